/* SPDX-License-Identifier: BSD-2-Clause */
/* surface: the point, its error and its normals where a ray meets a primitive, and where a shadow ray may start.
 *
 * The accelerators say only which primitive was hit; everything else is computed again, here, in double, from the ray
 * and the original vertices. So the picture does not depend on the accelerator, and the point's error is that of a
 * single rounding to float, 2^-24 of its coordinates, whatever the distance that the ray came from.
 * Idea of the offset: Wächter and Binder 2019 and pbrt-v4 ("OffsetRayOrigin"): leave the surface by the bound of the
 * point's own error, not by a constant epsilon (docs/errata.md E37). */
#include "bis/shape/geometry.h"

#include "quadric.h"
#include "rounding.h"
#include "triangle.h"

#include <float.h>

/* The weights b of the vertices where r meets the triangle: b >= 0, sum b = 1.
 *
 * Outside, by rounding: Embree finds hits in float, some of which lie outside an edge by 1e-7 of the distance. Such
 * a weight is set to 0, which moves the point to the edge. Edge-on to 1e-16, where no weights exist: any point of the
 * triangle is as good as another. */
static void weights(const vec3 v[3], const ray *r, double b[3])
{
    const float flat[9] = {v[0].x, v[0].y, v[0].z, v[1].x, v[1].y, v[1].z, v[2].x, v[2].y, v[2].z};
    const sheared_ray sheared = shear_ray(r);
    double det, z, sum = 0;

    shear_test(&sheared, flat, b, &det, &z);
    double sign = b[0] + b[1] + b[2] < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        b[i] = larger(0, sign * b[i]);
        sum += b[i];
    }
    const double scale = 1 / (sum > 0 ? sum : 1);
    for (int i = 0; i < 3; i++) b[i] = sum > 0 ? b[i] * scale : 1.0 / 3;
}

/* p_error, per component c. The true p is the point of the triangle with exactly the weights b. A shadow ray that
 * starts beyond p_error must be on the outer side of the plane for every test that it can meet. All of them ask the
 * same, the sign of t = T / (d.n) with T = a.n, a = v_0 - o, n = e x f, e = v_1 - v_0, f = v_2 - v_0: the grids in
 * double (plane_is_ahead; the packed one's floats only rule out by weights), Embree in float, for one ray, packets
 * and streams alike (its watertight test, RTC_SCENE_FLAG_ROBUST). T's sign is what the start decides. That of d.n is
 * lost in a tilted plane for directions within the error of n, some 8 u |e||f| / |n| radians, as it is in ng, which
 * is rounded; no start helps there, and of the light they bring the square of that angle. The parts:
 * - rounding p to float costs half an ulp, at most 2^-24 |p_c|, or half the smallest denormal;
 * - sum b_i v_ic in double: 3 products, 2 sums, sum b = 1 within 4 roundings: at most 9 * 2^-53 max |v_ic|; 2^-48 max
 *   |v_ic| is 3 times that;
 * - T. Let u be the unit of rounding and t_a = sum_c |a_c n_c| / |n|. It is a distance along ng that errs:
 *   . a vertex less the origin errs by u of itself: at most u extent_c along c, and the plane moves with its vertices,
 *     by at most u tilt, tilt = sum_c |n_c| extent_c / |n|;
 *   . e and f are rounded once and multiplied: 3 u sums, sums = sum_c |a_c| (|e||f| terms of n_c) / |n|;
 *   . the difference that makes n_c, the product with a_c, two sums: 4 u t_a.
 *   t_a is below both tilt and sums. So tilt + 3 sums + 4 t_a <= 2 tilt + 6 sums, and u (2 tilt + 6 sums) is taken,
 *   with Embree's u = 2^-24; double's is 2^-53. Embree may take n_c from another pair of edges, where its products
 *   are smaller; |n_c| + 2 such a product bound these, so that 6 t_a could come on top if all roundings had one sign.
 *   Measured over 4e7 rays it needs at most 0.21 of the bound.
 * Every part of T is a product with a coordinate difference along an axis and n along the same axis (or the two that
 * make n_c): in a plane across an axis both are 0 or exact, whatever the plane's size and the ray's direction, so that
 * rounding p is the whole error. A test that mixes the axes, as the sheared one does, would need 2^-53 of the size
 * there. For a scan's small triangles T is negligible, but a tilted floor of size 1000 seen at p = (1, 1, 1) needs
 * it. It is a distance along ng, so it enters as distance * |ng_c|. No more than the triangle's largest extent: the
 * plane of a needle for which the bound is longer than that is not known to floats, and the ray shall stay near.
 * Here n is of unit length, and per_size is what it was multiplied by. */
