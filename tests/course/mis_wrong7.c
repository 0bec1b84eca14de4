/* SPDX-License-Identifier: BSD-2-Clause */
/* Two slips: the cosine is forgotten in the samples of the map, and the heuristic is always the balance heuristic. The
 * first one counts once, and does not hide the second. */
/* loses: a_diffuse_surface_in_the_open_is_right */
/* loses: the_power_heuristic_is_right */
/* loses: the_weights_are_those_of_the_power_heuristic */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    (void)heuristic;
    return own / (own + other);
}
/* [end] */
/* [mis-em] */
-        rgbd C = bis_estimate(f, y.Le, cos_theta, (double)n_em * y.pdf);
+        rgbd C = bis_estimate(f, y.Le, 1, (double)n_em * y.pdf);
/* [end] */
