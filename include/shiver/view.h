/* Run files as a page to look at in a browser. */
#ifndef SHIVER_VIEW_H
#define SHIVER_VIEW_H

#include "shiver/export.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ShvViewRun {
    ShvRunFile *file;
    const ShvElasticity *elasticity; /* one an object, to colour by stress; NULL: no stress */
    bool convex; /* bodies moved as convex pieces (rigid engines bullet and bullet_plain): show them, too */
} ShvViewRun;

typedef struct ShvViewOptions {
    uint32_t cookie;
    bool force;    /* replace an existing file */
    int32_t every; /* every so many frames, from the first on, and the last one; 1: all */
    const char
        *page; /* what the data go into, with SHIVER_TITLE and SHIVER_DATA in it once each; NULL: the built-in page */
    struct ShvMemory *memory; /* may be NULL */
} ShvViewOptions;
ShvViewOptions shv_view_default(void);

/* Whether this library was built with the page: that takes node and npm. */
bool shv_view_is_built(void);
/* Writes one HTML file that shows one run, or two on one clock, without any other file and without a network. Memory does not
   grow with the number of frames. SHV_UNSUPPORTED without a page; SHV_BAD_INPUT for a run without frames, one so large that a
   browser would not take it (the message says which `every` helps), and as shv_export_csv. */
ShvStatus shv_view_write(const ShvViewRun *runs, int32_t run_count, const char *path, const ShvViewOptions *options,
                         ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
