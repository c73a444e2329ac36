/* One batch of eight elements, written once for all processors: displacement gradient, stress response, nodal
   forces.

   Everything starts from the displacement gradient H = Σ (u_b − u_0) ⊗ ∇N_b and never from D_s D_m⁻¹ − I, so that a
   body at rest has exactly no strain, and a rigid shift changes no bit. */
#ifndef SHV_SOLID_KERNEL_H
#define SHV_SOLID_KERNEL_H

#include "base/simd.h"
#include "solid/polar.h"
#include "solid/solid.h"

_Static_assert((int)SHV_LANES == (int)SHV_WIDE_LANES, "a batch fills one register");

/* Which responses occur in a batch. */
typedef enum ShvBatchKind { SHV_BATCH_GREEN, SHV_BATCH_COROTATIONAL, SHV_BATCH_BOTH } ShvBatchKind;

typedef struct ShvElasticity {
    ShvBatchKind kind;
    ShvWide lambda, mu;
    ShvWideMask green; /* only set for SHV_BATCH_BOTH */
} ShvElasticity;

/* Set where it is: as a value it is copied by registers wider than its first member, which the processor has to wait for. */
static inline void shv_material_elasticity(const ShvMaterial *material, ShvElasticity *elasticity)
{
    elasticity->kind = material->kinematics == SHV_GREEN_STRAIN ? SHV_BATCH_GREEN : SHV_BATCH_COROTATIONAL;
    elasticity->lambda = shv_wide_set1(material->lambda);
    elasticity->mu = shv_wide_set1(material->mu);
    elasticity->green = shv_wide_less(shv_wide_zero(), shv_wide_zero());
}

/* A material for every lane. */
static inline void shv_mixed_elasticity(const ShvMaterial *const materials[SHV_LANES], ShvElasticity *elasticity)
{
    _Alignas(64) double lambda[SHV_LANES], mu[SHV_LANES], green[SHV_LANES];
    int greens = 0;
    for (int lane = 0; lane < SHV_LANES; lane++) {
        const bool is_green = materials[lane]->kinematics == SHV_GREEN_STRAIN;
        lambda[lane] = materials[lane]->lambda;
        mu[lane] = materials[lane]->mu;
        green[lane] = is_green ? 1.0 : 0.0;
        greens += is_green;
    }
    elasticity->kind = greens == SHV_LANES ? SHV_BATCH_GREEN : greens == 0 ? SHV_BATCH_COROTATIONAL : SHV_BATCH_BOTH;
    elasticity->lambda = shv_wide_load(lambda);
    elasticity->mu = shv_wide_load(mu);
    elasticity->green = shv_wide_less(shv_wide_zero(), shv_wide_load(green));
}

static inline void shv_batch_mixed_elasticity(const ShvModel *model, int32_t batch, ShvElasticity *elasticity)
{
    const ShvMaterial *materials[SHV_LANES];
    for (int lane = 0; lane < SHV_LANES; lane++) {
        const int32_t element = batch * SHV_LANES + lane, last = model->mesh.element_count - 1;
        materials[lane] = shv_model_material(model, element < last ? element : last);
    }
    shv_mixed_elasticity(materials, elasticity);
}

static inline void shv_batch_elasticity(const ShvSolid *solid, int32_t batch, ShvElasticity *elasticity)
{
    const int16_t index = solid->batch_material[batch];
    if (index < 0)
        shv_batch_mixed_elasticity(solid->model, batch, elasticity);
    else
        shv_material_elasticity(&solid->model->materials[index], elasticity);
}

/* Gradient of N_(b+1), component j. */
static inline ShvWide shv_batch_shape_gradient(const ShvSolid *solid, int32_t batch, int b, int j)
{
    return shv_wide_load(solid->gradients + ((int64_t)batch * 9 + 3 * b + j) * SHV_LANES);
}

