/* microfacet_lanes: microfacet.c for many directions at once, in float: 0.7 ns each with AVX-512 instead of 16. The
 * formulas are those of microfacet.c.
 *
 * Small differences. A lobe of alpha = 1e-4 is 2e-4 wide, and s = wi + wo in float would be wrong by a thousandth of
 * that. Therefore s is not added up. With m = wo mirrored about n, rounded to float, and d = wi - m,
 *
 *     s = d + (m + wo),
 *
 * where m + wo is computed once, in double. Within the lobe d is small and exact, and the error of s is a share of d.
 * A direction is drawn in the same way, as m + d: d comes from the facet without a difference of equals, see
 * sample_facets.
 *
 * What float costs. Let e = 2^-24, the error of one rounding. d.x, d.y and d.z have errors of 4 e |d| at most (a
 * difference, a product, two sums).
 * - D is R^2 times a constant, R = |s|^2 / (a^2 s_z^2 + |p|^2), p = (s_x, s_y). If dp and ds_z are the errors of p and
 *   s_z, R's is at most 2 dp/|p| + 2 ds_z s_z/|s|^2 + 8 e. wi and m are wo mirrored about h and n, so |d| <= 2 sin
 *   theta_h, while |p| = 2 cos theta_d sin theta_h. So dp/|p| <= 4 sqrt(2) e/cos theta_d + e, and, with ds_z <= 4 e |d|
 *   + 3 e s_z, ds_z s_z/|s|^2 <= 2 e/cos theta_d + 3 e. Together D is good to 31 e/cos theta_d + 32 e < 2^-18/cos
 *   theta_d.
 * - c_i has an absolute error of 8 e + 2 e < 2^-20, a relative one of 2^-20/c_i. It enters f cos once (the lobe:
 *   c_i/(c_i S_o + c_o S_i)) or twice (the base: c_i A), and q once.
 * - cos theta_d has an absolute error of half of sqrt(3) 8 e + 2 e, below 2^-21: F has one of 5 (1 - Ks) (1 - cos
 *   theta_d)^4 2^-21. That is at most 3e-6 of F for Ks = 0.04, 2^-19 Ks^(-1/5) of F for any Ks.
 * - A metal's F changes by what a change of cos theta_d by 2^-21 does, and by the roundings of r_s and r_p, a few e of
 *   1 each. |r_s| is at least sqrt(Ks), so these are below 2^-19/sqrt(Ks) of F.
 * - All else are some 20 roundings of positive terms: 2^-19.
 * No error grows as the lobe gets narrow. The same f stands in the weight that a candidate is chosen by and in what the
 * estimate divides by, so no bias comes of it but these errors of f and q themselves. Each weight is held against the
 * sum of these bounds in tests/beyond/test_microfacet_lanes.c.
 *
 * f lies between 2^-97 and 2^62 (bis_microfacet, least_cos), which floats hold: the unit of the weights is 1. */
#include "microfacet_lanes.h"

#include "bis/base/fresnel.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/cone.h"
#include "thesis/real.h"

#include <float.h>
#include <math.h>

/* [microfacet-lanes] */
#define LEAST_COS 0x1p-24 /* nearer to the horizon, nothing is reflected */
static const float least_cos = 0x1p-24f;
FORMULA float fabs_float(float x) { return fabsf(x); }
FORMULA double fabs_double(double x) { return fabs(x); }
/* Which terms a loop needs: they are known when it is compiled. */
typedef enum terms { BASE, LOBE, METAL, PLASTIC } terms;

/* wo mirrored about n, of wo's length. Above the least cosine, that of n to 2^-23. */
static void mirrored_view(const bis_bsdf *b, double m[3])
{
    const vec3 n = b->local.z, wo = b->wo;
    const double k = 2 * dot(n, wo) / dot(n, n);

    m[0] = k * (double)n.x - (double)wo.x;
    m[1] = k * (double)n.y - (double)wo.y;
    m[2] = k * (double)n.z - (double)wo.z;
}

#define REAL float
#include "microfacet_formulas.h"
#undef REAL
#define REAL double
#include "microfacet_formulas.h"
#undef REAL
typedef constants_float constants;
typedef facet_float facet;
#define constants_of constants_of_float
#define facet_at facet_at_float
#define f_of f_of_float
#define fresnel fresnel_float
#define through_coat through_coat_float
#define stretched stretched_float
#define fifth_power fifth_power_float

/* ---- f, cosine, density ---- */

static inline BIS_INLINE void facet_fs(const bis_reflected *o, const constants *c, const bis_lanes *y, uint32_t n,
                                       const terms has)
{
    const constants k = *c;
    const bis_lanes l = *y;
    const bis_reflected out = *o;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const facet f = facet_at(&k, l.x[i], l.y[i], l.z[i], has);
        out.r[i] = f_of(&k, &f, 0, has);
        out.g[i] = f_of(&k, &f, 1, has);
        out.b[i] = f_of(&k, &f, 2, has);
        out.cos[i] = f.c_i;
        out.q[i] = k.pdf_lobe * f.R2 + k.pdf_base * bis_lanes_choose(f.c_i > 0, f.c_i, 0);
    }
}

