/* SPDX-License-Identifier: MIT */
#include "apps/prefilter_job.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Interpolation errs by up to so many times its root mean square. */
static const double interpolation_peak = 8;
/* Terms that take some seconds. */
static const double most_terms = 2e9, sum_rounding = 1e-6;

ncr_status prefilter_make_map(const prefilter_job *job, uint32_t size, ncr_directional_map *out)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    const ncr_status status = ncr_directional_map_init(ctx, job->as.convention->kind, size, 3, out);
    out->axes = ncr_axes_then(job->as.world, job->as.convention->axes);
    return status;
}

/* --- lobes and sizes -------------------------------------------------------------------------- */

/* Roughness rises with the level, alpha with its square: a mirror first, alpha 1 last. */
static void choose_lobes(prefilter_job *job)
{
    const filter_choice *c = &job->choice;
    job->level_count = c->chain ? job->o->levels ? job->o->levels : 8 : 1;
    for (uint32_t k = 0; k < job->level_count; k++) {
        const double roughness = job->level_count > 1 ? k / (job->level_count - 1.0) : 0;
        filtered_level *level = &job->levels[k];
        level->lobe = c->chain
                          ? (ncr_lobe){.kind = NCR_LOBE_GGX, .parameter = roughness * roughness}
                          : c->lobe;
        level->mirror = c->chain ? k == 0 : c->mirror;
    }
}

static size_t lobes_of(const prefilter_job *job, ncr_lobe out[NCR_KTX2_LEVELS])
{
    size_t count = 0;
    for (uint32_t k = 0; k < job->level_count; k++)
        if (!job->levels[k].mirror)
            out[count++] = job->levels[k].lobe;
    return count;
}

/* The power of two whose texels are as fine as the map's, or as the degrees that are left. */
static uint32_t fitting_size(const prefilter_job *job, uint32_t order)
{
    const ncr_map_kind kind = job->as.convention->kind;
    const double per_square =
        (double)ncr_map_part_count(kind) * ncr_map_part_width(kind, 1024) / 1024.0;
    const double texels = (double)job->in.image.width * job->in.image.height;
    const double as_fine = exp2(nearbyint(0.5 * log2(texels / per_square)));
    const double enough = exp2(ceil(log2(fmax(8, sqrt(8 / per_square) * order))));
    return (uint32_t)fmin(fmax(order ? fmin(as_fine, enough) : as_fine, 1), NCR_MAP_SIZE_MAX);
}

/* --- filtering -------------------------------------------------------------------------------- */

static ncr_status analyse(prefilter_job *job)
{
    const prefilter_options *o = job->o;
    ncr_lobe lobes[NCR_KTX2_LEVELS];
    const size_t count = lobes_of(job, lobes);
    const ncr_prefilter_opts how = {.struct_size = sizeof how,
                                    .band_limit = o->order,
                                    .peel = o->no_peel    ? 0
                                            : o->peel > 0 ? o->peel
                                                          : job->tolerance};
    const double began = app_seconds();
    double total[NCR_MAP_CHANNELS] = {0};
    ncr_status status = NCR_OK;
    if (count)
        status = o->order
                     ? ncr_prefilter_create_map(&o->common.ctx, &job->in, &how, &job->prefilter)
                     : ncr_prefilter_create_for(&o->common.ctx, &job->in, count, lobes,
                                                job->tolerance, &how, &job->prefilter);
    job->seconds[1] = app_seconds() - began;
    if (job->prefilter) {
        job->mean = ncr_prefilter_mean(job->prefilter);
    } else {
        ncr_directional_map_integral(&job->in, total);
        job->mean = (total[0] + total[1] + total[2]) / (12 * pi);
    }
    return status;
}

static ncr_status choose_order(const prefilter_job *job, const filtered_level *level,
                               uint32_t *order)
{
    *order = job->o->order;
    if (job->o->order)
        return NCR_OK;
    const ncr_status status = ncr_prefilter_order(&job->o->common.ctx, job->prefilter, &level->lobe,
                                                  job->tolerance, order, NULL);
    return status == NCR_E_LIMIT ? NCR_OK : status; /* as far as it goes: the measurement tells */
}

/* An order of 0 leaves the mean; as an option it would mean all degrees. */
static ncr_prefilter_output output_of(const prefilter_job *job, uint32_t order, bool apart)
{
    return (ncr_prefilter_output){.struct_size = sizeof(ncr_prefilter_output),
                                  .order = order ? order : 1,
                                  .window = job->window,
                                  .positivity =
                                      job->o->positive ? NCR_POSITIVITY_CLAMP : NCR_POSITIVITY_NONE,
                                  .lights_off = apart};
}

static ncr_status fill_level(const prefilter_job *job, filtered_level *level, uint32_t order,
                             bool apart)
{
    const ncr_prefilter_output how = output_of(job, order, apart);
    const ncr_status status = ncr_prefilter_fill(&job->o->common.ctx, job->prefilter, &level->lobe,
                                                 &how, &level->map, &level->report);
    const ncr_image *image = &level->map.image;
    level->negative = 0;
    for (size_t k = 0; k < (size_t)image->width * image->height * 3; k++)
        level->negative += image->data[k] < 0;
    level->bound = level->report.bound_max + level->report.rounding +
                   interpolation_peak * level->report.resampling;
    return status;
}

