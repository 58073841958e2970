/* SPDX-License-Identifier: MIT */
#include "apps/map_words.h"

#include <string.h>

enum { most_names = 64 };

static ncr_status unknown(const app *a, const char *flag, const char *word, size_t count,
                          const char *const *names)
{
    const char *nearest = ncr_nearest_word(word, count, names);
    return ncr_fail(&a->ctx, NCR_E_ARG, "%s %s: there is no such%s%s%s", flag, word,
                    nearest ? "; did you mean " : "", nearest ? nearest : "", nearest ? "?" : "");
}

static size_t kind_names(const char *names[most_names])
{
    for (int k = 0; k < NCR_MAP_KINDS; k++)
        names[k] = ncr_map_kind_name((ncr_map_kind)k);
    return NCR_MAP_KINDS;
}

static size_t convention_names(const char *names[most_names])
{
    const ncr_convention *c;
    size_t count = 0;
    for (size_t k = 0; (c = ncr_convention_at(k)) && count < most_names; k++)
        names[count++] = c->name;
    return count;
}

ncr_status map_kind_word(const app *a, const char *flag, const char *word, ncr_map_kind *out)
{
    const char *names[most_names];
    *out = NCR_MAP_CUBE;
    if (!word || ncr_map_kind_from_name(word, out))
        return NCR_OK;
    return unknown(a, flag, word, kind_names(names), names);
}

ncr_status map_up_word(const app *a, const char *flag, const char *word, ncr_axes *out)
{
    memset(out, 0, sizeof *out);
    if (!word || !strcmp(word, "z"))
        return NCR_OK;
    if (strcmp(word, "y"))
        return ncr_fail(&a->ctx, NCR_E_ARG, "%s %s: expected y or z", flag, word);
    *out = ncr_world_y_up();
    return NCR_OK;
}

ncr_status map_convention_word(const app *a, const char *word, ncr_map_kind kind,
                               const ncr_convention **out)
{
    *out = ncr_convention_find(word ? word : "nacre", kind);
    if (*out)
        return NCR_OK;
    const ncr_convention *c;
    const char *names[most_names];
    size_t count = 0;
    for (size_t k = 0; (c = ncr_convention_at(k)) && count < most_names; k++) {
        if (c->kind == kind)
            names[count++] = c->name;
        if (!strcmp(c->name, word))
            *out = c;
    }
    if (*out) {
        const char *other = ncr_map_kind_name((*out)->kind);
        *out = NULL;
        return ncr_fail(&a->ctx, NCR_E_ARG, "--convention %s: says nothing of %s maps, but of %s",
                        word, ncr_map_kind_name(kind), other);
    }
    return unknown(a, "--convention", word, count, names);
}

/* Of the conventions of one name the one whose shape the image has. */
static ncr_status by_shape(const app *a, const char *word, const char *file,
                           const ncr_convention **out)
{
    uint32_t width, height;
    const ncr_convention *c;
    const ncr_status status = ncr_image_read_size(&a->ctx, file, &width, &height);
    size_t fits = 0;
    for (size_t k = 0; status == NCR_OK && (c = ncr_convention_at(k)); k++) {
        if (!strcmp(c->name, word) && ncr_convention_size(c, width, height)) {
            *out = c;
            fits++;
        }
    }
    if (status != NCR_OK || fits == 1)
        return status;
    *out = NULL;
    return ncr_fail(&a->ctx, NCR_E_ARG, "--from %s: %s of %u x %u fits %s; say --from KIND:%s",
                    word, file, width, height, fits ? "several kinds" : "none of its kinds", word);
}

static ncr_status of_kind(const app *a, const char *word, const char *name, ncr_map_kind kind,
                          const ncr_convention **out)
{
    *out = ncr_convention_find(name, kind);
    return *out ? NCR_OK
                : ncr_fail(&a->ctx, NCR_E_ARG, "--from %s: there is no such convention of %s maps",
                           word, ncr_map_kind_name(kind));
}

ncr_status map_from_word(const app *a, const char *word, const char *file,
                         const ncr_convention **out)
{
    *out = NULL;
    if (!word)
        return NCR_OK;
    char kind_name[16] = "";
    const char *colon = strchr(word, ':');
    ncr_map_kind kind;
    snprintf(kind_name, sizeof kind_name, "%.*s", colon ? (int)(colon - word) : 15, word);
    if (ncr_map_kind_from_name(kind_name, &kind))
        return of_kind(a, word, colon ? colon + 1 : "nacre", kind, out);
    const char *names[2 * most_names];
    const size_t count = convention_names(names);
    size_t found = 0;
    for (size_t k = 0; k < count && !colon; k++) {
        if (!strcmp(names[k], word)) {
            *out = ncr_convention_at(k);
            found++;
        }
    }
    if (found > 1)
        return by_shape(a, word, file, out);
    return found ? NCR_OK : unknown(a, "--from", word, count + kind_names(names + count), names);
}
