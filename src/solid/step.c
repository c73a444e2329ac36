#include <float.h>

#include "solid/kernel.h"

/* Σ_a ∇N_a ∇N_aᵀ over the four corners of an element, 1/m². */
static ShvMat3 gradient_products(const ShvSolid *solid, int32_t element)
{
    const double *first = solid->gradients + (int64_t)(element / SHV_LANES) * (9 * SHV_LANES) + element % SHV_LANES;
    double g[4][3] = {{0.0}};
    for (int b = 0; b < 3; b++)
        for (int j = 0; j < 3; j++) {
            g[b + 1][j] = first[(3 * b + j) * SHV_LANES];
            g[0][j] -= g[b + 1][j];
        }
    ShvMat3 sum = {{{0.0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int a = 0; a < 4; a++) sum.m[i][j] += g[a][i] * g[a][j];
    return sum;
}

/* |∇N_a| is the inverse of the altitude above corner a. For λ < 0 the dilatation only softens, and 2µ alone bounds. */
double shv_solid_safe_step(const ShvSolid *solid, int32_t element)
{
    const ShvMaterial *material = shv_model_material(solid->model, element);
    const ShvMat3 products = gradient_products(solid, element);
    const double modulus = fmax(material->lambda, 0.0) + 2.0 * material->mu;
    const double inverse_square = products.m[0][0] + products.m[1][1] + products.m[2][2];
    return 1.0 / sqrt(modulus / material->density * inverse_square);
}

/* B Bᵀ of the strain-displacement matrix (engineering shear, rows xx, yy, zz, yz, xz, xy), from the gradient
   products. */
static void strain_products(const ShvMat3 *s, double b[6][6])
{
    const double(*m)[3] = s->m;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int k = 3 - i - j;
            b[i][j] = i == j ? m[i][i] : 0.0;
            /* Shear row 3 + j lacks axis j. It shares with the normal row i the product of axis i and the third
               axis. */
            b[i][3 + j] = b[3 + j][i] = i == j ? 0.0 : m[i][k];
            b[3 + i][3 + j] = i == j ? m[0][0] + m[1][1] + m[2][2] - m[i][i] : m[i][j];
        }
}

/* a := r a r for the symmetric root r of the elasticity matrix: p I + q 1 1ᵀ on the normal part, √µ on shear. */
static void scale_by_elastic_root(const ShvMaterial *material, double a[6][6])
{
    const double p = sqrt(2.0 * material->mu), shear = sqrt(material->mu);
    const double q = (sqrt(3.0 * material->lambda + 2.0 * material->mu) - p) / 3.0;
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < 6; i++) {
            double *row[6];
            for (int j = 0; j < 6; j++) row[j] = side == 0 ? &a[i][j] : &a[j][i];
            const double sum = *row[0] + *row[1] + *row[2];
            for (int j = 0; j < 3; j++) *row[j] = p * *row[j] + q * sum;
            for (int j = 3; j < 6; j++) *row[j] *= shear;
        }
}

