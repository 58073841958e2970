/* SPDX-License-Identifier: MIT
 * lab.h - one view of one stage with its references, and fields to measure against them. */
#ifndef NCR_APPS_LAB_H
#define NCR_APPS_LAB_H

#include "apps/view.h"

/** Light, points and maps of one bake. */
typedef struct lab_field {
    uint32_t cube;
    double epsilon;
    bool occlusion;
    ncr_baked baked;
    ncr_bake_report report;
    ncr_lightfield *light;
    ncr_field stored; /* what the light is read from, when it does not fit into lab.memory */
    const ncr_sample_map *map; /* which maps to shade by: the baked ones, or others */
    ncr_lightfield *probe_light;
    ncr_probe probe;
} lab_field;

typedef struct lab {
    const app *a;
    stage s;
    view v;
    uint8_t *mask;
    double exposure;
    double memory;             /* bytes of a field's light that may be kept; set by lab_open */
    const char *folder;        /* for light that needs more, borrowed; NULL: all goes into memory */
    ncr_image background;      /* everything but the object */
    ncr_image reference[3];    /* by ncr_term: full, recon, reflect */
    ncr_shade_stats traced[3]; /* what they cost */
} lab;

/** One method's picture of one term, and how far it is from the reference. */
typedef struct lab_result {
    ncr_image image;
    ncr_shade_stats stats;
    ncr_image_error error;
} lab_result;

ncr_status lab_open(const app *a, const char *scene, const char *preset, lab *out);
void lab_close(lab *l);

ncr_status lab_bake(lab *l, uint32_t cube, double epsilon, lab_field *out);
void lab_field_close(const lab *l, lab_field *f);

typedef struct lab_request {
    const char *method, *recon; /* recon: for the full term, NULL otherwise */
    ncr_term term;
    const lab_field *field; /* NULL: none needed */
    bool horizon_off;
    uint32_t mirror_depth;      /* of trace; 0: 1 */
    const ncr_gbuffer *gbuffer; /* NULL: the lab's own */
    const ncr_image *against;   /* NULL: the reference of the term */
} lab_request;

/** Shade `repeats` times (the median time is kept) over the background, and compare. */
ncr_status lab_measure(lab *l, const lab_request *request, unsigned repeats, lab_result *out);
void lab_result_close(const lab *l, lab_result *r);

#endif
