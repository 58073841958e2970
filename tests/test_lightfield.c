/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/cpu_internal.h"
#include "core/vec_internal.h"
#include "sampling/sample_map.h"
#include "shading/cube.h"
#include "shading/lightfield_internal.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

typedef void texel_fn(const void *user, uint32_t face, double s, double t, float rgb[3], float *z);

/* Fill one point of a field, texel centres from a function, in tiles of odd sizes. */
static void fill_point(ncr_lightfield *field, uint32_t point, texel_fn *fn, const void *user)
{
    const ncr_tile_sink sink = ncr_lightfield_sink(field);
    const uint32_t n = ncr_lightfield_resolution(field), side = n < 13 ? n : 13;
    float rgb[13 * 13 * 3], z[13 * 13];
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t y = 0; y < n; y += side)
            for (uint32_t x = 0; x < n; x += side) {
                ncr_tile tile = {.point = point, .face = face, .x = x, .y = y, .rgb = rgb, .z = z};
                tile.width = n - x < side ? n - x : side;
                tile.height = n - y < side ? n - y : side;
                for (uint32_t j = 0; j < tile.height; j++)
                    for (uint32_t i = 0; i < tile.width; i++)
                        fn(user, face, (2.0 * (x + i) + 1) / n - 1, (2.0 * (y + j) + 1) / n - 1,
                           rgb + 3 * (j * tile.width + i), z + j * tile.width + i);
                CHECK_STATUS(NCR_OK, sink.write(sink.user, &tile));
            }
}

static ncr_lightfield *make_field(uint32_t points, uint32_t n, ncr_texel_format format,
                                  int exponent, texel_fn *fn, const void *user)
{
    ncr_lightfield *field;
    CHECK_STATUS(NCR_OK, ncr_lightfield_create(NULL, points, n,
                                               NCR_OPTS(ncr_lightfield_opts, .format = format,
                                                        .depth = true, .exponent = exponent),
                                               &field));
    for (uint32_t point = 0; point < points; point++)
        fill_point(field, point, fn, user);
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, field));
    return field;
}

static void constant_texel(const void *user, uint32_t face, double s, double t, float rgb[3],
                           float *z)
{
    (void)face, (void)s, (void)t;
    memcpy(rgb, user, 3 * sizeof(float));
    *z = INFINITY;
}

static ncr_vec3 random_direction(check_random *random)
{
    for (;;) {
        const double x = check_uniform(random, -1, 1), y = check_uniform(random, -1, 1),
                     z = check_uniform(random, -1, 1), q = x * x + y * y + z * z;
        if (q > 1e-4 && q <= 1)
            return v_make((float)x, (float)y, (float)z);
    }
}

static void constant_light_is_returned_exactly(void **state)
{
    (void)state;
    const float rgb[3] = {0.75f, 3.0f, 0.0f};
    const uint32_t sizes[] = {1, 2, 5, 32};
    check_random random = {.seed = 29};
    for (int format = 0; format < 2; format++)
        for (size_t k = 0; k < 4; k++) {
            ncr_lightfield *field =
                make_field(2, sizes[k], (ncr_texel_format)format, 0, constant_texel, rgb);
            for (int trial = 0; trial < 20000; trial++) {
                const ncr_vec3 d = random_direction(&random);
                const ncr_vec3 got = ncr_lightfield_fetch(field, 1, d);
                CHECK(got.x == rgb[0] && got.y == rgb[1] && got.z == rgb[2],
                      "n %u: (%.9g,%.9g,%.9g)", sizes[k], got.x, got.y, got.z);
                assert_true(isinf(ncr_lightfield_distance(field, 0, d)));
            }
            ncr_lightfield_destroy(NULL, field);
        }
}

static void face_linear(const void *user, uint32_t face, double s, double t, float rgb[3], float *z)
{
    (void)user;
    rgb[0] = (float)(2 + s);
    rgb[1] = (float)(2 + t);
    rgb[2] = (float)(3 + 0.5 * s - 0.25 * t + face);
    *z = (float)(s + 2);
}

