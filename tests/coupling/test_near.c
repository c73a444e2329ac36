/* Where a deforming fragment is: its grid against the boxes of all its tets, one by one. */
#include "coupling/stage.h"

#include <stdlib.h>

#include "base/random.h"
#include "coupling/near.h"

/* Positions are below 1 m; products of 16 cells and differences cost a few units in their last place, 2.2e-16 m. */
static const double rounding = 1e-14;

/* Spheres, and how many of them must show each outcome, so that none goes untried. */
enum { SPHERES = 5000, LEAST = 100 };

static ShvBox box_of_tet(const ShvState *state, int32_t element)
{
    ShvBox box = shv_box_empty();
    for (int corner = 0; corner < 4; corner++)
        shv_box_add(&box, shv_state_position(state, shv_state_node(state, element, corner)));
    return box;
}

/* One a tet; the caller frees them. */
static ShvBox *boxes_of_fragment(const ShvHybrid *hybrid, const ShvFragment *fragment, ShvBox *whole)
{
    ShvBox *boxes = malloc((size_t)fragment->element_count * sizeof *boxes);
    assert_non_null(boxes);
    *whole = shv_box_empty();
    for (int32_t k = 0; k < fragment->element_count; k++) {
        boxes[k] = box_of_tet(&hybrid->state, hybrid->fragments.elements[fragment->element_begin + k]);
        shv_box_add(whole, boxes[k].low);
        shv_box_add(whole, boxes[k].high);
    }
    return boxes;
}

static double outside(double low, double high, double x)
{
    return x < low ? low - x : x > high ? x - high : 0.0;
}

static double squared_distance(const ShvBox *box, ShvVec3 x)
{
    const double dx = outside(box->low.x, box->high.x, x.x), dy = outside(box->low.y, box->high.y, x.y);
    const double dz = outside(box->low.z, box->high.z, x.z);
    return dx * dx + dy * dy + dz * dz;
}

static double distance_to_nearest(const ShvBox *boxes, int32_t count, ShvVec3 x)
{
    double nearest = HUGE_VAL;
    for (int32_t k = 0; k < count; k++) {
        const double squared = squared_distance(&boxes[k], x);
        if (squared < nearest) nearest = squared;
    }
    return sqrt(nearest);
}

static double largest_speed(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const ShvState *state = &hybrid->state;
    double largest = 0.0;
    for (int32_t k = 0; k < fragment->element_count; k++)
        for (int corner = 0; corner < 4; corner++) {
            const int32_t element = hybrid->fragments.elements[fragment->element_begin + k];
            const int64_t node = shv_state_node(state, element, corner);
            largest = fmax(largest, shv_norm(shv_load3(state->velocity + 3 * node)));
        }
    return largest;
}

/* The sphere's centre is drawn from the fragment's box with half its largest side around; radii up to a fifth of that side. */
static void draw(uint64_t i, const ShvBox *box, ShvVec3 *centre, double *radius)
{
    const double size = shv_box_size(box);
    const ShvBox room = shv_box_grown(*box, 0.5 * size);
    *centre = shv_vec3(room.low.x + (room.high.x - room.low.x) * shv_random_uniform(7, 4 * i),
                       room.low.y + (room.high.y - room.low.y) * shv_random_uniform(7, 4 * i + 1),
                       room.low.z + (room.high.z - room.low.z) * shv_random_uniform(7, 4 * i + 2));
    *radius = 0.2 * size * shv_random_uniform(7, 4 * i + 3);
}

/* A marked cell holds a point of a tet's box, so it lies within a cell's diagonal of that; spheres in between may be either.
   Returns how many spheres meet the fragment's box and yet none of its cells. */
static int compare_fragment(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    ShvNear near;
    shv_near_find(hybrid, fragment, &near);
    ShvBox box, *boxes = boxes_of_fragment(hybrid, fragment, &box);
    assert_memory_equal(&near.box, &box, sizeof box);
    assert_true(near.speed == largest_speed(hybrid, fragment));
    const double diagonal = shv_norm(shv_sub(box.high, box.low)) / SHV_NEAR_CELLS;
    int meet = 0, miss = 0, left_out = 0;
    for (uint64_t i = 0; i < SPHERES; i++) {
        ShvVec3 centre;
        double radius;
        draw(i, &box, &centre, &radius);
        const double gap = distance_to_nearest(boxes, fragment->element_count, centre) - radius;
        const bool near_says = shv_near_meets(&near, centre, radius);
        if (gap < -rounding) assert_true(near_says);
        if (gap > diagonal + rounding) assert_false(near_says);
        meet += gap < -rounding;
        miss += gap > diagonal + rounding;
        left_out += !near_says && squared_distance(&box, centre) < radius * radius;
    }
    free(boxes);
    assert_true(meet > LEAST && miss > LEAST);
    return left_out;
}

