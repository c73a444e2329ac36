#include "evaluate/study_plan.h"

#include <string.h>

#include "base/file.h"
#include "base/names.h"
#include "base/text.h"
#include "scene/read.h"
#include "scene/source.h"

typedef struct Planner {
    ShvStudyPlan *plan;
    ShvPool *pool;
    ShvDiagnostics *diagnostics;
    const char **fixed; /* overrides of all runs */
    int32_t fixed_count;
    const char *along; /* key that runs along a line of a plot */
} Planner;

/* A key of one block with its values. */
typedef struct Axis {
    const char *key;
    const char **values;
    int32_t count, column, chosen; /* chosen: the value of the setting under way */
} Axis;

static const char *const step_key = "step";
#define LENGTH_OF(array) ((int)(sizeof(array) / sizeof *(array)))

static const char *copy(const Planner *planner, const char *text)
{
    return shv_pool_text(planner->pool, text, strlen(text));
}

/* ---- keys of all runs ---- */

static const char *assignment(ShvPool *pool, const char *key, const char *value)
{
    if (!key || !value) return NULL;
    const size_t size = strlen(key) + strlen(value) + 2;
    char *text = shv_pool_take(pool, size, 1);
    if (text) shv_format(text, size, "%s=%s", key, value);
    return text;
}

static void read_fixed(Planner *planner, const ShvNode *set, const char *const *more, int32_t more_count)
{
    if (set && set->kind != SHV_NODE_MAPPING) {
        shv_error(planner->diagnostics, set->place, "'set' must be a mapping of scene keys to values");
        return;
    }
    const int32_t own = set ? set->count : 0;
    planner->fixed = shv_pool_take(planner->pool, (size_t)(own + more_count), sizeof *planner->fixed);
    if (!planner->fixed) return;
    for (const ShvEntry *entry = set ? set->first : NULL; entry; entry = entry->next)
        planner->fixed[planner->fixed_count++] =
            assignment(planner->pool, entry->key->text, shv_tree_text(planner->pool, entry->value));
    for (int32_t i = 0; i < more_count; i++) planner->fixed[planner->fixed_count++] = copy(planner, more[i]);
}

/* ---- settings ---- */

/* Column of a varied key in the study's table; −1 when there are too many. */
static int32_t column_of(Planner *planner, const ShvNode *key)
{
    ShvStudyPlan *plan = planner->plan;
    for (int32_t i = 0; i < plan->key_count; i++)
        if (strcmp(plan->keys[i], key->text) == 0) return i;
    if (plan->key_count == SHV_STUDY_MOST_KEYS) {
        shv_error(planner->diagnostics, key->place, "a study varies at most %d keys", (int)SHV_STUDY_MOST_KEYS);
        return -1;
    }
    plan->keys[plan->key_count] = copy(planner, key->text);
    return plan->key_count++;
}

static void read_multiple(Planner *planner, const char *text, const ShvNode *node, double *multiple)
{
    if (shv_parse_double(text, strlen(text), false, multiple, NULL) != SHV_OK || !(*multiple > 0.0 && *multiple <= 1e6))
        shv_error(planner->diagnostics, node->place, "'step' is a number of stable steps above 0, not %s",
                  shv_quoted(text).text);
}

/* "a, b" of the values that are not along the line; numbers carry the last word of their key. */
static void name_setting(Planner *planner, ShvStudySetting *setting, const Axis *axes, int32_t count)
{
    char series[200] = "", label[64] = "", name[1024] = "", title[300];
    const ShvStudyPlan *plan = planner->plan;
    for (int32_t i = 0; i < count; i++) {
        const char *value = axes[i].values[axes[i].chosen], *dot = strrchr(axes[i].key, '.');
        const char *times = strcmp(axes[i].key, step_key) == 0 ? "×" : "";
        if (strcmp(axes[i].key, planner->along) == 0)
            shv_append(label, sizeof label, "%s%.60s%s", label[0] ? ", " : "", value, times);
        else if (strchr("+-.0123456789", value[0]))
            shv_append(series, sizeof series, "%s%s %.60s%s", series[0] ? ", " : "", dot ? dot + 1 : axes[i].key, value,
                       times);
        else
            shv_append(series, sizeof series, "%s%.60s%s", series[0] ? ", " : "", value, times);
    }
    if (series[0] == '\0') shv_append(series, sizeof series, "runs");
    for (int32_t i = 0; i < plan->key_count; i++)
        if (setting->values[i][0])
            shv_append(name, sizeof name, "%s%s=%s", name[0] ? " " : "", plan->keys[i], setting->values[i]);
    shv_format(title, sizeof title, "%s%s%s", series, label[0] ? ", " : "", label);
    setting->series = copy(planner, series);
    setting->label = copy(planner, label);
    setting->title = copy(planner, title);
    setting->name = copy(planner, name[0] ? name : "reference");
}

