/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/cpu_internal.h"
#include "shading/harmonics.h"
#include "shading/harmonics_internal.h"
#include "shading/legendre_internal.h"
#include "shading/quadrature_internal.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- definitions ----------------------------------------------------------------------------- */

static void texel_direction(uint32_t w, uint32_t h, uint32_t x, uint32_t y, double d[3])
{
    const double theta = (y + 0.5) * pi / h, phi = (x + 0.5) * 2 * pi / w;
    d[0] = sin(theta) * cos(phi);
    d[1] = sin(theta) * sin(phi);
    d[2] = cos(theta);
}

static ncr_harmonics random_harmonics(uint32_t band_limit, uint32_t channels, uint64_t key)
{
    ncr_harmonics h;
    CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, band_limit, channels, &h));
    for (uint32_t l = 0; l <= band_limit; l++)
        for (int32_t m = -(int32_t)l; m <= (int32_t)l; m++)
            for (uint32_t c = 0; c < channels; c++)
                ncr_harmonics_at(&h, l, m)[c] =
                    ncr_uniform((l * (l + 1) + (uint64_t)m) * 4 + c, key) - 0.5;
    return h;
}

static ncr_image empty_image(uint32_t w, uint32_t h, uint32_t channels)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, w, h, channels, &image));
    return image;
}

static ncr_image random_image(uint32_t w, uint32_t h, uint32_t channels, uint64_t key)
{
    ncr_image image = empty_image(w, h, channels);
    for (size_t k = 0; k < (size_t)w * h * channels; k++)
        image.data[k] = (float)ncr_uniform(k, key);
    return image;
}

/* sum of a(l,m) Y(l,m)(d), one channel. */
static double defined_value(const ncr_harmonics *h, const double *zonal, const double d[3],
                            uint32_t channel)
{
    const uint32_t n = h->band_limit + 1;
    double *y = malloc((size_t)n * n * sizeof *y), sum = 0;
    ncr_harmonics_basis(h->band_limit, d, y);
    for (uint32_t l = 0; l < n; l++)
        for (int32_t m = -(int32_t)l; m <= (int32_t)l; m++)
            sum += (zonal ? zonal[l] : 1) * y[(int64_t)l * (l + 1) + m] *
                   ncr_harmonics_at(h, l, m)[channel];
    free(y);
    return sum;
}

/* Largest difference of two sets of coefficients, over the norm of the first. */
static double difference(const ncr_harmonics *a, const ncr_harmonics *b)
{
    const size_t n = (a->band_limit + 1) * ((size_t)a->band_limit + 2) * a->channels;
    double worst = 0, square = 0;
    for (size_t k = 0; k < n; k++) {
        worst = fmax(worst, fabs(a->data[k] - b->data[k]));
        square += a->data[k] * a->data[k];
    }
    return worst / sqrt(square);
}

/* ---- Legendre functions and the basis -------------------------------------------------------- */

/* */
static double addition_residual(uint32_t l, double theta)
{
    double sum = 0;
    for (uint32_t m = 0; m <= l; m++) {
        ncr_legendre f = ncr_legendre_begin(m, sin(theta));
        while (f.l < l)
            ncr_legendre_next(&f, cos(theta));
        const double p = ncr_legendre_value(&f);
        sum += (m ? 2 : 1) * p * p;
    }
    return fabs(sum * 4 * pi / (2 * l + 1) - 1);
}

static void squares_of_one_degree_sum_to_a_constant(void **state)
{
    (void)state;
    static const double thetas[] = {1e-8, 0.3, 1.5};
    for (size_t k = 0; k < sizeof thetas / sizeof *thetas; k++) {
        CHECK_NEAR(addition_residual(3, thetas[k]), 0, 1e-14);
        CHECK_NEAR(addition_residual(2000, thetas[k]), 0, 1e-9);
    }
    CHECK_NEAR(addition_residual(4000, 0.9), 0, 1e-8);
}

