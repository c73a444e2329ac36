/* The tets: moved rigidly with their fragments, or as the nodes were recorded. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/pieces.h"
#include "export/xdmf.h"

/* The finest division of the mesh serves all frames: a point for every node of every last owner. */
typedef struct Rigid {
    ShvPieces pieces;
    int64_t *keys; /* last owner and node of every point, increasing */
    int64_t point_count;
    double *points;                    /* 3 × point_count */
    int32_t *element_fragment, *shown; /* owners now, and in the last data set */
} Rigid;

static int64_t key_of(int32_t owner, int32_t node)
{
    return ((int64_t)owner << 32) | node;
}

static int by_key(const void *a, const void *b)
{
    const int64_t left = *(const int64_t *)a, right = *(const int64_t *)b;
    return (left > right) - (left < right);
}

/* Sorted, each once; returns their number. */
static int64_t make_keys(const ShvXdmf *xdmf, Rigid *rigid)
{
    const int64_t corners = 4 * (int64_t)xdmf->info->element_count;
    int64_t kept = 0;
    for (int64_t i = 0; i < corners; i++)
        rigid->keys[i] = key_of(rigid->pieces.owner[i / 4], rigid->pieces.elements[i]);
    qsort(rigid->keys, (size_t)corners, sizeof *rigid->keys, by_key);
    for (int64_t i = 0; i < corners; i++)
        if (i == 0 || rigid->keys[i] != rigid->keys[i - 1]) rigid->keys[kept++] = rigid->keys[i];
    return kept;
}

static ShvStatus put_cells(const ShvXdmf *xdmf, Rigid *rigid, ShvError *error)
{
    for (int64_t i = 0; i < 4 * (int64_t)xdmf->info->element_count; i++) {
        const int64_t key = key_of(rigid->pieces.owner[i / 4], rigid->pieces.elements[i]);
        const int64_t *found = bsearch(&key, rigid->keys, (size_t)rigid->point_count, sizeof key, by_key);
        rigid->pieces.elements[i] = (int32_t)(found - rigid->keys);
    }
    return shv_xdmf_put(xdmf, "/mesh/cells", SHV_XDMF_INT, xdmf->info->element_count, 4, rigid->pieces.elements, error);
}

static void move_points(const Rigid *rigid)
{
    for (int64_t i = 0; i < rigid->point_count; i++)
        shv_store3(rigid->points + 3 * i, shv_pieces_point(&rigid->pieces, (int32_t)(rigid->keys[i] >> 32),
                                                           (int32_t)(rigid->keys[i] & INT32_MAX)));
}

/* ---- XML of a frame ---- */

static void begin_grid(const ShvXdmf *xdmf, int64_t frame)
{
    shv_print(xdmf->stream, "      <Grid Name=\"mesh\" GridType=\"Uniform\">\n        <Time Value=\"%.17g\"/>\n",
              shv_run_file_times(xdmf->file)[frame]);
    shv_print(xdmf->stream, "        <Topology TopologyType=\"Tetrahedron\" NumberOfElements=\"%d\">",
              (int)xdmf->info->element_count);
    shv_xdmf_item(xdmf, "/mesh/cells", SHV_XDMF_INT, xdmf->info->element_count, 4);
    shv_print(xdmf->stream, "</Topology>\n");
}

/* Single precision: what is drawn needs no more, and these are the largest arrays. */
static ShvStatus put_points(const ShvXdmf *xdmf, int64_t frame, int64_t count, const double *points, ShvError *error)
{
    char path[96];
    shv_format(path, sizeof path, "/mesh/points_%06lld", (long long)frame);
    SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_SINGLE, count, 3, points, error));
    shv_print(xdmf->stream, "        <Geometry GeometryType=\"XYZ\">");
    shv_xdmf_item(xdmf, path, SHV_XDMF_SINGLE, count, 3);
    shv_print(xdmf->stream, "</Geometry>\n");
    return SHV_OK;
}

/* ---- rigid ---- */

