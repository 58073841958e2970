/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [H]             W. Heidrich. Environment Maps And Their Applications. Tutorial, 2000
 *   [KautzMcCool00] J. Kautz, M. McCool. Approximation of Glossy Reflection with Prefiltered
 *                   Environment Maps. Graphics Interface, 2000 */
#include "shading/lobe_sum_internal.h"

#include "core/vec_internal.h"
#include "shading/quadrature_internal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

double ncr_gloss_eval(const double v[3], const double l[3], const void *user)
{
    const ncr_gloss *gloss = user;
    const double f = ncr_microfacet_eval(&gloss->facets, v, l);
    if (!(f > 0))
        return 0;
    const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
    return f * ncr_fresnel_eval(&gloss->fresnel, fmin(1, d_dot(v, h) / d_length(h)));
}

/* --- views and directions --------------------------------------------------------------------- */

static const double grazing = 1e-3; /* n.v of the first view */

double ncr_lobe_sum_view(uint32_t i, uint32_t views)
{
    const double t = (double)i / (views - 1);
    return fmax(t * t, grazing);
}

/* A ball seen from afar shows n.v with density 2 n.v; t^2 = n.v. */
double ncr_lobe_sum_share(uint32_t i, uint32_t views)
{
    const double t = (double)i / (views - 1);
    return t * t * t * (i + 1 == views ? 0.5 : 1);
}

/* Gauss's nodes in z = u / (u + bend): close to r as fine as the lobe, and out to its back. */
void ncr_lobe_grid_init(double width, ncr_lobe_grid *grid)
{
    double node[NCR_LOBE_RINGS], weight[NCR_LOBE_RINGS];
    const double bend = fmin(width * width, 1), last = 2 / (2 + bend);
    ncr_gauss_legendre(NCR_LOBE_RINGS, node, weight);
    for (int k = 0; k < NCR_LOBE_RINGS; k++) {
        const double z = 0.5 * last * (1 + node[k]);
        grid->u[k] = bend * z / (1 - z);
        grid->area[k] =
            2 * pi / NCR_LOBE_SPOKES * 0.5 * last * weight[k] * bend / ((1 - z) * (1 - z));
    }
}

/* Half a turn of midpoints: the BRDF is the same on both sides of the plane of incidence. */
void ncr_lobe_grid_direction(const ncr_lobe_grid *grid, int ring, int spoke, double d[3])
{
    const double u = grid->u[ring], s = sqrt(u * (2 - u));
    const double phi = pi * (spoke + 0.5) / NCR_LOBE_SPOKES;
    d[0] = s * cos(phi);
    d[1] = s * sin(phi);
    d[2] = 1 - u;
}

/* From the frame of r (x toward n) to that of the surface, v in the half plane x < 0. */
static void to_surface(double c, const double d[3], double l[3])
{
    const double s = sqrt((1 - c) * (1 + c));
    l[0] = s * d[2] - c * d[0];
    l[1] = d[1];
    l[2] = c * d[2] + s * d[0];
}

static double reflect_toward(const ncr_reflectance *brdf, double c, const double d[3])
{
    const double v[3] = {-sqrt((1 - c) * (1 + c)), 0, c};
    double l[3];
    to_surface(c, d, l);
    return l[2] > 0 ? brdf->eval(v, l, brdf->user) : 0;
}

void ncr_lobe_grid_eval(const ncr_lobe_grid *grid, const ncr_reflectance *brdf, double c,
                        double *out)
{
    for (int i = 0; i < NCR_LOBE_RINGS; i++)
        for (int j = 0; j < NCR_LOBE_SPOKES; j++) {
            double d[3];
            ncr_lobe_grid_direction(grid, i, j, d);
            out[i * NCR_LOBE_SPOKES + j] = reflect_toward(brdf, c, d);
        }
}

/* --- lobes by table --------------------------------------------------------------------------- */

