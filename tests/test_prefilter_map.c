/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "shading/harmonics_points_internal.h"
#include "shading/prefilter.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

static void random_direction(uint64_t k, double d[3])
{
    const double z = 2 * ncr_uniform(k, 31) - 1, phi = 2 * pi * ncr_uniform(k, 32);
    d[0] = sqrt(1 - z * z) * cos(phi);
    d[1] = sqrt(1 - z * z) * sin(phi);
    d[2] = z;
}

static void smooth_light(const double d[3], void *user, float *out)
{
    (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.5 * d[c] + 0.3 * d[0] * d[1] + exp(3 * (d[2] - 1)));
}

static void constant_light(const double d[3], void *user, float *out)
{
    (void)d;
    (void)user;
    out[0] = out[1] = out[2] = 0.7f;
}

/* A smooth sky with a sun of 2.5e5 times its brightness. */
static void sunny_light(const double d[3], void *user, float *out)
{
    smooth_light(d, user, out);
    if (0.48 * d[0] + 0.6 * d[1] + 0.64 * d[2] > 0.996)
        for (int c = 0; c < 3; c++)
            out[c] = 2.5e5f;
}

static ncr_directional_map make_map(ncr_map_kind kind, uint32_t size, ncr_axes axes,
                                    ncr_radiance_fn *light)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, kind, size, 3, &map));
    map.axes = axes;
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0, light, NULL));
    return map;
}

static const ncr_axes turned = {{2, -3, 1}};
static const ncr_lobe lobes[] = {{.kind = NCR_LOBE_LAMBERT},
                                 {.kind = NCR_LOBE_PHONG, .parameter = 20.5},
                                 {.kind = NCR_LOBE_GGX, .parameter = 0.2}};
static const uint32_t sizes[NCR_MAP_KINDS] = {24, 64, 48, 64, 48};

/* Light of the texels of any map, against the sum that defines it. */
static void every_kind_of_map_is_analysed_texel_by_texel(void **state)
{
    (void)state;
    enum { last = 12 };
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map map = make_map((ncr_map_kind)kind, sizes[kind], turned, sunny_light);
        ncr_texels texels;
        ncr_harmonics a;
        ncr_texel_report report;
        double want[(last + 1) * (last + 1)] = {0}, y[(last + 1) * (last + 1)], size = 0;
        double one[(last + 1) * (last + 1)] = {0};
        CHECK_STATUS(NCR_OK, ncr_texels_of_map(NULL, &map, false, &texels));
        CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, last, 3, &a));
        CHECK_STATUS(
            NCR_OK, ncr_harmonics_gather_texels(NULL, &texels, false, (double[4]){0}, &a, &report));
        for (uint32_t k = 0; k < map.image.width * map.image.height; k++) {
            double d[3];
            const double area = ncr_texels_at(&texels, k % map.image.width, k / map.image.width, d);
            ncr_harmonics_basis(last, d, y);
            for (int i = 0; area > 0 && i < (last + 1) * (last + 1); i++)
                want[i] += area * (double)map.image.data[3 * k + 1] * y[i], one[i] += area * y[i];
        }
        for (int i = 1; i < (last + 1) * (last + 1); i++)
            want[i] -= want[0] * one[i] / one[0];
        for (int i = 0; i < (last + 1) * (last + 1); i++)
            size = fmax(size, fabs(want[i]));
        for (uint32_t l = 0; l <= last; l++)
            for (int32_t m = -(int32_t)l; m <= (int32_t)l; m++)
                CHECK_NEAR(ncr_harmonics_at(&a, l, m)[1], want[(int32_t)(l * (l + 1)) + m],
                           1e-4 * size);
        CHECK_NEAR(ncr_harmonics_at(&a, 0, 0)[1], want[0], 2e-7 * size);
        ncr_harmonics_dispose(NULL, &a);
        ncr_texels_dispose(NULL, &texels);
        ncr_directional_map_dispose(NULL, &map);
    }
}

