#include "fuzz.h"

#include "shiver/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvScene *scene = NULL;
    ShvDiagnostics *diagnostics = NULL;
    ShvError error = {SHV_OK, ""};
    const ShvStatus status =
        shv_scene_parse(&scene, (const char *)data, size, "scene.yaml", NULL, NULL, 0, NULL, &diagnostics, &error);
    fuzz_judge(status, &error);
    shv_diagnostics_destroy(diagnostics);
    shv_scene_destroy(scene);
    return 0;
}
