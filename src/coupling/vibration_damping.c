/* Internal friction of the material. A loss factor η takes the share 2π η of a vibration's energy in each of its periods. Every
   fragment's velocities beside its rigid motion are damped at the rate η ω of its slowest mode, which so loses what it should; faster
   modes lose less than they should, by the ratio of the frequencies (docs/decisions.md). It is damping proportional to mass (the α of
   Rayleigh's two terms), but flight and turning of the fragment are left alone, momentum and angular momentum with them, and it does
   not limit the step, which damping by stiffness would. */
#include "coupling/hybrid.h"

#include "base/deterministic.h"
#include "pbd/damping.h"

/* A fragment is damped every so many steps, a power of two, for all of them: its rigid motion costs some 58 ns a node. More often than
   eight times in half a period of its slowest mode, so that shards of a few tets are damped in every step. */
enum { LONGEST_INTERVAL = 16 };
static const double per_transit = 8.0;

/* Crumbs: pieces of one or two tets, isolated elements. In a body a wave of the shortest length leaves its tet; in these it stays, and where the step is
   about √3/ω, 0.866 of their stable one, the cubic term of Green strain's energy feeds it: central difference's resonance of third order
   (docs/decisions.md), which pieces of four tets hardly have. It grows in proportion to the strain, and so do they fade
   where their step is that near to the stable one: by this share a step and unit of strain, of which half is enough. */
enum { CRUMB = 2 };
static const double crumb_rate = 8.0, largest_crumb_share = 0.3, near_resonance = 0.75;

/* Half a period of the slowest mode, s: that of a bar or beam of the fragment's inertia, or that in which a square plate as wide as
   it is, and as thick as its walls, twists (f = √(G/E) c₀ t/b²), which is near that of tubes and vessels too. 2V/S is the thickness of
   a wall. */
static double slowest_transit(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    double bar, bending;
    shv_hybrid_transit_times(hybrid, fragment, &bar, &bending);
    const ShvMaterial *material = &hybrid->model.materials[hybrid->model.objects[fragment->object].material];
    const double width = fragment->sides[1], thickness = 2.0 * fragment->volume / fragment->surface;
    return fmax(bending, 0.5 * width * width / (material->shear_speed * thickness));
}

static bool is_crumb(const ShvFragment *fragment)
{
    return fragment->element_count <= CRUMB;
}

/* In steps of the length of `step`, the one to come. */
static int interval_of(const ShvHybrid *hybrid, const ShvFragment *fragment, double step)
{
    if (is_crumb(fragment)) return 1;
    const double transit = slowest_transit(hybrid, fragment);
    int interval = LONGEST_INTERVAL;
    while (interval > 1 && interval * step * per_transit > transit) interval /= 2;
    return interval;
}

static bool is_due(const ShvHybrid *hybrid, int32_t index, double step)
{
    const ShvFragment *fragment = &hybrid->fragments.items[index];
    return hybrid->awake.flags[index] && (fragment->loss_factor > 0.0 || is_crumb(fragment)) &&
           hybrid->state.step % interval_of(hybrid, fragment, step) == 0;
}

/* The length of the Green strain of a crumb's element, or a little more: from µ |E|² + λ/2 (tr E)², its energy by volume. Its edges are the
   crumb's alone. */
static double strain_of(const ShvHybrid *hybrid, int32_t element, const ShvMaterial *material)
{
    const double volume = hybrid->state.element_mass[element] / material->density;
    return sqrt(shv_solid_energy_of(&hybrid->solid, &hybrid->state, &element, 1) / (material->mu * volume));
}

