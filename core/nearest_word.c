/* SPDX-License-Identifier: MIT */
#include "core/nearest_word.h"

#include <ctype.h>
#include <string.h>

/* This file follows:
 *   [Damerau64]  F. J. Damerau. A Technique for Computer Detection and Correction of Spelling
 *                Errors, 1964 (the four kinds of slip) */

enum { longest = 63 };

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* Letters that people mix up without calling it a mistake are the same letter here. */
static char folded(char c)
{
    return c == '_' ? '-' : (char)tolower((unsigned char)c);
}

/* Row i holds the slips between the first i letters of a and each prefix of b; a swap reaches two
 * rows back, so three rows are kept. */
static int slips(const char *a, const char *b)
{
    const size_t a_length = strnlen(a, longest), b_length = strnlen(b, longest);
    int rows[3][longest + 1];
    for (size_t j = 0; j <= b_length; j++)
        rows[0][j] = (int)j;
    for (size_t i = 1; i <= a_length; i++) {
        int *now = rows[i % 3], *before = rows[(i + 2) % 3], *older = rows[(i + 1) % 3];
        now[0] = (int)i;
        for (size_t j = 1; j <= b_length; j++) {
            const char x = folded(a[i - 1]), y = folded(b[j - 1]);
            now[j] = least(before[j - 1] + (x != y), least(before[j], now[j - 1]) + 1);
            if (i > 1 && j > 1 && x == folded(b[j - 2]) && y == folded(a[i - 2]))
                now[j] = least(now[j], older[j - 2] + 1);
        }
    }
    return rows[a_length % 3][b_length];
}

const char *ncr_nearest_word(const char *word, size_t count, const char *const *words)
{
    const char *best = NULL;
    int fewest = 2 * longest;
    for (size_t k = 0; k < count; k++) {
        const int s = slips(word, words[k]);
        if (s < fewest) {
            fewest = s;
            best = words[k];
        }
    }
    return best;
}
