/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "shading/prefilter_internal.h"

static const double pi = 3.14159265358979323846;
static const ncr_lobe lobes[] = {{.kind = NCR_LOBE_LAMBERT},
                                 {.kind = NCR_LOBE_PHONG, .parameter = 20.5},
                                 {.kind = NCR_LOBE_GGX, .parameter = 0.3},
                                 {.kind = NCR_LOBE_PHONG, .parameter = 120}};
enum { lobe_count = 4, out_size = 16, broad = 10, seeds = 24 };

/* Broad glows of random place, width and colour over a constant. */
typedef struct glow {
    double axis[3], narrow, colour[3];
} glow;

typedef struct sky {
    check_random r;
    glow glows[broad];
    double noise;             /* of each texel, over 1 */
    double spots, spot_value; /* share of texels that are bright, and how bright */
    double disc, disc_value;  /* cosine of the first glow's disc, and its light */
} sky;

static void random_axis(check_random *r, double d[3])
{
    const double z = check_uniform(r, -1, 1), phi = check_uniform(r, 0, 2 * pi);
    const double s = sqrt(1 - z * z);
    d[0] = s * cos(phi), d[1] = s * sin(phi), d[2] = z;
}

static sky make_sky(uint64_t seed)
{
    sky s = {.r = {.seed = seed}, .disc = 2};
    for (int k = 0; k < broad; k++) {
        random_axis(&s.r, s.glows[k].axis);
        s.glows[k].narrow = exp(check_uniform(&s.r, 0, log(12)));
        for (int c = 0; c < 3; c++)
            s.glows[k].colour[c] = check_uniform(&s.r, 0, 2);
    }
    return s;
}

static void radiance(const double d[3], void *user, float *out)
{
    sky *s = user;
    double value[3] = {1, 1, 1};
    for (int k = 0; k < broad; k++) {
        const double *a = s->glows[k].axis, x = a[0] * d[0] + a[1] * d[1] + a[2] * d[2];
        for (int c = 0; c < 3; c++)
            value[c] += s->glows[k].colour[c] * exp(s->glows[k].narrow * (x - 1)) +
                        (k == 0 && x > s->disc ? s->disc_value : 0);
    }
    const bool spot = s->spots > 0 && check_uniform(&s->r, 0, 1) < s->spots;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(value[c] + (s->noise > 0 ? check_uniform(&s->r, 0, s->noise) : 0) +
                         (spot ? s->spot_value : 0));
}

static ncr_directional_map map_of(sky *s, uint32_t size)
{
    ncr_directional_map map;
    float *at;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_LATLONG, size, 3, &map));
    at = map.image.data;
    for (uint32_t y = 0; y < size; y++)
        for (uint32_t x = 0; x < 2 * size; x++, at += 3) {
            const ncr_map_coord place = {0, (x + 0.5) / size - 1, 2 * (y + 0.5) / size - 1};
            double d[3];
            ncr_map_to_direction(NCR_MAP_LATLONG, place, d);
            radiance(d, s, at);
        }
    return map;
}

/* ---- errors ---------------------------------------------------------------------------------- */

typedef struct verdict {
    double error, bound, mean, own; /* own: what the sum over texels itself may get wrong */
} verdict;

static double brightest(const ncr_directional_map *map)
{
    double most = 0;
    for (size_t k = 0; k < (size_t)map->image.width * map->image.height * 3; k++)
        most = fmax(most, (double)map->image.data[k]);
    return most;
}

/* Every texel of an output against the sum over all texels. */
static double worst_error(const ncr_directional_map *in, const ncr_lobe *lobe,
                          const ncr_directional_map *out, double *of_one)
{
    enum { count = out_size * out_size };
    static double d[count][3], want[count][3], whole[count];
    double worst = 0;
    *of_one = 0;
    for (uint32_t k = 0; k < count; k++) {
        const ncr_map_coord at = {0, 2 * (k % out_size + 0.5) / out_size - 1,
                                  2 * (k / out_size + 0.5) / out_size - 1};
        ncr_map_to_direction(NCR_MAP_OCTAHEDRAL, at, d[k]);
    }
    CHECK_STATUS(NCR_OK, ncr_prefilter_direct_map(NULL, in, lobe, count, d[0], want[0], whole));
    for (uint32_t k = 0; k < 3 * count; k++) {
        worst = fmax(worst, fabs((double)out->image.data[k] - want[k / 3][k % 3]));
        *of_one = fmax(*of_one, fabs(whole[k / 3] - 1));
    }
    return worst;
}

static verdict judge(const ncr_directional_map *in, const ncr_prefilter *p, const ncr_lobe *lobe,
                     uint32_t order)
{
    const ncr_prefilter_output how = {.struct_size = sizeof how, .order = order};
    ncr_directional_map out;
    ncr_prefilter_report report;
    double of_one;
    verdict v = {.mean = ncr_prefilter_mean(p)};
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_OCTAHEDRAL, out_size, 3, &out));
    CHECK_STATUS(NCR_OK, ncr_prefilter_fill(NULL, p, lobe, &how, &out, &report));
    v.error = worst_error(in, lobe, &out, &of_one);
    v.own = of_one * brightest(in); /* as on a map of 1, where this one is bright */
    v.bound = report.bound_max + report.rounding + 8 * report.resampling + v.own;
    ncr_directional_map_dispose(NULL, &out);
    return v;
}

