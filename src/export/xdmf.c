#include "export/xdmf.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/publish.h"
#include "base/text.h"
#include "record/hdf5_array.h"
#include "record/hdf5_text.h"

static const char *const SUFFIXES[] = {"_xdmf.h5", "_fragments.xmf", "_mesh.xmf", "_obstacles.xmf"};

static ShvStatus fail_numbers(const ShvXdmf *xdmf, ShvError *error)
{
    if (shv_stage_failure(xdmf->stage) == ENOMEM)
        return shv_fail(error, SHV_NO_MEMORY, "out of memory for '%s'", xdmf->path);
    return shv_fail(error, SHV_FILE_ERROR, "cannot write '%s'; make room on the disk", xdmf->path);
}

/* ---- data sets and what refers to them ---- */

ShvStatus shv_xdmf_put(const ShvXdmf *xdmf, const char *path, ShvXdmfType type, int64_t rows, int64_t columns,
                       const void *data, ShvError *error)
{
    const hid_t file_type = type == SHV_XDMF_INT      ? H5T_STD_I32LE
                            : type == SHV_XDMF_SINGLE ? H5T_IEEE_F32LE
                                                      : H5T_IEEE_F64LE;
    const hid_t memory_type = type == SHV_XDMF_INT ? H5T_NATIVE_INT32 : H5T_NATIVE_DOUBLE;
    const ShvSilence silence = shv_silence_begin();
    const bool good = shv_array_put(xdmf->numbers, path, file_type, memory_type, rows, columns, true, data, NULL);
    shv_silence_end(silence);
    return good ? SHV_OK : fail_numbers(xdmf, error);
}

void shv_xdmf_item(const ShvXdmf *xdmf, const char *path, ShvXdmfType type, int64_t rows, int64_t columns)
{
    shv_print(xdmf->stream, "<DataItem Format=\"HDF\" NumberType=\"%s\" Precision=\"%d\" Dimensions=\"%lld",
              type == SHV_XDMF_INT ? "Int" : "Float", type == SHV_XDMF_DOUBLE ? 8 : 4, (long long)rows);
    if (columns > 0) shv_print(xdmf->stream, " %lld", (long long)columns);
    shv_print(xdmf->stream, "\">%s:%s</DataItem>", xdmf->numbers_name, path);
}

