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

/* Openings of one step, second copy against the first: at the last half step, now, and at the next half step without
   traction; compliance: m/Pa, > 0. */
typedef struct ShvPairStep {
    ShvVec3 from, now, free;
    double compliance;
} ShvPairStep;

/* Normal traction, the slip held at that of `from`. The opening may be negative. */
double shv_pair_normal(const ShvLaw *law, ShvHistory history, double shear, double from, double now, double free,
                       double compliance);
/* Shear traction, the normal opening held; vectors in the plane. */
ShvVec3 shv_pair_shear(const ShvLaw *law, ShvHistory history, double normal, const ShvPairStep *step);
/* Both, first the normal and then the shear component, the path of shv_law_advance. `normal`: unit vector from the
   first face to the second. The traction acts on the first copy, and with the opposite sign on the second. */
ShvVec3 shv_pair_traction(const ShvLaw *law, ShvHistory history, ShvVec3 normal, const ShvPairStep *step);

#endif
