/* The tip of the first crack, frame by frame: of the facets that are half opened the one that is farthest from where it began. */
#include "evaluate/gather.h"

static const double opened = 0.5; /* damage */

/* Centroid of the face opposite to a corner, in the reference mesh. */
static ShvVec3 face_centre(const ShvMeshView *mesh, int64_t element, int corner)
{
    ShvVec3 sum = shv_vec3(0.0, 0.0, 0.0);
    for (int k = 0; k < 4; k++)
        if (k != corner) sum = shv_add(sum, shv_load3(mesh->positions + 3 * (int64_t)mesh->elements[4 * element + k]));
    return shv_scale(sum, 1.0 / 3.0);
}

static ShvStatus find_tip(ShvGather *gather, const ShvSimulation *simulation, ShvVec3 *tip, double *length,
                          ShvError *error)
{
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    const size_t count = 4 * (size_t)mesh.element_count;
    ShvCrackView crack;
    SHV_TRY(shv_simulation_crack(simulation, &crack, error));
    if (!gather->damage) gather->damage = shv_pool_take(&gather->pool, count, sizeof(double));
    if (!gather->damage) return shv_fail_memory(error, "damage of facets", count * sizeof(double));
    shv_simulation_element_state(simulation, NULL, gather->damage);
    const ShvVec3 origin = shv_load3(crack.origin);
    for (int64_t i = 0; i < (int64_t)count; i++) {
        if (gather->damage[i] < opened) continue;
        const ShvVec3 centre = face_centre(&mesh, i / 4, (int)(i % 4));
        const double distance = shv_norm(shv_sub(centre, origin));
        if (distance <= *length) continue;
        *length = distance;
        *tip = centre;
    }
    return SHV_OK;
}

ShvStatus shv_gather_tip(ShvGather *gather, const ShvSimulation *simulation, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    ShvVec3 tip = shv_vec3((double)NAN, (double)NAN, (double)NAN);
    double length = 0.0, place[3];
    if (frame->inserted > 0) SHV_TRY(find_tip(gather, simulation, &tip, &length, error));
    shv_store3(place, tip);
    shv_outcome_add_vector(gather->outcome, "crack.tip", SHV_CLOCK_FRAME, place);
    shv_outcome_add(gather->outcome, "crack.length", SHV_CLOCK_FRAME, length);
    return SHV_OK;
}
