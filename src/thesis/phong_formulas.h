/* The formulas of thesis 3.5 for REAL numbers (real.h): eq. 3.14, the density of E35, and eq. 3.16. No #pragma once: phong.c
 * includes this text once for float and once for double. */

/* What is the same for all directions at a point: f = base + lobe cos^n alpha, over `unit`, and its density. */
typedef struct OF(phong) {
    vec3 n, r;                  /* normal; axis of the lobe: wo mirrored */
    frame local, about_r;
    REAL exponent, inverse_n1;  /* n, 1/(n+1) */
    REAL lobe[3], base[3];      /* Ks (n+1)/(2 pi), Kd/pi, over unit */
    REAL pdf_lobe, pdf_base;    /* p_s (n+1)/(2 pi), p_d/pi */
    REAL p;                     /* p_s */
    bool has_lobe;
} OF(phong);

/* max(0, cos alpha)^n with 1 - cos alpha = |wi - r|^2/2, which does not cancel (E36). 0^0 = 0 at the horizon. */
FORMULA REAL OF(phong_power)(vec3 axis, REAL n, REAL x, REAL y, REAL z)
{
    const REAL dx = x - (REAL)axis.x, dy = y - (REAL)axis.y, dz = z - (REAL)axis.z;
    const REAL one_minus_cos = (dx * dx + dy * dy + dz * dz) * (REAL)0.5;
    const bool ahead = one_minus_cos < 1;
    const REAL power = OF(exp)(n * OF(log1m)(OF(choose)(ahead, one_minus_cos, 0)));

    return OF(choose)(ahead, power, 0);
}

/* f of eq. 3.14 in three channels, the cosine, and the density of the mixture of lobes (E35). */
typedef struct OF(phong_value) {
    REAL r, g, b, cos, q;
} OF(phong_value);

FORMULA OF(phong_value) OF(phong_f)(const OF(phong) *k, REAL x, REAL y, REAL z, const bool has_lobe)
{
    const REAL cos_theta = (REAL)k->n.x * x + (REAL)k->n.y * y + (REAL)k->n.z * z;
    REAL r = k->base[0], g = k->base[1], b = k->base[2], power = 0;

    if (has_lobe) {
        power = OF(phong_power)(k->r, k->exponent, x, y, z);
        r += k->lobe[0] * power;
        g += k->lobe[1] * power;
        b += k->lobe[2] * power;
    }
    return (OF(phong_value)){r, g, b, cos_theta,
                             k->pdf_lobe * power + k->pdf_base * OF(choose)(cos_theta > 0, cos_theta, 0)};
}

/* The place of u within its lobe's part of [0,1): uniform again (bis_bsdf_draw). */
FORMULA REAL OF(phong_stretch)(const OF(phong) *k, REAL u, REAL inverse_p, REAL inverse_rest)
{
    const REAL place = OF(choose)(u < k->p, u * inverse_p, (u - k->p) * inverse_rest);

    return OF(choose)(place < OF(BELOW_1), place, OF(BELOW_1)); /* the quotient may round up to 1 */
}

/* Eq. 3.16 about r, or the cosine about n. */
typedef struct OF(phong_wi) {
    REAL x, y, z;
} OF(phong_wi);

FORMULA OF(phong_wi) OF(phong_draw)(const OF(phong) *k, bool specular, REAL u, REAL u2)
{
    const REAL one_minus_cos = OF(one_minus_exp)(OF(log1m)(u) * k->inverse_n1);
    const REAL sine2 = OF(choose)(specular, one_minus_cos * (2 - one_minus_cos), u), sine = OF(sqrt)(sine2),
               cosine = OF(sqrt)(1 - u);
    REAL s, c;

    OF(sincos2pi)(u2, &s, &c);
    const REAL a = sine * c, b = sine * s, h = OF(choose)(specular, 1 - one_minus_cos, cosine);
    const frame *l = &k->about_r, *n = &k->local;
    const REAL x1 = a * (REAL)l->x.x + b * (REAL)l->y.x + h * (REAL)l->z.x,
               x2 = a * (REAL)n->x.x + b * (REAL)n->y.x + h * (REAL)n->z.x;
    const REAL y1 = a * (REAL)l->x.y + b * (REAL)l->y.y + h * (REAL)l->z.y,
               y2 = a * (REAL)n->x.y + b * (REAL)n->y.y + h * (REAL)n->z.y;
    const REAL z1 = a * (REAL)l->x.z + b * (REAL)l->y.z + h * (REAL)l->z.z,
               z2 = a * (REAL)n->x.z + b * (REAL)n->y.z + h * (REAL)n->z.z;

    return (OF(phong_wi)){OF(choose)(specular, x1, x2), OF(choose)(specular, y1, y2), OF(choose)(specular, z1, z2)};
}

/* The constants. In float f is divided by its largest coefficient, because a reflectance of 1e-40 would leave a
 * float's range; in double unit is 1. */
FORMULA OF(phong) OF(phong_at)(const bis_bsdf *b, double unit)
{
    const bis_material *m = b->material;
    const double peak = (m->exponent + 1) * (INV_PI / 2), p = b->p_specular;
    const double Ks[3] = {(double)m->Ks.r, (double)m->Ks.g, (double)m->Ks.b};
    const double Kd[3] = {(double)m->Kd.r, (double)m->Kd.g, (double)m->Kd.b};
    OF(phong) k = {.n = b->local.z, .r = b->r, .local = b->local, .about_r = b->lobe,
                   .exponent = (REAL)fmin(m->exponent, (double)FLT_MAX), .inverse_n1 = (REAL)(1 / (m->exponent + 1)),
                   .pdf_lobe = (REAL)(p * peak), .pdf_base = (REAL)((1 - p) * INV_PI), .p = (REAL)p,
                   .has_lobe = p > 0};

    for (int i = 0; i < 3; i++) {
        k.lobe[i] = (REAL)(Ks[i] * peak / unit);
        k.base[i] = (REAL)(Kd[i] * INV_PI / unit);
    }
    return k;
}
