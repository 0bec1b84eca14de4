/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_mis: what multiple importance sampling can reach at a point, by the balance heuristic and by the best weights.
 *
 * docs/theory.md, "The best weights", has the derivation. With c = n1 q1 + n2 q2 an estimate by the balance heuristic
 * is a sum of F/c over all samples. The best weights subtract g = beta (q1 - q2) from F, which changes no mean because
 * g integrates to 0. An estimate is a sum of independent samples, so its variance is
 *
 *     n1 Var_1[(F - g)/c] + n2 Var_2[(F - g)/c],      Var_i: under q_i,
 *
 * a square in beta, whose minimum is known. The variances are estimated from many samples of both techniques. That of
 * the best weights is then never negative, and 0 where F is a mixture of q1 and q2. beta belongs to the same samples,
 * which makes the variance too small by one part in their number. */
#include "pixel.h"

#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "thesis/mis.h"
#include "tools/verify/verify.h"

static const uint64_t purpose_mis = (uint64_t)0x7a << 40;

/* A sample: F/c of r+g+b, with V, and (q1 - q2)/c. */
typedef struct sample {
    double F, difference;
} sample;

/* Draws from the map (of_map) or from the BRDF. What cannot be drawn, or has no density, is 0. */
static sample draw(const bis_point *pt, bool of_map, double n1, double n2, bis_rng *rng)
{
    bis_light_point y = {.pdf = 0};
    double u[4];

    for (int d = 0; d < 4; d++) u[d] = bis_rng_double(rng);
    if (!(of_map ? bis_light_sample(pt->light, u, &y) : bis_bsdf_draw(&pt->bsdf, u, &y.wi))) return (sample){0, 0};
    const double q1 = of_map ? y.pdf : bis_light_pdf(pt->light, y.wi), q2 = bis_bsdf_pdf(&pt->bsdf, y.wi);
    const double c = n1 * q1 + n2 * q2, F = bis_pixel_product(pt, y.wi);
    if (!(c > 0)) return (sample){0, 0}; /* the lobe underflows */
    return (sample){F > 0 && bis_point_sees(pt, y.wi) ? F / c : 0, (q1 - q2) / c};
}

/* The samples of one technique: those of numbers [first, end) of each of n estimates. s[n][N]. */
typedef struct technique {
    const sample *s;
    size_t n;
    uint32_t N, first, end;
} technique;

/* Means, and sums of squares and products about them. */
typedef struct moments {
    double F, difference, FF, Fd, dd;
} moments;

static moments moments_of(technique t)
{
    const double count = (double)t.n * (t.end - t.first);
    moments m = {0, 0, 0, 0, 0};

    for (size_t i = 0; i < t.n; i++)
        for (uint32_t j = t.first; j < t.end; j++) {
            m.F += t.s[i * t.N + j].F / count;
            m.difference += t.s[i * t.N + j].difference / count;
        }
    for (size_t i = 0; i < t.n; i++)
        for (uint32_t j = t.first; j < t.end; j++) {
            const double F = t.s[i * t.N + j].F - m.F, d = t.s[i * t.N + j].difference - m.difference;
            m.FF += F * F;
            m.Fd += F * d;
            m.dd += d * d;
        }
    return m;
}

/* n Var of the samples less beta differences. */
static double squares(technique t, const moments *m, double beta)
{
    double sum = 0;

    for (size_t i = 0; i < t.n; i++)
        for (uint32_t j = t.first; j < t.end; j++) {
            const double x = t.s[i * t.N + j].F - m->F - beta * (t.s[i * t.N + j].difference - m->difference);
            sum += x * x;
        }
    return sum / ((double)t.n - 1.0 / (t.end - t.first));
}

bis_status bis_pixel_mis_of(bis_pixel_mis *mis, const bis_point *pt, const bis_settings *settings, size_t n,
                            uint64_t seed, bis_diag *diag)
{
    const uint32_t N = settings->samples, n1 = bis_mis_samples_em(settings), n2 = N - n1;
    sample *s = n <= SIZE_MAX / N ? bis_alloc(n * N, sizeof *s) : NULL;

    if (!s) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu times %u samples", n, (unsigned)N);
    for (size_t i = 0; i < n; i++) {
        bis_rng rng;
        bis_rng_init(&rng, seed, i, 0, purpose_mis);
        for (uint32_t j = 0; j < N; j++) s[i * N + j] = draw(pt, j < n1, n1, n2, &rng);
    }
    const technique by_map = {s, n, N, 0, n1}, by_brdf = {s, n, N, n1, N};
    const moments m1 = moments_of(by_map), m2 = moments_of(by_brdf);
    const double scatter = m1.dd + m2.dd;
    mis->mean = n1 * m1.F + n2 * m2.F;
    mis->beta = scatter > 0 ? (m1.Fd + m2.Fd) / scatter : 0; /* 0: q1 = q2, or they do not overlap: nothing to gain */
    mis->overlap = 1 - (double)n1 * n2 / N * (m1.difference - m2.difference); /* int (q1 - q2)^2/c of the derivation */
    for (int k = 0; k < 2; k++)
        mis->variance[k] = squares(by_map, &m1, k * mis->beta) + squares(by_brdf, &m2, k * mis->beta);
    bis_free(s);
    return BIS_OK;
}
