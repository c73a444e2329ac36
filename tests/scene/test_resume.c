/* Checkpoints: what goes on from one gives the bits of what never stopped, with every engine that has them. */
#include "check.h"

#include <stdlib.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "base/hash.h"
#include "base/memory.h"
#include "base/timer.h"
#include "shiver/scene.h"
#include "shiver/simulation.h"

enum { MOST_FRAMES = 1000, SAVES = 4 };

/* Two bodies that break each other, fly on and come down on a floor, beside a ball that nobody holds. */
static const char *const BREAKING =
    "shiver: 1\n"
    "materials: {plaster: {density: 1600, youngs_modulus: 3e8, poissons_ratio: 0.2, fracture_energy: 5, "
    "cohesive_strength: 1e6}}\n"
    "objects:\n"
    "  left: {mesh: {ball: {radius: 0.03, edge: 18 mm}, jitter: 0.1, seed: 1}, material: plaster, "
    "position: [-0.035, 0, 0.05], velocity: [4, 0, 0]}\n"
    "  right: {mesh: {ball: {radius: 0.03, edge: 18 mm}, jitter: 0.1, seed: 2}, material: plaster, "
    "position: [0.035, 0.01, 0.05], velocity: [-4, 0, 0]}\n"
    "obstacles:\n"
    "  floor: {plane: {normal: [0, 0, 1]}, friction: 0.4, restitution: 0.2}\n"
    "  free: {sphere: {radius: 0.02}, mass: 0.3, position: [0, -0.08, 0.021]}\n"
    "probes: {centre: {object: left, point: [-0.035, 0, 0.05]}, floor: {obstacle: floor}}\n"
    "rigid: {engine: bullet, time_step: 1 ms}\n"
    "duration: 0.06\n"
    "output: {rate: 250, fracture_every: 100, probe_every: 50}\n";

/* The published method: damped flight of the nodes, bars beside the elements, stress at the nodes. */
static const char *const DAMPED =
    "shiver: 1\n"
    "materials: {brittle: {density: 2400, youngs_modulus: 100, poissons_ratio: 0.1, law: ppr, fracture_energy: 22, "
    "cohesive_strength: 5e-3}}\n"
    "objects: {sphere: {mesh: {ball: {radius: 0.05, edge: 20 mm}, jitter: 0.1, seed: 1}, material: brittle, "
    "position: [0, 0, 0.06], velocity: [0, 0, -1]}}\n"
    "obstacles: {floor: {plane: {normal: [0, 0, 1]}, friction: 0.3, restitution: 0.3}}\n"
    "rigid: {engine: pbd, time_step: 2 ms, wake: contact}\n"
    "pbd: {stiffness: 0.9, iterations: 3, form: element, damping: 1}\n"
    "fracture: {stabiliser: bars, connectivity: nodes, time_step: 50 us, check_every: 1, threshold: 0.9, "
    "criterion: principal, quiet_checks: 20}\n"
    "duration: 0.1\n"
    "output: {rate: 200}\n";

/* A beam that is held and pulled until it breaks, a plate that falls, and what happens meanwhile; cracks grow at strengths that
   are lowered ahead of their fronts. */
static const char *const HELD =
    "shiver: 1\n"
    "materials: {stone: {density: 2400, youngs_modulus: 3e8, poissons_ratio: 0.2, fracture_energy: 5, "
    "cohesive_strength: 1e6, weibull: {modulus: 8}, unresolved: tip_strength}}\n"
    "objects:\n"
    "  beam: {mesh: {box: {size: [0.08, 0.02, 0.02], edge: 10 mm}, jitter: 0.1, seed: 1}, material: stone, "
    "position: [0, 0, 0.2]}\n"
    "  plate: {mesh: {box: {size: [0.06, 0.06, 0.02], edge: 15 mm}, jitter: 0.1, seed: 3}, material: stone, "
    "position: [0.3, 0, 0.02], velocity: [0, 0, -2], angular_velocity: [3, 2, 1]}\n"
    "supports: {wall: {object: beam, on: {plane: {normal: [1, 0, 0], offset: -0.04, tolerance: 1e-3}}, end: 12 ms}}\n"
    "imposed_velocities: {pull: {object: beam, on: {plane: {normal: [1, 0, 0], offset: 0.04, tolerance: 1e-3}}, "
    "velocity: [1, 0, 0], end: 6 ms}}\n"
    "probes: {end: {nodes: {object: beam, on: {plane: {normal: [1, 0, 0], offset: 0.04, tolerance: 1e-3}}}}}\n"
    "obstacles: {floor: {plane: {normal: [0, 0, 1]}, friction: 0.3, restitution: 0.3}}\n"
    "rigid: {engine: analytic, time_step: 1 ms}\n"
    "duration: 0.02\n"
    "output: {rate: 500}\n";

