#include "coupling/hybrid.h"

#include <string.h>

static ShvStatus reserve_nodal(ShvHybrid *hybrid, ShvError *error)
{
    if (hybrid->check.nodal_capacity >= hybrid->state.node_capacity) return SHV_OK;
    const size_t count = 6 * (size_t)hybrid->state.node_capacity;
    SHV_RESIZE(hybrid->memory, SHV_PART_STRESS, hybrid->check.nodal, count, "nodal stress", count * sizeof(double),
               error);
    hybrid->check.nodal_capacity = hybrid->state.node_capacity;
    return SHV_OK;
}

static ShvStatus nodal_stress(ShvHybrid *hybrid, ShvError *error)
{
    if (hybrid->scene->fracture.criterion != SHV_CRITERION_PRINCIPAL) return SHV_OK;
    SHV_TRY(reserve_nodal(hybrid, error));
#pragma omp parallel for schedule(static) num_threads(hybrid->model.threads)
    for (int32_t k = 0; k < hybrid->awake.node_count; k++) {
        const int32_t node = hybrid->awake.nodes[k];
        shv_solid_nodal_stress(&hybrid->solid, &hybrid->state, hybrid->check.stress, node,
                               hybrid->check.nodal + 6 * (int64_t)node);
    }
    return SHV_OK;
}

/* An impact loads a body from nothing to its strength within a few steps: until checks have shown how fast stress grows, each
   step is looked at. The memory of the rate decays by a tenth a check. */
void shv_check_clock_start(ShvCheckClock *clock)
{
    *clock = (ShvCheckClock){.due = 1, .rate = 1.0};
}

/* A growth that was seen fades by a tenth a check, since waves come back. Of the overshoot that the scene is promised, a tenth of the
   threshold, half is for how far above it the criterion may be found. */
static const double fading_growth = 0.9, overshoot = 0.1;

/* Fewer steps to the next check as stress grows faster. Where it has passed the threshold nothing need part all the same, as under a
   contact, or cracks are on their way: then no front may outrun the checks. But where all of a body is stretched fast, what has not
   parted yet grows on meanwhile. */
static void set_clock(ShvHybrid *hybrid, double largest)
{
    enum { RAREST = 10 };
    ShvCheckClock *clock = &hybrid->check.clock;
    const ShvFractureDefinition *fracture = &hybrid->scene->fracture;
    clock->rate = fmax((largest - clock->last) / clock->since, fading_growth * clock->rate);
    clock->last = largest;
    clock->since = 0;
    if (fracture->check_every > 0) {
        clock->due = fracture->check_every;
        return;
    }
    const double room = (1.0 + 0.5 * overshoot) * fracture->threshold - largest;
    const double growth = room > 0.0 ? room : overshoot * fracture->threshold;
    const double steps = clock->rate > 0.0 ? floor(growth / clock->rate) : RAREST;
    const double most = room > 0.0 ? RAREST : shv_front_steps(&hybrid->cohesive, hybrid->steps.last);
    clock->due = (int32_t)fmax(1.0, fmin(steps, fmin(most, RAREST)));
}

/* The first insertion since a fragment woke is an event; every insertion starts its quiet count afresh. */
static ShvStatus note_insertions(ShvHybrid *hybrid, int32_t count, ShvError *error)
{
    for (int32_t k = 0; k < count; k++) {
        const int32_t element = hybrid->model.adjacency.facet_elements[2 * (int64_t)hybrid->check.candidates[k]];
        const int32_t index = hybrid->state.element_fragment[element];
        ShvFragment *fragment = &hybrid->fragments.items[index];
        fragment->last_insertion = fragment->last_crack = hybrid->state.time;
        fragment->impact = fragment->borne_impact = 0.0;
        fragment->quiet = 0;
        hybrid->wake_audit.missed += fragment->audited;
        fragment->audited = false;
        if (fragment->cracked) continue;
        fragment->cracked = true;
        const ShvEventView event = {.time = hybrid->state.time,
                                    .kind = SHV_RUN_INSERTION,
                                    .fragment = index,
                                    .obstacle = -1,
                                    .value = hybrid->check.overstress[k]};
        SHV_TRY(shv_hybrid_log(hybrid, &event, error));
    }
    return SHV_OK;
}

/* Components of one awake fragment; its children carry on with its record, but each with its own damage. */
static ShvStatus relabel_fragment(ShvHybrid *hybrid, int32_t index, const ShvConnectivityChange *change,
                                  ShvError *error)
{
    int32_t parts = 0;
    const int32_t before = hybrid->fragments.count;
    SHV_TRY(shv_fragments_split_by(&hybrid->fragments, &hybrid->model, &hybrid->state, index, change, &parts, error));
    if (parts < 2) return SHV_OK;
    for (int32_t i = before; i < hybrid->fragments.count && hybrid->fragments.bonds; i++)
        shv_hybrid_note_damage(hybrid, &hybrid->fragments.items[i]);
    const ShvEventView event = {
        .time = hybrid->state.time, .kind = SHV_RUN_SPLIT, .fragment = index, .obstacle = -1, .value = parts};
    return shv_hybrid_log(hybrid, &event, error);
}

