/* Speed of position based bars: bench_bars [TETS]. One line of CSV for each form and 1 and 2 threads: nanoseconds for an
   edge and iteration, milliseconds to make all bars anew, and milliseconds to bring them up to date when one node has been
   duplicated. The best of several rounds counts: other work on the machine only ever slows it down. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/random.h"
#include "base/text.h"
#include "base/timer.h"
#include "pbd/bars.h"

enum { ROUNDS = 20, SWEEPS = 4 };

typedef struct Bench {
    ShvModel model;
    ShvState state;
    ShvBars bars;
    double *anchors, *shifts;
} Bench;

/* A jittered cube of about `tets` tets: a regular tet of edge h fills h³/8.5. */
static ShvStatus build_model(Bench *bench, double tets, int32_t threads, ShvError *error)
{
    ShvMaterialDefinition material = shv_material_default();
    material.name = "glass";
    material.density = 2500.0;
    material.youngs_modulus = 70e9;
    material.poissons_ratio = 0.22;
    material.breakable = true;
    material.fracture_energy = 8.0;
    material.cohesive_strength = 40e6;
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
    scene.fracture.enabled = true;
    SHV_TRY(shv_model_build(&bench->model, NULL, &scene, NULL, error));
    return shv_state_create(&bench->state, &bench->model, &scene, error);
}

static ShvStatus build(Bench *bench, ShvBarForm form, double tets, int32_t threads, ShvError *error)
{
    SHV_TRY(build_model(bench, tets, threads, error));
    SHV_TRY(shv_bars_create(&bench->bars, &bench->model, form, error));
    const size_t quads = 4 * (size_t)bench->state.node_count;
    bench->anchors = shv_allocate(NULL, SHV_PART_BARS, quads, sizeof(double));
    bench->shifts = shv_allocate(NULL, SHV_PART_BARS, quads, sizeof(double));
    if (!bench->anchors || !bench->shifts) return shv_fail_memory(error, "nodes", 2 * quads * sizeof(double));
    for (int64_t i = 0; i < bench->state.node_count; i++) {
        for (int c = 0; c < 3; c++) {
            bench->anchors[4 * i + c] = bench->state.reference[3 * i + c];
            bench->shifts[4 * i + c] = 1e-6 * shv_random_uniform(1, (uint64_t)(3 * i + c));
        }
        bench->anchors[4 * i + 3] = 1.0 / bench->state.mass[i];
    }
    return SHV_OK;
}

static double sweep_time(Bench *bench)
{
    double best = (double)INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        const double start = shv_now();
        for (int sweep = 0; sweep < SWEEPS; sweep++) shv_bars_sweep(&bench->bars, 0.9, bench->anchors, bench->shifts);
        best = fmin(best, shv_now() - start);
    }
    return best / SWEEPS;
}

/* All bars put to sleep and woken again. */
static ShvStatus rebuild_time(Bench *bench, double *best, ShvError *error)
{
    *best = (double)INFINITY;
    const uint8_t asleep = 0;
    for (int round = 0; round < 5; round++) {
        SHV_TRY(shv_bars_update(&bench->bars, &bench->state, &asleep, error));
        const double start = shv_now();
        SHV_TRY(shv_bars_update(&bench->bars, &bench->state, NULL, error));
        *best = fmin(*best, shv_now() - start);
    }
    return SHV_OK;
}

/* A copy of a middle node takes its first element. */
static ShvStatus duplicate(ShvState *state, ShvError *error)
{
    SHV_TRY(shv_state_reserve(state, (int64_t)state->node_count + 1, error));
    const int32_t copy = state->node_count++, origin = copy / 2;
    for (int c = 0; c < 3; c++) state->reference[3 * copy + c] = state->reference[3 * origin + c];
    state->origin[copy] = origin;
    const int32_t corner = state->corners[state->corner_start[origin]];
    state->connectivity[shv_corner_slot(corner / 4, corner % 4)] = copy;
    return SHV_OK;
}

static ShvStatus duplication_time(Bench *bench, double *best, ShvError *error)
{
    *best = (double)INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        SHV_TRY(duplicate(&bench->state, error));
        const double start = shv_now();
        SHV_TRY(shv_bars_update(&bench->bars, &bench->state, NULL, error));
        *best = fmin(*best, shv_now() - start);
    }
    return SHV_OK;
}

static ShvStatus measure(Bench *bench, ShvBarForm form, double tets, int32_t threads, ShvError *error)
{
    SHV_TRY(build(bench, form, tets, threads, error));
    double rebuild, duplication;
    SHV_TRY(rebuild_time(bench, &rebuild, error));
    const double sweep = sweep_time(bench), edges = (double)bench->bars.bar_count;
    SHV_TRY(duplication_time(bench, &duplication, error));
    shv_print(stdout, "%s,%d,%d,%d,%.0f,%.2f,%.2f,%.3f\n", form == SHV_BARS_EDGE ? "edge" : "element",
              (int)bench->state.element_count, (int)bench->model.mesh.node_count, (int)threads, edges,
              1e9 * sweep / edges, 1e3 * rebuild, 1e3 * duplication);
    return SHV_OK;
}

static void release(Bench *bench)
{
    shv_release(bench->anchors);
    shv_release(bench->shifts);
    shv_bars_release(&bench->bars);
    shv_state_release(&bench->state);
    shv_model_release(&bench->model);
}

int main(int argc, char **argv)
{
    const double tets = argc > 1 ? atof(argv[1]) : 200e3;
    if (!(tets >= 100.0)) {
        fputs("bench_bars [TETS]: TETS must be at least 100\n", stderr);
        return 2;
    }
    puts("form,tets,nodes,threads,edges_a_sweep,ns_per_edge,rebuild_ms,duplication_ms");
    for (int i = 0; i < 4; i++) {
        Bench bench = {0};
        ShvError error;
        const ShvStatus status = measure(&bench, i / 2 ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, tets, 1 + i % 2, &error);
        release(&bench);
        if (status == SHV_OK) continue;
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    return 0;
}
