/* SPDX-License-Identifier: MIT
 * Truths about footprints: what a long and narrow look at a map shows is its mean there. */
#include "check.h"

#include "shading/directional_map.h"

#include <string.h>

enum { size = 64, level_count = 7 };

static void constant(const double d[3], void *user, float *out)
{
    (void)d, (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = 0.7f + (float)c;
}

/* Waves of about three texels: what a round look would blur away, and point samples alias. */
static void waves(const double d[3], void *user, float *out)
{
    (void)user;
    out[0] = (float)(1 + sin(30 * d[0]));
    out[1] = (float)(1 + sin(28 * d[1] + 10 * d[2]));
    out[2] = (float)(1 + sin(25 * d[2]) * cos(20 * d[0]));
}

typedef struct pyramid {
    ncr_directional_map levels[level_count];
} pyramid;

static pyramid build(ncr_map_kind kind, ncr_radiance_fn *fn)
{
    pyramid p;
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, kind, size, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0.5 / size, fn, NULL));
    CHECK_STATUS(NCR_OK, ncr_directional_map_levels(NULL, &map, level_count, p.levels));
    ncr_directional_map_dispose(NULL, &map);
    return p;
}

static void release(pyramid *p)
{
    for (int k = 0; k < level_count; k++)
        ncr_directional_map_dispose(NULL, &p->levels[k]);
}

/* A direction and two steps across it, of these lengths, turned at random. */
static void random_footprint(check_random *r, double longer, double shorter, double d[3],
                             double du[3], double dv[3])
{
    double a[3], n = 0, m = 0, k = 0;
    for (int i = 0; i < 3; i++) {
        d[i] = check_uniform(r, -1, 1);
        a[i] = check_uniform(r, -1, 1);
        n += d[i] * d[i];
    }
    for (int i = 0; i < 3; i++)
        d[i] /= sqrt(n);
    for (int i = 0; i < 3; i++)
        k += a[i] * d[i];
    for (int i = 0; i < 3; i++) {
        a[i] -= k * d[i];
        m += a[i] * a[i];
    }
    for (int i = 0; i < 3; i++) {
        du[i] = longer * a[i] / sqrt(m);
        dv[i] =
            shorter * (d[(i + 1) % 3] * a[(i + 2) % 3] - d[(i + 2) % 3] * a[(i + 1) % 3]) / sqrt(m);
    }
}

static void a_constant_is_seen_bit_by_bit(void **state)
{
    (void)state;
    check_random r = {.seed = 1};
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        pyramid p = build((ncr_map_kind)kind, constant);
        for (int k = 0; k < 2000; k++) {
            double d[3], du[3], dv[3];
            float out[3];
            random_footprint(&r, pow(10, check_uniform(&r, -6, 0.5)),
                             pow(10, check_uniform(&r, -6, 0.5)), d, du, dv);
            ncr_directional_map_footprint(p.levels, level_count, d, du, dv, out);
            for (int c = 0; c < 3; c++)
                assert_true(out[c] == 0.7f + (float)c);
        }
        release(&p);
    }
}

static void no_footprint_is_a_look_up(void **state)
{
    (void)state;
    static const double zero[3] = {0};
    check_random r = {.seed = 2};
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        pyramid p = build((ncr_map_kind)kind, waves);
        for (int k = 0; k < 500; k++) {
            double d[3], du[3], dv[3];
            float a[3], b[3];
            random_footprint(&r, 1, 1, d, du, dv);
            ncr_directional_map_footprint(p.levels, level_count, d, zero, zero, a);
            ncr_directional_map_look_up(&p.levels[0], d, b);
            assert_memory_equal(a, b, sizeof a);
        }
        release(&p);
    }
}

/* The mean over the parallelogram, from 64 x 64 looks at the function itself. */
static void supersample(const double d[3], const double du[3], const double dv[3], double out[3])
{
    enum { n = 64 };
    memset(out, 0, 3 * sizeof *out);
    for (int k = 0; k < n * n; k++) {
        const double a = (k % n + 0.5) / n - 0.5, b = (double)((k / n) + 0.5) / n - 0.5;
        double e[3], length = 0;
        float one[3];
        for (int i = 0; i < 3; i++) {
            e[i] = d[i] + a * du[i] + b * dv[i];
            length += e[i] * e[i];
        }
        for (int i = 0; i < 3; i++)
            e[i] /= sqrt(length);
        waves(e, NULL, one);
        for (int c = 0; c < 3; c++)
            out[c] += (double)one[c] / (n * n);
    }
}

/* Root mean square over random long footprints; round: as if the footprint were as wide as long. */
static double error_of(const pyramid *p, bool round)
{
    check_random r = {.seed = 3};
    double sum = 0;
    enum { count = 300 };
    for (int k = 0; k < count; k++) {
        double d[3], du[3], dv[3], round_dv[3], exact[3];
        float out[3];
        random_footprint(&r, 0.6, 0.05, d, du, dv);
        for (int i = 0; i < 3; i++)
            round_dv[i] = 12 * dv[i];
        supersample(d, du, dv, exact);
        ncr_directional_map_footprint(p->levels, level_count, d, du, round ? round_dv : dv, out);
        for (int c = 0; c < 3; c++)
            sum += pow((double)out[c] - exact[c], 2) / (3 * count);
    }
    return sqrt(sum);
}

static void long_footprints_show_their_mean(void **state)
{
    (void)state;
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        pyramid p = build((ncr_map_kind)kind, waves);
        const double error = error_of(&p, false), round = error_of(&p, true);
        CHECK(error <= 0.1 && error <= 0.5 * round, "%s: %g, round %g",
              ncr_map_kind_name((ncr_map_kind)kind), error, round);
        release(&p);
    }
}

/* Skewed steps span the same ellipse as straight ones. */
static void how_the_ellipse_is_spanned_does_not_matter(void **state)
{
    (void)state;
    check_random r = {.seed = 4};
    pyramid p = build(NCR_MAP_CUBE, waves);
    for (int k = 0; k < 300; k++) {
        double d[3], du[3], dv[3], eu[3], ev[3];
        float a[3], b[3];
        random_footprint(&r, 0.5, 0.1, d, du, dv);
        const double turn = check_uniform(&r, 0, 6);
        for (int i = 0; i < 3; i++) {
            eu[i] = cos(turn) * du[i] + sin(turn) * dv[i];
            ev[i] = cos(turn) * dv[i] - sin(turn) * du[i];
        }
        ncr_directional_map_footprint(p.levels, level_count, d, du, dv, a);
        ncr_directional_map_footprint(p.levels, level_count, d, eu, ev, b);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR((double)a[c], (double)b[c], 1e-5);
    }
    release(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_is_seen_bit_by_bit),
        cmocka_unit_test(no_footprint_is_a_look_up),
        cmocka_unit_test(long_footprints_show_their_mean),
        cmocka_unit_test(how_the_ellipse_is_spanned_does_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
