/* Living fragments as points. */
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/xdmf.h"

/* Arrays of one frame, first for all fragments, then packed to the living ones. */
typedef struct Points {
    double *position, *orientation, *velocity, *angular, *mass;
    int32_t *id, *object, *range;
    uint8_t *alive;
    ShvFragmentView *fragments;
} Points;

static int64_t pack(Points *points, int64_t count)
{
    int64_t kept = 0;
    for (int64_t i = 0; i < count; i++) {
        if (!points->alive[i]) continue;
        memmove(points->position + 3 * kept, points->position + 3 * i, 3 * sizeof(double));
        memmove(points->orientation + 4 * kept, points->orientation + 4 * i, 4 * sizeof(double));
        memmove(points->velocity + 3 * kept, points->velocity + 3 * i, 3 * sizeof(double));
        memmove(points->angular + 3 * kept, points->angular + 3 * i, 3 * sizeof(double));
        points->mass[kept] = points->fragments[i].mass;
        points->object[kept] = points->fragments[i].object;
        points->range[kept] = (int32_t)kept;
        points->id[kept++] = (int32_t)i;
    }
    return kept;
}

static ShvStatus put_vector(const ShvXdmf *xdmf, const char *name, const char *kind, int64_t frame, int64_t rows,
                            int64_t columns, const double *data, ShvError *error)
{
    char path[96];
    shv_format(path, sizeof path, "/fragments/%s_%06lld", name, (long long)frame);
    SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_DOUBLE, rows, columns, data, error));
    shv_xdmf_attribute(xdmf, name, kind, "Node", path, SHV_XDMF_DOUBLE, rows, columns);
    return SHV_OK;
}

static ShvStatus put_integers(const ShvXdmf *xdmf, const char *name, int64_t frame, int64_t rows, const int32_t *data,
                              ShvError *error)
{
    char path[96];
    shv_format(path, sizeof path, "/fragments/%s_%06lld", name, (long long)frame);
    SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_INT, rows, 0, data, error));
    shv_xdmf_attribute(xdmf, name, "Scalar", "Node", path, SHV_XDMF_INT, rows, 0);
    return SHV_OK;
}

/* Vertex numbers depend on the count alone: frames of equal count share them. */
static ShvStatus put_topology(const ShvXdmf *xdmf, const Points *points, int64_t count, ShvError *error)
{
    char path[96];
    shv_format(path, sizeof path, "/fragments/vertices_%lld", (long long)count);
    if (H5Lexists(xdmf->numbers, path, H5P_DEFAULT) <= 0)
        SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_INT, count, 1, points->range, error));
    shv_print(xdmf->stream,
              "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%lld\" NodesPerElement=\"1\">",
              (long long)count);
    shv_xdmf_item(xdmf, path, SHV_XDMF_INT, count, 1);
    shv_print(xdmf->stream, "</Topology>\n");
    return SHV_OK;
}

static ShvStatus put_frame(const ShvXdmf *xdmf, Points *points, int64_t frame, ShvError *error)
{
    double time;
    char path[96];
    SHV_TRY(shv_run_file_frame(xdmf->file, frame, &time, NULL, points->alive, points->position, points->orientation,
                               points->velocity, points->angular, error));
    const int64_t count = pack(points, xdmf->info->fragment_count);
    if (count == 0) return SHV_OK;
    shv_print(xdmf->stream, "      <Grid Name=\"fragments\" GridType=\"Uniform\">\n        <Time Value=\"%.17g\"/>\n",
              time);
    SHV_TRY(put_topology(xdmf, points, count, error));
    shv_format(path, sizeof path, "/fragments/position_%06lld", (long long)frame);
    SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_DOUBLE, count, 3, points->position, error));
    shv_print(xdmf->stream, "        <Geometry GeometryType=\"XYZ\">");
    shv_xdmf_item(xdmf, path, SHV_XDMF_DOUBLE, count, 3);
    shv_print(xdmf->stream, "</Geometry>\n");
    SHV_TRY(put_integers(xdmf, "fragment", frame, count, points->id, error));
    for (int64_t i = 0; i < count; i++) points->id[i] = xdmf->lineage[points->id[i]];
    SHV_TRY(put_integers(xdmf, "line", frame, count, points->id, error));
    SHV_TRY(put_integers(xdmf, "object", frame, count, points->object, error));
    SHV_TRY(put_vector(xdmf, "mass", "Scalar", frame, count, 0, points->mass, error));
    SHV_TRY(put_vector(xdmf, "velocity", "Vector", frame, count, 3, points->velocity, error));
    SHV_TRY(put_vector(xdmf, "angular_velocity", "Vector", frame, count, 3, points->angular, error));
    /* Four components: as "Vector" the oldest of the readers keeps three. */
    SHV_TRY(put_vector(xdmf, "orientation_wxyz", "Matrix", frame, count, 4, points->orientation, error));
    shv_print(xdmf->stream, "      </Grid>\n");
    return SHV_OK;
}

static ShvStatus put_frames(const ShvXdmf *xdmf, Points *points, ShvError *error)
{
    SHV_TRY(shv_run_file_fragments(xdmf->file, points->fragments, error));
    for (int64_t frame = 0; frame < xdmf->info->frame_count; frame++) {
        if (!shv_output_takes(&xdmf->options, xdmf->file, frame)) continue;
        SHV_TRY(put_frame(xdmf, points, frame, error));
    }
    return SHV_OK;
}

ShvStatus shv_xdmf_fragments(const ShvXdmf *xdmf, ShvError *error)
{
    const size_t count = (size_t)xdmf->info->fragment_count;
    struct ShvMemory *memory = xdmf->options.memory;
    double *values = shv_allocate(memory, SHV_PART_RECORD, 14 * count, sizeof *values);
    int32_t *integers = shv_allocate(memory, SHV_PART_RECORD, 3 * count, sizeof *integers);
    uint8_t *alive = shv_allocate(memory, SHV_PART_RECORD, count, 1);
    ShvFragmentView *fragments = shv_allocate(memory, SHV_PART_RECORD, count, sizeof *fragments);
    ShvStatus status = SHV_OK;
    if (values && integers && alive && fragments) {
        Points points = {values,
                         values + 3 * count,
                         values + 7 * count,
                         values + 10 * count,
                         values + 13 * count,
                         integers,
                         integers + count,
                         integers + 2 * count,
                         alive,
                         fragments};
        status = put_frames(xdmf, &points, error);
    } else {
        status = shv_fail_memory(error, "a frame", count * (14 * 8 + 12 + 1 + sizeof *fragments));
    }
    shv_release(values);
    shv_release(integers);
    shv_release(alive);
    shv_release(fragments);
    return status;
}
