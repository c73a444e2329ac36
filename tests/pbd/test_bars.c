/* Bars: which edges there are, what a sweep does with them, the closed forms of one bar alone, and their upkeep while
   nodes are duplicated and fragments switch. */
#include "rigid/world.h"

#include "pbd/bar_kernel.h"
#include "pbd/bars.h"

typedef struct Mesh {
    World world;
    ShvBars bars;
    double *anchors, *shifts;
} Mesh;

static void quads_make(Mesh *mesh)
{
    const ShvState *state = &mesh->world.state;
    shv_release(mesh->anchors);
    shv_release(mesh->shifts);
    mesh->anchors = shv_allocate(NULL, SHV_PART_GENERAL, 4 * (size_t)state->node_count, sizeof(double));
    mesh->shifts = shv_allocate(NULL, SHV_PART_GENERAL, 4 * (size_t)state->node_count, sizeof(double));
    assert_true(mesh->anchors && mesh->shifts);
    for (int64_t i = 0; i < state->node_count; i++) {
        for (int c = 0; c < 3; c++) {
            mesh->anchors[4 * i + c] = state->reference[3 * i + c];
            mesh->shifts[4 * i + c] = 0.01 * (shv_random_uniform(2, (uint64_t)(3 * i + c)) - 0.5);
        }
        mesh->anchors[4 * i + 3] = 1.0 / state->mass[i];
    }
}

static void mesh_make(Mesh *mesh, ShvBarForm form, double edge, bool breakable, int32_t threads)
{
    ShvError error = {0};
    *mesh = (Mesh){.anchors = NULL};
    world_begin(&mesh->world);
    mesh->world.scene.fracture.enabled = breakable;
    mesh->world.scene.threads = threads;
    world_box(&mesh->world, 1.0, 1.0, 1.0, edge)->mesh.jitter = 0.15;
    world_build(&mesh->world);
    check_ok(shv_bars_create(&mesh->bars, &mesh->world.model, form, &error), error);
    check_ok(shv_bars_update(&mesh->bars, &mesh->world.state, NULL, &error), error);
    quads_make(mesh);
}

static void mesh_end(Mesh *mesh)
{
    shv_release(mesh->anchors);
    shv_release(mesh->shifts);
    shv_bars_release(&mesh->bars);
    world_end(&mesh->world);
}

/* ---- which items there are ---- */

typedef struct Item {
    int32_t node[4];
} Item;

static int by_nodes(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(Item));
}

static Item sorted(const int32_t *nodes, int count)
{
    Item item = {{-1, -1, -1, -1}};
    for (int i = 0; i < count; i++) {
        int place = i;
        for (; place > 0 && item.node[place - 1] > nodes[i]; place--) item.node[place] = item.node[place - 1];
        item.node[place] = nodes[i];
    }
    return item;
}

static int32_t distinct(Item *items, int32_t count)
{
    qsort(items, (size_t)count, sizeof *items, by_nodes);
    int32_t kept = 0;
    for (int32_t i = 0; i < count; i++)
        if (i == 0 || by_nodes(&items[i], &items[kept - 1]) != 0) items[kept++] = items[i];
    return kept;
}

/* All edges (once) or tets of the flagged elements, sorted. */
static int32_t expected_items(const Mesh *mesh, const uint8_t *flags, Item **items)
{
    const ShvState *state = &mesh->world.state;
    *items = malloc(6 * (size_t)state->element_count * sizeof **items);
    int32_t count = 0;
    for (int32_t e = 0; e < state->element_count; e++) {
        if (flags && !flags[state->element_fragment[e]]) continue;
        int32_t nodes[4];
        for (int c = 0; c < 4; c++) nodes[c] = shv_state_node(state, e, c);
        if (mesh->bars.corners == 4) (*items)[count++] = sorted(nodes, 4);
        for (int k = 0; k < 6 && mesh->bars.corners == 2; k++)
            (*items)[count++] = sorted((int32_t[2]){nodes[shv_tet_edges[k][0]], nodes[shv_tet_edges[k][1]]}, 2);
    }
    return distinct(*items, count);
}