/* From every kind into every kind, along any axes, against brute force over the texels. */
static double worst_error(const ncr_directional_map *in, const ncr_lobe *lobe,
                          const ncr_directional_map *out, double *of_one)
{
    enum { probes = 40 };
    double d[probes][3], want[probes][3], whole[probes], worst = 0;
    float *got[probes];
    for (uint64_t k = 0; k < probes; k++) {
        const uint32_t w = ncr_map_part_width(out->kind, out->size);
        double own[3];
        ncr_map_coord at;
        random_direction(k, d[k]);
        ncr_axes_apply(out->axes, d[k], own);
        at = ncr_map_from_direction(out->kind, own);
        const uint32_t x = (uint32_t)fmin(w - 1, 0.5 * (at.s + 1) * w);
        const uint32_t y = (uint32_t)fmin(out->size - 1, 0.5 * (at.t + 1) * out->size);
        got[k] = ncr_directional_map_at(out, at.part, x, y);
        at.s = 2 * (x + 0.5) / w - 1;
        at.t = 2 * (y + 0.5) / out->size - 1;
        if (ncr_map_to_direction(out->kind, at, own))
            ncr_axes_undo(out->axes, own, d[k]);
        else
            got[k] = NULL;
    }
    CHECK_STATUS(NCR_OK, ncr_prefilter_direct_map(NULL, in, lobe, probes, d[0], want[0], whole));
    *of_one = 0; /* what brute force itself gets wrong on a map of 1 */
    for (int k = 0; k < probes; k++)
        *of_one = fmax(*of_one, fabs(whole[k] - 1));
    for (int k = 0; k < probes; k++)
        for (int c = 0; got[k] && c < 3; c++)
            worst = fmax(worst, fabs((double)got[k][c] - want[k][c]));
    return worst;
}

static void every_kind_is_filtered_into_every_kind(void **state)
{
    (void)state;
    for (int from = 0; from < NCR_MAP_KINDS; from++) {
        ncr_directional_map in = make_map((ncr_map_kind)from, sizes[from],
                                          from % 2 ? turned : (ncr_axes){{0}}, sunny_light);
        const ncr_lobe *lobe = &lobes[from % 3];
        ncr_prefilter *p;
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_create_for(NULL, &in, 1, lobe, 1e-3,
                                              NCR_OPTS(ncr_prefilter_opts, .peel = 1e-3), &p));
        for (int to = 0; to < NCR_MAP_KINDS; to++) {
            ncr_directional_map out;
            ncr_prefilter_report report;
            CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, (ncr_map_kind)to, 12, 3, &out));
            out.axes = to % 2 ? (ncr_axes){{0}} : turned;
            CHECK_STATUS(NCR_OK, ncr_prefilter_fill(NULL, p, lobe, NULL, &out, &report));
            double of_one;
            const double worst = worst_error(&in, lobe, &out, &of_one);
            CHECK(worst <= 1e-3 * ncr_prefilter_mean(p), "%d to %d: %g of the mean", from, to,
                  worst / ncr_prefilter_mean(p));
            ncr_directional_map_dispose(NULL, &out);
        }
        ncr_prefilter_destroy(NULL, p);
        ncr_directional_map_dispose(NULL, &in);
    }
}

static void a_constant_stays_constant_in_every_kind(void **state)
{
    (void)state;
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map in = make_map((ncr_map_kind)kind, 16, turned, constant_light), out;
        ncr_prefilter *p;
        CHECK_STATUS(NCR_OK, ncr_prefilter_create_for(NULL, &in, 3, lobes, 1e-3, NULL, &p));
        CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, (ncr_map_kind)kind, 9, 3, &out));
        for (int k = 0; k < 3; k++) {
            CHECK_STATUS(NCR_OK, ncr_prefilter_fill(NULL, p, &lobes[k], NULL, &out, NULL));
            for (uint32_t i = 0; i < out.image.width * out.image.height * 3; i++)
                CHECK_NEAR((double)out.image.data[i] / (double)0.7f, 1, 1e-6);
        }
        ncr_prefilter_destroy(NULL, p);
        ncr_directional_map_dispose(NULL, &in);
        ncr_directional_map_dispose(NULL, &out);
    }
}

/* ---- order and bounds ------------------------------------------------------------------------ */

