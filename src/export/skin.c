#include "export/skin.h"

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

static void find_neighbours(ShvSkin *skin, Face *faces, int64_t count)
{
    for (int64_t i = 0; i < count; i++) {
        const int32_t *tet = skin->pieces.elements + 4 * (i / 4);
        int32_t *nodes = faces[i].nodes;
        for (int k = 0; k < 3; k++) nodes[k] = tet[FACES[i % 4][k]];
        order(&nodes[0], &nodes[1]);
        order(&nodes[1], &nodes[2]);
        order(&nodes[0], &nodes[1]);
        faces[i].place = i;
        skin->neighbour[i] = -1;
    }
    qsort(faces, (size_t)count, sizeof *faces, by_nodes);
    for (int64_t i = 0; i + 1 < count; i++) {
        const Face *one = &faces[i], *two = &faces[i + 1];
        if (one->nodes[0] != two->nodes[0] || one->nodes[1] != two->nodes[1] || one->nodes[2] != two->nodes[2])
            continue;
        skin->neighbour[one->place] = (int32_t)(two->place / 4);
        skin->neighbour[two->place] = (int32_t)(one->place / 4);
    }
}

/* ---- making ---- */

static ShvStatus prepare(ShvSkin *skin, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(skin->pieces.file);
    const size_t count = (size_t)info->element_count;
    skin->neighbour = shv_allocate(skin->memory, SHV_PART_RECORD, 4 * count, sizeof(int32_t));
    skin->owner = shv_allocate(skin->memory, SHV_PART_RECORD, count, sizeof(int32_t));
    if (info->nodes) skin->corners = shv_allocate(skin->memory, SHV_PART_RECORD, 12 * count, sizeof(double));
    Face *faces = shv_allocate(skin->memory, SHV_PART_RECORD, 4 * count, sizeof *faces);
    const bool good = skin->neighbour && skin->owner && faces && (skin->corners || !info->nodes);
    if (good) find_neighbours(skin, faces, 4 * (int64_t)count);
    shv_release(faces);
    return good ? SHV_OK : shv_fail_memory(error, "the skin", 200 * count);
}

ShvStatus shv_skin_create(ShvSkin *skin, ShvRunFile *file, struct ShvMemory *memory, ShvError *error)
{
    *skin = (ShvSkin){.memory = memory};
    SHV_TRY(shv_pieces_create(&skin->pieces, file, memory, error));
    const ShvStatus status = prepare(skin, error);
    if (status != SHV_OK) shv_skin_release(skin);
    return status;
}

void shv_skin_release(ShvSkin *skin)
{
    shv_pieces_release(&skin->pieces);
    shv_release(skin->neighbour);
    shv_release(skin->owner);
    shv_release(skin->corners);
    shv_release(skin->triangles);
    *skin = (ShvSkin){.memory = NULL};
}

/* ---- one frame ---- */

/* Owners at the frame: recorded, or the carriers of the last owners. */
static ShvStatus find_owners(ShvSkin *skin, int64_t frame, ShvError *error)
{
    const ShvPieces *pieces = &skin->pieces;
    const ShvRunFileInfo *info = shv_run_file_info(pieces->file);
    if (skin->corners) SHV_TRY(shv_run_file_corners(pieces->file, frame, skin->corners, NULL, skin->owner, error));
    for (int32_t e = 0; e < info->element_count; e++) {
        const int32_t owner = skin->corners ? skin->owner[e] : pieces->carrier[pieces->owner[e]];
        const bool lives = owner >= 0 && owner < info->fragment_count && pieces->alive[owner];
        skin->owner[e] = lives ? owner : -1;
    }
    return SHV_OK;
}

static ShvVec3 corner_of(const ShvSkin *skin, int64_t tet, int corner)
{
    if (skin->corners) return shv_load3(skin->corners + 12 * tet + 3 * (int64_t)corner);
    return shv_pieces_point(&skin->pieces, skin->pieces.owner[tet], skin->pieces.elements[4 * tet + corner]);
}

/* The order of the corners follows from where the opposite one is, so that a tet turned inside out is drawn too. */
static void add_face(ShvSkin *skin, int64_t tet, int face)
{
    ShvTriangle *triangle = &skin->triangles[skin->count];
    for (int k = 0; k < 3; k++) triangle->corner[k] = corner_of(skin, tet, FACES[face][k]);
    const ShvVec3 a = triangle->corner[0], b = triangle->corner[1], c = triangle->corner[2];
    if (!shv_finite3(a) || !shv_finite3(b) || !shv_finite3(c)) return;
    const ShvVec3 normal = shv_cross(shv_sub(b, a), shv_sub(c, a));
    if (shv_dot(normal, shv_sub(corner_of(skin, tet, face), a)) > 0.0) {
        triangle->corner[1] = c;
        triangle->corner[2] = b;
    }
    triangle->fragment = skin->owner[tet];
    skin->count++;
}

static bool is_bare(const ShvSkin *skin, int64_t place)
{
    const int32_t owner = skin->owner[place / 4], other = skin->neighbour[place];
    return owner >= 0 && (other < 0 || skin->owner[other] != owner);
}

ShvStatus shv_skin_move(ShvSkin *skin, int64_t frame, ShvError *error)
{
    const int64_t places = 4 * (int64_t)shv_run_file_info(skin->pieces.file)->element_count;
    SHV_TRY(shv_pieces_move(&skin->pieces, frame, error));
    SHV_TRY(find_owners(skin, frame, error));
    int64_t wanted = 0;
    for (int64_t place = 0; place < places; place++) wanted += is_bare(skin, place);
    if (wanted > skin->capacity) {
        ShvTriangle *grown =
            shv_reallocate(skin->memory, SHV_PART_RECORD, skin->triangles, (size_t)wanted, sizeof *skin->triangles);
        if (!grown) return shv_fail_memory(error, "triangles", (size_t)wanted * sizeof *skin->triangles);
        skin->triangles = grown;
        skin->capacity = wanted;
    }
    skin->count = 0;
    for (int64_t place = 0; place < places; place++)
        if (is_bare(skin, place)) add_face(skin, place / 4, (int)(place % 4));
    return SHV_OK;
}
