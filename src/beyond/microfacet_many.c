/* SPDX-License-Identifier: BSD-2-Clause */
/* microfacet_many: the formulas of microfacet.c in float, in loops over many directions that become vectors, and bounds
 * over cones. */
#include "thesis/real_float.h"

#include "beyond/microfacet_formulas.h"

#define MODEL facet
#include "thesis/model_many.h"

/* f, with F at facet f or head on, where it is larger. */
FORMULA float most_f(const constants *k, const facet *f, int channel, const int kind)
{
    if (kind < FRESNEL) return f_of(k, f, channel, kind);
    const float F = fresnel(&k->coat[channel], f->c_d, f->c2_d, f->x5, kind), Ks = k->coat[channel].Ks;

    return k->base[channel] * f->A + bis_lanes_choose(F > Ks, F, Ks) * f->specular;
}

/* f cos is a product. Each factor is taken at its largest over the cone: F where wi is farthest from wo (a metal's
 * there or head on, because it has one minimum and no maximum between the ends), A(c_i) c_i and c_i/(c_i S_o + c_o S_i)
 * where c_i is largest, R where t = tan theta_h is smallest. Two bounds of t hold, of which the larger one is taken:
 * - wi and m are mirror images of wo about h and n: theta_h is at least half of the angle between them. This bound is
 *   good in the plane of incidence.
 * - no wi of the cone is farther from its axis than the chord of the half angle: |p| is smaller by that at most, s_z
 *   larger by that at most. This bound is good across, where a lobe at grazing angles is narrow. */
FORMULA void reach_loop(float *w, const constants *c, vec3 wo, const bis_cones *cones, uint32_t n,
                        const int kind)
{
    const constants k = *c;
    const bis_cones l = *cones;
    const vec3 behind = neg(wo);
    const float least = (float)LEAST_COS;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float x = l.x[i], y = l.y[i], z = l.z[i], cosine = l.cosine[i];
        const float c_i = bis_cone_cosine(k.local.z, x, y, z, cosine, l.sine[i]);
        const float c_m = bis_cone_cosine(k.m, x, y, z, cosine, l.sine[i]), t2_mirror = (1 - c_m) / (1 + c_m);
        const float chord = sqrtf(l.sine[i] * l.sine[i] + (1 - cosine) * (1 - cosine)) + 0x1p-20f;
        const direction s = {x + wo.x, y + wo.y, z + wo.z};
        const float s_x = along(k.local.x, s), s_y = along(k.local.y, s);
        const float s_z = along(k.local.z, s) + chord, p = sqrtf(s_x * s_x + s_y * s_y) - chord;
        /* no direction of the cone is above the horizon if s_z is not; least keeps the quotient finite */
        const float t = bis_lanes_choose(p > 0, p, 0) / bis_lanes_choose(s_z > least, s_z, least);
        const float t2 = bis_lanes_choose(t * t > t2_mirror, t * t, t2_mirror), R = (1 + t2) / (k.a2 + t2);
        /* 2 cos^2 theta_d = 1 + wi wo */
        const float c_d = sqrtf((1 - bis_cone_cosine(behind, x, y, z, cosine, l.sine[i])) * 0.5f);
        const float c_up = bis_lanes_choose(c_i > least, c_i, least);
        const float shadow = c_up * k.S_o + k.c_o * stretched(k.a2, k.one_minus_a2, c_up);
        const facet f = {.A = through_coat(c_up, kind), .specular = k.lobe * (R * R) / shadow,
                               .c_d = c_d, .c2_d = c_d * c_d, .x5 = fifth_power(1 - c_d)};
        const float phat = most_f(&k, &f, 0, kind) * l.r[i] + most_f(&k, &f, 1, kind) * l.g[i] +
                           most_f(&k, &f, 2, kind) * l.b[i];

        w[i] = bis_lanes_choose(c_i > 0, c_up * phat, 0);
    }
}

BIS_LANES
static void facet_reach_lanes(float *w, const constants *c, vec3 wo, const bis_cones *cones, uint32_t n)
{
    if (c->kind == PLASTIC) reach_loop(w, c, wo, cones, n, PLASTIC);
    else if (c->kind == FRESNEL) reach_loop(w, c, wo, cones, n, FRESNEL);
    else reach_loop(w, c, wo, cones, n, LOBE);
}

static void reach(float *w, const bis_bsdf *b, const bis_cones *cones, uint32_t n)
{
    const constants c = constants_of(b, 1);

    facet_reach_lanes(w, &c, b->wo, cones, bis_lanes_round_up(n));
}

const bis_bsdf_many bis_microfacet_many = {.f = f_many, .sample = sample_many, .reach = reach},
                    bis_plastic_many = {.f = f_many, .sample = sample_many, .reach = reach};
