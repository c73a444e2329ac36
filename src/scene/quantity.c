#include "scene/quantity.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"

enum { LARGEST_UNITS = 8 };

/* value in the base unit = number × multiply / divide; one of the two is 1, so that one rounding is made. */
typedef struct Unit {
    const char *name;
    double multiply, divide;
} Unit;

typedef struct Dimension {
    const char *name;
    Unit units[LARGEST_UNITS];
} Dimension;

static const Dimension dimensions[SHV_DIMENSION_COUNT] = {
    [SHV_DIMENSION_NONE] = {"number", {{NULL, 0, 0}}},
    [SHV_DIMENSION_LENGTH] =
        {"length", {{"m", 1, 1}, {"cm", 1, 1e2}, {"mm", 1, 1e3}, {"um", 1, 1e6}, {"µm", 1, 1e6}, {"km", 1e3, 1}}},
    [SHV_DIMENSION_AREA] = {"area", {{"m2", 1, 1}, {"cm2", 1, 1e4}, {"mm2", 1, 1e6}}},
    [SHV_DIMENSION_VOLUME] = {"volume", {{"m3", 1, 1}, {"cm3", 1, 1e6}, {"mm3", 1, 1e9}}},
    [SHV_DIMENSION_MASS] = {"mass", {{"kg", 1, 1}, {"g", 1, 1e3}, {"mg", 1, 1e6}, {"t", 1e3, 1}}},
    [SHV_DIMENSION_TIME] =
        {"time", {{"s", 1, 1}, {"ms", 1, 1e3}, {"us", 1, 1e6}, {"µs", 1, 1e6}, {"ns", 1, 1e9}, {"min", 60, 1}}},
    [SHV_DIMENSION_FREQUENCY] = {"rate", {{"1/s", 1, 1}, {"Hz", 1, 1}, {"kHz", 1e3, 1}, {"MHz", 1e6, 1}}},
    [SHV_DIMENSION_VELOCITY] =
        {"velocity", {{"m/s", 1, 1}, {"mm/s", 1, 1e3}, {"cm/s", 1, 1e2}, {"km/s", 1e3, 1}, {"km/h", 1, 3.6}}},
    [SHV_DIMENSION_ACCELERATION] = {"acceleration", {{"m/s2", 1, 1}, {"mm/s2", 1, 1e3}}},
    [SHV_DIMENSION_ANGLE] = {"angle", {{"deg", 1, 1}, {"rad", 57.29577951308232, 1}}},
    [SHV_DIMENSION_ANGULAR_VELOCITY] =
        {"angular velocity", {{"rad/s", 1, 1}, {"deg/s", 1, 57.29577951308232}, {"rpm", 1, 9.549296585513721}}},
    [SHV_DIMENSION_DENSITY] = {"density", {{"kg/m3", 1, 1}, {"g/cm3", 1e3, 1}, {"t/m3", 1e3, 1}}},
    [SHV_DIMENSION_PRESSURE] = {"stress",
                                {{"Pa", 1, 1}, {"kPa", 1e3, 1}, {"MPa", 1e6, 1}, {"GPa", 1e9, 1}, {"N/mm2", 1e6, 1}}},
    [SHV_DIMENSION_SURFACE_ENERGY] =
        {"surface energy", {{"J/m2", 1, 1}, {"N/m", 1, 1}, {"kJ/m2", 1e3, 1}, {"mJ/m2", 1, 1e3}, {"N/mm", 1e3, 1}}},
    [SHV_DIMENSION_IMPULSE] = {"impulse", {{"N s", 1, 1}, {"Ns", 1, 1}, {"kg m/s", 1, 1}, {"mN s", 1, 1e3}}},
};

/* Characters that belong to a decimal number; 'e' only before an exponent, so that "3 mm" and "3mm" both split. */
static size_t number_length(const char *text)
{
    size_t i = 0;
    if (text[i] == '+' || text[i] == '-') i++;
    while ((text[i] >= '0' && text[i] <= '9') || text[i] == '.') i++;
    if (text[i] != 'e' && text[i] != 'E') return i;
    size_t end = i + 1;
    if (text[end] == '+' || text[end] == '-') end++;
    if (text[end] < '0' || text[end] > '9') return i;
    while (text[end] >= '0' && text[end] <= '9') end++;
    return end;
}

/* The YAML spellings of numbers that are none. */
static bool read_special(const char *text, double *value)
{
    static const char *const infinities[] = {".inf", ".Inf", ".INF"}, *const not_numbers[] = {".nan", ".NaN", ".NAN"};
    for (int i = 0; i < 3; i++) {
        const char *unsigned_text = text + (*text == '+' || *text == '-');
        if (strcmp(unsigned_text, infinities[i]) == 0) {
            *value = *text == '-' ? (double)-INFINITY : (double)INFINITY;
            return true;
        }
        if (strcmp(text, not_numbers[i]) == 0) {
            *value = (double)NAN;
            return true;
        }
    }
    return false;
}

static const Unit *find_unit(ShvDimension dimension, const char *name)
{
    const Unit *units = dimensions[dimension].units;
    for (int i = 0; i < LARGEST_UNITS && units[i].name; i++)
        if (strcmp(units[i].name, name) == 0) return &units[i];
    return NULL;
}

ShvQuantityFault shv_quantity_read(const char *text, ShvDimension dimension, double *value, const char **unit)
{
    if (read_special(text, value)) return SHV_QUANTITY_FINE;
    const size_t length = number_length(text);
    double number = 0.0;
    if (shv_parse_double(text, length, false, &number, NULL) != SHV_OK) {
        const bool digits = strcspn(text, "0123456789") < length;
        const char *dot = memchr(text, '.', length);
        const bool dots = dot && memchr(dot + 1, '.', length - (size_t)(dot + 1 - text));
        return digits && !dots ? SHV_QUANTITY_TOO_LARGE : SHV_QUANTITY_NO_NUMBER;
    }
    const char *name = text + length;
    while (*name == ' ') name++;
    *unit = name;
    const Unit bare = {"", 1.0, 1.0};
    const Unit *found = *name ? find_unit(dimension, name) : &bare;
    if (!found) return SHV_QUANTITY_WRONG_UNIT;
    *value = number * found->multiply / found->divide;
    return isfinite(*value) ? SHV_QUANTITY_FINE : SHV_QUANTITY_TOO_LARGE;
}

const char *shv_dimension_name(ShvDimension dimension)
{
    return dimensions[dimension].name;
}

const char *shv_dimension_unit(ShvDimension dimension, int index)
{
    return index >= 0 && index < LARGEST_UNITS ? dimensions[dimension].units[index].name : NULL;
}

void shv_dimension_units(ShvDimension dimension, char *buffer, size_t size)
{
    size_t used = 0;
    buffer[0] = '\0';
    const char *name;
    for (int i = 0; (name = shv_dimension_unit(dimension, i)) && used < size; i++)
        used += (size_t)shv_format(buffer + used, size - used, i == 0 ? "%s" : ", %s", name);
}
