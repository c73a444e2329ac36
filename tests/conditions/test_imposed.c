#include "check.h"

#include "conditions/imposed.h"
#include "solid/motion.h"

/* A block of 0.2 × 0.1 × 0.1 m on nodes 0.05 m apart, centred on the origin, of a material without stiffness in these
   tests: no internal force is added. */
typedef struct Piece {
    ShvMaterialDefinition material;
    ShvObjectDefinition object;
    ShvSceneDefinition scene;
    ShvModel model;
    ShvState state;
    ShvError error;
} Piece;

static void piece_create(Piece *piece)
{
    *piece = (Piece){.material = shv_material_default(), .object = shv_object_default(), .scene = shv_scene_default()};
    piece->material.name = "glass";
    piece->material.density = 2500.0;
    piece->material.youngs_modulus = 70e9;
    piece->material.poissons_ratio = 0.22;
    piece->material.fracture_energy = 8.0;
    piece->material.cohesive_strength = 40e6;
    piece->object.name = "block";
    piece->object.material = "glass";
    piece->object.mesh.kind = SHV_MESH_BOX;
    piece->object.mesh.size[0] = 0.2;
    piece->object.mesh.size[1] = piece->object.mesh.size[2] = 0.1;
    piece->object.mesh.edge = 0.05;
    piece->scene.materials = &piece->material;
    piece->scene.material_count = 1;
    piece->scene.objects = &piece->object;
    piece->scene.object_count = 1;
    check_ok(shv_model_build(&piece->model, NULL, &piece->scene, NULL, &piece->error), piece->error);
    check_ok(shv_state_create(&piece->state, &piece->model, &piece->scene, &piece->error), piece->error);
}

static void piece_release(Piece *piece)
{
    shv_state_release(&piece->state);
    shv_model_release(&piece->model);
}

static ShvConditionDefinition condition_on_face(const char *name, ShvConditionKind kind, double x)
{
    ShvConditionDefinition definition = shv_condition_default();
    definition.name = name;
    definition.object = "block";
    definition.kind = kind;
    definition.axes[0] = definition.axes[1] = definition.axes[2] = true;
    definition.selection.kind = SHV_SELECT_PLANE;
    definition.selection.plane_normal[0] = 1.0;
    definition.selection.plane_offset = x;
    definition.selection.tolerance = 1e-9;
    return definition;
}

static void impose(Piece *piece, ShvImposed *imposed, const ShvConditionDefinition *conditions, int32_t count)
{
    piece->scene.conditions = conditions;
    piece->scene.condition_count = count;
    check_ok(shv_imposed_create(imposed, &piece->model, &piece->scene, &piece->error), piece->error);
}

static const double GRAVITY[3] = {0.0, 0.0, -10.0};

static void step(Piece *piece, ShvImposed *imposed, double h)
{
    ShvState *state = &piece->state;
    const double kick = 0.5 * (state->last_step + h);
    shv_motion_clear_force(state, NULL, 0, 1);
    check_ok(shv_imposed_add_force(imposed, state, &piece->error), piece->error);
    shv_motion_kick(state, NULL, state->node_count, kick, GRAVITY, 1);
    shv_imposed_apply(imposed, state, state->last_step, h);
    shv_motion_drift(state, NULL, state->node_count, h, 1);
    state->time += h;
    state->last_step = h;
}

/* ---- selections ---- */

