#include "bodies.h"

/* Two unit tets on either side of a common facet. */
static const double pair_positions[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
static const int32_t pair_elements[8] = {0, 1, 2, 3, 4, 1, 3, 2};

static ShvMesh make_pair(void)
{
    ShvMesh mesh;
    ShvError error;
    check_ok(shv_mesh_allocate(&mesh, NULL, 5, 2, &error), error);
    memcpy(mesh.positions, pair_positions, sizeof pair_positions);
    memcpy(mesh.elements, pair_elements, sizeof pair_elements);
    return mesh;
}

static void check_refused(const ShvMesh *mesh, const char *part)
{
    ShvError error;
    check_fails(shv_mesh_validate(mesh, "plate.msh", &error), SHV_BAD_INPUT, error, part);
    assert_non_null(strstr(error.message, "plate.msh"));
}

static void a_sound_mesh_passes(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh = make_pair();
    check_ok(shv_mesh_validate(&mesh, "pair", &error), error);
    check_near(shv_mesh_element_volume(&mesh, 0), 1.0 / 6.0, 1e-16);
    check_near(shv_mesh_element_volume(&mesh, 1), 1.0 / 3.0, 1e-15);
    shv_mesh_release(&mesh);
    assert_null(mesh.positions);
}

static void bad_indices_are_named(void **state)
{
    (void)state;
    ShvMesh mesh = make_pair();
    mesh.elements[6] = 5;
    check_refused(&mesh, "element 1 uses node 5, but nodes run from 0 to 4");
    mesh.elements[6] = -2;
    check_refused(&mesh, "element 1 uses node -2");
    mesh.elements[6] = 1;
    check_refused(&mesh, "element 1 (nodes 4 1 1 2) uses node 1 twice");
    shv_mesh_release(&mesh);
}

static void bad_coordinates_are_named(void **state)
{
    (void)state;
    ShvMesh mesh = make_pair();
    mesh.positions[13] = (double)NAN;
    check_refused(&mesh, "node 4 has a coordinate that is not finite");
    mesh.positions[13] = (double)-INFINITY;
    check_refused(&mesh, "node 4 has a coordinate that is not finite");
    /* Finite, but its products overflow. */
    mesh.positions[13] = 1e300;
    check_refused(&mesh, "element 1");
    shv_mesh_release(&mesh);
}

static void flat_and_inverted_elements_are_named(void **state)
{
    (void)state;
    ShvMesh mesh = make_pair();
    /* Node 4 into the plane x + y + z = 1 of the common facet, then just outside it, just inside, and beyond. */
    const double offsets[3] = {0.0, 1e-16, -0.1};
    const char *messages[3] = {"element 1 (nodes 4 1 3 2) has no volume", "element 1 (nodes 4 1 3 2) has no volume",
                               "element 1 (nodes 4 1 3 2) is inverted"};
    for (int i = 0; i < 3; i++) {
        mesh.positions[12] = mesh.positions[13] = 0.5 + offsets[i];
        mesh.positions[14] = 0.0;
        check_refused(&mesh, messages[i]);
    }
    /* All nodes in one place. */
    for (int i = 0; i < 15; i++) mesh.positions[i] = 7.0;
    check_refused(&mesh, "element 0 (nodes 0 1 2 3) has no volume");
    shv_mesh_release(&mesh);
}

static void bad_connections_are_named(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    check_ok(shv_mesh_allocate(&mesh, NULL, 6, 3, &error), error);
    memcpy(mesh.positions, pair_positions, sizeof pair_positions);
    memcpy(mesh.elements, pair_elements, sizeof pair_elements);
    const double beyond[3] = {2, 2, 2};
    memcpy(mesh.positions + 15, beyond, sizeof beyond);

    const int32_t duplicate[4] = {2, 0, 1, 3};
    memcpy(mesh.elements + 8, duplicate, sizeof duplicate);
    check_refused(&mesh, "element 2 is a duplicate of element 0");

    const int32_t third[4] = {5, 1, 3, 2};
    memcpy(mesh.elements + 8, third, sizeof third);
    check_refused(&mesh, "element 2 is at least the third that shares the facet of nodes 1 2 3");

    /* On the side of facet 4 1 3 where element 1 lies already. */
    const int32_t overlapping[4] = {5, 4, 3, 1};
    memcpy(mesh.elements + 8, overlapping, sizeof overlapping);
    const double inside[3] = {0.9, 0.95, 0.9};
    memcpy(mesh.positions + 15, inside, sizeof inside);
    if (shv_mesh_element_volume(&mesh, 2) < 0.0) mesh.elements[9] = 3, mesh.elements[10] = 4;
    check_refused(&mesh, "elements 2 and 1 overlap");

    mesh.element_count = 2;
    check_refused(&mesh, "node 5 belongs to no element");
    mesh.element_count = 0;
    check_refused(&mesh, "at least one tetrahedron");
    mesh.element_count = 3;
    shv_mesh_release(&mesh);
}

static void too_large_a_mesh_is_refused(void **state)
{
    (void)state;
    ShvMesh mesh;
    ShvError error;
    check_fails(shv_mesh_allocate(&mesh, NULL, 10, INT64_C(3000000000), &error), SHV_BAD_INPUT, error, "too large");
    assert_null(mesh.elements);
}

static void quality_of_known_tets(void **state)
{
    (void)state;
    ShvMesh mesh = make_pair();
    /* Element 1 is replaced by a regular one: the alternating corners of a cube of side 1, edges √2. */
    const double cube[12] = {1, 1, 0, 1, 0, 1, 0, 1, 1, 0, 0, 0};
    const int32_t regular[4] = {0, 1, 2, 3};
    memcpy(mesh.positions, cube, sizeof cube);
    memcpy(mesh.elements, regular, sizeof regular);
    if (shv_mesh_element_volume(&mesh, 0) < 0.0) mesh.elements[0] = 1, mesh.elements[1] = 0;
    mesh.element_count = 1;
    ShvMeshQuality q = shv_mesh_quality(&mesh);
    check_near(q.volume, 1.0 / 3.0, 1e-15);
    check_near(q.worst_aspect, 1.0, 1e-14);
    check_near(q.mean_aspect, 1.0, 1e-14);
    check_near(q.mean_edge, sqrt(2.0), 1e-15);
    check_near(q.smallest_altitude, sqrt(4.0 / 3.0), 1e-14);
    const double regular_dihedral = 70.528779365509308631; /* arccos 1/3 */
    check_near(q.smallest_dihedral, regular_dihedral, 1e-11);
    check_near(q.largest_dihedral, regular_dihedral, 1e-11);

    /* The corner of a cube: edges 1 and √2, three right dihedral angles and three of arctan √2, r = (3 − √3)/6, R = √3/2. */
    memcpy(mesh.positions, pair_positions, sizeof pair_positions);
    memcpy(mesh.elements, pair_elements, sizeof pair_elements);
    q = shv_mesh_quality(&mesh);
    check_near(q.worst_aspect, 3.0 * (3.0 - sqrt(3.0)) / 6.0 / (sqrt(3.0) / 2.0), 1e-14);
    check_near(q.smallest_dihedral, 54.735610317245345685, 1e-11);
    check_near(q.largest_dihedral, 90.0, 1e-11);
    check_near(q.shortest_edge, 1.0, 0.0);
    check_near(q.longest_edge, sqrt(2.0), 1e-15);
    check_near(q.smallest_altitude, sqrt(1.0 / 3.0), 1e-15);
    check_near(q.mean_edge, (1.0 + sqrt(2.0)) / 2.0, 1e-15);
    shv_mesh_release(&mesh);
}

static void mass_of_a_box_far_away(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    const ShvMeshDefinition d = body(SHV_MESH_BOX, 0.01);
    check_ok(shv_mesh_box(&mesh, NULL, &d, &error), error);
    for (int32_t n = 0; n < mesh.node_count; n++) shv_add_to3(mesh.positions + 3 * n, shv_vec3(1.0, -2.0, 4.0));
    const ShvMassProperties m = shv_mesh_mass(&mesh);
    const double x = d.size[0], y = d.size[1], z = d.size[2], volume = x * y * z;
    /* Coordinates of size 4 carry 4e-16 of rounding: 1e-14 of lengths of 0.05, and a few times that of moments. */
    check_near(m.mass, volume, 1e-13 * volume);
    check_near(m.centre.x, 1.0, 1e-14);
    check_near(m.centre.y, -2.0, 1e-14);
    check_near(m.centre.z, 4.0, 1e-14);
    check_near(m.inertia.m[0][0], volume * (y * y + z * z) / 12.0, 1e-13 * volume);
    check_near(m.inertia.m[1][1], volume * (x * x + z * z) / 12.0, 1e-13 * volume);
    check_near(m.inertia.m[2][2], volume * (x * x + y * y) / 12.0, 1e-13 * volume);
    check_near(m.inertia.m[0][1], 0.0, 1e-13 * volume);
    check_near(m.inertia.m[1][2], 0.0, 1e-13 * volume);
    shv_mesh_release(&mesh);
}

/* Off-diagonal terms: a single tet against the product of inertia by Gauss points of degree two. */
static void mass_of_a_tet_by_quadrature(void **state)
{
    (void)state;
    ShvMesh mesh = make_pair();
    mesh.element_count = 1;
    const double skew[12] = {0.1, -0.2, 0.3, 1.3, 0.4, 0.2, -0.2, 0.9, 0.1, 0.3, 0.2, 1.7};
    memcpy(mesh.positions, skew, sizeof skew);
    const ShvMassProperties m = shv_mesh_mass(&mesh);
    double products[3][3] = {{0.0}};
    for (int g = 0; g < 4; g++) {
        /* Points (5 + 3√5)/20 and (5 − √5)/20, exact for degree two. */
        double x[3] = {0.0};
        for (int i = 0; i < 4; i++)
            for (int a = 0; a < 3; a++)
                x[a] += (i == g ? (5.0 + 3.0 * sqrt(5.0)) / 20.0 : (5.0 - sqrt(5.0)) / 20.0) * skew[3 * i + a];
        x[0] -= m.centre.x;
        x[1] -= m.centre.y;
        x[2] -= m.centre.z;
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) products[a][b] += 0.25 * m.mass * x[a] * x[b];
    }
    const double trace = products[0][0] + products[1][1] + products[2][2];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) check_near(m.inertia.m[a][b], (a == b ? trace : 0.0) - products[a][b], 1e-15);
    shv_mesh_release(&mesh);
}

