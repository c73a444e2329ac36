/* Lines are overrides of a scene, as --set gives them. */
#include "fuzz.h"

#include "shiver/scene.h"

enum { MOST = 8 };

static const char scene_text[] =
    "shiver: 1\n"
    "materials: {stone: {library: plaster}}\n"
    "objects: {block: {mesh: {box: {size: [1, 1, 1], edge: 0.5}}, material: stone, position: [0, 0, 1]}}\n"
    "obstacles: {floor: {plane: {normal: [0, 0, 1]}}}\n"
    "duration: 1\n";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *overrides[MOST];
    int32_t count = 0;
    char *text = malloc(size + 1);
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    char *rest = text;
    while (count < MOST && rest && *rest) {
        overrides[count++] = rest;
        rest = strchr(rest, '\n');
        if (rest) *rest++ = '\0';
    }
    ShvScene *scene = NULL;
    ShvError error = {SHV_OK, ""};
    const ShvStatus status = shv_scene_parse(&scene, scene_text, sizeof scene_text - 1, "scene.yaml", NULL, overrides,
                                             count, NULL, NULL, &error);
    fuzz_judge(status, &error);
    shv_scene_destroy(scene);
    free(text);
    return 0;
}
