/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]         B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99
 *   [Cook82]    R. Cook, K. Torrance. A Reflectance Model for Computer Graphics. 1982
 *   [Walter07]  B. Walter, S. Marschner, H. Li, K. Torrance. Microfacet Models for Refraction
 *               through Rough Surfaces. 2007 */
#include "core/nearest_word.h"
#include "shading/brushed_view_internal.h"
#include "shading/quadrature_internal.h"
#include "shading/rsibr_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- words ------------------------------------------------------------------------------------- */

static ncr_rsibr_lobe plain(ncr_rsibr_kind kind, float red, float green, float blue)
{
    return (ncr_rsibr_lobe){.kind = kind, .colour = {red, green, blue}};
}

static ncr_rsibr_brdf mirror(const double *eta)
{
    ncr_rsibr_brdf brdf = {1, {plain(NCR_RSIBR_MIRROR, 1, 1, 1)}};
    brdf.lobe[0].gloss.fresnel.eta = *eta;
    return brdf;
}

static ncr_rsibr_brdf lambert(const double *unused)
{
    (void)unused;
    return (ncr_rsibr_brdf){1, {plain(NCR_RSIBR_LAMBERT, 1, 1, 1)}};
}

static ncr_rsibr_brdf phong(const double *exponent)
{
    ncr_rsibr_brdf brdf = {1, {plain(NCR_RSIBR_PHONG, 1, 1, 1)}};
    brdf.lobe[0].exponent = *exponent;
    return brdf;
}

static ncr_rsibr_brdf cook_torrance(const double *m)
{
    ncr_rsibr_brdf brdf = {
        2, {plain(NCR_RSIBR_GLOSS, 1, 1, 1), plain(NCR_RSIBR_LAMBERT, 0.2f, 0.2f, 0.2f)}};
    brdf.lobe[0].gloss = (ncr_gloss){{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, *m}, {1.5, 0}};
    return brdf;
}

static ncr_rsibr_brdf ggx(const double *alpha)
{
    const bool brushed = alpha[0] != alpha[1];
    ncr_rsibr_brdf brdf = {1, {plain(brushed ? NCR_RSIBR_BRUSHED : NCR_RSIBR_GLOSS, 1, 1, 1)}};
    if (brushed)
        brdf.lobe[0].brushed = (ncr_brushed){alpha[0], alpha[1]};
    else
        brdf.lobe[0].gloss.facets = (ncr_microfacet){NCR_FACETS_GGX, NCR_SHADOWING_SMITH, alpha[0]};
    return brdf;
}

/* What is below the coat gets at most what the coat lets in, so all albedos add up to at most
 * F + (1 - F) (flakes + diffuse), and the two colours to less than 1. */
static ncr_rsibr_brdf car_paint(const double *unused)
{
    (void)unused;
    static const ncr_fresnel coat = {1.5, 0};
    ncr_rsibr_brdf brdf = {3,
                           {plain(NCR_RSIBR_MIRROR, 1, 1, 1),
                            plain(NCR_RSIBR_GLOSS, 0.42f, 0.10f, 0.08f),
                            plain(NCR_RSIBR_COATED, 0.36f, 0.02f, 0.02f)}};
    brdf.lobe[0].gloss.fresnel = coat;
    brdf.lobe[1].gloss.facets = (ncr_microfacet){NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.25};
    for (int k = 1; k < 3; k++) {
        brdf.lobe[k].coat = coat;
        brdf.lobe[k].through = 3 - k;
    }
    return brdf;
}

typedef enum number { NUMBER_NONE, NUMBER_MAY, NUMBER_MUST } number;

static const struct {
    const char *name;
    ncr_rsibr_brdf (*make)(const double number[2]);
    number number;
    double least, most, usual; /* of the number */
    const char *says;
    bool pair; /* may have a second one */
} words[] = {
    {"mirror", mirror, NUMBER_MAY, 1e-3, 1e4, 0, "an index of refraction", false},
    {"lambert", lambert, NUMBER_NONE, 0, 0, 0, NULL, false},
    {"phong", phong, NUMBER_MUST, 0, 1e6, 0, "an exponent", false},
    {"cook-torrance", cook_torrance, NUMBER_MUST, 1e-3, 4, 0, "a roughness", false},
    {"ggx", ggx, NUMBER_MUST, 1e-3, 4, 0, "a roughness", true},
    {"car-paint", car_paint, NUMBER_NONE, 0, 0, 0, NULL, false},
};
enum { word_count = sizeof words / sizeof *words, word_room = 32 };

/* Two numbers that differ, for which brushed_view_internal.h has tables; or two that are one. */
static ncr_status parse_pair(const ncr_ctx *ctx, const char *text, const char *second,
                             double out[2])
{
    char *end = NULL;
    out[1] = strtod(second, &end);
    bool good = end != second && !*end && out[1] > 0;
    for (int i = 0; good && i < 2 && out[0] != out[1]; i++)
        good = out[i] >= NCR_BRUSHED_LEAST && out[i] <= NCR_BRUSHED_MOST;
    if (!good)
        return ncr_fail(ctx, NCR_E_ARG,
                        "material \"%s\": expected roughness along and across, from %g to %g", text,
                        NCR_BRUSHED_LEAST, NCR_BRUSHED_MOST);
    return NCR_OK;
}

