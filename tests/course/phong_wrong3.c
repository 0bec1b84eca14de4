/* SPDX-License-Identifier: BSD-2-Clause */
/* The base without its 1/pi, and a sine through the rounded cosine. */
/* loses: narrow_lobes_keep_their_precision */
/* loses: f_is_eq_3_14 */
/* loses: the_albedo_comes_out_of_the_samples */
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
        k.base[i] = (REAL)(Kd[i] / unit);
    }
    return k;
}

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
/* [phong-lobe] */
FORMULA OF(direction) OF(lobe)(REAL inverse_n1, REAL u1, REAL u2)
{
    const REAL cos_theta = OF(exp)(OF(log1m)(u1) * inverse_n1), sine = OF(sqrt)(1 - cos_theta * cos_theta);
    REAL s, c;

    OF(sincos2pi)(u2, &s, &c);
    return (OF(direction)){sine * c, sine * s, cos_theta};
}
/* [end] */
