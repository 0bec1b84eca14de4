/* SPDX-License-Identifier: BSD-2-Clause */
/* grid_block: eight triangles against a ray at a time. Private to the grid.
 *
 * A block holds the vertices of eight triangles, coordinate by coordinate. `may_meet` tests all eight in float, in a
 * loop that the compiler turns into vector instructions, and rules out those that the ray cannot meet. shear_hit
 * (triangle.h) decides about the others in double, so a block never changes an answer. Most blocks cost the float
 * test only. */
#pragma once

#include "bis/base/clones.h"
#include "grid.h"
#include "rounding.h"
#include "triangle.h"

#include <float.h>

/* The ray in float, as may_meet needs it. */
typedef struct near_ray {
    float p[3];   /* a point of the ray near the block: float has many digits for short distances */
    float sx, sy; /* the slopes of sheared_ray */
    float wrong;  /* w of near_ray_of */
    int kx, ky, kz;
} near_ray;

/* near_ray_of returns the ray s with p at its origin, and w. w bounds two errors, both along the sheared x and y:
 * - p lies beside the ray, because it is rounded to float: by u b, where u = 2^-24 and b is the largest coordinate of
 *   the box; and it comes from 4 roundings in double of lengths up to b + o, where o is the largest coordinate of the
 *   ray's origin. At the origin p is exact, because the origin is a float.
 * - shear_test's own coordinates come from 5 roundings in double of lengths up to b + o.
 * In all u b + 9 * 2^-53 (b + o). Nearly twice as much is taken, because p may lie some ulps outside of the box. */
static inline BIS_INLINE near_ray near_ray_of(const bis_grid *g, const sheared_ray *s)
{
    double box = 0, o = 0;

    for (int a = 0; a < 3; a++) {
        box = larger(box, larger(fabs(g->lo[a]), fabs(g->hi[a])));
        o = larger(o, fabs(s->o[a]));
    }
    return (near_ray){{(float)s->o[0], (float)s->o[1], (float)s->o[2]}, (float)s->sx, (float)s->sy,
                      (float)(0x1p-23 * box + 0x1p-49 * (box + o)), s->kx, s->ky, s->kz};
}

/* near_move moves p to the ray's parameter t, which must be 0 or lie in the grid's box; dz is component kz of the ray's
 * direction. */
static inline BIS_INLINE void near_move(near_ray *near, const sheared_ray *s, double dz, double t)
{
    const int kx = near->kx, ky = near->ky, kz = near->kz;

    near->p[kz] = (float)(s->o[kz] + t * dz);
    const double z = (double)near->p[kz] - s->o[kz];
    near->p[kx] = (float)(s->o[kx] + s->sx * z);
    near->p[ky] = (float)(s->o[ky] + s->sy * z);
}

/* may_meet returns a mask: bit k is 0 only if shear_test says that the ray does not meet triangle k of the block v.
 * reach: no vertex of the block is farther from its first one, along any axis.
 *
 * shear_test says no if it finds weights of both signs. The loop below computes the same weights in float; a weight
 * in float that is farther from 0 than e has the sign of shear_test's. So a triangle with weights below -e and above
 * e is ruled out. Why e = 10 M w + 72 u M^2 is enough, where M is the largest |v - p| along an axis; |sx|, |sy| <= 1:
 * 1. A coordinate x - px - sx (z - pz) is at most 2M. Its roundings: of x - px, u M; of sx, of z - pz and of their
 *    product, u M each; of the last difference, 2u M. With the two errors above it is wrong by c = w + 6u M.
 * 2. A weight is the difference of two products of two such. An error of c in each factor makes each product wrong
 *    by 2M c + (2M + c) c, both by 8M c + 2c^2, which is 8M w + 2w^2 + 48u M^2 but for products of u and c.
 * 3. Its own roundings: of each product, of at most 4M^2, 4u M^2; of the difference 8u M^2. In all 16u M^2.
 * 4. If w <= M then 2w^2 <= 2M w, and the sum is 10M w + 64u M^2. If w > M then e > 10 M^2, and no weight is above
 *    8M^2, so nothing is ruled out.
 * 5. 72 in the place of 64 is for all that is of a higher order: products of two errors above, shear_test's rounding
 *    of its weights (16 * 2^-53 M^2), and the roundings of e and M (9 of them, u each).
 * A search (tests/shape/test_grid_block.c) finds triangles that need 31 u M^2 and 7.7 M w.
 * FLT_MIN is for what underflows: each product then loses up to 2^-150, and 2M times as much by its factors.
 * What overflows: all products are at most 8M^2, so if one is infinite then e is, too, and nothing is ruled out. */
static inline BIS_INLINE unsigned may_meet(const near_ray *r, const bis_grid_block v, float reach)
{
    const float *x = v[r->kx], *y = v[r->ky], *z = v[r->kz];
    const float px = r->p[r->kx], py = r->p[r->ky], pz = r->p[r->kz], sx = r->sx, sy = r->sy;
    const float dx = fabsf(x[0] - px), dy = fabsf(y[0] - py), dz = fabsf(z[0] - pz);
    const float m = (dx > dy ? (dx > dz ? dx : dz) : (dy > dz ? dy : dz)) + reach;
    const float e = 10 * m * r->wrong + 8 * m * m * (9 * 0x1p-24f) + FLT_MIN;
    enum { B = 3 * BIS_GRID_LANES, C = 6 * BIS_GRID_LANES };
    unsigned mask = 0;

#pragma omp simd reduction(| : mask)
    for (int k = 0; k < BIS_GRID_LANES; k++) {
        const float az = z[k] - pz, bz = z[B + k] - pz, cz = z[C + k] - pz;
        const float ax = x[k] - px - sx * az, ay = y[k] - py - sy * az;
        const float bx = x[B + k] - px - sx * bz, by = y[B + k] - py - sy * bz;
        const float cx = x[C + k] - px - sx * cz, cy = y[C + k] - py - sy * cz;
        const float e0 = cx * by - cy * bx, e1 = ax * cy - ay * cx, e2 = bx * ay - by * ax;
        const bool some_less = (e0 < -e) | (e1 < -e) | (e2 < -e), some_more = (e0 > e) | (e1 > e) | (e2 > e);
        mask |= (unsigned)!(some_less & some_more) << k;
    }
    return mask;
}

/* bis_grid_packed_bytes returns what bis_grid_pack will allocate. bis_grid_pack copies the triangles of g's items into
 * blocks. Errors: BIS_NOMEM. */
size_t bis_grid_packed_bytes(size_t n_items);
bis_status bis_grid_pack(bis_grid *g, int n_threads, bis_diag *diag);
