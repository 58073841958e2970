/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/vec_internal.h"
#include "shading/paraboloid_filter.h"
#include "shading/prefilter.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

static void even(const double d[3], void *user, float *out)
{
    (void)d, (void)user;
    out[0] = out[1] = out[2] = 0.7f;
}

/* Walls, a bright window and a lamp. */
static void room(const double d[3], void *user, float *out)
{
    (void)user;
    const bool window = d[1] < -0.6 && fabs(d[2] - 0.1) < 0.3;
    const bool lamp = 0.6 * d[0] + 0.8 * d[2] > 0.985;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(0.6 + 0.3 * sin(5 * d[c]) + (window ? 4 : 0) + (lamp ? 30 - 8 * c : 0));
}

static ncr_directional_map map_of(ncr_map_kind kind, uint32_t size, ncr_radiance_fn *fn)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, kind, size, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 1.0 / size, fn, NULL));
    return map;
}

static ncr_directional_map filtered(const ncr_ctx *ctx, const ncr_directional_map *map,
                                    double exponent, ncr_paraboloid_filter_opts opts)
{
    ncr_directional_map out;
    opts.struct_size = sizeof opts;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, map->kind, map->size, 3, &out));
    CHECK_STATUS(NCR_OK, ncr_paraboloid_filter(ctx, map, exponent, &opts, &out));
    return out;
}

/* The tutorial's table of exponents, kernel sizes and shrink factors. */
static void sizes_are_those_of_the_table(void **state)
{
    (void)state;
    const struct {
        double exponent;
        ncr_two_radii want;
    } rows[] = {{10, {174, 260, 32, 64}},
                {50, {78, 136, 16, 32}},
                {100, {56, 100, 8, 16}},
                {250, {36, 66, 8, 16}},
                {500, {26, 48, 4, 8}}};
    for (int k = 0; k < 5; k++) {
        const ncr_two_radii got = ncr_two_radii_plan(rows[k].exponent, 0.1, 256, 7);
        assert_memory_equal(&got, &rows[k].want, sizeof got);
    }
}

/* A disc of radius r on the map, d from its middle, and the angles from the direction of its centre:
 * (most - least) / (most + least).                                                        [H-27] */
static double distortion(double d, double r)
{
    double centre[3], p[3], least = pi, most = 0;
    ncr_map_to_direction(NCR_MAP_PARABOLOID, (ncr_map_coord){0, d, 0}, centre);
    for (int k = 0; k < 720; k++) {
        const double phi = k * pi / 360;
        ncr_map_to_direction(NCR_MAP_PARABOLOID, (ncr_map_coord){0, d + r * cos(phi), r * sin(phi)},
                             p);
        const double angle = acos(fmin(1, d_dot(centre, p)));
        least = fmin(least, angle);
        most = fmax(most, angle);
    }
    return (most - least) / (most + least);
}

static void discs_become_nearly_round_caps(void **state)
{
    (void)state;
    CHECK_NEAR(distortion(0, 0.6), 0, 1e-12);
    CHECK_NEAR(distortion(1, 0.4), 0.195, 5e-4);
    CHECK_NEAR(distortion(1, 0.6), 0.282, 5e-4);
    assert_true(distortion(0.5, 0.4) < distortion(1, 0.4));
    assert_true(distortion(1, 0.1) < 0.06);
}

static void a_constant_stays_itself(void **state)
{
    (void)state;
    const uint32_t sizes[] = {1, 2, 13, 64};
    const double exponents[] = {0.5, 10, 500, 1e6};
    for (int how = 0; how < 2; how++)
        for (int s = 0; s < 4; s++)
            for (int e = 0; e < 4; e++) {
                ncr_directional_map map = map_of(NCR_MAP_PARABOLOID, sizes[s], even);
                ncr_directional_map out =
                    filtered(NULL, &map, exponents[e],
                             (ncr_paraboloid_filter_opts){.how = (ncr_paraboloid_how)how});
                for (size_t k = 0; k < 6 * (size_t)sizes[s] * sizes[s]; k++)
                    CHECK_NEAR((double)out.image.data[k], (double)0.7f, 1e-6);
                ncr_directional_map_dispose(NULL, &out);
                ncr_directional_map_dispose(NULL, &map);
            }
}

/* Root mean square of the difference over the sphere, over that of the exact map. */
static double nrmse(const ncr_directional_map *map, const ncr_prefilter_grid *exact)
{
    double sum = 0, size = 0;
    for (uint32_t part = 0; part < 2; part++)
        for (uint32_t y = 0; y < map->size; y++)
            for (uint32_t x = 0; x < map->size; x++) {
                const double omega = ncr_map_texel_solid_angle(map->kind, map->size, x, y);
                const ncr_map_coord at = {part, (2.0 * x + 1) / map->size - 1,
                                          (2.0 * y + 1) / map->size - 1};
                double d[3];
                if (omega == 0 || !ncr_map_to_direction(map->kind, at, d))
                    continue;
                const ncr_vec3 f = d_to_v(d);
                float want[3];
                const float *got = ncr_directional_map_at(map, part, x, y);
                ncr_prefilter_grid_sample(exact, 1, &f, want);
                for (int c = 0; c < 3; c++) {
                    sum += omega * pow((double)got[c] - (double)want[c], 2);
                    size += omega * pow((double)want[c], 2);
                }
            }
    return sqrt(sum / size);
}

