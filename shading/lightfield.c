/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE /* madvise */
#include "shading/lightfield.h"

#include "core/half.h"
#include "shading/cube.h"
#include "shading/lightfield_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* This file follows:
 *   [H 2.4]   W. Heidrich. Environment Maps And Their Applications, 2000 */

static const float half_max = 65504.0f;

/* Zeros in large pages where the system has them: a field is hundreds of megabytes, in which
 * look-ups jump about. Up to twice the rate on processors with few entries for pages, and far
 * fewer faults while it is filled. */
static void *alloc_texels(const ncr_ctx *ctx, size_t count, size_t size)
{
    if (count > SIZE_MAX / size)
        return NULL;
    void *texels = ncr_alloc(ctx, count * size);
    if (!texels)
        return NULL;
#ifdef MADV_HUGEPAGE
    const uintptr_t page = 4096, begin = ((uintptr_t)texels + page - 1) & ~(page - 1);
    const uintptr_t end = ((uintptr_t)texels + count * size) & ~(page - 1);
    if (end > begin)
        (void)madvise((void *)begin, end - begin, MADV_HUGEPAGE); /* a wish: failure is harmless */
#endif
    return memset(texels, 0, count * size);
}

/* Addresses run in 64 bits: 65535 points of 4096 texels exceed 32 by far; what does not fit into
 * memory is the allocator's to refuse. */
static ncr_status allocate(const ncr_ctx *ctx, ncr_lightfield *field)
{
    const size_t texels = field->points * field->point_texels;
    field->texels = alloc_texels(ctx, texels, ncr_texel_bytes(field->format));
    if (!field->texels)
        return NCR_E_NOMEM;
    if (!field->has_depth)
        return NCR_OK;
    field->depth =
        ncr_alloc_zero(ctx, (size_t)field->points * 6 * field->n * field->n, sizeof(float));
    return field->depth ? NCR_OK : NCR_E_NOMEM;
}

ncr_status ncr_lightfield_begin(const ncr_ctx *ctx, uint32_t points, uint32_t n,
                                const ncr_lightfield_opts *opts, ncr_lightfield **out)
{
    *out = NULL;
    const ncr_lightfield_opts o = opts ? *opts : (ncr_lightfield_opts){.struct_size = sizeof o};
    if (o.struct_size != sizeof o)
        return ncr_fail(ctx, NCR_E_ARG, "light field options were not initialised");
    if (points == 0 || n == 0 || n > NCR_CUBE_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "a light field of %u points and %u texels per side", points,
                        n);
    if (o.format != NCR_TEXEL_HALF && o.format != NCR_TEXEL_FLOAT)
        return ncr_fail(ctx, NCR_E_ARG, "texel format %d does not exist", (int)o.format);
    if (abs(o.exponent) > 64)
        return ncr_fail(ctx, NCR_E_ARG, "radiance scaled by 2^%d, beyond 2^64", o.exponent);

    ncr_lightfield *field = ncr_alloc_zero(ctx, 1, sizeof *field);
    if (!field)
        return NCR_E_NOMEM;
    field->points = points;
    field->n = n;
    field->format = o.format;
    field->scale = ldexpf(1, o.exponent);
    field->row = (size_t)n + 2;
    field->face_texels = field->row * field->row;
    field->point_texels = 6 * field->face_texels;
    field->has_depth = o.depth;
    field->bytes = points * field->point_texels * ncr_texel_bytes(field->format);
    if (o.depth)
        field->bytes += (size_t)points * 6 * n * n * sizeof(float);
    *out = field;
    return NCR_OK;
}

ncr_status ncr_lightfield_create(const ncr_ctx *ctx, uint32_t points, uint32_t n,
                                 const ncr_lightfield_opts *opts, ncr_lightfield **out)
{
    ncr_lightfield *field;
    ncr_status status = ncr_lightfield_begin(ctx, points, n, opts, &field);
    *out = NULL;
    if (status == NCR_OK)
        status = allocate(ctx, field);
    if (status == NCR_OK)
        *out = field;
    else
        ncr_lightfield_destroy(ctx, field);
    return status;
}