static void a_linear_function_is_exact_inside_a_face(void **state)
{
    (void)state;
    const uint32_t n = 24;
    ncr_lightfield *field = make_field(1, n, NCR_TEXEL_FLOAT, 0, face_linear, NULL);
    check_random random = {.seed = 3};
    const double inside = 1 - 1.0 / n;
    for (int trial = 0; trial < 50000; trial++) {
        const uint32_t face = (uint32_t)trial % 6;
        const double s = check_uniform(&random, -inside, inside);
        const double t = check_uniform(&random, -inside, inside);
        const float length = (float)exp(check_uniform(&random, -20, 20));
        const ncr_vec3 d = v_scale(ncr_cube_to_direction(face, (float)s, (float)t), length);
        const ncr_vec3 got = ncr_lightfield_fetch(field, 0, d);
        const double tol = 8.0 * FLT_EPSILON * n; /* s is rounded, then scaled by n/2 */
        CHECK_NEAR(got.x, 2 + s, tol);
        CHECK_NEAR(got.y, 2 + t, tol);
        CHECK_NEAR(got.z, 3 + 0.5 * s - 0.25 * t + face, tol);

        const double centre = floor((s + 1) * n / 2) + 0.5; /* distances are those of one texel */
        if (fabs((s + 1) * n / 2 - centre) < 0.499)
            CHECK_NEAR(ncr_lightfield_distance(field, 0, d), 2 * centre / n + 1, 1e-6);
    }
    ncr_lightfield_destroy(NULL, field);
}

/* Noise: neighbouring texels differ by anything up to 1. */
static void noise_texel(const void *user, uint32_t face, double s, double t, float rgb[3], float *z)
{
    const uint64_t seed = *(const uint64_t *)user;
    for (uint64_t c = 0; c < 3; c++)
        rgb[c] = (float)ncr_uniform((uint64_t)(4096 * (s + 1)) * 8192 + (uint64_t)(4096 * (t + 1)) +
                                        (face * 3 + c) * 99991,
                                    seed);
    *z = rgb[0];
}

/* |L(a) - L(b)| <= n |a - b| x (difference of neighbouring texels <= 1) x 3: a step of h moves at
 * most (n/2) 3 h texels across a face on which |d| <= sqrt 3, in two directions. */
static void check_step(const ncr_lightfield *field, ncr_vec3 a, ncr_vec3 b)
{
    const double step = v_length(v_sub(v_unit(a), v_unit(b))) + 2 * FLT_EPSILON;
    const double bound = 3 * ncr_lightfield_resolution(field) * step;
    const ncr_vec3 la = ncr_lightfield_fetch(field, 0, a), lb = ncr_lightfield_fetch(field, 0, b);
    const ncr_vec3 jump = v_sub(la, lb);
    CHECK(v_length(jump) <= 2 * bound, "a step of %g jumps by %g at (%g,%g,%g)", step,
          v_length(jump), a.x, a.y, a.z);
}

static void light_is_continuous_across_edges_and_corners(void **state)
{
    (void)state;
    const uint64_t seed = 12;
    const uint32_t sizes[] = {1, 2, 3, 16};
    check_random random = {.seed = 30};
    for (size_t k = 0; k < 4; k++) {
        ncr_lightfield *field = make_field(1, sizes[k], NCR_TEXEL_FLOAT, 0, noise_texel, &seed);
        for (int trial = 0; trial < 60000; trial++) {
            /* a point on an edge or at a corner, pushed a little in two random directions */
            float p[3] = {1, 1, (float)check_uniform(&random, -1, 1)};
            if (trial % 3 == 0)
                p[2] = 1;
            for (int c = 0; c < 3; c++)
                p[c] *= check_uniform(&random, 0, 1) < 0.5 ? -1.0f : 1.0f;
            const int turn = trial % 5 % 3;
            const ncr_vec3 on = v_make(p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]);
            const float h = (float)pow(10, check_uniform(&random, -6, -2));
            check_step(field, v_mad(on, h, random_direction(&random)),
                       v_mad(on, h, random_direction(&random)));
        }
        ncr_lightfield_destroy(NULL, field);
    }
}

/* A smooth function of direction, to see that aprons come from the right texels. */
static void smooth_texel(const void *user, uint32_t face, double s, double t, float rgb[3],
                         float *z)
{
    (void)user;
    double d[3];
    ncr_cube_to_direction_d(face, s, t, d);
    assert_true(d_normalize(d));
    for (int c = 0; c < 3; c++)
        rgb[c] = (float)(1 + 0.5 * d[c] + 0.3 * d[(c + 1) % 3] * d[(c + 2) % 3]);
    *z = 1;
}

static double worst_smooth_error(uint32_t n)
{
    ncr_lightfield *field = make_field(1, n, NCR_TEXEL_FLOAT, 0, smooth_texel, NULL);
    check_random random = {.seed = 31};
    double worst = 0;
    for (int trial = 0; trial < 100000; trial++) {
        const ncr_vec3 d = random_direction(&random);
        const ncr_cube_coord at = ncr_cube_from_direction(d);
        float want[3], z;
        smooth_texel(NULL, at.face, at.s, at.t, want, &z);
        const ncr_vec3 got = ncr_lightfield_fetch(field, 0, d);
        worst = fmax(worst, fabs(got.x - want[0]));
        worst = fmax(worst, fabs(got.y - want[1]));
        worst = fmax(worst, fabs(got.z - want[2]));
    }
    ncr_lightfield_destroy(NULL, field);
    return worst;
}

