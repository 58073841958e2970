/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/vec_internal.h"
#include "shading/rsibr.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- light ------------------------------------------------------------------------------------- */

static void soft_light(const double d[3], void *user, float *out)
{
    (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.5 * d[c] + 0.3 * d[0] * d[1] + 0.2 * d[2] * d[2]);
}

static void constant_light(const double d[3], void *user, float *out)
{
    (void)d, (void)user;
    out[0] = out[1] = out[2] = 1;
}

/* A sky, a dark ground, a bright window and a small lamp. */
static void room_light(const double d[3], void *user, float *out)
{
    (void)user;
    const double window = exp(-12 * (pow(d[0] - 0.8, 2) + pow(d[1] - 0.5, 2) + pow(d[2] - 0.3, 2)));
    const double lamp = exp(-60 * (pow(d[0] + 0.5, 2) + pow(d[1] + 0.3, 2) + pow(d[2] - 0.8, 2)));
    for (int c = 0; c < 3; c++)
        out[c] =
            (float)((d[2] > 0 ? 0.6 + 0.2 * c * d[2] : 0.15 - 0.03 * c) + 5 * window + 20 * lamp);
}

static ncr_directional_map light_of(ncr_map_kind kind, uint32_t size, ncr_radiance_fn *fn)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, kind, size, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0, fn, NULL));
    return map;
}

static ncr_rsibr_brdf brdf_of(const char *text)
{
    ncr_rsibr_brdf brdf;
    CHECK_STATUS(NCR_OK, ncr_rsibr_brdf_find(NULL, text, &brdf));
    return brdf;
}

static ncr_rsibr set_of(ncr_radiance_fn *fn, const char *material, const ncr_rsibr_opts *opts)
{
    ncr_directional_map env = light_of(NCR_MAP_CUBE,
                                       fn == constant_light ? 8
                                       : fn == soft_light   ? 64
                                                            : 32,
                                       fn);
    const ncr_rsibr_brdf brdf = brdf_of(material);
    ncr_rsibr set;
    CHECK_STATUS(NCR_OK, ncr_rsibr_create(NULL, &env, &brdf, opts, &set));
    ncr_directional_map_dispose(NULL, &env);
    return set;
}

static void any_direction(check_random *r, double d[3])
{
    const double z = check_uniform(r, -1, 1), phi = check_uniform(r, -pi, pi);
    const double s = sqrt(1 - z * z);
    d[0] = s * cos(phi);
    d[1] = s * sin(phi);
    d[2] = z;
}

/* A normal that the eye sees, with cosine above `least`. */
static void seen_normal(check_random *r, const double eye[3], double least, double n[3])
{
    do
        any_direction(r, n);
    while (d_dot(n, eye) <= least);
}

static void shade(const ncr_rsibr *set, const ncr_rsibr_look *look, const double v[3],
                  const double n[3], float out[1][3])
{
    const ncr_vec3 view = d_to_v(v), normal = d_to_v(n);
    ncr_rsibr_shade(set, look, 1, &view, &normal, NULL, out);
}

/* --- warps ------------------------------------------------------------------------------------- */

static void a_place_and_its_direction_are_one_another(void **state) /* */
{
    (void)state;
    check_random r = {.seed = 60};
    for (int k = 0; k < 20000; k++) {
        double eye[3], n[3], m[3], s, t;
        any_direction(&r, eye);
        const ncr_rsibr_frame f = ncr_rsibr_frame_of(eye);
        const double rho = sqrt(check_uniform(&r, 0, 0.999)), phi = check_uniform(&r, -pi, pi);
        const double at[2] = {rho * cos(phi), rho * sin(phi)};
        assert_true(ncr_rsibr_direction(&f, NCR_RSIBR_BY_NORMAL, at[0], at[1], n));
        assert_true(ncr_rsibr_direction(&f, NCR_RSIBR_BY_MIRROR, at[0], at[1], m));
        for (int i = 0; i < 3; i++) /* the mirror's is the normal's reflection of the eye */
            CHECK_NEAR(m[i], 2 * d_dot(n, eye) * n[i] - eye[i], 1e-12);
        for (int index = 0; index < 2; index++) {
            const double c = ncr_rsibr_place(&f, (ncr_rsibr_index)index, index ? n : m, &s, &t);
            CHECK_NEAR(s, at[0], 1e-12);
            CHECK_NEAR(t, at[1], 1e-12);
            CHECK_NEAR(c, d_dot(n, eye), 1e-12);
        }
    }
}

