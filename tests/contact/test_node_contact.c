#include "check.h"

#include "contact/nodes.h"

static const double STEP = 1e-4;

/* ---- one node ---- */

/* Falls 0.5 m onto the floor: arrives exactly, stays, does not bounce; its energy is the work of the contact. */
static void test_drop(void **state)
{
    (void)state;
    const ShvObstacleDefinition floor = plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0);
    Nodes nodes;
    nodes_create(&nodes, &floor, 1, 1);
    nodes.gravity[2] = -9.81;
    nodes.state.mass[0] = 2.0;
    place_node(&nodes, 0, shv_vec3(0.0, 0.0, 0.5), shv_vec3(0.0, 0.0, 0.0));
    double work = 0.0, pending = 0.0, closing = 0.0;
    int impacts = 0;
    bool touched = false;
    for (int k = 0; k < 5000; k++) {
        nodes_step(&nodes, STEP);
        const double z = shv_state_position(&nodes.state, 0).z;
        assert_true(z > -1e-15);
        const ShvFacetPair *touch = nodes_touch(&nodes);
        impacts += touch && !touched;
        if (touch && !touched) closing = -shv_dot(touch->relative, touch->normal);
        touched = touch;
        work += nodes.contact.normal_work[0] + nodes.contact.normal_work[1];
        pending = nodes.contact.normal_work[1];
    }
    assert_int_equal(impacts, 1);
    check_near(closing, sqrt(2.0 * 9.81 * 0.5), 9.81 * STEP);
    check_near(shv_state_position(&nodes.state, 0).z, 0.0, 1e-15);
    check_near(node_velocity(&nodes, 0).z, 0.0, 1e-15);
    /* At rest the half-step velocities vanish and so does the kinetic energy. The half kick of the start did half of the
       work that gravity has over the half step: m (g h)²/8 was never there. */
    check_near(work - pending, -2.0 * 9.81 * 0.5 + 2.0 * 9.81 * 9.81 * STEP * STEP / 8.0, 1e-11);
    check_near(nodes.contact.push.z, 2.0 * 9.81 * STEP, 1e-15);
    nodes_release(&nodes);
}

/* Slides at 2 m/s with µ = 0.4. Each kick of contact takes µ g h, so the node stops after v/(µ g h) steps and
   v²/(2 µ g) ± v h/2. */
static void test_sliding_distance(void **state)
{
    (void)state;
    ShvObstacleDefinition floor = plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0);
    floor.friction = 0.4;
    Nodes nodes;
    nodes_create(&nodes, &floor, 1, 1);
    nodes.gravity[2] = -9.81;
    place_node(&nodes, 0, shv_vec3(0.0, 0.0, 0.0), shv_vec3(2.0 * cos(0.3), 2.0 * sin(0.3), 0.0));
    double friction = 0.0, normal = 0.0;
    for (int k = 0; k < 6000; k++) {
        nodes_step(&nodes, STEP);
        friction += nodes.contact.friction_work[0] + nodes.contact.friction_work[1];
        normal += nodes.contact.normal_work[0] + nodes.contact.normal_work[1];
    }
    const ShvVec3 at = shv_state_position(&nodes.state, 0);
    const double distance = 4.0 / (2.0 * 0.4 * 9.81);
    check_near(at.x, distance * cos(0.3), 2.0 * STEP);
    check_near(at.y, distance * sin(0.3), 2.0 * STEP);
    check_near(at.z, 0.0, 1e-15);
    check_near(shv_norm(node_velocity(&nodes, 0)), 0.0, 1e-14);
    check_near(friction, -2.0, 1e-12);
    check_near(normal, 0.0, 1e-14);
    nodes_release(&nodes);
}

