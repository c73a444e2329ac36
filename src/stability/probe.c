#include "stability/stability.h"

#include <string.h>

#include "base/random.h"

/* Strain rates and velocities at the start are this small against the speed of waves, so that what is seen is linear. */
static const double small = 1e-6;

/* What is judged here must not end the run: energies have no bound. */
static ShvStatus strip_scene(ShvProbe *probe, const ShvSceneDefinition *scene, double modulus, ShvError *error)
{
    const size_t count = (size_t)scene->material_count;
    probe->materials = shv_pool_take(&probe->pool, count, sizeof *probe->materials);
    if (!probe->materials) return shv_fail_memory(error, "materials", count * sizeof *probe->materials);
    for (size_t i = 0; i < count; i++) {
        probe->materials[i] = scene->materials[i];
        if (!isnan(modulus)) probe->materials[i].youngs_modulus = modulus;
    }
    probe->scene = *scene;
    probe->scene.materials = probe->materials;
    probe->scene.condition_count = probe->scene.obstacle_count = probe->scene.event_count = 0;
    memset(probe->scene.gravity, 0, sizeof probe->scene.gravity);
    probe->scene.rigid.engine = SHV_RIGID_ANALYTIC;
    probe->scene.fracture.enabled = false;
    probe->scene.fracture.stabiliser = SHV_STABILISER_BARS;
    probe->scene.fracture.energy_bound = 1e300;
    probe->scene.reference.law = SHV_REFERENCE_NONE;
    return SHV_OK;
}

static ShvStatus wake_all(ShvHybrid *hybrid, ShvError *error)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        hybrid->backend->functions->remove(hybrid->backend, i);
        SHV_TRY(shv_hybrid_wake(hybrid, &(ShvRigidContact){.fragment = i, .obstacle = -1, .other = -1}, error));
    }
    return shv_awake_refresh(hybrid, error);
}

static void draw_shake(ShvProbe *probe, uint64_t seed)
{
    ShvHybrid *hybrid = &probe->hybrid;
    ShvState *state = &hybrid->state;
    const int64_t count = 3 * (int64_t)state->node_count;
    for (int64_t i = 0; i < count; i++)
        state->velocity[i] = small * probe->bar_speed * (shv_random_uniform(seed, (uint64_t)i) - 0.5);
    memcpy(probe->shake, state->velocity, (size_t)count * sizeof(double));
    for (int32_t k = 0; k < hybrid->fragments.count; k++) {
        ShvFragment *fragment = &hybrid->fragments.items[k];
        shv_fragment_fit(fragment, &hybrid->fragments, state);
        for (int32_t n = 0; n < fragment->node_count; n++) {
            const int32_t node = hybrid->fragments.nodes[fragment->node_begin + n];
            const ShvVec3 rigid = shv_fragment_velocity(fragment, shv_state_position(state, node));
            double *v = probe->shake + 3 * (int64_t)node;
            shv_store3(v, shv_sub(shv_load3(v), rigid));
        }
    }
}

/* The longest axis is that of the least moment. */
static void shape_stretch(ShvProbe *probe)
{
    const ShvHybrid *hybrid = &probe->hybrid;
    const ShvFragment *fragment = &hybrid->fragments.items[0];
    double moments[3];
    ShvMat3 axes;
    shv_symmetric_eigen(&fragment->inertia, moments, &axes);
    probe->axis = shv_vec3(axes.m[0][0], axes.m[1][0], axes.m[2][0]);
    probe->length = 2.0 * fragment->radius;
    for (int32_t n = 0; n < fragment->node_count; n++) {
        const int64_t node = hybrid->fragments.nodes[fragment->node_begin + n];
        const ShvVec3 arm = shv_sub(shv_load3(hybrid->state.reference + 3 * node), fragment->reference_centre);
        const double along = shv_dot(probe->axis, arm);
        shv_store3(probe->stretch + 3 * node, shv_scale(probe->axis, along));
        probe->stretch_norm += hybrid->state.mass[node] * along * along;
    }
}

