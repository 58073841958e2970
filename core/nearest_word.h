/* SPDX-License-Identifier: MIT
 * nearest_word.h - which right word a mistyped one was meant to be. */
#ifndef NCR_CORE_NEAREST_WORD_H
#define NCR_CORE_NEAREST_WORD_H

#include "core/base.h"

NCR_BEGIN

/**
 * The word that takes the fewest slips to turn into `word`: letters put in, left out, replaced, or
 * swapped with their neighbour; case and the difference of '-' and '_' count nothing.
 *
 * @param words  [count] the right words; the first of equally near ones wins
 * @return       one of `words`, or NULL when count is 0
 *
 * Words are compared over their first 63 bytes. Re-entrant, allocates nothing.    [Damerau64]
 */
NCR_API const char *ncr_nearest_word(const char *word, size_t count, const char *const *words);

NCR_END

#endif
