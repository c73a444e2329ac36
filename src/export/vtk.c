/* VTK: an unstructured grid a frame, of the tets and of the obstacles, and a collection that tells their times. */
#include <math.h>
#include <string.h>

#include "base/disjoint_sets.h"
#include "base/memory.h"
#include "base/text.h"
#include "export/obstacle_mesh.h"
#include "export/output.h"
#include "export/tet_stress.h"
#include "export/vertices.h"

enum { TET = 10, TRIANGLE = 5 };

/* Raw numbers behind the XML. Cells that hang together share points, so that filters see them do so, and only surfaces are drawn. */
typedef struct Grid {
    FILE *stream;
    int64_t cells, point_count;
    int corners;             /* of a cell */
    uint64_t offset;         /* of the next array behind the XML */
    const float *points;     /* 3 × point_count */
    const int32_t *vertices; /* corners × cells */
} Grid;

typedef struct Vtk {
    ShvRunFile *file;
    const ShvRunFileInfo *info;
    ShvExportOptions options;
    ShvLines lines;
    ShvObstacleMesh *obstacles;
    ShvObstacleView *views;
    double *corners, *damage; /* 12 and 4 × tets; NULL: the run has no nodes */
    double *velocity;
    float *points, *velocities, *damages, *stresses; /* of the cells there are at a frame */
    int32_t *piece, *line, *object, *vertices;
    int32_t *carrier, *parent, *number; /* tets: who lives and moves them, −1: nobody; 4 × tets: of vertices */
    int64_t triangle_count;
    int64_t written; /* frames begun, those not taken among them */
} Vtk;

/* ---- raw arrays ---- */

static void put_bytes(FILE *stream, uint64_t value, int count)
{
    for (int i = 0; i < count; i++) putc((int)(value >> 8 * i & 255u), stream);
}

static void declare(Grid *grid, const char *name, const char *type, int components, int64_t count, int size)
{
    shv_print(grid->stream,
              "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%llu\"/>\n",
              type, name, components, (unsigned long long)grid->offset);
    grid->offset += 8 + (uint64_t)count * (uint64_t)components * (uint64_t)size;
}

static void put_floats(FILE *stream, const float *values, int64_t count)
{
    put_bytes(stream, 4 * (uint64_t)count, 8);
    for (int64_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        put_bytes(stream, bits, 4);
    }
}

static void put_ints(FILE *stream, const int32_t *values, int64_t count)
{
    put_bytes(stream, 4 * (uint64_t)count, 8);
    for (int64_t i = 0; i < count; i++) put_bytes(stream, (uint32_t)values[i], 4);
}

/* ---- a grid ---- */

static void begin_grid(Grid *grid)
{
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
          "header_type=\"UInt64\">\n<UnstructuredGrid>\n",
          grid->stream);
    shv_print(grid->stream, "<Piece NumberOfPoints=\"%lld\" NumberOfCells=\"%lld\">\n<Points>\n",
              (long long)grid->point_count, (long long)grid->cells);
    declare(grid, "Points", "Float32", 3, grid->point_count, 4);
    fputs("</Points>\n<Cells>\n", grid->stream);
    declare(grid, "connectivity", "Int32", 1, grid->corners * grid->cells, 4);
    declare(grid, "offsets", "Int64", 1, grid->cells, 8);
    declare(grid, "types", "UInt8", 1, grid->cells, 1);
    fputs("</Cells>\n<CellData>\n", grid->stream);
}

/* After what the cells carry has been declared: what was declared so far, and then the caller's arrays. */
static void put_cells(const Grid *grid)
{
    fputs("</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_", grid->stream);
    put_floats(grid->stream, grid->points, 3 * grid->point_count);
    put_ints(grid->stream, grid->vertices, grid->corners * grid->cells);
    put_bytes(grid->stream, 8 * (uint64_t)grid->cells, 8);
    for (int64_t i = 1; i <= grid->cells; i++) put_bytes(grid->stream, (uint64_t)(grid->corners * i), 8);
    put_bytes(grid->stream, (uint64_t)grid->cells, 8);
    for (int64_t i = 0; i < grid->cells; i++) putc(grid->corners == 4 ? TET : TRIANGLE, grid->stream);
}

static void end_grid(const Grid *grid)
{
    fputs("\n</AppendedData>\n</VTKFile>\n", grid->stream);
}

/* ---- tets of a frame ---- */

static void put_point(float *points, int64_t index, ShvVec3 point)
{
    const double x[3] = {point.x, point.y, point.z};
    for (int k = 0; k < 3; k++) points[3 * index + k] = (float)x[k];
}

