#include "check.h"

#include <hdf5.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/vector.h"
#include "crash.h"
#include "fake_simulation.h"
#include "files.h"
#include "shiver/run_file.h"

static const FakeSetup BREAKING = {.bricks = 8, .split_every = 2, .most = 15, .splits = 1};

static ShvRecordDefinition define(const char *path)
{
    static const char *const overrides[] = {"duration=2", "output.rate=60"};
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    definition.scene_name = "a wall";
    definition.scene_text = "shiver: 1\nname: ä wall\n";
    definition.overrides = overrides;
    definition.override_count = 2;
    definition.scene_hash = UINT64_C(0xfedcba9876543210);
    definition.threads = 3;
    return definition;
}

/* Records `frames` frames of a new simulation. */
static void record_frames(const ShvRecordDefinition *definition, const FakeSetup *setup, int frames, ShvStatus end,
                          const char *message)
{
    ShvError error;
    ShvRecord *record;
    ShvSimulation *simulation = fake_create(setup);
    check_ok(shv_record_create(&record, definition, simulation, &error), error);
    for (int i = 0; i < frames; i++) {
        fake_advance(simulation);
        check_ok(shv_record_frame(record, simulation, &error), error);
    }
    check_ok(shv_record_close(record, end, message, &error), error);
    fake_destroy(simulation);
}

static void check_head(const ShvRunFile *file)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    assert_int_equal(info->format, SHV_RUN_FILE_FORMAT);
    assert_string_equal(info->code_version, SHIVER_VERSION);
    assert_string_equal(info->status, "interrupted");
    assert_string_equal(info->message, "stopped by the user");
    assert_string_equal(info->scene_name, "a wall");
    assert_string_equal(info->scene_text, "shiver: 1\nname: ä wall\n");
    assert_string_equal(info->overrides, "duration=2\noutput.rate=60\n");
    assert_true(info->scene_hash == UINT64_C(0xfedcba9876543210));
    assert_string_equal(info->rigid_engine, "pbd");
    assert_int_equal(info->threads, 3);
    assert_true(strlen(info->processor) > 0);
    assert_int_equal(info->node_count, 40);
    assert_int_equal(info->element_count, 16);
    assert_int_equal(info->object_count, 1);
    assert_int_equal(info->obstacle_count, 2);
    assert_string_equal(shv_run_file_object_name(file, 0), "wall");
    assert_int_equal(shv_run_file_material_count(file), 2);
    const ShvMaterialView glass = shv_run_file_material(file, 0), steel = shv_run_file_material(file, 1);
    assert_string_equal(glass.name, "glass");
    assert_true(glass.breakable && !steel.breakable);
    assert_int_equal(glass.unresolved, SHV_UNRESOLVED_SCALE_STRENGTH);
    assert_int_equal(steel.unresolved, SHV_UNRESOLVED_KEEP);
    assert_true(glass.youngs_modulus == 70e9 && glass.poissons_ratio == 0.2);
    assert_true(glass.mesh_edge == 3e-3 && glass.zone_edges == 5.0 && glass.resolved_edge == 2.9e-5);
    assert_true(glass.nominal_strength == 40e6 && glass.strength == 4e6 && glass.nominal_energy == 8.0);
    assert_true(glass.energy == 8.0 && glass.cohesive_zone == 0.015 && glass.snap_back == 0.07);
    assert_true(glass.tip_toughness == 1.0 && isinf(steel.cohesive_zone));
    assert_string_equal(shv_run_file_object_name(file, 1), "");
    assert_string_equal(shv_run_file_object(file, 0).material, "glass");
    assert_int_equal(shv_run_file_object(file, 0).element_end, 16);
    assert_int_equal(shv_run_file_object(file, 0).node_end, 40);
}

