// Bullet's sequential impulses with this program's targets: each contact leaves at least its wanted normal velocity, and
// friction keeps to the cone instead of the pyramid.
#ifndef BULLET_BRIDGE_RIGID_SOLVER_HPP
#define BULLET_BRIDGE_RIGID_SOLVER_HPP

#include <vector>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include "bullet_bridge/rigid_body.hpp"
#include "bullet_bridge/rigid_mixing.hpp"

class ShvSolver : public btSequentialImpulseConstraintSolver
{
  public:
    static btContactSolverInfo settings();
    // A point of a manifold whose bodies stand at the origin.
    static void set_point(btManifoldPoint *point, ShvBulletContact *contact);
    double rest = 0; // m/s
    bool settles = true;
    // An island of ShvBulletBody by their numbers; its motions and contacts get the results.
    btScalar solveGroup(btCollisionObject **objects, int count, btPersistentManifold **manifolds, int manifold_count,
                        btTypedConstraint **constraints, int constraint_count, const btContactSolverInfo &info,
                        btIDebugDraw *drawer, btDispatcher *dispatcher) override;

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
    struct Grip {          // of a contact
        btScalar friction; // Coulomb's coefficient
        btScalar mobility; // the largest velocity along the surface for a unit impulse
    };
    static ShvBulletContact &contact_of(const btSolverConstraint &row);
    btScalar mobility_of(const btSolverConstraint &row) const;
    btScalar rub(const btSolverConstraint &row, const Grip &grip);

    btScalar sweep();
    void read(std::vector<btScalar> *impulses) const;
    void apply(const std::vector<btScalar> &impulses);
    bool moderate(const std::vector<btScalar> &impulses) const;

    std::vector<Grip> grips;
    bool restful = false; // rest would do for every contact, so that they do not contradict each other
    ShvMixing mixing;
    std::vector<btScalar> before, after; // impulses times the roots of the rows' mobilities: their squares are energies
};

#endif
