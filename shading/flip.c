/* SPDX-License-Identifier: MIT */
#include "shading/flip_internal.h"
#include "shading/image_error.h"

#include <string.h>

/* This file follows:
 *   [Andersson20]  P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom,
 *                  M. D. Fairchild. FLIP: A Difference Evaluator for Alternating Images. 2020
 *   [Andersson21]  P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Moller. Visualizing Errors in
 *                  Rendered High Dynamic Range Images. 2021
 *
 * An image is handled in bands of rows, exposure by exposure. Within a band, rows stream through a
 * ring just tall enough for the vertical filters, so the working set stays in the cache. */

enum { band_rows = 64 };

/* The horizontally filtered rows that the vertical filters still need. */
enum plane {
    plane_achromatic,
    plane_red_green,
    plane_blue_yellow,
    plane_blue_yellow_2,
    plane_smooth,
    plane_edge,
    plane_point,
    planes
};

/* The rows that are compared: L*, a*, b*, edge, point, and one to spare. */
enum { seen_rows = 6 };

/* One image's rows in one worker's scratch. */
typedef struct lane {
    const ncr_image *image;
    float *opponent[3]; /* one row each, with replicated margins of the largest radius */
    float *ring;        /* [planes][2 radius + 1][stride] */
    float *seen;        /* [seen_rows][stride] */
} lane;

typedef struct job {
    ncr_flip_filters filters;
    ncr_flip_exposures exposures;
    const ncr_image *images[2]; /* reference, image */
    size_t stride;              /* floats in a padded row */
    size_t scratch_floats;      /* of one worker */
    float *scratch, *error;
} job;

static size_t ring_rows(const job *j)
{
    return 2 * (size_t)j->filters.radius + 1;
}

static size_t lane_floats(const job *j)
{
    const size_t margins = 2 * (size_t)j->filters.radius;
    return 3 * (j->stride + margins) + (planes * ring_rows(j) + seen_rows) * j->stride;
}

static lane make_lane(const job *j, int image, float *at)
{
    lane l = {.image = j->images[image]};
    for (int k = 0; k < 3; k++, at += j->stride + 2 * (size_t)j->filters.radius)
        l.opponent[k] = at;
    l.ring = at;
    l.seen = at + planes * ring_rows(j) * j->stride;
    return l;
}

static float *ring_row(const job *j, const lane *l, enum plane plane, size_t y)
{
    return l->ring + ((size_t)plane * ring_rows(j) + y % ring_rows(j)) * j->stride;
}

/* Repeat the first and last pixel over `radius` more; past them the padding keeps its zeros. */
static void replicate_margins(float *row, size_t width, size_t radius)
{
    for (size_t k = 0; k < radius; k++) {
        row[k] = row[radius];
        row[radius + width + k] = row[radius + width - 1];
    }
}

static void filter_across(const job *j, const float *row, const ncr_flip_taps *taps, float *out)
{
    const float *shifted[2 * ncr_flip_radius_max + 1];
    for (int k = 0; k <= 2 * taps->radius; k++)
        shifted[k] = row + j->filters.radius - taps->radius + k;
    ncr_flip_convolve(j->stride, taps, shifted, false, out);
}

/* Rows above the first and below the last repeat them. */
static void filter_down(const job *j, const lane *l, enum plane plane, size_t y,
                        const ncr_flip_taps *taps, bool add, float *out)
{
    const float *rows[2 * ncr_flip_radius_max + 1];
    const ptrdiff_t last = (ptrdiff_t)l->image->height - 1;
    for (int k = 0; k <= 2 * taps->radius; k++) {
        ptrdiff_t from = (ptrdiff_t)y + k - taps->radius;
        from = from < 0 ? 0 : from > last ? last : from;
        rows[k] = ring_row(j, l, plane, (size_t)from);
    }
    ncr_flip_convolve(j->stride, taps, rows, add, out);
}

/* Bring row y into the ring. */
static void feed(const job *j, const lane *l, size_t y, float factor)
{
    const ncr_flip_filters *f = &j->filters;
    const size_t width = l->image->width, radius = (size_t)f->radius;
    ncr_flip_opponents(width, ncr_image_at(l->image, 0, (uint32_t)y), factor,
                       l->opponent[0] + radius, l->opponent[1] + radius, l->opponent[2] + radius);
    for (int k = 0; k < 3; k++)
        replicate_margins(l->opponent[k], width, radius);
    filter_across(j, l->opponent[0], &f->achromatic, ring_row(j, l, plane_achromatic, y));
    filter_across(j, l->opponent[1], &f->red_green, ring_row(j, l, plane_red_green, y));
    filter_across(j, l->opponent[2], &f->blue_yellow[0], ring_row(j, l, plane_blue_yellow, y));
    filter_across(j, l->opponent[2], &f->blue_yellow[1], ring_row(j, l, plane_blue_yellow_2, y));
    filter_across(j, l->opponent[0], &f->smooth, ring_row(j, l, plane_smooth, y));
    filter_across(j, l->opponent[0], &f->edge, ring_row(j, l, plane_edge, y));
    filter_across(j, l->opponent[0], &f->point, ring_row(j, l, plane_point, y));
}

