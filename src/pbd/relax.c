#include "pbd/relax.h"

#include "pbd/response.h"
#include "pbd/slips.h"

enum { BLOCK = 2048 }; /* nodes whose works are summed one after another, whatever the threads */

/* ---- life ---- */

ShvStatus shv_relax_create(ShvRelax *relax, const ShvModel *model, const ShvObstacles *obstacles, ShvError *error)
{
    *relax = (ShvRelax){
        .memory = model->memory, .threads = model->threads, .obstacle_count = obstacles->count, .slip_time = -HUGE_VAL};
    const size_t count = (size_t)obstacles->count;
    relax->later = shv_allocate(relax->memory, SHV_PART_BARS, count, sizeof *relax->later);
    relax->unmoved = shv_allocate(relax->memory, SHV_PART_BARS, 2 * count, sizeof *relax->unmoved);
    relax->yielded = shv_allocate(relax->memory, SHV_PART_BARS, count, sizeof *relax->yielded);
    if (relax->later && relax->unmoved && relax->yielded) return SHV_OK;
    shv_relax_release(relax);
    return shv_fail_memory(error, "the relaxation", count * (sizeof(ShvObstacle) + 7 * sizeof(double)));
}

void shv_relax_release(ShvRelax *relax)
{
    shv_release(relax->anchors);
    shv_release(relax->shifts);
    shv_release(relax->predicted);
    shv_release(relax->before);
    shv_release(relax->force);
    shv_release(relax->slips.items);
    shv_release(relax->past.items);
    shv_release(relax->reactions);
    shv_release(relax->clear);
    shv_release(relax->first_touch);
    shv_release(relax->touched);
    shv_release(relax->touches);
    shv_release(relax->later);
    shv_release(relax->unmoved);
    shv_release(relax->yielded);
    shv_release(relax->works);
    *relax = (ShvRelax){0};
}

/* Arrays are grown one by one; `node_room` is raised only when all are. */
static ShvStatus grow(ShvRelax *relax, int64_t room, ShvError *error)
{
#define GROW(name, components)                                                                                         \
    SHV_RESIZE(relax->memory, SHV_PART_BARS, relax->name, (components) * (size_t)room, "the relaxation",               \
               (size_t)room * 205, error);
    GROW(anchors, 4)
    GROW(shifts, 4)
    GROW(predicted, 3)
    GROW(before, 3)
    GROW(force, 3)
    GROW(reactions, 3)
    GROW(clear, 1)
    GROW(first_touch, 1)
    GROW(touched, 1)
#undef GROW
    for (int64_t i = relax->node_room; i < room; i++) relax->first_touch[i] = -1;
    relax->node_room = (int32_t)room;
    return SHV_OK;
}

static ShvStatus reserve(ShvRelax *relax, const ShvState *state, int32_t count, ShvError *error)
{
    if (state->node_count > relax->node_room) {
        const int64_t room = (int64_t)state->node_count + state->node_count / 2;
        SHV_TRY(grow(relax, room > INT32_MAX ? INT32_MAX : room, error));
    }
    const int32_t blocks = count / BLOCK + 1;
    if (blocks > relax->block_room) {
        SHV_RESIZE(relax->memory, SHV_PART_BARS, relax->works, (size_t)blocks, "the works of nodes",
                   (size_t)blocks * sizeof *relax->works, error);
        relax->block_room = blocks;
    }
    return SHV_OK;
}

/* ---- before the sweeps ---- */

/* A copy has touched what its origin has. */
static void adopt_copies(ShvRelax *relax, const ShvState *state)
{
    for (int32_t node = relax->known_nodes; node < state->node_count; node++)
        relax->touched[node] = relax->touched[state->origin[node]];
    relax->known_nodes = state->node_count;
}

ShvStatus shv_relax_begin(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count, ShvError *error)
{
    SHV_TRY(reserve(relax, state, count, error));
    adopt_copies(relax, state);
    shv_slips_begin(relax, state);
    for (int32_t i = 0; i < count; i++) {
        const int64_t k = 3 * (int64_t)nodes[i];
        shv_store3(relax->before + k, shv_load3(state->velocity + k));
        shv_store3(relax->force + k, shv_load3(state->force + k));
    }
    return SHV_OK;
}

void shv_relax_predict(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count, double step)
{
#pragma omp parallel for num_threads(relax->threads) if (relax->threads > 1)
    for (int32_t i = 0; i < count; i++) {
        const int64_t k = 3 * (int64_t)nodes[i];
        shv_store3(relax->predicted + k,
                   shv_madd(shv_load3(state->displacement + k), step, shv_load3(state->velocity + k)));
    }
}

