/* Studies of small scenes: what a study file means, going on where it stopped, tasks, ensembles, fronts. */
#include "bounce.h"
#include "check.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/text.h"
#include "evaluate/sampler.h"
#include "evaluate/study.h"

static char folder[] = "/tmp/shiver-study-XXXXXX";

static const char bounce_study[] = "shiver_study: 1\nname: bounce & <study>\n"
                                   "vary: {rigid.engine: [bullet, analytic], rigid.time_step: [1e-2, 2 ms, 1e-3]}\n"
                                   "reference: closed form\nmeasures: [surface, energy, event_time]\nrepeats: 2\n";
/* Breaks into several pieces; a weak, light ball keeps it short. */
static const char ball_scene[] = "shiver: 1\nname: ball\n"
                                 "materials:\n"
                                 "  plaster: {density: 1200, youngs_modulus: 5 GPa, poissons_ratio: 0.2, "
                                 "fracture_energy: 10, cohesive_strength: 2.5 MPa,\n"
                                 "            weibull: {modulus: 10}}\n"
                                 "objects:\n"
                                 "  ball: {mesh: {ball: {radius: 0.05, edge: 0.03}, jitter: 0.1, seed: 1}, material: "
                                 "plaster, position: [0, 0, 0.051],\n"
                                 "         velocity: [0, 0, -8]}\n"
                                 "obstacles: {floor: {plane: {normal: [0, 0, 1]}, friction: 0.5}}\n"
                                 "rigid: {engine: analytic}\nduration: 0.8 ms\noutput: {rate: 5000}\nthreads: 1\n";

static const char *at(const char *name)
{
    static char paths[128][256];
    static int next;
    next = (next + 1) % 128;
    snprintf(paths[next], sizeof paths[next], "%s/%s", folder, name);
    return paths[next];
}

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static char *read_text(const char *path)
{
    static char texts[4][1 << 18];
    static int next;
    next = (next + 1) % 4;
    FILE *file = fopen(path, "r");
    if (!file) fail_msg("%s is missing", path);
    texts[next][fread(texts[next], 1, sizeof texts[next] - 1, file)] = '\0';
    fclose(file);
    return texts[next];
}

static int enter(void **state)
{
    (void)state;
    if (!mkdtemp(folder)) return -1;
    write_text(at("bounce.yaml"), bounce_scene);
    write_text(at("ball.yaml"), ball_scene);
    return 0;
}

static int leave(void **state)
{
    (void)state;
    char line[128];
    snprintf(line, sizeof line, "rm -r %s", folder);
    return system(line);
}

/* ---- the study file ---- */

static ShvStatus read_plan(ShvStudyPlan *plan, const char *text, ShvError *error)
{
    static const char *const more[] = {"duration=1"};
    return shv_study_plan_read(plan, text, strlen(text), "study.yaml", more, 1, NULL, error);
}

