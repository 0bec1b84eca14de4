/* SPDX-License-Identifier: BSD-2-Clause */
/* xform: every transformation carries its inverse, made beside it in closed form where there is one, so that none is
 * ever inverted twice and (A B)^-1 = B^-1 A^-1 costs a product.
 *
 * Column vectors: p' = m p. The conventions (left-handed world, LookAt, the order of 16 numbers) are those of pbrt's
 * scene format. Everything in double; vec3 is rounded to float once, at the end. */
#include "bis/base/xform.h"

#include <assert.h>
#include <float.h>

bis_xform bis_xform_identity(void)
{
    bis_xform t = {0};
    for (int i = 0; i < 4; i++) t.m[i][i] = t.inv[i][i] = 1;
    return t;
}

bis_xform bis_xform_translate(double x, double y, double z)
{
    const double d[3] = {x, y, z};
    bis_xform t = bis_xform_identity();
    for (int i = 0; i < 3; i++) {
        t.m[i][3] = d[i];
        t.inv[i][3] = -d[i];
    }
    return t;
}

bis_xform bis_xform_scale(double x, double y, double z)
{
    const double s[3] = {x, y, z};
    bis_xform t = bis_xform_identity();
    for (int i = 0; i < 3; i++) {
        t.m[i][i] = s[i];
        t.inv[i][i] = 1 / s[i];
    }
    return t;
}

/* Exact at multiples of 90 degrees, where sin(PI / 2 * k) is off by 1e-16: a box turned by 90 stays axis-aligned. */
static void sincos_degrees(double degrees, double *sine, double *cosine)
{
    int quarter;
    double rest = remquo(degrees, 90, &quarter) * (PI / 180);
    double s = sin(rest), c = cos(rest);
    switch (quarter & 3) {
    case 0: *sine = s, *cosine = c; break;
    case 1: *sine = c, *cosine = -s; break;
    case 2: *sine = -s, *cosine = -c; break;
    default: *sine = -c, *cosine = s; break;
    }
}

static void scale3(double v[3], double s)
{
    for (int i = 0; i < 3; i++) v[i] *= s;
}

/* To unit length. Divides by the largest element first, so that no square over- or underflows. False: zero or not
 * finite. */
static bool normalize3(double v[3])
{
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(largest > 0) || !isfinite(largest)) return false;
    for (int i = 0; i < 3; i++) v[i] /= largest;
    scale3(v, 1 / sqrt(dot3(v, v)));
    return true;
}

/* Rodrigues: R = c 1 + (1 - c) a a^T + s [a]x. Its inverse is its transpose. */
bis_xform bis_xform_rotate(double degrees, double x, double y, double z)
{
    double a[3] = {x, y, z}, s, c;
    bis_xform t = bis_xform_identity();

    normalize3(a);
    sincos_degrees(degrees, &s, &c);
    const double cross_matrix[3][3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            t.m[i][j] = t.inv[j][i] = (i == j ? c : 0) + (1 - c) * a[i] * a[j] + s * cross_matrix[i][j];
    return t;
}

/* The camera looks along +z, its right is +x. Camera to world has right, up, direction and eye as columns; we want its
 * inverse. The cross product of two unit vectors is good to about 4 ulps: below that it has no direction, and `up` is
 * parallel to the view. */
bool bis_xform_look_at(bis_xform *out, const double eye[3], const double look[3], const double up[3])
{
    double forward[3], right[3], upward[3], tip[3];
    for (int i = 0; i < 3; i++) {
        forward[i] = look[i] - eye[i];
        tip[i] = up[i];
    }
    if (!normalize3(forward) || !normalize3(tip)) return false;
    cross3(right, tip, forward);
    if (sqrt(dot3(right, right)) <= 4 * DBL_EPSILON || !normalize3(right)) return false;
    cross3(upward, forward, right);

    bis_xform t = bis_xform_identity();
    const double *axes[3] = {right, upward, forward};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) t.m[i][j] = t.inv[j][i] = axes[i][j];
        t.m[i][3] = -dot3(axes[i], eye);
        t.inv[i][3] = eye[i];
    }
    *out = t;
    return true;
}

/* m^-1 = adj(m) / det(m), by the 2x2 minors of the upper (s) and the lower (c) two rows (Laplace's expansion): of the
 * numbers that people write, a singular matrix has a determinant of exactly 0 this way; Gauss's pivots would only be
 * small. */
