/* SPDX-License-Identifier: MIT
 * map_options.h - options that verbs share which read directional maps, or write them. */
#ifndef NCR_APPS_MAP_OPTIONS_H
#define NCR_APPS_MAP_OPTIONS_H

#include "apps/app.h"

/** How a map that is read lies. */
typedef struct map_in_options {
    const char *from, *up; /* NULL: as the file says, and z */
} map_in_options;

/** Rows for a verb's option table; NAME, a literal, is what the verb calls the map. */
/* clang-format off */
#define MAP_IN_OPTIONS(o, NAME)                                                                    \
    {"--from", 0, OPTION_TEXT, &(o)->from, "CONVENTION",                                           \
     "how " NAME " lies, or KIND:CONVENTION (default: as " NAME " says)"},                         \
    {"--from-up", 0, OPTION_TEXT, &(o)->up, "AXIS",                                                \
     "which axis is up in " NAME ": z (default) or y"}
/* clang-format on */

/** How OUT is to lie, and as what its texels are stored. */
typedef struct map_out_options {
    const char *convention, *up; /* NULL: nacre, and z */
    double exposure;             /* 0: 1 */
    bool half, single, rgb9e5;
} map_out_options;

/** Rows for a verb's option table. */
/* clang-format off */
#define MAP_OUT_OPTIONS(o)                                                                         \
    {"--convention", 0, OPTION_TEXT, &(o)->convention, "NAME",                                     \
     "how OUT is to lie: opengl, webgl, openexr, oiio, usd, vcross ..."},                          \
    {"--up", 0, OPTION_TEXT, &(o)->up, "AXIS",                                                     \
     "which axis is to be up in OUT: z (default) or y"},                                           \
    {"--half", 0, OPTION_FLAG, &(o)->half, NULL, "store EXR as halves (KTX2 is halves anyway)"},   \
    {"--float", 0, OPTION_FLAG, &(o)->single, NULL, "store KTX2 as floats"},                       \
    {"--rgb9e5", 0, OPTION_FLAG, &(o)->rgb9e5, NULL, "store KTX2 as E5B9G9R9, 4 bytes a texel"},   \
    {"--exposure", 0, OPTION_NUMBER, &(o)->exposure, "E", "factor for PNG (default 1)"}
/* clang-format on */

/** Read a map as --from and --from-up say, or as the file does. */
ncr_status map_in_read(const app *a, const map_in_options *o, const char *file,
                       ncr_directional_map *out, ncr_map_file_report *report);

/** How OUT lies as a map of the kind that `flag` names; NULL is the cube. NCR_E_ARG also where
 *  options exclude each other. */
ncr_status map_out_layout(const app *a, const map_out_options *o, const char *flag,
                          const char *kind, ncr_map_stated *out);

/** What is written in that layout, as the options say. */
ncr_map_file_opts map_out_file(const map_out_options *o, ncr_map_stated as);

#endif
