#include "surfaces.h"

#include "base/random.h"
#include "contact/surface_candidates.h"
#include "contact/surface_edge.h"

/* ---- free flight into each other ---- */

/* Two equal bars without lateral strain end on: waves run to the far ends and back, after 2 L/c the bars have exchanged
   their velocities. Contact of restitution 0 takes what the two layers of touching nodes bring in. */
static void test_bars_exchange_velocities(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    s.material.poissons_ratio = 0.0;
    surfaces_place(surfaces_box(&s, 0.1, 0.01, 0.01, 0.005), shv_vec3(-0.0501, 0.0, 0.0), shv_vec3(1.0, 0.0, 0.0));
    surfaces_place(surfaces_box(&s, 0.1, 0.01, 0.01, 0.005), shv_vec3(0.0501, 0.002, 0.001), shv_vec3(0.0, 0.0, 0.0));
    surfaces_build(&s, 0.0, false);
    const double step = surfaces_stable_step(&s), speed = sqrt(50e6 / 1200.0);
    const Momentum start = surfaces_momentum(&s);
    double first = 0.0, last = 0.0;
    while (s.state.time < 4.0 * 0.1 / speed) {
        surfaces_step(&s, step);
        if (s.contact.touching > 0 && first == 0.0) first = s.state.time;
        if (s.contact.touching > 0) last = s.state.time;
        check_momentum(&s, &start);
    }
    check_near(last - first, 2.0 * 0.1 / speed, 0.1 * 2.0 * 0.1 / speed);
    check_near(surfaces_mean_velocity(&s, 0).x, 0.0, 0.06);
    check_near(surfaces_mean_velocity(&s, 1).x, 1.0, 0.06);
    assert_true(s.gain <= 1e-13 * start.linear_size);
    assert_true(s.unbooked <= 1e-12 * start.linear_size);
    surfaces_release(&s);
}

/* Energy, momentum and depth of two bodies on their way into each other and out again. */
static void collide(Surfaces *s, double duration, double depth)
{
    const double step = surfaces_stable_step(s);
    const Momentum start = surfaces_momentum(s);
    const double energy = surfaces_kinetic(s, s->state.velocity) + coupled_bodies_kinetic(s);
    int touched = 0;
    while (s->state.time < duration) {
        surfaces_step(s, step);
        touched += s->contact.touching > 0;
        check_momentum(s, &start);
        /* Energy of a step differs by O(step²) from the conserved one. */
        if (!(s->energy < 1.005 * energy)) fail_msg("energy %g J of %g J", s->energy, energy);
    }
    assert_true(touched > 10);
    assert_true(s->gain <= 1e-13 * energy);
    assert_true(s->unbooked <= 1e-12 * energy);
    if (!(s->deepest < depth)) fail_msg("a node came %g m deep", s->deepest);
}

static void test_cubes_head_on(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_box(&s, 0.04, 0.04, 0.04, 0.01), shv_vec3(-0.021, 0.0, 0.0), shv_vec3(2.0, 0.0, 0.0));
    surfaces_place(surfaces_box(&s, 0.04, 0.04, 0.04, 0.01), shv_vec3(0.021, 0.003, 0.0), shv_vec3(-2.0, 0.0, 0.0));
    surfaces_build(&s, 0.3, false);
    /* Edges that are flush: a corner of one that has slipped past the other's face comes back behind it. */
    collide(&s, 0.004, 2e-4);
    assert_true(surfaces_mean_velocity(&s, 0).x < -0.5);
    assert_true(surfaces_mean_velocity(&s, 1).x > 0.5);
    surfaces_release(&s);
}

/* Friction of an oblique impact turns both balls. */
static void test_balls_oblique(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_ball(&s, 0.02, 0.006), shv_vec3(-0.021, 0.0, 0.0), shv_vec3(2.0, 0.5, 0.0));
    ShvObjectDefinition *other = surfaces_ball(&s, 0.02, 0.005);
    surfaces_place(other, shv_vec3(0.021, 0.013, 0.004), shv_vec3(-2.0, -0.5, 0.3));
    other->placement.angular_velocity[2] = 40.0;
    surfaces_build(&s, 0.4, false);
    collide(&s, 0.004, 1e-4);
    assert_true(surfaces_mean_velocity(&s, 0).x < 0.0);
    surfaces_release(&s);
}

static void test_ball_on_plate(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_ball(&s, 0.02, 0.006), shv_vec3(0.001, 0.002, 0.0255), shv_vec3(0.4, 0.0, -2.0));
    surfaces_box(&s, 0.1, 0.1, 0.01, 0.01);
    surfaces_build(&s, 0.4, false);
    collide(&s, 0.004, 1e-4);
    assert_true(surfaces_mean_velocity(&s, 0).z > -1.0);
    surfaces_release(&s);
}

/* ---- coupled bodies ---- */

static void test_cube_on_coupled_body(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_box(&s, 0.04, 0.04, 0.04, 0.01), shv_vec3(0.012, 0.003, 0.042), shv_vec3(0.3, 0.0, -2.0));
    surfaces_box(&s, 0.04, 0.04, 0.04, 0.02);
    surfaces_build(&s, 0.3, false);
    surfaces_make_coupled_body(&s, 1, shv_vec3(0.0, 0.1, 0.0), shv_vec3(1.0, 0.0, 2.0));
    collide(&s, 0.006, 1e-4);
    assert_true(s.coupled_body[1].velocity.z < -0.5);
    assert_true(fabs(s.coupled_body[1].angular_velocity.y) > 1.0);
    surfaces_release(&s);
}

