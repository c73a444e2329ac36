/* Facets against obstacles between their nodes. */
#include "check.h"

#include "shape/feature.h"
#include "shape/scene.h"

/* Of a random facet on one side of an obstacle. */
static ShvFacetShape random_facet(const ShvObstacle *obstacle, uint64_t *index)
{
    ShvFacetShape facet = {.apex = {0.0, 0.0, 0.0}};
    const ShvVec3 centre = shv_scale(shv_unit(draw_vector(3, index, 1.0)), draw(3, index, 0.5, 1.2));
    for (int k = 0; k < 3; k++)
        facet.corners[k] = shv_add(shv_add(obstacle->position, centre), draw_vector(3, index, 0.7));
    return facet;
}

/* The least distance of a facet's points by looking at many of them. The facet's tet is given the far side of that point. */
static double sampled_gap(const ShvObstacle *obstacle, ShvFacetShape *facet, int cells)
{
    double least = HUGE_VAL;
    for (int i = 0; i <= cells; i++)
        for (int j = 0; i + j <= cells; j++) {
            const double a = (double)i / cells, b = (double)j / cells;
            const ShvVec3 at = shv_add(shv_add(shv_scale(facet->corners[0], a), shv_scale(facet->corners[1], b)),
                                       shv_scale(facet->corners[2], 1.0 - a - b));
            const ShvSurfacePoint nearest = shv_obstacle_closest(obstacle, at, HUGE_VAL);
            if (nearest.gap < least) facet->apex = shv_add(at, nearest.normal);
            least = fmin(least, nearest.gap);
        }
    return least;
}

static double node_gap(const ShvObstacle *obstacle, const ShvFacetShape *facet)
{
    double least = HUGE_VAL;
    for (int k = 0; k < 3; k++) least = fmin(least, shv_obstacle_closest(obstacle, facet->corners[k], HUGE_VAL).gap);
    return least;
}

/* The least gap that features show; points are where they say. */
static double feature_gap(const ShvObstacle *obstacle, const ShvFacetShape *facet, double *distance)
{
    double least = HUGE_VAL;
    if (distance) *distance = HUGE_VAL;
    for (int32_t f = 0; f < obstacle->feature_count; f++) {
        ShvFeaturePoint points[3];
        const int count = shv_feature_meet(obstacle, &obstacle->features[f], facet, HUGE_VAL, points);
        if (distance) *distance = fmin(*distance, shv_feature_distance(obstacle, &obstacle->features[f], facet));
        for (int k = 0; k < count; k++) {
            ShvVec3 on_facet = {0.0, 0.0, 0.0};
            for (int c = 0; c < 3; c++) on_facet = shv_madd(on_facet, points[k].weights[c], facet->corners[c]);
            const ShvVec3 expected = shv_madd(points[k].point, points[k].gap, points[k].normal);
            check_near(shv_norm(shv_sub(on_facet, expected)), 0.0, 1e-9);
            check_near(shv_obstacle_closest(obstacle, points[k].point, HUGE_VAL).gap, 0.0, 1e-9);
            least = fmin(least, points[k].gap);
        }
    }
    return least;
}

static double exact_gap(const ShvObstacle *obstacle, const ShvFacetShape *facet)
{
    double distance;
    feature_gap(obstacle, facet, &distance);
    return fmin(node_gap(obstacle, facet), distance);
}

/* Moves a facet, whose apex stands straight out, closer at a slant, by no more than it has room each time. */
static double approach(const ShvObstacle *obstacle, ShvFacetShape *facet, uint64_t *index)
{
    const ShvVec3 out = shv_obstacle_closest(obstacle, facet->apex, HUGE_VAL).normal;
    const ShvVec3 way = shv_unit(shv_madd(draw_vector(3, index, 0.3), -1.0, out));
    double gap = exact_gap(obstacle, facet);
    for (int i = 0; i < 100 && gap > 1e-6; i++) {
        for (int k = 0; k < 3; k++) facet->corners[k] = shv_madd(facet->corners[k], gap, way);
        facet->apex = shv_madd(facet->apex, gap, way);
        gap = exact_gap(obstacle, facet);
    }
    return gap;
}

