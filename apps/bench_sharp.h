/* SPDX-License-Identifier: MIT
 * bench_sharp.h - libsharp as a peer. It is under the GPL: a program of its own holds it, which is
 * built where libsharp is found and stands beside the command, and is talked to through pipes.
 *
 * The program reads one bench_sharp_job, band_limit + 1 doubles, and width x height x 3 floats by
 * channel; then, each time, how many runs to do as a uint32_t, and answers with the processor time
 * they took as a double; for 0 runs it answers with the map, out_width x out_height x 3 floats by
 * channel. It ends when there is nothing more to read. */
#ifndef NCR_APPS_BENCH_SHARP_H
#define NCR_APPS_BENCH_SHARP_H

#include "core/image.h"

typedef struct bench_sharp_job {
    uint32_t width, height, out_width, out_height, band_limit;
} bench_sharp_job;

typedef struct bench_sharp bench_sharp;

/** Start the program with a map of three channels and a factor for each degree. *out is NULL, with
 *  NCR_OK, where the program is not there. */
ncr_status bench_sharp_start(const ncr_ctx *ctx, const ncr_image *map, const double *zonal,
                             const bench_sharp_job *job, bench_sharp **out);
void bench_sharp_stop(const ncr_ctx *ctx, bench_sharp *sharp);

/** A bench_side's `seconds`: filter so many times. NaN when the program has died. */
double bench_sharp_seconds(void *sharp, unsigned runs);

/** What it found, interleaved. False when the program has died. */
bool bench_sharp_answer(bench_sharp *sharp, float *rgb);

#endif