static void the_first_functions_are_the_known_ones(void **state)
{
    (void)state;
    const double d[3] = {0.48, -0.6, 0.64};
    double y[9];
    ncr_harmonics_basis(2, d, y);
    CHECK_NEAR(y[0], 0.28209479177387814, 1e-15);
    CHECK_NEAR(y[1], 0.48860251190291992 * d[1], 1e-15);
    CHECK_NEAR(y[2], 0.48860251190291992 * d[2], 1e-15);
    CHECK_NEAR(y[3], 0.48860251190291992 * d[0], 1e-15);
    CHECK_NEAR(y[4], 1.0925484305920792 * d[0] * d[1], 1e-15);
    CHECK_NEAR(y[6], 0.31539156525252005 * (3 * d[2] * d[2] - 1), 1e-15);
    CHECK_NEAR(y[8], 0.5462742152960396 * (d[0] * d[0] - d[1] * d[1]), 1e-15);
}

/* Gauss's rule in z and the trapezoid rule in phi are exact for products of degree 14. */
static void the_basis_is_orthonormal(void **state)
{
    (void)state;
    enum { last = 7, count = (last + 1) * (last + 1), rows = 12, columns = 24 };
    double z[rows], weight[rows], gram[count][count] = {{0}};
    ncr_gauss_legendre(rows, z, weight);
    for (int i = 0; i < rows; i++) {
        for (int j = 0; j < columns; j++) {
            const double s = sqrt((1 - z[i]) * (1 + z[i])), phi = 2 * pi * j / columns;
            double y[count];
            ncr_harmonics_basis(last, (const double[3]){s * cos(phi), s * sin(phi), z[i]}, y);
            for (int a = 0; a < count; a++)
                for (int b = 0; b < count; b++)
                    gram[a][b] += weight[i] * 2 * pi / columns * y[a] * y[b];
        }
    }
    for (int a = 0; a < count; a++)
        for (int b = 0; b < count; b++)
            CHECK_NEAR(gram[a][b], a == b, 1e-13);
}

static void functions_beyond_their_reach_are_nothing(void **state)
{
    (void)state;
    static const uint32_t limits[] = {8, 64, 500, 2000};
    for (size_t k = 0; k < 4; k++) {
        for (double s = 1e-4; s < 0.9; s *= 1.7) {
            const uint32_t m = ncr_legendre_reach(limits[k], s) + 1;
            if (m > limits[k])
                break;
            ncr_legendre f = ncr_legendre_begin(m, s);
            while (f.l < limits[k])
                ncr_legendre_next(&f, sqrt((1 - s) * (1 + s)));
            CHECK(fabs(ncr_legendre_value(&f)) < 1e-11, "L %u m %u sin %g: %g", limits[k], m, s,
                  ncr_legendre_value(&f));
        }
    }
}

/* ---- quadrature ------------------------------------------------------------------------------ */

static void rows_weigh_four_pi_and_the_exact_ones_integrate_cosines(void **state)
{
    (void)state;
    static const uint32_t heights[] = {1, 2, 7, 32, 99};
    for (size_t k = 0; k < 5; k++) {
        const uint32_t h = heights[k];
        double area[99], exact[99], sum = 0;
        ncr_harmonics_row_weights(h, true, area);
        ncr_harmonics_row_weights(h, false, exact);
        for (uint32_t i = 0; i < h; i++)
            sum += area[i];
        CHECK_NEAR(sum, 4 * pi, 1e-12);
        for (uint32_t n = 0; n < h; n++) {
            double got = 0;
            for (uint32_t i = 0; i < h; i++)
                got += exact[i] * cos(n * (i + 0.5) * pi / h);
            CHECK_NEAR(got, n % 2 ? 0 : 4 * pi / (1 - (double)n * n), 1e-12);
        }
    }
}

static void neighbours_give_every_frequency_of_the_band(void **state)
{
    (void)state;
    ncr_taps_solver solver;
    ncr_taps_prepare(NCR_TAPS, 1.0 / NCR_TAPS_OVERSAMPLING, 4, &solver);
    const double error = ncr_taps_error(&solver);
    CHECK(error < 4e-7, "error %g", error);
    double weight[NCR_TAPS], sum = 0;
    ncr_taps_weigh(&solver, 0.25, weight);
    for (int k = 0; k < NCR_TAPS; k++)
        sum += weight[k];
    CHECK_NEAR(sum, 1, 3e-9);
}

