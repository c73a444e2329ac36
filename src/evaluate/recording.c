#include "evaluate/recording.h"

#include <math.h>
#include <string.h>

#include "base/ledger_fields.h"

void shv_recording_release(ShvRecording *recording)
{
    shv_release(recording->probe_times);
    shv_release(recording->samples);
    shv_release(recording->frame_times);
    shv_release(recording->frames);
    shv_release(recording->preflights);
    shv_release(recording->piece_masses);
    *recording = (ShvRecording){0};
}

ShvStatus shv_recording_start(ShvRecording *recording, ShvMemory *memory, const ShvSimulation *simulation,
                              ShvError *error)
{
    *recording = (ShvRecording){.memory = memory, .object_count = shv_simulation_object_count(simulation)};
    recording->preflights =
        shv_allocate(memory, SHV_PART_RECORD, (size_t)recording->object_count, sizeof *recording->preflights);
    if (!recording->preflights) return shv_fail_memory(error, "a recording", 0);
    for (int32_t i = 0; i < recording->object_count; i++)
        SHV_TRY(shv_simulation_preflight(simulation, i, &recording->preflights[i], error));
    return SHV_OK;
}

/* Room for `wanted` entries of both blocks. */
static ShvStatus grow(ShvMemory *memory, double **times, void **entries, size_t entry_size, int64_t *capacity,
                      int64_t wanted, ShvError *error)
{
    if (wanted <= *capacity) return SHV_OK;
    const size_t room = 2 * (size_t)wanted + 64;
    double *grown_times = shv_reallocate(memory, SHV_PART_RECORD, *times, room, sizeof(double));
    if (grown_times) *times = grown_times;
    void *grown = shv_reallocate(memory, SHV_PART_RECORD, *entries, room, entry_size);
    if (grown) *entries = grown;
    if (!grown_times || !grown) return shv_fail_memory(error, "a recording", room * entry_size);
    *capacity = (int64_t)room;
    return SHV_OK;
}

static ShvStatus add_rows(ShvRecording *recording, const ShvFrameView *frame, ShvError *error)
{
    const size_t row = (size_t)frame->probe_count * sizeof(ShvProbeSample);
    recording->probe_count = frame->probe_count;
    recording->probes = frame->probes;
    if (frame->probe_row_count == 0 || row == 0) return SHV_OK;
    void *samples = recording->samples;
    const ShvStatus status = grow(recording->memory, &recording->probe_times, &samples, row, &recording->row_capacity,
                                  recording->rows + frame->probe_row_count, error);
    recording->samples = samples;
    if (status != SHV_OK) return status;
    memcpy(recording->probe_times + recording->rows, frame->probe_times,
           (size_t)frame->probe_row_count * sizeof(double));
    memcpy((char *)samples + (size_t)recording->rows * row, frame->probe_samples, (size_t)frame->probe_row_count * row);
    recording->rows += frame->probe_row_count;
    return SHV_OK;
}

ShvStatus shv_recording_add(ShvRecording *recording, const ShvSimulation *simulation, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    SHV_TRY(add_rows(recording, frame, error));
    void *frames = recording->frames;
    const ShvStatus status = grow(recording->memory, &recording->frame_times, &frames, sizeof *recording->frames,
                                  &recording->frame_capacity, recording->frame_count + 1, error);
    recording->frames = frames;
    if (status != SHV_OK) return status;
    recording->frame_times[recording->frame_count] = frame->time;
    recording->frames[recording->frame_count++] =
        (ShvRecordedFrame){frame->ledger, frame->step,        frame->courant,      frame->inserted,
                           frame->failed, frame->alive_count, (double)frame->steps};
    return SHV_OK;
}

ShvStatus shv_recording_finish(ShvRecording *recording, const ShvSimulation *simulation, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    recording->worst_overshoot = frame->worst_overshoot;
    recording->piece_masses =
        shv_allocate(recording->memory, SHV_PART_RECORD, (size_t)frame->fragment_count, sizeof(double));
    if (!recording->piece_masses) return shv_fail_memory(error, "a recording", 0);
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        if (fragment->mode == SHV_FRAGMENT_DEAD) continue;
        recording->piece_masses[recording->pieces++] = fragment->mass;
        recording->mass += fragment->mass;
        recording->largest_mass = fmax(recording->largest_mass, fragment->mass);
    }
    return shv_simulation_crack(simulation, &recording->crack, error);
}

