/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/vec_internal.h"
#include "shading/brushed_view_internal.h"
#include "shading/harmonics.h"

static const double pi = 3.14159265358979323846;
static const double eye[3] = {0.36, -0.48, 0.8};
static const ncr_vec3 eye_f = {0.36f, -0.48f, 0.8f};
enum { probes = 60, width = 64 };

/* A sky with a sun of one texel. */
static ncr_image make_light(void)
{
    ncr_image map;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, width, width / 2, 3, &map));
    for (uint32_t y = 0; y < width / 2; y++)
        for (uint32_t x = 0; x < width; x++)
            for (uint32_t c = 0; c < 3; c++)
                ncr_image_at(&map, x, y)[c] =
                    (float)(1 + 0.5 * cos(0.3 * x + c) * sin(0.2 * y) + (x == 40 && y == 6) * 200);
    ncr_image_at(&map, 7, 9)[1] = NAN;
    return map;
}

/* Away from the eye, across and out of the surface, turned about the last so that the tangent's part
 * across the mirrored direction lies at `angle`. */
static void make_frame(const double n[3], double angle, double x[3], double y[3])
{
    double r[3], across[3], on[3], u[3] = {0}, side[3];
    for (int i = 0; i < 3; i++)
        r[i] = 2 * d_dot(n, eye) * n[i] - eye[i];
    d_cross(eye, r, across);
    d_normalize(across);
    d_cross(across, r, on); /* leads on from the eye, across r */
    d_mad(u, cos(angle), on, u);
    d_mad(u, sin(angle), across, u);
    d_cross(u, r, side);
    d_cross(n, side, x); /* across n, in the plane of r and u */
    d_normalize(x);
    d_cross(n, x, y);
}

static void sum_texels(const ncr_brushed *m, const ncr_fresnel *fresnel, const ncr_image *map,
                       const double n[3], double angle, double out[3])
{
    double x[3], y[3], area[width / 2];
    make_frame(n, angle, x, y);
    ncr_harmonics_row_weights(width / 2, false, area);
    const double v[3] = {d_dot(x, eye), d_dot(y, eye), d_dot(n, eye)};
    out[0] = out[1] = out[2] = 0;
    for (uint32_t k = 0; k < width * width / 2; k++) {
        const double theta = (k / width + 0.5) * 2 * pi / width;
        const double phi = (k % width + 0.5) * 2 * pi / width;
        const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        const double l[3] = {d_dot(x, d), d_dot(y, d), d_dot(n, d)};
        const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
        const float *at = ncr_image_at(map, k % width, k / width);
        for (int c = 0; c < 3; c++)
            out[c] += isfinite(at[c])
                          ? area[k / width] / width * ncr_brushed_eval(m, v, l) * (double)at[c] *
                                ncr_fresnel_eval(fresnel, fmin(0.5 * d_length(h), 1))
                          : 0;
    }
}

static void make_normals(double n[probes][3], ncr_vec3 f[probes])
{
    check_random r = {.seed = 3};
    for (int k = 0; k < probes; k++) {
        do {
            const double z = check_uniform(&r, -1, 1), phi = check_uniform(&r, -pi, pi);
            n[k][0] = sqrt(1 - z * z) * cos(phi);
            n[k][1] = sqrt(1 - z * z) * sin(phi);
            n[k][2] = z;
        } while (d_dot(n[k], eye) < 0.02);
        f[k] = d_to_v(n[k]);
    }
}

static void brushed_views_agree_with_brute_force(void **state)
{
    (void)state;
    static const ncr_brushed models[] = {{0.1, 0.4}, {0.5, 0.15}, {0.3, 0.3}};
    static const ncr_fresnel fresnels[] = {{0, 0}, {1.5, 0}, {0.2, 3.9}};
    static const double angles[] = {0, 0.7, 1.3, 0.5 * 3.14159265358979323846};
    ncr_image map = make_light();
    double n[probes][3];
    ncr_vec3 f[probes];
    float got[2][probes][3];
    make_normals(n, f);
    for (int g = 0; g < 3; g++) {
        ncr_fixed_view *view;
        CHECK_STATUS(NCR_OK, ncr_brushed_view_create(NULL, &models[g], &view));
        for (int j = 0; j < 4; j++) {
            double error = 0, size = 0;
            CHECK_STATUS(NCR_OK,
                         ncr_brushed_view_turn(NULL, &models[g], &fresnels[g], angles[j], view));
            CHECK_STATUS(NCR_OK,
                         ncr_fixed_view_render_both(NULL, view, &map, eye_f, probes, f, got[0][0]));
            for (int k = 0; k < 2 * probes; k++) {
                double want[3];
                sum_texels(&models[g], &fresnels[g], &map, n[k % probes],
                           k < probes ? angles[j] : -angles[j], want);
                for (int c = 0; c < 3; c++) {
                    error += pow((double)got[k / probes][k % probes][c] - want[c], 2);
                    size += pow(want[c], 2);
                }
            }
            print_message("%g along, %g across, at %.2f: %.2e\n", models[g].along, models[g].across,
                          angles[j], sqrt(error / size));
            CHECK(sqrt(error / size) < 1e-3, "model %d at %g: %g", g, angles[j],
                  sqrt(error / size));
        }
        ncr_fixed_view_destroy(NULL, view);
    }
    ncr_image_dispose(NULL, &map);
}

static ncr_status attempt(const ncr_ctx *ctx, void *arg)
{
    static const ncr_brushed m = {0.4, 0.8};
    static const ncr_fresnel none = {0, 0};
    ncr_fixed_view *view;
    float out[2][3];
    ncr_status status = ncr_brushed_view_create(ctx, &m, &view);
    if (status == NCR_OK)
        status = ncr_brushed_view_turn(ctx, &m, &none, 1, view);
    if (status == NCR_OK)
        status = ncr_fixed_view_render_both(ctx, view, arg, eye_f, 1, &eye_f, out[0]);
    ncr_fixed_view_destroy(ctx, view);
    return status;
}

static void want_of_memory_and_wrong_alphas_are_refused(void **state)
{
    (void)state;
    static const ncr_brushed wrong[] = {{0.04, 0.3}, {0.3, 1.1}, {NAN, 0.3}, {0.3, 0}};
    ncr_image map = make_light();
    ncr_fixed_view *view;
    for (int k = 0; k < 4; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_brushed_view_create(NULL, &wrong[k], &view));
    assert_true(starve(attempt, &map) > 5);
    ncr_image_dispose(NULL, &map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brushed_views_agree_with_brute_force),
        cmocka_unit_test(want_of_memory_and_wrong_alphas_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
