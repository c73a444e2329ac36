/* A model of one box of tets, its state and its cohesive facets. */
#ifndef SHV_TESTS_COHESIVE_FIXTURE_H
#define SHV_TESTS_COHESIVE_FIXTURE_H

#include <stdlib.h>

#include "check.h"

#include "cohesive/cohesive.h"

typedef struct Fixture {
    ShvMemory *memory;
    ShvSceneDefinition scene;
    ShvMaterialDefinition material;
    ShvObjectDefinition object;
    ShvModel model;
    ShvState state;
    ShvCohesive cohesive;
    double *stress;
    ShvError error;
} Fixture;

/* Glass by default; change scene, material and object before `fixture_build`. */
static inline void fixture_define(Fixture *f, double x, double y, double z, double edge)
{
    memset(f, 0, sizeof *f);
    f->memory = shv_memory_create();
    f->scene = shv_scene_default();
    f->material = shv_material_default();
    f->object = shv_object_default();
    f->material.name = "glass";
    f->material.density = 2500.0;
    f->material.youngs_modulus = 70e9;
    f->material.poissons_ratio = 0.22;
    f->material.breakable = true;
    f->material.fracture_energy = 8.0;
    f->material.cohesive_strength = 40e6;
    f->object.name = "box";
    f->object.material = "glass";
    f->object.mesh = shv_mesh_default();
    f->object.mesh.kind = SHV_MESH_BOX;
    f->object.mesh.size[0] = x;
    f->object.mesh.size[1] = y;
    f->object.mesh.size[2] = z;
    f->object.mesh.edge = edge;
    f->scene.name = "test";
    f->scene.duration = 1.0;
    f->scene.threads = 1;
    f->scene.fracture.enabled = true;
    f->scene.fracture.regularisation = 0.005;
    f->scene.fracture.criterion = SHV_CRITERION_TRACTION;
    f->scene.fracture.threshold = 0.9;
}

/* Six tets a cube round the diagonal, so that planes between cubes are planes of facets. */
static inline void fixture_cubes(Fixture *f, const int32_t cells[3])
{
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {2, 1, 0}, {0, 2, 1}};
    const double *size = f->object.mesh.size;
    ShvMesh *mesh = &f->model.mesh;
    const int64_t nodes = (int64_t)(cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
    check_ok(shv_mesh_allocate(mesh, f->memory, nodes, 6 * (int64_t)cells[0] * cells[1] * cells[2], &f->error),
             f->error);
    int32_t node = 0, element = 0, at[3];
    for (at[2] = 0; at[2] <= cells[2]; at[2]++)
        for (at[1] = 0; at[1] <= cells[1]; at[1]++)
            for (at[0] = 0; at[0] <= cells[0]; at[0]++, node++)
                for (int i = 0; i < 3; i++) mesh->positions[3 * node + i] = size[i] * ((double)at[i] / cells[i] - 0.5);
    for (at[0] = 0; at[0] < cells[0]; at[0]++)
        for (at[1] = 0; at[1] < cells[1]; at[1]++)
            for (at[2] = 0; at[2] < cells[2]; at[2]++)
                for (int tet = 0; tet < 6; tet++, element++) {
                    int32_t corner[3] = {at[0], at[1], at[2]};
                    for (int k = 0; k < 4; k++) {
                        const int place = tet >= 3 && k > 0 && k < 3 ? 3 - k : k; /* odd permutations turned round */
                        mesh->elements[4 * element + place] =
                            corner[0] + (cells[0] + 1) * (corner[1] + (cells[1] + 1) * corner[2]);
                        if (k < 3) corner[order[tet][k]]++;
                    }
                }
}

static inline void fixture_build_cubes(Fixture *f, int32_t x, int32_t y, int32_t z)
{
    f->scene.materials = &f->material;
    f->scene.material_count = 1;
    f->scene.objects = &f->object;
    f->scene.object_count = 1;
    f->model = (ShvModel){.memory = f->memory,
                          .material_count = 1,
                          .object_count = 1,
                          .can_break = true,
                          .threads = f->scene.threads,
                          .most_threads = f->scene.threads};
    fixture_cubes(f, (const int32_t[]){x, y, z});
    check_ok(shv_mesh_validate(&f->model.mesh, "cubes", &f->error), f->error);
    check_ok(shv_adjacency_build(&f->model.adjacency, &f->model.mesh, &f->error), f->error);
    const int32_t elements = f->model.mesh.element_count;
    f->model.materials = shv_allocate(f->memory, SHV_PART_GENERAL, 1, sizeof *f->model.materials);
    f->model.objects = shv_allocate(f->memory, SHV_PART_GENERAL, 1, sizeof *f->model.objects);
    f->model.element_material =
        shv_allocate(f->memory, SHV_PART_GENERAL, (size_t)elements, sizeof *f->model.element_material);
    assert_non_null(f->model.materials);
    assert_non_null(f->model.objects);
    assert_non_null(f->model.element_material);
    check_ok(shv_material_make(f->model.materials, &f->material, &f->error), f->error);
    *f->model.objects = (ShvObject){.name = "box", .element_end = elements, .node_end = f->model.mesh.node_count};
}