/* Catmull and Rom's cubic between the nodes, without falling below 0. */
static double table_value(double u, void *user)
{
    const ncr_lobe_table *t = user;
    const double at = u / (u + t->bend) * (2 + t->bend) / 2 * (NCR_LOBE_NODES - 1);
    const int i = at < NCR_LOBE_NODES - 2 ? (int)at : NCR_LOBE_NODES - 2;
    const double x = at - i, *v = t->value;
    const double b = v[i], c = v[i + 1];
    const double before = i > 0 ? v[i - 1] : c; /* even in the angle */
    const double after = i + 2 < NCR_LOBE_NODES ? v[i + 2] : c;
    const double value =
        b + 0.5 * x *
                (c - before +
                 x * (2 * before - 5 * b + 4 * c - after + x * (3 * (b - c) + after - before)));
    return value > 0 ? value : 0;
}

/* The mean over turns about r: of all symmetric lobes the nearest one.              [H 18, 19] */
static void fill_table(const ncr_reflectance *brdf, double c, ncr_lobe_table *t)
{
    enum { spokes = 96 };
    for (int k = 0; k < NCR_LOBE_NODES; k++) {
        const double u = fmin(ncr_lobe_table_u(t, k), 2), s = sqrt(u * (2 - u));
        double sum = 0;
        for (int j = 0; j < spokes; j++) {
            const double phi = pi * (j + 0.5) / spokes;
            const double d[3] = {s * cos(phi), s * sin(phi), 1 - u};
            sum += reflect_toward(brdf, c, d);
        }
        t->value[k] = sum / spokes;
    }
}

typedef struct tabulation {
    const ncr_reflectance *brdf;
    const ncr_lobe_grid *grid;
    uint32_t views;
    ncr_lobe_table *table; /* [views] */
    double *values;        /* [views][rings][spokes] */
} tabulation;

static void tabulate_views(size_t begin, size_t end, unsigned worker, void *arg)
{
    const tabulation *job = arg;
    (void)worker;
    for (size_t i = begin; i < end; i++) {
        const double c = ncr_lobe_sum_view((uint32_t)i, job->views);
        fill_table(job->brdf, c, &job->table[i]);
        ncr_lobe_grid_eval(job->grid, job->brdf, c,
                           job->values + i * NCR_LOBE_RINGS * NCR_LOBE_SPOKES);
    }
}

static ncr_lobe lobe_of(ncr_lobe_table *table, double width)
{
    return (ncr_lobe){.kind = NCR_LOBE_CUSTOM, .value = table_value, .user = table, .width = width};
}

/* int k over the sphere: the directional albedo of what the table is the mean of. */
static ncr_status find_albedos(const ncr_ctx *ctx, const tabulation *job, double *albedo)
{
    double most = 0;
    for (uint32_t i = 0; i < job->views; i++) {
        const ncr_lobe lobe = lobe_of(&job->table[i], job->brdf->width);
        double lambda, highest = 0;
        for (int k = 0; k < NCR_LOBE_NODES; k++)
            highest = fmax(highest, job->table[i].value[k]);
        albedo[i] = 0;
        if (!isfinite(highest))
            return ncr_fail(ctx, NCR_E_ARG, "a BRDF that is not finite");
        if (highest > 0) {
            const ncr_status status =
                ncr_lobe_eigenvalues(ctx, &lobe, 0, &lambda, &albedo[i], NULL);
            if (status != NCR_OK)
                return status;
        }
        most = fmax(most, albedo[i]);
    }
    return most > 0 ? NCR_OK : ncr_fail(ctx, NCR_E_ARG, "a BRDF that is nowhere above 0");
}

/* --- the forms -------------------------------------------------------------------------------- */

/* One lobe: the mean of all, each brought to albedo 1 and weighted as a ball shows it. */
static void average(const tabulation *job, const double *albedo, ncr_lobe_sum *sum)
{
    double total = 0;
    ncr_lobe_table mean = {.bend = job->table[0].bend};
    for (uint32_t i = 0; i < job->views; i++) {
        const double share = albedo[i] > 0 ? ncr_lobe_sum_share(i, job->views) : 0;
        for (int k = 0; k < NCR_LOBE_NODES && share > 0; k++)
            mean.value[k] += share * job->table[i].value[k] / albedo[i];
        total += share;
    }
    for (int k = 0; k < NCR_LOBE_NODES; k++)
        sum->table[0].value[k] = mean.value[k] / total;
    sum->table[0].bend = mean.bend;
    sum->terms = sum->lobes = 1;
    for (uint32_t i = 0; i < job->views; i++)
        sum->weight[i][0] = albedo[i];
}

