/* SPDX-License-Identifier: MIT
 * report_words.h - what each experiment is called and shows, in words. */
#ifndef NCR_APPS_REPORT_WORDS_H
#define NCR_APPS_REPORT_WORDS_H

/** "Mirror reflections (the thesis's Table 6.2)"; an experiment unknown here is its own title. */
const char *report_words_title(const char *experiment);

/** A sentence or two on what to look for; "" for an unknown experiment. */
const char *report_words_note(const char *experiment);

#endif
