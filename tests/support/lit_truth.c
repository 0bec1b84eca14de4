/* SPDX-License-Identifier: BSD-2-Clause */
/* lit_truth: brute force, and many estimates, see lit.h. In a file of its own, because a student's process holds lit.c.
 */
#include "lit.h"

#include "bis/beyond/microfacet.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/phong.h"
#include "claim.h"

#include <complex.h>

enum { W = LIT_WIDTH, H = LIT_HEIGHT };

enum { K = 8 }; /* midpoints a side: 0.35 degrees apart */

typedef struct node {
    double d[3], solid_angle;
    rgb L;
} node;

static node midpoint(const lit *l, int i, int k)
{
    const bis_envmap *em = bis_light_envmap(l->light);
    double y = i / W, x = i % W, c0 = cos(PI * y / H), c1 = cos(PI * (y + 1) / H);
    double z = c0 + (c1 - c0) * ((int)(k / K) + 0.5) / K, s = sqrt(1 - z * z),
           phi = 2 * PI * (x + (k % K + 0.5) / K) / W;

    return (node){{s * cos(phi), s * sin(phi), z}, (c0 - c1) * 2 * PI / W / (K * K),
        em ? em->pixels[i] : bis_light_Le(l->light, (vec3){0, 0, 1})};
}

static double dot_node(const node *w, vec3 v)
{
    return w->d[0] * (double)v.x + w->d[1] * (double)v.y + w->d[2] * (double)v.z;
}

double lit_fresnel(double Ks, double eta, double c)
{
    if (!(eta > 0 && Ks > 0 && Ks < 1)) return Ks > 0 ? Ks + (1 - Ks) * pow(1 - c, 5) : 0;
    const long double n = (long double)eta, c_o = (long double)c, r = (long double)Ks;
    const long double k2 = (r * (n + 1) * (n + 1) - (n - 1) * (n - 1)) / (1 - r);
    const long double complex index = n + (k2 > 0 ? sqrtl(k2) : 0) * (long double complex)I;
    const long double complex q = csqrtl(index * index - (1 - c_o * c_o));
    const long double s = cabsl((c_o - q) / (c_o + q)),
                      p = cabsl((index * index * c_o - q) / (index * index * c_o + q));
    return (double)((s * s + p * p) / 2);
}

/* Each channel: Ks times the lobe, with Fresnel's term at c, and Kd times the base. */
static rgbd mix(const bis_material *m, double lobe, double base, double at, bool coated)
{
    const double eta[3] = {(double)m->eta.r, (double)m->eta.g, (double)m->eta.b};
    const double Ks[3] = {(double)m->Ks.r, (double)m->Ks.g, (double)m->Ks.b},
                 Kd[3] = {(double)m->Kd.r, (double)m->Kd.g, (double)m->Kd.b};
    double c[3];

    for (int i = 0; i < 3; i++) {
        const double glass = pow((eta[i] - 1) / (eta[i] + 1), 2); /* of plastic, head on */
        const bool is_plastic = m->model == &bis_plastic_model;
        const double F = is_plastic ? Ks[i] / glass * lit_fresnel(glass, eta[i], at) : lit_fresnel(Ks[i], eta[i], at);
        c[i] = F * lobe + (coated && !is_plastic ? 1 - Ks[i] : 1) * Kd[i] * base;
    }
    return (rgbd){c[0], c[1], c[2]};
}

/* Eq. 3.14, 3.15: cos alpha = 2 (n.wi)(n.wo) - wi.wo. */
static rgbd phong(const bis_material *m, double c_i, double c_o, double wi_wo, double *pdf)
{
    const double a = 2 * c_i * c_o - wi_wo, n = m->exponent, lobe = a > 0 ? (n + 1) / (2 * PI) * pow(a, n) : 0;
    const double ks = rgb_sum(m->Ks), kd = rgb_sum(m->Kd);

    *pdf = (ks * lobe + kd * fmax(0, c_i) / PI) / (ks + kd);
    return mix(m, lobe, 1 / PI, 1, false);
}

static double smith(double a, double c) { return (sqrt(1 + a * a * (1 / (c * c) - 1)) - 1) / 2; }

/* As in the papers that include/bis/beyond/microfacet.h names: D, Lambda and G by cosines and tangents; tan theta_h
 * from what of wi + wo lies across n. */
