/* SPDX-License-Identifier: BSD-2-Clause */
/* moon_formulas: the law of Lommel and Seeliger, f = Kd/(4 pi (cos theta_i + cos theta_o)): dust as on the moon, whose
 * disc is as bright at the rim as in the middle. */
#pragma once

#include "bis/thesis/bsdf.h"

#include "thesis/direction_formulas.h"

extern const bis_bsdf_model bis_moon_model;
extern const bis_bsdf_many bis_moon_many;

enum { KINDS = 1 }; /* f has one form */

/* f cos = Kd/(4 pi) c_i/(c_i + c_o) grows with c_i. Unit vectors are such to 2^-23, f is rounded to float: 2^-21. */
FORMULA double unit_of(const bis_bsdf *b)
{
    return rgb_max(b->material->Kd) * INV_PI / 4 / (1 + bis_bsdf_cos(b, b->wo)) * (1 + 0x1p-21);
}

typedef struct constants {
    vec3 n;
    real c_o, r, g, b; /* cos theta_o; Kd/(4 pi) over the unit */
    int kind;          /* 0 */
} constants;

FORMULA constants constants_of(const bis_bsdf *b, double unit)
{
    const rgb Kd = b->material->Kd;
    const double k = INV_PI / 4 / unit;

    return (constants){.n = b->local.z, .c_o = (real)bis_bsdf_cos(b, b->wo),
                       .r = (real)((double)Kd.r * k), .g = (real)((double)Kd.g * k), .b = (real)((double)Kd.b * k)};
}

FORMULA reflection f(const constants *k, direction wi, const int kind)
{
    const real cos_theta = along(k->n, wi), c_i = choose(cos_theta > 0, cos_theta, 0);
    const real share = 1 / (c_i + k->c_o);

    (void)kind;
    return (reflection){k->r * share, k->g * share, k->b * share, cos_theta, c_i * (real)INV_PI};
}

typedef struct draws {
    frame local;
} draws;

FORMULA draws draws_of(const bis_bsdf *b)
{
    return (draws){b->local};
}

FORMULA direction draw(const draws *k, int specular, real u1, real u2)
{
    (void)specular; /* there is no lobe */
    return turned(&k->local, cosine(u1, u2));
}
