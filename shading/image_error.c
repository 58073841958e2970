/* SPDX-License-Identifier: MIT */
#include "shading/image_error.h"

#include "core/numerics.h"
#include "shading/cielab_internal.h"

#include <math.h>

/* This file follows:
 *   [Neumaier74]  A. Neumaier. Rundungsfehleranalyse einiger Verfahren zur Summation. 1974 */

enum { block_pixels = 4096 }; /* fixed, so that no sum depends on the number of workers */

/* What one block of pixels, or a tree of blocks, adds up to. */
typedef struct tally {
    uint64_t pixels, nonfinite, steps;
    ncr_sum linear[3], lab[3], clipped[3], gradient, flip;
    double max_jump, max_abs;
} tally;

typedef struct comparison {
    const ncr_image *reference, *image;
    const uint8_t *mask;
    const float *flip; /* NULL: not wanted */
    double exposure;
    tally *blocks;
} comparison;

/* A pixel of both images after exposure and clip. */
typedef struct shown {
    double reference[3], image[3];
} shown;

static bool is_counted(const comparison *c, size_t pixel)
{
    return (!c->mask || c->mask[pixel]) && ncr_all_finite_f(c->reference->data + 3 * pixel, 3) &&
           ncr_all_finite_f(c->image->data + 3 * pixel, 3);
}

static double clip(double x)
{
    return fmin(fmax(x, 0.0), 1.0);
}

static shown show(const comparison *c, size_t pixel)
{
    shown s;
    for (int k = 0; k < 3; k++) {
        s.reference[k] = clip(c->exposure * c->reference->data[3 * pixel + (size_t)k]);
        s.image[k] = clip(c->exposure * c->image->data[3 * pixel + (size_t)k]);
    }
    return s;
}

static void add_square(ncr_sum *sum, double x)
{
    ncr_sum_add(sum, x * x);
}

static void add_colour(const comparison *c, size_t pixel, const shown *s, tally *t)
{
    double lab_reference[3], lab_image[3];
    ncr_lab_from_rgb(s->reference, lab_reference);
    ncr_lab_from_rgb(s->image, lab_image);
    for (size_t k = 0; k < 3; k++) {
        const double difference =
            (double)c->image->data[3 * pixel + k] - c->reference->data[3 * pixel + k];
        add_square(&t->linear[k], difference);
        add_square(&t->clipped[k], s->image[k] - s->reference[k]);
        add_square(&t->lab[k], lab_image[k] - lab_reference[k]);
        t->max_abs = fmax(t->max_abs, fabs(difference));
    }
}

/* The step to a neighbour, when that counts too: a visible seam is a step of the image that the
 * reference does not make. */
static void add_step(const comparison *c, const shown *here, size_t neighbour, tally *t)
{
    if (!is_counted(c, neighbour))
        return;
    const shown there = show(c, neighbour);
    const double image = ncr_luminance(there.image) - ncr_luminance(here->image);
    const double reference = ncr_luminance(there.reference) - ncr_luminance(here->reference);
    add_square(&t->gradient, image - reference);
    t->max_jump = fmax(t->max_jump, fabs(image) - fabs(reference));
    t->steps++;
}

static void add_pixel(const comparison *c, size_t pixel, tally *t)
{
    if (c->mask && !c->mask[pixel])
        return;
    if (!is_counted(c, pixel)) {
        t->nonfinite++;
        return;
    }
    const size_t width = c->image->width;
    const shown here = show(c, pixel);
    t->pixels++;
    add_colour(c, pixel, &here, t);
    if ((pixel + 1) % width != 0)
        add_step(c, &here, pixel + 1, t);
    if (pixel + width < width * c->image->height)
        add_step(c, &here, pixel + width, t);
    if (c->flip)
        ncr_sum_add(&t->flip, c->flip[pixel]);
}

static void tally_block(size_t begin, size_t end, unsigned worker, void *arg)
{
    const comparison *c = arg;
    tally t = {0};
    (void)worker;
    for (size_t pixel = begin; pixel < end; pixel++)
        add_pixel(c, pixel, &t);
    c->blocks[begin / block_pixels] = t;
}

static void merge_sum(ncr_sum *a, const ncr_sum *b)
{
    ncr_sum_add(a, b->sum);
    ncr_sum_add(a, b->error);
}

