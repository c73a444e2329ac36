/* Figures of a run by name, each a formula over what is kept of it; and the errors that studies show, formulas that also name the
   run `reference`. docs/study.md and scenes/verification/README.md tell them. */
#ifndef SHV_EVALUATE_FIGURES_H
#define SHV_EVALUATE_FIGURES_H

#include <stdbool.h>
#include <stdint.h>

/* The formula of a figure, NULL for an unknown name. */
const char *shv_figure_formula(const char *name);

typedef struct ShvMeasure {
    const char *name, *unit, *error_unit; /* units "" for shares and counts; unit NULL: has no value of its own */
    const char *value, *error;            /* formulas */
    const char *sentence;                 /* what the error is */
} ShvMeasure;
/* In the order of docs/study.md. */
int32_t shv_measure_count(void);
const ShvMeasure *shv_measure_at(int32_t index);
/* NULL for an unknown name. */
const ShvMeasure *shv_measure_named(const char *name);
/* Whether its error follows bodies; whether it needs no reference. */
bool shv_measure_tracks(const ShvMeasure *measure);
bool shv_measure_is_own(const ShvMeasure *measure);

#endif
