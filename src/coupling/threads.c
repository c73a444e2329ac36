#include "coupling/hybrid.h"

/* s of run time from one look at what other programs do to the next: threads that wait for one that another program keeps from
   its processor cost several times their work. */
static const double look_interval = 0.5;

static int32_t least(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

void shv_hybrid_choose_threads(ShvHybrid *hybrid)
{
    ShvModel *model = &hybrid->model;
    if (hybrid->scene->threads > 0) return;
    const bool due = shv_now() >= hybrid->processors.time + look_interval;
    if (due) shv_processors_look(&hybrid->processors);
    const int32_t useful = least(shv_threads_worth(hybrid->awake.element_count), model->most_threads);
    const int32_t wanted = least(useful, hybrid->processors.free);
    /* OpenMP ends threads that a loop does not need, and starts them again: not more often than is looked. */
    if (due || wanted > model->threads) model->threads = wanted;
}
