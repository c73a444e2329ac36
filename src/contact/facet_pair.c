#include "contact/facet_pair.h"

/* A node on the common edge of two facets belongs to one at least, whatever the rounding. */
static const double edge_margin = 1e-9;

static ShvVec3 node_velocity(const ShvSurfaceBodies *bodies, int32_t node, int32_t fragment, ShvVec3 point)
{
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, fragment);
    return coupled_body ? shv_coupled_body_velocity(coupled_body, point)
                        : shv_load3(bodies->state->velocity + 3 * (int64_t)node);
}

/* ---- geometry ---- */

typedef struct Place {
    ShvFacetPlane plane;
    double gap, weights[3];
} Place;

bool shv_facet_plane_make(const ShvVec3 corners[3], ShvFacetPlane *plane)
{
    const ShvVec3 first = shv_sub(corners[1], corners[0]), second = shv_sub(corners[2], corners[0]);
    const ShvVec3 across = shv_cross(first, second);
    const double size = shv_norm(across), inverse = 1.0 / size;
    if (!(size > 0.0)) return false;
    for (int k = 0; k < 3; k++) plane->corners[k] = corners[k];
    plane->normal = shv_scale(across, inverse);
    plane->gradients[1] = shv_scale(shv_cross(second, plane->normal), inverse);
    plane->gradients[2] = shv_scale(shv_cross(plane->normal, first), inverse);
    plane->gradients[0] = shv_scale(shv_add(plane->gradients[1], plane->gradients[2]), -1.0);
    return true;
}

static void stand(Place *place, ShvVec3 x)
{
    const ShvVec3 r = shv_sub(x, place->plane.corners[0]);
    place->gap = shv_dot(place->plane.normal, r);
    place->weights[1] = shv_dot(place->plane.gradients[1], r);
    place->weights[2] = shv_dot(place->plane.gradients[2], r);
    place->weights[0] = 1.0 - place->weights[1] - place->weights[2];
}

static bool over(const Place *place)
{
    return place->weights[0] >= -edge_margin && place->weights[1] >= -edge_margin && place->weights[2] >= -edge_margin;
}

static double squared_distance(ShvVec3 x, ShvVec3 from, ShvVec3 to)
{
    const ShvVec3 path = shv_sub(to, from), r = shv_sub(x, from);
    const double length = shv_dot(path, path), along = length > 0.0 ? shv_dot(r, path) / length : 0.0;
    const double share = along > 1.0 ? 1.0 : along > 0.0 ? along : 0.0;
    const ShvVec3 rest = shv_madd(r, -share, path);
    return shv_dot(rest, rest);
}

/* Squared, in the plane, from the node's projection to the facet. */
static double side_distance(ShvVec3 x, const Place *place)
{
    if (over(place)) return 0.0;
    const ShvVec3 *corners = place->plane.corners, foot = shv_madd(x, -place->gap, place->plane.normal);
    double least = (double)INFINITY;
    for (int k = 0; k < 3; k++) {
        /* The nearest point is on an edge beyond which the foot stands. */
        if (place->weights[k] > 0.0) continue;
        const double squared = squared_distance(foot, corners[(k + 1) % 3], corners[(k + 2) % 3]);
        least = squared < least ? squared : least;
    }
    return least;
}

/* Of the way of a point below the facet's plane: the facet tilts and the tet's apex moves, which moves what is below the facet farther than
   its corners go. */
static const double share_below = 0.5;

/* How far both have to go at least until the point is over the facet, m. */
static double distance_from(double gap, double squared_side)
{
    return gap > 0.0 ? sqrt(squared_side + gap * gap) : share_below * sqrt(squared_side);
}

double shv_facet_plane_distance(const ShvFacetPlane *plane, ShvVec3 x)
{
    Place place = {.plane = *plane};
    stand(&place, x);
    return distance_from(place.gap, side_distance(x, &place));
}

/* A face that bounds the body: of the mesh's boundary or of a crack. */
static bool is_free(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list, int32_t element, int32_t face)
{
    const int64_t slot = 4 * (int64_t)element + face;
    if (!bodies->cohesive) return list->place[slot] >= 0;
    const int32_t facet = list->model->adjacency.element_facets[slot];
    return facet >= list->model->adjacency.interior_count || bodies->cohesive->facet_cohesive[facet] >= 0;
}

