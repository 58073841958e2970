/* SPDX-License-Identifier: MIT
 * base.h - what every header starts from: linkage, version, plain vectors, option structs. */
#ifndef NCR_CORE_BASE_H
#define NCR_CORE_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define NCR_BEGIN extern "C" {
#define NCR_END }
#else
#define NCR_BEGIN
#define NCR_END
#endif

#define NCR_API __attribute__((visibility("default")))

#define NCR_VERSION_MAJOR 0
#define NCR_VERSION_MINOR 1
#define NCR_VERSION_PATCH 0

/** Options by name, zero meaning default: NCR_OPTS(ncr_bake_opts, .points = 1156). C only; a C++
 *  caller fills the struct and sets struct_size itself. */
#define NCR_OPTS(type, ...) (&(type){.struct_size = sizeof(type), __VA_ARGS__})

/** No object, no patch, no point: what an index says when there is nothing to name. */
#define NCR_NONE UINT32_MAX

/** Three floats: a position in frame units, a direction, or linear RGB, as the user says. */
typedef struct ncr_vec3 {
    float x, y, z;
} ncr_vec3;

#endif
