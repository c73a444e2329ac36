#include "bullet_bridge/dynamics_world.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <btBulletDynamicsCommon.h>

#include "bullet_bridge/body_shapes.hpp"
#include "bullet_bridge/guarded.hpp"
#include "bullet_bridge/layers.hpp"
#include "bullet_bridge/numbers.hpp"

namespace
{

using Pair = std::pair<int32_t, int32_t>; // of numbers, the smaller one first

struct Body {
    ShvBulletLayer layer = SHV_BULLET_BODY;
    btScalar friction = 0, restitution = 0;
    shiver::BodyShapes shapes; // in units
    std::unique_ptr<btRigidBody> body;
    btVector3 velocity{0, 0, 0}, spin{0, 0, 0}; // before the step
    bool born = true;                           // since the last step
    ShvDynamicsTouch touch = SHV_DYNAMICS_FREE;
};

class World final : public btDiscreteDynamicsWorld
{
  public:
    using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
    ShvDynamicsWorld *owner = nullptr;

  protected:
    void calculateSimulationIslands() override;
    // Velocities of kinematic bodies are told, not taken from their poses.
    void saveKinematicState(btScalar) override {}
};

} // namespace

struct ShvDynamicsWorld {
    explicit ShvDynamicsWorld(const ShvDynamicsSettings &given);
    ~ShvDynamicsWorld();
    ShvDynamicsSettings settings;
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    World world{&dispatcher, &broadphase, &solver, &configuration};
    std::vector<std::unique_ptr<Body>> bodies;     // by number
    std::map<Pair, btScalar> allowed_penetrations; // overlaps that are let be, in units
    std::vector<Pair> touching, touched;           // in this step and the last, in order
    std::vector<ShvDynamicsContact> contacts;
    ShvDynamicsJudge judge = nullptr;
    void *judge_data = nullptr;
    btScalar step = 0;

    Body &of(const btCollisionObject *object) const { return *bodies[size_t(object->getUserIndex())]; }
    void judge_contacts();
    void set_laws();

  private:
    btScalar closing_acceleration(const btPersistentManifold *manifold, const btVector3 &normal) const;
    bool sharpen(const btPersistentManifold *manifold, btManifoldPoint &point, btScalar restitution) const;
    void set_law(btPersistentManifold *manifold);
    void allow_overlaps();
    btScalar closing(const btPersistentManifold *manifold, const btManifoldPoint &point) const;
    void list_contacts();
    void list_contact(const btPersistentManifold *manifold, const btManifoldPoint &point);
};

/* ---- life ---- */

ShvDynamicsWorld::ShvDynamicsWorld(const ShvDynamicsSettings &given) : settings(given)
{
    world.owner = this;
    btContactSolverInfo &info = world.getSolverInfo();
    if (settings.sharp_impacts) {
        info.m_splitImpulsePenetrationThreshold = 0;
        // Otherwise a manifold gets a point a step, and what lands flat is thrown back by one corner.
        configuration.setPlaneConvexMultipointIterations();
        configuration.setConvexConvexMultipointIterations();
    }
    world.getDispatchInfo().m_deterministicOverlappingPairs = settings.sorted_pairs;
}

ShvDynamicsWorld::~ShvDynamicsWorld()
{
    for (const auto &body : bodies)
        if (body) world.removeRigidBody(body->body.get());
}

ShvStatus shv_dynamics_world_create(ShvDynamicsWorld **world, const ShvDynamicsSettings *settings, ShvError *error)
{
    *world = nullptr;
    return shiver::guarded(error, [&] {
        *world = new ShvDynamicsWorld(*settings);
        return SHV_OK;
    });
}

void shv_dynamics_world_destroy(ShvDynamicsWorld *world)
{
    delete world;
}

/* ---- bodies ---- */

static btTransform pose_of(const ShvDynamicsMotion &motion, btScalar unit)
{
    return btTransform(shiver::matrix(motion.axes), shiver::vector(motion.position) / unit);
}

