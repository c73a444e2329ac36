/* Scenes from text or file, with the tests' folder as the working directory. */
#ifndef SHV_TESTS_STABILITY_SCENE_H
#define SHV_TESTS_STABILITY_SCENE_H

#include "check.h"

#include "shiver/shiver.h"

static inline ShvScene *scene_parse(const char *text)
{
    ShvScene *scene = NULL;
    ShvError error = {.message = ""};
    check_ok(shv_scene_parse(&scene, text, strlen(text), "test", NULL, NULL, 0, NULL, NULL, &error), error);
    return scene;
}

static inline ShvScene *scene_load(const char *path, const char *const *overrides)
{
    ShvScene *scene = NULL;
    ShvError error = {.message = ""};
    int32_t count = 0;
    while (overrides[count]) count++;
    check_ok(shv_scene_load(&scene, path, overrides, count, NULL, NULL, &error), error);
    return scene;
}

#endif
