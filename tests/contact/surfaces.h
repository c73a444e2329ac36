/* Deforming bodies, one fragment each, and coupled bodies among them, moved as the solver moves them. */
#ifndef SHV_TESTS_CONTACT_SURFACES_H
#define SHV_TESTS_CONTACT_SURFACES_H

#include "check.h"

#include "contact/surface_contact.h"
#include "shape/scene.h"
#include "solid/motion.h"
#include "solid/solid.h"

enum { MOST_FRAGMENTS = 64, MOST_OBJECTS = 6 };

typedef struct Surfaces {
    ShvMemory *memory;
    ShvMaterialDefinition material;
    ShvObjectDefinition objects[MOST_OBJECTS];
    ShvSceneDefinition scene;
    ShvModel model;
    ShvState state;
    ShvSolid solid;
    ShvCohesive cohesive;
    ShvObstacles obstacles;
    ShvSurfaceContact contact;
    ShvCoupledBody coupled_body[MOST_FRAGMENTS];
    ShvCoupledBody *coupled_bodies[MOST_FRAGMENTS];
    ShvMat3 body_inverse_inertia[MOST_FRAGMENTS]; /* reference axes */
    uint8_t awake[MOST_FRAGMENTS];
    ShvSurfaceBodies bodies;
    int32_t *nodes; /* awake */
    int32_t node_count;
    double gravity[3];
    double *before; /* velocities before the kick */
    /* largest violations so far */
    double gain;     /* of kinetic energy by contact, J */
    double unbooked; /* kinetic energy that no work explains, J */
    double energy;   /* kinetic and strain at the time of the last kick, J */
    double deepest;
    ShvError error;
} Surfaces;

static inline void surfaces_define(Surfaces *s)
{
    memset(s, 0, sizeof *s);
    s->memory = shv_memory_create();
    s->material = shv_material_default();
    s->scene = shv_scene_default();
    s->material.name = "chalk";
    s->material.density = 1200.0;
    s->material.youngs_modulus = 50e6;
    s->material.poissons_ratio = 0.2;
    s->material.fracture_energy = 0.5;
    s->material.cohesive_strength = 50e3;
    s->material.breakable = true;
    s->scene.name = "surfaces";
    s->scene.materials = &s->material;
    s->scene.material_count = 1;
    s->scene.objects = s->objects;
    s->scene.duration = 1.0;
    s->scene.threads = 1;
    s->scene.fracture.enabled = true;
}

static inline ShvObjectDefinition *surfaces_object(Surfaces *s, ShvMeshKind kind, double edge)
{
    static const char *const names[MOST_OBJECTS] = {"a", "b", "c", "d", "e", "f"};
    ShvObjectDefinition *object = &s->objects[s->scene.object_count];
    *object = shv_object_default();
    object->name = names[s->scene.object_count++];
    object->material = "chalk";
    object->mesh.kind = kind;
    object->mesh.edge = edge;
    return object;
}
static inline ShvObjectDefinition *surfaces_box(Surfaces *s, double x, double y, double z, double edge)
{
    ShvObjectDefinition *object = surfaces_object(s, SHV_MESH_BOX, edge);
    object->mesh.size[0] = x;
    object->mesh.size[1] = y;
    object->mesh.size[2] = z;
    return object;
}
static inline ShvObjectDefinition *surfaces_ball(Surfaces *s, double radius, double edge)
{
    ShvObjectDefinition *object = surfaces_object(s, SHV_MESH_BALL, edge);
    object->mesh.radius = radius;
    return object;
}
static inline void surfaces_place(ShvObjectDefinition *object, ShvVec3 position, ShvVec3 velocity)
{
    shv_store3(object->placement.position, position);
    shv_store3(object->placement.velocity, velocity);
}

/* Nodes of what is awake; the lists of contact go on. */
static inline void surfaces_relist(Surfaces *s)
{
    shv_release(s->nodes);
    s->nodes = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)s->state.node_count, sizeof(int32_t));
    uint8_t *seen = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)s->state.node_count, 1);
    for (int32_t e = 0; e < s->state.element_count; e++)
        for (int32_t k = 0; k < 4; k++)
            if (s->awake[s->state.element_fragment[e]]) seen[shv_state_node(&s->state, e, k)] = 1;
    s->node_count = 0;
    for (int32_t i = 0; i < s->state.node_count; i++)
        if (seen[i]) s->nodes[s->node_count++] = i;
    for (int32_t b = 0; b < s->solid.batch_count; b++) s->solid.batch_active[b] = 0;
    for (int32_t e = 0; e < s->state.element_count; e++)
        if (s->awake[s->state.element_fragment[e]]) s->solid.batch_active[e / SHV_LANES] = 1;
    shv_release(seen);
    shv_release(s->before);
    s->before = shv_allocate(NULL, SHV_PART_GENERAL, 3 * (size_t)s->state.node_count, sizeof(double));
}
static inline void surfaces_list_nodes(Surfaces *s)
{
    surfaces_relist(s);
    shv_surface_contact_invalidate(&s->contact);
}

