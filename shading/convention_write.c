/* SPDX-License-Identifier: MIT */
#include "shading/convention.h"

#include <string.h>

/* ---- Opening ---- */

static ncr_status begin(const ncr_ctx *ctx, const ncr_convention *c, ncr_axes world, uint32_t size,
                        uint32_t channels, ncr_convention_rows *out, ncr_directional_map *shape)
{
    *out = (ncr_convention_rows){
        .ctx = ctx, .convention = c, .width = size * c->columns, .height = size * c->rows};
    ncr_status status =
        ncr_map_shape(ctx, c->kind, size, channels, ncr_axes_then(world, c->axes), shape);
    if (status != NCR_OK)
        return status;
    out->integral = ncr_alloc_zero(ctx, (size_t)ncr_map_part_count(c->kind) * size,
                                   channels * sizeof *out->integral);
    return out->integral ? NCR_OK : NCR_E_NOMEM;
}

/* Whether rows stand in need of others. */
static bool wants_whole(const ncr_convention *c)
{
    return c->on_border || c->kind == NCR_MAP_SPHERE || c->kind == NCR_MAP_PARABOLOID;
}

static bool is_just(const ncr_directional_map *map, const ncr_directional_map *shape)
{
    const ncr_axes a = ncr_axes_then(map->axes, (ncr_axes){{0}});
    const ncr_axes b = ncr_axes_then(shape->axes, (ncr_axes){{0}});
    return map->kind == shape->kind && map->size == shape->size && !memcmp(&a, &b, sizeof a);
}

static ncr_status hold(const ncr_ctx *ctx, const ncr_directional_map *shape,
                       ncr_convention_rows *out)
{
    ncr_status status =
        ncr_directional_map_init(ctx, shape->kind, shape->size, shape->image.channels, &out->owned);
    out->owned.axes = shape->axes;
    if (status == NCR_OK)
        status = ncr_map_rows_get_all(ctx, &out->made, &out->owned);
    out->held = &out->owned;
    return status;
}

ncr_status ncr_convention_rows_open(const ncr_ctx *ctx, const ncr_convention *c, ncr_axes world,
                                    const ncr_directional_map *map, ncr_directional_map *spare,
                                    uint32_t size, ncr_convention_rows *out)
{
    ncr_directional_map shape;
    ncr_status status =
        begin(ctx, c, world, size ? size : map->size, map->image.channels, out, &shape);
    if (status == NCR_OK && is_just(map, &shape)) {
        out->held = map;
        return NCR_OK;
    }
    if (status == NCR_OK)
        status = ncr_map_rows_init(ctx, map, spare, &shape, &out->made);
    if (status == NCR_OK && wants_whole(c))
        status = hold(ctx, &shape, out);
    if (status != NCR_OK)
        ncr_convention_rows_close(ctx, out);
    return status;
}

ncr_status ncr_convention_rows_of_function(const ncr_ctx *ctx, const ncr_convention *c,
                                           ncr_axes world, uint32_t size, uint32_t channels,
                                           double spacing, ncr_radiance_fn *fn, void *user,
                                           ncr_convention_rows *out)
{
    ncr_directional_map shape;
    ncr_status status = begin(ctx, c, world, size, channels, out, &shape);
    out->made = (ncr_map_rows){.shape = shape, .fn = fn, .user = user, .spacing = spacing};
    if (status == NCR_OK && wants_whole(c))
        status = hold(ctx, &shape, out);
    if (status != NCR_OK)
        ncr_convention_rows_close(ctx, out);
    return status;
}

void ncr_convention_rows_close(const ncr_ctx *ctx, ncr_convention_rows *rows)
{
    ncr_map_rows_dispose(ctx, &rows->made);
    ncr_directional_map_dispose(ctx, &rows->owned);
    ncr_free(ctx, rows->integral);
    *rows = (ncr_convention_rows){0};
}

void ncr_convention_rows_integral(const ncr_convention_rows *rows, double *out)
{
    const ncr_directional_map *shape = &rows->made.shape;
    if (rows->held) {
        ncr_directional_map_integral(rows->held, out);
        return;
    }
    const uint32_t channels = shape->image.channels;
    ncr_sum sum[NCR_MAP_CHANNELS] = {{0}};
    for (size_t k = 0; k < (size_t)ncr_map_part_count(shape->kind) * shape->size; k++)
        for (uint32_t c = 0; c < channels; c++)
            ncr_sum_add(&sum[c], rows->integral[k * channels + c].sum);
    for (size_t k = 0; k < (size_t)ncr_map_part_count(shape->kind) * shape->size; k++)
        for (uint32_t c = 0; c < channels; c++)
            ncr_sum_add(&sum[c], rows->integral[k * channels + c].error);
    for (uint32_t c = 0; c < channels; c++)
        out[c] = ncr_sum_value(&sum[c]);
}

/* ---- Texels to pixels ---- */

/* The map seen at a sample on the border. */
static void look_from_border(const ncr_directional_map *map, uint32_t part, uint32_t x, uint32_t y,
                             float *out)
{
    const uint32_t w = ncr_map_part_width(map->kind, map->size), h = map->size;
    const ncr_map_coord at = {part, w > 1 ? 2.0 * x / (w - 1) - 1 : 0,
                              h > 1 ? 2.0 * y / (h - 1) - 1 : 0};
    double own[3], d[3];
    ncr_map_to_direction(map->kind, at, own);
    ncr_axes_undo(map->axes, own, d);
    ncr_directional_map_look_up(map, d, out);
}