/* At least `least`. What costs most is asked last. */
static double crumb_share(const ShvHybrid *hybrid, const ShvFragment *fragment, double kick, double least)
{
    double share = least;
    for (int32_t i = 0; i < fragment->element_count; i++) {
        const int32_t element = hybrid->fragments.elements[fragment->element_begin + i];
        const ShvMaterial *material = shv_model_material(&hybrid->model, element);
        if (material->kinematics != SHV_GREEN_STRAIN) continue;
        if (kick < near_resonance * shv_solid_safe_step(&hybrid->solid, element)) continue; /* the smaller one */
        const double faded = fmin(crumb_rate * strain_of(hybrid, element, material), largest_crumb_share);
        if (!(faded > share) || kick < near_resonance * shv_solid_exact_step(&hybrid->solid, element)) continue;
        share = faded;
    }
    return share;
}

/* Of the velocities beside the rigid motion, what goes in a step. */
static double lost_share(const ShvHybrid *hybrid, const ShvFragment *fragment, double kick, double step)
{
    const double rate = fragment->loss_factor * SHV_PI / slowest_transit(hybrid, fragment);
    const double share = 1.0 - shv_exp(-rate * interval_of(hybrid, fragment, step) * kick);
    return is_crumb(fragment) ? crumb_share(hybrid, fragment, kick, share) : share;
}

static ShvStatus reserve(ShvHybrid *hybrid, ShvError *error)
{
    ShvVibrationDamping *damping = &hybrid->damping;
    if (damping->capacity >= hybrid->state.node_capacity) return SHV_OK;
    const size_t count = (size_t)hybrid->state.node_capacity;
    SHV_RESIZE(hybrid->memory, SHV_PART_STATE, damping->force, count, "damping forces", count * sizeof(ShvVec3), error);
    damping->capacity = hybrid->state.node_capacity;
    return SHV_OK;
}

/* Velocities are those of n − 1/2. */
static void add_force(ShvHybrid *hybrid, const ShvFragment *fragment, double before, double after)
{
    ShvState *state = &hybrid->state;
    const int32_t *nodes = hybrid->fragments.nodes + fragment->node_begin;
    const double kick = 0.5 * (before + after), share = lost_share(hybrid, fragment, kick, after);
    const ShvRigidField rigid = shv_rigid_field(state, nodes, fragment->node_count);
    for (int32_t i = 0; i < fragment->node_count; i++) {
        const int64_t node = nodes[i];
        const ShvVec3 arm = shv_sub(shv_state_position(state, nodes[i]), rigid.centre);
        const ShvVec3 whole = shv_add(rigid.velocity, shv_cross(rigid.angular_velocity, arm));
        const ShvVec3 beside = shv_sub(shv_load3(state->velocity + 3 * node), whole);
        hybrid->damping.force[node] = shv_scale(beside, -share * state->mass[node] / kick);
        shv_add_to3(state->force + 3 * node, hybrid->damping.force[node]);
    }
}

/* Σ F·v × `step`/2: half of the work, before or after the kick. */
static double half_work(const ShvHybrid *hybrid, const ShvFragment *fragment, double step)
{
    const int32_t *nodes = hybrid->fragments.nodes + fragment->node_begin;
    double power = 0.0;
    for (int32_t i = 0; i < fragment->node_count; i++)
        power += shv_dot(hybrid->damping.force[nodes[i]], shv_load3(hybrid->state.velocity + 3 * (int64_t)nodes[i]));
    return 0.5 * power * step;
}

ShvStatus shv_vibration_damping_add_force(ShvHybrid *hybrid, double before, double after, ShvError *error)
{
    if (!hybrid->damping.active) return SHV_OK;
    SHV_TRY(reserve(hybrid, error));
    hybrid->damping.first_half = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        if (!is_due(hybrid, i, after)) continue;
        add_force(hybrid, &hybrid->fragments.items[i], before, after);
        hybrid->damping.first_half += half_work(hybrid, &hybrid->fragments.items[i], before);
    }
    return SHV_OK;
}

void shv_vibration_damping_book(ShvHybrid *hybrid, double after)
{
    if (!hybrid->damping.active) return;
    double second_half = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (is_due(hybrid, i, after)) second_half += half_work(hybrid, &hybrid->fragments.items[i], after);
    shv_ledger_book(&hybrid->observer.ledger, SHV_WORK_DAMPING, hybrid->damping.first_half, second_half);
}
