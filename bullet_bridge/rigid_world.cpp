#include "bullet_bridge/rigid_world.h"

#include <algorithm>
#include <cmath>

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <LinearMath/btAabbUtil2.h>
#include <btBulletDynamicsCommon.h>

#include "bullet_bridge/guarded.hpp"
#include "bullet_bridge/layers.hpp"
#include "bullet_bridge/numbers.hpp"
#include "bullet_bridge/rigid_body.hpp"
#include "bullet_bridge/rigid_solver.hpp"

namespace
{
// Detection is asked for, not done by Bullet's algorithms.
class Dispatcher final : public btCollisionDispatcher
{
  public:
    Dispatcher(btCollisionConfiguration *configuration, ShvBulletWorld *world)
        : btCollisionDispatcher(configuration), owner(world)
    {
    }
    void dispatchAllCollisionPairs(btOverlappingPairCache *cache, const btDispatcherInfo &, btDispatcher *) override;

  private:
    ShvBulletWorld *const owner;
};

// Particles meet obstacles alone, of which there are few: each is compared with each of those. In the tree they would find one
// another, in rubble by the thousand, only to be told that they do not meet.
class Broadphase final : public btDbvtBroadphase
{
  public:
    btBroadphaseProxy *createProxy(const btVector3 &low, const btVector3 &high, int shape, void *user, int group,
                                   int mask, btDispatcher *dispatcher) override
    {
        if (group != shiver::PARTICLE)
            return btDbvtBroadphase::createProxy(low, high, shape, user, group, mask, dispatcher);
        return new btBroadphaseProxy(low, high, user, group, mask);
    }
    void destroyProxy(btBroadphaseProxy *proxy, btDispatcher *dispatcher) override
    {
        if (proxy->m_collisionFilterGroup == shiver::PARTICLE)
            delete proxy;
        else
            btDbvtBroadphase::destroyProxy(proxy, dispatcher);
    }
    void setAabb(btBroadphaseProxy *proxy, const btVector3 &low, const btVector3 &high,
                 btDispatcher *dispatcher) override
    {
        if (proxy->m_collisionFilterGroup != shiver::PARTICLE) btDbvtBroadphase::setAabb(proxy, low, high, dispatcher);
    }
};

class World final : public btDiscreteDynamicsWorld
{
  public:
    using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
    void updateAabbs() override {} // boxes are told
    bool touching_islands = true;

  protected:
    void predictUnconstraintMotion(btScalar) override {}
    void createPredictiveContacts(btScalar) override {}
    void calculateSimulationIslands() override;
    void integrateTransforms(btScalar) override {}
    void updateActivationState(btScalar) override {}
};
} // namespace

struct ShvBulletWorld {
    ShvBulletWorld(btScalar length_scale, const ShvBulletOverrides &given);
    ~ShvBulletWorld();
    btScalar scale;
    const ShvBulletOverrides overrides;
    btDefaultCollisionConfiguration configuration;
    Dispatcher dispatcher{&configuration, this};
    Broadphase broadphase;
    ShvSolver solver;
    World world{&dispatcher, &broadphase, &solver, &configuration};
    std::vector<std::unique_ptr<ShvBulletBody>> bodies; // by number
    std::vector<ShvBulletBody *> particles, obstacles;
    std::vector<ShvBulletPair> pairs;
    std::vector<int32_t> others;
    ShvCollider collider;
    // one step
    ShvBulletDetect detect = nullptr;
    void *data = nullptr;
    ShvBulletTask task = {};
    ShvStatus status = SHV_OK;
    ShvError *error = nullptr;
};

using shiver::guarded;

static btVector3 scaled(const ShvBulletWorld *world, const double *p)
{
    return shiver::vector(p) * world->scale;
}

ShvStatus shv_bullet_world_create(ShvBulletWorld **world, double length, const ShvBulletOverrides *overrides,
                                  ShvError *error)
{
    *world = nullptr;
    if (!(length > 0.0) || !std::isfinite(length))
        return shv_fail(error, SHV_BAD_INPUT, "bodies of size %g m cannot fly: check the scale of the meshes", length);
    return guarded(error, [&] {
        // A power of two changes no digit. Bullet's own constants (margins of its tree, tolerances of GJK) then meet bodies
        // of some units.
        *world = new ShvBulletWorld(std::exp2(std::round(std::log2(4.0 / length))), *overrides);
        return SHV_OK;
    });
}

