/* SPDX-License-Identifier: MIT
 * vec_internal.h - three-vectors: v_* on ncr_vec3 (float), d_* on double[3]. */
#ifndef NCR_CORE_VEC_INTERNAL_H
#define NCR_CORE_VEC_INTERNAL_H

#include "core/base.h"

#include <math.h>

static inline ncr_vec3 v_make(float x, float y, float z)
{
    return (ncr_vec3){x, y, z};
}

static inline ncr_vec3 v_add(ncr_vec3 a, ncr_vec3 b)
{
    return (ncr_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline ncr_vec3 v_sub(ncr_vec3 a, ncr_vec3 b)
{
    return (ncr_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline ncr_vec3 v_scale(ncr_vec3 a, float s)
{
    return (ncr_vec3){a.x * s, a.y * s, a.z * s};
}

static inline ncr_vec3 v_mul(ncr_vec3 a, ncr_vec3 b)
{
    return (ncr_vec3){a.x * b.x, a.y * b.y, a.z * b.z};
}

/* a + s b */
static inline ncr_vec3 v_mad(ncr_vec3 a, float s, ncr_vec3 b)
{
    return (ncr_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline float v_dot(ncr_vec3 a, ncr_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline ncr_vec3 v_cross(ncr_vec3 a, ncr_vec3 b)
{
    return (ncr_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline float v_length(ncr_vec3 a)
{
    return sqrtf(v_dot(a, a));
}

/* Unit vector along a; a itself when its length is zero or not finite. */
static inline ncr_vec3 v_unit(ncr_vec3 a)
{
    const float length = v_length(a);
    return length > 0 && length <= 3.4e38f ? v_scale(a, 1.0f / length) : a;
}

/* r = 2 n (n.v) - v: the direction in which a mirror of normal n, seen from v, looks. */
static inline ncr_vec3 v_reflect(ncr_vec3 n, ncr_vec3 v)
{
    const float k = 2.0f * v_dot(n, v);
    return (ncr_vec3){k * n.x - v.x, k * n.y - v.y, k * n.z - v.z};
}

static inline double d_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void d_cross(const double a[3], const double b[3], double out[3])
{
    const double x = a[1] * b[2] - a[2] * b[1];
    const double y = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
}

static inline void d_sub(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* out = a + s b */
static inline void d_mad(const double a[3], double s, const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] + s * b[k];
}

static inline double d_length(const double a[3])
{
    return sqrt(d_dot(a, a));
}

/* Scale to unit length in place; false, and unchanged, when the length is zero or not finite. */
static inline bool d_normalize(double a[3])
{
    const double length = d_length(a);
    if (!(length > 0) || !(length <= 1.7e308))
        return false;
    for (int k = 0; k < 3; k++)
        a[k] /= length;
    return true;
}

static inline ncr_vec3 d_to_v(const double a[3])
{
    return (ncr_vec3){(float)a[0], (float)a[1], (float)a[2]};
}

static inline void v_to_d(ncr_vec3 a, double out[3])
{
    out[0] = a.x;
    out[1] = a.y;
    out[2] = a.z;
}

/* Two unit vectors that make a right-handed frame (s, t, n) with the unit vector n, without a
 * branch on which axis is longest and without cancellation at n.z = -1.            [Duff17] */
static inline void v_basis(ncr_vec3 n, ncr_vec3 *s, ncr_vec3 *t)
{
    const float sign = copysignf(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    *s = (ncr_vec3){1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    *t = (ncr_vec3){b, sign + n.y * n.y * a, -n.y};
}

#endif
