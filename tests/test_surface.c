/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "core/vec_internal.h"
#include "geometry/bezier_patch_internal.h"
#include "io/patch_file.h"

#include <stdlib.h>
#include <string.h>

static ncr_surface *read_surface(const char *path, size_t keep)
{
    ncr_patch_set set;
    ncr_surface *surface = NULL;
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(NULL, path, &set));
    const size_t count = keep ? keep : set.count;
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, count, (const double(*)[16][3])set.control,
                                                   NULL, &surface));
    ncr_patch_set_dispose(NULL, &set);
    return surface;
}

static double area(const ncr_surface *s, uint32_t begin, uint32_t end)
{
    double sum = 0;
    for (uint32_t p = begin; p < end; p++)
        sum += ncr_surface_patch_area(s, p, NULL);
    return sum;
}

static void teapot_areas_are_the_known_ones(void **state)
{
    static const struct {
        uint32_t begin, end;
        double area;
    } part[] = {
        {0, 4, 2.319829},   {4, 8, 18.077613},  {8, 12, 10.625932}, {12, 14, 1.635847},
        {14, 16, 1.668012}, {16, 18, 4.014289}, {18, 20, 0.294155}, {20, 24, 1.177456},
        {24, 28, 5.570929}, {28, 32, 7.499241},
    };
    ncr_surface *s = read_surface("data/teapot.patches", 0);
    (void)state;
    assert_int_equal(ncr_surface_patch_count(s), 32);
    for (size_t k = 0; k < sizeof part / sizeof part[0]; k++)
        CHECK_NEAR(area(s, part[k].begin, part[k].end), part[k].area, 6e-7);
    CHECK_NEAR(area(s, 0, 32), 52.883303083, 2e-8);
    ncr_surface_destroy(NULL, s);
}

static void teapot_fills_its_known_box(void **state)
{
    static const double want_min[3] = {-3, -2, 0}, want_max[3] = {3.434075, 2, 3.15};
    double lo[3] = {9, 9, 9}, hi[3] = {-9, -9, -9}, min[3], max[3];
    ncr_surface *s = read_surface("data/teapot.patches", 0);
    (void)state;
    ncr_surface_bounds(s, min, max);
    for (uint32_t p = 0; p < 32; p++)
        for (int n = 0; n < 129 * 129; n++) {
            ncr_surface_point at;
            ncr_surface_eval(s, p, n % 129 / 128.0, n / 129 / 128.0, &at);
            for (int k = 0; k < 3; k++) {
                lo[k] = fmin(lo[k], at.p[k]);
                hi[k] = fmax(hi[k], at.p[k]);
            }
        }
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(lo[k], want_min[k], 1e-5);
        CHECK_NEAR(hi[k], want_max[k] - 5e-6, 1e-5); /* a grid misses the top */
        assert_true(min[k] <= lo[k] + 1e-14 && max[k] >= hi[k] - 1e-14);
    }
    ncr_surface_destroy(NULL, s);
}

/* Parameter of a point of border e (u = 0, u = 1, v = 0, v = 1) of a patch. */
static void border_parameter(int e, double t, double uv[2])
{
    uv[0] = e < 2 ? e : t;
    uv[1] = e < 2 ? t : e - 2;
}

static void border_points(const double (*c)[3], int e, const double *out[4])
{
    for (int i = 0; i < 4; i++)
        out[i] = e < 2 ? c[4 * i + 3 * e] : c[12 * (e - 2) + i];
}

/* +1: the same control points in the same order, -1: in opposite order, 0: another border, or one
 * that is a point. */
static int same_border(const ncr_surface *s, uint32_t p, int e, uint32_t q, int f)
{
    const double *a[4], *b[4];
    border_points(ncr_surface_patch_control(s, p), e, a);
    border_points(ncr_surface_patch_control(s, q), f, b);
    bool forward = true, backward = true, point = true;
    for (int i = 0; i < 4; i++) {
        forward &= !memcmp(a[i], b[i], 3 * sizeof(double));
        backward &= !memcmp(a[i], b[3 - i], 3 * sizeof(double));
        point &= !memcmp(a[i], a[0], 3 * sizeof(double));
    }
    return point ? 0 : forward - backward;
}

