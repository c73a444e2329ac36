/* Surfaces that meet where their edges cross, and no node is near. */
#include "surfaces.h"

#include "contact/inside.h"

#include "shape/triangle.h"

static const double edge = 0.008, thickness = 0.004; /* m */

/* ---- how deep edges are in the other body ---- */

/* From a point to the surface of a fragment. */
static double distance_to_surface(const Surfaces *s, int32_t fragment, ShvVec3 x)
{
    double least = (double)INFINITY;
    for (int32_t f = 0; f < s->contact.list.facet_count; f++) {
        const ShvSurfaceFacet *facet = &s->contact.list.facets[f];
        if (facet->fragment != fragment) continue;
        const ShvFacetShape shape = shv_surface_facet_shape(&s->bodies, &s->contact.list, facet);
        least = fmin(least, shv_norm(shv_sub(x, shv_triangle_closest(x, shape.corners).point)));
    }
    return least;
}

/* Of points along the edges of one fragment's surface, the one deepest inside the other, m. */
static double depth_of_edges(const Surfaces *s, int32_t fragment, int32_t other)
{
    enum { POINTS = 50 };
    double deepest = 0.0;
    ShvBox box = shv_box_empty();
    for (int32_t k = 0; k < s->contact.list.node_count; k++) {
        const ShvSurfaceNode *node = &s->contact.list.nodes[k];
        if (node->fragment == other) shv_box_add(&box, shv_bodies_position(&s->bodies, node->node, other));
    }
    for (int32_t f = 0; f < s->contact.list.facet_count; f++) {
        const ShvSurfaceFacet *facet = &s->contact.list.facets[f];
        if (facet->fragment != fragment) continue;
        const ShvFacetShape shape = shv_surface_facet_shape(&s->bodies, &s->contact.list, facet);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i <= POINTS; i++) {
                const ShvVec3 a = shape.corners[k], b = shape.corners[(k + 1) % 3];
                const ShvVec3 x = shv_madd(a, (double)i / POINTS, shv_sub(b, a));
                if (shv_box_holds(&box, x) && is_inside(&s->bodies, other, x))
                    deepest = fmax(deepest, distance_to_surface(s, other, x));
            }
    }
    return deepest;
}

/* ---- plates ---- */

static double radians(double degrees)
{
    return degrees * 3.14159265358979 / 180.0;
}

typedef struct Crossing {
    double speed; /* m/s, towards each other */
    double glide; /* m/s, across that */
    double tilt;  /* degrees: of each plate about its edge; 0: narrow face meets narrow face */
    double turn;  /* degrees: between their edges */
    double share; /* of an edge: from a node to where they cross; 0: 0.4 */
    int32_t threads;
    bool coupled, unbreakable;
} Crossing;

static void set_rotation(ShvObjectDefinition *body, ShvQuat pose)
{
    const double sine = sqrt(fmax(0.0, 1.0 - pose.w * pose.w));
    shv_store3(body->placement.rotation_axis, sine > 0.0 ? shv_vec3(pose.x, pose.y, pose.z) : shv_vec3(0.0, 0.0, 1.0));
    body->placement.rotation_degrees = 2.0 * acos(fmin(1.0, pose.w)) * 180.0 / 3.14159265358979;
}

/* Tilted about its own edge, along x, and turned about z; its lowest or highest edge, or middle, at the origin. */
static void define_plate(Surfaces *s, const Crossing *crossing, int index)
{
    const double height = 0.016, way = index == 0 ? 1.0 : -1.0, gap = 1e-5; /* m */
    const double t = radians(crossing->tilt), turn = index * radians(crossing->turn);
    const ShvQuat pose =
        shv_quat_multiply(shv_quat_exponential(shv_vec3(0.0, 0.0, turn)), shv_quat_exponential(shv_vec3(t, 0.0, 0.0)));
    ShvObjectDefinition *plate = surfaces_box(s, 0.064, thickness, height, edge);
    const ShvVec3 ridge = {(crossing->share > 0.0 ? crossing->share : 0.4) * edge,
                           t > 0.0 ? -0.5 * way * thickness : 0.0, -0.5 * way * height};
    ShvVec3 centre = shv_scale(shv_rotate(pose, ridge), -1.0);
    centre.z += 0.5 * way * gap;
    surfaces_place(plate, centre, shv_vec3(0.5 * way * crossing->glide, 0.0, -0.5 * way * crossing->speed));
    set_rotation(plate, pose);
}

