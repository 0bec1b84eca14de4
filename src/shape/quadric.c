/* SPDX-License-Identifier: BSD-2-Clause */
/* quadric: a sphere or a disc under any affine transformation. The ray goes to object space, where the shape is simple;
 * t is the same in both spaces because the direction is not normalised. All in double: after a translation by 1e6 an
 * object of size 1 still keeps ten digits.
 *
 * The sphere's discriminant is r^2 - |f|^2, f the ray's closest point to the centre, and not b^2 - ac: the latter
 * cancels when the origin is far away (Haines et al. 2019, "Precision improvements for ray/sphere intersection", Ray
 * Tracing Gems ch. 7). The two roots come from one sum without cancellation and the product of the roots. */
#include "quadric.h"
#include "rounding.h"

#include <float.h>

typedef struct point3 {
    double x, y, z;
} point3;

static point3 transform_point(const double m[4][4], point3 p)
{
    return (point3){m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
                    m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
                    m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
}

static point3 transform_vector(const double m[4][4], vec3 v)
{
    double x = (double)v.x, y = (double)v.y, z = (double)v.z;

    return (point3){m[0][0] * x + m[0][1] * y + m[0][2] * z, m[1][0] * x + m[1][1] * y + m[1][2] * z,
                    m[2][0] * x + m[2][1] * y + m[2][2] * z};
}

static point3 to_double(vec3 v) { return (point3){(double)v.x, (double)v.y, (double)v.z}; }
static double dot_points(point3 a, point3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* sum_k |m[i][k]| v_k (+ |m[i][3]|): how large the terms of m's row i are. */
static double row_size(const double m[4][4], int i, point3 v)
{
    return fabs(m[i][0]) * v.x + fabs(m[i][1]) * v.y + fabs(m[i][2]) * v.z;
}

/* Both roots of the sphere's quadratic, ascending; false without real ones. */
static bool sphere_roots(const bis_quadric *q, point3 o, point3 d, double t[2])
{
    double a = dot_points(d, d), b = -dot_points(o, d) / a;
    point3 f = {o.x + b * d.x, o.y + b * d.y, o.z + b * d.z};
    double discriminant = q->radius * q->radius - dot_points(f, f);

    if (!(discriminant >= 0)) return false;
    double distance = sqrt(dot_points(o, o));
    double c = (distance - q->radius) * (distance + q->radius);
    double k = a * b + copysign(sqrt(a * discriminant), b);
    if (k == 0) return false; /* touches at t = 0, which is no hit */
    t[0] = fmin(c / k, k / a);
    t[1] = fmax(c / k, k / a);
    return true;
}

static bool disk_root(const bis_quadric *q, point3 o, point3 d, double *t)
{
    if (d.z == 0) return false;
    *t = (q->height - o.z) / d.z;
    double x = o.x + *t * d.x, y = o.y + *t * d.y;
    return x * x + y * y <= q->radius * q->radius;
}

bool bis_quadric_intersect(const bis_quadric *q, const ray *r, float *t)
{
    const point3 o = transform_point(q->to_world.inv, to_double(r->o));
    const point3 d = transform_vector(q->to_world.inv, r->d);
    double root[2];
    int n;

    if (q->kind == BIS_SPHERE) n = sphere_roots(q, o, d, root) ? 2 : 0;
    else n = disk_root(q, o, d, root) ? 1 : 0;
    for (int i = 0; i < n; i++) {
        if (!(root[i] > 0 && root[i] < (double)r->tmax)) continue;
        *t = (float)root[i];
        if (*t > 0 && *t < r->tmax) return true;
    }
    return false;
}

/* The half extent of r (m_i0 x + m_i1 y + m_i2 z) over the unit sphere is r |row i| (Cauchy and Schwarz), and over the
 * unit disc r |(m_i0, m_i1)|. Widened by a bound of the double arithmetic, 2^-50 of all terms. */
bis_box bis_quadric_bounds(const bis_quadric *q)
{
    double lo[3], hi[3];

    for (int i = 0; i < 3; i++) {
        const double *row = q->to_world.m[i];
        bool sphere = q->kind == BIS_SPHERE;
        double centre = row[3] + (sphere ? 0 : row[2] * q->height);
        double half = q->radius * sqrt(row[0] * row[0] + row[1] * row[1] + (sphere ? row[2] * row[2] : 0));
        double slack = 0x1p-50 * (fabs(row[3]) + fabs(row[2] * q->height) + half);
        lo[i] = centre - half - slack;
        hi[i] = centre + half + slack;
    }
    for (int i = 0; i < 3; i++) {
        /* Beyond float the box is infinite, which the geometry refuses; the conversion itself would be undefined. */
        if (!(lo[i] > -(double)FLT_MAX)) lo[i] = -(double)INFINITY;
        if (!(hi[i] < (double)FLT_MAX)) hi[i] = (double)INFINITY;
    }
    return (bis_box){{round_down(lo[0]), round_down(lo[1]), round_down(lo[2])},
                     {round_up(hi[0]), round_up(hi[1]), round_up(hi[2])}};
}

/* In object space the box becomes a slanted one; its own axis-parallel box decides. */
bool bis_quadric_may_touch(const bis_quadric *q, const double centre[3], const double half[3])
{
    const double (*inv)[4] = q->to_world.inv;
    const point3 c = {centre[0], centre[1], centre[2]}, h = {half[0], half[1], half[2]};
    const point3 abs_c = {fabs(c.x), fabs(c.y), fabs(c.z)};
    const point3 o = transform_point(inv, c);
    const double at[3] = {fabs(o.x), fabs(o.y), q->kind == BIS_SPHERE ? fabs(o.z) : fabs(o.z - q->height)};
    double near[3], far[3];

    for (int i = 0; i < 3; i++) {
        double rounding = 0x1p-48 * (row_size(inv, i, abs_c) + fabs(inv[i][3]) + fabs(q->height));
        double extent = row_size(inv, i, h) + rounding;
        near[i] = fmax(0, at[i] - extent);
        far[i] = at[i] + extent;
    }
    double near2 = near[0] * near[0] + near[1] * near[1], r2 = q->radius * q->radius;
    if (q->kind == BIS_DISK) return near[2] == 0 && near2 * (1 - 0x1p-48) <= r2;
    near2 += near[2] * near[2];
    return near2 * (1 - 0x1p-48) <= r2 && r2 * (1 - 0x1p-48) <= far[0] * far[0] + far[1] * far[1] + far[2] * far[2];
}

/* The object-space hit, put onto the shape: a sphere's point is scaled to the radius, a disc's has z = height. */
static point3 object_hit(const bis_quadric *q, const ray *r, point3 *normal)
{
    const point3 o = transform_point(q->to_world.inv, to_double(r->o));
    const point3 d = transform_vector(q->to_world.inv, r->d);
    double root[2] = {0, 0};

    if (q->kind == BIS_DISK) {
        disk_root(q, o, d, root);
        *normal = (point3){0, 0, 1};
        return (point3){o.x + root[0] * d.x, o.y + root[0] * d.y, q->height};
    }
    sphere_roots(q, o, d, root);
    double t = (float)root[0] > 0 ? root[0] : root[1];
    point3 p = {o.x + t * d.x, o.y + t * d.y, o.z + t * d.z};
    double scale = q->radius / sqrt(dot_points(p, p));
    *normal = p;
    return (point3){p.x * scale, p.y * scale, p.z * scale};
}

/* A bound from below of a transformed sphere's smallest radius of curvature, a_min^2 / a_max for semi-axes a: singular
 * values are bounded by Frobenius norms. */
static double curvature_radius(const bis_quadric *q)
{
    double m = 0, inv = 0;

    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            m += q->to_world.m[i][j] * q->to_world.m[i][j];
            inv += q->to_world.inv[i][j] * q->to_world.inv[i][j];
        }
    }
    return q->radius / (inv * sqrt(m));
}