static void correct(btRigidBody *body, const ShvDynamicsMotion &motion, btScalar unit)
{
    body->setLinearVelocity(shiver::vector(motion.velocity) / unit);
    body->setAngularVelocity(shiver::vector(motion.spin));
    body->setCenterOfMassTransform(pose_of(motion, unit));
}

static void place(btRigidBody *body, const ShvDynamicsMotion &motion, btScalar unit)
{
    correct(body, motion, unit);
    const btVector3 &velocity = body->getLinearVelocity(), &spin = body->getAngularVelocity();
    if (body->isKinematicObject()) /* what stands still lets sleep what lies on it */
        body->forceActivationState(velocity.isZero() && spin.isZero() ? ISLAND_SLEEPING : DISABLE_DEACTIVATION);
    else
        body->activate(true);
}

static void make_body(Body *made, const ShvDynamicsBody &given, const ShvDynamicsSettings &settings)
{
    const bool moves = given.inverse_mass > 0;
    made->layer = given.shape.layer;
    made->friction = given.friction;
    made->restitution = given.restitution;
    btRigidBody::btRigidBodyConstructionInfo info(moves ? 1 / given.inverse_mass : 0, nullptr, made->shapes.shape);
    made->body = std::make_unique<btRigidBody>(info);
    if (moves)
        made->body->setInvInertiaDiagLocal(shiver::vector(given.inverse_moment) * (settings.unit * settings.unit));
    else if (given.shape.kind != SHV_BULLET_PLANE)
        made->body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    if (settings.exact_flight) made->body->setFlags(0);
}

static ShvStatus check_body(const Body &body, const ShvDynamicsSettings &settings, ShvError *error)
{
    if (body.shapes.radius > settings.margin) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "its radius of %.3g m is within the margin of %.3g m that Bullet lays round it; give a smaller "
                    "bullet_plain.unit or .margin",
                    body.shapes.radius * settings.unit, settings.margin * settings.unit);
}

ShvStatus shv_dynamics_world_add(ShvDynamicsWorld *world, int32_t number, const ShvDynamicsBody *given,
                                 const ShvDynamicsMotion *motion, ShvError *error)
{
    return shiver::guarded(error, [&]() -> ShvStatus {
        auto made = std::make_unique<Body>();
        const ShvDynamicsSettings &settings = world->settings;
        ShvStatus status = shiver::make_shapes(&made->shapes, given->shape, settings.unit, settings.margin, error);
        if (status == SHV_OK && given->shape.kind == SHV_BULLET_HULLS) status = check_body(*made, settings, error);
        if (status != SHV_OK) return status;
        make_body(made.get(), *given, world->settings);
        made->body->setUserIndex(number);
        place(made->body.get(), *motion, world->settings.unit);
        if (size_t(number) >= world->bodies.size()) world->bodies.resize(size_t(number) + 1);
        if (world->settings.sorted_pairs) world->broadphase.m_gid = number; // numbers the new body one more
        const shiver::Filter filter = shiver::filter_of(made->layer, given->inverse_mass > 0);
        world->world.addRigidBody(made->body.get(), filter.group, filter.mask);
        world->bodies[size_t(number)] = std::move(made);
        return SHV_OK;
    });
}

void shv_dynamics_world_remove(ShvDynamicsWorld *world, int32_t number)
{
    btRigidBody *body = world->bodies[size_t(number)]->body.get();
    for (int i = 0; i < world->dispatcher.getNumManifolds(); i++) {
        const btPersistentManifold *manifold = world->dispatcher.getManifoldByIndexInternal(i);
        if (manifold->getBody0() == body) manifold->getBody1()->activate();
        if (manifold->getBody1() == body) manifold->getBody0()->activate();
    }
    for (auto at = world->allowed_penetrations.begin(); at != world->allowed_penetrations.end();)
        at = at->first.first == number || at->first.second == number ? world->allowed_penetrations.erase(at)
                                                                     : std::next(at);
    world->world.removeRigidBody(body);
    world->bodies[size_t(number)].reset();
}

void shv_dynamics_world_place(ShvDynamicsWorld *world, int32_t number, const ShvDynamicsMotion *motion)
{
    place(world->bodies[size_t(number)]->body.get(), *motion, world->settings.unit);
}

