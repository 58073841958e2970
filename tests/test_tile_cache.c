/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [Mattson70]  R. L. Mattson, J. Gecsei, D. R. Slutz, I. L. Traiger. Evaluation Techniques for
 *                Storage Hierarchies, 1970 */

#include "files.h"
#include "sampling/sample_map.h"
#include "shading/lightfield.h"
#include "shading/tile_cache.h"

#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

/* ---- The cache ---- */

enum { slot_bytes = 256, keys = 300 };

/* A slot holds its key all over. */
static ncr_status fill_slot(void *user, uint32_t key, void *slot)
{
    atomic_uint *loads = user;
    uint32_t *words = slot;
    for (int k = 0; k < slot_bytes / 4; k++)
        words[k] = key;
    if (loads)
        atomic_fetch_add(loads, 1);
    return NCR_OK;
}

/* The budget that holds so many slots and no more. */
static size_t budget_for(size_t slots)
{
    ncr_tile_cache *c;
    size_t low = 0, high = 1 << 20;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const ncr_status status =
            ncr_tile_cache_create(NULL, keys, slot_bytes, middle, fill_slot, NULL, &c);
        const bool enough = status == NCR_OK && ncr_tile_cache_count(c).slots >= slots;
        ncr_tile_cache_destroy(NULL, status == NCR_OK ? c : NULL);
        if (enough)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static ncr_tile_cache *make_cache(size_t slots)
{
    ncr_tile_cache *c;
    CHECK_STATUS(NCR_OK, ncr_tile_cache_create(NULL, keys, slot_bytes, budget_for(slots), fill_slot,
                                               NULL, &c));
    assert_int_equal(ncr_tile_cache_count(c).slots, slots);
    return c;
}

static void touch(ncr_tile_cache *c, uint32_t key)
{
    const uint32_t *words = ncr_tile_cache_acquire(c, key);
    assert_non_null(words);
    assert_true(words[0] == key && words[slot_bytes / 4 - 1] == key);
    ncr_tile_cache_release(c, key);
}

static void a_cyclic_scan_one_too_long_misses_always(void **state)
{
    (void)state;
    for (uint32_t k = 1; k < 40; k += 3) {
        ncr_tile_cache *c = make_cache(k);
        for (uint32_t i = 0; i < 10 * (k + 1); i++)
            touch(c, i % (k + 1));
        assert_int_equal(ncr_tile_cache_count(c).hits, 0);
        assert_int_equal(ncr_tile_cache_count(c).misses, 10 * (k + 1));
        ncr_tile_cache_destroy(NULL, c);

        c = make_cache(k);
        for (uint32_t i = 0; i < 10 * k; i++)
            touch(c, i % k);
        assert_int_equal(ncr_tile_cache_count(c).misses, k);
        assert_int_equal(ncr_tile_cache_count(c).hits, 9 * k);
        ncr_tile_cache_destroy(NULL, c);
    }
}

/* Mattson's stack: how many other keys were used since a key was last used decides, for every size
 * of cache at once, whether it is found.                                            [Mattson70] */
static size_t stack_distance(uint32_t *stack, size_t *depth, uint32_t key)
{
    size_t k = 0;
    while (k < *depth && stack[k] != key)
        k++;
    const size_t distance = k < *depth ? k : SIZE_MAX;
    *depth += k == *depth;
    memmove(stack + 1, stack, k * sizeof *stack);
    stack[0] = key;
    return distance;
}

static void misses_are_those_of_the_stack_at_every_size(void **state)
{
    (void)state;
    enum { uses = 4000 };
    check_random r = {.seed = (uint64_t)time(NULL)};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    static uint32_t use[uses], stack[keys];
    static size_t distance[uses];
    size_t depth = 0;
    for (int k = 0; k < uses; k++) {
        const double near = check_uniform(&r, 0, 1);
        use[k] = (uint32_t)(keys * near * near * near * check_uniform(&r, 0, 1));
        distance[k] = stack_distance(stack, &depth, use[k]);
    }
    uint64_t before = UINT64_MAX;
    for (size_t size = 1; size <= 128; size += size < 20 ? 1 : 27) {
        uint64_t expected = 0;
        ncr_tile_cache *c = make_cache(size);
        for (int k = 0; k < uses; k++) {
            expected += distance[k] >= size;
            touch(c, use[k]);
        }
        const uint64_t misses = ncr_tile_cache_count(c).misses;
        assert_int_equal(misses, expected);
        assert_int_equal(misses + ncr_tile_cache_count(c).hits, uses);
        assert_true(misses <= before);
        before = misses;
        ncr_tile_cache_destroy(NULL, c);
    }
}

typedef struct crowd {
    ncr_tile_cache *cache;
    uint64_t seed;
} crowd;

static void *wander(void *arg)
{
    const crowd *w = arg;
    check_random r = {.seed = w->seed};
    for (int k = 0; k < 20000; k++) {
        const uint32_t key = (uint32_t)check_uniform(&r, 0, 40);
        const uint32_t *words = ncr_tile_cache_acquire(w->cache, key);
        for (int i = 0; i < slot_bytes / 4; i++)
            if (!words || words[i] != key)
                return (void *)1;
        ncr_tile_cache_release(w->cache, key);
    }
    return NULL;
}

/* Even one slot serves many threads, and nobody's piece is taken from under them. */
static void threads_share_any_number_of_slots(void **state)
{
    (void)state;
    for (size_t slots = 1; slots < 30; slots = slots * 3 + 1) {
        enum { threads = 7 };
        pthread_t thread[threads];
        crowd w[threads];
        ncr_tile_cache *c = make_cache(slots);
        for (size_t k = 0; k < threads; k++) {
            w[k] = (crowd){c, k};
            assert_int_equal(pthread_create(&thread[k], NULL, wander, &w[k]), 0);
        }
        for (size_t k = 0; k < threads; k++) {
            void *wrong = NULL;
            pthread_join(thread[k], &wrong);
            assert_null(wrong);
        }
        const ncr_tile_cache_stats stats = ncr_tile_cache_count(c);
        assert_int_equal(stats.hits + stats.misses, threads * 20000);
        ncr_tile_cache_destroy(NULL, c);
    }
}

/* Counts bytes asked for. */
static void *count_alloc(void *user, size_t size, size_t align)
{
    *(size_t *)user += size;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void count_release(void *user, void *ptr, size_t size)
{
    *(size_t *)user -= size;
    free(ptr);
}

static void the_budget_is_kept_to_the_byte(void **state)
{
    (void)state;
    for (size_t budget = 0; budget < 40000; budget += 97) {
        size_t held = 0;
        const ncr_ctx counting = {.struct_size = sizeof counting,
                                  .user = &held,
                                  .alloc = count_alloc,
                                  .release = count_release,
                                  .workers = 1};
        ncr_tile_cache *c;
        const ncr_status status =
            ncr_tile_cache_create(&counting, keys, slot_bytes, budget, fill_slot, NULL, &c);
        assert_true(status == NCR_OK || status == NCR_E_LIMIT);
        assert_true(status == NCR_OK || budget < 2000);
        if (status == NCR_OK) {
            assert_true(ncr_tile_cache_count(c).bytes <= budget);
            CHECK(held <= budget + 3 * 128, "%zu bytes for %zu", held, budget); /* headers of ctx */
            ncr_tile_cache_destroy(&counting, c);
        }
        assert_int_equal(held, 0);
    }
    ncr_tile_cache *c; /* what is not needed is not taken */
    CHECK_STATUS(NCR_OK,
                 ncr_tile_cache_create(NULL, keys, slot_bytes, 1 << 30, fill_slot, NULL, &c));
    assert_int_equal(ncr_tile_cache_count(c).slots, keys);
    ncr_tile_cache_destroy(NULL, c);
}

static void a_cache_that_gets_no_memory_leaks_none(void **state)
{
    (void)state;
    ncr_status status = NCR_E_NOMEM;
    for (long n = 0; status == NCR_E_NOMEM; n++) {
        file_meter m = {.left = n};
        const ncr_ctx metered = file_meter_ctx(&m);
        ncr_tile_cache *c;
        status = ncr_tile_cache_create(&metered, keys, slot_bytes, 1 << 16, fill_slot, NULL, &c);
        ncr_tile_cache_destroy(&metered, c);
        assert_int_equal(m.held, 0);
        assert_true(status == NCR_OK || n < 4);
    }
    CHECK_STATUS(NCR_OK, status);
}

/* ---- A light field over a source ---- */

/* Tiles computed from their place, some left out, some that cannot be read. */
typedef struct array_source {
    uint32_t n;
    bool holes;
    uint32_t fails_at; /* point that cannot be read; UINT32_MAX: none */
    atomic_uint reads;
} array_source;

static float light_at(uint32_t point, uint32_t face, uint32_t x, uint32_t y, int c)
{
    uint32_t h = ((point * 6 + face) * 4096 + y) * 4096 + x + (uint32_t)c * 77777;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (float)(h >> 16) / 1024;
}

static bool is_hole(const array_source *s, uint32_t point, uint32_t face, uint32_t x, uint32_t y)
{
    return s->holes && ncr_tile_number(s->n, point, face, x, y) % 5 == 2;
}

static void fill_part(const ncr_tile *part, float *rgb, float *z)
{
    for (uint32_t j = 0; j < part->height; j++)
        for (uint32_t i = 0; i < part->width; i++) {
            const size_t at = (size_t)j * part->width + i;
            for (int c = 0; c < 3; c++)
                rgb[3 * at + (size_t)c] =
                    light_at(part->point, part->face, part->x + i, part->y + j, c);
            if (z)
                z[at] = rgb[3 * at] + 1;
        }
}

static ncr_status read_part(void *user, const ncr_tile *part, float *rgb, float *z,
                            ncr_tile_read *found)
{
    array_source *s = user;
    atomic_fetch_add(&s->reads, 1);
    if (part->point == s->fails_at)
        return NCR_E_IO;
    const size_t first = ncr_tile_number(s->n, part->point, part->face, part->x, part->y);
    const size_t last = ncr_tile_number(s->n, part->point, part->face, part->x + part->width - 1,
                                        part->y + part->height - 1);
    if (first != last || part->x + part->width > s->n || part->y + part->height > s->n)
        abort();
    found->captured = !is_hole(s, part->point, part->face, part->x, part->y);
    found->bytes = 10 * part->width * part->height;
    if (found->captured)
        fill_part(part, rgb, z);
    return NCR_OK;
}

static ncr_lightfield *in_memory(const array_source *s, uint32_t points,
                                 const ncr_lightfield_opts *opts)
{
    ncr_lightfield *field;
    CHECK_STATUS(NCR_OK, ncr_lightfield_create(NULL, points, s->n, opts, &field));
    const ncr_tile_sink sink = ncr_lightfield_sink(field);
    float rgb[3 * 64 * 64], z[64 * 64];
    for (uint32_t cube = 0; cube < 6 * points; cube++)
        for (uint32_t y = 0; y < s->n; y += 64)
            for (uint32_t x = 0; x < s->n; x += 64) {
                ncr_tile t = {.point = cube / 6, .face = cube % 6, .x = x, .y = y};
                t.width = s->n - x < 64 ? s->n - x : 64;
                t.height = s->n - y < 64 ? s->n - y : 64;
                t.rgb = rgb;
                t.z = opts->depth ? z : NULL;
                fill_part(&t, rgb, z);
                if (!is_hole(s, t.point, t.face, x, y))
                    CHECK_STATUS(NCR_OK, sink.write(sink.user, &t));
            }
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, field));
    return field;
}

