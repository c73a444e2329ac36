#include "probes/probes.h"

#include <math.h>
#include <string.h>

#include "base/sorted.h"
#include "conditions/condition_selection.h"

/* ---- choosing ---- */

static ShvStatus take_elements(ShvSampledProbe *probe, ShvMemory *memory, int32_t count, ShvError *error)
{
    const size_t room = (size_t)count;
    probe->element_count = count;
    probe->elements = shv_allocate(memory, SHV_PART_RECORD, room, sizeof(int32_t));
    probe->corner_shares = shv_allocate(memory, SHV_PART_RECORD, 4 * room, sizeof(double));
    probe->stress_shares = shv_allocate(memory, SHV_PART_RECORD, room, sizeof(double));
    if (probe->elements && probe->corner_shares && probe->stress_shares) return SHV_OK;
    return shv_fail_memory(error, "the tets of a probe", room * 44);
}

static const ShvObject *find_object(const ShvModel *model, const char *name)
{
    for (int32_t i = 0; i < model->object_count; i++)
        if (strcmp(model->objects[i].name, name) == 0) return &model->objects[i];
    return NULL;
}

static double volume_of(ShvVec3 a, ShvVec3 b, ShvVec3 c, ShvVec3 d)
{
    return shv_dot(shv_sub(b, a), shv_cross(shv_sub(c, a), shv_sub(d, a)));
}

/* Barycentric coordinates of a point in a tet; returns the smallest, below 0 outside. */
static double barycentric(const ShvMesh *mesh, int32_t element, ShvVec3 point, double shares[4])
{
    ShvVec3 x[4];
    for (int a = 0; a < 4; a++) x[a] = shv_mesh_position(mesh, mesh->elements[4 * (int64_t)element + a]);
    const double whole = volume_of(x[0], x[1], x[2], x[3]);
    double least = HUGE_VAL;
    for (int a = 0; a < 4; a++) {
        ShvVec3 moved[4] = {x[0], x[1], x[2], x[3]};
        moved[a] = point;
        shares[a] = volume_of(moved[0], moved[1], moved[2], moved[3]) / whole;
        least = fmin(least, shares[a]);
    }
    return least;
}

/* The tet that holds the point deepest; a point on a face shared by several belongs to the first of them. */
static ShvStatus find_point(ShvSampledProbe *probe, const ShvModel *model, ShvError *error)
{
    const ShvProbeDefinition *definition = probe->definition;
    const ShvVec3 point = shv_load3(definition->point);
    const ShvObject *object = definition->object ? find_object(model, definition->object) : NULL;
    const double rounding = 1e-9;
    if (!shv_finite3(point)) return shv_fail(error, SHV_BAD_INPUT, "its point is not finite");
    if (definition->object && !object)
        return shv_fail(error, SHV_BAD_INPUT, "there is no object named '%s'", definition->object);
    const int32_t begin = object ? object->element_begin : 0,
                  end = object ? object->element_end : model->mesh.element_count;
    SHV_TRY(take_elements(probe, model->memory, 1, error));
    double best = -HUGE_VAL;
    for (int32_t e = begin; e < end && best < -rounding; e++) {
        double shares[4];
        const double least = barycentric(&model->mesh, e, point, shares);
        if (!(least > best)) continue;
        best = least;
        probe->elements[0] = e;
        memcpy(probe->corner_shares, shares, sizeof shares);
    }
    probe->stress_shares[0] = 1.0;
    if (best >= -rounding) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "the point (%g, %g, %g) m lies in no tet of %s%s at the start; move it inside", point.x, point.y,
                    point.z, object ? "object " : "any object", object ? object->name : "");
}

static bool is_chosen(const ShvSampledProbe *probe, int32_t origin)
{
    return shv_sorted_contains(probe->origins, probe->origin_count, origin);
}

static int chosen_corners(const ShvSampledProbe *probe, const ShvModel *model, int32_t element)
{
    int bits = 0;
    for (int a = 0; a < 4; a++)
        if (is_chosen(probe, model->mesh.elements[4 * (int64_t)element + a])) bits |= 1 << a;
    return bits;
}