/* Compare along a shared border: positions to the bit; returns the widest angle of normals. */
static double widest_crease(const ncr_surface *s, uint32_t p, int e, uint32_t q, int f, int order)
{
    double widest = 0;
    for (int n = 0; n <= 32; n++) {
        const double t = n / 32.0;
        double a[2], b[2], na[3], nb[3], chord[3];
        ncr_surface_point x, y;
        border_parameter(e, t, a);
        border_parameter(f, order > 0 ? t : 1 - t, b);
        ncr_surface_eval(s, p, a[0], a[1], &x);
        ncr_surface_eval(s, q, b[0], b[1], &y);
        for (int k = 0; k < 3; k++)
            assert_true(x.p[k] == y.p[k]);
        ncr_surface_normal(s, p, a[0], a[1], na);
        ncr_surface_normal(s, q, b[0], b[1], nb);
        d_sub(na, nb, chord);
        widest = fmax(widest, d_length(chord));
    }
    return widest;
}

static int shared_borders(const ncr_surface *s, double *widest)
{
    int shared = 0;
    const uint32_t count = ncr_surface_patch_count(s);
    *widest = 0;
    for (uint32_t p = 0; p < count; p++)
        for (uint32_t q = p + 1; q < count; q++)
            for (int n = 0; n < 16; n++) {
                const int order = same_border(s, p, n / 4, q, n % 4);
                if (!order)
                    continue;
                shared++;
                *widest = fmax(*widest, widest_crease(s, p, n / 4, q, n % 4, order));
            }
    return shared;
}

static void teapot_has_52_shared_borders_without_gap_or_crease(void **state)
{
    ncr_surface *s = read_surface("data/teapot.patches", 0);
    double widest;
    (void)state;
    assert_int_equal(shared_borders(s, &widest), 52);
    CHECK(widest < 4e-8, "crease of %g radian", widest); /* 1.7e-6 degree is 3e-8 */
    ncr_surface_destroy(NULL, s);
}

static double cup_volume(const ncr_surface *s)
{
    double sum = 0;
    for (uint32_t p = 0; p < ncr_surface_patch_count(s); p++)
        for (int n = 0; n < 64; n++) {
            ncr_surface_point at;
            double normal[3];
            if (p == 12 || p == 13)
                break; /* the handle, open where it enters the wall */
            ncr_surface_eval(s, p, ncr_gauss8_node[n % 8], ncr_gauss8_node[n / 8], &at);
            d_cross(at.du, at.dv, normal);
            sum += ncr_gauss8_weight[n % 8] * ncr_gauss8_weight[n / 8] * d_dot(at.p, normal) / 3;
        }
    return sum;
}

static void teacup_is_the_known_one_and_closed(void **state)
{
    static const double away[12] = {1, 0, 0, 100, 0, 1, 0, -50, 0, 0, 1, 30};
    ncr_surface *published = read_surface("data/teacup.patches", 26);
    ncr_surface *s = read_surface("data/teacup.patches", 0), *moved;
    double widest;
    (void)state;
    CHECK_NEAR(area(published, 0, 26), 4831.142005, 1e-3);
    assert_int_equal(shared_borders(published, &widest), 46);
    /* every border has its partner but the centres of two discs, points, and the handle's ends */
    assert_int_equal(shared_borders(s, &widest), (34 * 4 - 8 - 4) / 2);
    /* the volume of a closed, outward surface does not depend on where it stands */
    CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, s, away, &moved));
    CHECK(cup_volume(s) > 2000, "volume %g", cup_volume(s));
    CHECK_NEAR(cup_volume(moved), cup_volume(s), 1e-8 * cup_volume(s));
    ncr_surface_destroy(NULL, published);
    ncr_surface_destroy(NULL, s);
    ncr_surface_destroy(NULL, moved);
}

static void teaspoon_area_is_the_known_one(void **state)
{
    ncr_surface *s = read_surface("data/teaspoon.patches", 0);
    (void)state;
    assert_int_equal(ncr_surface_patch_count(s), 16);
    CHECK_NEAR(area(s, 0, 16), 0.342881444, 1e-8);
    ncr_surface_destroy(NULL, s);
}

static void random_patches(uint64_t seed, size_t count, double (*control)[16][3])
{
    check_random r = {.seed = seed};
    for (size_t i = 0; i < 48 * count; i++)
        control[i / 48][i / 3 % 16][i % 3] = check_uniform(&r, -1, 1);
}