static void merge(tally *a, const tally *b)
{
    a->pixels += b->pixels;
    a->nonfinite += b->nonfinite;
    a->steps += b->steps;
    for (int k = 0; k < 3; k++) {
        merge_sum(&a->linear[k], &b->linear[k]);
        merge_sum(&a->lab[k], &b->lab[k]);
        merge_sum(&a->clipped[k], &b->clipped[k]);
    }
    merge_sum(&a->gradient, &b->gradient);
    merge_sum(&a->flip, &b->flip);
    a->max_jump = fmax(a->max_jump, b->max_jump);
    a->max_abs = fmax(a->max_abs, b->max_abs);
}

/* A binary tree over the blocks, whose shape depends on their count alone. Root in blocks[0]. */
static void merge_blocks(tally *blocks, size_t count)
{
    for (size_t stride = 1; stride < count; stride *= 2)
        for (size_t k = 0; k + stride < count; k += 2 * stride)
            merge(&blocks[k], &blocks[k + stride]);
}

static double root_mean(const ncr_sum *sum, uint64_t count)
{
    return count ? sqrt(ncr_sum_value(sum) / (double)count) : 0.0;
}

static ncr_image_error summarise(const tally *t)
{
    ncr_image_error e = {.pixels = t->pixels, .nonfinite = t->nonfinite};
    for (int k = 0; k < 3; k++) {
        e.rmse[k] = root_mean(&t->linear[k], t->pixels);
        e.rmse_lab[k] = root_mean(&t->lab[k], t->pixels);
        e.rmse_clipped[k] = root_mean(&t->clipped[k], t->pixels);
    }
    e.gradient_rmse = root_mean(&t->gradient, t->steps);
    e.max_jump = t->max_jump;
    e.max_abs = t->max_abs;
    e.flip = t->pixels ? ncr_sum_value(&t->flip) / (double)t->pixels : 0.0;
    return e;
}

static ncr_status check(const ncr_ctx *ctx, const ncr_image *reference, const ncr_image *image,
                        const ncr_image_error_opts *opts)
{
    if (opts && opts->struct_size != sizeof *opts)
        return ncr_fail(ctx, NCR_E_ARG, "image comparison: options without their size");
    if (opts && !(opts->exposure >= 0 && isfinite(opts->exposure)))
        return ncr_fail(ctx, NCR_E_ARG, "image comparison: an exposure of %g", opts->exposure);
    if (reference->channels != 3 || image->channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "image comparison: %u and %u channels, both must have 3",
                        reference->channels, image->channels);
    if (reference->width != image->width || reference->height != image->height)
        return ncr_fail(ctx, NCR_E_ARG, "image comparison: %ux%u pixels against %ux%u",
                        reference->width, reference->height, image->width, image->height);
    return NCR_OK;
}

static ncr_status run(const ncr_ctx *ctx, comparison *c, ncr_image_error *out)
{
    const size_t pixels = (size_t)c->image->width * c->image->height;
    const size_t blocks = (pixels + block_pixels - 1) / block_pixels;
    c->blocks = ncr_alloc_zero(ctx, blocks, sizeof *c->blocks);
    if (!c->blocks)
        return NCR_E_NOMEM;
    const ncr_status status = ncr_parallel_for(ctx, pixels, block_pixels, tally_block, c);
    if (status == NCR_OK) {
        merge_blocks(c->blocks, blocks);
        *out = summarise(&c->blocks[0]);
    }
    ncr_free(ctx, c->blocks);
    return status;
}

ncr_status ncr_image_compare(const ncr_ctx *ctx, const ncr_image *reference, const ncr_image *image,
                             const uint8_t *mask, const ncr_image_error_opts *opts,
                             ncr_image_error *out)
{
    ncr_status status = check(ctx, reference, image, opts);
    if (status != NCR_OK)
        return status;
    comparison c = {
        .reference = reference,
        .image = image,
        .mask = mask,
        .exposure = opts && opts->exposure > 0 ? opts->exposure : 1.0,
    };
    float *flip = NULL;
    if (!opts || !opts->flip_off) {
        flip = ncr_alloc(ctx, (size_t)image->width * image->height * sizeof *flip);
        if (!flip)
            return NCR_E_NOMEM;
        status = ncr_image_flip(ctx, reference, image, opts ? opts->pixels_per_degree : 0, flip);
        c.flip = flip;
    }
    if (status == NCR_OK)
        status = run(ctx, &c, out);
    ncr_free(ctx, flip);
    return status;
}
