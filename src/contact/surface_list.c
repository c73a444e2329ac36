#include "contact/surface_list.h"

#include "contact/surface_edge.h"
#include "mesh/facets.h"

void shv_surface_list_release(ShvSurfaceList *list)
{
    shv_release(list->boundary);
    shv_release(list->facets);
    shv_release(list->facet_path);
    shv_release(list->nodes);
    shv_release(list->node_path);
    shv_release(list->node_speed);
    shv_release(list->slot);
    shv_release(list->cracks);
    shv_release(list->place);
    shv_release(list->outdated.items);
    *list = (ShvSurfaceList){0};
}

/* ---- rooms ---- */

static ShvStatus reserve_slots(ShvSurfaceList *list, const ShvState *state, ShvError *error)
{
    if (list->slot_capacity >= state->node_capacity) return SHV_OK;
    const size_t capacity = (size_t)state->node_capacity;
    SHV_RESIZE(list->memory, SHV_PART_CONTACT, list->slot, capacity, "contact of surfaces", capacity * sizeof(int32_t),
               error);
    for (int32_t i = list->slot_capacity; i < state->node_capacity; i++) list->slot[i] = -1;
    list->slot_capacity = state->node_capacity;
    return SHV_OK;
}

static ShvStatus reserve_places(ShvSurfaceList *list, ShvError *error)
{
    const size_t faces = 4 * (size_t)list->model->mesh.element_count;
    if (list->place) {
        for (int32_t k = 0; k < list->facet_count; k++)
            list->place[4 * (int64_t)list->facets[k].element + list->facets[k].face] = -1;
        return SHV_OK;
    }
    list->place = shv_allocate(list->memory, SHV_PART_CONTACT, faces, sizeof(int32_t));
    if (!list->place) return shv_fail_memory(error, "contact of surfaces", faces * sizeof(int32_t));
    for (size_t k = 0; k < faces; k++) list->place[k] = -1;
    return SHV_OK;
}

/* Where the model keeps no adjacency, its boundary is found once. */
static ShvStatus find_boundary(ShvSurfaceList *list, ShvError *error)
{
    if (list->model->can_break || list->boundary) return SHV_OK;
    return shv_boundary_faces(&list->model->mesh, list->memory, SHV_PART_CONTACT, &list->boundary,
                              &list->boundary_count, error);
}

/* ---- entries ---- */

ShvStatus shv_surface_list_mark_outdated(ShvSurfaceList *list, int32_t slot, ShvError *error)
{
    if (list->nodes[slot].outdated) return SHV_OK;
    list->nodes[slot].outdated = true;
    SHV_GROW(list->memory, SHV_PART_CONTACT, list->outdated.items, list->outdated.capacity, list->outdated.count,
             "contact", error);
    list->outdated.items[list->outdated.count++] = slot;
    return SHV_OK;
}

static ShvStatus grow_nodes(ShvSurfaceList *list, ShvError *error)
{
    const int32_t count = list->node_count;
    int32_t room = list->node_capacity;
    SHV_GROW(list->memory, SHV_PART_CONTACT, list->node_path, room, count, "contact", error);
    room = list->node_capacity;
    SHV_GROW(list->memory, SHV_PART_CONTACT, list->node_speed, room, count, "contact", error);
    SHV_GROW(list->memory, SHV_PART_CONTACT, list->nodes, list->node_capacity, count, "contact", error);
    return SHV_OK;
}

static ShvStatus add_node(ShvSurfaceList *list, int32_t node, int32_t fragment, bool inner, ShvError *error)
{
    if (list->slot[node] < 0) {
        SHV_TRY(grow_nodes(list, error));
        list->slot[node] = list->node_count;
        list->node_path[list->node_count] = list->node_speed[list->node_count] = 0.0;
        list->nodes[list->node_count++] =
            (ShvSurfaceNode){.node = node, .fragment = fragment, .watch = -1, .inner = inner};
    } else if (inner || !list->nodes[list->slot[node]].inner) {
        return SHV_OK;
    }
    list->nodes[list->slot[node]].inner = inner;
    return shv_surface_list_mark_outdated(list, list->slot[node], error);
}

