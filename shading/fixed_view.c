/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Cook82]  R. Cook, K. Torrance, A Reflectance Model for Computer Graphics, 1982
 *   [Walter07]  B. Walter, S. Marschner, H. Li, K. Torrance, Microfacet Models for Refraction
 *               through Rough Surfaces, 2007
 *   [C]         B. Cabral, M. Olano, P. Nemec, Reflection Space Image Based Rendering, 1999
 *   [Dutt93]  A. Dutt, V. Rokhlin, Fast Fourier Transforms for Nonequispaced Data, 1993 */
#include "shading/fixed_view.h"

#include "shading/brdf_internal.h"
#include "shading/fixed_view_internal.h"
#include "shading/prefilter_internal.h"

#include <math.h>
#include <string.h>

/* Half-vectors turn a lobe whose shape depends on the normal into D, which does not: D(n.h) has the
 * same detail everywhere, exp(-alpha l) at degree l. So half-vectors and normals stand on grids
 * just fine enough for D, and each texel is shared out among the 8 x 8 grid places around its own
 * half-vector by the weights that would give D there from its values at those places. That is exact
 * for whatever light there is; only D must be smooth.
 *
 * Shadowing is not, at grazing: V-cavities rise and fall between v.h = n.v/2 and 2 n.v. So another
 * 52 rows crowd toward the horizon, x / 16 apart at x = 0.025 from it and 5e-4 at its foot. */

static const double pi = 3.14159265358979323846;
static const double detail = 11; /* degrees worth having, times alpha: exp(-11) = 2e-5 */
static const double horizon_at = 0.025, horizon_rows = 52; /* see below */
enum { fewest_degrees = 64 };

/* --- tables ----------------------------------------------------------------------------------- */

typedef struct table_job {
    ncr_fixed_view *fixed;
    ncr_fixed_view_ring_fn *ring; /* NULL: the gloss of `fixed`, which is even in the azimuth */
    const void *user;
    ncr_row_set set;   /* of one normal's ring: data and spectrum by worker */
    const float *lift; /* [width/2 + 1] 1 - cos of the azimuth */
    float *row_work;   /* [workers][row_floats] */
    size_t row_floats, data_floats, spectrum_floats;
} table_job;

/* The inverse of ncr_grid_row at a row's middle: x from x + b x / (x + at) = u, a quadratic. */
double ncr_fixed_view_polar_angle(const ncr_fixed_view *f, uint32_t row)
{
    const double b = (double)f->grid.bend, at = (double)f->grid.bend_at;
    const double u = (f->rows - row - 0.5) / (double)f->grid.per_radian, p = u - at - b;
    const double root = sqrt(p * p + 4 * u * at);
    return 0.5 * pi - (p > 0 ? 0.5 * (p + root) : 2 * u * at / (root - p));
}

static ncr_facet_ring ring_of(const ncr_fixed_view *f, uint32_t row_n, uint32_t row_h)
{
    const ncr_microfacet *m = &f->gloss.facets;
    const double n = ncr_fixed_view_polar_angle(f, row_n);
    const double h = ncr_fixed_view_polar_angle(f, row_h);
    return (ncr_facet_ring){
        .beckmann = m->facets == NCR_FACETS_BECKMANN,
        .cavity = m->shadowing == NCR_SHADOWING_VCAVITY,
        .alpha = (float)m->alpha,
        .v_h = (float)cos(h),
        .n_v = (float)cos(n),
        .near = (float)(2 * pow(sin(0.5 * (n - h)), 2)),
        .across = (float)(sin(n) * sin(h)),
        .fresnel = (float)ncr_fresnel_eval(&f->gloss.fresnel, cos(h)),
        .spread_v = (float)ncr_microfacet_spread(m, cos(n)),
    };
}

/* The same in double, for the pair of D and G that has no fast loop: Beckmann with Smith. */
static void exact_row(const ncr_microfacet *m, const ncr_facet_ring *ring, size_t count,
                      const float *lift, float *out)
{
    const double v_h = (double)ring->v_h, n_v = (double)ring->n_v;
    for (size_t k = 0; k < count; k++) {
        const double gap = (double)ring->near + (double)ring->across * (double)lift[k];
        const double n_h = 1 - gap, n_l = 2 * v_h * n_h - n_v;
        const double h[3] = {sqrt(fmax(0, gap * (1 + n_h))), 0, n_h};
        out[k] = n_l > 0 && n_h > 0
                     ? (float)((double)ring->fresnel * 0.25 * ncr_microfacet_normals(m, h) *
                               ncr_microfacet_shadow(m, n_v, n_l, n_h, v_h))
                     : 0;
    }
}