static void mass_of_a_ball_converges(void **state)
{
    (void)state;
    ShvError error;
    double errors[2];
    for (int i = 0; i < 2; i++) {
        ShvMesh mesh;
        const ShvMeshDefinition d = body(SHV_MESH_BALL, i == 0 ? 0.01 : 0.005);
        check_ok(shv_mesh_ball(&mesh, NULL, &d, &error), error);
        const ShvMassProperties m = shv_mesh_mass(&mesh);
        const double exact = 8.0 / 15.0 * 3.14159265358979323846 * pow(d.radius, 5);
        check_near(m.centre.x, 0.0, 1e-15);
        check_near(m.inertia.m[0][0], m.inertia.m[2][2], 0.01 * exact);
        check_near(m.inertia.m[0][1], 0.0, 0.01 * exact);
        errors[i] = (1.0 - m.inertia.m[1][1] / exact) / pow(shv_mesh_quality(&mesh).mean_edge, 2);
        shv_mesh_release(&mesh);
    }
    /* Second order in the mean edge: the next term is of fourth order, some (h/R)² = 4 % of the first. */
    assert_true(errors[1] > 0.0);
    check_near(errors[0] / errors[1], 1.0, 0.08);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sound_mesh_passes),         cmocka_unit_test(bad_indices_are_named),
        cmocka_unit_test(bad_coordinates_are_named),   cmocka_unit_test(flat_and_inverted_elements_are_named),
        cmocka_unit_test(bad_connections_are_named),   cmocka_unit_test(too_large_a_mesh_is_refused),
        cmocka_unit_test(quality_of_known_tets),       cmocka_unit_test(mass_of_a_box_far_away),
        cmocka_unit_test(mass_of_a_tet_by_quadrature), cmocka_unit_test(mass_of_a_ball_converges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
