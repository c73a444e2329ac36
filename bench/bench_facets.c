/* Cost of the cohesive solve: bench_facets [FACETS [THREADS [STEPS]]]. A cube is cut into grains by the nearest of random
   seeds, so that clusters have the sizes that they have in rubble, and every facet between two grains is inserted: all their
   corners are split. Grains drift apart and together at random, so that facets soften, unload and close. One line of CSV:
   nanoseconds a point and step of all cohesive calls of a step together, beside those a tet and step of the internal force in
   the same run, by which figures of different machines and moods of one machine can be compared. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/hash.h"
#include "base/random.h"
#include "base/text.h"
#include "base/timer.h"
#include "cohesive/cohesive.h"
#include "solid/motion.h"
#include "solid/solid.h"

enum { MOST_SEEDS = 4096 };
static const double no_gravity[3] = {0.0, 0.0, 0.0};

typedef struct Bench {
    ShvSceneDefinition scene;
    ShvMaterialDefinition material;
    ShvObjectDefinition object;
    ShvModel model;
    ShvState state;
    ShvSolid solid;
    ShvCohesive cohesive;
    int32_t *grain, *facets;
    int32_t facet_count;
    double cohesive_time, force_time;
    int64_t points, sweeps;
} Bench;

static void define(Bench *bench, double tets, int32_t threads)
{
    bench->material = shv_material_default();
    bench->material.name = "plaster";
    bench->material.density = 2000.0;
    bench->material.youngs_modulus = 10e9;
    bench->material.poissons_ratio = 0.2;
    bench->material.breakable = true;
    bench->material.fracture_energy = 20.0;
    bench->material.cohesive_strength = 4e6;
    bench->object = shv_object_default();
    bench->object.name = "cube";
    bench->object.material = "plaster";
    for (int i = 0; i < 3; i++) bench->object.mesh.size[i] = 0.1;
    bench->object.mesh.edge = 0.1 * cbrt(8.5 / tets);
    bench->object.mesh.jitter = 0.1;
    bench->scene = shv_scene_default();
    bench->scene.materials = &bench->material;
    bench->scene.objects = &bench->object;
    bench->scene.material_count = bench->scene.object_count = 1;
    bench->scene.threads = threads;
    bench->scene.fracture.enabled = true;
}

static ShvVec3 random_vector(uint64_t stream, uint64_t index)
{
    return shv_vec3(shv_random_uniform(stream, 3 * index) - 0.5, shv_random_uniform(stream, 3 * index + 1) - 0.5,
                    shv_random_uniform(stream, 3 * index + 2) - 0.5);
}

static int32_t nearest_seed(ShvVec3 x, int32_t seeds)
{
    int32_t nearest = 0;
    double least = (double)INFINITY;
    for (int32_t s = 0; s < seeds; s++) {
        const ShvVec3 away = shv_madd(x, -0.1, random_vector(1, (uint64_t)s));
        if (!(shv_dot(away, away) < least)) continue;
        least = shv_dot(away, away);
        nearest = s;
    }
    return nearest;
}

/* Of the grains of so many seeds. */
static int32_t find_boundary(Bench *bench, int32_t seeds)
{
    const ShvAdjacency *adjacency = &bench->model.adjacency;
    for (int32_t e = 0; e < bench->state.element_count; e++) {
        ShvVec3 sum = {0.0, 0.0, 0.0};
        for (int a = 0; a < 4; a++)
            sum = shv_madd(sum, 0.25, shv_mesh_position(&bench->model.mesh, bench->model.mesh.elements[4 * e + a]));
        bench->grain[e] = nearest_seed(sum, seeds);
    }
    bench->facet_count = 0;
    for (int32_t f = 0; f < adjacency->interior_count; f++)
        if (bench->grain[adjacency->facet_elements[2 * f]] != bench->grain[adjacency->facet_elements[2 * f + 1]])
            bench->facets[bench->facet_count++] = f;
    return bench->facet_count;
}

static ShvStatus build(Bench *bench, int32_t wanted, ShvError *error)
{
    SHV_TRY(shv_model_build(&bench->model, NULL, &bench->scene, NULL, error));
    SHV_TRY(shv_state_create(&bench->state, &bench->model, &bench->scene, error));
    SHV_TRY(shv_solid_create(&bench->solid, &bench->model, &bench->state, error));
    SHV_TRY(shv_cohesive_create(&bench->cohesive, &bench->model, &bench->scene.fracture, error));
    bench->grain = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)bench->state.element_count, sizeof *bench->grain);
    bench->facets =
        shv_allocate(NULL, SHV_PART_GENERAL, (size_t)bench->model.adjacency.interior_count, sizeof *bench->facets);
    if (!bench->grain || !bench->facets) return shv_fail_memory(error, "grains", 0);
    int32_t seeds = 2;
    while (find_boundary(bench, seeds) < wanted && seeds < MOST_SEEDS) seeds += 1 + seeds / 8;
    int32_t duplicated;
    return shv_cohesive_insert(&bench->cohesive, &bench->state, NULL, bench->facets, bench->facet_count, &duplicated,
                               error);
}

