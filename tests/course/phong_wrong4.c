/* SPDX-License-Identifier: BSD-2-Clause */
/* The cosine for all, with its own density: a density that is drawn, but not the one that was asked for. */
/* loses: the_density_is_q_and_integrates_to_1 */
/* loses: samples_have_the_density */
/* [phong-f] */
FORMULA OF(constants) OF(constants_of)(const bis_bsdf *b, double unit)
{
    const bis_material *m = b->material;
    const double peak = (m->exponent + 1) * (INV_PI / 2), p = b->p_specular;
    const double Ks[3] = {(double)m->Ks.r, (double)m->Ks.g, (double)m->Ks.b};
    const double Kd[3] = {(double)m->Kd.r, (double)m->Kd.g, (double)m->Kd.b};
    OF(constants) k = {.n = b->local.z, .r = b->r, .exponent = (REAL)fmin(m->exponent, (double)FLT_MAX),
                       .pdf_lobe = 0, .pdf_base = (REAL)INV_PI, .kind = p > 0};

    for (int i = 0; i < 3; i++) {
        k.lobe[i] = (REAL)(Ks[i] * peak / unit);
        k.base[i] = (REAL)(Kd[i] * INV_PI / unit);
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
/* [phong-draw] */
FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
{
    (void)specular;
    return OF(turned)(&k->local, OF(cosine)(u1, u2));
}
/* [end] */
