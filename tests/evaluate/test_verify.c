#include "check.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "shiver/verify.h"

/* A block that falls for a tenth of a second, rigidly. */
static const char scene[] =
    "shiver: 1\n"
    "duration: 0.1\n"
    "materials: {stone: {density: 1000, youngs_modulus: 1e9, poissons_ratio: 0.2, breakable: false}}\n"
    "objects: {block: {mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.1}}, material: stone}}\n"
    "probes: {whole: {nodes: {object: block}}}\n";
static const char head[] = "verification: 1\ntitle: a fall\nscene: fall.yaml\nsource: G. Galilei\n";

static void write_text(const char *folder, const char *name, const char *first, const char *second)
{
    char path[300];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "%s%s", first, second);
    fclose(file);
}

static int make_folder(void **state)
{
    char *folder = malloc(64);
    strcpy(folder, "/tmp/shiver_verify_XXXXXX");
    assert_non_null(mkdtemp(folder));
    write_text(folder, "fall.yaml", scene, "");
    *state = folder;
    return 0;
}

static int remove_folder(void **state)
{
    static const char *const names[] = {"fall.yaml", "fall.case.yaml", "page.html", "page.md"};
    char path[300];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/%s", (const char *)*state, names[i]);
        unlink(path);
    }
    assert_int_equal(rmdir(*state), 0);
    free(*state);
    return 0;
}

static ShvStatus try_case(void **state, const char *rest, const ShvVerifyOptions *options, ShvVerification **made,
                          ShvError *error)
{
    char path[300];
    write_text(*state, "fall.case.yaml", head, rest);
    snprintf(path, sizeof path, "%s/fall.case.yaml", (const char *)*state);
    return shv_verify_run(made, path, options, NULL, error);
}

static ShvVerification *run_case(void **state, const char *rest, bool full)
{
    ShvVerification *made;
    ShvError error = {SHV_OK, ""};
    ShvVerifyOptions options = shv_verify_default();
    options.full = full;
    check_ok(try_case(state, rest, &options, &made, &error), error);
    return made;
}

static void test_verdicts(void **state)
{
    static const char rest[] =
        "let: |\n"
        "  t = scene.duration\n"
        "  fallen = -0.5 * 9.81 * t^2\n"
        "quantities:\n"
        "  - {name: right, measure: last(whole.displacement.z), reference: fallen, unit: m, tolerance: 1e-9}\n"
        "  - {name: wrong, measure: last(whole.displacement.z), reference: 2 * fallen, tolerance: 0.1}\n"
        "  - {name: excused, measure: last(whole.displacement.z), reference: '0', tolerance_absolute: 0.01, explained: "
        "it fell}\n"
        "  - {name: below, measure: last(whole.velocity.z), reference: '0', compare: below}\n"
        "  - {name: above, measure: last(whole.velocity.z), reference: '0', compare: above}\n"
        "  - {name: seen, measure: end.fragments, compare: shown}\n"
        "  - {name: not a number, measure: 'at(whole.velocity.z, 7)', reference: '1', tolerance: 1e9, explained: never "
        "mind}\n"
        "  - {name: unknown, measure: nothing, reference: '1', tolerance: 1}\n"
        "  - {name: excused in vain, measure: t, reference: scene.duration, tolerance: 0, explained: it passes}\n";
    static const ShvVerdict verdicts[] = {SHV_VERDICT_PASS,      SHV_VERDICT_MISS,   SHV_VERDICT_EXPLAINED,
                                          SHV_VERDICT_PASS,      SHV_VERDICT_MISS,   SHV_VERDICT_SHOWN,
                                          SHV_VERDICT_EXPLAINED, SHV_VERDICT_FAILED, SHV_VERDICT_PASS};
    ShvVerification *made = run_case(state, rest, false);
    const ShvVerifyCase *verified = shv_verification_case(made);
    assert_string_equal(verified->name, "fall");
    assert_string_equal(verified->title, "a fall");
    assert_int_equal(verified->row_count, 9);
    for (int i = 0; i < 9; i++) {
        if (verified->rows[i].verdict != verdicts[i])
            fail_msg("row %d: %s", i, shv_verdict_name(verified->rows[i].verdict));
        assert_string_equal(verified->rows[i].source, "G. Galilei");
    }
    assert_int_equal(verified->passes, 3);
    assert_int_equal(verified->explained, 2);
    assert_int_equal(verified->misses, 3);
    check_near(verified->rows[0].value, -0.04905, 1e-12);
    check_near(verified->rows[1].error, 0.5, 1e-9);
    assert_false(verified->rows[1].absolute);
    check_near(verified->rows[2].error, -0.04905, 1e-9);
    assert_true(verified->rows[2].absolute);
    assert_string_equal(verified->rows[2].note, "it fell");
    assert_string_equal(verified->rows[8].note, "");
    assert_non_null(strstr(verified->rows[7].note, "'nothing' is unknown"));
    shv_verify_destroy(made);
}

