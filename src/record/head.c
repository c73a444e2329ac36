/* What is written once: root attributes, scene, mesh, names. */
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "record/hdf5_array.h"
#include "record/hdf5_text.h"
#include "record/processor.h"
#include "record/record.h"

static bool write_attributes(hid_t file, const ShvRecordDefinition *definition, const ShvSimulation *simulation)
{
    const int32_t format = SHV_RUN_FILE_FORMAT;
    char processor[256];
    shv_processor_name(processor, sizeof processor);
    return shv_attribute_put_number(file, "shiver_format", H5T_STD_I32LE, H5T_NATIVE_INT32, &format) &&
           shv_attribute_put_text(file, "code_version", SHIVER_VERSION, 1) &&
           shv_attribute_put_text(file, "scene_name", definition->scene_name ? definition->scene_name : "", 1) &&
           shv_attribute_put_number(file, "scene_hash", H5T_STD_U64LE, H5T_NATIVE_UINT64, &definition->scene_hash) &&
           shv_attribute_put_number(file, "threads", H5T_STD_I32LE, H5T_NATIVE_INT32, &definition->threads) &&
           shv_attribute_put_text(file, "processor", processor, 1) &&
           shv_attribute_put_text(file, "rigid_engine", shv_simulation_rigid_engine(simulation), 1) &&
           shv_attribute_put_text(file, "status", "running", SHV_RECORD_STATUS) &&
           shv_attribute_put_text(file, "message", "", SHV_RECORD_MESSAGE) &&
           shv_attribute_put_text(file, "units", "SI", 1) && shv_attribute_put_text(file, "up", "z, right-handed", 1) &&
           shv_attribute_put_text(file, "quaternion_order", "wxyz", 1) &&
           shv_attribute_put_text(
               file, "pose", "world = position + rotate(orientation, reference - reference_centre of /fragments/list)",
               1);
}

