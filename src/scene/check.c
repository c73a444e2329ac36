#include "scene/check.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"
#include "scene/name_index.h"
#include "shiver/library.h"

typedef struct Checker {
    const ShvSceneItem *scene;
    const ShvAssembly *assembly;
    const char *folder;
    ShvPool *work;
    ShvDiagnostics *diagnostics;
    ShvNameIndex materials, bodies, conditions;
} Checker;

enum Group { GROUP_MATERIALS, GROUP_OBJECTS, GROUP_OBSTACLES, GROUP_SUPPORTS, GROUP_VELOCITIES, GROUP_TRACTIONS };

/* Where "a.b.c" below a node is: its value, or as much of the way as there is. */
static ShvPlace place_of(const ShvNode *node, const char *path)
{
    char part[64];
    while (*path) {
        const size_t length = strcspn(path, ".");
        memcpy(part, path, length);
        part[length] = '\0';
        const ShvEntry *entry = shv_tree_find(node, part);
        if (!entry) break;
        node = entry->value;
        path += length + (path[length] == '.');
    }
    return node->place;
}

static bool has(const ShvNode *node, const char *key)
{
    return shv_tree_find(node, key) != NULL;
}

#define fault(checker, node, path, ...) shv_error((checker)->diagnostics, place_of(node, path), __VA_ARGS__)
#define doubt(checker, node, path, ...) shv_warning((checker)->diagnostics, place_of(node, path), __VA_ARGS__)

/* ---- names -------------------------------------------------------------------------------------------- */

static void index_conditions(Checker *checker)
{
    const ShvSceneItem *scene = checker->scene;
    const ShvItems *groups[] = {&scene->supports, &scene->velocities, &scene->tractions};
    const size_t total =
        (size_t)scene->supports.count + (size_t)scene->velocities.count + (size_t)scene->tractions.count;
    checker->conditions = shv_name_index_create(checker->work, total);
    for (int g = 0; g < 3; g++) {
        const ShvConditionItem *items = groups[g]->data;
        for (int32_t i = 0; i < groups[g]->count; i++)
            shv_name_index_add(&checker->conditions, items[i].head.name, items[i].head.key, GROUP_SUPPORTS + g, true);
    }
    shv_name_index_finish(&checker->conditions, checker->diagnostics, "conditions");
}

static void index_names(Checker *checker)
{
    const ShvSceneItem *scene = checker->scene;
    const ShvSceneDefinition *definition = &checker->assembly->definition;
    const ShvMaterialItem *materials = scene->materials.data;
    checker->materials = shv_name_index_create(checker->work, (size_t)scene->materials.count);
    for (int32_t i = 0; i < scene->materials.count; i++)
        shv_name_index_add(&checker->materials, materials[i].head.name, materials[i].head.key, GROUP_MATERIALS, true);
    shv_name_index_finish(&checker->materials, checker->diagnostics, "materials");
    const size_t total = (size_t)definition->object_count + (size_t)definition->obstacle_count;
    checker->bodies = shv_name_index_create(checker->work, total);
    for (int32_t i = 0; i < definition->object_count; i++)
        shv_name_index_add(&checker->bodies, definition->objects[i].name,
                           checker->assembly->object_sources[i]->head.key, GROUP_OBJECTS, true);
    const ShvObstacleItem *obstacles = scene->obstacles.data;
    for (int32_t i = 0; i < definition->obstacle_count; i++)
        shv_name_index_add(&checker->bodies, definition->obstacles[i].name, obstacles[i].head.key, GROUP_OBSTACLES,
                           definition->obstacles[i].motion == SHV_OBSTACLE_FREE);
    shv_name_index_finish(&checker->bodies, checker->diagnostics, "bodies");
    index_conditions(checker);
}

/* ---- files -------------------------------------------------------------------------------------------- */

static bool file_exists(Checker *checker, const char *file, const char *ending)
{
    char *path = NULL;
    char name[4200];
    shv_format(name, sizeof name, "%.4096s%s", file, ending);
    if (shv_path_join(checker->work->memory, SHV_PART_SCENE, checker->folder, name, &path, NULL) != SHV_OK) {
        checker->work->failed = true;
        return true;
    }
    const bool exists = access(path, R_OK) == 0;
    shv_release(path);
    return exists;
}

