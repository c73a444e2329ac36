#include "bodies.h"

#include "mesh/sectors.h"

static const double pi = 3.14159265358979323846;

static double exact_volume(const ShvMeshDefinition *d)
{
    const double outer = d->radius, inner = d->inner_radius;
    switch (d->kind) {
    case SHV_MESH_BALL:
        return 4.0 / 3.0 * pi * pow(outer, 3);
    case SHV_MESH_HOLLOW_BALL:
        return 4.0 / 3.0 * pi * (pow(outer, 3) - pow(inner, 3));
    case SHV_MESH_CYLINDER:
        return pi * (outer * outer - inner * inner) * d->height;
    default:
        return d->size[0] * d->size[1] * d->size[2];
    }
}

static double volume_of(const ShvMeshDefinition *d, double *mean_edge)
{
    ShvError error;
    ShvMesh mesh;
    check_ok(make(&mesh, NULL, d, &error), error);
    const ShvMeshQuality q = shv_mesh_quality(&mesh);
    *mean_edge = q.mean_edge;
    shv_mesh_release(&mesh);
    return q.volume;
}

static void volumes_converge(void **state)
{
    (void)state;
    for (int b = 0; b < 5; b++) {
        double errors[2], mean_edge;
        for (int i = 0; i < 2; i++) {
            const ShvMeshDefinition d = any_body(b, i == 0 ? 0.01 : 0.005);
            errors[i] = 1.0 - volume_of(&d, &mean_edge) / exact_volume(&d);
            /* Rounding of some 1e4 sums of like size. */
            if (d.kind == SHV_MESH_BOX || d.kind == SHV_MESH_NOTCHED_BEAM) check_near(errors[i], 0.0, 1e-12);
            errors[i] /= mean_edge * mean_edge;
        }
        /* Second order in the mean edge; first order would give 0.5. The next term is of fourth order, some (h/R)² = 4 %
           of the first. (Holes: below.) */
        if (b != 1 && b != 3) continue;
        assert_true(errors[1] > 0.0);
        check_near(errors[0] / errors[1], 1.0, 0.1);
    }
}

/* Nodes at a distance from the centre, or from the axis in the bottom layer. */
static int32_t nodes_at(const ShvMesh *mesh, double radius, const double *bottom)
{
    int32_t count = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        ShvVec3 x = shv_mesh_position(mesh, n);
        if (bottom && x.z != *bottom) continue;
        if (bottom) x.z = 0.0;
        count += fabs(shv_norm(x) - radius) < 1e-12;
    }
    return count;
}

/* A hole takes away exactly what the polyhedron inscribed in it holds. */
static void holes_take_their_volume(void **state)
{
    (void)state;
    ShvError error;
    for (double edge = 0.004; edge < 0.015; edge *= 1.3) {
        ShvMesh mesh;
        const ShvMeshDefinition d = body(SHV_MESH_HOLLOW_BALL, edge), t = tube(edge);
        check_ok(make(&mesh, NULL, &d, &error), error);
        double expected = 0.0;
        for (int i = 0; i < 2; i++) {
            /* k layers: 10 k² + 2 nodes on the sphere. */
            const double radius = i == 0 ? d.radius : d.inner_radius;
            const int32_t layers = (int32_t)lround(sqrt((nodes_at(&mesh, radius, NULL) - 2) / 10.0));
            const ShvSectors solid = {0, layers, 0.0, radius};
            ShvMesh ball;
            check_ok(shv_sectors_mesh(&ball, NULL, &solid, &error), error);
            expected += (i == 0 ? 1.0 : -1.0) * shv_mesh_quality(&ball).volume;
            shv_mesh_release(&ball);
        }
        check_near(shv_mesh_quality(&mesh).volume, expected, 1e-12 * expected);
        shv_mesh_release(&mesh);

        check_ok(make(&mesh, NULL, &t, &error), error);
        const double bottom = -0.5 * t.height;
        const int32_t outer = nodes_at(&mesh, t.radius, &bottom), inner = nodes_at(&mesh, t.inner_radius, &bottom);
        expected = 0.5 * t.height *
                   (outer * t.radius * t.radius * sin(2.0 * pi / outer) -
                    inner * t.inner_radius * t.inner_radius * sin(2.0 * pi / inner));
        check_near(shv_mesh_quality(&mesh).volume, expected, 1e-12 * expected);
        shv_mesh_release(&mesh);
    }
}

