/* TetGen's .node and .ele files. Both begin with a line of counts; comments start with '#'; numbering starts at 0 or 1
   in both. */
#include <string.h>

#include "mesh/draft.h"
#include "mesh/generate.h"

/* "name", "name.node" and "name.ele" all mean the pair. */
static char *path_with(ShvMemory *memory, const char *path, const char *extension)
{
    size_t stem = strlen(path);
    if (stem > 5 && strcmp(path + stem - 5, ".node") == 0)
        stem -= 5;
    else if (stem > 4 && strcmp(path + stem - 4, ".ele") == 0)
        stem -= 4;
    const size_t size = stem + strlen(extension) + 1;
    char *made = shv_allocate(memory, SHV_PART_GENERAL, size, 1);
    if (!made) return NULL;
    memcpy(made, path, stem);
    memcpy(made + stem, extension, strlen(extension));
    return made;
}

static ShvStatus next_record(ShvScan *scan, const char *what, int64_t read, int64_t announced, ShvError *error)
{
    if (shv_scan_record(scan)) return SHV_OK;
    return shv_scan_fail(scan, error, "the file ends after %lld of %lld %s", (long long)read, (long long)announced,
                         what);
}

static ShvStatus refuse_more(ShvScan *scan, int64_t announced, const char *what, ShvError *error)
{
    if (!shv_scan_record(scan)) return SHV_OK;
    return shv_scan_fail(scan, error, "the file goes on after its %lld %s; correct the count in its first line",
                         (long long)announced, what);
}

/* Lines "index x y z"; what follows on a line (attributes, a boundary marker) is ignored. */
static ShvStatus read_nodes(ShvScan *scan, ShvDraft *draft, ShvError *error)
{
    int64_t count, dimension, first = 0;
    SHV_TRY(next_record(scan, "nodes", 0, 0, error));
    SHV_TRY(shv_scan_whole(scan, "the number of nodes", 1, INT32_MAX, &count, error));
    SHV_TRY(shv_scan_whole(scan, "the dimension", 3, 3, &dimension, error));
    SHV_TRY(shv_scan_check_count(scan, count, 7, "nodes", error));
    for (int64_t i = 0; i < count; i++) {
        int64_t tag;
        double x[3];
        SHV_TRY(next_record(scan, "nodes", i, count, error));
        SHV_TRY(shv_scan_whole(scan, "the index of a node", 0, INT32_MAX, &tag, error));
        if (i == 0) first = tag;
        if (first > 1 || tag != first + i)
            return shv_scan_fail(scan, error,
                                 "node %lld stands where %lld was expected; nodes are numbered "
                                 "consecutively from 0 or 1",
                                 (long long)tag, (long long)(i == 0 ? 1 : first + i));
        for (int k = 0; k < 3; k++) SHV_TRY(shv_scan_number(scan, "a coordinate", &x[k], error));
        SHV_TRY(shv_draft_add_node(draft, tag, shv_load3(x), error));
    }
    return refuse_more(scan, count, "nodes", error);
}

/* Lines "index a b c d"; attributes are ignored. */
static ShvStatus read_tets(ShvScan *scan, ShvDraft *draft, ShvError *error)
{
    int64_t count, corners;
    SHV_TRY(next_record(scan, "tets", 0, 0, error));
    SHV_TRY(shv_scan_whole(scan, "the number of tets", 1, INT32_MAX, &count, error));
    SHV_TRY(shv_scan_whole(scan, "the number of nodes a tet", 4, 10, &corners, error));
    if (corners != 4)
        return shv_scan_fail(scan, error, "tets of %lld nodes are not supported; run tetgen without -o2",
                             (long long)corners);
    SHV_TRY(shv_scan_check_count(scan, count, 9, "tets", error));
    for (int64_t i = 0; i < count; i++) {
        ShvDraftTet tet;
        SHV_TRY(next_record(scan, "tets", i, count, error));
        tet.place = scan->line;
        SHV_TRY(shv_scan_whole(scan, "the index of a tet", 0, INT32_MAX, &tet.tag, error));
        for (int k = 0; k < 4; k++)
            SHV_TRY(shv_scan_whole(scan, "the index of a node", 0, INT32_MAX, &tet.nodes[k], error));
        SHV_TRY(shv_draft_add_tet(draft, &tet, error));
    }
    return refuse_more(scan, count, "tets", error);
}

static ShvStatus read_file(ShvDraft *draft, const char *path, ShvStatus (*read)(ShvScan *, ShvDraft *, ShvError *),
                           ShvError *error)
{
    ShvScan scan;
    SHV_TRY(shv_scan_open(&scan, draft->memory, path, error));
    scan.comment = '#';
    const ShvStatus status = read(&scan, draft, error);
    shv_scan_close(&scan);
    return status;
}

ShvStatus shv_mesh_read_tetgen(ShvMesh *mesh, ShvMemory *memory, const char *path, ShvError *error)
{
    *mesh = (ShvMesh){0};
    char *node_path = path_with(memory, path, ".node"), *tet_path = path_with(memory, path, ".ele");
    ShvDraft draft = {.memory = memory, .path = tet_path};
    ShvStatus status = SHV_OK;
    if (!node_path || !tet_path) status = shv_fail_memory(error, "a file name", strlen(path) + 6);
    if (status == SHV_OK) status = read_file(&draft, node_path, read_nodes, error);
    if (status == SHV_OK) status = read_file(&draft, tet_path, read_tets, error);
    if (status == SHV_OK) status = shv_draft_finish(&draft, mesh, error);
    shv_draft_release(&draft);
    shv_release(node_path);
    shv_release(tet_path);
    return status;
}
