#include "contact/box.h"
#include "mesh/wall.h"
#include "sim/internal.h"

int32_t shv_simulation_object_count(const ShvSimulation *simulation)
{
    return simulation->hybrid.model.object_count;
}

const char *shv_breaking_name(ShvBreaking breaking)
{
    static const char *const names[] = {"anywhere", "plane", "tips"};
    return names[breaking];
}

/* Quality and lumped properties come from the object's own part of the joint mesh, seen as a mesh of its own. */
ShvMesh shv_object_part(const ShvModel *model, const ShvObject *object)
{
    return (ShvMesh){.memory = model->memory,
                     .node_count = object->node_end,
                     .element_count = object->element_end - object->element_begin,
                     .positions = model->mesh.positions,
                     .elements = model->mesh.elements + 4 * (int64_t)object->element_begin};
}

static void measure_mesh(ShvPreflight *preflight, const ShvModel *model, const ShvObject *object)
{
    const ShvMesh part = shv_object_part(model, object);
    const ShvMeshQuality quality = shv_mesh_quality(&part);
    preflight->tets = part.element_count;
    preflight->nodes = object->node_end - object->node_begin;
    preflight->volume = quality.volume;
    preflight->shortest_edge = quality.shortest_edge;
    preflight->mean_edge = quality.mean_edge;
    preflight->longest_edge = quality.longest_edge;
    preflight->smallest_altitude = quality.smallest_altitude;
    preflight->worst_aspect = quality.worst_aspect;
    preflight->smallest_dihedral = quality.smallest_dihedral;
    ShvBox box = shv_box_empty();
    for (int32_t i = object->node_begin; i < object->node_end; i++)
        shv_box_add(&box, shv_mesh_position(&model->mesh, i));
    shv_store3(preflight->extent, shv_sub(box.high, box.low));
}

static void measure_step(ShvPreflight *preflight, const ShvHybrid *hybrid, const ShvObject *object)
{
    preflight->stable_step = HUGE_VAL;
    for (int32_t e = object->element_begin; e < object->element_end; e++) {
        const double step = shv_solid_exact_step(&hybrid->solid, e);
        if (!(step < preflight->stable_step)) continue;
        preflight->stable_step = step;
        preflight->stable_element = e;
    }
    ShvVec3 sum = shv_vec3(0.0, 0.0, 0.0);
    for (int a = 0; a < 4; a++)
        sum = shv_add(sum, shv_mesh_position(&hybrid->model.mesh,
                                             hybrid->model.mesh.elements[4 * (int64_t)preflight->stable_element + a]));
    shv_store3(preflight->stable_centroid, shv_scale(sum, 0.25));
    const ShvFractureDefinition *fracture = &hybrid->scene->fracture;
    preflight->step = isnan(fracture->time_step) ? fracture->safety * hybrid->steps.stable : fracture->time_step;
    preflight->courant = preflight->step / preflight->stable_step;
}

/* Who touches whom is known only where something can break. */
static void measure_wall(ShvPreflight *preflight, const ShvModel *model, const ShvObject *object)
{
    ShvWall wall = {0};
    if (model->can_break)
        wall = shv_mesh_wall(&model->mesh, &model->adjacency, object->element_begin, object->element_end);
    preflight->smoothed = model->materials[object->material].smoothed;
    preflight->wall_share = wall.share;
    preflight->wall_thickness = wall.thickness;
    preflight->wall_edge = wall.edge;
    preflight->wall_stiffness = shv_wall_stiffness(&wall, preflight->smoothed);
}

/* `can_break`: fracture is on in this scene. */
static void measure_cohesion(ShvPreflight *preflight, const ShvMaterial *material, bool can_break)
{
    preflight->breakable = can_break && shv_material_can_open(material);
    preflight->cohesive_zone = shv_material_cohesive_zone(material);
    preflight->snap_back = shv_material_snap_back(material);
    preflight->final_opening = shv_material_final_opening(material);
    preflight->opening_speed = 2.0 * material->strength[SHV_NORMAL] / (material->density * material->bar_speed);
    preflight->cohesive_step = preflight->final_opening / preflight->opening_speed;
    preflight->steps_to_open = preflight->cohesive_step / preflight->step;
}

static void measure_waves(ShvPreflight *preflight, const ShvMaterial *material)
{
    const double *extent = preflight->extent;
    const double longest = fmax(extent[0], fmax(extent[1], extent[2]));
    const double shortest = fmin(extent[0], fmin(extent[1], extent[2]));
    preflight->bar_speed = material->bar_speed;
    preflight->dilatational_speed = material->dilatational_speed;
    preflight->bar_transit = longest / material->bar_speed;
    /* Free plate, fundamental: f = 1.03 c₀ h/L². */
    preflight->bending_period = longest * longest / (1.03 * material->bar_speed * shortest);
}

