/* SPDX-License-Identifier: MIT
 * Truths about directional maps: look-up, filling, conversion, levels. */
#include "files.h"

#include "core/numerics.h"
#include "shading/directional_map.h"

static const double pi = 3.14159265358979323846;
static const ncr_ctx quiet = {.struct_size = sizeof(ncr_ctx), .report = files_keep_report};

static ncr_directional_map make_map(ncr_map_kind kind, uint32_t size)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(&quiet, kind, size, 3, &map));
    return map;
}

static ncr_directional_map random_map(ncr_map_kind kind, uint32_t size, uint64_t seed)
{
    ncr_directional_map map = make_map(kind, size);
    check_random r = {.seed = seed};
    for (size_t k = 0; k < (size_t)map.image.width * map.image.height * 3; k++)
        map.image.data[k] = (float)check_uniform(&r, 0, 1);
    ncr_directional_map_seal(&map);
    return map;
}

static void random_direction(check_random *r, double d[3])
{
    const double z = check_uniform(r, -1, 1), phi = check_uniform(r, -pi, pi);
    d[0] = sqrt(1 - z * z) * cos(phi);
    d[1] = sqrt(1 - z * z) * sin(phi);
    d[2] = z;
}

static void constant(const double d[3], void *user, float *out)
{
    (void)d;
    memcpy(out, user, 3 * sizeof(float));
}

/* Smooth, of known integral: 1 + z, (1 + x)^2, 2 + x y. */
static void smooth(const double d[3], void *user, float *out)
{
    (void)user;
    out[0] = (float)(1 + d[2]);
    out[1] = (float)((1 + d[0]) * (1 + d[0]));
    out[2] = (float)(2 + d[0] * d[1]);
}

static const double smooth_integral[3] = {
    4 * 3.14159265358979323846, (4 + 4.0 / 3) * 3.14159265358979323846, 8 * 3.14159265358979323846};

static const uint32_t sizes[] = {1, 2, 3, 4, 7, 16, 33};
enum { size_count = sizeof sizes / sizeof sizes[0] };

static void a_constant_is_seen_bit_by_bit_from_everywhere(void **state)
{
    (void)state;
    float c[3] = {0.1f, 3.7e4f, 1.3e-20f}, got[3];
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (int k = 0; k < size_count; k++) {
            ncr_directional_map map = make_map((ncr_map_kind)kind, sizes[k]);
            CHECK_STATUS(NCR_OK, ncr_directional_map_fill(&quiet, &map, 0.1, constant, c));
            check_random r = {.seed = 21};
            for (int i = 0; i < 2000; i++) {
                double d[3];
                random_direction(&r, d);
                if (i < 27 && i != 13)
                    for (int j = 0; j < 3; j++)
                        d[j] = (int[]){i % 3, i / 3 % 3, i / 9}[j] - 1;
                ncr_directional_map_look_up(&map, d, got);
                CHECK(!memcmp(c, got, sizeof c), "%s of %u at (%g %g %g): %.9g %.9g %.9g",
                      ncr_map_kind_name(map.kind), map.size, d[0], d[1], d[2], (double)got[0],
                      (double)got[1], (double)got[2]);
            }
            ncr_directional_map_dispose(&quiet, &map);
        }
    }
}

/* Texel values in [0,1] n texels apart cannot change faster than the stretch allows; a seam would
 * jump by a good part of 1 whatever the step. */