/* Items as the batches hold them; checks that lanes of a batch share no node and repeat only the first. */
static int32_t stored_items(const Mesh *mesh, Item **items)
{
    const ShvBars *bars = &mesh->bars;
    int32_t count = 0;
    *items = malloc(SHV_LANES * ((size_t)bars->batch_end + 1) * sizeof **items);
    for (int32_t chunk = 0; chunk < bars->chunk_count; chunk++)
        for (int32_t k = 0; k < bars->chunks[chunk].count; k++) {
            const int32_t *ends = bars->ends + (int64_t)(bars->chunks[chunk].first + k) * bars->corners * SHV_LANES;
            Item lane[SHV_LANES];
            for (int i = 0; i < SHV_LANES; i++) {
                int32_t nodes[4];
                for (int c = 0; c < bars->corners; c++) nodes[c] = ends[c * SHV_LANES + i];
                lane[i] = sorted(nodes, bars->corners);
                if (i > 0 && by_nodes(&lane[i], &lane[0]) == 0) continue;
                (*items)[count++] = lane[i];
                for (int j = 0; j < i; j++)
                    for (int c = 0; c < 16; c++)
                        assert_false(c / 4 < bars->corners && c % 4 < bars->corners &&
                                     lane[i].node[c / 4] == lane[j].node[c % 4]);
            }
        }
    return count;
}

static void check_items(const Mesh *mesh, const uint8_t *flags)
{
    Item *expected, *stored;
    const int32_t count = expected_items(mesh, flags, &expected), found = stored_items(mesh, &stored);
    assert_int_equal(found, count);
    assert_int_equal(distinct(stored, found), count);
    assert_memory_equal(stored, expected, (size_t)count * sizeof *stored);
    assert_int_equal(mesh->bars.bar_count, (int64_t)count * mesh->bars.edges);
    free(expected);
    free(stored);
}

static void every_edge_or_tet_is_there_once(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        Mesh mesh;
        mesh_make(&mesh, i % 2 ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, 0.13, i / 2, 1);
        assert_true(mesh.bars.chunk_count > 3);
        check_items(&mesh, NULL);
        mesh_end(&mesh);
    }
}

/* ---- what a sweep does ---- */

/* The same sweep bar after bar, from lengths, and what each projection does to momentum and angular momentum, or to the
   reactions of pinned nodes. */
static void sweep_plainly(const Mesh *mesh, double stiffness, double *shifts, double *lost, double *reactions)
{
    const ShvBars *bars = &mesh->bars;
    for (int32_t i = 0; i < bars->chunk_count; i++) {
        const ShvBarChunk *chunk = &bars->chunks[bars->chunk_order[i]];
        for (int64_t b = chunk->first; b < chunk->first + chunk->count; b++)
            for (int lane = 0; lane < SHV_LANES; lane++)
                for (int e = 0; e < bars->edges; e++) {
                    const int32_t *ends = bars->ends + b * bars->corners * SHV_LANES;
                    const int64_t n = ends[shv_tet_edges[e][0] * SHV_LANES + lane];
                    const int64_t m = ends[shv_tet_edges[e][1] * SHV_LANES + lane];
                    if (lane > 0 && ends[lane] == ends[0]) continue;
                    const double wn = mesh->anchors[4 * n + 3], wm = mesh->anchors[4 * m + 3];
                    const ShvVec3 x = shv_add(shv_load3(mesh->anchors + 4 * n), shv_load3(shifts + 4 * n));
                    const ShvVec3 y = shv_add(shv_load3(mesh->anchors + 4 * m), shv_load3(shifts + 4 * m));
                    const double rest =
                        shv_norm(shv_sub(shv_load3(mesh->anchors + 4 * n), shv_load3(mesh->anchors + 4 * m)));
                    const ShvVec3 edge = shv_sub(x, y);
                    if (!(wn + wm > 0.0)) continue;
                    const double c = stiffness * (shv_norm(edge) - rest) / (shv_norm(edge) * (wn + wm));
                    const ShvVec3 first = shv_scale(edge, -wn * c), second = shv_scale(edge, wm * c);
                    shv_add_to3(shifts + 4 * n, first);
                    shv_add_to3(shifts + 4 * m, second);
                    if (wn == 0.0) shv_add_to3(reactions + 3 * n, shv_scale(edge, c));
                    if (wm == 0.0) shv_add_to3(reactions + 3 * m, shv_scale(edge, -c));
                    if (wn == 0.0 || wm == 0.0) continue;
                    const ShvVec3 momentum = shv_add(shv_scale(first, 1.0 / wn), shv_scale(second, 1.0 / wm));
                    const ShvVec3 angular =
                        shv_add(shv_cross(x, shv_scale(first, 1.0 / wn)), shv_cross(y, shv_scale(second, 1.0 / wm)));
                    *lost = fmax(*lost, (shv_norm(momentum) + shv_norm(angular)) / (fabs(c) * shv_norm(edge) + 1e-300));
                }
    }
}