/* Two coupled bodies touch by the same rules. */
static void test_coupled_bodies(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, 0.04, 0.04, 0.04, 0.01)->placement.position[2] = 0.041;
    surfaces_box(&s, 0.04, 0.04, 0.04, 0.02);
    surfaces_ball(&s, 0.01, 0.005)->placement.position[0] = 1.0; /* something awake, far away */
    surfaces_build(&s, 0.3, false);
    surfaces_make_coupled_body(&s, 0, shv_vec3(0.0, 0.0, -1.0), shv_vec3(0.0, 0.0, 0.0));
    surfaces_make_coupled_body(&s, 1, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    const Momentum start = surfaces_momentum(&s);
    for (int k = 0; k < 200; k++) {
        surfaces_step(&s, 2e-5);
        check_momentum(&s, &start);
    }
    /* Restitution 0 of equal cubes face to face. */
    check_near(s.coupled_body[0].velocity.z, -0.5, 1e-6);
    check_near(s.coupled_body[1].velocity.z, -0.5, 1e-6);
    surfaces_release(&s);
}

/* A block falls on a coupled body that stands on the floor: it does not sink, neither under the blow nor under the weight. */
static void test_coupled_body_on_floor(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_box(&s, 0.04, 0.04, 0.01, 0.01), shv_vec3(0.003, 0.002, 0.0255), shv_vec3(0.0, 0.0, -0.5));
    surfaces_box(&s, 0.06, 0.04, 0.02, 0.02)->placement.position[2] = 0.01;
    surfaces_build(&s, 0.4, true);
    s.gravity[2] = -9.81;
    surfaces_make_coupled_body(&s, 1, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    const double step = surfaces_stable_step(&s);
    double lowest = 0.01, fastest = 0.0;
    while (s.state.time < 0.03) {
        surfaces_step(&s, step);
        lowest = fmin(lowest, s.coupled_body[1].position.z);
        fastest = fmax(fastest, shv_norm(s.coupled_body[1].velocity));
    }
    check_near(lowest, 0.01, 1e-7);
    assert_true(fastest < 0.5);
    check_near(s.coupled_body[1].position.x, 0.0, 1e-4);
    assert_true(s.gain <= 1e-15);
    assert_true(s.unbooked < 1e-14);
    surfaces_release(&s);
}

/* ---- pieces of one body ---- */

static int32_t cut(Surfaces *s, double normal_x, double normal_z)
{
    const ShvAdjacency *adjacency = &s->model.adjacency;
    int32_t *facets = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)adjacency->interior_count, sizeof(int32_t));
    int32_t count = 0, duplicated;
    for (int32_t e = 0; e < s->state.element_count; e++) {
        double side = 0.0;
        for (int k = 0; k < 4; k++) {
            const ShvVec3 x = shv_load3(s->state.reference + 3 * (int64_t)s->model.mesh.elements[4 * (int64_t)e + k]);
            side += normal_x * x.x + normal_z * (x.z - 0.02);
        }
        s->state.element_fragment[e] = side > 0.0;
    }
    for (int32_t f = 0; f < adjacency->interior_count; f++)
        if (s->state.element_fragment[adjacency->facet_elements[2 * f]] !=
            s->state.element_fragment[adjacency->facet_elements[2 * f + 1]])
            facets[count++] = f;
    check_ok(shv_cohesive_insert(&s->cohesive, &s->state, NULL, facets, count, &duplicated, &s->error), s->error);
    shv_release(facets);
    s->awake[1] = 1;
    s->bodies.fragment_count = 2;
    surfaces_list_nodes(s);
    return count;
}

/* What touches or interlocks at birth is not moved, whether its crack has parted or not. */
static void test_halves_rest(void **state)
{
    (void)state;
    for (int parted = 0; parted < 2; parted++) {
        Surfaces s;
        surfaces_define(&s);
        surfaces_box(&s, 0.04, 0.04, 0.04, 0.01)->placement.position[2] = 0.02;
        surfaces_build(&s, 0.3, false);
        assert_true(cut(&s, 1.0, 0.3) > 10);
        if (parted) surfaces_part(&s);
        for (int k = 0; k < 50; k++) surfaces_step(&s, 2e-5);
        assert_true(parted ? s.contact.candidates[0].count > 100 : !s.contact.idle);
        for (int64_t i = 0; i < 3 * (int64_t)s.state.node_count; i++) {
            assert_true(s.state.displacement[i] == 0.0);
            assert_true(s.state.velocity[i] == 0.0);
        }
        surfaces_release(&s);
    }
}

/* Halves of a rough crack, drawn apart until it has parted and sent back at each other: they collide and stay out. */
static void test_parted_halves_collide(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, 0.04, 0.04, 0.04, 0.01)->placement.position[2] = 0.02;
    surfaces_build(&s, 0.2, false);
    cut(&s, 1.0, 0.3);
    for (int32_t e = 0; e < s.state.element_count; e++)
        for (int k = 0; k < 4; k++) {
            const int64_t i = 3 * (int64_t)shv_state_node(&s.state, e, k);
            s.state.displacement[i] = s.state.element_fragment[e] == 1 ? 0.01 : -0.01;
            s.state.velocity[i] = s.state.element_fragment[e] == 1 ? -1.0 : 1.0;
        }
    surfaces_part(&s);
    collide(&s, 0.02, 1e-4);
    assert_true(surfaces_mean_velocity(&s, 1).x > 0.1);
    assert_true(surfaces_mean_velocity(&s, 0).x < -0.1);
    surfaces_release(&s);
}

