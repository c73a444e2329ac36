/* The cohesive traction of one step at one pair of node copies.

   Openings of the law are taken at half steps: `from` at n − 1/2, `to` at n + 1/2, the mean of the openings `now` at n and
   2 to − now at n + 1. On the envelope the traction T of the step is the mean that does exactly the law's work over the
   step, T·(to − from) = recoverable(to) − recoverable(from) + dissipated (a discrete gradient), while the opening itself
   follows from T and the pair's inertia, to = free − compliance × T. So the work of separation is the law's whatever the
   step, and as the step goes to zero this is the plain explicit law.

   Below the largest opening, where the law is a spring of stiffness k, T = k ((1 − η) (from + to)/2 + η × opening at n + 1),
   η = q²/(9 + q²), q = compliance × k: the trapezoidal rule where the step resolves the spring, the backward rule where it
   does not, as far as that takes energy out. It fades where the rule changes (a closing pair, the envelope), so that
   traction is continuous in `free`: with jumps, sweeps over neighbouring pairs would not settle. Either is stable for the step that is stable without cracks, however large k is: with M the mass, K the solid's and C the
   law's stiffness, step² K < 4 M. At zero history (k infinite) the pair is held by any traction up to the peak. The
   backward rule costs some of the recoverable energy of springs that the step cannot resolve; nothing is gained. */
#ifndef SHV_COHESIVE_PAIR_H
#define SHV_COHESIVE_PAIR_H

#include "base/vector.h"
#include "cohesive/law.h"

/* One component below its largest opening, and what follows from that for one step. */
typedef struct ShvPairSpring {
    ShvLawBranch branch;
    double stiffness;     /* Pa/m; infinite where nothing has opened yet */
    double share;         /* 1/(1 + compliance × stiffness / 2): of an opening without traction, what is left of it */
    double yield, excess; /* of the damping (pair.c) */
} ShvPairSpring;

/* All that a pair's traction depends on besides what its neighbours do, so that sweeps over neighbours do not find it again
   and again. */
typedef struct ShvPair {
    const ShvLaw *law;
    ShvHistory history;
    double compliance;  /* m/Pa, > 0 */
    double from, drift; /* normal opening at n − 1/2, and how much it has grown until n; may be negative */
    double slip;        /* |start| */
    double still;       /* as long as the normal opening stays below, the history does not move before shear does */
    ShvVec3 normal;     /* unit, from the first face to the second */
    ShvVec3 start, sideways; /* in the plane: opening at n − 1/2, and its change until n */
    ShvPairSpring spring[2];
} ShvPair;

/* Openings second copy against the first, at the last half step and now. */
ShvPair shv_pair_make(const ShvLaw *law, const ShvLawSprings *springs, ShvVec3 normal, ShvVec3 from, ShvVec3 now,
                      double compliance);
/* The traction, first its normal and then its shear component, the path of shv_law_advance; `free`: opening at the next
   half step without it. It acts on the first copy, and with the opposite sign on the second. */
ShvVec3 shv_pair_traction(const ShvPair *pair, ShvVec3 free);

#endif
