/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "geometry/bezier_many_internal.h"
#include "io/patch_file.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* Every path that this processor has, against the definition, in both precisions. The paths see
 * the same numbers: float parameters are exact in double. */
enum { arrays = 21, most = 2048 };

/* Results of one call; entry 3 g + k is coordinate k of the groups p du dv duu duv dvv n. */
typedef struct results {
    float *f[arrays];
    double *d[arrays];
} results;

/* Exactly `count` entries, so that a sanitizer sees a write beyond. */
static void results_init(results *r, size_t count)
{
    for (int a = 0; a < arrays; a++) {
        r->f[a] = malloc(count ? count * sizeof(float) : 1);
        r->d[a] = malloc(count ? count * sizeof(double) : 1);
        assert_true(r->f[a] && r->d[a]);
    }
}

static void results_dispose(results *r)
{
    for (int a = 0; a < arrays; a++) {
        free(r->f[a]);
        free(r->d[a]);
    }
}

/* Groups in `want`: bit 0 p, bit 1 du dv, bit 2 duu duv dvv, bit 3 n. */
static bool wanted(int a, unsigned want)
{
    const unsigned bit = a < 3 ? 1 : a < 9 ? 2 : a < 18 ? 4 : 8;
    return want & bit;
}

static void run(ncr_cpu level, const ncr_surface *s, uint32_t patch, size_t count, const float *u,
                const float *v, unsigned want, const results *r)
{
    float *f[arrays];
    double *d[arrays];
    double *wide = malloc((2 * count + 1) * sizeof *wide);
    ncr_surface_arrays out;
    ncr_surface_arrays_d out_d;
    assert_non_null(wide);
    for (int a = 0; a < arrays; a++) {
        f[a] = wanted(a, want) ? r->f[a] : NULL;
        d[a] = wanted(a, want) ? r->d[a] : NULL;
    }
    for (size_t k = 0; k < count; k++) {
        wide[k] = (double)u[k];
        wide[count + k] = (double)v[k];
    }
    _Static_assert(sizeof out == sizeof f && sizeof out_d == sizeof d, "21 arrays");
    memcpy(&out, f, sizeof out);
    memcpy(&out_d, d, sizeof out_d);
    ncr_surface_eval_many_at(level, s, patch, count, u, v, &out);
    ncr_surface_eval_many_d_at(level, s, patch, count, wide, wide + count, &out_d);
    free(wide);
}

static void define(const ncr_surface *s, uint32_t patch, float u, float v, double x[arrays])
{
    ncr_surface_point at;
    ncr_surface_eval(s, patch, (double)u, (double)v, &at);
    memcpy(x, &at, sizeof at);
    ncr_surface_normal(s, patch, (double)u, (double)v, x + 18);
}

/* Largest coordinate, and longest difference of neighbouring control points. */
static void measure(const ncr_surface *s, uint32_t patch, double *largest, double *extent)
{
    const double(*c)[3] = ncr_surface_patch_control(s, patch);
    *largest = *extent = 0;
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 3; k++) {
            *largest = fmax(*largest, fabs(c[i][k]));
            *extent = fmax(*extent, fabs(c[i][k] - c[0][k]));
        }
}

/* Errors in ulp of: the largest control point (p), 3 and 12 extents of the patch (derivatives),
 * radians (n). */
typedef struct errors {
    double p, first, second, n;
} errors;

static void grow(errors *e, int a, double difference, double largest, double extent)
{
    if (a < 3)
        e->p = fmax(e->p, difference / largest);
    else if (a < 9)
        e->first = fmax(e->first, difference / (3 * extent));
    else if (a < 18)
        e->second = fmax(e->second, difference / (12 * extent));
    else
        e->n = fmax(e->n, difference);
}

