/* SPDX-License-Identifier: BSD-2-Clause */
/* model: the functions of a bis_bsdf_model from one text of formulas: f_pdf and sample for one direction in double,
 * f_many and sample_many for many directions in float, as vectors. A material's file says, once,
 *
 *     #define MODEL phong                              the name of its loops
 *     #define FORMULAS "thesis/phong_formulas.h"       its text
 *     #define KINDS 2                                  forms of f whose loops are compiled apart (a macro or an enum)
 *     #include "thesis/model.h"
 *
 * Before, it defines unit_of. The text, for REAL numbers (real.h), defines five things:
 *
 *     OF(constants)        what f needs and is the same for all directions; its `int kind` is in [0, KINDS)
 *     OF(constants_of)     the constants at a point, with f divided by `unit`
 *     OF(f)                f, the cosine and the density of what is drawn; `kind` is known when the loop is compiled.
 *                          Below the horizon of wi f may be anything finite
 *     OF(draws)            what drawing needs; OF(draws_of) makes it
 *     OF(draw)             the direction of (u1, u2): of the specular lobe, or of what is not specular */
#pragma once

#include "thesis/real.h"

#include "bis/thesis/bsdf.h"

/* unit_of returns the largest coefficient of f, > 0. In float f is divided by it, because a reflectance of 1e-40 would
 * leave a float's range. 1 if f fits. */
static double unit_of(const bis_bsdf *b);

/* Double first: constants of the float text may be computed by the double one. */
#define REAL double
#include "thesis/direction_formulas.h"
#include FORMULAS
#undef REAL
#define REAL float
#include "thesis/direction_formulas.h"
#include FORMULAS
#undef REAL

/* NAMED makes the names of loops: no two files may have a BIS_LANES function of one name (clones.h). */
#define NAMED(name) REAL_PASTE(MODEL, name)

/* f_pdf returns f and stores the density for one direction. */
static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const constants_double k = constants_of_double(b, 1);
    const reflection_double f = f_double(&k, (direction_double){(double)wi.x, (double)wi.y, (double)wi.z}, k.kind);

    *pdf = f.q;
    if (f.cos <= 0 || bis_bsdf_cos(b, b->wo) <= 0) return (rgb){0, 0, 0};
    return rgb_from(f.r, f.g, f.b);
}

/* sample draws one direction of the lobe or of the rest: "Deciding which term to sample from is made randomly in order
 * to remain unbiased" (3.5). */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    if (bis_bsdf_is_black(b)) return false;
    const draws_double k = draws_of_double(b);
    const direction_double w = draw_double(&k, u0 < b->p_specular, u1, u2);

    *wi = vec3_from(w.x, w.y, w.z);
    return true;
}

/* f_loop stores what f says of n directions, for one kind. */
FORMULA void f_loop(const bis_reflected *f, const constants_float *c, const bis_lanes *y, uint32_t n, const int kind)
{
    const constants_float k = *c;
    const bis_lanes l = *y;
    const bis_reflected o = *f;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const reflection_float v = f_float(&k, (direction_float){l.x[i], l.y[i], l.z[i]}, kind);
        o.r[i] = v.r;
        o.g[i] = v.g;
        o.b[i] = v.b;
        o.cos[i] = v.cos;
        o.q[i] = v.q;
    }
}

/* f_lanes does so for the kind at hand. */
BIS_LANES
static void NAMED(f_lanes)(const bis_reflected *f, const constants_float *c, const bis_lanes *y, uint32_t n)
{
    if (KINDS > 3 && c->kind == 3) f_loop(f, c, y, n, 3);
    else if (KINDS > 2 && c->kind == 2) f_loop(f, c, y, n, 2);
    else if (KINDS > 1 && c->kind == 1) f_loop(f, c, y, n, 1);
    else f_loop(f, c, y, n, 0);
}

/* f_many is bis_bsdf_f_many. */
static double f_many(const bis_reflected *f, const bis_bsdf *b, const bis_lanes *y, uint32_t n)
{
    const double unit = unit_of(b);
    const constants_float k = constants_of_float(b, unit);

    NAMED(f_lanes)(f, &k, y, bis_lanes_round_up(n));
    return unit;
}

/* draw_lanes draws by n points (u1, u2). */
BIS_LANES
static void NAMED(draw_lanes)(const bis_lanes *y, const draws_float *d, parts_float parts, const float *u1,
                              const float *u2, uint32_t n)
{
    const draws_float k = *d;
    const bis_lanes l = *y;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const direction_float w = draw_float(&k, u1[i] < parts.p, place_in_part_float(&parts, u1[i]), u2[i]);
        l.x[i] = w.x;
        l.y[i] = w.y;
        l.z[i] = w.z;
    }
}

/* sample_many is bis_bsdf_sample_many. */
static void sample_many(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n)
{
    const draws_float k = draws_of_float(b);

    NAMED(draw_lanes)(y, &k, parts_of_float(b->p_specular), u1, u2, bis_lanes_round_up(n));
}