/* What has come apart is labelled at once, so that the present count of fragments does not depend on who looks when. Nodes of
   fragments in which facets have just been inserted, copies included, are listed anew. */
static ShvStatus relabel_cracked(ShvHybrid *hybrid, int32_t first_copy, ShvError *error)
{
    const int32_t count = hybrid->fragments.count;
    const ShvConnectivityChange change = {.first_copy = first_copy};
    for (int32_t i = 0; i < count; i++)
        if (hybrid->awake.flags[i] && hybrid->fragments.items[i].last_insertion == hybrid->state.time)
            SHV_TRY(relabel_fragment(hybrid, i, &change, error));
    return shv_awake_follow(hybrid, error);
}

ShvStatus shv_hybrid_split(ShvHybrid *hybrid, ShvError *error)
{
    if (!hybrid->model.can_break) return SHV_OK;
    const double start = shv_now();
    ShvCohesive *cohesive = &hybrid->cohesive;
    shv_cohesive_find_failed(cohesive, &hybrid->state, hybrid->awake.flags, &hybrid->observer.ledger);
    if (!hybrid->fragments.bonds) return SHV_OK; /* failed facets are counted, but it is nodes that join */
    const int32_t before = hybrid->fragments.count;
    const ShvConnectivityChange change = {hybrid->state.node_count, cohesive->failed, cohesive->failed_count};
    for (int32_t i = 0; i < cohesive->failed_count; i++) {
        const int32_t *elements = cohesive->sides[cohesive->failed[i]].elements;
        const int32_t *fragment = hybrid->state.element_fragment;
        for (int side = 0; side < 2; side++)
            hybrid->fragments.items[fragment[elements[side]]].last_crack = hybrid->state.time;
        /* one search a fragment: those after it find its parts apart already, or whole */
        if (fragment[elements[0]] != fragment[elements[1]]) continue;
        if (fragment[elements[0]] >= before) continue;
        ShvFragment *whole = &hybrid->fragments.items[fragment[elements[0]]];
        if (whole->searched == hybrid->state.step + 1) continue;
        whole->searched = hybrid->state.step + 1;
        SHV_TRY(relabel_fragment(hybrid, fragment[elements[0]], &change, error));
    }
    if (hybrid->fragments.count > before) SHV_TRY(shv_awake_follow(hybrid, error));
    shv_costs_add(&hybrid->costs, SHV_COST_PARTS, start);
    return SHV_OK;
}

/* The solid learns of the split nodes, and internal forces that stand are shared among their copies. */
static ShvStatus follow_split(ShvHybrid *hybrid, int32_t first_copy, ShvError *error)
{
    ShvState *state = &hybrid->state;
    const size_t most = 2 * (size_t)(state->node_count - first_copy);
    int32_t *nodes = shv_allocate(hybrid->memory, SHV_PART_STRESS, most, sizeof *nodes), count = 0;
    if (!nodes) return shv_fail_memory(error, "the nodes of an insertion", most * sizeof *nodes);
    for (int32_t copy = first_copy; copy < state->node_count; copy++) {
        const int32_t from = shv_state_split_from(state, copy);
        if (from < first_copy) nodes[count++] = from;
        nodes[count++] = copy;
    }
    ShvStatus status = shv_solid_split(&hybrid->solid, state, nodes, count, error);
    if (status == SHV_OK && hybrid->check.forces_begun)
        status = shv_solid_put_internal_force(&hybrid->solid, state, nodes, count, error);
    shv_release(nodes);
    return status;
}

static ShvStatus insert(ShvHybrid *hybrid, int32_t count, ShvError *error)
{
    double start = shv_now();
    int32_t duplicated = 0;
    SHV_TRY(shv_cohesive_insert(&hybrid->cohesive, &hybrid->state, hybrid->check.stress, hybrid->check.candidates,
                                count, &duplicated, error));
    hybrid->cohesive.worst_overshoot = fmax(hybrid->cohesive.worst_overshoot, hybrid->check.overstress[0]);
    SHV_TRY(note_insertions(hybrid, count, error));
    const int32_t first_copy = hybrid->state.node_count - duplicated;
    if (duplicated > 0) SHV_TRY(follow_split(hybrid, first_copy, error));
    start = shv_costs_add(&hybrid->costs, SHV_COST_INSERT, start);
    if (duplicated > 0) SHV_TRY(relabel_cracked(hybrid, first_copy, error));
    shv_costs_add(&hybrid->costs, SHV_COST_PARTS, start);
    return SHV_OK;
}