/* A corner counts by its share of the tet's mass: the mean over corners is the mean over nodes and copies by mass. */
static void share_out(ShvSampledProbe *probe, const ShvModel *model, const ShvObject *object, const ShvState *state)
{
    double mass = 0.0, volume = 0.0;
    int32_t k = 0;
    for (int32_t e = object->element_begin; e < object->element_end; e++) {
        const int bits = chosen_corners(probe, model, e);
        if (bits == 0) continue;
        probe->elements[k] = e;
        probe->stress_shares[k] = shv_mesh_element_volume(&model->mesh, e);
        volume += probe->stress_shares[k];
        for (int a = 0; a < 4; a++) {
            probe->corner_shares[4 * (int64_t)k + a] = bits >> a & 1 ? state->element_mass[e] : 0.0;
            mass += probe->corner_shares[4 * (int64_t)k + a];
        }
        k++;
    }
    for (int32_t i = 0; i < k; i++) {
        probe->stress_shares[i] /= volume;
        for (int a = 0; a < 4; a++) probe->corner_shares[4 * (int64_t)i + a] /= mass;
    }
}

static ShvStatus find_nodes(ShvSampledProbe *probe, const ShvModel *model, const ShvState *state, ShvError *error)
{
    const ShvProbeDefinition *definition = probe->definition;
    const ShvObject *object = find_object(model, definition->object ? definition->object : "");
    if (!object)
        return shv_fail(error, SHV_BAD_INPUT, "there is no object named '%s'",
                        definition->object ? definition->object : "");
    SHV_TRY(shv_selection_nodes(&definition->selection, model, object, &probe->origins, &probe->origin_count, error));
    int32_t count = 0;
    for (int32_t e = object->element_begin; e < object->element_end; e++) count += chosen_corners(probe, model, e) != 0;
    SHV_TRY(take_elements(probe, model->memory, count, error));
    share_out(probe, model, object, state);
    return SHV_OK;
}

static ShvStatus find_obstacle(ShvSampledProbe *probe, const ShvObstacles *obstacles, ShvError *error)
{
    const char *name = probe->definition->obstacle ? probe->definition->obstacle : "";
    for (int32_t i = 0; i < obstacles->count; i++) {
        if (strcmp(obstacles->items[i].name, name) != 0) continue;
        probe->obstacle = i;
        probe->start = obstacles->items[i].position;
        return SHV_OK;
    }
    return shv_fail(error, SHV_BAD_INPUT, "there is no obstacle named '%s'", name);
}

static ShvStatus make_probe(ShvSampledProbe *probe, const ShvModel *model, const ShvObstacles *obstacles,
                            const ShvState *state, ShvError *error)
{
    const ShvProbeDefinition *definition = probe->definition;
    if (definition->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "it did not start from shv_probe_default()");
    if (!definition->name || !definition->name[0])
        return shv_fail(error, SHV_BAD_INPUT, "it has no name; give one, by which its values are found");
    if (definition->kind == SHV_PROBE_POINT) return find_point(probe, model, error);
    if (definition->kind == SHV_PROBE_NODES) return find_nodes(probe, model, state, error);
    return find_obstacle(probe, obstacles, error);
}

static ShvStatus make_all(ShvProbes *probes, const ShvModel *model, const ShvSceneDefinition *scene,
                          const ShvObstacles *obstacles, const ShvState *state, ShvError *error)
{
    const size_t count = (size_t)scene->probe_count;
    probes->items = shv_allocate(probes->memory, SHV_PART_RECORD, count, sizeof *probes->items);
    if (!probes->items) return shv_fail_memory(error, "the probes", count * sizeof *probes->items);
    for (int32_t i = 0; i < scene->probe_count; i++) {
        const ShvProbeDefinition *definition = &scene->probes[i];
        probes->count = i + 1;
        probes->items[i] = (ShvSampledProbe){.definition = definition, .obstacle = -1};
        const ShvStatus status = make_probe(&probes->items[i], model, obstacles, state, error);
        if (status != SHV_OK)
            return shv_fail_within(error, status, "probe %s", definition->name ? definition->name : "without a name");
    }
    return SHV_OK;
}