/* On smooth maps the bound tells the error within a factor of ten, whatever order is asked for. */
static void the_bound_is_near_the_error_of_smooth_maps(void **state)
{
    (void)state;
    ncr_directional_map in = make_map(NCR_MAP_LATLONG, 64, (ncr_axes){{0}}, smooth_light), out;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_OCTAHEDRAL, 64, 3, &out));
    for (int k = 0; k < 3; k++) {
        ncr_prefilter *p;
        CHECK_STATUS(NCR_OK, ncr_prefilter_create_for(NULL, &in, 1, &lobes[k], 1e-5, NULL, &p));
        for (uint32_t order = 1; order <= 5; order++) {
            const ncr_prefilter_output how = {.struct_size = sizeof how, .order = order};
            ncr_prefilter_report report;
            CHECK_STATUS(NCR_OK, ncr_prefilter_fill(NULL, p, &lobes[k], &how, &out, &report));
            double of_one;
            const double worst = worst_error(&in, &lobes[k], &out, &of_one);
            const double bound = report.bound_max + report.rounding + 8 * report.resampling +
                                 of_one * ncr_prefilter_mean(p);
            CHECK(worst <= bound && bound <= 10 * worst, "lobe %d order %u: %g, bound %g", k, order,
                  worst, bound);
        }
        ncr_prefilter_destroy(NULL, p);
    }
    ncr_directional_map_dispose(NULL, &in);
    ncr_directional_map_dispose(NULL, &out);
}

static void an_order_keeps_its_tolerance_and_no_lower_one_does(void **state)
{
    (void)state;
    ncr_directional_map in = make_map(NCR_MAP_LATLONG, 64, turned, smooth_light), out;
    double before = 0;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_SPHERE, 4, 3, &out));
    for (double tolerance = 0.1; tolerance > 5e-5; tolerance *= 0.1) {
        ncr_prefilter *p;
        uint32_t order;
        double bound;
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_create_for(NULL, &in, 1, &lobes[2], tolerance, NULL, &p));
        CHECK_STATUS(NCR_OK, ncr_prefilter_order(NULL, p, &lobes[2], tolerance, &order, &bound));
        CHECK(bound <= tolerance * ncr_prefilter_mean(p), "%g beyond %g", bound, tolerance);
        if (order > 1) {
            const ncr_prefilter_output how = {.struct_size = sizeof how, .order = order - 1};
            ncr_prefilter_report report;
            CHECK_STATUS(NCR_OK, ncr_prefilter_fill(NULL, p, &lobes[2], &how, &out, &report));
            CHECK(report.bound_max > tolerance * ncr_prefilter_mean(p), "order %u would do", order);
        }
        CHECK_STATUS(NCR_E_LIMIT, ncr_prefilter_order(NULL, p, &lobes[2], 1e-12, &order, &bound));
        before = order;
        ncr_prefilter_destroy(NULL, p);
    }
    CHECK(before > 6, "no more than %g", before);
    ncr_directional_map_dispose(NULL, &in);
    ncr_directional_map_dispose(NULL, &out);
}

/* Lambert errs by 3/8 of the mean at order 2 and by half as much for each doubling, when all light is
 * in one texel: the order must follow the lobe, far beyond what the map's texels tell apart. */
static void a_single_texel_needs_every_degree_of_the_lobe(void **state)
{
    (void)state;
    ncr_directional_map in = make_map(NCR_MAP_LATLONG, 16, (ncr_axes){{0}}, constant_light), out;
    memset(in.image.data, 0, 32 * 16 * 3 * sizeof(float));
    for (int c = 0; c < 3; c++)
        ncr_image_at(&in.image, 9, 5)[c] = 1e4f;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_CUBE, 32, 3, &out));
    for (double tolerance = 0.2; tolerance > 0.004; tolerance *= 0.25) {
        ncr_prefilter *p;
        uint32_t order;
        CHECK_STATUS(NCR_OK, ncr_prefilter_create_for(NULL, &in, 1, lobes, tolerance, NULL, &p));
        CHECK_STATUS(NCR_OK, ncr_prefilter_order(NULL, p, lobes, tolerance, &order, NULL));
        CHECK(order > 0.5 / tolerance, "order %u at %g", order, tolerance);
        CHECK_STATUS(NCR_OK, ncr_prefilter_fill(NULL, p, lobes, NULL, &out, NULL));
        double of_one;
        const double worst = worst_error(&in, lobes, &out, &of_one) / ncr_prefilter_mean(p);
        CHECK(worst <= tolerance, "%g at %g", worst, tolerance);
        ncr_prefilter_destroy(NULL, p);
    }
    ncr_directional_map_dispose(NULL, &in);
    ncr_directional_map_dispose(NULL, &out);
}

