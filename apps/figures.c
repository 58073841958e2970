/* SPDX-License-Identifier: MIT */
#include "apps/figures.h"

#include "apps/picture.h"
#include "core/vec_internal.h"
#include "sampling/false_color.h"

#include <math.h>

/* The pixel that shows frame position p, found by inverting ncr_camera_ray; false outside. */
static bool project(const ncr_gbuffer *g, const double p[3], const ncr_frame *frame,
                    const ncr_camera *camera, uint32_t *px, uint32_t *py)
{
    double eye[3], centre[3], right[3], down[3], to[3], along = 0, across = 0, below = 0;
    ncr_frame_from_model(frame, camera->eye, eye);
    const double w = g->width, h = g->height;
    ncr_camera_ray(camera, g->width, g->height, 0.5 * w, 0.5 * h, centre);
    ncr_camera_ray(camera, g->width, g->height, w, 0.5 * h, right);
    ncr_camera_ray(camera, g->width, g->height, 0.5 * w, h, down);
    /* The image plane at distance one: half its width and height as vectors. */
    double half_x = 0, half_y = 0;
    for (int c = 0; c < 3; c++)
        half_x += right[c] * centre[c], half_y += down[c] * centre[c], to[c] = p[c] - eye[c];
    for (int c = 0; c < 3; c++)
        right[c] = right[c] / half_x - centre[c], down[c] = down[c] / half_y - centre[c];
    double rr = 0, dd = 0;
    for (int c = 0; c < 3; c++) {
        along += to[c] * centre[c];
        rr += right[c] * right[c];
        dd += down[c] * down[c];
    }
    for (int c = 0; c < 3; c++) {
        across += to[c] * right[c] / rr;
        below += to[c] * down[c] / dd;
    }
    const double x = 0.5 * w * (1 + across / along), y = 0.5 * h * (1 + below / along);
    if (!(along > 0) || !(x >= 1) || !(y >= 1) || !(x < w - 1) || !(y < h - 1))
        return false;
    *px = (uint32_t)x;
    *py = (uint32_t)y;
    return true;
}

/* A 3x3 dot, unless the surface seen at that pixel is nearer to the eye. */
static void draw_dot(const ncr_gbuffer *g, const double p[3], const ncr_frame *frame,
                     const ncr_camera *camera, uint8_t *rgb)
{
    static const uint8_t ink[3] = {255, 235, 60};
    uint32_t x, y;
    double eye[3], seen = 0, own = 0;
    if (!project(g, p, frame, camera, &x, &y))
        return;
    const size_t k = (size_t)y * g->width + x;
    const double at[3] = {(double)g->px[k], (double)g->py[k], (double)g->pz[k]};
    ncr_frame_from_model(frame, camera->eye, eye);
    for (int c = 0; c < 3; c++) {
        seen += (at[c] - eye[c]) * (at[c] - eye[c]);
        own += (p[c] - eye[c]) * (p[c] - eye[c]);
    }
    if (g->object[k] != NCR_NONE && own > seen)
        return;
    for (uint32_t dy = 0; dy < 3; dy++)
        for (uint32_t dx = 0; dx < 3; dx++)
            for (int c = 0; c < 3; c++)
                rgb[3 * ((size_t)(y + dy - 1) * g->width + x + dx - 1) + (size_t)c] = ink[c];
}

/* Figure 3.5: the nearest point of each pixel's texel, each point its own colour. */
static ncr_status false_colour_figure(experiments *x, const lab_field *f)
{
    const ncr_gbuffer *g = &x->l->v.gbuffer;
    const size_t pixels = (size_t)g->width * g->height;
    uint8_t *rgb = ncr_alloc_zero(&x->l->a->ctx, pixels, 3);
    if (!rgb)
        return NCR_E_NOMEM;
    picture_from_image(&x->l->background, x->l->exposure, rgb);
    for (size_t k = 0; k < pixels; k++)
        if (x->l->mask[k])
            ncr_false_color(ncr_sample_map_at(f->map, g->patch[k], g->u[k], g->v[k])[0],
                            rgb + 3 * k);
    const ncr_status status = report_page_rgb8(
        x->page, REPORT_FIGURES, "The nearest sample point of each texel, a colour for each",
        "the object in false colours, a patch of one colour for each point", g->width, g->height,
        rgb);
    ncr_free(&x->l->a->ctx, rgb);
    return status;
}

enum { atlas_side = 512 }; /* pixels at most */

