#include "coupling/near.h"

#include <string.h>

static ShvBox box_of_tet(const ShvHybrid *hybrid, int32_t element)
{
    ShvBox box = shv_box_empty();
    for (int corner = 0; corner < 4; corner++)
        shv_box_add(&box, shv_state_position(&hybrid->state, shv_state_node(&hybrid->state, element, corner)));
    return box;
}

/* Number of the cell that holds a coordinate; those outside belong to the outermost. */
static int cell_of(double x, double low, double size)
{
    const double at = size > 0.0 ? floor((x - low) / size) : 0.0;
    return at > 0.0 ? at < SHV_NEAR_CELLS - 1 ? (int)at : SHV_NEAR_CELLS - 1 : 0;
}

typedef struct Cells {
    int low[3], high[3];
} Cells;

static Cells cells_of(const ShvNear *near, const ShvBox *box)
{
    const ShvVec3 low = near->box.low, size = near->cell;
    return (Cells){.low = {cell_of(box->low.x, low.x, size.x), cell_of(box->low.y, low.y, size.y),
                           cell_of(box->low.z, low.z, size.z)},
                   .high = {cell_of(box->high.x, low.x, size.x), cell_of(box->high.y, low.y, size.y),
                            cell_of(box->high.z, low.z, size.z)}};
}

static void mark(ShvNear *near, const ShvBox *box)
{
    const Cells cells = cells_of(near, box);
    const unsigned row = (2u << cells.high[0]) - (1u << cells.low[0]);
    for (int z = cells.low[2]; z <= cells.high[2]; z++)
        for (int y = cells.low[1]; y <= cells.high[1]; y++) near->rows[z][y] |= (uint16_t)row;
}

void shv_near_find(const ShvHybrid *hybrid, const ShvFragment *fragment, ShvNear *near)
{
    memset(near, 0, sizeof *near);
    near->box = shv_box_empty();
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        shv_box_add(&near->box, shv_state_position(&hybrid->state, node));
        near->speed = fmax(near->speed, shv_norm(shv_load3(hybrid->state.velocity + 3 * (int64_t)node)));
    }
    near->cell = shv_scale(shv_sub(near->box.high, near->box.low), 1.0 / SHV_NEAR_CELLS);
    for (int32_t k = 0; k < fragment->element_count; k++) {
        const ShvBox box = box_of_tet(hybrid, hybrid->fragments.elements[fragment->element_begin + k]);
        mark(near, &box);
    }
}

/* How far a coordinate is outside of a cell, m. */
static double outside(double x, double low, double size, int cell)
{
    return fmax(0.0, fmax(low + cell * size - x, x - (low + (cell + 1) * size)));
}

bool shv_near_meets(const ShvNear *near, ShvVec3 centre, double radius)
{
    const ShvBox around = shv_box_grown((ShvBox){centre, centre}, radius);
    if (!shv_box_meets(&around, &near->box)) return false;
    const Cells cells = cells_of(near, &around);
    const ShvVec3 low = near->box.low, size = near->cell;
    for (int z = cells.low[2]; z <= cells.high[2]; z++)
        for (int y = cells.low[1]; y <= cells.high[1]; y++)
            for (int x = cells.low[0]; x <= cells.high[0]; x++) {
                const ShvVec3 out = {outside(centre.x, low.x, size.x, x), outside(centre.y, low.y, size.y, y),
                                     outside(centre.z, low.z, size.z, z)};
                if ((near->rows[z][y] >> x & 1) && shv_dot(out, out) <= radius * radius) return true;
            }
    return false;
}
