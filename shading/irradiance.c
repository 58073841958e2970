/* SPDX-License-Identifier: MIT */
#include "shading/irradiance.h"

#include "core/random.h"
#include "core/vec_internal.h"
#include "shading/area_light_internal.h"
#include "shading/batch_internal.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

/* Radiosity by gathering. Each pass lets every site look at the world as the pass before has lit
 * it: the sky where nothing is, and where something is, its albedo times the stored irradiance
 * plus the sun. Early passes carry light from bounce to bounce and may be coarse; the last one
 * is what is kept. Lamps are summed exactly and shadowed by rays, once. */

enum { early_rays = 64, lamp_rays = 64, sites_per_chunk = 16 };

typedef struct site_light {
    float lamps[3], value[3];
    bool buried, set;
} site_light;

typedef struct gather_job {
    ncr_irradiance *ir;
    const node_layout *layout;
    site_light *sites;
    uint32_t rays;
    uint64_t key;
    bool first; /* find buried sites and light the others by lamps */
    atomic_uint_least64_t traced;
} gather_job;

/* --- one site -------------------------------------------------------------------------------- */

/* Directions k0.. of the site's cosine-weighted set. The set hangs on the place alone, and the
 * frame on the normal alone, so that neighbouring patches gather the same light on their border. */
static void cosine_rays(ncr_vec3 n, uint32_t key, uint32_t k0, size_t count, float d[3][BATCH])
{
    ncr_vec3 s, t;
    v_basis(n, &s, &t);
    for (size_t k = 0; k < count; k++) {
        float at[2];
        ncr_sobol2(k0 + (uint32_t)k, key, at);
        const float r = sqrtf(at[0]), angle = 6.28318531f * at[1], up = sqrtf(1.0f - at[0]);
        const float x = r * cosf(angle), y = r * sinf(angle);
        d[0][k] = x * s.x + y * t.x + up * n.x;
        d[1][k] = x * s.y + y * t.y + up * n.y;
        d[2][k] = x * s.z + y * t.z + up * n.z;
    }
}

typedef struct gathered {
    double sum[3];
    uint32_t from_behind; /* closed objects seen from the inside */
} gathered;

static void gather_batch(gather_job *job, ncr_vec3 o, ncr_vec3 n, uint32_t key, uint32_t k0,
                         size_t count, gathered *out)
{
    float origin[3][BATCH], d[3][BATCH], light[3][BATCH];
    float *const rgb[3] = {light[0], light[1], light[2]};
    batch_hits hits;
    uint64_t shadow_rays = 0;
    cosine_rays(n, key, k0, count, d);
    for (size_t k = 0; k < count; k++)
        origin[0][k] = o.x, origin[1][k] = o.y, origin[2][k] = o.z;
    const ncr_rays rays = {
        .ox = origin[0], .oy = origin[1], .oz = origin[2], .dx = d[0], .dy = d[1], .dz = d[2]};
    ncr_batch_trace(job->ir->world->scene, count, &rays, &hits);
    ncr_batch_shade(job->ir, count, &rays, &hits, LIGHT_GATHERED, NULL, rgb, &shadow_rays);
    for (size_t k = 0; k < count; k++) {
        for (int c = 0; c < 3; c++)
            out->sum[c] += (double)light[c][k];
        if (hits.object[k] != NCR_NONE && job->ir->objects[hits.object[k]].closed)
            out->from_behind +=
                hits.g[0][k] * d[0][k] + hits.g[1][k] * d[1][k] + hits.g[2][k] * d[2][k] > 0;
    }
    atomic_fetch_add_explicit(&job->traced, count + shadow_rays, memory_order_relaxed);
}

static void light_by_lamps(gather_job *job, ncr_vec3 o, ncr_vec3 n, uint32_t key, float out[3])
{
    const ncr_world *world = job->ir->world;
    double p[3], normal[3];
    uint64_t rays = 0;
    v_to_d(o, p);
    v_to_d(n, normal);
    for (size_t k = 0; k < world->light_count; k++) {
        const ncr_area_light *light = &world->lights[k];
        double e = ncr_area_light_irradiance(light, p, normal);
        if (e > 0)
            e *= ncr_area_light_visible(world->scene, light, p, normal,
                                        (double)job->ir->objects[light->object].lift, lamp_rays,
                                        key + (uint32_t)k, &rays);
        for (int c = 0; c < 3; c++)
            out[c] += (float)(e * (double)light->radiance[c]);
    }
    atomic_fetch_add_explicit(&job->traced, rays, memory_order_relaxed);
}

