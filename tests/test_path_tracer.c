/* SPDX-License-Identifier: MIT
 * The reference against brute force: a path tracer that shares with the library no more than the
 * ray tracer, the albedo, and the sky's radiance. It stores nothing and interpolates nothing. */
#include "core/vec_internal.h"
#include "io/scene_file.h"
#include "shading/tracer.h"
#include "tests/check.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { packet = 64, packets = 24, paths = packet * packets, views = 3, per_view = 334 };

/* --- the path tracer ------------------------------------------------------------------------- */

typedef struct path_world {
    const ncr_world *world;
    double sun[3], sun_radius; /* unit, radians; radius 0: no sun */
    float lift[4096];
} path_world;

/* `packet` paths that advance together, and the rays that they cast. */
typedef struct walk {
    check_random random;
    float o[3][packet], d[3][packet], shadow_d[3][packet], tmax[packet];
    double weight[packet][3], sum[packet][3];
    bool alive[packet];
    double p[packet][3], n[packet][3], albedo[packet][3];
    float t[packet], u[packet], v[packet], g[3][packet], s[3][packet];
    uint32_t object[packet], patch[packet];
    uint8_t blocked[packet];
} walk;

static void vector_of(float (*rows)[packet], size_t k, double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)rows[c][k];
}

/* Uniform in the cone of half-angle `radius` about `axis`. */
static void cone_direction(check_random *r, const double axis[3], double radius, double out[3])
{
    ncr_vec3 s, t;
    const double c = 1 - check_uniform(r, 0, 1) * (1 - cos(radius));
    const double a = check_uniform(r, 0, 2 * pi), sine = sqrt(fmax(0, 1 - c * c));
    double sd[3], td[3];
    v_basis(d_to_v(axis), &s, &t);
    v_to_d(s, sd);
    v_to_d(t, td);
    for (int k = 0; k < 3; k++)
        out[k] = c * axis[k] + sine * (cos(a) * sd[k] + sin(a) * td[k]);
}

static void cosine_direction(check_random *r, const double n[3], double out[3])
{
    double on_sphere[3];
    const double z = check_uniform(r, -1, 1), a = check_uniform(r, 0, 2 * pi);
    const double sine = sqrt(1 - z * z);
    on_sphere[0] = sine * cos(a);
    on_sphere[1] = sine * sin(a);
    on_sphere[2] = z;
    d_mad(n, 1, on_sphere, out); /* a point of the sphere that touches the surface */
    if (!d_normalize(out))
        memcpy(out, n, sizeof(double[3]));
}

static ncr_rays rays_of(walk *w, float (*d)[packet], float *tmax)
{
    return (ncr_rays){.ox = w->o[0],
                      .oy = w->o[1],
                      .oz = w->o[2],
                      .dx = d[0],
                      .dy = d[1],
                      .dz = d[2],
                      .tmax = tmax};
}

/* Paths that leave the scene take the sky with them, without the sun: that is sampled. Lamps are
 * sampled too, and dark here, save for the eye's own ray. */
