/* SPDX-License-Identifier: BSD-2-Clause */
/* direction_formulas: what the formulas of all materials share, for real numbers (real_double.h, real_float.h). */
#pragma once

/* A direction, or any vector. */
typedef struct direction {
    real x, y, z;
} direction;

/* What a material says of a direction: f over a unit, the cosine, and the density of its draws. */
typedef struct reflection {
    real r, g, b, cos, q;
} reflection;

/* along returns the component along an axis. */
FORMULA real along(vec3 axis, direction d)
{
    return d.x * (real)axis.x + d.y * (real)axis.y + d.z * (real)axis.z;
}

/* turned returns the local direction l in world space. */
FORMULA direction turned(const frame *f, direction l)
{
    return (direction){l.x * (real)f->x.x + l.y * (real)f->y.x + l.z * (real)f->z.x,
                       l.x * (real)f->x.y + l.y * (real)f->y.y + l.z * (real)f->z.y,
                       l.x * (real)f->x.z + l.y * (real)f->y.z + l.z * (real)f->z.z};
}

/* either returns yes ? a : b. */
FORMULA direction either(int yes, direction a, direction b)
{
    return (direction){choose(yes, a.x, b.x), choose(yes, a.y, b.y), choose(yes, a.z, b.z)};
}

/* cosine returns a direction about +z with the density cos theta/pi: a uniform disc, lifted to the hemisphere (Malley).
 * */
FORMULA direction cosine(real u1, real u2)
{
    const real sine = root(u1);
    real s, c;

    sincos2pi(u2, &s, &c);
    return (direction){sine * c, sine * s, root(1 - u1)};
}

/* The two parts of [0,1): below p the specular lobe is drawn. */
typedef struct parts {
    real p, inverse_p, inverse_rest;
} parts;

/* parts_of returns the parts at p_specular. */
FORMULA parts parts_of(double p_specular)
{
    const real p = (real)p_specular;

    return (parts){p, p > 0 ? 1 / p : 0, p < 1 ? 1 / (1 - p) : 0};
}

/* place_in_part returns the place of u within its part, uniform in [0,1) again (bis_bsdf_draw). The quotient may round
 * up to 1. */
FORMULA real place_in_part(const parts *k, real u)
{
    const real place = choose(u < k->p, u * k->inverse_p, (u - k->p) * k->inverse_rest);

    return choose(place < below_1, place, below_1);
}
