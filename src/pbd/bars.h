/* Position based bars (Müller et al. 2007, as the chapter's Table 6.2 uses them): every edge of every tet is a rigid bar,
   C = |p1 − p2| − d, relaxed by Gauss-Seidel sweeps that move each end by its inverse-mass share of k C.

   Two forms. SHV_BARS_EDGE visits each current edge once a sweep. SHV_BARS_ELEMENT is the chapter's loop over tets, which
   visits an edge once for every tet around it (4.3-5 times a sweep inside a mesh), and is stiffer for the same k.

   Colours: bars (or tets) of one colour share no node; colours run in order, a colour in parallel, so that the bits do not
   depend on the number of threads. */
#ifndef SHV_PBD_BARS_H
#define SHV_PBD_BARS_H

#include "model/ledger.h"
#include "model/state.h"

typedef struct ShvBars {
    ShvMemory *memory;
    const ShvModel *model;
    ShvBarForm form;
    /* edge form: bars sorted by colour */
    int32_t bar_count, bar_capacity;
    int32_t *ends;        /* 2 per bar: nodes */
    double *rest;         /* m */
    /* element form: tets sorted by colour */
    int32_t *tets;
    double *tet_rest;     /* 6 per tet */
    int32_t colour_count;
    int32_t *colour_start;
} ShvBars;

/* Bars of the elements with a non-zero flag (per fragment index; NULL: all). Call again (rebuild) when nodes were
   duplicated or the flags changed. */
ShvStatus shv_bars_create(ShvBars *bars, const ShvModel *model, const ShvState *state, ShvBarForm form, ShvError *error);
ShvStatus shv_bars_rebuild(ShvBars *bars, const ShvState *state, const uint8_t *awake, ShvError *error);
void shv_bars_release(ShvBars *bars);

/* One sweep over predicted positions (3 per node, world coordinates relative to nothing: reference + displacement).
   inverse_mass: 0 for pinned nodes. Bars between two pinned nodes, of zero current length, are skipped. */
void shv_bars_sweep(const ShvBars *bars, double stiffness, const double *inverse_mass, double *positions, int32_t threads);
/* Largest |length/rest − 1| over bars of the listed flags; 0 without bars. */
double shv_bars_largest_strain(const ShvBars *bars, const double *positions);

#endif
