#include "coupling/hybrid.h"

#include <string.h>

/* Share of the stable step that a message recommends. */
static const double recommended_share = 0.9;

/* A step the user asks for must be stable for every element: nothing here damps an unstable mode. */
static ShvStatus require_stable(ShvHybrid *hybrid, ShvError *error)
{
    const ShvFractureDefinition *fracture = &hybrid->scene->fracture;
    hybrid->steps.strained = HUGE_VAL;
    hybrid->steps.stable = shv_solid_stable_step(&hybrid->solid, &hybrid->steps.stable_element);
    const double stable = hybrid->steps.stable;
    if (hybrid->stabiliser.active || isnan(fracture->time_step) || fracture->time_step <= stable) return SHV_OK;
    return shv_fail(
        error, SHV_BAD_INPUT,
        "fracture.time_step %g s is %.3g times the stable step %g s (set by tet %d, safe for every element); "
        "give %g or less, or 'auto'",
        fracture->time_step, fracture->time_step / stable, stable, (int)hybrid->steps.stable_element,
        recommended_share * stable);
}

static ShvStatus create_fracture(ShvHybrid *hybrid, ShvError *error)
{
    const size_t slots = (size_t)hybrid->state.batch_count * 6 * SHV_LANES;
    const size_t facets = (size_t)hybrid->model.adjacency.interior_count;
    SHV_TRY(shv_cohesive_create(&hybrid->cohesive, &hybrid->model, &hybrid->scene->fracture, error));
    hybrid->check.stress = shv_allocate(hybrid->memory, SHV_PART_STRESS, slots, sizeof(double));
    hybrid->check.candidates = shv_allocate(hybrid->memory, SHV_PART_STRESS, facets, sizeof(int32_t));
    hybrid->check.overstress = shv_allocate(hybrid->memory, SHV_PART_STRESS, facets, sizeof(double));
    if (!hybrid->check.stress || !hybrid->check.candidates || !hybrid->check.overstress)
        return shv_fail_memory(error, "the insertion criterion", slots * sizeof(double) + facets * 12);
    return SHV_OK;
}

/* A rigid body cannot carry a motion that stretches it. */
static bool starts_stretching(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const double *rate = hybrid->scene->objects[fragment->object].placement.stretch_rate;
    return fabs(rate[0]) + fabs(rate[1]) + fabs(rate[2]) > 0.0;
}

static ShvStatus start_fragments(ShvHybrid *hybrid, ShvError *error)
{
    ShvFragments *fragments = &hybrid->fragments;
    for (int32_t i = 0; i < fragments->count; i++) {
        ShvFragment *fragment = &fragments->items[i];
        double bending;
        fragment->strength =
            hybrid->model.can_break
                ? shv_cohesive_weakest(&hybrid->cohesive, fragments->elements + fragment->element_begin,
                                       fragment->element_count)
                : HUGE_VAL;
        fragment->last_insertion = hybrid->state.time;
        shv_hybrid_transit_times(hybrid, fragment, &fragment->woken_transit, &bending);
        shv_hybrid_begin_growth(hybrid, fragment);
        fragment->fixed = shv_hybrid_starts_fixed(hybrid, fragment);
        if (starts_stretching(hybrid, fragment) || (shv_hybrid_is_held(hybrid, fragment) && !fragment->fixed)) {
            fragment->mode = SHV_MODE_FRACTURE;
        } else if (hybrid->scene->objects[fragment->object].waits) {
            shv_fragment_fit(fragment, fragments, &hybrid->state);
            fragment->mode = SHV_MODE_BINNED;
        } else {
            shv_fragment_fit(fragment, fragments, &hybrid->state);
            fragment->mode = SHV_MODE_FLIGHT;
            SHV_TRY(hybrid->backend->functions->add(hybrid->backend, i, error));
        }
    }
    hybrid->awake.stale = true;
    return shv_awake_refresh(hybrid, error);
}

/* Whether anything may be in fracture mode. */
static bool may_deform(const ShvHybrid *hybrid)
{
    const ShvSceneDefinition *scene = hybrid->scene;
    bool any = hybrid->model.can_break || scene->rigid.wake == SHV_WAKE_CONTACT || scene->condition_count > 0;
    for (int32_t i = 0; i < hybrid->fragments.count && !any; i++)
        any = starts_stretching(hybrid, &hybrid->fragments.items[i]);
    return any;
}

/* Where nothing can meet anything, Bullet is left out. */
static ShvStatus create_backend(ShvHybrid *hybrid, const ShvRigidWorld *world, ShvError *error)
{
    const ShvSceneDefinition *scene = hybrid->scene;
    const bool contact = scene->obstacle_count > 0 || hybrid->fragments.count > 1 || hybrid->model.can_break;
    if (scene->rigid.engine == SHV_RIGID_PBD) return shv_pbd_create(&hybrid->backend, world, &scene->pbd, error);
    const bool handed_over = may_deform(hybrid);
    if (scene->rigid.engine == SHV_RIGID_BULLET_PLAIN) {
        SHV_TRY(shv_bullet_plain_create(&hybrid->backend, world, &scene->bullet_plain, error));
        hybrid->backend->leaves_obstacles = handed_over;
        return SHV_OK;
    }
    if (scene->rigid.engine == SHV_RIGID_BULLET && contact) {
        hybrid->coupling.mutual = true;
        SHV_TRY(shv_bullet_create(&hybrid->backend, world, error));
        /* Who wakes in mid-step must find free obstacles where they are at that time. */
        hybrid->backend->leaves_obstacles = handed_over;
        return SHV_OK;
    }
    return shv_analytic_create(&hybrid->backend, world, error);
}

