/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/cpu_internal.h"
#include "core/vec_internal.h"
#include "sampling/sample_map.h"
#include "shading/blend_internal.h"

#include <float.h>
#include <string.h>

static ncr_vec3 random_unit(check_random *random)
{
    const double z = check_uniform(random, -1, 1), phi = check_uniform(random, 0, 6.283185307);
    const double rho = sqrt(1 - z * z);
    return v_make((float)(rho * cos(phi)), (float)(rho * sin(phi)), (float)z);
}

static const float exponents[] = {0, 1e-30f, 0.5f, 1, 2, 4, 16, 64, 1000, 1e6f, INFINITY};
enum { exponent_count = sizeof exponents / sizeof *exponents };

/* Offsets that include the awkward ones: zero, opposite, tiny, huge, equal. */
static void random_offsets(check_random *random, unsigned count, ncr_vec3 *to_point)
{
    for (unsigned j = 0; j < count; j++) {
        const double kind = check_uniform(random, 0, 10);
        const float length = (float)exp(check_uniform(random, -6, 0));
        to_point[j] = v_scale(random_unit(random), length);
        if (kind < 1)
            to_point[j] = v_make(0, 0, 0);
        else if (kind < 2 && j > 0)
            to_point[j] = v_scale(to_point[j - 1], -1);
        else if (kind < 3 && j > 0)
            to_point[j] = to_point[j - 1];
        else if (kind < 4)
            to_point[j] = v_scale(to_point[j], kind < 3.5 ? 1e-36f : 1e34f);
    }
}

static void weights_are_a_partition_of_unity(void **state)
{
    (void)state;
    check_random random = {.seed = 38};
    for (int trial = 0; trial < 200000; trial++) {
        const unsigned count = 1 + (unsigned)check_uniform(&random, 0, 16);
        const unsigned valid = (unsigned)check_uniform(&random, 0, 65536) & ((1u << count) - 1);
        const ncr_basis basis = (ncr_basis)check_uniform(&random, 0, 6);
        const float exponent = exponents[(int)check_uniform(&random, 0, exponent_count)];
        ncr_vec3 p[16];
        float w[16];
        random_offsets(&random, count, p);
        const unsigned fallback = ncr_blend_weights(basis, exponent, count, p, valid,
                                                    random_unit(&random), random_unit(&random), w);
        float forward = 0, backward = 0;
        for (unsigned j = 0; j < count; j++) {
            CHECK(w[j] >= 0 && w[j] <= 1, "basis %d N %g: weight %g", (int)basis, exponent, w[j]);
            CHECK(w[j] == 0 || valid >> j & 1, "an invalid point has weight %g", w[j]);
            forward += w[j];
            backward += w[count - 1 - j];
        }
        const float want = valid ? 1 : 0;
        CHECK(forward == want && backward == want, "basis %d N %g: sums %.9g %.9g", (int)basis,
              exponent, forward, backward);
        assert_int_equal(fallback == NCR_BLEND_NONE, valid == 0);
    }
}

/* The basis as a formula in double, by the definition: no ratio, no fallback. */
static bool literal(double exponent, unsigned count, const ncr_vec3 *to_point, ncr_vec3 axis,
                    bool clamp_cosine, double *w)
{
    double sum = 0, a[3], p[3];
    v_to_d(axis, a);
    for (unsigned j = 0; j < count; j++) {
        v_to_d(to_point[j], p);
        const double c = d_dot(a, p) / d_length(p);
        w[j] = clamp_cosine ? pow(fmax(c, 0), exponent) : fmax(pow(c, exponent), 0);
        sum += w[j];
    }
    for (unsigned j = 0; j < count; j++)
        w[j] /= sum;
    return sum > 1e-250;
}

