/* SPDX-License-Identifier: MIT
 * nearest_wide.h - the search for several texels at once, written over a dozen one-line wrappers
 * that the including file defines for its instruction set:
 *
 *     wide, mask, LANES                 doubles side by side, and a choice for each
 *     w_load(float *), w_set(double)    widening load, broadcast
 *     w_add w_sub w_mul                 one rounding each, as in C
 *     w_less(a, b), m_and, m_any        comparisons
 *     w_pick(m, a, b)                   m ? a : b
 *     w_bits(uint64), w_store_packed    indices ride along as bit patterns
 *
 * Every operation is the one of nearest.c, in its order, so the numbers are the same. */

static inline wide seen_distance(const wide n[3], const wide from[3], wide cos2)
{
    const wide c = w_add(w_add(w_mul(n[0], from[0]), w_mul(n[1], from[1])), w_mul(n[2], from[2]));
    const wide d2 =
        w_add(w_add(w_mul(from[0], from[0]), w_mul(from[1], from[1])), w_mul(from[2], from[2]));
    const mask sees = m_and(w_less(w_set(0), c), w_less(w_mul(cos2, d2), w_mul(c, c)));
    return w_pick(sees, d2, w_set(INFINITY));
}

static inline void search_lanes(const ncr_texel_tile *tile, uint32_t k,
                                const ncr_candidates *candidates, wide cos2, uint64_t *four)
{
    wide x[3], n[3], best[4], index[4];
    for (int c = 0; c < 3; c++) {
        x[c] = w_load(tile->x[c] + k);
        n[c] = w_load(tile->n[c] + k);
    }
    for (int s = 0; s < 4; s++) {
        best[s] = w_set(INFINITY);
        index[s] = w_bits(0xffff);
    }
    for (size_t c = 0; c < candidates->count; c++) {
        const wide from[3] = {w_sub(w_set(candidates->x[c]), x[0]),
                              w_sub(w_set(candidates->y[c]), x[1]),
                              w_sub(w_set(candidates->z[c]), x[2])};
        const wide d2 = seen_distance(n, from, cos2);
        const mask m3 = w_less(d2, best[3]);
        if (!m_any(m3))
            continue;
        /* The masks are nested, so one pass moves the farther ones up and puts d2 in its place. */
        const wide at = w_bits(candidates->index[c]);
        const mask m2 = w_less(d2, best[2]), m1 = w_less(d2, best[1]), m0 = w_less(d2, best[0]);
        best[3] = w_pick(m2, best[2], w_pick(m3, d2, best[3]));
        index[3] = w_pick(m2, index[2], w_pick(m3, at, index[3]));
        best[2] = w_pick(m1, best[1], w_pick(m2, d2, best[2]));
        index[2] = w_pick(m1, index[1], w_pick(m2, at, index[2]));
        best[1] = w_pick(m0, best[0], w_pick(m1, d2, best[1]));
        index[1] = w_pick(m0, index[0], w_pick(m1, at, index[1]));
        best[0] = w_pick(m0, d2, best[0]);
        index[0] = w_pick(m0, at, index[0]);
    }
    w_store_packed(four + k, index);
}

static inline void search_tile(const ncr_texel_tile *tile, const ncr_candidates *candidates,
                               double cos2, uint64_t *four)
{
    /* A tile of fewer texels than lanes reads zeros past its end: texels without a normal. */
    for (uint32_t k = 0; k < tile->side * tile->side; k += LANES)
        search_lanes(tile, k, candidates, w_set(cos2), four);
}
