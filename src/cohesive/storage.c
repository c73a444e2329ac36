#include "cohesive/storage.h"

#include "model/selection.h"

/* X(type, name, components): per cohesive facet */
#define FACET_ARRAYS(X)                                                                                                \
    X(int32_t, facet, 1)                                                                                               \
    X(uint8_t, partner, 3)                                                                                             \
    X(ShvCohesiveSides, sides, 1)                                                                                      \
    X(double, area, 1)                                                                                                 \
    X(ShvLaw, law, 1)                                                                                                  \
    X(ShvInternalVariables, internal, 3)                                                                               \
    X(ShvVec3, force, 3)                                                                                               \
    X(uint8_t, phase, 1)                                                                                               \
    X(uint8_t, bonded, 1)                                                                                              \
    X(double, born, 1)                                                                                                 \
    X(uint8_t, opened, 1)                                                                                              \
    X(int32_t, failed, 1)                                                                                              \
    X(int32_t, live, 1)                                                                                                \
    X(ShvFacetRotation, rotations, 1)                                                                                  \
    X(ShvFacetGaps, gaps, 1)                                                                                           \
    X(double, apart, 1)                                                                                                \
    X(int32_t, closed, 1)                                                                                              \
    X(int32_t, chunks, 1)                                                                                              \
    X(ShvVec3, couple, 3)                                                                                              \
    X(ShvCohesivePoint, points, 3)                                                                                     \
    X(ShvCohesiveCorner, corners, 3)

static size_t facet_bytes(void)
{
    size_t bytes = 0;
#define COUNT_BYTES(type, name, components) bytes += (components) * sizeof(type);
    FACET_ARRAYS(COUNT_BYTES)
#undef COUNT_BYTES
    return bytes;
}

ShvStatus shv_cohesive_reserve_facets(ShvCohesive *cohesive, int32_t more, ShvError *error)
{
    const int32_t needed = cohesive->count + more; /* never beyond the mesh's interior facets */
    if (needed <= cohesive->capacity) return SHV_OK;
    int32_t capacity = cohesive->capacity + cohesive->capacity / 2;
    if (capacity > cohesive->model->adjacency.interior_count) capacity = cohesive->model->adjacency.interior_count;
    if (capacity < needed) capacity = needed;
#define GROW(type, name, components)                                                                                   \
    SHV_RESIZE(cohesive->memory, SHV_PART_COHESIVE, cohesive->name, (components) * (size_t)capacity,                   \
               "cohesive facets", (size_t)capacity * facet_bytes(), error);
    FACET_ARRAYS(GROW)
#undef GROW
    cohesive->capacity = capacity;
    return SHV_OK;
}

static ShvStatus reserve_search(ShvCohesive *cohesive, int32_t nodes, ShvError *error)
{
    ShvStarSearch *search = &cohesive->search;
    const size_t count = (size_t)nodes, bytes = count * (sizeof *search->nodes + 4 * sizeof *search->ratio + 1);
    SHV_RESIZE(cohesive->memory, SHV_PART_STRESS, search->nodes, count, "nodes that may part", bytes, error);
    SHV_RESIZE(cohesive->memory, SHV_PART_STRESS, search->ratio, count, "nodes that may part", bytes, error);
    SHV_RESIZE(cohesive->memory, SHV_PART_STRESS, search->mark, count, "nodes that may part", bytes, error);
    SHV_RESIZE(cohesive->memory, SHV_PART_STRESS, search->value, count, "nodes that may part", bytes, error);
    SHV_RESIZE(cohesive->memory, SHV_PART_STRESS, search->held, count, "nodes that may part", bytes, error);
    SHV_RESIZE(cohesive->memory, SHV_PART_STRESS, search->left, count, "nodes that may part", bytes, error);
    for (int32_t i = cohesive->node_capacity; i < nodes; i++) {
        search->mark[i] = 0;
        search->value[i] = search->held[i] = search->left[i] = 0.0;
    }
    return SHV_OK;
}

