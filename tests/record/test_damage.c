/* Files that are no good run files: each gives a message. Where bytes were changed, HDF5 itself may crash; every try is a
   process of its own. */
#include "check.h"

#include <hdf5.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/memory.h"
#include "fake_simulation.h"
#include "files.h"
#include "shiver/run_file.h"

static const FakeSetup BREAKING = {.bricks = 8, .split_every = 2, .most = 15, .splits = 1, .probes = 2};

static void record_run(const char *path, int frames)
{
    ShvError error;
    ShvRecord *record;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    definition.scene_text = "shiver: 1\n";
    definition.nodes = true;
    ShvSimulation *simulation = fake_create(&BREAKING);
    check_ok(shv_record_create(&record, &definition, simulation, &error), error);
    for (int i = 0; i < frames; i++) {
        fake_advance(simulation);
        check_ok(shv_record_frame(record, simulation, &error), error);
    }
    check_ok(shv_record_close(record, SHV_OK, "", &error), error);
    fake_destroy(simulation);
}

static void check_refused(const char *path, ShvStatus status, const char *part)
{
    ShvError error;
    ShvRunFile *file;
    check_fails(shv_run_file_open(&file, path, NULL, &error), status, error, part);
    assert_null(file);
    assert_non_null(strstr(error.message, path));
}

static void make_hdf5(const char *path, int32_t format)
{
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), space = H5Screate(H5S_SCALAR);
    if (format > 0) {
        const hid_t attribute = H5Acreate2(file, "shiver_format", H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(attribute, H5T_NATIVE_INT32, &format);
        H5Aclose(attribute);
    }
    H5Sclose(space);
    H5Fclose(file);
}

static void test_other_files(void **state)
{
    const char *path = file_in(*state, "x.h5");
    check_refused(path, SHV_FILE_ERROR, "No such file");
    write_file(path, "", 0);
    check_refused(path, SHV_BAD_INPUT, "is empty");
    write_file(path, "time,x,y,z\n", 11);
    check_refused(path, SHV_BAD_INPUT, "no HDF5 file");
    make_hdf5(path, 0);
    check_refused(path, SHV_BAD_INPUT, "no run file of shiver");
    make_hdf5(path, 77);
    check_refused(path, SHV_BAD_INPUT, "has format 77");
    make_hdf5(path, SHV_RUN_FILE_FORMAT);
    check_refused(path, SHV_BAD_INPUT, "is damaged");
    check_refused(*state, SHV_BAD_INPUT, "not an ordinary file");
}

/* HDF5's own printing is off in our calls and as it was after them. */
static herr_t count_errors(hid_t stack, void *data)
{
    (void)stack;
    ++*(int *)data;
    return 0;
}

static void test_printing_of_hdf5_is_left_as_it_was(void **state)
{
    int printed = 0;
    void *data = NULL;
    H5E_auto2_t function = NULL;
    const char *path = file_in(*state, "x.h5");
    make_hdf5(path, 0);
    H5E_auto2_t before;
    void *before_data;
    H5Eget_auto2(H5E_DEFAULT, &before, &before_data);
    H5Eset_auto2(H5E_DEFAULT, count_errors, &printed);
    check_refused(path, SHV_BAD_INPUT, "no run file of shiver");
    H5Eget_auto2(H5E_DEFAULT, &function, &data);
    assert_int_equal(printed, 0);
    assert_true(function == count_errors && data == &printed);
    H5Eset_auto2(H5E_DEFAULT, before, before_data);
}

/* ---- damaged bytes ---- */

typedef enum Outcome { READ_ALL, REFUSED, CRASHED, BROKEN_RULE } Outcome;

