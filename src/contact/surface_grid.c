/* The grids in which nodes and facets of surfaces are found. */
#include "contact/surface_candidates.h"

_Static_assert((int)SHV_GRID_SPEED_CLASSES == (int)SHV_SURFACE_SPEED_CLASSES, "a grid for each speed class");

double shv_surface_reach(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet, int speed_class)
{
    return contact->skin[facet->speed_class] + contact->skin[speed_class];
}

static ShvVec3 centre_of(const ShvBox *box)
{
    return shv_scale(shv_add(box->low, box->high), 0.5);
}

/* Cubes are about half as large as the box in which a facet of middling size and speed class looks among them. */
static ShvStatus fill_node_grid(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvBox region,
                                ShvError *error)
{
    double size[SHV_GRID_SPEED_CLASSES];
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++)
        size[speed_class] =
            0.5 * contact->size + contact->skin[speed_class] + contact->skin[SHV_SURFACE_SPEED_CLASSES / 2];
    SHV_TRY(shv_node_grid_start(&contact->grid, region, size, contact->list.node_count, error));
    for (int32_t k = 0; k < contact->list.node_count; k++)
        if (!shv_bodies_alone(bodies, contact->list.nodes[k].fragment))
            shv_node_grid_add(&contact->grid, k, contact->list.nodes[k].speed_class, contact->list.nodes[k].from);
    shv_node_grid_finish(&contact->grid);
    contact->grid_nodes = contact->list.node_count;
    return SHV_OK;
}

static ShvStatus fill_facet_grid(ShvSurfaceContact *contact, ShvBox region, ShvError *error)
{
    double size[SHV_GRID_SPEED_CLASSES];
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) contact->half[speed_class] = 0.0;
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        ShvSurfaceFacet *facet = &contact->list.facets[k];
        facet->out_of_skin = false;
        contact->half[facet->speed_class] = fmax(contact->half[facet->speed_class], 0.5 * shv_box_size(&facet->box));
    }
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++)
        size[speed_class] = contact->half[speed_class] +
                            2.0 * (contact->skin[speed_class] + contact->skin[SHV_SURFACE_SPEED_CLASSES / 2]);
    SHV_TRY(shv_node_grid_start(&contact->facet_grid, region, size, contact->list.facet_count, error));
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        shv_node_grid_add(&contact->facet_grid, k, contact->list.facets[k].speed_class,
                          centre_of(&contact->list.facets[k].box));
    shv_node_grid_finish(&contact->facet_grid);
    contact->grid_facets = contact->list.facet_count;
    return SHV_OK;
}

ShvStatus shv_surface_fill_grids(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    ShvBox region = shv_box_empty();
    for (int32_t k = 0; k < contact->list.node_count; k++)
        if (!shv_bodies_alone(bodies, contact->list.nodes[k].fragment))
            shv_box_add(&region, contact->list.nodes[k].from);
    SHV_TRY(fill_node_grid(contact, bodies, region, error));
    return fill_facet_grid(contact, region, error);
}
