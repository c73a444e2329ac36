#include "check.h"

#include "base/hash.h"

/* Published values of 64-bit FNV-1a. */
static void known_values(void **state)
{
    (void)state;
    assert_true(shv_hash_bytes(SHV_HASH_START, NULL, 0) == UINT64_C(0xcbf29ce484222325));
    assert_true(shv_hash_bytes(SHV_HASH_START, "a", 1) == UINT64_C(0xaf63dc4c8601ec8c));
    assert_true(shv_hash_bytes(SHV_HASH_START, "foobar", 6) == UINT64_C(0x85944171f73967e8));
}

static void pieces_give_the_hash_of_the_whole(void **state)
{
    (void)state;
    const uint64_t part = shv_hash_bytes(SHV_HASH_START, "foo", 3);
    assert_true(shv_hash_bytes(part, "bar", 3) == UINT64_C(0x85944171f73967e8));
}

static void texts_do_not_run_together(void **state)
{
    (void)state;
    const uint64_t a = shv_hash_text(shv_hash_text(SHV_HASH_START, "ab"), "c");
    const uint64_t b = shv_hash_text(shv_hash_text(SHV_HASH_START, "a"), "bc");
    assert_true(a != b);
    assert_true(shv_hash_text(SHV_HASH_START, NULL) != shv_hash_text(SHV_HASH_START, ""));
    assert_true(shv_hash_text(SHV_HASH_START, "ab") == shv_hash_bytes(SHV_HASH_START, "ab", 3));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_values),
        cmocka_unit_test(pieces_give_the_hash_of_the_whole),
        cmocka_unit_test(texts_do_not_run_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