/* The combination that is chosen. */
static void fill_setting(Planner *planner, ShvStudySetting *setting, const Axis *axes, int32_t count,
                         const ShvNode *node)
{
    ShvPool *pool = planner->pool;
    const char **overrides = shv_pool_take(pool, (size_t)(planner->fixed_count + count), sizeof *overrides);
    const char **values = shv_pool_take(pool, SHV_STUDY_MOST_KEYS, sizeof *values);
    if (!overrides || !values) return;
    *setting =
        (ShvStudySetting){.overrides = overrides, .multiple = (double)NAN, .values = values, .line = node->place.line};
    for (int32_t i = 0; i < planner->fixed_count; i++) overrides[setting->override_count++] = planner->fixed[i];
    for (int32_t i = 0; i < SHV_STUDY_MOST_KEYS; i++) values[i] = "";
    for (int32_t i = 0; i < count; i++) {
        const char *value = axes[i].values[axes[i].chosen];
        if (!value) return;
        if (axes[i].column >= 0) values[axes[i].column] = value;
        if (strcmp(axes[i].key, step_key) == 0)
            read_multiple(planner, value, node, &setting->multiple);
        else
            overrides[setting->override_count++] = assignment(pool, axes[i].key, value);
    }
    name_setting(planner, setting, axes, count);
}

/* The values of a key, one or a list, as texts of YAML. Returns their number; 0 after a fault, which is reported. */
static int32_t read_values(Planner *planner, const ShvNode *node, const char ***values)
{
    const bool list = node->kind == SHV_NODE_LIST;
    const int32_t count = list ? node->count : 1;
    if (count == 0) {
        shv_error(planner->diagnostics, node->place, "the list of values is empty");
        return 0;
    }
    *values = shv_pool_take(planner->pool, (size_t)count, sizeof **values);
    if (!*values) return 0;
    int32_t i = 0;
    if (!list) (*values)[i++] = shv_tree_text(planner->pool, node);
    for (const ShvEntry *entry = node->first; list && entry; entry = entry->next)
        (*values)[i++] = shv_tree_text(planner->pool, entry->value);
    return count;
}

static bool given_twice(const Axis *axis)
{
    for (int32_t i = 0; i < axis->count; i++)
        for (int32_t k = 0; k < i; k++)
            if (axis->values[i] && axis->values[k] && strcmp(axis->values[i], axis->values[k]) == 0) return true;
    return false;
}

static int32_t read_axes(Planner *planner, const ShvNode *block, bool columns, Axis *axes)
{
    int32_t count = 0;
    if (block->kind != SHV_NODE_MAPPING || block->count == 0 || block->count > SHV_STUDY_MOST_KEYS) {
        shv_error(planner->diagnostics, block->place, "a block of 'vary' maps 1 to %d scene keys to their values",
                  (int)SHV_STUDY_MOST_KEYS);
        return 0;
    }
    for (const ShvEntry *entry = block->first; entry; entry = entry->next) {
        Axis *axis = &axes[count++];
        *axis = (Axis){.key = entry->key->text, .column = columns ? column_of(planner, entry->key) : -1};
        axis->count = read_values(planner, entry->value, &axis->values);
        if (axis->count == 0 || (columns && axis->column < 0)) return 0;
        if (given_twice(axis))
            shv_error(planner->diagnostics, entry->value->place, "a value of '%.60s' is given twice", axis->key);
    }
    return count;
}

/* The block that a line of a plot follows: as told, or the first of these that it has, or its last key. */
static const char *choose_along(const char *told, const Axis *axes, int32_t count)
{
    const char *const wanted[] = {told, step_key, "fracture.time_step", "fracture.safety", "rigid.time_step"};
    for (size_t k = 0; k < sizeof wanted / sizeof wanted[0]; k++)
        for (int32_t i = 0; i < count && wanted[k]; i++)
            if (strcmp(axes[i].key, wanted[k]) == 0) return wanted[k];
    return axes[count - 1].key;
}

