/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [M]  C. Madsen, B. Mortensen, J. Andersen. Real-time image-based rendering of glossy surfaces.
 *        2008 */
#include "shading/data_size.h"

uint64_t ncr_data_size_observations(uint64_t texels, uint32_t views)
{
    return texels * views * 5 * sizeof(float);
}

uint64_t ncr_data_size_lobes(uint64_t texels, uint32_t lobes)
{
    return texels * (4 + 6 * (uint64_t)lobes) * sizeof(float);
}

uint64_t ncr_data_size_harmonics(uint64_t texels, uint32_t bands)
{
    return texels * 3 * bands * bands * sizeof(float);
}
