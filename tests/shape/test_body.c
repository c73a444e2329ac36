#include "check.h"

#include "shape/rotation.h"
#include "shape/scene.h"

static const double NO_GRAVITY[3] = {0.0, 0.0, 0.0};
static const double GRAVITY[3] = {0.0, 0.0, -9.81};

static ShvObstacleDefinition free_sphere(double radius, double mass, ShvVec3 position)
{
    ShvObstacleDefinition definition = sphere_definition("ball", radius, position);
    make_free(&definition, mass);
    return definition;
}
static ShvObstacleDefinition free_box(ShvVec3 size, double mass, ShvVec3 position)
{
    ShvObstacleDefinition definition = box_definition("box", size, position);
    make_free(&definition, mass);
    return definition;
}

/* ---- free flight ---- */

static void test_parabola(void **state)
{
    (void)state;
    ShvObstacleDefinition definition = free_sphere(0.1, 2.0, shv_vec3(1.0, 2.0, 3.0));
    definition.placement.velocity[0] = 3.0;
    definition.placement.velocity[2] = 4.0;
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    const int steps = 1000;
    for (int k = 0; k < steps; k++) assert_true(shv_obstacles_advance(&obstacles, 1e-3, GRAVITY) == 0.0);
    const ShvObstacle *ball = &obstacles.items[0];
    check_near(ball->position.x, 4.0, 1e-12);
    check_near(ball->position.z, 3.0 + 4.0 - 0.5 * 9.81, 1e-12);
    check_near(ball->velocity.z, 4.0 - 9.81, 1e-12);
    shv_obstacles_release(&obstacles);
}

/* Principal moments (1, 2, 3), ω = (0.01, 1, 0.01): ω₂ returns after 39.1057 s (Jacobi's elliptic functions). */
static void test_intermediate_axis(void **state)
{
    (void)state;
    const ShvVec3 moments = {1.0, 2.0, 3.0};
    const ShvVec3 start = {0.01, 1.0, 0.01};
    ShvQuat orientation = shv_quat_identity();
    ShvVec3 spin = start;
    const double step = 1e-2, energy = 0.5 * (1e-4 + 2.0 + 3e-4);
    const ShvVec3 momentum = {0.01, 2.0, 0.03};
    double crossing = 0.0, last = 1.0, worst_energy = 0.0;
    int crossings = 0;
    for (int k = 1; k <= 4000; k++) {
        shv_rotate_free(moments, shv_quat_identity(), &orientation, &spin, step);
        const ShvVec3 w = shv_rotate(shv_quat_conjugate(orientation), spin);
        const ShvVec3 l = shv_rotate(orientation, shv_vec3(w.x, 2.0 * w.y, 3.0 * w.z));
        /* Direction and size: 4,000 steps of ten rotations, each with an error of 2e-16 of |L| = 2. */
        check_near(shv_norm(shv_sub(l, momentum)), 0.0, 2e-11);
        worst_energy = fmax(worst_energy, fabs(0.5 * (w.x * w.x + 2.0 * w.y * w.y + 3.0 * w.z * w.z) - energy));
        if (w.y < 0.0 && last >= 0.0 && ++crossings == 1) crossing = step * (k - 1 + last / (last - w.y));
        last = w.y;
    }
    /* Second order: errors of (ω step)² = 1e-4 of the first quarter period, 10.917 s, grown by the instability
       exp(Ω t / √3) no more than logarithmically in time. */
    check_near(crossing, 10.917, 5e-3);
    assert_true(worst_energy < 1e-4 * energy);
}

