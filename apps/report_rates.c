/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [H]  W. Heidrich. Environment Maps And Their Applications, figure 4. 2000
 */
#include "apps/report_rates.h"

#include "shading/map_kind.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/* From `middle` towards `side`, both unit and across each other, in the map's own axes. */
typedef struct curve {
    const char *name;
    ncr_map_kind kind;
    double middle[3], side[3];
} curve;

#define R2 0.70710678118654752440

static const curve curves[] = {
    {"paraboloid", NCR_MAP_PARABOLOID, {0, 0, 1}, {1, 0, 0}},
    {"cube, across an edge", NCR_MAP_CUBE, {0, 0, 1}, {1, 0, 0}},
    {"cube, across a corner", NCR_MAP_CUBE, {0, 0, 1}, {R2, R2, 0}},
    {"sphere", NCR_MAP_SPHERE, {0, 0, 1}, {1, 0, 0}},
    {"lat-long, to a pole", NCR_MAP_LATLONG, {-1, 0, 0}, {0, 0, 1}},
    {"octahedral, to a vertex", NCR_MAP_OCTAHEDRAL, {0, 0, 1}, {1, 0, 0}},
    {"octahedral, to an edge", NCR_MAP_OCTAHEDRAL, {0, 0, 1}, {R2, R2, 0}},
};
enum { curve_count = sizeof curves / sizeof curves[0] };

static double density(const curve *c, double degrees)
{
    const double a = degrees * pi / 180;
    double d[3];
    for (int k = 0; k < 3; k++)
        d[k] = cos(a) * c->middle[k] + sin(a) * c->side[k];
    return ncr_map_density(c->kind, ncr_map_from_direction(c->kind, d));
}

/* SVG units. */
enum { left = 58, right = 600, top = 14, bottom = 340 };

static double at_x(double degrees)
{
    return left + (right - left) * degrees / 90;
}

/* Logarithmic, from an eighth to eight. Below lies only the very pole of lat-long. */
static double at_y(double relative)
{
    const double t = (log2(fmax(relative, 0.125)) + 3) / 6;
    return bottom - (bottom - top) * t;
}

static double relative(const curve *c, double degrees)
{
    return density(c, degrees) / density(c, 0);
}

static void put_axes(text *out)
{
    for (int k = 0; k <= 6; k++)
        text_printf(out,
                    "<path class=\"grid\" d=\"M%.1f %dV%d\"/><text class=\"tick\" x=\"%.1f\" "
                    "y=\"%d\" text-anchor=\"middle\">%d\xc2\xb0</text>\n",
                    at_x(15 * k), top, bottom, at_x(15 * k), bottom + 16, 15 * k);
    for (int k = -3; k <= 3; k++)
        text_printf(out,
                    "<path class=\"grid\" d=\"M%d %.1fH%d\"/><text class=\"tick\" x=\"%d\" "
                    "y=\"%.1f\" text-anchor=\"end\">%s%d</text>\n",
                    left, at_y(exp2(k)), right, left - 6, at_y(exp2(k)) + 4, k < 0 ? "1/" : "",
                    1 << abs(k));
    text_printf(out,
                "<text class=\"name\" x=\"%d\" y=\"%d\" text-anchor=\"middle\">angle from the "
                "middle of the map</text>\n",
                (left + right) / 2, bottom + 36);
}

static void put_curve(int k, text *out)
{
    text_printf(out,
                "<path class=\"c%d\" fill=\"none\" stroke=\"var(--c)\" stroke-width=\"2\" d=\"", k);
    for (int half = 0; half <= 180; half++)
        text_printf(out, "%c%.1f %.1f", half ? 'L' : 'M', at_x(0.5 * half),
                    at_y(relative(&curves[k], 0.5 * half)));
    text_put(out, "\"><title>");
    text_escaped(out, curves[k].name);
    text_put(out, "</title></path>\n");
}

ncr_status report_plot_rates(text *out)
{
    text_printf(out,
                "<svg class=\"plot\" viewBox=\"0 0 620 %d\" role=\"img\" aria-label=\"solid angle "
                "of a texel against the angle from the middle\">\n",
                bottom + 46);
    put_axes(out);
    for (int k = 0; k < curve_count; k++)
        put_curve(k, out);
    text_put(out, "</svg>\n<p class=\"legend\">");
    for (int k = 0; k < curve_count; k++) {
        text_printf(out, "<span><i class=\"dot c%d\"></i>", k);
        text_escaped(out, curves[k].name);
        text_put(out, "</span> ");
    }
    text_put(out, "</p>\n");
    return text_status(out);
}

void report_csv_rates(text *out)
{
    text_put(out, "degrees");
    for (int k = 0; k < curve_count; k++)
        text_printf(out, ",\"%s\"", curves[k].name);
    for (int degrees = 0; degrees <= 90; degrees++) {
        text_printf(out, "\n%d", degrees);
        for (int k = 0; k < curve_count; k++)
            text_printf(out, ",%.6g", relative(&curves[k], degrees));
    }
    text_put(out, "\n");
}
