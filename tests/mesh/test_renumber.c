#include "bodies.h"

#include "base/random.h"

static int compare_nodes(const void *a, const void *b)
{
    const int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
    return (p > q) - (p < q);
}

/* Different cache lines of 64 bytes that the positions (24 bytes) of `length` consecutive elements lie in, on average:
   what a batch of the solver gathers, or what passes through a cache while some thousand elements are computed. */
static double lines_touched(const ShvMesh *mesh, int32_t length)
{
    int64_t different = 0;
    int32_t *lines = calloc(4 * (size_t)length, sizeof *lines);
    assert_non_null(lines);
    for (int32_t first = 0; first + length <= mesh->element_count; first += length) {
        for (int32_t i = 0; i < 4 * length; i++) lines[i] = mesh->elements[4 * first + i] * 24 / 64;
        qsort(lines, 4 * (size_t)length, sizeof *lines, compare_nodes);
        for (int32_t i = 0; i < 4 * length; i++) different += i == 0 || lines[i] != lines[i - 1];
    }
    free(lines);
    return (double)different / (double)(mesh->element_count / length);
}

/* Elements in random order: what a mesh file may bring. */
static void shuffle(ShvMesh *mesh)
{
    for (int32_t e = mesh->element_count - 1; e > 0; e--) {
        const int32_t other = (int32_t)(shv_random_bits(1, (uint64_t)e) % ((uint64_t)e + 1));
        for (int i = 0; i < 4; i++) {
            const int32_t swap = mesh->elements[4 * e + i];
            mesh->elements[4 * e + i] = mesh->elements[4 * other + i];
            mesh->elements[4 * other + i] = swap;
        }
    }
}

static void maps_lead_back(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        ShvMesh before, mesh;
        const ShvMeshDefinition d = any_body(b, 0.01);
        check_ok(make(&before, NULL, &d, &error), error);
        check_ok(make(&mesh, NULL, &d, &error), error);
        int32_t *old_elements = calloc((size_t)mesh.element_count, sizeof *old_elements);
        int32_t *old_nodes = calloc((size_t)mesh.node_count, sizeof *old_nodes);
        char *met = calloc((size_t)mesh.element_count, 1);
        check_ok(shv_mesh_renumber(&mesh, old_elements, old_nodes, &error), error);
        check_ok(shv_mesh_validate(&mesh, "renumbered", &error), error);
        int32_t used = 0;
        for (int32_t e = 0; e < mesh.element_count; e++) {
            assert_int_equal(met[old_elements[e]]++, 0);
            for (int i = 0; i < 4; i++) {
                const int32_t node = mesh.elements[4 * e + i];
                assert_int_equal(old_nodes[node], before.elements[4 * old_elements[e] + i]);
                assert_true(node <= used);
                used += node == used;
            }
        }
        for (int32_t n = 0; n < mesh.node_count; n++)
            assert_memory_equal(mesh.positions + 3 * n, before.positions + 3 * old_nodes[n], 24);
        free(met);
        free(old_nodes);
        free(old_elements);
        shv_mesh_release(&mesh);
        shv_mesh_release(&before);
    }
}

static void helps_locality(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        ShvMesh mesh;
        const ShvMeshDefinition d = any_body(b, 0.004);
        check_ok(make(&mesh, NULL, &d, &error), error);
        const double batch = lines_touched(&mesh, 8), window = lines_touched(&mesh, 4096);
        shuffle(&mesh);
        const double shuffled_batch = lines_touched(&mesh, 8), shuffled_window = lines_touched(&mesh, 4096);
        check_ok(shv_mesh_renumber(&mesh, NULL, NULL, &error), error);
        const double new_batch = lines_touched(&mesh, 8), new_window = lines_touched(&mesh, 4096);
        print_message("body %d, %d elements: lines a batch of 8: %.1f made, %.1f shuffled, %.1f renumbered; of 4096: "
                      "%.0f, %.0f, %.0f\n",
                      b, mesh.element_count, batch, shuffled_batch, new_batch, window, shuffled_window, new_window);
        /* Every batch needs the 24 or so nodes of eight neighbours: 8 lines when they are numbered together. */
        assert_true(new_batch < 0.35 * shuffled_batch);
        assert_true(new_window < 0.2 * shuffled_window);
        assert_true(new_window < window);
        shv_mesh_release(&mesh);
    }
}

/* Once more changes nothing, save for elements whose centroids share a cell of the curve: here there are none. */
static void is_a_fixed_point(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    const ShvMeshDefinition d = body(SHV_MESH_HOLLOW_BALL, 0.01);
    check_ok(make(&mesh, NULL, &d, &error), error);
    check_ok(shv_mesh_renumber(&mesh, NULL, NULL, &error), error);
    int32_t *old_elements = calloc((size_t)mesh.element_count, sizeof *old_elements);
    check_ok(shv_mesh_renumber(&mesh, old_elements, NULL, &error), error);
    for (int32_t e = 0; e < mesh.element_count; e++) assert_int_equal(old_elements[e], e);
    free(old_elements);
    shv_mesh_release(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_lead_back),
        cmocka_unit_test(helps_locality),
        cmocka_unit_test(is_a_fixed_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
