#include "evaluate/outcome.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "export/output.h"

void shv_outcome_release(ShvOutcome *outcome)
{
    for (int32_t i = 0; i < outcome->list_count; i++) shv_release(outcome->lists[i].values);
    shv_release(outcome->lists);
    *outcome = (ShvOutcome){.memory = NULL};
}

/* Its index, sought from where the last one was. */
static int32_t index_of(const ShvOutcome *outcome, const char *name, int32_t from)
{
    int32_t at = from < outcome->list_count ? from : 0;
    for (int32_t i = 0; i < outcome->list_count; i++) {
        if (strcmp(outcome->lists[at].name, name) == 0) return at;
        if (++at == outcome->list_count) at = 0;
    }
    return -1;
}

const ShvOutcomeList *shv_outcome_find(const ShvOutcome *outcome, const char *name)
{
    const int32_t i = index_of(outcome, name, 0);
    return i < 0 ? NULL : &outcome->lists[i];
}

const double *shv_outcome_times(const ShvOutcome *outcome, const ShvOutcomeList *list)
{
    static const char *const clocks[] = {NULL, "frame.time", "probe.time"};
    const ShvOutcomeList *times = list->clock == SHV_CLOCK_NONE ? NULL : shv_outcome_find(outcome, clocks[list->clock]);
    return times ? times->values : NULL;
}

double shv_outcome_number(const ShvOutcome *outcome, const char *name)
{
    const ShvOutcomeList *list = shv_outcome_find(outcome, name);
    return list && list->count > 0 ? list->values[list->count - 1] : (double)NAN;
}

/* An empty list of that name, or NULL. */
static ShvOutcomeList *make_list(ShvOutcome *outcome, const char *name, ShvClock clock)
{
    if (outcome->list_count == outcome->list_capacity) {
        const size_t capacity = 2 * (size_t)outcome->list_capacity + 64;
        ShvOutcomeList *grown =
            shv_reallocate(outcome->memory, SHV_PART_RECORD, outcome->lists, capacity, sizeof *grown);
        if (!grown) return NULL;
        outcome->lists = grown;
        outcome->list_capacity = (int32_t)capacity;
    }
    ShvOutcomeList *list = &outcome->lists[outcome->list_count++];
    *list = (ShvOutcomeList){.clock = clock};
    shv_format(list->name, sizeof list->name, "%.95s", name);
    return list;
}

static bool reserve(ShvOutcome *outcome, ShvOutcomeList *list, int64_t more)
{
    if (list->count + more <= list->capacity) return true;
    const size_t capacity = list->count == 0 ? (size_t)more : 2 * (size_t)(list->count + more) + 16;
    double *grown = shv_reallocate(outcome->memory, SHV_PART_RECORD, list->values, capacity, sizeof *grown);
    if (!grown) return false;
    list->values = grown;
    list->capacity = (int64_t)capacity;
    return true;
}

double *shv_outcome_room(ShvOutcome *outcome, const char *name, ShvClock clock, int64_t count)
{
    const int32_t i = index_of(outcome, name, outcome->cursor);
    ShvOutcomeList *list = i < 0 ? make_list(outcome, name, clock) : &outcome->lists[i];
    outcome->failed |= !list || !reserve(outcome, list, count);
    if (outcome->failed) return NULL;
    outcome->cursor = (int32_t)(list - outcome->lists) + 1;
    double *room = list->values ? list->values + list->count : NULL;
    list->count += count;
    return room;
}

void shv_outcome_add_all(ShvOutcome *outcome, const char *name, ShvClock clock, const void *values, int64_t count)
{
    double *room = shv_outcome_room(outcome, name, clock, count);
    if (room && count > 0) memcpy(room, values, (size_t)count * sizeof *room);
}

void shv_outcome_add(ShvOutcome *outcome, const char *name, ShvClock clock, double value)
{
    shv_outcome_add_all(outcome, name, clock, &value, 1);
}

void shv_outcome_set(ShvOutcome *outcome, const char *name, double value)
{
    const int32_t i = index_of(outcome, name, 0);
    if (i >= 0 && outcome->lists[i].count > 0)
        outcome->lists[i].values[outcome->lists[i].count - 1] = value;
    else
        shv_outcome_add(outcome, name, SHV_CLOCK_NONE, value);
}

