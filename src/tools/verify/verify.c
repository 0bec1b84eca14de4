/* SPDX-License-Identifier: BSD-2-Clause */
/* verify: the list of tests and how they are judged.
 *
 * p-values come from bis/stats.h as upper tails. m statistical tests at 1 - (1 - alpha)^(1/m) each (Sidak 1967) reject
 * something right with probability alpha in all, if independent, and less where they are positively dependent. Every p
 * here is a probability under what is right, or an upper bound of it: never too small, or a right sampler would be
 * accused. */
#include "verify.h"

#include "base/grow.h"
#include "base/text.h"
#include "bis/base/stats.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const double least_expected = 5;

/* ---- the list ---- */

bis_verify_test *bis_verify_new(bis_verify *v, const char *group, const char *name, ...)
{
    bis_verify_test *tests = bis_grow(v->tests, &v->capacity, v->n + 1, sizeof *tests), *t = &v->lost;
    va_list arguments;

    if (tests) {
        v->tests = tests;
        t = &v->tests[v->n++];
    } else {
        v->no_memory = true;
    }
    *t = (bis_verify_test){.group = group, .statistic = (double)NAN, .p = (double)NAN, .threshold = (double)NAN};
    va_start(arguments, name);
    vsnprintf(t->name, sizeof t->name, name, arguments);
    va_end(arguments);
    return t;
}

static void set_note(bis_verify_test *t, const char *note) { snprintf(t->note, sizeof t->note, "%s", note); }

void bis_verify_bound(bis_verify_test *t, double value, double limit, const char *note)
{
    t->statistic = value;
    t->threshold = limit;
    set_note(t, note);
    t->verdict = value >= 0 && value <= limit ? BIS_VERDICT_PASSED : BIS_VERDICT_FAILED; /* a NaN fails */
}

void bis_verify_p(bis_verify_test *t, double statistic, double p, const char *note)
{
    t->statistic = statistic;
    t->p = p >= 0 ? fmin(p, 1) : 0; /* a NaN is no defence */
    set_note(t, note);
}

void bis_verify_skip(bis_verify_test *t, const char *why)
{
    t->verdict = BIS_VERDICT_SKIPPED;
    set_note(t, why);
}

/* FNV-1a of the name, then mixed with the run's seed. */
uint64_t bis_verify_seed(const bis_verify *v, const char *name, ...)
{
    char text[160];
    va_list arguments;

    va_start(arguments, name);
    vsnprintf(text, sizeof text, name, arguments);
    va_end(arguments);
    return bis_hash(bis_hash(bis_fnv1a(BIS_FNV1A, text, strlen(text))) ^ v->seed);
}

/* ---- chi-square ---- */

/* Where cells expect 5, the statistic scatters more than chi-square, and its tail is longer: a half more often
 * below p = 0.01 where a few cells have the most draws. (O - E)^2/E of a Poisson variable has the cumulants 1, 2 + 1/E,
 * 8 + 22/E + 1/E^2; that the counts sum to n takes 1, 2 + (k^2 + 2k - 2)/n, 8 off their sums (the second exactly:
 * Haldane 1937; the third but for k/n). A gamma distribution with these three cumulants, shifted, gives p (Pearson's
 * type III). */
typedef struct pools {
    double observed, expected;           /* the open pool */
    double last_observed, last_expected; /* the last closed one, not yet in the statistic: it takes what is left over */
    double statistic, n, draws;
    double cumulant[2];                  /* the second and the third */
} pools;

static void count_last(pools *p)
{
    const double E = p->last_expected;
    if (E <= 0) return;
    const double difference = p->last_observed - E;
    p->statistic += difference * difference / E;
    p->cumulant[0] += 2 + 1 / E;
    p->cumulant[1] += 8 + 22 / E + 1 / (E * E);
    p->draws += E;
    p->n++;
}

/* k > 1 cells that expect 5 or more of n draws. The second cumulant is then at least (2k - 2)(1 - 1/n) > 0, because the
 * sum of 1/E is at least k^2/n. */
static double p_of(const pools *p)
{
    const double k = p->n, k2 = p->cumulant[0] - 2 - (k * k + 2 * k - 2) / p->draws, k3 = p->cumulant[1] - 8;
    const double a = k3 / (4 * k2), dof = k2 / (2 * a * a), shift = k - 1 - a * dof;
    return bis_stats_chi_square_p(fmax(0, (p->statistic - shift) / a), dof);
}

static void add_cell(pools *p, double observed, double expected)
{
    p->observed += observed;
    p->expected += expected;
    if (p->expected < least_expected) return;
    count_last(p);
    p->last_observed = p->observed;
    p->last_expected = p->expected;
    p->observed = p->expected = 0;
}

static void close_pools(pools *p)
{
    p->last_observed += p->observed;
    p->last_expected += p->expected;
    count_last(p);
}

