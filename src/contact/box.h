/* Boxes along the axes. */
#ifndef SHV_CONTACT_BOX_H
#define SHV_CONTACT_BOX_H

#include "base/vector.h"

typedef struct ShvBox {
    ShvVec3 low, high; /* empty: low above high */
} ShvBox;

static inline ShvBox shv_box_empty(void)
{
    const double far = (double)INFINITY;
    return (ShvBox){{far, far, far}, {-far, -far, -far}};
}
static inline void shv_box_add(ShvBox *box, ShvVec3 x)
{
    /* Comparisons become single instructions, unlike fmin and fmax; what is not a number counts nowhere in both. */
    box->low = shv_vec3(x.x < box->low.x ? x.x : box->low.x, x.y < box->low.y ? x.y : box->low.y,
                        x.z < box->low.z ? x.z : box->low.z);
    box->high = shv_vec3(x.x > box->high.x ? x.x : box->high.x, x.y > box->high.y ? x.y : box->high.y,
                         x.z > box->high.z ? x.z : box->high.z);
}
static inline ShvBox shv_box_grown(ShvBox box, double by)
{
    const ShvVec3 margin = {by, by, by};
    return (ShvBox){shv_sub(box.low, margin), shv_add(box.high, margin)};
}
static inline int shv_box_holds(const ShvBox *box, ShvVec3 x)
{
    return x.x >= box->low.x && x.x <= box->high.x && x.y >= box->low.y && x.y <= box->high.y && x.z >= box->low.z &&
           x.z <= box->high.z;
}
static inline int shv_box_meets(const ShvBox *a, const ShvBox *b)
{
    return a->low.x <= b->high.x && b->low.x <= a->high.x && a->low.y <= b->high.y && b->low.y <= a->high.y &&
           a->low.z <= b->high.z && b->low.z <= a->high.z;
}
/* Largest side. */
static inline double shv_box_size(const ShvBox *box)
{
    const double x = box->high.x - box->low.x, y = box->high.y - box->low.y, z = box->high.z - box->low.z;
    const double larger = x > y ? x : y;
    return larger > z ? larger : z;
}

#endif
