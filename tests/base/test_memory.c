#include "check.h"

#include "base/memory.h"

static void blocks_are_zero_aligned_and_counted(void **state)
{
    (void)state;
    ShvMemory *memory = shv_memory_create();
    assert_non_null(memory);
    for (size_t n = 0; n < 200; n++) {
        unsigned char *block = shv_allocate(memory, SHV_PART_MESH, n, 3);
        assert_non_null(block);
        assert_int_equal((uintptr_t)block % 64, 0);
        for (size_t i = 0; i < 3 * n; i++) assert_int_equal(block[i], 0);
        memset(block, 0xab, 3 * n); /* dirties what the next allocation may get again */
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_MESH), 3 * n);
        shv_release(block);
    }
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_MESH), 0);
    assert_int_equal(shv_memory_peak_bytes(memory, SHV_PART_MESH), 3 * 199);
    assert_int_equal(shv_memory_requests(memory), 200);
    shv_memory_destroy(memory);
}

static void parts_are_counted_apart_and_together(void **state)
{
    (void)state;
    ShvMemory *memory = shv_memory_create();
    void *a = shv_allocate(memory, SHV_PART_STATE, 10, 8), *b = shv_allocate(memory, SHV_PART_RIGID, 1, 5);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_STATE), 80);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_RIGID), 5);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_MESH), 0);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 85);
    shv_release(a);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 5);
    assert_int_equal(shv_memory_peak_bytes(memory, SHV_PART_COUNT), 85);
    shv_release(b);
    shv_release(NULL);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(memory);
}

static void growing_keeps_the_old_and_zeroes_the_new(void **state)
{
    (void)state;
    ShvMemory *memory = shv_memory_create();
    int32_t *block = shv_reallocate(memory, SHV_PART_COHESIVE, NULL, 3, sizeof *block);
    for (int i = 0; i < 3; i++) block[i] = i + 1;
    block = shv_reallocate(memory, SHV_PART_COHESIVE, block, 100, sizeof *block);
    assert_int_equal((uintptr_t)block % 64, 0);
    for (int i = 0; i < 100; i++) assert_int_equal(block[i], i < 3 ? i + 1 : 0);
    block = shv_reallocate(memory, SHV_PART_COHESIVE, block, 2, sizeof *block);
    assert_int_equal(block[1], 2);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COHESIVE), 8);
    block = shv_reallocate(memory, SHV_PART_COHESIVE, block, 3, sizeof *block);
    assert_int_equal(block[2], 0);
    shv_release(block);
    shv_memory_destroy(memory);
}

static void failures_are_injected_where_asked(void **state)
{
    (void)state;
    ShvMemory *memory = shv_memory_create();
    shv_memory_fail_after(memory, 2);
    char *a = shv_allocate(memory, SHV_PART_GENERAL, 4, 1), *b = shv_copy_text(memory, SHV_PART_GENERAL, "abc");
    assert_non_null(a);
    assert_string_equal(b, "abc");
    assert_null(shv_allocate(memory, SHV_PART_GENERAL, 1, 1));
    assert_null(shv_copy_text(memory, SHV_PART_GENERAL, "d"));
    assert_null(shv_reallocate(memory, SHV_PART_GENERAL, b, 100, 1));
    assert_string_equal(b, "abc");
    assert_int_equal(shv_memory_requests(memory), 5);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_GENERAL), 8);
    shv_memory_fail_after(memory, -1);
    b = shv_reallocate(memory, SHV_PART_GENERAL, b, 100, 1);
    assert_non_null(b);
    shv_release(a);
    shv_release(b);
    shv_memory_destroy(memory);
}

static void impossible_sizes_fail(void **state)
{
    (void)state;
    assert_null(shv_allocate(NULL, SHV_PART_GENERAL, SIZE_MAX / 4, 8));
    assert_null(shv_allocate(NULL, SHV_PART_GENERAL, SIZE_MAX, 1));
    void *empty = shv_allocate(NULL, SHV_PART_GENERAL, SIZE_MAX, 0);
    assert_non_null(empty);
    shv_release(empty);
}

