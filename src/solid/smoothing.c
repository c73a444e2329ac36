#include "solid/smoothing.h"

#include <stdlib.h>
#include <string.h>

#include "solid/domain.h"
#include "solid/kernel.h"

/* ---- stress ---- */

/* Volume × displacement gradient of each lane. */
static void find_gradient(const ShvSolid *solid, const ShvState *state, int32_t block)
{
    _Alignas(64) double rows[9][SHV_LANES];
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t batch = smoothing->blocks[block];
    const ShvWide volume = shv_wide_load(solid->volumes + (int64_t)batch * SHV_LANES);
    ShvWide h[3][3];
    shv_batch_displacement_gradient(solid, state, batch, h);
    for (int c = 0; c < 9; c++) shv_wide_store(rows[c], shv_wide_mul(volume, h[c / 3][c % 3]));
    double *into = smoothing->gradient + SHV_SMOOTHED_STRIDE * SHV_LANES * (int64_t)block;
    for (int lane = 0; lane < SHV_LANES; lane++)
        for (int c = 0; c < 9; c++) into[SHV_SMOOTHED_STRIDE * lane + c] = rows[c][lane];
}

/* Eight domains side by side. */
typedef struct Domains {
    int32_t index[SHV_LANES];
    bool started; /* any of them */
    ShvWide gradient[3][3];
    ShvWide start[3][3];
    ShvElasticity elasticity;
} Domains;

static void read_gradients(const ShvSmoothedEdges *smoothing, Domains *domains)
{
    _Alignas(64) double rows[SHV_SMOOTHED_STRIDE][SHV_LANES];
    for (int lane = 0; lane < SHV_LANES; lane++) {
        double mean[SHV_SMOOTHED_STRIDE];
        shv_domain_gradient(smoothing, domains->index[lane], mean);
        for (int c = 0; c < 9; c++) rows[c][lane] = mean[c];
    }
    for (int c = 0; c < 9; c++) domains->gradient[c / 3][c % 3] = shv_wide_load(rows[c]);
}

static void read_starts(const ShvSmoothedEdges *smoothing, Domains *domains)
{
    _Alignas(64) double rows[9][SHV_LANES];
    domains->started = false;
    for (int lane = 0; lane < SHV_LANES; lane++)
        domains->started = domains->started || smoothing->started[domains->index[lane]];
    if (!domains->started) return;
    for (int lane = 0; lane < SHV_LANES; lane++)
        for (int c = 0; c < 9; c++) rows[c][lane] = smoothing->start[9 * (int64_t)domains->index[lane] + c];
    for (int c = 0; c < 9; c++) domains->start[c / 3][c % 3] = shv_wide_load(rows[c]);
}

static void read_elasticity(const ShvSolid *solid, Domains *domains)
{
    _Alignas(64) double lambda[SHV_LANES], mu[SHV_LANES], green[SHV_LANES];
    int greens = 0;
    for (int lane = 0; lane < SHV_LANES; lane++) {
        const ShvMaterial *material = &solid->model->materials[solid->smoothing.material[domains->index[lane]]];
        lambda[lane] = material->lambda;
        mu[lane] = material->mu;
        green[lane] = material->kinematics == SHV_GREEN_STRAIN ? 1.0 : 0.0;
        greens += material->kinematics == SHV_GREEN_STRAIN;
    }
    const ShvBatchKind kind = greens == SHV_LANES ? SHV_BATCH_GREEN
                              : greens == 0       ? SHV_BATCH_COROTATIONAL
                                                  : SHV_BATCH_BOTH;
    domains->elasticity = (ShvElasticity){kind, shv_wide_load(lambda), shv_wide_load(mu),
                                          shv_wide_less(shv_wide_zero(), shv_wide_load(green))};
}

/* (I + H) (I + G) − I */
static void go_on_from_start(const Domains *domains, ShvWide h[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            ShvWide sum = shv_wide_add(domains->gradient[i][j], domains->start[i][j]);
            for (int k = 0; k < 3; k++) sum = shv_wide_fma(domains->gradient[i][k], domains->start[k][j], sum);
            h[i][j] = sum;
        }
}

/* P (I + G)ᵀ: the slope over F of what depends on F (I + G). */
static void turn_back(const Domains *domains, ShvWide p[3][3])
{
    for (int i = 0; i < 3; i++) {
        const ShvWide row[3] = {p[i][0], p[i][1], p[i][2]};
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) p[i][j] = shv_wide_fma(row[k], domains->start[j][k], p[i][j]);
    }
}

static void find_stress(const ShvSolid *solid, Domains *domains, bool with_energy)
{
    _Alignas(64) double rows[SHV_SMOOTHED_ENERGY + 1][SHV_LANES];
    ShvWide h[3][3], p[3][3];
    read_gradients(&solid->smoothing, domains);
    read_starts(&solid->smoothing, domains);
    read_elasticity(solid, domains);
    memcpy(h, domains->gradient, sizeof h);
    if (domains->started) go_on_from_start(domains, h);
    shv_batch_piola(&domains->elasticity, h, p);
    if (domains->started) turn_back(domains, p);
    for (int c = 0; c < 9; c++) shv_wide_store(rows[c], p[c / 3][c % 3]);
    if (with_energy) shv_wide_store(rows[SHV_SMOOTHED_ENERGY], shv_wide_energy_density(&domains->elasticity, h));
    const int count = with_energy ? SHV_SMOOTHED_ENERGY + 1 : SHV_SMOOTHED_ENERGY;
    for (int lane = 0; lane < SHV_LANES; lane++) {
        double *into = solid->smoothing.stress + SHV_SMOOTHED_STRIDE * (int64_t)domains->index[lane];
        for (int c = 0; c < count; c++) into[c] = rows[c][lane];
    }
}

/* Those from `first` on; behind the last it is repeated. */
static Domains domains_from(const ShvSmoothedEdges *smoothing, int32_t first)
{
    Domains domains;
    for (int lane = 0; lane < SHV_LANES; lane++)
        domains.index[lane] = first + lane < smoothing->domain_count ? first + lane : smoothing->domain_count - 1;
    return domains;
}

/* Tets of one domain hang together: they are awake or not. */
static bool any_active(const ShvSolid *solid, const Domains *domains)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    for (int i = 0; i < SHV_LANES; i++) {
        const int32_t edge = smoothing->members[smoothing->first_member[domains->index[i]]];
        if (solid->batch_active[smoothing->blocks[edge / (SHV_TET_EDGES * SHV_LANES)]]) return true;
    }
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
            if (solid->batch_active[smoothing->blocks[block]]) find_gradient(solid, state, block);
#pragma omp for schedule(static)
        for (int32_t first = 0; first < domains; first += SHV_LANES) {
            Domains some = domains_from(smoothing, first);
            if (any_active(solid, &some)) find_stress(solid, &some, with_energy);
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
