/* The rigid backends through their one interface: what every one of them must do, each to its own accuracy. */
#include "check.h"

#include "../rigid/bullet_world.h"
#include "pbd/pbd_backend.h"

typedef ShvStatus (*Create)(ShvRigidBackend **backend, const ShvRigidWorld *world, const ShvSceneDefinition *scene,
                            ShvError *error);

static ShvStatus create_analytic(ShvRigidBackend **backend, const ShvRigidWorld *world, const ShvSceneDefinition *scene,
                                 ShvError *error)
{
    (void)scene;
    return shv_analytic_create(backend, world, error);
}

static ShvStatus create_bullet(ShvRigidBackend **backend, const ShvRigidWorld *world, const ShvSceneDefinition *scene,
                               ShvError *error)
{
    (void)scene;
    return shv_bullet_create(backend, world, error);
}

/* In units of the box and without a skin, so that it meets the floor where it is. */
static ShvStatus create_bullet_plain(ShvRigidBackend **backend, const ShvRigidWorld *world,
                                     const ShvSceneDefinition *scene, ShvError *error)
{
    (void)scene;
    const ShvBulletPlainDefinition settings = {.unit = 0.1, .exact_flight = true, .sharp_impacts = true};
    return shv_bullet_plain_create(backend, world, &settings, error);
}

static ShvStatus create_pbd(ShvRigidBackend **backend, const ShvRigidWorld *world, const ShvSceneDefinition *scene,
                            ShvError *error)
{
    return shv_pbd_create(backend, world, &scene->pbd, error);
}

typedef struct Case {
    const char *name;
    Create create;
    double flight;      /* relative error of free fall, P and L */
    double impact_step; /* an impact's moment is known to this many steps */
    bool rebounds;      /* at the impact's moment, with the restitution whole */
    bool rests;         /* goes to sleep: the energy is exactly 0 */
} Case;

/* Plain Bullet sleeps after 2 s, and finds impacts in whole steps. Nodes of PBD carry round-off of their own positions, its contacts are judged at the step's start, and its bars swallow most
   of a rebound. */
static const Case cases[] = {
    {"analytic", create_analytic, 1e-12, 1e-3, true, true},
    {"bullet", create_bullet, 1e-12, 1e-3, true, true},
    {"bullet_plain", create_bullet_plain, 1e-12, 1.0, true, false},
    {"pbd", create_pbd, 1e-9, 1.0, false, false},
};
enum { CASES = sizeof cases / sizeof *cases };

static void fly(World *world, const Case *engine)
{
    ShvError error = {0};
    const ShvRigidWorld rigid = {&world->model, &world->state, &world->fragments, &world->obstacles,
                                 &world->scene.rigid};
    check_ok(engine->create(&world->backend, &rigid, &world->scene, &error), error);
    assert_string_equal(world->backend->functions->name, engine->name);
    for (int32_t i = 0; i < world->fragments.count; i++) {
        shv_fragment_fit(&world->fragments.items[i], &world->fragments, &world->state);
        check_ok(world->backend->functions->add(world->backend, i, &error), error);
    }
}