static void affine_maps_and_evaluation_commute(void **state)
{
    double c[8][16][3], map[12];
    check_random r = {.seed = 21};
    (void)state;
    random_patches(22, 8, c);
    for (int i = 0; i < 12; i++)
        map[i] = check_uniform(&r, -1, 1);
    ncr_surface *s, *moved;
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, 8, (const double(*)[16][3])c, NULL, &s));
    CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, s, map, &moved));
    for (int n = 0; n < 800; n++) {
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        ncr_surface_point a, b;
        ncr_surface_eval(s, (uint32_t)(n % 8), u, v, &a);
        ncr_surface_eval(moved, (uint32_t)(n % 8), u, v, &b);
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(b.p[k], d_dot(map + 4 * k, a.p) + map[4 * k + 3], 1e-13);
            CHECK_NEAR(b.duv[k], d_dot(map + 4 * k, a.duv), 1e-13);
        }
    }
    ncr_surface_destroy(NULL, s);
    ncr_surface_destroy(NULL, moved);
}

static void scaling_by_a_power_of_two_is_exact(void **state)
{
    static const double map[12] = {0x1p-9, 0, 0, 0, 0, 0x1p-9, 0, 0, 0, 0, 0x1p-9, 0};
    double c[1][16][3];
    (void)state;
    random_patches(23, 1, c);
    ncr_surface *s, *small;
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, 1, (const double(*)[16][3])c, NULL, &s));
    CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, s, map, &small));
    for (int n = 0; n < 100; n++) {
        ncr_surface_point a, b;
        double na[3], nb[3];
        ncr_surface_eval(s, 0, n / 99.0, 0.7, &a);
        ncr_surface_eval(small, 0, n / 99.0, 0.7, &b);
        ncr_surface_normal(s, 0, n / 99.0, 0.7, na);
        ncr_surface_normal(small, 0, n / 99.0, 0.7, nb);
        for (int k = 0; k < 3; k++)
            assert_true(b.p[k] == 0x1p-9 * a.p[k] && b.dvv[k] == 0x1p-9 * a.dvv[k] &&
                        na[k] == nb[k]);
    }
    ncr_surface_destroy(NULL, s);
    ncr_surface_destroy(NULL, small);
}

static void mirrors_keep_normals_outward(void **state)
{
    static const double mirror[12] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    ncr_surface *s = read_surface("data/teapot.patches", 0), *m;
    (void)state;
    CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, s, mirror, &m));
    for (uint32_t p = 0; p < 32; p++) {
        double a[3], b[3];
        assert_int_equal(ncr_surface_normal(s, p, 0.3, 0.6, a),
                         ncr_surface_normal(m, p, 0.3, 0.6, b));
        CHECK_NEAR(a[0], -b[0], 0);
        CHECK_NEAR(a[1], b[1], 0);
        CHECK_NEAR(a[2], b[2], 0);
    }
    ncr_surface_destroy(NULL, s);
    ncr_surface_destroy(NULL, m);
}

static void bad_input_is_refused(void **state)
{
    double c[2][16][3];
    ncr_surface *s = NULL, *moved = (ncr_surface *)c;
    (void)state;
    random_patches(24, 2, c);
    const double(*good)[16][3] = (const double(*)[16][3])c;
    CHECK_STATUS(NCR_E_ARG, ncr_surface_create_bezier(NULL, 0, good, NULL, &s));
    CHECK_STATUS(NCR_E_ARG, ncr_surface_create_bezier(NULL, 1, NULL, NULL, &s));
    CHECK_STATUS(NCR_E_LIMIT, ncr_surface_create_bezier(NULL, UINT32_MAX, good, NULL, &s));
    const ncr_surface_opts forgotten = {0};
    CHECK_STATUS(NCR_E_ARG, ncr_surface_create_bezier(NULL, 1, good, &forgotten, &s));
    static const double bad[3] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        const double keep = c[1][7][2];
        c[1][7][2] = bad[i];
        CHECK_STATUS(NCR_E_ARG, ncr_surface_create_bezier(NULL, 2, good, NULL, &s));
        assert_null(s);
        c[1][7][2] = keep;
    }
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, 2, good, NULL, &s));
    double map[12] = {1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0}; /* z' = x + y */
    CHECK_STATUS(NCR_E_ARG, ncr_surface_create_transformed(NULL, s, map, &moved));
    assert_null(moved);
    map[10] = NAN;
    CHECK_STATUS(NCR_E_ARG, ncr_surface_create_transformed(NULL, s, map, &moved));
    map[10] = 1e308;
    map[8] = -1e308;
    CHECK_STATUS(NCR_E_ARG, ncr_surface_create_transformed(NULL, s, map, &moved));
    ncr_surface_destroy(NULL, s);
    ncr_surface_destroy(NULL, NULL);
}

