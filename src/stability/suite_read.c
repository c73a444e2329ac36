/* Cases from the comments of scenes, and from the list of tests. */
#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "stability/suite.h"

enum { LONGEST_SCENE = 16 << 20, MOST_FILES = 1024 };

static ShvStatus new_case(ShvSuite *suite, ShvSuiteCase **item, ShvError *error)
{
    if (suite->count == suite->capacity) {
        const size_t capacity = suite->capacity ? 2 * (size_t)suite->capacity : 64;
        ShvSuiteCase *grown =
            shv_reallocate(suite->options.memory, SHV_PART_RECORD, suite->cases, capacity, sizeof *suite->cases);
        if (!grown) return shv_fail_memory(error, "the suite", capacity * sizeof *suite->cases);
        suite->cases = grown;
        suite->capacity = (int32_t)capacity;
    }
    *item = &suite->cases[suite->count++];
    memset(*item, 0, sizeof **item);
    return SHV_OK;
}

/* ---- comments of a scene ---- */

typedef struct Place {
    const char *folder, *file;
    int line;
    int32_t first; /* case of the file */
} Place;

static ShvStatus bad(const Place *place, const char *what, ShvError *error)
{
    return shv_fail(error, SHV_BAD_INPUT, "%s/%s:%d: %s", place->folder, place->file, place->line, what);
}

/* "3: a title" */
static ShvStatus begin_case(ShvSuite *suite, const Place *place, const char *text, ShvError *error)
{
    const char *colon = strchr(text, ':');
    ShvSuiteCase *item = NULL;
    if (!colon) return bad(place, "`case` needs a number, a colon and a title", error);
    SHV_TRY(new_case(suite, &item, error));
    item->first = place->first < suite->count - 1 ? place->first : suite->count - 1;
    shv_format(item->row.number, sizeof item->row.number, "%.*s", (int)(colon - text), text);
    shv_format(item->row.title, sizeof item->row.title, "%s", colon + 1 + strspn(colon + 1, " "));
    shv_format(item->row.file, sizeof item->row.file, "%s", place->file);
    shv_format(item->path, sizeof item->path, "%s/%s", place->folder, place->file);
    return SHV_OK;
}

static void append(char *text, size_t size, const char *part)
{
    const size_t length = strlen(text);
    shv_format(text + length, size - length, "%s%s", length ? "; " : "", part);
}

static ShvStatus add_expectation(ShvSuiteCase *item, const Place *place, const char *text, ShvError *error)
{
    if (item->expectation_count == SHV_MOST_EXPECTATIONS) return bad(place, "too many expectations", error);
    char *kept = item->expectations[item->expectation_count++];
    if (shv_format(kept, sizeof item->expectations[0], "%s", text) >= (int)sizeof item->expectations[0])
        return bad(place, "the expectation is too long", error);
    append(item->row.expected, sizeof item->row.expected, text);
    return SHV_OK;
}

static const char *value_of(const char *line, const char *key)
{
    const size_t length = strlen(key);
    if (strncmp(line, key, length) != 0) return NULL;
    return line + length + strspn(line + length, " ");
}

static ShvStatus read_line(ShvSuite *suite, const Place *place, const char *line, ShvError *error)
{
    const char *value = value_of(line, "case ");
    if (value) return begin_case(suite, place, value, error);
    if (suite->count <= place->first) return bad(place, "a `case` comes first", error);
    ShvSuiteCase *item = &suite->cases[suite->count - 1];
    if ((value = value_of(line, "set:")))
        append(item->row.overrides, sizeof item->row.overrides, value);
    else if ((value = value_of(line, "expect:")))
        return add_expectation(item, place, value, error);
    else if ((value = value_of(line, "explained:")))
        append(item->row.explained, sizeof item->row.explained, value);
    else if (strcmp(line, "long") == 0)
        item->is_long = true;
    else
        return bad(place, "none of case, set, expect, explained, long follows `#!`", error);
    return SHV_OK;
}

/* Lines of a text, one after the other; the text is cut up. */
static char *next_line(char **text)
{
    char *line = *text, *end = line + strcspn(line, "\n");
    if (!*line) return NULL;
    *text = *end ? end + 1 : end;
    *end = '\0';
    if (end > line && end[-1] == '\r') end[-1] = '\0';
    return line;
}

static ShvStatus read_scene(ShvSuite *suite, const char *file, ShvError *error)
{
    char path[1024], *text = NULL;
    size_t size = 0;
    Place place = {.folder = suite->folder, .file = file, .first = suite->count};
    shv_format(path, sizeof path, "%s/%s", suite->folder, file);
    SHV_TRY(shv_read_file(suite->options.memory, SHV_PART_SCENE, path, LONGEST_SCENE, &text, &size, error));
    ShvStatus status = SHV_OK;
    char *at = text, *line;
    while (status == SHV_OK && (line = next_line(&at))) {
        place.line++;
        const char *words = value_of(line, "#!");
        if (words) status = read_line(suite, &place, words, error);
    }
    for (int32_t i = place.first; i < suite->count && status == SHV_OK; i++)
        if (suite->cases[i].expectation_count == 0) status = bad(&place, "a case expects nothing", error);
    shv_release(text);
    return status;
}

