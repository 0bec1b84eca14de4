/* SPDX-License-Identifier: BSD-2-Clause */
/* portal: uniform directions in the solid angle of a rectangle. Source: Urena, Fajardo, King 2013, "An Area-Preserving
 * Parametrization for Spherical Rectangles".
 *
 * From p the planes through the rectangle's edges have normals whose parts towards the rectangle are the four
 * `cosine`, and its solid angle is a sum of arcs of their products. u1 chooses the arc of a great circle which, with
 * the edge low[0], cuts off the u1-th part of the solid angle; u2 chooses a height on it, of which area is a linear
 * function (Archimedes). Below 1e-8 sr the arcs cancel. There a point of the area A is drawn, at the distance r,
 * with density r^2/(A cos) = z^2/(A cos^3), which is nearly uniform. Cost: 6 ns a direction, 3 ns a density. */
#include "portal.h"

#include "thesis/curve_many.h"

#include <string.h>

static const double SMALL = 1e-8, GRAZING = 1e-6;

/* Light at the edge of an opening that rounding puts beside its portal would be found rarely, and be bright. */
static const double WIDER = 1e-5;

void bis_portal_look(bis_portal_view *v, const bis_portal *portal, vec3 p)
{
    const double to[3] = {portal->corner[0] - (double)p.x, portal->corner[1] - (double)p.y,
                          portal->corner[2] - (double)p.z};
    double (*a)[3] = v->axis;
    double far2 = 0;

    *v = (bis_portal_view){.solid_angle = 0};
    for (int k = 0; k < 2; k++) {
        const double size = sqrt(dot3(portal->edge[k], portal->edge[k]));
        for (int i = 0; i < 3; i++) a[k][i] = portal->edge[k][i] / size;
        v->low[k] = dot3(a[k], to) - WIDER * size;
        v->high[k] = v->low[k] + (1 + 2 * WIDER) * size;
        far2 += fmax(v->low[k] * v->low[k], v->high[k] * v->high[k]);
    }
    cross3(a[2], a[0], a[1]);
    const double side = copysign(1, dot3(a[2], to));
    for (int i = 0; i < 3; i++) a[2][i] *= side;
    v->z = dot3(a[2], to);
    if (!(v->z * v->z > GRAZING * GRAZING * far2)) return;
    for (int k = 0; k < 2; k++) {
        v->cosine[k][0] = v->low[k] / sqrt(v->low[k] * v->low[k] + v->z * v->z);
        v->cosine[k][1] = v->high[k] / sqrt(v->high[k] * v->high[k] + v->z * v->z);
    }
    const double *x = v->cosine[0], *y = v->cosine[1];
    v->solid_angle = asin(x[1] * y[1]) + asin(x[0] * y[0]) - asin(x[1] * y[0]) - asin(x[0] * y[1]);
    const double a0 = y[1] * x[0], a1 = -x[0] * y[0], s0 = sqrt(1 - a0 * a0), s1 = sqrt(1 - a1 * a1);
    v->arc[0] = a0 * a1 - s0 * s1;
    v->arc[1] = -s0 * a1 - a0 * s1;
    v->by_area = v->solid_angle < SMALL;
    if (v->by_area)
        v->solid_angle = (v->high[0] - v->low[0]) * (v->high[1] - v->low[1]) * v->z / pow(far2 + v->z * v->z, 1.5);
}

/* sin 4 r and cos 4 r for 0 <= r < pi/2: Taylor's series to 1e-17 by Horner's rule, and both doubled twice. */
static inline BIS_INLINE void sincos4(double r, double *sine, double *cosine)
{
    double s = 1, c = 1;

#pragma GCC unroll 10
    for (int k = 20; k > 0; k -= 2) {
        s = 1 - s * r * r * (1.0 / (k * (k + 1)));
        c = 1 - c * r * r * (1.0 / (k * (k - 1)));
    }
    s *= r;
    const double s2 = 2 * s * c, c2 = 1 - 2 * s * s;
    *sine = 2 * s2 * c2;
    *cosine = 1 - 2 * s2 * s2;
}