/* One Jacobi rotation that makes a[p][q] zero (Golub and Van Loan, Matrix Computations, 8.5). */
static void rotate(double a[6][6], int p, int q)
{
    if (a[p][q] == 0.0) return;
    const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    const double t = (theta < 0.0 ? -1.0 : 1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
    const double c = 1.0 / sqrt(t * t + 1.0), s = t * c, shift = t * a[p][q];
    a[p][p] -= shift;
    a[q][q] += shift;
    a[p][q] = a[q][p] = 0.0;
    for (int r = 0; r < 6; r++) {
        if (r == p || r == q) continue;
        const double x = a[r][p], y = a[r][q];
        a[r][p] = a[p][r] = c * x - s * y;
        a[r][q] = a[q][r] = s * x + c * y;
    }
}

static double off_diagonal_norm(double a[6][6])
{
    double sum = 0.0;
    for (int p = 0; p < 6; p++)
        for (int q = p + 1; q < 6; q++) sum += 2.0 * a[p][q] * a[p][q];
    return sqrt(sum);
}

/* Upper bound of the largest eigenvalue of a positive semidefinite matrix, and closer than 1e-12 of it. What Jacobi
   sweeps leave off the diagonal moves no eigenvalue by more than its norm (Weyl), and rounding in building and
   rotating the matrix stays below some hundred units in the last place of its trace, hence the last factor. */
static double largest_eigenvalue(double a[6][6])
{
    enum { SWEEPS = 30 };
    double trace = 0.0, largest = 0.0;
    for (int i = 0; i < 6; i++) trace += a[i][i];
    for (int sweep = 0; sweep < SWEEPS && off_diagonal_norm(a) > 1e-14 * trace; sweep++)
        for (int p = 0; p < 6; p++)
            for (int q = p + 1; q < 6; q++) rotate(a, p, q);
    for (int i = 0; i < 6; i++) largest = fmax(largest, a[i][i]);
    return largest + off_diagonal_norm(a) + 512.0 * DBL_EPSILON * trace;
}

/* The element's stiffness is V Bᵀ C B and its mass ρV/4 at each corner, so that ω² are the eigenvalues of (4/ρ) Bᵀ C B;
   those that are not zero are those of (4/ρ) C^½ B Bᵀ C^½, six rows instead of twelve. */
static double find_exact_step(const ShvSolid *solid, int32_t element)
{
    const ShvMaterial *material = shv_model_material(solid->model, element);
    const ShvMat3 products = gradient_products(solid, element);
    double a[6][6];
    strain_products(&products, a);
    scale_by_elastic_root(material, a);
    return sqrt(material->density / largest_eigenvalue(a));
}

/* What was found once is kept. */
double shv_solid_exact_step(const ShvSolid *solid, int32_t element)
{
    double *step = &solid->exact_step[element];
    if (isnan(*step)) *step = find_exact_step(solid, element);
    return *step;
}

/* Smallest exact step of a batch, and the first element that has it. */
static double exact_of_batch(const ShvSolid *solid, int32_t batch, int32_t *element)
{
    double best = HUGE_VAL;
    for (int32_t e = batch * SHV_LANES; e < (batch + 1) * SHV_LANES && e < solid->model->mesh.element_count; e++) {
        if (shv_solid_safe_step(solid, e) > best) continue; /* the safe step is the smaller one */
        const double step = shv_solid_exact_step(solid, e);
        if (!(step < best)) continue;
        best = step;
        *element = e;
    }
    return best;
}

static double find_exact(const ShvSolid *solid, int32_t batch)
{
    int32_t element;
    if (isnan(solid->batch_exact[batch])) solid->batch_exact[batch] = exact_of_batch(solid, batch, &element);
    return solid->batch_exact[batch];
}

/* Batches whose safe step is no smaller than the best exact one cannot set it: most need no eigenvalue. */
static double search_batch(const ShvSolid *solid, int32_t batch, double best)
{
    if (!solid->batch_active[batch] || solid->batch_safe[batch] > best) return best;
    return fmin(best, find_exact(solid, batch));
}

static int32_t first_element_with(const ShvSolid *solid, double step)
{
    int32_t element = -1;
    for (int32_t batch = 0; batch < solid->batch_count; batch++)
        if (solid->batch_active[batch] && solid->batch_exact[batch] == step) {
            exact_of_batch(solid, batch, &element);
            break;
        }
    return element;
}

double shv_solid_stable_step(const ShvSolid *solid, int32_t *element)
{
    double best = HUGE_VAL;
#pragma omp parallel for schedule(static) reduction(min                                                                \
                                                    : best)                                                            \
    num_threads(solid->model->threads) if (solid->model->threads > 1)
    for (int32_t batch = 0; batch < solid->batch_count; batch++) best = search_batch(solid, batch, best);
    if (!(best < DBL_MAX)) best = HUGE_VAL; /* a thread's share of the minimum may begin at the largest finite number */
    if (element) *element = first_element_with(solid, best);
    return best;
}

static void update_batch(ShvSolid *solid, int32_t batch, const int32_t *element_fragment, const uint8_t *awake)
{
    double safe = HUGE_VAL, exact = HUGE_VAL;
    for (int32_t e = batch * SHV_LANES; e < (batch + 1) * SHV_LANES && e < solid->model->mesh.element_count; e++) {
        if (!awake[element_fragment[e]]) continue;
        safe = fmin(safe, shv_solid_safe_step(solid, e));
        exact = fmin(exact, shv_solid_exact_step(solid, e));
    }
    solid->batch_safe[batch] = safe;
    solid->batch_exact[batch] = exact;
}

void shv_solid_update_batch_steps(ShvSolid *solid, const int32_t *element_fragment, const uint8_t *awake)
{
    for (int32_t object = 1; object < solid->model->object_count; object++) {
        const int32_t begin = solid->model->objects[object].element_begin, batch = begin / SHV_LANES;
        if (begin % SHV_LANES != 0 && solid->batch_active[batch]) update_batch(solid, batch, element_fragment, awake);
    }
}

