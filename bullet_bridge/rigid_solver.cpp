#include "bullet_bridge/rigid_solver.hpp"

#include <algorithm>

// Islands that sweeps alone have not settled by then are helped, when there is a solution: impulses of contacts that
// contradict each other (a ram that presses a body into the floor) have no limit, to which no mix should lead.
static const int plain_sweeps = 40, sweeps_a_mix = 4; // a mix costs as much as two sweeps
static const btScalar most_of_momentum = 10;
// A sweep that changes no velocity by more is the last: of the speed of rest, of that of the island's fastest body.
static const btScalar settled_of_rest = 1e-5, settled_of_speed = 1e-10;

static btVector3 load(const double *p)
{
    return btVector3(p[0], p[1], p[2]);
}

static void store(double *p, const btVector3 &v)
{
    for (int k = 0; k < 3; k++) p[k] = v[k];
}

ShvBulletContact &ShvSolver::contact_of(const btSolverConstraint &row)
{
    return *static_cast<ShvBulletContact *>(
        static_cast<btManifoldPoint *>(row.m_originalContactPoint)->m_userPersistentData);
}

void ShvSolver::set_point(btManifoldPoint *point, ShvBulletContact *contact)
{
    *point = btManifoldPoint(btVector3(0, 0, 0), btVector3(0, 0, 0), load(contact->normal), 0);
    point->m_positionWorldOnA = load(contact->arm_first);
    point->m_positionWorldOnB = load(contact->arm_second);
    point->m_combinedFriction = contact->friction;
    point->m_contactPointFlags = BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED;
    btPlaneSpace1(point->m_normalWorldOnB, point->m_lateralFrictionDir1, point->m_lateralFrictionDir2);
    point->m_appliedImpulse = contact->normal_impulse;
    point->m_appliedImpulseLateral1 = load(contact->friction_impulse).dot(point->m_lateralFrictionDir1);
    point->m_appliedImpulseLateral2 = load(contact->friction_impulse).dot(point->m_lateralFrictionDir2);
    point->m_userPersistentData = contact;
}

// What every row must still bring: the wanted velocity less that of the bodies before any contact.
btScalar ShvSolver::solveGroupCacheFriendlySetup(btCollisionObject **all, int count, btPersistentManifold **pointers,
                                                 int manifold_count, btTypedConstraint **constraints,
                                                 int constraint_count, const btContactSolverInfo &info,
                                                 btIDebugDraw *drawer)
{
    btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySetup(all, count, pointers, manifold_count, constraints,
                                                                      constraint_count, info, drawer);
    const auto speed = [this](const btSolverConstraint &row) {
        const btSolverBody &first = m_tmpSolverBodyPool[row.m_solverBodyIdA];
        const btSolverBody &second = m_tmpSolverBodyPool[row.m_solverBodyIdB];
        return row.m_contactNormal1.dot(first.m_linearVelocity) +
               row.m_relpos1CrossNormal.dot(first.m_angularVelocity) +
               row.m_contactNormal2.dot(second.m_linearVelocity) +
               row.m_relpos2CrossNormal.dot(second.m_angularVelocity);
    };
    restful = true;
    grips.resize(size_t(m_tmpSolverContactConstraintPool.size()));
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); i++) {
        btSolverConstraint &row = m_tmpSolverContactConstraintPool[i];
        const ShvBulletContact &contact = contact_of(row);
        grips[size_t(i)] = {contact.friction, mobility_of(row)};
        const btVector3 support = load(contact.support), normal = load(contact.normal);
        const btScalar wanted = contact.target + normal.dot(support);
        restful = restful && wanted <= 0;
        row.m_rhs = (wanted - speed(row)) * row.m_jacDiagABInv;
        row.m_rhsPenetration = contact.push * row.m_jacDiagABInv;
        row.m_upperLimit = BT_LARGE_FLOAT;
        const btManifoldPoint &point = *static_cast<btManifoldPoint *>(row.m_originalContactPoint);
        for (int k = 0; k < 2; k++) {
            btSolverConstraint &slide = m_tmpSolverContactFrictionConstraintPool[row.m_frictionIndex + k];
            const btVector3 &direction = k ? point.m_lateralFrictionDir2 : point.m_lateralFrictionDir1;
            slide.m_rhs = direction.dot(support) - speed(slide); // a velocity: see rub
            if (!settles) slide.m_rhs *= slide.m_jacDiagABInv;
        }
    }
    return 0;
}

