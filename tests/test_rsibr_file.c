/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "files.h"

#include "io/image_file.h"
#include "io/rsibr_file.h"

#include <sys/stat.h>

static void light(const double d[3], void *user, float *out)
{
    (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.5 * d[c]);
}

static ncr_rsibr set_of(const char *material, const ncr_rsibr_opts *opts)
{
    ncr_directional_map env;
    ncr_rsibr_brdf brdf;
    ncr_rsibr set;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_LATLONG, 8, 3, &env));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &env, 0, light, NULL));
    CHECK_STATUS(NCR_OK, ncr_rsibr_brdf_find(NULL, material, &brdf));
    CHECK_STATUS(NCR_OK, ncr_rsibr_create(NULL, &env, &brdf, opts, &set));
    ncr_directional_map_dispose(NULL, &env);
    return set;
}

static size_t texel_bytes(const ncr_rsibr *set)
{
    return (size_t)set->maps * set->sphere.view_count * set->size * set->size * 3 * sizeof(float);
}

static void check_same(const ncr_rsibr *a, const ncr_rsibr *b)
{
    assert_true(a->size == b->size && a->maps == b->maps && a->raw == b->raw &&
                a->single == b->single && a->turns == b->turns &&
                a->sphere.view_count == b->sphere.view_count);
    assert_memory_equal(a->texels, b->texels, texel_bytes(a));
    assert_memory_equal(a->frame, b->frame, a->sphere.view_count * sizeof *a->frame);
    assert_int_equal(a->brdf.lobe_count, b->brdf.lobe_count);
    assert_memory_equal(a->albedo, b->albedo,
                        a->brdf.lobe_count * NCR_RSIBR_AZIMUTHS * NCR_RSIBR_TABLE * sizeof(float));
    for (uint32_t map = 0; map < a->maps; map++)
        for (double c = 0; c <= 1; c += 0.01) {
            double x[3], y[3];
            ncr_rsibr_albedo(a, map, c, c, x);
            ncr_rsibr_albedo(b, map, c, c, y);
            assert_memory_equal(x, y, sizeof x);
        }
}

static void sets_come_back_bit_by_bit(void **state)
{
    (void)state;
    static const char *const materials[] = {"mirror:1.5", "phong:7.5", "car-paint",
                                            "cook-torrance:0.3", "ggx:0.4,0.8"};
    for (size_t k = 0; k < 5; k++) {
        const ncr_rsibr_opts opts = {.struct_size = sizeof opts,
                                     .views = k ? 12 : 162,
                                     .size = 5,
                                     .raw = k == 3,
                                     .single = k == 3,
                                     .turns = 3};
        ncr_rsibr set = set_of(materials[k], &opts), back;
        CHECK_STATUS(NCR_OK, ncr_rsibr_write(NULL, file_at("set").text, &set));
        CHECK_STATUS(NCR_OK, ncr_rsibr_read(NULL, file_at("set").text, &back));
        check_same(&set, &back);
        ncr_rsibr_dispose(NULL, &set);
        ncr_rsibr_dispose(NULL, &back);
    }
}

static size_t count_in(const char *folder)
{
    size_t count = 0;
    DIR *d = opendir(folder);
    for (struct dirent *e; (e = readdir(d));)
        count += e->d_name[0] != '.';
    closedir(d);
    return count;
}

static void sheets_of_an_earlier_set_go_and_other_files_stay(void **state)
{
    (void)state;
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .size = 4};
    ncr_rsibr first = set_of("car-paint", &opts), second = set_of("phong:20", &opts), back;
    const char *folder = file_at("turn").text;
    char path[160];
    strcpy(path, folder);
    CHECK_STATUS(NCR_OK, ncr_rsibr_write(NULL, path, &first));
    assert_int_equal(count_in(path), 1 + 3);
    file_put(file_at("turn/maps-9-deadbeef.exr").text, "mine", 4);
    CHECK_STATUS(NCR_OK, ncr_rsibr_write(NULL, path, &second));
    assert_int_equal(count_in(path), 1 + 1 + 1);
    CHECK_STATUS(NCR_OK, ncr_rsibr_write(NULL, path, &second));
    CHECK_STATUS(NCR_OK, ncr_rsibr_read(NULL, path, &back));
    check_same(&second, &back);
    ncr_rsibr_dispose(NULL, &first);
    ncr_rsibr_dispose(NULL, &second);
    ncr_rsibr_dispose(NULL, &back);
}

