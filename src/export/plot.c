#include "export/plot.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/text.h"

enum { WIDTH = 760, HEIGHT = 500, LEFT = 84, RIGHT = 28, TOP = 92, BOTTOM = 62, COLOURS = 6, MOST_TICKS = 8 };

/* Lines take the first six. */
static const char *const colours[] = {"#1f6fb4", "#c8501e", "#3a8f4d", "#8a4fb0", "#8c6d1f",
                                      "#5a5a5a", "#2a9d9d", "#d08aa0", "#a7c05a", "#30485f"};
enum { PART_COLOURS = sizeof colours / sizeof colours[0] };

typedef struct Page {
    FILE *stream;
    const ShvPlot *plot;
    ShvPlotAxis x, y;
} Page;

void shv_plot_line(ShvPlotDraft *draft, const char *name, ShvPlotStyle style)
{
    draft->lines[draft->line_count++] = (ShvPlotLine){name, draft->points + draft->point_count, 0, style};
}

void shv_plot_point(ShvPlotDraft *draft, ShvPlotPoint point)
{
    draft->points[draft->point_count++] = point;
    draft->lines[draft->line_count - 1].count++;
}

int32_t shv_plot_add(ShvPlotDraft *draft, const char *name, ShvPlotPoint point)
{
    int32_t i = 0;
    while (i < draft->line_count && strcmp(draft->lines[i].name, name) != 0) i++;
    if (i == draft->line_count) shv_plot_line(draft, name, SHV_PLOT_MARKED_LINE);
    const ptrdiff_t at = draft->lines[i].points - draft->points + draft->lines[i].count++;
    memmove(draft->points + at + 1, draft->points + at, (size_t)(draft->point_count++ - at) * sizeof point);
    draft->points[at] = point;
    for (int32_t k = i + 1; k < draft->line_count; k++) draft->lines[k].points++;
    return i;
}

/* ---- axes ---- */

/* 1, 2 or 5 times a power of ten, at least `least`. */
static double round_step(double least)
{
    const double power = pow(10.0, floor(log10(least)));
    const double rest = least / power;
    return power * (rest <= 1.0 + 1e-9 ? 1.0 : rest <= 2.0 + 1e-9 ? 2.0 : rest <= 5.0 + 1e-9 ? 5.0 : 10.0);
}

ShvPlotAxis shv_plot_axis(double low, double high, bool log)
{
    if (low > high) {
        low = log ? 1.0 : 0.0;
        high = log ? 10.0 : 1.0;
    }
    if (log) {
        low = floor(log10(low) + 1e-9);
        high = fmax(low + 1.0, ceil(log10(high) - 1e-9));
        return (ShvPlotAxis){low, high, fmax(1.0, ceil((high - low) / MOST_TICKS)), true};
    }
    if (low == high) {
        const double room = low != 0.0 ? 0.5 * fabs(low) : 0.5;
        low -= room;
        high += room;
    }
    const double tick = round_step((high - low) / (MOST_TICKS - 2));
    return (ShvPlotAxis){floor(low / tick + 1e-9) * tick, ceil(high / tick - 1e-9) * tick, tick, false};
}

static double share(const ShvPlotAxis *axis, double value)
{
    return ((axis->log ? log10(value) : value) - axis->low) / (axis->high - axis->low);
}

static double place_x(const Page *page, double value)
{
    return LEFT + share(&page->x, value) * (WIDTH - LEFT - RIGHT);
}

static double place_y(const Page *page, double value)
{
    return HEIGHT - BOTTOM - share(&page->y, value) * (HEIGHT - TOP - BOTTOM);
}

static bool shown(const ShvPlot *plot, const ShvPlotPoint *point)
{
    return isfinite(point->x) && isfinite(point->y) && (!plot->log_x || point->x > 0.0) &&
           (!plot->log_y || point->y > 0.0);
}

static void widen(const ShvPlot *plot, double low[2], double high[2], double x, double y)
{
    const ShvPlotPoint point = {.x = x, .y = y};
    if (!shown(plot, &point)) return;
    low[0] = fmin(low[0], x);
    high[0] = fmax(high[0], x);
    low[1] = fmin(low[1], y);
    high[1] = fmax(high[1], y);
}

static void fit(Page *page)
{
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    const ShvPlot *plot = page->plot;
    for (int32_t i = 0; i < plot->line_count; i++)
        for (int32_t k = 0; k < plot->lines[i].count; k++)
            widen(plot, low, high, plot->lines[i].points[k].x, plot->lines[i].points[k].y);
    for (int32_t i = 0; i < plot->span_count; i++) {
        widen(plot, low, high, plot->spans[i].x, plot->spans[i].low);
        widen(plot, low, high, plot->spans[i].x, plot->spans[i].high);
    }
    page->x = shv_plot_axis(low[0], high[0], plot->log_x);
    page->y = shv_plot_axis(low[1], high[1], plot->log_y);
}

