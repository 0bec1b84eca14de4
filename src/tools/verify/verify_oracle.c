/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_oracle: what does a ray meet? By a search over all primitives, in double, with the error that an accelerator
 * may make: so each primitive is surely met, surely missed, or in doubt. Nothing is shared with the accelerators:
 * another test (Pluecker's, by volumes), no cells, no boxes.
 *
 * The grazing rule. An accelerator may be wrong where its own arithmetic cannot know better. The weakest is Embree's,
 * in float; the grids' double lies within its bounds. With u = 2^-24, v_i the vertices less the ray's origin, D its
 * direction, m_c = |v_2c| + |v_0c|:
 * - Embree's weight of an edge is U = D.((v_2 - v_0) x (v_2 + v_0)). Each v errs by u of itself, difference and sum by
 * u again: 2 u m_c. A product of two such: (2 + 2 + 1) u m_c m_c'; n's component from two: 12 u m_c m_c'; times D, and
 * two sums: |error of U| <= 18 u sum_c |D_c| m_c' m_c''.
 * - It counts weights as inside to 2 u |U + V + W| on the wrong side.
 * - The sign of t is that of T = v_0.n and of D.n, n = e x f. With V_c the largest |v_ic|, an edge errs by u (2 V_c +
 *   |e_c|). The plane moves with its vertices and edges, u (1 + 2 + 1) V_c along c; products and sums are those of
 *   surface.c (triangle_error), u (3 + 10) sums at most: error of T <= u (4 sum |n_c| V_c + 13 sum |v_0c| terms_c),
 * terms_c the sizes of the two products that make n_c. That of D.n: its edges' errors times the other edge, and 6 u
 * terms_c.
 * - Where a primitive is in doubt, either answer is right. Distances may differ by T's error over D.n. */
#include "verify.h"

#include <string.h>

static const double u = 0x1p-24;

/* A primitive as one ray sees it. */
typedef enum sight { MISSED, DOUBTFUL, MET } sight;

/* The edge's weight, and its bound. */
static double edge_weight(const double a[3], const double b[3], const double d[3], double *error)
{
    double n[3], m[3];

    for (int c = 0; c < 3; c++) m[c] = fabs(a[c]) + fabs(b[c]);
    cross3(n, a, b);
    *error = 18 * u * (fabs(d[0]) * m[1] * m[2] + fabs(d[1]) * m[2] * m[0] + fabs(d[2]) * m[0] * m[1]);
    return 2 * dot3(n, d);
}

/* Is the ray's line inside the triangle? */
static sight inside(const double v[3][3], const double d[3])
{
    double w[3], error[3], sum = 0;
    bool some_more = false, some_less = false, all_more = true, all_less = true;

    for (int i = 0; i < 3; i++) {
        w[i] = edge_weight(v[i], v[(i + 1) % 3], d, &error[i]);
        sum += fabs(w[i]) + error[i];
    }
    for (int i = 0; i < 3; i++) {
        some_more |= w[i] > error[i] + 2 * u * sum;
        some_less |= w[i] < -error[i] - 2 * u * sum;
        all_more &= w[i] > error[i];
        all_less &= w[i] < -error[i];
    }
    return some_more && some_less ? MISSED : all_more || all_less ? MET : DOUBTFUL;
}

/* Where is it met? *t to within *error, as far as that is known; *t may be infinite. left: the ray starts from it, on
 * the side that it goes to, and beyond what T may err: it is not met, unless D.n has no sign. */
static sight see_triangle(const vec3 p[3], const ray *r, bool left, double *t, double *error)
{
    const double d[3] = {(double)r->d.x, (double)r->d.y, (double)r->d.z};
    double v[3][3], e[3], f[3], n[3], height_error = 0, descent_error = 0;

    for (int i = 0; i < 3; i++) {
        v[i][0] = (double)p[i].x - (double)r->o.x;
        v[i][1] = (double)p[i].y - (double)r->o.y;
        v[i][2] = (double)p[i].z - (double)r->o.z;
    }
    const sight in = inside(v, d);
    if (in == MISSED) return MISSED;
    for (int c = 0; c < 3; c++) {
        const float *a = &p[0].x, *b = &p[1].x, *last = &p[2].x;
        e[c] = (double)b[c] - (double)a[c];
        f[c] = (double)last[c] - (double)a[c];
    }
    cross3(n, e, f);
    if (n[0] == 0 && n[1] == 0 && n[2] == 0) return MISSED; /* without area */
    for (int c = 0; c < 3; c++) {
        const int i = (c + 1) % 3, j = (c + 2) % 3;
        const double terms = fabs(e[i] * f[j]) + fabs(e[j] * f[i]);
        const double largest_i = fmax(fabs(v[0][i]), fmax(fabs(v[1][i]), fabs(v[2][i])));
        const double largest_j = fmax(fabs(v[0][j]), fmax(fabs(v[1][j]), fabs(v[2][j])));
        const double largest_c = fmax(fabs(v[0][c]), fmax(fabs(v[1][c]), fabs(v[2][c])));
        height_error += u * (4 * fabs(n[c]) * largest_c + 13 * fabs(v[0][c]) * terms);
        descent_error +=
            u * fabs(d[c]) *
            (2 * largest_i * (fabs(f[j]) + fabs(e[j])) + 2 * largest_j * (fabs(f[i]) + fabs(e[i])) + 8 * terms);
    }
    const double height = dot3(v[0], n), descent = dot3(n, d);
    if (descent == 0) { /* edge-on */
        *t = *error = (double)INFINITY;
        return DOUBTFUL;
    }
    *t = height / descent;
    *error = height_error / fabs(descent) + fabs(*t) * (descent_error / fabs(descent) + 4 * u);
    if (left && fabs(descent) > descent_error) return MISSED;
    if (fabs(height) <= height_error || fabs(descent) <= descent_error) return DOUBTFUL;
    return *t > 0 ? in : MISSED;
}

/* Sphere or disk: the roots in long double, in object space. Both accelerators test quadrics in double: 2^-40 of all
 * sizes is far above its error and far below the offset, 2^-24. A disk has one root: s[1] stays as it is. */
static void see_quadric(const bis_quadric *q, const ray *r, sight s[2], double t[2], double error[2])
{
    const double (*inv)[4] = q->to_world.inv;
    const double wo[3] = {(double)r->o.x, (double)r->o.y, (double)r->o.z},
                 wd[3] = {(double)r->d.x, (double)r->d.y, (double)r->d.z};
    long double o[3], d[3], size = (long double)q->radius + fabsl((long double)q->height);
    const long double R = (long double)q->radius, doubt = 0x1p-40L;

    for (int i = 0; i < 3; i++) {
        o[i] = (long double)inv[i][3];
        d[i] = 0;
        long double terms = fabsl(o[i]);
        for (int k = 0; k < 3; k++) {
            o[i] += (long double)inv[i][k] * (long double)wo[k];
            d[i] += (long double)inv[i][k] * (long double)wd[k];
            terms += fabsl((long double)inv[i][k] * (long double)wo[k]);
        }
        size += terms;
    }
    const long double A = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], slack = doubt * size;
    if (q->kind == BIS_DISK) {
        if (d[2] == 0) return;
        const long double height = (long double)q->height - o[2], root = height / d[2];
        const long double x = o[0] + root * d[0], y = o[1] + root * d[1], rim = sqrtl(x * x + y * y) - R;
        t[0] = (double)root;
        error[0] = (double)(slack / fabsl(d[2])) + fabs(t[0]) * 4 * u;
        const long double blur = slack * (1 + sqrtl(A) / fabsl(d[2]));
        if (rim > blur) return;
        /* beside its plane the disk's own height is exact to the ulps of its terms */
        if (t[0] > 0) s[0] = rim < -blur ? MET : DOUBTFUL;
        else s[0] = fabsl(height) <= 0x1p-50L * size ? DOUBTFUL : MISSED;
        return;
    }
    const long double B = -(o[0] * d[0] + o[1] * d[1] + o[2] * d[2]) / A;
    const long double f[3] = {o[0] + B * d[0], o[1] + B * d[1], o[2] + B * d[2]};
    const long double D = R * R - (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]), blur = 4 * size * slack;
    if (D < -blur) return;
    const long double half = sqrtl(fmaxl(D, 0) / A),
                      spread = sqrtl((fabsl(D) + blur) / A) - sqrtl(fmaxl(D - blur, 0) / A) + slack / sqrtl(A);
    for (int i = 0; i < 2; i++) {
        const long double root = i ? B + half : B - half;
        t[i] = (double)root;
        error[i] = (double)spread + fabs(t[i]) * 4 * u;
        if (root > spread) s[i] = D > blur ? MET : DOUBTFUL;
        else s[i] = root >= -spread ? DOUBTFUL : MISSED;
    }
}