bool shv_record_write_badge(hid_t file, uint64_t *address)
{
    const hsize_t count = 2;
    const hid_t space = H5Screate_simple(1, &count, NULL), list = H5Pcreate(H5P_DATASET_CREATE);
    hid_t dataset = -1;
    if (space >= 0 && list >= 0 && H5Pset_obj_track_times(list, false) >= 0 &&
        H5Pset_alloc_time(list, H5D_ALLOC_TIME_EARLY) >= 0)
        dataset = H5Dcreate2(file, "/journal", H5T_STD_U64LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
    *address = dataset >= 0 ? H5Dget_offset(dataset) : HADDR_UNDEF;
    if (dataset >= 0) H5Dclose(dataset);
    if (list >= 0) H5Pclose(list);
    if (space >= 0) H5Sclose(space);
    return *address != HADDR_UNDEF;
}

bool shv_record_find_badge(hid_t file, uint64_t *address)
{
    const hid_t dataset = H5Dopen2(file, "/journal", H5P_DEFAULT);
    *address = dataset >= 0 ? H5Dget_offset(dataset) : HADDR_UNDEF;
    if (dataset >= 0) H5Dclose(dataset);
    return *address != HADDR_UNDEF;
}

/* The overrides, one a line. */
static bool write_overrides(hid_t file, const ShvRecordDefinition *definition)
{
    size_t size = 1;
    for (int32_t i = 0; i < definition->override_count; i++) size += strlen(definition->overrides[i]) + 1;
    char *text = shv_allocate(definition->memory, SHV_PART_RECORD, size, 1);
    if (!text) return false;
    char *end = text;
    for (int32_t i = 0; i < definition->override_count; i++)
        end += shv_format(end, size - (size_t)(end - text), "%s\n", definition->overrides[i]);
    const bool good = shv_dataset_put_text(file, "/scene/overrides", text);
    shv_release(text);
    return good;
}

bool shv_record_rewrite_overrides(hid_t file, const ShvRecordDefinition *definition)
{
    return H5Adelete(file, "scene_hash") >= 0 &&
           shv_attribute_put_number(file, "scene_hash", H5T_STD_U64LE, H5T_NATIVE_UINT64, &definition->scene_hash) &&
           H5Ldelete(file, "/scene/overrides", H5P_DEFAULT) >= 0 && write_overrides(file, definition);
}

/* Readers know by the attribute that corners may be missing. */
static bool put_nodes_group(hid_t file, const ShvSimulation *simulation)
{
    const ShvNodesWithin within = shv_simulation_nodes_within(simulation);
    const int32_t partial = shv_nodes_limited(&within);
    if (!shv_group_put(file, "/nodes")) return false;
    const hid_t group = H5Gopen2(file, "/nodes", H5P_DEFAULT);
    const bool good =
        group >= 0 && shv_attribute_put_number(group, "partial", H5T_STD_I32LE, H5T_NATIVE_INT32, &partial);
    if (group >= 0) H5Gclose(group);
    return good;
}

bool shv_record_write_head(hid_t file, const ShvRecordDefinition *definition, const ShvSimulation *simulation)
{
    static const char *const groups[] = {"/scene", "/mesh", "/trajectory", "/obstacles", "/fragments", "/cost"};
    for (size_t i = 0; i < sizeof groups / sizeof groups[0]; i++)
        if (!shv_group_put(file, groups[i])) return false;
    if (definition->nodes && !put_nodes_group(file, simulation)) return false;
    return write_attributes(file, definition, simulation) &&
           shv_dataset_put_text(file, "/scene/text", definition->scene_text ? definition->scene_text : "") &&
           write_overrides(file, definition);
}

/* ---- constant arrays ---- */

typedef const char *(*NameOf)(const void *items, int32_t index);

static bool put_names(hid_t file, const char *path, int32_t count, NameOf name_of, const void *items)
{
    size_t size = 1;
    for (int32_t i = 0; i < count; i++) {
        const size_t length = strlen(name_of(items, i)) + 1;
        if (length > size) size = length;
    }
    char *texts = shv_allocate(NULL, SHV_PART_RECORD, (size_t)count, size);
    const hid_t type = texts ? shv_text_type(size) : -1;
    if (texts)
        for (int32_t i = 0; i < count; i++) strcpy(texts + (size_t)i * size, name_of(items, i));
    const bool good = type >= 0 && shv_array_put(file, path, type, type, count, 0, false, texts, NULL);
    if (type >= 0) H5Tclose(type);
    shv_release(texts);
    return good;
}

static const char *object_name(const void *items, int32_t i)
{
    return ((const ShvObjectView *)items)[i].name;
}
static const char *object_material(const void *items, int32_t i)
{
    return ((const ShvObjectView *)items)[i].material;
}
static const char *obstacle_name(const void *items, int32_t i)
{
    return ((const ShvObstacleView *)items)[i].name;
}
static const char *cost_name(const void *items, int32_t i)
{
    return ((const ShvCostView *)items)[i].name;
}
static const char *bytes_name(const void *items, int32_t i)
{
    return ((const ShvBytesView *)items)[i].name;
}

static const char *probe_name(const void *items, int32_t i)
{
    return ((const ShvProbeView *)items)[i].name;
}

static const char *material_name(const void *items, int32_t i)
{
    return ((const ShvMaterialView *)items)[i].name;
}
static const char *material_unresolved(const void *items, int32_t i)
{
    return shv_unresolved_name(((const ShvMaterialView *)items)[i].unresolved);
}

static bool put_material_numbers(hid_t file, const ShvMaterialView *materials, int32_t count)
{
    double *column = shv_allocate(NULL, SHV_PART_RECORD, (size_t)count, sizeof *column);
    bool good = column != NULL;
    for (int k = 0; good && k < SHV_MATERIAL_COLUMNS; k++) {
        for (int32_t i = 0; i < count; i++)
            memcpy(&column[i], (const char *)&materials[i] + shv_material_columns[k].offset, sizeof *column);
        good = shv_array_put(file, shv_material_columns[k].path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, count, 0, false,
                             column, NULL);
    }
    shv_release(column);
    return good;
}

bool shv_record_write_materials(hid_t file, const ShvSimulation *simulation)
{
    const int32_t count = shv_simulation_material_count(simulation);
    ShvMaterialView *materials = shv_allocate(NULL, SHV_PART_RECORD, (size_t)count, sizeof *materials);
    if (!materials) return false;
    for (int32_t i = 0; i < count; i++) materials[i] = shv_simulation_material(simulation, i);
    const bool good = shv_group_put(file, "/materials") &&
                      put_names(file, "/materials/name", count, material_name, materials) &&
                      put_names(file, "/materials/unresolved", count, material_unresolved, materials) &&
                      put_material_numbers(file, materials, count);
    shv_release(materials);
    return good;
}

static bool put_ranges(hid_t file, const ShvMeshView *mesh)
{
    int32_t *ranges = shv_allocate(NULL, SHV_PART_RECORD, 4 * (size_t)mesh->object_count, sizeof *ranges);
    if (!ranges) return false;
    for (int32_t i = 0; i < mesh->object_count; i++) {
        const ShvObjectView *object = &mesh->objects[i];
        const int32_t range[4] = {object->element_begin, object->element_end, object->node_begin, object->node_end};
        memcpy(ranges + 4 * (int64_t)i, range, sizeof range);
    }
    const bool good = shv_array_put(file, "/mesh/object_ranges", H5T_STD_I32LE, H5T_NATIVE_INT32, mesh->object_count, 4,
                                    false, ranges, NULL);
    shv_release(ranges);
    return good;
}

bool shv_record_write_mesh(hid_t file, const ShvMeshView *mesh, hid_t *owners)
{
    return shv_array_put(file, "/mesh/positions", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, mesh->node_count, 3, true,
                         mesh->positions, NULL) &&
           shv_array_put(file, "/mesh/elements", H5T_STD_I32LE, H5T_NATIVE_INT32, mesh->element_count, 4, true,
                         mesh->elements, NULL) &&
           put_names(file, "/mesh/object_names", mesh->object_count, object_name, mesh->objects) &&
           put_names(file, "/mesh/object_materials", mesh->object_count, object_material, mesh->objects) &&
           put_ranges(file, mesh) &&
           shv_array_put(file, "/fragments/elements", H5T_STD_I32LE, H5T_NATIVE_INT32, mesh->element_count, 0, false,
                         NULL, owners);
}

bool shv_record_write_names(hid_t file, const ShvFrameView *frame)
{
    return put_names(file, "/obstacles/name", frame->obstacle_count, obstacle_name, frame->obstacles) &&
           (frame->probe_count == 0 ||
            put_names(file, "/probes/name", frame->probe_count, probe_name, frame->probes)) &&
           put_names(file, "/cost/name", frame->cost_count, cost_name, frame->costs) &&
           put_names(file, "/cost/bytes_name", frame->bytes_count, bytes_name, frame->bytes);
}