static rgbd ggx(const bis_material *m, const node *wi, vec3 wo, vec3 n, double *pdf)
{
    const double c_i = dot_node(wi, n), c_o = dot(wo, n),
                 s[3] = {wi->d[0] + (double)wo.x, wi->d[1] + (double)wo.y, wi->d[2] + (double)wo.z};
    const double along = s[0] * (double)n.x + s[1] * (double)n.y + s[2] * (double)n.z, k = along / dot(n, n);
    const double x = s[0] - k * (double)n.x, y = s[1] - k * (double)n.y, z = s[2] - k * (double)n.z;
    const double c_d = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / 2, c_h = along / (2 * c_d),
                 tan2 = (x * x + y * y + z * z) / (along * along);
    const double a = m->alpha, D = a * a / (PI * pow(c_h, 4) * pow(a * a + tan2, 2)), G1 = 1 / (1 + smith(a, c_o));
    const bool is_plastic = m->model == &bis_plastic_model; /* its base is Lambert's: 28/23 coat_i coat_o is 1 */
    const double coat_o = is_plastic ? sqrt(23 / 28.0) : 1 - pow(1 - c_o / 2, 5);
    const double coat_i = is_plastic ? coat_o : 1 - pow(1 - c_i / 2, 5);
    const double ks = rgbd_sum(mix(m, 1, 0, c_o, true)), kd = rgbd_sum(mix(m, 0, coat_o, 1, true));

    *pdf = (ks * (c_h > 0 ? G1 * D / (4 * c_o) : 0) + kd * fmax(0, c_i) / PI) / (ks + kd);
    if (c_i <= 0) return (rgbd){0, 0, 0};
    return mix(
        m, D / (1 + smith(a, c_o) + smith(a, c_i)) / (4 * c_i * c_o), 28 / (23 * PI) * coat_i * coat_o, c_d, true);
}

rgbd lit_f(const lit *l, const double wi[3], double *pdf)
{
    const node w = {{wi[0], wi[1], wi[2]}, 0, {0, 0, 0}};
    const double c_i = dot_node(&w, l->pt.n);
    const rgbd f = l->material.alpha > 0
                       ? ggx(&l->material, &w, l->pt.wo, l->pt.n, pdf)
                       : phong(&l->material, c_i, dot(l->pt.n, l->pt.wo), dot_node(&w, l->pt.wo), pdf);

    return c_i > 0 ? f : (rgbd){0, 0, 0};
}

/* F = f cos Le. */
static rgbd F(const lit *l, const node *w)
{
    const double c = dot_node(w, l->pt.n);
    double pdf;

    if (c <= 0) return (rgbd){0, 0, 0};
    const rgbd f = lit_f(l, w->d, &pdf);
    return (rgbd){f.r * c * (double)w->L.r, f.g * c * (double)w->L.g, f.b * c * (double)w->L.b};
}

rgbd lit_truth(const lit *l, bool with_V)
{
    rgbd sum = {0, 0, 0};

    for (int i = 0; i < W * H; i++) {
        for (int k = 0; k < K * K; k++) {
            node w = midpoint(l, i, k);
            if (with_V && lit_is_hidden(l->accel.hidden, w.d[1])) break;
            sum = rgbd_add(sum, rgbd_scale(F(l, &w), w.solid_angle));
        }
    }
    return sum;
}

double lit_variance_em(const lit *l)
{
    double square = 0, mean = rgbd_sum(lit_truth(l, false));

    for (int i = 0; i < W * H; i++) {
        node centre = midpoint(l, i, K * K / 2 + K / 2);
        double q = bis_light_pdf(l->light, vec3_from(centre.d[0], centre.d[1], centre.d[2]));
        for (int k = 0; q > 0 && k < K * K; k++) {
            node w = midpoint(l, i, k);
            double phat = rgbd_sum(F(l, &w));
            square += phat * phat / q * w.solid_angle;
        }
    }
    return square - mean * mean;
}

/* ---- runs ---- */

void lit_run(stat_moments m[4], lit *l, const bis_settings *s, uint32_t runs, uint64_t seed)
{
    bis_scratch scratch;

    for (int i = 0; i < 4; i++) m[i] = (stat_moments){0};
    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    for (uint32_t run = 0; run < runs; run++) {
        rgb L = lit_once(l, s, &scratch, seed, run);
        assert_true(rgb_is_finite(L));
        stat_add(&m[0], (double)L.r);
        stat_add(&m[1], (double)L.g);
        stat_add(&m[2], (double)L.b);
        stat_add(&m[3], rgb_sum(L));
    }
    bis_scratch_clear(&scratch);
}

uint64_t lit_most_rays(lit *l, const bis_settings *s, uint32_t runs, uint64_t seed)
{
    uint64_t most = 0;
    bis_scratch scratch;

    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    for (uint32_t run = 0; run < runs; run++) {
        const uint64_t before = l->counters.shadow_rays;
        lit_once(l, s, &scratch, seed, run);
        if (l->counters.shadow_rays - before > most) most = l->counters.shadow_rays - before;
    }
    bis_scratch_clear(&scratch);
    return most;
}
