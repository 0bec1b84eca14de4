/* SPDX-License-Identifier: BSD-2-Clause */
/* make_revolved: pbrt's quadrics, and parts of spheres and disks, as profiles that turn about the z axis.
 *
 * p(s, t) is the profile's point at t, turned by s phi_max. Where a straight profile lies in a plane with the axis, the
 * pieces between two of its positions are flat, so that one piece along t is enough. A skew line, a parabola or a
 * circle is cut along t, too. A triangle between points of p that are h and k apart in s and t is nowhere further from
 * p than (h^2 |p_ss| + 2 h k |p_st| + k^2 |p_tt|)/8, the error of linear interpolation; tests/shape/test_make.c
 * measures it. */
#include "make_grid.h"

/* q, and its derivative d, at t; a circle needs none. The profile starts in the plane y = 0, but for a skew line. */
static void profile_at(double q[3], double d[3], const bis_revolved *r, double t)
{
    q[1] = d[1] = 0;
    if (r->profile == BIS_PROFILE_LINE) {
        for (int i = 0; i < 3; i++) {
            q[i] = (1 - t) * r->p[0][i] + t * r->p[1][i];
            d[i] = r->p[1][i] - r->p[0][i];
        }
    } else if (r->profile == BIS_PROFILE_PARABOLA) { /* even pieces of x, because z is flat near the axis */
        const double a = sqrt(r->z[0] / r->z[1]), x = a + t * (1 - a);
        q[0] = r->radius * x;
        q[2] = r->z[1] * x * x;
        d[0] = r->radius;
        d[2] = 2 * r->z[1] * x;
    } else {
        const double from = acos(r->z[0] / r->radius), theta = from + t * (acos(r->z[1] / r->radius) - from);
        q[0] = r->radius * sin(theta);
        q[2] = r->radius * cos(theta);
    }
}

static double v_of(const bis_revolved *r, double z, double t)
{
    return r->profile == BIS_PROFILE_PARABOLA ? (z - r->z[0]) / (r->z[1] - r->z[0]) : t;
}

static void turn(double q[3], double cosine, double sine)
{
    const double x = q[0];
    q[0] = cosine * x - sine * q[1];
    q[1] = sine * x + cosine * q[1];
}

static void revolved_at(bis_grid_point *out, const void *surface, double s, double t)
{
    const bis_revolved *r = surface;
    const double degrees = s * r->phi_max_deg, phi = (degrees < 360 ? degrees : 0) * PI / 180; /* the turn closes */
    double d[3];

    profile_at(out->p, d, r, t);
    out->uv = (bis_uv){(float)s, (float)v_of(r, out->p[2], t)};
    turn(out->p, cos(phi), sin(phi));
    if (r->profile == BIS_PROFILE_CIRCLE) { /* at the poles a derivative would be no help */
        for (int i = 0; i < 3; i++) out->n[i] = out->p[i];
        return;
    }
    turn(d, cos(phi), sin(phi));
    /* the direction in which p turns; on the axis, in which the points before or behind it turn */
    const double side = t < 1 ? 1 : -1, axis[3] = {side * d[0], side * d[1], 0};
    const double *arm = out->p[0] != 0 || out->p[1] != 0 ? out->p : axis, round[3] = {-arm[1], arm[0], 0};
    cross3(out->n, round, d);
}

/* Does the profile stay on one side of the axis, in a plane with it? */
static bool is_flat_between(const bis_revolved *r)
{
    const double *a = r->p[0], *b = r->p[1];
    return r->profile == BIS_PROFILE_LINE && a[0] * b[1] == a[1] * b[0] && a[0] * b[0] + a[1] * b[1] >= 0;
}

/* Pieces along the turn and along the profile. */
static void pieces(size_t *ns, size_t *nt, const bis_revolved *r)
{
    *ns = (size_t)ceil(BIS_MAKE_TURN * r->phi_max_deg / 360);
    /* a meridian of a sphere is half a turn */
    *nt = is_flat_between(r) ? 1 : r->profile == BIS_PROFILE_LINE ? BIS_MAKE_TURN : BIS_MAKE_TURN / 2;
}

bis_made_size bis_make_revolved_size(const bis_revolved *r)
{
    size_t ns, nt;

    pieces(&ns, &nt, r);
    return (bis_made_size){(ns + 1) * (nt + 1), 2 * ns * nt};
}

bis_status bis_make_revolved(bis_mesh *m, const bis_revolved *r, bis_loc at, bis_diag *diag)
{
    const bis_made_size size = bis_make_revolved_size(r);
    const bis_status status = bis_grid_room(m, size.vertices, size.triangles, at, diag);
    size_t ns, nt;

    pieces(&ns, &nt, r);
    if (!status) bis_grid_add(m, ns, nt, revolved_at, r);
    return status;
}
