#include "solid/smoothing.h"

#include "solid/domain.h"
#include "solid/kernel.h"

/* ---- stress ---- */

/* Eight matrices in rows, each but for its last number. */
static inline void write_matrices(ShvWide m[3][3], double *rows)
{
    for (int half = 0; half < 2; half++) {
        ShvWide quad[4];
        for (int c = 0; c < 4; c++) quad[c] = m[(4 * half + c) / 3][(4 * half + c) % 3];
        shv_wide_store_quads(rows + 4 * half, shv_rows, quad);
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
    shv_batch_note_strain(solid, batch, h);
    for (int c = 0; c < 9; c++) h[c / 3][c % 3] = shv_wide_mul(volume, h[c / 3][c % 3]);
    write_matrices(h, smoothing->gradient + 8 * first);
    shv_wide_store(smoothing->gradient_zz + first, h[2][2]);
}

/* Mean over the tets of each domain. What a domain has less than the widest adds exactly nothing. */
static void read_gradients(const ShvSmoothedEdges *smoothing, int32_t group, ShvWide h[3][3])
{
    const int32_t *members = smoothing->members + smoothing->group_member[group];
    const int32_t *stop = members + (int64_t)SHV_LANES * smoothing->group_width[group];
    ShvWide sum[SHV_LANES];
    double last[SHV_LANES] = {0.0};
    for (int lane = 0; lane < SHV_LANES; lane++) sum[lane] = shv_wide_zero();
    for (; members < stop; members += SHV_LANES)
        for (int lane = 0; lane < SHV_LANES; lane++) {
            const int64_t tet = members[lane];
            sum[lane] = shv_wide_add(sum[lane], shv_wide_load(smoothing->gradient + 8 * tet));
            last[lane] += smoothing->gradient_zz[tet];
        }
    shv_wide_turn_matrices(sum, last, h);
    const ShvWide scale = shv_wide_load(smoothing->inverse_volume + SHV_LANES * (int64_t)group);
    for (int c = 0; c < 9; c++) h[c / 3][c % 3] = shv_wide_mul(scale, h[c / 3][c % 3]);
}

static void read_offsets(const ShvSmoothedEdges *smoothing, int32_t group, ShvWide offset[3][3])
{
    for (int c = 0; c < 9; c++)
        offset[c / 3][c % 3] = shv_wide_load(smoothing->offset + (9 * (int64_t)group + c) * SHV_LANES);
}

static void find_elasticity(const ShvSolid *solid, int32_t group, ShvElasticity *elasticity)
{
    const int16_t same = solid->smoothing.group_material[group];
    if (same >= 0) {
        shv_material_elasticity(&solid->model->materials[same], elasticity);
        return;
    }
    const ShvMaterial *materials[SHV_LANES];
    for (int lane = 0; lane < SHV_LANES; lane++)
        materials[lane] = &solid->model->materials[solid->smoothing.material[SHV_LANES * (int64_t)group + lane]];
    shv_mixed_elasticity(materials, elasticity);
}

/* (I + H) (I + G) − I */
static void apply_offset(ShvWide offset[3][3], ShvWide h[3][3])
{
    for (int i = 0; i < 3; i++) {
        const ShvWide row[3] = {h[i][0], h[i][1], h[i][2]};
        for (int j = 0; j < 3; j++) {
            h[i][j] = shv_wide_add(row[j], offset[i][j]);
            for (int k = 0; k < 3; k++) h[i][j] = shv_wide_fma(row[k], offset[k][j], h[i][j]);
        }
    }
}

/* P (I + G)ᵀ: the slope over F of what depends on F (I + G). */
static void pull_back_stress(ShvWide offset[3][3], ShvWide p[3][3])
{
    for (int i = 0; i < 3; i++) {
        const ShvWide row[3] = {p[i][0], p[i][1], p[i][2]};
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) p[i][j] = shv_wide_fma(row[k], offset[j][k], p[i][j]);
    }
}

static void find_stress(const ShvSolid *solid, int32_t group, bool with_energy)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int64_t first = SHV_LANES * (int64_t)group;
    const bool has_offset = smoothing->group_offset[group];
    ShvElasticity elasticity;
    ShvWide h[3][3], p[3][3], offset[3][3];
    find_elasticity(solid, group, &elasticity);
    read_gradients(smoothing, group, h);
    if (has_offset) {
        read_offsets(smoothing, group, offset);
        apply_offset(offset, h);
    }
    shv_batch_piola(&elasticity, h, p);
    if (has_offset) pull_back_stress(offset, p);
    write_matrices(p, smoothing->stress + 8 * first);
    shv_wide_store(smoothing->stress_zz + first, p[2][2]);
    if (with_energy) shv_wide_store(smoothing->energy + first, shv_wide_energy_density(&elasticity, h));
}

/* ---- of all that is active ---- */

static void find_mean(const ShvSmoothedEdges *smoothing, int32_t block)
{
    shv_block_find_mean(smoothing, block, shv_block_share(smoothing, block));
}

