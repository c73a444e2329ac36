/* docs/scene.md against the tables. "test_reference --write FILE" writes it anew. */
#include "check.h"

#include <stdlib.h>

#include "base/file.h"
#include "scene/reference.h"
#include "shiver/scene.h"

static void page_is_that_of_the_tables(void **state)
{
    (void)state;
    char *expected = NULL, *page = NULL;
    size_t size = 0;
    ShvError error;
    check_ok(shv_scene_reference(NULL, &expected, &error), error);
    check_ok(shv_read_file(NULL, SHV_PART_SCENE, "../docs/scene.md", 1 << 20, &page, &size, &error), error);
    if (strcmp(expected, page) != 0)
        fail_msg("docs/scene.md differs from the tables; write it anew: scene_test_reference --write docs/scene.md");
    assert_null(strstr(expected, "| nan |")); /* a default that the page does not put into words */
    shv_release(expected);
    shv_release(page);
}

static void example_of_the_page_parses(void **state)
{
    (void)state;
    static const char open[] = "```yaml\n";
    char *page = NULL;
    ShvError error;
    check_ok(shv_scene_reference(NULL, &page, &error), error);
    char *example = strstr(page, open);
    assert_non_null(example);
    example += strlen(open);
    const size_t length = (size_t)(strstr(example, "```") - example);
    ShvScene *scene = NULL;
    ShvDiagnostics *diagnostics = NULL;
    check_ok(shv_scene_parse(&scene, example, length, "example", NULL, NULL, 0, NULL, &diagnostics, &error), error);
    assert_int_equal(shv_diagnostics_count(diagnostics), 0);
    assert_int_equal(shv_scene_definition(scene)->object_count, 1);
    shv_scene_destroy(scene);
    shv_diagnostics_destroy(diagnostics);
    shv_release(page);
}

static void lack_of_memory_is_reported(void **state)
{
    (void)state;
    for (int64_t count = 0;; count++) {
        ShvMemory *memory = shv_memory_create();
        char *page = NULL;
        ShvError error;
        shv_memory_fail_after(memory, count);
        const ShvStatus status = shv_scene_reference(memory, &page, &error);
        shv_release(page);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
        if (status == SHV_OK) break;
        assert_int_equal(status, SHV_NO_MEMORY);
        assert_true(count < 100);
    }
}

static int write_page(const char *path)
{
    char *page = NULL;
    ShvError error;
    if (shv_scene_reference(NULL, &page, &error) != SHV_OK) return EXIT_FAILURE;
    FILE *file = fopen(path, "w");
    const int written = file ? fputs(page, file) : EOF;
    shv_release(page);
    return file && fclose(file) == 0 && written >= 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int count, char **arguments)
{
    if (count == 3 && strcmp(arguments[1], "--write") == 0) return write_page(arguments[2]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(page_is_that_of_the_tables),
                                       cmocka_unit_test(example_of_the_page_parses),
                                       cmocka_unit_test(lack_of_memory_is_reported)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
