/* One body frame by frame, and what is read from such a track. */
#ifndef SHV_EVALUATE_TRACK_H
#define SHV_EVALUATE_TRACK_H

#include "evaluate/body.h"

typedef struct ShvTrackRow {
    double time;
    ShvBodyState state;
} ShvTrackRow;

typedef struct ShvTrack {
    ShvTrackRow *rows;
    int32_t count;
} ShvTrack;

/* Times of events that mark a motion (impacts, flips), at most `most`; returns their number. */
/* Impacts on a plane: where the parabolas through two frames meet, between which the velocity along `normal` turned from in
   to out by more than thrice what gravity does in between. */
int shv_track_impacts(const ShvTrack *track, ShvVec3 normal, ShvVec3 gravity, double *times, int most);
/* Height of the apex after each of the first impacts, above where the body is at the first: from speed and place half way to
   the next one. */
int shv_track_apices(const ShvTrack *track, ShvVec3 normal, ShvVec3 gravity, double *heights, int most);
/* Flips: spin about the middle principal axis (of `inertia`, body axes) passes through zero, by linear interpolation. */
int shv_track_flips(const ShvTrack *track, const ShvMat3 *inertia, double *times, int most);

#endif