/* Every object a fragment of its own, awake; obstacles: a floor z = 0 or none. */
static inline void surfaces_build(Surfaces *s, double friction, bool floor)
{
    check_ok(shv_model_build(&s->model, s->memory, &s->scene, NULL, &s->error), s->error);
    check_ok(shv_state_create(&s->state, &s->model, &s->scene, &s->error), s->error);
    check_ok(shv_solid_create(&s->solid, &s->model, &s->state, &s->error), s->error);
    if (s->model.can_break)
        check_ok(shv_cohesive_create(&s->cohesive, &s->model, &s->scene.fracture, &s->error), s->error);
    ShvObstacleDefinition plane = plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0);
    plane.friction = friction;
    s->obstacles = make_obstacles(&plane, floor ? 1 : 0);
    check_ok(shv_surface_contact_create(&s->contact, s->memory, &s->model, friction, &s->error), s->error);
    for (int32_t i = 0; i < s->model.object_count; i++) {
        s->awake[i] = 1;
        for (int32_t e = s->model.objects[i].element_begin; e < s->model.objects[i].element_end; e++)
            s->state.element_fragment[e] = i;
    }
    s->bodies = (ShvSurfaceBodies){.state = &s->state,
                                   .cohesive = s->model.can_break ? &s->cohesive : NULL,
                                   .awake = s->awake,
                                   .coupled_bodies = s->coupled_bodies,
                                   .fragment_count = s->model.object_count,
                                   .obstacles = &s->obstacles};
    surfaces_list_nodes(s);
}

static inline void surfaces_release(Surfaces *s)
{
    shv_surface_contact_release(&s->contact);
    shv_obstacles_release(&s->obstacles);
    if (s->model.can_break) shv_cohesive_release(&s->cohesive);
    shv_solid_release(&s->solid);
    shv_state_release(&s->state);
    shv_model_release(&s->model);
    shv_release(s->nodes);
    shv_release(s->before);
    assert_int_equal(shv_memory_bytes(s->memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(s->memory);
}

/* Makes an object's fragment a rigid coupled body with its lumped masses, at its placed position. */
static inline void surfaces_make_coupled_body(Surfaces *s, int32_t index, ShvVec3 velocity, ShvVec3 spin)
{
    const ShvObject *object = &s->model.objects[index];
    ShvCoupledBody body = {.orientation = shv_quat_identity(), .velocity = velocity, .angular_velocity = spin};
    for (int32_t i = object->node_begin; i < object->node_end; i++) {
        body.mass += s->state.mass[i];
        body.position = shv_madd(body.position, s->state.mass[i], shv_state_position(&s->state, i));
    }
    body.position = shv_scale(body.position, 1.0 / body.mass);
    body.reference_centre = body.position;
    ShvMat3 inertia = {{{0.0}}};
    for (int32_t i = object->node_begin; i < object->node_end; i++) {
        const ShvVec3 r = shv_sub(shv_state_position(&s->state, i), body.position);
        const double m = s->state.mass[i], a[3] = {r.x, r.y, r.z};
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++) inertia.m[p][q] += m * ((p == q ? shv_dot(r, r) : 0.0) - a[p] * a[q]);
        body.radius = fmax(body.radius, shv_norm(r));
    }
    assert_true(shv_invert(&inertia, &body.inverse_inertia));
    s->body_inverse_inertia[index] = body.inverse_inertia;
    s->coupled_body[index] = body;
    s->coupled_bodies[index] = &s->coupled_body[index];
    s->awake[index] = 0;
    surfaces_list_nodes(s);
}

static inline ShvVec3 coupled_body_spin(const ShvCoupledBody *body)
{
    ShvMat3 inertia;
    assert_true(shv_invert(&body->inverse_inertia, &inertia));
    return shv_apply(&inertia, body->angular_velocity);
}

/* ---- sums ---- */

static inline double surfaces_kinetic(const Surfaces *s, const double *velocity)
{
    double sum = 0.0;
    for (int32_t k = 0; k < s->node_count; k++) {
        const ShvVec3 v = shv_load3(velocity + 3 * (int64_t)s->nodes[k]);
        sum += 0.5 * s->state.mass[s->nodes[k]] * shv_dot(v, v);
    }
    return sum;
}
static inline double coupled_bodies_kinetic(const Surfaces *s)
{
    double sum = 0.0;
    for (int32_t i = 0; i < s->bodies.fragment_count; i++) {
        const ShvCoupledBody *body = s->coupled_bodies[i];
        if (body && isfinite(body->mass))
            sum += 0.5 * body->mass * shv_dot(body->velocity, body->velocity) +
                   0.5 * shv_dot(body->angular_velocity, coupled_body_spin(body));
    }
    return sum;
}

typedef struct Momentum {
    ShvVec3 linear, angular;
    double linear_size, angular_size; /* Σ m|v|, Σ |r| m |v| */
} Momentum;

static inline Momentum surfaces_momentum(const Surfaces *s)
{
    Momentum sum = {0};
    for (int32_t k = 0; k < s->node_count; k++) {
        const int32_t i = s->nodes[k];
        const ShvVec3 p = shv_scale(shv_load3(s->state.velocity + 3 * (int64_t)i), s->state.mass[i]);
        const ShvVec3 x = shv_state_position(&s->state, i);
        sum.linear = shv_add(sum.linear, p);
        sum.angular = shv_add(sum.angular, shv_cross(x, p));
        sum.linear_size += shv_norm(p);
        sum.angular_size += shv_norm(x) * shv_norm(p);
    }
    for (int32_t i = 0; i < s->bodies.fragment_count; i++) {
        const ShvCoupledBody *body = s->coupled_bodies[i];
        if (!body || !isfinite(body->mass)) continue;
        const ShvVec3 p = shv_scale(body->velocity, body->mass), spin = coupled_body_spin(body);
        sum.linear = shv_add(sum.linear, p);
        sum.angular = shv_add(sum.angular, shv_add(spin, shv_cross(body->position, p)));
        sum.linear_size += shv_norm(p);
        sum.angular_size += shv_norm(body->position) * shv_norm(p) + shv_norm(spin);
    }
    return sum;
}

static inline ShvVec3 surfaces_mean_velocity(const Surfaces *s, int32_t fragment)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    double mass = 0.0;
    for (int32_t e = 0; e < s->state.element_count; e++) {
        if (s->state.element_fragment[e] != fragment) continue;
        for (int32_t k = 0; k < 4; k++) {
            const int32_t node = shv_state_node(&s->state, e, k);
            sum = shv_madd(sum, 0.25 * s->state.element_mass[e], shv_load3(s->state.velocity + 3 * (int64_t)node));
        }
        mass += s->state.element_mass[e];
    }
    return shv_scale(sum, 1.0 / mass);
}

