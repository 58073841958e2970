/* SPDX-License-Identifier: MIT
 * facet_kernel_internal.h - microfacet reflectance for many azimuths at once, in float. */
#ifndef NCR_SHADING_FACET_KERNEL_INTERNAL_H
#define NCR_SHADING_FACET_KERNEL_INTERNAL_H

#include "shading/harmonics_kernel_internal.h"

#include <math.h>
#include <string.h>

/* e^x for x <= 0, relative error below 3e-7; 0 below -87. A polynomial, so that loops of it are as
 * wide as the processor. */
ALWAYS float exp_of(float x)
{
    const float magic = 12582912.0f; /* 1.5 2^23: adding it rounds to an integer */
    const float y = x < -87.0f ? -87.0f : x;
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
    return x < -87.0f ? 0 : p * power;
}

/* F D G / (4 n.v) for half-vectors of one ring against normals of one ring, `count` azimuths apart
 * by delta_k with lift[k] = 1 - cos delta_k.
 *     1 - n.h = near + across lift,   n.l = 2 (v.h) (n.h) - n.v */
ALWAYS void facet_loop(const bool beckmann, const bool cavity, const ncr_facet_ring *ring,
                       size_t count, const float *lift, float *out)
{
    const float a2 = ring->alpha * ring->alpha, v_h = ring->v_h, n_v = ring->n_v;
    const float scale = ring->fresnel * 0.0795774715f; /* 1 / 4 pi */
    for (size_t k = 0; k < count; k++) {
        const float gap = ring->near + ring->across * lift[k], n_h = 1 - gap;
        const float s2 = gap * (1 + n_h), c2 = n_h * n_h, n_l = 2 * v_h * n_h - n_v;
        const bool lit = (n_l > 0) & (n_h > 0);
        const float l = lit ? n_l : 1, h = lit ? n_h : 1, h2 = lit ? c2 : 1;
        float d, shadow;
        if (beckmann) {
            d = exp_of(-s2 / (h2 * a2)) / (a2 * h2 * h2);
        } else {
            const float q = s2 + a2 * h2;
            d = a2 / (q * q);
        }
        if (cavity) {
            const float seen = 2 * h * l < v_h ? 2 * h * l / (v_h * n_v) : 1 / n_v;
            const float faced = 2 * h / v_h;
            shadow = seen < faced ? seen : faced;
        } else {
            shadow = 2 * l / (l * ring->spread_v + n_v * sqrtf(l * l + a2 * (1 - l) * (1 + l)));
        }
        out[k] = lit ? scale * d * shadow : 0;
    }
}

static void facet_row(const ncr_facet_ring *ring, size_t count, const float *lift, float *out)
{
    if (ring->beckmann)
        facet_loop(true, true, ring, count, lift, out);
    else if (ring->cavity)
        facet_loop(false, true, ring, count, lift, out);
    else
        facet_loop(false, false, ring, count, lift, out);
}

#endif
