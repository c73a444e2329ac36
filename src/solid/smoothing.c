#include "solid/smoothing.h"

#include <stdlib.h>
#include <string.h>

#include "solid/domain.h"
#include "solid/kernel.h"

/* ---- stress ---- */

static void write_matrices(ShvWide m[3][3], double *rows, const int32_t index[SHV_LANES])
{
    for (int half = 0; half < 2; half++) {
        ShvWide quad[4];
        for (int c = 0; c < 4; c++) quad[c] = m[(4 * half + c) / 3][(4 * half + c) % 3];
        shv_wide_store_quads(rows + 4 * half, index, quad);
    }
}

/* Volume × displacement gradient of each lane. */
static void find_gradient(const ShvSolid *solid, const ShvState *state, int32_t block)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t batch = smoothing->blocks[block];
    const int64_t first = SHV_LANES * (int64_t)block;
    const ShvWide volume = shv_wide_load(solid->volumes + (int64_t)batch * SHV_LANES);
    ShvWide h[3][3];
    shv_batch_displacement_gradient(solid, state, batch, h);
    for (int c = 0; c < 9; c++) h[c / 3][c % 3] = shv_wide_mul(volume, h[c / 3][c % 3]);
    write_matrices(h, smoothing->gradient + 8 * first, shv_rows);
    shv_wide_store(smoothing->gradient_zz + first, h[2][2]);
}

/* Eight domains side by side. */
typedef struct Domains {
    int32_t index[SHV_LANES];
    bool has_offset; /* any of them */
    ShvWide gradient[3][3];
    ShvWide offset[3][3];
    ShvElasticity elasticity;
} Domains;

static void read_gradients(const ShvSmoothedEdges *smoothing, Domains *domains)
{
    _Alignas(64) double rows[8 * SHV_LANES], last[SHV_LANES], inverse[SHV_LANES];
    for (int lane = 0; lane < SHV_LANES; lane++) {
        const int32_t domain = domains->index[lane], count = smoothing->member_count[domain];
        const int32_t *members = smoothing->members + smoothing->first_member[domain];
        ShvWide sum = shv_wide_zero();
        last[lane] = 0.0;
        for (int32_t i = 0; i < count; i++) {
            const int64_t tet = members[i] / SHV_TET_EDGES;
            sum = shv_wide_add(sum, shv_wide_load(smoothing->gradient + 8 * tet));
            last[lane] += smoothing->gradient_zz[tet];
        }
        shv_wide_store(rows + 8 * lane, sum);
        inverse[lane] = smoothing->inverse_volume[domain];
    }
    shv_wide_read_matrices(rows, last, domains->gradient);
    const ShvWide scale = shv_wide_load(inverse);
    for (int c = 0; c < 9; c++) domains->gradient[c / 3][c % 3] = shv_wide_mul(scale, domains->gradient[c / 3][c % 3]);
}

static void read_offsets(const ShvSmoothedEdges *smoothing, Domains *domains)
{
    _Alignas(64) double rows[9][SHV_LANES];
    domains->has_offset = false;
    for (int lane = 0; lane < SHV_LANES; lane++)
        domains->has_offset = domains->has_offset || smoothing->has_offset[domains->index[lane]];
    if (!domains->has_offset) return;
    for (int lane = 0; lane < SHV_LANES; lane++)
        for (int c = 0; c < 9; c++) rows[c][lane] = smoothing->offset[9 * (int64_t)domains->index[lane] + c];
    for (int c = 0; c < 9; c++) domains->offset[c / 3][c % 3] = shv_wide_load(rows[c]);
}

static void read_elasticity(const ShvSolid *solid, Domains *domains)
{
    const ShvMaterial *materials[SHV_LANES];
    bool same = true;
    for (int lane = 0; lane < SHV_LANES; lane++) {
        materials[lane] = &solid->model->materials[solid->smoothing.material[domains->index[lane]]];
        same = same && materials[lane] == materials[0];
    }
    domains->elasticity = same ? shv_material_elasticity(materials[0]) : shv_mixed_elasticity(materials);
}

/* (I + H) (I + G) − I */
static void apply_offset(const Domains *domains, ShvWide h[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            ShvWide sum = shv_wide_add(domains->gradient[i][j], domains->offset[i][j]);
            for (int k = 0; k < 3; k++) sum = shv_wide_fma(domains->gradient[i][k], domains->offset[k][j], sum);
            h[i][j] = sum;
        }
}

/* P (I + G)ᵀ: the slope over F of what depends on F (I + G). */
static void pull_back_stress(const Domains *domains, ShvWide p[3][3])
{
    for (int i = 0; i < 3; i++) {
        const ShvWide row[3] = {p[i][0], p[i][1], p[i][2]};
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) p[i][j] = shv_wide_fma(row[k], domains->offset[j][k], p[i][j]);
    }
}

static void write_stress(const ShvSmoothedEdges *smoothing, const Domains *domains, ShvWide p[3][3])
{
    _Alignas(64) double last[SHV_LANES];
    int32_t index[SHV_LANES];
    for (int lane = 0; lane < SHV_LANES; lane++) index[lane] = 2 * domains->index[lane];
    write_matrices(p, smoothing->stress, index);
    shv_wide_store(last, p[2][2]);
    for (int lane = 0; lane < SHV_LANES; lane++) smoothing->stress_zz[domains->index[lane]] = last[lane];
}

