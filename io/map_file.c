/* SPDX-License-Identifier: MIT */
#include "io/map_file.h"

#include "io/image_format_internal.h"
#include "io/map_file_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- The sentence ---- */

void ncr_map_state(ncr_map_stated as, char text[NCR_IMAGE_COMMENT])
{
    static const char *const spelled[] = {"-z", "-y", "-x", "", "+x", "+y", "+z"};
    const ncr_axes a = ncr_axes_then(as.world, (ncr_axes){{0}});
    snprintf(text, NCR_IMAGE_COMMENT,
             "nacre map: %s %s; axes %s %s %s; %s; linear radiance, Rec. 709 primaries",
             ncr_map_kind_name(as.convention->kind), as.convention->name, spelled[a.row[0] + 3],
             spelled[a.row[1] + 3], spelled[a.row[2] + 3], as.convention->says);
}

static bool read_axes(const char *const word[3], ncr_axes *out)
{
    int seen = 0;
    for (int k = 0; k < 3; k++) {
        const int axis = word[k][1] - 'x';
        if ((word[k][0] != '+' && word[k][0] != '-') || axis < 0 || axis > 2 || word[k][2])
            return false;
        out->row[k] = (int8_t)(word[k][0] == '-' ? -1 - axis : 1 + axis);
        seen |= 1 << axis;
    }
    return seen == 7;
}

static bool understand(const char *text, ncr_map_stated *out)
{
    char kind[16], name[16], x[4], y[4], z[4];
    ncr_map_stated found = {0};
    ncr_map_kind k;
    if (sscanf(text, "nacre map: %15s %15[^;]; axes %3s %3s %3[^;];", kind, name, x, y, z) != 5 ||
        !ncr_map_kind_from_name(kind, &k) ||
        !read_axes((const char *const[]){x, y, z}, &found.world))
        return false;
    found.convention = ncr_convention_find(name, k);
    if (found.convention)
        *out = found;
    return found.convention != NULL;
}

/* ---- Six files ---- */

static const char *const face_names[6] = {"px", "nx", "py", "ny", "pz", "nz"};

bool ncr_map_is_six(const ncr_convention *c)
{
    return c && !strcmp(c->name, "sixfiles");
}

ncr_status ncr_map_face_path(const ncr_ctx *ctx, const char *path, int face, char **out)
{
    *out = NULL;
    const char *mark = strchr(path, '%');
    if (!mark)
        return ncr_fail(ctx, NCR_E_ARG,
                        "%s: six files want a %% in their name, for px nx py ny pz nz", path);
    const size_t size = strlen(path) + 2;
    *out = ncr_alloc(ctx, size);
    if (!*out)
        return NCR_E_NOMEM;
    snprintf(*out, size, "%.*s%s%s", (int)(mark - path), path, face_names[face], mark + 1);
    return NCR_OK;
}

/* ---- Reading ---- */

bool ncr_map_is_ktx(const ncr_convention *c)
{
    const ncr_convention *k = ncr_convention_find("ktx", NCR_MAP_CUBE);
    return c && c->kind == NCR_MAP_CUBE && !c->on_border && c->rows == k->rows &&
           !memcmp(c->cell, k->cell, sizeof c->cell) && !memcmp(c->mirror, k->mirror, 6);
}

/* Tools that turn a map into another copy its comments along, so what the format itself says, which
 * they do keep up to date, overrules a sentence of another kind. */
ncr_status ncr_map_file_stated(const ncr_ctx *ctx, const char *path, ncr_map_stated *out)
{
    ncr_image_notes notes;
    memset(out, 0, sizeof *out);
    const ncr_status status = ncr_image_read_notes(ctx, path, &notes);
    if (status != NCR_OK)
        return status;
    understand(notes.comment, out);
    if (notes.faces == 6 && !ncr_map_is_ktx(out->convention))
        *out = (ncr_map_stated){ncr_convention_find("ktx", NCR_MAP_CUBE), {{0}}};
    if (!notes.envmap)
        return NCR_OK;
    const ncr_map_kind kind = notes.envmap == NCR_ENVMAP_CUBE ? NCR_MAP_CUBE : NCR_MAP_LATLONG;
    const ncr_convention *own = ncr_convention_find("openexr", kind);
    if (out->convention != own)
        *out = (ncr_map_stated){own, {{0}}};
    return NCR_OK;
}