/* Rows [y, y + count) of a part, all texels of one after those of the other. */
static ncr_status part_rows(ncr_convention_rows *r, uint32_t part, uint32_t y, uint32_t count,
                            float *out, size_t stride)
{
    const ncr_directional_map *map = r->held ? r->held : &r->made.shape;
    const uint32_t w = ncr_map_part_width(map->kind, map->size), channels = map->image.channels;
    if (!r->held)
        return ncr_map_rows_get(r->ctx, &r->made, part, y, count, out, stride,
                                r->integral + ((size_t)part * map->size + y) * channels);
    for (uint32_t k = 0; k < count; k++) {
        float *row = out + k * stride;
        for (uint32_t x = 0; r->convention->on_border && x < w; x++)
            look_from_border(map, part, x, y + k, row + (size_t)x * channels);
        if (!r->convention->on_border)
            memcpy(row, ncr_directional_map_at(map, part, 0, y + k),
                   (size_t)w * channels * sizeof *row);
    }
    return NCR_OK;
}

static void mirror_row(float *row, uint32_t width, uint32_t channels)
{
    for (size_t a = 0, b = width - 1; a < b; a++, b--)
        for (uint32_t k = 0; k < channels; k++) {
            const float x = row[a * channels + k];
            row[a * channels + k] = row[b * channels + k];
            row[b * channels + k] = x;
        }
}

/* Exchange whole rows of a cell's run: top and bottom. */
static void turn_over(float *rows, uint32_t count, size_t floats, size_t stride)
{
    for (uint32_t a = 0, b = count - 1; a < b; a++, b--)
        for (size_t k = 0; k < floats; k++) {
            const float x = rows[a * stride + k];
            rows[a * stride + k] = rows[b * stride + k];
            rows[b * stride + k] = x;
        }
}

/* Rows [y, y + count) of a cell of n rows. */
static ncr_status cell_rows(ncr_convention_rows *r, uint32_t part, uint32_t y, uint32_t count,
                            float *out, size_t stride)
{
    const uint32_t n = r->height / r->convention->rows, mirror = r->convention->mirror[part];
    const uint32_t channels = ncr_convention_rows_source(r).channels;
    const ncr_status status =
        part_rows(r, part, mirror & 2 ? n - y - count : y, count, out, stride);
    if (mirror & 2)
        turn_over(out, count, (size_t)n * channels, stride);
    for (uint32_t k = 0; k < count && (mirror & 1); k++)
        mirror_row(out + k * stride, n, channels);
    return status;
}

static ncr_status parts_abreast(ncr_convention_rows *r, uint32_t y, uint32_t count, float *out,
                                uint32_t channels)
{
    const uint32_t parts = ncr_map_part_count(r->convention->kind), w = r->width / parts;
    ncr_status status = NCR_OK;
    for (uint32_t part = 0; part < parts && status == NCR_OK; part++)
        status = part_rows(r, part, y, count, out + (size_t)part * w * channels,
                           (size_t)r->width * channels);
    return status;
}

static ncr_status image_rows(void *user, uint32_t y, uint32_t count, float *out)
{
    ncr_convention_rows *r = user;
    const ncr_convention *c = r->convention;
    const uint32_t n = r->height / c->rows;
    const uint32_t channels = ncr_convention_rows_source(r).channels;
    const size_t stride = (size_t)r->width * channels;
    ncr_status status = NCR_OK;
    if (c->kind != NCR_MAP_CUBE)
        return parts_abreast(r, y, count, out, channels);
    memset(out, 0, count * stride * sizeof *out);
    for (uint32_t done = 0, run; done < count && status == NCR_OK; done += run) {
        const uint32_t at = y + done, left = n - at % n;
        run = count - done < left ? count - done : left;
        for (uint32_t part = 0; part < 6 && status == NCR_OK; part++)
            if ((uint32_t)(c->cell[part] >> 4) == at / n)
                status = cell_rows(
                    r, part, at % n, run,
                    out + done * stride + (size_t)(c->cell[part] & 15) * n * channels, stride);
    }
    return status;
}

ncr_row_source ncr_convention_rows_source(ncr_convention_rows *rows)
{
    const ncr_directional_map *map = rows->held ? rows->held : &rows->made.shape;
    return (ncr_row_source){.width = rows->width,
                            .height = rows->height,
                            .channels = map->image.channels,
                            .user = rows,
                            .rows = image_rows};
}

ncr_status ncr_convention_write(const ncr_ctx *ctx, const ncr_convention *c, ncr_axes world,
                                const ncr_directional_map *map, uint32_t size, ncr_image *out)
{
    ncr_convention_rows rows;
    *out = (ncr_image){0};
    ncr_status status = ncr_convention_rows_open(ctx, c, world, map, NULL, size, &rows);
    if (status != NCR_OK)
        return status;
    status = ncr_image_init(ctx, rows.width, rows.height, map->image.channels, out);
    if (status == NCR_OK)
        status = image_rows(&rows, 0, rows.height, out->data);
    if (status != NCR_OK)
        ncr_image_dispose(ctx, out);
    ncr_convention_rows_close(ctx, &rows);
    return status;
}
