/* A block of cubes, six tets each, made by hand so that these tests know every node: model, state and solid
   together. */
#ifndef SHV_TESTS_SOLID_BLOCK_H
#define SHV_TESTS_SOLID_BLOCK_H

#include "check.h"

#include "base/random.h"
#include "solid/motion.h"
#include "solid/solid.h"

static const ShvKinematics both_kinematics[2] = {SHV_GREEN_STRAIN, SHV_COROTATIONAL};

typedef struct BlockShape {
    int32_t cells[3];
    double edge;   /* m */
    double jitter; /* of the edge, all nodes */
    double offset; /* m, added to every coordinate */
    int32_t threads;
    ShvKinematics kinematics;
    double poissons_ratio, youngs_modulus, density;
    int32_t materials; /* 2: every third element is of a second material, twice as stiff and of the other kinematics */
    int shuffled;      /* elements in random order: no locality at all */
    bool smoothed;     /* strain over edges */
} BlockShape;

typedef struct Block {
    ShvMemory *memory;
    ShvObjectDefinition object;
    ShvSceneDefinition scene;
    ShvModel model;
    ShvState state;
    ShvSolid solid;
    ShvError error;
} Block;

static inline BlockShape block_shape(int32_t x, int32_t y, int32_t z)
{
    return (BlockShape){.cells = {x, y, z},
                        .edge = 0.01,
                        .jitter = 0.15,
                        .threads = 1,
                        .kinematics = SHV_GREEN_STRAIN,
                        .poissons_ratio = 0.24,
                        .youngs_modulus = 70e9,
                        .density = 2500.0,
                        .materials = 1};
}

static inline int32_t block_node(const BlockShape *shape, int32_t x, int32_t y, int32_t z)
{
    return (z * (shape->cells[1] + 1) + y) * (shape->cells[0] + 1) + x;
}

static inline void block_positions(const BlockShape *shape, ShvMesh *mesh)
{
    for (int32_t z = 0; z <= shape->cells[2]; z++)
        for (int32_t y = 0; y <= shape->cells[1]; y++)
            for (int32_t x = 0; x <= shape->cells[0]; x++) {
                const int32_t node = block_node(shape, x, y, z);
                const double at[3] = {x, y, z};
                for (int c = 0; c < 3; c++) {
                    const double shift = shape->jitter * (2.0 * shv_random_uniform(7, (uint64_t)(3 * node + c)) - 1.0);
                    mesh->positions[3 * (int64_t)node + c] = shape->offset + shape->edge * (at[c] + shift);
                }
            }
}

/* Kuhn's six tets: from one corner of the cube to the opposite one along the axes in every order. */
static inline void block_elements(const BlockShape *shape, ShvMesh *mesh)
{
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    int64_t slot = 0;
    for (int32_t z = 0; z < shape->cells[2]; z++)
        for (int32_t y = 0; y < shape->cells[1]; y++)
            for (int32_t x = 0; x < shape->cells[0]; x++)
                for (int o = 0; o < 6; o++) {
                    int32_t at[3] = {x, y, z}, nodes[4];
                    nodes[0] = block_node(shape, x, y, z);
                    for (int k = 0; k < 3; k++) {
                        at[orders[o][k]]++;
                        nodes[k + 1] = block_node(shape, at[0], at[1], at[2]);
                    }
                    /* Odd orders are left handed. */
                    const int odd = o >= 3;
                    mesh->elements[slot++] = nodes[0];
                    mesh->elements[slot++] = nodes[odd ? 2 : 1];
                    mesh->elements[slot++] = nodes[odd ? 1 : 2];
                    mesh->elements[slot++] = nodes[3];
                }
}

static inline void block_shuffle(ShvMesh *mesh)
{
    for (int32_t i = mesh->element_count - 1; i > 0; i--) {
        const int32_t j = (int32_t)(shv_random_bits(23, (uint64_t)i) % (uint64_t)(i + 1));
        int32_t kept[4];
        memcpy(kept, mesh->elements + 4 * (int64_t)i, sizeof kept);
        memmove(mesh->elements + 4 * (int64_t)i, mesh->elements + 4 * (int64_t)j, sizeof kept);
        memcpy(mesh->elements + 4 * (int64_t)j, kept, sizeof kept);
    }
}

static inline void block_materials(Block *block, const BlockShape *shape)
{
    ShvModel *model = &block->model;
    model->materials = shv_allocate(block->memory, SHV_PART_GENERAL, 2, sizeof *model->materials);
    assert_non_null(model->materials);
    model->material_count = 2;
    for (int i = 0; i < 2; i++) {
        ShvMaterialDefinition definition = shv_material_default();
        definition.name = i ? "second" : "first";
        definition.density = shape->density;
        definition.youngs_modulus = shape->youngs_modulus * (i + 1);
        definition.poissons_ratio = shape->poissons_ratio;
        definition.breakable = false;
        definition.smoothing = shape->smoothed ? SHV_SMOOTHING_EDGES : SHV_SMOOTHING_NONE;
        definition.kinematics =
            (shape->kinematics == SHV_GREEN_STRAIN) == (i == 0) ? SHV_GREEN_STRAIN : SHV_COROTATIONAL;
        check_ok(shv_material_make(&model->materials[i], &definition, &block->error), block->error);
    }
    model->element_material =
        shv_allocate(block->memory, SHV_PART_MESH, (size_t)model->mesh.element_count, sizeof *model->element_material);
    assert_non_null(model->element_material);
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        model->element_material[e] = shape->materials == 2 && e % 3 == 2;
}

