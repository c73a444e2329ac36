#include "shiver/simulation.h"

#include <stdio.h>
#include <string.h>

#include "base/hash.h"
#include "sim/internal.h"

ShvSimulationOptions shv_simulation_options_default(void)
{
    return (ShvSimulationOptions){.cookie = SHV_DEFINITION_COOKIE};
}

static ShvStatus create_views(ShvSimulation *simulation, ShvError *error)
{
    const ShvModel *model = &simulation->hybrid.model;
    ShvViews *views = &simulation->views;
    const size_t obstacles = (size_t)simulation->hybrid.obstacles.count, objects = (size_t)model->object_count;
    views->obstacles = shv_allocate(simulation->memory, SHV_PART_RECORD, obstacles, sizeof(ShvObstacleView));
    views->objects = shv_allocate(simulation->memory, SHV_PART_RECORD, objects, sizeof(ShvObjectView));
    const size_t probes = (size_t)simulation->hybrid.probes.count;
    views->probes = shv_allocate(simulation->memory, SHV_PART_RECORD, probes, sizeof(ShvProbeView));
    if (!views->obstacles || !views->objects || !views->probes)
        return shv_fail_memory(error, "views", obstacles * sizeof(ShvObstacleView) + objects * sizeof(ShvObjectView));
    for (size_t i = 0; i < probes; i++) {
        const ShvProbeDefinition *definition = simulation->hybrid.probes.items[i].definition;
        views->probes[i] = (ShvProbeView){definition->name, definition->kind};
    }
    for (int32_t i = 0; i < model->object_count; i++) {
        const ShvObject *object = &model->objects[i];
        const char *material = object->materials ? object->materials : model->materials[object->material].name;
        views->objects[i] = (ShvObjectView){object->name,        material,           object->element_begin,
                                            object->element_end, object->node_begin, object->node_end};
    }
    return SHV_OK;
}

