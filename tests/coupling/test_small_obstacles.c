/* Obstacles smaller than an edge, and edges of larger ones: every hit is felt, in flight and in fracture mode. */
#include "contact/inside.h"
#include "coupling/stage.h"

#include "coupling/hybrid.h"
#include "shape/feature.h"

enum { SHAPES = 5 };
static const double edge = 0.01;

/* Box of 16 mm, spheres of 8, 3 and 1.5 mm radius, box of 1.6 mm, with their tops at z = 0. */
static ShvObstacleDefinition obstacle_of(int shape)
{
    static const double sizes[SHAPES] = {0.016, 8e-3, 3e-3, 1.5e-3, 1.6e-3};
    const double size = sizes[shape];
    ShvObstacleDefinition obstacle = shv_obstacle_default();
    obstacle.name = "anvil";
    obstacle.friction = 0.4;
    obstacle.shape = shape == 0 || shape == SHAPES - 1 ? SHV_OBSTACLE_BOX : SHV_OBSTACLE_SPHERE;
    obstacle.radius = size;
    for (int k = 0; k < 3; k++) obstacle.size[k] = size;
    obstacle.placement.position[2] = obstacle.shape == SHV_OBSTACLE_BOX ? -0.5 * size : -size;
    return obstacle;
}

/* A bar of 200 × 20 × 20 mm that comes down on the obstacle, off its own nodes. */
static void stage_bar(Stage *stage, ShvRigidEngine engine, int shape, double speed)
{
    stage_make(stage);
    ShvObjectDefinition *bar = stage_box(stage, "bar", (const double[3]){0.2, 0.02, 0.02}, edge, 0.0105);
    bar->placement.position[0] = 2.1e-3;
    bar->placement.position[1] = 2.7e-3;
    bar->placement.velocity[2] = -speed;
    stage->obstacles[stage->scene.obstacle_count++] = obstacle_of(shape);
    stage->scene.rigid.engine = engine;
    stage->scene.duration = 0.5e-3 / speed + 0.012;
}

/* How deep facets of awake pieces, or of what flies as it was made, are in the obstacle between their nodes, m. */
static double deepest(const ShvHybrid *hybrid)
{
    const ShvObstacle *obstacle = &hybrid->obstacles.items[0];
    double depth = 0.0;
    const ShvAdjacency *adjacency = &hybrid->model.adjacency;
    for (int64_t k = adjacency->interior_count; k < adjacency->facet_count; k++) {
        const int32_t element = adjacency->facet_elements[2 * k], face = adjacency->facet_faces[2 * k];
        if (!hybrid->awake.flags[hybrid->state.element_fragment[element]]) continue;
        ShvFacetShape facet = {.apex =
                                   shv_state_position(&hybrid->state, shv_state_node(&hybrid->state, element, face))};
        for (int c = 0; c < 3; c++)
            facet.corners[c] =
                shv_state_position(&hybrid->state, shv_state_node(&hybrid->state, element, shv_face_corners[face][c]));
        for (int32_t f = 0; f < obstacle->feature_count; f++) {
            ShvFeaturePoint points[3];
            const int count = shv_feature_meet(obstacle, &obstacle->features[f], &facet, 0.0, points);
            for (int i = 0; i < count; i++) depth = fmax(depth, -points[i].gap);
        }
    }
    return depth;
}

/* The whole bar as it moves now. */
static ShvFragment now(const ShvHybrid *hybrid)
{
    ShvFragment bar = hybrid->fragments.items[0];
    if (bar.mode == SHV_MODE_FRACTURE) shv_fragment_fit(&bar, &hybrid->fragments, &hybrid->state);
    return bar;
}

/* Whether the bar breaks; it never goes into the obstacle by more than 2 % of an edge, and its middle stays above it as long as
   the bar is whole. */
static bool breaks(ShvRigidEngine engine, int shape, double speed)
{
    Stage stage;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    stage_bar(&stage, engine, shape, speed);
    check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
    for (int part = 1; part <= 60; part++) {
        int64_t taken = 0;
        check_ok(shv_hybrid_advance(&hybrid, stage.scene.duration * part / 60.0, 0, &taken, &error), error);
        assert_true(deepest(&hybrid) <= 0.02 * edge);
        if (hybrid.fragments.count == 1) assert_true(now(&hybrid).position.z > 0.0095);
    }
    assert_true(fabs(hybrid.observer.balance.residual) <= 1e-3 * hybrid.observer.balance.largest);
    const bool broken = hybrid.fragments.count > 1;
    if (!broken) assert_true(now(&hybrid).velocity.z > 0.0); /* it has been thrown back */
    shv_hybrid_release(&hybrid);
    return broken;
}

static void check_engine(ShvRigidEngine engine)
{
    for (int shape = 0; shape < SHAPES; shape++) {
        assert_false(breaks(engine, shape, 0.1));
        assert_true(breaks(engine, shape, 1.0));
    }
}

