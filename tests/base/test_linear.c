#include "check.h"

#include <float.h>

#include "base/random.h"
#include "base/vector.h"

enum { DRAWS = 20000 };

static double draw(uint64_t i)
{
    return 2.0 * shv_random_uniform(5, i) - 1.0;
}

static ShvMat3 random_matrix(uint64_t i)
{
    ShvMat3 a;
    for (uint64_t k = 0; k < 9; k++) a.m[k / 3][k % 3] = draw(9 * i + k);
    return a;
}

static ShvQuat random_rotation(uint64_t i)
{
    return shv_quat_unit((ShvQuat){draw(4 * i), draw(4 * i + 1), draw(4 * i + 2), draw(4 * i + 3)});
}

/* Q diag(values) Qᵀ, summed in long double so that only the rounding of the entries remains. */
static ShvMat3 with_eigenvalues(const double values[3], uint64_t i)
{
    const ShvQuat q = random_rotation(i);
    const long double w = (long double)q.w, x = (long double)q.x, y = (long double)q.y, z = (long double)q.z;
    const long double n = w * w + x * x + y * y + z * z;
    const long double r[3][3] = {
        {(w * w + x * x - y * y - z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n},
        {2 * (x * y + w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z - w * x) / n},
        {2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, (w * w - x * x - y * y + z * z) / n}};
    ShvMat3 a;
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++) {
            long double sum = 0.0L;
            for (int l = 0; l < 3; l++) sum += r[j][l] * (long double)values[l] * r[k][l];
            a.m[j][k] = (double)sum;
        }
    return a;
}

static double largest_of(const ShvMat3 *a)
{
    const double voigt[6] = {a->m[0][0], a->m[1][1], a->m[2][2], a->m[1][2], a->m[0][2], a->m[0][1]};
    return shv_largest_principal(voigt);
}

static double difference(const ShvMat3 *a, const ShvMat3 *b)
{
    double largest = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) largest = fmax(largest, fabs(a->m[i][j] - b->m[i][j]));
    return largest;
}

static void check_rotation(const ShvMat3 *r, double tolerance)
{
    const ShvMat3 t = shv_transpose(r), product = shv_multiply(r, &t), one = shv_identity();
    check_near(difference(&product, &one), 0.0, tolerance);
    check_near(shv_determinant(r), 1.0, 3.0 * tolerance);
}

static void inverse_times_matrix_is_one(void **state)
{
    (void)state;
    const ShvMat3 one = shv_identity();
    int inverted = 0;
    for (uint64_t i = 0; i < 1000; i++) {
        const ShvMat3 a = random_matrix(i);
        ShvMat3 inverse;
        const double det = fabs(shv_determinant(&a));
        if (!shv_invert(&a, &inverse)) continue;
        inverted++;
        const ShvMat3 product = shv_multiply(&a, &inverse);
        /* Entries up to 1: the cofactors (≤ 2) carry a few units of 1.1e-16 each, divided by the determinant. */
        check_near(difference(&product, &one), 0.0, 4e-15 / det);
    }
    assert_int_equal(inverted, 1000);
}

