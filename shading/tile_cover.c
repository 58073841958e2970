/* SPDX-License-Identifier: MIT */
#include "shading/tile_cover_internal.h"

#include "core/vec_internal.h"
#include "shading/cube.h"

static const double pi = 3.14159265358979323846;
static const double rounding = 1e-4; /* radians: room for what is float in a look-up */

/* A look-up reads texels up to half a texel, 1/n of a face coordinate, beside its direction. Over an
 * edge it reads the neighbour's border through the apron: a direction on this face, at 1/n from
 * the edge, is at 1/(n-1) beyond the border in the neighbour's coordinates, and as much along it.
 * Three times 1/n is more than both for n >= 2. */
static double dilation(uint32_t n)
{
    return 3.0 / n;
}

static void span(uint32_t n, uint32_t from, double out[2])
{
    const uint32_t to = from + NCR_TILE_SIDE < n ? from + NCR_TILE_SIDE : n;
    out[0] = 2.0 * from / n - 1 - dilation(n);
    out[1] = 2.0 * to / n - 1 + dilation(n);
}

static ncr_cover_tile make_tile(uint32_t n, uint32_t face, uint32_t x, uint32_t y)
{
    ncr_cover_tile tile;
    double least = 1, s[2], t[2];
    span(n, x, s);
    span(n, y, t);
    ncr_cube_to_direction_d(face, 0.5 * (s[0] + s[1]), 0.5 * (t[0] + t[1]), tile.centre);
    d_normalize(tile.centre);
    for (int k = 0; k < 4; k++) {
        ncr_cube_to_direction_d(face, s[k & 1], t[k >> 1], tile.corner[k]);
        d_normalize(tile.corner[k]);
        least = fmin(least, d_dot(tile.corner[k], tile.centre));
    }
    tile.cosine = least;
    tile.sine = sqrt(1 - least * least);
    return tile;
}

ncr_status ncr_tile_cover_init(const ncr_ctx *ctx, uint32_t n, ncr_tile_cover *out)
{
    const uint32_t across = ncr_tiles_across(n), count = 6 * across * across;
    *out = (ncr_tile_cover){.n = n, .count = count, .words = (count + 63) / 64};
    out->tiles = ncr_alloc(ctx, count * sizeof *out->tiles);
    if (!out->tiles)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < count; k++)
        out->tiles[k] = make_tile(n, k / (across * across), k % across * NCR_TILE_SIDE,
                                  k / across % across * NCR_TILE_SIDE);
    return NCR_OK;
}

void ncr_tile_cover_dispose(const ncr_ctx *ctx, ncr_tile_cover *cover)
{
    ncr_free(ctx, cover->tiles);
    *cover = (ncr_tile_cover){0};
}

static void set(uint64_t *bits, uint32_t k)
{
    bits[k / 64] |= (uint64_t)1 << k % 64;
}

static void mark_all(const ncr_tile_cover *cover, uint64_t *bits)
{
    for (uint32_t k = 0; k < cover->count; k++)
        set(bits, k);
}

/* What a cone of a right angle or more leaves out is a cone about the other axis, and convex: a
 * tile is out when its corners are. */
static void mark_wide(const ncr_tile_cover *cover, const double axis[3], double angle,
                      uint64_t *bits)
{
    const double out = cos(angle); /* d is outside when d.axis < cos(angle) <= 0 */
    for (uint32_t k = 0; k < cover->count; k++) {
        const ncr_cover_tile *tile = &cover->tiles[k];
        bool touched = false;
        for (int c = 0; c < 4; c++)
            touched |= !(d_dot(tile->corner[c], axis) < out);
        if (touched)
            set(bits, k);
    }
}

/* Range of one face coordinate over a cone: tan(middle - half) to tan(middle + half), between the
 * two planes through the other axis of the face that touch it, where
 *
 *     middle = atan2(a, b),  half = asin(sine / |(a,b)|) <= pi/2
 *
 * with a the axis' component along the coordinate, b along the face's middle. What lies beyond a
 * right angle on the side of a is at infinity there; the rest is behind. */
static void face_range(double a, double b, double sine, double out[2])
{
    const double square = a * a + b * b - sine * sine; /* (|(a,b)| cos half)^2 */
    out[0] = -INFINITY;
    out[1] = INFINITY;
    if (!(square > 0))
        return;
    const double cosine = sqrt(square);
    const double before = b * cosine + a * sine, after = b * cosine - a * sine;
    out[0] = before > 0 ? (a * cosine - b * sine) / before : a > 0 ? INFINITY : -INFINITY;
    out[1] = after > 0 ? (a * cosine + b * sine) / after : a < 0 ? -INFINITY : INFINITY;
}

/* Columns (or rows) of tiles that a range of a face coordinate may meet: [begin, end). */
static void tile_range(uint32_t n, const double range[2], uint32_t out[2])
{
    const double across = ncr_tiles_across(n), per_unit = 0.5 * n / NCR_TILE_SIDE;
    const double from = floor((range[0] - dilation(n) + 1) * per_unit);
    const double to = floor((range[1] + dilation(n) + 1) * per_unit) + 1;
    out[0] = from > 0 ? (uint32_t)fmin(from, across) : 0;
    out[1] = to > 0 ? (uint32_t)fmin(to, across) : 0;
}

/* The cone's box on each face that it may meet; of the tiles in it, those whose own cone it meets. */
static void mark_narrow(const ncr_tile_cover *cover, const double axis[3], double angle,
                        uint64_t *bits)
{
    const uint32_t across = ncr_tiles_across(cover->n);
    const double cosine = cos(angle), sine = sin(angle);
    for (uint32_t face = 0; face < 6; face++) {
        double middle[3], right[3], down[3], s[2], t[2];
        uint32_t x[2], y[2];
        ncr_cube_to_direction_d(face, 0, 0, middle);
        ncr_cube_to_direction_d(face, 1, 0, right);
        ncr_cube_to_direction_d(face, 0, 1, down);
        d_sub(right, middle, right);
        d_sub(down, middle, down);
        const double ahead = d_dot(axis, middle);
        face_range(d_dot(axis, right), ahead, sine, s);
        face_range(d_dot(axis, down), ahead, sine, t);
        tile_range(cover->n, s, x);
        tile_range(cover->n, t, y);
        for (uint32_t row = y[0]; row < y[1]; row++)
            for (uint32_t column = x[0]; column < x[1]; column++) {
                const uint32_t k = (face * across + row) * across + column;
                const ncr_cover_tile *tile = &cover->tiles[k];
                if (d_dot(axis, tile->centre) >= cosine * tile->cosine - sine * tile->sine)
                    set(bits, k);
            }
    }
}

void ncr_tile_cover_mark(const ncr_tile_cover *cover, const ncr_cone *cone, uint64_t *bits)
{
    const double angle = cone->angle + rounding;
    if (cover->n < 2 || !(angle < pi))
        mark_all(cover, bits);
    else if (angle >= 0.5 * pi)
        mark_wide(cover, cone->axis, angle, bits);
    else
        mark_narrow(cover, cone->axis, angle, bits);
}