static void test_energy_error_is_second_order(void **state)
{
    (void)state;
    double worst[2];
    for (int level = 0; level < 2; level++) {
        ShvQuat orientation = shv_quat_identity();
        const ShvQuat axes = shv_quat_from_axis_angle(shv_vec3(1.0, 1.0, 0.0), 0.7);
        ShvVec3 spin = {0.3, 0.9, -0.4};
        const double step = level ? 0.01 : 0.02;
        double first = 0.0;
        worst[level] = 0.0;
        for (int k = 0; k < (level ? 10000 : 5000); k++) {
            const ShvVec3 w = shv_rotate(shv_quat_conjugate(shv_quat_multiply(orientation, axes)), spin);
            const double energy = 0.5 * (w.x * w.x + 2.5 * w.y * w.y + 3.0 * w.z * w.z);
            if (k == 0) first = energy;
            worst[level] = fmax(worst[level], fabs(energy / first - 1.0));
            shv_rotate_free(shv_vec3(1.0, 2.5, 3.0), axes, &orientation, &spin, step);
        }
    }
    assert_true(worst[0] < 1e-3);
    check_near(worst[0] / worst[1], 4.0, 0.4);
}

/* 1e4 rad/s with steps of 1 ms: |L| stays. */
static void test_fast_spin(void **state)
{
    (void)state;
    ShvObstacleDefinition definition = free_box(shv_vec3(0.1, 0.2, 0.3), 1.0, shv_vec3(0.0, 0.0, 0.0));
    shv_store3(definition.placement.angular_velocity, shv_vec3(6000.0, 8000.0, 100.0));
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    const ShvVec3 before = shv_obstacle_angular_momentum(&obstacles.items[0]);
    const double energy = shv_obstacle_kinetic(&obstacles.items[0]);
    for (int k = 0; k < 200; k++) shv_obstacles_advance(&obstacles, 1e-3, NO_GRAVITY);
    const ShvVec3 after = shv_obstacle_angular_momentum(&obstacles.items[0]);
    check_near(shv_norm(shv_sub(after, before)) / shv_norm(before), 0.0, 1e-10);
    check_near(shv_obstacle_kinetic(&obstacles.items[0]) / energy, 1.0, 1e-3); /* turns of 1/32 rad: (1/32)² */
    shv_obstacles_release(&obstacles);
}

/* ---- impulses ---- */

static void test_impulse_changes_energy_and_momentum(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(angle_text);
    ShvObstacleDefinition definition = mesh_definition("angle", file.path, shv_vec3(0.1, 0.2, 0.3));
    make_free(&definition, 2.5);
    turn(&definition, shv_vec3(1.0, 2.0, 0.3), 50.0);
    shv_store3(definition.placement.velocity, shv_vec3(1.0, -2.0, 0.5));
    shv_store3(definition.placement.angular_velocity, shv_vec3(3.0, 1.0, -2.0));
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    ShvObstacle *body = &obstacles.items[0];
    const ShvVec3 point = {0.9, -0.3, 0.6}, direction = shv_unit(shv_vec3(0.4, -0.2, 0.9));
    const double size = 0.7, energy = shv_obstacle_kinetic(body);
    const ShvVec3 spin = shv_obstacle_angular_momentum(body), before = shv_obstacle_velocity(body, point);
    const double inverse = shv_obstacle_inverse_mass(body, point, direction);
    shv_obstacle_impulse(body, point, shv_scale(direction, size));
    const ShvVec3 after = shv_obstacle_velocity(body, point);
    check_near(shv_dot(shv_sub(after, before), direction), size * inverse, 1e-14);
    check_near(shv_obstacle_kinetic(body) - energy, size * 0.5 * shv_dot(direction, shv_add(before, after)), 1e-13);
    const ShvVec3 moment = shv_scale(shv_cross(point, direction), size);
    check_near(shv_norm(shv_sub(shv_sub(shv_obstacle_angular_momentum(body), spin), moment)), 0.0, 1e-13);
    shv_obstacles_release(&obstacles);
    remove_surface_file(&file);
}

/* ---- contact with others ---- */

