/* SPDX-License-Identifier: MIT */
#include "apps/report_rows.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>

/* jansson has no infinities: what is not finite becomes null. */
static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *triple(const double x[3], const char *const names[3])
{
    return json_pack("{s:o, s:o, s:o}", names[0], number(x[0]), names[1], number(x[1]), names[2],
                     number(x[2]));
}

static const char *const rgb_names[3] = {"R", "G", "B"}, *const lab_names[3] = {"L", "a", "b"};

static void add_error(json_t *object, const ncr_image_error *e, bool no_flip)
{
    json_t *rmse = triple(e->rmse, rgb_names), *lab = triple(e->rmse_lab, lab_names);
    json_object_update(rmse, lab);
    json_decref(lab);
    json_object_set_new(object, "rmse", rmse);
    json_object_set_new(object, "rmse_clipped", triple(e->rmse_clipped, rgb_names));
    json_object_set_new(object, "gradient_rmse", number(e->gradient_rmse));
    json_object_set_new(object, "max_jump", number(e->max_jump));
    json_object_set_new(object, "max_abs", number(e->max_abs));
    json_object_set_new(object, "flip", no_flip ? json_null() : number(e->flip));
    json_object_set_new(object, "pixels", json_integer((json_int_t)e->pixels));
    json_object_set_new(object, "nonfinite", json_integer((json_int_t)e->nonfinite));
}

/* Text from outside may not be UTF-8, which jansson refuses. */
static json_t *string(const char *s)
{
    json_t *value = json_string(s);
    return value ? value : json_string("?");
}

static json_t *row_object(const report_row *row)
{
    json_t *object = json_pack("{s:o, s:o, s:I, s:o, s:I, s:o}", "experiment",
                               string(row->experiment), "method", string(row->method), "cube",
                               (json_int_t)row->cube, "epsilon", number(row->epsilon), "points",
                               (json_int_t)row->points, "placement", string(row->placement));
    add_error(object, &row->error, row->no_flip);
    json_object_set_new(object, "seconds", number(row->seconds));
    json_object_set_new(object, "bytes", json_integer((json_int_t)row->bytes));
    json_object_set_new(object, "lookups", json_integer((json_int_t)row->lookups));
    json_object_set_new(object, "rays", json_integer((json_int_t)row->rays));
    return object;
}

static json_t *floor_object(const report_floor *floor)
{
    json_t *object = json_object();
    if (floor->known) {
        json_object_set_new(object, "text", string(floor->text));
        add_error(object, &floor->error, false);
    }
    return object;
}

void report_json(const report_table *table, text *out)
{
    json_t *rows = json_array();
    for (size_t k = 0; k < table->count; k++)
        json_array_append_new(rows, row_object(&table->rows[k]));
    json_t *root =
        json_pack("{s:s, s:o, s:o, s:o}", "schema", "nacre.report/1", "scene", string(table->scene),
                  "rows", rows, "floor", floor_object(&table->floor));
    char *written = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(12)) : NULL;
    if (written) {
        text_put(out, written);
        text_put(out, "\n");
    } else {
        out->failed = true;
    }
    free(written);
    json_decref(root);
}
