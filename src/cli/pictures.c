#include "cli/pictures.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/publish.h"
#include "cli/browser.h"
#include "cli/elasticity.h"
#include "cli/programs.h"
#include "shiver/view.h"

/* Pictures a second of a film; of an animated picture for pages, which must be small. */
enum { FILM_RATE = 30, PAGE_RATE = 15 };
enum { MOST_BYTES = 1 << 30 };

/* A folder for the page, the browser's own files and the pictures of a film, and the browser. */
typedef struct Studio {
    const ShvPictures *pictures;
    ShvRunFile *file;
    ShvTemporary place;
    char page[SHV_CLI_PATH], profile[SHV_CLI_PATH];
    ShvBrowser browser;
} Studio;

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
    (void)number;
    interrupted = 1;
}

/* ---- one picture ---- */

static int digit_of(char letter)
{
    if (letter >= 'A' && letter <= 'Z') return letter - 'A';
    if (letter >= 'a' && letter <= 'z') return letter - 'a' + 26;
    if (letter >= '0' && letter <= '9') return letter - '0' + 52;
    return letter == '+' ? 62 : letter == '/' ? 63 : -1;
}

/* In place; returns the number of bytes. */
static size_t decode_base64(char *text)
{
    unsigned group = 0;
    int bits = 0;
    size_t count = 0;
    for (const char *letter = text; digit_of(*letter) >= 0; letter++) {
        group = group << 6 | (unsigned)digit_of(*letter);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        text[count++] = (char)(group >> bits & 255u);
    }
    return count;
}

static ShvStatus write_bytes(const char *path, const char *bytes, size_t count, bool force, ShvError *error)
{
    char *temporary = NULL;
    int descriptor = -1;
    ShvStatus status = shv_publish_begin(NULL, path, &temporary, &descriptor, error);
    for (size_t done = 0; done < count && status == SHV_OK;) {
        const ssize_t written = write(descriptor, bytes + done, count - done);
        if (written <= 0 && errno != EINTR)
            status = shv_fail(error, SHV_FILE_ERROR, "cannot write '%s'; make room on the disk", path);
        if (written > 0) done += (size_t)written;
    }
    if (status == SHV_OK) status = shv_publish_end(temporary, descriptor, path, force, error);
    if (status != SHV_OK && temporary) unlink(temporary);
    if (descriptor >= 0) close(descriptor);
    shv_release(temporary);
    return status;
}

/* `time` is an expression of the page's script. */
static ShvStatus draw(Studio *studio, const char *time, const char *path, bool force, ShvError *error)
{
    static const char head[] = "data:image/png;base64,";
    char expression[512];
    const char *text = NULL;
    const int width = studio->pictures->width;
    snprintf(expression, sizeof expression, "shiver.then(v => v.capture(%s, %d, %d))", time, width, width * 9 / 32 * 2);
    SHV_TRY(shv_browser_ask(&studio->browser, expression, &text, error));
    if (interrupted) return shv_fail(error, SHV_INTERRUPTED, "interrupted");
    if (strncmp(text, head, sizeof head - 1) != 0)
        return shv_fail(error, SHV_FILE_ERROR, "the browser could not draw a picture of %d pixels", width);
    char *bytes = studio->browser.answer + (text - studio->browser.answer) + sizeof head - 1;
    return write_bytes(path, bytes, decode_base64(bytes), force, error);
}

/* ---- the studio ---- */

static ShvStatus write_page(Studio *studio, ShvError *error)
{
    ShvElasticity *elasticity = NULL;
    SHV_TRY(shv_cli_elasticity(studio->file, &elasticity, error));
    const ShvViewRun run = {.file = studio->file, .elasticity = elasticity};
    ShvViewOptions options = shv_view_default();
    options.every = studio->pictures->every;
    const ShvStatus status = shv_view_write(&run, 1, studio->page, &options, error);
    shv_release(elasticity);
    return status;
}

