#include "record/materials.h"

#include <string.h>

#include "record/run_file.h"

const ShvMaterialColumn shv_material_columns[SHV_MATERIAL_COLUMNS] = {
    {"/materials/youngs_modulus", offsetof(ShvMaterialView, youngs_modulus)},
    {"/materials/poissons_ratio", offsetof(ShvMaterialView, poissons_ratio)},
    {"/materials/mesh_edge", offsetof(ShvMaterialView, mesh_edge)},
    {"/materials/zone_edges", offsetof(ShvMaterialView, zone_edges)},
    {"/materials/resolved_edge", offsetof(ShvMaterialView, resolved_edge)},
    {"/materials/nominal_strength", offsetof(ShvMaterialView, nominal_strength)},
    {"/materials/strength", offsetof(ShvMaterialView, strength)},
    {"/materials/nominal_fracture_energy", offsetof(ShvMaterialView, nominal_energy)},
    {"/materials/fracture_energy", offsetof(ShvMaterialView, energy)},
    {"/materials/cohesive_zone", offsetof(ShvMaterialView, cohesive_zone)},
    {"/materials/snap_back", offsetof(ShvMaterialView, snap_back)},
    {"/materials/tip_toughness", offsetof(ShvMaterialView, tip_toughness)}};

static ShvUnresolved unresolved_of(const char *name)
{
    for (int i = SHV_UNRESOLVED_TIP_STRENGTH; i > SHV_UNRESOLVED_KEEP; i--)
        if (strcmp(shv_unresolved_name((ShvUnresolved)i), name) == 0) return (ShvUnresolved)i;
    return SHV_UNRESOLVED_KEEP;
}

static ShvStatus read_numbers(const ShvRunFile *file, ShvError *error)
{
    double *column = shv_allocate(file->memory, SHV_PART_RECORD, (size_t)file->material_count, sizeof *column);
    if (!column) return shv_fail_memory(error, "materials", (size_t)file->material_count * sizeof *column);
    ShvStatus status = SHV_OK;
    for (int k = 0; status == SHV_OK && k < SHV_MATERIAL_COLUMNS; k++) {
        /* Files of earlier versions do not have all: what is not known is 0. */
        if (H5Lexists(file->file, shv_material_columns[k].path, H5P_DEFAULT) <= 0) continue;
        status = shv_run_read_array(file, shv_material_columns[k].path, file->material_count, 0, true, column, error);
        for (int32_t i = 0; status == SHV_OK && i < file->material_count; i++)
            memcpy((char *)&file->materials[i] + shv_material_columns[k].offset, &column[i], sizeof *column);
    }
    shv_release(column);
    return status;
}

static ShvStatus read_unresolved(const ShvRunFile *file, ShvError *error)
{
    char *texts = NULL;
    size_t size;
    int32_t count = 0;
    ShvStatus status = shv_run_read_texts(file, "/materials/unresolved", 1, &texts, &size, &count, error);
    if (status == SHV_OK && count != file->material_count)
        status = shv_run_fail_damaged(file, "/materials/unresolved", error);
    for (int32_t i = 0; status == SHV_OK && i < count; i++)
        file->materials[i].unresolved = unresolved_of(texts + (size_t)i * size);
    shv_release(texts);
    return status;
}

ShvStatus shv_run_read_materials(ShvRunFile *file, ShvError *error)
{
    /* Files of earlier versions have none. */
    if (H5Lexists(file->file, "/materials", H5P_DEFAULT) <= 0) return SHV_OK;
    size_t size;
    int32_t count = 0;
    SHV_TRY(shv_run_read_texts(file, "/materials/name", 1, &file->material_names, &size, &count, error));
    file->materials = shv_allocate(file->memory, SHV_PART_RECORD, (size_t)count, sizeof *file->materials);
    if (!file->materials) return shv_fail_memory(error, "materials", (size_t)count * sizeof *file->materials);
    file->material_count = count;
    SHV_TRY(read_numbers(file, error));
    SHV_TRY(read_unresolved(file, error));
    for (int32_t i = 0; i < count; i++) {
        file->materials[i].name = file->material_names + (size_t)i * size;
        file->materials[i].breakable = file->materials[i].cohesive_zone <= 1e300;
    }
    return SHV_OK;
}

int32_t shv_run_file_material_count(const ShvRunFile *file)
{
    return file->material_count;
}

ShvMaterialView shv_run_file_material(const ShvRunFile *file, int32_t index)
{
    return file->materials[index];
}
