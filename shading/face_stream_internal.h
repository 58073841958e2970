/* SPDX-License-Identifier: MIT
 * face_stream_internal.h - the faces of a light field that is read as it is looked at. */
#ifndef NCR_SHADING_FACE_STREAM_INTERNAL_H
#define NCR_SHADING_FACE_STREAM_INTERNAL_H

#include "shading/lightfield_internal.h"
#include "shading/tile_cache.h"

/* Key 6 point + face. A slot holds the face's texels with their apron, then its distances. */
struct ncr_face_stream {
    const ncr_lightfield *field;
    ncr_tile_source source;
    ncr_tile_cache *cache;
    size_t depth_at, slot_bytes;
    _Atomic uint64_t bytes_read;
};

#endif