/* Faces of a crack that has parted inside one fragment still meet: a slit that does not cut its body through is squeezed. */
static void test_slit_closes(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, 0.08, 0.02, 0.04, 0.01)->placement.position[2] = 0.02;
    surfaces_build(&s, 0.2, false);
    cut(&s, 1.0, 0.0);
    const double step = surfaces_stable_step(&s);
    /* Both halves carry one name. */
    for (int32_t e = 0; e < s.state.element_count; e++) s.state.element_fragment[e] = 0;
    s.bodies.fragment_count = 1;
    for (int32_t e = 0; e < s.state.element_count; e++)
        for (int k = 0; k < 4; k++) {
            const int32_t node = shv_state_node(&s.state, e, k);
            const double side = s.state.reference[3 * (int64_t)node];
            if (fabs(side) > 0.015) s.state.velocity[3 * (int64_t)node] = side > 0.0 ? -0.5 : 0.5;
        }
    surfaces_part(&s);
    int touched = 0;
    for (int k = 0; k < 100; k++) {
        surfaces_step(&s, step);
        touched += s.contact.touching > 0;
    }
    assert_false(s.contact.idle);
    assert_true(touched > 10);
    /* A node that slips past an edge shows the depth that it had beside it; faces as a whole stay apart. */
    assert_true(s.deepest < 0.05 * 0.01);
    surfaces_release(&s);
}

/* ---- rubble ---- */

/* Cuts the first object by nearest seed. */
static void shatter(Surfaces *s, int32_t seeds, const double size[3])
{
    const ShvAdjacency *adjacency = &s->model.adjacency;
    int32_t *facets = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)adjacency->interior_count, sizeof(int32_t));
    int32_t count = 0, duplicated;
    for (int32_t e = 0; e < s->state.element_count; e++) {
        double nearest = (double)INFINITY;
        ShvVec3 x = {0.0, 0.0, 0.0};
        for (int k = 0; k < 4; k++)
            x = shv_madd(x, 0.25, shv_load3(s->state.reference + 3 * (int64_t)shv_state_node(&s->state, e, k)));
        for (int32_t i = 0; i < seeds; i++) {
            double seed[3];
            for (int k = 0; k < 3; k++) seed[k] = size[k] * (shv_random_uniform(5, (uint64_t)(3 * i + k)) - 0.5);
            seed[2] += 0.5 * size[2];
            const double distance = shv_norm(shv_sub(x, shv_load3(seed)));
            if (distance < nearest) s->state.element_fragment[e] = i;
            nearest = fmin(nearest, distance);
        }
    }
    for (int32_t f = 0; f < adjacency->interior_count; f++)
        if (s->state.element_fragment[adjacency->facet_elements[2 * f]] !=
            s->state.element_fragment[adjacency->facet_elements[2 * f + 1]])
            facets[count++] = f;
    check_ok(shv_cohesive_insert(&s->cohesive, &s->state, NULL, facets, count, &duplicated, &s->error), s->error);
    shv_release(facets);
    memset(s->awake, 1, (size_t)seeds);
    s->bodies.fragment_count = seeds;
    surfaces_part(s);
}

/* A block in pieces that interlock and touch from birth, on a floor under gravity: it stands as a heap of rubble that no
   piece pops out of, and none sinks into another. */
static void test_rubble_stands(void **state)
{
    (void)state;
    const double size[3] = {0.04, 0.04, 0.04};
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, size[0], size[1], size[2], 0.01)->placement.position[2] = 0.02;
    surfaces_build(&s, 0.5, true);
    shatter(&s, 8, size);
    s.gravity[2] = -9.81;
    const double step = surfaces_stable_step(&s), mass = 1200.0 * 0.04 * 0.04 * 0.04;
    double highest = 0.0;
    while (s.state.time < 0.02) {
        surfaces_step(&s, step);
        highest = fmax(highest, surfaces_kinetic(&s, s.state.velocity));
    }
    /* Nothing falls farther than elastic sagging, g ρ H²/2E = 2 µm, and what the pieces settle into their joints. */
    assert_true(highest < mass * 9.81 * 2e-4);
    assert_true(s.deepest < 1e-4);
    assert_true(s.unbooked < 1e-12 * mass * 9.81 * 0.04);
    for (int32_t k = 0; k < s.node_count; k++)
        assert_true(shv_norm(shv_load3(s.state.displacement + 3 * (int64_t)s.nodes[k])) < 1e-3);
    surfaces_release(&s);
}

static bool in_tet(const Surfaces *s, int32_t element, ShvVec3 x)
{
    ShvVec3 corners[4];
    for (int k = 0; k < 4; k++) corners[k] = shv_state_position(&s->state, shv_state_node(&s->state, element, k));
    for (int k = 0; k < 4; k++) {
        const uint8_t *face = shv_face_corners[k];
        const ShvVec3 a = corners[face[0]];
        const ShvVec3 out = shv_cross(shv_sub(corners[face[1]], a), shv_sub(corners[face[2]], a));
        if (shv_dot(out, shv_sub(x, a)) > 0.0) return false;
    }
    return true;
}

/* Share of the bodies' volume that is in two of them, by random points of a box that holds them. */
static double overlap(const Surfaces *s, ShvVec3 low, ShvVec3 high)
{
    enum { POINTS = 4000 };
    int32_t once = 0, twice = 0;
    for (uint64_t i = 0; i < POINTS; i++) {
        const ShvVec3 x = {low.x + (high.x - low.x) * shv_random_uniform(9, 3 * i),
                           low.y + (high.y - low.y) * shv_random_uniform(9, 3 * i + 1),
                           low.z + (high.z - low.z) * shv_random_uniform(9, 3 * i + 2)};
        int32_t first = -1;
        bool both = false;
        for (int32_t e = 0; e < s->state.element_count && !both; e++) {
            const int32_t fragment = s->state.element_fragment[e];
            if (fragment == first || !in_tet(s, e, x)) continue;
            both = first >= 0;
            first = fragment;
        }
        once += first >= 0;
        twice += both;
    }
    return once > 0 ? (double)twice / once : 0.0;
}

