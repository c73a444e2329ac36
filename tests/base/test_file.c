#include "check.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"

static void check_join(const char *folder, const char *file, const char *expected)
{
    ShvError error;
    char *path;
    check_ok(shv_path_join(NULL, SHV_PART_SCENE, folder, file, &path, &error), error);
    assert_string_equal(path, expected);
    shv_release(path);
}

static void relative_names_are_seen_from_the_folder(void **state)
{
    (void)state;
    check_join("a/b", "c.obj", "a/b/c.obj");
    check_join("a/b/", "c.obj", "a/b/c.obj");
    check_join("a", "../c.obj", "a/../c.obj");
    check_join("", "c.obj", "c.obj");
    check_join(NULL, "c.obj", "c.obj");
    check_join("a/b", "/c.obj", "/c.obj");
    check_join("/", "c", "/c");
}

static void check_folder(const char *path, const char *expected)
{
    ShvError error;
    char *folder;
    check_ok(shv_path_folder(NULL, SHV_PART_SCENE, path, &folder, &error), error);
    assert_string_equal(folder, expected);
    shv_release(folder);
}

static void the_folder_of_a_path(void **state)
{
    (void)state;
    check_folder("a/b/c.yaml", "a/b");
    check_folder("c.yaml", "");
    check_folder("/c.yaml", "/");
}

/* A temporary file with these bytes; the name goes into `path`. */
static void write_file(char path[64], const char *bytes, size_t size)
{
    strcpy(path, "/tmp/shiver_test_XXXXXX");
    const int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, bytes, size), (ssize_t)size);
    close(descriptor);
}

static void whole_files_are_read_with_their_zeros(void **state)
{
    (void)state;
    char path[64], *data;
    size_t size;
    ShvError error;
    write_file(path, "ab\0c\n", 5);
    check_ok(shv_read_file(NULL, SHV_PART_SCENE, path, 5, &data, &size, &error), error);
    assert_int_equal(size, 5);
    assert_memory_equal(data, "ab\0c\n", 6);
    shv_release(data);
    check_fails(shv_read_file(NULL, SHV_PART_SCENE, path, 4, &data, &size, &error), SHV_BAD_INPUT, error,
                "longer than 4");
    assert_null(data);
    unlink(path);
    write_file(path, "", 0);
    check_ok(shv_read_file(NULL, SHV_PART_SCENE, path, 0, &data, &size, &error), error);
    assert_int_equal(size, 0);
    assert_string_equal(data, "");
    shv_release(data);
    unlink(path);
}

/* A pipe tells no length beforehand: the block has to grow. */
static void pipes_are_read_to_their_end(void **state)
{
    (void)state;
    enum { SENT = 30000 };
    static char sent[SENT];
    for (int i = 0; i < SENT; i++) sent[i] = (char)('a' + i % 26);
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], sent, SENT), SENT);
    close(ends[1]);
    char path[64], *data;
    snprintf(path, sizeof path, "/dev/fd/%d", ends[0]);
    size_t size;
    ShvError error;
    check_ok(shv_read_file(NULL, SHV_PART_SCENE, path, SENT, &data, &size, &error), error);
    assert_int_equal(size, SENT);
    assert_memory_equal(data, sent, SENT);
    shv_release(data);
    close(ends[0]);
}

/* A named pipe without a writer does not hold the program for ever. */
static void pipes_without_a_writer_are_left(void **state)
{
    (void)state;
    char path[64], *data;
    size_t size;
    ShvError error;
    snprintf(path, sizeof path, "/tmp/shiver_pipe_%ld", (long)getpid());
    assert_int_equal(mkfifo(path, 0600), 0);
    check_fails(shv_read_file(NULL, SHV_PART_SCENE, path, 10, &data, &size, &error), SHV_BAD_INPUT, error,
                "nothing has been written");
    unlink(path);
}

static void unreadable_files_are_named(void **state)
{
    (void)state;
    char *data;
    size_t size;
    ShvError error;
    check_fails(shv_read_file(NULL, SHV_PART_SCENE, "/nowhere/a.yaml", 10, &data, &size, &error), SHV_FILE_ERROR, error,
                "/nowhere/a.yaml");
    check_fails(shv_read_file(NULL, SHV_PART_SCENE, "/dev/zero", 10, &data, &size, &error), SHV_BAD_INPUT, error,
                "is a device");
    check_fails(shv_read_file(NULL, SHV_PART_SCENE, "/tmp", 10, &data, &size, &error), SHV_BAD_INPUT, error,
                "'/tmp' is a folder");
    assert_null(data);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    char path[64], *data;
    size_t size;
    ShvError error;
    write_file(path, "abc", 3);
    ShvMemory *memory = shv_memory_create();
    shv_memory_fail_after(memory, 0);
    check_fails(shv_read_file(memory, SHV_PART_SCENE, path, 9, &data, &size, &error), SHV_NO_MEMORY, error,
                "out of memory");
    assert_null(data);
    check_fails(shv_path_join(memory, SHV_PART_SCENE, "a", "b", &data, &error), SHV_NO_MEMORY, error, "a path");
    check_fails(shv_path_folder(memory, SHV_PART_SCENE, "a/b", &data, &error), SHV_NO_MEMORY, error, "a path");
    /* Growing fails after the first block was filled. */
    shv_memory_fail_after(memory, 1);
    int ends[2];
    static const char sent[10000];
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], sent, sizeof sent), (ssize_t)sizeof sent);
    close(ends[1]);
    char name[64];
    snprintf(name, sizeof name, "/dev/fd/%d", ends[0]);
    check_fails(shv_read_file(memory, SHV_PART_SCENE, name, 20000, &data, &size, &error), SHV_NO_MEMORY, error,
                "out of");
    assert_null(data);
    close(ends[0]);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(memory);
    unlink(path);
}

