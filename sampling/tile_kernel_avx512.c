/* SPDX-License-Identifier: MIT */
#include "sampling/tile_aim_loops.inc"
#include "sampling/tile_bound_loops.inc"
#include "sampling/tile_eval_loops.inc"

#include <immintrin.h>

typedef __m512d wide;
typedef __mmask8 mask;
enum { LANES = 8 };

static inline wide w_load(const float *x)
{
    return _mm512_cvtps_pd(_mm256_loadu_ps(x));
}

static inline wide w_set(double x)
{
    return _mm512_set1_pd(x);
}

static inline wide w_bits(uint64_t bits)
{
    return _mm512_castsi512_pd(_mm512_set1_epi64((long long)bits));
}

static inline wide w_add(wide a, wide b)
{
    return _mm512_add_pd(a, b);
}

static inline wide w_sub(wide a, wide b)
{
    return _mm512_sub_pd(a, b);
}

static inline wide w_mul(wide a, wide b)
{
    return _mm512_mul_pd(a, b);
}

static inline mask w_less(wide a, wide b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}

static inline mask m_and(mask a, mask b)
{
    return (mask)(a & b);
}

static inline int m_any(mask m)
{
    return m != 0;
}

static inline wide w_pick(mask m, wide a, wide b)
{
    return _mm512_mask_blend_pd(m, b, a);
}

static inline void w_store_packed(uint64_t *out, const wide index[4])
{
    __m512i packed = _mm512_castpd_si512(index[3]);
    for (int s = 2; s >= 0; s--)
        packed = _mm512_or_si512(_mm512_slli_epi64(packed, 16), _mm512_castpd_si512(index[s]));
    _mm512_storeu_si512(out, packed);
}

#include "sampling/tile_nearest_wide.inc"

/* Without the last instruction, gcc 12 returns with the upper halves in use, which makes the
 * scalar code that follows half as fast. */
static void nearest_tile(const ncr_texel_tile *tile, const ncr_candidates *candidates, double cos2,
                         uint64_t *four)
{
    search_tile(tile, candidates, cos2, four);
    _mm256_zeroupper();
}

const ncr_tile_kernel ncr_tile_kernel_avx512 = {
    .eval = eval_tile,
    .bound = bound_tile,
    .stand = stand_points,
    .nearest = nearest_tile,
    .distances = texel_distances,
    .aim = aim_segments,
};
