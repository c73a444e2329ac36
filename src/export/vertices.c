#include "export/vertices.h"

#include <string.h>

#include "base/disjoint_sets.h"
#include "base/memory.h"

static bool same_place(const double *corners, int32_t one, int32_t two)
{
    return !corners || memcmp(corners + 3 * (int64_t)one, corners + 3 * (int64_t)two, 3 * sizeof(double)) == 0;
}

void shv_vertices_join(const ShvLines *lines, const int32_t *piece, const double *corners, int32_t *parent)
{
    const ShvPieces *pieces = &lines->pieces;
    const int32_t places = 4 * shv_run_file_info(pieces->file)->element_count;
    for (int32_t i = 0; i < places; i++) parent[i] = i;
    for (int32_t place = 0; place < places; place++) {
        const int32_t tet = place / 4, other = lines->neighbour[place];
        if (other < tet || piece[other] != piece[tet]) continue; /* −1, or done from the other side */
        for (int k = 0; k < 3; k++) {
            const int32_t one = 4 * tet + shv_face_corner(place, k);
            for (int32_t two = 4 * other; two < 4 * other + 4; two++)
                if (pieces->elements[one] == pieces->elements[two] && same_place(corners, one, two))
                    shv_set_join(parent, one, two);
        }
    }
}

/* In the order in which faces come to them; `number` of each root, −1 before. */
static void number_vertices(ShvVertices *vertices, const ShvLines *lines, int32_t *parent, int32_t *number)
{
    int64_t count = 0;
    for (int32_t line = 0; line < lines->count; line++) {
        vertices->begin[line] = count;
        for (int64_t i = 3 * lines->begin[line]; i < 3 * lines->begin[line + 1]; i++) {
            const int64_t face = lines->face[i / 3];
            const int32_t corner = (int32_t)(4 * (face / 4)) + shv_face_corner(face, (int)(i % 3));
            const int32_t root = shv_set_root(parent, corner);
            if (number[root] < 0) {
                number[root] = (int32_t)(count - vertices->begin[line]);
                vertices->node[count++] = lines->pieces.elements[corner];
            }
            vertices->corners[i] = number[root];
        }
    }
    vertices->begin[lines->count] = count;
}

ShvStatus shv_vertices_create(ShvVertices *vertices, const ShvLines *lines, ShvError *error)
{
    const int32_t elements = shv_run_file_info(lines->pieces.file)->element_count;
    const size_t places = 4 * (size_t)elements, corners = 3 * (size_t)lines->begin[lines->count];
    *vertices = (ShvVertices){.begin = NULL};
    if (elements > INT32_MAX / 4)
        return shv_fail(error, SHV_UNSUPPORTED, "surfaces of meshes of more than %d tets cannot be exported",
                        (int)(INT32_MAX / 4));
    vertices->begin = shv_allocate(lines->memory, SHV_PART_RECORD, (size_t)lines->count + 1, sizeof(int64_t));
    vertices->node = shv_allocate(lines->memory, SHV_PART_RECORD, corners, sizeof(int32_t));
    vertices->corners = shv_allocate(lines->memory, SHV_PART_RECORD, corners, sizeof(int32_t));
    int32_t *parent = shv_allocate(lines->memory, SHV_PART_RECORD, places, sizeof *parent);
    int32_t *number = shv_allocate(lines->memory, SHV_PART_RECORD, places, sizeof *number);
    const bool good = vertices->begin && vertices->node && vertices->corners && parent && number;
    if (good) {
        for (size_t i = 0; i < places; i++) number[i] = -1;
        shv_vertices_join(lines, lines->pieces.owner, NULL, parent);
        number_vertices(vertices, lines, parent, number);
    } else {
        shv_vertices_release(vertices);
    }
    shv_release(parent);
    shv_release(number);
    return good ? SHV_OK : shv_fail_memory(error, "the vertices of surfaces", 8 * (places + corners));
}

void shv_vertices_release(ShvVertices *vertices)
{
    shv_release(vertices->begin);
    shv_release(vertices->node);
    shv_release(vertices->corners);
    *vertices = (ShvVertices){.begin = NULL};
}

int64_t shv_vertices_count(const ShvVertices *vertices, int32_t line)
{
    return vertices->begin[line + 1] - vertices->begin[line];
}

ShvVec3 shv_vertices_place(const ShvVertices *vertices, const ShvLines *lines, int32_t line, int64_t vertex)
{
    const int32_t node = vertices->node[vertices->begin[line] + vertex];
    return shv_sub(shv_load3(lines->pieces.reference + 3 * (int64_t)node), shv_lines_centre(lines, line));
}
