/* Pairs are the same, to the bit and in their order, on any number of threads. */
#include "surfaces.h"

/* Enough candidates for threads (narrow_phase.c starts none below 256). */
enum { FEWEST = 256, STEPS = 60 };

/* A plate that falls flat, and askew, on another one. */
static void meet(Surfaces *s, int32_t threads)
{
    surfaces_define(s);
    surfaces_place(surfaces_box(s, 0.12, 0.12, 0.01, 0.01), shv_vec3(0.0, 0.0, 0.01005), shv_vec3(0.5, 0.2, -2.0));
    surfaces_box(s, 0.12, 0.12, 0.01, 0.01)->placement.angular_velocity[2] = 30.0;
    surfaces_build(s, 0.3, false);
    s->model.threads = threads;
}

static void compare(const ShvSurfaceContact *a, const ShvSurfaceContact *b)
{
    assert_int_equal(a->pair_count, b->pair_count);
    assert_int_equal(a->distance_checks, b->distance_checks);
    for (int32_t k = 0; k < a->pair_count; k++) {
        const ShvFacetPair *x = &a->pairs[k], *y = &b->pairs[k];
        assert_memory_equal(x->nodes, y->nodes, sizeof x->nodes);
        assert_int_equal(x->element, y->element);
        assert_int_equal(x->face, y->face);
        assert_int_equal(x->edge, y->edge);
        assert_true(x->gap == y->gap && x->normal_impulse == y->normal_impulse);
    }
}

static void same_pairs_on_any_number_of_threads(void **unused)
{
    (void)unused;
    for (int32_t threads = 2; threads <= 3; threads++) {
        Surfaces one, more;
        meet(&one, 1);
        meet(&more, threads);
        const double step = surfaces_stable_step(&one);
        int32_t most = 0, pairs = 0;
        for (int i = 0; i < STEPS; i++) {
            const int64_t before = one.contact.distance_checks;
            surfaces_step(&one, step);
            surfaces_step(&more, step);
            compare(&one.contact, &more.contact);
            if (one.contact.pair_count > pairs) pairs = one.contact.pair_count;
            if (one.contact.distance_checks - before > most) most = (int32_t)(one.contact.distance_checks - before);
        }
        print_message("up to %d candidates looked at in a step, and %d pairs\n", most, pairs);
        assert_true(most >= FEWEST && pairs > 0);
        const size_t bytes = 3 * (size_t)one.state.node_count * sizeof(double);
        assert_memory_equal(one.state.velocity, more.state.velocity, bytes);
        surfaces_release(&one);
        surfaces_release(&more);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(same_pairs_on_any_number_of_threads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
