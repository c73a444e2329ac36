/* How the bodies of a run move, by body: its lines of descent, then its obstacles. */
#ifndef SHV_EXPORT_TRACKS_H
#define SHV_EXPORT_TRACKS_H

#include <stdio.h>

#include "export/obstacle_mesh.h"
#include "export/vertices.h"
#include "shiver/export.h"

/* Numbers of a pose: position, orientation (x, y, z, w; its sign follows the one before), 1 where the body is there. */
enum { SHV_TRACK_NUMBERS = 8 };

typedef struct ShvTracks {
    ShvLines lines;
    ShvVertices vertices;
    ShvObstacleMesh *obstacles;
    int32_t body_count; /* lines and obstacles */
    int64_t frame_count;
    double *times; /* s */
    float *poses;  /* SHV_TRACK_NUMBERS × frames × bodies, the frames of a body together */
} ShvTracks;

/* All frames, or those on the animation grid. On failure everything is released. */
ShvStatus shv_tracks_create(ShvTracks *tracks, ShvRunFile *file, const ShvExportOptions *options, ShvError *error);
void shv_tracks_release(ShvTracks *tracks);
/* One file, PREFIX and `suffix`, of all tracks of a run, which takes its name when `write` has made it whole. */
typedef ShvStatus (*ShvTracksWriter)(const ShvTracks *tracks, const ShvExportOptions *options, FILE *stream,
                                     ShvError *error);
ShvStatus shv_tracks_export(ShvRunFile *file, const char *prefix, const char *suffix, const ShvExportOptions *given,
                            ShvTracksWriter write, ShvError *error);
const float *shv_tracks_pose(const ShvTracks *tracks, int32_t body, int64_t frame);
/* False for a body that is there at all frames (`moves`: that stands still). */
bool shv_tracks_vanishes(const ShvTracks *tracks, int32_t body);
bool shv_tracks_moves(const ShvTracks *tracks, int32_t body);
/* A body's surface: vertices about its position, and the triangles that share them, each by the numbers of its three corners. */
int64_t shv_tracks_vertex_count(const ShvTracks *tracks, int32_t body);
ShvVec3 shv_tracks_vertex(const ShvTracks *tracks, int32_t body, int64_t vertex);
int64_t shv_tracks_triangle_count(const ShvTracks *tracks, int32_t body);
const int32_t *shv_tracks_triangles(const ShvTracks *tracks, int32_t body);
ShvVec3 shv_tracks_normal(const ShvTracks *tracks, int32_t body, int64_t triangle);
/* 0…1 each; obstacles are grey. */
void shv_tracks_colour(const ShvTracks *tracks, int32_t body, double colour[3]);
/* "line_12" or "obstacle_3". */
void shv_tracks_name(const ShvTracks *tracks, int32_t body, char name[32]);

#endif
