/* Members of a group are pulled along one direction and joined in pairs: which group is pulled hardest against what joins it to
   the others? A minimal cut, for the tets round one node (star.h), of which there are some dozens. */
#ifndef SHV_COHESIVE_CUT_H
#define SHV_COHESIVE_CUT_H

#include <stdint.h>

typedef struct ShvJoint {
    int32_t member[2];
    double capacity[2]; /* [i]: where member[i] is in the group and the other is not; may be infinite */
    double first_flow;  /* from member[0] to member[1], to begin with: any number will do */
} ShvJoint;

enum { SHV_MEMBER_JOINTS = 3 };

typedef struct ShvMember {
    double pull;                      /* over all members they sum to zero */
    int32_t joint[SHV_MEMBER_JOINTS]; /* −1: none */
    double left;                      /* of the pull, what nothing holds so far; the search: */
    int32_t from;                     /* joint over which it came here, or why there is none */
    uint8_t in_group;                 /* of the group found */
} ShvMember;

typedef struct ShvCut {
    int32_t member_count, joint_count;
    ShvMember *members;
    ShvJoint *joints;
    double *flow;   /* joint_count: what each passes on from its first to its second member */
    int32_t *queue; /* member_count */
} ShvCut;

/* The largest ratio of pull to capacity over all groups, if it is above `least`, and its group; else 0 and none. */
double shv_cut_weakest(ShvCut *cut, double least);

#endif
