/* SPDX-License-Identifier: MIT
 * harmonics_kernel_internal.h - the hot loops of spherical-harmonic transforms, as each
 * instruction set provides them, and the shapes of what they work on.
 *
 * Rings come in pairs, mirrored at the equator: pair q is row q from the top and row q from the
 * bottom of `rows`. Fourier coefficients of a pair are kept as the sum and the difference of the
 * two rings: `columns` = 2 channels numbers each (real parts of all channels, then imaginary), the
 * sum feeding even l - m and the difference odd. */
#ifndef NCR_SHADING_HARMONICS_KERNEL_INTERNAL_H
#define NCR_SHADING_HARMONICS_KERNEL_INTERNAL_H

#include "shading/fft_internal.h"
#include "shading/prefilter_internal.h"
#include "shading/taps_internal.h"

#define ALWAYS static inline __attribute__((always_inline))

enum { NCR_WIDEST = 16, NCR_SCAN_PART = 512 };

/* What is said of texels while they are read. */
typedef struct ncr_scan {
    uint64_t negative, nonfinite;
    double square; /* sum of squares */
} ncr_scan;

/* A group of consecutive fine rows with the same neighbours on the coarse grid. */
typedef struct ncr_tap_group {
    uint32_t rows;        /* 1 .. 4 */
    const float *weight;  /* [rows][NCR_TAPS] */
    const float *fine[4]; /* the rows; written by gather */
    float *coarse;        /* the first of NCR_TAPS rows, `stride` floats apart */
    size_t stride;
} ncr_tap_group;

/* Rows that a Fourier transform reads or writes. */
typedef struct ncr_row_set {
    uint32_t rows, width, channels;
    uint32_t pairs, padded; /* (rows + 1) / 2, and that rounded up to NCR_WIDEST */
    uint32_t orders;        /* 0 .. orders-1 are wanted */
    float *data;            /* [rows][width][channels] */
    const ncr_fft *fft;
    const ncr_taps *taps; /* from `width` places to fft->n, or NULL: they are the same */
    float *spectrum;      /* [orders][4 channels][padded]: sums, then differences */
} ncr_row_set;

/* Rings for the Legendre sums, from the pole to the equator, count a multiple of NCR_WIDEST. */
typedef struct ncr_ring_set {
    size_t count;
    const double *x, *s; /* cos and sin of theta */
} ncr_ring_set;

/* Half-vectors of one ring about the eye, seen from normals of another: GGX, or Beckmann with
 * V-cavities. With lift = 1 - cos(azimuth between them), 1 - n.h = near + across lift. */
typedef struct ncr_facet_ring {
    bool beckmann, cavity;
    float alpha, v_h, n_v, near, across;
    float fresnel, spread_v; /* F(v.h); Smith's n.v (1 + 2 Lambda) */
} ncr_facet_ring;

typedef struct ncr_sht_kernels {
    uint32_t lanes; /* row pairs per call of the row kernels; ring data comes in vectors of half
                       as many doubles: data[ring / (lanes/2)][2 columns][ring % (lanes/2)] */

    void (*scan)(size_t count, const float *x, ncr_scan *scan);

    /* coarse[k] += sum_r weight[r][k] fine[r], and fine[r] = sum_k weight[r][k] coarse[k], over
     * floats [begin, end) of each row. */
    void (*spread)(const ncr_tap_group *group, size_t begin, size_t end);
    void (*gather)(const ncr_tap_group *group, float *const fine[4], size_t begin, size_t end);

    /* Pairs pair0 .. pair0 + lanes - 1: rows to spectrum and back. `scratch` holds
     * ncr_row_scratch() floats. */
    void (*rows_to_spectrum)(const ncr_row_set *set, uint32_t pair0, float *scratch);
    void (*spectrum_to_rows)(const ncr_row_set *set, uint32_t pair0, float *scratch);

    /* out[l-m][columns] = sum over rings of P(l,m) data, and data = sum over l of P(l,m)
     * coefficient. step: ncr_legendre_steps(m, ...) with zeros for 5 more degrees; out has room
     * for 3 more, coefficient ends with one degree of zeros. state: [3][count] scratch. */
    void (*analyse_order)(const ncr_ring_set *rings, uint32_t m, uint32_t last, uint32_t channels,
                          const double *step, const double *data, double *state, double *out);
    void (*synthesise_order)(const ncr_ring_set *rings, uint32_t m, uint32_t last,
                             uint32_t channels, const double *step, const double *coefficient,
                             double *data);

    /* Values of a grid in count <= NCR_GRID_BATCH directions: out[count][4]. */
    void (*sample_grid)(const ncr_sphere_grid *grid, size_t count, const ncr_vec3 *directions,
                        float *out);

    /* Add count <= NCR_GRID_BATCH values of four channels to a grid, each to the neighbours that
     * sample_grid would take it from. */
    void (*scatter_grid)(const ncr_sphere_grid *grid, float *data, size_t count,
                         const ncr_vec3 *directions, const float *values);

    /* F D G / (4 n.v) at `count` azimuths. */
    void (*facet_row)(const ncr_facet_ring *ring, size_t count, const float *lift, float *out);

    /* out[k] = sum over i < count of matrix[i] vector[k][i], k < columns <= 8; count a multiple of
     * NCR_WIDEST, vectors `stride` floats apart. */
    void (*dot_rows)(size_t count, const float *matrix, size_t columns, size_t stride,
                     const float *vectors, float *out);
} ncr_sht_kernels;

/* Floats of scratch that the row kernels need for one set, at any number of lanes. */
size_t ncr_row_scratch(const ncr_row_set *set);

/* The best for this processor. */
const ncr_sht_kernels *ncr_sht_kernels_get(void);

extern const ncr_sht_kernels ncr_sht_plain, ncr_sht_avx2, ncr_sht_avx512;

#endif