/* ---- marks ---- */

void shv_html_text(FILE *stream, const char *text)
{
    for (; *text; text++) {
        const char c = *text;
        const char *form = c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : NULL;
        if (form)
            shv_print(stream, "%s", form);
        else
            shv_print(stream, "%c", (unsigned char)c < 0x20 || c == 0x7f ? ' ' : c);
    }
}

static void put_label(FILE *stream, double x, double y, const char *attributes, const char *text)
{
    shv_print(stream, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes);
    shv_html_text(stream, text);
    shv_print(stream, "</text>\n");
}

static void put_rule(FILE *stream, double x1, double y1, double x2, double y2, const char *colour)
{
    shv_print(stream, "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\"/>\n", x1, y1, x2, y2,
              colour);
}

static void put_tick(const Page *page, const ShvPlotAxis *axis, double at)
{
    const bool across = axis == &page->x;
    const double part = (at - axis->low) / (axis->high - axis->low);
    const double x = LEFT + part * (WIDTH - LEFT - RIGHT), y = HEIGHT - BOTTOM - part * (HEIGHT - TOP - BOTTOM);
    char text[32];
    /* A sum of ticks that should be zero is a rounding error. */
    const double value = fabs(at) < 1e-9 * axis->tick ? 0.0 : at;
    shv_format(text, sizeof text, axis->log ? "1e%g" : "%g", value);
    if (across) {
        put_rule(page->stream, x, TOP, x, HEIGHT - BOTTOM, "#e2dfd8");
        put_label(page->stream, x, HEIGHT - BOTTOM + 18, "text-anchor=\"middle\" class=\"tick\"", text);
    } else {
        put_rule(page->stream, LEFT, y, WIDTH - RIGHT, y, "#e2dfd8");
        put_label(page->stream, LEFT - 8, y + 4, "text-anchor=\"end\" class=\"tick\"", text);
    }
}

static void put_axis(const Page *page, const ShvPlotAxis *axis)
{
    const double ticks = floor((axis->high - axis->low) / axis->tick + 1e-9);
    for (double i = 0.0; i <= ticks; i += 1.0) put_tick(page, axis, axis->low + i * axis->tick);
}

/* Open, so that one does not hide another of the same place. */
static void put_marker(FILE *stream, double x, double y, int32_t line)
{
    static const char *const marks[COLOURS] = {"M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z",
                                               "M-4 -4h8v8h-8z",
                                               "M0 -5l5 9h-10z",
                                               "M0 -5l5 5l-5 5l-5 -5z",
                                               "M0 5l5 -9h-10z",
                                               "M-4 -2h8v4h-8z"};
    shv_print(stream,
              "<path class=\"mark\" transform=\"translate(%.1f %.1f)\" d=\"%s\" fill=\"none\" stroke=\"%s\" "
              "stroke-width=\"1.6\"/>\n",
              x, y, marks[line % COLOURS], colours[line % COLOURS]);
}

/* Each of four lines has a side of its own, so that labels of points that nearly coincide can be read; none leaves the frame. */
static void put_point_label(FILE *stream, double x, double y, int32_t line, const char *label)
{
    const double room = 60.0;
    const bool left = line % 4 >= 2 ? x > LEFT + room : x > WIDTH - RIGHT - room;
    put_label(stream, left ? x - 7 : x + 7, line % 2 == 1 ? y + 16 : y - 7,
              left ? "text-anchor=\"end\" class=\"point\"" : "class=\"point\"", label);
}

/* `attributes`: what the stroke looks like. */
static void put_strokes(const Page *page, const ShvPlotLine *line, const char *attributes, const char *colour)
{
    shv_print(page->stream, "<polyline %sfill=\"none\" stroke=\"%s\" %s points=\"",
              line == page->plot->front ? "class=\"front\" " : "", colour, attributes);
    for (int32_t i = 0; i < line->count; i++)
        if (shown(page->plot, &line->points[i]))
            shv_print(page->stream, "%.1f,%.1f ", place_x(page, line->points[i].x), place_y(page, line->points[i].y));
    shv_print(page->stream, "\"/>\n");
}

/* The first is solid and the others have dashes of their own: where lines coincide, each shows in the gaps of those above. */
static const char *stroke_of(int32_t index)
{
    static const char *const strokes[COLOURS] = {
        "stroke-width=\"1.6\"",
        "stroke-width=\"1.6\" stroke-dasharray=\"12 8\"",
        "stroke-width=\"1.6\" stroke-dasharray=\"3 5\"",
        "stroke-width=\"1.6\" stroke-dasharray=\"8 8\"",
        "stroke-width=\"1.6\" stroke-dasharray=\"12 5 3 5\"",
        "stroke-width=\"1.6\" stroke-dasharray=\"2 9\"",
    };
    return strokes[index % COLOURS];
}

