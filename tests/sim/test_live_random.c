/* A simulation that is driven at random for long: whatever is asked of it is done or refused in words, and the ledger knows all of it.
   usage: [FIRST LAST] seeds; without them a few. */
#include <stdlib.h>

#include "base/random.h"
#include "shiver/live.h"
#include "sim/stage.h"

enum { CALLS = 60 };

#ifdef SHIVER_SANITIZED
enum { SEEDS = 3 };
#else
enum { SEEDS = 12 };
#endif

static uint64_t first_seed = 0, last_seed = SEEDS;

typedef struct Driver {
    ShvSimulation *simulation;
    uint64_t seed, drawn;
    int32_t done, refused;
    double bound; /* of the residual, by the largest energy */
} Driver;

static double draw(Driver *driver, double least, double most)
{
    return least + (most - least) * shv_random_uniform(driver->seed, driver->drawn++);
}

static int32_t choose(Driver *driver, int32_t count)
{
    const int32_t chosen = (int32_t)draw(driver, 0.0, (double)count);
    return chosen < count ? chosen : count - 1;
}

static void draw_vector(Driver *driver, double size, double vector[3])
{
    for (int i = 0; i < 3; i++) vector[i] = draw(driver, -size, size);
}

/* A plate and a cube of chalk, another that waits; a free ball that waits, and a floor. */
static void make(Stage *stage, Driver *driver)
{
    static const double plate[3] = {0.12, 0.12, 0.02}, cube[3] = {0.03, 0.03, 0.03};
    static const ShvRigidEngine engines[] = {SHV_RIGID_BULLET, SHV_RIGID_BULLET, SHV_RIGID_ANALYTIC, SHV_RIGID_PBD,
                                             SHV_RIGID_BULLET_PLAIN};
    stage_make(stage);
    stage_box(stage, "plate", plate, 0.015, 0.02);
    stage_box(stage, "cube", cube, 0.015, 0.06)->placement.velocity[2] = draw(driver, -3.0, 0.0);
    stage_box(stage, "later", cube, 0.015, 0.2)->waits = true;
    stage_floor(stage)->friction = draw(driver, 0.0, 0.6);
    stage_free_ball(stage, "ball", 0.015, draw(driver, 0.01, 0.3))->waits = true;
    stage->scene.rigid.engine = engines[choose(driver, 5)];
    /* Plain Bullet parts what overlaps by velocities, and books no work for it. */
    driver->bound = stage->scene.rigid.engine == SHV_RIGID_BULLET_PLAIN ? 0.05 : 1e-3;
    stage->scene.bullet_plain.unit = 0.01; /* m; bodies of centimetres are smaller than its margin otherwise */
    stage->scene.seed = driver->seed;
}

static ShvStatus enter(Driver *driver, ShvError *error)
{
    ShvPlacement at = {0};
    draw_vector(driver, 0.08, at.position);
    at.position[2] = draw(driver, 0.0, 0.15);
    draw_vector(driver, 5.0, at.velocity);
    draw_vector(driver, 1.0, at.rotation_axis);
    at.rotation_degrees = draw(driver, 0.0, 180.0);
    return shv_simulation_enter(driver->simulation, choose(driver, 2) ? "ball" : "later", &at, error);
}

static ShvStatus leave(Driver *driver, ShvError *error)
{
    static const char *const names[] = {"plate", "cube", "later", "ball"};
    return shv_simulation_leave(driver->simulation, names[choose(driver, 4)], error);
}

static ShvStatus apply(Driver *driver, ShvError *error)
{
    static const char *const names[] = {"plate", "cube", "later", "ball", "floor"};
    ShvEventDefinition event = shv_event_default();
    event.kind = choose(driver, 2) ? SHV_EVENT_SET_VELOCITY : SHV_EVENT_IMPULSE;
    event.target = names[choose(driver, 5)];
    draw_vector(driver, event.kind == SHV_EVENT_IMPULSE ? 0.05 : 3.0, event.value);
    if (event.kind == SHV_EVENT_SET_VELOCITY) draw_vector(driver, 50.0, event.angular);
    if (choose(driver, 4) == 0) {
        event = shv_event_default();
        event.kind = SHV_EVENT_GRAVITY;
        draw_vector(driver, 20.0, event.value);
    }
    return shv_simulation_apply(driver->simulation, &event, error);
}

