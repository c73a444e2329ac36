#include "conditions/imposed.h"

#include <string.h>

#include "base/sorted.h"

/* ---- making ---- */

static const ShvObject *find_object(const ShvModel *model, const char *name)
{
    for (int32_t i = 0; i < model->object_count; i++)
        if (name && strcmp(model->objects[i].name, name) == 0) return &model->objects[i];
    return NULL;
}

static bool finite_values(const double values[3])
{
    return shv_finite3(shv_load3(values));
}

static ShvStatus check_selection(const ShvSelection *selection, ShvError *error)
{
    if (!(selection->tolerance >= 0.0) || !isfinite(selection->tolerance))
        return shv_fail(error, SHV_BAD_INPUT, "the tolerance must be 0 or more, but is %g m", selection->tolerance);
    if (selection->kind == SHV_SELECT_PLANE) {
        const ShvVec3 normal = shv_load3(selection->plane_normal);
        if (!shv_finite3(normal) || shv_dot(normal, normal) == 0.0 || !isfinite(selection->plane_offset))
            return shv_fail(error, SHV_BAD_INPUT,
                            "the plane needs a finite normal that is not zero, and a finite offset");
    }
    if (selection->kind == SHV_SELECT_BOX)
        for (int k = 0; k < 3; k++)
            if (!(selection->box_min[k] <= selection->box_max[k]))
                return shv_fail(error, SHV_BAD_INPUT,
                                "the box's lower corner must not lie above its upper one "
                                "(%g m and %g m along axis %d)",
                                selection->box_min[k], selection->box_max[k], k);
    return SHV_OK;
}

