/* A simulation driven from outside. */
#include "shiver/live.h"

#include <string.h>

#include "bullet_bridge/convex_overlap.h"
#include "contact/box.h"
#include "shape/collide.h"
#include "shiver/run_file.h"
#include "sim/internal.h"

/* ---- the present time ---- */

/* Whoever drives the simulation looks at it now: the frame and the events so far. */
static ShvStatus tell(ShvSimulation *simulation, ShvStatus status, ShvError *error)
{
    ShvError ignored;
    const ShvStatus filled = shv_simulation_fill(simulation, false, status == SHV_OK ? error : &ignored);
    for (int32_t i = 0; i < simulation->frame.event_count && simulation->listener; i++)
        simulation->listener(simulation->listener_data, &simulation->frame.events[i]);
    return status == SHV_OK ? filled : status;
}

/* Before a change: all before it has been told, and no rigid interval is under way. */
static ShvStatus begin(ShvSimulation *simulation, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    if (!simulation->started) SHV_TRY(shv_simulation_advance(simulation, error));
    if (hybrid->interval_end > hybrid->state.time)
        return shv_fail(error, SHV_BAD_INPUT,
                        "the simulation is in the midst of a rigid step, where shv_simulation_advance stopped for "
                        "output.fracture_every; change it after shv_simulation_step");
    shv_simulation_forget_told(simulation);
    return SHV_OK;
}

ShvStatus shv_simulation_step(ShvSimulation *simulation, double until, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    int64_t taken;
    if (!simulation->started) SHV_TRY(shv_simulation_advance(simulation, error));
    if (!isfinite(until) || until < hybrid->state.time)
        return shv_fail(error, SHV_BAD_INPUT, "cannot step to %g s from %.9g s: give a later time", until,
                        hybrid->state.time);
    shv_simulation_forget_told(simulation);
    const ShvStatus status = shv_hybrid_advance(hybrid, until, 0, &taken, error);
    shv_simulation_pass_frames(simulation);
    return tell(simulation, status, error);
}

void shv_simulation_listen(ShvSimulation *simulation, ShvListener listener, void *data)
{
    simulation->listener = listener;
    simulation->listener_data = data;
}

static ShvStatus find_fragment(const ShvSimulation *simulation, int32_t index, ShvError *error)
{
    const ShvFragments *fragments = &simulation->hybrid.fragments;
    if (index < 0 || index >= fragments->count)
        return shv_fail(error, SHV_BAD_INPUT, "there is no fragment %d, only 0 to %d", (int)index,
                        (int)fragments->count - 1);
    const ShvFragment *fragment = &fragments->items[index];
    if (shv_fragment_is_present(fragment)) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "fragment %d %s", (int)index,
                    fragment->mode == SHV_MODE_DEAD ? "has come apart; act on its children" : "is not in the scene");
}

ShvStatus shv_simulation_push(ShvSimulation *simulation, int32_t fragment, const double impulse[3],
                              const double point[3], ShvError *error)
{
    const ShvVec3 given = shv_load3(impulse), at = shv_load3(point);
    SHV_TRY(find_fragment(simulation, fragment, error));
    if (!shv_finite3(given) || !shv_finite3(at))
        return shv_fail(error, SHV_BAD_INPUT, "an impulse and its point need finite numbers");
    SHV_TRY(begin(simulation, error));
    return tell(simulation, shv_hybrid_push(&simulation->hybrid, fragment, given, at, error), error);
}

/* ---- names ---- */

static int32_t find_object(const ShvHybrid *hybrid, const char *name)
{
    for (int32_t i = 0; i < hybrid->model.object_count; i++)
        if (strcmp(hybrid->model.objects[i].name, name) == 0) return i;
    return -1;
}