/* ---- maps ------------------------------------------------------------------------------------ */

typedef struct map_size {
    uint32_t w, h, channels, band_limit;
} map_size;

/* Powers of two, odd, prime and tiny sides; few rows and many; bands beyond what a row can hold. */
static const map_size sizes[] = {{64, 32, 3, 12},  {60, 31, 2, 13},   {97, 51, 4, 20},
                                 {1, 1, 1, 3},     {2, 3, 3, 2},      {16, 8, 1, 12},
                                 {256, 128, 3, 9}, {101, 301, 3, 17}, {480, 240, 3, 100}};

static void a_filled_map_holds_the_sum_of_its_harmonics(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        const map_size s = sizes[k];
        ncr_harmonics a = random_harmonics(s.band_limit, s.channels, 11);
        ncr_image map = empty_image(s.w, s.h, s.channels);
        double *zonal = malloc((s.band_limit + 1) * sizeof *zonal);
        for (uint32_t l = 0; l <= s.band_limit; l++)
            zonal[l] = 1.0 / (1 + l);
        CHECK_STATUS(NCR_OK, ncr_harmonics_synthesise(NULL, &a, zonal, NULL, &map));
        for (uint32_t t = 0; t < 30; t++) {
            const uint32_t x = (uint32_t)(ncr_uniform(t, 5) * s.w);
            const uint32_t y = t == 0 ? 0 : t == 1 ? s.h - 1 : (uint32_t)(ncr_uniform(t, 6) * s.h);
            double d[3];
            texel_direction(s.w, s.h, x, y, d);
            for (uint32_t c = 0; c < s.channels; c++)
                CHECK_NEAR((double)ncr_image_at(&map, x, y)[c], defined_value(&a, zonal, d, c),
                           2e-6);
        }
        free(zonal);
        ncr_image_dispose(NULL, &map);
        ncr_harmonics_dispose(NULL, &a);
    }
}

static void defined_analysis(const ncr_image *map, bool row_areas, ncr_harmonics *out)
{
    const uint32_t n = out->band_limit + 1;
    double *y = malloc((size_t)n * n * sizeof *y), *row = malloc(map->height * sizeof *row);
    ncr_harmonics_row_weights(map->height, row_areas, row);
    for (uint32_t j = 0; j < map->height; j++) {
        for (uint32_t i = 0; i < map->width; i++) {
            double d[3];
            texel_direction(map->width, map->height, i, j, d);
            ncr_harmonics_basis(out->band_limit, d, y);
            for (uint32_t l = 0; l < n; l++)
                for (int32_t m = -(int32_t)l; m <= (int32_t)l; m++)
                    for (uint32_t c = 0; c < map->channels; c++)
                        ncr_harmonics_at(out, l, m)[c] += row[j] / map->width *
                                                          y[(int64_t)l * (l + 1) + m] *
                                                          (double)ncr_image_at(map, i, j)[c];
        }
    }
    free(y);
    free(row);
}

static void coefficients_are_sums_over_all_texels(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes - 1; k++) {
        const map_size s = sizes[k];
        ncr_image map = random_image(s.w, s.h, s.channels, 3);
        ncr_harmonics want, got;
        CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, s.band_limit, s.channels, &want));
        CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, s.band_limit, s.channels, &got));
        const ncr_harmonics_opts opts = {.struct_size = sizeof opts, .row_areas = k % 2};
        defined_analysis(&map, opts.row_areas, &want);
        CHECK_STATUS(NCR_OK, ncr_harmonics_analyse(NULL, &map, &opts, &got, NULL));
        CHECK_NEAR(difference(&want, &got), 0, 5e-7);
        ncr_image_dispose(NULL, &map);
        ncr_harmonics_dispose(NULL, &want);
        ncr_harmonics_dispose(NULL, &got);
    }
}