static ShvVec3 moment_of(const Mesh *mesh, const double *shifts)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    for (int64_t i = 0; i < mesh->world.state.node_count; i++)
        sum = shv_madd(sum, mesh->world.state.mass[i], shv_load3(shifts + 4 * i));
    return sum;
}

/* The meshes' sizes are 1, so that round-off is some units of 1e-16 a projection. */
static void a_sweep_is_gauss_seidel_and_keeps_momentum(void **state)
{
    (void)state;
    for (int form = 0; form < 2; form++) {
        Mesh mesh;
        mesh_make(&mesh, form ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, 0.2, false, 1);
        const size_t size = 4 * (size_t)mesh.world.state.node_count * sizeof(double);
        double *plain = malloc(size), lost = 0.0;
        memcpy(plain, mesh.shifts, size);
        const ShvVec3 before = moment_of(&mesh, plain);
        sweep_plainly(&mesh, 0.8, plain, &lost, NULL);
        assert_true(lost < 1e-14);
        shv_bars_sweep(&mesh.bars, 0.8, mesh.anchors, mesh.shifts);
        for (int64_t i = 0; i < 4 * (int64_t)mesh.world.state.node_count; i++)
            if (i % 4 != 3) check_near(mesh.shifts[i], plain[i], 1e-14);
        check_near(shv_norm(shv_sub(moment_of(&mesh, mesh.shifts), before)), 0.0, 1e-14 * 2500.0 * 0.01);
        free(plain);
        mesh_end(&mesh);
    }
}

/* A third of the nodes is pinned. Masses are some 10 kg and displacements some 0.01 m: reactions some 0.1 kg m. */
static void reactions_are_what_holds_pinned_nodes(void **state)
{
    (void)state;
    for (int form = 0; form < 2; form++) {
        Mesh mesh;
        mesh_make(&mesh, form ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, 0.2, false, 1);
        const int64_t nodes = mesh.world.state.node_count;
        const size_t size = 4 * (size_t)nodes * sizeof(double);
        double *plain = malloc(size), *held = shv_allocate(NULL, SHV_PART_GENERAL, 1, size), lost = 0.0;
        assert_non_null(held);
        double *reactions = calloc(3 * (size_t)nodes, sizeof(double)),
               *expected = calloc(3 * (size_t)nodes, sizeof(double));
        for (int64_t i = 0; i < nodes; i += 3) mesh.anchors[4 * i + 3] = 0.0;
        memcpy(plain, mesh.shifts, size);
        memcpy(held, mesh.shifts, size);
        ShvVec3 given = shv_scale(moment_of(&mesh, plain), -1.0);
        sweep_plainly(&mesh, 0.8, plain, &lost, expected);
        shv_bars_sweep_held(&mesh.bars, 0.8, mesh.anchors, held, reactions);
        shv_bars_sweep(&mesh.bars, 0.8, mesh.anchors, mesh.shifts);
        assert_memory_equal(held, mesh.shifts, size);
        given = shv_add(given, moment_of(&mesh, held));
        for (int64_t i = 0; i < nodes; i++) {
            const ShvVec3 reaction = shv_load3(reactions + 3 * i);
            assert_true((i % 3 == 0) == (shv_norm(reaction) > 0.0));
            check_near(shv_norm(shv_sub(reaction, shv_load3(expected + 3 * i))), 0.0, 1e-13);
            given = shv_sub(given, reaction);
        }
        check_near(shv_norm(given), 0.0, 1e-14 * 2500.0 * 0.01);
        free(plain);
        shv_release(held);
        free(reactions);
        free(expected);
        mesh_end(&mesh);
    }
}

