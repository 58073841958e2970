/* SPDX-License-Identifier: MIT */
#include "io/image_format_internal.h"
#include "io/ktx2_internal.h"
#include "io/map_file_internal.h"

#include <string.h>
#include <strings.h>

typedef struct map_writer {
    const ncr_ctx *ctx;
    const char *path;
    ncr_map_file_opts o;
    char text[NCR_IMAGE_COMMENT];
    ncr_ktx2_stream texture;
    uint32_t channels;
} map_writer;

static ncr_status begin(const ncr_ctx *ctx, const char *path, const ncr_map_file_opts *opts,
                        map_writer *w)
{
    *w = (map_writer){.ctx = ctx, .path = path, .o = {.struct_size = sizeof w->o}};
    if (opts && opts->struct_size != sizeof *opts)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_map_file_write: the options have no struct_size");
    if (opts)
        w->o = *opts;
    return NCR_OK;
}

static bool is_ktx2_path(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && !strcasecmp(dot, ".ktx2");
}

static bool is_texture(const map_writer *w)
{
    return is_ktx2_path(w->path) && !ncr_map_is_six(w->o.as.convention);
}

/* ---- Images ---- */

typedef struct face_rows {
    ncr_row_source strip;
    uint32_t first;
} face_rows;

static ncr_status give_face(void *user, uint32_t y, uint32_t count, float *out)
{
    const face_rows *f = user;
    return f->strip.rows(f->strip.user, f->first + y, count, out);
}

static ncr_status write_six(const map_writer *w, const ncr_row_source *strip,
                            const ncr_image_write_opts *opts)
{
    ncr_status status = NCR_OK;
    for (uint32_t face = 0; face < 6 && status == NCR_OK; face++) {
        char *name;
        face_rows rows = {*strip, face * strip->width};
        const ncr_row_source source = {strip->width, strip->width, strip->channels, &rows,
                                       give_face};
        status = ncr_map_face_path(w->ctx, w->path, (int)face, &name);
        if (status == NCR_OK)
            status = ncr_image_write_rows(w->ctx, name, &source, opts);
        ncr_free(w->ctx, name);
    }
    return status;
}

static ncr_envmap envmap_of(const ncr_convention *c)
{
    if (strcmp(c->name, "openexr"))
        return NCR_ENVMAP_NONE;
    return c->kind == NCR_MAP_CUBE ? NCR_ENVMAP_CUBE : NCR_ENVMAP_LATLONG;
}

static ncr_status write_image(const map_writer *w, ncr_convention_rows *rows)
{
    const ncr_row_source source = ncr_convention_rows_source(rows);
    const ncr_image_write_opts how = {.struct_size = sizeof how,
                                      .exposure = w->o.exposure,
                                      .half = w->o.half,
                                      .comment = w->text,
                                      .envmap = envmap_of(w->o.as.convention)};
    return ncr_map_is_six(w->o.as.convention)
               ? write_six(w, &source, &how)
               : ncr_image_write_rows(w->ctx, w->path, &source, &how);
}

/* ---- Textures ---- */

/* A level's sides must be those of level 0, halved. */
static ncr_status check_levels(const map_writer *w, uint32_t size, uint32_t count)
{
    const ncr_convention *c = w->o.as.convention;
    if (count > NCR_KTX2_LEVELS || count > ncr_map_level_count(size))
        return ncr_fail(w->ctx, NCR_E_ARG, "%s: a map of size %u has no %u levels", w->path, size,
                        count);
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t width = (size >> k) * c->columns, height = (size >> k) * c->rows;
        if (!ncr_map_is_ktx(c) &&
            (width != ktx2_side(size * c->columns, k) || height != ktx2_side(size * c->rows, k)))
            return ncr_fail(w->ctx, NCR_E_ARG, "%s: level %u is %u x %u, not half the one before",
                            w->path, k, width, height);
    }
    return NCR_OK;
}

static ncr_status open_texture(map_writer *w, uint32_t size, uint32_t count, bool judged)
{
    const ncr_convention *c = w->o.as.convention;
    const bool cube = ncr_map_is_ktx(c);
    const ncr_ktx2_opts how = {
        .struct_size = sizeof how, .format = w->o.ktx2, .cube = cube, .comment = w->text};
    const ncr_status status = check_levels(w, size, count);
    return status == NCR_OK
               ? ncr_ktx2_stream_open(w->ctx, w->path, size * c->columns,
                                      size * (cube ? 1 : c->rows), count, &how, judged, &w->texture)
               : status;
}

