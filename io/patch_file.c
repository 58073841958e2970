/* SPDX-License-Identifier: MIT */
#include "io/patch_file.h"

#include "io/atomic_file_internal.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { max_patches = 1 << 20, max_points = 16 * max_patches, token_size = 64 };
static const size_t max_bytes = (size_t)1 << 32;

/* ---- Reading: one cursor over lines, one over the words of the current line. ---- */

typedef struct text_reader {
    const ncr_ctx *ctx;
    const char *name;
    const char *next, *end;      /* what follows the current line */
    const char *word, *word_end; /* what is left of it, comment cut off */
    size_t line;
} text_reader;

__attribute__((format(printf, 2, 3))) static ncr_status fail(const text_reader *r,
                                                             const char *format, ...)
{
    char sentence[320];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    return ncr_fail(r->ctx, NCR_E_FORMAT, "%s:%zu: %s", r->name, r->line, sentence);
}

static bool blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

static void skip_blanks(text_reader *r)
{
    while (r->word < r->word_end && blank(*r->word))
        r->word++;
}

/* Go to the next line that holds a word; false at the end of the text. */
static bool next_line(text_reader *r)
{
    while (r->next < r->end) {
        const size_t left = (size_t)(r->end - r->next);
        const char *stop = memchr(r->next, '\n', left);
        const char *line_end = stop ? stop : r->end;
        const char *comment = memchr(r->next, '#', (size_t)(line_end - r->next));
        r->word = r->next;
        r->word_end = comment ? comment : line_end;
        r->next = stop ? stop + 1 : r->end;
        r->line++;
        skip_blanks(r);
        if (r->word < r->word_end)
            return true;
    }
    return false;
}

static ncr_status expect_line(text_reader *r, const char *what)
{
    if (next_line(r))
        return NCR_OK;
    return fail(r, "the file ends where %s was expected", what);
}

/* Copy the next word of the line; an over-long one is cut, and then no longer a number. */
static ncr_status next_word(text_reader *r, const char *what, char out[token_size])
{
    if (r->word == r->word_end)
        return fail(r, "the line ends where %s was expected", what);
    size_t n = 0;
    while (r->word < r->word_end && !blank(*r->word)) {
        if (n < token_size - 1)
            out[n++] = *r->word ? *r->word : '?';
        r->word++;
    }
    out[n] = 0;
    if (n == token_size - 1)
        return fail(r, "expected %s, found a word of over %d characters", what, token_size - 2);
    skip_blanks(r);
    return NCR_OK;
}

static ncr_status end_of_line(const text_reader *r)
{
    if (r->word == r->word_end)
        return NCR_OK;
    const ptrdiff_t left = r->word_end - r->word;
    return fail(r, "expected the end of the line, found \"%.*s\"", left < 20 ? (int)left : 20,
                r->word);
}

static ncr_status read_keyword(text_reader *r, const char *keyword)
{
    char word[token_size];
    const ncr_status status = next_word(r, keyword, word);
    if (status != NCR_OK)
        return status;
    return strcmp(word, keyword) ? fail(r, "expected \"%s\", found \"%s\"", keyword, word) : NCR_OK;
}

static ncr_status read_whole(text_reader *r, const char *what, uint64_t *out)
{
    char word[token_size];
    const ncr_status status = next_word(r, what, word);
    if (status != NCR_OK)
        return status;
    const size_t digits = strspn(word, "0123456789");
    if (!digits || word[digits] || digits > 18)
        return fail(r, "expected %s, found \"%s\"", what, word);
    *out = strtoull(word, NULL, 10);
    return NCR_OK;
}

/* strtod would also take "nan", "inf" and hexadecimal; the format does not. */
static ncr_status read_number(text_reader *r, double *out)
{
    char word[token_size], *stop;
    const ncr_status status = next_word(r, "a number", word);
    if (status != NCR_OK)
        return status;
    const double x = strtod(word, &stop);
    if (word[strspn(word, "0123456789+-.eE")] || *stop || stop == word)
        return fail(r, "expected a number, found \"%s\"", word);
    if (!isfinite(x))
        return fail(r, "the number %s is too large for a double", word);
    *out = x;
    return NCR_OK;
}

static ncr_status read_magic(text_reader *r)
{
    ncr_status status = expect_line(r, "\"nacre patches 1\"");
    if (status == NCR_OK)
        status = read_keyword(r, "nacre");
    if (status == NCR_OK)
        status = read_keyword(r, "patches");
    uint64_t version = 0;
    if (status == NCR_OK)
        status = read_whole(r, "a version", &version);
    if (status == NCR_OK && version != 1)
        return fail(r, "version %" PRIu64 " is not known, only 1", version);
    return status == NCR_OK ? end_of_line(r) : status;
}