static void sweeps_have_the_same_bits_for_any_number_of_threads(void **state)
{
    (void)state;
    for (int form = 0; form < 2; form++) {
        double *first = NULL;
        for (int32_t threads = 1; threads <= 3; threads++) {
            Mesh mesh;
            mesh_make(&mesh, form ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, 0.09, false, threads);
            const size_t size = 4 * (size_t)mesh.world.state.node_count * sizeof(double);
            for (int i = 0; i < 3; i++) shv_bars_sweep(&mesh.bars, 0.9, mesh.anchors, mesh.shifts);
            if (!first) {
                first = malloc(size);
                memcpy(first, mesh.shifts, size);
            }
            assert_memory_equal(first, mesh.shifts, size);
            mesh_end(&mesh);
        }
        free(first);
    }
}

static void translation_is_left_alone_to_the_last_bit(void **state)
{
    (void)state;
    Mesh mesh;
    mesh_make(&mesh, SHV_BARS_ELEMENT, 0.2, false, 1);
    const double shift[3] = {1e3 / 7.0, -3.3, 1e-9};
    for (int64_t i = 0; i < mesh.world.state.node_count; i++) memcpy(mesh.shifts + 4 * i, shift, sizeof shift);
    assert_true(shv_bars_largest_strain(&mesh.bars, mesh.anchors, mesh.shifts) == 0.0);
    for (int k = 0; k < 5; k++) shv_bars_sweep(&mesh.bars, 1.0, mesh.anchors, mesh.shifts);
    for (int64_t i = 0; i < mesh.world.state.node_count; i++)
        assert_memory_equal(mesh.shifts + 4 * i, shift, sizeof shift);
    mesh_end(&mesh);
}

/* Uniform stretch: every bar has the strain of the stretch. */
static void largest_strain_is_that_of_a_stretch(void **state)
{
    (void)state;
    for (int form = 0; form < 2; form++) {
        Mesh mesh;
        mesh_make(&mesh, form ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, 0.3, false, 2);
        const double strains[] = {1e-12, -1e-5, 0.3};
        for (int k = 0; k < 3; k++) {
            for (int64_t i = 0; i < mesh.world.state.node_count; i++)
                for (int c = 0; c < 3; c++) mesh.shifts[4 * i + c] = strains[k] * mesh.anchors[4 * i + c];
            check_near(shv_bars_largest_strain(&mesh.bars, mesh.anchors, mesh.shifts), fabs(strains[k]),
                       1e-13 * fabs(strains[k]) + 1e-28);
        }
        mesh_end(&mesh);
    }
}

/* ---- one bar alone ---- */

typedef struct OneBar {
    ShvModel model;
    ShvBarChunk chunk;
    int32_t colour_start[2], chunk_order[1], ends[2 * SHV_LANES];
    _Alignas(64) double rest[SHV_LANES];
    _Alignas(64) double anchors[8], shifts[8];
    ShvBars bars;
} OneBar;

