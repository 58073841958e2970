/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"
#include "io/image_file.h"
#include "io/json_internal.h"
#include "io/rsibr_internal.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* jansson's setters and packers accept the NULL of one that failed before, and fail too: one check at
 * the end is enough. */

typedef struct sheet_entry {
    char name[NCR_RSIBR_NAME];
    uint32_t crc;
} sheet_entry;

static json_t *vector(const double v[3])
{
    return json_pack("[f,f,f]", v[0], v[1], v[2]);
}

static json_t *eyes(const ncr_rsibr *set)
{
    json_t *list = json_array();
    for (uint32_t k = 0; k < set->sphere.view_count; k++) {
        const ncr_rsibr_frame *f = &set->frame[k];
        json_array_append_new(list, json_pack("{s:o, s:o, s:o}", "right", vector(f->axis[0]), "up",
                                              vector(f->axis[1]), "toward", vector(f->axis[2])));
    }
    return list;
}

static json_t *fresnel(const ncr_fresnel *f)
{
    return json_pack("{s:f, s:f}", "eta", f->eta, "k", f->k);
}

static json_t *table(const float *albedo, uint32_t count)
{
    json_t *list = json_array();
    for (uint32_t k = 0; k < count; k++)
        json_array_append_new(list, json_real((double)albedo[k]));
    return list;
}

static json_t *lobes(const ncr_rsibr *set)
{
    json_t *list = json_array();
    for (uint32_t k = 0; k < set->brdf.lobe_count; k++) {
        const ncr_rsibr_lobe *l = &set->brdf.lobe[k];
        const ncr_microfacet *m = &l->gloss.facets;
        json_t *lobe = json_pack(
            "{s:s, s:[f,f,f], s:f, s:s, s:s, s:f, s:f, s:f, s:o, s:o, s:f}", "kind",
            ncr_rsibr_kinds[l->kind], "colour", (double)l->colour[0], (double)l->colour[1],
            (double)l->colour[2], "exponent", l->exponent, "facets", ncr_rsibr_facets[m->facets],
            "shadowing", ncr_rsibr_shadowings[m->shadowing], "alpha", m->alpha, "along",
            l->brushed.along, "across", l->brushed.across, "fresnel", fresnel(&l->gloss.fresnel),
            "coat", fresnel(&l->coat), "through", l->through);
        uint32_t count;
        const float *albedo = ncr_rsibr_albedo_table(set, k, &count);
        if (count)
            json_object_set_new(lobe, "albedo", table(albedo, count));
        json_array_append_new(list, lobe);
    }
    return list;
}

static json_t *conventions(void)
{
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s}", "sheets",
        "all eyes side by side: eye k in column k % columns and row k / columns, "
        "columns = ceil(sqrt(eyes))",
        "place",
        "s to the right and t down over [-1,1] of a map is the normal n with n.right = "
        "s, n.up = -t; beyond the disc the rim goes on",
        "values",
        "linear radiance, Rec. 709; unless raw, divided by the directional albedo, its "
        "colour and its coat at cosine n.toward",
        "albedo",
        "of gloss, without colour and coat, at cosine ((k + 1/2) / 256)^2; of brushed facets "
        "for 17 azimuths of the eye, i pi / 32 about the normal from the tangent, in turn",
        "turns",
        "a brushed lobe has so many sheets: sheet j for tangents whose part across the "
        "mirrored direction lies at j pi / turns from right mirrored at the normal, toward up "
        "mirrored");
}

static json_t *manifest(const ncr_rsibr *set, const sheet_entry *entries)
{
    json_t *sheets = json_array();
    for (uint32_t k = 0; k < set->maps; k++)
        json_array_append_new(sheets, json_pack("{s:s, s:I}", "file", entries[k].name, "crc32",
                                                (json_int_t)entries[k].crc));
    return json_pack("{s:s, s:i, s:b, s:b, s:i, s:o, s:o, s:o, s:o}", "format", ncr_rsibr_format,
                     "size", (int)set->size, "raw", set->raw, "single", set->single, "turns",
                     (int)set->turns, "lobes", lobes(set), "sheets", sheets, "eyes", eyes(set),
                     "conventions", conventions());
}

