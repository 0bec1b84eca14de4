/* SPDX-License-Identifier: BSD-2-Clause */
/* moon_formulas: the law of Lommel and Seeliger for REAL numbers (thesis/real.h, thesis/model.h), f = Kd/(4 pi (cos
 * theta_i + cos theta_o)): dust as on the moon, whose disc is as bright at the rim as in the middle. */

typedef struct OF(constants) {
    vec3 n;
    REAL c_o, r, g, b; /* cos theta_o; Kd/(4 pi) over the unit */
    int kind;          /* 0, because f has one form */
} OF(constants);

FORMULA OF(constants) OF(constants_of)(const bis_bsdf *b, double unit)
{
    const rgb Kd = b->material->Kd;
    const double k = INV_PI / 4 / unit;

    return (OF(constants)){.n = b->local.z, .c_o = (REAL)bis_bsdf_cos(b, b->wo),
                           .r = (REAL)((double)Kd.r * k), .g = (REAL)((double)Kd.g * k), .b = (REAL)((double)Kd.b * k)};
}

FORMULA OF(reflection) OF(f)(const OF(constants) *k, OF(direction) wi, const int kind)
{
    const REAL cos_theta = OF(along)(k->n, wi), c_i = OF(choose)(cos_theta > 0, cos_theta, 0);
    const REAL share = 1 / (c_i + k->c_o);

    (void)kind;
    return (OF(reflection)){k->r * share, k->g * share, k->b * share, cos_theta, c_i * (REAL)INV_PI};
}

typedef struct OF(draws) {
    frame local;
} OF(draws);

FORMULA OF(draws) OF(draws_of)(const bis_bsdf *b)
{
    return (OF(draws)){b->local};
}

FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
{
    (void)specular; /* there is no lobe */
    return OF(turned)(&k->local, OF(cosine)(u1, u2));
}
