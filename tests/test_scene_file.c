/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "io/scene_file.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char small_path[] = "tests/data/small.json";

/* --- a context that remembers the last sentence --------------------------------------------------- */

static char last[512];

static void remember(void *user, ncr_status status, const char *sentence)
{
    (void)user;
    (void)status;
    snprintf(last, sizeof last, "%s", sentence);
}

static const ncr_ctx ctx = {.struct_size = sizeof ctx, .report = remember, .workers = 1};

static ncr_scene_file *load_small(void)
{
    ncr_scene_file *file;
    CHECK_STATUS(NCR_OK, ncr_scene_file_load(&ctx, small_path, &file));
    return file;
}

/* --- what is read ---------------------------------------------------------------------------------- */

static void sky_and_materials_are_as_written(void **state)
{
    (void)state;
    ncr_scene_file *file = load_small();
    const ncr_world *world = ncr_scene_file_world(file);
    CHECK_NEAR(world->sky.zenith[2], 0.25, 0);
    CHECK_NEAR(world->sky.horizon[1], 0.75, 0);
    CHECK_NEAR(world->sky.ground[0], 0, 0);
    CHECK_NEAR(world->sky.sun_direction[0], 0, 1e-7);
    CHECK_NEAR(world->sky.sun_direction[1], sqrt(0.75), 1e-7);
    CHECK_NEAR(world->sky.sun_direction[2], 0.5, 1e-7);
    CHECK_NEAR(world->sky.sun_radius_deg, 1, 0);
    CHECK_NEAR(ncr_scene_file_exposure(file), 0.5, 0);
    const ncr_material *stone = &world->materials[0];
    assert_int_equal(stone->pattern, NCR_PATTERN_TILES);
    assert_int_equal(stone->projection, NCR_PROJECT_XY);
    CHECK_NEAR(stone->color[0][2], 0.125, 0);
    CHECK_NEAR(stone->color[1][0], 0.75, 0);
    CHECK_NEAR(stone->color[2][1], 0.5, 0); /* a slot left out repeats the last */
    CHECK_NEAR(stone->period[1], 3, 0);
    CHECK_NEAR(stone->offset[0], 0.25, 0);
    CHECK_NEAR(stone->width, 0.125, 0);
    CHECK_NEAR(stone->specular[1], 0.375, 0);
    CHECK_NEAR(world->materials[2].specular[0], 0, 0);
    ncr_scene_file_destroy(&ctx, file);
}

static void emissive_objects_become_area_lights(void **state)
{
    (void)state;
    ncr_scene_file *file = load_small();
    const ncr_world *world = ncr_scene_file_world(file);
    assert_int_equal(world->light_count, 1);
    assert_int_equal(world->lights[0].object, 3);
    CHECK_NEAR(world->lights[0].radiance[1], 4, 0);
    ncr_scene_file_destroy(&ctx, file);
}

static void the_baked_object_is_the_subject_and_can_be_hidden_by_mask(void **state)
{
    (void)state;
    ncr_scene_file *file = load_small();
    const ncr_scene *scene = ncr_scene_file_world(file)->scene;
    const uint32_t subject = ncr_scene_file_subject(file);
    assert_int_equal(subject, 1);
    assert_string_equal(ncr_scene_object_name(scene, subject), "cubes");
    for (uint32_t k = 0; k < ncr_scene_object_count(scene); k++)
        assert_int_equal(ncr_scene_object_mask(scene, k), k == subject ? 2 : 1);
    assert_true(ncr_scene_object_open(scene, 0));
    assert_false(ncr_scene_object_open(scene, 1));
    ncr_scene_file_destroy(&ctx, file);
}

/* Model-unit bounds of an object. */
static void bounds(const ncr_scene_file *file, uint32_t object, double min[3], double max[3])
{
    const ncr_scene *scene = ncr_scene_file_world(file)->scene;
    double low[3], high[3];
    ncr_surface_bounds(ncr_scene_object_surface(scene, object), low, high);
    ncr_frame_to_model(ncr_scene_frame(scene), low, min);
    ncr_frame_to_model(ncr_scene_frame(scene), high, max);
}

