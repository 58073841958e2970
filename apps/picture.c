/* SPDX-License-Identifier: MIT */
#include "apps/picture.h"

#include <math.h>
#include <png.h>
#include <string.h>

/* This file follows:
 *   [IEC61966]  IEC 61966-2-1. Default RGB colour space - sRGB. 1999
 *   [Smith15]   S. van der Walt, N. Smith. A Better Default Colormap for Matplotlib. 2015 */

static uint8_t byte_from_unit(double x)
{
    return (uint8_t)(255.0 * fmin(fmax(x, 0.0), 1.0) + 0.5);
}

static double srgb_from_linear(double x)
{
    x = fmin(fmax(x, 0.0), 1.0);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}

static void put_magenta(uint8_t *out)
{
    memcpy(out, (const uint8_t[3]){255, 0, 255}, 3);
}

void picture_from_image(const ncr_image *image, double exposure, uint8_t *out)
{
    const size_t pixels = (size_t)image->width * image->height, channels = image->channels;
    for (size_t k = 0; k < pixels; k++, out += 3) {
        const float *in = image->data + k * channels;
        bool finite = true;
        for (size_t c = 0; c < 3; c++) {
            const float x = in[channels < 3 ? 0 : c];
            finite &= isfinite(x) != 0;
            out[c] = byte_from_unit(srgb_from_linear(exposure * x));
        }
        if (!finite)
            put_magenta(out);
    }
}

/* Nine stops of viridis; straight lines between them stay within 2 levels of 255. [Smith15] */
void picture_ramp(double t, uint8_t rgb[3])
{
    static const double stops[9][3] = {
        {68, 1, 84},    {71, 44, 122}, {59, 81, 139},  {44, 113, 142}, {33, 144, 141},
        {39, 173, 129}, {92, 200, 99}, {170, 220, 50}, {253, 231, 37},
    };
    t = 8.0 * fmin(fmax(t, 0.0), 1.0);
    const int k = t < 7.0 ? (int)t : 7;
    for (int c = 0; c < 3; c++)
        rgb[c] = (uint8_t)(stops[k][c] + (t - k) * (stops[k + 1][c] - stops[k][c]) + 0.5);
}

static double shown_luminance(const float *p, double exposure)
{
    static const double weight[3] = {0.2126, 0.7152, 0.0722};
    double y = 0;
    for (int c = 0; c < 3; c++)
        y += weight[c] * fmin(fmax(exposure * p[c], 0.0), 1.0);
    return y;
}

void picture_difference(const ncr_image *reference, const ncr_image *image, const uint8_t *mask,
                        double exposure, double scale, uint8_t *out)
{
    const size_t pixels = (size_t)image->width * image->height;
    for (size_t k = 0; k < pixels; k++, out += 3) {
        const float *a = reference->data + 3 * k, *b = image->data + 3 * k;
        const double y = shown_luminance(a, exposure);
        const double difference = fabs((double)a[0] + a[1] + a[2] - b[0] - b[1] - b[2]);
        if (mask && !mask[k])
            memset(out, byte_from_unit(0.10 + 0.25 * srgb_from_linear(y)), 3);
        else if (!isfinite(difference))
            put_magenta(out);
        else
            picture_ramp(fabs(shown_luminance(b, exposure) - y) / scale, out);
    }
}

void picture_false_colour(const ncr_image *map, double lo, double hi, uint8_t *out)
{
    const size_t pixels = (size_t)map->width * map->height;
    for (size_t k = 0; k < pixels; k++, out += 3) {
        const float x = map->data[k * map->channels];
        if (isfinite(x))
            picture_ramp(hi > lo ? (x - lo) / (hi - lo) : 0.0, out);
        else
            put_magenta(out);
    }
}

ncr_status picture_encode_png(const ncr_ctx *ctx, uint32_t width, uint32_t height,
                              const uint8_t *rgb, uint8_t **png, size_t *size)
{
    png_image image = {
        .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_RGB};
    png_alloc_size_t bound = PNG_IMAGE_PNG_SIZE_MAX(image);
    uint8_t *bytes = ncr_alloc(ctx, bound);
    if (!bytes)
        return NCR_E_NOMEM;
    if (!png_image_write_to_memory(&image, bytes, &bound, 0, rgb, 0, NULL)) {
        ncr_free(ctx, bytes);
        return ncr_fail(ctx, NCR_E_BACKEND, "PNG: %s", image.message);
    }
    *png = bytes;
    *size = bound;
    return NCR_OK;
}
