/* SPDX-License-Identifier: MIT */
#include "geometry/shapes.h"
#include "io/scene_parts_internal.h"

#include <math.h>
#include <string.h>

enum { most_copies = 4096 };

double (*ncr_scene_grow(const ncr_json *at, ncr_net_list *nets, size_t extra))[16][3]
{
    const ncr_ctx *ctx = at->doc->ctx;
    if (at->doc->status)
        return NULL;
    if (extra > NCR_SCENE_NETS_MAX - nets->count) {
        ncr_json_fail(at, "more than %d patches in one object", NCR_SCENE_NETS_MAX);
        return NULL;
    }
    if (nets->count + extra > nets->room) {
        const size_t room = 2 * (nets->count + extra);
        void *bigger = ncr_alloc(ctx, room * sizeof *nets->at);
        if (!bigger) {
            at->doc->status = NCR_E_NOMEM;
            return NULL;
        }
        if (nets->count)
            memcpy(bigger, nets->at, nets->count * sizeof *nets->at);
        ncr_free(ctx, nets->at);
        nets->at = bigger;
        nets->room = room;
    }
    nets->count += extra;
    return nets->at + (nets->count - extra);
}

static const double degree = 0.017453292519943295;

/* Rotation about one axis as a 3x4 map; quarter turns are exact. */
static void rotation(int axis, double degrees, double map[12])
{
    const double quarters = degrees / 90;
    double s = sin(degrees * degree), c = cos(degrees * degree);
    if (quarters == floor(quarters)) {
        s = round(s);
        c = round(c);
    }
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    memset(map, 0, 12 * sizeof *map);
    map[5 * axis] = 1;
    map[5 * a] = map[5 * b] = c;
    map[4 * b + a] = s;
    map[4 * a + b] = -s;
}

static void move(ncr_net_list *nets, size_t first, const double map[12])
{
    ncr_shape_move(map, nets->count - first, nets->at + first);
}

static void read_scale(ncr_json at, double scale[3])
{
    if (json_is_array(at.value))
        ncr_json_numbers(at, 3, -ncr_scene_long, ncr_scene_long, scale);
    else
        ncr_json_number(at, ncr_scene_tiny, ncr_scene_long, scale);
    if (!json_is_array(at.value))
        scale[1] = scale[2] = scale[0];
    for (int k = 0; k < 3; k++)
        if (scale[k] == 0)
            ncr_json_expected(&at, "a scale without zeros");
}

static void place(const ncr_json *at, size_t first, ncr_net_list *nets)
{
    static const char *const known[] = {"translate", "rotate_deg", "scale"};
    double translate[3] = {0}, rotate[3] = {0}, scale[3] = {1, 1, 1};
    if (!ncr_json_present(at) || !ncr_json_only(at, NCR_WORDS(known)))
        return;
    ncr_json_numbers(ncr_json_member(at, "translate"), 3, -ncr_scene_long, ncr_scene_long,
                     translate);
    ncr_json_numbers(ncr_json_member(at, "rotate_deg"), 3, -360, 360, rotate);
    read_scale(ncr_json_member(at, "scale"), scale);
    if (at->doc->status)
        return;
    const double scaling[12] = {scale[0], 0, 0, 0, 0, scale[1], 0, 0, 0, 0, scale[2], 0};
    const double shift[12] = {1, 0, 0, translate[0], 0, 1, 0, translate[1], 0, 0, 1, translate[2]};
    move(nets, first, scaling);
    for (int axis = 0; axis < 3; axis++)
        if (rotate[axis] != 0) {
            double turn[12];
            rotation(axis, rotate[axis], turn);
            move(nets, first, turn);
        }
    move(nets, first, shift);
}

/* Copy k of a repetition is turned k times the angle, then moved k times the step. */
static void repeat(const ncr_json *at, size_t first, ncr_net_list *nets)
{
    static const char *const known[] = {"count", "about", "angle_deg", "step"};
    static const char *const axes[] = {"x", "y", "z"};
    uint32_t copies = 0;
    size_t axis = 2;
    double angle = 0, step[3] = {0};
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    const ncr_json count_at = ncr_json_member(at, "count");
    ncr_json_need(&count_at, "the number of copies");
    ncr_json_count(count_at, 1, most_copies, &copies);
    ncr_json_word(ncr_json_member(at, "about"), NCR_WORDS(axes), &axis);
    ncr_json_number(ncr_json_member(at, "angle_deg"), -360, 360, &angle);
    ncr_json_numbers(ncr_json_member(at, "step"), 3, -ncr_scene_long, ncr_scene_long, step);
    if (at->doc->status)
        return;
    const size_t one = nets->count - first;
    for (uint32_t k = 1; k < copies && ncr_scene_grow(at, nets, one); k++) {
        const size_t start = first + k * one;
        double turn[12];
        rotation((int)axis, k * angle, turn);
        for (int c = 0; c < 3; c++)
            turn[4 * c + 3] = k * step[c];
        memcpy(nets->at + start, nets->at + first, one * sizeof *nets->at);
        move(nets, start, turn);
    }
}

void ncr_scene_read_place(const ncr_json *at, size_t first, ncr_net_list *nets)
{
    const ncr_json place_at = ncr_json_member(at, "place");
    const ncr_json repeat_at = ncr_json_member(at, "repeat");
    place(&place_at, first, nets);
    if (!ncr_json_present(&repeat_at))
        return;
    if (!json_is_array(repeat_at.value)) {
        repeat(&repeat_at, first, nets);
        return;
    }
    const size_t count = ncr_json_array(&repeat_at, 1, 8, "repetitions");
    for (size_t k = 0; k < count; k++) {
        const ncr_json one = ncr_json_element(&repeat_at, k);
        repeat(&one, first, nets);
    }
}
