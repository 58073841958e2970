/* SPDX-License-Identifier: MIT
 * small_rsibr.h - radiance maps of car paint, the smallest there are, in a folder. */
#ifndef NCR_TESTS_SMALL_RSIBR_H
#define NCR_TESTS_SMALL_RSIBR_H

#include "fuzz.h"

#include "io/rsibr_file.h"

static inline void small_rsibr_light(const double d[3], void *user, float *out)
{
    (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.5 * d[c]);
}

static inline void small_rsibr_write(const char *folder)
{
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .views = 12, .size = 2};
    ncr_directional_map map;
    ncr_rsibr_brdf brdf;
    ncr_rsibr set;
    FUZZ_CHECK(ncr_directional_map_init(NULL, NCR_MAP_LATLONG, 8, 3, &map) == NCR_OK);
    FUZZ_CHECK(ncr_directional_map_fill(NULL, &map, 0, small_rsibr_light, NULL) == NCR_OK);
    FUZZ_CHECK(ncr_rsibr_brdf_find(NULL, "car-paint", &brdf) == NCR_OK);
    FUZZ_CHECK(ncr_rsibr_create(NULL, &map, &brdf, &opts, &set) == NCR_OK);
    FUZZ_CHECK(ncr_rsibr_write(NULL, folder, &set) == NCR_OK);
    ncr_rsibr_dispose(NULL, &set);
    ncr_directional_map_dispose(NULL, &map);
}

#endif
