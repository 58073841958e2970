/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [H]        W. Heidrich. Environment Maps And Their Applications. Tutorial, 2000
 *   [Gooch98]  A. Gooch, B. Gooch, P. Shirley, E. Cohen. A Non-Photorealistic Lighting Model for
 *              Automatic Technical Illustration. SIGGRAPH 1998 */
#include "shading/npr_map.h"

#include <math.h>
#include <string.h>

/* --- drawings: a colour for each place of the unit disc and around it -------------------------- */

static const float white[3] = {1, 1, 1}, black[3] = {0, 0, 0};

static const float *draw_ring(double s, double t)
{
    return 1 - s * s - t * t < 0.45 * 0.45 ? black : white;
}

/* Blue below, yellow above, a white spot: to be blurred. */
static const float *draw_cool_warm(double s, double t)
{
    static const float cool[3] = {0.05f, 0.09f, 0.42f}, warm[3] = {0.80f, 0.62f, 0.12f};
    if (hypot(s + 0.42, t - 0.45) < 0.24)
        return white;
    return t > s ? warm : cool;
}

/* Two by two panes, up and to the left, in a frame that bends with the ball. */
static const float *draw_window(double s, double t)
{
    const double bend = 1 + 0.35 * (s * s + t * t), x = (s + 0.36) * bend, y = (t - 0.34) * bend;
    const bool bar = fabs(x) < 0.035 || fabs(y) < 0.035;
    return fabs(x) < 0.36 && fabs(y) < 0.40 && !bar ? white : black;
}

static const float *draw_hatching(double s, double t)
{
    const double rho = hypot(s, t), ink = (rho - 0.55) / 0.45;
    const double along = (s + t) * 16, stroke = fabs(along - floor(along) - 0.5) * 2;
    return stroke < ink ? black : white;
}

typedef const float *drawing(double s, double t);

typedef struct canvas {
    drawing *draw; /* NULL: an outline */
    double inner;  /* where its line begins */
    const ncr_image *image;
} canvas;

/* Each texel is the mean of 4 x 4 places. */
static void draw_rows(size_t begin, size_t end, unsigned worker, void *arg)
{
    enum { places = 4 };
    const canvas *c = arg;
    const uint32_t n = c->image->width;
    (void)worker;
    for (size_t y = begin; y < end; y++)
        for (uint32_t x = 0; x < n; x++) {
            float sum[3] = {0};
            for (int k = 0; k < places * places; k++) {
                const double s = 2 * (x + (k % places + 0.5) / places) / n - 1;
                const double t = 1 - 2 * ((double)y + (k / places + 0.5) / places) / n;
                const float *rgb = c->draw ? c->draw(s, t) : hypot(s, t) > c->inner ? black : white;
                for (int i = 0; i < 3; i++)
                    sum[i] += rgb[i] / (places * places);
            }
            memcpy(ncr_image_at(c->image, x, (uint32_t)y), sum, sizeof sum);
        }
}

/* The mean of 2 `radius` + 1 texels of a line, which goes on beyond its ends. */
static void blur_line(const float *in, size_t step, uint32_t n, uint32_t radius, float *out)
{
    for (size_t c = 0; c < 3; c++) {
        double sum = 0;
        for (long k = -(long)radius; k <= (long)radius; k++)
            sum += (double)in[(size_t)(k > 0 ? k : 0) * step + c];
        for (uint32_t k = 0; k < n; k++) {
            const size_t leaves = k > radius ? k - radius : 0;
            const size_t enters = k + radius + 1 < n ? k + radius + 1 : n - 1;
            out[3 * (size_t)k + c] = (float)(sum / (2.0 * radius + 1));
            sum += (double)in[enters * step + c] - (double)in[leaves * step + c];
        }
    }
}

/* Three times along rows and columns: nearly a bell. */
static ncr_status blur(const ncr_ctx *ctx, const ncr_image *image, uint32_t radius)
{
    const uint32_t n = image->width;
    float *line = ncr_alloc(ctx, 3 * (size_t)n * sizeof *line);
    if (!line)
        return NCR_E_NOMEM;
    for (int turn = 0; turn < 6; turn++)
        for (uint32_t y = 0; y < n; y++) {
            const bool down = turn % 2;
            float *from = down ? ncr_image_at(image, y, 0) : ncr_image_at(image, 0, y);
            const size_t step = down ? 3 * (size_t)n : 3;
            blur_line(from, step, n, radius, line);
            for (size_t k = 0; k < n; k++)
                memcpy(from + k * step, line + 3 * k, 3 * sizeof *line);
        }
    ncr_free(ctx, line);
    return NCR_OK;
}