static void test_selections(void **state)
{
    (void)state;
    Piece piece;
    piece_create(&piece);
    ShvConditionDefinition conditions[4] = {
        condition_on_face("face", SHV_CONDITION_SUPPORT, 0.1), condition_on_face("all", SHV_CONDITION_SUPPORT, 0.0),
        condition_on_face("part", SHV_CONDITION_SUPPORT, 0.0), condition_on_face("pull", SHV_CONDITION_TRACTION, 0.1)};
    conditions[1].selection.kind = SHV_SELECT_ALL;
    conditions[2].selection.kind = SHV_SELECT_BOX;
    for (int k = 0; k < 3; k++) {
        conditions[2].selection.box_min[k] = -0.2;
        conditions[2].selection.box_max[k] = 0.0;
    }
    conditions[3].value[0] = 5e6;
    ShvImposed imposed;
    impose(&piece, &imposed, conditions, 4);
    int32_t expected[3] = {0, 0, 0};
    for (int32_t i = 0; i < piece.state.node_count; i++) {
        const ShvVec3 x = shv_state_position(&piece.state, i);
        expected[0] += fabs(x.x - 0.1) < 1e-6;
        expected[1]++;
        expected[2] += x.x < 1e-8 && x.y < 1e-8 && x.z < 1e-8;
    }
    assert_true(expected[0] >= 9);
    for (int k = 0; k < 3; k++) assert_int_equal(imposed.items[k].origin_count, expected[k]);
    /* The whole end face is pulled: its area is 0.01 m², and no interior face counts. */
    ShvVec3 total = {0.0, 0.0, 0.0};
    for (int32_t k = 0; k < imposed.items[3].facet_count; k++)
        total = shv_madd(total, 3.0, imposed.items[3].facets[k].share);
    check_near(total.x, 5e6 * 0.01, 1e-9 * 5e4);
    check_near(total.y, 0.0, 0.0);
    shv_imposed_release(&imposed);
    piece_release(&piece);
}

/* A traction on every boundary facet: interior faces of the same nodes are told apart. */
static void test_traction_on_all(void **state)
{
    (void)state;
    Piece piece;
    piece_create(&piece);
    ShvConditionDefinition condition = condition_on_face("wind", SHV_CONDITION_TRACTION, 0.0);
    condition.selection.kind = SHV_SELECT_ALL;
    condition.value[1] = 100.0;
    ShvImposed imposed;
    impose(&piece, &imposed, &condition, 1);
    double total = 0.0;
    for (int32_t k = 0; k < imposed.items[0].facet_count; k++) total += 3.0 * imposed.items[0].facets[k].share.y;
    check_near(total, 100.0 * (2.0 * 0.01 + 4.0 * 0.02), 1e-11);
    shv_imposed_release(&imposed);
    piece_release(&piece);
}

static void check_refused(Piece *piece, const ShvConditionDefinition *condition, const char *part)
{
    ShvImposed imposed;
    piece->scene.conditions = condition;
    piece->scene.condition_count = 1;
    check_fails(shv_imposed_create(&imposed, &piece->model, &piece->scene, &piece->error), SHV_BAD_INPUT, piece->error,
                part);
    if (condition->name) assert_non_null(strstr(piece->error.message, condition->name));
}

static void test_refusals(void **state)
{
    (void)state;
    Piece piece;
    piece_create(&piece);
    ShvConditionDefinition wrong = condition_on_face("clamp", SHV_CONDITION_SUPPORT, 0.3);
    check_refused(&piece, &wrong, "no node of object block, of which the nearest, (0.1, ");
    check_refused(&piece, &wrong, "lies 0.2 m outside");
    wrong = condition_on_face("pull", SHV_CONDITION_TRACTION, 0.3);
    check_refused(&piece, &wrong, "no boundary facet of object block");
    /* Nodes of the mid plane are chosen, but no boundary facet lies in it. */
    wrong = condition_on_face("pull", SHV_CONDITION_TRACTION, 0.0);
    check_refused(&piece, &wrong, "no boundary facet");
    wrong = condition_on_face("clamp", SHV_CONDITION_SUPPORT, 0.1);
    wrong.object = "brick";
    check_refused(&piece, &wrong, "no object named 'brick'");
    wrong = condition_on_face("clamp", SHV_CONDITION_SUPPORT, 0.1);
    wrong.axes[0] = wrong.axes[1] = wrong.axes[2] = false;
    check_refused(&piece, &wrong, "axis");
    wrong = condition_on_face("push", SHV_CONDITION_VELOCITY, 0.1);
    wrong.value[1] = (double)NAN;
    check_refused(&piece, &wrong, "finite");
    wrong.value[1] = 0.0;
    wrong.ramp_time = -1.0;
    check_refused(&piece, &wrong, "ramp_time");
    wrong.ramp_time = 0.0;
    wrong.end = wrong.start;
    check_refused(&piece, &wrong, "after it starts");
    wrong = condition_on_face("clamp", SHV_CONDITION_SUPPORT, 0.1);
    wrong.selection.plane_normal[0] = 0.0;
    check_refused(&piece, &wrong, "normal");
    wrong = condition_on_face("clamp", SHV_CONDITION_SUPPORT, 0.1);
    wrong.selection.tolerance = -1.0;
    check_refused(&piece, &wrong, "tolerance");
    wrong = (ShvConditionDefinition){.name = "zeroed"};
    check_refused(&piece, &wrong, "shv_condition_default");
    piece_release(&piece);
}

