#include "rigid/flight_step.h"
#include "rigid/rigid_archive.h"

typedef struct Analytic {
    ShvRigidBackend backend; /* first: the interface's pointer is this one's */
    ShvFlightBody **bodies;  /* by increasing fragment */
    int32_t count, capacity;
    ShvTouch *touches;
    int32_t touch_capacity;
    ShvObstacle *others;
} Analytic;

/* ---- bodies ---- */

static int32_t place_of(const Analytic *analytic, int32_t fragment)
{
    int32_t low = 0, high = analytic->count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (analytic->bodies[middle]->fragment < fragment)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static ShvMemory *memory_of(const Analytic *analytic)
{
    return analytic->backend.world.fragments->memory;
}

static ShvStatus reserve_touches(Analytic *analytic, int32_t surface_nodes, ShvError *error)
{
    const int64_t obstacles = analytic->backend.world.obstacles->count;
    const int64_t wanted = SHV_TOUCHES_AN_OBSTACLE * (obstacles + 1) + surface_nodes;
    if (wanted <= analytic->touch_capacity) return SHV_OK;
    if (wanted > INT32_MAX) return shv_fail(error, SHV_UNSUPPORTED, "Too many obstacles: remove some.");
    SHV_RESIZE(memory_of(analytic), SHV_PART_RIGID, analytic->touches, (size_t)wanted, "the touches of a fragment",
               (size_t)wanted * sizeof *analytic->touches, error);
    analytic->touch_capacity = (int32_t)wanted;
    return SHV_OK;
}

static ShvFlightStep step_of(Analytic *analytic, ShvFlightBody *body)
{
    const ShvRigidWorld *world = &analytic->backend.world;
    return (ShvFlightStep){.world = world,
                           .body = body,
                           .fragment = &world->fragments->items[body->fragment],
                           .touches = analytic->touches,
                           .others = analytic->others};
}

static ShvStatus add(ShvRigidBackend *backend, int32_t fragment, ShvError *error)
{
    Analytic *analytic = (Analytic *)backend;
    SHV_GROW(memory_of(analytic), SHV_PART_RIGID, analytic->bodies, analytic->capacity, analytic->count,
             "the fragments in flight", error);
    ShvFlightBody *body;
    SHV_TRY(shv_flight_body_create(&body, &backend->world, fragment, error));
    const ShvStatus status = reserve_touches(analytic, body->arms.count, error);
    if (status != SHV_OK) {
        shv_flight_body_destroy(body);
        return status;
    }
    const int32_t place = place_of(analytic, fragment);
    for (int32_t i = analytic->count; i > place; i--) analytic->bodies[i] = analytic->bodies[i - 1];
    analytic->bodies[place] = body;
    analytic->count++;
    ShvFlightStep step = step_of(analytic, body);
    shv_flight_step_greet(&step);
    return SHV_OK;
}

static void take_out(ShvRigidBackend *backend, int32_t fragment)
{
    Analytic *analytic = (Analytic *)backend;
    const int32_t place = place_of(analytic, fragment);
    if (place == analytic->count || analytic->bodies[place]->fragment != fragment) return;
    shv_flight_body_destroy(analytic->bodies[place]);
    analytic->count--;
    for (int32_t i = place; i < analytic->count; i++) analytic->bodies[i] = analytic->bodies[i + 1];
}

/* ---- advance ---- */

static ShvStatus check_motion(const ShvFlightBody *body, const ShvFragment *fragment, double step, ShvError *error)
{
    const double turn =
        step * shv_free_rotation_fastest(&body->rotation, fragment->orientation, body->angular_momentum);
    return shv_rigid_check_motion("fragment", fragment->id, fragment->position, fragment->velocity,
                                  fragment->angular_velocity, turn, error);
}

/* Moves one body; *woke tells whether it leaves flight. */
static ShvStatus advance_body(Analytic *analytic, ShvFlightStep step, bool *woke, ShvRigidContact *contact,
                              ShvError *error)
{
    *woke = false;
    shv_flight_body_read(step.body, step.fragment);
    SHV_TRY(check_motion(step.body, step.fragment, step.step, error));
    *woke = shv_flight_step_run(&step, contact);
    analytic->backend.contact_work += step.work.normal;
    analytic->backend.friction_work += step.work.friction;
    return SHV_OK;
}

static ShvStatus advance(ShvRigidBackend *backend, double time, double step, const double gravity[3],
                         ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes, int32_t *wake_count,
                         ShvError *error)
{
    Analytic *analytic = (Analytic *)backend;
    if (!(step > 0.0)) return SHV_OK;
    ShvStatus status = SHV_OK;
    int32_t kept = 0;
    for (int32_t i = 0; i < analytic->count; i++) {
        ShvFlightBody *body = analytic->bodies[i];
        bool woke = false;
        if (status == SHV_OK && body->time < time + 0.5 * step) {
            ShvFlightStep own = step_of(analytic, body);
            own.time = time;
            own.step = step;
            own.gravity = shv_load3(gravity);
            own.judge = judge;
            own.judge_data = judge_data;
            ShvRigidContact contact;
            status = advance_body(analytic, own, &woke, &contact, error);
            if (woke) wakes[(*wake_count)++] = contact;
            if (status == SHV_OK) body->time = time + step;
        }
        if (woke)
            shv_flight_body_destroy(body);
        else
            analytic->bodies[kept++] = body;
    }
    analytic->count = kept;
    return status;
}

/* ---- checkpoints ---- */

static void remove_all(Analytic *analytic)
{
    for (int32_t i = 0; i < analytic->count; i++) shv_flight_body_destroy(analytic->bodies[i]);
    analytic->count = 0;
}

static bool archive_body(Analytic *analytic, ShvFlightBody **body, ShvArchive *archive)
{
    ShvError error;
    if (!*body) *body = shv_allocate(memory_of(analytic), SHV_PART_RIGID, 1, sizeof **body);
    if (*body) return shv_flight_body_archive(*body, archive);
    return shv_archive_fail(archive, shv_fail_memory(&error, "a fragment in flight", sizeof **body), &error);
}

static bool archive_all(ShvRigidBackend *backend, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(Analytic, bodies, SHV_FIELD_ROOM),
        SHV_FIELD_OF(Analytic, touches, SHV_FIELD_ROOM),
        SHV_FIELD_OF(Analytic, others, SHV_FIELD_KEPT),
        SHV_FIELD_OF(Analytic, count, SHV_FIELD_KEPT),
        SHV_FIELD_OF(Analytic, backend.functions, SHV_FIELD_KEPT),
        SHV_FIELD_OF(Analytic, backend.world, SHV_FIELD_KEPT),
    };
    Analytic *analytic = (Analytic *)backend;
    int32_t count = analytic->count;
    if (shv_archive_reads(archive)) remove_all(analytic);
    bool good = SHV_ARCHIVE_STRUCT(archive, analytic, fields) && shv_archive_bytes(archive, &count, sizeof count);
    for (int32_t i = 0; good && i < count; i++) {
        good = archive_body(analytic, &analytic->bodies[i], archive);
        if (shv_archive_reads(archive)) analytic->count = i + 1;
    }
    return good;
}