// Larger eigenvalue of the 2 × 2 mobility of a contact's friction rows.
btScalar ShvSolver::mobility_of(const btSolverConstraint &row) const
{
    const btSolverConstraint *rows = &m_tmpSolverContactFrictionConstraintPool[row.m_frictionIndex];
    const btScalar coupling = rows[0].m_relpos1CrossNormal.dot(rows[1].m_angularComponentA) +
                              rows[0].m_relpos2CrossNormal.dot(rows[1].m_angularComponentB);
    const btScalar x = 1 / rows[0].m_jacDiagABInv, y = 1 / rows[1].m_jacDiagABInv, half = (x - y) / 2;
    return (x + y) / 2 + btSqrt(half * half + coupling * coupling);
}

// Coulomb's law of one contact in both directions at once: the impulse moves against the sliding velocity, by what the largest
// effective mobility bears, and back onto the disc. At rest of the iteration friction is opposite to the sliding. (Row by row,
// each brought to rest and cut, it would not be: the rows are coupled by the bodies' turning.) Returns the change of velocity.
btScalar ShvSolver::rub(const btSolverConstraint &row, const Grip &grip)
{
    btSolverConstraint *rows = &m_tmpSolverContactFrictionConstraintPool[row.m_frictionIndex];
    btSolverBody &first = m_tmpSolverBodyPool[row.m_solverBodyIdA], &second = m_tmpSolverBodyPool[row.m_solverBodyIdB];
    const btScalar limit = grip.friction * row.m_appliedImpulse, give = 1 / grip.mobility;
    if (!(limit > 0) && rows[0].m_appliedImpulse == 0 && rows[1].m_appliedImpulse == 0) return 0;
    btScalar wanted[2];
    for (int k = 0; k < 2; k++) {
        const btScalar slides = rows[k].m_contactNormal1.dot(first.internalGetDeltaLinearVelocity()) +
                                rows[k].m_relpos1CrossNormal.dot(first.internalGetDeltaAngularVelocity()) +
                                rows[k].m_contactNormal2.dot(second.internalGetDeltaLinearVelocity()) +
                                rows[k].m_relpos2CrossNormal.dot(second.internalGetDeltaAngularVelocity());
        wanted[k] = rows[k].m_appliedImpulse + (rows[k].m_rhs - slides) * give;
    }
    const btScalar size = btSqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]);
    btScalar change = 0;
    for (int k = 0; k < 2; k++) {
        const btScalar impulse = size > limit ? wanted[k] * (limit / size) : wanted[k];
        const btScalar more = impulse - rows[k].m_appliedImpulse;
        first.internalApplyImpulse(rows[k].m_contactNormal1 * first.internalGetInvMass(), rows[k].m_angularComponentA,
                                   more);
        second.internalApplyImpulse(rows[k].m_contactNormal2 * second.internalGetInvMass(), rows[k].m_angularComponentB,
                                    more);
        rows[k].m_appliedImpulse = impulse;
        change = btMax(change, btFabs(more) * grip.mobility);
    }
    return change;
}

// One pass over the contacts; the largest change of velocity.
btScalar ShvSolver::sweep()
{
    btScalar change = 0;
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); i++) {
        btSolverConstraint &row = m_tmpSolverContactConstraintPool[i];
        const btScalar earlier = row.m_appliedImpulse;
        resolveSingleConstraintRowLowerLimit(m_tmpSolverBodyPool[row.m_solverBodyIdA],
                                             m_tmpSolverBodyPool[row.m_solverBodyIdB], row);
        change = btMax(change, btFabs(row.m_appliedImpulse - earlier) / row.m_jacDiagABInv);
        if (grips[size_t(i)].friction > 0) change = btMax(change, rub(row, grips[size_t(i)]));
    }
    return change;
}