static void test_plan(void **state)
{
    (void)state;
    ShvStudyPlan plan;
    ShvError error;
    check_ok(
        read_plan(&plan,
                  "shiver_study: 1\nname: both\nset: {output.rate: 10, gravity: [0, 0, -1]}\nvary:\n"
                  "  - {fracture.stabiliser: none, step: [0.5, 1]}\n"
                  "  - {fracture.stabiliser: bars, pbd.iterations: [1, 4], step: [1, 10, 100]}\n"
                  "  - {'obstacles.floor': [{plane: {normal: [0, 0, 1]}}], "
                  "rigid.time_step: [1 ms, 2 ms]}\n"
                  "reference: {fracture.stabiliser: none, step: 0.1}\nmeasures: [fragments, dissipated]\nrepeats: 3\n"
                  "ensemble: {seeds: 5}\naudit_wakes: 7\n",
                  &error),
        error);
    assert_string_equal(plan.name, "both");
    assert_int_equal(plan.setting_count, 2 + 6 + 2);
    assert_int_equal(plan.key_count, 5);
    assert_string_equal(plan.keys[1], "step");
    assert_true(plan.repeats == 3 && plan.members == 5 && plan.seeds && plan.audit_wakes == 7);
    assert_true(plan.measure_count == 2 && strcmp(plan.measures[0].name, "fragments") == 0);
    assert_true(plan.reference == SHV_STUDY_SETTING && plan.settings[plan.setting_count].multiple == 0.1);
    const ShvStudySetting *s = plan.settings;
    assert_int_equal(s[0].override_count, 4);
    assert_string_equal(s[0].overrides[0], "output.rate=10");
    assert_string_equal(s[0].overrides[1], "gravity=[0, 0, -1]");
    assert_string_equal(s[0].overrides[2], "duration=1");
    assert_string_equal(s[0].overrides[3], "fracture.stabiliser=none");
    assert_true(s[0].multiple == 0.5 && s[1].multiple == 1.0);
    assert_string_equal(s[1].series, "none");
    assert_string_equal(s[1].label, "1×");
    /* The last key runs fastest. */
    assert_true(s[2].multiple == 1.0 && s[3].multiple == 10.0 && s[4].multiple == 100.0 && s[5].multiple == 1.0);
    assert_string_equal(s[4].overrides[4], "pbd.iterations=1");
    assert_string_equal(s[5].overrides[4], "pbd.iterations=4");
    assert_string_equal(s[5].series, "bars, iterations 4");
    assert_string_equal(s[5].values[0], "bars");
    assert_string_equal(s[0].values[2], "");
    assert_string_equal(s[9].overrides[3], "obstacles.floor={plane: {normal: [0, 0, 1]}}");
    assert_string_equal(s[9].overrides[4], "rigid.time_step=2 ms");
    assert_true(isnan(s[9].multiple));
    assert_int_equal(s[5].line, 6);
    shv_study_plan_release(&plan);
}

static void test_bad_plans(void **state)
{
    (void)state;
#define REFERENCE "reference: {step: 0.5}\n"
#define VARY      "vary: {step: [1]}\nmeasures: [energy]\n"
#define REST      VARY REFERENCE
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"vary: [", "study.yaml:2:1: error: not valid YAML"},
        {"- 1\n", "study.yaml:1:1: error: the study is a list; expected a mapping"},
        {"shiver_study: 1\nmesures: [energy]\n" REST,
         "study.yaml:2:1: error: unknown key 'mesures' in the study; did you mean 'measures'?"},
        {REST, "lacks what it must have: shiver_study"},
        {"shiver_study: 1\nvary: {step: [1]}\nmeasures: [fragments]\n",
         "must have 'reference', what errors are taken from: the keys of the finest setting, such as 'reference: "
         "{step: 0.25}'"},
        {"shiver_study: 2\n" REST, "shiver_study is '2'; expected a whole number, exactly 1"},
        {"shiver_study: 1\nmeasures: [energy]\n" REFERENCE,
         "must have 'vary', the keys and values to run, such as 'vary: {step: "},
        {"shiver_study: 1\nvary: {}\nmeasures: [energy]\n" REFERENCE, "study.yaml:2:7: error: a block of 'vary'"},
        {"shiver_study: 1\nvary: []\nmeasures: [energy]\n" REFERENCE, "'vary' is empty"},
        {"shiver_study: 1\nvary: 3\nmeasures: [energy]\n" REFERENCE, "a block of 'vary'"},
        {"shiver_study: 1\nvary: {step: []}\nmeasures: [energy]\n" REFERENCE, "list of values is empty"},
        {"shiver_study: 1\nvary: {step: [0]}\nmeasures: [energy]\n" REFERENCE,
         "number of stable steps above 0, not '0'"},
        {"shiver_study: 1\nvary: {step: fast}\nmeasures: [energy]\n" REFERENCE, "not 'fast'"},
        {"shiver_study: 1\nvary: {a: [1, 2, 3, 4, 5], b: [1, 2, 3, 4, 5], c: [1, 2, 3, 4, 5], d: [1, 2, 3, 4, 5], "
         "e: [1, 2, 3, 4, 5], f: [1, 2, 3, 4, 5]}\nmeasures: [energy]\n" REFERENCE,
         "more than 10000 settings"},
        {"shiver_study: 1\nvary: {step: 1}\n" REFERENCE,
         "must have 'measures', what is compared, such as 'measures: ["},
        {"shiver_study: 1\nvary: {step: 1}\nmeasures: [energie]\n" REFERENCE,
         "study.yaml:3:12: error: there is no measure 'energie'; did you mean energy?"},
        {"shiver_study: 1\nvary: {step: 1}\nmeasures: [energy, energy]\n" REFERENCE, "given twice"},
        {"shiver_study: 1\nrepeats: 0\n" REST, "repeats is '0'; expected a whole number, at least 1 and at most 50"},
        {"shiver_study: 1\nrepeats: 99999999999\n" REST, "; expected a whole number, at least 1"},
        {"shiver_study: 1\nrepeats: 1.5\n" REST, "; expected a whole number, at least 1"},
        {"shiver_study: 1\nname: [a]\n" REST, "name is a list of 1; expected a text"},
        {"shiver_study: 1\nset: [a]\n" REST, "'set' must be a mapping"},
        {"shiver_study: 1\nensemble: {seeds: 4}\n" REST, "seeds is '4'; expected a whole number, at least 5"},
        {"shiver_study: 1\nensemble: {shifts: 5}\n" REST, "'ensemble' is {seeds: 5} or"},
        {"shiver_study: 1\nensemble: {seed: 5}\n" REST, "did you mean 'seeds'?"},
        {"shiver_study: 1\nensemble: {seeds: 5}\nreference: closed form\n" VARY, "an ensemble has no closed form"},
        {"shiver_study: 1\nreference: best\n" VARY, "'reference' is 'closed form'"},
        {"shiver_study: 1\nreference: {step: [1, 2]}\n" VARY, "give one value of 'step'"},
        {"shiver_study: 1\nreference: closed form\nvary: {step: 1}\nmeasures: [fragments]\n",
         "'fragments' has no closed form"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        ShvStudyPlan plan;
        ShvError error;
        check_fails(read_plan(&plan, cases[i].text, &error), SHV_BAD_INPUT, error, cases[i].part);
        assert_null(plan.settings);
    }
}