static ShvStatus find_obstacle(const ShvHybrid *hybrid, const char *name, int32_t *index, ShvError *error)
{
    for (*index = 0; *index < hybrid->obstacles.count; ++*index) {
        const ShvObstacle *obstacle = &hybrid->obstacles.items[*index];
        if (strcmp(obstacle->name, name) != 0) continue;
        if (obstacle->motion == SHV_OBSTACLE_FREE) return SHV_OK;
        return shv_fail(error, SHV_BAD_INPUT, "the obstacle '%s' is not free: it is there from start to end", name);
    }
    return shv_fail(error, SHV_BAD_INPUT, "there is no object and no obstacle '%s'", name);
}

/* ---- events ---- */

/* What is not in the scene cannot be moved; other events act on all of it. */
static ShvStatus check_present(const ShvHybrid *hybrid, const ShvEventDefinition *event, ShvError *error)
{
    if (event->kind != SHV_EVENT_SET_VELOCITY && event->kind != SHV_EVENT_IMPULSE) return SHV_OK;
    const int32_t object = find_object(hybrid, event->target);
    int32_t obstacle = -1;
    bool present = false;
    if (object < 0) SHV_TRY(find_obstacle(hybrid, event->target, &obstacle, error));
    if (object < 0) present = !shv_hybrid_waits(hybrid, obstacle);
    for (int32_t i = 0; object >= 0 && i < hybrid->fragments.count; i++) {
        const ShvFragment *item = &hybrid->fragments.items[i];
        present = present || (item->object == object && shv_fragment_is_present(item));
    }
    return present ? SHV_OK : shv_fail(error, SHV_BAD_INPUT, "'%s' is not in the scene", event->target);
}

ShvStatus shv_simulation_apply(ShvSimulation *simulation, const ShvEventDefinition *event, ShvError *error)
{
    SHV_TRY(shv_simulation_check_event(simulation->scene, event, "the event", error));
    SHV_TRY(check_present(&simulation->hybrid, event, error));
    SHV_TRY(begin(simulation, error));
    return tell(simulation, shv_hybrid_apply(&simulation->hybrid, event, error), error);
}

/* ---- room ---- */

/* Tets by their corners, world. */
typedef struct Tets {
    double *corners; /* 12 a tet */
    int32_t count;
    ShvBox box;
} Tets;

static ShvVec3 corner(const Tets *tets, int32_t tet, int k)
{
    return shv_load3(tets->corners + 12 * (int64_t)tet + 3 * k);
}

