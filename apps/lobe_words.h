/* SPDX-License-Identifier: MIT
 * lobe_words.h - lobes as words on the command line. */
#ifndef NCR_APPS_LOBE_WORDS_H
#define NCR_APPS_LOBE_WORDS_H

#include "apps/app.h"

/** The lobe of --lobe: lambert, phong:N, ggx:A or beckmann:M. */
ncr_status lobe_word(const app *a, const char *word, ncr_lobe *out);

/** "lambert" and so on. */
const char *lobe_name(const ncr_lobe *lobe);

#endif
