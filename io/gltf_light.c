/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [EXTibl]         G. Hsu, M. Bond. glTF extension EXT_lights_image_based. 2019
 *   [Ramamoorthi01]  R. Ramamoorthi, P. Hanrahan. An Efficient Representation for Irradiance
 *                    Environment Maps. 2001
 */
#include "io/gltf_light_internal.h"
#include "io/rgbd_internal.h"
#include "shading/convention.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- Irradiance ---- */

/* With the sign of Condon and Shortley: (-1)^m. */
static void harmonics(const double d[3], double y[9])
{
    const double a = sqrt(1 / (4 * pi)), b = sqrt(3 / (4 * pi)), c = sqrt(15 / (4 * pi));
    y[0] = a;
    y[1] = -b * d[1];
    y[2] = b * d[2];
    y[3] = -b * d[0];
    y[4] = c * d[0] * d[1];
    y[5] = -c * d[1] * d[2];
    y[6] = c / sqrt(12) * (3 * d[2] * d[2] - 1);
    y[7] = -c * d[0] * d[2];
    y[8] = c / 2 * (d[0] * d[0] - d[1] * d[1]);
}

/* The integral of the harmonics over a quarter of a texel, as at its middle. */
static void add_quarter(const ncr_directional_map *map, uint32_t part, double x, double y,
                        double out[9])
{
    const double w = ncr_map_part_width(map->kind, map->size), h = map->size;
    const ncr_map_coord at = {part, 2 * (x + 0.25) / w - 1, 2 * (y + 0.25) / h - 1};
    double own[3], world[3], d[3], value[9];
    const double area = ncr_map_solid_angle(map->kind, 2 * x / w - 1, 2 * (x + 0.5) / w - 1,
                                            2 * y / h - 1, 2 * (y + 0.5) / h - 1);
    ncr_map_to_direction(map->kind, at, own);
    ncr_axes_undo(map->axes, own, world);
    ncr_axes_apply(ncr_world_y_up(), world, d);
    d[0] = -d[0]; /* the cube's axes, as its faces have them */
    harmonics(d, value);
    for (int k = 0; k < 9; k++)
        out[k] += area * value[k];
}

void ncr_gltf_irradiance(const ncr_directional_map *map, double out[9][3])
{
    static const double band[9] = {1, 2 / 3.0, 2 / 3.0, 2 / 3.0, .25, .25, .25, .25, .25};
    memset(out, 0, 27 * sizeof(double));
    for (uint32_t part = 0; part < ncr_map_part_count(map->kind); part++) {
        for (uint32_t y = 0; y < map->size; y++) {
            double row[9][3] = {{0}};
            for (uint32_t x = 0; x < ncr_map_part_width(map->kind, map->size); x++) {
                const float *texel = ncr_directional_map_at(map, part, x, y);
                double sum[9] = {0};
                for (int k = 0; k < 4; k++)
                    add_quarter(map, part, x + 0.5 * (k & 1), y + 0.5 * (k >> 1), sum);
                for (int k = 0; k < 27; k++)
                    row[k / 3][k % 3] += sum[k / 3] * (double)texel[k % 3];
            }
            for (int k = 0; k < 27; k++)
                out[k / 3][k % 3] += pi * band[k / 3] * row[k / 3][k % 3];
        }
    }
}

/* ---- Faces ---- */

typedef struct tally {
    double values, sum, kept, squares, errors, worst;
    uint64_t clamped;
} tally;

static void judge(const float in[3], const uint8_t rgbd[4], double mean, tally *t)
{
    double out[3], most = mean;
    ncr_rgbd_to_floats(rgbd, out);
    for (int k = 0; k < 3; k++)
        most = in[k] > most ? (double)in[k] : most;
    for (int k = 0; k < 3; k++) {
        const double value = isfinite(in[k]) ? (double)in[k] : 0;
        const bool clamped = !(in[k] >= 0 && in[k] <= 255);
        t->clamped += clamped;
        t->sum += value;
        t->kept += clamped ? fmin(fmax(value, 0), 255) : value;
        if (clamped || most > 255)
            continue;
        t->errors += (out[k] - value) * (out[k] - value);
        t->squares += value * value;
        if (most > 0)
            t->worst = fmax(t->worst, fabs(out[k] - value) / most);
    }
}

static double mean_of(const ncr_image *image)
{
    const size_t count = (size_t)image->width * image->height * 3;
    double sum = 0;
    for (size_t k = 0; k < count; k++)
        sum += image->data[k] > 0 ? (double)image->data[k] : 0;
    return sum / (double)count;
}