ShvFacetShape shv_surface_facet_shape(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list,
                                      const ShvSurfaceFacet *facet)
{
    ShvFacetShape shape = {.free = 0};
    const uint8_t *own = shv_face_corners[facet->face];
    shv_surface_facet_corners(bodies, facet, shape.corners);
    for (int k = 0; k < 3; k++)
        if (is_free(bodies, list, facet->element, own[k])) shape.free |= (uint8_t)(1 << k);
    const int32_t apex = shv_state_node(bodies->state, facet->element, facet->face);
    shape.apex = shv_bodies_position(bodies, apex, facet->fragment);
    return shape;
}

bool shv_surface_is_behind(const ShvSurfaceBodies *bodies, int32_t fragment, int32_t node, int32_t end, ShvVec3 push,
                           double before)
{
    const ShvState *state = bodies->state;
    const ShvVec3 x = shv_bodies_position(bodies, node, fragment);
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t element = state->corners[state->corner_start[node] + i] / 4;
        if (end >= 0 && !shv_state_has_node(state, element, end)) continue;
        for (int k = 0; k < 4; k++) {
            const ShvVec3 corner = shv_bodies_position(bodies, shv_state_node(state, element, k), fragment);
            if (shv_is_before(push, shv_sub(corner, x), before)) return false;
        }
    }
    return true;
}

static bool facet_faces(const ShvSurfaceBodies *bodies, const ShvSurfaceFacet *facet, ShvVec3 push)
{
    ShvVec3 corners[3];
    shv_surface_facet_corners(bodies, facet, corners);
    const ShvVec3 area = shv_cross(shv_sub(corners[1], corners[0]), shv_sub(corners[2], corners[0]));
    return shv_normals_face(shv_unit(area), push);
}

static bool is_faced(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list, const ShvSurfaceNode *node,
                     ShvVec3 push)
{
    const ShvState *state = bodies->state;
    for (int32_t i = 0; i < state->corner_count[node->node]; i++) {
        const int32_t corner = state->corners[state->corner_start[node->node] + i];
        for (int face = 0; face < 4; face++) {
            const int32_t place = face == corner % 4 ? -1 : list->place[4 * (int64_t)(corner / 4) + face];
            if (place >= 0 && facet_faces(bodies, &list->facets[place], push)) return true;
        }
    }
    return false;
}

bool shv_surface_admits(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list, const ShvSurfaceNode *node,
                        ShvVec3 push)
{
    return is_faced(bodies, list, node, push) ||
           shv_surface_is_behind(bodies, node->fragment, node->node, -1, push, SHV_BEFORE_NODE);
}

/* How far both have to go until a point below the facet is in the nearer half of its tet, m: in the other half it may touch the
   surface at the tet's apex. Nor may it be outside again. */
static double way_into_tet(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list, const ShvSurfaceFacet *facet,
                           ShvVec3 x, const Place *place)
{
    const ShvFacetShape shape = shv_surface_facet_shape(bodies, list, facet);
    const double altitude = -shv_dot(place->plane.normal, shv_sub(shape.apex, shape.corners[0]));
    if (-place->gap > 0.5 * altitude) return share_below * (-place->gap - 0.5 * altitude);
    return share_below * shv_facet_beyond_free_face(&shape, x);
}

/* ---- detection ---- */

static ShvVec3 mean_velocity(const ShvFacetPair *pair, const ShvVec3 velocities[3])
{
    ShvVec3 mean = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; k++) {
        const double turn = pair->height * shv_dot(pair->facet_normal, velocities[k]);
        mean = shv_add(mean, shv_madd(shv_scale(velocities[k], pair->weights[k]), -turn, pair->gradients[k]));
    }
    return mean;
}

/* Until the node is in the plane of the facet that it is over, at most the step, s. */
static double time_to_meet(const Place *place, ShvVec3 velocity, const ShvVec3 velocities[3], double step)
{
    double approach = -shv_dot(place->plane.normal, velocity);
    for (int k = 0; k < 3; k++) approach += place->weights[k] * shv_dot(place->plane.normal, velocities[k]);
    return place->gap < approach * step ? place->gap / approach : step;
}

/* Whether the node will stand over the facet after `step`. */
static bool will_be_over(ShvVec3 x, ShvVec3 velocity, const ShvVec3 corners[3], const ShvVec3 velocities[3],
                         double step)
{
    Place place;
    ShvVec3 then[3];
    for (int k = 0; k < 3; k++) then[k] = shv_madd(corners[k], step, velocities[k]);
    if (!shv_facet_plane_make(then, &place.plane)) return false;
    stand(&place, shv_madd(x, step, velocity));
    return over(&place);
}

