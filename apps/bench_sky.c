/* SPDX-License-Identifier: MIT */
#include "apps/bench_sky.h"

#include "core/random.h"
#include "core/vec_internal.h"

#include <math.h>

enum { light_count = 24 };

static const double pi = 3.14159265358979323846;

static void random_direction(uint64_t k, double d[3])
{
    const double z = 2 * ncr_uniform(2 * k, 1) - 1, phi = 2 * pi * ncr_uniform(2 * k + 1, 1);
    d[0] = sqrt(1 - z * z) * cos(phi);
    d[1] = sqrt(1 - z * z) * sin(phi);
    d[2] = z;
}

static double sky_at(const double d[3], const double (*light)[3], int channel)
{
    double sum = 0.3 + 0.2 * d[2];
    for (int k = 0; k < light_count; k++) {
        const double width = 0.05 + 0.05 * k, gap = 1 - d_dot(d, light[k]);
        sum += (0.2 + 0.1 * ((k + channel) % 3)) * exp(-gap / (width * width));
    }
    return 1 - d_dot(d, light[3]) < 4e-5 ? 5000 : sum;
}

ncr_status bench_sky(const ncr_ctx *ctx, uint32_t width, uint32_t height, ncr_directional_map *out)
{
    double light[light_count][3];
    for (uint64_t k = 0; k < light_count; k++)
        random_direction(k, light[k]);
    ncr_status status = ncr_directional_map_init(ctx, NCR_MAP_LATLONG, height, 3, out);
    for (uint32_t y = 0; status == NCR_OK && y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const double theta = (y + 0.5) * pi / height, phi = (x + 0.5) * 2 * pi / width;
            const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
            float *at = ncr_image_at(&out->image, x, y);
            for (int c = 0; c < 3; c++)
                at[c] = (float)(sky_at(d, (const double(*)[3])light, c) *
                                (0.9 + 0.2 * ncr_uniform(y * (uint64_t)width + x, 2)));
        }
    if (status == NCR_OK)
        ncr_directional_map_seal(out);
    return status;
}

void bench_sky_probes(uint32_t width, uint32_t height, size_t count, double (*d)[3], size_t *texel)
{
    for (size_t k = 0; k < count; k++) {
        double at[3];
        random_direction(1000 + k, at);
        const double u = atan2(at[1], at[0]) / (2 * pi);
        const uint32_t x = (uint32_t)((u < 0 ? u + 1 : u) * width) % width;
        const uint32_t y = (uint32_t)(acos(at[2]) / pi * height) % height;
        const double theta = (y + 0.5) * pi / height, phi = (x + 0.5) * 2 * pi / width;
        d[k][0] = sin(theta) * cos(phi);
        d[k][1] = sin(theta) * sin(phi);
        d[k][2] = cos(theta);
        texel[k] = (size_t)y * width + x;
    }
}

double bench_nrmse(size_t count, const float *have, const double *want)
{
    double off = 0, whole = 0;
    for (size_t k = 0; k < count; k++) {
        const double gap = (double)have[k] - want[k];
        off += gap * gap;
        whole += want[k] * want[k];
    }
    return sqrt(off / whole);
}
