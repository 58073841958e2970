/* SPDX-License-Identifier: MIT
 * check_weights.c - blend weights at every exponent, and of points at the surface.   [S-12, S-13] */
#include "apps/check.h"

#include "core/vec_internal.h"

#include <math.h>

static const uint32_t sets = 20000;

static ncr_vec3 direction(uint64_t counter, uint64_t key)
{
    const double z = 2 * ncr_uniform(counter, key) - 1;
    const double phi = 6.283185307179586 * ncr_uniform(counter, key + 1000), s = sqrt(1 - z * z);
    return v_make((float)(s * cos(phi)), (float)(s * sin(phi)), (float)z);
}

/* Four points about a surface point; every third set has one at the point itself, every fifth an
 * opposite pair, and lengths run over 12 orders. */
static void make_set(uint32_t k, ncr_vec3 to[4])
{
    for (uint32_t j = 0; j < 4; j++)
        to[j] = v_scale(direction(4 * k + j, 3), (float)pow(10, 12 * ncr_uniform(k, j) - 6));
    if (k % 3 == 0)
        to[0] = v_make(0, 0, 0);
    if (k % 5 == 0)
        to[2] = v_scale(to[1], -1);
}

typedef struct sums {
    double off_one, least; /* largest |sum - 1|, smallest weight */
    uint32_t not_finite;
} sums;

static void add_set(ncr_basis basis, float exponent, uint32_t k, sums *s)
{
    ncr_vec3 to[4];
    float w[4];
    double sum = 0;
    make_set(k, to);
    ncr_blend_weights(basis, exponent, 4, to, 15, direction(k, 1), direction(k, 2), w);
    for (int j = 0; j < 4; j++) {
        s->not_finite += isfinite(w[j]) ? 0 : 1;
        s->least = fmin(s->least, w[j]);
        sum += w[j];
    }
    s->off_one = fmax(s->off_one, fabs(sum - 1));
}

ncr_status check_weight_sums(check_run *r)
{
    static const float exponents[] = {0, 1e-30f, 1, 4, 16, 4096, 1e6f, INFINITY};
    static const ncr_basis bases[] = {NCR_BASIS_COSINE_R, NCR_BASIS_COSINE_N, NCR_BASIS_ABS_R};
    static const char *const names[] = {"cosine-r", "cosine-n", "abs-r"};
    for (size_t b = 0; b < 3; b++)
        for (size_t e = 0; e < sizeof exponents / sizeof exponents[0]; e++) {
            sums s = {0};
            for (uint32_t k = 0; k < sets; k++)
                add_set(bases[b], exponents[e], k, &s);
            check_at_most(r, s.not_finite ? NAN : fmax(s.off_one, -s.least), 0x1p-23,
                          "%s:%g, |sum - 1| or below 0, %u sets", names[b], (double)exponents[e],
                          sets);
        }
    return NCR_OK;
}

ncr_status check_coincident_points(check_run *r)
{
    double worst = 0;
    for (uint32_t k = 0; k < sets; k++) {
        const ncr_vec3 n = direction(k, 1), m = direction(k, 2);
        ncr_vec3 at[4], along[4];
        float w[4], v[4];
        make_set(k, at);
        make_set(k, along);
        at[0] = v_make(0, 0, 0);
        along[0] = n;
        for (float exponent = 0; exponent < 2000; exponent = 4 * exponent + 1) {
            ncr_blend_weights(NCR_BASIS_COSINE_R, exponent, 4, at, 15, n, m, w);
            const unsigned fell =
                ncr_blend_weights(NCR_BASIS_COSINE_R, exponent, 4, along, 15, n, m, v);
            for (int j = 0; j < 4 && !fell; j++) /* a fallback may look at distances */
                worst = fmax(worst, fabs((double)w[j] - (double)v[j]) / (1 + (double)exponent));
        }
    }
    check_at_most(r, worst, 1e-7, "weights with p = x against s = n, per exponent");
    return NCR_OK;
}
