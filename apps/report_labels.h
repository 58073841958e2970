/* SPDX-License-Identifier: MIT
 * report_labels.h - where names go beside marks so that neither hides the other. */
#ifndef NCR_APPS_REPORT_LABELS_H
#define NCR_APPS_REPORT_LABELS_H

#include <stdbool.h>
#include <stddef.h>

typedef struct label_box {
    float x0, y0, x1, y1;
} label_box;

/** Boxes that are taken, inside a frame. */
typedef struct label_space {
    label_box frame;
    label_box *taken; /* [capacity] */
    size_t count, capacity;
} label_space;

/** Take a box without asking; ignored when there is no capacity left. */
void label_take(label_space *space, label_box box);

/** Find and take room for a label of this size near (x, y): to the right, then left, above, below,
 *  the corners, then further out. False when nothing is free; `ring` counts how far out it is, 0
 *  being next to the mark. */
bool label_place(label_space *space, float x, float y, float width, float height, label_box *out,
                 int *ring);

#endif