static void beyond_the_disc_and_opposite_the_eye_nothing_is_undefined(void **state) /* A-60, S-34 */
{
    (void)state;
    check_random r = {.seed = 34};
    for (int k = 0; k < 1000; k++) {
        double eye[3], d[3], s, t;
        any_direction(&r, eye);
        const ncr_rsibr_frame f = ncr_rsibr_frame_of(eye);
        for (int index = 0; index < 2; index++) {
            const double far_out = 1 + pow(10, check_uniform(&r, -15, 1));
            assert_false(ncr_rsibr_direction(&f, (ncr_rsibr_index)index, far_out, 0, d));
            CHECK_NEAR(d_length(d), 1, 1e-12);
            const double away[3] = {-eye[0], -eye[1], -eye[2]};
            const double c = ncr_rsibr_place(&f, (ncr_rsibr_index)index, away, &s, &t);
            assert_true(c <= 0 && hypot(s, t) <= 1 + 1e-12);
        }
        /* Close to the eye's opposite the cosine keeps its digits: sin(e/2) for an angle e. */
        const double e = pow(10, check_uniform(&r, -5, -1));
        for (int i = 0; i < 3; i++)
            d[i] = -cos(e) * f.axis[2][i] + sin(e) * f.axis[0][i];
        CHECK_NEAR(ncr_rsibr_place(&f, NCR_RSIBR_BY_MIRROR, d, &s, &t) / sin(0.5 * e), 1, 1e-9);
        CHECK_NEAR(s, cos(0.5 * e), 1e-9);
    }
}

/* From eye to eye and back; and from the same eye to itself, whichever way it is turned about its
 * axis. What a map holds by direction is therefore found again by any other eye.  A-61 A-62 A-71 */
static void warps_there_and_back_are_no_warp(void **state)
{
    (void)state;
    check_random r = {.seed = 61};
    for (int k = 0; k < 20000; k++) {
        double a[3], b[3], d[3], back[3], s, t;
        any_direction(&r, a);
        any_direction(&r, b);
        const double turn = check_uniform(&r, -pi, pi);
        ncr_rsibr_frame fa = ncr_rsibr_frame_of(a), fb = ncr_rsibr_frame_of(k % 2 ? a : b);
        for (int i = 0; i < 3; i++) {
            const double x = fb.axis[0][i], y = fb.axis[1][i];
            fb.axis[0][i] = cos(turn) * x + sin(turn) * y;
            fb.axis[1][i] = cos(turn) * y - sin(turn) * x;
        }
        const double rho = sqrt(check_uniform(&r, 0, 0.99)), phi = check_uniform(&r, -pi, pi);
        ncr_rsibr_direction(&fa, NCR_RSIBR_BY_MIRROR, rho * cos(phi), rho * sin(phi), d);
        if (ncr_rsibr_place(&fb, NCR_RSIBR_BY_MIRROR, d, &s, &t) < 0.05)
            continue; /* the other eye's singularity */
        ncr_rsibr_direction(&fb, NCR_RSIBR_BY_MIRROR, s, t, back);
        for (int i = 0; i < 3; i++)
            CHECK_NEAR(back[i], d[i], 1e-12);
        ncr_rsibr_place(&fa, NCR_RSIBR_BY_MIRROR, back, &s, &t);
        CHECK_NEAR(s, rho * cos(phi), 1e-10);
        CHECK_NEAR(t, rho * sin(phi), 1e-10);
    }
}