/* Sticks iff tan θ ≤ µ; else a = g (sin θ − µ cos θ), exactly in every kick. */
static void test_incline(void **state)
{
    (void)state;
    const double angle = 3.14159265358979323846 / 6.0, frictions[3] = {0.3, 0.577, 0.578};
    for (int k = 0; k < 3; k++) {
        ShvObstacleDefinition slope = plane_definition("slope", shv_vec3(sin(angle), 0.0, cos(angle)), 0.0);
        slope.friction = frictions[k];
        Nodes nodes;
        nodes_create(&nodes, &slope, 1, 1);
        nodes.gravity[2] = -9.81;
        for (int step = 0; step < 1000; step++) nodes_step(&nodes, STEP);
        const double a = fmax(0.0, 9.81 * (sin(angle) - frictions[k] * cos(angle)));
        const ShvVec3 down = {cos(angle), 0.0, -sin(angle)};
        check_near(shv_dot(node_velocity(&nodes, 0), down), a * (1000.0 - 0.5) * STEP, 1e-12);
        nodes_release(&nodes);
    }
}

/* A node exactly on a plane with no velocity and no load is not touched at all. */
static void test_rests_on_plane(void **state)
{
    (void)state;
    const ShvObstacleDefinition floor = plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0);
    Nodes nodes;
    nodes_create(&nodes, &floor, 1, 1);
    for (int step = 0; step < 100; step++) {
        nodes_step(&nodes, STEP);
        assert_int_equal(nodes.contact.touching, 0);
    }
    nodes_release(&nodes);
}

/* ---- fast nodes ---- */

/* 1 km/s at a shape of 1 mm, 0.4 m away, step 1 ms: stops at its near side. What flies past is left alone. */
static void test_fast_node_stops(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(box_text);
    ShvObstacleDefinition definitions[3] = {box_definition("plate", shv_vec3(1.0, 1.0, 1e-3), shv_vec3(0.0, 0.0, 0.0)),
                                            sphere_definition("shot", 5e-4, shv_vec3(0.0, 0.0, 0.0)),
                                            mesh_definition("chip", file.path, shv_vec3(-1e-3, -5e-4, -5e-4))};
    definitions[2].scale = 1e-3; /* 2 × 1 × 0.5 mm, top at z = 0 */
    const double top[3] = {5e-4, 5e-4, 0.0};
    for (int k = 0; k < 3; k++) {
        Nodes nodes;
        nodes_create(&nodes, &definitions[k], 1, 3);
        place_node(&nodes, 0, shv_vec3(0.0, 0.0, 0.4), shv_vec3(0.0, 0.0, -1000.0));
        place_node(&nodes, 1, shv_vec3(0.6, 0.0, 0.4), shv_vec3(0.0, 0.0, -1000.0));
        place_node(&nodes, 2, shv_vec3(0.7, 0.0, 0.05), shv_vec3(-100.0, 0.0, -1000.0)); /* passes under the rim */
        for (int step = 0; step < 3; step++) nodes_step(&nodes, 1e-3);
        check_near(shv_state_position(&nodes.state, 0).z, top[k], 1e-12);
        check_near(node_velocity(&nodes, 0).z, 0.0, 1e-9);
        check_near(node_velocity(&nodes, 1).z, -1000.0, 0.0);
        check_near(node_velocity(&nodes, 2).z, -1000.0, 0.0);
        nodes_release(&nodes);
    }
    remove_surface_file(&file);
}

/* Nodes from everywhere at random speeds never get into a box, a ball or an angle that stands still, on a floor or not. */
static void test_nothing_gets_in(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(angle_text);
    ShvObstacleDefinition shapes[3] = {box_definition("box", shv_vec3(1.0, 0.6, 0.02), shv_vec3(0.0, 0.0, 0.0)),
                                       sphere_definition("ball", 0.3, shv_vec3(0.0, 0.0, 0.0)),
                                       mesh_definition("angle", file.path, shv_vec3(-0.3, -0.3, -0.2))};
    shapes[2].scale = 0.4;
    for (int k = 0; k < 6; k++) {
        uint64_t index = 0;
        Nodes nodes;
        ShvObstacleDefinition definitions[2] = {shapes[k % 3],
                                                plane_definition("floor", shv_vec3(0.0, 0.1, 1.0), -0.1)};
        turn(&definitions[0], shv_vec3(1.0, 0.3, 0.2), 33.0);
        definitions[0].friction = 0.3;
        nodes_create(&nodes, definitions, k < 3 ? 1 : 2, 500);
        for (int32_t i = 0; i < 500; i++) {
            ShvVec3 direction = shv_unit(draw_vector(8, &index, 1.0));
            if (k >= 3) direction.z = fabs(direction.z) + 0.1;
            const ShvVec3 to = draw_vector(8, &index, 0.3), from = shv_scale(direction, draw(8, &index, 1.0, 2.0));
            place_node(&nodes, i, from, shv_scale(shv_sub(to, from), draw(8, &index, 1.0, 1000.0)));
        }
        int touched = 0;
        for (int step = 0; step < 1000; step++) {
            nodes_step(&nodes, 1e-3);
            touched += nodes.contact.touching;
        }
        for (int32_t i = 0; i < 500; i++)
            for (int32_t o = 0; o < nodes.obstacles.count; o++) {
                const ShvVec3 at = shv_state_position(&nodes.state, i);
                assert_true(shv_obstacle_closest(&nodes.obstacles.items[o], at, (double)INFINITY).gap > -1e-9);
            }
        assert_true(touched > 100);
        nodes_release(&nodes);
    }
    remove_surface_file(&file);
}

