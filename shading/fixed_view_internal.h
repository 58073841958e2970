/* SPDX-License-Identifier: MIT
 * fixed_view_internal.h - the eye's frame: z is the direction to the eye. */
#ifndef NCR_SHADING_FIXED_VIEW_INTERNAL_H
#define NCR_SHADING_FIXED_VIEW_INTERNAL_H

#include "shading/fixed_view.h"
#include "shading/harmonics_kernel_internal.h"
#include "shading/prefilter_internal.h"

/* Normals n and half-vectors h both stand on `rows` rings about the eye, `width` places on each,
 * as `grid` says: evenly, but closer and closer toward the horizon. */
struct ncr_fixed_view {
    ncr_gloss gloss;
    bool sharp; /* no tables: facets are summed */
    uint32_t rows, width, orders;
    uint32_t padded; /* rows, rounded up to NCR_WIDEST */
    ncr_fft fft;
    float *matrix;  /* [row of n][order][padded row of h] */
    float *odd;     /* the same of what is odd in the azimuth; NULL: nothing is */
    float *weights; /* of 8 neighbours */
    ncr_sphere_grid grid;
};

/* A grid fine enough for facets of this alpha, with room for the tables. */
ncr_status ncr_fixed_view_grid(const ncr_ctx *ctx, double alpha, bool odd, ncr_fixed_view *fixed);

/* Reflectance from every half-vector, [row of h][width] by azimuth, to a normal of a row at azimuth
 * 0. Called from many threads. */
typedef void ncr_fixed_view_ring_fn(const ncr_fixed_view *fixed, uint32_t row_n, const void *user,
                                    float *data);

/* Fill the tables of a grid; ring NULL: by its gloss. */
ncr_status ncr_fixed_view_tabulate(const ncr_ctx *ctx, ncr_fixed_view *fixed,
                                   ncr_fixed_view_ring_fn *ring, const void *user);

/* Of the middle of a row, from the eye. */
double ncr_fixed_view_polar_angle(const ncr_fixed_view *fixed, uint32_t row);

/* Render a view by the tables, and by those of the mirrored reflectance, whose odd part has the
 * other sign: out[2][count][channels]. Without an odd part, out[1][count][channels]. */
ncr_status ncr_fixed_view_render_both(const ncr_ctx *ctx, const ncr_fixed_view *fixed,
                                      const ncr_image *map, ncr_vec3 view, size_t count,
                                      const ncr_vec3 *normals, float *out);

/* Rings of so many channels, for the row kernels, and the size of their spectrum. */
ncr_row_set ncr_fixed_view_rows(const ncr_fixed_view *fixed, uint32_t channels);
size_t ncr_fixed_view_spectrum(const ncr_row_set *set);

/* An orthonormal frame: axis[2] is the eye. */
typedef struct ncr_eye_frame {
    float axis[3][3];
} ncr_eye_frame;

ncr_eye_frame ncr_eye_frame_of(ncr_vec3 view);

/* Add up the texels of a map, without those points of light, at their half-vectors:
 * rows[row][column][channel], cleared first. */
ncr_status ncr_fixed_view_gather(const ncr_ctx *ctx, const ncr_fixed_view *fixed,
                                 const ncr_image *map, const ncr_eye_frame *frame,
                                 size_t point_count, const ncr_light_point *points, float *rows);

/* What a surface of unit normal n sends toward the eye at v of light from `points`, added to
 * value[channel]: all unit, along one frame. */
void ncr_fixed_view_add_points(const ncr_gloss *gloss, const double n[3], const double v[3],
                               size_t count, const ncr_light_point *points, uint32_t channels,
                               float *value);

/* The sharp path: facets summed for each normal. */
ncr_status ncr_fixed_view_facets(const ncr_ctx *ctx, const ncr_fixed_view *fixed,
                                 const ncr_image *map, const ncr_eye_frame *frame, size_t count,
                                 const ncr_vec3 *normals, float *out);

#endif