static void singular_matrices_have_no_inverse(void **state)
{
    (void)state;
    const ShvMat3 flat = {{{1, 2, 3}, {2, 4, 6}, {0, 1, 5}}}, bad = {{{(double)NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    ShvMat3 inverse = {{{7}}};
    assert_int_equal(shv_invert(&flat, &inverse), 0);
    assert_int_equal(shv_invert(&bad, &inverse), 0);
    check_near(inverse.m[0][0], 7.0, 0.0);
}

/* Spectra from well apart to equal, scaled over many decades. */
static void spectrum(uint64_t i, double values[3])
{
    const double gap = pow(10.0, -(double)(i % 18));
    const double scale = pow(10.0, (double)(i % 13) - 6.0);
    const double a = draw(3 * i + 1000000), b = draw(3 * i + 1000001);
    values[0] = a * scale;
    values[1] = i % 3 == 0 ? a * scale : (a + gap * b) * scale;
    values[2] = i % 2 == 0 ? draw(3 * i + 1000002) * scale : (a - gap) * scale;
}

static double norm_of(const double values[3])
{
    return sqrt(values[0] * values[0] + values[1] * values[1] + values[2] * values[2]);
}

static void eigenvectors_diagonalise(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < DRAWS; i++) {
        double values[3], found[3], sorted_sum = 0.0;
        spectrum(i, values);
        const ShvMat3 a = with_eigenvalues(values, i);
        ShvMat3 v;
        shv_symmetric_eigen(&a, found, &v);
        assert_true(found[0] <= found[1] && found[1] <= found[2]);
        /* Five sweeps of three rotations, whose cosine and sine (four roundings together) scale the columns. */
        check_rotation(&v, 60.0 * 0.5 * DBL_EPSILON);
        const double tolerance = 30.0 * DBL_EPSILON * norm_of(values);
        for (int k = 0; k < 3; k++) {
            const ShvVec3 e = shv_vec3(v.m[0][k], v.m[1][k], v.m[2][k]);
            check_near(shv_norm(shv_sub(shv_apply(&a, e), shv_scale(e, found[k]))), 0.0, tolerance);
            sorted_sum += found[k];
        }
        check_near(found[2], fmax(values[0], fmax(values[1], values[2])), tolerance);
        check_near(sorted_sum, values[0] + values[1] + values[2], tolerance);
    }
}

static void eigenvalues_of_diagonal_matrices_are_sorted_entries(void **state)
{
    (void)state;
    const ShvMat3 a = {{{3, 0, 0}, {0, -1, 0}, {0, 0, 2}}};
    double values[3];
    shv_symmetric_eigen(&a, values, NULL);
    check_near(values[0], -1.0, 0.0);
    check_near(values[1], 2.0, 0.0);
    check_near(values[2], 3.0, 0.0);
}

/* Ten roundings of the size of the tensor: the entries' own, the deviator's, the invariants' and the series'. */
static const double principal_tolerance = 10.0 * DBL_EPSILON;

static void largest_principal_of_known_spectra(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 10 * DRAWS; i++) {
        double values[3];
        spectrum(i, values);
        const ShvMat3 a = with_eigenvalues(values, i);
        const double expected = fmax(values[0], fmax(values[1], values[2]));
        check_near(largest_of(&a), expected, principal_tolerance * norm_of(values));
    }
}

static void largest_principal_of_whole_number_matrices(void **state)
{
    (void)state;
    static const struct {
        double voigt[6], largest;
    } cases[] = {
        {{2, 2, 2, 1, 1, 1}, 4},        /* 4, 1, 1 */
        {{-2, -2, -2, -1, -1, -1}, -1}, /* −1 twice: where the plain cubic formula loses half of the digits */
        {{0, 0, 0, -1, -1, -1}, 1},     /* 1, 1, −2 */
        {{0, 0, 0, 1, 1, 1}, 2},        {{5, 5, -10, 0, 0, 0}, 5},
        {{-10, 5, 5, 0, 0, 0}, 5},      {{7, 0, 0, 0, 0, 0}, 7}, /* uniaxial tension and compression */
        {{-7, 0, 0, 0, 0, 0}, 0},       {{0, 0, 0, 3, 0, 0}, 3}, /* pure shear */
        {{1, 2, 3, 0, 0, 0}, 3},        {{2, 3, 6, 2, 0, 0}, 7}, /* block 3 2 / 2 6 has 7 and 2 */
        {{4, 4, 4, 0, 0, 0}, 4},        {{0, 0, 0, 0, 0, 0}, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double norm = 0.0;
        for (int k = 0; k < 6; k++) norm = hypot(norm, cases[i].voigt[k] * (k < 3 ? 1.0 : sqrt(2.0)));
        check_near(shv_largest_principal(cases[i].voigt), cases[i].largest, principal_tolerance * norm);
    }
}

static void largest_principal_at_the_ends_of_the_range(void **state)
{
    (void)state;
    const double base[6] = {1.0, -2.0, 0.5, 0.3, -0.7, 0.2};
    const double reference = shv_largest_principal(base);
    static const int exponents[] = {-1000, -600, -400, 400, 600, 1000};
    for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
        double scaled[6];
        for (int k = 0; k < 6; k++) scaled[k] = ldexp(base[k], exponents[i]);
        check_near(ldexp(shv_largest_principal(scaled), -exponents[i]), reference, 10.0 * DBL_EPSILON);
    }
    for (int k = 0; k < 6; k++) {
        double bad[6] = {0.0};
        bad[k] = (double)NAN;
        assert_true(isnan(shv_largest_principal(bad)));
    }
    /* A tiny deviator on a large pressure. */
    const double pressed[6] = {-1e9, -1e9, -1e9, 1e-110, 0.0, 0.0};
    check_near(shv_largest_principal(pressed), -1e9, 1e-6);
}

static void pseudo_inverse_leaves_the_null_space(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 1000; i++) {
        const double values[3] = {0.0, 2.0 + draw(i), 5.0};
        const ShvMat3 a = with_eigenvalues(values, i), p = shv_symmetric_pseudo_inverse(&a, 1e-10);
        const ShvMat3 ap = shv_multiply(&a, &p), apa = shv_multiply(&ap, &a), pap = shv_multiply(&p, &ap);
        check_near(difference(&apa, &a), 0.0, 1e-13); /* condition 5 times some 40 roundings of 5 */
        check_near(difference(&pap, &p), 0.0, 1e-13);
        check_near(p.m[0][0] + p.m[1][1] + p.m[2][2], 1.0 / values[1] + 1.0 / values[2], 1e-13);
    }
    const ShvMat3 zero = {{{0.0}}}, p = shv_symmetric_pseudo_inverse(&zero, 1e-10);
    check_near(difference(&p, &zero), 0.0, 0.0);
}

