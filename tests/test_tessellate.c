/* SPDX-License-Identifier: MIT */
#include "tests/solids.h"

#include "core/vec_internal.h"
#include "geometry/tessellate_internal.h"

#include <stdlib.h>
#include <string.h>

static ncr_mesh mesh_of(const ncr_surface *surface, double chord)
{
    ncr_mesh mesh;
    CHECK_STATUS(NCR_OK, ncr_mesh_create(NULL, surface, chord, &mesh));
    return mesh;
}

/* --- cracks: every directed edge has its reverse, bit for bit -------------------------------- */

typedef struct edge {
    float from[3], to[3];
} edge;

static int compare_edges(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(edge));
}

static bool same(const float a[3], const float b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void put(float to[3], const float from[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = from[k] + 0.0f; /* one zero only */
}

/* Directed edges, by position, of the triangles that have three different corners. */
static edge *directed_edges(const ncr_mesh *m, size_t *count)
{
    edge *edges = calloc(3 * m->triangle_count + 1, sizeof *edges);
    *count = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const float *p[3];
        for (int k = 0; k < 3; k++)
            p[k] = m->position[m->corner[t][k]];
        if (same(p[0], p[1]) || same(p[1], p[2]) || same(p[2], p[0]))
            continue;
        for (int k = 0; k < 3; k++) {
            put(edges[*count].from, p[k]);
            put(edges[(*count)++].to, p[(k + 1) % 3]);
        }
    }
    qsort(edges, *count, sizeof *edges, compare_edges);
    return edges;
}

static size_t unmatched_edges(const ncr_mesh *m)
{
    size_t count, lonely = 0;
    edge *edges = directed_edges(m, &count);
    for (size_t k = 0; k < count; k++) {
        edge back;
        memcpy(back.from, edges[k].to, sizeof back.from);
        memcpy(back.to, edges[k].from, sizeof back.to);
        const bool twice = k + 1 < count && compare_edges(&edges[k], &edges[k + 1]) == 0;
        lonely += twice || !bsearch(&back, edges, count, sizeof *edges, compare_edges);
    }
    free(edges);
    return lonely;
}

static void closed_surfaces_have_no_cracks(void **state)
{
    (void)state;
    for (double chord = 0.1; chord > 1e-4; chord /= 3) {
        ncr_surface *sphere = solid_sphere();
        ncr_mesh mesh = mesh_of(sphere, chord);
        assert_int_equal(unmatched_edges(&mesh), 0);
        ncr_mesh_dispose(NULL, &mesh);
        ncr_surface_destroy(NULL, sphere);
    }
}

static void neighbours_with_different_grids_have_no_cracks(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 40; seed++) {
        ncr_surface *surface = solid_uneven_sphere(seed);
        ncr_mesh mesh = mesh_of(surface, 0.004);
        const size_t lonely = unmatched_edges(&mesh);
        CHECK(lonely == 0, "seed %u: %zu of %zu triangles", (unsigned)seed, lonely,
              mesh.triangle_count);
        ncr_mesh_dispose(NULL, &mesh);
        ncr_surface_destroy(NULL, surface);
    }
}

/* --- tiling ---------------------------------------------------------------------------------- */

static double parameter_area(const ncr_mesh *m, const uint32_t c[3])
{
    const float *a = m->uv[c[0]], *b = m->uv[c[1]], *d = m->uv[c[2]];
    return ((double)(b[0] - a[0]) * (d[1] - a[1]) - (double)(b[1] - a[1]) * (d[0] - a[0])) / 2;
}

static void triangles_tile_the_parameter_square_without_folds(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        ncr_surface *surface = solid_uneven_sphere(seed);
        ncr_mesh mesh = mesh_of(surface, 0.003);
        double area[sphere_patches] = {0};
        for (size_t t = 0; t < mesh.triangle_count; t++) {
            const double a = parameter_area(&mesh, mesh.corner[t]);
            assert_true(a >= 0);
            area[mesh.patch[t]] += a;
        }
        for (int p = 0; p < sphere_patches; p++)
            CHECK_NEAR(area[p], 1, 1e-12);
        ncr_mesh_dispose(NULL, &mesh);
        ncr_surface_destroy(NULL, surface);
    }
}

