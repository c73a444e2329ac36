#include "model/state.h"

#include <string.h>

#include "base/random.h"

/* ---- storage ---- */

static size_t node_bytes(void)
{
    size_t bytes = 0;
#define COUNT_BYTES(type, name, components) bytes += (components) * sizeof(type);
    SHV_NODE_ARRAYS(COUNT_BYTES)
#undef COUNT_BYTES
    return bytes;
}

/* Arrays are grown one by one; `node_capacity` is raised only when all are, so that a failure leaves every array at
   least as long as it says. */
static ShvStatus set_capacity(ShvState *state, int32_t capacity, ShvError *error)
{
#define GROW(type, name, components)                                                                                   \
    SHV_RESIZE(state->memory, SHV_PART_STATE, state->name, (components) * (size_t)capacity, "the state of nodes",      \
               (size_t)capacity * node_bytes(), error);
    SHV_NODE_ARRAYS(GROW)
#undef GROW
    state->node_capacity = capacity;
    return SHV_OK;
}

ShvStatus shv_state_reserve(ShvState *state, int64_t nodes, ShvError *error)
{
    if (nodes <= state->node_capacity) return SHV_OK;
    if (nodes > SHV_NODE_LIMIT)
        return shv_fail(error, SHV_BAD_INPUT, "%lld nodes are needed and at most %d fit; mesh more coarsely",
                        (long long)nodes, (int)SHV_NODE_LIMIT);
    int64_t capacity = (int64_t)state->node_capacity + state->node_capacity / 2;
    if (capacity < nodes) capacity = nodes;
    if (capacity > SHV_NODE_LIMIT) capacity = SHV_NODE_LIMIT;
    return set_capacity(state, (int32_t)capacity, error);
}

static ShvStatus allocate_elements(ShvState *state, ShvError *error)
{
    ShvMemory *memory = state->memory;
    const size_t elements = (size_t)state->element_count, slots = 4 * SHV_LANES * (size_t)state->batch_count;
    state->connectivity = shv_allocate(memory, SHV_PART_STATE, slots, sizeof *state->connectivity);
    state->element_mass = shv_allocate(memory, SHV_PART_STATE, elements, sizeof *state->element_mass);
    state->element_fragment = shv_allocate(memory, SHV_PART_STATE, elements, sizeof *state->element_fragment);
    state->corners = shv_allocate(memory, SHV_PART_STATE, 4 * elements, sizeof *state->corners);
    if (!state->connectivity || !state->element_mass || !state->element_fragment || !state->corners)
        return shv_fail_memory(error, "the state of elements",
                               slots * sizeof *state->connectivity + elements * (sizeof *state->element_mass + 20));
    return SHV_OK;
}

void shv_state_release(ShvState *state)
{
#define RELEASE(type, name, components) shv_release(state->name);
    SHV_NODE_ARRAYS(RELEASE)
#undef RELEASE
    shv_release(state->connectivity);
    shv_release(state->element_mass);
    shv_release(state->element_fragment);
    shv_release(state->corners);
    *state = (ShvState){0};
}

/* ---- the start ---- */

static void fill_nodes(ShvState *state, const ShvModel *model)
{
    memcpy(state->reference, model->mesh.positions, 3 * (size_t)state->node_count * sizeof *state->reference);
    for (int32_t i = 0; i < state->node_count; i++) state->origin[i] = i;
    shv_mesh_corners(&model->mesh, state->corner_start, state->corners);
    for (int32_t i = 0; i < state->node_count; i++) {
        const int32_t end = i + 1 < state->node_count ? state->corner_start[i + 1] : 4 * state->element_count;
        state->corner_count[i] = end - state->corner_start[i];
    }
}

static void fill_elements(ShvState *state, const ShvModel *model)
{
    for (int32_t lane = 0; lane < state->batch_count * SHV_LANES; lane++) {
        const int32_t element = lane < state->element_count ? lane : state->element_count - 1;
        for (int32_t corner = 0; corner < 4; corner++)
            state->connectivity[shv_corner_slot(lane, corner)] = model->mesh.elements[4 * (int64_t)element + corner];
    }
    for (int32_t e = 0; e < state->element_count; e++)
        state->element_mass[e] = shv_model_material(model, e)->density * shv_mesh_element_volume(&model->mesh, e);
}

/* A quarter of each element to each corner. Going through the elements in order adds to every node in increasing
   element order, which is the order of its corners: later sums over corners give the same bits. */