static ShvStatus add_nodes(ShvSurfaceList *list, const ShvState *state, int32_t element, int32_t face, ShvError *error)
{
    int32_t nodes[3];
    shv_surface_corners(state, element, face, nodes);
    for (int k = 0; k < 3; k++) SHV_TRY(add_node(list, nodes[k], state->element_fragment[element], false, error));
    return SHV_OK;
}

void shv_surface_facet_corners(const ShvSurfaceBodies *bodies, const ShvSurfaceFacet *facet, ShvVec3 corners[3])
{
    int32_t nodes[3];
    shv_surface_corners(bodies->state, facet->element, facet->face, nodes);
    for (int k = 0; k < 3; k++) corners[k] = shv_bodies_position(bodies, nodes[k], facet->fragment);
}

void shv_surface_facet_measure(const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet)
{
    ShvVec3 x[3];
    shv_surface_facet_corners(bodies, facet, x);
    facet->box = shv_box_empty();
    for (int k = 0; k < 3; k++) shv_box_add(&facet->box, x[k]);
    const int32_t apex = shv_state_node(bodies->state, facet->element, facet->face);
    const ShvVec3 n = shv_unit(shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0])));
    const double altitude = shv_dot(n, shv_sub(x[0], shv_bodies_position(bodies, apex, facet->fragment)));
    for (int k = 0; k < 3; k++) shv_box_add(&facet->box, shv_madd(x[k], -0.5 * altitude, n));
}

void shv_surface_list_measure(ShvSurfaceList *list, const ShvSurfaceBodies *bodies)
{
    for (int32_t k = 0; k < list->facet_count; k++) shv_surface_facet_measure(bodies, &list->facets[k]);
}

static ShvStatus add_facet(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t element, int32_t face,
                           ShvError *error)
{
    const int32_t fragment = bodies->state->element_fragment[element];
    if (!shv_bodies_active(bodies, fragment)) return SHV_OK;
    SHV_TRY(add_nodes(list, bodies->state, element, face, error));
    if (shv_bodies_alone(bodies, fragment)) return SHV_OK;
    int32_t room = list->facet_capacity;
    SHV_GROW(list->memory, SHV_PART_CONTACT, list->facet_path, room, list->facet_count, "contact", error);
    SHV_GROW(list->memory, SHV_PART_CONTACT, list->facets, list->facet_capacity, list->facet_count, "contact", error);
    list->facet_path[list->facet_count] = 0.0;
    list->place[4 * (int64_t)element + face] = list->facet_count;
    ShvSurfaceFacet *facet = &list->facets[list->facet_count++];
    *facet = (ShvSurfaceFacet){.element = element, .face = face, .fragment = fragment, .across = {-1, -1, -1}};
    int32_t nodes[3];
    shv_surface_corners(bodies->state, element, face, nodes);
    for (int k = 0; k < 3; k++) facet->slots[k] = list->slot[nodes[k]];
    shv_surface_facet_measure(bodies, facet);
    if (bodies->cohesive) shv_surface_edges_link(list, list->facet_count - 1);
    return SHV_OK;
}

static bool is_near_obstacle(const ShvObstacles *obstacles, ShvVec3 x, double distance)
{
    for (int32_t k = 0; k < obstacles->count; k++)
        if (shv_obstacle_closest(&obstacles->items[k], x, distance).gap < distance) return true;
    return false;
}

ShvStatus shv_surface_list_inner(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, double distance, ShvError *error)
{
    const ShvState *state = bodies->state;
    if (!bodies->obstacles || bodies->barred) return SHV_OK;
    for (int32_t i = 0; i < state->node_count; i++) {
        if (list->slot[i] >= 0 || state->corner_count[i] == 0) continue;
        const int32_t fragment = state->element_fragment[state->corners[state->corner_start[i]] / 4];
        if (bodies->awake[fragment] && is_near_obstacle(bodies->obstacles, shv_state_position(state, i), distance))
            SHV_TRY(add_node(list, i, fragment, true, error));
    }
    return SHV_OK;
}

/* ---- cracks ---- */

static ShvStatus add_sides(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t index, ShvError *error)
{
    const ShvAdjacency *adjacency = &list->model->adjacency;
    const int64_t facet = bodies->cohesive->facet[index];
    for (int side = 0; side < 2; side++)
        SHV_TRY(add_facet(list, bodies, adjacency->facet_elements[2 * facet + side],
                          adjacency->facet_faces[2 * facet + side], error));
    return SHV_OK;
}

