/* One run, and what of it is kept. */
#include <string.h>

#include "base/text.h"
#include "evaluate/digest.h"
#include "record/processor.h"
#include "shiver/plan.h"

static ShvStatus make(const ShvDigestOrder *order, const ShvSceneDefinition *scene, ShvSimulation **simulation,
                      ShvError *error)
{
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = order->folder;
    options.memory = order->memory;
    options.audit_wakes = order->audit_wakes;
    options.stop = order->stop;
    options.stop_data = order->stop_data;
    return shv_simulation_create(simulation, scene, &options, error);
}

static ShvStatus least_stable_step(const ShvSimulation *simulation, double *step, ShvError *error)
{
    *step = HUGE_VAL;
    for (int32_t i = 0; i < shv_simulation_object_count(simulation); i++) {
        ShvPreflight preflight;
        SHV_TRY(shv_simulation_preflight(simulation, i, &preflight, error));
        *step = fmin(*step, preflight.stable_step);
    }
    return SHV_OK;
}

/* The stable step is that of the scene's own meshes, whatever step it asks for. */
static ShvStatus find_stable_step(const ShvDigestOrder *order, double *step, ShvError *error)
{
    ShvSceneDefinition scene = *order->scene;
    ShvSimulation *simulation = NULL;
    scene.fracture.time_step = (double)NAN;
    SHV_TRY(make(order, &scene, &simulation, error));
    const ShvStatus status = least_stable_step(simulation, step, error);
    shv_simulation_destroy(simulation);
    return status;
}

/* ---- figures that build up over frames ---- */

static void add_frame(ShvDigest *digest, const ShvFrameView *frame, double *bars)
{
    double *n = digest->numbers;
    const double change = frame->ledger.bars - *bars;
    *bars = frame->ledger.bars;
    n[change > 0.0 ? SHV_DIGEST_BARS_GIVEN : SHV_DIGEST_BARS_TAKEN] += fabs(change);
    n[SHV_DIGEST_RESIDUAL] = fmax(n[SHV_DIGEST_RESIDUAL], fabs(frame->ledger.residual));
    n[SHV_DIGEST_COURANT] = fmax(n[SHV_DIGEST_COURANT], frame->courant);
}

/* ---- figures of the last frame ---- */

static ShvStatus keep_fragments(ShvDigest *digest, const ShvFrameView *frame, ShvError *error)
{
    double *n = digest->numbers;
    ShvVec3 momentum = shv_vec3(0.0, 0.0, 0.0);
    digest->masses = shv_allocate(digest->memory, SHV_PART_RECORD, (size_t)frame->fragment_count, sizeof(double));
    if (!digest->masses)
        return shv_fail_memory(error, "masses of fragments", (size_t)frame->fragment_count * sizeof(double));
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        if (fragment->mode == SHV_FRAGMENT_DEAD) continue;
        digest->masses[digest->mass_count++] = fragment->mass;
        momentum = shv_madd(momentum, fragment->mass, shv_load3(fragment->velocity));
        n[SHV_DIGEST_MASS] += fragment->mass;
    }
    shv_sort_numbers(digest->masses, digest->mass_count);
    n[SHV_DIGEST_FRAGMENTS] = digest->mass_count;
    if (digest->mass_count > 0)
        n[SHV_DIGEST_LARGEST_MASS] = digest->masses[digest->mass_count - 1] / n[SHV_DIGEST_MASS];
    shv_store3(n + SHV_DIGEST_MOMENTUM_X, momentum);
    return SHV_OK;
}

static void keep_numbers(ShvDigest *digest, const ShvFrameView *frame)
{
    const ShvLedgerView *ledger = &frame->ledger;
    double *n = digest->numbers;
    n[SHV_DIGEST_TIME] = frame->time;
    n[SHV_DIGEST_STEPS] = (double)frame->steps;
    n[SHV_DIGEST_STEP] = frame->step;
    n[SHV_DIGEST_KINETIC] = ledger->kinetic;
    n[SHV_DIGEST_STRAIN] = ledger->strain;
    n[SHV_DIGEST_DISSIPATED] = ledger->fracture_dissipation;
    n[SHV_DIGEST_BAR_SHARE] = frame->bar_work_share;
    n[SHV_DIGEST_LARGEST] = ledger->largest;
    n[SHV_DIGEST_FAILED_AREA] = ledger->failed_area;
    n[SHV_DIGEST_INSERTED] = frame->inserted;
    n[SHV_DIGEST_FAILED] = frame->failed;
    memcpy(n + SHV_DIGEST_IMPULSE_X, frame->contact_impulse, sizeof frame->contact_impulse);
    n[SHV_DIGEST_CONTACT_TIME] = frame->contact_time;
    n[SHV_DIGEST_FIRST_CONTACT] = frame->first_contact;
    n[SHV_DIGEST_AUDITED] = frame->audited;
    n[SHV_DIGEST_MISSED] = frame->missed;
    for (int32_t i = 0; i < frame->cost_count && i < SHV_COST_COUNT; i++) digest->costs[i] = frame->costs[i].seconds;
}

static ShvStatus keep_crack(ShvDigest *digest, const ShvSimulation *simulation, ShvError *error)
{
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    const size_t count = 4 * (size_t)mesh.element_count;
    uint8_t *bonds = shv_allocate(digest->memory, SHV_PART_RECORD, count, sizeof *bonds);
    if (!bonds) return shv_fail_memory(error, "bonds of facets", count * sizeof *bonds);
    shv_simulation_bonds(simulation, bonds);
    const ShvStatus status = shv_crack_surface_create(&digest->crack, &mesh, bonds, digest->memory, error);
    shv_release(bonds);
    return status;
}

