/* SPDX-License-Identifier: MIT */
#include "apps/lobe_words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct lobe_name {
    const char *name;
    ncr_lobe_kind kind;
    double most; /* of the parameter; 0: it has none */
} lobes[] = {
    {"lambert", NCR_LOBE_LAMBERT, 0},
    {"phong", NCR_LOBE_PHONG, 1e6},
    {"ggx", NCR_LOBE_GGX, 4},
    {"beckmann", NCR_LOBE_BECKMANN, 4},
};
enum { lobe_count = sizeof lobes / sizeof *lobes };

static ncr_status unknown(const app *a, const char *word)
{
    const char *names[lobe_count];
    for (int k = 0; k < lobe_count; k++)
        names[k] = lobes[k].name;
    return ncr_fail(&a->ctx, NCR_E_ARG, "--lobe %s: no such lobe; did you mean %s?", word,
                    ncr_nearest_word(word, lobe_count, names));
}

const char *lobe_name(const ncr_lobe *lobe)
{
    for (int k = 0; k < lobe_count; k++)
        if (lobes[k].kind == lobe->kind)
            return lobes[k].name;
    return "custom";
}

ncr_status lobe_word(const app *a, const char *word, ncr_lobe *out)
{
    const char *colon = strchr(word, ':');
    const size_t length = colon ? (size_t)(colon - word) : strlen(word);
    const struct lobe_name *found = NULL;
    for (int k = 0; k < lobe_count; k++)
        if (strlen(lobes[k].name) == length && !strncmp(lobes[k].name, word, length))
            found = &lobes[k];
    if (!found)
        return unknown(a, word);
    *out = (ncr_lobe){.kind = found->kind};
    if (found->most == 0 && !colon)
        return NCR_OK;

    char *end = NULL;
    out->parameter = colon ? strtod(colon + 1, &end) : NAN;
    const bool number = end && end != colon + 1 && !*end;
    const bool positive = found->kind == NCR_LOBE_PHONG ? out->parameter >= 0 : out->parameter > 0;
    if (found->most > 0 && number && positive && out->parameter <= found->most)
        return NCR_OK;
    if (found->most == 0)
        return ncr_fail(&a->ctx, NCR_E_ARG, "--lobe %s: %s takes no number", word, found->name);
    return ncr_fail(&a->ctx, NCR_E_ARG, "--lobe %s: expected %s:NUMBER, %s0 to %g", word,
                    found->name, found->kind == NCR_LOBE_PHONG ? "" : "above ", found->most);
}
