#include "broken_ball.h"

#include <math.h>

#include "base/random.h"

static ShvStatus build(BrokenBall *ball, const char *file, double edge, ShvError *error)
{
    ShvMaterialDefinition material = shv_material_default();
    material.name = "glass";
    material.density = 2500.0;
    material.youngs_modulus = 70e9;
    material.poissons_ratio = 0.22;
    material.breakable = false;
    ShvObjectDefinition object = shv_object_default();
    object.name = "ball";
    object.material = "glass";
    object.mesh.kind = file ? SHV_MESH_GMSH : SHV_MESH_BALL;
    object.mesh.file = file;
    object.mesh.radius = BROKEN_BALL_RADIUS;
    object.mesh.edge = edge;
    object.mesh.jitter = 0.2;
    ShvSceneDefinition scene = shv_scene_default();
    scene.materials = &material;
    scene.objects = &object;
    scene.material_count = scene.object_count = 1;
    scene.threads = 1;
    SHV_TRY(shv_model_build(&ball->model, NULL, &scene, NULL, error));
    SHV_TRY(shv_state_create(&ball->state, &ball->model, &scene, error));
    return shv_fragments_create(&ball->fragments, &ball->model, &ball->state, error);
}

void broken_ball_release(BrokenBall *ball)
{
    shv_fragments_release(&ball->fragments);
    shv_state_release(&ball->state);
    shv_model_release(&ball->model);
}

static ShvVec3 centroid(const BrokenBall *ball, int32_t element)
{
    ShvVec3 sum = {0};
    for (int a = 0; a < 4; a++)
        sum = shv_add(sum, shv_load3(ball->state.reference + 3 * (int64_t)shv_state_node(&ball->state, element, a)));
    return shv_scale(sum, 0.25);
}

/* Random points in the ball, out of its box. */
static void draw_seeds(ShvVec3 *seeds, int32_t count)
{
    uint64_t index = 0;
    for (int32_t s = 0; s < count;) {
        double x[3];
        for (int i = 0; i < 3; i++) x[i] = BROKEN_BALL_RADIUS * (2.0 * shv_random_uniform(1, index++) - 1.0);
        seeds[s] = shv_load3(x);
        s += shv_norm(seeds[s]) <= BROKEN_BALL_RADIUS;
    }
}

static void nearest_seeds(const BrokenBall *ball, const ShvVec3 *seeds, int32_t count, int32_t *group)
{
    for (int32_t e = 0; e < ball->state.element_count; e++) {
        const ShvVec3 x = centroid(ball, e);
        double nearest = (double)INFINITY;
        for (int32_t s = 0; s < count; s++) {
            const ShvVec3 away = shv_sub(x, seeds[s]);
            const double distance = shv_dot(away, away);
            if (distance >= nearest) continue;
            nearest = distance;
            group[e] = s;
        }
    }
}

/* Gives every group its own copy of each node: chains of (group, node) hang on the nodes of the mesh. */
static ShvStatus separate(BrokenBall *ball, const int32_t *group, ShvError *error)
{
    ShvState *state = &ball->state;
    const int32_t corners = 4 * state->element_count, nodes = state->node_count;
    SHV_TRY(shv_state_reserve(state, (int64_t)nodes + corners, error));
    int32_t *next = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)nodes + (size_t)corners, sizeof *next);
    int32_t *owner = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)nodes + (size_t)corners, sizeof *owner);
    for (int32_t n = 0; next && owner && n < nodes; n++) next[n] = owner[n] = -1;
    for (int32_t c = 0; next && owner && c < corners; c++) {
        const int32_t first = shv_state_node(state, c / 4, c % 4);
        int32_t node = first;
        while (owner[node] != group[c / 4] && owner[node] >= 0 && next[node] >= 0) node = next[node];
        if (owner[node] >= 0 && owner[node] != group[c / 4]) {
            const int32_t copy = state->node_count++;
            for (int i = 0; i < 3; i++)
                state->reference[3 * (int64_t)copy + i] = state->reference[3 * (int64_t)first + i];
            state->origin[copy] = state->origin[first];
            state->mass[copy] = state->mass[first];
            next[node] = copy;
            next[copy] = -1;
            node = copy;
        }
        owner[node] = group[c / 4];
        state->connectivity[shv_corner_slot(c / 4, c % 4)] = node;
    }
    const bool done = next && owner;
    shv_release(next);
    shv_release(owner);
    return done ? SHV_OK : shv_fail_memory(error, "node copies", 8 * ((size_t)nodes + (size_t)corners));
}

static ShvStatus cut(BrokenBall *ball, int32_t seeds, ShvError *error)
{
    const size_t elements = (size_t)ball->state.element_count;
    int32_t *group = shv_allocate(NULL, SHV_PART_GENERAL, elements, sizeof *group), parts = 0;
    ShvVec3 *points = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)seeds, sizeof *points);
    ShvStatus status = shv_fail_memory(error, "seeds", 4 * elements);
    if (group && points) {
        draw_seeds(points, seeds);
        nearest_seeds(ball, points, seeds, group);
        status = separate(ball, group, error);
    }
    shv_release(group);
    shv_release(points);
    SHV_TRY(status);
    return shv_fragments_split(&ball->fragments, &ball->model, &ball->state, 0, &parts, error);
}

ShvStatus broken_ball_make(BrokenBall *ball, const char *file, double edge, int32_t seeds, ShvError *error)
{
    *ball = (BrokenBall){0};
    SHV_TRY(build(ball, file, edge, error));
    return cut(ball, seeds, error);
}