static ncr_status add_faces(const ncr_ctx *ctx, const ncr_image *strip, double mean, uint8_t *rgba,
                            ncr_gltf_images *images, tally *t)
{
    const uint32_t n = strip->width;
    ncr_status status = NCR_OK;
    for (uint32_t face = 0; face < 6 && status == NCR_OK; face++) {
        for (size_t k = 0; k < (size_t)n * n; k++) {
            const float *in = strip->data + 3 * ((size_t)face * n * n + k);
            ncr_rgbd_from_floats(in, rgba + 4 * k);
            judge(in, rgba + 4 * k, mean, t);
        }
        status = ncr_gltf_add_png(ctx, images, n, rgba);
    }
    return status;
}

/* Faces as the extension has them, in a world with y up, divided by the intensity. */
static ncr_status lay_out(const ncr_ctx *ctx, const ncr_directional_map *map, uint32_t size,
                          double intensity, ncr_image *out)
{
    const ncr_convention *gltf = ncr_convention_find("gltf", NCR_MAP_CUBE);
    const ncr_status status = ncr_convention_write(ctx, gltf, ncr_world_y_up(), map, size, out);
    for (size_t k = 0; status == NCR_OK && k < (size_t)18 * size * size; k++)
        out->data[k] = (float)((double)out->data[k] / intensity);
    return status;
}

static ncr_status add_levels(const ncr_ctx *ctx, const ncr_directional_map *levels, uint32_t count,
                             uint32_t size, double intensity, ncr_gltf_images *images, tally *t)
{
    double mean = 0;
    uint8_t *rgba = ncr_alloc(ctx, 4 * (size_t)size * size);
    ncr_status status = rgba ? NCR_OK : NCR_E_NOMEM;
    for (uint32_t k = 0; k < count && status == NCR_OK; k++) {
        ncr_image strip;
        status = lay_out(ctx, &levels[k], size >> k, intensity, &strip);
        if (status == NCR_OK && k == 0)
            mean = mean_of(&strip);
        if (status == NCR_OK)
            status = add_faces(ctx, &strip, mean, rgba, images, t);
        ncr_image_dispose(ctx, &strip);
    }
    ncr_free(ctx, rgba);
    return status;
}

/* ---- The whole ---- */

static ncr_status check(const ncr_ctx *ctx, const char *path, const ncr_directional_map *levels,
                        uint32_t count, uint32_t size, const ncr_gltf_light_opts *o)
{
    if (o->struct_size != sizeof *o)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_gltf_light_write: the options have no struct_size");
    if (!(o->intensity >= 0 && o->intensity < INFINITY))
        return ncr_fail(ctx, NCR_E_ARG, "%s: an intensity of %g", path, o->intensity);
    if (!size || size > NCR_MAP_SIZE_MAX || (size & (size - 1)) || !count ||
        count > NCR_GLTF_LEVELS || !(size >> (count - 1)))
        return ncr_fail(
            ctx, NCR_E_ARG,
            "%s: %u levels of %u: the size should be a power of two, halved by each level", path,
            count, size);
    for (uint32_t k = 0; k < count; k++)
        if (levels[k].image.channels != 3)
            return ncr_fail(ctx, NCR_E_ARG, "%s: level %u has %u channels, not 3", path, k,
                            levels[k].image.channels);
    return NCR_OK;
}

static ncr_gltf_light_report summary(const tally *t)
{
    return (ncr_gltf_light_report){.clamped = t->clamped,
                                   .lost = t->sum != 0 ? (t->sum - t->kept) / t->sum : 0,
                                   .worst = t->worst,
                                   .rms = t->squares > 0 ? sqrt(t->errors / t->squares) : 0};
}

ncr_status ncr_gltf_light_write(const ncr_ctx *ctx, const char *path,
                                const ncr_directional_map *levels, uint32_t count, uint32_t size,
                                const double irradiance[9][3], const ncr_gltf_light_opts *opts,
                                ncr_gltf_light_report *report)
{
    const ncr_gltf_light_opts defaults = {.struct_size = sizeof defaults};
    ncr_gltf_light_opts o = opts ? *opts : defaults;
    ncr_gltf_images images = {0};
    tally t = {0};
    ncr_status status = check(ctx, path, levels, count, size, &o);
    o.intensity = o.intensity > 0 ? o.intensity : 1;
    if (status == NCR_OK)
        status = add_levels(ctx, levels, count, size, o.intensity, &images, &t);
    const ncr_gltf_light_report found = summary(&t);
    if (status == NCR_OK)
        status = ncr_gltf_put_file(ctx, path, &images, size, irradiance, &o, &found);
    ncr_free(ctx, images.data);
    if (status == NCR_OK && report)
        *report = found;
    return status;
}