static ShvStatus set_up_page(Studio *studio, ShvError *error)
{
    char expression[512];
    const char *text = NULL, *colour = studio->pictures->colour ? studio->pictures->colour : "piece";
    if (strspn(colour, "abcdefghijklmnopqrstuvwxyz") != strlen(colour))
        return shv_fail(error, SHV_BAD_INPUT,
                        "there is no colour '%s'; give piece, mode, age, speed, mass, damage or stress", colour);
    snprintf(expression, sizeof expression,
             "shiver.then(v => [...document.querySelectorAll(`#colour option`)].some(o => o.value === `%s`) ? "
             "(v.setTheme(`light`), "
             "v.setColour(`%s`), v.clock.stretch(%s), `done`) : `none`)",
             colour, colour, studio->pictures->stretch ? "true" : "false");
    SHV_TRY(shv_browser_ask(&studio->browser, expression, &text, error));
    if (strcmp(text, "done") == 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "this run has no colour '%s'; piece, mode, age, speed and mass always are there, damage "
                    "and stress where the run recorded nodes",
                    colour);
}

static ShvStatus open_studio(Studio *studio, ShvError *error)
{
    shv_interrupt_waiting(on_signal); /* what was begun is removed */
    SHV_TRY(shv_temporary_open(&studio->place, NULL, error));
    SHV_TRY(shv_cli_path(studio->page, error, "%s/page.html", studio->place.folder));
    SHV_TRY(shv_cli_path(studio->profile, error, "%s/profile", studio->place.folder));
    SHV_TRY(write_page(studio, error));
    SHV_TRY(shv_browser_open(&studio->browser, &studio->place, studio->page, studio->profile, error));
    return set_up_page(studio, error);
}

static void close_studio(Studio *studio)
{
    shv_browser_close(&studio->browser);
    shv_temporary_close(&studio->place);
}

static ShvStatus check_width(const ShvPictures *pictures, ShvError *error)
{
    if (pictures->width >= 200 && pictures->width <= 4000) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "a picture is 200 to 4000 pixels wide; %d were given", (int)pictures->width);
}

/* ---- frames as pictures ---- */

/* Number of the i-th frame asked for. */
static int64_t frame_of(const Studio *studio, int64_t i)
{
    const ShvPictures *pictures = studio->pictures;
    if (pictures->frame_count > 0) return (int64_t)pictures->frames[i];
    return pictures->time_count > 0 ? shv_run_file_nearest(studio->file, pictures->times[i]) : i;
}

static ShvStatus name_picture(const Studio *studio, int64_t i, char path[SHV_CLI_PATH], ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(studio->file);
    const int64_t frame = frame_of(studio, i), count = info->frame_count;
    if (frame < 0 && studio->pictures->time_count > 0)
        return shv_fail(error, SHV_BAD_INPUT, "there is no time %g s: the run goes from %g to %g s",
                        studio->pictures->times[i], info->first_time, info->last_time);
    if (frame < 0 || frame >= count)
        return shv_fail(error, SHV_BAD_INPUT, "there is no frame %lld: the run has frames 0 to %lld", (long long)frame,
                        (long long)(count - 1));
    return shv_cli_path(path, error, "%s_%06lld.png", studio->pictures->prefix, (long long)frame);
}

static ShvStatus draw_frames(Studio *studio, int64_t count, ShvError *error)
{
    char path[SHV_CLI_PATH], time[64];
    for (int64_t i = 0; i < count; i++) {
        SHV_TRY(name_picture(studio, i, path, error));
        snprintf(time, sizeof time, "%.17g", shv_run_file_times(studio->file)[frame_of(studio, i)]);
        const ShvStatus status = draw(studio, time, path, studio->pictures->force, error);
        if (status == SHV_OK) continue;
        while (i-- > 0 && name_picture(studio, i, path, error) == SHV_OK) unlink(path); /* half a row is none */
        return status;
    }
    return SHV_OK;
}

/* The camera stands for what there is at the times asked for, not for a whole fall. */
static ShvStatus show_frames(Studio *studio, int64_t count, ShvError *error)
{
    const double *times = shv_run_file_times(studio->file);
    double from = times[frame_of(studio, 0)], to = from;
    char expression[128];
    const char *text;
    for (int64_t i = 1; i < count; i++) {
        from = fmin(from, times[frame_of(studio, i)]);
        to = fmax(to, times[frame_of(studio, i)]);
    }
    snprintf(expression, sizeof expression, "shiver.then(v => (v.look(%.17g, %.17g), `done`))", from, to);
    return shv_browser_ask(&studio->browser, expression, &text, error);
}

