/* A program as one writes it with Bullet alone (btDiscreteDynamicsWorld with its default settings, double precision), to
   measure the rigid backend against. Not part of the library. */
#ifndef BULLET_BRIDGE_BENCH_PLAIN_WORLD_H
#define BULLET_BRIDGE_BENCH_PLAIN_WORLD_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct PlainWorld PlainWorld;

typedef struct PlainBody {
    int32_t hulls;               /* convex, */
    const int32_t *vertex_begin; /* hulls + 1 */
    const double *vertices;      /* 3 each, from the centre of mass in principal axes, m */
    double mass, moments[3];     /* kg, kg m² */
    double position[3], axes[9]; /* rows of the matrix from principal axes to the world's */
    double velocity[3], spin[3];
} PlainBody;

/* NULL when memory is out, as the other functions' 0. Bullet's constants (margins, breaking distance, speeds of rest) are made
   for bodies of about 1: `length`, m, is that unit. */
PlainWorld *plain_world_create(const double gravity[3], double friction, double length);
int plain_world_add_plane(PlainWorld *world, const double normal[3], double offset);
int plain_world_add_body(PlainWorld *world, const PlainBody *body);
int plain_world_step(PlainWorld *world, double step);
double plain_world_kinetic(const PlainWorld *world); /* J */
void plain_world_destroy(PlainWorld *world);

#ifdef __cplusplus
}
#endif
#endif
