/* SPDX-License-Identifier: MIT
 * random.h - counter-based random numbers and low-discrepancy points: no state, no order. */
#ifndef NCR_CORE_RANDOM_H
#define NCR_CORE_RANDOM_H

#include "core/base.h"

NCR_BEGIN

/** 64 well-mixed bits from a counter and a key (two rounds of a 64-bit finaliser). [Steele14] */
NCR_API uint64_t ncr_hash64(uint64_t counter, uint64_t key);

/** Uniform double in [0, 1) with 53 random bits. */
NCR_API double ncr_uniform(uint64_t counter, uint64_t key);

/**
 * Point `index` of a two-dimensional Sobol' sequence, Owen-scrambled by a hash of `key`.
 *
 * @param index  which point; the first 2^k points of one key are a (0,k,2)-net
 * @param out    two coordinates in [0, 1)                          [Burley20] [Sobol67]
 *
 * Different keys give independently scrambled sequences. Re-entrant, allocates nothing.
 */
NCR_API void ncr_sobol2(uint32_t index, uint32_t key, float out[2]);

NCR_END

#endif