static void trust_is_nothing_at_the_singularity_and_rises_smoothly(void **state) /* */
{
    (void)state;
    assert_true(ncr_rsibr_trust(0) == 0 && ncr_rsibr_trust(-1) == 0);
    assert_true(ncr_rsibr_trust(0.2) == 1 && ncr_rsibr_trust(1) == 1);
    for (double c = 0; c < 0.25; c += 1e-4) {
        const double rise = ncr_rsibr_trust(c + 1e-4) - ncr_rsibr_trust(c);
        CHECK(rise >= 0 && rise <= 1.5 / 0.2 * 1e-4 + 1e-12, "trust rises by %g at %g", rise, c);
    }
}

/* --- materials --------------------------------------------------------------------------------- */

/* Of the normals that would mirror the same direction toward the eyes that are blended. */
static double least_cosine(const ncr_rsibr *set, const double eye[3], const double n[3])
{
    const ncr_view_share share = ncr_view_sphere_share(&set->sphere, NCR_VIEW_PLANAR, eye);
    double m[3], s, t, least = 1;
    for (int i = 0; i < 3; i++)
        m[i] = 2 * d_dot(n, eye) * n[i] - eye[i];
    for (int i = 0; i < 3; i++)
        least = fmin(least,
                     ncr_rsibr_place(&set->frame[share.view[i]], NCR_RSIBR_BY_MIRROR, m, &s, &t));
    return least;
}

/* Mean over one map's disc of the difference between what a set shows toward an eye and the map
 * computed for that eye. */
static double unlike_direct_where(const ncr_rsibr *set, ncr_radiance_fn *fn, const double eye[3],
                                  double least, double least_of_all)
{
    ncr_directional_map env = light_of(NCR_MAP_CUBE, fn == soft_light ? 64 : 32, fn);
    ncr_rsibr direct;
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .size = set->size, .raw = true};
    CHECK_STATUS(NCR_OK, ncr_rsibr_init(NULL, &set->brdf, &opts, &direct));
    for (uint32_t k = 0; k < direct.sphere.view_count; k++)
        direct.frame[k] = ncr_rsibr_frame_of(eye);
    direct.sphere.view_count = 1; /* one will do */
    CHECK_STATUS(NCR_OK, ncr_rsibr_fill(NULL, &env, &direct));
    double square = 0, count = 0;
    for (uint32_t y = 0; y < set->size; y++)
        for (uint32_t x = 0; x < set->size; x++) {
            double n[3];
            const double s = 2 * (x + 0.5) / set->size - 1, t = 2 * (y + 0.5) / set->size - 1;
            if (!ncr_rsibr_direction(direct.frame, NCR_RSIBR_BY_NORMAL, s, t, n) ||
                d_dot(n, eye) < least || least_cosine(set, eye, n) < least_of_all)
                continue;
            float got[1][3];
            shade(set, NULL, eye, n, got);
            for (size_t c = 0; c < 3; c++) {
                double want = 0;
                for (uint32_t map = 0; map < direct.maps; map++)
                    want +=
                        (double)ncr_rsibr_map(&direct, map, 0)[3 * ((size_t)y * set->size + x) + c];
                square += pow((double)got[0][c] - want, 2);
                count++;
            }
        }
    ncr_rsibr_dispose(NULL, &direct);
    ncr_directional_map_dispose(NULL, &env);
    return sqrt(square / count);
}

static double unlike_direct(const ncr_rsibr *set, ncr_radiance_fn *fn, const double eye[3],
                            double least)
{
    return unlike_direct_where(set, fn, eye, least, 0);
}

/* Resampling errs with the square of the angle that a texel spans, which at cosine c of an eye's own
 * normal is 2 / c of its width: toward the rims it does not shrink in proportion.              A-62 */
