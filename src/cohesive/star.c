#include "cohesive/star.h"

#include <math.h>

#include "cohesive/cohesive.h"
#include "cohesive/topology.h"
#include "cohesive/traction.h"

/* Faces slide past each other where a facet leans over by less than this: round-off. */
static const double overhang = 1e-6;
/* The same under pressure with friction, where no facet is flat enough: those of a rough crack lean by some 20 degrees, and what
   juts out is crushed, not ridden over. Fitted: with less a prism of granite is up to 47 % too strong, with more its strength
   does not grow with pressure as it should (docs/cohesive.md). */
static const double strained_overhang = 0.35;
/* Cosine between the largest principal stress and another direction, above which the first stands for both. */
static const double much_the_same = 0.9;
/* Cracks on several sides of a tet pull it off by what is left of their own traction, and pieces of one tet are the mesh's and
   not the material's: its last bond counts this often, which leaves crumbs to where a body is really crushed. */
static const double last_bond = 16.0;

/* Of its strength: a disk at the surface that passes on less is not what the tension there pulls at. */
static const double least_passed_on = 0.05;
/* Facets that lean by more than 45° across the pull count as ones that do so by 45°. */
static const double least_projected_share = 0.7;

static size_t most_joints(int32_t members)
{
    return (size_t)members * SHV_MEMBER_JOINTS / 2 + 1;
}

ShvStatus shv_star_create(ShvStar *star, ShvMemory *memory, int32_t most_corners, ShvError *error)
{
    const size_t members = (size_t)most_corners, joints = most_joints(most_corners);
    *star = (ShvStar){0};
    star->cut.members = shv_allocate(memory, SHV_PART_COHESIVE, members, sizeof *star->cut.members);
    star->cut.queue = shv_allocate(memory, SHV_PART_COHESIVE, members, sizeof *star->cut.queue);
    star->cut.joints = shv_allocate(memory, SHV_PART_COHESIVE, joints, sizeof *star->cut.joints);
    star->cut.flow = shv_allocate(memory, SHV_PART_COHESIVE, joints, sizeof *star->cut.flow);
    star->facets = shv_allocate(memory, SHV_PART_COHESIVE, joints, sizeof *star->facets);
    star->disk = shv_allocate(memory, SHV_PART_COHESIVE, joints, sizeof *star->disk);
    if (star->cut.members && star->cut.queue && star->cut.joints && star->cut.flow && star->facets && star->disk)
        return SHV_OK;
    shv_star_release(star);
    return shv_fail_memory(error, "the tets round a node", members * sizeof *star->cut.members);
}

void shv_star_release(ShvStar *star)
{
    shv_release(star->cut.members);
    shv_release(star->cut.queue);
    shv_release(star->cut.joints);
    shv_release(star->cut.flow);
    shv_release(star->facets);
    shv_release(star->disk);
    *star = (ShvStar){0};
}

/* ---- the star ---- */

static ShvVec3 apply(const double voigt[6], ShvVec3 v)
{
    return shv_vec3(voigt[0] * v.x + voigt[5] * v.y + voigt[4] * v.z, voigt[5] * v.x + voigt[1] * v.y + voigt[3] * v.z,
                    voigt[4] * v.x + voigt[3] * v.y + voigt[2] * v.z);
}

/* A third of a face's area, outward, as the element stands now. */
static ShvVec3 third_of_area(const ShvState *state, int32_t element, int face)
{
    const uint8_t *corners = shv_face_corners[face];
    const ShvVec3 start = shv_state_position(state, shv_state_node(state, element, corners[0]));
    const ShvVec3 side = shv_sub(shv_state_position(state, shv_state_node(state, element, corners[1])), start);
    const ShvVec3 other = shv_sub(shv_state_position(state, shv_state_node(state, element, corners[2])), start);
    return shv_scale(shv_cross(side, other), 1.0 / 6.0);
}

/* Whether one facet is all that an element has left after others have been inserted. */
static bool hangs_on_one(const ShvCohesive *cohesive, int32_t element)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    int intact = 0, inserted = 0;
    for (int k = 0; k < 4; k++) {
        const int32_t facet = adjacency->element_facets[4 * (int64_t)element + k];
        if (facet >= adjacency->interior_count) continue;
        intact += cohesive->facet_cohesive[facet] < 0;
        inserted += cohesive->facet_cohesive[facet] >= 0;
    }
    return intact == 1 && inserted >= 2;
}

