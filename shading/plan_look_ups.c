/* SPDX-License-Identifier: MIT
 * plan_look_ups.c - every direction in which a field may be looked up, piece by piece.
 *
 * A patch is halved until the cones of its pieces are small against a tile. What holds for a piece
 * holds for each pixel in it, and so for the points that its texels name. */
#include "core/vec_internal.h"
#include "geometry/bezier_piece_internal.h"
#include "shading/plan_internal.h"

#include <stdatomic.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { candidates = 4, per_texel = 4 /* pieces along a texel at most */ };
enum { BELOW = 0, PERHAPS, ABOVE }; /* how a point stands to the horizon of a piece */

/* A point that a piece's texels name. */
typedef struct named_point {
    uint16_t point;
    bool mirrors, rebuilds; /* reflections, reconstruction may look it up */
    double low, high;       /* between the normal and the way to the point, radians */
    ncr_cone toward;        /* from the point to the piece */
} named_point;

typedef struct worker_scratch {
    uint32_t serial, *stamp; /* [points] which list they were put on last */
    uint16_t *slot;          /* [points] and where */
    named_point *named;      /* [points] */
    uint64_t *mask;          /* [cover words] */
} worker_scratch;

typedef struct look_up_job {
    const ncr_plan_scope *scope;
    const ncr_tile_cover *cover;
    const ncr_vec3 *position; /* [points] frame units */
    double chord, narrow;     /* narrow: a cone small against a tile */
    _Atomic uint64_t *words;
    worker_scratch *scratch; /* [workers] */
} look_up_job;

/* A rectangle of a patch, its texels and its bounds. */
typedef struct patch_part {
    ncr_bezier_piece piece;
    uint32_t patch, level[2]; /* the sides are 2^-level of the patch's */
    double corner[2];         /* parameters */
    ncr_piece_bound bound;
    double tilt; /* of its facets */
} patch_part;

/* How an eye may see a piece. */
typedef struct part_view {
    bool front, back;      /* which sides it may see */
    bool edge, wide;       /* perhaps a silhouette; the eye is too close to say */
    double axis[3], angle; /* directions to the eye */
} part_view;

static double angle_between(const double a[3], const double b[3])
{
    double cross[3];
    d_cross(a, b, cross);
    return atan2(d_length(cross), d_dot(a, b));
}

/* Room for facets that lean away from the normal: which side is seen, facets decide. Their corners
 * do not tell all: half as much again. */
static double tilt_of(const look_up_job *job, const patch_part *part)
{
    double high[2];
    for (int a = 0; a < 2; a++)
        high[a] = part->corner[a] + ldexp(1, -(int)part->level[a]);
    const double tilt = ncr_shell_tilt(job->scope->shell, part->patch, part->corner, high);
    return fmin(1.5 * tilt + 0.01, pi);
}

/* The eye sees rays that met a triangle: up to the chord off the surface, and as much again where
 * the ray passes the surface by. */
static part_view view_of(const look_up_job *job, const patch_part *part)
{
    const ncr_plan_scope *scope = job->scope;
    const ncr_piece_bound *b = &part->bound;
    part_view view = {
        .front = true, .back = !scope->one_sided, .edge = true, .wide = true, .angle = pi};
    if (scope->any_eye)
        return view;
    d_sub(scope->eye, b->centre, view.axis);
    const double distance = d_length(view.axis), radius = b->radius + 4 * job->chord;
    if (!(distance > radius) || !d_normalize(view.axis))
        return view;
    view.wide = false;
    view.angle = asin(radius / distance);
    const double between = angle_between(b->axis, view.axis);
    const double room = b->angle + view.angle + part->tilt;
    view.front = between - room < 0.5 * pi;
    view.back = between + room > 0.5 * pi;
    view.edge = view.front && view.back;
    view.back &= !scope->one_sided;
    return view;
}

/* --- the texels of a piece, and the points they name ----------------------------------------- */

typedef struct texel_range {
    uint32_t begin[2], end[2];
} texel_range;

static texel_range texels_of(const ncr_chart *chart, const patch_part *part)
{
    const uint32_t side[2] = {chart->width, chart->height};
    texel_range r;
    for (int a = 0; a < 2; a++) {
        r.begin[a] = (uint32_t)(part->corner[a] * side[a]);
        const double end = ceil((part->corner[a] + ldexp(1, -(int)part->level[a])) * side[a]);
        r.end[a] = end < side[a] ? (uint32_t)end : side[a];
    }
    return r;
}