static uint8_t least_active(bool with_energy)
{
    return with_energy ? SHV_ACTIVE_BATCH : SHV_ACTIVE_AWAKE;
}

static void find_window(const ShvSolid *solid, const ShvState *state, int32_t window, bool with_energy)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t end = (window + 1) * smoothing->window_blocks, count = smoothing->block_count;
    const uint8_t least = least_active(with_energy);
    for (int32_t block = window * smoothing->window_blocks; block < end && block < count; block++)
        if (smoothing->block_active[block] >= least) find_gradient(solid, state, block);
    for (int32_t group = smoothing->window_group[window]; group < smoothing->window_group[window + 1]; group++)
        if (smoothing->group_active[group] >= least) find_stress(solid, group, with_energy);
    for (int32_t i = smoothing->window_ready[window]; i < smoothing->window_ready[window + 1]; i++) {
        const int32_t block = smoothing->ready_blocks[i];
        if (solid->batch_active[smoothing->blocks[block]] && !smoothing->block_late[block]) find_mean(smoothing, block);
    }
}

static void smooth(const ShvSolid *solid, const ShvState *state, bool with_energy)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t regions = smoothing->region_count;
    const int64_t windows = smoothing->window_count;
    const uint8_t least = least_active(with_energy);
#pragma omp parallel num_threads(solid->model->threads) if (solid->model->threads > 1)
    {
#pragma omp for schedule(static)
        for (int32_t region = 0; region < regions; region++)
            for (int64_t window = windows * region / regions; window < windows * (region + 1) / regions; window++)
                find_window(solid, state, (int32_t)window, with_energy);
#pragma omp for schedule(static)
        for (int32_t group = smoothing->window_group[windows]; group < smoothing->group_count; group++)
            if (smoothing->group_active[group] >= least) find_stress(solid, group, with_energy);
#pragma omp for schedule(static)
        for (int32_t i = 0; i < smoothing->late_count; i++)
            if (solid->batch_active[smoothing->blocks[smoothing->late_blocks[i]]])
                find_mean(smoothing, smoothing->late_blocks[i]);
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

/* ---- of a few ---- */

/* Groups that were found lately: neighbours share them. */
typedef struct Recent {
    int32_t groups[64];
} Recent;

static Recent none_recent(void)
{
    Recent recent;
    for (int i = 0; i < 64; i++) recent.groups[i] = -1;
    return recent;
}

static void find_domain(const ShvSolid *solid, int32_t domain, Recent *recent)
{
    const int32_t group = domain / SHV_LANES;
    if (recent->groups[group % 64] == group) return;
    recent->groups[group % 64] = group;
    find_stress(solid, group, true);
}

void shv_smoothing_find_batch(const ShvSolid *solid, const ShvState *state, int32_t batch)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t block = shv_batch_block(solid, batch);
    if (block < 0) return;
    const int32_t *domains = smoothing->edge_domain + SHV_TET_EDGES * SHV_LANES * (int64_t)block;
    Recent recent = none_recent();
    for (int edge = 0; edge < SHV_TET_EDGES * SHV_LANES; edge++) {
        const int32_t count = shv_domain_edge_count(smoothing, domains[edge]);
        for (int32_t i = 0; i < count; i++)
            find_gradient(solid, state, *shv_domain_member(smoothing, domains[edge], i) / SHV_LANES);
    }
    for (int edge = 0; edge < SHV_TET_EDGES * SHV_LANES; edge++) find_domain(solid, domains[edge], &recent);
    shv_block_find_mean(smoothing, block, shv_wide_set1(1.0 / SHV_TET_EDGES));
}

void shv_smoothing_find_body(const ShvSolid *solid, const ShvState *state, const int32_t *elements, int32_t count)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    Recent recent = none_recent();
    int32_t last = -1;
    if (smoothing->block_count == 0) return;
    for (int32_t k = 0; k < count; k++) {
        const int32_t block = shv_batch_block(solid, elements[k] / SHV_LANES);
        if (block >= 0 && block != last) find_gradient(solid, state, block);
        last = block;
    }
    for (int32_t k = 0; k < count; k++) {
        const int32_t block = shv_batch_block(solid, elements[k] / SHV_LANES);
        if (block < 0) continue;
        const int64_t edge = SHV_TET_EDGES * (SHV_LANES * (int64_t)block + elements[k] % SHV_LANES);
        for (int i = 0; i < SHV_TET_EDGES; i++) find_domain(solid, smoothing->edge_domain[edge + i], &recent);
    }
}

void shv_smoothing_find_split(const ShvSolid *solid)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    Recent recent = none_recent();
    for (int32_t i = 0; i < smoothing->split_count; i++) find_domain(solid, smoothing->split[i], &recent);
    for (int32_t i = 0; i < smoothing->split_count; i++) {
        const int32_t domain = smoothing->split[i], count = shv_domain_edge_count(smoothing, domain);
        for (int32_t k = 0; k < count; k++) find_mean(smoothing, *shv_domain_member(smoothing, domain, k) / SHV_LANES);
    }
}