void shv_outcome_add_vector(ShvOutcome *outcome, const char *name, ShvClock clock, const double value[3])
{
    static const char *const axes = "xyz";
    char full[96];
    for (int k = 0; k < 3; k++) {
        shv_format(full, sizeof full, "%.90s.%c", name, axes[k]);
        shv_outcome_add(outcome, full, clock, value[k]);
    }
}

/* ---- as a file ---- */

static const char word[16] = "shiver-outcome 4";
enum { LARGEST_FILE = 1 << 30 };

/* Heads and values as they lie in memory, without pointers: whoever reads them is the program that wrote them, on a machine of the
   same kind. */
void shv_outcome_put(const void *data, FILE *stream)
{
    const ShvOutcome *outcome = data;
    ShvOutcome head = *outcome;
    head.memory = NULL;
    head.lists = NULL;
    fwrite(word, sizeof word, 1, stream);
    fwrite(&head, sizeof head, 1, stream);
    for (int32_t i = 0; i < outcome->list_count; i++) {
        ShvOutcomeList list = outcome->lists[i];
        list.values = NULL;
        fwrite(&list, sizeof list, 1, stream);
        if (list.count > 0) fwrite(outcome->lists[i].values, sizeof(double), (size_t)list.count, stream);
    }
}

ShvStatus shv_outcome_save(const ShvOutcome *outcome, const char *path, ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = true;
    options.memory = outcome->memory;
    return shv_output_write(&options, path, shv_outcome_put, outcome, error);
}

/* ---- reading ---- */

typedef struct Reader {
    const char *at;
    size_t left;
} Reader;

static bool get(Reader *reader, void *data, size_t size)
{
    if (reader->left < size) return false;
    memcpy(data, reader->at, size);
    reader->at += size;
    reader->left -= size;
    return true;
}

static bool get_list(Reader *reader, ShvOutcome *outcome)
{
    ShvOutcomeList list;
    if (!get(reader, &list, sizeof list) || !memchr(list.name, '\0', sizeof list.name)) return false;
    if (list.count < 0 || (uint64_t)list.count > reader->left / sizeof(double)) return false;
    double *room = shv_outcome_room(outcome, list.name, list.clock, list.count);
    return !room || get(reader, room, (size_t)list.count * sizeof *room);
}

static bool get_outcome(Reader *reader, ShvOutcome *outcome)
{
    char begins[sizeof word];
    ShvOutcome head;
    if (!get(reader, begins, sizeof begins) || memcmp(begins, word, sizeof word) != 0) return false;
    if (!get(reader, &head, sizeof head)) return false;
    outcome->key = head.key;
    outcome->status = head.status;
    outcome->shared = head.shared;
    memcpy(outcome->message, head.message, sizeof head.message);
    memcpy(outcome->no_motion, head.no_motion, sizeof head.no_motion);
    memcpy(outcome->processor, head.processor, sizeof head.processor);
    for (int32_t i = 0; i < head.list_count && !outcome->failed; i++)
        if (!get_list(reader, outcome)) return false;
    return reader->left == 0;
}

ShvStatus shv_outcome_parse(ShvOutcome *outcome, const char *data, size_t size, const char *name, ShvMemory *memory,
                            ShvError *error)
{
    Reader reader = {data, size};
    *outcome = (ShvOutcome){.memory = memory};
    const bool good = get_outcome(&reader, outcome), failed = outcome->failed;
    if (good && !failed) return SHV_OK;
    shv_outcome_release(outcome);
    if (failed) return shv_fail_memory(error, "what is kept of a run", size);
    return shv_fail(error, SHV_BAD_INPUT, "'%s' is not a whole run of a study; remove it", name);
}

ShvStatus shv_outcome_load(ShvOutcome *outcome, const char *path, ShvMemory *memory, ShvError *error)
{
    char *data;
    size_t size;
    *outcome = (ShvOutcome){.memory = memory};
    SHV_TRY(shv_read_file(memory, SHV_PART_RECORD, path, LARGEST_FILE, &data, &size, error));
    const ShvStatus status = shv_outcome_parse(outcome, data, size, path, memory, error);
    shv_release(data);
    return status;
}