/* Sound, connected as a ball, a thick sphere, or a ring is, and with one boundary that is closed. */
static void topology(void **state)
{
    (void)state;
    /* Of solids without holes 1, of a shell 2, of a ring 0. The slit opens to the outside and changes nothing. */
    static const int expected[BODY_COUNT] = {1, 1, 2, 1, 1, 0, 1, 1};
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        static const double edges[4] = {0.04, 0.012, 0.008, 0.005};
        for (int i = 0; i < 4; i++) {
            ShvMesh mesh;
            ShvAdjacency a;
            const ShvMeshDefinition d = any_body(b, edges[i]);
            check_ok(make(&mesh, NULL, &d, &error), error);
            check_ok(shv_mesh_validate(&mesh, "body", &error), error);
            check_ok(shv_adjacency_build(&a, &mesh, &error), error);
            assert_int_equal(euler_characteristic(&mesh, a.facet_count), expected[b]);
            shv_adjacency_release(&a);
            shv_mesh_release(&mesh);
        }
    }
}

/* Bounds below what the constructions give. The lattice's surface pyramids have 45° and an aspect of 0.64 before they are
   stretched to fit by up to an eighth along one axis and a tenth the other way along another, which leaves
   arctan(0.9 / 1.125) = 38.7°; a notch stretches its first cells a little more. Balls and cylinders as measured over
   many sizes. The flattest brick has sides 1, 1 and a = 0.4 / (1.125 · 1.1) = 0.32: its corner tet has a dihedral angle
   of arctan(√2 a) = 24.5° and, from volume a / 6, surface and circumradius √(2 + a²) / 2, an aspect of 0.486; bricks of a box, at
   least four a side, have sides within an eighth of the one asked for: at least arctan(√2 · 0.875 / 1.125) = 47.7°. */
static void quality_is_good(void **state)
{
    (void)state;
    ShvError error;
    static const double aspects[BODY_COUNT] = {0.5, 0.7, 0.55, 0.6, 0.5, 0.6, 0.48, 0.65};
    static const double dihedrals[BODY_COUNT] = {38.0, 37.0, 33.0, 30.0, 35.0, 30.0, 24.0, 45.0};
    for (int b = 0; b < BODY_COUNT; b++)
        for (double edge = 0.006; edge < 0.013; edge *= 1.17) {
            ShvMesh mesh;
            const ShvMeshDefinition d = any_body(b, edge);
            check_ok(make(&mesh, NULL, &d, &error), error);
            const ShvMeshQuality q = shv_mesh_quality(&mesh);
            if (!(q.worst_aspect > aspects[b]) || !(q.smallest_dihedral > dihedrals[b]))
                fail_msg("body %d, edge %g: aspect %g, dihedral angle %g", b, edge, q.worst_aspect,
                         q.smallest_dihedral);
            if (d.kind != SHV_MESH_NOTCHED_BEAM) check_near(q.mean_edge, edge, 0.15 * edge);
            shv_mesh_release(&mesh);
        }
}

static void curved_surfaces_are_met_exactly(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        const ShvMeshDefinition d = any_body(b, 0.007);
        const bool round = d.kind == SHV_MESH_BALL || d.kind == SHV_MESH_HOLLOW_BALL;
        if (!round && d.kind != SHV_MESH_CYLINDER) continue;
        ShvMesh mesh;
        int32_t *triangles, count;
        check_ok(make(&mesh, NULL, &d, &error), error);
        check_ok(shv_mesh_boundary(&mesh, SHV_PART_GENERAL, &triangles, &count, &error), error);
        for (int32_t i = 0; i < 3 * count; i++) {
            ShvVec3 x = shv_mesh_position(&mesh, triangles[i]);
            if (!round && fabs(x.z) == 0.5 * d.height) continue;
            if (!round) x.z = 0.0;
            const double r = shv_norm(x);
            check_near(r, r > 0.5 * (d.radius + d.inner_radius) ? d.radius : d.inner_radius, 1e-15);
        }
        shv_release(triangles);
        shv_mesh_release(&mesh);
    }
}

/* The slit: on its plane below the tip every place has two nodes, one of each lip, but the front has one; nothing
   connects the lips. Both lips have the area depth × y. */
