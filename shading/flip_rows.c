/* SPDX-License-Identifier: MIT */
#include "shading/cielab_internal.h"
#include "shading/flip_internal.h"

#include <math.h>
#include <string.h>

/* This file follows:
 *   [Andersson20]  P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom,
 *                  M. D. Fairchild. FLIP: A Difference Evaluator for Alternating Images. 2020
 *   [Narkowicz15]  K. Narkowicz. ACES Filmic Tone Mapping Curve. 2015
 *
 * Loops without branches over plain rows, so that compilers turn them into vectors. Opponents are
 * kept as Y, X - Y, Y - Z relative to white: the factors 116, 500 and 200 and the offset 16 of
 * YCxCz pass through filters that sum to one, and are undone after them. */

static inline float between(float x, float lo, float hi)
{
    x = x > lo ? x : lo; /* NaN becomes lo */
    return x < hi ? x : hi;
}

static inline float dot3(const double row[3], float r, float g, float b)
{
    return (float)row[0] * r + (float)row[1] * g + (float)row[2] * b;
}

/* The filmic curve; beyond 1e6 it has long been clipped to 1. */
static inline float tone(float x, float factor)
{
    x = between(factor * between(x, 0.0f, 1e30f), 0.0f, 1e6f);
    const float top = x * (0.9036f * x + 0.018f);
    const float bottom = x * (0.8748f * x + 0.354f) + 0.14f;
    return between(top / bottom, 0.0f, 1.0f);
}

void ncr_flip_opponents(size_t width, const float *rgb, float factor, float *y, float *red_green,
                        float *blue_yellow)
{
    for (size_t k = 0; k < width; k++) {
        const float r = tone(rgb[3 * k], factor);
        const float g = tone(rgb[3 * k + 1], factor);
        const float b = tone(rgb[3 * k + 2], factor);
        const float luminance = dot3(ncr_xyz_from_rgb[1], r, g, b);
        y[k] = luminance;
        red_green[k] = dot3(ncr_xyz_from_rgb[0], r, g, b) - luminance;
        blue_yellow[k] = luminance - dot3(ncr_xyz_from_rgb[2], r, g, b);
    }
}

void ncr_flip_convolve(size_t n, const ncr_flip_taps *taps, const float *const *rows, bool add,
                       float *out)
{
    enum { block = ncr_flip_row_multiple };
    const int count = 2 * taps->radius + 1;
    for (size_t x = 0; x < n; x += block) {
        float sum[block] = {0};
        if (add)
            memcpy(sum, out + x, sizeof sum);
        for (int k = 0; k < count; k++) {
            const float weight = taps->weight[k];
            const float *row = rows[k] + x;
            for (int j = 0; j < block; j++)
                sum[j] += weight * row[j];
        }
        memcpy(out + x, sum, sizeof sum);
    }
}

/* Cube root of t in [2^-20, 4]: a third of the exponent, then Newton. Error below 3e-7. */
static inline float cube_root(float t)
{
    int32_t bits;
    memcpy(&bits, &t, sizeof bits);
    bits = (int32_t)((float)bits * (1.0f / 3.0f)) + 0x2a5137a0;
    float y;
    memcpy(&y, &bits, sizeof y);
    y -= (y - t / (y * y)) * (1.0f / 3.0f);
    y -= (y - t / (y * y)) * (1.0f / 3.0f);
    y -= (y - t / (y * y)) * (1.0f / 3.0f);
    return y;
}

static inline float lab_f(float t)
{
    const float curve = cube_root(t), line = (24389.0f / 27.0f * t + 16.0f) * (1.0f / 116.0f);
    return t > 216.0f / 24389.0f ? curve : line;
}

void ncr_flip_hunt_lab(size_t n, float *restrict y, float *restrict red_green,
                       float *restrict blue_yellow)
{
    for (size_t k = 0; k < n; k++) {
        const float luminance = y[k];
        const float x = luminance + red_green[k], z = luminance - blue_yellow[k];
        const float r = between(dot3(ncr_rgb_from_xyz[0], x, luminance, z), 0.0f, 1.0f);
        const float g = between(dot3(ncr_rgb_from_xyz[1], x, luminance, z), 0.0f, 1.0f);
        const float b = between(dot3(ncr_rgb_from_xyz[2], x, luminance, z), 0.0f, 1.0f);
        const float fx = lab_f(dot3(ncr_xyz_from_rgb[0], r, g, b));
        const float fy = lab_f(dot3(ncr_xyz_from_rgb[1], r, g, b));
        const float fz = lab_f(dot3(ncr_xyz_from_rgb[2], r, g, b));
        const float lightness = 116.0f * fy - 16.0f;
        y[k] = lightness;
        red_green[k] = 0.01f * lightness * (500.0f * (fx - fy));
        blue_yellow[k] = 0.01f * lightness * (200.0f * (fy - fz));
    }
}

void ncr_flip_magnitude(size_t n, float *restrict x, const float *restrict y)
{
    for (size_t k = 0; k < n; k++)
        x[k] = sqrtf(x[k] * x[k] + y[k] * y[k]);
}

/* |dL| + the distance in (a, b), between Hunt-adjusted colours. */
static inline float hyab(const ncr_flip_seen *p, const ncr_flip_seen *q, size_t k)
{
    const float l = p->lab[0][k] - q->lab[0][k];
    const float u = p->lab[1][k] - q->lab[1][k], v = p->lab[2][k] - q->lab[2][k];
    return fabsf(l) + sqrtf(u * u + v * v);
}

/* .7-th powers of the distance, up to that of green from blue, the largest, to [0, 1]: the first
 * .4 of the range take .95 of the scale.                                       [Andersson20 4.1.4]
 * tests/test_flip.c computes the largest again. */
static inline float redistribute(float distance)
{
    const float largest = 41.276570f, knee = 0.4f * largest;
    const float power = powf(distance, 0.7f);
    return power < knee ? 0.95f / knee * power : 0.95f + 0.05f * (power - knee) / (largest - knee);
}

void ncr_flip_difference(size_t width, const ncr_flip_seen *reference, const ncr_flip_seen *image,
                         float *error)
{
    for (size_t k = 0; k < width; k++) {
        const float colour = between(redistribute(hyab(reference, image, k)), 0.0f, 1.0f);
        const float edge = fabsf(reference->edge[k] - image->edge[k]);
        const float point = fabsf(reference->point[k] - image->point[k]);
        const float larger = edge > point ? edge : point;
        const float feature = between(sqrtf(0.70710678f * larger), 0.0f, 1.0f);
        const float flip = powf(colour, 1.0f - feature);
        error[k] = flip > error[k] ? flip : error[k];
    }
}
