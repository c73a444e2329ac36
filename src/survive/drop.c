#include "survive/drop.h"

#include <math.h>
#include <string.h>

#include "base/deterministic.h"
#include "base/random.h"
#include "shiver/run_file.h"

static const double standard_gravity = 9.80665; /* m/s² */

double shv_drop_speed(double height)
{
    return sqrt(2.0 * standard_gravity * height);
}

/* ---- the body ---- */

static ShvStatus find_object(ShvDrop *drop, ShvError *error)
{
    const ShvSceneDefinition *scene = drop->scene;
    if (!scene->survival.object && scene->object_count == 1) return SHV_OK;
    if (!scene->survival.object)
        return shv_fail(error, SHV_BAD_INPUT,
                        "the scene has several objects; survival.object names the one that falls");
    for (drop->object = 0; drop->object < scene->object_count; drop->object++)
        if (strcmp(scene->objects[drop->object].name, scene->survival.object) == 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "survival.object: there is no object '%s'", scene->survival.object);
}

static ShvStatus find_direction(ShvDrop *drop, ShvError *error)
{
    const bool height = drop->scene->survival.vary == SHV_SURVIVAL_HEIGHT;
    const ShvVec3 along =
        shv_load3(height ? drop->scene->gravity : drop->scene->objects[drop->object].placement.velocity);
    if (!(shv_norm(along) > 0.0))
        return shv_fail(error, SHV_BAD_INPUT,
                        height ? "nothing falls without gravity; give it, or 'survival: {vary: speed}' and a velocity"
                               : "survival.vary: speed needs a velocity of the object, for its direction");
    drop->direction = shv_unit(along);
    return SHV_OK;
}

/* The body as the scene places it, from a simulation of it that is not run. */
static ShvStatus copy_nodes(ShvDrop *drop, ShvError *error)
{
    ShvSimulation *simulation;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = drop->folder;
    options.memory = drop->memory;
    SHV_TRY(shv_simulation_create(&simulation, drop->scene, &options, error));
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    const ShvObjectView object = mesh.objects[drop->object];
    drop->node_count = object.node_end - object.node_begin;
    drop->nodes = shv_allocate(drop->memory, SHV_PART_GENERAL, 3 * (size_t)drop->node_count, sizeof(double));
    if (drop->nodes)
        memcpy(drop->nodes, mesh.positions + 3 * (int64_t)object.node_begin,
               3 * (size_t)drop->node_count * sizeof(double));
    shv_simulation_destroy(simulation);
    if (!drop->nodes) return shv_fail_memory(error, "the body's nodes", 24 * (size_t)drop->node_count);
    drop->centre = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t i = 0; i < drop->node_count; i++)
        drop->centre = shv_madd(drop->centre, 1.0 / drop->node_count, shv_load3(drop->nodes + 3 * (int64_t)i));
    return SHV_OK;
}

ShvStatus shv_drop_create(ShvDrop *drop, const ShvSceneDefinition *scene, const char *folder,
                          const ShvSurviveOptions *options, ShvError *error)
{
    *drop = (ShvDrop){.scene = scene,
                      .folder = folder,
                      .memory = options->memory,
                      .stop = options->stop,
                      .stop_data = options->stop_data};
    ShvStatus status = find_object(drop, error);
    if (status == SHV_OK) status = find_direction(drop, error);
    if (status == SHV_OK) status = copy_nodes(drop, error);
    if (status == SHV_OK) {
        drop->objects =
            shv_allocate(drop->memory, SHV_PART_GENERAL, (size_t)scene->object_count, sizeof *drop->objects);
        if (!drop->objects) status = shv_fail_memory(error, "objects", (size_t)scene->object_count);
    }
    if (status != SHV_OK) shv_drop_release(drop);
    return status;
}

void shv_drop_release(ShvDrop *drop)
{
    shv_release(drop->nodes);
    shv_release(drop->objects);
    drop->nodes = NULL;
    drop->objects = NULL;
}

/* ---- how it falls ---- */

