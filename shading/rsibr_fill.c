/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "shading/rsibr_internal.h"

#include "core/vec_internal.h"
#include "shading/prefilter.h"

#include <math.h>
#include <string.h>

/* A lobe's mean of light for every normal of every eye. With the light goes a fourth channel that is
 * 1 everywhere: what a filter makes of it is the albedo, by the very sums that make the rest. */

typedef struct fill_job {
    const ncr_ctx *ctx;
    const ncr_directional_map *env;
    ncr_rsibr *set;
    uint32_t lobe, map;         /* and its first map */
    ncr_image light;            /* lat-long along the world's axes: rgb, 1 */
    ncr_directional_map coarse; /* for mirrors: no finer than their texels call for */
    ncr_prefilter_grid *grid;
    ncr_fixed_view *fixed;
    float *mean; /* [size][size][4] of the eye at hand */
    ncr_vec3 *normal;
    uint32_t view;
} fill_job;

/* --- the light --------------------------------------------------------------------------------- */

static ncr_status as_latlong(const ncr_ctx *ctx, const ncr_directional_map *env,
                             ncr_directional_map *out)
{
    const bool same = env->kind == NCR_MAP_LATLONG;
    const uint32_t size = same || env->kind == NCR_MAP_SPHERE ? env->size
                          : env->size < NCR_MAP_SIZE_MAX / 2  ? 2 * env->size
                                                              : NCR_MAP_SIZE_MAX;
    ncr_status status =
        ncr_directional_map_init(ctx, NCR_MAP_LATLONG, size, env->image.channels, out);
    if (status == NCR_OK)
        status = ncr_directional_map_convert(ctx, env, out);
    if (status != NCR_OK)
        ncr_directional_map_dispose(ctx, out);
    return status;
}

/* Mean side of a texel in radians. */
static double texel_side(const ncr_directional_map *map)
{
    return sqrt(4 * 3.14159265358979323846 / map->image.width / map->image.height);
}

/* The light for mirrors, halved while two of its texels still fit into one of a map, which has
 * 16 / size^2 steradians. Halving keeps what there is of light, of a sun too. */
static ncr_status make_coarse(fill_job *job)
{
    uint32_t size = job->env->size;
    while (size > 1 && texel_side(job->env) * job->env->size / (size / 2) < 2.0 / job->set->size)
        size /= 2;
    ncr_directional_map_dispose(job->ctx, &job->coarse);
    ncr_status status = ncr_directional_map_init(job->ctx, job->env->kind, size, 3, &job->coarse);
    job->coarse.axes = job->env->axes;
    if (status == NCR_OK)
        status = ncr_directional_map_shrink(job->ctx, job->env, &job->coarse);
    return status;
}

static ncr_status make_light(fill_job *job)
{
    ncr_directional_map map;
    ncr_status status = as_latlong(job->ctx, job->env, &map);
    if (status != NCR_OK)
        return status;
    status = ncr_image_init(job->ctx, map.image.width, map.image.height, 4, &job->light);
    const size_t texels = (size_t)map.image.width * map.image.height;
    for (size_t k = 0; status == NCR_OK && k < texels; k++) {
        memcpy(job->light.data + 4 * k, map.image.data + 3 * k, 3 * sizeof(float));
        job->light.data[4 * k + 3] = 1;
    }
    ncr_directional_map_dispose(job->ctx, &map);
    return status;
}

/* --- lobes ------------------------------------------------------------------------------------- */

static double through_coat(double u, void *user)
{
    const double c = 1 - u;
    return c > 0 ? c * (1 - ncr_fresnel_eval(user, c)) : 0;
}

static ncr_status make_grid(fill_job *job)
{
    ncr_rsibr_lobe *lobe = &job->set->brdf.lobe[job->lobe];
    ncr_lobe kernel = {.kind = NCR_LOBE_LAMBERT};
    if (lobe->kind == NCR_RSIBR_PHONG)
        kernel = (ncr_lobe){.kind = NCR_LOBE_PHONG, .parameter = lobe->exponent};
    else if (lobe->kind == NCR_RSIBR_COATED)
        kernel = (ncr_lobe){.kind = NCR_LOBE_CUSTOM,
                            .value = through_coat,
                            .user = &lobe->coat,
                            .support = 0.5 * 3.14159265358979323846};
    ncr_prefilter *prefilter;
    ncr_status status = ncr_prefilter_create(
        job->ctx, &job->light, NCR_OPTS(ncr_prefilter_opts, .sharpest = &kernel), &prefilter);
    if (status == NCR_OK)
        status = ncr_prefilter_grid_create(job->ctx, prefilter, &kernel, NULL, &job->grid, NULL);
    ncr_prefilter_destroy(job->ctx, prefilter);
    return status;
}