BIS_LANES
static void facet_f_lanes(const bis_reflected *f, const constants *c, const bis_lanes *y, uint32_t n)
{
    if (c->flat > 0) facet_fs(f, c, y, n, PLASTIC);
    else if (c->has_metal) facet_fs(f, c, y, n, METAL);
    else if (c->has_lobe) facet_fs(f, c, y, n, LOBE);
    else facet_fs(f, c, y, n, BASE);
}

double bis_microfacet_f_many(const bis_reflected *f, const bis_bsdf *b, const bis_lanes *y, uint32_t n)
{
    const constants c = constants_of(b);

    facet_f_lanes(f, &c, y, bis_lanes_round_up(n));
    return 1;
}

/* ---- bounds over cones ---- */

/* f, with F at facet f or head on, where it is larger. */
static inline BIS_INLINE float most_f(const constants *k, const facet *f, int channel, const terms has)
{
    if (has < METAL) return f_of(k, f, channel, has);
    const float F = fresnel(k, f, channel, has), Ks = k->Ks[channel];

    return k->base[channel] * f->A + bis_lanes_choose(F > Ks, F, Ks) * f->specular;
}

/* f cos is a product. Each factor is taken at its largest over the cone: F where wi is farthest from wo (a metal's
 * there or head on, because it has one minimum and no maximum between the ends), A(c_i) c_i and c_i/(c_i S_o + c_o S_i)
 * where c_i is largest, R where t = tan theta_h is smallest. Two bounds of t hold, of which the larger one is taken:
 * - wi and m are mirror images of wo about h and n: theta_h is at least half of the angle between them. This bound is
 *   good in the plane of incidence.
 * - no wi of the cone is farther from its axis than the chord of the half angle: |p| is smaller by that at most, s_z
 *   larger by that at most. This bound is good across, where a lobe at grazing angles is narrow. */
static inline BIS_INLINE void reach_as(float *w, const constants *c, vec3 wo, const bis_cones *cones,
                                       uint32_t n, const terms has)
{
    const constants k = *c;
    const bis_cones l = *cones;
    const vec3 behind = {-wo.x, -wo.y, -wo.z};

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float x = l.x[i], y = l.y[i], z = l.z[i], cosine = l.cosine[i];
        const float c_i = bis_cone_cosine(k.z, x, y, z, cosine, l.sine[i]);
        const float c_m = bis_cone_cosine(k.m, x, y, z, cosine, l.sine[i]), t2_mirror = (1 - c_m) / (1 + c_m);
        const float chord = sqrtf(l.sine[i] * l.sine[i] + (1 - cosine) * (1 - cosine)) + 0x1p-20f;
        const float hx = x + wo.x, hy = y + wo.y, hz = z + wo.z;
        const float s_x = hx * k.x.x + hy * k.x.y + hz * k.x.z, s_y = hx * k.y.x + hy * k.y.y + hz * k.y.z;
        const float s_z = hx * k.z.x + hy * k.z.y + hz * k.z.z + chord, p = sqrtf(s_x * s_x + s_y * s_y) - chord;
        /* no direction of the cone is above the horizon if s_z is not; least_cos keeps the quotient finite */
        const float t = bis_lanes_choose(p > 0, p, 0) / bis_lanes_choose(s_z > least_cos, s_z, least_cos);
        const float t2 = bis_lanes_choose(t * t > t2_mirror, t * t, t2_mirror), R = (1 + t2) / (k.a2 + t2);
        /* 2 cos^2 theta_d = 1 + wi wo */
        const float c_d = sqrtf((1 - bis_cone_cosine(behind, x, y, z, cosine, l.sine[i])) * 0.5f);
        const float c_up = bis_lanes_choose(c_i > least_cos, c_i, least_cos);
        const facet f = {.A = through_coat(&k, c_up, has),
                         .specular = k.lobe * (R * R) / (c_up * k.S_o + k.c_o * stretched(&k, c_up)),
                         .x5 = fifth_power(1 - c_d),
                         .c_d = c_d,
                         .c2_d = c_d * c_d};
        const float phat = most_f(&k, &f, 0, has) * l.r[i] + most_f(&k, &f, 1, has) * l.g[i] +
                           most_f(&k, &f, 2, has) * l.b[i];

        w[i] = bis_lanes_choose(c_i > 0, c_up * phat, 0);
    }
}

BIS_LANES
static void reach_facets(float *w, const constants *c, vec3 wo, const bis_cones *cones, uint32_t n)
{
    if (c->flat > 0) reach_as(w, c, wo, cones, n, PLASTIC);
    else if (c->has_metal) reach_as(w, c, wo, cones, n, METAL);
    else reach_as(w, c, wo, cones, n, LOBE);
}

void bis_microfacet_reach(float *w, const bis_bsdf *b, const bis_cones *cones, uint32_t n)
{
    const constants c = constants_of(b);

    reach_facets(w, &c, b->wo, cones, bis_lanes_round_up(n));
}

/* ---- drawing: a visible facet, or the cosine ---- */

