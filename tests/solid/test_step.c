#include "block.h"

/* A regular tet of unit altitude. */
static void create_regular(Block *block, double poissons_ratio, double youngs_modulus, double size)
{
    /* Corners of a cube of side a: edge √2 a, altitude 2a/√3. */
    const double a = 0.8660254037844386 * size;
    const double corners[12] = {0, 0, 0, a, a, 0, 0, a, a, a, 0, a};
    BlockShape shape = block_shape(1, 1, 1);
    shape.poissons_ratio = poissons_ratio;
    shape.youngs_modulus = youngs_modulus;
    block_create_tet(block, &shape, corners);
}

/* dt c_d / h of the regular tet with altitude h, to the digits of the tables. By symmetry Σ ∇N ∇Nᵀ = 4/(3h²) I, so that
   λmax(Bᵀ C B) = 4/(3h²) (3λ+2µ), that of dilatation, when λ ≥ 0, and (dt c_d / h)² = ¾ (λ+2µ)/(3λ+2µ). */
static void regular_tet_has_the_known_step(void **unused)
{
    (void)unused;
    static const double cases[4][2] = {{0.0, 0.866}, {0.2, 0.707}, {0.24, 0.678}, {0.499999, 0.500}};
    for (int i = 0; i < 4; i++) {
        Block block;
        create_regular(&block, cases[i][0], 70e9, 0.01);
        const double exact = shv_solid_exact_step(&block.solid, 0), safe = shv_solid_safe_step(&block.solid, 0);
        const double speed = block.model.materials[0].dilatational_speed;
        const double lambda = block.model.materials[0].lambda, mu = block.model.materials[0].mu;
        check_near(exact * speed / 0.01, cases[i][1], 5e-4);
        check_near(exact * speed / 0.01, sqrt(0.75 * (lambda + 2.0 * mu) / (3.0 * lambda + 2.0 * mu)), 1e-12);
        check_near(safe * speed / 0.01, 0.5, 1e-14);
        block_release(&block);
    }
}

enum { N = 12 };

/* Largest eigenvalue of a symmetric matrix by squaring it over and over: of the 2⁴⁰th power nothing else is left. */
static double largest_eigenvalue(double matrix[N][N])
{
    double power[N][N], next[N][N], x[N], size = 0.0, value = 0.0;
    memcpy(power, matrix, sizeof power);
    for (int k = 0; k < 40; k++) {
        double largest = 0.0;
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++) {
                next[i][j] = 0.0;
                for (int l = 0; l < N; l++) next[i][j] += power[i][l] * power[l][j];
                largest = fmax(largest, fabs(next[i][j]));
            }
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++) power[i][j] = next[i][j] / largest;
    }
    for (int i = 0; i < N; i++) {
        x[i] = 0.0;
        for (int j = 0; j < N; j++) x[i] += power[i][j] * shv_random_uniform(5, (uint64_t)j);
        size += x[i] * x[i];
    }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) value += x[i] * matrix[i][j] * x[j];
    return value / size;
}

/* 2/ω of the whole 12 × 12 tangent stiffness at some displacements, column by column from the internal force beside them; the four
   masses are equal, so that K/m is symmetric. */
static double tangent_step(Block *block, const double displacement[N], double tiny)
{
    double stiffness[N][N];
    for (int j = 0; j < N; j++)
        for (int side = -1; side <= 1; side += 2) {
            memcpy(block->state.displacement, displacement, N * sizeof(double));
            block->state.displacement[j] += side * tiny;
            block_force(block);
            for (int i = 0; i < N; i++) {
                const double slope = -side * block->state.force[i] / (2.0 * tiny) / block->state.mass[i / 3];
                stiffness[i][j] = side < 0 ? slope : stiffness[i][j] + slope;
            }
        }
    return 2.0 / sqrt(largest_eigenvalue(stiffness));
}

static double dense_step(Block *block, double edge)
{
    return tangent_step(block, (const double[N]){0.0}, 1e-9 * edge);
}

static void random_tet(double corners[12], uint64_t seed)
{
    static const double regular[12] = {0, 0, 0, 1, 1, 0, 0, 1, 1, 1, 0, 1};
    for (uint64_t i = 0; i < 12; i++) corners[i] = 0.01 * (regular[i] + 0.5 * (shv_random_uniform(seed, i) - 0.5));
}