static void shapes_are_scaled_turned_moved_and_repeated_in_that_order(void **state)
{
    (void)state;
    ncr_scene_file *file = load_small();
    const ncr_scene *scene = ncr_scene_file_world(file)->scene;
    double min[3], max[3];
    assert_int_equal(ncr_surface_patch_count(ncr_scene_object_surface(scene, 1)), 6 * 2 * 4);
    bounds(file, 1, min, max); /* a cube at x 1..1.5, y 0...5, twice along z, turned to 4 sides */
    for (int k = 0; k < 2; k++) {
        CHECK_NEAR(min[k], -1.5, 1e-12);
        CHECK_NEAR(max[k], 1.5, 1e-12);
    }
    CHECK_NEAR(min[2], 0, 1e-12);
    CHECK_NEAR(max[2], 1.5, 1e-12);
    /* the second square of the file, x 1..2, stood up by x, then turned by z: y 1..2, z 0..1 */
    assert_int_equal(ncr_surface_patch_count(ncr_scene_object_surface(scene, 2)), 1);
    bounds(file, 2, min, max);
    const double want_min[3] = {0, 1, 0}, want_max[3] = {0, 2, 1};
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(min[k], want_min[k], 1e-12);
        CHECK_NEAR(max[k], want_max[k], 1e-12);
    }
    ncr_scene_file_destroy(&ctx, file);
}

static void cameras_and_presets_are_found_by_name(void **state)
{
    (void)state;
    ncr_scene_file *file = load_small();
    const ncr_camera *camera;
    const ncr_preset *preset;
    assert_int_equal(ncr_scene_file_camera_count(file), 2);
    CHECK_STATUS(NCR_OK, ncr_scene_file_find_camera(&ctx, file, NULL, &camera));
    CHECK_NEAR(camera->fov_deg, 45, 0);
    CHECK_NEAR(camera->up[2], 1, 0);
    CHECK_STATUS(NCR_OK, ncr_scene_file_find_camera(&ctx, file, "above", &camera));
    assert_ptr_equal(camera, &ncr_scene_file_camera(file, 1)->camera);
    CHECK_NEAR(camera->eye[2], 9, 0);
    CHECK_STATUS(NCR_E_ARG, ncr_scene_file_find_camera(&ctx, file, "abvoe", &camera));
    assert_string_equal(last, "no camera \"abvoe\"; did you mean \"above\"?");
    assert_null(camera);
    CHECK_STATUS(NCR_OK, ncr_scene_file_find_preset(&ctx, file, "quick", &preset));
    assert_int_equal(preset->points, 100);
    assert_int_equal(preset->cube[1], 32);
    assert_int_equal(preset->height, 48);
    CHECK_NEAR(preset->epsilon[1], 0.25, 0);
    assert_int_equal(preset->irradiance.seed, 7);
    assert_int_equal(preset->irradiance.struct_size, sizeof preset->irradiance);
    CHECK_STATUS(NCR_OK, ncr_scene_file_find_preset(&ctx, file, "bare", &preset));
    assert_int_equal(preset->points, 1156);
    assert_int_equal(preset->cube[1], 0);
    CHECK_STATUS(NCR_E_ARG, ncr_scene_file_find_preset(&ctx, file, "quik", &preset));
    assert_string_equal(last, "no preset \"quik\"; did you mean \"quick\"?");
    ncr_scene_file_destroy(&ctx, file);
}