/* State and solid of a model whose mesh and materials are there. */
static inline void block_finish(Block *block, int32_t threads)
{
    ShvModel *model = &block->model;
    model->memory = block->memory;
    model->threads = threads;
    model->objects = shv_allocate(block->memory, SHV_PART_GENERAL, 1, sizeof *model->objects);
    assert_non_null(model->objects);
    model->object_count = 1;
    model->objects[0] =
        (ShvObject){.name = "block", .element_end = model->mesh.element_count, .node_end = model->mesh.node_count};
    block->object = shv_object_default();
    block->scene = shv_scene_default();
    block->scene.objects = &block->object;
    block->scene.object_count = 1;
    check_ok(shv_state_create(&block->state, model, &block->scene, &block->error), block->error);
    check_ok(shv_solid_create(&block->solid, model, &block->state, &block->error), block->error);
}

static inline void block_create(Block *block, const BlockShape *shape)
{
    *block = (Block){.memory = shv_memory_create()};
    assert_non_null(block->memory);
    const int64_t cubes = (int64_t)shape->cells[0] * shape->cells[1] * shape->cells[2];
    const int64_t nodes = (int64_t)(shape->cells[0] + 1) * (shape->cells[1] + 1) * (shape->cells[2] + 1);
    check_ok(shv_mesh_allocate(&block->model.mesh, block->memory, nodes, 6 * cubes, &block->error), block->error);
    block_positions(shape, &block->model.mesh);
    block_elements(shape, &block->model.mesh);
    if (shape->shuffled) block_shuffle(&block->model.mesh);
    block_materials(block, shape);
    block_finish(block, shape->threads);
}

/* One tet with the given corners. */
static inline void block_create_tet(Block *block, const BlockShape *shape, const double corners[12])
{
    *block = (Block){.memory = shv_memory_create()};
    assert_non_null(block->memory);
    check_ok(shv_mesh_allocate(&block->model.mesh, block->memory, 4, 1, &block->error), block->error);
    memcpy(block->model.mesh.positions, corners, 12 * sizeof *corners);
    for (int32_t i = 0; i < 4; i++) block->model.mesh.elements[i] = i;
    block_materials(block, shape);
    block_finish(block, shape->threads);
}

static inline void block_release(Block *block)
{
    shv_solid_release(&block->solid);
    shv_state_release(&block->state);
    shv_mesh_release(&block->model.mesh);
    shv_release(block->model.materials);
    shv_release(block->model.objects);
    shv_release(block->model.element_material);
    assert_int_equal(shv_memory_bytes(block->memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(block->memory);
}

/* Displacements of random size up to `size`, m. */
static inline void block_shake(Block *block, double size, uint64_t seed)
{
    for (int64_t i = 0; i < 3 * (int64_t)block->state.node_count; i++)
        block->state.displacement[i] = size * (2.0 * shv_random_uniform(seed, (uint64_t)i) - 1.0);
}

/* u = A X + b, so that F = I + A everywhere. */
static inline void block_map(Block *block, const double a[3][3], const double b[3])
{
    for (int32_t node = 0; node < block->state.node_count; node++)
        for (int i = 0; i < 3; i++) {
            const double *x = block->state.reference + 3 * (int64_t)node;
            block->state.displacement[3 * (int64_t)node + i] = a[i][0] * x[0] + a[i][1] * x[1] + a[i][2] * x[2] + b[i];
        }
}

static inline void block_force(Block *block)
{
    shv_motion_clear_force(&block->state, NULL, 0, block->model.threads);
    shv_solid_add_internal_force(&block->solid, &block->state);
}

static inline double block_largest_force(const Block *block)
{
    double largest = 0.0;
    for (int64_t i = 0; i < 3 * (int64_t)block->state.node_count; i++)
        largest = fmax(largest, fabs(block->state.force[i]));
    return largest;
}

/* Central differences of U with step s miss by s² U'''/6 and by rounding of U over s. Units: displacements of 0.05
   edges (strains near 0.1), forces near E edge² × 0.1. With s = 1e-5 edge: truncation (1e-5)² of the force, rounding
   1e-16 U / s with U near 300 elements × E edge³ × 0.01, so 3e-11 E edge². */
static inline void block_check_slope(const BlockShape *shape)
{
    Block block;
    block_create(&block, shape);
    block_shake(&block, 0.05 * shape->edge, 11);
    block_force(&block);
    const double step = 1e-5 * shape->edge, unit = shape->youngs_modulus * shape->edge * shape->edge;
    for (int64_t i = 0; i < 3 * (int64_t)block.state.node_count; i += 7) {
        const double u = block.state.displacement[i];
        block.state.displacement[i] = u + step;
        const double above = shv_solid_strain_energy(&block.solid, &block.state);
        block.state.displacement[i] = u - step;
        const double below = shv_solid_strain_energy(&block.solid, &block.state);
        block.state.displacement[i] = u;
        check_near(block.state.force[i] / unit, -(above - below) / (2.0 * step) / unit, 1e-9);
    }
    block_release(&block);
}

#endif