/* Every grain with a velocity of its own, of a size that softens facets by about a tenth in a thousand steps. */
static void throw_grains(Bench *bench)
{
    for (int32_t e = 0; e < bench->state.element_count; e++)
        for (int a = 0; a < 4; a++)
            shv_store3(bench->state.velocity + 3 * (int64_t)shv_state_node(&bench->state, e, a),
                       shv_scale(random_vector(2, (uint64_t)bench->grain[e]), 2.0));
}

static void step_once(Bench *bench, double step)
{
    const int32_t threads = bench->model.threads;
    ShvLedger ledger = {0};
    double start = shv_now();
    shv_motion_clear_force(&bench->state, NULL, 0, threads);
    shv_solid_add_internal_force(&bench->solid, &bench->state);
    bench->force_time += shv_now() - start;
    start = shv_now();
    shv_cohesive_begin(&bench->cohesive, &bench->state, NULL);
    bench->cohesive_time += shv_now() - start;
    shv_motion_kick(&bench->state, NULL, 0, step, no_gravity, threads);
    start = shv_now();
    shv_cohesive_pull(&bench->cohesive, &bench->state, step, step);
    bench->sweeps += bench->cohesive.sweeps;
    shv_cohesive_close(&bench->cohesive, &bench->state, step, step);
    shv_cohesive_pull(&bench->cohesive, &bench->state, step, step);
    shv_cohesive_book(&bench->cohesive, &bench->state, step, &ledger);
    bench->cohesive_time += shv_now() - start;
    bench->points += bench->cohesive.point_count;
    shv_motion_drift(&bench->state, NULL, 0, step, threads);
    bench->state.last_step = step;
    bench->state.time += step;
}

static void print_figures(const Bench *bench, int32_t steps)
{
    const ShvCohesiveEnergy energy = shv_cohesive_energy(&bench->cohesive, &bench->state);
    const size_t values = 3 * (size_t)bench->state.node_count;
    const double point = 1e9 * bench->cohesive_time / (double)bench->points;
    const double tet = 1e9 * bench->force_time / ((double)bench->state.element_count * steps);
    puts("facets,points,clusters,threads,ns a point and step,ns a tet and step,ratio,sweeps a cluster and step,"
         "dissipated [J],softened,hash");
    shv_print(stdout, "%d,%d,%d,%d,%.1f,%.2f,%.1f,%.2f,%.17g,%d,%016llx\n", (int)bench->facet_count,
              (int)bench->cohesive.point_count, (int)bench->cohesive.cluster_count, (int)bench->model.threads, point,
              tet, point / tet, (double)bench->sweeps / ((double)bench->cohesive.cluster_count * steps),
              energy.dissipated, (int)energy.softened,
              (unsigned long long)shv_hash_bytes(0, bench->state.velocity, values * sizeof(double)));
}

static void release(Bench *bench)
{
    shv_release(bench->grain);
    shv_release(bench->facets);
    shv_cohesive_release(&bench->cohesive);
    shv_solid_release(&bench->solid);
    shv_state_release(&bench->state);
    shv_model_release(&bench->model);
}

int main(int argc, char **argv)
{
    const int32_t facets = argc > 1 ? atoi(argv[1]) : 20000, threads = argc > 2 ? atoi(argv[2]) : 1;
    const int32_t steps = argc > 3 ? atoi(argv[3]) : 100;
    if (facets < 10 || steps < 1) {
        fputs("bench_facets [FACETS [THREADS [STEPS]]]: FACETS must be at least 10, STEPS at least 1\n", stderr);
        return 2;
    }
    Bench bench = {0};
    ShvError error;
    define(&bench, 3.0 * facets, threads);
    const ShvStatus status = build(&bench, facets, &error);
    if (status == SHV_OK) {
        throw_grains(&bench);
        const double step = 0.5 * shv_solid_stable_step(&bench.solid, NULL);
        for (int32_t i = 0; i < steps; i++) step_once(&bench, step);
        print_figures(&bench, steps);
    } else {
        fprintf(stderr, "%s\n", error.message);
    }
    release(&bench);
    return status == SHV_OK ? 0 : 1;
}