/* Drawn apart and dropped: the pieces fall onto each other and stay out of each other. */
static void test_rubble_falls(void **state)
{
    (void)state;
    const double size[3] = {0.04, 0.04, 0.04};
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, size[0], size[1], size[2], 0.01)->placement.position[2] = 0.02;
    surfaces_build(&s, 0.5, true);
    shatter(&s, 8, size);
    s.gravity[2] = -9.81;
    ShvVec3 centre[8] = {{0.0, 0.0, 0.0}};
    double weight[8] = {0.0};
    for (int32_t e = 0; e < s.state.element_count; e++)
        for (int k = 0; k < 4; k++) {
            const int32_t node = shv_state_node(&s.state, e, k), f = s.state.element_fragment[e];
            centre[f] = shv_add(centre[f], shv_load3(s.state.reference + 3 * (int64_t)node));
            weight[f] += 1.0;
        }
    for (int32_t e = 0; e < s.state.element_count; e++)
        for (int k = 0; k < 4; k++) {
            const int32_t node = shv_state_node(&s.state, e, k), f = s.state.element_fragment[e];
            shv_store3(s.state.displacement + 3 * (int64_t)node, shv_scale(centre[f], 0.6 / weight[f]));
            s.state.velocity[3 * (int64_t)node + 2] = -0.5;
        }
    const double step = surfaces_stable_step(&s), start = surfaces_kinetic(&s, s.state.velocity);
    const double mass = 1200.0 * 0.04 * 0.04 * 0.04;
    int64_t touches = 0;
    while (s.state.time < 0.06) {
        surfaces_step(&s, step);
        touches += s.contact.touching;
        assert_true(surfaces_kinetic(&s, s.state.velocity) < start + mass * 9.81 * 0.05);
    }
    assert_true(touches > 1000);
    assert_true(s.gain <= 1e-13 * start);
    const double share = overlap(&s, shv_vec3(-0.06, -0.06, 0.0), shv_vec3(0.06, 0.06, 0.08));
    if (!(share < 0.01)) fail_msg("%g of the volume is in two pieces", share);
    surfaces_release(&s);
}

/* ---- the same bits ---- */

static uint64_t hash_of(const Surfaces *s)
{
    return shv_state_hash(&s->state);
}

static void define_crash(Surfaces *s, int32_t threads)
{
    surfaces_define(s);
    s->scene.threads = threads;
    surfaces_place(surfaces_ball(s, 0.02, 0.006), shv_vec3(0.001, 0.002, 0.0252), shv_vec3(0.4, 0.0, -3.0));
    surfaces_box(s, 0.1, 0.1, 0.01, 0.01);
    surfaces_place(surfaces_box(s, 0.03, 0.03, 0.03, 0.01), shv_vec3(0.0, 0.0, -0.021), shv_vec3(0.0, 0.0, 1.0));
    surfaces_build(s, 0.4, false);
    surfaces_make_coupled_body(s, 2, shv_vec3(0.0, 0.0, 1.0), shv_vec3(3.0, 1.0, 0.0));
}

static void test_threads(void **state)
{
    (void)state;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        Surfaces s;
        define_crash(&s, 1 + k);
        /* Few steps: two threads that wait for each other are slow on a busy machine. */
        for (int step = 0; step < 12; step++) surfaces_step(&s, 8e-6);
        assert_true(s.contact.touching > 0);
        hash[k] = hash_of(&s);
        surfaces_release(&s);
    }
    assert_true(hash[0] == hash[1]);
}

/* A step that is looked at and not taken leaves no trace. */
static void test_steps_thrown_away(void **state)
{
    (void)state;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        Surfaces s;
        define_crash(&s, 1);
        double *kept = shv_allocate(NULL, SHV_PART_GENERAL, 3 * (size_t)s.state.node_count, sizeof(double));
        for (int step = 0; step < 150; step++) {
            if (k == 1 && step % 3 == 1) {
                const ShvCoupledBody coupled_body = s.coupled_body[2];
                memcpy(kept, s.state.velocity, 3 * (size_t)s.state.node_count * sizeof(double));
                surfaces_kick(&s, s.state.last_step);
                memcpy(s.state.velocity, kept, 3 * (size_t)s.state.node_count * sizeof(double));
                s.coupled_body[2] = coupled_body;
            }
            surfaces_step(&s, 6e-6 * (1.0 + 0.1 * (step % 4)));
        }
        assert_true(s.contact.touching > 0);
        hash[k] = hash_of(&s);
        shv_release(kept);
        surfaces_release(&s);
    }
    assert_true(hash[0] == hash[1]);
}

/* ---- what is looked at ---- */

/* Whether a pair, or one that stands for it, is among those of the step. */
static bool is_listed(const ShvSurfaceContact *contact, const ShvFacetPair *pair)
{
    for (int32_t i = 0; i < contact->pair_count; i++) {
        const ShvFacetPair *other = &contact->pairs[i];
        if (other->node_count == 1 && other->nodes[0] == pair->nodes[0] && other->fragments[1] == pair->fragments[1] &&
            fabs(other->gap) <= fabs(pair->gap) * (1.0 + 1e-6))
            return true;
    }
    return false;
}

/* Whether a tet has a copy of a node. */
static bool are_neighbours(const ShvState *state, int32_t element, int32_t node)
{
    bool shared = false;
    for (int k = 0; k < 4; k++)
        shared = shared || state->origin[shv_state_node(state, element, k)] == state->origin[node];
    return shared;
}