static void no_look_up_jumps(void **state)
{
    (void)state;
    static const double step = 1e-6;
    double worst[NCR_MAP_KINDS] = {0};
    check_random r = {.seed = 22};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map map = random_map((ncr_map_kind)kind, 16, 5);
        for (int i = 0; i < 300000; i++) {
            double d[3], e[3];
            float a[3], b[3];
            random_direction(&r, d);
            const int where = i % 6; /* on planes where seams lie, and about the poles */
            if (where < 3)
                d[where] = 0.3 * step * (i / 6 % 3 - 1);
            else if (where == 3)
                d[i / 6 % 3] = copysign(d[(i / 6 + 1) % 3], d[i / 6 % 3]);
            else if (where == 4)
                d[0] *= 3 * step, d[1] *= 3 * step, d[2] = copysign(1, d[2]);
            const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            for (int k = 0; k < 3; k++)
                e[k] = d[k] / length + check_uniform(&r, -step, step);
            ncr_directional_map_look_up(&map, d, a);
            ncr_directional_map_look_up(&map, e, b);
            for (int c = 0; c < 3; c++)
                worst[kind] = fmax(worst[kind], fabs((double)a[c] - (double)b[c]));
        }
        print_message("%s: %.2g\n", ncr_map_kind_name(map.kind), worst[kind]);
        ncr_directional_map_dispose(&quiet, &map);
    }
    /* 16 texels, slopes of at most 8 texels per unit of s times 1/least stretch: about 50 a radian
       where nothing is singular. The sphere's rim and lat-long's poles are steep by nature. */
    CHECK_NEAR(worst[NCR_MAP_CUBE], 0, 1e-4);
    CHECK_NEAR(worst[NCR_MAP_OCTAHEDRAL], 0, 1e-4);
    CHECK_NEAR(worst[NCR_MAP_LATLONG], 0, 1e-4);
    CHECK_NEAR(worst[NCR_MAP_SPHERE], 0, 1e-4);
    CHECK_NEAR(worst[NCR_MAP_PARABOLOID], 0, 1e-4);
}

/* x/|major| is linear on a face, so bilinear look-up is exact where all four texels lie on it. */
static void a_linear_function_is_exact_within_a_face(void **state)
{
    (void)state;
    const uint32_t n = 32;
    ncr_directional_map map = make_map(NCR_MAP_CUBE, n);
    for (uint32_t f = 0; f < 6; f++)
        for (uint32_t y = 0; y < n; y++)
            for (uint32_t x = 0; x < n; x++) {
                float *texel = ncr_directional_map_at(&map, f, x, y);
                texel[0] = (float)((2 * x + 1.0) / n - 1);
                texel[1] = (float)((2 * y + 1.0) / n - 1);
            }
    ncr_directional_map_seal(&map);
    check_random r = {.seed = 23};
    for (int k = 0; k < 10000; k++) {
        double d[3];
        float got[3];
        random_direction(&r, d);
        const ncr_map_coord at = ncr_map_from_direction(NCR_MAP_CUBE, d);
        if (fmax(fabs(at.s), fabs(at.t)) > 1 - 1.0 / n)
            continue;
        ncr_directional_map_look_up(&map, d, got);
        CHECK_NEAR((double)got[0], at.s, 2e-7);
        CHECK_NEAR((double)got[1], at.t, 2e-7);
    }
    ncr_directional_map_dispose(&quiet, &map);
}

static void a_cube_corner_is_the_mean_of_three_texels(void **state)
{
    (void)state;
    ncr_directional_map map = random_map(NCR_MAP_CUBE, 8, 6);
    for (int k = 0; k < 8; k++) {
        const double d[3] = {k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1};
        double mean = 0;
        float got[3];
        for (uint32_t f = 0; f < 6; f++) {
            if (d[f / 2] != (f % 2 ? -1 : 1))
                continue;
            double near[3] = {0.99 * d[0], 0.99 * d[1], 0.99 * d[2]};
            near[f / 2] = d[f / 2];
            const ncr_map_coord at = ncr_map_from_direction(NCR_MAP_CUBE, near);
            assert_int_equal(at.part, f);
            mean +=
                (double)*ncr_directional_map_at(&map, f, at.s > 0 ? 7 : 0, at.t > 0 ? 7 : 0) / 3;
        }
        ncr_directional_map_look_up(&map, d, got);
        CHECK_NEAR((double)got[0], mean, 1e-7);
    }
    ncr_directional_map_dispose(&quiet, &map);
}