ShvStatus shv_cohesive_reserve_nodes(ShvCohesive *cohesive, int32_t nodes, ShvError *error)
{
    if (nodes <= cohesive->node_capacity) return SHV_OK;
    SHV_RESIZE(cohesive->memory, SHV_PART_COHESIVE, cohesive->pulled_velocity, 3 * (size_t)nodes, "velocities of nodes",
               33 * (size_t)nodes, error);
    SHV_RESIZE(cohesive->memory, SHV_PART_COHESIVE, cohesive->node_news, (size_t)nodes, "velocities of nodes",
               33 * (size_t)nodes, error);
    SHV_RESIZE(cohesive->memory, SHV_PART_COHESIVE, cohesive->corner_nodes, (size_t)nodes, "nodes of corners",
               33 * (size_t)nodes, error);
    SHV_RESIZE(cohesive->memory, SHV_PART_COHESIVE, cohesive->struck, (size_t)nodes, "velocities of nodes",
               33 * (size_t)nodes, error);
    if (cohesive->settings->criterion == SHV_CRITERION_PRINCIPAL) {
        const size_t values = 2 * (size_t)nodes;
        SHV_RESIZE(cohesive->memory, SHV_PART_STRESS, cohesive->node_value, values, "principal stresses of nodes",
                   values * sizeof *cohesive->node_value, error);
        SHV_RESIZE(cohesive->memory, SHV_PART_STRESS, cohesive->watched_nodes, (size_t)nodes, "nodes to look at",
                   4 * (size_t)nodes, error);
    }
    if (cohesive->settings->criterion == SHV_CRITERION_FORCE) SHV_TRY(reserve_search(cohesive, nodes, error));
    cohesive->node_capacity = nodes;
    return SHV_OK;
}

static ShvStatus create_stars(ShvStars *stars, ShvMemory *memory, int32_t count, int32_t most_corners, ShvError *error)
{
    stars->items = shv_allocate(memory, SHV_PART_COHESIVE, (size_t)count, sizeof *stars->items);
    if (!stars->items) return shv_fail_memory(error, "the tets round a node", (size_t)count * sizeof *stars->items);
    for (; stars->count < count; stars->count++)
        SHV_TRY(shv_star_create(&stars->items[stars->count], memory, most_corners, error));
    return SHV_OK;
}

static int32_t most_corners(const ShvAdjacency *adjacency, int32_t nodes)
{
    int32_t most = 0;
    for (int32_t i = 0; i < nodes; i++) {
        const int32_t corners = adjacency->corner_start[i + 1] - adjacency->corner_start[i];
        if (corners > most) most = corners;
    }
    return most;
}

static bool may_open(const ShvModel *model, const ShvSelection *where, int32_t facet)
{
    const int32_t element = model->adjacency.facet_elements[2 * (int64_t)facet];
    const uint8_t face = model->adjacency.facet_faces[2 * (int64_t)facet];
    for (int i = 0; i < 3; i++) {
        const int32_t node = model->mesh.elements[4 * (int64_t)element + shv_face_corners[face][i]];
        if (!shv_selection_contains(where, shv_mesh_position(&model->mesh, node))) return false;
    }
    return true;
}

static double facet_strength(const ShvModel *model, const ShvSelection *where, int32_t facet)
{
    const ShvMaterial *material = shv_cohesive_material(model, facet);
    if (!material || !may_open(model, where, facet)) return (double)INFINITY;
    return material->strength[SHV_NORMAL] * shv_cohesive_strength_scale(model, facet);
}

