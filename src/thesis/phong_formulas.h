/* SPDX-License-Identifier: BSD-2-Clause */
/* phong_formulas: the formulas of thesis 3.5 for REAL numbers (real.h, model.h): eq. 3.14, the density of E35, and eq.
 * 3.16. */

/* What is the same for all directions: f = base + lobe cos^n alpha, in three channels, and its density. */
typedef struct OF(constants) {
    vec3 n, r;                 /* normal; axis of the lobe: wo mirrored */
    REAL exponent;
    REAL lobe[3], base[3];     /* Ks (n+1)/(2 pi), Kd/pi, over the unit */
    REAL pdf_lobe, pdf_base;   /* p_s (n+1)/(2 pi), p_d/pi */
    int kind;                  /* 1 if there is a lobe */
} OF(constants);

/* power returns max(0, cos alpha)^n, with 1 - cos alpha = |wi - r|^2/2, which does not cancel (E36). 0^0 = 0 at the
 * horizon. */
FORMULA REAL OF(power)(vec3 axis, REAL n, OF(direction) wi)
{
    const REAL dx = wi.x - (REAL)axis.x, dy = wi.y - (REAL)axis.y, dz = wi.z - (REAL)axis.z;
    const REAL one_minus_cos = (dx * dx + dy * dy + dz * dz) * (REAL)0.5;
    const bool ahead = one_minus_cos < 1;
    const REAL power = OF(exp)(n * OF(log1m)(OF(choose)(ahead, one_minus_cos, 0)));

    return OF(choose)(ahead, power, 0);
}

/* constants_of returns the coefficients of eq. 3.14. */
/* [phong-f] */
FORMULA OF(constants) OF(constants_of)(const bis_bsdf *b, double unit)
{
    const bis_material *m = b->material;
    const double peak = (m->exponent + 1) * (INV_PI / 2), p = b->p_specular;
    const double Ks[3] = {(double)m->Ks.r, (double)m->Ks.g, (double)m->Ks.b};
    const double Kd[3] = {(double)m->Kd.r, (double)m->Kd.g, (double)m->Kd.b};
    OF(constants) k = {.n = b->local.z, .r = b->r, .exponent = (REAL)fmin(m->exponent, (double)FLT_MAX),
                       .pdf_lobe = (REAL)(p * peak), .pdf_base = (REAL)((1 - p) * INV_PI), .kind = p > 0};

    for (int i = 0; i < 3; i++) {
        k.lobe[i] = (REAL)(Ks[i] * peak / unit);
        k.base[i] = (REAL)(Kd[i] * INV_PI / unit);
    }
    return k;
}

/* f returns f, and the density of the mixture of both lobes (E35). */
FORMULA OF(reflection) OF(f)(const OF(constants) *k, OF(direction) wi, const int kind)
{
    const REAL cos_theta = OF(along)(k->n, wi);
    REAL r = k->base[0], g = k->base[1], b = k->base[2], power = 0;

    if (kind == 1) {
        power = OF(power)(k->r, k->exponent, wi);
        r += k->lobe[0] * power;
        g += k->lobe[1] * power;
        b += k->lobe[2] * power;
    }
    return (OF(reflection)){r, g, b, cos_theta,
                            k->pdf_lobe * power + k->pdf_base * OF(choose)(cos_theta > 0, cos_theta, 0)};
}
/* [end] */

/* lobe draws by eq. 3.16 about +z: cos theta = (1 - u1)^(1/(n+1)), phi = 2 pi u2. sqrt(1 - cos^2) would cancel near the
 * axis (in float at n = 1e5, 7 % of all samples are wrong by more than 1 %). (1 - cos)(1 + cos), with 1 - cos from e^y
 * - 1, does not. */
/* [phong-lobe] */
FORMULA OF(direction) OF(lobe)(REAL inverse_n1, REAL u1, REAL u2)
{
    const REAL one_minus_cos = OF(one_minus_exp)(OF(log1m)(u1) * inverse_n1);
    const REAL sine = OF(sqrt)(one_minus_cos * (2 - one_minus_cos));
    REAL s, c;

    OF(sincos2pi)(u2, &s, &c);
    return (OF(direction)){sine * c, sine * s, 1 - one_minus_cos};
}
/* [end] */

/* The frames about the normal and about r; 1/(n+1). */
typedef struct OF(draws) {
    frame local, about_r;
    REAL inverse_n1;
} OF(draws);

/* draws_of returns them. */
FORMULA OF(draws) OF(draws_of)(const bis_bsdf *b)
{
    return (OF(draws)){b->local, b->lobe, (REAL)(1 / (b->material->exponent + 1))};
}

/* draw returns a direction of the lobe, or of the cosine. */
/* [phong-draw] */
FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
{
    return OF(either)(specular, OF(turned)(&k->about_r, OF(lobe)(k->inverse_n1, u1, u2)),
                      OF(turned)(&k->local, OF(cosine)(u1, u2)));
}
/* [end] */
