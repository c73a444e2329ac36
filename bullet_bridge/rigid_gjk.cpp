#include "bullet_bridge/rigid_gjk.hpp"

#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include "bullet_bridge/numbers.hpp"

enum { most_rounds = 64 };
// Of the squared distance: an improvement by less is none (a direction off by 1e-6). Of the largest squared corner: the origin
// is reached.
static const btScalar converged = 1e-12, reached = 1e-24;

static btVector3 farthest(const ShvCore &core, const btVector3 &direction)
{
    const btVector3 *best = nullptr;
    btScalar most = -BT_LARGE_FLOAT;
    for (const btVector3 &vertex : core.vertices) {
        const btScalar along = direction.dot(vertex);
        if (along > most) {
            most = along;
            best = &vertex;
        }
    }
    return best ? core.centre + core.share * (*best - core.centre) : core.centre;
}

ShvNearest shv_nearest(const ShvCore &first, const ShvCore &second, const btMatrix3x3 &axes, const btVector3 &origin,
                       const btVector3 &guess, btScalar far)
{
    // four: the scene's largest bodies have that size, and keep their unit
    const btScalar unit = 4 * shiver::simplex_unit(first.radius, second.radius);
    ShvNearest result;
    btVoronoiSimplexSolver simplex;
    simplex.reset();
    simplex.setEqualVertexThreshold(0);
    btVector3 nearest = guess;
    btScalar distance2 = BT_LARGE_FLOAT, largest2 = 0;
    for (int round = 0; round < most_rounds; round++) {
        const btVector3 p = farthest(first, -nearest) * unit,
                        q = (origin + axes * farthest(second, nearest * axes)) * unit, w = p - q;
        const btScalar along = nearest.dot(w);
        result.far = along > 0 && along * along > nearest.length2() * (far * unit) * (far * unit);
        if (result.far) return result;
        if (distance2 - along <= converged * distance2 || simplex.inSimplex(w)) break;
        largest2 = btMax(largest2, w.length2());
        const btVoronoiSimplexSolver before = simplex;
        simplex.addVertex(w, p, q);
        btVector3 nearer;
        if (!simplex.closest(nearer)) {
            simplex = before;
            break;
        }
        const btScalar nearer2 = nearer.length2();
        if (simplex.fullSimplex() || nearer2 <= reached * largest2) return result;
        if (nearer2 >= distance2) { // round-off
            simplex = before;
            break;
        }
        nearest = nearer;
        distance2 = nearer2;
    }
    if (simplex.emptySimplex()) return result;
    btVector3 p, q;
    simplex.compute_points(p, q);
    result.apart = true;
    result.normal = nearest.normalized();
    result.middle = (p + q) / (2 * unit);
    return result;
}