static ShvStatus add_crack(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t index, ShvError *error)
{
    const int32_t *elements = list->model->adjacency.facet_elements + 2 * (int64_t)bodies->cohesive->facet[index];
    const int32_t *fragment = bodies->state->element_fragment;
    if (!shv_bodies_active(bodies, fragment[elements[0]]) && !shv_bodies_active(bodies, fragment[elements[1]]))
        return SHV_OK;
    SHV_GROW(list->memory, SHV_PART_CONTACT, list->cracks, list->crack_capacity, list->crack_count, "contact", error);
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

/* Whether a crack that has not separated lies between a node and another copy of it. */
static bool is_held(const ShvCohesive *cohesive, const ShvState *state, const ShvAdjacency *adjacency, int32_t node)
{
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t corner = state->corners[state->corner_start[node] + i];
        for (int k = 0; k < 4; k++) {
            const int32_t facet = adjacency->element_facets[4 * (int64_t)(corner / 4) + k];
            if (k == corner % 4 || facet >= adjacency->interior_count || cohesive->facet_cohesive[facet] < 0) continue;
            const int32_t index = cohesive->facet_cohesive[facet];
            if (cohesive->phase[index] == SHV_COHESIVE_SEPARATED) continue;
            const ShvCohesiveSides *sides = &cohesive->sides[index];
            for (int c = 0; c < 3; c++)
                if (sides->first[c] != sides->second[c] && (sides->first[c] == node || sides->second[c] == node))
                    return true;
        }
    }
    return false;
}

static ShvStatus hold_node(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t node, ShvError *error)
{
    const int32_t slot = list->slot[node];
    if (slot < 0) return SHV_OK;
    const bool held = is_held(bodies->cohesive, bodies->state, &list->model->adjacency, node);
    if (list->nodes[slot].held && !held) SHV_TRY(shv_surface_list_mark_outdated(list, slot, error));
    list->nodes[slot].held = held;
    return SHV_OK;
}

static ShvStatus hold_sides(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t index, ShvError *error)
{
    for (int c = 0; c < 3; c++) {
        SHV_TRY(hold_node(list, bodies, bodies->cohesive->sides[index].first[c], error));
        SHV_TRY(hold_node(list, bodies, bodies->cohesive->sides[index].second[c], error));
    }
    return SHV_OK;
}

static ShvStatus follow_crack(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvSurfaceCrack *crack,
                              ShvError *error)
{
    const uint8_t phase = bodies->cohesive->phase[crack->index];
    if (phase == SHV_COHESIVE_SEPARATED) return add_sides(list, bodies, crack->index, error);
    if ((phase == SHV_COHESIVE_CARRYING && bodies->cohesive->bonded[crack->index]) || crack->open) return SHV_OK;
    SHV_TRY(open_crack(list, bodies, crack->index, error));
    crack->open = true;
    return SHV_OK;
}

/* Nodes that have come, and those of cracks that have separated, may be held or not. */
ShvStatus shv_surface_list_update(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvError *error)
{
    int32_t kept = 0;
    for (int32_t k = 0; k < list->crack_count; k++) {
        const int32_t index = list->cracks[k].index;
        SHV_TRY(follow_crack(list, bodies, &list->cracks[k], error));
        if (bodies->cohesive->phase[index] == SHV_COHESIVE_SEPARATED)
            SHV_TRY(hold_sides(list, bodies, index, error));
        else
            list->cracks[kept++] = list->cracks[k];
    }
    list->crack_count = kept;
    for (int32_t k = 0; k < list->outdated.count; k++)
        SHV_TRY(hold_node(list, bodies, list->nodes[list->outdated.items[k]].node, error));
    return SHV_OK;
}

/* ---- insertions ---- */

static ShvStatus follow_facet(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet,
                              ShvError *error)
{
    int32_t nodes[3];
    shv_surface_corners(bodies->state, facet->element, facet->face, nodes);
    for (int k = 0; k < 3; k++) {
        if (list->nodes[facet->slots[k]].node == nodes[k]) continue;
        SHV_TRY(add_node(list, nodes[k], list->nodes[facet->slots[k]].fragment, false, error));
        facet->slots[k] = list->slot[nodes[k]];
    }
    return SHV_OK;
}