/* A level from the rows of its image; these go on into the pyramid, where there is one. */
static ncr_status put_level(map_writer *w, uint32_t level, ncr_convention_rows *rows,
                            ncr_map_pyramid *pyramid)
{
    const ncr_row_source source = ncr_convention_rows_source(rows);
    const uint32_t strip = ncr_row_strip(&source);
    float *texels =
        ncr_alloc(w->ctx, (size_t)strip * source.width * source.channels * sizeof *texels);
    ncr_status status = texels ? NCR_OK : NCR_E_NOMEM;
    for (uint32_t y = 0; y < source.height && status == NCR_OK; y += strip) {
        const uint32_t count = source.height - y < strip ? source.height - y : strip;
        status = source.rows(source.user, y, count, texels);
        if (status != NCR_OK)
            break;
        ncr_ktx2_stream_rows(&w->texture, level, y, count, source.channels, texels);
        if (pyramid)
            status = ncr_map_pyramid_push(w->ctx, pyramid, count, texels);
    }
    ncr_free(w->ctx, texels);
    return status;
}

/* The rows of a level; the first may be made of another map. */
static ncr_status open_level(const map_writer *w, uint32_t level, const ncr_directional_map *map,
                             uint32_t size, ncr_convention_rows *out)
{
    ncr_directional_map *spare = level == 0 ? w->o.first : NULL;
    return ncr_convention_rows_open(w->ctx, w->o.as.convention, w->o.as.world, spare ? spare : map,
                                    spare, size ? size : map->size, out);
}

static ncr_status put_map(map_writer *w, uint32_t level, const ncr_directional_map *map,
                          uint32_t size)
{
    ncr_convention_rows rows;
    ncr_status status = open_level(w, level, map, size, &rows);
    if (status == NCR_OK) {
        status = put_level(w, level, &rows, NULL);
        ncr_convention_rows_close(w->ctx, &rows);
    }
    return status;
}

static ncr_status write_texture(map_writer *w, const ncr_directional_map *levels, uint32_t count,
                                ncr_ktx2_report *report)
{
    const uint32_t size = w->o.size ? w->o.size : levels[0].size;
    ncr_status status = open_texture(w, size, count, report != NULL);
    for (uint32_t k = 0; k < count && status == NCR_OK; k++)
        status = put_map(w, k, &levels[k], size >> k);
    return ncr_ktx2_stream_close(&w->texture, status, report);
}

ncr_status ncr_map_file_write_levels(const ncr_ctx *ctx, const char *path,
                                     const ncr_directional_map *levels, uint32_t count,
                                     const ncr_map_file_opts *opts, ncr_ktx2_report *report)
{
    map_writer w;
    ncr_convention_rows rows;
    ncr_status status = begin(ctx, path, opts, &w);
    if (status != NCR_OK)
        return status;
    if (!w.o.as.convention)
        w.o.as.convention = ncr_convention_find("nacre", levels[0].kind);
    if (report)
        *report = (ncr_ktx2_report){0};
    ncr_map_state(w.o.as, w.text);
    if (is_texture(&w))
        return write_texture(&w, levels, count, report);
    if (count != 1)
        return ncr_fail(ctx, NCR_E_ARG, "%s: of the formats only .ktx2 holds levels", path);
    status = open_level(&w, 0, levels, w.o.size, &rows);
    if (status == NCR_OK) {
        status = write_image(&w, &rows);
        ncr_convention_rows_close(ctx, &rows);
    }
    return status;
}

ncr_status ncr_map_file_write(const ncr_ctx *ctx, const char *path, const ncr_directional_map *map,
                              const ncr_map_file_opts *opts)
{
    return ncr_map_file_write_levels(ctx, path, map, 1, opts, NULL);
}

/* ---- Straight from another map, or a function ---- */

/* Whether rows of the image are rows of the map, from its first part to its last. */
static bool runs_in_order(const ncr_convention *c)
{
    static const uint8_t none[6] = {0};
    if (c->kind == NCR_MAP_CUBE)
        return c->columns == 1 && !c->on_border && !memcmp(c->mirror, none, sizeof none);
    return !c->on_border && (c->kind == NCR_MAP_LATLONG || c->kind == NCR_MAP_OCTAHEDRAL);
}

static ncr_status put_smaller(void *user, uint32_t level, uint32_t y, uint32_t count,
                              const float *rows)
{
    map_writer *w = user;
    ncr_ktx2_stream_rows(&w->texture, level, y, count, w->channels, rows);
    return NCR_OK;
}

