#include "scene.h"

typedef struct Start {
    Scene scene;
    ShvMemory *memory;
    ShvModel model;
    ShvState state;
    ShvError error;
} Start;

static void create(Start *start, bool fracture)
{
    scene_make(&start->scene);
    start->scene.definition.fracture.enabled = fracture;
    start->memory = shv_memory_create();
    assert_non_null(start->memory);
    check_ok(shv_model_build(&start->model, start->memory, &start->scene.definition, NULL, &start->error),
             start->error);
    check_ok(shv_state_create(&start->state, &start->model, &start->scene.definition, &start->error), start->error);
}

static void destroy(Start *start)
{
    shv_state_release(&start->state);
    shv_model_release(&start->model);
    assert_int_equal(shv_memory_bytes(start->memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(start->memory);
}

static void connectivity_is_that_of_the_mesh(void **unused)
{
    (void)unused;
    Start s;
    create(&s, true);
    const int32_t elements = s.model.mesh.element_count;
    assert_int_equal(s.state.batch_count, (elements + SHV_LANES - 1) / SHV_LANES);
    for (int32_t lane = 0; lane < s.state.batch_count * SHV_LANES; lane++)
        for (int32_t corner = 0; corner < 4; corner++) {
            const int32_t element = lane < elements ? lane : elements - 1;
            assert_int_equal(s.state.connectivity[shv_corner_slot(lane, corner)],
                             s.model.mesh.elements[4 * (int64_t)element + corner]);
        }
    destroy(&s);
}

static void corners_list_the_elements_of_each_node(void **unused)
{
    (void)unused;
    Start s;
    create(&s, true);
    int64_t total = 0;
    for (int32_t node = 0; node < s.state.node_count; node++) {
        for (int32_t i = 0; i < s.state.corner_count[node]; i++) {
            const int32_t *corner = s.state.corners + s.state.corner_start[node] + i;
            assert_int_equal(shv_state_node(&s.state, *corner / 4, *corner % 4), node);
            if (i > 0) assert_true(corner[0] > corner[-1]);
        }
        assert_int_equal(s.state.origin[node], node);
        total += s.state.corner_count[node];
    }
    assert_int_equal(total, 4 * (int64_t)s.state.element_count);
    destroy(&s);
}

/* ρV in all; a node's mass has the bits of the sum over its corners, with or without adjacency. */
static void masses_are_lumped_in_element_order(void **unused)
{
    (void)unused;
    Start with, without;
    create(&with, true);
    create(&without, false);
    assert_memory_equal(with.state.corners, without.state.corners,
                        4 * (size_t)with.state.element_count * sizeof(int32_t));
    assert_memory_equal(with.state.mass, without.state.mass, (size_t)with.state.node_count * sizeof(double));
    double total = 0.0;
    for (int32_t node = 0; node < with.state.node_count; node++) {
        double sum = 0.0;
        for (int32_t i = 0; i < with.state.corner_count[node]; i++)
            sum += 0.25 * with.state.element_mass[with.state.corners[with.state.corner_start[node] + i] / 4];
        assert_true(sum == with.state.mass[node]);
        total += sum;
    }
    check_near(total, 4.0 * 2500.0 + 2.0 * 8000.0, 26000.0 * 1e-14);
    destroy(&with);
    destroy(&without);
}

static void bodies_start_at_rest_shape_with_their_velocity(void **unused)
{
    (void)unused;
    Start s;
    create(&s, true);
    const ShvObject *block = &s.model.objects[1];
    for (int64_t i = 0; i < 3 * (int64_t)s.state.node_count; i++) {
        assert_true(s.state.displacement[i] == 0.0);
        if (i < 3 * (int64_t)block->node_begin) assert_true(s.state.velocity[i] == 0.0);
    }
    /* Spin and stretching are about the lumped centre of mass, so they add nothing to the momentum. */
    ShvVec3 momentum = {0.0, 0.0, 0.0};
    double mass = 0.0;
    for (int32_t node = block->node_begin; node < block->node_end; node++) {
        momentum = shv_madd(momentum, s.state.mass[node], shv_load3(s.state.velocity + 3 * (int64_t)node));
        mass += s.state.mass[node];
    }
    check_near(momentum.x / mass, 1.0, 1e-13);
    check_near(momentum.y / mass, 2.0, 1e-13);
    check_near(momentum.z / mass, 3.0, 1e-13);
    /* The difference of two nodes' velocities is ω × their distance and what the distance stretches by. */
    const ShvVec3 spin = {0.0, 0.0, 4.0};
    for (int32_t node = block->node_begin + 1; node < block->node_end; node++) {
        const int64_t k = 3 * (int64_t)node, first = 3 * (int64_t)block->node_begin;
        const ShvVec3 arm = shv_sub(shv_load3(s.state.reference + k), shv_load3(s.state.reference + first));
        const ShvVec3 speed = shv_sub(shv_load3(s.state.velocity + k), shv_load3(s.state.velocity + first));
        const ShvVec3 stretching = shv_vec3(0.5 * arm.x, -arm.y, 2.0 * arm.z);
        check_near(shv_norm(shv_sub(speed, shv_add(shv_cross(spin, arm), stretching))), 0.0, 1e-13);
    }
    assert_true(s.state.time == 0.0 && s.state.last_step == 0.0 && s.state.step == 0);
    destroy(&s);
}

static void growth_keeps_what_is_there(void **unused)
{
    (void)unused;
    Start s;
    create(&s, true);
    const uint64_t hash = shv_state_hash(&s.state);
    const int32_t count = s.state.node_count;
    check_ok(shv_state_reserve(&s.state, count, &s.error), s.error);
    assert_int_equal(s.state.node_capacity, count);
    check_ok(shv_state_reserve(&s.state, count + 1, &s.error), s.error);
    assert_int_equal(s.state.node_capacity, count + count / 2);
    check_ok(shv_state_reserve(&s.state, 10 * (int64_t)count, &s.error), s.error);
    assert_int_equal(s.state.node_capacity, 10 * count);
    assert_true(shv_state_hash(&s.state) == hash);
    /* New entries are zero and can be written in every array (the sanitizer looks). */
    s.state.node_count = 10 * count;
    for (int64_t i = 3 * (int64_t)count; i < 3 * (int64_t)s.state.node_count; i++) {
        assert_true(s.state.velocity[i] == 0.0 && s.state.reference[i] == 0.0);
        s.state.velocity[i] = s.state.reference[i] = s.state.force[i] = s.state.displacement[i] = 1.0;
    }
    s.state.mass[s.state.node_count - 1] = 1.0;
    s.state.origin[s.state.node_count - 1] = s.state.corner_start[s.state.node_count - 1] = 1;
    s.state.corner_count[s.state.node_count - 1] = 1;
    check_fails(shv_state_reserve(&s.state, (int64_t)INT32_MAX, &s.error), SHV_BAD_INPUT, s.error, "nodes");
    destroy(&s);
}

static void failed_growth_changes_nothing(void **unused)
{
    (void)unused;
    Start s;
    create(&s, true);
    const uint64_t hash = shv_state_hash(&s.state);
    const int32_t count = s.state.node_count;
    int64_t failures = 0;
    for (ShvStatus status = SHV_NO_MEMORY; status != SHV_OK; failures++) {
        shv_memory_fail_after(s.memory, failures);
        status = shv_state_reserve(&s.state, 2 * (int64_t)count, &s.error);
        shv_memory_fail_after(s.memory, -1);
        if (status != SHV_OK) {
            assert_int_equal(status, SHV_NO_MEMORY);
            assert_int_equal(s.state.node_capacity, count);
        }
        assert_true(shv_state_hash(&s.state) == hash);
    }
    assert_int_equal(failures, 9);
    destroy(&s);
}

/* Every array and the clock count: one changed bit anywhere gives another hash; the sign of zero is a bit. */
static void hash_sees_every_array(void **unused)
{
    (void)unused;
    Start s;
    create(&s, true);
    ShvState *state = &s.state;
    const uint64_t hash = shv_state_hash(state);
#define SEEN(place)                                                                                                    \
    do {                                                                                                               \
        unsigned char *byte = (unsigned char *)&(place);                                                               \
        *byte ^= 1;                                                                                                    \
        assert_true(shv_state_hash(state) != hash);                                                                    \
        *byte ^= 1;                                                                                                    \
        assert_true(shv_state_hash(state) == hash);                                                                    \
    } while (0)
#define SEEN_ARRAY(type, name, components) SEEN(state->name[(components) * (int64_t)state->node_count - 1]);
    SHV_NODE_ARRAYS(SEEN_ARRAY)
#undef SEEN_ARRAY
    SEEN(state->connectivity[5]);
    SEEN(state->element_mass[3]);
    SEEN(state->element_fragment[2]);
    SEEN(state->corners[1]);
    SEEN(state->time);
    SEEN(state->last_step);
    SEEN(state->step);
#undef SEEN
    state->displacement[0] = -0.0;
    assert_true(shv_state_hash(state) != hash);
    state->displacement[0] = 0.0;
    Start other;
    create(&other, true);
    assert_true(shv_state_hash(&other.state) == hash);
    destroy(&other);
    destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(connectivity_is_that_of_the_mesh),
        cmocka_unit_test(corners_list_the_elements_of_each_node),
        cmocka_unit_test(masses_are_lumped_in_element_order),
        cmocka_unit_test(bodies_start_at_rest_shape_with_their_velocity),
        cmocka_unit_test(growth_keeps_what_is_there),
        cmocka_unit_test(failed_growth_changes_nothing),
        cmocka_unit_test(hash_sees_every_array),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