static ncr_status make_level(prefilter_job *job, uint32_t k)
{
    const prefilter_options *o = job->o;
    filtered_level *level = &job->levels[k];
    uint32_t order = 0;
    ncr_status status = level->mirror ? NCR_OK : choose_order(job, level, &order);
    if (status)
        return status;
    const uint32_t whole = o->size ? o->size : fitting_size(job, job->choice.chain ? 0 : order);
    const uint32_t size = o->same_size ? whole : whole >> k ? whole >> k : 1;
    const ncr_convention *c = job->as.convention;
    if (level->mirror) /* made while it is written */
        return ncr_map_shape(&o->common.ctx, c->kind, size, 3,
                             ncr_axes_then(job->as.world, c->axes), &level->map);
    status = prefilter_make_map(job, size, &level->map);
    return status ? status : fill_level(job, level, order, false);
}

/* --- measuring -------------------------------------------------------------------------------- */

static ncr_status measure_level(const prefilter_job *job, filtered_level *level)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    probe_set set;
    double *want = ncr_alloc(ctx, 4 * (size_t)job->probes * sizeof *want);
    double *whole = want + 3 * (size_t)job->probes;
    ncr_status status = probe_set_make(job, &level->map, &set);
    if (!status)
        status = want ? ncr_prefilter_direct_map(ctx, &job->in, &level->lobe, set.count,
                                                 set.direction[0], want, whole)
                      : NCR_E_NOMEM;
    if (!status) {
        status = probe_set_compare(job, &set, want, level);
        for (uint32_t k = 0; k < set.count; k++)
            level->texel_error = fmax(level->texel_error, fabs(whole[k] - 1));
    }
    probe_set_dispose(job, &set);
    ncr_free(ctx, want);
    return status;
}

/* Where no degrees keep the tolerance, as for lobes that end in a jump, texels can be summed if they
 * are few enough; not where they do not resolve the lobe, since what they sum to is no filtering. */
static bool can_sum(const prefilter_job *job, const filtered_level *level)
{
    const double in = (double)job->in.image.width * job->in.image.height;
    const double out = (double)level->map.image.width * level->map.image.height;
    return !job->o->order && !job->window && !job->o->lights_apart &&
           level->texel_error <= job->tolerance && in * out <= most_terms;
}

static ncr_status sum_level(const prefilter_job *job, filtered_level *level)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    const ncr_image *image = &level->map.image;
    const size_t count = (size_t)image->width * image->height;
    double *direction = ncr_alloc(ctx, 6 * count * sizeof *direction);
    double *sum = direction + 3 * count;
    if (!direction)
        return NCR_E_NOMEM;
    prefilter_texel_directions(&level->map, direction);
    const ncr_status status =
        ncr_prefilter_direct_map(ctx, &job->in, &level->lobe, count, direction, sum, NULL);
    for (size_t k = 0; status == NCR_OK && k < 3 * count; k++)
        image->data[k] = (float)sum[k];
    ncr_directional_map_seal(&level->map);
    ncr_free(ctx, direction);
    level->summed = true;
    level->report = (ncr_prefilter_report){.rounding = 0};
    level->bound = sum_rounding * job->mean;
    prefilter_make_positive(job, level);
    return status;
}

/* Brute force visits every texel for every probe: fewer probes for large maps, never below 16. */
static void choose_probes(prefilter_job *job)
{
    const double texels = (double)job->in.image.width * job->in.image.height;
    const double affordable = 1.5e8 / (texels * job->level_count);
    job->probes = job->o->probes ? job->o->probes : (uint32_t)fmin(256, fmax(16, affordable));
}

/* With lights apart, what was measured is the whole; then they are left out. */
static ncr_status measure(prefilter_job *job)
{
    ncr_status status = NCR_OK;
    choose_probes(job);
    for (uint32_t k = 0; status == NCR_OK && k < job->level_count; k++) {
        filtered_level *level = &job->levels[k];
        if (level->mirror)
            continue;
        status = measure_level(job, level);
        if (status == NCR_OK && !(level->error <= job->tolerance * job->mean) &&
            can_sum(job, level)) {
            status = sum_level(job, level);
            if (status == NCR_OK)
                status = measure_level(job, level);
        }
        if (status == NCR_OK && job->o->lights_apart)
            status = fill_level(job, level, level->report.order, true);
    }
    return status;
}

static ncr_status find_nine(prefilter_job *job)
{
    const ncr_lobe lambert = {.kind = NCR_LOBE_LAMBERT};
    const ncr_prefilter_output how = {
        .struct_size = sizeof how, .window = job->window, .lights_off = job->o->lights_apart};
    if (!job->prefilter)
        return ncr_fail(&job->o->common.ctx, NCR_E_ARG, "--harmonics wants a --lobe");
    return ncr_prefilter_nine_get(&job->o->common.ctx, job->prefilter, &lambert, &how, &job->nine);
}

ncr_status prefilter_run(prefilter_job *job)
{
    choose_lobes(job);
    ncr_status status = analyse(job);
    double began = app_seconds();
    for (uint32_t k = 0; status == NCR_OK && k < job->level_count; k++) {
        const double level_began = app_seconds();
        status = make_level(job, k);
        job->levels[k].seconds = app_seconds() - level_began;
    }
    job->seconds[2] = app_seconds() - began;
    began = app_seconds();
    if (status == NCR_OK)
        status = measure(job);
    job->seconds[3] = app_seconds() - began;
    return status == NCR_OK && job->o->harmonics ? find_nine(job) : status;
}

bool prefilter_met(const prefilter_job *job)
{
    for (uint32_t k = 0; k < job->level_count; k++)
        if (!job->levels[k].mirror && !(job->levels[k].error <= job->tolerance * job->mean))
            return false;
    return true;
}
