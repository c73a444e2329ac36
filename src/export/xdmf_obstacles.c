/* Obstacles as triangles. */
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/obstacle_mesh.h"
#include "export/xdmf.h"

typedef struct Surfaces {
    ShvObstacleMesh *meshes;
    ShvObstacleView *views;
    int32_t *cells, *obstacle; /* 3 and 1 × cell_count */
    double *points, *last;     /* 3 × point_count: of this frame, of the last data set */
    int64_t cell_count, point_count;
} Surfaces;

static ShvStatus put_cells(const ShvXdmf *xdmf, Surfaces *surfaces, ShvError *error)
{
    int64_t cell = 0;
    int32_t first = 0;
    for (int32_t i = 0; i < xdmf->info->obstacle_count; i++) {
        const ShvObstacleMesh *mesh = &surfaces->meshes[i];
        for (int32_t t = 0; t < mesh->triangle_count; t++, cell++) {
            for (int k = 0; k < 3; k++) surfaces->cells[3 * cell + k] = first + mesh->triangles[3 * (int64_t)t + k];
            surfaces->obstacle[cell] = i;
        }
        first += mesh->node_count;
    }
    SHV_TRY(shv_xdmf_put(xdmf, "/obstacles/cells", SHV_XDMF_INT, surfaces->cell_count, 3, surfaces->cells, error));
    return shv_xdmf_put(xdmf, "/obstacles/obstacle", SHV_XDMF_INT, surfaces->cell_count, 0, surfaces->obstacle, error);
}

static void move(const ShvXdmf *xdmf, const Surfaces *surfaces)
{
    int64_t point = 0;
    for (int32_t i = 0; i < xdmf->info->obstacle_count; i++) {
        const double *q = surfaces->views[i].orientation;
        for (int32_t n = 0; n < surfaces->meshes[i].node_count; n++, point++)
            shv_store3(surfaces->points + 3 * point,
                       shv_add(shv_load3(surfaces->views[i].position),
                               shv_rotate((ShvQuat){q[0], q[1], q[2], q[3]},
                                          shv_load3(surfaces->meshes[i].positions + 3 * (int64_t)n))));
    }
}

/* Points that have not moved since the last data set are not written again. */
static ShvStatus put_frame(const ShvXdmf *xdmf, const Surfaces *surfaces, int64_t frame, int64_t *written,
                           ShvError *error)
{
    const size_t bytes = 3 * (size_t)surfaces->point_count * sizeof(double);
    char path[96];
    SHV_TRY(shv_run_file_obstacles(xdmf->file, frame, surfaces->views, error));
    move(xdmf, surfaces);
    const bool same = *written >= 0 && memcmp(surfaces->points, surfaces->last, bytes) == 0;
    if (!same) *written = frame;
    shv_format(path, sizeof path, "/obstacles/points_%06lld", (long long)*written);
    if (!same) {
        SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_SINGLE, surfaces->point_count, 3, surfaces->points, error));
        memcpy(surfaces->last, surfaces->points, bytes);
    }
    shv_print(xdmf->stream,
              "      <Grid Name=\"obstacles\" GridType=\"Uniform\">\n        <Time Value=\"%.17g\"/>\n"
              "        <Topology TopologyType=\"Triangle\" NumberOfElements=\"%lld\">",
              shv_run_file_times(xdmf->file)[frame], (long long)surfaces->cell_count);
    shv_xdmf_item(xdmf, "/obstacles/cells", SHV_XDMF_INT, surfaces->cell_count, 3);
    shv_print(xdmf->stream, "</Topology>\n        <Geometry GeometryType=\"XYZ\">");
    shv_xdmf_item(xdmf, path, SHV_XDMF_SINGLE, surfaces->point_count, 3);
    shv_print(xdmf->stream, "</Geometry>\n");
    shv_xdmf_attribute(xdmf, "obstacle", "Scalar", "Cell", "/obstacles/obstacle", SHV_XDMF_INT, surfaces->cell_count,
                       0);
    shv_print(xdmf->stream, "      </Grid>\n");
    return SHV_OK;
}

static ShvStatus put_all(const ShvXdmf *xdmf, Surfaces *surfaces, const ShvPieces *pieces, ShvError *error)
{
    struct ShvMemory *memory = xdmf->options.memory;
    const int32_t count = xdmf->info->obstacle_count;
    SHV_TRY(shv_obstacle_meshes_create(&surfaces->meshes, pieces, memory, error));
    for (int32_t i = 0; i < count; i++) {
        surfaces->cell_count += surfaces->meshes[i].triangle_count;
        surfaces->point_count += surfaces->meshes[i].node_count;
    }
    const size_t cells = (size_t)surfaces->cell_count, numbers = 3 * (size_t)surfaces->point_count;
    surfaces->views = shv_allocate(memory, SHV_PART_RECORD, (size_t)count, sizeof *surfaces->views);
    surfaces->cells = shv_allocate(memory, SHV_PART_RECORD, 3 * cells, sizeof(int32_t));
    surfaces->obstacle = shv_allocate(memory, SHV_PART_RECORD, cells, sizeof(int32_t));
    surfaces->points = shv_allocate(memory, SHV_PART_RECORD, numbers, sizeof(double));
    surfaces->last = shv_allocate(memory, SHV_PART_RECORD, numbers, sizeof(double));
    if (!surfaces->views || !surfaces->cells || !surfaces->obstacle || !surfaces->points || !surfaces->last)
        return shv_fail_memory(error, "obstacles", 16 * (cells + numbers));
    SHV_TRY(put_cells(xdmf, surfaces, error));
    int64_t written = -1;
    for (int64_t frame = 0; frame < xdmf->info->frame_count; frame++)
        if (shv_output_takes(&xdmf->options, xdmf->file, frame))
            SHV_TRY(put_frame(xdmf, surfaces, frame, &written, error));
    return SHV_OK;
}

ShvStatus shv_xdmf_obstacles(const ShvXdmf *xdmf, ShvError *error)
{
    Surfaces surfaces = {.meshes = NULL};
    ShvPieces pieces;
    SHV_TRY(shv_pieces_create(&pieces, xdmf->file, xdmf->options.memory, error));
    const ShvStatus status = put_all(xdmf, &surfaces, &pieces, error);
    shv_obstacle_meshes_release(surfaces.meshes, xdmf->info->obstacle_count);
    shv_pieces_release(&pieces);
    shv_release(surfaces.views);
    shv_release(surfaces.cells);
    shv_release(surfaces.obstacle);
    shv_release(surfaces.points);
    shv_release(surfaces.last);
    return status;
}