static void compare(const ncr_surface *s, uint32_t patch, size_t count, const float *u,
                    const float *v, const results *r, errors *f, errors *d)
{
    double largest, extent;
    measure(s, patch, &largest, &extent);
    for (size_t k = 0; k < count; k++) {
        double x[arrays];
        define(s, patch, u[k], v[k], x);
        for (int a = 0; a < arrays; a++) {
            assert_true(isfinite(r->f[a][k]) && isfinite(r->d[a][k]));
            grow(f, a, fabs((double)r->f[a][k] - x[a]), FLT_EPSILON * largest,
                 FLT_EPSILON * extent);
            grow(d, a, fabs(r->d[a][k] - x[a]), DBL_EPSILON * largest, DBL_EPSILON * extent);
        }
    }
}

/* Corners, borders, the smallest steps inside them, and the middle. */
static size_t extreme_parameters(float *u, float *v)
{
    static const float edge[] = {0,     FLT_TRUE_MIN, FLT_MIN, 1e-30f,       0x1p-24f,
                                 1e-3f, 0.5f,         0.999f,  1 - 0x1p-24f, 1};
    enum { n = sizeof edge / sizeof edge[0] };
    for (size_t k = 0; k < n * n; k++) {
        u[k] = edge[k % n];
        v[k] = edge[k / n];
    }
    return n * n;
}

static void check_errors(const char *what, ncr_cpu level, const errors *f, const errors *d)
{
    print_message(
        "%s, level %d: float %.2f %.2f %.2f ulp %.1e rad, double %.2f %.2f %.2f ulp %.1e\n", what,
        (int)level, f->p, f->first, f->second, f->n, d->p, d->first, d->second, d->n);
    CHECK(f->p <= 4 && f->first <= 4 && f->second <= 4, "float errors above 4 ulp");
    CHECK(d->p <= 4 && d->first <= 4 && d->second <= 4, "double errors above 4 ulp");
    CHECK(f->n <= 2e-5 && d->n <= 1e-12, "normals turned");
}

static void check_surface(const char *what, const ncr_surface *s)
{
    check_random random = {.seed = 51};
    static float u[most], v[most];
    results r;
    results_init(&r, most);
    for (int level = 0; level <= (int)ncr_cpu_level(); level++) {
        errors f = {0}, d = {0};
        for (uint32_t p = 0; p < ncr_surface_patch_count(s); p++)
            for (int round = 0; round < 2; round++) {
                size_t count = extreme_parameters(u, v);
                for (; round && count < most; count++) {
                    u[count] = (float)check_uniform(&random, 0, 1);
                    v[count] = (float)check_uniform(&random, 0, 1);
                }
                run((ncr_cpu)level, s, p, count, u, v, 15, &r);
                compare(s, p, count, u, v, &r, &f, &d);
            }
        check_errors(what, (ncr_cpu)level, &f, &d);
    }
    results_dispose(&r);
}

static ncr_surface *teapot(void)
{
    ncr_patch_set set;
    ncr_surface *surface = NULL;
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(NULL, "data/teapot.patches", &set));
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(
                             NULL, set.count, (const double(*)[16][3])set.control, NULL, &surface));
    ncr_patch_set_dispose(NULL, &set);
    return surface;
}

static ncr_surface *random_surface(double size, double away, bool inward)
{
    static double c[6][16][3];
    check_random r = {.seed = 52};
    ncr_surface *s = NULL;
    for (int i = 0; i < 6 * 48; i++)
        c[i / 48][i / 3 % 16][i % 3] = away + size * check_uniform(&r, -1, 1);
    CHECK_STATUS(NCR_OK,
                 ncr_surface_create_bezier(NULL, 6, (const double(*)[16][3])c,
                                           NCR_OPTS(ncr_surface_opts, .inward = inward), &s));
    return s;
}

static void teapot_agrees_on_every_path(void **state)
{
    ncr_surface *s = teapot();
    (void)state;
    check_surface("teapot", s);
    ncr_surface_destroy(NULL, s);
}

static void random_patches_agree_on_every_path(void **state)
{
    static const struct {
        double size, away;
        const char *what;
    } cases[] = {{1, 0, "random"},   {1e-3, 1e6, "far away"}, {1e-12, 0, "small"},
                 {1e12, 0, "large"}, {1e-25, 0, "tiny"},      {1e25, 0, "huge"}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        ncr_surface *s = random_surface(cases[k].size, cases[k].away, k % 2);
        check_surface(cases[k].what, s);
        ncr_surface_destroy(NULL, s);
    }
}

