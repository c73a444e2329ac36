/* Which Bullet this is. Functions of the single-precision library have other names (their numbers are floats), so that a mixed
   build does not link. */
#ifndef BULLET_BRIDGE_PRECISION_H
#define BULLET_BRIDGE_PRECISION_H

#ifdef __cplusplus
extern "C" {
#endif

/* Bullet's version number (324 is 3.24). */
int shv_bullet_version(void);

#ifdef __cplusplus
}
#endif
#endif