/* Reads everything that a run file offers. Exit status 0: read, 1: refused with a message, 2: refused without one. */
static void read_everything(const char *path)
{
    ShvError error = {SHV_OK, ""};
    ShvRunFile *file;
    ShvStatus status = shv_run_file_open(&file, path, NULL, &error);
    if (status != SHV_OK) _exit(error.message[0] != '\0' && !file ? 1 : 2);
    const ShvRunFileInfo *info = shv_run_file_info(file);
    const size_t fragments = (size_t)info->fragment_count, elements = (size_t)info->element_count;
    double *values =
        shv_allocate(NULL, SHV_PART_GENERAL, 16 * (fragments + elements) + 3 * (size_t)info->node_count, 8);
    ShvFragmentView *views = shv_allocate(NULL, SHV_PART_GENERAL, fragments, sizeof *views);
    ShvObstacleView *obstacles = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)info->obstacle_count, sizeof *obstacles);
    int32_t *integers = shv_allocate(NULL, SHV_PART_GENERAL, 4 * elements, sizeof *integers);
    const ShvCostView *costs;
    const ShvBytesView *bytes;
    int32_t counts[2], mode;
    if (!values || !views || !obstacles || !integers) _exit(1);
    for (int64_t i = 0; i < info->frame_count && i < 10 && status == SHV_OK; i++) {
        status =
            shv_run_file_frame(file, i, values, &mode, (uint8_t *)integers, values, values, values, values, &error);
        if (status == SHV_OK) status = shv_run_file_ledger(file, i, &(ShvLedgerView){0}, &error);
        if (status == SHV_OK) status = shv_run_file_obstacles(file, i, obstacles, &error);
        if (status == SHV_OK && info->nodes) status = shv_run_file_corners(file, i, values, values, integers, &error);
    }
    for (int64_t i = 0; i < info->event_count && i < 10 && status == SHV_OK; i++)
        status = shv_run_file_event(file, i, &(ShvEventView){0}, &error);
    const size_t row = (size_t)info->probe_count * sizeof(ShvProbeSample);
    ShvProbeSample *samples = shv_allocate(NULL, SHV_PART_GENERAL, 1, row);
    if (!samples) _exit(1);
    for (int64_t i = 0; i < info->probe_row_count && i < 10 && status == SHV_OK; i++)
        status = shv_run_file_probes(file, i, 1, values, samples, &error);
    if (status == SHV_OK) status = shv_run_file_fragments(file, views, &error);
    if (status == SHV_OK) status = shv_run_file_mesh(file, values, integers, (uint16_t *)values, NULL, &error);
    if (status == SHV_OK) status = shv_run_file_mesh(file, NULL, NULL, NULL, integers, &error);
    if (status == SHV_OK) status = shv_run_file_cost(file, &costs, &counts[0], &bytes, &counts[1], &error);
    shv_run_file_close(file);
    _exit(status == SHV_OK ? 0 : error.message[0] != '\0' ? 1 : 2);
}

static Outcome try_file(const char *path)
{
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        signal(SIGSEGV, SIG_DFL);
        signal(SIGABRT, SIG_DFL);
        alarm(20);
        read_everything(path);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) return CRASHED;
    return WEXITSTATUS(status) == 0 ? READ_ALL : WEXITSTATUS(status) == 1 ? REFUSED : BROKEN_RULE;
}

static void test_truncated_anywhere(void **state)
{
    const char *path = file_in(*state, "run.h5"), *cut = file_in(*state, "cut.h5");
    record_run(path, 6);
    assert_int_equal(try_file(path), READ_ALL);
    const long size = file_size(path);
    char *bytes = read_bytes(path);
    for (int i = 0; i < 60; i++) {
        const long length = i < 20 ? i * 13 : size - 1 - (size * (i - 20)) / 40;
        write_file(cut, bytes, (size_t)length);
        assert_int_equal(try_file(cut), REFUSED);
    }
    free(bytes);
}

/* Changed bytes: nearly all are noticed, since values and structure have checksums. HDF5 1.10 may crash on some, which a
   reader cannot help; our own checks must not let them through to a wrong access of ours. */
static void test_changed_bytes(void **state)
{
    const char *path = file_in(*state, "run.h5"), *changed = file_in(*state, "changed.h5");
    record_run(path, 3);
    const long size = file_size(path);
    char *bytes = read_bytes(path);
    const int tries = getenv("SHIVER_FUZZ_TRIES") ? atoi(getenv("SHIVER_FUZZ_TRIES")) : 150;
    int outcomes[4] = {0, 0, 0, 0};
    uint64_t random = 88172645463325252u; /* xorshift64 (Marsaglia 2003) */
    for (int i = 0; i < tries; i++) {
        long places[4];
        char old[4];
        for (int k = 0; k < 4; k++) {
            random ^= random << 13, random ^= random >> 7, random ^= random << 17;
            places[k] = (long)(random % (uint64_t)(i % 2 ? size : 8192 < size ? 8192 : size));
            old[k] = bytes[places[k]];
            bytes[places[k]] = (char)(random >> 40);
        }
        write_file(changed, bytes, (size_t)size);
        const Outcome outcome = try_file(changed);
        outcomes[outcome]++;
        if (outcome == CRASHED && getenv("SHIVER_FUZZ_KEEP"))
            write_file(file_in(getenv("SHIVER_FUZZ_KEEP"), "crash.h5"), bytes, (size_t)size);
        for (int k = 3; k >= 0; k--) bytes[places[k]] = old[k];
    }
    free(bytes);
    print_message("read %d, refused %d, crashed %d, refused without a word %d\n", outcomes[READ_ALL], outcomes[REFUSED],
                  outcomes[CRASHED], outcomes[BROKEN_RULE]);
    assert_int_equal(outcomes[BROKEN_RULE], 0);
    assert_int_equal(outcomes[CRASHED], 0);
    assert_true(outcomes[READ_ALL] * 20 <= tries);
}

