#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "cohesive/cut.h"

enum { MEMBERS = 11, JOINTS = MEMBERS * SHV_MEMBER_JOINTS / 2 };

typedef struct Case {
    ShvCut cut;
    ShvMember members[MEMBERS];
    ShvJoint joints[JOINTS];
    double flow[JOINTS];
    int32_t queue[MEMBERS];
} Case;

static double draw(uint64_t seed, uint64_t *next)
{
    return shv_random_uniform(seed, (*next)++);
}

static int free_place(const ShvMember *member)
{
    for (int k = 0; k < SHV_MEMBER_JOINTS; k++)
        if (member->joint[k] < 0) return k;
    return -1;
}

/* Joints between random members that have room, one direction of some of them unbreakable; pulls sum to zero. */
static void make(Case *c, uint64_t seed, int32_t members)
{
    uint64_t next = 0;
    double sum = 0.0;
    *c = (Case){.cut = {.member_count = members}};
    c->cut.members = c->members;
    c->cut.joints = c->joints;
    c->cut.flow = c->flow;
    c->cut.queue = c->queue;
    for (int32_t i = 0; i < members; i++) {
        memset(c->members[i].joint, 0xff, sizeof c->members[i].joint);
        c->members[i].pull = i < members - 1 ? draw(seed, &next) - 0.5 : -sum;
        sum += c->members[i].pull;
    }
    for (int attempt = 0; attempt < 4 * members; attempt++) {
        const int32_t a = (int32_t)(draw(seed, &next) * members), b = (int32_t)(draw(seed, &next) * members);
        const int free_a = free_place(&c->members[a]), free_b = free_place(&c->members[b]);
        if (a == b || free_a < 0 || free_b < 0) continue;
        const double one = draw(seed, &next), two = draw(seed, &next), rare = draw(seed, &next);
        c->members[a].joint[free_a] = c->members[b].joint[free_b] = c->cut.joint_count;
        c->joints[c->cut.joint_count++] =
            (ShvJoint){{a, b}, {rare < 0.3 ? HUGE_VAL : one, rare > 0.9 ? 0.0 : two}, one - two};
    }
}

static double ratio_of(const Case *c, uint32_t group)
{
    double pull = 0.0, capacity = 0.0;
    for (int32_t i = 0; i < c->cut.member_count; i++)
        if (group >> i & 1u) pull += c->members[i].pull;
    for (int32_t j = 0; j < c->cut.joint_count; j++) {
        const uint32_t first = group >> c->joints[j].member[0] & 1u, second = group >> c->joints[j].member[1] & 1u;
        if (first != second) capacity += c->joints[j].capacity[first ? 0 : 1];
    }
    return pull > 1e-9 ? pull / capacity : 0.0;
}

static double brute_force(const Case *c)
{
    double best = 0.0;
    for (uint32_t group = 1; group < 1u << c->cut.member_count; group++) best = fmax(best, ratio_of(c, group));
    return best;
}

static uint32_t found_group(const Case *c)
{
    uint32_t group = 0;
    for (int32_t i = 0; i < c->cut.member_count && i < MEMBERS; i++) group |= (uint32_t)c->members[i].in_group << i;
    return group;
}

static void finds_the_weakest_of_all_groups(void **state)
{
    (void)state;
    int held = 0, finite = 0;
    for (uint64_t seed = 1; seed <= 400; seed++) {
        Case c;
        make(&c, seed, 3 + (int32_t)(seed % (MEMBERS - 2)));
        const double best = brute_force(&c), least = 0.4;
        const double ratio = shv_cut_weakest(&c.cut, least);
        if (best < least * (1.0 - 1e-6)) {
            assert_true(ratio == 0.0);
            assert_int_equal(found_group(&c), 0);
            held++;
        } else if (best > least * (1.0 + 1e-6)) {
            if (isinf(best))
                assert_true(isinf(ratio));
            else
                check_near(ratio, best, 1e-8 * best);
            assert_true(isinf(best) || fabs(ratio_of(&c, found_group(&c)) - best) <= 1e-8 * best);
            finite += !isinf(best);
        }
    }
    assert_true(held > 50);
    assert_true(finite > 50);
}

/* Four in a row, pulled at the ends: the weakest joint gives, and nothing gives where all hold. */
static void a_row_parts_at_its_weakest_joint(void **state)
{
    (void)state;
    Case c = {.cut = {.member_count = 4, .joint_count = 3}};
    c.cut.members = c.members;
    c.cut.joints = c.joints;
    c.cut.flow = c.flow;
    c.cut.queue = c.queue;
    const double capacity[3] = {3.0, 2.0, 2.5};
    for (int32_t j = 0; j < 3; j++) c.joints[j] = (ShvJoint){{j, j + 1}, {capacity[j], capacity[j]}, 0.0};
    for (int32_t i = 0; i < 4; i++)
        c.members[i] = (ShvMember){.pull = i == 0 ? 2.2 : i == 3 ? -2.2 : 0.0, .joint = {i - 1, i < 3 ? i : -1, -1}};
    check_near(shv_cut_weakest(&c.cut, 1.0), 1.1, 1e-12);
    assert_int_equal(found_group(&c), 3);
    assert_true(shv_cut_weakest(&c.cut, 1.11) == 0.0);
    assert_int_equal(found_group(&c), 0);
}

/* A direction that is closed holds whatever is asked of it: the group must go round. */
static void what_would_close_is_not_cut(void **state)
{
    (void)state;
    Case c = {.cut = {.member_count = 3, .joint_count = 2}};
    c.cut.members = c.members;
    c.cut.joints = c.joints;
    c.cut.flow = c.flow;
    c.cut.queue = c.queue;
    c.joints[0] = (ShvJoint){{0, 1}, {HUGE_VAL, 1.0}, 0.0};
    c.joints[1] = (ShvJoint){{1, 2}, {4.0, HUGE_VAL}, 0.0};
    c.members[0] = (ShvMember){.pull = 5.0, .joint = {0, -1, -1}};
    c.members[1] = (ShvMember){.pull = 0.0, .joint = {0, 1, -1}};
    c.members[2] = (ShvMember){.pull = -5.0, .joint = {1, -1, -1}};
    check_near(shv_cut_weakest(&c.cut, 1.0), 1.25, 1e-12);
    assert_int_equal(found_group(&c), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(finds_the_weakest_of_all_groups),
                                       cmocka_unit_test(a_row_parts_at_its_weakest_joint),
                                       cmocka_unit_test(what_would_close_is_not_cut)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