/* p_error has three parts:
 * - rounding of p to float: half an ulp, at most 2^-24 |p|, or half the smallest denormal;
 * - the double arithmetic there (p from object space) and back (a shadow ray's origin to object space): each of the two
 *   sums has 4 terms and their products, so 8 roundings of 2^-53 of the sum of sizes would do; 2^-48 is 4 times that;
 * - on a sphere a tangential error tau also changes the distance to the surface, seen from inside by tau^2 / 2R at
 *   first order. Where tau reaches R, floats do not resolve the sphere: tau^2 / R is then cut to tau. */
void bis_quadric_surface(const bis_quadric *q, const ray *r, bis_surface *s)
{
    point3 no;
    const point3 po = object_hit(q, r, &no);
    const point3 p = transform_point(q->to_world.m, po);
    const double (*inv)[4] = q->to_world.inv;
    const double n[3] = {inv[0][0] * no.x + inv[1][0] * no.y + inv[2][0] * no.z,
                         inv[0][1] * no.x + inv[1][1] * no.y + inv[2][1] * no.z,
                         inv[0][2] * no.x + inv[1][2] * no.y + inv[2][2] * no.z};
    double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    double side = n[0] * (double)r->d.x + n[1] * (double)r->d.y + n[2] * (double)r->d.z > 0 ? -1 : 1;
    const double at[3] = {p.x, p.y, p.z};
    const point3 abs_p = {fabs(p.x), fabs(p.y), fabs(p.z)};
    const point3 terms = {row_size(inv, 0, abs_p) + fabs(inv[0][3]), row_size(inv, 1, abs_p) + fabs(inv[1][3]),
                          row_size(inv, 2, abs_p) + fabs(inv[2][3])};
    double e[3], tau2 = 0;

    for (int i = 0; i < 3; i++) {
        double size_of_terms = row_size(q->to_world.m, i, terms) + fabs(q->to_world.m[i][3]);
        e[i] = 0x1p-24 * fabs(at[i]) + 0.5 * (double)FLT_TRUE_MIN + 0x1p-48 * size_of_terms;
        tau2 += e[i] * e[i];
    }
    s->p = vec3_from(p.x, p.y, p.z);
    s->ng = vec3_from(side * n[0] / size, side * n[1] / size, side * n[2] / size);
    s->n = s->ng;
    double bulge = q->kind == BIS_SPHERE ? fmin(tau2 / curvature_radius(q), sqrt(tau2)) : 0;
    s->p_error = (vec3){round_up(e[0] + bulge * fabs((double)s->ng.x)), round_up(e[1] + bulge * fabs((double)s->ng.y)),
                        round_up(e[2] + bulge * fabs((double)s->ng.z))};
    s->material = q->material;
}

