/* Largest stable step of bars on top of elasticity: bench_stable_step [STEPS]. What is stepped is what a scene in fracture mode
   steps: internal forces, kick, relaxation of the predicted positions; no contact, no cohesion, no gravity, no damping. The unit
   is the stable step that `shiver check` reports: the smallest 2/ω_max of any element.

   A step is called stable when, from small random velocities without rigid motion, the energy (kinetic and strain) stays below
   BOUND times its start and a straight line through its logarithm over the last third of STEPS (1500) grows by no more than the
   share GROWTH in that third. Multiples are tried upwards in steps of SCAN until one is not stable, and the limit is then halved
   down to RESOLUTION. Three more multiples beyond it are tried: where one of them is stable again, `stable_again` names it.

   CSV: a line for each mesh, Poisson's ratio, form, stiffness and number of iterations. Stiffness 0 is the mesh without bars;
   `over_mesh_limit` is in units of its limit, which lies above the smallest of the elements'.
   The lattice is what `box` makes. Cubes of six tets each, which no generator makes, are written to the working directory as
   TetGen files for a moment. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "base/text.h"
#include "hybrid/hybrid.h"

static const double BOUND = 100.0, GROWTH = 0.05, SCAN = 1.2, RESOLUTION = 1.02, MOST = 60.0;

typedef struct Setting {
    double stiffness;
    int32_t iterations;
} Setting;

typedef struct Body {
    const char *name;
    int32_t cubes[3]; /* 0: a lattice of size `edge` */
    double edge;
    double poissons_ratio;
} Body;

typedef struct Bench {
    ShvMaterialDefinition material;
    ShvObjectDefinition object;
    ShvSceneDefinition scene;
    ShvHybrid hybrid;
    double *start; /* velocities */
    double alone;  /* limit without bars, in stable steps */
    int32_t steps;
} Bench;

/* ---- meshes ---- */

static const char mesh_name[] = "bench_stable_step_mesh";

/* Six tets around the diagonal of every cube. */
static void print_cube(FILE *file, const int32_t cubes[3], const int32_t at[3], int64_t *number)
{
    static const int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int path = 0; path < 6; path++) {
        int32_t corner[3] = {at[0], at[1], at[2]}, tet[4];
        for (int k = 0; k < 4; k++) {
            tet[k] = (corner[2] * (cubes[1] + 1) + corner[1]) * (cubes[0] + 1) + corner[0];
            if (k < 3) corner[paths[path][k]]++;
        }
        const bool even = path < 3; /* the others are mirror images */
        shv_print(file, "%d %d %d %d %d\n", (int)(*number)++, (int)tet[0], (int)tet[1], (int)tet[even ? 2 : 3],
                  (int)tet[even ? 3 : 2]);
    }
}

static ShvStatus write_cubes(const int32_t cubes[3], double edge, ShvError *error)
{
    char path[64];
    snprintf(path, sizeof path, "%s.node", mesh_name);
    FILE *nodes = fopen(path, "w");
    snprintf(path, sizeof path, "%s.ele", mesh_name);
    FILE *tets = nodes ? fopen(path, "w") : NULL;
    if (!tets) {
        if (nodes) fclose(nodes);
        return shv_fail(error, SHV_FILE_ERROR, "%s cannot be written in the working directory", path);
    }
    shv_print(nodes, "%d 3 0 0\n", (int)((cubes[0] + 1) * (cubes[1] + 1) * (cubes[2] + 1)));
    shv_print(tets, "%d 4 0\n", (int)(6 * cubes[0] * cubes[1] * cubes[2]));
    int64_t node = 0, tet = 0;
    for (int32_t z = 0; z <= cubes[2]; z++)
        for (int32_t y = 0; y <= cubes[1]; y++)
            for (int32_t x = 0; x <= cubes[0]; x++) {
                shv_print(nodes, "%d %.17g %.17g %.17g\n", (int)node++, edge * x, edge * y, edge * z);
                if (x < cubes[0] && y < cubes[1] && z < cubes[2])
                    print_cube(tets, cubes, (const int32_t[3]){x, y, z}, &tet);
            }
    const bool written = fclose(nodes) == 0;
    return fclose(tets) == 0 && written ? SHV_OK : shv_fail(error, SHV_FILE_ERROR, "the mesh cannot be written");
}

static void remove_cubes(void)
{
    char path[64];
    snprintf(path, sizeof path, "%s.node", mesh_name);
    remove(path);
    snprintf(path, sizeof path, "%s.ele", mesh_name);
    remove(path);
}