ShvStatus shv_simulation_create(ShvSimulation **simulation, const ShvSceneDefinition *scene,
                                const ShvSimulationOptions *options, ShvError *error)
{
    *simulation = NULL;
    if (options && options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the options did not start from shv_simulation_options_default()");
    SHV_TRY(shv_simulation_check_scene(scene, error));
    ShvMemory *memory = options && options->memory ? options->memory : shv_memory_create();
    if (!memory) return shv_fail_memory(error, "the allocation counter", 0);
    const bool owns = !options || !options->memory;
    ShvSimulation *made = shv_allocate(memory, SHV_PART_GENERAL, 1, sizeof *made);
    if (!made) {
        if (owns) shv_memory_destroy(memory);
        return shv_fail_memory(error, "the simulation", sizeof *made);
    }
    made->memory = memory;
    made->owns_memory = owns;
    made->scene = scene;
    ShvStatus status = shv_hybrid_create(&made->hybrid, memory, scene, options ? options->folder : NULL, error);
    if (status == SHV_OK) status = shv_simulation_refuse_overlaps(made, error);
    if (status == SHV_OK) status = create_views(made, error);
    if (status != SHV_OK) {
        shv_simulation_destroy(made);
        return status;
    }
    made->hybrid.wake_audit.wakes = options ? options->audit_wakes : 0;
    made->hybrid.stop = options ? options->stop : NULL;
    made->hybrid.stop_data = options ? options->stop_data : NULL;
    *simulation = made;
    return SHV_OK;
}

void shv_simulation_destroy(ShvSimulation *simulation)
{
    if (!simulation) return;
    ShvMemory *memory = simulation->owns_memory ? simulation->memory : NULL;
    shv_hybrid_release(&simulation->hybrid);
    shv_release(simulation->views.fragments);
    shv_release(simulation->views.obstacles);
    shv_release(simulation->views.objects);
    shv_release(simulation->views.probes);
    shv_release(simulation);
    if (memory) shv_memory_destroy(memory);
}

/* ---- views ---- */

static void view_fragment(ShvFragmentView *view, const ShvFragment *fragment)
{
    const ShvMat3 *inertia = &fragment->inertia;
    *view = (ShvFragmentView){
        .id = fragment->id,
        .parent = fragment->parent,
        .object = fragment->object,
        .birth = fragment->birth,
        .death = fragment->death,
        .mode = (ShvFragmentMode)fragment->mode,
        .tets = fragment->element_count,
        .mass = fragment->mass,
        .volume = fragment->volume,
        .inertia = {inertia->m[0][0], inertia->m[1][1], inertia->m[2][2], inertia->m[1][2], inertia->m[0][2],
                    inertia->m[0][1]},
        .orientation = {fragment->orientation.w, fragment->orientation.x, fragment->orientation.y,
                        fragment->orientation.z},
    };
    shv_store3(view->reference_centre, fragment->reference_centre);
    shv_store3(view->position, fragment->position);
    shv_store3(view->velocity, fragment->velocity);
    shv_store3(view->angular_velocity, fragment->angular_velocity);
}

static ShvStatus view_fragments(ShvSimulation *simulation, ShvError *error)
{
    const ShvFragments *fragments = &simulation->hybrid.fragments;
    ShvViews *views = &simulation->views;
    if (views->fragment_capacity < fragments->count) {
        const size_t capacity = (size_t)fragments->capacity;
        ShvFragmentView *grown =
            shv_reallocate(simulation->memory, SHV_PART_RECORD, views->fragments, capacity, sizeof(ShvFragmentView));
        if (!grown) return shv_fail_memory(error, "views of fragments", capacity * sizeof(ShvFragmentView));
        views->fragments = grown;
        views->fragment_capacity = fragments->capacity;
    }
    for (int32_t i = 0; i < fragments->count; i++) view_fragment(&views->fragments[i], &fragments->items[i]);
    return SHV_OK;
}

static void view_obstacles(ShvSimulation *simulation)
{
    for (int32_t i = 0; i < simulation->hybrid.obstacles.count; i++) {
        const ShvObstacle *obstacle = &simulation->hybrid.observer.ghost.obstacles[i];
        ShvObstacleView *view = &simulation->views.obstacles[i];
        view->name = obstacle->definition->name;
        shv_store3(view->position, shv_hybrid_waits(&simulation->hybrid, i)
                                       ? shv_load3(obstacle->definition->placement.position)
                                       : obstacle->position);
        view->orientation[0] = obstacle->orientation.w;
        shv_store3(view->orientation + 1,
                   shv_vec3(obstacle->orientation.x, obstacle->orientation.y, obstacle->orientation.z));
        shv_store3(view->velocity, obstacle->velocity);
        shv_store3(view->angular_velocity, obstacle->angular_velocity);
    }
}

static void view_costs(ShvSimulation *simulation)
{
    for (int i = 0; i < SHV_COST_COUNT; i++)
        simulation->views.costs[i] = (ShvCostView){shv_cost_name((ShvCost)i), simulation->hybrid.costs.seconds[i],
                                                   simulation->hybrid.costs.calls[i]};
    for (int i = 0; i < SHV_PART_COUNT; i++)
        simulation->views.bytes[i] =
            (ShvBytesView){shv_part_name((ShvPart)i), shv_memory_bytes(simulation->memory, (ShvPart)i),
                           shv_memory_peak_bytes(simulation->memory, (ShvPart)i)};
}

/* While some body is awake, steps look at what is awake and at obstacles. */
static ShvStatus sample_flight(ShvHybrid *hybrid, ShvError *error)
{
    const ShvProbeScene scene = {&hybrid->solid, &hybrid->state, &hybrid->fragments, &hybrid->obstacles};
    return shv_probes_fly(&hybrid->probes, &scene, hybrid->awake.count == 0, hybrid->backend->keeps_nodes, error);
}

static double cohesive_share(ShvHybrid *hybrid)
{
    const double step = hybrid->observer.cohesive_energy.spring_step;
    const bool less = hybrid->observer.least_spring_step == 0.0 || step < hybrid->observer.least_spring_step;
    if (hybrid->observer.cohesive_energy.inserted > 0 && isfinite(step) && less)
        hybrid->observer.least_spring_step = step;
    return hybrid->observer.least_spring_step > 0.0 && hybrid->steps.bulk > 0.0
               ? hybrid->observer.least_spring_step / hybrid->steps.bulk
               : (double)NAN;
}

/* Under other limits for what still bonds than the one that makes fragments. */
static ShvStatus count_pieces(ShvHybrid *hybrid, int32_t pieces[3], ShvError *error)
{
    static const double limits[3] = {0.01, 0.1, 0.5};
    for (int i = 0; i < 3; i++) {
        pieces[i] = hybrid->fragments.alive;
        if (hybrid->model.can_break && hybrid->cohesive.count > 0)
            SHV_TRY(shv_fragments_count_at(&hybrid->fragments, &hybrid->cohesive, &hybrid->state, limits[i], &pieces[i],
                                           error));
    }
    return SHV_OK;
}

ShvStatus shv_simulation_fill(ShvSimulation *simulation, bool animation, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    const ShvStatus observed = shv_hybrid_observe(hybrid, error);
    SHV_TRY(view_fragments(simulation, error));
    view_obstacles(simulation);
    view_costs(simulation);
    if (animation) SHV_TRY(sample_flight(hybrid, error));
    simulation->frame = (ShvFrameView){
        .time = hybrid->state.time,
        .animation = animation,
        .fracture = hybrid->awake.count > 0,
        .fragments = simulation->views.fragments,
        .fragment_count = hybrid->fragments.count,
        .alive_count = hybrid->fragments.alive,
        .obstacles = simulation->views.obstacles,
        .obstacle_count = hybrid->obstacles.count,
        .events = hybrid->log.items,
        .event_count = hybrid->log.count,
        .probes = simulation->views.probes,
        .probe_count = hybrid->probes.count,
        .probe_times = hybrid->probes.times,
        .probe_samples = hybrid->probes.samples,
        .probe_row_count = hybrid->probes.rows,
        .ledger = hybrid->observer.balance,
        .steps = hybrid->state.step,
        .step = hybrid->steps.last,
        .courant = shv_hybrid_courant(hybrid),
        .costs = simulation->views.costs,
        .cost_count = SHV_COST_COUNT,
        .bytes = simulation->views.bytes,
        .bytes_count = SHV_PART_COUNT,
    };
    shv_store3(simulation->frame.contact_impulse, hybrid->obstacle_contact.impulse);
    const bool touched = hybrid->obstacle_contact.steps > 0;
    simulation->frame.contact_time = hybrid->obstacle_contact.time;
    simulation->frame.first_contact = touched ? hybrid->obstacle_contact.first : (double)NAN;
    simulation->frame.last_contact = touched ? hybrid->obstacle_contact.last : (double)NAN;
    const bool positions = hybrid->stabiliser.active || hybrid->backend->keeps_nodes;
    const double turnover = hybrid->stabiliser.bars_turnover + hybrid->stabiliser.elastic_turnover;
    simulation->frame.edge_strain = positions ? shv_hybrid_edge_strain(hybrid) : (double)NAN;
    simulation->frame.bar_work_share = turnover > 0.0 ? hybrid->stabiliser.bars_turnover / turnover : (double)NAN;
    simulation->frame.inserted = hybrid->observer.cohesive_energy.inserted;
    simulation->frame.failed = hybrid->observer.cohesive_energy.failed;
    SHV_TRY(count_pieces(hybrid, simulation->frame.pieces, error));
    simulation->frame.softened = (int32_t)hybrid->observer.cohesive_energy.softened;
    simulation->frame.audited = hybrid->wake_audit.audited;
    simulation->frame.missed = hybrid->wake_audit.missed;
    simulation->frame.worst_overshoot = hybrid->cohesive.worst_overshoot;
    simulation->frame.cohesive_share = cohesive_share(hybrid);
    return observed;
}

/* ---- frames ---- */

void shv_simulation_forget_told(ShvSimulation *simulation)
{
    simulation->hybrid.log.count = 0;
    simulation->hybrid.probes.rows = 0;
}

static double animation_time(const ShvSimulation *simulation)
{
    const ShvSceneDefinition *scene = simulation->scene;
    if (simulation->animation_frame >= shv_frame_intervals(scene)) return scene->duration;
    return (double)simulation->animation_frame / scene->output.rate;
}

void shv_simulation_pass_frames(ShvSimulation *simulation)
{
    const ShvSceneDefinition *scene = simulation->scene;
    while (simulation->animation_frame < shv_frame_intervals(scene) &&
           animation_time(simulation) <= simulation->hybrid.state.time)
        simulation->animation_frame++;
}

bool shv_simulation_finished(const ShvSimulation *simulation)
{
    return simulation->started && simulation->hybrid.state.time >= simulation->scene->duration;
}

/* Keeps the frame view true after a failure: it shows the last consistent state. */
static ShvStatus failed(ShvSimulation *simulation, ShvStatus status)
{
    ShvError ignored;
    (void)shv_simulation_fill(simulation, false, &ignored);
    return status;
}

/* Up to the next frame, which *animation tells the kind of; from a checkpoint in the midst of that on. */
static ShvStatus go_to_frame(ShvSimulation *simulation, bool *animation, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    const double until = animation_time(simulation);
    const int64_t every = simulation->scene->output.fracture_every;
    simulation->fracture_steps += simulation->taken;
    simulation->under_way = true;
    const ShvStatus status = shv_hybrid_advance(hybrid, until, every > 0 ? every - simulation->fracture_steps : 0,
                                                &simulation->taken, error);
    simulation->fracture_steps += simulation->taken;
    simulation->taken = 0;
    simulation->under_way = false;
    *animation = hybrid->state.time >= until;
    if (status != SHV_OK) return status;
    if (*animation) simulation->animation_frame++;
    if (every > 0 && simulation->fracture_steps >= every) simulation->fracture_steps = 0;
    return SHV_OK;
}

ShvStatus shv_simulation_advance(ShvSimulation *simulation, ShvError *error)
{
    if (!simulation->started) {
        simulation->started = true;
        simulation->animation_frame = 1;
        return shv_simulation_fill(simulation, true, error);
    }
    if (!simulation->under_way) shv_simulation_forget_told(simulation);
    if (shv_simulation_finished(simulation)) return SHV_OK;
    bool animation;
    const ShvStatus status = go_to_frame(simulation, &animation, error);
    return status == SHV_OK ? shv_simulation_fill(simulation, animation, error) : failed(simulation, status);
}

const ShvFrameView *shv_simulation_frame(const ShvSimulation *simulation)
{
    return &simulation->frame;
}

ShvMeshView shv_simulation_mesh(const ShvSimulation *simulation)
{
    const ShvModel *model = &simulation->hybrid.model;
    return (ShvMeshView){model->mesh.node_count, model->mesh.element_count, model->mesh.positions,
                         model->mesh.elements,   simulation->views.objects, model->object_count};
}

void shv_simulation_corner_positions(const ShvSimulation *simulation, double *corners)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    const ShvState *state = &hybrid->state;
#pragma omp parallel for schedule(static) num_threads(hybrid->model.threads)
    for (int32_t e = 0; e < state->element_count; e++) {
        const ShvFragment *fragment = &hybrid->fragments.items[state->element_fragment[e]];
        const bool flying = fragment->mode == SHV_MODE_FLIGHT;
        for (int32_t a = 0; a < 4; a++) {
            const int32_t node = shv_state_node(state, e, a);
            if (!flying) {
                shv_store3(corners + 12 * (int64_t)e + 3 * a, shv_state_position(state, node));
                continue;
            }
            const ShvVec3 arm = shv_rotate(fragment->orientation, shv_fragment_shape_position(fragment, state, node));
            shv_store3(corners + 12 * (int64_t)e + 3 * a, shv_add(fragment->position, arm));
        }
    }
}

