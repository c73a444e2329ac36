/* Speed of the explicit step without cracks: bench_step [TETS [THREADS]]. One line of CSV for each kinematics, without and with smoothed edges, in
   million tets a second: internal force alone, element stress alone, and the whole step (clear, force, kick, drift).
   The best of several rounds counts: other work on the machine only ever slows it down. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/random.h"
#include "base/text.h"
#include "base/timer.h"
#include "solid/motion.h"
#include "solid/solid.h"

enum { ROUNDS = 30, CALLS = 5 };

typedef struct Bench {
    ShvModel model;
    ShvState state;
    ShvSolid solid;
    double *stress;
    double step;
} Bench;

typedef void (*Work)(Bench *bench);

static void add_force(Bench *bench)
{
    shv_solid_add_internal_force(&bench->solid, &bench->state);
}

static void find_stress(Bench *bench)
{
    shv_solid_stress(&bench->solid, &bench->state, bench->stress);
}

static void whole_step(Bench *bench)
{
    static const double gravity[3] = {0.0, 0.0, -9.81};
    const int32_t threads = bench->model.threads;
    shv_motion_clear_force(&bench->state, NULL, 0, threads);
    shv_solid_add_internal_force(&bench->solid, &bench->state);
    shv_motion_kick(&bench->state, NULL, 0, bench->step, gravity, threads);
    shv_motion_drift(&bench->state, NULL, 0, bench->step, threads);
}

/* Million tets a second. */
static double speed(Bench *bench, Work work)
{
    double best = (double)INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        const double start = shv_now();
        for (int call = 0; call < CALLS; call++) work(bench);
        best = fmin(best, (shv_now() - start) / CALLS);
    }
    return 1e-6 * bench->state.element_count / best;
}

/* A jittered cube of glass of about `tets` tets: a regular tet of edge h fills h³/8.5. */
static ShvStatus build(Bench *bench, ShvKinematics kinematics, ShvSmoothing smoothing, double tets, int32_t threads,
                       ShvError *error)
{
    ShvMaterialDefinition material = shv_material_default();
    material.name = "glass";
    material.density = 2500.0;
    material.youngs_modulus = 70e9;
    material.poissons_ratio = 0.22;
    material.breakable = false;
    material.kinematics = kinematics;
    material.smoothing = smoothing;
    ShvObjectDefinition object = shv_object_default();
    object.name = "cube";
    object.material = "glass";
    object.mesh.size[0] = object.mesh.size[1] = object.mesh.size[2] = 0.1;
    object.mesh.edge = 0.1 * cbrt(8.5 / tets);
    object.mesh.jitter = 0.1;
    ShvSceneDefinition scene = shv_scene_default();
    scene.materials = &material;
    scene.objects = &object;
    scene.material_count = scene.object_count = 1;
    scene.threads = threads;
    SHV_TRY(shv_model_build(&bench->model, NULL, &scene, NULL, error));
    SHV_TRY(shv_state_create(&bench->state, &bench->model, &scene, error));
    SHV_TRY(shv_solid_create(&bench->solid, &bench->model, &bench->state, error));
    const size_t count = 6 * SHV_LANES * (size_t)bench->state.batch_count;
    bench->stress = shv_allocate(NULL, SHV_PART_STRESS, count, sizeof *bench->stress);
    if (!bench->stress) return shv_fail_memory(error, "stress", count * sizeof *bench->stress);
    bench->step = 0.5 * shv_solid_stable_step(&bench->solid, NULL);
    for (int64_t i = 0; i < 3 * (int64_t)bench->state.node_count; i++)
        bench->state.displacement[i] = 1e-4 * object.mesh.edge * shv_random_uniform(1, (uint64_t)i);
    return SHV_OK;
}

static void release(Bench *bench)
{
    shv_release(bench->stress);
    shv_solid_release(&bench->solid);
    shv_state_release(&bench->state);
    shv_model_release(&bench->model);
}

static ShvStatus measure(ShvKinematics kinematics, ShvSmoothing smoothing, double tets, int32_t threads,
                         ShvError *error)
{
    Bench bench = {0};
    const ShvStatus status = build(&bench, kinematics, smoothing, tets, threads, error);
    if (status == SHV_OK) {
        const double force = speed(&bench, add_force), stress = speed(&bench, find_stress);
        const double step = speed(&bench, whole_step);
        shv_print(stdout, "%s,%s,%d,%d,%d,%.2f,%.2f,%.2f\n", kinematics == SHV_GREEN_STRAIN ? "green" : "corotational",
                  smoothing == SHV_SMOOTHING_EDGES ? "edges" : "none", (int)bench.state.element_count,
                  (int)bench.state.node_count, (int)bench.model.threads, force, stress, step);
    }
    release(&bench);
    return status;
}

int main(int argc, char **argv)
{
    const double tets = argc > 1 ? atof(argv[1]) : 200e3;
    const int32_t threads = argc > 2 ? atoi(argv[2]) : 1;
    if (!(tets >= 100.0)) {
        fputs("bench_step [TETS [THREADS]]: TETS must be at least 100\n", stderr);
        return 2;
    }
    ShvError error;
    puts("kinematics,smoothing,tets,nodes,threads,force_mtets_per_s,stress_mtets_per_s,step_mtets_per_s");
    for (int i = 0; i < 4; i++)
        if (measure(i % 2 ? SHV_COROTATIONAL : SHV_GREEN_STRAIN, i / 2 ? SHV_SMOOTHING_EDGES : SHV_SMOOTHING_NONE, tets,
                    threads, &error) != SHV_OK) {
            fprintf(stderr, "%s\n", error.message);
            return 1;
        }
    return 0;
}
