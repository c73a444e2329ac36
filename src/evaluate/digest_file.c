/* A digest as a text file: words and hexadecimal numbers apart by blanks, texts a line each, "end" last. */
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/publish.h"
#include "base/text.h"
#include "evaluate/digest.h"

#define HEAD "shiver-digest 1"
enum { LARGEST_FILE = 1 << 30, STATE_NUMBERS = 13 };

/* ---- writing ---- */

static void put_text(FILE *stream, const char *name, const char *text)
{
    shv_print(stream, "%s ", name);
    for (; *text; text++) shv_print(stream, "%c", *text == '\n' || *text == '\r' ? ' ' : *text);
    shv_print(stream, "\n");
}

static void put_numbers(FILE *stream, const char *name, const double *values, int64_t count)
{
    shv_print(stream, "%s %lld", name, (long long)count);
    for (int64_t i = 0; i < count; i++) shv_print(stream, " %a", values[i]);
    shv_print(stream, "\n");
}

static void put_crack(FILE *stream, const ShvCrackSurface *crack)
{
    shv_print(stream, "crack %016llx %d\n", (unsigned long long)crack->mesh, (int)crack->count);
    for (int32_t i = 0; i < crack->count; i++) {
        const ShvCrackFacet *facet = &crack->facets[i];
        shv_print(stream, "%d %d %d", (int)facet->nodes[0], (int)facet->nodes[1], (int)facet->nodes[2]);
        for (int k = 0; k < 3; k++)
            shv_print(stream, " %a %a %a", facet->corners[k].x, facet->corners[k].y, facet->corners[k].z);
        shv_print(stream, "\n");
    }
}

static void state_to_numbers(const ShvBodyState *state, double numbers[STATE_NUMBERS])
{
    shv_store3(numbers, state->position);
    const double turn[] = {state->orientation.w, state->orientation.x, state->orientation.y, state->orientation.z};
    memcpy(numbers + 3, turn, sizeof turn);
    shv_store3(numbers + 7, state->velocity);
    shv_store3(numbers + 10, state->angular_velocity);
}

static void put_track(FILE *stream, const ShvDigest *digest)
{
    shv_print(stream, "track %d %d %d\n", (int)digest->tracked, (int)digest->frame_count, (int)digest->body_count);
    for (int32_t i = 0; i < digest->frame_count; i++) {
        shv_print(stream, "%a", digest->times[i]);
        for (int32_t k = 0; k < digest->body_count; k++) {
            double numbers[STATE_NUMBERS];
            state_to_numbers(&digest->states[(int64_t)i * digest->body_count + k], numbers);
            for (int j = 0; j < STATE_NUMBERS; j++) shv_print(stream, " %a", numbers[j]);
        }
        shv_print(stream, "\n");
    }
}

static void put_digest(FILE *stream, const ShvDigest *digest)
{
    shv_print(stream, HEAD "\nkey %016llx\nstatus %d\n", (unsigned long long)digest->key, (int)digest->status);
    put_text(stream, "message", digest->message);
    put_text(stream, "processor", digest->processor);
    shv_print(stream, "shared %d\nthreads %d\n", (int)digest->shared, (int)digest->threads);
    put_numbers(stream, "numbers", digest->numbers, SHV_DIGEST_NUMBERS);
    put_numbers(stream, "costs", digest->costs, SHV_COST_COUNT);
    put_numbers(stream, "seconds", digest->seconds, digest->repeats);
    put_numbers(stream, "masses", digest->masses, digest->mass_count);
    put_crack(stream, &digest->crack);
    put_track(stream, digest);
    shv_print(stream, "end\n");
}

