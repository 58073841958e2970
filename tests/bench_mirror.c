/* SPDX-License-Identifier: MIT
 * bench_mirror.c - look-ups and mirror shading beside their limit: a bare bilinear kernel that is
 * given every address, fraction and weight. Shading has a second limit: that kernel, and one pass
 * that only reads the G-buffer and the sample map and writes the image. Ratios are rate over rate,
 * from alternating runs. */
#include "tests/rig.h"

#include "core/cpu_internal.h"
#include "shading/lightfield_internal.h"

#include <immintrin.h>
#include <time.h>

enum { side = 512, points = 1156, cube = 64, pairs = 15 };

/* A look-up with nothing left to find out. */
typedef struct ready {
    const char *at;
    float fx, fy, w;
} ready;

#define TARGET __attribute__((target("avx512f,avx512dq,avx512vl,f16c,fma")))

TARGET static inline __m128 bilinear(const ready *r, size_t row, bool half)
{
    const void *a = r->at, *b = r->at + row;
    const __m256 top = half ? _mm256_cvtph_ps(_mm_loadu_si128(a)) : _mm256_loadu_ps(a);
    const __m256 bottom = half ? _mm256_cvtph_ps(_mm_loadu_si128(b)) : _mm256_loadu_ps(b);
    const __m256 mid = _mm256_fmadd_ps(_mm256_set1_ps(r->fy), _mm256_sub_ps(bottom, top), top);
    const __m128 left = _mm256_castps256_ps128(mid), right = _mm256_extractf128_ps(mid, 1);
    return _mm_fmadd_ps(_mm_set1_ps(r->fx), _mm_sub_ps(right, left), left);
}

/* out[k] = sum over `per` look-ups. */
TARGET static inline void limit(const ready *r, size_t count, unsigned per, size_t row, bool half,
                                float (*out)[4])
{
    for (size_t k = 0; k < count; k++) {
        __m128 sum = _mm_setzero_ps();
        for (unsigned j = 0; j < per; j++, r++)
            sum = _mm_fmadd_ps(_mm_set1_ps(r->w), bilinear(r, row, half), sum);
        _mm_storeu_ps(out[k], sum);
    }
}

TARGET static void limit_half_1(const ready *r, size_t n, size_t row, float (*out)[4])
{
    limit(r, n, 1, row, true, out);
}
TARGET static void limit_half_4(const ready *r, size_t n, size_t row, float (*out)[4])
{
    limit(r, n, 4, row, true, out);
}
TARGET static void limit_float_1(const ready *r, size_t n, size_t row, float (*out)[4])
{
    limit(r, n, 1, row, false, out);
}
TARGET static void limit_float_4(const ready *r, size_t n, size_t row, float (*out)[4])
{
    limit(r, n, 4, row, false, out);
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *x)
{
    qsort(x, pairs, sizeof *x, ascending);
    return x[pairs / 2];
}

static void wavy(const void *user, const double p[3], const double d[3], double rgb[3])
{
    (void)user;
    for (int c = 0; c < 3; c++)
        rgb[c] = 1 + 0.5 * d[c] / (fabs(d[0]) + fabs(d[1]) + fabs(d[2])) + 0.1 * p[c];
}

static ready make_ready(const ncr_lightfield *f, uint32_t point, ncr_vec3 d, float w)
{
    const ncr_footprint at = ncr_lightfield_footprint(f->n, d);
    const size_t texel = f->format == NCR_TEXEL_HALF ? 8 : 16;
    return (ready){(const char *)f->texels + texel * (point * f->point_texels + at.first), at.fx,
                   at.fy, w};
}

static void report(const char *name, double work, double *ours, double *theirs)
{
    double ratio[pairs];
    for (int k = 0; k < pairs; k++)
        ratio[k] = theirs[k] / ours[k];
    printf("%-28s %8.1f M/s   limit %8.1f M/s   ratio %.2f\n", name, work / median(ours) / 1e6,
           work / median(theirs) / 1e6, median(ratio));
}

static void bench_lookups(rig *r, bool coherent, const char *name)
{
    enum { count = 1 << 18 };
    const ncr_lightfield *f = r->light;
    float *d[3], *out[3], *w = malloc(count * sizeof *w);
    uint16_t *point = malloc(count * sizeof *point);
    ready *prepared = malloc(count * sizeof *prepared);
    float(*sink)[4] = malloc(count * sizeof *sink);
    for (int c = 0; c < 3; c++) {
        d[c] = malloc(count * sizeof **d);
        out[c] = calloc(count, sizeof **out);
    }
    check_random random = {.seed = 1};
    for (size_t k = 0; k < count; k++) {
        const double a = (double)(k % 512) / 512 - 0.5, b = (double)(k / 512) / 512 - 0.5;
        const bool near = coherent;
        d[0][k] = near ? 1 : (float)check_uniform(&random, -1, 1);
        d[1][k] = near ? (float)(3 * a) : (float)check_uniform(&random, -1, 1);
        d[2][k] = near ? (float)(3 * b) : (float)check_uniform(&random, -1, 1);
        point[k] = near ? 5 : (uint16_t)check_uniform(&random, 0, points);
        w[k] = 1;
        prepared[k] = make_ready(f, point[k], v_make(d[0][k], d[1][k], d[2][k]), 1);
    }
    const bool half = f->format == NCR_TEXEL_HALF;
    const size_t row = (half ? 8 : 16) * f->row;
    double ours[pairs], theirs[pairs];
    for (int k = -1; k < pairs; k++) {
        const double t0 = now();
        ncr_lightfield_accumulate(f, count, point, (const float *const[3]){d[0], d[1], d[2]}, w,
                                  (float *const[3]){out[0], out[1], out[2]});
        const double t1 = now();
        (half ? limit_half_1 : limit_float_1)(prepared, count, row, sink);
        const double t2 = now();
        if (k >= 0)
            ours[k] = t1 - t0, theirs[k] = t2 - t1;
    }
    report(name, count, ours, theirs);
    for (int c = 0; c < 3; c++) {
        free(d[c]);
        free(out[c]);
    }
    free(w), free(point), free(prepared), free(sink);
}