/* Drop from 1 m, e = 0.8, g = 9.81: impacts at 0.45152, 1.17396, 1.75191, 2.21427 s, apex e^(2n), rest at 4.0637 s. */
static void test_bounces(void **state)
{
    (void)state;
    ShvObstacleDefinition definitions[2] = {plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0),
                                            free_sphere(0.1, 0.5, shv_vec3(0.0, 0.0, 1.1))};
    definitions[0].restitution = 0.8;
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    const ShvObstacle *ball = &obstacles.items[1];
    const double step = 1e-3, expected[4] = {0.45152, 1.17396, 1.75191, 2.21427};
    double time = 0.0, work = 0.0, apex = 0.0, energy = 0.0;
    int bounces = 0;
    while (time < 4.2) {
        const double before = ball->velocity.z;
        work += shv_obstacles_advance(&obstacles, step, GRAVITY);
        time += step;
        assert_true(ball->position.z >= 0.1 - 1e-12);
        energy = shv_obstacle_kinetic(ball) + 0.5 * 9.81 * (ball->position.z - 1.1);
        check_near(energy, work, 1e-12); /* the work of contact is all that changes it */
        if (before < 0.0 && ball->velocity.z > 0.0 && bounces < 4) {
            check_near(time, expected[bounces] + 0.5 * step, 0.5 * step + 1e-5);
            apex = ball->position.z - 0.1 + 0.5 * ball->velocity.z * ball->velocity.z / 9.81;
            bounces++;
            check_near(apex, pow(0.64, bounces), 1e-12);
        }
    }
    assert_int_equal(bounces, 4);
    check_near(ball->position.z, 0.1, 1e-12); /* at rest: twice the fall time times 1/(1 − e) later */
    check_near(ball->velocity.z, 0.0, 1e-15);
    shv_obstacles_release(&obstacles);
}

static void test_elastic_ball_keeps_its_height(void **state)
{
    (void)state;
    ShvObstacleDefinition definitions[2] = {plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0),
                                            free_sphere(0.1, 0.5, shv_vec3(0.0, 0.0, 0.6))};
    definitions[0].restitution = 1.0;
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    const ShvObstacle *ball = &obstacles.items[1];
    for (int k = 0; k < 20000; k++) shv_obstacles_advance(&obstacles, 1e-3, GRAVITY);
    const double energy = 0.5 * ball->velocity.z * ball->velocity.z + 9.81 * (ball->position.z - 0.1);
    check_near(energy, 9.81 * 0.5, 1e-10); /* 31 impacts, each to rounding of 20,000 steps */
    shv_obstacles_release(&obstacles);
}

/* A resting box, on its face and on a wedge of two planes, for 5,000 steps: it neither sinks nor moves. */
static void test_box_rests(void **state)
{
    (void)state;
    for (int wedge = 0; wedge < 2; wedge++) {
        const double s = sqrt(0.5);
        ShvObstacleDefinition definitions[3] = {
            plane_definition("left", wedge ? shv_vec3(s, 0.0, s) : shv_vec3(0.0, 0.0, 1.0), 0.0),
            plane_definition("right", wedge ? shv_vec3(-s, 0.0, s) : shv_vec3(0.0, 0.0, 1.0), 0.0),
            free_box(shv_vec3(0.2, 0.2, 0.2), 3.0, shv_vec3(0.0, 0.0, wedge ? 0.1 * sqrt(2.0) : 0.1))};
        definitions[0].friction = definitions[1].friction = definitions[2].friction = 0.5;
        if (wedge) turn(&definitions[2], shv_vec3(0.0, 1.0, 0.0), 45.0);
        ShvObstacles obstacles = make_obstacles(definitions, 3);
        const ShvObstacle *box = &obstacles.items[2];
        const ShvVec3 start = box->position;
        double work = 0.0;
        for (int k = 0; k < 5000; k++) {
            work += shv_obstacles_advance(&obstacles, 1e-3, GRAVITY);
            assert_true(shv_norm(shv_sub(box->position, start)) < 1e-9);
        }
        check_near(work, 0.0, 1e-9);
        shv_obstacles_release(&obstacles);
    }
}

