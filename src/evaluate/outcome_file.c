#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/publish.h"
#include "base/text.h"
#include "evaluate/outcome.h"

#define HEAD "shiver-outcome 1"
enum { LARGEST_FILE = 1 << 30 };

/* ---- writing ---- */

static void put_text(FILE *stream, const char *name, const char *text)
{
    shv_print(stream, "%s ", name);
    for (; *text; text++) shv_print(stream, "%c", *text == '\n' || *text == '\r' ? ' ' : *text);
    shv_print(stream, "\n");
}

void shv_outcome_put(const ShvOutcome *outcome, FILE *stream)
{
    shv_print(stream, HEAD "\nkey %016llx\nstatus %d\n", (unsigned long long)outcome->key, (int)outcome->status);
    put_text(stream, "message", outcome->message);
    put_text(stream, "processor", outcome->processor);
    shv_print(stream, "shared %d\nlists %d\n", (int)outcome->shared, (int)outcome->list_count);
    for (int32_t i = 0; i < outcome->list_count; i++) {
        const ShvOutcomeList *list = &outcome->lists[i];
        shv_print(stream, "%s %d %lld", list->name, (int)list->clock, (long long)list->count);
        for (int64_t k = 0; k < list->count; k++) shv_print(stream, " %a", list->values[k]);
        shv_print(stream, "\n");
    }
    shv_print(stream, "end\n");
}

ShvStatus shv_outcome_save(const ShvOutcome *outcome, const char *path, ShvError *error)
{
    char *temporary = NULL;
    int descriptor;
    SHV_TRY(shv_publish_begin(outcome->memory, path, &temporary, &descriptor, error));
    FILE *stream = fdopen(descriptor, "w");
    ShvStatus status = SHV_OK;
    if (stream) {
        shv_outcome_put(outcome, stream);
        if (fflush(stream) != 0 || ferror(stream) != 0)
            status = shv_fail(error, SHV_FILE_ERROR, "cannot write '%s'; make room on the disk", path);
        if (status == SHV_OK) status = shv_publish_end(temporary, descriptor, path, true, error);
        fclose(stream);
    } else {
        close(descriptor);
        status = shv_fail_memory(error, "a stream", sizeof(FILE));
    }
    if (status != SHV_OK) unlink(temporary);
    shv_release(temporary);
    return status;
}

/* ---- reading ---- */

typedef struct Reader {
    char *at, *end;
    bool good;
} Reader;

static void expect(Reader *reader, const char *word)
{
    const size_t length = strlen(word);
    reader->at += strspn(reader->at, " \n");
    reader->good = reader->good && strncmp(reader->at, word, length) == 0;
    if (reader->good) reader->at += length;
}

static int64_t get_integer(Reader *reader, int base)
{
    char *end = reader->at;
    reader->at += strspn(reader->at, " \n");
    const uint64_t value =
        base == 16 ? (uint64_t)strtoull(reader->at, &end, 16) : (uint64_t)strtoll(reader->at, &end, 10);
    reader->good = reader->good && end > reader->at;
    reader->at = end;
    return (int64_t)value;
}

static void get_line(Reader *reader, const char *name, char *text, size_t size)
{
    expect(reader, name);
    if (!reader->good) return;
    if (*reader->at == ' ') reader->at++;
    const size_t length = strcspn(reader->at, "\n");
    shv_format(text, size, "%.*s", (int)length, reader->at);
    reader->at += length;
}

static void get_list(Reader *reader, ShvOutcome *outcome)
{
    char name[96];
    reader->at += strspn(reader->at, " \n");
    const size_t length = strcspn(reader->at, " \n");
    reader->good = reader->good && length > 0 && length < sizeof name;
    if (!reader->good) return;
    shv_format(name, sizeof name, "%.*s", (int)length, reader->at);
    reader->at += length;
    const int64_t clock = get_integer(reader, 10), count = get_integer(reader, 10);
    /* Each number takes at least two bytes of what is left of the file. */
    reader->good = reader->good && clock >= 0 && clock <= SHV_CLOCK_PROBE && count >= 0 &&
                   count <= (reader->end - reader->at) / 2 + 1;
    if (reader->good) shv_outcome_add_all(outcome, name, (ShvClock)clock, NULL, 0);
    for (int64_t i = 0; i < count && reader->good && !outcome->failed; i++) {
        char *end = reader->at;
        reader->at += strspn(reader->at, " \n");
        const double value = shv_text_to_double(reader->at, &end);
        reader->good = end > reader->at;
        reader->at = end;
        outcome->cursor--; /* the same list again */
        shv_outcome_add(outcome, name, (ShvClock)clock, value);
    }
}

static void get_outcome(Reader *reader, ShvOutcome *outcome)
{
    expect(reader, HEAD "\n");
    expect(reader, "key");
    outcome->key = (uint64_t)get_integer(reader, 16);
    expect(reader, "status");
    outcome->status = (ShvStatus)get_integer(reader, 10);
    get_line(reader, "message", outcome->message, sizeof outcome->message);
    get_line(reader, "processor", outcome->processor, sizeof outcome->processor);
    expect(reader, "shared");
    outcome->shared = get_integer(reader, 10) != 0;
    expect(reader, "lists");
    const int64_t count = get_integer(reader, 10);
    for (int64_t i = 0; i < count && reader->good && !outcome->failed; i++) get_list(reader, outcome);
    expect(reader, "end");
}

ShvStatus shv_outcome_parse(ShvOutcome *outcome, char *text, size_t size, const char *name, ShvMemory *memory,
                            ShvError *error)
{
    Reader reader = {text, text + size, true};
    *outcome = (ShvOutcome){.memory = memory};
    get_outcome(&reader, outcome);
    if (reader.good && !outcome->failed) return SHV_OK;
    const bool memory_out = outcome->failed;
    shv_outcome_release(outcome);
    if (memory_out) return shv_fail_memory(error, "what is kept of a run", size);
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
