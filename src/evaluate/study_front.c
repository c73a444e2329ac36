#include "evaluate/study.h"

bool shv_study_counts(const ShvStudyRow *row, int32_t measure)
{
    return row->status == SHV_OK && !row->is_reference && isfinite(row->errors[measure]) && isfinite(row->seconds);
}

/* The cheapest row that counts and whose error is below `limit`, of equally cheap ones the best; −1: none. */
static int32_t cheapest_below(const ShvStudy *study, int32_t measure, double limit)
{
    int32_t best = -1;
    for (int32_t i = 0; i < study->setting_count; i++) {
        const ShvStudyRow *row = &study->rows[i], *other = best < 0 ? NULL : &study->rows[best];
        if (!shv_study_counts(row, measure) || !(row->errors[measure] < limit)) continue;
        if (!other || row->seconds < other->seconds ||
            (row->seconds == other->seconds && row->errors[measure] < other->errors[measure]))
            best = i;
    }
    return best;
}

/* From the cheapest row on, each that is better than the last one marked by more than the scatter: a difference below that is
   none, and of equals the cheaper counts. */
void shv_study_mark_front(ShvStudy *study, int32_t measure)
{
    const double scatter = isnan(study->view.scatter[measure]) ? 0.0 : study->view.scatter[measure];
    double limit = HUGE_VAL;
    for (int32_t i; (i = cheapest_below(study, measure, limit)) >= 0;) {
        study->rows[i].on_front[measure] = true;
        limit = study->rows[i].errors[measure] - scatter;
    }
}

int32_t shv_study_pick(const ShvStudy *study, int32_t measure, double largest)
{
    int32_t best = -1;
    for (int32_t i = 0; i < study->view.row_count; i++) {
        const ShvStudyRow *row = &study->rows[i];
        if (!shv_study_counts(row, measure) || row->errors[measure] > largest) continue;
        if (best < 0 || row->seconds < study->rows[best].seconds) best = i;
    }
    return best;
}