static bool in_place(const Surfaces *s, const ShvFacetPair *pair)
{
    const ShvVec3 x = shv_bodies_position(&s->bodies, pair->nodes[0], pair->fragments[0]);
    for (int k = 0; k < 4; k++) {
        const int32_t corner = shv_state_node(&s->state, pair->element, k);
        const ShvVec3 apart = shv_sub(x, shv_bodies_position(&s->bodies, corner, pair->fragments[1]));
        if (s->state.origin[corner] == s->state.origin[pair->nodes[0]] && shv_norm(apart) < 0.5 * s->contact.skin[0])
            return true;
    }
    return false;
}

/* Pairs, by all nodes against all facets, that would be struck in a step. */
static int32_t brute_force(const Surfaces *s, double step, ShvFacetPair *found, int32_t room)
{
    const double reach = 1e-3; /* m, far more than any two can come closer in a step */
    const ShvSurfaceList *list = &s->contact.list;
    int32_t count = 0;
    for (int32_t f = 0; f < list->facet_count; f++)
        for (int32_t i = 0; i < list->node_count; i++) {
            const ShvSurfaceFacet *facet = &list->facets[f];
            const ShvSurfaceNode *node = &list->nodes[i];
            ShvSurfaceCandidate candidate = {.slot = i, .facet = f, .own_facet = -1};
            shv_surface_candidate_name(list, &candidate);
            ShvFacetPair pair;
            double distance;
            if (facet->fragment == node->fragment ||
                (node->held && are_neighbours(&s->state, facet->element, node->node)) ||
                !shv_facet_pair_detect(&s->bodies, list, &candidate, step, reach, &pair, &distance))
                continue;
            if (pair.gap + step * shv_dot(pair.relative, pair.normal) >= 0.0) continue;
            assert_true(count < room);
            found[count++] = pair;
        }
    return count;
}

/* ---- edges ---- */

enum { MOST_EDGES = 4000 };

/* Sharp edges as they are, each once. */
static int32_t list_edges(const Surfaces *s, ShvEdge edges[MOST_EDGES])
{
    const ShvSurfaceList *list = &s->contact.list;
    int32_t count = 0;
    for (int32_t h = 0; h < 3 * list->facet_count; h++) {
        if (!(list->facets[h / 3].sharp >> h % 3 & 1)) continue;
        assert_true(count < MOST_EDGES);
        if (shv_surface_edge(list, &s->bodies, h, &edges[count])) count++;
    }
    return count;
}

static bool share_a_node(const Surfaces *s, const ShvEdge *a, const ShvEdge *b)
{
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            if (s->state.origin[a->corners[(a->edge + i) % 3]] == s->state.origin[b->corners[(b->edge + k) % 3]])
                return true;
    return false;
}

static ShvBox box_of_edge(const ShvEdge *edge)
{
    ShvBox box = shv_box_empty();
    shv_box_add(&box, edge->places[edge->edge]);
    shv_box_add(&box, edge->places[(edge->edge + 1) % 3]);
    return box;
}

static bool both_rigid(const Surfaces *s, const int32_t fragments[2])
{
    return s->coupled_bodies[fragments[0]] && s->coupled_bodies[fragments[1]];
}

/* Whether the two edges of a pair are among the pairs of the step, whichever comes first. */
static bool edges_are_listed(const ShvSurfaceContact *contact, const ShvEdge *a, const ShvEdge *b)
{
    for (int32_t i = 0; i < contact->pair_count; i++) {
        const ShvFacetPair *pair = &contact->pairs[i];
        for (int side = 0; side < 2; side++) {
            const ShvEdge *own = side == 0 ? a : b, *other = side == 0 ? b : a;
            if (pair->nodes[0] == own->corners[own->edge] && pair->nodes[1] == own->corners[(own->edge + 1) % 3] &&
                pair->element == other->element && pair->face == other->face && pair->edge == other->edge)
                return true;
        }
    }
    return false;
}

typedef struct EdgePairs {
    ShvEdge edges[MOST_EDGES];
    int32_t pairs[MOST_EDGES][2], count;
} EdgePairs;

/* All edges of different fragments against one another that would be struck in a step. */
static void find_edges(const Surfaces *s, double step, EdgePairs *found)
{
    const double reach = 1e-4; /* m, more than any two can come closer in a step */
    const int32_t count = list_edges(s, found->edges);
    found->count = 0;
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = 0; k < i; k++) {
            const ShvEdge *a = &found->edges[i], *b = &found->edges[k];
            const ShvBox box = shv_box_grown(box_of_edge(a), reach), other = box_of_edge(b);
            ShvFacetPair pair;
            double distance;
            if (a->fragment == b->fragment || !shv_box_meets(&box, &other) || share_a_node(s, a, b) ||
                both_rigid(s, (const int32_t[]){a->fragment, b->fragment}) ||
                !shv_edge_pair_detect(&s->bodies, a, b, step, reach, &pair, &distance))
                continue;
            if (pair.gap + step * shv_dot(pair.relative, pair.normal) >= -1e-12) continue;
            assert_true(found->count < MOST_EDGES);
            found->pairs[found->count][0] = i;
            found->pairs[found->count++][1] = k;
        }
}

/* After the step's pairs have been found. Returns how many there were. */
static int32_t check_edges(const Surfaces *s, const EdgePairs *expected)
{
    for (int32_t i = 0; i < expected->count; i++)
        assert_true(edges_are_listed(&s->contact, &expected->edges[expected->pairs[i][0]],
                                     &expected->edges[expected->pairs[i][1]]));
    return expected->count;
}

