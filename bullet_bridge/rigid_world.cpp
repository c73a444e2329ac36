#include "bullet_bridge/rigid_world.h"

#include <algorithm>
#include <cmath>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <LinearMath/btAabbUtil2.h>

#include "bullet_bridge/guarded.hpp"
#include "bullet_bridge/layers.hpp"
#include "bullet_bridge/rigid_body.hpp"
#include "bullet_bridge/rigid_solver.hpp"

struct ShvBulletWorld {
    explicit ShvBulletWorld(btScalar length_scale) : scale(length_scale), collider(length_scale) {}
    btScalar scale;
    btDbvtBroadphase broadphase; // of all bodies but planes
    std::vector<const ShvBulletBody *> planes;
    std::vector<std::unique_ptr<ShvBulletBody>> bodies; // by number
    std::vector<ShvBulletPair> pairs;
    std::vector<int32_t> others;
    ShvCollider collider;
    ShvSolver solver;
    ~ShvBulletWorld();
    std::vector<ShvBulletBody *> moved, firsts, seconds;
};

using shiver::guarded;

static btVector3 scaled(const ShvBulletWorld *world, const double *p)
{
    return btVector3(p[0], p[1], p[2]) * world->scale;
}

ShvStatus shv_bullet_world_create(ShvBulletWorld **world, double length, ShvError *error)
{
    *world = nullptr;
    if (!(length > 0.0) || !std::isfinite(length))
        return shv_fail(error, SHV_BAD_INPUT, "bodies of size %g m cannot fly: check the scale of the meshes", length);
    return guarded(error, [&] {
        // A power of two changes no digit. Bullet's own constants (margins of its tree, tolerances of GJK) then meet bodies
        // of some units.
        *world = new ShvBulletWorld(std::exp2(std::round(std::log2(4.0 / length))));
        return SHV_OK;
    });
}

ShvBulletWorld::~ShvBulletWorld()
{
    for (const auto &body : bodies)
        if (body && body->proxy) broadphase.destroyProxy(body->proxy, nullptr);
}

void shv_bullet_world_destroy(ShvBulletWorld *world)
{
    delete world;
}

static bool finite(const double *values, size_t count)
{
    return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
}

static ShvStatus make_hulls(ShvBulletBody *body, const ShvBulletWorld *world, const ShvBulletShape *shape,
                            ShvError *error)
{
    if (shape->hull_count < 1 || !finite(shape->vertices, 3 * size_t(shape->hull_begin[shape->hull_count])))
        return shv_fail(error, SHV_BAD_INPUT, "it has no hull, or one with coordinates that are not finite");
    for (int32_t h = 0; h < shape->hull_count; h++) {
        std::vector<btVector3> points;
        for (int32_t i = shape->hull_begin[h]; i < shape->hull_begin[h + 1]; i++)
            points.push_back(scaled(world, shape->vertices + 3 * size_t(i)));
        ShvConvex part;
        if (points.size() < 4 || !part.make_hull(points)) continue; // a sliver without volume meets nothing
        body->parts.push_back(std::move(part));
    }
    if (body->parts.empty())
        return shv_fail(error, SHV_BAD_INPUT, "it is flat: no convex hull of it has a volume; mend the mesh there");
    return SHV_OK;
}

static ShvStatus make_triangles(ShvBulletBody *body, const ShvBulletWorld *world, const ShvBulletShape *shape,
                                ShvError *error)
{
    if (!finite(shape->vertices, 3 * size_t(shape->vertex_count)))
        return shv_fail(error, SHV_BAD_INPUT, "it has coordinates that are not finite");
    for (int32_t t = 0; t < shape->triangle_count; t++) {
        btVector3 corner[3];
        for (int k = 0; k < 3; k++)
            corner[k] = scaled(world, shape->vertices + 3 * size_t(shape->triangles[3 * t + k]));
        ShvConvex part;
        if (!part.make_triangle(corner[0], corner[1], corner[2])) continue;
        btVector3 low = corner[0], high = corner[0];
        for (int k = 1; k < 3; k++) {
            low.setMin(corner[k]);
            high.setMax(corner[k]);
        }
        btDbvtNode *leaf = body->tree.insert(btDbvtVolume::FromMM(low, high), nullptr);
        leaf->dataAsInt = int(body->parts.size());
        body->parts.push_back(std::move(part));
    }
    if (body->parts.empty()) return shv_fail(error, SHV_BAD_INPUT, "its surface has no area; mend the mesh");
    return SHV_OK;
}

static void measure(ShvBulletBody *body)
{
    if (body->kind == SHV_BULLET_SPHERE) {
        body->high = btVector3(body->radius, body->radius, body->radius);
        body->low = -body->high;
        return;
    }
    body->low = body->high = body->parts[0].vertices[0];
    for (const ShvConvex &part : body->parts)
        for (const btVector3 &vertex : part.vertices) {
            body->low.setMin(vertex);
            body->high.setMax(vertex);
            body->radius = btMax(body->radius, vertex.length());
        }
}

