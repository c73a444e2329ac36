/* One step of position based dynamics (Müller et al. 2007; Table 6.2 of the chapter, lines 22 to 30): predicted
   positions, sweeps of bars and obstacle projections, then velocities.

   Velocities gain (projected − predicted)/dt, and not (projected − previous)/dt in their place, so that a small step
   loses no digits and nodes that nothing moved keep their velocity bit by bit.

   An obstacle moves a node that would end inside it to its surface, along the outward normal at the closest point; a free
   obstacle gives way by its share of the inverse masses. A node that went right through a thin obstacle, or would be
   pushed out of its far side, is held before the tangent plane where it entered. While projecting, Coulomb friction holds the
   node to the obstacle's material with at most µ × the normal impulse.

   Then the response. With v the relative velocity a node would have without projections, its normal part v·n becomes
   −e (v·n) where v·n < 0 (closing; e = 0 below `rest_speed`, or bodies would never rest), and otherwise stays between 0
   and v·n. What a projection gave to a node stopped in the middle of a step, or pushed out of an overlap, therefore does
   not count as velocity. The contact never pulls: the sum of normal impulses is at least 0. Friction uses up what is left
   of µ × that sum. e and µ are the obstacle's; nodes add nothing of their own. Of several obstacles at one node the last
   one in order has the last word. */
#ifndef SHV_PBD_RELAX_H
#define SHV_PBD_RELAX_H

#include "model/ledger.h"
#include "pbd/bars.h"
#include "pbd/ties.h"
#include "shape/obstacle.h"

/* Works of impulses on nodes, J, in halves: with the velocities before the kick, and with those after everything. Bars act on
   both their ends; at an imposed component, `constraint` is the work of what holds it against them. */
typedef struct ShvRelaxWork {
    double bars[2], contact[2], friction[2], constraint[2];
} ShvRelaxWork;

/* A node that met an obstacle in this step. */
typedef struct ShvRelaxTouch {
    int32_t node, obstacle;
    int32_t next;          /* of the same node, −1: none */
    bool fresh;            /* the node touched nothing in the step before */
    bool held;             /* before the plane through `point`, where it entered */
    double closing_speed;  /* m/s along the normal, by the predicted motion */
    ShvVec3 point, normal; /* on the obstacle at the end of the step; outward; world */
    double push;           /* Σ of projections along the normal × mass, kg m; 0: it did not come to a touch */
    ShvVec3 pushed, drag;  /* the same as a vector, and tangential projections × mass, kg m */
    double normal_impulse; /* N·s on the node, all together, ≥ 0 */
    ShvVec3 impulse;       /* the same as a vector */
    ShvVec3 friction;      /* N·s on the node */
} ShvRelaxTouch;

/* A node that a contact moved otherwise than by its velocity: to a surface in the middle of a step, or with a velocity of return.
   Forces work along that way, too, which the velocities do not tell. */
typedef struct ShvRelaxSlip {
    int32_t node;
    ShvVec3 displacement; /* m: displacement in the step − dt × velocity after it */
} ShvRelaxSlip;

typedef struct ShvRelaxSlips {
    ShvRelaxSlip *items;
    int32_t count, room;
    double work; /* J: half of − force × way, with the forces of this time */
} ShvRelaxSlips;

typedef struct ShvRelaxStep {
    double step;        /* dt, s */
    double gravity[3];  /* m/s² */
    double stiffness;   /* k, 0…1 */
    int32_t iterations; /* ≥ 1 */
    double rest_speed;  /* m/s: slower impacts do not bounce; 2 dt |g| */
    /* Velocities of whole moments (rigid mode) instead of half steps: they have had dt g/2 before and get dt g/2 after the
       relaxation, ahead of the response; works then balance the potential energy of gravity exactly. */
    bool synchronous;
    /* per node, bits 1, 2, 4: components x, y, z whose velocity is imposed, which neither bars nor obstacles change;
       NULL: none */
    const uint8_t *fixed;
    const ShvTies *ties; /* of bonded facets; NULL: none */
} ShvRelaxStep;

typedef struct ShvRelax {
    ShvMemory *memory;
    int32_t threads;
    int32_t node_room;
    double *anchors, *shifts; /* quads, as in bars.h */
    double *predicted;        /* 3 per node: displacement */
    double *before;           /* 3 per node: velocity before the kick */
    double *reactions;        /* 3 per node, kg m: held imposed components against their bars; only with `fixed` */
    double *clear;            /* per node: least gap to any obstacle at the predicted position; may be too small */
    int32_t *first_touch;     /* per node: its touches of this step; −1: none */
    uint8_t *touched;         /* per node: in the last step */
    int32_t known_nodes;
    ShvRelaxTouch *touches; /* of this step, those with a push of 0 did not happen */
    int32_t touch_count, touch_room;
    double *force;       /* 3 per node: of the present time, N, without gravity */
    ShvRelaxSlips slips; /* of this step */
    ShvRelaxSlips past;  /* of the step before */
    double slip_time;    /* s: when this step began */
    int32_t obstacle_count;
    ShvObstacle *later;  /* the obstacles at the end of the step, with its mean velocity */
    ShvVec3 *unmoved;    /* 2 per obstacle: velocity and angular velocity of `later` before any impulse */
    double *yielded;     /* per obstacle: bound of what impulses have shifted its surface by, m */
    ShvRelaxWork *works; /* per block of nodes */
    int32_t block_room;
    /* results of the step */
    ShvRelaxWork work;
    double obstacle_work;      /* J on free obstacles */
    double largest_projection; /* m */
    int32_t touching;          /* nodes with an impulse from an obstacle */
} ShvRelax;

ShvStatus shv_relax_create(ShvRelax *relax, const ShvModel *model, const ShvObstacles *obstacles, ShvError *error);
void shv_relax_release(ShvRelax *relax);

/* The pieces of a step, in this order, each for the same listed nodes (all nodes of the bars' elements, each once). */

/* Room for the state's nodes; remembers velocities as those before the kick, and forces: elastic ones, whose potential the energy
   has. Called again at the same time it starts the same step anew. */
ShvStatus shv_relax_begin(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count, ShvError *error);
/* Predicted displacements u + dt v. A caller may write `predicted` itself instead. */
void shv_relax_predict(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count, double step);
/* Fills `touches` with the nodes that would end inside an obstacle or pass through it (obstacles at time n). */
ShvStatus shv_relax_detect(ShvRelax *relax, const ShvState *state, const ShvObstacles *obstacles, const int32_t *nodes,
                           int32_t count, const ShvRelaxStep *step, ShvError *error);
/* Sweeps, projections, response: displacements and velocities of the nodes, and velocities of free obstacles, such that
   moving those over the whole step from time n leads them where they belong. Nodes that were looked at may be missing
   from the list; their touches then did not happen. On failure state and obstacles are unchanged. */
ShvStatus shv_relax_run(ShvRelax *relax, const ShvBars *bars, ShvState *state, ShvObstacles *obstacles,
                        const int32_t *nodes, int32_t count, const ShvRelaxStep *step, ShvError *error);

/* Of the bars at the displacements the last step ended with, as long as nobody else has moved the nodes. */
double shv_relax_largest_strain(const ShvRelax *relax, const ShvBars *bars);
/* Books the works of the last step into a ledger. */
void shv_relax_book(const ShvRelax *relax, ShvLedger *ledger);

#endif
