/* stats: p-values, for those who test samplers and for those who compare images.
 *
 * All p-values are computed as upper tails: 1 - P would be noise below 1e-16. */
#ifndef BIS_STATS_H
#define BIS_STATS_H

/* Q(a, x) = Gamma(a, x) / Gamma(a): the regularised upper incomplete gamma function, a > 0, x >= 0. Relative error at
 * most about 1e-13 sqrt(a) where the result is a normal number; 0 below. */
double bis_stats_gamma_q(double a, double x);

/* Probability that a chi-square variable of dof > 0 degrees of freedom is at least `statistic`. */
double bis_stats_chi_square_p(double statistic, double dof);

/* Probability that a standard normal variable is at least |z| away from 0, on either side. */
double bis_stats_normal_p(double z);

/* Probability that Student's t with dof > 0 degrees of freedom (any real) is at least |t| away from 0, on either side:
 * for means whose standard error was itself measured from few replicates. Relative error about 1e-12. */
double bis_stats_student_p(double t, double dof);

/* The significance at which each of m independent tests must be run so that all of them together raise a false alarm
 * with probability alpha: 1 - (1 - alpha)^(1/m) (Sidak 1967). m = 40, alpha = 0.01: 2.5e-4. */
double bis_stats_sidak(double alpha, double m);

#endif