static void empty_and_repeated_patches_keep_their_place(void **state)
{
    double c[4][16][3];
    bool flat[4];
    (void)state;
    random_patches(25, 1, c);
    memcpy(c[1], c[0], sizeof c[0]);
    for (int i = 0; i < 16; i++) {
        memcpy(c[2][i], c[0][0], sizeof c[0][0]); /* a point */
        for (int k = 0; k < 3; k++)
            c[3][i][k] = 0.1 * i * (k + 1); /* a line */
    }
    ncr_surface *s;
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, 4, (const double(*)[16][3])c, NULL, &s));
    double a[4];
    for (uint32_t p = 0; p < 4; p++)
        a[p] = ncr_surface_patch_area(s, p, &flat[p]);
    assert_true(!flat[0] && !flat[1] && flat[2] && flat[3]);
    assert_true(a[0] == a[1] && a[0] > 1 && a[2] == 0 && a[3] < 1e-12);
    ncr_surface_destroy(NULL, s);
}

typedef struct meter {
    int left; /* allocations that still succeed */
    int held;
} meter;

static void *metered_alloc(void *user, size_t size, size_t align)
{
    meter *m = user;
    if (m->left-- <= 0)
        return NULL;
    m->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void metered_release(void *user, void *ptr, size_t size)
{
    meter *m = user;
    (void)size;
    m->held--;
    free(ptr);
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    static const double map[12] = {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    double c[3][16][3];
    (void)state;
    random_patches(26, 3, c);
    ncr_status last = NCR_E_NOMEM;
    for (int n = 0; last != NCR_OK; n++) {
        meter m = {.left = n};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &m,
                             .alloc = metered_alloc,
                             .release = metered_release,
                             .workers = 1};
        ncr_surface *s = NULL, *moved = NULL;
        last = ncr_surface_create_bezier(&ctx, 3, (const double(*)[16][3])c, NULL, &s);
        if (last == NCR_OK)
            last = ncr_surface_create_transformed(&ctx, s, map, &moved);
        assert_true(last == NCR_OK ? n == 2 : last == NCR_E_NOMEM && !moved);
        ncr_surface_destroy(&ctx, s);
        ncr_surface_destroy(&ctx, moved);
        assert_int_equal(m.held, 0);
    }
}

static void worker_count_does_not_change_a_bit(void **state)
{
    enum { count = 100 };
    double(*c)[16][3] = malloc(count * sizeof *c);
    ncr_surface *one, *many;
    (void)state;
    assert_non_null(c);
    random_patches(27, count, c);
    const ncr_ctx four = {.struct_size = sizeof four, .workers = 4};
    CHECK_STATUS(NCR_OK,
                 ncr_surface_create_bezier(NULL, count, (const double(*)[16][3])c, NULL, &one));
    CHECK_STATUS(NCR_OK,
                 ncr_surface_create_bezier(&four, count, (const double(*)[16][3])c, NULL, &many));
    for (int p = 0; p < count; p++) {
        assert_memory_equal(&one->patch[p].field, &many->patch[p].field,
                            sizeof one->patch[p].field);
        assert_true(one->patch[p].area == many->patch[p].area);
    }
    ncr_surface_destroy(NULL, one);
    ncr_surface_destroy(&four, many);
    free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(teapot_areas_are_the_known_ones),
        cmocka_unit_test(teapot_fills_its_known_box),
        cmocka_unit_test(teapot_has_52_shared_borders_without_gap_or_crease),
        cmocka_unit_test(teacup_is_the_known_one_and_closed),
        cmocka_unit_test(teaspoon_area_is_the_known_one),
        cmocka_unit_test(affine_maps_and_evaluation_commute),
        cmocka_unit_test(scaling_by_a_power_of_two_is_exact),
        cmocka_unit_test(mirrors_keep_normals_outward),
        cmocka_unit_test(bad_input_is_refused),
        cmocka_unit_test(empty_and_repeated_patches_keep_their_place),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
        cmocka_unit_test(worker_count_does_not_change_a_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