/* ---- steps ---- */

/* A support holds its nodes against gravity; its impulses are their weight, it does no work, and after its end or its
   release they fall. */
static void test_support(void **state)
{
    (void)state;
    for (int released = 0; released < 2; released++) {
        Piece piece;
        piece_create(&piece);
        ShvConditionDefinition clamp = condition_on_face("clamp", SHV_CONDITION_SUPPORT, 0.1);
        const double h = 1e-3;
        if (!released) clamp.end = 10.5 * h;
        ShvImposed imposed;
        impose(&piece, &imposed, &clamp, 1);
        const int32_t chosen = imposed.items[0].origins[0];
        int32_t other = 0;
        while (imposed.held[other]) other++;
        assert_true(shv_imposed_holds(&imposed, &piece.state, &chosen, 1));
        assert_false(shv_imposed_holds(&imposed, &piece.state, &other, 1));
        for (int k = 0; k < 11; k++) {
            step(&piece, &imposed, h);
            check_near(imposed.constraint_work[0] + imposed.constraint_work[1], 0.0, 0.0);
        }
        const int32_t held = imposed.items[0].nodes[0];
        check_near(imposed.items[0].impulse[2], piece.state.mass[held] * 10.0 * h, 1e-15);
        check_near(piece.state.displacement[3 * held + 2], 0.0, 0.0);
        if (released) {
            assert_true(shv_imposed_release_condition(&imposed, "clamp"));
            assert_false(shv_imposed_release_condition(&imposed, "lamp"));
        }
        for (int k = 0; k < 5; k++) step(&piece, &imposed, h);
        assert_false(shv_imposed_holds(&imposed, &piece.state, &chosen, 1));
        check_near(piece.state.velocity[3 * held + 2], -10.0 * 5.0 * h, 1e-15);
        shv_imposed_release(&imposed);
        piece_release(&piece);
    }
}

/* An imposed velocity with a ramp: half-step velocities lie on the ramp at the half steps, free components are free, and
   the work is the energy of the held components. */
static void test_velocity_ramp(void **state)
{
    (void)state;
    Piece piece;
    piece_create(&piece);
    ShvConditionDefinition push = condition_on_face("push", SHV_CONDITION_VELOCITY, -0.1);
    push.axes[1] = push.axes[2] = false;
    push.value[0] = 4.0;
    push.ramp_time = 0.01;
    push.start = 0.002;
    ShvImposed imposed;
    impose(&piece, &imposed, &push, 1);
    const double h = 1e-3;
    double work = 0.0, mass = 0.0;
    for (int k = 0; k < 20; k++) {
        step(&piece, &imposed, h);
        const int32_t node = k >= 2 ? imposed.items[0].nodes[0] : 0;
        const double middle = (k + 0.5) * h;
        const double expected = k >= 2 ? 4.0 * fmin(1.0, (middle - 0.002) / 0.01) : 0.0;
        check_near(piece.state.velocity[3 * node], expected, 1e-14);
        check_near(piece.state.velocity[3 * node + 2], -10.0 * middle, 1e-14);
        if (k < 2) continue;
        work += imposed.constraint_work[0] + imposed.constraint_work[1];
    }
    for (int32_t k = 0; k < imposed.items[0].node_count; k++) mass += piece.state.mass[imposed.items[0].nodes[k]];
    check_near(work, 0.5 * mass * 16.0, 1e-12 * mass * 8.0);
    shv_imposed_release(&imposed);
    piece_release(&piece);
}

