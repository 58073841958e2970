/* SPDX-License-Identifier: MIT */
#include "io/json_internal.h"

#include "core/nearest_word.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

ncr_status ncr_json_parse(const ncr_ctx *ctx, const char *name, const char *text, size_t length,
                          ncr_json_doc *out)
{
    json_error_t error;
    *out = (ncr_json_doc){.ctx = ctx, .name = name};
    out->root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &error);
    if (out->root)
        return NCR_OK;
    return out->status = ncr_fail(ctx, NCR_E_FORMAT, "%s:%d:%d: %s", name, error.line, error.column,
                                  error.text);
}

void ncr_json_dispose(ncr_json_doc *doc)
{
    json_decref(doc->root);
    doc->root = NULL;
}

ncr_json ncr_json_root(ncr_json_doc *doc)
{
    return (ncr_json){.doc = doc, .value = doc->root};
}

ncr_json ncr_json_member(const ncr_json *object, const char *key)
{
    return (ncr_json){object->doc, object, key, 0, json_object_get(object->value, key)};
}

ncr_json ncr_json_element(const ncr_json *array, size_t k)
{
    return (ncr_json){array->doc, array, NULL, k, json_array_get(array->value, k)};
}

/* --- failures ---------------------------------------------------------------------------------- */

/* Write the path to a value into text[size], truncated; returns how far it got. */
static size_t write_path(const ncr_json *at, char *text, size_t size)
{
    if (!at->parent)
        return 0;
    const size_t used = write_path(at->parent, text, size);
    const int n = at->key ? snprintf(text + used, size - used, "/%s", at->key)
                          : snprintf(text + used, size - used, "/%zu", at->index);
    const size_t end = used + (size_t)n;
    return end < size ? end : size - 1;
}

static void fail_at(const ncr_json *at, const char *sentence)
{
    char path[200] = "/";
    write_path(at, path, sizeof path);
    at->doc->status =
        ncr_fail(at->doc->ctx, NCR_E_FORMAT, "%s: %s: %s", at->doc->name, path, sentence);
}

void ncr_json_fail(const ncr_json *at, const char *format, ...)
{
    if (at->doc->status)
        return;
    char sentence[256];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    fail_at(at, sentence);
}

static void describe(const json_t *value, char *text, size_t size)
{
    static const char *const names[] = {[JSON_OBJECT] = "an object",
                                        [JSON_ARRAY] = "an array",
                                        [JSON_TRUE] = "true",
                                        [JSON_FALSE] = "false",
                                        [JSON_NULL] = "null"};
    if (!value)
        snprintf(text, size, "nothing");
    else if (json_is_array(value))
        snprintf(text, size, "an array of %zu", json_array_size(value));
    else if (json_is_string(value))
        snprintf(text, size, "\"%.40s\"", json_string_value(value));
    else if (json_is_number(value))
        snprintf(text, size, "%.10g", json_number_value(value));
    else
        snprintf(text, size, "%s", names[json_typeof(value)]);
}

void ncr_json_expected(const ncr_json *at, const char *format, ...)
{
    if (at->doc->status)
        return;
    char what[200], found[64], sentence[280];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    describe(at->value, found, sizeof found);
    snprintf(sentence, sizeof sentence, "expected %s, found %s", what, found);
    fail_at(at, sentence);
}

/* --- values ------------------------------------------------------------------------------------ */

void ncr_json_need(const ncr_json *at, const char *what)
{
    if (!at->value)
        ncr_json_expected(at, "%s", what);
}

static bool is_one_of(const char *word, size_t count, const char *const *words)
{
    for (size_t k = 0; k < count; k++)
        if (!strcmp(word, words[k]))
            return true;
    return false;
}

bool ncr_json_only(const ncr_json *at, size_t count, const char *const *known)
{
    if (!json_is_object(at->value)) {
        ncr_json_expected(at, "an object");
        return false;
    }
    const char *key;
    json_t *value;
    json_object_foreach(at->value, key, value)
    {
        if (!is_one_of(key, count, known)) {
            const ncr_json member = {at->doc, at, key, 0, value};
            ncr_json_fail(&member, "unknown member \"%.40s\"; did you mean \"%s\"?", key,
                          ncr_nearest_word(key, count, known));
        }
    }
    return at->doc->status == NCR_OK;
}

size_t ncr_json_array(const ncr_json *at, size_t min, size_t max, const char *what)
{
    if (!ncr_json_present(at))
        return 0;
    const size_t count = json_array_size(at->value);
    if (!json_is_array(at->value) || count < min || count > max) {
        if (min == max)
            ncr_json_expected(at, "an array of %zu %s", min, what);
        else if (max == SIZE_MAX)
            ncr_json_expected(at, "an array of %s%s", what, min ? ", not empty" : "");
        else
            ncr_json_expected(at, "an array of %zu to %zu %s", min, max, what);
        return 0;
    }
    return count;
}

void ncr_json_number(ncr_json at, double low, double high, double *out)
{
    if (!ncr_json_present(&at))
        return;
    const double x = json_number_value(at.value);
    if (json_is_number(at.value) && x >= low && x <= high)
        *out = x;
    else if (isinf(low) && isinf(high))
        ncr_json_expected(&at, "a number");
    else if (isinf(high))
        ncr_json_expected(&at, "a number not below %g", low);
    else
        ncr_json_expected(&at, "a number from %g to %g", low, high);
}

void ncr_json_numbers(ncr_json at, size_t count, double low, double high, double *out)
{
    const size_t n = ncr_json_array(&at, count, count, "numbers");
    for (size_t k = 0; k < n; k++)
        ncr_json_number(ncr_json_element(&at, k), low, high, out + k);
}

void ncr_json_floats(ncr_json at, size_t count, double low, double high, float *out)
{
    const size_t n = ncr_json_array(&at, count, count, "numbers");
    for (size_t k = 0; k < n; k++) {
        double x = out[k];
        ncr_json_number(ncr_json_element(&at, k), low, high, &x);
        out[k] = (float)x;
    }
}

void ncr_json_count(ncr_json at, uint32_t low, uint32_t high, uint32_t *out)
{
    if (!ncr_json_present(&at))
        return;
    const json_int_t x = json_integer_value(at.value);
    if (json_is_integer(at.value) && x >= low && x <= high)
        *out = (uint32_t)x;
    else
        ncr_json_expected(&at, "a whole number from %u to %u", low, high);
}

void ncr_json_bool(ncr_json at, bool *out)
{
    if (!ncr_json_present(&at))
        return;
    if (json_is_boolean(at.value))
        *out = json_is_true(at.value);
    else
        ncr_json_expected(&at, "true or false");
}

void ncr_json_string(ncr_json at, const char **out)
{
    if (!ncr_json_present(&at))
        return;
    if (json_is_string(at.value) && json_string_length(at.value) > 0)
        *out = json_string_value(at.value);
    else
        ncr_json_expected(&at, "a string that is not empty");
}

void ncr_json_word(ncr_json at, size_t count, const char *const *words, size_t *out)
{
    const char *word = NULL;
    ncr_json_string(at, &word);
    if (!word)
        return;
    for (size_t k = 0; k < count; k++)
        if (!strcmp(word, words[k])) {
            *out = k;
            return;
        }
    ncr_json_fail(&at, "unknown word \"%.40s\"; did you mean \"%s\"?", word,
                  ncr_nearest_word(word, count, words));
}