/* Whatever allocation fails, it says so and leaks nothing. */
static void test_plan_without_memory(void **state)
{
    (void)state;
    ShvStatus status = SHV_NO_MEMORY;
    for (int64_t count = 0; status != SHV_OK; count++) {
        ShvMemory *memory = shv_memory_create();
        ShvStudyPlan plan;
        ShvError error;
        shv_memory_fail_after(memory, count);
        status = shv_study_plan_read(&plan, bounce_study, strlen(bounce_study), "s", NULL, 0, memory, &error);
        if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
        shv_study_plan_release(&plan);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
        assert_true(count < 1000);
    }
}

/* ---- running ---- */

typedef struct Told {
    int runs, limit; /* begun; after how many it is told to stop */
} Told;

static void count_run(void *data, const char *setting)
{
    Told *told = data;
    assert_true(strlen(setting) > 0);
    told->runs++;
}

static bool enough(void *data)
{
    const Told *told = data;
    return told->limit > 0 && told->runs >= told->limit;
}

static ShvStudyOptions options_for(const char *output, Told *told)
{
    ShvStudyOptions options = shv_study_default();
    options.output = output;
    options.begins = count_run;
    options.begins_data = told;
    options.stop = enough;
    options.stop_data = told;
    return options;
}

static ShvStudy *open_study(const char *scene, const char *text, const ShvStudyOptions *options)
{
    ShvStudy *study;
    ShvError error;
    write_text(at("study.yaml"), text);
    check_ok(shv_study_open(&study, at(scene), at("study.yaml"), options, &error), error);
    return study;
}

/* Runs to the end and writes; returns how many runs that took. */
static int complete(const char *scene, const char *text, const char *output)
{
    Told told = {0, 0};
    ShvError error;
    const ShvStudyOptions options = options_for(output, &told);
    ShvStudy *study = open_study(scene, text, &options);
    check_ok(shv_study_run(study, &error), error);
    check_ok(shv_study_measure(study, &error), error);
    check_ok(shv_study_write(study, &error), error);
    shv_study_close(study);
    return told.runs;
}