/* A lobe for each view. One that reflects nothing takes its neighbour's shape, and no weight. */
static void keep_all(const tabulation *job, const double *albedo, ncr_lobe_sum *sum)
{
    uint32_t whole = 0;
    while (albedo[whole] == 0)
        whole++;
    sum->terms = sum->lobes = job->views;
    for (uint32_t i = 0; i < job->views; i++) {
        whole = albedo[i] > 0 ? i : whole;
        sum->table[i] = job->table[whole];
        sum->term_lobe[i] = i;
        sum->weight[i][i] = albedo[i];
    }
}

/* cos of the angle between direction d of the grid and an axis tilted toward n. */
static double cosine_to(const double d[3], double tilt)
{
    return d[2] * cos(tilt) + d[0] * sin(tilt);
}

static double value_toward(const ncr_lobe_sum *sum, const double *weight, const double *integral,
                           const double d[3])
{
    double value = 0;
    for (uint32_t j = 0; j < sum->terms; j++)
        if (weight[j] > 0) {
            const uint32_t k = sum->term_lobe[j];
            const double u = fmax(0, 1 - cosine_to(d, sum->tilt[j]));
            value += weight[j] * ncr_lobe_value(&sum->lobe[k], u) / integral[k];
        }
    return value;
}

/* Root mean square over the sphere, relative: of all views, and of the worst. */
static ncr_status measure(const ncr_ctx *ctx, const tabulation *job, ncr_lobe_sum *sum)
{
    double integral[NCR_LOBE_TERMS], lambda, all = 0, all_size = 0;
    for (uint32_t k = 0; k < sum->lobes; k++) {
        const ncr_status status =
            ncr_lobe_eigenvalues(ctx, &sum->lobe[k], 0, &lambda, &integral[k], NULL);
        if (status != NCR_OK)
            return status;
    }
    sum->worst = 0;
    for (uint32_t i = 0; i < sum->views; i++) {
        const double *values = job->values + (size_t)i * NCR_LOBE_RINGS * NCR_LOBE_SPOKES;
        double error = 0, size = 0;
        for (int a = 0; a < NCR_LOBE_RINGS; a++)
            for (int b = 0; b < NCR_LOBE_SPOKES; b++) {
                double d[3];
                ncr_lobe_grid_direction(job->grid, a, b, d);
                const double want = values[a * NCR_LOBE_SPOKES + b];
                const double off = value_toward(sum, sum->weight[i], integral, d) - want;
                error += job->grid->area[a] * off * off;
                size += job->grid->area[a] * want * want;
            }
        if (size > 0)
            sum->worst = fmax(sum->worst, sqrt(error / size));
        if (size > 0) {
            const double share = ncr_lobe_sum_share(i, sum->views);
            all += share * error / size;
            all_size += share;
        }
    }
    sum->error = sqrt(all / all_size);
    return NCR_OK;
}

