/* SPDX-License-Identifier: MIT */
#include "apps/report_labels.h"

static bool overlap(label_box a, label_box b)
{
    return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

static bool is_free(const label_space *space, label_box box)
{
    const label_box f = space->frame;
    if (box.x0 < f.x0 || box.y0 < f.y0 || box.x1 > f.x1 || box.y1 > f.y1)
        return false;
    for (size_t k = 0; k < space->count; k++)
        if (overlap(box, space->taken[k]))
            return false;
    return true;
}

void label_take(label_space *space, label_box box)
{
    if (space->count < space->capacity)
        space->taken[space->count++] = box;
}

bool label_place(label_space *space, float x, float y, float width, float height, label_box *out,
                 int *ring)
{
    /* Of the label's centre from the mark, in units of the gap and half the label. */
    static const float sides[8][2] = {{1, 0},  {-1, 0}, {0, -1},  {0, 1},
                                      {1, -1}, {1, 1},  {-1, -1}, {-1, 1}};
    static const float gaps[4] = {7, 18, 32, 50};
    for (*ring = 0; *ring < 4; ++*ring)
        for (int k = 0; k < 8; k++) {
            const float cx = x + sides[k][0] * (gaps[*ring] + width / 2);
            const float cy = y + sides[k][1] * (gaps[*ring] + height / 2);
            const label_box box = {cx - width / 2, cy - height / 2, cx + width / 2,
                                   cy + height / 2};
            if (is_free(space, box)) {
                label_take(space, box);
                *out = box;
                return true;
            }
        }
    return false;
}
