#include "model/precrack.h"

#include <string.h>

#include "base/disjoint_sets.h"
#include "mesh/adjacency.h"
#include "model/selection.h"

typedef struct Cut {
    ShvMesh *mesh;
    ShvAdjacency adjacency;
    uint8_t *open;   /* per interior facet */
    int32_t *parent; /* per corner, 4 × element + corner: corners that stay one node have one root */
    int32_t *owner;  /* per node: the root that keeps it, −1: none yet */
} Cut;

/* ---- which facets ---- */

static ShvVec3 facet_corner(const Cut *cut, int32_t facet, int corner)
{
    const int32_t element = cut->adjacency.facet_elements[2 * (int64_t)facet];
    const uint8_t *corners = shv_face_corners[cut->adjacency.facet_faces[2 * (int64_t)facet]];
    return shv_mesh_position(cut->mesh, cut->mesh->elements[4 * (int64_t)element + corners[corner]]);
}

/* All corners near the plane, the centroid in the box. */
static bool is_on(const Cut *cut, int32_t facet, const ShvCrackDefinition *crack)
{
    ShvVec3 centre = shv_vec3(0.0, 0.0, 0.0);
    for (int k = 0; k < 3; k++) {
        const ShvVec3 x = facet_corner(cut, facet, k);
        if (!shv_selection_contains(&crack->plane, x)) return false;
        centre = shv_madd(centre, 1.0 / 3.0, x);
    }
    return shv_selection_contains(&crack->box, centre);
}

static ShvStatus choose_facets(Cut *cut, const ShvObjectDefinition *object, ShvError *error)
{
    for (int32_t i = 0; i < object->crack_count; i++) {
        int32_t met = 0;
        for (int32_t f = 0; f < cut->adjacency.interior_count; f++) {
            if (!is_on(cut, f, &object->cracks[i])) continue;
            cut->open[f] = 1;
            met++;
        }
        if (met == 0)
            return shv_fail(
                error, SHV_BAD_INPUT,
                "objects.%s.cracks.%d meets no facet of the mesh: none between two tets has all corners within "
                "%g m of its plane and its middle in its box; move it to where the mesh has facets, or give a "
                "larger tolerance",
                object->name, (int)i, object->cracks[i].plane.tolerance);
    }
    return SHV_OK;
}

/* ---- which corners stay together ---- */

/* The corner of a tet at a node. */
static int32_t corner_at(const ShvMesh *mesh, int32_t element, int32_t node)
{
    const int32_t *nodes = mesh->elements + 4 * (int64_t)element;
    int corner = 0;
    while (nodes[corner] != node) corner++;
    return 4 * element + corner;
}

static void join_across(Cut *cut, int32_t facet)
{
    const int32_t *pair = cut->adjacency.facet_elements + 2 * (int64_t)facet;
    const uint8_t *corners = shv_face_corners[cut->adjacency.facet_faces[2 * (int64_t)facet]];
    for (int k = 0; k < 3; k++) {
        const int32_t own = 4 * pair[0] + corners[k];
        shv_set_join(cut->parent, own, corner_at(cut->mesh, pair[1], cut->mesh->elements[own]));
    }
}

/* Nodes that lie on no crack stay one, however their tets meet there. */
static void join_corners(Cut *cut)
{
    const ShvAdjacency *adjacency = &cut->adjacency;
    const int32_t nodes = cut->mesh->node_count;
    for (int32_t i = 0; i < 4 * cut->mesh->element_count; i++) cut->parent[i] = i;
    for (int32_t n = 0; n < nodes; n++) cut->owner[n] = -2;
    for (int32_t f = 0; f < adjacency->interior_count; f++) {
        if (!cut->open[f]) {
            join_across(cut, f);
            continue;
        }
        const int32_t element = adjacency->facet_elements[2 * (int64_t)f];
        const uint8_t *corners = shv_face_corners[adjacency->facet_faces[2 * (int64_t)f]];
        for (int k = 0; k < 3; k++) cut->owner[cut->mesh->elements[4 * (int64_t)element + corners[k]]] = -1;
    }
    for (int32_t n = 0; n < nodes; n++)
        for (int32_t i = adjacency->corner_start[n]; cut->owner[n] == -2 && i < adjacency->corner_start[n + 1]; i++)
            cut->parent[adjacency->corners[i]] = adjacency->corners[adjacency->corner_start[n]];
}

/* ---- the parted mesh ---- */

/* The first group of corners keeps its node; returns how many nodes there are, with new ones for the others. */
static int32_t number_nodes(Cut *cut, int32_t *number)
{
    const int32_t corners = 4 * cut->mesh->element_count;
    int32_t count = cut->mesh->node_count;
    for (int32_t i = 0; i < corners; i++) {
        const int32_t node = cut->mesh->elements[i], root = shv_set_root(cut->parent, i);
        if (cut->owner[node] < 0) cut->owner[node] = root;
        if (root == i) number[i] = cut->owner[node] == root ? node : count++;
    }
    for (int32_t i = 0; i < corners; i++) number[i] = number[shv_set_root(cut->parent, i)];
    return count;
}

static ShvStatus part(Cut *cut, ShvError *error)
{
    ShvMesh *mesh = cut->mesh, parted;
    const size_t corners = 4 * (size_t)mesh->element_count;
    int32_t *number = shv_allocate(mesh->memory, SHV_PART_MESH, corners, sizeof *number);
    if (!number) return shv_fail_memory(error, "nodes of a crack", corners * sizeof *number);
    const int32_t count = number_nodes(cut, number);
    const ShvStatus status = shv_mesh_allocate(&parted, mesh->memory, count, mesh->element_count, error);
    if (status == SHV_OK) {
        for (size_t i = 0; i < corners; i++) {
            parted.elements[i] = number[i];
            memcpy(parted.positions + 3 * (int64_t)number[i], mesh->positions + 3 * (int64_t)mesh->elements[i],
                   3 * sizeof *parted.positions);
        }
        shv_mesh_release(mesh);
        *mesh = parted;
    }
    shv_release(number);
    return status;
}

ShvStatus shv_precrack_open(ShvMesh *mesh, const ShvObjectDefinition *object, ShvError *error)
{
    Cut cut = {.mesh = mesh};
    if (object->crack_count == 0) return SHV_OK;
    SHV_TRY(shv_adjacency_build(&cut.adjacency, mesh, error));
    const size_t facets = (size_t)cut.adjacency.interior_count, corners = 4 * (size_t)mesh->element_count;
    cut.open = shv_allocate(mesh->memory, SHV_PART_MESH, facets, 1);
    cut.parent = shv_allocate(mesh->memory, SHV_PART_MESH, corners, sizeof *cut.parent);
    cut.owner = shv_allocate(mesh->memory, SHV_PART_MESH, (size_t)mesh->node_count, sizeof *cut.owner);
    ShvStatus status =
        cut.open && cut.parent && cut.owner ? SHV_OK : shv_fail_memory(error, "cracks", corners * sizeof *cut.parent);
    if (status == SHV_OK) status = choose_facets(&cut, object, error);
    if (status == SHV_OK) {
        join_corners(&cut);
        status = part(&cut, error);
    }
    shv_adjacency_release(&cut.adjacency);
    shv_release(cut.open);
    shv_release(cut.parent);
    shv_release(cut.owner);
    return status;
}