ShvStatus shv_probes_create(ShvProbes *probes, const ShvModel *model, const ShvSceneDefinition *scene,
                            const ShvObstacles *obstacles, const ShvState *state, ShvError *error)
{
    *probes = (ShvProbes){
        .memory = model->memory, .every = scene->output.probe_every, .interval = scene->output.probe_interval};
    if (scene->probe_count == 0) return SHV_OK;
    const ShvStatus status = make_all(probes, model, scene, obstacles, state, error);
    if (status != SHV_OK) shv_probes_release(probes);
    return status;
}

void shv_probes_release(ShvProbes *probes)
{
    for (int32_t i = 0; i < probes->count; i++) {
        shv_release(probes->items[i].elements);
        shv_release(probes->items[i].corner_shares);
        shv_release(probes->items[i].stress_shares);
        shv_release(probes->items[i].origins);
    }
    shv_release(probes->items);
    shv_release(probes->times);
    shv_release(probes->samples);
    *probes = (ShvProbes){0};
}

/* ---- rows ---- */

static const ShvProbeSample unknown = {{(double)NAN, (double)NAN, (double)NAN},
                                       {(double)NAN, (double)NAN, (double)NAN},
                                       {(double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN},
                                       {(double)NAN, (double)NAN, (double)NAN},
                                       {(double)NAN, (double)NAN, (double)NAN}};

static ShvProbeSample *last_row(const ShvProbes *probes)
{
    return probes->samples + (probes->rows - 1) * probes->count;
}

static ShvStatus append_row(ShvProbes *probes, double time, ShvError *error)
{
    if (probes->rows == probes->capacity) {
        const int64_t capacity = 2 * probes->capacity + 64;
        const size_t room = (size_t)capacity * (size_t)probes->count;
        double *times = shv_reallocate(probes->memory, SHV_PART_RECORD, probes->times, (size_t)capacity, sizeof *times);
        if (times) probes->times = times;
        ShvProbeSample *samples =
            shv_reallocate(probes->memory, SHV_PART_RECORD, probes->samples, room, sizeof *samples);
        if (samples) probes->samples = samples;
        if (!times || !samples) return shv_fail_memory(error, "samples of probes", room * sizeof *samples);
        probes->capacity = capacity;
    }
    probes->times[probes->rows++] = time;
    ShvProbeSample *row = last_row(probes);
    for (int32_t i = 0; i < probes->count; i++) row[i] = unknown;
    return SHV_OK;
}

/* Of the interval between samples: rounding of times. */
static const double rounding_of_interval = 1e-9;

bool shv_probes_due(ShvProbes *probes, const ShvState *state)
{
    if (probes->count == 0) return false;
    if (!(probes->interval > 0.0)) return state->step % probes->every == 0;
    const double rounding = rounding_of_interval * probes->interval;
    if (state->time < probes->next_time - rounding) return false;
    probes->next_time = (floor((state->time + rounding) / probes->interval) + 1.0) * probes->interval;
    return true;
}

/* ---- fracture mode ---- */

static bool is_awake(const ShvSampledProbe *probe, const ShvState *state, const uint8_t *awake)
{
    for (int32_t k = 0; k < probe->element_count; k++)
        if (!awake[state->element_fragment[probe->elements[k]]]) return false;
    return true;
}

/* Mean over the corners of one of the state's vectors. */
static ShvVec3 mean_of(const ShvSampledProbe *probe, const ShvState *state, const double *vectors)
{
    ShvVec3 sum = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t k = 0; k < probe->element_count; k++)
        for (int a = 0; a < 4; a++) {
            const double share = probe->corner_shares[4 * (int64_t)k + a];
            if (share == 0.0) continue;
            const int32_t node = shv_state_node(state, probe->elements[k], a);
            sum = shv_madd(sum, share, shv_load3(vectors + 3 * (int64_t)node));
        }
    return sum;
}

static void mean_stress(const ShvSampledProbe *probe, const ShvProbeScene *scene, double voigt[6])
{
    _Alignas(64) double stress[6 * SHV_LANES];
    int32_t known = -1;
    for (int c = 0; c < 6; c++) voigt[c] = 0.0;
    for (int32_t k = 0; k < probe->element_count; k++) {
        const int32_t element = probe->elements[k], batch = element / SHV_LANES;
        if (batch != known) shv_solid_batch_stress(scene->solid, scene->state, batch, stress);
        known = batch;
        for (int c = 0; c < 6; c++) voigt[c] += probe->stress_shares[k] * stress[c * SHV_LANES + element % SHV_LANES];
    }
}

