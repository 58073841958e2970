/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]      B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99
 *   [Kasa76] I. Kasa. A Circle Fitting Procedure and Its Error Analysis. IEEE Transactions on
 *            Instrumentation and Measurement, 1976 */
#include "shading/ball_photo.h"

#include "core/vec_internal.h"
#include "shading/rsibr.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- the outline ------------------------------------------------------------------------------- */

typedef struct outline {
    size_t count;
    double (*at)[2]; /* [2 (width + height)] */
} outline;

static float largest_value(const ncr_image *image)
{
    float most = 0;
    const size_t count = (size_t)image->width * image->height * image->channels;
    for (size_t k = 0; k < count; k++)
        most = fmaxf(most, image->data[k]);
    return most;
}

static bool is_ball(const ncr_image *image, float above, uint32_t x, uint32_t y)
{
    const float *texel = ncr_image_at(image, x, y);
    if (image->channels == 4)
        return texel[3] > 0.5f;
    bool lit = false;
    for (uint32_t c = 0; c < image->channels; c++)
        lit = lit || texel[c] > above;
    return lit;
}

/* First and last pixel of the ball along row or column k; false when there is none, or when it
 * touches the picture's border, where the outline is cut. */
static bool find_ends(const ncr_image *image, float above, bool column, uint32_t k, uint32_t *first,
                      uint32_t *last)
{
    const uint32_t length = column ? image->height : image->width;
    uint32_t lo = 0, hi = length;
    while (lo < length && !is_ball(image, above, column ? k : lo, column ? lo : k))
        lo++;
    while (hi > lo && !is_ball(image, above, column ? k : hi - 1, column ? hi - 1 : k))
        hi--;
    *first = lo;
    *last = hi;
    return lo > 0 && hi < length && hi > lo;
}

static void trace_outline(const ncr_image *image, outline *out)
{
    const float above = 1e-3f * largest_value(image);
    for (int column = 0; column < 2; column++) {
        const uint32_t lines = column ? image->width : image->height;
        for (uint32_t k = 0; k < lines; k++) {
            uint32_t ends[2];
            if (!find_ends(image, above, column, k, &ends[0], &ends[1]))
                continue;
            for (int i = 0; i < 2; i++) {
                out->at[out->count][column] = ends[i];
                out->at[out->count++][!column] = k + 0.5;
            }
        }
    }
}

/* Least |x^2 + y^2 - 2 a x - 2 b y - c|, about the mean of the points, by Cramer's rule; points
 * farther than `reach` from the circle so far are left out.                          [Kasa76] */
static bool fit(const outline *o, double reach, ncr_ball_circle *circle)
{
    double mean[2] = {0}, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, z = 0;
    size_t count = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t k = 0; k < o->count; k++) {
            double x = o->at[k][0], y = o->at[k][1];
            if (fabs(hypot(x - circle->x, y - circle->y) - circle->radius) > reach)
                continue;
            if (pass == 0) {
                mean[0] += x;
                mean[1] += y;
                count++;
                continue;
            }
            x -= mean[0];
            y -= mean[1];
            const double square = x * x + y * y;
            xx += x * x;
            xy += x * y;
            yy += y * y;
            xz += x * square;
            yz += y * square;
            z += square;
        }
        if (pass == 0 && count) {
            mean[0] /= (double)count;
            mean[1] /= (double)count;
        }
    }
    const double det = xx * yy - xy * xy;
    if (count < 8 || !(det > 1e-9 * (xx + yy) * (xx + yy)))
        return false;
    const double a = 0.5 * (xz * yy - yz * xy) / det, b = 0.5 * (yz * xx - xz * xy) / det;
    *circle = (ncr_ball_circle){mean[0] + a, mean[1] + b, sqrt(z / (double)count + a * a + b * b)};
    return true;
}

static double misfit_of(const outline *o, const ncr_ball_circle *circle)
{
    double square = 0;
    for (size_t k = 0; k < o->count; k++)
        square += pow(hypot(o->at[k][0] - circle->x, o->at[k][1] - circle->y) - circle->radius, 2);
    return sqrt(square / (double)o->count);
}

ncr_status ncr_ball_circle_fit(const ncr_ctx *ctx, const ncr_image *image, ncr_ball_circle *out,
                               double *misfit)
{
    ncr_ball_circle circle = {0};
    outline o = {0};
    *out = circle;
    o.at = ncr_alloc(ctx, 2 * ((size_t)image->width + image->height) * sizeof *o.at);
    if (!o.at)
        return NCR_E_NOMEM;
    trace_outline(image, &o);
    bool found = fit(&o, INFINITY, &circle);
    for (int pass = 0; found && pass < 3; pass++)
        found = fit(&o, fmax(1, misfit_of(&o, &circle)), &circle);
    const double off = found ? misfit_of(&o, &circle) : 0;
    ncr_free(ctx, o.at);
    if (!found)
        return ncr_fail(ctx, NCR_E_DEGENERATE, "no outline of a ball on a black ground");
    if (off > 1 && off > 0.02 * circle.radius)
        return ncr_fail(ctx, NCR_E_DEGENERATE,
                        "the outline is %.2g pixels off a circle of radius %.4g: no ball on a "
                        "black ground",
                        off, circle.radius);
    *out = circle;
    if (misfit)
        *misfit = off;
    return NCR_OK;
}

/* --- the light --------------------------------------------------------------------------------- */

