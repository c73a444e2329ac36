/* Eight doubles at once, in AVX-512, AVX2 with FMA, or plain C: the only place with processor intrinsics. Every
   operation rounds once per lane as IEEE 754 says, so all three give the same bits. SHV_SIMD_AVX2 or
   SHV_SIMD_PLAIN, defined before the include, choose a narrower path than the compiler offers (tests). */
#ifndef SHV_BASE_SIMD_H
#define SHV_BASE_SIMD_H

#include <math.h>
#include <stdint.h>

enum { SHV_WIDE_LANES = 8 };

#if defined(__AVX512F__) && !defined(SHV_SIMD_AVX2) && !defined(SHV_SIMD_PLAIN)
#include <immintrin.h>

typedef __m512d ShvWide;
typedef __mmask8 ShvWideMask; /* one truth value a lane */

static inline ShvWide shv_wide_zero(void)
{
    return _mm512_setzero_pd();
}
static inline ShvWide shv_wide_set1(double s)
{
    return _mm512_set1_pd(s);
}
/* p: 8 doubles, aligned to 64 bytes. */
static inline ShvWide shv_wide_load(const double *p)
{
    return _mm512_load_pd(p);
}
/* Of numbers that may still be in registers. */
static inline ShvWide shv_wide_set(const double lane[8])
{
    return _mm512_set_pd(lane[7], lane[6], lane[5], lane[4], lane[3], lane[2], lane[1], lane[0]);
}
static inline void shv_wide_store(double *p, ShvWide a)
{
    _mm512_store_pd(p, a);
}
/* base[index[0]] … base[index[7]]; index needs no alignment. */
static inline ShvWide shv_wide_gather(const double *base, const int32_t *index)
{
    return _mm512_i32gather_pd(_mm256_loadu_si256((const __m256i *)(const void *)index), base, 8);
}
static inline ShvWide shv_wide_add(ShvWide a, ShvWide b)
{
    return _mm512_add_pd(a, b);
}
static inline ShvWide shv_wide_sub(ShvWide a, ShvWide b)
{
    return _mm512_sub_pd(a, b);
}
static inline ShvWide shv_wide_mul(ShvWide a, ShvWide b)
{
    return _mm512_mul_pd(a, b);
}
static inline ShvWide shv_wide_div(ShvWide a, ShvWide b)
{
    return _mm512_div_pd(a, b);
}
/* a < b ? a : b and a > b ? a : b: b where either is not a number. */
static inline ShvWide shv_wide_min(ShvWide a, ShvWide b)
{
    return _mm512_min_pd(a, b);
}
static inline ShvWide shv_wide_max(ShvWide a, ShvWide b)
{
    return _mm512_max_pd(a, b);
}
static inline ShvWide shv_wide_sqrt(ShvWide a)
{
    return _mm512_sqrt_pd(a);
}
/* a b + c and c − a b, rounded once. */
static inline ShvWide shv_wide_fma(ShvWide a, ShvWide b, ShvWide c)
{
    return _mm512_fmadd_pd(a, b, c);
}
static inline ShvWide shv_wide_fnma(ShvWide a, ShvWide b, ShvWide c)
{
    return _mm512_fnmadd_pd(a, b, c);
}
/* a < b, a ≤ b; false where either is not a number. */
static inline ShvWideMask shv_wide_less(ShvWide a, ShvWide b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}
static inline ShvWideMask shv_wide_less_equal(ShvWide a, ShvWide b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ);
}
/* where ? a : b */
static inline ShvWide shv_wide_select(ShvWideMask where, ShvWide a, ShvWide b)
{
    return _mm512_mask_blend_pd(where, b, a);
}
/* Whether the mask is true in some lane. */
static inline int shv_wide_any(ShvWideMask mask)
{
    return mask != 0;
}
/* Bit i: whether the mask is true in lane i. */
static inline uint32_t shv_wide_bits(ShvWideMask mask)
{
    return mask;
}
/* Records of four doubles, aligned to 32 bytes: q[c] lane i becomes base[4 index[i] + c]. */
static inline void shv_wide_load_quads(const double *base, const int32_t *index, ShvWide q[4])
{
    ShvWide r[4];
    for (int i = 0; i < 4; i++)
        r[i] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(base + 4 * (int64_t)index[i])),
                                  _mm256_load_pd(base + 4 * (int64_t)index[i + 4]), 1);
    const __m512i low = _mm512_set_epi64(13, 12, 5, 4, 9, 8, 1, 0), high = _mm512_set_epi64(15, 14, 7, 6, 11, 10, 3, 2);
    for (int i = 0; i < 2; i++) {
        const ShvWide first = i ? _mm512_unpackhi_pd(r[0], r[1]) : _mm512_unpacklo_pd(r[0], r[1]);
        const ShvWide second = i ? _mm512_unpackhi_pd(r[2], r[3]) : _mm512_unpacklo_pd(r[2], r[3]);
        q[i] = _mm512_permutex2var_pd(first, low, second);
        q[i + 2] = _mm512_permutex2var_pd(first, high, second);
    }
}
/* The reverse, lane after lane: of lanes with the same index the last one stays. */
static inline void shv_wide_store_quads(double *base, const int32_t *index, const ShvWide q[4])
{
    const __m512i low = _mm512_set_epi64(13, 12, 5, 4, 9, 8, 1, 0), high = _mm512_set_epi64(15, 14, 7, 6, 11, 10, 3, 2);
    ShvWide r[4];
    for (int i = 0; i < 2; i++) {
        const ShvWide first = _mm512_permutex2var_pd(q[0], i ? high : low, q[2]);
        const ShvWide second = _mm512_permutex2var_pd(q[1], i ? high : low, q[3]);
        r[2 * i] = _mm512_unpacklo_pd(first, second);
        r[2 * i + 1] = _mm512_unpackhi_pd(first, second);
    }
    for (int i = 0; i < 4; i++) _mm256_store_pd(base + 4 * (int64_t)index[i], _mm512_castpd512_pd256(r[i]));
    for (int i = 0; i < 4; i++) _mm256_store_pd(base + 4 * (int64_t)index[i + 4], _mm512_extractf64x4_pd(r[i], 1));
}

