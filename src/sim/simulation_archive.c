/* Checkpoints of a simulation. */
#include "base/archive.h"
#include "base/hash.h"
#include "coupling/hybrid_archive.h"
#include "sim/internal.h"

bool shv_simulation_has_checkpoints(const ShvSimulation *simulation)
{
    return shv_hybrid_has_checkpoints(&simulation->hybrid);
}

uint64_t shv_simulation_geometry_hash(const ShvSimulation *simulation)
{
    const ShvMesh *mesh = &simulation->hybrid.model.mesh;
    uint64_t hash =
        shv_hash_bytes(SHV_HASH_START, mesh->positions, 3 * (size_t)mesh->node_count * sizeof *mesh->positions);
    hash = shv_hash_bytes(hash, mesh->elements, 4 * (size_t)mesh->element_count * sizeof *mesh->elements);
    const uint16_t *materials = simulation->hybrid.model.element_material;
    hash = shv_hash_bytes(hash, materials, (size_t)mesh->element_count * sizeof *materials);
    for (int32_t i = 0; i < simulation->hybrid.obstacles.count; i++) {
        const ShvSurface *surface = &simulation->hybrid.obstacles.items[i].surface;
        hash = shv_hash_bytes(hash, surface->positions, 3 * (size_t)surface->node_count * sizeof *surface->positions);
        hash =
            shv_hash_bytes(hash, surface->triangles, 3 * (size_t)surface->triangle_count * sizeof *surface->triangles);
    }
    return hash;
}

/* Where a run was to end within an interval of the grid, one that goes on has the frame of the grid before it. */
static void go_on(ShvSimulation *simulation)
{
    const double before = (double)(simulation->animation_frame - 1) / simulation->scene->output.rate;
    if (simulation->animation_frame > 1 && simulation->hybrid.state.time < before) simulation->animation_frame--;
}

static bool exchange(ShvSimulation *simulation, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvSimulation, memory, SHV_FIELD_KEPT), SHV_FIELD_OF(ShvSimulation, owns_memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSimulation, scene, SHV_FIELD_KEPT),  SHV_FIELD_OF(ShvSimulation, hybrid, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSimulation, views, SHV_FIELD_KEPT),  SHV_FIELD_OF(ShvSimulation, frame, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, simulation, fields) && shv_hybrid_archive(&simulation->hybrid, archive);
}

static ShvStatus refuse(ShvError *error)
{
    return shv_fail(error, SHV_UNSUPPORTED,
                    "rigid.engine bullet_plain has no checkpoints: a run with it goes on only by beginning anew");
}

ShvStatus shv_simulation_save(ShvSimulation *simulation, int descriptor, uint64_t *size, uint32_t *checksum,
                              ShvError *error)
{
    ShvArchive *archive;
    ShvArchiveSum sum = {0, 0};
    if (!shv_simulation_has_checkpoints(simulation)) return refuse(error);
    SHV_TRY(shv_archive_create(&archive, simulation->memory, descriptor, false, 0, error));
    (void)exchange(simulation, archive);
    const ShvStatus status = shv_archive_finish(archive, &sum, error);
    shv_archive_release(archive);
    *size = sum.size;
    *checksum = sum.checksum;
    return status;
}

ShvStatus shv_simulation_load(ShvSimulation *simulation, int descriptor, uint64_t size, ShvError *error)
{
    ShvArchive *archive;
    if (!shv_simulation_has_checkpoints(simulation)) return refuse(error);
    SHV_TRY(shv_archive_create(&archive, simulation->memory, descriptor, true, size, error));
    (void)exchange(simulation, archive);
    const ShvStatus status = shv_archive_finish(archive, NULL, error);
    shv_archive_release(archive);
    if (status == SHV_OK) go_on(simulation);
    return status;
}
