/* SPDX-License-Identifier: MIT */
#include "apps/report_words.h"

#include <stddef.h>
#include <string.h>

static const struct words {
    const char *experiment, *title, *note;
} words[] = {
    {"reconstruction", "Reconstruction of the surface (Table 6.1)",
     "The object's own colour, read back from the light that was captured around it. Larger cubes "
     "are closer."},
    {"mirror", "Mirror reflections (Table 6.2)",
     "The reflection alone, by every method. An environment map sees the surroundings from one "
     "place; a light field sees them from beside each texel."},
    {"epsilon", "How far above the surface the points are",
     "The same number of cubes from points at two heights."},
    {"horizon", "With and without the 65 degree rule (Figure 6.1)",
     "Without it, points near a pixel's horizon are read where they see the surface edge on."},
    {"occlusion", "With and without the occlusion test",
     "The same light through maps whose points are all in plain sight of their texels, beside maps "
     "by distance and horizon alone."},
    {"registration", "Registration: hits refined on the patch, and left on the triangles",
     "What is shaded lies on the patch once a hit is refined; the triangle's own point lies up to "
     "the chord tolerance beside it."},
    {"recursion", "Depth of recursion",
     "The ray trace with few mirror bounces against itself with five: what one level of "
     "self-reflection, which is all that a light field holds, leaves out."},
};

static const struct words *find(const char *experiment)
{
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (!strcmp(words[k].experiment, experiment))
            return &words[k];
    return NULL;
}

const char *report_words_title(const char *experiment)
{
    const struct words *w = find(experiment);
    return w ? w->title : experiment;
}

const char *report_words_note(const char *experiment)
{
    const struct words *w = find(experiment);
    return w ? w->note : "";
}
