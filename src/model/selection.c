#include "model/selection.h"

bool shv_selection_contains(const ShvSelection *selection, ShvVec3 point)
{
    const double tolerance = selection->tolerance;
    double x[3];
    shv_store3(x, point);
    switch (selection->kind) {
    case SHV_SELECT_ALL:
        return true;
    case SHV_SELECT_BOX:
        for (int k = 0; k < 3; k++)
            if (x[k] < selection->box_min[k] - tolerance || x[k] > selection->box_max[k] + tolerance) return false;
        return true;
    case SHV_SELECT_PLANE:
        break;
    }
    const ShvVec3 normal = shv_unit(shv_load3(selection->plane_normal));
    return fabs(shv_dot(normal, point) - selection->plane_offset) <= tolerance;
}
