/* How far what is listed may go until candidates are chosen anew, and whether it has. */
#include "contact/surface_candidates.h"

enum { STEPS_TO_LAST = 256 };

/* ---- motion ---- */

static ShvVec3 node_velocity(const ShvSurfaceBodies *bodies, const ShvSurfaceNode *node)
{
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, node->fragment);
    if (!coupled_body) return shv_load3(bodies->state->velocity + 3 * (int64_t)node->node);
    return shv_coupled_body_velocity(coupled_body, shv_bodies_position(bodies, node->node, node->fragment));
}

static ShvVec3 against_frame(const ShvSurfaceContact *contact, ShvVec3 velocity)
{
    return shv_sub(velocity, contact->drift);
}

/* Of any point of an obstacle, which may fall in the step; those that stand move against the frame too. */
static double obstacle_speed(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    double largest = 0.0;
    if (!bodies->obstacles || bodies->obstacles->count == 0) return 0.0;
    for (int32_t k = 0; k < bodies->obstacles->count; k++) {
        const ShvObstacle *obstacle = &bodies->obstacles->items[k];
        if (obstacle->motion == SHV_OBSTACLE_FIXED) continue;
        const double speed =
            shv_norm(obstacle->velocity) + shv_norm(obstacle->angular_velocity) * obstacle->bounding_radius;
        largest = fmax(largest, speed + bodies->state->last_step * contact->gravity);
    }
    return largest + shv_norm(contact->drift);
}

/* No node of it is faster against the frame, m/s. */
static double coupled_body_speed(const ShvSurfaceContact *contact, const ShvCoupledBody *coupled_body)
{
    return shv_norm(against_frame(contact, coupled_body->velocity)) +
           shv_norm(coupled_body->angular_velocity) * coupled_body->radius;
}

void shv_surface_measure_speeds(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    double largest[SHV_SURFACE_SPEED_CLASSES] = {0.0};
    for (int32_t k = 0; k < contact->watched_count; k++) {
        const ShvSurfaceNode *node = &contact->list.nodes[contact->watched[k]];
        const ShvVec3 v = against_frame(contact, shv_load3(bodies->state->velocity + 3 * (int64_t)node->node));
        const double speed = sqrt(shv_dot(v, v));
        contact->list.node_speed[contact->watched[k]] = speed;
        largest[node->speed_class] = speed > largest[node->speed_class] ? speed : largest[node->speed_class];
    }
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++)
        contact->speed[speed_class] = largest[speed_class];
    for (int32_t i = 0; bodies->coupled_bodies && i < bodies->fragment_count; i++) {
        if (!bodies->coupled_bodies[i]) continue;
        double *speed = &contact->speed[contact->fragments[i].speed_class];
        const double own = coupled_body_speed(contact, bodies->coupled_bodies[i]);
        *speed = own > *speed ? own : *speed;
    }
    contact->speed[SHV_SURFACE_OBSTACLES] = obstacle_speed(contact, bodies);
}

bool shv_surface_speed_leaves(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t fragment,
                              double step)
{
    const double ahead = 2.0 * contact->detection_interval * step; /* twice the way until it is looked at next */
    const ShvSurfaceFragment *motion = &contact->fragments[fragment];
    const double speed = coupled_body_speed(contact, bodies->coupled_bodies[fragment]) + ahead * contact->gravity;
    return !(motion->path + ahead * speed <= contact->skin[motion->speed_class]);
}

int32_t shv_surface_speed_steps(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                const ShvSurfaceNode *node, double step, int32_t most)
{
    const double time = bodies->state->time - contact->built_time, skin = contact->skin[node->speed_class];
    const ShvVec3 x = shv_state_position(bodies->state, node->node);
    const ShvVec3 v = against_frame(contact, shv_load3(bodies->state->velocity + 3 * (int64_t)node->node));
    const ShvVec3 path = shv_madd(shv_sub(x, node->from), -time, contact->drift);
    double ahead = 2.0 * most * step;
    const double room = skin - ahead * ahead * contact->gravity;
    /* (a + b)² ≤ 2 a² + 2 b²: most need no root */
    if (room > 0.0 && 2.0 * (shv_dot(path, path) + ahead * ahead * shv_dot(v, v)) <= room * room) return most;
    const double gone = shv_norm(path), speed = shv_norm(v);
    while (most > 0 && !(gone + ahead * (speed + ahead * contact->gravity) <= skin)) ahead = 2.0 * (most /= 2) * step;
    return most;
}

static bool obstacles_outrun(const ShvSurfaceContact *contact, double ahead)
{
    return contact->path[SHV_SURFACE_OBSTACLES] + ahead * contact->speed[SHV_SURFACE_OBSTACLES] >
           contact->skin[SHV_SURFACE_OBSTACLES];
}

int32_t shv_surface_detection_interval(const ShvSurfaceContact *contact, double step)
{
    const double share = 0.1; /* of a facet's size: twice the way of both sides from one detection to the next */
    double fastest = 0.0;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++)
        fastest = fmax(fastest, contact->speed[speed_class]);
    const double steps = share * contact->size / (4.0 * step * fastest);
    return steps >= SHV_SURFACE_DETECTION_INTERVAL ? SHV_SURFACE_DETECTION_INTERVAL : steps >= 1.0 ? (int32_t)steps : 1;
}

