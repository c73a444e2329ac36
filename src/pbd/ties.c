#include "pbd/ties.h"

static ShvStatus append(ShvTies *ties, ShvTie tie, ShvError *error)
{
    if (ties->count == ties->capacity) {
        const int32_t wanted = 16 + 2 * ties->capacity;
        SHV_RESIZE(ties->memory, SHV_PART_BARS, ties->items, (size_t)wanted, "ties across bonded facets",
                   (size_t)wanted * sizeof *ties->items, error);
        ties->capacity = wanted;
    }
    ties->items[ties->count++] = tie;
    return SHV_OK;
}

/* The openings are those with which the body came to rest. */
static ShvStatus tie_facet(ShvTies *ties, const ShvCohesive *cohesive, int32_t index, ShvError *error)
{
    const ShvCohesiveSides *sides = &cohesive->sides[index];
    for (int c = 0; c < 3; c++) {
        if (sides->first[c] == sides->second[c]) continue;
        const ShvOpening at = cohesive->internal[3 * (int64_t)index + c].opening;
        const ShvTie tie = {{sides->first[c], sides->second[c]}, sqrt(at.normal * at.normal + at.shear * at.shear)};
        SHV_TRY(append(ties, tie, error));
    }
    return SHV_OK;
}

ShvStatus shv_ties_update(ShvTies *ties, const ShvFragments *fragments, const ShvState *state, const uint8_t *flags,
                          ShvError *error)
{
    const ShvCohesive *cohesive = fragments->bonds;
    ties->memory = fragments->memory;
    ties->count = 0;
    for (int32_t k = 0; cohesive && k < cohesive->live_count; k++) {
        const int32_t index = cohesive->live[k];
        if (!cohesive->bonded[index] || !flags[state->element_fragment[cohesive->sides[index].elements[0]]]) continue;
        const ShvStatus status = tie_facet(ties, cohesive, index, error);
        if (status != SHV_OK) ties->count = 0;
        SHV_TRY(status);
    }
    return SHV_OK;
}

void shv_ties_release(ShvTies *ties)
{
    shv_release(ties->items);
    *ties = (ShvTies){0};
}

void shv_ties_sweep(const ShvTies *ties, double stiffness, const double *anchors, double *shifts)
{
    for (int32_t k = 0; k < ties->count; k++) {
        const ShvTie *tie = &ties->items[k];
        const int64_t first = 4 * (int64_t)tie->ends[0], second = 4 * (int64_t)tie->ends[1];
        const double w[2] = {anchors[first + 3], anchors[second + 3]};
        const ShvVec3 displacement = shv_sub(shv_load3(shifts + second), shv_load3(shifts + first));
        const double length = shv_norm(displacement);
        if (!(length > 0.0 && w[0] + w[1] > 0.0)) continue;
        const ShvVec3 change = shv_scale(displacement, stiffness * (length - tie->length) / (length * (w[0] + w[1])));
        shv_add_to3(shifts + first, shv_scale(change, w[0]));
        shv_add_to3(shifts + second, shv_scale(change, -w[1]));
    }
}