static void meet(const path_world *pw, walk *w)
{
    const ncr_world *world = pw->world;
    const ncr_rays rays = rays_of(w, w->d, NULL);
    ncr_scene_closest(world->scene, packet, &rays,
                      &(ncr_hits){.t = w->t,
                                  .object = w->object,
                                  .patch = w->patch,
                                  .u = w->u,
                                  .v = w->v,
                                  .gx = w->g[0],
                                  .gy = w->g[1],
                                  .gz = w->g[2],
                                  .nx = w->s[0],
                                  .ny = w->s[1],
                                  .nz = w->s[2]});
    for (size_t k = 0; k < packet; k++) {
        if (!w->alive[k])
            continue;
        double d[3], g[3], model[3];
        float albedo[3];
        vector_of(w->d, k, d);
        if (w->object[k] == NCR_NONE) {
            const ncr_vec3 l = ncr_sky_radiance(&world->sky, v_unit(d_to_v(d)));
            w->sum[k][0] += w->weight[k][0] * (double)l.x;
            w->sum[k][1] += w->weight[k][1] * (double)l.y;
            w->sum[k][2] += w->weight[k][2] * (double)l.z;
            w->alive[k] = false;
            continue;
        }
        const ncr_material *m = &world->materials[w->object[k]];
        if (m->emission[0] > 0) {
            w->alive[k] = false;
            continue;
        }
        vector_of(w->g, k, g);
        vector_of(w->s, k, w->n[k]);
        const double side = d_dot(g, d) > 0 ? -1 : 1;
        for (int c = 0; c < 3; c++) {
            w->p[k][c] = (double)w->o[c][k] + (double)w->t[k] * d[c];
            w->n[k][c] *= side;
        }
        ncr_frame_to_model(ncr_scene_frame(world->scene), w->p[k], model);
        ncr_material_albedo(m, model, w->u[k], w->v[k], albedo);
        for (int c = 0; c < 3; c++)
            w->albedo[k][c] = (double)albedo[c];
    }
}

static void step_off(const path_world *pw, walk *w)
{
    for (size_t k = 0; k < packet; k++)
        for (int c = 0; w->alive[k] && c < 3; c++)
            w->o[c][k] = (float)(w->p[k][c] + (double)pw->lift[w->object[k]] * w->n[k][c]);
}

/* Add albedo / pi * radiance * cosine / density where the shadow ray is free. */
static void add_sampled(const path_world *pw, walk *w, const double (*gain)[3])
{
    const ncr_rays rays = rays_of(w, w->shadow_d, w->tmax);
    ncr_scene_occluded(pw->world->scene, packet, &rays, w->blocked);
    for (size_t k = 0; k < packet; k++)
        for (int c = 0; w->alive[k] && !w->blocked[k] && c < 3; c++)
            w->sum[k][c] += w->weight[k][c] * w->albedo[k][c] / pi * gain[k][c];
}

static void sample_sun(const path_world *pw, walk *w)
{
    double gain[packet][3] = {{0}};
    const ncr_vec3 l = ncr_sky_sun_radiance(&pw->world->sky);
    const double solid = 2 * pi * (1 - cos(pw->sun_radius));
    for (size_t k = 0; k < packet; k++) {
        double d[3];
        cone_direction(&w->random, pw->sun, pw->sun_radius, d);
        const double cosine = w->alive[k] ? fmax(0, d_dot(d, w->n[k])) : 0;
        for (int c = 0; c < 3; c++)
            w->shadow_d[c][k] = cosine > 0 ? (float)d[c] : 0;
        w->tmax[k] = INFINITY;
        gain[k][0] = (double)l.x * solid * cosine;
        gain[k][1] = (double)l.y * solid * cosine;
        gain[k][2] = (double)l.z * solid * cosine;
    }
    add_sampled(pw, w, (const double(*)[3])gain);
}

static void sample_lamp(const path_world *pw, walk *w, const ncr_area_light *lamp)
{
    double gain[packet][3] = {{0}}, axis[3];
    d_cross(lamp->edge_u, lamp->edge_v, axis);
    const double area = d_length(axis);
    d_normalize(axis);
    for (size_t k = 0; k < packet; k++) {
        double q[3];
        d_mad(lamp->corner, check_uniform(&w->random, 0, 1), lamp->edge_u, q);
        d_mad(q, check_uniform(&w->random, 0, 1), lamp->edge_v, q);
        d_mad(q, (double)pw->lift[lamp->object], axis, q);
        for (int c = 0; c < 3; c++) {
            q[c] -= (double)w->o[c][k];
            w->shadow_d[c][k] = w->alive[k] ? (float)q[c] : 0;
        }
        w->tmax[k] = 1;
        const double r2 = d_dot(q, q), b = -d_dot(q, axis);
        const double a = w->alive[k] ? d_dot(q, w->n[k]) : 0;
        for (int c = 0; a > 0 && b > 0 && c < 3; c++)
            gain[k][c] = (double)lamp->radiance[c] * a * b / (r2 * r2) * area;
    }
    add_sampled(pw, w, (const double(*)[3])gain);
}

