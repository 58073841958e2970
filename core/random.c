/* SPDX-License-Identifier: MIT */
#include "core/random.h"

/* This file follows:
 *   [Steele14]  G. Steele, D. Lea, C. Flood. Fast splittable pseudorandom number generators. 2014
 *   [Sobol67]   I. Sobol'. On the distribution of points in a cube. 1967
 *   [Burley20]  B. Burley. Practical hash-based Owen scrambling. JCGT 2020 */

static uint64_t mix64(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

uint64_t ncr_hash64(uint64_t counter, uint64_t key)
{
    const uint64_t golden = 0x9e3779b97f4a7c15u; /* 2^64 / golden ratio, odd */
    return mix64(mix64(key + golden) + counter * golden);
}

double ncr_uniform(uint64_t counter, uint64_t key)
{
    return (double)(ncr_hash64(counter, key) >> 11) * 0x1p-53;
}

static uint32_t reverse_bits(uint32_t x)
{
    x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    return __builtin_bswap32(x);
}

/* A hash in which each bit depends only on the bits below it: on reversed numbers that is an
 * Owen scramble, each digit permuted by the digits before it.                     [Burley20] */
static uint32_t laine_karras(uint32_t x, uint32_t key)
{
    x += key;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

static uint32_t owen_scramble(uint32_t x, uint32_t key)
{
    return reverse_bits(laine_karras(reverse_bits(x), key));
}

/* Second dimension of the Sobol' sequence: direction numbers of x + 1, v_k = v_{k-1} ^ v_{k-1}/2. */
static uint32_t sobol_second(uint32_t index)
{
    uint32_t result = 0;
    for (uint32_t v = 0x80000000u; index; index >>= 1, v ^= v >> 1)
        result ^= index & 1 ? v : 0;
    return result;
}

static float to_unit(uint32_t x)
{
    return (float)(x >> 8) * 0x1p-24f;
}

void ncr_sobol2(uint32_t index, uint32_t key, float out[2])
{
    const uint32_t shuffled = owen_scramble(index, key);
    const uint32_t key_x = (uint32_t)ncr_hash64(0, key), key_y = (uint32_t)ncr_hash64(1, key);
    out[0] = to_unit(owen_scramble(reverse_bits(shuffled), key_x));
    out[1] = to_unit(owen_scramble(sobol_second(shuffled), key_y));
}
