/* Shapes of obstacles: one row each, and the nodes and triangles of all meshes in two lists. */
#include <string.h>

#include "record/hdf5_array.h"
#include "record/hdf5_text.h"
#include "record/record.h"
#include "record/run_file.h"
#include "record/types.h"

/* ---- writing ---- */

typedef struct Lists {
    ShvObstacleRow *rows;
    double *nodes;
    int32_t *triangles;
    int32_t node_count, triangle_count;
} Lists;

static ShvObstacleRow row_of(const ShvObstacleBody *body, const Lists *lists)
{
    ShvObstacleRow row = {.shape = body->shape,
                          .motion = body->motion,
                          .offset = body->offset,
                          .radius = body->radius,
                          .mass = body->mass,
                          .friction = body->friction,
                          .restitution = body->restitution,
                          .nodes = {lists->node_count, lists->node_count + body->node_count},
                          .triangles = {lists->triangle_count, lists->triangle_count + body->triangle_count}};
    memcpy(row.normal, body->normal, sizeof row.normal);
    memcpy(row.size, body->size, sizeof row.size);
    return row;
}

/* Triangles name the nodes of the list. */
static void add_body(Lists *lists, int32_t index, const ShvObstacleBody *body)
{
    lists->rows[index] = row_of(body, lists);
    const int64_t node = lists->node_count, triangle = lists->triangle_count;
    if (body->node_count > 0)
        memcpy(lists->nodes + 3 * node, body->positions, 3 * (size_t)body->node_count * sizeof(double));
    for (int64_t i = 0; i < 3 * (int64_t)body->triangle_count; i++)
        lists->triangles[3 * triangle + i] = body->triangles[i] + (int32_t)node;
    lists->node_count += body->node_count;
    lists->triangle_count += body->triangle_count;
}

static bool put_rows(hid_t file, const Lists *lists, int32_t count)
{
    const hid_t type = shv_row_file_type(SHV_ROW_OBSTACLE);
    unsigned char *packed =
        type >= 0 ? shv_allocate(NULL, SHV_PART_RECORD, (size_t)count + 1, H5Tget_size(type)) : NULL;
    if (packed) shv_row_pack(SHV_ROW_OBSTACLE, lists->rows, (size_t)count, packed);
    const bool good = packed && shv_array_put(file, "/obstacles/list", type, type, count, 0, false, packed, NULL);
    shv_release(packed);
    if (type >= 0) H5Tclose(type);
    return good;
}

static bool put_lists(hid_t file, const ShvSimulation *simulation, Lists *lists, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        const ShvObstacleBody body = shv_simulation_obstacle(simulation, i);
        add_body(lists, i, &body);
    }
    return put_rows(file, lists, count) &&
           shv_array_put(file, "/obstacles/nodes", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, lists->node_count, 3, true,
                         lists->nodes, NULL) &&
           shv_array_put(file, "/obstacles/triangles", H5T_STD_I32LE, H5T_NATIVE_INT32, lists->triangle_count, 3, true,
                         lists->triangles, NULL);
}

bool shv_record_write_obstacles(hid_t file, const ShvSimulation *simulation, int32_t count)
{
    size_t nodes = 0, triangles = 0;
    for (int32_t i = 0; i < count; i++) {
        const ShvObstacleBody body = shv_simulation_obstacle(simulation, i);
        nodes += (size_t)body.node_count;
        triangles += (size_t)body.triangle_count;
    }
    Lists lists = {shv_allocate(NULL, SHV_PART_RECORD, (size_t)count, sizeof(ShvObstacleRow)),
                   shv_allocate(NULL, SHV_PART_RECORD, 3 * nodes, sizeof(double)),
                   shv_allocate(NULL, SHV_PART_RECORD, 3 * triangles, sizeof(int32_t)), 0, 0};
    const bool good = lists.rows && lists.nodes && lists.triangles && put_lists(file, simulation, &lists, count);
    shv_release(lists.rows);
    shv_release(lists.nodes);
    shv_release(lists.triangles);
    return good;
}

/* ---- reading ---- */

struct ShvObstacleBodies {
    ShvObstacleRow *rows;
    double *nodes;
    int32_t *triangles;
};

static ShvStatus read_rows(ShvRunFile *file, ShvObstacleRow *rows, ShvError *error)
{
    const hid_t dataset = H5Dopen2(file->file, "/obstacles/list", H5P_DEFAULT);
    const hid_t wanted = shv_row_file_type(SHV_ROW_OBSTACLE), type = shv_row_memory_type(SHV_ROW_OBSTACLE);
    const hid_t found = dataset >= 0 ? H5Dget_type(dataset) : -1, space = dataset >= 0 ? H5Dget_space(dataset) : -1;
    const int32_t count = file->info.obstacle_count;
    bool good = found >= 0 && space >= 0 && wanted >= 0 && type >= 0 && H5Tequal(found, wanted) > 0 &&
                H5Sget_simple_extent_npoints(space) == count;
    if (good && count > 0)
        good = shv_filters_agree(dataset, false) && shv_chunks_sound(dataset, 0, count) &&
               H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows) >= 0;
    if (space >= 0) H5Sclose(space);
    if (found >= 0) H5Tclose(found);
    if (type >= 0) H5Tclose(type);
    if (wanted >= 0) H5Tclose(wanted);
    if (dataset >= 0) H5Dclose(dataset);
    return good ? SHV_OK : shv_run_fail_damaged(file, "/obstacles/list", error);
}

