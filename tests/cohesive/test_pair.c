#include "check.h"

#include "base/random.h"
#include "cohesive/spring.h"

static ShvLaw law_of(ShvCohesiveLaw kind, double alpha)
{
    const ShvMaterial material = {.name = "glass",
                                  .breakable = true,
                                  .law = kind,
                                  .fracture_energy = {8.0, 8.0},
                                  .strength = {40e6, 40e6},
                                  .shape = {alpha, alpha}};
    return shv_law_make(&material, 1.0);
}

/* Two nodes of 1 kg each behind 1 m²: reduced mass ½ kg. */
typedef struct Pair {
    const ShvLaw *law;
    ShvHistory history;
    ShvVec3 opening, rate, from; /* of n, n − 1/2, n − 1/2 */
    double work;                 /* by the traction on the nodes, J */
} Pair;

static const double reduced_mass = 0.5;

static double kinetic(const Pair *pair)
{
    return 0.5 * reduced_mass * shv_dot(pair->rate, pair->rate);
}

static ShvOpening split(ShvVec3 opening, ShvVec3 normal)
{
    const double n = shv_dot(opening, normal);
    return (ShvOpening){n, shv_norm(shv_madd(opening, -n, normal))};
}

static double kept(const Pair *pair, ShvVec3 normal)
{
    const ShvOpening at = split(pair->from, normal);
    return shv_law_recoverable(pair->law, pair->history, at.normal, at.shear) + pair->history.dissipated;
}

/* One step with a relative acceleration; `last`: the step before, 0 at a start, where the rate is that of time 0. */
static ShvVec3 advance_from(Pair *pair, ShvVec3 normal, double last, double step, ShvVec3 acceleration)
{
    const double kick = 0.5 * (last + step);
    const ShvVec3 before = pair->rate, free_rate = shv_madd(before, kick, acceleration);
    const ShvLawSprings springs = shv_law_springs(pair->law, pair->history);
    const ShvPair made =
        shv_pair_make(pair->law, &springs, normal, pair->from, pair->opening, 0.5 * step * kick / reduced_mass);
    const ShvVec3 traction = shv_pair_traction(&made, shv_madd(pair->opening, 0.5 * step, free_rate));
    pair->rate = shv_madd(free_rate, -kick / reduced_mass, traction);
    pair->work -= 0.5 * shv_dot(traction, shv_add(shv_scale(before, last), shv_scale(pair->rate, step)));
    const ShvVec3 to = shv_madd(pair->opening, 0.5 * step, pair->rate);
    pair->history = shv_law_advance(pair->law, pair->history, split(pair->from, normal), split(to, normal));
    pair->from = to;
    pair->opening = shv_madd(pair->opening, step, pair->rate);
    return traction;
}

static ShvVec3 advance(Pair *pair, ShvVec3 normal, double step, ShvVec3 acceleration)
{
    return advance_from(pair, normal, step, step, acceleration);
}

static const ShvVec3 none = {0.0, 0.0, 0.0};

/* Pulled apart so fast that a step opens 0.1 … 10 final openings: the energy taken is G, to round-off. */
static void opening_takes_the_fracture_energy(void **state)
{
    (void)state;
    const ShvVec3 normal = {0.6, 0.0, 0.8}, across = {0.8, 0.0, -0.6};
    const double shapes[] = {2.0, 3.0, 1.6}, shares[] = {0.1, 0.3, 1.0, 2.7, 10.0};
    for (int kind = 0; kind < 4; kind++)
        for (int i = 0; i < 5; i++)
            for (int shear = 0; shear < 2; shear++) {
                const ShvLaw law = law_of(kind < 3 ? SHV_PPR : SHV_CAMACHO_ORTIZ, kind < 3 ? shapes[kind] : 2.0);
                const double speed = 20.0, step = shares[i] * law.final_opening[0] / speed;
                Pair pair = {.law = &law, .rate = shv_scale(shear ? across : normal, speed)};
                pair.opening = shv_scale(pair.rate, 0.5 * step); /* closed at n − 1/2 */
                const double start = kinetic(&pair);
                for (int k = 0; k < 200; k++) advance(&pair, normal, step, none);
                check_near(start - kinetic(&pair), 8.0, 8.0 * 1e-11);
                check_near(pair.history.dissipated, 8.0, 8.0 * 1e-11);
                check_near(pair.work, -8.0, 8.0 * 1e-11);
                assert_true(shv_law_damage(&law, pair.history) == 1.0);
            }
}

/* Thrown apart at random, too slowly or fast enough to open: the work on the nodes is what the law keeps, but for what
   the backward rule costs; never is there more energy than before. */