static inline void shv_batch_displacement_gradient(const ShvSolid *solid, const ShvState *state, int32_t batch,
                                                   ShvWide h[3][3])
{
    int32_t index[4 * SHV_LANES];
    const int32_t *nodes = state->connectivity + (int64_t)batch * (4 * SHV_LANES);
    for (int i = 0; i < 4 * SHV_LANES; i++) index[i] = 3 * nodes[i];
    for (int i = 0; i < 3; i++) {
        const double *component = state->displacement + i;
        const ShvWide base = shv_wide_gather(component, index);
        ShvWide difference[3];
        for (int b = 0; b < 3; b++)
            difference[b] = shv_wide_sub(shv_wide_gather(component, index + (b + 1) * SHV_LANES), base);
        for (int j = 0; j < 3; j++) {
            h[i][j] = shv_wide_mul(difference[0], shv_batch_shape_gradient(solid, batch, 0, j));
            h[i][j] = shv_wide_fma(difference[1], shv_batch_shape_gradient(solid, batch, 1, j), h[i][j]);
            h[i][j] = shv_wide_fma(difference[2], shv_batch_shape_gradient(solid, batch, 2, j), h[i][j]);
        }
    }
}

/* 2 E = H + Hᵀ + Hᵀ H, all nine components filled. */
static inline void shv_wide_twice_green_strain(ShvWide h[3][3], ShvWide e[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            ShvWide sum = shv_wide_add(h[i][j], h[j][i]);
            for (int k = 0; k < 3; k++) sum = shv_wide_fma(h[k][i], h[k][j], sum);
            e[i][j] = e[j][i] = sum;
        }
}

/* Length of 2 E below which strain counts for nothing in the stable step. */
static const double shv_little_strain = 0.0125;

/* step.c: the strained step of a batch of which some tet is strained more than a little. The displacement gradient comes as plain lanes,
   component by component: what is linked must not depend on the width that this header was compiled for. */
double shv_batch_strained_step(const ShvSolid *solid, int32_t batch, const double *gradient);

static inline double shv_batch_gradient_step(const ShvSolid *solid, int32_t batch, ShvWide h[3][3])
{
    _Alignas(64) double gradient[9 * SHV_LANES];
    for (int c = 0; c < 9; c++) shv_wide_store(gradient + c * SHV_LANES, h[c / 3][c % 3]);
    return shv_batch_strained_step(solid, batch, gradient);
}

static inline void shv_batch_note_strain(const ShvSolid *solid, int32_t batch, ShvWide h[3][3])
{
    ShvWide e[3][3];
    shv_wide_twice_green_strain(h, e);
    const ShvWide little = shv_wide_set1(shv_little_strain * shv_little_strain);
    const bool strained = shv_wide_bits(shv_wide_less(little, shv_wide_squared_norm(e))) != 0;
    solid->batch_strained[batch] = strained ? shv_batch_gradient_step(solid, batch, h) : HUGE_VAL;
}

static inline ShvWide shv_wide_trace(ShvWide a[3][3])
{
    return shv_wide_add(shv_wide_add(a[0][0], a[1][1]), a[2][2]);
}

/* St. Venant-Kirchhoff: P = F S, S = λ tr E I + 2µ E. */
static inline void shv_green_stress(const ShvElasticity *elasticity, ShvWide h[3][3], ShvWide p[3][3])
{
    ShvWide s[3][3];
    shv_wide_twice_green_strain(h, s);
    const ShvWide pressure = shv_wide_mul(shv_wide_mul(shv_wide_set1(0.5), elasticity->lambda), shv_wide_trace(s));
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            s[i][j] = i == j ? shv_wide_fma(elasticity->mu, s[i][j], pressure) : shv_wide_mul(elasticity->mu, s[i][j]);
            s[j][i] = s[i][j];
        }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            p[i][j] = s[i][j];
            for (int k = 0; k < 3; k++) p[i][j] = shv_wide_fma(h[i][k], s[k][j], p[i][j]);
        }
}

/* Per volume: λ/2 (tr E)² + µ E:E. */
static inline ShvWide shv_green_energy(const ShvElasticity *elasticity, ShvWide h[3][3])
{
    ShvWide e[3][3];
    shv_wide_twice_green_strain(h, e);
    const ShvWide trace = shv_wide_trace(e);
    const ShvWide volumetric =
        shv_wide_mul(shv_wide_mul(shv_wide_set1(0.125), elasticity->lambda), shv_wide_mul(trace, trace));
    return shv_wide_fma(shv_wide_mul(shv_wide_set1(0.25), elasticity->mu), shv_wide_squared_norm(e), volumetric);
}