/* ---- of deformed elements ---- */

/* With S = λ tr E I + 2µ E, a small motion u of the nodes of an element with F meets the stiffness
     V (C : sym(Fᵀ ∇u) : sym(Fᵀ ∇u) + S : ∇uᵀ∇u),
   whose first term is that at rest of Fᵀu, at most σ₁² |u|² for the largest stretch σ₁, and whose second is at most S₁ V Σ|∇N|² |u|² for
   the largest principal stress. With the steps at rest, exact and safe (which has Σ|∇N|² in it):
     (ω/2)² ≤ σ₁² / exact² + max(S₁, 0) / (λ⁺+2µ) / safe².
   The largest eigenvalue of a symmetric matrix is at most its mean and √⅔ of its deviator's norm, which is exact for one axis. */
typedef struct ShvWideStrained {
    ShvWide stretch, stress; /* σ₁²; max(S₁, 0) / (λ⁺+2µ) */
} ShvWideStrained;

static ShvWideStrained find_strained(const ShvElasticity *elasticity, ShvWide h[3][3])
{
    ShvWide twice[3][3];
    shv_wide_twice_green_strain(h, twice);
    const ShvWide zero = shv_wide_zero(), trace = shv_wide_trace(twice), third = shv_wide_set1(1.0 / 3.0);
    const ShvWide deviator =
        shv_wide_max(zero, shv_wide_fnma(shv_wide_mul(third, trace), trace, shv_wide_squared_norm(twice)));
    const ShvWide largest = shv_wide_fma(third, trace, shv_wide_sqrt(shv_wide_mul(shv_wide_set1(2.0 / 3.0), deviator)));
    const ShvWide pressure = shv_wide_mul(shv_wide_mul(shv_wide_set1(0.5), elasticity->lambda), trace);
    const ShvWide stress = shv_wide_max(zero, shv_wide_fma(elasticity->mu, largest, pressure));
    const ShvWide modulus =
        shv_wide_add(shv_wide_max(zero, elasticity->lambda), shv_wide_add(elasticity->mu, elasticity->mu));
    return (ShvWideStrained){shv_wide_add(shv_wide_set1(1.0), shv_wide_max(zero, largest)),
                             shv_wide_div(stress, modulus)};
}

/* The first 5 % of ω² are left to what the scene's safety leaves, so that brittle bodies know nothing of this, and the step goes down from
   that at rest without a jump: by shv_little_strain, ω² has grown by at most 3.6 times as much. */
static const double little_growth = 0.05;

double shv_batch_strained_step(const ShvSolid *solid, int32_t batch, const double *gradient)
{
    ShvWide h[3][3];
    for (int c = 0; c < 9; c++) h[c / 3][c % 3] = shv_wide_load(gradient + c * SHV_LANES);
    ShvElasticity elasticity;
    shv_batch_elasticity(solid, batch, &elasticity);
    if (elasticity.kind == SHV_BATCH_COROTATIONAL) return HUGE_VAL;
    const double exact = find_exact(solid, batch), safe = solid->batch_safe[batch];
    const double at_rest = 1.0 / (exact * exact);
    const ShvWideStrained strained = find_strained(&elasticity, h);
    ShvWide inverse = shv_wide_mul(shv_wide_set1(at_rest), strained.stretch);
    inverse = shv_wide_fma(shv_wide_set1(1.0 / (safe * safe)), strained.stress, inverse);
    if (elasticity.kind == SHV_BATCH_BOTH) inverse = shv_wide_select(elasticity.green, inverse, shv_wide_zero());
    _Alignas(64) double lanes[SHV_LANES];
    shv_wide_store(lanes, inverse);
    double most = 0.0;
    for (int lane = 0; lane < SHV_LANES; lane++) most = fmax(most, lanes[lane]);
    const double counted = most - little_growth * at_rest;
    return counted > at_rest ? 1.0 / sqrt(counted) : HUGE_VAL;
}

double shv_solid_strained_step(const ShvSolid *solid)
{
    double best = HUGE_VAL;
    for (int32_t batch = 0; batch < solid->batch_count; batch++)
        if (solid->batch_active[batch]) best = fmin(best, solid->batch_strained[batch]);
    return best;
}