static void a_mirror_is_the_direct_map_up_to_resampling_for_any_eye(void **state)
{
    (void)state;
    check_random r = {.seed = 62};
    for (int k = 0; k < 2; k++) {
        double eye[3], all[3], inner[3];
        any_direction(&r, eye);
        for (int level = 0; level < 3; level++) {
            ncr_rsibr set =
                set_of(soft_light, "mirror", NCR_OPTS(ncr_rsibr_opts, .size = 32u << level));
            all[level] = unlike_direct(&set, soft_light, eye, 0.3);
            inner[level] = unlike_direct_where(&set, soft_light, eye, 0.3, 0.5);
            ncr_rsibr_dispose(NULL, &set);
        }
        print_message("mirror: %.2e %.2e %.2e, away from rims %.2e %.2e %.2e\n", all[0], all[1],
                      all[2], inner[0], inner[1], inner[2]);
        CHECK(all[2] < 1e-3, "error %g", all[2]);
        for (int level = 1; level < 3; level++) {
            CHECK(all[level] < all[level - 1] / 2.5, "%g then %g", all[level - 1], all[level]);
            CHECK_NEAR(inner[level - 1] / inner[level], 4, 0.5);
        }
    }
}

/* With maps that are functions of the direction, not texels, nothing is lost: what the three eyes of
 * any other have at a direction's place is the direction itself.                           A-62 */
static void a_mirror_is_exact_without_texels(void **state)
{
    (void)state;
    ncr_view_sphere sphere;
    CHECK_STATUS(NCR_OK, ncr_view_sphere_init(NULL, 12, &sphere));
    check_random r = {.seed = 63};
    for (int k = 0; k < 20000; k++) {
        double eye[3], n[3], m[3], sum = 0;
        float want[3], part[3];
        double got[3] = {0};
        any_direction(&r, eye);
        seen_normal(&r, eye, 0, n);
        for (int i = 0; i < 3; i++)
            m[i] = 2 * d_dot(n, eye) * n[i] - eye[i];
        const ncr_view_share share = ncr_view_sphere_share(&sphere, NCR_VIEW_PLANAR, eye);
        for (int i = 0; i < 3; i++) {
            double s, t, back[3];
            const ncr_rsibr_frame f = ncr_rsibr_frame_of(sphere.view[share.view[i]]);
            const double c = ncr_rsibr_place(&f, NCR_RSIBR_BY_MIRROR, m, &s, &t);
            const double weight = share.weight[i] * ncr_rsibr_trust(c);
            ncr_rsibr_direction(&f, NCR_RSIBR_BY_MIRROR, s, t, back);
            soft_light(back, NULL, part);
            for (int j = 0; j < 3; j++)
                got[j] += weight * (double)part[j];
            sum += weight;
        }
        soft_light(m, NULL, want);
        for (int j = 0; j < 3 && sum > 0; j++)
            CHECK_NEAR(got[j] / sum, (double)want[j], 3e-7);
    }
    ncr_view_sphere_dispose(NULL, &sphere);
}

/* Phong's lobe goes with the mirror direction, Lambert's with the normal: exact but for resampling,
 * and Lambert's by mirror direction is not.                                             A-63 */
static void lobes_are_right_by_their_own_direction_alone(void **state)
{
    (void)state;
    static const double eye[3] = {0.36, -0.48, 0.8};
    static const struct {
        const char *material;
        bool single, right;
    } cases[] = {{"lambert", false, true}, {"phong:20", false, true}, {"lambert", true, false}};
    for (int k = 0; k < 3; k++) {
        ncr_rsibr set = set_of(room_light, cases[k].material,
                               NCR_OPTS(ncr_rsibr_opts, .single = cases[k].single));
        const double error = unlike_direct(&set, room_light, eye, 0.2);
        print_message("%s%s: %.2e\n", cases[k].material, cases[k].single ? ", by mirror" : "",
                      error);
        CHECK(cases[k].right ? error < 2e-3 : error > 0.05, "%s: %g", cases[k].material, error);
        ncr_rsibr_dispose(NULL, &set);
    }
}