/* Every kind of expectation, held and missed. */
static void test_expectations(void **state)
{
    static const struct {
        const char *set, *expect, *explained;
        ShvVerdict verdict;
    } cases[] = {
        {"", "finishes", "", SHV_VERDICT_PASS},
        {"", "told", "", SHV_VERDICT_PASS},
        {"", "refused anything", "", SHV_VERDICT_MISS},
        {"", "stops anything", "", SHV_VERDICT_MISS},
        {"duration=-1", "refused duration", "", SHV_VERDICT_PASS},
        {"duration=-1", "refused another thing", "", SHV_VERDICT_MISS},
        {"duration=-1", "finishes", "", SHV_VERDICT_MISS},
        {"duration=-1", "run.steps = 0", "", SHV_VERDICT_MISS},
        {"fracture.time_step=0.05", "refused stable step", "", SHV_VERDICT_PASS},
        {"", "end.position.z = -0.04905 within 1e-9", "", SHV_VERDICT_PASS},
        {"", "end.position.z = -0.04905 within 1e-9 absolute", "", SHV_VERDICT_PASS},
        {"", "end.position.z = -0.04904 within 1e-9", "", SHV_VERDICT_MISS},
        {"", "end.position.z = -0.04904 within 0.001", "", SHV_VERDICT_PASS},
        {"gravity=[0, 0, -19.62]", "end.position.z = 2 * runs.r0.end.position.z within 1e-9", "", SHV_VERDICT_PASS},
        {"", "end.position.z = 2 * runs.r0.end.position.z within 1e-9", "", SHV_VERDICT_MISS},
        {"", "end.fragments <= 1", "", SHV_VERDICT_PASS},
        {"", "end.fragments < 1", "", SHV_VERDICT_MISS},
        {"", "end.fragments >= 1", "", SHV_VERDICT_PASS},
        {"", "end.fragments > 1", "", SHV_VERDICT_MISS},
        {"", "at(frame.time, 9) > 0", "", SHV_VERDICT_MISS}, /* not a number */
        {"", "end.hash = runs.r0.end.hash", "", SHV_VERDICT_PASS},
        {"duration=0.2", "end.hash = runs.r0.end.hash", "", SHV_VERDICT_MISS},
        {"", "end.position.z < -0.05", "it has not had the time", SHV_VERDICT_EXPLAINED},
        {"", "finishes", "needs none", SHV_VERDICT_PASS},
        {"", "nothing < 1", "", SHV_VERDICT_FAILED},
        {"", "no relation at all", "", SHV_VERDICT_FAILED},
    };
    enum { COUNT = sizeof cases / sizeof cases[0] };
    char text[8192] = "runs:\n";
    for (int i = 0; i < COUNT; i++) {
        const size_t length = strlen(text);
        snprintf(text + length, sizeof text - length,
                 "  r%d: {title: run %d, set: '%s', expect: '%s', explained: '%s'}\n", i, i, cases[i].set,
                 cases[i].expect, cases[i].explained);
        if (!cases[i].explained[0]) strcpy(strstr(text + length, ", explained"), "}\n");
        char *set = strstr(text + length, "set: '', ");
        if (set) memmove(set, set + 9, strlen(set + 9) + 1);
    }
    ShvVerification *made = run_case(state, text, true);
    const ShvVerifyCase *verified = shv_verification_case(made);
    assert_int_equal(verified->row_count, COUNT);
    for (int i = 0; i < COUNT; i++) {
        char title[32];
        snprintf(title, sizeof title, "run %d", i);
        if (verified->rows[i].verdict != cases[i].verdict)
            fail_msg("%s gave %s: %s", cases[i].expect, shv_verdict_name(verified->rows[i].verdict),
                     verified->rows[i].note);
        assert_string_equal(verified->rows[i].run, title);
    }
    shv_verify_destroy(made);
}