static void check_file(Checker *checker, const ShvNode *node, const char *path, const char *file, const char *ending)
{
    if (!file || file_exists(checker, file, "") || (ending[0] && file_exists(checker, file, ending))) return;
    const char *folder = checker->folder && checker->folder[0] ? checker->folder : "the working directory";
    /* Meshes that come from elsewhere are not part of the source tree; one command makes all of them. */
    const char *remedy = strstr(file, "build/meshes/") ? "; ./bootstrap meshes makes it" : "";
    fault(checker, node, path, "file %s cannot be read%s; relative names start from %.200s", shv_quoted(file).text,
          remedy, folder);
}

/* ---- materials ---------------------------------------------------------------------------------------- */

static void check_material(Checker *checker, const ShvMaterialItem *item)
{
    const ShvMaterialDefinition *material = &item->definition;
    const ShvNode *node = item->head.node;
    if (!item->head.good || !material->breakable) return;
    if (isnan(material->cohesive_strength))
        fault(checker, node, "", "%s can break but has no cohesive_strength; give it, or 'breakable: false'",
              item->head.name);
    if (isnan(material->fracture_energy) && !isinf(material->cohesive_strength))
        fault(checker, node, "", "%s can break but has no fracture_energy; give it, or 'breakable: false'",
              item->head.name);
    static const struct {
        const char *key;
        size_t offset;
    } strengths[] = {{"cohesive_strength", offsetof(ShvMaterialDefinition, cohesive_strength)},
                     {"cohesive_strength_shear", offsetof(ShvMaterialDefinition, cohesive_strength_shear)}};
    for (int i = 0; i < 2; i++) {
        double strength;
        memcpy(&strength, (const char *)material + strengths[i].offset, sizeof strength);
        /* The theoretical strength of a perfect solid is near E/10 (Orowan); real ones stay below. */
        if (isfinite(strength) && strength > material->youngs_modulus / 5.0)
            doubt(checker, node, strengths[i].key,
                  "%s is above a fifth of youngs_modulus, more than any solid bears; "
                  "check the units",
                  strengths[i].key);
    }
}

/* Materials that no object is of; not where an object's material is unknown, for it may be the one that was meant. */
static void check_unused_materials(Checker *checker)
{
    const ShvMaterialItem *items = checker->scene->materials.data;
    const int32_t count = checker->scene->materials.count;
    const ShvSceneDefinition *definition = &checker->assembly->definition;
    bool *used = shv_pool_take(checker->work, (size_t)count, sizeof *used);
    if (!used) return;
    for (int32_t i = 0; i < definition->object_count; i++) {
        const ShvObjectDefinition *object = &definition->objects[i];
        for (int32_t k = -1; k < object->group_count; k++) {
            const char *name = k < 0 ? object->material : object->groups[k].material;
            const ShvNameEntry *found = name ? shv_name_index_find(&checker->materials, name) : NULL;
            if (!found) return;
            used[found->order] = true;
        }
    }
    for (int32_t i = 0; i < count; i++)
        if (!used[i])
            shv_warning(checker->diagnostics, items[i].head.key->place, "no object is of material %s",
                        shv_quoted(items[i].head.name).text);
}

static void check_materials(Checker *checker)
{
    const ShvMaterialItem *items = checker->scene->materials.data;
    for (int32_t i = 0; i < checker->scene->materials.count; i++) check_material(checker, &items[i]);
    if (checker->assembly->definition.object_count > 0) check_unused_materials(checker);
}

/* ---- objects ------------------------------------------------------------------------------------------ */

static void check_mesh(Checker *checker, const ShvNode *node, const ShvMeshDefinition *mesh)
{
    switch (mesh->kind) {
    case SHV_MESH_HOLLOW_BALL:
        if (mesh->thickness >= mesh->radius)
            fault(checker, node, "hollow_ball.thickness",
                  "thickness must be less than the radius; use ball for a solid one");
        break;
    case SHV_MESH_CYLINDER:
        if (mesh->inner_radius >= mesh->radius)
            fault(checker, node, "cylinder.inner_radius", "inner_radius must be less than radius");
        break;
    case SHV_MESH_NOTCHED_BEAM:
        if (mesh->notch_depth >= mesh->size[2])
            fault(checker, node, "notched_beam.notch_depth", "notch_depth must be less than the height, size[2]");
        if (fabs(mesh->notch_offset) >= 0.5 * mesh->size[0])
            fault(checker, node, "notched_beam.notch_offset",
                  "notch_offset must be less than half the length, size[0]");
        if (mesh->notch_edge > mesh->edge)
            fault(checker, node, "notched_beam.notch_edge",
                  "notch_edge must be at most edge: it refines the mesh at the notch");
        break;
    case SHV_MESH_GMSH:
        check_file(checker, node, "gmsh.file", mesh->file, "");
        break;
    case SHV_MESH_TETGEN:
        check_file(checker, node, "tetgen.file", mesh->file, ".node");
        break;
    case SHV_MESH_SHELL:
        check_file(checker, node, "shell.surface", mesh->file, "");
        break;
    case SHV_MESH_STL:
        check_file(checker, node, "stl.file", mesh->file, "");
        break;
    default:
        break;
    }
}