static ncr_status write_manifest(const ncr_ctx *ctx, const char *path, const ncr_rsibr *set,
                                 const sheet_entry *entries)
{
    ncr_atomic_file file;
    ncr_c_locale locale;
    json_t *object = manifest(set, entries);
    if (!object)
        return ncr_fail(ctx, NCR_E_NOMEM, "%s: no memory for the manifest", path);
    ncr_status status = ncr_c_locale_enter(ctx, &locale);
    if (status == NCR_OK) {
        status = ncr_atomic_file_open(ctx, path, &file);
        if (status == NCR_OK) {
            const bool good = json_dumpf(object, file.stream, JSON_INDENT(1)) == 0 &&
                              fputc('\n', file.stream) != EOF;
            status = ncr_atomic_file_close(
                ctx, &file, good ? NCR_OK : ncr_fail(ctx, NCR_E_IO, "%s: cannot be written", path));
        }
        ncr_c_locale_leave(&locale);
    }
    json_decref(object);
    return status;
}

static ncr_status write_sheet(const ncr_ctx *ctx, const char *folder, const ncr_rsibr *set,
                              uint32_t map, sheet_entry *entry)
{
    ncr_image sheet;
    ncr_rsibr_path path;
    ncr_status status = ncr_rsibr_sheet_init(ctx, set, &sheet);
    if (status != NCR_OK)
        return status;
    ncr_rsibr_sheet_copy(set, map, false, &sheet);
    entry->crc = ncr_rsibr_sheet_crc(&sheet);
    snprintf(entry->name, sizeof entry->name, "maps-%u-%08x.exr", map, entry->crc);
    status = ncr_rsibr_join(ctx, folder, entry->name, &path);
    if (status == NCR_OK)
        status = ncr_image_write(
            ctx, path.text, &sheet,
            NCR_OPTS(ncr_image_write_opts,
                     .comment = "radiance maps of one material for many eyes: see rsibr.json"));
    ncr_image_dispose(ctx, &sheet);
    return status;
}

/* Names of sheets in the manifest that is there, if there is one that can be read at all. */
static json_t *earlier_sheets(const char *path)
{
    json_t *object = json_load_file(path, 0, NULL);
    json_t *sheets = json_incref(json_object_get(object, "sheets"));
    json_decref(object);
    return sheets;
}

/* Only what has the name of a sheet of ours, and is none of the new set. */
static void remove_earlier(const ncr_ctx *ctx, const char *folder, const json_t *sheets,
                           uint32_t count, const sheet_entry *entries)
{
    size_t k;
    json_t *at;
    json_array_foreach(sheets, k, at)
    {
        const char *name = json_string_value(json_object_get(at, "file"));
        unsigned map, crc;
        int used = 0;
        ncr_rsibr_path path;
        if (!name || sscanf(name, "maps-%u-%8x.exr%n", &map, &crc, &used) != 2 || !used ||
            name[used])
            continue;
        bool kept = false;
        for (uint32_t i = 0; i < count; i++)
            kept = kept || !strcmp(entries[i].name, name);
        if (!kept && ncr_rsibr_join(ctx, folder, name, &path) == NCR_OK)
            unlink(path.text);
    }
}

ncr_status ncr_rsibr_write(const ncr_ctx *ctx, const char *folder, const ncr_rsibr *set)
{
    sheet_entry entries[NCR_RSIBR_SHEETS];
    ncr_rsibr_path path;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be made: %s", folder, strerror(errno));
    ncr_status status = ncr_rsibr_join(ctx, folder, NCR_RSIBR_MANIFEST, &path);
    if (status != NCR_OK)
        return status;
    json_t *earlier = earlier_sheets(path.text);
    for (uint32_t k = 0; status == NCR_OK && k < set->maps; k++)
        status = write_sheet(ctx, folder, set, k, &entries[k]);
    if (status == NCR_OK)
        status = write_manifest(ctx, path.text, set, entries);
    if (status == NCR_OK)
        remove_earlier(ctx, folder, earlier, set->maps, entries);
    json_decref(earlier);
    return status;
}