/* ---- names ---- */

static const char *const axes[] = {"x", "y", "z"};

/* "displacement.x" … of a sample: index of the double, or −1. */
static int sample_index(const char *name)
{
    static const char *const vectors[] = {"displacement", "velocity", "contact", "reaction"};
    static const int begins[] = {0, 3, 12, 15};
    static const char *const voigt[] = {"stress.xx", "stress.yy", "stress.zz", "stress.yz", "stress.xz", "stress.xy"};
    for (int i = 0; i < 6; i++)
        if (strcmp(name, voigt[i]) == 0) return 6 + i;
    for (int i = 0; i < 4; i++) {
        const size_t length = strlen(vectors[i]);
        if (strncmp(name, vectors[i], length) != 0 || name[length] != '.') continue;
        for (int axis = 0; axis < 3; axis++)
            if (strcmp(name + length + 1, axes[axis]) == 0) return begins[i] + axis;
    }
    return -1;
}

/* The rest of `name` behind "prefix.", or NULL. */
static const char *behind(const char *name, const char *prefix)
{
    const size_t length = strlen(prefix);
    return strncmp(name, prefix, length) == 0 && name[length] == '.' ? name + length + 1 : NULL;
}

static bool make_series(ShvPool *pool, const double *times, int64_t count, const char *begin, size_t stride,
                        ShvFormulaValue *value)
{
    double *values = shv_pool_take(pool, (size_t)count, sizeof *values);
    if (!values) return false;
    for (int64_t i = 0; i < count; i++) memcpy(&values[i], begin + (size_t)i * stride, sizeof values[i]);
    *value = (ShvFormulaValue){.series = true, .times = times, .values = values, .count = count};
    return true;
}

static bool find_probe(const ShvRecording *recording, ShvPool *pool, const char *name, ShvFormulaValue *value)
{
    for (int32_t i = 0; i < recording->probe_count; i++) {
        const char *rest = behind(name, recording->probes[i].name);
        const int index = rest ? sample_index(rest) : -1;
        if (index < 0) continue;
        const char *begin = (const char *)(recording->samples + i) + (size_t)index * sizeof(double);
        return make_series(pool, recording->probe_times, recording->rows, begin,
                           (size_t)recording->probe_count * sizeof(ShvProbeSample), value);
    }
    return false;
}

typedef struct Field {
    const char *name;
    size_t offset;
    bool vector; /* three numbers: name.x, name.y, name.z */
} Field;

/* Offset of the number that a field's name stands for. */
static bool find_field(const Field *fields, size_t count, const char *name, size_t *offset)
{
    for (size_t i = 0; i < count; i++) {
        if (!fields[i].vector && strcmp(fields[i].name, name) == 0) {
            *offset = fields[i].offset;
            return true;
        }
        const char *axis = fields[i].vector ? behind(name, fields[i].name) : NULL;
        for (size_t k = 0; axis && k < 3; k++) {
            if (strcmp(axis, axes[k]) != 0) continue;
            *offset = fields[i].offset + k * sizeof(double);
            return true;
        }
    }
    return false;
}
#define COUNT(array) (sizeof(array) / sizeof *(array))

#define NUMBER(member) {#member, offsetof(ShvRecordedFrame, ledger.member), false},
#define VECTOR(member) {#member, offsetof(ShvRecordedFrame, ledger.member), true},
static const Field ledger_fields[] = {SHV_LEDGER_FIELDS(NUMBER, VECTOR)};
#undef NUMBER
#undef VECTOR
#define FRAME(member)                                                                                                  \
    {                                                                                                                  \
#member, offsetof(ShvRecordedFrame, member), false                                                             \
    }
static const Field frame_fields[] = {FRAME(step),   FRAME(courant), FRAME(inserted),
                                     FRAME(failed), FRAME(alive),   FRAME(steps)};

static bool find_frame(const ShvRecording *recording, ShvPool *pool, const char *name, ShvFormulaValue *value)
{
    size_t offset;
    const char *of_ledger = behind(name, "ledger"), *of_frame = behind(name, "frame");
    if (!(of_ledger && find_field(ledger_fields, COUNT(ledger_fields), of_ledger, &offset)) &&
        !(of_frame && find_field(frame_fields, COUNT(frame_fields), of_frame, &offset)))
        return false;
    return make_series(pool, recording->frame_times, recording->frame_count, (const char *)recording->frames + offset,
                       sizeof *recording->frames, value);
}