/* The step that led here, of each node and facet that is watched. */
static void count_paths(ShvSurfaceContact *contact, double step)
{
    ShvSurfaceList *list = &contact->list;
    for (int32_t k = 0; k < contact->watched_count; k++) {
        const int32_t slot = contact->watched[k];
        list->node_path[slot] += step * list->node_speed[slot];
    }
    for (int32_t k = 0; k < contact->watched_facets.count; k++) {
        const int32_t place = contact->watched_facets.items[k], *slots = list->facets[place].slots;
        const double a = list->node_speed[slots[0]], b = list->node_speed[slots[1]], c = list->node_speed[slots[2]];
        const double larger = a > b ? a : b;
        list->facet_path[place] += step * (larger > c ? larger : c);
    }
}

bool shv_surface_speed_count(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    const ShvState *state = bodies->state;
    if (state->time == contact->seen_time) return false;
    contact->seen_time = state->time;
    shv_surface_measure_speeds(contact, bodies);
    for (int k = 0; k < SHV_SURFACE_MOTION_CLASSES; k++) contact->path[k] += state->last_step * contact->speed[k];
    count_paths(contact, state->last_step);
    for (int32_t i = 0; bodies->coupled_bodies && i < bodies->fragment_count; i++)
        if (bodies->coupled_bodies[i])
            contact->fragments[i].path += state->last_step * coupled_body_speed(contact, bodies->coupled_bodies[i]);
    return --contact->steps_to_check <= 0 &&
           obstacles_outrun(contact, 2.0 * SHV_SURFACE_STEPS_BETWEEN_CHECKS * state->last_step);
}

/* ---- speed classes ---- */

static void choose_frame(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    const int32_t count = contact->list.node_count;
    for (int32_t k = 0; k < count; k++) sum = shv_add(sum, node_velocity(bodies, &contact->list.nodes[k]));
    contact->drift = count > 0 ? shv_scale(sum, 1.0 / count) : sum;
}

/* Of the mean edge of facets: the skin beyond which lasting longer is not worth it, since in a cloud of splinters every node would
   have dozens of candidates. */
static const double largest_skin = 0.06;
/* Times the motion between two checks: no node may leave its skin unseen. */
static const double skin_margin = 4.0;

/* Lasts for many steps, but is not so far that every node has dozens of candidates unless the motion demands it. */
static double skin_for(const ShvSurfaceContact *contact, double distance)
{
    const double far = largest_skin * contact->size, wanted = STEPS_TO_LAST * distance,
                 needed = skin_margin * SHV_SURFACE_STEPS_BETWEEN_CHECKS * distance;
    return fmax(needed, fmin(wanted, far));
}

/* Chooses the speed class; places are kept as if the frame had not moved since candidates were chosen. */
void shv_surface_speed_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvSurfaceNode *node,
                            double step)
{
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, node->fragment);
    const double speed = coupled_body ? coupled_body_speed(contact, coupled_body)
                                      : shv_norm(against_frame(contact, node_velocity(bodies, node)));
    double wanted = skin_for(contact, step * speed);
    if (coupled_body) wanted = fmax(wanted, 4.0 * contact->detection_interval * step * speed);
    const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
    node->from = shv_madd(x, contact->built_time - bodies->state->time, contact->drift);
    node->speed_class = 0;
    while (node->speed_class < SHV_SURFACE_SPEED_CLASSES - 1 && !(contact->skin[node->speed_class] >= wanted))
        node->speed_class++;
    if (coupled_body) contact->fragments[node->fragment].speed_class = node->speed_class;
}

void shv_surface_speed_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet)
{
    int32_t nodes[3];
    shv_surface_corners(bodies->state, facet->element, facet->face, nodes);
    const ShvVec3 back = shv_scale(contact->drift, contact->built_time - bodies->state->time);
    facet->box = (ShvBox){shv_add(facet->box.low, back), shv_add(facet->box.high, back)};
    facet->speed_class = 0;
    for (int k = 0; k < 3; k++) {
        const uint8_t speed_class = contact->list.nodes[contact->list.slot[nodes[k]]].speed_class;
        facet->speed_class = speed_class > facet->speed_class ? speed_class : facet->speed_class;
    }
}

void shv_surface_speed_choose(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step)
{
    const double least = 0.04;
    choose_frame(contact, bodies);
    contact->built_time = bodies->state->time;
    contact->steps_to_check = 1;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++)
        contact->skin[speed_class] = least * contact->size * (double)(1 << speed_class);
    contact->speed[SHV_SURFACE_OBSTACLES] = obstacle_speed(contact, bodies);
    /* no upper limit: few candidates are with obstacles, and none where all are far away */
    contact->skin[SHV_SURFACE_OBSTACLES] =
        fmax(contact->skin[0], STEPS_TO_LAST * step * contact->speed[SHV_SURFACE_OBSTACLES]);
    for (int32_t k = 0; k < contact->list.node_count; k++)
        shv_surface_speed_node(contact, bodies, &contact->list.nodes[k], step);
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        shv_surface_speed_facet(contact, bodies, &contact->list.facets[k]);
    for (int k = 0; k < SHV_SURFACE_MOTION_CLASSES; k++) contact->path[k] = 0.0;
}
