/* SPDX-License-Identifier: MIT */
#include "shading/distant_internal.h"

#include "core/vec_internal.h"
#include "shading/brdf.h"
#include "shading/method_internal.h"
#include "shading/paraboloid_filter.h"

#include <math.h>

enum { sun_pieces = 4096 };
static const double pi = 3.14159265358979323846;
static const double light_share = 0.01; /* of the map's power, from which a light is peeled */

bool ncr_method_reads_distant(const ncr_method *method)
{
    return method->entry && method->entry->needs & NCR_NEEDS_DISTANT;
}

/* --- a sky ------------------------------------------------------------------------------------ */

static void sky_radiance(const double d[3], void *user, float *out)
{
    const ncr_vec3 light = ncr_sky_radiance(user, d_to_v(d));
    out[0] = light.x;
    out[1] = light.y;
    out[2] = light.z;
}

/* The texel that a direction falls into, and its solid angle. */
static float *texel_toward(const ncr_directional_map *map, ncr_vec3 direction, double *omega)
{
    double world[3], own[3];
    v_to_d(direction, world);
    ncr_axes_apply(map->axes, world, own);
    const ncr_map_coord at = ncr_map_from_direction(map->kind, own);
    const uint32_t w = ncr_map_part_width(map->kind, map->size), h = map->size;
    const double x = 0.5 * (at.s + 1) * w, y = 0.5 * (at.t + 1) * h;
    const uint32_t i = x < w ? (uint32_t)x : w - 1, j = y < h ? (uint32_t)y : h - 1;
    *omega = ncr_map_texel_solid_angle(map->kind, map->size, i, j);
    return ncr_directional_map_at(map, at.part, i, j);
}

/* The disc in equal pieces, each to the texel that it falls into: all of its power arrives. */
static void add_sun(const ncr_sky *sky, ncr_directional_map *map)
{
    const ncr_vec3 radiance = ncr_sky_sun_radiance(sky);
    const double radius =
        (sky->sun_radius_deg > 0 ? (double)sky->sun_radius_deg : 0.2666) * pi / 180;
    const double half = sin(0.5 * radius);
    const double piece = 4 * pi * half * half / sun_pieces;
    for (uint32_t k = 0; k < sun_pieces; k++) {
        const ncr_vec3 d = ncr_sky_sun_sample(sky, k, sun_pieces);
        if (v_dot(d, d) == 0)
            return;
        double omega;
        float *texel = texel_toward(map, d, &omega);
        const float share = (float)(piece / omega);
        texel[0] += share * radiance.x;
        texel[1] += share * radiance.y;
        texel[2] += share * radiance.z;
    }
}

ncr_status ncr_distant_fill_sky(const ncr_ctx *ctx, const ncr_sky *sky, ncr_directional_map *map)
{
    if (map->image.channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "a sky has 3 channels, the map %u", map->image.channels);
    ncr_sky copy = *sky;
    const ncr_status status =
        ncr_directional_map_fill(ctx, map, 0.5 * pi / map->size, sky_radiance, &copy);
    if (status == NCR_OK) {
        add_sun(sky, map);
        ncr_directional_map_seal(map);
    }
    return status;
}

ncr_status ncr_distant_probe(const ncr_ctx *ctx, const ncr_probe *probe, ncr_directional_map *out)
{
    const uint32_t n = ncr_lightfield_resolution(probe->light);
    const ncr_status status = ncr_directional_map_init(ctx, NCR_MAP_CUBE, n, 3, out);
    if (status != NCR_OK)
        return status;
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t y = 0; y < n; y++)
            for (uint32_t x = 0; x < n; x++)
                ncr_lightfield_texel(probe->light, 0, face, x, y,
                                     ncr_directional_map_at(out, face, x, y), NULL);
    ncr_directional_map_seal(out);
    return NCR_OK;
}

/* --- filters ---------------------------------------------------------------------------------- */

/* Rows of an equirectangular map with as many texels. */
static uint32_t rows_like(const ncr_directional_map *map)
{
    const double rows = ceil(sqrt(0.5 * map->image.width * map->image.height));
    return rows > NCR_MAP_SIZE_MAX ? NCR_MAP_SIZE_MAX : (uint32_t)rows;
}