/* The vertices of a tet, of which those that no tet before had are put at the end of the points. */
static void put_vertices(const Vtk *vtk, int32_t tet, Grid *grid)
{
    const ShvPieces *pieces = &vtk->lines.pieces;
    for (int32_t corner = 4 * tet; corner < 4 * tet + 4; corner++) {
        int32_t *number = &vtk->number[shv_set_root(vtk->parent, corner)];
        if (*number < 0) {
            *number = (int32_t)grid->point_count++;
            put_point(vtk->points, *number,
                      vtk->corners ? shv_load3(vtk->corners + 3 * (int64_t)corner)
                                   : shv_pieces_point(pieces, pieces->owner[tet], pieces->elements[corner]));
        }
        vtk->vertices[4 * grid->cells + corner - 4 * (int64_t)tet] = *number;
    }
}

static float stress_of(const Vtk *vtk, int64_t tet, int32_t object)
{
    const ShvPieces *pieces = &vtk->lines.pieces;
    double rest[12];
    for (int c = 0; c < 4; c++)
        shv_store3(rest + 3 * c, shv_load3(pieces->reference + 3 * (int64_t)pieces->elements[4 * tet + c]));
    return (float)shv_tet_stress(rest, vtk->corners + 12 * tet, vtk->options.elasticity[object]);
}

static bool has_stress(const Vtk *vtk)
{
    return vtk->corners && vtk->options.elasticity;
}

/* Who lives and moves each tet, and which corners are one point. */
static void find_vertices(const Vtk *vtk)
{
    for (int32_t tet = 0; tet < vtk->info->element_count; tet++) {
        const ShvPose pose = shv_lines_pose(&vtk->lines, shv_lines_of(&vtk->lines, tet));
        vtk->carrier[tet] = pose.lives ? pose.fragment : -1;
        for (int c = 0; c < 4; c++) vtk->number[4 * tet + c] = -1;
    }
    shv_vertices_join(&vtk->lines, vtk->carrier, vtk->corners, vtk->parent);
}

/* The cells that are there at the frame. */
static void gather(Vtk *vtk, Grid *grid)
{
    find_vertices(vtk);
    for (int32_t tet = 0; tet < vtk->info->element_count; tet++) {
        const int64_t kept = grid->cells;
        const int32_t piece = vtk->carrier[tet];
        if (piece < 0) continue;
        const ShvFragmentView *fragment = &vtk->lines.pieces.fragments[piece];
        put_vertices(vtk, tet, grid);
        vtk->piece[kept] = piece;
        vtk->line[kept] = vtk->lines.pieces.lineage[piece];
        vtk->object[kept] = fragment->object;
        for (int k = 0; k < 3; k++) vtk->velocities[3 * kept + k] = (float)vtk->velocity[3 * (int64_t)piece + k];
        const double *d = vtk->corners ? vtk->damage + 4 * (int64_t)tet : NULL;
        if (d) vtk->damages[kept] = (float)fmax(fmax(d[0], d[1]), fmax(d[2], d[3]));
        if (has_stress(vtk)) vtk->stresses[kept] = stress_of(vtk, tet, fragment->object);
        grid->cells++;
    }
}

static void put_tets(Vtk *vtk, FILE *stream)
{
    Grid grid = {.stream = stream, .corners = 4, .points = vtk->points, .vertices = vtk->vertices};
    gather(vtk, &grid);
    begin_grid(&grid);
    declare(&grid, "piece", "Int32", 1, grid.cells, 4);
    declare(&grid, "line", "Int32", 1, grid.cells, 4);
    declare(&grid, "object", "Int32", 1, grid.cells, 4);
    declare(&grid, "velocity", "Float32", 3, grid.cells, 4);
    if (vtk->corners) declare(&grid, "damage", "Float32", 1, grid.cells, 4);
    if (has_stress(vtk)) declare(&grid, "stress", "Float32", 1, grid.cells, 4);
    put_cells(&grid);
    put_ints(stream, vtk->piece, grid.cells);
    put_ints(stream, vtk->line, grid.cells);
    put_ints(stream, vtk->object, grid.cells);
    put_floats(stream, vtk->velocities, 3 * grid.cells);
    if (vtk->corners) put_floats(stream, vtk->damages, grid.cells);
    if (has_stress(vtk)) put_floats(stream, vtk->stresses, grid.cells);
    end_grid(&grid);
}

/* ---- obstacles of a frame ---- */

