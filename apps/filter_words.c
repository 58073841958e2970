/* SPDX-License-Identifier: MIT */
#include "apps/filter_words.h"

#include "core/vec_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_called(const char *word, const char *name)
{
    const size_t length = strlen(name);
    return !strncmp(word, name, length) && (!word[length] || word[length] == ':');
}

static ncr_status gloss_word(const app *a, const char *word, const char *eta, ncr_gloss *out)
{
    const bool cook = is_called(word, "cook-torrance");
    double eta_k[2] = {0, 0};
    char *end = NULL;
    if (!cook && !is_called(word, "ggx"))
        return ncr_fail(&a->ctx, NCR_E_ARG,
                        "--lobe %s: with --view, expected ggx:ALPHA or cook-torrance:M", word);
    if (eta) {
        eta_k[0] = strtod(eta, &end);
        if (end != eta && *end == ':')
            eta_k[1] = strtod(end + 1, &end);
        if (end == eta || *end || !(eta_k[0] > 0 && eta_k[0] < 1e9) || !(eta_k[1] >= 0))
            return ncr_fail(&a->ctx, NCR_E_ARG, "--eta %s: expected an index, or INDEX:EXTINCTION",
                            eta);
    }
    *out = (ncr_gloss){.facets = {.facets = cook ? NCR_FACETS_BECKMANN : NCR_FACETS_GGX,
                                  .shadowing = cook ? NCR_SHADOWING_VCAVITY : NCR_SHADOWING_SMITH},
                       .fresnel = {eta_k[0], eta_k[1]}};
    const char *colon = strchr(word, ':');
    out->facets.alpha = colon ? strtod(colon + 1, &end) : 0;
    if (!colon || *end || !(out->facets.alpha >= 1e-6 && out->facets.alpha <= 4))
        return ncr_fail(&a->ctx, NCR_E_ARG,
                        "--lobe %s: expected a number from 1e-6 to 4 after a colon", word);
    return NCR_OK;
}

ncr_status filter_word(const app *a, const char *word, bool view, const char *eta,
                       filter_choice *out)
{
    *out = (filter_choice){.view = view};
    word = word ? word : view ? "ggx:0.3" : "lambert";
    if (view)
        return gloss_word(a, word, eta, &out->gloss);
    if (eta)
        return ncr_fail(&a->ctx, NCR_E_ARG, "--eta goes with --view");
    out->chain = !strcmp(word, "chain");
    out->mirror = !strcmp(word, "mirror");
    if (is_called(word, "cook-torrance"))
        return ncr_fail(&a->ctx, NCR_E_ARG, "--lobe %s: depends on the eye: say --view X,Y,Z",
                        word);
    return out->chain || out->mirror ? NCR_OK : lobe_word(a, word, &out->lobe);
}

ncr_status window_word(const app *a, const char *word, ncr_window *out)
{
    static const char *const names[] = {"none", "hann", "lanczos"};
    *out = NCR_WINDOW_NONE;
    for (int k = 0; word && k < 3; k++)
        if (!strcmp(word, names[k])) {
            *out = (ncr_window)k;
            return NCR_OK;
        }
    return word ? ncr_fail(&a->ctx, NCR_E_ARG, "--window %s: expected none, hann or lanczos", word)
                : NCR_OK;
}

ncr_status direction_word(const app *a, const char *flag, const char *word, double out[3])
{
    char rest;
    if (sscanf(word, "%lf,%lf,%lf%c", &out[0], &out[1], &out[2], &rest) != 3 || !d_normalize(out))
        return ncr_fail(&a->ctx, NCR_E_ARG, "%s %s: expected a direction such as 0,-1,0.5", flag,
                        word);
    return NCR_OK;
}