/* Tractions pull the block's nodes: momentum is force × time, and the booked works are F · the way of the nodes. */
static void test_traction(void **state)
{
    (void)state;
    Piece piece;
    piece_create(&piece);
    ShvConditionDefinition pull = condition_on_face("pull", SHV_CONDITION_TRACTION, 0.1);
    pull.value[1] = 1e3;
    ShvImposed imposed;
    impose(&piece, &imposed, &pull, 1);
    const double h = 1e-3;
    double booked = 0.0, way = 0.0, momentum = 0.0;
    for (int k = 0; k < 50; k++) {
        /* Works of time n: half a step before it and half a step after it. The second half of the last is pending. */
        step(&piece, &imposed, h);
        booked += imposed.traction_work[0] + imposed.traction_work[1];
    }
    for (int32_t k = 0; k < imposed.items[0].facet_count; k++) {
        const ShvImposedFacet *facet = &imposed.items[0].facets[k];
        for (int corner = 0; corner < 3; corner++) {
            const int32_t node = shv_state_node(&piece.state, facet->element, shv_face_corners[facet->face][corner]);
            const ShvVec3 half = shv_scale(shv_load3(piece.state.velocity + 3 * node), 0.5 * h);
            way += shv_dot(facet->share, shv_sub(shv_load3(piece.state.displacement + 3 * node), half));
        }
    }
    check_near(booked, way, 1e-12 * way);
    for (int32_t i = 0; i < piece.state.node_count; i++)
        momentum += piece.state.mass[i] * piece.state.velocity[3 * i + 1];
    check_near(momentum, 1e3 * 0.01 * 49.5 * h, 1e-12);
    shv_imposed_release(&imposed);
    piece_release(&piece);
}

/* The corner of one tet leaves a node and has one of its own. */
static int32_t split_off(Piece *piece, int32_t element, int32_t corner)
{
    ShvState *s = &piece->state;
    const int32_t old = shv_state_node(s, element, corner), copy = s->node_count;
    check_ok(shv_state_reserve(s, copy + 1, &piece->error), piece->error);
    s->node_count = copy + 1;
    s->connectivity[shv_corner_slot(element, corner)] = copy;
    s->origin[copy] = s->origin[old];
    s->mass[copy] = 0.5 * s->mass[old];
    s->mass[old] *= 0.5;
    shv_store3(s->reference + 3 * copy, shv_load3(s->reference + 3 * old));
    shv_store3(s->displacement + 3 * copy, shv_load3(s->displacement + 3 * old));
    shv_store3(s->velocity + 3 * copy, shv_load3(s->velocity + 3 * old));
    int32_t *corners = s->corners + s->corner_start[old], kept = 0;
    for (int32_t k = 0; k < s->corner_count[old]; k++)
        if (corners[k] != 4 * element + corner) corners[kept++] = corners[k];
    assert_int_equal(kept, s->corner_count[old] - 1);
    corners[kept] = 4 * element + corner;
    s->corner_count[old] = kept;
    s->corner_start[copy] = s->corner_start[old] + kept;
    s->corner_count[copy] = 1;
    return copy;
}

/* A node of the held and pulled face is split by hand: the copy is held too, and the traction goes to the copy that owns the
   element. */
static void test_follows_duplication(void **state)
{
    (void)state;
    Piece piece;
    piece_create(&piece);
    ShvConditionDefinition conditions[2] = {condition_on_face("pull", SHV_CONDITION_TRACTION, 0.1),
                                            condition_on_face("guide", SHV_CONDITION_SUPPORT, 0.1)};
    conditions[0].value[1] = 1e3;
    conditions[1].axes[1] = conditions[1].axes[2] = false;
    ShvImposed imposed;
    impose(&piece, &imposed, conditions, 2);
    ShvState *s = &piece.state;
    step(&piece, &imposed, 1e-3);
    const ShvImposedFacet *facet = &imposed.items[0].facets[0];
    const int32_t copy = split_off(&piece, facet->element, shv_face_corners[facet->face][0]);
    double before = 0.0, after = 0.0;
    for (int32_t i = 0; i < copy; i++) before += s->force[3 * i + 1];
    step(&piece, &imposed, 1e-3);
    for (int32_t i = 0; i <= copy; i++) after += s->force[3 * i + 1];
    check_near(after, before, 1e-12);
    check_near(s->force[3 * copy + 1], facet->share.y, 0.0);
    check_near(s->velocity[3 * copy], 0.0, 0.0);
    s->velocity[3 * copy] = 7.0;
    step(&piece, &imposed, 1e-3);
    check_near(s->velocity[3 * copy], 0.0, 0.0);
    shv_imposed_release(&imposed);
    piece_release(&piece);
}