void ncr_lightfield_destroy(const ncr_ctx *ctx, ncr_lightfield *field)
{
    if (!field)
        return;
    ncr_stream_destroy(ctx, field->stream);
    ncr_free(ctx, field->texels);
    ncr_free(ctx, field->depth);
    ncr_free(ctx, field);
}

uint32_t ncr_lightfield_points(const ncr_lightfield *field)
{
    return field->points;
}

uint32_t ncr_lightfield_resolution(const ncr_lightfield *field)
{
    return field->n;
}

bool ncr_lightfield_has_depth(const ncr_lightfield *field)
{
    return field->has_depth;
}

size_t ncr_lightfield_bytes(const ncr_lightfield *field)
{
    return field->bytes;
}

uint64_t ncr_lightfield_overflows(const ncr_lightfield *field)
{
    return atomic_load(&field->overflows);
}

uint64_t ncr_lightfield_missed_distances(const ncr_lightfield *field)
{
    return atomic_load(&field->missed_distances);
}

static float missed_distance(const ncr_lightfield *field)
{
    atomic_fetch_add(&((ncr_lightfield *)field)->missed_distances, 1); /* no field is made const */
    return 0;
}

/* Index of a texel; x and y may be -1 or n, the apron. */
static size_t texel_index(const ncr_lightfield *field, uint32_t point, uint32_t face, int x, int y)
{
    const size_t in_face = (size_t)(y + 1) * field->row + (size_t)(x + 1);
    return point * field->point_texels + face * field->face_texels + in_face;
}

static size_t depth_index(const ncr_lightfield *field, uint32_t point, uint32_t face, uint32_t x,
                          uint32_t y)
{
    return (((size_t)point * 6 + face) * field->n + y) * field->n + x;
}

uint64_t ncr_lightfield_store_row(const ncr_lightfield *field, void *to, uint32_t width,
                                  const float *rgb)
{
    const float down = 1 / field->scale; /* exact: a power of two */
    if (field->format == NCR_TEXEL_FLOAT) {
        float *out = to;
        for (uint32_t k = 0; k < width; k++, out += 4, rgb += 3) {
            for (int c = 0; c < 3; c++)
                out[c] = rgb[c] * down;
            out[3] = 1;
        }
        return 0;
    }

    uint16_t *out = to;
    uint64_t clamped = 0;
    float texel[4 * NCR_TILE_SIDE];
    for (uint32_t done = 0; done < width; done += NCR_TILE_SIDE) {
        const uint32_t count = width - done < NCR_TILE_SIDE ? width - done : NCR_TILE_SIDE;
        for (uint32_t k = 0; k < count; k++, rgb += 3) {
            for (int c = 0; c < 3; c++) {
                const float value = rgb[c] * down;
                clamped += value > half_max;
                texel[4 * k + (uint32_t)c] = value > half_max ? half_max : value;
            }
            texel[4 * k + 3] = 1;
        }
        ncr_half_from_floats(4 * (size_t)count, texel, out + 4 * (size_t)done);
    }
    return clamped;
}

static bool tile_fits(const ncr_lightfield *field, const ncr_tile *tile)
{
    return field->texels && tile->point < field->points && tile->face < 6 && tile->x < field->n &&
           tile->y < field->n && tile->width <= field->n - tile->x &&
           tile->height <= field->n - tile->y && tile->rgb && (!field->depth || tile->z);
}

