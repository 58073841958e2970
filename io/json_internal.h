/* SPDX-License-Identifier: MIT
 * json_internal.h - JSON values that know their path, read with errors that say where.
 *
 * Reading is written without a check after each member: the first failure sticks to the document,
 * every later read leaves its output alone, and the reader asks for doc->status at the end. */
#ifndef NCR_IO_JSON_INTERNAL_H
#define NCR_IO_JSON_INTERNAL_H

#include "core/ctx.h"

#include <jansson.h>

typedef struct ncr_json_doc {
    const ncr_ctx *ctx;
    const char *name; /* what messages call the file; borrowed */
    json_t *root;
    ncr_status status; /* of the first failure */
} ncr_json_doc;

/* A value and the way to it. Lives on the stack, inside the life of its parent. */
typedef struct ncr_json {
    ncr_json_doc *doc;
    const struct ncr_json *parent; /* NULL: the root */
    const char *key;               /* member of an object, or NULL: */
    size_t index;                  /* element of an array */
    json_t *value;                 /* NULL: absent */
} ncr_json;

/* Parse a text; duplicate members are errors. NCR_E_FORMAT as "file:line:column: ...". */
ncr_status ncr_json_parse(const ncr_ctx *ctx, const char *name, const char *text, size_t length,
                          ncr_json_doc *out);
void ncr_json_dispose(ncr_json_doc *doc);

ncr_json ncr_json_root(ncr_json_doc *doc);
/* A member (absent when it is not there or `object` is no object) or an element (k < count). */
ncr_json ncr_json_member(const ncr_json *object, const char *key);
ncr_json ncr_json_element(const ncr_json *array, size_t k);
static inline bool ncr_json_present(const ncr_json *at)
{
    return at->value && at->doc->status == NCR_OK;
}

/* Fail at this value with a printf-formatted sentence; at most one failure is reported. */
void ncr_json_fail(const ncr_json *at, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Fail with "expected ..., found ...", the latter taken from the value itself. */
void ncr_json_expected(const ncr_json *at, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The value must be there; what it should be completes "expected ...". */
void ncr_json_need(const ncr_json *at, const char *what);
/* An object with no other members than these. False: it is not, or something failed before. */
bool ncr_json_only(const ncr_json *at, size_t count, const char *const *known);
/* Elements of an array of min..max elements; 0 for an absent one, or after a failure. */
size_t ncr_json_array(const ncr_json *at, size_t min, size_t max, const char *what);

/* Each leaves *out alone when the value is absent. Ranges are inclusive. */
void ncr_json_number(ncr_json at, double low, double high, double *out);
void ncr_json_numbers(ncr_json at, size_t count, double low, double high, double *out);
void ncr_json_floats(ncr_json at, size_t count, double low, double high, float *out);
void ncr_json_count(ncr_json at, uint32_t low, uint32_t high, uint32_t *out);
void ncr_json_bool(ncr_json at, bool *out);
/* Borrowed from the document. Never empty. */
void ncr_json_string(ncr_json at, const char **out);
/* Index of one of `count` words. */
void ncr_json_word(ncr_json at, size_t count, const char *const *words, size_t *out);

#define NCR_WORDS(list) (sizeof(list) / sizeof *(list)), (list)

#endif