static ncr_status put_in_order(map_writer *w, uint32_t count, ncr_convention_rows *rows,
                               const ncr_directional_map *shape)
{
    ncr_map_pyramid *pyramid;
    w->channels = shape->image.channels;
    ncr_status status = ncr_map_pyramid_create(w->ctx, shape, count, put_smaller, w, &pyramid);
    if (status == NCR_OK)
        status = put_level(w, 0, rows, count > 1 ? pyramid : NULL);
    ncr_map_pyramid_destroy(w->ctx, pyramid);
    return status;
}

/* Each level held until the next is made of it. */
static ncr_status put_held(map_writer *w, uint32_t count, const ncr_convention_rows *rows,
                           const ncr_directional_map *shape)
{
    ncr_directional_map map = {.kind = NCR_MAP_CUBE};
    ncr_status status = NCR_OK;
    if (!rows->held) {
        status =
            ncr_directional_map_init(w->ctx, shape->kind, shape->size, shape->image.channels, &map);
        map.axes = shape->axes;
        if (status == NCR_OK)
            status = ncr_map_rows_get_all(w->ctx, &rows->made, &map);
    }
    for (uint32_t k = 0; k < count && status == NCR_OK; k++) {
        const ncr_directional_map *from = k || !rows->held ? &map : rows->held;
        ncr_directional_map next = {.kind = NCR_MAP_CUBE};
        status = put_map(w, k, from, 0);
        if (status == NCR_OK && k + 1 < count)
            status = ncr_directional_map_init(w->ctx, shape->kind, shape->size >> (k + 1),
                                              shape->image.channels, &next);
        if (status == NCR_OK && k + 1 < count)
            status = ncr_directional_map_shrink(w->ctx, from, &next);
        ncr_directional_map_dispose(w->ctx, &map);
        map = next;
    }
    ncr_directional_map_dispose(w->ctx, &map);
    return status;
}

static ncr_status make_texture(map_writer *w, bool mips, ncr_convention_rows *rows,
                               ncr_map_written *report)
{
    const ncr_directional_map *shape = rows->held ? rows->held : &rows->made.shape;
    const uint32_t count = mips ? ncr_map_level_count(shape->size) : 1;
    ncr_status status = open_texture(w, shape->size, count, true);
    if (status == NCR_OK)
        status = count == 1 || runs_in_order(w->o.as.convention)
                     ? put_in_order(w, count, rows, shape)
                     : put_held(w, count, rows, shape);
    report->levels = count;
    return ncr_ktx2_stream_close(&w->texture, status, &report->stored);
}

static ncr_status open_rows(const map_writer *w, ncr_directional_map *map,
                            const ncr_map_function *f, ncr_convention_rows *out)
{
    const ncr_map_stated as = w->o.as;
    return map ? ncr_convention_rows_open(w->ctx, as.convention, as.world, map, map, w->o.size, out)
               : ncr_convention_rows_of_function(w->ctx, as.convention, as.world, w->o.size,
                                                 f->channels, f->spacing, f->fn, f->user, out);
}

ncr_status ncr_map_file_make(const ncr_ctx *ctx, const char *path, ncr_directional_map *map,
                             const ncr_map_function *function, bool mips,
                             const ncr_map_file_opts *opts, ncr_map_written *report)
{
    map_writer w;
    ncr_convention_rows rows;
    ncr_map_written found = {.levels = 1};
    ncr_status status = begin(ctx, path, opts, &w);
    if (status == NCR_OK && !w.o.as.convention)
        status = ncr_fail(ctx, NCR_E_ARG, "%s: no convention is said", path);
    if (status != NCR_OK)
        return status;
    ncr_map_state(w.o.as, w.text);
    w.o.first = NULL;
    if (mips && !is_texture(&w))
        return ncr_fail(ctx, NCR_E_ARG, "%s: of the formats only .ktx2 holds levels", path);
    status = open_rows(&w, map, function, &rows);
    if (status != NCR_OK)
        return status;
    status = is_texture(&w) ? make_texture(&w, mips, &rows, &found) : write_image(&w, &rows);
    found.size = rows.width / w.o.as.convention->columns;
    if (status == NCR_OK && report) {
        ncr_convention_rows_integral(&rows, found.integral);
        *report = found;
    }
    ncr_convention_rows_close(ctx, &rows);
    return status;
}
