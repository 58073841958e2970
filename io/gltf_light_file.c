/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [glTF]    Khronos. glTF 2.0 Specification: JSON, buffers, the binary container. 2021
 *   [EXTibl]  G. Hsu, M. Bond. glTF extension EXT_lights_image_based. 2019
 */
#include "io/atomic_file_internal.h"
#include "io/gltf_light_internal.h"

#include <jansson.h>
#include <png.h>
#include <string.h>
#include <strings.h>

#define EXTENSION "EXT_lights_image_based"

/* ---- Images ---- */

/* Room for `more` bytes and the zeros after them. */
static ncr_status make_room(const ncr_ctx *ctx, ncr_gltf_images *images, size_t more)
{
    if (images->size + more + 4 <= images->room)
        return NCR_OK;
    const size_t room = 2 * images->room + more + 4;
    uint8_t *data = ncr_alloc(ctx, room);
    if (!data)
        return NCR_E_NOMEM;
    if (images->size)
        memcpy(data, images->data, images->size);
    ncr_free(ctx, images->data);
    images->data = data;
    images->room = room;
    return NCR_OK;
}

ncr_status ncr_gltf_add_png(const ncr_ctx *ctx, ncr_gltf_images *images, uint32_t size,
                            const uint8_t *rgba)
{
    png_image png = {
        .version = PNG_IMAGE_VERSION, .width = size, .height = size, .format = PNG_FORMAT_RGBA};
    png_alloc_size_t length = PNG_IMAGE_PNG_SIZE_MAX(png);
    const ncr_status status = make_room(ctx, images, length);
    if (status != NCR_OK)
        return status;
    if (!png_image_write_to_memory(&png, images->data + images->size, &length, 0, rgba, 0, NULL))
        return ncr_fail(ctx, NCR_E_BACKEND, "a face cannot be packed as PNG: %s", png.message);
    images->offset[images->count] = images->size;
    images->length[images->count++] = length;
    images->size += length;
    while (images->size % 4)
        images->data[images->size++] = 0;
    return NCR_OK;
}

/* ---- JSON ---- */

static json_t *face_numbers(uint32_t count)
{
    json_t *levels = json_array();
    for (uint32_t k = 0; k < count; k += 6) {
        json_t *faces = json_array();
        for (uint32_t f = 0; f < 6; f++)
            json_array_append_new(faces, json_integer(k + f));
        json_array_append_new(levels, faces);
    }
    return levels;
}

static json_t *coefficients(const double irradiance[9][3], double intensity)
{
    json_t *list = json_array();
    for (int k = 0; k < 9; k++)
        json_array_append_new(list, json_pack("[f,f,f]", irradiance[k][0] / intensity,
                                              irradiance[k][1] / intensity,
                                              irradiance[k][2] / intensity));
    return list;
}

/* What a reader of the file should know and the extension has no word for. */
static json_t *extras(const ncr_gltf_light_report *r)
{
    return json_pack(
        "{s:{s:s, s:s, s:{s:I, s:f, s:f, s:f}}}", "nacre", "encoding",
        "RGBD: radiance / intensity = (rgb/255)^2.2 / (a/255)", "irradiance",
        "E(n) = sum c_lm Y_lm(-x, y, z), real orthonormal Y times (-1)^m, not divided by pi; "
        "+Y up",
        "packing", "clamped", (json_int_t)r->clamped, "lost", r->lost, "worst", r->worst, "rms",
        r->rms);
}

static json_t *light(const ncr_gltf_images *images, uint32_t size, const double irradiance[9][3],
                     const ncr_gltf_light_opts *o, const ncr_gltf_light_report *report)
{
    json_t *out =
        json_pack("{s:f, s:i, s:o, s:o, s:o}", "intensity", o->intensity, "specularImageSize",
                  (int)size, "irradianceCoefficients", coefficients(irradiance, o->intensity),
                  "specularImages", face_numbers(images->count), "extras", extras(report));
    if (o->name)
        json_object_set_new(out, "name", json_string(o->name));
    return out;
}

static json_t *views(const ncr_gltf_images *images)
{
    json_t *list = json_array();
    for (uint32_t k = 0; k < images->count; k++)
        json_array_append_new(list, json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset",
                                              (json_int_t)images->offset[k], "byteLength",
                                              (json_int_t)images->length[k]));
    return list;
}

static json_t *pictures(const ncr_gltf_images *images)
{
    static const char *const names[6] = {"px", "nx", "py", "ny", "pz", "nz"};
    json_t *list = json_array();
    for (uint32_t k = 0; k < images->count; k++) {
        char name[32];
        snprintf(name, sizeof name, "level %u %s", k / 6, names[k % 6]);
        json_array_append_new(list, json_pack("{s:i, s:s, s:s}", "bufferView", (int)k, "mimeType",
                                              "image/png", "name", name));
    }
    return list;
}

