#include "conditions/condition_selection.h"

#include <stdlib.h>

static ShvStatus fail_empty(const ShvSelection *selection, const ShvModel *model, const ShvObject *object,
                            ShvError *error)
{
    double least = HUGE_VAL;
    ShvVec3 nearest = {0.0, 0.0, 0.0};
    for (int32_t i = object->node_begin; i < object->node_end; i++) {
        const ShvVec3 x = shv_mesh_position(&model->mesh, i);
        const double distance = shv_selection_distance(selection, x);
        if (!(distance < least)) continue;
        least = distance;
        nearest = x;
    }
    return shv_fail(
        error, SHV_BAD_INPUT,
        "its selection contains no node of object %s, of which the nearest, (%.4g, %.4g, %.4g), lies %.3g m "
        "outside: move the box or plane, or give a larger tolerance",
        object->name, nearest.x, nearest.y, nearest.z, least);
}

ShvStatus shv_selection_nodes(const ShvSelection *selection, const ShvModel *model, const ShvObject *object,
                              int32_t **nodes, int32_t *count, ShvError *error)
{
    const size_t most = (size_t)(object->node_end - object->node_begin);
    *count = 0;
    *nodes = shv_allocate(model->memory, SHV_PART_CONTACT, most, sizeof(int32_t));
    if (!*nodes) return shv_fail_memory(error, "a selection of nodes", most * sizeof(int32_t));
    for (int32_t i = object->node_begin; i < object->node_end; i++)
        if (shv_selection_contains(selection, shv_mesh_position(&model->mesh, i))) (*nodes)[(*count)++] = i;
    return *count > 0 ? SHV_OK : fail_empty(selection, model, object, error);
}

/* ---- facets ---- */

typedef struct ChosenFace {
    int32_t nodes[3]; /* increasing: the two sides of an interior face have the same */
    int32_t element, face;
} ChosenFace;

static int by_nodes(const void *a, const void *b)
{
    const ChosenFace *first = a, *second = b;
    for (int k = 0; k < 3; k++)
        if (first->nodes[k] != second->nodes[k]) return first->nodes[k] < second->nodes[k] ? -1 : 1;
    return (first->element > second->element) - (first->element < second->element);
}

static int by_element(const void *a, const void *b)
{
    const ShvImposedFacet *first = a, *second = b;
    if (first->element != second->element) return first->element < second->element ? -1 : 1;
    return first->face - second->face;
}

static void order_pair(int32_t *a, int32_t *b)
{
    if (*a <= *b) return;
    const int32_t kept = *a;
    *a = *b;
    *b = kept;
}

static bool chosen_face(const ShvSelection *selection, const ShvMesh *mesh, int32_t element, int face,
                        ChosenFace *chosen)
{
    *chosen = (ChosenFace){.element = element, .face = face};
    for (int k = 0; k < 3; k++) {
        chosen->nodes[k] = mesh->elements[4 * (int64_t)element + shv_face_corners[face][k]];
        if (!shv_selection_contains(selection, shv_mesh_position(mesh, chosen->nodes[k]))) return false;
    }
    order_pair(&chosen->nodes[0], &chosen->nodes[1]);
    order_pair(&chosen->nodes[1], &chosen->nodes[2]);
    order_pair(&chosen->nodes[0], &chosen->nodes[1]);
    return true;
}

static bool same_nodes(const ChosenFace *a, const ChosenFace *b)
{
    return a->nodes[0] == b->nodes[0] && a->nodes[1] == b->nodes[1] && a->nodes[2] == b->nodes[2];
}

static ShvVec3 facet_share(const ShvMesh *mesh, const ChosenFace *chosen, ShvVec3 traction)
{
    const ShvVec3 a = shv_mesh_position(mesh, chosen->nodes[0]);
    const ShvVec3 normal = shv_cross(shv_sub(shv_mesh_position(mesh, chosen->nodes[1]), a),
                                     shv_sub(shv_mesh_position(mesh, chosen->nodes[2]), a));
    return shv_scale(traction, 0.5 * shv_norm(normal) / 3.0);
}

static int32_t list_faces(const ShvSelection *selection, const ShvModel *model, const ShvObject *object,
                          ChosenFace *faces)
{
    int32_t count = 0;
    for (int32_t e = object->element_begin; e < object->element_end; e++)
        for (int f = 0; f < 4; f++) {
            ChosenFace chosen;
            if (!chosen_face(selection, &model->mesh, e, f, &chosen)) continue;
            if (faces) faces[count] = chosen;
            count++;
        }
    return count;
}

ShvStatus shv_selection_facets(const ShvSelection *selection, const ShvModel *model, const ShvObject *object,
                               ShvVec3 traction, ShvImposedFacet **facets, int32_t *count, ShvError *error)
{
    const int32_t faces_count = list_faces(selection, model, object, NULL);
    *count = 0;
    *facets = shv_allocate(model->memory, SHV_PART_CONTACT, (size_t)faces_count, sizeof **facets);
    ChosenFace *faces = shv_allocate(model->memory, SHV_PART_CONTACT, (size_t)faces_count, sizeof *faces);
    if (!*facets || !faces) {
        shv_release(*facets);
        shv_release(faces);
        *facets = NULL;
        return shv_fail_memory(error, "a selection of facets", (size_t)faces_count * (sizeof *faces + sizeof **facets));
    }
    list_faces(selection, model, object, faces);
    qsort(faces, (size_t)faces_count, sizeof *faces, by_nodes);
    for (int32_t k = 0; k < faces_count; k++) {
        const bool interior = (k > 0 && same_nodes(&faces[k], &faces[k - 1])) ||
                              (k + 1 < faces_count && same_nodes(&faces[k], &faces[k + 1]));
        if (!interior)
            (*facets)[(*count)++] =
                (ShvImposedFacet){faces[k].element, faces[k].face, facet_share(&model->mesh, &faces[k], traction)};
    }
    shv_release(faces);
    qsort(*facets, (size_t)*count, sizeof **facets, by_element);
    return SHV_OK;
}