static void fewer_rows_say_the_same_as_all(void **state)
{
    (void)state;
    ncr_image map = random_image(512, 256, 3, 9);
    ncr_harmonics few, all;
    CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, 40, 3, &few));
    CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, 40, 3, &all));
    ncr_texel_report a, b;
    CHECK_STATUS(NCR_OK, ncr_harmonics_analyse(NULL, &map, NULL, &few, &a));
    CHECK_STATUS(NCR_OK,
                 ncr_harmonics_analyse(NULL, &map, NCR_OPTS(ncr_harmonics_opts, .every_row = true),
                                       &all, &b));
    CHECK_NEAR(difference(&all, &few), 0, 5e-7);
    CHECK_NEAR(a.square, b.square, 1e-5 * b.square);
    ncr_image_dispose(NULL, &map);
    ncr_harmonics_dispose(NULL, &few);
    ncr_harmonics_dispose(NULL, &all);
}

static void analysis_recovers_what_was_put_in(void **state)
{
    (void)state;
    static const map_size maps[] = {{64, 32, 3, 15}, {90, 41, 2, 20}, {400, 200, 1, 24}};
    for (size_t k = 0; k < 3; k++) {
        const map_size s = maps[k];
        ncr_harmonics a = random_harmonics(s.band_limit, s.channels, 21), b;
        ncr_image map = empty_image(s.w, s.h, s.channels);
        CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, s.band_limit, s.channels, &b));
        CHECK_STATUS(NCR_OK, ncr_harmonics_synthesise(NULL, &a, NULL, NULL, &map));
        CHECK_STATUS(NCR_OK, ncr_harmonics_analyse(NULL, &map, NULL, &b, NULL));
        CHECK_NEAR(difference(&a, &b), 0, 5e-7);
        ncr_image_dispose(NULL, &map);
        ncr_harmonics_dispose(NULL, &a);
        ncr_harmonics_dispose(NULL, &b);
    }
}

/* Odd and even heights, rows coarse and as they are, more orders than a row has texels, texels that
 * do not count; blocks that do and do not divide the rings. */
static void some_rings_at_a_time_sum_to_the_same_as_all(void **state)
{
    static const uint32_t cases[][3] = {
        {96, 400, 40}, {40, 401, 30}, {64, 131, 64}, {33, 96, 90}, {20, 260, 100}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        for (int strange = 0; strange < 2; strange++) {
            const ncr_harmonics_opts opts = {.struct_size = sizeof opts, .clamp_negative = strange};
            ncr_image map = random_image(cases[k][0], cases[k][1], 3, k);
            ncr_harmonics all, some;
            ncr_texel_report a, b;
            map.data[7] = strange ? NAN : 1;
            map.data[3 * (size_t)map.width * map.height - 5] = strange ? -9 : 1;
            map.data[3 * (size_t)map.width * (map.height / 2) + 4] = strange ? INFINITY : 2;
            CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, cases[k][2], 3, &all));
            CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, cases[k][2], 3, &some));
            CHECK_STATUS(NCR_OK,
                         ncr_harmonics_analyse_blocks(NULL, &map, &opts, NCR_ALL_RINGS, &all, &a));
            CHECK_STATUS(NCR_OK, ncr_harmonics_analyse_blocks(NULL, &map, &opts,
                                                              k % 2 ? NCR_WIDEST : 2 * NCR_WIDEST,
                                                              &some, &b));
            CHECK_NEAR(difference(&all, &some), 0, 1e-14);
            assert_int_equal(a.nonfinite, b.nonfinite);
            assert_int_equal(a.negative, b.negative);
            CHECK_NEAR(a.square, b.square, 1e-12 * a.square);
            ncr_harmonics_dispose(NULL, &all);
            ncr_harmonics_dispose(NULL, &some);
            ncr_image_dispose(NULL, &map);
        }
    }
}

