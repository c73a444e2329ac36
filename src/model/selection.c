#include "model/selection.h"

double shv_selection_distance(const ShvSelection *selection, ShvVec3 point)
{
    const double tolerance = selection->tolerance;
    double x[3], distance = 0.0;
    shv_store3(x, point);
    switch (selection->kind) {
    case SHV_SELECT_ALL:
        return 0.0;
    case SHV_SELECT_BOX:
        for (int k = 0; k < 3; k++) {
            distance = fmax(distance, selection->box_min[k] - tolerance - x[k]);
            distance = fmax(distance, x[k] - (selection->box_max[k] + tolerance));
        }
        return distance;
    case SHV_SELECT_PLANE:
        break;
    }
    const ShvVec3 normal = shv_unit(shv_load3(selection->plane_normal));
    const double beyond = fabs(shv_dot(normal, point) - selection->plane_offset) - tolerance;
    return beyond <= 0.0 ? 0.0 : beyond; /* NaN without a normal: no point is chosen */
}

bool shv_selection_contains(const ShvSelection *selection, ShvVec3 point)
{
    return shv_selection_distance(selection, point) == 0.0;
}