static ShvStatus create_parts(ShvHybrid *hybrid, const char *folder, ShvError *error)
{
    const ShvSceneDefinition *scene = hybrid->scene;
    SHV_TRY(shv_model_build(&hybrid->model, hybrid->memory, scene, folder, error));
    hybrid->damping.active = hybrid->model.can_break;
    for (int32_t i = 0; i < hybrid->model.material_count; i++)
        hybrid->damping.active = hybrid->damping.active || hybrid->model.materials[i].loss_factor > 0.0;
    SHV_TRY(shv_state_create(&hybrid->state, &hybrid->model, scene, error));
    SHV_TRY(shv_solid_create(&hybrid->solid, &hybrid->model, &hybrid->state, error));
    SHV_TRY(require_stable(hybrid, error));
    if (hybrid->model.can_break) SHV_TRY(create_fracture(hybrid, error));
    SHV_TRY(shv_obstacles_create(&hybrid->obstacles, hybrid->memory, scene, folder, error));
    const size_t obstacles = (size_t)hybrid->obstacles.count;
    hybrid->observer.ghost.obstacles = shv_allocate(hybrid->memory, SHV_PART_SHAPE, obstacles, sizeof(ShvObstacle));
    if (obstacles > 0 && !hybrid->observer.ghost.obstacles)
        return shv_fail_memory(error, "obstacles at a time", obstacles * sizeof(ShvObstacle));
    SHV_TRY(shv_imposed_create(&hybrid->imposed, &hybrid->model, scene, error));
    SHV_TRY(shv_fragments_create(&hybrid->fragments, &hybrid->model, &hybrid->state, error));
    if (hybrid->model.can_break && scene->fracture.connectivity == SHV_CONNECTIVITY_BONDS)
        hybrid->fragments.bonds = &hybrid->cohesive;
    const ShvRigidWorld world = {&hybrid->model, &hybrid->state, &hybrid->fragments, &hybrid->obstacles, &scene->rigid};
    if (hybrid->stabiliser.active) SHV_TRY(shv_hybrid_create_bars(hybrid, error));
    SHV_TRY(create_backend(hybrid, &world, error));
    SHV_TRY(shv_surface_contact_create(&hybrid->coupling.surface, hybrid->memory, &hybrid->model, scene->rigid.friction,
                                       error));
    SHV_TRY(shv_probes_create(&hybrid->probes, &hybrid->model, scene, &hybrid->obstacles, &hybrid->state, error));
    SHV_TRY(shv_hybrid_let_wait(hybrid, error));
    return start_fragments(hybrid, error);
}

ShvStatus shv_hybrid_create(ShvHybrid *hybrid, ShvMemory *memory, const ShvSceneDefinition *scene, const char *folder,
                            ShvError *error)
{
    *hybrid = (ShvHybrid){.memory = memory, .scene = scene};
    memcpy(hybrid->gravity, scene->gravity, sizeof hybrid->gravity);
    hybrid->stabiliser.active = scene->fracture.stabiliser == SHV_STABILISER_BARS;
    shv_check_clock_start(&hybrid->check.clock);
    ShvStatus status = create_parts(hybrid, folder, error);
    if (status == SHV_OK) status = shv_hybrid_observe(hybrid, error);
    if (status != SHV_OK) shv_hybrid_release(hybrid);
    return status;
}

void shv_hybrid_release(ShvHybrid *hybrid)
{
    if (hybrid->backend) hybrid->backend->functions->destroy(hybrid->backend);
    if (hybrid->stabiliser.active) shv_relax_release(&hybrid->stabiliser.relax);
    if (hybrid->stabiliser.active) shv_bars_release(&hybrid->stabiliser.bars);
    shv_fragments_release(&hybrid->fragments);
    shv_imposed_release(&hybrid->imposed);
    shv_probes_release(&hybrid->probes);
    shv_surface_contact_release(&hybrid->coupling.surface);
    shv_coupled_bodies_release(hybrid);
    shv_obstacles_release(&hybrid->obstacles);
    if (hybrid->model.can_break) shv_cohesive_release(&hybrid->cohesive);
    shv_solid_release(&hybrid->solid);
    shv_state_release(&hybrid->state);
    shv_model_release(&hybrid->model);
    shv_release(hybrid->waiting);
    shv_release(hybrid->awake.flags);
    shv_release(hybrid->awake.nodes);
    shv_release(hybrid->wakes.items);
    shv_release(hybrid->check.stress);
    shv_release(hybrid->check.nodal);
    shv_release(hybrid->check.candidates);
    shv_release(hybrid->check.overstress);
    shv_release(hybrid->stabiliser.fixed);
    shv_release(hybrid->damping.force);
    shv_release(hybrid->observer.ghost.before);
    shv_release(hybrid->observer.ghost.displacement);
    shv_release(hybrid->observer.ghost.obstacles);
    shv_release(hybrid->log.items);
    memset(hybrid, 0, sizeof *hybrid);
}