static vec3 triangle_error(const vec3 v[3], vec3 p, const double n[3], double per_size)
{
    const double x[3][3] = {{(double)v[0].x, (double)v[0].y, (double)v[0].z},
                            {(double)v[1].x, (double)v[1].y, (double)v[1].z},
                            {(double)v[2].x, (double)v[2].y, (double)v[2].z}};
    const double at[3] = {(double)p.x, (double)p.y, (double)p.z};
    double e[3], tilt = 0, sums = 0, size = 0;

    for (int c = 0; c < 3; c++) {
        const int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
        double largest = larger(fabs(x[0][c]), larger(fabs(x[1][c]), fabs(x[2][c])));
        double extent = larger(x[0][c], larger(x[1][c], x[2][c])) - smaller(x[0][c], smaller(x[1][c], x[2][c]));
        e[c] = 0x1p-24 * fabs(at[c]) + 0.5 * (double)FLT_TRUE_MIN + 0x1p-48 * largest;
        size = larger(size, extent);
        tilt += fabs(n[c]) * extent;
        sums += fabs(x[0][c] - at[c]) * per_size * (fabs((x[1][c1] - x[0][c1]) * (x[2][c2] - x[0][c2])) +
                                                    fabs((x[1][c2] - x[0][c2]) * (x[2][c1] - x[0][c1])));
    }
    double distance = smaller(0x1p-23 * tilt + 6 * 0x1p-24 * sums, size);
    return (vec3){round_up(e[0] + distance * fabs(n[0])), round_up(e[1] + distance * fabs(n[1])),
                  round_up(e[2] + distance * fabs(n[2]))};
}

/* The interpolated normal. A vertex of normal (0,0,0) has the face's. */
static vec3 shading_normal(const bis_geometry *g, const uint32_t index[3], const double b[3], vec3 face)
{
    double n[3] = {0, 0, 0};

    for (int i = 0; i < 3; i++) {
        vec3 vn = g->n[index[i]];
        if (vn.x == 0 && vn.y == 0 && vn.z == 0) vn = face;
        n[0] += b[i] * (double)vn.x;
        n[1] += b[i] * (double)vn.y;
        n[2] += b[i] * (double)vn.z;
    }
    double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return size > 0 ? vec3_from(n[0] / size, n[1] / size, n[2] / size) : face;
}

/* Ranges ascend: the last one that starts at or before prim. */
static const bis_range *range_of(const bis_geometry *g, uint32_t prim)
{
    size_t lo = 0, hi = g->n_ranges;

    while (hi - lo > 1) {
        size_t mid = lo + (hi - lo) / 2;
        if (g->ranges[mid].first <= prim) {
            lo = mid;
        } else {
            hi = mid;
        }
    }
    return &g->ranges[lo];
}

static void triangle_surface(const bis_geometry *g, uint32_t prim, const ray *r, bis_surface *s)
{
    const uint32_t *index = g->index + 3 * (size_t)prim;
    const vec3 v[3] = {g->p[index[0]], g->p[index[1]], g->p[index[2]]};
    double b[3], n[3];

    weights(v, r, b);
    s->p = vec3_from(b[0] * (double)v[0].x + b[1] * (double)v[1].x + b[2] * (double)v[2].x,
                     b[0] * (double)v[0].y + b[1] * (double)v[1].y + b[2] * (double)v[2].y,
                     b[0] * (double)v[0].z + b[1] * (double)v[1].z + b[2] * (double)v[2].z);
    area_vector(v, n);
    /* > 0: no accelerator reports a triangle without area */
    const double per_size = 1 / sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3; c++) n[c] *= per_size;
    s->p_error = triangle_error(v, s->p, n, per_size);
    const vec3 face = vec3_from(n[0], n[1], n[2]);
    s->n = g->n ? shading_normal(g, index, b, face) : face;
    s->ng = n[0] * (double)r->d.x + n[1] * (double)r->d.y + n[2] * (double)r->d.z > 0 ? neg(face) : face;
    if (dot(s->n, s->ng) < 0) s->n = neg(s->n);
    s->material = range_of(g, prim)->material;
}

void bis_geometry_surface(const bis_geometry *g, uint32_t prim, const ray *r, bis_surface *s)
{
    if (prim < g->n_triangles) {
        triangle_surface(g, prim, r, s);
    } else {
        bis_quadric_surface(&g->quadrics[prim - g->n_triangles], r, s);
    }
}

/* The texture coordinates of a triangle's vertices. */
static void corner_uv(bis_uv corner[3], const bis_geometry *g, const uint32_t index[3])
{
    static const bis_uv usual[3] = {{0, 0}, {1, 0}, {1, 1}}; /* pbrt's, of a triangle without any */
    const bool has = g->uv && !isnan(g->uv[index[0]].u) && !isnan(g->uv[index[1]].u) && !isnan(g->uv[index[2]].u);

    for (int i = 0; i < 3; i++) corner[i] = has ? g->uv[index[i]] : usual[i];
}

