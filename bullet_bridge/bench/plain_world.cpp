#include "bullet_bridge/bench/plain_world.h"

#include <exception>
#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>

struct PlainWorld {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    btScalar friction = 0, scale = 1;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    ~PlainWorld()
    {
        for (const auto &body : bodies) world.removeRigidBody(body.get());
    }
};

static btVector3 load(const double *p)
{
    return btVector3(p[0], p[1], p[2]);
}

PlainWorld *plain_world_create(const double gravity[3], double friction, double length)
{
    try {
        auto plain = std::make_unique<PlainWorld>();
        plain->scale = 1 / length;
        plain->world.setGravity(load(gravity) * plain->scale);
        plain->friction = friction;
        return plain.release();
    } catch (const std::exception &) {
        return nullptr;
    }
}

static void add(PlainWorld *plain, btScalar mass, btCollisionShape *shape, const btVector3 &moments,
                const btTransform &pose, const btVector3 &velocity, const btVector3 &spin)
{
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, moments);
    info.m_startWorldTransform = pose;
    info.m_friction = plain->friction;
    plain->bodies.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody *body = plain->bodies.back().get();
    body->setLinearVelocity(velocity);
    body->setAngularVelocity(spin);
    plain->world.addRigidBody(body);
}

int plain_world_add_plane(PlainWorld *plain, const double normal[3], double offset)
{
    try {
        plain->shapes.push_back(std::make_unique<btStaticPlaneShape>(load(normal), offset * plain->scale));
        const btVector3 none(0, 0, 0);
        add(plain, 0, plain->shapes.back().get(), none, btTransform::getIdentity(), none, none);
        return 1;
    } catch (const std::exception &) {
        return 0;
    }
}

static btCollisionShape *add_hull(PlainWorld *plain, const PlainBody *body, int32_t hull)
{
    auto shape = std::make_unique<btConvexHullShape>();
    for (int32_t i = body->vertex_begin[hull]; i < body->vertex_begin[hull + 1]; i++)
        shape->addPoint(load(body->vertices + 3 * size_t(i)) * plain->scale, false);
    shape->recalcLocalAabb();
    plain->shapes.push_back(std::move(shape));
    return plain->shapes.back().get();
}

int plain_world_add_body(PlainWorld *plain, const PlainBody *body)
{
    try {
        btCollisionShape *whole = nullptr;
        if (body->hulls == 1) {
            whole = add_hull(plain, body, 0);
        } else {
            auto compound = std::make_unique<btCompoundShape>();
            for (int32_t h = 0; h < body->hulls; h++)
                compound->addChildShape(btTransform::getIdentity(), add_hull(plain, body, h));
            whole = compound.get();
            plain->shapes.push_back(std::move(compound));
        }
        const double *m = body->axes;
        const btTransform pose(btMatrix3x3(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]),
                               load(body->position) * plain->scale);
        add(plain, body->mass, whole, load(body->moments) * (plain->scale * plain->scale), pose,
            load(body->velocity) * plain->scale, load(body->spin));
        return 1;
    } catch (const std::exception &) {
        return 0;
    }
}

int plain_world_step(PlainWorld *plain, double step)
{
    try {
        plain->world.stepSimulation(step, 0);
        return 1;
    } catch (const std::exception &) {
        return 0;
    }
}

double plain_world_kinetic(const PlainWorld *plain)
{
    btScalar sum = 0;
    for (const auto &body : plain->bodies) {
        if (body->isStaticObject()) continue;
        const btVector3 spin = body->getAngularVelocity() * body->getWorldTransform().getBasis();
        sum += body->getMass() * body->getLinearVelocity().length2() / 2;
        sum += (spin * spin).dot(body->getLocalInertia()) / 2;
    }
    return sum / (plain->scale * plain->scale);
}

void plain_world_destroy(PlainWorld *plain)
{
    delete plain;
}