/* Figure 3.5 unrolled: the same indices chart by chart, as the maps are stored. */
static ncr_status atlas_figure(experiments *x, const lab_field *f)
{
    const ncr_sample_map *map = f->map;
    uint32_t step = 1;
    while (map->page_width / step > atlas_side || map->page_height / step > atlas_side)
        step *= 2;
    const uint32_t w = map->page_width / step, h = map->page_height / step;
    uint8_t *rgb = ncr_alloc(&x->l->a->ctx, (size_t)w * h * 3);
    if (!rgb)
        return NCR_E_NOMEM;
    for (uint32_t j = 0; j < h; j++)
        for (uint32_t i = 0; i < w; i++) {
            const size_t texel = (size_t)j * step * map->page_width + (size_t)i * step;
            ncr_false_color(map->index[4 * texel], rgb + 3 * ((size_t)j * w + i));
        }
    const ncr_status status = report_page_rgb8(
        x->page, REPORT_FIGURES, "The same maps as they are stored, patch by patch",
        "square charts, each a mosaic of false colours", w, h, rgb);
    ncr_free(&x->l->a->ctx, rgb);
    return status;
}

static uint32_t nearest_to_eye(const lab *l, const ncr_points *points)
{
    double least = INFINITY, to[3];
    uint32_t nearest = 0;
    for (size_t k = 0; k < points->count; k++) {
        d_sub(points->at[k].position, l->v.camera->eye, to);
        if (d_dot(to, to) < least) {
            least = d_dot(to, to);
            nearest = (uint32_t)k;
        }
    }
    return nearest;
}

/* Figure 3.4: a captured cube, unfolded as a cross. */
static ncr_status cube_figure(experiments *x, const lab_field *f)
{
    static const uint32_t column[6] = {2, 0, 1, 1, 1, 3}, row[6] = {1, 1, 0, 2, 1, 1};
    const uint32_t n = f->cube;
    ncr_image cross;
    ncr_status status = ncr_image_init(&x->l->a->ctx, 4 * n, 3 * n, 3, &cross);
    if (status != NCR_OK)
        return status;
    const uint32_t point = nearest_to_eye(x->l, &f->baked.points);
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t y = 0; y < n; y++)
            for (uint32_t i = 0; i < n; i++)
                ncr_lightfield_texel(f->light, point, face, i, y,
                                     ncr_image_at(&cross, column[face] * n + i, row[face] * n + y),
                                     NULL);
    status = report_page_image(x->page, REPORT_FIGURES,
                               "The light captured at the point nearest to the eye, unfolded",
                               "six faces of a cube laid out as a cross", &cross, x->l->exposure);
    ncr_image_dispose(&x->l->a->ctx, &cross);
    return status;
}

/* Figure 3.3: where the points are, as dots over the traced view; those behind the object are left
 * out by asking the G-buffer how far the surface is. */
static ncr_status points_figure(experiments *x, const lab_field *f)
{
    const lab *l = x->l;
    const ncr_gbuffer *g = &l->v.gbuffer;
    const ncr_frame *frame = ncr_scene_frame(l->s.world->scene);
    uint8_t *rgb = ncr_alloc_zero(&l->a->ctx, (size_t)g->width * g->height, 3);
    if (!rgb)
        return NCR_E_NOMEM;
    picture_from_image(&l->reference[NCR_TERM_RECON], l->exposure, rgb);
    for (size_t k = 0; k < f->baked.points.count; k++) {
        double p[3];
        ncr_frame_from_model(frame, f->baked.points.at[k].position, p);
        draw_dot(g, p, frame, l->v.camera, rgb);
    }
    const ncr_status status =
        report_page_rgb8(x->page, REPORT_FIGURES, "The sample points, just above the surface",
                         "the object dotted with sample points", g->width, g->height, rgb);
    ncr_free(&l->a->ctx, rgb);
    return status;
}

ncr_status figures_of_field(experiments *x, const lab_field *f)
{
    report_page_heading(x->page, REPORT_FIGURES, "Inside the field (Figures 3.3 to 3.5)");
    report_page_row_begin(x->page, REPORT_FIGURES);
    ncr_status status = points_figure(x, f);
    if (status == NCR_OK)
        status = false_colour_figure(x, f);
    if (status == NCR_OK)
        status = atlas_figure(x, f);
    if (status == NCR_OK)
        status = cube_figure(x, f);
    report_page_row_end(x->page, REPORT_FIGURES, NULL);
    return status;
}