/* The upper plate may be a coupled body. */
static void define_plates(Surfaces *s, const Crossing *crossing)
{
    surfaces_define(s);
    s->scene.threads = crossing->threads > 0 ? crossing->threads : 1;
    s->material.density = 2400.0;
    s->material.youngs_modulus = 30e9;
    s->material.breakable = !crossing->unbreakable;
    for (int k = 0; k < 2; k++) define_plate(s, crossing, k);
    surfaces_build(s, 0.3, false);
    if (crossing->coupled)
        surfaces_make_coupled_body(s, 1, shv_load3(s->objects[1].placement.velocity), shv_vec3(0.0, 0.0, 0.0));
}

/* How deep edges of either are in the other, in edges. */
static double depth(const Surfaces *s)
{
    return fmax(depth_of_edges(s, 0, 1), depth_of_edges(s, 1, 0)) / edge;
}

/* Until they would have passed by an eighth of an edge; returns how deep they were on the way. */
static double run_plates(const Crossing *crossing)
{
    enum { LOOKS = 40 };
    Surfaces s;
    define_plates(&s, crossing);
    const double step = surfaces_stable_step(&s), duration = 0.125 * edge / crossing->speed;
    const Momentum start = surfaces_momentum(&s);
    const double energy = surfaces_kinetic(&s, s.state.velocity) + coupled_bodies_kinetic(&s);
    double deepest = 0.0;
    int touched = 0, looks = 0;
    while (s.state.time < duration) {
        surfaces_step(&s, step);
        touched += s.contact.touching > 0;
        check_momentum(&s, &start);
        /* Energy of a step differs by O(step²) from the conserved one. */
        if (!(s.energy < 1.005 * energy)) fail_msg("energy %g J of %g J", s.energy, energy);
        if (s.state.time < looks * duration / LOOKS) continue;
        deepest = fmax(deepest, depth(&s));
        looks++;
    }
    assert_true(touched > 0);
    assert_true(s.gain <= 1e-13 * energy);
    assert_true(s.unbooked <= 1e-12 * energy);
    surfaces_release(&s);
    return deepest;
}

static void check_plates(const Crossing *crossing)
{
    const double deepest = run_plates(crossing);
    if (!(deepest < 0.02))
        fail_msg("%g m/s, %g across, tilted by %g, turned by %g degrees: %g of an edge deep", crossing->speed,
                 crossing->glide, crossing->tilt, crossing->turn, deepest);
}

/* ---- edges that cross ---- */

static void test_speeds(void **state)
{
    (void)state;
    const double speeds[] = {1.0, 5.0, 20.0};
    for (int k = 0; k < 3; k++)
        for (int tilt = 0; tilt < 2; tilt++)
            check_plates(&(Crossing){.speed = speeds[k], .tilt = 45.0 * tilt, .turn = 90.0});
}

static void test_angles(void **state)
{
    (void)state;
    const double tilts[] = {0.0, 3.0, 20.0, 80.0}, turns[] = {90.0, 45.0, 10.0, 2.0};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) check_plates(&(Crossing){.speed = 5.0, .tilt = tilts[i], .turn = turns[k]});
}

/* Edges that glide across each other pass from edge to edge of the mesh while they come closer. */
static void test_shallow_approach(void **state)
{
    (void)state;
    for (int tilt = 0; tilt < 2; tilt++)
        for (int turn = 1; turn <= 2; turn++)
            check_plates(&(Crossing){.speed = 2.0, .glide = 20.0, .tilt = 30.0 * tilt, .turn = 45.0 * turn});
}

/* Next to a node of each, which is beside the other body still: a hundredth of an edge away, and half of that. */
static void test_next_to_nodes(void **state)
{
    (void)state;
    for (int k = 1; k <= 2; k++)
        assert_true(run_plates(&(Crossing){.speed = 1.0, .tilt = 45.0, .turn = 90.0, .share = 0.005 * k}) < 1e-3);
}

/* One of them rigid. */
static void test_coupled_bodies(void **state)
{
    (void)state;
    for (int tilt = 0; tilt < 2; tilt++)
        check_plates(&(Crossing){.speed = 5.0, .tilt = 30.0 * tilt, .turn = 60.0, .coupled = true});
}

/* Edges are found without adjacency, too. */
static void test_unbreakable(void **state)
{
    (void)state;
    check_plates(&(Crossing){.speed = 5.0, .tilt = 30.0, .turn = 90.0, .unbreakable = true});
}

/* ---- edges that do not meet ---- */

/* Pairs with an impulse: of edges, until a node has one. */
typedef struct Impulses {
    int edges, nodes;
} Impulses;