/* Tiles do not overlap and each comes once, so writers share nothing but the counter. */
static ncr_status write_tile(void *user, const ncr_tile *tile)
{
    ncr_lightfield *field = user;
    if (!tile_fits(field, tile))
        return NCR_E_ARG;

    uint64_t clamped = 0;
    for (uint32_t j = 0; j < tile->height; j++) {
        const size_t at =
            texel_index(field, tile->point, tile->face, (int)tile->x, (int)(tile->y + j));
        clamped += ncr_lightfield_store_row(
            field, (char *)field->texels + at * ncr_texel_bytes(field->format), tile->width,
            tile->rgb + 3 * (size_t)j * tile->width);
        if (field->depth)
            memcpy(field->depth + depth_index(field, tile->point, tile->face, tile->x, tile->y + j),
                   tile->z + (size_t)j * tile->width, tile->width * sizeof(float));
    }
    if (clamped)
        atomic_fetch_add(&field->overflows, clamped);
    return NCR_OK;
}

ncr_tile_sink ncr_lightfield_sink(ncr_lightfield *field)
{
    return (ncr_tile_sink){.user = field, .write = write_tile};
}

static void load(const ncr_lightfield *field, const void *texels, size_t index, float texel[4])
{
    if (field->format == NCR_TEXEL_FLOAT)
        memcpy(texel, (const float *)texels + 4 * index, 4 * sizeof(float));
    else
        for (size_t c = 0; c < 4; c++)
            texel[c] = ncr_half_to_float(((const uint16_t *)texels)[4 * index + c]);
}

static void store(const ncr_lightfield *field, void *texels, size_t index, const float texel[4])
{
    if (field->format == NCR_TEXEL_FLOAT)
        memcpy((float *)texels + 4 * index, texel, 4 * sizeof(float));
    else
        for (size_t c = 0; c < 4; c++)
            ((uint16_t *)texels)[4 * index + c] = ncr_half_from_float(texel[c]);
}

/* The texel that lies over the edge of a face at (x,y), one of which is -1 or n. The apron's centre is half a texel beyond the edge, (major, beyond) = (1, 1 + 1/n);
 * folding it about the edge onto the neighbour, (1 - 1/n, 1), meets that face's border texel. */
ncr_texel_place ncr_lightfield_over_the_edge(uint32_t side, uint32_t face, int x, int y)
{
    const int n = (int)side;
    const float inward = 1.0f - 1.0f / (float)n;
    const float s = x < 0 ? -1.0f : x == n ? 1.0f : (2.0f * (float)x + 1.0f) / (float)n - 1.0f;
    const float t = y < 0 ? -1.0f : y == n ? 1.0f : (2.0f * (float)y + 1.0f) / (float)n - 1.0f;

    ncr_vec3 d = ncr_cube_to_direction(face, s, t);
    float *component[3] = {&d.x, &d.y, &d.z};
    *component[face / 2] *= inward;

    const ncr_cube_coord c = ncr_cube_from_direction(d);
    const int cx = (int)((c.s + 1.0f) * 0.5f * (float)n);
    const int cy = (int)((c.t + 1.0f) * 0.5f * (float)n);
    return (ncr_texel_place){c.face, cx < n ? cx : n - 1, cy < n ? cy : n - 1};
}

/* A corner of the cube belongs to three faces: (x,y) is the apron's corner, whose neighbours in
 * the apron already hold the other two. The mean makes all three faces agree at the corner. */
static void seal_corner(const ncr_lightfield *field, void *face, int x, int y)
{
    const int n = (int)field->n, ix = x < 0 ? 0 : n - 1, iy = y < 0 ? 0 : n - 1;
    float a[4], b[4], c[4], mean[4];
    load(field, face, texel_index(field, 0, 0, ix, iy), a);
    load(field, face, texel_index(field, 0, 0, x, iy), b);
    load(field, face, texel_index(field, 0, 0, ix, y), c);
    for (int k = 0; k < 4; k++)
        mean[k] = (float)(((double)a[k] + b[k] + c[k]) / 3.0);
    store(field, face, texel_index(field, 0, 0, x, y), mean);
}

void ncr_lightfield_seal_corners(const ncr_lightfield *field, void *face)
{
    const int n = (int)field->n;
    for (int corner = 0; corner < 4; corner++)
        seal_corner(field, face, corner & 1 ? n : -1, corner & 2 ? n : -1);
}

