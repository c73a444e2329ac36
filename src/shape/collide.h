/* Contacts of free obstacles with the others at one time, and the impulses that answer them. */
#ifndef SHV_SHAPE_COLLIDE_H
#define SHV_SHAPE_COLLIDE_H

#include <stdbool.h>

#include "shape/obstacle.h"

/* `gap` between a sample (corner, vertex, or a sphere's surface) of one obstacle and the surface of the other. */
typedef struct ShvBodyContact {
    int32_t first, second; /* the normal points from the second to the first */
    ShvVec3 point, normal;
    double gap;
    double friction, restitution;
    /* of one solution */
    double target; /* normal relative velocity that must be reached, m/s */
    bool active;
    double normal_impulse; /* N·s on the first */
    ShvVec3 tangential;    /* N·s on the first */
    ShvVec3 velocity[2];   /* of the first and second there, before */
} ShvBodyContact;

/* Most contacts that are looked at at once: what lies deepest is kept. */
int32_t shv_collide_capacity(const ShvObstacles *obstacles);
/* Lists contacts with gap ≤ margin in obstacles->contacts, in increasing order of pairs and samples. */
int32_t shv_collide_detect(ShvObstacles *obstacles, double margin);
/* Whether two obstacles, one of them free, overlap by more than `least`, m, by corners, vertices and spheres; where they do so most, the first
   and second of `deepest` being 0 and 1. `all`: whose room for contacts is used. */
bool shv_collide_overlap(const ShvObstacles *all, const ShvObstacle *first, const ShvObstacle *second, double least,
                         ShvBodyContact *deepest);
/* Relative velocity of the first against the second at a contact, and what of it the normal sees. */
ShvVec3 shv_collide_velocity(const ShvObstacles *obstacles, const ShvBodyContact *contact);

/* Impulses for the active contacts: normal relative velocity ≥ target, Coulomb friction; projected Gauss-Seidel on the
   accumulated impulses. Where friction and restitution together would raise the energy (each alone cannot), all impulses
   are scaled down to where they leave it. Returns the work on free obstacles, J; *impulse receives the total impulse on
   them, N·s. */
double shv_collide_solve(ShvObstacles *obstacles, int32_t count, ShvVec3 *impulse);

#endif
