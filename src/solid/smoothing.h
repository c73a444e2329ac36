/* Strain smoothed over edges: linear tets that bend.

   A linear tet has one strain. In a wall about as thin as its edges it shears where it should bend: shear of either sign in
   neighbours, which the wall itself does not have. Here the deformation gradient is averaged, by volume, over the tets round each
   edge (ES-FEM: Liu, Nguyen-Thoi and Lam, J. Sound Vib. 320 (2009) 1100; in tets Jiang and others, Eng. Anal. Bound. Elem. 59 (2015)
   62); of that the edge has its stress, and a tet the mean stress of its six edges. With W the elastic energy of a volume, the energy
   is Σ V W(F of the edge) over edges, of which a tet gives each of its own a sixth of its volume; nodal forces −V P ∇N with the
   mean stress P are its exact slope, so that momentum and energy are kept as they are without it. What is convex is never more than
   without it: steps that are stable for the tets stay so.

   A domain is the tets of one material that share both nodes of an edge. Where nodes are split, so is it, and a crack's faces know
   nothing of each other. That alone would make energy: shear of either sign, whose mean was nothing, would count from then on. So the
   parts of a domain go on from what the whole had, F of a part times (I + G), G, the offset, found at the split: stress and energy are
   continuous. */
#ifndef SHV_SOLID_SMOOTHING_H
#define SHV_SOLID_SMOOTHING_H

#include <stdbool.h>

#include "model/state.h"

enum { SHV_TET_EDGES = 6 };
/* Corners of edge k of a tet. */
static const int shv_tet_edges[SHV_TET_EDGES][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* A body that rests may have tets in batches beside others that do not: energies are found of all of a batch, forces of what is awake. */
enum { SHV_ACTIVE_NOT, SHV_ACTIVE_BATCH, SHV_ACTIVE_AWAKE };

/* Lanes are those of batches with smoothed elements, block after block; lane l of block b is numbered 8 b + l. Edge k of a lane is
   numbered 6 × lane + k. An element without smoothing beside others in a batch is a domain of its own.

   Domains are found eight together, in groups; lane l of group g is domain 8 g + l, and may be empty. One pass goes through windows of
   blocks: gradients of a window's lanes, then the groups that need no later ones, then the mean stress of blocks whose groups are
   all found, while the numbers still lie in a cache near to the processor. Regions of windows, as many as threads, do so side by side. What lies across
   regions, and what was split off since domains were laid out, is late: found after all windows. None of it changes a bit. */
typedef struct ShvSmoothedEdges {
    int32_t block_count;
    int32_t *blocks;       /* block_count: their batches */
    int32_t *batch_block;  /* of each batch of the solid; −1: none of its elements is smoothed. NULL: nowhere */
    int32_t *edge_domain;  /* of each edge */
    uint8_t *lane_active;  /* SHV_ACTIVE_…, of each */
    uint8_t *block_active; /* of the domains of its lanes the highest */
    /* matrices in rows: eight numbers that fill a register, and the ninth apart */
    double *gradient, *gradient_zz; /* of a lane, volume × displacement gradient, m³; one block more, of zeros */
    double *mean;                   /* of a block, the mean stress of its lanes' edges, Pa: 9 × SHV_LANES */
    int32_t domain_count;
    int32_t group_count, group_capacity;
    int32_t last_lanes;                   /* lanes of the last group that have a domain */
    int32_t settled_groups;               /* those that domains were laid out in */
    int32_t *group_member, *group_width;  /* lanes of domain l: members[group_member + 8 i + l], i < group_width */
    uint8_t *group_active, *group_offset; /* of its domains' lanes the highest; whether some G is not zero */
    int16_t *group_material;              /* −1: of its domains */
    int32_t *members;                     /* lanes; behind the last of a domain the one of zeros */
    int32_t member_count, member_capacity;
    double *inverse_volume;                            /* of the tets of a domain, 1/m³ */
    double *stress, *stress_zz;                        /* of a domain, first Piola-Kirchhoff, Pa */
    double *energy;                                    /* of a volume, J/m³, where it was asked for */
    double *offset;                                    /* of a group, 9 × SHV_LANES: G */
    int16_t *material;                                 /* of a domain */
    int32_t region_count, window_count, window_blocks; /* blocks a window */
    int32_t *window_group; /* window_count + 1: first group of each window; the last: the first late one */
    int32_t *window_ready; /* window_count + 1, into ready_blocks: those that are complete with the window */
    int32_t *ready_blocks, *late_blocks, late_count;
    uint8_t *block_late;
    int32_t *split, split_count; /* domains that the last shv_solid_split has parted; room for all */
} ShvSmoothedEdges;

#endif
