/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "shading/rsibr_disc.h"

#include "core/vec_internal.h"
#include "shading/rsibr_internal.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* Where one of the three eyes has a direction, and how far it is trusted there. */
typedef struct corner {
    float s, t, trust;
} corner;

typedef struct draw_job {
    const ncr_rsibr *set;
    ncr_rsibr_frame frame;
    ncr_view_share share;
    uint32_t rings, spokes;
    uint32_t map;
    ncr_rsibr_index index;
    corner *mesh; /* [3][rings + 1][spokes] */
    ncr_image *image;
} draw_job;

static corner warp(const draw_job *job, int eye, double s, double t)
{
    double d[3], out_s, out_t;
    ncr_rsibr_direction(&job->frame, job->index, s, t, d);
    const ncr_rsibr_frame *source = &job->set->frame[job->share.view[eye]];
    const double c = ncr_rsibr_place(source, job->index, d, &out_s, &out_t);
    return (corner){(float)out_s, (float)out_t, (float)ncr_rsibr_trust(c)};
}

/* --- the disc ---------------------------------------------------------------------------------- */

/* Rings stand evenly in the angle of what is mirrored: rho = sin(angle / 2). */
static double ring_radius(const draw_job *job, uint32_t ring)
{
    return sin(0.5 * pi * ring / job->rings);
}

static void warp_ring(size_t first, size_t past, unsigned worker, void *arg)
{
    const draw_job *job = arg;
    const size_t rings = job->rings + 1;
    (void)worker;
    for (size_t k = first; k < past; k++) {
        const double rho = ring_radius(job, (uint32_t)(k % rings));
        for (uint32_t j = 0; j < job->spokes; j++) {
            const double phi = 2 * pi * j / job->spokes;
            job->mesh[k * job->spokes + j] =
                warp(job, (int)(k / rings), rho * cos(phi), rho * sin(phi));
        }
    }
}

/* Three corners of the mesh, as places in one eye's part of it, and their shares of a texel. */
typedef struct triangle {
    size_t at[3];
    double share[3];
} triangle;

/* Between two spokes a texel is a u + b w, u and w their directions; a + b says between which chords
 * it lies. The quad there has its diagonal from the inner corner at u to the outer one at w. Beyond
 * the last chord the last triangle goes on. */
static triangle find_triangle(const draw_job *job, double s, double t)
{
    const double step = 2 * pi / job->spokes, phi = atan2(t, s);
    const double turn = phi < 0 ? phi + 2 * pi : phi;
    uint32_t j = (uint32_t)(turn / step);
    j = j < job->spokes ? j : job->spokes - 1;
    const double rho = hypot(s, t), from = turn - j * step;
    const double b = rho * sin(from) / sin(step), a = rho * sin(step - from) / sin(step);
    const double level = a + b;
    uint32_t k = (uint32_t)(2 / pi * asin(fmin(level, 1)) * job->rings);
    k = k < job->rings ? k : job->rings - 1;
    const double inner = ring_radius(job, k), outer = ring_radius(job, k + 1);
    const uint32_t next = (j + 1) % job->spokes;
    const size_t low = (size_t)k * job->spokes, high = low + job->spokes;
    triangle tri = {.at = {low + j, high + next, high + j}};
    if (a * outer + b * inner >= inner * outer) { /* beyond the diagonal */
        tri.share[1] = b / outer;
        tri.share[0] = (outer - level) / (outer - inner);
        tri.share[2] = 1 - tri.share[0] - tri.share[1];
    } else {
        tri.at[2] = low + next;
        tri.share[1] = (level - inner) / (outer - inner);
        tri.share[0] = a / inner;
        tri.share[2] = 1 - tri.share[0] - tri.share[1];
    }
    return tri;
}

static corner interpolate(const corner *mesh, const triangle *tri)
{
    double s = 0, t = 0, trust = 0;
    for (int i = 0; i < 3; i++) {
        const corner *c = &mesh[tri->at[i]];
        s += tri->share[i] * (double)c->s;
        t += tri->share[i] * (double)c->t;
        trust += tri->share[i] * (double)c->trust;
    }
    return (corner){(float)s, (float)t, (float)fmax(trust, 0)};
}

/* --- texels ------------------------------------------------------------------------------------ */