static void lump_masses(ShvState *state)
{
    for (int32_t e = 0; e < state->element_count; e++)
        for (int32_t corner = 0; corner < 4; corner++)
            state->mass[shv_state_node(state, e, corner)] += 0.25 * state->element_mass[e];
}

static ShvStatus check_masses(const ShvState *state, ShvError *error)
{
    for (int32_t i = 0; i < state->node_count; i++)
        if (!(state->mass[i] > 0.0 && isfinite(state->mass[i])))
            return shv_fail(error, SHV_BAD_INPUT,
                            "node %d has the mass %g; give a density and a mesh size whose products double precision "
                            "can hold, and no node without an element",
                            (int)i, state->mass[i]);
    return SHV_OK;
}

/* Measured from the object's first node, so that a far position costs no digits. */
static ShvVec3 lumped_centre(const ShvState *state, const ShvObject *object)
{
    const ShvVec3 first = shv_load3(state->reference + 3 * (int64_t)object->node_begin);
    ShvVec3 moment = {0.0, 0.0, 0.0};
    double mass = 0.0;
    for (int32_t i = object->node_begin; i < object->node_end; i++) {
        const ShvVec3 arm = shv_sub(shv_load3(state->reference + 3 * (int64_t)i), first);
        moment = shv_madd(moment, state->mass[i], arm);
        mass += state->mass[i];
    }
    return shv_madd(first, 1.0 / mass, moment);
}

static void start_velocities(ShvState *state, const ShvObject *object, const ShvPlacement *placement)
{
    const ShvVec3 velocity = shv_load3(placement->velocity), spin = shv_load3(placement->angular_velocity);
    const ShvVec3 centre = lumped_centre(state, object);
    const double *rate = placement->stretch_rate;
    for (int32_t i = object->node_begin; i < object->node_end; i++) {
        const ShvVec3 arm = shv_sub(shv_load3(state->reference + 3 * (int64_t)i), centre);
        const ShvVec3 stretching = shv_vec3(rate[0] * arm.x, rate[1] * arm.y, rate[2] * arm.z);
        shv_store3(state->velocity + 3 * (int64_t)i, shv_add(shv_velocity_at(velocity, spin, arm), stretching));
    }
}

static ShvStatus create(ShvState *state, const ShvModel *model, const ShvSceneDefinition *scene, ShvError *error)
{
    SHV_TRY(set_capacity(state, state->node_count, error));
    SHV_TRY(allocate_elements(state, error));
    fill_nodes(state, model);
    fill_elements(state, model);
    lump_masses(state);
    SHV_TRY(check_masses(state, error));
    for (int32_t i = 0; i < model->object_count; i++)
        start_velocities(state, &model->objects[i], &scene->objects[i].placement);
    return SHV_OK;
}

ShvStatus shv_state_create(ShvState *state, const ShvModel *model, const ShvSceneDefinition *scene, ShvError *error)
{
    *state = (ShvState){.memory = model->memory,
                        .node_count = model->mesh.node_count,
                        .element_count = model->mesh.element_count,
                        .batch_count = (model->mesh.element_count + SHV_LANES - 1) / SHV_LANES};
    const ShvStatus status = create(state, model, scene, error);
    if (status != SHV_OK) shv_state_release(state);
    return status;
}

/* ---- hash ---- */

static uint64_t hash_word(uint64_t hash, uint64_t word)
{
    return shv_random_bits(hash, word);
}

static uint64_t hash_double(uint64_t hash, const double *values, int64_t count)
{
    for (int64_t i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        hash = hash_word(hash, bits);
    }
    return hash;
}

static uint64_t hash_int32_t(uint64_t hash, const int32_t *values, int64_t count)
{
    for (int64_t i = 0; i < count; i++) hash = hash_word(hash, (uint32_t)values[i]);
    return hash;
}

uint64_t shv_state_hash(const ShvState *state)
{
    uint64_t hash = hash_word((uint64_t)state->node_count, (uint64_t)state->element_count);
#define HASH(type, name, components) hash = hash_##type(hash, state->name, (components) * (int64_t)state->node_count);
    SHV_NODE_ARRAYS(HASH)
#undef HASH
    hash = hash_int32_t(hash, state->connectivity, 4 * SHV_LANES * (int64_t)state->batch_count);
    hash = hash_double(hash, state->element_mass, state->element_count);
    hash = hash_int32_t(hash, state->element_fragment, state->element_count);
    hash = hash_int32_t(hash, state->corners, 4 * (int64_t)state->element_count);
    hash = hash_double(hash, &state->time, 1);
    hash = hash_double(hash, &state->last_step, 1);
    return hash_word(hash, (uint64_t)state->step);
}