typedef struct photo_job {
    const ncr_image *image;
    const ncr_ball_photo *photo;
    ncr_rsibr_frame frame;
    double nearness;   /* 1 / distance: 0 for parallel rays */
    double last;       /* angle of the outline from the axis */
    double scale, rim; /* 1 / reflectance; share of the radius to keep within */
} photo_job;

/* With e = 1/D, the eye's slant at a place: atan2(e sin a, 1 - e cos a). */
static double slant(const photo_job *job, double a)
{
    return atan2(job->nearness * sin(a), 1 - job->nearness * cos(a));
}

/* The angle a that mirrors the direction at `angle` from the axis: 2 a + slant(a) = angle, which
 * rises, by guarded Newton steps. */
static double find_place(const photo_job *job, double angle)
{
    double low = 0, high = job->last, a = fmin(0.5 * angle, high);
    const double e = job->nearness;
    if (2 * high + slant(job, high) <= angle)
        return high;
    for (int step = 0; step < 60 && high - low > 1e-15; step++) {
        const double over = 2 * a + slant(job, a) - angle;
        const double rise = 2 + (e * cos(a) - e * e) / (1 - 2 * e * cos(a) + e * e);
        if (over > 0)
            high = a;
        else
            low = a;
        const double next = a - over / rise;
        if (fabs(over) < 1e-14)
            break;
        a = next > low && next < high ? next : 0.5 * (low + high);
    }
    return a;
}

static void pixel(const photo_job *job, double x, double y, float *out)
{
    const ncr_image *image = job->image;
    const double px = fmin(fmax(x - 0.5, 0), image->width - 1.0);
    const double py = fmin(fmax(y - 0.5, 0), image->height - 1.0);
    const uint32_t i = px < image->width - 2.0 ? (uint32_t)px : image->width - 2;
    const uint32_t j = py < image->height - 2.0 ? (uint32_t)py : image->height - 2;
    const double fx = px - i, fy = py - j;
    for (int c = 0; c < 3; c++) {
        const double a = (double)ncr_image_at(image, i, j)[c];
        const double b = (double)ncr_image_at(image, i + 1, j)[c];
        const double d = (double)ncr_image_at(image, i, j + 1)[c];
        const double e = (double)ncr_image_at(image, i + 1, j + 1)[c];
        const double upper = a + fx * (b - a), lower = d + fx * (e - d);
        out[c] = (float)(job->scale * (upper + fy * (lower - upper)));
    }
}

/* rho = sin a sqrt(1 - e^2) / (1 - e cos a), kept half a pixel off the outline, which mixes the ball
 * with what is beside it. */
static void seen(const double d[3], void *user, float *out)
{
    const photo_job *job = user;
    const ncr_ball_circle *circle = &job->photo->circle;
    const double e = job->nearness;
    const double x = d_dot(d, job->frame.axis[0]), y = d_dot(d, job->frame.axis[1]);
    const double flat = hypot(x, y), a = find_place(job, atan2(flat, d_dot(d, job->frame.axis[2])));
    const double rho = fmin(sin(a) * sqrt((1 - e) * (1 + e)) / (1 - e * cos(a)), job->rim);
    const double k = flat > 0 ? rho * circle->radius / flat : 0;
    pixel(job, circle->x + k * x, circle->y - k * y, out);
}

static ncr_status check(const ncr_ctx *ctx, const ncr_image *image, const ncr_ball_photo *photo,
                        const ncr_directional_map *map)
{
    const ncr_ball_circle *c = &photo->circle;
    if (!photo->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "options without a size");
    if (image->channels < 3 || image->channels > 4 || map->image.channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "a picture of %u channels into a map of %u",
                        image->channels, map->image.channels);
    if (!(c->radius >= 2) || !(c->x - c->radius > -1) || !(c->y - c->radius > -1) ||
        !(c->x + c->radius < image->width + 1.0) || !(c->y + c->radius < image->height + 1.0))
        return ncr_fail(ctx, NCR_E_ARG,
                        "a ball of radius %g at (%g, %g) in a picture of %u x %u: it must lie "
                        "inside, and be 2 pixels at least",
                        c->radius, c->x, c->y, image->width, image->height);
    if (photo->distance != 0 && !(photo->distance > 1))
        return ncr_fail(ctx, NCR_E_ARG, "a camera %g radii from the ball's centre: above 1",
                        photo->distance);
    if (photo->reflectance != 0 && !(photo->reflectance > 0 && photo->reflectance <= 1))
        return ncr_fail(ctx, NCR_E_ARG, "a ball of reflectance %g", photo->reflectance);
    if (!(d_length(photo->view) < 1e30))
        return ncr_fail(ctx, NCR_E_ARG, "a view that is no direction");
    return NCR_OK;
}

ncr_status ncr_ball_photo_map(const ncr_ctx *ctx, const ncr_image *image,
                              const ncr_ball_photo *photo, ncr_directional_map *map, double *blind)
{
    static const double front[3] = {0, 1, 0};
    ncr_status status = check(ctx, image, photo, map);
    if (status != NCR_OK)
        return status;
    photo_job job = {.image = image, .photo = photo};
    job.frame = ncr_rsibr_frame_of(d_length(photo->view) > 0 ? photo->view : front);
    job.nearness = photo->distance > 0 ? 1 / photo->distance : 0;
    job.last = acos(job.nearness);
    job.scale = photo->reflectance > 0 ? 1 / photo->reflectance : 1;
    job.rim = 1 - 0.75 / photo->circle.radius;
    if (blind)
        *blind = pi - 2 * job.last - slant(&job, job.last);
    return ncr_directional_map_fill(ctx, map, 1 / photo->circle.radius, seen, &job);
}
