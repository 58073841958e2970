/* SPDX-License-Identifier: MIT
 * gather_internal.h - the sites of stored irradiance while it is being made. */
#ifndef NCR_SHADING_GATHER_INTERNAL_H
#define NCR_SHADING_GATHER_INTERNAL_H

#include "shading/batch_internal.h"

#include <stdatomic.h>

typedef struct site_light {
    float lamps[3];    /* from area lights, in full */
    float gathered[3]; /* from everything else, so far */
    float value[3];    /* what look-ups read */
    float noise2;      /* variance of the luminance of `gathered` */
    bool buried, set;
} site_light;

/* A ray of the first gathering that met a surface: the site nearest to the hit, and the albedo
 * there in 255ths. Light is carried from bounce to bounce over these, without tracing again. */
typedef struct site_link {
    uint32_t site; /* NCR_NONE: the ray met none */
    uint8_t albedo[4];
} site_link;

typedef struct gather_job {
    ncr_irradiance *ir;
    const node_layout *layout;
    site_light *sites;
    site_link *links; /* [site_count][rays] when the first gathering fills them, else NULL */
    uint32_t rays;
    uint64_t key;
    atomic_uint_least64_t traced;
} gather_job;

/* Gather over `rays` rays per site from what the irradiance holds now: sets `gathered` and
 * `noise2`, and with links also `lamps` and `buried`. */
ncr_status ncr_gather(const ncr_ctx *ctx, gather_job *job);

/* One more bounce over the links: value = lamps + gathered + what the linked sites reflect. Reads
 * `value` of all sites, writes next[site]. */
ncr_status ncr_gather_bounce(const ncr_ctx *ctx, const gather_job *job, float (*next)[3]);

/* Give buried sites the light of the nearest free ones, ring by ring, across patches: a look-up
 * beside the line where a handle enters a body then does not mix in the dark of the inside.
 * Returns how many are buried. */
ncr_status ncr_sites_spread(const ncr_ctx *ctx, const node_layout *l, site_light *sites,
                            size_t *buried);

/* Average `gathered` over neighbours whose difference may be noise. */
ncr_status ncr_sites_smooth(const ncr_ctx *ctx, const node_layout *l, site_light *sites);

#endif