/* In spite of skin, paths and grid. */
static void test_nothing_is_missed(void **state)
{
    (void)state;
    enum { ROOM = 1000 };
    static ShvFacetPair expected[ROOM];
    static EdgePairs edges;
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_ball(&s, 0.02, 0.006), shv_vec3(-0.021, 0.0, 0.0), shv_vec3(2.0, 0.5, 0.0));
    ShvObjectDefinition *other = surfaces_box(&s, 0.03, 0.03, 0.03, 0.012);
    surfaces_place(other, shv_vec3(0.014, 0.0255, 0.004), shv_vec3(-2.0, -0.5, 0.3));
    other->placement.angular_velocity[2] = 100.0;
    surfaces_box(&s, 0.08, 0.08, 0.08, 0.08)->placement.position[2] = -0.0605;
    surfaces_build(&s, 0.4, false);
    surfaces_make_coupled_body(&s, 2, shv_vec3(0.0, 0.0, 2.0), shv_vec3(0.0, 5.0, 0.0));
    const double step = surfaces_stable_step(&s);
    int64_t crossed = 0, found = 0;
    for (int k = 0; k < 400; k++) {
        surfaces_forces(&s);
        check_ok(shv_surface_contact_begin(&s.contact, &s.bodies, step, &s.error), s.error);
        shv_motion_kick(&s.state, s.nodes, s.node_count, 0.5 * (s.state.last_step + step), s.gravity, 1);
        const int32_t count = brute_force(&s, step, expected, ROOM);
        find_edges(&s, step, &edges);
        check_ok(shv_surface_contact_apply(&s.contact, &s.bodies, step, &s.error), s.error);
        for (int32_t i = 0; i < count; i++) assert_true(is_listed(&s.contact, &expected[i]));
        found += count;
        crossed += check_edges(&s, &edges);
        surfaces_drift(&s, step);
    }
    assert_true(found > 100);
    assert_true(crossed > 50);
    assert_true(s.contact.rebuilds < 100);
    assert_true(s.contact.distance_checks < 100 * found);
    surfaces_release(&s);
}

/* Cracks fail and part one by one while their pieces, apart from birth, run into each other: faces and nodes that come after
   the candidates were chosen meet as if they had been there. */
static void test_late_cracks(void **state)
{
    (void)state;
    enum { ROOM = 4000, PIECES = 8 };
    static ShvFacetPair expected[ROOM];
    static EdgePairs edges;
    const double size[3] = {0.04, 0.04, 0.04};
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, size[0], size[1], size[2], 0.01)->placement.position[2] = 0.02;
    surfaces_build(&s, 0.3, false);
    shatter(&s, PIECES, size);
    for (int32_t i = 0; i < s.cohesive.count; i++) s.cohesive.phase[i] = SHV_COHESIVE_CARRYING;
    s.cohesive.live_count = s.cohesive.count;
    for (int32_t e = 0; e < s.state.element_count; e++)
        for (int k = 0; k < 4; k++) {
            const int32_t node = shv_state_node(&s.state, e, k), piece = s.state.element_fragment[e];
            for (int axis = 0; axis < 3; axis++) {
                const double way = shv_random_uniform(3, (uint64_t)(3 * piece + axis)) - 0.5;
                s.state.displacement[3 * (int64_t)node + axis] = 0.03 * way;
                s.state.velocity[3 * (int64_t)node + axis] = -6.0 * way;
            }
        }
    const double step = surfaces_stable_step(&s);
    int64_t crossed = 0, found = 0, late = 0;
    for (int k = 0; k < 300; k++) {
        for (int n = 0; n < 2; n++) {
            const double share = shv_random_uniform(11, (uint64_t)(2 * k + n));
            uint8_t *phase = &s.cohesive.phase[(int32_t)(share * s.cohesive.count)];
            *phase = *phase == SHV_COHESIVE_CARRYING ? SHV_COHESIVE_FAILED : SHV_COHESIVE_SEPARATED;
        }
        const int64_t rebuilds = s.contact.rebuilds;
        const int32_t facets = s.contact.list.facet_count;
        check_ok(shv_surface_contact_begin(&s.contact, &s.bodies, step, &s.error), s.error);
        late += rebuilds == s.contact.rebuilds && s.contact.list.facet_count > facets;
        const int32_t count = brute_force(&s, step, expected, ROOM);
        find_edges(&s, step, &edges);
        check_ok(shv_surface_contact_apply(&s.contact, &s.bodies, step, &s.error), s.error);
        for (int32_t i = 0; i < count; i++) assert_true(is_listed(&s.contact, &expected[i]));
        found += count;
        crossed += check_edges(&s, &edges);
        surfaces_drift(&s, step);
    }
    assert_true(late > 20);
    assert_true(found > 100);
    assert_true(crossed > 50);
    surfaces_release(&s);
}

/* The facets around the elements of a piece that are still whole; the piece becomes a fragment of its own. */
static void cut_off(Surfaces *s, const int32_t *piece, int32_t index)
{
    const ShvAdjacency *adjacency = &s->model.adjacency;
    int32_t *facets = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)adjacency->interior_count, sizeof(int32_t));
    int32_t count = 0, duplicated;
    for (int32_t f = 0; f < adjacency->interior_count; f++) {
        const int32_t *sides = adjacency->facet_elements + 2 * (int64_t)f;
        if ((piece[sides[0]] == index) != (piece[sides[1]] == index) && s->cohesive.facet_cohesive[f] < 0)
            facets[count++] = f;
    }
    check_ok(shv_cohesive_insert(&s->cohesive, &s->state, NULL, facets, count, &duplicated, &s->error), s->error);
    for (int32_t e = 0; e < s->state.element_count; e++)
        if (piece[e] == index) s->state.element_fragment[e] = s->bodies.fragment_count;
    s->awake[s->bodies.fragment_count++] = 1;
    surfaces_relist(s);
    shv_release(facets);
}

