#include "solid/solid.h"

#include <string.h>

#include "solid/colour.h"
#include "solid/domain.h"

/* Gradients of N1, N2, N3: the rows of D_m⁻¹, which are the opposite faces' area vectors over three volumes. */
static ShvStatus shape_gradients(const ShvMesh *mesh, int32_t element, ShvVec3 gradients[3], double *volume,
                                 ShvError *error)
{
    const int32_t *nodes = mesh->elements + 4 * (int64_t)element;
    const ShvVec3 first = shv_mesh_position(mesh, nodes[0]);
    ShvVec3 edge[3];
    for (int b = 0; b < 3; b++) edge[b] = shv_sub(shv_mesh_position(mesh, nodes[b + 1]), first);
    const double determinant = shv_dot(edge[0], shv_cross(edge[1], edge[2]));
    *volume = determinant / 6.0;
    for (int b = 0; b < 3; b++)
        gradients[b] = shv_scale(shv_cross(edge[(b + 1) % 3], edge[(b + 2) % 3]), 1.0 / determinant);
    if (!(determinant > 0.0) || !shv_finite3(gradients[0]) || !shv_finite3(gradients[1]) || !shv_finite3(gradients[2]))
        return shv_fail(error, SHV_BAD_INPUT,
                        "element %d has the volume %g m³, for which no strain can be computed; mend the mesh or choose "
                        "units in which its size is nearer to 1",
                        (int)element, *volume);
    return SHV_OK;
}

/* Padding lanes repeat the last element, with no volume: they compute, and contribute nothing. */
static ShvStatus fill_gradients(ShvSolid *solid, ShvError *error)
{
    const ShvMesh *mesh = &solid->model->mesh;
    for (int32_t batch = 0; batch < solid->batch_count; batch++)
        for (int32_t lane = 0; lane < SHV_LANES; lane++) {
            const int32_t slot = batch * SHV_LANES + lane;
            const int32_t element = slot < mesh->element_count ? slot : mesh->element_count - 1;
            ShvVec3 rows[3];
            double volume;
            SHV_TRY(shape_gradients(mesh, element, rows, &volume, error));
            double *into = solid->gradients + (int64_t)batch * (9 * SHV_LANES) + lane;
            for (int b = 0; b < 3; b++) {
                into[(3 * b + 0) * SHV_LANES] = rows[b].x;
                into[(3 * b + 1) * SHV_LANES] = rows[b].y;
                into[(3 * b + 2) * SHV_LANES] = rows[b].z;
            }
            solid->volumes[slot] = slot < mesh->element_count ? volume : 0.0;
        }
    return SHV_OK;
}

static void fill_batches(ShvSolid *solid)
{
    const ShvModel *model = solid->model;
    for (int32_t batch = 0; batch < solid->batch_count; batch++) {
        const int32_t begin = batch * SHV_LANES;
        int32_t material = model->element_material[begin];
        for (int32_t e = begin + 1; e < begin + SHV_LANES && e < model->mesh.element_count; e++)
            if (model->element_material[e] != material) material = -1;
        solid->batch_material[batch] = (int16_t)material;
    }
    memset(solid->batch_active, 1, (size_t)solid->batch_count);
}

static void fill_steps(ShvSolid *solid)
{
    for (int32_t batch = 0; batch < solid->batch_count; batch++) {
        const int32_t begin = batch * SHV_LANES;
        solid->batch_safe[batch] = HUGE_VAL;
        solid->batch_exact[batch] = nan("");
        for (int lane = 0; lane < SHV_LANES; lane++) solid->exact_step[begin + lane] = nan("");
        solid->batch_strained[batch] = HUGE_VAL;
        for (int32_t e = begin; e < begin + SHV_LANES && e < solid->model->mesh.element_count; e++)
            solid->batch_safe[batch] = fmin(solid->batch_safe[batch], shv_solid_safe_step(solid, e));
    }
}

static ShvStatus create(ShvSolid *solid, const ShvState *state, ShvError *error)
{
    const size_t batches = (size_t)solid->batch_count, lanes = SHV_LANES * batches;
    ShvMemory *memory = solid->memory;
    solid->gradients = shv_allocate(memory, SHV_PART_STATE, 9 * lanes, sizeof *solid->gradients);
    solid->volumes = shv_allocate(memory, SHV_PART_STATE, lanes, sizeof *solid->volumes);
    solid->batch_material = shv_allocate(memory, SHV_PART_STATE, batches, sizeof *solid->batch_material);
    solid->batch_active = shv_allocate(memory, SHV_PART_STATE, batches, sizeof *solid->batch_active);
    solid->batch_safe = shv_allocate(memory, SHV_PART_STATE, batches, sizeof *solid->batch_safe);
    solid->exact_step = shv_allocate(memory, SHV_PART_STATE, lanes, sizeof *solid->exact_step);
    solid->batch_exact = shv_allocate(memory, SHV_PART_STATE, batches, sizeof *solid->batch_exact);
    solid->batch_strained = shv_allocate(memory, SHV_PART_STATE, batches, sizeof *solid->batch_strained);
    if (!solid->gradients || !solid->volumes || !solid->batch_material || !solid->batch_active || !solid->batch_safe ||
        !solid->exact_step || !solid->batch_exact || !solid->batch_strained)
        return shv_fail_memory(error, "the constants of elements",
                               11 * lanes * sizeof *solid->gradients + 27 * batches);
    SHV_TRY(fill_gradients(solid, error));
    fill_batches(solid);
    fill_steps(solid);
    SHV_TRY(shv_smoothing_create(solid, state, error));
    return shv_solid_colour(solid, state, error);
}

ShvStatus shv_solid_create(ShvSolid *solid, const ShvModel *model, const ShvState *state, ShvError *error)
{
    *solid = (ShvSolid){.memory = model->memory, .model = model, .batch_count = state->batch_count};
    const ShvStatus status = create(solid, state, error);
    if (status != SHV_OK) shv_solid_release(solid);
    return status;
}

void shv_solid_release(ShvSolid *solid)
{
    shv_release(solid->gradients);
    shv_release(solid->volumes);
    shv_release(solid->batch_material);
    shv_release(solid->batch_active);
    shv_release(solid->batch_safe);
    shv_release(solid->exact_step);
    shv_release(solid->batch_exact);
    shv_release(solid->batch_strained);
    shv_release(solid->colour_start);
    shv_release(solid->chunk_order);
    shv_release(solid->chunk_colour);
    shv_smoothing_release(&solid->smoothing);
    *solid = (ShvSolid){0};
}
