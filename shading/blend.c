/* SPDX-License-Identifier: MIT */
#include "shading/blend.h"

#include "core/vec_internal.h"
#include "shading/blend_internal.h"

#include <assert.h>
#include <math.h>

/* This file follows:
 *   [T]   J. Ang. Offset Surface Light Fields. MMath thesis, University of Waterloo, 2003 */

/* Cosine between a unit axis and each offset; `alone` for an offset of length zero, which has no
 * direction and counts as lying along the normal.                                      [S-13] */
static void cosines(unsigned count, const ncr_vec3 *to_point, ncr_vec3 axis, float alone,
                    float *cosine)
{
    for (unsigned j = 0; j < count; j++) {
        ncr_vec3 p = to_point[j];
        float square = v_dot(p, p);
        if (!(square >= ncr_blend_square_min && square <= ncr_blend_square_max)) {
            const float largest = fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z)));
            int exponent = 0;
            if (largest > 0 && largest <= 3.4e38f)
                (void)frexpf(largest, &exponent);
            p = v_make(ldexpf(p.x, -exponent), ldexpf(p.y, -exponent), ldexpf(p.z, -exponent));
            square = v_dot(p, p);
        }
        const float c = v_dot(axis, p) / sqrtf(square);
        cosine[j] = square == 0 ? alone : c;
    }
}

static float power(float q, float exponent)
{
    if (!ncr_blend_squares(exponent))
        return powf(q, exponent);
    float result = 1;
    for (unsigned e = (unsigned)exponent; e; e >>= 1, q *= q)
        if (e & 1)
            result *= q;
    return result;
}

static unsigned put_all_on(unsigned count, unsigned chosen, float *weight)
{
    for (unsigned j = 0; j < count; j++)
        weight[j] = j == chosen;
    return 0;
}

/* Index of the largest valid value, the lowest on ties; `count` when none is valid. */
static unsigned largest_of(unsigned count, const float *value, unsigned valid)
{
    unsigned best = count;
    for (unsigned j = 0; j < count; j++)
        if (valid >> j & 1 && (best == count || value[j] > value[best]))
            best = j;
    return best;
}

/* Scale to a sum of one, in whole multiples of 2^-24: floats of that kind add without rounding,
 * so the sum is exactly one in any order. What rounding takes or leaves, a few 2^-24, goes to
 * the largest weight, which is at least 1/16.                                       [S-12] */
static void normalise(unsigned count, float *weight)
{
    float sum = 0, others = 0;
    for (unsigned j = 0; j < count; j++)
        sum += weight[j];
    const unsigned big = largest_of(count, weight, ~0u);
    const float scale = 0x1p24f / sum;
    for (unsigned j = 0; j < count; j++) {
        weight[j] = rintf(weight[j] * scale) * 0x1p-24f;
        others += j == big ? 0 : weight[j];
    }
    weight[big] = 1 - others;
}

/* B_j = max(c_j, 0)^N / sum                                                     [T 4.10] [T 4.11]
 *
 * The thesis prints max(c^N, 0), which for even N lets points behind the axis in [E-01]; and
 * c_j >= 0 is not given for 4.11 away from the texel's centre [E-02]. Each cosine is taken
 * relative to the largest before the power, so one term is 1 and the sum cannot vanish:
 * 0.0872^64 alone is zero in float.                                                    [S-12] */
static bool powers(unsigned count, const float *cosine, unsigned valid, float exponent,
                   float *weight)
{
    float largest = 0;
    for (unsigned j = 0; j < count; j++)
        if (valid >> j & 1 && cosine[j] > largest)
            largest = cosine[j];
    if (!(largest > ncr_blend_cosine_min))
        return false;
    const float scale = 1 / largest;

    for (unsigned j = 0; j < count; j++) {
        const bool counts = valid >> j & 1 && cosine[j] > 0;
        weight[j] = counts ? power(cosine[j] * scale, exponent) : 0;
    }
    normalise(count, weight);
    return true;
}

static bool inverse_distances(unsigned count, const ncr_vec3 *to_point, unsigned valid,
                              float *weight)
{
    float closest = INFINITY;
    for (unsigned j = 0; j < count; j++) {
        weight[j] = hypotf(hypotf(to_point[j].x, to_point[j].y), to_point[j].z);
        if (valid >> j & 1 && weight[j] < closest)
            closest = weight[j];
    }
    if (!(closest > 0 && closest < INFINITY))
        return false;
    for (unsigned j = 0; j < count; j++)
        weight[j] = valid >> j & 1 && weight[j] >= closest ? closest / weight[j] : 0;
    normalise(count, weight);
    return true;
}

/* What is left when the basis is zero at every valid point.                            [S-12] */
static unsigned fall_back(unsigned count, const ncr_vec3 *to_point, unsigned valid, ncr_vec3 n,
                          float *weight)
{
    float cosine[NCR_BLEND_MAX];
    cosines(count, to_point, n, 1, cosine);
    if (powers(count, cosine, valid, 4, weight))
        return NCR_BLEND_COSINE_N4;
    if (inverse_distances(count, to_point, valid, weight))
        return NCR_BLEND_INVERSE;
    put_all_on(count, (unsigned)__builtin_ctz(valid), weight);
    return NCR_BLEND_NEAREST;
}

static void average(unsigned count, unsigned valid, float *weight)
{
    for (unsigned j = 0; j < count; j++)
        weight[j] = (float)(valid >> j & 1);
    normalise(count, weight);
}

unsigned ncr_blend_weights(ncr_basis basis, float exponent, unsigned count,
                           const ncr_vec3 *to_point, unsigned valid, ncr_vec3 n, ncr_vec3 r,
                           float *weight)
{
    assert(count <= NCR_BLEND_MAX && exponent >= 0);

    valid &= (1u << count) - 1;
    if (!valid) {
        put_all_on(count, count, weight);
        return NCR_BLEND_NONE;
    }
    if (basis == NCR_BASIS_DISTANCE)
        return put_all_on(count, (unsigned)__builtin_ctz(valid), weight);
    if (basis == NCR_BASIS_AVERAGE || (basis != NCR_BASIS_ANGLE && exponent == 0)) {
        average(count, valid, weight);
        return 0;
    }

    const bool about_n = basis == NCR_BASIS_COSINE_N;
    float cosine[NCR_BLEND_MAX];
    cosines(count, to_point, about_n ? n : r, about_n ? 1 : v_dot(n, r), cosine);
    if (basis == NCR_BASIS_ABS_R)
        for (unsigned j = 0; j < count; j++)
            cosine[j] = fabsf(cosine[j]);

    const unsigned best = largest_of(count, cosine, valid);
    if (basis == NCR_BASIS_ANGLE || (isinf(exponent) && cosine[best] > 0))
        return put_all_on(count, best, weight);
    if (isinf(exponent) || !powers(count, cosine, valid, exponent, weight))
        return fall_back(count, to_point, valid, n, weight);
    return 0;
}
