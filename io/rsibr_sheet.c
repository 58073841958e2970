/* SPDX-License-Identifier: MIT */
#include "io/rsibr_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

const char ncr_rsibr_format[] = "nacre.rsibr/1";
const char *const ncr_rsibr_kinds[6] = {"mirror", "phong", "gloss", "lambert", "coated", "brushed"};
const char *const ncr_rsibr_facets[2] = {"ggx", "beckmann"};
const char *const ncr_rsibr_shadowings[2] = {"smith", "v-cavity"};

const char *ncr_rsibr_kind_name(ncr_rsibr_kind kind)
{
    return ncr_rsibr_kinds[kind];
}

ncr_status ncr_rsibr_join(const ncr_ctx *ctx, const char *folder, const char *name,
                          ncr_rsibr_path *out)
{
    const int length = snprintf(out->text, sizeof out->text, "%s/%s", folder, name);
    return length < (int)sizeof out->text ? NCR_OK
                                          : ncr_fail(ctx, NCR_E_ARG, "a path of %d bytes", length);
}

static uint32_t columns_of(const ncr_rsibr *set)
{
    return (uint32_t)ceil(sqrt(set->sphere.view_count));
}

ncr_status ncr_rsibr_sheet_init(const ncr_ctx *ctx, const ncr_rsibr *set, ncr_image *out)
{
    const uint32_t columns = columns_of(set);
    const uint32_t rows = (set->sphere.view_count + columns - 1) / columns;
    return ncr_image_init(ctx, columns * set->size, rows * set->size, 3, out);
}

void ncr_rsibr_sheet_copy(const ncr_rsibr *set, uint32_t map, bool from_sheet, ncr_image *sheet)
{
    const uint32_t n = set->size, columns = columns_of(set);
    const size_t bytes = (size_t)n * 3 * sizeof(float);
    for (uint32_t view = 0; view < set->sphere.view_count; view++)
        for (uint32_t y = 0; y < n; y++) {
            float *row = ncr_rsibr_map(set, map, view) + (size_t)y * n * 3;
            float *at = ncr_image_at(sheet, view % columns * n, view / columns * n + y);
            if (from_sheet)
                memcpy(row, at, bytes);
            else
                memcpy(at, row, bytes);
        }
}

uint32_t ncr_rsibr_sheet_crc(const ncr_image *sheet)
{
    uLong crc = crc32(0, Z_NULL, 0);
    for (uint32_t y = 0; y < sheet->height; y++)
        crc = crc32(crc, (const Bytef *)ncr_image_at(sheet, 0, y),
                    (uInt)(sheet->width * 3 * sizeof(float)));
    return (uint32_t)crc;
}
