/* SPDX-License-Identifier: MIT
 * Truths about lights in glTF: the coefficients are the irradiance, every face shows what it should,
 * and what packing costs is told. JSON is read by jansson and faces by libpng alone. */
#include "files.h"

#include "io/gltf_light.h"
#include "io/rgbd_internal.h"
#include "shading/orientation_chart.h"

#include <jansson.h>
#include <png.h>

static const ncr_ctx *const ctx = &files_ctx;
static const double pi = 3.14159265358979323846;

/* Irradiance for a normal of the file's world: the cube's x is the world's reversed, and harmonics
 * of odd m are negative. */
static double irradiance(const double c[9][3], const double n[3], int channel)
{
    const double x = -n[0], y = n[1], z = n[2];
    const double basis[9] = {.28209479177387814,
                             -.48860251190291992 * y,
                             .48860251190291992 * z,
                             -.48860251190291992 * x,
                             1.0925484305920792 * x * y,
                             -1.0925484305920792 * y * z,
                             .31539156525252005 * (3 * z * z - 1),
                             -1.0925484305920792 * x * z,
                             .54627421529603959 * (x * x - y * y)};
    double sum = 0;
    for (int k = 0; k < 9; k++)
        sum += basis[k] * c[k][channel];
    return sum;
}

static void light_of_three_degrees(const double d[3], void *user, float *out)
{
    (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(2 + d[c] + d[(c + 1) % 3] * d[(c + 2) % 3]);
}

/* L = 2 + d_c + d_i d_j, i and j the other two: E(n) = 2 pi + (2 pi/3) n_c + (pi/4) n_i n_j, with n
 * in the file's world (x, z, -y). */
static void coefficients_are_the_irradiance(void **state)
{
    (void)state;
    static const double turned[3] = {0, 2, 1}, sign[3] = {1, -1, 1};
    check_random r = {.seed = 9};
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (int up = 0; up < 2; up++) {
            ncr_directional_map map;
            double c[9][3];
            CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, (ncr_map_kind)kind, 64, 3, &map));
            if (up)
                map.axes = (ncr_axes){{-3, 1, 2}};
            CHECK_STATUS(NCR_OK,
                         ncr_directional_map_fill(ctx, &map, 0, light_of_three_degrees, NULL));
            ncr_gltf_irradiance(&map, c);
            for (int k = 0; k < 50; k++) {
                double n[3], length = 0;
                for (int i = 0; i < 3; i++)
                    n[i] = check_uniform(&r, -1, 1), length += n[i] * n[i];
                for (int i = 0; i < 3; i++)
                    n[i] /= sqrt(length);
                for (int i = 0; i < 3; i++) { /* our axis i is the file's axis turned[i] */
                    const int j = (i + 1) % 3, m = (i + 2) % 3;
                    const double along = sign[i] * n[(int)turned[i]];
                    const double across = sign[j] * n[(int)turned[j]] * sign[m] * n[(int)turned[m]];
                    CHECK_NEAR(irradiance((const double(*)[3])c, n, i),
                               2 * pi + 2 * pi / 3 * along + pi / 4 * across,
                               (kind == NCR_MAP_SPHERE ? 4.0 : 1.0) / (64 * 64) * 2 * pi);
                }
            }
            ncr_directional_map_dispose(ctx, &map);
        }
    }
}

/* ---- Packing ---- */

static void packing_keeps_what_eight_bits_can(void **state)
{
    (void)state;
    check_random r = {.seed = 255};
    for (int k = 0; k < 20000; k++) {
        float in[3];
        double out[3], most = 0;
        uint8_t rgbd[4];
        for (int c = 0; c < 3; c++) {
            in[c] = (float)pow(10, check_uniform(&r, -3, 2.4));
            most = fmax(most, (double)in[c]);
        }
        ncr_rgbd_from_floats(in, rgbd);
        ncr_rgbd_to_floats(rgbd, out);
        assert_true(rgbd[3] > 0);
        if (most > 1) /* no larger divisor would do: the steps are as fine as can be */
            assert_true(most * (rgbd[3] + 1) > 255 || rgbd[3] == 255);
        /* Half a step of the code, at the steepest: 2.2/510, of 255/a, which is at most 2 max. */
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(out[c], (double)in[c], 2.2 / 510 * 1.003 * 255 / rgbd[3]);
    }
    static const float odd[3] = {NAN, -1, 1e9f};
    uint8_t rgbd[4];
    ncr_rgbd_from_floats(odd, rgbd);
    assert_true(rgbd[0] == 0 && rgbd[1] == 0 && rgbd[2] == 255 && rgbd[3] == 1);
}