static inline void fixture_start(Fixture *f)
{
    check_ok(shv_state_create(&f->state, &f->model, &f->scene, &f->error), f->error);
    check_ok(shv_cohesive_create(&f->cohesive, &f->model, &f->scene.fracture, &f->error), f->error);
    f->stress = shv_allocate(f->memory, SHV_PART_STRESS, 6 * SHV_LANES * (size_t)f->state.batch_count, sizeof(double));
    assert_non_null(f->stress);
}

static inline void fixture_release(Fixture *f)
{
    shv_release(f->stress);
    shv_cohesive_release(&f->cohesive);
    shv_state_release(&f->state);
    shv_model_release(&f->model);
    assert_int_equal(shv_memory_bytes(f->memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(f->memory);
}

static inline void fixture_build(Fixture *f)
{
    f->scene.materials = &f->material;
    f->scene.material_count = 1;
    f->scene.objects = &f->object;
    f->scene.object_count = 1;
    check_ok(shv_model_build(&f->model, f->memory, &f->scene, NULL, &f->error), f->error);
    fixture_start(f);
}

/* The same stress everywhere. */
static inline void fixture_stress(Fixture *f, double xx, double yy, double zz, double yz, double xz, double xy)
{
    const double s[6] = {xx, yy, zz, yz, xz, xy};
    for (int32_t e = 0; e < f->state.element_count; e++)
        for (int c = 0; c < 6; c++) f->stress[(e / 8) * 48 + c * 8 + e % 8] = s[c];
}

static inline ShvVec3 fixture_facet_centre(const Fixture *f, int32_t facet)
{
    const ShvAdjacency *a = &f->model.adjacency;
    const int32_t *nodes = f->model.mesh.elements + 4 * (int64_t)a->facet_elements[2 * (int64_t)facet];
    const uint8_t *corners = shv_face_corners[a->facet_faces[2 * (int64_t)facet]];
    ShvVec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < 3; i++) sum = shv_madd(sum, 1.0 / 3.0, shv_mesh_position(&f->model.mesh, nodes[corners[i]]));
    return sum;
}

/* Interior facets whose three nodes lie on x = `at`. */
static inline int32_t fixture_plane(const Fixture *f, double at, double tolerance, int32_t *facets)
{
    const ShvAdjacency *a = &f->model.adjacency;
    int32_t count = 0;
    for (int32_t facet = 0; facet < a->interior_count; facet++) {
        const int32_t *nodes = f->model.mesh.elements + 4 * (int64_t)a->facet_elements[2 * (int64_t)facet];
        const uint8_t *corners = shv_face_corners[a->facet_faces[2 * (int64_t)facet]];
        int on = 0;
        for (int i = 0; i < 3; i++)
            on += fabs(f->model.mesh.positions[3 * (int64_t)nodes[corners[i]]] - at) < tolerance;
        if (on == 3) facets[count++] = facet;
    }
    return count;
}

/* Interior facets between elements whose centres lie on both sides of x = 0. */
static inline int32_t fixture_cut(const Fixture *f, int32_t *facets)
{
    const ShvAdjacency *a = &f->model.adjacency;
    int32_t count = 0;
    for (int32_t facet = 0; facet < a->interior_count; facet++) {
        double x[2] = {0.0, 0.0};
        for (int s = 0; s < 2; s++)
            for (int k = 0; k < 4; k++)
                x[s] += f->model.mesh.positions[3 * (int64_t)f->model.mesh
                                                        .elements[4 * (int64_t)a->facet_elements[2 * facet + s] + k]];
        if ((x[0] < 0.0) != (x[1] < 0.0)) facets[count++] = facet;
    }
    return count;
}

/* Components of elements that share nodes. */
static inline int32_t fixture_components(const Fixture *f)
{
    const int32_t nodes = f->state.node_count;
    int32_t *root = calloc((size_t)nodes, sizeof *root), count = 0;
    for (int32_t i = 0; i < nodes; i++) root[i] = i;
    for (int32_t e = 0; e < f->state.element_count; e++)
        for (int k = 1; k < 4; k++) {
            int32_t a = shv_state_node(&f->state, e, 0), b = shv_state_node(&f->state, e, k);
            while (root[a] != a) a = root[a] = root[root[a]];
            while (root[b] != b) b = root[b] = root[root[b]];
            root[a > b ? a : b] = a > b ? b : a;
        }
    for (int32_t i = 0; i < nodes; i++) count += root[i] == i;
    free(root);
    return count;
}

#endif
