/* SPDX-License-Identifier: BSD-2-Clause */
/* stat: see stat.h. tests/base/test_stats.c tests the tests: they accept what is right at their rate and reject what is
 * wrong. */
#include "stat.h"
#include "bis/base/stats.h"
#include "claim.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

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
        r.p = isnan(r.statistic) ? 0 : bis_stats_student_p(r.statistic, r.dof);
        r.rejected = !(r.p >= alpha);
    }
    r.why = r.rejected ? "t" : "fits";
    return r;
}

/* ---- power ---- */

/* The x in [0, inf) with falling(x, a) = target. */
static double solve_falling(double (*falling)(double x, const double *a), const double *a, double target)
{
    double low = 0, high = 1;
    while (falling(high, a) > target) high *= 2;
    for (int i = 0; i < 60; i++) {
        double middle = (low + high) / 2;
        if (falling(middle, a) > target) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return (low + high) / 2;
}

static double chi_square_tail(double x, const double *dof) { return bis_stats_chi_square_p(x, *dof); }

static double upper_tail(double z, const double *unused)
{
    (void)unused;
    return bis_stats_normal_p(z) / 2;
}

/* Sum over j of Poisson(j; h) Q(dof/2 + j, y), h = noncentrality/2, over all j that matter; Q by its recurrence
 * Q(a+1, y) = Q(a, y) + y^a e^-y / Gamma(a+1). */
static double noncentral_tail(double x, double dof, double noncentrality)
{
    const double y = x / 2, h = noncentrality / 2, reach = 10 * sqrt(h) + 30;
    const double first = fmax(0, floor(h - reach)), last = ceil(h + reach);
    double a = dof / 2 + first, Q = bis_stats_gamma_q(a, y), step = exp(a * log(y) - y - lgamma(a + 1));
    double poisson = h > 0 ? exp(first * log(h) - h - lgamma(first + 1)) : 1, sum = 0;

    for (double j = first; j <= last; j++) {
        sum += poisson * fmin(Q, 1);
        Q += step;
        step *= y / ++a;
        poisson *= h / (j + 1);
    }
    return sum;
}

double stat_power(double dof, double alpha, double noncentrality)
{
    return noncentral_tail(solve_falling(chi_square_tail, &dof, alpha), dof, noncentrality);
}

static double missed(double noncentrality, const double *a) { return 1 - noncentral_tail(a[0], a[1], noncentrality); }

double stat_least_error(double n, double dof, double alpha, double power)
{
    const double a[] = {solve_falling(chi_square_tail, &dof, alpha), dof};
    return sqrt(solve_falling(missed, a, 1 - power) / n);
}

double stat_least_shift(double alpha, double power)
{
    return solve_falling(upper_tail, NULL, alpha / 2) + solve_falling(upper_tail, NULL, 1 - power);
}

static const double POWER = 0.99;

/* One file for each test program, begun anew with it: programs can run side by side, and again. */
static void power_path(char path[256])
{
    snprintf(path, 256, "build/power/%s.txt", program_invocation_short_name);
}

__attribute__((constructor)) static void begin_power_file(void)
{
    char path[256];
    power_path(path);
    unlink(path);
}

/* name, test, number of values, degrees of freedom, alpha, smallest error found. */
static void write_power(const char *name, const char *test, double n, stat_result r, double error)
{
    char path[256];
    power_path(path);
    mkdir("build", 0777);
    mkdir("build/power", 0777);
    FILE *f = fopen(path, "a");
    if (!f) return;
    fprintf(
        f, "%s\t%s\t%s\t%.0f\t%.0f\t%.3g\t%.3g\n", program_invocation_short_name, name, test, n, r.dof, r.alpha, error);
    fclose(f);
}

/* ---- the family: as many p-values as it was told ---- */

static int told, judged;
static pid_t program;

double stat_level(double significance, int m)
{
    if (told && told != m) fail_msg("stat_level: %d p-values, and %d before: a program has one family", m, told);
    told = m;
    return bis_stats_sidak(significance, m);
}

void stat_judges(int n) { judged += n; }

enum { MOST_LATER = 4096 };

static struct {
    double significance, p;
    char claim[200];
} later[MOST_LATER];
static int n_later;

void stat_later(double significance, double p, const char *claim, ...)
{
    va_list args;

    if (n_later == MOST_LATER) fail_msg("stat_later: more than %d p-values", MOST_LATER);
    later[n_later].significance = significance;
    later[n_later].p = p;
    va_start(args, claim);
    vsnprintf(later[n_later].claim, sizeof later[n_later].claim, claim, args);
    va_end(args);
    n_later++;
}

static bool judge_later(void)
{
    bool holds = true;

    for (int i = 0; i < n_later; i++) {
        const double level = bis_stats_sidak(later[i].significance, judged);
        if (later[i].p >= level) continue;
        holds = false;
        fprintf(stderr, "stat: %s: p %.3g is below %.3g, the level of each of %d p-values\n", later[i].claim,
                later[i].p, level, judged);
    }
    return holds;
}

/* Not in children that a test has forked. The count is not held where a test failed, because it may have judged less,
 * nor where nobody tells one. */
static void check_family(int status, void *unused)
{
    (void)unused;
    if (getpid() != program) return;
    bool holds = judge_later();
    if (status == 0 && !getenv("BIS_TEST") && told != judged && !(told == 0 && n_later > 0)) {
        fprintf(stderr, "stat: %d p-values were judged, and stat_level was told %d: write %d\n", judged, told, judged);
        holds = false;
    }
    if (holds) return;
    fflush(NULL);
    _exit(1);
}

__attribute__((constructor)) static void watch_family(void)
{
    program = getpid();
    on_exit(check_family, NULL);
}

/* ---- assertions ---- */

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
    if (!must_be_rejected) stat_judges(1);
    if (r.rejected == must_be_rejected) {
        double total = 0;
        for (size_t i = 0; i < n; i++) total += observed[i];
        if (!r.rejected && r.dof > 0)
            write_power(name, "chi-square", total, r, stat_least_error(total, r.dof, alpha, POWER));
        return;
    }
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

static const double WEAKEST = 0.5;

static void judge_mean(const char *name, uint64_t seed, const stat_moments *m, double expected, double alpha,
                       bool must_be_rejected)
{
    stat_result r = stat_mean(m, expected, alpha);
    if (!must_be_rejected) stat_judges(1);
    if (r.rejected == must_be_rejected) {
        double error = sqrt(stat_variance(m) / m->n);
        if (r.rejected || !(error > 0) || expected == 0) return;
        const double least = stat_least_shift(alpha, POWER) * error / fabs(expected);
        write_power(name, "mean", m->n, r, least);
        if (least > WEAKEST && !getenv("BIS_TEST_SEED"))
            fail_msg("%s finds no error below %.0f %% of the mean: give it more values", name, 100 * least);
        return;
    }
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
