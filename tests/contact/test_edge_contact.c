/* Surfaces that meet where their edges cross, and no node is near. */
#include "surfaces.h"

#include "shape/triangle.h"

static const double edge = 0.008, thickness = 0.004; /* m */

/* ---- how deep edges are in the other body ---- */

/* Whether a point is in a tet of a fragment. */
static bool is_inside(const Surfaces *s, int32_t fragment, ShvVec3 x)
{
    for (int32_t e = 0; e < s->state.element_count; e++) {
        ShvVec3 at[4];
        double least = (double)INFINITY;
        if (s->state.element_fragment[e] != fragment) continue;
        for (int k = 0; k < 4; k++) at[k] = shv_bodies_position(&s->bodies, shv_state_node(&s->state, e, k), fragment);
        for (int f = 0; f < 4; f++) {
            const ShvVec3 a = at[shv_face_corners[f][0]];
            const ShvVec3 area =
                shv_cross(shv_sub(at[shv_face_corners[f][1]], a), shv_sub(at[shv_face_corners[f][2]], a));
            least = fmin(least, -shv_dot(area, shv_sub(x, a)));
        }
        if (least > 0.0) return true;
    }
    return false;
}

/* From a point to the surface of a fragment. */
static double distance_to_surface(const Surfaces *s, int32_t fragment, ShvVec3 x)
{
    double least = (double)INFINITY;
    for (int32_t f = 0; f < s->contact.list.facet_count; f++) {
        const ShvSurfaceFacet *facet = &s->contact.list.facets[f];
        if (facet->fragment != fragment) continue;
        const ShvFacetShape shape = shv_surface_facet_shape(&s->bodies, facet->element, facet->face, fragment);
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
        const ShvFacetShape shape = shv_surface_facet_shape(&s->bodies, facet->element, facet->face, fragment);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i <= POINTS; i++) {
                const ShvVec3 a = shape.corners[k], b = shape.corners[(k + 1) % 3];
                const ShvVec3 x = shv_madd(a, (double)i / POINTS, shv_sub(b, a));
                if (shv_box_holds(&box, x) && is_inside(s, other, x))
                    deepest = fmax(deepest, distance_to_surface(s, other, x));
            }
    }
    return deepest;
}

/* ---- plates ---- */

typedef struct Crossing {
    double speed; /* m/s, towards each other */
    double drift; /* m/s, across that */
    double tilt;  /* degrees: of both plates about their edges: 0: narrow face on narrow face */
    double turn;  /* degrees: between their edges */
} Crossing;

/* Two plates on edge, the upper one along x, the lower one turned about z. */
static void define_plates(Surfaces *s, const Crossing *crossing)
{
    surfaces_define(s);
    s->material.density = 2400.0;
    s->material.youngs_modulus = 30e9;
    const double t = crossing->tilt * 3.14159265358979 / 180.0;
    const double half = 0.5 * (0.016 * cos(t) + thickness * sin(t)); /* m: of a plate's height */
    for (int k = 0; k < 2; k++) {
        ShvObjectDefinition *plate = surfaces_box(s, 0.064, thickness, 0.016, edge);
        const double way = k == 0 ? 1.0 : -1.0;
        surfaces_place(plate, shv_vec3(k == 0 ? 0.0039 : 0.0, 0.0, way * (half + 1e-5)),
                       shv_vec3(way * 0.5 * crossing->drift, 0.0, -way * 0.5 * crossing->speed));
        const ShvQuat tilt = shv_quat_exponential(shv_vec3(t, 0.0, 0.0));
        const ShvQuat turn = shv_quat_exponential(shv_vec3(0.0, 0.0, k * crossing->turn * 3.14159265358979 / 180.0));
        const ShvQuat q = shv_quat_multiply(turn, tilt);
        const double angle = 2.0 * acos(fmin(1.0, q.w));
        plate->placement.rotation_axis[0] = q.x;
        plate->placement.rotation_axis[1] = q.y;
        plate->placement.rotation_axis[2] = angle > 0.0 ? q.z : 1.0;
        plate->placement.rotation_degrees = angle * 180.0 / 3.14159265358979;
        /* The other plate's crossing between nodes. */
        if (k == 1) {
            const ShvVec3 along = shv_rotate(turn, shv_vec3(0.0035, 0.0, 0.0));
            plate->placement.position[0] += along.x;
            plate->placement.position[1] += along.y;
        }
    }
    surfaces_build(s, 0.3, false);
}

static double run_crossing(const Crossing *crossing, int steps)
{
    Surfaces s;
    define_plates(&s, crossing);
    const double step = surfaces_stable_step(&s);
    const Momentum start = surfaces_momentum(&s);
    const double energy = surfaces_kinetic(&s, s.state.velocity);
    double deepest = 0.0;
    int touched = 0;
    for (int k = 0; k < steps; k++) {
        surfaces_step(&s, step);
        touched += s.contact.touching > 0;
        check_momentum(&s, &start);
        if (k % (1 + steps / 200) == 0)
            deepest = fmax(deepest, fmax(depth_of_edges(&s, 0, 1), depth_of_edges(&s, 1, 0)));
        if (!(s.energy < 1.005 * energy)) fail_msg("energy %g J of %g J", s.energy, energy);
    }
    fprintf(stderr, "touched %d of %d, travel %g mm, mean v0 %g: ", touched, steps,
            1e3 * steps * step * crossing->speed, surfaces_mean_velocity(&s, 0).z);
    assert_true(s.gain <= 1e-13 * energy);
    assert_true(s.unbooked <= 1e-12 * energy);
    surfaces_release(&s);
    return deepest;
}

static void test_crossing(void **state)
{
    (void)state;
    const double speeds[] = {1.0, 5.0, 20.0}, tilts[] = {0.0, 10.0, 45.0, 80.0}, turns[] = {90.0, 45.0, 10.0, 3.0};
    for (int i = 0; i < 3; i++)
        for (int t = 0; t < 4; t++)
            for (int k = 0; k < 4; k++) {
                const Crossing c = {.speed = speeds[i], .tilt = tilts[t], .turn = turns[k]};
                const double d = run_crossing(&c, (int)(1e-3 / speeds[i] / 2e-7));
                fprintf(stderr, "v %g tilt %g turn %g: %g %%\n", speeds[i], tilts[t], turns[k], 100.0 * d / edge);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_crossing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