/* The direction a along one edge, b along the other, and c towards the plane. */
static inline BIS_INLINE void put(const bis_lanes *x, uint32_t i, const bis_portal_view *v, double a, double b,
                                  double c)
{
    x->x[i] = (float)(a * v->axis[0][0] + b * v->axis[1][0] + c * v->axis[2][0]);
    x->y[i] = (float)(a * v->axis[0][1] + b * v->axis[1][1] + c * v->axis[2][1]);
    x->z[i] = (float)(a * v->axis[0][2] + b * v->axis[1][2] + c * v->axis[2][2]);
}

BIS_LANES
static void sample_arcs(const bis_lanes *x, const bis_portal_view *view, const float *u1, const float *u2, uint32_t n)
{
    const bis_lanes l = *x;
    const bis_portal_view v = *view;
    const double b0 = v.cosine[1][0], b1 = v.cosine[1][1], y0 = v.low[1], y1 = v.high[1], zz = v.z * v.z;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        double sine, cosine;
        sincos4((double)u1[i] * (v.solid_angle / 4), &sine, &cosine);
        const double s = v.arc[1] * cosine + v.arc[0] * sine, c = v.arc[0] * cosine - v.arc[1] * sine;
        const double f = (-c * b0 - b1) / s, ff = f * f + b0 * b0 - 1; /* 0 or less if rounding says so */
        const double far = copysign(v.z / sqrt(ff > 0x1p-52 ? ff : 0x1p-52), f);
        const double near_end = far > v.low[0] ? far : v.low[0]; /* it may be beyond by some ulps */
        const double a = near_end < v.high[0] ? near_end : v.high[0], d2 = a * a + zz;
        const double h0 = y0 / sqrt(d2 + y0 * y0), h1 = y1 / sqrt(d2 + y1 * y1), h = h0 + (double)u2[i] * (h1 - h0);
        const double k = sqrt((1 - h * h) / d2); /* |h| < 1, because z > 0 */
        put(&l, i, &v, k * a, h, k * v.z);
    }
}

void bis_portal_sample(const bis_lanes *x, const bis_portal_view *v, const float *u1, const float *u2, uint32_t n)
{
    if (!v->by_area) sample_arcs(x, v, u1, u2, n);
    for (uint32_t i = 0; i < n && v->by_area; i++) {
        const double a = v->low[0] + (double)u1[i] * (v->high[0] - v->low[0]);
        const double b = v->low[1] + (double)u2[i] * (v->high[1] - v->low[1]);
        const double k = 1 / sqrt(a * a + b * b + v->z * v->z);
        put(x, i, v, k * a, k * b, k * v->z);
    }
}

/* ---- all portals of a light ---- */

/* Half of the candidates, but of a lobe's those alone that it is likely to reflect: 1/q_f(R) is about its solid angle.
 * (In a room with exponent 1000, 3 to 64 % less squared error.) */
static double part_of_portals(const bis_point *pt, double solid_angle)
{
    const double p = pt->bsdf.p_specular;

    if (!(p > 0)) return 0.5;
    return 0.5 * (1 - p * (1 - fmin(1, 1 / (solid_angle * bis_bsdf_pdf(&pt->bsdf, pt->bsdf.r)))));
}

uint32_t bis_portals_look(bis_portals *p, const bis_portal *portals, uint32_t n_portals, const bis_point *pt,
                          uint32_t n)
{
    double all = 0, sum = 0;
    uint32_t end = 0;

    p->n = n_portals;
    for (uint32_t j = 0; j < p->n; j++) {
        bis_portal_look(&p->view[j], &portals[j], pt->origin);
        all += p->view[j].solid_angle;
    }
    const double part = part_of_portals(pt, all);
    for (uint32_t j = 0; j < p->n && all > 0; j++) {
        sum += p->view[j].solid_angle;
        p->end[j] = (uint32_t)(n * part * (sum / all) + 0.5);
        p->share[j] = (double)(p->end[j] - end) / n;
        end = p->end[j];
    }
    p->of_product = (double)(n - end) / n;
    return end;
}