void shv_dynamics_world_correct(ShvDynamicsWorld *world, int32_t number, const ShvDynamicsMotion *motion)
{
    const Body &body = *world->bodies[size_t(number)];
    correct(body.body.get(), *motion, world->settings.unit);
    if (body.touch == SHV_DYNAMICS_FREE) body.body->setDeactivationTime(0);
}

bool shv_dynamics_world_read(const ShvDynamicsWorld *world, int32_t number, ShvDynamicsMotion *motion)
{
    const btRigidBody *body = world->bodies[size_t(number)]->body.get();
    const btScalar unit = world->settings.unit;
    const btTransform &pose = body->getWorldTransform();
    shiver::store(pose.getOrigin() * unit, motion->position);
    for (int i = 0; i < 9; i++) motion->axes[i] = pose.getBasis()[i / 3][i % 3];
    shiver::store(body->getLinearVelocity() * unit, motion->velocity);
    shiver::store(body->getAngularVelocity(), motion->spin);
    return body->isActive();
}

ShvDynamicsTouch shv_dynamics_world_touch(const ShvDynamicsWorld *world, int32_t number)
{
    return world->bodies[size_t(number)]->touch;
}

void shv_dynamics_world_wake_all(ShvDynamicsWorld *world)
{
    for (const auto &body : world->bodies)
        if (body && !body->body->isStaticOrKinematicObject()) body->body->activate(true);
}

/* ---- between detection and solution ---- */

static Pair pair_of(const btPersistentManifold *manifold)
{
    return std::minmax(int32_t(manifold->getBody0()->getUserIndex()), int32_t(manifold->getBody1()->getUserIndex()));
}

static bool has(const std::vector<Pair> &pairs, const Pair &pair)
{
    return std::binary_search(pairs.begin(), pairs.end(), pair);
}

btScalar ShvDynamicsWorld::closing(const btPersistentManifold *manifold, const btManifoldPoint &point) const
{
    const btRigidBody *a = of(manifold->getBody0()).body.get(), *b = of(manifold->getBody1()).body.get();
    const btVector3 relative = a->getVelocityInLocalPoint(point.getPositionWorldOnA() - a->getCenterOfMassPosition()) -
                               b->getVelocityInLocalPoint(point.getPositionWorldOnB() - b->getCenterOfMassPosition());
    return -relative.dot(point.m_normalWorldOnB);
}

// Overlaps at birth are the pair's; the least one seen since is what it keeps.
void ShvDynamicsWorld::allow_overlaps()
{
    std::map<Pair, btScalar> deepest;
    for (int i = 0; i < dispatcher.getNumManifolds(); i++) {
        const btPersistentManifold *manifold = dispatcher.getManifoldByIndexInternal(i);
        for (int k = 0; k < manifold->getNumContacts(); k++) {
            btScalar &depth = deepest.emplace(pair_of(manifold), 0).first->second;
            depth = btMax(depth, -manifold->getContactPoint(k).getDistance());
        }
    }
    for (auto at = allowed_penetrations.begin(); at != allowed_penetrations.end();) {
        const auto now = deepest.find(at->first);
        at->second = now == deepest.end() ? 0 : btMin(at->second, now->second);
        at = at->second > 0 ? std::next(at) : allowed_penetrations.erase(at);
    }
    for (const auto &item : deepest) {
        const bool born = bodies[size_t(item.first.first)]->born || bodies[size_t(item.first.second)]->born;
        if (born && item.second > 0) allowed_penetrations.emplace(item.first, item.second);
    }
}

// Of the first against the second at a point, along its normal, towards each other; without contacts.
btScalar ShvDynamicsWorld::closing_acceleration(const btPersistentManifold *manifold, const btVector3 &normal) const
{
    const bool falls_a = of(manifold->getBody0()).body->getInvMass() > 0,
               falls_b = of(manifold->getBody1()).body->getInvMass() > 0;
    return -normal.dot(world.getGravity()) * (btScalar(falls_a) - btScalar(falls_b));
}

