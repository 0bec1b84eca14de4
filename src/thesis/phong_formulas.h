/* SPDX-License-Identifier: BSD-2-Clause */
/* phong_formulas: the formulas of thesis 3.5 for real numbers (real_double.h, real_float.h; model_one.h says what such
 * a file defines): eq. 3.14, the density of E35, and eq. 3.16. */
#pragma once

#include "bis/thesis/phong.h"

#include "thesis/direction_formulas.h"

#include <float.h>

/* A form of f without the lobe, and one with it. */
enum { KINDS = 2 };

/* unit_of returns the larger of the peaks of both terms. */
FORMULA double unit_of(const bis_bsdf *b)
{
    const bis_material *m = b->material;
    const double peak = (m->exponent + 1) * (INV_PI / 2);

    return fmax(rgb_max(m->Ks) * peak, rgb_max(m->Kd) * INV_PI);
}

/* What is the same for all directions: f = base + lobe cos^n alpha, in three channels, and its density. */
typedef struct constants {
    vec3 n, r;                 /* normal; axis of the lobe: wo mirrored */
    real exponent;
    real lobe[3], base[3];     /* Ks (n+1)/(2 pi), Kd/pi, over the unit */
    real pdf_lobe, pdf_base;   /* p_s (n+1)/(2 pi), p_d/pi */
    int kind;                  /* 1 if there is a lobe */
} constants;

/* power returns max(0, cos alpha)^n, with 1 - cos alpha = |wi - r|^2/2, which does not cancel (E36). 0^0 = 0 at the
 * horizon. */
FORMULA real power(vec3 axis, real n, direction wi)
{
    const real dx = wi.x - (real)axis.x, dy = wi.y - (real)axis.y, dz = wi.z - (real)axis.z;
    const real one_minus_cos = (dx * dx + dy * dy + dz * dz) * (real)0.5;
    const bool ahead = one_minus_cos < 1;
    const real cos_n = exp_of(n * log1m(choose(ahead, one_minus_cos, 0)));

    return choose(ahead, cos_n, 0);
}

/* constants_of returns the coefficients of eq. 3.14. */
/* [phong-f] */
FORMULA constants constants_of(const bis_bsdf *b, double unit)
{
    const bis_material *m = b->material;
    const double peak = (m->exponent + 1) * (INV_PI / 2), p = b->p_specular;
    const double Ks[3] = {(double)m->Ks.r, (double)m->Ks.g, (double)m->Ks.b};
    const double Kd[3] = {(double)m->Kd.r, (double)m->Kd.g, (double)m->Kd.b};
    constants k = {.n = b->local.z, .r = b->r, .exponent = (real)fmin(m->exponent, (double)FLT_MAX),
                   .pdf_lobe = (real)(p * peak), .pdf_base = (real)((1 - p) * INV_PI), .kind = p > 0};

    for (int i = 0; i < 3; i++) {
        k.lobe[i] = (real)(Ks[i] * peak / unit);
        k.base[i] = (real)(Kd[i] * INV_PI / unit);
    }
    return k;
}

/* f returns f, and the density of the mixture of both lobes (E35). */
FORMULA reflection f(const constants *k, direction wi, const int kind)
{
    const real cos_theta = along(k->n, wi);
    real r = k->base[0], g = k->base[1], b = k->base[2], cos_n = 0;

    if (kind == 1) {
        cos_n = power(k->r, k->exponent, wi);
        r += k->lobe[0] * cos_n;
        g += k->lobe[1] * cos_n;
        b += k->lobe[2] * cos_n;
    }
    return (reflection){r, g, b, cos_theta,
                        k->pdf_lobe * cos_n + k->pdf_base * choose(cos_theta > 0, cos_theta, 0)};
}
/* [end] */

/* lobe draws by eq. 3.16 about +z: cos theta = (1 - u1)^(1/(n+1)), phi = 2 pi u2. sqrt(1 - cos^2) would cancel near the
 * axis (in float at n = 1e5, 7 % of all samples are wrong by more than 1 %). (1 - cos)(1 + cos), with 1 - cos from e^y
 * - 1, does not. */
/* [phong-lobe] */
FORMULA direction lobe(real inverse_n1, real u1, real u2)
{
    const real one_minus_cos = one_minus_exp(log1m(u1) * inverse_n1);
    const real sine = root(one_minus_cos * (2 - one_minus_cos));
    real s, c;

    sincos2pi(u2, &s, &c);
    return (direction){sine * c, sine * s, 1 - one_minus_cos};
}
/* [end] */

/* The frames about the normal and about r; 1/(n+1). */
typedef struct draws {
    frame local, about_r;
    real inverse_n1;
} draws;

/* draws_of returns them. */
FORMULA draws draws_of(const bis_bsdf *b)
{
    return (draws){b->local, b->lobe, (real)(1 / (b->material->exponent + 1))};
}

/* draw returns a direction of the lobe, or of the cosine. */
/* [phong-draw] */
FORMULA direction draw(const draws *k, int specular, real u1, real u2)
{
    return either(specular, turned(&k->about_r, lobe(k->inverse_n1, u1, u2)),
                  turned(&k->local, cosine(u1, u2)));
}
/* [end] */