static ShvStatus check_condition(const ShvConditionDefinition *definition, ShvError *error)
{
    if (definition->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the definition did not start from shv_condition_default()");
    if (!finite_values(definition->value)) return shv_fail(error, SHV_BAD_INPUT, "its value must be finite");
    if (!(definition->ramp_time >= 0.0) || !isfinite(definition->ramp_time))
        return shv_fail(error, SHV_BAD_INPUT, "ramp_time must be 0 or more, but is %g s", definition->ramp_time);
    if (!isfinite(definition->start) || !(definition->end > definition->start))
        return shv_fail(error, SHV_BAD_INPUT, "it must end after it starts, but lasts from %g s to %g s",
                        definition->start, definition->end);
    if (definition->kind != SHV_CONDITION_TRACTION && !definition->axes[0] && !definition->axes[1] &&
        !definition->axes[2])
        return shv_fail(error, SHV_BAD_INPUT, "choose at least one axis that it holds");
    return check_selection(&definition->selection, error);
}

static ShvStatus make_nodes(ShvImposedCondition *condition, const ShvModel *model, const ShvObject *object,
                            ShvError *error)
{
    return shv_selection_nodes(&condition->definition->selection, model, object, &condition->origins,
                               &condition->origin_count, error);
}

static ShvStatus make_facets(ShvImposedCondition *condition, const ShvModel *model, const ShvObject *object,
                             ShvError *error)
{
    const ShvConditionDefinition *definition = condition->definition;
    SHV_TRY(shv_selection_facets(&definition->selection, model, object, shv_load3(definition->value),
                                 &condition->facets, &condition->facet_count, error));
    if (condition->facet_count == 0)
        return shv_fail(error, SHV_BAD_INPUT,
                        "its selection contains no boundary facet of object %s (all three nodes "
                        "must be chosen): move the box or plane, or give a larger tolerance",
                        object->name);
    return SHV_OK;
}

static ShvStatus make_condition(ShvImposedCondition *condition, const ShvModel *model, ShvError *error)
{
    const ShvConditionDefinition *definition = condition->definition;
    SHV_TRY(check_condition(definition, error));
    const ShvObject *object = find_object(model, definition->object);
    if (!object)
        return shv_fail(error, SHV_BAD_INPUT, "there is no object named '%s'",
                        definition->object ? definition->object : "");
    return definition->kind == SHV_CONDITION_TRACTION ? make_facets(condition, model, object, error)
                                                      : make_nodes(condition, model, object, error);
}

static bool is_over(const ShvImposedCondition *condition, double time)
{
    return condition->released || time >= condition->definition->end;
}

static int32_t count_over(const ShvImposed *imposed, double time)
{
    int32_t count = 0;
    for (int32_t i = 0; i < imposed->count; i++) count += is_over(&imposed->items[i], time);
    return count;
}

/* How conditions that are not over act on a node of the reference mesh. */
enum { BY_NODES = 1, BY_FACETS = 2 };

static void mark_held(ShvImposed *imposed, double time)
{
    const ShvMesh *mesh = &imposed->model->mesh;
    imposed->over_count = count_over(imposed, time);
    memset(imposed->held, 0, (size_t)mesh->node_count);
    for (int32_t i = 0; i < imposed->count; i++) {
        const ShvImposedCondition *condition = &imposed->items[i];
        if (is_over(condition, time)) continue;
        for (int32_t k = 0; k < condition->origin_count; k++) imposed->held[condition->origins[k]] |= BY_NODES;
        for (int32_t k = 0; k < condition->facet_count; k++) {
            const int32_t *corners = mesh->elements + 4 * (int64_t)condition->facets[k].element;
            for (int c = 0; c < 3; c++)
                imposed->held[corners[shv_face_corners[condition->facets[k].face][c]]] |= BY_FACETS;
        }
    }
}

static ShvStatus make_all(ShvImposed *imposed, const ShvModel *model, const ShvSceneDefinition *scene, ShvError *error)
{
    const size_t count = (size_t)scene->condition_count;
    const size_t nodes = count > 0 ? (size_t)model->mesh.node_count : 0;
    imposed->items = shv_allocate(imposed->memory, SHV_PART_CONTACT, count, sizeof *imposed->items);
    imposed->held = shv_allocate(imposed->memory, SHV_PART_CONTACT, nodes, sizeof *imposed->held);
    if (!imposed->items || !imposed->held)
        return shv_fail_memory(error, "the conditions", count * sizeof *imposed->items + nodes);
    for (int32_t i = 0; i < scene->condition_count; i++) {
        const ShvConditionDefinition *definition = &scene->conditions[i];
        imposed->count = i + 1;
        imposed->items[i].definition = definition;
        const ShvStatus status = make_condition(&imposed->items[i], model, error);
        if (status != SHV_OK)
            return shv_fail_within(error, status, "condition %s",
                                   definition->name ? definition->name : "without a name");
    }
    if (count > 0) mark_held(imposed, -HUGE_VAL);
    return SHV_OK;
}

ShvStatus shv_imposed_create(ShvImposed *imposed, const ShvModel *model, const ShvSceneDefinition *scene,
                             ShvError *error)
{
    *imposed = (ShvImposed){.memory = model->memory, .model = model};
    const ShvStatus status = make_all(imposed, model, scene, error);
    if (status != SHV_OK) shv_imposed_release(imposed);
    return status;
}

void shv_imposed_release(ShvImposed *imposed)
{
    for (int32_t i = 0; i < imposed->count; i++) {
        shv_release(imposed->items[i].origins);
        shv_release(imposed->items[i].nodes);
        shv_release(imposed->items[i].before);
        shv_release(imposed->items[i].impulse);
        shv_release(imposed->items[i].facets);
    }
    shv_release(imposed->items);
    shv_release(imposed->held);
    *imposed = (ShvImposed){0};
}

bool shv_imposed_release_condition(ShvImposed *imposed, const char *name)
{
    bool found = false;
    for (int32_t i = 0; i < imposed->count; i++) {
        const char *own = imposed->items[i].definition->name;
        if (!own || strcmp(own, name) != 0) continue;
        imposed->items[i].released = true;
        found = true;
    }
    return found;
}

bool shv_imposed_in_force(const ShvImposedCondition *condition, double time)
{
    return !is_over(condition, time) && time >= condition->definition->start;
}

static bool is_chosen(const ShvImposedCondition *condition, int32_t origin)
{
    return shv_sorted_contains(condition->origins, condition->origin_count, origin);
}

/* Whether it holds a node of the state; one that has not been looked at yet, as its origin. */
static bool has_node(const ShvImposed *imposed, const ShvImposedCondition *condition, const ShvState *state,
                     int32_t node)
{
    if (node >= imposed->known_nodes) return is_chosen(condition, state->origin[node]);
    return shv_sorted_contains(condition->nodes, condition->node_count, node);
}

static bool is_held(const ShvImposed *imposed, const ShvState *state, int32_t node)
{
    const uint8_t held = imposed->held[state->origin[node]];
    bool found = held & BY_FACETS;
    for (int32_t i = 0; i < imposed->count && held && !found; i++)
        found = !is_over(&imposed->items[i], state->time) && has_node(imposed, &imposed->items[i], state, node);
    return found;
}

bool shv_imposed_holds(const ShvImposed *imposed, const ShvState *state, const int32_t *nodes, int32_t count)
{
    bool holds = false;
    for (int32_t k = 0; k < count && !holds && imposed->over_count < imposed->count; k++)
        holds = is_held(imposed, state, nodes[k]);
    return holds;
}

/* Supports along one axis: how many nodes they hold, and Σ r with r = x × axis: a rotation ω moves a node at x along the axis by ω · r. */
typedef struct Holds {
    int32_t count;
    ShvVec3 sum;
} Holds;

static void add_product(ShvMat3 *sum, ShvVec3 a, ShvVec3 b)
{
    const double x[3] = {a.x, a.y, a.z}, y[3] = {b.x, b.y, b.z};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) sum->m[i][j] += x[i] * y[j];
}