static void strange_texels_are_counted_and_left_out(void **state)
{
    (void)state;
    for (int many_rows = 0; many_rows < 2; many_rows++) {
        const uint32_t w = many_rows ? 300 : 40, h = many_rows ? 150 : 20;
        ncr_image map = random_image(w, h, 3, 4), clean = random_image(w, h, 3, 4);
        const float strange[] = {NAN, INFINITY, -INFINITY, -3, -0.5f, -1};
        for (uint32_t k = 0; k < 6; k++) {
            ncr_image_at(&map, 3 + 5 * k, k * (h - 1) / 5)[k % 3] = strange[k];
            ncr_image_at(&clean, 3 + 5 * k, k * (h - 1) / 5)[k % 3] = 0;
        }
        ncr_harmonics want, got;
        ncr_texel_report report;
        CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, 9, 3, &want));
        CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, 9, 3, &got));
        CHECK_STATUS(NCR_OK, ncr_harmonics_analyse(NULL, &clean, NULL, &want, NULL));
        CHECK_STATUS(NCR_OK, ncr_harmonics_analyse(
                                 NULL, &map, NCR_OPTS(ncr_harmonics_opts, .clamp_negative = true),
                                 &got, &report));
        CHECK_NEAR(difference(&want, &got), 0, 0);
        assert_int_equal(report.nonfinite, 3);
        assert_int_equal(report.negative, 4);
        ncr_image_dispose(NULL, &map);
        ncr_image_dispose(NULL, &clean);
        ncr_harmonics_dispose(NULL, &want);
        ncr_harmonics_dispose(NULL, &got);
    }
}

/* ---- kernels, workers, memory ---------------------------------------------------------------- */

static const ncr_sht_kernels *const all_kernels[] = {&ncr_sht_plain, &ncr_sht_avx2,
                                                     &ncr_sht_avx512};

/* sum over l of P(l,m) c(l) on rings of one sign of z, against the definition. */
static void check_synthesis_of_an_order(const ncr_sht_kernels *k, uint32_t m, uint32_t last,
                                        const ncr_ring_set *rings)
{
    const size_t degrees = last - m + 1, lanes = k->lanes / 2;
    double *step = calloc(2 * (degrees + 6), sizeof *step);
    double *c = calloc(2 * (degrees + 2), sizeof *c), *data = calloc(4 * rings->count, 8);
    ncr_legendre_steps(m, last, step);
    for (size_t i = 0; i < degrees; i++) {
        c[2 * i] = ncr_uniform(i, m) - 0.5;
        c[2 * i + 1] = ncr_uniform(i, m + 9) - 0.5;
    }
    k->synthesise_order(rings, m, last, 1, step, c, data);
    for (size_t q = 0; q < rings->count; q++) {
        double want[4] = {0};
        ncr_legendre f = ncr_legendre_begin(m, rings->s[q]);
        for (size_t i = 0; i < degrees; i++, ncr_legendre_next(&f, rings->x[q]))
            for (size_t part = 0; part < 2; part++)
                want[i % 2 * 2 + part] += ncr_legendre_value(&f) * c[2 * i + part];
        for (size_t part = 0; part < 4; part++)
            CHECK_NEAR(data[(q / lanes * 4 + part) * lanes + q % lanes], want[part], 1e-8);
    }
    free(step);
    free(c);
    free(data);
}

/* sum over rings of P(l,m) f, likewise. */
static void check_analysis_of_an_order(const ncr_sht_kernels *k, uint32_t m, uint32_t last,
                                       const ncr_ring_set *rings)
{
    const size_t degrees = last - m + 1, lanes = k->lanes / 2;
    double *step = calloc(2 * (degrees + 6), sizeof *step), *out = calloc(2 * (degrees + 4), 8);
    double *data = calloc(4 * rings->count, 8), *state = calloc(3 * rings->count, 8);
    double *want = calloc(2 * degrees, 8);
    ncr_legendre_steps(m, last, step);
    for (size_t i = 0; i < 4 * rings->count; i++)
        data[i] = ncr_uniform(i, m + 5) - 0.5;
    k->analyse_order(rings, m, last, 1, step, data, state, out);
    for (size_t q = 0; q < rings->count; q++) {
        ncr_legendre f = ncr_legendre_begin(m, rings->s[q]);
        for (size_t i = 0; i < degrees; i++, ncr_legendre_next(&f, rings->x[q]))
            for (size_t part = 0; part < 2; part++)
                want[2 * i + part] += ncr_legendre_value(&f) *
                                      data[(q / lanes * 4 + i % 2 * 2 + part) * lanes + q % lanes];
    }
    for (size_t i = 0; i < 2 * degrees; i++)
        CHECK_NEAR(out[i], want[i], 1e-8);
    free(step);
    free(out);
    free(data);
    free(state);
    free(want);
}