static void gather(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count,
                   const ShvRelaxStep *step)
{
#pragma omp parallel for num_threads(relax->threads) if (relax->threads > 1)
    for (int32_t i = 0; i < count; i++) {
        const int64_t node = nodes[i];
        shv_store3(relax->anchors + 4 * node, shv_load3(state->reference + 3 * node));
        shv_store3(relax->shifts + 4 * node, shv_load3(relax->predicted + 3 * node));
        const bool moves = state->mass[node] > 0.0 && !(step->fixed && step->fixed[node] == 7);
        relax->anchors[4 * node + 3] = moves ? 1.0 / state->mass[node] : 0.0;
        if (step->fixed) shv_store3(relax->reactions + 3 * node, shv_vec3(0.0, 0.0, 0.0));
    }
}

/* ---- sweeps ---- */

/* Imposed components have the last word in every sweep: what bars did to them is undone. */
static void hold_fixed(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count,
                       const ShvRelaxStep *step)
{
    for (int32_t i = 0; i < count; i++) {
        const int64_t node = nodes[i];
        for (int c = 0; c < 3 && step->fixed[node]; c++) {
            if (!(step->fixed[node] & (1 << c))) continue;
            double *shift = relax->shifts + 4 * node + c;
            relax->reactions[3 * node + c] += state->mass[node] * (relax->predicted[3 * node + c] - *shift);
            *shift = relax->predicted[3 * node + c];
        }
    }
}

static void sweep(ShvRelax *relax, const ShvBars *bars, const ShvState *state, const int32_t *nodes, int32_t count,
                  const ShvRelaxStep *step)
{
    shv_bars_sweep_held(bars, step->stiffness, relax->anchors, relax->shifts, step->fixed ? relax->reactions : NULL);
    if (step->ties) shv_ties_sweep(step->ties, step->stiffness, relax->anchors, relax->shifts);
    if (step->fixed) hold_fixed(relax, state, nodes, count, step);
}

static ShvStatus check_finite(ShvRelax *relax, const int32_t *nodes, int32_t count, ShvError *error)
{
    double largest = 0.0;
    for (int32_t i = 0; i < count; i++) {
        const int64_t node = nodes[i];
        const ShvVec3 change = shv_sub(shv_load3(relax->shifts + 4 * node), shv_load3(relax->predicted + 3 * node));
        const double square = shv_dot(change, change);
        if (!isfinite(square))
            return shv_fail(error, SHV_DIVERGED,
                            "the position of node %d is not finite any more: use a smaller time step, more iterations "
                            "or a larger stiffness of the bars",
                            (int)node);
        largest = square > largest ? square : largest;
    }
    relax->largest_projection = sqrt(largest);
    return SHV_OK;
}

static void move_nodes(const ShvRelax *relax, ShvState *state, const int32_t *nodes, int32_t count,
                       const ShvRelaxStep *step)
{
    const double inverse = 1.0 / step->step, half = step->synchronous ? 0.5 * step->step : 0.0;
    const ShvVec3 tail = shv_scale(shv_load3(step->gravity), half);
#pragma omp parallel for num_threads(relax->threads) if (relax->threads > 1)
    for (int32_t i = 0; i < count; i++) {
        const int64_t node = nodes[i];
        const ShvVec3 shift = shv_load3(relax->shifts + 4 * node);
        const ShvVec3 change = shv_sub(shift, shv_load3(relax->predicted + 3 * node));
        double *velocity = state->velocity + 3 * node;
        shv_store3(velocity, shv_add(shv_madd(shv_load3(velocity), inverse, change), tail));
        shv_store3(state->displacement + 3 * node, shift);
    }
}

/* ---- works ---- */

static void add_work(double work[2], ShvVec3 impulse, ShvVec3 before, ShvVec3 after)
{
    work[0] += 0.5 * shv_dot(impulse, before);
    work[1] += 0.5 * shv_dot(impulse, after);
}

/* Of one node. With velocities of whole moments the kinetic energy changes by every impulse times the mean velocity, to
   which gravity adds dt/2 g·J, while the potential energy changes by −g·(mass × projection): both go to the impulse, so
   that works add up to the change of energy. `moved`: mass × projection. */
static void add_synchronous(double work[2], const ShvRelaxStep *step, ShvVec3 impulse, ShvVec3 moved)
{
    const ShvVec3 lift = shv_madd(shv_scale(moved, -1.0), 0.5 * step->step, impulse);
    work[1] += shv_dot(shv_load3(step->gravity), lift);
}

