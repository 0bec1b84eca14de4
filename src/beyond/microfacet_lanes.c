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
#include "cone_lanes.h"

#include <float.h>
#include <math.h>

/* [microfacet-lanes] */
static const float least_cos = 0x1p-24f; /* as in microfacet.c: nearer to the horizon, nothing is reflected */

/* What is the same for all directions. */
typedef struct constants {
    vec3 x, y, z;                 /* the frame of the normal */
    vec3 m;                       /* wo mirrored about the normal */
    float s_x, s_y, s_z, m_z;     /* m + wo and m in that frame */
    float c_o, S_o, a2, one_minus_a2;
    float Ks[3], rest[3], base[3]; /* F = Ks + rest (1 - cos theta_d)^5; the base is `base` A(c_i) */
    float real[3], half[3];       /* eta^2 - k^2 - 1 and eta^2 k^2 of a metal */
    int is_metal[3];              /* its channels, but those with Ks 0 or 1 */
    float scale[3], flat;         /* plastic: F over Fresnel's, and its A; else not used, and 0 */
    float lobe;                   /* a^2/(2 pi): D/2 = lobe R^2 */
    float pdf_lobe, pdf_base;     /* q_f = pdf_lobe R^2 + pdf_base c_i */
    bool has_lobe, has_metal;
} constants;

/* Which terms a loop needs: they are known when it is compiled. */
typedef enum terms { BASE, LOBE, METAL, PLASTIC } terms;

/* A(c) = 1 - (1 - c/2)^5, multiplied out as in microfacet.c. */
static inline BIS_INLINE float through_coat(const constants *k, float c, const terms has)
{
    const float x = c * 0.5f, A = x * (5 + x * (-10 + x * (10 + x * (-5 + x))));

    return has < PLASTIC ? A : k->flat;
}

static inline BIS_INLINE float stretched(const constants *k, float c)
{
    return sqrtf(k->a2 + k->one_minus_a2 * (c * c));
}

static inline BIS_INLINE float fifth_power(float x)
{
    const float x2 = x * x;

    return x2 * x2 * x;
}

/* wo mirrored about n, of wo's length. Above the least cosine, that of n to 2^-23. */
static void mirrored_view(const bis_bsdf *b, double m[3])
{
    const vec3 n = b->local.z, wo = b->wo;
    const double k = 2 * dot(n, wo) / dot(n, n);

    m[0] = k * (double)n.x - (double)wo.x;
    m[1] = k * (double)n.y - (double)wo.y;
    m[2] = k * (double)n.z - (double)wo.z;
}

/* eta^2 - 1 as a product, because it is small where eta is next to 1. */
static void metal_constants(constants *c, int i, double Ks, double eta)
{
    const bool is_plastic = c->flat > 0;
    c->real[i] = 1; /* of a channel that is none: no root of 0, no quotient 0/0 */
    if (is_plastic && !(bis_fresnel(eta, 0, 1) > 0)) c->Ks[i] = c->rest[i] = 0; /* of an index of 1 */
    c->is_metal[i] = eta > 0 && c->Ks[i] > 0 && Ks < 1;
    if (!c->is_metal[i]) return;
    const double k2 = is_plastic ? 0 : bis_fresnel_k2(Ks, eta);
    c->real[i] = (float)((eta - 1) * (eta + 1) - k2);
    c->half[i] = (float)(eta * eta * k2);
    if (is_plastic) c->scale[i] = (float)(Ks / bis_fresnel(eta, 0, 1));
    c->has_metal = true;
}

