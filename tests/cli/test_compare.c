/* `shiver compare` as its users meet it, and every scene of scenes/rigid run by it. */
#include "cli/json.h"
#include "cli/shell.h"

static const char bounce_scene[] =
    "shiver: 1\n"
    "name: bounce\n"
    "materials: {m: {density: 1000, youngs_modulus: 1e6, poissons_ratio: 0.3, breakable: false}}\n"
    "objects: {box: {mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.1}}, material: m, position: [0, 0, 0.25]}}\n"
    "obstacles: {floor: {plane: {normal: [0, 0, 1]}, restitution: 0.5}}\n"
    "duration: 0.3\n"
    "reference: {law: bounce, body: box, on: floor}\n"
    "threads: 1\n";

static int enter(void **state)
{
    if (shell_enter(state) != 0) return -1;
    shell_write("bounce.yaml", bounce_scene);
    return 0;
}

static void test_table(void **state)
{
    (void)state;
    shell_works("$shiver compare bounce.yaml --steps 1e-2,1e-3", "errors from closed form (bounce of box on floor)");
    assert_non_null(strstr(output.out, "\nbullet, 0.01 "));
    assert_non_null(strstr(output.out, "\nbullet_plain, 0.001 "));
    assert_non_null(strstr(output.out, "\npbd, 0.001 "));
    assert_non_null(strstr(output.out, "wrote bounce/report.html"));
    assert_non_null(strstr(output.err, "running pbd, 0.001"));
    shell_works("grep -c '^analytic,' bounce/results.csv", "2\n");
    shell_works("ls bounce", "error_position.svg");
    /* What has been run is not run again. */
    shell_works("$shiver compare bounce.yaml --steps 1e-2,1e-3", "\nbullet, 0.01 ");
    assert_string_equal(output.err, "");
    shell_works("$shiver compare bounce.yaml --steps .01 --engines analytic --force", "\nanalytic, 0.01 ");
    assert_null(strstr(output.out, "bullet"));
    assert_non_null(strstr(output.err, "running"));
    shell_works("$shiver compare bounce.yaml --steps .01 --engines analytic --json", "\"results\"");
    assert_true(json_valid(output.out));
}

static void test_without_closed_form(void **state)
{
    (void)state;
    shell_works("sed /reference/d bounce.yaml >none.yaml; $shiver compare none.yaml --steps 1e-2,1e-3",
                "errors from run of analytic, 0.001");
    assert_non_null(strstr(output.out, "(reference)"));
    shell_fails("$shiver compare none.yaml --force --engines pbd", 2, "add bullet or analytic");
    /* Bodies that could meet need an engine in which they do. */
    shell_works("$shiver compare none.yaml --force --steps 1e-2 --set 'obstacles.ball={sphere: {radius: 0.1}, mass: 1, "
                "position: [1, 0, 1]}'",
                "errors from run of bullet, 0.01");
}