/* All orientations alike (K. Shoemake, Uniform random rotations, Graphics Gems III (1992) 124). */
static ShvQuat random_turn(uint64_t specimen)
{
    const uint64_t seed =
        specimen ^ UINT64_C(0x7475726e); /* its own numbers: strengths are drawn from the seed itself */
    const double u = shv_random_uniform(seed, 0), a = 2.0 * SHV_PI * shv_random_uniform(seed, 1),
                 b = 2.0 * SHV_PI * shv_random_uniform(seed, 2);
    return (ShvQuat){
        .w = sqrt(u) * cos(b), .x = sqrt(1.0 - u) * sin(a), .y = sqrt(1.0 - u) * cos(a), .z = sqrt(u) * sin(b)};
}

/* How far the body reaches forwards once it is turned about its centre. */
static double foremost(const ShvDrop *drop, ShvQuat turn)
{
    double most = -HUGE_VAL;
    for (int32_t i = 0; i < drop->node_count; i++) {
        const ShvVec3 arm = shv_rotate(turn, shv_sub(shv_load3(drop->nodes + 3 * (int64_t)i), drop->centre));
        most = fmax(most, shv_dot(arm, drop->direction));
    }
    return most;
}

/* Where its centre goes, so that its foremost point stays where it was along the way. */
static ShvVec3 turned_centre(const ShvDrop *drop, ShvQuat turn)
{
    return shv_madd(drop->centre, foremost(drop, shv_quat_identity()) - foremost(drop, turn), drop->direction);
}

static void turn_body(const ShvDrop *drop, ShvQuat turn, ShvPlacement *placement)
{
    const ShvVec3 axis = shv_load3(placement->rotation_axis), place = shv_load3(placement->position);
    const ShvQuat old = shv_norm(axis) > 0.0
                            ? shv_quat_from_axis_angle(shv_unit(axis), placement->rotation_degrees * SHV_PI / 180.0)
                            : shv_quat_identity();
    const ShvQuat whole = shv_quat_unit(shv_quat_multiply(turn, old));
    const ShvVec3 arm = shv_vec3(whole.x, whole.y, whole.z);
    const double sine = shv_norm(arm);
    const ShvVec3 arm_of_origin = shv_rotate(turn, shv_sub(place, drop->centre));
    shv_store3(placement->position, shv_add(turned_centre(drop, turn), arm_of_origin));
    shv_store3(placement->rotation_axis, sine > 0.0 ? shv_scale(arm, 1.0 / sine) : shv_vec3(0.0, 0.0, 1.0));
    placement->rotation_degrees = 2.0 * atan2(sine, whole.w) * 180.0 / SHV_PI;
}

static ShvSceneDefinition scene_of(const ShvDrop *drop, uint64_t specimen, double height)
{
    ShvSceneDefinition scene = *drop->scene;
    memcpy(drop->objects, scene.objects, (size_t)scene.object_count * sizeof *drop->objects);
    ShvPlacement *placement = &drop->objects[drop->object].placement;
    if (scene.survival.turn) turn_body(drop, random_turn(specimen), placement);
    shv_store3(placement->velocity, shv_scale(drop->direction, shv_drop_speed(height)));
    scene.objects = drop->objects;
    scene.seed += specimen;
    return scene;
}

/* ---- what becomes of it ---- */

/* The pieces of the body by mass. */
static void judge(const ShvDrop *drop, const ShvFrameView *frame, ShvShot *shot)
{
    double mass = 0.0, masses[SHV_SHOT_PIECES] = {0.0};
    shot->pieces = 0;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        if (fragment->mode == SHV_FRAGMENT_DEAD || fragment->object != drop->object) continue;
        mass += fragment->mass;
        shot->pieces++;
        double moved = fragment->mass;
        for (int k = 0; k < SHV_SHOT_PIECES; k++)
            if (moved > masses[k]) {
                const double smaller = masses[k];
                masses[k] = moved;
                moved = smaller;
            }
    }
    for (int k = 0; k < SHV_SHOT_PIECES; k++) shot->shares[k] = mass > 0.0 ? masses[k] / mass : 0.0;
    shot->broken = shot->shares[0] < drop->scene->survival.broken;
}