/* A file on its way into a map: RGB, row by row. */
typedef struct map_reader {
    const ncr_ctx *ctx;
    const char *path;
    ncr_map_stated as;
    int face; /* of six files, or -1 */
    uint32_t width, channels;
    uint64_t negative;
    ncr_directional_map *out;
} map_reader;

/* The first of six files makes the map, as if all stood in one strip. */
static ncr_status begin_face(map_reader *r, uint32_t width, uint32_t height)
{
    if (height != width || (r->face > 0 && width != r->out->size))
        return ncr_fail(r->ctx, NCR_E_FORMAT, "%s: is %u x %u, not a square like the other faces",
                        r->path, width, height);
    return r->face > 0 ? NCR_OK
                       : ncr_convention_begin(r->ctx, r->as.convention, r->as.world, width,
                                              6 * width, 3, r->out);
}

static ncr_status begin_map(void *user, uint32_t width, uint32_t height, uint32_t channels)
{
    map_reader *r = user;
    r->width = width;
    r->channels = channels;
    if (channels > 4)
        return ncr_fail(r->ctx, NCR_E_FORMAT, "%s: %u channels are no colours", r->path, channels);
    return r->face < 0 ? ncr_convention_begin(r->ctx, r->as.convention, r->as.world, width, height,
                                              3, r->out)
                       : begin_face(r, width, height);
}

/* Gray three times; what is beyond RGB left out. Three values fit where as many or more were. */
static void to_rgb_in_place(uint32_t width, uint32_t channels, float *row)
{
    for (size_t x = 0; channels > 3 && x < width; x++)
        for (size_t c = 0; c < 3; c++)
            row[3 * x + c] = row[channels * x + c];
}

static ncr_status take_rows(void *user, uint32_t y, uint32_t count, float *rows)
{
    map_reader *r = user;
    const uint32_t before = r->face > 0 ? (uint32_t)r->face * r->out->size : 0;
    for (uint32_t k = 0; k < count; k++, rows += (size_t)r->width * r->channels) {
        to_rgb_in_place(r->width, r->channels, rows);
        for (size_t i = 0; i < 3 * (size_t)r->width; i++)
            r->negative += rows[i] < 0;
        ncr_convention_take(r->as.convention, before + y + k, rows, r->out);
    }
    return NCR_OK;
}

/* Gray has no room for three values in its own row. */
static ncr_status take_gray(void *user, uint32_t y, uint32_t count, float *rows)
{
    map_reader *r = user;
    const uint32_t channels = r->channels;
    ncr_status status = NCR_OK;
    if (channels >= 3)
        return take_rows(user, y, count, rows);
    float *rgb = ncr_alloc(r->ctx, 3 * (size_t)r->width * sizeof *rgb);
    if (!rgb)
        return NCR_E_NOMEM;
    r->channels = 3;
    for (uint32_t k = 0; k < count && status == NCR_OK; k++) {
        for (size_t i = 0; i < 3 * (size_t)r->width; i++)
            rgb[i] = rows[((size_t)k * r->width + i / 3) * channels];
        status = take_rows(user, y + k, 1, rgb);
    }
    r->channels = channels;
    ncr_free(r->ctx, rgb);
    return status;
}

static ncr_status read_file(map_reader *r, const char *path, uint64_t *nonfinite)
{
    const ncr_row_sink sink = {.user = r, .begin = begin_map, .rows = take_gray};
    uint64_t found = 0;
    r->path = path;
    const ncr_status status = ncr_image_read_rows(r->ctx, path, &sink, &found);
    *nonfinite += found;
    return status;
}

static ncr_status read_six(map_reader *r, const char *path, uint64_t *nonfinite)
{
    ncr_status status = NCR_OK;
    for (int face = 0; face < 6 && status == NCR_OK; face++) {
        char *name;
        r->face = face;
        status = ncr_map_face_path(r->ctx, path, face, &name);
        if (status == NCR_OK)
            status = read_file(r, name, nonfinite);
        ncr_free(r->ctx, name);
    }
    return status;
}

