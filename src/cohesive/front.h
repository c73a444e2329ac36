/* Fronts of cracks on meshes that do not resolve the cohesive zone (SHV_UNRESOLVED_TIP_STRENGTH).

   Away from cracks a facet opens at the strength. At the front of one a mesh of edge h shows of K no more stress than about
   K/√(2πh): there the strength that makes growth cost G on this mesh is σ_tip = c √(E G/h), if that is less.

   A facet has opened once one of its points has lost a tenth of its normal strength, and a crack at half the speed of shear
   waves could have crossed it: stress of several σ_tip would else drive a front faster than sound, and nothing could unload in
   time. A node that such a facet reaches but does not split is of a front, and so is one of which it has split off no more than a
   quarter of the solid angle: at an island between two sheets of a crack, which would be lost there. A slit of the mesh is a crack that
   has opened from the start. Where tension exceeds compression there, and pulls across the crack, the star of the node (star.h) may part as
   well along a disk that goes on from an opened facet, in which facets ahead hold σ_tip in any direction, over what they cover
   of the plane across the pull: that a mesh makes them lean is nothing that the material resists. Their law starts with it, and
   their energy is G times what they cover. Ahead is a facet that leads away from where the crack comes from, or that
   continues an opened one over an edge. */
#ifndef SHV_COHESIVE_FRONT_H
#define SHV_COHESIVE_FRONT_H

#include "model/state.h"

struct ShvCohesive;

/* Where a slit of the mesh ends: its normal, and the way into it, not of unit length; zero elsewhere. */
typedef struct ShvSlit {
    ShvVec3 normal, flank;
} ShvSlit;

enum { SHV_FRONT_LOWERED = 8 };

typedef struct ShvFront {
    bool any;             /* some material asks for it; without one the rest is not there */
    double crossing_time; /* s in which a front crosses a facet, their mean */
    uint8_t *ahead; /* per interior facet, intact: bit k where it is ahead of a front at corner k of its first element's
                       face; inserted: SHV_FRONT_LOWERED where its law started so */
    ShvSlit *slit;  /* per node of the mesh */
} ShvFront;

/* A facet at a node, as a part of a crack that goes on there. */
typedef struct ShvTip {
    double strength; /* Pa, in any direction where `lowered` */
    bool lowered;
    bool behind; /* it has opened */
} ShvTip;

ShvStatus shv_front_create(struct ShvCohesive *cohesive, ShvError *error);
void shv_front_release(ShvFront *front);
/* σ_tip of a facet, Pa; infinite where its material does not ask for it. */
double shv_front_tip_strength(const ShvModel *model, int32_t facet);
/* Looks at the ends of slits. */
void shv_front_start(struct ShvCohesive *cohesive, const ShvState *state);
/* Looks whether a facet has opened by now; then at its nodes that are not split. */
void shv_front_open(struct ShvCohesive *cohesive, const ShvState *state, int32_t cohesive_facet);
/* Which facets at a node are ahead of a front, after a change there. */
void shv_front_update(struct ShvCohesive *cohesive, const ShvState *state, int32_t node);
/* Steps between checks, once something may part, that no front outruns: 1 without any. */
int32_t shv_front_steps(const struct ShvCohesive *cohesive, double step);
/* Of an intact facet, at whichever corner it is weakest, Pa. */
double shv_front_strength(const struct ShvCohesive *cohesive, int32_t facet);
ShvTip shv_front_tip(const struct ShvCohesive *cohesive, const ShvState *state, int32_t facet, int32_t node);
/* Whether a pull is across a crack whose normal is along `normal`, of any length. */
bool shv_front_is_across(ShvVec3 normal, ShvVec3 direction);
/* Normal, of any length, of a crack that ends at a node which it does not part: of a slit, until the node is split, or of an opened
   crack that has cut only an island out there; zero without one. */
ShvVec3 shv_front_normal(const struct ShvCohesive *cohesive, const ShvState *state, int32_t node);

#endif