static void cosine_bases_match_the_formula(void **state)
{
    (void)state;
    check_random random = {.seed = 410};
    for (int trial = 0; trial < 100000; trial++) {
        const float exponent = (const float[]){0.5f, 1, 2, 4, 8, 16, 64, 100.5f}[trial % 8];
        const bool about_n = trial & 8;
        const ncr_vec3 n = random_unit(&random), r = random_unit(&random);
        ncr_vec3 p[4];
        for (int j = 0; j < 4; j++)
            p[j] = v_scale(random_unit(&random), (float)exp(check_uniform(&random, -6, 0)));
        double want[4];
        if (!literal(exponent, 4, p, about_n ? n : r, true, want))
            continue;
        float w[4];
        const unsigned fallback = ncr_blend_weights(
            about_n ? NCR_BASIS_COSINE_N : NCR_BASIS_COSINE_R, exponent, 4, p, 15, n, r, w);
        assert_int_equal(fallback, 0);
        for (int j = 0; j < 4; j++) /* N times the cosine's rounding, which a small one magnifies */
            CHECK_NEAR(w[j], want[j], 2e-6 * (1 + exponent));
    }
}

static void the_printed_formula_is_the_absolute_variant(void **state)
{
    (void)state;
    check_random random = {.seed = 42};
    int differs = 0;
    for (int trial = 0; trial < 20000; trial++) {
        const float exponent = trial & 1 ? 2 : 4;
        const ncr_vec3 n = random_unit(&random), r = random_unit(&random);
        ncr_vec3 p[4];
        for (int j = 0; j < 4; j++)
            p[j] = random_unit(&random);
        double want[4];
        float w[4], right[4];
        literal(exponent, 4, p, r, false, want);
        assert_int_equal(ncr_blend_weights(NCR_BASIS_ABS_R, exponent, 4, p, 15, n, r, w), 0);
        ncr_blend_weights(NCR_BASIS_COSINE_R, exponent, 4, p, 15, n, r, right);
        for (int j = 0; j < 4; j++) {
            CHECK_NEAR(w[j], want[j], 1e-6);
            differs += fabsf(right[j] - w[j]) > 0.01f;
        }
    }
    assert_true(differs > 10000); /* and it is not the basis that was meant */
}

static void points_behind_the_axis_have_no_weight(void **state)
{
    (void)state;
    check_random random = {.seed = 39};
    for (int trial = 0; trial < 50000; trial++) {
        const float exponent = (const float[]){1e-30f, 1, 2, 4, 8, 16}[trial % 6];
        const ncr_vec3 n = random_unit(&random), r = random_unit(&random);
        const bool about_n = trial % 7 < 3;
        const ncr_vec3 axis = about_n ? n : r;
        ncr_vec3 p[4];
        for (int j = 0; j < 4; j++)
            p[j] = random_unit(&random);
        p[trial % 4] = v_mad(axis, 0.1f, random_unit(&random)); /* at least one in front */
        float w[4];
        const unsigned fallback = ncr_blend_weights(
            about_n ? NCR_BASIS_COSINE_N : NCR_BASIS_COSINE_R, exponent, 4, p, 15, n, r, w);
        assert_int_equal(fallback, 0);
        for (int j = 0; j < 4; j++)
            if (v_dot(axis, p[j]) < 0)
                assert_true(w[j] == 0);
    }
}

static void exponent_zero_is_the_average(void **state)
{
    (void)state;
    check_random random = {.seed = 40};
    for (int trial = 0; trial < 10000; trial++) {
        const unsigned valid = 1 + (unsigned)check_uniform(&random, 0, 15);
        const ncr_vec3 n = random_unit(&random), r = random_unit(&random);
        ncr_vec3 p[4];
        float w[4], average[4];
        random_offsets(&random, 4, p);
        ncr_blend_weights(NCR_BASIS_AVERAGE, 0, 4, p, valid, n, r, average);
        for (int basis = NCR_BASIS_COSINE_R; basis <= NCR_BASIS_ABS_R; basis++) {
            ncr_blend_weights((ncr_basis)basis, 0, 4, p, valid, n, r, w);
            assert_memory_equal(w, average, sizeof w);
        }
        for (int j = 0; j < 4; j++)
            if (valid >> j & 1)
                CHECK_NEAR(average[j], 1.0 / __builtin_popcount(valid), 0x1p-23);
        if (valid == 15)
            for (int j = 0; j < 4; j++)
                assert_true(average[j] == 0.25f);
    }
}