/* ---- several obstacles ---- */

/* Two opposed planes that overlap: the node inside both cannot leave either way, and its velocity along them stays. */
static void test_opposed_planes(void **state)
{
    (void)state;
    const ShvObstacleDefinition definitions[2] = {plane_definition("below", shv_vec3(0.0, 0.0, 1.0), 0.001),
                                                  plane_definition("above", shv_vec3(0.0, 0.0, -1.0), 0.001)};
    for (int sign = -1; sign <= 1; sign += 2) {
        Nodes nodes;
        nodes_create(&nodes, definitions, 2, 1);
        place_node(&nodes, 0, shv_vec3(0.0, 0.0, 0.0), shv_vec3(1.0, 0.0, 3.0 * sign));
        for (int step = 0; step < 100; step++) {
            nodes_step(&nodes, STEP);
        }
        check_near(node_velocity(&nodes, 0).z, 0.0, 1e-15);
        check_near(node_velocity(&nodes, 0).x, 1.0, 0.0);
        nodes_release(&nodes);
    }
}

/* Two planes nearly opposed and closing: sweeps are capped, and energy only falls. */
static void test_wedge_corner(void **state)
{
    (void)state;
    for (int sharp = 0; sharp < 2; sharp++) {
        const double angle = sharp ? 1e-3 : 0.7; /* between the faces, half */
        const ShvObstacleDefinition definitions[2] = {
            plane_definition("left", shv_vec3(cos(angle), 0.0, sin(angle)), 0.0),
            plane_definition("right", shv_vec3(-cos(angle), 0.0, sin(angle)), 0.0)};
        Nodes nodes;
        nodes_create(&nodes, definitions, 2, 1);
        place_node(&nodes, 0, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.5, 0.0, -2.0));
        double energy = nodes_kinetic(&nodes, 0.0);
        for (int step = 0; step < 200; step++) {
            nodes_step(&nodes, STEP);
            assert_true(nodes_kinetic(&nodes, 0.0) <= energy);
            energy = nodes_kinetic(&nodes, 0.0);
            assert_true(shv_finite3(node_velocity(&nodes, 0)));
        }
        if (!sharp) check_near(energy, 0.0, 1e-20);
        nodes_release(&nodes);
    }
}

/* ---- free and scripted obstacles ---- */