/* ---- a step ---- */

static inline void surfaces_forces(Surfaces *s)
{
    shv_motion_clear_force(&s->state, s->nodes, s->node_count, 1);
    shv_solid_add_internal_force(&s->solid, &s->state);
    if (s->model.can_break) shv_cohesive_begin(&s->cohesive, &s->state, s->awake);
}

/* Kinetic energy must change by the works of forces, gravity, cracks and contact: an identity of each step. */
static inline void surfaces_audit(Surfaces *s, const double *force, double kick, double step, double bodies_before,
                                  double gravity_work)
{
    double work = gravity_work, change = coupled_bodies_kinetic(s) - bodies_before;
    ShvLedger ledger = {0};
    if (s->model.can_break) shv_cohesive_book(&s->cohesive, &s->state, step, &ledger);
    shv_surface_contact_book_ledger(&s->contact, &ledger);
    for (int i = 0; i < SHV_WORK_COUNT; i++) work += ledger.booked[i];
    for (int32_t k = 0; k < s->node_count; k++) {
        const int64_t i = 3 * (int64_t)s->nodes[k];
        const double m = s->state.mass[s->nodes[k]];
        const ShvVec3 v0 = shv_load3(s->before + i), v1 = shv_load3(s->state.velocity + i);
        const ShvVec3 mean = shv_scale(shv_add(v0, v1), 0.5);
        change += m * shv_dot(shv_sub(v1, v0), mean);
        work += kick * shv_dot(shv_madd(shv_load3(force + i), m, shv_load3(s->gravity)), mean);
    }
    s->unbooked = fmax(s->unbooked, fabs(change - work));
}

