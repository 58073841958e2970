/* SPDX-License-Identifier: MIT */
#include "apps/map_options.h"

#include "apps/map_words.h"

ncr_status map_in_read(const app *a, const map_in_options *o, const char *file,
                       ncr_directional_map *out, ncr_map_file_report *report)
{
    ncr_map_stated as;
    ncr_status status = map_from_word(a, o->from, file, &as.convention);
    if (status == NCR_OK)
        status = map_up_word(a, "--from-up", o->up, &as.world);
    if (status == NCR_OK && !as.convention) {
        status = ncr_map_file_stated(&a->ctx, file, &as);
        if (status == NCR_OK && !as.convention)
            return ncr_fail(
                &a->ctx, NCR_E_ARG,
                "%s: does not say how it lies: name its convention with --from, such as "
                "usd for a panorama with y up (docs/maps.md lists them)",
                file);
    }
    return status == NCR_OK ? ncr_map_file_read(&a->ctx, file, as, out, report) : status;
}

ncr_status map_out_layout(const app *a, const map_out_options *o, const char *flag,
                          const char *kind, ncr_map_stated *out)
{
    ncr_map_kind is;
    if (o->half + o->single + o->rgb9e5 > 1)
        return ncr_fail(&a->ctx, NCR_E_ARG, "--half, --float and --rgb9e5 exclude each other");
    ncr_status status = map_kind_word(a, flag, kind, &is);
    if (status == NCR_OK)
        status = map_convention_word(a, o->convention, is, &out->convention);
    if (status == NCR_OK)
        status = map_up_word(a, "--up", o->up, &out->world);
    return status;
}

ncr_map_file_opts map_out_file(const map_out_options *o, ncr_map_stated as)
{
    return (ncr_map_file_opts){.struct_size = sizeof(ncr_map_file_opts),
                               .as = as,
                               .half = o->half,
                               .exposure = o->exposure,
                               .ktx2 = o->rgb9e5   ? NCR_KTX2_RGB9E5
                                       : o->single ? NCR_KTX2_FLOAT
                                                   : NCR_KTX2_HALF};
}