/* Root mean square over eyes and normals they see of radiance minus Fresnel's reflectance. */
static double fresnel_error(const ncr_rsibr *set, bool fade_off)
{
    const ncr_rsibr_look look = {.struct_size = sizeof look, .fade_off = fade_off};
    check_random r = {.seed = 69};
    double square = 0;
    enum { draws = 40000 };
    for (int k = 0; k < draws; k++) {
        double v[3], n[3];
        any_direction(&r, v);
        seen_normal(&r, v, 0, n);
        float got[1][3];
        shade(set, &look, v, n, got);
        square += pow((double)got[0][0] - ncr_fresnel_dielectric(1.5, d_dot(n, v)), 2);
    }
    return sqrt(square / draws);
}

/* The same with maps of infinitely many texels, and nothing faded. */
static double fresnel_error_of_blending(uint32_t views)
{
    ncr_view_sphere sphere;
    CHECK_STATUS(NCR_OK, ncr_view_sphere_init(NULL, views, &sphere));
    check_random r = {.seed = 69};
    double square = 0;
    enum { draws = 40000 };
    for (int k = 0; k < draws; k++) {
        double v[3], n[3], m[3], s, t, got = 0;
        any_direction(&r, v);
        seen_normal(&r, v, 0, n);
        for (int i = 0; i < 3; i++)
            m[i] = 2 * d_dot(n, v) * n[i] - v[i];
        const ncr_view_share share = ncr_view_sphere_share(&sphere, NCR_VIEW_PLANAR, v);
        for (int i = 0; i < 3; i++) {
            const ncr_rsibr_frame f = ncr_rsibr_frame_of(sphere.view[share.view[i]]);
            const double c = ncr_rsibr_place(&f, NCR_RSIBR_BY_MIRROR, m, &s, &t);
            got += share.weight[i] * ncr_fresnel_dielectric(1.5, fmin(c, 1));
        }
        square += pow(got - ncr_fresnel_dielectric(1.5, d_dot(n, v)), 2);
    }
    ncr_view_sphere_dispose(NULL, &sphere);
    return sqrt(square / draws);
}

static void fresnel_is_wrong_as_the_paper_has_it(void **state) /* */
{
    (void)state;
    static const double rms[] = {0.170, 0.105, 0.051, 0.022};
    for (uint32_t k = 0, views = 12; k < 4; k++, views = 4 * views - 6) {
        const double error = fresnel_error_of_blending(views);
        print_message("%u views: rms %.4f\n", views, error);
        CHECK_NEAR(error, rms[k], 0.06 * rms[k]);
    }
    ncr_rsibr raw =
        set_of(constant_light, "mirror:1.5", NCR_OPTS(ncr_rsibr_opts, .size = 256, .raw = true));
    const double error = fresnel_error(&raw, true), faded = fresnel_error(&raw, false);
    print_message("12 views, maps of 256: rms %.4f, faded %.4f\n", error, faded);
    CHECK_NEAR(error, 0.170, 0.01);
    CHECK(faded > error, "fading made %g of %g", faded, error);
    ncr_rsibr_dispose(NULL, &raw);
}

static void fresnel_is_right_with_the_albedo_divided_out(void **state) /* A-69, B-12 */
{
    (void)state;
    for (uint32_t views = 12; views <= 642; views = 4 * views - 6) {
        ncr_rsibr set = set_of(constant_light, "mirror:1.5",
                               NCR_OPTS(ncr_rsibr_opts, .views = views, .size = 8));
        CHECK_NEAR(fresnel_error(&set, false), 0, 1e-6);
        ncr_rsibr_dispose(NULL, &set);
    }
}

