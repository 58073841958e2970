/* SPDX-License-Identifier: MIT */
#include "io/exr_stream_openexr_internal.h"
#include "io/image_format_internal.h"

#include <stdio.h>

ncr_status ncr_exr_read_notes(const ncr_ctx *ctx, const char *path, ncr_image_notes *out)
{
    ncr_exr_stream s;
    int32_t length = 0;
    const char *text = NULL;
    exr_envmap_t envmap;
    const ncr_status status = ncr_exr_stream_read(ctx, path, &s);
    if (status == NCR_OK) {
        if (exr_attr_get_string(s.exr, 0, "comments", &length, &text) == EXR_ERR_SUCCESS)
            snprintf(out->comment, sizeof out->comment, "%.*s", (int)length, text);
        if (exr_attr_get_envmap(s.exr, 0, "envmap", &envmap) == EXR_ERR_SUCCESS)
            out->envmap = envmap == EXR_ENVMAP_CUBE ? NCR_ENVMAP_CUBE : NCR_ENVMAP_LATLONG;
    }
    return ncr_exr_stream_close(&s, status);
}
