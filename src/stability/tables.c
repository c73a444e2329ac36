/* A measurement as text, JSON and CSV. */
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "export/output.h"
#include "stability/stability.h"

typedef enum Form { TEXT, JSON, CSV } Form;

typedef struct Field {
    const char *name;   /* in JSON */
    const char *format; /* in the text */
    size_t offset;
} Field;

#define ROW(member)   offsetof(ShvStabilityRow, member)
#define POINT(member) offsetof(ShvStabilityPoint, member)
#define COUNT(array)  ((int)(sizeof(array) / sizeof *(array)))
static const Field setting_fields[] = {{"youngs_modulus", NULL, ROW(modulus)}, {"k", NULL, ROW(stiffness)}},
                   limit_fields[] = {{"stable_step", "%.3e", ROW(stable_step)},
                                     {"limit", "%.2f", ROW(limit)},
                                     {"failed", "%.2f", ROW(failed)},
                                     {"over_mesh", "%.2f", ROW(over_mesh)}},
                   odd_fields[] = {{"unstable_below", NULL, ROW(unstable_below)},
                                   {"stable_again", NULL, ROW(stable_again)},
                                   {"refused_above", NULL, ROW(refused_above)}},
                   point_fields[] = {{"step", "%.2f", POINT(multiple)},
                                     {"stiffness", "%.4g", POINT(stiffness)},
                                     {"bars_alone", "%.4g", POINT(closed_form)},
                                     {"frequency", "%.4f", POINT(frequency)},
                                     {"displacement", "%.3g", POINT(displacement)},
                                     {"energy_kept", "%.3g", POINT(energy_kept)}};

static void put_numbers(FILE *stream, Form form, const void *item, const Field *fields, int count)
{
    for (int i = 0; i < count; i++) {
        double value;
        char text[32];
        memcpy(&value, (const char *)item + fields[i].offset, sizeof value);
        const char *odd = form == JSON ? "null" : isnan(value) ? "-" : "inf";
        const char *format = !isfinite(value) ? odd : form == TEXT ? fields[i].format : "%.17g";
        shv_format(text, sizeof text, format, value);
        if (form == CSV)
            shv_output_number(stream, value);
        else if (form == TEXT)
            shv_print(stream, " %9s", text);
        else
            shv_print(stream, ", \"%s\": %s", fields[i].name, text);
    }
}

/* ---- text ---- */

static void put_setting(FILE *stream, const ShvStabilityRow *row)
{
    if (row->iterations > 0)
        shv_print(stream, "%-10.3g %5.3g %4d", row->modulus, row->stiffness, (int)row->iterations);
    else
        shv_print(stream, "%-10.3g %5s %4s", row->modulus, "none", "-");
}

static void put_limits(FILE *stream, const ShvStabilityRow *row)
{
    put_setting(stream, row);
    put_numbers(stream, TEXT, row, limit_fields, COUNT(limit_fields));
    shv_print(stream, "  %-9s %-9s ", shv_stability_class_name(row->beyond), shv_stability_class_name(row->far));
    if (row->monotone) shv_print(stream, "yes");
    if (!isnan(row->unstable_below)) shv_print(stream, "NO: unstable at %.2f", row->unstable_below);
    if (!isnan(row->stable_again))
        shv_print(stream, "%sNO: stable again at %.2f", isnan(row->unstable_below) ? "" : ", ", row->stable_again);
    if (!isnan(row->refused_above))
        shv_print(stream, "; the program refuses steps above %.2f without bars", row->refused_above);
    shv_print(stream, "\n");
}

static void put_points(FILE *stream, const ShvStabilityRow *row)
{
    for (int32_t k = 0; k < row->point_count; k++) {
        const ShvStabilityPoint *point = &row->points[k];
        put_setting(stream, row);
        put_numbers(stream, TEXT, point, point_fields, 1);
        shv_print(stream, "  %-9s", shv_stability_class_name(point->outcome));
        put_numbers(stream, TEXT, point, point_fields + 1, COUNT(point_fields) - 1);
        shv_print(stream, "\n");
    }
}