void bis_verify_search(bool right[], const bis_geometry *g, const ray *r, uint32_t left,
                       const bis_verify_answer *answer, int n)
{
    double nearest = (double)INFINITY; /* of what is surely met, its error included */
    bool any = false, known[BIS_VERIFY_ANSWERS] = {false};

    for (uint32_t prim = 0; prim < bis_geometry_primitives(g); prim++) {
        double t[2], error[2];
        sight s[2] = {MISSED, MISSED};
        if (prim == left && prim >= g->n_triangles) continue;
        if (prim < g->n_triangles) {
            const uint32_t *index = g->index + 3 * (size_t)prim;
            const vec3 p[3] = {g->p[index[0]], g->p[index[1]], g->p[index[2]]};
            s[0] = see_triangle(p, r, prim == left, &t[0], &error[0]);
        } else {
            see_quadric(&g->quadrics[prim - g->n_triangles], r, s, t, error);
        }
        for (int k = 0; k < 2; k++) {
            if (s[k] == MISSED) continue;
            any = true;
            if (s[k] == MET) nearest = fmin(nearest, t[k] + error[k]);
            for (int i = 0; i < n; i++) known[i] |= fabs(answer[i].t - t[k]) <= error[k] || isinf(error[k]);
        }
    }
    for (int i = 0; i < n; i++) {
        const bool met = isfinite(answer[i].t);
        right[i] =
            (met ? known[i] && answer[i].t <= nearest : isinf(nearest)) && (answer[i].occluded ? any : isinf(nearest));
    }
}
