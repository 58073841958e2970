/* SPDX-License-Identifier: MIT */
#include "io/map_file.h"

#include "io/image_format_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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

/* Whether a convention is what six faces of KTX 2 are. */
static bool is_ktx(const ncr_convention *c)
{
    const ncr_convention *k = ncr_convention_find("ktx", NCR_MAP_CUBE);
    return c && c->kind == NCR_MAP_CUBE && !c->on_border && !strcmp(c->says, k->says);
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
    if (notes.faces == 6 && !is_ktx(out->convention))
        *out = (ncr_map_stated){ncr_convention_find("ktx", NCR_MAP_CUBE), {{0}}};
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

static bool is_ktx2_path(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && !strcasecmp(dot, ".ktx2");
}

static ncr_status write_ktx2(const ncr_ctx *ctx, const char *path,
                             const ncr_directional_map *levels, uint32_t count,
                             const ncr_map_file_opts *o, const char *text, ncr_ktx2_report *report)
{
    const ncr_convention *c = o->as.convention;
    const uint32_t size = o->size ? o->size : levels[0].size;
    const ncr_ktx2_opts how = {
        .struct_size = sizeof how, .format = o->ktx2, .cube = is_ktx(c), .comment = text};
    ncr_image images[NCR_KTX2_LEVELS] = {{0}};
    ncr_status status =
        count <= NCR_KTX2_LEVELS && count <= ncr_map_level_count(size)
            ? NCR_OK
            : ncr_fail(ctx, NCR_E_ARG, "%s: a map of size %u has no %u levels", path, size, count);
    for (uint32_t k = 0; k < count && status == NCR_OK; k++)
        status = ncr_convention_write(ctx, c, o->as.world, &levels[k], size >> k, &images[k]);
    if (status == NCR_OK)
        status = ncr_ktx2_write(ctx, path, images, count, &how, report);
    for (uint32_t k = 0; k < NCR_KTX2_LEVELS; k++)
        ncr_image_dispose(ctx, &images[k]);
    return status;
}

static ncr_status write_image(const ncr_ctx *ctx, const char *path, const ncr_directional_map *map,
                              const ncr_map_file_opts *o, const char *text)
{
    const ncr_map_stated as = o->as;
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

ncr_status ncr_map_file_write_levels(const ncr_ctx *ctx, const char *path,
                                     const ncr_directional_map *levels, uint32_t count,
                                     const ncr_map_file_opts *opts, ncr_ktx2_report *report)
{
    ncr_map_file_opts o = {.struct_size = sizeof o};
    char text[NCR_IMAGE_COMMENT];
    if (opts && opts->struct_size != sizeof o)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_map_file_write: the options have no struct_size");
    if (opts)
        o = *opts;
    if (!o.as.convention)
        o.as.convention = ncr_convention_find("nacre", levels[0].kind);
    if (report)
        *report = (ncr_ktx2_report){0};
    state(o.as, text);
    if (is_ktx2_path(path) && !is_six(o.as.convention))
        return write_ktx2(ctx, path, levels, count, &o, text, report);
    if (count != 1)
        return ncr_fail(ctx, NCR_E_ARG, "%s: of the formats only .ktx2 holds levels", path);
    return write_image(ctx, path, levels, &o, text);
}

ncr_status ncr_map_file_write(const ncr_ctx *ctx, const char *path, const ncr_directional_map *map,
                              const ncr_map_file_opts *opts)
{
    return ncr_map_file_write_levels(ctx, path, map, 1, opts, NULL);
}
