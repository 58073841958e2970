/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "geometry/shapes.h"
#include "io/atomic_file_internal.h"
#include "io/patch_file.h"
#include "io/scene_parts_internal.h"

#include <stdio.h>
#include <string.h>

enum { most_slats = 4096 };
static const size_t most_bytes = (size_t)1 << 28;

/* --- the kinds ---------------------------------------------------------------------------------- */

static void append_file(const ncr_json *at, const ncr_patch_set *set, uint32_t first,
                        uint32_t count, ncr_net_list *nets)
{
    const ncr_json first_at = ncr_json_member(at, "first");
    if (first >= set->count || count > set->count - first) {
        ncr_json_fail(&first_at, "%u patches from %u on of a file that has %zu", count, first,
                      set->count);
        return;
    }
    const size_t wanted = count ? count : set->count - first;
    double(*out)[16][3] = ncr_scene_grow(at, nets, wanted);
    if (out)
        memcpy(out, set->control + first, wanted * sizeof *out);
}

static void read_patches(const ncr_json *at, ncr_scene_folder *folder, ncr_net_list *nets)
{
    const char *name = NULL;
    char path[4096];
    uint32_t first = 0, count = 0;
    uint8_t *bytes;
    size_t size;
    ncr_patch_set set;
    ncr_json_doc *doc = at->doc;
    ncr_json_string(ncr_json_member(at, "patches"), &name);
    ncr_json_count(ncr_json_member(at, "first"), 0, NCR_SCENE_NETS_MAX, &first);
    ncr_json_count(ncr_json_member(at, "count"), 1, NCR_SCENE_NETS_MAX, &count);
    if (doc->status)
        return;
    const int folder_length = name[0] == '/' ? 0 : (int)folder->path_length;
    const int n = snprintf(path, sizeof path, "%.*s%s", folder_length, folder->path, name);
    if ((size_t)n >= sizeof path) {
        ncr_json_fail(at, "the path is too long");
        return;
    }
    doc->status = ncr_file_read(doc->ctx, path, most_bytes, &bytes, &size);
    if (doc->status)
        return;
    folder->hash = ncr_fnv1a(folder->hash, bytes, size);
    doc->status = ncr_patch_text_parse(doc->ctx, path, (const char *)bytes, size, &set);
    ncr_free(doc->ctx, bytes);
    if (doc->status)
        return;
    append_file(at, &set, first, count, nets);
    ncr_patch_set_dispose(doc->ctx, &set);
}

/* One cubic of a profile: four points, or two for a straight line. */
static void read_cubic(const ncr_json *at, double out[4][2], double low)
{
    const size_t n = ncr_json_array(at, 2, 4, "points");
    if (n == 3)
        ncr_json_expected(at, "4 points of a cubic or 2 of a line");
    for (size_t i = 0; i < n; i++) {
        const ncr_json point = ncr_json_element(at, i);
        double *p = out[n == 2 ? 3 * i : i];
        if (ncr_json_array(&point, 2, 2, "numbers")) {
            ncr_json_number(ncr_json_element(&point, 0), low, INFINITY, &p[0]);
            ncr_json_number(ncr_json_element(&point, 1), -INFINITY, INFINITY, &p[1]);
        }
    }
    for (int i = 1; n == 2 && i < 3; i++)
        for (int c = 0; c < 2; c++)
            out[i][c] = (out[0][c] * (3 - i) + out[3][c] * i) / 3;
}

static void read_revolve(const ncr_json *at, ncr_net_list *nets)
{
    const size_t segments = ncr_json_array(at, 1, NCR_SCENE_NETS_MAX / 4, "cubics");
    for (size_t s = 0; s < segments; s++) {
        ncr_profile profile = {{0}};
        const ncr_json cubic = ncr_json_element(at, s);
        read_cubic(&cubic, profile, 0);
        double(*out)[16][3] = ncr_scene_grow(at, nets, 4);
        if (out)
            ncr_shape_revolve(1, (const ncr_profile *)&profile, out);
    }
}

