#include "fake_simulation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { COSTS = 2, PARTS = 2, OBSTACLES = 2, EVENTS = 64, PROBES = 2, ROWS = 64 };

struct ShvSimulation {
    FakeSetup setup;
    int64_t frame_index;              /* −1 before the first frame */
    int32_t *brick_begin, *brick_end; /* of each fragment */
    ShvFragmentView *fragments;
    ShvObstacleView obstacles[OBSTACLES];
    ShvEventView events[EVENTS];
    ShvCostView costs[COSTS];
    ShvBytesView bytes[PARTS];
    double probe_times[ROWS];
    ShvProbeSample samples[ROWS * PROBES];
    double *positions;
    int32_t *elements;
    ShvObjectView object;
    ShvFrameView frame;
};

static const double STEP = 1.0 / 240.0;

static void make_mesh(ShvSimulation *simulation)
{
    const int32_t bricks = simulation->setup.bricks;
    simulation->positions = calloc((size_t)bricks * 15, sizeof(double));
    simulation->elements = calloc((size_t)bricks * 8, sizeof(int32_t));
    for (int32_t b = 0; b < bricks; b++) {
        const double corners[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
        const int32_t tets[8] = {0, 1, 2, 3, 1, 2, 3, 4};
        for (int k = 0; k < 15; k++) simulation->positions[15 * b + k] = corners[k] + (k % 3 == 0 ? b : 0);
        for (int k = 0; k < 8; k++) simulation->elements[8 * b + k] = tets[k] + 5 * b;
    }
    simulation->object = (ShvObjectView){"wall", "glass", 0, 2 * bricks, 0, 5 * bricks};
}

static void start_fragment(ShvSimulation *simulation, int32_t parent, int32_t begin, int32_t end, double birth)
{
    const int32_t id = simulation->frame.fragment_count++;
    simulation->brick_begin[id] = begin;
    simulation->brick_end[id] = end;
    simulation->fragments[id] = (ShvFragmentView){.id = id,
                                                  .parent = parent,
                                                  .birth = birth,
                                                  .death = (double)NAN,
                                                  .mode = SHV_FRAGMENT_FLIGHT,
                                                  .tets = 2 * (end - begin),
                                                  .mass = 2.5 * (end - begin),
                                                  .volume = 0.5 * (end - begin),
                                                  .inertia = {1, 2, 3, 0.1 * id, 0.2, 0.3},
                                                  .reference_centre = {0.5 * (begin + end), 0.5, 0.5}};
}

/* Where a fragment is: thrown from its reference centre at time 0 with a velocity of its own. */
static void move(ShvFragmentView *fragment, double time)
{
    const double i = fragment->id, angle = 0.5 * (1.0 + 0.01 * i) * time;
    const double velocity[3] = {0.1 * sin(i), 0.1 * cos(i), 3.0 + 0.01 * i};
    for (int k = 0; k < 3; k++) {
        fragment->position[k] = fragment->reference_centre[k] + velocity[k] * time;
        fragment->velocity[k] = velocity[k];
        fragment->orientation[k + 1] = sin(angle) / sqrt(3.0);
        fragment->angular_velocity[k] = (1.0 + 0.01 * i) / sqrt(3.0);
    }
    fragment->position[2] -= 4.905 * time * time;
    fragment->velocity[2] -= 9.81 * time;
    fragment->orientation[0] = cos(angle);
}

static void split_one(ShvSimulation *simulation, double time)
{
    ShvFrameView *frame = &simulation->frame;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        ShvFragmentView *fragment = &simulation->fragments[i];
        const int32_t begin = simulation->brick_begin[i], end = simulation->brick_end[i], middle = (begin + end) / 2;
        if (fragment->mode == SHV_FRAGMENT_DEAD || end - begin < 2) continue;
        if (frame->fragment_count + 2 > simulation->setup.most) return;
        fragment->mode = SHV_FRAGMENT_DEAD;
        fragment->death = time;
        start_fragment(simulation, i, begin, middle, time);
        start_fragment(simulation, i, middle, end, time);
        if (frame->event_count < EVENTS)
            simulation->events[frame->event_count++] = (ShvEventView){.time = time,
                                                                      .kind = SHV_RUN_SPLIT,
                                                                      .fragment = i,
                                                                      .obstacle = 1,
                                                                      .value = 2,
                                                                      .kinetic_before = 7,
                                                                      .momentum_after = {1, 2, 3},
                                                                      .angular_after = {4, 5, 6 + time},
                                                                      .reason = SHV_REASON_LONGEST,
                                                                      .hulls = 3,
                                                                      .mass = 8,
                                                                      .momentum_scale = 9,
                                                                      .angular_scale = 10,
                                                                      .cohesive_before = 11,
                                                                      .cohesive_after = 12,
                                                                      .dropped_vibration = 13,
                                                                      .dropped_strain = 14,
                                                                      .dropped_cohesive = 15,
                                                                      .hull_outside = 16,
                                                                      .hull_missing = 17 + time};
        return;
    }
}

