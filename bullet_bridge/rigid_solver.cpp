#include "bullet_bridge/rigid_solver.hpp"

#include <new>

// Islands that sweeps alone have not settled by then are helped, when there is a solution: impulses of contacts that
// contradict each other (a ram that presses a body into the floor) have no limit, to which no mix should lead.
static const int plain_sweeps = 40, sweeps_a_mix = 4; // a mix costs as much as two sweeps
static const btScalar most_of_momentum = 10;

static btVector3 load(const double *p)
{
    return btVector3(p[0], p[1], p[2]);
}

static void store(double *p, const btVector3 &v)
{
    for (int k = 0; k < 3; k++) p[k] = v[k];
}

ShvSolver::ShvSolver() : ground(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, nullptr)) {}

ShvBulletContact &ShvSolver::contact_of(const btSolverConstraint &row)
{
    return *static_cast<ShvBulletContact *>(
        static_cast<btManifoldPoint *>(row.m_originalContactPoint)->m_userPersistentData);
}

// Manifolds of up to four contacts of one pair. The world positions are arms, and the bodies' origins are zero: far from the
// world's origin nothing is lost.
void ShvSolver::fill(const std::vector<ShvBulletBody *> &firsts, const std::vector<ShvBulletBody *> &seconds,
                     ShvBulletContact *contacts, int count)
{
    manifolds.clear();
    manifolds.reserve(size_t(count));
    for (int i = 0; i < count; i++) {
        ShvBulletContact &contact = contacts[i];
        btRigidBody *first = firsts[size_t(i)] ? firsts[size_t(i)]->body.get() : &ground;
        btRigidBody *second = seconds[size_t(i)] ? seconds[size_t(i)]->body.get() : &ground;
        const bool fits = i > 0 && contacts[i - 1].first == contact.first && contacts[i - 1].second == contact.second &&
                          manifolds.back().getNumContacts() < MANIFOLD_CACHE_SIZE;
        if (!fits) manifolds.emplace_back(first, second, 0, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
        btManifoldPoint point(btVector3(0, 0, 0), btVector3(0, 0, 0), load(contact.normal), 0);
        point.m_positionWorldOnA = load(contact.arm_first);
        point.m_positionWorldOnB = load(contact.arm_second);
        point.m_combinedFriction = contact.friction;
        point.m_contactPointFlags = BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED;
        btPlaneSpace1(point.m_normalWorldOnB, point.m_lateralFrictionDir1, point.m_lateralFrictionDir2);
        point.m_appliedImpulse = contact.normal_impulse;
        point.m_appliedImpulseLateral1 = load(contact.friction_impulse).dot(point.m_lateralFrictionDir1);
        point.m_appliedImpulseLateral2 = load(contact.friction_impulse).dot(point.m_lateralFrictionDir2);
        point.m_userPersistentData = &contact;
        btPersistentManifold &manifold = manifolds.back();
        manifold.setNumContacts(manifold.getNumContacts() + 1);
        manifold.getContactPoint(manifold.getNumContacts() - 1) = point;
    }
    manifold_pointers.clear();
    for (btPersistentManifold &manifold : manifolds) manifold_pointers.push_back(&manifold);
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
btScalar ShvSolver::solveSingleIteration(int iteration, btCollisionObject **, int, btPersistentManifold **, int,
                                         btTypedConstraint **, int, const btContactSolverInfo &info, btIDebugDraw *)
{
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
        store(motion[i].velocity, body.m_linearVelocity + body.m_deltaLinearVelocity);
        store(motion[i].spin, body.m_angularVelocity + body.m_deltaAngularVelocity);
        store(motion[i].push, body.m_pushVelocity);
        store(motion[i].turn, body.m_turnVelocity);
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

void ShvSolver::solve(const std::vector<ShvBulletBody *> &bodies, ShvBulletMotion *motions,
                      const std::vector<ShvBulletBody *> &firsts, const std::vector<ShvBulletBody *> &seconds,
                      ShvBulletContact *contacts, int contact_count, const ShvBulletSolve &settings)
{
    motion = motions;
    objects.clear();
    for (size_t i = 0; i < bodies.size(); i++) {
        btRigidBody *body = bodies[i]->body.get();
        bodies[i]->yield(motions[i].give);
        body->setWorldTransform(btTransform(bodies[i]->axes, btVector3(0, 0, 0)));
        body->updateInertiaTensor();
        body->setLinearVelocity(load(motions[i].velocity));
        body->setAngularVelocity(load(motions[i].spin));
        objects.push_back(body);
    }
    fill(firsts, seconds, contacts, contact_count);
    btContactSolverInfo info;
    info.m_timeStep = 1; // targets are velocities: the step does not enter
    info.m_numIterations = settings.iterations;
    info.m_leastSquaresResidualThreshold = settings.tolerance * settings.tolerance;
    info.m_splitImpulse = true;
    info.m_warmstartingFactor = 1;
    info.m_restitutionVelocityThreshold = 0;
    info.m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_USE_2_FRICTION_DIRECTIONS |
                        SOLVER_ENABLE_FRICTION_DIRECTION_CACHING | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
    solveGroup(objects.data(), int(objects.size()), manifold_pointers.data(), int(manifold_pointers.size()), nullptr, 0,
               info, nullptr, nullptr);
    for (btPersistentManifold &manifold : manifolds)
        for (int i = 0; i < manifold.getNumContacts(); i++) manifold.getContactPoint(i).m_userPersistentData = nullptr;
}