/* A site that sees solids from the inside is probably in one; the winding number decides. */
static bool is_buried(const gather_job *job, ncr_vec3 o, const gathered *g)
{
    double p[3];
    v_to_d(o, p);
    return 4 * g->from_behind > job->rays && ncr_scene_inside(job->ir->world->scene, p) != NCR_NONE;
}

static void gather_site(gather_job *job, size_t k)
{
    const node_layout *l = job->layout;
    site_light *site = &job->sites[k];
    const ncr_vec3 n = l->normal[k];
    const ncr_vec3 o = v_mad(l->place[k], job->ir->objects[l->owner[k]].lift, n);
    const uint32_t key = (uint32_t)ncr_hash64(l->key[k], job->key);
    gathered g = {0};
    if (site->buried || !(v_dot(n, n) > 0)) {
        site->buried = true;
        return;
    }
    for (uint32_t k0 = 0; k0 < job->rays; k0 += BATCH)
        gather_batch(job, o, n, key, k0, job->rays - k0 < BATCH ? job->rays - k0 : BATCH, &g);
    if (job->first) {
        site->buried = is_buried(job, o, &g);
        light_by_lamps(job, o, n, key, site->lamps);
    }
    for (int c = 0; c < 3; c++)
        site->value[c] = (float)(3.14159265358979 * g.sum[c] / job->rays) + site->lamps[c];
}

static void gather_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    (void)worker;
    for (size_t k = begin; k < end; k++)
        gather_site(arg, k);
}

/* --- all sites ------------------------------------------------------------------------------- */

/* Mean of the set sites about node (i,j) of a patch, straight neighbours before diagonal ones. */
static bool mean_about(const node_layout *l, const site_light *sites, const node_grid *g,
                       uint32_t i, uint32_t j, double sum[3])
{
    double weight = 0;
    for (uint32_t y = j ? j - 1 : 0; y <= j + 1 && y < g->nv; y++)
        for (uint32_t x = i ? i - 1 : 0; x <= i + 1 && x < g->nu; x++) {
            const site_light *near = &sites[l->site[g->first + y * g->nu + x]];
            if (!near->set)
                continue;
            const double w = x == i || y == j ? 1.0 : 0.5;
            for (int c = 0; c < 3; c++)
                sum[c] += w * (double)near->value[c];
            weight += w;
        }
    for (int c = 0; c < 3 && weight > 0; c++)
        sum[c] /= weight;
    return weight > 0;
}

typedef struct spread_sum {
    double rgb[3];
    uint32_t count;
} spread_sum;

/* One ring of buried sites takes the mean of its neighbours that have a value. */
static size_t spread_ring(const node_layout *l, site_light *sites, spread_sum *sums)
{
    size_t reached = 0;
    for (size_t p = 0; p < l->patch_count; p++) {
        const node_grid *g = &l->grids[p];
        for (uint32_t j = 0; j < g->nv; j++)
            for (uint32_t i = 0; i < g->nu; i++) {
                const uint32_t site = l->site[g->first + j * g->nu + i];
                double mean[3] = {0, 0, 0};
                if (sites[site].set || !mean_about(l, sites, g, i, j, mean))
                    continue;
                for (int c = 0; c < 3; c++)
                    sums[site].rgb[c] += mean[c];
                sums[site].count++;
            }
    }
    for (size_t k = 0; k < l->site_count; k++)
        if (sums[k].count) {
            for (int c = 0; c < 3; c++)
                sites[k].value[c] = (float)(sums[k].rgb[c] / sums[k].count);
            sites[k].set = true;
            sums[k] = (spread_sum){0};
            reached++;
        }
    return reached;
}

/* Buried sites take the light of the nearest free ones, ring by ring, across patches: a look-up
 * beside the line where a handle enters a body then does not mix in the dark of the inside. */
static size_t spread(const node_layout *l, site_light *sites, spread_sum *sums)
{
    size_t buried = 0;
    for (size_t k = 0; k < l->site_count; k++) {
        sites[k].set = !sites[k].buried;
        buried += sites[k].buried;
        for (int c = 0; sites[k].buried && c < 3; c++)
            sites[k].value[c] = 0;
    }
    for (size_t left = buried; left;) {
        const size_t reached = spread_ring(l, sites, sums);
        if (!reached) /* patches that are buried as a whole stay dark */
            break;
        left -= reached;
    }
    return buried;
}

static void publish(const node_layout *l, const site_light *sites, float (*node)[4])
{
    for (size_t k = 0; k < l->node_count; k++)
        memcpy(node[k], sites[l->site[k]].value, sizeof sites->value);
}