ShvBulletWorld::ShvBulletWorld(btScalar length_scale, const ShvBulletOverrides &given)
    : scale(length_scale), overrides(given), collider(length_scale)
{
    world.touching_islands = overrides.touching_islands;
    solver.settles = overrides.settled_impulses;
    world.setGravity(btVector3(0, 0, 0)); // the caller's
    world.getSolverInfo() = ShvSolver::settings();
}

ShvBulletWorld::~ShvBulletWorld()
{
    for (const auto &body : bodies)
        if (body) world.removeRigidBody(body->body.get());
}

void shv_bullet_world_destroy(ShvBulletWorld *world)
{
    delete world;
}

static void measure(ShvBulletBody *body)
{
    if (body->kind == SHV_BULLET_SPHERE) {
        body->high = btVector3(body->radius, body->radius, body->radius);
        body->low = -body->high;
        return;
    }
    body->low = body->high = body->shapes.parts[0].vertices[0];
    for (const ShvConvex &part : body->shapes.parts)
        for (const btVector3 &vertex : part.vertices) {
            body->low.setMin(vertex);
            body->high.setMax(vertex);
            body->radius = btMax(body->radius, vertex.length());
        }
}

static ShvStatus make_shape(ShvBulletBody *body, const ShvBulletWorld *world, const ShvBulletShape *shape,
                            ShvError *error)
{
    const ShvStatus status = shiver::make_shapes(&body->shapes, *shape, 1 / world->scale, 0, error);
    if (status != SHV_OK) return status;
    body->kind = shape->kind;
    body->layer = shape->layer;
    body->normal = shiver::vector(shape->normal);
    body->offset = shape->offset * world->scale;
    body->radius = shape->kind == SHV_BULLET_SPHERE || shape->kind == SHV_BULLET_PLANE ? body->shapes.radius : 0;
    if (shape->kind != SHV_BULLET_PLANE) measure(body);
    return SHV_OK;
}

static void make_mass(ShvBulletBody *body, double inverse_mass, const double inverse_moment[3])
{
    body->mass = inverse_mass > 0 ? 1 / inverse_mass : 0;
    btRigidBody::btRigidBodyConstructionInfo info(body->mass, nullptr, body->shapes.shape);
    body->body = std::make_unique<btRigidBody>(info);
    body->body->setUserIndex(body->number);
    body->body->setFlags(0); // no gyroscopic term: free rotation is the caller's
    if (!(body->mass > 0)) return;
    body->inverse_moment = shiver::vector(inverse_moment);
    body->body->setInvInertiaDiagLocal(body->inverse_moment);
    body->body->setActivationState(DISABLE_DEACTIVATION);
}

static void set_box(ShvBulletWorld *world, ShvBulletBody *body, const btVector3 &displacement, double drift,
                    double turn)
{
    body->displacement = displacement;
    body->ball = body->radius + drift * world->scale;
    btTransformAabb(body->low, body->high, (drift + turn) * world->scale,
                    btTransform(body->axes, body->position * world->scale), body->box_low, body->box_high);
    const btVector3 none(0, 0, 0);
    btVector3 back = displacement, ahead = displacement;
    back.setMin(none);
    ahead.setMax(none);
    body->box_low += back;
    body->box_high += ahead;
    world->broadphase.setAabb(body->body->getBroadphaseProxy(), body->box_low, body->box_high, &world->dispatcher);
}

static std::vector<ShvBulletBody *> *list_of(ShvBulletWorld *world, ShvBulletLayer layer)
{
    if (layer == SHV_BULLET_BODY) return nullptr;
    return layer == SHV_BULLET_PARTICLE ? &world->particles : &world->obstacles;
}

ShvStatus shv_bullet_world_add(ShvBulletWorld *world, int32_t number, const ShvBulletShape *shape, double inverse_mass,
                               const double inverse_moment[3], ShvError *error)
{
    const bool good = std::isfinite(inverse_moment[0] + inverse_moment[1] + inverse_moment[2]);
    if (!(inverse_mass >= 0.0) || !std::isfinite(inverse_mass) || !good)
        return shv_fail(error, SHV_BAD_INPUT, "its mass or inertia is not a positive number");
    return guarded(error, [&]() -> ShvStatus {
        auto body = std::make_unique<ShvBulletBody>();
        body->number = number;
        const ShvStatus status = make_shape(body.get(), world, shape, error);
        if (status != SHV_OK) return status;
        make_mass(body.get(), inverse_mass, inverse_moment);
        if (size_t(number) >= world->bodies.size()) world->bodies.resize(size_t(number) + 1);
        const shiver::Filter filter = shiver::filter_of(body->layer, inverse_mass > 0);
        std::vector<ShvBulletBody *> *list = list_of(world, body->layer);
        if (list) {
            body->place = list->size();
            list->push_back(body.get());
        }
        world->world.addRigidBody(body->body.get(), filter.group, filter.mask);
        world->bodies[size_t(number)] = std::move(body);
        return SHV_OK;
    });
}