static ShvStatus allocate(ShvCohesive *cohesive, ShvError *error)
{
    const ShvModel *model = cohesive->model;
    ShvMemory *memory = cohesive->memory;
    const size_t facets = (size_t)model->adjacency.interior_count;
    const size_t batches = ((size_t)model->mesh.element_count + SHV_LANES - 1) / SHV_LANES;
    const size_t corners = (size_t)most_corners(&model->adjacency, model->mesh.node_count);
    cohesive->facet_cohesive = shv_allocate(memory, SHV_PART_COHESIVE, facets, sizeof *cohesive->facet_cohesive);
    cohesive->facet_strength = shv_allocate(memory, SHV_PART_COHESIVE, facets, sizeof *cohesive->facet_strength);
    cohesive->corner_label = shv_allocate(memory, SHV_PART_COHESIVE, corners, sizeof *cohesive->corner_label);
    cohesive->corner_queue = shv_allocate(memory, SHV_PART_COHESIVE, corners, sizeof *cohesive->corner_queue);
    const size_t nodes = (size_t)model->mesh.node_count;
    cohesive->origin_fill = shv_allocate(memory, SHV_PART_COHESIVE, nodes, sizeof *cohesive->origin_fill);
    cohesive->overdrawn = shv_allocate(memory, SHV_PART_COHESIVE, nodes, sizeof *cohesive->overdrawn);
    cohesive->cluster = shv_allocate(memory, SHV_PART_COHESIVE, nodes + 1, sizeof *cohesive->cluster);
    cohesive->cluster_corner = shv_allocate(memory, SHV_PART_COHESIVE, nodes + 1, sizeof *cohesive->cluster_corner);
    cohesive->budget = shv_allocate(memory, SHV_PART_COHESIVE, nodes, sizeof *cohesive->budget);
    cohesive->kicked_clusters = shv_allocate(memory, SHV_PART_COHESIVE, nodes, sizeof *cohesive->kicked_clusters);
    cohesive->rotated_clusters = shv_allocate(memory, SHV_PART_COHESIVE, nodes, sizeof *cohesive->rotated_clusters);
    cohesive->corner_copy = shv_allocate(memory, SHV_PART_COHESIVE, corners, sizeof *cohesive->corner_copy);
    cohesive->most_facets = (int32_t)(3 * corners / 2); /* of a tet's faces at a node, three, each belongs to two */
    const size_t solves = (size_t)model->most_threads * (size_t)cohesive->most_facets;
    cohesive->solves = shv_allocate(memory, SHV_PART_COHESIVE, solves, sizeof *cohesive->solves);
    cohesive->facet_value = shv_allocate(memory, SHV_PART_STRESS, facets, sizeof *cohesive->facet_value);
    cohesive->facet_watch = shv_allocate(memory, SHV_PART_STRESS, facets, sizeof *cohesive->facet_watch);
    cohesive->face_weight = shv_allocate(memory, SHV_PART_STRESS, 4 * SHV_LANES * batches, sizeof(double));
    cohesive->faces = shv_allocate(memory, SHV_PART_STRESS, batches, sizeof *cohesive->faces);
    cohesive->asked = shv_allocate(memory, SHV_PART_STRESS, batches, sizeof *cohesive->asked);
    cohesive->stress_known = shv_allocate(memory, SHV_PART_STRESS, batches, sizeof *cohesive->stress_known);
    cohesive->watched = shv_allocate(memory, SHV_PART_STRESS, facets, sizeof *cohesive->watched);
    if (!cohesive->facet_cohesive || !cohesive->facet_strength || !cohesive->corner_label || !cohesive->corner_queue ||
        !cohesive->corner_copy || !cohesive->origin_fill || !cohesive->overdrawn || !cohesive->cluster ||
        !cohesive->cluster_corner || !cohesive->budget || !cohesive->kicked_clusters || !cohesive->rotated_clusters ||
        !cohesive->facet_value || !cohesive->facet_watch || !cohesive->face_weight || !cohesive->faces ||
        !cohesive->asked || !cohesive->stress_known || !cohesive->watched || !cohesive->solves)
        return shv_fail_memory(error, "facets that may break",
                               facets * 25 + batches * 265 + corners * 12 + nodes * 52 +
                                   solves * sizeof *cohesive->solves);
    if (cohesive->settings->criterion == SHV_CRITERION_FORCE) {
        ShvStarSearch *search = &cohesive->search;
        SHV_TRY(create_stars(&search->stars, memory, model->most_threads, (int32_t)corners, error));
        search->facet_along = shv_allocate(memory, SHV_PART_STRESS, facets, sizeof *search->facet_along);
        if (!search->facet_along) return shv_fail_memory(error, "directions of opening", facets * sizeof(double));
    }
    SHV_TRY(shv_front_create(cohesive, error));
    return shv_cohesive_reserve_nodes(cohesive, model->mesh.node_count, error);
}