#elif defined(__AVX2__) && defined(__FMA__) && !defined(SHV_SIMD_PLAIN)
#include <immintrin.h>

typedef struct ShvWide {
    __m256d low, high;
} ShvWide;
typedef ShvWide ShvWideMask; /* all bits of a lane set or clear */

static inline ShvWide shv_wide_zero(void)
{
    return (ShvWide){_mm256_setzero_pd(), _mm256_setzero_pd()};
}
static inline ShvWide shv_wide_set1(double s)
{
    return (ShvWide){_mm256_set1_pd(s), _mm256_set1_pd(s)};
}
static inline ShvWide shv_wide_load(const double *p)
{
    return (ShvWide){_mm256_load_pd(p), _mm256_load_pd(p + 4)};
}
static inline ShvWide shv_wide_set(const double lane[8])
{
    return (ShvWide){_mm256_set_pd(lane[3], lane[2], lane[1], lane[0]),
                     _mm256_set_pd(lane[7], lane[6], lane[5], lane[4])};
}
static inline void shv_wide_store(double *p, ShvWide a)
{
    _mm256_store_pd(p, a.low);
    _mm256_store_pd(p + 4, a.high);
}
static inline ShvWide shv_wide_gather(const double *base, const int32_t *index)
{
    return (ShvWide){_mm256_i32gather_pd(base, _mm_loadu_si128((const __m128i *)(const void *)index), 8),
                     _mm256_i32gather_pd(base, _mm_loadu_si128((const __m128i *)(const void *)(index + 4)), 8)};
}
#define SHV_WIDE_BINARY(name, instruction)                                                                             \
    static inline ShvWide shv_wide_##name(ShvWide a, ShvWide b)                                                        \
    {                                                                                                                  \
        return (ShvWide){instruction(a.low, b.low), instruction(a.high, b.high)};                                      \
    }
