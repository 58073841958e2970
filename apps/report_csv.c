/* SPDX-License-Identifier: MIT */
#include "apps/report_rows.h"

#include <inttypes.h>
#include <string.h>

/* A field is quoted, and its quotes doubled, when it holds what would end it.       [RFC4180 2] */
static void put_field(text *out, const char *s)
{
    if (!strpbrk(s, ",\"\r\n")) {
        text_put(out, s);
        return;
    }
    text_put(out, "\"");
    for (; *s; s++) {
        text_bytes(out, s, 1);
        if (*s == '"')
            text_put(out, "\"");
    }
    text_put(out, "\"");
}

static void put_numbers(text *out, size_t count, const double *x)
{
    for (size_t k = 0; k < count; k++)
        text_printf(out, ",%.9g", x[k]);
}

static void put_row(text *out, const report_row *row)
{
    const ncr_image_error *e = &row->error;
    put_field(out, row->experiment);
    text_put(out, ",");
    put_field(out, row->method);
    text_printf(out, ",%u,%.9g,%u,", row->cube, row->epsilon, row->points);
    put_field(out, row->placement);
    put_numbers(out, 3, e->rmse);
    put_numbers(out, 3, e->rmse_lab);
    put_numbers(out, 3, e->rmse_clipped);
    put_numbers(out, 3, (const double[]){e->gradient_rmse, e->max_jump, e->max_abs});
    if (row->no_flip)
        text_put(out, ",");
    else
        put_numbers(out, 1, &e->flip);
    text_printf(out, ",%" PRIu64 ",%" PRIu64 ",%.9g", e->pixels, e->nonfinite, row->seconds);
    text_printf(out, ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 "\n", row->bytes, row->lookups, row->rays);
}

void report_csv(const report_table *table, text *out)
{
    text_put(out, "experiment,method,cube,epsilon,points,placement,"
                  "rmse_R,rmse_G,rmse_B,rmse_L,rmse_a,rmse_b,"
                  "rmse_clipped_R,rmse_clipped_G,rmse_clipped_B,"
                  "gradient_rmse,max_jump,max_abs,flip,pixels,nonfinite,seconds,"
                  "bytes,lookups,rays\n");
    for (size_t k = 0; k < table->count; k++)
        put_row(out, &table->rows[k]);
}