static Impulses count_impulses(Surfaces *s, double duration)
{
    const double step = surfaces_stable_step(s);
    Impulses sum = {0, 0};
    while (s->state.time < duration && sum.nodes == 0) {
        surfaces_step(s, step);
        for (int32_t k = 0; k < s->contact.pair_count; k++) {
            const ShvFacetPair *pair = &s->contact.pairs[k];
            sum.edges += pair->node_count > 1 && pair->normal_impulse > 0.0;
            sum.nodes += pair->node_count == 1 && pair->normal_impulse > 0.0;
        }
    }
    return sum;
}

/* Builds what was defined, and lets it pass without an impulse; `first` and `second` say which case it is. */
static void check_untouched(Surfaces *s, double duration, const char *name, double first, double second)
{
    surfaces_build(s, 0.3, false);
    const Impulses sum = count_impulses(s, duration);
    if (sum.edges > 0 || sum.nodes > 0)
        fail_msg("%s (%g, %g): impulses of %d edges and %d nodes", name, first, second, sum.edges, sum.nodes);
    surfaces_release(s);
}

/* Edges beside each other, parallel and not, that pass with a hundredth of an edge between them. */
static void test_edges_pass(void **state)
{
    (void)state;
    for (int turn = 0; turn < 3; turn++) {
        Surfaces s;
        surfaces_define(&s);
        surfaces_place(surfaces_box(&s, 0.02, 0.02, 0.02, 0.01), shv_vec3(0.0, 0.0, 0.0202), shv_vec3(0.0, 0.0, -5.0));
        ShvObjectDefinition *other = surfaces_box(&s, 0.02, 0.02, 0.02, 0.01);
        const double angle = radians(45.0 * turn); /* the other's corner, or side, is beside the first one's side */
        surfaces_place(other,
                       shv_vec3(0.0101 + 0.01 * (cos(angle) > 0.9 || cos(angle) < 0.1 ? 1.0 : sqrt(2.0)), 0.003, 0.0),
                       shv_vec3(0.0, 0.0, 5.0));
        other->placement.rotation_axis[2] = 1.0;
        other->placement.rotation_degrees = 45.0 * turn;
        check_untouched(&s, 0.04 / 10.0, "turned by degrees", 45.0 * turn, 0.0);
    }
}

/* A block glides off another, on which it stands, or in which it is so deep from the start. Its edges are askew to those of the
   other, parallel to them, or exactly on them; none is in the way, nor are sides. */
static void glide_off(double depth_at_start, double turn, double size)
{
    Surfaces s;
    surfaces_define(&s);
    ShvObjectDefinition *block = surfaces_box(&s, 0.02, 0.02, 0.02, 0.01);
    surfaces_place(block, shv_vec3(0.0, 0.0, 0.02 - depth_at_start), shv_vec3(3.0, 4.0, 0.0));
    block->placement.rotation_axis[2] = 1.0;
    block->placement.rotation_degrees = turn;
    surfaces_box(&s, size, size, 0.02, 0.5 * size);
    check_untouched(&s, 0.04 / 5.0, "m deep, turned by degrees", depth_at_start, turn);
}

/* A block that leans by so many degrees glides along its own lower face over the rim of another, and off it, with its last nodes just over
   the other's upper face until they have passed the rim: none is in the way. */
static void glide_down(double degrees, double turn)
{
    Surfaces s;
    const double t = radians(degrees), gap = 1e-8;
    surfaces_define(&s);
    ShvObjectDefinition *block = surfaces_box(&s, 0.02, 0.02, 0.02, 0.01);
    const ShvQuat pose = shv_quat_multiply(shv_quat_exponential(shv_vec3(0.0, t, 0.0)),
                                           shv_quat_exponential(shv_vec3(0.0, 0.0, radians(turn))));
    const ShvVec3 down = shv_vec3(cos(t), 0.0, -sin(t)), up = shv_vec3(sin(t), 0.0, cos(t)), rim = {0.01, 0.0, 0.01};
    const ShvVec3 centre = shv_madd(shv_madd(rim, 0.01 + gap, up), -0.003, down);
    surfaces_place(block, centre, shv_scale(down, 5.0));
    set_rotation(block, pose);
    surfaces_box(&s, 0.02, 0.02, 0.02, 0.01);
    check_untouched(&s, 0.03 / 5.0, "leaning, turned by degrees", degrees, turn);
}

static void test_block_glides_down(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        glide_down(15.0, 10.0 * k);
        glide_down(40.0, 10.0 * k);
    }
}