SHV_WIDE_BINARY(add, _mm256_add_pd)
SHV_WIDE_BINARY(sub, _mm256_sub_pd)
SHV_WIDE_BINARY(mul, _mm256_mul_pd)
SHV_WIDE_BINARY(div, _mm256_div_pd)
SHV_WIDE_BINARY(min, _mm256_min_pd)
SHV_WIDE_BINARY(max, _mm256_max_pd)
#undef SHV_WIDE_BINARY
static inline ShvWide shv_wide_sqrt(ShvWide a)
{
    return (ShvWide){_mm256_sqrt_pd(a.low), _mm256_sqrt_pd(a.high)};
}
static inline ShvWide shv_wide_fma(ShvWide a, ShvWide b, ShvWide c)
{
    return (ShvWide){_mm256_fmadd_pd(a.low, b.low, c.low), _mm256_fmadd_pd(a.high, b.high, c.high)};
}
static inline ShvWide shv_wide_fnma(ShvWide a, ShvWide b, ShvWide c)
{
    return (ShvWide){_mm256_fnmadd_pd(a.low, b.low, c.low), _mm256_fnmadd_pd(a.high, b.high, c.high)};
}
static inline ShvWideMask shv_wide_less(ShvWide a, ShvWide b)
{
    return (ShvWide){_mm256_cmp_pd(a.low, b.low, _CMP_LT_OQ), _mm256_cmp_pd(a.high, b.high, _CMP_LT_OQ)};
}
static inline ShvWideMask shv_wide_less_equal(ShvWide a, ShvWide b)
{
    return (ShvWide){_mm256_cmp_pd(a.low, b.low, _CMP_LE_OQ), _mm256_cmp_pd(a.high, b.high, _CMP_LE_OQ)};
}
static inline ShvWide shv_wide_select(ShvWideMask where, ShvWide a, ShvWide b)
{
    return (ShvWide){_mm256_blendv_pd(b.low, a.low, where.low), _mm256_blendv_pd(b.high, a.high, where.high)};
}
static inline int shv_wide_any(ShvWideMask mask)
{
    return (_mm256_movemask_pd(mask.low) | _mm256_movemask_pd(mask.high)) != 0;
}
static inline uint32_t shv_wide_bits(ShvWideMask mask)
{
    return (uint32_t)_mm256_movemask_pd(mask.low) | (uint32_t)_mm256_movemask_pd(mask.high) << 4;
}
/* Four rows become four columns. */
static inline void shv_wide_transpose(const __m256d r[4], __m256d q[4])
{
    for (int i = 0; i < 2; i++) {
        const __m256d first = i ? _mm256_unpackhi_pd(r[0], r[1]) : _mm256_unpacklo_pd(r[0], r[1]);
        const __m256d second = i ? _mm256_unpackhi_pd(r[2], r[3]) : _mm256_unpacklo_pd(r[2], r[3]);
        q[i] = _mm256_permute2f128_pd(first, second, 0x20);
        q[i + 2] = _mm256_permute2f128_pd(first, second, 0x31);
    }
}
static inline void shv_wide_load_quads(const double *base, const int32_t *index, ShvWide q[4])
{
    __m256d rows[2][4], columns[2][4];
    for (int i = 0; i < SHV_WIDE_LANES; i++) rows[i / 4][i % 4] = _mm256_load_pd(base + 4 * (int64_t)index[i]);
    for (int half = 0; half < 2; half++) shv_wide_transpose(rows[half], columns[half]);
    for (int c = 0; c < 4; c++) q[c] = (ShvWide){columns[0][c], columns[1][c]};
}
static inline void shv_wide_store_quads(double *base, const int32_t *index, const ShvWide q[4])
{
    for (int half = 0; half < 2; half++) {
        __m256d columns[4], rows[4];
        for (int c = 0; c < 4; c++) columns[c] = half ? q[c].high : q[c].low;
        shv_wide_transpose(columns, rows);
        for (int i = 0; i < 4; i++) _mm256_store_pd(base + 4 * (int64_t)index[4 * half + i], rows[i]);
    }
}

#else

typedef struct ShvWide {
    double lane[SHV_WIDE_LANES];
} ShvWide;
typedef struct ShvWideMask {
    uint8_t lane[SHV_WIDE_LANES];
} ShvWideMask;

