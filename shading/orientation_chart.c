/* SPDX-License-Identifier: MIT */
#include "shading/orientation_chart.h"

#include "core/vec_internal.h"

#include <assert.h>

/* Letters of 5 x 7, rows from the top, the left pixel in bit 4. */
static const uint8_t glyphs[5][7] = {
    {0x00, 0x04, 0x04, 0x1f, 0x04, 0x04, 0x00}, /* + */
    {0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00}, /* - */
    {0x11, 0x11, 0x0a, 0x04, 0x0a, 0x11, 0x11}, /* X */
    {0x11, 0x11, 0x0a, 0x04, 0x04, 0x04, 0x04}, /* Y */
    {0x1f, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1f}, /* Z */
};

/* Whether the two letters of a name, side by side in 11 x 7 squares around the middle of the face,
 * cover (a, b): a to the right, b up, both over [-1,1]. */
static bool name_covers(int axis, bool negative, double a, double b)
{
    static const double square = 0.1;
    const double x = a / square + 5.5, y = 3.5 - b / square;
    if (x < 0 || x >= 11 || y < 0 || y >= 7)
        return false;
    const int column = (int)x, letter = column < 5 ? negative : column > 5 ? 2 + axis : -1;
    if (letter < 0)
        return false;
    const int bit = 4 - (column < 5 ? column : column - 6);
    return glyphs[letter][(int)y] >> bit & 1;
}

/* The face that a direction meets, and where on it, as an eye within sees it: to the right is
 * forward x up. */
static int meet_face(const double d[3], bool *negative, double *a, double *b)
{
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(d[k]) > fabs(d[axis]))
            axis = k;
    *negative = d[axis] < 0;
    double forward[3] = {0}, up[3] = {0}, right[3];
    forward[axis] = *negative ? -1 : 1;
    up[axis == 2 ? 1 : 2] = 1;
    d_cross(forward, up, right);
    *a = d_dot(d, right) / fabs(d[axis]);
    *b = d_dot(d, up) / fabs(d[axis]);
    return axis;
}

void ncr_orientation_chart(const double d[3], void *unused, float *rgb)
{
    static const float paint[3][3] = {
        {0.80f, 0.10f, 0.08f}, {0.10f, 0.55f, 0.12f}, {0.12f, 0.22f, 0.85f}};
    (void)unused;
    assert(d[0] != 0 || d[1] != 0 || d[2] != 0);
    bool negative;
    double a, b;
    const int axis = meet_face(d, &negative, &a, &b);
    const bool frame = fmax(fabs(a), fabs(b)) > 0.96;
    const bool bar = b > 0.8 && b < 0.9 && fabs(a) < 0.8;
    const bool white = !frame && (bar || name_covers(axis, negative, a, b));
    const bool odd = ((int)floor(4 * (a + 1)) + (int)floor(4 * (b + 1))) & 1;
    for (int c = 0; c < 3; c++) {
        const float shade = (negative ? 0.3f : 1.0f) * (odd ? 0.8f : 1.0f);
        rgb[c] = frame ? 0 : white ? 1 : shade * paint[axis][c];
    }
}