/* Frame by frame beside the same simulation run again: every number has the same bits. */
static void check_frame(ShvRunFile *file, int64_t index, const ShvFrameView *frame)
{
    ShvError error;
    double time, position[45], orientation[60], velocity[45], angular[45];
    int32_t mode;
    uint8_t alive[15];
    check_ok(shv_run_file_frame(file, index, &time, &mode, alive, position, orientation, velocity, angular, &error),
             error);
    assert_true(time == frame->time && shv_run_file_times(file)[index] == time);
    assert_int_equal(mode, frame->fracture);
    assert_int_equal(shv_run_file_animation(file)[index], frame->animation);
    for (int32_t i = 0; i < shv_run_file_info(file)->fragment_count; i++) {
        const bool lives = i < frame->fragment_count && frame->fragments[i].mode != SHV_FRAGMENT_DEAD;
        assert_int_equal(alive[i], lives);
        if (!lives) {
            assert_true(isnan(position[3 * i]) && isnan(orientation[4 * i + 3]) && isnan(velocity[3 * i + 2]) &&
                        isnan(angular[3 * i + 1]));
            continue;
        }
        assert_memory_equal(position + 3 * i, frame->fragments[i].position, 24);
        assert_memory_equal(orientation + 4 * i, frame->fragments[i].orientation, 32);
        assert_memory_equal(velocity + 3 * i, frame->fragments[i].velocity, 24);
        assert_memory_equal(angular + 3 * i, frame->fragments[i].angular_velocity, 24);
    }
}

static void check_rest_of_frame(ShvRunFile *file, int64_t index, const ShvFrameView *frame)
{
    ShvError error;
    ShvLedgerView ledger;
    ShvProgressView progress;
    ShvObstacleView obstacles[2];
    check_ok(shv_run_file_ledger(file, index, &ledger, &error), error);
    assert_memory_equal(&ledger, &frame->ledger, sizeof ledger);
    check_ok(shv_run_file_progress(file, index, &progress, &error), error);
    assert_int_equal(progress.steps, frame->steps);
    assert_int_equal(progress.alive, frame->alive_count);
    assert_int_equal(progress.inserted, frame->inserted);
    assert_true(progress.step == frame->step && progress.courant == frame->courant);
    check_ok(shv_run_file_obstacles(file, index, obstacles, &error), error);
    for (int i = 0; i < 2; i++) {
        assert_string_equal(obstacles[i].name, frame->obstacles[i].name);
        assert_memory_equal(obstacles[i].position, frame->obstacles[i].position, 13 * sizeof(double));
    }
}

static void check_events(ShvRunFile *file, int64_t *next, const ShvFrameView *frame)
{
    ShvError error;
    for (int32_t i = 0; i < frame->event_count; i++) {
        ShvEventView event;
        const ShvEventView *expected = &frame->events[i];
        check_ok(shv_run_file_event(file, (*next)++, &event, &error), error);
        assert_true(event.time == expected->time && event.value == expected->value);
        assert_int_equal(event.kind, expected->kind);
        assert_int_equal(event.fragment, expected->fragment);
        assert_int_equal(event.obstacle, expected->obstacle);
        assert_memory_equal(&event.kinetic_before, &expected->kinetic_before, 16 * sizeof(double));
        assert_int_equal(event.reason, expected->reason);
        assert_int_equal(event.hulls, expected->hulls);
        assert_memory_equal(&event.mass, &expected->mass, 10 * sizeof(double));
    }
}

static void check_genealogy(ShvRunFile *file, const ShvFrameView *last)
{
    ShvError error;
    ShvFragmentView fragments[15];
    assert_int_equal(shv_run_file_info(file)->fragment_count, last->fragment_count);
    check_ok(shv_run_file_fragments(file, fragments, &error), error);
    for (int32_t i = 0; i < last->fragment_count; i++) {
        const ShvFragmentView *a = &fragments[i], *b = &last->fragments[i];
        assert_int_equal(a->id, i);
        assert_int_equal(a->parent, b->parent);
        assert_int_equal(a->object, b->object);
        assert_int_equal(a->tets, b->tets);
        assert_int_equal(a->mode, b->mode);
        assert_memory_equal(&a->birth, &b->birth, 2 * sizeof(double));
        assert_memory_equal(&a->mass, &b->mass, 11 * sizeof(double));
        if (b->mode != SHV_FRAGMENT_DEAD) assert_memory_equal(a->position, b->position, 13 * sizeof(double));
    }
}

static void check_mesh(ShvRunFile *file, const ShvSimulation *simulation)
{
    ShvError error;
    double positions[120];
    int32_t elements[64], owner[16], expected[16];
    uint16_t object[16];
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    check_ok(shv_run_file_mesh(file, positions, elements, object, owner, &error), error);
    shv_simulation_element_state(simulation, expected, NULL);
    assert_memory_equal(positions, mesh.positions, sizeof positions);
    assert_memory_equal(elements, mesh.elements, sizeof elements);
    assert_memory_equal(owner, expected, sizeof owner);
    for (int i = 0; i < 16; i++) assert_int_equal(object[i], 0);
}

