/* Whether points are in bodies, tet by tet. */
#ifndef SHV_TESTS_CONTACT_INSIDE_H
#define SHV_TESTS_CONTACT_INSIDE_H

#include "contact/surface_list.h"

static inline bool is_inside(const ShvSurfaceBodies *bodies, int32_t fragment, ShvVec3 x)
{
    const ShvState *state = bodies->state;
    for (int32_t e = 0; e < state->element_count; e++) {
        ShvVec3 at[4];
        double least = (double)INFINITY;
        if (state->element_fragment[e] != fragment) continue;
        for (int k = 0; k < 4; k++) at[k] = shv_bodies_position(bodies, shv_state_node(state, e, k), fragment);
        for (int f = 0; f < 4; f++) {
            const ShvVec3 a = at[shv_face_corners[f][0]];
            const ShvVec3 area =
                shv_cross(shv_sub(at[shv_face_corners[f][1]], a), shv_sub(at[shv_face_corners[f][2]], a));
            least = fmin(least, -shv_dot(area, shv_sub(x, a)));
        }
        if (least > 0.0) return true;
    }
    return false;
}

#endif
