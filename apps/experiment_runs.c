/* SPDX-License-Identifier: MIT */
#include "apps/experiment_runs.h"

#include <stdio.h>
#include <string.h>

/* Methods that read one map at the object's centre, whatever the field is. */
static bool one_map(const char *method)
{
    return !strcmp(method, "envmap") || !strcmp(method, "proxy");
}

static ncr_status add_row(experiments *x, const char *experiment, const char *method,
                          const lab_field *f, const lab_result *r)
{
    report_row row = {.placement = "grid", .error = r->error};
    snprintf(row.experiment, sizeof row.experiment, "%s", experiment);
    snprintf(row.method, sizeof row.method, "%s", method);
    if (f && strcmp(method, "trace")) {
        row.cube = f->cube;
        row.epsilon = f->epsilon;
        row.points = (uint32_t)f->baked.points.count;
        row.bytes = ncr_lightfield_bytes(one_map(method) ? f->probe_light : f->light);
    }
    row.seconds = r->stats.seconds;
    row.lookups = r->stats.lookups;
    row.rays = r->stats.rays;
    return report_table_add(x->table, &row);
}

static ncr_status show(experiments *x, report_section section, caption words, ncr_term term,
                       const lab_result *r)
{
    return report_page_compare(x->page, section,
                               &(report_comparison){.name = words.name,
                                                    .alt = words.alt,
                                                    .reference = &x->l->reference[term],
                                                    .image = &r->image,
                                                    .mask = x->l->mask,
                                                    .exposure = x->l->exposure,
                                                    .error = &r->error,
                                                    .seconds = r->stats.seconds});
}

ncr_status run_show_reference(experiments *x, report_section section, ncr_term term,
                              const char *alt)
{
    return report_page_reference(x->page, section, "ray trace", alt, &x->l->reference[term],
                                 x->l->exposure, x->l->traced[term].seconds);
}

ncr_status run_measure(experiments *x, const char *experiment, const char *label,
                       const lab_request *q, report_section section, caption words)
{
    lab_result r;
    ncr_status status = lab_measure(x->l, q, x->repeats, &r);
    if (status != NCR_OK)
        return status;
    if (experiment)
        status = add_row(x, experiment, label, q->field, &r);
    if (status == NCR_OK && words.name)
        status = show(x, section, words, q->term, &r);
    lab_result_close(x->l, &r);
    return status;
}
