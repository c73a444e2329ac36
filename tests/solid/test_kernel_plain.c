/* The kernels compiled for a narrower path against those of the library, bit by bit. test_kernel_avx2.c runs the
   same on the path of four doubles. */
#ifndef SHV_SIMD_AVX2
#define SHV_SIMD_PLAIN
#endif
#include "block.h"

#include "solid/kernel.h"

static void create(Block *block, ShvKinematics kinematics)
{
    BlockShape shape = block_shape(5, 4, 3);
    shape.materials = 2;
    shape.kinematics = kinematics;
    block_create(block, &shape);
    block_shake(block, 0.2 * shape.edge, 21);
}

static void forces_have_equal_bits(void **unused)
{
    (void)unused;
    for (int kinematics = 0; kinematics < 2; kinematics++) {
        Block block;
        create(&block, kinematics ? SHV_COROTATIONAL : SHV_GREEN_STRAIN);
        block_force(&block);
        const size_t count = 3 * (size_t)block.state.node_count;
        double *library = shv_allocate(block.memory, SHV_PART_GENERAL, count, sizeof *library);
        assert_non_null(library);
        memcpy(library, block.state.force, count * sizeof *library);
        shv_motion_clear_force(&block.state, NULL, 0, 1);
        for (int32_t i = 0; i < block.solid.chunk_count; i++) {
            const int32_t begin = block.solid.chunk_order[i] * block.solid.chunk_batches;
            for (int32_t batch = begin; batch < begin + block.solid.chunk_batches && batch < block.solid.batch_count;
                 batch++)
                shv_batch_add_force(&block.solid, &block.state, batch);
        }
        assert_memory_equal(library, block.state.force, count * sizeof *library);
        shv_release(library);
        block_release(&block);
    }
}

static void stresses_and_energies_have_equal_bits(void **unused)
{
    (void)unused;
    for (int kinematics = 0; kinematics < 2; kinematics++) {
        Block block;
        create(&block, kinematics ? SHV_COROTATIONAL : SHV_GREEN_STRAIN);
        _Alignas(64) double stress[6 * SHV_LANES], energy[SHV_LANES];
        double *library = shv_allocate(block.memory, SHV_PART_GENERAL, (size_t)block.solid.batch_count, sizeof stress);
        assert_non_null(library);
        shv_solid_stress(&block.solid, &block.state, library);
        for (int32_t batch = 0; batch < block.solid.batch_count; batch++) {
            shv_batch_cauchy(&block.solid, &block.state, batch, stress);
            assert_memory_equal(stress, library + (int64_t)batch * (6 * SHV_LANES), sizeof stress);
            shv_wide_store(energy, shv_batch_energy(&block.solid, &block.state, batch));
            for (int32_t lane = 0; lane < SHV_LANES && batch * SHV_LANES + lane < block.state.element_count; lane++) {
                const double other = shv_solid_element_energy(&block.solid, &block.state, batch * SHV_LANES + lane);
                assert_memory_equal(&energy[lane], &other, sizeof other);
            }
        }
        shv_release(library);
        block_release(&block);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_have_equal_bits),
        cmocka_unit_test(stresses_and_energies_have_equal_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