static ShvStatus define_mesh(const Body *body, ShvMeshDefinition *mesh, ShvError *error)
{
    mesh->jitter = 0.1;
    mesh->size[0] = mesh->size[1] = 0.06;
    mesh->size[2] = 0.1;
    mesh->edge = body->edge;
    if (body->cubes[0] == 0) return SHV_OK;
    mesh->kind = SHV_MESH_TETGEN;
    mesh->file = mesh_name;
    return write_cubes(body->cubes, body->edge, error);
}

/* ---- a body that is awake, and random velocities without rigid motion ---- */

static ShvStatus wake(ShvHybrid *hybrid, ShvError *error)
{
    hybrid->backend->functions->remove(hybrid->backend, 0);
    SHV_TRY(shv_hybrid_wake(hybrid, &(ShvRigidContact){.obstacle = -1}, error));
    return shv_awake_refresh(hybrid, error);
}

static ShvStatus draw_start(Bench *bench, ShvError *error)
{
    ShvHybrid *hybrid = &bench->hybrid;
    ShvState *state = &hybrid->state;
    const int64_t count = 3 * (int64_t)state->node_count;
    bench->start = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)count, sizeof(double));
    if (!bench->start) return shv_fail_memory(error, "velocities", (size_t)count * sizeof(double));
    for (int64_t i = 0; i < count; i++) state->velocity[i] = 1e-6 * (shv_random_uniform(3, (uint64_t)i) - 0.5);
    ShvFragment *fragment = &hybrid->fragments.items[0];
    shv_fragment_fit(fragment, &hybrid->fragments, state);
    for (int32_t i = 0; i < state->node_count; i++) {
        const ShvVec3 arm = shv_sub(shv_state_position(state, i), fragment->position);
        const ShvVec3 rigid = shv_add(fragment->velocity, shv_cross(fragment->angular_velocity, arm));
        shv_store3(bench->start + 3 * i, shv_sub(shv_load3(state->velocity + 3 * i), rigid));
    }
    return SHV_OK;
}

static ShvStatus build(Bench *bench, const Body *body, ShvBarForm form, ShvError *error)
{
    bench->material = shv_material_default();
    bench->material.name = "glass";
    bench->material.density = 2500.0;
    bench->material.youngs_modulus = 70e9;
    bench->material.poissons_ratio = body->poissons_ratio;
    bench->material.breakable = false;
    bench->object = shv_object_default();
    bench->object.name = "body";
    bench->object.material = "glass";
    bench->scene = shv_scene_default();
    bench->scene.materials = &bench->material;
    bench->scene.objects = &bench->object;
    bench->scene.material_count = bench->scene.object_count = 1;
    bench->scene.threads = 1;
    bench->scene.duration = 1.0;
    memset(bench->scene.gravity, 0, sizeof bench->scene.gravity);
    bench->scene.pbd.form = form;
    bench->scene.fracture.enabled = false;
    bench->scene.fracture.stabiliser = SHV_STABILISER_BARS;
    bench->scene.fracture.energy_bound = 1e300; /* what diverges is judged here */
    SHV_TRY(define_mesh(body, &bench->object.mesh, error));
    SHV_TRY(shv_hybrid_create(&bench->hybrid, NULL, &bench->scene, NULL, error));
    SHV_TRY(wake(&bench->hybrid, error));
    return draw_start(bench, error);
}

static void release(Bench *bench)
{
    if (bench->hybrid.scene) shv_hybrid_release(&bench->hybrid);
    shv_release(bench->start);
    remove_cubes();
}

/* ---- one run ---- */

static double energy(const ShvHybrid *hybrid)
{
    const ShvState *state = &hybrid->state;
    double sum = shv_solid_strain_energy(&hybrid->solid, state);
    for (int32_t i = 0; i < state->node_count; i++) {
        const ShvVec3 v = shv_load3(state->velocity + 3 * (int64_t)i);
        sum += 0.5 * state->mass[i] * shv_dot(v, v);
    }
    return sum;
}

static void restart(Bench *bench, const Setting *setting)
{
    ShvHybrid *hybrid = &bench->hybrid;
    const size_t bytes = 3 * (size_t)hybrid->state.node_count * sizeof(double);
    memset(hybrid->state.displacement, 0, bytes);
    memcpy(hybrid->state.velocity, bench->start, bytes);
    hybrid->state.time = hybrid->state.last_step = 0.0;
    hybrid->obstacle_time = 0.0;
    bench->scene.pbd.stiffness = setting->stiffness;
    bench->scene.pbd.iterations = setting->iterations;
}

/* Least squares of y over x, from sums. */
typedef struct Line {
    double n, x, y, xx, xy;
} Line;

static void line_add(Line *line, double x, double y)
{
    line->n += 1.0;
    line->x += x;
    line->y += y;
    line->xx += x * x;
    line->xy += x * y;
}