void ShvSolver::read(std::vector<btScalar> *impulses) const
{
    impulses->clear();
    const auto add = [impulses](const btSolverConstraint &row) {
        impulses->push_back(row.m_appliedImpulse / btSqrt(row.m_jacDiagABInv));
    };
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); i++) add(m_tmpSolverContactConstraintPool[i]);
    for (int i = 0; i < m_tmpSolverContactFrictionConstraintPool.size(); i++)
        add(m_tmpSolverContactFrictionConstraintPool[i]);
}

void ShvSolver::apply(const std::vector<btScalar> &impulses)
{
    size_t next = 0;
    const auto set = [&](btSolverConstraint &row) {
        const btScalar impulse = impulses[next++] * btSqrt(row.m_jacDiagABInv), more = impulse - row.m_appliedImpulse;
        btSolverBody &first = m_tmpSolverBodyPool[row.m_solverBodyIdA];
        btSolverBody &second = m_tmpSolverBodyPool[row.m_solverBodyIdB];
        first.internalApplyImpulse(row.m_contactNormal1 * first.internalGetInvMass(), row.m_angularComponentA, more);
        second.internalApplyImpulse(row.m_contactNormal2 * second.internalGetInvMass(), row.m_angularComponentB, more);
        row.m_appliedImpulse = impulse;
    };
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); i++) set(m_tmpSolverContactConstraintPool[i]);
    for (int i = 0; i < m_tmpSolverContactFrictionConstraintPool.size(); i++)
        set(m_tmpSolverContactFrictionConstraintPool[i]);
}

// Whether impulses are of the size of the momentum that is there. (Pressed between two sides a body bears any impulse, and
// friction any with it: no mix should lead there.)
bool ShvSolver::moderate(const std::vector<btScalar> &impulses) const
{
    btScalar momentum = 0;
    for (int i = 0; i < m_tmpSolverBodyPool.size(); i++) {
        const btSolverBody &body = m_tmpSolverBodyPool[i];
        const btScalar inverse = body.m_invMass.x();
        if (inverse > 0) momentum += body.m_linearVelocity.length() / inverse;
    }
    size_t next = 0;
    const auto holds = [&](const btSolverConstraint &row) {
        return btFabs(impulses[next++]) * btSqrt(row.m_jacDiagABInv) <= most_of_momentum * momentum;
    };
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); i++)
        if (!holds(m_tmpSolverContactConstraintPool[i])) return false;
    for (int i = 0; i < m_tmpSolverContactFrictionConstraintPool.size(); i++)
        if (!holds(m_tmpSolverContactFrictionConstraintPool[i])) return false;
    return true;
}

// What is left at the end comes from a plain sweep: its impulses keep to their bounds.
btScalar ShvSolver::solveSingleIteration(int iteration, btCollisionObject **objects, int count,
                                         btPersistentManifold **pointers, int manifold_count,
                                         btTypedConstraint **constraints, int constraint_count,
                                         const btContactSolverInfo &info, btIDebugDraw *drawer)
{
    if (!settles)
        return btSequentialImpulseConstraintSolver::solveSingleIteration(
            iteration, objects, count, pointers, manifold_count, constraints, constraint_count, info, drawer);
    const bool last = iteration + 1 == info.m_numIterations;
    const bool helped =
        restful && iteration >= plain_sweeps && (last || (iteration - plain_sweeps) % sweeps_a_mix == 0);
    if (iteration == plain_sweeps) mixing.begin();
    if (helped) read(&before);
    const btScalar change = sweep(), residual = change * change;
    if (!helped || residual <= info.m_leastSquaresResidualThreshold) return residual;
    read(&after);
    if (last) {
        apply(mixing.best(before, after));
        return residual;
    }
    mixing.mix(before, after);
    if (moderate(after))
        apply(after);
    else
        mixing.begin();
    return residual;
}

