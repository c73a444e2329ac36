#include "evaluate/study.h"

bool shv_study_counts(const ShvStudyRow *row, int32_t measure)
{
    return row->status == SHV_OK && !row->is_reference && isfinite(row->errors[measure]) && isfinite(row->seconds);
}

/* The cheapest row that counts, is dearer than `after` (index breaks ties), and whose error is below `limit`; −1: none. */
static int32_t next_row(const ShvStudy *study, int32_t measure, int32_t after, double limit)
{
    int32_t best = -1;
    const double least = after < 0 ? -HUGE_VAL : study->rows[after].seconds;
    for (int32_t i = 0; i < study->setting_count; i++) {
        const ShvStudyRow *row = &study->rows[i];
        if (!shv_study_counts(row, measure) || !(row->errors[measure] < limit) || row->seconds < least || i == after)
            continue;
        const bool first = best < 0 || row->seconds < study->rows[best].seconds;
        const bool better = best >= 0 && row->seconds == study->rows[best].seconds &&
                            row->errors[measure] < study->rows[best].errors[measure];
        if (first || better) best = i;
    }
    return best;
}

/* From the cheapest row on, each that is better than the last one marked by more than the scatter: a difference below that is
   none, and of equals the cheaper counts. */
void shv_study_mark_front(ShvStudy *study, int32_t measure)
{
    const double scatter = isnan(study->view.scatter[measure]) ? 0.0 : study->view.scatter[measure];
    double limit = HUGE_VAL;
    for (int32_t i = -1; (i = next_row(study, measure, i, limit)) >= 0;) {
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
