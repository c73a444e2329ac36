/* The state at one time. Velocities live at half steps; what they are at time n follows from a step of the same length
   as the last that is made but not taken ("ghost"): kinetic energy is Σ ½ m v₋·v₊, momentum that of the mean. */
#include "coupling/hybrid.h"

#include <stdio.h>
#include <string.h>

static ShvStatus reserve_ghost(ShvHybrid *hybrid, ShvError *error)
{
    ShvGhost *ghost = &hybrid->observer.ghost;
    if (ghost->capacity < hybrid->state.node_capacity) {
        const size_t count = 3 * (size_t)hybrid->state.node_capacity;
        SHV_RESIZE(hybrid->memory, SHV_PART_STATE, ghost->before, count, "velocities around a time",
                   count * sizeof(double), error);
        if (hybrid->stabiliser.active)
            SHV_RESIZE(hybrid->memory, SHV_PART_STATE, ghost->displacement, count, "displacements at a time",
                       count * sizeof(double), error);
        ghost->capacity = hybrid->state.node_capacity;
    }
    return SHV_OK;
}

static void copy_obstacles(ShvHybrid *hybrid)
{
    const size_t bytes = (size_t)hybrid->obstacles.count * sizeof(ShvObstacle);
    if (bytes > 0) memcpy(hybrid->observer.ghost.obstacles, hybrid->obstacles.items, bytes);
}

/* Takes the ghost step back: velocities of this time are the means, for free obstacles as for nodes. */
static void synchronise_obstacles(ShvHybrid *hybrid)
{
    ShvGhost *ghost = &hybrid->observer.ghost;
    for (int32_t i = 0; i < hybrid->obstacles.count; i++) {
        ShvObstacle *seen = &ghost->obstacles[i], *item = &hybrid->obstacles.items[i];
        const ShvObstacle before = *seen;
        seen->velocity = shv_scale(shv_add(before.velocity, item->velocity), 0.5);
        seen->angular_velocity = shv_scale(shv_add(before.angular_velocity, item->angular_velocity), 0.5);
        *item = before;
    }
    /* As it is booked: impulses act one after another, so that velocities before and after the step do not tell. */
    ghost->obstacle_exchange = hybrid->coupling.surface.obstacle_work[0];
    if (hybrid->stabiliser.active) ghost->obstacle_exchange += 0.5 * hybrid->stabiliser.relax.obstacle_work;
}

/* Velocities as they are now, beside which others are to come. */
static ShvStatus keep_velocities(ShvHybrid *hybrid, ShvError *error)
{
    SHV_TRY(reserve_ghost(hybrid, error));
    memcpy(hybrid->observer.ghost.before, hybrid->state.velocity,
           3 * (size_t)hybrid->state.node_count * sizeof(double));
    return SHV_OK;
}

/* Puts the mean of the velocities before and after a ghost step into state.velocity and keeps the earlier ones in
   ghost.before; first halves of works go to ghost.first; kinetic energy of awake nodes to ghost.kinetic. */
ShvStatus shv_hybrid_synchronise(ShvHybrid *hybrid, ShvError *error)
{
    ShvState *state = &hybrid->state;
    ShvGhost *ghost = &hybrid->observer.ghost;
    SHV_TRY(keep_velocities(hybrid, error));
    shv_coupled_bodies_keep(hybrid);
    memset(ghost->first, 0, sizeof ghost->first);
    ghost->obstacle_exchange = 0.0;
    copy_obstacles(hybrid);
    if (state->last_step > 0.0) {
        const size_t moved = hybrid->stabiliser.active ? 3 * (size_t)state->node_count * sizeof(double) : 0;
        if (moved > 0) memcpy(ghost->displacement, state->displacement, moved);
        const ShvLedger booked = hybrid->observer.ledger;
        SHV_TRY(shv_hybrid_forces(hybrid, error));
        SHV_TRY(shv_hybrid_kick(hybrid, state->last_step, state->last_step, error));
        for (int i = 0; i < SHV_WORK_COUNT; i++)
            ghost->first[i] = hybrid->observer.ledger.booked[i] - booked.booked[i] - hybrid->observer.ledger.pending[i];
        hybrid->observer.ledger = booked;
        if (moved > 0) memcpy(state->displacement, ghost->displacement, moved);
        synchronise_obstacles(hybrid);
    }
    ghost->kinetic = shv_coupled_bodies_put_back(hybrid);
    for (int32_t k = 0; k < hybrid->awake.node_count; k++) {
        const int64_t node = hybrid->awake.nodes[k];
        const ShvVec3 before = shv_load3(ghost->before + 3 * node), after = shv_load3(state->velocity + 3 * node);
        ghost->kinetic += 0.5 * state->mass[node] * shv_dot(before, after);
        shv_store3(state->velocity + 3 * node, shv_scale(shv_add(before, after), 0.5));
    }
    return SHV_OK;
}

