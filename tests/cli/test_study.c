/* `shiver study` as its users meet it: tables, files, going on after a kill, tasks, picks. */
#include "bounce.h"
#include "cli/json.h"
#include "cli/shell.h"

/* The errors of PBD are above a centimetre, those of the others below a micrometre. */
static const char bounce_study[] = "shiver_study: 1\nname: bounce study\n"
                                   "vary: {rigid.engine: [analytic, pbd], rigid.time_step: [1e-2, 1e-3]}\n"
                                   "reference: closed form\nmeasures: [position, energy]\n";
static const char ball_scene[] =
    "shiver: 1\nname: ball\n"
    "materials: {m: {density: 1200, youngs_modulus: 5 GPa, poissons_ratio: 0.2, fracture_energy: 10, "
    "cohesive_strength: 2.5 MPa}}\n"
    "objects:\n  ball: {mesh: {ball: {radius: 0.05, edge: 0.03}, jitter: 0.1, seed: 1}, material: m,\n"
    "         position: [0, 0, 0.051], velocity: [0, 0, -8]}\n"
    "obstacles: {floor: {plane: {normal: [0, 0, 1]}, friction: 0.5}}\n"
    "rigid: {engine: analytic}\nduration: 0.8 ms\noutput: {rate: 5000}\nthreads: 1\n";
static const char ball_study[] =
    "shiver_study: 1\nvary: {step: [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4]}\nreference: {step: 0.05}\n"
    "measures: [dissipated, failed_overlap, crack_distance, fragments, masses, impulse]\n";

static int enter(void **state)
{
    if (shell_enter(state) != 0) return -1;
    shell_write("bounce.yaml", bounce_scene);
    shell_write("b.yaml", bounce_study);
    shell_write("ball.yaml", ball_scene);
    shell_write("s.yaml", ball_study);
    return 0;
}

static void test_table(void **state)
{
    (void)state;
    shell_works("$shiver study bounce.yaml b.yaml",
                "errors from closed form (bounce of box on floor); * on the Pareto front\n");
    assert_non_null(strstr(output.out, "\nanalytic, 1e-2 "));
    assert_non_null(strstr(output.out, "wrote b/report.html"));
    assert_null(strstr(output.out, "not valid"));
    assert_non_null(strstr(output.err, "running pbd, 1e-3"));
    shell_works(
        "ls b | tr '\\n' ' '",
        "cost.svg error_energy.svg error_position.svg report.html results.csv runs study.json table.md timings.csv ");
    shell_works("grep -c '^| ' b/table.md", "5\n");
    /* Everything is there: nothing is run. */
    shell_works("$shiver study bounce.yaml b.yaml --json", "\"study\": \"bounce study\"");
    assert_string_equal(output.err, "");
    assert_true(json_valid(output.out));
    shell_works("cat b/study.json", "{");
    assert_true(json_valid(output.out));
    shell_works("$shiver study bounce.yaml b.yaml --force --set duration=0.1 --output short",
                "wrote short/report.html");
    shell_works("grep -o 'shiver study bounce.yaml b.yaml --set .duration=0.1.' short/report.html", "shiver study");
}

static void test_pick(void **state)
{
    (void)state;
    shell_works("$shiver study bounce.yaml b.yaml --pick error=1e-3", "pick: rigid.engine=analytic");
    assert_non_null(strstr(output.out, "error of position"));
    shell_works("$shiver study bounce.yaml b.yaml --pick energy=0.01", "error of energy");
    shell_fails("$shiver study bounce.yaml b.yaml --pick position=1e-300", 1, "no setting has an error of position");
    shell_fails("$shiver study bounce.yaml b.yaml --pick apex=1", 2, "does not measure 'apex'");
    shell_fails("$shiver study bounce.yaml b.yaml --pick 0.1", 2, "--pick needs error=LARGEST");
    shell_fails("$shiver study bounce.yaml b.yaml --pick error=x", 2, "--pick needs error=LARGEST");
}

/* Killed in the middle, it goes on, and the results are those of a study that was not. */
static void test_kill(void **state)
{
    (void)state;
    shell_works("$shiver study ball.yaml s.yaml --output whole", "wrote whole/report.html");
    shell_works("$shiver study ball.yaml s.yaml --output killed >/dev/null 2>&1 & pid=$!\n"
                "while [ \"$(ls killed/runs 2>/dev/null | grep -c 'run$')\" -lt 3 ]; do sleep 0.01; done\n"
                "kill -9 $pid; wait $pid; ls killed/runs | grep -c 'run$'",
                "");
    const int done = atoi(output.out);
    assert_true(done >= 3 && done <= 8);
    if (done < 8) assert_int_not_equal(access("killed/report.html", F_OK), 0);
    shell_works("$shiver study ball.yaml s.yaml --output killed", "wrote killed/report.html");
    int runs = 0;
    for (const char *at = output.err; (at = strstr(at, "running")) != NULL; at++) runs++;
    assert_int_equal(runs, 8 - done);
    shell_works("cmp whole/results.csv killed/results.csv && echo same", "same");
}

