/* SPDX-License-Identifier: MIT
 * legendre_kernel_internal.h - sums over the Legendre functions of one order, D_LANES rings
 * abreast. See harmonics_kernel_internal.h for what goes in and out. */
#ifndef NCR_SHADING_LEGENDRE_KERNEL_INTERNAL_H
#define NCR_SHADING_LEGENDRE_KERNEL_INTERNAL_H

#include "shading/harmonics_kernel_internal.h"
#include "shading/legendre_internal.h"
#include "shading/wide_internal.h"

/* Degrees per block of the analysis: 4 of them times 6 sums fill the registers of AVX-512. */
enum { L_BLOCK = WIDE_BYTES == 64 ? 4 : 2 };

typedef struct legendre {
    vd p0, p1, e; /* P(l-1), P(l) without 2^(600 e) */
} legendre;

/* --- start and step --------------------------------------------------------------------------- */

ALWAYS vl below(vd a, double b)
{
    return (vl)(a < vd_all(b));
}

ALWAYS void keep_scale(vd *p, vd *e)
{
    const vl tiny = below(*p, 1 / NCR_LEGENDRE_BIG);
    *p = vd_pick(tiny, *p * vd_all(NCR_LEGENDRE_UP), *p);
    *e = vd_pick(tiny, *e - vd_all(1), *e);
}

/* P(m,m) = start s^m by repeated squaring. */
static legendre legendre_begin(uint32_t m, double start, vd s)
{
    legendre f = {.p0 = vd_all(0), .p1 = vd_all(1), .e = vd_all(0)};
    vd square = s, e = vd_all(0);
    keep_scale(&square, &e);
    for (; m > 0; m /= 2) {
        if (m & 1) {
            f.p1 *= square;
            f.e += e;
            keep_scale(&f.p1, &f.e);
        }
        square *= square;
        e += e;
        keep_scale(&square, &e);
    }
    f.p1 *= vd_all(start);
    return f;
}

/* P(l+1) from P(l) and P(l-1). */
ALWAYS void legendre_step(legendre *f, const double *step, vd x)
{
    const vd next = vd_msub(vd_all(step[0]) * x, f->p1, vd_all(step[1]) * f->p0);
    f->p0 = f->p1;
    f->p1 = next;
}

/* The same while some lanes are still below 2^-300. */
ALWAYS void legendre_step_scaled(legendre *f, const double *step, vd x)
{
    legendre_step(f, step, x);
    const vd size = vd_pick((vl)(f->p1 < vd_all(0)), -f->p1, f->p1);
    const vl grown = (vl)(size > vd_all(NCR_LEGENDRE_BIG)) & below(f->e, 0);
    const vd down = vd_all(NCR_LEGENDRE_DOWN);
    f->p0 = vd_pick(grown, f->p0 * down, f->p0);
    f->p1 = vd_pick(grown, f->p1 * down, f->p1);
    f->e = vd_pick(grown, f->e + vd_all(1), f->e);
}

/* P(l), or 0 where it is below 2^-300. */
ALWAYS vd legendre_value(const legendre *f)
{
    return vd_pick(below(f->e, 0), vd_all(0), f->p1);
}

ALWAYS bool all_live(const legendre *f)
{
    return !vl_any(below(f->e, 0));
}

ALWAYS bool none_live(const legendre *f)
{
    return !vl_any(~below(f->e, 0));
}

/* First vector of rings in which some function of this order is not negligible. */
static size_t first_vector(const ncr_ring_set *rings, uint32_t m, uint32_t last)
{
    size_t v = 0;
    while ((v + 1) * D_LANES < rings->count &&
           m > ncr_legendre_reach(last, rings->s[(v + 1) * D_LANES - 1]))
        v++;
    return v;
}

/* --- analysis --------------------------------------------------------------------------------- */

/* What the block loop keeps for each vector of rings, in `state`: p0, p1, e. */
ALWAYS legendre load_state(const double *state)
{
    return (legendre){vd_load(state), vd_load(state + D_LANES), vd_load(state + 2 * D_LANES)};
}

ALWAYS void store_state(double *state, const legendre *f)
{
    vd_store(state, f->p0);
    vd_store(state + D_LANES, f->p1);
    vd_store(state + 2 * D_LANES, f->e);
}

/* Add this vector's share of sum_rings P(l) F to L_BLOCK degrees, and step beyond them. */
ALWAYS void add_vector(const int columns, const bool live, vd x, const double *data,
                       const double *step, legendre *f, vd sum[L_BLOCK][8])
{
    for (int i = 0; i < L_BLOCK; i++) {
        const double *parity = data + (i & 1) * columns * D_LANES;
        const vd p = live ? f->p1 : legendre_value(f);
        for (int k = 0; k < columns; k++)
            sum[i][k] = vd_mad(p, vd_load(parity + k * D_LANES), sum[i][k]);
        if (live)
            legendre_step(f, step + 2 * i, x);
        else
            legendre_step_scaled(f, step + 2 * i, x);
    }
}

/* Step over L_BLOCK degrees that are nothing yet; false, and unchanged, if some are not. */
ALWAYS bool pass_over(vd x, const double *step, legendre *f)
{
    legendre g = *f;
    for (int i = 0; i < L_BLOCK; i++) {
        if (!none_live(&g))
            return false;
        legendre_step_scaled(&g, step + 2 * i, x);
    }
    *f = g;
    return true;
}