/* A tet that has but one node on the support, and the corner that it has there. */
static void find_hanging(const Piece *piece, double x, int32_t *element, int32_t *corner)
{
    const ShvState *s = &piece->state;
    int on = 0;
    for (*element = 0; *element < s->element_count; ++*element) {
        on = 0;
        for (int c = 0; c < 4; c++) {
            const bool at = fabs(s->reference[3 * shv_state_node(s, *element, c)] - x) < 1e-9;
            if (at) *corner = c;
            on += at;
        }
        if (on == 1) return;
    }
    fail_msg("no tet hangs by a node");
}

/* What hangs from a face of supports by a node alone is held until it is let go; from a line of them it is not let go, for there is
   nothing else to hold it by. */
static void test_holds_by_faces(void **state)
{
    (void)state;
    for (int line = 0; line < 2; line++) {
        Piece piece;
        piece_create(&piece);
        int32_t element = 0, corner = 0;
        find_hanging(&piece, 0.1, &element, &corner);
        const int32_t old = shv_state_node(&piece.state, element, corner);
        ShvConditionDefinition condition = condition_on_face("wall", SHV_CONDITION_SUPPORT, 0.1);
        if (line) {
            condition.selection.kind = SHV_SELECT_BOX;
            for (int k = 0; k < 3; k++) {
                condition.selection.box_min[k] = piece.state.reference[3 * old + k] - 1e-9;
                condition.selection.box_max[k] = piece.state.reference[3 * old + k] + 1e-9;
            }
        }
        ShvImposed imposed;
        impose(&piece, &imposed, &condition, 1);
        step(&piece, &imposed, 1e-3);
        const int32_t copy = split_off(&piece, element, corner);
        piece.state.velocity[3 * copy] = 7.0;
        step(&piece, &imposed, 1e-3);
        check_near(piece.state.velocity[3 * copy], 0.0, 0.0);
        const int32_t both[] = {old, copy};
        shv_imposed_release_nodes(&imposed, &piece.state, both, 2);
        piece.state.velocity[3 * copy] = piece.state.velocity[3 * old] = 7.0;
        step(&piece, &imposed, 1e-3);
        check_near(piece.state.velocity[3 * copy], line ? 0.0 : 7.0, 0.0);
        check_near(piece.state.velocity[3 * old], 0.0, 0.0);
        assert_int_equal(shv_imposed_holds(&imposed, &piece.state, &copy, 1), line == 1);
        assert_true(shv_imposed_holds(&imposed, &piece.state, &old, 1));
        shv_imposed_release(&imposed);
        piece_release(&piece);
    }
}

static void test_allocation_failures(void **state)
{
    (void)state;
    Piece piece;
    piece_create(&piece);
    const ShvConditionDefinition conditions[2] = {condition_on_face("pull", SHV_CONDITION_TRACTION, 0.1),
                                                  condition_on_face("guide", SHV_CONDITION_SUPPORT, 0.1)};
    piece.scene.conditions = conditions;
    piece.scene.condition_count = 2;
    ShvStatus status = SHV_NO_MEMORY;
    for (int64_t allowed = 0; status != SHV_OK; allowed++) {
        ShvMemory *memory = shv_memory_create();
        ShvModel model = piece.model;
        model.memory = memory;
        shv_memory_fail_after(memory, allowed);
        ShvImposed imposed;
        status = shv_imposed_create(&imposed, &model, &piece.scene, &piece.error);
        if (status == SHV_OK) {
            status = shv_imposed_add_force(&imposed, &piece.state, &piece.error);
            shv_imposed_release(&imposed);
        }
        if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
        if (status == SHV_OK) assert_in_range(allowed, 6, 20);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
    }
    piece_release(&piece);
}

/* How supports hold the block under a force at its centre. */
static ShvRestraint hold(Piece *piece, const ShvConditionDefinition *conditions, int32_t count, ShvVec3 force)
{
    ShvImposed imposed;
    int32_t nodes[1024];
    assert_true(piece->state.node_count <= 1024);
    for (int32_t i = 0; i < piece->state.node_count; i++) nodes[i] = i;
    impose(piece, &imposed, conditions, count);
    const ShvRestraint result =
        shv_imposed_restraint(&imposed, &piece->state, nodes, piece->state.node_count, force, shv_vec3(0.0, 0.0, 0.0));
    shv_imposed_release(&imposed);
    return result;
}

