/* What obstacles are, for the run file and whoever draws them. */
#include "sim/internal.h"

ShvObstacleBody shv_simulation_obstacle(const ShvSimulation *simulation, int32_t index)
{
    const ShvObstacle *obstacle = &simulation->hybrid.obstacles.items[index];
    ShvObstacleBody body = {.name = obstacle->name,
                            .shape = obstacle->shape,
                            .motion = obstacle->motion,
                            .offset = obstacle->offset,
                            .radius = obstacle->radius,
                            .mass = obstacle->mass,
                            .friction = obstacle->friction,
                            .restitution = obstacle->restitution,
                            .positions = obstacle->surface.positions,
                            .triangles = obstacle->surface.triangles,
                            .node_count = obstacle->surface.node_count,
                            .triangle_count = obstacle->surface.triangle_count};
    shv_store3(body.normal, obstacle->normal);
    shv_store3(body.size, shv_scale(obstacle->half, 2.0));
    return body;
}
