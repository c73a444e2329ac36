#include "contact/surface_edge.h"

#include "mesh/edge_table.h"

/* ---- facets across edges ---- */

static void join(ShvSurfaceList *list, int32_t a, int32_t b)
{
    list->facets[a / 3].across[a % 3] = b;
    list->facets[b / 3].across[b % 3] = a;
}

/* The edge of a face between two nodes of the mesh, −1: it has none. */
static int edge_between(const int32_t *nodes, int face, int32_t p, int32_t q)
{
    for (int k = 0; k < 3; k++) {
        const int32_t start = nodes[shv_face_corners[face][k]], end = nodes[shv_face_corners[face][(k + 1) % 3]];
        if ((start == p && end == q) || (start == q && end == p)) return k;
    }
    return -1;
}

/* Round an edge, from tet to tet, up to the next listed face. */
static int32_t find_across(const ShvSurfaceList *list, const ShvSurfaceFacet *facet, int edge)
{
    const ShvAdjacency *adjacency = &list->model->adjacency;
    const int32_t *elements = list->model->mesh.elements;
    const int32_t own = adjacency->element_facets[4 * (int64_t)facet->element + facet->face];
    int32_t element = facet->element;
    int face = facet->face;
    const int32_t p = elements[4 * (int64_t)element + shv_face_corners[face][edge]];
    const int32_t q = elements[4 * (int64_t)element + shv_face_corners[face][(edge + 1) % 3]];
    for (int k = edge;; k = edge_between(elements + 4 * (int64_t)element, face, p, q)) {
        face = shv_face_corners[face][(k + 2) % 3]; /* the tet's other face at the edge */
        const int32_t place = list->place[4 * (int64_t)element + face];
        if (place >= 0) return 3 * place + edge_between(elements + 4 * (int64_t)element, face, p, q);
        const int32_t through = adjacency->element_facets[4 * (int64_t)element + face];
        if (through >= adjacency->interior_count || through == own) return -1;
        const int side = adjacency->facet_elements[2 * (int64_t)through] == element;
        element = adjacency->facet_elements[2 * (int64_t)through + side];
        face = adjacency->facet_faces[2 * (int64_t)through + side];
    }
}

void shv_surface_edges_link(ShvSurfaceList *list, int32_t place)
{
    for (int k = 0; k < 3; k++) {
        const int32_t across = find_across(list, &list->facets[place], k);
        if (across >= 0) join(list, 3 * place + k, across);
    }
}

ShvStatus shv_surface_edges_link_all(ShvSurfaceList *list, ShvError *error)
{
    const int32_t half_edges = 3 * list->facet_count;
    ShvEdgeTable table = {0};
    int32_t *nodes = shv_allocate(list->memory, SHV_PART_CONTACT, (size_t)half_edges + 1, sizeof(int32_t));
    ShvStatus status =
        nodes ? SHV_OK : shv_fail_memory(error, "contact of surfaces", ((size_t)half_edges + 1) * sizeof(int32_t));
    for (int32_t h = 0; status == SHV_OK && h < half_edges; h++) nodes[h] = list->facets[h / 3].slots[h % 3];
    if (status == SHV_OK) status = shv_edge_table_create(&table, list->memory, nodes, half_edges, error);
    for (int32_t h = 0; status == SHV_OK && h < half_edges; h++) {
        const int32_t across = shv_edge_table_find(&table, shv_half_edge_end(nodes, h), shv_half_edge_start(nodes, h));
        shv_edge_table_insert(&table, h);
        if (across >= 0) join(list, h, across);
    }
    shv_edge_table_release(&table);
    shv_release(nodes);
    return status;
}

/* ---- sharp edges ---- */

bool shv_surface_edge(const ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t half_edge, ShvEdge *edge)
{
    const ShvSurfaceFacet *facet = &list->facets[half_edge / 3];
    const int32_t across = facet->across[half_edge % 3];
    if (across < 0) return false;
    *edge =
        (ShvEdge){.element = facet->element, .face = facet->face, .fragment = facet->fragment, .edge = half_edge % 3};
    for (int k = 0; k < 3; k++) {
        edge->corners[k] = list->nodes[facet->slots[k]].node;
        edge->places[k] = shv_bodies_position(bodies, edge->corners[k], facet->fragment);
    }
    const ShvSurfaceFacet *second = &list->facets[across / 3];
    const int32_t opposite = list->nodes[second->slots[(across + 2) % 3]].node;
    edge->opposite = shv_bodies_position(bodies, opposite, second->fragment);
    return true;
}

static bool is_sharp(const ShvEdge *edge)
{
    const double least = 0.9961946980917455; /* cosine of SHV_SHARP_EDGE */
    const ShvVec3 start = edge->places[edge->edge];
    const ShvVec3 way = shv_sub(edge->places[(edge->edge + 1) % 3], start), opposite = shv_sub(edge->opposite, start);
    const ShvVec3 own = shv_cross(way, shv_sub(edge->places[(edge->edge + 2) % 3], start));
    const ShvVec3 other = shv_cross(opposite, way);
    return shv_dot(own, opposite) < 0.0 && shv_dot(own, other) < least * shv_norm(own) * shv_norm(other);
}

void shv_surface_edges_mark(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t place)
{
    ShvSurfaceFacet *facet = &list->facets[place];
    facet->sharp = 0;
    for (int k = 0; k < 3; k++) {
        ShvEdge edge;
        if (facet->across[k] / 3 < place && shv_surface_edge(list, bodies, 3 * place + k, &edge) && is_sharp(&edge))
            facet->sharp |= (uint8_t)(1 << k);
    }
}
