/* Eight bars, or eight tets of six bars each, relaxed at once. Ends are quads: reference position and inverse mass,
   displacement and nothing. */
#ifndef SHV_PBD_BAR_KERNEL_H
#define SHV_PBD_BAR_KERNEL_H

#include "base/simd.h"

/* The six edges of a tet. */
static const uint8_t shv_tet_edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* Where eight bars are: the present edge vector, its length, and (length − rest) (length + rest). */
typedef struct ShvBarShape {
    ShvWide edge[3], length, excess;
} ShvBarShape;

static inline ShvBarShape shv_bar_shape(const ShvWide a[4], const ShvWide b[4], const ShvWide u[4], const ShvWide v[4])
{
    ShvBarShape shape;
    ShvWide square = shv_wide_zero();
    shape.excess = shv_wide_zero();
    for (int c = 0; c < 3; c++) {
        const ShvWide reference = shv_wide_sub(a[c], b[c]), change = shv_wide_sub(u[c], v[c]);
        shape.edge[c] = shv_wide_add(reference, change);
        shape.excess = shv_wide_fma(change, shv_wide_add(reference, shape.edge[c]), shape.excess);
        square = shv_wide_fma(shape.edge[c], shape.edge[c], square);
    }
    shape.length = shv_wide_sqrt(square);
    return shape;
}

/* f = k (length − rest)/(length (w_a + w_b)); 0 between two pinned nodes and where a length is 0. */
static inline ShvWide shv_bar_factor(ShvWide stiffness, ShvWide rest, ShvWide weights, const ShvBarShape *shape)
{
    const ShvWide zero = shv_wide_zero();
    const ShvWide divisor = shv_wide_mul(shv_wide_mul(shape->length, shv_wide_add(shape->length, rest)), weights);
    const ShvWideMask sound = shv_wide_less(zero, shv_wide_min(divisor, rest));
    return shv_wide_select(sound, shv_wide_div(shv_wide_mul(stiffness, shape->excess), divisor), zero);
}

/* Moves the ends: Δu = −w_a f e, Δv = w_b f e. */
static inline void shv_bar_move(ShvWide f, const ShvBarShape *shape, ShvWide a, ShvWide b, ShvWide u[4], ShvWide v[4])
{
    const ShvWide first = shv_wide_mul(a, f), second = shv_wide_mul(b, f);
    for (int c = 0; c < 3; c++) {
        u[c] = shv_wide_fnma(first, shape->edge[c], u[c]);
        v[c] = shv_wide_fma(second, shape->edge[c], v[c]);
    }
}

/* Relaxes bars between the ends a (displacement u) and b (displacement v). */
static inline void shv_bar_relax(ShvWide stiffness, ShvWide rest, const ShvWide a[4], const ShvWide b[4], ShvWide u[4],
                                 ShvWide v[4])
{
    const ShvBarShape shape = shv_bar_shape(a, b, u, v);
    const ShvWide f = shv_bar_factor(stiffness, rest, shv_wide_add(a[3], b[3]), &shape);
    shv_bar_move(f, &shape, a[3], b[3], u, v);
}

static inline void shv_bar_batch(ShvWide stiffness, const int32_t *ends, const double *rest, const double *anchors,
                                 double *shifts)
{
    ShvWide anchor[2][4], shift[2][4];
    for (int end = 0; end < 2; end++) {
        shv_wide_load_quads(anchors, ends + end * SHV_WIDE_LANES, anchor[end]);
        shv_wide_load_quads(shifts, ends + end * SHV_WIDE_LANES, shift[end]);
    }
    shv_bar_relax(stiffness, shv_wide_load(rest), anchor[0], anchor[1], shift[0], shift[1]);
    for (int end = 0; end < 2; end++) shv_wide_store_quads(shifts, ends + end * SHV_WIDE_LANES, shift[end]);
}

static inline void shv_tet_batch(ShvWide stiffness, const int32_t *ends, const double *rest, const double *anchors,
                                 double *shifts)
{
    ShvWide anchor[4][4], shift[4][4];
    for (int corner = 0; corner < 4; corner++) {
        shv_wide_load_quads(anchors, ends + corner * SHV_WIDE_LANES, anchor[corner]);
        shv_wide_load_quads(shifts, ends + corner * SHV_WIDE_LANES, shift[corner]);
    }
    for (int edge = 0; edge < 6; edge++) {
        const int i = shv_tet_edges[edge][0], j = shv_tet_edges[edge][1];
        shv_bar_relax(stiffness, shv_wide_load(rest + edge * SHV_WIDE_LANES), anchor[i], anchor[j], shift[i], shift[j]);
    }
    for (int corner = 0; corner < 4; corner++)
        shv_wide_store_quads(shifts, ends + corner * SHV_WIDE_LANES, shift[corner]);
}

#endif