/* An object, a hundred times as strong as others, strikes the floor and deforms in one piece: that piece once it is awake. */
static const ShvFragment *awake(ShvHybrid *hybrid, Stage *stage, ShvObjectDefinition *object)
{
    ShvError error = {SHV_OK, ""};
    object->placement.velocity[2] = -1.0;
    object->placement.angular_velocity[1] = 3.0;
    stage->material.cohesive_strength *= 100.0;
    stage->material.fracture_energy *= 1e4; /* a cohesive zone of the same length */
    stage->scene.rigid.wake = SHV_WAKE_CONTACT;
    stage_floor(stage);
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
    int64_t taken = 0;
    for (int step = 0; step < 2000 && hybrid->awake.count == 0; step++)
        check_ok(shv_hybrid_advance(hybrid, stage->scene.duration, 1, &taken, &error), error);
    check_ok(shv_hybrid_advance(hybrid, stage->scene.duration, 3, &taken, &error), error);
    assert_int_equal(hybrid->fragments.count, 1);
    assert_true(hybrid->awake.flags[0]);
    return &hybrid->fragments.items[0];
}

/* What its box surrounds is not all near: the inside of a ball, the corners around it. */
static void a_hollow_ball_is_empty_inside(void **unused)
{
    (void)unused;
    Stage stage;
    stage_make(&stage);
    ShvObjectDefinition *object = stage_box(&stage, "ball", (const double[3]){0.0, 0.0, 0.0}, 0.012, 0.051);
    object->mesh.kind = SHV_MESH_HOLLOW_BALL;
    object->mesh.radius = 0.05;
    object->mesh.inner_radius = 0.04;
    ShvHybrid hybrid;
    const ShvFragment *fragment = awake(&hybrid, &stage, object);
    assert_true(compare_fragment(&hybrid, fragment) > LEAST);
    ShvNear near;
    shv_near_find(&hybrid, fragment, &near);
    const ShvVec3 middle = shv_scale(shv_add(near.box.low, near.box.high), 0.5);
    assert_false(shv_near_meets(&near, middle, 0.01));
    assert_true(shv_near_meets(&near, middle, 0.045));
    shv_hybrid_release(&hybrid);
}

/* A plate of bricks, square across `axis`: of one layer, each of whose tets reaches from face to face. */
static ShvObjectDefinition *plate(Stage *stage, int axis, double height)
{
    double size[3] = {0.1, 0.1, 0.1};
    size[axis] = 0.01;
    ShvObjectDefinition *object = stage_box(stage, "plate", size, 0.01, height);
    object->mesh.pattern = SHV_PATTERN_BRICKS;
    return object;
}

/* Tilted, so that its box is mostly empty. */
static void a_plate_one_tet_thick(void **unused)
{
    (void)unused;
    Stage stage;
    stage_make(&stage);
    ShvObjectDefinition *object = plate(&stage, 2, 0.04);
    object->placement.rotation_axis[0] = 0.0;
    object->placement.rotation_axis[1] = 1.0;
    object->placement.rotation_axis[2] = 0.0;
    object->placement.rotation_degrees = 40.0;
    ShvHybrid hybrid;
    const ShvFragment *fragment = awake(&hybrid, &stage, object);
    assert_true(compare_fragment(&hybrid, fragment) > LEAST);
    shv_hybrid_release(&hybrid);
}

static void check_layer(const ShvMesh *mesh, int axis)
{
    for (int32_t element = 0; element < mesh->element_count; element++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int corner = 0; corner < 4; corner++) {
            const double x = mesh->positions[3 * mesh->elements[4 * element + corner] + axis];
            low = fmin(low, x);
            high = fmax(high, x);
        }
        check_near(high - low, 0.01, rounding);
    }
}

/* Its box lies along the axes and has hardly any extent, then none at all, along each of them in turn. */
static void a_fragment_without_extent(void **unused)
{
    (void)unused;
    for (int axis = 0; axis < 3; axis++) {
        Stage stage;
        stage_make(&stage);
        ShvHybrid hybrid;
        const ShvFragment *fragment = awake(&hybrid, &stage, plate(&stage, axis, 0.051));
        check_layer(&hybrid.model.mesh, axis);
        compare_fragment(&hybrid, fragment);
        for (int32_t i = 0; i < hybrid.state.node_count; i++)
            hybrid.state.displacement[3 * i + axis] = -hybrid.state.reference[3 * i + axis];
        ShvNear near;
        shv_near_find(&hybrid, fragment, &near);
        const double cell[3] = {near.cell.x, near.cell.y, near.cell.z};
        assert_true(cell[axis] == 0.0);
        compare_fragment(&hybrid, fragment);
        shv_hybrid_release(&hybrid);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hollow_ball_is_empty_inside),
        cmocka_unit_test(a_plate_one_tet_thick),
        cmocka_unit_test(a_fragment_without_extent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
