/* SPDX-License-Identifier: BSD-2-Clause */
/* direction_formulas: what the texts of all materials share, for REAL numbers (real.h). Included once for float and
 * once for double by model.h. */

/* A direction, or any vector. */
typedef struct OF(direction) {
    REAL x, y, z;
} OF(direction);

/* What a material says of a direction: f over a unit, the cosine, and the density of its draws. */
typedef struct OF(reflection) {
    REAL r, g, b, cos, q;
} OF(reflection);

/* along returns the component along an axis. */
FORMULA REAL OF(along)(vec3 axis, OF(direction) d)
{
    return d.x * (REAL)axis.x + d.y * (REAL)axis.y + d.z * (REAL)axis.z;
}

/* turned returns the local direction l in world space. */
FORMULA OF(direction) OF(turned)(const frame *f, OF(direction) l)
{
    return (OF(direction)){l.x * (REAL)f->x.x + l.y * (REAL)f->y.x + l.z * (REAL)f->z.x,
                           l.x * (REAL)f->x.y + l.y * (REAL)f->y.y + l.z * (REAL)f->z.y,
                           l.x * (REAL)f->x.z + l.y * (REAL)f->y.z + l.z * (REAL)f->z.z};
}

/* either returns yes ? a : b. */
FORMULA OF(direction) OF(either)(int yes, OF(direction) a, OF(direction) b)
{
    return (OF(direction)){OF(choose)(yes, a.x, b.x), OF(choose)(yes, a.y, b.y), OF(choose)(yes, a.z, b.z)};
}

/* cosine returns a direction about +z with the density cos theta/pi: a uniform disc, lifted to the hemisphere (Malley).
 * */
FORMULA OF(direction) OF(cosine)(REAL u1, REAL u2)
{
    const REAL sine = OF(sqrt)(u1);
    REAL s, c;

    OF(sincos2pi)(u2, &s, &c);
    return (OF(direction)){sine * c, sine * s, OF(sqrt)(1 - u1)};
}

/* The two parts of [0,1): below p the specular lobe is drawn. */
typedef struct OF(parts) {
    REAL p, inverse_p, inverse_rest;
} OF(parts);

/* parts_of returns the parts at p_specular. */
FORMULA OF(parts) OF(parts_of)(double p_specular)
{
    const REAL p = (REAL)p_specular;

    return (OF(parts)){p, p > 0 ? 1 / p : 0, p < 1 ? 1 / (1 - p) : 0};
}

/* place_in_part returns the place of u within its part, uniform in [0,1) again (bis_bsdf_draw). The quotient may round
 * up to 1. */
FORMULA REAL OF(place_in_part)(const OF(parts) *k, REAL u)
{
    const REAL place = OF(choose)(u < k->p, u * k->inverse_p, (u - k->p) * k->inverse_rest);

    return OF(choose)(place < OF(BELOW_1), place, OF(BELOW_1));
}
