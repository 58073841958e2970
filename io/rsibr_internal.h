/* SPDX-License-Identifier: MIT
 * rsibr_internal.h - what writing and reading of radiance maps agree on. */
#ifndef NCR_IO_RSIBR_INTERNAL_H
#define NCR_IO_RSIBR_INTERNAL_H

#include "io/rsibr_file.h"

enum { NCR_RSIBR_NAME = 32, NCR_RSIBR_SHEETS = NCR_RSIBR_LOBES * NCR_RSIBR_TURNS_MAX };

extern const char ncr_rsibr_format[];
extern const char *const ncr_rsibr_kinds[6], *const ncr_rsibr_facets[2],
                                                 *const ncr_rsibr_shadowings[2];

typedef struct ncr_rsibr_path {
    char text[4096];
} ncr_rsibr_path;

/* NCR_E_ARG when the two together are too long. */
ncr_status ncr_rsibr_join(const ncr_ctx *ctx, const char *folder, const char *name,
                          ncr_rsibr_path *out);

/* An image for all eyes of a set, black. */
ncr_status ncr_rsibr_sheet_init(const ncr_ctx *ctx, const ncr_rsibr *set, ncr_image *out);
/* Copy one map of all eyes to its sheet, or from it. */
void ncr_rsibr_sheet_copy(const ncr_rsibr *set, uint32_t map, bool from_sheet, ncr_image *sheet);
uint32_t ncr_rsibr_sheet_crc(const ncr_image *sheet);

#endif