/* What a whole reading gives: the checksums that were verified, in one number; 0: refused. */
static uint32_t verified(const char *path)
{
    ShvError error;
    ShvRunFile *file;
    double values[8 * 3] = {0.0}; /* of fewer fragments where there are fewer */
    uint32_t sum = 1;
    if (shv_run_file_open(&file, path, NULL, &error) != SHV_OK) return 0;
    if (shv_run_file_verify(file, &error) != SHV_OK) sum = 0;
    for (int64_t i = 0; sum != 0 && i < shv_run_file_info(file)->frame_count; i++) {
        if (shv_run_file_info(file)->fragment_count > 8) sum = 0;
        if (sum != 0 && shv_run_file_frame(file, i, NULL, NULL, NULL, values, NULL, NULL, NULL, &error) == SHV_OK)
            for (int k = 0; k < 24; k++)
                sum = sum * 31 + (uint32_t)(int64_t)(1e6 * (isnan(values[k]) ? 0.5 : values[k]));
    }
    shv_run_file_close(file);
    return sum;
}

/* The same in a process of its own: HDF5 keeps memory of files that it could not close. */
static Outcome verify_apart(const char *path, uint32_t whole)
{
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        const uint32_t found = verified(path);
        _exit(found == whole ? 0 : found == 0 ? 1 : 2);
    }
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) return CRASHED;
    return WEXITSTATUS(status) == 0 ? READ_ALL : WEXITSTATUS(status) == 1 ? REFUSED : BROKEN_RULE;
}

/* One wrong bit anywhere: it is noticed, or it is in a byte that nobody reads. */
static void test_single_bits(void **state)
{
    enum { BITS = 400 };
    const char *path = file_in(*state, "run.h5"), *changed = file_in(*state, "changed.h5");
    record_run(path, 3);
    const uint32_t whole = verified(path);
    assert_true(whole != 0);
    const long size = file_size(path);
    char *bytes = read_bytes(path);
    int unread = 0;
    for (int i = 0; i < BITS; i++) {
        const long place = (long)((int64_t)size * i / BITS) + i % 7;
        if (place >= size) continue;
        bytes[place] = (char)(bytes[place] ^ (1 << i % 8));
        write_file(changed, bytes, (size_t)size);
        const Outcome outcome = verify_apart(changed, whole);
        if (outcome == BROKEN_RULE || outcome == CRASHED)
            fail_msg("a wrong bit in byte %ld of %ld: %s", place, size, outcome == CRASHED ? "a crash" : "not noticed");
        unread += outcome == READ_ALL;
        bytes[place] = (char)(bytes[place] ^ (1 << i % 8));
    }
    free(bytes);
    print_message("%d of %d wrong bits are in bytes that nobody reads\n", unread, BITS);
    assert_true(unread * 4 < BITS);
}

/* A chunk that holds fewer bytes than it says makes HDF5 1.10 read beyond its end. */
static void test_short_chunks(void **state)
{
    static const struct {
        const char *dataset;
        hsize_t offset[3];
    } chunks[] = {{"/mesh/positions", {0}}, {"/trajectory/position", {0}}, {"/trajectory/time", {0}},
                  {"/nodes/damage", {0}},   {"/fragments/elements", {0}},  {"/mesh/object_names", {0}}};
    for (size_t i = 0; i < sizeof chunks / sizeof *chunks; i++)
        for (unsigned left_out = 0; left_out < 2; left_out++) {
            static const unsigned char few[16] = {0x78, 0x9c, 3, 0, 0, 0, 0, 1};
            const char *path = file_in(*state, "run.h5");
            unlink(path);
            record_run(path, 2);
            const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
            const hid_t dataset = H5Dopen2(file, chunks[i].dataset, H5P_DEFAULT);
            assert_true(dataset >= 0);
            assert_true(H5Dwrite_chunk(dataset, H5P_DEFAULT, left_out ? 0xff : 0, chunks[i].offset, 8, few) >= 0);
            H5Dclose(dataset);
            H5Fclose(file);
            assert_int_equal(try_file(path), REFUSED);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_other_files, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_printing_of_hdf5_is_left_as_it_was, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_truncated_anywhere, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_changed_bytes, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_single_bits, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_short_chunks, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
