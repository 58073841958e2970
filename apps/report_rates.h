/* SPDX-License-Identifier: MIT
 * report_rates.h - how finely each kind of map samples, by the angle from its middle. */
#ifndef NCR_APPS_REPORT_RATES_H
#define NCR_APPS_REPORT_RATES_H

#include "apps/text.h"

/**
 * Solid angle of a texel, relative to the middle of the map, over 0 to 90 degrees: the tutorial's
 * figure 4, with the sphere's curve put right (its texels are all alike; what shrinks towards its rim
 * is one of their sides), lat-long's and the octahedron's beside them. Inline SVG. NCR_E_NOMEM.
 *                                                                            [H fig 4] [E-14] */
ncr_status report_plot_rates(text *out);

/** The same numbers as CSV, a line for each degree, a column for each curve. */
void report_csv_rates(text *out);

#endif