/* The principal criterion judges tension alone: nothing would say when a facet slides. */
static ShvStatus check_friction(const ShvModel *model, const ShvFractureDefinition *settings, ShvError *error)
{
    for (int32_t i = 0; i < model->material_count; i++)
        if (settings->criterion == SHV_CRITERION_PRINCIPAL && model->materials[i].friction > 0.0)
            return shv_fail(
                error, SHV_BAD_INPUT,
                "material '%s' has a friction_angle, which 'fracture: {criterion: principal}' does not ask "
                "for: it judges tension alone; give 'criterion: force' or 'traction', or 'friction_angle: 0'",
                model->materials[i].name);
    return SHV_OK;
}

ShvStatus shv_cohesive_create(ShvCohesive *cohesive, const ShvModel *model, const ShvFractureDefinition *settings,
                              ShvError *error)
{
    *cohesive = (ShvCohesive){.memory = model->memory, .model = model, .settings = settings};
    if (!model->can_break)
        return shv_fail(error, SHV_BAD_INPUT,
                        "nothing in this model can break; make a material breakable and enable "
                        "fracture, or leave cohesive facets out");
    SHV_TRY(check_friction(model, settings, error));
    const ShvStatus status = allocate(cohesive, error);
    if (status != SHV_OK) {
        shv_cohesive_release(cohesive);
        return status;
    }
    for (int32_t i = 0; i < model->adjacency.interior_count; i++) {
        cohesive->facet_cohesive[i] = -1;
        cohesive->facet_strength[i] = facet_strength(model, &settings->on, i);
    }
    const ShvStatus begun = shv_initiation_create(cohesive, error);
    if (begun != SHV_OK) shv_cohesive_release(cohesive);
    return begun;
}

void shv_cohesive_release(ShvCohesive *cohesive)
{
#define RELEASE(type, name, components) shv_release(cohesive->name);
    FACET_ARRAYS(RELEASE)
#undef RELEASE
    shv_release(cohesive->facet_cohesive);
    shv_release(cohesive->facet_strength);
    shv_release(cohesive->corner_label);
    shv_release(cohesive->corner_queue);
    shv_release(cohesive->corner_copy);
    shv_release(cohesive->solves);
    shv_release(cohesive->origin_fill);
    shv_release(cohesive->overdrawn);
    shv_release(cohesive->cluster);
    shv_release(cohesive->cluster_corner);
    shv_release(cohesive->budget);
    shv_release(cohesive->kicked_clusters);
    shv_release(cohesive->rotated_clusters);
    shv_release(cohesive->pulled_velocity);
    shv_release(cohesive->node_news);
    shv_release(cohesive->corner_nodes);
    shv_release(cohesive->struck);
    shv_release(cohesive->facet_value);
    shv_release(cohesive->facet_watch);
    shv_release(cohesive->face_weight);
    shv_release(cohesive->faces);
    shv_release(cohesive->asked);
    shv_release(cohesive->stress_known);
    shv_release(cohesive->node_value);
    shv_release(cohesive->watched);
    shv_release(cohesive->watched_nodes);
    for (int32_t k = 0; k < cohesive->search.stars.count; k++) shv_star_release(&cohesive->search.stars.items[k]);
    shv_release(cohesive->search.stars.items);
    shv_release(cohesive->search.nodes);
    shv_release(cohesive->search.ratio);
    shv_release(cohesive->search.mark);
    shv_release(cohesive->search.value);
    shv_release(cohesive->search.held);
    shv_release(cohesive->search.left);
    shv_release(cohesive->search.facet_along);
    shv_front_release(&cohesive->front);
    shv_initiation_release(&cohesive->initiation);
    *cohesive = (ShvCohesive){0};
}