/* Flat drop without restitution: the box stops where it lands and all its energy is taken by the contact. */
static void test_box_lands_flat(void **state)
{
    (void)state;
    ShvObstacleDefinition definitions[2] = {plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0),
                                            free_box(shv_vec3(0.3, 0.2, 0.1), 3.0, shv_vec3(0.0, 0.0, 0.55))};
    definitions[0].friction = definitions[1].friction = 0.5;
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    const ShvObstacle *box = &obstacles.items[1];
    double work = 0.0;
    for (int k = 0; k < 1000; k++) work += shv_obstacles_advance(&obstacles, 1e-3, GRAVITY);
    check_near(box->position.z, 0.05, 1e-10);
    check_near(shv_norm(box->velocity), 0.0, 1e-10);
    check_near(shv_norm(box->angular_velocity), 0.0, 1e-9);
    check_near(work, -3.0 * 9.81 * 0.5, 1e-8);
    shv_obstacles_release(&obstacles);
}

/* A box on an incline of 30°: g in the axes of the incline. It stays iff tan θ ≤ µ; µ = 0.3: a = g (sin θ − µ cos θ). */
static void test_incline(void **state)
{
    (void)state;
    const double angle = 3.14159265358979323846 / 6.0, g = 9.81;
    const double gravity[3] = {g * sin(angle), 0.0, -g * cos(angle)};
    const double frictions[3] = {0.3, 0.57, 0.585}; /* tan 30° = 0.57735 */
    for (int k = 0; k < 3; k++) {
        ShvObstacleDefinition definitions[2] = {plane_definition("slope", shv_vec3(0.0, 0.0, 1.0), 0.0),
                                                free_box(shv_vec3(0.4, 0.4, 0.1), 1.0, shv_vec3(0.0, 0.0, 0.05))};
        definitions[0].friction = definitions[1].friction = frictions[k];
        ShvObstacles obstacles = make_obstacles(definitions, 2);
        for (int step = 0; step < 1000; step++) shv_obstacles_advance(&obstacles, 1e-3, gravity);
        const double expected = fmax(0.0, g * (sin(angle) - frictions[k] * cos(angle)));
        check_near(obstacles.items[1].velocity.x, expected, 1e-9);
        check_near(obstacles.items[1].position.x, 0.5 * expected, 1e-9);
        shv_obstacles_release(&obstacles);
    }
}

/* Slides at 2 m/s, µ = 0.4: stops after v²/(2 µ g) = 0.5097 m; the last step is not split, which costs µ g h²/8 at most. */
static void test_sliding_distance(void **state)
{
    (void)state;
    ShvObstacleDefinition definitions[2] = {plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0),
                                            free_box(shv_vec3(0.4, 0.4, 0.1), 1.0, shv_vec3(0.0, 0.0, 0.05))};
    definitions[0].friction = 0.8;
    definitions[1].friction = 0.2; /* geometric mean 0.4 */
    definitions[1].placement.velocity[0] = 2.0;
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    double work = 0.0;
    for (int step = 0; step < 1000; step++) work += shv_obstacles_advance(&obstacles, 1e-3, GRAVITY);
    check_near(obstacles.items[1].position.x, 4.0 / (2.0 * 0.4 * 9.81), 0.4 * 9.81 * 1e-6);
    check_near(obstacles.items[1].velocity.x, 0.0, 1e-12);
    check_near(work, -2.0, 1e-9);
    shv_obstacles_release(&obstacles);
}