static void read_block(Planner *planner, const ShvNode *block, const char *along)
{
    Axis axes[SHV_STUDY_MOST_KEYS];
    ShvStudyPlan *plan = planner->plan;
    const int32_t count = read_axes(planner, block, true, axes);
    if (count == 0) return;
    int64_t own = 1;
    for (int32_t i = 0; i < count && own <= SHV_STUDY_MOST_SETTINGS; i++) own *= axes[i].count;
    if (plan->setting_count + own > SHV_STUDY_MOST_SETTINGS) {
        shv_error(planner->diagnostics, block->place, "more than %d settings; give fewer values",
                  (int)SHV_STUDY_MOST_SETTINGS);
        return;
    }
    /* One more than there are: that of a reference of its own comes last. */
    ShvStudySetting *grown = shv_pool_take(planner->pool, (size_t)(plan->setting_count + own + 1), sizeof *grown);
    if (!grown) return;
    if (plan->settings) memcpy(grown, plan->settings, (size_t)plan->setting_count * sizeof *grown);
    plan->settings = grown;
    planner->along = choose_along(along, axes, count);
    for (int32_t k = 0; k < own; k++) {
        int32_t rest = k; /* the last key of the block runs fastest */
        for (int32_t i = count - 1; i >= 0; rest /= axes[i--].count) axes[i].chosen = rest % axes[i].count;
        fill_setting(planner, &plan->settings[plan->setting_count++], axes, count, block);
    }
}

static void read_vary(Planner *planner, const ShvNode *vary, const char *along)
{
    planner->plan->keys = shv_pool_take(planner->pool, SHV_STUDY_MOST_KEYS, sizeof *planner->plan->keys);
    if (!planner->plan->keys || !vary) return;
    if (vary->kind != SHV_NODE_LIST) {
        read_block(planner, vary, along);
        return;
    }
    if (vary->count == 0) shv_error(planner->diagnostics, vary->place, "'vary' is empty");
    for (const ShvEntry *entry = vary->first; entry; entry = entry->next) read_block(planner, entry->value, along);
}

/* ---- the rest ---- */

static void read_reference(Planner *planner, const ShvNode *node)
{
    Axis axes[SHV_STUDY_MOST_KEYS];
    ShvStudyPlan *plan = planner->plan;
    const bool text = node && node->kind == SHV_NODE_SCALAR && node->text;
    if (!node || (text && strcmp(node->text, "closed form") == 0)) return;
    if (node->kind != SHV_NODE_MAPPING) {
        shv_error(planner->diagnostics, node->place, "'reference' is 'closed form' or the keys of a run of its own");
        return;
    }
    plan->reference = SHV_STUDY_SETTING;
    const int32_t count = read_axes(planner, node, false, axes);
    for (int32_t i = 0; i < count; i++)
        if (axes[i].count != 1)
            shv_error(planner->diagnostics, node->place, "the reference is one run: give one value of '%.60s'",
                      axes[i].key);
    planner->along = "";
    if (count > 0 && plan->settings) fill_setting(planner, &plan->settings[plan->setting_count], axes, count, node);
}

typedef struct MeasureItem {
    ShvItemHead head;
    ShvMeasure measure;
} MeasureItem;
#define MEASURE(member) offsetof(MeasureItem, measure.member)
static const ShvKey measure_keys[] = {{"name", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = MEASURE(name)},
                                      {"error", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = MEASURE(error)},
                                      {"value", SHV_KEY_TEXT, .offset = MEASURE(value)},
                                      {"unit", SHV_KEY_TEXT, .offset = MEASURE(error_unit)}};
static void start_measure(void *item)
{
    *(MeasureItem *)item = (MeasureItem){.measure = {.error_unit = ""}};
}
static const ShvTable measure_table = {.name = "a measure",
                                       .keys = measure_keys,
                                       .key_count = LENGTH_OF(measure_keys),
                                       .size = sizeof(MeasureItem),
                                       .start = start_measure};

/* {name: …, error: formula, value: formula, unit: …} */
static bool read_formula(Planner *planner, const ShvNode *node, ShvMeasure *measure)
{
    MeasureItem item;
    ShvReader reader = {planner->pool, planner->pool, planner->diagnostics, NULL};
    shv_read_document(&reader, &measure_table, node, &item);
    if (!item.head.good || planner->pool->failed) return false;
    *measure = item.measure;
    if (measure->value) measure->unit = measure->error_unit;
    if (shv_is_name(measure->name)) return true;
    shv_error(planner->diagnostics, node->place, "the name of a measure is made of letters, digits, '_' and '-'");
    return false;
}

