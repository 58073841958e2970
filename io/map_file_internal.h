/* SPDX-License-Identifier: MIT
 * map_file_internal.h - what readers and writers of map files share. */
#ifndef NCR_IO_MAP_FILE_INTERNAL_H
#define NCR_IO_MAP_FILE_INTERNAL_H

#include "io/map_file.h"

/** The sentence that a file says about itself: "nacre map: latlong usd; axes +x +z -y; +Y on top,
 *  ...; linear radiance, Rec. 709". Axes are those of our world along the file's x, y and z. */
void ncr_map_state(ncr_map_stated as, char text[NCR_IMAGE_COMMENT]);

/** Whether a cube's faces are files of their own, and the path of one: released with ncr_free. */
bool ncr_map_is_six(const ncr_convention *convention);
ncr_status ncr_map_face_path(const ncr_ctx *ctx, const char *path, int face, char **out);

/** Whether a convention is what six faces of KTX 2 are. */
bool ncr_map_is_ktx(const ncr_convention *convention);

#endif