enum { field_points = 9, rows = 1300 };

typedef struct look_ups {
    float d[3][rows], w[4][rows];
    uint16_t point[4][rows];
} look_ups;

static void make_look_ups(check_random *r, look_ups *l)
{
    for (int k = 0; k < rows; k++) {
        for (int c = 0; c < 3; c++)
            l->d[c][k] = (float)check_uniform(r, -1, 1);
        if (k % 11 == 0)
            l->d[k % 3][k] = l->d[(k + 1) % 3][k]; /* on an edge */
        for (int j = 0; j < 4; j++) {
            const double x = check_uniform(r, 0, 1);
            l->point[j][k] = x < .1 ? NCR_NO_POINT : (uint16_t)check_uniform(r, 0, field_points);
            l->w[j][k] = x > .8 ? 0 : (float)check_uniform(r, 0, 1);
        }
    }
}

typedef struct answers {
    float rgb[3][rows], blend[3][rows];
    size_t trapped[2];
} answers;

static void look(const ncr_lightfield *field, const look_ups *l, answers *out)
{
    memset(out, 0, sizeof *out);
    const float *const d[3] = {l->d[0], l->d[1], l->d[2]};
    out->trapped[0] =
        ncr_lightfield_accumulate(field, rows, l->point[0], d, l->w[0],
                                  (float *const[]){out->rgb[0], out->rgb[1], out->rgb[2]});
    out->trapped[1] = ncr_lightfield_blend(
        field, rows, 4,
        (const uint16_t *const[]){l->point[0], l->point[1], l->point[2], l->point[3]},
        (const float *const[]){l->w[0], l->w[1], l->w[2], l->w[3]}, d,
        (float *const[]){out->blend[0], out->blend[1], out->blend[2]});
}

