/* Runs that are stopped, go on and are made longer: their files are those of runs that never stopped. */
#include "cli/shell.h"

static const char balls[] =
    "shiver: 1\n"
    "materials: {plaster: {density: 1600, youngs_modulus: 3e9, poissons_ratio: 0.2, fracture_energy: 10, "
    "cohesive_strength: 2e6}}\n"
    "objects:\n"
    "  left: {mesh: {ball: {radius: 0.03, edge: 20 mm}, jitter: 0.1, seed: 1}, material: plaster, "
    "position: [-0.035, 0, 0], velocity: [4, 0, 0]}\n"
    "  right: {mesh: {ball: {radius: 0.03, edge: 20 mm}, jitter: 0.1, seed: 2}, material: plaster, "
    "position: [0.035, 0.01, 0], velocity: [-4, 0, 0]}\n"
    "gravity: [0, 0, 0]\n"
    "rigid: {engine: bullet, time_step: 1e-3}\n"
    "duration: 0.02\n"
    "threads: 1\n"
    "output: {rate: 500}\n";

static int enter(void **state)
{
    if (shell_enter(state) != 0) return -1;
    shell_write("balls.yaml", balls);
    return shell(
        "$shiver run balls.yaml --output whole.h5 && $shiver info whole.h5 | grep -o 'all frames.*' > whole.txt");
}

/* The file verifies and has the frames of the run that never stopped. */
static void check_whole(const char *name)
{
    char line[300];
    snprintf(
        line, sizeof line,
        "$shiver info --verify %s && $shiver info %s | grep -o 'all frames.*' | cmp - whole.txt && $shiver info %s",
        name, name, name);
    shell_works(line, "finished");
}

static void test_stopped_at_signals(void **state)
{
    static const char *const signals[] = {"INT", "TERM", "HUP", "XCPU", "KILL"};
    (void)state;
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        char line[400];
        /* Later and later, until the run comes to its end. By KILL `timeout` ends, too, perhaps before the program has let go of its
           file. */
        snprintf(line, sizeof line,
                 "rm -f run.h5*; for wait in 0.05 0.1 0.15 0.2 0.25 0.3 1 100; do "
                 "timeout -s %s $wait $shiver run balls.yaml --output run.h5 --checkpoint 0.01 --resume; end=$?; "
                 "test $end = 0 && break; test $end = 2 && exit 9; test $end = 137 && sleep 0.3; done; test $end = 0",
                 signals[i]);
        shell_works(line, "");
        check_whole("run.h5");
    }
}

static void test_made_longer(void **state)
{
    (void)state;
    shell_works("$shiver run balls.yaml --output long.h5 --until 0.008 --checkpoint 0.001", "finished: t = 0.008 s");
    shell_works("test $(ls long.h5.checkpoint-* | wc -l) = 1", "");
    shell_works("$shiver run balls.yaml --output long.h5 --until 12ms --resume || test $? = 2", "");
    shell_works("$shiver run balls.yaml --output long.h5 --until 0.012 --resume", "finished: t = 0.012 s");
    shell_works("$shiver run long.h5 --resume --until 0.02", "finished: t = 0.02 s");
    check_whole("long.h5");
    shell_works("$shiver run long.h5 --resume", "finished before: t = 0.02 s");
    shell_works("$shiver run long.h5 --resume --until 0.01 --json", "\"status\": \"finished\"");
    check_whole("long.h5");
    /* The file remembers how long it is to be. */
    shell_works("$shiver run long.h5 --resume --until 0.022", "finished: t = 0.022 s");
    shell_works("$shiver run long.h5 --resume", "finished before: t = 0.022 s");
}

/* Also where a signal ends the run. */
static void test_file_that_went_away(void **state)
{
    (void)state;
    shell_fails("$shiver run balls.yaml --output gone.h5 --quiet --until 1000 & "
                "until test -e gone.h5; do sleep 0.05; done; rm gone.h5; kill -TERM $!; wait $!",
                1, "was deleted or moved away");
    assert_non_null(strstr(output.err, "stopped at"));
}

static void test_refused(void **state)
{
    (void)state;
    shell_works("$shiver run balls.yaml --output other.h5 --until 0.008 --checkpoint 0.001 && cp other.h5 before.h5",
                "");
    shell_fails("$shiver run balls.yaml --output other.h5 --resume --set gravity=[0,0,-1]", 2, "another scene");
    shell_fails("$shiver run other.h5 --resume --set rigid.friction=0.9", 2, "another scene");
    shell_fails("$shiver run other.h5", 2, "is a run file");
    shell_fails("$shiver run other.h5 --force", 2, "is a run file");
    shell_works("cmp other.h5 before.h5", "");
    shell_fails("$shiver run balls.yaml --until soon", 2, "--until takes");
    shell_fails("$shiver run balls.yaml --checkpoint -1", 2, "--checkpoint takes");
    /* Damaged: both say so. */
    shell_works("for f in other.h5.checkpoint-*; do printf xxxx | dd of=$f bs=1 seek=5000 conv=notrunc; done", "");
    shell_fails("$shiver run balls.yaml --output other.h5 --resume", 2, "are damaged");
    /* Another run takes the place of the file, and its checkpoints go. */
    shell_works("$shiver run balls.yaml --output other.h5 --force && ! ls other.h5.*", "");
    check_whole("other.h5");
}

static void test_without_checkpoints(void **state)
{
    (void)state;
    shell_works("$shiver run balls.yaml --output new.h5 --resume", "finished");
    check_whole("new.h5");
    shell_works("! ls new.h5.*", "");
    shell_works("$shiver run balls.yaml --output new.h5 --resume", "finished before");
    shell_fails("$shiver run balls.yaml --output new.h5 --resume --set rigid.friction=0.9", 2, "exists already");
    shell_works("$shiver run balls.yaml --output plain.h5 --resume --set rigid.engine=bullet_plain --set "
                "bullet_plain.unit=0.01 --until 0.004",
                "finished");
    shell_works("$shiver run balls.yaml --output plain.h5 --resume --set rigid.engine=bullet_plain --set "
                "bullet_plain.unit=0.01 --until 0.006",
                "0.006");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stopped_at_signals),
        cmocka_unit_test(test_made_longer),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_file_that_went_away),
        cmocka_unit_test(test_without_checkpoints),
    };
    return cmocka_run_group_tests(tests, enter, shell_leave);
}