static void every_processor_sums_the_same_legendre_functions(void **state)
{
    (void)state;
    enum { count = 64 };
    double x[count], s[count];
    const ncr_ring_set rings = {.count = count, .x = x, .s = s};
    for (int q = 0; q < count; q++) {
        x[q] = cos((q + 0.5) * pi / 2 / count);
        s[q] = sin((q + 0.5) * pi / 2 / count);
    }
    for (int k = 0; k <= (int)ncr_cpu_level(); k++) {
        static const uint32_t orders[][2] = {{0, 0},    {0, 7},       {1, 40},
                                             {37, 38},  {64, 100},    {700, 2000},
                                             {0, 2000}, {1500, 2000}, {1999, 2000}};
        for (size_t i = 0; i < sizeof orders / sizeof *orders; i++) {
            check_synthesis_of_an_order(all_kernels[k], orders[i][0], orders[i][1], &rings);
            check_analysis_of_an_order(all_kernels[k], orders[i][0], orders[i][1], &rings);
        }
    }
}

/* Rows to spectrum against plain sums, and back. */
static void check_rows(const ncr_sht_kernels *k, uint32_t width, uint32_t rows)
{
    const uint32_t channels = 3, orders = width / 2 + 1, pairs = (rows + 1) / 2;
    const uint32_t padded = (pairs + NCR_WIDEST - 1) / NCR_WIDEST * NCR_WIDEST;
    ncr_image map = random_image(width, rows, channels, 8), back = empty_image(width, rows, 3);
    ncr_fft fft;
    CHECK_STATUS(NCR_OK, ncr_fft_init(NULL, width, &fft));
    ncr_row_set set = {.rows = rows,
                       .width = width,
                       .channels = channels,
                       .pairs = pairs,
                       .padded = padded,
                       .orders = orders,
                       .data = map.data,
                       .fft = &fft};
    set.spectrum = calloc((size_t)orders * 4 * channels * padded, sizeof(float));
    float *scratch = malloc(ncr_row_scratch(&set) * sizeof *scratch);
    for (uint32_t q = 0; q < pairs; q += k->lanes)
        k->rows_to_spectrum(&set, q, scratch);
    for (uint32_t m = 0; m < orders; m++) {
        double re = 0, im = 0;
        for (uint32_t x = 0; x < width; x++) {
            const double sum =
                (double)ncr_image_at(&map, x, 0)[1] + (double)ncr_image_at(&map, x, rows - 1)[1];
            re += sum * cos(2 * pi * m * x / width);
            im -= sum * sin(2 * pi * m * x / width);
        }
        const float *column = set.spectrum + (size_t)m * 4 * channels * padded;
        CHECK_NEAR((double)column[1 * padded], re, 1e-4);
        CHECK_NEAR((double)column[4 * padded], im, 1e-4);
    }
    /* Sum and difference are twice what they were; with an even width so is the last order. */
    const float scale = 0.5f / (float)width;
    set.data = back.data;
    for (size_t i = 0; i < (size_t)orders * 4 * channels * padded; i++)
        set.spectrum[i] *=
            width % 2 == 0 && i / (4 * channels * padded) == width / 2 ? scale / 2 : scale;
    for (uint32_t q = 0; q < pairs; q += k->lanes)
        k->spectrum_to_rows(&set, q, scratch);
    for (size_t i = 0; i < (size_t)width * rows * channels; i++)
        CHECK_NEAR((double)back.data[i], (double)map.data[i], 2e-6);
    free(scratch);
    free(set.spectrum);
    ncr_fft_dispose(NULL, &fft);
    ncr_image_dispose(NULL, &map);
    ncr_image_dispose(NULL, &back);
}

