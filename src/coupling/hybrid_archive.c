#include "coupling/hybrid_archive.h"

#include "cohesive/cohesive_archive.h"
#include "conditions/condition_archive.h"
#include "contact/contact_archive.h"
#include "model/state_archive.h"
#include "pbd/pbd_archive.h"
#include "rigid/rigid_archive.h"
#include "shape/obstacle_archive.h"

bool shv_hybrid_has_checkpoints(const ShvHybrid *hybrid)
{
    return hybrid->backend->functions->archive != NULL;
}

/* The rest of a solid follows from the scene. */
static bool archive_solid(ShvSolid *solid, ShvArchive *archive)
{
    static const ShvField smoothing[] = {
        SHV_FIELD_OF(ShvSmoothedEdges, blocks, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSmoothedEdges, batch_block, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSmoothedEdges, edge_domain, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, lane_active, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, block_active, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, gradient, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSmoothedEdges, gradient_zz, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSmoothedEdges, mean, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSmoothedEdges, group_member, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, group_width, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, group_active, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, group_offset, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, group_material, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, members, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, inverse_volume, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, stress, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSmoothedEdges, stress_zz, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSmoothedEdges, energy, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSmoothedEdges, offset, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, material, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, window_group, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, window_ready, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, ready_blocks, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, late_blocks, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, block_late, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSmoothedEdges, split, SHV_FIELD_ROOM),
    };
    return shv_archive_block(archive, (void **)&solid->batch_active) &&
           shv_archive_block(archive, (void **)&solid->batch_safe) &&
           shv_archive_block(archive, (void **)&solid->exact_step) &&
           shv_archive_block(archive, (void **)&solid->batch_exact) &&
           shv_archive_room(archive, (void **)&solid->batch_strained) &&
           SHV_ARCHIVE_STRUCT(archive, &solid->smoothing, smoothing);
}

static bool archive_probes(ShvProbes *probes, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvProbes, times, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvProbes, samples, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvProbes, memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvProbes, items, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, probes, fields);
}

static bool archive_coupled_bodies(ShvCoupledBodies *coupled_bodies, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvCoupledBodies, items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, kept, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, rotations, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, impulses, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, fragments, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, touches, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, masses, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, wanted, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, island, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvCoupledBodies, by_fragment, SHV_FIELD_ROOM),
    };
    if (!SHV_ARCHIVE_STRUCT(archive, coupled_bodies, fields)) return false;
    for (int32_t i = 0; i < coupled_bodies->count; i++)
        coupled_bodies->by_fragment[coupled_bodies->fragments[i]] = &coupled_bodies->items[i];
    return true;
}

/* What is not a part with a table of its own. */
static bool archive_rest(ShvHybrid *hybrid, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvHybrid, awake.flags, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, awake.nodes, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, wakes.items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, check.stress, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, check.nodal, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, stabiliser.fixed, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, damping.force, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvHybrid, waiting, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, log.items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, observer.ghost.before, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, observer.ghost.displacement, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvHybrid, observer.ghost.obstacles, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, check.candidates, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, check.overstress, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, scene, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, model, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, stop, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, stop_data, SHV_FIELD_KEPT),
        /* parts */
        SHV_FIELD_OF(ShvHybrid, costs, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, processors, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, state, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, solid, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, cohesive, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, obstacles, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, coupling.surface, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, coupling.bodies, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, imposed, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, stabiliser.bars, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, stabiliser.relax, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, probes, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, fragments, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvHybrid, backend, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, hybrid, fields);
}

bool shv_hybrid_archive(ShvHybrid *hybrid, ShvArchive *archive)
{
    const bool good = archive_rest(hybrid, archive) && shv_state_archive(&hybrid->state, archive) &&
                      archive_solid(&hybrid->solid, archive) && shv_obstacles_archive(&hybrid->obstacles, archive) &&
                      shv_surface_contact_archive(&hybrid->coupling.surface, archive) &&
                      archive_coupled_bodies(&hybrid->coupling.bodies, archive) &&
                      shv_imposed_archive(&hybrid->imposed, archive) && archive_probes(&hybrid->probes, archive) &&
                      shv_fragments_archive(&hybrid->fragments, archive);
    if (!good) return false;
    if (hybrid->stabiliser.active &&
        !(shv_bars_archive(&hybrid->stabiliser.bars, archive) && shv_relax_archive(&hybrid->stabiliser.relax, archive)))
        return false;
    if (hybrid->model.can_break && !shv_cohesive_archive(&hybrid->cohesive, hybrid->awake.flags, archive)) return false;
    /* Run times come last: all before is the same in equal runs. */
    return hybrid->backend->functions->archive(hybrid->backend, archive) &&
           shv_archive_bytes(archive, &hybrid->costs, sizeof hybrid->costs);
}