static bool read_measure(Planner *planner, const ShvNode *node, ShvMeasure *measure)
{
    if (node->kind == SHV_NODE_MAPPING) return read_formula(planner, node, measure);
    const char *names[SHV_STUDY_MOST_MEASURES], *text = node->kind == SHV_NODE_SCALAR && node->text ? node->text : "";
    const ShvMeasure *known = shv_measure_named(text);
    if (known) *measure = *known;
    if (known) return true;
    const int32_t count = shv_measure_count();
    for (int32_t i = 0; i < count; i++) names[i] = shv_measure_at(i)->name;
    const char *near = shv_nearest_name(text, names, (size_t)count);
    shv_error(planner->diagnostics, node->place, "there is no measure %s%s%s%s; docs/study.md lists them",
              shv_quoted(text).text, near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
    return false;
}

static void read_measures(Planner *planner, const ShvNode *node)
{
    ShvStudyPlan *plan = planner->plan;
    if (!node) return;
    if (node->kind != SHV_NODE_LIST || node->count == 0 || node->count > SHV_STUDY_MOST_MEASURES) {
        shv_error(planner->diagnostics, node->place, "'measures' is a list of 1 to %d names; docs/study.md lists them",
                  (int)SHV_STUDY_MOST_MEASURES);
        return;
    }
    for (const ShvEntry *item = node->first; item; item = item->next) {
        ShvMeasure *measure = &plan->measures[plan->measure_count];
        if (!read_measure(planner, item->value, measure)) continue;
        for (int32_t i = 0; i < plan->measure_count; i++)
            if (strcmp(plan->measures[i].name, measure->name) == 0)
                shv_error(planner->diagnostics, item->value->place, "the measure %s is given twice",
                          shv_quoted(measure->name).text);
        plan->measure_count++;
    }
}

/* ---- the file ---- */

typedef struct StudyItem {
    ShvItemHead head;
    int32_t version, repeats, audit_wakes, seeds, shifts;
    double size; /* m */
    const char *name, *along;
    const ShvNode *set, *vary, *reference, *measures; /* NULL: not given */
} StudyItem;

#define STUDY(member) offsetof(StudyItem, member)
static const ShvRange version = {1.0, 1.0, false, false}, repeats = {1.0, 50.0, false, false},
                      wakes = {0.0, 1e6, false, false}, members = {SHV_STUDY_LEAST_MEMBERS, 1000.0, false, false},
                      size = {0.0, 1.0, true, false};
static const ShvKey ensemble_keys[] = {
    {"seeds", SHV_KEY_INT32, .range = &members, .offset = STUDY(seeds)},
    {"shifts", SHV_KEY_INT32, .range = &members, .offset = STUDY(shifts)},
    {"size", SHV_KEY_NUMBER, SHV_DIMENSION_LENGTH, .range = &size, .offset = STUDY(size)}};
static const ShvTable ensemble_table = {
    .name = "'ensemble'", .keys = ensemble_keys, .key_count = LENGTH_OF(ensemble_keys)};
static const ShvKey study_keys[] = {
    {"shiver_study", SHV_KEY_INT32, .flags = SHV_KEY_REQUIRED, .range = &version, .offset = STUDY(version)},
    {"name", SHV_KEY_TEXT, .offset = STUDY(name)},
    {"set", SHV_KEY_NODE, .offset = STUDY(set)},
    {"vary", SHV_KEY_NODE, .offset = STUDY(vary)},
    {"reference", SHV_KEY_NODE, .offset = STUDY(reference)},
    {"measures", SHV_KEY_NODE, .offset = STUDY(measures)},
    {"repeats", SHV_KEY_INT32, .range = &repeats, .offset = STUDY(repeats)},
    {"ensemble", SHV_KEY_MAPPING, .table = &ensemble_table},
    {"audit_wakes", SHV_KEY_INT32, .range = &wakes, .offset = STUDY(audit_wakes)},
    {"along", SHV_KEY_TEXT, .offset = STUDY(along)}};
static void start_study(void *item)
{
    *(StudyItem *)item = (StudyItem){.name = "study", .repeats = 1};
}
static const ShvTable study_table = {.name = "the study",
                                     .keys = study_keys,
                                     .key_count = LENGTH_OF(study_keys),
                                     .size = sizeof(StudyItem),
                                     .start = start_study};

static void read_ensemble(Planner *planner, const StudyItem *item)
{
    ShvStudyPlan *plan = planner->plan;
    const int32_t count = item->seeds > 0 ? item->seeds : item->shifts;
    if ((item->seeds > 0 && item->shifts > 0) || (item->shifts > 0) != (item->size > 0.0))
        shv_error(planner->diagnostics, item->head.node->place,
                  "'ensemble' is {seeds: 5} or {shifts: 5, size: 1e-9}, a displacement in m");
    plan->members = count > 0 ? count : 1;
    plan->seeds = item->seeds > 0;
    plan->shift = item->size;
}

static void check_together(Planner *planner, const ShvNode *reference)
{
    const ShvStudyPlan *plan = planner->plan;
    if (!reference || plan->reference != SHV_STUDY_CLOSED) return;
    if (plan->members > 1)
        shv_error(planner->diagnostics, reference->place,
                  "an ensemble has no closed form; take another reference or leave out 'ensemble'");
    for (int32_t i = 0; i < plan->measure_count; i++)
        if (!shv_measure_tracks(&plan->measures[i]) && !shv_measure_is_own(&plan->measures[i]))
            shv_error(planner->diagnostics, reference->place, "'%s' has no closed form; take another reference",
                      plan->measures[i].name);
}

/* What is missing, and how it is written. Which setting is the finest only its author knows: values of a key have no order. */
static void check_parts(Planner *planner, const StudyItem *item, const ShvNode *root)
{
    const struct {
        const ShvNode *node;
        const char *text;
    } parts[] = {
        {item->vary, "'vary', the keys and values to run, such as 'vary: {step: [0.5, 1, 2]}'"},
        {item->measures, "'measures', what is compared, such as 'measures: [dissipated, fragments]'"},
        {item->reference, "'reference', what errors are taken from: the keys of the finest setting, such as "
                          "'reference: {step: 0.25}', or 'reference: closed form' where the scene has a 'reference'"},
    };
    for (size_t i = 0; i < LENGTH_OF(parts); i++)
        if (!parts[i].node) shv_error(planner->diagnostics, root->place, "the study must have %s", parts[i].text);
}

static void read_plan(Planner *planner, const ShvNode *root, const char *const *more, int32_t more_count)
{
    StudyItem item;
    ShvStudyPlan *plan = planner->plan;
    ShvReader reader = {planner->pool, planner->pool, planner->diagnostics, NULL};
    shv_read_document(&reader, &study_table, root, &item);
    if (item.head.good) check_parts(planner, &item, root); /* else a misspelt one has been told */
    plan->name = item.name;
    plan->repeats = item.repeats;
    plan->audit_wakes = item.audit_wakes;
    read_fixed(planner, item.set, more, more_count);
    read_vary(planner, item.vary, item.along);
    read_measures(planner, item.measures);
    read_ensemble(planner, &item);
    read_reference(planner, item.reference);
    check_together(planner, item.reference);
}

ShvStatus shv_study_plan_read(ShvStudyPlan *plan, const char *text, size_t length, const char *name,
                              const char *const *more, int32_t more_count, ShvMemory *memory, ShvError *error)
{
    *plan = (ShvStudyPlan){.pool = {.memory = memory}, .repeats = 1, .members = 1};
    ShvDiagnostics *diagnostics = shv_diagnostics_create(memory, name, NULL, 0);
    if (!diagnostics) return shv_fail_memory(error, "the messages of a study", 0);
    Planner planner = {plan, &plan->pool, diagnostics, NULL, 0, ""};
    const ShvNode *root = shv_tree_read(&plan->pool, diagnostics, text, length, 0);
    if (root) read_plan(&planner, root, more, more_count);
    const ShvStatus status = shv_diagnostics_end(diagnostics, plan->pool.failed, "the study", length, error);
    shv_diagnostics_destroy(diagnostics);
    if (status != SHV_OK) shv_study_plan_release(plan);
    return status;
}

void shv_study_plan_release(ShvStudyPlan *plan)
{
    shv_pool_release(&plan->pool);
    *plan = (ShvStudyPlan){.name = NULL};
}