static void halve(const ncr_image *in, const ncr_image *out)
{
    for (uint32_t y = 0; y < out->height; y++)
        for (uint32_t x = 0; x < out->width; x++)
            for (uint32_t c = 0; c < 3; c++)
                ncr_image_at(out, x, y)[c] = 0.25f * (ncr_image_at(in, 2 * x, 2 * y)[c] +
                                                      ncr_image_at(in, 2 * x + 1, 2 * y)[c] +
                                                      ncr_image_at(in, 2 * x, 2 * y + 1)[c] +
                                                      ncr_image_at(in, 2 * x + 1, 2 * y + 1)[c]);
}

static ncr_status fill_level(const ncr_ctx *ctx, ncr_npr_map *map, uint32_t k, double width)
{
    static drawing *const drawings[] = {NULL, draw_ring, draw_cool_warm, draw_window,
                                        draw_hatching};
    const ncr_image *image = &map->level[k];
    const bool outline = map->kind == NCR_NPR_OUTLINE;
    if (k > 0 && !outline) {
        halve(&map->level[k - 1], image);
        return NCR_OK;
    }
    canvas c = {drawings[map->kind], 1 - 2 * width / image->width, image};
    ncr_status status = ncr_parallel_for(ctx, image->height, 16, draw_rows, &c);
    if (status == NCR_OK && map->kind == NCR_NPR_COOL_WARM)
        status = blur(ctx, image, image->width / 14);
    return status;
}

ncr_status ncr_npr_map_init(const ncr_ctx *ctx, ncr_npr_kind kind, double width, ncr_npr_map *out)
{
    *out = (ncr_npr_map){.kind = kind};
    if (kind == NCR_NPR_OUTLINE && !(width >= 0.5 && width <= 16))
        return ncr_fail(ctx, NCR_E_ARG, "a line %g pixels wide, not 0.5 to 16", width);
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; status == NCR_OK && k < NCR_NPR_LEVELS; k++) {
        const uint32_t n = NCR_NPR_SIZE >> k;
        status = ncr_image_init(ctx, n, n, 3, &out->level[k]);
        if (status == NCR_OK)
            status = fill_level(ctx, out, k, width);
    }
    if (status != NCR_OK)
        ncr_npr_map_dispose(ctx, out);
    return status;
}

void ncr_npr_map_dispose(const ncr_ctx *ctx, ncr_npr_map *map)
{
    for (int k = 0; k < NCR_NPR_LEVELS; k++)
        ncr_image_dispose(ctx, &map->level[k]);
    *map = (ncr_npr_map){0};
}

/* Bilinear in one level, the outermost texels go on beyond it. Adds `weight` times the colour. */
static void add_level(const ncr_image *image, const float at[2], float weight, float rgb[3])
{
    const float last = (float)image->width - 1;
    const float x = fminf(fmaxf(0.5f * (at[0] + 1) * (float)image->width - 0.5f, 0), last);
    const float y = fminf(fmaxf(0.5f * (1 - at[1]) * (float)image->height - 0.5f, 0), last);
    const uint32_t i = (uint32_t)x, j = (uint32_t)y;
    const uint32_t i1 = i + 1 < image->width ? i + 1 : i, j1 = j + 1 < image->height ? j + 1 : j;
    const float a = x - (float)i, b = y - (float)j;
    const float w[4] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
    const float *texel[4] = {ncr_image_at(image, i, j), ncr_image_at(image, i1, j),
                             ncr_image_at(image, i, j1), ncr_image_at(image, i1, j1)};
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            rgb[c] += weight * w[k] * texel[k][c];
}

void ncr_npr_map_look_up(const ncr_npr_map *map, const float at[2], float step, float rgb[3])
{
    const float texels =
        fmaxf(step * (0.5f * NCR_NPR_SIZE), 1); /* of level 0 from pixel to pixel */
    const float level = fminf(log2f(texels), NCR_NPR_LEVELS - 1);
    const uint32_t k = (uint32_t)level;
    const float share = level - (float)k;
    rgb[0] = rgb[1] = rgb[2] = 0;
    add_level(&map->level[k], at, 1 - share, rgb);
    if (share > 0)
        add_level(&map->level[k + 1], at, share, rgb);
}
