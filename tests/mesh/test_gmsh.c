#include "check.h"

#include "files.h"
#include "mesh/generate.h"

/* Files written by Gmsh 4.8: a block of 1 × 2 × 3 with physical groups, 22 nodes, 40 triangles, 42 tets. */
static const char *const block_files[] = {"data/block_22.msh", "data/block_41.msh", "data/block_41_binary.msh"};

static ShvStatus read_once(ShvMemory *memory, const char *path, ShvError *error)
{
    ShvMesh mesh;
    const ShvStatus status = shv_mesh_read_gmsh(&mesh, memory, path, error);
    if (status != SHV_OK) {
        assert_null(mesh.positions);
        assert_null(mesh.elements);
        return status;
    }
    check_mesh_sound(&mesh);
    shv_mesh_release(&mesh);
    return SHV_OK;
}

static void reads_what_gmsh_writes(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh first = {0};
    for (int i = 0; i < 3; i++) {
        ShvMesh mesh;
        check_ok(shv_mesh_read_gmsh(&mesh, NULL, block_files[i], &error), error);
        assert_int_equal(mesh.node_count, 22);
        assert_int_equal(mesh.element_count, 42);
        check_ok(shv_mesh_validate(&mesh, block_files[i], &error), error);
        /* 42 sums of products of numbers below 10. */
        check_near(mesh_volume(&mesh), 6.0, 1e-14 * 42.0);
        if (i == 0) {
            first = mesh;
            continue;
        }
        assert_memory_equal(mesh.elements, first.elements, 4 * 42 * sizeof(int32_t));
        /* Text has 16 digits. */
        for (int k = 0; k < 66; k++) check_near(mesh.positions[k], first.positions[k], 3e-15);
        shv_mesh_release(&mesh);
    }
    shv_mesh_release(&first);
}

static void refuses_cut_off_files(void **state)
{
    (void)state;
    static const char *const names[] = {"a.msh", "b.msh", "c.msh"};
    for (int i = 0; i < 3; i++) {
        const Bytes bytes = read_bytes(block_files[i]);
        /* Only the end of the last line can be spared. */
        check_truncations(read_once, bytes, names[i], bytes.size - 1);
        shv_release(bytes.data);
    }
}

static void survives_corrupted_files(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        const Bytes bytes = read_bytes(block_files[i]);
        check_corruptions(read_once, bytes, "a.msh", 1000);
        shv_release(bytes.data);
    }
}

static void survives_failing_allocations(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) check_allocation_failures(read_once, block_files[i]);
}

#define HEAD_2 "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define HEAD_4 "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
/* Tags with gaps, out of order, one node (9) of no tet. */
#define NODES_2 "$Nodes\n5\n70 0 0 0\n9 5 5 5\n20 1 0 0\n3 0 1 0\n40 0 0 1\n$EndNodes\n"
#define NODES_4 "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"

static void maps_tags_and_drops_unused_nodes(void **state)
{
    (void)state;
    const char *text = HEAD_2 "$Comment\nanything\n$EndComment\n" NODES_2
                              "$Elements\n3\n1 15 2 0 1 9\n2 2 2 0 1 70 20 3\n8 4 3 0 1 5 70 20 3 40\n$EndElements\n"
                              "$NodeData\n1\n\"a\"\n$EndNodeData\n";
    ShvError error;
    ShvMesh mesh;
    const TemporaryFile file = temporary_file("tags.msh");
    write_bytes(file.path, text, strlen(text));
    check_ok(shv_mesh_read_gmsh(&mesh, NULL, file.path, &error), error);
    static const int32_t element[4] = {0, 1, 2, 3};
    static const double positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    assert_int_equal(mesh.node_count, 4);
    assert_int_equal(mesh.element_count, 1);
    assert_memory_equal(mesh.elements, element, sizeof element);
    assert_memory_equal(mesh.positions, positions, sizeof positions);
    shv_mesh_release(&mesh);
    remove_temporary_file(&file);
}

/* Two tets of two physical volumes, one of which has a name; a third, of none. */
#define FIVE_NODES "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n6 -1 0 0\n"
#define NAMES      "$PhysicalNames\n2\n2 7 \"skin\"\n3 7 \"a bar of steel\"\n$EndPhysicalNames\n"
static const char *const grouped[] = {
    HEAD_2 NAMES "$Nodes\n6\n" FIVE_NODES "$EndNodes\n"
                 "$Elements\n3\n1 4 2 7 1 1 2 3 4\n2 4 2 9 2 2 3 4 5\n3 4 2 0 3 1 3 6 4\n$EndElements\n",
    HEAD_4 NAMES
    "$Entities\n1 0 1 3\n1 0 0 0 1 5\n1 0 0 0 1 1 1 1 7 0\n1 0 0 0 1 1 1 2 7 9 1 -1\n2 0 0 0 1 1 1 1 9 0\n"
    "3 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n1 6 1 6\n3 1 0 6\n1\n2\n3\n4\n5\n6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n"
    "-1 0 0\n$EndNodes\n$Elements\n3 3 1 3\n3 1 4 1\n1 1 2 3 4\n3 2 4 1\n2 2 3 4 5\n3 3 4 1\n3 1 3 6 "
    "4\n$EndElements\n"};