static void put_obstacles(Vtk *vtk, FILE *stream)
{
    Grid grid = {.stream = stream, .corners = 3, .points = vtk->points, .vertices = vtk->vertices};
    for (int32_t i = 0; i < vtk->info->obstacle_count; i++) {
        const ShvObstacleMesh *mesh = &vtk->obstacles[i];
        const double *q = vtk->views[i].orientation;
        const ShvVec3 position = shv_load3(vtk->views[i].position);
        const int32_t first = (int32_t)grid.point_count;
        for (int32_t n = 0; n < mesh->node_count; n++) {
            const ShvVec3 arm = shv_load3(mesh->positions + 3 * (int64_t)n);
            put_point(vtk->points, grid.point_count++,
                      shv_add(position, shv_rotate((ShvQuat){q[0], q[1], q[2], q[3]}, arm)));
        }
        for (int32_t k = 0; k < mesh->triangle_count; k++, grid.cells++) {
            for (int c = 0; c < 3; c++) vtk->vertices[3 * grid.cells + c] = first + mesh->triangles[3 * (int64_t)k + c];
            vtk->object[grid.cells] = i;
        }
    }
    begin_grid(&grid);
    declare(&grid, "obstacle", "Int32", 1, grid.cells, 4);
    put_cells(&grid);
    put_ints(stream, vtk->object, grid.cells);
    end_grid(&grid);
}

/* ---- files ---- */

static void name_file(char suffix[48], bool obstacles, int64_t frame)
{
    shv_format(suffix, 48, obstacles ? "_obstacles_%06lld.vtu" : "_%06lld.vtu", (long long)frame);
}

static ShvStatus write_one(Vtk *vtk, const char *prefix, bool obstacles, int64_t frame, ShvError *error)
{
    char suffix[48];
    ShvOutput output;
    name_file(suffix, obstacles, frame);
    SHV_TRY(shv_output_open(&output, &vtk->options, prefix, suffix, error));
    if (obstacles)
        put_obstacles(vtk, output.stream);
    else
        put_tets(vtk, output.stream);
    return shv_output_close(&output, &vtk->options, SHV_OK, error);
}

/* Frames whose collection will never be there. */
static void withdraw_frames(const Vtk *vtk, const char *prefix)
{
    for (int64_t frame = 0; frame < vtk->written; frame++)
        for (int part = 0; part < 2 && shv_output_takes(&vtk->options, vtk->file, frame); part++) {
            char suffix[48];
            name_file(suffix, part == 1, frame);
            shv_output_withdraw(prefix, suffix);
        }
}

static ShvStatus write_frames(Vtk *vtk, const char *prefix, ShvError *error)
{
    for (int64_t frame = 0; frame < vtk->info->frame_count; frame++) {
        if (!shv_output_takes(&vtk->options, vtk->file, frame)) continue;
        SHV_TRY(shv_lines_move(&vtk->lines, frame, error));
        SHV_TRY(shv_run_file_frame(vtk->file, frame, NULL, NULL, NULL, NULL, NULL, vtk->velocity, NULL, error));
        if (vtk->corners) SHV_TRY(shv_run_file_corners(vtk->file, frame, vtk->corners, vtk->damage, NULL, error));
        vtk->written = frame + 1;
        SHV_TRY(write_one(vtk, prefix, false, frame, error));
        if (vtk->triangle_count == 0) continue;
        SHV_TRY(shv_run_file_obstacles(vtk->file, frame, vtk->views, error));
        SHV_TRY(write_one(vtk, prefix, true, frame, error));
    }
    return SHV_OK;
}

static ShvStatus write_collection(const Vtk *vtk, const char *prefix, ShvError *error)
{
    const char *slash = strrchr(prefix, '/');
    char suffix[48];
    ShvOutput output;
    char *name = shv_output_escaped(&vtk->options, slash ? slash + 1 : prefix);
    if (!name) return shv_fail_memory(error, "a file name", strlen(prefix));
    ShvStatus status = shv_output_open(&output, &vtk->options, prefix, ".pvd", error);
    if (status == SHV_OK) {
        fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n", output.stream);
        for (int64_t frame = 0; frame < vtk->info->frame_count; frame++)
            for (int part = 0;
                 part < (vtk->triangle_count > 0 ? 2 : 1) && shv_output_takes(&vtk->options, vtk->file, frame);
                 part++) {
                name_file(suffix, part == 1, frame);
                shv_print(output.stream, "<DataSet timestep=\"%.17g\" part=\"%d\" file=\"%s%s\"/>\n",
                          shv_run_file_times(vtk->file)[frame], part, name, suffix);
            }
        fputs("</Collection>\n</VTKFile>\n", output.stream);
        status = shv_output_close(&output, &vtk->options, SHV_OK, error);
    }
    shv_release(name);
    return status;
}