static constants constants_of(const bis_bsdf *b)
{
    const bis_material *material = b->material;
    const double a = material->alpha, c_o = dot(b->local.z, b->wo), S_o = sqrt(a * a + (1 - a * a) * c_o * c_o);
    const double Ks[3] = {(double)material->Ks.r, (double)material->Ks.g, (double)material->Ks.b};
    const double Kd[3] = {(double)material->Kd.r, (double)material->Kd.g, (double)material->Kd.b};
    const double eta[3] = {(double)material->eta.r, (double)material->eta.g, (double)material->eta.b};
    const bool is_plastic = material->model == &bis_plastic_model;
    const frame *f = &b->local;
    double m[3];

    mirrored_view(b, m);
    const vec3 mirror = vec3_from(m[0], m[1], m[2]);
    constants k = {.x = f->x,
                   .y = f->y,
                   .z = f->z,
                   .m = mirror,
                   .s_x = (float)(dot(mirror, f->x) + dot(b->wo, f->x)),
                   .s_y = (float)(dot(mirror, f->y) + dot(b->wo, f->y)),
                   .s_z = (float)(dot(mirror, f->z) + c_o),
                   .m_z = (float)dot(mirror, f->z),
                   .c_o = (float)c_o,
                   .S_o = (float)S_o,
                   .a2 = (float)(a * a),
                   .one_minus_a2 = (float)(1 - a * a),
                   .lobe = (float)(a * a * INV_PI / 2),
                   .pdf_lobe = (float)(b->p_specular * a * a * INV_PI / (2 * (c_o + S_o))),
                   .pdf_base = (float)((1 - b->p_specular) * INV_PI),
                   .flat = is_plastic ? (float)BIS_PLASTIC_A : 0,
                   .has_lobe = b->p_specular > 0};
    const double A_o = (double)through_coat(&k, (float)c_o, is_plastic ? PLASTIC : BASE);

    for (int i = 0; i < 3; i++) {
        if (c_o < (double)least_cos) break; /* all stays 0 */
        k.Ks[i] = (float)Ks[i];
        k.rest[i] = Ks[i] > 0 ? (float)(1 - Ks[i]) : 0;
        k.base[i] = (float)(28 / 23.0 * INV_PI * Kd[i] * (is_plastic ? 1 : 1 - Ks[i]) * A_o);
    }
    for (int i = 0; i < 3; i++) metal_constants(&k, i, Ks[i], eta[i]);
    k.has_metal &= k.has_lobe && c_o >= (double)least_cos;
    return k;
}

/* f = base A + F specular, 0 below the horizon; and what the density needs. */
typedef struct facet {
    float c_i, R2;                /* R^2 */
    float A, specular, x5;        /* D/(2 (c_i S_o + c_o S_i)), (1 - cos theta_d)^5 */
    float c_d, c2_d;              /* cos theta_d, and its square */
} facet;

static inline BIS_INLINE facet facet_at(const constants *k, float x, float y, float z, const terms has)
{
    const float dx = x - k->m.x, dy = y - k->m.y, dz = z - k->m.z;
    const float d_z = dx * k->z.x + dy * k->z.y + dz * k->z.z, c_i = d_z + k->m_z;
    const bool above = c_i >= least_cos;
    facet f = {.c_i = c_i, .A = bis_lanes_choose(above, through_coat(k, c_i, has), 0)};

    if (has >= LOBE) {
        const float s_x = dx * k->x.x + dy * k->x.y + dz * k->x.z + k->s_x;
        const float s_y = dx * k->y.x + dy * k->y.y + dz * k->y.z + k->s_y;
        const float s_z = d_z + k->s_z, across = s_x * s_x + s_y * s_y, along = s_z * s_z;
        const float s2 = across + along, squeezed = k->a2 * along + across;
        const float R = s2 / bis_lanes_choose(above, squeezed, 1), shadow = c_i * k->S_o + k->c_o * stretched(k, c_i);

        f.R2 = R * R;
        f.specular = bis_lanes_choose(above, k->lobe * f.R2 / bis_lanes_choose(above, shadow, 1), 0);
        f.c_d = sqrtf(s2) * 0.5f;
        f.c2_d = s2 * 0.25f;
        f.x5 = fifth_power(1 - f.c_d);
    }
    return f;
}