static void the_generic_path_is_the_definition(void **state)
{
    static float u[most], v[most];
    const size_t count = extreme_parameters(u, v);
    ncr_surface *s = teapot();
    results r;
    (void)state;
    results_init(&r, count);
    for (uint32_t p = 0; p < 32; p++) {
        run(NCR_CPU_GENERIC, s, p, count, u, v, 15, &r);
        for (size_t k = 0; k < count; k++) {
            double x[arrays];
            define(s, p, u[k], v[k], x);
            for (int a = 0; a < arrays; a++)
                assert_true(r.f[a][k] == (float)x[a] && r.d[a][k] == x[a]);
        }
    }
    results_dispose(&r);
    ncr_surface_destroy(NULL, s);
}

/* Whatever the count and the groups, an entry has the bits that it has in the full batch. */
static void every_count_and_every_group_gives_the_same_bits(void **state)
{
    enum { all = 48 };
    static float u[most], v[most];
    ncr_surface *s = teapot();
    results whole;
    (void)state;
    extreme_parameters(u, v);
    results_init(&whole, all);
    for (int level = 0; level <= (int)ncr_cpu_level(); level++) {
        run((ncr_cpu)level, s, 21, all, u, v, 15, &whole);
        for (size_t count = 0; count <= all; count++)
            for (unsigned want = 0; want < 16; want++) {
                results part;
                results_init(&part, count);
                run((ncr_cpu)level, s, 21, count, u, v, want, &part);
                for (int a = 0; a < arrays; a++)
                    if (wanted(a, want)) {
                        assert_memory_equal(part.f[a], whole.f[a], count * sizeof(float));
                        assert_memory_equal(part.d[a], whole.d[a], count * sizeof(double));
                    }
                results_dispose(&part);
            }
    }
    results_dispose(&whole);
    ncr_surface_destroy(NULL, s);
}

static void both_vector_paths_give_the_same_bits(void **state)
{
    static float u[most], v[most];
    const size_t count = extreme_parameters(u, v);
    ncr_surface *s = teapot();
    results narrow, wide;
    (void)state;
    if (ncr_cpu_level() < NCR_CPU_AVX512)
        skip();
    results_init(&narrow, count);
    results_init(&wide, count);
    for (uint32_t p = 0; p < 32; p++) {
        run(NCR_CPU_AVX2, s, p, count, u, v, 15, &narrow);
        run(NCR_CPU_AVX512, s, p, count, u, v, 15, &wide);
        for (int a = 0; a < arrays; a++) {
            assert_memory_equal(narrow.f[a], wide.f[a], count * sizeof(float));
            assert_memory_equal(narrow.d[a], wide.d[a], count * sizeof(double));
        }
    }
    results_dispose(&narrow);
    results_dispose(&wide);
    ncr_surface_destroy(NULL, s);
}

static void patches_without_normals_give_zeros(void **state)
{
    double c[1][16][3];
    static float u[most], v[most];
    const size_t count = extreme_parameters(u, v);
    ncr_surface *s;
    results r;
    (void)state;
    for (int i = 0; i < 48; i++)
        c[0][i / 3][i % 3] = 3.25;
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, 1, (const double(*)[16][3])c, NULL, &s));
    results_init(&r, count);
    for (int level = 0; level <= (int)ncr_cpu_level(); level++) {
        run((ncr_cpu)level, s, 0, count, u, v, 15, &r);
        for (size_t k = 0; k < count; k++)
            for (int a = 0; a < arrays; a++)
                CHECK_NEAR((double)r.f[a][k], a < 3 ? 3.25 : 0, 0);
    }
    results_dispose(&r);
    ncr_surface_destroy(NULL, s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(teapot_agrees_on_every_path),
        cmocka_unit_test(random_patches_agree_on_every_path),
        cmocka_unit_test(the_generic_path_is_the_definition),
        cmocka_unit_test(every_count_and_every_group_gives_the_same_bits),
        cmocka_unit_test(both_vector_paths_give_the_same_bits),
        cmocka_unit_test(patches_without_normals_give_zeros),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