void shv_simulation_bonds(const ShvSimulation *simulation, uint8_t *bonds)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    const ShvModel *model = &hybrid->model;
    const int64_t faces = 4 * (int64_t)hybrid->state.element_count;
    memset(bonds, 1, (size_t)faces);
    for (int64_t i = 0; i < faces && model->can_break; i++)
        bonds[i] = shv_cohesive_joins(&hybrid->cohesive, model->adjacency.element_facets[i]);
}

void shv_simulation_element_state(const ShvSimulation *simulation, int32_t *fragment, double *damage)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    const ShvModel *model = &hybrid->model;
    const int32_t count = hybrid->state.element_count;
    if (fragment) memcpy(fragment, hybrid->state.element_fragment, (size_t)count * sizeof(int32_t));
    if (!damage) return;
    memset(damage, 0, 4 * (size_t)count * sizeof(double));
    if (!model->can_break) return;
    for (int64_t i = 0; i < 4 * (int64_t)count; i++) {
        const int32_t facet = model->adjacency.element_facets[i];
        if (facet >= model->adjacency.interior_count) continue;
        const int32_t cohesive = hybrid->cohesive.facet_cohesive[facet];
        if (cohesive >= 0) damage[i] = shv_cohesive_facet_damage(&hybrid->cohesive, cohesive);
    }
}