static ShvConditionDefinition in_box(const char *name, ShvVec3 low, ShvVec3 high, bool x, bool y, bool z)
{
    ShvConditionDefinition definition = condition_on_face(name, SHV_CONDITION_SUPPORT, 0.0);
    definition.selection.kind = SHV_SELECT_BOX;
    shv_store3(definition.selection.box_min, low);
    shv_store3(definition.selection.box_max, high);
    definition.axes[0] = x;
    definition.axes[1] = y;
    definition.axes[2] = z;
    return definition;
}

static void supports_leave_no_motion_or_some(void **state)
{
    (void)state;
    Piece piece;
    piece_create(&piece);
    const ShvVec3 down = {0.0, 0.0, -1.0}, aside = {0.0, 1.0, -1.0};
    const ShvConditionDefinition face = condition_on_face("face", SHV_CONDITION_SUPPORT, -0.1);
    assert_int_equal(hold(&piece, &face, 1, aside), SHV_FULLY_RESTRAINED);
    const ShvConditionDefinition moved = condition_on_face("face", SHV_CONDITION_VELOCITY, -0.1);
    assert_int_equal(hold(&piece, &moved, 1, down), SHV_UNRESTRAINED);
    ShvConditionDefinition later = face;
    later.start = 1.0;
    assert_int_equal(hold(&piece, &later, 1, down), SHV_UNRESTRAINED);
    assert_int_equal(hold(&piece, NULL, 0, down), SHV_UNRESTRAINED);
    /* On ice, and on a slope of it. */
    const ShvVec3 low = {-0.11, -0.06, -0.06}, high = {0.11, 0.06, 0.06};
    const ShvConditionDefinition slides = in_box("slides", low, high, false, false, true);
    assert_int_equal(hold(&piece, &slides, 1, down), SHV_IN_EQUILIBRIUM);
    assert_int_equal(hold(&piece, &slides, 1, aside), SHV_UNRESTRAINED);
    /* On its lower edge at one end, along y: as a door, a shelf; and a shelf on a corner of the other end, and one pulled to the hinge there,
       which bears nothing. */
    const ShvConditionDefinition hinge = in_box("hinge", low, shv_vec3(-0.09, 0.06, -0.04), true, true, true);
    assert_int_equal(hold(&piece, &hinge, 1, down), SHV_UNRESTRAINED);
    assert_int_equal(hold(&piece, &hinge, 1, shv_vec3(-0.1, 0.0, -0.05)), SHV_IN_EQUILIBRIUM);
    const ShvVec3 corner_low = {0.09, -0.06, -0.06}, corner_high = {0.11, -0.04, -0.04};
    const ShvConditionDefinition shelf[2] = {hinge, in_box("corner", corner_low, corner_high, false, false, true)};
    assert_int_equal(hold(&piece, shelf, 2, down), SHV_FULLY_RESTRAINED);
    const ShvConditionDefinition pulled[2] = {hinge, in_box("corner", corner_low, corner_high, true, false, false)};
    assert_int_equal(hold(&piece, pulled, 2, down), SHV_UNRESTRAINED);
    /* On rollers at both ends: what bears it bears it there as well when it is turned upside down. */
    const ShvConditionDefinition ends[2] = {
        in_box("left", low, shv_vec3(-0.09, 0.06, -0.04), false, false, true),
        in_box("right", shv_vec3(0.09, -0.06, -0.06), shv_vec3(0.11, 0.06, -0.04), false, false, true)};
    assert_int_equal(hold(&piece, ends, 2, down), SHV_IN_EQUILIBRIUM);
    assert_int_equal(hold(&piece, ends, 1, down), SHV_UNRESTRAINED);
    piece_release(&piece);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_selections),
        cmocka_unit_test(test_traction_on_all),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_support),
        cmocka_unit_test(test_velocity_ramp),
        cmocka_unit_test(test_traction),
        cmocka_unit_test(test_follows_duplication),
        cmocka_unit_test(test_holds_by_faces),
        cmocka_unit_test(test_allocation_failures),
        cmocka_unit_test(supports_leave_no_motion_or_some),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