/* What one face takes in memory, by asking for less. */
static size_t least_budget(const array_source *s, const ncr_lightfield_opts *opts)
{
    const ncr_tile_source source = {(void *)s, read_part};
    size_t budget = 0;
    for (ncr_status status = NCR_E_LIMIT; status == NCR_E_LIMIT; budget += 500) {
        ncr_lightfield *field;
        status = ncr_lightfield_stream(NULL, field_points, s->n, opts, &source, budget, &field);
        ncr_lightfield_destroy(NULL, field);
    }
    return budget - 500;
}

static void expect_single_look_ups(const ncr_lightfield *a, const ncr_lightfield *b,
                                   const look_ups *l)
{
    const uint32_t n = ncr_lightfield_resolution(a);
    const uint64_t missed = ncr_lightfield_missed_distances(b);
    for (uint32_t k = 0; k < 100; k++) {
        const ncr_vec3 d = {l->d[0][k], l->d[1][k], l->d[2][k]};
        const uint32_t p = k % field_points;
        const ncr_vec3 x = ncr_lightfield_fetch(a, p, d), y = ncr_lightfield_fetch(b, p, d);
        assert_memory_equal(&x, &y, sizeof x);
        float one[3], two[3], z1 = -1, z2 = -1;
        ncr_lightfield_texel(a, p, k % 6, k * 7 % n, k * 3 % n, one, &z1);
        ncr_lightfield_texel(b, p, k % 6, k * 7 % n, k * 3 % n, two, &z2);
        assert_memory_equal(one, two, sizeof one);
        assert_true(z1 == z2);
        assert_true(ncr_lightfield_has_depth(a) == ncr_lightfield_has_depth(b));
        if (ncr_lightfield_has_depth(a))
            assert_true(ncr_lightfield_distance(a, p, d) == ncr_lightfield_distance(b, p, d));
    }
    assert_int_equal(ncr_lightfield_has_depth(b) ? 0 : 100,
                     ncr_lightfield_missed_distances(b) - missed);
}