/* The map's albedo times the mean of the three eyes; where none is trusted, of the first one's. */
static void draw_texel(const draw_job *job, double s, double t, float *out)
{
    const ncr_rsibr *set = job->set;
    double mean[3] = {0}, albedo[3] = {1, 1, 1}, sum = 0;
    float texel[3];
    const triangle tri = job->rings ? find_triangle(job, s, t) : (triangle){0};
    const size_t corners = ((size_t)job->rings + 1) * job->spokes;
    for (int i = 0; i < 3; i++) {
        const corner c =
            job->rings ? interpolate(job->mesh + (size_t)i * corners, &tri) : warp(job, i, s, t);
        const double weight = job->share.weight[i] * fmax((double)c.trust, 1e-12);
        ncr_rsibr_bilinear(ncr_rsibr_map(set, job->map, job->share.view[i]), set->size, (double)c.s,
                           (double)c.t, texel);
        for (int k = 0; k < 3; k++)
            mean[k] += weight * (double)texel[k];
        sum += weight;
    }
    if (!set->raw)
        ncr_rsibr_albedo(set, job->map, sqrt(fmax(0, 1 - s * s - t * t)), 0, albedo);
    for (int k = 0; k < 3; k++)
        out[k] += (float)(albedo[k] * mean[k] / sum);
}

static void draw_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const draw_job *job = arg;
    const uint32_t n = job->image->width;
    (void)worker;
    for (size_t y = first; y < past; y++)
        for (uint32_t x = 0; x < n; x++) {
            const double s = 2 * (x + 0.5) / n - 1, t = 2 * ((double)y + 0.5) / n - 1;
            float *out = ncr_image_at(job->image, x, (uint32_t)y);
            if (s * s + t * t > 1)
                continue;
            if (job->map == 0)
                out[0] = out[1] = out[2] = 0;
            draw_texel(job, s, t, out);
        }
}

static ncr_status draw_map(const ncr_ctx *ctx, draw_job *job)
{
    const ncr_rsibr *set = job->set;
    job->index =
        set->single ? NCR_RSIBR_BY_MIRROR : ncr_rsibr_lobe_index(&set->brdf.lobe[job->map]);
    ncr_status status = NCR_OK;
    if (job->rings)
        status = ncr_parallel_for(ctx, 3 * ((size_t)job->rings + 1), 4, warp_ring, job);
    return status == NCR_OK ? ncr_parallel_for(ctx, job->image->height, 8, draw_rows, job) : status;
}

static ncr_status check(const ncr_ctx *ctx, const draw_job *job, const ncr_image *image)
{
    if (image->channels != 3 || image->width != image->height)
        return ncr_fail(ctx, NCR_E_ARG, "a radiance map of %u x %u texels, %u channels",
                        image->width, image->height, image->channels);
    if (job->set->turns)
        return ncr_fail(ctx, NCR_E_ARG,
                        "brushed metal has no map of its own: it asks for tangents");
    if (job->rings > NCR_RSIBR_RINGS_MAX || job->spokes > 8 * NCR_RSIBR_RINGS_MAX ||
        (job->rings && job->spokes < 3))
        return ncr_fail(ctx, NCR_E_ARG, "a disc of %u rings and %u spokes", job->rings,
                        job->spokes);
    return NCR_OK;
}

ncr_status ncr_rsibr_draw(const ncr_ctx *ctx, const ncr_rsibr *set, const double eye[3],
                          const ncr_rsibr_disc *disc, ncr_image *image)
{
    draw_job job = {.set = set, .frame = ncr_rsibr_frame_of(eye), .image = image};
    job.share = ncr_view_sphere_share(&set->sphere, disc ? disc->rule : NCR_VIEW_PLANAR, eye);
    job.rings = disc ? disc->rings : 0;
    job.spokes = disc && disc->spokes ? disc->spokes : 4 * job.rings;
    ncr_status status = check(ctx, &job, image);
    if (status != NCR_OK)
        return status;
    if (job.rings) {
        job.mesh = ncr_alloc(ctx, 3 * ((size_t)job.rings + 1) * job.spokes * sizeof *job.mesh);
        if (!job.mesh)
            return NCR_E_NOMEM;
    }
    for (; status == NCR_OK && job.map < set->maps; job.map++)
        status = draw_map(ctx, &job);
    ncr_free(ctx, job.mesh);
    return status;
}
