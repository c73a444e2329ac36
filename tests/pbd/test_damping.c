/* Damping towards rigid motion: what it keeps, what it takes, and components without three dimensions. */
#include "check.h"

#include "base/random.h"
#include "pbd/damping.h"

enum { MOST = 60 };

typedef struct Cloud {
    double reference[3 * MOST], displacement[3 * MOST], velocity[3 * MOST], mass[MOST];
    int32_t nodes[MOST], count;
    ShvState state;
} Cloud;

static double draw(uint64_t *index)
{
    return 2.0 * shv_random_uniform(3, (*index)++) - 1.0;
}

/* Nodes at offset + Σ extent_i × random × axis_i, with random velocities of about 1 m/s and masses over three decades. */
static void cloud_make(Cloud *cloud, int32_t count, const double extent[3], double offset, uint64_t seed)
{
    const ShvQuat turn = shv_quat_exponential(shv_vec3(0.7, -0.4, 1.1));
    uint64_t index = 1000 * seed;
    *cloud = (Cloud){.count = count};
    for (int32_t i = 0; i < count; i++) {
        const double x = draw(&index), y = draw(&index), z = draw(&index);
        const ShvVec3 arm = shv_rotate(turn, shv_vec3(extent[0] * x, extent[1] * y, extent[2] * z));
        shv_store3(cloud->reference + 3 * i, shv_add(arm, shv_vec3(offset, -offset, 2.0 * offset)));
        for (int c = 0; c < 3; c++) {
            cloud->displacement[3 * i + c] = 1e-3 * extent[2] * draw(&index);
            cloud->velocity[3 * i + c] = draw(&index);
        }
        cloud->mass[i] = exp(3.0 * draw(&index));
        cloud->nodes[i] = i;
    }
    cloud->state = (ShvState){.reference = cloud->reference,
                              .displacement = cloud->displacement,
                              .velocity = cloud->velocity,
                              .mass = cloud->mass,
                              .node_count = count};
}

typedef struct Sums {
    ShvVec3 momentum, angular;
    double kinetic, momentum_scale, angular_scale;
} Sums;

/* From the first node: an offset must not hide what is lost, and references and displacements each keep their digits. */
static ShvVec3 arm_of(const Cloud *cloud, int32_t node)
{
    return shv_add(shv_sub(shv_load3(cloud->reference + 3 * node), shv_load3(cloud->reference)),
                   shv_sub(shv_load3(cloud->displacement + 3 * node), shv_load3(cloud->displacement)));
}

static Sums sums_of(const Cloud *cloud)
{
    Sums sums = {0};
    for (int32_t i = 0; i < cloud->count; i++) {
        const double m = cloud->mass[i];
        const ShvVec3 r = arm_of(cloud, i), v = shv_load3(cloud->velocity + 3 * i);
        sums.momentum = shv_madd(sums.momentum, m, v);
        sums.angular = shv_madd(sums.angular, m, shv_cross(r, v));
        sums.kinetic += 0.5 * m * shv_dot(v, v);
        sums.momentum_scale += m * shv_norm(v);
        sums.angular_scale += m * shv_norm(r) * shv_norm(v);
    }
    return sums;
}

static void check_kept(const Sums *before, const Sums *after)
{
    check_near(shv_norm(shv_sub(after->momentum, before->momentum)), 0.0, 1e-12 * before->momentum_scale);
    check_near(shv_norm(shv_sub(after->angular, before->angular)), 0.0, 1e-12 * before->angular_scale);
}

static const double shapes[][3] = {{1.0, 1.0, 1.0},    {1.0, 0.7, 0.01}, {1.0, 1e-3, 1e-3}, {1.0, 1e-7, 1e-7},
                                   {1.0, 1e-9, 1e-10}, {1.0, 0.0, 0.0},  {0.0, 0.0, 0.0},   {1e-4, 1e-4, 2e-4}};
enum { SHAPES = sizeof shapes / sizeof shapes[0] };

static void momentum_and_angular_momentum_are_kept_for_every_shape_and_factor(void **state)
{
    (void)state;
    const double factors[] = {0.0, 0.1, 0.5, 1.0};
    const int32_t counts[] = {1, 2, 3, 4, MOST};
    for (int s = 0; s < SHAPES; s++)
        for (int k = 0; k < 4; k++)
            for (int n = 0; n < 5; n++) {
                Cloud cloud;
                cloud_make(&cloud, counts[n], shapes[s], 0.0, (uint64_t)(20 * s + n));
                const Sums before = sums_of(&cloud);
                const double taken = shv_damp_velocities(&cloud.state, cloud.nodes, cloud.count, factors[k], NULL);
                const Sums after = sums_of(&cloud);
                check_kept(&before, &after);
                check_near(taken, before.kinetic - after.kinetic, 1e-12 * before.kinetic);
                assert_true(taken >= 0.0);
            }
}