/* By the four signed volumes; what lies in a face is outside. */
static bool holds(const Tets *tets, int32_t tet, ShvVec3 point)
{
    const double touch = 1e-6; /* of the tet's volume */
    static const int faces[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
    ShvVec3 c[4];
    for (int k = 0; k < 4; k++) c[k] = corner(tets, tet, k);
    const double volume = shv_dot(shv_sub(c[3], c[0]), shv_cross(shv_sub(c[1], c[0]), shv_sub(c[2], c[0])));
    for (int k = 0; k < 4; k++) {
        const ShvVec3 a = c[faces[k][0]], b = c[faces[k][1]], d = c[faces[k][2]];
        if (!(shv_dot(shv_sub(point, a), shv_cross(shv_sub(b, a), shv_sub(d, a))) > touch * volume)) return false;
    }
    return true;
}

static ShvBox box_of(const Tets *tets, int32_t tet)
{
    ShvBox box = shv_box_empty();
    for (int k = 0; k < 4; k++) shv_box_add(&box, corner(tets, tet, k));
    return box;
}

/* Which object's tets some tet of the newcomer stands in; −1: none. */
static int32_t find_overlapping_object(const ShvHybrid *hybrid, const Tets *all, const Tets *newcomer)
{
    for (int32_t e = 0; e < all->count; e++) {
        const ShvFragment *owner = &hybrid->fragments.items[hybrid->state.element_fragment[e]];
        const ShvBox box = box_of(all, e);
        if (owner->mode == SHV_MODE_BINNED || !shv_box_meets(&box, &newcomer->box)) continue;
        for (int32_t k = 0; k < newcomer->count; k++) {
            const ShvBox other = box_of(newcomer, k);
            if (!shv_box_meets(&box, &other)) continue;
            if (shv_convex_overlap(all->corners + 12 * (int64_t)e, 4, newcomer->corners + 12 * (int64_t)k, 4))
                return owner->object;
        }
    }
    return -1;
}

static bool obstacle_holds(const ShvObstacle *obstacle, const Tets *tets, int32_t tet, double touch)
{
    for (int k = 0; k < 4; k++)
        if (shv_obstacle_closest(obstacle, corner(tets, tet, k), touch).gap < -touch) return true;
    return obstacle->shape != SHV_OBSTACLE_PLANE && holds(tets, tet, obstacle->position);
}

static ShvStatus fail_overlapping(const char *name, const char *kind, const char *other, ShvError *error)
{
    return shv_fail(error, SHV_BAD_INPUT, "'%s' would stand in the %s '%s': bring it to another place", name, kind,
                    other);
}

static ShvStatus all_corners(ShvSimulation *simulation, Tets *tets, ShvError *error)
{
    *tets = (Tets){.count = simulation->hybrid.state.element_count};
    const size_t count = 12 * (size_t)tets->count;
    tets->corners = shv_allocate(simulation->memory, SHV_PART_GENERAL, count, sizeof(double));
    if (!tets->corners) return shv_fail_memory(error, "where everything stands", count * sizeof(double));
    shv_simulation_corner_positions(simulation, tets->corners);
    return SHV_OK;
}

static ShvStatus check_object_room(const ShvHybrid *hybrid, const Tets *all, const Tets *newcomer, int32_t object,
                                   ShvError *error)
{
    const char *name = hybrid->model.objects[object].name;
    const int32_t other = find_overlapping_object(hybrid, all, newcomer);
    if (other >= 0) return fail_overlapping(name, "object", hybrid->model.objects[other].name, error);
    const double touch = 1e-6 * shv_norm(shv_sub(newcomer->box.high, newcomer->box.low));
    for (int32_t i = 0; i < hybrid->obstacles.count; i++)
        for (int32_t k = 0; k < newcomer->count && !shv_hybrid_waits(hybrid, i); k++)
            if (obstacle_holds(&hybrid->obstacles.items[i], newcomer, k, touch))
                return fail_overlapping(name, "obstacle", hybrid->obstacles.items[i].name, error);
    return SHV_OK;
}

/* Where a body that waits would be. */
static ShvStatus make_newcomer(ShvSimulation *simulation, int32_t object, int32_t fragment,
                               const ShvPlacement *placement, Tets *newcomer, ShvError *error)
{
    const ShvObject *item = &simulation->hybrid.model.objects[object];
    const ShvModel *model = &simulation->hybrid.model;
    ShvFragment there = simulation->hybrid.fragments.items[fragment];
    shv_hybrid_place(&simulation->hybrid, &there, placement);
    *newcomer = (Tets){.count = item->element_end - item->element_begin, .box = shv_box_empty()};
    newcomer->corners =
        shv_allocate(simulation->memory, SHV_PART_GENERAL, 12 * (size_t)newcomer->count, sizeof(double));
    if (!newcomer->corners) return shv_fail_memory(error, "a body that comes", 96 * (size_t)newcomer->count);
    for (int64_t i = 0; i < 4 * (int64_t)newcomer->count; i++) {
        const int32_t node = model->mesh.elements[4 * (int64_t)item->element_begin + i];
        const ShvVec3 arm = shv_sub(shv_mesh_position(&model->mesh, node), there.reference_centre);
        const ShvVec3 x = shv_add(there.position, shv_rotate(there.orientation, arm));
        shv_store3(newcomer->corners + 3 * i, x);
        shv_box_add(&newcomer->box, x);
    }
    return SHV_OK;
}

/* ---- coming ---- */

static ShvStatus check_placement(const char *name, const ShvPlacement *placement, ShvError *error)
{
    const ShvVec3 axis = shv_load3(placement->rotation_axis);
    const bool turned = placement->rotation_degrees != 0.0;
    if (shv_finite3(shv_load3(placement->position)) && shv_finite3(shv_load3(placement->velocity)) &&
        shv_finite3(shv_load3(placement->angular_velocity)) && isfinite(placement->rotation_degrees) &&
        (!turned || (shv_finite3(axis) && shv_norm(axis) > 0.0)))
        return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "the placement of '%s' needs finite numbers and an axis with a direction",
                    name);
}