/* Differencing costs the quadratic terms, 1e-9 × gradient × edge (below 10) of the force. */
static void exact_step_is_that_of_the_dense_matrix(void **unused)
{
    (void)unused;
    static const double ratios[5] = {-0.5, 0.0, 0.24, 0.4, 0.4999};
    for (uint64_t seed = 0; seed < 40; seed++) {
        BlockShape shape = block_shape(1, 1, 1);
        shape.poissons_ratio = ratios[seed % 5];
        shape.kinematics = seed % 2 ? SHV_COROTATIONAL : SHV_GREEN_STRAIN;
        double corners[12];
        random_tet(corners, seed);
        Block block;
        block_create_tet(&block, &shape, corners);
        const double exact = shv_solid_exact_step(&block.solid, 0), safe = shv_solid_safe_step(&block.solid, 0);
        const double dense = dense_step(&block, shape.edge);
        check_near(exact / dense, 1.0, 1e-8);
        assert_true(safe <= exact);
        block_release(&block);
    }
}

/* Displacements of a tet's nodes with a random gradient, whose nine numbers reach `size`. */
static void deform(const Block *block, double size, uint64_t seed, double displacement[N])
{
    for (int node = 0; node < 4; node++)
        for (int i = 0; i < 3; i++) {
            displacement[3 * node + i] = 0.0;
            for (int j = 0; j < 3; j++)
                displacement[3 * node + i] += size *
                                              (2.0 * shv_random_uniform(seed, (uint64_t)(100 + 3 * i + j)) - 1.0) *
                                              block->model.mesh.positions[3 * node + j];
        }
}

/* Of what ω² is more than at rest, the first twentieth is left to safety. */
static void strained_step_is_stable_for_the_tangent(void **unused)
{
    (void)unused;
    static const double ratios[4] = {0.0, 0.2, 0.4, 0.49};
    int counted = 0;
    for (uint64_t seed = 0; seed < 80; seed++) {
        BlockShape shape = block_shape(1, 1, 1);
        shape.poissons_ratio = ratios[seed % 4];
        double corners[12], displacement[N];
        random_tet(corners, seed);
        Block block;
        block_create_tet(&block, &shape, corners);
        deform(&block, 0.003 * (double)(1 + seed), seed, displacement);
        memcpy(block.state.displacement, displacement, sizeof displacement);
        block_force(&block);
        const double exact = shv_solid_exact_step(&block.solid, 0), found = shv_solid_strained_step(&block.solid);
        const double tangent = tangent_step(&block, displacement, 1e-6 * shape.edge);
        const double bound = 1.0 / sqrt(1.0 / (found * found) + 0.05 / (exact * exact));
        assert_true(fmin(bound, exact / sqrt(1.05)) <= tangent * (1.0 + 1e-6));
        assert_true(found >= 0.6 * fmin(tangent, exact));
        counted += isfinite(found);
        block_release(&block);
    }
    assert_true(counted >= 40);
}

/* Of elements in whose rotated frame all is linear, no strain counts, and need not. */
static void corotational_step_is_that_at_rest(void **unused)
{
    (void)unused;
    for (uint64_t seed = 0; seed < 80; seed++) {
        BlockShape shape = block_shape(1, 1, 1);
        shape.kinematics = SHV_COROTATIONAL;
        double corners[12], displacement[N];
        random_tet(corners, seed);
        Block block;
        block_create_tet(&block, &shape, corners);
        deform(&block, 0.003 * (double)(1 + seed), seed, displacement);
        memcpy(block.state.displacement, displacement, sizeof displacement);
        block_force(&block);
        assert_true(shv_solid_strained_step(&block.solid) == HUGE_VAL);
        const double exact = shv_solid_exact_step(&block.solid, 0);
        assert_true(exact <= tangent_step(&block, displacement, 1e-6 * shape.edge) * (1.0 + 1e-6));
        block_release(&block);
    }
}

static void safe_step_is_below_the_exact_one(void **unused)
{
    (void)unused;
    static const double ratios[4] = {-0.9, 0.0, 0.3, 0.4999};
    for (int i = 0; i < 4; i++) {
        Block block;
        BlockShape shape = block_shape(6, 6, 6);
        shape.poissons_ratio = ratios[i];
        shape.jitter = 0.25;
        shape.materials = 2;
        block_create(&block, &shape);
        double smallest = (double)INFINITY;
        int32_t setter = -1, element = -1;
        for (int32_t e = 0; e < block.state.element_count; e++) {
            const double exact = shv_solid_exact_step(&block.solid, e);
            assert_true(isfinite(exact) && exact > 0.0);
            assert_true(shv_solid_safe_step(&block.solid, e) <= exact);
            if (exact < smallest) {
                smallest = exact;
                setter = e;
            }
        }
        for (int32_t threads = 1; threads <= 3; threads++) {
            block.model.threads = threads;
            assert_true(shv_solid_stable_step(&block.solid, &element) == smallest);
            assert_int_equal(element, setter);
        }
        block_release(&block);
    }
}