static ShvStatus push(Driver *driver, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(driver->simulation);
    const int32_t fragment = choose(driver, frame->fragment_count + 1);
    double impulse[3], point[3] = {0};
    draw_vector(driver, 3.0,
                impulse); /* m/s of a whole piece; near its centre, so that it is not spun out of all proportion */
    if (fragment < frame->fragment_count)
        for (int i = 0; i < 3; i++) {
            const ShvFragmentView *pushed = &frame->fragments[fragment];
            impulse[i] *= pushed->mass;
            point[i] = pushed->position[i] + draw(driver, -0.2, 0.2) * cbrt(pushed->volume);
        }
    return shv_simulation_push(driver->simulation, fragment, impulse, point, error);
}

static ShvStatus take_out(Driver *driver, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(driver->simulation);
    return shv_simulation_remove(driver->simulation, choose(driver, frame->fragment_count), error);
}

static ShvStatus step(Driver *driver, ShvError *error)
{
    const double time = shv_simulation_frame(driver->simulation)->time;
    return shv_simulation_step(driver->simulation, time + pow(10.0, draw(driver, -5.0, -2.3)), error);
}

static ShvStatus call(Driver *driver, ShvError *error)
{
    const int32_t chosen = choose(driver, 12);
    if (chosen < 6) return step(driver, error);
    if (chosen == 6) return leave(driver, error);
    if (chosen == 7) return take_out(driver, error);
    if (chosen == 8) return apply(driver, error);
    return chosen < 10 ? push(driver, error) : enter(driver, error);
}

static void check_frame(const Driver *driver)
{
    const ShvFrameView *frame = shv_simulation_frame(driver->simulation);
    const ShvLedgerView *ledger = &frame->ledger;
    if (!(fabs(ledger->residual) <= driver->bound * ledger->largest))
        print_error("seed %d, call %d: residual %g of %g\n", (int)driver->seed, driver->done + driver->refused,
                    ledger->residual, ledger->largest);
    assert_true(fabs(ledger->residual) <= driver->bound * ledger->largest);
    for (int32_t i = 0; i < frame->fragment_count; i++)
        for (int k = 0; k < 3; k++)
            assert_true(isfinite(frame->fragments[i].position[k]) && isfinite(frame->fragments[i].velocity[k]));
}

static void whatever_is_asked(void **state)
{
    (void)state;
    int32_t done = 0, refused = 0, pieces = 0;
    for (uint64_t seed = first_seed; seed < last_seed; seed++) {
        Stage stage;
        Driver driver = {.seed = seed};
        make(&stage, &driver);
        driver.simulation = stage_start(&stage);
        for (int k = 0; k < CALLS; k++) {
            ShvError error = {SHV_OK, ""};
            const ShvStatus status = call(&driver, &error);
            const bool in_words = (status == SHV_BAD_INPUT || status == SHV_UNSUPPORTED) && error.message[0] != '\0';
            if (status != SHV_OK && !in_words) print_error("seed %d, call %d: %s\n", (int)seed, k, error.message);
            assert_true(status == SHV_OK || in_words);
            *(status == SHV_OK ? &driver.done : &driver.refused) += 1;
            check_frame(&driver);
        }
        done += driver.done;
        refused += driver.refused;
        pieces += shv_simulation_frame(driver.simulation)->fragment_count;
        shv_simulation_destroy(driver.simulation);
    }
    assert_true(done > refused && refused > 0 && pieces > (int32_t)(last_seed - first_seed));
}

int main(int count, char **arguments)
{
    if (count == 3) {
        first_seed = strtoull(arguments[1], NULL, 10);
        last_seed = strtoull(arguments[2], NULL, 10);
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whatever_is_asked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