static void check_material_name(Checker *checker, const ShvNode *node, const char *material)
{
    if (!material || shv_name_index_find(&checker->materials, material)) return;
    if (shv_library_find(material))
        shv_error(checker->diagnostics, place_of(node, "material"),
                  "material '%s' is of the library; add it to the scene: 'materials: {%s: {library: %s}}'", material,
                  material, material);
    else
        shv_name_index_report_unknown(&checker->materials, checker->diagnostics, place_of(node, "material"), "material",
                                      material, "material of the scene", SHV_ANY_GROUP);
}

static void check_groups(Checker *checker, const ShvObjectItem *item)
{
    const ShvMeshKind kind = item->definition.mesh.kind;
    const ShvGroupItem *groups = item->groups.data;
    for (int32_t i = 0; i < item->groups.count; i++)
        check_material_name(checker, groups[i].head.node, groups[i].definition.material);
    if (item->groups.count > 0 && item->head.good && kind != SHV_MESH_GMSH && kind != SHV_MESH_STL)
        fault(checker, item->head.node, "groups", "only a mesh from a gmsh file has groups: mesh: {gmsh: …}");
}

/* Other tets have other facets: a crack that the mesh was made for would be bridged where they are. */
static void check_cracks(Checker *checker, const ShvObjectItem *item)
{
    if (item->head.good && item->cracks.count > 0 && item->definition.mesh.improve)
        fault(
            checker, item->head.node, "cracks",
            "'improve' may take away facets that 'cracks' open: leave out one of them, and better the mesh where it is "
            "made");
}

static void check_objects(Checker *checker)
{
    const ShvObjectItem *items = checker->scene->objects.data;
    for (int32_t i = 0; i < checker->scene->objects.count; i++) {
        const ShvObjectItem *item = &items[i];
        const ShvEntry *mesh = shv_tree_find(item->head.node, "mesh");
        check_material_name(checker, item->head.node, item->definition.material);
        check_groups(checker, item);
        check_cracks(checker, item);
        if (item->head.good && mesh) check_mesh(checker, mesh->value, &item->definition.mesh);
    }
    const ShvEntry *objects = shv_tree_find(checker->scene->head.node, "objects");
    if (objects && objects->value->kind == SHV_NODE_MAPPING && objects->value->count == 0)
        fault(checker, objects->value, "", "the scene has no objects; give at least one");
}

/* ---- conditions --------------------------------------------------------------------------------------- */

static bool is_object(const ShvNameEntry *found)
{
    return found && found->group == GROUP_OBJECTS;
}

static void check_selection(Checker *checker, const ShvNode *node, const ShvSelection *selection)
{
    if (selection->kind != SHV_SELECT_BOX) return;
    for (int axis = 0; axis < 3; axis++)
        if (selection->box_max[axis] < selection->box_min[axis]) {
            fault(checker, node, "on.box.max", "max is below min along %c; no node lies in such a box", "xyz"[axis]);
            return;
        }
}

static void check_condition(Checker *checker, const ShvConditionItem *item)
{
    const ShvConditionDefinition *condition = &item->definition;
    const ShvNode *node = item->head.node;
    if (condition->object && !is_object(shv_name_index_find(&checker->bodies, condition->object)))
        shv_name_index_report_unknown(&checker->bodies, checker->diagnostics, place_of(node, "object"), "object",
                                      condition->object, "object of the scene", GROUP_OBJECTS);
    if (!item->head.good) return;
    check_selection(checker, node, &condition->selection);
    if (condition->end <= condition->start) fault(checker, node, "end", "end must be after start");
    if (condition->start >= checker->assembly->definition.duration)
        doubt(checker, node, "start", "start is not before the end of the run; %s never acts", item->head.name);
}

static void check_conditions(Checker *checker)
{
    const ShvSceneItem *scene = checker->scene;
    const ShvItems *groups[] = {&scene->supports, &scene->velocities, &scene->tractions};
    for (int g = 0; g < 3; g++) {
        const ShvConditionItem *items = groups[g]->data;
        for (int32_t i = 0; i < groups[g]->count; i++) check_condition(checker, &items[i]);
    }
}