static ncr_status analyse(const ncr_ctx *ctx, const ncr_directional_map *map,
                          const ncr_prefilter_opts *opts, ncr_prefilter **out)
{
    const bool as_it_is = map->kind == NCR_MAP_LATLONG && !map->axes.row[0];
    if (as_it_is)
        return ncr_prefilter_create(ctx, &map->image, opts, out);
    ncr_directional_map flat;
    ncr_status status =
        ncr_directional_map_init(ctx, NCR_MAP_LATLONG, rows_like(map), map->image.channels, &flat);
    if (status != NCR_OK)
        return status;
    status = ncr_directional_map_convert(ctx, map, &flat);
    if (status == NCR_OK)
        status = ncr_prefilter_create(ctx, &flat.image, opts, out);
    ncr_directional_map_dispose(ctx, &flat);
    return status;
}

static ncr_status filter(const ncr_ctx *ctx, const ncr_directional_map *map,
                         const ncr_lobe *sharpest, const ncr_lobe *gloss, bool diffuse,
                         double tolerance, ncr_distant *distant)
{
    const ncr_lobe lambert = {.kind = NCR_LOBE_LAMBERT};
    const ncr_prefilter_output *positive =
        NCR_OPTS(ncr_prefilter_output, .positivity = NCR_POSITIVITY_CLAMP);
    ncr_prefilter *prefilter = NULL;
    ncr_status status =
        analyse(ctx, map,
                NCR_OPTS(ncr_prefilter_opts, .sharpest = sharpest, .tolerance = tolerance,
                         .clamp_negative = true, .peel = light_share),
                &prefilter);
    if (status == NCR_OK && gloss)
        status = ncr_prefilter_grid_create(ctx, prefilter, gloss, positive, &distant->gloss, NULL);
    if (status == NCR_OK && diffuse)
        status =
            ncr_prefilter_grid_create(ctx, prefilter, &lambert, positive, &distant->diffuse, NULL);
    if (status == NCR_OK && distant->sum)
        status = ncr_gloss_maps_create(ctx, prefilter, positive, distant->sum, &distant->lobes);
    ncr_prefilter_destroy(ctx, prefilter);
    return status;
}

/* By Heidrich's means: as a dual paraboloid map of as many rows. */
static ncr_status filter_roughly(const ncr_ctx *ctx, const ncr_directional_map *map,
                                 const ncr_lobe *lobe, ncr_distant_filter how,
                                 ncr_directional_map *out)
{
    if (lobe->kind != NCR_LOBE_PHONG)
        return ncr_fail(ctx, NCR_E_ARG, "only Phong lobes are filtered by kernels of few texels");
    ncr_directional_map sharp;
    ncr_status status =
        ncr_directional_map_init(ctx, NCR_MAP_PARABOLOID, rows_like(map), 3, &sharp);
    if (status == NCR_OK)
        status = ncr_directional_map_convert(ctx, map, &sharp);
    if (status == NCR_OK)
        status = ncr_directional_map_init(ctx, NCR_MAP_PARABOLOID, sharp.size, 3, out);
    if (status == NCR_OK) {
        const ncr_paraboloid_how kernels =
            how == NCR_DISTANT_TWO_RADII ? NCR_PARABOLOID_TWO_RADII : NCR_PARABOLOID_HIERARCHICAL;
        status = ncr_paraboloid_filter(ctx, &sharp, lobe->parameter,
                                       NCR_OPTS(ncr_paraboloid_filter_opts, .how = kernels), out);
    }
    ncr_directional_map_dispose(ctx, &sharp);
    return status;
}

/* What a lobe is the reflection of, where it has one. */
typedef struct coat {
    ncr_gloss gloss;
    double exponent;
} coat;

static double coat_of_facets(const double v[3], const double l[3], const void *user)
{
    return ncr_gloss_eval(v, l, &((const coat *)user)->gloss);
}

static double coat_of_phong(const double v[3], const double l[3], const void *user)
{
    const coat *c = user;
    const double f = ncr_phong_eval(c->exponent, v, l);
    const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
    return f > 0 ? f * ncr_fresnel_eval(&c->gloss.fresnel, fmin(1, d_dot(v, h) / d_length(h))) : 0;
}

/* The BRDF that a lobe stands for: GGX with Smith's shadowing, Beckmann with V-cavities (Cook and
 * Torrance's), or Phong's; under a Fresnel term. */
