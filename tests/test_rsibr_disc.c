/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/vec_internal.h"
#include "shading/rsibr_disc.h"

#include <string.h>

static const double eye[3] = {0.36, -0.48, 0.8};

static void light(const double d[3], void *user, float *out)
{
    (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.5 * d[c] + 0.3 * d[0] * d[1] + 0.2 * d[2] * d[2]);
}

static ncr_rsibr set_of(const char *material, uint32_t size)
{
    ncr_directional_map env;
    ncr_rsibr_brdf brdf;
    ncr_rsibr set;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_CUBE, 32, 3, &env));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &env, 0, light, NULL));
    CHECK_STATUS(NCR_OK, ncr_rsibr_brdf_find(NULL, material, &brdf));
    CHECK_STATUS(NCR_OK,
                 ncr_rsibr_create(NULL, &env, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = size), &set));
    ncr_directional_map_dispose(NULL, &env);
    return set;
}

static ncr_image drawn(const ncr_rsibr *set, uint32_t rings, uint32_t size)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, size, size, 3, &image));
    CHECK_STATUS(NCR_OK,
                 ncr_rsibr_draw(NULL, set, eye, NCR_OPTS(ncr_rsibr_disc, .rings = rings), &image));
    return image;
}

/* The least cosine at which the three eyes see what a place mirrors. */
static double least_cosine(const ncr_rsibr *set, const ncr_rsibr_frame *frame, double s, double t)
{
    const ncr_view_share share = ncr_view_sphere_share(&set->sphere, NCR_VIEW_PLANAR, eye);
    double d[3], x, y, least = 1;
    ncr_rsibr_direction(frame, NCR_RSIBR_BY_MIRROR, s, t, d);
    for (int i = 0; i < 3; i++)
        least = fmin(least,
                     ncr_rsibr_place(&set->frame[share.view[i]], NCR_RSIBR_BY_MIRROR, d, &x, &y));
    return least;
}

/* The largest difference where all eyes see what is mirrored at a cosine above `least`. */
static double apart(const ncr_rsibr *set, const ncr_image *a, const ncr_image *b, double least)
{
    const ncr_rsibr_frame frame = ncr_rsibr_frame_of(eye);
    double most = 0;
    for (uint32_t y = 0; y < a->height; y++)
        for (uint32_t x = 0; x < a->width; x++) {
            const double s = 2 * (x + 0.5) / a->width - 1, t = 2 * (y + 0.5) / a->width - 1;
            if (s * s + t * t > 1 || least_cosine(set, &frame, s, t) < least)
                continue;
            for (int c = 0; c < 3; c++)
                most =
                    fmax(most, fabs((double)(ncr_image_at(a, x, y)[c] - ncr_image_at(b, x, y)[c])));
        }
    return most;
}

static void twice_the_rings_err_a_quarter_as_much(void **state) /* */
{
    (void)state;
    ncr_rsibr set = set_of("mirror", 512);
    ncr_image exact = drawn(&set, 0, 160);
    double before = 0;
    for (uint32_t rings = 8; rings <= 64; rings *= 2) {
        ncr_image disc = drawn(&set, rings, 160);
        const double error = apart(&set, &exact, &disc, 0.45);
        print_message("%u rings: %.2e, of the whole disc %.2e\n", rings, error,
                      apart(&set, &exact, &disc, 0));
        if (before > 0)
            CHECK_NEAR(before / error, 4, 0.8);
        before = error;
        ncr_image_dispose(NULL, &disc);
    }
    ncr_image_dispose(NULL, &exact);
    ncr_rsibr_dispose(NULL, &set);
}

/* Texel by texel is what ncr_rsibr_shade shows of the texel's normal. */
static void every_texel_by_itself_is_what_shading_shows(void **state)
{
    (void)state;
    ncr_rsibr set = set_of("car-paint", 32);
    ncr_image image = drawn(&set, 0, 40);
    const ncr_rsibr_frame frame = ncr_rsibr_frame_of(eye);
    for (uint32_t y = 0; y < 40; y++)
        for (uint32_t x = 0; x < 40; x++) {
            double n[3];
            if (!ncr_rsibr_direction(&frame, NCR_RSIBR_BY_NORMAL, (x + 0.5) / 20 - 1,
                                     (y + 0.5) / 20 - 1, n) ||
                d_dot(n, eye) < 0.05)
                continue;
            const ncr_vec3 view = d_to_v(eye), normal = d_to_v(n);
            float want[1][3];
            ncr_rsibr_shade(&set, NULL, 1, &view, &normal, NULL, want);
            for (int c = 0; c < 3; c++)
                CHECK_NEAR((double)ncr_image_at(&image, x, y)[c], (double)want[0][c], 2e-5);
        }
    ncr_image_dispose(NULL, &image);
    ncr_rsibr_dispose(NULL, &set);
}

static ncr_status attempt(const ncr_ctx *ctx, void *arg)
{
    ncr_image image;
    ncr_status status = ncr_image_init(ctx, 8, 8, 3, &image);
    if (status == NCR_OK)
        status = ncr_rsibr_draw(ctx, arg, eye, NCR_OPTS(ncr_rsibr_disc, .rings = 4), &image);
    ncr_image_dispose(ctx, &image);
    return status;
}

static void wrong_discs_and_want_of_memory_are_refused(void **state)
{
    (void)state;
    ncr_rsibr set = set_of("car-paint", 8);
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 8, 8, 3, &image));
    CHECK_STATUS(
        NCR_E_ARG,
        ncr_rsibr_draw(NULL, &set, eye, NCR_OPTS(ncr_rsibr_disc, .rings = 4, .spokes = 2), &image));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_rsibr_draw(NULL, &set, eye, NCR_OPTS(ncr_rsibr_disc, .rings = 1025), &image));
    image.height = 7;
    CHECK_STATUS(NCR_E_ARG, ncr_rsibr_draw(NULL, &set, eye, NULL, &image));
    ncr_image_dispose(NULL, &image);
    assert_true(starve(attempt, &set) > 1);
    ncr_rsibr_dispose(NULL, &set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(twice_the_rings_err_a_quarter_as_much),
        cmocka_unit_test(every_texel_by_itself_is_what_shading_shows),
        cmocka_unit_test(wrong_discs_and_want_of_memory_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
