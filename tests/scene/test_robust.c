/* Whatever the bytes: a scene or a message, nothing leaked, in bounded time. */
#include "check.h"

#include <stdlib.h>

#include "base/file.h"
#include "base/random.h"
#include "parse.h"

static char *read_full(size_t *size)
{
    char *text = NULL;
    ShvError error;
    check_ok(shv_read_file(NULL, SHV_PART_SCENE, "scene/full.yaml", 1 << 20, &text, size, &error), error);
    return text;
}

/* Either a scene and no errors, or errors that are put into words and no scene. */
static ShvStatus check_outcome(const char *text, size_t length)
{
    Parsed parsed = parse_bytes(text, length, NULL, 0);
    const ShvStatus status = parsed.status;
    if (status == SHV_OK) {
        assert_non_null(parsed.scene);
        assert_int_equal(shv_diagnostics_errors(parsed.diagnostics), 0);
    } else {
        assert_int_equal(status, SHV_BAD_INPUT);
        assert_null(parsed.scene);
        assert_true(shv_diagnostics_errors(parsed.diagnostics) > 0);
        assert_true(shv_diagnostics_count(parsed.diagnostics) > 0);
    }
    release(&parsed);
    return status;
}

/* A file cut anywhere before its last line lacks the duration, which must be there. */
static void every_truncation_is_noticed(void **state)
{
    (void)state;
    size_t size = 0;
    char *text = read_full(&size);
    const size_t last_line = size - strlen("duration: 1.5\n");
    assert_memory_equal(text + last_line, "duration", 8);
    for (size_t length = 0; length < size; length++) {
        char *cut = malloc(length + 1); /* a block of its own, so that a read beyond the end is caught */
        assert_non_null(cut);
        memcpy(cut, text, length);
        const ShvStatus status = check_outcome(cut, length);
        if (length < last_line && status == SHV_OK) fail_msg("a scene cut at byte %zu was taken", length);
        free(cut);
    }
    shv_release(text);
}

static void flipped_bytes_are_survived(void **state)
{
    (void)state;
    enum { TRIALS = 400, MOST_FLIPS = 8 };
    size_t size = 0;
    char *text = read_full(&size), *flipped = malloc(size);
    assert_non_null(flipped);
    int refused = 0;
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        memcpy(flipped, text, size);
        const uint64_t flips = 1 + shv_random_bits(1, trial * 100) % MOST_FLIPS;
        for (uint64_t k = 0; k < flips; k++) {
            const uint64_t bits = shv_random_bits(1, trial * 100 + 1 + k);
            /* Half of them stay printable, so that YAML and keys are reached and not only the check of bytes. */
            const unsigned char byte = (unsigned char)(bits >> 32);
            flipped[bits % size] = (char)(trial % 2 ? byte : 32 + byte % 95);
        }
        refused += check_outcome(flipped, size) != SHV_OK;
    }
    assert_true(refused > TRIALS / 2);
    free(flipped);
    shv_release(text);
}

static void every_lack_of_memory_is_reported(void **state)
{
    (void)state;
    size_t size = 0;
    char *text = read_full(&size);
    static const char *const overrides[] = {"objects.plate.mesh.box.edge=4 mm", "seed=3"};
    bool done = false;
    for (int64_t count = 0; !done; count++) {
        Parsed parsed = {.memory = shv_memory_create()};
        shv_memory_fail_after(parsed.memory, count);
        parsed.status = shv_scene_parse(&parsed.scene, text, size, "s.yaml", "scene", overrides, 2, parsed.memory,
                                        &parsed.diagnostics, &parsed.error);
        done = parsed.status == SHV_OK;
        if (!done) {
            assert_int_equal(parsed.status, SHV_NO_MEMORY);
            assert_non_null(strstr(parsed.error.message, "memory"));
            assert_null(parsed.scene);
            assert_null(parsed.diagnostics);
        }
        assert_true(count < 1000);
        release(&parsed);
    }
    shv_release(text);
}

static void every_lack_of_memory_is_reported_by_load(void **state)
{
    (void)state;
    bool done = false;
    for (int64_t count = 0; !done; count++) {
        Parsed parsed = {.memory = shv_memory_create()};
        shv_memory_fail_after(parsed.memory, count);
        parsed.status = shv_scene_load(&parsed.scene, "scene/full.yaml", NULL, 0, parsed.memory, &parsed.diagnostics,
                                       &parsed.error);
        done = parsed.status == SHV_OK;
        if (!done) assert_int_equal(parsed.status, SHV_NO_MEMORY);
        release(&parsed);
    }
}

/* `unit` over and over after `head`. */
static char *repeated(const char *head, const char *unit, size_t count, const char *tail, size_t *length)
{
    const size_t h = strlen(head), u = strlen(unit), t = strlen(tail);
    char *text = malloc(h + u * count + t + 1);
    assert_non_null(text);
    memcpy(text, head, h);
    for (size_t i = 0; i < count; i++) memcpy(text + h + i * u, unit, u);
    memcpy(text + h + u * count, tail, t + 1);
    *length = h + u * count + t;
    return text;
}

static void check_refused(char *text, size_t length, const char *part)
{
    Parsed parsed = parse_bytes(text, length, NULL, 0);
    free(text);
    assert_int_equal(parsed.status, SHV_BAD_INPUT);
    if (!strstr(parsed.error.message, part)) fail_msg("message lacks '%s': %s", part, parsed.error.message);
    release(&parsed);
}