/* The taps of a filter times its share of the sum of two. */
static ncr_flip_taps scaled(const ncr_flip_taps *taps, float share)
{
    ncr_flip_taps out = *taps;
    for (int k = 0; k <= 2 * taps->radius; k++)
        out.weight[k] *= share;
    return out;
}

/* Finish row y: colour and features. */
static ncr_flip_seen look(const job *j, const lane *l, size_t y)
{
    const ncr_flip_filters *f = &j->filters;
    const size_t n = j->stride;
    float *s[seen_rows];
    for (size_t k = 0; k < seen_rows; k++)
        s[k] = l->seen + k * n;

    const ncr_flip_taps by = scaled(&f->blue_yellow[0], f->blue_yellow_share[0]);
    const ncr_flip_taps by_2 = scaled(&f->blue_yellow[1], f->blue_yellow_share[1]);
    filter_down(j, l, plane_achromatic, y, &f->achromatic, false, s[0]);
    filter_down(j, l, plane_red_green, y, &f->red_green, false, s[1]);
    filter_down(j, l, plane_blue_yellow, y, &by, false, s[2]);
    filter_down(j, l, plane_blue_yellow_2, y, &by_2, true, s[2]);
    ncr_flip_hunt_lab(n, s[0], s[1], s[2]);

    filter_down(j, l, plane_edge, y, &f->smooth, false, s[3]);
    filter_down(j, l, plane_smooth, y, &f->edge, false, s[5]);
    ncr_flip_magnitude(n, s[3], s[5]);
    filter_down(j, l, plane_point, y, &f->smooth, false, s[4]);
    filter_down(j, l, plane_smooth, y, &f->point, false, s[5]);
    ncr_flip_magnitude(n, s[4], s[5]);
    return (ncr_flip_seen){.lab = {s[0], s[1], s[2]}, .edge = s[3], .point = s[4]};
}

static void compare_band(const job *j, const lane lanes[2], size_t begin, size_t end, float factor)
{
    const size_t width = j->images[0]->width, height = j->images[0]->height;
    const size_t radius = (size_t)j->filters.radius;
    size_t fed = begin > radius ? begin - radius : 0;
    for (size_t y = begin; y < end; y++) {
        for (; fed < height && fed <= y + radius; fed++)
            for (int k = 0; k < 2; k++)
                feed(j, &lanes[k], fed, factor);
        const ncr_flip_seen reference = look(j, &lanes[0], y), image = look(j, &lanes[1], y);
        ncr_flip_difference(width, &reference, &image, j->error + y * width);
    }
}

static void run_band(size_t begin, size_t end, unsigned worker, void *arg)
{
    const job *j = arg;
    float *scratch = j->scratch + worker * j->scratch_floats;
    const lane lanes[2] = {make_lane(j, 0, scratch), make_lane(j, 1, scratch + lane_floats(j))};
    for (int k = 0; k < j->exposures.count; k++)
        compare_band(j, lanes, begin, end, ncr_flip_exposure_factor(&j->exposures, k));
}

static ncr_status check(const ncr_ctx *ctx, const ncr_image *reference, const ncr_image *image,
                        double pixels_per_degree)
{
    if (reference->channels != 3 || image->channels != 3 || reference->width != image->width ||
        reference->height != image->height)
        return ncr_fail(ctx, NCR_E_ARG, "FLIP: needs two RGB images of one size");
    if (!(pixels_per_degree >= 0 && pixels_per_degree <= ncr_flip_pixels_per_degree_max))
        return ncr_fail(ctx, NCR_E_ARG, "FLIP: %g pixels per degree (0 to %d)", pixels_per_degree,
                        ncr_flip_pixels_per_degree_max);
    return NCR_OK;
}

ncr_status ncr_image_flip(const ncr_ctx *ctx, const ncr_image *reference, const ncr_image *image,
                          double pixels_per_degree, float *out)
{
    ncr_status status = check(ctx, reference, image, pixels_per_degree);
    if (status != NCR_OK)
        return status;
    const size_t multiple = ncr_flip_row_multiple, height = image->height;
    job j = {
        .filters = ncr_flip_make_filters(pixels_per_degree > 0 ? pixels_per_degree : 67.0),
        .images = {reference, image},
        .stride = (image->width + multiple - 1) / multiple * multiple,
        .error = out,
    };
    status = ncr_flip_find_exposures(ctx, reference, &j.exposures);
    if (status != NCR_OK)
        return status;
    j.scratch_floats = 2 * lane_floats(&j);
    j.scratch = ncr_alloc_zero(ctx, ncr_ctx_workers(ctx), j.scratch_floats * sizeof(float));
    if (!j.scratch)
        return NCR_E_NOMEM;
    memset(out, 0, height * image->width * sizeof *out);
    status = ncr_parallel_for(ctx, height, band_rows, run_band, &j);
    ncr_free(ctx, j.scratch);
    return status;
}
