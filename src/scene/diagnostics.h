/* Collects the faults of a scene. */
#ifndef SHV_SCENE_DIAGNOSTICS_H
#define SHV_SCENE_DIAGNOSTICS_H

#include "scene/pool.h"
#include "shiver/scene.h"

/* Where something stands: line and column from 1 in the scene file (origin 0), or in override `origin` − 1. */
typedef struct ShvPlace {
    int32_t line, column, origin;
} ShvPlace;

/* A new, empty list; `name` stands for the file in messages. NULL when memory is out. */
ShvDiagnostics *shv_diagnostics_create(ShvMemory *memory, const char *name, const char *const *overrides,
                                       int32_t override_count);
void shv_diagnose(ShvDiagnostics *diagnostics, ShvSeverity severity, ShvPlace place, const char *format, ...);
#define shv_error(diagnostics, place, ...)   shv_diagnose(diagnostics, SHV_SEVERITY_ERROR, place, __VA_ARGS__)
#define shv_warning(diagnostics, place, ...) shv_diagnose(diagnostics, SHV_SEVERITY_WARNING, place, __VA_ARGS__)
/* Puts the list in the order of the file. */
void shv_diagnostics_sort(ShvDiagnostics *diagnostics);
/* What reading `what`, of `bytes` bytes, ends with: sorts the list; memory is out where the reader has `failed` or a message was
   lost, and of errors the message has their number and the first. */
ShvStatus shv_diagnostics_end(ShvDiagnostics *diagnostics, bool failed, const char *what, size_t bytes,
                              ShvError *error);

typedef struct ShvQuoted {
    char text[72];
} ShvQuoted;
/* 'text' in quotes for a message: long texts are cut between characters, control characters become '?'. */
ShvQuoted shv_quoted(const char *text);

#endif