static bool row_fits(const ShvObstacleRow *row, const int32_t *nodes, const int32_t *triangles)
{
    return row->nodes[0] == *nodes && row->nodes[1] >= row->nodes[0] && row->triangles[0] == *triangles &&
           row->triangles[1] >= row->triangles[0];
}

/* The ranges of the rows follow each other, and every triangle names nodes of its own row. */
static ShvStatus read_lists(ShvRunFile *file, ShvObstacleBodies *bodies, ShvError *error)
{
    int32_t nodes = 0, triangles = 0;
    for (int32_t i = 0; i < file->info.obstacle_count; i++) {
        if (!row_fits(&bodies->rows[i], &nodes, &triangles))
            return shv_run_fail_damaged(file, "/obstacles/list", error);
        nodes = bodies->rows[i].nodes[1];
        triangles = bodies->rows[i].triangles[1];
    }
    SHV_TRY(shv_run_check_rows(file, "/obstacles/nodes", true, nodes, error));
    SHV_TRY(shv_run_check_rows(file, "/obstacles/triangles", false, triangles, error));
    bodies->nodes = shv_allocate(file->memory, SHV_PART_RECORD, 3 * (size_t)nodes, sizeof(double));
    bodies->triangles = shv_allocate(file->memory, SHV_PART_RECORD, 3 * (size_t)triangles, sizeof(int32_t));
    if (!bodies->nodes || !bodies->triangles) return shv_fail_memory(error, "obstacles", 24 * (size_t)nodes);
    SHV_TRY(shv_run_read_array(file, "/obstacles/nodes", nodes, 3, true, bodies->nodes, error));
    SHV_TRY(shv_run_read_array(file, "/obstacles/triangles", triangles, 3, false, bodies->triangles, error));
    for (int32_t i = 0; i < file->info.obstacle_count; i++) {
        const ShvObstacleRow *row = &bodies->rows[i];
        for (int64_t k = 3 * (int64_t)row->triangles[0]; k < 3 * (int64_t)row->triangles[1]; k++) {
            if (bodies->triangles[k] < row->nodes[0] || bodies->triangles[k] >= row->nodes[1])
                return shv_run_fail_damaged(file, "/obstacles/triangles", error);
            bodies->triangles[k] -= row->nodes[0];
        }
    }
    return SHV_OK;
}

void shv_obstacle_bodies_release(ShvObstacleBodies *bodies)
{
    if (!bodies) return;
    shv_release(bodies->rows);
    shv_release(bodies->nodes);
    shv_release(bodies->triangles);
    shv_release(bodies);
}

static ShvStatus load(ShvRunFile *file, ShvError *error)
{
    const size_t count = (size_t)file->info.obstacle_count;
    ShvObstacleBodies *bodies = shv_allocate(file->memory, SHV_PART_RECORD, 1, sizeof *bodies);
    if (!bodies) return shv_fail_memory(error, "obstacles", sizeof *bodies);
    bodies->rows = shv_allocate(file->memory, SHV_PART_RECORD, count, sizeof *bodies->rows);
    const ShvSilence silence = shv_silence_begin();
    ShvStatus status = bodies->rows ? read_rows(file, bodies->rows, error)
                                    : shv_fail_memory(error, "obstacles", count * sizeof *bodies->rows);
    if (status == SHV_OK) status = read_lists(file, bodies, error);
    shv_silence_end(silence);
    if (status == SHV_OK)
        file->bodies = bodies;
    else
        shv_obstacle_bodies_release(bodies);
    return status;
}

ShvStatus shv_run_file_obstacle(ShvRunFile *file, int32_t index, ShvObstacleBody *body, ShvError *error)
{
    if (index < 0 || index >= file->info.obstacle_count)
        return shv_fail(error, SHV_BAD_INPUT, "'%s' has %d obstacles and no obstacle %d", file->path,
                        (int)file->info.obstacle_count, (int)index);
    if (!file->bodies) SHV_TRY(load(file, error));
    SHV_TRY(shv_run_obstacle_names(file, error));
    const ShvObstacleRow *row = &file->bodies->rows[index];
    *body = (ShvObstacleBody){.name = file->obstacle_names + (size_t)index * file->obstacle_name_size,
                              .shape = row->shape,
                              .motion = row->motion,
                              .offset = row->offset,
                              .radius = row->radius,
                              .mass = row->mass,
                              .friction = row->friction,
                              .restitution = row->restitution,
                              .positions = file->bodies->nodes + 3 * (int64_t)row->nodes[0],
                              .triangles = file->bodies->triangles + 3 * (int64_t)row->triangles[0],
                              .node_count = row->nodes[1] - row->nodes[0],
                              .triangle_count = row->triangles[1] - row->triangles[0]};
    memcpy(body->normal, row->normal, sizeof body->normal);
    memcpy(body->size, row->size, sizeof body->size);
    return SHV_OK;
}
