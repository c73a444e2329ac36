/* Hard cases, under Bullet: mass ratios, planes that contradict each other, wedges, coordinates far off, overlaps at the start,
   many fragments, shapes without volume. */
#include "check.h"

#include "base/random.h"
#include "bullet_world.h"

static double speed_of(const ShvFragment *fragment)
{
    return shv_norm(fragment->velocity) + shv_norm(fragment->angular_velocity) * fragment->radius;
}

static double fastest(const World *world)
{
    double speed = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++) {
        const ShvFragment *fragment = &world->fragments.items[f];
        if (fragment->mode == SHV_MODE_DEAD) continue;
        assert_true(shv_finite3(fragment->position) && shv_finite3(fragment->velocity) &&
                    shv_finite3(fragment->angular_velocity));
        speed = fmax(speed, speed_of(fragment));
    }
    return speed;
}

/* The largest speed in so many steps of 1 ms. */
static double advance(World *world, int32_t steps, const double gravity[3])
{
    double speed = 0.0;
    for (int32_t i = 0; i < steps; i++) {
        world_advance(world, i * 1e-3, 1e-3, gravity, NULL, NULL, NULL);
        speed = fmax(speed, fastest(world));
    }
    return speed;
}

/* The second object and those after it are so many times as dense as the first. */
static void build_with_ratio(World *world, ShvMaterialDefinition materials[2], double ratio)
{
    materials[0] = materials[1] = world->material;
    materials[1].name = "lead";
    materials[1].density *= ratio;
    world->scene.materials = materials;
    world->scene.material_count = 2;
    for (int i = 1; i < world->scene.object_count; i++) world->objects[i].material = "lead";
    world_build(world);
    bullet_fly(world);
}

/* ---- mass ratio 1e6 ---- */

/* The light one is thrown back by the heavy one, which gains 1e-6 (1 + e) of its speed. */
static void test_light_meets_heavy(void **unused)
{
    (void)unused;
    World world;
    ShvMaterialDefinition materials[2];
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.velocity[0] = 3.0;
    world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.position[0] = 0.3;
    build_with_ratio(&world, materials, 1e6);
    world.backend->fragment_friction = 0.0;
    world.backend->fragment_restitution = 0.5;
    const ShvFragment *light = &world.fragments.items[0], *heavy = &world.fragments.items[1];
    advance(&world, 150, no_gravity);
    const double common = 3.0 / (1.0 + 1e6);
    /* the iteration is good to 1e-10 of the speed, on which the heavy one's answer weighs 1e-6 of that */
    check_near(light->velocity.x, common - 0.5 * (3.0 - common) - 0.5 * common, 3e-6);
    check_near(heavy->velocity.x, common * 1.5, 1e-6 * common + 1e-15);
    check_near(light->mass * light->velocity.x + heavy->mass * heavy->velocity.x, 3.0 * light->mass,
               1e-12 * 3.0 * light->mass);
    world_end(&world);
}

/* A heavy box on a light one, centred and leaning out, and a light one under each of two heavy ones: they stand. */
static void test_heavy_stands_on_light(void **unused)
{
    (void)unused;
    for (int shape = 0; shape < 3; shape++)
        for (double ratio = 1.0; ratio < 2e6; ratio *= 1e3) {
            World world;
            ShvMaterialDefinition materials[2];
            const int boxes = shape < 2 ? 2 : 3;
            world_begin(&world);
            for (int i = 0; i < boxes; i++) {
                ShvObjectDefinition *box = world_box(&world, 0.1, 0.1, 0.1, 0.1);
                box->placement.position[2] = 0.05 + 0.1 * i;
                if (i == 1 && shape == 1) box->placement.position[0] = 0.03;
            }
            world_floor(&world, 0.5, 0.0);
            build_with_ratio(&world, materials, ratio);
            const double speed = advance(&world, 500, earth);
            print_message("mass ratio %g, shape %d: fastest %.1e m/s\n", ratio, shape, speed);
            for (int i = 0; i < boxes; i++) {
                const ShvFragment *fragment = &world.fragments.items[i];
                /* the gap that counts as a touch is 1e-6 of the radius; ten times that is no motion to speak of */
                check_near(fragment->position.z, 0.05 + 0.1 * i, 1e-5 * fragment->radius);
                check_near(fragment->position.x, i == 1 && shape == 1 ? 0.03 : 0.0, 1e-5 * fragment->radius);
            }
            assert_true(speed < 9.81e-3); /* of one step's fall */
            world_end(&world);
        }
}

