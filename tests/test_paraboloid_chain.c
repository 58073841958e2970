/* SPDX-License-Identifier: MIT
 * Truths about the paraboloid as hardware looks it up: matrices, alpha and passes give what the
 * formula gives. */
#include "check.h"

#include "shading/paraboloid_chain.h"

static const double identity[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static void random_unit(check_random *r, double d[3])
{
    double length;
    do {
        length = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = check_uniform(r, -1, 1);
            length += d[k] * d[k];
        }
    } while (length > 1 || length < 1e-3);
    for (int k = 0; k < 3; k++)
        d[k] /= sqrt(length);
}

/* Axes of eye space in terms of the map's: columns of a random rotation. */
static void random_rotation(check_random *r, double m[3][3])
{
    double a[3], b[3], c[3], length = 0;
    random_unit(r, a);
    random_unit(r, c);
    for (int k = 0; k < 3; k++)
        b[k] = a[(k + 1) % 3] * c[(k + 2) % 3] - a[(k + 2) % 3] * c[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        length += b[k] * b[k];
    for (int k = 0; k < 3; k++)
        b[k] /= sqrt(length);
    for (int k = 0; k < 3; k++) {
        m[0][k] = a[k];
        m[1][k] = b[k];
        m[2][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

static void smooth(const double d[3], void *user, float *out)
{
    (void)user;
    out[0] = (float)(2 + d[0] + 0.5 * d[1] * d[2]);
    out[1] = (float)(1 + d[2] * d[2]);
    out[2] = (float)(2 - d[1] + 0.3 * d[0] * d[2]);
}

static ncr_directional_map smooth_map(uint32_t size)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_PARABOLOID, size, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0, smooth, NULL));
    return map;
}

/* ---- Matrices ---- */

/* Each half's chain against the closed form, front and back, far into the other half. */
static void the_matrix_chain_is_the_formula(void **state)
{
    (void)state;
    check_random r = {.seed = 10};
    for (int k = 0; k < 20000; k++) {
        double model[3][3], eye[3], own[3], u, v;
        random_rotation(&r, model);
        random_unit(&r, own);
        for (int i = 0; i < 3; i++)
            eye[i] = model[i][0] * own[0] + model[i][1] * own[1] + model[i][2] * own[2];
        for (uint32_t part = 0; part < 2; part++) {
            double m[4][4];
            const double z = part ? -own[2] : own[2];
            if (z < -0.9)
                continue;
            ncr_paraboloid_matrix(part, (const double(*)[3])model, m);
            ncr_paraboloid_project((const double(*)[4])m, eye, &u, &v);
            CHECK_NEAR(2 * u - 1, own[0] / (1 + z), 1e-13);
            CHECK_NEAR(2 * v - 1, -own[1] / (1 + z), 1e-13);
        }
    }
}

/* Where the map's own look-up goes, rim included; and one place for both halves at the rim. */
static void the_matrix_chain_meets_the_map(void **state)
{
    (void)state;
    check_random r = {.seed = 11};
    double m[2][4][4], u, v;
    for (uint32_t part = 0; part < 2; part++)
        ncr_paraboloid_matrix(part, identity, m[part]);
    for (int k = 0; k < 20000; k++) {
        double d[3];
        random_unit(&r, d);
        const ncr_map_coord at = ncr_map_from_direction(NCR_MAP_PARABOLOID, d);
        ncr_paraboloid_project((const double(*)[4])m[at.part], d, &u, &v);
        CHECK_NEAR(2 * u - 1, at.s, 1e-14);
        CHECK_NEAR(2 * v - 1, at.t, 1e-14);
    }
    for (int k = 0; k < 360; k++) {
        const double phi = k * 3.14159265358979323846 / 180, d[3] = {cos(phi), sin(phi), 0};
        double u1, v1;
        ncr_paraboloid_project((const double(*)[4])m[0], d, &u, &v);
        ncr_paraboloid_project((const double(*)[4])m[1], d, &u1, &v1);
        CHECK_NEAR(u, u1, 1e-15);
        CHECK_NEAR(v, v1, 1e-15);
    }
}

static void what_lies_straight_behind_is_at_infinity(void **state)
{
    (void)state;
    double m[4][4], u, v;
    for (uint32_t part = 0; part < 2; part++) {
        const double d[3] = {0, 0, part ? 1 : -1};
        ncr_paraboloid_matrix(part, identity, m);
        ncr_paraboloid_project((const double(*)[4])m, d, &u, &v);
        assert_true(isinf(u) && isinf(v));
    }
}

/* ---- Alpha and passes ---- */

static double largest_difference(const ncr_paraboloid_units *units, double from, double to,
                                 void (*look)(const ncr_paraboloid_units *, const double *,
                                              float *))
{
    check_random r = {.seed = 12};
    double worst = 0;
    for (int k = 0; k < 20000; k++) {
        double d[3];
        float a[3], b[3];
        random_unit(&r, d);
        const ncr_map_coord at = ncr_map_from_direction(NCR_MAP_PARABOLOID, d);
        const double rho = hypot(at.s, at.t);
        if (rho < from || rho > to)
            continue;
        look(units, d, a);
        ncr_directional_map_look_up(units->map, d, b);
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs((double)a[c] - (double)b[c]));
    }
    return worst;
}

