/* The page, the tables and the curve of a search. */
#include <math.h>

#include "base/file.h"
#include "base/text.h"
#include "export/html.h"
#include "export/output.h"
#include "export/table.h"
#include "survive/pictures.h"

enum { CURVE_POINTS = 61, LINES = 4 };

/* ---- figures ---- */

/* Room for the points of one figure, the shots by height, the pictures. */
typedef struct Room {
    ShvPlotPoint *points;
    int32_t *order;
    double *shares;
    ShvSurvivePictures *pictures;
} Room;

static void add_law(ShvPlotDraft *draft, ShvFragilityLaw law, const ShvFragilityView *view, double low, double high)
{
    const ShvFragilityFit fit = {.location = view->location, .scale = view->scale};
    shv_plot_line(draft, shv_fragility_law_name(law), SHV_PLOT_PLAIN_LINE);
    for (int i = 0; i < CURVE_POINTS; i++) {
        const double height = low * pow(high / low, (double)i / (CURVE_POINTS - 1));
        shv_plot_point(draft, (ShvPlotPoint){.x = height, .y = 1.0 - shv_fragility_share(law, &fit, height)});
    }
}

static void add_isotonic(ShvPlotDraft *draft, const ShvSurviveView *view, const int32_t *order, const double *shares)
{
    shv_plot_line(draft, "without a law", SHV_PLOT_MARKED_LINE);
    for (int32_t i = 0; i < view->shot_count; i++)
        shv_plot_point(draft, (ShvPlotPoint){.x = view->shots[order[i]].height, .y = 1.0 - shares[i]});
}

/* A logarithmic axis of whole decades would leave most of a figure empty. */
static bool is_wide(const ShvSurviveView *view, const int32_t *order)
{
    const double most_on_a_scale = 30.0;
    return view->shots[order[view->shot_count - 1]].height > most_on_a_scale * view->shots[order[0]].height;
}

static void put_plot(FILE *stream, const ShvPlotDraft *draft, const char *title, const char *x, const char *y,
                     bool log_x, bool within)
{
    const ShvPlot plot = {.title = title,
                          .x_label = x,
                          .y_label = y,
                          .log_x = log_x,
                          .lines = draft->lines,
                          .line_count = draft->line_count};
    shv_plot_write(stream, &plot, within);
}

static void put_curve(const ShvSurviveView *view, const Room *room, FILE *stream, bool within)
{
    ShvPlotLine lines[LINES];
    ShvPlotDraft draft = {.points = room->points, .lines = lines};
    double low = HUGE_VAL, high = 0.0;
    for (int32_t i = 0; i < view->shot_count; i++) {
        low = fmin(low, view->shots[i].height);
        high = fmax(high, view->shots[i].height);
    }
    if (isfinite(view->laws[0].h50) && low < high)
        for (int law = 0; law < SHV_FRAGILITY_LAWS; law++) add_law(&draft, law, &view->laws[law], low, high);
    add_isotonic(&draft, view, room->order, room->shares);
    put_plot(stream, &draft, "Share that survives", "height, m", "share that survives", is_wide(view, room->order),
             within);
}

static void put_pieces(const ShvSurviveView *view, const Room *room, FILE *stream)
{
    static const char *const names[] = {"largest piece", "second", "third"};
    ShvPlotLine lines[LINES];
    ShvPlotDraft draft = {.points = room->points, .lines = lines};
    for (int k = 0; k < 3; k++) {
        shv_plot_line(&draft, names[k], SHV_PLOT_MARKERS);
        for (int32_t i = 0; i < view->shot_count; i++) {
            const ShvShot *shot = &view->shots[room->order[i]];
            if (shot->shares[k] > 0.0) shv_plot_point(&draft, (ShvPlotPoint){.x = shot->height, .y = shot->shares[k]});
        }
    }
    put_plot(stream, &draft, "Masses of the pieces", "height, m", "share of the mass", is_wide(view, room->order),
             true);
}

/* Of those that broke, seen along an axis. */
static void put_origins(const ShvSurviveView *view, const Room *room, int x, int y, const char *title, FILE *stream)
{
    static const char *const axes[] = {"x, m", "y, m", "z, m"};
    ShvPlotLine lines[LINES];
    ShvPlotDraft draft = {.points = room->points, .lines = lines};
    shv_plot_line(&draft, "first crack", SHV_PLOT_MARKERS);
    for (int32_t i = 0; i < view->shot_count; i++) {
        const ShvShot *shot = &view->shots[i];
        if (shot->broken && isfinite(shot->origin[0]))
            shv_plot_point(&draft, (ShvPlotPoint){.x = shot->origin[x], .y = shot->origin[y]});
    }
    if (draft.point_count > 0) put_plot(stream, &draft, title, axes[x], axes[y], false, true);
}

/* ---- words ---- */