static void a_sun_costs_few_degrees_once_it_is_peeled(void **state)
{
    (void)state;
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map in = make_map((ncr_map_kind)kind, sizes[kind], turned, sunny_light);
        ncr_prefilter *p, *whole;
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_create_for(NULL, &in, 1, lobes, 1e-2,
                                              NCR_OPTS(ncr_prefilter_opts, .peel = 1e-2), &p));
        CHECK_STATUS(NCR_OK, ncr_prefilter_create_for(NULL, &in, 1, lobes, 1e-2, NULL, &whole));
        const ncr_prefilter_info a = ncr_prefilter_info_get(p), b = ncr_prefilter_info_get(whole);
        CHECK(a.light_count >= 1, "kind %d: no light", kind);
        CHECK(4 * a.band_limit <= b.band_limit, "kind %d: %u of %u", kind, a.band_limit,
              b.band_limit);
        CHECK_NEAR(ncr_prefilter_mean(p), ncr_prefilter_mean(whole), 2e-6 * ncr_prefilter_mean(p));
        ncr_prefilter_destroy(NULL, p);
        ncr_prefilter_destroy(NULL, whole);
        ncr_directional_map_dispose(NULL, &in);
    }
}

/* ---- nine coefficients ----------------------------------------------------------------------- */

/* Their sum stays within the bound, along any axes, with the lights and without a window. */
static void nine_coefficients_stay_within_their_bound(void **state)
{
    (void)state;
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        enum { probes = 60 };
        ncr_directional_map in = make_map((ncr_map_kind)kind, sizes[kind], turned, sunny_light);
        ncr_prefilter *p;
        ncr_prefilter_nine nine;
        double d[probes][3], want[probes][3], worst = 0;
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_create_for(NULL, &in, 1, lobes, 1e-3,
                                              NCR_OPTS(ncr_prefilter_opts, .peel = 1e-3), &p));
        CHECK_STATUS(NCR_OK, ncr_prefilter_nine_get(NULL, p, lobes, NULL, &nine));
        for (uint64_t k = 0; k < probes; k++)
            random_direction(k, d[k]);
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_direct_map(NULL, &in, lobes, probes, d[0], want[0], NULL));
        for (int k = 0; k < probes; k++) {
            double y[9], sum = 0;
            ncr_harmonics_basis(2, d[k], y);
            for (int i = 0; i < 9; i++)
                sum += nine.filtered[i][1] * y[i];
            worst = fmax(worst, fabs(sum - want[k][1]));
            CHECK(sum >= nine.lowest[1] - 0.01 * ncr_prefilter_mean(p), "%g below %g", sum,
                  nine.lowest[1]);
        }
        CHECK(worst <= nine.bound && worst > 0.2 * nine.bound, "kind %d: %g, bound %g", kind, worst,
              nine.bound);
        CHECK_NEAR(nine.radiance[0][1] / sqrt(4 * pi), ncr_prefilter_mean(p),
                   1e-5 * ncr_prefilter_mean(p));
        ncr_prefilter_destroy(NULL, p);
        ncr_directional_map_dispose(NULL, &in);
    }
}

/* Light from +x, +y and +z alone, in the world's axes whatever the map's. */
static void axis_light(const double d[3], void *user, float *out)
{
    (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.9 * d[c]);
}

static void coefficients_lie_along_the_axes_of_the_world(void **state)
{
    (void)state;
    static const int term[3] = {3, 1, 2}; /* (1,1) (1,-1) (1,0) rise along x, y, z */
    ncr_directional_map in = make_map(NCR_MAP_LATLONG, 32, turned, axis_light);
    ncr_prefilter *p;
    ncr_prefilter_nine nine;
    CHECK_STATUS(NCR_OK, ncr_prefilter_create_map(NULL, &in, NULL, &p));
    CHECK_STATUS(NCR_OK, ncr_prefilter_nine_get(NULL, p, lobes, NULL, &nine));
    for (int c = 0; c < 3; c++) {
        for (int k = 1; k < 9; k++)
            CHECK_NEAR(nine.radiance[k][c], k == term[c] ? 0.9 * sqrt(4 * pi / 3) : 0, 1e-6);
        CHECK_NEAR(nine.filtered[term[c]][c], 0.6 * sqrt(4 * pi / 3), 1e-6);
        CHECK_NEAR(nine.lowest[c], 0.4, 2e-3);
    }
    ncr_prefilter_destroy(NULL, p);
    ncr_directional_map_dispose(NULL, &in);
}

