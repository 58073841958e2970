/* SPDX-License-Identifier: MIT
 * filter_words.h - what a map is filtered by, as words on the command line. */
#ifndef NCR_APPS_FILTER_WORDS_H
#define NCR_APPS_FILTER_WORDS_H

#include "apps/lobe_words.h"

/** A --lobe. */
typedef struct filter_choice {
    bool chain;  /* GGX of rising roughness, a mirror first */
    bool mirror; /* no lobe at all */
    bool view;   /* as seen from one eye, by the normal: `gloss` counts, not `lobe` */
    ncr_lobe lobe;
    ncr_gloss gloss;
} filter_choice;

/**
 * lambert, phong:N, ggx:ALPHA, beckmann:M, mirror, chain; with a view, ggx:ALPHA (Smith) and
 * cook-torrance:M (Beckmann and V-cavities), reflecting as --eta ETA or ETA:K says, or all.
 *
 * @param word  NULL: lambert, or with a view ggx:0.3
 * @param eta   NULL: reflects everything
 */
ncr_status filter_word(const app *a, const char *word, bool view, const char *eta,
                       filter_choice *out);

/** "hann", "lanczos", "none"; NULL is none. */
ncr_status window_word(const app *a, const char *word, ncr_window *out);

/** "X,Y,Z", not all 0: a unit vector. */
ncr_status direction_word(const app *a, const char *flag, const char *word, double out[3]);

#endif
