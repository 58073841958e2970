/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "apps/draw_ball.h"

#include "core/vec_internal.h"

#include <stdio.h>
#include <string.h>

enum { size_by_default = 256 };
static const double inner = 0.45; /* cosine above which no triangle is pinched */

typedef struct draw_job {
    const app *a;
    double eye[3];
    ncr_rsibr_disc disc;
    ncr_rsibr set;
    ncr_image image, pixels;   /* as asked for; warped pixel by pixel */
    double most[2], square[2]; /* differences: of the whole disc, of its inner part */
    size_t count[2];
} draw_job;

static ncr_status read_words(draw_job *job, const draw_ball_options *o)
{
    const ncr_ctx *ctx = &job->a->ctx;
    char after = 0;
    double *e = job->eye;
    job->disc.struct_size = sizeof job->disc;
    if (sscanf(o->eye, "%lf,%lf,%lf%c", &e[0], &e[1], &e[2], &after) != 3 || !d_normalize(e) ||
        !isfinite(e[0] + e[1] + e[2]))
        return ncr_fail(ctx, NCR_E_ARG,
                        "--draw %s: expected a direction, three numbers with "
                        "commas between",
                        o->eye);
    if (!o->warp || !strcmp(o->warp, "pixel"))
        return NCR_OK;
    if (sscanf(o->warp, "disc:%u%c", &job->disc.rings, &after) != 1 || !job->disc.rings)
        return ncr_fail(ctx, NCR_E_ARG, "--warp %s: expected pixel or disc:RINGS", o->warp);
    return NCR_OK;
}

static ncr_status draw(draw_job *job, uint32_t size)
{
    const ncr_ctx *ctx = &job->a->ctx;
    ncr_status status = ncr_image_init(ctx, size, size, 3, &job->image);
    if (status == NCR_OK)
        status = ncr_rsibr_draw(ctx, &job->set, job->eye, &job->disc, &job->image);
    if (status == NCR_OK && job->disc.rings)
        status = ncr_image_init(ctx, size, size, 3, &job->pixels);
    if (status == NCR_OK && job->disc.rings)
        status = ncr_rsibr_draw(ctx, &job->set, job->eye, NULL, &job->pixels);
    return status;
}

/* The least cosine at which the eyes that are blended see what a place mirrors. */
static double least_cosine(const draw_job *job, const ncr_rsibr_frame *frame, double s, double t)
{
    const ncr_view_share share = ncr_view_sphere_share(&job->set.sphere, job->disc.rule, job->eye);
    double d[3], x, y, least = 1;
    ncr_rsibr_direction(frame, NCR_RSIBR_BY_MIRROR, s, t, d);
    for (int i = 0; i < 3; i++)
        least = fmin(
            least, ncr_rsibr_place(&job->set.frame[share.view[i]], NCR_RSIBR_BY_MIRROR, d, &x, &y));
    return least;
}

static void compare(draw_job *job)
{
    const uint32_t n = job->image.width;
    const ncr_rsibr_frame frame = ncr_rsibr_frame_of(job->eye);
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < n; x++) {
            const double s = 2 * (x + 0.5) / n - 1, t = 2 * (y + 0.5) / n - 1;
            if (s * s + t * t > 1)
                continue;
            const int parts = least_cosine(job, &frame, s, t) > inner ? 2 : 1;
            for (int c = 0; c < 3; c++) {
                const double off = (double)(ncr_image_at(&job->image, x, y)[c] -
                                            ncr_image_at(&job->pixels, x, y)[c]);
                for (int part = 0; part < parts; part++) {
                    job->most[part] = fmax(job->most[part], fabs(off));
                    job->square[part] += off * off;
                    job->count[part]++;
                }
            }
        }
}

static double rms(const draw_job *job, int part)
{
    return job->count[part] ? sqrt(job->square[part] / (double)job->count[part]) : 0;
}

static void report(const draw_job *job, const char *out)
{
    const app *a = job->a;
    const ncr_rsibr_disc *d = &job->disc;
    if (d->rings)
        app_say(a,
                "%s: a disc of %u rings, off from warping every pixel by %.2e rms, %.2e at most; "
                "by %.2e at most where all eyes see what is mirrored at a cosine above %g",
                out, d->rings, rms(job, 0), job->most[0], job->most[1], inner);
    else
        app_say(a, "%s: every pixel warped by itself", out);
    app_print_json(a, json_pack("{s:s, s:[f,f,f], s:i, s:i, s:{s:f, s:f}, s:{s:f, s:f}}", "schema",
                                "nacre.rsibr/1", "eye", job->eye[0], job->eye[1], job->eye[2],
                                "size", (int)job->image.width, "rings", (int)d->rings, "error",
                                "rms", rms(job, 0), "most", job->most[0], "inner_error", "rms",
                                rms(job, 1), "most", job->most[1]));
}

ncr_status draw_ball(const app *a, const draw_ball_options *o, const char *folder, uint32_t size,
                     const char *out)
{
    draw_job job = {.a = a};
    ncr_status status = read_words(&job, o);
    if (status == NCR_OK)
        status = ncr_rsibr_read(&a->ctx, folder, &job.set);
    if (status == NCR_OK)
        status = draw(&job, size ? size : size_by_default);
    if (status == NCR_OK && job.disc.rings)
        compare(&job);
    if (status == NCR_OK)
        status = ncr_image_write(&a->ctx, out, &job.image, NULL);
    if (status == NCR_OK)
        report(&job, out);
    ncr_image_dispose(&a->ctx, &job.image);
    ncr_image_dispose(&a->ctx, &job.pixels);
    ncr_rsibr_dispose(&a->ctx, &job.set);
    return status;
}