/* ---- contradictions ---- */

static ShvObstacleDefinition *plane(World *world, double x, double z, double offset)
{
    ShvObstacleDefinition *definition = world_obstacle(world, SHV_OBSTACLE_PLANE);
    definition->plane_normal[0] = x;
    definition->plane_normal[1] = 0.0;
    definition->plane_normal[2] = z;
    definition->plane_offset = offset;
    definition->friction = 0.5;
    return definition;
}

/* A box where two opposed planes leave no room, or none at all: what overlaps at the start is let be, nothing is thrown. */
static void test_opposed_planes(void **unused)
{
    (void)unused;
    for (int coincident = 0; coincident < 2; coincident++) {
        World world;
        world_begin(&world);
        world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.velocity[0] = 0.5;
        plane(&world, 0.0, 1.0, coincident ? 0.0 : -0.04);
        plane(&world, 0.0, -1.0, coincident ? 0.0 : -0.04);
        world_build(&world);
        bullet_fly(&world);
        const double speed = advance(&world, 1000, earth);
        print_message("opposed planes: fastest %.3f m/s\n", speed);
        assert_true(speed <= 0.5 + 9.81e-3);
        assert_true(fabs(world.fragments.items[0].position.z) < 0.05);
        world_end(&world);
    }
}

/* A box leaves the floor that it touches, and a roof 10 mm above throws it back within the step: to 1 mm above the floor. */
static void test_thrown_back_to_what_it_left(void **unused)
{
    (void)unused;
    for (int overlap = 0; overlap < 2; overlap++) {
        World world;
        world_begin(&world);
        world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.velocity[2] = 20.0;
        plane(&world, 0.0, 1.0, overlap ? -0.0499 : -0.05)->restitution = 0.9;
        plane(&world, 0.0, -1.0, -0.06)->restitution = 0.9;
        world_build(&world);
        bullet_fly(&world);
        world_advance(&world, 0.0, 1e-3, no_gravity, NULL, NULL, NULL);
        const ShvFragment *box = &world.fragments.items[0];
        check_near(box->velocity.z, -18.0, 1e-9);
        check_near(box->position.z, 1e-3, 1e-9);
        check_near(shv_norm(box->angular_velocity), 0.0, 1e-7); /* the solver iterates */
        world_end(&world);
    }
}