typedef struct draws {
    frame local;
    float m[3], m_rest[3];        /* wo mirrored about the normal, and what its rounding left */
    float o[3], v[2];             /* wo in the local frame; the same, stretched to the unit sphere */
    float t, one_minus_v;         /* 1 + v_z, 1 - v_z */
    float a, p;
} draws;

static draws draws_of(const bis_bsdf *b)
{
    const double a = b->material->alpha;
    const double o[3] = {dot(b->wo, b->local.x), dot(b->wo, b->local.y), dot(b->wo, b->local.z)};
    const double scale = 1 / sqrt(a * a * (o[0] * o[0] + o[1] * o[1]) + o[2] * o[2]);
    const double v[3] = {a * o[0] * scale, a * o[1] * scale, o[2] * scale}, t = 1 + v[2];
    draws d = {.local = b->local,
               .v = {(float)v[0], (float)v[1]},
               .t = (float)t,
               .one_minus_v = (float)((v[0] * v[0] + v[1] * v[1]) / t),
               .a = (float)a,
               .p = (float)b->p_specular};
    double m[3];

    mirrored_view(b, m);
    for (int i = 0; i < 3; i++) {
        d.o[i] = (float)o[i];
        d.m[i] = (float)m[i];
        d.m_rest[i] = (float)(m[i] - (double)d.m[i]);
    }
    return d;
}

/* The facet h as in microfacet.c. wo mirrored about it is m + d. In the local frame, with P = o_x h_x + o_y h_y and H =
 * h_x^2 + h_y^2, the difference of 2 (wo h) h/|h|^2 - wo and 2 o_z n - wo is
 *     d = 2/|h|^2 ((wo h) h_x, (wo h) h_y, P h_z - o_z H). */
BIS_LANES
static void sample_facets(const bis_lanes *y, const draws *d, const float *u1, const float *u2, uint32_t n)
{
    const draws k = *d;
    const bis_lanes l = *y;
    const float inverse_p = k.p > 0 ? 1 / k.p : 0, inverse_rest = k.p < 1 ? 1 / (1 - k.p) : 0;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const bool specular = u1[i] < k.p;
        const float rest = bis_lanes_choose(specular, u1[i] * inverse_p, (u1[i] - k.p) * inverse_rest);
        /* the quotient may round up to 1 */
        const float u = bis_lanes_choose(rest < 0x1.fffffep-1f, rest, 0x1.fffffep-1f);
        const float sine = sqrtf(u * bis_lanes_choose(specular, k.t * (2 * (1 - u) + u * k.one_minus_v), 1));
        float s, c;

        bis_lanes_sincos2pi(u2[i], &s, &c);
        const float across = sine * c, along = sine * s;
        const float hx = k.a * (across + k.v[0]), hy = k.a * (along + k.v[1]), hz = (1 - u) * k.t;
        const float P = k.o[0] * hx + k.o[1] * hy, H = hx * hx + hy * hy, wo_h = P + k.o[2] * hz;
        const float scale = 2 / (H + hz * hz);
        const float lx = bis_lanes_choose(specular, scale * wo_h * hx, across);
        const float ly = bis_lanes_choose(specular, scale * wo_h * hy, along);
        const float lz = bis_lanes_choose(specular, scale * (P * hz - k.o[2] * H), sqrtf(1 - u));
        const float wx = lx * k.local.x.x + ly * k.local.y.x + lz * k.local.z.x;
        const float wy = lx * k.local.x.y + ly * k.local.y.y + lz * k.local.z.y;
        const float wz = lx * k.local.x.z + ly * k.local.y.z + lz * k.local.z.z;

        l.x[i] = bis_lanes_choose(specular, k.m[0] + (k.m_rest[0] + wx), wx);
        l.y[i] = bis_lanes_choose(specular, k.m[1] + (k.m_rest[1] + wy), wy);
        l.z[i] = bis_lanes_choose(specular, k.m[2] + (k.m_rest[2] + wz), wz);
    }
}

void bis_microfacet_sample_many(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n)
{
    const draws d = draws_of(b);

    sample_facets(y, &d, u1, u2, bis_lanes_round_up(n));
}
/* [end] */

rgb bis_microfacet_f_pdf_double(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const double c_o = bis_bsdf_cos(b, b->wo);

    *pdf = 0;
    if (c_o <= 0) return (rgb){0, 0, 0};
    const constants_double k = constants_of_double(b);
    const terms has = k.flat > 0 ? PLASTIC : k.has_metal ? METAL : k.has_lobe ? LOBE : BASE;
    const facet_double f = facet_at_double(&k, (double)wi.x, (double)wi.y, (double)wi.z, has);
    *pdf = k.pdf_lobe * f.R2 + k.pdf_base * (f.c_i > 0 ? f.c_i : 0);
    if (f.c_i < LEAST_COS || c_o < LEAST_COS) return (rgb){0, 0, 0};
    return rgb_from(f_of_double(&k, &f, 0, has), f_of_double(&k, &f, 1, has), f_of_double(&k, &f, 2, has));
}