/* What flies is in the fragments' records alone, what has cracked in the histories of its facets. */
uint64_t shv_simulation_hash(const ShvSimulation *simulation)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    uint64_t hash = shv_state_hash(&hybrid->state);
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *f = &hybrid->fragments.items[i];
        const double motion[] = {f->position.x,        f->position.y,    f->position.z,         f->orientation.w,
                                 f->orientation.x,     f->orientation.y, f->orientation.z,      f->velocity.x,
                                 f->velocity.y,        f->velocity.z,    f->angular_velocity.x, f->angular_velocity.y,
                                 f->angular_velocity.z};
        hash = shv_hash_bytes(hash, motion, sizeof motion);
    }
    for (int32_t i = 0; i < hybrid->obstacles.count; i++) {
        const ShvObstacle *o = &hybrid->obstacles.items[i];
        const double motion[] = {o->position.x,        o->position.y,    o->position.z,         o->orientation.w,
                                 o->orientation.x,     o->orientation.y, o->orientation.z,      o->velocity.x,
                                 o->velocity.y,        o->velocity.z,    o->angular_velocity.x, o->angular_velocity.y,
                                 o->angular_velocity.z};
        hash = shv_hash_bytes(hash, motion, sizeof motion);
    }
    if (!hybrid->model.can_break) return hash;
    for (int64_t i = 0; i < 3 * (int64_t)hybrid->cohesive.count; i++)
        hash = shv_hash_bytes(hash, &hybrid->cohesive.internal[i].history, sizeof(ShvHistory));
    return hash;
}