typedef struct seal_job {
    ncr_lightfield *field;
    size_t *source; /* [6][4][n] texels that lie over each edge: the same for every point */
} seal_job;

void ncr_lightfield_edge_texel(int n, int edge, int k, int *x, int *y)
{
    *x = edge == 0 ? -1 : edge == 1 ? n : k;
    *y = edge == 2 ? -1 : edge == 3 ? n : k;
}

static void seal_points(size_t begin, size_t end, unsigned worker, void *arg)
{
    (void)worker;
    const seal_job *job = arg;
    ncr_lightfield *field = job->field;
    const int n = (int)field->n;
    const size_t size = ncr_texel_bytes(field->format);

    for (size_t point = begin; point < end; point++) {
        char *texels = (char *)field->texels + point * field->point_texels * size;
        const size_t *source = job->source;
        for (uint32_t face = 0; face < 6; face++) {
            for (int edge = 0; edge < 4; edge++)
                for (int k = 0, x, y; k < n; k++) {
                    ncr_lightfield_edge_texel(n, edge, k, &x, &y);
                    memcpy(texels + texel_index(field, 0, face, x, y) * size,
                           texels + *source++ * size, size);
                }
            ncr_lightfield_seal_corners(field, texels + face * field->face_texels * size);
        }
    }
}

ncr_status ncr_lightfield_seal(const ncr_ctx *ctx, ncr_lightfield *field)
{
    if (field->stream)
        return NCR_OK; /* each face is sealed when it is read */
    const int n = (int)field->n;
    size_t *source = ncr_alloc(ctx, 24 * (size_t)n * sizeof *source);
    if (!source)
        return NCR_E_NOMEM;

    size_t *at = source;
    for (uint32_t face = 0; face < 6; face++)
        for (int edge = 0; edge < 4; edge++)
            for (int k = 0, x, y; k < n; k++) {
                ncr_lightfield_edge_texel(n, edge, k, &x, &y);
                const ncr_texel_place p = ncr_lightfield_over_the_edge(field->n, face, x, y);
                *at++ = texel_index(field, 0, p.face, p.x, p.y);
            }

    seal_job job = {field, source};
    const ncr_status status = ncr_parallel_for(ctx, field->points, 16, seal_points, &job);
    ncr_free(ctx, source);
    return status;
}

void ncr_lightfield_texel(const ncr_lightfield *field, uint32_t point, uint32_t face, uint32_t x,
                          uint32_t y, float rgb[3], float *z)
{
    assert(point < field->points && face < 6 && x < field->n && y < field->n);
    float texel[4];
    float *kept = field->has_depth ? z : NULL;
    if (field->stream)
        ncr_stream_texel(field, point, face, x, y, texel, kept);
    else
        load(field, field->texels, texel_index(field, point, face, (int)x, (int)y), texel);
    for (int c = 0; c < 3; c++)
        rgb[c] = texel[c] * field->scale;
    if (kept && !field->stream)
        *kept = field->depth[depth_index(field, point, face, x, y)];
    if (z && !kept)
        *z = missed_distance(field);
}

float ncr_lightfield_distance(const ncr_lightfield *field, uint32_t point, ncr_vec3 d)
{
    assert(point < field->points);
    if (!field->has_depth)
        return missed_distance(field);
    const ncr_cube_coord c = ncr_cube_from_direction(d);
    const float n = (float)field->n;
    const uint32_t x = (uint32_t)((c.s + 1.0f) * 0.5f * n), y = (uint32_t)((c.t + 1.0f) * 0.5f * n);
    const uint32_t last = field->n - 1, ix = x < last ? x : last, iy = y < last ? y : last;
    if (!field->stream)
        return field->depth[depth_index(field, point, c.face, ix, iy)];
    float texel[4], z = 0;
    ncr_stream_texel(field, point, c.face, ix, iy, texel, &z);
    return z;
}
