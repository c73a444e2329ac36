/* From what height a small tile breaks: tables that go on, tasks, bounds, bad input. */
#include <math.h>

#include "cli/command.h"
#include "cli/json.h"
#include "cli/shell.h"

static const char tile[] =
    "shiver: 1\nduration: 0.4 ms\n"
    "materials:\n  plaster: {density: 1200, youngs_modulus: 5 GPa, poissons_ratio: 0.2, fracture_energy: 10,\n"
    "    fracture_energy_shear: 50, cohesive_strength: 2.5 MPa, cohesive_strength_shear: 12.5 MPa, ppr_shape: 2,\n"
    "    weibull: {modulus: 5}}\n"
    "objects: {tile: {mesh: {box: {size: [0.06, 0.02, 0.01], edge: 0.01}}, material: plaster, position: [0, 0, 5.1 "
    "mm],\n"
    "  rotation: {axis: [0, 1, 0], angle: 3}}}\n"
    "obstacles: {floor: {plane: {normal: [0, 0, 1], offset: -2 mm}}}\n"
    "output: {rate: 1e5}\nsurvival: {broken: 0.9}\n";

static int enter(void **state)
{
    if (shell_enter(state) != 0) return -1;
    shell_write("tile.yaml", tile);
    return 0;
}

static void same_table(const char *a, const char *b)
{
    char line[256];
    snprintf(line, sizeof line, "cmp %s %s", a, b);
    shell_works(line, "");
}

/* An interval around the middle, all shots in the table, pictures in the page. */
static void test_search(void **state)
{
    (void)state;
    shell_works("$shiver survive tile.yaml -o whole --shots 14 --heights 0.1,50 --set threads=1", "half break from");
    shell_works("grep -c . whole/shots-1-of-1.csv", "16\n");
    shell_works("grep -c '<svg' whole/report.html", "");
    assert_true(atoi(output.out) >= 4);
    shell_works("$shiver survive tile.yaml -o whole --shots 14 --heights 0.1,50 --set threads=1 -q --json",
                "\"h50\": ");
    assert_true(json_valid(output.out));
    const double h50 = atof(strstr(output.out, "\"h50\": ") + 7);
    const double low = atof(strstr(output.out, "\"h50_low\": ") + 11);
    assert_true(h50 > 0.1 && h50 < 50.0 && low < h50);
    /* Nothing was shot again. */
    assert_string_equal(output.err, "");
}

/* A table that was broken off in a line, and one that ended, go on to the same shots. */
static void test_goes_on(void **state)
{
    (void)state;
    shell_works("$shiver survive tile.yaml -o part --shots 5 --heights 0.1,50 --set threads=1", "5 shots");
    shell_works("head -c -20 part/shots-1-of-1.csv >torn && mv torn part/shots-1-of-1.csv", "");
    shell_works("$shiver survive tile.yaml -o part --shots 14 --heights 0.1,50 --set threads=1", "14 shots");
    same_table("part/shots-1-of-1.csv", "whole/shots-1-of-1.csv");
    shell_fails("$shiver survive tile.yaml -o part --set seed=3", 2, "of another scene");
    shell_works("echo 1,x >>part/shots-1-of-1.csv", "");
    shell_fails("$shiver survive tile.yaml -o part --set threads=1", 2, "part/shots-1-of-1.csv:17");
}

/* Tasks of a batch array together are what jobs at a time are. */
static void test_tasks(void **state)
{
    (void)state;
    shell_works("for i in 1 2; do $shiver survive tile.yaml -o tasks --shots 5 --task $i/2 --heights 0.1,50 "
                "--set threads=1 -q; done; $shiver survive tile.yaml -o tasks --merge --set threads=1",
                "10 shots");
    shell_works("$shiver survive tile.yaml -o jobs --shots 10 -j 2 --heights 0.1,50 --set threads=1", "10 shots");
    same_table("tasks/shots.csv", "jobs/shots.csv");
    shell_fails("mkdir empty; $shiver survive tile.yaml -o empty --merge", 2, "no shots");
}

static void test_never_and_always(void **state)
{
    (void)state;
    shell_works("$shiver survive tile.yaml -o never --heights 0.001,0.01 --shots 6 --set threads=1", "never: ");
    shell_works("$shiver survive tile.yaml -o always --heights 500,600 --shots 6 --set threads=1", "always: ");
}

static void test_staircase(void **state)
{
    (void)state;
    shell_works("$shiver survive tile.yaml -o stairs --standard d2463 --first 3 --step 1 --shots 8 --set threads=1",
                "ASTM D2463");
    shell_works("cut -d, -f1 stairs/staircase.csv | tail -n +3 | tr '\\n' ' '", "0 1 2 3 4 5 6 7");
}

static void test_bad_input(void **state)
{
    (void)state;
    static const struct {
        const char *options, *message;
    } cases[] = {{"--heights 0,1", "heights are positive"},
                 {"--heights 2,1", "the lowest first"},
                 {"--heights 2", "LOWEST,HIGHEST"},
                 {"--first -1", "first height"},
                 {"--shots 0", "1 to 1000000"},
                 {"--until 0.5", "a factor above 1"},
                 {"--standard d5276", "knows d2463"},
                 {"--step 1", "--standard d2463"},
                 {"--task 3/2", "--task"},
                 {"--task 1/2 --merge", "only one"},
                 {"--set survival.broken=1", "survival.broken"},
                 {"--set survival.object=cup", "no object 'cup'"},
                 {"--set survival.vary=speed", "velocity"},
                 {"--set gravity=[0,0,0]", "without gravity"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char line[256];
        snprintf(line, sizeof line, "$shiver survive tile.yaml -o bad %s", cases[i].options);
        shell_fails(line, 2, cases[i].message);
    }
    shell_works("ls -d bad 2>/dev/null || echo none", "none");
}

/* Turned bodies keep their foremost point where the scene's is: none starts in the floor or far above it. */
static void test_turned(void **state)
{
    (void)state;
    shell_works(
        "$shiver survive tile.yaml -o turned --shots 3 --heights 0.1,50 --set threads=1 --set survival.turn=true",
        "3 shots");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_search),           cmocka_unit_test(test_goes_on),   cmocka_unit_test(test_tasks),
        cmocka_unit_test(test_never_and_always), cmocka_unit_test(test_staircase), cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_turned),
    };
    return cmocka_run_group_tests(tests, enter, shell_leave);
}
