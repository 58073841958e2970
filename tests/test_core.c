/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "core/ctx.h"
#include "core/half.h"
#include "core/image.h"
#include "core/numerics.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static void sums_keep_what_plain_addition_drops(void **state)
{
    (void)state;
    ncr_sum s = {0};
    ncr_sum_add(&s, 1.0);
    ncr_sum_add(&s, 1e100);
    ncr_sum_add(&s, 1.0);
    ncr_sum_add(&s, -1e100);
    assert_true(ncr_sum_value(&s) == 2.0);
}

static void small_angles_survive(void **state)
{
    (void)state;
    for (double angle = 1e-12; angle < 3; angle *= 7) {
        const double a[3] = {1, 0, 0}, b[3] = {cos(angle), sin(angle), 0};
        CHECK_NEAR(ncr_angle_between(a, b) / angle, 1, 1e-15);
    }
}

static void every_half_round_trips(void **state)
{
    (void)state;
    static float row[65536];
    static uint16_t back[65536], all[65536];
    for (unsigned h = 0; h < 65536; h++)
        all[h] = (uint16_t)h;
    ncr_half_to_floats(65536, all, row);
    ncr_half_from_floats(65536, row, back);
    for (unsigned h = 0; h < 65536; h++) {
        const bool nan = (h & 0x7fffu) > 0x7c00u;
        assert_true(nan ? isnan(row[h]) : back[h] == h);
        assert_true(nan || ncr_half_from_float(ncr_half_to_float((uint16_t)h)) == h);
    }
}

static void half_rounds_to_nearest_even_and_saturates_to_infinity(void **state)
{
    (void)state;
    assert_int_equal(ncr_half_from_float(65504.0f), 0x7bff);
    assert_int_equal(ncr_half_from_float(65519.99f), 0x7bff);
    assert_int_equal(ncr_half_from_float(65520.0f), 0x7c00);
    assert_int_equal(ncr_half_from_float(0x1p-24f), 1);
    assert_int_equal(ncr_half_from_float(0x1p-25f), 0);
    assert_int_equal(ncr_half_from_float(0x1.8p-24f), 2);
    assert_int_equal(ncr_half_from_float(1.0f + 0x1p-11f), 0x3c00);
    assert_int_equal(ncr_half_from_float(1.0f + 0x3p-11f), 0x3c02);
}

static void the_fast_half_conversion_agrees_with_the_plain_one(void **state)
{
    (void)state;
    check_random r = {.seed = 1};
    float in[64];
    uint16_t out[64];
    for (int round = 0; round < 4000; round++) {
        for (int k = 0; k < 64; k++)
            in[k] = (float)(check_uniform(&r, -1, 1) * exp2(check_uniform(&r, -30, 20)));
        ncr_half_from_floats(64, in, out);
        for (int k = 0; k < 64; k++)
            assert_int_equal(out[k], ncr_half_from_float(in[k]));
    }
}

typedef struct visit {
    unsigned char seen[1000];
    size_t grain;
    atomic_bool bad;
} visit;

static void mark(size_t begin, size_t end, unsigned worker, void *arg)
{
    visit *v = arg;
    (void)worker;
    if (begin % v->grain != 0 || end - begin > v->grain)
        atomic_store(&v->bad, true);
    for (size_t k = begin; k < end; k++)
        v->seen[k]++;
}

static void loops_visit_each_index_once_in_fixed_chunks(void **state)
{
    (void)state;
    const unsigned workers[] = {1, 2, 3, 7, 64};
    for (size_t w = 0; w < 5; w++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers[w]};
        visit v = {.grain = 7};
        CHECK_STATUS(NCR_OK, ncr_parallel_for(&ctx, 1000, 7, mark, &v));
        assert_false(v.bad);
        for (int k = 0; k < 1000; k++)
            assert_int_equal(v.seen[k], 1);
    }
}

static int always(void *user)
{
    (void)user;
    return 1;
}

static void a_cancelled_loop_says_so(void **state)
{
    (void)state;
    const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = 2, .cancelled = always};
    visit v = {.grain = 7};
    CHECK_STATUS(NCR_E_CANCELLED, ncr_parallel_for(&ctx, 1000, 7, mark, &v));
}

static void memory_is_aligned_and_counted(void **state)
{
    (void)state;
    char *p = ncr_alloc_zero(NULL, 3, 5);
    assert_non_null(p);
    assert_int_equal((uintptr_t)p % 64, 0);
    for (int k = 0; k < 15; k++)
        assert_int_equal(p[k], 0);
    ncr_free(NULL, p);
    ncr_free(NULL, NULL);
    assert_null(ncr_alloc_zero(NULL, SIZE_MAX / 2, 3));
}

static void sobol_points_stratify(void **state)
{
    (void)state;
    /* A (0,m,2)-net: each of the 2^m elementary intervals of every shape holds one point. */
    enum { m = 8, count = 1 << m };
    for (uint32_t key = 0; key < 20; key++) {
        for (int shape = 0; shape <= m; shape++) {
            unsigned char hits[count] = {0};
            for (uint32_t k = 0; k < count; k++) {
                float xy[2];
                ncr_sobol2(k, key, xy);
                const unsigned i = (unsigned)(xy[0] * (float)(1 << shape));
                const unsigned j = (unsigned)(xy[1] * (float)(1 << (m - shape)));
                hits[i << (m - shape) | j]++;
            }
            for (int k = 0; k < count; k++)
                assert_int_equal(hits[k], 1);
        }
    }
}

static void images_refuse_impossible_sizes(void **state)
{
    (void)state;
    ncr_image image;
    CHECK_STATUS(NCR_E_ARG, ncr_image_init(NULL, 0, 1, 3, &image));
    CHECK_STATUS(NCR_E_ARG, ncr_image_init(NULL, 1, NCR_IMAGE_MAX + 1, 3, &image));
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 3, 2, 3, &image));
    ncr_image_dispose(NULL, &image);
    assert_null(image.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_keep_what_plain_addition_drops),
        cmocka_unit_test(small_angles_survive),
        cmocka_unit_test(every_half_round_trips),
        cmocka_unit_test(half_rounds_to_nearest_even_and_saturates_to_infinity),
        cmocka_unit_test(the_fast_half_conversion_agrees_with_the_plain_one),
        cmocka_unit_test(loops_visit_each_index_once_in_fixed_chunks),
        cmocka_unit_test(a_cancelled_loop_says_so),
        cmocka_unit_test(memory_is_aligned_and_counted),
        cmocka_unit_test(sobol_points_stratify),
        cmocka_unit_test(images_refuse_impossible_sizes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