static void one_bar_make(OneBar *one, double first_inverse_mass, double second_inverse_mass)
{
    *one = (OneBar){.model = {.threads = 1},
                    .chunk = {.first = 0, .count = 1, .room = 1, .items = 1},
                    .colour_start = {0, 1},
                    .anchors = {0.0, 0.0, 0.0, first_inverse_mass, 0.0, 0.0, -1.0, second_inverse_mass}};
    for (int i = 0; i < SHV_LANES; i++) {
        one->ends[SHV_LANES + i] = 1;
        one->rest[i] = 1.0;
    }
    one->bars = (ShvBars){.model = &one->model,
                          .form = SHV_BARS_EDGE,
                          .corners = 2,
                          .edges = 1,
                          .chunk_count = 1,
                          .chunks = &one->chunk,
                          .colour_count = 1,
                          .colour_start = one->colour_start,
                          .chunk_order = one->chunk_order,
                          .batch_end = 1,
                          .ends = one->ends,
                          .rest = one->rest};
}

/* Stretch of a bar that hangs from a pinned end, with elasticity ω, after some steps. */
static double hang(double stiffness, int iterations, double omega, double gravity, double step, int steps, double start)
{
    OneBar one;
    one_bar_make(&one, 0.0, 1.0);
    double velocity = 0.0;
    one.shifts[6] = -start;
    for (int k = 0; k < steps; k++) {
        velocity += step * (-gravity - omega * omega * one.shifts[6]);
        const double predicted = one.shifts[6] + step * velocity;
        one.shifts[6] = predicted;
        for (int i = 0; i < iterations; i++) shv_bars_sweep(&one.bars, stiffness, one.anchors, one.shifts);
        velocity += (one.shifts[6] - predicted) / step;
    }
    return -one.shifts[6];
}

/* e* = g dt² r/(1 − r) with r = (1 − k)^n; what started differently decays by √r a step. */
static void a_hanging_bar_stretches_by_the_closed_form(void **state)
{
    (void)state;
    const double g = 9.81, dt = 1e-3, unit = g * dt * dt;
    check_near(hang(0.9, 3, 0.0, g, dt, 200, 0.0), unit * 1e-3 / 0.999, 1e-9 * unit);
    check_near(hang(0.5, 4, 0.0, g, dt, 200, 0.0), unit / 15.0, 1e-9 * unit);
    check_near(hang(0.1, 1, 0.0, g, dt, 2000, 0.0), 9.0 * unit, 1e-9 * unit);
}

/* ω dt < √(3 + 1/r): the factor of growth beyond is about 1 + the excess, hence the steps. */
static void a_bar_is_stable_up_to_the_closed_form(void **state)
{
    (void)state;
    const double start = 1e-9;
    const struct {
        double stiffness;
        int iterations;
    } cases[] = {{0.5, 1}, {0.5, 4}, {0.1, 1}, {0.9, 3}};
    for (int i = 0; i < 4; i++) {
        double r = 1.0;
        for (int k = 0; k < cases[i].iterations; k++) r *= 1.0 - cases[i].stiffness;
        const double limit = sqrt(3.0 + 1.0 / r);
        assert_true(fabs(hang(cases[i].stiffness, cases[i].iterations, 0.99 * limit, 0.0, 1.0, 400, start)) <
                    0.1 * start);
        assert_true(fabs(hang(cases[i].stiffness, cases[i].iterations, 1.01 * limit, 0.0, 1.0, 400, start)) >
                    10.0 * start);
    }
}

static void ends_share_a_projection_by_their_inverse_masses(void **state)
{
    (void)state;
    OneBar one;
    one_bar_make(&one, 1e-6, 1.0);
    one.shifts[6] = -0.5;
    shv_bars_sweep(&one.bars, 1.0, one.anchors, one.shifts);
    const double heavy = fabs(one.shifts[2]), light = fabs(one.shifts[6] + 0.5);
    assert_true(heavy > 0.0 && heavy <= 0.5e-6);
    check_near(heavy * 1e6, light, 1e-15);
    check_near(heavy + light, 0.5, 1e-15);
}