/* F − R = H − (R − I), and R : (F − R), the trace of the strain in the rotated frame; R − I in `turn`. */
static inline ShvWide shv_corotational_strain(ShvWide h[3][3], ShvWide turn[3][3], ShvWide strain[3][3])
{
    shv_wide_polar_turn(h, turn);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) strain[i][j] = shv_wide_sub(h[i][j], turn[i][j]);
    ShvWide trace = shv_wide_trace(strain);
    for (int k = 0; k < 9; k++) trace = shv_wide_fma(turn[k / 3][k % 3], strain[k / 3][k % 3], trace);
    return trace;
}

/* Linear in the rotated frame: P = R (λ tr ε I + 2µ ε), ε = Rᵀ F − I. It is the exact derivative of
   µ |F − R|² + λ/2 (tr ε)², because R is the nearest rotation. */
static inline void shv_corotational_stress(const ShvElasticity *elasticity, ShvWide h[3][3], ShvWide p[3][3])
{
    ShvWide turn[3][3], strain[3][3];
    const ShvWide pressure = shv_wide_mul(elasticity->lambda, shv_corotational_strain(h, turn, strain));
    const ShvWide twice_mu = shv_wide_add(elasticity->mu, elasticity->mu);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const ShvWide rotated = shv_wide_mul(pressure, turn[i][j]);
            p[i][j] = shv_wide_fma(twice_mu, strain[i][j], i == j ? shv_wide_add(rotated, pressure) : rotated);
        }
}

static inline ShvWide shv_corotational_energy(const ShvElasticity *elasticity, ShvWide h[3][3])
{
    ShvWide turn[3][3], strain[3][3];
    const ShvWide trace = shv_corotational_strain(h, turn, strain);
    const ShvWide volumetric =
        shv_wide_mul(shv_wide_mul(shv_wide_set1(0.5), elasticity->lambda), shv_wide_mul(trace, trace));
    return shv_wide_fma(elasticity->mu, shv_wide_squared_norm(strain), volumetric);
}

/* First Piola-Kirchhoff stress of every lane. */
static inline void shv_batch_piola(const ShvElasticity *elasticity, ShvWide h[3][3], ShvWide p[3][3])
{
    if (elasticity->kind == SHV_BATCH_COROTATIONAL) {
        shv_corotational_stress(elasticity, h, p);
        return;
    }
    shv_green_stress(elasticity, h, p);
    if (elasticity->kind == SHV_BATCH_GREEN) return;
    ShvWide other[3][3];
    shv_corotational_stress(elasticity, h, other);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) p[i][j] = shv_wide_select(elasticity->green, p[i][j], other[i][j]);
}

/* Strain energy of a volume, J/m³. */
static inline ShvWide shv_wide_energy_density(const ShvElasticity *elasticity, ShvWide h[3][3])
{
    if (elasticity->kind == SHV_BATCH_COROTATIONAL) return shv_corotational_energy(elasticity, h);
    const ShvWide density = shv_green_energy(elasticity, h);
    if (elasticity->kind == SHV_BATCH_GREEN) return density;
    return shv_wide_select(elasticity->green, density, shv_corotational_energy(elasticity, h));
}

/* Number among the blocks of smoothed elements; −1: it has none. */
static inline int32_t shv_batch_block(const ShvSolid *solid, int32_t batch)
{
    return solid->smoothing.batch_block ? solid->smoothing.batch_block[batch] : -1;
}

/* Where the matrices of eight neighbours begin, in fours of numbers: each fills two. */
static const int32_t shv_rows[SHV_LANES] = {0, 2, 4, 6, 8, 10, 12, 14};

/* Eight matrices, each a row but for its last number, as wide numbers. */
static inline void shv_wide_turn_matrices(const ShvWide row[SHV_LANES], const double last[SHV_LANES], ShvWide m[3][3])
{
    _Alignas(64) double rows[8 * SHV_LANES];
    ShvWide quads[2][4];
    for (int lane = 0; lane < SHV_LANES; lane++) shv_wide_store(rows + 8 * lane, row[lane]);
    for (int half = 0; half < 2; half++) shv_wide_load_quads(rows + 4 * half, shv_rows, quads[half]);
    for (int c = 0; c < 8; c++) m[c / 3][c % 3] = quads[c / 4][c % 4];
    m[2][2] = shv_wide_set(last);
}

