#include "contact/surface_list.h"

#include "contact/candidates.h"
#include "mesh/facets.h"

void shv_surface_list_release(ShvSurfaceList *list)
{
    shv_release(list->boundary);
    shv_release(list->facets);
    shv_release(list->nodes);
    shv_release(list->slot);
    shv_release(list->cracks);
    *list = (ShvSurfaceList){0};
}

/* ---- rooms ---- */

static ShvStatus reserve_slots(ShvSurfaceList *list, const ShvState *state, ShvError *error)
{
    if (list->slot_capacity >= state->node_capacity) return SHV_OK;
    const size_t capacity = (size_t)state->node_capacity;
    int32_t *grown = shv_reallocate(list->memory, SHV_PART_CONTACT, list->slot, capacity, sizeof(int32_t));
    if (!grown) return shv_fail_memory(error, "contact of surfaces", capacity * sizeof(int32_t));
    list->slot = grown;
    for (int32_t i = list->slot_capacity; i < state->node_capacity; i++) list->slot[i] = -1;
    list->slot_capacity = state->node_capacity;
    return SHV_OK;
}

/* Where the model keeps no adjacency, its boundary is found once. */
static ShvStatus find_boundary(ShvSurfaceList *list, ShvError *error)
{
    if (list->model->can_break || list->boundary) return SHV_OK;
    int32_t *mates, count = 0;
    SHV_TRY(shv_facet_mates(&list->model->mesh, &mates, NULL, error));
    const int32_t faces = 4 * list->model->mesh.element_count;
    for (int32_t k = 0; k < faces; k++) count += mates[k] < 0;
    list->boundary = shv_allocate(list->memory, SHV_PART_CONTACT, (size_t)count, sizeof(int32_t));
    if (list->boundary)
        for (int32_t k = 0; k < faces; k++)
            if (mates[k] < 0) list->boundary[list->boundary_count++] = k;
    shv_release(mates);
    return list->boundary ? SHV_OK : shv_fail_memory(error, "contact of surfaces", (size_t)count * sizeof(int32_t));
}

/* ---- entries ---- */

static ShvStatus add_node(ShvSurfaceList *list, int32_t node, int32_t fragment, ShvError *error)
{
    if (list->slot[node] >= 0) return SHV_OK;
    void *block = list->nodes;
    SHV_TRY(shv_candidates_grow(list->memory, &block, &list->node_capacity, list->node_count, sizeof(ShvSurfaceNode),
                                error));
    list->nodes = block;
    list->slot[node] = list->node_count;
    list->nodes[list->node_count++] =
        (ShvSurfaceNode){.node = node, .fragment = fragment, .watch = -1, .twins = -1, .twin = -1};
    return SHV_OK;
}

static ShvStatus add_nodes(ShvSurfaceList *list, const ShvState *state, int32_t element, int32_t face, ShvError *error)
{
    int32_t nodes[3];
    shv_surface_corners(state, element, face, nodes);
    for (int k = 0; k < 3; k++) SHV_TRY(add_node(list, nodes[k], state->element_fragment[element], error));
    return SHV_OK;
}

static void measure(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet)
{
    int32_t nodes[3];
    ShvVec3 x[3];
    shv_surface_corners(bodies->state, facet->element, facet->face, nodes);
    facet->box = shv_box_empty();
    for (int k = 0; k < 3; k++) {
        x[k] = shv_bodies_position(bodies, nodes[k], facet->fragment);
        shv_box_add(&facet->box, x[k]);
    }
    const int32_t apex = shv_state_node(bodies->state, facet->element, facet->face);
    const ShvVec3 area = shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0])), n = shv_unit(area);
    const double altitude = shv_dot(n, shv_sub(x[0], shv_bodies_position(bodies, apex, facet->fragment)));
    for (int k = 0; k < 3; k++) shv_box_add(&facet->box, shv_madd(x[k], -0.5 * altitude, n));
    for (int k = 0; k < 3; k++) {
        ShvVec3 *normal = &list->nodes[list->slot[nodes[k]]].normal;
        *normal = shv_add(*normal, area);
    }
}

void shv_surface_list_measure(ShvSurfaceList *list, const ShvSurfaceBodies *bodies)
{
    for (int32_t k = 0; k < list->node_count; k++) list->nodes[k].normal = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t k = 0; k < list->facet_count; k++) measure(list, bodies, &list->facets[k]);
}