static void put_interval(ShvTable *table, const char *head, double height, double low, double high)
{
    char from[32] = "no lower bound", to[32] = "no upper bound";
    if (low > 0.0) shv_format(from, sizeof from, "%.3g", low);
    if (isfinite(high)) shv_format(to, sizeof to, "%.3g m", high);
    shv_table_put(table, head, "number", "%.3g m, %.3g m/s", height, shv_drop_speed(height));
    shv_table_put(table, "95 %", "number", "%s to %s", from, to);
}

static void put_law(ShvTable *table, const void *data, int32_t index)
{
    const ShvFragilityView *fit = (const ShvFragilityView *)data + index;
    shv_table_text(table, "law", NULL, shv_fragility_law_name((ShvFragilityLaw)index));
    put_interval(table, "half break from", fit->h50, fit->h50_low, fit->h50_high);
    put_interval(table, "a tenth breaks from", fit->h10, fit->h10_low, fit->h10_high);
    shv_table_put(table, "spread of ln h", "number", "%.3g", fit->scale);
    shv_table_put(table, "log-likelihood", "number", "%.2f", fit->likelihood);
}

static void put_answer(const ShvSurvive *survive, FILE *stream)
{
    const ShvSurviveView *view = &survive->view;
    char text[400];
    shv_format(text, sizeof text,
               "%d shots at %d specimens, %d of which broke. Broken: the largest piece has less than %g of the mass.",
               (int)view->shot_count, (int)view->specimens, (int)view->broken,
               shv_scene_definition(survive->scene)->survival.broken);
    shv_html_paragraph(stream, text);
    if (isfinite(view->bound)) {
        const bool broke = isfinite(view->all_broke_from);
        shv_format(text, sizeof text,
                   "All %s from %.3g m: the share that does otherwise there is below %.2g with 95 %% confidence.",
                   broke ? "broke, even" : "survived, even", broke ? view->all_broke_from : view->all_survived_from,
                   view->bound);
        shv_html_paragraph(stream, text);
        return;
    }
    shv_table_write(stream, SHV_TABLE_HTML, SHV_FRAGILITY_LAWS, put_law, view->laws);
    if (!view->overlap)
        shv_html_paragraph(
            stream, "No specimen survived from as high as another one broke: of the spread nothing is known yet.");
    shv_format(
        text, sizeof text,
        "%d specimens fell a third time, from where the first two had told what would happen: %d survived higher and "
        "broke lower. Where many do, chance decides in the impact itself, not the strength of the specimen.",
        (int)view->checked, (int)view->contradictory);
    shv_html_paragraph(stream, text);
    if (isfinite(view->staircase_mean)) {
        shv_format(text, sizeof text, "ASTM D2463, procedure B: mean failure height %.3g m, standard deviation %.2g m.",
                   view->staircase_mean, view->staircase_deviation);
        shv_html_paragraph(stream, text);
    }
}

static void put_shot(ShvTable *table, const void *data, int32_t index)
{
    const ShvShot *shot = (const ShvShot *)data + index;
    shv_table_put(table, "specimen", "number", "%llu", (unsigned long long)shot->specimen);
    shv_table_put(table, "height, m", "number", "%.4g", shot->height);
    shv_table_put(table, "speed, m/s", "number", "%.3g", shv_drop_speed(shot->height));
    shv_table_text(table, "", shot->broken ? "miss" : "pass", shot->broken ? "broke" : "survived");
    shv_table_put(table, "pieces", "number", "%d", (int)shot->pieces);
    shv_table_put(table, "largest piece", "number", "%.1f %%", 100.0 * shot->shares[0]);
}

static void put_pictures(const ShvSurvivePictures *pictures, FILE *stream)
{
    for (int i = 0; i < SHV_SURVIVE_PICTURES; i++) {
        const ShvShot *shot = &pictures->shot[i];
        char text[160];
        if (!pictures->title[i]) continue;
        shv_format(text, sizeof text, "%s: specimen %llu from %.3g m, %d piece%s, largest %.0f %% of the mass.",
                   pictures->title[i], (unsigned long long)shot->specimen, shot->height, (int)shot->pieces,
                   shot->pieces == 1 ? "" : "s", 100.0 * shot->shares[0]);
        shv_html_paragraph(stream, text);
        fputs("<figure>\n", stream);
        fputs(pictures->drawing[i], stream);
        fputs("</figure>\n", stream);
    }
}

static void put_html(const ShvSurvive *survive, const Room *room, FILE *stream)
{
    char title[300];
    const char *name = shv_scene_definition(survive->scene)->name;
    shv_format(title, sizeof title, "%.200s: from what height does it break?", name);
    shv_html_begin(stream, title);
    if (survive->options.command) shv_html_command(stream, survive->options.command);
    put_answer(survive, stream);
    put_curve(&survive->view, room, stream, true);
    put_pieces(&survive->view, room, stream);
    put_pictures(room->pictures, stream);
    put_origins(&survive->view, room, 0, 2, "Where the first crack of those that broke began, from the front", stream);
    put_origins(&survive->view, room, 0, 1, "The same, from above", stream);
    shv_html_heading(stream, 2, "Shots");
    shv_table_write(stream, SHV_TABLE_HTML, survive->view.shot_count, put_shot, survive->view.shots);
    shv_html_end(stream);
}