ShvStatus shv_probes_begin(ShvProbes *probes, const ShvProbeScene *scene, const uint8_t *awake, ShvError *error)
{
    const ShvState *state = scene->state;
    SHV_TRY(append_row(probes, state->time, error));
    for (int32_t i = 0; i < probes->count; i++) {
        const ShvSampledProbe *probe = &probes->items[i];
        ShvProbeSample *sample = &last_row(probes)[i];
        if (probe->obstacle >= 0) {
            const ShvObstacle *obstacle = &scene->obstacles->items[probe->obstacle];
            shv_store3(sample->displacement, shv_sub(obstacle->position, probe->start));
            shv_store3(sample->velocity, obstacle->velocity);
        } else if (is_awake(probe, state, awake)) {
            shv_store3(sample->displacement, mean_of(probe, state, state->displacement));
            shv_store3(sample->velocity, mean_of(probe, state, state->velocity));
            mean_stress(probe, scene, sample->stress);
        }
    }
    return SHV_OK;
}

static bool is_touched(const ShvSampledProbe *probe, const ShvState *state, int32_t node, int32_t obstacle)
{
    return probe->obstacle >= 0 ? obstacle == probe->obstacle : is_chosen(probe, state->origin[node]);
}

/* N·s on the probe's nodes by obstacles, other bodies and faces of cracks that meet again; or by its obstacle on all that it meets. */
static ShvVec3 contact_impulse(const ShvSampledProbe *probe, const ShvSurfaceContact *contact, const ShvRelax *relax,
                               const ShvState *state)
{
    ShvVec3 impulse = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t k = 0; relax && k < relax->touch_count; k++) {
        const ShvRelaxTouch *touch = &relax->touches[k];
        if (touch->push > 0.0 && is_touched(probe, state, touch->node, touch->obstacle))
            impulse = shv_add(impulse, shv_add(touch->friction, touch->impulse));
    }
    for (int32_t k = 0; k < contact->pair_count; k++) {
        const ShvFacetPair *pair = &contact->pairs[k];
        const ShvVec3 given = shv_madd(pair->friction, pair->normal_impulse, pair->normal);
        for (int c = 0; c < pair->node_count; c++)
            if (is_touched(probe, state, pair->nodes[c], -1 - pair->element))
                impulse = shv_madd(impulse, pair->shares[c], given);
        for (int c = 0; c < 3 && pair->element >= 0 && probe->obstacle < 0; c++)
            if (is_chosen(probe, state->origin[pair->corners[c]]))
                impulse = shv_add(impulse, shv_facet_pair_share(pair, c, given));
    }
    return impulse;
}

static ShvVec3 reaction(const ShvSampledProbe *probe, const ShvImposed *imposed, const ShvState *state, double kick)
{
    ShvVec3 impulse = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t c = 0; c < imposed->count; c++) {
        const ShvImposedCondition *condition = &imposed->items[c];
        if (!shv_imposed_in_force(condition, state->time)) continue;
        for (int32_t k = 0; k < condition->node_count; k++)
            if (is_chosen(probe, state->origin[condition->nodes[k]]))
                impulse = shv_add(impulse, shv_load3(condition->impulse + 3 * (int64_t)k));
    }
    return shv_scale(impulse, 1.0 / kick);
}

/* The acceleration is that of the whole kick: v(n) = v(n−1/2) + (v(n+1/2) − v(n−1/2)) dt₋/(dt₋ + dt₊). */
static void synchronise(double velocity[3], ShvVec3 after, double share)
{
    const ShvVec3 before = shv_load3(velocity);
    shv_store3(velocity, shv_madd(before, share, shv_sub(after, before)));
}

