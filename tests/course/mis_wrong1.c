/* SPDX-License-Identifier: BSD-2-Clause */
/* The counts are forgotten in the weight: these still sum to 1, so the mean is right, and the noise is not. */
/* loses: the_weights_are_those_of_the_balance_heuristic */
/* loses: the_weights_are_those_of_the_power_heuristic */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    (void)heuristic, (void)other;
    return own > 0 ? 0.5 : 0;
}
/* [end] */