/* A sampler that knows only one bordered part sees what the seamless look-up sees. */
static void a_border_replaces_the_neighbours(void **state)
{
    (void)state;
    const uint32_t n = 16, b = 2;
    check_random r = {.seed = 24};
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map map = random_map((ncr_map_kind)kind, n, 7);
        const double w = ncr_map_part_width(map.kind, n);
        for (uint32_t part = 0; part < ncr_map_part_count(map.kind); part++) {
            ncr_image image;
            CHECK_STATUS(NCR_OK, ncr_directional_map_bordered(&quiet, &map, part, b, &image));
            for (int k = 0; k < 3000; k++) {
                const ncr_map_coord at = {part, check_uniform(&r, -1, 1), check_uniform(&r, -1, 1)};
                double d[3];
                float want[3];
                if (!ncr_map_to_direction(map.kind, at, d) ||
                    (kind == NCR_MAP_PARABOLOID && hypot(at.s, at.t) > 1 - 4.0 / n) ||
                    (kind == NCR_MAP_SPHERE && d[2] < -0.95))
                    continue; /* where two parts, or the rim, are mixed in on top */
                ncr_directional_map_look_up(&map, d, want);
                const double x = 0.5 * (at.s + 1) * w - 0.5 + b, y = 0.5 * (at.t + 1) * n - 0.5 + b;
                const uint32_t ix = (uint32_t)x, iy = (uint32_t)y;
                const double fx = x - ix, fy = y - iy;
                for (int c = 0; c < 3; c++) {
                    const double top = (1 - fx) * (double)ncr_image_at(&image, ix, iy)[c] +
                                       fx * (double)ncr_image_at(&image, ix + 1, iy)[c];
                    const double low = (1 - fx) * (double)ncr_image_at(&image, ix, iy + 1)[c] +
                                       fx * (double)ncr_image_at(&image, ix + 1, iy + 1)[c];
                    CHECK_NEAR((double)want[c], (1 - fy) * top + fy * low, 1e-6);
                }
            }
            ncr_image_dispose(&quiet, &image);
        }
        ncr_directional_map_dispose(&quiet, &map);
    }
}

static void height(const double d[3], void *user, float *out)
{
    (void)user;
    out[0] = out[1] = out[2] = (float)d[2];
}

/* z is odd across the rim: the half that comes in must be asked where the direction lies on it, not
 * at the mirrored place. */
static void the_halves_of_the_paraboloid_show_the_same_near_their_rim(void **state)
{
    (void)state;
    ncr_directional_map map = make_map(NCR_MAP_PARABOLOID, 64);
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(&quiet, &map, 0.01, height, NULL));
    check_random r = {.seed = 29};
    for (int k = 0; k < 5000; k++) {
        double d[3];
        float got[3];
        random_direction(&r, d);
        d[2] *= 0.1;
        const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        ncr_directional_map_look_up(&map, d, got);
        CHECK_NEAR((double)got[0], d[2] / length, 0.01); /* texels cut by the rim: a third of one */
    }
    ncr_directional_map_dispose(&quiet, &map);
}

static void a_filled_map_has_the_integral_of_its_function(void **state)
{
    (void)state;
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map map = make_map((ncr_map_kind)kind, 32);
        CHECK_STATUS(NCR_OK, ncr_directional_map_fill(&quiet, &map, 0.02, smooth, NULL));
        double got[3];
        ncr_directional_map_integral(&map, got);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(got[c] / smooth_integral[c], 1, 2e-4);
        ncr_directional_map_dispose(&quiet, &map);
    }
}

/* The largest error of a conversion of the smooth function, over directions that every kind samples
 * well, and of its integral. */
static void convert_smooth(const ncr_directional_map *in, ncr_map_kind to, uint32_t size,
                           double *error, double *energy)
{
    ncr_directional_map out = make_map(to, size);
    CHECK_STATUS(NCR_OK, ncr_directional_map_convert(&quiet, in, &out));
    check_random r = {.seed = 25};
    for (int k = 0; k < 500; k++) {
        double d[3];
        float a[3], b[3];
        random_direction(&r, d);
        if (d[2] < -0.5 && (in->kind == NCR_MAP_SPHERE || to == NCR_MAP_SPHERE))
            continue;
        ncr_directional_map_look_up(&out, d, a);
        smooth(d, NULL, b);
        for (int c = 0; c < 3; c++)
            *error = fmax(*error, fabs((double)a[c] - (double)b[c]));
    }
    double got[3];
    ncr_directional_map_integral(&out, got);
    for (int c = 0; c < 3; c++)
        *energy = fmax(*energy, fabs(got[c] / smooth_integral[c] - 1));
    ncr_directional_map_dispose(&quiet, &out);
}

