/* SPDX-License-Identifier: MIT */
#include "brushed_maps.h"

#include "shading/harmonics.h"

#include <string.h>

/* All texels, each by its solid angle: nothing of maps, tables or warps. */
static void integrate(const ncr_directional_map *env, const ncr_brushed *m, const seen_point *p,
                      double out[3])
{
    double area[rows], b[3];
    d_cross(p->n, p->t, b);
    ncr_harmonics_row_weights(rows, false, area);
    const double v[3] = {d_dot(p->t, p->v), d_dot(b, p->v), d_dot(p->n, p->v)};
    out[0] = out[1] = out[2] = 0;
    for (uint32_t k = 0; k < 2 * rows * rows; k++) {
        const uint32_t x = k % (2 * rows), y = k / (2 * rows);
        const double theta = (y + 0.5) * pi / rows, phi = (x + 0.5) * pi / rows;
        const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        const double l[3] = {d_dot(p->t, d), d_dot(b, d), d_dot(p->n, d)};
        const double f = area[y] / (2 * rows) * ncr_brushed_eval(m, v, l);
        for (int c = 0; c < 3; c++)
            out[c] += f * (double)ncr_image_at(&env->image, x, y)[c];
    }
}

/* Root mean square over random points of what a set shows minus the integral, over that of the
 * integral. With `own`, points are seen by eyes of the set. */
static double unlike_integral(const ncr_rsibr *set, bool own)
{
    enum { draws = 240 };
    ncr_directional_map env = light_of(room_light);
    check_random r = {.seed = 6};
    double error = 0, size = 0;
    for (int k = 0; k < draws; k++) {
        seen_point p = any_point(&r, 0.2);
        while (own && d_dot(p.n, set->sphere.view[k % 12]) < 0.2)
            p = any_point(&r, 0.2);
        if (own)
            memcpy(p.v, set->sphere.view[k % 12], sizeof p.v);
        float got[1][3];
        double want[3];
        shade(set, &p, got);
        integrate(&env, &set->brdf.lobe[0].brushed, &p, want);
        for (int c = 0; c < 3; c++) {
            error += pow((double)got[0][c] - want[c], 2);
            size += want[c] * want[c];
        }
    }
    ncr_directional_map_dispose(NULL, &env);
    return sqrt(error / size);
}

static double error_of(uint32_t views, uint32_t turns, bool own)
{
    const ncr_rsibr_brdf brdf = brushed(0.3, 0.45);
    ncr_rsibr set = set_of(room_light, &brdf,
                           NCR_OPTS(ncr_rsibr_opts, .views = views, .size = 48, .turns = turns));
    const double error = unlike_integral(&set, own);
    print_message("%u eyes, %u turns: %.4f%s\n", views, turns, error,
                  own ? ", toward those eyes" : "");
    ncr_rsibr_dispose(NULL, &set);
    return error;
}

/* Toward eyes of the set nothing is blended, but directions of the tangent. */
static void more_turns_err_less(void **state)
{
    (void)state;
    const double few = error_of(12, 3, true), enough = error_of(12, 12, true);
    assert_true(enough < 0.3 * few && enough < 0.02);
}

static void more_eyes_err_less(void **state)
{
    (void)state;
    const double few = error_of(12, 6, false), more = error_of(42, 6, false);
    assert_true(more < 0.75 * few && few < 0.2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(more_turns_err_less),
        cmocka_unit_test(more_eyes_err_less),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
