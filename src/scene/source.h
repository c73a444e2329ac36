/* What is looked at before YAML is: bytes that no scene text has, and what the YAML library does not survive. */
#ifndef SHV_SCENE_SOURCE_H
#define SHV_SCENE_SOURCE_H

#include "scene/diagnostics.h"

enum { SHV_SCENE_LARGEST_DEPTH = 32 };

/* Reports the first byte that is not text (UTF-8 without control characters other than tab, line feed and carriage
   return), a run of more opening brackets than any nesting may have (the YAML scanner would look ahead through all of
   them), and tabs before a block where there are complex keys. False when there is such a fault. */
bool shv_source_check(ShvDiagnostics *diagnostics, const char *text, size_t length, int32_t origin);

#endif