static void keeps_physical_volumes(void **state)
{
    (void)state;
    static const int32_t groups[3] = {7, 9, 0};
    for (int i = 0; i < 2; i++) {
        ShvError error;
        ShvMesh mesh;
        const TemporaryFile file = temporary_file("groups.msh");
        write_bytes(file.path, grouped[i], strlen(grouped[i]));
        check_ok(shv_mesh_read_gmsh(&mesh, NULL, file.path, &error), error);
        assert_memory_equal(mesh.element_groups, groups, sizeof groups);
        assert_int_equal(mesh.group_count, 1);
        assert_int_equal(shv_mesh_find_group(&mesh, "a bar of steel"), 7);
        assert_int_equal(shv_mesh_find_group(&mesh, "9"), 9);
        assert_int_equal(shv_mesh_find_group(&mesh, "8"), 0);
        assert_int_equal(shv_mesh_find_group(&mesh, "skin"), 0);
        int32_t old[3];
        check_ok(shv_mesh_renumber(&mesh, old, NULL, &error), error);
        for (int e = 0; e < 3; e++) assert_int_equal(mesh.element_groups[e], groups[old[e]]);
        assert_string_equal(mesh.groups[0].name, "a bar of steel");
        shv_mesh_release(&mesh);
        check_allocation_failures(read_once, file.path);
        remove_temporary_file(&file);
    }
}

static void names_what_is_wrong(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"", "a.msh:1: the file ends where $MeshFormat"},
        {"\x7f"
         "ELF\x01\x02",
         "a.msh:1: expected $MeshFormat, not '?ELF"},
        {"$MeshFormat\n4.1 0 4\n$EndMeshFormat\n", "a.msh:2: the data size must lie between 8 and 8"},
        {"$MeshFormat\n1 0 8\n$EndMeshFormat\n", "version 1 is not supported"},
        {"$MeshFormat\n2.2 1 8\n$EndMeshFormat\n", "binary files of version 2"},
        {"$MeshFormat\n4.1 1 8\n\x00\x00\x00\x01", "cut off"},
        {HEAD_2 NODES_2, "no $Elements section"},
        {HEAD_2 "$Elements\n1\n8 4 0 1 2 3 4\n$EndElements\n", "no $Nodes section"},
        {HEAD_2 "$Nodes\n99999999999\n1 0 0 0\n", "a.msh:5: 99999999999 nodes are announced, more than the remaining"},
        {HEAD_2 "$Nodes\n99999999999999999999\n", "expected the number of nodes, a whole number"},
        {HEAD_2 "$Nodes\n-1\n", "must lie between 0 and"},
        {HEAD_2 "$Nodes\n1\n1 0 nan 0\n$EndNodes\n", "a.msh:6: expected a coordinate, a finite number, not 'nan'"},
        {HEAD_2 "$Nodes\n1\n1 0 1e999 0\n$EndNodes\n", "finite number, not '1e999'"},
        {HEAD_2 "$Nodes\n1\n1 0 0x10 0\n$EndNodes\n", "finite number, not '0x10'"},
        {HEAD_2 "$Nodes\n1\n1 0 0 0 0\n$EndNodes\n", "expected the end of the line, not '0'"},
        {HEAD_2 "$Nodes\n1\n1 0 0 0\n2 1 0 0\n$EndNodes\n", "a.msh:7: expected $EndNodes, not '2'"},
        {HEAD_2 NODES_2 NODES_2, "two $Nodes sections"},
        {HEAD_2 "junk\n", "expected a section such as $Nodes, not 'junk'"},
        {HEAD_2 "$Entities\n1\n", "section $Entities does not end"},
        {HEAD_4 "$Entities\n1 0 0 0\n\n\n\n\n\n\n\n\n\n", "the file ends where an entity was expected"},
        {HEAD_4 "$Entities\n0 0 0 1\n4 0 0 0 1 1 1 9999\n", "a.msh:6: expected a physical group"},
        {HEAD_4 "$Entities\n99999 0 0 0\n", "99999 entities are announced, more than the remaining"},
        {HEAD_2 "$PhysicalNames\n1\n3 1 steel\n", "a.msh:6: physical group 1 has no name in quotes"},
        {HEAD_2 "$PhysicalNames\n1\n3 1 \"steel\n", "a.msh:6: the name of physical group 1 does not end"},
        {HEAD_2 "$PhysicalNames\n1\n3 1 \"\n", "a.msh:6: the name of physical group 1 does not end"},
        {HEAD_2 NODES_2 "$Elements\n1\n7 2 0 70 20 3\n$EndElements\n", "there are no tets"},
        {HEAD_2 NODES_2 "$Elements\n1\n7 5 0 1 2 3 4 5 6 7 8\n$EndElements\n", "a.msh:14: elements of type 5"},
        {HEAD_2 NODES_2 "$Elements\n1\n7 4 0 70 20 3\n$EndElements\n", "expected a node, but the line ends"},
        {HEAD_2 NODES_2 "$Elements\n1\n7 4 0 70 20 3 41\n$EndElements\n", "a.msh:14: tet 7 uses node 41, which"},
        {HEAD_2 NODES_2 "$Elements\n1\n7 4 0 70 20 3 3\n$EndElements\n", "a.msh:14: tet 7 uses node 3 twice"},
        {HEAD_2 NODES_2 "$Elements\n1\n7 4 0 20 70 3 40\n$EndElements\n", "a.msh:14: tet 7 is inverted"},
        {HEAD_2 "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 1 1 0\n$EndNodes\n"
                "$Elements\n1\n7 4 0 1 2 3 4\n$EndElements\n",
         "a.msh:13: tet 7 has no volume"},
        {HEAD_2 "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n3 9 9 9\n$EndNodes\n"
                "$Elements\n1\n7 4 0 1 2 3 4\n$EndElements\n",
         "node 3 is given twice"},
        {HEAD_4 "$Nodes\n1 4 1 4\n3 1 0 5\n", "a block of 5 entries, but only 4"},
        {HEAD_4 "$Nodes\n1 2 1 4\n3 1 0 1\n1\n0 0 0\n$EndNodes\n", "hold 1 entries fewer"},
        {HEAD_4 "$Nodes\n1 9223372036854775807 1 4\n3 1 0 1\n", "more than the remaining"},
        {HEAD_4 "$Nodes\n1 1 1 1\n7 1 0 1\n1\n0 0 0\n", "dimension 7"},
        {HEAD_4 NODES_4 "$Elements\n1 1 1 1\n3 1 11 1\n", "elements of type 11"},
        {HEAD_4 NODES_4 "$Elements\n1 1 1 1\n3 1 4 1\n7 2 1 3 4\n$EndElements\n", "a.msh:19: tet 7 is inverted"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_text_fails(read_once, "a.msh", cases[i].text, cases[i].part);
}