/* Rolls down 30° with 5/7 g sin θ; a solid ball thrown at 2 m/s, µ = 0.2, slides until 2 v/(7 µ g), then rolls with 5/7 v. */
static void test_rolling(void **state)
{
    (void)state;
    const double angle = 3.14159265358979323846 / 6.0, g = 9.81;
    const double slope[3] = {g * sin(angle), 0.0, -g * cos(angle)};
    ShvObstacleDefinition definitions[2] = {plane_definition("slope", shv_vec3(0.0, 0.0, 1.0), 0.0),
                                            free_sphere(0.1, 1.0, shv_vec3(0.0, 0.0, 0.1))};
    definitions[0].friction = definitions[1].friction = 0.5;
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    for (int step = 0; step < 1000; step++) shv_obstacles_advance(&obstacles, 1e-3, slope);
    const double a = 5.0 / 7.0 * g * sin(angle);
    check_near(obstacles.items[1].velocity.x, a, 1e-9);
    check_near(obstacles.items[1].angular_velocity.y, a / 0.1, 1e-8);
    check_near(obstacles.items[1].position.x, 0.5 * a, 1e-9);
    shv_obstacles_release(&obstacles);

    definitions[0].friction = definitions[1].friction = 0.2;
    definitions[1].placement.velocity[0] = 2.0;
    obstacles = make_obstacles(definitions, 2);
    double rolls = 0.0;
    for (int step = 0; step < 600; step++) {
        shv_obstacles_advance(&obstacles, 1e-3, GRAVITY);
        const double slip = obstacles.items[1].velocity.x - 0.1 * obstacles.items[1].angular_velocity.y;
        if (rolls == 0.0 && fabs(slip) < 1e-9) rolls = 1e-3 * (step + 1);
    }
    check_near(rolls, 4.0 / (7.0 * 0.2 * g), 1e-3);
    check_near(obstacles.items[1].velocity.x, 10.0 / 7.0, 1e-9);
    shv_obstacles_release(&obstacles);
}

/* Two free balls, head on: 1-dimensional impact with e. */
static void test_two_balls(void **state)
{
    (void)state;
    ShvObstacleDefinition definitions[2] = {free_sphere(0.1, 1.0, shv_vec3(0.0, 0.0, 0.0)),
                                            free_sphere(0.2, 3.0, shv_vec3(1.0, 0.0, 0.0))};
    definitions[0].placement.velocity[0] = 4.0;
    definitions[0].restitution = 0.5;
    definitions[1].restitution = 0.25;
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    double work = 0.0;
    for (int step = 0; step < 500; step++) work += shv_obstacles_advance(&obstacles, 1e-3, NO_GRAVITY);
    check_near(obstacles.items[0].velocity.x, -0.5, 1e-12); /* mean 1, ± e 4 · (3/4, 1/4) */
    check_near(obstacles.items[1].velocity.x, 1.5, 1e-12);
    check_near(obstacles.items[0].position.x, 0.7 - 0.5 * (0.5 - 0.7 / 4.0), 1e-12);
    check_near(work, 0.5 * 0.25 + 1.5 * 2.25 - 8.0, 1e-12);
    shv_obstacles_release(&obstacles);
}

/* 1 km/s at a plate of 1 mm, step 1 ms: a ball and a box stop or rebound in front of it. */
static void test_fast_body_and_thin_plate(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        ShvObstacleDefinition definitions[2] = {
            box_definition("plate", shv_vec3(1.0, 1.0, 1e-3), shv_vec3(0.0, 0.0, 0.0)),
            kind ? free_box(shv_vec3(0.02, 0.02, 0.02), 1.0, shv_vec3(0.1, 0.0, 0.345))
                 : free_sphere(0.01, 1.0, shv_vec3(0.1, 0.0, 0.345))};
        definitions[1].placement.velocity[2] = -1000.0;
        ShvObstacles obstacles = make_obstacles(definitions, 2);
        for (int step = 0; step < 10; step++) {
            shv_obstacles_advance(&obstacles, 1e-3, GRAVITY);
            assert_true(obstacles.items[1].position.z > 0.0104);
        }
        check_near(obstacles.items[1].position.z, 0.0105, 1e-6);
        shv_obstacles_release(&obstacles);
    }
}

/* Free balls, boxes and an angle in a cage, no gravity, restitution and friction at random: energy never grows, the works
   account for every change, and pairs of free bodies keep their momentum. */
