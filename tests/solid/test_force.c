#include "block.h"

/* ---- force against energy ---- */

static void force_is_the_slope_of_energy(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++)
        for (int32_t materials = 1; materials <= 2; materials++) {
            BlockShape shape = block_shape(3, 4, 4);
            shape.kinematics = both_kinematics[i];
            shape.materials = materials;
            block_check_slope(&shape);
        }
}

/* The mixed batches of two materials give what each element alone gives. */
static void element_energies_add_up(void **unused)
{
    (void)unused;
    Block block;
    BlockShape shape = block_shape(3, 3, 3);
    shape.materials = 2;
    block_create(&block, &shape);
    block_shake(&block, 0.05 * shape.edge, 12);
    double sum = 0.0;
    for (int32_t e = 0; e < block.state.element_count; e++)
        sum += shv_solid_element_energy(&block.solid, &block.state, e);
    const double energy = shv_solid_strain_energy(&block.solid, &block.state);
    assert_true(energy > 0.0);
    check_near(sum / energy, 1.0, 200 * 1.2e-16);
    block_release(&block);
}

/* ---- rest and rigid motion ---- */

static void rest_gives_no_force_at_all(void **unused)
{
    (void)unused;
    static const double zero[3] = {0.0};
    for (int i = 0; i < 2; i++) {
        Block block;
        BlockShape shape = block_shape(3, 3, 3);
        shape.kinematics = both_kinematics[i];
        shape.materials = 2;
        shape.offset = 1e6;
        block_create(&block, &shape);
        for (int shifted = 0; shifted < 2; shifted++) {
            for (int64_t k = 0; k < 3 * (int64_t)block.state.node_count; k++)
                block.state.displacement[k] = shifted ? 0.3 * (double)(k % 3 + 1) : 0.0;
            block_force(&block);
            for (int32_t node = 0; node < block.state.node_count; node++)
                assert_memory_equal(block.state.force + 3 * (int64_t)node, zero, sizeof zero);
            assert_true(shv_solid_strain_energy(&block.solid, &block.state) == 0.0);
        }
        block_release(&block);
    }
}

/* Rounding of u (1e-16 of |x|) over the edge is strain: coordinates up to 3 edges, gradients up to 3 over the edge. */
static void quarter_turn_gives_no_stress(void **unused)
{
    (void)unused;
    static const double turn[3][3][3] = {{{-1, -1, 0}, {1, -1, 0}, {0, 0, 0}},
                                         {{0, 0, 0}, {0, -1, -1}, {0, 1, -1}},
                                         {{-2, 0, 0}, {0, -2, 0}, {0, 0, 0}}};
    static const double shift[3] = {0.4, -0.1, 0.2};
    for (int i = 0; i < 2; i++)
        for (int t = 0; t < 3; t++) {
            Block block;
            BlockShape shape = block_shape(3, 3, 3);
            shape.kinematics = both_kinematics[i];
            shape.materials = 2;
            block_create(&block, &shape);
            block_map(&block, turn[t], shift);
            double *stress = shv_allocate(block.memory, SHV_PART_STRESS,
                                          6 * SHV_LANES * (size_t)block.state.batch_count, sizeof *stress);
            assert_non_null(stress);
            shv_solid_stress(&block.solid, &block.state, stress);
            for (int32_t e = 0; e < block.state.element_count; e++)
                for (int c = 0; c < 6; c++)
                    check_near(stress[shv_stress_slot(e, c)] / shape.youngs_modulus, 0.0, 1e-12);
            block_force(&block);
            check_near(block_largest_force(&block) / (shape.youngs_modulus * shape.edge * shape.edge), 0.0, 1e-12);
            shv_release(stress);
            block_release(&block);
        }
}