static ncr_status fit(const ncr_ctx *ctx, const ncr_reflectance *brdf, uint32_t most,
                      ncr_lobe_sum *sum)
{
    ncr_lobe_grid grid;
    double albedo[NCR_LOBE_VIEWS];
    const size_t directions = NCR_LOBE_RINGS * NCR_LOBE_SPOKES;
    tabulation job = {.brdf = brdf, .grid = &grid, .views = sum->views};
    ncr_lobe_grid_init(brdf->width, &grid);
    job.table = ncr_alloc(ctx, sum->views * sizeof *job.table);
    job.values = ncr_alloc(ctx, sum->views * directions * sizeof *job.values);
    ncr_status status = job.table && job.values ? NCR_OK : NCR_E_NOMEM;
    for (uint32_t i = 0; status == NCR_OK && i < sum->views; i++)
        job.table[i].bend = fmin(brdf->width * brdf->width, 1);
    if (status == NCR_OK)
        status = ncr_parallel_for(ctx, sum->views, 1, tabulate_views, &job);
    if (status == NCR_OK)
        status = find_albedos(ctx, &job, albedo);
    if (status == NCR_OK && sum->form == NCR_LOBES_TILTED)
        status = ncr_lobe_sum_fit_tilted(ctx, brdf->width, &grid, job.values, albedo, most, sum);
    if (status == NCR_OK && sum->form == NCR_LOBES_AVERAGED)
        average(&job, albedo, sum);
    if (status == NCR_OK && sum->form == NCR_LOBES_BY_ANGLE)
        keep_all(&job, albedo, sum);
    for (uint32_t k = 0; status == NCR_OK && sum->table && k < sum->lobes; k++)
        sum->lobe[k] = lobe_of(&sum->table[k], brdf->width);
    if (status == NCR_OK)
        status = measure(ctx, &job, sum);
    ncr_free(ctx, job.table);
    ncr_free(ctx, job.values);
    return status;
}

ncr_status ncr_lobe_sum_fit(const ncr_ctx *ctx, const ncr_reflectance *brdf,
                            const ncr_lobe_sum_opts *opts, ncr_lobe_sum **out)
{
    *out = NULL;
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_lobe_sum_opts without its size");
    const ncr_lobe_sum_opts o = opts ? *opts : (ncr_lobe_sum_opts){0};
    const uint32_t views = o.views ? o.views : 16, terms = o.terms ? o.terms : 10;
    if (!(brdf->width > 0 && brdf->width <= pi))
        return ncr_fail(ctx, NCR_E_ARG, "a BRDF %g radians wide", brdf->width);
    if (views < 4 || views > NCR_LOBE_VIEWS || terms > NCR_LOBE_TERMS)
        return ncr_fail(ctx, NCR_E_ARG, "%u views, %u terms: 4 to 64, and up to 64", views, terms);
    ncr_lobe_sum *sum = ncr_alloc_zero(ctx, 1, sizeof *sum);
    if (!sum)
        return NCR_E_NOMEM;
    sum->form = o.form;
    sum->views = views;
    ncr_status status = NCR_OK;
    if (o.form != NCR_LOBES_TILTED) {
        sum->table = ncr_alloc_zero(ctx, views, sizeof *sum->table);
        status = sum->table ? NCR_OK : NCR_E_NOMEM;
    }
    if (status == NCR_OK)
        status = fit(ctx, brdf, terms, sum);
    if (status != NCR_OK) {
        ncr_lobe_sum_destroy(ctx, sum);
        return status;
    }
    *out = sum;
    return NCR_OK;
}

void ncr_lobe_sum_destroy(const ncr_ctx *ctx, ncr_lobe_sum *sum)
{
    if (!sum)
        return;
    ncr_free(ctx, sum->table);
    ncr_free(ctx, sum);
}

ncr_lobe_sum_info ncr_lobe_sum_info_get(const ncr_lobe_sum *sum)
{
    return (ncr_lobe_sum_info){sum->terms, sum->lobes, sum->error, sum->worst};
}

ncr_lobe ncr_lobe_sum_lobe(const ncr_lobe_sum *sum, uint32_t k)
{
    return sum->lobe[k];
}

uint32_t ncr_lobe_sum_terms(const ncr_lobe_sum *sum, double c, ncr_lobe_term *terms)
{
    const double at = sqrt(fmin(fmax(c, 0), 1)) * (sum->views - 1);
    const uint32_t i = at < sum->views - 2 ? (uint32_t)at : sum->views - 2;
    const double x = at - i;
    uint32_t count = 0;
    for (uint32_t j = 0; j < sum->terms; j++) {
        const double w = (1 - x) * sum->weight[i][j] + x * sum->weight[i + 1][j];
        if (w > 0)
            terms[count++] = (ncr_lobe_term){sum->term_lobe[j], sum->tilt[j], w};
    }
    return count;
}
