/* Surfaces whose triangles share vertices: closed, and apart where tets only touch. */
#include "check.h"

#include "export/run.h"
#include "export/vertices.h"
#include "files.h"

enum { FRAMES = 8, BRICKS = 4, FACES = 6, CORNERS = 5 }; /* of two tets with a face in common */

typedef struct Fixture {
    ShvRunFile *file;
    ShvLines lines;
    ShvVertices vertices;
} Fixture;

static void open_run(Fixture *f, void *folder)
{
    ShvError error;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(folder, "run.h5");
    record_frames(&definition, FRAMES);
    check_ok(shv_run_file_open(&f->file, definition.path, NULL, &error), error);
    check_ok(shv_lines_create(&f->lines, f->file, NULL, NULL, &error), error);
}

static void make_vertices(Fixture *f)
{
    ShvError error;
    check_ok(shv_vertices_create(&f->vertices, &f->lines, &error), error);
}

static void close_run(Fixture *f)
{
    shv_vertices_release(&f->vertices);
    shv_lines_release(&f->lines);
    shv_run_file_close(f->file);
}

/* How often the triangles of a line run along an edge from one vertex to the other. */
static int uses(const Fixture *f, int32_t line, int32_t from, int32_t to)
{
    int count = 0;
    for (int64_t face = f->lines.begin[line]; face < f->lines.begin[line + 1]; face++)
        for (int k = 0; k < 3; k++)
            count += f->vertices.corners[3 * face + k] == from && f->vertices.corners[3 * face + (k + 1) % 3] == to;
    return count;
}

static void check_closed(const Fixture *f, int32_t line)
{
    const int32_t count = (int32_t)shv_vertices_count(&f->vertices, line);
    for (int32_t a = 0; a < count; a++)
        for (int32_t b = 0; b < count; b++) {
            assert_int_equal(uses(f, line, a, b), uses(f, line, b, a));
            assert_true(uses(f, line, a, b) <= 1);
        }
}

/* Every vertex once, where the corners of its triangles are. */
static void test_triangles_share_vertices(void **state)
{
    Fixture f;
    open_run(&f, *state);
    make_vertices(&f);
    for (int32_t line = 0; line < BRICKS; line++) {
        assert_int_equal(shv_vertices_count(&f.vertices, line), CORNERS);
        check_closed(&f, line);
        const ShvVec3 centre = shv_lines_centre(&f.lines, line);
        for (int64_t i = 3 * f.lines.begin[line]; i < 3 * f.lines.begin[line + 1]; i++) {
            const ShvVec3 corner = shv_lines_corner(&f.lines, f.lines.face[i / 3], (int)(i % 3));
            const ShvVec3 vertex = shv_vertices_place(&f.vertices, &f.lines, line, f.vertices.corners[i]);
            check_near(shv_norm(shv_sub(vertex, shv_sub(corner, centre))), 0.0, 0.0);
        }
    }
    close_run(&f);
}

/* Two bricks of one piece that have a node in common and nothing else: the node is two vertices. */
static void test_tets_that_only_touch(void **state)
{
    Fixture f;
    open_run(&f, *state);
    ShvPieces *pieces = &f.lines.pieces;
    assert_true(shv_lines_of(&f.lines, 0) == 0 && shv_lines_of(&f.lines, 2) == 1); /* the first two bricks */
    const int32_t touching = pieces->elements[8];
    for (int i = 8; i < 16; i++)
        if (pieces->elements[i] == touching) pieces->elements[i] = pieces->elements[0];
    for (int tet = 2; tet < 4; tet++) pieces->owner[tet] = pieces->owner[0];
    f.lines.begin[1] = f.lines.begin[2]; /* the first line has the faces of both */
    make_vertices(&f);
    assert_int_equal(f.lines.begin[1] - f.lines.begin[0], 2 * FACES);
    assert_int_equal(shv_vertices_count(&f.vertices, 0), 2 * CORNERS);
    assert_int_equal(shv_vertices_count(&f.vertices, 1), 0);
    check_closed(&f, 0);
    close_run(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_triangles_share_vertices, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_tets_that_only_touch, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
