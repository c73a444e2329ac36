/* No popping: a ball cut into 100 pieces by the nearest of random seeds. The pieces' hulls overlap at birth; that must push
   nothing apart, and the pieces must collide for real afterwards. */
#include "check.h"

#include "bullet_world.h"
#include "pieces.h"

enum { PIECES = 100 };
static const double radius = 0.1;

/* The ball in place, about the origin, in flight. */
static void cut_ball(World *world, bool floor)
{
    world_begin(world);
    world_ball(world, radius, 0.01);
    if (floor) {
        world_floor(world, 0.5, 0.0);
        world->definitions[0].plane_offset = -radius;
    }
    world_build(world);
    uint64_t index = 1;
    cut_by_seeds(world, PIECES, shv_vec3(radius, radius, radius), &index);
    assert_true(world->fragments.alive >= 95);
    bullet_fly(world);
}

static bool lives(const ShvFragment *fragment)
{
    return fragment->mode != SHV_MODE_DEAD;
}

static double fastest(const World *world)
{
    double speed = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++) {
        const ShvFragment *fragment = &world->fragments.items[f];
        if (lives(fragment))
            speed = fmax(speed, shv_norm(fragment->velocity) + shv_norm(fragment->angular_velocity) * fragment->radius);
    }
    return speed;
}

static double kinetic(const World *world)
{
    double sum = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++)
        if (lives(&world->fragments.items[f])) sum += shv_fragment_kinetic(&world->fragments.items[f]);
    return sum;
}

/* Σ m z, and Σ m. */
static double height_moment(const World *world, double *mass)
{
    double sum = 0.0;
    *mass = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++) {
        const ShvFragment *fragment = &world->fragments.items[f];
        if (!lives(fragment)) continue;
        sum += fragment->mass * fragment->position.z;
        *mass += fragment->mass;
    }
    return sum;
}

/* ---- true overlap ---- */

static double six_volumes(ShvVec3 a, ShvVec3 b, ShvVec3 c, ShvVec3 d)
{
    return shv_dot(shv_sub(b, a), shv_cross(shv_sub(c, a), shv_sub(d, a)));
}

static bool holds(const ShvVec3 c[4], ShvVec3 x)
{
    for (int k = 0; k < 3; k++) {
        const double at = k == 0 ? x.x : k == 1 ? x.y : x.z;
        double low = (double)INFINITY, high = -(double)INFINITY;
        for (int a = 0; a < 4; a++) {
            const double p = k == 0 ? c[a].x : k == 1 ? c[a].y : c[a].z;
            low = fmin(low, p);
            high = fmax(high, p);
        }
        if (at < low || at > high) return false;
    }
    return six_volumes(x, c[1], c[2], c[3]) >= 0.0 && six_volumes(c[0], x, c[2], c[3]) >= 0.0 &&
           six_volumes(c[0], c[1], x, c[3]) >= 0.0 && six_volumes(c[0], c[1], c[2], x) >= 0.0;
}

static bool is_in(const World *world, int32_t fragment, ShvVec3 x)
{
    const ShvFragment *record = &world->fragments.items[fragment];
    if (!lives(record) || shv_norm(shv_sub(x, record->position)) > record->radius) return false;
    for (int32_t i = 0; i < record->element_count; i++) {
        const int32_t element = world->fragments.elements[record->element_begin + i];
        ShvVec3 corner[4];
        for (int a = 0; a < 4; a++)
            corner[a] = shv_state_position(&world->state, shv_state_node(&world->state, element, a));
        if (holds(corner, x)) return true;
    }
    return false;
}

/* Share of the volume that lies in tets of another fragment as well, by one random point of every tet. */
static double overlap(World *world)
{
    uint64_t index = 5000;
    double whole = 0.0, shared = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++)
        if (lives(&world->fragments.items[f]))
            shv_fragment_scatter(&world->fragments.items[f], &world->fragments, &world->state);
    for (int32_t e = 0; e < world->state.element_count; e++) {
        const double volume = shv_mesh_element_volume(&world->model.mesh, e);
        double share[4], sum = 0.0;
        for (int a = 0; a < 4; a++) sum += share[a] = -log(draw(&index, 0.0, 1.0));
        ShvVec3 x = shv_vec3(0.0, 0.0, 0.0);
        for (int a = 0; a < 4; a++)
            x = shv_madd(x, share[a] / sum, shv_state_position(&world->state, shv_state_node(&world->state, e, a)));
        bool foreign = false;
        for (int32_t f = 0; f < world->fragments.count && !foreign; f++)
            foreign = f != world->state.element_fragment[e] && is_in(world, f, x);
        whole += volume;
        shared += foreign ? volume : 0.0;
    }
    return shared / whole;
}