/* Spinning boxes on a floor without any loss but friction: what Newton's law of restitution gives them is never more than they had. */
static void test_rebounds_gain_nothing(void **unused)
{
    (void)unused;
    double most = 0.0;
    for (uint64_t k = 0; k < 60; k++) {
        World world;
        world_begin(&world);
        ShvPlacement *placement = &world_box(&world, 0.1, 0.07, 0.04, 0.08)->placement;
        placement->position[2] = 0.11;
        for (int i = 0; i < 3; i++) {
            placement->velocity[i] = 10.0 * (shv_random_uniform(k, (uint64_t)i) - 0.5);
            placement->angular_velocity[i] = 200.0 * (shv_random_uniform(k, (uint64_t)i + 3) - 0.5);
        }
        placement->velocity[2] = -5.0;
        ShvObstacleDefinition *floor = plane(&world, 0.0, 1.0, 0.0);
        floor->restitution = floor->friction = 1.0;
        world_build(&world);
        bullet_fly(&world);
        const double before = shv_fragment_kinetic(&world.fragments.items[0]);
        for (int i = 0; i < 60; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        most = fmax(most, shv_fragment_kinetic(&world.fragments.items[0]) / before - 1.0);
        assert_true(world.fragments.items[0].velocity.z > 0.0);
        world_end(&world);
    }
    print_message("spinning boxes thrown at a floor: energy gained %.2e of theirs\n", most);
    assert_true(most < 1e-6);
}

/* Boxes, and a light and a heavy ball, that cross a room up to twice in a step, and meet walls and each other on the way: none leaves it. */
static void test_none_leaves_a_room(void **unused)
{
    (void)unused;
    double farthest = 0.0;
    for (uint64_t k = 0; k < 150; k++) {
        World world;
        world_begin(&world);
        for (uint64_t n = 0; n < 3; n++) {
            ShvPlacement *placement = &world_box(&world, 0.04, 0.04, 0.04, 0.04)->placement;
            placement->position[0] = 0.065 * ((double)n - 1.0);
            for (uint64_t i = 0; i < 3; i++) {
                placement->velocity[i] = 400.0 * (shv_random_uniform(k, 9 * n + i) - 0.5);
                placement->angular_velocity[i] = 2000.0 * (shv_random_uniform(k, 9 * n + i + 3) - 0.5);
            }
        }
        for (int wall = 0; wall < 6; wall++) {
            ShvObstacleDefinition *definition = plane(&world, 0.0, 0.0, -0.1);
            definition->plane_normal[wall / 2] = wall % 2 ? 1.0 : -1.0;
            definition->restitution = 0.9;
        }
        for (uint64_t n = 0; n < 2; n++) {
            ShvObstacleDefinition *ball = world_obstacle(&world, SHV_OBSTACLE_SPHERE);
            ball->motion = SHV_OBSTACLE_FREE;
            ball->radius = 0.02;
            ball->mass = n ? 0.05 : 1.0;
            ball->restitution = 0.9;
            ball->placement.position[0] = n ? 0.05 : -0.05;
            ball->placement.position[1] = 0.06;
            for (uint64_t i = 0; i < 3; i++)
                ball->placement.velocity[i] = 400.0 * (shv_random_uniform(k, 27 + 3 * n + i) - 0.5);
        }
        world.scene.rigid.restitution = 0.9;
        world_build(&world);
        bullet_fly(&world);
        for (int step = 0; step < 20; step++) {
            world_advance(&world, step * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
            for (int32_t n = 0; n < 5; n++) {
                const ShvVec3 x = n < 3 ? world.fragments.items[n].position : world.obstacles.items[n + 3].position;
                farthest = fmax(farthest, fmax(fabs(x.x), fmax(fabs(x.y), fabs(x.z))));
            }
        }
        world_end(&world);
    }
    print_message("a room of 0.2 m: farthest centre %.4f m from its middle\n", farthest);
    /* half a box: bodies may stand in a wall by a quarter of that for a step */
    assert_true(farthest < 0.085);
}

/* A ram presses a box into the floor: the contradiction stays bounded by the ram's speed. */
static void test_crushed_between_ram_and_floor(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.position[2] = 0.05;
    world_floor(&world, 0.5, 0.0);
    ShvObstacleDefinition *ram = world_obstacle(&world, SHV_OBSTACLE_BOX);
    ram->size[0] = ram->size[1] = ram->size[2] = 0.1;
    ram->placement.position[2] = 0.16;
    world_build(&world);
    world.obstacles.items[0].motion = SHV_OBSTACLE_FIXED;
    ShvObstacle *obstacle = &world.obstacles.items[1];
    obstacle->motion = SHV_OBSTACLE_SCRIPTED;
    obstacle->velocity = shv_vec3(0.0, 0.0, -1.0);
    bullet_fly(&world);
    double speed = 0.0;
    for (int i = 0; i < 100; i++) {
        world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        obstacle->position = shv_madd(obstacle->position, 1e-3, obstacle->velocity);
        speed = fmax(speed, fastest(&world));
    }
    print_message("crushed by a ram of 1 m/s: fastest %.3f m/s\n", speed);
    assert_true(speed < 10.0);
    assert_true(fabs(world.fragments.items[0].position.z) < 0.3);
    world_end(&world);
}

/* A box falls, corner first, into wedges of 60°, 10° and 1°: it is held, comes to rest, and is in neither side. */
static void test_wedge(void **unused)
{
    (void)unused;
    static const double angles[] = {60.0, 10.0, 1.0};
    for (int a = 0; a < 3; a++) {
        const double half = 0.5 * angles[a] * 3.14159265358979323846 / 180.0;
        World world;
        world_begin(&world);
        ShvObjectDefinition *box = world_box(&world, 0.1, 0.1, 0.1, 0.1);
        box->placement.position[2] = 0.09 / sin(half);
        box->placement.rotation_axis[1] = 1.0;
        box->placement.rotation_degrees = 45.0;
        plane(&world, cos(half), sin(half), 0.0);
        plane(&world, -cos(half), sin(half), 0.0);
        world_build(&world);
        bullet_fly(&world);
        const double speed = advance(&world, 3000, earth);
        const ShvFragment *fragment = &world.fragments.items[0];
        assert_true(speed <= sqrt(2.0 * 9.81 * 0.09 / sin(half)) + 1.0);
        shv_fragment_scatter(fragment, &world.fragments, &world.state);
        double lowest = 1.0;
        for (int32_t n = 0; n < world.state.node_count; n++) {
            const ShvVec3 x = shv_state_position(&world.state, n);
            lowest = fmin(lowest, sin(half) * x.z - cos(half) * fabs(x.x));
        }
        print_message("wedge of %g degrees: fastest %.2f m/s, last %.1e m/s, gap %.1e m\n", angles[a], speed,
                      shv_norm(fragment->velocity), lowest);
        assert_true(lowest > -1e-4 * fragment->radius);
        /* it may go on turning about the line through two corners that touch: nothing brakes that */
        assert_true(shv_norm(fragment->velocity) < 1e-3);
        world_end(&world);
    }
}

/* ---- far off ---- */

/* A box that tumbles onto a floor and slides to rest, seen from its start. */
static ShvVec3 landed(double offset)
{
    World world;
    world_begin(&world);
    ShvObjectDefinition *box = world_box(&world, 0.1, 0.08, 0.05, 0.05);
    box->placement.position[0] = box->placement.position[1] = box->placement.position[2] = offset;
    box->placement.position[2] += 0.2;
    box->placement.velocity[0] = 0.4;
    box->placement.angular_velocity[1] = 2.0;
    world_floor(&world, 0.3, 0.2);
    world.definitions[0].plane_offset = offset;
    world_build(&world);
    bullet_fly(&world);
    for (int i = 0; i < 800; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    const ShvVec3 end = shv_sub(world.fragments.items[0].position, shv_vec3(offset, offset, offset));
    assert_true(shv_fragment_kinetic(&world.fragments.items[0]) == 0.0);
    world_end(&world);
    return end;
}

/* Coordinates 1e6 m off carry 1.2e-10 m; tumbling multiplies that. */
static void test_far_from_the_origin(void **unused)
{
    (void)unused;
    const ShvVec3 near = landed(0.0), far = landed(1048576.0);
    const double off = shv_norm(shv_sub(far, near));
    print_message("1e6 m off: it comes to rest %.1e m beside\n", off);
    assert_true(off < 1e-4);
}

/* ---- overlaps at the start ---- */

static void test_objects_that_overlap_at_the_start(void **unused)
{
    (void)unused;
    for (int same_place = 0; same_place < 2; same_place++) {
        World world;
        world_begin(&world);
        world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.position[2] = 0.05;
        ShvObjectDefinition *other = world_box(&world, 0.1, 0.1, 0.1, 0.1);
        other->placement.position[2] = 0.05;
        if (!same_place) other->placement.position[0] = 0.06;
        world_floor(&world, 0.5, 0.0);
        world_build(&world);
        bullet_fly(&world);
        assert_true(advance(&world, 500, earth) < 9.81e-3);
        world_end(&world);
    }
}

/* A fixed ball inside a box, one at its rim, and a free one inside: the box is neither thrown nor does it fall off the world. */
static void test_obstacle_inside_an_object(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < 3; kind++) {
        World world;
        world_begin(&world);
        world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.05;
        world_floor(&world, 0.5, 0.0);
        ShvObstacleDefinition *ball = world_obstacle(&world, SHV_OBSTACLE_SPHERE);
        ball->radius = 0.01;
        ball->placement.position[2] = kind == 1 ? 0.097 : 0.05;
        if (kind == 2) {
            ball->motion = SHV_OBSTACLE_FREE;
            ball->mass = 0.1;
        }
        world_build(&world);
        bullet_fly(&world);
        const double speed = advance(&world, 500, earth);
        print_message("ball inside a box, %d: fastest %.1e m/s\n", kind, speed);
        assert_true(speed < 0.1);
        check_near(world.fragments.items[0].position.z, 0.05, 1e-3);
        assert_true(shv_finite3(world.obstacles.items[1].position));
        world_end(&world);
    }
}

/* ---- many, and bad ones ---- */

/* Cells of 1 cm, 2 mm apart, each cut into six tets about its diagonal (Kuhn), all tets with nodes of their own. */
enum { CELLS = 10, LAYERS = 9, TETS = 6 * CELLS * CELLS * LAYERS };

static void fill_cell(int cell, double *points)
{
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    for (int t = 0; t < 6; t++) {
        const double origin[3] = {cell % CELLS, cell / CELLS % CELLS, (double)(cell / (CELLS * CELLS))};
        double corner[3] = {0.0, 0.0, 0.0};
        for (int n = 0; n < 4; n++) {
            const int place = t < 3 || n == 0 || n == 3 ? n : 3 - n; /* odd orders: two corners change places */
            for (int k = 0; k < 3; k++) points[12 * t + 3 * place + k] = 0.012 * origin[k] + 0.01 * corner[k];
            if (n < 3) corner[orders[t][n]] += 1.0;
        }
    }
}

/* More than 5,000 fragments of one tet, in place: at rest they stay, and on a floor they settle. */
static void test_five_thousand_fragments(void **unused)
{
    (void)unused;
    double *points = malloc(12 * TETS * sizeof *points);
    int32_t *tets = malloc(4 * TETS * sizeof *tets);
    for (int cell = 0; cell < TETS / 6; cell++) fill_cell(cell, points + 72 * (size_t)cell);
    for (int32_t i = 0; i < 4 * TETS; i++) tets[i] = i;
    World world;
    world_begin(&world);
    world_floor(&world, 0.5, 0.0);
    world_tets(&world, points, 4 * TETS, tets, TETS);
    assert_int_equal(world.fragments.count, TETS);
    bullet_fly(&world);
    for (int i = 0; i < 2; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    assert_true(fastest(&world) == 0.0);
    const double speed = advance(&world, 12, earth);
    print_message("%d fragments: fastest %.4f m/s in 12 ms\n", (int)TETS, speed);
    assert_true(speed < 0.5); /* 0.12 of the fall */
    world_end(&world);
    free(points);
    free(tets);
}

/* Four corners in a plane or on a line, or in one point: refused by name. Zero inertia is a line of nodes: it flies. */
static void test_shapes_without_volume_are_refused(void **unused)
{
    (void)unused;
    static const double sizes[][3] = {{0.1, 0.1, 0.0}, {0.1, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    static const int32_t tet[] = {0, 1, 2, 3};
    for (int s = 0; s < 3; s++) {
        const double *size = sizes[s];
        const double good[] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1};
        World world;
        world_begin(&world);
        world_tets(&world, good, 4, tet, 1);
        for (int n = 0; n < 4; n++)
            for (int k = 0; k < 3; k++)
                if (size[k] == 0.0) world.state.reference[3 * n + k] = 0.0;
        const ShvRigidWorld rigid = {&world.model, &world.state, &world.fragments, &world.obstacles,
                                     &world.scene.rigid};
        ShvError error = {0};
        check_ok(shv_bullet_create(&world.backend, &rigid, &error), error);
        check_fails(world.backend->functions->add(world.backend, 0, &error), SHV_BAD_INPUT, error, "fragment");
        print_message("%s\n", error.message);
        world_end(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_light_meets_heavy),
        cmocka_unit_test(test_heavy_stands_on_light),
        cmocka_unit_test(test_opposed_planes),
        cmocka_unit_test(test_thrown_back_to_what_it_left),
        cmocka_unit_test(test_rebounds_gain_nothing),
        cmocka_unit_test(test_none_leaves_a_room),
        cmocka_unit_test(test_crushed_between_ram_and_floor),
        cmocka_unit_test(test_wedge),
        cmocka_unit_test(test_far_from_the_origin),
        cmocka_unit_test(test_objects_that_overlap_at_the_start),
        cmocka_unit_test(test_obstacle_inside_an_object),
        cmocka_unit_test(test_five_thousand_fragments),
        cmocka_unit_test(test_shapes_without_volume_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
