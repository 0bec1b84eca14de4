/* SPDX-License-Identifier: BSD-2-Clause */
/* model_knot: a trefoil whose tube is carved as a braid of ropes; the figure that stands in for the thesis's statue,
 * and the mesh of 1e4 to 1e7 triangles of the scaling benchmark.
 *
 * The centre line is the (2, 3) torus knot. The tube's frame turns about it with the torus it lies on (its second axis
 * is the torus's normal), which closes after one round without a twist to be undone. The relief is the higher of two
 * families of ropes that wind about the tube in opposite ways; where they cross, they pass over and under in turn, as
 * woven things do. */
#include "model.h"

#include <math.h>

enum { P = 2, Q = 3 };            /* turns about the axis, and about the torus's own circle */
enum { TURNS = 36, STRANDS = 4 }; /* a rope's turns about the tube on its way round, ropes of each family */

static const double MAJOR = 0.92, MINOR = 0.40, TUBE = 0.300, RELIEF = 0.070;

typedef struct d3 {
    double x, y, z;
} d3;

static d3 d3_cross(d3 a, d3 b) { return (d3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
static double d3_dot(d3 a, d3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static d3 d3_unit(d3 a)
{
    double l = sqrt(d3_dot(a, a));
    return (d3){a.x / l, a.y / l, a.z / l};
}

/* Height of a rope at distance s from its middle, s = 1 its edge: round on top, 0 beyond. */
static double rope(double s) { return s * s < 1 ? sqrt(1 - s * s) : 0; }

/* One family: STRANDS ropes that wind `turns` times about the tube; over and under follow the other family's phase. */
static double family(double u, double v, double turns)
{
    double phase = STRANDS * v + turns * u;         /* integer in the middle of a rope */
    double other = STRANDS * v - turns * u;         /* integer where a rope of the other family is crossed */
    double s = 2 * (phase - round(phase)) / 0.86;   /* a gap of 14% between neighbours */
    double twist = 0.10 * cos(2 * PI * (2 * other + s)); /* the rope's own strands */
    double over = (turns > 0 ? 1 : -1) * cos(PI * (other + round(phase)));

    return rope(s) * (0.70 + 0.30 * over + twist);
}

static vec3 knot_position(const void *data, double u, double v)
{
    double t = 2 * PI * u, w = 2 * PI * v, rho = MAJOR + MINOR * cos(Q * t);
    d3 centre = {rho * cos(P * t), rho * sin(P * t), MINOR * sin(Q * t)};
    d3 tangent = {-Q * MINOR * sin(Q * t) * cos(P * t) - P * rho * sin(P * t),
                  -Q * MINOR * sin(Q * t) * sin(P * t) + P * rho * cos(P * t), Q * MINOR * cos(Q * t)};
    d3 out = {
        cos(Q * t) * cos(P * t), cos(Q * t) * sin(P * t), sin(Q * t)}; /* the torus's normal: square to the tangent */
    d3 side = d3_cross(out, d3_unit(tangent));
    double h = fmax(family(u, v, TURNS), family(u, v, -TURNS));
    double r = TUBE + RELIEF * (h - 1);
    double a = r * cos(w), b = r * sin(w);

    (void)data;
    /* The knot's axis lies along y, so that it stands upright and shows its face. */
    return vec3_from(
        centre.x + a * out.x + b * side.x, -(centre.z + a * out.z + b * side.z), centre.y + a * out.y + b * side.y);
}

bis_status model_knot(bis_mesh *m, size_t n_triangles, bis_diag *diag)
{
    const double aspect = 8.5; /* the centre line's length over the tube's girth: cells are about square */
    size_t n_v = (size_t)ceil(sqrt((double)n_triangles / (2 * aspect)));
    size_t n_u = (n_triangles + 2 * n_v - 1) / (2 * n_v);

    return model_tube_mesh(m, n_u, n_v, knot_position, NULL, diag);
}