static ncr_status view_figure(experiments *x, const ncr_scene_camera *camera)
{
    lab *l = x->l;
    const uint32_t size[2] = {(l->v.gbuffer.width + 1) / 2, (l->v.gbuffer.height + 1) / 2};
    view v;
    ncr_image image = {0};
    ncr_status status = view_open(l->a, &l->s, &camera->camera, size, false, &v);
    if (status != NCR_OK)
        return status;
    status = ncr_image_init(&l->a->ctx, size[0], size[1], 3, &image);
    if (status == NCR_OK)
        status = ncr_background_trace(&l->a->ctx, &l->s.tracer, &camera->camera, &v.gbuffer,
                                      NCR_NONE, &image);
    if (status == NCR_OK)
        status = report_page_image(x->page, REPORT_FIGURES, camera->name,
                                   "a view of the scene, the object without its mirror", &image,
                                   l->exposure);
    ncr_image_dispose(&l->a->ctx, &image);
    view_close(l->a, &v);
    return status;
}

ncr_status figures_of_views(experiments *x)
{
    const ncr_scene_file *file = x->l->s.file;
    ncr_status status = NCR_OK;
    report_page_heading(x->page, REPORT_FIGURES, "The scene from its cameras (Figure 3.2)");
    report_page_row_begin(x->page, REPORT_FIGURES);
    for (size_t k = 0; status == NCR_OK && k < ncr_scene_file_camera_count(file); k++)
        status = view_figure(x, ncr_scene_file_camera(file, k));
    report_page_row_end(x->page, REPORT_FIGURES, NULL);
    return status;
}

/* How far a pixel's ray passes from the patch at the (u,v) that the pixel was given. */
static double registration_error(const lab *l, const ncr_gbuffer *g, const double eye[3], size_t k)
{
    const ncr_surface *surface = ncr_scene_object_surface(l->s.world->scene, g->object[k]);
    ncr_surface_point at;
    double d[3], to[3], cross[3];
    ncr_surface_eval(surface, g->patch[k], (double)g->u[k], (double)g->v[k], &at);
    ncr_camera_ray(l->v.camera, g->width, g->height, (double)(k % g->width) + 0.5,
                   (double)(k / g->width) + 0.5, d);
    d_sub(at.p, eye, to);
    d_cross(d, to, cross);
    return ncr_frame_length_to_model(ncr_scene_frame(l->s.world->scene), d_length(cross));
}

/* Of all pixels of the object: into channel 0 of the map, with mean and largest as a fact. */
static void measure_registration(experiments *x, const ncr_gbuffer *g, const char *name,
                                 ncr_image *map, double *mean)
{
    const lab *l = x->l;
    ncr_sum sum = {0};
    double eye[3], largest = 0;
    size_t count = 0;
    ncr_frame_from_model(ncr_scene_frame(l->s.world->scene), l->v.camera->eye, eye);
    for (size_t k = 0; k < (size_t)g->width * g->height; k++) {
        map->data[k] = 0;
        if (!l->mask[k] || g->object[k] != l->s.object)
            continue;
        const double error = registration_error(l, g, eye, k);
        map->data[k] = (float)error;
        ncr_sum_add(&sum, error);
        largest = fmax(largest, error);
        count++;
    }
    *mean = count ? ncr_sum_value(&sum) / (double)count : 0;
    report_page_fact(x->page, REPORT_TIMINGS, name,
                     "mean %.2g, largest %.2g model units over %zu pixels", *mean, largest, count);
}

ncr_status figures_registration(experiments *x, const ncr_gbuffer *raw)
{
    static const char *const alt = "a map of distances, brightest where patch and ray part most";
    const ncr_gbuffer *exact = &x->l->v.gbuffer;
    ncr_image map;
    double mean[2] = {0};
    ncr_status status = ncr_image_init(&x->l->a->ctx, raw->width, raw->height, 1, &map);
    if (status != NCR_OK)
        return status;
    report_page_heading(x->page, REPORT_FIGURES, "How far patch and ray are apart");
    report_page_say(
        x->page, REPORT_FIGURES,
        "Rays meet triangles, which lie beside the curved patch between their corners. "
        "Refined hits lie on the patch: a dark picture is a good one. Both share a scale.");
    report_page_row_begin(x->page, REPORT_FIGURES);
    measure_registration(x, raw, "registration error, triangle hits", &map, &mean[0]);
    const double scale = mean[0] > 0 ? 4 * mean[0] : 1;
    status = report_page_map(x->page, REPORT_FIGURES, "Hits left on the triangles", alt, &map, 0,
                             scale, "model units");
    measure_registration(x, exact, "registration error, refined hits", &map, &mean[1]);
    if (status == NCR_OK)
        status = report_page_map(x->page, REPORT_FIGURES, "Hits refined on the patch", alt, &map, 0,
                                 scale, "model units");
    report_page_row_end(x->page, REPORT_FIGURES, NULL);
    ncr_image_dispose(&x->l->a->ctx, &map);
    return status;
}
