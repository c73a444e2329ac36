#include "fragment/fragment.h"

#include "mesh/facets.h"
#include "mesh/tet.h"

/* Whether the other side of a face uses the same three copies of the face's nodes. */
static bool shares_face(const ShvState *state, int32_t element, int32_t face, int32_t other, int32_t other_face)
{
    for (int a = 0; a < 3; a++) {
        const int32_t node = shv_state_node(state, element, shv_face_corners[face][a]);
        bool found = false;
        for (int b = 0; b < 3; b++) found |= shv_state_node(state, other, shv_face_corners[other_face][b]) == node;
        if (!found) return false;
    }
    return true;
}

static bool is_on_boundary(const ShvFragments *fragments, const ShvModel *model, int32_t element, int32_t face)
{
    if (fragments->boundary) return fragments->boundary[element] >> face & 1;
    return model->adjacency.element_facets[4 * (int64_t)element + face] >= model->adjacency.interior_count;
}

/* Which of the two sides of a face inside the mesh is the other one. */
static int64_t other_side(const ShvAdjacency *adjacency, int32_t element, int32_t face)
{
    const int64_t facet = adjacency->element_facets[4 * (int64_t)element + face];
    return 2 * facet + (adjacency->facet_elements[2 * facet] == element);
}

static bool is_open(const ShvFragments *fragments, const ShvModel *model, const ShvState *state, int32_t element,
                    int32_t face)
{
    if (is_on_boundary(fragments, model, element, face)) return true;
    if (fragments->boundary) return false;
    if (shv_fragments_bonded_neighbour(fragments, element, face) >= 0) return false;
    const ShvAdjacency *adjacency = &model->adjacency;
    const int64_t other = other_side(adjacency, element, face);
    return !shares_face(state, element, face, adjacency->facet_elements[other], adjacency->facet_faces[other]);
}

/* To another fragment or to the outside. */
static bool is_outside(const ShvFragments *fragments, const ShvModel *model, const ShvState *state, int32_t element,
                       int32_t face)
{
    if (is_on_boundary(fragments, model, element, face)) return true;
    if (fragments->boundary) return false;
    const int32_t other = model->adjacency.facet_elements[other_side(&model->adjacency, element, face)];
    return state->element_fragment[other] != state->element_fragment[element];
}

double shv_fragment_surface_area(const ShvFragment *fragment, const ShvFragments *fragments, const ShvModel *model,
                                 const ShvState *state)
{
    const int32_t *elements = fragments->elements + fragment->element_begin;
    double area = 0.0;
    for (int32_t i = 0; i < fragment->element_count; i++)
        for (int32_t face = 0; face < 4; face++)
            if (is_outside(fragments, model, state, elements[i], face))
                area += shv_tet_face_area(&model->mesh, model->mesh.elements + 4 * (int64_t)elements[i], face);
    return area;
}

enum { INSIDE = 0, ON_SURFACE = 1 };

static void mark_surface(const ShvFragments *fragments, const ShvModel *model, const ShvState *state,
                         const ShvFragment *fragment)
{
    const int32_t *nodes = fragments->nodes + fragment->node_begin;
    for (int32_t i = 0; i < fragment->node_count; i++) fragments->label[nodes[i]] = INSIDE;
    const int32_t *elements = fragments->elements + fragment->element_begin;
    for (int32_t i = 0; i < fragment->element_count; i++)
        for (int32_t face = 0; face < 4; face++)
            if (is_open(fragments, model, state, elements[i], face))
                for (int a = 0; a < 3; a++)
                    fragments->label[shv_state_node(state, elements[i], shv_face_corners[face][a])] = ON_SURFACE;
}

ShvStatus shv_fragment_surface(const ShvFragments *fragments, const ShvModel *model, const ShvState *state,
                               int32_t fragment, int32_t **nodes, int32_t *count, ShvError *error)
{
    const ShvFragment *item = &fragments->items[fragment];
    const int32_t *all = fragments->nodes + item->node_begin;
    mark_surface(fragments, model, state, item);
    *count = 0;
    for (int32_t i = 0; i < item->node_count; i++) *count += fragments->label[all[i]] == ON_SURFACE;
    *nodes = shv_allocate(fragments->memory, SHV_PART_RIGID, (size_t)*count, sizeof(int32_t));
    if (!*nodes) return shv_fail_memory(error, "the surface of a fragment", (size_t)*count * sizeof(int32_t));
    int32_t end = 0;
    for (int32_t i = 0; i < item->node_count; i++)
        if (fragments->label[all[i]] == ON_SURFACE) (*nodes)[end++] = all[i];
    return SHV_OK;
}

/* As a mesh of its own, whose nodes are numbered from 0. */
ShvStatus shv_fragment_faces(const ShvFragments *fragments, const ShvState *state, int32_t fragment, int32_t **faces,
                             int32_t *count, ShvError *error)
{
    const ShvFragment *item = &fragments->items[fragment];
    const int32_t *own = fragments->elements + item->element_begin, *nodes = fragments->nodes + item->node_begin;
    const size_t corners = 4 * (size_t)item->element_count;
    *faces = NULL;
    int32_t *elements = shv_allocate(fragments->memory, SHV_PART_RIGID, corners, sizeof *elements);
    if (!elements) return shv_fail_memory(error, "the surface of a fragment", corners * sizeof *elements);
    for (int32_t i = 0; i < item->node_count; i++) fragments->label[nodes[i]] = i;
    for (int32_t i = 0; i < item->element_count; i++)
        for (int k = 0; k < 4; k++) elements[4 * (int64_t)i + k] = fragments->label[shv_state_node(state, own[i], k)];
    const ShvMesh mesh = {.memory = fragments->memory,
                          .node_count = item->node_count,
                          .element_count = item->element_count,
                          .elements = elements};
    const ShvStatus status = shv_boundary_faces(&mesh, fragments->memory, SHV_PART_RIGID, faces, count, error);
    for (int32_t k = 0; status == SHV_OK && k < *count; k++) (*faces)[k] = 4 * own[(*faces)[k] / 4] + (*faces)[k] % 4;
    shv_release(elements);
    return status;
}
