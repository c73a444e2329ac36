/* What the plan promises is held: bytes up to the first crack, and none for what is left out. */
#include "stability/scene.h"

#include "coupling/hybrid.h"

typedef struct Held {
    ShvPlan plan;
    size_t bytes[SHV_PART_COUNT + 1], peak[SHV_PART_COUNT];
    bool woke;
} Held;

/* As `shiver plan` makes it, when it has time enough. */
static ShvPlan plan_of(const ShvScene *scene, const ShvSceneDefinition *definition)
{
    ShvPlan plan;
    ShvError error = {.message = ""};
    ShvSimulation *simulation = NULL;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = shv_scene_folder(scene);
    check_ok(shv_simulation_create(&simulation, definition, &options, &error), error);
    check_ok(shv_simulation_plan(simulation, &plan, &error), error);
    check_ok(shv_simulation_try(simulation, 60.0, &plan, &error), error);
    shv_simulation_destroy(simulation);
    return plan;
}

/* Step by step until the first crack, or the end. */
static Held follow(const ShvScene *scene)
{
    Held held = {.woke = false};
    ShvError error = {.message = ""};
    ShvMemory *memory = shv_memory_create();
    ShvSimulation *simulation = NULL;
    ShvSimulationOptions options = shv_simulation_options_default();
    ShvSceneDefinition definition = *shv_scene_definition(scene);
    definition.output.fracture_every = 1;
    options.memory = memory;
    options.folder = shv_scene_folder(scene);
    check_ok(shv_simulation_create(&simulation, &definition, &options, &error), error);
    for (int i = 0; i < SHV_PART_COUNT; i++) held.peak[i] = shv_memory_peak_bytes(memory, (ShvPart)i);
    check_ok(shv_simulation_advance(simulation, &error), error);
    while (shv_simulation_frame(simulation)->inserted == 0) {
        for (int i = 0; i <= SHV_PART_COUNT; i++) held.bytes[i] = shv_memory_bytes(memory, (ShvPart)i);
        for (int i = 0; i < SHV_PART_COUNT; i++) held.peak[i] = shv_memory_peak_bytes(memory, (ShvPart)i);
        held.woke |= shv_simulation_frame(simulation)->steps > 0;
        if (shv_simulation_finished(simulation)) break;
        check_ok(shv_simulation_advance(simulation, &error), error);
    }
    definition.duration = shv_simulation_frame(simulation)->time; /* the first crack, or the end */
    shv_simulation_destroy(simulation);
    shv_memory_destroy(memory);
    held.plan = plan_of(scene, &definition);
    return held;
}

static const ShvPlanPart *part_of(const ShvPlan *plan, const char *name)
{
    for (int32_t i = 0; i < plan->part_count; i++)
        if (strcmp(plan->parts[i].name, name) == 0) return &plan->parts[i];
    fail_msg("no part is called %s", name);
    return NULL;
}

/* A ball of some 1,500 tets meets the floor within 2 ms. */
#define BALL                                                                                                           \
    "objects.ball.mesh.ball.edge=1 cm", "objects.ball.position.2=0.06", "objects.ball.velocity=[0, 0, -6]",            \
        "duration=3 ms"

static void check_bytes(const Held *held, const char *what)
{
    const double planned = (double)held->plan.bytes, found = (double)held->bytes[SHV_PART_COUNT];
    if (!(fabs(found - planned) <= 0.1 * found))
        fail_msg("%s: %.0f bytes were planned, %.0f are held", what, planned, found);
}