/* Away from the rim the very same texels are mixed; about it the halves, which show the same there,
 * are mixed otherwise: by what the texels that the rim cuts are off, which falls with their size. */
static void alpha_and_passes_show_what_the_formula_shows(void **state)
{
    (void)state;
    for (int s = 0; s < 2; s++) {
        double at_rim[2];
        for (int k = 0; k < 2; k++) {
            const uint32_t size = k ? 128 : 32;
            const double soft = s ? 2.0 / size : 0;
            ncr_directional_map map = smooth_map(size);
            ncr_paraboloid_units units;
            CHECK_STATUS(NCR_OK, ncr_paraboloid_bind(NULL, &map, identity, soft, &units));
            const double band = 4.0 / size + 1e-9; /* two texels: where the map itself mixes */
            CHECK_NEAR(largest_difference(&units, 0, 1 - band, ncr_paraboloid_blend), 0, 1e-6);
            CHECK_NEAR(largest_difference(&units, 0, 1 - band, ncr_paraboloid_passes), 0, 1e-6);
            at_rim[k] = largest_difference(&units, 1 - band, 1, ncr_paraboloid_blend);
            ncr_directional_map_dispose(NULL, &map);
        }
        CHECK(at_rim[0] <= 0.02 && at_rim[1] <= at_rim[0] / 3, "soft %d: off by %g, then %g", s,
              at_rim[0], at_rim[1]);
    }
}

static void without_a_band_passes_are_the_same_image(void **state)
{
    (void)state;
    check_random r = {.seed = 13};
    ncr_directional_map map = smooth_map(16);
    ncr_paraboloid_units units;
    double model[3][3];
    random_rotation(&r, model);
    CHECK_STATUS(NCR_OK, ncr_paraboloid_bind(NULL, &map, (const double(*)[3])model, 0, &units));
    for (int k = 0; k < 20000; k++) {
        double d[3];
        float a[3], b[3];
        random_unit(&r, d);
        ncr_paraboloid_blend(&units, d, a);
        ncr_paraboloid_passes(&units, d, b);
        assert_memory_equal(a, b, sizeof a);
    }
    ncr_directional_map_dispose(NULL, &map);
}

/* Also straight ahead and behind, where one half has no place at all. */
static void a_constant_shows_itself(void **state)
{
    (void)state;
    check_random r = {.seed = 14};
    for (uint32_t size = 1; size <= 16; size *= 4) {
        ncr_directional_map map;
        CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_PARABOLOID, size, 3, &map));
        for (size_t k = 0; k < (size_t)size * size * 6; k++)
            map.image.data[k] = 0.1f;
        for (int k = 0; k < 3000; k++) {
            double d[3] = {0, 0, k ? -1 : 1};
            float a[3], b[3];
            if (k > 1)
                random_unit(&r, d);
            ncr_paraboloid_units units;
            CHECK_STATUS(NCR_OK, ncr_paraboloid_bind(NULL, &map, identity,
                                                     k % 3 ? 0.1 * (k % 3) : 0, &units));
            ncr_paraboloid_blend(&units, d, a);
            ncr_paraboloid_passes(&units, d, b);
            for (int c = 0; c < 3; c++)
                assert_true(a[c] == 0.1f && b[c] == 0.1f);
        }
        ncr_directional_map_dispose(NULL, &map);
    }
}

static void other_kinds_are_refused(void **state)
{
    (void)state;
    ncr_directional_map map;
    ncr_paraboloid_units units;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_SPHERE, 4, 3, &map));
    CHECK_STATUS(NCR_E_ARG, ncr_paraboloid_bind(NULL, &map, identity, 0, &units));
    ncr_directional_map_dispose(NULL, &map);
    map = smooth_map(4);
    CHECK_STATUS(NCR_E_ARG, ncr_paraboloid_bind(NULL, &map, identity, 0.5, &units));
    CHECK_STATUS(NCR_E_ARG, ncr_paraboloid_bind(NULL, &map, identity, NAN, &units));
    ncr_directional_map_dispose(NULL, &map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_matrix_chain_is_the_formula),
        cmocka_unit_test(the_matrix_chain_meets_the_map),
        cmocka_unit_test(what_lies_straight_behind_is_at_infinity),
        cmocka_unit_test(alpha_and_passes_show_what_the_formula_shows),
        cmocka_unit_test(without_a_band_passes_are_the_same_image),
        cmocka_unit_test(a_constant_shows_itself),
        cmocka_unit_test(other_kinds_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
