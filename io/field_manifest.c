/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"
#include "io/field_internal.h"
#include "io/json_internal.h"
#include "io/tile_runs_internal.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <zlib.h>

static const size_t max_bytes = 2 * NCR_FIELD_RUNS_MAX;
static const char *const format_words[] = {"half", "float"};

ncr_field_path ncr_field_join(const char *folder, const char *name)
{
    ncr_field_path p;
    snprintf(p.text, sizeof p.text, "%s/%s", folder, name);
    return p;
}

void ncr_field_file_name(uint32_t k, char name[32])
{
    static const char *const fixed[] = {"points.ply", "charts.bin", "radiance.exr"};
    if (k < 3)
        snprintf(name, 32, "%s", fixed[k]);
    else
        snprintf(name, 32, "maps-%u.png", k - 3);
}

ncr_status ncr_field_entry_of(const ncr_ctx *ctx, const char *path, ncr_field_entry *out)
{
    enum { piece = 1 << 18 };
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
    uint8_t *buffer = ncr_alloc(ctx, piece);
    uLong crc = crc32(0, Z_NULL, 0);
    uint64_t bytes = 0;
    for (size_t n; buffer && (n = fread(buffer, 1, piece, stream)) > 0; bytes += n)
        crc = crc32(crc, buffer, (uInt)n);
    const bool good = !ferror(stream);
    const int why = errno;
    fclose(stream);
    ncr_free(ctx, buffer);
    if (!buffer)
        return NCR_E_NOMEM;
    if (!good)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be read: %s", path, strerror(why));
    *out = (ncr_field_entry){.bytes = bytes, .crc = (uint32_t)crc};
    return NCR_OK;
}

size_t ncr_field_tiles(const ncr_field_manifest *manifest)
{
    return ncr_tile_number(manifest->cube, manifest->points, 0, 0, 0);
}

void ncr_field_manifest_dispose(const ncr_ctx *ctx, ncr_field_manifest *manifest)
{
    ncr_free(ctx, manifest->files);
    ncr_free(ctx, manifest->omitted);
    *manifest = (ncr_field_manifest){0};
}

/* ---- Writing. jansson's setters and packers accept the NULL of one that failed before, and fail
 * too: one check at the end is enough. ---- */

static json_t *conventions(void)
{
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:s, s:s}", "axes",
        "right-handed, the world's; lengths in field files are model units unless said otherwise",
        "frame", "frame = (model - centre) 2^-exponent", "faces",
        "+X -X +Y -Y +Z -Z from left to right, oriented as OpenGL and KTX do", "texels",
        "centres at +0.5, row 0 on top", "radiance",
        "linear, scene-referred, Rec. 709; stored value = radiance 2^-exponent", "depth",
        "Z is the radial distance from the point in frame units, infinity for the sky", "maps",
        "candidates by rising distance, 65535 for none; charts of one patch each, u to the right, "
        "v down");
}

static json_t *omission(const ncr_field_omission *o)
{
    return json_pack("{s:s, s:s, s:f, s:I, s:I}", "part", o->part, "reason", o->reason, "bound",
                     o->bound, "saved_rays", (json_int_t)o->saved_rays, "saved_bytes",
                     (json_int_t)o->saved_bytes);
}