btScalar ShvSolver::solveGroupCacheFriendlyFinish(btCollisionObject **all, int count, const btContactSolverInfo &info)
{
    for (int i = 0; i < count; i++) {
        btSolverBody &body = m_tmpSolverBodyPool[all[i]->getCompanionId()];
        auto *motion = static_cast<ShvBulletMotion *>(all[i]->getUserPointer());
        if (!motion) continue; // nothing touches it: an island of boxes
        store(motion->velocity, body.m_linearVelocity + body.m_deltaLinearVelocity);
        store(motion->spin, body.m_angularVelocity + body.m_deltaAngularVelocity);
        store(motion->push, body.m_pushVelocity);
        store(motion->turn, body.m_turnVelocity);
    }
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); i++) {
        const btSolverConstraint &row = m_tmpSolverContactConstraintPool[i];
        const btManifoldPoint &point = *static_cast<btManifoldPoint *>(row.m_originalContactPoint);
        ShvBulletContact &contact = contact_of(row);
        const btSolverConstraint *rows = &m_tmpSolverContactFrictionConstraintPool[row.m_frictionIndex];
        contact.normal_impulse = row.m_appliedImpulse;
        store(contact.friction_impulse, point.m_lateralFrictionDir1 * rows[0].m_appliedImpulse +
                                            point.m_lateralFrictionDir2 * rows[1].m_appliedImpulse);
    }
    // Poses are the caller's: Bullet would turn them with the C library's sine.
    btContactSolverInfo plain = info;
    plain.m_splitImpulse = false;
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(all, count, plain);
}

btContactSolverInfo ShvSolver::settings()
{
    btContactSolverInfo info;
    info.m_minimumSolverBatchSize = 1; // each island for itself
    info.m_splitImpulse = true;
    info.m_warmstartingFactor = 1;
    info.m_restitutionVelocityThreshold = 0;
    info.m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_USE_2_FRICTION_DIRECTIONS |
                        SOLVER_ENABLE_FRICTION_DIRECTION_CACHING | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
    return info;
}

// Small islands are solved to the tolerance, of large ones each step goes on from the last one's impulses.
static int most_iterations(btPersistentManifold **manifolds, int count)
{
    enum { ROW_BUDGET = 10000, FEWEST = 30, MOST = 1000 };
    int contacts = 0;
    for (int i = 0; i < count; i++) contacts += manifolds[i]->getNumContacts();
    return std::max(int(FEWEST), std::min(int(MOST), ROW_BUDGET / std::max(1, contacts)));
}

btScalar ShvSolver::solveGroup(btCollisionObject **all, int count, btPersistentManifold **pointers, int manifold_count,
                               btTypedConstraint **constraints, int constraint_count, const btContactSolverInfo &given,
                               btIDebugDraw *drawer, btDispatcher *dispatcher)
{
    if (manifold_count == 0) return 0;
    // In an order that does not depend on the past.
    const auto first = [](const btPersistentManifold *manifold) {
        return static_cast<const ShvBulletContact *>(manifold->getContactPoint(0).m_userPersistentData);
    };
    std::sort(pointers, pointers + manifold_count,
              [&](const btPersistentManifold *a, const btPersistentManifold *b) { return first(a) < first(b); });
    std::sort(all, all + count, [](const btCollisionObject *a, const btCollisionObject *b) {
        return a->getUserIndex() < b->getUserIndex();
    });
    btScalar fastest = 0;
    for (int i = 0; i < count; i++)
        fastest = btMax(fastest, static_cast<const btRigidBody *>(all[i])->getLinearVelocity().length());
    const btScalar tolerance = btMax(settled_of_rest * rest, settled_of_speed * fastest);
    btContactSolverInfo info = given;
    info.m_timeStep = 1; // targets are velocities: the step does not enter
    if (settles) info.m_numIterations = most_iterations(pointers, manifold_count);
    info.m_leastSquaresResidualThreshold = tolerance * tolerance;
    return btSequentialImpulseConstraintSolver::solveGroup(all, count, pointers, manifold_count, constraints,
                                                           constraint_count, info, drawer, dispatcher);
}