static void test_going_on(void **state)
{
    (void)state;
    const char *output = at("going");
    assert_int_equal(complete("bounce.yaml", bounce_study, at("whole")), 6);
    /* Told to stop when the third run begins, which is left unfinished: two are kept. */
    Told told = {0, 3};
    ShvError error;
    ShvStudyOptions options = options_for(output, &told);
    ShvStudy *study = open_study("bounce.yaml", bounce_study, &options);
    assert_int_equal(shv_study_run(study, &error), SHV_INTERRUPTED);
    check_fails(shv_study_measure(study, &error), SHV_BAD_INPUT, error, "4 of 6 runs are missing");
    assert_int_equal(shv_study_view(study)->row_count, 0);
    check_fails(shv_study_write(study, &error), SHV_BAD_INPUT, error, "after it has been measured");
    shv_study_close(study);
    assert_int_equal(complete("bounce.yaml", bounce_study, output), 4);
    assert_string_equal(read_text(at("going/results.csv")), read_text(at("whole/results.csv")));
    /* Nothing is run twice, unless asked for or run beside others before. */
    assert_int_equal(complete("bounce.yaml", bounce_study, output), 0);
    told = (Told){0, 0};
    options.force = options.shared = true;
    study = open_study("bounce.yaml", bounce_study, &options);
    check_ok(shv_study_run(study, &error), error);
    assert_int_equal(told.runs, 6);
    check_ok(shv_study_measure(study, &error), error);
    assert_false(shv_study_view(study)->timings_valid);
    shv_study_close(study);
    assert_int_equal(complete("bounce.yaml", bounce_study, output), 6);
    /* Another scene is another run, and so is another number of repeats; another measure of the same kind is not. */
    write_text(at("other.yaml"), bounce_scene);
    assert_int_equal(complete("other.yaml", bounce_study, output), 0);
    FILE *file = fopen(at("other.yaml"), "a");
    assert_non_null(file);
    fputs("seed: 3\n", file);
    fclose(file);
    assert_int_equal(complete("other.yaml", bounce_study, output), 6);
    static char changed[sizeof bounce_study + 32];
    strcpy(changed, bounce_study);
    memcpy(strstr(changed, "surface"), "apex   ", 7);
    assert_int_equal(complete("bounce.yaml", changed, output), 0);
    strcpy(strstr(changed, "repeats"), "repeats: 1\n");
    assert_int_equal(complete("bounce.yaml", changed, output), 6);
    /* A file that was cut is run again. */
    char line[200];
    snprintf(line, sizeof line, "for f in %s/runs/*; do head -c 300 $f >$f.cut; mv $f.cut $f; done", output);
    assert_int_equal(system(line), 0);
    assert_int_equal(complete("bounce.yaml", changed, output), 6);
}

static void test_tasks(void **state)
{
    (void)state;
    static const char text[] = "shiver_study: 1\nvary:\n  - {fracture.stabiliser: none, step: [0.5, 1]}\n"
                               "  - {fracture.stabiliser: bars, step: [0.5, 3]}\n"
                               "reference: {step: 0.25}\n"
                               "measures: [dissipated, failed_overlap, crack_distance, masses, impulse, bars_given]\n";
    assert_int_equal(complete("ball.yaml", text, at("serial")), 5);
    int runs = 0;
    ShvError error;
    for (int32_t task = 4; task >= 1; task--) {
        Told told = {0, 0};
        ShvStudyOptions options = options_for(at("tasks"), &told);
        options.task = task;
        options.tasks = 4;
        ShvStudy *study = open_study("ball.yaml", text, &options);
        check_ok(shv_study_run(study, &error), error);
        shv_study_close(study);
        assert_int_equal(told.runs, task == 1 ? 2 : 1);
        runs += told.runs;
    }
    assert_int_equal(runs, 5);
    assert_int_equal(complete("ball.yaml", text, at("tasks")), 0);
    assert_string_equal(read_text(at("tasks/results.csv")), read_text(at("serial/results.csv")));
    assert_non_null(strstr(read_text(at("serial/results.csv")), "none,0.5,"));
}

