#include "check.h"

#include "files.h"
#include "mesh/generate.h"

/* Files written by TetGen 1.5: a block of 1 × 2 × 3, 26 nodes and 36 tets, numbered from 1 (with a region attribute)
   and from 0. */

/* A folder with both files. */
typedef struct Pair {
    char folder[256], node[320], ele[320];
} Pair;
static Pair pair;

static int make_pair(void **state)
{
    (void)state;
    const TemporaryFile file = temporary_file("a.node");
    snprintf(pair.folder, sizeof pair.folder, "%s", file.folder);
    snprintf(pair.node, sizeof pair.node, "%s/a.node", file.folder);
    snprintf(pair.ele, sizeof pair.ele, "%s/a.ele", file.folder);
    return 0;
}

static int remove_pair(void **state)
{
    (void)state;
    unlink(pair.node);
    unlink(pair.ele);
    return rmdir(pair.folder);
}

static ShvStatus read_once(ShvMemory *memory, const char *path, ShvError *error)
{
    ShvMesh mesh;
    const ShvStatus status = shv_mesh_read_tetgen(&mesh, memory, path, error);
    if (status != SHV_OK) {
        assert_null(mesh.positions);
        return status;
    }
    check_mesh_sound(&mesh);
    shv_mesh_release(&mesh);
    return SHV_OK;
}

static void reads_what_tetgen_writes(void **state)
{
    (void)state;
    static const char *const paths[] = {"data/block_one", "data/block_one.node", "data/block_zero.ele",
                                        "data/block_zero"};
    ShvError error;
    for (int i = 0; i < 4; i++) {
        ShvMesh mesh;
        check_ok(shv_mesh_read_tetgen(&mesh, NULL, paths[i], &error), error);
        assert_int_equal(mesh.node_count, 26);
        assert_int_equal(mesh.element_count, 36);
        check_ok(shv_mesh_validate(&mesh, paths[i], &error), error);
        check_near(mesh_volume(&mesh), 6.0, 1e-14 * 36.0);
        shv_mesh_release(&mesh);
    }
}

/* Where the last line of data starts: a number cut off there is still a number. */
static size_t last_data_line(Bytes bytes)
{
    const char *comment = strstr(bytes.data, "\n# Generated");
    assert_non_null(comment);
    do comment--;
    while (*comment != '\n');
    return (size_t)(comment - bytes.data);
}

/* Cuts and corrupts one file while the other stays whole. */
static void torture(const char *varied, const char *kept, const char *varied_path, const char *kept_path)
{
    const Bytes a = read_bytes(varied), b = read_bytes(kept);
    const size_t complete = last_data_line(a);
    write_bytes(kept_path, b.data, b.size);
    for (size_t trial = 0; trial < a.size + 1000; trial++) {
        ShvStatus status;
        ShvMemory *memory = shv_memory_create();
        const size_t size = trial < a.size ? trial : a.size;
        const uint64_t draw = shv_random_bits(trial, 0), at = (draw >> 8) % a.size;
        const char kept_byte = a.data[at];
        if (trial >= a.size) a.data[at] = (char)(draw >> 63 ? '0' + draw % 10 : draw);
        write_bytes(varied_path, a.data, size);
        a.data[at] = kept_byte;
        read_and_count(read_once, memory, varied_path, a.size + b.size, &status);
        if (size < complete) assert_int_equal(status, SHV_BAD_INPUT);
        shv_memory_destroy(memory);
    }
    shv_release(a.data);
    shv_release(b.data);
}

static void refuses_cut_off_and_corrupted_files(void **state)
{
    (void)state;
    torture("data/block_one.node", "data/block_one.ele", pair.node, pair.ele);
    torture("data/block_zero.ele", "data/block_zero.node", pair.ele, pair.node);
}

static void survives_failing_allocations(void **state)
{
    (void)state;
    check_allocation_failures(read_once, "data/block_one");
}