static json_t *omissions(size_t count, const ncr_field_omission *omitted)
{
    json_t *list = json_array();
    for (size_t k = 0; k < count; k++) {
        if (json_array_append_new(list, omission(&omitted[k])) != 0) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

static json_t *file_list(const ncr_field_manifest *m)
{
    json_t *list = json_object();
    for (uint32_t k = 0; k < 3 + m->pages; k++) {
        char name[32], crc[16];
        ncr_field_file_name(k, name);
        snprintf(crc, sizeof crc, "%08x", m->files[k].crc);
        json_t *entry =
            json_pack("{s:I, s:s}", "bytes", (json_int_t)m->files[k].bytes, "crc32", crc);
        if (json_object_set_new(list, name, entry) != 0) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

static json_t *manifest_object(const ncr_field_manifest *m, size_t omitted_count,
                               const ncr_field_omission *omitted)
{
    json_t *frame = json_pack("{s:[fff], s:i}", "centre", m->frame.centre[0], m->frame.centre[1],
                              m->frame.centre[2], "exponent", m->frame.exponent);
    json_t *parameters = json_pack("{s:f, s:f, s:b}", "epsilon", m->epsilon, "horizon_deg",
                                   m->horizon_deg, "occlusion", (int)m->occlusion);
    json_t *counts =
        json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "points", (json_int_t)m->points, "patches",
                  (json_int_t)m->patches, "cube", (json_int_t)m->cube, "pages",
                  (json_int_t)m->pages, "page_width", (json_int_t)m->page_width, "page_height",
                  (json_int_t)m->page_height, "clamped", (json_int_t)m->clamped);
    json_t *encoding =
        json_pack("{s:s, s:i, s:b, s:s}", "radiance", format_words[m->format], "exponent",
                  m->exponent, "depth", (int)m->depth, "byte_order", "little");
    return json_pack("{s:s, s:i, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "format",
                     "nacre field", "version", NCR_FIELD_VERSION, "object", m->object, "scene_hash",
                     m->scene_hash, "frame", frame, "parameters", parameters, "counts", counts,
                     "encoding", encoding, "conventions", conventions(), "omitted",
                     omissions(omitted_count, omitted), "files", file_list(m));
}

static ncr_status add_omitted_tiles(const ncr_ctx *ctx, const ncr_field_manifest *m, json_t *object)
{
    if (!m->omitted)
        return NCR_OK;
    const size_t tiles = ncr_field_tiles(m);
    char *text;
    const ncr_status status = ncr_tile_runs_write(ctx, m->omitted, tiles, &text);
    if (status != NCR_OK)
        return status;
    json_t *set = json_pack("{s:I, s:s}", "count",
                            (json_int_t)ncr_tile_set_count(m->omitted, tiles), "runs", text);
    ncr_free(ctx, text);
    return json_object_set_new(object, "omitted_tiles", set) == 0 ? NCR_OK : NCR_E_NOMEM;
}

static ncr_status write_object(const ncr_ctx *ctx, const char *path, const json_t *object)
{
    ncr_atomic_file file;
    const ncr_status status = ncr_atomic_file_open(ctx, path, &file);
    if (status != NCR_OK)
        return status;
    const bool good =
        json_dumpf(object, file.stream, JSON_INDENT(2)) == 0 && fputc('\n', file.stream) != EOF;
    return ncr_atomic_file_close(
        ctx, &file, good ? NCR_OK : ncr_fail(ctx, NCR_E_IO, "%s: cannot be written", path));
}

ncr_status ncr_field_manifest_write(const ncr_ctx *ctx, const char *path,
                                    const ncr_field_manifest *manifest, size_t omitted_count,
                                    const ncr_field_omission *omitted)
{
    json_t *object = manifest_object(manifest, omitted_count, omitted);
    if (!object)
        return ncr_fail(ctx, NCR_E_ARG,
                        "%s: a name is not UTF-8, a number not finite, or memory is out", path);
    ncr_status status = add_omitted_tiles(ctx, manifest, object);
    if (status == NCR_OK)
        status = write_object(ctx, path, object);
    json_decref(object);
    return status;
}

/* ---- Reading ---- */

static void copy_text(ncr_json at, size_t size, char *out)
{
    ncr_json_need(&at, "a string");
    if (!ncr_json_present(&at))
        return;
    if (!json_is_string(at.value) || json_string_length(at.value) >= size)
        ncr_json_expected(&at, "a string of up to %zu bytes", size - 1);
    else
        memcpy(out, json_string_value(at.value), json_string_length(at.value) + 1);
}

static void need_number(const ncr_json *in, const char *key, double low, double high, double *out)
{
    const ncr_json at = ncr_json_member(in, key);
    ncr_json_need(&at, "a number");
    ncr_json_number(at, low, high, out);
}

static void need_count(const ncr_json *in, const char *key, uint32_t low, uint32_t high,
                       uint32_t *out)
{
    const ncr_json at = ncr_json_member(in, key);
    ncr_json_need(&at, "a whole number");
    ncr_json_count(at, low, high, out);
}

static void need_size(const ncr_json *in, const char *key, uint64_t *out)
{
    const ncr_json at = ncr_json_member(in, key);
    ncr_json_need(&at, "a whole number");
    if (!ncr_json_present(&at))
        return;
    if (!json_is_integer(at.value) || json_integer_value(at.value) < 0)
        ncr_json_expected(&at, "a whole number from 0");
    else
        *out = (uint64_t)json_integer_value(at.value);
}

static void need_exponent(const ncr_json *in, int limit, int *out)
{
    const ncr_json at = ncr_json_member(in, "exponent");
    ncr_json_need(&at, "a whole number");
    if (!ncr_json_present(&at))
        return;
    const json_int_t x = json_integer_value(at.value);
    if (!json_is_integer(at.value) || x < -limit || x > limit)
        ncr_json_expected(&at, "a whole number from %d to %d", -limit, limit);
    else
        *out = (int)x;
}

static void need_bool(const ncr_json *in, const char *key, bool *out)
{
    const ncr_json at = ncr_json_member(in, key);
    ncr_json_need(&at, "true or false");
    ncr_json_bool(at, out);
}

static void read_version(const ncr_json *root)
{
    static const char *const words[] = {"nacre field"};
    size_t word = 0;
    uint32_t version = 0;
    const ncr_json format = ncr_json_member(root, "format");
    const ncr_json at = ncr_json_member(root, "version");
    ncr_json_need(&format, "\"nacre field\"");
    ncr_json_word(format, NCR_WORDS(words), &word);
    need_count(root, "version", 1, UINT32_MAX, &version);
    if (ncr_json_present(&at) && version != NCR_FIELD_VERSION)
        ncr_json_fail(&at, "version %u is not known, only %d", version, NCR_FIELD_VERSION);
}

static void read_object(const ncr_json *root, ncr_field_manifest *m)
{
    const ncr_json frame = ncr_json_member(root, "frame");
    const ncr_json centre = ncr_json_member(&frame, "centre");
    copy_text(ncr_json_member(root, "object"), sizeof m->object, m->object);
    copy_text(ncr_json_member(root, "scene_hash"), sizeof m->scene_hash, m->scene_hash);
    ncr_json_need(&centre, "three numbers");
    ncr_json_numbers(centre, 3, -INFINITY, INFINITY, m->frame.centre);
    need_exponent(&frame, 1100, &m->frame.exponent);
}

static void read_parameters(const ncr_json *root, ncr_field_manifest *m)
{
    const ncr_json parameters = ncr_json_member(root, "parameters");
    const ncr_json encoding = ncr_json_member(root, "encoding");
    need_number(&parameters, "epsilon", 0, INFINITY, &m->epsilon);
    need_number(&parameters, "horizon_deg", 0, 90, &m->horizon_deg);
    need_bool(&parameters, "occlusion", &m->occlusion);

    size_t format = 0;
    const ncr_json radiance = ncr_json_member(&encoding, "radiance");
    ncr_json_need(&radiance, "\"half\" or \"float\"");
    ncr_json_word(radiance, NCR_WORDS(format_words), &format);
    m->format = format == 0 ? NCR_TEXEL_HALF : NCR_TEXEL_FLOAT;
    need_exponent(&encoding, 64, &m->exponent);
    need_bool(&encoding, "depth", &m->depth);

    static const char *const orders[] = {"little"}; /* absent from the first fields */
    size_t order = 0;
    ncr_json_word(ncr_json_member(&encoding, "byte_order"), NCR_WORDS(orders), &order);
}

static void read_counts(const ncr_json *root, ncr_field_manifest *m)
{
    const ncr_json counts = ncr_json_member(root, "counts");
    need_count(&counts, "points", 1, NCR_POINTS_MAX, &m->points);
    need_count(&counts, "patches", 1, NCR_FIELD_PATCHES_MAX, &m->patches);
    need_count(&counts, "cube", 1, 4096, &m->cube);
    need_count(&counts, "pages", 1, NCR_FIELD_PAGES_MAX, &m->pages);
    need_count(&counts, "page_width", 1, 4096, &m->page_width);
    need_count(&counts, "page_height", 1, 4096, &m->page_height);
    need_size(&counts, "clamped", &m->clamped);
}

static void read_entry(const ncr_json *list, uint32_t k, ncr_field_entry *out)
{
    char name[32], crc[9] = "";
    ncr_field_file_name(k, name);
    const ncr_json entry = ncr_json_member(list, name);
    const ncr_json at = ncr_json_member(&entry, "crc32");
    need_size(&entry, "bytes", &out->bytes);
    copy_text(at, sizeof crc, crc);
    if (strlen(crc) != 8 || strspn(crc, "0123456789abcdef") != 8)
        ncr_json_expected(&at, "8 hexadecimal digits");
    else
        sscanf(crc, "%x", &out->crc);
}

static ncr_status read_files(const ncr_ctx *ctx, const ncr_json *root, ncr_field_manifest *m)
{
    m->files = ncr_alloc_zero(ctx, 3 + (size_t)m->pages, sizeof *m->files);
    if (!m->files)
        return NCR_E_NOMEM;
    const ncr_json list = ncr_json_member(root, "files");
    for (uint32_t k = 0; k < 3 + m->pages && root->doc->status == NCR_OK; k++)
        read_entry(&list, k, &m->files[k]);
    return root->doc->status;
}

static ncr_status read_omitted_tiles(const ncr_ctx *ctx, const ncr_json *root,
                                     ncr_field_manifest *m)
{
    const ncr_json set = ncr_json_member(root, "omitted_tiles");
    if (!ncr_json_present(&set))
        return root->doc->status;
    const size_t tiles = ncr_field_tiles(m);
    const ncr_json runs = ncr_json_member(&set, "runs");
    const char *text = "";
    uint64_t count = 0;
    need_size(&set, "count", &count);
    ncr_json_need(&runs, "a string");
    ncr_json_string(runs, &text);
    if (root->doc->status != NCR_OK)
        return root->doc->status;
    m->omitted = ncr_alloc_zero(ctx, (tiles + 7) / 8, 1);
    if (!m->omitted)
        return NCR_E_NOMEM;
    if (!ncr_tile_runs_read(text, tiles, m->omitted))
        ncr_json_fail(&runs, "is no set of %zu tiles", tiles);
    else if (ncr_tile_set_count(m->omitted, tiles) != count)
        ncr_json_fail(&set, "lists %zu tiles, its count says %llu",
                      ncr_tile_set_count(m->omitted, tiles), (unsigned long long)count);
    return root->doc->status;
}

static ncr_status read_document(const ncr_ctx *ctx, ncr_json_doc *doc, ncr_field_manifest *m)
{
    static const char *const members[] = {
        "format", "version",  "object",      "scene_hash", "frame",         "parameters",
        "counts", "encoding", "conventions", "omitted",    "omitted_tiles", "files"};
    const ncr_json root = ncr_json_root(doc);
    read_version(&root); /* first: a later version may well have other members */
    if (doc->status == NCR_OK)
        ncr_json_only(&root, NCR_WORDS(members));
    read_object(&root, m);
    read_parameters(&root, m);
    read_counts(&root, m);
    ncr_status status = doc->status;
    if (status == NCR_OK)
        status = read_files(ctx, &root, m);
    return status == NCR_OK ? read_omitted_tiles(ctx, &root, m) : status;
}

ncr_status ncr_field_manifest_read(const ncr_ctx *ctx, const char *path, ncr_field_manifest *out)
{
    *out = (ncr_field_manifest){0};
    uint8_t *text;
    size_t size;
    ncr_json_doc doc;
    ncr_status status = ncr_file_read(ctx, path, max_bytes, &text, &size);
    if (status != NCR_OK)
        return status;
    status = ncr_json_parse(ctx, path, (const char *)text, size, &doc);
    if (status == NCR_OK) {
        status = read_document(ctx, &doc, out);
        ncr_json_dispose(&doc);
    }
    ncr_free(ctx, text);
    if (status != NCR_OK)
        ncr_field_manifest_dispose(ctx, out);
    return status;
}