/* Definitions that need each other are told apart from names that nobody defines. */
static void test_circle(void **state)
{
    static const struct {
        const char *let, *part;
    } cases[] = {
        {"a = b\n  b = a", "top to bottom"}, {"a = a + 1", "top to bottom"}, {"a = nobody", "'nobody' is unknown"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "let: |\n  %s\nquantities:\n  - {name: x, measure: '1', compare: shown}\n",
                 cases[i].let);
        ShvVerification *made = run_case(state, text, false);
        const ShvVerifyCase *verified = shv_verification_case(made);
        assert_int_equal(verified->row_count, 1);
        assert_int_equal(verified->rows[0].verdict, SHV_VERDICT_FAILED);
        if (!strstr(verified->rows[0].note, cases[i].part)) fail_msg("%s", verified->rows[0].note);
        assert_true(i < 2 || !strstr(verified->rows[0].note, "top to bottom"));
        shv_verify_destroy(made);
    }
}

/* Every name that the README tells, with its value where the scene says it. */
static void test_names(void **state)
{
    static const char rest[] =
        "quantities:\n"
        "  - {name: series, measure: last(foot.reaction.z) + last(foot.stress.xy) + last(ground.contact.x) + "
        "last(foot.contact.y), compare: shown}\n"
        "  - {name: ledger, measure: last(ledger.kinetic + ledger.residual + ledger.momentum.x), compare: shown}\n"
        "  - {name: frames, measure: last(frame.step + frame.courant + frame.steps + frame.inserted + frame.failed), "
        "compare: shown}\n"
        "  - {name: alive, measure: last(frame.alive), reference: '1', tolerance: 0}\n"
        "  - {name: pieces, measure: end.fragments, reference: '1', tolerance: 0}\n"
        "  - {name: share, measure: end.largest_mass / end.mass, reference: '1', tolerance: 1e-12}\n"
        "  - {name: end, measure: end.worst_overshoot + end.wall_seconds + end.crack_facets, compare: shown}\n"
        "  - {name: material, measure: stone.density + stone.youngs_modulus + stone.poissons_ratio, reference: "
        "100001000.2, "
        "tolerance: 1e-12}\n"
        "  - {name: mass, measure: block.mass, reference: stone.density * block.size.x * block.size.y * block.size.z, "
        "tolerance: 1e-12}\n"
        "  - {name: mesh, measure: block.tets * block.nodes * block.mean_edge * block.shortest_edge * "
        "block.stable_step * "
        "block.smallest_altitude * block.longest_edge, compare: shown}\n"
        "  - {name: speeds, measure: block.bar_speed / sqrt(stone.youngs_modulus / stone.density), reference: '1', "
        "tolerance: 1e-12}\n"
        "  - {name: object, measure: block.edge + block.position.z + block.velocity.x + block.angular_velocity.y + "
        "block.stretch_rate.z + block.angle, reference: '0.12', tolerance: 1e-12}\n"
        "  - {name: obstacle, measure: floor.friction + floor.restitution + floor.offset + floor.normal.z, reference: "
        "'1.3', tolerance: 1e-12}\n"
        "  - {name: condition, measure: hold.start + hold.normal.x, reference: '0', "
        "tolerance_absolute: 0}\n"
        "  - {name: scene, measure: scene.duration + scene.gravity.z + fracture.safety, reference: '-8.909', "
        "tolerance: "
        "1e-12}\n";
    write_text(*state, "fall.yaml",
               "shiver: 1\nduration: 1 ms\nthreads: 1\n"
               "materials: {stone: {density: 1000, youngs_modulus: 1e8, poissons_ratio: 0.2, breakable: false}}\n"
               "objects: {block: {mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.05}}, material: stone, position: [0, 0, "
               "0.07]}}\n"
               "obstacles: {floor: {plane: {normal: [0, 0, 1], offset: -1}, friction: 0.3, restitution: 1}}\n"
               "supports: {hold: {object: block, on: {plane: {normal: [0, 0, 1], offset: 0.02, tolerance: 1e-6}}}}\n",
               "probes: {foot: {nodes: {object: block}}, ground: {obstacle: floor}}\n");
    ShvVerification *made = run_case(state, rest, false);
    const ShvVerifyCase *verified = shv_verification_case(made);
    if (verified->row_count != 15) fail_msg("%s", verified->rows[0].note);
    for (int32_t i = 0; i < verified->row_count; i++) {
        const ShvVerifyRow *row = &verified->rows[i];
        if (row->verdict != SHV_VERDICT_PASS && row->verdict != SHV_VERDICT_SHOWN)
            fail_msg("%s: %s %.17g %s", row->quantity, shv_verdict_name(row->verdict), row->value, row->note);
        if (!isfinite(row->value)) fail_msg("%s is %g", row->quantity, row->value);
    }
    shv_verify_destroy(made);
}