/* A function whose result's lane i is `expression`. */
#define SHV_WIDE_LOOP(type, name, parameters, expression)                                                              \
    static inline type shv_wide_##name parameters                                                                      \
    {                                                                                                                  \
        type r;                                                                                                        \
        for (int i = 0; i < SHV_WIDE_LANES; i++) r.lane[i] = (expression);                                             \
        return r;                                                                                                      \
    }
SHV_WIDE_LOOP(ShvWide, zero, (void), 0.0)
SHV_WIDE_LOOP(ShvWide, set1, (double s), s)
SHV_WIDE_LOOP(ShvWide, load, (const double *p), p[i])
SHV_WIDE_LOOP(ShvWide, set, (const double lane[8]), lane[i])
SHV_WIDE_LOOP(ShvWide, gather, (const double *base, const int32_t *index), base[index[i]])
SHV_WIDE_LOOP(ShvWide, add, (ShvWide a, ShvWide b), a.lane[i] + b.lane[i])
SHV_WIDE_LOOP(ShvWide, sub, (ShvWide a, ShvWide b), a.lane[i] - b.lane[i])
SHV_WIDE_LOOP(ShvWide, mul, (ShvWide a, ShvWide b), a.lane[i] * b.lane[i])
SHV_WIDE_LOOP(ShvWide, div, (ShvWide a, ShvWide b), a.lane[i] / b.lane[i])
SHV_WIDE_LOOP(ShvWide, min, (ShvWide a, ShvWide b), a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i])
SHV_WIDE_LOOP(ShvWide, max, (ShvWide a, ShvWide b), a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i])
SHV_WIDE_LOOP(ShvWide, sqrt, (ShvWide a), sqrt(a.lane[i]))
SHV_WIDE_LOOP(ShvWide, fma, (ShvWide a, ShvWide b, ShvWide c), fma(a.lane[i], b.lane[i], c.lane[i]))
SHV_WIDE_LOOP(ShvWide, fnma, (ShvWide a, ShvWide b, ShvWide c), fma(-a.lane[i], b.lane[i], c.lane[i]))
SHV_WIDE_LOOP(ShvWideMask, less, (ShvWide a, ShvWide b), a.lane[i] < b.lane[i])
SHV_WIDE_LOOP(ShvWideMask, less_equal, (ShvWide a, ShvWide b), a.lane[i] <= b.lane[i])
SHV_WIDE_LOOP(ShvWide, select, (ShvWideMask where, ShvWide a, ShvWide b), where.lane[i] ? a.lane[i] : b.lane[i])
#undef SHV_WIDE_LOOP
static inline void shv_wide_store(double *p, ShvWide a)
{
    for (int i = 0; i < SHV_WIDE_LANES; i++) p[i] = a.lane[i];
}
static inline int shv_wide_any(ShvWideMask mask)
{
    int any = 0;
    for (int i = 0; i < SHV_WIDE_LANES; i++) any |= mask.lane[i];
    return any;
}
static inline uint32_t shv_wide_bits(ShvWideMask mask)
{
    uint32_t bits = 0;
    for (int i = 0; i < SHV_WIDE_LANES; i++) bits |= (uint32_t)(mask.lane[i] != 0) << i;
    return bits;
}
static inline void shv_wide_load_quads(const double *base, const int32_t *index, ShvWide q[4])
{
    for (int c = 0; c < 4; c++)
        for (int i = 0; i < SHV_WIDE_LANES; i++) q[c].lane[i] = base[4 * (int64_t)index[i] + c];
}
static inline void shv_wide_store_quads(double *base, const int32_t *index, const ShvWide q[4])
{
    for (int i = 0; i < SHV_WIDE_LANES; i++)
        for (int c = 0; c < 4; c++) base[4 * (int64_t)index[i] + c] = q[c].lane[i];
}

#endif

/* Asks for what will be read soon; changes nothing else. */
static inline void shv_prefetch(const void *where)
{
#if defined(__GNUC__)
    __builtin_prefetch(where);
#else
    (void)where;
#endif
}

#endif