/* ---- tests ---- */

/* Cuts "a | b | c | d" in place. */
static bool cut(char *line, char *parts[4])
{
    for (int i = 0; i < 4; i++) {
        parts[i] = line + strspn(line, " ");
        char *end = i < 3 ? strchr(line, '|') : line + strlen(line);
        if (!end) return false;
        line = *end ? end + 1 : end;
        while (end > parts[i] && end[-1] == ' ') end--;
        *end = '\0';
        if (!*parts[i]) return false;
    }
    return true;
}

/* A test covers its case if its function stands in its source. */
static void look_up(const ShvSuite *suite, ShvSuiteCase *item, const char *test, const char *function)
{
    char path[1200], wanted[256], *text = NULL;
    size_t size = 0;
    ShvError ignored;
    ShvSuiteRow *row = &item->row;
    if (suite->options.tests)
        shv_format(path, sizeof path, "%s/%s.c", suite->options.tests, test);
    else
        shv_format(path, sizeof path, "%s/../../tests/%s.c", suite->folder, test);
    shv_format(wanted, sizeof wanted, "cmocka_unit_test(%s)", function);
    shv_format(row->file, sizeof row->file, "ctest -R %s", test);
    shv_format(row->expected, sizeof row->expected, "%s", function);
    const bool read =
        shv_read_file(suite->options.memory, SHV_PART_SCENE, path, LONGEST_SCENE, &text, &size, &ignored) == SHV_OK;
    const bool there = read && strstr(text, wanted);
    shv_format(row->found, sizeof row->found, "%s", there ? "in the tests" : read ? "no such test" : "no such file");
    row->verdict = there ? SHV_SUITE_PASS : SHV_SUITE_MISS;
    item->has_run = true;
    shv_release(text);
}

static ShvStatus read_tests(ShvSuite *suite, ShvError *error)
{
    char path[1024], *text = NULL, *line, *parts[4];
    size_t size = 0;
    shv_format(path, sizeof path, "%s/covered.txt", suite->folder);
    FILE *there = fopen(path, "r");
    if (!there) return SHV_OK;
    fclose(there);
    SHV_TRY(shv_read_file(suite->options.memory, SHV_PART_SCENE, path, LONGEST_SCENE, &text, &size, error));
    ShvStatus status = SHV_OK;
    Place place = {.folder = suite->folder, .file = "covered.txt"};
    for (char *at = text; status == SHV_OK && (line = next_line(&at));) {
        ShvSuiteCase *item = NULL;
        place.line++;
        if (line[0] == '#' || line[0] == '\0') continue;
        if (!cut(line, parts)) {
            status = bad(&place, "a line is `number | title | module/test_noun | function`", error);
            break;
        }
        status = new_case(suite, &item, error);
        if (status != SHV_OK) break;
        shv_format(item->row.number, sizeof item->row.number, "%s", parts[0]);
        shv_format(item->row.title, sizeof item->row.title, "%s", parts[1]);
        look_up(suite, item, parts[2], parts[3]);
    }
    shv_release(text);
    return status;
}

/* ---- the folder ---- */

typedef struct Names {
    char names[MOST_FILES][128];
    int count;
} Names;

static int compare_names(const void *a, const void *b)
{
    return strcmp(a, b);
}

static ShvStatus list_scenes(const ShvSuite *suite, Names *names, ShvError *error)
{
    DIR *folder = opendir(suite->folder);
    if (!folder)
        return shv_fail(error, SHV_FILE_ERROR, "there is no folder %s; name the one with the suite's scenes",
                        suite->folder);
    ShvStatus status = SHV_OK;
    for (struct dirent *entry; (entry = readdir(folder));) {
        const size_t length = strlen(entry->d_name);
        if (length < 6 || length >= sizeof names->names[0] || strcmp(entry->d_name + length - 5, ".yaml") != 0)
            continue;
        if (names->count == MOST_FILES) {
            status = shv_fail(error, SHV_BAD_INPUT, "%s has more than %d scenes", suite->folder, MOST_FILES);
            break;
        }
        shv_format(names->names[names->count++], sizeof names->names[0], "%s", entry->d_name);
    }
    closedir(folder);
    qsort(names->names, (size_t)names->count, sizeof names->names[0], compare_names);
    return status;
}

ShvStatus shv_suite_read(ShvSuite *suite, ShvError *error)
{
    Names *names = shv_allocate(suite->options.memory, SHV_PART_RECORD, 1, sizeof *names);
    if (!names) return shv_fail_memory(error, "names of scenes", sizeof *names);
    ShvStatus status = list_scenes(suite, names, error);
    for (int i = 0; i < names->count && status == SHV_OK; i++) status = read_scene(suite, names->names[i], error);
    if (status == SHV_OK) status = read_tests(suite, error);
    if (status == SHV_OK && suite->count == 0)
        status = shv_fail(error, SHV_BAD_INPUT, "no scene in %s states a case (`#! case …`)", suite->folder);
    shv_release(names);
    return status;
}
