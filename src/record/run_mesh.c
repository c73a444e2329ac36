/* Reference mesh and fragments of a run file. */
#include <string.h>

#include "record/hdf5_text.h"
#include "record/run_file.h"

/* ---- mesh ---- */

static ShvStatus check_elements(const ShvRunFile *file, const int32_t *elements, ShvError *error)
{
    for (int64_t i = 0; i < 4 * (int64_t)file->info.element_count; i++)
        if (elements[i] < 0 || elements[i] >= file->info.node_count)
            return shv_run_fail_damaged(file, "/mesh/elements", error);
    return SHV_OK;
}

static ShvStatus read_element_objects(const ShvRunFile *file, uint16_t *element_object, ShvError *error)
{
    if (file->info.object_count > UINT16_MAX) return shv_run_fail_damaged(file, "the list of objects", error);
    for (int32_t i = 0; i < file->info.object_count; i++)
        for (int32_t e = file->objects[i].element_begin; e < file->objects[i].element_end; e++)
            element_object[e] = (uint16_t)i;
    return SHV_OK;
}

static ShvStatus read_owners(const ShvRunFile *file, int32_t *owner, ShvError *error)
{
    SHV_TRY(shv_run_read_array(file, "/fragments/elements", file->info.element_count, 0, false, owner, error));
    for (int32_t e = 0; e < file->info.element_count; e++)
        if (owner[e] < 0 || owner[e] >= file->info.fragment_count)
            return shv_run_fail_damaged(file, "/fragments/elements", error);
    return SHV_OK;
}

static ShvStatus read_mesh(const ShvRunFile *file, double *positions, int32_t *elements, uint16_t *element_object,
                           int32_t *element_fragment, ShvError *error)
{
    if (positions)
        SHV_TRY(shv_run_read_array(file, "/mesh/positions", file->info.node_count, 3, true, positions, error));
    if (elements) {
        SHV_TRY(shv_run_read_array(file, "/mesh/elements", file->info.element_count, 4, false, elements, error));
        SHV_TRY(check_elements(file, elements, error));
    }
    if (element_object) SHV_TRY(read_element_objects(file, element_object, error));
    if (element_fragment) SHV_TRY(read_owners(file, element_fragment, error));
    return SHV_OK;
}

ShvStatus shv_run_file_mesh(ShvRunFile *file, double *positions, int32_t *elements, uint16_t *element_object,
                            int32_t *element_fragment, ShvError *error)
{
    const ShvSilence silence = shv_silence_begin();
    const ShvStatus status = read_mesh(file, positions, elements, element_object, element_fragment, error);
    shv_silence_end(silence);
    return status;
}

/* ---- fragments ---- */

static ShvStatus check_fragments(const ShvRunFile *file, const ShvFragmentView *fragments, ShvError *error)
{
    for (int32_t i = 0; i < file->info.fragment_count; i++) {
        const ShvFragmentView *fragment = &fragments[i];
        if (fragment->id != i || fragment->parent < -1 || fragment->parent >= i || fragment->object < 0 ||
            fragment->object >= file->info.object_count)
            return shv_run_fail_damaged(file, "/fragments/list", error);
    }
    return SHV_OK;
}

/* Mode and motion of the last frame. */
static ShvStatus add_poses(ShvRunFile *file, ShvFragmentView *fragments, double *values, uint8_t *alive,
                           ShvError *error)
{
    static const struct {
        ShvSeriesName name;
        size_t offset, components;
    } parts[] = {{SHV_SERIES_POSITION, offsetof(ShvFragmentView, position), 3},
                 {SHV_SERIES_ORIENTATION, offsetof(ShvFragmentView, orientation), 4},
                 {SHV_SERIES_VELOCITY, offsetof(ShvFragmentView, velocity), 3},
                 {SHV_SERIES_ANGULAR_VELOCITY, offsetof(ShvFragmentView, angular_velocity), 3}};
    const int64_t last = file->info.frame_count - 1;
    const int32_t count = file->info.fragment_count;
    for (size_t p = 0; p < sizeof parts / sizeof parts[0]; p++) {
        SHV_TRY(shv_run_get(file, parts[p].name, last, count, values, error));
        for (int32_t i = 0; i < count; i++)
            memcpy((char *)&fragments[i] + parts[p].offset, values + parts[p].components * (size_t)i,
                   parts[p].components * sizeof *values);
    }
    SHV_TRY(shv_run_get(file, SHV_SERIES_ALIVE, last, count, alive, error));
    for (int32_t i = 0; i < count; i++)
        fragments[i].mode = !alive[i]           ? SHV_FRAGMENT_DEAD
                            : file->modes[last] ? SHV_FRAGMENT_FRACTURE
                                                : SHV_FRAGMENT_FLIGHT;
    return SHV_OK;
}

ShvStatus shv_run_file_lineages(ShvRunFile *file, int32_t *lineages, ShvError *error)
{
    const int32_t count = file->info.fragment_count;
    const ShvSilence silence = shv_silence_begin();
    bool good = shv_series_read(&file->series[SHV_SERIES_LINEAGE], 0, count, 0, lineages);
    shv_silence_end(silence);
    for (int32_t i = 0; good && i < count; i++) good = lineages[i] >= 0 && lineages[i] <= i;
    return good ? SHV_OK : shv_run_fail_damaged(file, "/fragments/lineage", error);
}

ShvStatus shv_run_file_fragments(ShvRunFile *file, ShvFragmentView *fragments, ShvError *error)
{
    const size_t count = (size_t)file->info.fragment_count;
    const ShvSilence silence = shv_silence_begin();
    const bool good = shv_series_read(&file->series[SHV_SERIES_FRAGMENTS], 0, (int64_t)count, 0, fragments);
    shv_silence_end(silence);
    if (!good) return shv_run_fail_damaged(file, "/fragments/list", error);
    SHV_TRY(check_fragments(file, fragments, error));
    double *values = shv_allocate(file->memory, SHV_PART_RECORD, 4 * count, sizeof *values);
    uint8_t *alive = shv_allocate(file->memory, SHV_PART_RECORD, count, 1);
    const ShvStatus status = values && alive ? add_poses(file, fragments, values, alive, error)
                                             : shv_fail_memory(error, "poses", 33 * count);
    shv_release(values);
    shv_release(alive);
    return status;
}
