/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"
#include "io/field_internal.h"
#include "io/image_file.h"

#include <stdlib.h>
#include <string.h>

enum { chart_words = 6 };
_Static_assert(sizeof(ncr_chart) == chart_words * sizeof(uint32_t),
               "a chart is stored as it lies in memory: patch, page, x, y, width, height");

static size_t page_texels(const ncr_sample_map *map)
{
    return (size_t)map->page_width * map->page_height;
}

static ncr_field_path page_path(const char *folder, uint32_t page)
{
    char name[32];
    ncr_field_file_name(3 + page, name);
    return ncr_field_join(folder, name);
}

/* ---- Writing ---- */

static ncr_status write_charts(const ncr_ctx *ctx, const char *path, const ncr_sample_map *map)
{
    ncr_atomic_file file;
    const ncr_status status = ncr_atomic_file_open(ctx, path, &file);
    if (status != NCR_OK)
        return status;
    fwrite(map->charts, sizeof *map->charts, map->patch_count, file.stream);
    return ncr_atomic_file_commit(ctx, &file);
}

ncr_status ncr_field_map_write(const ncr_ctx *ctx, const char *folder, const ncr_sample_map *map)
{
    ncr_status status = write_charts(ctx, ncr_field_join(folder, "charts.bin").text, map);
    for (uint32_t page = 0; page < map->page_count && status == NCR_OK; page++)
        status = ncr_png16_write(ctx, page_path(folder, page).text, map->page_width,
                                 map->page_height, 4, map->index + 4 * page * page_texels(map));
    return status;
}

/* ---- Reading ---- */

static bool power_of_two(uint32_t x)
{
    return x && !(x & (x - 1));
}

/* Mark the chart's texels; false when one is taken. */
static bool claim(const ncr_sample_map *map, const ncr_chart *c, uint8_t *taken)
{
    for (uint32_t y = 0; y < c->height; y++) {
        uint8_t *row =
            taken + c->page * page_texels(map) + (size_t)(c->y + y) * map->page_width + c->x;
        if (memchr(row, 1, c->width))
            return false;
        memset(row, 1, c->width);
    }
    return true;
}

static const char *fault(const ncr_sample_map *map, uint32_t k, uint8_t *taken)
{
    const ncr_chart *c = &map->charts[k];
    if (c->patch != k)
        return "patches are not in order";
    if (!power_of_two(c->width) || !power_of_two(c->height))
        return "a side is not a power of two";
    if (c->page >= map->page_count || c->x >= map->page_width || c->y >= map->page_height ||
        c->width > map->page_width - c->x || c->height > map->page_height - c->y)
        return "it passes the edge of its page";
    return claim(map, c, taken) ? NULL : "it overlaps an earlier chart";
}

static ncr_status check_charts(const ncr_ctx *ctx, const char *path, const ncr_sample_map *map)
{
    uint8_t *taken = ncr_alloc_zero(ctx, page_texels(map), map->page_count);
    if (!taken)
        return NCR_E_NOMEM;
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; k < map->patch_count && status == NCR_OK; k++) {
        const char *wrong = fault(map, k, taken);
        if (wrong)
            status = ncr_fail(ctx, NCR_E_FORMAT, "%s: chart %u: %s", path, k, wrong);
    }
    ncr_free(ctx, taken);
    return status;
}

static ncr_status read_charts(const ncr_ctx *ctx, const char *path, ncr_sample_map *map)
{
    uint8_t *data;
    size_t size;
    ncr_status status = ncr_file_read(ctx, path, SIZE_MAX, &data, &size);
    if (status != NCR_OK)
        return status;
    const size_t expected = map->patch_count * sizeof *map->charts;
    if (size != expected)
        status = ncr_fail(ctx, NCR_E_FORMAT, "%s: has %zu bytes, %u charts take %zu", path, size,
                          map->patch_count, expected);
    else if (!(map->charts = ncr_alloc(ctx, expected)))
        status = NCR_E_NOMEM;
    else
        memcpy(map->charts, data, expected);
    ncr_free(ctx, data);
    return status == NCR_OK ? check_charts(ctx, path, map) : status;
}

/* Every index names a point, and after the first "none" there are no more. */
static ncr_status check_page(const ncr_ctx *ctx, const char *path, const ncr_sample_map *map,
                             const uint16_t *index, uint32_t points)
{
    for (size_t k = 0; k < 4 * page_texels(map); k++) {
        const size_t texel = k / 4, x = texel % map->page_width, y = texel / map->page_width;
        if (index[k] != NCR_NO_POINT && index[k] >= points)
            return ncr_fail(ctx, NCR_E_FORMAT, "%s: texel %zu,%zu names point %u of %u", path, x, y,
                            index[k], points);
        if (k % 4 && index[k] != NCR_NO_POINT && index[k - 1] == NCR_NO_POINT)
            return ncr_fail(ctx, NCR_E_FORMAT, "%s: texel %zu,%zu names a point after none", path,
                            x, y);
    }
    return NCR_OK;
}

static ncr_status read_page(const ncr_ctx *ctx, const char *path, const ncr_sample_map *map,
                            uint32_t page, uint32_t points)
{
    uint32_t width, height, channels;
    uint16_t *data;
    ncr_status status = ncr_png16_read(ctx, path, &width, &height, &channels, &data);
    if (status != NCR_OK)
        return status;
    if (width != map->page_width || height != map->page_height || channels != 4)
        status = ncr_fail(ctx, NCR_E_FORMAT, "%s: is %ux%u of %u channels, expected %ux%u of 4",
                          path, width, height, channels, map->page_width, map->page_height);
    else
        status = check_page(ctx, path, map, data, points);
    if (status == NCR_OK)
        memcpy(map->index + 4 * page * page_texels(map), data, 8 * page_texels(map));
    ncr_free(ctx, data);
    return status;
}

ncr_status ncr_field_map_read(const ncr_ctx *ctx, const char *folder,
                              const ncr_field_manifest *manifest, ncr_sample_map *out)
{
    ncr_sample_map map = {.patch_count = manifest->patches,
                          .page_count = manifest->pages,
                          .page_width = manifest->page_width,
                          .page_height = manifest->page_height};
    ncr_status status = read_charts(ctx, ncr_field_join(folder, "charts.bin").text, &map);
    if (status == NCR_OK) {
        map.index = ncr_alloc_zero(ctx, page_texels(&map) * map.page_count, 4 * sizeof *map.index);
        status = map.index ? NCR_OK : NCR_E_NOMEM;
    }
    for (uint32_t page = 0; page < map.page_count && status == NCR_OK; page++)
        status = read_page(ctx, page_path(folder, page).text, &map, page, manifest->points);
    if (status == NCR_OK)
        *out = map;
    else
        ncr_sample_map_dispose(ctx, &map);
    return status;
}