static void names_bytes_of_binary_files(void **state)
{
    (void)state;
    ShvError error = {0};
    Bytes bytes = read_bytes(block_files[2]);
    const TemporaryFile file = temporary_file("a.msh");
    char *one = strchr(strchr(bytes.data, '\n') + 1, '\n') + 1;
    const char native[4] = {one[0], one[1], one[2], one[3]};
    for (int k = 0; k < 4; k++) one[k] = native[3 - k];
    write_bytes(file.path, bytes.data, bytes.size);
    check_fails(read_once(NULL, file.path, &error), SHV_BAD_INPUT, error, "byte order");
    memcpy(one, native, 4);
    /* The last eight bytes of the data are the last node of the last tet: 0 is no node. */
    const size_t end = bytes.size - strlen("\n$EndElements\n");
    memset(bytes.data + end - 8, 0, 8);
    write_bytes(file.path, bytes.data, bytes.size);
    char place[64];
    snprintf(place, sizeof place, "at byte %zu: tet 82 uses node 0,", end - 40);
    check_fails(read_once(NULL, file.path, &error), SHV_BAD_INPUT, error, place);
    remove_temporary_file(&file);
    shv_release(bytes.data);
}

static void refuses_what_is_no_file(void **state)
{
    (void)state;
    ShvError error = {0};
    check_fails(read_once(NULL, "data/absent.msh", &error), SHV_FILE_ERROR, error, "data/absent.msh");
    check_fails(read_once(NULL, "data", &error), SHV_BAD_INPUT, error, "data");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_what_gmsh_writes),
        cmocka_unit_test(refuses_cut_off_files),
        cmocka_unit_test(survives_corrupted_files),
        cmocka_unit_test(survives_failing_allocations),
        cmocka_unit_test(maps_tags_and_drops_unused_nodes),
        cmocka_unit_test(keeps_physical_volumes),
        cmocka_unit_test(names_what_is_wrong),
        cmocka_unit_test(names_bytes_of_binary_files),
        cmocka_unit_test(refuses_what_is_no_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