static void test_everything_comes_back(void **state)
{
    const char *path = file_in(*state, "run.h5");
    ShvError error;
    enum { FRAMES = 150 }; /* more than two chunks of rows */
    const ShvRecordDefinition definition = define(path);
    record_frames(&definition, &BREAKING, FRAMES, SHV_INTERRUPTED, "stopped by the user");
    ShvMemory *memory = shv_memory_create();
    ShvRunFile *file;
    check_ok(shv_run_file_open(&file, path, memory, &error), error);
    check_head(file);
    assert_int_equal(shv_run_file_info(file)->frame_count, FRAMES);
    ShvSimulation *again = fake_create(&BREAKING);
    int64_t events = 0;
    for (int i = 0; i < FRAMES; i++) {
        fake_advance(again);
        check_frame(file, i, shv_simulation_frame(again));
        check_rest_of_frame(file, i, shv_simulation_frame(again));
        check_events(file, &events, shv_simulation_frame(again));
    }
    assert_int_equal(shv_run_file_info(file)->event_count, events);
    assert_int_equal(events, 7);
    check_genealogy(file, shv_simulation_frame(again));
    check_mesh(file, again);
    fake_destroy(again);
    check_fails(shv_run_file_ledger(file, FRAMES, &(ShvLedgerView){0}, &error), SHV_BAD_INPUT, error, "no frame 150");
    check_fails(shv_run_file_event(file, 7, &(ShvEventView){0}, &error), SHV_BAD_INPUT, error, "no event 7");
    check_fails(shv_run_file_corners(file, 0, NULL, NULL, NULL, &error), SHV_UNSUPPORTED, error, "output.nodes");
    shv_run_file_close(file);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(memory);
}

static void test_cost_is_of_the_last_frame(void **state)
{
    const char *path = file_in(*state, "run.h5");
    ShvError error;
    const ShvRecordDefinition definition = define(path);
    record_frames(&definition, &BREAKING, 5, SHV_OK, NULL);
    ShvRunFile *file;
    const ShvCostView *costs;
    const ShvBytesView *bytes;
    int32_t cost_count, bytes_count;
    check_ok(shv_run_file_open(&file, path, NULL, &error), error);
    assert_string_equal(shv_run_file_info(file)->status, "finished");
    assert_true(shv_run_file_info(file)->wall_seconds > 0.0 && shv_run_file_info(file)->wall_seconds < 100.0);
    for (int i = 0; i < 2; i++)
        check_ok(shv_run_file_cost(file, &costs, &cost_count, &bytes, &bytes_count, &error), error);
    assert_int_equal(cost_count, 2);
    assert_string_equal(costs[1].name, "stress");
    assert_true(costs[1].seconds == 0.5);
    assert_int_equal(costs[0].calls, 40);
    double wall, seconds[2];
    check_ok(shv_run_file_cost_at(file, 3, &wall, seconds, &error), error);
    assert_true(seconds[0] == 0.75 && seconds[1] == 0.375);
    assert_true(wall > 0.0 && wall <= shv_run_file_info(file)->wall_seconds);
    check_fails(shv_run_file_cost_at(file, 99, &wall, NULL, &error), SHV_BAD_INPUT, error, "99");
    assert_int_equal(bytes_count, 2);
    assert_string_equal(bytes[1].name, "state");
    assert_int_equal(bytes[1].bytes, 104);
    assert_int_equal(bytes[0].peak, 2000);
    shv_run_file_close(file);
}

enum { NODE_TETS = 16 };

/* Corners of a frame as they are read, and as the next frame of the simulation has them; damage and owners must be the same. */
static void read_next(ShvRunFile *file, int frame, ShvSimulation *again, double corners[12 * NODE_TETS],
                      double expected[12 * NODE_TETS], int32_t owner[NODE_TETS])
{
    double damage[4 * NODE_TETS], expected_damage[4 * NODE_TETS];
    int32_t expected_owner[NODE_TETS];
    ShvError error;
    fake_advance(again);
    shv_simulation_corner_positions(again, expected);
    shv_simulation_element_state(again, expected_owner, expected_damage);
    check_ok(shv_run_file_corners(file, frame, corners, damage, owner, &error), error);
    assert_memory_equal(damage, expected_damage, sizeof damage); /* quarters: exact in single precision too */
    assert_memory_equal(owner, expected_owner, sizeof expected_owner);
}

