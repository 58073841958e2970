/* SPDX-License-Identifier: MIT */
#include "shading/irradiance.h"

#include "core/vec_internal.h"
#include "shading/gather_internal.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* Radiosity by gathering, in three steps. Every site looks at the world along a few rays: what
 * they bring of sky and sun, and which sites they meet, is written down. Light then goes from
 * bounce to bounce over what was written down. Last, every site looks again, along more rays, at
 * a world lit by the result, and that is kept. Lamps are summed exactly and shadowed by rays. */

/* --- the steps --------------------------------------------------------------------------------- */

enum { early_rays = 64, default_rays = 256, default_bounces = 16 };
static const size_t most_link_bytes = (size_t)1 << 29;

/* Rays of the first look: fewer where there are so many sites that links would fill the memory. */
static uint32_t first_rays(size_t sites, uint32_t last)
{
    uint32_t rays = last < early_rays ? last : early_rays;
    while (rays > 16 && sites * rays * sizeof(site_link) > most_link_bytes)
        rays /= 2;
    return rays;
}

static void write_node(node_light *node, const site_light *site)
{
    *node = (node_light){site->value[0], site->value[1], site->value[2], 0};
}

/* value = lamps + gathered where a site is free, and its neighbours' where it is not; then the
 * nodes, which look-ups read, take it over. */
static ncr_status publish(const ncr_ctx *ctx, const gather_job *job, size_t *buried)
{
    const node_layout *l = job->layout;
    for (size_t k = 0; k < l->site_count; k++)
        for (int c = 0; c < 3; c++)
            job->sites[k].value[c] = job->sites[k].lamps[c] + job->sites[k].gathered[c];
    const ncr_status status = ncr_sites_spread(ctx, l, job->sites, buried);
    for (size_t k = 0; status == NCR_OK && k < l->node_count; k++)
        write_node(&job->ir->node[k], &job->sites[l->site[k]]);
    return status;
}

static ncr_status carry_bounces(const ncr_ctx *ctx, const gather_job *job, uint32_t bounces)
{
    const size_t count = job->layout->site_count;
    size_t buried;
    float(*next)[3] = ncr_alloc(ctx, count * sizeof *next);
    ncr_status status = next ? publish(ctx, job, &buried) : NCR_E_NOMEM;
    for (uint32_t k = 1; status == NCR_OK && k < bounces; k++) {
        status = ncr_gather_bounce(ctx, job, next);
        for (size_t s = 0; status == NCR_OK && s < count; s++)
            memcpy(job->sites[s].value, next[s], sizeof *next);
        if (status == NCR_OK)
            status = ncr_sites_spread(ctx, job->layout, job->sites, &buried);
    }
    for (size_t k = 0; status == NCR_OK && k < job->layout->node_count; k++)
        write_node(&job->ir->node[k], &job->sites[job->layout->site[k]]);
    ncr_free(ctx, next);
    return status;
}

static ncr_status run_steps(const ncr_ctx *ctx, gather_job *job, const ncr_irradiance_opts *opts,
                            size_t *buried)
{
    const uint32_t last_rays = opts->rays ? opts->rays : default_rays;
    job->key = opts->seed;
    job->rays = first_rays(job->layout->site_count, last_rays);
    job->links = ncr_alloc_zero(ctx, job->layout->site_count, job->rays * sizeof *job->links);
    ncr_status status = job->links ? ncr_gather(ctx, job) : NCR_E_NOMEM;
    ncr_progress(ctx, "irradiance", 0.25);
    if (status == NCR_OK)
        status = carry_bounces(ctx, job, opts->bounces ? opts->bounces : default_bounces);
    ncr_free(ctx, job->links);
    job->links = NULL;
    job->rays = last_rays;
    if (status == NCR_OK)
        status = ncr_gather(ctx, job);
    if (status == NCR_OK)
        status = ncr_sites_smooth(ctx, job->layout, job->sites);
    if (status == NCR_OK)
        status = publish(ctx, job, buried);
    ncr_progress(ctx, "irradiance", 1);
    return status;
}

/* --- making and reading ---------------------------------------------------------------------- */

static double longest_side(const double lo[3], const double hi[3])
{
    return fmax(fmax(hi[0] - lo[0], hi[1] - lo[1]), hi[2] - lo[2]);
}

static double world_size(const ncr_scene *scene)
{
    double lo[3], hi[3], all_lo[3] = {2, 2, 2}, all_hi[3] = {-2, -2, -2};
    for (uint32_t k = 0; k < ncr_scene_object_count(scene); k++) {
        ncr_surface_bounds(ncr_scene_object_surface(scene, k), lo, hi);
        for (int c = 0; c < 3; c++) {
            all_lo[c] = fmin(all_lo[c], lo[c]);
            all_hi[c] = fmax(all_hi[c], hi[c]);
        }
    }
    return longest_side(all_lo, all_hi);
}

/* Rays start two chord tolerances off the triangles, and by what float can tell apart. Smaller
 * objects are seen from closer by: their cells shrink with the root of their size. */