static ShvBulletBody *body_of(const ShvBulletWorld *world, int32_t number)
{
    return world->bodies[size_t(number)].get();
}

void shv_bullet_world_remove(ShvBulletWorld *world, int32_t number)
{
    const ShvBulletBody *body = body_of(world, number);
    std::vector<ShvBulletBody *> *list = list_of(world, body->layer);
    if (list) {
        (*list)[body->place] = list->back();
        (*list)[body->place]->place = body->place;
        list->pop_back();
    }
    world->world.removeRigidBody(body->body.get());
    world->bodies[size_t(number)].reset();
}

void shv_bullet_world_place(ShvBulletWorld *world, int32_t number, const double position[3], const double axes[9])
{
    ShvBulletBody *body = body_of(world, number);
    body->position = shiver::vector(position);
    body->axes = shiver::matrix(axes);
}

double shv_bullet_world_radius(const ShvBulletWorld *world, int32_t number)
{
    const ShvBulletBody *body = body_of(world, number);
    return body->kind == SHV_BULLET_PLANE ? double(INFINITY) : body->radius / world->scale;
}

ShvStatus shv_bullet_world_reach(ShvBulletWorld *world, int32_t number, const double displacement[3], double drift,
                                 double turn, ShvError *error)
{
    return guarded(error, [&] {
        ShvBulletBody *body = body_of(world, number);
        if (body->kind == SHV_BULLET_PLANE) return SHV_OK;
        set_box(world, body, scaled(world, displacement), drift, turn);
        return SHV_OK;
    });
}

static bool before(const ShvBulletPair &a, const ShvBulletPair &b)
{
    return a.first != b.first ? a.first < b.first : a.second < b.second;
}

static bool balls_meet(const ShvBulletBody &a, const ShvBulletBody &b, btScalar scale)
{
    const btVector3 apart = (a.position - b.position) * scale, displacement = a.displacement - b.displacement;
    const btScalar length = displacement.length2(), reach = a.ball + b.ball;
    const btScalar share = length > 0 ? btMin(btScalar(1), btMax(btScalar(0), -apart.dot(displacement) / length)) : 0;
    return (apart + share * displacement).length2() <= reach * reach;
}

static bool reaches(const ShvBulletBody &body, const ShvBulletBody &plane)
{
    const btVector3 centre = (body.box_low + body.box_high) / 2, half = (body.box_high - body.box_low) / 2;
    return plane.normal.dot(centre) - plane.normal.absolute().dot(half) <= plane.offset;
}

static bool boxes_meet(const ShvBulletBody &a, const ShvBulletBody &b)
{
    if (a.kind == SHV_BULLET_PLANE) return reaches(b, a);
    if (b.kind == SHV_BULLET_PLANE) return reaches(a, b);
    return TestAabbAgainstAabb2(a.box_low, a.box_high, b.box_low, b.box_high);
}

static const ShvBulletBody &body_of(const ShvBulletWorld *world, const btBroadphaseProxy *proxy)
{
    const auto *object = static_cast<const btCollisionObject *>(proxy->m_clientObject);
    return *world->bodies[size_t(object->getUserIndex())];
}

/* ---- step ---- */

// Manifolds of up to four contacts of one pair. The world positions are arms, and the bodies' origins are zero: far from the
// world's origin nothing is lost.
static void make_manifolds(ShvBulletWorld *world)
{
    btPersistentManifold *manifold = nullptr;
    for (int32_t i = 0; i < world->task.contact_count; i++) {
        ShvBulletContact *contact = &world->task.contacts[i];
        const bool same = i > 0 && contact[-1].first == contact->first && contact[-1].second == contact->second;
        if (!same || manifold->getNumContacts() == MANIFOLD_CACHE_SIZE)
            manifold = world->dispatcher.getNewManifold(body_of(world, contact->first)->body.get(),
                                                        body_of(world, contact->second)->body.get());
        manifold->setNumContacts(manifold->getNumContacts() + 1);
        ShvSolver::set_point(&manifold->getContactPoint(manifold->getNumContacts() - 1), contact);
    }
}