/* What each of six edges counts in a lane's mean: nothing where its body rests, whose edges nobody keeps up. */
static inline ShvWide shv_block_share(const ShvSmoothedEdges *smoothing, int32_t block)
{
    double share[SHV_LANES];
    const uint8_t *active = smoothing->lane_active + SHV_LANES * (int64_t)block;
    for (int lane = 0; lane < SHV_LANES; lane++)
        share[lane] = active[lane] == SHV_ACTIVE_AWAKE ? 1.0 / SHV_TET_EDGES : 0.0;
    return shv_wide_set(share);
}

/* Of every lane the mean over its six edges. */
static inline void shv_block_find_mean(const ShvSmoothedEdges *smoothing, int32_t block, ShvWide share)
{
    const int32_t *domain = smoothing->edge_domain + SHV_TET_EDGES * SHV_LANES * (int64_t)block;
    double last[SHV_LANES], *mean = smoothing->mean + 9 * SHV_LANES * (int64_t)block;
    ShvWide sum[SHV_LANES], p[3][3];
    for (int lane = 0; lane < SHV_LANES; lane++, domain += SHV_TET_EDGES) {
        sum[lane] = shv_wide_load(smoothing->stress + 8 * (int64_t)domain[0]);
        last[lane] = smoothing->stress_zz[domain[0]];
        for (int k = 1; k < SHV_TET_EDGES; k++) {
            sum[lane] = shv_wide_add(sum[lane], shv_wide_load(smoothing->stress + 8 * (int64_t)domain[k]));
            last[lane] += smoothing->stress_zz[domain[k]];
        }
    }
    shv_wide_turn_matrices(sum, last, p);
    for (int c = 0; c < 9; c++) shv_wide_store(mean + c * SHV_LANES, shv_wide_mul(share, p[c / 3][c % 3]));
}

static inline ShvWide shv_block_mean_energy(const ShvSmoothedEdges *smoothing, int32_t block)
{
    _Alignas(64) double mean[SHV_LANES];
    for (int lane = 0; lane < SHV_LANES; lane++) {
        const int32_t *domain = smoothing->edge_domain + SHV_TET_EDGES * (SHV_LANES * (int64_t)block + lane);
        mean[lane] = 0.0;
        for (int k = 0; k < SHV_TET_EDGES; k++) mean[lane] += smoothing->energy[domain[k]] / SHV_TET_EDGES;
    }
    return shv_wide_load(mean);
}

/* Strain energy of every lane, J; zero in padding lanes. With smoothed elements the domains' energies are to be there. */
static inline ShvWide shv_batch_energy(const ShvSolid *solid, const ShvState *state, int32_t batch)
{
    const ShvWide volume = shv_wide_load(solid->volumes + (int64_t)batch * SHV_LANES);
    const int32_t block = shv_batch_block(solid, batch);
    if (block >= 0) return shv_wide_mul(volume, shv_block_mean_energy(&solid->smoothing, block));
    ShvWide h[3][3];
    ShvElasticity elasticity;
    shv_batch_elasticity(solid, batch, &elasticity);
    shv_batch_displacement_gradient(solid, state, batch, h);
    return shv_wide_mul(volume, shv_wide_energy_density(&elasticity, h));
}

static inline void shv_block_stress(const ShvSmoothedEdges *smoothing, int32_t block, ShvWide p[3][3])
{
    const double *mean = smoothing->mean + 9 * SHV_LANES * (int64_t)block;
    for (int c = 0; c < 9; c++) p[c / 3][c % 3] = shv_wide_load(mean + c * SHV_LANES);
}

/* First Piola-Kirchhoff stress of every lane with the displacement gradient `h`, or that which its edges have. */
static inline void shv_batch_stress(const ShvSolid *solid, int32_t batch, ShvWide h[3][3], ShvWide p[3][3])
{
    const int32_t block = shv_batch_block(solid, batch);
    if (block >= 0) {
        shv_block_stress(&solid->smoothing, block, p);
        return;
    }
    ShvElasticity elasticity;
    shv_batch_elasticity(solid, batch, &elasticity);
    shv_batch_piola(&elasticity, h, p);
}

