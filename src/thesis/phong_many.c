/* SPDX-License-Identifier: BSD-2-Clause */
/* phong_many: thesis 3.5 for sets of candidates: the formulas of phong.c in float, in loops that become vectors. */
#include "thesis/real_float.h"

#include "thesis/phong_formulas.h"

#define MODEL phong
#include "thesis/model_many.h"

/* A bound of f cos over cones: power and cosine each at their largest. kind, as in f: without a lobe it has no power,
 * which is three quarters of the time. */
FORMULA void reach_loop(float *w, const constants *c, const bis_cones *cones, uint32_t n, const int kind)
{
    const constants k = *c;
    const bis_cones l = *cones;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float cos_theta = bis_cone_cosine(k.n, l.x[i], l.y[i], l.z[i], l.cosine[i], l.sine[i]);
        float p = 0;
        if (kind == 1) {
            const float cos_alpha = bis_cone_cosine(k.r, l.x[i], l.y[i], l.z[i], l.cosine[i], l.sine[i]);
            const float x = bis_lanes_choose(cos_alpha > 0x1p-20f, 1 - cos_alpha, 1 - 0x1p-20f);
            p = bis_lanes_exp(k.exponent * bis_lanes_log1m(x));
        }
        const float phat = (k.base[0] + k.lobe[0] * p) * l.r[i] + (k.base[1] + k.lobe[1] * p) * l.g[i] +
                           (k.base[2] + k.lobe[2] * p) * l.b[i];

        w[i] = bis_lanes_choose(cos_theta > 0, cos_theta * phat, 0);
    }
}

BIS_LANES
static void phong_reach_lanes(float *w, const constants *c, const bis_cones *cones, uint32_t n)
{
    if (c->kind == 1) reach_loop(w, c, cones, n, 1);
    else reach_loop(w, c, cones, n, 0);
}

static void reach(float *w, const bis_bsdf *b, const bis_cones *cones, uint32_t n)
{
    const constants k = constants_of(b, unit_of(b));

    phong_reach_lanes(w, &k, cones, bis_lanes_round_up(n));
}

const bis_bsdf_many bis_phong_many = {.f = f_many, .sample = sample_many, .reach = reach};
