/* What a page holds of one run, for the files of this folder. */
#ifndef SHV_VIEW_DATA_H
#define SHV_VIEW_DATA_H

#include "export/obstacle_mesh.h"
#include "shiver/view.h"
#include "view/hulls.h"
#include "view/pack.h"

/* Quantities of a line that are quantised over their own range: position and velocity. */
enum { SHV_VIEW_RANGES = 6 };

typedef struct ShvViewRange {
    float low, step; /* value = low + step × (0…65535) */
} ShvViewRange;

typedef struct ShvViewData {
    const ShvViewRun *run;
    ShvRunFile *file;
    const ShvRunFileInfo *info;
    struct ShvMemory *memory;
    ShvPack *pack;
    int64_t *frames; /* those shown */
    int64_t frame_count;
    ShvLines lines;
    ShvObstacleMesh *obstacles;
    ShvHulls hulls; /* none where the run made no convex pieces */
    int64_t face_count;
    double *velocity;     /* 3 × fragments, at the present frame */
    int32_t mode;         /* 1: some fragment is in fracture mode at the present frame */
    ShvViewRange *ranges; /* SHV_VIEW_RANGES × lines */
    double *corners;      /* 12 × tets; NULL: the run has no nodes; also the next */
    double *damage;       /* 4 × tets */
    double reach, stress; /* largest displacement of a corner from its line, m; largest tension, Pa: of all frames */
} ShvViewData;

/* Reads mesh and genealogy, and looks at all frames once for ranges. On failure everything is released. */
ShvStatus shv_view_data_create(ShvViewData *data, const ShvViewRun *run, const ShvViewOptions *options,
                               ShvError *error);
void shv_view_data_release(ShvViewData *data);
/* Goes to a frame: poses, velocities, corners. */
ShvStatus shv_view_data_move(ShvViewData *data, int64_t frame, ShvError *error);
/* Position and velocity of a line (6); false where it is not there. */
bool shv_view_data_motion(const ShvViewData *data, int32_t line, double values[SHV_VIEW_RANGES]);
/* How far corner k of a face is from where its line alone would have it, in the line's own axes, m. */
ShvVec3 shv_view_data_displacement(const ShvViewData *data, int64_t face, int k, const ShvPose *pose);
/* Largest principal stress of a tet, Pa; NaN where it is not known. */
double shv_view_data_stress(const ShvViewData *data, int64_t tet);

/* What does not change: names, mesh, genealogy, obstacles, events, curves (head.c). */
ShvStatus shv_view_put_head(ShvViewData *data, ShvError *error);
/* The frames (frames.c). */
ShvStatus shv_view_put_frames(ShvViewData *data, ShvError *error);

#endif
