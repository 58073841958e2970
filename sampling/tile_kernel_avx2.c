/* SPDX-License-Identifier: MIT */
#include "sampling/tile_aim_loops.inc"
#include "sampling/tile_bound_loops.inc"
#include "sampling/tile_eval_loops.inc"

#include <immintrin.h>

typedef __m256d wide;
typedef __m256d mask;
enum { LANES = 4 };

static inline wide w_load(const float *x)
{
    return _mm256_cvtps_pd(_mm_loadu_ps(x));
}

static inline wide w_set(double x)
{
    return _mm256_set1_pd(x);
}

static inline wide w_bits(uint64_t bits)
{
    return _mm256_castsi256_pd(_mm256_set1_epi64x((long long)bits));
}

static inline wide w_add(wide a, wide b)
{
    return _mm256_add_pd(a, b);
}

static inline wide w_sub(wide a, wide b)
{
    return _mm256_sub_pd(a, b);
}

static inline wide w_mul(wide a, wide b)
{
    return _mm256_mul_pd(a, b);
}

static inline mask w_less(wide a, wide b)
{
    return _mm256_cmp_pd(a, b, _CMP_LT_OQ);
}

static inline mask m_and(mask a, mask b)
{
    return _mm256_and_pd(a, b);
}

static inline int m_any(mask m)
{
    return _mm256_movemask_pd(m) != 0;
}

static inline wide w_pick(mask m, wide a, wide b)
{
    return _mm256_blendv_pd(b, a, m);
}

static inline void w_store_packed(uint64_t *out, const wide index[4])
{
    __m256i packed = _mm256_castpd_si256(index[3]);
    for (int s = 2; s >= 0; s--)
        packed = _mm256_or_si256(_mm256_slli_epi64(packed, 16), _mm256_castpd_si256(index[s]));
    _mm256_storeu_si256((__m256i *)(void *)out, packed);
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

const ncr_tile_kernel ncr_tile_kernel_avx2 = {
    .eval = eval_tile,
    .bound = bound_tile,
    .stand = stand_points,
    .nearest = nearest_tile,
    .distances = texel_distances,
    .aim = aim_segments,
};
