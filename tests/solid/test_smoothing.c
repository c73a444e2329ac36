/* Strain smoothed over edges: against the energy whose slope its forces are, against linear tets, and against beams. */
#include "block.h"

#include <stdlib.h>

static BlockShape smoothed_shape(int32_t x, int32_t y, int32_t z)
{
    BlockShape shape = block_shape(x, y, z);
    shape.smoothed = true;
    return shape;
}

/* Batches of two materials and both kinematics, and the last one padded. */
static void force_is_the_slope_of_energy(void **unused)
{
    (void)unused;
    for (int i = 0; i < 4; i++) {
        BlockShape shape = smoothed_shape(3, 3, 3);
        shape.kinematics = both_kinematics[i % 2];
        shape.materials = 1 + i / 2;
        block_check_slope(&shape);
    }
}

static void element_energies_add_up(void **unused)
{
    (void)unused;
    Block block;
    BlockShape shape = smoothed_shape(3, 3, 3);
    shape.materials = 2;
    block_create(&block, &shape);
    block_shake(&block, 0.05 * shape.edge, 12);
    double sum = 0.0;
    for (int32_t e = 0; e < block.state.element_count; e++)
        sum += shv_solid_element_energy(&block.solid, &block.state, e);
    check_near(sum / shv_solid_strain_energy(&block.solid, &block.state), 1.0, 1e-13);
    int32_t *all = malloc((size_t)block.state.element_count * sizeof *all);
    for (int32_t e = 0; e < block.state.element_count; e++) all[e] = e;
    block_shake(&block, 0.04 * shape.edge, 13);
    const double body = shv_solid_energy_of(&block.solid, &block.state, all, block.state.element_count);
    check_near(body / shv_solid_strain_energy(&block.solid, &block.state), 1.0, 1e-13);
    free(all);
    block_release(&block);
}

/* Means of what is everywhere the same. */
static void uniform_strain_is_as_without(void **unused)
{
    (void)unused;
    static const double a[3][3] = {{0.05, -0.32, 0.11}, {0.24, -0.08, 0.17}, {-0.13, -0.09, 0.03}};
    static const double shift[3] = {0.01, 0.02, -0.03};
    for (int i = 0; i < 2; i++) {
        Block smoothed, linear;
        BlockShape shape = smoothed_shape(4, 3, 3);
        shape.kinematics = both_kinematics[i];
        block_create(&smoothed, &shape);
        shape.smoothed = false;
        block_create(&linear, &shape);
        block_map(&smoothed, a, shift);
        block_map(&linear, a, shift);
        block_force(&smoothed);
        block_force(&linear);
        const double unit = block_largest_force(&linear);
        for (int64_t k = 0; k < 3 * (int64_t)linear.state.node_count; k++)
            check_near(smoothed.state.force[k] / unit, linear.state.force[k] / unit, 1e-13);
        check_near(shv_solid_strain_energy(&smoothed.solid, &smoothed.state) /
                       shv_solid_strain_energy(&linear.solid, &linear.state),
                   1.0, 1e-13);
        block_release(&smoothed);
        block_release(&linear);
    }
}

static void rest_and_shifts_give_no_force_at_all(void **unused)
{
    (void)unused;
    static const double zero[3] = {0.0};
    Block block;
    BlockShape shape = smoothed_shape(3, 3, 3);
    shape.materials = 2;
    shape.offset = 1e6;
    block_create(&block, &shape);
    for (int shifted = 0; shifted < 2; shifted++) {
        for (int64_t k = 0; k < 3 * (int64_t)block.state.node_count; k++)
            block.state.displacement[k] = shifted ? 0.3 * (double)(k % 3 + 1) : 0.0;
        block_force(&block);
        for (int32_t node = 0; node < block.state.node_count; node++)
            assert_memory_equal(block.state.force + 3 * (int64_t)node, zero, sizeof zero);
    }
    block_release(&block);
}

static void any_number_of_threads_gives_the_same_bits(void **unused)
{
    (void)unused;
    Block one, three;
    BlockShape shape = smoothed_shape(7, 6, 5);
    shape.materials = 2;
    block_create(&one, &shape);
    shape.threads = 3;
    block_create(&three, &shape);
    block_shake(&one, 0.05 * shape.edge, 16);
    block_shake(&three, 0.05 * shape.edge, 16);
    block_force(&one);
    block_force(&three);
    assert_memory_equal(one.state.force, three.state.force, 3 * (size_t)one.state.node_count * sizeof(double));
    assert_true(shv_solid_strain_energy(&one.solid, &one.state) == shv_solid_strain_energy(&three.solid, &three.state));
    block_release(&one);
    block_release(&three);
}

/* ---- bending ---- */

/* Pure bending of a beam about z, small: axial strain −κ y, and no stress across. */
static void bend(Block *block, const BlockShape *shape, double curvature)
{
    const double nu = shape->poissons_ratio, middle = 0.5 * shape->edge * shape->cells[1];
    for (int32_t node = 0; node < block->state.node_count; node++) {
        const double *at = block->state.reference + 3 * (int64_t)node;
        const double x = at[0], y = at[1] - middle, z = at[2];
        double *u = block->state.displacement + 3 * (int64_t)node;
        u[0] = -curvature * x * y;
        u[1] = 0.5 * curvature * (x * x + nu * (y * y - z * z));
        u[2] = nu * curvature * y * z;
    }
}

/* Energy of a wall `layers` cells thick that is bent as a beam bends, over what the beam has, E I κ² L/2. Nodes are where the
   beam has them; between them tets are straight, and shear. */
static double stiffness(int32_t layers, bool smoothed)
{
    Block block;
    BlockShape shape = block_shape(16, layers, 6);
    shape.smoothed = smoothed;
    shape.jitter = 0.0;
    block_create(&block, &shape);
    const double curvature = 1e-6 / shape.edge, height = layers * shape.edge;
    bend(&block, &shape, curvature);
    const double beam = 0.5 * shape.youngs_modulus * (6.0 * shape.edge) * height * height * height / 12.0 * curvature *
                        curvature * (16.0 * shape.edge);
    const double energy = shv_solid_strain_energy(&block.solid, &block.state);
    block_release(&block);
    return energy / beam;
}

/* What walls of linear tets are too stiff by is c (edge/thickness)²; smoothed edges leave a fifth of it. */
static void walls_bend(void **unused)
{
    (void)unused;
    for (int32_t layers = 1; layers <= 4; layers++) {
        const double square = (double)layers * layers;
        const double linear = (stiffness(layers, false) - 1.0) * square;
        const double smoothed = (stiffness(layers, true) - 1.0) * square;
        print_message("%d layers: linear tets 1 + %.2f/n², smoothed 1 %+.2f/n²\n", layers, linear, smoothed);
        assert_true(linear > 1.5);
        assert_true(fabs(smoothed) < 0.25 * linear);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(force_is_the_slope_of_energy),
        cmocka_unit_test(element_energies_add_up),
        cmocka_unit_test(uniform_strain_is_as_without),
        cmocka_unit_test(rest_and_shifts_give_no_force_at_all),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(walls_bend),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