static void test_nodes(void **state)
{
    const char *path = file_in(*state, "run.h5");
    ShvError error;
    ShvRecordDefinition definition = define(path);
    definition.nodes = true;
    record_frames(&definition, &BREAKING, 5, SHV_OK, NULL);
    ShvRunFile *file;
    check_ok(shv_run_file_open(&file, path, NULL, &error), error);
    assert_true(shv_run_file_info(file)->nodes);
    ShvSimulation *again = fake_create(&BREAKING);
    for (int i = 0; i < 5; i++) {
        double corners[12 * NODE_TETS], expected[12 * NODE_TETS];
        int32_t owner[NODE_TETS];
        read_next(file, i, again, corners, expected, owner);
        assert_memory_equal(corners, expected, sizeof corners);
    }
    fake_destroy(again);
    shv_run_file_close(file);
}

/* Frames 2 and 3, and the tets of the first two bricks: others are in their fragment's pose. */
static void test_nodes_within(void **state)
{
    const char *path = file_in(*state, "run.h5");
    ShvError error;
    ShvNodesWithin within = shv_scene_default().output.nodes_within;
    within.from = 2.0 / 240.0;
    within.to = 3.0 / 240.0;
    within.box.box_max[0] = 1.5;
    FakeSetup setup = BREAKING;
    setup.within = &within;
    ShvRecordDefinition definition = define(path);
    definition.nodes = true;
    record_frames(&definition, &setup, 5, SHV_OK, NULL);
    ShvRunFile *file;
    check_ok(shv_run_file_open(&file, path, NULL, &error), error);
    check_ok(shv_run_file_verify(file, &error), error);
    ShvSimulation *again = fake_create(&setup);
    const ShvMeshView mesh = shv_simulation_mesh(again);
    for (int i = 0; i < 5; i++) {
        double corners[12 * NODE_TETS], expected[12 * NODE_TETS];
        int32_t owner[NODE_TETS];
        read_next(file, i, again, corners, expected, owner);
        for (int k = 0; k < 64; k++) {
            const ShvFragmentView *fragment = &shv_simulation_frame(again)->fragments[owner[k / 4]];
            const double *q = fragment->orientation;
            const ShvVec3 arm =
                shv_sub(shv_load3(mesh.positions + 3 * mesh.elements[k]), shv_load3(fragment->reference_centre));
            const ShvVec3 posed =
                shv_add(shv_load3(fragment->position), shv_rotate((ShvQuat){q[0], q[1], q[2], q[3]}, arm));
            const bool chosen = (i == 2 || i == 3) && k < 16;
            double wanted[3];
            shv_store3(wanted, chosen ? shv_load3(expected + 3 * (int64_t)k) : posed);
            for (int axis = 0; axis < 3; axis++) check_near(corners[3 * k + axis], wanted[axis], 1e-14);
        }
    }
    fake_destroy(again);
    shv_run_file_close(file);
    within.box.box_min[0] = within.box.box_max[0] = 100.0;
    definition.force = true;
    ShvSimulation *nowhere = fake_create(&setup);
    ShvRecord *record;
    check_fails(shv_record_create(&record, &definition, nowhere, &error), SHV_BAD_INPUT, error, "output.nodes_within");
    fake_destroy(nowhere);
}

static void test_obstacles(void **state)
{
    const char *path = file_in(*state, "run.h5");
    ShvError error;
    ShvObstacleBody body;
    const ShvRecordDefinition definition = define(path);
    record_frames(&definition, &BREAKING, 2, SHV_OK, NULL);
    ShvRunFile *file;
    check_ok(shv_run_file_open(&file, path, NULL, &error), error);
    check_ok(shv_run_file_obstacle(file, 0, &body, &error), error);
    assert_string_equal(body.name, "floor");
    assert_true(body.shape == SHV_OBSTACLE_PLANE && body.motion == SHV_OBSTACLE_FIXED && isinf(body.mass));
    assert_true(body.normal[2] == 1.0 && body.node_count == 0 && body.triangle_count == 0);
    check_ok(shv_run_file_obstacle(file, 1, &body, &error), error);
    assert_string_equal(body.name, "hammer");
    assert_true(body.shape == SHV_OBSTACLE_MESH && body.motion == SHV_OBSTACLE_FREE);
    assert_true(body.mass == 2.5 && body.friction == 0.25 && body.node_count == 4 && body.triangle_count == 4);
    const ShvObstacleBody wanted = shv_simulation_obstacle(NULL, 1);
    assert_memory_equal(body.positions, wanted.positions, 12 * sizeof(double));
    assert_memory_equal(body.triangles, wanted.triangles, 12 * sizeof(int32_t));
    check_fails(shv_run_file_obstacle(file, 2, &body, &error), SHV_BAD_INPUT, error, "no obstacle 2");
    shv_run_file_close(file);
}