/* Albedo by cosine: the fourth channel, seen from above at as many slants. */
static ncr_status make_table(fill_job *job)
{
    float *table = ncr_rsibr_table(job->set, job->lobe);
    float out[NCR_RSIBR_TABLE][4];
    ncr_vec3 normal[NCR_RSIBR_TABLE];
    for (int k = 0; k < NCR_RSIBR_TABLE; k++) {
        const double c = ncr_rsibr_table_cosine(k);
        normal[k] = v_make((float)sqrt(1 - c * c), 0, (float)c);
    }
    const ncr_status status = ncr_fixed_view_render(job->ctx, job->fixed, &job->light,
                                                    v_make(0, 0, 1), NCR_RSIBR_TABLE, normal, *out);
    for (int k = 0; status == NCR_OK && k < NCR_RSIBR_TABLE; k++)
        table[k] = out[k][3];
    return status;
}

static ncr_status open_lobe(fill_job *job)
{
    const ncr_rsibr_lobe *lobe = &job->set->brdf.lobe[job->lobe];
    if (lobe->kind == NCR_RSIBR_MIRROR)
        return make_coarse(job);
    if (lobe->kind != NCR_RSIBR_GLOSS)
        return make_grid(job);
    const ncr_status status = ncr_fixed_view_create(job->ctx, &lobe->gloss, &job->fixed);
    return status == NCR_OK ? make_table(job) : status;
}

static void close_lobe(fill_job *job)
{
    ncr_prefilter_grid_destroy(job->ctx, job->grid);
    ncr_fixed_view_destroy(job->ctx, job->fixed);
    job->grid = NULL;
    job->fixed = NULL;
}

/* --- one eye ----------------------------------------------------------------------------------- */

static const ncr_rsibr_frame *frame_at(const fill_job *job)
{
    return &job->set->frame[job->view];
}

static void mirrored(const double own[3], void *user, float *out)
{
    const fill_job *job = user;
    const ncr_rsibr_frame *f = frame_at(job);
    double d[3];
    for (int i = 0; i < 3; i++)
        d[i] = own[0] * f->axis[0][i] + own[1] * f->axis[1][i] + own[2] * f->axis[2][i];
    ncr_directional_map_look_up(&job->coarse, d, out);
    for (int i = 0; i < 3; i++)
        out[i] = isfinite(out[i]) ? out[i] : 0;
}

/* A sphere map in the eye's own axes is what a mirror ball shows. */
static ncr_status fill_mirror(fill_job *job)
{
    const uint32_t n = job->set->size;
    ncr_directional_map ball;
    ncr_status status = ncr_directional_map_init(job->ctx, NCR_MAP_SPHERE, n, 3, &ball);
    if (status == NCR_OK)
        status = ncr_directional_map_fill(job->ctx, &ball, 0.5 * texel_side(&job->coarse), mirrored,
                                          job);
    for (size_t k = 0; status == NCR_OK && k < (size_t)n * n; k++) {
        memcpy(job->mean + 4 * k, ball.image.data + 3 * k, 3 * sizeof(float));
        job->mean[4 * k + 3] = 1;
    }
    ncr_directional_map_dispose(job->ctx, &ball);
    return status;
}

static double place(uint32_t k, uint32_t size)
{
    return 2 * (k + 0.5) / size - 1;
}

/* The directions that one row of texels asks for. Normals at grazing, whose albedo vanishes, stand
 * in for those a little farther out. */
static void find_row(const fill_job *job, uint32_t y, ncr_vec3 *out)
{
    static const double grazing = 0.01;
    const ncr_rsibr *set = job->set;
    const ncr_rsibr_lobe *lobe = &set->brdf.lobe[job->lobe];
    const ncr_rsibr_index index =
        lobe->kind == NCR_RSIBR_PHONG ? NCR_RSIBR_BY_MIRROR : NCR_RSIBR_BY_NORMAL;
    for (uint32_t x = 0; x < set->size; x++) {
        double d[3];
        ncr_rsibr_direction(frame_at(job), index, place(x, set->size), place(y, set->size), d);
        const double c = d_dot(d, frame_at(job)->axis[2]);
        if (lobe->kind == NCR_RSIBR_GLOSS && c < grazing)
            d_mad(d, grazing - c, frame_at(job)->axis[2], d);
        out[x] = d_to_v(d);
    }
}

static void fill_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const fill_job *job = arg;
    const size_t size = job->set->size;
    (void)worker;
    for (size_t y = first; y < past; y++) {
        ncr_vec3 *row = job->normal + y * size;
        find_row(job, (uint32_t)y, row);
        if (job->grid)
            ncr_prefilter_grid_sample(job->grid, size, row, job->mean + 4 * y * size);
    }
}

static ncr_status fill_filtered(fill_job *job)
{
    const size_t size = job->set->size;
    const ncr_vec3 eye = d_to_v(frame_at(job)->axis[2]);
    ncr_status status = ncr_parallel_for(job->ctx, size, 8, fill_rows, job);
    if (status == NCR_OK && job->fixed)
        status = ncr_fixed_view_render(job->ctx, job->fixed, &job->light, eye, size * size,
                                       job->normal, job->mean);
    return status;
}

/* --- into the set ------------------------------------------------------------------------------ */