/* The facets of all tets at a node that has come since. Where none of them is listed it meets what the node does that it was split from,
   until the cracks round it have separated: an obstacle that held one lets neither through. */
static ShvStatus follow_node(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t node, ShvError *error)
{
    const ShvState *state = bodies->state;
    const int32_t fragment = state->element_fragment[state->corners[state->corner_start[node]] / 4];
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t element = state->corners[state->corner_start[node] + i] / 4;
        for (int face = 0; face < 4; face++) {
            const int32_t place = list->place[4 * (int64_t)element + face];
            if (place >= 0) SHV_TRY(follow_facet(list, bodies, &list->facets[place], error));
        }
    }
    const int32_t from = list->slot[shv_state_split_from(state, node)];
    return from >= 0 ? add_node(list, node, fragment, list->nodes[from].inner, error) : SHV_OK;
}

/* A node that was split, or a copy: it has fewer facets now, and neighbours that it may meet. */
static ShvStatus split_node(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t node, ShvError *error)
{
    const int32_t slot = list->slot[node];
    if (slot < 0) return SHV_OK;
    SHV_TRY(shv_surface_list_mark_outdated(list, slot, error));
    return hold_node(list, bodies, node, error);
}

static void name_fragments(ShvSurfaceList *list, const ShvState *state)
{
    for (int32_t k = 0; k < list->facet_count; k++)
        list->facets[k].fragment = state->element_fragment[list->facets[k].element];
    for (int32_t k = 0; k < list->node_count; k++) {
        const int32_t corner = state->corners[state->corner_start[list->nodes[k].node]];
        list->nodes[k].fragment = state->element_fragment[corner / 4];
    }
}

ShvStatus shv_surface_list_follow(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvSurfaceKnown known,
                                  ShvError *error)
{
    const ShvState *state = bodies->state;
    SHV_TRY(reserve_slots(list, state, error));
    for (int32_t node = known.nodes; node < state->node_count; node++) SHV_TRY(follow_node(list, bodies, node, error));
    if (known.fragments != bodies->fragment_count) name_fragments(list, state);
    for (int32_t i = known.cohesive; i < bodies->cohesive->count; i++) SHV_TRY(add_crack(list, bodies, i, error));
    for (int32_t node = known.nodes; node < state->node_count; node++) {
        SHV_TRY(split_node(list, bodies, node, error));
        SHV_TRY(split_node(list, bodies, shv_state_split_from(state, node), error));
    }
    return SHV_OK;
}

/* ---- all ---- */

static ShvStatus add_boundary(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvError *error)
{
    const ShvAdjacency *adjacency = &list->model->adjacency;
    for (int32_t k = 0; k < list->boundary_count; k++)
        SHV_TRY(add_facet(list, bodies, list->boundary[k] / 4, list->boundary[k] % 4, error));
    for (int64_t k = adjacency->interior_count; k < adjacency->facet_count; k++)
        SHV_TRY(add_facet(list, bodies, adjacency->facet_elements[2 * k], adjacency->facet_faces[2 * k], error));
    return SHV_OK;
}

ShvStatus shv_surface_list_build(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvError *error)
{
    for (int32_t k = 0; k < list->node_count; k++) list->slot[list->nodes[k].node] = -1;
    SHV_TRY(reserve_places(list, error));
    list->node_count = list->facet_count = list->crack_count = list->outdated.count = 0;
    SHV_TRY(reserve_slots(list, bodies->state, error));
    SHV_TRY(find_boundary(list, error));
    SHV_TRY(add_boundary(list, bodies, error));
    if (!bodies->cohesive) return shv_surface_edges_link_all(list, error);
    for (int32_t i = 0; i < bodies->cohesive->count; i++) SHV_TRY(add_crack(list, bodies, i, error));
    SHV_TRY(shv_surface_list_update(list, bodies, error));
    for (int32_t k = 0; k < list->node_count; k++) SHV_TRY(hold_node(list, bodies, list->nodes[k].node, error));
    return SHV_OK;
}