/* A member that must be there, as `count` numbers. */
static void need_numbers(const ncr_json *at, const char *key, size_t count, double *out)
{
    const ncr_json member = ncr_json_member(at, key);
    char what[32];
    snprintf(what, sizeof what, "an array of %zu numbers", count);
    ncr_json_need(&member, what);
    ncr_json_numbers(member, count, -ncr_scene_long, ncr_scene_long, out);
}

static void need_length(const ncr_json *at, const char *key, double low, double *out)
{
    const ncr_json member = ncr_json_member(at, key);
    ncr_json_need(&member, "a length");
    ncr_json_number(member, low, ncr_scene_long, out);
}

static void read_box(const ncr_json *at, ncr_net_list *nets)
{
    static const char *const known[] = {"min", "max"};
    double min[3], max[3];
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    need_numbers(at, "min", 3, min);
    need_numbers(at, "max", 3, max);
    for (int k = 0; k < 3 && !at->doc->status; k++)
        if (!(min[k] < max[k]))
            ncr_json_fail(at, "min must be below max, but %g and %g", min[k], max[k]);
    double(*out)[16][3] = ncr_scene_grow(at, nets, 6);
    if (out)
        ncr_shape_box(min, max, out);
}

static void read_quad(const ncr_json *at, ncr_net_list *nets)
{
    static const char *const known[] = {"corner", "edge_u", "edge_v"};
    double corner[3], edge_u[3], edge_v[3];
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    need_numbers(at, "corner", 3, corner);
    need_numbers(at, "edge_u", 3, edge_u);
    need_numbers(at, "edge_v", 3, edge_v);
    double(*out)[16][3] = ncr_scene_grow(at, nets, 1);
    if (out)
        ncr_shape_quad(corner, edge_u, edge_v, out);
}

static void read_disc(const ncr_json *at, ncr_net_list *nets)
{
    static const char *const known[] = {"radius", "hole"};
    double radius = 0, hole = 0;
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    need_length(at, "radius", ncr_scene_tiny, &radius);
    ncr_json_number(ncr_json_member(at, "hole"), 0, radius * (1 - 1e-9), &hole);
    double(*out)[16][3] = ncr_scene_grow(at, nets, 4);
    if (out)
        ncr_shape_disc(radius, hole, out);
}

static bool independent(const double a[3], const double b[3])
{
    double c[3];
    d_cross(a, b, c);
    return d_length(c) > 1e-9 * d_length(a) * d_length(b);
}

static void read_beam(const ncr_json *at, ncr_net_list *nets)
{
    static const char *const known[] = {"from", "to", "up", "width", "height"};
    double from[3], to[3], along[3], up[3] = {0, 0, 1}, width = 0, height = 0;
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    need_numbers(at, "from", 3, from);
    need_numbers(at, "to", 3, to);
    ncr_json_numbers(ncr_json_member(at, "up"), 3, -1, 1, up);
    need_length(at, "width", ncr_scene_tiny, &width);
    need_length(at, "height", ncr_scene_tiny, &height);
    if (at->doc->status)
        return;
    d_sub(to, from, along);
    if (!independent(along, up))
        ncr_json_fail(at, "the beam has no length or runs along \"up\"");
    double(*out)[16][3] = ncr_scene_grow(at, nets, 6);
    if (out)
        ncr_shape_beam(from, to, up, width, height, out);
}

static void read_plank(const ncr_json *at, ncr_net_list *nets)
{
    static const char *const known[] = {"lower", "upper", "thickness"};
    double lower[4][2] = {{0}}, upper[4][2] = {{0}}, thickness = 0;
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    const ncr_json lower_at = ncr_json_member(at, "lower"), upper_at = ncr_json_member(at, "upper");
    ncr_json_need(&lower_at, "a cubic");
    ncr_json_need(&upper_at, "a cubic");
    read_cubic(&lower_at, lower, -INFINITY);
    read_cubic(&upper_at, upper, -INFINITY);
    need_length(at, "thickness", ncr_scene_tiny, &thickness);
    double(*out)[16][3] = ncr_scene_grow(at, nets, 6);
    if (out)
        ncr_shape_plank((const double(*)[2])lower, (const double(*)[2])upper, thickness, out);
}

