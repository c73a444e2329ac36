/* Position based bars (Müller et al. 2007, as the chapter's Table 6.2 uses them): every edge of every tet is a rigid bar,
   C = |p1 − p2| − d, relaxed by Gauss-Seidel sweeps that move each end by its inverse-mass share of k C.

   Two forms. SHV_BARS_EDGE visits each current edge once a sweep. SHV_BARS_ELEMENT is the chapter's loop over tets, which
   visits an edge once for every tet around it (4.3-5 times a sweep inside a mesh), and is stiffer for the same k.

   The unknowns are displacements. With D the edge in the reference and δ the difference of its ends' displacements, the
   length is |D + δ| and C (|D + δ| + d) = δ·(2 D + δ), so that a strain keeps all its digits and a mesh that moves without
   turning is left alone to the last bit.

   Order and layout. An edge belongs to its end with the lower number in the reference mesh, a tet to its lowest corner.
   Runs of consecutive reference nodes make chunks: copies of a node stay where their origin is, so that a chunk is compact
   in memory and in space however much has broken. Within a chunk, items without a common node form colours, and the
   colours are cut into batches of eight which are relaxed at once. Chunks themselves are coloured so that two of a colour
   share no node: colours run in order, the chunks of a colour in parallel, and the bits do not depend on the number of
   threads. Node duplication only ever removes sharing, so the colours of chunks stay valid; only chunks around a
   duplicated node, or around elements that fall asleep or wake, are made anew. */
#ifndef SHV_PBD_BARS_H
#define SHV_PBD_BARS_H

#include "model/state.h"

/* Batches of one chunk, in the arrays of ShvBars. */
typedef struct ShvBarChunk {
    int32_t first, count, room; /* in batches */
    int32_t items;              /* edges or tets */
} ShvBarChunk;

typedef struct ShvBars {
    ShvMemory *memory;
    const ShvModel *model;
    ShvBarForm form;
    int32_t corners, edges; /* of an item: 2 and 1 (edge), 4 and 6 (tet) */
    int32_t chunk_count;
    ShvBarChunk *chunks;
    int32_t colour_count;
    int32_t *colour_start; /* colour_count + 1, into chunk_order */
    int32_t *chunk_order;  /* chunks sorted by colour */
    int32_t batch_end, batch_capacity;
    int32_t batch_held; /* batches that belong to a chunk; the others are gaps */
    int32_t *ends;      /* corners × 8 per batch: nodes, corner-major; free lanes repeat the batch's first item */
    double *rest;       /* edges × 8 per batch: rest lengths, m, edge-major */
    int64_t bar_count;  /* edges relaxed by one sweep */
    /* what the bars were made from */
    int32_t known_nodes;
    uint8_t *awake; /* per element: its edges are bars */
    uint8_t *dirty; /* per chunk: to be made anew */
    /* corners (element × 4 + corner) around each reference node; the model's adjacency, or own where it has none */
    const int32_t *corner_start, *corner_list;
    int32_t *own_start, *own_list;
    /* work space */
    uint64_t *met; /* per node: colours in use; zero between calls */
    int32_t *seen; /* per node: the owner of the last edge that ended here; −1 between calls */
    int32_t node_room;
    int32_t *items; /* corners per item of one chunk */
    uint8_t *item_colour;
    int32_t item_room;
} ShvBars;

/* No bars yet: the first update makes them. On failure `bars` is zeroed and owns nothing. */
ShvStatus shv_bars_create(ShvBars *bars, const ShvModel *model, ShvBarForm form, ShvError *error);
void shv_bars_release(ShvBars *bars);
/* Brings the bars up to date with duplicated nodes and with the elements that take part: those whose fragment has a
   non-zero flag (flags per fragment index, as in state->element_fragment; NULL: all). Work in proportion to what changed.
   On failure the bars must not be swept before another call has succeeded. */
ShvStatus shv_bars_update(ShvBars *bars, const ShvState *state, const uint8_t *flags, ShvError *error);

/* One sweep. anchors: 4 doubles a node, reference position and inverse mass (0: pinned); shifts: 4 doubles a node,
   displacement and a number that is lost; both aligned to 32 bytes. Bars between two pinned nodes, of zero current length
   or of zero rest length are skipped. */
void shv_bars_sweep(const ShvBars *bars, double stiffness, const double *anchors, double *shifts);
/* The same bits; besides, what holds pinned nodes against their bars is added to their `reactions`, 3 a node, as impulse × step,
   kg m. */
void shv_bars_sweep_held(const ShvBars *bars, double stiffness, const double *anchors, double *shifts,
                         double *reactions);
/* Largest |length/rest − 1| over all bars; 0 without bars. */
double shv_bars_largest_strain(const ShvBars *bars, const double *anchors, const double *shifts);

#endif
