/* SPDX-License-Identifier: BSD-2-Clause */
/* model_one: f_pdf and sample of a bis_bsdf_model, for one direction in double, from a material's formulas. A material
 * is three files:
 *
 *     phong_formulas.h     its formulas, for real numbers
 *     phong.c              real_double.h, the formulas, this file; then what is asked once a point
 *     phong_many.c         real_float.h, the formulas, model_many.h: loops over many directions, as vectors
 *
 * The formulas define seven things:
 *
 *     KINDS            the number of forms of f whose loops are compiled apart, at most 4
 *     unit_of          the largest coefficient of f, > 0. In float f is divided by it, because a reflectance of 1e-40
 *                      would leave a float's range. 1 if f fits
 *     constants        what f needs and is the same for all directions; its `int kind` is in [0, KINDS)
 *     constants_of     the constants at a point, with f divided by `unit`
 *     f                f, the cosine and the density of what is drawn; `kind` is known when the loop is compiled. Below
 *                      the horizon of wi f may be anything finite
 *     draws            what drawing needs; draws_of makes it
 *     draw             the direction of (u1, u2): of the specular lobe, or of what is not specular */
#pragma once

/* f_pdf returns f and stores the density for one direction. */
static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const constants k = constants_of(b, 1);
    const reflection v = f(&k, (direction){(double)wi.x, (double)wi.y, (double)wi.z}, k.kind);

    *pdf = v.q;
    if (v.cos <= 0 || bis_bsdf_cos(b, b->wo) <= 0) return (rgb){0, 0, 0};
    return rgb_from(v.r, v.g, v.b);
}

/* sample draws one direction of the lobe or of the rest: "Deciding which term to sample from is made randomly in order
 * to remain unbiased" (3.5). */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    if (bis_bsdf_is_black(b)) return false;
    const draws k = draws_of(b);
    const direction w = draw(&k, u0 < b->p_specular, u1, u2);

    *wi = vec3_from(w.x, w.y, w.z);
    return true;
}