static void energy_never_grows(void **state)
{
    (void)state;
    const ShvVec3 normal = {0.0, 0.0, 1.0};
    int turned = 0;
    for (uint64_t run = 0; run < 200; run++) {
        const ShvLaw law = law_of(run % 2 ? SHV_CAMACHO_ORTIZ : SHV_PPR, 2.0 + (double)(run % 3));
        Pair pair = {.law = &law};
        pair.rate = shv_vec3(8.0 * (shv_random_uniform(run, 0) - 0.5), 4.0 * (shv_random_uniform(run, 1) - 0.5),
                             8.0 * shv_random_uniform(run, 2));
        const double step = law.final_opening[0] / 6.0 * (0.01 + 3.0 * shv_random_uniform(run, 3));
        advance_from(&pair, normal, 0.0, step, none);
        const double start = kinetic(&pair) + kept(&pair, normal);
        double last = pair.history.dissipated;
        for (uint64_t k = 0; k < 500; k++) {
            advance(&pair, normal, step, none);
            const double energy = kinetic(&pair) + kept(&pair, normal);
            if (energy > start + 1e-11 * (8.0 + start))
                fail_msg("run %d step %d: %g above %g", (int)run, (int)k, energy - start, start);
            assert_true(isfinite(pair.opening.x) && pair.history.dissipated >= last);
            last = pair.history.dissipated;
        }
        assert_true(last <= 8.0 * (1.0 + 1e-12));
        if (shv_law_damage(&law, pair.history) < 1.0) turned++;
    }
    assert_in_range(turned, 20, 180);
}

/* Below the peak a new pair does not open; the traction is what holds it, from the first step on. A disturbance dies
   out. */
static void a_new_pair_is_held(void **state)
{
    (void)state;
    const ShvLaw law = law_of(SHV_PPR, 2.0);
    const ShvVec3 normal = {0.0, 1.0, 0.0};
    Pair pair = {.law = &law, .history = shv_law_start(&law, 3e-3, 7e10)};
    const double start = pair.history.normal;
    assert_true(start > 0.0 && start <= 1e-8 * law.final_opening[0]);
    for (int k = 0; k < 1000; k++) {
        const double pull = 39.9e6 * (1.0 - 0.999 * k / 1000.0);
        if (k == 300) pair.rate = shv_vec3(1e-9, 2e-9, 0.0);
        const ShvVec3 traction =
            advance(&pair, normal, 3e-7, shv_vec3(0.5 * pull / reduced_mass, pull / reduced_mass, 0.0));
        /* the spring of the start gives way by `start` at full load, 1e-8 of what the load would move the pair in a step */
        if (k < 300 || k > 320) {
            check_near(traction.y, pull, 1e-6 * 40e6);
            check_near(traction.x, 0.5 * pull, 1e-6 * 40e6);
        }
        /* the disturbance alone moves it for a step or two */
        assert_true(pair.history.normal <= start + 1e-9 * 3e-7 * 4.0 &&
                    pair.history.shear <= start + 1e-9 * 3e-7 * 4.0);
    }
    for (int k = 0; k < 100; k++) advance(&pair, normal, 3e-7, shv_vec3(0.0, 41e6 / reduced_mass, 0.0));
    assert_true(shv_law_damage(&law, pair.history) == 1.0);
}

/* As the step falls, the motion tends to that of the plain law (opening from rest under a constant pull), with an error of
   second order. */
static void tends_to_the_plain_law(void **state)
{
    (void)state;
    const ShvLaw law = law_of(SHV_PPR, 2.0);
    const ShvVec3 normal = {1.0, 0.0, 0.0};
    /* m x'' = p − σ (1 − x/δ): x = (p − σ) δ/σ (cosh(ω t) − 1), ω² = σ/(m δ) */
    const double pull = 50e6, d = law.final_opening[0], omega = sqrt(40e6 / (reduced_mass * d));
    const double end = acosh(1.0 + 0.8 * 40e6 / 10e6) / omega; /* opened to 0.8 δ */
    double last = 0.0;
    for (int steps = 50; steps <= 400; steps *= 2) {
        const double step = end / steps;
        Pair pair = {.law = &law};
        for (int k = 0; k < steps; k++)
            advance_from(&pair, normal, k == 0 ? 0.0 : step, step, shv_vec3(pull / reduced_mass, 0.0, 0.0));
        const double error = fabs(pair.opening.x / d - 0.8);
        if (last > 0.0) check_near(last / error, 4.0, 0.4);
        last = error;
    }
}