static ShvStatus add_facet(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t element, int32_t face,
                           bool crack, ShvError *error)
{
    const int32_t fragment = bodies->state->element_fragment[element];
    if (!shv_bodies_active(bodies, fragment)) return SHV_OK;
    SHV_TRY(add_nodes(list, bodies->state, element, face, error));
    void *block = list->facets;
    SHV_TRY(shv_candidates_grow(list->memory, &block, &list->facet_capacity, list->facet_count, sizeof(ShvSurfaceFacet),
                                error));
    list->facets = block;
    ShvSurfaceFacet *facet = &list->facets[list->facet_count++];
    *facet = (ShvSurfaceFacet){.element = element, .face = face, .fragment = fragment, .crack = crack};
    int32_t nodes[3];
    shv_surface_corners(bodies->state, element, face, nodes);
    for (int k = 0; k < 3; k++) facet->slots[k] = list->slot[nodes[k]];
    measure(list, bodies, facet);
    return SHV_OK;
}

/* ---- cracks ---- */

static ShvStatus add_sides(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t index, ShvError *error)
{
    const ShvAdjacency *adjacency = &list->model->adjacency;
    const int64_t facet = bodies->cohesive->facet[index];
    for (int side = 0; side < 2; side++)
        SHV_TRY(add_facet(list, bodies, adjacency->facet_elements[2 * facet + side],
                          adjacency->facet_faces[2 * facet + side], true, error));
    return SHV_OK;
}

static ShvStatus add_crack(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t index, ShvError *error)
{
    const int32_t *elements = list->model->adjacency.facet_elements + 2 * (int64_t)bodies->cohesive->facet[index];
    const int32_t *fragment = bodies->state->element_fragment;
    if (!shv_bodies_active(bodies, fragment[elements[0]]) && !shv_bodies_active(bodies, fragment[elements[1]]))
        return SHV_OK;
    void *block = list->cracks;
    SHV_TRY(shv_candidates_grow(list->memory, &block, &list->crack_capacity, list->crack_count, sizeof(ShvSurfaceCrack),
                                error));
    list->cracks = block;
    list->cracks[list->crack_count++] = (ShvSurfaceCrack){.index = index};
    return SHV_OK;
}

/* Pieces may meet the nodes of a crack that has failed from elsewhere. */
static ShvStatus open_crack(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t index, ShvError *error)
{
    const ShvAdjacency *adjacency = &list->model->adjacency;
    const int64_t facet = bodies->cohesive->facet[index];
    for (int side = 0; side < 2; side++) {
        const int32_t element = adjacency->facet_elements[2 * facet + side];
        if (shv_bodies_active(bodies, bodies->state->element_fragment[element]))
            SHV_TRY(add_nodes(list, bodies->state, element, adjacency->facet_faces[2 * facet + side], error));
    }
    return SHV_OK;
}

static void hold_pairs(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t index)
{
    const ShvAdjacency *adjacency = &list->model->adjacency;
    const int64_t facet = bodies->cohesive->facet[index];
    const int32_t *elements = adjacency->facet_elements + 2 * facet;
    const uint8_t *faces = adjacency->facet_faces + 2 * facet;
    for (int i = 0; i < 3; i++) {
        const uint8_t partner = bodies->cohesive->partner[3 * (int64_t)index + i];
        const int32_t first = shv_state_node(bodies->state, elements[0], shv_face_corners[faces[0]][i]);
        const int32_t second = shv_state_node(bodies->state, elements[1], shv_face_corners[faces[1]][partner]);
        if (first == second) continue;
        if (list->slot[first] >= 0) list->nodes[list->slot[first]].held = true;
        if (list->slot[second] >= 0) list->nodes[list->slot[second]].held = true;
    }
}

static ShvStatus follow_crack(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvSurfaceCrack *crack,
                              ShvError *error)
{
    const uint8_t phase = bodies->cohesive->phase[crack->index];
    if (phase == SHV_COHESIVE_SEPARATED) return add_sides(list, bodies, crack->index, error);
    if (phase == SHV_COHESIVE_CARRYING || crack->open) return SHV_OK;
    SHV_TRY(open_crack(list, bodies, crack->index, error));
    crack->open = true;
    return SHV_OK;
}

/* *changed: whether nodes were added or cracks have parted. */
static ShvStatus follow_cracks(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, bool *changed, ShvError *error)
{
    int32_t kept = 0;
    const int32_t nodes = list->node_count;
    for (int32_t k = 0; k < list->crack_count; k++) {
        SHV_TRY(follow_crack(list, bodies, &list->cracks[k], error));
        if (bodies->cohesive->phase[list->cracks[k].index] != SHV_COHESIVE_SEPARATED)
            list->cracks[kept++] = list->cracks[k];
    }
    *changed = kept != list->crack_count || nodes != list->node_count;
    list->crack_count = kept;
    return SHV_OK;
}

static void hold(ShvSurfaceList *list, const ShvSurfaceBodies *bodies)
{
    for (int32_t k = 0; k < list->node_count; k++) list->nodes[k].held = false;
    for (int32_t k = 0; k < list->crack_count; k++) hold_pairs(list, bodies, list->cracks[k].index);
}

