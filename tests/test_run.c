/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/cpu_internal.h"
#include "shading/method_internal.h"

#include <string.h>

static const ncr_run_kernels *const by_level[] = {&ncr_run_plain, &ncr_run_avx2, &ncr_run_avx512};

enum { page_side = 64, image_pixels = 4 * NCR_RUN };

/* Four charts on two pages, and texels that tell where they are. */
typedef struct atlas {
    ncr_chart charts[4];
    uint16_t index[2 * page_side * page_side * 4];
    ncr_sample_map map;
} atlas;

static void make_atlas(atlas *a)
{
    for (uint32_t p = 0; p < 4; p++)
        a->charts[p] = (ncr_chart){.patch = p,
                                   .page = p / 2,
                                   .x = p % 2 * 32,
                                   .y = p % 3 * 16,
                                   .width = p == 3 ? 8 : 32,
                                   .height = 16};
    for (size_t k = 0; k < sizeof a->index / sizeof *a->index; k++)
        a->index[k] = (uint16_t)(k * 40503u >> 3);
    a->map = (ncr_sample_map){.patch_count = 4,
                              .page_count = 2,
                              .charts = a->charts,
                              .page_width = page_side,
                              .page_height = page_side,
                              .index = a->index};
}

/* Pixels with gaps, on stretches of one patch, with corners of the patch among them. */
static void random_run(check_random *random, size_t count, ncr_run *run)
{
    memset(run, 0, sizeof *run);
    ncr_packed *at = &run->packed;
    run->count = count;
    run->patch = at->patch;
    run->u = at->u;
    run->v = at->v;
    uint32_t pixel = 0, patch = 0;
    for (size_t k = 0; k < count; k++) {
        pixel += check_uniform(random, 0, 1) < 0.95 ? 1 : (uint32_t)check_uniform(random, 1, 9);
        if (check_uniform(random, 0, 1) < 0.05)
            patch = (uint32_t)check_uniform(random, 0, 4);
        run->pixel[k] = pixel;
        at->patch[k] = patch;
        at->u[k] = k % 7 ? (float)check_uniform(random, 0, 1) : (float)(k % 2);
        at->v[k] = k % 5 ? (float)check_uniform(random, 0, 1) : 1;
        for (int c = 0; c < 3; c++) {
            at->n.at[c][k] = (float)check_uniform(random, -1, 1);
            at->view.at[c][k] = (float)check_uniform(random, -1, 1);
            run->rgb.at[c][k] = (float)check_uniform(random, -1, 1);
        }
    }
    for (int c = 0; c < 3; c++) {
        run->n[c] = at->n.at[c];
        run->view[c] = at->view.at[c];
    }
}

static void do_all(const ncr_run_kernels *kernels, const atlas *a, ncr_run *run, float *image)
{
    kernels->ask(&a->map, run);
    kernels->look_up_points(&a->map, run);
    kernels->reflect(run);
    kernels->store(run, image);
}

static void runs_read_the_texels_of_the_map(void **state)
{
    (void)state;
    static atlas a;
    static ncr_run run;
    static float image[3 * image_pixels];
    check_random random = {.seed = 61};
    make_atlas(&a);
    for (int level = 0; level <= (int)ncr_cpu_level(); level++)
        for (size_t count = 1; count <= NCR_RUN; count += 17) {
            random_run(&random, count, &run);
            do_all(by_level[level], &a, &run, image);
            for (size_t k = 0; k < count; k++) {
                const uint16_t *want = ncr_sample_map_at(&a.map, run.patch[k], run.u[k], run.v[k]);
                for (int j = 0; j < NCR_CANDIDATES; j++)
                    assert_int_equal(run.point[j][k], want[j]);
                for (int c = 0; c < 3; c++)
                    assert_true(image[3 * run.pixel[k] + (uint32_t)c] == run.rgb.at[c][k]);
            }
        }
}

/* A buffer in which every number is another. */
static void number(ncr_gbuffer *g)
{
    float *const plane[] = {g->u,  g->v,  g->px, g->py, g->pz, g->nx,
                            g->ny, g->nz, g->vx, g->vy, g->vz};
    const size_t pixels = (size_t)g->width * g->height;
    for (size_t k = 0; k < pixels; k++) {
        g->patch[k] = (uint32_t)k;
        for (size_t p = 0; p < sizeof plane / sizeof *plane; p++)
            plane[p][k] = (float)(p * pixels + k);
    }
}

