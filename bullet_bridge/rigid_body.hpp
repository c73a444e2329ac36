// What the world keeps of a body.
#ifndef BULLET_BRIDGE_RIGID_BODY_HPP
#define BULLET_BRIDGE_RIGID_BODY_HPP

#include <memory>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "bullet_bridge/body_shapes.hpp"

struct ShvBulletBody {
    int32_t number = 0;
    ShvBulletKind kind = SHV_BULLET_PLANE;
    ShvBulletLayer layer = SHV_BULLET_BODY;
    size_t place = 0;          // among the particles or the obstacles
    shiver::BodyShapes shapes; // scaled
    btVector3 normal{0, 0, 0}; // plane, scaled offset
    btScalar offset = 0;
    btScalar radius = 0;                   // about the origin, scaled
    btVector3 low{0, 0, 0}, high{0, 0, 0}; // box in the body's frame, scaled
    btVector3 position{0, 0, 0};           // m, world: not scaled, so that far from the origin nothing is lost
    btMatrix3x3 axes{1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::unique_ptr<btRigidBody> body; // as the solver sees it: turned, its origin in the world's. User: number, motion
    btScalar mass = 0;
    btVector3 inverse_moment{0, 0, 0};
    btVector3 box_low{0, 0, 0}, box_high{0, 0, 0}; // box in the world on its way, scaled
    btVector3 displacement{0, 0, 0};               // scaled
    btScalar ball = 0;                             // radius with its drift, scaled
};

// Finds contacts of two bodies; lengths inside are scaled by `scale`.
class ShvCollider
{
  public:
    explicit ShvCollider(btScalar length_scale) : scale(length_scale) {}
    void collide(const ShvBulletBody &first, const ShvBulletBody &second, btScalar reach);
    std::vector<ShvBulletContact> contacts;

  private:
    struct Point {
        btVector3 place; // middle of the gap, scaled, from the first body's origin
        btScalar gap;
    };
    struct Placed { // a convex part in the pair's frame
        const ShvConvex *convex;
        const btMatrix3x3 *axes;
        btVector3 origin;
        btVector3 at(size_t vertex) const { return origin + *axes * convex->vertices[vertex]; }
        btScalar highest(const btVector3 &normal) const { return convex->highest(normal * *axes); }
    };
    struct Near {
        Placed part;
        btVector3 middle, half; // of its box
    };
    struct Axis {
        btVector3 normal{0, 0, 0}; // from the second part to the first
        btScalar gap = -BT_LARGE_FLOAT;
        bool witnessed = false; // by GJK, in the middle of the gap:
        btVector3 witness{0, 0, 0};
    };
    struct Face {
        size_t index;
        bool of_first;
        btScalar along; // cosine to the contact's normal
    };

    void pair(const ShvBulletBody &first, const ShvBulletBody &second);
    void plane_body(const ShvBulletBody &plane, const ShvBulletBody &body, btScalar side);
    void sphere_sphere();
    void sphere_parts(const ShvBulletBody &sphere, const ShvBulletBody &other, const btVector3 &centre,
                      const btVector3 &origin, btScalar side);
    void sphere_part(const ShvBulletBody &sphere, const Placed &part, bool surface, const btVector3 &centre,
                     btScalar side);
    void near_parts(const ShvBulletBody &own, const btVector3 &origin, const ShvBulletBody &other,
                    const btVector3 &other_origin, std::vector<Near> *list) const;
    void parts_parts();
    // A surface's part is seen from outside only.
    void part_part(const Placed &first, const Placed &second, bool surface_first, bool surface_second);
    btScalar gap_along(const Placed &first, const Placed &second, const btVector3 &normal) const;
    bool try_nearest(const Placed &first, const Placed &second, btScalar share_first, btScalar share_second,
                     const btVector3 &guess, Axis *axis) const;
    void try_faces(const Placed &first, const Placed &second, const btVector3 &outward_first,
                   const btVector3 &outward_second, Axis *axis) const;
    Face nearest_face(const Placed &first, const Placed &second, const btVector3 &normal) const;
    bool emit_faces(const Placed &first, const Placed &second, const Axis &axis);
    const std::vector<int> &near_triangles(const ShvBulletBody &surface, const btVector3 &local, btScalar reach);
    void parts_surface(const ShvBulletBody &parts, const ShvBulletBody &surface, const btVector3 &parts_origin,
                       const btVector3 &surface_origin, bool swapped);
    bool clip(const Placed &reference, size_t face, const Placed &incident, const btVector3 &outward);
    void reduce();
    void emit(const btVector3 &normal);

    const btScalar scale;
    const ShvBulletBody *a = nullptr, *b = nullptr;
    btVector3 shift{0, 0, 0}; // origin of the second from that of the first, scaled
    btScalar limit = 0;
    std::vector<Point> points;
    std::vector<btVector3> polygon, clipped;
    std::vector<Near> near_first, near_second;
    std::vector<int> triangles;
};

#endif