ShvSimulation *fake_create(const FakeSetup *setup)
{
    ShvSimulation *simulation = calloc(1, sizeof *simulation);
    simulation->setup = *setup;
    simulation->frame_index = -1;
    simulation->brick_begin = calloc((size_t)setup->most, sizeof(int32_t));
    simulation->brick_end = calloc((size_t)setup->most, sizeof(int32_t));
    simulation->fragments = calloc((size_t)setup->most, sizeof(ShvFragmentView));
    make_mesh(simulation);
    return simulation;
}

void fake_destroy(ShvSimulation *simulation)
{
    free(simulation->brick_begin);
    free(simulation->brick_end);
    free(simulation->fragments);
    free(simulation->positions);
    free(simulation->elements);
    free(simulation);
}

/* Number k of probe p in row r of frame n is 1000 n + 100 r + 20 p + k; the last probe of the first row is unknown. */
static void fill_probes(ShvSimulation *simulation)
{
    static const ShvProbeView views[PROBES] = {{"tip", SHV_PROBE_POINT}, {"floor_below", SHV_PROBE_OBSTACLE}};
    ShvFrameView *frame = &simulation->frame;
    const int64_t n = simulation->frame_index, count = simulation->setup.probes;
    frame->probes = views;
    frame->probe_count = (int32_t)count;
    frame->probe_row_count = count > 0 && n < ROWS ? n : 0;
    frame->probe_times = simulation->probe_times;
    frame->probe_samples = simulation->samples;
    for (int64_t r = 0; r < frame->probe_row_count; r++) {
        simulation->probe_times[r] = (double)n + 0.01 * (double)r;
        for (int64_t p = 0; p < count; p++) {
            double values[SHV_PROBE_NUMBERS];
            const bool unknown = r == 0 && p == 1;
            for (int k = 0; k < SHV_PROBE_NUMBERS; k++)
                values[k] = unknown ? (double)NAN : (double)(1000 * n + 100 * r + 20 * p + k);
            memcpy(&simulation->samples[r * count + p], values, sizeof values);
        }
    }
}