/* bis_fresnel. */
static inline BIS_INLINE float conductor(float real_1, float half, float c, float c2)
{
    const float s2 = bis_lanes_choose(c2 < 1, 1 - c2, 0), real = real_1 + bis_lanes_choose(c2 < 1, c2, 1);
    const float more = (sqrtf(real * real + 4 * half) + fabsf(real)) * 0.5f;
    const float less = half / bis_lanes_choose(more > 0, more, 1);
    const float a = sqrtf(bis_lanes_choose(real >= 0, more, less)), b2 = bis_lanes_choose(real >= 0, less, more);
    const float minus = c - a, plus = c + a, p_minus = a * c - s2, p_plus = a * c + s2, rest = b2 * c2;
    const float over_s = minus * minus + b2, under_s = plus * plus + b2; /* R_s, and R_p/R_s, in one quotient */
    const float over_p = p_minus * p_minus + rest, under_p = p_plus * p_plus + rest;

    return 0.5f * over_s * (under_p + over_p) / (under_s * under_p);
}

static inline BIS_INLINE float fresnel(const constants *k, const facet *f, int channel, const terms has)
{
    const float schlick = k->Ks[channel] + k->rest[channel] * f->x5;

    if (has < METAL) return schlick;
    const float F = conductor(k->real[channel], k->half[channel], f->c_d, f->c2_d);
    return bis_lanes_choose(k->is_metal[channel], has < PLASTIC ? F : k->scale[channel] * F, schlick);
}

static inline BIS_INLINE float f_of(const constants *k, const facet *f, int channel, const terms has)
{
    const float base = k->base[channel] * f->A;

    return has >= LOBE ? base + fresnel(k, f, channel, has) * f->specular : base;
}

/* ---- weights: phat/q, eq. 4.9 ---- */

static inline BIS_INLINE void weigh_as(float *w, const constants *c, const bis_lanes *y, uint32_t n, float em,
                                       float brdf, const terms has, const bool mixed)
{
    const constants k = *c;
    const bis_lanes l = *y;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const facet f = facet_at(&k, l.x[i], l.y[i], l.z[i], has);
        const float phat = f.c_i * (f_of(&k, &f, 0, has) * l.r[i] + f_of(&k, &f, 1, has) * l.g[i] +
                                    f_of(&k, &f, 2, has) * l.b[i]);
        float q = em * l.q_L[i];

        if (mixed) q += brdf * (k.pdf_lobe * f.R2 + k.pdf_base * bis_lanes_choose(f.c_i > 0, f.c_i, 0));
        /* q = 0: a black pixel; phat is 0, too. Below the horizon 0 f may be -0 */
        w[i] = bis_lanes_choose(phat > 0, phat / bis_lanes_choose(q > 0, q, 1), 0);
    }
}

BIS_LANES
static void weigh_facets(float *w, const constants *c, const bis_lanes *y, uint32_t n, float em, float brdf)
{
    if (c->flat > 0) {
        if (brdf > 0) weigh_as(w, c, y, n, em, brdf, PLASTIC, true);
        else weigh_as(w, c, y, n, em, brdf, PLASTIC, false);
    } else if (c->has_metal) {
        if (brdf > 0) weigh_as(w, c, y, n, em, brdf, METAL, true);
        else weigh_as(w, c, y, n, em, brdf, METAL, false);
    } else if (c->has_lobe) {
        if (brdf > 0) weigh_as(w, c, y, n, em, brdf, LOBE, true);
        else weigh_as(w, c, y, n, em, brdf, LOBE, false);
    } else {
        if (brdf > 0) weigh_as(w, c, y, n, em, brdf, BASE, true);
        else weigh_as(w, c, y, n, em, brdf, BASE, false);
    }
}

static double weigh(float *w, const bis_bsdf *b, const bis_lanes *y, uint32_t n, double beta)
{
    const constants c = constants_of(b);

    weigh_facets(w, &c, y, bis_lanes_round_up(n), (float)beta, (float)(1 - beta));
    return 1;
}

/* ---- colours: F/phat ---- */

