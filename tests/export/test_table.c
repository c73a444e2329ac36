/* One table in all forms: heads above their figures, each form's own escapes. Members of JSON. */
#include "check.h"

#include "cli/json.h"
#include "export/output.h"
#include "export/table.h"

static char text[1 << 12];

static void read_back(FILE *stream)
{
    rewind(stream);
    text[fread(text, 1, sizeof text - 1, stream)] = '\0';
    fclose(stream);
}

static void check_form(ShvTableForm form, const char *wanted)
{
    static const char *const names[] = {"", "a|b", "", "c, \"d\" <e>"};
    FILE *stream = tmpfile();
    assert_non_null(stream);
    ShvTable table = shv_table_begin(stream, form);
    for (int i = 0; i < 4; i++) {
        shv_table_text(&table, "run & name", NULL, names[i]);
        shv_table_put(&table, "error", i == 1 ? "number best" : "number", "%.2f", 0.5 * i);
        shv_table_end_row(&table);
    }
    shv_table_end(&table);
    read_back(stream);
    assert_string_equal(text, wanted);
}

static void test_forms(void **state)
{
    (void)state;
    check_form(SHV_TABLE_MARKDOWN, "| run & name | error |\n|---|--:|\n| a\\|b | **0.50** |\n|  | 1.00 |\n"
                                   "| c, \"d\" <e> | 1.50 |\n");
    check_form(SHV_TABLE_CSV, "run & name,error\na|b,0.50\n,1.00\n\"c, \"\"d\"\" <e>\",1.50\n");
    check_form(
        SHV_TABLE_HTML,
        "<div class=\"wide\"><table>\n<thead><tr><th>run &amp; name</th>\n<th>error</th>\n</tr></thead>\n<tbody>\n"
        "<tr><td>a|b</td><td class=\"number best\">0.50</td></tr>\n"
        "<tr><td></td><td class=\"number\">1.00</td></tr>\n"
        "<tr><td>c, &quot;d&quot; &lt;e&gt;</td><td class=\"number\">1.50</td></tr>\n</tbody>\n</table></div>\n");
}

static void put_row(ShvTable *table, const void *data, int32_t index)
{
    static const char *const names[] = {"ä", "longer"};
    shv_table_text(table, "run", NULL, names[index]);
    shv_table_number(table, "error", "m", index == 0 ? "number best" : "number", "%.3g", ((const double *)data)[index]);
    shv_table_flag(table, "so", index == 0);
}

static void check_numbers(ShvTableForm form, int32_t count, const char *wanted)
{
    static const double errors[] = {1.0 / 3.0, (double)NAN};
    FILE *stream = tmpfile();
    assert_non_null(stream);
    shv_table_write(stream, form, count, put_row, errors);
    read_back(stream);
    assert_string_equal(text, wanted);
}

/* A terminal's columns are below each other; numbers are full where a program reads them. */
static void test_numbers(void **state)
{
    (void)state;
    check_numbers(SHV_TABLE_TEXT, 2, "run     error, m  so\nä         0.333*  yes\nlonger        -   \n");
    check_numbers(SHV_TABLE_JSON, 2,
                  "[\n {\"run\": \"ä\", \"error\": 0.3333333333333333, \"so\": true},\n "
                  "{\"run\": \"longer\", \"error\": null, \"so\": false}\n]");
    assert_true(json_valid(text));
    check_numbers(SHV_TABLE_JSON, 0, "[\n]");
    check_numbers(SHV_TABLE_CSV, 2, "run,error [m],so\nä,0.3333333333333333,yes\nlonger,,\n");
    check_numbers(SHV_TABLE_MARKDOWN, 2,
                  "| run | error, m | so |\n|---|--:|---|\n| ä | **0.333** | yes |\n| longer | – |  |\n");
    check_numbers(SHV_TABLE_TEXT, 0, "");
}

static void test_members(void **state)
{
    (void)state;
    FILE *stream = tmpfile();
    assert_non_null(stream);
    ShvMembers members = {.stream = stream};
    fputs("{", stream);
    shv_member_text(&members, "a \"b\"", "c\n");
    shv_member_number(&members, "tenth", 0.1);
    shv_member_number(&members, "none", (double)NAN);
    shv_member_flag(&members, "so", true);
    shv_member_key(&members, "list");
    fputs("[]}", stream);
    read_back(stream);
    assert_true(json_valid(text));
    assert_non_null(strstr(text, ", \"tenth\": 0.1, \"none\": null, \"so\": true, \"list\": []}"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_forms), cmocka_unit_test(test_numbers),
                                       cmocka_unit_test(test_members)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
