/* SPDX-License-Identifier: MIT
 * fft_kernel_internal.h - the passes of a Fourier transform, LANES rows abreast. Element i is
 * LANES real parts and then LANES imaginary parts at x + 2 LANES i. */
#ifndef NCR_SHADING_FFT_KERNEL_INTERNAL_H
#define NCR_SHADING_FFT_KERNEL_INTERNAL_H

#include "shading/harmonics_kernel_internal.h"
#include "shading/wide_internal.h"

/* y_k = sum_j x_j e^{s 2 pi i j k / r}, in place, for r = 2, 3, 4, 5. */
ALWAYS void butterfly(const int r, const float s, vf re[], vf im[])
{
    if (r == 2) {
        const vf a = re[0], b = im[0];
        re[0] = a + re[1], im[0] = b + im[1];
        re[1] = a - re[1], im[1] = b - im[1];
    } else if (r == 3) {
        const vf half = vf_all(-0.5f), h = vf_all(s * 0.866025404f);
        const vf pr = re[1] + re[2], pi = im[1] + im[2];
        const vf dr = h * (re[1] - re[2]), di = h * (im[1] - im[2]);
        const vf cr = vf_mad(half, pr, re[0]), ci = vf_mad(half, pi, im[0]);
        re[0] += pr, im[0] += pi;
        re[1] = cr - di, im[1] = ci + dr;
        re[2] = cr + di, im[2] = ci - dr;
    } else if (r == 4) {
        const vf ar = re[0] + re[2], ai = im[0] + im[2];
        const vf br = re[0] - re[2], bi = im[0] - im[2];
        const vf cr = re[1] + re[3], ci = im[1] + im[3];
        const vf sign = vf_all(s);
        const vf dr = sign * (re[1] - re[3]), di = sign * (im[1] - im[3]);
        re[0] = ar + cr, im[0] = ai + ci;
        re[2] = ar - cr, im[2] = ai - ci;
        re[1] = br - di, im[1] = bi + dr;
        re[3] = br + di, im[3] = bi - dr;
    } else {
        const vf c1 = vf_all(0.309016994f), c2 = vf_all(-0.809016994f);
        const vf s1 = vf_all(s * 0.951056516f), s2 = vf_all(s * 0.587785252f);
        const vf p1r = re[1] + re[4], p1i = im[1] + im[4];
        const vf p2r = re[2] + re[3], p2i = im[2] + im[3];
        const vf m1r = re[1] - re[4], m1i = im[1] - im[4];
        const vf m2r = re[2] - re[3], m2i = im[2] - im[3];
        const vf ar = vf_mad(c1, p1r, vf_mad(c2, p2r, re[0]));
        const vf ai = vf_mad(c1, p1i, vf_mad(c2, p2i, im[0]));
        const vf br = vf_mad(c2, p1r, vf_mad(c1, p2r, re[0]));
        const vf bi = vf_mad(c2, p1i, vf_mad(c1, p2i, im[0]));
        const vf er = vf_mad(s1, m1r, s2 * m2r), ei = vf_mad(s1, m1i, s2 * m2i);
        const vf fr = s2 * m1r - s1 * m2r, fi = s2 * m1i - s1 * m2i;
        re[0] += p1r + p2r, im[0] += p1i + p2i;
        re[1] = ar - ei, im[1] = ai + er;
        re[4] = ar + ei, im[4] = ai - er;
        re[2] = br - fi, im[2] = bi + fr;
        re[3] = br + fi, im[3] = bi - fr;
    }
}

/* Points 1 .. r-1 by their roots: as stored (forward), or conjugate (s > 0). */
ALWAYS void twiddle(const int r, const float s, const float *root, vf re[], vf im[])
{
    for (int k = 1; k < r; k++) {
        const vf c = vf_all(root[2 * k - 2]), w = vf_all(-s * root[2 * k - 1]);
        const vf a = re[k], b = im[k];
        re[k] = vf_mad(c, a, -(w * b));
        im[k] = vf_mad(c, b, w * a);
    }
}

ALWAYS void one_block(const int r, const float s, uint32_t q, const float *root, float *x)
{
    for (uint32_t j = 0; j < q; j++, root += 2 * (r - 1), x += 2 * LANES) {
        vf re[5], im[5];
        for (int k = 0; k < r; k++) {
            re[k] = vf_load(x + (size_t)k * q * 2 * LANES);
            im[k] = vf_load(x + (size_t)k * q * 2 * LANES + LANES);
        }
        if (s > 0 && q > 1)
            twiddle(r, s, root, re, im);
        butterfly(r, s, re, im);
        if (s < 0 && q > 1)
            twiddle(r, s, root, re, im);
        for (int k = 0; k < r; k++) {
            vf_store(x + (size_t)k * q * 2 * LANES, re[k]);
            vf_store(x + (size_t)k * q * 2 * LANES + LANES, im[k]);
        }
    }
}

ALWAYS void one_pass(const ncr_fft *fft, uint32_t pass, const float s, float *x)
{
    const uint32_t q = fft->block[pass] / fft->radix[pass];
    const float *root = fft->roots + fft->twiddle[pass];
    switch (fft->radix[pass]) {
    case 2:
        one_block(2, s, q, root, x);
        break;
    case 3:
        one_block(3, s, q, root, x);
        break;
    case 4:
        one_block(4, s, q, root, x);
        break;
    default:
        one_block(5, s, q, root, x);
    }
}

/* Depth first, so that blocks which fit a cache stay in it until they are done. */
static void fft_forward(const ncr_fft *fft, uint32_t pass, float *x)
{
    if (pass == fft->passes)
        return;
    const uint32_t r = fft->radix[pass], q = fft->block[pass] / r;
    one_pass(fft, pass, -1.0f, x);
    for (uint32_t k = 0; q > 1 && k < r; k++)
        fft_forward(fft, pass + 1, x + (size_t)k * q * 2 * LANES);
}

static void fft_backward(const ncr_fft *fft, uint32_t pass, float *x)
{
    if (pass == fft->passes)
        return;
    const uint32_t r = fft->radix[pass], q = fft->block[pass] / r;
    for (uint32_t k = 0; q > 1 && k < r; k++)
        fft_backward(fft, pass + 1, x + (size_t)k * q * 2 * LANES);
    one_pass(fft, pass, 1.0f, x);
}

#endif