static void read_prism(const ncr_json *at, ncr_net_list *nets)
{
    static const char *const known[] = {"sides", "radius", "bottom", "top"};
    double radius = 0, bottom = 0, top = 0;
    uint32_t sides = 0;
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    const ncr_json sides_at = ncr_json_member(at, "sides");
    ncr_json_need(&sides_at, "an even number");
    ncr_json_count(sides_at, 4, 1024, &sides);
    if (sides % 2)
        ncr_json_expected(&sides_at, "an even number");
    need_length(at, "radius", ncr_scene_tiny, &radius);
    need_length(at, "bottom", -ncr_scene_long, &bottom);
    need_length(at, "top", -ncr_scene_long, &top);
    if (!(bottom < top))
        ncr_json_fail(at, "bottom must be below top, but %g and %g", bottom, top);
    double(*out)[16][3] = ncr_scene_grow(at, nets, 2 * (size_t)sides);
    if (out)
        ncr_shape_prism(sides, radius, bottom, top, out);
}

static void read_lattice(const ncr_json *at, ncr_net_list *nets)
{
    static const char *const known[] = {"width", "height", "spacing", "slat", "thickness"};
    ncr_lattice l = {0};
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    need_length(at, "width", ncr_scene_tiny, &l.width);
    need_length(at, "height", ncr_scene_tiny, &l.height);
    need_length(at, "spacing", ncr_scene_tiny, &l.spacing);
    need_length(at, "slat", ncr_scene_tiny, &l.slat);
    need_length(at, "thickness", ncr_scene_tiny, &l.thickness);
    if (at->doc->status)
        return;
    if ((l.width + l.height) / l.spacing > most_slats) {
        ncr_json_fail(at, "spacing %g gives more than %d slats", l.spacing, most_slats);
        return;
    }
    double(*out)[16][3] = ncr_scene_grow(at, nets, ncr_shape_lattice_count(&l));
    if (out)
        ncr_shape_lattice(&l, out);
}

/* --- one shape, or several ----------------------------------------------------------------------- */

typedef void read_kind(const ncr_json *at, ncr_net_list *nets);

static void read_one(const ncr_json *at, ncr_scene_folder *folder, ncr_net_list *nets)
{
    static const char *const known[] = {"patches", "revolve", "box",   "quad",    "disc",
                                        "beam",    "plank",   "prism", "lattice", "first",
                                        "count",   "place",   "repeat"};
    enum { kinds = 9 };
    static read_kind *const readers[kinds] = {NULL,       read_revolve, read_box,
                                              read_quad,  read_disc,    read_beam,
                                              read_plank, read_prism,   read_lattice};
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    size_t kind = kinds, found = 0;
    for (size_t k = kinds; k-- > 0;)
        if (json_object_get(at->value, known[k])) {
            kind = k;
            found++;
        }
    const size_t first = nets->count;
    if (found != 1)
        ncr_json_fail(at,
                      "expected one of patches, revolve, box, quad, disc, beam, plank, prism, "
                      "lattice, found %zu of them",
                      found);
    else if (kind == 0)
        read_patches(at, folder, nets);
    else if (json_object_get(at->value, "first") || json_object_get(at->value, "count"))
        ncr_json_fail(at, "\"first\" and \"count\" belong to \"patches\"");
    else {
        const ncr_json shape = ncr_json_member(at, known[kind]);
        readers[kind](&shape, nets);
    }
    ncr_scene_read_place(at, first, nets);
}

void ncr_scene_read_shape(const ncr_json *at, ncr_scene_folder *folder, ncr_net_list *nets)
{
    if (!json_is_array(at->value)) {
        read_one(at, folder, nets);
        return;
    }
    const size_t count = ncr_json_array(at, 1, SIZE_MAX, "shapes");
    for (size_t k = 0; k < count && !at->doc->status; k++) {
        const ncr_json one = ncr_json_element(at, k);
        read_one(&one, folder, nets);
    }
}
