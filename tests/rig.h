/* SPDX-License-Identifier: MIT
 * rig.h - a light field without a scene: a surface given by a formula, light given by a formula,
 * sample points wherever a test wants them. What shading makes of it can be told in closed form. */
#ifndef NCR_TESTS_RIG_H
#define NCR_TESTS_RIG_H

#include "tests/check.h"

#include "core/vec_internal.h"
#include "shading/cube.h"
#include "shading/method.h"

#include <stdlib.h>
#include <string.h>

typedef struct rig_light {
    /* Light that arrives at p from direction d, both double. */
    void (*radiance)(const void *user, const double p[3], const double d[3], double rgb[3]);
    const void *user;
} rig_light;

typedef struct rig {
    ncr_gbuffer g;
    ncr_points points;
    ncr_frame frame;
    ncr_sample_map map;
    ncr_lightfield *light, *probe_light;
    ncr_probe probe;
    ncr_shading_inputs in;
} rig;

static inline ncr_lightfield *rig_capture(uint32_t count, const ncr_point *at, uint32_t n,
                                          ncr_texel_format format, rig_light light)
{
    ncr_lightfield *field;
    CHECK_STATUS(NCR_OK,
                 ncr_lightfield_create(NULL, count, n,
                                       NCR_OPTS(ncr_lightfield_opts, .format = format), &field));
    const ncr_tile_sink sink = ncr_lightfield_sink(field);
    float *rgb = malloc((size_t)n * n * 3 * sizeof *rgb);
    assert_non_null(rgb);
    for (uint32_t point = 0; point < count; point++)
        for (uint32_t face = 0; face < 6; face++) {
            for (uint32_t y = 0; y < n; y++)
                for (uint32_t x = 0; x < n; x++) {
                    double d[3], l[3];
                    ncr_cube_to_direction_d(face, (2.0 * x + 1) / n - 1, (2.0 * y + 1) / n - 1, d);
                    light.radiance(light.user, at[point].position, d, l);
                    for (size_t c = 0; c < 3; c++)
                        rgb[3 * ((size_t)y * n + x) + c] = (float)l[c];
                }
            CHECK_STATUS(
                NCR_OK,
                sink.write(sink.user,
                           &(ncr_tile){
                               .point = point, .face = face, .width = n, .height = n, .rgb = rgb}));
        }
    free(rgb);
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, field));
    return field;
}

/* Pixel (i,j) of a width x height image: u = (i + 1/2)/width, v likewise; one texel of the sample
 * map for each pixel. */
static inline void rig_init(rig *r, uint32_t width, uint32_t height, size_t points)
{
    *r = (rig){.frame = {{0, 0, 0}, 0}};
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, width, height, &r->g));
    r->points.at = ncr_alloc_zero(NULL, points, sizeof *r->points.at);
    r->points.count = points;
    r->map.patch_count = r->map.page_count = 1;
    r->map.page_width = width;
    r->map.page_height = height;
    r->map.charts = ncr_alloc_zero(NULL, 1, sizeof *r->map.charts);
    r->map.charts[0] = (ncr_chart){.width = width, .height = height};
    r->map.index = ncr_alloc_zero(NULL, (size_t)width * height * 4, sizeof *r->map.index);
    for (size_t k = 0; k < (size_t)width * height; k++) {
        r->g.object[k] = 7;
        r->g.patch[k] = 0;
        r->g.u[k] = ((float)(k % width) + 0.5f) / (float)width;
        r->g.v[k] = ((float)(k / width) + 0.5f) / (float)height;
    }
    r->in =
        (ncr_shading_inputs){.object = 7, .points = &r->points, .frame = &r->frame, .map = &r->map};
}

static inline void rig_dispose(rig *r)
{
    ncr_gbuffer_dispose(NULL, &r->g);
    ncr_points_dispose(NULL, &r->points);
    ncr_sample_map_dispose(NULL, &r->map);
    ncr_lightfield_destroy(NULL, r->light);
    ncr_lightfield_destroy(NULL, r->probe_light);
}

static inline void rig_set_pixel(rig *r, size_t k, ncr_vec3 x, ncr_vec3 n, ncr_vec3 v)
{
    r->g.px[k] = x.x, r->g.py[k] = x.y, r->g.pz[k] = x.z;
    r->g.nx[k] = n.x, r->g.ny[k] = n.y, r->g.nz[k] = n.z;
    r->g.vx[k] = v.x, r->g.vy[k] = v.y, r->g.vz[k] = v.z;
}

static inline ncr_vec3 rig_x(const rig *r, size_t k)
{
    return v_make(r->g.px[k], r->g.py[k], r->g.pz[k]);
}

