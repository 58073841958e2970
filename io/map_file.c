/* SPDX-License-Identifier: MIT */
#include "io/map_file.h"

#include "io/image_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- The sentence ---- */

/* "nacre map: latlong usd; axes +x +z -y; +Y on top, ...; linear radiance, Rec. 709". Axes are those
 * of our world along the file's x, y and z. */
static void state(ncr_map_stated as, char text[NCR_IMAGE_COMMENT])
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

static bool is_six(const ncr_convention *c)
{
    return c && !strcmp(c->name, "sixfiles");
}

/* The path of one face; released with ncr_free. */
static ncr_status face_path(const ncr_ctx *ctx, const char *path, int face, char **out)
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

/* Tools that turn a map into another copy its comments along, so the attribute, which they do keep up
 * to date, overrules a sentence of another kind. */
ncr_status ncr_map_file_stated(const ncr_ctx *ctx, const char *path, ncr_map_stated *out)
{
    ncr_image_notes notes;
    memset(out, 0, sizeof *out);
    const ncr_status status = ncr_image_read_notes(ctx, path, &notes);
    if (status != NCR_OK)
        return status;
    understand(notes.comment, out);
    if (!notes.envmap)
        return NCR_OK;
    const ncr_map_kind kind = notes.envmap == NCR_ENVMAP_CUBE ? NCR_MAP_CUBE : NCR_MAP_LATLONG;
    const ncr_convention *own = ncr_convention_find("openexr", kind);
    if (out->convention != own)
        *out = (ncr_map_stated){own, {{0}}};
    return NCR_OK;
}

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

static ncr_status read_rgb(const ncr_ctx *ctx, const char *path, ncr_image *out,
                           uint64_t *nonfinite)
{
    uint64_t found = 0;
    ncr_status status = ncr_image_read(ctx, path, out, &found);
    *nonfinite += found;
    if (status == NCR_OK && out->channels > 4)
        status = ncr_fail(ctx, NCR_E_FORMAT, "%s: %u channels are no colours", path, out->channels);
    if (status == NCR_OK)
        status = to_rgb(ctx, out);
    if (status != NCR_OK)
        ncr_image_dispose(ctx, out);
    return status;
}

/* Put one face at its place in the strip, which the first face makes. */
static ncr_status add_face(const ncr_ctx *ctx, const char *path, uint32_t face,
                           const ncr_image *image, ncr_image *strip)
{
    const uint32_t n = image->width;
    ncr_status status = NCR_OK;
    if (image->height != n || (face > 0 && n != strip->width))
        return ncr_fail(ctx, NCR_E_FORMAT, "%s: is %u x %u, not a square like the other faces",
                        path, n, image->height);
    if (face == 0)
        status = ncr_image_init(ctx, n, 6 * n, 3, strip);
    if (status == NCR_OK)
        memcpy(ncr_image_at(strip, 0, face * n), image->data, (size_t)n * n * 3 * sizeof(float));
    return status;
}

static ncr_status read_six(const ncr_ctx *ctx, const char *path, ncr_image *strip,
                           uint64_t *nonfinite)
{
    ncr_status status = NCR_OK;
    for (int face = 0; face < 6 && status == NCR_OK; face++) {
        char *name;
        ncr_image image = {0};
        status = face_path(ctx, path, face, &name);
        if (status == NCR_OK)
            status = read_rgb(ctx, name, &image, nonfinite);
        if (status == NCR_OK)
            status = add_face(ctx, name, (uint32_t)face, &image, strip);
        ncr_image_dispose(ctx, &image);
        ncr_free(ctx, name);
    }
    return status;
}

static uint64_t count_negative(const ncr_image *image)
{
    uint64_t count = 0;
    for (size_t k = 0; k < (size_t)image->width * image->height * image->channels; k++)
        count += image->data[k] < 0;
    return count;
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
    ncr_image image = {0};
    memset(out, 0, sizeof *out);
    ncr_status status = find_convention(ctx, path, &as);
    if (status == NCR_OK)
        status = is_six(as.convention) ? read_six(ctx, path, &image, &found.nonfinite)
                                       : read_rgb(ctx, path, &image, &found.nonfinite);
    if (status == NCR_OK)
        status = ncr_convention_read(ctx, as.convention, as.world, &image, out);
    if (status == NCR_OK && report) {
        found.used = as;
        found.negative = count_negative(&image);
        *report = found;
    }
    ncr_image_dispose(ctx, &image);
    return status;
}

/* ---- Writing ---- */

static ncr_status write_six(const ncr_ctx *ctx, const char *path, const ncr_image *strip,
                            const ncr_image_write_opts *opts)
{
    ncr_status status = NCR_OK;
    for (uint32_t face = 0; face < 6 && status == NCR_OK; face++) {
        char *name;
        const ncr_image image = {strip->width, strip->width, strip->channels,
                                 ncr_image_at(strip, 0, face * strip->width)};
        status = face_path(ctx, path, (int)face, &name);
        if (status == NCR_OK)
            status = ncr_image_write(ctx, name, &image, opts);
        ncr_free(ctx, name);
    }
    return status;
}

static ncr_envmap envmap_of(const ncr_convention *c)
{
    if (strcmp(c->name, "openexr"))
        return NCR_ENVMAP_NONE;
    return c->kind == NCR_MAP_CUBE ? NCR_ENVMAP_CUBE : NCR_ENVMAP_LATLONG;
}

ncr_status ncr_map_file_write(const ncr_ctx *ctx, const char *path, const ncr_directional_map *map,
                              const ncr_map_file_opts *opts)
{
    const ncr_map_file_opts defaults = {.struct_size = sizeof defaults};
    const ncr_map_file_opts *o = opts ? opts : &defaults;
    if (o->struct_size != sizeof *o)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_map_file_write: the options have no struct_size");
    ncr_map_stated as = o->as;
    if (!as.convention)
        as.convention = ncr_convention_find("nacre", map->kind);
    char text[NCR_IMAGE_COMMENT];
    state(as, text);
    const ncr_image_write_opts how = {.struct_size = sizeof how,
                                      .exposure = o->exposure,
                                      .half = o->half,
                                      .comment = text,
                                      .envmap = envmap_of(as.convention)};
    ncr_image image;
    ncr_status status = ncr_convention_write(ctx, as.convention, as.world, map, o->size, &image);
    if (status == NCR_OK)
        status = is_six(as.convention) ? write_six(ctx, path, &image, &how)
                                       : ncr_image_write(ctx, path, &image, &how);
    ncr_image_dispose(ctx, &image);
    return status;
}
