/* Plots: well-formed, ticks where they should be, points in their places, hostile numbers and texts. */
#include "check.h"

#include <locale.h>
#include <stdlib.h>

#include "export/plot.h"
#include "xml.h"

static char *draw(const ShvPlot *plot)
{
    enum { MOST = 1 << 16 };
    char *text = malloc(MOST);
    FILE *stream = tmpfile();
    assert_true(text && stream);
    shv_plot_write(stream, plot, false);
    rewind(stream);
    text[fread(text, 1, MOST - 1, stream)] = '\0';
    fclose(stream);
    return text;
}

static void test_axes(void **state)
{
    (void)state;
    static const struct {
        double low, high, from, to, tick;
        bool log;
    } cases[] = {{0.0, 1.0, 0.0, 1.0, 0.2, false},       {0.13, 0.87, 0.0, 1.0, 0.2, false},
                 {-3.0, 47.0, -10.0, 50.0, 10.0, false}, {5.0, 5.0, 2.0, 8.0, 1.0, false},
                 {0.0, 0.0, -0.6, 0.6, 0.2, false},      {2e-5, 3e-3, -5.0, -2.0, 1.0, true},
                 {1e-3, 1e2, -3.0, 2.0, 1.0, true},      {1e-16, 1.0, -16.0, 0.0, 2.0, true},
                 {10.0, 10.0, 1.0, 2.0, 1.0, true},      {1.0, -1.0, 0.0, 1.0, 0.2, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const ShvPlotAxis axis = shv_plot_axis(cases[i].low, cases[i].high, cases[i].log);
        check_near(axis.low, cases[i].from, 1e-12);
        check_near(axis.high, cases[i].to, 1e-12);
        check_near(axis.tick, cases[i].tick, 1e-12);
    }
}

static void test_points(void **state)
{
    (void)state;
    const ShvPlotPoint up[] = {{1.0, 1e-2, "first"}, {10.0, 1e-1, ""}, {100.0, 1.0, "last"}};
    const ShvPlotPoint odd[] = {
        {(double)NAN, 1.0, "a"}, {0.0, 1.0, "b"}, {-2.0, 1.0, "c"}, {10.0, (double)INFINITY, "d"}};
    const ShvPlotLine lines[] = {{"up & <away>", up, 3, SHV_PLOT_MARKED_LINE},
                                 {"odd", odd, 4, SHV_PLOT_MARKED_LINE},
                                 {"none", NULL, 0, SHV_PLOT_MARKED_LINE}};
    const ShvPlot plot = {.title = "a < b\n& c",
                          .x_label = "time, s",
                          .y_label = "error, µm",
                          .log_x = true,
                          .log_y = true,
                          .lines = lines,
                          .line_count = 3};
    char *xml = draw(&plot);
    check_well_formed(xml);
    assert_int_equal(count_text(xml, "<title>a &lt; b &amp; c</title>"), 1);
    assert_int_equal(count_text(xml, ">up &amp; &lt;away&gt;<"), 1);
    /* Three points and three entries of the legend; what cannot be shown is not. */
    assert_int_equal(count_text(xml, "class=\"mark\""), 6);
    assert_int_equal(count_text(xml, "class=\"point\""), 2);
    assert_int_equal(count_text(xml, ">1e0<"), 2);
    /* The line runs from one corner of the frame to the opposite one. */
    double x[3], y[3], left, top, width, height;
    assert_int_equal(
        sscanf(strstr(xml, "points=\""), "points=\"%lf,%lf %lf,%lf %lf,%lf", &x[0], &y[0], &x[1], &y[1], &x[2], &y[2]),
        6);
    const char *frame = strstr(xml, "<rect x=");
    assert_non_null(frame);
    assert_int_equal(
        sscanf(frame, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &left, &top, &width, &height), 4);
    check_near(x[0], left, 0.051);
    check_near(y[0], top + height, 0.051);
    check_near(x[1], left + 0.5 * width, 0.051);
    check_near(y[1], top + 0.5 * height, 0.051);
    check_near(x[2], left + width, 0.051);
    check_near(y[2], top, 0.051);
    static const char *const commas[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"};
    for (int i = 0; i < 3; i++)
        if (setlocale(LC_ALL, commas[i])) break;
    char *other = draw(&plot);
    setlocale(LC_ALL, "C");
    assert_string_equal(xml, other);
    free(xml);
    free(other);
}

/* Lines of the same points: each has strokes of its own, and no marker covers another. */
static void test_lines_that_coincide(void **state)
{
    (void)state;
    enum { LINES = 6 };
    const ShvPlotPoint points[] = {{1.0, 1.0, ""}, {2.0, 3.0, ""}};
    ShvPlotLine lines[LINES];
    for (int i = 0; i < LINES; i++) lines[i] = (ShvPlotLine){"same", points, 2, SHV_PLOT_MARKED_LINE};
    const ShvPlot plot = {.title = "", .x_label = "", .y_label = "", .lines = lines, .line_count = LINES};
    char *xml = draw(&plot), dashes[LINES][24] = {""};
    check_well_formed(xml);
    int count = 0;
    for (const char *at = strstr(xml, "<polyline"); at; at = strstr(at + 1, "<polyline"), count++) {
        char element[160] = "";
        assert_true(count < LINES);
        memcpy(element, at, strcspn(at, ">") < 159 ? strcspn(at, ">") : 159);
        const char *dash = strstr(element, "stroke-dasharray=\"");
        assert_int_equal(dash != NULL, count > 0); /* the first shows in the gaps of all others */
        if (dash) assert_int_equal(sscanf(dash, "stroke-dasharray=\"%23[^\"]", dashes[count]), 1);
        for (int i = 0; i < count; i++) assert_string_not_equal(dashes[i], dashes[count]);
    }
    assert_int_equal(count, LINES);
    const int marks = count_text(xml, "class=\"mark\"");
    assert_int_equal(marks, 3 * LINES);
    int open = 0;
    for (const char *at = strstr(xml, "class=\"mark\""); at; at = strstr(at + 1, "class=\"mark\"")) {
        const char *fill = strstr(at, "fill=\"none\""), *end = strstr(at, "/>");
        open += fill && fill < end;
    }
    assert_int_equal(open, marks);
    free(xml);
}

static void test_nothing_to_show(void **state)
{
    (void)state;
    const ShvPlot plot = {.title = "", .x_label = "", .y_label = "", .log_x = true};
    char *xml = draw(&plot);
    check_well_formed(xml);
    assert_int_equal(count_text(xml, "class=\"mark\""), 0);
    free(xml);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_axes),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_lines_that_coincide),
        cmocka_unit_test(test_nothing_to_show),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