static uint64_t hash_frame(const ShvSimulation *simulation)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    uint64_t hash = shv_simulation_hash(simulation);
    hash = shv_hash_bytes(hash, &frame->time, sizeof frame->time);
    hash = shv_hash_bytes(hash, &frame->ledger, sizeof frame->ledger);
    hash = shv_hash_bytes(hash, &frame->steps, sizeof frame->steps);
    hash = shv_hash_bytes(hash, &frame->worst_overshoot, sizeof frame->worst_overshoot);
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        hash = shv_hash_bytes(hash, frame->fragments[i].position, sizeof frame->fragments[i].position);
        hash = shv_hash_bytes(hash, frame->fragments[i].velocity, sizeof frame->fragments[i].velocity);
        hash = shv_hash_bytes(hash, frame->fragments[i].orientation, sizeof frame->fragments[i].orientation);
    }
    for (int32_t i = 0; i < frame->obstacle_count; i++)
        hash = shv_hash_bytes(hash, frame->obstacles[i].position, sizeof frame->obstacles[i].position);
    for (int32_t i = 0; i < frame->event_count; i++)
        hash = shv_hash_bytes(hash, &frame->events[i].time, sizeof(double));
    return shv_hash_bytes(hash, frame->probe_samples,
                          (size_t)frame->probe_row_count * (size_t)frame->probe_count * sizeof(ShvProbeSample));
}

/* A run that saves itself, now and then when it is asked whether it should stop. */
typedef struct Saver {
    ShvSimulation *simulation;
    int64_t asked, moments[SAVES];
    FILE *files[SAVES];
    uint64_t sizes[SAVES];
    int frames, frame[SAVES]; /* given so far, and at each time */
} Saver;

static bool save_now_and_then(void *data)
{
    Saver *saver = data;
    ShvError error;
    uint32_t checksum;
    for (int i = 0; i < SAVES; i++) {
        if (saver->asked != saver->moments[i] || !saver->files[i]) continue;
        check_ok(shv_simulation_save(saver->simulation, fileno(saver->files[i]), &saver->sizes[i], &checksum, &error),
                 error);
        saver->frame[i] = saver->frames;
    }
    saver->asked++;
    return false;
}

static ShvScene *parse(const char *text)
{
    ShvScene *scene = NULL;
    ShvError error;
    check_ok(shv_scene_parse(&scene, text, strlen(text), "scene", NULL, NULL, 0, NULL, NULL, &error), error);
    return scene;
}

static ShvSimulation *make(const ShvSceneDefinition *scene, Saver *saver)
{
    ShvError error;
    ShvSimulation *simulation = NULL;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.stop = saver ? save_now_and_then : NULL;
    options.stop_data = saver;
    check_ok(shv_simulation_create(&simulation, scene, &options, &error), error);
    if (saver) saver->simulation = simulation;
    return simulation;
}

static int run(ShvSimulation *simulation, uint64_t *hashes, int first, Saver *saver)
{
    ShvError error;
    int n = first;
    while (!shv_simulation_finished(simulation)) {
        check_ok(shv_simulation_advance(simulation, &error), error);
        assert_true(n < MOST_FRAMES);
        hashes[n++] = hash_frame(simulation);
        if (saver) saver->frames = n;
    }
    return n;
}

