/* The grids in which nodes and facets of surfaces are found. Each stands there where it was when its speed class was chosen, and has
   not left its skin round that. */
#include "contact/surface_candidates.h"

_Static_assert((int)SHV_GRID_SPEED_CLASSES == (int)SHV_SURFACE_SPEED_CLASSES, "a grid for each speed class");

double shv_surface_reach(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet, int speed_class)
{
    return contact->skin[facet->speed_class] + contact->skin[speed_class];
}

ShvStatus shv_surface_put_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                               ShvError *error)
{
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    if (node->inner || shv_bodies_alone(bodies, node->fragment)) return SHV_OK;
    return shv_hash_grid_put(&contact->node_grid, slot, node->speed_class, node->from, error);
}

ShvStatus shv_surface_put_facet(ShvSurfaceContact *contact, int32_t place, ShvError *error)
{
    const ShvSurfaceFacet *facet = &contact->list.facets[place];
    const ShvVec3 centre = shv_scale(shv_add(facet->box.low, facet->box.high), 0.5);
    contact->half[facet->speed_class] = fmax(contact->half[facet->speed_class], 0.5 * shv_box_size(&facet->box));
    return shv_hash_grid_put(&contact->facet_grid, place, facet->speed_class, centre, error);
}

/* Cubes are about half as large as the box in which a facet of middling size and speed class looks among them. */
ShvStatus shv_surface_fill_grids(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    const ShvSurfaceList *list = &contact->list;
    ShvBox region = shv_box_empty();
    double size[SHV_SURFACE_SPEED_CLASSES];
    for (int32_t k = 0; k < list->node_count; k++)
        if (!shv_bodies_alone(bodies, list->nodes[k].fragment)) shv_box_add(&region, list->nodes[k].from);
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) {
        size[speed_class] =
            0.5 * contact->size + contact->skin[speed_class] + contact->skin[SHV_SURFACE_SPEED_CLASSES / 2];
        contact->half[speed_class] = 0.0;
    }
    SHV_TRY(shv_hash_grid_start(&contact->node_grid, region, size, list->node_count, error));
    SHV_TRY(shv_hash_grid_start(&contact->facet_grid, region, size, list->facet_count, error));
    for (int32_t k = 0; k < list->node_count; k++) SHV_TRY(shv_surface_put_node(contact, bodies, k, error));
    for (int32_t k = 0; k < list->facet_count; k++) SHV_TRY(shv_surface_put_facet(contact, k, error));
    return SHV_OK;
}