/* ---- tests ---- */

/* In place, zero gravity, at rest: after 1 s no piece is faster than 1e-3 diameters/s. */
static void test_pieces_in_place_stay(void **unused)
{
    (void)unused;
    World world;
    cut_ball(&world, false);
    for (int i = 0; i < 1000; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    print_message("in place: fastest %.3g m/s after 1 s\n", fastest(&world));
    assert_true(fastest(&world) <= 1e-3 * 2.0 * radius);
    world_end(&world);
}

/* Sent outward at 0.05 m/s r/R they keep their kinetic energy within 1 %. Sent back inward they collide: momentum is kept, energy
   lost, and less than 1 % of the volume is ever in two fragments. */
static void test_pieces_part_and_collide(void **unused)
{
    (void)unused;
    World world;
    cut_ball(&world, false);
    for (int32_t f = 0; f < world.fragments.count; f++)
        world.fragments.items[f].velocity = shv_scale(world.fragments.items[f].position, 0.05 / radius);
    const double start = kinetic(&world);
    for (int i = 0; i < 1000; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    const double parted = kinetic(&world);
    print_message("sent outward: kinetic energy %.5f of the start\n", parted / start);
    check_near(parted, start, 0.01 * start);
    ShvVec3 momentum = shv_vec3(0.0, 0.0, 0.0);
    double scale = 0.0;
    for (int32_t f = 0; f < world.fragments.count; f++) {
        ShvFragment *fragment = &world.fragments.items[f];
        if (!lives(fragment)) continue;
        fragment->velocity = shv_scale(fragment->velocity, -1.0);
        momentum = shv_madd(momentum, -fragment->mass, fragment->velocity);
        scale += fragment->mass * shv_norm(fragment->velocity);
    }
    double deepest = 0.0;
    for (int i = 0; i < 2000; i++) {
        world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        if (i % 200 == 199) deepest = fmax(deepest, overlap(&world));
    }
    for (int32_t f = 0; f < world.fragments.count; f++)
        if (lives(&world.fragments.items[f]))
            momentum = shv_madd(momentum, world.fragments.items[f].mass, world.fragments.items[f].velocity);
    print_message(
        "sent inward: kinetic energy %.3f of the start, momentum off by %.1e, overlap at most %.2e of the volume\n",
        kinetic(&world) / start, shv_norm(momentum) / scale, deepest);
    assert_true(kinetic(&world) < 0.5 * start);
    check_near(shv_norm(momentum), 0.0, 1e-10 * scale);
    assert_true(deepest < 0.01);
    world_end(&world);
}

/* On a floor under gravity: kinetic energy never exceeds what gravity gave, and after 5 s less than 1 % of the volume is in two
   fragments. */
static void test_heap_gains_nothing(void **unused)
{
    (void)unused;
    World world;
    cut_ball(&world, true);
    double mass;
    const double start = height_moment(&world, &mass), birth = overlap(&world);
    double most = -(double)INFINITY;
    for (int i = 0; i < 5000; i++) {
        world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        most = fmax(most, kinetic(&world) - 9.81 * (start - height_moment(&world, &mass)));
    }
    const double end = overlap(&world);
    print_message(
        "heap: kinetic energy at most %.2e of m g R above what gravity gave, %.2e left after 5 s, overlap %.2e "
        "of the volume (at birth %.1e)\n",
        most / (mass * 9.81 * radius), kinetic(&world) / (mass * 9.81 * radius), end, birth);
    assert_true(most <= 1e-12 * mass * 9.81 * radius); /* round-off of 5000 steps */
    assert_true(end < 0.01);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pieces_in_place_stay),
        cmocka_unit_test(test_pieces_part_and_collide),
        cmocka_unit_test(test_heap_gains_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
