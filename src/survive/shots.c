#include "survive/shots.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/publish.h"
#include "base/text.h"
#include "export/output.h"

enum { COLUMNS = 4 + SHV_SHOT_PIECES + 3, LARGEST_BYTES = 256 << 20 };
static const char heads[] = "specimen,height,broken,pieces,share1,share2,share3,share4,share5,x,y,z\n";

void shv_shots_release(ShvShots *shots)
{
    shv_release(shots->items);
    shots->items = NULL;
    shots->count = shots->capacity = 0;
}

ShvStatus shv_shots_add(ShvShots *shots, const ShvShot *shot, ShvError *error)
{
    if (shots->count == shots->capacity) {
        const int32_t capacity = 2 * shots->capacity + 64;
        ShvShot *items = shv_reallocate(shots->memory, SHV_PART_GENERAL, shots->items, (size_t)capacity, sizeof *items);
        if (!items) return shv_fail_memory(error, "the shots", (size_t)capacity * sizeof *items);
        shots->items = items;
        shots->capacity = capacity;
    }
    shots->items[shots->count++] = *shot;
    return SHV_OK;
}

/* ---- text ---- */

void shv_shot_put_heads(FILE *stream)
{
    fputs(heads, stream);
}

void shv_shot_put(FILE *stream, const ShvShot *shot)
{
    char height[SHV_OUTPUT_NUMBER];
    shv_output_format(height, shot->height);
    shv_print(stream, "%" PRIu64 ",%s,%d,%d", shot->specimen, height, (int)shot->broken, (int)shot->pieces);
    for (int i = 0; i < SHV_SHOT_PIECES; i++) shv_output_number(stream, shot->shares[i]);
    for (int i = 0; i < 3; i++) shv_output_number(stream, shot->origin[i]);
    fputc('\n', stream);
}

static void first_line(char *line, size_t size, uint64_t key)
{
    shv_format(line, size, "# shiver survive 1, key %016" PRIx64 "\n", key);
}

/* The numbers of a line; an empty field is NaN. */
static bool read_numbers(const char *line, size_t length, double numbers[COLUMNS])
{
    const char *end = line + length;
    for (int i = 0; i < COLUMNS; i++) {
        const char *comma = memchr(line, ',', (size_t)(end - line));
        const size_t field = (size_t)((comma ? comma : end) - line);
        if ((comma != NULL) != (i + 1 < COLUMNS)) return false;
        numbers[i] = (double)NAN;
        if (field > 0 && shv_parse_double(line, field, false, &numbers[i], NULL) != SHV_OK) return false;
        line += field + 1;
    }
    return true;
}

static bool read_shot(const char *line, size_t length, ShvShot *shot)
{
    double n[COLUMNS];
    const double most_specimens = 9007199254740992.0; /* 2⁵³: whole numbers up to there are exact */
    if (!read_numbers(line, length, n)) return false;
    if (!(n[0] >= 0.0 && n[0] < most_specimens && n[1] > 0.0 && (n[2] == 0.0 || n[2] == 1.0) && n[3] >= 0.0 &&
          n[3] < 1e9))
        return false;
    *shot = (ShvShot){.specimen = (uint64_t)n[0], .height = n[1], .broken = n[2] == 1.0, .pieces = (int32_t)n[3]};
    for (int i = 0; i < SHV_SHOT_PIECES; i++) shot->shares[i] = n[4 + i];
    for (int i = 0; i < 3; i++) shot->origin[i] = n[4 + SHV_SHOT_PIECES + i];
    return true;
}