/* ---- JSON ---- */

#define OF(member)                                                                                                     \
    {                                                                                                                  \
#member, offsetof(ShvFragilityView, member)                                                                    \
    }
static const ShvNumberField law_fields[] = {OF(h50),      OF(h50_low),  OF(h50_high), OF(h10),       OF(h10_low),
                                            OF(h10_high), OF(location), OF(scale),    OF(likelihood)};
#undef OF

void shv_survive_print_json(const ShvSurvive *survive, FILE *stream)
{
    const ShvSurviveView *view = &survive->view;
    static const char *const laws[SHV_FRAGILITY_LAWS] = {"lognormal", "weibull"};
    ShvMembers members = {.stream = stream};
    shv_print(stream, "{");
    shv_member_number(&members, "shots", view->shot_count);
    shv_member_number(&members, "specimens", view->specimens);
    shv_member_number(&members, "broken", view->broken);
    shv_member_flag(&members, "overlap", view->overlap);
    shv_member_number(&members, "checked", view->checked);
    shv_member_number(&members, "contradictory", view->contradictory);
    shv_member_number(&members, "all_survived_from", view->all_survived_from);
    shv_member_number(&members, "all_broke_from", view->all_broke_from);
    shv_member_number(&members, "bound", view->bound);
    shv_member_number(&members, "staircase_mean", view->staircase_mean);
    shv_member_number(&members, "staircase_deviation", view->staircase_deviation);
    for (int law = 0; law < SHV_FRAGILITY_LAWS; law++) {
        ShvMembers own = {.stream = stream};
        shv_member_key(&members, laws[law]);
        shv_print(stream, "{");
        shv_member_fields(&own, &view->laws[law], law_fields, sizeof law_fields / sizeof law_fields[0]);
        shv_print(stream, "}");
    }
    shv_print(stream, "}\n");
}

/* ---- files ---- */

enum { FILE_TABLE, FILE_JSON, FILE_CURVE, FILE_PAGE, FILE_COUNT };

typedef struct Report {
    const ShvSurvive *survive;
    const Room *room;
} Report;

static void put_file(const void *data, int file, FILE *stream)
{
    const Report *report = data;
    const ShvSurvive *survive = report->survive;
    if (file == FILE_JSON) shv_survive_print_json(survive, stream);
    if (file == FILE_CURVE) put_curve(&survive->view, report->room, stream, false);
    if (file == FILE_PAGE) put_html(survive, report->room, stream);
    if (file != FILE_TABLE) return;
    shv_shot_put_heads(stream);
    for (int32_t i = 0; i < survive->view.shot_count; i++) shv_shot_put(stream, &survive->view.shots[i]);
}

static ShvStatus write_files(const ShvSurvive *survive, const Room *room, ShvError *error)
{
    static const char *const names[FILE_COUNT] = {"shots.csv", "survive.json", "curve.svg", "report.html"};
    ShvExportOptions options = shv_export_default();
    char *folder;
    options.force = true;
    options.memory = survive->options.memory;
    SHV_TRY(shv_path_join(options.memory, SHV_PART_GENERAL, survive->options.output, "", &folder, error));
    const ShvStatus status =
        shv_output_write_all(&options, folder, names, FILE_COUNT, put_file, &(Report){survive, room}, error);
    shv_release(folder);
    return status;
}

ShvStatus shv_survive_write(ShvSurvive *survive, ShvError *error)
{
    ShvSurvivePictures pictures = {0};
    const size_t count = (size_t)survive->view.shot_count;
    const size_t points = SHV_FRAGILITY_LAWS * CURVE_POINTS + 3 * count;
    if (count == 0) return shv_fail(error, SHV_BAD_INPUT, "a search is written after it has shot");
    const Room room = {.points = shv_allocate(survive->options.memory, SHV_PART_GENERAL, points, sizeof(ShvPlotPoint)),
                       .order = shv_allocate(survive->options.memory, SHV_PART_GENERAL, count, sizeof(int32_t)),
                       .pictures = &pictures,
                       .shares = shv_allocate(survive->options.memory, SHV_PART_GENERAL, count, sizeof(double))};
    ShvStatus status = room.points && room.order && room.shares
                           ? SHV_OK
                           : shv_fail_memory(error, "the report", points * sizeof(ShvPlotPoint));
    if (status == SHV_OK) shv_fragility_isotonic(survive->view.shots, (int32_t)count, room.order, room.shares);
    if (status == SHV_OK) status = shv_survive_draw(survive, &pictures, error);
    if (status == SHV_OK) status = write_files(survive, &room, error);
    shv_survive_pictures_release(&pictures);
    shv_release(room.points);
    shv_release(room.order);
    shv_release(room.shares);
    return status;
}