/* The lines of the owners, which take the owners' place; NULL: those of that frame are there already. */
static ShvStatus put_lines(const ShvXdmf *xdmf, int64_t frame, int32_t *owner, ShvError *error)
{
    const int32_t count = xdmf->info->element_count;
    char path[96];
    shv_format(path, sizeof path, "/mesh/line_%06lld", (long long)frame);
    for (int32_t e = 0; owner && e < count; e++)
        owner[e] = owner[e] >= 0 && owner[e] < xdmf->info->fragment_count ? xdmf->lineage[owner[e]] : -1;
    if (owner) SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_INT, count, 0, owner, error));
    shv_xdmf_attribute(xdmf, "line", "Scalar", "Cell", path, SHV_XDMF_INT, count, 0);
    return SHV_OK;
}

/* A data set of owners serves all frames until it changes. */
static ShvStatus put_owners(const ShvXdmf *xdmf, const Rigid *rigid, int64_t frame, int64_t *written, ShvError *error)
{
    const int32_t count = xdmf->info->element_count;
    char path[96];
    for (int32_t e = 0; e < count; e++) rigid->element_fragment[e] = rigid->pieces.carrier[rigid->pieces.owner[e]];
    const bool same =
        *written >= 0 && memcmp(rigid->shown, rigid->element_fragment, (size_t)count * sizeof(int32_t)) == 0;
    if (!same) *written = frame;
    shv_format(path, sizeof path, "/mesh/fragment_%06lld", (long long)*written);
    if (!same) {
        SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_INT, count, 0, rigid->element_fragment, error));
        memcpy(rigid->shown, rigid->element_fragment, (size_t)count * sizeof(int32_t));
    }
    shv_xdmf_attribute(xdmf, "fragment", "Scalar", "Cell", path, SHV_XDMF_INT, count, 0);
    return put_lines(xdmf, *written, same ? NULL : rigid->element_fragment, error);
}

static ShvStatus put_rigid_frames(const ShvXdmf *xdmf, Rigid *rigid, ShvError *error)
{
    int64_t written = -1;
    for (int64_t frame = 0; frame < xdmf->info->frame_count; frame++) {
        if (!shv_output_takes(&xdmf->options, xdmf->file, frame)) continue;
        SHV_TRY(shv_pieces_move(&rigid->pieces, frame, error));
        move_points(rigid);
        begin_grid(xdmf, frame);
        SHV_TRY(put_points(xdmf, frame, rigid->point_count, rigid->points, error));
        SHV_TRY(put_owners(xdmf, rigid, frame, &written, error));
        shv_print(xdmf->stream, "      </Grid>\n");
    }
    return SHV_OK;
}

static ShvStatus put_rigid(const ShvXdmf *xdmf, Rigid *rigid, ShvError *error)
{
    struct ShvMemory *memory = xdmf->options.memory;
    const size_t elements = (size_t)xdmf->info->element_count;
    rigid->keys = shv_allocate(memory, SHV_PART_RECORD, 4 * elements, sizeof(int64_t));
    rigid->element_fragment = shv_allocate(memory, SHV_PART_RECORD, elements, sizeof(int32_t));
    rigid->shown = shv_allocate(memory, SHV_PART_RECORD, elements, sizeof(int32_t));
    if (!rigid->keys || !rigid->element_fragment || !rigid->shown)
        return shv_fail_memory(error, "the mesh", 40 * elements);
    rigid->point_count = make_keys(xdmf, rigid);
    rigid->points = shv_allocate(memory, SHV_PART_RECORD, 3 * (size_t)rigid->point_count, sizeof(double));
    if (!rigid->points) return shv_fail_memory(error, "points", 24 * (size_t)rigid->point_count);
    SHV_TRY(put_cells(xdmf, rigid, error));
    return put_rigid_frames(xdmf, rigid, error);
}

