/* SPDX-License-Identifier: MIT
 * scene_parts_internal.h - the parts of a scene file, each read by one function.
 *
 * All follow json_internal.h: a failure is left in the document's status. */
#ifndef NCR_IO_SCENE_PARTS_INTERNAL_H
#define NCR_IO_SCENE_PARTS_INTERNAL_H

#include "io/json_internal.h"
#include "io/scene_file.h"

/* The longest and shortest length in model units: a scene of everyday numbers may be 1e30 times as
 * large or small, and what is kept as float stays a normal one. */
static const double ncr_scene_long = 1e36, ncr_scene_tiny = 1e-36;

/* A growing list of control nets. */
typedef struct ncr_net_list {
    size_t count, room;
    double (*at)[16][3];
} ncr_net_list;

enum { NCR_SCENE_NETS_MAX = 1 << 20 }; /* in one object */

/* Room for `extra` more nets: their address, or NULL after a failure. */
double (*ncr_scene_grow(const ncr_json *at, ncr_net_list *nets, size_t extra))[16][3];

/* Where patch files are found, and the hash that their bytes go into. */
typedef struct ncr_scene_folder {
    const char *path;   /* of the scene file */
    size_t path_length; /* of its folder, with the slash */
    uint64_t hash;
} ncr_scene_folder;

/* Materials by name, as the file lists them. */
typedef struct ncr_scene_palette {
    size_t count;
    const char **names;
    ncr_material *materials;
} ncr_scene_palette;

/* Ray masks: what is baked can be hidden from rays by asking for the others. */
enum { NCR_SCENE_MASK_OTHER = 1, NCR_SCENE_MASK_BAKED = 2 };

/* FNV-1a, 64 bits.                                                                     [FNV] */
uint64_t ncr_fnv1a(uint64_t hash, const void *bytes, size_t size);

/* A shape, or an array of shapes, appended to the list. */
void ncr_scene_read_shape(const ncr_json *at, ncr_scene_folder *folder, ncr_net_list *nets);
/* "place" and "repeat" of `at`, applied to the nets from `first` on. */
void ncr_scene_read_place(const ncr_json *at, size_t first, ncr_net_list *nets);

/* An object; desc->surface is the caller's to destroy, also after a failure. */
void ncr_scene_read_object(const ncr_json *at, const ncr_scene_palette *palette,
                           ncr_scene_folder *folder, ncr_object_desc *desc, ncr_material *material);
void ncr_scene_read_material(const ncr_json *at, ncr_material *out);
void ncr_scene_read_sky(const ncr_json *at, ncr_sky *out);
void ncr_scene_read_camera(const ncr_json *at, ncr_scene_camera *out);
void ncr_scene_read_preset(const ncr_json *at, ncr_preset *out);

#endif