/* Determinant of F = I + H: current over reference volume. */
static inline ShvWide shv_wide_volume_ratio(ShvWide h[3][3])
{
    ShvWide f[3][3], cofactors[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) f[i][j] = i == j ? shv_wide_add(h[i][j], shv_wide_set1(1.0)) : h[i][j];
    return shv_wide_cofactors(f, cofactors);
}

/* Forces of a batch: −V P ∇N_b on corner b, the opposite of their sum on corner 0. */
static inline void shv_batch_corner_forces(const ShvSolid *solid, int32_t batch, ShvWide p[3][3],
                                           double corner_force[4][3][SHV_LANES])
{
    const ShvWide minus_volume =
        shv_wide_sub(shv_wide_zero(), shv_wide_load(solid->volumes + (int64_t)batch * SHV_LANES));
    for (int i = 0; i < 3; i++) {
        ShvWide sum = shv_wide_zero();
        ShvWide row[3];
        for (int j = 0; j < 3; j++) row[j] = shv_wide_mul(minus_volume, p[i][j]);
        for (int b = 0; b < 3; b++) {
            ShvWide f = shv_wide_mul(row[0], shv_batch_shape_gradient(solid, batch, b, 0));
            f = shv_wide_fma(row[1], shv_batch_shape_gradient(solid, batch, b, 1), f);
            f = shv_wide_fma(row[2], shv_batch_shape_gradient(solid, batch, b, 2), f);
            shv_wide_store(corner_force[b + 1][i], f);
            sum = shv_wide_add(sum, f);
        }
        shv_wide_store(corner_force[0][i], shv_wide_sub(shv_wide_zero(), sum));
    }
}

/* Adds them lane after lane. */
static inline void shv_batch_scatter(const ShvSolid *solid, ShvState *state, int32_t batch, ShvWide p[3][3])
{
    _Alignas(64) double corner_force[4][3][SHV_LANES];
    shv_batch_corner_forces(solid, batch, p, corner_force);
    const int32_t *nodes = state->connectivity + (int64_t)batch * (4 * SHV_LANES);
    for (int lane = 0; lane < SHV_LANES; lane++)
        for (int corner = 0; corner < 4; corner++) {
            double *force = state->force + 3 * (int64_t)nodes[corner * SHV_LANES + lane];
            for (int i = 0; i < 3; i++) force[i] += corner_force[corner][i][lane];
        }
}

static inline void shv_batch_add_force(const ShvSolid *solid, ShvState *state, int32_t batch)
{
    const int32_t block = shv_batch_block(solid, batch);
    if (block >= 0) {
        ShvWide mean[3][3];
        shv_block_stress(&solid->smoothing, block, mean);
        shv_batch_scatter(solid, state, batch, mean);
        return;
    }
    ShvWide h[3][3], p[3][3];
    shv_batch_displacement_gradient(solid, state, batch, h);
    shv_batch_note_strain(solid, batch, h);
    shv_batch_stress(solid, batch, h, p);
    shv_batch_scatter(solid, state, batch, p);
}