// A rebound that is found at a depth is that of the touch before it: with the speed of the touch, its share of that, and what a
// parabola makes of it until the step's end. Nothing else moves the bodies out; they fly out.
bool ShvDynamicsWorld::sharpen(const btPersistentManifold *manifold, btManifoldPoint &point, btScalar restitution) const
{
    const btScalar speed = closing(manifold, point), depth = -point.getDistance();
    const btScalar slow = world.getSolverInfo().m_restitutionVelocityThreshold;
    point.m_combinedRestitution = 0;
    if (depth > 0 && restitution > 0 && speed < 0) point.setDistance(0);
    if (!(restitution > 0) || !(speed > slow)) return false;
    if (depth < 0) return true; // its turn is to come
    const btScalar fall = 2 * closing_acceleration(manifold, point.m_normalWorldOnB) * depth;
    const btScalar touch = btMax(btScalar(0), speed * speed - fall);
    const btScalar back = btSqrt(btMax(btScalar(0), restitution * restitution * touch + fall)) -
                          closing_acceleration(manifold, point.m_normalWorldOnB) * step;
    if (!(back > 0)) return true;
    point.m_combinedRestitution = back / speed;
    point.setDistance(0);
    return true;
}

static void pair_law(const Body &a, const Body &b, const ShvDynamicsSettings &settings, btScalar *friction,
                     btScalar *restitution)
{
    const bool own_a = a.layer != SHV_BULLET_OBSTACLE, own_b = b.layer != SHV_BULLET_OBSTACLE;
    *friction = own_a && own_b ? settings.friction
                : own_a        ? b.friction
                : own_b        ? a.friction
                               : btSqrt(a.friction * b.friction);
    *restitution = own_a && own_b ? settings.restitution
                   : own_a        ? b.restitution
                   : own_b        ? a.restitution
                                  : btMax(a.restitution, b.restitution);
}

// The pair's friction and restitution; the overlap that it may keep; and which of its points take part.
void ShvDynamicsWorld::set_law(btPersistentManifold *manifold)
{
    btScalar friction, restitution;
    pair_law(of(manifold->getBody0()), of(manifold->getBody1()), settings, &friction, &restitution);
    const auto allowed_penetration = allowed_penetrations.find(pair_of(manifold));
    bool rebounds = false;
    for (int k = 0; k < manifold->getNumContacts(); k++) {
        btManifoldPoint &point = manifold->getContactPoint(k);
        point.m_combinedFriction = friction;
        point.m_combinedRestitution = restitution;
        if (allowed_penetration != allowed_penetrations.end())
            point.setDistance(point.getDistance() + allowed_penetration->second);
        if (settings.sharp_impacts) rebounds = sharpen(manifold, point, restitution) || rebounds;
    }
    const btScalar reach = rebounds ? 0 : BT_LARGE_FLOAT;
    if (settings.sharp_impacts) manifold->setContactProcessingThreshold(reach);
    for (int k = 0; k < manifold->getNumContacts(); k++) {
        btManifoldPoint &point = manifold->getContactPoint(k);
        if (point.getDistance() > reach) point.m_appliedImpulse = point.m_appliedImpulseLateral1 = 0;
    }
}

void ShvDynamicsWorld::set_laws()
{
    if (settings.keep_overlaps) allow_overlaps();
    for (int i = 0; i < dispatcher.getNumManifolds(); i++) set_law(dispatcher.getManifoldByIndexInternal(i));
    for (const auto &body : bodies)
        if (body) body->born = false;
}

void ShvDynamicsWorld::list_contact(const btPersistentManifold *manifold, const btManifoldPoint &point)
{
    const Pair pair = pair_of(manifold);
    const btScalar speed = closing(manifold, point), sign = manifold->getBody0()->getUserIndex() == pair.first ? 1 : -1;
    if (point.getDistance() > btMax(btScalar(0), speed * step)) return;
    if (touching.empty() || touching.back() != pair) touching.push_back(pair);
    ShvDynamicsContact contact = {};
    contact.first = pair.first;
    contact.second = pair.second;
    contact.closing = btMax(btScalar(0), speed) * settings.unit;
    shiver::store((point.getPositionWorldOnA() + point.getPositionWorldOnB()) * (settings.unit / 2), contact.point);
    shiver::store(point.m_normalWorldOnB * sign, contact.normal);
    contact.fresh = !has(touched, pair);
    contacts.push_back(contact);
}