/* With the nodes, the distances of features are that of the facet. Where it has come close, their points say the same. */
static void check_distances(ShvObstacleDefinition *definition)
{
    enum { FACETS = 300, CELLS = 120 };
    ShvSceneDefinition scene = shv_scene_default();
    ShvObstacles obstacles;
    ShvError error = {SHV_OK, ""};
    uint64_t index = 0;
    int between = 0, missed = 0;
    turn(definition, shv_vec3(1.0, 0.4, 0.3), 40.0);
    scene.obstacles = definition;
    scene.obstacle_count = 1;
    check_ok(shv_obstacles_create(&obstacles, NULL, &scene, NULL, &error), error);
    const ShvObstacle *obstacle = &obstacles.items[0];
    for (int i = 0; i < FACETS; i++) {
        ShvFacetShape facet = random_facet(obstacle, &index);
        const double sampled = sampled_gap(obstacle, &facet, CELLS);
        if (sampled <= 0.02) continue;
        const double gap = exact_gap(obstacle, &facet);
        assert_true(gap <= sampled + 1e-12 && gap > sampled - 0.01); /* a cell's half diagonal */
        if (approach(obstacle, &facet, &index) > 1e-6) continue;     /* it has gone by */
        const double features = feature_gap(obstacle, &facet, NULL), nodes = node_gap(obstacle, &facet);
        between += features < nodes;
        missed += !(fmin(nodes, features) < 1e-5);
    }
    assert_true(between > FACETS / 10);
    assert_true(missed <= FACETS / 100); /* by what comes within the rims of both edges */
    shv_obstacles_release(&obstacles);
}

static void test_distances(void **state)
{
    (void)state;
    ShvObstacleDefinition definition = box_definition("box", shv_vec3(0.4, 0.2, 0.3), shv_vec3(0.1, 0.2, 0.3));
    check_distances(&definition);
    definition = sphere_definition("ball", 0.2, shv_vec3(0.1, 0.2, 0.3));
    check_distances(&definition);
}

/* A box given as a mesh has the same corners and edges; the diagonals of its faces are none. The inner edge of an angle is
   concave, and nothing. */
static void test_what_counts(void **state)
{
    (void)state;
    const SurfaceFile box = surface_file(box_text), angle = surface_file(angle_text);
    ShvObstacleDefinition definitions[5] = {box_definition("box", shv_vec3(2.0, 1.0, 0.5), shv_vec3(0.0, 0.0, 0.0)),
                                            mesh_definition("box as a mesh", box.path, shv_vec3(0.0, 0.0, 0.0)),
                                            mesh_definition("angle", angle.path, shv_vec3(0.0, 0.0, 0.0)),
                                            sphere_definition("ball", 0.1, shv_vec3(0.0, 0.0, 0.0)),
                                            plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0)};
    const int32_t expected[5] = {20, 20, 12 + 17, 1, 0};
    ShvSceneDefinition scene = shv_scene_default();
    ShvObstacles obstacles;
    ShvError error = {SHV_OK, ""};
    scene.obstacles = definitions;
    scene.obstacle_count = 5;
    check_ok(shv_obstacles_create(&obstacles, NULL, &scene, NULL, &error), error);
    for (int k = 0; k < 5; k++) assert_int_equal(obstacles.items[k].feature_count, expected[k]);
    const ShvVec3 above = {0.0, 0.0, 0.15};
    assert_true(shv_features_matter(&obstacles.items[3], 0.1, above, 0.1));    /* edges of 0.17 */
    assert_false(shv_features_matter(&obstacles.items[3], 0.02, above, 0.1));  /* edges of 0.035 */
    assert_false(shv_features_matter(&obstacles.items[0], 0.02, above, 0.02)); /* over the middle of a face */
    shv_obstacles_release(&obstacles);
    remove_surface_file(&box);
    remove_surface_file(&angle);
}

