/* stat: see stat.h. tests/test_stats.c tests the tests: they accept what is right at their rate and reject what is wrong. */
#include "stat.h"
#include "bis/stats.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/stat.h>

#include <cmocka.h>

static const double LEAST_EXPECTED = 5;

/* A pool of cells, and the sums over the pools that are closed. */
typedef struct pools {
    double observed, expected;           /* the open pool */
    double last_observed, last_expected; /* the last closed pool of several cells, not yet in the statistic */
    double statistic, n;
} pools;

static void count_cell(pools *p, double observed, double expected)
{
    double difference = observed - expected;
    p->statistic += difference * difference / expected;
    p->n++;
}

static void close_pool(pools *p)
{
    if (p->last_expected > 0) count_cell(p, p->last_observed, p->last_expected);
    p->last_observed = p->observed;
    p->last_expected = p->expected;
    p->observed = p->expected = 0;
}

static void add_cell(pools *p, double observed, double expected)
{
    if (expected >= LEAST_EXPECTED) {
        count_cell(p, observed, expected);
        return;
    }
    p->observed += observed;
    p->expected += expected;
    if (p->expected >= LEAST_EXPECTED) close_pool(p);
}

static void finish(pools *p)
{
    p->last_observed += p->observed;
    p->last_expected += p->expected;
    p->observed = p->expected = 0;
    close_pool(p);
}

stat_result stat_chi_square(const double *observed, const double *expected, size_t n, double alpha)
{
    stat_result r = {.alpha = alpha, .rejected = true, .why = "a cell of probability 0 was hit"};
    double total_observed = 0, total_expected = 0;
    pools p = {0};

    for (size_t i = 0; i < n; i++) {
        total_observed += observed[i];
        total_expected += expected[i];
        if (expected[i] == 0 && observed[i] != 0) return r;
        add_cell(&p, observed[i], expected[i]);
    }
    finish(&p);
    r.why = "the totals differ";
    if (!(fabs(total_observed - total_expected) <= 0.1 * sqrt(total_expected))) return r;

    r.statistic = p.statistic;
    r.dof = p.n - 1;
    r.p = r.dof > 0 && !isnan(r.statistic) ? bis_stats_chi_square_p(r.statistic, r.dof) : 1;
    r.rejected = isnan(r.statistic) || r.p < alpha;
    r.why = r.rejected ? "chi-square" : "fits";
    return r;
}

void stat_add(stat_moments *m, double x)
{
    double d = x - m->mean;
    m->n++;
    m->mean += d / m->n;
    m->m2 += d * (x - m->mean);
}

double stat_variance(const stat_moments *m) { return m->m2 / (m->n - 1); }

stat_result stat_mean(const stat_moments *m, double expected, double alpha)
{
    double error = sqrt(stat_variance(m) / m->n), difference = m->mean - expected;
    stat_result r = {.statistic = difference, .dof = m->n - 1, .alpha = alpha, .p = 1};

    if (error == 0) {
        r.rejected = !(fabs(difference) <= 1e-12 * fabs(expected));
    } else {
        r.statistic = difference / error;
        r.p = isnan(r.statistic) ? 0 : bis_stats_normal_p(r.statistic);
        r.rejected = !(r.p >= alpha);
    }
    r.why = r.rejected ? "z" : "fits";
    return r;
}

static void write_histograms(const char *name, const double *observed, const double *expected, size_t n)
{
    char path[256];
    mkdir("build", 0777);
    mkdir("build/histograms", 0777);
    snprintf(path, sizeof path, "build/histograms/%s.csv", name);
    FILE *f = fopen(path, "w");
    if (!f) return;
    fprintf(f, "cell,expected,observed\n");
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%zu,%.9g,%.9g\n", i, expected[i], observed[i]);
    fclose(f);
    print_error("both histograms are in %s\n", path);
}

static void fail_with(const char *name, const char *claim, uint64_t seed, stat_result r)
{
    fail_msg("%s %s (%s): statistic %g, %g degrees of freedom, p %.3g, alpha %.3g, seed %llu", name, claim, r.why,
             r.statistic, r.dof, r.p, r.alpha, (unsigned long long)seed);
}

static void judge_fit(const char *name, uint64_t seed, const double *observed, const double *expected, size_t n,
                      double alpha, bool must_be_rejected)
{
    stat_result r = stat_chi_square(observed, expected, n, alpha);
    if (r.rejected == must_be_rejected) return;
    write_histograms(name, observed, expected, n);
    fail_with(name, must_be_rejected ? "is wrong but was accepted" : "does not fit", seed, r);
}

void stat_assert_fit(const char *name, uint64_t seed, const double *observed, const double *expected, size_t n,
                     double alpha)
{
    judge_fit(name, seed, observed, expected, n, alpha, false);
}

void stat_assert_no_fit(const char *name, uint64_t seed, const double *observed, const double *expected, size_t n,
                        double alpha)
{
    judge_fit(name, seed, observed, expected, n, alpha, true);
}

static void judge_mean(const char *name, uint64_t seed, const stat_moments *m, double expected, double alpha,
                       bool must_be_rejected)
{
    stat_result r = stat_mean(m, expected, alpha);
    if (r.rejected == must_be_rejected) return;
    print_error("mean %.12g, expected %.12g, n %g\n", m->mean, expected, m->n);
    fail_with(name, must_be_rejected ? "has a wrong mean but was accepted" : "has a wrong mean", seed, r);
}

void stat_assert_mean(const char *name, uint64_t seed, const stat_moments *m, double expected, double alpha)
{
    judge_mean(name, seed, m, expected, alpha, false);
}

void stat_assert_not_mean(const char *name, uint64_t seed, const stat_moments *m, double expected, double alpha)
{
    judge_mean(name, seed, m, expected, alpha, true);
}