static void put_line(const Page *page, int32_t index)
{
    const ShvPlotLine *line = &page->plot->lines[index];
    if (line->style != SHV_PLOT_MARKERS) put_strokes(page, line, stroke_of(index), colours[index % COLOURS]);
    for (int32_t i = 0; i < line->count && line->style != SHV_PLOT_PLAIN_LINE; i++) {
        if (!shown(page->plot, &line->points[i])) continue;
        const double x = place_x(page, line->points[i].x), y = place_y(page, line->points[i].y);
        put_marker(page->stream, x, y, index);
        if (line->points[i].label[0]) put_point_label(page->stream, x, y, index, line->points[i].label);
    }
}

/* A bar whose lower end is not on a logarithmic axis begins at the frame. */
static void put_span(const Page *page, const ShvPlotSpan *span)
{
    const ShvPlotPoint top = {.x = span->x, .y = span->high}, foot = {.x = span->x, .y = span->low};
    if (!shown(page->plot, &top) || isnan(span->low)) return;
    const double x = place_x(page, span->x);
    put_rule(page->stream, x, shown(page->plot, &foot) ? place_y(page, span->low) : HEIGHT - BOTTOM, x,
             place_y(page, span->high), colours[span->line % COLOURS]);
}

static void put_front(const Page *page)
{
    const ShvPlotLine *front = page->plot->front;
    put_strokes(page, front, "stroke-width=\"1.2\" stroke-dasharray=\"5 4\"", "#2c2a26");
    for (int32_t i = 0; i < front->count; i++)
        if (shown(page->plot, &front->points[i]))
            shv_print(page->stream,
                      "<circle class=\"ring\" cx=\"%.1f\" cy=\"%.1f\" r=\"8\" fill=\"none\" stroke=\"#2c2a26\"/>\n",
                      place_x(page, front->points[i].x), place_y(page, front->points[i].y));
}

static void put_legend(const Page *page)
{
    double x = LEFT;
    for (int32_t i = 0; i < page->plot->line_count; i++) {
        const char *name = page->plot->lines[i].name;
        double letters = 0.0; /* bytes that begin a character of UTF-8 */
        for (const char *c = name; *c; c++) letters += ((unsigned char)*c & 0xc0) != 0x80;
        if (page->plot->lines[i].style != SHV_PLOT_MARKERS)
            shv_print(page->stream, "<path d=\"M%.1f %dh32\" stroke=\"%s\" %s/>\n", x, TOP - 32, colours[i % COLOURS],
                      stroke_of(i));
        if (page->plot->lines[i].style != SHV_PLOT_PLAIN_LINE) put_marker(page->stream, x + 16, TOP - 32, i);
        put_label(page->stream, x + 38, TOP - 28, "class=\"tick\"", name);
        x += 38 + 7 * letters + 16;
    }
    if (!page->plot->front) return;
    shv_print(page->stream, "<circle cx=\"%.1f\" cy=\"%d\" r=\"6\" fill=\"none\" stroke=\"#2c2a26\"/>\n", x + 6,
              TOP - 32);
    put_label(page->stream, x + 16, TOP - 28, "class=\"tick\"", page->plot->front->name);
}

/* Head and title of a drawing; `attributes` (" name=value") of its element. */
static void begin(FILE *stream, int width, int height, bool within, const char *title, const char *attributes)
{
    shv_print(stream, within ? "<figure>\n" : "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    shv_print(stream,
              "<svg %swidth=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
              "font-family=\"Helvetica, Arial, sans-serif\"%s>\n<title>",
              within ? "" : "xmlns=\"http://www.w3.org/2000/svg\" ", width, height, width, height, attributes);
    shv_html_text(stream, title);
    shv_print(stream, "</title>\n");
}

