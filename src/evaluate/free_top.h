/* Torque-free rotation of a rigid body by Jacobi's elliptic functions; the turn about the angular momentum by one quadrature. */
#ifndef SHV_EVALUATE_FREE_TOP_H
#define SHV_EVALUATE_FREE_TOP_H

#include <stdbool.h>

#include "base/vector.h"

typedef struct ShvElliptic {
    double sn, cn, dn;
} ShvElliptic;
/* Jacobi's functions of the argument u for the parameter 1 − complement (0 < complement ≤ 1), by the arithmetic-geometric
   mean (Abramowitz and Stegun 16.4). The parameter is given by its complement, which loses no digits near 1. */
ShvElliptic shv_elliptic(double u, double complement);
/* Complete integral of the first kind K, quarter of the period; and the incomplete one F(angle), whose sn is sin(angle). */
double shv_elliptic_quarter(double complement);
double shv_elliptic_integral(double angle, double complement);

typedef struct ShvFreeTop {
    ShvMat3 axes;        /* columns: principal axes in body axes, of increasing moments; right-handed */
    double moment[3];    /* kg m² */
    ShvVec3 start_spin;  /* rad/s, principal axes */
    ShvQuat start;       /* orientation at time 0 */
    bool steady;         /* the spin does not change in the body */
    int first, last;     /* principal axes whose spins go with cn and dn; sn belongs to axis 1 */
    double amplitude[3]; /* rad/s, signed for `last` */
    double rate, phase;  /* of the elliptic argument: 1/s, – */
    double complement;   /* 1 − parameter */
    double momentum, twice_energy;
    double time, turned; /* how far the quadrature has come: s, rad */
} ShvFreeTop;

/* `inertia` in body axes, about the centre of mass; `spin` in world axes. */
ShvFreeTop shv_free_top(const ShvMat3 *inertia, ShvQuat orientation, ShvVec3 spin);
/* Orientation and spin (world) at `time`, not before that of the last call. */
void shv_free_top_at(ShvFreeTop *top, double time, ShvQuat *orientation, ShvVec3 *spin);
/* Spin in principal axes at any time. */
ShvVec3 shv_free_top_spin(const ShvFreeTop *top, double time);

#endif