void bis_verify_fit(bis_verify_test *t, const double *observed, const double *expected, size_t n)
{
    pools p = {0};
    double impossible = 0;
    for (size_t i = 0; i < n; i++) {
        if (expected[i] == 0) impossible += observed[i];
        add_cell(&p, observed[i], expected[i]);
    }
    close_pools(&p);
    t->dof = p.n - 1;
    if (impossible > 0) {
        bis_verify_p(t, p.statistic, 0, "");
        snprintf(t->note, sizeof t->note, "chi-square; %.0f draws fell where nothing can be drawn", impossible);
        return;
    }
    if (isnan(p.statistic)) {
        bis_verify_p(t, p.statistic, 0, "chi-square; an expected count is not a number");
        return;
    }
    bis_verify_p(t, p.statistic, t->dof > 0 ? p_of(&p) : 1, "");
    snprintf(t->note, sizeof t->note, "chi-square, %.0f degrees of freedom", t->dof);
}

/* ---- means ---- */

void bis_verify_add(bis_verify_moments *m, double x)
{
    const double d = x - m->mean, before = m->n++, step = d / m->n;
    m->mean += step;
    m->m3 += d * step * step * before * (before - 1) - 3 * step * m->m2;
    m->m2 += d * step * before;
}

double bis_verify_skewness(const bis_verify_moments *m) { return m->m2 > 0 ? m->m3 / pow(m->m2, 1.5) : 0; }

double bis_verify_skewness_beside(const bis_verify_moments *a, const bis_verify_moments *b, double of_a)
{
    return fabs(bis_verify_skewness(a)) * pow(of_a, 1.5) + fabs(bis_verify_skewness(b)) * pow(1 - of_a, 1.5);
}

/* The largest z up to which the bound of bis_verify_t falls. The tail of t falls by at least (dof - 1) z/(dof + z^2),
 * relative to itself: p(z) <= density(z) (dof + z^2)/((dof - 1) z), because 1 <= u/z below its integral. The factor
 * grows by s z^2. */
static double falls_up_to(double s, double dof)
{
    if (s == 0) return (double)INFINITY;
    double lo = 0, hi = 1 / s;
    for (int i = 0; i < 64; i++) {
        const double z = (lo + hi) / 2;
        if (s * z * (1 + z * z / dof) <= 1 - 1 / dof) lo = z;
        else hi = z;
    }
    return lo;
}

/* Student's t tells the chance where a mean is normally distributed. For a mean of skewness s, its tails at z are off
 * by exp(|s| z^3/3), to first order (Hall 1987): 3 at z = 4 for s = 0.05. The factor grows faster than the tail falls
 * beyond z = 1/|s|, or somewhat before for few runs; but what is farther is not likelier, so the bound there holds
 * beyond it, too. At s = 0.15 that is 8e-5, about the threshold of a test among 100. */
double bis_verify_t(double z, double dof, double skewness)
{
    const double s = fabs(skewness), x = fmin(fabs(z), falls_up_to(s, dof));
    const double p = isinf(dof) ? bis_stats_normal_p(x) : bis_stats_student_p(x, dof);
    return p > 0 ? fmin(1, p * exp(s * x * x * x / 3)) : 0;
}

void bis_verify_mean(bis_verify_test *t, const bis_verify_moments *runs, double expected, double slack)
{
    const double dof = runs->n - 1, se = dof > 0 ? sqrt(runs->m2 / dof / runs->n) : (double)NAN;
    const double difference = runs->mean - expected;
    const double excess = copysign(fmax(0, fabs(difference) - slack), difference), skewness = bis_verify_skewness(runs);
    if (isnan(difference) || isnan(se)) {
        bis_verify_p(t, difference, 0, "not a number");
    } else if (excess == 0) {
        bis_verify_p(t, 0, 1, "z; equal up to rounding and quadrature");
    } else {
        const double z = se > 0 ? excess / se : copysign((double)INFINITY, excess);
        t->dof = dof;
        bis_verify_p(t, z, se > 0 ? bis_verify_t(z, dof, skewness) : 0, "z");
    }
}

/* ---- the verdict ---- */

void bis_verify_begin(const bis_verify *v, const char *what)
{
    if (v->progress) v->progress(what, v->user);
}

bis_status bis_verify_judge(bis_verify *v, bis_diag *diag)
{
    v->n_statistical = v->n_failed = v->n_skipped = 0;
    for (size_t i = 0; i < v->n; i++) v->n_statistical += isnan(v->tests[i].p) ? 0 : 1;
    v->threshold = v->n_statistical ? bis_stats_sidak(BIS_VERIFY_ALPHA, (double)v->n_statistical) : BIS_VERIFY_ALPHA;
    for (size_t i = 0; i < v->n; i++) {
        bis_verify_test *t = &v->tests[i];
        if (!isnan(t->p)) {
            t->threshold = v->threshold;
            t->verdict = t->p < v->threshold ? BIS_VERDICT_FAILED : BIS_VERDICT_PASSED;
        }
        v->n_failed += t->verdict == BIS_VERDICT_FAILED;
        v->n_skipped += t->verdict == BIS_VERDICT_SKIPPED;
    }
    if (v->no_memory) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the list of tests");
    return BIS_OK;
}

void bis_verify_clear(bis_verify *v)
{
    bis_free(v->tests);
    *v = (bis_verify){.seed = v->seed,
                      .as_printed = v->as_printed,
                      .halvings = v->halvings,
                      .progress = v->progress,
                      .user = v->user};
}