/* A run beside the motion that its scene's `reference` names; without one that is said, of that row alone. */
static void test_closed_form(void **state)
{
    static const char rest[] = "runs: {flies: {set: 'reference={law: flight}'}, without: {}}\n"
                               "quantities:\n"
                               "  - {name: place, measure: position(closed_form), reference: '0', compare: below, "
                               "tolerance_absolute: 1e-9}\n"
                               "  - {name: pieces, measure: end.fragments, reference: '1', tolerance: 0}\n";
    ShvVerification *made = run_case(state, rest, false);
    const ShvVerifyCase *verified = shv_verification_case(made);
    assert_int_equal(verified->row_count, 4);
    assert_int_equal(verified->passes, 3);
    assert_int_equal(verified->rows[2].verdict, SHV_VERDICT_FAILED);
    assert_non_null(strstr(verified->rows[2].note, "has no 'reference'"));
    shv_verify_destroy(made);
}

/* Errors of 1 + h² against 1: order 2 over all runs; of each the last one alone is judged. */
static const char series[] =
    "let: error = h^2\n"
    "runs:\n"
    "  coarse: {let: h = 0.4, set: duration=0.01}\n"
    "  middle: {let: h = 0.2, set: \"duration=0.02\\ngravity=[0, 0, -1]\"}\n"
    "  fine: {let: \"h = 0.1\\nbefore = runs.coarse.h\", full: true}\n"
    "quantities:\n"
    "  - {name: x, measure: 1 + error, reference: '1', tolerance: 0.02, judge: last}\n"
    "  - {name: order, measure: log(runs.coarse.error / error) / log(runs.coarse.h / h), reference: '2', "
    "tolerance_absolute: 1e-6, judge: together}\n"
    "  - {name: duration, measure: scene.duration, compare: shown}\n";

static void test_runs(void **state)
{
    ShvVerification *made = run_case(state, series, true);
    const ShvVerifyCase *verified = shv_verification_case(made);
    assert_int_equal(verified->row_count, 7);
    static const ShvVerdict verdicts[] = {SHV_VERDICT_SHOWN, SHV_VERDICT_SHOWN, SHV_VERDICT_SHOWN, SHV_VERDICT_SHOWN,
                                          SHV_VERDICT_PASS,  SHV_VERDICT_SHOWN, SHV_VERDICT_PASS};
    for (int i = 0; i < 7; i++) assert_int_equal(verified->rows[i].verdict, verdicts[i]);
    assert_string_equal(verified->rows[0].run, "coarse");
    check_near(verified->rows[1].value, 0.01, 0.0);
    check_near(verified->rows[3].value, 0.02, 0.0);
    check_near(verified->rows[5].value, 0.1, 0.0);
    assert_string_equal(verified->rows[6].quantity, "order");
    check_near(verified->rows[6].value, 2.0, 1e-9);
    shv_verify_destroy(made);
}

/* Without the finest run the one before it is the last, and what is of all runs is not judged. */
static void test_short_runs(void **state)
{
    ShvVerification *made = run_case(state, series, false);
    const ShvVerifyCase *verified = shv_verification_case(made);
    assert_int_equal(verified->row_count, 5);
    assert_int_equal(verified->rows[2].verdict, SHV_VERDICT_MISS);
    assert_int_equal(verified->rows[4].verdict, SHV_VERDICT_SHOWN);
    check_near(verified->rows[4].value, 2.0, 1e-9);
    shv_verify_destroy(made);
}

/* A run that cannot be made is a row; a scene with faults is an error. */
static void test_failed_runs(void **state)
{
    static const char too_long[] = "runs: {long: {set: fracture.time_step=0.05}}\n"
                                   "quantities: [{name: x, measure: '1', compare: shown}]\n";
    ShvVerification *made = run_case(state, too_long, false);
    const ShvVerifyCase *verified = shv_verification_case(made);
    assert_int_equal(verified->row_count, 1);
    assert_int_equal(verified->misses, 1);
    assert_int_equal(verified->rows[0].verdict, SHV_VERDICT_FAILED);
    assert_non_null(strstr(verified->rows[0].note, "times the stable step"));
    shv_verify_destroy(made);
    ShvError error = {SHV_OK, ""};
    check_fails(try_case(state,
                         "runs: {bad: {set: durration=3}}\nquantities: [{name: x, measure: '1', compare: shown}]\n",
                         NULL, &made, &error),
                SHV_BAD_INPUT, error, "did you mean 'duration'?");
    assert_null(made);
}