static void test_analytic(void **state)
{
    (void)state;
    check_engine(SHV_RIGID_ANALYTIC);
}

static void test_bullet(void **state)
{
    (void)state;
    check_engine(SHV_RIGID_BULLET);
}

/* A plank in fracture mode, pressed down by its weight, that glides over the edges of a smooth block, along and aslant: its flat face has
   nothing to do with the block's sides. */
static void test_glides_over_edges(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        Stage stage;
        ShvHybrid hybrid;
        ShvError error = {SHV_OK, ""};
        stage_make(&stage);
        ShvObjectDefinition *plank = stage_box(&stage, "plank", (const double[3]){0.3, 0.06, 0.03}, 0.012, 0.01501);
        plank->placement.position[0] = 1.3e-3;
        plank->placement.position[1] = -2.1e-3;
        plank->placement.velocity[k % 2] = -0.5;
        plank->placement.stretch_rate[0] = 1e-6; /* starts awake */
        ShvObstacleDefinition *block = &stage.obstacles[stage.scene.obstacle_count++];
        *block = shv_obstacle_default();
        block->name = "block";
        block->shape = SHV_OBSTACLE_BOX;
        block->size[0] = block->size[1] = 0.16;
        block->size[2] = 0.02;
        block->placement.position[2] = -0.01;
        block->placement.rotation_degrees = k < 2 ? 0.0 : 25.0;
        block->friction = 0.0;
        stage.scene.fracture.longest = 1e3;
        stage.scene.fracture.quiet_checks = INT32_MAX;
        stage.scene.duration = 0.03;
        check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
        int64_t taken = 0;
        check_ok(shv_hybrid_advance(&hybrid, stage.scene.duration, 0, &taken, &error), error);
        assert_int_equal(hybrid.fragments.count, 1);
        assert_int_equal(hybrid.fragments.items[0].mode, SHV_MODE_FRACTURE);
        const ShvVec3 velocity = now(&hybrid).velocity;
        check_near(velocity.x, k % 2 ? 0.0 : -0.5, 1e-4);
        check_near(velocity.y, k % 2 ? -0.5 : 0.0, 1e-4);
        shv_hybrid_release(&hybrid);
    }
}

/* A soft pad that drapes over the edge of a box, deep enough for its nodes to leave their skin: whether it can break or not, the edge is
   nowhere deeper in it than 1 % of an edge of the mesh. */
static void test_soft_pad_on_an_edge(void **state)
{
    (void)state;
    const double size = 6e-3, side = 0.03;
    for (int breakable = 0; breakable < 2; breakable++) {
        Stage stage;
        ShvHybrid hybrid;
        ShvError error = {SHV_OK, ""};
        stage_make(&stage);
        stage.material.density = 1100.0;
        stage.material.youngs_modulus = 5e6;
        stage.material.poissons_ratio = 0.45;
        stage.material.breakable = breakable;
        stage.material.cohesive_strength = 1e9;
        stage.material.fracture_energy = 1e6;
        ShvObjectDefinition *pad = stage_box(&stage, "pad", (const double[3]){0.06, 0.06, 0.018}, size, 9.1e-3);
        pad->placement.position[0] = 1.3e-3;
        pad->mesh.jitter = 0.2;
        pad->placement.velocity[2] = -2.0;
        pad->placement.stretch_rate[0] = 1e-6; /* starts awake */
        ShvObstacleDefinition *box = &stage.obstacles[stage.scene.obstacle_count++];
        *box = obstacle_of(0);
        box->size[0] = box->size[2] = side;
        box->size[1] = 0.2;
        box->placement.position[2] = -side * sqrt(0.5); /* its upper edge is the y axis */
        box->placement.rotation_axis[1] = 1.0;
        box->placement.rotation_axis[2] = 0.0;
        box->placement.rotation_degrees = 45.0;
        stage.scene.duration = 6e-3;
        check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
        const ShvSurfaceBodies bodies = {.state = &hybrid.state};
        double lowest = 0.0;
        for (int part = 1; part <= 30; part++) {
            int64_t taken = 0;
            check_ok(shv_hybrid_advance(&hybrid, stage.scene.duration * part / 30.0, 0, &taken, &error), error);
            assert_int_equal(hybrid.fragments.items[0].mode, SHV_MODE_FRACTURE);
            for (int k = 0; k <= 60; k++)
                assert_false(is_inside(&bodies, 0, shv_vec3(0.0, -0.03 + 1e-3 * k, -0.01 * size)));
            for (int32_t i = 0; i < hybrid.state.node_count; i++)
                lowest = fmin(lowest, shv_state_position(&hybrid.state, i).z);
        }
        assert_true(lowest < -0.2 * size); /* it has draped over the edge */
        shv_hybrid_release(&hybrid);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_analytic), cmocka_unit_test(test_bullet),
                                       cmocka_unit_test(test_glides_over_edges),
                                       cmocka_unit_test(test_soft_pad_on_an_edge)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