static inline BIS_INLINE void colour_as(const constants *c, const bis_lanes *y, uint32_t n, const terms has)
{
    const constants k = *c;
    const bis_lanes l = *y;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const facet f = facet_at(&k, l.x[i], l.y[i], l.z[i], has); /* without a lobe times 0 */
        const float r = f_of(&k, &f, 0, has) * l.r[i], g = f_of(&k, &f, 1, has) * l.g[i],
                    b = f_of(&k, &f, 2, has) * l.b[i], sum = r + g + b;
        /* as in phong_lanes.c: sum = 0 fills the last block, and 1/sum of a denormal would be infinite */
        const float lift = bis_lanes_choose(sum < FLT_MIN, 0x1p64f, 1);
        const float share = 1 / (bis_lanes_choose(sum > 0, sum, 1) * lift);

        l.r[i] = r * lift * share;
        l.g[i] = g * lift * share;
        l.b[i] = b * lift * share;
    }
}

BIS_LANES
static void colour_facets(const constants *c, const bis_lanes *y, uint32_t n)
{
    if (c->flat > 0) colour_as(c, y, n, PLASTIC);
    else if (c->has_metal) colour_as(c, y, n, METAL);
    else colour_as(c, y, n, LOBE);
}

static void colour(const bis_bsdf *b, const bis_lanes *y, uint32_t n)
{
    const constants c = constants_of(b);

    colour_facets(&c, y, bis_lanes_round_up(n));
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
static inline BIS_INLINE void reach_as(float *w, const constants *c, vec3 wo, const bis_lanes *cone,
                                       const float *sine, uint32_t n, const terms has)
{
    const constants k = *c;
    const bis_lanes l = *cone;
    const vec3 behind = {-wo.x, -wo.y, -wo.z};

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float x = l.x[i], y = l.y[i], z = l.z[i], cosine = l.q_L[i];
        const float c_i = largest_cosine(k.z, x, y, z, cosine, sine[i]);
        const float c_m = largest_cosine(k.m, x, y, z, cosine, sine[i]), t2_mirror = (1 - c_m) / (1 + c_m);
        const float chord = sqrtf(sine[i] * sine[i] + (1 - cosine) * (1 - cosine)) + 0x1p-20f;
        const float hx = x + wo.x, hy = y + wo.y, hz = z + wo.z;
        const float s_x = hx * k.x.x + hy * k.x.y + hz * k.x.z, s_y = hx * k.y.x + hy * k.y.y + hz * k.y.z;
        const float s_z = hx * k.z.x + hy * k.z.y + hz * k.z.z + chord, p = sqrtf(s_x * s_x + s_y * s_y) - chord;
        /* no direction of the cone is above the horizon if s_z is not; least_cos keeps the quotient finite */
        const float t = bis_lanes_choose(p > 0, p, 0) / bis_lanes_choose(s_z > least_cos, s_z, least_cos);
        const float t2 = bis_lanes_choose(t * t > t2_mirror, t * t, t2_mirror), R = (1 + t2) / (k.a2 + t2);
        /* 2 cos^2 theta_d = 1 + wi wo */
        const float c_d = sqrtf((1 - largest_cosine(behind, x, y, z, cosine, sine[i])) * 0.5f);
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
static void reach_facets(float *w, const constants *c, vec3 wo, const bis_lanes *cone, const float *sine, uint32_t n)
{
    if (c->flat > 0) reach_as(w, c, wo, cone, sine, n, PLASTIC);
    else if (c->has_metal) reach_as(w, c, wo, cone, sine, n, METAL);
    else reach_as(w, c, wo, cone, sine, n, LOBE);
}

static void reach(float *w, const bis_bsdf *b, const bis_lanes *cone, const float *sine, uint32_t n)
{
    const constants c = constants_of(b);

    reach_facets(w, &c, b->wo, cone, sine, bis_lanes_round_up(n));
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

static void sample(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n)
{
    const draws d = draws_of(b);

    sample_facets(y, &d, u1, u2, bis_lanes_round_up(n));
}
/* [end] */

const bis_bsdf_lanes bis_microfacet_lanes = {weigh, colour, reach, sample};