static void constant_light_gives_the_albedo_and_no_more_than_came_in(void **state) /* A-68, C-15 */
{
    (void)state;
    static const char *const materials[] = {"mirror",  "mirror:1.5", "lambert",          "phong:50",
                                            "ggx:0.3", "car-paint",  "cook-torrance:0.3"};
    for (size_t k = 0; k < sizeof materials / sizeof *materials; k++)
        for (int single = 0; single < 2; single++) {
            ncr_rsibr set = set_of(constant_light, materials[k],
                                   NCR_OPTS(ncr_rsibr_opts, .size = 32, .single = single));
            check_random r = {.seed = 68};
            for (int draw = 0; draw < 2000; draw++) {
                double v[3], n[3], want[3] = {0}, part[3];
                any_direction(&r, v);
                seen_normal(&r, v, 0, n);
                for (uint32_t map = 0; map < set.maps; map++) {
                    ncr_rsibr_albedo(&set, map, d_dot(n, v), 0, part);
                    d_mad(want, 1, part, want);
                }
                float got[1][3];
                shade(&set, NULL, v, n, got);
                for (int c = 0; c < 3; c++) {
                    CHECK_NEAR((double)got[0][c], want[c], 3e-6 * (1 + want[c]));
                    CHECK(got[0][c] < 1.2f, "%s returns %g", materials[k], (double)got[0][c]);
                    if (!strcmp(materials[k], "car-paint"))
                        assert_true(got[0][c] <= 1);
                }
            }
            ncr_rsibr_dispose(NULL, &set);
        }
}

/* One warp for each lobe beats one for all, with the albedo divided out or not. */
static void lobes_of_their_own_beat_a_single_map(void **state) /* C-17 */
{
    (void)state;
    static const char *const materials[] = {"car-paint", "cook-torrance:0.2"};
    static const double eye[3] = {0.36, -0.48, 0.8};
    for (int k = 0; k < 2; k++) {
        double error[3];
        for (int way = 0; way < 3; way++) {
            ncr_rsibr set =
                set_of(room_light, materials[k],
                       NCR_OPTS(ncr_rsibr_opts, .size = 64, .single = way > 0, .raw = way > 1));
            error[way] = unlike_direct(&set, room_light, eye, 0.1);
            ncr_rsibr_dispose(NULL, &set);
        }
        print_message("%s: by lobe %.4f, in one %.4f, in one and raw %.4f\n", materials[k],
                      error[0], error[1], error[2]);
        assert_true(error[0] < 0.8 * error[1] && error[0] < 0.8 * error[2]);
    }
}

static void more_eyes_err_less(void **state)
{
    (void)state;
    static const double eye[3] = {0.36, -0.48, 0.8};
    double before = 1;
    for (uint32_t views = 12; views <= 162; views = 4 * views - 6) {
        ncr_rsibr set = set_of(room_light, "cook-torrance:0.3",
                               NCR_OPTS(ncr_rsibr_opts, .views = views, .size = 64));
        const double error = unlike_direct(&set, room_light, eye, 0.1);
        print_message("%u views: %.4f\n", views, error);
        CHECK(error < before, "%g after %g", error, before);
        before = error;
        ncr_rsibr_dispose(NULL, &set);
    }
}

/* --- eyes -------------------------------------------------------------------------------------- */

/* The paper's one eye for all pixels, against each pixel's own, at the edge of a field of view. C-02 */
static double perspective_error(const ncr_rsibr *set, double half_angle)
{
    check_random r = {.seed = 2};
    double square = 0;
    for (int k = 0; k < 2000; k++) {
        double eye[3], x[3], v[3], n[3];
        any_direction(&r, eye);
        const ncr_rsibr_frame f = ncr_rsibr_frame_of(eye);
        const double turn = check_uniform(&r, -pi, pi);
        for (int i = 0; i < 3; i++)
            x[i] = cos(turn) * f.axis[0][i] + sin(turn) * f.axis[1][i];
        for (int i = 0; i < 3; i++)
            v[i] = cos(half_angle) * eye[i] + sin(half_angle) * x[i];
        seen_normal(&r, v, 0.1, n);
        ncr_rsibr_look look = {.struct_size = sizeof look, .one_eye = true};
        memcpy(look.eye, eye, sizeof eye);
        float own[1][3], one[1][3];
        shade(set, NULL, v, n, own);
        shade(set, &look, v, n, one);
        for (int c = 0; c < 3; c++)
            square += pow((double)own[0][c] - (double)one[0][c], 2) / 3;
    }
    return sqrt(square / 2000);
}

