/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Cooley65]  J. Cooley, J. Tukey, An Algorithm for the Machine Calculation of Complex Fourier
 *               Series, 1965
 *   [Gentleman66]  W. Gentleman, G. Sande, Fast Fourier Transforms: for Fun and Profit, 1966 */
#include "shading/fft_internal.h"

#include <assert.h>
#include <math.h>

/* Decimation in frequency: pass k splits each block into `radix` blocks of q = block/radix points,
 * block j of them holding the frequencies that are j modulo radix. The order in which frequencies
 * end up costs nothing, because whoever reads them looks them up one at a time. */

static const double two_pi = 6.28318530717958647693;

static uint32_t without_small_factors(uint32_t n)
{
    static const uint32_t primes[] = {2, 3, 5};
    for (size_t k = 0; k < sizeof primes / sizeof *primes; k++)
        while (n % primes[k] == 0)
            n /= primes[k];
    return n;
}

bool ncr_fft_smooth(uint32_t n)
{
    return n > 0 && without_small_factors(n) == 1;
}

uint32_t ncr_fft_smooth_above(uint32_t n)
{
    n = n > 0 ? n : 1;
    while (!ncr_fft_smooth(n))
        n++;
    return n;
}

/* Fours first, where they save most passes over memory. */
static uint32_t next_radix(uint32_t n)
{
    return n % 4 == 0 ? 4 : n % 2 == 0 ? 2 : n % 3 == 0 ? 3 : 5;
}

static uint32_t plan_passes(ncr_fft *fft)
{
    uint32_t floats = 0;
    for (uint32_t left = fft->n; left > 1; left /= fft->radix[fft->passes++]) {
        const uint32_t r = next_radix(left), k = fft->passes;
        fft->radix[k] = r;
        fft->block[k] = left;
        fft->twiddle[k] = floats;
        floats += left / r * (r - 1) * 2;
    }
    return floats;
}

static void fill_roots(ncr_fft *fft)
{
    float *root = fft->roots;
    for (uint32_t pass = 0; pass < fft->passes; pass++) {
        const uint32_t r = fft->radix[pass], n = fft->block[pass];
        for (uint32_t j = 0; j < n / r; j++) {
            for (uint32_t k = 1; k < r; k++) {
                const double angle = -two_pi * ((double)j * k / n);
                *root++ = (float)cos(angle);
                *root++ = (float)sin(angle);
            }
        }
    }
}

/* The mixed-radix digits of m, first pass's digit first, are the steps to its place. */
static uint32_t place_of(const ncr_fft *fft, uint32_t m)
{
    uint32_t at = 0;
    for (uint32_t pass = 0; pass < fft->passes; pass++) {
        const uint32_t r = fft->radix[pass];
        at += m % r * (fft->block[pass] / r);
        m /= r;
    }
    return at;
}

ncr_status ncr_fft_init(const ncr_ctx *ctx, uint32_t n, ncr_fft *out)
{
    assert(ncr_fft_smooth(n));
    ncr_fft fft = {.n = n};
    const uint32_t floats = plan_passes(&fft);
    *out = (ncr_fft){0};
    fft.roots = ncr_alloc(ctx, (floats + 1) * sizeof *fft.roots);
    fft.place = ncr_alloc(ctx, n * sizeof *fft.place);
    if (!fft.roots || !fft.place) {
        ncr_fft_dispose(ctx, &fft);
        return NCR_E_NOMEM;
    }
    fill_roots(&fft);
    for (uint32_t m = 0; m < n; m++)
        fft.place[m] = place_of(&fft, m);
    *out = fft;
    return NCR_OK;
}

void ncr_fft_dispose(const ncr_ctx *ctx, ncr_fft *fft)
{
    ncr_free(ctx, fft->roots);
    ncr_free(ctx, fft->place);
    *fft = (ncr_fft){0};
}
