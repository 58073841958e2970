/* SPDX-License-Identifier: MIT
 * method_internal.h - what a shading method is made of: a row of the registry, and the pixels it
 * is handed a run at a time. */
#ifndef NCR_SHADING_METHOD_INTERNAL_H
#define NCR_SHADING_METHOD_INTERNAL_H

#include "shading/blend.h"
#include "shading/method.h"

/* Pixels of a run: few enough that two runs stay in the first cache. */
enum { NCR_RUN = NCR_TRACE_BATCH / 2, NCR_CANDIDATES = 4 };

/* One vector per pixel of a run. */
typedef struct ncr_rows {
    float at[3][NCR_RUN];
} ncr_rows;

/* As the three pointers that rows are passed by, to read and to write. */
#define NCR_ROWS_IN(rows) ((const float *const[3]){(rows)->at[0], (rows)->at[1], (rows)->at[2]})
#define NCR_ROWS_OUT(rows) ((float *const[3]){(rows)->at[0], (rows)->at[1], (rows)->at[2]})

static inline ncr_vec3 ncr_rows_get(const ncr_rows *rows, size_t k)
{
    return (ncr_vec3){rows->at[0][k], rows->at[1][k], rows->at[2][k]};
}

static inline ncr_vec3 ncr_vec3_at(const float *const from[3], size_t k)
{
    return (ncr_vec3){from[0][k], from[1][k], from[2][k]};
}

static inline void ncr_rows_set(ncr_rows *rows, size_t k, ncr_vec3 value)
{
    rows->at[0][k] = value.x;
    rows->at[1][k] = value.y;
    rows->at[2][k] = value.z;
}

/* What the G-buffer says of some pixels, copied side by side. */
typedef struct ncr_packed {
    uint32_t patch[NCR_RUN];
    float u[NCR_RUN], v[NCR_RUN];
    ncr_rows x, n, view;
} ncr_packed;

/* Up to NCR_RUN pixels of the object, structure of arrays. Methods read everything above `rgb` and
 * write rgb. Where neighbours fill whole rows of 64 they are read where they lie, in the G-buffer;
 * others are packed together. Either way there is something to read up to the end of a row. */
typedef struct ncr_run {
    size_t count;
    const uint32_t *patch;
    const float *u, *v;
    const float *x[3], *n[3]; /* position in frame units, unit normal toward the eye */
    const float *view[3];     /* unit vector to the eye */
    uint32_t pixel[NCR_RUN];
    ncr_rows r;              /* 2 n (n.view) - view */
    uint64_t texel[NCR_RUN]; /* where the sample map has its points, if there is one */
    uint16_t point[NCR_CANDIDATES][NCR_RUN]; /* these; NCR_NO_POINT without a map */
    ncr_rows rgb;
    ncr_packed packed; /* what the pointers point to, unless the pixels are in place */
} ncr_run;

/* What is done to every pixel whatever the method, by instruction set. All give the same bits. */
typedef struct ncr_run_kernels {
    /* Find texels of the sample map and start fetching them. */
    void (*ask)(const ncr_sample_map *map, ncr_run *run);
    void (*reflect)(ncr_run *run); /* find r */
    void (*look_up_points)(const ncr_sample_map *map, ncr_run *run);
    uint32_t (*count_weights)(size_t count, const float (*w)[NCR_RUN]); /* that are positive */
    void (*store)(const ncr_run *run, float *image);
} ncr_run_kernels;
extern const ncr_run_kernels ncr_run_plain, ncr_run_avx2, ncr_run_avx512;

/* Those of this processor. */
const ncr_run_kernels *ncr_run_kernels_here(void);

/* What all runs of one call share. */
typedef struct ncr_shade_job {
    const ncr_run_kernels *kernels;
    const ncr_shading_inputs *in;
    const ncr_gbuffer *gbuffer;
    const float (*point)[4]; /* [point count + 1] frame units and a 0, aligned; NULL without */
    float horizon;           /* cosine below which reconstruction avoids a point; -2: no rule */
    float lift;              /* trace: how far off the surface rays start, frame units */
} ncr_shade_job;

typedef void ncr_shade_fn(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                          ncr_shade_stats *stats);

