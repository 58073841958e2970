/* SPDX-License-Identifier: MIT
 * exr_none.c - what stands in for OpenEXR in a build without it: such files are refused. */
#include "io/field_radiance_internal.h"
#include "io/image_format_internal.h"

static ncr_status refuse(const ncr_ctx *ctx, const char *path)
{
    return ncr_fail(ctx, NCR_E_BACKEND, "%s: this build has no OpenEXR (NCR_WITH_OPENEXR is off)",
                    path);
}

ncr_status ncr_exr_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink)
{
    (void)sink;
    return refuse(ctx, path);
}

ncr_status ncr_exr_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                         const ncr_image_write_opts *opts)
{
    (void)rows, (void)opts;
    return refuse(ctx, path);
}

ncr_status ncr_exr_read_notes(const ncr_ctx *ctx, const char *path, ncr_image_notes *out)
{
    (void)out;
    return refuse(ctx, path);
}

ncr_status ncr_radiance_read(const ncr_ctx *ctx, const char *path,
                             const ncr_field_manifest *manifest, ncr_lightfield **out)
{
    (void)manifest;
    *out = NULL;
    return refuse(ctx, path);
}