static void every_processor_transforms_rows_of_any_smooth_width(void **state)
{
    (void)state;
    static const uint32_t widths[] = {1, 2, 3, 4, 5, 6, 30, 64, 75, 125, 360};
    for (int k = 0; k <= (int)ncr_cpu_level(); k++)
        for (size_t i = 0; i < sizeof widths / sizeof *widths; i++)
            check_rows(all_kernels[k], widths[i], i % 2 ? 40 : 5);
}

static void any_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    static const unsigned workers[] = {1, 2, 3, 7};
    ncr_image map = random_image(300, 170, 3, 2), first = {0};
    for (size_t k = 0; k < 4; k++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers[k]};
        ncr_harmonics a;
        ncr_image out = empty_image(300, 170, 3);
        CHECK_STATUS(NCR_OK, ncr_harmonics_init(&ctx, 25, 3, &a));
        CHECK_STATUS(NCR_OK, ncr_harmonics_analyse(&ctx, &map, NULL, &a, NULL));
        CHECK_STATUS(NCR_OK, ncr_harmonics_synthesise(&ctx, &a, NULL, NULL, &out));
        ncr_harmonics_dispose(&ctx, &a);
        if (k == 0) {
            first = out;
            continue;
        }
        assert_memory_equal(first.data, out.data, 300 * 170 * 3 * sizeof(float));
        ncr_image_dispose(NULL, &out);
    }
    ncr_image_dispose(NULL, &first);
    ncr_image_dispose(NULL, &map);
}

static ncr_status round_trip(const ncr_ctx *ctx, void *arg)
{
    const ncr_image *map = arg;
    ncr_harmonics a;
    ncr_status status = ncr_harmonics_init(ctx, 10, 3, &a);
    if (!status)
        status = ncr_harmonics_analyse(ctx, map, NULL, &a, NULL);
    if (!status)
        status = ncr_harmonics_synthesise(ctx, &a, NULL, NULL, map);
    ncr_harmonics_dispose(ctx, &a);
    return status;
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    ncr_image map = random_image(101, 101, 3, 1); /* both kinds of taps */
    ncr_image_at(&map, 5, 5)[0] = NAN;            /* and the copy */
    assert_true(starve(round_trip, &map) > 20);
    ncr_image_dispose(NULL, &map);
}

static void wrong_calls_are_refused(void **state)
{
    (void)state;
    ncr_harmonics a;
    ncr_image map = empty_image(8, 4, 2);
    CHECK_STATUS(NCR_E_ARG, ncr_harmonics_init(NULL, 4, 5, &a));
    CHECK_STATUS(NCR_E_ARG, ncr_harmonics_init(NULL, NCR_HARMONICS_MAX + 1, 1, &a));
    CHECK_STATUS(NCR_OK, ncr_harmonics_init(NULL, 4, 3, &a));
    CHECK_STATUS(NCR_E_ARG, ncr_harmonics_analyse(NULL, &map, NULL, &a, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_harmonics_synthesise(NULL, &a, NULL, NULL, &map));
    ncr_image_dispose(NULL, &map);
    ncr_harmonics_dispose(NULL, &a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(squares_of_one_degree_sum_to_a_constant),
        cmocka_unit_test(the_first_functions_are_the_known_ones),
        cmocka_unit_test(the_basis_is_orthonormal),
        cmocka_unit_test(functions_beyond_their_reach_are_nothing),
        cmocka_unit_test(rows_weigh_four_pi_and_the_exact_ones_integrate_cosines),
        cmocka_unit_test(neighbours_give_every_frequency_of_the_band),
        cmocka_unit_test(a_filled_map_holds_the_sum_of_its_harmonics),
        cmocka_unit_test(coefficients_are_sums_over_all_texels),
        cmocka_unit_test(fewer_rows_say_the_same_as_all),
        cmocka_unit_test(analysis_recovers_what_was_put_in),
        cmocka_unit_test(some_rings_at_a_time_sum_to_the_same_as_all),
        cmocka_unit_test(strange_texels_are_counted_and_left_out),
        cmocka_unit_test(every_processor_sums_the_same_legendre_functions),
        cmocka_unit_test(every_processor_transforms_rows_of_any_smooth_width),
        cmocka_unit_test(any_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
        cmocka_unit_test(wrong_calls_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