static void step_scales_with_stiffness_and_size(void **unused)
{
    (void)unused;
    Block glass, stiff, large;
    create_regular(&glass, 0.24, 70e9, 0.01);
    create_regular(&stiff, 0.24, 400e9, 0.01);
    create_regular(&large, 0.24, 70e9, 1.0);
    const double step = shv_solid_stable_step(&glass.solid, NULL);
    check_near(shv_solid_stable_step(&stiff.solid, NULL) / step, sqrt(70.0 / 400.0), 1e-14);
    check_near(shv_solid_stable_step(&large.solid, NULL) / step, 100.0, 1e-12);
    block_release(&glass);
    block_release(&stiff);
    block_release(&large);
}

/* An altitude a million times smaller than the edges: the step falls with it and stays finite. */
static void sliver_sets_the_step(void **unused)
{
    (void)unused;
    const double edge = 0.01, altitude = 1e-8;
    const double corners[12] = {0, 0, 0, edge, 0, 0, 0, edge, 0, 0.3 * edge, 0.3 * edge, altitude};
    const BlockShape shape = block_shape(1, 1, 1);
    Block block;
    block_create_tet(&block, &shape, corners);
    const double courant =
        shv_solid_exact_step(&block.solid, 0) * block.model.materials[0].dilatational_speed / altitude;
    /* Four altitudes: the apex above its base, and three nearly in the plane, of the order of the edge times
       altitude / distance from the foot. */
    assert_true(courant > 0.1 && courant < 1.0);
    block_release(&block);
}

/* A mesh given without shape: named, not computed with. */
static void flat_element_is_refused(void **unused)
{
    (void)unused;
    Block block;
    BlockShape shape = block_shape(2, 1, 1);
    block_create(&block, &shape);
    const int32_t *nodes = block.model.mesh.elements + 4 * 7;
    for (int c = 0; c < 3; c++)
        block.model.mesh.positions[3 * (int64_t)nodes[1] + c] = block.model.mesh.positions[3 * (int64_t)nodes[0] + c];
    ShvSolid solid;
    check_fails(shv_solid_create(&solid, &block.model, &block.state, &block.error), SHV_BAD_INPUT, block.error,
                "element ");
    assert_null(solid.gradients);
    block_release(&block);
}

static void failed_allocations_release_everything(void **unused)
{
    (void)unused;
    Block block;
    const BlockShape shape = block_shape(3, 3, 3);
    block_create(&block, &shape);
    const size_t bytes = shv_memory_bytes(block.memory, SHV_PART_COUNT);
    ShvStatus status = SHV_NO_MEMORY;
    int64_t failures = 0;
    for (; status != SHV_OK; failures++) {
        ShvSolid solid;
        shv_memory_fail_after(block.memory, failures);
        status = shv_solid_create(&solid, &block.model, &block.state, &block.error);
        shv_memory_fail_after(block.memory, -1);
        if (status == SHV_OK) {
            shv_solid_release(&solid);
        } else {
            assert_int_equal(status, SHV_NO_MEMORY);
            assert_non_null(strstr(block.error.message, "out of memory"));
        }
        assert_int_equal(shv_memory_bytes(block.memory, SHV_PART_COUNT), bytes);
    }
    assert_int_equal(failures, 13);
    block_release(&block);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regular_tet_has_the_known_step),
        cmocka_unit_test(exact_step_is_that_of_the_dense_matrix),
        cmocka_unit_test(strained_step_is_stable_for_the_tangent),
        cmocka_unit_test(corotational_step_is_that_at_rest),
        cmocka_unit_test(safe_step_is_below_the_exact_one),
        cmocka_unit_test(step_scales_with_stiffness_and_size),
        cmocka_unit_test(sliver_sets_the_step),
        cmocka_unit_test(flat_element_is_refused),
        cmocka_unit_test(failed_allocations_release_everything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