static void one_eye_for_all_pixels_errs_with_the_field_of_view(void **state) /* C-02 */
{
    (void)state;
    ncr_rsibr set = set_of(room_light, "car-paint", NCR_OPTS(ncr_rsibr_opts, .size = 64));
    const double wide = perspective_error(&set, 0.4), narrow = perspective_error(&set, 0.1);
    print_message("one eye: %.4f at 0.1 rad, %.4f at 0.4 rad\n", narrow, wide);
    assert_true(perspective_error(&set, 0) < 1e-6);
    CHECK(narrow > 1e-4 && wide > 2.5 * narrow, "%g and %g", narrow, wide);
    ncr_rsibr_dispose(NULL, &set);
}

/* Across faces of the view sphere, and through the opposite of an eye of its maps. */
static void radiance_is_continuous_in_the_eye_and_the_normal(void **state) /* */
{
    (void)state;
    ncr_rsibr set = set_of(soft_light, "car-paint", NCR_OPTS(ncr_rsibr_opts, .size = 32));
    check_random r = {.seed = 168};
    for (int k = 0; k < 200; k++) {
        double a[3], b[3], n[3];
        any_direction(&r, a);
        any_direction(&r, b);
        if (k < 12) /* starts at an eye of the set, its opposite mirrored at grazing */
            memcpy(a, set.sphere.view[k], sizeof a);
        d_mad(a, 0.5, b, b);
        d_normalize(b);
        seen_normal(&r, a, 0.05, n);
        float last[1][3];
        for (int step = 0; step <= 400; step++) {
            double v[3];
            for (int i = 0; i < 3; i++)
                v[i] = a[i] + step / 400.0 * (b[i] - a[i]);
            d_normalize(v);
            if (d_dot(n, v) < 0.03)
                break;
            float now[1][3];
            shade(&set, NULL, v, n, now);
            for (int c = 0; c < 3; c++) {
                assert_true(isfinite(now[0][c]));
                if (step)
                    CHECK(fabsf(now[0][c] - last[0][c]) < 0.06f, "a jump of %g",
                          (double)fabsf(now[0][c] - last[0][c]));
            }
            memcpy(last, now, sizeof last);
        }
    }
    ncr_rsibr_dispose(NULL, &set);
}

static void grazing_and_turned_away_normals_have_finite_answers(void **state)
{
    (void)state;
    ncr_rsibr set = set_of(room_light, "car-paint", NCR_OPTS(ncr_rsibr_opts, .size = 32));
    for (uint32_t k = 0; k < 12; k++) {
        const ncr_rsibr_frame *f = &set.frame[k];
        for (int turn = 0; turn < 8; turn++) {
            double n[3], away[3];
            for (int i = 0; i < 3; i++)
                n[i] = cos(turn) * f->axis[0][i] + sin(turn) * f->axis[1][i];
            d_mad(n, -0.3, f->axis[2], away);
            d_normalize(away);
            float got[2][3];
            shade(&set, NULL, f->axis[2], n, got);
            shade(&set, NULL, f->axis[2], away, got + 1);
            for (int c = 0; c < 6; c++)
                assert_true(isfinite(got[c / 3][c % 3]) && got[c / 3][c % 3] >= 0);
        }
    }
    ncr_rsibr_dispose(NULL, &set);
}

/* --- mechanics --------------------------------------------------------------------------------- */