/* ---- The file ---- */

typedef struct parsed {
    json_t *root, *light;
    uint8_t *data, *buffer;
    size_t size, buffer_size;
} parsed;

static uint32_t number(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* The length and start of a chunk, which starts and ends at a multiple of four. */
static uint32_t chunk_at(const parsed *p, size_t at, const char *type)
{
    assert_true(at % 4 == 0 && at + 8 <= p->size);
    const uint32_t length = number(p->data + at);
    assert_int_equal(length % 4, 0);
    assert_true(length <= p->size - at - 8);
    assert_memory_equal(p->data + at + 4, type, 4);
    return length;
}

/* GLB, version 2: a header of twelve bytes, JSON filled up with spaces, one buffer with zeros, and
 * nothing more.                                                                    [glTF 4.4] */
static void parse_binary(parsed *p)
{
    assert_true(p->size >= 12);
    assert_memory_equal(p->data, "glTF", 4);
    assert_int_equal(number(p->data + 4), 2);
    assert_int_equal(number(p->data + 8), p->size);
    const uint32_t text = chunk_at(p, 12, "JSON");
    assert_int_equal(p->data[20], '{');
    p->root = json_loadb((const char *)p->data + 20, text, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(p->root);
    uint32_t end = text;
    while (p->data[19 + end] == ' ')
        end--;
    assert_true(p->data[19 + end] == '}' && text - end < 4);
    p->buffer_size = chunk_at(p, 20 + text, "BIN");
    assert_int_equal(20 + text + 8 + p->buffer_size, p->size);
    const json_t *buffers = json_object_get(p->root, "buffers");
    assert_int_equal(json_array_size(buffers), 1);
    assert_null(json_object_get(json_array_get(buffers, 0), "uri"));
    p->buffer = malloc(p->buffer_size);
    memcpy(p->buffer, p->data + 28 + text, p->buffer_size);
}

static uint32_t digit_value(char c)
{
    return c >= 'a'   ? (uint32_t)(c - 'a') + 26
           : c >= 'A' ? (uint32_t)(c - 'A')
           : c >= '0' ? (uint32_t)(c - '0') + 52
           : c == '+' ? 62
                      : 63;
}

static void parse_text(parsed *p)
{
    static const char head[] = "data:application/octet-stream;base64,";
    p->root = json_loadb((const char *)p->data, p->size, 0, NULL);
    assert_non_null(p->root);
    const json_t *b = json_array_get(json_object_get(p->root, "buffers"), 0);
    const char *uri = json_string_value(json_object_get(b, "uri"));
    assert_memory_equal(uri, head, sizeof head - 1);
    uri += sizeof head - 1;
    const size_t digits = strlen(uri);
    assert_int_equal(digits % 4, 0);
    p->buffer = malloc(digits);
    for (size_t k = 0; k < digits; k += 4) {
        uint32_t bits = 0;
        for (size_t d = 0; d < 4; d++)
            bits = bits << 6 | (uri[k + d] == '=' ? 0 : digit_value(uri[k + d]));
        for (int byte = 2; byte >= 0; byte--)
            if (uri[k + 3 - (size_t)byte] != '=' || byte == 2)
                p->buffer[p->buffer_size++] = (uint8_t)(bits >> 8 * byte);
    }
}

static parsed parse(const char *path, bool binary)
{
    parsed p = {0};
    p.data = file_get(path, &p.size);
    if (binary)
        parse_binary(&p);
    else
        parse_text(&p);
    assert_non_null(p.root);
    const json_t *ext =
        json_object_get(json_object_get(p.root, "extensions"), "EXT_lights_image_based");
    p.light = json_array_get(json_object_get(ext, "lights"), 0);
    assert_non_null(p.light);
    return p;
}

static void release(parsed *p)
{
    json_decref(p->root);
    free(p->data);
    free(p->buffer);
}

static size_t count_of(const json_t *object, const char *key)
{
    return json_array_size(json_object_get(object, key));
}

static json_int_t integer(const json_t *object, const char *key)
{
    return json_integer_value(json_object_get(object, key));
}

/* One face as libpng reads it, unpacked as the extension says. */
static double *face_of(const parsed *p, uint32_t level, uint32_t face, uint32_t size)
{
    const json_t *faces = json_array_get(json_object_get(p->light, "specularImages"), level);
    assert_int_equal(json_array_size(faces), 6);
    const size_t image = (size_t)json_integer_value(json_array_get(faces, face));
    const json_t *i = json_array_get(json_object_get(p->root, "images"), image);
    assert_string_equal(json_string_value(json_object_get(i, "mimeType")), "image/png");
    const json_t *view =
        json_array_get(json_object_get(p->root, "bufferViews"), (size_t)integer(i, "bufferView"));
    const size_t offset = (size_t)integer(view, "byteOffset");
    const size_t length = (size_t)integer(view, "byteLength");
    assert_true(offset % 4 == 0 && offset + length <= p->buffer_size);
    for (size_t k = offset + length; k % 4; k++) /* zeros up to the next */
        assert_int_equal(p->buffer[k], 0);
    png_image png = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_memory(&png, p->buffer + offset, length));
    assert_true(png.width == size && png.height == size && png.format == PNG_FORMAT_RGBA);
    uint8_t *bytes = malloc(PNG_IMAGE_SIZE(png));
    assert_true(png_image_finish_read(&png, NULL, bytes, 0, NULL));
    double *out = malloc((size_t)size * size * 3 * sizeof *out);
    for (size_t k = 0; k < (size_t)size * size; k++)
        for (size_t c = 0; c < 3; c++)
            out[3 * k + c] = pow(bytes[4 * k + c] / 255.0, 2.2) / (bytes[4 * k + 3] / 255.0);
    free(bytes);
    return out;
}

/* What OpenGL looks up on each face: the axis ahead, along s, along t. Its table 8.19. */
static const double faces_of_gl[6][3][3] = {
    {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
    {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}},
};

/* The extension's first reader puts each image's lowest row at t = 0 and looks up (-x, y, z). */
static void check_face(const parsed *p, uint32_t level, uint32_t face, uint32_t size,
                       const ncr_directional_map *map)
{
    double *values = face_of(p, level, face, size), worst = 0;
    for (uint32_t y = 0; y < size; y++) {
        for (uint32_t x = 0; x < size; x++) {
            const double s = (2.0 * x + 1) / size - 1, t = (2.0 * (size - 1 - y) + 1) / size - 1;
            const double(*gl)[3] = faces_of_gl[face];
            double d[3], world[3];
            float expected[3];
            for (int k = 0; k < 3; k++)
                d[k] = gl[0][k] + s * gl[1][k] + t * gl[2][k];
            world[0] = -d[0]; /* (x, y, z) of the file is (x, -z, y) here */
            world[1] = -d[2];
            world[2] = d[1];
            ncr_directional_map_look_up(map, world, expected);
            for (int c = 0; c < 3; c++)
                worst = fmax(worst,
                             fabs(values[3 * (y * size + x) + (uint32_t)c] - (double)expected[c]));
        }
    }
    CHECK(worst <= 2.2 / 510 * 1.01, "level %u face %u: off by %g", level, face, worst);
    free(values);
}

static void check_document(const parsed *p, uint32_t count, uint32_t size)
{
    const json_t *asset = json_object_get(p->root, "asset");
    assert_string_equal(json_string_value(json_object_get(asset, "version")), "2.0");
    assert_string_equal(
        json_string_value(json_array_get(json_object_get(p->root, "extensionsUsed"), 0)),
        "EXT_lights_image_based");
    const json_t *scene = json_array_get(json_object_get(p->root, "scenes"), 0);
    const json_t *used =
        json_object_get(json_object_get(scene, "extensions"), "EXT_lights_image_based");
    assert_int_equal(integer(used, "light"), 0);
    assert_int_equal(count_of(p->root, "images"), 6 * count);
    assert_int_equal(count_of(p->root, "bufferViews"), 6 * count);
    const json_t *buffer = json_array_get(json_object_get(p->root, "buffers"), 0);
    assert_int_equal(integer(buffer, "byteLength"), p->buffer_size);
    assert_int_equal(integer(p->light, "specularImageSize"), size);
    assert_int_equal(count_of(p->light, "specularImages"), count);
    assert_int_equal(count_of(p->light, "irradianceCoefficients"), 9);
    const char *key; /* no members but the schema's */
    json_t *value;
    json_object_foreach(p->light, key, value)
    {
        static const char known[] = " rotation intensity irradianceCoefficients specularImages "
                                    "specularImageSize name extensions extras ";
        char word[64];
        snprintf(word, sizeof word, " %s ", key);
        assert_non_null(strstr(known, word));
    }
}

/* Levels of the chart: what a reader looks up is what is there, in a world with y up. */
static void every_look_up_finds_what_is_in_its_direction(void **state)
{
    (void)state;
    for (int binary = 0; binary < 2; binary++) {
        const file_path path = file_at(binary ? "light.glb" : "light.gltf");
        ncr_directional_map levels[3];
        double c[9][3];
        for (uint32_t k = 0; k < 3; k++) {
            CHECK_STATUS(NCR_OK,
                         ncr_directional_map_init(ctx, NCR_MAP_CUBE, 64u >> k, 3, &levels[k]));
            CHECK_STATUS(NCR_OK,
                         ncr_directional_map_fill(ctx, &levels[k], 0, ncr_orientation_chart, NULL));
        }
        ncr_gltf_irradiance(&levels[0], c);
        CHECK_STATUS(NCR_OK,
                     ncr_gltf_light_write(ctx, path.text, levels, 3, 64, (const double(*)[3])c,
                                          NCR_OPTS(ncr_gltf_light_opts, .name = "chart"), NULL));
        parsed p = parse(path.text, binary);
        check_document(&p, 3, 64);
        assert_string_equal(json_string_value(json_object_get(p.light, "name")), "chart");
        for (int k = 0; k < 27; k++) {
            const json_t *row =
                json_array_get(json_object_get(p.light, "irradianceCoefficients"), (size_t)k / 3);
            CHECK_NEAR(json_number_value(json_array_get(row, (size_t)k % 3)), c[k / 3][k % 3],
                       1e-8 * fabs(c[0][0]));
        }
        for (uint32_t k = 0; k < 3; k++)
            for (uint32_t face = 0; face < 6; face++)
                check_face(&p, k, face, 64u >> k, &levels[k]);
        release(&p);
        for (uint32_t k = 0; k < 3; k++)
            ncr_directional_map_dispose(ctx, &levels[k]);
    }
}

static void what_packing_costs_is_told(void **state)
{
    (void)state;
    const file_path path = file_at("bright.glb");
    static const double zero[9][3] = {{0}};
    ncr_directional_map map;
    ncr_gltf_light_report r, dim;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_CUBE, 4, 3, &map));
    for (size_t k = 0; k < 4 * 24 * 3; k++)
        map.image.data[k] = 1;
    map.image.data[0] = 1000;
    map.image.data[30] = -1;
    CHECK_STATUS(NCR_OK, ncr_gltf_light_write(ctx, path.text, &map, 1, 4, zero, NULL, &r));
    assert_int_equal(r.clamped, 2);
    CHECK_NEAR(r.lost, (1000.0 - 255 - 1) / (4 * 24 * 3 - 2 + 1000 - 1), 1e-12);
    parsed p = parse(path.text, true);
    const json_t *told =
        json_object_get(json_object_get(json_object_get(p.light, "extras"), "nacre"), "packing");
    assert_int_equal(integer(told, "clamped"), 2);
    CHECK_NEAR(json_real_value(json_object_get(told, "rms")), r.rms, 1e-8);
    release(&p);
    CHECK_STATUS(NCR_OK, ncr_gltf_light_write(ctx, path.text, &map, 1, 4, zero,
                                              NCR_OPTS(ncr_gltf_light_opts, .intensity = 8), &dim));
    assert_int_equal(dim.clamped, 1); /* the negative one */
    p = parse(path.text, true);
    CHECK_NEAR(json_number_value(json_object_get(p.light, "intensity")), 8, 0);
    release(&p);
    ncr_directional_map_dispose(ctx, &map);
}