static void check_slit(ShvMeshPattern pattern, double edge)
{
    ShvError error;
    ShvMesh mesh;
    int32_t *triangles, count;
    ShvMeshDefinition d = body(SHV_MESH_NOTCHED_BEAM, edge);
    d.pattern = pattern;
    check_ok(make(&mesh, NULL, &d, &error), error);
    check_ok(shv_mesh_boundary(&mesh, SHV_PART_GENERAL, &triangles, &count, &error), error);
    const double tip = -0.5 * d.size[2] + d.notch_depth;
    double areas[2] = {0.0, 0.0}, highest = -1.0;
    for (int32_t t = 0; t < count; t++) {
        const ShvVec3 a = shv_mesh_position(&mesh, triangles[3 * t]),
                      b = shv_mesh_position(&mesh, triangles[3 * t + 1]),
                      c = shv_mesh_position(&mesh, triangles[3 * t + 2]);
        if (a.x != d.notch_offset || b.x != d.notch_offset || c.x != d.notch_offset) continue;
        const double area = 0.5 * shv_cross(shv_sub(b, a), shv_sub(c, a)).x;
        areas[area > 0.0] += fabs(area);
        highest = fmax(highest, fmax(a.z, fmax(b.z, c.z)));
    }
    /* The tip lies exactly where asked for. */
    assert_true(highest == tip);
    check_near(areas[0], d.notch_depth * d.size[1], 1e-15);
    check_near(areas[1], d.notch_depth * d.size[1], 1e-15);
    int on_front = 0, on_lips = 0;
    for (int32_t n = 0; n < mesh.node_count; n++) {
        const ShvVec3 x = shv_mesh_position(&mesh, n);
        if (x.x != d.notch_offset || x.z > tip) continue;
        int same = 0;
        for (int32_t m = 0; m < mesh.node_count; m++) same += shv_norm(shv_sub(shv_mesh_position(&mesh, m), x)) == 0.0;
        assert_int_equal(same, x.z == tip ? 1 : 2);
        *(x.z == tip ? &on_front : &on_lips) += 1;
    }
    assert_true(on_front > 10 && on_lips > 4 * on_front);
    /* An element with a node on a lip lies on one side of the slit. */
    for (int32_t e = 0; e < mesh.element_count; e++) {
        double low = 1.0, high = -1.0;
        bool lip = false;
        for (int i = 0; i < 4; i++) {
            const ShvVec3 x = shv_mesh_position(&mesh, mesh.elements[4 * e + i]);
            lip = lip || (x.x == d.notch_offset && x.z < tip);
            low = fmin(low, x.x);
            high = fmax(high, x.x);
        }
        assert_true(!lip || low == d.notch_offset || high == d.notch_offset);
    }
    shv_release(triangles);
    shv_mesh_release(&mesh);
}

static void notch_is_a_slit(void **state)
{
    (void)state;
    check_slit(SHV_PATTERN_LATTICE, 0.008);
    check_slit(SHV_PATTERN_BRICKS, 0.0048);
}

static double mean_edge_near(const ShvMesh *mesh, ShvVec3 place, double distance)
{
    double sum = 0.0;
    int64_t count = 0;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int i = 0; i < 4; i++)
            for (int j = i + 1; j < 4; j++) {
                const ShvVec3 a = shv_mesh_position(mesh, mesh->elements[4 * e + i]);
                const ShvVec3 b = shv_mesh_position(mesh, mesh->elements[4 * e + j]);
                if (fabs(a.x - place.x) > distance || fabs(a.z - place.z) > distance) continue;
                sum += shv_norm(shv_sub(a, b));
                count++;
            }
    assert_true(count > 0);
    return sum / (double)count;
}

/* The beam of John & Shah (1990): 228.6 × 25.4 × 76.2 mm. */
static ShvMeshDefinition john_shah_beam(double edge, double notch_edge)
{
    ShvMeshDefinition d = body(SHV_MESH_NOTCHED_BEAM, edge);
    d.size[0] = 0.2286;
    d.size[1] = 0.0254;
    d.size[2] = 0.0762;
    d.notch_depth = 0.01905;
    d.notch_offset = 0.0508;
    d.notch_edge = notch_edge;
    return d;
}

static void beam_is_graded(void **state)
{
    (void)state;
    ShvError error;
    for (int halvings = 0; halvings < 3; halvings++) {
        ShvMesh mesh;
        const ShvMeshDefinition d = john_shah_beam(0.006, ldexp(0.006, -halvings));
        check_ok(make(&mesh, NULL, &d, &error), error);
        check_ok(shv_mesh_validate(&mesh, "beam", &error), error);
        const ShvVec3 tip = shv_vec3(d.notch_offset, 0.0, -0.5 * d.size[2] + d.notch_depth);
        check_near(mean_edge_near(&mesh, tip, 0.5 * d.notch_edge), d.notch_edge, 0.2 * d.notch_edge);
        check_near(mean_edge_near(&mesh, shv_vec3(-0.08, 0.0, 0.0), 0.03), d.edge, 0.15 * d.edge);
        shv_mesh_release(&mesh);
    }
}