/* "points N" or "patches N". N is believed only if the rest of the text can hold that many lines,
 * so that a wrong count cannot ask for memory. */
static ncr_status read_count(text_reader *r, const char *keyword, size_t limit, size_t line_bytes,
                             size_t *out)
{
    ncr_status status = expect_line(r, keyword);
    if (status == NCR_OK)
        status = read_keyword(r, keyword);
    uint64_t count = 0;
    if (status == NCR_OK)
        status = read_whole(r, "a count", &count);
    if (status == NCR_OK)
        status = end_of_line(r);
    if (status != NCR_OK)
        return status;
    if (count == 0)
        return fail(r, "expected at least one of \"%s\", found 0", keyword);
    if (count > limit)
        return ncr_fail(r->ctx, NCR_E_LIMIT,
                        "%s:%zu: %" PRIu64 " %s are more than the limit of %zu", r->name, r->line,
                        count, keyword, limit);
    if (count > ((size_t)(r->end - r->next) + 1) / line_bytes)
        return fail(r, "%" PRIu64 " %s are promised, more than the file has room for", count,
                    keyword);
    *out = (size_t)count;
    return NCR_OK;
}

static ncr_status read_points(text_reader *r, size_t count, double (*points)[3])
{
    for (size_t k = 0; k < count; k++) {
        ncr_status status = expect_line(r, "a point");
        for (int c = 0; c < 3 && status == NCR_OK; c++)
            status = read_number(r, &points[k][c]);
        if (status == NCR_OK)
            status = end_of_line(r);
        if (status != NCR_OK)
            return status;
    }
    return NCR_OK;
}

static ncr_status read_patch(text_reader *r, size_t point_count, const double (*points)[3],
                             double control[16][3])
{
    ncr_status status = expect_line(r, "a patch of 16 point indices");
    for (int k = 0; k < 16 && status == NCR_OK; k++) {
        uint64_t index = 0;
        status = read_whole(r, "a point index", &index);
        if (status != NCR_OK)
            return status;
        if (index >= point_count)
            return fail(r, "point index %" PRIu64 " is out of range, there are %zu points from 0",
                        index, point_count);
        memcpy(control[k], points[index], sizeof control[k]);
    }
    return status == NCR_OK ? end_of_line(r) : status;
}

static ncr_status read_patches(text_reader *r, size_t point_count, const double (*points)[3],
                               ncr_patch_set *out)
{
    size_t count = 0;
    ncr_status status = read_count(r, "patches", max_patches, 32, &count);
    if (status != NCR_OK)
        return status;
    double(*control)[16][3] = ncr_alloc(r->ctx, count * sizeof *control);
    if (!control)
        return NCR_E_NOMEM;
    for (size_t k = 0; k < count && status == NCR_OK; k++)
        status = read_patch(r, point_count, points, control[k]);
    if (status == NCR_OK && next_line(r))
        status = fail(r, "expected the end of the file after %zu patches", count);
    if (status == NCR_OK)
        *out = (ncr_patch_set){.count = count, .control = control};
    else
        ncr_free(r->ctx, control);
    return status;
}

static ncr_status parse(text_reader *r, ncr_patch_set *out)
{
    size_t count = 0;
    ncr_status status = read_magic(r);
    if (status == NCR_OK)
        status = read_count(r, "points", max_points, 6, &count);
    if (status != NCR_OK)
        return status;
    double(*points)[3] = ncr_alloc(r->ctx, count * sizeof *points);
    if (!points)
        return NCR_E_NOMEM;
    status = read_points(r, count, points);
    if (status == NCR_OK)
        status = read_patches(r, count, (const double(*)[3])points, out);
    ncr_free(r->ctx, points);
    return status;
}

ncr_status ncr_patch_text_parse(const ncr_ctx *ctx, const char *name, const char *text,
                                size_t length, ncr_patch_set *out)
{
    *out = (ncr_patch_set){0};
    ncr_c_locale locale;
    ncr_status status = ncr_c_locale_enter(ctx, &locale);
    if (status != NCR_OK)
        return status;
    text_reader r = {.ctx = ctx, .name = name, .next = text, .end = text + length};
    status = parse(&r, out);
    ncr_c_locale_leave(&locale);
    return status;
}

ncr_status ncr_patch_file_read(const ncr_ctx *ctx, const char *path, ncr_patch_set *out)
{
    *out = (ncr_patch_set){0};
    uint8_t *data;
    size_t size;
    ncr_status status = ncr_file_read(ctx, path, max_bytes, &data, &size);
    if (status == NCR_OK)
        status = ncr_patch_text_parse(ctx, path, (const char *)data, size, out);
    ncr_free(ctx, data);
    return status;
}

