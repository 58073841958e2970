/* SPDX-License-Identifier: MIT */
#include "apps/far_light.h"

#include "apps/lobe_words.h"
#include "apps/map_words.h"

#include <string.h>

enum { sky_rows = 512 };

static ncr_status read_env(const app *a, const far_light_options *o, ncr_directional_map *map)
{
    ncr_map_stated as = {0};
    ncr_map_file_report report;
    ncr_status status = map_from_word(a, o->from, o->env, &as.convention);
    if (status == NCR_OK)
        status = map_up_word(a, "--env-up", o->up, &as.world);
    if (status == NCR_OK)
        status = ncr_map_file_read(&a->ctx, o->env, as, map, &report);
    if (status == NCR_OK && (report.negative || report.nonfinite))
        app_say(a, "%s: %llu values below 0 and %llu that are not finite", o->env,
                (unsigned long long)report.negative, (unsigned long long)report.nonfinite);
    return status;
}

static ncr_status paint_sky(const app *a, const ncr_sky *sky, ncr_directional_map *map)
{
    const ncr_status status = ncr_directional_map_init(&a->ctx, NCR_MAP_LATLONG, sky_rows, 3, map);
    return status == NCR_OK ? ncr_distant_fill_sky(&a->ctx, sky, map) : status;
}

static ncr_status filter_word(const app *a, const char *word, ncr_distant_filter *out)
{
    static const char *const words[] = {"exact", "hierarchical", "two-radii"};
    *out = NCR_DISTANT_EXACT;
    for (int k = 0; word && k < 3; k++)
        if (!strcmp(word, words[k])) {
            *out = (ncr_distant_filter)k;
            return NCR_OK;
        }
    if (!word)
        return NCR_OK;
    return ncr_fail(&a->ctx, NCR_E_ARG, "--filter %s: did you mean %s?", word,
                    ncr_nearest_word(word, 3, words));
}

bool far_light_is_probe(const far_light_options *o)
{
    return o->env && !strcmp(o->env, "probe");
}

static ncr_status make_map(const app *a, const ncr_sky *sky, const ncr_probe *probe,
                           ncr_directional_map *map)
{
    if (map->image.data)
        return NCR_OK;
    return probe ? ncr_distant_probe(&a->ctx, probe, map) : paint_sky(a, sky, map);
}

ncr_status far_light_read(const app *a, const far_light_options *o, far_light *out)
{
    return o->env && !far_light_is_probe(o) ? read_env(a, o, &out->map) : NCR_OK;
}

static bool any_reads(size_t count, const ncr_method *methods)
{
    bool reads = false;
    for (size_t k = 0; k < count; k++)
        reads |= ncr_method_reads_distant(&methods[k]);
    return reads;
}

ncr_status far_light_open(const app *a, const far_light_options *o, const ncr_sky *sky,
                          const ncr_probe *probe, bool lit, size_t count, const ncr_method *methods,
                          far_light *out)
{
    if (!any_reads(count, methods)) {
        const char *asked = o->env && !lit ? "--env"
                            : o->lobe      ? "--lobe"
                            : o->filter    ? "--filter"
                                           : NULL;
        if (!asked)
            return NCR_OK;
        return ncr_fail(&a->ctx, NCR_E_ARG, "%s: method \"%s\" does not read distant light", asked,
                        methods[0].name);
    }
    ncr_lobe lobe;
    ncr_distant_opts opts = {.struct_size = sizeof opts, .lobe = o->lobe ? &lobe : NULL};
    ncr_status status = o->lobe ? lobe_word(a, o->lobe, &lobe) : NCR_OK;
    if (status == NCR_OK)
        status = filter_word(a, o->filter, &opts.filter);
    if (status == NCR_OK)
        status = make_map(a, sky, probe, &out->map);
    if (status == NCR_OK)
        status = ncr_distant_create(&a->ctx, &out->map, count, methods, &opts, &out->distant);
    if (status != NCR_OK)
        far_light_close(a, out);
    return status;
}

void far_light_close(const app *a, far_light *light)
{
    ncr_distant_destroy(&a->ctx, light->distant);
    ncr_directional_map_dispose(&a->ctx, &light->map);
    *light = (far_light){0};
}