static double point_inverse_mass(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies, ShvVec3 direction)
{
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, pair->fragments[0]);
    if (coupled_body) return shv_coupled_body_inverse_mass(coupled_body, pair->point, direction);
    double sum = 0.0;
    for (int k = 0; k < pair->node_count; k++)
        sum += pair->shares[k] * pair->shares[k] / bodies->state->mass[pair->nodes[k]];
    return sum;
}

/* Change of the pair's velocity along a unit vector per impulse along it, 1/kg. */
static double inverse_mass(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies, ShvVec3 direction)
{
    double sum = point_inverse_mass(pair, bodies, direction);
    if (pair->element < 0)
        return sum + shv_obstacle_inverse_mass(shv_bodies_obstacle(bodies, pair->element), pair->point, direction);
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, pair->fragments[1]);
    if (coupled_body) return sum + shv_coupled_body_inverse_mass(coupled_body, pair->point, direction);
    for (int k = 0; k < 3; k++) {
        const ShvVec3 share = shv_facet_pair_share(pair, k, direction);
        sum += shv_dot(share, share) / bodies->state->mass[pair->corners[k]];
    }
    return sum;
}

/* Of directions across the normal, the one that yields most: the larger eigenvalue of two by two. */
static double largest_slip_inverse_mass(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies)
{
    const ShvVec3 n = pair->normal;
    const ShvVec3 axis = {fabs(n.x) <= fabs(n.y) && fabs(n.x) <= fabs(n.z),
                          fabs(n.y) < fabs(n.x) && fabs(n.y) <= fabs(n.z),
                          fabs(n.z) < fabs(n.x) && fabs(n.z) < fabs(n.y)};
    const ShvVec3 first = shv_unit(shv_cross(n, axis));
    const ShvVec3 second = shv_cross(pair->normal, first);
    const double a = inverse_mass(pair, bodies, first), b = inverse_mass(pair, bodies, second);
    const double mixed = inverse_mass(pair, bodies, shv_unit(shv_add(first, second))) - 0.5 * (a + b);
    return 0.5 * (a + b) + sqrt(0.25 * (a - b) * (a - b) + mixed * mixed);
}

void shv_facet_pair_stand(ShvFacetPair *pair, const ShvFacetPlane *plane)
{
    Place place = {.plane = *plane};
    stand(&place, pair->point);
    pair->height = place.gap;
    pair->facet_normal = plane->normal;
    pair->centre = shv_scale(shv_add(shv_add(plane->corners[0], plane->corners[1]), plane->corners[2]), 1.0 / 3.0);
    for (int k = 0; k < 3; k++) {
        pair->weights[k] = place.weights[k];
        pair->gradients[k] = plane->gradients[k];
    }
}

void shv_facet_pair_weigh(ShvFacetPair *pair, const ShvSurfaceBodies *bodies)
{
    pair->relative = shv_facet_pair_velocity(pair, bodies);
    pair->inverse_mass = inverse_mass(pair, bodies, pair->normal);
    pair->slip_inverse_mass = largest_slip_inverse_mass(pair, bodies);
    pair->normal_impulse = pair->friction_bound = 0.0;
    pair->friction = shv_vec3(0.0, 0.0, 0.0);
    pair->obstacle_work[0] = pair->obstacle_work[1] = 0.0;
    pair->excluded = false;
}

