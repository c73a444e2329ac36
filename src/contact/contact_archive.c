#include "contact/contact_archive.h"

_Static_assert(sizeof(ShvMotionBound) == sizeof(double) + 2 * sizeof(int32_t) + 2 * sizeof(ShvSideKind),
               "written as it lies: has no gaps");

bool shv_surface_contact_archive(ShvSurfaceContact *contact, ShvArchive *archive)
{
    static const ShvField fields[] = {
        SHV_FIELD_OF(ShvSurfaceContact, list.boundary, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.facets, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.facet_path, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.nodes, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.node_path, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.node_speed, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.slot, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.cracks, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.place, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, list.outdated.items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, node_grid.entries, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, node_grid.first, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, node_grid.found, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, facet_grid.entries, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, facet_grid.first, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, facet_grid.found, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, rebuilt_facets.items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, fragments, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[0].items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[0].due, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[0].motion_bounds, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[0].motion_classes, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[1].items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[1].due, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[1].motion_bounds, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[1].motion_classes, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, watched, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, watched_facets.items, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, before, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, coupled_body_before, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, pairs, SHV_FIELD_BLOCK),
        /* made anew by every look */
        SHV_FIELD_OF(ShvSurfaceContact, candidates[0].now, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[1].now, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[0].near, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSurfaceContact, candidates[1].near, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSurfaceContact, found, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSurfaceContact, keys, SHV_FIELD_ROOM),
        SHV_FIELD_OF(ShvSurfaceContact, visits, SHV_FIELD_BLOCK),
        SHV_FIELD_OF(ShvSurfaceContact, memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSurfaceContact, model, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSurfaceContact, list.memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSurfaceContact, list.model, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSurfaceContact, node_grid.memory, SHV_FIELD_KEPT),
        SHV_FIELD_OF(ShvSurfaceContact, facet_grid.memory, SHV_FIELD_KEPT),
    };
    return SHV_ARCHIVE_STRUCT(archive, contact, fields);
}
