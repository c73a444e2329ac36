#include <string.h>

#include "base/file.h"
#include "evaluate/outcome.h"
#include "export/output.h"

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
