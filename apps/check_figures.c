/* SPDX-License-Identifier: MIT
 * check_figures.c - the figures errors are told in.                                 [S-71, S-73] */
#include "apps/check.h"

#include <math.h>
#include <string.h>

ncr_status check_cielab(check_run *r)
{
    static const double known[][2] = {{1, 100}, {0.18, 49.49610729}, {10, 233.91434}, {0, 0}};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++) {
        const double y = known[k][0];
        double lab[3];
        ncr_lab_from_rgb((const double[3]){y, y, y}, lab);
        const double off = fmax(fabs(lab[0] - known[k][1]), fmax(fabs(lab[1]), fabs(lab[2])));
        check_at_most(r, off, 1e-4, "grey of Y = %g, from L* = %.4f, a* = b* = 0", y, known[k][1]);
    }
    double worst = 0;
    for (uint32_t k = 0; k < 20000; k++) {
        double rgb[3], lab[3], back[3];
        for (uint32_t c = 0; c < 3; c++)
            rgb[c] = ncr_uniform(k, c) * (k % 2 ? 1 : 0.02);
        ncr_lab_from_rgb(rgb, lab);
        ncr_lab_to_rgb(lab, back);
        for (uint32_t c = 0; c < 3; c++)
            worst = fmax(worst, fabs(back[c] - rgb[c]));
    }
    check_at_most(r, worst, 1e-10, "there and back, 20000 colours");
    return NCR_OK;
}

enum { wide = 301, high = 203 };

static ncr_status compare(const ncr_ctx *ctx, unsigned workers, const ncr_image *a,
                          const ncr_image *b, ncr_image_error *out)
{
    ncr_ctx many = *ctx;
    many.workers = workers;
    memset(out, 0, sizeof *out);
    return ncr_image_compare(&many, a, b, NULL, NULL, out);
}

/* Values over eight orders, so that sums in another order have other bits. */
static void fill(ncr_image *image, uint64_t key)
{
    for (uint64_t k = 0; k < 3 * wide * high; k++)
        image->data[k] = (float)pow(10, 8 * ncr_uniform(k, key) - 5);
}

ncr_status check_reductions(check_run *r)
{
    static const unsigned workers[] = {2, 3, 7, 16, 64};
    ncr_image a = {0}, b = {0};
    ncr_image_error one, many;
    ncr_status status = ncr_image_init(r->ctx, wide, high, 3, &a);
    if (status == NCR_OK)
        status = ncr_image_init(r->ctx, wide, high, 3, &b);
    if (status == NCR_OK) {
        fill(&a, 1);
        fill(&b, 2);
        status = compare(r->ctx, 1, &a, &b, &one);
    }
    for (size_t k = 0; k < sizeof workers / sizeof workers[0] && status == NCR_OK; k++) {
        status = compare(r->ctx, workers[k], &a, &b, &many);
        if (status == NCR_OK)
            check_at_most(r, memcmp(&one, &many, sizeof one) != 0, 0, "%u workers differ from one",
                          workers[k]);
    }
    ncr_image_dispose(r->ctx, &a);
    ncr_image_dispose(r->ctx, &b);
    return status;
}