static void test_energy_never_grows(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(angle_text);
    for (uint64_t seed = 1; seed <= 6; seed++) {
        uint64_t index = 0;
        ShvObstacleDefinition definitions[10];
        for (int k = 0; k < 6; k++) {
            const ShvVec3 normal = shv_vec3(k / 2 == 0, k / 2 == 1, k / 2 == 2);
            definitions[k] = plane_definition("wall", shv_scale(normal, k % 2 ? -1.0 : 1.0), -2.5);
        }
        for (int k = 6; k < 10; k++) {
            const ShvVec3 position = shv_vec3(k & 1 ? 1.2 : -1.2, k & 2 ? 1.2 : -1.2, 0.3);
            definitions[k] = k == 6   ? mesh_definition("angle", file.path, position)
                             : k == 7 ? free_sphere(0.5, 1.0, position)
                                      : free_box(shv_vec3(0.5, 0.7, 0.9), 1.0, position);
            definitions[k].scale = 0.5;
            make_free(&definitions[k], draw(seed, &index, 0.5, 4.0));
            shv_store3(definitions[k].placement.velocity, draw_vector(seed, &index, 5.0));
            shv_store3(definitions[k].placement.angular_velocity, draw_vector(seed, &index, 8.0));
        }
        for (int k = 0; k < 10; k++) {
            definitions[k].friction = draw(seed, &index, 0.0, 1.5);
            definitions[k].restitution = draw(seed, &index, 0.0, 1.0);
        }
        ShvObstacles obstacles = make_obstacles(definitions, 10);
        double energy = (double)INFINITY, start = 0.0, work = 0.0;
        for (int step = 0; step < 3000; step++) {
            const double done = shv_obstacles_advance(&obstacles, 1e-3, NO_GRAVITY);
            double now = 0.0;
            for (int k = 6; k < 10; k++) now += shv_obstacle_kinetic(&obstacles.items[k]);
            if (step == 0) start = now - done;
            /* The rotation's own energy error: (ω step)²/12 with ω up to 30 rad/s, of what is rotation. */
            assert_true(done <= 1e-12);
            assert_true(now <= energy + 1e-4 * start);
            energy = now;
            work += done;
            for (int k = 6; k < 10; k++) assert_true(shv_norm(obstacles.items[k].position) < 5.0);
        }
        check_near(energy - start, work, 2e-3 * start);
        assert_true(work < -0.1 * start);
        shv_obstacles_release(&obstacles);
    }
    remove_surface_file(&file);
}

/* A scripted piston pushes a ball: it leaves with the piston's velocity, and the work is its energy. */
static void test_piston(void **state)
{
    (void)state;
    const ShvKeyframe keyframes[2] = {{0.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.0},
                                      {1.0, {2.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.0}};
    ShvObstacleDefinition definitions[2] = {box_definition("piston", shv_vec3(0.2, 1.0, 1.0), shv_vec3(0.0, 0.0, 0.0)),
                                            free_sphere(0.1, 2.0, shv_vec3(0.5, 0.0, 0.0))};
    definitions[0].motion = SHV_OBSTACLE_SCRIPTED;
    definitions[0].keyframes = keyframes;
    definitions[0].keyframe_count = 2;
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    double work = 0.0;
    for (int step = 0; step < 1500; step++) {
        shv_obstacles_script(&obstacles, 1e-3 * step);
        work += shv_obstacles_advance(&obstacles, 1e-3, NO_GRAVITY);
    }
    check_near(obstacles.items[1].velocity.x, 2.0, 1e-9);
    check_near(work, 4.0, 1e-8);
    check_near(obstacles.items[1].position.x, 0.5 + 2.0 * (1.5 - 0.15), 2e-3);
    shv_obstacles_release(&obstacles);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parabola),
        cmocka_unit_test(test_intermediate_axis),
        cmocka_unit_test(test_energy_error_is_second_order),
        cmocka_unit_test(test_fast_spin),
        cmocka_unit_test(test_impulse_changes_energy_and_momentum),
        cmocka_unit_test(test_bounces),
        cmocka_unit_test(test_elastic_ball_keeps_its_height),
        cmocka_unit_test(test_box_rests),
        cmocka_unit_test(test_box_lands_flat),
        cmocka_unit_test(test_incline),
        cmocka_unit_test(test_sliding_distance),
        cmocka_unit_test(test_rolling),
        cmocka_unit_test(test_two_balls),
        cmocka_unit_test(test_fast_body_and_thin_plate),
        cmocka_unit_test(test_energy_never_grows),
        cmocka_unit_test(test_piston),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