static void test_block_glides_off(void **state)
{
    (void)state;
    const double depths[] = {0.0, 1e-9, 1e-6, 2e-5, 2e-4, 1e-3}, turns[] = {0.0, 30.0, 45.0};
    for (int k = 0; k < 3; k++) {

        for (int i = 0; i < 6; i++) {
            glide_off(depths[i], turns[k], 0.01);
            glide_off(depths[i], turns[k], 0.02);
        }
    }
}

/* A block that leans by so many degrees, its side 0.5 mm over the rim of another, into which it has sunk by 0.2 mm, glides on: its upright
   edges are inside the rim, sideways, but it was from above that their nodes came. */
static void glide_on(double degrees)
{
    Surfaces s;
    surfaces_define(&s);
    ShvObjectDefinition *block = surfaces_box(&s, 0.02, 0.02, 0.02, 0.01);
    const ShvVec3 axis = shv_unit(shv_vec3(1.0, 0.0, 0.25)), lowest = {-0.01, -0.01, -0.01};
    const ShvQuat pose = shv_quat_exponential(shv_scale(axis, radians(degrees)));
    surfaces_place(block, shv_sub(shv_vec3(-0.007, 0.0095, 0.0098), shv_rotate(pose, lowest)),
                   shv_vec3(0.0, -5.0, 0.0));
    set_rotation(block, pose);
    surfaces_box(&s, 0.04, 0.02, 0.02, 0.01);
    check_untouched(&s, 0.005 / 5.0, "leaning by degrees", degrees, 0.0);
}

static void test_block_glides_on(void **state)
{
    (void)state;
    glide_on(0.0);
    glide_on(2.0);
}

/* Equal blocks face to face, all edges of the faces in common, run into each other: no impulse has another direction than the
   faces'. */
static void test_common_edges(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_box(&s, 0.02, 0.02, 0.02, 0.01), shv_vec3(0.0, 0.0, 0.02), shv_vec3(0.0, 0.0, -1.0));
    surfaces_place(surfaces_box(&s, 0.02, 0.02, 0.02, 0.01), shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 1.0));
    surfaces_build(&s, 0.3, false);
    surfaces_step(&s, surfaces_stable_step(&s));
    assert_true(s.contact.touching > 0);
    for (int32_t k = 0; k < s.contact.pair_count; k++) {
        const ShvFacetPair *pair = &s.contact.pairs[k];
        if (!(pair->normal_impulse > 0.0)) continue;
        check_near(fabs(pair->normal.z), 1.0, 1e-12);
    }
    surfaces_release(&s);
}

/* ---- the same bits ---- */

static void test_threads(void **state)
{
    (void)state;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        Surfaces s;
        define_plates(&s, &(Crossing){.speed = 20.0, .tilt = 30.0, .turn = 60.0, .threads = 1 + k});
        const double step = surfaces_stable_step(&s);
        for (int i = 0; i < 30; i++) surfaces_step(&s, step);
        assert_true(s.contact.touching > 0);
        hash[k] = shv_state_hash(&s.state);
        surfaces_release(&s);
    }
    assert_true(hash[0] == hash[1]);
}

/* Fails at every allocation in turn. */
static void test_out_of_memory(void **state)
{
    (void)state;
    Surfaces s;
    define_plates(&s, &(Crossing){.speed = 20.0, .tilt = 30.0, .turn = 60.0, .unbreakable = true});
    int failures = 0;
    for (int64_t allowed = 0;; allowed++) {
        shv_memory_fail_after(s.memory, allowed);
        ShvStatus status = shv_surface_contact_begin(&s.contact, &s.bodies, 1e-6, &s.error);
        if (status == SHV_OK) status = shv_surface_contact_apply(&s.contact, &s.bodies, 1e-6, &s.error);
        shv_memory_fail_after(s.memory, -1);
        if (status == SHV_OK) break;
        assert_int_equal(status, SHV_NO_MEMORY);
        failures++;
        shv_surface_contact_release(&s.contact);
        check_ok(shv_surface_contact_create(&s.contact, s.memory, &s.model, 0.3, &s.error), s.error);
    }
    assert_true(failures > 12);
    assert_true(s.contact.pair_count > 0);
    surfaces_release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_speeds),           cmocka_unit_test(test_angles),
        cmocka_unit_test(test_shallow_approach), cmocka_unit_test(test_coupled_bodies),
        cmocka_unit_test(test_unbreakable),      cmocka_unit_test(test_edges_pass),
        cmocka_unit_test(test_next_to_nodes),    cmocka_unit_test(test_block_glides_down),
        cmocka_unit_test(test_block_glides_off), cmocka_unit_test(test_block_glides_on),
        cmocka_unit_test(test_common_edges),     cmocka_unit_test(test_threads),
        cmocka_unit_test(test_out_of_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
