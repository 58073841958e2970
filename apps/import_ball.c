/* SPDX-License-Identifier: MIT */
#include "apps/import_ball.h"

#include "apps/map_words.h"

#include <stdio.h>

enum { size_by_default = 256 };

/* "A,B,C". */
static ncr_status three_numbers(const app *a, const char *flag, const char *text, double out[3])
{
    char after = 0;
    if (sscanf(text, "%lf,%lf,%lf%c", &out[0], &out[1], &out[2], &after) == 3)
        return NCR_OK;
    return ncr_fail(&a->ctx, NCR_E_ARG, "%s %s: expected three numbers with commas between", flag,
                    text);
}

static ncr_status find_circle(const app *a, const import_ball_options *o, const ncr_image *image,
                              ncr_ball_circle *out)
{
    double given[3], misfit = 0;
    ncr_status status;
    if (o->circle) {
        status = three_numbers(a, "--circle", o->circle, given);
        *out = (ncr_ball_circle){given[0], given[1], given[2]};
        return status;
    }
    status = ncr_ball_circle_fit(&a->ctx, image, out, &misfit);
    if (status == NCR_OK)
        app_say(a, "found a ball of radius %.2f at (%.2f, %.2f), its outline off by %.2g pixels",
                out->radius, out->x, out->y, misfit);
    return status;
}

static ncr_status fill(const app *a, const import_ball_options *o, const ncr_image *image,
                       ncr_directional_map *map, ncr_ball_photo *photo, double *blind)
{
    ncr_status status = find_circle(a, o, image, &photo->circle);
    if (status == NCR_OK && o->view)
        status = three_numbers(a, "--view", o->view, photo->view);
    return status == NCR_OK ? ncr_ball_photo_map(&a->ctx, image, photo, map, blind) : status;
}

static void report(const app *a, const ncr_ball_photo *photo, const ncr_directional_map *map,
                   double blind, const char *out)
{
    const double degrees = 180 / 3.14159265358979323846;
    app_say(a, "%s: %s map of size %u; %.1f degrees about the far side are not to be seen", out,
            ncr_map_kind_name(map->kind), map->size, blind * degrees);
    app_print_json(a, json_pack("{s:s, s:s, s:i, s:[f,f,f], s:f}", "schema", "nacre.rsibr/1", "to",
                                ncr_map_kind_name(map->kind), "size", (int)map->size, "circle",
                                photo->circle.x, photo->circle.y, photo->circle.radius, "blind_deg",
                                blind * degrees));
}

ncr_status import_ball(const app *a, const import_ball_options *o, const char *picture,
                       uint32_t size, const char *out)
{
    ncr_image image;
    ncr_map_kind kind;
    ncr_directional_map map;
    double blind = 0;
    ncr_ball_photo photo = {
        .struct_size = sizeof photo, .distance = o->distance, .reflectance = o->reflectance};
    ncr_status status = map_kind_word(a, "--to", o->to, &kind);
    if (status == NCR_OK)
        status = ncr_image_read(&a->ctx, picture, &image, NULL);
    if (status != NCR_OK)
        return status;
    status = ncr_directional_map_init(&a->ctx, kind, size ? size : size_by_default, 3, &map);
    if (status == NCR_OK)
        status = fill(a, o, &image, &map, &photo, &blind);
    if (status == NCR_OK)
        status = ncr_map_file_write(&a->ctx, out, &map, NULL);
    if (status == NCR_OK)
        report(a, &photo, &map, blind, out);
    ncr_directional_map_dispose(&a->ctx, &map);
    ncr_image_dispose(&a->ctx, &image);
    return status;
}
