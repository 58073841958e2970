/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Karis13]  B. Karis, Real Shading in Unreal Engine 4, 2013
 *   [Turquin19]  E. Turquin, Practical Multiple Scattering Compensation for Microfacet Models, 2019 */
#include "apps/split_sum.h"

#include "apps/map_words.h"
#include "io/image_file.h"
#include "shading/brdf.h"

#include <math.h>
#include <string.h>

/* Smith's shadowing for GGX, V-cavities for Beckmann, as --view has them. */
static ncr_status facets_word(const app *a, const char *word, ncr_microfacet *out)
{
    const bool ggx = !strcmp(word, "ggx");
    *out = (ncr_microfacet){ggx ? NCR_FACETS_GGX : NCR_FACETS_BECKMANN,
                            ggx ? NCR_SHADOWING_SMITH : NCR_SHADOWING_VCAVITY, 1};
    return ggx || !strcmp(word, "beckmann")
               ? NCR_OK
               : ncr_fail(&a->ctx, NCR_E_ARG, "--split-sum %s: expected ggx or beckmann", word);
}

/* The least albedo: what single scattering loses at worst. */
static double fill_image(const ncr_image *image, const float *table)
{
    double least = 1;
    for (size_t k = 0; k < (size_t)image->width * image->height; k++) {
        const double scale = (double)table[2 * k], bias = (double)table[2 * k + 1];
        float *texel = image->data + 3 * k;
        texel[0] = table[2 * k];
        texel[1] = table[2 * k + 1];
        texel[2] = (float)(ncr_multiscatter_gain(1, scale + bias) - 1);
        least = fmin(least, scale + bias);
    }
    return least;
}

static ncr_status write_table(const app *a, const ncr_microfacet *m, uint32_t size, const char *out,
                              double *least)
{
    float *table = ncr_alloc(&a->ctx, 2 * (size_t)size * size * sizeof *table);
    ncr_image image = {0};
    ncr_status status = table ? ncr_split_sum_table(&a->ctx, m, size, size, table) : NCR_E_NOMEM;
    if (status == NCR_OK)
        status = ncr_image_init(&a->ctx, size, size, 3, &image);
    if (status == NCR_OK) {
        *least = fill_image(&image, table);
        status = ncr_image_write(&a->ctx, out, &image, NULL);
    }
    ncr_image_dispose(&a->ctx, &image);
    ncr_free(&a->ctx, table);
    return status;
}

ncr_status split_sum_write(const app *a, const char *facets, uint32_t size, const char *out)
{
    const double began = app_seconds();
    ncr_microfacet m;
    double least = 1;
    if (size < 2 || size > 1024)
        return ncr_fail(&a->ctx, NCR_E_ARG, "--size %u: a table has 2 to 1024", size);
    ncr_status status = facets_word(a, facets, &m);
    if (status == NCR_OK)
        status = write_table(a, &m, size, out, &least);
    if (status != NCR_OK)
        return status;
    app_say(a,
            "%s: scale, bias and lost light of %s facets, n.v to the right, roughness downwards; "
            "single scattering gives back at least %.3g",
            out, facets, least);
    app_print_json(a, json_pack("{s:s, s:{s:s, s:i, s:f, s:f}}", "schema", "nacre.prefilter/1",
                                "split_sum", "facets", facets, "size", (int)size, "least_albedo",
                                least, "seconds", app_seconds() - began));
    return NCR_OK;
}
