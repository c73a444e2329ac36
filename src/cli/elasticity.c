#include "cli/elasticity.h"

#include <string.h>

#include "cli/command.h"

static ShvScene *parse_scene(const ShvRunFileInfo *info)
{
    const char *overrides[SHV_MOST_OVERRIDES];
    int32_t count = 0;
    ShvError ignored;
    ShvScene *scene = NULL;
    char *lines = shv_copy_text(NULL, SHV_PART_GENERAL, info->overrides), *rest = lines;
    for (char *line = lines ? strtok_r(lines, "\n", &rest) : NULL; line && count < SHV_MOST_OVERRIDES;
         line = strtok_r(NULL, "\n", &rest))
        overrides[count++] = line;
    if (lines && shv_scene_parse(&scene, info->scene_text, strlen(info->scene_text), info->scene_name, NULL, overrides,
                                 count, NULL, NULL, &ignored) != SHV_OK)
        scene = NULL;
    shv_release(lines);
    return scene;
}

static bool find_moduli(const ShvSceneDefinition *scene, const char *material, ShvElasticity *elasticity)
{
    for (int32_t i = 0; i < scene->material_count; i++) {
        if (!scene->materials[i].name || strcmp(scene->materials[i].name, material) != 0) continue;
        *elasticity = (ShvElasticity){scene->materials[i].youngs_modulus, scene->materials[i].poissons_ratio};
        return true;
    }
    return false;
}

ShvStatus shv_cli_elasticity(const ShvRunFile *file, ShvElasticity **elasticity, ShvError *error)
{
    const int32_t count = shv_run_file_info(file)->object_count;
    ShvScene *scene = parse_scene(shv_run_file_info(file));
    *elasticity = NULL;
    if (!scene) return SHV_OK;
    *elasticity = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)count, sizeof **elasticity);
    bool known = *elasticity != NULL;
    for (int32_t i = 0; i < count && known; i++)
        known = find_moduli(shv_scene_definition(scene), shv_run_file_object(file, i).material, &(*elasticity)[i]);
    shv_scene_destroy(scene);
    const bool room = *elasticity != NULL;
    if (!known) {
        shv_release(*elasticity);
        *elasticity = NULL;
    }
    return room ? SHV_OK : shv_fail_memory(error, "materials", (size_t)count * sizeof **elasticity);
}

bool shv_cli_made_convex_pieces(const ShvRunFile *file)
{
    ShvScene *scene = parse_scene(shv_run_file_info(file));
    if (!scene) return false;
    const ShvRigidEngine engine = shv_scene_definition(scene)->rigid.engine;
    shv_scene_destroy(scene);
    return engine == SHV_RIGID_BULLET || engine == SHV_RIGID_BULLET_PLAIN;
}