static void shipped_scenes_are_whole_and_of_moderate_size(void **state)
{
    (void)state;
    static const char *const paths[] = {"data/scenes/gazebo.json", "data/scenes/room.json",
                                        "data/scenes/spheres.json"};
    static const char *const presets[] = {"quick", "mid", "thesis"};
    for (size_t k = 0; k < sizeof paths / sizeof *paths; k++) {
        ncr_scene_file *file;
        const ncr_camera *camera;
        const ncr_preset *preset;
        const ncr_status status = ncr_scene_file_load(&ctx, paths[k], &file);
        CHECK(status == NCR_OK, "%s: %s", paths[k], last);
        const ncr_scene *scene = ncr_scene_file_world(file)->scene;
        assert_true(ncr_scene_file_subject(file) != NCR_NONE);
        assert_true(ncr_scene_object_count(scene) < 60);
        assert_true(ncr_scene_triangle_count(scene, NCR_NONE) < 600000);
        CHECK_STATUS(NCR_OK, ncr_scene_file_find_camera(&ctx, file, "main", &camera));
        assert_ptr_equal(camera, &ncr_scene_file_camera(file, 0)->camera);
        for (int p = 0; p < 3; p++)
            CHECK_STATUS(NCR_OK, ncr_scene_file_find_preset(&ctx, file, presets[p], &preset));
        ncr_scene_file_destroy(&ctx, file);
    }
}

/* --- what is refused -------------------------------------------------------------------------------- */

static char *read_text(const char *path)
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    char *text = calloc(1, 1 << 16);
    const size_t n = fread(text, 1, (1 << 16) - 1, stream);
    assert_true(n > 0);
    fclose(stream);
    return text;
}

static void write_text(const char *path, const char *text)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    fwrite(text, 1, strlen(text), stream);
    fclose(stream);
}

/* A folder of our own that holds small.patches and, as scene.json, an edited small.json. */
typedef struct bench {
    char folder[64], scene[96], patches[96];
    char *text;
} bench;

static bench make_bench(void)
{
    bench b = {.folder = "/tmp/nacre_scene_XXXXXX", .text = read_text(small_path)};
    assert_non_null(mkdtemp(b.folder));
    snprintf(b.scene, sizeof b.scene, "%s/scene.json", b.folder);
    snprintf(b.patches, sizeof b.patches, "%s/small.patches", b.folder);
    char *patches = read_text("tests/data/small.patches");
    write_text(b.patches, patches);
    free(patches);
    return b;
}

static void clear_bench(bench *b)
{
    unlink(b->scene);
    unlink(b->patches);
    rmdir(b->folder);
    free(b->text);
}

/* Write the small scene with the first `old` replaced by `new`. */
static void edit(const bench *b, const char *old, const char *new)
{
    const char *at = strstr(b->text, old);
    if (!at)
        fail_msg("the small scene does not hold %s", old);
    char *text = calloc(1, strlen(b->text) + strlen(new) + 1);
    sprintf(text, "%.*s%s%s", (int)(at - b->text), b->text, new, at + strlen(old));
    write_text(b->scene, text);
    free(text);
}

