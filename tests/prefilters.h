/* SPDX-License-Identifier: MIT
 * prefilters.h - light to filter, lobes to filter it by, and the sum over all texels to compare with. */
#ifndef NCR_TESTS_PREFILTERS_H
#define NCR_TESTS_PREFILTERS_H

#include "check.h"

#include "shading/prefilter.h"

static const double pi = 3.14159265358979323846;

static inline void texel_direction(uint32_t w, uint32_t h, double x, double y, double d[3])
{
    const double theta = (y + 0.5) * pi / h, phi = (x + 0.5) * 2 * pi / w;
    d[0] = sin(theta) * cos(phi);
    d[1] = sin(theta) * sin(phi);
    d[2] = cos(theta);
}

static inline void random_direction(uint64_t k, double d[3])
{
    const double z = 2 * ncr_uniform(k, 71) - 1, phi = 2 * pi * ncr_uniform(k, 72);
    const double s = sqrt(1 - z * z);
    d[0] = s * cos(phi);
    d[1] = s * sin(phi);
    d[2] = z;
}

typedef void light_fn(const double d[3], double out[3]);

/* A map of f at texel centres, or the mean of n x n samples in each texel. */
static inline ncr_image make_map(uint32_t w, uint32_t h, uint32_t n, light_fn *f)
{
    ncr_image map;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, w, h, 3, &map));
    for (uint32_t y = 0; y < h; y++) {
        for (uint32_t x = 0; x < w; x++) {
            double sum[3] = {0};
            for (uint32_t k = 0; k < n * n; k++) {
                double d[3], value[3];
                texel_direction(w, h, x + (k % n + 0.5) / n - 0.5, y + (k / n + 0.5) / n - 0.5, d);
                f(d, value);
                for (int c = 0; c < 3; c++)
                    sum[c] += value[c] / (n * n);
            }
            for (int c = 0; c < 3; c++)
                ncr_image_at(&map, x, y)[c] = (float)sum[c];
        }
    }
    return map;
}

/* Sky and ground, a window, a glow and a small sun. */
static inline void outdoor_light(const double d[3], double out[3])
{
    const double sun[3] = {0.48, 0.6, 0.64};
    const double c = d[0] * sun[0] + d[1] * sun[1] + d[2] * sun[2];
    for (int k = 0; k < 3; k++) {
        out[k] = d[2] > 0 ? 0.5 + 0.2 * k + d[2] : 0.2 + 0.1 * d[0];
        out[k] += d[1] < -0.8 && fabs(d[2]) < 0.4 ? 5 : 0;
        out[k] += 3 * exp(20 * (c - 1)) + (c > 0.9985 ? 3000 : 0);
    }
}

/* 1 from above, nothing from below. */
static inline void sky_light(const double d[3], double out[3])
{
    out[0] = out[1] = out[2] = d[2] > 0;
}

static inline ncr_prefilter *prefilter_of(const ncr_image *map, const ncr_prefilter_opts *opts)
{
    ncr_prefilter *p;
    CHECK_STATUS(NCR_OK, ncr_prefilter_create(NULL, map, opts, &p));
    return p;
}

static const ncr_lobe lambert = {.kind = NCR_LOBE_LAMBERT};
static const ncr_lobe several[] = {{.kind = NCR_LOBE_LAMBERT},
                                   {.kind = NCR_LOBE_PHONG, .parameter = 10},
                                   {.kind = NCR_LOBE_PHONG, .parameter = 60.5},
                                   {.kind = NCR_LOBE_GGX, .parameter = 0.25},
                                   {.kind = NCR_LOBE_BECKMANN, .parameter = 0.3}};
enum { lobe_count = sizeof several / sizeof *several };

/* ---- against brute force --------------------------------------------------------------------- */

enum { probes = 60 };

typedef struct probe_set {
    double d[probes][3];
    ncr_vec3 f[probes];
} probe_set;

static inline void make_probes(probe_set *out)
{
    for (uint64_t k = 0; k < probes; k++) {
        random_direction(k, out->d[k]);
        out->f[k] = (ncr_vec3){(float)out->d[k][0], (float)out->d[k][1], (float)out->d[k][2]};
    }
    out->d[0][0] = out->d[0][1] = 0;
    out->d[0][2] = 1;
    out->f[0] = (ncr_vec3){0, 0, 1};
}

typedef struct misses {
    double relative, most, size; /* rms over rms of the truth; largest; rms of the truth */
} misses;

static inline misses compare(const ncr_image *map, const ncr_prefilter *p, const ncr_lobe *lobe,
                             const ncr_prefilter_output *opts, ncr_prefilter_report *report)
{
    probe_set at;
    double want[probes][3], error = 0, size = 0;
    float got[probes][3];
    misses found = {0};
    make_probes(&at);
    CHECK_STATUS(NCR_OK, ncr_prefilter_direct(NULL, map, lobe, false, probes, at.d[0], want[0]));
    CHECK_STATUS(NCR_OK,
                 ncr_prefilter_directions(NULL, p, lobe, opts, probes, at.f, got[0], report));
    for (int k = 0; k < 3 * probes; k++) {
        const double e = (double)got[k / 3][k % 3] - want[k / 3][k % 3];
        error += e * e;
        size += want[k / 3][k % 3] * want[k / 3][k % 3];
        found.most = fmax(found.most, fabs(e));
    }
    found.relative = sqrt(error / size);
    found.size = sqrt(size / (3 * probes));
    return found;
}

#endif