void shv_probes_end(ShvProbes *probes, const ShvProbeScene *scene, double before, double after,
                    const ShvSurfaceContact *contact, const ShvRelax *relax, const ShvImposed *imposed)
{
    const ShvState *state = scene->state;
    const double kick = 0.5 * (before + after), share = before / (before + after);
    for (int32_t i = 0; i < probes->count; i++) {
        const ShvSampledProbe *probe = &probes->items[i];
        ShvProbeSample *sample = &last_row(probes)[i];
        const bool obstacle = probe->obstacle >= 0;
        if (!obstacle && isnan(sample->displacement[0])) continue;
        synchronise(sample->velocity,
                    obstacle ? scene->obstacles->items[probe->obstacle].velocity
                             : mean_of(probe, state, state->velocity),
                    share);
        if (probe->definition->kind != SHV_PROBE_POINT) {
            const ShvVec3 impulse = contact_impulse(probe, contact, relax, state);
            shv_store3(sample->contact, shv_scale(impulse, (obstacle ? -1.0 : 1.0) / kick));
        }
        if (probe->definition->kind == SHV_PROBE_NODES)
            shv_store3(sample->reaction, reaction(probe, imposed, state, kick));
    }
}

/* ---- flight ---- */

static bool flies(const ShvFragment *fragment)
{
    return fragment->mode != SHV_MODE_FRACTURE;
}

static bool any_flies(const ShvSampledProbe *probe, const ShvProbeScene *scene)
{
    for (int32_t k = 0; k < probe->element_count; k++)
        if (flies(&scene->fragments->items[scene->state->element_fragment[probe->elements[k]]])) return true;
    return false;
}

/* Displacement and velocity of one corner, where its fragment is rigid or where the state has it. */
static void corner_motion(const ShvProbeScene *scene, int32_t element, int corner, bool keeps_nodes,
                          ShvVec3 *displacement, ShvVec3 *velocity)
{
    const ShvState *state = scene->state;
    const ShvFragment *fragment = &scene->fragments->items[state->element_fragment[element]];
    const int64_t i = 3 * (int64_t)shv_state_node(state, element, corner);
    *displacement = shv_load3(state->displacement + i);
    *velocity = shv_load3(state->velocity + i);
    if (!flies(fragment) || keeps_nodes) return;
    const ShvVec3 reference = shv_load3(state->reference + i);
    const ShvVec3 arm = shv_rotate(fragment->orientation, shv_sub(reference, fragment->reference_centre));
    *displacement = shv_sub(shv_add(fragment->position, arm), reference);
    *velocity = shv_velocity_at(fragment->velocity, fragment->angular_velocity, arm);
}

static void sample_flight(const ShvSampledProbe *probe, const ShvProbeScene *scene, bool keeps_nodes,
                          ShvProbeSample *sample)
{
    ShvVec3 displacement = shv_vec3(0.0, 0.0, 0.0), velocity = displacement;
    for (int32_t k = 0; k < probe->element_count; k++)
        for (int a = 0; a < 4; a++) {
            ShvVec3 u, v;
            const double share = probe->corner_shares[4 * (int64_t)k + a];
            if (share == 0.0) continue;
            corner_motion(scene, probe->elements[k], a, keeps_nodes, &u, &v);
            displacement = shv_madd(displacement, share, u);
            velocity = shv_madd(velocity, share, v);
        }
    shv_store3(sample->displacement, displacement);
    shv_store3(sample->velocity, velocity);
}

ShvStatus shv_probes_fly(ShvProbes *probes, const ShvProbeScene *scene, bool none_awake, bool keeps_nodes,
                         ShvError *error)
{
    bool any = none_awake && probes->count > 0;
    for (int32_t i = 0; i < probes->count; i++) any = any || any_flies(&probes->items[i], scene);
    if (!any) return SHV_OK;
    SHV_TRY(append_row(probes, scene->state->time, error));
    for (int32_t i = 0; i < probes->count; i++) {
        const ShvSampledProbe *probe = &probes->items[i];
        ShvProbeSample *sample = &last_row(probes)[i];
        if (probe->obstacle >= 0 && none_awake) {
            const ShvObstacle *obstacle = &scene->obstacles->items[probe->obstacle];
            shv_store3(sample->displacement, shv_sub(obstacle->position, probe->start));
            shv_store3(sample->velocity, obstacle->velocity);
        } else if (probe->obstacle < 0 && any_flies(probe, scene)) {
            sample_flight(probe, scene, keeps_nodes, sample);
        }
    }
    return SHV_OK;
}