static void open_files(Saver *saver, int64_t asks)
{
    for (int i = 0; i < SAVES; i++) {
        saver->moments[i] = asks * (2 * i + 1) / (2 * SAVES);
        saver->files[i] = tmpfile();
        assert_non_null(saver->files[i]);
    }
}

static void go_on(const ShvSceneDefinition *scene, const Saver *saver, int i, const uint64_t *whole, int count)
{
    static uint64_t again[MOST_FRAMES];
    ShvError error;
    ShvSimulation *simulation = make(scene, NULL);
    lseek(fileno(saver->files[i]), 0, SEEK_SET);
    check_ok(shv_simulation_load(simulation, fileno(saver->files[i]), saver->sizes[i], &error), error);
    const int n = run(simulation, again, saver->frame[i], NULL);
    shv_simulation_destroy(simulation);
    assert_int_equal(n, count);
    for (int k = saver->frame[i]; k < n; k++)
        if (again[k] != whole[k])
            fail_msg("from the checkpoint after frame %d on frame %d is another", saver->frame[i], k);
}

/* Returns facets inserted in all. */
static int32_t check_resumes(const char *text)
{
    static uint64_t whole[MOST_FRAMES], saved[MOST_FRAMES];
    ShvScene *scene = parse(text);
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    Saver counter = {0}, saver = {0};
    for (int i = 0; i < SAVES; i++) counter.moments[i] = -1;
    ShvSimulation *simulation = make(definition, &counter);
    const int count = run(simulation, whole, 0, NULL);
    shv_simulation_destroy(simulation);
    open_files(&saver, counter.asked);
    simulation = make(definition, &saver);
    assert_int_equal(run(simulation, saved, 0, &saver), count);
    const int32_t inserted = shv_simulation_frame(simulation)->inserted;
    shv_simulation_destroy(simulation);
    assert_memory_equal(saved, whole, (size_t)count * sizeof *whole); /* saving changes nothing */
    for (int i = 0; i < SAVES; i++) {
        go_on(definition, &saver, i, whole, count);
        fclose(saver.files[i]);
    }
    shv_scene_destroy(scene);
    return inserted;
}

static void test_bullet(void **state)
{
    (void)state;
    assert_true(check_resumes(BREAKING) > 50);
}

static void test_damped(void **state)
{
    (void)state;
    assert_true(check_resumes(DAMPED) > 10);
}

static void test_conditions(void **state)
{
    (void)state;
    assert_true(check_resumes(HELD) > 5);
}

/* What nobody has written of blocks yet to be allocated follows from `value`; 0: whatever is there. */
static void perturb_heap(int value)
{
#ifdef __GLIBC__
    mallopt(M_PERTURB, value);
#else
    (void)value;
#endif
}

/* An address that slipped in among the numbers, or a byte that nobody wrote, would not be the same twice. */
static void test_no_addresses(void **state)
{
    static const char *const scenes[] = {BREAKING, DAMPED, HELD};
    (void)state;
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        static uint64_t hashes[MOST_FRAMES];
        ShvScene *scene = parse(scenes[s]);
        ShvSimulation *both[2];
        char *bytes[2];
        uint64_t size[2];
        ShvError error;
        uint32_t checksum;
        for (int i = 0; i < 2; i++) {
            perturb_heap(0x55 + i);
            both[i] = make(shv_scene_definition(scene), NULL);
            run(both[i], hashes, 0, NULL);
            perturb_heap(0);
            FILE *file = tmpfile();
            check_ok(shv_simulation_save(both[i], fileno(file), &size[i], &checksum, &error), error);
            bytes[i] = malloc(size[i]);
            assert_int_equal(pread(fileno(file), bytes[i], size[i], 0), (ssize_t)size[i]);
            fclose(file);
        }
        assert_int_equal(size[0], size[1]);
        for (uint64_t k = 0; k < size[0] - sizeof(ShvCosts); k++)
            if (bytes[0][k] != bytes[1][k])
                fail_msg("scene %zu: byte %llu of %llu", s, (unsigned long long)k, (unsigned long long)size[0]);
        for (int i = 0; i < 2; i++) {
            free(bytes[i]);
            shv_simulation_destroy(both[i]);
        }
        shv_scene_destroy(scene);
    }
}

