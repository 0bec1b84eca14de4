/* SPDX-License-Identifier: BSD-2-Clause */
/* The best weights of two techniques (docs/theory.md, "Multiple importance sampling"), solved there by hand.
 *
 * The other road: on eight patches all outcomes of the samples are enumerated, which gives the mean and the variance of
 * an estimate without any formula for them. The variance is a convex function of the eight weights that one is free to
 * choose (those of the second technique are 1 less them), so weights at which no derivative is left are the best there
 * are. */
#include "bis/thesis/rng.h"
#include "claim.h"

#include <math.h>
#include <stdbool.h>

enum { PATCHES = 8, CASES = 20 };

typedef struct problem {
    int n[2];
    double q[2][PATCHES], F[PATCHES], c[PATCHES]; /* densities by patch; c = n1 q1 + n2 q2 */
    double a, b[2], I;                            /* the page's */
} problem;

static void integrate(problem *p)
{
    p->a = p->b[0] = p->b[1] = p->I = 0;
    for (int x = 0; x < PATCHES; x++) {
        p->c[x] = p->n[0] * p->q[0][x] + p->n[1] * p->q[1][x];
        p->a += p->q[0][x] * p->q[1][x] / p->c[x];
        for (int i = 0; i < 2; i++) p->b[i] += p->q[i][x] * p->F[x] / p->c[x];
        p->I += p->F[x];
    }
}

static void make(problem *p, bis_rng *rng, int n1, int n2)
{
    *p = (problem){.n = {n1, n2}};
    for (int i = 0; i < 2; i++) {
        double sum = 0;
        for (int x = 0; x < PATCHES; x++) sum += p->q[i][x] = 0.05 + bis_rng_double(rng);
        for (int x = 0; x < PATCHES; x++) p->q[i][x] /= sum;
    }
    for (int x = 0; x < PATCHES; x++) p->F[x] = 0.1 + bis_rng_double(rng);
    integrate(p);
}

/* The weights h of the first technique. */
static void balance(double h[PATCHES], const problem *p)
{
    for (int x = 0; x < PATCHES; x++) h[x] = p->n[0] * p->q[0][x] / p->c[x];
}

static void by_hand(double h[PATCHES], const problem *p)
{
    double alpha[2];
    for (int i = 0; i < 2; i++) alpha[i] = p->n[i] * (p->b[i] - p->a * p->I) / (1 - (p->n[0] + p->n[1]) * p->a);
    for (int x = 0; x < PATCHES; x++) {
        const double g = alpha[0] * p->q[0][x] + alpha[1] * p->q[1][x];
        h[x] = alpha[0] * p->q[0][x] / p->F[x] + (1 - g / p->F[x]) * p->n[0] * p->q[0][x] / p->c[x];
    }
}

/* All outcomes of the n1 + n2 samples. Returns the variance. */
static double variance(const problem *p, const double h[PATCHES], double *mean)
{
    const int samples = p->n[0] + p->n[1];
    double square = 0;
    long outcomes = 1;

    for (int k = 0; k < samples; k++) outcomes *= PATCHES;
    *mean = 0;
    for (long outcome = 0; outcome < outcomes; outcome++) {
        double probability = 1, estimate = 0;
        long digits = outcome;
        for (int k = 0; k < samples; k++, digits /= PATCHES) {
            const int i = k >= p->n[0], x = (int)(digits % PATCHES);
            probability *= p->q[i][x];
            estimate += (i ? 1 - h[x] : h[x]) * p->F[x] / p->q[i][x] / p->n[i];
        }
        *mean += probability * estimate;
        square += probability * estimate * estimate;
    }
    return square - *mean * *mean;
}

/* The largest derivative of the variance by one of the weights. The variance is quadratic, so the difference over any
 * step is exact but for rounding: 1e-16 of a square of some 10, over steps of 1. */
static double slope(const problem *p, const double h[PATCHES])
{
    double most = 0, mean;
    for (int x = 0; x < PATCHES; x++) {
        double up[PATCHES], down[PATCHES];
        for (int y = 0; y < PATCHES; y++) {
            up[y] = h[y] + (x == y);
            down[y] = h[y] - (x == y);
        }
        most = fmax(most, fabs(variance(p, up, &mean) - variance(p, down, &mean)) / 2);
    }
    return most;
}

static const double rounding = 1e-11;

static void optimal_weights_by_hand_are_the_best(void **state)
{
    static const int n[3][2] = {{1, 1}, {2, 1}, {1, 3}};
    bis_rng rng;
    bis_rng_init(&rng, 3, 0, 0, 0);
    for (int k = 0; k < CASES; k++) {
        const int *m = n[k % 3];
        double h[PATCHES], mean[2];
        problem p;
        make(&p, &rng, m[0], m[1]);
        balance(h, &p);
        const double old = variance(&p, h, &mean[0]);
        assert_true(slope(&p, h) > 1e3 * rounding); /* the twin: other weights are found out */
        by_hand(h, &p);
        const double best = variance(&p, h, &mean[1]);
        for (int i = 0; i < 2; i++) assert_true(fabs(mean[i] - p.I) < rounding);
        assert_true(slope(&p, h) < rounding);
        const double d = p.b[0] - p.b[1], gain = p.a * m[0] * m[1] * d * d / (1 - (m[0] + m[1]) * p.a);
        assert_true(fabs(old - best - gain) < rounding);
    }
}

/* F + t q1, with t so that a sample of each technique brings as much as one of the other. */
static void the_balance_heuristic_is_the_best_where_both_bring_as_much(void **state)
{
    bis_rng rng;
    bis_rng_init(&rng, 4, 0, 0, 0);
    for (int k = 0; k < CASES; k++) {
        double h[PATCHES], a11 = 0;
        problem p;
        make(&p, &rng, 1, 1);
        for (int x = 0; x < PATCHES; x++) a11 += p.q[0][x] * p.q[0][x] / p.c[x];
        const double t = (p.b[1] - p.b[0]) / (a11 - p.a);
        for (int x = 0; x < PATCHES; x++) p.F[x] += t * p.q[0][x];
        integrate(&p);
        balance(h, &p);
        assert_true(slope(&p, h) < rounding);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(optimal_weights_by_hand_are_the_best),
        cmocka_unit_test(the_balance_heuristic_is_the_best_where_both_bring_as_much),
    };

    return cmocka_run_group_tests_name("optimal_mis", tests, NULL, NULL);
}