static void enter_bodies(ShvBulletWorld *world)
{
    for (int32_t i = 0; i < world->task.motion_count; i++) {
        ShvBulletMotion *motion = &world->task.motions[i];
        ShvBulletBody *body = body_of(world, motion->body);
        body->body->setUserPointer(motion);
        body->body->setWorldTransform(btTransform(body->axes, btVector3(0, 0, 0)));
        body->body->updateInertiaTensor();
        body->body->setLinearVelocity(shiver::vector(motion->velocity));
        body->body->setAngularVelocity(shiver::vector(motion->spin));
    }
}

static void add_pair(ShvBulletWorld *world, const ShvBulletBody &a, const ShvBulletBody &b)
{
    const bool plane = a.kind == SHV_BULLET_PLANE || b.kind == SHV_BULLET_PLANE;
    if (boxes_meet(a, b) && (plane || balls_meet(a, b, world->scale)))
        world->pairs.push_back({std::min(a.number, b.number), std::max(a.number, b.number)});
}

// Of the pairs whose boxes in the tree meet, which are a little larger: those whose own boxes and balls do. Which they are, and
// their order, does not depend on the tree's past.
void Dispatcher::dispatchAllCollisionPairs(btOverlappingPairCache *cache, const btDispatcherInfo &, btDispatcher *)
{
    const btBroadphasePairArray &found = cache->getOverlappingPairArray();
    owner->pairs.clear();
    for (int i = 0; i < found.size(); i++)
        add_pair(owner, body_of(owner, found[i].m_pProxy0), body_of(owner, found[i].m_pProxy1));
    for (const ShvBulletBody *particle : owner->particles)
        for (const ShvBulletBody *obstacle : owner->obstacles) add_pair(owner, *particle, *obstacle);
    std::sort(owner->pairs.begin(), owner->pairs.end(), before);
    owner->status =
        owner->detect(owner->data, owner->pairs.data(), int32_t(owner->pairs.size()), &owner->task, owner->error);
    if (owner->status != SHV_OK) return;
    enter_bodies(owner);
    owner->solver.rest = owner->task.rest;
    make_manifolds(owner);
}

// Bullet's union-find, over what touches instead of over boxes.
void World::calculateSimulationIslands()
{
    if (!touching_islands) {
        btDiscreteDynamicsWorld::calculateSimulationIslands();
        return;
    }
    btUnionFind &sets = m_islandManager->getUnionFind();
    int count = 0;
    for (int i = 0; i < m_collisionObjects.size(); i++)
        if (!m_collisionObjects[i]->isStaticObject()) m_collisionObjects[i]->setIslandTag(count++);
    sets.reset(count);
    for (int i = 0; i < m_dispatcher1->getNumManifolds(); i++) {
        const btPersistentManifold *manifold = m_dispatcher1->getManifoldByIndexInternal(i);
        const btCollisionObject *a = manifold->getBody0(), *b = manifold->getBody1();
        if (!a->isStaticObject() && !b->isStaticObject()) sets.unite(a->getIslandTag(), b->getIslandTag());
    }
    m_islandManager->storeIslandActivationState(this);
}

// What was found is the caller's; nothing stays here.
static void leave(ShvBulletWorld *world)
{
    std::vector<int32_t> first(size_t(world->world.getNumCollisionObjects()), -1); // motions, by islands
    for (int32_t i = 0; i < world->task.motion_count; i++) {
        ShvBulletMotion *motion = &world->task.motions[i];
        btRigidBody *body = body_of(world, motion->body)->body.get();
        int32_t &island = first[size_t(body->getIslandTag())];
        if (island < 0) island = i;
        motion->island = island;
        body->setUserPointer(nullptr);
    }
    world->task = {};
    for (int i = world->dispatcher.getNumManifolds(); i-- > 0;)
        world->dispatcher.releaseManifold(world->dispatcher.getManifoldByIndexInternal(i));
}

ShvStatus shv_bullet_world_step(ShvBulletWorld *world, double step, ShvBulletDetect detect, void *data, ShvError *error)
{
    return guarded(error, [&] {
        world->detect = detect;
        world->data = data;
        world->error = error;
        world->world.stepSimulation(step, 0); // one step of this length
        leave(world);
        return world->status;
    });
}