static void box_world(World *world, double height)
{
    world_begin(world);
    world->scene.pbd.exact_rotation = true;
    world_box(world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.05 + height;
}

static void test_free_fall(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASES; c++) {
        World world;
        box_world(&world, 10.0);
        world.objects[0].placement.velocity[0] = 3.0;
        world_build(&world);
        fly(&world, &cases[c]);
        const ShvFragment *fragment = &world.fragments.items[0];
        const double start = fragment->position.z;
        for (int i = 0; i < 1000; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        check_near(fragment->position.z - start, -0.5 * 9.81, cases[c].flight * 4.905);
        check_near(fragment->position.x, 3.0, cases[c].flight * 3.0);
        check_near(fragment->velocity.z, -9.81, cases[c].flight * 9.81);
        world_end(&world);
    }
}

/* A spinning, flying box: P, L about the origin and the energy. */
static void test_spin_keeps_momentum(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASES; c++) {
        World world;
        box_world(&world, 0.0);
        world.objects[0].mesh.size[0] = 0.2;
        world.objects[0].mesh.size[1] = 0.15;
        world.objects[0].placement.velocity[1] = 2.0;
        world.objects[0].placement.angular_velocity[0] = 3.0;
        world.objects[0].placement.angular_velocity[1] = 8.0;
        world_build(&world);
        fly(&world, &cases[c]);
        const ShvFragment *fragment = &world.fragments.items[0];
        const ShvMat3 before = shv_fragment_world_inertia(fragment);
        const ShvVec3 p0 = shv_scale(fragment->velocity, fragment->mass);
        const ShvVec3 l0 = shv_add(shv_apply(&before, fragment->angular_velocity), shv_cross(fragment->position, p0));
        const double k0 = shv_fragment_kinetic(fragment);
        for (int i = 0; i < 1000; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        const ShvMat3 after = shv_fragment_world_inertia(fragment);
        const ShvVec3 p1 = shv_scale(fragment->velocity, fragment->mass);
        const ShvVec3 l1 = shv_add(shv_apply(&after, fragment->angular_velocity), shv_cross(fragment->position, p1));
        check_near(shv_norm(shv_sub(p1, p0)), 0.0, cases[c].flight * shv_norm(p0));
        check_near(shv_norm(shv_sub(l1, l0)), 0.0, 10.0 * cases[c].flight * shv_norm(p0));
        check_near(shv_fragment_kinetic(fragment), k0, 1e3 * cases[c].flight * k0);
        world_end(&world);
    }
}

/* The first rebound from 1 m with e = 0.8 reaches 0.64 m, or less where bars give way; never more. */
static void test_bounce(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASES; c++) {
        World world;
        box_world(&world, 1.0);
        world_floor(&world, 0.0, 0.8);
        world_build(&world);
        fly(&world, &cases[c]);
        const ShvFragment *fragment = &world.fragments.items[0];
        double apex = 0.0;
        for (int i = 0; i < 1100; i++) {
            world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
            if (i > 460) apex = fmax(apex, fragment->position.z - 0.05);
        }
        assert_true(apex <= 0.64 * 1.002);
        if (cases[c].rebounds) check_near(apex, 0.64, 2e-3 * 0.64);
        world_end(&world);
    }
}

static bool accept(void *data, const ShvRigidContact *contact)
{
    (void)data;
    return contact->closing_speed > 1.0;
}

/* The contact that wakes is reported with its moment, normal and speed, and its fragment stops there, untouched. */
static void test_wake_contact(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASES; c++) {
        World world;
        box_world(&world, 1.0);
        world_floor(&world, 0.3, 0.8);
        world_build(&world);
        fly(&world, &cases[c]);
        const ShvFragment *fragment = &world.fragments.items[0];
        const double fall = sqrt(2.0 / 9.81), allowed = 1e-3 * cases[c].impact_step + 1e-6;
        ShvRigidContact wake = {0};
        int woken = 0;
        for (int i = 0; i < 1000 && !woken; i++)
            woken = world_advance(&world, 7.0 + i * 1e-3, 1e-3, earth, accept, NULL, &wake);
        assert_int_equal(woken, 1);
        check_near(wake.time, 7.0 + fall, allowed);
        check_near(wake.normal.z, 1.0, 1e-12);
        check_near(wake.closing_speed, 9.81 * fall, 2.0 * 9.81 * allowed);
        check_near(wake.point.z, 0.0, 10.0 * allowed);
        check_near(fragment->velocity.z, -9.81 * fall, 2.0 * 9.81 * allowed);
        check_near(fragment->position.z, 0.05, 10.0 * allowed);
        assert_true(wake.fresh && wake.fragment == 0 && wake.obstacle == 0 && wake.other == -1);
        assert_true(isinf(wake.other_mass));
        assert_true(world.backend->contact_work == 0.0);
        const ShvVec3 position = fragment->position;
        assert_int_equal(world_advance(&world, 8.0, 1e-3, earth, accept, NULL, &wake), 0);
        assert_memory_equal(&position, &fragment->position, sizeof position);
        world_end(&world);
    }
}

/* Dropped from a hand's breadth it lies still in the end, on the floor. */
static void test_rest(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASES; c++) {
        World world;
        box_world(&world, 0.02);
        world_floor(&world, 0.5, 0.3);
        world_build(&world);
        fly(&world, &cases[c]);
        const ShvFragment *fragment = &world.fragments.items[0];
        for (int i = 0; i < 2000; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        check_near(fragment->position.z, 0.05, 1e-4 * fragment->radius);
        if (cases[c].rests)
            assert_true(shv_fragment_kinetic(fragment) == 0.0);
        else
            check_near(shv_fragment_kinetic(fragment), 0.0, 0.5 * fragment->mass * 9.81e-3 * 9.81e-3); /* of one step */
        world_end(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_fall), cmocka_unit_test(test_spin_keeps_momentum),
        cmocka_unit_test(test_bounce),    cmocka_unit_test(test_wake_contact),
        cmocka_unit_test(test_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
