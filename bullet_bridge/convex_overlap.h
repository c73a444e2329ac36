/* Whether two convex bodies overlap: yes or no, by libccd's GJK (depth.h says how deep, at ten times the cost). */
#ifndef BULLET_BRIDGE_CONVEX_OVERLAP_H
#define BULLET_BRIDGE_CONVEX_OVERLAP_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Hulls of points, 3 numbers each, world; at least one. Bodies that touch, or overlap by less than about 1e-6 of their size, do
   not overlap. */
bool shv_convex_overlap(const double *first, int32_t first_count, const double *second, int32_t second_count);

#ifdef __cplusplus
}
#endif
#endif