/* Where the first crack began, in the body as the scene places it. */
static ShvStatus find_origin(const ShvDrop *drop, const ShvSimulation *simulation, ShvShot *shot, ShvError *error)
{
    ShvCrackView crack;
    SHV_TRY(shv_simulation_crack(simulation, &crack, error));
    ShvVec3 origin = shv_load3(crack.origin);
    if (crack.facets > 0 && drop->scene->survival.turn) {
        const ShvQuat turn = random_turn(shot->specimen);
        const ShvVec3 arm = shv_sub(origin, turned_centre(drop, turn));
        origin = shv_add(drop->centre, shv_rotate(shv_quat_conjugate(turn), arm));
    }
    shv_store3(shot->origin, origin);
    return SHV_OK;
}

/* To the end or, once it has broken, until nothing cracks any more: then its pieces are known, too. */
static ShvStatus run(const ShvDrop *drop, ShvSimulation *simulation, ShvRecord *record, ShvShot *shot, ShvError *error)
{
    bool known = false;
    while (!known) {
        SHV_TRY(shv_simulation_advance(simulation, error));
        const ShvFrameView *frame = shv_simulation_frame(simulation);
        if (record) SHV_TRY(shv_record_frame(record, simulation, error));
        judge(drop, frame, shot);
        known = shv_simulation_finished(simulation) || (shot->broken && !frame->fracture);
    }
    return find_origin(drop, simulation, shot, error);
}

/* A run of `shot`, which holds specimen and height, recorded where `path` says. */
static ShvStatus run_recorded(const ShvDrop *drop, ShvSimulation *simulation, const char *path, ShvShot *shot,
                              ShvError *error)
{
    ShvRecord *record = NULL;
    ShvRecordDefinition recording = shv_record_default();
    recording.path = path;
    recording.force = recording.nodes = true;
    recording.scene_name = drop->scene->name;
    recording.threads = shv_simulation_threads(simulation);
    recording.memory = drop->memory;
    if (path) SHV_TRY(shv_record_create(&record, &recording, simulation, error));
    const ShvStatus status = run(drop, simulation, record, shot, error);
    ShvError closing;
    const ShvStatus closed = shv_record_close(record, status, status == SHV_OK ? "" : error->message, &closing);
    if (status == SHV_OK && closed != SHV_OK) *error = closing;
    return status == SHV_OK ? closed : status;
}

static ShvStatus fall(ShvDrop *drop, const char *path, ShvShot *shot, ShvError *error)
{
    ShvSimulation *simulation;
    ShvSimulationOptions options = shv_simulation_options_default();
    const ShvSceneDefinition scene = scene_of(drop, shot->specimen, shot->height);
    options.folder = drop->folder;
    options.memory = drop->memory;
    options.stop = drop->stop;
    options.stop_data = drop->stop_data;
    ShvStatus status = shv_simulation_create(&simulation, &scene, &options, error);
    if (status == SHV_OK) {
        status = run_recorded(drop, simulation, path, shot, error);
        shv_simulation_destroy(simulation);
    }
    if (status == SHV_OK || status == SHV_INTERRUPTED || status == SHV_NO_MEMORY) return status;
    return shv_fail_within(error, status, "specimen %llu from %g m", (unsigned long long)shot->specimen, shot->height);
}

ShvStatus shv_drop_shoot(ShvDrop *drop, uint64_t specimen, double height, ShvShot *shot, ShvError *error)
{
    *shot = (ShvShot){.specimen = specimen, .height = height};
    return fall(drop, NULL, shot, error);
}

ShvStatus shv_drop_record(ShvDrop *drop, const ShvShot *shot, const char *path, ShvError *error)
{
    ShvShot again = {.specimen = shot->specimen, .height = shot->height};
    return fall(drop, path, &again, error);
}
