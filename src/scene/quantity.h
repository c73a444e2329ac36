/* Numbers with units: "70e9", "70 GPa", "3mm". A unit must belong to the dimension of its key. */
#ifndef SHV_SCENE_QUANTITY_H
#define SHV_SCENE_QUANTITY_H

#include <stddef.h>

typedef enum ShvDimension {
    SHV_DIMENSION_NONE,
    SHV_DIMENSION_LENGTH,
    SHV_DIMENSION_AREA,
    SHV_DIMENSION_VOLUME,
    SHV_DIMENSION_MASS,
    SHV_DIMENSION_TIME,
    SHV_DIMENSION_FREQUENCY,
    SHV_DIMENSION_VELOCITY,
    SHV_DIMENSION_ACCELERATION,
    SHV_DIMENSION_ANGLE,
    SHV_DIMENSION_ANGULAR_VELOCITY,
    SHV_DIMENSION_DENSITY,
    SHV_DIMENSION_PRESSURE,
    SHV_DIMENSION_SURFACE_ENERGY,
    SHV_DIMENSION_IMPULSE,
    SHV_DIMENSION_COUNT
} ShvDimension;

typedef enum ShvQuantityFault {
    SHV_QUANTITY_FINE,
    SHV_QUANTITY_NO_NUMBER,
    SHV_QUANTITY_TOO_LARGE, /* a number beyond the largest double */
    SHV_QUANTITY_WRONG_UNIT
} ShvQuantityFault;

/* Reads a number in the base unit of `dimension`. ".inf" and ".nan" are numbers here. After a wrong unit *unit points to
   it. "9 mm" has the bits of "0.009": units divide where they are smaller than the base. */
ShvQuantityFault shv_quantity_read(const char *text, ShvDimension dimension, double *value, const char **unit);

/* "length"; "numbers" of none. */
const char *shv_dimension_name(ShvDimension dimension);
/* Unit number `index` (0: the one in which a bare number counts), NULL beyond the last. */
const char *shv_dimension_unit(ShvDimension dimension, int index);
/* "m, mm, cm, um", "" of none. */
void shv_dimension_units(ShvDimension dimension, char *buffer, size_t size);

#endif