static const uint16_t *texel(const ncr_sample_map *map, const ncr_chart *chart, uint32_t i,
                             uint32_t j)
{
    const size_t row = (size_t)chart->page * map->page_height + chart->y + j;
    return map->index + 4 * (row * map->page_width + chart->x + i);
}

/* How the point and the piece see each other. */
static void judge(const look_up_job *job, const patch_part *part, const part_view *view,
                  named_point *out)
{
    const ncr_piece_bound *b = &part->bound;
    double p[3];
    v_to_d(job->position[out->point], p);
    out->toward.angle = out->high = pi;
    out->low = 0;
    d_sub(b->centre, p, out->toward.axis);
    const double distance = d_length(out->toward.axis), radius = b->radius + job->chord;
    if (!(distance > radius) || !d_normalize(out->toward.axis))
        return;
    out->toward.angle = asin(radius / distance);
    const double angle = pi - angle_between(b->axis, out->toward.axis);
    const double bent = view->edge ? part->tilt : 0;
    const double room = b->angle + out->toward.angle + bent + 1e-3;
    out->low = angle - room;
    out->high = angle + room;
}

static named_point *name_point(const look_up_job *job, const patch_part *part,
                               const part_view *view, uint16_t point, worker_scratch *s,
                               size_t *count)
{
    if (s->stamp[point] != s->serial) {
        s->stamp[point] = s->serial;
        s->slot[point] = (uint16_t)*count;
        s->named[*count] = (named_point){.point = point};
        judge(job, part, view, &s->named[(*count)++]);
    }
    return &s->named[s->slot[point]];
}

/* Of several points, those that may be the one nearest to the normal; or farthest from it, which is
 * nearest when the back is seen. */
static void rebuild_from_best(unsigned count, named_point *const named[candidates], bool back)
{
    double least_high = pi, most_low = 0;
    for (unsigned j = 0; j < count; j++) {
        least_high = fmin(least_high, named[j]->high);
        most_low = fmax(most_low, named[j]->low);
    }
    for (unsigned j = 0; j < count; j++)
        named[j]->rebuilds |= back ? named[j]->high >= most_low : named[j]->low <= least_high;
}

/* Reconstruction takes points in order until one is surely above the horizon, or the best where
 * none is. Seen from the back they are all below. */
static void rebuild_from(const look_up_job *job, const part_view *view, unsigned count,
                         named_point *const named[candidates])
{
    const double horizon = job->scope->horizon;
    bool sure = false;
    for (unsigned j = 0; view->front && j < count; j++) {
        named[j]->rebuilds |= named[j]->low <= horizon;
        sure |= named[j]->high < horizon;
        if (sure && !job->scope->reads.surface_all)
            break;
    }
    if (view->front && !sure)
        rebuild_from_best(count, named, false);
    if (view->back)
        rebuild_from_best(count, named, true);
}

/* Every point that the texels of the piece name, and which terms may look it up. */
static size_t name_points(const look_up_job *job, const patch_part *part, const part_view *view,
                          worker_scratch *s)
{
    const ncr_sample_map *map = job->scope->map;
    const ncr_plan_reads *reads = &job->scope->reads;
    const ncr_chart *chart = &map->charts[part->patch];
    const texel_range r = texels_of(chart, part);
    size_t count = 0;
    s->serial++;
    for (uint32_t j = r.begin[1]; j < r.end[1]; j++)
        for (uint32_t i = r.begin[0]; i < r.end[0]; i++) {
            const uint16_t *index = texel(map, chart, i, j);
            named_point *named[candidates];
            unsigned found = 0;
            for (; found < candidates && index[found] != NCR_NO_POINT; found++) {
                named[found] = name_point(job, part, view, index[found], s, &count);
                named[found]->mirrors |= reads->mirror && (reads->mirror_all || found == 0);
            }
            if (reads->surface)
                rebuild_from(job, view, found, named);
        }
    return count;
}

/* --- cones ----------------------------------------------------------------------------------- */

/* Where mirrors look. A normal that turns by some angle turns the reflection by twice as much; a
 * pixel whose normal had to be bent toward the eye looks almost straight on, away from it. */
