/* phong_lanes: phong.c for many directions at once, in float: 1 to 2 ns each with AVX-512 instead of 25 (190 for a
 * direction drawn from the BRDF). The formulas are those of phong.c, line for line.
 *
 * What float costs. The lobe's power has a relative error below 2^-20 (1 + |log power|), plus n 2^-22/cos
 * where cos alpha is small, and never falls below 2^-64 (bis/lanes.h). The same power stands in the weight that a
 * candidate is chosen by and in what the estimate divides by, so no bias comes of it but this error of f itself: 1e-6
 * in the middle of the lobe, 2e-5 where it has fallen to 1e-9 of its peak (tests/beyond/test_phong_lanes.c).
 * Reflectances are divided by the largest of them: a material of reflectance 1e-40 would leave a float's range. */
#include "phong_lanes.h"

#include "bis/thesis/phong.h"
#include "cone_lanes.h"

#include <float.h>
#include <math.h>

/* [phong-lanes] */
/* What is the same for all directions: f = lobe K power + base, over `unit`. */
typedef struct constants {
    vec3 n, r;                /* normal; axis of the lobe */
    float exponent;
    float lobe[3], base[3];   /* Ks (n+1)/(2 pi), Kd/pi, over unit */
    float pdf_lobe, pdf_base; /* p_s (n+1)/(2 pi), p_d/pi */
    bool has_lobe;
} constants;

static constants constants_of(const bis_bsdf *b, double *unit)
{
    const bis_material *m = b->material;
    const double peak = (m->exponent + 1) * (INV_PI / 2);
    const double Ks[3] = {(double)m->Ks.r * peak, (double)m->Ks.g * peak, (double)m->Ks.b * peak};
    const double Kd[3] = {(double)m->Kd.r * INV_PI, (double)m->Kd.g * INV_PI, (double)m->Kd.b * INV_PI};
    constants c = {.n = b->local.z,
                   .r = b->r,
                   .exponent = (float)fmin(m->exponent, (double)FLT_MAX),
                   .has_lobe = b->p_specular > 0};

    *unit = fmax(fmax(fmax(Ks[0], Ks[1]), Ks[2]), fmax(fmax(Kd[0], Kd[1]), Kd[2]));
    for (int i = 0; i < 3; i++) {
        c.lobe[i] = (float)(Ks[i] / *unit);
        c.base[i] = (float)(Kd[i] / *unit);
    }
    c.pdf_lobe = (float)(b->p_specular * peak);
    c.pdf_base = (float)((1 - b->p_specular) * INV_PI);
    return c;
}

/* max(0, cos alpha)^n, as bis_phong_power. */
static inline BIS_INLINE float power(const constants *c, float x, float y, float z)
{
    const float dx = x - c->r.x, dy = y - c->r.y, dz = z - c->r.z;
    const float one_minus_cos = (dx * dx + dy * dy + dz * dz) * 0.5f;
    const bool ahead = one_minus_cos < 1;
    const float v = bis_lanes_exp(c->exponent * bis_lanes_log1m(bis_lanes_choose(ahead, one_minus_cos, 0)));

    return bis_lanes_choose(ahead, v, 0);
}

/* ---- weights: phat/q, eq. 4.9 ---- */

static inline BIS_INLINE void weigh_as(float *w, const constants *c, const bis_lanes *y, uint32_t n, float em,
                                       float brdf, const bool has_lobe, const bool mixed)
{
    const constants k = *c;
    const bis_lanes l = *y;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float cos_theta = k.n.x * l.x[i] + k.n.y * l.y[i] + k.n.z * l.z[i];
        float fr = k.base[0], fg = k.base[1], fb = k.base[2], q = em * l.q_L[i], p = 0;

        if (has_lobe) {
            p = power(&k, l.x[i], l.y[i], l.z[i]);
            fr += k.lobe[0] * p;
            fg += k.lobe[1] * p;
            fb += k.lobe[2] * p;
        }
        if (mixed) q += brdf * (k.pdf_lobe * p + k.pdf_base * bis_lanes_choose(cos_theta > 0, cos_theta, 0));
        const float phat = cos_theta * (fr * l.r[i] + fg * l.g[i] + fb * l.b[i]);
        /* q = 0: a black pixel, outside the lobe; phat is 0, too */
        w[i] = bis_lanes_choose(cos_theta > 0, phat / bis_lanes_choose(q > 0, q, 1), 0);
    }
}

BIS_LANES
static void weigh_lanes(float *w, const constants *c, const bis_lanes *y, uint32_t n, float em, float brdf)
{
    if (c->has_lobe) {
        if (brdf > 0) weigh_as(w, c, y, n, em, brdf, true, true);
        else weigh_as(w, c, y, n, em, brdf, true, false);
    } else {
        if (brdf > 0) weigh_as(w, c, y, n, em, brdf, false, true);
        else weigh_as(w, c, y, n, em, brdf, false, false);
    }
}

static double weigh(float *w, const bis_bsdf *b, const bis_lanes *y, uint32_t n, double beta)
{
    double unit;
    const constants c = constants_of(b, &unit);

    weigh_lanes(w, &c, y, bis_lanes_round_up(n), (float)beta, (float)(1 - beta));
    return unit;
}

