/* Inside of a study, for the files of this folder. */
#ifndef SHV_EVALUATE_STUDY_H
#define SHV_EVALUATE_STUDY_H

#include "base/timer.h"
#include "evaluate/outcome.h"
#include "evaluate/study_plan.h"
#include "export/plot.h"
#include "export/table.h"
#include "shiver/scene.h"
#include "shiver/study.h"

/* Room for one figure, taken with the results, so that drawing cannot fail. */
typedef struct ShvStudyFigure {
    ShvPlotDraft draft;
    ShvPlotPoint *front;
    ShvPlotSpan *spans;
} ShvStudyFigure;

struct ShvStudy {
    ShvMemory *memory;
    ShvPool pool; /* of what lives as long as the study */
    ShvStudyOptions options;
    ShvStudyPlan plan;
    char *text, *study_text; /* of the scene; of the study */
    char *folder;            /* where the files lie that the scene names */
    size_t length;
    const char *scene_path;
    int32_t setting_count; /* those of the plan, and the reference's own */
    int32_t reference;     /* index of its setting; −1: closed form */
    char reference_name[256];
    uint64_t *keys; /* of each run: setting × members + member */
    /* after measuring */
    ShvStudyRow *rows;
    ShvStudyView view;
    ShvStudyFigure figure;
    char processor[128];
};

/* The scene of a setting; the caller destroys it. */
ShvStatus shv_study_scene(const ShvStudy *study, int32_t setting, ShvScene **scene, ShvError *error);
/* The definition of a member: seed or places changed. `objects` has room for the scene's objects. */
ShvSceneDefinition shv_study_member(const ShvStudy *study, const ShvSceneDefinition *scene, int32_t member,
                                    ShvObjectDefinition *objects);
/* What is kept of a run, of which key and needs must fit; else SHV_BAD_INPUT or SHV_FILE_ERROR. */
ShvStatus shv_study_load(const ShvStudy *study, int32_t run, ShvOutcome *outcome, ShvError *error);
/* File of a run, or a file of the report with run −1. */
enum { SHV_STUDY_PATH = 4096 };
ShvStatus shv_study_path(const ShvStudy *study, int32_t run, const char *file, char path[SHV_STUDY_PATH],
                         ShvError *error);
/* study_measure.c: whether a row has an error and a run time to be compared; marks rows for one measure. */
bool shv_study_counts(const ShvStudyRow *row, int32_t measure);
void shv_study_mark_front(ShvStudy *study, int32_t measure);

/* study_tables.c: the same rows in four tables. Results and run times in full, for CSV and JSON; the lines of table.md and of the
   terminal; and those of the page; the last two with the scatter below. */
typedef enum ShvStudyTable { SHV_STUDY_RESULTS, SHV_STUDY_TIMINGS, SHV_STUDY_LINES, SHV_STUDY_RUNS } ShvStudyTable;
void shv_study_put_table(const ShvStudy *study, ShvStudyTable kind, ShvTableForm form, FILE *stream);
void shv_study_put_definitions(const ShvStudy *study, FILE *stream);

#endif
