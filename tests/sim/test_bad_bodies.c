/* Bodies as they should not be, through whole runs with Bullet: overlaps at the start, obstacles inside objects, needles and
   flat tets, no mass. Handled or refused; never a number that is not finite, never more energy than gravity gave. */
#include "sim/stage.h"

#include <stdlib.h>
#include <unistd.h>

static const double cube[3] = {0.02, 0.02, 0.02};
static const double height = 0.06; /* of centres; they fall by 0.05 m */

static void begin(Stage *stage)
{
    stage_make(stage);
    stage->scene.rigid.engine = SHV_RIGID_BULLET;
    stage->scene.duration = 0.15;
    stage_floor(stage)->friction = 0.3;
}

/* Runs to the end; no body is ever faster than all energy of the fall allows. */
static void check_run(const Stage *stage)
{
    ShvSimulation *simulation = stage_start(stage);
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        double mass = 0.0;
        for (int32_t i = 0; i < frame->fragment_count; i++) {
            const ShvFragmentView *fragment = &frame->fragments[i];
            for (int k = 0; k < 3; k++) assert_true(isfinite(fragment->position[k]) && isfinite(fragment->velocity[k]));
            mass += fragment->mass;
        }
        assert_true(isfinite(frame->ledger.residual));
        /* plus the height of a body that lies down */
        assert_true(frame->ledger.kinetic <= mass * 9.81 * (height + 0.02));
    }
    shv_simulation_destroy(simulation);
}

/* Two objects in each other, by a part and entirely, at rest on the floor and falling: breaking or not. */
static void test_objects_that_overlap(void **state)
{
    (void)state;
    static const double shifts[] = {0.012, 0.0};
    for (int s = 0; s < 2; s++)
        for (int falls = 0; falls < 2; falls++)
            for (int breaks = 0; breaks < 2; breaks++) {
                Stage stage;
                begin(&stage);
                stage.scene.overlaps = SHV_OVERLAPS_KEEP;
                stage.material.breakable = breaks;
                stage_box(&stage, "one", cube, 0.02, falls ? height : 0.01);
                stage_box(&stage, "other", cube, 0.02, falls ? height : 0.01)->placement.position[0] = shifts[s];
                check_run(&stage);
            }
}

/* A pin inside an object, one at the rim, and one in the way of its fall. */
static void test_obstacle_inside_an_object(void **state)
{
    (void)state;
    static const double heights[] = {0.06, 0.0695, 0.045};
    for (int i = 0; i < 3; i++) {
        Stage stage;
        begin(&stage);
        stage.scene.overlaps = SHV_OVERLAPS_KEEP;
        stage_box(&stage, "one", cube, 0.02, height);
        ShvObstacleDefinition *pin = stage_floor(&stage);
        pin->name = "pin";
        pin->shape = SHV_OBSTACLE_SPHERE;
        pin->radius = 0.002;
        pin->placement.position[2] = heights[i];
        check_run(&stage);
    }
}

static void write_tets(char path[512], const char *nodes, const char *elements)
{
    const char *folder = getenv("TMPDIR");
    const char *const ends[2] = {"node", "ele"}, *const texts[2] = {nodes, elements};
    for (int i = 0; i < 2; i++) {
        snprintf(path, 512, "%s/shiver_bad_%ld.%s", folder ? folder : "/tmp", (long)getpid(), ends[i]);
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fputs(texts[i], file);
        fclose(file);
    }
    *strrchr(path, '.') = '\0';
}

static void remove_tets(const char *path)
{
    char name[520];
    snprintf(name, sizeof name, "%s.node", path);
    remove(name);
    snprintf(name, sizeof name, "%s.ele", path);
    remove(name);
}

/* A needle and a plate of one tet each, 1e4 times as long as thick: they fall, and lie. A tet without volume is refused. */
static void test_needle_and_flat_tet(void **state)
{
    (void)state;
    char path[512];
    write_tets(path,
               "8 3 0 0\n0 0 0 0\n1 1 0 0\n2 0.5 0.0001 0\n3 0.5 0 0.0001\n4 2 0 0\n5 2.1 0 0\n6 2 0.1 0\n7 2.03 0.03 "
               "0.00001\n",
               "2 4 0\n0 0 1 2 3\n1 4 5 6 7\n");
    for (int breaks = 0; breaks < 2; breaks++) {
        Stage stage;
        begin(&stage);
        stage.material.breakable = breaks;
        ShvObjectDefinition *object = stage_box(&stage, "thin", cube, 0.02, height);
        object->mesh.kind = SHV_MESH_TETGEN;
        object->mesh.file = path;
        check_run(&stage);
    }
    remove_tets(path);
    write_tets(path, "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0.5 1 0\n3 0.5 0.4 0\n", "1 4 0\n0 0 1 2 3\n");
    Stage stage;
    begin(&stage);
    ShvObjectDefinition *object = stage_box(&stage, "flat", cube, 0.02, height);
    object->mesh.kind = SHV_MESH_TETGEN;
    object->mesh.file = path;
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    check_fails(shv_simulation_create(&simulation, &stage.scene, NULL, &error), SHV_BAD_INPUT, error, "volume");
    assert_null(simulation);
    remove_tets(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_objects_that_overlap),
        cmocka_unit_test(test_obstacle_inside_an_object),
        cmocka_unit_test(test_needle_and_flat_tet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