static void wake_coupled_body(Surfaces *s, int32_t index)
{
    const ShvCoupledBody *coupled_body = s->coupled_bodies[index];
    const ShvObject *object = &s->model.objects[index];
    for (int32_t i = object->node_begin; i < object->node_end; i++) {
        const ShvVec3 reference = shv_load3(s->state.reference + 3 * (int64_t)i);
        const ShvVec3 x = shv_coupled_body_point(coupled_body, reference);
        shv_store3(s->state.displacement + 3 * (int64_t)i, shv_sub(x, reference));
        shv_store3(s->state.velocity + 3 * (int64_t)i, shv_coupled_body_velocity(coupled_body, x));
    }
    s->coupled_bodies[index] = NULL;
    s->awake[index] = 1;
    surfaces_relist(s);
    shv_surface_contact_wake(&s->contact);
}

/* A block comes to pieces one by one while it runs into two coupled bodies, which run into each other too, and one of which wakes:
   candidates go on without new lists unless too many nodes are split at once, and nothing is missed. Neighbours in place are left
   out: they have nothing to do with each other by intention; so are coupled bodies among themselves, which are looked at now and then. */
static void test_lists_go_on(void **state)
{
    (void)state;
    enum { ROOM = 4000, PIECES = 12, PAUSE = 12 };
    static ShvFacetPair expected[ROOM];
    static EdgePairs edges;
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, 0.04, 0.04, 0.04, 0.01);
    ShvObjectDefinition *other = surfaces_box(&s, 0.03, 0.05, 0.03, 0.0125);
    surfaces_place(other, shv_vec3(0.003, 0.002, 0.035001), shv_vec3(0.0, 0.0, 0.0));
    surfaces_place(surfaces_box(&s, 0.03, 0.05, 0.05, 0.0125), shv_vec3(0.035001, 0.001, 0.002),
                   shv_vec3(0.0, 0.0, 0.0));
    surfaces_build(&s, 0.3, false);
    surfaces_make_coupled_body(&s, 1, shv_vec3(0.8, 0.1, -3.0), shv_vec3(0.0, 0.0, 0.0));
    surfaces_make_coupled_body(&s, 2, shv_vec3(-3.0, 0.0, 0.3), shv_vec3(1.0, 2.0, 0.0));
    int32_t *piece = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)s.state.element_count, sizeof(int32_t));
    for (int32_t e = 0; e < s.state.element_count; e++)
        piece[e] = e < s.model.objects[0].element_end ? 1 + e * 7 % PIECES : 0;
    const double step = surfaces_stable_step(&s);
    int64_t crossed = 0, found = 0, kept = 0, copies = 0;
    const int32_t nodes = s.state.node_count; /* later ones are copies */
    for (int k = 0; k < PAUSE * (PIECES + 4); k++) {
        const bool changed = k % PAUSE == 0 && k > 0 && k / PAUSE <= PIECES;
        if (changed) cut_off(&s, piece, k / PAUSE);
        if (k == PAUSE * 3 + 1) wake_coupled_body(&s, 2);
        const int64_t rebuilds = s.contact.rebuilds;
        surfaces_forces(&s);
        check_ok(shv_surface_contact_begin(&s.contact, &s.bodies, step, &s.error), s.error);
        kept += (changed || k == PAUSE * 3 + 1) && rebuilds == s.contact.rebuilds;
        shv_motion_kick(&s.state, s.nodes, s.node_count, 0.5 * (s.state.last_step + step), s.gravity, 1);
        const int32_t count = brute_force(&s, step, expected, ROOM);
        find_edges(&s, step, &edges);
        check_ok(shv_surface_contact_apply(&s.contact, &s.bodies, step, &s.error), s.error);
        for (int32_t i = 0; i < count; i++)
            assert_true(in_place(&s, &expected[i]) || both_rigid(&s, expected[i].fragments) ||
                        is_listed(&s.contact, &expected[i]));
        for (int32_t i = 0; i < count; i++)
            copies +=
                expected[i].nodes[0] >= nodes && !are_neighbours(&s.state, expected[i].element, expected[i].nodes[0]);
        found += count;
        crossed += check_edges(&s, &edges);
        surfaces_drift(&s, step);
    }
    assert_true(copies > 10);
    assert_true(kept > PIECES / 3);
    assert_true(found > 100);
    assert_true(crossed > 50);
    shv_release(piece);
    surfaces_release(&s);
}

/* One awake fragment without parted cracks: nothing is allocated. */
static void test_idle(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, 0.04, 0.04, 0.04, 0.01)->placement.angular_velocity[0] = 5.0;
    surfaces_ball(&s, 0.02, 0.006); /* overlaps, and sleeps */
    surfaces_build(&s, 0.3, false);
    s.awake[1] = 0;
    surfaces_list_nodes(&s);
    surfaces_step(&s, 2e-5);
    const int64_t requests = shv_memory_requests(s.memory);
    for (int k = 0; k < 20; k++) surfaces_step(&s, 2e-5);
    assert_true(s.contact.idle);
    assert_int_equal(shv_memory_requests(s.memory), requests);
    assert_null(s.contact.list.nodes);
    assert_null(s.contact.candidates[0].items);
    surfaces_release(&s);
}

/* Times that all candidates are chosen anew while two bodies meet that fly together, `floor`: far above one. */
static int64_t rebuilds_of_a_pair(ShvVec3 together, bool floor)
{
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_ball(&s, 0.02, 0.006), shv_vec3(-0.021, 0.0, 10.0),
                   shv_add(together, shv_vec3(2.0, 0.0, 0.0)));
    surfaces_place(surfaces_box(&s, 0.03, 0.03, 0.03, 0.012), shv_vec3(0.016, 0.0, 10.0),
                   shv_add(together, shv_vec3(-2.0, 0.0, 0.0)));
    surfaces_build(&s, 0.3, floor);
    const double step = surfaces_stable_step(&s);
    for (int k = 0; k < 300; k++) surfaces_step(&s, step);
    const int64_t rebuilds = s.contact.rebuilds;
    surfaces_release(&s);
    return rebuilds;
}

