#include "rigid/bullet_shape.h"

ShvStatus shv_body_shape_of_pieces(ShvBodyShape *body, const ShvConvexPieces *pieces, const ShvMat3 *axes, bool dust,
                                   ShvError *error)
{
    const int32_t count = pieces->vertex_begin[pieces->count];
    *body = (ShvBodyShape){.vertices =
                               shv_allocate(pieces->memory, SHV_PART_RIGID, 3 * (size_t)count, sizeof *body->vertices)};
    if (!body->vertices)
        return shv_fail_memory(error, "the hulls of a fragment", 3 * (size_t)count * sizeof *body->vertices);
    for (int32_t i = 0; i < count; i++)
        shv_store3(body->vertices + 3 * (int64_t)i,
                   shv_apply_transposed(axes, shv_load3(pieces->vertices + 3 * (int64_t)i)));
    body->shape = (ShvBulletShape){.kind = SHV_BULLET_HULLS,
                                   .layer = dust ? SHV_BULLET_PARTICLE : SHV_BULLET_BODY,
                                   .hull_count = pieces->count,
                                   .hull_begin = pieces->vertex_begin,
                                   .vertices = body->vertices};
    return SHV_OK;
}

static const double box_corners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                         {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};

static ShvBulletKind kind_of(const ShvObstacle *obstacle)
{
    switch (obstacle->shape) {
    case SHV_OBSTACLE_PLANE:
        return SHV_BULLET_PLANE;
    case SHV_OBSTACLE_SPHERE:
        return SHV_BULLET_SPHERE;
    case SHV_OBSTACLE_BOX:
        return SHV_BULLET_HULLS;
    case SHV_OBSTACLE_MESH:
        break;
    }
    return obstacle->motion == SHV_OBSTACLE_FREE ? SHV_BULLET_HULLS : SHV_BULLET_TRIANGLES;
}

ShvStatus shv_body_shape_of_obstacle(ShvBodyShape *body, const ShvObstacle *obstacle, const ShvMat3 *axes,
                                     ShvMemory *memory, ShvError *error)
{
    const bool mesh = obstacle->shape == SHV_OBSTACLE_MESH;
    const int32_t count = mesh ? obstacle->surface.node_count : 8;
    *body = (ShvBodyShape){.hull_begin = {0, count}};
    body->vertices = shv_allocate(memory, SHV_PART_RIGID, 3 * (size_t)count, sizeof *body->vertices);
    if (!body->vertices)
        return shv_fail_memory(error, "the shape of an obstacle", 3 * (size_t)count * sizeof *body->vertices);
    for (int32_t i = 0; i < count; i++) {
        const double *c = box_corners[i % 8];
        const ShvVec3 corner =
            mesh ? shv_surface_position(&obstacle->surface, i)
                 : shv_vec3(c[0] * obstacle->half.x, c[1] * obstacle->half.y, c[2] * obstacle->half.z);
        shv_store3(body->vertices + 3 * (int64_t)i, shv_apply_transposed(axes, corner));
    }
    body->shape = (ShvBulletShape){.kind = kind_of(obstacle),
                                   .layer = SHV_BULLET_OBSTACLE,
                                   .offset = obstacle->offset,
                                   .radius = obstacle->radius,
                                   .hull_count = 1,
                                   .hull_begin = body->hull_begin,
                                   .vertices = body->vertices,
                                   .vertex_count = count,
                                   .triangles = obstacle->surface.triangles,
                                   .triangle_count = obstacle->surface.triangle_count};
    shv_store3(body->shape.normal, obstacle->normal);
    return SHV_OK;
}

void shv_body_shape_release(ShvBodyShape *body)
{
    shv_release(body->vertices);
    body->vertices = NULL;
}