static void smooth_light_is_followed_over_the_edges(void **state)
{
    (void)state;
    /* At an edge the apron's texel is half a texel's kink away from where bilinear puts it, so the
     * bound is a fraction of a texel's step, falling as 1/n. */
    CHECK_NEAR(worst_smooth_error(16), 0, 0.03);
    CHECK_NEAR(worst_smooth_error(64), 0, 0.0075);
}

static void too_bright_for_half_is_clamped_and_counted(void **state)
{
    (void)state;
    const float sun[3] = {1e5f, 65504.0f, 6e4f};
    ncr_lightfield *field = make_field(1, 4, NCR_TEXEL_HALF, 0, constant_texel, sun);
    assert_int_equal(ncr_lightfield_overflows(field), 6 * 4 * 4);
    assert_true(ncr_lightfield_fetch(field, 0, v_make(1, 2, 3)).x == 65504.0f);
    assert_true(ncr_lightfield_fetch(field, 0, v_make(1, 2, 3)).y == 65504.0f);
    ncr_lightfield_destroy(NULL, field);

    /* what would round to infinity is clamped and told, the largest and the least are kept */
    const float edge[3] = {65504.0f, 65520.0f, 0x1p-24f};
    field = make_field(1, 4, NCR_TEXEL_HALF, 0, constant_texel, edge);
    assert_int_equal(ncr_lightfield_overflows(field), 6 * 4 * 4);
    assert_true(ncr_lightfield_fetch(field, 0, v_make(1, 2, 3)).y == 65504.0f);
    assert_true(ncr_lightfield_fetch(field, 0, v_make(1, 2, 3)).z == 0x1p-24f);
    ncr_lightfield_destroy(NULL, field);

    /* divided by a power of two it fits, and comes back in radiance units */
    field = make_field(1, 4, NCR_TEXEL_HALF, 4, constant_texel, sun);
    assert_int_equal(ncr_lightfield_overflows(field), 0);
    CHECK_NEAR(ncr_lightfield_fetch(field, 0, v_make(1, 2, 3)).x, 1e5, 1e5 * 0x1p-11);
    float rgb[3], z;
    ncr_lightfield_texel(field, 0, 5, 3, 3, rgb, &z);
    CHECK_NEAR(rgb[2], 6e4, 6e4 * 0x1p-11);
    assert_true(isinf(z));
    ncr_lightfield_destroy(NULL, field);
}

static void rows_of_lookups_are_single_lookups(void **state)
{
    (void)state;
    enum { count = 1003 };
    const uint64_t seed = 77;
    check_random random = {.seed = 78};
    for (int format = 0; format < 2; format++) {
        ncr_lightfield *field = make_field(7, 9, (ncr_texel_format)format, 2, noise_texel, &seed);
        float d[3][count], w[count], out[3][count], want[3][count];
        uint16_t point[count];
        for (int k = 0; k < count; k++) {
            const ncr_vec3 v = random_direction(&random);
            d[0][k] = v.x, d[1][k] = v.y, d[2][k] = v.z;
            w[k] = (float)check_uniform(&random, 0, 1);
            point[k] = (uint16_t)check_uniform(&random, 0, 8);
            if (point[k] == 7)
                point[k] = NCR_NO_POINT;
            for (int c = 0; c < 3; c++)
                out[c][k] = want[c][k] = (float)c;
            if (point[k] != NCR_NO_POINT) {
                const ncr_vec3 l = ncr_lightfield_fetch(field, point[k], v);
                want[0][k] += w[k] * l.x, want[1][k] += w[k] * l.y, want[2][k] += w[k] * l.z;
            }
        }
        const size_t trapped = ncr_lightfield_accumulate(
            field, count, point, (const float *const[3]){d[0], d[1], d[2]}, w,
            (float *const[3]){out[0], out[1], out[2]});
        assert_int_equal(trapped, 0);
        assert_memory_equal(out, want, sizeof out);
        ncr_lightfield_destroy(NULL, field);
    }
}

/* Random look-ups, some of missing points, some without weight, among the awkward directions. */
enum { rows = 1003, blended = 5 };
typedef struct lookup_case {
    float d[3][rows], w[blended][rows];
    uint16_t point[blended][rows];
} lookup_case;

