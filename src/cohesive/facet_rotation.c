#include "cohesive/facet_rotation.h"

/* The middles of faces that stand half a turn against each other fall together, and nothing that acts on them makes a couple:
   a triangle that has shrunk to this share of the facet's area is left out. */
static const double smallest_share = 0.25;

/* (Σ |r|² − r rᵀ)⁻¹ of three arms in one plane with no sum. In the plane Σ |r|² − Σ r rᵀ is the adjugate of Σ r rᵀ, whose
   determinant is a third of the square of twice the area. */
static void find_inverse(ShvFacetRotation *rotation)
{
    const ShvVec3 n = rotation->normal, *r = rotation->arm;
    const double spread = rotation->spread, tilt = rotation->tilt;
    rotation->inverse[0] = spread * n.x * n.x + tilt * (r[0].x * r[0].x + r[1].x * r[1].x + r[2].x * r[2].x);
    rotation->inverse[1] = spread * n.x * n.y + tilt * (r[0].x * r[0].y + r[1].x * r[1].y + r[2].x * r[2].y);
    rotation->inverse[2] = spread * n.x * n.z + tilt * (r[0].x * r[0].z + r[1].x * r[1].z + r[2].x * r[2].z);
    rotation->inverse[3] = spread * n.y * n.y + tilt * (r[0].y * r[0].y + r[1].y * r[1].y + r[2].y * r[2].y);
    rotation->inverse[4] = spread * n.y * n.z + tilt * (r[0].y * r[0].z + r[1].y * r[1].z + r[2].y * r[2].z);
    rotation->inverse[5] = spread * n.z * n.z + tilt * (r[0].z * r[0].z + r[1].z * r[1].z + r[2].z * r[2].z);
}

/* Relative to the middle of corner 0, so that no digits are lost far from the origin. */
void shv_facet_rotation_begin(ShvFacetRotation *rotation, const ShvState *state)
{
    const ShvVec3 start = shv_scale(shv_facet_rotation_twice_middle(rotation, 0, state->displacement), 0.5);
    const ShvVec3 *reference = rotation->reference;
    const ShvVec3 side =
        shv_sub(shv_madd(reference[0], 0.5, shv_facet_rotation_twice_middle(rotation, 1, state->displacement)), start);
    const ShvVec3 other =
        shv_sub(shv_madd(reference[1], 0.5, shv_facet_rotation_twice_middle(rotation, 2, state->displacement)), start);
    const ShvVec3 twice_area = shv_cross(side, other), mean = shv_scale(shv_add(side, other), 1.0 / 3.0);
    rotation->normal = shv_unit(twice_area);
    rotation->arm[0] = shv_scale(mean, -1.0);
    rotation->arm[1] = shv_sub(side, mean);
    rotation->arm[2] = shv_sub(other, mean);
    const double square = shv_dot(twice_area, twice_area);
    rotation->rotates = square > 4.0 * smallest_share * smallest_share * rotation->area * rotation->area;
    rotation->tilt = 3.0 / square;
    rotation->spread = 0.0;
    for (int i = 0; i < 3; i++) rotation->spread += shv_dot(rotation->arm[i], rotation->arm[i]);
    rotation->spread = 1.0 / rotation->spread;
    find_inverse(rotation);
    rotation->couple = shv_vec3(0.0, 0.0, 0.0);
    rotation->rate = shv_facet_rotation_rate(rotation, state);
}

void shv_facet_rotation_answer(ShvFacetRotation *rotation, const ShvVec3 couple[3])
{
    const ShvVec3 sum = shv_add(couple[0], shv_add(couple[1], couple[2])), change = shv_sub(sum, rotation->couple);
    rotation->answers = rotation->rotates && (change.x != 0.0 || change.y != 0.0 || change.z != 0.0);
    if (rotation->answers) rotation->answer = shv_facet_rotation_invert(rotation, shv_scale(change, 0.5));
    rotation->couple = sum;
}
