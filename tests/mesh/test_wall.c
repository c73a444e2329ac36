#include "bodies.h"

#include "mesh/wall.h"

static ShvWall wall_of(const ShvMeshDefinition *d)
{
    ShvMesh mesh;
    ShvAdjacency adjacency;
    ShvError error;
    check_ok(make(&mesh, NULL, d, &error), error);
    check_ok(shv_adjacency_build(&adjacency, &mesh, &error), error);
    const ShvWall wall = shv_mesh_wall(&mesh, &adjacency, 0, mesh.element_count);
    shv_adjacency_release(&adjacency);
    shv_mesh_release(&mesh);
    return wall;
}

static ShvMeshDefinition plate(double edge, ShvMeshPattern pattern)
{
    ShvMeshDefinition d = body(SHV_MESH_BOX, edge);
    d.size[1] = 0.004;
    d.pattern = pattern;
    d.seed = 1;
    return d;
}

/* Its thickness is that of the box, whatever the tets in it; both large sides are wall, and of the rim no more than corners. */
static void plates_are_walls(void **state)
{
    (void)state;
    static const ShvMeshPattern patterns[2] = {SHV_PATTERN_LATTICE, SHV_PATTERN_UNSTRUCTURED};
    const double rim = 2.0 * (0.09 + 0.06) * 0.004, sides = 2.0 * 0.09 * 0.06;
    for (int i = 0; i < 2; i++)
        for (double edge = 0.003; edge < 0.008; edge += 0.002) {
            const ShvMeshDefinition d = plate(edge, patterns[i]);
            const ShvWall wall = wall_of(&d);
            check_near(wall.thickness, 0.004, 0.02 * 0.004);
            check_near(wall.edge, edge, 0.2 * edge); /* whole cells fit the box: edges are not quite those asked for */
            assert_true(wall.share >= sides / (sides + rim) - 1e-9);
            const double ratio = wall.edge / wall.thickness;
            check_near(shv_wall_stiffness(&wall, false), 1.0 + 1.3 * ratio * ratio, 1e-12);
            check_near(shv_wall_stiffness(&wall, true), 1.0 + 0.055 * ratio * ratio * ratio * ratio, 1e-12);
        }
}

/* Chords of 4 mm on a ball of 50 mm: its shell is flat enough to be a wall, and 20 mm thick. */
static void shells_are_as_thick_as_they_are(void **state)
{
    (void)state;
    const ShvMeshDefinition thick = body(SHV_MESH_HOLLOW_BALL, 0.009);
    const ShvWall wall = wall_of(&thick);
    check_near(wall.thickness, 0.02, 0.05 * 0.02);
    assert_true(wall.share > 0.4);
}

static void solid_bodies_have_none(void **state)
{
    (void)state;
    const ShvMeshDefinition ball = body(SHV_MESH_BALL, 0.009), box = body(SHV_MESH_BOX, 0.009);
    const ShvWall of_ball = wall_of(&ball), of_box = wall_of(&box);
    assert_true(of_ball.share < 0.02 && of_box.share < 0.02);
    check_near(shv_wall_stiffness(&(ShvWall){0}, false), 1.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plates_are_walls),
        cmocka_unit_test(shells_are_as_thick_as_they_are),
        cmocka_unit_test(solid_bodies_have_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
