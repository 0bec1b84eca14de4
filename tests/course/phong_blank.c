/* SPDX-License-Identifier: BSD-2-Clause */
/* [phong-f] */
FORMULA OF(constants) OF(constants_of)(const bis_bsdf *b, double unit)
{
    OF(constants) k = {.n = b->local.z, .r = b->r, .exponent = (REAL)fmin(b->material->exponent, (double)FLT_MAX),
                       .kind = b->p_specular > 0};

    /* Yours to write: k.lobe[3] and k.base[3], divided by unit; k.pdf_lobe and k.pdf_base. */
    (void)unit;
    return k;
}

FORMULA OF(reflection) OF(f)(const OF(constants) *k, OF(direction) wi, const int kind)
{
    const REAL cos_theta = OF(along)(k->n, wi);

    /* Yours to write: f of eq. 3.14 in three channels, and the density of the mixture of both lobes. Of use: OF(power),
     * OF(choose). kind == 1: there is a lobe. */
    (void)kind;
    return (OF(reflection)){0, 0, 0, cos_theta, 1};
}
/* [end] */
/* [phong-lobe] */
FORMULA OF(direction) OF(lobe)(REAL inverse_n1, REAL u1, REAL u2)
{
    /* Yours to write. */
    (void)inverse_n1, (void)u1, (void)u2;
    return (OF(direction)){0, (REAL)0.6, (REAL)0.8};
}
/* [end] */
/* [phong-draw] */
FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
{
    /* Yours to write: a direction of the lobe if specular, else of the cosine. Of use: OF(lobe), OF(cosine),
     * OF(turned), OF(either). */
    (void)k, (void)specular, (void)u1, (void)u2;
    return (OF(direction)){0, 0, 1};
}
/* [end] */