static ncr_status parse_number(const ncr_ctx *ctx, const char *text, const char *colon, int k,
                               double out[2])
{
    char *end = NULL;
    *out = colon ? strtod(colon + 1, &end) : words[k].usual;
    if (colon && words[k].number == NUMBER_NONE)
        return ncr_fail(ctx, NCR_E_ARG, "material \"%s\" takes no number", words[k].name);
    if (!colon && words[k].number != NUMBER_MUST)
        return NCR_OK;
    const bool pair = words[k].pair && end && end != colon + 1 && *end == ',';
    if (!colon || end == colon + 1 || (*end && !pair) ||
        !(*out >= words[k].least && *out <= words[k].most))
        return ncr_fail(ctx, NCR_E_ARG, "material \"%s\": expected %s from %g to %g after \"%s:\"",
                        text, words[k].says, words[k].least, words[k].most, words[k].name);
    if (pair)
        return parse_pair(ctx, text, end + 1, out);
    out[1] = out[0];
    return NCR_OK;
}

ncr_status ncr_rsibr_brdf_find(const ncr_ctx *ctx, const char *text, ncr_rsibr_brdf *out)
{
    const char *colon = strchr(text, ':'), *names[word_count];
    const size_t length = colon ? (size_t)(colon - text) : strlen(text);
    char name[word_room] = "";
    memcpy(name, text, length < word_room ? length : word_room - 1);
    *out = (ncr_rsibr_brdf){0};
    for (int k = 0; k < word_count; k++) {
        names[k] = words[k].name;
        if (strcmp(name, names[k]))
            continue;
        double parameter[2] = {0};
        const ncr_status status = parse_number(ctx, text, colon, k, parameter);
        if (status == NCR_OK)
            *out = words[k].make(parameter);
        return status;
    }
    return ncr_fail(ctx, NCR_E_ARG, "there is no material \"%s\"; did you mean \"%s\"?", name,
                    ncr_nearest_word(name, word_count, names));
}

/* --- albedo ------------------------------------------------------------------------------------ */

/* 2 int c (1 - F(c)) dc: what a coat lets in of light from everywhere. */
double ncr_rsibr_let_in(const ncr_fresnel *coat)
{
    enum { nodes = 32 };
    double node[nodes], weight[nodes], sum = 0;
    ncr_gauss_legendre(nodes, node, weight);
    for (int k = 0; k < nodes; k++) {
        const double x = 0.5 * (node[k] + 1), c = x * x; /* closer toward grazing */
        sum += weight[k] * 2 * c * (1 - ncr_fresnel_eval(coat, c)) * x;
    }
    return sum;
}

static double look_up(const float *table, double c)
{
    const double x = fmin(fmax(sqrt(c) * NCR_RSIBR_TABLE - 0.5, 0), NCR_RSIBR_TABLE - 1);
    const int k = x < NCR_RSIBR_TABLE - 2 ? (int)x : NCR_RSIBR_TABLE - 2;
    const double a = (double)table[k], b = (double)table[k + 1];
    return a + (x - k) * (b - a);
}

/* Between the azimuths of the table. */
static double look_up_azimuth(const float *table, double c, double azimuth)
{
    const int last = NCR_RSIBR_AZIMUTHS - 1;
    const double x = fmin(fmax(azimuth * 2 / pi, 0), 1) * last;
    const int i = x < last - 1 ? (int)x : last - 1;
    const double a = look_up(table + (size_t)i * NCR_RSIBR_TABLE, c);
    return a + (x - i) * (look_up(table + (size_t)(i + 1) * NCR_RSIBR_TABLE, c) - a);
}

double ncr_rsibr_lobe_albedo(const ncr_rsibr_lobe *lobe, const float *table, double c,
                             double azimuth)
{
    double a = 1;
    c = fmin(fmax(c, 0), 1);
    if (lobe->kind == NCR_RSIBR_MIRROR)
        a = ncr_fresnel_eval(&lobe->gloss.fresnel, c);
    else if (lobe->kind == NCR_RSIBR_GLOSS)
        a = look_up(table, c);
    else if (lobe->kind == NCR_RSIBR_BRUSHED)
        a = look_up_azimuth(table, c, azimuth);
    else if (lobe->kind == NCR_RSIBR_COATED)
        a = (double)table[0];
    if (lobe->through != 0)
        a *= pow(1 - ncr_fresnel_eval(&lobe->coat, c), lobe->through);
    return a;
}

ncr_rsibr_index ncr_rsibr_lobe_index(const ncr_rsibr_lobe *lobe)
{
    return lobe->kind == NCR_RSIBR_LAMBERT || lobe->kind == NCR_RSIBR_COATED ? NCR_RSIBR_BY_NORMAL
                                                                             : NCR_RSIBR_BY_MIRROR;
}

void ncr_rsibr_albedo(const ncr_rsibr *set, uint32_t map, double c, double azimuth, double out[3])
{
    const uint32_t first = ncr_rsibr_lobe_of(set, map);
    const uint32_t past = set->single ? set->brdf.lobe_count : first + 1;
    out[0] = out[1] = out[2] = 0;
    for (uint32_t k = first; k < past; k++) {
        const ncr_rsibr_lobe *lobe = &set->brdf.lobe[k];
        const double a = ncr_rsibr_lobe_albedo(lobe, ncr_rsibr_table(set, k), c, azimuth);
        for (int i = 0; i < 3; i++)
            out[i] += (double)lobe->colour[i] * a;
    }
}