/* A published coarse mesh of it has 113,984 tets. */
static void john_shah_beam_of_published_size(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    const ShvMeshDefinition d = john_shah_beam(0.00495, 0.0009);
    check_ok(make(&mesh, NULL, &d, &error), error);
    check_ok(shv_mesh_validate(&mesh, "beam", &error), error);
    check_near(mesh.element_count, 113984, 0.05 * 113984);
    check_near(shv_mesh_quality(&mesh).volume, exact_volume(&d), 1e-12 * exact_volume(&d));
    shv_mesh_release(&mesh);
}

/* … and 25,777 nodes. */
static void john_shah_beam_of_bricks(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    ShvMeshDefinition d = john_shah_beam(0.0036, 0.0018);
    d.pattern = SHV_PATTERN_BRICKS;
    d.notch_growth = 0.03;
    check_ok(make(&mesh, NULL, &d, &error), error);
    check_ok(shv_mesh_validate(&mesh, "beam", &error), error);
    check_near(mesh.element_count, 113984, 0.05 * 113984);
    check_near(mesh.node_count, 25777, 0.05 * 25777);
    check_near(shv_mesh_quality(&mesh).volume, exact_volume(&d), 1e-12 * exact_volume(&d));
    /* All boundary areas: six sides and two lips; a pair of faces that did not fit would add to them. */
    int32_t *triangles, count;
    check_ok(shv_mesh_boundary(&mesh, SHV_PART_GENERAL, &triangles, &count, &error), error);
    double area = 0.0;
    for (int32_t t = 0; t < count; t++) {
        const ShvVec3 a = shv_mesh_position(&mesh, triangles[3 * t]);
        area += 0.5 * shv_norm(shv_cross(shv_sub(shv_mesh_position(&mesh, triangles[3 * t + 1]), a),
                                         shv_sub(shv_mesh_position(&mesh, triangles[3 * t + 2]), a)));
    }
    const double *l = d.size;
    const double expected = 2.0 * (l[0] * l[1] + l[1] * l[2] + l[2] * l[0]) + 2.0 * d.notch_depth * l[1];
    check_near(area, expected, 1e-12 * expected);
    shv_release(triangles);
    shv_mesh_release(&mesh);
}

/* Where the sides along x are those asked for: the mean edge over the depth is mixed with the even sides along y and z. */
static void bricks_are_thinned_along_x(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    ShvMeshDefinition d = john_shah_beam(0.006, 0.0015);
    d.pattern = SHV_PATTERN_BRICKS;
    d.notch_growth = 0.1;
    check_ok(make(&mesh, NULL, &d, &error), error);
    double least = 1.0, most = 0.0, next = 1.0;
    for (int32_t n = 0; n < mesh.node_count; n++) {
        const double x = shv_mesh_position(&mesh, n).x;
        if (x > d.notch_offset) least = fmin(least, x - d.notch_offset);
        if (x > -0.5 * d.size[0]) next = fmin(next, x);
    }
    most = next + 0.5 * d.size[0];
    /* A brick's mean edge is 1.2485 sides; the run is scaled by less than half a brick over its length, 3 / 64. */
    check_near(least, d.notch_edge / 1.24852813742386, 0.05 * least);
    check_near(most, d.edge / 1.24852813742386, 0.05 * most);
    shv_mesh_release(&mesh);
}

static void same_input_same_bits(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        ShvMesh first, second;
        const ShvMeshDefinition d = any_body(b, 0.009);
        check_ok(make(&first, NULL, &d, &error), error);
        check_ok(make(&second, NULL, &d, &error), error);
        assert_int_equal(first.node_count, second.node_count);
        assert_int_equal(first.element_count, second.element_count);
        assert_memory_equal(first.positions, second.positions, 24 * (size_t)first.node_count);
        assert_memory_equal(first.elements, second.elements, 16 * (size_t)first.element_count);
        shv_mesh_release(&first);
        shv_mesh_release(&second);
    }
}

static void refused(ShvMeshDefinition d, const char *part)
{
    ShvError error;
    ShvMesh mesh;
    check_fails(make(&mesh, NULL, &d, &error), SHV_BAD_INPUT, error, part);
    assert_null(mesh.positions);
    assert_null(mesh.elements);
}