#define END(member)                                                                                                    \
    {                                                                                                                  \
#member, offsetof(ShvRecording, member), false                                                                 \
    }
static const Field end_fields[] = {END(largest_mass),
                                   END(mass),
                                   END(worst_overshoot),
                                   END(wall_seconds),
                                   {"crack_origin", offsetof(ShvRecording, crack.origin), true},
                                   {"crack_centre", offsetof(ShvRecording, crack.centre), true},
                                   {"crack_normal", offsetof(ShvRecording, crack.normal), true}};

static bool find_end(const ShvRecording *recording, const char *name, ShvFormulaValue *value)
{
    size_t offset;
    const char *rest = behind(name, "end");
    if (!rest) return false;
    *value = (ShvFormulaValue){.number = recording->pieces};
    if (strcmp(rest, "fragments") == 0) return true;
    value->number = recording->crack.facets;
    if (strcmp(rest, "crack_facets") == 0) return true;
    if (!find_field(end_fields, COUNT(end_fields), rest, &offset)) return false;
    memcpy(&value->number, (const char *)recording + offset, sizeof value->number);
    return true;
}

/* ---- the scene's own numbers ---- */

#define MATERIAL(member)                                                                                               \
    {                                                                                                                  \
#member, offsetof(ShvMaterialDefinition, member), false                                                        \
    }
static const Field material_fields[] = {MATERIAL(density),
                                        MATERIAL(youngs_modulus),
                                        MATERIAL(poissons_ratio),
                                        MATERIAL(fracture_energy),
                                        MATERIAL(cohesive_strength),
                                        MATERIAL(fracture_energy_shear),
                                        MATERIAL(cohesive_strength_shear),
                                        MATERIAL(ppr_shape),
                                        MATERIAL(ppr_shape_shear),
                                        MATERIAL(weibull_modulus),
                                        MATERIAL(weibull_volume)};
#define OBJECT(name, member, vector)                                                                                   \
    {                                                                                                                  \
        name, offsetof(ShvObjectDefinition, member), vector                                                            \
    }
static const Field object_fields[] = {OBJECT("size", mesh.size, true),
                                      OBJECT("radius", mesh.radius, false),
                                      OBJECT("inner_radius", mesh.inner_radius, false),
                                      OBJECT("height", mesh.height, false),
                                      OBJECT("edge", mesh.edge, false),
                                      OBJECT("notch_depth", mesh.notch_depth, false),
                                      OBJECT("notch_offset", mesh.notch_offset, false),
                                      OBJECT("position", placement.position, true),
                                      OBJECT("rotation_degrees", placement.rotation_degrees, false),
                                      OBJECT("velocity", placement.velocity, true),
                                      OBJECT("angular_velocity", placement.angular_velocity, true),
                                      OBJECT("stretch_rate", placement.stretch_rate, true)};
#define PREFLIGHT(member)                                                                                              \
    {                                                                                                                  \
#member, offsetof(ShvPreflight, member), false                                                                 \
    }
static const Field preflight_fields[] = {PREFLIGHT(mass),
                                         PREFLIGHT(volume),
                                         PREFLIGHT(mean_edge),
                                         PREFLIGHT(shortest_edge),
                                         PREFLIGHT(longest_edge),
                                         PREFLIGHT(smallest_altitude),
                                         PREFLIGHT(stable_step),
                                         PREFLIGHT(bar_speed),
                                         PREFLIGHT(cohesive_zone),
                                         PREFLIGHT(snap_back),
                                         PREFLIGHT(dilatational_speed),
                                         {"effective_strength", offsetof(ShvPreflight, cohesion.strength), false},
                                         {"effective_energy", offsetof(ShvPreflight, cohesion.energy), false},
                                         {"tip_toughness", offsetof(ShvPreflight, cohesion.tip_toughness), false}};
#define OBSTACLE(name, member, vector)                                                                                 \
    {                                                                                                                  \
        name, offsetof(ShvObstacleDefinition, member), vector                                                          \
    }
