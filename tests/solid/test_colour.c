#include "block.h"

/* Which chunk of a colour last touched each node: no other chunk of that colour may. */
static void check_colour(const Block *block, int32_t colour, int32_t *owner)
{
    const ShvSolid *solid = &block->solid;
    for (int32_t node = 0; node < block->state.node_count; node++) owner[node] = -1;
    for (int32_t i = solid->colour_start[colour]; i < solid->colour_start[colour + 1]; i++) {
        const int32_t chunk = solid->chunk_order[i];
        if (i > solid->colour_start[colour]) assert_true(chunk > solid->chunk_order[i - 1]);
        for (int32_t e = chunk * solid->chunk_batches * SHV_LANES;
             e < (chunk + 1) * solid->chunk_batches * SHV_LANES && e < block->state.element_count; e++)
            for (int32_t corner = 0; corner < 4; corner++) {
                int32_t *who = &owner[shv_state_node(&block->state, e, corner)];
                assert_true(*who == -1 || *who == chunk);
                *who = chunk;
            }
    }
}

static void check_colours(const Block *block)
{
    const ShvSolid *solid = &block->solid;
    int32_t *owner = shv_allocate(block->memory, SHV_PART_GENERAL, (size_t)block->state.node_count, sizeof *owner);
    uint8_t *seen = shv_allocate(block->memory, SHV_PART_GENERAL, (size_t)solid->chunk_count, sizeof *seen);
    assert_non_null(owner);
    assert_non_null(seen);
    assert_int_equal(solid->colour_start[0], 0);
    assert_int_equal(solid->colour_start[solid->colour_count], solid->chunk_count);
    assert_true((int64_t)solid->chunk_count * solid->chunk_batches >= solid->batch_count);
    for (int32_t i = 0; i < solid->chunk_count; i++) seen[solid->chunk_order[i]]++;
    for (int32_t i = 0; i < solid->chunk_count; i++) assert_int_equal(seen[i], 1);
    for (int32_t colour = 0; colour < solid->colour_count; colour++) {
        assert_true(solid->colour_start[colour] < solid->colour_start[colour + 1]);
        check_colour(block, colour, owner);
    }
    shv_release(owner);
    shv_release(seen);
}

static void chunks_of_a_colour_share_no_node(void **unused)
{
    (void)unused;
    for (int32_t size = 1; size <= 16; size += 5) {
        Block block;
        const BlockShape shape = block_shape(size, size, size);
        block_create(&block, &shape);
        check_colours(&block);
        assert_true(block.solid.colour_count < 30);
        block_release(&block);
    }
}

/* Without locality almost every pair of chunks shares a node: after 64 colours the rest run one by one. */
static void a_mesh_without_locality_is_served(void **unused)
{
    (void)unused;
    Block block;
    BlockShape shape = block_shape(12, 12, 12);
    shape.shuffled = 1;
    block_create(&block, &shape);
    assert_true(block.solid.colour_count > 64);
    check_colours(&block);
    block_release(&block);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chunks_of_a_colour_share_no_node),
        cmocka_unit_test(a_mesh_without_locality_is_served),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
