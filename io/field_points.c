/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"
#include "io/field_internal.h"

#include <math.h>
#include <string.h>

/* A header that any PLY reader knows; ours knows only this one. */
static const char head[] = "ply\n"
                           "format binary_little_endian 1.0\n"
                           "comment nacre field points 1, model units\n"
                           "element vertex ";
static const char tail[] = "\nproperty double x\nproperty double y\nproperty double z\n"
                           "property double nx\nproperty double ny\nproperty double nz\n"
                           "property uint patch\nproperty double u\nproperty double v\n"
                           "property double epsilon\nproperty double clearance\nend_header\n";

enum { record_bytes = 6 * 8 + 4 + 4 * 8 };

static void pack(const ncr_point *p, uint8_t out[record_bytes])
{
    const double last[] = {p->u, p->v, p->epsilon, p->clearance};
    memcpy(out, p->position, 24);
    memcpy(out + 24, p->normal, 24);
    memcpy(out + 48, &p->patch, 4);
    memcpy(out + 52, last, 32);
}

static void unpack(const uint8_t in[record_bytes], ncr_point *p)
{
    double last[4];
    memcpy(p->position, in, 24);
    memcpy(p->normal, in + 24, 24);
    memcpy(&p->patch, in + 48, 4);
    memcpy(last, in + 52, 32);
    p->u = last[0];
    p->v = last[1];
    p->epsilon = last[2];
    p->clearance = last[3];
}

/* The first thing wrong with a point, or NULL. */
static const char *fault(const ncr_point *p, uint32_t patches)
{
    const double *n = p->normal, *x = p->position;
    const double length = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
        return "position is not finite";
    if (!(fabs(length - 1) <= 1e-6))
        return "normal is not of unit length";
    if (p->patch >= patches)
        return "patch is out of range";
    if (!(p->u >= 0 && p->u <= 1 && p->v >= 0 && p->v <= 1))
        return "(u,v) is outside [0,1]";
    if (!(p->epsilon >= 0 && isfinite(p->epsilon)))
        return "epsilon is not a finite length";
    return p->clearance >= 0 ? NULL : "clearance is not a length";
}

ncr_status ncr_field_points_write(const ncr_ctx *ctx, const char *path, const ncr_points *points)
{
    ncr_atomic_file file;
    const ncr_status status = ncr_atomic_file_open(ctx, path, &file);
    if (status != NCR_OK)
        return status;
    fprintf(file.stream, "%s%zu%s", head, points->count, tail);
    for (size_t k = 0; k < points->count; k++) {
        uint8_t record[record_bytes];
        pack(&points->at[k], record);
        fwrite(record, sizeof record, 1, file.stream);
    }
    return ncr_atomic_file_commit(ctx, &file);
}

static ncr_status read_records(const ncr_ctx *ctx, const char *path, const uint8_t *in,
                               uint32_t count, uint32_t patches, ncr_points *out)
{
    ncr_points points = {.count = count, .at = ncr_alloc(ctx, count * sizeof *points.at)};
    if (!points.at)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < count; k++) {
        unpack(in + (size_t)k * record_bytes, &points.at[k]);
        const char *wrong = fault(&points.at[k], patches);
        if (wrong) {
            ncr_points_dispose(ctx, &points);
            return ncr_fail(ctx, NCR_E_FORMAT, "%s: point %u: its %s", path, k, wrong);
        }
    }
    *out = points;
    return NCR_OK;
}

ncr_status ncr_field_points_read(const ncr_ctx *ctx, const char *path, uint32_t count,
                                 uint32_t patches, ncr_points *out)
{
    char expected[sizeof head + sizeof tail + 16];
    const int n = snprintf(expected, sizeof expected, "%s%u%s", head, count, tail);
    const size_t header = (size_t)n, size_expected = header + (size_t)count * record_bytes;
    uint8_t *data;
    size_t size;
    ncr_status status = ncr_file_read(ctx, path, SIZE_MAX, &data, &size);
    if (status != NCR_OK)
        return status;
    if (size < header || memcmp(data, expected, header) != 0)
        status = ncr_fail(ctx, NCR_E_FORMAT, "%s: is not a PLY file of %u points of a field", path,
                          count);
    else if (size != size_expected)
        status = ncr_fail(ctx, NCR_E_FORMAT, "%s: has %zu bytes, %u points take %zu", path, size,
                          count, size_expected);
    else
        status = read_records(ctx, path, data + header, count, patches, out);
    ncr_free(ctx, data);
    return status;
}
