/* SPDX-License-Identifier: MIT */
#include "shading/facet_kernel_internal.h"
#include "shading/grid_kernel_internal.h"
#include "shading/legendre_kernel_internal.h"
#include "shading/rows_kernel_internal.h"

const ncr_sht_kernels ncr_sht_plain = {
    .lanes = LANES,
    .scan = scan_texels,
    .spread = spread,
    .gather = gather,
    .rows_to_spectrum = rows_to_spectrum,
    .spectrum_to_rows = spectrum_to_rows,
    .analyse_order = analyse_order,
    .synthesise_order = synthesise_order,
    .sample_grid = sample_grid,
    .scatter_grid = scatter_grid,
    .facet_row = facet_row,
    .dot_rows = dot_rows,
};