static void add_holds(const ShvImposedCondition *condition, const ShvState *state, ShvVec3 from, int32_t node,
                      Holds holds[3], ShvMat3 *square)
{
    const ShvVec3 axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int axis = 0; axis < 3; axis++) {
        if (!condition->definition->axes[axis]) continue;
        const ShvVec3 r = shv_cross(shv_sub(shv_state_position(state, node), from), axes[axis]);
        holds[axis].count++;
        holds[axis].sum = shv_add(holds[axis].sum, r);
        add_product(square, r, r);
    }
}

/* Of the largest eigenvalue of what holds against rotation: below, an axis is left to turn about; of a force, or its moment about the
   supports: below, it is rounding. */
static const double least_hold = 1e-8, rounding = 1e-9;

/* Whether translations, of which those along held axes are free to make the least of a rotation, and rotations bear a wrench: that its
   moment, less what held nodes bear at their mean r, is in the range of the matrix, and no force is along an axis without supports. */
static bool bears(const Holds holds[3], const ShvMat3 *square, ShvVec3 force, ShvVec3 arm)
{
    const double forces[3] = {force.x, force.y, force.z}, size = shv_norm(force);
    ShvVec3 moment = shv_cross(arm, force);
    for (int axis = 0; axis < 3; axis++) {
        if (holds[axis].count == 0 && fabs(forces[axis]) > rounding * size) return false;
        if (holds[axis].count > 0) moment = shv_madd(moment, -forces[axis] / holds[axis].count, holds[axis].sum);
    }
    const ShvMat3 inverse = shv_symmetric_pseudo_inverse(square, least_hold);
    const ShvVec3 borne = shv_apply(square, shv_apply(&inverse, moment));
    return shv_norm(shv_sub(moment, borne)) <= rounding * size * shv_norm(arm);
}

/* Σ r rᵀ about the mean r of each axis: its quadratic form is the sum of squares of held displacements in a rotation together with the
   translation that makes it least. */
ShvRestraint shv_imposed_restraint(const ShvImposed *imposed, const ShvState *state, const int32_t *nodes,
                                   int32_t count, ShvVec3 force, ShvVec3 point)
{
    Holds holds[3] = {{0}};
    ShvMat3 square = {{{0.0}}};
    const ShvVec3 from = shv_state_position(state, nodes[0]);
    for (int32_t k = 0; k < count; k++)
        for (int32_t i = 0; i < imposed->count && imposed->held[state->origin[nodes[k]]]; i++)
            if (imposed->items[i].definition->kind == SHV_CONDITION_SUPPORT &&
                shv_imposed_in_force(&imposed->items[i], state->time) &&
                has_node(imposed, &imposed->items[i], state, nodes[k]))
                add_holds(&imposed->items[i], state, from, nodes[k], holds, &square);
    bool everywhere = true;
    for (int axis = 0; axis < 3; axis++) {
        everywhere = everywhere && holds[axis].count > 0;
        if (holds[axis].count > 0)
            add_product(&square, shv_scale(holds[axis].sum, -1.0 / holds[axis].count), holds[axis].sum);
    }
    double values[3];
    shv_symmetric_eigen(&square, values, NULL);
    if (everywhere && values[0] > least_hold * values[2]) return SHV_FULLY_RESTRAINED;
    return bears(holds, &square, force, shv_sub(point, from)) ? SHV_IN_EQUILIBRIUM : SHV_UNRESTRAINED;
}