static ShvStatus parse(ShvShots *shots, const char *path, const char *text, uint64_t key, size_t *whole,
                       ShvError *error)
{
    char first[64];
    const char *line = text;
    first_line(first, sizeof first, key);
    *whole = 0;
    for (int number = 1; line[0]; number++) {
        const char *end = strchr(line, '\n');
        ShvShot shot;
        if (!end) return SHV_OK; /* it was broken off in this line */
        const size_t length = (size_t)(end - line);
        const char *wanted = number == 1 ? first : number == 2 ? heads : NULL;
        if (number == 1 && strncmp(line, "# shiver survive ", 17) == 0 && strncmp(line, first, length + 1) != 0)
            return shv_fail(error, SHV_BAD_INPUT,
                            "the shots in '%s' are of another scene or version; give another folder, or --force", path);
        if (wanted ? strncmp(line, wanted, length + 1) != 0 : !read_shot(line, length, &shot))
            return shv_fail(error, SHV_BAD_INPUT, "%s:%d: not a line of a table of shots; remove the file", path,
                            number);
        if (!wanted) SHV_TRY(shv_shots_add(shots, &shot, error));
        line = end + 1;
        *whole = (size_t)(line - text);
    }
    return SHV_OK;
}

ShvStatus shv_shots_read(ShvShots *shots, const char *path, uint64_t key, size_t *whole, ShvError *error)
{
    char *text;
    size_t size, complete;
    SHV_TRY(shv_read_file(shots->memory, SHV_PART_GENERAL, path, LARGEST_BYTES, &text, &size, error));
    const ShvStatus status = parse(shots, path, text, key, &complete, error);
    if (whole) *whole = complete;
    shv_release(text);
    return status;
}

/* ---- writing ---- */

static ShvStatus fail_to_write(const char *path, ShvError *error)
{
    return shv_fail(error, SHV_FILE_ERROR, "cannot write '%s': %s", path, strerror(errno));
}

/* What has been written is on the disk. */
static ShvStatus sync_table(const ShvShotTable *table, ShvError *error)
{
    if (fflush(table->stream) != 0 || ferror(table->stream)) return fail_to_write(table->path, error);
    return shv_publish_sync(fileno(table->stream), table->path, error);
}

static ShvStatus begin(ShvShotTable *table, uint64_t key, ShvError *error)
{
    char line[64];
    first_line(line, sizeof line, key);
    fputs(line, table->stream);
    shv_shot_put_heads(table->stream);
    SHV_TRY(sync_table(table, error));
    return shv_publish_sync_folder(table->path, error);
}

static ShvStatus resume(ShvShotTable *table, ShvShots *shots, uint64_t key, bool anew, ShvError *error)
{
    size_t whole = 0;
    struct stat about;
    if (flock(fileno(table->stream), LOCK_EX | LOCK_NB) != 0)
        return shv_fail(error, SHV_FILE_ERROR, "'%s' is being written by another process", table->path);
    if (fstat(fileno(table->stream), &about) != 0) return fail_to_write(table->path, error);
    if (!anew && about.st_size > 0) SHV_TRY(shv_shots_read(shots, table->path, key, &whole, error));
    if (ftruncate(fileno(table->stream), (off_t)whole) != 0) return fail_to_write(table->path, error);
    return whole > 0 ? SHV_OK : begin(table, key, error);
}

ShvStatus shv_shot_table_open(ShvShotTable *table, ShvShots *shots, const char *path, uint64_t key, bool anew,
                              ShvError *error)
{
    *table = (ShvShotTable){.path = path};
    const int descriptor = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor < 0) return fail_to_write(path, error);
    table->stream = fdopen(descriptor, "a");
    if (!table->stream) {
        close(descriptor);
        return fail_to_write(path, error);
    }
    const ShvStatus status = resume(table, shots, key, anew, error);
    if (status != SHV_OK) shv_shot_table_close(table);
    return status;
}

ShvStatus shv_shot_table_append(ShvShotTable *table, const ShvShot *shot, ShvError *error)
{
    shv_shot_put(table->stream, shot);
    return sync_table(table, error);
}

void shv_shot_table_close(ShvShotTable *table)
{
    if (table->stream) fclose(table->stream);
    table->stream = NULL;
}
