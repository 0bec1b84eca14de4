/* SPDX-License-Identifier: BSD-2-Clause */
/* auto_fit: how many candidates and rays? A camera sample of SIR costs and errs, nearly,
 *
 *     c = c0 + cM M + cN N,     v = v0 + A/M + B/N^e,
 *
 * c0 the camera ray and all else that is done once, v0 the noise of the pixel's area, A that of the candidates, B
 * that of the rays (docs/errata.md E31). e = 1 for independent marks. Systematic marks over stratified candidates
 * are stratified rays, whose noise at the edges of shadows falls with N^1.5: e = 1.5 (measured 1.3 to 1.7). The
 * error at equal time is c v. Its logarithm is convex in log M and log N, and has its least value where
 *
 *     cM M/c = (A/M)/v   and   cN N/c = e (B/N^e)/v:     the share of the time that goes into candidates is that of
 *     the variance which they leave, and with rays it is e times that.
 *
 * For a given N this is M = sqrt(A/cM) sqrt((c0 + cN N)/(v0 + B/N^e)). With e = 1 there is a formula for both, M =
 * sqrt(A/cM) sqrt(c0/v0), N = sqrt(B/cN) sqrt(c0/v0), by Cauchy's inequality c v >= (sqrt(c0 v0) + sqrt(cM A) +
 * sqrt(cN B))^2: so M/N = sqrt(A/B) sqrt(cN/cM), candidates go as the root of the price of a ray in candidates. The
 * noisier the pixel's area and the cheaper a camera ray, the fewer of both: time is then better spent on other
 * camera samples. N is small and an integer: all are tried.
 *
 * The fit is for use between the measurements and not far from them, and auto.c measures what it recommends. */
#include "auto_fit.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>

enum { UNKNOWNS = 3, MOST_ROWS = 32 };

/* ---- least squares ---- */

/* rows[n][3] p = 1 for the unknowns that are `free`, the others 0, by the normal equations. False: they are not told
 * apart. */
static bool solve(double p[UNKNOWNS], const double rows[][UNKNOWNS], int n, unsigned free)
{
    double a[UNKNOWNS][UNKNOWNS + 1] = {{0}}, diagonal[UNKNOWNS];

    for (int i = 0; i < UNKNOWNS; i++) {
        const bool is_free = free >> i & 1;
        for (int k = 0; k < n && is_free; k++) {
            for (int j = 0; j < UNKNOWNS; j++) a[i][j] += free >> j & 1 ? rows[k][i] * rows[k][j] : 0;
            a[i][UNKNOWNS] += rows[k][i];
        }
        if (!is_free) a[i][i] = 1;
    }
    for (int i = 0; i < UNKNOWNS; i++) diagonal[i] = a[i][i];
    for (int i = 0; i < UNKNOWNS; i++) {
        /* By Schwarz, what elimination leaves of a diagonal is 0 where its column depends on those before: then
         * but for rounding, some 1e-16 of it. */
        if (!(a[i][i] > 1e-12 * diagonal[i])) return false;
        for (int j = i + 1; j < UNKNOWNS; j++) {
            const double factor = a[j][i] / a[i][i];
            for (int k = i; k <= UNKNOWNS; k++) a[j][k] -= factor * a[i][k];
        }
    }
    for (int i = UNKNOWNS - 1; i >= 0; i--) {
        p[i] = a[i][UNKNOWNS];
        for (int j = i + 1; j < UNKNOWNS; j++) p[i] -= a[i][j] * p[j];
        p[i] /= a[i][i];
    }
    return true;
}

static double misfit(const double p[UNKNOWNS], const double rows[][UNKNOWNS], int n)
{
    double sum = 0;

    for (int k = 0; k < n; k++) {
        double d = -1;
        for (int i = 0; i < UNKNOWNS; i++) d += rows[k][i] * p[i];
        sum += d * d;
    }
    return sum;
}

/* The least misfit with all p >= 0: at it some of the unknowns are 0 and the others solve the normal equations, so all
 * eight choices are tried. */
static bis_auto_model fit(const double rows[][UNKNOWNS], int n)
{
    double best[UNKNOWNS] = {0}, least = (double)INFINITY;

    for (unsigned free = 0; free < 1u << UNKNOWNS; free++) {
        double p[UNKNOWNS];
        if (!solve(p, rows, n, free) || !(p[0] >= 0 && p[1] >= 0 && p[2] >= 0)) continue;
        const double m = misfit(p, rows, n);
        if (m >= least) continue;
        least = m;
        for (int i = 0; i < UNKNOWNS; i++) best[i] = p[i];
    }
    return (bis_auto_model){best[0], best[1], best[2]};
}

bis_auto_model bis_auto_fit_cost(const bis_auto_measured *m, int n)
{
    double rows[MOST_ROWS][UNKNOWNS];

    assert(n >= 1 && n <= MOST_ROWS);
    for (int i = 0; i < n; i++) {
        rows[i][0] = 1 / m[i].cost;
        rows[i][1] = m[i].M / m[i].cost;
        rows[i][2] = m[i].N / m[i].cost;
    }
    return fit(rows, n);
}

/* N^-e */
static double of_rays(uint32_t N) { return 1 / (N * sqrt(N)); }

bis_auto_model bis_auto_fit_variance(const bis_auto_measured *m, int n)
{
    double rows[MOST_ROWS][UNKNOWNS];

    assert(n >= 1 && n <= MOST_ROWS);
    for (int i = 0; i < n; i++) {
        rows[i][0] = 1 / m[i].variance;
        rows[i][1] = m[i].M ? 1 / (m[i].M * m[i].variance) : 0;
        rows[i][2] = of_rays(m[i].N) / m[i].variance;
    }
    return fit(rows, n);
}

/* ---- the optimum ---- */

double bis_auto_cost(const bis_auto_model *c, uint32_t M, uint32_t N)
{
    return c->constant + c->by_M * M + c->by_N * N;
}

double bis_auto_variance(const bis_auto_model *v, uint32_t M, uint32_t N)
{
    return v->constant + (M ? v->by_M / M : 0) + v->by_N * of_rays(N);
}

/* sqrt(a c0/(b v0)) within [lo, hi]: hi where nothing speaks against more, lo where nothing speaks for it. */
static uint32_t best_M(double a, double v0, double b, double c0, uint32_t lo, uint32_t hi)
{
    if (!(a > 0)) return lo;
    if (!(v0 > 0) || !(b > 0)) return hi;
    return (uint32_t)fmin(hi, fmax(lo, round(sqrt(a / b * (c0 / v0)))));
}

void bis_auto_best(uint32_t *M, uint32_t *N, const bis_auto_model *c, const bis_auto_model *v,
                   const bis_auto_limits *l)
{
    double least = (double)INFINITY;

    for (uint32_t n = l->min_N; n <= l->max_N; n++) {
        const double v0 = v->constant + v->by_N * of_rays(n), c0 = c->constant + c->by_N * n;
        const uint32_t m = l->max_M ? best_M(v->by_M, v0, c->by_M, c0, l->min_M, l->max_M) : 0;
        const double product = bis_auto_cost(c, m, n) * bis_auto_variance(v, m, n);
        if (n > l->min_N && product >= least) continue;
        least = product;
        *M = m;
        *N = n;
    }
}