/* ---- a step ---- */

static ShvStatus reserve(ShvImposedCondition *condition, ShvMemory *memory, ShvError *error)
{
    if (condition->node_count < condition->node_capacity) return SHV_OK;
    const size_t capacity = 2 * (size_t)condition->node_capacity + (size_t)condition->origin_count;
    int32_t *nodes = shv_reallocate(memory, SHV_PART_CONTACT, condition->nodes, capacity, sizeof(int32_t));
    if (nodes) condition->nodes = nodes;
    double *before = shv_reallocate(memory, SHV_PART_CONTACT, condition->before, 3 * capacity, sizeof(double));
    if (before) condition->before = before;
    double *impulse = shv_reallocate(memory, SHV_PART_CONTACT, condition->impulse, 3 * capacity, sizeof(double));
    if (impulse) condition->impulse = impulse;
    if (!nodes || !before || !impulse) return shv_fail_memory(error, "the nodes of a condition", capacity * 52);
    condition->node_capacity = (int32_t)capacity;
    return SHV_OK;
}

/* Whether a face at a corner of a tet has all its nodes chosen. */
static bool has_chosen_face(const ShvImposedCondition *condition, const int32_t *corners_of_tet, int32_t corner)
{
    bool found = false;
    for (int face = 0; face < 4 && !found; face++) {
        bool all = face != corner; /* which is opposite to the corner of its number */
        for (int c = 0; c < 3 && all; c++) all = is_chosen(condition, corners_of_tet[shv_face_corners[face][c]]);
        found = all;
    }
    return found;
}

static bool any_has_chosen_face(const ShvImposed *imposed, const ShvImposedCondition *condition, const int32_t *corners,
                                int32_t count)
{
    bool found = false;
    for (int32_t k = 0; k < count && !found; k++)
        found =
            has_chosen_face(condition, imposed->model->mesh.elements + 4 * (int64_t)(corners[k] / 4), corners[k] % 4);
    return found;
}

static bool holds_faces(const ShvImposed *imposed, const ShvImposedCondition *condition)
{
    const ShvAdjacency *adjacency = &imposed->model->adjacency;
    bool found = false;
    for (int32_t k = 0; k < condition->origin_count && !found; k++) {
        const int32_t origin = condition->origins[k], begin = adjacency->corner_start[origin];
        found = any_has_chosen_face(imposed, condition, adjacency->corners + begin,
                                    adjacency->corner_start[origin + 1] - begin);
    }
    return found;
}

static void remove_node(ShvImposedCondition *condition, int32_t node)
{
    int32_t kept = 0;
    for (int32_t k = 0; k < condition->node_count; k++)
        if (condition->nodes[k] != node) condition->nodes[kept++] = condition->nodes[k];
    condition->node_count = kept;
}

/* Nothing passes through a node or an edge alone, as between fragments. */
void shv_imposed_release_nodes(ShvImposed *imposed, const ShvState *state, const int32_t *nodes, int32_t count)
{
    for (int32_t i = 0; i < imposed->count; i++) {
        ShvImposedCondition *condition = &imposed->items[i];
        if (condition->definition->kind != SHV_CONDITION_SUPPORT || !holds_faces(imposed, condition)) continue;
        for (int32_t k = 0; k < count; k++)
            if (shv_sorted_contains(condition->nodes, condition->node_count, nodes[k]) &&
                !any_has_chosen_face(imposed, condition, state->corners + state->corner_start[nodes[k]],
                                     state->corner_count[nodes[k]]))
                remove_node(condition, nodes[k]);
    }
}

static ShvStatus adopt_nodes(ShvImposed *imposed, const ShvState *state, ShvError *error)
{
    for (int32_t node = imposed->known_nodes; node < state->node_count; node++) {
        for (int32_t i = 0; i < imposed->count; i++) {
            ShvImposedCondition *condition = &imposed->items[i];
            if (!is_chosen(condition, state->origin[node])) continue;
            SHV_TRY(reserve(condition, imposed->memory, error));
            condition->nodes[condition->node_count++] = node;
        }
        imposed->known_nodes = node + 1;
    }
    return SHV_OK;
}