void ncr_patch_set_dispose(const ncr_ctx *ctx, ncr_patch_set *set)
{
    ncr_free(ctx, set->control);
    *set = (ncr_patch_set){0};
}

/* ---- Writing: points equal bit for bit are written once. ---- */

typedef struct point_table {
    const double (*points)[3]; /* all control points in patch order */
    size_t count, mask;
    uint32_t *slot;   /* [mask + 1] a control point's index, NCR_NONE: free */
    uint32_t *number; /* [count] which written point a control point is */
} point_table;

static size_t hash_point(const double p[3])
{
    uint64_t bits[3];
    memcpy(bits, p, sizeof bits);
    uint64_t h = 0;
    for (int k = 0; k < 3; k++) {
        h = (h ^ bits[k]) * 0x9e3779b97f4a7c15u;
        h ^= h >> 32;
    }
    return (size_t)h;
}

/* The first control point with the bits of point k, which is k itself when it is new. */
static uint32_t first_equal(point_table *t, uint32_t k)
{
    size_t at = hash_point(t->points[k]) & t->mask;
    while (t->slot[at] != NCR_NONE) {
        if (!memcmp(t->points[t->slot[at]], t->points[k], sizeof t->points[k]))
            return t->slot[at];
        at = (at + 1) & t->mask;
    }
    t->slot[at] = k;
    return k;
}

static uint32_t number_points(point_table *t)
{
    memset(t->slot, 0xff, (t->mask + 1) * sizeof *t->slot);
    uint32_t distinct = 0;
    for (uint32_t k = 0; k < t->count; k++) {
        const uint32_t first = first_equal(t, k);
        t->number[k] = first == k ? distinct++ : t->number[first];
    }
    return distinct;
}

/* The shortest of 15 to 17 digits that reads back to the same bits. */
static void print_number(FILE *out, double x)
{
    char text[40];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, x);
        if (strtod(text, NULL) == x)
            break;
    }
    fputs(text, out);
}

static void print_set(FILE *out, const point_table *t, uint32_t distinct)
{
    fprintf(out, "nacre patches 1\npoints %" PRIu32 "\n", distinct);
    for (uint32_t k = 0, next = 0; k < t->count; k++) {
        if (t->number[k] != next)
            continue;
        next++;
        for (int c = 0; c < 3; c++) {
            print_number(out, t->points[k][c]);
            fputc(c < 2 ? ' ' : '\n', out);
        }
    }
    fprintf(out, "patches %zu\n", t->count / 16);
    for (size_t k = 0; k < t->count; k++)
        fprintf(out, "%" PRIu32 "%c", t->number[k], k % 16 < 15 ? ' ' : '\n');
}

static ncr_status print_file(const ncr_ctx *ctx, const char *path, point_table *t)
{
    ncr_c_locale locale;
    ncr_atomic_file file;
    ncr_status status = ncr_c_locale_enter(ctx, &locale);
    if (status != NCR_OK)
        return status;
    status = ncr_atomic_file_open(ctx, path, &file);
    if (status == NCR_OK) {
        print_set(file.stream, t, number_points(t));
        status = ncr_atomic_file_commit(ctx, &file);
    }
    ncr_c_locale_leave(&locale);
    return status;
}

static ncr_status check_set(const ncr_ctx *ctx, const char *path, const ncr_patch_set *set)
{
    if (set->count == 0)
        return ncr_fail(ctx, NCR_E_ARG, "%s: there are no patches to write", path);
    if (set->count > max_patches)
        return ncr_fail(ctx, NCR_E_LIMIT, "%s: %zu patches are more than the limit of %d", path,
                        set->count, max_patches);
    const double *x = &set->control[0][0][0];
    for (size_t k = 0; k < 48 * set->count; k++) {
        if (!isfinite(x[k]))
            return ncr_fail(ctx, NCR_E_ARG, "%s: patch %zu, control point %zu is not finite", path,
                            k / 48, k / 3 % 16);
    }
    return NCR_OK;
}

ncr_status ncr_patch_file_write(const ncr_ctx *ctx, const char *path, const ncr_patch_set *set)
{
    ncr_status status = check_set(ctx, path, set);
    if (status != NCR_OK)
        return status;
    point_table t = {.points = (const double(*)[3])set->control, .count = 16 * set->count};
    size_t slots = 32;
    while (slots < 2 * t.count)
        slots *= 2;
    t.mask = slots - 1;
    t.slot = ncr_alloc(ctx, slots * sizeof *t.slot);
    t.number = ncr_alloc(ctx, t.count * sizeof *t.number);
    status = t.slot && t.number ? print_file(ctx, path, &t) : NCR_E_NOMEM;
    ncr_free(ctx, t.slot);
    ncr_free(ctx, t.number);
    return status;
}