static void streamed_light_is_that_in_memory_to_the_bit(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 2, 8, 63, 64, 65, 100, 128, 130};
    check_random r = {.seed = 6};
    static look_ups l;
    static answers expected, got;
    for (int k = 0; k < 18; k++) {
        array_source s = {.n = sizes[k % 9], .holes = k % 2, .fails_at = UINT32_MAX};
        const ncr_lightfield_opts *opts =
            NCR_OPTS(ncr_lightfield_opts, .format = k < 9 ? NCR_TEXEL_HALF : NCR_TEXEL_FLOAT,
                     .depth = k % 3 == 0, .exponent = k % 4);
        ncr_lightfield *whole = in_memory(&s, field_points, opts), *field;
        make_look_ups(&r, &l);
        look(whole, &l, &expected);
        assert_true(!s.holes || expected.trapped[0] > 0);
        const size_t least = least_budget(&s, opts);
        for (int size = 0; size < 3; size++) {
            const ncr_tile_source source = {&s, read_part};
            CHECK_STATUS(NCR_OK, ncr_lightfield_stream(NULL, field_points, s.n, opts, &source,
                                                       least << 2 * size, &field));
            assert_true(ncr_lightfield_count(field).bytes <= least << 2 * size);
            assert_int_equal(ncr_lightfield_bytes(field), ncr_lightfield_bytes(whole));
            look(field, &l, &got);
            CHECK(!memcmp(&expected, &got, sizeof got), "n = %u, case %d", s.n, k);
            expect_single_look_ups(whole, field, &l);
            CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, field));
            CHECK_STATUS(NCR_OK, ncr_lightfield_status(field));
            const ncr_lightfield_traffic t = ncr_lightfield_count(field);
            assert_true(t.misses > 0 && t.bytes_read > 0 && t.faces >= 1);
            ncr_lightfield_destroy(NULL, field);
        }
        assert_int_equal(ncr_lightfield_count(whole).misses, 0);
        CHECK_STATUS(NCR_OK, ncr_lightfield_status(whole));
        ncr_lightfield_destroy(NULL, whole);
    }
}