static bool invert(double inv[4][4], const double m[4][4])
{
    static const int pair[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    double s[6], c[6];
    for (int k = 0; k < 6; k++) {
        int i = pair[k][0], j = pair[k][1];
        s[k] = m[0][i] * m[1][j] - m[1][i] * m[0][j];
        c[k] = m[2][i] * m[3][j] - m[3][i] * m[2][j];
    }
    double det = s[0] * c[5] - s[1] * c[4] + s[2] * c[3] + s[3] * c[2] - s[4] * c[1] + s[5] * c[0];
    if (det == 0) return false;

    const double adj[4][4] = {
        {m[1][1] * c[5] - m[1][2] * c[4] + m[1][3] * c[3], -m[0][1] * c[5] + m[0][2] * c[4] - m[0][3] * c[3],
         m[3][1] * s[5] - m[3][2] * s[4] + m[3][3] * s[3], -m[2][1] * s[5] + m[2][2] * s[4] - m[2][3] * s[3]},
        {-m[1][0] * c[5] + m[1][2] * c[2] - m[1][3] * c[1], m[0][0] * c[5] - m[0][2] * c[2] + m[0][3] * c[1],
         -m[3][0] * s[5] + m[3][2] * s[2] - m[3][3] * s[1], m[2][0] * s[5] - m[2][2] * s[2] + m[2][3] * s[1]},
        {m[1][0] * c[4] - m[1][1] * c[2] + m[1][3] * c[0], -m[0][0] * c[4] + m[0][1] * c[2] - m[0][3] * c[0],
         m[3][0] * s[4] - m[3][1] * s[2] + m[3][3] * s[0], -m[2][0] * s[4] + m[2][1] * s[2] - m[2][3] * s[0]},
        {-m[1][0] * c[3] + m[1][1] * c[1] - m[1][2] * c[0], m[0][0] * c[3] - m[0][1] * c[1] + m[0][2] * c[0],
         -m[3][0] * s[3] + m[3][1] * s[1] - m[3][2] * s[0], m[2][0] * s[3] - m[2][1] * s[1] + m[2][2] * s[0]},
    };
    bool finite = true;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            inv[i][j] = adj[i][j] / det;
            finite &= isfinite(inv[i][j]) != 0;
        }
    return finite;
}

bool bis_xform_is_affine(const bis_xform *t)
{
    return t->m[3][0] == 0 && t->m[3][1] == 0 && t->m[3][2] == 0 && t->m[3][3] == 1;
}

/* A last row 0 0 0 w divides every point by w, and so can the matrix. The three zeros of an exporter's matrix may be
 * the rounding of a float product: 1e-6 of w is eight times the epsilon of float. */
bool bis_xform_from_columns(bis_xform *out, const double v[16])
{
    bis_xform t;
    const double w = v[15], zero = 1e-6 * fabs(w);
    const bool is_affine = w != 0 && fabs(v[3]) <= zero && fabs(v[7]) <= zero && fabs(v[11]) <= zero;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) t.m[i][j] = !is_affine ? v[4 * j + i] : i == 3 ? j == 3 : v[4 * j + i] / w;
    if (!invert(t.inv, (const double(*)[4])t.m)) return false;
    if (is_affine) { /* so is the inverse; rounding may have left 1 by an ulp */
        t.inv[3][0] = t.inv[3][1] = t.inv[3][2] = 0;
        t.inv[3][3] = 1;
    }
    *out = t;
    return true;
}

static void multiply(double out[4][4], const double a[4][4], const double b[4][4])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] + a[i][3] * b[3][j];
}

bis_xform bis_xform_compose(const bis_xform *a, const bis_xform *b)
{
    bis_xform t;
    multiply(t.m, (const double(*)[4])a->m, (const double(*)[4])b->m);
    multiply(t.inv, (const double(*)[4])b->inv, (const double(*)[4])a->inv);
    return t;
}

bis_xform bis_xform_inverse(const bis_xform *t)
{
    bis_xform r;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            r.m[i][j] = t->inv[i][j];
            r.inv[i][j] = t->m[i][j];
        }
    return r;
}

vec3 bis_xform_point(const bis_xform *t, vec3 p)
{
    const double v[3] = {(double)p.x, (double)p.y, (double)p.z};
    double q[4];
    for (int i = 0; i < 4; i++)
        q[i] = dot3(t->m[i], v) + t->m[i][3];
    return vec3_from(q[0] / q[3], q[1] / q[3], q[2] / q[3]);
}

vec3 bis_xform_vector(const bis_xform *t, vec3 v)
{
    const double d[3] = {(double)v.x, (double)v.y, (double)v.z};
    return vec3_from(dot3(t->m[0], d), dot3(t->m[1], d), dot3(t->m[2], d));
}

vec3 bis_xform_normal(const bis_xform *t, vec3 n)
{
    double r[3];
    for (int j = 0; j < 3; j++)
        r[j] = t->inv[0][j] * (double)n.x + t->inv[1][j] * (double)n.y + t->inv[2][j] * (double)n.z;
    return vec3_from(r[0], r[1], r[2]);
}

bool bis_xform_is_orthonormal(const bis_xform *t, double tolerance)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double element = t->m[0][i] * t->m[0][j] + t->m[1][i] * t->m[1][j] + t->m[2][i] * t->m[2][j];
            if (!(fabs(element - (i == j)) <= tolerance)) return false;
        }
    return true;
}

bis_xform bis_xform_rotation(const bis_xform *t)
{
    bis_xform r = bis_xform_identity();

    assert(bis_xform_is_orthonormal(t, BIS_XFORM_FRAME_TOLERANCE));
    for (int j = 0; j < 3; j++) {
        double v[3] = {t->m[0][j], t->m[1][j], t->m[2][j]};
        for (int k = 0; k < j; k++) {
            const double along = v[0] * r.m[0][k] + v[1] * r.m[1][k] + v[2] * r.m[2][k];
            for (int i = 0; i < 3; i++) v[i] -= along * r.m[i][k];
        }
        const double norm = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (int i = 0; i < 3; i++) r.m[i][j] = r.inv[j][i] = v[i] / norm;
    }
    return r;
}
