/* SPDX-License-Identifier: MIT */
#include "apps/options.h"

#include "core/nearest_word.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void command_line_help(const command_line *line, FILE *out)
{
    fprintf(out, "usage: %s\n\n%s\n\n", line->usage, line->summary);
    for (const option *o = line->options; o->name; o++) {
        char left[64];
        const char letter[] = {'-', o->letter, ',', ' ', 0};
        snprintf(left, sizeof left, "%s%s%s%s", o->letter ? letter : "    ", o->name,
                 o->value ? " " : "", o->value ? o->value : "");
        fprintf(out, "  %-30s %s\n", left, o->help);
    }
    fprintf(out, "  %-30s %s\n\nexample:\n  %s\n", "    --help", "this text", line->example);
}

static parse_result wrong_option(const command_line *line, const char *name)
{
    const char *names[64];
    size_t count = 0;
    for (const option *o = line->options; o->name && count < 64; o++)
        names[count++] = o->name;
    const char *nearest = ncr_nearest_word(name, count, names);
    fprintf(stderr, "nacre: unknown option %s", name);
    if (nearest)
        fprintf(stderr, "; did you mean %s?", nearest);
    fprintf(stderr, "\n");
    return PARSE_WRONG;
}

static bool read_number(const char *text, double *out)
{
    char *end;
    errno = 0;
    *out = strtod(text, &end);
    return end != text && !*end && errno == 0 && isfinite(*out) && *out > 0;
}

static bool read_count(const char *text, uint64_t low, uint64_t high, uint64_t *out)
{
    char *end;
    errno = 0;
    if (*text < '0' || *text > '9')
        return false;
    *out = strtoull(text, &end, 10);
    return !*end && errno == 0 && *out >= low && *out <= high;
}

static bool read_size(const char *text, uint32_t out[2])
{
    uint64_t side[2];
    char first[16];
    const char *x = strchr(text, 'x');
    if (!x || (size_t)(x - text) >= sizeof first)
        return false;
    memcpy(first, text, (size_t)(x - text));
    first[x - text] = 0;
    if (!read_count(first, 1, 131072, &side[0]) || !read_count(x + 1, 1, 131072, &side[1]))
        return false;
    out[0] = (uint32_t)side[0];
    out[1] = (uint32_t)side[1];
    return true;
}

/* What the value should have been, or NULL when it was taken. */
static const char *take_value(const option *o, const char *text)
{
    uint64_t whole;
    switch (o->kind) {
    case OPTION_FLAG:
        return "no value";
    case OPTION_TEXT:
        *(const char **)o->target = text;
        return NULL;
    case OPTION_COUNT:
        if (!read_count(text, 1, UINT32_MAX, &whole))
            return "a whole number from 1";
        *(uint32_t *)o->target = (uint32_t)whole;
        return NULL;
    case OPTION_SEED:
        if (!read_count(text, 0, UINT64_MAX, &whole))
            return "a whole number from 0";
        *(uint64_t *)o->target = whole;
        return NULL;
    case OPTION_NUMBER:
        return read_number(text, o->target) ? NULL : "a number above 0";
    case OPTION_SIZE:
        return read_size(text, o->target) ? NULL : "a size such as 655x460";
    }
    return "nothing";
}

static const option *find_option(const command_line *line, const char *name, size_t length)
{
    for (const option *o = line->options; o->name; o++) {
        const bool is_long = strlen(o->name) == length && !strncmp(o->name, name, length);
        const bool is_letter = o->letter && length == 2 && name[0] == '-' && name[1] == o->letter;
        if (is_long || is_letter)
            return o;
    }
    return NULL;
}

/* Handle argv[*k], an option; moves *k past a value that stands apart. */
static parse_result parse_option(const command_line *line, int argc, char **argv, int *k)
{
    const char *arg = argv[*k];
    const char *equals = strncmp(arg, "--", 2) ? NULL : strchr(arg, '=');
    const option *o = find_option(line, arg, equals ? (size_t)(equals - arg) : strlen(arg));
    if (!o)
        return wrong_option(line, arg);
    if (o->kind == OPTION_FLAG && !equals) {
        *(bool *)o->target = true;
        return PARSE_OK;
    }
    const char *value = equals ? equals + 1 : *k + 1 < argc ? argv[++*k] : NULL;
    if (!value) {
        fprintf(stderr, "nacre: %s needs a value: %s\n", o->name, o->value);
        return PARSE_WRONG;
    }
    const char *expected = take_value(o, value);
    if (expected) {
        fprintf(stderr, "nacre: %s %s: expected %s\n", o->name, value, expected);
        return PARSE_WRONG;
    }
    return PARSE_OK;
}

parse_result command_line_parse(const command_line *line, int argc, char **argv)
{
    size_t words = 0;
    bool options_end = false;
    for (int k = 0; k < argc; k++) {
        if (!options_end && !strcmp(argv[k], "--help")) {
            command_line_help(line, stdout);
            return PARSE_HELP;
        }
        if (!options_end && !strcmp(argv[k], "--")) {
            options_end = true;
        } else if (!options_end && argv[k][0] == '-' && argv[k][1]) {
            const parse_result result = parse_option(line, argc, argv, &k);
            if (result != PARSE_OK)
                return result;
        } else if (words < line->word_count) {
            line->words[words++] = argv[k];
        } else {
            fprintf(stderr, "nacre: %s: one word too many\nusage: %s\n", argv[k], line->usage);
            return PARSE_WRONG;
        }
    }
    if (line->word_total)
        *line->word_total = words;
    else if (words < line->word_count) {
        fprintf(stderr, "nacre: %s is missing\nusage: %s\n", line->word_names[words], line->usage);
        return PARSE_WRONG;
    }
    return PARSE_OK;
}

int command_line_missing(const char *what)
{
    fprintf(stderr, "nacre: %s is missing\n", what);
    return 2;
}