/* A spring far stiffer than the step resolves: the trapezoidal rule, bounded for ever. */
static void stiff_unloading_is_stable(void **state)
{
    (void)state;
    const ShvLaw law = law_of(SHV_PPR, 2.0);
    const ShvVec3 normal = {0.0, 0.0, 1.0};
    Pair pair = {.law = &law};
    const double reached = 1e-6 * law.final_opening[0];
    pair.history = shv_law_grow(&law, (ShvHistory){0}, reached, reached);
    pair.opening = pair.from = shv_vec3(0.5 * reached, 0.0, 0.5 * reached);
    const double start = kept(&pair, normal);
    for (int k = 0; k < 100000; k++) {
        advance(&pair, normal, 1e-7, none);
        assert_true(kinetic(&pair) <= start * (1.0 + 1e-9));
    }
    assert_true(pair.history.normal == reached);
}

/* From exactly the largest opening back: the spring gives no more than it stores, whatever the step and however the last bit of
   the opening falls. */
static void turning_round_gives_back_what_was_stored(void **state)
{
    (void)state;
    int turned = 0;
    for (uint64_t run = 0; run < 20000; run++) {
        const ShvLaw law = law_of(run % 4 ? SHV_PPR : SHV_CAMACHO_ORTIZ, 2.0 + (double)(run % 2));
        const ShvVec3 normal = shv_unit(shv_vec3(shv_random_uniform(run, 0) - 0.5, shv_random_uniform(run, 1) - 0.5,
                                                 shv_random_uniform(run, 2) - 0.5));
        const double reached = law.final_opening[0] * pow(10.0, -8.0 * shv_random_uniform(run, 3));
        const ShvVec3 from = shv_scale(normal, reached);
        const ShvHistory history = shv_law_grow(&law, (ShvHistory){0}, split(from, normal).normal, 0.0);
        const double stiffness = shv_law_normal_branch(&law, history, 0.0).peak / history.normal;
        const double compliance = pow(10.0, 6.0 * shv_random_uniform(run, 4) - 3.0) / stiffness;
        const ShvVec3 now = shv_scale(from, 1.0 + 0.5 * (shv_random_uniform(run, 5) - 0.5));
        const ShvLawSprings springs = shv_law_springs(&law, history);
        const ShvPair pair = shv_pair_make(&law, &springs, normal, from, now, compliance);
        const ShvVec3 free = shv_scale(from, 1.0 + compliance * stiffness * shv_random_uniform(run, 6));
        const ShvVec3 traction = shv_pair_traction(&pair, free);
        const ShvVec3 path = shv_sub(shv_madd(free, -compliance, traction), from);
        const double stored = shv_law_recoverable(&law, history, reached, 0.0);
        assert_true(shv_dot(traction, path) >= -stored * (1.0 + 1e-9));
        turned += shv_dot(path, normal) < 0.0;
    }
    assert_true(turned > 10000);
}

static ShvVec3 random_vector(uint64_t run, uint64_t first, double size)
{
    return shv_vec3(size * (shv_random_uniform(run, first) - 0.5), size * (shv_random_uniform(run, first + 1) - 0.5),
                    size * (shv_random_uniform(run, first + 2) - 0.5));
}

/* The short way through a step says the same, bit by bit, wherever it says that both components stay on their springs. */
static void the_short_way_says_the_same(void **state)
{
    (void)state;
    int stayed = 0;
    for (uint64_t run = 0; run < 20000; run++) {
        const ShvLaw law = law_of(run % 4 ? SHV_PPR : SHV_CAMACHO_ORTIZ, 2.0 + (double)(run % 2));
        const double final_opening = law.final_opening[0], reached = final_opening * shv_random_uniform(run, 0);
        const ShvHistory history = shv_law_grow(&law, (ShvHistory){0}, reached, reached);
        const ShvVec3 normal = shv_unit(random_vector(run, 1, 1.0)), from = random_vector(run, 4, 2.0 * reached);
        const ShvVec3 now = shv_add(from, random_vector(run, 7, 0.3 * reached));
        const double compliance = pow(10.0, 4.0 * shv_random_uniform(run, 10) - 3.0) * final_opening / 40e6;
        const ShvLawSprings springs = shv_law_springs(&law, history);
        const ShvPair pair = shv_pair_make(&law, &springs, normal, from, now, compliance);
        const ShvVec3 free = shv_add(from, random_vector(run, 11, reached));
        ShvVec3 traction;
        if (!shv_pair_stays(&pair, free, &traction)) continue;
        const ShvVec3 whole = shv_pair_traction(&pair, free);
        assert_true(traction.x == whole.x && traction.y == whole.y && traction.z == whole.z);
        stayed++;
    }
    assert_in_range(stayed, 4000, 19000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(turning_round_gives_back_what_was_stored),
        cmocka_unit_test(opening_takes_the_fracture_energy),
        cmocka_unit_test(energy_never_grows),
        cmocka_unit_test(a_new_pair_is_held),
        cmocka_unit_test(tends_to_the_plain_law),
        cmocka_unit_test(stiff_unloading_is_stable),
        cmocka_unit_test(the_short_way_says_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