ALWAYS void analyse_columns(const int columns, const ncr_ring_set *rings, uint32_t m, uint32_t last,
                            const double *step, const double *data, double *state, double *out)
{
    const size_t vectors = rings->count / D_LANES, begin = first_vector(rings, m, last);
    const size_t stride = 2 * (size_t)columns * D_LANES;
    const double start = ncr_legendre_start(m);
    size_t live = vectors; /* all vectors from here on are live */
    for (size_t v = begin; v < vectors; v++) {
        const legendre f = legendre_begin(m, start, vd_load(rings->s + v * D_LANES));
        store_state(state + 3 * v * D_LANES, &f);
    }
    for (uint32_t l = m; l <= last; l += L_BLOCK, step += 2 * L_BLOCK, out += L_BLOCK * columns) {
        vd sum[L_BLOCK][8] = {{{0}}};
        size_t next_live = live;
        for (size_t v = live; v-- > begin;) {
            const vd x = vd_load(rings->x + v * D_LANES);
            double *own = state + 3 * v * D_LANES;
            legendre f = load_state(own);
            if (!pass_over(x, step + 2, &f))
                add_vector(columns, false, x, data + v * stride, step + 2, &f, sum);
            if (next_live == v + 1 && all_live(&f))
                next_live = v;
            store_state(own, &f);
        }
        for (size_t v = live; v < vectors; v++) {
            const vd x = vd_load(rings->x + v * D_LANES);
            double *own = state + 3 * v * D_LANES;
            legendre f = load_state(own);
            add_vector(columns, true, x, data + v * stride, step + 2, &f, sum);
            vd_store(own, f.p0);
            vd_store(own + D_LANES, f.p1);
        }
        live = next_live;
        for (int i = 0; i < L_BLOCK; i++)
            for (int k = 0; k < columns; k++)
                out[i * columns + k] = vd_sum(sum[i][k]);
    }
}

/* --- synthesis -------------------------------------------------------------------------------- */

ALWAYS void add_degree(const int columns, vd p, const double *coefficient, vd sum[8])
{
    for (int k = 0; k < columns; k++)
        sum[k] = vd_mad(p, vd_all(coefficient[k]), sum[k]);
}

ALWAYS void synthesise_columns(const int columns, const ncr_ring_set *rings, uint32_t m,
                               uint32_t last, const double *step, const double *coefficient,
                               double *data)
{
    const size_t vectors = rings->count / D_LANES, begin = first_vector(rings, m, last);
    const size_t stride = 2 * (size_t)columns * D_LANES, degrees = last - m + 1;
    const double start = ncr_legendre_start(m);
    for (size_t k = 0; k < begin * stride; k++)
        data[k] = 0;
    for (size_t v = begin; v < vectors; v++) {
        const vd x = vd_load(rings->x + v * D_LANES);
        legendre f = legendre_begin(m, start, vd_load(rings->s + v * D_LANES));
        vd even[8] = {{0}}, odd[8] = {{0}};
        size_t i = 0;
        for (; i < degrees && none_live(&f); i++)
            legendre_step_scaled(&f, step + 2 * i + 2, x);
        for (; i < degrees && (i % 2 || !all_live(&f)); i++) {
            const double *at = coefficient + i * (size_t)columns;
            if (i % 2)
                add_degree(columns, legendre_value(&f), at, odd);
            else
                add_degree(columns, legendre_value(&f), at, even);
            legendre_step_scaled(&f, step + 2 * i + 2, x);
        }
        /* The tables hold one degree of zeros past the last. */
        for (; i < degrees; i += 2) {
            const double *at = coefficient + i * (size_t)columns;
            add_degree(columns, f.p1, at, even);
            legendre_step(&f, step + 2 * i + 2, x);
            add_degree(columns, f.p1, at + columns, odd);
            legendre_step(&f, step + 2 * i + 4, x);
        }
        for (int k = 0; k < columns; k++) {
            vd_store(data + v * stride + (size_t)k * D_LANES, even[k]);
            vd_store(data + v * stride + (size_t)(columns + k) * D_LANES, odd[k]);
        }
    }
}

/* --- for 1 to 4 channels ---------------------------------------------------------------------- */

static void analyse_order(const ncr_ring_set *rings, uint32_t m, uint32_t last, uint32_t channels,
                          const double *step, const double *data, double *state, double *out)
{
    switch (channels) {
    case 1:
        analyse_columns(2, rings, m, last, step, data, state, out);
        break;
    case 2:
        analyse_columns(4, rings, m, last, step, data, state, out);
        break;
    case 3:
        analyse_columns(6, rings, m, last, step, data, state, out);
        break;
    default:
        analyse_columns(8, rings, m, last, step, data, state, out);
    }
}

static void synthesise_order(const ncr_ring_set *rings, uint32_t m, uint32_t last,
                             uint32_t channels, const double *step, const double *coefficient,
                             double *data)
{
    switch (channels) {
    case 1:
        synthesise_columns(2, rings, m, last, step, coefficient, data);
        break;
    case 2:
        synthesise_columns(4, rings, m, last, step, coefficient, data);
        break;
    case 3:
        synthesise_columns(6, rings, m, last, step, coefficient, data);
        break;
    default:
        synthesise_columns(8, rings, m, last, step, coefficient, data);
    }
}

#endif
