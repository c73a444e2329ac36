#include "block.h"

enum { NODES = 27 };

static void create(Block *block)
{
    const BlockShape shape = block_shape(2, 2, 2);
    block_create(block, &shape);
    assert_int_equal(block->state.node_count, NODES);
    for (uint64_t i = 0; i < 3 * NODES; i++) {
        block->state.force[i] = shv_random_uniform(1, i);
        block->state.velocity[i] = shv_random_uniform(2, i);
        block->state.displacement[i] = shv_random_uniform(3, i);
    }
}

static int is_listed(int32_t node)
{
    return node % 4 == 1;
}

static int32_t make_list(int32_t nodes[NODES])
{
    int32_t count = 0;
    for (int32_t i = 0; i < NODES; i++)
        if (is_listed(i)) nodes[count++] = i;
    return count;
}

static void kick_and_drift_move_the_listed_nodes_only(void **unused)
{
    (void)unused;
    static const double gravity[3] = {0.5, -1.0, 2.0};
    for (int with_list = 0; with_list < 2; with_list++) {
        Block before, after;
        create(&before);
        create(&after);
        int32_t list[NODES];
        const int32_t count = make_list(list), *nodes = with_list ? list : NULL;
        shv_motion_kick(&after.state, nodes, count, 0.25, gravity, 2);
        shv_motion_drift(&after.state, nodes, count, 0.5, 2);
        shv_motion_clear_force(&after.state, nodes, count, 2);
        for (int32_t i = 0; i < 3 * NODES; i++) {
            const ShvState *old = &before.state;
            const int moved = !with_list || is_listed(i / 3);
            const double force = 0.25 * (old->force[i] / old->mass[i / 3] + gravity[i % 3]);
            const double velocity = moved ? old->velocity[i] + force : old->velocity[i];
            check_near(after.state.velocity[i] / velocity, 1.0, 1e-15);
            check_near(after.state.displacement[i],
                       old->displacement[i] + (moved ? 0.5 * after.state.velocity[i] : 0.0),
                       moved ? 1e-15 * fabs(velocity) : 0.0);
            assert_true(after.state.force[i] == (moved ? 0.0 : old->force[i]));
        }
        block_release(&before);
        block_release(&after);
    }
}

static void power_sums_the_listed_nodes(void **unused)
{
    (void)unused;
    Block block;
    create(&block);
    int32_t list[NODES];
    const int32_t count = make_list(list);
    double all = 0.0, some = 0.0;
    for (int32_t i = 0; i < 3 * NODES; i++) {
        const double power = block.state.force[i] * block.state.velocity[i];
        all += power;
        if (is_listed(i / 3)) some += power;
    }
    check_near(shv_motion_power(&block.state, block.state.force, NULL, 0, 2), all, 81 * 1.2e-16 * all);
    check_near(shv_motion_power(&block.state, block.state.force, list, count, 1), some, 81 * 1.2e-16 * all);
    assert_true(shv_motion_power(&block.state, block.state.force, list, 0, 1) == 0.0);
    block_release(&block);
}

/* Started from v(0) by half a kick, free fall is exact at every step: u = v₀ t + ½ g t². */
static void free_fall_is_exact(void **unused)
{
    (void)unused;
    enum { STEPS = 1000 };
    static const double gravity[3] = {0.0, 0.0, -9.81};
    Block block;
    const BlockShape shape = block_shape(2, 2, 2);
    block_create(&block, &shape);
    for (int32_t i = 0; i < NODES; i++) block.state.velocity[3 * i] = 3.0;
    const double step = 1e-3;
    for (int i = 0; i < STEPS; i++) {
        block_force(&block);
        shv_motion_kick(&block.state, NULL, 0, i ? step : 0.5 * step, gravity, 1);
        shv_motion_drift(&block.state, NULL, 0, step, 1);
    }
    /* A thousand roundings of sums up to 5 m and 10 m/s. Were they not equal at all nodes, forces would answer. */
    for (int32_t i = 0; i < NODES; i++) {
        check_near(block.state.displacement[3 * i], 3.0, STEPS * 4.5e-16);
        check_near(block.state.displacement[3 * i + 2], -0.5 * 9.81, STEPS * (9e-16 + 1e-3 * STEPS * 1e-15));
    }
    block_release(&block);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kick_and_drift_move_the_listed_nodes_only),
        cmocka_unit_test(power_sums_the_listed_nodes),
        cmocka_unit_test(free_fall_is_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
