/* SPDX-License-Identifier: MIT
 * prefilter_job.h - one run of nacre prefilter: the map, its levels, and what was measured of them. */
#ifndef NCR_APPS_PREFILTER_JOB_H
#define NCR_APPS_PREFILTER_JOB_H

#include "apps/filter_words.h"
#include "apps/map_options.h"

typedef struct prefilter_options {
    app common;
    const char *in, *out, *lobe, *kind, *window, *view, *eta, *split_sum;
    map_in_options read;
    map_out_options write;
    uint32_t size, levels, order, probes;
    double tolerance, peel;
    bool positive, no_peel, lights_apart, same_size, harmonics;
} prefilter_options;

/** One filtered map. Radiance in the map's units. */
typedef struct filtered_level {
    ncr_directional_map map;
    ncr_lobe lobe;
    bool mirror;
    bool summed; /* over all texels: no degrees kept the tolerance */
    ncr_prefilter_report report;
    uint64_t negative;   /* values below 0 that were left */
    double bound;        /* on the error: what was left out, interpolation and rounding */
    double error;        /* measured: the largest, against the sum over all texels */
    double nrmse;        /* measured: root mean square over root mean square */
    double nrmse_spread; /* standard deviation of that over choices of directions */
    double texel_error;  /* what that sum itself gets wrong on a map of 1 everywhere */
    double seconds;
} filtered_level;

typedef struct prefilter_job {
    const prefilter_options *o;
    filter_choice choice;
    ncr_window window;
    double view[3];    /* unit, of our world */
    ncr_map_stated as; /* how results are laid out */
    ncr_map_file_report read;
    ncr_directional_map in; /* spent by writing a mirror */
    uint32_t in_size;
    ncr_prefilter *prefilter; /* NULL for views and mirrors */
    double tolerance, mean;   /* of the map, over sphere and channels */
    uint32_t level_count, probes;
    filtered_level levels[NCR_KTX2_LEVELS];
    ncr_prefilter_nine nine;
    ncr_ktx2_report stored;
    double seconds[5]; /* read, analyse, filter, measure, write */
} prefilter_job;

/** Analyse, filter and measure as chosen; levels are made here and closed by the caller. */
ncr_status prefilter_run(prefilter_job *job);
/** The same for what one eye sees. */
ncr_status prefilter_run_view(prefilter_job *job);

/** An empty map of the chosen layout. */
ncr_status prefilter_make_map(const prefilter_job *job, uint32_t size, ncr_directional_map *out);

/** Directions of the centres of all its texels, [height][width][3], of our world. */
void prefilter_texel_directions(const ncr_directional_map *map, double *out);
/** Count values below 0, or with --positive make them 0 and reckon what that adds. */
void prefilter_make_positive(const prefilter_job *job, filtered_level *level);

/** Texels of an output in seeded directions, and the directions of their centres. */
typedef struct probe_set {
    uint32_t count;
    double (*direction)[3]; /* [count] unit, of our world */
    const float **texel;    /* [count] RGB */
} probe_set;
ncr_status probe_set_make(const prefilter_job *job, const ncr_directional_map *map, probe_set *out);
void probe_set_dispose(const prefilter_job *job, probe_set *set);
/** Compare against what should be there: [count][3]; fills error, nrmse and its spread. */
ncr_status probe_set_compare(const prefilter_job *job, const probe_set *set, const double *want,
                             filtered_level *level);

/** Whether every level keeps the tolerance. */
bool prefilter_met(const prefilter_job *job);
void prefilter_say(const prefilter_job *job);
json_t *prefilter_describe(const prefilter_job *job);

#endif