/* Head on, a free ball and a node: perfectly plastic impact; momentum to rounding, works on both sides as energies. */
static void test_free_ball(void **state)
{
    (void)state;
    ShvObstacleDefinition ball = sphere_definition("ball", 0.1, shv_vec3(0.0, 0.0, 0.0));
    make_free(&ball, 3.0);
    ball.placement.velocity[0] = 4.0;
    Nodes nodes;
    nodes_create(&nodes, &ball, 1, 1);
    place_node(&nodes, 0, shv_vec3(0.5, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    double node_work = 0.0, ball_work = 0.0;
    for (int step = 0; step < 2000; step++) {
        nodes_step(&nodes, STEP);
        node_work += nodes.contact.normal_work[0] + nodes.contact.normal_work[1];
        ball_work += nodes.contact.obstacle_work[0] + nodes.contact.obstacle_work[1];
    }
    check_near(node_velocity(&nodes, 0).x, 3.0, 1e-13);
    check_near(nodes.obstacles.items[0].velocity.x, 3.0, 1e-13);
    check_near(node_work, 4.5, 1e-12);
    check_near(ball_work, 13.5 - 24.0, 1e-12);
    nodes_release(&nodes);
}

/* A piston pushes a node along: it takes the piston's velocity, never enters, and the work is its energy. */
static void test_piston(void **state)
{
    (void)state;
    const ShvKeyframe keyframes[2] = {{0.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.0},
                                      {1.0, {2.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.0}};
    ShvObstacleDefinition piston = box_definition("piston", shv_vec3(0.2, 1.0, 1.0), shv_vec3(0.0, 0.0, 0.0));
    piston.motion = SHV_OBSTACLE_SCRIPTED;
    piston.keyframes = keyframes;
    piston.keyframe_count = 2;
    Nodes nodes;
    nodes_create(&nodes, &piston, 1, 1);
    place_node(&nodes, 0, shv_vec3(0.5, 0.1, 0.2), shv_vec3(0.0, 0.0, 0.0));
    double work = 0.0;
    for (int step = 0; step < 10000; step++) {
        nodes_step(&nodes, STEP);
        work += nodes.contact.normal_work[0] + nodes.contact.normal_work[1];
        assert_true(shv_state_position(&nodes.state, 0).x - nodes.obstacles.items[0].position.x > 0.1 - 1e-12);
    }
    check_near(node_velocity(&nodes, 0).x, 2.0, 1e-11);
    check_near(work, 2.0, 1e-11);
    nodes_release(&nodes);
}

/* A free box of 1 kg rests on four nodes of 1 t in free space: they carry it. Nodes are worked through one by one, so the
   corners hang by what a step falls, g h², and no more however long it lasts. */
static void test_box_on_nodes(void **state)
{
    (void)state;
    ShvObstacleDefinition box = box_definition("box", shv_vec3(0.2, 0.2, 0.1), shv_vec3(0.0, 0.0, 0.05));
    make_free(&box, 1.0);
    Nodes nodes;
    nodes_create(&nodes, &box, 1, 4);
    nodes.gravity[2] = -9.81;
    for (int32_t i = 0; i < 4; i++) {
        nodes.state.mass[i] = 1e3;
        nodes.state.force[3 * i + 2] = 9.81 * 1e3;
        place_node(&nodes, i, shv_vec3(i & 1 ? 0.08 : -0.08, i & 2 ? 0.08 : -0.08, 0.0), shv_vec3(0.0, 0.0, 0.0));
    }
    const double fall = 9.81 * STEP * STEP;
    double impulse = 0.0;
    for (int step = 0; step < 5000; step++) {
        nodes_step(&nodes, STEP);
        impulse -= nodes.contact.push.z;
        double top = 0.0;
        for (int32_t i = 0; i < 4; i++) top += 0.25 * shv_state_position(&nodes.state, i).z;
        check_near(nodes.obstacles.items[0].position.z - top, 0.05, fall);
        check_near(shv_norm(nodes.obstacles.items[0].angular_velocity), 0.0, 9.81 * STEP / 0.08);
    }
    check_near(impulse, 9.81 * 0.5, 1e-3 * 9.81 * 0.5); /* all but what the nodes' own motion takes: masses 1 : 4000 */
    nodes_release(&nodes);
}

/* Random nodes and free obstacles, some of the nodes inside at the start: kinetic energy never grows through contact,
   whatever overlaps whatever, and node works plus obstacle works are its change. */
static void test_energy_never_grows(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(angle_text);
    for (uint64_t seed = 1; seed <= 5; seed++) {
        uint64_t index = 0;
        ShvObstacleDefinition definitions[6] = {
            plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), -1.0),
            plane_definition("wall", shv_vec3(1.0, 0.1, 0.0), -1.0),
            sphere_definition("ball", 0.4, draw_vector(seed, &index, 0.6)),
            box_definition("box", shv_vec3(0.5, 0.9, 0.3), draw_vector(seed, &index, 0.6)),
            mesh_definition("angle", file.path, draw_vector(seed, &index, 0.6)),
            box_definition("block", shv_vec3(1.0, 0.2, 0.3), draw_vector(seed, &index, 0.6))};
        definitions[4].scale = 0.4;
        for (int k = 0; k < 6; k++) definitions[k].friction = draw(seed, &index, 0.0, 1.5);
        for (int k = 2; k < 5; k++) {
            make_free(&definitions[k], draw(seed, &index, 0.1, 20.0));
            shv_store3(definitions[k].placement.velocity, draw_vector(seed, &index, 5.0));
            shv_store3(definitions[k].placement.angular_velocity, draw_vector(seed, &index, 10.0));
            turn(&definitions[k], draw_vector(seed, &index, 1.0), 100.0);
        }
        Nodes nodes;
        nodes_create(&nodes, definitions, 6, 200);
        shv_store3(nodes.gravity, shv_vec3(0.3, 0.0, -9.81));
        for (int32_t i = 0; i < 200; i++) {
            nodes.state.mass[i] = draw(seed, &index, 0.01, 2.0);
            const ShvVec3 position = draw_vector(seed, &index, 1.2);
            place_node(&nodes, i, position, draw_vector(seed, &index, 10.0));
        }
        int touched = 0;
        for (int step = 0; step < 300; step++) {
            const double h = 1e-3, kick = 0.5 * (nodes.state.last_step + h);
            nodes_begin(&nodes, h);
            nodes_kick(&nodes, kick);
            const double before = nodes_kinetic(&nodes, 0.5 * h);
            nodes_answer(&nodes, h);
            const double after = nodes_kinetic(&nodes, 0.5 * h);
            assert_true(after <= before * (1.0 + 1e-13));
            touched += nodes.contact.touching;
            nodes_drift(&nodes, h);
        }
        assert_true(touched > 1000);
        nodes_release(&nodes);
    }
    remove_surface_file(&file);
}

/* The works as booked: J·v₋/2 and J·v₊/2 with v₋ from before the kick, and again after something else moved the node. */
static void test_works(void **state)
{
    (void)state;
    ShvObstacleDefinition floor = plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0);
    floor.friction = 0.5;
    Nodes nodes;
    nodes_create(&nodes, &floor, 1, 1);
    nodes.gravity[2] = -9.81;
    nodes.state.mass[0] = 0.3;
    const ShvVec3 start = {1.0, 0.5, -2.0}, force = {0.4, -0.1, -5.0};
    place_node(&nodes, 0, shv_vec3(0.0, 0.0, 1e-5), start);
    shv_store3(nodes.state.force, force);
    const double kick = 1.5e-4;
    nodes_begin(&nodes, STEP);
    nodes_kick(&nodes, kick);
    nodes_answer(&nodes, STEP);
    assert_int_equal(nodes.contact.touching, 1);
    const ShvFacetPair *touch = nodes_touch(&nodes);
    const ShvVec3 after = node_velocity(&nodes, 0);
    check_near(after.z, -1e-5 / STEP, 1e-15);
    check_near(nodes.contact.normal_work[0], 0.5 * touch->normal_impulse * start.z, 1e-16);
    check_near(nodes.contact.normal_work[1], 0.5 * touch->normal_impulse * after.z, 1e-16);
    check_near(nodes.contact.friction_work[0], 0.5 * shv_dot(touch->friction, start), 1e-16);
    check_near(nodes.contact.friction_work[1], 0.5 * shv_dot(touch->friction, after), 1e-16);
    check_near(shv_norm(touch->friction), 0.5 * touch->normal_impulse, 1e-16);
    /* The same step, though a stranger's impulse comes between. */
    const double expected = nodes.contact.normal_work[0], impulse = touch->normal_impulse;
    shv_store3(nodes.state.velocity, start);
    nodes_begin(&nodes, STEP);
    nodes_kick(&nodes, kick);
    nodes.state.velocity[2] -= 1.0;
    nodes_answer(&nodes, STEP);
    touch = nodes_touch(&nodes);
    check_near(touch->normal_impulse, impulse + 0.3, 1e-15);
    check_near(nodes.contact.normal_work[0], expected * (impulse + 0.3) / impulse, 1e-15);
    shv_store3(nodes.state.velocity, shv_vec3(0.0, 0.0, 0.0));
    const ShvSurfaceBodies bodies = nodes_bodies(&nodes);
    shv_surface_contact_book(&nodes.contact, &bodies);
    check_near(nodes.contact.normal_work[0], 0.5 * touch->normal_impulse * start.z, 1e-16);
    check_near(nodes.contact.normal_work[1], 0.0, 0.0);
    ShvLedger ledger = {0};
    shv_surface_contact_book_ledger(&nodes.contact, &ledger);
    check_near(ledger.booked[SHV_WORK_CONTACT], nodes.contact.normal_work[0], 0.0);
    check_near(ledger.booked[SHV_WORK_FRICTION], nodes.contact.friction_work[0], 0.0);
    nodes_release(&nodes);
}