static double share_of_strength(const ShvCohesive *cohesive, int32_t facet, const int32_t *elements)
{
    const bool last = cohesive->facet_cohesive[facet] < 0 &&
                      (hangs_on_one(cohesive, elements[0]) || hangs_on_one(cohesive, elements[1]));
    return last ? last_bond : 1.0;
}

static void add_joint(ShvStar *star, const ShvCohesive *cohesive, const ShvState *state, const double *stress,
                      int32_t facet, int32_t first, int32_t second)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const int32_t *elements = adjacency->facet_elements + 2 * (int64_t)facet;
    const ShvMaterial *material = shv_cohesive_material(cohesive->model, facet);
    const int32_t number = star->cut.joint_count++;
    ShvStarFacet *joint = &star->facets[number];
    double mean[6];
    for (int i = 0; i < 6; i++)
        mean[i] =
            0.5 * (stress[shv_cohesive_stress_slot(elements[0], i)] + stress[shv_cohesive_stress_slot(elements[1], i)]);
    joint->facet = facet;
    joint->area = third_of_area(state, elements[0], adjacency->facet_faces[2 * (int64_t)facet]);
    joint->size = shv_norm(joint->area);
    joint->force = apply(mean, joint->area);
    joint->strength = material ? cohesive->facet_strength[facet] : (double)INFINITY;
    joint->tip = shv_front_tip(cohesive, state, facet, star->node);
    const bool leans = joint->tip.lowered && cohesive->facet_cohesive[facet] >= 0;
    joint->shear_ratio = material && !leans ? shv_shear_ratio(material) : 1.0;
    joint->share = share_of_strength(cohesive, facet, elements);
    joint->friction =
        material ? material->friction * shv_larger(-shv_dot(joint->force, joint->area) / joint->size, 0.0) : 0.0;
    star->cut.joints[number].member[0] = first;
    star->cut.joints[number].member[1] = second;
    for (int k = 0; k < 2; k++) {
        int32_t *slot = star->cut.members[k ? second : first].joint;
        while (*slot >= 0) slot++;
        *slot = number;
    }
}

/* Facets from an element to members after it; those that were split at the node lead to none. */
static void join_member(ShvStar *star, const ShvCohesive *cohesive, const ShvState *state, const double *stress,
                        const int32_t *corners, int32_t member)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const int32_t element = corners[member] / 4;
    for (int opposite = 0; opposite < 4; opposite++) {
        const int32_t facet = adjacency->element_facets[4 * (int64_t)element + opposite];
        if (opposite == corners[member] % 4 || facet >= adjacency->interior_count) continue;
        const int32_t *elements = adjacency->facet_elements + 2 * (int64_t)facet;
        if (elements[0] != element) continue;
        const int32_t second = shv_topology_find(corners, star->cut.member_count, elements[1]);
        if (second >= 0) add_joint(star, cohesive, state, stress, facet, member, second);
    }
}

static void gather(ShvStar *star, const ShvCohesive *cohesive, const ShvState *state, const double *stress,
                   int32_t node)
{
    const int32_t *corners = state->corners + state->corner_start[node];
    double mass = 0.0, sum[6] = {0.0};
    star->cut.member_count = state->corner_count[node];
    star->cut.joint_count = 0;
    for (int32_t i = 0; i < star->cut.member_count; i++) {
        const double own = state->element_mass[corners[i] / 4];
        mass += own;
        for (int k = 0; k < 6; k++) sum[k] += own * stress[shv_cohesive_stress_slot(corners[i] / 4, k)];
        for (int k = 0; k < SHV_MEMBER_JOINTS; k++) star->cut.members[i].joint[k] = -1;
    }
    for (int k = 0; k < 6; k++) star->stress[k] = sum[k] / mass;
    for (int32_t i = 0; i < star->cut.member_count; i++) join_member(star, cohesive, state, stress, corners, i);
}

/* ---- one direction ---- */