/* Numbers that mean something have names in the file. */
static void test_names_of_numbers(void **state)
{
    const char *path = file_in(*state, "run.h5");
    const ShvRecordDefinition definition = define(path);
    record_frames(&definition, &BREAKING, 4, SHV_OK, NULL);
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), events = H5Dopen2(file, "/events", H5P_DEFAULT);
    const hid_t type = H5Dget_type(events),
                kind = H5Tget_member_type(type, (unsigned)H5Tget_member_index(type, "kind"));
    assert_int_equal(H5Tget_class(kind), H5T_ENUM);
    int32_t value = -1;
    assert_true(H5Tenum_valueof(kind, "split", &value) >= 0);
    assert_int_equal(value, SHV_RUN_SPLIT);
    H5Tclose(kind);
    H5Tclose(type);
    H5Dclose(events);
    H5Fclose(file);
    assert_string_equal(shv_run_event_name(SHV_RUN_SPLIT), "split");
    assert_string_equal(shv_switch_reason_name(SHV_REASON_QUIET), "quiet");
}

/* The bricks' halves weigh the same: the left one has the lower tet and goes on in its parent's line. */
static void test_lineages(void **state)
{
    enum { FRAMES = 20 };
    const char *path = file_in(*state, "run.h5");
    ShvError error;
    const ShvRecordDefinition definition = define(path);
    record_frames(&definition, &BREAKING, FRAMES, SHV_OK, NULL);
    ShvRunFile *file;
    int32_t lines[64];
    ShvFragmentView fragments[64];
    check_ok(shv_run_file_open(&file, path, NULL, &error), error);
    const int32_t count = shv_run_file_info(file)->fragment_count;
    assert_in_range(count, 5, 64);
    check_ok(shv_run_file_lineages(file, lines, &error), error);
    check_ok(shv_run_file_fragments(file, fragments, &error), error);
    shv_run_file_close(file);
    for (int32_t i = 0; i < count; i++) {
        const int32_t parent = fragments[i].parent;
        const bool left = parent >= 0 && fragments[i - 1].parent != parent;
        assert_int_equal(lines[i], left ? lines[parent] : i);
    }
}

/* ---- names of files ---- */

static void test_probes(void **state)
{
    enum { PROBES = 2, TIMES = 5 };
    ShvError error;
    const FakeSetup setup = {.bricks = 2, .most = 1, .probes = PROBES};
    ShvRecordDefinition definition = define(file_in(*state, "run.h5"));
    record_frames(&definition, &setup, TIMES, SHV_OK, NULL);
    ShvRunFile *file;
    check_ok(shv_run_file_open(&file, definition.path, NULL, &error), error);
    const ShvRunFileInfo *info = shv_run_file_info(file);
    assert_int_equal(info->probe_count, PROBES);
    assert_int_equal(info->probe_row_count, 0 + 1 + 2 + 3 + 4);
    assert_string_equal(shv_run_file_probe_name(file, 0), "tip");
    assert_string_equal(shv_run_file_probe_name(file, 1), "floor_below");
    assert_string_equal(shv_run_file_probe_name(file, 2), "");
    double times[2];
    ShvProbeSample samples[2 * PROBES];
    check_ok(shv_run_file_probes(file, 7, 2, times, samples, &error), error); /* rows 1 and 2 of frame 4 */
    assert_true(times[0] == 4.01 && times[1] == 4.02);
    assert_true(samples[0].displacement[0] == 4100.0);
    assert_true(samples[1].velocity[1] == 4100.0 + 20.0 + 4.0);
    assert_true(samples[2].stress[5] == 4200.0 + 11.0);
    assert_true(samples[3].reaction[2] == 4200.0 + 20.0 + 17.0);
    check_ok(shv_run_file_probes(file, 6, 1, NULL, samples, &error), error);
    assert_true(isnan(samples[1].contact[0]) && samples[0].contact[0] == 4012.0);
    check_fails(shv_run_file_probes(file, 9, 2, times, samples, &error), SHV_BAD_INPUT, error, "rows 9 to 10");
    check_fails(shv_run_file_probes(file, -1, 1, times, samples, &error), SHV_BAD_INPUT, error, "10 rows");
    shv_run_file_close(file);
}