/* The one fragment of an object that waits whole. */
static ShvStatus find_whole(const ShvHybrid *hybrid, int32_t object, int32_t *fragment, ShvError *error)
{
    const char *name = hybrid->model.objects[object].name;
    int32_t count = 0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *item = &hybrid->fragments.items[i];
        if (item->object != object || item->mode == SHV_MODE_DEAD) continue;
        if (item->mode != SHV_MODE_BINNED) return shv_fail(error, SHV_BAD_INPUT, "'%s' is in the scene already", name);
        *fragment = i;
        count += 1 + item->cracked;
    }
    if (count == 1) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "'%s' is broken: only a whole object can come back", name);
}

static ShvStatus enter_object(ShvSimulation *simulation, int32_t object, const ShvPlacement *placement, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    int32_t fragment = -1;
    SHV_TRY(find_whole(hybrid, object, &fragment, error));
    Tets all = {.count = 0}, newcomer = {.count = 0};
    ShvStatus status = all_corners(simulation, &all, error);
    if (status == SHV_OK) status = make_newcomer(simulation, object, fragment, placement, &newcomer, error);
    if (status == SHV_OK) status = check_object_room(hybrid, &all, &newcomer, object, error);
    if (status == SHV_OK) status = shv_hybrid_enter_fragment(hybrid, fragment, placement, error);
    shv_release(newcomer.corners);
    shv_release(all.corners);
    return status;
}

static ShvStatus check_obstacle_room(ShvSimulation *simulation, const ShvObstacle *newcomer, ShvError *error)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    Tets all;
    SHV_TRY(all_corners(simulation, &all, error));
    const double touch = 1e-6 * newcomer->bounding_radius;
    ShvStatus status = SHV_OK;
    for (int32_t e = 0; e < all.count && status == SHV_OK; e++) {
        const ShvFragment *owner = &hybrid->fragments.items[hybrid->state.element_fragment[e]];
        if (owner->mode != SHV_MODE_BINNED && obstacle_holds(newcomer, &all, e, touch))
            status = fail_overlapping(newcomer->name, "object", hybrid->model.objects[owner->object].name, error);
    }
    shv_release(all.corners);
    for (int32_t i = 0; i < hybrid->obstacles.count && status == SHV_OK; i++) {
        const ShvObstacle *other = &hybrid->obstacles.items[i];
        ShvBodyContact deepest;
        if (!shv_hybrid_waits(hybrid, i) && shv_collide_overlap(&hybrid->obstacles, newcomer, other, touch, &deepest))
            status = fail_overlapping(newcomer->name, "obstacle", other->name, error);
    }
    return status;
}

static ShvStatus enter_obstacle(ShvSimulation *simulation, int32_t index, const ShvPlacement *placement,
                                ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    ShvObstacle there = hybrid->obstacles.items[index];
    if (!shv_hybrid_waits(hybrid, index))
        return shv_fail(error, SHV_BAD_INPUT, "'%s' is in the scene already", there.name);
    shv_hybrid_place_obstacle(&there, placement);
    SHV_TRY(check_obstacle_room(simulation, &there, error));
    shv_hybrid_enter_obstacle(hybrid, index, placement);
    return SHV_OK;
}