/* Figure 13 as numbers: true kernels are nearer than two fixed ones; neither is far off; and what
 * the hierarchy lacks is what its clamp and its few texels take away. */
static void true_kernels_err_less_than_two_fixed_ones(void **state)
{
    (void)state;
    ncr_directional_map map = map_of(NCR_MAP_PARABOLOID, 256, room);
    ncr_directional_map flat = map_of(NCR_MAP_LATLONG, 256, room);
    ncr_prefilter *prefilter;
    const ncr_lobe sharpest = {.kind = NCR_LOBE_PHONG, .parameter = 500};
    CHECK_STATUS(NCR_OK, ncr_prefilter_create(NULL, &flat.image,
                                              NCR_OPTS(ncr_prefilter_opts, .sharpest = &sharpest),
                                              &prefilter));
    const double exponents[] = {10, 50, 100, 250, 500};
    print_message("nrmse      hierarchical  two radii  hierarchical, clamp 0.001, 21 texels\n");
    for (int e = 0; e < 5; e++) {
        const ncr_lobe phong = {.kind = NCR_LOBE_PHONG, .parameter = exponents[e]};
        ncr_prefilter_grid *exact;
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_grid_create(NULL, prefilter, &phong, NULL, &exact, NULL));
        const ncr_paraboloid_filter_opts how[] = {
            {.how = NCR_PARABOLOID_HIERARCHICAL},
            {.how = NCR_PARABOLOID_TWO_RADII},
            {.how = NCR_PARABOLOID_HIERARCHICAL, .clamp = 1e-3, .most = 21}};
        double error[3];
        for (int k = 0; k < 3; k++) {
            ncr_directional_map out = filtered(NULL, &map, exponents[e], how[k]);
            error[k] = nrmse(&out, exact);
            ncr_directional_map_dispose(NULL, &out);
        }
        print_message("N = %-6g  %.4f       %.4f     %.4f\n", exponents[e], error[0], error[1],
                      error[2]);
        CHECK(error[0] < error[1], "%g %g", error[0], error[1]);
        CHECK(error[1] < 0.2, "%g", error[1]);
        CHECK(error[2] < 0.8 * error[0], "%g %g", error[2], error[0]);
        ncr_prefilter_grid_destroy(NULL, exact);
    }
    ncr_prefilter_destroy(NULL, prefilter);
    ncr_directional_map_dispose(NULL, &flat);
    ncr_directional_map_dispose(NULL, &map);
}

static void any_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    ncr_directional_map map = map_of(NCR_MAP_PARABOLOID, 64, room);
    for (int how = 0; how < 2; how++) {
        ncr_directional_map out[2];
        for (unsigned k = 0; k < 2; k++) {
            const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = 1 + 6 * k};
            out[k] = filtered(&ctx, &map, 100,
                              (ncr_paraboloid_filter_opts){.how = (ncr_paraboloid_how)how});
        }
        assert_memory_equal(out[0].image.data, out[1].image.data, 64 * 64 * 6 * sizeof(float));
        for (int k = 0; k < 2; k++)
            ncr_directional_map_dispose(NULL, &out[k]);
    }
    ncr_directional_map_dispose(NULL, &map);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    ncr_directional_map map = map_of(NCR_MAP_PARABOLOID, 8, even), cube, grey;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_CUBE, 8, 3, &cube));
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_PARABOLOID, 8, 1, &grey));
    CHECK_STATUS(NCR_E_ARG, ncr_paraboloid_filter(NULL, &map, 10, NULL, &cube));
    CHECK_STATUS(NCR_E_ARG, ncr_paraboloid_filter(NULL, &cube, 10, NULL, &map));
    CHECK_STATUS(NCR_E_ARG, ncr_paraboloid_filter(NULL, &map, 10, NULL, &grey));
    const double exponents[] = {0, -1, 1e7, NAN};
    for (int k = 0; k < 4; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_paraboloid_filter(NULL, &map, exponents[k], NULL, &map));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_paraboloid_filter(NULL, &map, 10,
                                       NCR_OPTS(ncr_paraboloid_filter_opts, .clamp = 1), &map));
    ncr_directional_map_dispose(NULL, &map);
    ncr_directional_map_dispose(NULL, &cube);
    ncr_directional_map_dispose(NULL, &grey);
}

static ncr_status attempt(const ncr_ctx *ctx, void *arg)
{
    ncr_directional_map out;
    ncr_status status = ncr_directional_map_init(ctx, NCR_MAP_PARABOLOID, 16, 3, &out);
    if (status != NCR_OK)
        return status;
    status = ncr_paraboloid_filter(
        ctx, arg, 50, NCR_OPTS(ncr_paraboloid_filter_opts, .how = NCR_PARABOLOID_TWO_RADII), &out);
    ncr_directional_map_dispose(ctx, &out);
    return status;
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    ncr_directional_map map = map_of(NCR_MAP_PARABOLOID, 16, room);
    assert_true(starve(attempt, &map) > 6);
    ncr_directional_map_dispose(NULL, &map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_those_of_the_table),
        cmocka_unit_test(discs_become_nearly_round_caps),
        cmocka_unit_test(a_constant_stays_itself),
        cmocka_unit_test(true_kernels_err_less_than_two_fixed_ones),
        cmocka_unit_test(any_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