static void test_rows(void **state)
{
    (void)state;
    Told told = {0, 0};
    ShvError error;
    const ShvStudyOptions options = options_for(at("rows"), &told);
    ShvStudy *study = open_study("ball.yaml",
                                 "shiver_study: 1\nvary: {step: [0.5, 1, 1.5]}\nreference: {step: 0.5}\n"
                                 "measures: [dissipated, fragments, failed_overlap]\n",
                                 &options);
    check_ok(shv_study_run(study, &error), error);
    check_ok(shv_study_measure(study, &error), error);
    assert_int_equal(shv_study_view(study)->row_count, 3);
    assert_string_equal(shv_study_view(study)->reference, "run of runs, 0.5×");
    const ShvStudyRow *half = &shv_study_view(study)->rows[0], *one = &shv_study_view(study)->rows[1],
                      *beyond = &shv_study_view(study)->rows[2];
    assert_true(half->is_reference && !one->is_reference);
    for (int i = 0; i < 3; i++) assert_true(half->errors[i] == 0.0);
    assert_true(half->values[1] > 1.0 && half->values[0] > 0.0); /* it does break */
    check_near(one->errors[0], fabs(one->values[0] - half->values[0]) / half->values[0], 1e-15);
    assert_true(one->errors[2] > 0.0 && one->errors[2] <= 1.0);
    /* Equal steps fill the time to the next frame, so that a step is a little shorter than asked for. */
    assert_true(one->courant <= 1.0 && one->courant > 0.9 && one->step <= one->stable_step);
    assert_true(half->seconds > 0.0 && half->seconds_low <= half->seconds && half->seconds <= half->seconds_high);
    /* Beyond the stable step the run is refused, which is a result. */
    assert_int_equal(beyond->status, SHV_BAD_INPUT);
    assert_non_null(strstr(beyond->message, "1.5 times the stable step"));
    assert_true(isnan(beyond->errors[0]));
    assert_true(shv_study_view(study)->scatter[0] == 0.0);
    assert_int_equal(shv_study_pick(study, 2, 1.0), 1); /* the reference is not picked */
    assert_int_equal(shv_study_pick(study, 2, 0.0), -1);
    shv_study_close(study);
}

static void test_ensemble(void **state)
{
    (void)state;
    Told told = {0, 0};
    ShvError error;
    ShvStudyOptions options = options_for(at("ensemble"), &told);
    ShvStudy *study = open_study("ball.yaml",
                                 "shiver_study: 1\nvary: {step: [0.7, 1]}\nreference: {step: 0.4}\n"
                                 "measures: [dissipated, bars_given]\nensemble: {seeds: 5}\n",
                                 &options);
    check_ok(shv_study_run(study, &error), error);
    assert_int_equal(told.runs, 15);
    check_ok(shv_study_measure(study, &error), error);
    const ShvStudyRow *row = &shv_study_view(study)->rows[0];
    assert_true(row->errors_low[0] <= row->errors[0] && row->errors[0] <= row->errors_high[0]);
    assert_true(row->errors_low[0] < row->errors_high[0]);
    assert_true(shv_study_view(study)->scatter[0] > 0.0);
    assert_true(shv_study_view(study)->scatter[1] == 0.0);
    /* The scatter is the median of ten pairs of the reference's runs: by hand from their files. */
    double dissipated[5], pairs[10];
    for (int32_t m = 0; m < 5; m++) {
        ShvOutcome outcome;
        check_ok(shv_study_load(study, 2 * 5 + m, &outcome, &error), error);
        dissipated[m] = shv_outcome_number(&outcome, "ledger.fracture_dissipation");
        shv_outcome_release(&outcome);
    }
    for (int a = 0, k = 0; a < 5; a++)
        for (int b = a + 1; b < 5; b++) pairs[k++] = fabs(dissipated[a] - dissipated[b]) / dissipated[b];
    shv_sort_numbers(pairs, 10);
    check_near(shv_study_view(study)->scatter[0], 0.5 * (pairs[4] + pairs[5]), 1e-15);
    /* Members other than the first differ by tiny places. */
    shv_study_close(study);
    study = open_study("ball.yaml",
                       "shiver_study: 1\nvary: {step: [0.7]}\nreference: {step: 0.7}\nmeasures: [dissipated]\n"
                       "ensemble: {shifts: 5, size: 1e-9}\n",
                       &options);
    ShvScene *scene;
    ShvObjectDefinition objects[1];
    check_ok(shv_study_scene(study, 0, &scene, &error), error);
    for (int32_t m = 0; m < 5; m++) {
        const ShvSceneDefinition member = shv_study_member(study, shv_scene_definition(scene), m, objects);
        const double shift = member.objects[0].placement.position[2] - 0.051;
        assert_true(m == 0 ? shift == 0.0 : shift != 0.0 && fabs(shift) <= 1e-9);
        assert_int_equal(member.seed, shv_scene_definition(scene)->seed);
    }
    shv_scene_destroy(scene);
    shv_study_close(study);
}