static void check_pair_fails(const char *nodes, const char *tets, const char *part)
{
    ShvError error = {0};
    write_bytes(pair.node, nodes, strlen(nodes));
    write_bytes(pair.ele, tets, strlen(tets));
    check_fails(read_once(NULL, pair.node, &error), SHV_BAD_INPUT, error, part);
}

#define NODES                                                                                                          \
    "# made by hand\r\n\r\n5 3 1 1\r\n0 0 0 0 7.5 1 # attribute, marker\r\n1 1 0 0 0 0\n2 0 1 0 0 0\n3 0 0 1 0 0\n4 "  \
    "9 9 9 0 0\n"
#define TETS "1 4 0\n0 0 1 2 3\n"

static void ignores_comments_attributes_and_unused_nodes(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    write_bytes(pair.node, NODES, strlen(NODES));
    write_bytes(pair.ele, TETS, strlen(TETS));
    check_ok(shv_mesh_read_tetgen(&mesh, NULL, pair.ele, &error), error);
    assert_int_equal(mesh.node_count, 4);
    check_near(mesh_volume(&mesh), 1.0 / 6.0, 1e-16);
    shv_mesh_release(&mesh);
}

static void names_what_is_wrong(void **state)
{
    (void)state;
    check_pair_fails("", TETS, "a.node:1: the file ends");
    check_pair_fails("4 2 0 0\n", TETS, "a.node:1: the dimension must lie between 3 and 3");
    check_pair_fails("2000000000 3 0 0\n1 0 0 0\n", TETS, "2000000000 nodes are announced");
    check_pair_fails("4 3 0 0\n1 0 0 0\n3 0 0 0\n4 0 0 0\n5 0 0 0\n", TETS, "a.node:3: node 3 stands where 2");
    check_pair_fails("1 3 0 0\n2 0 0 0\n", TETS, "a.node:2: node 2 stands where 1");
    check_pair_fails("1 3 0 0\n1 0 inf 0\n", TETS, "a.node:2: expected a coordinate, a finite number, not 'inf'");
    check_pair_fails("1 3 0 0\n1 0 0 0\n2 0 0 0\n", TETS, "a.node:3: the file goes on after its 1 nodes");
    check_pair_fails("2 3 0 0\n1 0 0 0 # nothing else\n", TETS, "the file ends after 1 of 2 nodes");
    check_pair_fails(NODES, "1 10 0\n0 0 1 2 3 4 5 6 7 8 9\n", "a.ele:1: tets of 10 nodes are not supported");
    check_pair_fails(NODES, "1 4 0\n0 0 1 2\n", "a.ele:2: expected the index of a node, but the line ends");
    check_pair_fails(NODES, "1 4 0\n0 0 1 2 -3\n", "a.ele:2: the index of a node must lie between");
    check_pair_fails(NODES, "1 4 0\n0 0 1 2 5\n", "a.ele:2: tet 0 uses node 5, which the file does not give");
    check_pair_fails(NODES, "2 4 0\n0 0 1 2 3\n1 2 1 0 3\n", "a.ele:3: tet 1 is inverted");
    check_pair_fails(NODES, "1 4 0\n0 0 1 2 2\n", "a.ele:2: tet 0 uses node 2 twice");
    check_pair_fails(NODES, "0 4 0\n", "the number of tets must lie between 1");
}

static void needs_both_files(void **state)
{
    (void)state;
    ShvError error = {0};
    write_bytes(pair.node, NODES, strlen(NODES));
    unlink(pair.ele);
    check_fails(read_once(NULL, pair.node, &error), SHV_FILE_ERROR, error, "a.ele");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_what_tetgen_writes),     cmocka_unit_test(refuses_cut_off_and_corrupted_files),
        cmocka_unit_test(survives_failing_allocations), cmocka_unit_test(ignores_comments_attributes_and_unused_nodes),
        cmocka_unit_test(names_what_is_wrong),          cmocka_unit_test(needs_both_files),
    };
    return cmocka_run_group_tests(tests, make_pair, remove_pair);
}