/* F = R U with a known rotation and a positive stretch must give R back; the polar factor moves by the error of F
   over the sum of the two smallest stretches. */
static void polar_factor_of_a_stretched_rotation(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 5000; i++) {
        const ShvMat3 r = shv_quat_to_matrix(random_rotation(i + 77));
        const double small = pow(10.0, -(double)(i % 10));
        const double values[3] = {1.0, 0.5 + 0.4 * draw(i), small};
        const ShvMat3 u = with_eigenvalues(values, i), f = shv_multiply(&r, &u), found = shv_polar_rotation(&f);
        check_rotation(&found, 2e-15);
        check_near(difference(&found, &r), 0.0, 20.0 * DBL_EPSILON / (values[1] + small));
    }
}

/* The closest rotation has the largest trace(Rᵀ F): no turned neighbour beats it, inverted and flat F included. */
static void polar_rotation_is_the_closest(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 2000; i++) {
        ShvMat3 f = random_matrix(i);
        if (i % 4 == 0)
            for (int j = 0; j < 3; j++) f.m[j][2] = f.m[j][0] - f.m[j][1];
        const ShvMat3 r = shv_polar_rotation(&f), t = shv_transpose(&r), s = shv_multiply(&t, &f);
        check_rotation(&r, 4e-15);
        const double best = s.m[0][0] + s.m[1][1] + s.m[2][2];
        for (uint64_t k = 0; k < 20; k++) {
            const ShvVec3 turn =
                shv_scale(shv_vec3(draw(k), draw(k + 100), draw(k + 200)), pow(10.0, -(double)(k % 5)));
            const ShvMat3 q = shv_quat_to_matrix(shv_quat_exponential(turn)), other = shv_multiply(&q, &s);
            assert_true(other.m[0][0] + other.m[1][1] + other.m[2][2] <= best + 1e-14);
        }
    }
}