/* ---- colours: F/phat ---- */

BIS_LANES
static void colour_lanes(const constants *c, const bis_lanes *y, uint32_t n)
{
    const constants k = *c;
    const bis_lanes l = *y;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float p = power(&k, l.x[i], l.y[i], l.z[i]); /* without a lobe times 0 */
        const float r = (k.base[0] + k.lobe[0] * p) * l.r[i];
        const float g = (k.base[1] + k.lobe[1] * p) * l.g[i];
        const float b = (k.base[2] + k.lobe[2] * p) * l.b[i];
        const float sum = r + g + b;
        /* sum = 0: what fills the last block. 1/sum of a denormal would be infinite: it is made a normal float first,
         * by a power of two, which rounds nothing. */
        const float lift = bis_lanes_choose(sum < FLT_MIN, 0x1p64f, 1);
        const float share = 1 / (bis_lanes_choose(sum > 0, sum, 1) * lift);

        l.r[i] = r * lift * share;
        l.g[i] = g * lift * share;
        l.b[i] = b * lift * share;
    }
}

static void colour(const bis_bsdf *b, const bis_lanes *y, uint32_t n)
{
    double unit;
    const constants c = constants_of(b, &unit);

    colour_lanes(&c, y, bis_lanes_round_up(n));
}

/* ---- bounds over cones ---- */

BIS_LANES
static void reach_lanes(float *w, const constants *c, const bis_lanes *cone, const float *sine, uint32_t n)
{
    const constants k = *c;
    const bis_lanes l = *cone;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float cos_theta = largest_cosine(k.n, l.x[i], l.y[i], l.z[i], l.q_L[i], sine[i]);
        const float cos_alpha = largest_cosine(k.r, l.x[i], l.y[i], l.z[i], l.q_L[i], sine[i]);
        const float x = bis_lanes_choose(cos_alpha > 0x1p-20f, 1 - cos_alpha, 1 - 0x1p-20f);
        const float p = bis_lanes_exp(k.exponent * bis_lanes_log1m(x));
        const float phat = (k.base[0] + k.lobe[0] * p) * l.r[i] + (k.base[1] + k.lobe[1] * p) * l.g[i] +
                           (k.base[2] + k.lobe[2] * p) * l.b[i];

        w[i] = bis_lanes_choose(cos_theta > 0, cos_theta * phat, 0);
    }
}

static void reach(float *w, const bis_bsdf *b, const bis_lanes *cone, const float *sine, uint32_t n)
{
    double unit;
    const constants c = constants_of(b, &unit);

    reach_lanes(w, &c, cone, sine, bis_lanes_round_up(n));
}

/* ---- drawing: the lobe by eq. 3.16, or the cosine ---- */

/* Two frames, and how often each is drawn from. */
typedef struct draws {
    frame lobe, local;
    float p, inverse_n1; /* 1/(n+1) */
} draws;

BIS_LANES
static void sample_lanes(const bis_lanes *y, const draws *d, const float *u1, const float *u2, uint32_t n)
{
    const draws k = *d;
    const bis_lanes l = *y;
    const float inverse_p = k.p > 0 ? 1 / k.p : 0, inverse_rest = k.p < 1 ? 1 / (1 - k.p) : 0;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const bool specular = u1[i] < k.p;
        const float stretched = bis_lanes_choose(specular, u1[i] * inverse_p, (u1[i] - k.p) * inverse_rest);
        /* the quotient may round up to 1 */
        const float u = bis_lanes_choose(stretched < 0x1.fffffep-1f, stretched, 0x1.fffffep-1f);
        const float one_minus_cos = bis_lanes_1mexp(bis_lanes_log1m(u) * k.inverse_n1);
        const float sine2 = bis_lanes_choose(specular, one_minus_cos * (2 - one_minus_cos), u), sine = sqrtf(sine2),
                    cosine = sqrtf(1 - u);
        float s, c;

        bis_lanes_sincos2pi(u2[i], &s, &c);
        const float a = sine * c, b = sine * s, h = bis_lanes_choose(specular, 1 - one_minus_cos, cosine);
        const float x1 = a * k.lobe.x.x + b * k.lobe.y.x + h * k.lobe.z.x,
                    x2 = a * k.local.x.x + b * k.local.y.x + h * k.local.z.x;
        const float y1 = a * k.lobe.x.y + b * k.lobe.y.y + h * k.lobe.z.y,
                    y2 = a * k.local.x.y + b * k.local.y.y + h * k.local.z.y;
        const float z1 = a * k.lobe.x.z + b * k.lobe.y.z + h * k.lobe.z.z,
                    z2 = a * k.local.x.z + b * k.local.y.z + h * k.local.z.z;

        l.x[i] = bis_lanes_choose(specular, x1, x2);
        l.y[i] = bis_lanes_choose(specular, y1, y2);
        l.z[i] = bis_lanes_choose(specular, z1, z2);
    }
}

static void sample(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n)
{
    const draws d = {b->lobe, b->local, (float)b->p_specular, (float)(1 / (b->material->exponent + 1))};

    sample_lanes(y, &d, u1, u2, bis_lanes_round_up(n));
}
/* [end] */

const bis_bsdf_lanes bis_phong_lanes = {weigh, colour, reach, sample};