/* ---- obstacles ---------------------------------------------------------------------------------------- */

static void check_keyframes(Checker *checker, const ShvObstacleItem *item)
{
    const ShvKeyframeItem *frames = item->keyframes.data;
    for (int32_t i = 1; i < item->keyframes.count; i++)
        if (frames[i].keyframe.time <= frames[i - 1].keyframe.time)
            fault(checker, frames[i].head.node, "time", "time must be later than that of the keyframe before");
    if (has(item->head.node, "motion") && item->keyframes.count == 0)
        fault(checker, item->head.node, "motion", "motion has no keyframes; give at least one, or leave it out");
}

/* Keys that an obstacle of this shape and motion has no use for: they would be ignored, so they are faults. */
static void check_unused_keys(Checker *checker, const ShvObstacleItem *item)
{
    static const char *const keys[] = {"mass", "motion", "position", "rotation", "velocity", "angular_velocity"};
    const ShvNode *node = item->head.node;
    const bool plane = item->definition.shape == SHV_OBSTACLE_PLANE;
    const bool scripted = has(node, "motion"), is_free = has(node, "mass");
    if (scripted && is_free && !plane) {
        fault(checker, node, "mass", "mass makes a free body, motion a scripted one; keep one of them");
        return;
    }
    for (int i = 0; i < 6; i++) {
        if (!has(node, keys[i])) continue;
        if (plane)
            fault(checker, node, keys[i], "a plane is fixed where its normal and offset say; remove %s", keys[i]);
        else if (scripted && i >= 2)
            fault(checker, node, keys[i], "the keyframes of motion say where the obstacle is; remove %s", keys[i]);
        else if (!is_free && i >= 4)
            fault(checker, node, keys[i], "a fixed obstacle has no velocity; remove %s, or give mass or motion",
                  keys[i]);
    }
}

static void check_obstacles(Checker *checker)
{
    const ShvObstacleItem *items = checker->scene->obstacles.data;
    for (int32_t i = 0; i < checker->scene->obstacles.count; i++) {
        if (!items[i].head.good) continue;
        check_keyframes(checker, &items[i]);
        check_unused_keys(checker, &items[i]);
        if (items[i].definition.shape == SHV_OBSTACLE_MESH)
            check_file(checker, items[i].head.node, "mesh.file", items[i].definition.file, "");
    }
}

/* ---- events ------------------------------------------------------------------------------------------- */

static void check_target(Checker *checker, const ShvEventItem *item)
{
    const ShvEventDefinition *event = &item->definition;
    const ShvNode *node = item->head.node;
    if (!event->target) return;
    if (event->kind == SHV_EVENT_RELEASE) {
        if (!shv_name_index_find(&checker->conditions, event->target))
            shv_name_index_report_unknown(&checker->conditions, checker->diagnostics, place_of(node, "release"),
                                          "release", event->target,
                                          "support, imposed velocity or traction of the scene", SHV_ANY_GROUP);
        return;
    }
    const ShvNameEntry *found = shv_name_index_find(&checker->bodies, event->target);
    if (found && found->usable) return;
    const char *path = event->kind == SHV_EVENT_IMPULSE ? "impulse.target" : "set_velocity.target";
    if (found)
        fault(checker, node, path, "target %s is not free to move; an event acts on an object or an obstacle with mass",
              shv_quoted(event->target).text);
    else
        shv_name_index_report_unknown(&checker->bodies, checker->diagnostics, place_of(node, path), "target",
                                      event->target, "object or free obstacle of the scene", SHV_ANY_GROUP);
}

static void check_events(Checker *checker)
{
    const ShvEventItem *items = checker->scene->events.data;
    for (int32_t i = 0; i < checker->scene->events.count; i++) {
        const ShvEventItem *item = &items[i];
        check_target(checker, item);
        if (!item->head.good) continue;
        if (i > 0 && items[i - 1].head.good && item->definition.time < items[i - 1].definition.time)
            fault(checker, item->head.node, "at",
                  "'at' lies before the event above it; put events in the order of their times");
        if (item->definition.time > checker->assembly->definition.duration)
            doubt(checker, item->head.node, "at", "'at' lies after the end of the run; the event never happens");
    }
}

/* ---- probes ------------------------------------------------------------------------------------------- */