/* A corner, an edge and a pin that have gone a little way into a facet push it straight out. */
static void test_overlaps(void **state)
{
    (void)state;
    ShvObstacleDefinition definitions[2] = {box_definition("box", shv_vec3(1.0, 1.0, 1.0), shv_vec3(0.0, 0.0, -0.5)),
                                            sphere_definition("pin", 0.1, shv_vec3(5.0, 0.0, -0.1))};
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    for (int k = 0; k < 2; k++) {
        const double x = k == 0 ? 0.0 : 5.0, depth = 1e-3;
        const ShvFacetShape facet = {.corners = {{x - 3.0, -2.0, -depth}, {x + 3.0, -2.5, -depth}, {x, 4.0, -depth}},
                                     .apex = {x, 0.0, 2.0}};
        int count = 0;
        for (int32_t f = 0; f < obstacles.items[k].feature_count; f++) {
            ShvFeaturePoint points[3];
            count += shv_feature_meet(&obstacles.items[k], &obstacles.items[k].features[f], &facet, 0.0, points);
            if (count == 0) continue;
            check_near(points[0].gap, -depth, 1e-12);
            check_near(points[0].normal.z, 1.0, 1e-12);
        }
        assert_int_equal(count, k == 0 ? 4 : 1); /* the four corners of the box's top */
    }
    shv_obstacles_release(&obstacles);
}

static int count_of_overlaps(const ShvObstacle *obstacle, const ShvFacetShape *facet)
{
    int count = 0;
    for (int32_t f = 0; f < obstacle->feature_count; f++) {
        ShvFeaturePoint points[3];
        count += shv_feature_meet(obstacle, &obstacle->features[f], facet, 0.0, points);
    }
    return count;
}

/* A splinter stands over a small box. The box's lower corners are behind the splinter's upper facet, and nearer to it than half its tet
   reaches, but they are out again below: unless the body goes on there. */
static void test_beyond_a_free_face(void **state)
{
    (void)state;
    const ShvObstacleDefinition definition = box_definition("box", shv_vec3(1.6, 1.6, 1.6), shv_vec3(0.0, 0.0, -0.8));
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    ShvFacetShape facet = {.corners = {{-1.31, 1.09, 0.16}, {-2.05, -8.85, -0.66}, {3.49, -4.68, 4.78}},
                           .apex = {8.44, -9.64, -0.56},
                           .free = 4}; /* that opposite to the third corner, below */
    assert_int_equal(count_of_overlaps(obstacles.items, &facet), 0);
    facet.free = 0;
    assert_int_equal(count_of_overlaps(obstacles.items, &facet), 2);
    shv_obstacles_release(&obstacles);
}

/* An edge of a facet crosses an edge of a box beyond a node that lies on its top, a billionth deep. Only what the node is deeper in
   than the edge is left to it. */
static void test_edge_beside_a_node(void **state)
{
    (void)state;
    const ShvObstacleDefinition definition = box_definition("box", shv_vec3(1.0, 1.0, 1.0), shv_vec3(0.0, 0.0, -0.5));
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    ShvFacetShape facet = {.corners = {{0.2, 0.0, -1e-9}, {0.8, 0.05, -2e-3}, {0.5, 3.0, 0.2}},
                           .apex = {0.5, 1.0, 2.0}};
    assert_int_equal(count_of_overlaps(obstacles.items, &facet), 1);
    check_near(feature_gap(obstacles.items, &facet, NULL), -1e-3, 1e-5);
    facet.corners[0].z = -5e-3;
    assert_int_equal(count_of_overlaps(obstacles.items, &facet), 0);
    shv_obstacles_release(&obstacles);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_distances), cmocka_unit_test(test_what_counts),
                                       cmocka_unit_test(test_overlaps), cmocka_unit_test(test_beyond_a_free_face),
                                       cmocka_unit_test(test_edge_beside_a_node)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