static void test_refusals(void **state)
{
    (void)state;
    Told told = {0, 0};
    ShvStudy *study;
    ShvError error;
    ShvStudyOptions options = options_for(at("refused"), &told);
    write_text(at("study.yaml"), "shiver_study: 1\nvary:\n  - {seed: 1}\n  - {rigid.time_stop: [1]}\nmeasures: "
                                 "[energy]\nreference: {seed: 1}\n");
    check_fails(shv_study_open(&study, at("bounce.yaml"), at("study.yaml"), &options, &error), SHV_BAD_INPUT, error,
                "study.yaml:4: --set rigid.time_stop: error: unknown key 'time_stop'");
    assert_null(study);
    write_text(at("study.yaml"), bounce_study);
    check_fails(shv_study_open(&study, at("none.yaml"), at("study.yaml"), &options, &error), SHV_FILE_ERROR, error,
                "none.yaml");
    check_fails(shv_study_open(&study, at("bounce.yaml"), at("none.yaml"), &options, &error), SHV_FILE_ERROR, error,
                "none.yaml");
    options.output = at("missing/folder");
    check_fails(shv_study_open(&study, at("bounce.yaml"), at("study.yaml"), &options, &error), SHV_FILE_ERROR, error,
                "cannot make the folder");
    options.output = "";
    check_fails(shv_study_open(&study, at("bounce.yaml"), at("study.yaml"), &options, &error), SHV_BAD_INPUT, error,
                "needs a folder");
    options.output = at("refused");
    options.task = 3;
    options.tasks = 2;
    check_fails(shv_study_open(&study, at("bounce.yaml"), at("study.yaml"), &options, &error), SHV_BAD_INPUT, error,
                "not 3 of 2");
    options.task = options.tasks = 0;
    options.cookie = 0;
    check_fails(shv_study_open(&study, at("bounce.yaml"), at("study.yaml"), &options, &error), SHV_BAD_INPUT, error,
                "shv_study_default");
    /* Somebody's report is not replaced. */
    options.cookie = SHV_DEFINITION_COOKIE;
    assert_int_equal(mkdir(at("taken"), 0777), 0);
    write_text(at("taken/report.html"), "mine");
    options.output = at("taken");
    check_fails(shv_study_open(&study, at("bounce.yaml"), at("study.yaml"), &options, &error), SHV_BAD_INPUT, error,
                "has a report but no runs");
    /* A scene without `reference` has no closed form. */
    options.output = at("formless");
    write_text(at("study.yaml"), "shiver_study: 1\nvary: {step: 1}\nreference: closed form\nmeasures: [position]\n");
    check_fails(shv_study_open(&study, at("ball.yaml"), at("study.yaml"), &options, &error), SHV_BAD_INPUT, error,
                "has no 'reference'");
    assert_int_not_equal(access(at("formless"), F_OK), 0);
}