static ShvStatus make_shape(ShvBulletBody *body, const ShvBulletWorld *world, const ShvBulletShape *shape,
                            ShvError *error)
{
    body->kind = shape->kind;
    body->layer = shape->layer;
    ShvStatus status = SHV_OK;
    switch (shape->kind) {
    case SHV_BULLET_PLANE:
        body->normal = btVector3(shape->normal[0], shape->normal[1], shape->normal[2]);
        body->offset = shape->offset * world->scale;
        body->radius = BT_LARGE_FLOAT;
        body->high = btVector3(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
        body->low = -body->high;
        return SHV_OK;
    case SHV_BULLET_SPHERE:
        body->radius = shape->radius * world->scale;
        if (!(body->radius > 0)) return shv_fail(error, SHV_BAD_INPUT, "its radius is %g m", shape->radius);
        break;
    case SHV_BULLET_HULLS:
        status = make_hulls(body, world, shape, error);
        break;
    case SHV_BULLET_TRIANGLES:
        status = make_triangles(body, world, shape, error);
        break;
    }
    if (status == SHV_OK) measure(body);
    return status;
}

static void make_mass(ShvBulletBody *body, double inverse_mass, const double inverse_moment[3])
{
    if (!(inverse_mass > 0.0)) return;
    body->mass = 1.0 / inverse_mass;
    body->inverse_moment = btVector3(inverse_moment[0], inverse_moment[1], inverse_moment[2]);
    btRigidBody::btRigidBodyConstructionInfo info(body->mass, nullptr, nullptr);
    body->body = std::make_unique<btRigidBody>(info);
    body->body->setFlags(0); // no gyroscopic term: free rotation is the caller's
    body->body->setInvInertiaDiagLocal(body->inverse_moment);
}

void ShvBulletBody::yield(btScalar share)
{
    if (share == give) return;
    give = share;
    body->setMassProps(mass / share, btVector3(0, 0, 0));
    body->setInvInertiaDiagLocal(inverse_moment * share);
}

static void set_box(ShvBulletWorld *world, ShvBulletBody *body, const btVector3 &way, double drift, double turn)
{
    body->way = way;
    body->ball = body->radius + drift * world->scale;
    btTransformAabb(body->low, body->high, (drift + turn) * world->scale,
                    btTransform(body->axes, body->position * world->scale), body->box_low, body->box_high);
    const btVector3 none(0, 0, 0);
    btVector3 back = way, ahead = way;
    back.setMin(none);
    ahead.setMax(none);
    body->box_low += back;
    body->box_high += ahead;
    if (body->proxy) world->broadphase.setAabb(body->proxy, body->box_low, body->box_high, nullptr);
}

ShvStatus shv_bullet_world_add(ShvBulletWorld *world, int32_t number, const ShvBulletShape *shape, double inverse_mass,
                               const double inverse_moment[3], ShvError *error)
{
    if (!(inverse_mass >= 0.0) || !std::isfinite(inverse_mass) || !finite(inverse_moment, 3))
        return shv_fail(error, SHV_BAD_INPUT, "its mass or inertia is not a positive number");
    return guarded(error, [&]() -> ShvStatus {
        auto body = std::make_unique<ShvBulletBody>();
        body->number = number;
        const ShvStatus status = make_shape(body.get(), world, shape, error);
        if (status != SHV_OK) return status;
        make_mass(body.get(), inverse_mass, inverse_moment);
        if (size_t(number) >= world->bodies.size()) world->bodies.resize(size_t(number) + 1);
        if (body->kind == SHV_BULLET_PLANE) {
            world->planes.push_back(body.get());
        } else {
            set_box(world, body.get(), btVector3(0, 0, 0), 0, 0);
            const shiver::Filter filter = shiver::filter_of(body->layer, body->body != nullptr);
            body->proxy = world->broadphase.createProxy(body->box_low, body->box_high, 0, body.get(), filter.group,
                                                        filter.mask, nullptr);
        }
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
    world->planes.erase(std::remove(world->planes.begin(), world->planes.end(), body), world->planes.end());
    if (body->proxy) world->broadphase.destroyProxy(body->proxy, nullptr);
    world->bodies[size_t(number)].reset();
}

void shv_bullet_world_place(ShvBulletWorld *world, int32_t number, const double position[3], const double axes[9])
{
    ShvBulletBody *body = body_of(world, number);
    body->position = btVector3(position[0], position[1], position[2]);
    body->axes = btMatrix3x3(axes[0], axes[1], axes[2], axes[3], axes[4], axes[5], axes[6], axes[7], axes[8]);
}

double shv_bullet_world_radius(const ShvBulletWorld *world, int32_t number)
{
    const ShvBulletBody *body = body_of(world, number);
    return body->kind == SHV_BULLET_PLANE ? double(INFINITY) : body->radius / world->scale;
}

ShvStatus shv_bullet_world_reach(ShvBulletWorld *world, int32_t number, const double way[3], double drift, double turn,
                                 ShvError *error)
{
    return guarded(error, [&] {
        ShvBulletBody *body = body_of(world, number);
        if (body->kind == SHV_BULLET_PLANE) return SHV_OK;
        set_box(world, body, scaled(world, way), drift, turn);
        return SHV_OK;
    });
}

static bool before(const ShvBulletPair &a, const ShvBulletPair &b)
{
    return a.first != b.first ? a.first < b.first : a.second < b.second;
}

static bool balls_meet(const ShvBulletBody &a, const ShvBulletBody &b, btScalar scale)
{
    const btVector3 apart = (a.position - b.position) * scale, way = a.way - b.way;
    const btScalar length = way.length2(), reach = a.ball + b.ball;
    const btScalar share = length > 0 ? btMin(btScalar(1), btMax(btScalar(0), -apart.dot(way) / length)) : 0;
    return (apart + share * way).length2() <= reach * reach;
}

static bool boxes_meet(const ShvBulletBody &a, const ShvBulletBody &b)
{
    return TestAabbAgainstAabb2(a.box_low, a.box_high, b.box_low, b.box_high);
}

static void add_pair(ShvBulletWorld *world, const ShvBulletBody *a, const ShvBulletBody *b)
{
    world->pairs.push_back({std::min(a->number, b->number), std::max(a->number, b->number)});
}

// Of the pairs whose boxes in the tree meet, which are a little larger: those whose own boxes and balls do. Which they are, and
// their order, does not depend on the tree's past.
static void list_pairs(ShvBulletWorld *world)
{
    world->broadphase.calculateOverlappingPairs(nullptr);
    const btBroadphasePairArray &found = world->broadphase.getOverlappingPairCache()->getOverlappingPairArray();
    for (int i = 0; i < found.size(); i++) {
        const auto *a = static_cast<const ShvBulletBody *>(found[i].m_pProxy0->m_clientObject);
        const auto *b = static_cast<const ShvBulletBody *>(found[i].m_pProxy1->m_clientObject);
        if (boxes_meet(*a, *b) && balls_meet(*a, *b, world->scale)) add_pair(world, a, b);
    }
}

static bool reaches(const ShvBulletBody &body, const ShvBulletBody &plane)
{
    const btVector3 centre = (body.box_low + body.box_high) / 2, half = (body.box_high - body.box_low) / 2;
    return plane.normal.dot(centre) - plane.normal.absolute().dot(half) <= plane.offset;
}

ShvStatus shv_bullet_world_pairs(ShvBulletWorld *world, const ShvBulletPair **pairs, int32_t *count, ShvError *error)
{
    return guarded(error, [&] {
        world->pairs.clear();
        list_pairs(world);
        for (const auto &body : world->bodies) {
            if (!body || !body->body) continue;
            for (const ShvBulletBody *plane : world->planes)
                if (reaches(*body, *plane)) add_pair(world, body.get(), plane);
        }
        std::sort(world->pairs.begin(), world->pairs.end(), before);
        *pairs = world->pairs.data();
        *count = int32_t(world->pairs.size());
        return SHV_OK;
    });
}

namespace
{
struct Neighbours final : btBroadphaseAabbCallback {
    Neighbours(const ShvBulletBody &body, std::vector<int32_t> &list) : own(body), others(list) {}
    bool process(const btBroadphaseProxy *proxy) override
    {
        const auto *other = static_cast<const ShvBulletBody *>(proxy->m_clientObject);
        if (other != &own && boxes_meet(own, *other)) others.push_back(other->number);
        return true;
    }
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
        Neighbours neighbours(*body, world->others);
        world->broadphase.aabbTest(body->box_low, body->box_high, neighbours);
        for (const ShvBulletBody *plane : world->planes)
            if (reaches(*body, *plane)) world->others.push_back(plane->number);
        std::sort(world->others.begin(), world->others.end());
        *others = world->others.data();
        *count = int32_t(world->others.size());
        return SHV_OK;
    });
}

ShvStatus shv_bullet_world_collide(ShvBulletWorld *world, int32_t first, int32_t second, double reach,
                                   ShvBulletContact **contacts, int32_t *count, ShvError *error)
{
    return guarded(error, [&] {
        world->collider.collide(*body_of(world, first), *body_of(world, second), reach);
        *contacts = world->collider.contacts.data();
        *count = int32_t(world->collider.contacts.size());
        return SHV_OK;
    });
}

ShvStatus shv_bullet_world_solve(ShvBulletWorld *world, ShvBulletMotion *motions, int32_t motion_count,
                                 ShvBulletContact *contacts, int32_t contact_count, const ShvBulletSolve *settings,
                                 ShvError *error)
{
    return guarded(error, [&] {
        const auto massive = [&](int32_t number) {
            ShvBulletBody *body = body_of(world, number);
            return body->body ? body : nullptr;
        };
        world->moved.clear();
        world->firsts.clear();
        world->seconds.clear();
        for (int32_t i = 0; i < motion_count; i++) world->moved.push_back(body_of(world, motions[i].body));
        for (int32_t i = 0; i < contact_count; i++) {
            world->firsts.push_back(massive(contacts[i].first));
            world->seconds.push_back(massive(contacts[i].second));
        }
        world->solver.solve(world->moved, motions, world->firsts, world->seconds, contacts, contact_count, *settings);
        return SHV_OK;
    });
}