static void write_energy(const ShvSmoothedEdges *smoothing, const Domains *domains, ShvWide h[3][3])
{
    _Alignas(64) double density[SHV_LANES];
    shv_wide_store(density, shv_wide_energy_density(&domains->elasticity, h));
    for (int lane = 0; lane < SHV_LANES; lane++) smoothing->energy[domains->index[lane]] = density[lane];
}

static void find_stress(const ShvSolid *solid, Domains *domains, bool with_energy)
{
    ShvWide h[3][3], p[3][3];
    read_gradients(&solid->smoothing, domains);
    read_offsets(&solid->smoothing, domains);
    read_elasticity(solid, domains);
    memcpy(h, domains->gradient, sizeof h);
    if (domains->has_offset) apply_offset(domains, h);
    shv_batch_piola(&domains->elasticity, h, p);
    if (domains->has_offset) pull_back_stress(domains, p);
    write_stress(&solid->smoothing, domains, p);
    if (with_energy) write_energy(&solid->smoothing, domains, h);
}

/* Those from `first` on; behind the last it is repeated. */
static Domains domains_from(const ShvSmoothedEdges *smoothing, int32_t first)
{
    Domains domains;
    for (int lane = 0; lane < SHV_LANES; lane++)
        domains.index[lane] = first + lane < smoothing->domain_count ? first + lane : smoothing->domain_count - 1;
    return domains;
}

static bool any_active(const ShvSmoothedEdges *smoothing, const Domains *domains)
{
    for (int i = 0; i < SHV_LANES; i++)
        if (smoothing->active[domains->index[i]]) return true;
    return false;
}

static void smooth(const ShvSolid *solid, const ShvState *state, bool with_energy)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t blocks = smoothing->block_count, domains = smoothing->domain_count;
#pragma omp parallel num_threads(solid->model->threads) if (solid->model->threads > 1)
    {
#pragma omp for schedule(static)
        for (int32_t block = 0; block < blocks; block++)
            if (smoothing->block_active[block]) find_gradient(solid, state, block);
#pragma omp for schedule(static)
        for (int32_t first = 0; first < domains; first += SHV_LANES) {
            Domains some = domains_from(smoothing, first);
            if (any_active(smoothing, &some)) find_stress(solid, &some, with_energy);
        }
    }
}

void shv_solid_smooth(const ShvSolid *solid, const ShvState *state)
{
    if (solid->smoothing.block_count > 0) smooth(solid, state, false);
}

void shv_smoothing_find_energy(const ShvSolid *solid, const ShvState *state)
{
    if (solid->smoothing.block_count > 0) smooth(solid, state, true);
}

void shv_smoothing_find_batch(const ShvSolid *solid, const ShvState *state, int32_t batch)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t block = shv_batch_block(solid, batch);
    if (block < 0) return;
    const int32_t *edges = smoothing->edge_domain + SHV_TET_EDGES * SHV_LANES * (int64_t)block;
    for (int first = 0; first < SHV_TET_EDGES * SHV_LANES; first += SHV_LANES) {
        Domains some;
        for (int lane = 0; lane < SHV_LANES; lane++) {
            const int32_t domain = some.index[lane] = edges[first + lane];
            const int32_t *members = smoothing->members + smoothing->first_member[domain];
            for (int32_t i = 0; i < smoothing->member_count[domain]; i++)
                find_gradient(solid, state, members[i] / (SHV_TET_EDGES * SHV_LANES));
        }
        find_stress(solid, &some, true);
    }
}

/* Domains that are collected until eight of them are found together. */
typedef struct Collected {
    Domains domains;
    int count;
} Collected;

static void find_collected(const ShvSolid *solid, Collected *collected)
{
    for (int lane = collected->count; lane < SHV_LANES; lane++)
        collected->domains.index[lane] = collected->domains.index[0];
    if (collected->count > 0) find_stress(solid, &collected->domains, true);
    collected->count = 0;
}

/* Each domain with the first of its edges. */
static void collect(const ShvSolid *solid, Collected *collected, int32_t lane)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    for (int32_t edge = SHV_TET_EDGES * lane; edge < SHV_TET_EDGES * (lane + 1); edge++) {
        const int32_t domain = smoothing->edge_domain[edge];
        if (smoothing->members[smoothing->first_member[domain]] != edge) continue;
        collected->domains.index[collected->count++] = domain;
        if (collected->count == SHV_LANES) find_collected(solid, collected);
    }
}

void shv_smoothing_find_body(const ShvSolid *solid, const ShvState *state, const int32_t *elements, int32_t count)
{
    int32_t last = -1;
    Collected collected = {.count = 0};
    if (solid->smoothing.block_count == 0) return;
    for (int32_t k = 0; k < count; k++) {
        const int32_t block = shv_batch_block(solid, elements[k] / SHV_LANES);
        if (block >= 0 && block != last) find_gradient(solid, state, block);
        last = block;
    }
    for (int32_t k = 0; k < count; k++) {
        const int32_t block = shv_batch_block(solid, elements[k] / SHV_LANES);
        if (block >= 0) collect(solid, &collected, SHV_LANES * block + elements[k] % SHV_LANES);
    }
    find_collected(solid, &collected);
}

void shv_smoothing_find_split(const ShvSolid *solid)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    for (int32_t first = 0; first < smoothing->split_count; first += SHV_LANES) {
        Domains some;
        for (int lane = 0; lane < SHV_LANES; lane++) {
            const int32_t last = smoothing->split_count - 1;
            some.index[lane] = smoothing->split[first + lane < last ? first + lane : last];
        }
        find_stress(solid, &some, false);
    }
}