static void test_bad_input(void **state)
{
    (void)state;
    static const struct {
        const char *options, *part;
    } cases[] = {
        {"--steps", "--steps needs a value"},
        {"--steps ''", "--steps needs times"},
        {"--steps 1e-2,", "--steps needs times"},
        {"--steps 1e-2,,1e-3", "--steps needs times"},
        {"--steps 1ms", "--steps needs times"},
        {"--steps -1", "--steps needs times"},
        {"--steps 0", "--steps needs times"},
        {"--steps nan", "--steps needs times"},
        {"--steps inf", "--steps needs times"},
        {"--steps 1e-999", "--steps needs times"},
        {"--steps 1e-2,0.01", "given twice"},
        {"--steps 5", "at most the duration"},
        {"--steps 1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17", "at most 16"},
        {"--engines ''", "list of values is empty"},
        {"--engines bulet", "expected bullet, bullet_plain"},
        {"--engines bullet,bullet", "given twice"},
        {"--engines bullet,bullet_plain,pbd,analytic,pbd", "given twice"},
        {"--set reference.law=fly", "flight"},
        {"--set reference.body=bax", "did you mean 'box'"},
        {"--set reference.body=floor", "not free to move"},
        {"--set reference.on=flor", "no obstacle 'flor'"},
        {"--set reference.on=box", "plane"},
        {"--set reference.law=rest", "remove 'on'"},
        {"--set 'reference={law: bounce, on: floor}'", "needs 'body'"},
        {"--set 'reference={law: slide, body: box}'", "needs 'on'"},
        {"--set 'gravity=[1, 0, 0]'", "straight on to 'floor'"},
        {"--set 'materials.m={density: 1, youngs_modulus: 1, poissons_ratio: 0, fracture_energy: 1, cohesive_strength: "
         "0.1}'",
         "can break"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char line[400];
        snprintf(line, sizeof line, "$shiver compare bounce.yaml --output bad %s", cases[i].options);
        shell_fails(line, 2, cases[i].part);
        assert_string_equal(output.out, "");
        assert_int_not_equal(access("bad", F_OK), 0);
    }
    shell_fails("$shiver compare missing.yaml", 2, "missing.yaml");
    shell_fails("$shiver compare bounce.yaml --output /dev/null/a", 1, "/dev/null");
}

/* Each scene at one step of 10 ms, and how far Bullet and the analytic engine may be from its closed form: in the column of
   results.csv that matters, a percent of what happens in the scene. */
static void test_rigid_scenes(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *engines, *limits;
    } cases[] = {
        {"free_fall", "bullet,analytic", "$12+0 < 1e-10"},
        {"torque_free_top", "bullet,analytic", "$12+0 < 1e-6 && $14+0 < 1e-8 && $15+0 == 0 && $16+0 < 1e-3"},
        {"torque_free_top --set bullet_plain.exact_flight=true", "bullet_plain", "$12+0 < 1e-9 && $15+0 == 0"},
        {"bouncing_ball --set bullet_plain.exact_flight=true --set bullet_plain.sharp_impacts=true", "bullet_plain",
         "$13+0 < 1e-9 && $15+0 == 0"},
        {"bouncing_ball", "bullet,analytic", "$15+0 == 0 && $16 != \"\" && $16+0 < 4.5e-3 && $17+0 < 0.01"},
        {"block_on_incline", "bullet,analytic", "$8+0 < 0.0118"},
        {"block_on_incline --set obstacles.slope.friction=0.6", "bullet,analytic", "$8+0 < 1e-4"},
        {"rolling_ball", "bullet,analytic", "$8+0 < 0.0175"},
        {"slip_to_roll", "bullet,analytic", "$8+0 < 0.0151"},
        {"stack_of_boxes", "bullet", "$8+0 < 1e-3"},
        {"mass_ratio --set materials.neutronium.density=1e5", "bullet", "$8+0 < 1e-3"},
        {"pile --set duration=0.25", "bullet", "$13+0 < 1e-3"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char line[600];
        const size_t name = strcspn(cases[i].scene, " ");
        snprintf(
            line, sizeof line,
            "$shiver compare $scenes/rigid/%.*s.yaml%s --steps 1e-2 --engines %s --output scene --force >table.txt "
            "&& awk -F, 'NR > 1 && !(%s) { bad = 1; print } END { exit bad }' scene/results.csv && echo kept",
            (int)name, cases[i].scene, cases[i].scene + name, cases[i].engines, cases[i].limits);
        shell_works(line, "kept");
        assert_null(strstr(output.err, "warning"));
    }
    /* All are named above, and all can be checked. */
    shell_works("ls $scenes/rigid/*.yaml | wc -l", "9\n");
    shell_works("for scene in $scenes/rigid/*.yaml; do $shiver check $scene >/dev/null || exit 1; done; echo kept",
                "kept");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_without_closed_form),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_rigid_scenes),
    };
    return cmocka_run_group_tests(tests, enter, shell_leave);
}