void bis_portals_draw(const bis_portals *p, const bis_lanes *x, float *u1, float *u2, bis_rng *rng)
{
    for (uint32_t j = 0, first = 0; j < p->n; first = p->end[j++]) {
        const bis_lanes through = bis_lanes_from(x, first);
        if (p->end[j] == first) continue;
        bis_curve_points(u1, u2, p->end[j] - first, bis_rng_u64(rng));
        bis_portal_sample(&through, &p->view[j], u1, u2, p->end[j] - first);
    }
}

BIS_LANES
static void pass(const bis_portals *p, float *q, uint32_t *place, const bis_lanes *x, uint32_t n, uint32_t drawn)
{
    const bis_lanes l = *x;

    memset(q, 0, n * sizeof *q);
    memset(place, 0xff, n * sizeof *place);
    for (uint32_t j = p->n; j-- > 0;) {
        const bis_portal_view *v = &p->view[j];
        if (!(p->share[j] > 0)) continue;
        const double size[3] = {v->high[0] - v->low[0], v->high[1] - v->low[1], v->z};
        const float even = (float)(v->by_area ? 0 : p->share[j] / v->solid_angle);
        const float by_area = (float)(v->by_area ? p->share[j] * v->z * v->z / (size[0] * size[1]) : 0);
        const float low[2] = {(float)(v->low[0] / size[0]), (float)(v->low[1] / size[1])};
        const float wide[2] = {drawn == BIS_PORTALS_CONES ? (float)(v->z / size[0]) : 0,
                               drawn == BIS_PORTALS_CONES ? (float)(v->z / size[1]) : 0};
        const int all = j == drawn;
        float a[3][3];
        for (int k = 0; k < 9; k++) a[k / 3][k % 3] = (float)(v->axis[k / 3][k % 3] * v->z / size[k / 3]);
#pragma omp simd
        for (uint32_t i = 0; i < n; i++) {
            const float c = l.x[i] * a[2][0] + l.y[i] * a[2][1] + l.z[i] * a[2][2];
            const float r = 1 / bis_lanes_choose(c > 0, c, 1);
            const float s = (l.x[i] * a[0][0] + l.y[i] * a[0][1] + l.z[i] * a[0][2]) * r - low[0];
            const float t = (l.x[i] * a[1][0] + l.y[i] * a[1][1] + l.z[i] * a[1][2]) * r - low[1];
            const float m = l.q[i] * r * r, ms = m * wide[0], mt = m * wide[1];
            const int passes = all | ((c > 0) & (s >= -ms) & (s < 1 + ms) & (t >= -mt) & (t < 1 + mt));
            const int32_t at = ((int32_t)j * BIS_PORTAL_SIDE + (t >= 0.5f)) * BIS_PORTAL_SIDE + (s >= 0.5f);
            q[i] += bis_lanes_choose(passes, even + by_area * r * r * r, 0);
            place[i] = passes ? (uint32_t)at : place[i];
        }
    }
}

void bis_portals_pass(const bis_portals *p, float *q, uint32_t *place, const bis_lanes *x, uint32_t n, uint32_t drawn)
{
    pass(p, q, place, x, n, drawn);
}

bool bis_portals_are_missed(const bis_light *light, ray eye)
{
    bis_portals p;
    float q = 0;
    const bis_lanes x = {.x = &eye.d.x, .y = &eye.d.y, .z = &eye.d.z, .q = &q};
    uint32_t place = 0, n;
    const bis_portal *portals = bis_light_portals(light, &n);

    if (bis_portals_look(&p, portals, n, &(bis_point){.origin = eye.o}, 1 << 30))
        bis_portals_pass(&p, &q, &place, &x, 1, BIS_PORTALS_MAX);
    return p.n && place == UINT32_MAX;
}