/* --- the chord ------------------------------------------------------------------------------- */

/* Distance from a point to the segment a b. */
static double segment_distance(const double p[3], const double a[3], const double b[3])
{
    double ab[3], ap[3], rest[3];
    d_sub(b, a, ab);
    d_sub(p, a, ap);
    const double length2 = d_dot(ab, ab);
    const double t = length2 > 0 ? fmin(1, fmax(0, d_dot(ap, ab) / length2)) : 0;
    d_mad(ap, -t, ab, rest);
    return d_length(rest);
}

static double triangle_distance(const ncr_mesh *m, const uint32_t corner[3], const double p[3])
{
    double c[3][3], e1[3], e2[3], n[3], ap[3], side[3], out[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            c[i][k] = m->position[corner[i]][k];
    d_sub(c[1], c[0], e1);
    d_sub(c[2], c[0], e2);
    d_cross(e1, e2, n);
    d_sub(p, c[0], ap);
    bool above = d_normalize(n);
    for (int i = 0; i < 3 && above; i++) {
        d_sub(c[(i + 1) % 3], c[i], side);
        d_cross(n, side, out);
        d_sub(p, c[i], side);
        above = d_dot(out, side) >= 0;
    }
    if (above)
        return fabs(d_dot(n, ap));
    return fmin(segment_distance(p, c[0], c[1]),
                fmin(segment_distance(p, c[1], c[2]), segment_distance(p, c[2], c[0])));
}

static double mesh_distance(const ncr_mesh *m, uint32_t patch, const double p[3])
{
    double nearest = INFINITY;
    for (size_t t = 0; t < m->triangle_count; t++)
        if (m->patch[t] == patch)
            nearest = fmin(nearest, triangle_distance(m, m->corner[t], p));
    return nearest;
}

static void check_chord(const ncr_surface *surface, double chord, check_random *r)
{
    ncr_mesh mesh = mesh_of(surface, chord);
    assert_true(mesh.chord <= chord);
    double worst = 0;
    for (int k = 0; k < 600; k++) {
        const uint32_t patch = (uint32_t)check_uniform(r, 0, ncr_surface_patch_count(surface));
        /* Every third point close to a border, where grids are stitched. */
        const double near = k % 3 ? 1 : 0.02;
        ncr_surface_point at;
        ncr_surface_eval(surface, patch, check_uniform(r, 0, 1), near * check_uniform(r, 0, 1),
                         &at);
        worst = fmax(worst, mesh_distance(&mesh, patch, at.p));
    }
    CHECK(worst <= mesh.chord, "gap %g, promised %g, asked %g, seed %u", worst, (double)mesh.chord,
          chord, (unsigned)r->seed);
    CHECK(worst > 0.02 * chord, "gap %g is far finer than the %g asked for", worst, chord);
    ncr_mesh_dispose(NULL, &mesh);
}

static void no_point_is_farther_than_the_chord(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 6; seed++) {
        check_random r = {.seed = seed};
        ncr_surface *surface = solid_uneven_sphere(seed);
        check_chord(surface, 0.02, &r);
        ncr_surface_destroy(NULL, surface);
    }
}

/* Distance of the patch from the triangle at the same parameter, inside and on its edges. */
static double interpolation_gap(const ncr_surface *surface, const ncr_mesh *m, size_t t)
{
    static const double weights[4][3] = {
        {1 / 3.0, 1 / 3.0, 1 / 3.0}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}};
    double worst = 0;
    for (int s = 0; s < 4; s++) {
        double p[3] = {0}, uv[2] = {0}, gap[3];
        ncr_surface_point at;
        for (int i = 0; i < 3; i++) {
            const uint32_t c = m->corner[t][i];
            for (int k = 0; k < 3; k++)
                p[k] += weights[s][i] * (double)m->position[c][k];
            for (int k = 0; k < 2; k++)
                uv[k] += weights[s][i] * (double)m->uv[c][k];
        }
        ncr_surface_eval(surface, m->patch[t], uv[0], uv[1], &at);
        d_sub(at.p, p, gap);
        worst = fmax(worst, d_length(gap));
    }
    return worst;
}

