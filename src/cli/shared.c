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

int shv_cli_inspect(const ShvArguments *arguments, ShvInspection show)
{
    ShvScene *scene = shv_cli_load_scene(arguments);
    if (!scene) return SHV_EXIT_INPUT;
    ShvError error;
    ShvSimulation *simulation = NULL;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = shv_scene_folder(scene);
    ShvStatus status = shv_simulation_create(&simulation, shv_scene_definition(scene), &options, &error);
    if (status == SHV_OK) status = show(simulation, arguments, &error);
    shv_simulation_destroy(simulation);
    shv_scene_destroy(scene);
    return status == SHV_OK ? SHV_EXIT_DONE : shv_cli_failed(status, &error);
}