ShvStatus shv_hybrid_velocities_without_impulses(ShvHybrid *hybrid, ShvError *error)
{
    ShvState *state = &hybrid->state;
    SHV_TRY(keep_velocities(hybrid, error));
    const double half = 0.5 * state->last_step;
    if (half == 0.0) return SHV_OK;
    SHV_TRY(shv_hybrid_forces(hybrid, error));
    shv_motion_kick(state, hybrid->awake.nodes, hybrid->awake.node_count, half, hybrid->gravity, hybrid->model.threads);
    return SHV_OK;
}

/* A step counts as another one when it differs by more than this share: less is rounding of quotients. */
static const double another_step = 1e-9;

static bool changes(const ShvHybrid *hybrid, double before, double after)
{
    return fabs(after - before) > another_step * after && !hybrid->stabiliser.active;
}

ShvStatus shv_hybrid_begin_step_change(ShvHybrid *hybrid, double before, double after, ShvError *error)
{
    return changes(hybrid, before, after) ? keep_velocities(hybrid, error) : SHV_OK;
}

void shv_hybrid_book_step_change(ShvHybrid *hybrid, double before, double after)
{
    if (!changes(hybrid, before, after)) return;
    const ShvState *state = &hybrid->state;
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    double sum = 0.0;
    for (int32_t k = 0; k < hybrid->awake.node_count; k++) {
        const int64_t i = 3 * (int64_t)hybrid->awake.nodes[k];
        const ShvVec3 force = shv_madd(shv_load3(state->force + i), state->mass[i / 3], gravity);
        sum += shv_dot(force, shv_sub(shv_load3(state->velocity + i), shv_load3(hybrid->observer.ghost.before + i)));
    }
    shv_ledger_book(&hybrid->observer.ledger, SHV_WORK_STEP_CHANGE, -0.25 * (after - before) * sum, 0.0);
}

void shv_hybrid_resume(ShvHybrid *hybrid)
{
    memcpy(hybrid->state.velocity, hybrid->observer.ghost.before,
           3 * (size_t)hybrid->state.node_count * sizeof(double));
}

static void add_awake(const ShvHybrid *hybrid, ShvLedgerView *balance)
{
    const ShvState *state = &hybrid->state;
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    balance->kinetic += hybrid->observer.ghost.kinetic + hybrid->observer.ghost.obstacle_exchange;
    for (int32_t k = 0; k < hybrid->awake.node_count; k++) {
        const int32_t node = hybrid->awake.nodes[k];
        const ShvVec3 x = shv_state_position(state, node);
        const ShvVec3 momentum = shv_scale(shv_load3(state->velocity + 3 * (int64_t)node), state->mass[node]);
        balance->gravity_potential -= state->mass[node] * shv_dot(gravity, x);
        shv_add_to3(balance->momentum, momentum);
        shv_add_to3(balance->angular_momentum, shv_cross(x, momentum));
    }
    balance->strain += shv_solid_strain_energy(&hybrid->solid, state);
}

/* Strain that a deformed fragment keeps in flight; what of it lies in batches with awake elements has been counted. Nodes that
   fly on their own, led by bars, have given theirs back when they went to rest and get another, or none, when they wake. */
static void add_kept_strain(const ShvHybrid *hybrid, ShvLedgerView *balance, const ShvFragment *fragment)
{
    if (!fragment->deformed && !hybrid->backend->keeps_nodes) return;
    if (fragment->deformed) balance->strain += fragment->strain;
    for (int32_t k = 0; k < fragment->element_count && hybrid->awake.count > 0; k++) {
        const int32_t element = hybrid->fragments.elements[fragment->element_begin + k];
        if (hybrid->solid.batch_active[element / SHV_LANES])
            balance->strain -= shv_solid_element_energy(&hybrid->solid, &hybrid->state, element);
    }
}

