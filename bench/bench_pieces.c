/* Speed of convex pieces: bench_pieces [MESH.msh]. A glass ball of radius 0.1 m, meshed with about 45,000 tets or read from a
   gmsh file, is cut by nearest seed into 10, 100 and 5,000 pieces. One line of CSV each: fragments, seconds for all of them on
   one core (the best of several rounds counts: other work on the machine only ever slows it down), hulls a fragment, most
   vertices of a hull, and, in % of the ball, space in hulls that the fragment does not own and its tets in no hull. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/random.h"
#include "base/text.h"
#include "base/timer.h"
#include "rigid/convex_pieces.h"

enum { ROUNDS = 5 };
#define RADIUS 0.1

typedef struct Bench {
    ShvModel model;
    ShvState state;
    ShvFragments fragments;
} Bench;

static ShvStatus build(Bench *bench, const char *file, ShvError *error)
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
    object.mesh.radius = RADIUS;
    object.mesh.edge = 0.01;
    object.mesh.jitter = 0.2;
    ShvSceneDefinition scene = shv_scene_default();
    scene.materials = &material;
    scene.objects = &object;
    scene.material_count = scene.object_count = 1;
    scene.threads = 1;
    SHV_TRY(shv_model_build(&bench->model, NULL, &scene, NULL, error));
    SHV_TRY(shv_state_create(&bench->state, &bench->model, &scene, error));
    return shv_fragments_create(&bench->fragments, &bench->model, &bench->state, error);
}

static void release(Bench *bench)
{
    shv_fragments_release(&bench->fragments);
    shv_state_release(&bench->state);
    shv_model_release(&bench->model);
}

static ShvVec3 centroid(const Bench *bench, int32_t element)
{
    ShvVec3 sum = {0};
    for (int a = 0; a < 4; a++)
        sum = shv_add(sum, shv_load3(bench->state.reference + 3 * (int64_t)shv_state_node(&bench->state, element, a)));
    return shv_scale(sum, 0.25);
}

/* Random points in the ball, out of its box. */
static void draw_seeds(ShvVec3 *seeds, int32_t count)
{
    uint64_t index = 0;
    for (int32_t s = 0; s < count;) {
        double x[3];
        for (int i = 0; i < 3; i++) x[i] = RADIUS * (2.0 * shv_random_uniform(1, index++) - 1.0);
        seeds[s] = shv_load3(x);
        s += shv_norm(seeds[s]) <= RADIUS;
    }
}

static void nearest_seeds(const Bench *bench, const ShvVec3 *seeds, int32_t count, int32_t *group)
{
    for (int32_t e = 0; e < bench->state.element_count; e++) {
        const ShvVec3 x = centroid(bench, e);
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
static ShvStatus separate(Bench *bench, const int32_t *group, ShvError *error)
{
    ShvState *state = &bench->state;
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

static ShvStatus cut(Bench *bench, int32_t seeds, ShvError *error)
{
    const size_t elements = (size_t)bench->state.element_count;
    int32_t *group = shv_allocate(NULL, SHV_PART_GENERAL, elements, sizeof *group), parts = 0;
    ShvVec3 *points = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)seeds, sizeof *points);
    ShvStatus status = shv_fail_memory(error, "seeds", 4 * elements);
    if (group && points) {
        draw_seeds(points, seeds);
        nearest_seeds(bench, points, seeds, group);
        status = separate(bench, group, error);
    }
    shv_release(group);
    shv_release(points);
    SHV_TRY(status);
    return shv_fragments_split(&bench->fragments, &bench->model, &bench->state, 0, &parts, error);
}

typedef struct Total {
    int32_t fragments, hulls, most_vertices;
    double outside, missing, volume;
} Total;

static ShvStatus make_all(const Bench *bench, Total *total, ShvError *error)
{
    *total = (Total){0};
    for (int32_t f = 0; f < bench->fragments.count; f++) {
        if (bench->fragments.items[f].mode == SHV_MODE_DEAD) continue;
        ShvConvexPieces pieces;
        SHV_TRY(shv_convex_pieces_make(&pieces, &bench->fragments, &bench->model, &bench->state, f, error));
        total->fragments++;
        total->hulls += pieces.count;
        total->outside += pieces.outside;
        total->missing += pieces.missing;
        total->volume += bench->fragments.items[f].volume;
        for (int32_t p = 0; p < pieces.count; p++) {
            const int32_t vertices = pieces.vertex_begin[p + 1] - pieces.vertex_begin[p];
            if (vertices > total->most_vertices) total->most_vertices = vertices;
        }
        shv_convex_pieces_release(&pieces);
    }
    return SHV_OK;
}

static ShvStatus measure(const char *file, int32_t seeds, ShvError *error)
{
    Bench bench = {0};
    Total total = {0};
    double best = (double)INFINITY;
    ShvStatus status = build(&bench, file, error);
    if (status == SHV_OK) status = cut(&bench, seeds, error);
    for (int round = 0; round < ROUNDS && status == SHV_OK; round++) {
        const double start = shv_now();
        status = make_all(&bench, &total, error);
        best = fmin(best, shv_now() - start);
    }
    if (status == SHV_OK)
        shv_print(stdout, "%d,%d,%d,%.4f,%.2f,%d,%.2f,%.2f\n", (int)bench.state.element_count, (int)seeds,
                  (int)total.fragments, best, (double)total.hulls / total.fragments, (int)total.most_vertices,
                  100.0 * total.outside / total.volume, 100.0 * total.missing / total.volume);
    release(&bench);
    return status;
}

int main(int argc, char **argv)
{
    static const int32_t seeds[] = {10, 100, 5000};
    ShvError error;
    puts("tets,seeds,fragments,seconds,hulls_per_fragment,most_vertices,outside_percent,missing_percent");
    for (int i = 0; i < 3; i++)
        if (measure(argc > 1 ? argv[1] : NULL, seeds[i], &error) != SHV_OK) {
            fprintf(stderr, "%s\n", error.message);
            return 1;
        }
    return 0;
}