/* ---- the rest -------------------------------------------------------------------------------- */

static void any_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    ncr_directional_map in = make_map(NCR_MAP_CUBE, 24, turned, sunny_light), first = {0};
    for (unsigned workers = 1; workers <= 5; workers += 2) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers};
        ncr_directional_map out;
        ncr_prefilter *p;
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_create_for(&ctx, &in, 1, &lobes[2], 1e-3,
                                              NCR_OPTS(ncr_prefilter_opts, .peel = 1e-3), &p));
        CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_CUBE, 10, 3, &out));
        CHECK_STATUS(NCR_OK, ncr_prefilter_fill(&ctx, p, &lobes[2], NULL, &out, NULL));
        ncr_prefilter_destroy(&ctx, p);
        if (workers == 1)
            first = out;
        assert_memory_equal(first.image.data, out.image.data, 10 * 60 * 3 * sizeof(float));
        if (workers > 1)
            ncr_directional_map_dispose(NULL, &out);
    }
    ncr_directional_map_dispose(NULL, &first);
    ncr_directional_map_dispose(NULL, &in);
}

static ncr_status filter_all(const ncr_ctx *ctx, void *arg)
{
    const ncr_directional_map *in = arg;
    ncr_directional_map out;
    ncr_prefilter *p;
    double d[3] = {0, 0, 1}, value[3];
    ncr_prefilter_report report;
    ncr_status status = ncr_prefilter_create_for(ctx, in, 1, &lobes[1], 1e-1,
                                                 NCR_OPTS(ncr_prefilter_opts, .peel = 1e-3), &p);
    if (status)
        return status;
    status = ncr_directional_map_init(ctx, NCR_MAP_SPHERE, 8, 3, &out);
    if (!status)
        status = ncr_prefilter_fill(ctx, p, &lobes[1], NULL, &out, &report);
    if (!status)
        status = ncr_prefilter_direct_map(ctx, in, &lobes[1], 1, d, value, NULL);
    ncr_directional_map_dispose(ctx, &out);
    ncr_prefilter_destroy(ctx, p);
    return status;
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    ncr_directional_map in = make_map(NCR_MAP_CUBE, 16, turned, sunny_light);
    assert_true(starve(filter_all, &in) > 30);
    ncr_directional_map_dispose(NULL, &in);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    ncr_directional_map in = make_map(NCR_MAP_CUBE, 4, turned, smooth_light), gray;
    const ncr_lobe wrong = {.kind = NCR_LOBE_PHONG, .parameter = -2};
    ncr_prefilter *p;
    CHECK_STATUS(NCR_E_ARG, ncr_prefilter_create_for(NULL, &in, 1, &wrong, 1e-3, NULL, &p));
    assert_null(p);
    CHECK_STATUS(NCR_E_ARG, ncr_prefilter_create_map(NULL, &in, &(ncr_prefilter_opts){0}, &p));
    CHECK_STATUS(NCR_OK, ncr_prefilter_create_map(NULL, &in, NULL, &p));
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_CUBE, 4, 1, &gray));
    CHECK_STATUS(NCR_E_ARG, ncr_prefilter_fill(NULL, p, lobes, NULL, &gray, NULL));
    ncr_prefilter_destroy(NULL, p);
    ncr_directional_map_dispose(NULL, &gray);
    ncr_directional_map_dispose(NULL, &in);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_map_is_analysed_texel_by_texel),
        cmocka_unit_test(every_kind_is_filtered_into_every_kind),
        cmocka_unit_test(a_constant_stays_constant_in_every_kind),
        cmocka_unit_test(the_bound_is_near_the_error_of_smooth_maps),
        cmocka_unit_test(an_order_keeps_its_tolerance_and_no_lower_one_does),
        cmocka_unit_test(a_single_texel_needs_every_degree_of_the_lobe),
        cmocka_unit_test(a_sun_costs_few_degrees_once_it_is_peeled),
        cmocka_unit_test(nine_coefficients_stay_within_their_bound),
        cmocka_unit_test(coefficients_lie_along_the_axes_of_the_world),
        cmocka_unit_test(any_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
