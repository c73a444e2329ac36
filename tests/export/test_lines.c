/* Lines of descent as bodies, obstacles as triangles, and stress of a tet. */
#include "check.h"

#include "base/memory.h"
#include "export/obstacle_mesh.h"
#include "export/run.h"
#include "export/tet_stress.h"
#include "files.h"

enum { FRAMES = 8, BRICKS = 4 };

static ShvRunFile *open_run(void *folder)
{
    ShvError error;
    ShvRunFile *file;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(folder, "run.h5");
    record_frames(&definition, FRAMES);
    check_ok(shv_run_file_open(&file, definition.path, NULL, &error), error);
    return file;
}

/* At every frame, every living fragment is where the lines that descend from it say: their points move with it. */
static void test_lines_move_with_what_lives(void **state)
{
    ShvError error;
    ShvLines lines;
    ShvRunFile *file = open_run(*state);
    check_ok(shv_lines_create(&lines, file, NULL, NULL, &error), error);
    assert_int_equal(lines.count, BRICKS);
    for (int64_t frame = 0; frame < FRAMES; frame++) {
        check_ok(shv_lines_move(&lines, frame, &error), error);
        for (int32_t e = 0; e < 2 * BRICKS; e++) {
            const int32_t line = shv_lines_of(&lines, e), node = lines.pieces.elements[4 * e];
            const ShvPose pose = shv_lines_pose(&lines, line);
            const ShvVec3 rest = shv_load3(lines.pieces.reference + 3 * node);
            const ShvVec3 here =
                shv_add(pose.position, shv_rotate(pose.orientation, shv_sub(rest, shv_lines_centre(&lines, line))));
            const ShvVec3 expected = shv_pieces_point(&lines.pieces, lines.pieces.owner[e], node);
            assert_true(pose.lives);
            check_near(shv_norm(shv_sub(here, expected)), 0.0, 1e-14); /* rounding of numbers up to 5 */
        }
    }
    shv_lines_release(&lines);
    shv_run_file_close(file);
}

/* Faces of a line surround its volume. */
static void test_faces_surround_volumes(void **state)
{
    ShvError error;
    ShvLines lines;
    ShvRunFile *file = open_run(*state);
    check_ok(shv_lines_create(&lines, file, NULL, NULL, &error), error);
    for (int32_t line = 0; line < lines.count; line++) {
        double volume = 0.0;
        assert_int_equal(lines.begin[line + 1] - lines.begin[line], 6);
        for (int64_t f = lines.begin[line]; f < lines.begin[line + 1]; f++)
            volume += shv_dot(shv_lines_corner(&lines, lines.face[f], 0),
                              shv_cross(shv_lines_corner(&lines, lines.face[f], 1),
                                        shv_lines_corner(&lines, lines.face[f], 2))) /
                      6.0;
        check_near(volume, 0.5, 18.0 * 125.0 * 2.3e-16); /* rounding of 18 products of numbers up to 5 */
    }
    shv_lines_release(&lines);
    shv_run_file_close(file);
}

/* Closed surfaces, their triangles counter-clockwise from outside: volume by the divergence theorem. */
static void test_obstacles_face_outwards(void **state)
{
    ShvError error;
    ShvLines lines;
    ShvObstacleMesh *meshes;
    ShvRunFile *file = open_run(*state);
    check_ok(shv_lines_create(&lines, file, NULL, NULL, &error), error);
    check_ok(shv_obstacle_meshes_create(&meshes, &lines.pieces, NULL, &error), error);
    const ShvObstacleMesh *floor_mesh = &meshes[0], *hammer = &meshes[1];
    assert_int_equal(floor_mesh->node_count, 4);
    for (int i = 0; i < 4; i++) assert_true(floor_mesh->positions[3 * i + 2] == 0.0);
    double volume = 0.0;
    for (int32_t t = 0; t < hammer->triangle_count; t++) {
        ShvVec3 c[3];
        for (int k = 0; k < 3; k++) c[k] = shv_load3(hammer->positions + 3 * hammer->triangles[3 * t + k]);
        volume += shv_dot(c[0], shv_cross(c[1], c[2])) / 6.0;
    }
    check_near(volume, 1.0 / 6.0, 1e-15);
    shv_obstacle_meshes_release(meshes, 2);
    shv_lines_release(&lines);
    shv_run_file_close(file);
}

/* Stretched by 1e-6 along x and held across: σ = (λ + 2μ) ε. Turning the tet changes nothing. */
static void test_stress(void **state)
{
    (void)state;
    const ShvElasticity elasticity = {70e9, 0.2};
    const double rest[12] = {0, 0, 0, 1, 0, 0, 0, 2, 0, 0.5, 0, 1}, strain = 1e-6;
    const ShvQuat turn = shv_quat_unit((ShvQuat){0.3, 0.5, -0.2, 0.7});
    double now[12], inverted[12];
    for (int i = 0; i < 4; i++) {
        const ShvVec3 x = shv_load3(rest + 3 * i);
        shv_store3(now + 3 * i, shv_rotate(turn, shv_vec3((1.0 + strain) * x.x, x.y, x.z)));
        shv_store3(inverted + 3 * i, shv_vec3(-x.x, x.y, x.z));
    }
    const double modulus = 70e9 * 0.8 / (1.2 * 0.6);
    /* 1e-5 of it: the strain's square and rounding of coordinates over the strain. */
    check_near(shv_tet_stress(rest, now, elasticity), modulus * strain, 1e-5 * modulus * strain);
    check_near(shv_tet_stress(rest, rest, elasticity), 0.0, 0.0);
    assert_true(isnan(shv_tet_stress(rest, inverted, elasticity)));
    assert_true(isnan(shv_tet_stress((const double[12]){0}, now, elasticity)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_lines_move_with_what_lives, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_faces_surround_volumes, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_obstacles_face_outwards, make_folder, remove_folder),
        cmocka_unit_test(test_stress),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