static void random_case(check_random *random, uint32_t points, lookup_case *c)
{
    for (int k = 0; k < rows; k++) {
        ncr_vec3 v = v_scale(random_direction(random), (float)exp(check_uniform(random, -9, 9)));
        if (k % 5 == 0) /* on an edge or at a corner */
            v.y = v.x, v.z = k % 10 ? v.z : -v.x;
        if (k % 7 == 0)
            v = v_make(0, k % 2 ? -1.0f : 2.0f, 0);
        c->d[0][k] = v.x, c->d[1][k] = v.y, c->d[2][k] = v.z;
        for (int j = 0; j < blended; j++) {
            const double kind = check_uniform(random, 0, 10);
            c->w[j][k] = kind < 2 ? 0 : (float)check_uniform(random, 0, 1);
            c->point[j][k] = kind > 8 ? NCR_NO_POINT : (uint16_t)check_uniform(random, 0, points);
        }
    }
}

static size_t run_accumulate(ncr_accumulate_fn *fn, const ncr_lightfield *field, size_t count,
                             const lookup_case *c, float out[3][rows])
{
    for (int k = 0; k < 3 * rows; k++)
        out[k / rows][k % rows] = (float)k;
    return fn(field, count, c->point[0], (const float *const[3]){c->d[0], c->d[1], c->d[2]},
              c->w[0], (float *const[3]){out[0], out[1], out[2]});
}

static size_t run_blend(ncr_blend_fn *fn, const ncr_lightfield *field, size_t count,
                        unsigned points, const lookup_case *c, float out[3][rows])
{
    const uint16_t *point[blended];
    const float *w[blended];
    for (int j = 0; j < blended; j++) {
        point[j] = c->point[j];
        w[j] = c->w[j];
    }
    memset(out, 0, 3 * rows * sizeof(float));
    return fn(field, count, points, point, w, (const float *const[3]){c->d[0], c->d[1], c->d[2]},
              (float *const[3]){out[0], out[1], out[2]});
}

static void every_processor_gives_the_same_bits(void **state)
{
    (void)state;
    static ncr_accumulate_fn *const accumulate[] = {ncr_lightfield_accumulate_c,
                                                    ncr_lightfield_accumulate_avx2,
                                                    ncr_lightfield_accumulate_avx512};
    static ncr_blend_fn *const blend[] = {ncr_lightfield_blend_c, ncr_lightfield_blend_avx2,
                                          ncr_lightfield_blend_avx512};
    static lookup_case c;
    static float want[3][rows], got[3][rows];
    const uint64_t seed = 113;
    check_random random = {.seed = 114};
    for (int trial = 0; trial < 24; trial++) {
        const uint32_t n = (const uint32_t[]){1, 2, 7, 40}[trial % 4];
        ncr_lightfield *field =
            make_field(5, n, (ncr_texel_format)(trial & 1), trial % 3, noise_texel, &seed);
        if (trial % 3 == 0) { /* one point that was never captured */
            ncr_lightfield_destroy(NULL, field);
            CHECK_STATUS(NCR_OK, ncr_lightfield_create(NULL, 5, n, NULL, &field));
            for (uint32_t point = 1; point < 5; point++)
                fill_point(field, point, noise_texel, &seed);
            CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, field));
        }
        random_case(&random, 5, &c);
        const size_t count = trial < 8 ? (size_t)trial : rows - (size_t)trial;
        for (int level = 1; level <= (int)ncr_cpu_level(); level++) {
            size_t a = run_accumulate(accumulate[0], field, count, &c, want);
            size_t b = run_accumulate(accumulate[level], field, count, &c, got);
            CHECK(a == b, "level %d: %zu trapped, %zu by the definition", level, b, a);
            assert_memory_equal(got, want, sizeof want);
            for (unsigned points = 1; points <= blended; points++) {
                a = run_blend(blend[0], field, count, points, &c, want);
                b = run_blend(blend[level], field, count, points, &c, got);
                CHECK(a == b, "level %d: %zu trapped, %zu by the definition", level, b, a);
                assert_memory_equal(got, want, sizeof want);
            }
        }
        ncr_lightfield_destroy(NULL, field);
    }
}

static void a_blend_is_the_weighted_sum_of_lookups(void **state)
{
    (void)state;
    static lookup_case c;
    static float got[3][rows];
    const uint64_t seed = 115;
    check_random random = {.seed = 116};
    ncr_lightfield *field = make_field(5, 11, NCR_TEXEL_HALF, 0, noise_texel, &seed);
    random_case(&random, 5, &c);
    run_blend(ncr_lightfield_blend, field, rows, 4, &c, got);
    for (int k = 0; k < rows; k++) {
        double want = 0;
        for (int j = 0; j < 4; j++)
            if (c.point[j][k] != NCR_NO_POINT)
                want += (double)c.w[j][k] *
                        ncr_lightfield_fetch(field, c.point[j][k],
                                             v_make(c.d[0][k], c.d[1][k], c.d[2][k]))
                            .x;
        CHECK_NEAR(got[0][k], want, 1e-6);
    }
    ncr_lightfield_destroy(NULL, field);
}