static void a_huge_exponent_takes_the_largest(void **state)
{
    (void)state;
    const ncr_vec3 r = {0, 0, 1};
    const ncr_vec3 p[4] = {{0.1f, 0, 1}, {0, 0.05f, 1}, {0.05f, 0.05f, 1}, {0, 0, -1}};
    float w[4];
    const float all_on_second[4] = {0, 1, 0, 0};
    assert_int_equal(ncr_blend_weights(NCR_BASIS_COSINE_R, 1e6f, 4, p, 15, r, r, w), 0);
    for (int j = 0; j < 4; j++)
        CHECK_NEAR(w[j], all_on_second[j], 1e-12);
    assert_int_equal(ncr_blend_weights(NCR_BASIS_COSINE_R, INFINITY, 4, p, 15, r, r, w), 0);
    assert_memory_equal(w, all_on_second, sizeof w);

    /* a tie is shared by a power, and goes to the lowest channel at infinity and for `angle` */
    const ncr_vec3 tie[4] = {{0.1f, 0, 1}, {0, 0.05f, 1}, {0.05f, 0, 1}, {0, 0, -1}};
    const float shared[4] = {0, 0.5f, 0.5f, 0};
    ncr_blend_weights(NCR_BASIS_COSINE_R, 1e6f, 4, tie, 15, r, r, w);
    assert_memory_equal(w, shared, sizeof w);
    ncr_blend_weights(NCR_BASIS_COSINE_R, INFINITY, 4, tie, 15, r, r, w);
    assert_memory_equal(w, all_on_second, sizeof w);
    ncr_blend_weights(NCR_BASIS_ANGLE, 0, 4, tie, 15, r, r, w);
    assert_memory_equal(w, all_on_second, sizeof w);
}

static void a_point_on_the_ray_takes_all_for_angle(void **state)
{
    (void)state;
    check_random random = {.seed = 36};
    for (int trial = 0; trial < 20000; trial++) {
        const ncr_vec3 n = random_unit(&random), r = random_unit(&random);
        const int on = trial % 4;
        ncr_vec3 p[4];
        for (int j = 0; j < 4; j++)
            do
                p[j] = random_unit(&random);
            while (v_dot(p[j], r) > 0.999f);
        p[on] = v_scale(r, 0.3f);
        for (int basis = 0; basis < 2; basis++) {
            float w[4];
            ncr_blend_weights(basis ? NCR_BASIS_COSINE_R : NCR_BASIS_ANGLE, 1e6f, 4, p, 15, n, r,
                              w);
            for (int j = 0; j < 4; j++)
                assert_true(w[j] == (j == on));
        }
    }
}

static void fallbacks_come_in_order_and_are_told(void **state)
{
    (void)state;
    const ncr_vec3 n = {0, 0, 1}, r = {1, 0, 0};
    float w[4];

    /* all behind r, two above the surface */
    const ncr_vec3 behind[4] = {{-1, 0, 1}, {-1, 0, -1}, {-1, 0, 1}, {0, 0, -1}};
    const float upper[4] = {0.5f, 0, 0.5f, 0};
    assert_int_equal(ncr_blend_weights(NCR_BASIS_COSINE_R, 4, 4, behind, 15, n, r, w),
                     NCR_BLEND_COSINE_N4);
    assert_memory_equal(w, upper, sizeof w);
    assert_int_equal(ncr_blend_weights(NCR_BASIS_COSINE_R, INFINITY, 4, behind, 15, n, r, w),
                     NCR_BLEND_COSINE_N4);

    /* behind r and below the surface: distances 1, 3 */
    const ncr_vec3 below[4] = {{-1, 0, 0}, {0, 0, 1}, {0, 0, -3}, {0, 0, 1}};
    assert_int_equal(ncr_blend_weights(NCR_BASIS_COSINE_R, 1, 4, below, 5, n, r, w),
                     NCR_BLEND_INVERSE);
    CHECK_NEAR(w[0], 0.75, 1e-7);
    CHECK_NEAR(w[2], 0.25, 1e-7);

    /* nothing known about the distance either */
    const ncr_vec3 lost[4] = {{0, 0, 1}, {NAN, 0, 0}, {-INFINITY, 0, 0}, {0, 0, 1}};
    assert_int_equal(ncr_blend_weights(NCR_BASIS_COSINE_R, 1, 4, lost, 6, n, r, w),
                     NCR_BLEND_NEAREST);
    const float second[4] = {0, 1, 0, 0};
    assert_memory_equal(w, second, sizeof w);

    assert_int_equal(ncr_blend_weights(NCR_BASIS_COSINE_N, 1, 4, below, 0, n, r, w),
                     NCR_BLEND_NONE);
}