/* `along`: cosine between what a group leaves behind, outward, and where it goes. */
static double capacity(const ShvStarFacet *facet, double size, double along, bool goes_on)
{
    if (along > (facet->friction > 0.0 ? strained_overhang : overhang)) return (double)INFINITY;
    if (goes_on && facet->tip.lowered) return size * facet->share * facet->tip.strength;
    const double cohesion = size * facet->share * facet->strength * shv_strength_share(along, facet->shear_ratio);
    return cohesion + facet->friction * sqrt(shv_larger(1.0 - along * along, 0.0));
}

/* Returns the most that a facet passes on of what it could hold: no group is pulled harder against what holds it. */
static double load(ShvStar *star, ShvVec3 direction, bool goes_on)
{
    double most = 0.0;
    for (int32_t i = 0; i < star->cut.member_count; i++) star->cut.members[i].pull = 0.0;
    for (int32_t k = 0; k < star->cut.joint_count; k++) {
        const ShvStarFacet *facet = &star->facets[k];
        ShvJoint *joint = &star->cut.joints[k];
        const double size = facet->size, along = shv_dot(facet->area, direction) / size;
        const double force = shv_dot(facet->force, direction);
        joint->first_flow = -force;
        joint->capacity[0] = capacity(facet, size, along, goes_on);
        joint->capacity[1] = capacity(facet, size, -along, goes_on);
        star->cut.members[joint->member[0]].pull -= force;
        star->cut.members[joint->member[1]].pull += force;
        const double held = joint->capacity[force > 0.0];
        if (fabs(force) > most * held) most = fabs(force) / held;
    }
    return most;
}

/* Whether the group just found leaves across a joint: 1 outward from its first member, -1 from its second, 0 not at all. */
static int leaves(const ShvStar *star, int32_t joint)
{
    const int32_t *member = star->cut.joints[joint].member;
    return (star->cut.members[member[0]].in_group != 0) - (star->cut.members[member[1]].in_group != 0);
}

static void keep_disk(ShvStar *star, const ShvCohesive *cohesive)
{
    star->disk_count = 0;
    for (int32_t k = 0; k < star->cut.joint_count; k++) {
        if (leaves(star, k) == 0) continue;
        if (cohesive->facet_cohesive[star->facets[k].facet] < 0) star->disk[star->disk_count++] = k;
    }
}

/* Whether the group just found leaves along a crack that has opened across the pull, or there is none, but a slit. The facets of a rough
   crack may all lean by more than it does: their sum counts. */
static bool follows_crack(const ShvStar *star, ShvVec3 direction)
{
    bool any = false;
    ShvVec3 left = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t k = 0; k < star->cut.joint_count; k++) {
        if (!star->facets[k].tip.behind) continue;
        any = true;
        left = shv_madd(left, (double)leaves(star, k), star->facets[k].area);
    }
    return !any || shv_front_is_across(left, direction);
}

/* Of the area of the facets that hold what tips do: what they cover of the plane across the pull. */
static double projected_share(const ShvStar *star, ShvVec3 direction)
{
    double size = 0.0, projected = 0.0;
    for (int32_t k = 0; k < star->cut.joint_count; k++) {
        const ShvStarFacet *facet = &star->facets[k];
        if (leaves(star, k) == 0 || !facet->tip.lowered || facet->tip.behind) continue;
        size += facet->size;
        projected += fabs(shv_dot(facet->area, direction));
    }
    return size > 0.0 ? shv_larger(projected / size, least_projected_share) : 1.0;
}

/* The flattest disk is looked for, as leaning facets hold what flat ones do; judged is what it covers. */
static void try_direction(ShvStar *star, const ShvCohesive *cohesive, ShvVec3 direction, double least, bool goes_on)
{
    const double wanted = shv_larger(least, star->ratio), searched = goes_on ? least_projected_share * wanted : wanted;
    const double most = load(star, direction, goes_on);
    star->nearest = shv_larger(star->nearest, most / searched);
    if (most < searched) return;
    const double found = shv_cut_weakest(&star->cut, searched);
    const double share = goes_on ? projected_share(star, direction) : 1.0, ratio = found / share;
    if (ratio < wanted || !(ratio > star->ratio) || (goes_on && !follows_crack(star, direction))) return;
    star->ratio = ratio;
    star->projected_share = share;
    star->direction = direction;
    star->goes_on = goes_on;
    keep_disk(star, cohesive);
}

