/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"
#include "io/image_file.h"
#include "io/json_internal.h"
#include "io/rsibr_internal.h"

#include "core/vec_internal.h"

#include <string.h>

enum { manifest_bytes = 1 << 22 };

static const double huge = 1e9;

static void read_fresnel(ncr_json at, ncr_fresnel *out)
{
    static const char *const known[] = {"eta", "k"};
    if (!ncr_json_only(&at, NCR_WORDS(known)))
        return;
    ncr_json_number(ncr_json_member(&at, "eta"), 0, huge, &out->eta);
    ncr_json_number(ncr_json_member(&at, "k"), 0, huge, &out->k);
}

static void read_lobe(ncr_json at, ncr_rsibr_lobe *out)
{
    static const char *const known[] = {"kind",      "colour", "exponent", "facets",
                                        "shadowing", "alpha",  "fresnel",  "coat",
                                        "through",   "albedo", "along",    "across"};
    size_t kind = 0, facets = 0, shadowing = 0;
    const ncr_json kind_at = ncr_json_member(&at, "kind");
    ncr_json_only(&at, NCR_WORDS(known));
    ncr_json_need(&kind_at, "the kind of a lobe");
    ncr_json_word(kind_at, NCR_WORDS(ncr_rsibr_kinds), &kind);
    ncr_json_floats(ncr_json_member(&at, "colour"), 3, 0, 1e6, out->colour);
    ncr_json_number(ncr_json_member(&at, "exponent"), 0, 1e6, &out->exponent);
    ncr_json_word(ncr_json_member(&at, "facets"), NCR_WORDS(ncr_rsibr_facets), &facets);
    ncr_json_word(ncr_json_member(&at, "shadowing"), NCR_WORDS(ncr_rsibr_shadowings), &shadowing);
    ncr_json_number(ncr_json_member(&at, "alpha"), 0, 4, &out->gloss.facets.alpha);
    ncr_json_number(ncr_json_member(&at, "along"), 0, 4, &out->brushed.along);
    ncr_json_number(ncr_json_member(&at, "across"), 0, 4, &out->brushed.across);
    read_fresnel(ncr_json_member(&at, "fresnel"), &out->gloss.fresnel);
    read_fresnel(ncr_json_member(&at, "coat"), &out->coat);
    ncr_json_number(ncr_json_member(&at, "through"), 0, 8, &out->through);
    out->kind = (ncr_rsibr_kind)kind;
    out->gloss.facets.facets = (ncr_facets)facets;
    out->gloss.facets.shadowing = (ncr_shadowing)shadowing;
}

/* What has to be known before there can be a set. */
static void read_shape(const ncr_json *root, ncr_rsibr_brdf *brdf, ncr_rsibr_opts *opts)
{
    static const char *const known[] = {"format", "size",   "raw",  "single",     "turns",
                                        "lobes",  "sheets", "eyes", "conventions"};
    const char *format = "";
    const ncr_json format_at = ncr_json_member(root, "format");
    const ncr_json size_at = ncr_json_member(root, "size"), eyes_at = ncr_json_member(root, "eyes");
    const ncr_json lobes_at = ncr_json_member(root, "lobes");
    if (!ncr_json_only(root, NCR_WORDS(known)))
        return;
    ncr_json_need(&format_at, "a format");
    ncr_json_string(format_at, &format);
    if (root->doc->status == NCR_OK && strcmp(format, ncr_rsibr_format))
        ncr_json_fail(&format_at, "is \"%s\", not \"%s\"", format, ncr_rsibr_format);
    ncr_json_need(&size_at, "texels along a map");
    ncr_json_need(&eyes_at, "eyes");
    ncr_json_need(&lobes_at, "lobes");
    ncr_json_count(size_at, 2, NCR_RSIBR_SIZE_MAX, &opts->size);
    ncr_json_bool(ncr_json_member(root, "raw"), &opts->raw);
    ncr_json_bool(ncr_json_member(root, "single"), &opts->single);
    ncr_json_count(ncr_json_member(root, "turns"), 0, NCR_RSIBR_TURNS_MAX, &opts->turns);
    opts->views = (uint32_t)ncr_json_array(&eyes_at, 12, 642, "12, 42, 162 or 642 eyes");
    brdf->lobe_count = (uint32_t)ncr_json_array(&lobes_at, 1, NCR_RSIBR_LOBES, "1 to 4 lobes");
    for (uint32_t k = 0; k < brdf->lobe_count; k++)
        read_lobe(ncr_json_element(&lobes_at, k), &brdf->lobe[k]);
}

/* Eyes stand where the view sphere has them; how they are turned about their axes is theirs. */
static void read_eye(ncr_json at, const double view[3], ncr_rsibr_frame *out)
{
    static const char *const axes[] = {"right", "up", "toward"};
    double square = 0;
    if (!ncr_json_only(&at, NCR_WORDS(axes)))
        return;
    for (int i = 0; i < 3; i++)
        ncr_json_numbers(ncr_json_member(&at, axes[i]), 3, -1.001, 1.001, out->axis[i]);
    double across[3];
    d_cross(out->axis[0], out->axis[1], across);
    for (int i = 0; i < 3; i++)
        square += pow(across[i] - view[i], 2) + pow(out->axis[2][i] - view[i], 2);
    for (int i = 0; i < 2; i++)
        square += pow(d_dot(out->axis[i], out->axis[i]) - 1, 2);
    if (at.doc->status == NCR_OK && !(square < 1e-12))
        ncr_json_fail(&at, "is no right-handed frame about (%.4f, %.4f, %.4f)", view[0], view[1],
                      view[2]);
}

