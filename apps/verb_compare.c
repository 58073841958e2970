/* SPDX-License-Identifier: MIT
 * verb_compare.c - nacre compare: how far an image is from its reference. */
#include "apps/app.h"
#include "apps/verbs.h"

typedef struct compare_options {
    app common;
    const char *words[2]; /* reference, image */
    const char *mask;
    double exposure, max_rmse;
} compare_options;

/* A mask image to bytes: nonzero where any channel is above a half. */
static ncr_status read_mask(const app *a, const char *path, const ncr_image *like, uint8_t **out)
{
    ncr_image image;
    ncr_status status = ncr_image_read(&a->ctx, path, &image, NULL);
    if (status != NCR_OK)
        return status;
    const size_t pixels = (size_t)image.width * image.height;
    if (image.width != like->width || image.height != like->height)
        status = ncr_fail(&a->ctx, NCR_E_FORMAT, "%s is %ux%u, the images are %ux%u", path,
                          image.width, image.height, like->width, like->height);
    else if (!(*out = ncr_alloc(&a->ctx, pixels)))
        status = NCR_E_NOMEM;
    for (size_t k = 0; status == NCR_OK && k < pixels; k++) {
        (*out)[k] = 0;
        for (uint32_t c = 0; c < image.channels; c++)
            (*out)[k] |= image.data[k * image.channels + c] > 0.5f;
    }
    ncr_image_dispose(&a->ctx, &image);
    return status;
}

static void say_error(const app *a, const ncr_image_error *e)
{
    app_say(a, "%llu pixels, %llu left out as not finite", (unsigned long long)e->pixels,
            (unsigned long long)e->nonfinite);
    app_say(a, "RMSE  L* %.4f  a* %.4f  b* %.4f   (CIELAB after exposure, L* of 100)",
            e->rmse_lab[0], e->rmse_lab[1], e->rmse_lab[2]);
    app_say(a, "RMSE  R %.6f  G %.6f  B %.6f   (linear, unclipped)", e->rmse[0], e->rmse[1],
            e->rmse[2]);
    app_say(a, "RMSE  R %.6f  G %.6f  B %.6f   (after exposure and clip)", e->rmse_clipped[0],
            e->rmse_clipped[1], e->rmse_clipped[2]);
    app_say(a, "gradient RMSE %.6f, largest jump %.4f, largest difference %.6g, HDR-FLIP %.4f",
            e->gradient_rmse, e->max_jump, e->max_abs, e->flip);
    app_print_json(
        a, json_pack("{s:s, s:I, s:I, s:{s:f, s:f, s:f, s:f, s:f, s:f}, s:{s:f, s:f, s:f}, s:f, "
                     "s:f, s:f, s:f}",
                     "schema", "nacre.compare/1", "pixels", (json_int_t)e->pixels, "nonfinite",
                     (json_int_t)e->nonfinite, "rmse", "R", e->rmse[0], "G", e->rmse[1], "B",
                     e->rmse[2], "L", e->rmse_lab[0], "a", e->rmse_lab[1], "b", e->rmse_lab[2],
                     "rmse_clipped", "R", e->rmse_clipped[0], "G", e->rmse_clipped[1], "B",
                     e->rmse_clipped[2], "gradient_rmse", e->gradient_rmse, "max_jump", e->max_jump,
                     "max_abs", e->max_abs, "flip", e->flip));
}

static ncr_status compare_files(const compare_options *o, ncr_image_error *error)
{
    const app *a = &o->common;
    ncr_image image[2] = {{0}, {0}};
    uint64_t replaced[2] = {0, 0};
    uint8_t *mask = NULL;
    ncr_status status = NCR_OK;
    for (int k = 0; k < 2 && status == NCR_OK; k++)
        status = ncr_image_read(&a->ctx, o->words[k], &image[k], &replaced[k]);
    if (status == NCR_OK && o->mask)
        status = read_mask(a, o->mask, &image[0], &mask);
    if (status == NCR_OK &&
        (image[0].width != image[1].width || image[0].height != image[1].height))
        status = ncr_fail(&a->ctx, NCR_E_FORMAT, "the sizes differ: %s is %ux%u, %s is %ux%u",
                          o->words[0], image[0].width, image[0].height, o->words[1], image[1].width,
                          image[1].height);
    if (status == NCR_OK)
        status = ncr_image_compare(&a->ctx, &image[0], &image[1], mask,
                                   NCR_OPTS(ncr_image_error_opts, .exposure = o->exposure), error);
    error->nonfinite += replaced[0] + replaced[1];
    ncr_free(&a->ctx, mask);
    ncr_image_dispose(&a->ctx, &image[0]);
    ncr_image_dispose(&a->ctx, &image[1]);
    return status;
}

int verb_compare(int argc, char **argv)
{
    compare_options o = {.max_rmse = -1};
    const option options[] = {
        {"--mask", 0, OPTION_TEXT, &o.mask, "IMAGE", "count only where this image is bright"},
        {"--exposure", 0, OPTION_NUMBER, &o.exposure, "X", "factor before the clip (default 1)"},
        {"--max-rmse", 0, OPTION_NUMBER, &o.max_rmse, "X", "exit 1 when RMSE(L*) is above X"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre compare REFERENCE IMAGE [options]",
        .summary = "Measure how far an image is from its reference.",
        .example = "nacre compare out/trace.exr out/oslf.exr --mask out/mask.png --json",
        .options = options,
        .word_count = 2,
        .word_names = {"REFERENCE", "IMAGE"},
        .words = o.words,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    app_begin(&o.common);
    ncr_image_error error = {0};
    const ncr_status status = compare_files(&o, &error);
    if (status != NCR_OK)
        return app_exit_code(status);
    say_error(&o.common, &error);
    return o.max_rmse >= 0 && !(error.rmse_lab[0] <= o.max_rmse) ? EXIT_DIFFERENT : EXIT_DONE;
}
