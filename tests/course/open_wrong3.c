/* SPDX-License-Identifier: BSD-2-Clause */
/* A bound that is of no use; the base drawn where the lobe is due, on which proposals count. */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* loses: the_bound_of_rejection_holds */
/* [facet-draw] */
typedef struct OF(draws) {
    frame local;
    vec3 m, m_rest;              /* wo mirrored about the normal, and what its rounding left */
    REAL o[3], v[2];             /* wo in the frame; the same, stretched to the unit sphere */
    REAL t, one_minus_v;         /* 1 + v_z, 1 - v_z */
    REAL a;
} OF(draws);

static OF(draws) OF(draws_of)(const bis_bsdf *b)
{
    const double a = b->material->alpha;
    const double o[3] = {dot(b->wo, b->local.x), dot(b->wo, b->local.y), dot(b->wo, b->local.z)};
    const double scale = 1 / sqrt(a * a * (o[0] * o[0] + o[1] * o[1]) + o[2] * o[2]);
    const double v[3] = {a * o[0] * scale, a * o[1] * scale, o[2] * scale}, t = 1 + v[2];
    OF(draws) k = {.local = b->local,
                   .o = {(REAL)o[0], (REAL)o[1], (REAL)o[2]},
                   .v = {(REAL)v[0], (REAL)v[1]},
                   .t = (REAL)t,
                   .one_minus_v = (REAL)((v[0] * v[0] + v[1] * v[1]) / t),
                   .a = (REAL)a};

    k.m = mirrored_view(b, &k.m_rest);
    return k;
}

/* A visible facet, not of unit length, in the frame of the normal. c = (sin cos phi, sin sin phi, z), z uniform between
 * -v_z and 1. With t = 1 + v_z, 1 - z = u1 t and 1 + z = 2 (1 - u1) + u1 (1 - v_z): no difference of equals, h_z > 0
 * for every u1 < 1.
 *
 * wo mirrored about h is m + d. With P = o_x h_x + o_y h_y and H = h_x^2 + h_y^2, the difference of 2 (wo h) h/|h|^2 -
 * wo and 2 o_z n - wo is
 *     d = 2/|h|^2 ((wo h) h_x, (wo h) h_y, P h_z - o_z H). */
FORMULA OF(direction) OF(draw)(const OF(draws) *k, int is_specular, REAL u1, REAL u2)
{
    const int specular = !is_specular;
    const REAL sine = OF(sqrt)(u1 * (k->t * (2 * (1 - u1) + u1 * k->one_minus_v)));
    REAL s, c;

    OF(sincos2pi)(u2, &s, &c);
    const REAL hx = k->a * (sine * c + k->v[0]), hy = k->a * (sine * s + k->v[1]), hz = (1 - u1) * k->t;
    const REAL P = k->o[0] * hx + k->o[1] * hy, H = hx * hx + hy * hy, wo_h = P + k->o[2] * hz;
    const REAL scale = 2 / (H + hz * hz);
    const OF(direction) d = {scale * wo_h * hx, scale * wo_h * hy, scale * (P * hz - k->o[2] * H)};
    const OF(direction) w = OF(turned)(&k->local, OF(either)(specular, d, OF(cosine)(u1, u2)));
    const OF(direction) mirrored = {(REAL)k->m.x + ((REAL)k->m_rest.x + w.x), (REAL)k->m.y + ((REAL)k->m_rest.y + w.y),
                                    (REAL)k->m.z + ((REAL)k->m_rest.z + w.z)};

    return OF(either)(specular, mirrored, w);
}
/* [end] */
/* [facet-bound] */
/* A ratio of sums is at most the largest ratio of their terms: F G2/G1 / p_s with G2 <= G1, and the base's f cos over
 * p_d cos/pi. */
static double max_ratio(const bis_bsdf *b)
{
    const double p = b->p_specular;
    const double specular = p > 0 ? rgbd_max(most_fresnel(b)) / p : 0;
    const double diffuse = p < 1 ? rgbd_max(most_base(b)) / (1 - p) : 0;

    return fmax(specular, diffuse) * 1e30;
}
/* [end] */
