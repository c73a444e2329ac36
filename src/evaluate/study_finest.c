#include "evaluate/study.h"

/* What makes a run fine, in the order in which it counts; smaller is finer. */
typedef struct Fineness {
    double edge;       /* m: Σ of the objects' edge lengths */
    double surface;    /* − Σ of triangles that surfaces are refined to */
    double step;       /* of fracture mode: in stable steps, or s, or the share of the stable step */
    double rigid;      /* s */
    double stabiliser; /* bars come after none */
    double engine;     /* analytic, then bullet, then the others */
} Fineness;

static Fineness fineness_of(const ShvSceneDefinition *scene, const ShvStudySetting *setting)
{
    Fineness fine = {.rigid = scene->rigid.time_step, .stabiliser = scene->fracture.stabiliser};
    for (int32_t i = 0; i < scene->object_count; i++) {
        fine.edge += scene->objects[i].mesh.edge + scene->objects[i].mesh.notch_edge;
        fine.surface -= (double)scene->objects[i].mesh.refine_to;
    }
    if (!isnan(setting->multiple))
        fine.step = setting->multiple;
    else
        fine.step = isnan(scene->fracture.time_step) ? scene->fracture.safety : scene->fracture.time_step;
    fine.engine = scene->rigid.engine == SHV_RIGID_ANALYTIC ? 0.0 : scene->rigid.engine == SHV_RIGID_BULLET ? 1.0 : 2.0;
    return fine;
}

static bool is_finer(const Fineness *a, const Fineness *b)
{
    const double x[] = {a->edge, a->surface, a->step, a->rigid, a->stabiliser, a->engine};
    const double y[] = {b->edge, b->surface, b->step, b->rigid, b->stabiliser, b->engine};
    for (size_t i = 0; i < sizeof x / sizeof x[0]; i++)
        if (x[i] != y[i]) return x[i] < y[i];
    return false;
}

ShvStatus shv_study_finest(const ShvStudy *study, int32_t *finest, ShvError *error)
{
    Fineness best = {0};
    *finest = -1;
    for (int32_t i = 0; i < study->plan.setting_count; i++) {
        ShvScene *scene;
        SHV_TRY(shv_study_scene(study, i, &scene, error));
        const Fineness own = fineness_of(shv_scene_definition(scene), shv_study_setting(study, i));
        shv_scene_destroy(scene);
        if (*finest >= 0 && !is_finer(&own, &best)) continue;
        best = own;
        *finest = i;
    }
    return SHV_OK;
}
