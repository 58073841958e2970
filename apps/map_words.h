/* SPDX-License-Identifier: MIT
 * map_words.h - kinds and conventions of directional maps as words on the command line. */
#ifndef NCR_APPS_MAP_WORDS_H
#define NCR_APPS_MAP_WORDS_H

#include "apps/app.h"

/** The kind that `flag` names; NULL is the cube. */
ncr_status map_kind_word(const app *a, const char *flag, const char *word, ncr_map_kind *out);

/** "y" or "z", NULL is z: the axes of a world with that up, in terms of ours. */
ncr_status map_up_word(const app *a, const char *flag, const char *word, ncr_axes *out);

/** The convention of --convention for a kind; NULL is "nacre". */
ncr_status map_convention_word(const app *a, const char *word, ncr_map_kind kind,
                               const ncr_convention **out);

/** The convention of --from for a file: CONVENTION, KIND (its native one) or KIND:CONVENTION. One
 *  that several kinds have is told apart by the shape of the image. NULL gives NULL. */
ncr_status map_from_word(const app *a, const char *word, const char *file,
                         const ncr_convention **out);

#endif