static void a_point_at_the_surface_lies_along_the_normal(void **state)
{
    (void)state;
    const ncr_vec3 n = {0, 0, 1}, r = {0, 0.6f, 0.8f};
    const ncr_vec3 p[2] = {{0, 0, 0}, {0, 0, 0.5f}};
    float w[2];
    ncr_blend_weights(NCR_BASIS_COSINE_N, 8, 2, p, 3, n, r, w);
    assert_true(w[0] == 0.5f && w[1] == 0.5f);
    ncr_blend_weights(NCR_BASIS_COSINE_R, 8, 2, p, 3, n, r, w);
    assert_true(w[0] == 0.5f && w[1] == 0.5f);
}

static void lengths_do_not_matter_to_cosines(void **state)
{
    (void)state;
    check_random random = {.seed = 44};
    for (int trial = 0; trial < 20000; trial++) {
        const ncr_vec3 n = random_unit(&random), r = random_unit(&random);
        const ncr_basis basis = (ncr_basis)(1 + trial % 5);
        ncr_vec3 p[4], q[4];
        float w[4], x[4];
        const int e = (int)check_uniform(&random, -100, 100);
        for (int j = 0; j < 4; j++) {
            p[j] = random_unit(&random);
            q[j] = v_make(ldexpf(p[j].x, e), ldexpf(p[j].y, e), ldexpf(p[j].z, e));
        }
        const unsigned a = ncr_blend_weights(basis, 4, 4, p, 15, n, r, w);
        const unsigned b = ncr_blend_weights(basis, 4, 4, q, 15, n, r, x);
        assert_int_equal(a, b);
        assert_memory_equal(w, x, sizeof w);
    }
}

static void order_does_not_matter(void **state)
{
    (void)state;
    check_random random = {.seed = 45};
    for (int trial = 0; trial < 20000; trial++) {
        const ncr_vec3 n = random_unit(&random), r = random_unit(&random);
        const ncr_basis basis = (ncr_basis)(1 + trial % 5);
        ncr_vec3 p[4], q[4];
        float w[4], x[4];
        for (int j = 0; j < 4; j++)
            q[3 - j] = p[j] = random_unit(&random);
        ncr_blend_weights(basis, 4, 4, p, 15, n, r, w);
        ncr_blend_weights(basis, 4, 4, q, 15, n, r, x);
        for (int j = 0; j < 4; j++)
            CHECK_NEAR(w[j], x[3 - j], 2 * 0x1p-23);
    }
}

/* A row of pixels among a few points, some of them missing, some very close or far away. */
enum { few = 40 };
typedef struct row_case {
    _Alignas(64) float position[few + 1][4];
    float x[3][NCR_BLEND_ROW], axis[3][NCR_BLEND_ROW], w[4][NCR_BLEND_ROW];
    uint16_t point[4][NCR_BLEND_ROW];
} row_case;

static void random_row(check_random *random, row_case *c)
{
    for (int p = 0; p < few; p++)
        for (int k = 0; k < 3; k++)
            c->position[p][k] = (float)check_uniform(random, -1, 1) * (p % 10 == 9 ? 1e-16f : 1);
    for (int k = 0; k < NCR_BLEND_ROW; k++) {
        const ncr_vec3 axis = random_unit(random);
        c->axis[0][k] = axis.x, c->axis[1][k] = axis.y, c->axis[2][k] = axis.z;
        for (int i = 0; i < 3; i++)
            c->x[i][k] = k % 8 ? (float)check_uniform(random, -1, 1) : 0;
        for (int j = 0; j < 4; j++) {
            const double p = check_uniform(random, 0, few * 1.2);
            c->point[j][k] = p < few ? (uint16_t)p : NCR_NO_POINT;
            if (j && k % 5 == 1) /* ties */
                c->point[j][k] = c->point[0][k];
        }
    }
}