/* Read what shading reads, write what it writes, compute nothing. */
TARGET static void stream(const rig *r, float *image)
{
    const size_t count = (size_t)side * side;
    const float *in[] = {r->g.u,  r->g.v,  r->g.px, r->g.py, r->g.pz, r->g.nx,
                         r->g.ny, r->g.nz, r->g.vx, r->g.vy, r->g.vz};
    const uint32_t *patch = r->g.patch, *object = r->g.object;
    for (size_t k = 0; k < count; k += 16) {
        __m512 sum = _mm512_castsi512_ps(
            _mm512_xor_si512(_mm512_loadu_si512(patch + k), _mm512_loadu_si512(object + k)));
        for (size_t a = 0; a < sizeof in / sizeof *in; a++)
            sum = _mm512_xor_ps(sum, _mm512_loadu_ps(in[a] + k));
        for (size_t a = 0; a < 64; a += 32)
            sum = _mm512_xor_ps(sum,
                                _mm512_castsi512_ps(_mm512_loadu_si512(r->map.index + 4 * k + a)));
        for (size_t a = 0; a < 48; a += 16)
            _mm512_storeu_ps(image + 3 * k + a, sum);
    }
}

static void bench_mirror(rig *r, const char *method, const char *name)
{
    const ncr_lightfield *f = r->light;
    ready *prepared = malloc((size_t)side * side * 4 * sizeof *prepared);
    float(*sink)[4] = malloc((size_t)side * side * sizeof *sink);
    size_t count = 0;
    for (size_t k = 0; k < (size_t)side * side; k++) {
        if (r->g.object[k] == NCR_NONE)
            continue;
        const ncr_vec3 v = v_make(r->g.vx[k], r->g.vy[k], r->g.vz[k]);
        const ncr_vec3 d = v_reflect(rig_n(r, k), v);
        for (size_t j = 0; j < 4; j++)
            prepared[4 * count + j] = make_ready(f, r->map.index[4 * k + j], d, 0.25f);
        count++;
    }
    const bool half = f->format == NCR_TEXEL_HALF;
    const size_t row = (half ? 8 : 16) * f->row;
    double ours[pairs], theirs[pairs], both[pairs];
    ncr_method m;
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, method, &m));
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, side, side, 3, &image));
    for (int k = -1; k < pairs; k++) {
        const double t0 = now();
        CHECK_STATUS(NCR_OK, ncr_method_shade(NULL, &m, NCR_TERM_REFLECT, NULL, NULL, &r->in, &r->g,
                                              &image, NULL));
        const double t1 = now();
        (half ? limit_half_4 : limit_float_4)(prepared, count, row, sink);
        const double t2 = now();
        stream(r, image.data);
        const double t3 = now();
        if (k >= 0)
            ours[k] = t1 - t0, theirs[k] = t2 - t1, both[k] = t3 - t1;
    }
    double copy[pairs];
    memcpy(copy, ours, sizeof copy);
    report(name, (double)count, ours, theirs);
    report("    and memory", (double)count, copy, both);
    ncr_image_dispose(NULL, &image);
    free(prepared), free(sink);
}

static void bench_all(void **state)
{
    (void)state;
    for (int format = 0; format < 2; format++) {
        const char *kind = format ? "float" : "half";
        char name[64];
        rig r;
        rig_sphere(&r, side, 0.3, points, 0.03);
        rig_light_up(&r, cube, (ncr_texel_format)format, (rig_light){wavy, NULL});
        for (int coherent = 1; coherent >= 0; coherent--) {
            snprintf(name, sizeof name, "look-up %s %s", kind, coherent ? "coherent" : "random");
            bench_lookups(&r, coherent, name);
        }
        const char *const methods[] = {"cosine-n:4", "cosine-r:4", "average", "distance"};
        for (int k = 0; k < 4; k++) {
            snprintf(name, sizeof name, "mirror %s %s", kind, methods[k]);
            bench_mirror(&r, methods[k], name);
        }
        rig_dispose(&r);
    }
}

int main(void)
{
    if (ncr_cpu_level() < NCR_CPU_AVX512) {
        puts("the limit kernel needs AVX-512");
        return 0;
    }
    const struct CMUnitTest tests[] = {cmocka_unit_test(bench_all)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
