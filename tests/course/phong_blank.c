/* SPDX-License-Identifier: BSD-2-Clause */
/* [phong-f] */
FORMULA constants constants_of(const bis_bsdf *b, double unit)
{
    constants k = {.n = b->local.z, .r = b->r, .exponent = (real)fmin(b->material->exponent, (double)FLT_MAX),
                   .kind = b->p_specular > 0};

    /* Yours to write: k.lobe[3] and k.base[3], divided by unit; k.pdf_lobe and k.pdf_base. */
    (void)unit;
    return k;
}

FORMULA reflection f(const constants *k, direction wi, const int kind)
{
    const real cos_theta = along(k->n, wi);

    /* Yours to write: f of eq. 3.14 in three channels, and the density of the mixture of both lobes. Of use: power,
     * choose. kind == 1: there is a lobe. */
    (void)kind;
    return (reflection){0, 0, 0, cos_theta, 1};
}
/* [end] */
/* [phong-lobe] */
FORMULA direction lobe(real inverse_n1, real u1, real u2)
{
    /* Yours to write. */
    (void)inverse_n1, (void)u1, (void)u2;
    return (direction){0, (real)0.6, (real)0.8};
}
/* [end] */
/* [phong-draw] */
FORMULA direction draw(const draws *k, int specular, real u1, real u2)
{
    /* Yours to write: a direction of the lobe if specular, else of the cosine. Of use: lobe, cosine, turned,
     * either. */
    (void)k, (void)specular, (void)u1, (void)u2;
    return (direction){0, 0, 1};
}
/* [end] */
