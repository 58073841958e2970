/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [KTX2]  M. Callow. KTX File Format Specification, version 2.0. 2020
 *   [KDF]   A. Garrard. Khronos Data Format Specification, version 1.3: basic descriptor block. 2019
 */
#include "io/ktx2_internal.h"

const uint8_t ncr_ktx2_identifier[12] = {0xab, 'K',  'T',  'X',  ' ',  '2',
                                         '0',  0xbb, '\r', '\n', 0x1a, '\n'};

static const ktx2_texel texels[] = {
    {97, 2, 8, 4},                    /* R16G16B16A16_SFLOAT */
    {123, 4, 4, 3},                   /* E5B9G9R9_UFLOAT_PACK32 */
    {109, 4, 16, 4},                  /* R32G32B32A32_SFLOAT */
    {76, 2, 2, 1},   {90, 2, 6, 3},   /* R16, R16G16B16_SFLOAT */
    {100, 4, 4, 1},  {106, 4, 12, 3}, /* R32, R32G32B32_SFLOAT */
};

const ktx2_texel *ncr_ktx2_texel_of(uint32_t vk_format)
{
    for (size_t k = 0; k < sizeof texels / sizeof texels[0]; k++)
        if (texels[k].vk_format == vk_format)
            return &texels[k];
    return NULL;
}

const ktx2_texel *ncr_ktx2_texel_at(ncr_ktx2_format format)
{
    return &texels[format];
}

uint32_t ncr_ktx2_alignment(const ktx2_texel *texel)
{
    const uint32_t b = texel->bytes;
    return b % 4 == 0 ? b : b % 2 == 0 ? 2 * b : 4 * b;
}

/* ---- Data format descriptor ---- */

enum { is_exponent = 0x20, is_signed = 0x40, is_float = 0x80 };

static void put_sample(uint8_t *at, uint32_t offset, uint32_t bits, uint32_t channel,
                       uint32_t lower, uint32_t upper)
{
    ktx2_put32(at, offset | (bits - 1) << 16 | channel << 24);
    ktx2_put32(at + 4, 0); /* position within the texel */
    ktx2_put32(at + 8, lower);
    ktx2_put32(at + 12, upper);
}

/* -1 and 1 as floats tell the range of signed floats; alpha is channel 15.                [KDF] */
static uint32_t put_floats(const ktx2_texel *texel, uint8_t *at)
{
    const uint32_t bits = 8 * texel->type_size;
    for (uint32_t k = 0; k < texel->channels; k++)
        put_sample(at + 16 * k, k * bits, bits, (k == 3 ? 15 : k) | is_signed | is_float,
                   0xbf800000u, 0x3f800000u);
    return texel->channels;
}

/* Mantissa and exponent of each channel are samples of their own; 8448 and 15 are what the data
 * format specification's example of this format has for the value 1 and the bias.         [KDF] */
static uint32_t put_shared_exponent(uint8_t *at)
{
    for (uint32_t k = 0; k < 3; k++) {
        put_sample(at + 32 * k, 9 * k, 9, k, 0, 8448);
        put_sample(at + 32 * k + 16, 27, 5, k | is_exponent, 15, 31);
    }
    return 6;
}

uint32_t ncr_ktx2_describe(const ktx2_texel *texel, uint8_t out[ktx2_dfd_most])
{
    const bool shared = texel->vk_format == 123;
    const uint32_t samples = shared ? put_shared_exponent(out + 28) : put_floats(texel, out + 28);
    const uint32_t block = 24 + 16 * samples;
    ktx2_put32(out, 4 + block);
    ktx2_put32(out + 4, 0);                     /* Khronos, basic */
    ktx2_put32(out + 8, 2 | block << 16);       /* version 1.3 */
    ktx2_put32(out + 12, 1 | 1 << 8 | 1 << 16); /* RGBSDA, BT709, linear */
    ktx2_put32(out + 16, 0);                    /* texel blocks of one texel */
    ktx2_put32(out + 20, texel->bytes);
    ktx2_put32(out + 24, 0);
    return 4 + block;
}