static inline void surfaces_kick(Surfaces *s, double step)
{
    ShvState *state = &s->state;
    const double kick = 0.5 * (state->last_step + step);
    const size_t bytes = 3 * (size_t)state->node_count * sizeof(double);
    surfaces_forces(s);
    double *force = shv_allocate(NULL, SHV_PART_GENERAL, 3 * (size_t)state->node_count, sizeof(double));
    memcpy(force, state->force, bytes);
    memcpy(s->before, state->velocity, bytes);
    const double bodies_before = coupled_bodies_kinetic(s);
    s->bodies.gravity = shv_load3(s->gravity);
    check_ok(shv_surface_contact_begin(&s->contact, &s->bodies, step, &s->error), s->error);
    shv_motion_kick(state, s->nodes, s->node_count, kick, s->gravity, 1);
    ShvVec3 body_velocity[MOST_FRAGMENTS];
    ShvCoupledBody body_before[MOST_FRAGMENTS];
    for (int32_t i = 0; i < s->bodies.fragment_count; i++)
        if (s->coupled_bodies[i]) {
            body_before[i] = *s->coupled_bodies[i];
            body_velocity[i] = s->coupled_bodies[i]->velocity;
            s->coupled_bodies[i]->velocity = shv_madd(body_velocity[i], kick, shv_load3(s->gravity));
        }
    if (s->model.can_break) {
        shv_cohesive_pull(&s->cohesive, state, kick, step);
        shv_cohesive_close(&s->cohesive, state, kick, step);
    }
    const double kinetic = surfaces_kinetic(s, state->velocity) + coupled_bodies_kinetic(s);
    check_ok(shv_surface_contact_apply(&s->contact, &s->bodies, step, &s->error), s->error);
    s->gain = fmax(s->gain, surfaces_kinetic(s, state->velocity) + coupled_bodies_kinetic(s) - kinetic);
    s->deepest = fmax(s->deepest, s->contact.deepest);
    if (s->model.can_break) shv_cohesive_pull(&s->cohesive, state, kick, step);
    shv_surface_contact_book(&s->contact, &s->bodies);
    double gravity_work = 0.0;
    for (int32_t i = 0; i < s->bodies.fragment_count; i++)
        if (s->coupled_bodies[i] && isfinite(s->coupled_bodies[i]->mass))
            gravity_work += 0.5 * kick * s->coupled_bodies[i]->mass *
                            shv_dot(shv_load3(s->gravity), shv_add(body_velocity[i], s->coupled_bodies[i]->velocity));
    surfaces_audit(s, force, kick, step, bodies_before, gravity_work);
    s->energy = shv_solid_strain_energy(&s->solid, state);
    for (int32_t k = 0; k < s->node_count; k++) {
        const int64_t i = 3 * (int64_t)s->nodes[k];
        s->energy += 0.5 * state->mass[s->nodes[k]] * shv_dot(shv_load3(s->before + i), shv_load3(state->velocity + i));
    }
    for (int32_t i = 0; i < s->bodies.fragment_count; i++)
        if (s->coupled_bodies[i] && isfinite(s->coupled_bodies[i]->mass))
            s->energy +=
                0.5 * s->coupled_bodies[i]->mass * shv_dot(body_before[i].velocity, s->coupled_bodies[i]->velocity) +
                0.5 * shv_dot(body_before[i].angular_velocity, coupled_body_spin(s->coupled_bodies[i]));
    shv_release(force);
}

static inline void coupled_body_drift(ShvCoupledBody *body, const ShvMat3 *reference_inverse, double step)
{
    body->position = shv_madd(body->position, step, body->velocity);
    const ShvVec3 spin = coupled_body_spin(body);
    const ShvQuat turn = shv_quat_exponential(shv_scale(body->angular_velocity, step));
    body->orientation = shv_quat_unit(shv_quat_multiply(turn, body->orientation));
    const ShvMat3 r = shv_quat_to_matrix(body->orientation), back = shv_transpose(&r);
    const ShvMat3 half = shv_multiply(reference_inverse, &back);
    body->inverse_inertia = shv_multiply(&r, &half);
    body->angular_velocity = shv_apply(&body->inverse_inertia, spin); /* the spin is kept */
}

static inline void surfaces_drift(Surfaces *s, double step)
{
    shv_motion_drift(&s->state, s->nodes, s->node_count, step, 1);
    for (int32_t i = 0; i < s->bodies.fragment_count; i++)
        if (s->coupled_bodies[i] && isfinite(s->coupled_bodies[i]->mass))
            coupled_body_drift(s->coupled_bodies[i], &s->body_inverse_inertia[i], step);
    s->state.time += step;
    s->state.last_step = step;
}

static inline void surfaces_step(Surfaces *s, double step)
{
    surfaces_kick(s, step);
    surfaces_drift(s, step);
}

static inline double surfaces_stable_step(const Surfaces *s)
{
    return 0.5 * shv_solid_stable_step(&s->solid, NULL);
}

/* As if the cracks had parted. */
static inline void surfaces_part(Surfaces *s)
{
    for (int32_t i = 0; i < s->cohesive.count; i++) s->cohesive.phase[i] = SHV_COHESIVE_SEPARATED;
    s->cohesive.live_count = 0;
    surfaces_list_nodes(s);
}

/* Momentum as it was, within 1e-12 of the sums of sizes. */
static inline void check_momentum(const Surfaces *s, const Momentum *start)
{
    const Momentum now = surfaces_momentum(s);
    check_near(shv_norm(shv_sub(now.linear, start->linear)), 0.0, 1e-12 * start->linear_size);
    check_near(shv_norm(shv_sub(now.angular, start->angular)), 0.0, 1e-12 * start->angular_size);
}

#endif
