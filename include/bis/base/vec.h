/* vec: the eye sees mathematics. vec3, rgb, ray, frame and their verbs keep the bare names and are static inline.
 *
 * Components are float at rest (what meshes and maps hold); every scalar that is computed from them (dot, length,
 * cosines) is double. Products of two floats are exact in double, so dot() is good to 1 ulp of its largest term. */
#ifndef BIS_VEC_H
#define BIS_VEC_H

#include <math.h>
#include <stdbool.h>

#define PI 3.14159265358979323846
#define INV_PI 0.31830988618379067154

typedef struct vec3 {
    float x, y, z;
} vec3;

/* Linear radiance or reflectance, Rec. 709 primaries. */
typedef struct rgb {
    float r, g, b;
} rgb;

/* o + t d, 0 < t < tmax. d need not be unit for accel; it is everywhere in bis. */
typedef struct ray {
    vec3 o, d;
    float tmax;
} ray;

/* An orthonormal basis; z is the axis (a normal, a lobe's axis). */
typedef struct frame {
    vec3 x, y, z;
} frame;

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

/* a / |a|. |a| must not be 0: dividing by it is a defect of the caller. */
static inline vec3 normalize(vec3 a) { return mul(a, 1 / length(a)); }
static inline bool vec3_is_finite(vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

static inline rgb rgb_from(double r, double g, double b) { return (rgb){(float)r, (float)g, (float)b}; }
static inline rgb rgb_add(rgb a, rgb b) { return (rgb){a.r + b.r, a.g + b.g, a.b + b.b}; }
static inline rgb rgb_mul(rgb a, rgb b) { return (rgb){a.r * b.r, a.g * b.g, a.b * b.b}; }
static inline rgb rgb_scale(rgb a, double s)
{
    return rgb_from((double)a.r * s, (double)a.g * s, (double)a.b * s);
}
/* Intensity, thesis 3.3: r + g + b. In double: three floats near FLT_MAX would overflow. */
static inline double rgb_sum(rgb a) { return (double)a.r + (double)a.g + (double)a.b; }
static inline double rgb_max(rgb a) { return fmax((double)a.r, fmax((double)a.g, (double)a.b)); }
static inline bool rgb_is_black(rgb a) { return a.r == 0 && a.g == 0 && a.b == 0; }
static inline bool rgb_is_finite(rgb a) { return isfinite(a.r) && isfinite(a.g) && isfinite(a.b); }

/* RGB in double, for sums over samples and for products that a float cannot hold: f Le / q with Le = 3e38. */
typedef struct rgbd {
    double r, g, b;
} rgbd;

static inline rgbd rgbd_add(rgbd a, rgbd b) { return (rgbd){a.r + b.r, a.g + b.g, a.b + b.b}; }
static inline rgbd rgbd_scale(rgbd a, double s) { return (rgbd){a.r * s, a.g * s, a.b * s}; }
static inline double rgbd_sum(rgbd a) { return a.r + a.g + a.b; }
static inline rgb rgbd_round(rgbd a) { return rgb_from(a.r, a.g, a.b); }

/* A basis about unit z, without a branch on near-parallel vectors. Source: Duff et al. 2017, "Building an Orthonormal
 * Basis, Revisited" (JCGT 6(1)): error below 1e-6 in float everywhere, -z included. */
static inline frame frame_about(vec3 z)
{
    double sign = copysign(1.0, (double)z.z);
    double a = -1.0 / (sign + (double)z.z);
    double b = (double)z.x * (double)z.y * a;
    return (frame){vec3_from(1 + sign * (double)z.x * (double)z.x * a, sign * b, -sign * (double)z.x),
                   vec3_from(b, sign + (double)z.y * (double)z.y * a, -(double)z.y), z};
}
static inline vec3 to_local(const frame *f, vec3 w) { return vec3_from(dot(w, f->x), dot(w, f->y), dot(w, f->z)); }
static inline vec3 to_world(const frame *f, vec3 w)
{
    return vec3_from((double)w.x * (double)f->x.x + (double)w.y * (double)f->y.x + (double)w.z * (double)f->z.x,
                     (double)w.x * (double)f->x.y + (double)w.y * (double)f->y.y + (double)w.z * (double)f->z.y,
                     (double)w.x * (double)f->x.z + (double)w.y * (double)f->y.z + (double)w.z * (double)f->z.z);
}

#endif