/* NULL when memory is out. A buffer without uri is the binary chunk's. */
static json_t *document(const ncr_gltf_images *images, json_t *the_light, const char *uri)
{
    char generator[64];
    snprintf(generator, sizeof generator, "nacre %d.%d.%d", NCR_VERSION_MAJOR, NCR_VERSION_MINOR,
             NCR_VERSION_PATCH);
    json_t *buffer = json_pack("{s:I}", "byteLength", (json_int_t)images->size);
    if (uri)
        json_object_set_new(buffer, "uri", json_string(uri));
    return json_pack(
        "{s:{s:s, s:s}, s:[s], s:{s:{s:[o]}}, s:i, s:[{s:{s:{s:i}}}], s:o, s:o, s:[o]}", "asset",
        "version", "2.0", "generator", generator, "extensionsUsed", EXTENSION, "extensions",
        EXTENSION, "lights", the_light, "scene", 0, "scenes", "extensions", EXTENSION, "light", 0,
        "images", pictures(images), "bufferViews", views(images), "buffers", buffer);
}

/* ---- Containers ---- */

static char *base64(const ncr_ctx *ctx, const ncr_gltf_images *images)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static const char head[] = "data:application/octet-stream;base64,";
    const size_t n = images->size;
    char *out = ncr_alloc(ctx, sizeof head + (n + 2) / 3 * 4);
    if (!out)
        return NULL;
    memcpy(out, head, sizeof head);
    char *at = out + sizeof head - 1;
    for (size_t k = 0; k < n; k += 3) {
        const uint32_t left = (uint32_t)(n - k), b = k + 1 < n ? images->data[k + 1] : 0;
        const uint32_t bits =
            (uint32_t)images->data[k] << 16 | b << 8 | (k + 2 < n ? images->data[k + 2] : 0u);
        for (uint32_t d = 0; d < 4; d++)
            *at++ = d <= left ? digit[bits >> (18 - 6 * d) & 63] : '=';
    }
    *at = 0;
    return out;
}

static void put32(FILE *out, uint32_t x)
{
    for (int k = 0; k < 4; k++)
        fputc((int)(x >> 8 * k & 255), out);
}

/* Header, JSON padded with spaces, binary chunk.                                          [glTF] */
static void put_binary(FILE *out, const char *text, const ncr_gltf_images *images)
{
    const uint32_t length = (uint32_t)strlen(text), padded = (length + 3) & ~3u;
    put32(out, 0x46546c67);
    put32(out, 2);
    put32(out, (uint32_t)(12 + 8 + padded + 8 + images->size));
    put32(out, padded);
    put32(out, 0x4e4f534a);
    fputs(text, out);
    for (uint32_t k = length; k < padded; k++)
        fputc(' ', out);
    put32(out, (uint32_t)images->size);
    put32(out, 0x004e4942);
    fwrite(images->data, 1, images->size, out);
}

static ncr_status put_text(const ncr_ctx *ctx, const char *path, const char *text,
                           const ncr_gltf_images *images, bool binary)
{
    ncr_atomic_file file;
    const ncr_status status = ncr_atomic_file_open(ctx, path, &file);
    if (status != NCR_OK)
        return status;
    if (binary)
        put_binary(file.stream, text, images);
    else
        fprintf(file.stream, "%s\n", text);
    return ncr_atomic_file_commit(ctx, &file);
}

ncr_status ncr_gltf_put_file(const ncr_ctx *ctx, const char *path, const ncr_gltf_images *images,
                             uint32_t size, const double irradiance[9][3],
                             const ncr_gltf_light_opts *opts, const ncr_gltf_light_report *report)
{
    const char *dot = strrchr(path, '.');
    const bool binary = dot && !strcasecmp(dot, ".glb");
    if (!binary && (!dot || strcasecmp(dot, ".gltf")))
        return ncr_fail(ctx, NCR_E_ARG, "%s: the extension must be .glb or .gltf", path);
    if (images->size > 0xf0000000u)
        return ncr_fail(ctx, NCR_E_LIMIT, "%s: glTF files end at 4 GB", path);
    char *uri = binary ? NULL : base64(ctx, images);
    if (!binary && !uri)
        return NCR_E_NOMEM;
    json_t *root = document(images, light(images, size, irradiance, opts, report), uri);
    char *text =
        root ? json_dumps(root, JSON_REAL_PRECISION(9) | JSON_INDENT(binary ? 0 : 1)) : NULL;
    const ncr_status status = text ? put_text(ctx, path, text, images, binary)
                                   : ncr_fail(ctx, NCR_E_NOMEM, "%s: no memory for its JSON", path);
    free(text);
    json_decref(root);
    ncr_free(ctx, uri);
    return status;
}