/* The manifest with one thing replaced by another. */
static void doctor(const char *folder, const char *from, const char *to)
{
    char path[200];
    snprintf(path, sizeof path, "%s/rsibr.json", folder);
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    static char text[1 << 20], out[1 << 20];
    const size_t size = fread(text, 1, sizeof text - 1, f);
    text[size] = 0;
    fclose(f);
    char *at = strstr(text, from);
    CHECK(at, "no %s in the manifest", from);
    snprintf(out, sizeof out, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    file_put(path, out, strlen(out));
}

static void damage_is_noticed(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to;
    } cases[] = {
        {"nacre.rsibr/1", "nacre.rsibr/2"},
        {"\"size\": 4", "\"size\": 5"},
        {"\"size\": 4", "\"size\": 4, \"sise\": 4"},
        {"\"kind\": \"gloss\"", "\"kind\": \"glass\""},
        {"\"through\": 2", "\"through\": -2"},
        {"\"file\": \"maps", "\"file\": \"../maps"},
        {"\"crc32\": ", "\"crc32\": 1"},
        {"\"raw\": false", "\"raw\": 3"},
        {"\"right\": [", "\"right\": [0.5, "},
        {"\"toward\"", "\"tovard\""},
        {"{", "["},
    };
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .size = 4};
    ncr_rsibr set = set_of("car-paint", &opts), back;
    char folder[160];
    strcpy(folder, file_at("damaged").text);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        CHECK_STATUS(NCR_OK, ncr_rsibr_write(NULL, folder, &set));
        doctor(folder, cases[k].from, cases[k].to);
        const ncr_status status = ncr_rsibr_read(NULL, folder, &back);
        CHECK(status == NCR_E_FORMAT || (k == 5 && status != NCR_OK), "%s gave %s", cases[k].to,
              ncr_status_name(status));
        assert_null(back.texels);
    }
    CHECK_STATUS(NCR_OK, ncr_rsibr_write(NULL, folder, &set));
    set.texels[7] += 1; /* another set's sheet under this one's name */
    ncr_rsibr_write(NULL, file_at("other").text, &set);
    CHECK_STATUS(NCR_E_IO, ncr_rsibr_read(NULL, file_at("nowhere").text, &back));
    CHECK_STATUS(NCR_E_IO, ncr_rsibr_write(NULL, file_at("nowhere/below").text, &set));
    ncr_rsibr_dispose(NULL, &set);
}

/* Other readers find each eye where the manifest says: eye 5 of 12 in the second row of four. */
static void a_sheet_is_a_grid_of_eyes(void **state)
{
    (void)state;
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .size = 6};
    ncr_rsibr set = set_of("mirror", &opts);
    char folder[160], path[200] = "";
    strcpy(folder, file_at("grid").text);
    CHECK_STATUS(NCR_OK, ncr_rsibr_write(NULL, folder, &set));
    DIR *d = opendir(folder);
    for (struct dirent *e; (e = readdir(d));)
        if (!strncmp(e->d_name, "maps-0-", 7))
            snprintf(path, sizeof path, "%s/%.30s", folder, e->d_name);
    closedir(d);
    ncr_image sheet;
    uint64_t bad;
    CHECK_STATUS(NCR_OK, ncr_image_read(NULL, path, &sheet, &bad));
    assert_true(sheet.width == 4 * 6 && sheet.height == 3 * 6);
    const float *texel = ncr_rsibr_map(&set, 0, 5) + (2 * 6 + 3) * 3;
    assert_memory_equal(ncr_image_at(&sheet, 1 * 6 + 3, 1 * 6 + 2), texel, 3 * sizeof(float));
    ncr_image_dispose(NULL, &sheet);
    ncr_rsibr_dispose(NULL, &set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sets_come_back_bit_by_bit),
        cmocka_unit_test(sheets_of_an_earlier_set_go_and_other_files_stay),
        cmocka_unit_test(damage_is_noticed),
        cmocka_unit_test(a_sheet_is_a_grid_of_eyes),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