/* Compares one pixel of a row with the definition; returns whether it was left to it. */
static bool check_pixel(const row_case *c, int k, unsigned exponent, bool absolute, bool odd)
{
    const ncr_vec3 axis = v_make(c->axis[0][k], c->axis[1][k], c->axis[2][k]);
    const ncr_vec3 x = v_make(c->x[0][k], c->x[1][k], c->x[2][k]);
    ncr_vec3 to_point[4];
    unsigned valid = 0;
    for (unsigned j = 0; j < 4; j++) {
        const float *p = c->position[c->point[j][k] == NCR_NO_POINT ? 0 : c->point[j][k]];
        to_point[j] = v_sub(v_make(p[0], p[1], p[2]), x);
        valid |= (unsigned)(c->point[j][k] != NCR_NO_POINT) << j;
    }
    float want[4];
    const unsigned fallback =
        ncr_blend_weights(absolute ? NCR_BASIS_ABS_R : NCR_BASIS_COSINE_R, (float)exponent, 4,
                          to_point, valid, axis, axis, want);
    CHECK(odd || !fallback, "exponent %u pixel %d: fallback %u was not left to the definition",
          exponent, k, fallback);
    for (int j = 0; j < 4 && !odd; j++)
        CHECK(c->w[j][k] == want[j], "exponent %u pixel %d: weight %d is %.9g, want %.9g", exponent,
              k, j, c->w[j][k], want[j]);
    return odd;
}

static void rows_of_weights_are_the_definition(void **state)
{
    (void)state;
    static ncr_blend_rows_fn *const by_level[] = {NULL, ncr_blend_rows_avx2, ncr_blend_rows_avx512};
    static row_case c;
    check_random random = {.seed = 113};
    int odd_ones = 0, pixels = 0;
    if (ncr_cpu_level() == NCR_CPU_GENERIC)
        skip(); /* the definition has no rows to be compared with */
    for (int trial = 0; trial < 3000; trial++) {
        random_row(&random, &c);
        const unsigned exponent = (const unsigned[]){0, 1, 2, 4, 8, 16, 61, 1024}[trial % 8];
        const ncr_blend_rows rows = {.x = {c.x[0], c.x[1], c.x[2]},
                                     .axis = {c.axis[0], c.axis[1], c.axis[2]},
                                     .point = {c.point[0], c.point[1], c.point[2], c.point[3]},
                                     .points = few,
                                     .position = (const float(*)[4])c.position,
                                     .w = {c.w[0], c.w[1], c.w[2], c.w[3]}};
        for (int level = 1; level <= (int)ncr_cpu_level(); level++) {
            const uint64_t odd = by_level[level](&rows, exponent, trial & 8);
            for (int k = 0; k < NCR_BLEND_ROW; k++)
                odd_ones += check_pixel(&c, k, exponent, trial & 8, odd >> k & 1);
            pixels += NCR_BLEND_ROW;
        }
    }
    assert_true(odd_ones * 3 < pixels); /* the rule, not the exception, goes in rows */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_are_a_partition_of_unity),
        cmocka_unit_test(cosine_bases_match_the_formula),
        cmocka_unit_test(the_printed_formula_is_the_absolute_variant),
        cmocka_unit_test(points_behind_the_axis_have_no_weight),
        cmocka_unit_test(exponent_zero_is_the_average),
        cmocka_unit_test(a_huge_exponent_takes_the_largest),
        cmocka_unit_test(a_point_on_the_ray_takes_all_for_angle),
        cmocka_unit_test(fallbacks_come_in_order_and_are_told),
        cmocka_unit_test(a_point_at_the_surface_lies_along_the_normal),
        cmocka_unit_test(lengths_do_not_matter_to_cosines),
        cmocka_unit_test(order_does_not_matter),
        cmocka_unit_test(rows_of_weights_are_the_definition),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