/* Rigid motion changes no distance: (x_i − x_j)·(v_i − v_j) = 0. */
static void full_damping_leaves_rigid_motion(void **state)
{
    (void)state;
    for (int s = 0; s < SHAPES; s++) {
        Cloud cloud;
        cloud_make(&cloud, MOST, shapes[s], 0.0, (uint64_t)s);
        shv_damp_velocities(&cloud.state, cloud.nodes, cloud.count, 1.0, NULL);
        double fastest = 0.0;
        for (int32_t i = 0; i < MOST; i++) fastest = fmax(fastest, shv_norm(shv_load3(cloud.velocity + 3 * i)));
        for (int32_t i = 0; i < MOST; i++)
            for (int32_t j = 0; j < i; j++) {
                const ShvVec3 x = shv_sub(shv_state_position(&cloud.state, i), shv_state_position(&cloud.state, j));
                const ShvVec3 v = shv_sub(shv_load3(cloud.velocity + 3 * i), shv_load3(cloud.velocity + 3 * j));
                check_near(shv_dot(x, v), 0.0, 1e-12 * shv_norm(x) * fastest + 1e-300);
            }
    }
}

static void rigid_motion_is_left_alone(void **state)
{
    (void)state;
    Cloud cloud;
    cloud_make(&cloud, MOST, shapes[0], 0.0, 5);
    const ShvVec3 velocity = shv_vec3(3.0, -2.0, 1.0), spin = shv_vec3(10.0, 20.0, -5.0);
    const ShvVec3 pole = shv_vec3(0.3, 0.1, -0.2);
    for (int32_t i = 0; i < MOST; i++)
        shv_store3(cloud.velocity + 3 * i,
                   shv_add(velocity, shv_cross(spin, shv_sub(shv_state_position(&cloud.state, i), pole))));
    double kept[3 * MOST];
    memcpy(kept, cloud.velocity, sizeof kept);
    const ShvRigidField field = shv_rigid_field(&cloud.state, cloud.nodes, MOST);
    check_near(shv_norm(shv_sub(field.angular_velocity, spin)), 0.0, 1e-12 * shv_norm(spin));
    const double taken = shv_damp_velocities(&cloud.state, cloud.nodes, MOST, 1.0, NULL);
    check_near(taken, 0.0, 1e-25 * sums_of(&cloud).kinetic);
    for (int i = 0; i < 3 * MOST; i++) check_near(cloud.velocity[i], kept[i], 1e-13 * shv_norm(spin));
}

/* A cubic metre a thousand kilometres away: positions carry 1e-10 of it, the sums about its own centre must not lose
   more. */
static void far_from_the_origin_nothing_is_lost(void **state)
{
    (void)state;
    Cloud cloud;
    cloud_make(&cloud, MOST, shapes[0], 1e6, 8);
    const Sums before = sums_of(&cloud);
    shv_damp_velocities(&cloud.state, cloud.nodes, MOST, 0.6, NULL);
    const Sums after = sums_of(&cloud);
    check_kept(&before, &after);
}

/* The sign of Table 6.1's line 4 as printed would turn the spin around. */
static void a_dumbbell_keeps_its_sense_of_rotation(void **state)
{
    (void)state;
    Cloud cloud;
    cloud_make(&cloud, 2, shapes[0], 0.0, 9);
    const double x[6] = {1.0, 0.0, 0.0, -1.0, 0.0, 0.0}, v[6] = {0.0, 2.0, 0.0, 0.0, -2.0, 0.0};
    memcpy(cloud.reference, x, sizeof x);
    memset(cloud.displacement, 0, sizeof x);
    memcpy(cloud.velocity, v, sizeof v);
    cloud.mass[0] = cloud.mass[1] = 3.0;
    const ShvRigidField field = shv_rigid_field(&cloud.state, cloud.nodes, 2);
    check_near(field.angular_velocity.z, 2.0, 1e-15);
    check_near(field.angular_velocity.x, 0.0, 0.0);
    check_near(field.inertia.m[2][2], 6.0, 1e-15);
    check_near(field.angular_momentum.z, 12.0, 1e-14);
}

/* Two clumps of one body are damped each for itself when they are listed each for itself. */
static void components_do_not_see_each_other(void **state)
{
    (void)state;
    Cloud cloud, half;
    cloud_make(&cloud, MOST, shapes[0], 0.0, 10);
    half = cloud;
    shv_damp_velocities(&cloud.state, cloud.nodes, MOST / 2, 1.0, NULL);
    for (int i = 3 * (MOST / 2); i < 3 * MOST; i++) assert_true(cloud.velocity[i] == half.velocity[i]);
    shv_damp_velocities(&cloud.state, cloud.nodes + MOST / 2, MOST / 2, 1.0, NULL);
    const ShvRigidField first = shv_rigid_field(&cloud.state, cloud.nodes, MOST / 2);
    const ShvRigidField second = shv_rigid_field(&cloud.state, cloud.nodes + MOST / 2, MOST / 2);
    assert_true(shv_norm(shv_sub(first.angular_velocity, second.angular_velocity)) > 1e-3);
}

static void no_nodes_are_no_motion(void **state)
{
    (void)state;
    Cloud cloud;
    cloud_make(&cloud, 1, shapes[0], 0.0, 11);
    check_near(shv_damp_velocities(&cloud.state, cloud.nodes, 0, 1.0, NULL), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(momentum_and_angular_momentum_are_kept_for_every_shape_and_factor),
        cmocka_unit_test(full_damping_leaves_rigid_motion),
        cmocka_unit_test(rigid_motion_is_left_alone),
        cmocka_unit_test(far_from_the_origin_nothing_is_lost),
        cmocka_unit_test(a_dumbbell_keeps_its_sense_of_rotation),
        cmocka_unit_test(components_do_not_see_each_other),
        cmocka_unit_test(no_nodes_are_no_motion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
