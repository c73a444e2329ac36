#include "pbd/pbd_backend.h"

#include "pbd/pbd_archive.h"
#include "pbd/pbd_body.h"

typedef struct Pbd {
    ShvRigidBackend backend; /* first: the interface's pointer is this one's */
    const ShvPbdDefinition *settings;
    ShvBars bars;
    ShvTies ties;
    ShvRelax relax;
    ShvPbdBody **bodies; /* by increasing fragment */
    int32_t count, capacity;
    bool stale;     /* those that move are not those of the lists below */
    uint8_t *flags; /* per fragment index: in flight and moving */
    int32_t flag_room;
    int32_t *nodes; /* of all that move, one after another */
    int32_t node_count, node_room;
    int32_t *owner; /* per node of the state: index of its body, for nodes that move */
    int32_t owner_room;
} Pbd;

#define RESERVE(pbd, block, room, wanted, error)                                                                       \
    SHV_BACKEND_RESERVE(&(pbd)->backend, (pbd)->block, (pbd)->room, (wanted), "the fragments in flight", (error))

/* ---- coming and going ---- */

static int32_t place_of(const Pbd *pbd, int32_t fragment)
{
    int32_t low = 0, high = pbd->count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (pbd->bodies[middle]->fragment < fragment)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static ShvStatus reserve_flags(Pbd *pbd, ShvError *error)
{
    RESERVE(pbd, flags, flag_room, pbd->backend.world.fragments->count, error);
    return SHV_OK;
}

static ShvStatus add(ShvRigidBackend *backend, int32_t fragment, ShvError *error)
{
    Pbd *pbd = (Pbd *)backend;
    SHV_TRY(reserve_flags(pbd, error));
    RESERVE(pbd, bodies, capacity, (int64_t)pbd->count + 1, error);
    ShvPbdBody *body;
    SHV_TRY(shv_pbd_body_create(&body, &backend->world, fragment, error));
    const int32_t place = place_of(pbd, fragment);
    for (int32_t i = pbd->count; i > place; i--) pbd->bodies[i] = pbd->bodies[i - 1];
    pbd->bodies[place] = body;
    pbd->count++;
    pbd->stale = true;
    return SHV_OK;
}

static void take_out(ShvRigidBackend *backend, int32_t fragment)
{
    Pbd *pbd = (Pbd *)backend;
    const int32_t place = place_of(pbd, fragment);
    if (place == pbd->count || pbd->bodies[place]->fragment != fragment) return;
    shv_pbd_body_destroy(pbd->bodies[place]);
    pbd->count--;
    for (int32_t i = place; i < pbd->count; i++) pbd->bodies[i] = pbd->bodies[i + 1];
    pbd->flags[fragment] = 0;
    pbd->stale = true;
}

/* Those that an earlier call has moved to the end of the step already stay where they are. */
static void choose_moving(Pbd *pbd, double time, double step)
{
    for (int32_t i = 0; i < pbd->count; i++) {
        ShvPbdBody *body = pbd->bodies[i];
        const bool moves = body->time < time + 0.5 * step;
        if (moves != body->moves) pbd->stale = true;
        body->moves = moves;
    }
}

/* Lists of nodes and the bars of what moves. */
static ShvStatus refresh(Pbd *pbd, ShvError *error)
{
    if (!pbd->stale) return SHV_OK;
    const ShvRigidWorld *world = &pbd->backend.world;
    int64_t count = 0;
    SHV_TRY(reserve_flags(pbd, error));
    for (int32_t i = 0; i < pbd->count; i++) {
        const ShvPbdBody *body = pbd->bodies[i];
        pbd->flags[body->fragment] = body->moves;
        if (body->moves) count += world->fragments->items[body->fragment].node_count;
    }
    RESERVE(pbd, nodes, node_room, count, error);
    RESERVE(pbd, owner, owner_room, world->state->node_count, error);
    SHV_TRY(shv_bars_update(&pbd->bars, world->state, pbd->flags, error));
    SHV_TRY(shv_ties_update(&pbd->ties, world->fragments, world->state, pbd->flags, error));
    pbd->node_count = 0;
    for (int32_t i = 0; i < pbd->count; i++) {
        if (!pbd->bodies[i]->moves) continue;
        const ShvFragment *fragment = &world->fragments->items[pbd->bodies[i]->fragment];
        for (int32_t k = 0; k < fragment->node_count; k++) {
            const int32_t node = world->fragments->nodes[fragment->node_begin + k];
            pbd->owner[node] = i;
            pbd->nodes[pbd->node_count++] = node;
        }
    }
    pbd->stale = false;
    return SHV_OK;
}

/* ---- advance ---- */

static ShvRelaxStep step_of(const Pbd *pbd, double step, const double gravity[3])
{
    return (ShvRelaxStep){.step = step,
                          .gravity = {gravity[0], gravity[1], gravity[2]},
                          .stiffness = pbd->settings->stiffness,
                          .iterations = pbd->settings->iterations,
                          .rest_speed = 2.0 * step * shv_norm(shv_load3(gravity)),
                          .synchronous = true,
                          .ties = &pbd->ties};
}

static ShvStatus predict_all(Pbd *pbd, const ShvRelaxStep *step, ShvError *error)
{
    const ShvRigidWorld *world = &pbd->backend.world;
    for (int32_t i = 0; i < pbd->count; i++) {
        double taken;
        if (!pbd->bodies[i]->moves) continue;
        SHV_TRY(shv_pbd_body_predict(pbd->bodies[i], world, pbd->settings, &pbd->relax, step, &taken, error));
        pbd->backend.damping_work -= taken;
    }
    return shv_relax_detect(&pbd->relax, world->state, world->obstacles, pbd->nodes, pbd->node_count, step, error);
}

/* The touch of each body and obstacle that closes fastest; `pushed`: only among those that were projected. */
static void find_fastest(Pbd *pbd, bool pushed)
{
    for (int32_t i = 0; i < pbd->count; i++)
        for (int32_t o = 0; o < pbd->relax.obstacle_count; o++) pbd->bodies[i]->fastest[o] = -1;
    for (int32_t t = 0; t < pbd->relax.touch_count; t++) {
        const ShvRelaxTouch *touch = &pbd->relax.touches[t];
        if (pushed && !(touch->push > 0.0)) continue;
        int32_t *fastest = &pbd->bodies[pbd->owner[touch->node]]->fastest[touch->obstacle];
        if (*fastest < 0 || touch->closing_speed > pbd->relax.touches[*fastest].closing_speed) *fastest = t;
    }
}

/* The whole step of a fragment that wakes goes to fracture mode, in which the gap is yet to close: when that will be, by
   how deep the prediction goes. */
static double closing_time(const Pbd *pbd, const ShvRelaxTouch *touch, double time, double step)
{
    const int64_t i = 3 * (int64_t)touch->node;
    const ShvVec3 predicted =
        shv_add(shv_load3(pbd->backend.world.state->reference + i), shv_load3(pbd->relax.predicted + i));
    const double depth = shv_dot(shv_sub(touch->point, predicted), touch->normal);
    return time + fmin(step, fmax(0.0, step - depth / touch->closing_speed));
}

/* Whether a contact of one body wakes it. */
static bool wakes_up(const Pbd *pbd, const ShvPbdBody *body, double time, double step, ShvWakeJudge judge,
                     void *judge_data, ShvRigidContact *contact)
{
    for (int32_t o = 0; o < pbd->relax.obstacle_count && judge; o++) {
        if (body->fastest[o] < 0) continue;
        const ShvRelaxTouch *touch = &pbd->relax.touches[body->fastest[o]];
        if (!(touch->closing_speed > 0.0)) continue;
        *contact = (ShvRigidContact){.fragment = body->fragment,
                                     .obstacle = o,
                                     .other = -1,
                                     .other_mass = pbd->backend.world.obstacles->items[o].mass,
                                     .time = time,
                                     .expected = closing_time(pbd, touch, time, step),
                                     .point = touch->point,
                                     .normal = touch->normal,
                                     .closing_speed = touch->closing_speed,
                                     .fresh = !body->touched[o]};
        if (judge(judge_data, contact)) return true;
    }
    return false;
}

static void judge_all(Pbd *pbd, double time, double step, ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes,
                      int32_t *wake_count)
{
    find_fastest(pbd, false);
    int32_t kept = 0;
    for (int32_t i = 0; i < pbd->count; i++) {
        ShvPbdBody *body = pbd->bodies[i];
        ShvRigidContact contact;
        if (!body->moves || !wakes_up(pbd, body, time, step, judge, judge_data, &contact)) {
            pbd->bodies[kept++] = body;
            continue;
        }
        wakes[(*wake_count)++] = contact;
        shv_pbd_body_write(body, &pbd->backend.world);
        pbd->flags[body->fragment] = 0;
        pbd->stale = true;
        shv_pbd_body_destroy(body);
    }
    pbd->count = kept;
}

/* What is still in flight moves. */
static ShvStatus move_all(Pbd *pbd, const ShvRelaxStep *step, ShvError *error)
{
    const ShvRigidWorld *world = &pbd->backend.world;
    for (int32_t i = 0; i < pbd->count; i++)
        if (pbd->bodies[i]->moves) shv_pbd_body_rotate(pbd->bodies[i], world);
    SHV_TRY(shv_relax_begin(&pbd->relax, world->state, pbd->nodes, pbd->node_count, error));
    const ShvVec3 kick = shv_scale(shv_load3(step->gravity), 0.5 * step->step);
    for (int32_t i = 0; i < pbd->node_count; i++)
        shv_add_to3(world->state->velocity + 3 * (int64_t)pbd->nodes[i], kick);
    return shv_relax_run(&pbd->relax, &pbd->bars, world->state, world->obstacles, pbd->nodes, pbd->node_count, step,
                         error);
}

static void book(Pbd *pbd, double end)
{
    const ShvRelaxWork *work = &pbd->relax.work;
    pbd->backend.bars_work += work->bars[0] + work->bars[1];
    pbd->backend.contact_work += work->contact[0] + work->contact[1] + pbd->relax.obstacle_work;
    pbd->backend.friction_work += work->friction[0] + work->friction[1];
    find_fastest(pbd, true);
    for (int32_t i = 0; i < pbd->count; i++) {
        if (!pbd->bodies[i]->moves) continue;
        pbd->bodies[i]->time = end;
        shv_pbd_body_write(pbd->bodies[i], &pbd->backend.world);
        shv_pbd_body_note_contacts(pbd->bodies[i], &pbd->backend.world, &pbd->relax);
    }
}

static ShvStatus advance(ShvRigidBackend *backend, double time, double step, const double gravity[3],
                         ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes, int32_t *wake_count,
                         ShvError *error)
{
    Pbd *pbd = (Pbd *)backend;
    if (!(step > 0.0) || pbd->count == 0) return SHV_OK;
    const ShvRelaxStep settings = step_of(pbd, step, gravity);
    choose_moving(pbd, time, step);
    SHV_TRY(refresh(pbd, error));
    if (pbd->node_count == 0) return SHV_OK;
    SHV_TRY(shv_relax_begin(&pbd->relax, backend->world.state, pbd->nodes, pbd->node_count, error));
    SHV_TRY(predict_all(pbd, &settings, error));
    judge_all(pbd, time, step, judge, judge_data, wakes, wake_count);
    SHV_TRY(refresh(pbd, error));
    if (pbd->node_count == 0) return SHV_OK;
    SHV_TRY(move_all(pbd, &settings, error));
    book(pbd, time + step);
    return SHV_OK;
}

/* ---- checkpoints ---- */

static void remove_all(Pbd *pbd)
{
    for (int32_t i = 0; i < pbd->count; i++) shv_pbd_body_destroy(pbd->bodies[i]);
    pbd->count = 0;
}

static bool archive_body(Pbd *pbd, ShvPbdBody **body, ShvArchive *archive)
{
    ShvError error;
    ShvMemory *memory = pbd->backend.world.fragments->memory;
    if (!*body) *body = shv_allocate(memory, SHV_PART_RIGID, 1, sizeof **body);
    if (*body) return shv_pbd_body_archive(*body, archive);
    return shv_archive_fail(archive, shv_fail_memory(&error, "a fragment in flight", sizeof **body), &error);
}

static bool archive_bodies(Pbd *pbd, ShvArchive *archive)
{
    int32_t count = pbd->count;
    if (shv_archive_reads(archive)) remove_all(pbd);
    bool good = shv_archive_room(archive, (void **)&pbd->bodies) && shv_archive_bytes(archive, &count, sizeof count);
    for (int32_t i = 0; good && i < count; i++) {
        good = archive_body(pbd, &pbd->bodies[i], archive);
        if (shv_archive_reads(archive)) pbd->count = i + 1;
    }
    return good;
}

static bool archive_all(ShvRigidBackend *backend, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(Pbd, flags, SHV_FIELD_BLOCK),        SHV_FIELD_OF(Pbd, nodes, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(Pbd, owner, SHV_FIELD_BLOCK),        SHV_FIELD_OF(Pbd, backend.functions, SHV_FIELD_KEPT),
        SHV_FIELD_OF(Pbd, backend.world, SHV_FIELD_KEPT), SHV_FIELD_OF(Pbd, settings, SHV_FIELD_KEPT),
        SHV_FIELD_OF(Pbd, bodies, SHV_FIELD_KEPT),        SHV_FIELD_OF(Pbd, count, SHV_FIELD_KEPT),
        SHV_FIELD_OF(Pbd, bars, SHV_FIELD_KEPT),          SHV_FIELD_OF(Pbd, ties, SHV_FIELD_KEPT),
        SHV_FIELD_OF(Pbd, relax, SHV_FIELD_KEPT),
    };
    Pbd *pbd = (Pbd *)backend;
    return archive_bodies(pbd, archive) && SHV_ARCHIVE_STRUCT(archive, pbd, fields) &&
           shv_bars_archive(&pbd->bars, archive) && shv_ties_archive(&pbd->ties, archive) &&
           shv_relax_archive(&pbd->relax, archive);
}

/* ---- life ---- */

static void destroy(ShvRigidBackend *backend)
{
    Pbd *pbd = (Pbd *)backend;
    if (!pbd) return;
    remove_all(pbd);
    shv_release(pbd->bodies);
    shv_release(pbd->flags);
    shv_release(pbd->nodes);
    shv_release(pbd->owner);
    shv_relax_release(&pbd->relax);
    shv_bars_release(&pbd->bars);
    shv_ties_release(&pbd->ties);
    shv_release(pbd);
}

static ShvStatus check(const ShvPbdDefinition *pbd, ShvError *error)
{
    if (!(pbd->stiffness >= 0.0 && pbd->stiffness <= 1.0))
        return shv_fail(error, SHV_BAD_INPUT, "pbd.stiffness is %g; give a number from 0 to 1", pbd->stiffness);
    if (!(pbd->damping >= 0.0 && pbd->damping <= 1.0))
        return shv_fail(error, SHV_BAD_INPUT, "pbd.damping is %g; give a number from 0 to 1", pbd->damping);
    if (pbd->iterations < 1)
        return shv_fail(error, SHV_BAD_INPUT, "pbd.iterations is %d; give at least 1", (int)pbd->iterations);
    return SHV_OK;
}

ShvStatus shv_pbd_create(ShvRigidBackend **backend, const ShvRigidWorld *world, const ShvPbdDefinition *settings,
                         ShvError *error)
{
    static const ShvRigidFunctions functions = {
        .name = "pbd", .add = add, .remove = take_out, .advance = advance, .archive = archive_all, .destroy = destroy};
    *backend = NULL;
    SHV_TRY(check(settings, error));
    Pbd *pbd = shv_allocate(world->fragments->memory, SHV_PART_RIGID, 1, sizeof *pbd);
    if (!pbd) return shv_fail_memory(error, "the rigid backend", sizeof *pbd);
    pbd->backend.functions = &functions;
    pbd->backend.world = *world;
    pbd->backend.keeps_nodes = true;
    pbd->settings = settings;
    ShvStatus status = shv_bars_create(&pbd->bars, world->model, settings->form, error);
    if (status == SHV_OK) status = shv_relax_create(&pbd->relax, world->model, world->obstacles, error);
    if (status == SHV_OK)
        *backend = &pbd->backend;
    else
        destroy(&pbd->backend);
    return status;
}