ShvStatus shv_digest_save(const ShvDigest *digest, const char *path, ShvError *error)
{
    char *temporary = NULL;
    int descriptor;
    SHV_TRY(shv_publish_begin(digest->memory, path, &temporary, &descriptor, error));
    FILE *stream = fdopen(descriptor, "w");
    ShvStatus status = SHV_OK;
    if (stream) {
        put_digest(stream, digest);
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

/* A count of things that each take at least two bytes of what is left of the file. */
static int32_t get_count(Reader *reader)
{
    const int64_t count = get_integer(reader, 10);
    reader->good = reader->good && count >= 0 && count <= (reader->end - reader->at) / 2 + 1 && count < INT32_MAX;
    return reader->good ? (int32_t)count : 0;
}

static double get_number(Reader *reader)
{
    char *end = reader->at;
    reader->at += strspn(reader->at, " \n");
    const double value = shv_text_to_double(reader->at, &end);
    reader->good = reader->good && end > reader->at;
    reader->at = end;
    return value;
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

static void get_fixed(Reader *reader, const char *name, double *values, int32_t count)
{
    expect(reader, name);
    reader->good = reader->good && get_count(reader) == count;
    for (int32_t i = 0; i < count && reader->good; i++) values[i] = get_number(reader);
}

static double *get_list(Reader *reader, const char *name, ShvMemory *memory, int32_t *count)
{
    expect(reader, name);
    const int32_t wanted = get_count(reader);
    double *values = shv_allocate(memory, SHV_PART_RECORD, (size_t)wanted, sizeof *values);
    if (!values) return NULL;
    for (int32_t i = 0; i < wanted && reader->good; i++) values[i] = get_number(reader);
    *count = wanted;
    return values;
}

static ShvStatus get_crack(Reader *reader, ShvDigest *digest, ShvError *error)
{
    expect(reader, "crack");
    digest->crack.mesh = (uint64_t)get_integer(reader, 16);
    const int32_t count = get_count(reader);
    digest->crack.facets = shv_allocate(digest->memory, SHV_PART_RECORD, (size_t)count, sizeof(ShvCrackFacet));
    if (!digest->crack.facets) return shv_fail_memory(error, "failed facets", (size_t)count * sizeof(ShvCrackFacet));
    for (int32_t i = 0; i < count && reader->good; i++) {
        ShvCrackFacet *facet = &digest->crack.facets[i];
        for (int k = 0; k < 3; k++) facet->nodes[k] = (int32_t)get_integer(reader, 10);
        for (int k = 0; k < 3; k++) {
            double corner[3];
            for (int j = 0; j < 3; j++) corner[j] = get_number(reader);
            facet->corners[k] = shv_load3(corner);
        }
    }
    digest->crack.count = count;
    return SHV_OK;
}

static ShvBodyState state_of_numbers(const double n[STATE_NUMBERS])
{
    return (ShvBodyState){shv_load3(n), {n[3], n[4], n[5], n[6]}, shv_load3(n + 7), shv_load3(n + 10)};
}

static ShvStatus get_track(Reader *reader, ShvDigest *digest, ShvError *error)
{
    expect(reader, "track");
    digest->tracked = get_integer(reader, 10) != 0;
    const int32_t frames = get_count(reader), bodies = get_count(reader);
    reader->good = reader->good && (int64_t)frames * bodies <= reader->end - reader->at;
    if (!reader->good) return SHV_OK;
    const size_t count = (size_t)frames * (size_t)bodies;
    digest->times = shv_allocate(digest->memory, SHV_PART_RECORD, (size_t)frames, sizeof(double));
    digest->states = shv_allocate(digest->memory, SHV_PART_RECORD, count, sizeof(ShvBodyState));
    if (!digest->times || !digest->states)
        return shv_fail_memory(error, "the way of bodies", count * sizeof(ShvBodyState));
    for (int32_t i = 0; i < frames && reader->good; i++) {
        digest->times[i] = get_number(reader);
        for (int32_t k = 0; k < bodies && reader->good; k++) {
            double numbers[STATE_NUMBERS];
            for (int j = 0; j < STATE_NUMBERS; j++) numbers[j] = get_number(reader);
            digest->states[(int64_t)i * bodies + k] = state_of_numbers(numbers);
        }
    }
    digest->frame_count = digest->frame_capacity = frames;
    digest->body_count = bodies;
    return SHV_OK;
}

static ShvStatus get_digest(Reader *reader, ShvDigest *digest, ShvError *error)
{
    expect(reader, HEAD "\n");
    expect(reader, "key");
    digest->key = (uint64_t)get_integer(reader, 16);
    expect(reader, "status");
    digest->status = (ShvStatus)get_integer(reader, 10);
    get_line(reader, "message", digest->message, sizeof digest->message);
    get_line(reader, "processor", digest->processor, sizeof digest->processor);
    expect(reader, "shared");
    digest->shared = get_integer(reader, 10) != 0;
    expect(reader, "threads");
    digest->threads = (int32_t)get_integer(reader, 10);
    get_fixed(reader, "numbers", digest->numbers, SHV_DIGEST_NUMBERS);
    get_fixed(reader, "costs", digest->costs, SHV_COST_COUNT);
    digest->seconds = get_list(reader, "seconds", digest->memory, &digest->repeats);
    digest->masses = get_list(reader, "masses", digest->memory, &digest->mass_count);
    if (!digest->seconds || !digest->masses) return shv_fail_memory(error, "a run of the study", 0);
    SHV_TRY(get_crack(reader, digest, error));
    SHV_TRY(get_track(reader, digest, error));
    expect(reader, "end");
    return SHV_OK;
}

ShvStatus shv_digest_load(ShvDigest *digest, const char *path, ShvMemory *memory, ShvError *error)
{
    char *data;
    size_t size;
    *digest = (ShvDigest){.memory = memory};
    SHV_TRY(shv_read_file(memory, SHV_PART_RECORD, path, LARGEST_FILE, &data, &size, error));
    Reader reader = {data, data + size, true};
    ShvStatus status = get_digest(&reader, digest, error);
    if (status == SHV_OK && !reader.good)
        status = shv_fail(error, SHV_BAD_INPUT, "'%s' is not a whole run of a study; remove it", path);
    shv_release(data);
    if (status != SHV_OK) shv_digest_release(digest);
    return status;
}