/* Whatever is not awake. */
static void add_fragment(const ShvHybrid *hybrid, ShvLedgerView *balance, const ShvFragment *fragment)
{
    double momentum[3], angular[3];
    if (fragment->mode != SHV_MODE_BINNED && fragment->mode != SHV_MODE_FLIGHT) return;
    balance->gravity_potential -= fragment->mass * shv_dot(shv_load3(hybrid->gravity), fragment->position);
    if (fragment->mode == SHV_MODE_BINNED) return;
    if (!fragment->coupled) balance->kinetic += shv_hybrid_kinetic_in_flight(hybrid, fragment);
    if (hybrid->backend->keeps_nodes)
        shv_audit_nodes(hybrid, fragment, momentum, angular, NULL);
    else
        shv_audit_rigid(fragment, momentum, angular);
    shv_add_to3(balance->momentum, shv_load3(momentum));
    shv_add_to3(balance->angular_momentum, shv_load3(angular));
    add_kept_strain(hybrid, balance, fragment);
}

static void add_obstacle(const ShvHybrid *hybrid, ShvLedgerView *balance, int32_t index)
{
    const ShvObstacle *obstacle = &hybrid->obstacles.items[index], *seen = &hybrid->observer.ghost.obstacles[index];
    if (obstacle->motion != SHV_OBSTACLE_FREE || shv_hybrid_waits(hybrid, index)) return;
    balance->kinetic += shv_obstacle_kinetic(obstacle);
    balance->gravity_potential -= obstacle->mass * shv_dot(shv_load3(hybrid->gravity), obstacle->position);
    shv_add_to3(balance->momentum, shv_scale(seen->velocity, seen->mass));
    shv_add_to3(balance->angular_momentum, shv_obstacle_angular_momentum(seen)); /* about the origin already */
}

static void add_works(ShvHybrid *hybrid, ShvLedgerView *balance)
{
    double *booked = hybrid->observer.ledger.booked;
    booked[SHV_WORK_CONTACT] += hybrid->backend->contact_work - hybrid->observer.backend_contact;
    booked[SHV_WORK_FRICTION] += hybrid->backend->friction_work - hybrid->observer.backend_friction;
    hybrid->observer.backend_contact = hybrid->backend->contact_work;
    hybrid->observer.backend_friction = hybrid->backend->friction_work;
    booked[SHV_WORK_BARS] += hybrid->backend->bars_work - hybrid->observer.backend_bars;
    booked[SHV_WORK_DAMPING] += hybrid->backend->damping_work - hybrid->observer.backend_damping;
    hybrid->observer.backend_bars = hybrid->backend->bars_work;
    hybrid->observer.backend_damping = hybrid->backend->damping_work;
    double work[SHV_WORK_COUNT];
    for (int i = 0; i < SHV_WORK_COUNT; i++) work[i] = booked[i] + hybrid->observer.ghost.first[i];
    balance->cohesive = work[SHV_WORK_COHESIVE];
    balance->cohesive_released = hybrid->observer.ledger.released;
#define WORK(member, name) balance->member = work[SHV_WORK_##name];
#define NO_WORK(member, unit)
    SHV_LEDGER_COLUMNS(NO_WORK, WORK, NO_WORK)
#undef WORK
}

static void add_cohesive(ShvHybrid *hybrid, ShvLedgerView *balance)
{
    if (!hybrid->model.can_break) return;
    const ShvCohesiveEnergy energy = shv_cohesive_energy(&hybrid->cohesive, &hybrid->state);
    hybrid->observer.cohesive_energy = energy;
    balance->cohesive_recoverable = energy.recoverable;
    balance->fracture_dissipation = energy.dissipated;
    balance->inserted_area = energy.inserted_area;
    balance->failed_area = energy.failed_area;
    balance->fracture_energy_area = energy.failed_energy;
}

static double given_work(const ShvLedgerView *b)
{
    double sum = b->cohesive;
#define WORK(member, name) sum += b->member;
    SHV_LEDGER_COLUMNS(NO_WORK, WORK, NO_WORK)
#undef WORK
#undef NO_WORK
    return sum;
}