/* Σ f = 0 and Σ x × f = 0, x the current position, to rounding: 64 nodes, forces near 0.1 E edge². */
static void forces_are_in_balance(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        Block block;
        BlockShape shape = block_shape(3, 3, 3);
        shape.kinematics = both_kinematics[i];
        block_create(&block, &shape);
        block_shake(&block, 0.1 * shape.edge, 13);
        block_force(&block);
        const double scale = 1.0 / block_largest_force(&block);
        ShvVec3 force = {0.0, 0.0, 0.0}, torque = {0.0, 0.0, 0.0};
        for (int32_t node = 0; node < block.state.node_count; node++) {
            const ShvVec3 f = shv_scale(shv_load3(block.state.force + 3 * (int64_t)node), scale);
            force = shv_add(force, f);
            torque = shv_add(torque, shv_cross(shv_state_position(&block.state, node), f));
        }
        check_near(shv_norm(force), 0.0, 64 * 24 * 1.2e-16);
        check_near(shv_norm(torque) / shape.edge, 0.0, 64 * 24 * 5 * 1.2e-16);
        block_release(&block);
    }
}

/* ---- patch test ---- */

/* Green strain of F = I + A by hand. */
static void expected_cauchy(const ShvMaterial *material, const double a[3][3], double voigt[6])
{
    static const int rows[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    ShvMat3 f, s, e;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) f.m[i][j] = a[i][j] + (i == j);
    if (material->kinematics == SHV_GREEN_STRAIN) {
        const ShvMat3 transposed = shv_transpose(&f);
        e = shv_multiply(&transposed, &f);
        for (int k = 0; k < 9; k++) e.m[k / 3][k % 3] = 0.5 * (e.m[k / 3][k % 3] - (k % 4 == 0));
    } else {
        const ShvMat3 rotation = shv_polar_rotation(&f), back = shv_transpose(&rotation);
        e = shv_multiply(&back, &f);
        for (int k = 0; k < 9; k += 4) e.m[k / 3][k % 3] -= 1.0;
    }
    const double pressure = material->lambda * (e.m[0][0] + e.m[1][1] + e.m[2][2]);
    for (int k = 0; k < 9; k++) s.m[k / 3][k % 3] = 2.0 * material->mu * e.m[k / 3][k % 3] + (k % 4 == 0) * pressure;
    if (material->kinematics == SHV_COROTATIONAL) {
        const ShvMat3 rotation = shv_polar_rotation(&f);
        s = shv_multiply(&rotation, &s);
    } else {
        s = shv_multiply(&f, &s);
    }
    const ShvMat3 transposed = shv_transpose(&f), kirchhoff = shv_multiply(&s, &transposed);
    for (int c = 0; c < 6; c++) voigt[c] = kirchhoff.m[rows[c][0]][rows[c][1]] / shv_determinant(&f);
}

static int is_inside(const BlockShape *shape, int32_t node)
{
    const int32_t nx = shape->cells[0] + 1, ny = shape->cells[1] + 1;
    const int32_t at[3] = {node % nx, node / nx % ny, node / nx / ny};
    int inside = 1;
    for (int c = 0; c < 3; c++) inside = inside && at[c] > 0 && at[c] < shape->cells[c];
    return inside;
}

/* A linear displacement field: every element has exactly its stress, and inner nodes are in balance. Jittered
   elements have gradients up to 10 over the edge, so rounding of u reaches 1e-16 × 4 × 10 in the strain, times 4 for
   the modulus. */
static void linear_field_gives_constant_stress(void **unused)
{
    (void)unused;
    static const double a[3][3] = {{0.05, -0.32, 0.11}, {0.24, -0.08, 0.17}, {-0.13, -0.09, 0.03}};
    static const double shift[3] = {0.01, 0.02, -0.03};
    for (int i = 0; i < 2; i++) {
        Block block;
        BlockShape shape = block_shape(4, 4, 4);
        shape.kinematics = both_kinematics[i];
        block_create(&block, &shape);
        block_map(&block, a, shift);
        double expected[6];
        expected_cauchy(&block.model.materials[0], a, expected);
        double *stress = shv_allocate(block.memory, SHV_PART_STRESS, 6 * SHV_LANES * (size_t)block.state.batch_count,
                                      sizeof *stress);
        assert_non_null(stress);
        shv_solid_stress(&block.solid, &block.state, stress);
        for (int32_t e = 0; e < block.state.element_count; e++)
            for (int c = 0; c < 6; c++)
                check_near(stress[shv_stress_slot(e, c)] / shape.youngs_modulus, expected[c] / shape.youngs_modulus,
                           2e-14);
        block_force(&block);
        int inner = 0;
        for (int32_t node = 0; node < block.state.node_count; node++) {
            if (!is_inside(&shape, node)) continue;
            inner++;
            const double *f = block.state.force + 3 * (int64_t)node;
            for (int c = 0; c < 3; c++) check_near(f[c] / (shape.youngs_modulus * shape.edge * shape.edge), 0.0, 2e-14);
        }
        assert_int_equal(inner, 27);
        shv_release(stress);
        block_release(&block);
    }
}

