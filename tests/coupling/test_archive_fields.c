/* A struct that goes to checkpoints has got or lost a field: numbers come along by themselves, a pointer has to be named in the
   struct's table (SHV_FIELD_BLOCK where its bytes are state, SHV_FIELD_KEPT where it was made from the scene), or it would point
   nowhere after a run goes on. Then the new size belongs here. */
#include "check.h"

#include "coupling/hybrid.h"
#include "pbd/pbd_body.h"
#include "rigid/bullet_step.h"
#include "rigid/flight_body.h"

typedef struct Size {
    const char *name, *table;
    size_t now, known;
} Size;

#define SIZE(type, table, known)                                                                                       \
    {                                                                                                                  \
#type, table, sizeof(type), known                                                                              \
    }
static const Size sizes[] = {
    SIZE(ShvState, "model/state_archive.c", 144),
    SIZE(ShvCohesive, "cohesive/cohesive_archive.c", 896),
    SIZE(ShvCohesivePoint, "cohesive/cohesive_archive.c", 256),
    SIZE(ShvSurfaceContact, "contact/contact_archive.c", 1328),
    SIZE(ShvImposed, "conditions/condition_archive.c", 80),
    SIZE(ShvImposedCondition, "conditions/condition_archive.c", 88),
    SIZE(ShvObstacle, "shape/obstacle_archive.c", 520),
    SIZE(ShvFragments, "rigid/rigid_archive.c", 104),
    SIZE(ShvFragment, "rigid/rigid_archive.c", 704),
    SIZE(ShvFlightBody, "rigid/rigid_archive.c", 368),
    SIZE(ShvBullet, "rigid/bullet_archive.c", 352),
    SIZE(ShvBulletRigidBody, "rigid/bullet_archive.c", 880),
    SIZE(ShvBars, "pbd/pbd_archive.c", 208),
    SIZE(ShvRelax, "pbd/pbd_archive.c", 304),
    SIZE(ShvTies, "pbd/pbd_archive.c", 24),
    SIZE(ShvPbdBody, "pbd/pbd_archive.c", 272),
    SIZE(ShvProbes, "coupling/hybrid_archive.c", 80),
    SIZE(ShvCoupledBodies, "coupling/hybrid_archive.c", 96),
    SIZE(ShvSolid, "coupling/hybrid_archive.c", 408),
    SIZE(ShvHybrid, "coupling/hybrid_archive.c", 5352),
};

static void test_no_field_is_new(void **state)
{
    (void)state;
#ifdef __x86_64__
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        if (sizes[i].now != sizes[i].known)
            fail_msg("%s has %zu bytes and had %zu: see its pointers in src/%s", sizes[i].name, sizes[i].now,
                     sizes[i].known, sizes[i].table);
#else
    skip();
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_field_is_new)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
