#include "contact/candidates.h"

#include "mesh/facets.h"

enum { STEPS_BETWEEN_CHECKS = 16, STEPS_TO_LAST = 64 };

double shv_candidates_obstacle_speed(const ShvObstacle *obstacle)
{
    if (obstacle->motion == SHV_OBSTACLE_FIXED) return 0.0;
    return shv_norm(obstacle->velocity) + shv_norm(obstacle->angular_velocity) * obstacle->bounding_radius;
}

static double largest_obstacle_speed(const ShvObstacles *obstacles)
{
    double largest = 0.0;
    for (int32_t i = 0; i < obstacles->count; i++)
        largest = fmax(largest, shv_candidates_obstacle_speed(&obstacles->items[i]));
    return largest;
}

static double largest_node_speed(const ShvState *state, const int32_t *nodes, int32_t count)
{
    double largest = 0.0;
    for (int32_t k = 0; k < count; k++) {
        const ShvVec3 v = shv_load3(state->velocity + 3 * (int64_t)nodes[k]);
        const double squared = shv_dot(v, v);
        largest = squared > largest ? squared : largest;
    }
    return sqrt(largest);
}

/* About all nodes. */
typedef struct Ball {
    ShvVec3 centre;
    double radius;
} Ball;

static Ball bound(const ShvState *state, const int32_t *nodes, int32_t count)
{
    if (count == 0) return (Ball){{0.0, 0.0, 0.0}, 0.0};
    ShvVec3 low = shv_state_position(state, nodes[0]), high = low;
    for (int32_t k = 1; k < count; k++) {
        const ShvVec3 x = shv_state_position(state, nodes[k]);
        low = shv_vec3(fmin(low.x, x.x), fmin(low.y, x.y), fmin(low.z, x.z));
        high = shv_vec3(fmax(high.x, x.x), fmax(high.y, x.y), fmax(high.z, x.z));
    }
    return (Ball){shv_scale(shv_add(low, high), 0.5), 0.5 * shv_norm(shv_sub(high, low))};
}

static ShvStatus choose(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles, int32_t index,
                        int32_t node, ShvError *error)
{
    const ShvVec3 x = shv_state_position(state, node);
    if (shv_obstacle_closest(&obstacles->items[index], x, contact->skin).gap >= contact->skin) return SHV_OK;
    if (!(state->mass[node] > 0.0)) return SHV_OK;
    SHV_GROW(contact->memory, SHV_PART_CONTACT, contact->candidates, contact->candidate_capacity,
             contact->candidate_count, "contact", error);
    contact->candidates[contact->candidate_count++] = (ShvNodeCandidate){.node = node, .obstacle = index};
    return SHV_OK;
}

static ShvStatus choose_all(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                            const int32_t *nodes, int32_t count, ShvError *error)
{
    contact->candidate_count = 0;
    for (int32_t i = 0; i < obstacles->count; i++)
        for (int32_t k = 0; k < count; k++) SHV_TRY(choose(contact, state, obstacles, i, nodes[k], error));
    contact->of_nodes = state->node_count;
    contact->listed = count;
    return SHV_OK;
}

static ShvStatus add_copies(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                            ShvError *error)
{
    for (; contact->of_nodes < state->node_count; contact->of_nodes++, contact->listed++)
        for (int32_t i = 0; i < obstacles->count; i++)
            SHV_TRY(choose(contact, state, obstacles, i, contact->of_nodes, error));
    return SHV_OK;
}

/* ---- facets ---- */

ShvFacetShape shv_candidate_shape(const ShvFacetCandidate *candidate, const ShvState *state)
{
    ShvFacetShape shape = {.apex = shv_state_position(state, candidate->apex)};
    for (int k = 0; k < 3; k++) {
        shape.corners[k] = shv_state_position(state, candidate->nodes[k]);
    }
    return shape;
}

/* With each feature of the obstacle that is near. */
static ShvStatus pair_facet(ShvNodeContact *contact, const ShvState *state, const ShvObstacle *obstacle, int32_t index,
                            int32_t face, ShvError *error)
{
    ShvFacetCandidate candidate = {.obstacle = index, .apex = shv_state_node(state, face / 4, face % 4)};
    for (int k = 0; k < 3; k++) candidate.nodes[k] = shv_state_node(state, face / 4, shv_face_corners[face % 4][k]);
    const ShvFacetShape shape = shv_candidate_shape(&candidate, state);
    ShvFeatureRange range;
    if (!shv_features_about(obstacle, &shape, contact->skin, &range)) return SHV_OK;
    for (candidate.feature = range.first; candidate.feature < range.end; candidate.feature++) {
        if (!shv_feature_is_near(obstacle, &obstacle->features[candidate.feature], range.centre, range.reach)) continue;
        SHV_GROW(contact->memory, SHV_PART_CONTACT, contact->facets, contact->facet_capacity, contact->facet_count,
                 "contact", error);
        contact->facets[contact->facet_count++] = candidate;
    }
    return SHV_OK;
}