static void check_interpolation(const ncr_surface *surface, double chord)
{
    ncr_mesh mesh = mesh_of(surface, chord);
    for (size_t t = 0; t < mesh.triangle_count; t++) {
        const double gap = interpolation_gap(surface, &mesh, t);
        CHECK(gap <= (double)mesh.chord, "%g of %g", gap, (double)mesh.chord);
    }
    ncr_mesh_dispose(NULL, &mesh);
}

static void every_triangle_keeps_the_chord_at_its_parameter(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 40; seed++) {
        ncr_surface *surface = solid_uneven_sphere(seed);
        check_interpolation(surface, 0.004);
        ncr_surface_destroy(NULL, surface);
    }
}

/* A sheet that rises from a straight border to a wave. Two flat sheets, numbered before and after
 * it, share the straight border, which for them needs no points but its ends. */
static void a_straight_border_of_a_wavy_patch_keeps_the_chord(void **state)
{
    (void)state;
    double nets[3][16][3];
    const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    ncr_shape_quad((double[3]){0, -1, 0}, x, y, &nets[0]);
    ncr_shape_quad((double[3]){0, 0, 0}, x, y, &nets[1]);
    ncr_shape_quad((double[3]){0, -1, 0}, x, y, &nets[2]);
    for (int i = 0; i < 4; i++) {
        nets[1][4 * i + 1][2] = 0.5 * i / 3;
        nets[1][4 * i + 2][2] = -0.5 * i / 3;
    }
    ncr_surface *surface = solid_surface(3, nets);
    check_interpolation(surface, 0.004);
    ncr_surface_destroy(NULL, surface);
}

static void a_chord_out_of_reach_is_reported_as_it_is(void **state)
{
    (void)state;
    ncr_surface *sphere = solid_sphere();
    ncr_mesh mesh = mesh_of(sphere, 0);
    assert_int_equal(mesh.triangle_count, sphere_patches * 2 * NCR_RATE_MAX * NCR_RATE_MAX);
    assert_true(mesh.chord > 1e-6 && mesh.chord < 1e-4);
    ncr_mesh_dispose(NULL, &mesh);
    ncr_surface_destroy(NULL, sphere);
}

/* --- orientation and leftovers --------------------------------------------------------------- */

/* Enclosed volume of the triangles: positive when they face outward. */
static double volume(const ncr_mesh *m)
{
    double sum = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double c[3][3], n[3];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                c[i][k] = m->position[m->corner[t][i]][k];
        d_cross(c[0], c[1], n);
        sum += d_dot(n, c[2]) / 6;
    }
    return sum;
}

static void triangles_face_outward_also_in_a_mirror(void **state)
{
    (void)state;
    const double mirror[12] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    ncr_surface *sphere = solid_sphere(), *mirrored = NULL;
    CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, sphere, mirror, &mirrored));
    const ncr_surface *both[2] = {sphere, mirrored};
    for (int k = 0; k < 2; k++) {
        ncr_mesh mesh = mesh_of(both[k], 1e-4);
        CHECK_NEAR(volume(&mesh), 4.18879, 4e-3);
        ncr_mesh_dispose(NULL, &mesh);
    }
    ncr_surface_destroy(NULL, sphere);
    ncr_surface_destroy(NULL, mirrored);
}