static void degenerate_bars_are_skipped(void **state)
{
    (void)state;
    OneBar one;
    one_bar_make(&one, 0.0, 0.0); /* both pinned */
    one.shifts[6] = -0.5;
    shv_bars_sweep(&one.bars, 1.0, one.anchors, one.shifts);
    assert_true(one.shifts[2] == 0.0 && one.shifts[6] == -0.5);
    one_bar_make(&one, 1.0, 1.0); /* ends together: no direction */
    one.shifts[6] = 1.0;
    shv_bars_sweep(&one.bars, 1.0, one.anchors, one.shifts);
    assert_true(one.shifts[2] == 0.0 && one.shifts[6] == 1.0);
    one_bar_make(&one, 1.0, 1.0); /* no rest length */
    for (int i = 0; i < SHV_LANES; i++) one.rest[i] = 0.0;
    shv_bars_sweep(&one.bars, 1.0, one.anchors, one.shifts);
    assert_true(one.shifts[2] == 0.0 && one.shifts[6] == 0.0);
    assert_true(shv_bars_largest_strain(&one.bars, one.anchors, one.shifts) == 0.0);
}

static void pinned_nodes_stay_and_a_pinned_tet_does_nothing(void **state)
{
    (void)state;
    Mesh mesh;
    mesh_make(&mesh, SHV_BARS_ELEMENT, 0.5, false, 1);
    const int64_t nodes = mesh.world.state.node_count;
    const size_t size = 4 * (size_t)nodes * sizeof(double);
    double *kept = malloc(size);
    memcpy(kept, mesh.shifts, size);
    mesh.anchors[3] = 0.0;
    shv_bars_sweep(&mesh.bars, 1.0, mesh.anchors, mesh.shifts);
    assert_memory_equal(mesh.shifts, kept, 3 * sizeof(double));
    assert_memory_not_equal(mesh.shifts + 4, kept + 4, 3 * sizeof(double));
    memcpy(mesh.shifts, kept, size);
    for (int64_t i = 0; i < nodes; i++) mesh.anchors[4 * i + 3] = 0.0;
    shv_bars_sweep(&mesh.bars, 1.0, mesh.anchors, mesh.shifts);
    assert_memory_equal(mesh.shifts, kept, size);
    free(kept);
    mesh_end(&mesh);
}

/* ---- upkeep ---- */

/* A copy of one node takes some of its corners. */
static void duplicate(ShvState *state, int32_t node, uint64_t seed)
{
    ShvError error = {0};
    check_ok(shv_state_reserve(state, (int64_t)state->node_count + 1, &error), error);
    const int32_t copy = state->node_count++;
    memcpy(state->reference + 3 * (int64_t)copy, state->reference + 3 * (int64_t)node, 3 * sizeof(double));
    state->origin[copy] = state->origin[node];
    state->mass[copy] = state->mass[node];
    for (int32_t e = 0; e < state->element_count; e++)
        for (int c = 0; c < 4; c++)
            if (shv_state_node(state, e, c) == node && shv_random_uniform(seed, (uint64_t)e) < 0.5)
                state->connectivity[shv_corner_slot(e, c)] = copy;
}

static void duplication_is_followed(void **state)
{
    (void)state;
    ShvError error = {0};
    for (int form = 0; form < 2; form++) {
        Mesh mesh;
        mesh_make(&mesh, form ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, 0.18, form, 1);
        ShvState *now = &mesh.world.state;
        for (int round = 0; round < 40; round++) {
            for (int k = 0; k < 1 + round % 5; k++) {
                const double at = shv_random_uniform(9, (uint64_t)(10 * round + k));
                duplicate(now, (int32_t)(at * now->node_count), (uint64_t)(1000 * round + k));
            }
            check_ok(shv_bars_update(&mesh.bars, now, NULL, &error), error);
            check_items(&mesh, NULL);
            assert_true(mesh.bars.batch_end <= 4 * mesh.bars.batch_held);
        }
        quads_make(&mesh);
        shv_bars_sweep(&mesh.bars, 1.0, mesh.anchors, mesh.shifts);
        mesh_end(&mesh);
    }
}