static inline ncr_vec3 rig_n(const rig *r, size_t k)
{
    return v_make(r->g.nx[k], r->g.ny[k], r->g.nz[k]);
}

/* The four nearest points above 85 degrees from the normal, by the definition. */
static inline void rig_choose(rig *r)
{
    for (size_t k = 0; k < (size_t)r->g.width * r->g.height; k++) {
        double best[4] = {INFINITY, INFINITY, INFINITY, INFINITY}, x[3], n[3], to[3];
        uint16_t *index = r->map.index + 4 * k;
        memset(index, 0xff, 4 * sizeof *index);
        v_to_d(rig_x(r, k), x);
        v_to_d(rig_n(r, k), n);
        for (size_t p = 0; p < r->points.count; p++) {
            d_sub(r->points.at[p].position, x, to);
            const double distance = d_length(to);
            if (d_dot(n, to) <= 0.08715574274765817 * distance || distance >= best[3])
                continue;
            int at = 3;
            for (; at > 0 && distance < best[at - 1]; at--) {
                best[at] = best[at - 1];
                index[at] = index[at - 1];
            }
            best[at] = distance;
            index[at] = (uint16_t)p;
        }
    }
}

/* The half of a sphere that faces an eye far away along +y - z / 2, about the origin, with `points`
 * spread evenly (a golden-angle spiral) at radius + epsilon. */
static inline void rig_sphere(rig *r, uint32_t side, double radius, size_t points, double epsilon)
{
    rig_init(r, side, side, points);
    const ncr_vec3 eye = v_unit(v_make(0.2f, -1, 0.4f));
    ncr_vec3 right, up;
    v_basis(eye, &right, &up);
    for (size_t k = 0; k < (size_t)side * side; k++) {
        const float a = 2 * r->g.u[k] - 1, b = 2 * r->g.v[k] - 1, q = a * a + b * b;
        if (q >= 0.98f) {
            r->g.object[k] = NCR_NONE;
            continue;
        }
        ncr_vec3 n = v_scale(eye, sqrtf(1 - q));
        n = v_unit(v_mad(v_mad(n, a, right), b, up));
        rig_set_pixel(r, k, v_scale(n, (float)radius), n, eye);
    }
    for (size_t p = 0; p < points; p++) {
        const double z = 1 - (2 * (double)p + 1) / (double)points,
                     phi = 2.399963229728653 * (double)p;
        const double rho = sqrt(1 - z * z), n[3] = {rho * cos(phi), rho * sin(phi), z};
        for (int c = 0; c < 3; c++) {
            r->points.at[p].position[c] = (radius + epsilon) * n[c];
            r->points.at[p].normal[c] = n[c];
        }
    }
    rig_choose(r);
}

static inline void rig_light_up(rig *r, uint32_t n, ncr_texel_format format, rig_light light)
{
    const ncr_point centre = {.position = {0, 0, 0}};
    r->light = rig_capture((uint32_t)r->points.count, r->points.at, n, format, light);
    r->probe_light = rig_capture(1, &centre, n, format, light);
    r->probe.light = r->probe_light;
    r->in.light = r->light;
    r->in.probe = &r->probe;
}

/* Shade with a method by name; the image must be disposed of. */
static inline ncr_image rig_shade(const rig *r, const char *method, ncr_term term,
                                  ncr_shade_stats *stats)
{
    ncr_method m;
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, method, &m));
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, r->g.width, r->g.height, 3, &image));
    CHECK_STATUS(NCR_OK,
                 ncr_method_shade(NULL, &m, term, NULL, NULL, &r->in, &r->g, &image, stats));
    return image;
}

/* Root mean square difference from the exact mirror image of the light, over the object. */
static inline double rig_mirror_rmse(const rig *r, const char *method, rig_light light)
{
    ncr_image image = rig_shade(r, method, NCR_TERM_REFLECT, NULL);
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < (size_t)r->g.width * r->g.height; k++) {
        if (r->g.object[k] == NCR_NONE)
            continue;
        const ncr_vec3 v = v_make(r->g.vx[k], r->g.vy[k], r->g.vz[k]);
        double x[3], d[3], l[3];
        v_to_d(rig_x(r, k), x);
        v_to_d(v_reflect(rig_n(r, k), v), d);
        light.radiance(light.user, x, d, l);
        for (size_t c = 0; c < 3; c++)
            sum += pow((double)image.data[3 * k + c] - l[c], 2);
        count += 3;
    }
    ncr_image_dispose(NULL, &image);
    return sqrt(sum / (double)count);
}

#endif
