/* SPDX-License-Identifier: MIT
 * rsibr_file.h - radiance maps of a material on disk: a folder of OpenEXR sheets and rsibr.json.
 *
 * One sheet for each map of the set, all eyes side by side: eye k stands in column k % columns and row
 * k / columns, columns = ceil(sqrt(eyes)). docs/command.md has the rest. */
#ifndef NCR_IO_RSIBR_FILE_H
#define NCR_IO_RSIBR_FILE_H

#include "shading/rsibr.h"

NCR_BEGIN

/** The file that makes a folder one of these. */
#define NCR_RSIBR_MANIFEST "rsibr.json"

/**
 * Write a set.
 *
 * @param folder  made when it is not there (its parent must be)
 * @return        NCR_E_IO, NCR_E_LIMIT (a sheet too large), NCR_E_NOMEM
 *
 * Sheets are named by their contents and rsibr.json is renamed into place last: at every instant the
 * folder holds the earlier set or the new one. Sheets of the earlier one are removed afterwards.
 */
NCR_API ncr_status ncr_rsibr_write(const ncr_ctx *ctx, const char *folder, const ncr_rsibr *set);

/** Read one back: the same bits. NCR_E_FORMAT (the sentence says where; sheets whose contents are not
 *  what the manifest says), NCR_E_IO, NCR_E_NOMEM. On failure *out is {0}. */
NCR_API ncr_status ncr_rsibr_read(const ncr_ctx *ctx, const char *folder, ncr_rsibr *out);

/** Words of a lobe: "mirror", "phong", "gloss", "lambert", "coated", "brushed". Static storage. */
NCR_API const char *ncr_rsibr_kind_name(ncr_rsibr_kind kind);

NCR_END

#endif
