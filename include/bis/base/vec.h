/* SPDX-License-Identifier: BSD-2-Clause */
/* vec: vectors, colours, rays and frames. These types and their functions have no `bis_` prefix, so that formulas
 * read like mathematics. All functions are static inline.
 *
 * Components are floats, because meshes and maps hold floats. Every scalar that is computed from them (dot, length,
 * cosines) is a double. The product of two floats is exact in double, so dot() has an error of at most 1 ulp of its
 * largest term. */
#pragma once

#include <math.h>
#include <stdbool.h>

#define PI 3.14159265358979323846
#define INV_PI 0.31830988618379067154

typedef struct vec3 {
    float x, y, z;
} vec3;

/* Linear radiance or reflectance with the primaries of Rec. 709. */
typedef struct rgb {
    float r, g, b;
} rgb;

/* The ray o + t d with 0 < t < tmax. The accelerators accept any length of d; everywhere else in bis d is unit. */
typedef struct ray {
    vec3 o, d;
    float tmax;
} ray;

/* An orthonormal basis. z is its axis: a normal, or the axis of a lobe. */
typedef struct frame {
    vec3 x, y, z;
} frame;

/* vec3_from rounds three doubles to a vector. add, sub, neg, mul, dot, cross and length are the usual operations. */
static inline vec3 vec3_from(double x, double y, double z) { return (vec3){(float)x, (float)y, (float)z}; }
static inline vec3 add(vec3 a, vec3 b) { return (vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline vec3 sub(vec3 a, vec3 b) { return (vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline vec3 neg(vec3 a) { return (vec3){-a.x, -a.y, -a.z}; }
static inline vec3 mul(vec3 a, double s)
{
    return vec3_from((double)a.x * s, (double)a.y * s, (double)a.z * s);
}
static inline double dot(vec3 a, vec3 b)
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z;
}
static inline vec3 cross(vec3 a, vec3 b)
{
    return vec3_from((double)a.y * (double)b.z - (double)a.z * (double)b.y,
                     (double)a.z * (double)b.x - (double)a.x * (double)b.z,
                     (double)a.x * (double)b.y - (double)a.y * (double)b.x);
}
static inline double length(vec3 a) { return sqrt(dot(a, a)); }

/* dot3 is the dot product of vectors of doubles. */
static inline double dot3(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* cross3 stores a x b in out, which is neither of them. */
static inline void cross3(double out[3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* normalize returns a / |a|. |a| must not be 0: a division by 0 is a defect of the caller. */
static inline vec3 normalize(vec3 a) { return mul(a, 1 / length(a)); }
static inline bool vec3_is_finite(vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

/* rgb_from rounds three doubles to a colour. rgb_add, rgb_mul and rgb_scale work per channel. */
static inline rgb rgb_from(double r, double g, double b) { return (rgb){(float)r, (float)g, (float)b}; }
static inline rgb rgb_add(rgb a, rgb b) { return (rgb){a.r + b.r, a.g + b.g, a.b + b.b}; }
static inline rgb rgb_mul(rgb a, rgb b) { return (rgb){a.r * b.r, a.g * b.g, a.b * b.b}; }
static inline rgb rgb_scale(rgb a, double s)
{
    return rgb_from((double)a.r * s, (double)a.g * s, (double)a.b * s);
}
/* rgb_sum returns the intensity of thesis 3.3: r + g + b. It adds in double, because three floats near FLT_MAX would
 * overflow. */
static inline double rgb_sum(rgb a) { return (double)a.r + (double)a.g + (double)a.b; }

/* rgb_max returns the largest channel. rgb_is_black and rgb_is_finite ask whether all channels are 0, and finite. */
static inline double rgb_max(rgb a) { return fmax((double)a.r, fmax((double)a.g, (double)a.b)); }
static inline bool rgb_is_black(rgb a) { return a.r == 0 && a.g == 0 && a.b == 0; }
static inline bool rgb_is_finite(rgb a) { return isfinite(a.r) && isfinite(a.g) && isfinite(a.b); }

/* RGB in double, for sums over samples and for products that a float cannot hold, like f Le / q with Le = 3e38. */
typedef struct rgbd {
    double r, g, b;
} rgbd;

/* rgbd_add, rgbd_scale and rgbd_sum work as their namesakes for rgb. rgbd_round rounds to floats. */
static inline rgbd rgbd_add(rgbd a, rgbd b) { return (rgbd){a.r + b.r, a.g + b.g, a.b + b.b}; }
static inline rgbd rgbd_scale(rgbd a, double s) { return (rgbd){a.r * s, a.g * s, a.b * s}; }
static inline double rgbd_sum(rgbd a) { return a.r + a.g + a.b; }
static inline rgb rgbd_round(rgbd a) { return rgb_from(a.r, a.g, a.b); }

/* frame_about returns a basis whose z axis is the unit vector z. It has no branch for near-parallel vectors. Source:
 * Duff et al. 2017, "Building an Orthonormal Basis, Revisited" (JCGT 6(1)). The error in float is below 1e-6
 * everywhere, -z included. */
static inline frame frame_about(vec3 z)
{
    double sign = copysign(1.0, (double)z.z);
    double a = -1.0 / (sign + (double)z.z);
    double b = (double)z.x * (double)z.y * a;
    return (frame){vec3_from(1 + sign * (double)z.x * (double)z.x * a, sign * b, -sign * (double)z.x),
                   vec3_from(b, sign + (double)z.y * (double)z.y * a, -(double)z.y), z};
}

/* to_local returns the coordinates of the world vector w in the frame f; to_world is its inverse. */
static inline vec3 to_local(const frame *f, vec3 w) { return vec3_from(dot(w, f->x), dot(w, f->y), dot(w, f->z)); }
static inline vec3 to_world(const frame *f, vec3 w)
{
    return vec3_from((double)w.x * (double)f->x.x + (double)w.y * (double)f->y.x + (double)w.z * (double)f->z.x,
                     (double)w.x * (double)f->x.y + (double)w.y * (double)f->y.y + (double)w.z * (double)f->z.y,
                     (double)w.x * (double)f->x.z + (double)w.y * (double)f->y.z + (double)w.z * (double)f->z.z);
}
