/* SPDX-License-Identifier: BSD-2-Clause */
/* model_many: f_many and sample_many of a bis_bsdf_many, for many directions in float, as vectors, from a material's
 * formulas (model_one.h). Before, a file says, once, `#define MODEL phong`: the name of its loops, because no two files
 * may have a BIS_LANES function of one name (clones.h). */
#pragma once

#define MODEL_PASTE2(a, b) a##_##b
#define MODEL_PASTE(a, b) MODEL_PASTE2(a, b)
#define NAMED(name) MODEL_PASTE(MODEL, name)

/* f_loop stores what f says of n directions, for one kind. */
FORMULA void f_loop(const bis_reflected *to, const constants *c, const bis_lanes *y, uint32_t n, const int kind)
{
    const constants k = *c;
    const bis_lanes l = *y;
    const bis_reflected o = *to;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const reflection v = f(&k, (direction){l.x[i], l.y[i], l.z[i]}, kind);
        o.r[i] = v.r;
        o.g[i] = v.g;
        o.b[i] = v.b;
        o.cos[i] = v.cos;
        o.q[i] = v.q;
    }
}

/* f_lanes does so for the kind at hand. */
BIS_LANES
static void NAMED(f_lanes)(const bis_reflected *to, const constants *c, const bis_lanes *y, uint32_t n)
{
    if (KINDS > 3 && c->kind == 3) f_loop(to, c, y, n, 3);
    else if (KINDS > 2 && c->kind == 2) f_loop(to, c, y, n, 2);
    else if (KINDS > 1 && c->kind == 1) f_loop(to, c, y, n, 1);
    else f_loop(to, c, y, n, 0);
}

/* f_many is f of bis_bsdf_many. */
static double f_many(const bis_reflected *to, const bis_bsdf *b, const bis_lanes *y, uint32_t n)
{
    const double unit = unit_of(b);
    const constants k = constants_of(b, unit);

    NAMED(f_lanes)(to, &k, y, bis_lanes_round_up(n));
    return unit;
}

/* draw_lanes draws by n points (u1, u2). */
BIS_LANES
static void NAMED(draw_lanes)(const bis_lanes *y, const draws *d, parts lobes, const float *u1, const float *u2,
                              uint32_t n)
{
    const draws k = *d;
    const bis_lanes l = *y;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const direction w = draw(&k, u1[i] < lobes.p, place_in_part(&lobes, u1[i]), u2[i]);
        l.x[i] = w.x;
        l.y[i] = w.y;
        l.z[i] = w.z;
    }
}

/* sample_many is sample of bis_bsdf_many. */
static void sample_many(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n)
{
    const draws k = draws_of(b);

    NAMED(draw_lanes)(y, &k, parts_of(b->p_specular), u1, u2, bis_lanes_round_up(n));
}