static void test_tasks(void **state)
{
    (void)state;
    shell_works("for i in 2 4 1; do $shiver study ball.yaml s.yaml --output parts --task $i/4 || exit 1; done", "");
    shell_fails("$shiver study ball.yaml s.yaml --output parts --merge", 2, "2 of 8 runs are missing");
    assert_int_not_equal(access("parts/report.html", F_OK), 0);
    shell_works("$shiver study ball.yaml s.yaml --output parts --task 3/4", "");
    assert_string_equal(output.out, "");
    shell_works("$shiver study ball.yaml s.yaml --output parts --merge", "wrote parts/report.html");
    assert_null(strstr(output.err, "running"));
    shell_works("cmp whole/results.csv parts/results.csv && echo same", "same");
}

static void test_jobs(void **state)
{
    (void)state;
    shell_works("$shiver study ball.yaml s.yaml --output jobs -j 3", "run times are not valid");
    shell_works("cmp whole/results.csv jobs/results.csv && echo same", "same");
    shell_works("grep -c ',no,' jobs/timings.csv", "8\n");
    shell_works("grep -c 'Run times are not valid' jobs/report.html", "1\n");
    shell_fails("$shiver study ball.yaml s.yaml --output jobs --merge --pick error=1", 2,
                "run times of this study are not valid");
    /* Alone, it measures the times again. */
    shell_works("$shiver study ball.yaml s.yaml --output jobs --set threads=1 --pick error=100", "pick: step=");
}

static void test_bad_input(void **state)
{
    (void)state;
    static const struct {
        const char *command;
        int status;
        const char *part;
    } cases[] = {
        {"study bounce.yaml", 2, "it needs SCENE STUDY"},
        {"study bounce.yaml none.yaml", 2, "none.yaml"},
        {"study none.yaml b.yaml", 2, "none.yaml"},
        {"study bounce.yaml bounce.yaml", 2, "bounce.yaml:1:1: error: unknown key 'shiver' in the study; did you mean"},
        {"study bounce.yaml b.yaml --set rigid.tme_step=1", 2, "did you mean"},
        {"study bounce.yaml b.yaml --task 3", 2, "--task needs I/N"},
        {"study bounce.yaml b.yaml --task 0/3", 2, "--task needs I/N"},
        {"study bounce.yaml b.yaml --task 4/3", 2, "--task needs I/N"},
        {"study bounce.yaml b.yaml -j 0", 2, "--jobs needs a number"},
        {"study bounce.yaml b.yaml -j x", 2, "--jobs needs a number"},
        {"study bounce.yaml b.yaml -j 2 --merge", 2, "only one"},
        {"study bounce.yaml b.yaml --task 1/2 --pick error=1", 2, "--pick needs all runs"},
        {"study bounce.yaml b.yaml --output none/none", 1, "cannot make the folder"},
        {"study bounce.yaml b.yaml --merge --output empty", 2, "4 of 4 runs are missing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char line[300];
        snprintf(line, sizeof line, "$shiver %s", cases[i].command);
        shell_fails(line, cases[i].status, cases[i].part);
        assert_null(strstr(output.err, "running"));
    }
}

/* Those of the project can be read; their runs are long. */
static void test_studies_of_the_project(void **state)
{
    (void)state;
    shell_works("set -e\n"
                "for pair in rigid/torque_free_top:top rigid/bouncing_ball:bounce sphere_drop:sphere_drop "
                "studies/glass_tile:tile thesis/fig_6_6_slow_beam:beam; do\n"
                "  $shiver study $scenes/${pair%:*}.yaml $scenes/studies/${pair#*:}.yaml --merge --output p 2>err.txt "
                "&& exit 1\n"
                "  grep -q 'runs are missing' err.txt || { cat err.txt; exit 1; }\n"
                "done; echo read",
                "read");
    shell_works("cat $scenes/studies/*.yaml | grep -c '^shiver_study: 1'", "5\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_pick),
        cmocka_unit_test(test_kill),
        cmocka_unit_test(test_tasks),
        cmocka_unit_test(test_jobs),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_studies_of_the_project),
    };
    return cmocka_run_group_tests(tests, enter, shell_leave);
}