static void check_probe(Checker *checker, const ShvProbeItem *item)
{
    const ShvProbeDefinition *probe = &item->definition;
    const ShvNode *node = item->head.node;
    const char *path = probe->kind == SHV_PROBE_NODES ? "nodes.object" : "object";
    if (probe->kind != SHV_PROBE_POINT && has(node, "object")) {
        fault(checker, node, "object", "object goes with point alone; remove it");
        return;
    }
    const ShvNameEntry *body = probe->object ? shv_name_index_find(&checker->bodies, probe->object) : NULL;
    if (probe->object && !is_object(body))
        shv_name_index_report_unknown(&checker->bodies, checker->diagnostics, place_of(node, path), "object",
                                      probe->object, "object of the scene", GROUP_OBJECTS);
    const ShvNameEntry *obstacle = probe->obstacle ? shv_name_index_find(&checker->bodies, probe->obstacle) : NULL;
    if (is_object(obstacle))
        fault(checker, node, "obstacle", "%s is an object; watch it with point or nodes", probe->obstacle);
    else if (probe->obstacle && !obstacle)
        shv_name_index_report_unknown(&checker->bodies, checker->diagnostics, place_of(node, "obstacle"), "obstacle",
                                      probe->obstacle, "obstacle of the scene", GROUP_OBSTACLES);
    const ShvEntry *nodes = item->head.good ? shv_tree_find(node, "nodes") : NULL;
    if (nodes) check_selection(checker, nodes->value, &probe->selection);
}

static void check_probes(Checker *checker)
{
    const ShvProbeItem *items = checker->scene->probes.data;
    for (int32_t i = 0; i < checker->scene->probes.count; i++) check_probe(checker, &items[i]);
}

/* ---- reference ---------------------------------------------------------------------------------------- */

static void check_reference_plane(Checker *checker, const ShvReferenceDefinition *reference)
{
    const ShvNode *root = checker->scene->head.node;
    const ShvSceneDefinition *scene = &checker->assembly->definition;
    for (int32_t i = 0; i < scene->obstacle_count; i++) {
        if (strcmp(scene->obstacles[i].name, reference->on) != 0) continue;
        if (scene->obstacles[i].shape != SHV_OBSTACLE_PLANE)
            fault(checker, root, "reference.on", "%s is no plane; the closed forms know planes only", reference->on);
        return;
    }
    fault(checker, root, "reference.on", "there is no obstacle %s; give a plane of the scene",
          shv_quoted(reference->on).text);
}

static void check_reference(Checker *checker)
{
    const ShvReferenceDefinition *reference = &checker->scene->definition.reference;
    const ShvNode *root = checker->scene->head.node;
    if (reference->law == SHV_REFERENCE_NONE) return;
    const bool meets = reference->law == SHV_REFERENCE_BOUNCE || reference->law == SHV_REFERENCE_SLIDE ||
                       reference->law == SHV_REFERENCE_ROLL;
    if (reference->body) {
        const ShvNameEntry *found = shv_name_index_find(&checker->bodies, reference->body);
        if (!found)
            shv_name_index_report_unknown(&checker->bodies, checker->diagnostics, place_of(root, "reference.body"),
                                          "body", reference->body, "object or free obstacle of the scene",
                                          SHV_ANY_GROUP);
        else if (!found->usable)
            fault(checker, root, "reference.body", "%s is not free to move; give an object or an obstacle with mass",
                  reference->body);
    } else if (meets) {
        fault(checker, root, "reference", "this law needs 'body', the object or free obstacle that follows it");
    }
    if (meets && !reference->on)
        fault(checker, root, "reference", "this law needs 'on', the plane that the body meets");
    if (!meets && reference->on) fault(checker, root, "reference.on", "this law meets no plane; remove 'on'");
    if (meets && reference->on) check_reference_plane(checker, reference);
}

static void check_fracture(Checker *checker)
{
    const ShvFractureDefinition *fracture = &checker->scene->definition.fracture;
    const ShvNode *root = checker->scene->head.node;
    if (fracture->time_step > checker->scene->definition.duration)
        fault(checker, root, "fracture.time_step", "time_step is longer than the whole run, see duration");
}

static void check_dust(Checker *checker)
{
    const ShvRigidDefinition *rigid = &checker->scene->definition.rigid;
    const ShvNode *root = checker->scene->head.node;
    if (rigid->dust != SHV_DUST_KEEP && rigid->dust_size == 0.0)
        fault(checker, root, "rigid.dust",
              "nothing is dust without a size; give dust_size, the diameter below which a "
              "piece is, or 'dust: keep'");
    if (rigid->dust == SHV_DUST_KEEP && rigid->dust_size > 0.0)
        doubt(checker, root, "rigid.dust_size",
              "dust is kept, so that its size says nothing; give 'dust: particles' or "
              "'dust: bin'");
}