static double line_slope(const Line *line)
{
    return (line->n * line->xy - line->x * line->y) / (line->n * line->xx - line->x * line->x);
}

/* What has lost all but 1e-15 of its energy is stable: a mode that grows never falls below its share of the start. Rounding keeps
   some 1e-20 at long steps. */
static bool is_stable(Bench *bench, const Setting *setting, double multiple)
{
    enum { EVERY = 10 };
    ShvHybrid *hybrid = &bench->hybrid;
    restart(bench, setting);
    const double step = multiple * hybrid->stable_step, start = energy(hybrid);
    bench->scene.fracture.time_step = step;
    const int32_t third = bench->steps / 3;
    Line line = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (int32_t i = 1; i <= bench->steps; i++) {
        if (shv_hybrid_substep(hybrid, step, NULL) != SHV_OK) return false;
        if (i % EVERY != 0) continue;
        const double now = energy(hybrid) / start;
        if (!(now <= BOUND)) return false;
        if (now < 1e-15) return true;
        if (i > bench->steps - third) line_add(&line, i, log(now));
    }
    return line_slope(&line) * third <= log1p(GROWTH);
}

/* ---- one limit ---- */

static void measure(Bench *bench, const Body *body, ShvBarForm form, const Setting *setting)
{
    double low = 0.0, high = 0.8 * SCAN;
    while (high < MOST && is_stable(bench, setting, high)) {
        low = high;
        high *= SCAN;
    }
    const double failed = high;
    while (low > 0.0 && high < MOST && high > RESOLUTION * low) {
        const double middle = sqrt(low * high);
        *(is_stable(bench, setting, middle) ? &low : &high) = middle;
    }
    double again = 0.0;
    for (double beyond = failed * SCAN; beyond < failed * 1.8; beyond *= SCAN)
        if (is_stable(bench, setting, beyond)) again = beyond;
    if (setting->stiffness == 0.0) bench->alone = low;
    const ShvHybrid *hybrid = &bench->hybrid;
    shv_print(stdout, "%s,%d,%d,%g,%s,%g,%d,%.2f,%.2f,%.2f,", body->name, (int)hybrid->state.node_count,
              (int)hybrid->state.element_count, body->poissons_ratio, form == SHV_BARS_EDGE ? "edge" : "element",
              setting->stiffness, (int)setting->iterations, low, high, low / bench->alone);
    if (again > 0.0) shv_print(stdout, "%.2f", again);
    fputs("\n", stdout);
    fflush(stdout);
}

static ShvStatus measure_all(const Body *body, ShvBarForm form, const Setting *settings, int count, int32_t steps,
                             ShvError *error)
{
    Bench bench = {.steps = steps};
    const ShvStatus status = build(&bench, body, form, error);
    for (int i = 0; i < count && status == SHV_OK; i++) measure(&bench, body, form, &settings[i]);
    release(&bench);
    return status;
}

int main(int argc, char **argv)
{
    static const Setting settings[] = {{0.0, 1}, {1.0, 1},  {1.0, 2}, {1.0, 4},  {1.0, 10},
                                       {0.9, 3}, {0.1, 10}, {0.5, 4}, {0.5, 10}, {1.0, 20}};
    static const Body bodies[] = {{"cubes", {3, 3, 6}, 0.02, 0.24},
                                  {"cubes", {6, 6, 10}, 0.01, 0.24},
                                  {"lattice", {0, 0, 0}, 0.0118, 0.24},
                                  {"cubes", {6, 6, 10}, 0.01, 0.0},
                                  {"cubes", {6, 6, 10}, 0.01, 0.45}};
    enum { SETTINGS = sizeof settings / sizeof settings[0], BODIES = sizeof bodies / sizeof bodies[0] };
    const int32_t steps = argc > 1 ? atoi(argv[1]) : 1500;
    if (steps < 90) {
        fputs("bench_stable_step [STEPS]: STEPS must be at least 90\n", stderr);
        return 2;
    }
    puts("mesh,nodes,tets,poissons_ratio,form,stiffness,iterations,stable_up_to,unstable_from,over_mesh_limit,stable_"
         "again");
    ShvError error;
    for (int b = 0; b < BODIES; b++)
        for (int form = 0; form < 2; form++) {
            /* Twenty sweeps are slow, and Poisson's ratio is of interest where it matters. */
            const int count = b == 0 ? SETTINGS : b < 3 ? SETTINGS - (form == 1) : 5 - (form == 1);
            if (measure_all(&bodies[b], form ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, settings, count, steps, &error) ==
                SHV_OK)
                continue;
            fprintf(stderr, "%s\n", error.message);
            return 1;
        }
    return 0;
}
