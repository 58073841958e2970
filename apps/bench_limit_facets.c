/* SPDX-License-Identifier: MIT
 * bench_limit_facets.c - Cook and Torrance's reflectance summed over every texel: Beckmann's facets,
 * V-shaped cavities, everything that does not depend on the normal known beforehand. Apart from
 * shading/facet_kernel_internal.h on purpose: a limit shares no code with what it is the limit of. */
#include "apps/bench_limit_kernels.h"
#include "apps/bench_limit_texels.h"

#include <string.h>

/* e^x for x <= 0 to 3e-7, in operations that go abreast. */
BENCH_INLINE float exp_of(float x)
{
    const float magic = 12582912.0f, y = x < -87.0f ? -87.0f : x;
    const float i = (y * 1.44269504f + magic) - magic;
    const float r = (y - i * 0.693359375f) + i * 2.12194440e-4f;
    const float p =
        1.0f +
        r * (1.0f +
             r * (0.5f + r * (1.6666667e-1f +
                              r * (4.1665795e-2f + r * (8.3334519e-3f + r * 1.3981999e-3f)))));
    const uint32_t bits = (uint32_t)((int32_t)i + 127) << 23;
    float power;
    memcpy(&power, &bits, sizeof power);
    return p * power;
}

void BENCH_KERNEL(bench_facets)(const bench_facet_texels *t, float alpha, float n_v,
                                const float n[3], float out[3])
{
    const float x = n[0], y = n[1], z = n[2], a2 = alpha * alpha, one_v = 1 / n_v;
    const float *hx = t->h[0], *hy = t->h[1], *hz = t->h[2], *vh = t->v_h, *one_vh = t->one_v_h;
    const float *r = t->rgb[0], *g = t->rgb[1], *b = t->rgb[2];
    float sr = 0, sg = 0, sb = 0;
#pragma omp simd reduction(+ : sr, sg, sb)
    for (size_t k = 0; k < t->count; k++) {
        const float n_h = x * hx[k] + y * hy[k] + z * hz[k], n_l = 2 * vh[k] * n_h - n_v;
        const float lit = ((n_l > 0) & (n_h > 0)) ? 1.0f : 0.0f, h2 = n_h * n_h + (1 - lit);
        const float one = 1 / (h2 * a2), d = exp_of((h2 - 1) * one) * one / h2;
        const float seen = 2 * n_h * one_vh[k];
        const float in = seen < one_v ? seen : one_v, away = seen * n_l * one_v;
        const float f = lit * d * (in < away ? in : away);
        sr += f * r[k];
        sg += f * g[k];
        sb += f * b[k];
    }
    out[0] = sr;
    out[1] = sg;
    out[2] = sb;
}