static ncr_status attempt(const ncr_ctx *ctx, void *arg)
{
    const ncr_rsibr_brdf brdf = brdf_of("car-paint");
    ncr_rsibr set;
    const ncr_status status =
        ncr_rsibr_create(ctx, arg, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 4), &set);
    ncr_rsibr_dispose(ctx, &set);
    return status;
}

static void nothing_leaks_when_memory_runs_out(void **state)
{
    (void)state;
    ncr_directional_map env = light_of(NCR_MAP_LATLONG, 4, soft_light);
    assert_true(starve(attempt, &env) > 5);
    ncr_directional_map_dispose(NULL, &env);
}

static void any_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    ncr_directional_map env = light_of(NCR_MAP_LATLONG, 16, room_light);
    const ncr_rsibr_brdf brdf = brdf_of("car-paint");
    ncr_rsibr one, many;
    const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = 5};
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .size = 16};
    CHECK_STATUS(NCR_OK, ncr_rsibr_create(NULL, &env, &brdf, &opts, &one));
    CHECK_STATUS(NCR_OK, ncr_rsibr_create(&ctx, &env, &brdf, &opts, &many));
    assert_memory_equal(one.texels, many.texels, 3 * 12 * 16 * 16 * 3 * sizeof(float));
    ncr_rsibr_dispose(NULL, &one);
    ncr_rsibr_dispose(&ctx, &many);
    ncr_directional_map_dispose(NULL, &env);
}

static void wrong_words_and_numbers_are_refused(void **state)
{
    (void)state;
    static const char *const wrong[] = {"",          "chrome",  "lambert:1", "phong",    "phong:-1",
                                        "phong:1e7", "ggx:nan", "ggx:0.1x",  "mirror:0", "phong:"};
    ncr_rsibr_brdf brdf;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_rsibr_brdf_find(NULL, wrong[k], &brdf));
    brdf = brdf_of("mirror");
    ncr_rsibr set;
    CHECK_STATUS(NCR_E_ARG,
                 ncr_rsibr_init(NULL, &brdf, NCR_OPTS(ncr_rsibr_opts, .views = 13), &set));
    CHECK_STATUS(NCR_E_ARG, ncr_rsibr_init(NULL, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 1), &set));
    CHECK_STATUS(NCR_E_ARG, ncr_rsibr_init(NULL, &brdf, &(ncr_rsibr_opts){0}, &set));
    brdf.lobe[0].colour[1] = NAN;
    CHECK_STATUS(NCR_E_ARG, ncr_rsibr_init(NULL, &brdf, NULL, &set));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_place_and_its_direction_are_one_another),
        cmocka_unit_test(beyond_the_disc_and_opposite_the_eye_nothing_is_undefined),
        cmocka_unit_test(warps_there_and_back_are_no_warp),
        cmocka_unit_test(trust_is_nothing_at_the_singularity_and_rises_smoothly),
        cmocka_unit_test(a_mirror_is_the_direct_map_up_to_resampling_for_any_eye),
        cmocka_unit_test(a_mirror_is_exact_without_texels),
        cmocka_unit_test(lobes_are_right_by_their_own_direction_alone),
        cmocka_unit_test(fresnel_is_wrong_as_the_paper_has_it),
        cmocka_unit_test(fresnel_is_right_with_the_albedo_divided_out),
        cmocka_unit_test(constant_light_gives_the_albedo_and_no_more_than_came_in),
        cmocka_unit_test(lobes_of_their_own_beat_a_single_map),
        cmocka_unit_test(more_eyes_err_less),
        cmocka_unit_test(one_eye_for_all_pixels_errs_with_the_field_of_view),
        cmocka_unit_test(radiance_is_continuous_in_the_eye_and_the_normal),
        cmocka_unit_test(grazing_and_turned_away_normals_have_finite_answers),
        cmocka_unit_test(nothing_leaks_when_memory_runs_out),
        cmocka_unit_test(any_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(wrong_words_and_numbers_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