/* ---- nodal stress, inversion, activity ---- */

static void nodal_stress_is_the_volume_average(void **unused)
{
    (void)unused;
    Block block;
    BlockShape shape = block_shape(2, 2, 2);
    block_create(&block, &shape);
    block_shake(&block, 1e-3 * shape.edge, 14);
    const int32_t node = block_node(&shape, 1, 1, 1);
    const size_t lanes = SHV_LANES * (size_t)block.state.batch_count;
    double *stress = shv_allocate(block.memory, SHV_PART_STRESS, 6 * lanes, sizeof *stress);
    assert_non_null(stress);
    shv_solid_stress(&block.solid, &block.state, stress);
    double sum[6] = {0.0}, volume = 0.0, voigt[6];
    for (int32_t e = 0; e < block.state.element_count; e++)
        for (int32_t corner = 0; corner < 4; corner++) {
            if (shv_state_node(&block.state, e, corner) != node) continue;
            const double own = shv_mesh_element_volume(&block.model.mesh, e);
            volume += own;
            for (int c = 0; c < 6; c++) sum[c] += own * stress[shv_stress_slot(e, c)];
        }
    shv_solid_nodal_stress(&block.solid, &block.state, stress, node, voigt);
    assert_int_equal(block.state.corner_count[node], 24);
    for (int c = 0; c < 6; c++)
        check_near(voigt[c] / shape.youngs_modulus, sum[c] / volume / shape.youngs_modulus, 1e-15);
    shv_release(stress);
    block_release(&block);
}

static void inverted_elements_are_counted(void **unused)
{
    (void)unused;
    Block block;
    BlockShape shape = block_shape(3, 3, 3);
    shape.jitter = 0.0;
    block_create(&block, &shape);
    int32_t first = 0;
    assert_int_equal(shv_solid_inverted(&block.solid, &block.state, &first), 0);
    assert_int_equal(first, -1);
    /* An inner node moved two cells: count by brute force from current positions. */
    const int32_t node = block_node(&shape, 1, 1, 1);
    block.state.displacement[3 * (int64_t)node] = 2.1 * shape.edge;
    int32_t count = 0, lowest = -1;
    for (int32_t e = block.state.element_count - 1; e >= 0; e--) {
        ShvVec3 x[4];
        for (int32_t c = 0; c < 4; c++) x[c] = shv_state_position(&block.state, shv_state_node(&block.state, e, c));
        const ShvVec3 normal = shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0]));
        if (shv_dot(normal, shv_sub(x[3], x[0])) > 0.0) continue;
        count++;
        lowest = e;
    }
    assert_true(count > 3);
    assert_int_equal(shv_solid_inverted(&block.solid, &block.state, &first), count);
    assert_int_equal(first, lowest);
    block.state.displacement[3 * (int64_t)node] = (double)NAN;
    assert_int_equal(shv_solid_inverted(&block.solid, &block.state, &first), 24);
    block_release(&block);
}