bool shv_facet_pair_detect(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list,
                           const ShvSurfaceCandidate *candidate, double step, double reach, ShvFacetPair *pair,
                           double *distance)
{
    ShvVec3 corners[3], velocities[3];
    Place place;
    const ShvSurfaceNode *node = &list->nodes[candidate->slot];
    const ShvSurfaceFacet *facet = &list->facets[candidate->facet];
    const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
    for (int k = 0; k < 3; k++) {
        corners[k] = shv_bodies_position(bodies, candidate->corners[k], facet->fragment);
    }
    *distance = 0.0;
    if (!shv_facet_plane_make(corners, &place.plane)) return false;
    stand(&place, x);
    const double side = side_distance(x, &place);
    *distance = distance_from(place.gap, side);
    if (*distance > reach) return false;
    *distance = 0.0;
    const ShvVec3 v = node_velocity(bodies, node->node, node->fragment, x);
    for (int k = 0; k < 3; k++)
        velocities[k] = node_velocity(bodies, candidate->corners[k], facet->fragment, corners[k]);
    if (place.gap > 0.0) {
        const double meeting = side > 0.0 ? step : time_to_meet(&place, v, velocities, step);
        if (!will_be_over(x, v, corners, velocities, meeting)) return false;
    } else {
        if (side > 0.0) return false;
        *distance = way_into_tet(bodies, list, facet, x, &place);
        if (*distance > 0.0) return false;
    }
    if (!shv_surface_admits(bodies, list, node, place.plane.normal)) return false;
    *pair = (ShvFacetPair){.nodes = {node->node},
                           .node_count = 1,
                           .shares = {1.0},
                           .element = facet->element,
                           .face = facet->face,
                           .fragments = {node->fragment, facet->fragment},
                           .corners = {candidate->corners[0], candidate->corners[1], candidate->corners[2]},
                           .step = step,
                           .point = x};
    shv_facet_pair_stand(pair, &place.plane);
    pair->gap = pair->height;
    pair->normal = pair->facet_normal;
    shv_facet_pair_weigh(pair, bodies);
    return true;
}

/* ---- response ---- */

static ShvVec3 point_velocity(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    for (int k = 0; k < pair->node_count; k++)
        sum = shv_madd(sum, pair->shares[k], node_velocity(bodies, pair->nodes[k], pair->fragments[0], pair->point));
    return sum;
}

/* Mean over the coming step, as velocities of nodes and coupled bodies are. */
static ShvVec3 obstacle_velocity(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies)
{
    const ShvObstacle *obstacle = shv_bodies_obstacle(bodies, pair->element);
    const ShvVec3 velocity = shv_obstacle_velocity(obstacle, pair->point);
    return obstacle->motion == SHV_OBSTACLE_FREE ? shv_madd(velocity, 0.5 * pair->step, bodies->gravity) : velocity;
}

ShvVec3 shv_facet_pair_velocity(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies)
{
    const ShvVec3 own = point_velocity(pair, bodies);
    if (pair->element < 0) return shv_sub(own, obstacle_velocity(pair, bodies));
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, pair->fragments[1]);
    if (coupled_body) return shv_sub(own, shv_coupled_body_velocity(coupled_body, pair->point));
    ShvVec3 velocities[3];
    for (int k = 0; k < 3; k++) velocities[k] = shv_load3(bodies->state->velocity + 3 * (int64_t)pair->corners[k]);
    return shv_sub(own, mean_velocity(pair, velocities));
}

static void strike_obstacle(ShvFacetPair *pair, const ShvSurfaceBodies *bodies, ShvVec3 impulse)
{
    ShvObstacle *obstacle = shv_bodies_obstacle(bodies, pair->element);
    if (obstacle->motion != SHV_OBSTACLE_FREE) return;
    pair->obstacle_work[0] -= 0.5 * shv_dot(impulse, shv_obstacle_velocity(obstacle, pair->point));
    shv_obstacle_impulse(obstacle, pair->point, shv_scale(impulse, -1.0));
    pair->obstacle_work[1] -= 0.5 * shv_dot(impulse, shv_obstacle_velocity(obstacle, pair->point));
}

static void strike_point(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies, ShvVec3 impulse)
{
    ShvState *state = bodies->state;
    ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, pair->fragments[0]);
    if (coupled_body) {
        shv_coupled_body_impulse(coupled_body, pair->point, impulse);
        return;
    }
    for (int k = 0; k < pair->node_count; k++)
        shv_add_to3(state->velocity + 3 * (int64_t)pair->nodes[k],
                    shv_scale(impulse, pair->shares[k] / state->mass[pair->nodes[k]]));
}

void shv_facet_pair_strike(ShvFacetPair *pair, const ShvSurfaceBodies *bodies, ShvVec3 impulse)
{
    ShvState *state = bodies->state;
    strike_point(pair, bodies, impulse);
    if (pair->element < 0) {
        strike_obstacle(pair, bodies, impulse);
        return;
    }
    ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, pair->fragments[1]);
    if (coupled_body) {
        shv_coupled_body_impulse(coupled_body, pair->point, shv_scale(impulse, -1.0));
        return;
    }
    for (int k = 0; k < 3; k++)
        shv_add_to3(state->velocity + 3 * (int64_t)pair->corners[k],
                    shv_scale(shv_facet_pair_share(pair, k, impulse), 1.0 / state->mass[pair->corners[k]]));
}
