#include "mesh/adjacency.h"

#include "mesh/facets.h"

/* Numbers the facets of one kind (interior or boundary) in increasing order of (lower element, its face). */
static int32_t number_facets(ShvAdjacency *a, const int32_t *mates, int32_t slots, int boundary, int32_t facet)
{
    for (int32_t slot = 0; slot < slots; slot++) {
        const int32_t mate = mates[slot];
        if (boundary ? mate >= 0 : mate < slot) continue;
        a->facet_elements[2 * (int64_t)facet] = slot / 4;
        a->facet_elements[2 * (int64_t)facet + 1] = boundary ? -1 : mate / 4;
        a->facet_faces[2 * (int64_t)facet] = (uint8_t)(slot % 4);
        a->facet_faces[2 * (int64_t)facet + 1] = boundary ? 0 : (uint8_t)(mate % 4);
        a->element_facets[slot] = facet;
        if (!boundary) a->element_facets[mate] = facet;
        facet++;
    }
    return facet;
}

void shv_mesh_corners(const ShvMesh *mesh, int32_t *start, int32_t *corners)
{
    const int32_t slots = 4 * mesh->element_count;
    int32_t sum = slots;
    for (int32_t n = 0; n < mesh->node_count; n++) start[n] = 0;
    for (int32_t slot = 0; slot < slots; slot++) start[mesh->elements[slot]]++;
    for (int32_t n = mesh->node_count - 1; n >= 0; n--) start[n] = sum -= start[n];
    for (int32_t slot = 0; slot < slots; slot++) corners[start[mesh->elements[slot]]++] = slot;
    /* Filling moved every start to the next one's place. */
    for (int32_t n = mesh->node_count - 1; n > 0; n--) start[n] = start[n - 1];
    start[0] = 0;
}

static ShvStatus allocate(ShvAdjacency *a, const ShvMesh *mesh, int32_t facet_count, ShvError *error)
{
    const size_t facets = (size_t)facet_count, slots = 4 * (size_t)mesh->element_count,
                 nodes = (size_t)mesh->node_count;
    ShvMemory *memory = mesh->memory;
    a->facet_elements = shv_allocate(memory, SHV_PART_ADJACENCY, 2 * facets, sizeof *a->facet_elements);
    a->facet_faces = shv_allocate(memory, SHV_PART_ADJACENCY, 2 * facets, sizeof *a->facet_faces);
    a->element_facets = shv_allocate(memory, SHV_PART_ADJACENCY, slots, sizeof *a->element_facets);
    a->corner_start = shv_allocate(memory, SHV_PART_ADJACENCY, nodes + 1, sizeof *a->corner_start);
    a->corners = shv_allocate(memory, SHV_PART_ADJACENCY, slots, sizeof *a->corners);
    if (a->facet_elements && a->facet_faces && a->element_facets && a->corner_start && a->corners) return SHV_OK;
    shv_adjacency_release(a);
    return shv_fail_memory(error, "the facets and node corners of a mesh", 10 * facets + 8 * slots + 4 * nodes + 4);
}

ShvStatus shv_adjacency_build(ShvAdjacency *adjacency, const ShvMesh *mesh, ShvError *error)
{
    *adjacency = (ShvAdjacency){0};
    int32_t *mates = NULL;
    SHV_TRY(shv_facet_mates(mesh, &mates, NULL, error));
    const int32_t slots = 4 * mesh->element_count;
    int32_t boundary = 0;
    for (int32_t slot = 0; slot < slots; slot++) boundary += mates[slot] < 0;
    const int32_t interior = (slots - boundary) / 2;
    const ShvStatus status = allocate(adjacency, mesh, interior + boundary, error);
    if (status == SHV_OK) {
        adjacency->facet_count = interior + boundary;
        adjacency->interior_count = number_facets(adjacency, mates, slots, 0, 0);
        number_facets(adjacency, mates, slots, 1, interior);
        shv_mesh_corners(mesh, adjacency->corner_start, adjacency->corners);
        adjacency->corner_start[mesh->node_count] = slots;
    }
    shv_release(mates);
    return status;
}

void shv_adjacency_release(ShvAdjacency *adjacency)
{
    shv_release(adjacency->facet_elements);
    shv_release(adjacency->facet_faces);
    shv_release(adjacency->element_facets);
    shv_release(adjacency->corner_start);
    shv_release(adjacency->corners);
    *adjacency = (ShvAdjacency){0};
}

ShvStatus shv_mesh_boundary(const ShvMesh *mesh, ShvPart part, int32_t **triangles, int32_t *count, ShvError *error)
{
    *triangles = NULL;
    *count = 0;
    int32_t *mates = NULL;
    SHV_TRY(shv_facet_mates(mesh, &mates, NULL, error));
    const int32_t slots = 4 * mesh->element_count;
    int32_t found = 0;
    for (int32_t slot = 0; slot < slots; slot++) found += mates[slot] < 0;
    int32_t *made = shv_allocate(mesh->memory, part, 3 * (size_t)found, sizeof *made);
    if (made) {
        int64_t next = 0;
        for (int32_t slot = 0; slot < slots; slot++)
            for (int i = 0; mates[slot] < 0 && i < 3; i++)
                made[next++] = mesh->elements[4 * (int64_t)(slot / 4) + shv_face_corners[slot % 4][i]];
        *triangles = made;
        *count = found;
    }
    shv_release(mates);
    return made ? SHV_OK : shv_fail_memory(error, "the boundary of a mesh", 3 * (size_t)found * sizeof *made);
}
