/* SPDX-License-Identifier: MIT */
#include "shading/run_kernel_internal.h"

const ncr_run_kernels ncr_run_plain = {
    .ask = ask,
    .reflect = reflect,
    .look_up_points = look_up_points,
    .count_weights = count_weights,
    .store = store,
};
