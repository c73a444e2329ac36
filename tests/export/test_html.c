/* Pages: escaped, nested as they should be, and nothing in them comes from elsewhere. */
#include "check.h"

#include "export/html.h"
#include "export/table.h"
#include "xml.h"

static char text[1 << 16];

static void read_back(FILE *stream)
{
    rewind(stream);
    text[fread(text, 1, sizeof text - 1, stream)] = '\0';
    fclose(stream);
}

static void test_page(void **state)
{
    (void)state;
    const ShvPlotPoint points[] = {{1.0, 2.0, "one"}, {10.0, 1.0, "two"}};
    const ShvPlotLine line = {"line & dot", points, 2, SHV_PLOT_MARKED_LINE},
                      front = {"front", points, 2, SHV_PLOT_MARKED_LINE};
    const ShvPlotSpan span = {1.0, 0.5, 3.0, 0};
    const ShvPlot plot = {.title = "plot",
                          .x_label = "x",
                          .y_label = "y",
                          .log_x = true,
                          .lines = &line,
                          .line_count = 1,
                          .front = &front,
                          .spans = &span,
                          .span_count = 1};
    FILE *stream = tmpfile();
    assert_non_null(stream);
    shv_html_begin(stream, "R&D \"page\"");
    shv_html_heading(stream, 2, "Runs");
    shv_html_heading(stream, 99, "deep");
    shv_html_paragraph(stream, "a < b > c & d");
    shv_html_command(stream, "shiver --set 'a=<b>'");
    ShvTable table = shv_table_begin(stream, SHV_TABLE_HTML);
    for (int i = 0; i < 2; i++) {
        shv_table_text(&table, "a < b", "number", "1e-3\x01");
        shv_table_put(&table, "verdict", "pass\" onclick=\"x", "<%s>bold</b>", "b");
        shv_table_end_row(&table);
    }
    shv_table_end(&table);
    shv_plot_write(stream, &plot, true);
    shv_html_end(stream);
    read_back(stream);
    assert_non_null(strstr(text, "<title>R&amp;D &quot;page&quot;</title>"));
    assert_non_null(strstr(text, "<h2>Runs</h2>"));
    assert_non_null(strstr(text, "<h6>deep</h6>"));
    assert_non_null(strstr(text, "<p>a &lt; b &gt; c &amp; d</p>"));
    assert_non_null(strstr(text, "<pre>shiver --set 'a=&lt;b&gt;'</pre>"));
    assert_non_null(strstr(text, "<th>a &lt; b</th>"));
    assert_non_null(strstr(text, "<tr><td class=\"number\">1e-3 </td>"));
    assert_non_null(strstr(text, "<td class=\"pass&quot; onclick=&quot;x\">&lt;b&gt;bold&lt;/b&gt;</td>"));
    static const char *const outside[] = {"http", "//", "src=", "href", "url(", "@import", "<script", "<link"};
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) assert_null(strstr(text, outside[i]));
    assert_int_equal(count_text(text, "<svg "), 1);
    assert_int_equal(count_text(text, "</svg>"), 1);
    assert_int_equal(count_text(text, "class=\"ring\""), 2);
}

/* What is drawn within the page is what stands alone, but for the head. */
static void test_plot_within(void **state)
{
    (void)state;
    const ShvPlotPoint points[] = {{1.0, 2.0, "one"}, {3.0, 1.0, ""}};
    const ShvPlotLine line = {"line", points, 2, SHV_PLOT_MARKED_LINE},
                      front = {"front", points, 1, SHV_PLOT_MARKED_LINE};
    const ShvPlotSpan spans[] = {{1.0, -1.0, 2.0, 0}, {2.0, 1.0, (double)NAN, 0}, {2.0, (double)NAN, 1.0, 0}};
    const ShvPlot plot = {.title = "p",
                          .x_label = "x",
                          .y_label = "y",
                          .log_y = true,
                          .lines = &line,
                          .line_count = 1,
                          .front = &front,
                          .spans = spans,
                          .span_count = 3};
    FILE *stream = tmpfile();
    assert_non_null(stream);
    shv_plot_write(stream, &plot, false);
    read_back(stream);
    check_well_formed(text);
    static char alone[sizeof text];
    memcpy(alone, text, sizeof text);
    stream = tmpfile();
    assert_non_null(stream);
    shv_plot_write(stream, &plot, true);
    read_back(stream);
    strcpy(strstr(text, "</figure>"), "");
    assert_string_equal(strstr(alone, "width=\""), strstr(text, "width=\""));
    /* The bar whose foot is not on the axis begins at the frame; the other two are not drawn. Its x is that of the first point. */
    double x, y, marks[2];
    assert_int_equal(sscanf(strstr(text, "class=\"ring\""), "class=\"ring\" cx=\"%lf\" cy=\"%lf\"", &x, &y), 2);
    char wanted[64];
    snprintf(wanted, sizeof wanted, "<line x1=\"%.1f\" y1=\"438.0\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#1f6fb4\"/>", x, x,
             y);
    assert_int_equal(count_text(text, wanted), 1);
    assert_int_equal(count_text(text, "stroke=\"#1f6fb4\"/>"), 1);
    assert_int_equal(
        sscanf(strstr(text, "class=\"mark\""), "class=\"mark\" transform=\"translate(%lf %lf)", &marks[0], &marks[1]),
        2);
    check_near(marks[0], x, 0.0);
    check_near(marks[1], y, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_page), cmocka_unit_test(test_plot_within)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