static ShvStatus find_inverted(ShvHybrid *hybrid, ShvError *error)
{
    int32_t first = -1;
    const int32_t inverted = shv_solid_inverted(&hybrid->solid, &hybrid->state, &first);
    if (inverted <= hybrid->steps.inverted) return SHV_OK;
    hybrid->steps.inverted = inverted;
    const ShvEventView event = {.time = hybrid->state.time,
                                .kind = SHV_RUN_INVERSION,
                                .obstacle = -1,
                                .value = first,
                                .fragment = hybrid->state.element_fragment[first]};
    return shv_hybrid_log(hybrid, &event, error);
}

static void count_quiet(ShvHybrid *hybrid)
{
    hybrid->check.since_rest++;
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (hybrid->awake.flags[i] && hybrid->fragments.items[i].last_insertion <= hybrid->state.time)
            hybrid->fragments.items[i].quiet++;
}

static ShvStatus check_nodes(ShvHybrid *hybrid, double *largest, int32_t *count, ShvError *error)
{
    const double start = shv_now();
    shv_solid_stress(&hybrid->solid, &hybrid->state, hybrid->check.stress);
    SHV_TRY(nodal_stress(hybrid, error));
    *largest = shv_cohesive_candidates(&hybrid->cohesive, &hybrid->state, hybrid->check.stress, hybrid->check.nodal,
                                       hybrid->check.candidates, hybrid->check.overstress, count);
    SHV_TRY(find_inverted(hybrid, error));
    shv_costs_add(&hybrid->costs, SHV_COST_STRESS, start);
    return SHV_OK;
}

static void fill_stress(void *context, const int32_t *batches, int32_t count)
{
    const ShvHybrid *hybrid = context;
    shv_solid_stress_of(&hybrid->solid, &hybrid->state, batches, count, hybrid->check.stress);
}

/* The internal forces of the step are found here: they know the stress as well, and where it is too low to matter. */
static ShvStatus check_facets(ShvHybrid *hybrid, double *largest, int32_t *count, ShvError *error)
{
    ShvState *state = &hybrid->state;
    ShvCohesive *cohesive = &hybrid->cohesive;
    const ShvStressSource source = {fill_stress, hybrid};
    double start = shv_now();
    shv_solid_smooth(&hybrid->solid, state);
    start = shv_costs_add(&hybrid->costs, SHV_COST_FORCE, start);
    const double floor = shv_cohesive_floor(cohesive, state, hybrid->check.stress, source);
    start = shv_costs_add(&hybrid->costs, SHV_COST_STRESS, start);
    shv_motion_clear_force(state, hybrid->awake.nodes, hybrid->awake.node_count, hybrid->model.threads);
    const bool inverted = shv_solid_add_internal_force_and_find_faces(&hybrid->solid, state, cohesive->face_weight,
                                                                      floor, cohesive->faces);
    hybrid->check.forces_begun = true;
    start = shv_costs_add(&hybrid->costs, SHV_COST_FORCE, start);
    if (inverted) SHV_TRY(find_inverted(hybrid, error));
    *largest = shv_cohesive_face_candidates(cohesive, state, hybrid->check.stress, source, hybrid->check.candidates,
                                            hybrid->check.overstress, count);
    shv_costs_add(&hybrid->costs, SHV_COST_STRESS, start);
    return SHV_OK;
}

/* Of neighbours one parts at a time, and what it leaves to the others is looked at again until nothing parts, at once: a crack cannot have
   unloaded anything yet, and what a check puts off depends on the step. */
static ShvStatus insert_neighbours(ShvHybrid *hybrid, ShvError *error)
{
    const ShvStressSource source = {fill_stress, hybrid};
    for (int32_t count = 1; count > 0;) {
        const double start = shv_now();
        shv_solid_smooth(&hybrid->solid, &hybrid->state);
        shv_cohesive_face_candidates(&hybrid->cohesive, &hybrid->state, hybrid->check.stress, source,
                                     hybrid->check.candidates, hybrid->check.overstress, &count);
        shv_costs_add(&hybrid->costs, SHV_COST_STRESS, start);
        if (count > 0) SHV_TRY(insert(hybrid, count, error));
    }
    return SHV_OK;
}

ShvStatus shv_hybrid_check(ShvHybrid *hybrid, ShvError *error)
{
    if (++hybrid->check.clock.since < hybrid->check.clock.due) return SHV_OK;
    count_quiet(hybrid);
    if (!hybrid->model.can_break) {
        set_clock(hybrid, 0.0);
        return find_inverted(hybrid, error);
    }
    int32_t count = 0;
    double largest = 0.0;
    if (hybrid->scene->fracture.criterion == SHV_CRITERION_PRINCIPAL)
        SHV_TRY(check_nodes(hybrid, &largest, &count, error));
    else
        SHV_TRY(check_facets(hybrid, &largest, &count, error));
    set_clock(hybrid, largest);
    if (count == 0) return SHV_OK;
    SHV_TRY(insert(hybrid, count, error));
    return hybrid->scene->fracture.criterion == SHV_CRITERION_FORCE ? insert_neighbours(hybrid, error) : SHV_OK;
}