/* Stress/strength a step gains behind the front of a wave that a wall starts at the speed of the first contact: the front
   rises over about one mean edge. */
static double overshoot(const ShvPreflight *preflight, const ShvMaterial *material)
{
    const double stress = material->density * material->bar_speed * preflight->impact_speed;
    const double rise = preflight->mean_edge / material->bar_speed;
    return stress / material->strength[SHV_NORMAL] * preflight->step / rise;
}

static double least_extent(const ShvObstacle *obstacle)
{
    double corners[24];
    const ShvSurface surface = shv_obstacle_surface(obstacle, corners);
    ShvBox box = shv_box_empty();
    if (obstacle->shape == SHV_OBSTACLE_PLANE) return (double)INFINITY;
    if (obstacle->shape == SHV_OBSTACLE_SPHERE) return 2.0 * obstacle->radius;
    for (int32_t i = 0; i < surface.node_count; i++) shv_box_add(&box, shv_surface_position(&surface, i));
    const ShvVec3 extent = shv_sub(box.high, box.low);
    return fmin(extent.x, fmin(extent.y, extent.z));
}

static void find_small_obstacle(ShvPreflight *preflight, const ShvObstacles *obstacles)
{
    preflight->small_obstacle_size = preflight->mean_edge;
    for (int32_t i = 0; i < obstacles->count; i++) {
        const double extent = least_extent(&obstacles->items[i]);
        if (!(extent < preflight->small_obstacle_size)) continue;
        preflight->small_obstacle_size = extent;
        preflight->small_obstacle = obstacles->items[i].name;
    }
}

static void measure_spin(ShvPreflight *preflight, const ShvHybrid *hybrid, int32_t object)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->object != object || fragment->mode != SHV_MODE_FLIGHT) continue;
        preflight->centrifugal_stress = fmax(preflight->centrifugal_stress, shv_hybrid_centrifugal_stress(fragment));
        preflight->wakes_by_spin = preflight->wakes_by_spin || shv_hybrid_wakes_by_spin(hybrid, fragment);
    }
}

static void measure_rest(ShvPreflight *preflight, const ShvHybrid *hybrid, int32_t object)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (hybrid->fragments.items[i].object == object)
            preflight->vibration_time =
                fmax(preflight->vibration_time, shv_hybrid_longest(hybrid, &hybrid->fragments.items[i]));
    if (preflight->breakable && hybrid->coupling.mutual && !shv_hybrid_is_alone(hybrid))
        preflight->flight_interval = hybrid->scene->rigid.time_step;
}

ShvStatus shv_simulation_preflight(const ShvSimulation *simulation, int32_t object, ShvPreflight *preflight,
                                   ShvError *error)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    if (object < 0 || object >= hybrid->model.object_count)
        return shv_fail(error, SHV_BAD_INPUT, "object %d does not exist; there are %d", (int)object,
                        (int)hybrid->model.object_count);
    const ShvObject *body = &hybrid->model.objects[object];
    const ShvMaterial *material = &hybrid->model.materials[body->material];
    *preflight = (ShvPreflight){.object = body->name,
                                .material = body->materials ? body->materials : material->name,
                                .cohesion = shv_simulation_material(simulation, body->material)};
    measure_mesh(preflight, &hybrid->model, body);
    measure_wall(preflight, &hybrid->model, body);
    const ShvMeshDefinition *mesh = &hybrid->scene->objects[object].mesh;
    preflight->improvable = !mesh->improve && (mesh->kind == SHV_MESH_GMSH || mesh->kind == SHV_MESH_TETGEN ||
                                               mesh->kind == SHV_MESH_MEMORY);
    preflight->ordered = mesh->kind == SHV_MESH_BOX && mesh->pattern != SHV_PATTERN_UNSTRUCTURED;
    for (int32_t e = body->element_begin; e < body->element_end; e++) preflight->mass += hybrid->state.element_mass[e];
    measure_step(preflight, hybrid, body);
    measure_cohesion(preflight, material, hybrid->model.can_break);
    measure_waves(preflight, material);
    const ShvMesh part = shv_object_part(&hybrid->model, body);
    SHV_TRY(shv_find_breaking(preflight, hybrid, &part, body->node_begin, error));
    preflight->never_parts = preflight->breakable && preflight->final_opening > preflight->breaking_mean_edge &&
                             hybrid->scene->fracture.connectivity == SHV_CONNECTIVITY_BONDS;
    SHV_TRY(shv_find_nearest(preflight, hybrid, object, error));
    preflight->overshoot_each_step = overshoot(preflight, material);
    find_small_obstacle(preflight, &hybrid->obstacles);
    measure_spin(preflight, hybrid, object);
    measure_rest(preflight, hybrid, object);
    return SHV_OK;
}
