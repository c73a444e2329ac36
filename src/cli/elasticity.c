#include "cli/elasticity.h"

#include <string.h>

#include "cli/command.h"
#include "shiver/definition.h"

static bool find_moduli(const ShvRunFile *file, const char *material, ShvElasticity *elasticity)
{
    for (int32_t i = 0; i < shv_run_file_material_count(file); i++) {
        const ShvMaterialView found = shv_run_file_material(file, i);
        if (strcmp(found.name, material) != 0) continue;
        *elasticity = (ShvElasticity){found.youngs_modulus, found.poissons_ratio};
        return found.youngs_modulus > 0.0;
    }
    return false;
}

ShvStatus shv_cli_elasticity(const ShvRunFile *file, ShvElasticity **elasticity, ShvError *error)
{
    const int32_t count = shv_run_file_info(file)->object_count;
    *elasticity = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)count, sizeof **elasticity);
    if (!*elasticity) return shv_fail_memory(error, "materials", (size_t)count * sizeof **elasticity);
    for (int32_t i = 0; i < count; i++) {
        if (find_moduli(file, shv_run_file_object(file, i).material, &(*elasticity)[i])) continue;
        shv_release(*elasticity);
        *elasticity = NULL;
        break;
    }
    return SHV_OK;
}

bool shv_cli_made_convex_pieces(const ShvRunFile *file)
{
    const char *engine = shv_run_file_info(file)->rigid_engine;
    return strcmp(engine, shv_rigid_engine_name(SHV_RIGID_BULLET)) == 0 ||
           strcmp(engine, shv_rigid_engine_name(SHV_RIGID_BULLET_PLAIN)) == 0;
}
