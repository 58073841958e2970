/* SPDX-License-Identifier: MIT
 * seeds.c - writes small files of every format into the folders of a fuzzing corpus:
 *
 *     fuzz_seeds CORPUS      with CORPUS/{hdr,exr,png_map,field,map,journal,ktx2,rsibr} there already */
#include "small_field.h"
#include "small_rsibr.h"

#include "io/image_file.h"
#include "io/ktx2_file.h"
#include "io/map_file.h"
#include "tests/exr_sample_openexr.h"

enum { side = 17 };

static fuzz_path in(const char *corpus, const char *name)
{
    fuzz_path p;
    snprintf(p.text, sizeof p.text, "%.150s/%.90s", corpus, name);
    return p;
}

static void fill(float *data, size_t count)
{
    for (size_t k = 0; k < count; k++)
        data[k] = (float)(k * k % 23) / 8;
}

static void write_images(const char *corpus)
{
    static const struct {
        const char *name;
        uint32_t channels;
    } images[] = {{"hdr/runs.hdr", 3},     {"png_map/gray.png", 1}, {"png_map/rgb.png", 3},
                  {"png_map/rgba.png", 4}, {"exr/y.exr", 1},        {"exr/rgba.exr", 4}};
    for (size_t k = 0; k < sizeof images / sizeof images[0]; k++) {
        ncr_image image;
        FUZZ_CHECK(ncr_image_init(NULL, side, side, images[k].channels, &image) == NCR_OK);
        fill(image.data, (size_t)side * side * images[k].channels);
        FUZZ_CHECK(ncr_image_write(NULL, in(corpus, images[k].name).text, &image, NULL) == NCR_OK);
        ncr_image_dispose(NULL, &image);
    }
    uint16_t words[4 * side * side];
    for (size_t k = 0; k < sizeof words / sizeof words[0]; k++)
        words[k] = (uint16_t)(k * 77);
    FUZZ_CHECK(ncr_png16_write(NULL, in(corpus, "png_map/map.png").text, side, side, 4, words) ==
               NCR_OK);
}

/* A cube of three levels and a flat texture, in each format. */
static void write_textures(const char *corpus)
{
    ncr_image levels[3];
    for (uint32_t k = 0; k < 3; k++) {
        FUZZ_CHECK(ncr_image_init(NULL, 4u >> k, 24u >> k, 3, &levels[k]) == NCR_OK);
        fill(levels[k].data, (size_t)levels[k].width * levels[k].height * 3);
    }
    for (int k = 0; k < 2 * NCR_KTX2_FORMATS; k++) {
        char name[64];
        snprintf(name, sizeof name, "ktx2/%d.ktx2", k);
        const ncr_ktx2_opts opts = {.struct_size = sizeof opts,
                                    .format = (ncr_ktx2_format)(k / 2),
                                    .cube = k % 2,
                                    .comment = "nacre map: cube nacre; axes +x +y +z;"};
        FUZZ_CHECK(ncr_ktx2_write(NULL, in(corpus, name).text, levels, 3, &opts, NULL) == NCR_OK);
    }
    for (uint32_t k = 0; k < 3; k++)
        ncr_image_dispose(NULL, &levels[k]);
}

/* Flat pixels, repeats of the old kind, and turned axes. */
static void write_hdr_texts(const char *corpus)
{
    static const char old_runs[] = "#?RADIANCE\nEXPOSURE=2\nCOLORCORR=1 2 3\n"
                                   "FORMAT=32-bit_rle_rgbe\n\n+X 2 -Y 6\n"
                                   "abcd\1\1\1\5efghijkl\1\1\1\4";
    fuzz_put(in(corpus, "hdr/old.hdr").text, old_runs, sizeof old_runs - 1);
}