static ShvStatus pair_face(ShvNodeContact *contact, const ShvState *state, const ShvObstacle *obstacle, int32_t index,
                           int32_t face, ShvError *error)
{
    if (!(*contact->surface.awake)[state->element_fragment[face / 4]]) return SHV_OK;
    return pair_facet(contact, state, obstacle, index, face, error);
}

/* Faces of cracks that have separated, too; until then nothing gets between them but at their edges, which are the boundary's. */
static ShvStatus choose_facets(ShvNodeContact *contact, const ShvState *state, const ShvObstacle *obstacle,
                               int32_t index, ShvError *error)
{
    const ShvModel *model = contact->surface.model;
    const ShvCohesive *cohesive = contact->surface.cohesive;
    for (int32_t k = 0; k < contact->boundary_count; k++)
        SHV_TRY(pair_face(contact, state, obstacle, index, contact->boundary[k], error));
    for (int32_t i = 0; cohesive && i < cohesive->count; i++) {
        if (cohesive->phase[i] != SHV_COHESIVE_SEPARATED) continue;
        const int64_t side = 2 * (int64_t)cohesive->facet[i];
        for (int k = 0; k < 2; k++)
            SHV_TRY(pair_face(contact, state, obstacle, index,
                              4 * model->adjacency.facet_elements[side + k] + model->adjacency.facet_faces[side + k],
                              error));
    }
    return SHV_OK;
}

static ShvStatus find_boundary(ShvNodeContact *contact, ShvError *error)
{
    const ShvMesh *mesh = &contact->surface.model->mesh;
    for (int32_t face = 0; face < 4 * mesh->element_count; face++) {
        ShvFacetShape shape;
        double radius;
        for (int k = 0; k < 3; k++)
            shape.corners[k] =
                shv_mesh_position(mesh, mesh->elements[4 * (int64_t)(face / 4) + shv_face_corners[face % 4][k]]);
        shv_facet_centre(&shape, &radius);
        contact->facet_radius = fmax(contact->facet_radius, radius);
    }
    return shv_boundary_faces(mesh, contact->memory, SHV_PART_CONTACT, &contact->boundary, &contact->boundary_count,
                              error);
}

/* Where no obstacle is small or has an edge near the nodes, no facet is looked at. */
static ShvStatus choose_all_facets(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                                   const Ball *ball, ShvError *error)
{
    contact->facet_count = 0;
    for (int32_t i = 0; contact->surface.model && i < obstacles->count; i++) {
        const ShvObstacle *obstacle = &obstacles->items[i];
        if (obstacle->feature_count == 0) continue;
        if (!contact->boundary) SHV_TRY(find_boundary(contact, error));
        if (shv_features_matter(obstacle, contact->facet_radius, ball->centre, ball->radius + contact->skin))
            SHV_TRY(choose_facets(contact, state, obstacle, i, error));
    }
    return SHV_OK;
}

static void measure_speed(ShvNodeContact *contact, const ShvState *state, const int32_t *nodes, int32_t count)
{
    contact->node_speed = largest_node_speed(state, nodes, count);
    contact->since = 0;
}

/* Share of the radius of all nodes that the skin has at least, so that bodies at rest keep their neighbour lists. */
static const double least_skin = 4e-3;

/* Facets, which are then chosen, have other nodes when one of theirs is split, and come with cracks that separate. */
static bool have_features(const ShvObstacles *obstacles)
{
    bool any = false;
    for (int32_t i = 0; i < obstacles->count; i++) any |= obstacles->items[i].feature_count > 0;
    return any;
}

ShvStatus shv_candidates_refresh(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                                 const int32_t *nodes, int32_t count, double step, double gravity, ShvError *error)
{
    const double others = largest_obstacle_speed(obstacles) + (STEPS_BETWEEN_CHECKS + 1) * step * gravity;
    contact->stale |= contact->split && have_features(obstacles);
    if (!contact->stale && contact->split) SHV_TRY(add_copies(contact, state, obstacles, error));
    contact->split = false;
    const bool forced = contact->stale || contact->listed != count;
    if (!forced && ++contact->since >= STEPS_BETWEEN_CHECKS) measure_speed(contact, state, nodes, count);
    contact->moved += step * (2.0 * contact->node_speed + others);
    if (!forced && contact->moved <= 0.5 * contact->skin) return SHV_OK;
    measure_speed(contact, state, nodes, count);
    const double motion = step * (2.0 * contact->node_speed + others);
    const Ball ball = bound(state, nodes, count);
    contact->skin = fmax(2.0 * STEPS_TO_LAST * motion, least_skin * ball.radius);
    contact->stale = true; /* until it is done */
    SHV_TRY(choose_all(contact, state, obstacles, nodes, count, error));
    SHV_TRY(choose_all_facets(contact, state, obstacles, &ball, error));
    contact->stale = false;
    contact->moved = motion;
    return SHV_OK;
}
