/* SPDX-License-Identifier: MIT
 * scene_file.h - scenes as JSON: objects, materials, lights, cameras, presets. docs/scene.md is the
 * reference of the format. */
#ifndef NCR_IO_SCENE_FILE_H
#define NCR_IO_SCENE_FILE_H

#include "shading/bake.h"
#include "shading/gbuffer.h"
#include "shading/world.h"

NCR_BEGIN

typedef struct ncr_scene_camera {
    const char *name;
    ncr_camera camera;
} ncr_scene_camera;

/** A named set of sizes: how much work a run is. */
typedef struct ncr_preset {
    const char *name;                             /* "quick", "mid", "thesis" */
    uint32_t points, cube[2], map, width, height; /* cube[1]: second size, or 0 */
    double epsilon[2];                            /* model units; [1]: second, or 0 */
    ncr_irradiance_opts irradiance;
} ncr_preset;

typedef struct ncr_scene_file ncr_scene_file;

/**
 * Load a scene and everything it names (patch files are found beside it).
 *
 * @return  NCR_E_IO; NCR_E_FORMAT with line and column for a syntax error, and with the JSON path
 *          ("/objects/3/material") and what was expected for a wrong value; unknown members are
 *          errors that name the nearest known one; what ncr_scene_create says
 */
NCR_API ncr_status ncr_scene_file_load(const ncr_ctx *ctx, const char *path, ncr_scene_file **out);
NCR_API void ncr_scene_file_destroy(const ncr_ctx *ctx, ncr_scene_file *file);

/** Everything below is borrowed until destroy. */
NCR_API const ncr_world *ncr_scene_file_world(const ncr_scene_file *file);
NCR_API double ncr_scene_file_exposure(const ncr_scene_file *file); /* stated exposure for L*a*b* */
/** The object to bake when none is named: the first with "bake": true; NCR_NONE if there is none. */
NCR_API uint32_t ncr_scene_file_subject(const ncr_scene_file *file);
NCR_API size_t ncr_scene_file_camera_count(const ncr_scene_file *file);
NCR_API const ncr_scene_camera *ncr_scene_file_camera(const ncr_scene_file *file, size_t k);
/** By name; NULL names the first. NCR_E_ARG with the nearest right word. */
NCR_API ncr_status ncr_scene_file_find_camera(const ncr_ctx *ctx, const ncr_scene_file *file,
                                              const char *name, const ncr_camera **out);
/** The same for presets. */
NCR_API ncr_status ncr_scene_file_find_preset(const ncr_ctx *ctx, const ncr_scene_file *file,
                                              const char *name, const ncr_preset **out);
/** Hash of the file and the patch files it names: 16 hexadecimal digits. */
NCR_API const char *ncr_scene_file_hash(const ncr_scene_file *file);

NCR_END

#endif