static const Field obstacle_fields[] = {OBSTACLE("radius", radius, false),
                                        OBSTACLE("size", size, true),
                                        OBSTACLE("mass", mass, false),
                                        OBSTACLE("friction", friction, false),
                                        OBSTACLE("restitution", restitution, false),
                                        OBSTACLE("offset", plane_offset, false),
                                        OBSTACLE("normal", plane_normal, true),
                                        OBSTACLE("position", placement.position, true),
                                        OBSTACLE("velocity", placement.velocity, true)};
#define CONDITION(name, member, vector)                                                                                \
    {                                                                                                                  \
        name, offsetof(ShvConditionDefinition, member), vector                                                         \
    }
static const Field condition_fields[] = {CONDITION("value", value, true), CONDITION("ramp_time", ramp_time, false),
                                         CONDITION("start", start, false), CONDITION("end", end, false)};
static const Field scene_fields[] = {{"duration", offsetof(ShvSceneDefinition, duration), false},
                                     {"gravity", offsetof(ShvSceneDefinition, gravity), true},
                                     {"rigid_step", offsetof(ShvSceneDefinition, rigid.time_step), false},
                                     {"safety", offsetof(ShvSceneDefinition, fracture.safety), false},
                                     {"threshold", offsetof(ShvSceneDefinition, fracture.threshold), false},
                                     {"regularisation", offsetof(ShvSceneDefinition, fracture.regularisation), false}};

typedef struct Group {
    const void *items;
    int32_t count;
    size_t size, name_offset;
    const Field *fields;
    size_t field_count;
} Group;

static bool find_in(const Group *group, const char *name, ShvFormulaValue *value)
{
    for (int32_t i = 0; i < group->count; i++) {
        const char *item = (const char *)group->items + (size_t)i * group->size;
        const char *own;
        size_t offset;
        memcpy(&own, item + group->name_offset, sizeof own);
        const char *rest = own ? behind(name, own) : NULL;
        if (!rest || !find_field(group->fields, group->field_count, rest, &offset)) continue;
        *value = (ShvFormulaValue){0};
        memcpy(&value->number, item + offset, sizeof value->number);
        return true;
    }
    return false;
}

static bool find_count(const ShvRecording *recording, const char *name, ShvFormulaValue *value)
{
    for (int32_t i = 0; i < recording->object_count; i++) {
        const ShvPreflight *preflight = &recording->preflights[i];
        const char *rest = behind(name, preflight->object);
        if (!rest || (strcmp(rest, "tets") != 0 && strcmp(rest, "nodes") != 0)) continue;
        *value = (ShvFormulaValue){.number = rest[0] == 't' ? preflight->tets : preflight->nodes};
        return true;
    }
    return false;
}

static bool find_fact(const ShvRecording *recording, const ShvSceneDefinition *scene, const char *name,
                      ShvFormulaValue *value)
{
    const Group groups[] = {{scene->materials, scene->material_count, sizeof *scene->materials,
                             offsetof(ShvMaterialDefinition, name), material_fields, COUNT(material_fields)},
                            {scene->objects, scene->object_count, sizeof *scene->objects,
                             offsetof(ShvObjectDefinition, name), object_fields, COUNT(object_fields)},
                            {recording->preflights, recording->object_count, sizeof *recording->preflights,
                             offsetof(ShvPreflight, object), preflight_fields, COUNT(preflight_fields)},
                            {scene->obstacles, scene->obstacle_count, sizeof *scene->obstacles,
                             offsetof(ShvObstacleDefinition, name), obstacle_fields, COUNT(obstacle_fields)},
                            {scene->conditions, scene->condition_count, sizeof *scene->conditions,
                             offsetof(ShvConditionDefinition, name), condition_fields, COUNT(condition_fields)}};
    for (size_t i = 0; i < COUNT(groups); i++)
        if (find_in(&groups[i], name, value)) return true;
    size_t offset;
    const char *rest = behind(name, "scene");
    if (!rest || !find_field(scene_fields, COUNT(scene_fields), rest, &offset)) return false;
    *value = (ShvFormulaValue){0};
    memcpy(&value->number, (const char *)scene + offset, sizeof value->number);
    return true;
}

bool shv_recording_find(const ShvRecording *recording, const ShvSceneDefinition *scene, ShvPool *pool, const char *name,
                        ShvFormulaValue *value)
{
    return find_probe(recording, pool, name, value) || find_frame(recording, pool, name, value) ||
           find_end(recording, name, value) || find_count(recording, name, value) ||
           find_fact(recording, scene, name, value);
}