/* Look-ups of a call that jump about between all faces read each face once, with room for one. */
static void look_ups_of_a_call_are_sorted_by_face(void **state)
{
    (void)state;
    array_source s = {.n = 8, .fails_at = UINT32_MAX};
    const ncr_tile_source source = {&s, read_part};
    const ncr_lightfield_opts *opts = NCR_OPTS(ncr_lightfield_opts, .depth = false);
    ncr_lightfield *field;
    static look_ups l;
    static answers got;
    check_random r = {.seed = 7};
    make_look_ups(&r, &l);
    CHECK_STATUS(NCR_OK, ncr_lightfield_stream(NULL, field_points, 8, opts, &source,
                                               least_budget(&s, opts), &field));
    assert_int_equal(ncr_lightfield_count(field).faces, 1);
    const float *const d[3] = {l.d[0], l.d[1], l.d[2]};
    ncr_lightfield_accumulate(field, 1000, l.point[0], d, l.w[0],
                              (float *const[]){got.rgb[0], got.rgb[1], got.rgb[2]});
    assert_int_equal(ncr_lightfield_count(field).misses, 6 * field_points);
    assert_int_equal(ncr_lightfield_count(field).hits, 0);
    ncr_lightfield_destroy(NULL, field);
}

typedef struct many_looks {
    const ncr_lightfield *field;
    const look_ups *l;
    const answers *expected;
} many_looks;

static void *look_often(void *arg)
{
    const many_looks *m = arg;
    answers *got = malloc(sizeof *got);
    bool wrong = false;
    for (int k = 0; k < 2; k++) {
        look(m->field, m->l, got);
        wrong |= memcmp(got, m->expected, sizeof *got) != 0;
    }
    free(got);
    return wrong ? arg : NULL;
}

