#include <string.h>

#include "evaluate/study.h"

/* ---- the finest setting ---- */

enum { FINENESSES = 6 };

/* What makes a run fine, in the order in which it counts; smaller is finer: edges of the objects, triangles that their surfaces are
   refined to, step of fracture mode (in stable steps, or s, or the share of the stable step), rigid step, no bars before bars,
   analytic before bullet before the others. */
static void measure_fineness(const ShvSceneDefinition *scene, const ShvStudySetting *setting, double fine[FINENESSES])
{
    const ShvRigidEngine engine = scene->rigid.engine;
    fine[0] = fine[1] = 0.0;
    for (int32_t i = 0; i < scene->object_count; i++) {
        fine[0] += scene->objects[i].mesh.edge + scene->objects[i].mesh.notch_edge;
        fine[1] -= (double)scene->objects[i].mesh.refine_to;
    }
    fine[2] = isnan(scene->fracture.time_step) ? scene->fracture.safety : scene->fracture.time_step;
    if (!isnan(setting->multiple)) fine[2] = setting->multiple;
    fine[3] = scene->rigid.time_step;
    fine[4] = scene->fracture.stabiliser;
    fine[5] = engine == SHV_RIGID_ANALYTIC ? 0.0 : engine == SHV_RIGID_BULLET ? 1.0 : 2.0;
}

ShvStatus shv_study_finest(const ShvStudy *study, int32_t *finest, ShvError *error)
{
    double best[FINENESSES], own[FINENESSES];
    *finest = -1;
    for (int32_t i = 0; i < study->plan.setting_count; i++) {
        ShvScene *scene;
        int k = 0;
        SHV_TRY(shv_study_scene(study, i, &scene, error));
        measure_fineness(shv_scene_definition(scene), shv_study_setting(study, i), own);
        shv_scene_destroy(scene);
        while (*finest >= 0 && k < FINENESSES && own[k] == best[k]) k++;
        if (*finest >= 0 && (k == FINENESSES || own[k] > best[k])) continue;
        memcpy(best, own, sizeof best);
        *finest = i;
    }
    return SHV_OK;
}

/* ---- the front ---- */

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
