/* Where surfaces may meet, and the grid that holds their nodes. */
#include "contact/surface_candidates.h"

enum { MOST_REGIONS = 64 };

/* ---- regions ---- */

ShvStatus shv_surface_reserve_fragments(ShvSurfaceContact *contact, int32_t count, ShvError *error)
{
    if (contact->fragment_capacity >= count) return SHV_OK;
    const size_t wanted = (size_t)count + (size_t)count / 2;
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, contact->own, wanted, "contact of surfaces",
               wanted * sizeof *contact->own, error);
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, contact->near, wanted, "contact of surfaces",
               wanted * sizeof *contact->near, error);
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, contact->order, wanted, "contact of surfaces",
               wanted * sizeof *contact->order, error);
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, contact->fragments, wanted, "contact of surfaces",
               wanted * sizeof *contact->fragments, error);
    contact->fragment_capacity = (int32_t)wanted;
    return SHV_OK;
}

/* Binary search places each fragment: an order that does not depend on a library's sort. */
static int32_t sort_boxes(const ShvSurfaceContact *contact, int32_t count)
{
    int32_t sorted = 0;
    for (int32_t i = 0; i < count; i++) {
        if (!(contact->own[i].low.x <= contact->own[i].high.x)) continue;
        int32_t low = 0, high = sorted;
        while (low < high) {
            const int32_t middle = low + (high - low) / 2;
            if (contact->own[contact->order[middle]].low.x <= contact->own[i].low.x)
                low = middle + 1;
            else
                high = middle;
        }
        for (int32_t k = sorted++; k > low; k--) contact->order[k] = contact->order[k - 1];
        contact->order[low] = i;
    }
    return sorted;
}

static void add_common_part(ShvSurfaceContact *contact, int32_t a, int32_t b)
{
    const ShvBox *x = &contact->own[a], *y = &contact->own[b];
    if (!shv_box_meets(x, y)) return;
    const ShvVec3 low = {fmax(x->low.x, y->low.x), fmax(x->low.y, y->low.y), fmax(x->low.z, y->low.z)};
    const ShvVec3 high = {fmin(x->high.x, y->high.x), fmin(x->high.y, y->high.y), fmin(x->high.z, y->high.z)};
    shv_box_add(&contact->near[a], low);
    shv_box_add(&contact->near[a], high);
    shv_box_add(&contact->near[b], low);
    shv_box_add(&contact->near[b], high);
}

static void find_boxes(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    for (int32_t i = 0; i < bodies->fragment_count; i++) contact->own[i] = contact->near[i] = shv_box_empty();
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        const ShvSurfaceNode *node = &contact->list.nodes[k];
        const double way = contact->allowance[node->pace];
        shv_box_add(&contact->own[node->fragment], shv_sub(node->from, shv_vec3(way, way, way)));
        shv_box_add(&contact->own[node->fragment], shv_add(node->from, shv_vec3(way, way, way)));
    }
}

/* Of few bodies only what is near another is looked at; where there are many, they are small, and the grid sorts them out. */
void shv_surface_find_regions(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    int32_t boxes = 0;
    find_boxes(contact, bodies);
    for (int32_t i = 0; i < bodies->fragment_count; i++) boxes += contact->own[i].low.x <= contact->own[i].high.x;
    if (boxes > MOST_REGIONS) {
        for (int32_t i = 0; i < bodies->fragment_count; i++) contact->near[i] = contact->own[i];
        return;
    }
    const int32_t count = sort_boxes(contact, bodies->fragment_count);
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = i + 1; k < count; k++) {
            if (contact->own[contact->order[k]].low.x > contact->own[contact->order[i]].high.x) break;
            add_common_part(contact, contact->order[i], contact->order[k]);
        }
    /* A cracked fragment may meet itself anywhere. */
    for (int32_t i = 0; i < bodies->fragment_count; i++)
        if (contact->fragments[i].cracked) contact->near[i] = contact->own[i];
}

/* ---- the grid ---- */

static bool node_in_region(const ShvSurfaceContact *contact, const ShvSurfaceNode *node)
{
    const ShvBox near = shv_box_grown(contact->near[node->fragment], contact->allowance[node->pace]);
    return shv_box_holds(&near, node->from);
}

bool shv_surface_in_region(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet)
{
    const ShvBox box = shv_box_grown(facet->box, contact->allowance[facet->pace]);
    return shv_box_meets(&box, &contact->near[facet->fragment]);
}

static double smallest_facet(const ShvSurfaceContact *contact)
{
    double smallest = (double)INFINITY;
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        if (!shv_surface_in_region(contact, &contact->list.facets[k])) continue;
        const double size = shv_box_size(&contact->list.facets[k].box);
        smallest = size < smallest ? size : smallest;
    }
    return smallest;
}

/* Sizes of the facets that lie in regions. */
static uint32_t find_levels(ShvSurfaceContact *contact, ShvBox region, double smallest)
{
    uint32_t levels = 0;
    shv_node_grid_scale(&contact->grid, region, smallest);
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        if (shv_surface_in_region(contact, &contact->list.facets[k]))
            levels |=
                (uint32_t)1 << shv_node_grid_level(&contact->grid, 0.5 * shv_box_size(&contact->list.facets[k].box));
    return levels;
}

ShvStatus shv_surface_fill_grid(ShvSurfaceContact *contact, ShvError *error)
{
    ShvBox region = shv_box_empty();
    int32_t count = 0;
    contact->grid_nodes = contact->list.node_count;
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        if (!node_in_region(contact, &contact->list.nodes[k])) continue;
        shv_box_add(&region, contact->list.nodes[k].from);
        count++;
    }
    const double smallest = smallest_facet(contact);
    const bool none = count == 0 || !isfinite(smallest);
    const uint32_t levels = none ? 0 : find_levels(contact, region, 0.5 * smallest);
    SHV_TRY(shv_node_grid_start(&contact->grid, region, none ? 1.0 : 0.5 * smallest, levels, none ? 0 : count, error));
    for (int32_t k = 0; k < contact->list.node_count && !none; k++)
        if (node_in_region(contact, &contact->list.nodes[k]))
            shv_node_grid_add(&contact->grid, k, contact->list.nodes[k].pace, contact->list.nodes[k].from);
    shv_node_grid_finish(&contact->grid);
    return SHV_OK;
}
