/* Memory that runs out anywhere, in our code or in a library: a message and an exit status, no signal, no silence. */
#include "cli/shell.h"

static const char tiny_scene[] =
    "shiver: 1\n"
    "name: tiny\n"
    "materials:\n"
    "  chalk: {density: 1200, youngs_modulus: 50e6, poissons_ratio: 0.2, fracture_energy: 0.5, cohesive_strength: "
    "50e3}\n"
    "objects:\n"
    "  bar: {mesh: {box: {size: [0.02, 0.02, 0.06], edge: 0.02}}, material: chalk, position: [0, 0, 0.031],\n"
    "        velocity: [0, 0, -0.3]}\n"
    "obstacles:\n"
    "  floor: {plane: {normal: [0, 0, 1], offset: 0}, friction: 0.3}\n"
    "duration: 0.005\n"
    "output: {rate: 1000}\n"
    "threads: 1\n";
static const char falls_case[] =
    "verification: 1\ntitle: a bar lands\nscene: tiny.yaml\nsource: none\n"
    "quantities:\n  - {name: steps, measure: last(frame.steps), reference: \"0\", compare: above}\n";
static const char study[] = "shiver_study: 1\nname: t\nvary: {duration: [2e-3]}\n"
                            "reference: {duration: 3e-3}\nmeasures: [dissipated]\n";

static int enter(void **state)
{
    if (shell_enter(state) != 0) return -1;
    shell_write("tiny.yaml", tiny_scene);
    shell_write("study.yaml", study);
    shell_write("falls.case.yaml", falls_case);
    shell_works("$shiver run tiny.yaml --output r.h5 --quiet", "");
    shell_works("$shiver study tiny.yaml study.yaml --output whole && $shiver verify ./falls.case.yaml", "");
    return 0;
}

/* Ends with a status of its own and a word, or with success. */
static void check_end(const char *command, long from, const char *all)
{
    char line[512];
    snprintf(line, sizeof line, "%s SHIVER_FAIL_FROM=%ld LD_PRELOAD='%s' $shiver %s", all, from, SHIVER_FAILING_MALLOC,
             command);
    const int status = shell(line);
    if (status < 0 || status > 2) fail_msg("%s ended with %d: %s", line, status, output.err);
    if (status != 0 && output.err[0] == '\0') fail_msg("%s failed without a word", line);
    if (strstr(output.err, "damaged")) fail_msg("%s takes the end of memory for damage: %s", line, output.err);
}

/* From early to late, closer together at the beginning, where the program sets up. Ends at the first that nothing fails any more. */
static void fail_from(const char *command, double factor, const char *all)
{
    enum { LATEST = 40000 };
    for (double from = 3.0; from < LATEST; from = factor * from + 1.0) check_end(command, (long)from, all);
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    static const char *const commands[] = {"run tiny.yaml --output m.h5 --force --quiet",
                                           "check tiny.yaml",
                                           "info --verify r.h5",
                                           "export csv r.h5 --force",
                                           "export xdmf r.h5 --force",
                                           "export svg r.h5 --force",
                                           "export gltf r.h5 --force",
                                           "plan tiny.yaml --trial 0",
                                           "verify ./falls.case.yaml",
                                           "study tiny.yaml study.yaml --output st --force"};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) fail_from(commands[i], 1.5, "SHIVER_FAIL_ALL=1");
}

static void test_one_allocation_fails(void **state)
{
    (void)state;
    fail_from("run tiny.yaml --output m.h5 --force --quiet", 1.25, "");
    fail_from("export xdmf r.h5 --force", 1.4, "");
    fail_from("survive tiny.yaml --shots 2 --output sv --force", 1.25, "");
}

/* Nor for damage; an allocation of ours in ten is one between HDF5 and the file, which HDF5 does not give the reason of. */
static void test_no_damage_is_seen(void **state)
{
    (void)state;
    for (long from = 200; from < 20000; from += 251) check_end("info --verify r.h5", from, "");
}

/* Out of memory is not taken for a fault of the scene. */
static void test_memory_is_named(void **state)
{
    (void)state;
    shell_fails("SHIVER_FAIL_ALL=1 SHIVER_FAIL_FROM=150 LD_PRELOAD=" SHIVER_FAILING_MALLOC " $shiver check tiny.yaml",
                1, "out of memory");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_memory_runs_out), cmocka_unit_test(test_one_allocation_fails),
        cmocka_unit_test(test_no_damage_is_seen), cmocka_unit_test(test_memory_is_named)};
    return cmocka_run_group_tests(tests, enter, shell_leave);
}