static void write_exr_samples(const char *corpus)
{
    static const float primaries[8] = {0.7f, 0.3f, 0.2f, 0.7f, 0.15f, 0.05f, 0.32f, 0.33f};
    float data[3 * side * side];
    fill(data, sizeof data / sizeof data[0]);
    for (int k = 0; k < 30; k++) {
        char name[64];
        snprintf(name, sizeof name, "exr/sample-%d.exr", k);
        const exr_sample sample = {.width = side,
                                   .height = side,
                                   .min_x = k % 4 - 2,
                                   .min_y = k % 3,
                                   .compression = k % 10,
                                   .type = k % 3,
                                   .tile = k % 4 == 1 ? 8 : 0,
                                   .mip = k % 8 == 1,
                                   .decreasing = k % 5 == 2,
                                   .primaries = k % 7 == 3 ? primaries : NULL,
                                   .channels = k % 6 == 5 ? "Y" : "RGB",
                                   .data = data};
        FUZZ_CHECK(exr_sample_write(in(corpus, name).text, &sample) == 0);
    }
}

/* A file after the byte that a target tells files by. */
static void put_led(const char *from, size_t lead, const char *to)
{
    size_t size;
    uint8_t *data = fuzz_get(from, &size);
    memmove(data + 1, data, size);
    data[0] = (uint8_t)lead;
    fuzz_put(to, data, size + 1);
    free(data);
}

static void write_field_files(const char *corpus)
{
    small_field_write(fuzz_at("small.field").text);
    for (size_t k = 0; k < small_file_count; k++) {
        char from[64], to[64];
        snprintf(from, sizeof from, "small.field/%s", small_files[k]);
        snprintf(to, sizeof to, "field/%s", small_files[k]);
        put_led(fuzz_at(from).text, k, in(corpus, to).text);
    }
}

/* Every convention in every format: as the file itself says, and as one that it does not say. */
static void write_maps(const char *corpus)
{
    static const char *const ends[] = {"exr", "hdr", "png"};
    const ncr_convention *c;
    for (size_t k = 0; (c = ncr_convention_at(k)); k++) {
        ncr_directional_map map;
        const char *end = ends[k % 3];
        char to[64];
        FUZZ_CHECK(ncr_directional_map_init(NULL, c->kind, 4, 3, &map) == NCR_OK);
        fill(map.image.data, (size_t)map.image.width * map.image.height * 3);
        ncr_directional_map_seal(&map);
        const ncr_map_file_opts opts = {.struct_size = sizeof opts, .as = {c, {{0}}}};
        snprintf(to, sizeof to, "map-%%.%s", end);
        FUZZ_CHECK(ncr_map_file_write(NULL, fuzz_at(to).text, &map, &opts) == NCR_OK);
        const char *face = strcmp(c->name, "sixfiles") ? "%" : "px";
        snprintf(to, sizeof to, "map-%s.%s", face, end);
        const fuzz_path from = fuzz_at(to);
        for (size_t lead = 0; lead <= k + 1; lead += k + 1) {
            snprintf(to, sizeof to, "map/%zu-%zu.%s", k, lead, end);
            put_led(from.text, lead, in(corpus, to).text);
        }
        ncr_directional_map_dispose(NULL, &map);
    }
}

/* A bake cut short after some tiles: its journal and its radiance. */
static void write_journal(const char *corpus)
{
    small_bake bake;
    small_bake_init(&bake, 7);
    const fuzz_path path = fuzz_at("cut.field");
    small_bake_suspend(&bake, path.text, small_tile_count / 2);
    for (size_t k = 0; k < small_partial_count; k++) {
        char from[64], to[64];
        snprintf(from, sizeof from, "cut.field.partial/%s", small_partial[k]);
        snprintf(to, sizeof to, "journal/%s", small_partial[k]);
        put_led(fuzz_at(from).text, k, in(corpus, to).text);
    }
    small_bake_dispose(&bake);
}

static void write_rsibr(const char *corpus)
{
    size_t size;
    small_rsibr_write(fuzz_at("paint").text);
    uint8_t *data = fuzz_get(fuzz_at("paint/" NCR_RSIBR_MANIFEST).text, &size);
    fuzz_put(in(corpus, "rsibr/car-paint.json").text, data, size);
    free(data);
}

int main(int argc, char **argv)
{
    if (argc != 2)
        return 2;
    write_images(argv[1]);
    write_textures(argv[1]);
    write_hdr_texts(argv[1]);
    write_exr_samples(argv[1]);
    write_field_files(argv[1]);
    write_maps(argv[1]);
    write_journal(argv[1]);
    write_rsibr(argv[1]);
    return 0;
}