static void every_mistake_is_named_with_its_place(void **state)
{
    (void)state;
    static const struct {
        const char *old, *new, *sentence;
    } cases[] = {
        {"\"nacre\": 1,", "\"nacre\": 1", ":3:9: '}' expected near '\"units\"'"},
        {"\"units\"", "\"nacre\"", ":3:9: duplicate object key near '\"nacre\"'"},
        {"\"nacre\": 1", "\"nacre\": 2", ": /nacre: expected a whole number from 1 to 1, found 2"},
        {"\"nacre\": 1,", "", ": /nacre: expected 1, the version of the format, found nothing"},
        {"\"exposure\": 0.5", "\"exposure\": 0",
         ": /exposure: expected a number from 1e-30 to 1e+30, found 0"},
        {"\"exposure\"", "\"expsoure\"",
         ": /expsoure: unknown member \"expsoure\"; did you mean \"exposure\"?"},
        {"[0.5, 0.75, 1]", "[0.5, 0.75]",
         ": /sky/horizon: expected an array of 3 numbers, found an array of 2"},
        {"\"elevation_deg\": 30", "\"elevation_deg\": 91",
         ": /sky/sun/elevation_deg: expected a number from -90 to 90, found 91"},
        {"\"tiles\"", "\"tilse\"",
         ": /materials/stone/pattern: unknown word \"tilse\"; did you mean \"tiles\"?"},
        {"0.125], [0.75", "1.5], [0.75",
         ": /materials/stone/color/0/2: expected a number from 0 to 1, found 1.5"},
        {"\"specular\": 0.375", "\"specular\": \"high\"",
         ": /materials/stone/specular: expected a number from 0 to 1, found \"high\""},
        {"\"material\": \"stone\"", "\"material\": \"stnoe\"",
         ": /objects/0/material: no material \"stnoe\"; did you mean \"stone\"?"},
        {"\"material\": \"stone\",", "",
         ": /objects/0/material: expected the name of a material, found nothing"},
        {"\"name\": \"flag\"", "\"name\": \"cubes\"",
         ": /objects/2/name: another object has the name \"cubes\""},
        {"\"bake\": true", "\"bake\": 1", ": /objects/1/bake: expected true or false, found 1"},
        {"\"max\": [1, 1, 1]", "\"max\": [1, 0, 1]",
         ": /objects/1/shape/box: min must be below max, but 0 and 0"},
        {"\"box\"", "\"bxo\"",
         ": /objects/1/shape/bxo: unknown member \"bxo\"; did you mean \"box\"?"},
        {"\"scale\": 0.5", "\"scale\": [1, 0, 1]",
         ": /objects/1/shape/place/scale: expected a scale without zeros, found an array of 3"},
        {"\"count\": 4", "\"count\": 0",
         ": /objects/1/shape/repeat/1/count: expected a whole number from 1 to 4096, found 0"},
        {"\"first\": 1", "\"first\": 2",
         ": /objects/2/shape/first: 0 patches from 2 on of a file that has 2"},
        {"\"target\": [0, 0, 0], \"up\": [0, 1, 0]", "\"target\": [0, 0, 0]",
         ": /cameras/1: eye, target and up give no direction"},
        {"\"rays\": 64", "\"rays\": 65",
         ": /presets/quick/irradiance/rays: expected a power of two, found 65"},
        {"\"map\": 32", "\"map\": 33", ": /presets/quick/map: expected a power of two, found 33"},
        {"\"size\": [64, 48]", "\"size\": [64, 48.5]",
         ": /presets/quick/size/1: expected a whole number from 1 to 65536, found 48.5"},
        {"{ \"patches\": \"small.patches\", \"first\": 1 }",
         "{ \"revolve\": [[[0, 0], [1, 1], [2, 2]]] }",
         ": /objects/2/shape/revolve/0: expected 4 points of a cubic or 2 of a line, found an "
         "array of 3"},
        {"{ \"patches\": \"small.patches\", \"first\": 1 }", "{ \"revolve\": [[[0, 0], [-1, 1]]] }",
         ": /objects/2/shape/revolve/0/1/0: expected a number not below 0, found -1"},
        {"{ \"patches\": \"small.patches\", \"first\": 1 }",
         "{ \"prism\": { \"sides\": 7, \"radius\": 1, \"bottom\": 0, \"top\": 1 } }",
         ": /objects/2/shape/prism/sides: expected an even number, found 7"},
        {"{ \"patches\": \"small.patches\", \"first\": 1 }",
         "{ \"beam\": { \"from\": [0,0,0], \"to\": [0,0,1], \"width\": 1, \"height\": 1 } }",
         ": /objects/2/shape/beam: the beam has no length or runs along \"up\""},
        {"{ \"patches\": \"small.patches\", \"first\": 1 }",
         "{ \"lattice\": { \"width\": 1, \"height\": 1, \"spacing\": 1e-6, \"slat\": 1, "
         "\"thickness\": 1 } }",
         ": /objects/2/shape/lattice: spacing 1e-06 gives more than 4096 slats"},
        {"{ \"patches\": \"small.patches\", \"first\": 1 }", "{ \"first\": 1 }",
         ": /objects/2/shape: expected one of patches, revolve, box, quad, disc, beam, plank, "
         "prism, lattice, found 0 of them"},
    };
    bench b = make_bench();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char want[512];
        ncr_scene_file *file = (ncr_scene_file *)&b;
        edit(&b, cases[k].old, cases[k].new);
        snprintf(want, sizeof want, "%s%s", b.scene, cases[k].sentence);
        const ncr_status status = ncr_scene_file_load(&ctx, b.scene, &file);
        CHECK(status == NCR_E_FORMAT, "%s instead of %s: %s", cases[k].new, cases[k].old,
              ncr_status_name(status));
        assert_null(file);
        assert_string_equal(last, want);
    }
    clear_bench(&b);
}