static void bad_lengths_are_refused(void **state)
{
    (void)state;
    static const double bad[4] = {0.0, -0.01, (double)NAN, (double)INFINITY};
    for (int b = 0; b < BODY_COUNT; b++)
        for (int i = 0; i < 4; i++) {
            ShvMeshDefinition d = any_body(b, 0.01);
            const bool flat = d.kind == SHV_MESH_BOX || d.kind == SHV_MESH_NOTCHED_BEAM;
            d.edge = bad[i];
            refused(d, "edge is");
            d = any_body(b, 0.01);
            d.size[1] = d.radius = bad[i];
            refused(d, flat ? "size along y" : "radius is");
        }
    ShvMeshDefinition d = body(SHV_MESH_CYLINDER, 0.01);
    d.height = -1.0;
    refused(d, "height is -1 m");
    d = body(SHV_MESH_CYLINDER, 0.01);
    d.inner_radius = -0.01;
    refused(d, "inner_radius is -0.01 m");
    d.inner_radius = 0.05;
    refused(d, "inner_radius 0.05 m must be less than radius 0.05 m");
    d = body(SHV_MESH_HOLLOW_BALL, 0.01);
    d.inner_radius = 0.06;
    refused(d, "inner_radius 0.06 m must be less than radius 0.05 m");
}

static void edges_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    refused(body(SHV_MESH_BOX, 0.11), "edge 0.11 m is more than twice the thinnest side (0.05 m)");
    refused(body(SHV_MESH_BALL, 0.11), "more than twice the radius");
    refused(body(SHV_MESH_HOLLOW_BALL, 0.05), "thickness");
    refused(body(SHV_MESH_CYLINDER, 0.11), "thickness of the wall");
    refused(tube(0.05), "inner radius");
    for (int b = 0; b < BODY_COUNT; b++) {
        refused(any_body(b, 1e-5), "elements");
        refused(any_body(b, 1e-12), "elements");
        refused(any_body(b, 1e-300), "elements");
    }
    /* A fine notch in a coarse beam. */
    ShvMeshDefinition d = body(SHV_MESH_NOTCHED_BEAM, 0.01);
    d.notch_edge = 1e-5;
    refused(d, "elements");
    d.notch_edge = 1e-12;
    refused(d, "notch_edge 1e-12 m is too short");
    d.pattern = SHV_PATTERN_BRICKS;
    refused(d, "notch_edge 1e-12 m is less than a tenth of edge");
    d.notch_edge = 0.0;
    d.edge = 1e-6;
    refused(d, "elements");
}

static void notches_outside_the_beam_are_refused(void **state)
{
    (void)state;
    ShvMeshDefinition d = body(SHV_MESH_NOTCHED_BEAM, 0.01);
    d.notch_offset = 0.045;
    refused(d, "notch_offset 0.045 m puts the notch outside the beam");
    d.notch_offset = (double)NAN;
    refused(d, "notch_offset nan m");
    d.notch_offset = 0.0449;
    refused(d, "the notch is only 0.0001 m from the beam's surface");
    d = body(SHV_MESH_NOTCHED_BEAM, 0.01);
    d.notch_depth = 0.06;
    refused(d, "notch_depth 0.06 m must be less than the beam's height of 0.06 m");
    d.notch_depth = 0.0;
    refused(d, "notch_depth is 0 m");
    d.notch_depth = 0.0005;
    refused(d, "the notch tip or its bottom is only 0.0005 m");
    d = body(SHV_MESH_NOTCHED_BEAM, 0.01);
    d.notch_edge = -0.001;
    refused(d, "notch_edge is -0.001 m");
    d = body(SHV_MESH_NOTCHED_BEAM, 0.01);
    d.notch_growth = 0.0;
    refused(d, "notch_growth is 0");
    d.notch_growth = 0.9;
    refused(d, "notch_growth is 0.9, but must be positive and at most 0.8");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_converge),
        cmocka_unit_test(holes_take_their_volume),
        cmocka_unit_test(topology),
        cmocka_unit_test(quality_is_good),
        cmocka_unit_test(curved_surfaces_are_met_exactly),
        cmocka_unit_test(notch_is_a_slit),
        cmocka_unit_test(beam_is_graded),
        cmocka_unit_test(john_shah_beam_of_published_size),
        cmocka_unit_test(john_shah_beam_of_bricks),
        cmocka_unit_test(bricks_are_thinned_along_x),
        cmocka_unit_test(same_input_same_bits),
        cmocka_unit_test(bad_lengths_are_refused),
        cmocka_unit_test(edges_that_do_not_fit_are_refused),
        cmocka_unit_test(notches_outside_the_beam_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