static void patches_without_area_get_no_triangles(void **state)
{
    (void)state;
    double nets[3][16][3];
    memset(nets, 0, sizeof nets);
    const double corner[3] = {0, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 1, 0};
    ncr_shape_quad(corner, u, v, &nets[0]);
    ncr_shape_quad(corner, u, u, &nets[1]);
    ncr_shape_quad(corner, v, u, &nets[2]);
    ncr_surface *surface = solid_surface(3, nets);
    ncr_mesh mesh = mesh_of(surface, 1e-3);
    assert_int_equal(mesh.triangle_count, 4);
    for (int t = 0; t < 4; t++)
        assert_int_equal(mesh.patch[t], t < 2 ? 0 : 2);
    ncr_mesh_dispose(NULL, &mesh);
    ncr_surface_destroy(NULL, surface);
}

static void vertices_lie_on_the_surface_at_their_parameter(void **state)
{
    (void)state;
    ncr_surface *surface = solid_uneven_sphere(3);
    ncr_mesh mesh = mesh_of(surface, 0.01);
    for (size_t t = 0; t < mesh.triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const uint32_t c = mesh.corner[t][k];
            ncr_surface_point at;
            double n[3];
            ncr_surface_eval(surface, mesh.patch[t], (double)mesh.uv[c][0], (double)mesh.uv[c][1],
                             &at);
            ncr_surface_normal(surface, mesh.patch[t], (double)mesh.uv[c][0], (double)mesh.uv[c][1],
                               n);
            for (int i = 0; i < 3; i++) {
                CHECK_NEAR((double)mesh.position[c][i], at.p[i], 2.5e-7);
                CHECK_NEAR((double)mesh.normal[c][i], n[i], 1e-7);
            }
        }
    ncr_mesh_dispose(NULL, &mesh);
    ncr_surface_destroy(NULL, surface);
}

static void the_rule_of_the_grid_gives_what_the_arrays_say(void **state)
{
    (void)state;
    const double mirror[12] = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0};
    for (uint64_t seed = 1; seed <= 8; seed++) {
        ncr_surface *surface = solid_uneven_sphere(seed), *mirrored = NULL;
        CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, surface, mirror, &mirrored));
        ncr_mesh mesh = mesh_of(seed % 2 ? surface : mirrored, 0.003);
        for (uint32_t t = 0; t < mesh.triangle_count; t++) {
            const uint32_t patch = mesh.block_patch[t >> mesh.log_block];
            const ncr_mesh_grid *g = &mesh.grids[patch];
            uint32_t x[3], y[3];
            assert_int_equal(patch, mesh.patch[t]);
            ncr_grid_triangle(g, t - g->first_triangle, x, y);
            for (int i = 0; i < 3; i++) {
                const uint32_t c = mesh.corner[t][i];
                assert_int_equal(ncr_grid_vertex(g, x[i], y[i]), c);
                assert_true((float)x[i] * g->step[0] == mesh.uv[c][0]);
                assert_true((float)y[i] * g->step[1] == mesh.uv[c][1]);
            }
        }
        ncr_mesh_dispose(NULL, &mesh);
        ncr_surface_destroy(NULL, surface);
        ncr_surface_destroy(NULL, mirrored);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_surfaces_have_no_cracks),
        cmocka_unit_test(neighbours_with_different_grids_have_no_cracks),
        cmocka_unit_test(triangles_tile_the_parameter_square_without_folds),
        cmocka_unit_test(no_point_is_farther_than_the_chord),
        cmocka_unit_test(every_triangle_keeps_the_chord_at_its_parameter),
        cmocka_unit_test(a_straight_border_of_a_wavy_patch_keeps_the_chord),
        cmocka_unit_test(a_chord_out_of_reach_is_reported_as_it_is),
        cmocka_unit_test(triangles_face_outward_also_in_a_mirror),
        cmocka_unit_test(patches_without_area_get_no_triangles),
        cmocka_unit_test(vertices_lie_on_the_surface_at_their_parameter),
        cmocka_unit_test(the_rule_of_the_grid_gives_what_the_arrays_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
