/* How many threads the loops of a step get. */
#include "coupling/stage.h"

#include <omp.h>

#include "coupling/hybrid.h"

enum { MANY = 1 << 20, FEW = 10 };

typedef struct Body {
    Stage stage;
    ShvMemory *memory;
    ShvHybrid hybrid;
} Body;

static void begin(Body *body, int32_t threads)
{
    ShvError error = {0};
    const double size[3] = {0.1, 0.1, 0.1};
    stage_make(&body->stage);
    stage_box(&body->stage, "block", size, 0.01, 1.0); /* 6,000 tets */
    body->stage.scene.threads = threads;
    body->memory = shv_memory_create();
    check_ok(shv_hybrid_create(&body->hybrid, body->memory, &body->stage.scene, NULL, &error), error);
}

static void end(Body *body)
{
    shv_hybrid_release(&body->hybrid);
    shv_memory_destroy(body->memory);
}

/* As if so many tets were awake, so many processors free, and the last look so many seconds ago. */
static int32_t choose(ShvHybrid *hybrid, int32_t tets, int32_t free, double age)
{
    hybrid->awake.element_count = tets;
    hybrid->processors = (ShvProcessors){.time = shv_now() - age, .free = free, .busy = (double)NAN};
    shv_hybrid_choose_threads(hybrid);
    return hybrid->model.threads;
}

static void a_number_that_is_given_stays(void **unused)
{
    (void)unused;
    Body body;
    begin(&body, 3);
    assert_int_equal(body.hybrid.model.most_threads, 3);
    assert_int_equal(choose(&body.hybrid, FEW, 1, 10.0), 3);
    assert_int_equal(choose(&body.hybrid, MANY, 1, 10.0), 3);
    end(&body);
}

static void threads_follow_what_is_awake(void **unused)
{
    (void)unused;
    Body body;
    begin(&body, 0);
    const int32_t most = body.hybrid.model.most_threads;
    assert_int_equal(most, shv_threads_worth(6000));
    assert_int_equal(most, omp_get_num_procs() < 3 ? omp_get_num_procs() : 3);
    assert_int_equal(choose(&body.hybrid, FEW, MANY, 10.0), 1);    /* what other programs do is not known */
    assert_int_equal(choose(&body.hybrid, MANY, MANY, 0.0), most); /* more at once */
    assert_int_equal(choose(&body.hybrid, FEW, MANY, 0.0), most);  /* fewer at the next look */
    assert_int_equal(choose(&body.hybrid, FEW, MANY, 10.0), 1);
    assert_int_equal(choose(&body.hybrid, MANY, 1, 0.0), 1); /* another program has the rest */
    end(&body);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_number_that_is_given_stays),
        cmocka_unit_test(threads_follow_what_is_awake),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
