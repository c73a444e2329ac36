/* Anderson's acceleration of an iteration x ← G(x) (Anderson 1965; Walker and Ni 2011, type II): of the last results that mix is
   taken whose residual G(x) − x is the smallest. Sequential impulses alone lose a share of some 1/ratio of their error in a
   sweep where a heavy body stands on a light one; the few directions in which they do so are what the mix removes. */
#ifndef BULLET_BRIDGE_RIGID_MIXING_HPP
#define BULLET_BRIDGE_RIGID_MIXING_HPP

#include <cstddef>
#include <vector>

#include <LinearMath/btScalar.h>

class ShvMixing
{
  public:
    void begin();
    // What to go on from after an iteration from `before` to `after`: left in `after`. All of one size since `begin`.
    void mix(const std::vector<btScalar> &before, std::vector<btScalar> &after);
    // The result with the smallest residual since `begin`, that of the iteration from `before` to `after` included.
    const std::vector<btScalar> &best(const std::vector<btScalar> &before, const std::vector<btScalar> &after);

  private:
    typedef std::vector<btScalar> Column;
    enum { most = 10 };
    btScalar measure(const Column &before, const Column &after);
    void forget();
    void remember(const Column &after);
    void choose();

    size_t known = 0, oldest = 0; // columns, the next to be replaced
    bool started = false;         // last_… are set
    Column residual, last_residual, last_after, best_after;
    Column changes[most], results[most]; // of the residual and of the result, from one iteration to the next
    Column base[most];                   // orthonormal: of the changes
    btScalar upper[most][most], weight[most];
    btScalar least = -1, near = 0; // smallest squared residual since `begin`, and since what is known was
};

#endif
