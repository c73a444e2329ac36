#include "export/obstacle_mesh.h"

#include <math.h>
#include <string.h>

#include "base/deterministic.h"
#include "base/memory.h"

/* A sphere's meridians and the belts between its poles: 2.5 % of the radius at most between a facet and the sphere. */
enum { MERIDIANS = 32, BELTS = 16 };
/* Half an edge of a plane's square, over half the diagonal of the box around all objects at the start. */
static const double PLANE_REACH = 4.0;

static ShvStatus take_room(ShvObstacleMesh *mesh, int32_t nodes, int32_t triangles, struct ShvMemory *memory,
                           ShvError *error)
{
    mesh->node_count = nodes;
    mesh->triangle_count = triangles;
    mesh->positions = shv_allocate(memory, SHV_PART_RECORD, 3 * (size_t)nodes, sizeof(double));
    mesh->triangles = shv_allocate(memory, SHV_PART_RECORD, 3 * (size_t)triangles, sizeof(int32_t));
    return mesh->positions && mesh->triangles ? SHV_OK : shv_fail_memory(error, "an obstacle", 24 * (size_t)nodes);
}

static void put_triangle(ShvObstacleMesh *mesh, int32_t *next, int32_t a, int32_t b, int32_t c)
{
    int32_t *triangle = mesh->triangles + 3 * (int64_t)(*next)++;
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

static void put_sphere(ShvObstacleMesh *mesh, double radius)
{
    const int32_t top = MERIDIANS * (BELTS - 1), bottom = top + 1;
    int32_t next = 0;
    for (int32_t i = 0; i < top; i++) {
        const double polar = SHV_PI * (i / MERIDIANS + 1) / BELTS, turn = 2.0 * SHV_PI * (i % MERIDIANS) / MERIDIANS;
        shv_store3(mesh->positions + 3 * (int64_t)i,
                   shv_vec3(radius * sin(polar) * cos(turn), radius * sin(polar) * sin(turn), radius * cos(polar)));
    }
    shv_store3(mesh->positions + 3 * (int64_t)top, shv_vec3(0.0, 0.0, radius));
    shv_store3(mesh->positions + 3 * (int64_t)bottom, shv_vec3(0.0, 0.0, -radius));
    for (int32_t k = 0; k < MERIDIANS; k++) {
        const int32_t after = (k + 1) % MERIDIANS, last = MERIDIANS * (BELTS - 2);
        put_triangle(mesh, &next, top, k, after);
        put_triangle(mesh, &next, bottom, last + after, last + k);
        for (int32_t belt = 0; belt < BELTS - 2; belt++) {
            const int32_t upper = MERIDIANS * belt, lower = upper + MERIDIANS;
            put_triangle(mesh, &next, upper + k, lower + k, lower + after);
            put_triangle(mesh, &next, upper + k, lower + after, upper + after);
        }
    }
}

static void put_box(ShvObstacleMesh *mesh, const double size[3])
{
    /* Two triangles a side; corner i has the high end of x, y, z where the bit 1, 2, 4 of i is set. */
    static const int32_t sides[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                         {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    for (int32_t i = 0; i < 8; i++)
        for (int32_t k = 0; k < 3; k++) mesh->positions[3 * i + k] = (i >> k & 1 ? 0.5 : -0.5) * size[k];
    memcpy(mesh->triangles, sides, sizeof sides);
}

static void put_plane(ShvObstacleMesh *mesh, ShvVec3 centre, double reach)
{
    const ShvVec3 normal = shv_load3(mesh->body.normal);
    /* Along the axes of the world on a level floor. */
    const ShvVec3 start = fabs(normal.x) < 0.9 ? shv_vec3(1.0, 0.0, 0.0) : shv_vec3(0.0, 1.0, 0.0);
    const ShvVec3 one = shv_unit(shv_madd(start, -shv_dot(start, normal), normal)), two = shv_cross(normal, one);
    const ShvVec3 foot = shv_madd(centre, mesh->body.offset - shv_dot(centre, normal), normal);
    for (int32_t i = 0; i < 4; i++)
        shv_store3(mesh->positions + 3 * (int64_t)i,
                   shv_madd(shv_madd(foot, i == 0 || i == 3 ? -reach : reach, one), i < 2 ? -reach : reach, two));
    int32_t next = 0;
    put_triangle(mesh, &next, 0, 1, 2);
    put_triangle(mesh, &next, 0, 2, 3);
}

static ShvStatus make(ShvObstacleMesh *mesh, ShvVec3 centre, double reach, struct ShvMemory *memory, ShvError *error)
{
    const ShvObstacleBody *body = &mesh->body;
    switch (body->shape) {
    case SHV_OBSTACLE_PLANE:
        SHV_TRY(take_room(mesh, 4, 2, memory, error));
        put_plane(mesh, centre, PLANE_REACH * reach);
        return SHV_OK;
    case SHV_OBSTACLE_SPHERE:
        SHV_TRY(take_room(mesh, MERIDIANS * (BELTS - 1) + 2, 2 * MERIDIANS * (BELTS - 1), memory, error));
        put_sphere(mesh, body->radius);
        return SHV_OK;
    case SHV_OBSTACLE_BOX:
        SHV_TRY(take_room(mesh, 8, 12, memory, error));
        put_box(mesh, body->size);
        return SHV_OK;
    default:
        SHV_TRY(take_room(mesh, body->node_count, body->triangle_count, memory, error));
        if (body->node_count > 0)
            memcpy(mesh->positions, body->positions, 3 * (size_t)body->node_count * sizeof(double));
        if (body->triangle_count > 0)
            memcpy(mesh->triangles, body->triangles, 3 * (size_t)body->triangle_count * sizeof(int32_t));
        return SHV_OK;
    }
}

/* Middle of the box around the reference mesh; returns half its diagonal. */
static double surround(const ShvPieces *pieces, ShvVec3 *centre)
{
    const int32_t count = shv_run_file_info(pieces->file)->node_count;
    double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
    for (int32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const double x = pieces->reference[3 * (int64_t)i + k];
            low[k] = i == 0 ? x : fmin(low[k], x);
            high[k] = i == 0 ? x : fmax(high[k], x);
        }
    *centre = shv_scale(shv_add(shv_load3(low), shv_load3(high)), 0.5);
    return 0.5 * shv_norm(shv_sub(shv_load3(high), shv_load3(low)));
}

ShvStatus shv_obstacle_meshes_create(ShvObstacleMesh **meshes, const ShvPieces *pieces, struct ShvMemory *memory,
                                     ShvError *error)
{
    const int32_t count = shv_run_file_info(pieces->file)->obstacle_count;
    ShvVec3 centre;
    const double reach = surround(pieces, &centre);
    *meshes = shv_allocate(memory, SHV_PART_RECORD, (size_t)count, sizeof **meshes);
    if (!*meshes) return shv_fail_memory(error, "obstacles", (size_t)count * sizeof **meshes);
    memset(*meshes, 0, (size_t)count * sizeof **meshes);
    for (int32_t i = 0; i < count; i++) {
        SHV_TRY(shv_run_file_obstacle(pieces->file, i, &(*meshes)[i].body, error));
        SHV_TRY(make(&(*meshes)[i], centre, reach, memory, error));
    }
    return SHV_OK;
}

void shv_obstacle_meshes_release(ShvObstacleMesh *meshes, int32_t count)
{
    for (int32_t i = 0; meshes && i < count; i++) {
        shv_release(meshes[i].positions);
        shv_release(meshes[i].triangles);
    }
    shv_release(meshes);
}