/* Send each path on, in proportion to the cosine; faint ones end by chance, and those that go on
 * carry their light. */
static bool scatter(walk *w)
{
    bool any = false;
    for (size_t k = 0; k < packet; k++) {
        double d[3], most = 0;
        for (int c = 0; c < 3; c++)
            w->d[c][k] = 0; /* a ray without direction costs nothing */
        if (!w->alive[k])
            continue;
        for (int c = 0; c < 3; c++) {
            w->weight[k][c] *= w->albedo[k][c];
            most = fmax(most, w->weight[k][c]);
        }
        if (most < 0.1) {
            w->alive[k] = check_uniform(&w->random, 0, 1) < most / 0.1;
            for (int c = 0; w->alive[k] && c < 3; c++)
                w->weight[k][c] *= 0.1 / most;
        }
        cosine_direction(&w->random, w->n[k], d);
        for (int c = 0; c < 3; c++)
            w->d[c][k] = (float)d[c];
        any |= w->alive[k];
    }
    return any;
}

static double luminance(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

typedef struct estimate {
    double mean, sigma; /* of luminance; sigma of the mean */
    double sun;         /* luminance of the surface seen first, were the sun all it has */
    double sun_share;   /* how much of the sun's disc it sees */
} estimate;

/* The sun as the surface seen first has it; called after the first shadow rays. */
static void note_sun(const path_world *pw, const walk *w, estimate *out)
{
    const ncr_sky *sky = &pw->world->sky;
    const double cosine = fmax(0, d_dot(w->n[0], pw->sun));
    double rgb[3];
    for (int c = 0; c < 3; c++)
        rgb[c] = w->albedo[0][c] / pi * (double)sky->sun_irradiance[c] * cosine;
    out->sun = luminance(rgb);
    for (size_t k = 0; k < packet; k++)
        out->sun_share += w->blocked[k] ? 0 : 1.0 / paths;
}

static estimate trace_paths(const path_world *pw, const double o[3], const double d[3],
                            uint64_t seed)
{
    double sum = 0, squares = 0;
    estimate out = {0};
    walk w;
    memset(&w, 0, sizeof w);
    w.random = (check_random){.seed = seed};
    for (int n = 0; n < packets; n++) {
        for (size_t k = 0; k < packet; k++) {
            w.alive[k] = true;
            for (int c = 0; c < 3; c++) {
                w.weight[k][c] = 1;
                w.sum[k][c] = 0;
                w.o[c][k] = (float)o[c];
                w.d[c][k] = (float)d[c];
            }
        }
        bool first = true;
        do {
            meet(pw, &w);
            step_off(pw, &w);
            if (pw->sun_radius > 0)
                sample_sun(pw, &w);
            if (pw->sun_radius > 0 && first)
                note_sun(pw, &w, &out);
            first = false;
            for (size_t l = 0; l < pw->world->light_count; l++)
                sample_lamp(pw, &w, &pw->world->lights[l]);
        } while (scatter(&w));
        for (size_t k = 0; k < packet; k++) {
            const double y = luminance(w.sum[k]);
            sum += y;
            squares += y * y;
        }
    }
    out.mean = sum / paths;
    out.sigma = sqrt(fmax(0, squares / paths - out.mean * out.mean) / (paths - 1));
    return out;
}

/* --- the comparison -------------------------------------------------------------------------- */

typedef struct pixel {
    double o[3], d[3];
    estimate path;
    double stored[2]; /* by irradiances of two seeds */
    uint32_t object;
} pixel;

typedef struct compare_job {
    const path_world *pw;
    pixel *pixels;
} compare_job;

static void compare_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    compare_job *job = arg;
    (void)worker;
    for (size_t k = begin; k < end; k++)
        job->pixels[k].path = trace_paths(job->pw, job->pixels[k].o, job->pixels[k].d, 1000 + k);
}

