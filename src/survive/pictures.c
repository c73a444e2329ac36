#include "survive/pictures.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "shiver/export.h"
#include "shiver/run_file.h"

enum { PICTURE_WIDTH = 900, LARGEST_DRAWING = 64 << 20 };

void shv_survive_pictures_release(ShvSurvivePictures *pictures)
{
    for (int i = 0; i < SHV_SURVIVE_PICTURES; i++) shv_release(pictures->drawing[i]);
    *pictures = (ShvSurvivePictures){0};
}

static void choose(const ShvSurviveView *view, ShvSurvivePictures *pictures)
{
    static const char *const titles[SHV_SURVIVE_PICTURES] = {"The highest fall that was survived",
                                                             "A fall from about the middle", "The highest fall"};
    const double middle = isfinite(view->laws[0].h50) ? view->laws[0].h50 : 0.0;
    double best[SHV_SURVIVE_PICTURES] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    for (int32_t i = 0; i < view->shot_count; i++) {
        const ShvShot *shot = &view->shots[i];
        const double away = log(shot->height / middle);
        const double score[SHV_SURVIVE_PICTURES] = {shot->broken ? HUGE_VAL : -shot->height,
                                                    shot->broken && away >= 0.0 ? away : HUGE_VAL,
                                                    shot->broken ? -shot->height : HUGE_VAL};
        for (int k = 0; k < SHV_SURVIVE_PICTURES; k++) {
            if (!(score[k] < best[k])) continue;
            best[k] = score[k];
            pictures->title[k] = titles[k];
            pictures->shot[k] = *shot;
        }
    }
    if (pictures->title[1] && pictures->title[2] && pictures->shot[1].height == pictures->shot[2].height)
        pictures->title[1] = NULL;
}

/* The element of a drawing's file, without what goes before it there. */
static ShvStatus read_drawing(ShvSurvive *survive, const char *path, char **drawing, ShvError *error)
{
    size_t size;
    SHV_TRY(shv_read_file(survive->options.memory, SHV_PART_GENERAL, path, LARGEST_DRAWING, drawing, &size, error));
    const char *element = strstr(*drawing, "<svg");
    if (element) memmove(*drawing, element, strlen(element) + 1);
    return SHV_OK;
}

/* First and last frame. */
static ShvStatus draw_run(ShvSurvive *survive, const char *run, const char *prefix, ShvError *error)
{
    ShvRunFile *file;
    ShvSvgOptions options = shv_svg_default();
    SHV_TRY(shv_run_file_open(&file, run, survive->options.memory, error));
    const int64_t frames[] = {0, shv_run_file_info(file)->frame_count - 1};
    options.force = true;
    options.frames = frames;
    options.frame_count = 2;
    options.size = PICTURE_WIDTH;
    options.memory = survive->options.memory;
    const ShvStatus status = shv_export_svg(file, prefix, &options, error);
    shv_run_file_close(file);
    return status;
}

static ShvStatus draw(ShvSurvive *survive, int index, const ShvShot *shot, char **drawing, ShvError *error)
{
    static const char *const endings[] = {"", ".h5", ".svg"};
    char name[64], *paths[3] = {NULL, NULL, NULL};
    ShvStatus status = SHV_OK;
    for (int i = 0; i < 3 && status == SHV_OK; i++) {
        shv_format(name, sizeof name, "picture-%d%s", index + 1, endings[i]);
        status =
            shv_path_join(survive->options.memory, SHV_PART_GENERAL, survive->options.output, name, &paths[i], error);
    }
    if (status == SHV_OK) status = shv_drop_record(&survive->drop, shot, paths[1], error);
    if (status == SHV_OK) status = draw_run(survive, paths[1], paths[0], error);
    if (status == SHV_OK) status = read_drawing(survive, paths[2], drawing, error);
    for (int i = 0; i < 3; i++) shv_release(paths[i]);
    return status;
}

ShvStatus shv_survive_draw(ShvSurvive *survive, ShvSurvivePictures *pictures, ShvError *error)
{
    *pictures = (ShvSurvivePictures){0};
    choose(&survive->view, pictures);
    for (int i = 0; i < SHV_SURVIVE_PICTURES; i++)
        if (pictures->title[i]) SHV_TRY(draw(survive, i, &pictures->shot[i], &pictures->drawing[i], error));
    return SHV_OK;
}