static void read_details(const ncr_json *root, ncr_rsibr *set)
{
    const ncr_json eyes = ncr_json_member(root, "eyes"), lobes = ncr_json_member(root, "lobes");
    for (uint32_t k = 0; k < set->sphere.view_count; k++)
        read_eye(ncr_json_element(&eyes, k), set->sphere.view[k], &set->frame[k]);
    for (uint32_t k = 0; k < set->brdf.lobe_count; k++) {
        const ncr_json lobe = ncr_json_element(&lobes, k);
        const ncr_json table = ncr_json_member(&lobe, "albedo");
        uint32_t count;
        float *albedo = ncr_rsibr_albedo_table(set, k, &count);
        if (!count)
            continue;
        ncr_json_need(&table, "the albedo of a gloss");
        ncr_json_floats(table, count, 0, 1e3, albedo);
    }
}

static ncr_status read_sheet(const ncr_ctx *ctx, const char *folder, const char *name, uint32_t crc,
                             uint32_t map, const ncr_rsibr *set)
{
    ncr_rsibr_path path;
    ncr_image sheet = {0}, want = {0};
    uint64_t nonfinite = 0;
    ncr_status status = ncr_rsibr_join(ctx, folder, name, &path);
    if (status == NCR_OK)
        status = ncr_image_read(ctx, path.text, &sheet, &nonfinite);
    if (status == NCR_OK)
        status = ncr_rsibr_sheet_init(ctx, set, &want);
    if (status == NCR_OK && (sheet.width != want.width || sheet.height != want.height ||
                             sheet.channels != 3 || nonfinite))
        status = ncr_fail(ctx, NCR_E_FORMAT, "%s: is not a sheet of %u x %u finite texels",
                          path.text, want.width, want.height);
    if (status == NCR_OK && ncr_rsibr_sheet_crc(&sheet) != crc)
        status = ncr_fail(ctx, NCR_E_FORMAT, "%s: is not what %s was written with", path.text,
                          NCR_RSIBR_MANIFEST);
    if (status == NCR_OK)
        ncr_rsibr_sheet_copy(set, map, true, &sheet);
    ncr_image_dispose(ctx, &sheet);
    ncr_image_dispose(ctx, &want);
    return status;
}

static ncr_status read_sheets(const ncr_ctx *ctx, const char *folder, const ncr_json *root,
                              const ncr_rsibr *set)
{
    static const char *const known[] = {"file", "crc32"};
    const ncr_json sheets = ncr_json_member(root, "sheets");
    ncr_json_need(&sheets, "sheets");
    ncr_json_array(&sheets, set->maps, set->maps, "as many sheets as maps of each eye");
    ncr_status status = root->doc->status;
    for (uint32_t k = 0; status == NCR_OK && k < set->maps; k++) {
        const ncr_json at = ncr_json_element(&sheets, k), name_at = ncr_json_member(&at, "file");
        const char *name = "";
        uint32_t crc = 0;
        ncr_json_only(&at, NCR_WORDS(known));
        ncr_json_need(&name_at, "the name of a file");
        ncr_json_string(name_at, &name);
        ncr_json_count(ncr_json_member(&at, "crc32"), 0, UINT32_MAX, &crc);
        if (root->doc->status == NCR_OK && strchr(name, '/'))
            ncr_json_fail(&name_at, "names a file elsewhere");
        status = root->doc->status;
        if (status == NCR_OK)
            status = read_sheet(ctx, folder, name, crc, k, set);
    }
    return status;
}

static ncr_status read_set(const ncr_ctx *ctx, const char *folder, ncr_json_doc *doc,
                           ncr_rsibr *out)
{
    const ncr_json root = ncr_json_root(doc);
    ncr_rsibr_brdf brdf = {0};
    ncr_rsibr_opts opts = {.struct_size = sizeof opts};
    read_shape(&root, &brdf, &opts);
    if (doc->status != NCR_OK)
        return doc->status;
    ncr_status status = ncr_rsibr_init(ctx, &brdf, &opts, out);
    if (status == NCR_E_ARG)
        return ncr_fail(ctx, NCR_E_FORMAT, "%s: is no set of radiance maps", doc->name);
    if (status != NCR_OK)
        return status;
    read_details(&root, out);
    status = doc->status;
    if (status == NCR_OK)
        status = read_sheets(ctx, folder, &root, out);
    if (status != NCR_OK)
        ncr_rsibr_dispose(ctx, out);
    return status;
}

ncr_status ncr_rsibr_read(const ncr_ctx *ctx, const char *folder, ncr_rsibr *out)
{
    *out = (ncr_rsibr){0};
    ncr_rsibr_path path;
    uint8_t *text;
    size_t length;
    ncr_json_doc doc;
    ncr_c_locale locale;
    ncr_status status = ncr_rsibr_join(ctx, folder, NCR_RSIBR_MANIFEST, &path);
    if (status == NCR_OK)
        status = ncr_file_read(ctx, path.text, manifest_bytes, &text, &length);
    if (status != NCR_OK)
        return status;
    status = ncr_c_locale_enter(ctx, &locale);
    if (status == NCR_OK) {
        status = ncr_json_parse(ctx, path.text, (const char *)text, length, &doc);
        ncr_c_locale_leave(&locale);
    }
    ncr_free(ctx, text);
    if (status != NCR_OK)
        return status;
    status = read_set(ctx, folder, &doc, out);
    ncr_json_dispose(&doc);
    return status;
}
