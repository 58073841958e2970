/* SPDX-License-Identifier: MIT
 * well_formed.h - a small reader of well-formed XML, enough for what the report page uses. */
#ifndef NCR_TESTS_WELL_FORMED_H
#define NCR_TESTS_WELL_FORMED_H

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* What was read; `wrong` is empty when the page is well formed. */
typedef struct xml {
    const char *at;
    int depth, images, elements, plots;
    char open[64][24];
    char wrong[120];
} xml;

static inline bool complain(xml *x, const char *what)
{
    snprintf(x->wrong, sizeof x->wrong, "%s at \"%.60s\"", what, x->at);
    return false;
}

static inline size_t read_name(const char *at, char *name, size_t size)
{
    size_t n = 0;
    while ((isalnum((unsigned char)at[n]) || at[n] == '-') && n + 1 < size) {
        name[n] = at[n];
        n++;
    }
    name[n] = 0;
    return n;
}

static inline bool read_entity(xml *x)
{
    static const char *const known[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    for (int k = 0; k < 5; k++)
        if (!strncmp(x->at, known[k], strlen(known[k]))) {
            x->at += strlen(known[k]);
            return true;
        }
    return complain(x, "bare ampersand");
}

static inline bool read_attributes(xml *x)
{
    char name[40];
    while (isspace((unsigned char)*x->at)) {
        x->at += strspn(x->at, " \n\t");
        if (*x->at == '/' || *x->at == '>')
            break;
        if (!read_name(x->at, name, sizeof name))
            return complain(x, "attribute without a name");
        x->at += strlen(name);
        if (strncmp(x->at, "=\"", 2))
            return complain(x, "attribute without a quoted value");
        for (x->at += 2; *x->at && *x->at != '"';) {
            if (*x->at == '<')
                return complain(x, "< in an attribute");
            if (*x->at == '&' && !read_entity(x))
                return false;
            x->at += *x->at != '"' && *x->at != '&';
        }
        if (*x->at++ != '"')
            return complain(x, "attribute without an end");
    }
    return true;
}

static inline bool read_tag(xml *x)
{
    const bool closing = x->at[1] == '/';
    char name[24];
    x->at += closing ? 2 : 1;
    if (!read_name(x->at, name, sizeof name))
        return complain(x, "tag without a name");
    x->at += strlen(name);
    if (closing) {
        if (x->depth == 0 || strcmp(x->open[x->depth - 1], name))
            return complain(x, "closes what is not open");
        x->depth--;
        return *x->at++ == '>' || complain(x, "closing tag without an end");
    }
    x->elements++;
    x->images += !strcmp(name, "img");
    x->plots += !strcmp(name, "svg") && !strncmp(x->at, " class=\"plot", 12);
    if (!read_attributes(x))
        return false;
    if (!strncmp(x->at, "/>", 2)) {
        x->at += 2;
        return true;
    }
    if (*x->at++ != '>' || x->depth == 64)
        return complain(x, "tag without an end");
    snprintf(x->open[x->depth++], 24, "%s", name);
    return true;
}

static inline xml read_page(const char *page)
{
    static const char doctype[] = "<!DOCTYPE html>\n";
    xml x = {.at = page};
    if (strncmp(page, doctype, strlen(doctype))) {
        complain(&x, "no doctype");
        return x;
    }
    x.at += strlen(doctype);
    while (*x.at && !*x.wrong) {
        if (*x.at == '<')
            read_tag(&x);
        else if (*x.at == '&')
            read_entity(&x);
        else
            x.at++;
    }
    if (!*x.wrong && x.depth)
        complain(&x, "open at the end");
    return x;
}

#endif