static ShvStatus answer_once(Nodes *nodes, ShvSurfaceContact *contact)
{
    const ShvSurfaceBodies bodies = nodes_bodies(nodes);
    SHV_TRY(shv_surface_contact_begin(contact, &bodies, STEP, &nodes->error));
    for (int32_t i = 0; i < 300; i++) nodes->state.velocity[3 * i + 2] = -1.0;
    return shv_surface_contact_apply(contact, &bodies, STEP, &nodes->error);
}

/* Every allocation fails in turn: a message, nothing leaked, and the same contact works once there is memory. */
static void test_allocation_failures(void **state)
{
    (void)state;
    const ShvObstacleDefinition floor = plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0);
    Nodes nodes;
    nodes_create(&nodes, &floor, 1, 300);
    for (int32_t i = 0; i < 300; i++) place_node(&nodes, i, shv_vec3(i, 0.0, 0.0), shv_vec3(0.0, 0.0, -1.0));
    int failures = 0;
    ShvStatus status = SHV_NO_MEMORY;
    for (int64_t allowed = 0; status != SHV_OK; allowed++) {
        ShvMemory *memory = shv_memory_create();
        ShvSurfaceContact contact;
        shv_memory_fail_after(memory, allowed);
        check_ok(shv_surface_contact_create(&contact, memory, &nodes.model, 0.0, &nodes.error), nodes.error);
        status = answer_once(&nodes, &contact);
        if (status != SHV_OK) {
            shv_memory_fail_after(memory, -1);
            assert_int_equal(answer_once(&nodes, &contact), SHV_OK);
            assert_int_equal(contact.touching, 300);
        }
        if (status != SHV_OK) failures++;
        shv_surface_contact_release(&contact);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
    }
    assert_true(failures >= 5);
    nodes_release(&nodes);
}

