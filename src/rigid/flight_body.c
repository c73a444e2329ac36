#include "rigid/flight_body.h"

static const double slop_of_radius = 1e-6;

static ShvStatus copy_surface(ShvFlightBody *body, const ShvRigidWorld *world, ShvError *error)
{
    const ShvFragment *fragment = &world->fragments->items[body->fragment];
    int32_t *nodes = NULL, count = 0;
    SHV_TRY(shv_fragment_surface(world->fragments, world->model, world->state, body->fragment, &nodes, &count, error));
    body->offsets = shv_allocate(world->fragments->memory, SHV_PART_RIGID, 3 * (size_t)count, sizeof(double));
    if (body->offsets)
        for (int32_t i = 0; i < count; i++)
            shv_store3(body->offsets + 3 * (int64_t)i,
                       shv_sub(shv_load3(world->state->reference + 3 * (int64_t)nodes[i]), fragment->reference_centre));
    shv_release(nodes);
    body->arms = (ShvArms){.offsets = body->offsets, .count = count, .radius = fragment->radius};
    return body->offsets ? SHV_OK : shv_fail_memory(error, "a fragment in flight", 3 * (size_t)count * sizeof(double));
}

static ShvVec3 arm_of(const ShvState *state, int32_t element, int32_t corner, ShvVec3 centre)
{
    return shv_sub(shv_load3(state->reference + 3 * (int64_t)shv_state_node(state, element, corner)), centre);
}

/* Of the k-th face of a fragment's surface, in which those of a tet are next to each other. */
static ShvFacetShape facet_of(const ShvState *state, const int32_t *faces, int32_t count, int32_t k, ShvVec3 centre)
{
    const int32_t element = faces[k] / 4, face = faces[k] % 4;
    ShvFacetShape facet = {.apex = arm_of(state, element, face, centre)};
    for (int c = 0; c < 3; c++) facet.corners[c] = arm_of(state, element, shv_face_corners[face][c], centre);
    for (int32_t i = k < 3 ? 0 : k - 3; i < count && i <= k + 3; i++)
        for (int c = 0; c < 3; c++)
            if (faces[i] == 4 * element + shv_face_corners[face][c]) facet.free |= (uint8_t)(1 << c);
    return facet;
}

/* Needed where some obstacle has features. */
static ShvStatus copy_facets(ShvFlightBody *body, const ShvRigidWorld *world, ShvError *error)
{
    const ShvVec3 centre = world->fragments->items[body->fragment].reference_centre;
    int32_t *faces, count, features = 0;
    for (int32_t o = 0; o < world->obstacles->count; o++) features += world->obstacles->items[o].feature_count;
    if (features == 0) return SHV_OK;
    SHV_TRY(shv_fragment_faces(world->fragments, world->state, body->fragment, &faces, &count, error));
    body->facets = shv_allocate(world->fragments->memory, SHV_PART_RIGID, (size_t)count, sizeof *body->facets);
    body->arms.facets = body->facets;
    body->arms.facet_count = body->facets ? count : 0;
    for (int32_t k = 0; k < body->arms.facet_count; k++) {
        double radius;
        body->facets[k] = facet_of(world->state, faces, count, k, centre);
        shv_facet_centre(&body->facets[k], &radius);
        body->arms.facet_radius = fmax(body->arms.facet_radius, radius);
    }
    shv_release(faces);
    return body->facets ? SHV_OK : shv_fail_memory(error, "a fragment in flight", (size_t)count * sizeof *body->facets);
}

static ShvStatus fill(ShvFlightBody *body, const ShvRigidWorld *world, ShvError *error)
{
    const ShvFragment *fragment = &world->fragments->items[body->fragment];
    const size_t obstacles = (size_t)world->obstacles->count;
    body->touched = shv_allocate(world->fragments->memory, SHV_PART_RIGID, obstacles, 1);
    body->touching = shv_allocate(world->fragments->memory, SHV_PART_RIGID, obstacles, 1);
    if (!body->touched || !body->touching) return shv_fail_memory(error, "a fragment in flight", 2 * obstacles);
    SHV_TRY(copy_surface(body, world, error));
    SHV_TRY(copy_facets(body, world, error));
    body->rotation = shv_free_rotation_make(&fragment->inertia);
    body->slop = slop_of_radius * fragment->radius;
    body->angular_momentum =
        shv_free_rotation_momentum(&body->rotation, fragment->orientation, fragment->angular_velocity);
    body->seen_orientation = fragment->orientation;
    body->seen_spin = fragment->angular_velocity;
    return SHV_OK;
}

ShvStatus shv_flight_body_create(ShvFlightBody **body, const ShvRigidWorld *world, int32_t fragment, ShvError *error)
{
    *body = shv_allocate(world->fragments->memory, SHV_PART_RIGID, 1, sizeof **body);
    if (!*body) return shv_fail_memory(error, "a fragment in flight", sizeof **body);
    (*body)->fragment = fragment;
    (*body)->time = world->state->time;
    const ShvStatus status = fill(*body, world, error);
    if (status == SHV_OK) return SHV_OK;
    shv_flight_body_destroy(*body);
    *body = NULL;
    return status;
}

void shv_flight_body_destroy(ShvFlightBody *body)
{
    if (!body) return;
    shv_release(body->touched);
    shv_release(body->touching);
    shv_release(body->offsets);
    shv_release(body->facets);
    shv_release(body);
}

void shv_flight_body_read(ShvFlightBody *body, const ShvFragment *fragment)
{
    if (shv_same3(body->seen_spin, fragment->angular_velocity) &&
        shv_same_quat(body->seen_orientation, fragment->orientation))
        return;
    body->angular_momentum =
        shv_free_rotation_momentum(&body->rotation, fragment->orientation, fragment->angular_velocity);
    body->seen_spin = fragment->angular_velocity;
    body->seen_orientation = fragment->orientation;
}

void shv_flight_body_write(ShvFlightBody *body, ShvFragment *fragment)
{
    fragment->angular_velocity =
        shv_free_rotation_velocity(&body->rotation, fragment->orientation, body->angular_momentum);
    body->seen_spin = fragment->angular_velocity;
    body->seen_orientation = fragment->orientation;
}