/* Keys of `pbd` that nothing in the scene listens to: more likely a forgotten switch than a wish. */
static void check_pbd(Checker *checker)
{
    static const char *const of_rigid_mode[] = {"damping", "exact_rotation"};
    const ShvSceneDefinition *scene = &checker->scene->definition;
    const ShvNode *root = checker->scene->head.node;
    const ShvEntry *pbd = checker->scene->head.good ? shv_tree_find(root, "pbd") : NULL;
    const bool rigid = scene->rigid.engine == SHV_RIGID_PBD, bars = scene->fracture.stabiliser == SHV_STABILISER_BARS;
    if ((rigid || bars) && scene->pbd.stiffness == 0.0)
        doubt(checker, root, "pbd.stiffness", "with stiffness 0 the bars hold nothing together");
    if (!pbd || rigid) return;
    if (!bars) {
        doubt(checker, root, "pbd", "nothing uses pbd; give 'rigid: {engine: pbd}' or 'fracture: {stabiliser: bars}'");
        return;
    }
    for (int i = 0; i < 2; i++)
        if (has(pbd->value, of_rigid_mode[i]))
            doubt(checker, pbd->value, of_rigid_mode[i], "%s acts in rigid mode alone; give 'rigid: {engine: pbd}'",
                  of_rigid_mode[i]);
}

/* Bodies that these engines move meet obstacles alone. */
static void check_meetings(Checker *checker)
{
    const ShvSceneDefinition *scene = &checker->scene->definition;
    const bool analytic = scene->rigid.engine == SHV_RIGID_ANALYTIC;
    const ShvItems *objects = &checker->scene->objects;
    const bool several =
        objects->count > 1 || (objects->count == 1 && ((const ShvObjectItem *)objects->data)->repeat_count > 1);
    if ((analytic || scene->rigid.engine == SHV_RIGID_PBD) && several)
        doubt(checker, checker->scene->head.node, "rigid.engine",
              "objects that fly under %s go through one another; give 'engine: bullet' where they can meet",
              analytic ? "analytic" : "pbd");
}

static void check_bullet_plain(Checker *checker)
{
    const ShvSceneDefinition *scene = &checker->scene->definition;
    if (scene->rigid.engine != SHV_RIGID_BULLET_PLAIN || !scene->fracture.enabled) return;
    const ShvMaterialItem *materials = checker->scene->materials.data;
    for (int32_t i = 0; i < checker->scene->materials.count; i++) {
        if (!materials[i].definition.breakable || isinf(materials[i].definition.cohesive_strength)) continue;
        doubt(
            checker, checker->scene->head.node, "rigid.engine",
            "bodies that fly in bullet_plain go through those in fracture mode; give 'engine: bullet' for what breaks");
        return;
    }
}

static void check_output(Checker *checker)
{
    const ShvOutputDefinition *output = &checker->scene->definition.output;
    const ShvNodesWithin *within = &output->nodes_within;
    const ShvNode *node = checker->scene->head.node;
    if (!shv_nodes_limited(within)) return;
    if (!output->nodes)
        fault(checker, node, "output.nodes_within",
              "node positions are not recorded at all; give 'nodes: true' beside it, or leave it out");
    if (within->to < within->from)
        fault(checker, node, "output.nodes_within.to", "it is before 'from'; no frame lies between");
    for (int axis = 0; axis < 3; axis++)
        if (within->box.box_max[axis] < within->box.box_min[axis])
            fault(checker, node, "output.nodes_within.box.max", "max is below min along %c; no node lies in such a box",
                  "xyz"[axis]);
}

void shv_check_scene(const ShvSceneItem *scene, const ShvAssembly *assembly, const char *folder, ShvPool *work,
                     ShvDiagnostics *diagnostics)
{
    Checker checker = {
        .scene = scene, .assembly = assembly, .folder = folder, .work = work, .diagnostics = diagnostics};
    index_names(&checker);
    check_materials(&checker);
    check_objects(&checker);
    check_conditions(&checker);
    check_obstacles(&checker);
    check_events(&checker);
    check_probes(&checker);
    check_reference(&checker);
    check_fracture(&checker);
    check_pbd(&checker);
    check_dust(&checker);
    check_meetings(&checker);
    check_bullet_plain(&checker);
    check_output(&checker);
}
