/* Convex pieces checked from outside: half-spaces of a piece found by brute force, bodies cut by nearest seed. */
#ifndef SHV_TESTS_RIGID_PIECES_H
#define SHV_TESTS_RIGID_PIECES_H

#include "convex/convex_pieces.h"
#include "convex/hull.h"

#include "world.h"

typedef struct Shape {
    ShvConvexPieces pieces;
    ShvPlanes *planes; /* one a piece */
    ShvVec3 centre;    /* reference centre of the fragment */
} Shape;

static inline void shape_make(Shape *shape, World *world, int32_t fragment)
{
    ShvError error = {0};
    ShvHullScratch scratch = {0};
    check_ok(shv_convex_pieces_make(&shape->pieces, &world->fragments, &world->model, &world->state, fragment, &error),
             error);
    shape->centre = world->fragments.items[fragment].reference_centre;
    shape->planes = calloc((size_t)shape->pieces.count, sizeof *shape->planes);
    for (int32_t p = 0; p < shape->pieces.count; p++) {
        const int32_t begin = shape->pieces.vertex_begin[p], end = shape->pieces.vertex_begin[p + 1];
        ShvPolytope polytope;
        check_ok(shv_polytope_make(&polytope, &scratch, shape->pieces.vertices + 3 * begin, end - begin, &error),
                 error);
        if (polytope.hull.rank == SHV_HULL_SOLID) shv_polytope_planes(&polytope, &shape->planes[p]);
    }
    shv_hull_scratch_release(&scratch);
}

static inline void shape_release(Shape *shape)
{
    free(shape->planes);
    shv_convex_pieces_release(&shape->pieces);
}

static inline bool planes_hold(const ShvPlanes *planes, ShvVec3 x, double slack)
{
    for (int32_t f = 0; f < planes->count; f++)
        if (shv_dot(shv_load3(planes->planes[f]), x) > planes->planes[f][3] + slack) return false;
    return planes->count > 0;
}

/* Whether a point in reference coordinates lies in some piece. */
static inline bool shape_holds(const Shape *shape, ShvVec3 point)
{
    const ShvVec3 x = shv_sub(point, shape->centre);
    for (int32_t p = 0; p < shape->pieces.count; p++) {
        const ShvPlanes *planes = &shape->planes[p];
        if (x.x < planes->low[0] || x.y < planes->low[1] || x.z < planes->low[2] || x.x > planes->high[0] ||
            x.y > planes->high[1] || x.z > planes->high[2])
            continue;
        if (planes_hold(planes, x, 0.0)) return true;
    }
    return false;
}

/* Uniform in tet `element`: shares by the logarithms of four uniform numbers. */
static inline ShvVec3 draw_in_tet(const World *world, int32_t element, uint64_t *index)
{
    double share[4], sum = 0.0;
    for (int a = 0; a < 4; a++) {
        share[a] = -log(draw(index, 0.0, 1.0));
        sum += share[a];
    }
    ShvVec3 x = {0};
    for (int a = 0; a < 4; a++)
        x = shv_madd(x, share[a] / sum,
                     shv_load3(world->state.reference + 3 * (int64_t)shv_state_node(&world->state, element, a)));
    return x;
}

/* Cuts the one object of a world into the elements nearest each of `count` random seeds in an ellipsoid. */
static inline void cut_by_seeds(World *world, int32_t count, ShvVec3 semi_axes, uint64_t *index)
{
    const int32_t elements = world->state.element_count;
    int32_t *group = malloc((size_t)elements * sizeof *group), parts = 0;
    ShvVec3 *seeds = malloc((size_t)count * sizeof *seeds);
    for (int32_t s = 0; s < count; s++) do {
            seeds[s] = draw3(index, 1.0);
        } while (shv_norm(seeds[s]) > 1.0);
    for (int32_t s = 0; s < count; s++)
        seeds[s] = shv_vec3(semi_axes.x * seeds[s].x, semi_axes.y * seeds[s].y, semi_axes.z * seeds[s].z);
    for (int32_t e = 0; e < elements; e++) {
        ShvVec3 centroid = {0};
        for (int a = 0; a < 4; a++)
            centroid = shv_madd(centroid, 0.25,
                                shv_load3(world->state.reference + 3 * (int64_t)shv_state_node(&world->state, e, a)));
        double nearest = (double)INFINITY;
        for (int32_t s = 0; s < count; s++) {
            const double distance = shv_norm(shv_sub(centroid, seeds[s]));
            if (distance >= nearest) continue;
            nearest = distance;
            group[e] = s;
        }
    }
    world_separate(world, group);
    ShvError error = {0};
    check_ok(shv_fragments_split(&world->fragments, &world->model, &world->state, 0, &parts, &error), error);
    free(group);
    free(seeds);
}

static inline ShvObjectDefinition *world_ball(World *world, double radius, double edge)
{
    ShvObjectDefinition *object = world_box(world, 1.0, 1.0, 1.0, 1.0);
    object->mesh.kind = SHV_MESH_BALL;
    object->mesh.radius = radius;
    object->mesh.edge = edge;
    object->mesh.jitter = 0.2;
    return object;
}

#endif
