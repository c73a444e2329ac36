// Bullet's sequential impulses with this program's targets: each contact leaves at least its wanted normal velocity, and
// friction keeps to the cone instead of the pyramid.
#ifndef BULLET_BRIDGE_RIGID_SOLVER_HPP
#define BULLET_BRIDGE_RIGID_SOLVER_HPP

#include <vector>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include "bullet_bridge/rigid_body.hpp"

class ShvSolver : public btSequentialImpulseConstraintSolver
{
  public:
    ShvSolver();
    // `bodies[i]` belongs to motions[i]; `find(number)` is the body with mass under that number, or NULL.
    void solve(const std::vector<ShvBulletBody *> &bodies, ShvBulletMotion *motions,
               const std::vector<ShvBulletBody *> &firsts, const std::vector<ShvBulletBody *> &seconds,
               ShvBulletContact *contacts, int contact_count, const ShvBulletSolve &settings);

  protected:
    btScalar solveGroupCacheFriendlySetup(btCollisionObject **objects, int count, btPersistentManifold **manifolds,
                                          int manifold_count, btTypedConstraint **constraints, int constraint_count,
                                          const btContactSolverInfo &info, btIDebugDraw *drawer) override;
    btScalar solveSingleIteration(int iteration, btCollisionObject **objects, int count,
                                  btPersistentManifold **manifolds, int manifold_count, btTypedConstraint **constraints,
                                  int constraint_count, const btContactSolverInfo &info, btIDebugDraw *drawer) override;
    btScalar solveGroupCacheFriendlyFinish(btCollisionObject **objects, int count,
                                           const btContactSolverInfo &info) override;

  private:
    static ShvBulletContact &contact_of(const btSolverConstraint &row);
    void fill(const std::vector<ShvBulletBody *> &firsts, const std::vector<ShvBulletBody *> &seconds,
              ShvBulletContact *contacts, int count);
    btScalar mobility_of(const btSolverConstraint &row) const;
    btScalar rub(const btSolverConstraint &row, btScalar mobility);

    btRigidBody ground;
    std::vector<btPersistentManifold> manifolds;
    std::vector<btPersistentManifold *> manifold_pointers;
    std::vector<btCollisionObject *> objects;
    std::vector<btScalar> mobilities; // of each contact: its largest velocity along the surface for a unit impulse
    ShvBulletMotion *motion = nullptr;
};

#endif