/* What two bodies cost is what they do to each other: how fast they fly together does not count, nor do obstacles that are out of
   reach. */
static void test_common_motion(void **state)
{
    (void)state;
    const ShvVec3 none = shv_vec3(0.0, 0.0, 0.0), fast = shv_vec3(30.0, 40.0, 0.0);
    const int64_t alone = rebuilds_of_a_pair(none, false);
    assert_true(alone > 0);
    assert_int_equal(rebuilds_of_a_pair(fast, false), alone);
    assert_int_equal(rebuilds_of_a_pair(none, true), alone);
    assert_true(rebuilds_of_a_pair(fast, true) <= alone + 3); /* 256 steps each with the floor in mind */
}

/* Fails at every allocation in turn, and goes on when there is memory again. */
static void test_out_of_memory(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_box(&s, 0.04, 0.04, 0.04, 0.01)->placement.position[2] = 0.02;
    surfaces_build(&s, 0.3, false);
    cut(&s, 1.0, 0.0);
    surfaces_forces(&s);
    surfaces_part(&s);
    for (int64_t i = 0; i < 3 * (int64_t)s.state.node_count; i++) s.state.velocity[i] = i % 2 ? 1.0 : -1.0;
    int failures = 0;
    for (int64_t allowed = 0;; allowed++) {
        shv_memory_fail_after(s.memory, allowed);
        shv_surface_contact_invalidate(&s.contact);
        ShvStatus status = shv_surface_contact_begin(&s.contact, &s.bodies, 1e-5, &s.error);
        if (status == SHV_OK) status = shv_surface_contact_apply(&s.contact, &s.bodies, 1e-5, &s.error);
        if (status == SHV_OK) break;
        assert_int_equal(status, SHV_NO_MEMORY);
        failures++;
        /* Nothing is kept between tries, so that every allocation is met. */
        shv_memory_fail_after(s.memory, -1);
        shv_surface_contact_release(&s.contact);
        check_ok(shv_surface_contact_create(&s.contact, s.memory, &s.model, 0.3, &s.error), s.error);
    }
    shv_memory_fail_after(s.memory, -1);
    assert_true(failures > 12);
    assert_true(s.contact.pair_count > 0);
    surfaces_release(&s);
}

static void test_friction_is_checked(void **state)
{
    (void)state;
    ShvSurfaceContact contact;
    ShvError error;
    check_fails(shv_surface_contact_create(&contact, NULL, NULL, -0.1, &error), SHV_BAD_INPUT, error, "friction");
    check_fails(shv_surface_contact_create(&contact, NULL, NULL, (double)NAN, &error), SHV_BAD_INPUT, error,
                "friction");
}

/* Motion that grows without bound is an error, and does not make everything a neighbour of everything. */
static void test_unstable_motion(void **state)
{
    (void)state;
    Surfaces s;
    surfaces_define(&s);
    surfaces_place(surfaces_box(&s, 0.04, 0.04, 0.04, 0.01), shv_vec3(-0.021, 0.0, 0.0), shv_vec3(2.0, 0.0, 0.0));
    surfaces_place(surfaces_box(&s, 0.04, 0.04, 0.04, 0.01), shv_vec3(0.021, 0.003, 0.0), shv_vec3(-2.0, 0.0, 0.0));
    surfaces_build(&s, 0.0, false);
    const double step = surfaces_stable_step(&s);
    for (int i = 0; i < 8; i++) surfaces_step(&s, step);
    for (int32_t i = 0; i < s.state.node_count; i++)
        s.state.velocity[3 * (int64_t)i] = (i % 2 ? -1e3 : 1e3) * 0.01 / step;
    ShvStatus status = SHV_OK;
    for (int i = 0; i < 8 && status == SHV_OK; i++) {
        status = shv_surface_contact_begin(&s.contact, &s.bodies, step, &s.error);
        s.state.time += step;
    }
    assert_int_equal(status, SHV_DIVERGED);
    assert_non_null(strstr(s.error.message, "fracture.safety"));
    surfaces_release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bars_exchange_velocities),
                                       cmocka_unit_test(test_cubes_head_on),
                                       cmocka_unit_test(test_balls_oblique),
                                       cmocka_unit_test(test_ball_on_plate),
                                       cmocka_unit_test(test_cube_on_coupled_body),
                                       cmocka_unit_test(test_coupled_bodies),
                                       cmocka_unit_test(test_coupled_body_on_floor),
                                       cmocka_unit_test(test_halves_rest),
                                       cmocka_unit_test(test_parted_halves_collide),
                                       cmocka_unit_test(test_slit_closes),
                                       cmocka_unit_test(test_rubble_stands),
                                       cmocka_unit_test(test_rubble_falls),
                                       cmocka_unit_test(test_threads),
                                       cmocka_unit_test(test_steps_thrown_away),
                                       cmocka_unit_test(test_nothing_is_missed),
                                       cmocka_unit_test(test_late_cracks),
                                       cmocka_unit_test(test_lists_go_on),
                                       cmocka_unit_test(test_idle),
                                       cmocka_unit_test(test_common_motion),
                                       cmocka_unit_test(test_out_of_memory),
                                       cmocka_unit_test(test_friction_is_checked),
                                       cmocka_unit_test(test_unstable_motion)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