static void close_balance(ShvHybrid *hybrid, ShvLedgerView *b)
{
    const double energy = b->kinetic + b->strain + b->gravity_potential;
    if (!hybrid->observer.started) {
        hybrid->observer.start_energy = energy;
        hybrid->observer.start_potential = b->gravity_potential;
        hybrid->observer.started = true;
    }
    b->residual = energy - hybrid->observer.start_energy - given_work(b);
    b->cohesive_defect = b->cohesive + b->cohesive_recoverable + b->cohesive_released + b->fracture_dissipation;
    const double sizes[] = {b->kinetic,
                            b->strain,
                            fabs(b->gravity_potential - hybrid->observer.start_potential),
                            fabs(b->contact),
                            fabs(b->constraint),
                            fabs(b->traction),
                            b->fracture_dissipation};
    b->largest = hybrid->observer.balance.largest;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) b->largest = fmax(b->largest, sizes[i]);
}

/* First awake node whose motion is not finite, seen through an element that owns it. */
static int32_t first_lost_element(const ShvHybrid *hybrid)
{
    const ShvState *state = &hybrid->state;
    for (int32_t e = 0; e < state->element_count; e++)
        for (int32_t a = 0; a < 4; a++) {
            const int64_t i = 3 * (int64_t)shv_state_node(state, e, a);
            if (!shv_finite3(shv_load3(state->displacement + i)) || !shv_finite3(shv_load3(state->velocity + i)))
                return e;
        }
    return -1;
}

/* Of the sum of potentials: its rounding over many bodies and frames. */
static const double rounding_of_sum = 1e-12;

/* Rounding of the potentials from which the balance is summed, J: what a body at rest, whose energies are nothing but rounding,
   may be off by. */
static double rounding_of_balance(const ShvHybrid *hybrid)
{
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    double size = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_DEAD) size += fragment->mass * fabs(shv_dot(gravity, fragment->position));
    }
    return rounding_of_sum * (size + fabs(hybrid->observer.start_energy));
}

/* By closing faces, what they hold still counted as theirs to give, J: it never rises. */
static double given_by_closing(const ShvHybrid *hybrid, const ShvLedgerView *balance)
{
    return balance->closure + hybrid->observer.cohesive_energy.held;
}

/* Of contacts and of closing faces, pushes and friction together: no impulse of either gives kinetic energy, but what each of them does to
   the others' pairs is booked there, so that of the two alone one may rise. */
static double contact_work(const ShvHybrid *hybrid, const ShvLedgerView *balance)
{
    return balance->contact + balance->friction + balance->crack_friction + given_by_closing(hybrid, balance);
}

/* What contacts have given since they had taken most, J. They take energy or leave it, unless obstacles are driven or overlaps are
   the scene's; a balance cannot tell, since all that they do is booked. */
static double contact_gain(const ShvHybrid *hybrid)
{
    const ShvLedgerView *b = &hybrid->observer.balance;
    if (hybrid->scene->overlaps == SHV_OVERLAPS_KEEP) return 0.0;
    for (int32_t i = 0; i < hybrid->obstacles.count; i++)
        if (hybrid->obstacles.items[i].motion == SHV_OBSTACLE_SCRIPTED) return 0.0;
    return contact_work(hybrid, b) - hybrid->observer.least_contact_work;
}

/* What it takes to lift every body by its radius, J: contacts may lift out what starts or wakes inside something else. */
static double lift_of_bodies(const ShvHybrid *hybrid)
{
    double sum = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_DEAD) sum += fragment->mass * fragment->radius;
    }
    return sum * shv_norm(shv_load3(hybrid->gravity));
}

static ShvStatus off_by(const ShvHybrid *hybrid, const char *what, double size, double bound, ShvError *error)
{
    int32_t first = -1;
    char inside_out[64] = "no tet inside out";
    const int32_t inverted = shv_solid_inverted(&hybrid->solid, &hybrid->state, &first);
    if (inverted > 0)
        snprintf(inside_out, sizeof inside_out, "%d tets inside out (first: %d)", (int)inverted, (int)first);
    return shv_fail(
        error, SHV_DIVERGED,
        "%s by %.3g J, more than %.3g (fracture.energy_bound × the largest energy), at step %lld, t = %.9g s, "
        "Courant number %.3g, %s; give %sa smaller fracture.time_step or fracture.safety, a finer mesh or a milder "
        "impact, or raise the bound",
        what, size, bound, (long long)hybrid->state.step, hybrid->state.time, shv_hybrid_courant(hybrid), inside_out,
        hybrid->scene->rigid.engine == SHV_RIGID_BULLET_PLAIN
            ? "'engine: bullet' or a smaller bullet_plain.margin (plain Bullet throws what comes to it overlapping), "
            : "");
}

