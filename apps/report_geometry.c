/* SPDX-License-Identifier: MIT
 * report_geometry.c - the geometry of reflection among sample points, as a drawing. [T fig 4.4] */
#include "apps/report_page.h"

static const char drawing[] =
    "<svg class=\"plot geometry\" viewBox=\"0 0 640 300\" role=\"img\" aria-label=\"a surface "
    "point x with its normal n, the eye's direction v, the mirror direction r and four sample "
    "points above the surface\">\n"
    "<path class=\"body\" d=\"M20 290Q320 130 620 290Z\"/>"
    "<path class=\"offset\" d=\"M52 240Q320 86 588 240\"/>\n"
    "<path class=\"arrow\" d=\"M320 210V40\"/><path class=\"arrow\" d=\"M320 210L210 60\"/>"
    "<path class=\"arrow strong\" d=\"M320 210L430 60\"/>\n"
    "<path class=\"tip\" d=\"M320 34L315 46H325ZM207 56L220 66L213 72ZM433 56L427 72L420 66Z\"/>"
    "<path class=\"ray\" d=\"M320 210L176 184\"/><path class=\"ray\" d=\"M320 210L262 167\"/>"
    "<path class=\"ray\" d=\"M320 210L362 165\"/><path class=\"ray\" d=\"M320 210L452 180\"/>\n"
    "<g class=\"c1\"><circle class=\"point\" cx=\"176\" cy=\"184\" r=\"5\"/>"
    "<circle class=\"point\" cx=\"262\" cy=\"167\" r=\"5\"/>"
    "<circle class=\"point\" cx=\"362\" cy=\"165\" r=\"5\"/>"
    "<circle class=\"point\" cx=\"452\" cy=\"180\" r=\"5\"/></g>"
    "<circle class=\"spot\" cx=\"320\" cy=\"210\" r=\"4\"/>\n"
    "<text x=\"316\" y=\"232\">x</text><text x=\"328\" y=\"50\">n</text>"
    "<text x=\"192\" y=\"58\">v</text><text x=\"440\" y=\"60\">r = 2n(n\xc2\xb7v) \xe2\x88\x92 "
    "v</text><text x=\"462\" y=\"174\">sample point p</text>"
    "<text x=\"396\" y=\"212\">s = p \xe2\x88\x92 x</text>"
    "<text class=\"tick\" x=\"60\" y=\"226\" text-anchor=\"end\">offset \xce\xb5</text>\n"
    "</svg>\n";

void report_page_geometry(report_page *page, report_section section)
{
    text *t = &page->sections[section];
    text_put(t, "<figure class=\"drawing\">");
    text_put(t, drawing);
    text_put(t,
             "<figcaption>A pixel shows x. Each texel names four sample points; the closest, the "
             "one best aligned with r, or a blend of them by the cosines r\xc2\xb7s or "
             "n\xc2\xb7s is looked up along r. Reconstruction looks up along \xe2\x88\x92s "
             "instead, at the first point within 65\xc2\xb0 of n.</figcaption></figure>\n");
}