ShvStatus shv_write_png(ShvRunFile *file, const ShvPictures *pictures, ShvError *error)
{
    Studio studio = {.pictures = pictures, .file = file, .browser = {.process = -1, .to = -1, .from = -1}};
    const int64_t asked = pictures->frame_count + pictures->time_count,
                  count = asked > 0 ? asked : shv_run_file_info(file)->frame_count;
    SHV_TRY(check_width(pictures, error));
    for (int64_t i = 0; i < count; i++) {
        char path[SHV_CLI_PATH];
        SHV_TRY(name_picture(&studio, i, path, error));
        SHV_TRY(shv_publish_check(path, pictures->force, error));
    }
    ShvStatus status = open_studio(&studio, error);
    if (status == SHV_OK) status = show_frames(&studio, count, error);
    if (status == SHV_OK) status = draw_frames(&studio, count, error);
    close_studio(&studio);
    return status;
}

/* ---- films ---- */

static bool run_ffmpeg(const ShvTemporary *place, const char *rate, const char *result, bool webp)
{
    char input[SHV_TEMPORARY_PATH + 16];
    snprintf(input, sizeof input, "%s/%%06d.png", place->folder);
    /* One thread and no dates: equal films have equal bytes. */
    const char *film[] = {"ffmpeg",   "-y",        "-loglevel", "error",      "-framerate", rate,
                          "-i",       input,       "-c:v",      "libx264",    "-pix_fmt",   "yuv420p",
                          "-crf",     "20",        "-threads",  "1",          "-fflags",    "+bitexact",
                          "-flags:v", "+bitexact", "-movflags", "+faststart", result,       NULL};
    const char *page[] = {
        "ffmpeg", "-y", "-loglevel",          "error", "-framerate", rate, "-i",       input, "-c:v", "libwebp_anim",
        "-q:v",   "62", "-compression_level", "6",     "-loop",      "0",  "-threads", "1",   result, NULL};
    return shv_run_program(place, webp ? page : film);
}

static ShvStatus film(Studio *studio, const char *path, bool webp, ShvError *error)
{
    char picture[SHV_CLI_PATH], place[64], rate[16], result[SHV_CLI_PATH];
    const int frequency = webp ? PAGE_RATE : FILM_RATE, count = (int)(studio->pictures->lasts * frequency);
    for (int i = 0; i < count; i++) {
        SHV_TRY(shv_cli_path(picture, error, "%s/%06d.png", studio->place.folder, i));
        snprintf(place, sizeof place, "v.clock.timeOf(%.9g)", count > 1 ? (double)i / (count - 1) : 0.0);
        SHV_TRY(draw(studio, place, picture, true, error));
    }
    SHV_TRY(shv_cli_path(result, error, "%s/film.%s", studio->place.folder, webp ? "webp" : "mp4"));
    snprintf(rate, sizeof rate, "%d", frequency);
    if (!run_ffmpeg(&studio->place, rate, result, webp))
        return shv_fail(error, SHV_FILE_ERROR, "ffmpeg could not make a film of the pictures; see its message above");
    char *bytes = NULL;
    size_t size;
    SHV_TRY(shv_read_file(NULL, SHV_PART_GENERAL, result, MOST_BYTES, &bytes, &size, error));
    const ShvStatus status = write_bytes(path, bytes, size, studio->pictures->force, error);
    shv_release(bytes);
    return status;
}

ShvStatus shv_write_film(ShvRunFile *file, const ShvPictures *pictures, bool webp, ShvError *error)
{
    Studio studio = {.pictures = pictures, .file = file, .browser = {.process = -1, .to = -1, .from = -1}};
    char path[SHV_CLI_PATH];
    SHV_TRY(check_width(pictures, error));
    if (!(pictures->lasts >= 0.1 && pictures->lasts <= 600.0))
        return shv_fail(error, SHV_BAD_INPUT, "a film lasts 0.1 to 600 s; %g were given", pictures->lasts);
    SHV_TRY(shv_cli_path(path, error, "%s.%s", pictures->prefix, webp ? "webp" : "mp4"));
    SHV_TRY(shv_publish_check(path, pictures->force, error));
    if (!shv_on_path("ffmpeg"))
        return shv_fail(error, SHV_UNSUPPORTED,
                        "films are made by ffmpeg, which is not here: install Debian's package ffmpeg");
    ShvStatus status = open_studio(&studio, error);
    if (status == SHV_OK) status = film(&studio, path, webp, error);
    close_studio(&studio);
    return status;
}