static ShvStatus make_fields(ShvProbe *probe, uint64_t seed, ShvError *error)
{
    const ShvModel *model = &probe->hybrid.model;
    const ShvMaterial *material = &model->materials[model->objects[0].material];
    const size_t count = 3 * (size_t)probe->hybrid.state.node_count;
    probe->modulus = material->youngs_modulus;
    probe->bar_speed = material->bar_speed;
    probe->shake = shv_pool_take(&probe->pool, count, sizeof(double));
    probe->stretch = shv_pool_take(&probe->pool, count, sizeof(double));
    probe->before = shv_pool_take(&probe->pool, count, sizeof(double));
    if (probe->pool.failed) return shv_fail_memory(error, "velocities", 3 * count * sizeof(double));
    draw_shake(probe, seed);
    shape_stretch(probe);
    return SHV_OK;
}

ShvStatus shv_probe_create(ShvProbe *probe, const ShvSceneDefinition *scene, const ShvStabilityOptions *options,
                           double modulus, ShvError *error)
{
    *probe = (ShvProbe){.pool = {.memory = options->memory}};
    SHV_TRY(strip_scene(probe, scene, modulus, error));
    SHV_TRY(shv_hybrid_create(&probe->hybrid, options->memory, &probe->scene, options->folder, error));
    SHV_TRY(wake_all(&probe->hybrid, error));
    return make_fields(probe, options->seed, error);
}

void shv_probe_release(ShvProbe *probe)
{
    if (probe->hybrid.scene) shv_hybrid_release(&probe->hybrid);
    shv_release(probe->reference.q);
    shv_pool_release(&probe->pool);
}

void shv_probe_restart(ShvProbe *probe, const double *velocities, double scale, double stiffness, int32_t iterations)
{
    ShvState *state = &probe->hybrid.state;
    const int64_t count = 3 * (int64_t)state->node_count;
    memset(state->displacement, 0, (size_t)count * sizeof(double));
    for (int64_t i = 0; i < count; i++) state->velocity[i] = velocities ? scale * velocities[i] : 0.0;
    state->time = state->last_step = 0.0;
    probe->hybrid.obstacle_time = 0.0;
    memset(&probe->hybrid.observer.ledger, 0, sizeof probe->hybrid.observer.ledger);
    probe->scene.pbd.stiffness = iterations > 0 ? stiffness : 0.0;
    probe->scene.pbd.iterations = iterations > 0 ? iterations : 1;
}

ShvStatus shv_probe_step(ShvProbe *probe, double step)
{
    ShvError ignored; /* what fails here is a step that is too long */
    probe->scene.fracture.time_step = step;
    probe->hybrid.observer.steps_since = 0;
    return shv_hybrid_substep(&probe->hybrid, step, &ignored);
}

double shv_probe_energy(const ShvProbe *probe)
{
    const ShvState *state = &probe->hybrid.state;
    double sum = shv_solid_strain_energy(&probe->hybrid.solid, state);
    for (int32_t i = 0; i < state->node_count; i++) {
        const ShvVec3 v = shv_load3(state->velocity + 3 * (int64_t)i);
        sum += 0.5 * state->mass[i] * shv_dot(v, v);
    }
    return sum;
}

double shv_probe_elongation(const ShvProbe *probe)
{
    const ShvState *state = &probe->hybrid.state;
    double sum = 0.0;
    for (int64_t i = 0; i < state->node_count; i++)
        sum += state->mass[i] * shv_dot(shv_load3(state->displacement + 3 * i), shv_load3(probe->stretch + 3 * i));
    return sum / probe->stretch_norm;
}

void shv_probe_push(ShvProbe *probe, double rate, double keep)
{
    ShvState *state = &probe->hybrid.state;
    for (int64_t i = 0; i < 3 * (int64_t)state->node_count; i++)
        state->velocity[i] = keep * state->velocity[i] + rate * probe->stretch[i];
}