static void prepare_world(const ncr_world *world, path_world *pw)
{
    pw->world = world;
    assert_true(ncr_scene_object_count(world->scene) <= 4096);
    for (uint32_t k = 0; k < ncr_scene_object_count(world->scene); k++)
        pw->lift[k] = 2 * ncr_scene_object_chord(world->scene, k) + 1e-6f;
    for (int c = 0; c < 3; c++)
        pw->sun[c] = (double)world->sky.sun_direction[c];
    const double degrees =
        world->sky.sun_radius_deg > 0 ? (double)world->sky.sun_radius_deg : 0.2666;
    pw->sun_radius = d_normalize(pw->sun) ? degrees * pi / 180 : 0;
}

static double traced(const ncr_tracer *tracer, const pixel *p)
{
    float o[3], d[3], c[3];
    float *const rgb[3] = {&c[0], &c[1], &c[2]};
    for (int k = 0; k < 3; k++) {
        o[k] = (float)p->o[k];
        d[k] = (float)p->d[k];
    }
    const ncr_rays rays = {
        .ox = &o[0], .oy = &o[1], .oz = &o[2], .dx = &d[0], .dy = &d[1], .dz = &d[2]};
    ncr_tracer_radiance(tracer, 1, &rays, NULL, rgb, NULL, NULL);
    return luminance((const double[3]){(double)c[0], (double)c[1], (double)c[2]});
}

/* Random pixels of a camera that see a surface. */
static size_t choose_pixels(const ncr_world *world, const ncr_camera *camera, check_random *r,
                            pixel *out)
{
    size_t count = 0;
    while (count < per_view) {
        pixel *p = &out[count];
        float o[3], d[3];
        uint32_t object;
        ncr_camera_ray(camera, 655, 460, floor(check_uniform(r, 0, 655)) + 0.5,
                       floor(check_uniform(r, 0, 460)) + 0.5, p->d);
        ncr_frame_from_model(ncr_scene_frame(world->scene), camera->eye, p->o);
        for (int k = 0; k < 3; k++) {
            o[k] = (float)p->o[k];
            d[k] = (float)p->d[k];
        }
        const ncr_rays rays = {
            .ox = &o[0], .oy = &o[1], .oz = &o[2], .dx = &d[0], .dy = &d[1], .dz = &d[2]};
        ncr_scene_closest(world->scene, 1, &rays, &(ncr_hits){.object = &object});
        p->object = object;
        count += object != NCR_NONE && !(world->materials[object].emission[0] > 0);
    }
    return count;
}

/* What the tracer says, by stored irradiance of one seed. */
static void light_pixels(const ncr_ctx *ctx, const ncr_world *world, double spacing, uint32_t rays,
                         int seed, size_t count, pixel *pixels)
{
    ncr_irradiance *ir;
    CHECK_STATUS(NCR_OK,
                 ncr_irradiance_create(ctx, world,
                                       NCR_OPTS(ncr_irradiance_opts, .rays = rays,
                                                .spacing = spacing, .seed = (uint64_t)seed + 1),
                                       &ir, NULL));
    const ncr_tracer tracer = {.world = world, .irradiance = ir, .diffuse_object = NCR_NONE};
    for (size_t k = 0; k < count; k++)
        pixels[k].stored[seed] = traced(&tracer, &pixels[k]);
    ncr_irradiance_destroy(ctx, ir);
}

/* Standard deviation of the mean of two seeds, for the pixels of one object, relative to their
 * light. */
static double stored_noise(const pixel *pixels, size_t count, uint32_t object)
{
    double squares = 0, means = 0;
    for (size_t k = 0; k < count; k++)
        if (pixels[k].object == object) {
            const double a = pixels[k].stored[0], b = pixels[k].stored[1];
            squares += (a - b) * (a - b) / 4;
            means += (a + b) * (a + b) / 4;
        }
    return means > 0 ? sqrt(squares / means) : 0;
}

typedef struct verdict {
    double inside;          /* share of the pixels within 3 sigma */
    double gap, gap_3sigma; /* mean difference, and its interval, relative to the mean */
} verdict;