/* An impact that the rule takes for harmless is run in fracture mode, and breaks the ball. */
static void test_shadow(void **state)
{
    (void)state;
    Told told = {0, 0};
    ShvError error;
    const ShvStudyOptions options = options_for(at("shadow"), &told);
    ShvStudy *study = open_study("ball.yaml",
                                 "shiver_study: 1\nvary: {rigid.wake_fraction: [0.5, 1e9]}\naudit_wakes: 1\n"
                                 "reference: {rigid.wake_fraction: 0.5}\n"
                                 "measures: [missed_fracture]\n",
                                 &options);
    check_ok(shv_study_run(study, &error), error);
    check_ok(shv_study_measure(study, &error), error);
    assert_true(isnan(shv_study_view(study)->rows[0].errors[0]));
    check_near(shv_study_view(study)->rows[1].errors[0], 1.0, 0.0);
    check_near(shv_study_view(study)->rows[1].values[0], 1.0, 0.0);
    shv_study_close(study);
}

/* Whatever allocation fails, the study says so, and leaves nothing behind in memory. */
static void test_without_memory(void **state)
{
    (void)state;
    static const char text[] = "shiver_study: 1\nvary: {rigid.time_step: [1e-2, 5e-3]}\nset: {duration: 0.1}\n"
                               "reference: closed form\nmeasures: [surface, energy]\n";
    ShvStatus status = SHV_NO_MEMORY;
    write_text(at("study.yaml"), text);
    for (int64_t count = 0; status != SHV_OK; count += 1 + count / 40) {
        Told told = {0, 0};
        ShvError error;
        ShvStudy *study;
        ShvStudyOptions options = options_for(at("short of memory"), &told);
        options.memory = shv_memory_create();
        options.force = true;
        shv_memory_fail_after(options.memory, count);
        status = shv_study_open(&study, at("bounce.yaml"), at("study.yaml"), &options, &error);
        if (status == SHV_OK) status = shv_study_run(study, &error);
        if (status == SHV_OK) status = shv_study_measure(study, &error);
        if (status == SHV_OK) status = shv_study_write(study, &error);
        if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
        shv_study_close(study);
        assert_int_equal(shv_memory_bytes(options.memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(options.memory);
        assert_true(count < 1000000);
    }
}

/* ---- fronts ---- */

static ShvStudyRow row_of(double seconds, double error, ShvStatus status)
{
    return (ShvStudyRow){.seconds = seconds, .status = status, .errors = {error}};
}

static void check_front(double scatter, const char *wanted)
{
    static const double rows[][2] = {{4.0, 0.01}, {1.0, 0.5},  {2.0, 0.4}, {3.0, 0.3},
                                     {3.0, 0.2},  {5.0, 0.02}, {2.5, 0.45}};
    enum { COUNT = sizeof rows / sizeof rows[0] };
    ShvStudyRow results[COUNT + 3];
    ShvStudy study = {.rows = results, .setting_count = COUNT + 3};
    study.view = (ShvStudyView){.rows = results, .row_count = COUNT + 3, .scatter = {scatter}};
    for (int i = 0; i < COUNT; i++) results[i] = row_of(rows[i][0], rows[i][1], SHV_OK);
    results[COUNT] = row_of(0.1, 0.0, SHV_DIVERGED);
    results[COUNT + 1] = row_of(0.1, (double)NAN, SHV_OK);
    results[COUNT + 2] = row_of(0.1, 0.0, SHV_OK);
    results[COUNT + 2].is_reference = true;
    shv_study_mark_front(&study, 0);
    for (int i = 0; i < COUNT + 3; i++)
        if (results[i].on_front[0] != (wanted[i] == '*')) fail_msg("scatter %g: row %d", scatter, i);
    assert_int_equal(shv_study_pick(&study, 0, 0.35), 4); /* of two that cost the same the better */
    assert_int_equal(shv_study_pick(&study, 0, 0.02), 0);
    assert_int_equal(shv_study_pick(&study, 0, 0.001), -1);
}

static void test_front(void **state)
{
    (void)state;
    /* Times 1, 2, 3 (the better of two), 4; 2.5 and 5 are beaten by cheaper ones. */
    check_front(0.0, "***.*.....");
    check_front((double)NAN, "***.*.....");
    /* 0.4 is not better than 0.5 by more than 0.15, but 0.2 is; 0.01 is again. */
    check_front(0.15, "**..*.....");
    check_front(0.25, ".*..*.....");
    check_front(1.0, ".*........");
}

/* ---- the page ---- */

static void test_files(void **state)
{
    (void)state;
    complete("bounce.yaml", bounce_study, at("files"));
    const char *page = read_text(at("files/report.html"));
    static const char *const outside[] = {"http", "src=", "href", "url(", "@import", "<script", "<link"};
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) assert_null(strstr(page, outside[i]));
    assert_non_null(strstr(page, "<h1>bounce &amp; &lt;study&gt;</h1>"));
    assert_non_null(strstr(page, "closed form (bounce of "));
    static const char *const files[] = {"error_surface.svg", "error_energy.svg", "error_event_time.svg", "cost.svg",
                                        "study.json",        "results.csv",      "timings.csv"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        char name[64];
        snprintf(name, sizeof name, "files/%s", files[i]);
        assert_true(strlen(read_text(at(name))) > 100);
    }
    assert_non_null(strstr(read_text(at("files/results.csv")),
                           "rigid.engine,rigid.time_step,reference,status,stable step [s],step [s],Courant number,"
                           "error of surface [m],error of energy,error of event_time [s],message\nbullet,1e-2,,ok,"));
}

static void check_table(const ShvStudy *study, const char *wanted)
{
    FILE *stream = fopen(at("table.md"), "w");
    assert_non_null(stream);
    shv_study_put_table(study, SHV_STUDY_LINES, SHV_TABLE_MARKDOWN, stream);
    assert_int_equal(fclose(stream), 0);
    assert_string_equal(read_text(at("table.md")), wanted);
}

/* A column of the table in which no row has a figure is left out: the Courant number of what is rigid, and impacts of what flies
   past the floor. With a run that failed the columns are as many. */
static void test_table_without_empty_columns(void **state)
{
    (void)state;
    enum { COUNT = 2 };
    ShvMeasure measures[] = {{.name = "position", .error_unit = "m"}, {.name = "apex", .error_unit = ""}};
    ShvStudyRow rows[COUNT] = {row_of(1.0, 0.5, SHV_OK), row_of(2.0, 0.25, SHV_OK)};
    ShvStudy study = {.rows = rows, .setting_count = COUNT};
    memcpy(study.plan.measures, measures, sizeof measures);
    study.plan.measure_count = 2;
    study.plan.members = 1;
    rows[0].series = rows[1].series = "ball";
    rows[0].label = "a";
    rows[1].label = "b";
    rows[0].errors[1] = rows[1].errors[1] = (double)NAN;
    check_table(
        &study,
        "| setting | run time, s | position, m |\n|---|---|---|\n| ball, a | 1 | 0.5 |\n| ball, b | 2 | 0.25 |\n");
    rows[1].courant = 0.9;
    rows[1].errors[1] = 0.125;
    rows[0].status = SHV_DIVERGED;
    shv_format(rows[0].message, sizeof rows[0].message, "it diverged; do this");
    check_table(&study, "| setting | Courant | run time, s | position, m | apex |\n|---|---|---|---|---|\n"
                        "| ball, a | – | 1 | failed: it diverged |  |\n| ball, b | 0.9 | 2 | 0.25 | 0.125 |\n");
    rows[1].status = SHV_DIVERGED; /* then nothing is known, and what was asked for is told */
    shv_format(rows[1].message, sizeof rows[1].message, "too");
    check_table(&study, "| setting | Courant | run time, s | position, m | apex |\n|---|---|---|---|---|\n"
                        "| ball, a | – | 1 | failed: it diverged |  |\n| ball, b | 0.9 | 2 | failed: too |  |\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plan),
        cmocka_unit_test(test_bad_plans),
        cmocka_unit_test(test_plan_without_memory),
        cmocka_unit_test(test_going_on),
        cmocka_unit_test(test_tasks),
        cmocka_unit_test(test_rows),
        cmocka_unit_test(test_ensemble),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_front),
        cmocka_unit_test(test_without_memory),
        cmocka_unit_test(test_shadow),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_table_without_empty_columns),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
