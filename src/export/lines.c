#include "export/lines.h"

#include <stdlib.h>

#include "base/memory.h"

/* Corners of the face opposite to each corner. */
static const int FACES[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/* ---- neighbours ---- */

typedef struct Face {
    int32_t nodes[3]; /* increasing */
    int64_t place;    /* 4 × tet + opposite corner */
} Face;

static void order(int32_t *a, int32_t *b)
{
    if (*a <= *b) return;
    const int32_t other = *a;
    *a = *b;
    *b = other;
}

static int by_nodes(const void *a, const void *b)
{
    const Face *left = a, *right = b;
    for (int k = 0; k < 3; k++)
        if (left->nodes[k] != right->nodes[k]) return left->nodes[k] < right->nodes[k] ? -1 : 1;
    return (left->place > right->place) - (left->place < right->place);
}

static void find_neighbours(ShvLines *lines, Face *faces, int64_t count)
{
    for (int64_t i = 0; i < count; i++) {
        const int32_t *tet = lines->pieces.elements + 4 * (i / 4);
        int32_t *nodes = faces[i].nodes;
        for (int k = 0; k < 3; k++) nodes[k] = tet[FACES[i % 4][k]];
        order(&nodes[0], &nodes[1]);
        order(&nodes[1], &nodes[2]);
        order(&nodes[0], &nodes[1]);
        faces[i].place = i;
        lines->neighbour[i] = -1;
    }
    qsort(faces, (size_t)count, sizeof *faces, by_nodes);
    for (int64_t i = 0; i + 1 < count; i++) {
        const Face *one = &faces[i], *two = &faces[i + 1];
        if (one->nodes[0] != two->nodes[0] || one->nodes[1] != two->nodes[1] || one->nodes[2] != two->nodes[2])
            continue;
        lines->neighbour[one->place] = (int32_t)(two->place / 4);
        lines->neighbour[two->place] = (int32_t)(one->place / 4);
    }
}

/* ---- lines ---- */

static void find_lines(ShvLines *lines, int32_t elements, int32_t fragments)
{
    for (int32_t f = 0; f < fragments; f++) lines->index[f] = -1;
    for (int32_t e = 0; e < elements; e++) lines->index[lines->pieces.owner[e]] = 0;
    for (int32_t f = 0; f < fragments; f++) {
        if (lines->index[f] < 0) continue;
        lines->leaf[lines->count] = f;
        lines->index[f] = lines->count++;
    }
}

static bool is_seen(const ShvLines *lines, const uint8_t *cracks, int64_t place)
{
    const int32_t other = lines->neighbour[place];
    return other < 0 || (cracks && cracks[place]) || lines->pieces.owner[other] != lines->pieces.owner[place / 4];
}

static void count_faces(ShvLines *lines, const uint8_t *cracks, int64_t places)
{
    for (int32_t i = 0; i <= lines->count; i++) lines->begin[i] = 0;
    for (int64_t i = 0; i < places; i++)
        if (is_seen(lines, cracks, i)) lines->begin[shv_lines_of(lines, i / 4) + 1]++;
    for (int32_t i = 0; i < lines->count; i++) lines->begin[i + 1] += lines->begin[i];
}

/* Filled from the end of each line: `begin` moves one place up and back. */
static void fill_faces(ShvLines *lines, const uint8_t *cracks, int64_t places)
{
    for (int64_t i = places - 1; i >= 0; i--)
        if (is_seen(lines, cracks, i)) lines->face[--lines->begin[shv_lines_of(lines, i / 4) + 1]] = i;
    for (int32_t i = 0; i < lines->count; i++) lines->begin[i] = lines->begin[i + 1];
}

static ShvStatus prepare(ShvLines *lines, const uint8_t *cracks, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(lines->pieces.file);
    const size_t fragments = (size_t)info->fragment_count, places = 4 * (size_t)info->element_count;
    lines->leaf = shv_allocate(lines->memory, SHV_PART_RECORD, fragments, sizeof(int32_t));
    lines->index = shv_allocate(lines->memory, SHV_PART_RECORD, fragments, sizeof(int32_t));
    lines->begin = shv_allocate(lines->memory, SHV_PART_RECORD, fragments + 1, sizeof(int64_t));
    lines->neighbour = shv_allocate(lines->memory, SHV_PART_RECORD, places, sizeof(int32_t));
    Face *faces = shv_allocate(lines->memory, SHV_PART_RECORD, places, sizeof *faces);
    bool good = lines->leaf && lines->index && lines->begin && lines->neighbour && faces;
    if (good) {
        find_neighbours(lines, faces, (int64_t)places);
        find_lines(lines, info->element_count, info->fragment_count);
        count_faces(lines, cracks, (int64_t)places);
        lines->face = shv_allocate(lines->memory, SHV_PART_RECORD, (size_t)lines->begin[lines->count], sizeof(int64_t));
        good = lines->face != NULL;
    }
    shv_release(faces);
    if (!good) return shv_fail_memory(error, "the faces of the mesh", 36 * places);
    const int64_t total = lines->begin[lines->count];
    fill_faces(lines, cracks, (int64_t)places);
    lines->begin[lines->count] = total;
    return SHV_OK;
}

ShvStatus shv_lines_create(ShvLines *lines, ShvRunFile *file, struct ShvMemory *memory, const uint8_t *cracks,
                           ShvError *error)
{
    *lines = (ShvLines){.memory = memory};
    SHV_TRY(shv_pieces_create(&lines->pieces, file, memory, error));
    const ShvStatus status = prepare(lines, cracks, error);
    if (status != SHV_OK) shv_lines_release(lines);
    return status;
}

void shv_lines_release(ShvLines *lines)
{
    shv_pieces_release(&lines->pieces);
    shv_release(lines->leaf);
    shv_release(lines->index);
    shv_release(lines->begin);
    shv_release(lines->neighbour);
    shv_release(lines->face);
    *lines = (ShvLines){.memory = NULL};
}

/* ---- at a frame ---- */

ShvStatus shv_lines_move(ShvLines *lines, int64_t frame, ShvError *error)
{
    return shv_pieces_move(&lines->pieces, frame, error);
}

ShvPose shv_lines_pose(const ShvLines *lines, int32_t line)
{
    const ShvPieces *pieces = &lines->pieces;
    const int32_t carrier = pieces->carrier[lines->leaf[line]];
    const double *q = pieces->orientation + 4 * (int64_t)carrier;
    const ShvQuat orientation = {q[0], q[1], q[2], q[3]};
    const ShvVec3 arm = shv_sub(shv_lines_centre(lines, line), shv_load3(pieces->fragments[carrier].reference_centre));
    const ShvVec3 position = shv_add(shv_load3(pieces->position + 3 * (int64_t)carrier), shv_rotate(orientation, arm));
    return (ShvPose){position, orientation, carrier, pieces->alive[carrier] && shv_finite3(position)};
}

int32_t shv_lines_of(const ShvLines *lines, int64_t tet)
{
    return lines->index[lines->pieces.owner[tet]];
}

int shv_face_corner(int64_t face, int k)
{
    return FACES[face % 4][k];
}

ShvVec3 shv_lines_corner(const ShvLines *lines, int64_t face, int k)
{
    const int32_t node = lines->pieces.elements[4 * (face / 4) + shv_face_corner(face, k)];
    return shv_load3(lines->pieces.reference + 3 * (int64_t)node);
}

ShvVec3 shv_lines_centre(const ShvLines *lines, int32_t line)
{
    return shv_load3(lines->pieces.fragments[lines->leaf[line]].reference_centre);
}