static verdict judge(const pixel *pixels, size_t count)
{
    double gap = 0, total = 0, variance = 0, inside = 0;
    for (size_t k = 0; k < count; k++) {
        const pixel *p = &pixels[k];
        const double noise = fmax(stored_noise(pixels, count, p->object) * p->path.mean,
                                  fabs(p->stored[0] - p->stored[1]) / 2);
        const double sigma = sqrt(p->path.sigma * p->path.sigma + noise * noise);
        const double off = (p->stored[0] + p->stored[1]) / 2 - p->path.mean;
        /* in a penumbra the four probes may take 10.7 % of the disc for all or nothing */
        const bool cut = p->path.sun_share > 0 && p->path.sun_share < 1;
        const double probes = cut ? 0.107 * p->path.sun : 0;
        gap += off;
        total += p->path.mean;
        variance += sigma * sigma;
        inside += fabs(off) <= 3 * sigma + probes + 1e-6;
    }
    return (verdict){inside / (double)count, gap / total, 3 * sqrt(variance) / total};
}

static verdict compare(const char *path, double spacing, uint32_t rays)
{
    static pixel pixels[views * per_view];
    static path_world pw;
    const ncr_ctx ctx = {.struct_size = sizeof ctx};
    ncr_scene_file *file;
    CHECK_STATUS(NCR_OK, ncr_scene_file_load(&ctx, path, &file));
    const ncr_world *world = ncr_scene_file_world(file);
    check_random r = {.seed = 2718};
    size_t count = 0;
    for (size_t k = 0; k < views && k < ncr_scene_file_camera_count(file); k++)
        count += choose_pixels(world, &ncr_scene_file_camera(file, k)->camera, &r, pixels + count);
    prepare_world(world, &pw);
    for (int seed = 0; seed < 2; seed++)
        light_pixels(&ctx, world, spacing, rays, seed, count, pixels);
    compare_job job = {&pw, pixels};
    CHECK_STATUS(NCR_OK, ncr_parallel_for(&ctx, count, 4, compare_range, &job));
    const verdict v = judge(pixels, count);
    print_message("%s: %zu pixels, %.2f %% within 3 sigma, mean difference %+.3f %% (3 sigma "
                  "%.3f %%)\n",
                  path, count, 100 * v.inside, 100 * v.gap, 100 * v.gap_3sigma);
    ncr_scene_file_destroy(&ctx, file);
    return v;
}

static void expect(verdict v, double inside)
{
    CHECK(v.inside >= inside, "%.2f %% of the pixels, expected %.1f %%", 100 * v.inside,
          100 * inside);
    CHECK(fabs(v.gap) < 0.01 && fabs(v.gap) <= v.gap_3sigma + 0.002,
          "mean difference %.3f %%, 3 sigma %.3f %%", 100 * v.gap, 100 * v.gap_3sigma);
}

/* Nodes at half the default spacing. With the 32 rays that a quick test can pay for, smoothing has
 * much noise to remove and blurs contact shadows a little: 97.6 % of the pixels agree. With the
 * default of 256 (NCR_TEST_LONG=1, minutes) it is more than 98 %. */
static void gazebo_is_lit_as_paths_light_it(void **state)
{
    (void)state;
    const bool thorough = getenv("NCR_TEST_LONG") != NULL;
    expect(compare("data/scenes/gazebo.json", 0.45, thorough ? 256 : 32), thorough ? 0.98 : 0.965);
}

static void room_is_lit_as_paths_light_it(void **state)
{
    (void)state;
    expect(compare("data/scenes/room.json", 0, 64), 0.985);
}

static void spheres_are_lit_as_paths_light_them(void **state)
{
    (void)state;
    expect(compare("data/scenes/spheres.json", 0, 64), 0.985);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gazebo_is_lit_as_paths_light_it),
        cmocka_unit_test(spheres_are_lit_as_paths_light_them),
        cmocka_unit_test(room_is_lit_as_paths_light_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