static void node_work(const ShvRelax *relax, const ShvState *state, int64_t node, const ShvRelaxStep *step,
                      ShvRelaxWork *work)
{
    const ShvVec3 before = shv_load3(relax->before + 3 * node), after = shv_load3(state->velocity + 3 * node);
    const double inverse = 1.0 / step->step;
    ShvVec3 moved = shv_scale(shv_sub(shv_load3(relax->shifts + 4 * node), shv_load3(relax->predicted + 3 * node)),
                              state->mass[node]);
    for (int32_t t = relax->first_touch[node]; t >= 0; t = relax->touches[t].next) {
        const ShvRelaxTouch *touch = &relax->touches[t];
        add_work(work->contact, touch->impulse, before, after);
        add_work(work->friction, touch->friction, before, after);
        moved = shv_sub(moved, shv_add(touch->pushed, touch->drag));
        if (!step->synchronous) continue;
        add_synchronous(work->contact, step, touch->impulse, touch->pushed);
        add_synchronous(work->friction, step, touch->friction, touch->drag);
    }
    const ShvVec3 impulse = shv_scale(moved, inverse);
    add_work(work->bars, impulse, before, after);
    if (step->synchronous) add_synchronous(work->bars, step, impulse, moved);
    if (!step->fixed || !step->fixed[node]) return;
    const ShvVec3 reaction = shv_scale(shv_load3(relax->reactions + 3 * node), inverse);
    add_work(work->bars, shv_scale(reaction, -1.0), before, after);
    add_work(work->constraint, reaction, before, after);
}

static void sum_works(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count,
                      const ShvRelaxStep *step)
{
    const int32_t blocks = count / BLOCK + 1;
#pragma omp parallel for num_threads(relax->threads) if (relax->threads > 1)
    for (int32_t block = 0; block < blocks; block++) {
        ShvRelaxWork work = {{0.0}, {0.0}, {0.0}, {0.0}};
        const int32_t end = block + 1 < blocks ? (block + 1) * BLOCK : count;
        for (int32_t i = block * BLOCK; i < end; i++) node_work(relax, state, nodes[i], step, &work);
        relax->works[block] = work;
    }
    relax->work = (ShvRelaxWork){{0.0}, {0.0}, {0.0}, {0.0}};
    for (int32_t block = 0; block < blocks; block++)
        for (int half = 0; half < 2; half++) {
            relax->work.bars[half] += relax->works[block].bars[half];
            relax->work.contact[half] += relax->works[block].contact[half];
            relax->work.friction[half] += relax->works[block].friction[half];
            relax->work.constraint[half] += relax->works[block].constraint[half];
        }
    if (step->synchronous) return;
    relax->work.contact[0] += relax->past.work;
    relax->work.contact[1] += relax->slips.work;
}

/* ---- the step ---- */

ShvStatus shv_relax_run(ShvRelax *relax, const ShvBars *bars, ShvState *state, ShvObstacles *obstacles,
                        const int32_t *nodes, int32_t count, const ShvRelaxStep *step, ShvError *error)
{
    gather(relax, state, nodes, count, step);
    for (int32_t iteration = 0; iteration < step->iterations; iteration++) {
        sweep(relax, bars, state, nodes, count, step);
        SHV_TRY(shv_response_project(relax, state, nodes, count, step, error));
    }
    SHV_TRY(check_finite(relax, nodes, count, error));
    SHV_TRY(shv_slips_start(relax, state, step, error));
    move_nodes(relax, state, nodes, count, step);
    shv_response_apply(relax, state, obstacles, step);
    shv_slips_finish(relax, state, step);
    sum_works(relax, state, nodes, count, step);
    shv_response_finish(relax, nodes, count);
    return SHV_OK;
}

double shv_relax_largest_strain(const ShvRelax *relax, const ShvBars *bars)
{
    return shv_bars_largest_strain(bars, relax->anchors, relax->shifts);
}

void shv_relax_book(const ShvRelax *relax, ShvLedger *ledger)
{
    const ShvRelaxWork *work = &relax->work;
    shv_ledger_book(ledger, SHV_WORK_BARS, work->bars[0], work->bars[1]);
    shv_ledger_book(ledger, SHV_WORK_CONTACT, work->contact[0], work->contact[1]);
    shv_ledger_book(ledger, SHV_WORK_FRICTION, work->friction[0], work->friction[1]);
    shv_ledger_book(ledger, SHV_WORK_CONSTRAINT, work->constraint[0], work->constraint[1]);
}
