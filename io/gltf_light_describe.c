/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [glTF]    Khronos. glTF 2.0 Specification: the binary container. 2021
 *   [EXTibl]  G. Hsu, M. Bond. glTF extension EXT_lights_image_based. 2019
 */
#include "io/atomic_file_internal.h"
#include "io/gltf_light.h"
#include "io/json_internal.h"

#include <math.h>
#include <string.h>

static const size_t most_bytes = (size_t)1 << 32;

static uint32_t number_at(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static ncr_status broken(const ncr_ctx *ctx, const char *path, const char *what)
{
    return ncr_fail(ctx, NCR_E_FORMAT, "%s: %s", path, what);
}

/* Where the JSON lies: the whole of a .gltf, the first chunk of a .glb. */
static ncr_status find_text(const ncr_ctx *ctx, const char *path, const uint8_t *data, size_t size,
                            const char **text, size_t *length)
{
    *text = (const char *)data;
    *length = size;
    if (size < 4 || memcmp(data, "glTF", 4))
        return NCR_OK;
    if (size < 20 || number_at(data + 4) != 2)
        return broken(ctx, path, "no binary glTF of version 2");
    if (number_at(data + 8) != size)
        return broken(ctx, path, "another length than its header says");
    if (memcmp(data + 16, "JSON", 4) || number_at(data + 12) > size - 20)
        return broken(ctx, path, "its first chunk is no JSON, or ends beyond the file");
    *text += 20;
    *length = number_at(data + 12);
    return NCR_OK;
}

/* Levels and faces are numbers of images that are there. */
static uint32_t count_levels(const ncr_json *light, size_t images)
{
    const ncr_json levels = ncr_json_member(light, "specularImages");
    ncr_json_need(&levels, "levels of six faces");
    const size_t count = ncr_json_array(&levels, 1, NCR_GLTF_LEVELS, "levels");
    for (size_t k = 0; k < count; k++) {
        const ncr_json level = ncr_json_element(&levels, k);
        for (size_t face = ncr_json_array(&level, 6, 6, "faces"); face-- > 0;) {
            const ncr_json image = ncr_json_element(&level, face);
            uint32_t index;
            if (images)
                ncr_json_count(image, 0, (uint32_t)images - 1, &index);
            else
                ncr_json_fail(&image, "the file has no images");
        }
    }
    return (uint32_t)count;
}

static void read_light(const ncr_json *light, size_t images, ncr_gltf_light_info *out)
{
    const ncr_json size = ncr_json_member(light, "specularImageSize");
    const ncr_json irradiance = ncr_json_member(light, "irradianceCoefficients");
    const char *name = "";
    double first[3] = {0};
    out->intensity = 1;
    ncr_json_string(ncr_json_member(light, "name"), &name);
    ncr_json_number(ncr_json_member(light, "intensity"), 0, 1e30, &out->intensity);
    ncr_json_need(&size, "the size of faces");
    ncr_json_count(size, 1, NCR_MAP_SIZE_MAX, &out->size);
    ncr_json_need(&irradiance, "nine coefficients");
    if (ncr_json_array(&irradiance, 9, 9, "coefficients"))
        ncr_json_numbers(ncr_json_element(&irradiance, 0), 3, -1e30, 1e30, first);
    out->levels = count_levels(light, images);
    snprintf(out->name, sizeof out->name, "%s", name);
    for (int c = 0; c < 3; c++) /* c00 = pi Y00 int L, Y00 = 1/sqrt(4 pi) */
        out->mean[c] = out->intensity * first[c] / (2 * 5.56832799683170785); /* 2 pi^1.5 */
}

static void read_document(ncr_json_doc *doc, ncr_gltf_light_info *out)
{
    const ncr_json root = ncr_json_root(doc), all = ncr_json_member(&root, "images");
    const ncr_json extensions = ncr_json_member(&root, "extensions");
    const ncr_json ours = ncr_json_member(&extensions, "EXT_lights_image_based");
    const ncr_json lights = ncr_json_member(&ours, "lights");
    ncr_json_need(&lights, "lights of EXT_lights_image_based");
    out->lights = (uint32_t)ncr_json_array(&lights, 1, 1 << 16, "lights");
    const size_t images = ncr_json_array(&all, 0, 1 << 24, "images");
    const ncr_json light = ncr_json_element(&lights, 0);
    if (out->lights)
        read_light(&light, images, out);
}

ncr_status ncr_gltf_light_describe(const ncr_ctx *ctx, const char *path, ncr_gltf_light_info *out)
{
    ncr_gltf_light_info found = {0};
    uint8_t *data;
    const char *text;
    size_t size, length;
    ncr_json_doc doc;
    ncr_status status = ncr_file_read(ctx, path, most_bytes, &data, &size);
    if (status != NCR_OK)
        return status;
    status = find_text(ctx, path, data, size, &text, &length);
    if (status == NCR_OK)
        status = ncr_json_parse(ctx, path, text, length, &doc);
    if (status == NCR_OK) {
        read_document(&doc, &found);
        status = doc.status;
        ncr_json_dispose(&doc);
    }
    found.bytes = size;
    ncr_free(ctx, data);
    if (status == NCR_OK)
        *out = found;
    return status;
}