static ShvStatus not_finite(const ShvHybrid *hybrid, ShvError *error)
{
    const int32_t element = first_lost_element(hybrid);
    const long long step = hybrid->state.step;
    const double time = hybrid->state.time;
    if (element < 0)
        return shv_fail(error, SHV_DIVERGED,
                        "the energy stopped being finite at step %lld, t = %.9g s; look for a speed or a size of the "
                        "scene that is out of all proportion",
                        step, time);
    return shv_fail(
        error, SHV_DIVERGED,
        "a value stopped being finite at step %lld, t = %.9g s, in tet %d (Courant number %.3g); give a smaller "
        "fracture.time_step or fracture.safety, or look at that tet's quality",
        step, time, (int)element, shv_hybrid_courant(hybrid));
}

/* `largest`: the largest energy before, J, which nothing that has been gained since is part of. */
static ShvStatus judge_balance(const ShvHybrid *hybrid, double largest, ShvError *error)
{
    const ShvLedgerView *b = &hybrid->observer.balance;
    const double rounding = rounding_of_balance(hybrid), share = hybrid->scene->fracture.energy_bound;
    const double bound = share * b->largest + rounding;
    if (!isfinite(b->kinetic + b->strain + b->residual + b->gravity_potential)) return not_finite(hybrid, error);
    const double off = b->residual + b->step_change;
    if (fabs(off) > bound) return off_by(hybrid, "the energy balance is off", off, bound, error);
    /* With bars, which open facets otherwise than the tractions foresaw, the defect is what bars did to the law. What tractions take
       besides, the backward rule does to springs that the step does not resolve (cohesive/pair.h): bodies with cracks vibrate less. */
    const bool barred = hybrid->stabiliser.active || hybrid->backend->keeps_nodes;
    if (!barred && b->cohesive_defect > bound)
        return off_by(hybrid, "cohesive tractions have given more than the cohesive law", b->cohesive_defect, bound,
                      error);
    const double gain = contact_gain(hybrid);
    const double most = share * fmax(largest, b->largest - gain) + lift_of_bodies(hybrid) + rounding;
    return gain > most ? off_by(hybrid, "contacts have gained energy", gain, most, error) : SHV_OK;
}

ShvStatus shv_hybrid_observe(ShvHybrid *hybrid, ShvError *error)
{
    ShvState *state = &hybrid->state;
    ShvLedgerView balance = {.time = state->time};
    memset(hybrid->observer.ghost.first, 0, sizeof hybrid->observer.ghost.first);
    if (hybrid->awake.count > 0) {
        SHV_TRY(shv_hybrid_synchronise(hybrid, error));
        for (int32_t i = 0; i < hybrid->fragments.count; i++)
            if (hybrid->awake.flags[i]) shv_fragment_fit(&hybrid->fragments.items[i], &hybrid->fragments, state);
        add_awake(hybrid, &balance);
        shv_hybrid_resume(hybrid);
    } else {
        copy_obstacles(hybrid);
    }
    for (int32_t i = 0; i < hybrid->fragments.count; i++) add_fragment(hybrid, &balance, &hybrid->fragments.items[i]);
    shv_add_to3(balance.momentum, shv_load3(hybrid->binned.momentum));
    shv_add_to3(balance.angular_momentum, shv_load3(hybrid->binned.angular));
    for (int32_t i = 0; i < hybrid->obstacles.count; i++) add_obstacle(hybrid, &balance, i);
    add_cohesive(hybrid, &balance);
    add_works(hybrid, &balance);
    close_balance(hybrid, &balance);
    const double largest = hybrid->observer.balance.largest;
    hybrid->observer.balance = balance;
    hybrid->observer.least_contact_work =
        fmin(hybrid->observer.least_contact_work, contact_work(hybrid, &hybrid->observer.balance));
    return judge_balance(hybrid, largest, error);
}
