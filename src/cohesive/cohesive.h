/* Cohesive facets: those that have been inserted between two tets. Each carries three points, one at each corner
   (nodal quadrature, weight area/3), so that a point's opening is the distance of one pair of node copies; where the
   crack front still shares its node, the opening is zero. */
#ifndef SHV_COHESIVE_COHESIVE_H
#define SHV_COHESIVE_COHESIVE_H

#include "cohesive/law.h"
#include "model/ledger.h"
#include "model/state.h"

typedef struct ShvCohesive {
    ShvMemory *memory;
    const ShvModel *model;
    const ShvFractureDefinition *settings;
    int32_t *facet_cohesive; /* interior_count: index of the cohesive facet, −1 while intact */
    int32_t count, capacity;
    /* per cohesive facet, in the order of insertion */
    int32_t *facet;       /* facet of the adjacency */
    uint8_t *partner;     /* 3 per facet: which corner of the second element's face meets corner i of the first's */
    double *area;         /* m², reference */
    ShvLaw *law;
    double *start_traction; /* 3 per facet: activation traction in the facet's frame (normal, and two tangents of the
                               first element's face), Pa */
    ShvHistory *history;  /* 3 per facet */
    uint8_t *separated;   /* faces have left each other: closure no longer looks at them */
    double worst_overshoot; /* largest criterion / strength met at an insertion */
} ShvCohesive;

ShvStatus shv_cohesive_create(ShvCohesive *cohesive, const ShvModel *model, const ShvFractureDefinition *settings,
                              ShvError *error);
void shv_cohesive_release(ShvCohesive *cohesive);

/* Strength scale of a facet, 1 without scatter: Weibull from model->seed and the facet's number, independent of order. */
double shv_cohesive_strength_scale(const ShvModel *model, int32_t facet);
/* Weakest facet strength of a set of elements' interior facets (elements NULL: all), Pa; infinity when none can break. */
double shv_cohesive_weakest(const ShvCohesive *cohesive, const int32_t *elements, int32_t count);

/* Criterion value / facet strength of every intact interior facet whose two elements are in awake fragments
   (awake: one byte per fragment index, NULL: all); returns the largest. Fills `candidates` (room for interior_count) with
   facets at or above settings->threshold, ordered by descending overstress, ties by facet number. `stress` from
   shv_solid_stress; `nodal` (6 per node) only for the principal criterion. */
double shv_cohesive_candidates(const ShvCohesive *cohesive, const ShvState *state, const double *stress, const double *nodal,
                               const uint8_t *awake, int32_t *candidates, double *overstress, int32_t *count);

/* Inserts facets: makes them cohesive and duplicates nodes by the rule that a node is split among the groups of its
   elements that are still joined across intact facets. Order of facets does not matter. Copies inherit position and
   velocity; masses are re-summed from elements. On failure nothing changed. `duplicated` receives the number of new
   nodes; `touched` (may be NULL) one byte per fragment index: 1 when a node of it was duplicated. */
ShvStatus shv_cohesive_insert(ShvCohesive *cohesive, ShvState *state, const double *stress, const int32_t *facets,
                              int32_t count, int32_t *duplicated, ShvError *error);

/* Adds cohesive forces at the present openings to state->force and advances the histories; books the work with the
   half-step velocities around this time through shv_cohesive_book after the kick. awake: per fragment, NULL: all. */
void shv_cohesive_add_force(ShvCohesive *cohesive, ShvState *state, const uint8_t *awake);
/* Work of the cohesive forces of this step over a half step with the present velocities (call before and after the
   kick): Σ f·v × half_step, J. */
double shv_cohesive_power(const ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake);

/* Keeps closing crack faces from passing through each other: for pairs of node copies whose predicted normal opening
   after `step` is negative, an inelastic impulse along the facet normal (and Coulomb friction) that never pushes faces
   apart, so that no energy can come of it. Velocities are those after the kick. Returns the work on the nodes given
   `before` velocities are not known to the pair: impulse × mean of the pair's velocities before and after; ≤ 0. */
double shv_cohesive_close(ShvCohesive *cohesive, ShvState *state, double step, double friction, const uint8_t *awake);

/* 1/dt² contribution of cohesive stiffness: max over nodes of ω²/4, 1/s²; 0 without active facets. The step resolves
   1/dt² = 1/dt_bulk² + this. */
double shv_cohesive_inverse_square_step(const ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake);

typedef struct ShvCohesiveEnergy {
    double recoverable, dissipated; /* J */
    double inserted_area, opened_area; /* m² */
    double opened_energy;           /* ΣG·A over opened facets, J */
    int32_t inserted, opened;
} ShvCohesiveEnergy;
ShvCohesiveEnergy shv_cohesive_energy(const ShvCohesive *cohesive, const ShvState *state);
double shv_cohesive_facet_damage(const ShvCohesive *cohesive, int32_t cohesive_facet);

#endif