static ncr_status find_convention(const ncr_ctx *ctx, const char *path, ncr_map_stated *as)
{
    if (as->convention)
        return NCR_OK;
    const ncr_status status = ncr_map_file_stated(ctx, path, as);
    if (status == NCR_OK && !as->convention)
        return ncr_fail(ctx, NCR_E_ARG, "%s: does not say by which convention it is to be read",
                        path);
    return status;
}

ncr_status ncr_map_file_read(const ncr_ctx *ctx, const char *path, ncr_map_stated as,
                             ncr_directional_map *out, ncr_map_file_report *report)
{
    ncr_map_file_report found = {0};
    memset(out, 0, sizeof *out);
    ncr_status status = find_convention(ctx, path, &as);
    map_reader r = {.ctx = ctx, .as = as, .face = -1, .out = out};
    if (status == NCR_OK)
        status = ncr_map_is_six(as.convention) ? read_six(&r, path, &found.nonfinite)
                                               : read_file(&r, path, &found.nonfinite);
    if (status == NCR_OK)
        status = ncr_convention_finish(ctx, as.convention, out);
    if (status != NCR_OK)
        ncr_directional_map_dispose(ctx, out);
    if (status == NCR_OK && report) {
        found.used = as;
        found.negative = r.negative;
        *report = found;
    }
    return status;
}

/* ---- Levels ---- */

/* Any image as RGB: gray three times, what is beyond RGB left out. */
static ncr_status to_rgb(const ncr_ctx *ctx, ncr_image *image)
{
    if (image->channels == 3)
        return NCR_OK;
    ncr_image rgb;
    const ncr_status status = ncr_image_init(ctx, image->width, image->height, 3, &rgb);
    if (status != NCR_OK)
        return status;
    const bool gray = image->channels < 3;
    for (size_t k = 0; k < (size_t)rgb.width * rgb.height; k++)
        for (uint32_t c = 0; c < 3; c++)
            rgb.data[3 * k + c] = image->data[k * image->channels + (gray ? 0 : c)];
    ncr_image_dispose(ctx, image);
    *image = rgb;
    return NCR_OK;
}

static uint64_t count_negative(const ncr_image *image)
{
    uint64_t count = 0;
    for (size_t k = 0; k < (size_t)image->width * image->height * image->channels; k++)
        count += image->data[k] < 0;
    return count;
}

/* One level of a KTX 2 file, whose values are counted and made finite first. */
static ncr_status take_level(const ncr_ctx *ctx, ncr_map_stated as, ncr_image *image,
                             ncr_directional_map *out, ncr_map_file_report *found)
{
    found->nonfinite += ncr_image_zero_nonfinite(image);
    ncr_status status = to_rgb(ctx, image);
    if (status == NCR_OK)
        found->negative += count_negative(image);
    return status == NCR_OK ? ncr_convention_read(ctx, as.convention, as.world, image, out)
                            : status;
}

ncr_status ncr_map_file_read_levels(const ncr_ctx *ctx, const char *path, ncr_map_stated as,
                                    uint32_t count, ncr_directional_map *levels,
                                    ncr_map_file_report *report)
{
    ncr_map_file_report found = {0};
    ncr_image images[NCR_KTX2_LEVELS] = {{0}};
    memset(levels, 0, count * sizeof *levels);
    ncr_status status = find_convention(ctx, path, &as);
    if (status == NCR_OK && count > NCR_KTX2_LEVELS)
        status = ncr_fail(ctx, NCR_E_ARG, "%s: has not %u levels", path, count);
    if (status == NCR_OK)
        status = ncr_ktx2_read(ctx, path, count, images);
    for (uint32_t k = 0; k < count && status == NCR_OK; k++)
        status = take_level(ctx, as, &images[k], &levels[k], &found);
    for (uint32_t k = 0; k < NCR_KTX2_LEVELS; k++)
        ncr_image_dispose(ctx, &images[k]);
    for (uint32_t k = 0; k < count && status != NCR_OK; k++)
        ncr_directional_map_dispose(ctx, &levels[k]);
    found.used = as;
    if (status == NCR_OK && report)
        *report = found;
    return status;
}