static void conversion_keeps_a_smooth_function_and_its_energy(void **state)
{
    (void)state;
    double coarse = 0, fine = 0, energy = 0;
    for (int from = 0; from < NCR_MAP_KINDS; from++) {
        ncr_directional_map in = make_map((ncr_map_kind)from, 48);
        CHECK_STATUS(NCR_OK, ncr_directional_map_fill(&quiet, &in, 0.02, smooth, NULL));
        for (int to = 0; to < NCR_MAP_KINDS; to++) {
            convert_smooth(&in, (ncr_map_kind)to, 20, &coarse, &energy);
            convert_smooth(&in, (ncr_map_kind)to, 64, &fine, &energy);
        }
        ncr_directional_map_dispose(&quiet, &in);
    }
    print_message("largest error %.3g at 20 and %.3g at 64 of 4, of the energy %.3g\n", coarse,
                  fine, energy);
    CHECK_NEAR(coarse, 0, 0.2); /* bilinear look-up in 20 texels over the octahedron's ridges */
    CHECK_NEAR(fine, 0, 0.05);
    CHECK_NEAR(energy, 0, 1e-3);
}

/* One texel at d much brighter than the rest, as the sun is, converted: energy after / before. */
static double convert_sun(ncr_map_kind from, ncr_map_kind to, const double d[3])
{
    double before[3], after[3];
    ncr_directional_map in = make_map(from, 40), out = make_map(to, 32);
    const ncr_map_coord at = ncr_map_from_direction(from, d);
    const double w = ncr_map_part_width(from, 40);
    *ncr_directional_map_at(&in, at.part, (uint32_t)(0.5 * (at.s + 1) * w),
                            (uint32_t)(0.5 * (at.t + 1) * 40)) = 1e5f;
    ncr_directional_map_seal(&in);
    CHECK_STATUS(NCR_OK, ncr_directional_map_convert(&quiet, &in, &out));
    ncr_directional_map_integral(&in, before);
    ncr_directional_map_integral(&out, after);
    ncr_directional_map_dispose(&quiet, &in);
    ncr_directional_map_dispose(&quiet, &out);
    return after[0] / before[0];
}

static void a_sun_keeps_its_energy(void **state)
{
    (void)state;
    enum { suns = 8 };
    for (int k = 0; k < NCR_MAP_KINDS * NCR_MAP_KINDS; k++) {
        const ncr_map_kind from = (ncr_map_kind)(k / NCR_MAP_KINDS),
                           to = (ncr_map_kind)(k % NCR_MAP_KINDS);
        check_random r = {.seed = 26};
        double sum = 0, worst = 0;
        for (int i = 0; i < suns; i++) {
            double d[3];
            random_direction(&r, d);
            d[2] *= 0.8;
            const double kept = convert_sun(from, to, d);
            sum += kept / suns;
            worst = fmax(worst, fabs(kept - 1));
        }
        print_message("%-10s to %-10s one sun %4.2f %%, all %5.2f %%\n", ncr_map_kind_name(from),
                      ncr_map_kind_name(to), 100 * worst, 100 * (sum - 1));
        CHECK_NEAR(worst, 0, from == NCR_MAP_SPHERE ? 0.05 : 0.025);
        CHECK_NEAR(sum, 1, 0.005);
    }
}

static ncr_axes axes_number(int k)
{
    static const int8_t orders[6][3] = {{1, 2, 3}, {2, 3, 1}, {3, 1, 2},
                                        {1, 3, 2}, {3, 2, 1}, {2, 1, 3}};
    ncr_axes a;
    for (int i = 0; i < 3; i++)
        a.row[i] = (int8_t)(k >> i & 1 ? -orders[k / 8][i] : orders[k / 8][i]);
    return a;
}

static void axes_are_a_group(void **state)
{
    (void)state;
    check_random r = {.seed = 27};
    for (int j = 0; j < 48; j++) {
        for (int k = 0; k < 48; k++) {
            double d[3], a[3], b[3], c[3];
            random_direction(&r, d);
            ncr_axes_apply(axes_number(j), d, a);
            ncr_axes_apply(axes_number(k), a, b);
            ncr_axes_apply(ncr_axes_then(axes_number(j), axes_number(k)), d, c);
            assert_memory_equal(b, c, sizeof b);
            ncr_axes_undo(axes_number(k), b, c);
            assert_memory_equal(a, c, sizeof a);
        }
    }
}

