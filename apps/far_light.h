/* SPDX-License-Identifier: MIT
 * far_light.h - the light that methods of distant light read: a map file, the scene's sky,
 * or what a probe captures in the object's place. */
#ifndef NCR_APPS_FAR_LIGHT_H
#define NCR_APPS_FAR_LIGHT_H

#include "apps/app.h"

/** What the command line says about it. */
typedef struct far_light_options {
    const char *env;    /* a file, or "probe"; NULL: the sky */
    const char *from;   /* its convention; NULL: as the file says */
    const char *up;     /* NULL: z */
    const char *lobe;   /* NULL: none */
    const char *filter; /* exact, hierarchical or two-radii; NULL: exact */
} far_light_options;

typedef struct far_light {
    ncr_directional_map map;
    ncr_distant *distant;
} far_light;

/** Whether the light is a probe's. */
bool far_light_is_probe(const far_light_options *o);

/** Read the map, if the light is a file's; else leave *out zeroed. */
ncr_status far_light_read(const app *a, const far_light_options *o, far_light *out);

/** Make the map, unless it was read, and filter it for the methods. NCR_E_ARG when none of them reads
 *  distant light but an option asks for it; --env may, where `lit`. Filters nothing when none does.
 *
 *  @param probe  NULL unless the light is a probe's
 *  @param lit    the map lights what is traced for the object */
ncr_status far_light_open(const app *a, const far_light_options *o, const ncr_sky *sky,
                          const ncr_probe *probe, bool lit, size_t count, const ncr_method *methods,
                          far_light *out);
void far_light_close(const app *a, far_light *light);

#endif