static void mark_mirrors(const look_up_job *job, const patch_part *part, const part_view *view,
                         uint64_t *mask)
{
    const ncr_piece_bound *b = &part->bound;
    ncr_cone cone = {.angle = pi};
    if (job->scope->any_eye) {
        memcpy(cone.axis, b->axis, sizeof cone.axis);
        if (job->scope->one_sided)
            cone.angle = 0.5 * pi + b->angle + part->tilt;
        ncr_tile_cover_mark(job->cover, &cone, mask);
        return;
    }
    if (!view->wide && b->angle < 0.5 * pi && !(view->edge && part->tilt > 1)) {
        const double k = 2 * d_dot(b->axis, view->axis);
        for (int c = 0; c < 3; c++)
            cone.axis[c] = k * b->axis[c] - view->axis[c];
        cone.angle = d_normalize(cone.axis) ? 2 * b->angle + view->angle : pi;
    }
    ncr_tile_cover_mark(job->cover, &cone, mask);
    if (view->edge && cone.angle < pi) {
        const double *v = view->axis;
        cone = (ncr_cone){.axis = {-v[0], -v[1], -v[2]}, .angle = view->angle + 1e-3};
        ncr_tile_cover_mark(job->cover, &cone, mask);
    }
}

static void add_words(const look_up_job *job, uint16_t point, const uint64_t *mask)
{
    const uint32_t words = job->cover->words;
    _Atomic uint64_t *to = job->words + (size_t)point * words;
    for (uint32_t k = 0; k < words; k++)
        if (mask[k] & ~atomic_load_explicit(&to[k], memory_order_relaxed))
            atomic_fetch_or_explicit(&to[k], mask[k], memory_order_relaxed);
}

static void mark_part(const look_up_job *job, const patch_part *part, const part_view *view,
                      size_t count, worker_scratch *s)
{
    const size_t bytes = job->cover->words * sizeof *s->mask;
    memset(s->mask, 0, bytes);
    if (job->scope->reads.mirror)
        mark_mirrors(job, part, view, s->mask);
    for (size_t k = 0; k < count; k++)
        if (s->named[k].mirrors)
            add_words(job, s->named[k].point, s->mask);
    for (size_t k = 0; k < count; k++)
        if (s->named[k].rebuilds) {
            memset(s->mask, 0, bytes);
            ncr_tile_cover_mark(job->cover, &s->named[k].toward, s->mask);
            add_words(job, s->named[k].point, s->mask);
        }
}

/* --- halving --------------------------------------------------------------------------------- */

/* Sum of the steps between neighbours of a net, along v less along u. */
static double steps(int rows, int columns, int stride, const double (*net)[3])
{
    double sum = 0, d[3];
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++) {
            const double(*at)[3] = net + j * stride + i;
            if (j + 1 < rows) {
                d_sub(at[stride], at[0], d);
                sum += d_length(d) / (columns * (rows - 1));
            }
            if (i + 1 < columns) {
                d_sub(at[1], at[0], d);
                sum -= d_length(d) / (rows * (columns - 1));
            }
        }
    return sum;
}

static bool may_halve(const look_up_job *job, const patch_part *part, int along)
{
    const ncr_chart *chart = &job->scope->map->charts[part->patch];
    const uint32_t side = along ? chart->height : chart->width;
    return ldexp(side, -(int)part->level[along]) * per_texel > 1;
}

/* Along which parameter a piece is best halved: where normals turn, or where it is long. */
static int direction(const look_up_job *job, const patch_part *part, bool normals)
{
    const ncr_bezier_piece *p = &part->piece;
    const double excess =
        normals ? steps(p->degree_v + 1, p->degree_u + 1, 6, p->n[0]) : steps(4, 4, 4, p->p[0]);
    const int along = excess > 0;
    return may_halve(job, part, along) ? along : may_halve(job, part, !along) ? !along : -1;
}

/* Whether the cones of reflections are narrow enough. */
static bool mirrors_narrow(const look_up_job *job, const patch_part *part, const part_view *view)
{
    if (!job->scope->reads.mirror)
        return true;
    if (job->scope->any_eye)
        return !job->scope->one_sided || part->bound.angle <= job->narrow;
    return 2 * part->bound.angle + view->angle <= job->narrow;
}

static void walk(const look_up_job *job, patch_part *part, worker_scratch *s);