static void threads_see_the_same_light(void **state)
{
    (void)state;
    array_source s = {.n = 100, .holes = true, .fails_at = UINT32_MAX};
    const ncr_tile_source source = {&s, read_part};
    const ncr_lightfield_opts *opts = NCR_OPTS(ncr_lightfield_opts, .depth = false);
    static look_ups l;
    static answers expected;
    check_random r = {.seed = 8};
    make_look_ups(&r, &l);
    ncr_lightfield *whole = in_memory(&s, field_points, opts), *field;
    look(whole, &l, &expected);
    for (size_t room = 1; room < 30; room += 13) {
        CHECK_STATUS(NCR_OK, ncr_lightfield_stream(NULL, field_points, s.n, opts, &source,
                                                   room * least_budget(&s, opts), &field));
        many_looks m = {.field = field, .l = &l, .expected = &expected};
        pthread_t thread[5];
        for (int k = 0; k < 5; k++)
            assert_int_equal(pthread_create(&thread[k], NULL, look_often, &m), 0);
        for (int k = 0; k < 5; k++) {
            void *wrong = NULL;
            pthread_join(thread[k], &wrong);
            assert_null(wrong);
        }
        ncr_lightfield_destroy(NULL, field);
    }
    ncr_lightfield_destroy(NULL, whole);
}

static void a_source_that_fails_is_reported(void **state)
{
    (void)state;
    array_source s = {.n = 8, .fails_at = 4};
    const ncr_tile_source source = {&s, read_part};
    ncr_lightfield *field;
    CHECK_STATUS(NCR_OK,
                 ncr_lightfield_stream(NULL, field_points, 8, NULL, &source, 1 << 20, &field));
    const ncr_vec3 d = {1, 0, 0};
    const ncr_vec3 good = ncr_lightfield_fetch(field, 3, d);
    assert_true(good.x > 0);
    CHECK_STATUS(NCR_OK, ncr_lightfield_status(field));
    const ncr_vec3 none = ncr_lightfield_fetch(field, 4, d);
    assert_true(none.x == 0 && none.y == 0 && none.z == 0);
    CHECK_STATUS(NCR_E_IO, ncr_lightfield_status(field));
    const unsigned reads = atomic_load(&s.reads);
    static look_ups l;
    static answers got;
    check_random r = {.seed = 9};
    make_look_ups(&r, &l);
    look(field, &l, &got);
    assert_true(got.trapped[0] > 1000);
    assert_int_equal(atomic_load(&s.reads), reads); /* nothing more is tried */
    CHECK_STATUS(NCR_E_IO, ncr_lightfield_status(field));
    ncr_lightfield_destroy(NULL, field);
}

static void wrong_requests_are_refused(void **state)
{
    (void)state;
    array_source s = {.n = 8};
    const ncr_tile_source source = {&s, read_part};
    ncr_lightfield *field = (ncr_lightfield *)&s;
    CHECK_STATUS(NCR_E_LIMIT, ncr_lightfield_stream(&files_ctx, 9, 8, NULL, &source, 100, &field));
    assert_null(field);
    assert_non_null(strstr(files_report, "100 bytes of memory are too few"));
    CHECK_STATUS(NCR_E_ARG, ncr_lightfield_stream(NULL, 0, 8, NULL, &source, 1 << 20, &field));
    CHECK_STATUS(NCR_E_ARG, ncr_lightfield_stream(NULL, 1, 5000, NULL, &source, 1 << 20, &field));
    CHECK_STATUS(NCR_OK, ncr_lightfield_stream(NULL, 1, 8, NULL, &source, 1 << 20, &field));
    const float rgb[3] = {0};
    const ncr_tile tile = {.width = 1, .height = 1, .rgb = rgb};
    const ncr_tile_sink sink = ncr_lightfield_sink(field);
    CHECK_STATUS(NCR_E_ARG, sink.write(sink.user, &tile));
    ncr_lightfield_destroy(NULL, field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cyclic_scan_one_too_long_misses_always),
        cmocka_unit_test(misses_are_those_of_the_stack_at_every_size),
        cmocka_unit_test(threads_share_any_number_of_slots),
        cmocka_unit_test(the_budget_is_kept_to_the_byte),
        cmocka_unit_test(a_cache_that_gets_no_memory_leaks_none),
        cmocka_unit_test(streamed_light_is_that_in_memory_to_the_bit),
        cmocka_unit_test(look_ups_of_a_call_are_sorted_by_face),
        cmocka_unit_test(threads_see_the_same_light),
        cmocka_unit_test(a_source_that_fails_is_reported),
        cmocka_unit_test(wrong_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