/* What is written is described again: cut short or bent, it is refused or says the same. */
static void a_file_is_described_or_refused(void **state)
{
    (void)state;
    static const double flat[9][3] = {{11.136655993663414, 22.273311987326828, 0}};
    ncr_directional_map levels[2];
    for (uint32_t k = 0; k < 2; k++)
        CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_CUBE, 4u >> k, 3, &levels[k]));
    for (int binary = 0; binary < 2; binary++) {
        const file_path path = file_at(binary ? "told.glb" : "told.gltf");
        const file_path bent = file_at(binary ? "bent.glb" : "bent.gltf");
        ncr_gltf_light_info info;
        CHECK_STATUS(NCR_OK,
                     ncr_gltf_light_write(
                         ctx, path.text, levels, 2, 4, flat,
                         NCR_OPTS(ncr_gltf_light_opts, .name = "dusk", .intensity = 2), NULL));
        CHECK_STATUS(NCR_OK, ncr_gltf_light_describe(ctx, path.text, &info));
        assert_string_equal(info.name, "dusk");
        assert_true(info.lights == 1 && info.levels == 2 && info.size == 4);
        CHECK_NEAR(info.intensity, 2, 0);
        CHECK_NEAR(info.mean[0], 1, 1e-8); /* a constant 1 has pi 2 sqrt(pi) for its first */
        CHECK_NEAR(info.mean[1], 2, 1e-8);
        size_t size;
        uint8_t *data = file_get(path.text, &size);
        assert_int_equal(info.bytes, size);
        check_random r = {.seed = 77};
        for (int k = 0; k < 300; k++) {
            const size_t at = (size_t)check_uniform(&r, 0, (double)size);
            const size_t length = k % 3 ? size : at;
            const uint8_t was = data[at];
            data[at] ^= (uint8_t)(1u << (k & 7));
            file_put(bent.text, data, length);
            data[at] = was;
            const ncr_status status = ncr_gltf_light_describe(ctx, bent.text, &info);
            assert_true(status == NCR_OK || status == NCR_E_FORMAT);
            if (length < size)
                assert_int_equal(status, NCR_E_FORMAT);
        }
        free(data);
    }
    CHECK_STATUS(NCR_E_IO,
                 ncr_gltf_light_describe(ctx, file_at("none.glb").text, &(ncr_gltf_light_info){0}));
    for (uint32_t k = 0; k < 2; k++)
        ncr_directional_map_dispose(ctx, &levels[k]);
}

