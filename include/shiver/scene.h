/* Scene files: YAML text to the definitions of definition.h. Everything that is wrong with a scene is found and listed at
   once, each fault with file, line and column, what was expected, and the nearest key. docs/scene.md lists every key. */
#ifndef SHIVER_SCENE_H
#define SHIVER_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "shiver/definition.h"
#include "shiver/status.h"

#ifdef __cplusplus
extern "C" {
#endif

struct ShvMemory;

/* A scene that has been read and found without errors. It owns all texts and arrays of its definition. */
typedef struct ShvScene ShvScene;
/* The faults of one scene, ordered as they stand in the file; those of overrides come last. */
typedef struct ShvDiagnostics ShvDiagnostics;

typedef enum ShvSeverity { SHV_SEVERITY_WARNING, SHV_SEVERITY_ERROR } ShvSeverity;

typedef struct ShvDiagnostic {
    ShvSeverity severity;
    int32_t line, column; /* from 1, columns in characters; 0 where the fault is in an override */
    const char *message;  /* "file:line:column: error: …" or "--set a.b.c: error: …" */
} ShvDiagnostic;

/* Of a scene's text. */
enum { SHV_SCENE_LARGEST_BYTES = 16 << 20 };

/* Reads a scene file of at most SHV_SCENE_LARGEST_BYTES. Each of `overrides` is "a.b.c=value": the value, YAML text, takes the place of that
   key; list elements are named by their index from 0. Overrides are applied in order.
   SHV_BAD_INPUT when the scene has errors (`error` tells their number and the first), SHV_FILE_ERROR when the file cannot
   be read; *scene is then NULL. *diagnostics (`diagnostics` may be NULL) lists the faults, also the warnings of a good
   scene; it is NULL, which counts as an empty list, when no text could be looked at or memory is out; the caller destroys
   it. `memory` (may be NULL) counts the allocations and must outlive scene and diagnostics. */
ShvStatus shv_scene_load(ShvScene **scene, const char *path, const char *const *overrides, int32_t override_count,
                         struct ShvMemory *memory, ShvDiagnostics **diagnostics, ShvError *error);
/* The same for a text of `length` bytes. `name` stands for the file in messages; `folder` (NULL: the working directory) is
   what relative file names of the scene start from. */
ShvStatus shv_scene_parse(ShvScene **scene, const char *text, size_t length, const char *name, const char *folder,
                          const char *const *overrides, int32_t override_count, struct ShvMemory *memory,
                          ShvDiagnostics **diagnostics, ShvError *error);
void shv_scene_destroy(ShvScene *scene);

/* Valid as long as the scene. File names in it are as written: relative ones start from shv_scene_folder. */
const ShvSceneDefinition *shv_scene_definition(const ShvScene *scene);
/* Gives an object whose mesh is `memory: {…}` its tets, which are copied: 3 × node_count positions, m, and 4 × tet_count nodes from
   0 (ShvMeshDefinition). All objects of a `repeat` get them by the name of their first, without its number. */
ShvStatus shv_scene_give_mesh(ShvScene *scene, const char *object, const double *positions, int32_t node_count,
                              const int32_t *tets, int32_t tet_count, ShvError *error);
/* The text as it was read, without the overrides, terminated. */
const char *shv_scene_text(const ShvScene *scene);
size_t shv_scene_text_length(const ShvScene *scene);
/* The overrides as they were given. */
int32_t shv_scene_override_count(const ShvScene *scene);
const char *shv_scene_override(const ShvScene *scene, int32_t index);
/* 64-bit hash of text and overrides. */
uint64_t shv_scene_hash(const ShvScene *scene);
/* The folder of the scene file, "" for the working directory. */
const char *shv_scene_folder(const ShvScene *scene);

int32_t shv_diagnostics_count(const ShvDiagnostics *diagnostics);
const ShvDiagnostic *shv_diagnostics_get(const ShvDiagnostics *diagnostics, int32_t index);
/* All errors and all warnings; of more than 200 faults only the first 200 are kept as messages. */
int32_t shv_diagnostics_errors(const ShvDiagnostics *diagnostics);
int32_t shv_diagnostics_warnings(const ShvDiagnostics *diagnostics);
void shv_diagnostics_destroy(ShvDiagnostics *diagnostics);

#ifdef __cplusplus
}
#endif
#endif