static void test_faults(void **state)
{
    static const struct {
        const char *rest, *part;
    } cases[] = {
        {"", "compares nothing"},
        {"quantities: [{name: x}]\n", "lacks what it must have: measure"},
        {"quantities: [{name: x, measure: '1'}]\n", "needs 'reference'"},
        {"quantities: [{name: x, measure: '1', reference: '1'}]\n", "needs 'tolerance' or 'tolerance_absolute'"},
        {"quantities: [{name: x, measure: '1', reference: '1', tolerance: 1, tolerance_absolute: 1}]\n", "give one of"},
        {"quantities: [{name: x, measure: '1', compare: shown, judge: none}]\n", "together"},
        {"quantities: [{name: x, measure: '1', reference: '1', tolerance: -1}]\n", "tolerance is '-1'"},
        {"quantities: [{name: x, measure: '1', compare: shown, mesure: '1'}]\n", "did you mean 'measure'?"},
        {"quantities: [{name: x, measure: '1', compare: shown}]\nruns: {only: {full: true}}\n", "give --full"},
        {"quantities: [\n", "not valid YAML"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ShvVerification *made;
        ShvError error = {SHV_OK, ""};
        check_fails(try_case(state, cases[i].rest, NULL, &made, &error), SHV_BAD_INPUT, error, cases[i].part);
        assert_null(made);
    }
    ShvVerification *made;
    ShvError error = {SHV_OK, ""};
    check_fails(shv_verify_run(&made, "/nowhere/x.case.yaml", NULL, NULL, &error), SHV_FILE_ERROR, error,
                "x.case.yaml");
    const ShvVerifyOptions zero = {0};
    check_fails(try_case(state, series, &zero, &made, &error), SHV_BAD_INPUT, error, "shv_verify_default()");
}

static void test_short_set(void **state)
{
    char text[2000];
    ShvVerification *made;
    ShvVerifyOptions options = shv_verify_default();
    ShvError error = {SHV_OK, ""};
    options.short_set = true;
    check_ok(try_case(state, series, &options, &made, &error), error);
    assert_null(made);
    check_fails(try_case(state, "short: true\n", &options, &made, &error), SHV_BAD_INPUT, error, "quantities");
    snprintf(text, sizeof text, "short: true\n%s", series);
    check_ok(try_case(state, text, &options, &made, &error), error);
    assert_non_null(made);
    shv_verify_destroy(made);
}

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    char *text = calloc(1, 100000);
    assert_true(fread(text, 1, 99999, file) > 0);
    fclose(file);
    return text;
}

static void test_pages(void **state)
{
    ShvVerification *made = run_case(state, series, true);
    const ShvVerifyCase *cases[] = {shv_verification_case(made)};
    char html[300], markdown[300];
    ShvError error = {SHV_OK, ""};
    snprintf(html, sizeof html, "%s/page.html", (const char *)*state);
    snprintf(markdown, sizeof markdown, "%s/page.md", (const char *)*state);
    check_ok(shv_verify_write(html, true, false, cases, 1, &error), error);
    check_ok(shv_verify_write(markdown, false, false, cases, 1, &error), error);
    check_fails(shv_verify_write(markdown, false, false, cases, 1, &error), SHV_BAD_INPUT, error, "--force");
    check_ok(shv_verify_write(markdown, false, true, cases, 1, &error), error);
    char *text = read_text(html);
    assert_non_null(strstr(text, "order"));
    assert_non_null(strstr(text, "G. Galilei"));
    free(text);
    text = read_text(markdown);
    assert_non_null(strstr(text, "## a fall"));
    assert_non_null(strstr(text, "| x | fine | 1 | 1.01 |  | +1 % | 2 % | pass |"));
    assert_non_null(strstr(text, "| order | all runs | 2 | 2 |  |"));
    assert_non_null(strstr(text, "\nSource: G. Galilei\n"));
    free(text);
    shv_verify_destroy(made);
}

static void test_no_memory(void **state)
{
    ShvVerification *made;
    ShvError error = {SHV_OK, ""};
    int64_t requests = 1;
    for (int64_t n = 0; n <= requests; n++) {
        ShvMemory *memory = shv_memory_create();
        ShvVerifyOptions options = shv_verify_default();
        options.memory = memory;
        shv_memory_fail_after(memory, n == 0 ? -1 : n - 1);
        const ShvStatus status = try_case(state, series, &options, &made, &error);
        if (n == 0) {
            check_ok(status, error);
            requests = shv_memory_requests(memory);
        } else {
            assert_int_equal(status, SHV_NO_MEMORY);
            assert_null(made);
        }
        shv_verify_destroy(made);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
    }
    assert_true(requests > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_verdicts, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_expectations, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_circle, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_names, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_closed_form, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_runs, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_short_runs, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_failed_runs, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_faults, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_short_set, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_pages, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_no_memory, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