static void a_missing_file_is_named(void **state)
{
    (void)state;
    ncr_scene_file *file;
    CHECK_STATUS(NCR_E_IO, ncr_scene_file_load(&ctx, "/nowhere/scene.json", &file));
    assert_non_null(strstr(last, "/nowhere/scene.json"));
    bench b = make_bench();
    edit(&b, "small.patches", "other.patches");
    CHECK_STATUS(NCR_E_IO, ncr_scene_file_load(&ctx, b.scene, &file));
    assert_non_null(strstr(last, "other.patches"));
    clear_bench(&b);
}

static void the_hash_changes_with_the_scene_and_with_the_patches_it_names(void **state)
{
    (void)state;
    bench b = make_bench();
    char hash[4]
             [17]; /* as it is, other units, another letter in a comment of the patches, as it is */
    char *patches = read_text("tests/data/small.patches");
    for (int k = 0; k < 4; k++) {
        ncr_scene_file *file;
        edit(&b, "\"metres\"", k == 1 ? "\"feet\"" : "\"metres\"");
        patches[strlen("nacre patches 1\n#")] = k == 2 ? '-' : ' ';
        write_text(b.patches, patches);
        CHECK_STATUS(NCR_OK, ncr_scene_file_load(&ctx, b.scene, &file));
        strcpy(hash[k], ncr_scene_file_hash(file));
        ncr_scene_file_destroy(&ctx, file);
    }
    free(patches);
    assert_int_equal(strspn(hash[0], "0123456789abcdef"), 16);
    assert_string_not_equal(hash[0], hash[1]);
    assert_string_not_equal(hash[0], hash[2]);
    assert_string_not_equal(hash[1], hash[2]);
    assert_string_equal(hash[0], hash[3]);
    clear_bench(&b);
}

/* An allocator that refuses the call numbered `refuse` and counts what is held. */
typedef struct miser {
    int calls, refuse, held;
} miser;

static void *miser_alloc(void *user, size_t size, size_t align)
{
    miser *m = user;
    if (m->calls++ == m->refuse)
        return NULL;
    m->held++;
    return aligned_alloc(align, size);
}

static void miser_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((miser *)user)->held--;
    free(ptr);
}

static void running_out_of_memory_anywhere_leaks_nothing(void **state)
{
    (void)state;
    ncr_status status = NCR_E_NOMEM;
    int refuse = 0;
    for (; status != NCR_OK && refuse < 1000; refuse++) {
        miser m = {.refuse = refuse};
        const ncr_ctx poor = {.struct_size = sizeof poor,
                              .user = &m,
                              .alloc = miser_alloc,
                              .release = miser_release,
                              .workers = 1};
        ncr_scene_file *file;
        status = ncr_scene_file_load(&poor, small_path, &file);
        if (status == NCR_OK)
            ncr_scene_file_destroy(&poor, file);
        else
            CHECK(status == NCR_E_NOMEM && !file, "call %d: %s", refuse, ncr_status_name(status));
        CHECK(m.held == 0, "call %d refused: %d blocks are still held", refuse, m.held);
    }
    CHECK(status == NCR_OK && refuse > 10, "%d refusals", refuse);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sky_and_materials_are_as_written),
        cmocka_unit_test(emissive_objects_become_area_lights),
        cmocka_unit_test(the_baked_object_is_the_subject_and_can_be_hidden_by_mask),
        cmocka_unit_test(shapes_are_scaled_turned_moved_and_repeated_in_that_order),
        cmocka_unit_test(cameras_and_presets_are_found_by_name),
        cmocka_unit_test(shipped_scenes_are_whole_and_of_moderate_size),
        cmocka_unit_test(every_mistake_is_named_with_its_place),
        cmocka_unit_test(a_missing_file_is_named),
        cmocka_unit_test(the_hash_changes_with_the_scene_and_with_the_patches_it_names),
        cmocka_unit_test(running_out_of_memory_anywhere_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
