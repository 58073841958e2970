/* SPDX-License-Identifier: MIT
 * report_thesis.h - the numbers printed in the thesis, to stand beside ours. */
#ifndef NCR_APPS_REPORT_THESIS_H
#define NCR_APPS_REPORT_THESIS_H

#include <stdint.h>

/** One line of Table 6.1 (experiment "reconstruction", method "oslf") or Table 6.2 ("mirror"). */
typedef struct thesis_row {
    const char *experiment, *method; /* our names */
    uint32_t cube;
    double lab[3], rgb[3]; /* RMSE as printed */
} thesis_row;

/** The printed line, or NULL. */
const thesis_row *thesis_find(const char *experiment, const char *method, uint32_t cube);

/** L* RMSE of a method over that of the environment map at the same cube size, as printed in Table
 *  6.2; 0 where the thesis does not say. Only such ratios can be compared: the scale of its CIELAB
 *  columns is not the standard one and is not stated. */
double thesis_ratio(const char *method, uint32_t cube);

#endif