void bis_geometry_uv(const bis_geometry *g, uint32_t prim, const ray *r, double uv[2])
{
    bis_uv corner[3];
    double b[3];

    if (prim >= g->n_triangles) {
        bis_quadric_uv(&g->quadrics[prim - g->n_triangles], r, uv);
        return;
    }
    const uint32_t *index = g->index + 3 * (size_t)prim;
    const vec3 v[3] = {g->p[index[0]], g->p[index[1]], g->p[index[2]]};
    corner_uv(corner, g, index);
    weights(v, r, b);
    uv[0] = b[0] * (double)corner[0].u + b[1] * (double)corner[1].u + b[2] * (double)corner[2].u;
    uv[1] = b[0] * (double)corner[0].v + b[1] * (double)corner[1].v + b[2] * (double)corner[2].v;
}

/* Two unit vectors that n completes. */
static void any_tangents(bis_tangents *t, const double n[3])
{
    const int c = fabs(n[0]) > fabs(n[1]) ? 0 : 1, z = 2; /* the longer of the first two parts, and the third */
    const double size = hypot(n[c], n[z]);

    for (int i = 0; i < 3; i++) t->u[i] = 0;
    t->u[c] = n[z] / size;
    t->u[z] = -n[c] / size;
    cross3(t->v, n, t->u);
}

/* p is linear in (u, v): its derivatives solve two equations for two edges. */
static void triangle_tangents(const bis_geometry *g, uint32_t prim, const ray *r, bis_tangents *t)
{
    const uint32_t *index = g->index + 3 * (size_t)prim;
    const vec3 p[3] = {g->p[index[0]], g->p[index[1]], g->p[index[2]]};
    bis_uv c[3];
    double n[3], b[3], e[2][3], d[2][2];

    corner_uv(c, g, index);
    for (int k = 0; k < 2; k++) {
        e[k][0] = (double)p[k + 1].x - (double)p[0].x;
        e[k][1] = (double)p[k + 1].y - (double)p[0].y;
        e[k][2] = (double)p[k + 1].z - (double)p[0].z;
        d[k][0] = (double)c[k + 1].u - (double)c[0].u;
        d[k][1] = (double)c[k + 1].v - (double)c[0].v;
    }
    area_vector(p, n);
    const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), det = d[0][0] * d[1][1] - d[0][1] * d[1][0];
    weights(p, r, b);
    vec3 side = vec3_from(n[0] / size, n[1] / size, n[2] / size);
    if (range_of(g, prim)->mirrored) side = neg(side);
    if (g->n) side = shading_normal(g, index, b, side);
    t->outside[0] = (double)side.x;
    t->outside[1] = (double)side.y;
    t->outside[2] = (double)side.z;
    const double scale = det != 0 ? 1 / det : HUGE_VAL;
    t->is_arbitrary = !isfinite(scale);
    if (t->is_arbitrary) {
        any_tangents(t, t->outside);
        return;
    }
    for (int i = 0; i < 3; i++) {
        t->u[i] = (d[1][1] * e[0][i] - d[0][1] * e[1][i]) * scale;
        t->v[i] = (d[0][0] * e[1][i] - d[1][0] * e[0][i]) * scale;
    }
}

void bis_geometry_tangents(const bis_geometry *g, uint32_t prim, const ray *r, bis_tangents *t)
{
    if (prim < g->n_triangles) triangle_tangents(g, prim, r, t);
    else bis_quadric_tangents(&g->quadrics[prim - g->n_triangles], r, t);
}

/* p + step, rounded away from p. */
static float move_away(float p, double step)
{
    const double exact = (double)p + step;

    return step > 0 ? round_up(exact) : round_down(exact);
}

/* True p lies within p_error of p, so in the direction ng at most sum_c |ng_c| p_error_c before it. ng itself is
 * rounded: its direction errs by 2^-24 sqrt(3), its length likewise; 1 + 2^-20 pays for both. */
vec3 bis_surface_offset(const bis_surface *s)
{
    const double n[3] = {(double)s->ng.x, (double)s->ng.y, (double)s->ng.z};
    double step = (1 + 0x1p-20) * (fabs(n[0]) * (double)s->p_error.x + fabs(n[1]) * (double)s->p_error.y +
                                   fabs(n[2]) * (double)s->p_error.z);

    return (vec3){move_away(s->p.x, step * n[0]), move_away(s->p.y, step * n[1]), move_away(s->p.z, step * n[2])};
}