ShvStatus shv_xdmf_mesh(const ShvXdmf *xdmf, ShvError *error)
{
    Rigid rigid = {.keys = NULL};
    SHV_TRY(shv_pieces_create(&rigid.pieces, xdmf->file, xdmf->options.memory, error));
    const ShvStatus status = put_rigid(xdmf, &rigid, error);
    shv_pieces_release(&rigid.pieces);
    shv_release(rigid.keys);
    shv_release(rigid.points);
    shv_release(rigid.element_fragment);
    shv_release(rigid.shown);
    return status;
}

/* ---- as recorded ---- */

typedef struct Deformed {
    int32_t *cells, *fragment;
    double *corners, *damage;
} Deformed;

static ShvStatus put_deformed_frame(const ShvXdmf *xdmf, const Deformed *mesh, int64_t frame, ShvError *error)
{
    const int64_t count = xdmf->info->element_count;
    char path[96];
    SHV_TRY(shv_run_file_corners(xdmf->file, frame, mesh->corners, mesh->damage, mesh->fragment, error));
    for (int64_t e = 0; e < count; e++) {
        const double *facets = mesh->damage + 4 * e;
        mesh->damage[e] = fmax(fmax(facets[0], facets[1]), fmax(facets[2], facets[3]));
    }
    begin_grid(xdmf, frame);
    SHV_TRY(put_points(xdmf, frame, 4 * count, mesh->corners, error));
    shv_format(path, sizeof path, "/mesh/damage_%06lld", (long long)frame);
    SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_SINGLE, count, 0, mesh->damage, error));
    shv_xdmf_attribute(xdmf, "damage", "Scalar", "Cell", path, SHV_XDMF_SINGLE, count, 0);
    shv_format(path, sizeof path, "/mesh/fragment_%06lld", (long long)frame);
    SHV_TRY(shv_xdmf_put(xdmf, path, SHV_XDMF_INT, count, 0, mesh->fragment, error));
    shv_xdmf_attribute(xdmf, "fragment", "Scalar", "Cell", path, SHV_XDMF_INT, count, 0);
    SHV_TRY(put_lines(xdmf, frame, mesh->fragment, error));
    shv_print(xdmf->stream, "      </Grid>\n");
    return SHV_OK;
}

static ShvStatus put_deformed(const ShvXdmf *xdmf, const Deformed *mesh, ShvError *error)
{
    const int64_t count = xdmf->info->element_count;
    for (int64_t i = 0; i < 4 * count; i++) mesh->cells[i] = (int32_t)i;
    SHV_TRY(shv_xdmf_put(xdmf, "/mesh/cells", SHV_XDMF_INT, count, 4, mesh->cells, error));
    for (int64_t frame = 0; frame < xdmf->info->frame_count; frame++)
        if (shv_output_takes(&xdmf->options, xdmf->file, frame)) SHV_TRY(put_deformed_frame(xdmf, mesh, frame, error));
    return SHV_OK;
}

ShvStatus shv_xdmf_deformed_mesh(const ShvXdmf *xdmf, ShvError *error)
{
    const size_t count = (size_t)xdmf->info->element_count;
    struct ShvMemory *memory = xdmf->options.memory;
    if (count > INT32_MAX / 4)
        return shv_fail(error, SHV_UNSUPPORTED, "more than %d tets have too many corners for this format",
                        INT32_MAX / 4);
    const Deformed mesh = {shv_allocate(memory, SHV_PART_RECORD, 4 * count, sizeof(int32_t)),
                           shv_allocate(memory, SHV_PART_RECORD, count, sizeof(int32_t)),
                           shv_allocate(memory, SHV_PART_RECORD, 12 * count, sizeof(double)),
                           shv_allocate(memory, SHV_PART_RECORD, 4 * count, sizeof(double))};
    const ShvStatus status = mesh.cells && mesh.fragment && mesh.corners && mesh.damage
                                 ? put_deformed(xdmf, &mesh, error)
                                 : shv_fail_memory(error, "the mesh", 150 * count);
    shv_release(mesh.cells);
    shv_release(mesh.fragment);
    shv_release(mesh.corners);
    shv_release(mesh.damage);
    return status;
}