static void texels_never_captured_are_trapped(void **state)
{
    (void)state;
    ncr_lightfield *field;
    CHECK_STATUS(NCR_OK, ncr_lightfield_create(NULL, 2, 8, NULL, &field));
    const float white[3] = {1, 1, 1};
    fill_point(field, 1, constant_texel, white);
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, field));

    const uint16_t point[3] = {0, 1, NCR_NO_POINT};
    const float x[3] = {1, 1, 1}, w[3] = {1, 1, 1};
    float out[3] = {0, 0, 0};
    const size_t trapped = ncr_lightfield_accumulate(
        field, 3, point, (const float *const[3]){x, x, x}, w, (float *const[3]){out, out, out});
    assert_int_equal(trapped, 1);
    ncr_lightfield_destroy(NULL, field);
}

static void bad_calls_are_refused(void **state)
{
    (void)state;
    ncr_lightfield *field;
    CHECK_STATUS(NCR_E_ARG, ncr_lightfield_create(NULL, 0, 8, NULL, &field));
    CHECK_STATUS(NCR_E_ARG, ncr_lightfield_create(NULL, 1, 0, NULL, &field));
    CHECK_STATUS(NCR_E_ARG, ncr_lightfield_create(NULL, 1, 4097, NULL, &field));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_lightfield_create(NULL, 1, 8, &(ncr_lightfield_opts){.depth = true}, &field));
    assert_null(field);

    CHECK_STATUS(NCR_OK, ncr_lightfield_create(NULL, 1, 8, NULL, &field));
    const ncr_tile_sink sink = ncr_lightfield_sink(field);
    float rgb[3 * 64] = {0};
    const ncr_tile beyond[] = {{.point = 1, .width = 1, .height = 1, .rgb = rgb},
                               {.face = 6, .width = 1, .height = 1, .rgb = rgb},
                               {.x = 4, .width = 5, .height = 1, .rgb = rgb},
                               {.y = 8, .width = 1, .height = 1, .rgb = rgb},
                               {.width = 1, .height = UINT32_MAX, .rgb = rgb}};
    for (size_t k = 0; k < sizeof beyond / sizeof *beyond; k++)
        CHECK_STATUS(NCR_E_ARG, sink.write(sink.user, &beyond[k]));
    ncr_lightfield_destroy(NULL, field);
    ncr_lightfield_destroy(NULL, NULL);
}

typedef struct failing {
    int until, held;
} failing;

static void *failing_alloc(void *user, size_t size, size_t align)
{
    failing *f = user;
    if (f->until-- == 0)
        return NULL;
    f->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void failing_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((failing *)user)->held--;
    free(ptr);
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    failing f = {0, 0};
    ncr_ctx ctx = {.struct_size = sizeof ctx,
                   .user = &f,
                   .alloc = failing_alloc,
                   .release = failing_release,
                   .workers = 1};
    int failures = 0;
    for (int nth = 0;; nth++) {
        ncr_lightfield *field = NULL;
        f.until = nth;
        ncr_status status =
            ncr_lightfield_create(&ctx, 2, 4, NCR_OPTS(ncr_lightfield_opts, .depth = true), &field);
        if (status == NCR_OK)
            status = ncr_lightfield_seal(&ctx, field);
        if (field)
            ncr_lightfield_destroy(&ctx, field);
        assert_int_equal(f.held, 0);
        if (status == NCR_OK)
            break;
        CHECK_STATUS(NCR_E_NOMEM, status);
        failures++;
    }
    assert_int_equal(failures, 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_light_is_returned_exactly),
        cmocka_unit_test(a_linear_function_is_exact_inside_a_face),
        cmocka_unit_test(light_is_continuous_across_edges_and_corners),
        cmocka_unit_test(smooth_light_is_followed_over_the_edges),
        cmocka_unit_test(too_bright_for_half_is_clamped_and_counted),
        cmocka_unit_test(rows_of_lookups_are_single_lookups),
        cmocka_unit_test(every_processor_gives_the_same_bits),
        cmocka_unit_test(a_blend_is_the_weighted_sum_of_lookups),
        cmocka_unit_test(texels_never_captured_are_trapped),
        cmocka_unit_test(bad_calls_are_refused),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