/* A cube turned and mirrored in each of 48 ways, and back: not a bit is changed, and on the way the
 * look-up is the same in every world direction. */
static void turning_a_cube_rounds_nothing(void **state)
{
    (void)state;
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map in = random_map((ncr_map_kind)kind, 12, 8);
        for (int k = 0; k < 48; k++) {
            const ncr_axes axes = axes_number(k);
            if (kind != NCR_MAP_CUBE &&
                (abs(axes.row[2]) != 3 || (kind == NCR_MAP_SPHERE && axes.row[2] < 0)))
                continue; /* the pole must stay in its place */
            ncr_directional_map turned = make_map(in.kind, 12), back = make_map(in.kind, 12);
            turned.axes = axes;
            CHECK_STATUS(NCR_OK, ncr_directional_map_convert(&quiet, &in, &turned));
            CHECK_STATUS(NCR_OK, ncr_directional_map_convert(&quiet, &turned, &back));
            const size_t bytes = (size_t)in.image.width * in.image.height * 3 * sizeof(float);
            CHECK(!memcmp(in.image.data, back.image.data, bytes), "%s, axes %d %d %d",
                  ncr_map_kind_name(in.kind), axes.row[0], axes.row[1], axes.row[2]);
            check_random r = {.seed = 28};
            for (int i = 0; i < 200; i++) {
                double d[3];
                float a[3], b[3];
                random_direction(&r, d);
                ncr_directional_map_look_up(&in, d, a);
                ncr_directional_map_look_up(&turned, d, b);
                for (int c = 0; c < 3; c++)
                    CHECK_NEAR((double)a[c], (double)b[c], 1e-5);
            }
            ncr_directional_map_dispose(&quiet, &turned);
            ncr_directional_map_dispose(&quiet, &back);
        }
        ncr_directional_map_dispose(&quiet, &in);
    }
}

static void every_level_keeps_the_integral(void **state)
{
    (void)state;
    assert_int_equal(ncr_map_level_count(1), 1);
    assert_int_equal(ncr_map_level_count(45), 6);
    assert_int_equal(ncr_map_level_count(64), 7);
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (uint32_t size = 45; size <= 64; size += 19) {
            ncr_directional_map map = random_map((ncr_map_kind)kind, size, 9), levels[7];
            const uint32_t count = ncr_map_level_count(size);
            CHECK_STATUS(NCR_OK, ncr_directional_map_levels(&quiet, &map, count, levels));
            double first[3], here[3];
            ncr_directional_map_integral(&map, first);
            for (uint32_t k = 0; k < count; k++) {
                assert_int_equal(levels[k].size, size >> k);
                ncr_directional_map_integral(&levels[k], here);
                for (int c = 0; c < 3; c++)
                    CHECK_NEAR(here[c] / first[c], 1, 1e-7 * (k + 1)); /* rounding of texels */
                ncr_directional_map_dispose(&quiet, &levels[k]);
            }
            ncr_directional_map_dispose(&quiet, &map);
        }
    }
}

static void a_constant_stays_itself_through_conversion_and_levels(void **state)
{
    (void)state;
    float c[3] = {0.3f, 7e4f, 1e-9f};
    for (int from = 0; from < NCR_MAP_KINDS; from++) {
        ncr_directional_map in = make_map((ncr_map_kind)from, 20), levels[5];
        CHECK_STATUS(NCR_OK, ncr_directional_map_fill(&quiet, &in, 0, constant, c));
        for (int to = 0; to < NCR_MAP_KINDS; to++) {
            ncr_directional_map out = make_map((ncr_map_kind)to, 13);
            out.axes = (ncr_axes){{2, -3, 1}};
            CHECK_STATUS(NCR_OK, ncr_directional_map_convert(&quiet, &in, &out));
            for (size_t k = 0; k < (size_t)out.image.width * out.image.height; k++)
                assert_memory_equal(out.image.data + 3 * k, c, sizeof c);
            ncr_directional_map_dispose(&quiet, &out);
        }
        CHECK_STATUS(NCR_OK, ncr_directional_map_levels(&quiet, &in, 5, levels));
        assert_memory_equal(levels[4].image.data, c, sizeof c);
        for (int k = 0; k < 5; k++)
            ncr_directional_map_dispose(&quiet, &levels[k]);
        ncr_directional_map_dispose(&quiet, &in);
    }
}