static ShvStatus check_names(const Vtk *vtk, const char *prefix, ShvError *error)
{
    static const char *const collection[] = {".pvd"};
    SHV_TRY(shv_output_check(&vtk->options, prefix, collection, 1, error));
    for (int64_t frame = 0; frame < vtk->info->frame_count; frame++)
        for (int part = 0; part < 2; part++) {
            char suffix[48];
            const char *const suffixes[] = {suffix};
            name_file(suffix, part == 1, frame);
            SHV_TRY(shv_output_check(&vtk->options, prefix, suffixes, 1, error));
        }
    return SHV_OK;
}

static void *room(const Vtk *vtk, int64_t count, size_t size)
{
    return shv_allocate(vtk->options.memory, SHV_PART_RECORD, (size_t)count, size);
}

static ShvStatus prepare(Vtk *vtk, ShvError *error)
{
    const int64_t tets = vtk->info->element_count;
    int64_t nodes = 0; /* of obstacles */
    SHV_TRY(shv_obstacle_meshes_create(&vtk->obstacles, &vtk->lines.pieces, vtk->options.memory, error));
    for (int32_t i = 0; i < vtk->info->obstacle_count; i++) {
        vtk->triangle_count += vtk->obstacles[i].triangle_count;
        nodes += vtk->obstacles[i].node_count;
    }
    const int64_t cells = tets > vtk->triangle_count ? tets : vtk->triangle_count;
    if (cells > INT32_MAX / 4)
        return shv_fail(error, SHV_UNSUPPORTED, "more than %d tets cannot be exported", (int)(INT32_MAX / 4));
    vtk->views = room(vtk, vtk->info->obstacle_count, sizeof *vtk->views);
    vtk->velocity = room(vtk, 3 * (int64_t)vtk->info->fragment_count, sizeof(double));
    vtk->points = room(vtk, 3 * (4 * cells > nodes ? 4 * cells : nodes), sizeof(float));
    vtk->velocities = room(vtk, 3 * cells, sizeof(float));
    vtk->damages = room(vtk, cells, sizeof(float));
    vtk->stresses = room(vtk, cells, sizeof(float));
    vtk->piece = room(vtk, cells, sizeof(int32_t));
    vtk->line = room(vtk, cells, sizeof(int32_t));
    vtk->object = room(vtk, cells, sizeof(int32_t));
    vtk->vertices = room(vtk, 4 * cells, sizeof(int32_t));
    vtk->carrier = room(vtk, tets, sizeof(int32_t));
    vtk->parent = room(vtk, 4 * tets, sizeof(int32_t));
    vtk->number = room(vtk, 4 * tets, sizeof(int32_t));
    if (vtk->info->nodes) {
        vtk->corners = room(vtk, 12 * tets, sizeof(double));
        vtk->damage = room(vtk, 4 * tets, sizeof(double));
    }
    const bool good = vtk->views && vtk->velocity && vtk->points && vtk->velocities && vtk->damages && vtk->stresses &&
                      vtk->piece && vtk->line && vtk->object && vtk->vertices && vtk->carrier && vtk->parent &&
                      vtk->number && (!vtk->info->nodes || (vtk->corners && vtk->damage));
    return good ? SHV_OK : shv_fail_memory(error, "the mesh", 240 * (size_t)cells);
}

static void release(Vtk *vtk)
{
    shv_obstacle_meshes_release(vtk->obstacles, vtk->info->obstacle_count);
    shv_lines_release(&vtk->lines);
    shv_release(vtk->views);
    shv_release(vtk->velocity);
    shv_release(vtk->points);
    shv_release(vtk->velocities);
    shv_release(vtk->damages);
    shv_release(vtk->stresses);
    shv_release(vtk->piece);
    shv_release(vtk->line);
    shv_release(vtk->object);
    shv_release(vtk->vertices);
    shv_release(vtk->carrier);
    shv_release(vtk->parent);
    shv_release(vtk->number);
    shv_release(vtk->corners);
    shv_release(vtk->damage);
}

ShvStatus shv_export_vtk(ShvRunFile *file, const char *prefix, const ShvExportOptions *given, ShvError *error)
{
    Vtk vtk = {.file = file, .info = shv_run_file_info(file)};
    SHV_TRY(shv_export_options(given, &vtk.options, error));
    if (vtk.info->frame_count < 1) return shv_fail(error, SHV_BAD_INPUT, "the run has no frame to export");
    SHV_TRY(check_names(&vtk, prefix, error));
    SHV_TRY(shv_lines_create(&vtk.lines, file, vtk.options.memory, NULL, error));
    ShvStatus status = prepare(&vtk, error);
    if (status == SHV_OK) status = write_frames(&vtk, prefix, error);
    /* The collection last: where it is, all it names is. */
    if (status == SHV_OK) status = write_collection(&vtk, prefix, error);
    if (status != SHV_OK) withdraw_frames(&vtk, prefix);
    release(&vtk);
    return status;
}
