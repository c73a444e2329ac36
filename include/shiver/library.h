/* The program's own materials: numbers with their sources, for `library: NAME` in a scene. */
#ifndef SHIVER_LIBRARY_H
#define SHIVER_LIBRARY_H

#include "shiver/definition.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One number under the name that the scene's key has (weibull_modulus: `weibull: {modulus: …}`); SI, angles in degrees. */
typedef struct ShvLibraryNumber {
    const char *key; /* NULL ends the list */
    double value;
    const char *source;
    bool unchecked; /* the source has not been read */
} ShvLibraryNumber;

enum { SHV_LIBRARY_NUMBERS = 12 };

typedef struct ShvLibraryMaterial {
    const char *name, *title;
    bool breakable;
    ShvUnresolved unresolved; /* tip_strength where no mesh of a body of centimetres resolves its cohesive zone */
    ShvLibraryNumber numbers[SHV_LIBRARY_NUMBERS];
    const char *remark; /* a sentence on what the numbers stand for */
} ShvLibraryMaterial;

int32_t shv_library_count(void);
/* NULL when there is none of that index or name. */
const ShvLibraryMaterial *shv_library_get(int32_t index);
const ShvLibraryMaterial *shv_library_find(const char *name);
/* The definition that `library: NAME` alone makes, under the library's name. */
ShvMaterialDefinition shv_library_definition(const ShvLibraryMaterial *material);

/* What the solver makes of it, m: infinite where nothing can open. */
typedef struct ShvLibraryFigures {
    double cohesive_zone;        /* (π/8) E/(1−ν²) G/σ² */
    double resolved_edge;        /* longest mean edge at which five fit into the zone */
    double snap_back;            /* 2 E G/σ² */
    double compressive_strength; /* Pa: 2 τ tan(45° + φ/2), at which a free column breaks */
} ShvLibraryFigures;
ShvLibraryFigures shv_library_figures(const ShvLibraryMaterial *material);

#ifdef __cplusplus
}
#endif
#endif