static void expect_pixel(const ncr_gbuffer *g, const ncr_run *run, size_t k)
{
    const size_t at = run->pixel[k];
    assert_true(run->patch[k] == g->patch[at] && run->u[k] == g->u[at] && run->v[k] == g->v[at]);
    assert_true(run->x[0][k] == g->px[at] && run->x[1][k] == g->py[at] &&
                run->x[2][k] == g->pz[at]);
    assert_true(run->n[0][k] == g->nx[at] && run->n[1][k] == g->ny[at] &&
                run->n[2][k] == g->nz[at]);
    assert_true(run->view[0][k] == g->vx[at] && run->view[1][k] == g->vy[at] &&
                run->view[2][k] == g->vz[at]);
}

static void runs_in_place_and_packed_ones_hold_the_same(void **state)
{
    (void)state;
    static ncr_run place, packed;
    ncr_gbuffer g;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 400, 1, &g));
    number(&g);
    for (size_t length = 1; length <= 400; length++) {
        const size_t begin = 400 - length, rows = length / 64 < 2 ? length / 64 : 2;
        assert_int_equal(ncr_run_take(&g, begin, 400, &place), 64 * rows);
        assert_int_equal(place.count, 64 * rows);
        for (size_t k = 0; k < place.count; k++) {
            assert_int_equal(place.pixel[k], begin + k);
            expect_pixel(&g, &place, k);
        }
    }
    packed.count = 0;
    for (size_t at = 0, taken; packed.count < NCR_RUN; at += taken + 3) {
        const size_t before = packed.count, room = NCR_RUN - before;
        taken = ncr_run_add(&g, at, at + 37, &packed);
        assert_int_equal(taken, room < 37 ? room : 37);
        assert_int_equal(packed.count, before + taken);
        assert_int_equal(packed.pixel[before], at);
    }
    for (size_t k = 0; k < packed.count; k++)
        expect_pixel(&g, &packed, k);
    ncr_gbuffer_dispose(NULL, &g);
}

static void runs_touch_no_other_pixel(void **state)
{
    (void)state;
    static ncr_run run;
    static float image[3 * image_pixels];
    check_random random = {.seed = 62};
    for (int level = 0; level <= (int)ncr_cpu_level(); level++) {
        random_run(&random, NCR_RUN, &run);
        for (size_t k = 0; k < 3 * image_pixels; k++)
            image[k] = 7;
        by_level[level]->store(&run, image);
        size_t kept = 0;
        for (size_t k = 0; k < 3 * image_pixels; k++)
            kept += image[k] == 7;
        assert_int_equal(kept, 3 * (image_pixels - NCR_RUN));
    }
}

static void runs_are_the_same_on_every_instruction_set(void **state)
{
    (void)state;
    static atlas a;
    static ncr_run start, plain, fast;
    static float image[3 * image_pixels], weight[NCR_CANDIDATES][NCR_RUN];
    check_random random = {.seed = 63};
    make_atlas(&a);
    if (ncr_cpu_level() == NCR_CPU_GENERIC)
        skip(); /* nothing to compare with */
    for (size_t count = 1; count <= NCR_RUN; count++) {
        random_run(&random, count, &start);
        for (int j = 0; j < NCR_CANDIDATES; j++)
            for (size_t k = 0; k < count; k++)
                weight[j][k] = (float)check_uniform(&random, -1, 1);
        plain = start;
        do_all(&ncr_run_plain, &a, &plain, image);
        const uint32_t positive =
            ncr_run_plain.count_weights(count, (const float(*)[NCR_RUN])weight);
        for (int level = 1; level <= (int)ncr_cpu_level(); level++) {
            fast = start;
            do_all(by_level[level], &a, &fast, image);
            assert_memory_equal(&fast, &plain, sizeof fast);
            assert_int_equal(by_level[level]->count_weights(count, (const float(*)[NCR_RUN])weight),
                             positive);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_read_the_texels_of_the_map),
        cmocka_unit_test(runs_in_place_and_packed_ones_hold_the_same),
        cmocka_unit_test(runs_touch_no_other_pixel),
        cmocka_unit_test(runs_are_the_same_on_every_instruction_set),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
