#include "cohesive/frame.h"

/* Copies have one reference position, so the middle of a pair relative to that of corner 0 loses no digits far from the
   origin. */
static ShvVec3 middle(const ShvState *state, const ShvCohesiveFrame *frame, int corner)
{
    const int64_t a = 3 * (int64_t)frame->first[corner], b = 3 * (int64_t)frame->second[corner];
    const int64_t origin = 3 * (int64_t)frame->first[0];
    const ShvVec3 arm = shv_sub(shv_load3(state->reference + a), shv_load3(state->reference + origin));
    const ShvVec3 sum = shv_add(shv_load3(state->displacement + a), shv_load3(state->displacement + b));
    return shv_madd(arm, 0.5, sum);
}

ShvCohesiveFrame shv_cohesive_frame(const ShvCohesive *cohesive, const ShvState *state, int32_t cohesive_facet)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const int64_t facet = cohesive->facet[cohesive_facet];
    const int32_t *elements = adjacency->facet_elements + 2 * facet;
    const uint8_t *faces = adjacency->facet_faces + 2 * facet;
    ShvCohesiveFrame frame;
    for (int i = 0; i < 3; i++) {
        const uint8_t partner = cohesive->partner[3 * (int64_t)cohesive_facet + i];
        frame.first[i] = shv_state_node(state, elements[0], shv_face_corners[faces[0]][i]);
        frame.second[i] = shv_state_node(state, elements[1], shv_face_corners[faces[1]][partner]);
    }
    const ShvVec3 start = middle(state, &frame, 0);
    const ShvVec3 side = shv_sub(middle(state, &frame, 1), start), other = shv_sub(middle(state, &frame, 2), start);
    frame.normal = shv_unit(shv_cross(side, other));
    return frame;
}

ShvVec3 shv_cohesive_opening(const ShvState *state, int32_t first, int32_t second)
{
    return shv_sub(shv_load3(state->displacement + 3 * (int64_t)second),
                   shv_load3(state->displacement + 3 * (int64_t)first));
}

ShvOpening shv_cohesive_components(ShvVec3 opening, ShvVec3 normal)
{
    const double n = shv_dot(opening, normal);
    return (ShvOpening){n, shv_norm(shv_madd(opening, -n, normal))};
}

ShvVec3 shv_cohesive_reference_area(const ShvModel *model, int32_t facet)
{
    const int64_t element = model->adjacency.facet_elements[2 * (int64_t)facet];
    const uint8_t *corners = shv_face_corners[model->adjacency.facet_faces[2 * (int64_t)facet]];
    const int32_t *nodes = model->mesh.elements + 4 * element;
    const ShvVec3 start = shv_mesh_position(&model->mesh, nodes[corners[0]]);
    const ShvVec3 side = shv_sub(shv_mesh_position(&model->mesh, nodes[corners[1]]), start);
    const ShvVec3 other = shv_sub(shv_mesh_position(&model->mesh, nodes[corners[2]]), start);
    return shv_scale(shv_cross(side, other), 0.5);
}
