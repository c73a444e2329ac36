#include "fragment/fragment.h"

static void sum_elements(ShvFragment *fragment, const int32_t *elements, const ShvModel *model, const ShvState *state)
{
    double mass = 0.0, volume = 0.0, loss = 0.0;
    for (int32_t i = 0; i < fragment->element_count; i++) {
        const ShvMaterial *material = shv_model_material(model, elements[i]);
        mass += state->element_mass[elements[i]];
        volume += state->element_mass[elements[i]] / material->density;
        loss += state->element_mass[elements[i]] * material->loss_factor;
    }
    fragment->mass = mass;
    fragment->volume = volume;
    fragment->loss_factor = loss / mass;
}

/* Centre of the lumped masses, summed from the first node so that a body far from the origin loses no digits. */
static ShvVec3 lumped_centre(const int32_t *nodes, int32_t count, const ShvState *state)
{
    if (count == 0) return shv_vec3(0.0, 0.0, 0.0);
    const ShvVec3 start = shv_load3(state->reference + 3 * (int64_t)nodes[0]);
    ShvVec3 moment = shv_vec3(0.0, 0.0, 0.0);
    double mass = 0.0;
    for (int32_t i = 0; i < count; i++) {
        const double m = state->mass[nodes[i]];
        moment = shv_madd(moment, m, shv_sub(shv_load3(state->reference + 3 * (int64_t)nodes[i]), start));
        mass += m;
    }
    return mass > 0.0 ? shv_madd(start, 1.0 / mass, moment) : start;
}

/* a² = 6 (I₂ + I₃ − I₁)/m. */
static void find_sides(ShvFragment *fragment)
{
    double values[3];
    shv_symmetric_eigen(&fragment->inertia, values, NULL);
    const double trace = values[0] + values[1] + values[2];
    for (int i = 0; i < 3; i++) fragment->sides[i] = sqrt(fmax(0.0, 6.0 * (trace - 2.0 * values[i]) / fragment->mass));
}

static ShvVec3 lower(ShvVec3 a, ShvVec3 b)
{
    return shv_vec3(b.x < a.x ? b.x : a.x, b.y < a.y ? b.y : a.y, b.z < a.z ? b.z : a.z);
}

static ShvVec3 upper(ShvVec3 a, ShvVec3 b)
{
    return shv_vec3(b.x > a.x ? b.x : a.x, b.y > a.y ? b.y : a.y, b.z > a.z ? b.z : a.z);
}

void shv_fragment_measure(ShvFragment *fragment, const ShvFragments *fragments, const ShvModel *model,
                          const ShvState *state)
{
    const int32_t *nodes = fragments->nodes + fragment->node_begin;
    sum_elements(fragment, fragments->elements + fragment->element_begin, model, state);
    fragment->surface = shv_fragment_surface_area(fragment, fragments, model, state);
    fragment->reference_centre = lumped_centre(nodes, fragment->node_count, state);
    ShvVec3 low = {0.0, 0.0, 0.0}, high = {0.0, 0.0, 0.0};
    double xx = 0.0, yy = 0.0, zz = 0.0, yz = 0.0, xz = 0.0, xy = 0.0, farthest = 0.0;
    for (int32_t i = 0; i < fragment->node_count; i++) {
        const double m = state->mass[nodes[i]];
        const ShvVec3 r = shv_sub(shv_load3(state->reference + 3 * (int64_t)nodes[i]), fragment->reference_centre);
        xx += m * (r.y * r.y + r.z * r.z);
        yy += m * (r.x * r.x + r.z * r.z);
        zz += m * (r.x * r.x + r.y * r.y);
        yz -= m * r.y * r.z;
        xz -= m * r.x * r.z;
        xy -= m * r.x * r.y;
        const double square = shv_dot(r, r);
        farthest = square > farthest ? square : farthest;
        low = lower(low, r);
        high = upper(high, r);
    }
    fragment->inertia = (ShvMat3){{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
    find_sides(fragment);
    fragment->radius = sqrt(farthest);
    fragment->low = low;
    fragment->high = high;
}

ShvMat3 shv_fragment_world_inertia(const ShvFragment *fragment)
{
    const ShvMat3 rotation = shv_quat_to_matrix(fragment->orientation), transposed = shv_transpose(&rotation);
    const ShvMat3 turned = shv_multiply(&rotation, &fragment->inertia);
    return shv_multiply(&turned, &transposed);
}

double shv_fragment_rotational(const ShvFragment *fragment)
{
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    return 0.5 * shv_dot(fragment->angular_velocity, shv_apply(&inertia, fragment->angular_velocity));
}

double shv_fragment_kinetic(const ShvFragment *fragment)
{
    return 0.5 * fragment->mass * shv_dot(fragment->velocity, fragment->velocity) + shv_fragment_rotational(fragment);
}