ShvStatus shv_simulation_enter(ShvSimulation *simulation, const char *name, const ShvPlacement *placement,
                               ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    const int32_t object = find_object(hybrid, name);
    int32_t obstacle = -1;
    if (object < 0) SHV_TRY(find_obstacle(hybrid, name, &obstacle, error));
    SHV_TRY(check_placement(name, placement, error));
    SHV_TRY(begin(simulation, error));
    SHV_TRY(shv_hybrid_observe(hybrid, error));
    SHV_TRY(object >= 0 ? enter_object(simulation, object, placement, error)
                        : enter_obstacle(simulation, obstacle, placement, error));
    return tell(simulation, SHV_OK, error);
}

/* ---- going ---- */

static ShvStatus can_leave(const ShvHybrid *hybrid, int32_t fragment, ShvError *error)
{
    const ShvFragment *item = &hybrid->fragments.items[fragment];
    if (item->mode != SHV_MODE_FRACTURE) return SHV_OK;
    return shv_fail(error, SHV_UNSUPPORTED,
                    "fragment %d of '%s' is in fracture mode and cannot leave: step on until it flies or rests",
                    (int)fragment, hybrid->model.objects[item->object].name);
}

static ShvStatus leave_object(ShvHybrid *hybrid, int32_t object, ShvError *error)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (hybrid->fragments.items[i].object == object) SHV_TRY(can_leave(hybrid, i, error));
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *item = &hybrid->fragments.items[i];
        if (item->object == object && item->mode == SHV_MODE_FLIGHT) shv_hybrid_leave_fragment(hybrid, i);
    }
    return SHV_OK;
}

ShvStatus shv_simulation_leave(ShvSimulation *simulation, const char *name, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    const int32_t object = find_object(hybrid, name);
    int32_t obstacle = -1;
    if (object < 0) SHV_TRY(find_obstacle(hybrid, name, &obstacle, error));
    SHV_TRY(begin(simulation, error));
    SHV_TRY(shv_hybrid_observe(hybrid, error));
    if (object >= 0)
        SHV_TRY(leave_object(hybrid, object, error));
    else if (!shv_hybrid_waits(hybrid, obstacle))
        SHV_TRY(shv_hybrid_leave_obstacle(hybrid, obstacle, error));
    return tell(simulation, SHV_OK, error);
}

ShvStatus shv_simulation_remove(ShvSimulation *simulation, int32_t fragment, ShvError *error)
{
    SHV_TRY(find_fragment(simulation, fragment, error));
    SHV_TRY(can_leave(&simulation->hybrid, fragment, error));
    SHV_TRY(begin(simulation, error));
    SHV_TRY(shv_hybrid_observe(&simulation->hybrid, error));
    shv_hybrid_leave_fragment(&simulation->hybrid, fragment);
    return tell(simulation, SHV_OK, error);
}

/* ---- for other languages ---- */

size_t shv_struct_size(const char *name)
{
#define ENTRY(type)                                                                                                    \
    {                                                                                                                  \
#type, sizeof(type)                                                                                            \
    }
    static const struct {
        const char *name;
        size_t size;
    } entries[] = {ENTRY(ShvError),
                   ENTRY(ShvFragmentView),
                   ENTRY(ShvObstacleView),
                   ENTRY(ShvEventView),
                   ENTRY(ShvLedgerView),
                   ENTRY(ShvFrameView),
                   ENTRY(ShvMeshView),
                   ENTRY(ShvObjectView),
                   ENTRY(ShvPlacement),
                   ENTRY(ShvSimulationSummary),
                   ENTRY(ShvEventDefinition),
                   ENTRY(ShvSimulationOptions),
                   ENTRY(ShvRecordDefinition),
                   ENTRY(ShvRunFileInfo)};
#undef ENTRY
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++)
        if (strcmp(entries[i].name, name) == 0) return entries[i].size;
    return 0;
}