static void on_smooth_maps_the_bound_is_within_ten_times_the_error(void **state)
{
    (void)state;
    double most = 0;
    for (uint64_t seed = 0; seed < seeds; seed++) {
        sky s = make_sky(seed);
        ncr_directional_map in = map_of(&s, 64);
        const ncr_lobe *lobe = &lobes[seed % lobe_count];
        const double tolerance = pow(10, -check_uniform(&s.r, 1.5, 4));
        ncr_prefilter *p;
        uint32_t order;
        CHECK_STATUS(NCR_OK, ncr_prefilter_create_for(NULL, &in, 1, lobe, tolerance, NULL, &p));
        CHECK_STATUS(NCR_OK, ncr_prefilter_order(NULL, p, lobe, tolerance, &order, NULL));
        const verdict v = judge(&in, p, lobe, order ? order : 1);
        CHECK(v.error <= tolerance * v.mean + v.own, "seed %u: %g of %g", (unsigned)seed,
              v.error / v.mean, tolerance);
        CHECK(v.error <= v.bound, "seed %u: %g above %g", (unsigned)seed, v.error, v.bound);
        CHECK(v.bound <= 10 * v.error, "seed %u, order %u: %g far below %g", (unsigned)seed, order,
              v.error, v.bound);
        most = fmax(most, v.bound / v.error);
        ncr_prefilter_destroy(NULL, p);
        ncr_directional_map_dispose(NULL, &in);
    }
    print_message("bound over error on %d smooth maps: at most %.2g\n", seeds, most);
}

/* Noise, bright texels, a disc of light of any size; peeled or not; to any degree. */
static void no_map_errs_beyond_its_bound(void **state)
{
    (void)state;
    for (uint64_t seed = 100; seed < 100 + seeds; seed++) {
        sky s = make_sky(seed);
        s.noise = seed % 3 == 0 ? 3 : 0;
        s.spots = seed % 3 == 1 ? 0.004 : 0;
        s.spot_value = pow(10, check_uniform(&s.r, 0, 4));
        s.disc = cos(check_uniform(&s.r, 0.02, 0.3));
        s.disc_value = pow(10, check_uniform(&s.r, 0, 4));
        ncr_directional_map in = map_of(&s, 64);
        const ncr_lobe *lobe = &lobes[seed % lobe_count];
        const uint32_t limit = (uint32_t)check_uniform(&s.r, 1, 60);
        ncr_prefilter *p;
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_create_map(NULL, &in,
                                              NCR_OPTS(ncr_prefilter_opts, .band_limit = limit,
                                                       .peel = seed % 2 ? 1e-3 : 0),
                                              &p));
        for (uint32_t order = 1; order <= limit; order = order * 2 + 1) {
            const verdict v = judge(&in, p, lobe, order);
            CHECK(v.error <= v.bound, "seed %u, order %u of %u: %g above %g", (unsigned)seed, order,
                  limit, v.error / v.mean, v.bound / v.mean);
        }
        ncr_prefilter_destroy(NULL, p);
        ncr_directional_map_dispose(NULL, &in);
    }
}

/* A lamp of more than a thousand texels in the dark, and a lobe narrower than the lamp. */
static void a_wide_lamp_keeps_its_tolerance(void **state)
{
    (void)state;
    const ncr_lobe lobe = {.kind = NCR_LOBE_PHONG, .parameter = 400};
    sky s = make_sky(7);
    s.disc = cos(0.12);
    s.disc_value = 300; /* 740 texels */
    ncr_directional_map in = map_of(&s, 320);
    ncr_prefilter *p;
    uint32_t order;
    CHECK_STATUS(NCR_OK, ncr_prefilter_create_for(NULL, &in, 1, &lobe, 1e-3,
                                                  NCR_OPTS(ncr_prefilter_opts, .peel = 1e-3), &p));
    CHECK_STATUS(NCR_OK, ncr_prefilter_order(NULL, p, &lobe, 1e-3, &order, NULL));
    const verdict v = judge(&in, p, &lobe, order);
    CHECK(v.error <= 1e-3 * v.mean + v.own && v.error <= v.bound, "%g, bound %g", v.error / v.mean,
          v.bound / v.mean);
    ncr_prefilter_destroy(NULL, p);
    ncr_directional_map_dispose(NULL, &in);
}

/* ---- the largest value of a sum of harmonics ------------------------------------------------- */

/* One harmonic of any degree and order stays below what is said, and that is near. */
static void the_largest_value_of_a_sum_is_near_what_is_said(void **state)
{
    (void)state;
    sky s = make_sky(3);
    s.noise = 5;
    ncr_directional_map in = map_of(&s, 64);
    ncr_prefilter *p;
    CHECK_STATUS(NCR_OK, ncr_prefilter_create_map(
                             NULL, &in, NCR_OPTS(ncr_prefilter_opts, .band_limit = 30), &p));
    for (uint32_t first = 0; first <= 30; first += 3) {
        double change[31], most, largest = 0;
        ncr_image fine;
        for (uint32_t l = 0; l <= 30; l++)
            change[l] = l >= first && l < first + 6 ? check_uniform(&s.r, -1, 1) : 0;
        CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 720, 360, 3, &fine));
        CHECK_STATUS(NCR_OK, ncr_harmonics_synthesise(NULL, &p->harmonics, change, NULL, &fine));
        for (size_t k = 0; k < 3 * 720 * 360; k++)
            largest = fmax(largest, fabs((double)fine.data[k]));
        CHECK_STATUS(NCR_OK, ncr_prefilter_largest(NULL, p, 30, change, &most));
        CHECK(largest <= most && most <= 1.4 * largest, "from %u: %g, said %g", first, largest,
              most);
        ncr_image_dispose(NULL, &fine);
    }
    ncr_prefilter_destroy(NULL, p);
    ncr_directional_map_dispose(NULL, &in);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_smooth_maps_the_bound_is_within_ten_times_the_error),
        cmocka_unit_test(no_map_errs_beyond_its_bound),
        cmocka_unit_test(a_wide_lamp_keeps_its_tolerance),
        cmocka_unit_test(the_largest_value_of_a_sum_is_near_what_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
