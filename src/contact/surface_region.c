/* Where surfaces may meet, and the grid that holds their nodes. */
#include "contact/surface_candidates.h"

_Static_assert((int)SHV_GRID_SPEED_CLASSES == (int)SHV_SURFACE_SPEED_CLASSES, "a grid for each speed class");

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
        const double distance = contact->skin[node->speed_class];
        if (shv_bodies_alone(bodies, node->fragment)) continue;
        shv_box_add(&contact->own[node->fragment], shv_sub(node->from, shv_vec3(distance, distance, distance)));
        shv_box_add(&contact->own[node->fragment], shv_add(node->from, shv_vec3(distance, distance, distance)));
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
    const ShvBox near = shv_box_grown(contact->near[node->fragment], contact->skin[node->speed_class]);
    return shv_box_holds(&near, node->from);
}

bool shv_surface_in_region(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet)
{
    const ShvBox box = shv_box_grown(facet->box, contact->skin[facet->speed_class]);
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

double shv_surface_reach(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet, int speed_class)
{
    return contact->skin[facet->speed_class] + contact->skin[speed_class];
}

double shv_surface_cube(const ShvSurfaceFacet *facet, double reach)
{
    return 0.5 * shv_box_size(&facet->box) + reach;
}

/* For the facets that lie in regions, and nodes of each speed class. */
static void find_levels(const ShvSurfaceContact *contact, uint32_t levels[SHV_GRID_SPEED_CLASSES])
{
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        const ShvSurfaceFacet *facet = &contact->list.facets[k];
        if (!shv_surface_in_region(contact, facet)) continue;
        for (int speed_class = 0; speed_class < SHV_GRID_SPEED_CLASSES; speed_class++)
            levels[speed_class] |=
                (uint32_t)1 << shv_node_grid_level(
                    &contact->grid, shv_surface_cube(facet, shv_surface_reach(contact, facet, speed_class)));
    }
}

static ShvVec3 centre_of(const ShvBox *box)
{
    return shv_scale(shv_add(box->low, box->high), 0.5);
}

/* One level a speed class, for nodes of a middling speed class. */
static ShvStatus fill_facet_grid(ShvSurfaceContact *contact, ShvBox region, double smallest, ShvError *error)
{
    ShvNodeGrid *grid = &contact->facet_grid;
    int32_t counts[SHV_GRID_SPEED_CLASSES] = {0};
    uint32_t levels[SHV_GRID_SPEED_CLASSES] = {0};
    contact->grid_facets = contact->list.facet_count;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) contact->half[speed_class] = 0.0;
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        ShvSurfaceFacet *facet = &contact->list.facets[k];
        facet->out_of_skin = false;
        counts[facet->speed_class]++;
        contact->half[facet->speed_class] = fmax(contact->half[facet->speed_class], 0.5 * shv_box_size(&facet->box));
    }
    shv_node_grid_scale(grid, region, isfinite(smallest) ? 0.5 * smallest : 1.0);
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++)
        levels[speed_class] =
            (uint32_t)1 << shv_node_grid_level(
                grid, contact->half[speed_class] +
                          2.0 * (contact->skin[speed_class] + contact->skin[SHV_SURFACE_SPEED_CLASSES / 2]));
    SHV_TRY(shv_node_grid_start(grid, levels, counts, error));
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        shv_node_grid_add(grid, k, contact->list.facets[k].speed_class, centre_of(&contact->list.facets[k].box));
    shv_node_grid_finish(grid);
    return SHV_OK;
}

ShvStatus shv_surface_fill_grid(ShvSurfaceContact *contact, ShvError *error)
{
    ShvBox region = shv_box_empty();
    int32_t counts[SHV_GRID_SPEED_CLASSES] = {0};
    uint32_t levels[SHV_GRID_SPEED_CLASSES] = {0};
    contact->grid_nodes = contact->list.node_count;
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        if (!node_in_region(contact, &contact->list.nodes[k])) continue;
        shv_box_add(&region, contact->list.nodes[k].from);
        counts[contact->list.nodes[k].speed_class]++;
    }
    const double smallest = smallest_facet(contact);
    if (isfinite(smallest)) {
        shv_node_grid_scale(&contact->grid, region, 0.5 * smallest);
        find_levels(contact, levels);
    }
    SHV_TRY(shv_node_grid_start(&contact->grid, levels, counts, error));
    for (int32_t k = 0; k < contact->list.node_count; k++)
        if (node_in_region(contact, &contact->list.nodes[k]))
            shv_node_grid_add(&contact->grid, k, contact->list.nodes[k].speed_class, contact->list.nodes[k].from);
    shv_node_grid_finish(&contact->grid);
    return fill_facet_grid(contact, region, smallest, error);
}