/* Parts a method cannot do without. */
enum { NCR_NEEDS_FIELD = 1, NCR_NEEDS_PROBE = 2, NCR_NEEDS_TRACER = 4 };
/* Distant light; filtered by Lambert's lobe; by the chosen lobe, or if there is one. */
enum { NCR_NEEDS_DISTANT = 128, NCR_NEEDS_DIFFUSE = 256, NCR_NEEDS_GLOSS = 512 };
enum { NCR_TAKES_GLOSS = 1024 };
/* Radiance maps, which show all of a surface: a full image has nothing under them. */
enum { NCR_NEEDS_RSIBR = 2048, NCR_SHOWS_ALL = 4096 };
enum { NCR_NEEDS_NPR = 16384 };  /* a drawing, of the kind `detail` */
enum { NCR_NEEDS_LOBES = 8192 }; /* a sum of lobes, of the form `detail` */

/* In which directions a method looks up the field, so that a plan can leave out the others: along
 * r, or from the point to the surface; at any of the candidates, or only at the first one (of a
 * reconstruction: the first above the horizon). A method that says nothing may look anywhere. */
enum { NCR_LOOKS_ALONG_R = 8, NCR_LOOKS_AT_SURFACE = 16, NCR_LOOKS_FROM_FIRST = 32 };
enum { NCR_READS_DEPTH = 64 }; /* and asks for distances */

/* What follows a method's name. */
typedef enum ncr_parameter {
    NCR_PARAMETER_NONE = 0,
    NCR_PARAMETER_EXPONENT, /* "name:N", N in [0, 1e6] or inf */
    NCR_PARAMETER_INDEX,    /* "name:n", an index of refraction, (0, 1e6] */
    NCR_PARAMETER_WIDTH,    /* "name:w", of a line in pixels, [0.5, 16] */
} ncr_parameter;

/* A row of the registry. */
typedef struct ncr_method_entry {
    const char *name, *summary;
    ncr_parameter takes;
    unsigned needs;
    ncr_shade_fn *recon, *reflect; /* NULL: this method has no such term */
    int detail;                    /* whatever tells entries with the same function apart */
} ncr_method_entry;

/* Entry k; NULL past the last. */
const ncr_method_entry *ncr_method_entry_at(size_t k);

ncr_shade_fn ncr_recon_nearest, ncr_recon_average; /* oslf_reconstruct.c */
/* oslf_mirror.c: detail is the ncr_basis */
ncr_shade_fn ncr_reflect_blend, ncr_reflect_closest, ncr_reflect_angle;
ncr_shade_fn ncr_reflect_envmap, ncr_reflect_proxy; /* environment.c */
ncr_shade_fn ncr_recon_trace, ncr_reflect_trace;    /* method_trace.c */
/* method_distant.c */
ncr_shade_fn ncr_reflect_mirror, ncr_reflect_prefiltered, ncr_reflect_fresnel;
ncr_shade_fn ncr_reflect_lobes; /* detail is the ncr_lobe_form */
ncr_shade_fn ncr_recon_lambert, ncr_recon_fresnel;
ncr_shade_fn ncr_reflect_rsibr; /* method_rsibr.c */
ncr_shade_fn ncr_reflect_npr;   /* method_npr.c: detail is the ncr_npr_kind */

/* Make a run of neighbouring pixels [begin, end) in place: as many whole rows of 64 as there are and
 * fit. Returns how many pixels these are, which may be none. */
size_t ncr_run_take(const ncr_gbuffer *gbuffer, size_t begin, size_t end, ncr_run *run);

/* Pack neighbouring pixels [begin, end) into a run beside those that are in it, as many as there is
 * room for; returns how many. */
size_t ncr_run_add(const ncr_gbuffer *gbuffer, size_t begin, size_t end, ncr_run *run);

/* Start fetching a quarter, 0 to 3, of what the run after the one from pixel `next` on needs of the
 * G-buffer. */
void ncr_run_fetch(const ncr_gbuffer *gbuffer, size_t next, unsigned quarter);

/* Find a full run's texels in the sample map and start fetching them: done a run ahead, since they
 * lie far apart. */
void ncr_run_ask(const ncr_shade_job *job, ncr_run *run);

/* What follows from the pixels of a run that has asked: where their mirrors look, and which points
 * see them. */
void ncr_run_complete(const ncr_shade_job *job, ncr_run *run);

/* Offsets from pixel k to its candidates, and a bit for each that there is. */
unsigned ncr_run_offsets(const ncr_shade_job *job, const ncr_run *run, size_t k,
                         ncr_vec3 to_point[NCR_CANDIDATES]);

#endif