static void polar_rotation_of_extremes(void **state)
{
    (void)state;
    const ShvMat3 zero = {{{0.0}}}, one = shv_identity();
    ShvMat3 r = shv_polar_rotation(&zero);
    check_near(difference(&r, &one), 0.0, 0.0);
    const ShvMat3 mirror = {{{1, 0, 0}, {0, 1, 0}, {0, 0, -0.5}}};
    r = shv_polar_rotation(&mirror);
    check_near(difference(&r, &one), 0.0, 1e-15);
    const ShvMat3 huge = {{{0, -1e200, 0}, {1e200, 0, 0}, {0, 0, 1e200}}},
                  quarter = {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
    r = shv_polar_rotation(&huge);
    check_near(difference(&r, &quarter), 0.0, 1e-15);
}

static void quaternions_and_matrices_agree(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 5000; i++) {
        ShvQuat q = random_rotation(i);
        if (i % 5 == 0) q = shv_quat_unit((ShvQuat){1e-9 * q.w, q.x, 1e-5 * q.y, q.z}); /* half turns */
        const ShvMat3 m = shv_quat_to_matrix(q);
        check_rotation(&m, 2e-15);
        const ShvVec3 v = shv_vec3(draw(i), draw(i + 1), draw(i + 2));
        check_near(shv_norm(shv_sub(shv_apply(&m, v), shv_rotate(q, v))), 0.0, 4e-15);
        const ShvQuat back = shv_quat_from_matrix(&m);
        const double sign = q.w * back.w + q.x * back.x + q.y * back.y + q.z * back.z < 0.0 ? -1.0 : 1.0;
        check_near(sign * back.w, q.w, 2e-15);
        check_near(sign * back.x, q.x, 2e-15);
        check_near(sign * back.y, q.y, 2e-15);
        check_near(sign * back.z, q.z, 2e-15);
    }
}

static void axis_and_angle_turn_the_right_way(void **state)
{
    (void)state;
    const double pi = 3.14159265358979323846;
    const ShvQuat q = shv_quat_from_axis_angle(shv_vec3(0.0, 0.0, 5.0), 0.5 * pi);
    const ShvVec3 turned = shv_rotate(q, shv_vec3(1.0, 0.0, 0.0));
    check_near(shv_norm(shv_sub(turned, shv_vec3(0.0, 1.0, 0.0))), 0.0, 4e-16);
    const ShvQuat none = shv_quat_from_axis_angle(shv_vec3(0.0, 0.0, 0.0), 1.0);
    check_near(none.w, 1.0, 0.0);
}

static void exponential_agrees_with_axis_and_angle(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 2000; i++) {
        const double size = pow(10.0, -(double)(i % 20) + 1.0);
        const ShvVec3 w = shv_scale(shv_vec3(draw(3 * i), draw(3 * i + 1), draw(3 * i + 2)), size);
        const ShvQuat a = shv_quat_exponential(w), b = shv_quat_from_axis_angle(w, shv_norm(w));
        check_near(a.w, b.w, 1e-15);
        check_near(a.x, b.x, 1e-15 * fmin(size, 1.0));
        check_near(a.y, b.y, 1e-15 * fmin(size, 1.0));
        check_near(a.z, b.z, 1e-15 * fmin(size, 1.0));
    }
    const ShvQuat still = shv_quat_exponential(shv_vec3(0.0, 0.0, 0.0)),
                  tiny = shv_quat_exponential(shv_vec3(2e-200, 0.0, 0.0));
    check_near(still.w, 1.0, 0.0);
    check_near(still.x, 0.0, 0.0);
    check_near(tiny.x, 1e-200, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inverse_times_matrix_is_one),
        cmocka_unit_test(singular_matrices_have_no_inverse),
        cmocka_unit_test(eigenvectors_diagonalise),
        cmocka_unit_test(eigenvalues_of_diagonal_matrices_are_sorted_entries),
        cmocka_unit_test(largest_principal_of_known_spectra),
        cmocka_unit_test(largest_principal_of_whole_number_matrices),
        cmocka_unit_test(largest_principal_at_the_ends_of_the_range),
        cmocka_unit_test(pseudo_inverse_leaves_the_null_space),
        cmocka_unit_test(polar_factor_of_a_stretched_rotation),
        cmocka_unit_test(polar_rotation_is_the_closest),
        cmocka_unit_test(polar_rotation_of_extremes),
        cmocka_unit_test(quaternions_and_matrices_agree),
        cmocka_unit_test(axis_and_angle_turn_the_right_way),
        cmocka_unit_test(exponential_agrees_with_axis_and_angle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
