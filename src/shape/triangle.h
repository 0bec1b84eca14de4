/* SPDX-License-Identifier: BSD-2-Clause */
/* triangle: what every road to a triangle must do alike: grid, Embree and the surface at a hit. Private to row 3.
 *
 * The ray/triangle test is the watertight one of Woop, Benthin and Wald 2013 ("Watertight Ray/Triangle Intersection",
 * JCGT 2(1)), in double. The vertices are moved to the ray's origin and sheared so that the ray becomes the z axis; an
 * edge function is then one 2x2 determinant. Why no hit can slip between two triangles that share an edge:
 * - a vertex goes to the same rounded point (x, y) in all its triangles;
 * - the determinant a - b of two rounded products has never the wrong sign: rounding is monotone, so exact a > b
 *   gives fl(a) >= fl(b). At worst it is 0, and 0 counts as inside on both sides of the edge.
 * No fallback for doubtful signs is needed. In double a hit's relative error is some 1e-15 instead of 1e-7, far below
 * what the float vertices mean.
 *
 * Where a ray starts beside a triangle, the sign of t is a question of its own: on which side of the plane is the
 * origin? The sheared coordinates mix the axes, so they answer it with an error of 2^-53 of the triangle's size,
 * whatever the plane. The plane's equation does not mix them: its error along an axis is a share of what the triangle
 * measures along that axis, and 0 for a plane across an axis. So it is asked, too, but only where the triangle begins
 * behind the origin: elsewhere every point of it lies ahead. */
#pragma once

#include "bis/base/vec.h"

/* gcc keeps a*b - c*d as written under -std=c11; clang must be told: a fused a*b would undo the argument above. */
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif

/* A ray made ready for many triangles. Axes kx, ky, kz: kz is d's largest component. */
typedef struct sheared_ray {
    double o[3];
    double sx, sy, sz;
    int kx, ky, kz;
} sheared_ray;

/* shear_ray makes a ray ready. */
static inline sheared_ray shear_ray(const ray *r)
{
    const double d[3] = {(double)r->d.x, (double)r->d.y, (double)r->d.z};
    int kz = fabs(d[0]) > fabs(d[1]) ? (fabs(d[0]) > fabs(d[2]) ? 0 : 2) : (fabs(d[1]) > fabs(d[2]) ? 1 : 2);
    int kx = kz == 2 ? 0 : kz + 1;
    int ky = kx == 2 ? 0 : kx + 1;
    return (sheared_ray){{(double)r->o.x, (double)r->o.y, (double)r->o.z},
                         d[kx] / d[kz], d[ky] / d[kz], 1 / d[kz], kx, ky, kz};
}

/* shear_test returns whether the line meets the triangle v[9] = a, b, c. Then e[3] are a, b and c's weights times det
 * (all of one sign, or 0), *z the ray parameter times det. A triangle seen edge-on (det = 0) is not met. */
static inline __attribute__((always_inline)) bool shear_test(const sheared_ray *s, const float v[9], double e[3],
                                                             double *det, double *z)
{
    double az = (double)v[s->kz] - s->o[s->kz];
    double bz = (double)v[3 + s->kz] - s->o[s->kz];
    double cz = (double)v[6 + s->kz] - s->o[s->kz];
    double ax = (double)v[s->kx] - s->o[s->kx] - s->sx * az;
    double bx = (double)v[3 + s->kx] - s->o[s->kx] - s->sx * bz;
    double cx = (double)v[6 + s->kx] - s->o[s->kx] - s->sx * cz;
    double ay = (double)v[s->ky] - s->o[s->ky] - s->sy * az;
    double by = (double)v[3 + s->ky] - s->o[s->ky] - s->sy * bz;
    double cy = (double)v[6 + s->ky] - s->o[s->ky] - s->sy * cz;

    e[0] = cx * by - cy * bx;
    e[1] = ax * cy - ay * cx;
    e[2] = bx * ay - by * ax;
    const double least = e[0] < e[1] ? (e[0] < e[2] ? e[0] : e[2]) : (e[1] < e[2] ? e[1] : e[2]);
    const double most = e[0] > e[1] ? (e[0] > e[2] ? e[0] : e[2]) : (e[1] > e[2] ? e[1] : e[2]);
    if (least < 0 && most > 0) return false;
    *det = e[0] + e[1] + e[2];
    *z = s->sz * (e[0] * az + e[1] * bz + e[2] * cz);
    return *det != 0;
}

/* area_vector stores twice the area vector. In double no float triangle overflows or underflows here. */
static inline void area_vector(const vec3 v[3], double n[3])
{
    double e[3] = {(double)v[1].x - (double)v[0].x, (double)v[1].y - (double)v[0].y, (double)v[1].z - (double)v[0].z};
    double f[3] = {(double)v[2].x - (double)v[0].x, (double)v[2].y - (double)v[0].y, (double)v[2].z - (double)v[0].z};

    n[0] = e[1] * f[2] - e[2] * f[1];
    n[1] = e[2] * f[0] - e[0] * f[2];
    n[2] = e[0] * f[1] - e[1] * f[0];
}

/* plane_is_ahead returns whether the ray r meets the plane of triangle v[9] at a t > 0, by the sign of a.n / d.n, a =
 * v0 - o, n = (v1 - v0) x (v2 - v0). Its error is bounded in surface.c (triangle_error); a plane across an axis has
 * none. */
static inline bool plane_is_ahead(const ray *r, const float v[9])
{
    const double a[3] = {(double)v[0] - (double)r->o.x, (double)v[1] - (double)r->o.y, (double)v[2] - (double)r->o.z};
    double n[3];

    area_vector((const vec3[3]){{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}}, n);
    const double height = a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
    const double descent = n[0] * (double)r->d.x + n[1] * (double)r->d.y + n[2] * (double)r->d.z;
    return (height > 0 && descent > 0) || (height < 0 && descent < 0);
}

/* all_ahead returns whether all vertices of v[9] lie ahead of the origin, along the axis kz. */
static inline bool all_ahead(const sheared_ray *s, const float v[9])
{
    const double a = (double)v[s->kz] - s->o[s->kz], b = (double)v[3 + s->kz] - s->o[s->kz],
                 c = (double)v[6 + s->kz] - s->o[s->kz];

    return s->sz > 0 ? a > 0 && b > 0 && c > 0 : a < 0 && b < 0 && c < 0;
}

/* shear_hit returns whether the ray meets triangle v at a t in (0, best] whose float lies in (0, tmax). s: the ray r,
 * sheared. */
static inline __attribute__((always_inline)) bool shear_hit(const sheared_ray *s, const ray *r, const float v[9],
                                                            double best, double *t)
{
    double e[3], det, z;
    float rounded;

    if (!shear_test(s, v, e, &det, &z)) return false;
    *t = z / det;
    if (!(*t > 0 && *t <= best)) return false;
    rounded = (float)*t;
    if (!(rounded > 0 && rounded < r->tmax)) return false;
    return all_ahead(s, v) || plane_is_ahead(r, v);
}

/* has_area returns whether a triangle has an area. Without one it is never hit, whichever the accelerator. */
static inline bool has_area(const vec3 v[3])
{
    double n[3];

    area_vector(v, n);
    return n[0] != 0 || n[1] != 0 || n[2] != 0;
}
