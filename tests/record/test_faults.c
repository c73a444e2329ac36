/* Every operation of a run on its files may fail, once or from then on: the run says so, and the file holds what was told. */
#include "check.h"

#include <errno.h>
#include <unistd.h>

#include "crash.h"
#include "files.h"
#include "shiver/run_file.h"

enum { FRAMES = 2 };

static int64_t refuse_all(const void *folder, const FakeSetup *setup, int number, bool always)
{
    const int64_t all = crash_operations(folder, setup, FRAMES);
    int64_t told = 0;
    for (int64_t at = 0; at < all; at++) {
        const char *path = file_in(folder, "run.h5");
        unlink(path);
        const int status = crash_refuse(path, setup, FRAMES, (CrashRefusal){at, number, always});
        if (status < 0) fail_msg("operation %lld failed and the writer crashed", (long long)at);
        const char *wrong = crash_check(path, setup);
        if (wrong) fail_msg("operation %lld failed: %s", (long long)at, wrong);
        if (status == SHV_OK && crash_counters()->frames < FRAMES) fail_msg("%lld: frames are missing", (long long)at);
        told += status != SHV_OK;
    }
    return told;
}

/* Failures that do no harm, such as that a temporary file cannot be removed, need not be told. */
static void check_told(const void *folder, const FakeSetup *setup, int number, bool always)
{
    const int64_t all = crash_operations(folder, setup, FRAMES);
    const int64_t told = refuse_all(folder, setup, number, always);
    assert_true(told >= all - 4);
}

static void test_one_operation_fails(void **state)
{
    check_told(*state, &CRASH_SETUP, EIO, false);
    check_told(*state, &CRASH_LAZY, EIO, false);
}

static void test_all_operations_fail_from_one_on(void **state)
{
    check_told(*state, &CRASH_SETUP, ENOSPC, true);
    check_told(*state, &CRASH_LAZY, EIO, true);
}

/* A file that was deleted or replaced while it was written is told of. */
static void test_file_that_goes_away(void **state)
{
    ShvError error;
    ShvRecord *record;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(*state, "run.h5");
    for (int replaced = 0; replaced < 2; replaced++) {
        ShvSimulation *simulation = fake_create(&CRASH_SETUP);
        check_ok(shv_record_create(&record, &definition, simulation, &error), error);
        fake_advance(simulation);
        check_ok(shv_record_frame(record, simulation, &error), error);
        unlink(definition.path);
        if (replaced) write_file(definition.path, "other", 5);
        check_fails(shv_record_close(record, SHV_OK, "", &error), SHV_FILE_ERROR, error,
                    replaced ? "was replaced by another file" : "was deleted or moved away");
        if (replaced) assert_int_equal(file_size(definition.path), 5);
        fake_destroy(simulation);
    }
}

/* Two runs that write one file: the second is refused, even with force. */
static void test_two_writers(void **state)
{
    ShvError error;
    ShvRecord *first, *second;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(*state, "run.h5");
    definition.force = true;
    ShvSimulation *simulation = fake_create(&CRASH_SETUP);
    check_ok(shv_record_create(&first, &definition, simulation, &error), error);
    check_ok(shv_record_create(&second, &definition, simulation, &error), error);
    fake_advance(simulation);
    check_ok(shv_record_frame(first, simulation, &error), error);
    check_fails(shv_record_frame(second, simulation, &error), SHV_BAD_INPUT, error, "being written");
    shv_record_close(second, SHV_BAD_INPUT, "", &error);
    check_fails(shv_record_create(&second, &definition, simulation, &error), SHV_BAD_INPUT, error, "being written");
    check_ok(shv_record_close(first, SHV_OK, "", &error), error);
    crash_expect(1);
    assert_null(crash_check(definition.path, &CRASH_SETUP));
    fake_destroy(simulation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_one_operation_fails, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_all_operations_fail_from_one_on, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_file_that_goes_away, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_two_writers, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