/* A run without probes has nothing of them. */
static void test_no_probes(void **state)
{
    ShvError error;
    ShvRecordDefinition definition = define(file_in(*state, "run.h5"));
    record_frames(&definition, &BREAKING, 3, SHV_OK, NULL);
    ShvRunFile *file;
    check_ok(shv_run_file_open(&file, definition.path, NULL, &error), error);
    assert_int_equal(shv_run_file_info(file)->probe_count, 0);
    assert_int_equal(shv_run_file_info(file)->probe_row_count, 0);
    check_ok(shv_run_file_probes(file, 0, 0, NULL, NULL, &error), error);
    shv_run_file_close(file);
    const hid_t raw = H5Fopen(definition.path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_int_equal(H5Lexists(raw, "/probes", H5P_DEFAULT), 0);
    H5Fclose(raw);
}

static void test_existing_file_is_kept_until_the_first_frame(void **state)
{
    const char *path = file_in(*state, "run.h5");
    ShvError error;
    ShvRecord *record;
    ShvRecordDefinition definition = define(path);
    ShvSimulation *simulation = fake_create(&BREAKING);
    write_file(path, "precious", 8);
    check_fails(shv_record_create(&record, &definition, simulation, &error), SHV_BAD_INPUT, error, "--force");
    assert_null(record);
    assert_int_equal(files_in(*state), 1);
    definition.force = true;
    check_ok(shv_record_create(&record, &definition, simulation, &error), error);
    assert_int_equal(file_size(path), 8);
    check_ok(shv_record_close(record, SHV_OK, NULL, &error), error); /* no frame: nothing happened */
    assert_int_equal(file_size(path), 8);
    assert_int_equal(files_in(*state), 1);
    record_frames(&definition, &BREAKING, 1, SHV_OK, NULL);
    assert_true(file_size(path) > 8);
    assert_int_equal(files_in(*state), 1);
    fake_destroy(simulation);
}

/* A file that appears between the start and the first frame is left alone too. */
static void test_file_that_appears_later_is_kept(void **state)
{
    const char *path = file_in(*state, "run.h5");
    ShvError error;
    ShvRecord *record;
    const ShvRecordDefinition definition = define(path);
    ShvSimulation *simulation = fake_create(&BREAKING);
    check_ok(shv_record_create(&record, &definition, simulation, &error), error);
    write_file(path, "precious", 8);
    fake_advance(simulation);
    check_fails(shv_record_frame(record, simulation, &error), SHV_BAD_INPUT, error, "--force");
    check_fails(shv_record_frame(record, simulation, &error), SHV_BAD_INPUT, error, "--force");
    check_ok(shv_record_close(record, SHV_BAD_INPUT, error.message, &error), error);
    assert_int_equal(file_size(path), 8);
    assert_int_equal(files_in(*state), 1);
    fake_destroy(simulation);
}

static void test_bad_names(void **state)
{
    ShvError error;
    ShvRecord *record;
    ShvSimulation *simulation = fake_create(&BREAKING);
    ShvRecordDefinition definition = define("");
    check_fails(shv_record_create(&record, &definition, simulation, &error), SHV_BAD_INPUT, error, "no name");
    definition.path = *state;
    check_fails(shv_record_create(&record, &definition, simulation, &error), SHV_BAD_INPUT, error,
                "not an ordinary file");
    definition.path = file_in(*state, "missing/run.h5");
    check_fails(shv_record_create(&record, &definition, simulation, &error), SHV_FILE_ERROR, error, "missing/run.h5");
    definition.cookie = 0;
    check_fails(shv_record_create(&record, &definition, simulation, &error), SHV_BAD_INPUT, error,
                "shv_record_default");
    assert_int_equal(files_in(*state), 0);
    fake_destroy(simulation);
}

/* Two runs of the same simulation give the same bytes but for the wall time: it is the only clock in the file. */
static void test_same_run_same_size(void **state)
{
    char first[512];
    strcpy(first, file_in(*state, "a.h5"));
    const char *second = file_in(*state, "b.h5");
    ShvRecordDefinition definition = define(first);
    record_frames(&definition, &BREAKING, 20, SHV_OK, NULL);
    definition.path = second;
    record_frames(&definition, &BREAKING, 20, SHV_OK, NULL);
    const long size = file_size(first);
    assert_int_equal(size, file_size(second));
    char *a = read_bytes(first), *b = read_bytes(second);
    long different = 0;
    for (long i = 0; i < size; i++) different += a[i] != b[i];
    assert_true(different <= 20 * (long)sizeof(double) + 4); /* and the checksum of their chunk */
    free(a);
    free(b);
}

/* ---- memory ---- */

static ShvStatus record_with(ShvMemory *memory, const char *path, ShvError *error)
{
    ShvRecord *record;
    ShvRecordDefinition definition = define(path);
    definition.memory = memory;
    definition.force = true;
    definition.nodes = true;
    ShvSimulation *simulation = fake_create(&BREAKING);
    ShvStatus status = shv_record_create(&record, &definition, simulation, error);
    for (int i = 0; i < 4 && status == SHV_OK; i++) {
        fake_advance(simulation);
        status = shv_record_frame(record, simulation, error);
    }
    ShvError closing;
    const ShvStatus closed = shv_record_close(record, status, "", &closing);
    if (status == SHV_OK) status = closed;
    if (closed != SHV_OK) *error = closing;
    fake_destroy(simulation);
    return status;
}

static ShvStatus read_with(ShvMemory *memory, const char *path, ShvError *error)
{
    ShvRunFile *file;
    ShvFragmentView fragments[15];
    ShvObstacleView obstacles[2];
    const ShvCostView *costs;
    const ShvBytesView *bytes;
    int32_t counts[2];
    ShvStatus status = shv_run_file_open(&file, path, memory, error);
    if (status == SHV_OK) status = shv_run_file_fragments(file, fragments, error);
    if (status == SHV_OK) status = shv_run_file_obstacles(file, 0, obstacles, error);
    if (status == SHV_OK) status = shv_run_file_cost(file, &costs, &counts[0], &bytes, &counts[1], error);
    shv_run_file_close(file);
    return status;
}

static void fail_one_by_one(const char *path, ShvStatus (*work)(ShvMemory *, const char *, ShvError *))
{
    ShvError error = {SHV_OK, ""};
    for (int64_t count = 0;; count++) {
        ShvMemory *memory = shv_memory_create();
        shv_memory_fail_after(memory, count);
        const ShvStatus status = work(memory, path, &error);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
        if (status == SHV_OK) {
            assert_true(count > 8);
            break;
        }
        assert_true(status == SHV_NO_MEMORY || status == SHV_FILE_ERROR);
        assert_true(strlen(error.message) > 0 && count < 1000);
    }
}

static void test_every_allocation_may_fail(void **state)
{
    const char *path = file_in(*state, "run.h5");
    fail_one_by_one(path, record_with);
    assert_int_equal(files_in(*state), 1);
    fail_one_by_one(path, read_with);
}

/* Early frames then lack some of the chunks that later ones have. */
static void test_more_fragments_than_a_chunk(void **state)
{
    enum { COUNT = 30, COLUMNS = 2048 };
    static const FakeSetup many = {.bricks = 1100, .split_every = 1, .most = 2199, .splits = 60};
    ShvError error;
    ShvRunFile *file;
    const char *path = file_in(*state, "run.h5");
    crash_expect(0);
    assert_int_equal(crash_frames(path, &many, COUNT, &error), SHV_OK);
    check_ok(shv_run_file_open(&file, path, NULL, &error), error);
    assert_true(shv_run_file_info(file)->fragment_count > COLUMNS);
    const char *wrong = crash_check_open(file, &many, COUNT);
    if (wrong) fail_msg("%s", wrong);
    shv_run_file_close(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_more_fragments_than_a_chunk, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_everything_comes_back, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_cost_is_of_the_last_frame, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_nodes, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_nodes_within, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_probes, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_no_probes, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_obstacles, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_names_of_numbers, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_lineages, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_existing_file_is_kept_until_the_first_frame, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_file_that_appears_later_is_kept, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_bad_names, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_same_run_same_size, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_every_allocation_may_fail, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