static void test_made_longer(void **state)
{
    static uint64_t whole[MOST_FRAMES], first[MOST_FRAMES];
    ShvError error;
    uint64_t size;
    uint32_t checksum;
    (void)state;
    ShvScene *scene = parse(HELD);
    ShvSceneDefinition half = *shv_scene_definition(scene);
    half.duration *= 0.5;
    ShvSimulation *simulation = make(shv_scene_definition(scene), NULL);
    const int count = run(simulation, whole, 0, NULL);
    shv_simulation_destroy(simulation);
    simulation = make(&half, NULL);
    const int begun = run(simulation, first, 0, NULL);
    FILE *file = tmpfile();
    check_ok(shv_simulation_save(simulation, fileno(file), &size, &checksum, &error), error);
    shv_simulation_destroy(simulation);
    simulation = make(shv_scene_definition(scene), NULL);
    lseek(fileno(file), 0, SEEK_SET);
    check_ok(shv_simulation_load(simulation, fileno(file), size, &error), error);
    assert_int_equal(run(simulation, first, begun, NULL), count);
    assert_memory_equal(first, whole, (size_t)count * sizeof *whole);
    shv_simulation_destroy(simulation);
    fclose(file);
    shv_scene_destroy(scene);
}

/* What is cut short ends in a message. */
static void test_cut_short(void **state)
{
    ShvError error;
    uint64_t size;
    uint32_t checksum;
    (void)state;
    ShvScene *scene = parse(BREAKING);
    ShvSimulation *simulation = make(shv_scene_definition(scene), NULL);
    FILE *file = tmpfile();
    check_ok(shv_simulation_save(simulation, fileno(file), &size, &checksum, &error), error);
    shv_simulation_destroy(simulation);
    for (uint64_t cut = 0; cut < size; cut += size / 40 + 1) {
        simulation = make(shv_scene_definition(scene), NULL);
        lseek(fileno(file), 0, SEEK_SET);
        check_fails(shv_simulation_load(simulation, fileno(file), cut, &error), SHV_BAD_INPUT, error, "checkpoint");
        shv_simulation_destroy(simulation);
    }
    fclose(file);
    shv_scene_destroy(scene);
}

/* Memory that runs out while a checkpoint is loaded ends in a message, and leaves what can be released. */
static void test_no_memory(void **state)
{
    static const char *const scenes[] = {BREAKING, DAMPED, HELD};
    (void)state;
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        static uint64_t hashes[MOST_FRAMES];
        ShvError error;
        uint64_t size;
        uint32_t checksum;
        ShvScene *scene = parse(scenes[s]);
        ShvSimulation *simulation = make(shv_scene_definition(scene), NULL);
        run(simulation, hashes, 0, NULL);
        FILE *file = tmpfile();
        check_ok(shv_simulation_save(simulation, fileno(file), &size, &checksum, &error), error);
        shv_simulation_destroy(simulation);
        ShvStatus status = SHV_NO_MEMORY;
        int failures = 0;
        for (int64_t allowed = 0; status == SHV_NO_MEMORY; allowed += 5, failures++) {
            ShvMemory *memory = shv_memory_create();
            ShvSimulationOptions options = shv_simulation_options_default();
            options.memory = memory;
            check_ok(shv_simulation_create(&simulation, shv_scene_definition(scene), &options, &error), error);
            shv_memory_fail_after(memory, allowed);
            lseek(fileno(file), 0, SEEK_SET);
            status = shv_simulation_load(simulation, fileno(file), size, &error);
            shv_simulation_destroy(simulation);
            assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
            shv_memory_destroy(memory);
        }
        check_ok(status, error);
        assert_true(failures > 5);
        fclose(file);
        shv_scene_destroy(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bullet),       cmocka_unit_test(test_damped),      cmocka_unit_test(test_conditions),
        cmocka_unit_test(test_no_addresses), cmocka_unit_test(test_made_longer), cmocka_unit_test(test_cut_short),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