ShvStatus shv_surface_list_part(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvError *error)
{
    bool changed = false;
    SHV_TRY(follow_cracks(list, bodies, &changed, error));
    if (changed) hold(list, bodies);
    return SHV_OK;
}

/* ---- insertions ---- */

/* A copy of a node that a facet has got in place of the one at `slot`. */
static ShvStatus add_copy(ShvSurfaceList *list, int32_t slot, int32_t node, ShvError *error)
{
    const int32_t own = list->node_count;
    SHV_TRY(add_node(list, node, list->nodes[slot].fragment, error));
    ShvSurfaceNode *copy = &list->nodes[own], *original = &list->nodes[slot];
    copy->pace = original->pace;
    copy->from = original->from;
    copy->twin = original->twins;
    original->twins = own;
    return SHV_OK;
}

static ShvStatus follow_facet(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet,
                              ShvError *error)
{
    int32_t nodes[3];
    shv_surface_corners(bodies->state, facet->element, facet->face, nodes);
    facet->changed = false;
    for (int k = 0; k < 3; k++) {
        if (list->nodes[facet->slots[k]].node == nodes[k]) continue;
        if (list->slot[nodes[k]] < 0) SHV_TRY(add_copy(list, facet->slots[k], nodes[k], error));
        facet->slots[k] = list->slot[nodes[k]];
        facet->changed = true;
    }
    facet->fragment = bodies->state->element_fragment[facet->element];
    return SHV_OK;
}

/* Normals of nodes that were split, and of their copies: each has fewer facets now. */
static void part_normals(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t copies)
{
    for (int32_t k = 0; k < list->node_count; k++)
        if (k >= copies || list->nodes[k].twins >= 0) list->nodes[k].normal = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t k = 0; k < list->facet_count; k++) {
        const ShvSurfaceFacet *facet = &list->facets[k];
        ShvVec3 x[3];
        bool concerned = false;
        for (int i = 0; i < 3; i++)
            concerned = concerned || facet->slots[i] >= copies || list->nodes[facet->slots[i]].twins >= 0;
        if (!concerned) continue;
        for (int i = 0; i < 3; i++)
            x[i] = shv_bodies_position(bodies, list->nodes[facet->slots[i]].node, facet->fragment);
        const ShvVec3 area = shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0]));
        for (int i = 0; i < 3; i++) {
            ShvSurfaceNode *node = &list->nodes[facet->slots[i]];
            if (facet->slots[i] >= copies || node->twins >= 0) node->normal = shv_add(node->normal, area);
        }
    }
}

ShvStatus shv_surface_list_follow(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t cohesive,
                                  int32_t *nodes, ShvError *error)
{
    const ShvState *state = bodies->state;
    *nodes = list->node_count;
    SHV_TRY(reserve_slots(list, state, error));
    for (int32_t k = 0; k < list->node_count; k++) list->nodes[k].twins = list->nodes[k].twin = -1;
    for (int32_t k = 0; k < list->facet_count; k++) SHV_TRY(follow_facet(list, bodies, &list->facets[k], error));
    for (int32_t k = 0; k < list->node_count; k++) {
        const int32_t corner = state->corners[state->corner_start[list->nodes[k].node]];
        list->nodes[k].fragment = state->element_fragment[corner / 4];
    }
    if (list->node_count > *nodes) part_normals(list, bodies, *nodes);
    for (int32_t i = cohesive; i < bodies->cohesive->count; i++) SHV_TRY(add_crack(list, bodies, i, error));
    hold(list, bodies);
    return SHV_OK;
}

/* ---- all ---- */

static ShvStatus add_boundary(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvError *error)
{
    const ShvAdjacency *adjacency = &list->model->adjacency;
    for (int32_t k = 0; k < list->boundary_count; k++)
        SHV_TRY(add_facet(list, bodies, list->boundary[k] / 4, list->boundary[k] % 4, false, error));
    for (int64_t k = adjacency->interior_count; k < adjacency->facet_count; k++)
        SHV_TRY(add_facet(list, bodies, adjacency->facet_elements[2 * k], adjacency->facet_faces[2 * k], false, error));
    return SHV_OK;
}

ShvStatus shv_surface_list_gather(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvError *error)
{
    for (int32_t k = 0; k < list->node_count; k++) list->slot[list->nodes[k].node] = -1;
    list->node_count = list->facet_count = list->crack_count = 0;
    SHV_TRY(reserve_slots(list, bodies->state, error));
    SHV_TRY(find_boundary(list, error));
    SHV_TRY(add_boundary(list, bodies, error));
    if (!bodies->cohesive) return SHV_OK;
    for (int32_t i = 0; i < bodies->cohesive->count; i++) SHV_TRY(add_crack(list, bodies, i, error));
    bool changed;
    SHV_TRY(follow_cracks(list, bodies, &changed, error));
    hold(list, bodies);
    return SHV_OK;
}