/* Reflectance from every half-vector to a normal at azimuth 0: [row of h][width], even. */
static void fill_ring(const table_job *job, uint32_t row_n, float *data)
{
    const ncr_fixed_view *f = job->fixed;
    const ncr_microfacet *m = &f->gloss.facets;
    const bool exact = m->facets == NCR_FACETS_BECKMANN && m->shadowing == NCR_SHADOWING_SMITH;
    const uint32_t w = f->width, half = w / 2 + 1;
    for (uint32_t j = 0; j < f->rows; j++) {
        float *row = data + (size_t)j * w;
        const ncr_facet_ring ring = ring_of(f, row_n, j);
        if (exact)
            exact_row(m, &ring, half, job->lift, row);
        else
            ncr_sht_kernels_get()->facet_row(&ring, half, job->lift, row);
        for (uint32_t k = half; k < w; k++)
            row[k] = row[w - k];
    }
}

/* The matrix rows of one ring of normals: the cosine (part 0) or sine (1) series of its data, over
 * width. */
static void store_ring(const table_job *job, uint32_t row_n, int part, const ncr_row_set *set)
{
    const ncr_fixed_view *f = job->fixed;
    const float scale = (part ? -0.5f : 0.5f) / (float)f->width;
    float *out = (part ? f->odd : f->matrix) + (size_t)row_n * f->orders * f->padded;
    for (uint32_t m = 0; m < f->orders; m++, out += f->padded) {
        const float *sum = set->spectrum + ((size_t)m * 4 + (size_t)part) * set->padded;
        const float *difference = sum + 2 * (size_t)set->padded;
        memset(out, 0, f->padded * sizeof *out);
        for (uint32_t q = 0; q < set->pairs; q++) {
            out[q] = scale * (sum[q] + difference[q]);
            out[f->rows - 1 - q] = scale * (sum[q] - difference[q]);
        }
    }
}

static void fill_matrix(size_t first, size_t past, unsigned worker, void *arg)
{
    const table_job *job = arg;
    const ncr_sht_kernels *kernels = ncr_sht_kernels_get();
    float *work = job->row_work + worker * job->row_floats;
    ncr_row_set set = job->set;
    set.data = work;
    set.spectrum = work + job->data_floats;
    for (size_t i = first; i < past; i++) {
        if (job->ring)
            job->ring(job->fixed, (uint32_t)i, job->user, set.data);
        else
            fill_ring(job, (uint32_t)i, set.data);
        for (uint32_t q = 0; q < set.pairs; q += kernels->lanes)
            kernels->rows_to_spectrum(&set, q, work + job->data_floats + job->spectrum_floats);
        store_ring(job, (uint32_t)i, 0, &set);
        if (job->fixed->odd)
            store_ring(job, (uint32_t)i, 1, &set);
    }
}

ncr_row_set ncr_fixed_view_rows(const ncr_fixed_view *f, uint32_t channels)
{
    const uint32_t pairs = (f->rows + 1) / 2;
    return (ncr_row_set){.rows = f->rows,
                         .width = f->width,
                         .channels = channels,
                         .pairs = pairs,
                         .padded = (pairs + NCR_WIDEST - 1) / NCR_WIDEST * NCR_WIDEST,
                         .orders = f->orders,
                         .fft = &f->fft};
}

size_t ncr_fixed_view_spectrum(const ncr_row_set *set)
{
    return (size_t)set->orders * 4 * set->channels * set->padded;
}

