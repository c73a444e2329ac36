/* Motions along a line in closed form: lengths m, times s, and angles as arcs (m): radius × angle. */
#ifndef SHV_EVALUATE_LAWS_H
#define SHV_EVALUATE_LAWS_H

typedef struct ShvLineMotion {
    double position, velocity;
} ShvLineMotion;

/* Height above the ground (≥ 0 at the start) under gravity g > 0 towards it, at `time` after the start; an impact multiplies
   the velocity by −restitution. Impacts that accumulate (restitution < 1) end at rest on the ground. */
ShvLineMotion shv_law_bounce(double height, double velocity, double gravity, double restitution, double time);

/* Along a slope: `pull` is the part of gravity along it, `friction` ≥ 0 the largest deceleration by Coulomb friction, m/s².
   What has stopped stays while friction bears the pull. */
ShvLineMotion shv_law_slide(double velocity, double pull, double friction, double time);

typedef struct ShvRollMotion {
    ShvLineMotion centre, rim; /* rim: arc turned and its speed; forward rolling without slip has equal speeds */
} ShvRollMotion;
/* The same for a ball with moment of inertia `shape` × mass × radius² (solid: 2/5) that starts with these speeds of centre and
   rim. It slips until they agree, then rolls if friction bears it. */
ShvRollMotion shv_law_roll(double velocity, double rim_speed, double pull, double friction, double shape, double time);

#endif