/* ---- life ---- */

static void destroy(ShvRigidBackend *backend)
{
    Analytic *analytic = (Analytic *)backend;
    if (!analytic) return;
    remove_all(analytic);
    shv_release(analytic->bodies);
    shv_release(analytic->touches);
    shv_release(analytic->others);
    shv_release(analytic);
}

ShvStatus shv_analytic_create(ShvRigidBackend **backend, const ShvRigidWorld *world, ShvError *error)
{
    static const ShvRigidFunctions functions = {.name = "analytic",
                                                .add = add,
                                                .remove = take_out,
                                                .advance = advance,
                                                .archive = archive_all,
                                                .destroy = destroy};
    *backend = NULL;
    Analytic *analytic = shv_allocate(world->fragments->memory, SHV_PART_RIGID, 1, sizeof *analytic);
    if (!analytic) return shv_fail_memory(error, "the rigid backend", sizeof *analytic);
    analytic->backend.functions = &functions;
    analytic->backend.world = *world;
    const size_t obstacles = (size_t)world->obstacles->count;
    analytic->others = shv_allocate(world->fragments->memory, SHV_PART_RIGID, obstacles, sizeof *analytic->others);
    if (!analytic->others) {
        destroy(&analytic->backend);
        return shv_fail_memory(error, "the rigid backend", obstacles * sizeof(ShvObstacle));
    }
    *backend = &analytic->backend;
    return SHV_OK;
}