void bis_quadric_uv(const bis_quadric *q, const ray *r, double uv[2])
{
    point3 n;
    const point3 p = object_hit(q, r, &n);
    const double across = sqrt(p.x * p.x + p.y * p.y), phi = atan2(p.y, p.x);

    uv[0] = (phi < 0 ? phi + 2 * PI : phi) * (INV_PI / 2);
    uv[1] = q->kind == BIS_SPHERE ? 1 - atan2(across, p.z) * INV_PI : 1 - across / q->radius;
}

/* The derivatives by u = phi/2pi and v (bis_geometry_uv): v of a sphere rises from its lowest point by theta/pi, v of a
 * disc falls from 1 in its middle. The normal is (to_world)^-T that of the object. At a pole and in a disc's middle phi
 * is 0. */
void bis_quadric_tangents(const bis_quadric *q, const ray *r, bis_tangents *t)
{
    point3 n;
    const point3 p = object_hit(q, r, &n);
    const double across = sqrt(p.x * p.x + p.y * p.y);
    const double cosine = across > 0 ? p.x / across : 1, sine = across > 0 ? p.y / across : 0;
    const double u[3] = {-2 * PI * p.y, 2 * PI * p.x, 0}, disc[3] = {-q->radius * cosine, -q->radius * sine, 0};
    const double sphere[3] = {-PI * p.z * cosine, -PI * p.z * sine, PI * across};
    const double *v = q->kind == BIS_SPHERE ? sphere : disc;
    double size = 0;

    t->is_arbitrary = false;
    for (int i = 0; i < 3; i++) {
        const double *m = q->to_world.m[i];
        t->u[i] = m[0] * u[0] + m[1] * u[1];
        t->v[i] = m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
        t->outside[i] = q->to_world.inv[0][i] * n.x + q->to_world.inv[1][i] * n.y + q->to_world.inv[2][i] * n.z;
        size += t->outside[i] * t->outside[i];
    }
    for (int i = 0; i < 3; i++) t->outside[i] /= sqrt(size);
}