ncr_status ncr_fixed_view_tabulate(const ncr_ctx *ctx, ncr_fixed_view *f,
                                   ncr_fixed_view_ring_fn *ring, const void *user)
{
    const unsigned workers = ncr_ctx_workers(ctx);
    const uint32_t half = f->width / 2 + 1;
    table_job job = {.fixed = f, .ring = ring, .user = user, .set = ncr_fixed_view_rows(f, 1)};
    job.data_floats = (size_t)f->rows * f->width;
    job.spectrum_floats = ncr_fixed_view_spectrum(&job.set);
    job.row_floats = job.data_floats + job.spectrum_floats + ncr_row_scratch(&job.set);
    float *lift = ncr_alloc(ctx, half * sizeof *lift);
    job.row_work = ncr_alloc(ctx, workers * job.row_floats * sizeof(float));
    ncr_status status = NCR_E_NOMEM;
    if (lift && job.row_work) {
        for (uint32_t k = 0; k < half; k++)
            lift[k] = (float)(2 * pow(sin(pi * k / f->width), 2));
        job.lift = lift;
        status = ncr_parallel_for(ctx, f->rows, 1, fill_matrix, &job);
    }
    ncr_free(ctx, lift);
    ncr_free(ctx, job.row_work);
    return status;
}

ncr_status ncr_fixed_view_grid(const ncr_ctx *ctx, double alpha, bool odd, ncr_fixed_view *f)
{
    const double degrees = fmax(fewest_degrees, ceil(detail / alpha));
    f->orders = (uint32_t)degrees + 1;
    f->rows = (uint32_t)(ceil(1.5 * degrees) + horizon_rows);
    f->padded = (f->rows + NCR_WIDEST - 1) / NCR_WIDEST * NCR_WIDEST;
    f->width = 2 * ncr_fft_smooth_above((uint32_t)(3 * degrees));
    const size_t entries = (size_t)f->rows * f->orders * f->padded;
    f->matrix = ncr_alloc(ctx, entries * sizeof *f->matrix);
    f->odd = odd ? ncr_alloc(ctx, entries * sizeof *f->odd) : NULL;
    f->weights = ncr_alloc(ctx, (NCR_GRID_WIDE_FLOATS + NCR_GRID_TALL_FLOATS) * sizeof *f->weights);
    if (!f->weights || !f->matrix || (odd && !f->odd))
        return NCR_E_NOMEM;
    ncr_grid_weights_fill(f->weights);
    const double bend = horizon_rows * pi / (3 * degrees);
    const double length = 0.5 * pi * (1 + bend / (0.5 * pi + horizon_at));
    f->grid = (ncr_sphere_grid){.width = f->width,
                                .per_radian = (float)(f->rows / length),
                                .bend = (float)bend,
                                .bend_at = (float)horizon_at,
                                .stride = ((size_t)f->width + 2 * NCR_GRID_BORDER) * 4,
                                .wide = f->weights,
                                .tall = f->weights + NCR_GRID_WIDE_FLOATS};
    return ncr_fft_init(ctx, f->width, &f->fft);
}

static ncr_status make_tables(const ncr_ctx *ctx, ncr_fixed_view *f)
{
    const ncr_status status = ncr_fixed_view_grid(ctx, f->gloss.facets.alpha, false, f);
    return status ? status : ncr_fixed_view_tabulate(ctx, f, NULL, NULL);
}

ncr_status ncr_fixed_view_create(const ncr_ctx *ctx, const ncr_gloss *gloss, ncr_fixed_view **out)
{
    const double alpha = gloss->facets.alpha;
    *out = NULL;
    if (!(alpha > 0 && alpha <= 4))
        return ncr_fail(ctx, NCR_E_ARG, "a microfacet roughness of %g: above 0, at most 4", alpha);
    ncr_fixed_view *f = ncr_alloc_zero(ctx, 1, sizeof *f);
    if (!f)
        return NCR_E_NOMEM;
    f->gloss = *gloss;
    f->sharp = alpha < NCR_FIXED_VIEW_SHARP;
    const ncr_status status = f->sharp ? NCR_OK : make_tables(ctx, f);
    if (status)
        ncr_fixed_view_destroy(ctx, f);
    else
        *out = f;
    return status;
}

void ncr_fixed_view_destroy(const ncr_ctx *ctx, ncr_fixed_view *f)
{
    if (!f)
        return;
    ncr_fft_dispose(ctx, &f->fft);
    ncr_free(ctx, f->matrix);
    ncr_free(ctx, f->odd);
    ncr_free(ctx, f->weights);
    ncr_free(ctx, f);
}