/* ---- single bodies ---- */

namespace
{
struct Neighbours final : btBroadphaseAabbCallback {
    Neighbours(const ShvBulletWorld *owner, const ShvBulletBody &body, std::vector<int32_t> &list)
        : world(owner), own(body), others(list)
    {
    }
    bool process(const btBroadphaseProxy *proxy) override
    {
        add(body_of(world, proxy));
        return true;
    }
    void add(const ShvBulletBody &other)
    {
        if (&other != &own && boxes_meet(own, other)) others.push_back(other.number);
    }
    const ShvBulletWorld *world;
    const ShvBulletBody &own;
    std::vector<int32_t> &others;
};
} // namespace

ShvStatus shv_bullet_world_near(ShvBulletWorld *world, int32_t number, const int32_t **others, int32_t *count,
                                ShvError *error)
{
    return guarded(error, [&] {
        const ShvBulletBody *body = body_of(world, number);
        world->others.clear();
        Neighbours neighbours(world, *body, world->others);
        if (body->layer != SHV_BULLET_PARTICLE)
            world->broadphase.aabbTest(body->box_low, body->box_high, neighbours);
        else
            for (const ShvBulletBody *obstacle : world->obstacles) neighbours.add(*obstacle);
        if (body->layer == SHV_BULLET_OBSTACLE)
            for (const ShvBulletBody *particle : world->particles) neighbours.add(*particle);
        std::sort(world->others.begin(), world->others.end());
        *others = world->others.data();
        *count = int32_t(world->others.size());
        return SHV_OK;
    });
}

namespace
{
// By Bullet's algorithms: as many points as they give, about the first body's origin.
struct Points final : btCollisionWorld::ContactResultCallback {
    btScalar addSingleResult(btManifoldPoint &point, const btCollisionObjectWrapper *one, int, int,
                             const btCollisionObjectWrapper *, int, int) override
    {
        const btScalar side = one->getCollisionObject()->getUserIndex() == pair->first ? 1 : -1;
        ShvBulletContact contact = *pair;
        for (int k = 0; k < 3; k++) {
            const btScalar middle = (point.m_positionWorldOnA[k] + point.m_positionWorldOnB[k]) / 2;
            contact.arm_first[k] = middle / scale;
            contact.arm_second[k] = (middle - shift[k]) / scale;
            contact.normal[k] = side * point.m_normalWorldOnB[k];
        }
        contact.gap = point.getDistance() / scale;
        contacts->push_back(contact);
        return 0;
    }
    const ShvBulletContact *pair;
    btScalar scale;
    btVector3 shift;
    std::vector<ShvBulletContact> *contacts;
};
} // namespace

static void collide_plainly(ShvBulletWorld *world, const ShvBulletBody &first, const ShvBulletBody &second,
                            btScalar reach)
{
    ShvBulletContact pair = {};
    pair.first = first.number;
    pair.second = second.number;
    Points points;
    points.pair = &pair;
    points.scale = world->scale;
    points.shift = (second.position - first.position) * world->scale;
    points.contacts = &world->collider.contacts;
    points.m_closestDistanceThreshold = reach * world->scale;
    world->collider.contacts.clear();
    const auto place = [&](const ShvBulletBody &body) {
        const bool plane = body.kind == SHV_BULLET_PLANE; // in the world's frame
        const btVector3 origin = plane ? btVector3(0, 0, 0) : body.position;
        body.body->setWorldTransform(
            btTransform(plane ? btMatrix3x3::getIdentity() : body.axes, (origin - first.position) * world->scale));
    };
    place(first);
    place(second);
    world->world.contactPairTest(first.body.get(), second.body.get(), points);
    for (const ShvBulletBody *body : {&first, &second})
        body->body->setWorldTransform(btTransform(body->axes, btVector3(0, 0, 0)));
}

ShvStatus shv_bullet_world_collide(ShvBulletWorld *world, int32_t first, int32_t second, double reach,
                                   ShvBulletContact **contacts, int32_t *count, ShvError *error)
{
    return guarded(error, [&] {
        const ShvBulletBody &one = *body_of(world, first), &other = *body_of(world, second);
        if (world->overrides.exact_contacts)
            world->collider.collide(one, other, reach);
        else
            collide_plainly(world, one, other, reach);
        *contacts = world->collider.contacts.data();
        *count = int32_t(world->collider.contacts.size());
        return SHV_OK;
    });
}
