/* SPDX-License-Identifier: BSD-2-Clause */
/* stat: how our tests judge samplers and estimators. Shared by all test files; p-values from bis/stats.h.
 *
 * A test file states its family-wise significance and the number m of its statistical tests once, in stat_level. That
 * number is counted: the program fails at its end if it judged another. For every claim there is a twin: a plausible
 * wrong implementation that the same check must reject (stat_assert_no_fit, stat_assert_not_mean); twins do not count.
 * A failure prints statistic, degrees of freedom, p, alpha and seed; both histograms go to build/histograms/NAME.csv.
 * What holds leaves a line in build/power/PROGRAM.txt: the smallest error that this test finds with 99 % power
 * (docs/trust.md). */
#ifndef TESTS_STAT_H
#define TESTS_STAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct stat_result {
    double statistic, dof, p, alpha;
    bool rejected;
    const char *why; /* in words */
} stat_result;

/* stat_level returns the level of each of the m statistical tests of this program, by Sidak, so that a right program
 * fails with probability `significance` at most. m is the number of p-values that it judges: too large an m costs
 * power, too small an m breaks the promise. A program has one m. When it ends, after tests that all passed and without
 * BIS_TEST (which leaves tests out), it fails if m is not the number that stat_assert_fit, stat_assert_mean and
 * stat_judges have counted, and says which number to write. */
double stat_level(double significance, int m);

/* stat_keep_seeds(true) lets seeds stand as they are written, also under BIS_TEST_SEED, because what follows is the
 * known answer of one; stat_keep_seeds(false) ends it. */
void stat_keep_seeds(bool as_written);

/* stat_judges counts n p-values that the caller judges without an assertion of stat, or would judge if it did not skip.
 */
void stat_judges(int n);

/* stat_later judges a p-value when the program ends, because only then it is known how many there are: it must not be
 * below the level of stat_level(significance, m), where m is what stat_judges has counted. Such a program needs no
 * stat_level. The claim is said where it does not hold. */
void stat_later(double significance, double p, const char *claim, ...) __attribute__((format(printf, 3, 4)));

/* Pearson's chi-square test of observed counts against expected counts (not probabilities), n cells each. Cells that
 * expect fewer than 5 are pooled; what is left at the end joins the last pool. Rejects also: a hit in a cell that
 * expects 0; totals that differ by more than 0.1 sqrt(total), which could move the statistic by 0.01; a NaN
 * anywhere. */
stat_result stat_chi_square(const double *observed, const double *expected, size_t n, double alpha);

/* Running mean and variance, Welford 1962. Zero-initialise. */
typedef struct stat_moments {
    double n, mean, m2;
} stat_moments;

void stat_add(stat_moments *m, double x);

/* Variance of one value, unbiased; needs n >= 2. */
double stat_variance(const stat_moments *m);

/* Student's t-test of the mean against `expected`, standard error from the data. Where all values are equal, a
 * difference beyond 1e-12 of `expected` (rounding of the sum) rejects. */
stat_result stat_mean(const stat_moments *m, double expected, double alpha);

/* ---- power: how large must an error be to be found? ---- */

/* Probability that a chi-square test at `alpha` rejects when its statistic is noncentral chi-square: the tail of a
 * Poisson mixture of central ones. With n draws whose true cell probabilities are p (1 + e), noncentrality = n times
 * the mean of e^2 under p. */
double stat_power(double dof, double alpha, double noncentrality);

/* The root mean square relative error e (weighted by p) of a density that a chi-square test of n draws finds with
 * probability `power`: the inverse of stat_power, by bisection. */
double stat_least_error(double n, double dof, double alpha, double power);

/* The shift of a mean, in standard errors, that a two-sided z-test finds with probability `power`. */
double stat_least_shift(double alpha, double power);

/* cmocka assertions. stat_assert_mean also fails where no error below 50 % is found with 99 % power (not under
 * BIS_TEST_SEED, because the power changes with the draw): a mean that may be wrong by half and pass is no test.
 * `name` names the claim and the csv file (letters, digits, _ and -). */
void stat_assert_fit(const char *name, uint64_t seed, const double *observed, const double *expected, size_t n,
                     double alpha);
void stat_assert_no_fit(const char *name, uint64_t seed, const double *observed, const double *expected, size_t n,
                        double alpha);
void stat_assert_mean(const char *name, uint64_t seed, const stat_moments *m, double expected, double alpha);
void stat_assert_not_mean(const char *name, uint64_t seed, const stat_moments *m, double expected, double alpha);

#endif