static void sleeping_batches_are_left_out(void **unused)
{
    (void)unused;
    Block block;
    BlockShape shape = block_shape(3, 3, 3);
    block_create(&block, &shape);
    block_shake(&block, 1e-3 * shape.edge, 15);
    block.solid.batch_active[0] = 0;
    block_force(&block);
    const double energy = shv_solid_strain_energy(&block.solid, &block.state);
    double sum = 0.0;
    for (int32_t e = SHV_LANES; e < block.state.element_count; e++)
        sum += shv_solid_element_energy(&block.solid, &block.state, e);
    check_near(energy / sum, 1.0, 200 * 1.2e-16);
    /* Node 0 belongs to the six tets of the first cube alone, all of batch 0. */
    for (int c = 0; c < 3; c++) assert_true(block.state.force[c] == 0.0);
    assert_true(block_largest_force(&block) > 0.0);
    memset(block.solid.batch_active, 0, (size_t)block.solid.batch_count);
    int32_t element = 0;
    assert_true(isinf(shv_solid_stable_step(&block.solid, &element)));
    assert_int_equal(element, -1);
    assert_true(shv_solid_strain_energy(&block.solid, &block.state) == 0.0);
    block_release(&block);
}

/* ---- far from the origin, any number of threads ---- */

/* Rounding of the coordinates (1e6 × 1.1e-16 / edge = 1.1e-8) is all that differs; gradients take it up to ten
   times. */
static void far_from_the_origin(void **unused)
{
    (void)unused;
    Block near, far;
    BlockShape shape = block_shape(3, 3, 3);
    block_create(&near, &shape);
    shape.offset = 1e6;
    block_create(&far, &shape);
    block_shake(&near, 1e-3 * shape.edge, 16);
    block_shake(&far, 1e-3 * shape.edge, 16);
    block_force(&near);
    block_force(&far);
    const double scale = 1.0 / block_largest_force(&near);
    for (int64_t i = 0; i < 3 * (int64_t)near.state.node_count; i++)
        check_near(far.state.force[i] * scale, near.state.force[i] * scale, 1e-6);
    block_release(&near);
    block_release(&far);
}

/* Some steps with forces, energies and powers by 1 to 4 threads: equal bits. The block is long, so that there are
   more chunks than threads in every colour; shuffled, it has chunks that run alone. */
static void check_threads(int shuffled)
{
    static const double gravity[3] = {0.0, 0.0, -9.81};
    uint64_t hashes[4];
    double results[4][2];
    for (int32_t threads = 1; threads <= 4; threads++) {
        Block block;
        BlockShape shape = block_shape(40, 9, 9);
        shape.threads = threads;
        shape.materials = 2;
        shape.shuffled = shuffled;
        block_create(&block, &shape);
        block_shake(&block, 1e-3 * shape.edge, 17);
        const double step = 0.5 * shv_solid_stable_step(&block.solid, NULL);
        for (int i = 0; i < 3; i++) {
            block_force(&block);
            shv_motion_kick(&block.state, NULL, 0, step, gravity, threads);
            shv_motion_drift(&block.state, NULL, 0, step, threads);
        }
        hashes[threads - 1] = shv_state_hash(&block.state);
        results[threads - 1][0] = shv_solid_strain_energy(&block.solid, &block.state);
        results[threads - 1][1] = shv_motion_power(&block.state, block.state.force, NULL, 0, threads);
        block_release(&block);
    }
    for (int i = 1; i < 4; i++) {
        assert_true(hashes[i] == hashes[0]);
        assert_memory_equal(results[i], results[0], sizeof results[0]);
    }
}

static void threads_change_no_bit(void **unused)
{
    (void)unused;
    check_threads(0);
    check_threads(1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(force_is_the_slope_of_energy),
        cmocka_unit_test(element_energies_add_up),
        cmocka_unit_test(rest_gives_no_force_at_all),
        cmocka_unit_test(quarter_turn_gives_no_stress),
        cmocka_unit_test(forces_are_in_balance),
        cmocka_unit_test(linear_field_gives_constant_stress),
        cmocka_unit_test(nodal_stress_is_the_volume_average),
        cmocka_unit_test(inverted_elements_are_counted),
        cmocka_unit_test(sleeping_batches_are_left_out),
        cmocka_unit_test(far_from_the_origin),
        cmocka_unit_test(threads_change_no_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
