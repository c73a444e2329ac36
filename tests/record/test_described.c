/* docs/run_file.md against a run file with everything in it: each describes or holds what the other has. */
#include "check.h"

#include <ctype.h>
#include <hdf5.h>
#include <stdlib.h>

#include "base/memory.h"
#include "fake_simulation.h"
#include "files.h"
#include "record/record.h"

enum { MOST = 128, NAME = 128 };

typedef struct Page {
    char *text, *header; /* the page, and the header whose structures it names */
    char datasets[MOST][NAME];
    const char *rows[MOST]; /* lines of the page that tell of them */
    int count, seen;
} Page;

static const char *record_everything(void *folder)
{
    static const FakeSetup setup = {.bricks = 8, .split_every = 2, .most = 15, .splits = 1, .probes = 2};
    ShvError error;
    ShvRecord *record;
    ShvSimulation *simulation = fake_create(&setup);
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(folder, "run.h5");
    definition.nodes = true;
    check_ok(shv_record_create(&record, &definition, simulation, &error), error);
    for (int i = 0; i < 4; i++) {
        fake_advance(simulation);
        check_ok(shv_record_frame(record, simulation, &error), error);
    }
    check_ok(shv_record_close(record, SHV_OK, "", &error), error);
    fake_destroy(simulation);
    return definition.path;
}

/* The names between back quotes in the first cell of a row: without a slash, one beside the name before it. */
static void add_row(Page *page, const char *row)
{
    const char *end = strchr(row + 1, '|'), *at = row;
    char group[NAME] = "";
    while ((at = strchr(at, '`')) && at < end) {
        const int length = (int)strcspn(++at, "`");
        assert_true(page->count < MOST);
        char *name = page->datasets[page->count];
        snprintf(name, NAME, "%s%.*s", *at == '/' ? "" : group, length, at);
        snprintf(group, NAME, "%.*s", (int)(strrchr(name, '/') - name + 1), name);
        page->rows[page->count++] = row;
        at += length + 1;
    }
}

static void read_page(Page *page)
{
    page->text = read_bytes("../docs/run_file.md");
    page->header = read_bytes("../include/shiver/simulation.h");
    const char *at = strstr(page->text, "## Datasets"), *end = strstr(page->text, "## Checksums");
    assert_true(at && end);
    for (; at < end; at = strchr(at, '\n') + 1)
        if (strncmp(at, "| `", 3) == 0) add_row(page, at);
    assert_true(page->count > 50);
}

/* A whole word of a text that ends at `end`. */
static bool has_word(const char *text, const char *end, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = text; (at = strstr(at, word)) && at < end; at += length)
        if (!isalnum((unsigned char)at[-1]) && at[-1] != '_' && !isalnum((unsigned char)at[length]) &&
            at[length] != '_')
            return true;
    return false;
}

/* Columns are named in the dataset's row, or by the structure of the header that the row names. */
static void check_columns(const Page *page, int index, hid_t dataset)
{
    const hid_t type = H5Dget_type(dataset);
    const char *row = page->rows[index], *end = strchr(row, '\n');
    const bool in_header = has_word(row, end, "ShvEventView") || has_word(row, end, "ShvLedgerView");
    for (int i = 0; H5Tget_class(type) == H5T_COMPOUND && i < H5Tget_nmembers(type); i++) {
        char *column = H5Tget_member_name(type, (unsigned)i);
        if (!has_word(row, end, column) &&
            !(in_header && has_word(page->header + 1, page->header + strlen(page->header), column)))
            fail_msg("%s has a column '%s' that docs/run_file.md does not describe", page->datasets[index], column);
        H5free_memory(column);
    }
    H5Tclose(type);
}

static herr_t check_attribute(hid_t object, const char *name, const H5A_info_t *info, void *given)
{
    (void)object;
    (void)info;
    const Page *page = given;
    char quoted[NAME];
    snprintf(quoted, sizeof quoted, "`%s`", name);
    if (!strstr(page->text, quoted)) fail_msg("docs/run_file.md does not describe the attribute '%s'", name);
    return 0;
}

static herr_t check_object(hid_t file, const char *name, const H5L_info_t *info, void *given)
{
    (void)info;
    Page *page = given;
    const hid_t object = H5Oopen(file, name, H5P_DEFAULT);
    assert_true(H5Aiterate(object, H5_INDEX_NAME, H5_ITER_INC, NULL, check_attribute, page) >= 0);
    if (H5Iget_type(object) == H5I_DATASET) {
        int index = 0;
        while (index < page->count && strcmp(page->datasets[index] + 1, name) != 0) index++;
        if (index == page->count) fail_msg("docs/run_file.md does not describe /%s", name);
        check_columns(page, index, object);
        page->seen++;
    }
    H5Oclose(object);
    return 0;
}

static void test_page_describes_the_file(void **state)
{
    Page page = {.count = 0};
    read_page(&page);
    const hid_t file = H5Fopen(record_everything(*state), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    assert_true(H5Aiterate(file, H5_INDEX_NAME, H5_ITER_INC, NULL, check_attribute, &page) >= 0);
    assert_true(H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, check_object, &page) >= 0);
    for (int i = 0; i < page.count; i++)
        if (H5Lexists(file, page.datasets[i], H5P_DEFAULT) <= 0)
            fail_msg("docs/run_file.md describes %s, which no run file has", page.datasets[i]);
    assert_int_equal(page.seen, page.count);
    H5Fclose(file);
    free(page.text);
    free(page.header);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_page_describes_the_file, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
