/* Columns of /materials: where each number of a ShvMaterialView stands in the run file. */
#ifndef SHV_RECORD_MATERIALS_H
#define SHV_RECORD_MATERIALS_H

#include <stddef.h>

enum { SHV_MATERIAL_COLUMNS = 12 };

typedef struct ShvMaterialColumn {
    const char *path;
    size_t offset; /* of a double in ShvMaterialView */
} ShvMaterialColumn;
extern const ShvMaterialColumn shv_material_columns[SHV_MATERIAL_COLUMNS];

#endif