static void fill_rest(ShvSimulation *simulation, double time)
{
    ShvFrameView *frame = &simulation->frame;
    const double n = (double)simulation->frame_index;
    frame->fragments = simulation->fragments;
    frame->obstacles = simulation->obstacles;
    frame->obstacle_count = OBSTACLES;
    frame->events = simulation->events;
    frame->costs = simulation->costs;
    frame->cost_count = COSTS;
    frame->bytes = simulation->bytes;
    frame->bytes_count = PARTS;
    simulation->obstacles[0] = (ShvObstacleView){"floor", {0, 0, 0}, {1, 0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    simulation->obstacles[1] = (ShvObstacleView){"hammer", {time, 2, 3}, {0, 1, 0, 0}, {1, 0, 0}, {0, 0, n}};
    simulation->costs[0] = (ShvCostView){"force", 0.25 * n, (int64_t)(10 * n)};
    simulation->costs[1] = (ShvCostView){"stress", 0.125 * n, (int64_t)n};
    simulation->bytes[0] = (ShvBytesView){"mesh", 1000, 2000};
    simulation->bytes[1] = (ShvBytesView){"state", (size_t)(100 + n), 5000};
    frame->ledger =
        (ShvLedgerView){.time = time, .kinetic = 100 - n, .strain = 0.5 * n, .momentum = {1, 2, n}, .largest = 100};
    fill_probes(simulation);
    frame->steps = 10 * simulation->frame_index;
    frame->step = 1e-7;
    frame->courant = 0.9;
    frame->inserted = (int32_t)n;
}

void fake_advance(ShvSimulation *simulation)
{
    ShvFrameView *frame = &simulation->frame;
    const int64_t index = ++simulation->frame_index;
    const double time = (double)index * STEP;
    const int32_t every = simulation->setup.split_every;
    frame->event_count = 0;
    if (index == 0) start_fragment(simulation, -1, 0, simulation->setup.bricks, 0.0);
    if (every > 0 && index > 0 && index % every == 0)
        for (int32_t i = 0; i < simulation->setup.splits; i++) split_one(simulation, time);
    frame->time = time;
    frame->animation = index % 2 == 0;
    frame->fracture = index % 3 == 1;
    frame->alive_count = 0;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        if (simulation->fragments[i].mode == SHV_FRAGMENT_DEAD) continue;
        simulation->fragments[i].mode = frame->fracture ? SHV_FRAGMENT_FRACTURE : SHV_FRAGMENT_FLIGHT;
        move(&simulation->fragments[i], time);
        frame->alive_count++;
    }
    fill_rest(simulation, time);
}

/* ---- checkpoints: the number of the frame, again and again so that writes have something to do ---- */

enum { SAVED = 4096 };

ShvStatus shv_simulation_save(ShvSimulation *simulation, int descriptor, uint64_t *size, uint32_t *checksum,
                              ShvError *error)
{
    int64_t numbers[SAVED];
    for (int i = 0; i < SAVED; i++) numbers[i] = simulation->frame_index + i;
    *size = sizeof numbers;
    *checksum = (uint32_t)crc32_z(0, (const unsigned char *)numbers, sizeof numbers);
    const off_t start = lseek(descriptor, 0, SEEK_CUR);
    if (pwrite(descriptor, numbers, sizeof numbers, start) == (ssize_t)sizeof numbers) return SHV_OK;
    return shv_fail(error, SHV_FILE_ERROR, "cannot write the state");
}

ShvStatus shv_simulation_load(ShvSimulation *simulation, int descriptor, uint64_t size, ShvError *error)
{
    int64_t numbers[SAVED];
    if (size != sizeof numbers || read(descriptor, numbers, sizeof numbers) != (ssize_t)sizeof numbers)
        return shv_fail(error, SHV_BAD_INPUT, "the state is not whole");
    while (simulation->frame_index < numbers[0]) fake_advance(simulation);
    return SHV_OK;
}

ShvNodesWithin shv_simulation_nodes_within(const ShvSimulation *simulation)
{
    return simulation->setup.within ? *simulation->setup.within : shv_scene_default().output.nodes_within;
}

const char *shv_simulation_rigid_engine(const ShvSimulation *simulation)
{
    (void)simulation;
    return "pbd";
}

uint64_t shv_simulation_geometry_hash(const ShvSimulation *simulation)
{
    return (uint64_t)simulation->setup.bricks;
}

ShvSimulationSummary shv_simulation_summary(const ShvSimulation *simulation)
{
    return (ShvSimulationSummary){.time = simulation->frame.time};
}

/* ---- what the run file asks of a simulation ---- */

const ShvFrameView *shv_simulation_frame(const ShvSimulation *simulation)
{
    return &simulation->frame;
}

ShvMeshView shv_simulation_mesh(const ShvSimulation *simulation)
{
    const int32_t bricks = simulation->setup.bricks;
    return (ShvMeshView){5 * bricks, 2 * bricks, simulation->positions, simulation->elements, &simulation->object, 1};
}

ShvObstacleBody shv_simulation_obstacle(const ShvSimulation *simulation, int32_t index)
{
    static const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const int32_t triangles[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    (void)simulation;
    if (index == 0)
        return (ShvObstacleBody){
            .name = "floor", .shape = SHV_OBSTACLE_PLANE, .normal = {0, 0, 1}, .mass = (double)INFINITY};
    return (ShvObstacleBody){.name = "hammer",
                             .shape = SHV_OBSTACLE_MESH,
                             .motion = SHV_OBSTACLE_FREE,
                             .mass = 2.5,
                             .friction = 0.25,
                             .positions = corners,
                             .triangles = triangles,
                             .node_count = 4,
                             .triangle_count = 4};
}

int32_t shv_simulation_material_count(const ShvSimulation *simulation)
{
    (void)simulation;
    return 2;
}

ShvMaterialView shv_simulation_material(const ShvSimulation *simulation, int32_t index)
{
    (void)simulation;
    if (index == 1) return (ShvMaterialView){.name = "steel", .cohesive_zone = (double)INFINITY};
    return (ShvMaterialView){.name = "glass",
                             .breakable = true,
                             .unresolved = SHV_UNRESOLVED_SCALE_STRENGTH,
                             .youngs_modulus = 70e9,
                             .poissons_ratio = 0.2,
                             .mesh_edge = 3e-3,
                             .zone_edges = 5.0,
                             .resolved_edge = 2.9e-5,
                             .nominal_strength = 40e6,
                             .strength = 4e6,
                             .nominal_energy = 8.0,
                             .energy = 8.0,
                             .cohesive_zone = 0.015,
                             .snap_back = 0.07,
                             .tip_toughness = 1.0};
}

const char *shv_unresolved_name(ShvUnresolved unresolved)
{
    static const char *const names[] = {"keep", "scale_strength", "scale_energy", "tip_strength"};
    return names[unresolved];
}

void shv_simulation_element_state(const ShvSimulation *simulation, int32_t *fragment, double *damage)
{
    for (int32_t i = 0; i < simulation->frame.fragment_count; i++) {
        if (simulation->fragments[i].mode == SHV_FRAGMENT_DEAD) continue;
        for (int32_t e = 2 * simulation->brick_begin[i]; e < 2 * simulation->brick_end[i]; e++) {
            if (fragment) fragment[e] = i;
            for (int k = 0; damage && k < 4; k++) damage[4 * e + k] = 0.25 * k;
        }
    }
}

void shv_simulation_bonds(const ShvSimulation *simulation, uint8_t *bonds)
{
    for (int32_t i = 0; i < 4 * simulation->object.element_end; i++) bonds[i] = i % 3 != 0;
}

void shv_simulation_corner_positions(const ShvSimulation *simulation, double *corners)
{
    for (int64_t i = 0; i < 8 * (int64_t)simulation->setup.bricks; i++)
        for (int k = 0; k < 3; k++)
            corners[3 * i + k] = simulation->positions[3 * simulation->elements[i] + k] + simulation->frame.time;
}
