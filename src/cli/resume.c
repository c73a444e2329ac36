#include "cli/resume.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"

bool shv_resume_is_run_file(const char *path)
{
    static const unsigned char signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
    unsigned char begin[sizeof signature];
    if (shv_cli_is_stream(path)) return false;
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    const bool same =
        fread(begin, 1, sizeof begin, file) == sizeof begin && memcmp(begin, signature, sizeof begin) == 0;
    fclose(file);
    return same;
}

/* ---- what runs have in common ---- */

static bool is_free(const char *override)
{
    return strncmp(override, "duration=", 9) == 0 || strncmp(override, "threads=", 8) == 0;
}

uint64_t shv_resume_hash(const ShvScene *scene)
{
    uint64_t hash = shv_hash_text(SHV_HASH_START, shv_scene_text(scene));
    for (int32_t i = 0; i < shv_scene_override_count(scene); i++)
        if (!is_free(shv_scene_override(scene, i))) hash = shv_hash_text(hash, shv_scene_override(scene, i));
    return hash;
}

/* Lines of the overrides of a run file, each made a text of its own. */
static int split(char *text, const char *lines[SHV_MOST_OVERRIDES])
{
    int count = 0;
    for (char *at = text, *end; *at && count < SHV_MOST_OVERRIDES; at = end + 1) {
        end = at + strcspn(at, "\n");
        lines[count++] = at;
        if (*end == '\0') break;
        *end = '\0';
    }
    return count;
}

static uint64_t hash_of_file(const ShvRunFileInfo *info, char *overrides)
{
    const char *lines[SHV_MOST_OVERRIDES];
    const int count = split(overrides, lines);
    uint64_t hash = shv_hash_text(SHV_HASH_START, info->scene_text);
    for (int i = 0; i < count; i++)
        if (!is_free(lines[i])) hash = shv_hash_text(hash, lines[i]);
    return hash;
}

ShvLeftover shv_resume_inspect(const char *path, const ShvScene *scene, double *time)
{
    ShvRunFile *file;
    ShvError ignored;
    if (shv_run_file_open(&file, path, NULL, &ignored) != SHV_OK) return SHV_LEFTOVER_NONE;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    char *overrides = shv_copy_text(NULL, SHV_PART_SCENE, info->overrides);
    ShvLeftover leftover = SHV_LEFTOVER_OTHER;
    *time = info->last_time;
    if (overrides && hash_of_file(info, overrides) == shv_resume_hash(scene)) {
        const bool whole =
            strcmp(info->status, "finished") == 0 && info->last_time >= shv_scene_definition(scene)->duration;
        leftover = whole ? SHV_LEFTOVER_WHOLE : SHV_LEFTOVER_PARTIAL;
    }
    shv_release(overrides);
    shv_run_file_close(file);
    return leftover;
}

/* ---- the scene of a run file ---- */

static ShvStatus parse(ShvScene **scene, const ShvRunFileInfo *info, const ShvArguments *arguments, char *overrides,
                       const char *folder, ShvDiagnostics **diagnostics, ShvError *error)
{
    const char *all[2 * SHV_MOST_OVERRIDES];
    int count = split(overrides, all);
    for (int i = 0; i < arguments->override_count; i++) all[count++] = arguments->overrides[i];
    return shv_scene_parse(scene, info->scene_text, strlen(info->scene_text), arguments->positional[0], folder, all,
                           count, NULL, diagnostics, error);
}

static ShvStatus read_scene(ShvScene **scene, const ShvArguments *arguments, ShvDiagnostics **diagnostics,
                            ShvError *error)
{
    ShvRunFile *file;
    char *folder = NULL;
    *scene = NULL;
    const char *path = arguments->positional[0];
    ShvStatus status = shv_run_file_open(&file, path, NULL, error);
    if (status != SHV_OK) return status;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    char *overrides = shv_copy_text(NULL, SHV_PART_SCENE, info->overrides);
    if (!overrides) status = shv_fail_memory(error, "a scene", strlen(info->overrides));
    if (status == SHV_OK) status = shv_path_folder(NULL, SHV_PART_SCENE, path, &folder, error);
    if (status == SHV_OK) status = parse(scene, info, arguments, overrides, folder, diagnostics, error);
    shv_release(folder);
    shv_release(overrides);
    shv_run_file_close(file);
    return status;
}

int shv_resume_load_scene(ShvScene **scene, const ShvArguments *arguments)
{
    if (!shv_resume_is_run_file(arguments->positional[0])) return shv_cli_load_scene(scene, arguments);
    ShvDiagnostics *diagnostics = NULL;
    ShvError error;
    const ShvStatus status = read_scene(scene, arguments, &diagnostics, &error);
    return shv_cli_end_loading(status, diagnostics, &error);
}