void shv_plot_write(FILE *stream, const ShvPlot *plot, bool within)
{
    Page page = {.stream = stream, .plot = plot};
    fit(&page);
    begin(stream, WIDTH, HEIGHT, within, plot->title, "");
    shv_print(stream, "<style>.tick{font-size:13px;fill:#4a463f}.point{font-size:11px;fill:#6b665d}"
                      ".name{font-size:14px;fill:#2c2a26}</style>\n"
                      "<rect width=\"100%%\" height=\"100%%\" rx=\"8\" fill=\"#fbfaf8\"/>\n");
    put_label(stream, LEFT, 30, "class=\"name\" font-weight=\"bold\"", plot->title);
    put_axis(&page, &page.x);
    put_axis(&page, &page.y);
    shv_print(stream, "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#8d877b\"/>\n", LEFT,
              TOP, WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
    put_label(stream, 0.5 * (LEFT + WIDTH - RIGHT), HEIGHT - 16, "text-anchor=\"middle\" class=\"name\"",
              plot->x_label);
    char turned[96];
    shv_format(turned, sizeof turned, "text-anchor=\"middle\" class=\"name\" transform=\"rotate(-90 22 %.1f)\"",
               0.5 * (TOP + HEIGHT - BOTTOM));
    put_label(stream, 22, 0.5 * (TOP + HEIGHT - BOTTOM), turned, plot->y_label);
    for (int32_t i = 0; i < plot->span_count; i++) put_span(&page, &plot->spans[i]);
    if (plot->front) put_front(&page);
    for (int32_t i = 0; i < plot->line_count; i++) put_line(&page, i);
    put_legend(&page);
    shv_print(stream, within ? "</svg>\n</figure>\n" : "</svg>\n");
}

/* ---- bars ---- */

enum { BAR_LEFT = 250, BAR_RIGHT = 70, BAR_TOP = 96, BAR_ROW = 22 };

static double sum_of(const ShvPlotBars *bars, const double *values)
{
    double sum = 0.0;
    for (int32_t i = 0; i < bars->part_count; i++) sum += values[i];
    return sum;
}

/* Of the parts that any bar has. */
static void put_parts(FILE *stream, const ShvPlotBars *bars)
{
    char name[SHV_PLOT_BAR_NAME];
    int place = 0;
    for (int32_t i = 0; i < bars->part_count; i++) {
        double most = 0.0;
        for (int32_t k = 0; k < bars->count; k++) most = fmax(most, bars->bar(bars->data, k, name)[i]);
        if (most <= 0.0) continue;
        const int x = 20 + 120 * (place % 6), y = 52 + 20 * (place / 6);
        shv_print(stream, "<rect x=\"%d\" y=\"%d\" width=\"12\" height=\"12\" fill=\"%s\"/>\n", x, y - 10,
                  colours[i % PART_COLOURS]);
        shv_print(stream, "<text x=\"%d\" y=\"%d\">%s</text>\n", x + 18, y, bars->parts[i]);
        place++;
    }
}

static void put_bar(FILE *stream, const ShvPlotBars *bars, int32_t index, double scale)
{
    char name[SHV_PLOT_BAR_NAME];
    const double *values = bars->bar(bars->data, index, name), y = BAR_TOP + BAR_ROW * index;
    double x = BAR_LEFT;
    shv_print(stream, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">", BAR_LEFT - 8, y + 12.0);
    shv_html_text(stream, name);
    shv_print(stream, "</text>\n");
    for (int32_t i = 0; i < bars->part_count; i++) {
        const double width = values[i] * scale;
        if (!(width > 0.0)) continue;
        shv_print(stream, "<rect x=\"%.2f\" y=\"%.1f\" width=\"%.2f\" height=\"%d\" fill=\"%s\"/>\n", x, y, width,
                  BAR_ROW - 6, colours[i % PART_COLOURS]);
        x += width;
    }
    shv_print(stream, "<text x=\"%.1f\" y=\"%.1f\">%.3g %s</text>\n", x + 6.0, y + 12.0, sum_of(bars, values),
              bars->unit);
}

void shv_plot_bars(FILE *stream, const ShvPlotBars *bars, bool within)
{
    char name[SHV_PLOT_BAR_NAME];
    double longest = 0.0;
    for (int32_t i = 0; i < bars->count; i++) longest = fmax(longest, sum_of(bars, bars->bar(bars->data, i, name)));
    const double scale = longest > 0.0 ? (WIDTH - BAR_LEFT - BAR_RIGHT) / longest : 0.0;
    begin(stream, WIDTH, BAR_TOP + BAR_ROW * (int)bars->count + 14, within, bars->title,
          " font-size=\"12\" fill=\"#4a463f\"");
    shv_print(stream, "<rect width=\"100%%\" height=\"100%%\" rx=\"8\" fill=\"#fbfaf8\"/>\n"
                      "<text x=\"20\" y=\"28\" font-size=\"14\" font-weight=\"bold\" fill=\"#2c2a26\">");
    shv_html_text(stream, bars->title);
    shv_print(stream, "</text>\n");
    put_parts(stream, bars);
    for (int32_t i = 0; i < bars->count; i++) put_bar(stream, bars, i, scale);
    shv_print(stream, within ? "</svg>\n</figure>\n" : "</svg>\n");
}
