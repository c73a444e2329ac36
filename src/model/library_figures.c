#include "model/material.h"
#include "shiver/library.h"

ShvLibraryFigures shv_library_figures(const ShvLibraryMaterial *material)
{
    ShvMaterial made;
    ShvError error;
    const ShvMaterialDefinition definition = shv_library_definition(material);
    const double none = (double)INFINITY;
    if (shv_material_make(&made, &definition, &error) != SHV_OK) return (ShvLibraryFigures){none, none, none, none};
    return (ShvLibraryFigures){shv_material_cohesive_zone(&made), shv_material_resolved_edge(&made),
                               shv_material_snap_back(&made), shv_material_compressive_strength(&made)};
}