static void any_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    ncr_directional_map in = random_map(NCR_MAP_LATLONG, 32, 10), out[2];
    for (unsigned k = 0; k < 2; k++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = 1 + 6 * k};
        out[k] = make_map(NCR_MAP_PARABOLOID, 21);
        CHECK_STATUS(NCR_OK, ncr_directional_map_convert(&ctx, &in, &out[k]));
    }
    assert_memory_equal(out[0].image.data, out[1].image.data, 21 * 42 * 3 * sizeof(float));
    for (int k = 0; k < 2; k++)
        ncr_directional_map_dispose(&quiet, &out[k]);
    ncr_directional_map_dispose(&quiet, &in);
}

static void running_out_of_memory_leaves_nothing_behind(void **state)
{
    (void)state;
    ncr_directional_map in = random_map(NCR_MAP_CUBE, 32, 11), levels[6];
    for (long limit = 0;; limit++) {
        file_meter meter = {.left = limit};
        const ncr_ctx ctx = file_meter_ctx(&meter);
        ncr_directional_map out = {0};
        ncr_status status = ncr_directional_map_init(&ctx, NCR_MAP_LATLONG, 4, 3, &out);
        if (status == NCR_OK)
            status = ncr_directional_map_convert(&ctx, &in, &out); /* through coarser levels */
        ncr_directional_map_dispose(&ctx, &out);
        if (status == NCR_OK) {
            status = ncr_directional_map_levels(&ctx, &in, 6, levels);
            for (int k = 0; k < 6 && status == NCR_OK; k++)
                ncr_directional_map_dispose(&ctx, &levels[k]);
        }
        assert_int_equal(meter.held, 0);
        if (status == NCR_OK) {
            assert_true(limit >= 6);
            break;
        }
        assert_int_equal(status, NCR_E_NOMEM);
    }
    ncr_directional_map_dispose(&quiet, &in);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    ncr_directional_map a, b = make_map(NCR_MAP_CUBE, 4);
    CHECK_STATUS(NCR_E_ARG, ncr_directional_map_init(&quiet, NCR_MAP_CUBE, 0, 3, &a));
    assert_null(a.image.data);
    CHECK_STATUS(NCR_E_ARG, ncr_directional_map_init(&quiet, NCR_MAP_CUBE, 4, 5, &a));
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(&quiet, NCR_MAP_CUBE, 4, 1, &a));
    CHECK_STATUS(NCR_E_ARG, ncr_directional_map_convert(&quiet, &a, &b));
    CHECK_STATUS(NCR_E_ARG, ncr_directional_map_shrink(&quiet, &a, &b));
    ncr_image image;
    CHECK_STATUS(NCR_E_ARG, ncr_directional_map_bordered(&quiet, &b, 6, 1, &image));
    CHECK_STATUS(NCR_E_ARG, ncr_directional_map_bordered(&quiet, &b, 0, 5, &image));
    ncr_directional_map_dispose(&quiet, &a);
    ncr_directional_map_dispose(&quiet, &b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_is_seen_bit_by_bit_from_everywhere),
        cmocka_unit_test(no_look_up_jumps),
        cmocka_unit_test(a_linear_function_is_exact_within_a_face),
        cmocka_unit_test(a_cube_corner_is_the_mean_of_three_texels),
        cmocka_unit_test(a_border_replaces_the_neighbours),
        cmocka_unit_test(the_halves_of_the_paraboloid_show_the_same_near_their_rim),
        cmocka_unit_test(a_filled_map_has_the_integral_of_its_function),
        cmocka_unit_test(conversion_keeps_a_smooth_function_and_its_energy),
        cmocka_unit_test(a_sun_keeps_its_energy),
        cmocka_unit_test(axes_are_a_group),
        cmocka_unit_test(turning_a_cube_rounds_nothing),
        cmocka_unit_test(every_level_keeps_the_integral),
        cmocka_unit_test(a_constant_stays_itself_through_conversion_and_levels),
        cmocka_unit_test(any_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