/* A map that is one lobe's holds its mean; one that is not, or raw, its radiance, which is added. */
static void store(const fill_job *job)
{
    ncr_rsibr *set = job->set;
    const bool whole = set->raw || set->single;
    const ncr_rsibr_lobe *lobe = &set->brdf.lobe[job->lobe];
    const float *table = ncr_rsibr_table(set, job->lobe);
    float *out = ncr_rsibr_map(set, set->single ? 0 : job->map, job->view);
    const float *mean = job->mean;
    for (uint32_t y = 0; y < set->size; y++)
        for (uint32_t x = 0; x < set->size; x++, out += 3, mean += 4) {
            const double s = place(x, set->size), t = place(y, set->size);
            const double c = sqrt(fmax(0, 1 - s * s - t * t));
            const double a = whole ? ncr_rsibr_lobe_albedo(lobe, table, c, 0) : 1;
            for (int i = 0; i < 3; i++)
                out[i] += (float)(a / (double)mean[3]) * mean[i] * (whole ? lobe->colour[i] : 1);
        }
}

/* The light, halved while rows stay below an eighth of the smaller alpha: what that blurs is a few
 * thousandths of the lobe's own width. */
static ncr_status fill_brushed(fill_job *job)
{
    const ncr_brushed *m = &job->set->brdf.lobe[job->lobe].brushed;
    const double side = fmin(m->along, m->across) / 8, pi = 3.14159265358979323846;
    const ncr_directional_map light = {
        .kind = NCR_MAP_LATLONG, .size = job->light.height, .image = job->light};
    uint32_t size = light.size;
    while (size > 8 && 2 * pi / size <= side)
        size /= 2;
    ncr_directional_map small;
    ncr_status status = ncr_directional_map_init(job->ctx, light.kind, size, 4, &small);
    if (status == NCR_OK)
        status = ncr_directional_map_shrink(job->ctx, &light, &small);
    if (status == NCR_OK)
        status = ncr_rsibr_fill_brushed(job->ctx, &small.image, job->set, job->lobe, job->map);
    ncr_directional_map_dispose(job->ctx, &small);
    return status;
}

static ncr_status fill_lobe(fill_job *job)
{
    if (job->set->brdf.lobe[job->lobe].kind == NCR_RSIBR_BRUSHED)
        return fill_brushed(job);
    ncr_status status = open_lobe(job);
    for (job->view = 0; status == NCR_OK && job->view < job->set->sphere.view_count; job->view++) {
        const bool mirror = job->set->brdf.lobe[job->lobe].kind == NCR_RSIBR_MIRROR;
        status = mirror ? fill_mirror(job) : fill_filtered(job);
        if (status == NCR_OK)
            store(job);
    }
    close_lobe(job);
    return status;
}

/* A single map holds radiance so far: divide the albedo of all lobes out of it. */
static void demodulate(ncr_rsibr *set)
{
    for (uint32_t view = 0; view < set->sphere.view_count; view++) {
        float *at = ncr_rsibr_map(set, 0, view);
        for (uint32_t y = 0; y < set->size; y++)
            for (uint32_t x = 0; x < set->size; x++, at += 3) {
                const double s = place(x, set->size), t = place(y, set->size);
                double a[3];
                ncr_rsibr_albedo(set, 0, sqrt(fmax(0, 1 - s * s - t * t)), 0, a);
                for (int i = 0; i < 3; i++)
                    at[i] = a[i] > 0 ? (float)((double)at[i] / a[i]) : 0;
            }
    }
}

ncr_status ncr_rsibr_fill(const ncr_ctx *ctx, const ncr_directional_map *env, ncr_rsibr *set)
{
    if (env->image.channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "an environment of %u channels: 3", env->image.channels);
    const size_t texels = (size_t)set->size * set->size;
    fill_job job = {.ctx = ctx, .env = env, .set = set};
    job.mean = ncr_alloc(ctx, texels * 4 * sizeof(float));
    job.normal = ncr_alloc(ctx, texels * sizeof *job.normal);
    ncr_status status = job.mean && job.normal ? make_light(&job) : NCR_E_NOMEM;
    memset(set->texels, 0, set->maps * set->sphere.view_count * texels * 3 * sizeof(float));
    for (job.lobe = 0; status == NCR_OK && job.lobe < set->brdf.lobe_count; job.lobe++) {
        status = fill_lobe(&job);
        job.map += ncr_rsibr_lobe_maps(set, job.lobe);
    }
    if (status == NCR_OK && set->single && !set->raw)
        demodulate(set);
    ncr_image_dispose(ctx, &job.light);
    ncr_directional_map_dispose(ctx, &job.coarse);
    ncr_free(ctx, job.mean);
    ncr_free(ctx, job.normal);
    return status;
}

ncr_status ncr_rsibr_create(const ncr_ctx *ctx, const ncr_directional_map *env,
                            const ncr_rsibr_brdf *brdf, const ncr_rsibr_opts *opts, ncr_rsibr *out)
{
    ncr_status status = ncr_rsibr_init(ctx, brdf, opts, out);
    if (status == NCR_OK) {
        status = ncr_rsibr_fill(ctx, env, out);
        if (status != NCR_OK)
            ncr_rsibr_dispose(ctx, out);
    }
    return status;
}