/* Cauchy stress P Fᵀ / J of every lane into six rows of eight (xx, yy, zz, yz, xz, xy). */
static inline void shv_batch_cauchy(const ShvSolid *solid, const ShvState *state, int32_t batch, double *stress)
{
    static const int rows[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    ShvWide h[3][3], p[3][3];
    shv_batch_displacement_gradient(solid, state, batch, h);
    shv_batch_stress(solid, batch, h, p);
    const ShvWide ratio = shv_wide_max(shv_wide_set1(SHV_SMALLEST_VOLUME_RATIO), shv_wide_volume_ratio(h));
    const ShvWide scale = shv_wide_div(shv_wide_set1(1.0), ratio);
    for (int c = 0; c < 6; c++) {
        const int i = rows[c][0], j = rows[c][1];
        ShvWide sum = p[i][j];
        for (int k = 0; k < 3; k++) sum = shv_wide_fma(p[i][k], h[j][k], sum);
        shv_wide_store(stress + c * SHV_LANES, shv_wide_mul(scale, sum));
    }
}

/* Of each lane, whether the traction on one face may count `floor` or more, from its reference normal G (any length) and
   P G: with the cofactors C of F, the current normal is C G, and P G is the traction times |C G|. Compression counts for
   nothing, shear as the weight says. Margins cover round-off; what is squeezed or inside out may count any amount. */
static inline ShvWideMask shv_wide_face_counts(const ShvWide normal[3], const ShvWide traction[3], ShvWide volume,
                                               ShvWide weight, ShvWide floor)
{
    ShvWide area = shv_wide_mul(normal[0], normal[0]), size = shv_wide_mul(traction[0], traction[0]);
    ShvWide along = shv_wide_mul(normal[0], traction[0]);
    for (int i = 1; i < 3; i++) {
        area = shv_wide_fma(normal[i], normal[i], area);
        size = shv_wide_fma(traction[i], traction[i], size);
        along = shv_wide_fma(normal[i], traction[i], along);
    }
    const ShvWide compression = shv_wide_min(along, shv_wide_zero());
    const ShvWide whole = shv_wide_mul(shv_wide_mul(size, area), shv_wide_set1(1.0 + 1e-12));
    const ShvWide counted = shv_wide_fnma(compression, compression, whole);
    const ShvWide least = shv_wide_mul(shv_wide_mul(floor, area), shv_wide_mul(floor, area));
    const ShvWide value = shv_wide_mul(shv_wide_mul(weight, weight), counted);
    const ShvWideMask regular = shv_wide_less(shv_wide_set1(SHV_SMALLEST_VOLUME_RATIO), volume);
    return shv_wide_less_equal(shv_wide_select(regular, least, shv_wide_zero()), value);
}

/* All four faces: bit 8 × face + lane. Face 0 is opposite corner 0, and its normal and traction balance the others'. */
static inline uint32_t shv_batch_faces(const ShvSolid *solid, int32_t batch, ShvWide h[3][3], ShvWide p[3][3],
                                       const double *weight, double floor, bool *inverted)
{
    ShvWide f[3][3], cofactors[3][3], normal[4][3], traction[4][3];
    uint32_t bits = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) f[i][j] = i == j ? shv_wide_add(h[i][j], shv_wide_set1(1.0)) : h[i][j];
    const ShvWide volume = shv_wide_cofactors(f, cofactors), least = shv_wide_set1(floor * (1.0 - 1e-12));
    for (int i = 0; i < 3; i++) {
        normal[0][i] = traction[0][i] = shv_wide_zero();
        for (int b = 0; b < 3; b++) {
            const ShvWide x = shv_batch_shape_gradient(solid, batch, b, 0);
            const ShvWide y = shv_batch_shape_gradient(solid, batch, b, 1);
            const ShvWide z = shv_batch_shape_gradient(solid, batch, b, 2);
            normal[b + 1][i] =
                shv_wide_fma(cofactors[i][2], z, shv_wide_fma(cofactors[i][1], y, shv_wide_mul(cofactors[i][0], x)));
            traction[b + 1][i] = shv_wide_fma(p[i][2], z, shv_wide_fma(p[i][1], y, shv_wide_mul(p[i][0], x)));
            normal[0][i] = shv_wide_sub(normal[0][i], normal[b + 1][i]);
            traction[0][i] = shv_wide_sub(traction[0][i], traction[b + 1][i]);
        }
    }
    for (int face = 0; face < 4; face++) {
        const ShvWide own = shv_wide_load(weight + ((int64_t)batch * 4 + face) * SHV_LANES);
        bits |= shv_wide_bits(shv_wide_face_counts(normal[face], traction[face], volume, own, least))
                << (SHV_LANES * face);
    }
    *inverted = shv_wide_bits(shv_wide_less(shv_wide_zero(), volume)) != 0xffu;
    return bits;
}

static inline bool shv_batch_add_force_and_find_faces(const ShvSolid *solid, ShvState *state, int32_t batch,
                                                      const double *weight, double floor, uint32_t *faces)
{
    ShvWide h[3][3], p[3][3];
    bool inverted;
    shv_batch_displacement_gradient(solid, state, batch, h);
    if (shv_batch_block(solid, batch) < 0)
        shv_batch_note_strain(solid, batch, h); /* smoothed: found with their edges */
    shv_batch_stress(solid, batch, h, p);
    shv_batch_scatter(solid, state, batch, p);
    faces[batch] = shv_batch_faces(solid, batch, h, p, weight, floor, &inverted);
    return inverted;
}

#endif