static ncr_status coat_of(const ncr_ctx *ctx, const ncr_lobe *lobe, double index, coat *c,
                          ncr_reflectance *out)
{
    const double p = lobe ? lobe->parameter : 0;
    c->gloss.fresnel.eta = index;
    if (lobe && lobe->kind == NCR_LOBE_PHONG && p > 0) {
        c->exponent = p;
        *out = (ncr_reflectance){coat_of_phong, c, fmin(1, 1 / sqrt(p))};
        return NCR_OK;
    }
    if (!lobe || !(lobe->kind == NCR_LOBE_GGX || lobe->kind == NCR_LOBE_BECKMANN) || !(p > 0))
        return ncr_fail(ctx, NCR_E_ARG, "a glossy coat needs a lobe of GGX, Beckmann or Phong");
    const bool ggx = lobe->kind == NCR_LOBE_GGX;
    c->gloss.facets = (ncr_microfacet){ggx ? NCR_FACETS_GGX : NCR_FACETS_BECKMANN,
                                       ggx ? NCR_SHADOWING_SMITH : NCR_SHADOWING_VCAVITY, p};
    *out = (ncr_reflectance){coat_of_facets, c, fmin(p, 1)};
    return NCR_OK;
}

/* Fit the lobes of the first method that wants any. */
static ncr_status fit_lobes(const ncr_ctx *ctx, size_t count, const ncr_method *methods,
                            const ncr_lobe *lobe, ncr_distant *distant)
{
    coat c = {0};
    ncr_reflectance brdf;
    for (size_t k = 0; k < count; k++) {
        const ncr_method *m = &methods[k];
        if (!m->entry || !(m->entry->needs & NCR_NEEDS_LOBES))
            continue;
        const ncr_status status = coat_of(ctx, lobe, m->parameter, &c, &brdf);
        distant->made_for = m->entry;
        distant->index = m->parameter;
        const ncr_lobe_form form = (ncr_lobe_form)m->entry->detail;
        return status != NCR_OK
                   ? status
                   : ncr_lobe_sum_fit(ctx, &brdf, NCR_OPTS(ncr_lobe_sum_opts, .form = form),
                                      &distant->sum);
    }
    return NCR_OK;
}

/* The union of what the methods' entries ask for. */
static unsigned wanted(size_t count, const ncr_method *methods)
{
    unsigned needs = 0;
    for (size_t k = 0; k < count; k++)
        needs |= methods[k].entry ? methods[k].entry->needs : 0;
    return needs;
}

ncr_status ncr_distant_create(const ncr_ctx *ctx, const ncr_directional_map *map, size_t count,
                              const ncr_method *methods, const ncr_distant_opts *opts,
                              ncr_distant **out)
{
    *out = NULL;
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_distant_opts without its size");
    if (map->image.channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "distant light of %u channels, not 3", map->image.channels);
    const unsigned needs = wanted(count, methods);
    const ncr_lobe *gloss = needs & NCR_TAKES_GLOSS && opts ? opts->lobe : NULL;
    const bool diffuse = needs & NCR_NEEDS_DIFFUSE;
    ncr_distant *distant = ncr_alloc_zero(ctx, 1, sizeof *distant);
    if (!distant)
        return NCR_E_NOMEM;
    distant->map = map;
    ncr_status status = NCR_OK;
    if (gloss && opts->filter != NCR_DISTANT_EXACT) {
        status = filter_roughly(ctx, map, gloss, opts->filter, &distant->rough);
        gloss = NULL;
    }
    const ncr_lobe *lobe = opts ? opts->lobe : NULL;
    if (status == NCR_OK)
        status = fit_lobes(ctx, count, methods, lobe, distant);
    if (status == NCR_OK && (gloss || diffuse || distant->sum))
        status = filter(ctx, map, distant->sum ? lobe : gloss, gloss, diffuse,
                        opts ? opts->tolerance : 0, distant);
    if (status != NCR_OK) {
        ncr_distant_destroy(ctx, distant);
        return status;
    }
    *out = distant;
    return NCR_OK;
}

void ncr_distant_destroy(const ncr_ctx *ctx, ncr_distant *distant)
{
    if (!distant)
        return;
    ncr_gloss_maps_destroy(ctx, distant->lobes);
    ncr_lobe_sum_destroy(ctx, distant->sum);
    ncr_directional_map_dispose(ctx, &distant->rough);
    ncr_prefilter_grid_destroy(ctx, distant->gloss);
    ncr_prefilter_grid_destroy(ctx, distant->diffuse);
    ncr_free(ctx, distant);
}