int32_t shv_simulation_material_count(const ShvSimulation *simulation)
{
    return simulation->hybrid.model.material_count;
}

ShvMaterialView shv_simulation_material(const ShvSimulation *simulation, int32_t index)
{
    const ShvModel *model = &simulation->hybrid.model;
    const ShvMaterial *material = &model->materials[index];
    return (ShvMaterialView){
        .name = material->name,
        .breakable = model->can_break && shv_material_can_open(material),
        .unresolved = material->unresolved,
        .mesh_edge = material->mesh_edge,
        .zone_edges = material->zone_edges,
        .resolved_edge = shv_material_resolved_edge(material),
        .nominal_strength = material->nominal_strength,
        .strength = material->strength[SHV_NORMAL],
        .nominal_energy = material->nominal_energy,
        .energy = material->fracture_energy[SHV_NORMAL],
        .cohesive_zone = shv_material_cohesive_zone(material),
        .snap_back = shv_material_snap_back(material),
        .tip_toughness = shv_material_tip_toughness(material, material->mesh_edge),
        .youngs_modulus = material->youngs_modulus,
        .poissons_ratio = material->poissons_ratio,
        .tip_strength = material->mesh_edge > 0.0 ? shv_material_tip_strength(material, material->mesh_edge) : 0.0,
        .compressive_strength = shv_material_compressive_strength(material),
    };
}

const char *shv_unresolved_name(ShvUnresolved unresolved)
{
    static const char *const names[] = {"keep", "scale_strength", "scale_energy", "tip_strength"};
    return names[unresolved];
}

int32_t shv_simulation_threads(const ShvSimulation *simulation)
{
    return simulation->hybrid.model.most_threads;
}

ShvNodesWithin shv_simulation_nodes_within(const ShvSimulation *simulation)
{
    return simulation->scene->output.nodes_within;
}

const char *shv_simulation_rigid_engine(const ShvSimulation *simulation)
{
    return shv_rigid_engine_name(simulation->hybrid.scene->rigid.engine);
}

ShvSimulationSummary shv_simulation_summary(const ShvSimulation *simulation)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    return (ShvSimulationSummary){hybrid->state.time, hybrid->state.step, hybrid->fragments.alive,
                                  hybrid->awake.count > 0};
}
