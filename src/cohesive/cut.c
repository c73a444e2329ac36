#include "cohesive/cut.h"

#include <math.h>
#include <stdbool.h>

/* Of the sum of all pulls: less than that is round-off. */
static const double rounding = 1e-10;
enum { BEGAN_HERE = -1, NOT_REACHED = -2 };

/* What joint may still pass on from a member to the other one. */
static double room(const ShvCut *cut, int32_t joint, int32_t from, double scale)
{
    const ShvJoint *j = &cut->joints[joint];
    const bool first = j->member[0] == from;
    return scale * j->capacity[first ? 0 : 1] + (first ? -cut->flow[joint] : cut->flow[joint]);
}

static int32_t other(const ShvCut *cut, int32_t joint, int32_t member)
{
    const ShvJoint *j = &cut->joints[joint];
    return j->member[0] == member ? j->member[1] : j->member[0];
}

/* Breadth first from all members with pull left; the first reached that pulls the other way, or −1: then the reached ones are
   the group. */
static int32_t search(ShvCut *cut, double scale, double slight)
{
    int32_t length = 0;
    for (int32_t i = 0; i < cut->member_count; i++) {
        const bool begins = cut->members[i].left > slight;
        cut->members[i].from = begins ? BEGAN_HERE : NOT_REACHED;
        if (begins) cut->queue[length++] = i;
    }
    for (int32_t head = 0; head < length; head++) {
        const int32_t member = cut->queue[head];
        for (int k = 0; k < SHV_MEMBER_JOINTS; k++) {
            const int32_t joint = cut->members[member].joint[k];
            if (joint < 0 || !(room(cut, joint, member, scale) > slight)) continue;
            const int32_t next = other(cut, joint, member);
            if (cut->members[next].from != NOT_REACHED) continue;
            cut->members[next].from = joint;
            if (cut->members[next].left < -slight) return next;
            cut->queue[length++] = next;
        }
    }
    return -1;
}

/* Lets as much of what pulls at the way's start be held by its end as the way allows. */
static void pass_on(ShvCut *cut, int32_t end, double scale)
{
    double most = -cut->members[end].left;
    int32_t start = end;
    while (cut->members[start].from >= 0) {
        const int32_t joint = cut->members[start].from, before = other(cut, joint, start);
        most = fmin(most, room(cut, joint, before, scale));
        start = before;
    }
    most = fmin(most, cut->members[start].left);
    cut->members[start].left -= most;
    cut->members[end].left += most;
    for (int32_t i = end; cut->members[i].from >= 0;) {
        const int32_t joint = cut->members[i].from, before = other(cut, joint, i);
        cut->flow[joint] += cut->joints[joint].member[0] == before ? most : -most;
        i = before;
    }
}

/* Each joint passes on what pulls at it itself, as far as it may: little is then left to be led round. What can still be
   reached at the end of a largest flow is the same group whichever largest flow it is, and so wherever it began. */
static void begin_flow(ShvCut *cut, double scale)
{
    for (int32_t i = 0; i < cut->member_count; i++) cut->members[i].left = cut->members[i].pull;
    for (int32_t j = 0; j < cut->joint_count; j++) {
        const ShvJoint *joint = &cut->joints[j];
        const double flow = fmax(-scale * joint->capacity[1], fmin(scale * joint->capacity[0], joint->first_flow));
        cut->flow[j] = flow;
        cut->members[joint->member[0]].left -= flow;
        cut->members[joint->member[1]].left += flow;
    }
}

/* The group whose pull exceeds `scale` times its capacity by most. Returns whether there is one. */
static bool exceeding(ShvCut *cut, double scale, double slight)
{
    double left = 0.0;
    begin_flow(cut, scale);
    for (int32_t end = search(cut, scale, slight); end >= 0; end = search(cut, scale, slight)) pass_on(cut, end, scale);
    for (int32_t i = 0; i < cut->member_count; i++) left += fmax(cut->members[i].left, 0.0);
    return left > slight * (double)cut->member_count;
}

static double ratio_of_reached(const ShvCut *cut)
{
    double pull = 0.0, capacity = 0.0;
    for (int32_t i = 0; i < cut->member_count; i++)
        if (cut->members[i].from != NOT_REACHED) pull += cut->members[i].pull;
    for (int32_t j = 0; j < cut->joint_count; j++) {
        const ShvJoint *joint = &cut->joints[j];
        const bool first = cut->members[joint->member[0]].from != NOT_REACHED;
        const bool second = cut->members[joint->member[1]].from != NOT_REACHED;
        if (first != second) capacity += joint->capacity[first ? 0 : 1];
    }
    return pull / capacity;
}

static void keep_group(ShvCut *cut)
{
    for (int32_t i = 0; i < cut->member_count; i++) cut->members[i].in_group = cut->members[i].from != NOT_REACHED;
}

double shv_cut_weakest(ShvCut *cut, double least)
{
    enum { MOST_ROUNDS = 20 }; /* each raises the ratio; it is found in a handful */
    double sum = 0.0, ratio = 0.0;
    for (int32_t i = 0; i < cut->member_count; i++) {
        cut->members[i].in_group = 0;
        sum += fabs(cut->members[i].pull);
    }
    const double slight = rounding * sum;
    for (int round = 0; round < MOST_ROUNDS && exceeding(cut, fmax(ratio, least), slight); round++) {
        const double better = ratio_of_reached(cut);
        if (!(better > ratio)) break;
        ratio = better;
        keep_group(cut);
        if (isinf(ratio)) break;
    }
    return ratio;
}
