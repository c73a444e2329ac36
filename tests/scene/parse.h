/* Short ways to a scene for the tests of this folder. */
#ifndef SHV_TESTS_SCENE_PARSE_H
#define SHV_TESTS_SCENE_PARSE_H

#include "base/memory.h"
#include "check.h"
#include "shiver/scene.h"

/* What one parsing gave; `memory` counts it. */
typedef struct Parsed {
    ShvMemory *memory;
    ShvScene *scene;
    ShvDiagnostics *diagnostics;
    ShvStatus status;
    ShvError error;
} Parsed;

static inline Parsed parse_bytes(const char *text, size_t length, const char *const *overrides, int32_t count)
{
    Parsed parsed = {.memory = shv_memory_create()};
    parsed.status = shv_scene_parse(&parsed.scene, text, length, "s.yaml", "scene", overrides, count, parsed.memory,
                                    &parsed.diagnostics, &parsed.error);
    return parsed;
}

static inline const char *message(const Parsed *parsed, int32_t index)
{
    const ShvDiagnostic *diagnostic = shv_diagnostics_get(parsed->diagnostics, index);
    return diagnostic ? diagnostic->message : "(no message)";
}

static inline Parsed parse_good(const char *text, const char *const *overrides, int32_t count)
{
    const Parsed parsed = parse_bytes(text, strlen(text), overrides, count);
    if (parsed.status != SHV_OK) fail_msg("%s", message(&parsed, 0));
    return parsed;
}

/* Releases everything and fails when a block is left. */
static inline void release(Parsed *parsed)
{
    shv_scene_destroy(parsed->scene);
    shv_diagnostics_destroy(parsed->diagnostics);
    assert_int_equal(shv_memory_bytes(parsed->memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(parsed->memory);
}

/* A small scene without faults. */
#define SMALL_SCENE                                                                                                    \
    "shiver: 1\n"                                                                                                      \
    "materials:\n"                                                                                                     \
    "  glass: {density: 2500, youngs_modulus: 70e9, poissons_ratio: 0.22, fracture_energy: 8, cohesive_strength: "     \
    "4e7}\n"                                                                                                           \
    "objects:\n"                                                                                                       \
    "  plate: {mesh: {ball: {radius: 1, edge: 0.1}}, material: glass}\n"                                               \
    "duration: 1\n"

#endif