static void planned_bytes_are_held_until_the_first_crack(void **state)
{
    (void)state;
    static const char *const cases[][6] = {
        {BALL, NULL},
        {BALL, "rigid.engine=analytic", NULL},
        {BALL, "fracture.stabiliser=bars", NULL},
        {BALL, "fracture.criterion=principal", NULL},
        {BALL, "fracture.enabled=false", NULL},
        {BALL, "rigid.engine=pbd", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        ShvScene *scene = scene_load("../scenes/sphere_drop.yaml", cases[i]);
        const Held held = follow(scene);
        check_bytes(&held, cases[i][4] ? cases[i][4] : "as it is");
        if (shv_scene_definition(scene)->fracture.enabled) assert_true(held.woke);
        shv_scene_destroy(scene);
    }
}

/* Small bodies, for which lists count: made at the first contact, for coupled bodies, probes, conditions and events. */
static void small_bodies_too(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"../scenes/hybrid/tile_on_brick.yaml", NULL},
        {"../scenes/hybrid/bar.yaml", NULL},
        {"../scenes/rigid/stack_of_boxes.yaml", "duration=0.3", NULL},
        {"../scenes/rigid/rolling_ball.yaml", "duration=0.3", NULL},
        {"../scenes/rigid/block_on_incline.yaml", NULL},
        {"../scenes/verification/turned.yaml", "duration=0.02", NULL},
        {"../scenes/verification/closing.yaml", NULL},
        {"../scenes/verification/fall.yaml", NULL},
        {"../scenes/extreme/12_single_tet.yaml", "duration=0.1", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        ShvScene *scene = scene_load(cases[i][0], cases[i] + 1);
        const Held held = follow(scene);
        check_bytes(&held, cases[i][0]);
        shv_scene_destroy(scene);
    }
}

/* Rigid bodies alone: no byte, at no time, for what cracks or bars would need. */
static void rigid_bodies_pay_for_nothing_else(void **state)
{
    (void)state;
    static const char *const engines[] = {"rigid.engine=analytic", "rigid.engine=bullet"};
    static const ShvPart parts[] = {SHV_PART_ADJACENCY, SHV_PART_STRESS, SHV_PART_COHESIVE, SHV_PART_BARS};
    static const char *const names[] = {"adjacency", "stress", "cohesive facets", "bars"};
    for (int i = 0; i < 2; i++) {
        const char *const overrides[] = {BALL, "materials.plaster.breakable=false", engines[i], NULL};
        ShvScene *scene = scene_load("../scenes/sphere_drop.yaml", overrides);
        const Held held = follow(scene);
        for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++) {
            assert_int_equal(held.peak[parts[k]], 0);
            assert_false(part_of(&held.plan, names[k])->on);
            assert_int_equal(part_of(&held.plan, names[k])->bytes, 0);
        }
        assert_true(part_of(&held.plan, "bullet")->on == (i == 1));
        shv_scene_destroy(scene);
    }
}

/* One body that cannot break and has nothing to meet is flown without Bullet, though the scene asks for it. */
static void no_contact_no_bullet(void **state)
{
    (void)state;
    static const char *const alone =
        "{shiver: 1, duration: 1, rigid: {engine: bullet}, materials: {stuff: {density: 1000, "
        "youngs_modulus: 1 GPa, poissons_ratio: 0.2, breakable: false}}, objects: {cube: "
        "{material: stuff, mesh: {box: {size: [1, 1, 1], edge: 1}}%s}}%s}";
    static const char *const more[][2] = {{"", ""},
                                          {", repeat: {count: 2, offset: [3, 0, 0]}", ""},
                                          {"", ", obstacles: {floor: {plane: {normal: [0, 0, 1], offset: -9}}}"}};
    for (int i = 0; i < 3; i++) {
        char text[1024];
        snprintf(text, sizeof text, alone, more[i][0], more[i][1]);
        ShvScene *scene = scene_parse(text);
        ShvMemory *memory = shv_memory_create();
        ShvHybrid hybrid;
        ShvError error = {.message = ""};
        check_ok(shv_hybrid_create(&hybrid, memory, shv_scene_definition(scene), NULL, &error), error);
        assert_string_equal(hybrid.backend->functions->name, i == 0 ? "analytic" : "bullet");
        assert_true(hybrid.coupling.mutual == (i > 0));
        shv_hybrid_release(&hybrid);
        shv_memory_destroy(memory);
        shv_scene_destroy(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planned_bytes_are_held_until_the_first_crack),
        cmocka_unit_test(small_bodies_too),
        cmocka_unit_test(rigid_bodies_pay_for_nothing_else),
        cmocka_unit_test(no_contact_no_bullet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