/* Share of the value in force: value × min(1, (t − start)/ramp). */
static double ramp(const ShvConditionDefinition *definition, double time)
{
    if (!(definition->ramp_time > 0.0)) return 1.0;
    return fmax(0.0, fmin(1.0, (time - definition->start) / definition->ramp_time));
}

/* Σ force · velocity over the facets' corners; also adds the forces to state->force when `add`. */
static double pull(const ShvImposedCondition *condition, ShvState *state, bool add)
{
    const double share = ramp(condition->definition, state->time);
    double power = 0.0;
    for (int32_t k = 0; k < condition->facet_count; k++) {
        const ShvImposedFacet *facet = &condition->facets[k];
        const ShvVec3 force = shv_scale(facet->share, share);
        for (int corner = 0; corner < 3; corner++) {
            const int64_t i = 3 * (int64_t)shv_state_node(state, facet->element, shv_face_corners[facet->face][corner]);
            power += shv_dot(force, shv_load3(state->velocity + i));
            if (add) shv_add_to3(state->force + i, force);
        }
    }
    return power;
}

ShvStatus shv_imposed_add_force(ShvImposed *imposed, ShvState *state, ShvError *error)
{
    SHV_TRY(adopt_nodes(imposed, state, error));
    if (count_over(imposed, state->time) != imposed->over_count) mark_held(imposed, state->time);
    for (int32_t c = 0; c < imposed->count; c++) {
        ShvImposedCondition *condition = &imposed->items[c];
        if (!shv_imposed_in_force(condition, state->time)) continue;
        for (int32_t k = 0; k < condition->node_count; k++)
            shv_store3(condition->before + 3 * (int64_t)k,
                       shv_load3(state->velocity + 3 * (int64_t)condition->nodes[k]));
        condition->power = pull(condition, state, true);
    }
    return SHV_OK;
}

/* Sets held components; remembers the impulses it took. */
static void hold(ShvImposedCondition *condition, ShvState *state, double step)
{
    const ShvConditionDefinition *definition = condition->definition;
    const double share = ramp(definition, state->time + 0.5 * step);
    for (int32_t k = 0; k < condition->node_count; k++) {
        const int32_t node = condition->nodes[k];
        double *velocity = state->velocity + 3 * (int64_t)node, *impulse = condition->impulse + 3 * (int64_t)k;
        for (int axis = 0; axis < 3; axis++) {
            impulse[axis] = 0.0;
            if (!definition->axes[axis]) continue;
            const double wanted = definition->kind == SHV_CONDITION_SUPPORT ? 0.0 : share * definition->value[axis];
            impulse[axis] = state->mass[node] * (wanted - velocity[axis]);
            velocity[axis] = wanted;
        }
    }
}

static void book_constraint(ShvImposed *imposed, const ShvImposedCondition *condition, const ShvState *state)
{
    for (int32_t k = 0; k < condition->node_count; k++) {
        const ShvVec3 impulse = shv_load3(condition->impulse + 3 * (int64_t)k);
        const ShvVec3 before = shv_load3(condition->before + 3 * (int64_t)k);
        const ShvVec3 after = shv_load3(state->velocity + 3 * (int64_t)condition->nodes[k]);
        imposed->constraint_work[0] += 0.5 * shv_dot(impulse, before);
        imposed->constraint_work[1] += 0.5 * shv_dot(impulse, after);
    }
}

void shv_imposed_apply(ShvImposed *imposed, ShvState *state, double before, double step)
{
    for (int32_t c = 0; c < imposed->count; c++)
        if (shv_imposed_in_force(&imposed->items[c], state->time)) hold(&imposed->items[c], state, step);
    /* With the velocities after all conditions: a node may be under several. */
    shv_imposed_book(imposed, state, before, step);
}

void shv_imposed_book(ShvImposed *imposed, ShvState *state, double before, double step)
{
    for (int half = 0; half < 2; half++) imposed->constraint_work[half] = imposed->traction_work[half] = 0.0;
    for (int32_t c = 0; c < imposed->count; c++) {
        const ShvImposedCondition *condition = &imposed->items[c];
        if (!shv_imposed_in_force(condition, state->time)) continue;
        book_constraint(imposed, condition, state);
        imposed->traction_work[0] += 0.5 * before * condition->power;
        imposed->traction_work[1] += 0.5 * step * pull(condition, state, false);
    }
}