static void wrong_calls_write_nothing(void **state)
{
    (void)state;
    static const double zero[9][3] = {{0}};
    ncr_directional_map map[2];
    const size_t before = files_count();
    const file_path path = file_at("wrong.glb");
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_CUBE, 4, 3, &map[0]));
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_CUBE, 4, 1, &map[1]));
    const ncr_gltf_light_opts unsized = {0}, dark = {sizeof dark, NULL, -1};
    CHECK_STATUS(NCR_E_ARG, ncr_gltf_light_write(ctx, path.text, map, 1, 4, zero, &unsized, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_gltf_light_write(ctx, path.text, map, 1, 4, zero, &dark, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_gltf_light_write(ctx, path.text, map, 1, 5, zero, NULL, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_gltf_light_write(ctx, path.text, map, 0, 4, zero, NULL, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_gltf_light_write(ctx, path.text, map, 2, 1, zero, NULL, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_gltf_light_write(ctx, path.text, map, 2, 4, zero, NULL, NULL));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_gltf_light_write(ctx, file_at("wrong.png").text, map, 1, 4, zero, NULL, NULL));
    CHECK_STATUS(NCR_E_IO, ncr_gltf_light_write(ctx, file_at("no/such.glb").text, map, 1, 4, zero,
                                                NULL, NULL));
    assert_int_equal(files_count(), before);
    ncr_directional_map_dispose(ctx, &map[0]);
    ncr_directional_map_dispose(ctx, &map[1]);
}

static void running_out_of_memory_leaves_nothing_behind(void **state)
{
    (void)state;
    static const double zero[9][3] = {{0}};
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_CUBE, 4, 3, &map));
    for (int binary = 0; binary < 2; binary++) {
        const file_path path = file_at(binary ? "poor.glb" : "poor.gltf");
        for (long limit = 0;; limit++) {
            file_meter meter = {.left = limit};
            const ncr_ctx poor = file_meter_ctx(&meter);
            const ncr_status status =
                ncr_gltf_light_write(&poor, path.text, &map, 1, 4, zero, NULL, NULL);
            assert_int_equal(meter.held, 0);
            if (status == NCR_OK)
                break;
            assert_int_equal(status, NCR_E_NOMEM);
        }
    }
    ncr_directional_map_dispose(ctx, &map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coefficients_are_the_irradiance),
        cmocka_unit_test(packing_keeps_what_eight_bits_can),
        cmocka_unit_test(every_look_up_finds_what_is_in_its_direction),
        cmocka_unit_test(what_packing_costs_is_told),
        cmocka_unit_test(a_file_is_described_or_refused),
        cmocka_unit_test(wrong_calls_write_nothing),
        cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