// The fastest contact of each pair, by pairs.
void ShvDynamicsWorld::list_contacts()
{
    contacts.clear();
    touched.swap(touching);
    touching.clear();
    for (int i = 0; i < dispatcher.getNumManifolds(); i++) {
        const btPersistentManifold *manifold = dispatcher.getManifoldByIndexInternal(i);
        for (int k = 0; k < manifold->getNumContacts(); k++) list_contact(manifold, manifold->getContactPoint(k));
    }
    std::sort(touching.begin(), touching.end());
    touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
    std::stable_sort(contacts.begin(), contacts.end(), [](const ShvDynamicsContact &a, const ShvDynamicsContact &b) {
        const Pair x(a.first, a.second), y(b.first, b.second);
        return x != y ? x < y : a.closing > b.closing;
    });
    const auto same = [](const ShvDynamicsContact &a, const ShvDynamicsContact &b) {
        return a.first == b.first && a.second == b.second;
    };
    contacts.erase(std::unique(contacts.begin(), contacts.end(), same), contacts.end());
}

void ShvDynamicsWorld::judge_contacts()
{
    if (!judge) return;
    list_contacts();
    if (!contacts.empty()) judge(judge_data, contacts.data(), int32_t(contacts.size()));
}

void World::calculateSimulationIslands()
{
    owner->set_laws();
    owner->judge_contacts();
    btDiscreteDynamicsWorld::calculateSimulationIslands();
}

/* ---- step ---- */

// Impulses on mean velocities; and who was pushed.
static double book_contacts(ShvDynamicsWorld *world)
{
    const ShvDynamicsSettings &settings = world->settings;
    btScalar work = 0;
    for (int i = 0; i < world->dispatcher.getNumManifolds(); i++) {
        const btPersistentManifold *manifold = world->dispatcher.getManifoldByIndexInternal(i);
        Body &a = world->of(manifold->getBody0()), &b = world->of(manifold->getBody1());
        if (!a.body->isActive() && !b.body->isActive()) continue;
        const auto mean = [](const Body &own, const btVector3 &point) {
            if (own.body->isStaticOrKinematicObject()) return btVector3(0, 0, 0);
            const btVector3 arm = point - own.body->getCenterOfMassPosition();
            return (own.velocity + own.spin.cross(arm) + own.body->getVelocityInLocalPoint(arm)) / 2;
        };
        for (int k = 0; k < manifold->getNumContacts(); k++) {
            const btManifoldPoint &point = manifold->getContactPoint(k);
            if (!(point.m_appliedImpulse > 0)) continue;
            const bool strikes = settings.sharp_impacts && point.m_combinedRestitution > 0;
            const ShvDynamicsTouch touch = strikes ? SHV_DYNAMICS_STRUCK : SHV_DYNAMICS_HELD;
            a.touch = std::max(a.touch, touch);
            b.touch = std::max(b.touch, touch);
            const btVector3 relative = mean(a, point.getPositionWorldOnA()) - mean(b, point.getPositionWorldOnB());
            work += point.m_appliedImpulseLateral1 * relative.dot(point.m_lateralFrictionDir1);
        }
    }
    return work * settings.unit * settings.unit;
}

ShvStatus shv_dynamics_world_step(ShvDynamicsWorld *world, double step, const double gravity[3], ShvDynamicsJudge judge,
                                  void *data, double *friction_work, ShvError *error)
{
    return shiver::guarded(error, [&] {
        world->judge = judge;
        world->judge_data = data;
        world->step = step;
        world->world.setGravity(shiver::vector(gravity) / world->settings.unit);
        for (const auto &body : world->bodies) {
            if (!body) continue;
            body->velocity = body->body->getLinearVelocity();
            body->spin = body->body->getAngularVelocity();
            body->touch = SHV_DYNAMICS_FREE;
        }
        world->world.stepSimulation(step, 0); // one step of this length
        *friction_work = book_contacts(world);
        return SHV_OK;
    });
}
