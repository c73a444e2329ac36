#include "mesh/facets.h"

static ShvStatus check_corners(const ShvMesh *mesh, const char *what, int32_t element, ShvError *error)
{
    const int32_t *n = mesh->elements + 4 * (int64_t)element;
    for (int i = 0; i < 4; i++)
        if (n[i] < 0 || n[i] >= mesh->node_count)
            return shv_fail(error, SHV_BAD_INPUT, "%s: element %d uses node %d, but nodes run from 0 to %d", what,
                            (int)element, (int)n[i], (int)mesh->node_count - 1);
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++)
            if (n[i] == n[j])
                return shv_fail(error, SHV_BAD_INPUT,
                                "%s: element %d (nodes %d %d %d %d) uses node %d twice; a tetrahedron needs four "
                                "different nodes",
                                what, (int)element, (int)n[0], (int)n[1], (int)n[2], (int)n[3], (int)n[i]);
    return SHV_OK;
}

static ShvStatus check_volume(const ShvMesh *mesh, const char *what, int32_t element, ShvError *error)
{
    const int32_t *n = mesh->elements + 4 * (int64_t)element;
    double longest = 0.0;
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++) {
            const double length = shv_norm(shv_sub(shv_mesh_position(mesh, n[i]), shv_mesh_position(mesh, n[j])));
            if (!(length <= longest)) longest = length;
        }
    const double volume = shv_mesh_element_volume(mesh, element);
    /* Written so that an overflow to infinity or NaN is refused too. */
    if (!(fabs(volume) >= 1e-15 * longest * longest * longest) || longest == 0.0 || !isfinite(volume))
        return shv_fail(error, SHV_BAD_INPUT,
                        "%s: element %d (nodes %d %d %d %d) has no volume (%.3g m³ with a longest edge of %.3g m); "
                        "move or remove it",
                        what, (int)element, (int)n[0], (int)n[1], (int)n[2], (int)n[3], volume, longest);
    if (volume < 0.0)
        return shv_fail(error, SHV_BAD_INPUT,
                        "%s: element %d (nodes %d %d %d %d) is inverted (volume %.6g m³); swap two of its nodes", what,
                        (int)element, (int)n[0], (int)n[1], (int)n[2], (int)n[3], volume);
    return SHV_OK;
}

static ShvStatus check_positions(const ShvMesh *mesh, const char *what, ShvError *error)
{
    for (int32_t node = 0; node < mesh->node_count; node++) {
        const ShvVec3 x = shv_mesh_position(mesh, node);
        if (!shv_finite3(x))
            return shv_fail(error, SHV_BAD_INPUT, "%s: node %d has a coordinate that is not finite (%g, %g, %g)", what,
                            (int)node, x.x, x.y, x.z);
    }
    return SHV_OK;
}

static ShvStatus check_facets(const ShvMesh *mesh, const char *what, ShvError *error)
{
    int32_t *mates = NULL;
    ShvFacetFinding f;
    SHV_TRY(shv_facet_mates(mesh, &mates, &f, error));
    shv_release(mates);
    switch (f.fault) {
    case SHV_FACET_SOUND:
        break;
    case SHV_FACET_DUPLICATE_ELEMENT:
        return shv_fail(error, SHV_BAD_INPUT, "%s: element %d is a duplicate of element %d; remove it", what,
                        (int)f.element, (int)f.other);
    case SHV_FACET_CROWDED:
        return shv_fail(error, SHV_BAD_INPUT,
                        "%s: element %d is at least the third that shares the facet of nodes %d %d %d (another is "
                        "element %d); a facet can lie between two elements at most",
                        what, (int)f.element, (int)f.nodes[0], (int)f.nodes[1], (int)f.nodes[2], (int)f.other);
    case SHV_FACET_OVERLAP:
        return shv_fail(error, SHV_BAD_INPUT,
                        "%s: elements %d and %d overlap: they lie on the same side of their common facet of nodes "
                        "%d %d %d",
                        what, (int)f.element, (int)f.other, (int)f.nodes[0], (int)f.nodes[1], (int)f.nodes[2]);
    }
    return SHV_OK;
}

static ShvStatus check_nodes_used(const ShvMesh *mesh, const char *what, ShvError *error)
{
    uint8_t *used = shv_allocate(mesh->memory, SHV_PART_GENERAL, (size_t)mesh->node_count, sizeof *used);
    if (!used) return shv_fail_memory(error, "the check of a mesh", (size_t)mesh->node_count);
    for (int64_t i = 0; i < 4 * (int64_t)mesh->element_count; i++) used[mesh->elements[i]] = 1;
    int32_t node = 0;
    while (node < mesh->node_count && used[node]) node++;
    shv_release(used);
    if (node < mesh->node_count)
        return shv_fail(error, SHV_BAD_INPUT, "%s: node %d belongs to no element; remove it", what, (int)node);
    return SHV_OK;
}

ShvStatus shv_mesh_validate(const ShvMesh *mesh, const char *what, ShvError *error)
{
    if (mesh->element_count < 1 || mesh->node_count < 4)
        return shv_fail(error, SHV_BAD_INPUT, "%s: a mesh needs at least one tetrahedron, this one has %d and %d nodes",
                        what, (int)mesh->element_count, (int)mesh->node_count);
    if (mesh->element_count > SHV_MESH_LARGEST || mesh->node_count > SHV_MESH_LARGEST)
        return shv_fail(error, SHV_BAD_INPUT, "%s: %d elements and %d nodes are too many; at most %d of each", what,
                        (int)mesh->element_count, (int)mesh->node_count, (int)SHV_MESH_LARGEST);
    for (int32_t e = 0; e < mesh->element_count; e++) SHV_TRY(check_corners(mesh, what, e, error));
    SHV_TRY(check_positions(mesh, what, error));
    for (int32_t e = 0; e < mesh->element_count; e++) SHV_TRY(check_volume(mesh, what, e, error));
    SHV_TRY(check_facets(mesh, what, error));
    return check_nodes_used(mesh, what, error);
}