/* A request that no machine could serve tells of a wrong number, not of memory that is out. */
static void misses_are_told_once(void **state)
{
    (void)state;
    ShvMemory *memory = shv_memory_create();
    assert_non_null(memory);
    (void)shv_memory_missed();
    shv_memory_fail_after(memory, 0);
    assert_null(shv_allocate(memory, SHV_PART_MESH, 1000, 1));
    assert_true(shv_memory_missed());
    assert_false(shv_memory_missed());
    assert_null(shv_allocate(memory, SHV_PART_MESH, (size_t)1 << 40, 1));
    assert_null(shv_allocate(memory, SHV_PART_MESH, SIZE_MAX, 2));
    assert_false(shv_memory_missed());
    shv_memory_destroy(memory);
}

static void no_counter_is_accepted(void **state)
{
    (void)state;
    shv_memory_fail_after(NULL, 0);
    double *block = shv_allocate(NULL, SHV_PART_GENERAL, 8, sizeof *block);
    assert_non_null(block);
    block = shv_reallocate(NULL, SHV_PART_GENERAL, block, 16, sizeof *block);
    assert_non_null(block);
    shv_release(block);
    assert_int_equal(shv_memory_requests(NULL), 0);
    assert_int_equal(shv_memory_bytes(NULL, SHV_PART_COUNT), 0);
    assert_int_equal(shv_memory_peak_bytes(NULL, SHV_PART_COUNT), 0);
    shv_memory_destroy(NULL);
}

static void counters_hold_from_many_threads(void **state)
{
    (void)state;
    enum { ROUNDS = 4000 };
    ShvMemory *memory = shv_memory_create();
    void *kept[ROUNDS];
#pragma omp parallel for num_threads(4)
    for (int i = 0; i < ROUNDS; i++) {
        void *passing = shv_allocate(memory, SHV_PART_CONTACT, 3, 1);
        kept[i] = shv_allocate(memory, SHV_PART_CONTACT, 7, 1);
        shv_release(passing);
    }
    assert_int_equal(shv_memory_requests(memory), 2 * ROUNDS);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_CONTACT), 7 * ROUNDS);
    assert_in_range(shv_memory_peak_bytes(memory, SHV_PART_CONTACT), 7 * ROUNDS, 7 * ROUNDS + 3 * 4);
#pragma omp parallel for num_threads(4)
    for (int i = 0; i < ROUNDS; i++) shv_release(kept[i]);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(memory);
}

static void parts_have_names_and_failures_one_wording(void **state)
{
    (void)state;
    for (int a = 0; a <= SHV_PART_COUNT; a++)
        for (int b = 0; b < a; b++) assert_string_not_equal(shv_part_name((ShvPart)a), shv_part_name((ShvPart)b));
    assert_string_equal(shv_part_name(SHV_PART_ADJACENCY), "adjacency");
    ShvError error;
    check_fails(shv_fail_memory(&error, "nodes", 24), SHV_NO_MEMORY, error, "out of memory for nodes (24 bytes)");
}

static ShvStatus pass_on(ShvStatus status, int *reached)
{
    SHV_TRY(status);
    *reached = 1;
    return SHV_OK;
}

static void try_returns_early_on_failure_only(void **state)
{
    (void)state;
    int reached = 0;
    assert_int_equal(pass_on(SHV_DIVERGED, &reached), SHV_DIVERGED);
    assert_int_equal(reached, 0);
    assert_int_equal(pass_on(SHV_OK, &reached), SHV_OK);
    assert_int_equal(reached, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_zero_aligned_and_counted),
        cmocka_unit_test(parts_are_counted_apart_and_together),
        cmocka_unit_test(growing_keeps_the_old_and_zeroes_the_new),
        cmocka_unit_test(failures_are_injected_where_asked),
        cmocka_unit_test(impossible_sizes_fail),
        cmocka_unit_test(misses_are_told_once),
        cmocka_unit_test(no_counter_is_accepted),
        cmocka_unit_test(counters_hold_from_many_threads),
        cmocka_unit_test(parts_have_names_and_failures_one_wording),
        cmocka_unit_test(try_returns_early_on_failure_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
