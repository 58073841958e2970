/* SPDX-License-Identifier: MIT
 * brushed_view_internal.h - what brushed metal reflects toward a fixed eye, by its normal, where its
 * tangent keeps one angle to the plane of eye and normal.
 *
 * The angle is taken about the mirrored direction r, from the plane that leads on from the eye to
 * the part of the tangent that is across r: see rsibr.h. Everything then turns about the eye as one,
 * as fixed_view.h has it; but only the mirror image of one angle is that of its opposite. */
#ifndef NCR_SHADING_BRUSHED_VIEW_INTERNAL_H
#define NCR_SHADING_BRUSHED_VIEW_INTERNAL_H

#include "shading/brushed.h"
#include "shading/fixed_view_internal.h"

/* Alphas that the tables are made for. */
#define NCR_BRUSHED_LEAST 0.05
#define NCR_BRUSHED_MOST 1.0

/* The grid; the tables come with a turn. Destroy with ncr_fixed_view_destroy. NCR_E_ARG for alphas
 * out of range. */
ncr_status ncr_brushed_view_create(const ncr_ctx *ctx, const ncr_brushed *m, ncr_fixed_view **out);

/* Fill the tables for tangents at an angle. ncr_fixed_view_render_both then gives those at it, and
 * those at its opposite. */
ncr_status ncr_brushed_view_turn(const ncr_ctx *ctx, const ncr_brushed *m,
                                 const ncr_fresnel *fresnel, double angle, ncr_fixed_view *fixed);

#endif