static void describe_objects(ncr_irradiance *ir, double spacing)
{
    const ncr_scene *scene = ir->world->scene;
    const double size = world_size(scene);
    const double widest =
        spacing > 0 ? ncr_frame_length_from_model(ncr_scene_frame(scene), spacing) : size / 100;
    uint32_t first = 0;
    for (uint32_t k = 0; k < ncr_scene_object_count(scene); k++) {
        const ncr_material *m = &ir->world->materials[k];
        const ncr_surface *surface = ncr_scene_object_surface(scene, k);
        double lo[3], hi[3];
        ncr_surface_bounds(surface, lo, hi);
        ir->objects[k] = (object_light){.material = m,
                                        .first_grid = first,
                                        .lift = 2.0f * ncr_scene_object_chord(scene, k) + 0x1p-20f,
                                        .cell = (float)(widest * sqrt(longest_side(lo, hi) / size)),
                                        .emits = light_is_on(m->emission),
                                        .mirror = light_is_on(m->specular),
                                        .closed = !ncr_scene_object_open(scene, k)};
        first += ncr_surface_patch_count(surface);
    }
}

static ncr_status compute(const ncr_ctx *ctx, ncr_irradiance *ir, const ncr_irradiance_opts *opts,
                          ncr_irradiance_stats *stats)
{
    node_layout layout;
    ncr_status status = ncr_node_layout_create(ctx, ir->world->scene, ir->objects, &layout);
    if (status != NCR_OK)
        return status;
    gather_job job = {.ir = ir, .layout = &layout};
    job.sites = ncr_alloc_zero(ctx, layout.site_count, sizeof *job.sites);
    ir->node = ncr_alloc_zero(ctx, layout.node_count, sizeof *ir->node);
    ir->grids = layout.grids;
    status = job.sites && ir->node ? run_steps(ctx, &job, opts, &stats->buried) : NCR_E_NOMEM;
    stats->nodes = layout.node_count;
    stats->rays = atomic_load(&job.traced);
    layout.grids = NULL; /* now the irradiance's own */
    ncr_node_layout_dispose(ctx, &layout);
    ncr_free(ctx, job.sites);
    return status;
}

static ncr_status check_opts(const ncr_ctx *ctx, const ncr_irradiance_opts *opts)
{
    if (!opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "the irradiance options' struct_size is zero");
    if (opts->rays & (opts->rays - 1))
        return ncr_fail(ctx, NCR_E_ARG, "%u irradiance rays: a power of two is needed", opts->rays);
    if (!(opts->spacing >= 0))
        return ncr_fail(ctx, NCR_E_ARG, "an irradiance spacing of %g", opts->spacing);
    return NCR_OK;
}

ncr_status ncr_irradiance_create(const ncr_ctx *ctx, const ncr_world *world,
                                 const ncr_irradiance_opts *opts, ncr_irradiance **out,
                                 ncr_irradiance_stats *stats)
{
    *out = NULL;
    const ncr_irradiance_opts defaults = {.struct_size = sizeof defaults};
    const ncr_irradiance_opts *set = opts ? opts : &defaults;
    ncr_irradiance_stats unwanted, *report = stats ? stats : &unwanted;
    *report = (ncr_irradiance_stats){0};
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    ncr_status status = check_opts(ctx, set);
    if (status != NCR_OK)
        return status;
    ncr_irradiance *ir = ncr_alloc_zero(ctx, 1, sizeof *ir);
    if (!ir)
        return NCR_E_NOMEM;
    const ncr_frame *frame = ncr_scene_frame(world->scene);
    ir->world = world;
    ir->unit = ldexp(1.0, frame->exponent);
    memcpy(ir->centre, frame->centre, sizeof ir->centre);
    ncr_sky_prepare(&world->sky, &ir->sky);
    ir->objects = ncr_alloc_zero(ctx, ncr_scene_object_count(world->scene), sizeof *ir->objects);
    status = ir->objects ? NCR_OK : NCR_E_NOMEM;
    if (status == NCR_OK) {
        describe_objects(ir, set->spacing);
        status = compute(ctx, ir, set, report);
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    report->seconds =
        (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    if (status != NCR_OK)
        ncr_irradiance_destroy(ctx, ir);
    else
        *out = ir;
    return status;
}

void ncr_irradiance_destroy(const ncr_ctx *ctx, ncr_irradiance *irradiance)
{
    if (!irradiance)
        return;
    ncr_free(ctx, irradiance->objects);
    ncr_free(ctx, irradiance->grids);
    ncr_free(ctx, irradiance->node);
    ncr_free(ctx, irradiance);
}

ncr_vec3 ncr_irradiance_at(const ncr_irradiance *irradiance, uint32_t object, uint32_t patch,
                           float u, float v)
{
    const node_light e = irradiance_look(irradiance, &irradiance->objects[object], patch, u, v);
    return v_make(e[0], e[1], e[2]);
}
