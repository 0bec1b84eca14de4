/* SPDX-License-Identifier: BSD-2-Clause */
/* stats: p-values, for testing samplers and for comparing images.
 *
 * All p-values are computed as upper tails, because 1 - P would be noise below 1e-16. */
#pragma once

/* bis_stats_gamma_q returns Q(a, x) = Gamma(a, x) / Gamma(a), the regularised upper incomplete gamma function, for a
 * > 0 and x >= 0. The relative error is at most about 1e-13 sqrt(a) if the result is a normal number; smaller results
 * are 0. */
double bis_stats_gamma_q(double a, double x);

/* bis_stats_chi_square_p returns the probability that a chi-square variable with dof > 0 degrees of freedom is at
 * least `statistic`. */
double bis_stats_chi_square_p(double statistic, double dof);

/* bis_stats_normal_p returns the probability that a standard normal variable is at least |z| away from 0, on either
 * side. */
double bis_stats_normal_p(double z);

/* bis_stats_student_p returns the probability that Student's t with dof degrees of freedom (any real > 0) is at least
 * |t| away from 0, on either side. It is for means whose standard error was itself measured from few replicates. The
 * relative error is about 1e-12. */
double bis_stats_student_p(double t, double dof);

/* bis_stats_sidak returns the significance for each of m independent tests such that all of them together raise a
 * false alarm with probability alpha: 1 - (1 - alpha)^(1/m) (Sidak 1967). m = 40 and alpha = 0.01 give 2.5e-4. */
double bis_stats_sidak(double alpha, double m);