static void halve(const look_up_job *job, const patch_part *part, int along, worker_scratch *s)
{
    ncr_bezier_piece half[2];
    ncr_bezier_piece_split(&part->piece, along, half);
    for (int k = 0; k < 2; k++) {
        patch_part next = {.piece = half[k], .patch = part->patch};
        memcpy(next.level, part->level, sizeof next.level);
        memcpy(next.corner, part->corner, sizeof next.corner);
        next.level[along]++;
        next.corner[along] += k * ldexp(1, -(int)next.level[along]);
        walk(job, &next, s);
    }
}

static void walk(const look_up_job *job, patch_part *part, worker_scratch *s)
{
    ncr_bezier_piece_bound(&part->piece, &part->bound);
    part->tilt = tilt_of(job, part);
    const part_view view = view_of(job, part);
    if (!view.front && !view.back)
        return;
    int along = -1;
    if (!mirrors_narrow(job, part, &view) && (along = direction(job, part, true)) >= 0) {
        halve(job, part, along, s);
        return;
    }
    const size_t count = name_points(job, part, &view, s);
    double widest = 0;
    for (size_t k = 0; k < count; k++)
        widest = fmax(widest, s->named[k].rebuilds ? s->named[k].toward.angle : 0);
    if (widest > 2 * job->narrow && (along = direction(job, part, false)) >= 0)
        halve(job, part, along, s);
    else
        mark_part(job, part, &view, count, s);
}

static void walk_patches(size_t begin, size_t end, unsigned worker, void *arg)
{
    const look_up_job *job = arg;
    const ncr_surface *surface = ncr_scene_object_surface(job->scope->scene, job->scope->object);
    for (size_t patch = begin; patch < end; patch++) {
        patch_part part = {.patch = (uint32_t)patch};
        ncr_bezier_piece_of(surface, part.patch, &part.piece);
        walk(job, &part, &job->scratch[worker]);
    }
}

static void free_scratch(const ncr_ctx *ctx, worker_scratch *scratch)
{
    for (unsigned w = 0; scratch && w < ncr_ctx_workers(ctx); w++) {
        ncr_free(ctx, scratch[w].stamp);
        ncr_free(ctx, scratch[w].slot);
        ncr_free(ctx, scratch[w].named);
        ncr_free(ctx, scratch[w].mask);
    }
    ncr_free(ctx, scratch);
}

static worker_scratch *make_scratch(const ncr_ctx *ctx, size_t points, uint32_t words)
{
    worker_scratch *scratch = ncr_alloc_zero(ctx, ncr_ctx_workers(ctx), sizeof *scratch);
    for (unsigned w = 0; scratch && w < ncr_ctx_workers(ctx); w++) {
        worker_scratch *s = &scratch[w];
        s->stamp = ncr_alloc_zero(ctx, points, sizeof *s->stamp);
        s->slot = ncr_alloc(ctx, points * sizeof *s->slot);
        s->named = ncr_alloc(ctx, points * sizeof *s->named);
        s->mask = ncr_alloc(ctx, words * sizeof *s->mask);
        if (!s->stamp || !s->slot || !s->named || !s->mask) {
            free_scratch(ctx, scratch);
            return NULL;
        }
    }
    return scratch;
}

ncr_status ncr_plan_look_ups(const ncr_ctx *ctx, const ncr_plan_scope *scope,
                             const ncr_tile_cover *cover, _Atomic uint64_t *words)
{
    const double tile = 0.5 * pi / ncr_tiles_across(cover->n);
    const size_t points = scope->points->count;
    ncr_vec3 *position = ncr_alloc(ctx, points * sizeof *position);
    look_up_job job = {.scope = scope,
                       .cover = cover,
                       .position = position,
                       .chord = (double)ncr_scene_object_chord(scope->scene, scope->object),
                       .narrow = fmax(0.02, fmin(0.15 * tile, 0.12)),
                       .words = words,
                       .scratch = make_scratch(ctx, points, cover->words)};
    ncr_status status = NCR_E_NOMEM;
    if (position && job.scratch) {
        ncr_points_to_frame(scope->points, ncr_scene_frame(scope->scene), position);
        status = ncr_parallel_for(ctx, scope->map->patch_count, 1, walk_patches, &job);
    }
    free_scratch(ctx, job.scratch);
    ncr_free(ctx, position);
    return status;
}