static double number(const char *text)
{
    ShvError error;
    double value = 0.0;
    check_ok(shv_parse_double(text, strlen(text), false, &value, &error), error);
    return value;
}

static void decimal_numbers_are_read_exactly(void **state)
{
    (void)state;
    check_near(number("1"), 1.0, 0.0);
    check_near(number("-2.5"), -2.5, 0.0);
    check_near(number("+.5"), 0.5, 0.0);
    check_near(number("7."), 7.0, 0.0);
    check_near(number("70e9"), 70e9, 0.0);
    check_near(number("3E-06"), 3e-6, 0.0);
    check_near(number("0.1"), 0.1, 0.0);
    check_near(number("1.7976931348623157e308"), 1.7976931348623157e308, 0.0);
    check_near(number("1e-400"), 0.0, 0.0);
    check_near(number("4.9e-324"), 0x1p-1074, 0.0);
    assert_true(signbit(number("-0")));
    double value = 0.0;
    ShvError error;
    check_ok(shv_parse_double("12345", 2, false, &value, &error), error); /* only the given length */
    check_near(value, 12.0, 0.0);
}

static void other_texts_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"",      " 1", "1 ",  "1,5", "0x10", "1e",  "1e+", ".",   "-",    "+-1",
                                        "1.2.3", "e5", "inf", "nan", "1f",   "1_0", "--1", "abc", "1e5.", "infinity"};
    ShvError error;
    double value = 77.0;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        check_fails(shv_parse_double(texts[i], strlen(texts[i]), false, &value, &error), SHV_BAD_INPUT, error,
                    "not a number");
        check_near(value, 77.0, 0.0);
    }
    check_fails(shv_parse_double("1e999", 5, false, &value, &error), SHV_BAD_INPUT, error, "beyond the largest");
    check_fails(shv_parse_double("-1e999", 6, true, &value, &error), SHV_BAD_INPUT, error, "beyond the largest");
    char many[600];
    memset(many, '1', sizeof many);
    check_fails(shv_parse_double(many, sizeof many, false, &value, &error), SHV_BAD_INPUT, error, "too long");
    assert_true(strlen(error.message) < 100); /* a long text is shown in part */
}

static void special_numbers_on_request_only(void **state)
{
    (void)state;
    ShvError error;
    double value = 0.0;
    check_ok(shv_parse_double("inf", 3, true, &value, &error), error);
    assert_true(isinf(value) && value > 0.0);
    check_ok(shv_parse_double("-Infinity", 9, true, &value, &error), error);
    assert_true(isinf(value) && value < 0.0);
    check_ok(shv_parse_double("NaN", 3, true, &value, &error), error);
    assert_true(isnan(value));
    check_ok(shv_parse_double("2.5", 3, true, &value, &error), error);
    check_near(value, 2.5, 0.0);
    check_fails(shv_parse_double("nano", 4, true, &value, &error), SHV_BAD_INPUT, error, "not a number");
    check_fails(shv_parse_double("", 0, true, &value, &error), SHV_BAD_INPUT, error, "not a number");
}

static void whole_numbers_up_to_their_limits(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int64_t value;
    } good[] = {{"0", 0},
                {"-0", 0},
                {"+12", 12},
                {"007", 7},
                {"9223372036854775807", INT64_MAX},
                {"-9223372036854775808", INT64_MIN}};
    ShvError error;
    int64_t value = 0;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        check_ok(shv_parse_int64(good[i].text, strlen(good[i].text), &value, &error), error);
        assert_true(value == good[i].value);
    }
    static const char *const bad[] = {"", "-", "1.0", "1e3", " 1", "0x1", "1 ", "a"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        check_fails(shv_parse_int64(bad[i], strlen(bad[i]), &value, &error), SHV_BAD_INPUT, error,
                    "not a whole number");
    static const char *const beyond[] = {"9223372036854775808", "-9223372036854775809", "99999999999999999999"};
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++)
        check_fails(shv_parse_int64(beyond[i], strlen(beyond[i]), &value, &error), SHV_BAD_INPUT, error, "64 bits");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(relative_names_are_seen_from_the_folder),
        cmocka_unit_test(the_folder_of_a_path),
        cmocka_unit_test(whole_files_are_read_with_their_zeros),
        cmocka_unit_test(pipes_are_read_to_their_end),
        cmocka_unit_test(unreadable_files_are_named),
        cmocka_unit_test(pipes_without_a_writer_are_left),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(decimal_numbers_are_read_exactly),
        cmocka_unit_test(other_texts_are_refused),
        cmocka_unit_test(special_numbers_on_request_only),
        cmocka_unit_test(whole_numbers_up_to_their_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