void shv_stability_print(const ShvStability *stability, FILE *stream)
{
    shv_print(stream,
              "load: velocities of up to 0.5e-6 bar speeds, drawn node by node, rigid motion taken out; %d steps\n"
              "largest stable step, in computed stable steps\n"
              "%-10s %5s %4s %9s %9s %9s %9s  %-9s %-9s %s\n",
              (int)stability->options.steps, "E, Pa", "k", "n", "step, s", "limit", "fails at", "of mesh", "there",
              "at 3x", "monotone");
    for (int32_t i = 0; i < stability->count; i++) put_limits(stream, &stability->rows[i]);
    shv_print(stream,
              "\nhow far off: against no bars at a quarter of the stable step\n"
              "%-10s %5s %4s %9s  %-9s %9s %9s %9s %9s %9s\n",
              "E, Pa", "k", "n", "step", "class", "stiffness", "bars alone", "frequency", "displ.", "energy");
    for (int32_t i = 0; i < stability->count; i++) put_points(stream, &stability->rows[i]);
}

/* ---- JSON ---- */

static void put_point_json(FILE *stream, const ShvStabilityPoint *point)
{
    shv_print(stream, "{\"class\": \"%s\"", shv_stability_class_name(point->outcome));
    put_numbers(stream, JSON, point, point_fields, COUNT(point_fields));
    shv_print(stream, "}");
}

void shv_stability_print_json(const ShvStability *stability, FILE *stream)
{
    shv_print(stream, "{\"rows\": [");
    for (int32_t i = 0; i < stability->count; i++) {
        const ShvStabilityRow *row = &stability->rows[i];
        shv_print(stream, "%s{\"bars\": %s", i ? ",\n " : "", row->iterations > 0 ? "true" : "false");
        put_numbers(stream, JSON, row, setting_fields, COUNT(setting_fields));
        shv_print(stream, ", \"iterations\": %d", (int)row->iterations);
        put_numbers(stream, JSON, row, limit_fields, COUNT(limit_fields));
        put_numbers(stream, JSON, row, odd_fields, COUNT(odd_fields));
        shv_print(stream, ", \"beyond\": \"%s\", \"far\": \"%s\", \"monotone\": %s, \"points\": [",
                  shv_stability_class_name(row->beyond), shv_stability_class_name(row->far),
                  row->monotone ? "true" : "false");
        for (int32_t k = 0; k < row->point_count; k++) {
            shv_print(stream, k > 0 ? ",\n  " : "");
            put_point_json(stream, &row->points[k]);
        }
        shv_print(stream, "]}");
    }
    shv_print(stream, "]}\n");
}

/* ---- CSV ---- */

static void put_line(FILE *stream, const ShvStability *stability, const ShvStabilityRow *row,
                     const ShvStabilityPoint *point)
{
    shv_print(stream, "%s,%d", row->iterations > 0 ? "bars" : "none", (int)row->iterations);
    put_numbers(stream, CSV, row, setting_fields, COUNT(setting_fields));
    put_numbers(stream, CSV, row, limit_fields, COUNT(limit_fields));
    put_numbers(stream, CSV, row, odd_fields, 2);
    shv_print(stream, ",%s,%s,%d,%s", shv_stability_class_name(row->beyond), shv_stability_class_name(row->far),
              (int)stability->options.steps, shv_stability_class_name(point->outcome));
    put_numbers(stream, CSV, point, point_fields, COUNT(point_fields));
    shv_print(stream, "\n");
}

void shv_stability_put_csv(const ShvStability *stability, FILE *stream)
{
    shv_print(stream,
              "stabiliser,iterations,youngs_modulus [Pa],k,stable_step [s],limit [stable steps],"
              "failed [stable steps],limit over that without bars,unstable_below [stable steps],"
              "stable_again [stable steps],class at failed,class at 3 x failed,steps,class,"
              "step [stable steps],stiffness,stiffness of bars alone,frequency,displacement error,energy kept\n");
    for (int32_t i = 0; i < stability->count; i++)
        for (int32_t k = 0; k < stability->rows[i].point_count; k++)
            put_line(stream, stability, &stability->rows[i], &stability->rows[i].points[k]);
}