static void limits_hold(void **state)
{
    (void)state;
    size_t length;
    char *text = repeated("", "#", ((size_t)16 << 20) + 1, "", &length);
    check_refused(text, length, "has at most 16777216");
    text = repeated("a: ", "[", 8000000, "", &length);
    check_refused(text, length, "more than 32 brackets are opened in a row");
    text = repeated("a: ", "{ \n", 2000000, "", &length);
    check_refused(text, length, "more than 32 brackets are opened in a row");
    text = repeated("a: ", "[0, ", 40, "", &length);
    check_refused(text, length, "nested more than 32 deep");
    text = repeated("", "- ", 4000000, "", &length);
    check_refused(text, length, "nested more than 32 deep");
    text = repeated("", "? ", 4000000, "", &length);
    check_refused(text, length, "");
    text = repeated("a: [", "1,", 1100000, "]", &length);
    check_refused(text, length, "more than 1000000 values");
    text = repeated("a: [", "&a x,", 300000, "]", &length);
    check_refused(text, length, "unknown key 'a'");
}

/* libfyaml 0.7.12 frees a key twice over these, and the program ended in a signal. */
static void tabs_after_complex_keys_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"? a:\t|\n",        "? a:\t? b\n",    "? a:\t- b\n",   "? a: \t > b\n: c",
                                        "? - a\n  - b:\t|", "a:\n - ? b:\t|", "?\na:\t\t: c\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        size_t length;
        char *text = repeated(texts[i], "", 0, "", &length);
        check_refused(text, length, "a tab follows this colon");
    }
    static const char *const good[] = {"name:\tx\n", "name:\t- x\n", "name: what ? is\n", "? name\n: a\tb\n"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        Parsed parsed = parse_bytes(good[i], strlen(good[i]), NULL, 0);
        if (strstr(parsed.error.message, "tab follows")) fail_msg("%s: %s", good[i], parsed.error.message);
        release(&parsed);
    }
}

/* Ten references to ten references to …: tiny as a file, 10^9 values when it is followed. */
static void alias_bombs_are_defused(void **state)
{
    (void)state;
    static const char bomb[] = "a: &a [1,1,1,1,1,1,1,1,1,1]\n"
                               "b: &b [*a,*a,*a,*a,*a,*a,*a,*a,*a,*a]\n"
                               "c: &c [*b,*b,*b,*b,*b,*b,*b,*b,*b,*b]\n"
                               "d: &d [*c,*c,*c,*c,*c,*c,*c,*c,*c,*c]\n"
                               "e: &e [*d,*d,*d,*d,*d,*d,*d,*d,*d,*d]\n"
                               "f: &f [*e,*e,*e,*e,*e,*e,*e,*e,*e,*e]\n"
                               "g: &g [*f,*f,*f,*f,*f,*f,*f,*f,*f,*f]\n"
                               "h: &h [*g,*g,*g,*g,*g,*g,*g,*g,*g,*g]\n";
    Parsed parsed = parse_bytes(bomb, strlen(bomb), NULL, 0);
    assert_string_equal(message(&parsed, 0),
                        "s.yaml:6:7: error: more than 1000000 values, those of aliases counted as often "
                        "as they are used");
    release(&parsed);
}

static void many_anchors_are_refused(void **state)
{
    (void)state;
    char text[300 * 16] = "a: [";
    for (int i = 0; i < 300; i++) snprintf(text + strlen(text), sizeof text - strlen(text), "&a%d 1,", i);
    Parsed parsed = parse_bytes(text, strlen(text), NULL, 0);
    assert_non_null(strstr(message(&parsed, 0), "more than 256 anchors"));
    release(&parsed);
}

/* Thousands of faults are counted; the first 200 are told. */
static void many_faults_are_counted(void **state)
{
    (void)state;
    size_t length;
    char *text = repeated("shiver: 1\nevents: [", "{at: x},", 3000, "]\n", &length);
    Parsed parsed = parse_bytes(text, length, NULL, 0);
    free(text);
    assert_int_equal(shv_diagnostics_count(parsed.diagnostics), 200);
    assert_int_equal(shv_diagnostics_errors(parsed.diagnostics), 3000 * 2 + 1);
    assert_null(shv_diagnostics_get(parsed.diagnostics, 200));
    release(&parsed);
}

/* Long values are cut between characters and control characters do not reach the terminal. */
static void quotes_are_short_and_clean(void **state)
{
    (void)state;
    static const char text[] =
        SMALL_SCENE "threads: \"\\e[31m\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9"
                    "\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9"
                    "\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\"\n";
    Parsed parsed = parse_bytes(text, strlen(text), NULL, 0);
    const char *first = message(&parsed, 0);
    assert_non_null(strstr(first, "threads is '?[31m\xC3\xA9"));
    assert_non_null(strstr(first, "\xC3\xA9...';"));
    release(&parsed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_truncation_is_noticed),
        cmocka_unit_test(flipped_bytes_are_survived),
        cmocka_unit_test(every_lack_of_memory_is_reported),
        cmocka_unit_test(every_lack_of_memory_is_reported_by_load),
        cmocka_unit_test(limits_hold),
        cmocka_unit_test(tabs_after_complex_keys_are_refused),
        cmocka_unit_test(alias_bombs_are_defused),
        cmocka_unit_test(many_anchors_are_refused),
        cmocka_unit_test(many_faults_are_counted),
        cmocka_unit_test(quotes_are_short_and_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