void shv_xdmf_attribute(const ShvXdmf *xdmf, const char *name, const char *kind, const char *centre, const char *path,
                        ShvXdmfType type, int64_t rows, int64_t columns)
{
    shv_print(xdmf->stream, "        <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">", name, kind, centre);
    shv_xdmf_item(xdmf, path, type, rows, columns);
    shv_print(xdmf->stream, "</Attribute>\n");
}

/* ---- the three files ---- */

typedef ShvStatus (*WriteGrids)(const ShvXdmf *xdmf, ShvError *error);

static ShvStatus write_xml(ShvXdmf *xdmf, ShvOutput *output, const char *prefix, const char *suffix, const char *name,
                           WriteGrids grids, ShvError *error)
{
    SHV_TRY(shv_output_open(output, &xdmf->options, prefix, suffix, error));
    xdmf->stream = output->stream;
    shv_print(xdmf->stream,
              "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
              "    <Grid Name=\"%s\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
              name);
    const ShvStatus status = grids(xdmf, error);
    shv_print(xdmf->stream, "    </Grid>\n  </Domain>\n</Xdmf>\n");
    return status;
}

static ShvStatus open_numbers(ShvXdmf *xdmf, const char *path, char **temporary, ShvError *error)
{
    xdmf->path = path;
    const char *slash = strrchr(path, '/');
    xdmf->numbers_name = shv_output_escaped(&xdmf->options, slash ? slash + 1 : path);
    if (!xdmf->numbers_name) return shv_fail_memory(error, "a file name", 6 * strlen(path));
    SHV_TRY(shv_publish_begin(xdmf->options.memory, path, temporary, &xdmf->descriptor, error));
    SHV_TRY(shv_stage_create(&xdmf->stage, xdmf->options.memory, xdmf->descriptor, error));
    const ShvSilence silence = shv_silence_begin();
    xdmf->numbers = shv_stage_make(xdmf->stage, *temporary);
    const bool good = xdmf->numbers >= 0 && shv_group_put(xdmf->numbers, "/fragments") &&
                      shv_group_put(xdmf->numbers, "/mesh") && shv_group_put(xdmf->numbers, "/obstacles");
    shv_silence_end(silence);
    return good ? SHV_OK : fail_numbers(xdmf, error);
}

static ShvStatus close_numbers(ShvXdmf *xdmf, char *temporary, ShvStatus status, ShvError *error)
{
    const ShvSilence silence = shv_silence_begin();
    /* HDF5 cannot let go of a file that it could not write, and crashes at the exit: so it writes everything first, and then
       closes over a stage that takes what is left in silence. */
    if (xdmf->numbers >= 0 && status == SHV_OK) H5Fflush(xdmf->numbers, H5F_SCOPE_GLOBAL);
    if (xdmf->stage) shv_stage_discard(xdmf->stage);
    if (xdmf->numbers >= 0) H5Fclose(xdmf->numbers);
    shv_silence_end(silence);
    if (status == SHV_OK && shv_stage_failure(xdmf->stage) != 0) status = fail_numbers(xdmf, error);
    if (status == SHV_OK) status = shv_stage_end(xdmf->stage, error);
    if (status == SHV_OK) status = shv_publish_end(temporary, xdmf->descriptor, xdmf->path, xdmf->options.force, error);
    if (status != SHV_OK && temporary) unlink(temporary);
    shv_stage_release(xdmf->stage);
    if (xdmf->descriptor >= 0) close(xdmf->descriptor);
    shv_release(temporary);
    shv_release(xdmf->numbers_name);
    return status;
}

static ShvStatus write_all(ShvXdmf *xdmf, const char *prefix, const char *path, ShvError *error)
{
    char *temporary = NULL;
    ShvOutput fragments = {NULL, NULL, NULL}, mesh = {NULL, NULL, NULL}, obstacles = {NULL, NULL, NULL};
    ShvStatus status = open_numbers(xdmf, path, &temporary, error);
    if (status == SHV_OK)
        status = write_xml(xdmf, &fragments, prefix, SUFFIXES[1], "fragments", shv_xdmf_fragments, error);
    if (status == SHV_OK)
        status = write_xml(xdmf, &mesh, prefix, SUFFIXES[2], "mesh",
                           xdmf->info->nodes ? shv_xdmf_deformed_mesh : shv_xdmf_mesh, error);
    if (status == SHV_OK && xdmf->info->obstacle_count > 0)
        status = write_xml(xdmf, &obstacles, prefix, SUFFIXES[3], "obstacles", shv_xdmf_obstacles, error);
    status = close_numbers(xdmf, temporary, status, error);
    status = shv_output_close(&fragments, &xdmf->options, status, error);
    status = shv_output_close(&obstacles, &xdmf->options, status, error);
    return shv_output_close(&mesh, &xdmf->options, status, error);
}

ShvStatus shv_export_xdmf(ShvRunFile *file, const char *prefix, const ShvExportOptions *given, ShvError *error)
{
    ShvXdmf xdmf = {.file = file, .info = shv_run_file_info(file), .numbers = -1, .descriptor = -1};
    SHV_TRY(shv_export_options(given, &xdmf.options, error));
    SHV_TRY(shv_output_check(&xdmf.options, prefix, SUFFIXES, xdmf.info->obstacle_count > 0 ? 4 : 3, error));
    char *path = shv_output_path(&xdmf.options, prefix, SUFFIXES[0]);
    if (!path) return shv_fail_memory(error, "a file name", strlen(prefix));
    const size_t fragments = (size_t)xdmf.info->fragment_count;
    xdmf.lineage = shv_allocate(xdmf.options.memory, SHV_PART_RECORD, fragments, sizeof(int32_t));
    ShvStatus status = xdmf.lineage ? shv_run_file_lineages(file, xdmf.lineage, error)
                                    : shv_fail_memory(error, "fragments", fragments * sizeof(int32_t));
    if (status == SHV_OK) status = write_all(&xdmf, prefix, path, error);
    shv_release(xdmf.lineage);
    shv_release(path);
    return status;
}