static ncr_status run_passes(const ncr_ctx *ctx, gather_job *job, const ncr_irradiance_opts *opts,
                             ncr_irradiance_stats *stats)
{
    const uint32_t early = opts->bounces ? opts->bounces : 4;
    const uint32_t last_rays = opts->rays ? opts->rays : 256;
    spread_sum *sums = ncr_alloc_zero(ctx, job->layout->site_count, sizeof *sums);
    ncr_status status = sums ? NCR_OK : NCR_E_NOMEM;
    for (uint32_t pass = 0; status == NCR_OK && pass <= early; pass++) {
        job->first = pass == 0;
        job->rays = pass == early ? last_rays : last_rays < early_rays ? last_rays : early_rays;
        job->key = ncr_hash64(pass, opts->seed);
        status = ncr_parallel_for(ctx, job->layout->site_count, sites_per_chunk, gather_range, job);
        if (status == NCR_OK) {
            stats->buried = spread(job->layout, job->sites, sums);
            publish(job->layout, job->sites, job->ir->node);
        }
        ncr_progress(ctx, "irradiance", (pass + 1.0) / (early + 1.0));
    }
    ncr_free(ctx, sums);
    return status;
}

/* --- making and reading ---------------------------------------------------------------------- */

/* Rays start two chord tolerances off the triangles, and by what float can tell apart. */
static void describe_objects(ncr_irradiance *ir)
{
    const ncr_scene *scene = ir->world->scene;
    uint32_t first = 0;
    for (uint32_t k = 0; k < ncr_scene_object_count(scene); k++) {
        const ncr_material *m = &ir->world->materials[k];
        ir->objects[k] = (object_light){.material = m,
                                        .first_grid = first,
                                        .lift = 2.0f * ncr_scene_object_chord(scene, k) + 0x1p-20f,
                                        .emits = light_is_on(m->emission),
                                        .mirror = light_is_on(m->specular),
                                        .closed = !ncr_scene_object_open(scene, k)};
        first += ncr_surface_patch_count(ncr_scene_object_surface(scene, k));
    }
}

static double longest_side(const ncr_scene *scene)
{
    double lo[3], hi[3], all_lo[3] = {2, 2, 2}, all_hi[3] = {-2, -2, -2}, side = 0;
    for (uint32_t k = 0; k < ncr_scene_object_count(scene); k++) {
        ncr_surface_bounds(ncr_scene_object_surface(scene, k), lo, hi);
        for (int c = 0; c < 3; c++) {
            all_lo[c] = fmin(all_lo[c], lo[c]);
            all_hi[c] = fmax(all_hi[c], hi[c]);
        }
    }
    for (int c = 0; c < 3; c++)
        side = fmax(side, all_hi[c] - all_lo[c]);
    return side;
}

static ncr_status lay_out(const ncr_ctx *ctx, const ncr_irradiance *ir, double spacing,
                          node_layout *out)
{
    const ncr_scene *scene = ir->world->scene;
    const uint32_t objects = ncr_scene_object_count(scene);
    const double side = longest_side(scene);
    float *lift = ncr_alloc(ctx, objects * sizeof *lift);
    if (!lift)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < objects; k++)
        lift[k] = ir->objects[k].lift;
    const double step =
        spacing > 0 ? ncr_frame_length_from_model(ncr_scene_frame(scene), spacing) : side / 100;
    const ncr_status status = ncr_node_layout_create(ctx, scene, step, side, lift, out);
    ncr_free(ctx, lift);
    return status;
}

static ncr_status compute(const ncr_ctx *ctx, ncr_irradiance *ir, const ncr_irradiance_opts *opts,
                          ncr_irradiance_stats *stats)
{
    node_layout layout;
    ncr_status status = lay_out(ctx, ir, opts->spacing, &layout);
    if (status != NCR_OK)
        return status;
    gather_job job = {.ir = ir, .layout = &layout};
    job.sites = ncr_alloc_zero(ctx, layout.site_count, sizeof *job.sites);
    ir->node = ncr_alloc_zero(ctx, layout.node_count, sizeof *ir->node);
    ir->grids = layout.grids;
    status = job.sites && ir->node ? run_passes(ctx, &job, opts, stats) : NCR_E_NOMEM;
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
        describe_objects(ir);
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
    float rgb[4];
    irradiance_look(irradiance, &irradiance->objects[object], patch, u, v, rgb);
    return v_make(rgb[0], rgb[1], rgb[2]);
}