/* ---- nothing near ---- */

/* 40,000 nodes with nothing near: no pair is made, and over many steps nothing touches. */
static void test_nothing_near(void **state)
{
    (void)state;
    const ShvObstacleDefinition definitions[2] = {plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), -1.0),
                                                  sphere_definition("ball", 0.1, shv_vec3(0.0, 0.0, 2.0))};
    const int32_t count = 40000;
    uint64_t index = 0;
    Nodes nodes;
    nodes_create(&nodes, definitions, 2, count);
    for (int32_t i = 0; i < count; i++)
        place_node(&nodes, i, shv_scale(shv_unit(draw_vector(9, &index, 1.0)), 0.25), shv_vec3(0.0, 0.0, -3.0));
    for (int step = 0; step < 64; step++) {
        nodes_begin(&nodes, 1e-7);
        nodes_answer(&nodes, 1e-7);
        assert_int_equal(nodes.contact.pair_count, 0);
        assert_int_equal(nodes.contact.touching, 0);
    }
    nodes_release(&nodes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_drop),
        cmocka_unit_test(test_sliding_distance),
        cmocka_unit_test(test_incline),
        cmocka_unit_test(test_rests_on_plane),
        cmocka_unit_test(test_fast_node_stops),
        cmocka_unit_test(test_nothing_gets_in),
        cmocka_unit_test(test_opposed_planes),
        cmocka_unit_test(test_wedge_corner),
        cmocka_unit_test(test_free_ball),
        cmocka_unit_test(test_piston),
        cmocka_unit_test(test_box_on_nodes),
        cmocka_unit_test(test_energy_never_grows),
        cmocka_unit_test(test_works),
        cmocka_unit_test(test_allocation_failures),
        cmocka_unit_test(test_nothing_near),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