/* ---- all of them ---- */

/* Under the mean stress, the direction in which the facet that is nearest to its strength has least to spare: a flat crack
   slides that way, and one that is kept to a plane opens so, whatever pulls along it. */
static ShvVec3 weakest_direction(const ShvStar *star)
{
    double largest = 0.0;
    ShvVec3 direction = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t k = 0; k < star->cut.joint_count; k++) {
        const ShvStarFacet *facet = &star->facets[k];
        const double soft = 1.0 / (facet->shear_ratio * facet->shear_ratio);
        const ShvVec3 normal = shv_scale(facet->area, 1.0 / facet->size), traction = apply(star->stress, normal);
        const double tension = shv_dot(traction, normal);
        const ShvVec3 shear = shv_scale(shv_madd(traction, -tension, normal), soft);
        const ShvVec3 opening = shv_madd(shear, shv_larger(tension, 0.0), normal);
        const double friction = facet->friction > 0.0 ? facet->friction / (facet->shear_ratio * facet->size) : 0.0;
        const double held = facet->strength + friction;
        const double value = shv_dot(traction, opening) / (held * held);
        if (!(value > largest)) continue;
        largest = value;
        direction = shv_unit(opening);
    }
    return direction;
}

static bool is_front(const ShvStar *star, const ShvCohesive *cohesive, const ShvState *state, ShvVec3 direction)
{
    if (!cohesive->front.any) return false;
    for (int32_t k = 0; k < star->cut.joint_count; k++)
        if (star->facets[k].tip.behind) return true;
    return shv_front_is_across(shv_front_normal(cohesive, state, star->node), direction);
}

/* Directions come with either sign: what moves is a group or all the others. */
void shv_star_evaluate(ShvStar *star, const ShvCohesive *cohesive, const ShvState *state, const double *stress,
                       int32_t node, double least)
{
    double values[3];
    ShvMat3 axes;
    star->ratio = star->nearest = 0.0;
    star->disk_count = 0;
    star->node = node;
    gather(star, cohesive, state, stress, node);
    const double *m = star->stress;
    const ShvMat3 mean = {{{m[0], m[5], m[4]}, {m[5], m[1], m[3]}, {m[4], m[3], m[2]}}};
    shv_symmetric_eigen(&mean, values, &axes);
    const ShvVec3 first = shv_vec3(axes.m[0][2], axes.m[1][2], axes.m[2][2]);
    const ShvVec3 last = shv_vec3(axes.m[0][0], axes.m[1][0], axes.m[2][0]);
    const ShvMaterial *material = shv_model_material(cohesive->model, state->corners[state->corner_start[node]] / 4);
    const ShvVec3 across = shv_scale(first, material->riding[0]);
    if (values[2] > fmax(0.0, -values[0]) && is_front(star, cohesive, state, first))
        try_direction(star, cohesive, first, least, true);
    if (values[2] > 0.0) try_direction(star, cohesive, first, least, false);
    const ShvVec3 other = weakest_direction(star);
    if (fabs(shv_dot(other, first)) < much_the_same) try_direction(star, cohesive, other, least, false);
    if (!(values[0] < 0.0)) return;
    try_direction(star, cohesive, shv_madd(across, material->riding[1], last), least, false);
    try_direction(star, cohesive, shv_madd(across, -material->riding[1], last), least, false);
}

void shv_star_begin(ShvStar *star, const ShvCohesive *cohesive, const ShvState *state, const double *stress,
                    int32_t node, ShvSurfaceTension tension, double least)
{
    star->ratio = 0.0;
    star->disk_count = 0;
    star->node = node;
    gather(star, cohesive, state, stress, node);
    for (int32_t k = 0; k < star->cut.joint_count; k++)
        star->facets[k].tip = (ShvTip){.strength = star->facets[k].strength, .lowered = true};
    try_direction(star, cohesive, tension.direction, least_passed_on, true);
    const double held = shv_smaller(star->ratio, 1.0);
    star->ratio = star->disk_count > 0 ? tension.stress / cohesive->initiation.strength[node] : 0.0;
    if (!(star->ratio >= least)) star->disk_count = 0;
    for (int32_t k = 0; k < star->disk_count; k++) star->facets[star->disk[k]].tip.strength *= held;
}
