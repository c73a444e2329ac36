#include "cli/command.h"

#include <stdio.h>

ShvScene *shv_cli_load_scene(const ShvArguments *arguments)
{
    ShvScene *scene = NULL;
    ShvDiagnostics *diagnostics = NULL;
    ShvError error;
    const ShvStatus status = shv_scene_load(&scene, arguments->positional[0], arguments->overrides,
                                            (int32_t)arguments->override_count, NULL, &diagnostics, &error);
    const int32_t count = diagnostics ? shv_diagnostics_count(diagnostics) : 0;
    for (int32_t i = 0; i < count; i++) fprintf(stderr, "%s\n", shv_diagnostics_get(diagnostics, i)->message);
    if (status != SHV_OK) fprintf(stderr, "shiver: %s\n", error.message);
    shv_diagnostics_destroy(diagnostics);
    return scene;
}
