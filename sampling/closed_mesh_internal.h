/* SPDX-License-Identifier: MIT
 * closed_mesh_internal.h - whether a mesh bounds a solid of one piece. */
#ifndef NCR_SAMPLING_CLOSED_MESH_INTERNAL_H
#define NCR_SAMPLING_CLOSED_MESH_INTERNAL_H

#include "geometry/scene.h"

/* Whether the triangles close without a gap or a fold, turned the same way, and hang together by
 * their edges. Places are compared to the bit, as a scene's triangles meet; empty triangles are passed over. A mesh without triangles is not closed. NCR_E_NOMEM. */
ncr_status ncr_closed_mesh_find(const ncr_ctx *ctx, const ncr_triangles *mesh, bool *closed);

#endif