static ShvStatus keep(ShvDigest *digest, const ShvSimulation *simulation, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    digest->threads = shv_simulation_threads(simulation);
    keep_numbers(digest, frame);
    SHV_TRY(keep_fragments(digest, frame, error));
    return keep_crack(digest, simulation, error);
}

/* ---- the run ---- */

/* The next frame, its time and what builds up. */
static ShvStatus pull_frame(ShvDigestPull *pull, ShvBodies *bodies, ShvError *own, ShvError *error)
{
    pull->begun = shv_now();
    const ShvStatus status = shv_simulation_advance(pull->simulation, own);
    const ShvFrameView *frame = shv_simulation_frame(pull->simulation);
    if (frame->steps > 0 || frame->time > 0.0) pull->seconds += shv_now() - pull->begun;
    if (status == SHV_INTERRUPTED || status == SHV_NO_MEMORY) return shv_fail(error, status, "%s", own->message);
    if (status != SHV_OK) return SHV_OK;
    if (pull->order->tracked && !bodies->items)
        SHV_TRY(shv_bodies_create(bodies, pull->order->scene, frame, pull->digest->memory, error));
    add_frame(pull->digest, frame, &pull->bars);
    return pull->order->tracked ? shv_digest_track(pull->digest, bodies, frame, error) : SHV_OK;
}

/* Frame by frame, or from a checkpoint on, to the end or to a failure, which goes to `own`. */
static ShvStatus pull_frames(ShvDigestPull *pull, ShvBodies *bodies, ShvError *own, ShvError *error)
{
    bool goes_on;
    SHV_TRY(pull_frame(pull, bodies, own, error));
    if (own->status == SHV_OK) SHV_TRY(shv_digest_go_on(pull, bodies, &goes_on, error));
    while (own->status == SHV_OK && !shv_simulation_finished(pull->simulation))
        SHV_TRY(pull_frame(pull, bodies, own, error));
    pull->digest->seconds[pull->digest->repeats++] = pull->seconds;
    return keep(pull->digest, pull->simulation, error);
}

/* For its time alone. */
static ShvStatus repeat(ShvDigest *digest, const ShvDigestOrder *order, const ShvSceneDefinition *scene,
                        ShvError *error)
{
    ShvSimulation *simulation = NULL;
    SHV_TRY(make(order, scene, &simulation, error));
    ShvStatus status = shv_simulation_advance(simulation, error);
    const double start = shv_now();
    while (status == SHV_OK && !shv_simulation_finished(simulation)) status = shv_simulation_advance(simulation, error);
    digest->seconds[digest->repeats++] = shv_now() - start;
    shv_simulation_destroy(simulation);
    return status;
}

static bool is_short(const ShvDigest *digest, const ShvDigestOrder *order)
{
    double sum = 0.0;
    for (int32_t i = 0; i < digest->repeats; i++) sum += digest->seconds[i];
    return order->repeat_below == 0.0 || sum < order->repeat_below;
}

static ShvStatus run_first(ShvDigest *digest, const ShvDigestOrder *order, const ShvSceneDefinition *scene,
                           ShvError *own, ShvError *error)
{
    ShvBodies bodies = {NULL, 0};
    ShvDigestPull pull = {.order = order, .digest = digest};
    ShvDigestOrder asking = *order;
    asking.stop = shv_digest_ask;
    asking.stop_data = &pull;
    const double start = shv_now();
    ShvStatus status = make(&asking, scene, &pull.simulation, own);
    digest->numbers[SHV_DIGEST_SETUP] = shv_now() - start;
    if (status == SHV_NO_MEMORY) return shv_fail(error, status, "%s", own->message);
    if (status != SHV_OK) return SHV_OK;
    status = least_stable_step(pull.simulation, &digest->numbers[SHV_DIGEST_STABLE_STEP], error);
    if (status == SHV_OK) status = pull_frames(&pull, &bodies, own, error);
    shv_bodies_release(&bodies);
    shv_simulation_destroy(pull.simulation);
    return status;
}

ShvStatus shv_digest_run(ShvDigest *digest, const ShvDigestOrder *order, ShvError *error)
{
    ShvError own = {.status = SHV_OK, .message = ""};
    ShvSceneDefinition scene = *order->scene;
    *digest = (ShvDigest){.memory = order->memory, .tracked = order->tracked};
    shv_processor_name(digest->processor, sizeof digest->processor);
    digest->seconds = shv_allocate(order->memory, SHV_PART_RECORD, (size_t)order->repeats, sizeof(double));
    if (!digest->seconds) return shv_fail_memory(error, "run times", (size_t)order->repeats * sizeof(double));
    double stable = (double)NAN;
    if (!isnan(order->multiple) && find_stable_step(order, &stable, &own) == SHV_NO_MEMORY)
        return shv_fail(error, SHV_NO_MEMORY, "%s", own.message);
    if (!isnan(stable)) scene.fracture.time_step = order->multiple * stable;
    if (own.status == SHV_OK) SHV_TRY(run_first(digest, order, &scene, &own, error));
    digest->status = own.status;
    shv_format(digest->message, sizeof digest->message, "%.255s", own.message);
    for (int32_t i = 1; i < order->repeats && own.status == SHV_OK && is_short(digest, order); i++)
        SHV_TRY(repeat(digest, order, &scene, error));
    return SHV_OK;
}