/* Every facet a crack: each tet for itself. */
static void a_mesh_in_pieces_has_six_edges_a_tet(void **state)
{
    (void)state;
    ShvError error = {0};
    Mesh mesh;
    mesh_make(&mesh, SHV_BARS_EDGE, 0.2, true, 1);
    const int32_t tets = mesh.world.state.element_count;
    int32_t *group = malloc((size_t)tets * sizeof *group);
    for (int32_t e = 0; e < tets; e++) group[e] = e;
    world_separate(&mesh.world, group);
    assert_int_equal(mesh.world.state.node_count, 4 * tets);
    check_ok(shv_bars_update(&mesh.bars, &mesh.world.state, NULL, &error), error);
    assert_int_equal(mesh.bars.bar_count, 6 * (int64_t)tets);
    check_items(&mesh, NULL);
    free(group);
    mesh_end(&mesh);
}

static void only_flagged_fragments_have_bars(void **state)
{
    (void)state;
    ShvError error = {0};
    Mesh mesh;
    mesh_make(&mesh, SHV_BARS_EDGE, 0.2, true, 1);
    ShvState *now = &mesh.world.state;
    int32_t *group = malloc((size_t)now->element_count * sizeof *group);
    for (int32_t e = 0; e < now->element_count; e++) {
        group[e] = shv_state_position(now, shv_state_node(now, e, 0)).x > 0.0;
        now->element_fragment[e] = group[e];
    }
    world_separate(&mesh.world, group);
    for (int k = 0; k < 5; k++) {
        const uint8_t flags[2] = {(uint8_t)(k & 1), (uint8_t)(k >> 1 & 1)};
        check_ok(shv_bars_update(&mesh.bars, now, flags, &error), error);
        check_items(&mesh, flags);
    }
    free(group);
    mesh_end(&mesh);
}

static void running_out_of_memory_is_reported_and_leaks_nothing(void **state)
{
    (void)state;
    ShvError error = {0};
    for (int form = 0; form < 2; form++) {
        Mesh mesh;
        mesh_make(&mesh, form ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, 0.2, false, 1);
        shv_bars_release(&mesh.bars);
        ShvMemory *memory = mesh.world.memory;
        const size_t held = shv_memory_bytes(memory, SHV_PART_COUNT);
        ShvStatus status = SHV_NO_MEMORY;
        int64_t allowed = 0;
        for (; status != SHV_OK; allowed++) {
            shv_memory_fail_after(memory, allowed);
            status = shv_bars_create(&mesh.bars, &mesh.world.model, mesh.bars.form, &error);
            if (status == SHV_OK) status = shv_bars_update(&mesh.bars, &mesh.world.state, NULL, &error);
            if (status == SHV_OK) break;
            assert_int_equal(status, SHV_NO_MEMORY);
            shv_bars_release(&mesh.bars);
            assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), held);
        }
        assert_true(allowed > 8);
        shv_memory_fail_after(memory, -1);
        mesh_end(&mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_edge_or_tet_is_there_once),
        cmocka_unit_test(a_sweep_is_gauss_seidel_and_keeps_momentum),
        cmocka_unit_test(reactions_are_what_holds_pinned_nodes),
        cmocka_unit_test(sweeps_have_the_same_bits_for_any_number_of_threads),
        cmocka_unit_test(translation_is_left_alone_to_the_last_bit),
        cmocka_unit_test(largest_strain_is_that_of_a_stretch),
        cmocka_unit_test(a_hanging_bar_stretches_by_the_closed_form),
        cmocka_unit_test(a_bar_is_stable_up_to_the_closed_form),
        cmocka_unit_test(ends_share_a_projection_by_their_inverse_masses),
        cmocka_unit_test(degenerate_bars_are_skipped),
        cmocka_unit_test(pinned_nodes_stay_and_a_pinned_tet_does_nothing),
        cmocka_unit_test(duplication_is_followed),
        cmocka_unit_test(a_mesh_in_pieces_has_six_edges_a_tet),
        cmocka_unit_test(only_flagged_fragments_have_bars),
        cmocka_unit_test(running_out_of_memory_is_reported_and_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
