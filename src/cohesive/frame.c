#include "cohesive/frame.h"

/* Copies have one reference position, so the arms stay; and the middle of a pair relative to that of corner 0 loses no digits far
   from the origin. */
void shv_cohesive_find_sides(const ShvCohesive *cohesive, const ShvState *state, int32_t cohesive_facet)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const int64_t facet = cohesive->facet[cohesive_facet];
    const uint8_t *faces = adjacency->facet_faces + 2 * facet;
    ShvCohesiveSides *sides = &cohesive->sides[cohesive_facet];
    sides->split = false;
    for (int k = 0; k < 2; k++) sides->elements[k] = adjacency->facet_elements[2 * facet + k];
    for (int i = 0; i < 3; i++) {
        const uint8_t partner = cohesive->partner[3 * (int64_t)cohesive_facet + i];
        sides->first[i] = shv_state_node(state, sides->elements[0], shv_face_corners[faces[0]][i]);
        sides->second[i] = shv_state_node(state, sides->elements[1], shv_face_corners[faces[1]][partner]);
        sides->split = sides->split || sides->first[i] != sides->second[i];
    }
    const ShvVec3 origin = shv_load3(state->reference + 3 * (int64_t)sides->first[0]);
    for (int i = 0; i < 2; i++)
        sides->arm[i] = shv_sub(shv_load3(state->reference + 3 * (int64_t)sides->first[i + 1]), origin);
}

static ShvVec3 twice_shift(const ShvState *state, const ShvCohesiveSides *sides, int corner)
{
    return shv_add(shv_load3(state->displacement + 3 * (int64_t)sides->first[corner]),
                   shv_load3(state->displacement + 3 * (int64_t)sides->second[corner]));
}

ShvCohesiveFrame shv_cohesive_frame(const ShvCohesive *cohesive, const ShvState *state, int32_t cohesive_facet)
{
    const ShvCohesiveSides *sides = &cohesive->sides[cohesive_facet];
    ShvCohesiveFrame frame;
    for (int i = 0; i < 3; i++) {
        frame.first[i] = sides->first[i];
        frame.second[i] = sides->second[i];
    }
    const ShvVec3 start = shv_scale(twice_shift(state, sides, 0), 0.5);
    const ShvVec3 side = shv_sub(shv_madd(sides->arm[0], 0.5, twice_shift(state, sides, 1)), start);
    const ShvVec3 other = shv_sub(shv_madd(sides->arm[1], 0.5, twice_shift(state, sides, 2)), start);
    frame.normal = shv_unit(shv_cross(side, other));
    return frame;
}

ShvVec3 shv_cohesive_opening(const ShvState *state, int32_t first, int32_t second)
{
    return shv_sub(shv_load3(state->displacement + 3 * (int64_t)second),
                   shv_load3(state->displacement + 3 * (int64_t)first));
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
