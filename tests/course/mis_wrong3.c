/* SPDX-License-Identifier: BSD-2-Clause */
/* The BRDF alone: unbiased without a single sample of the map. */
/* loses: a_diffuse_surface_in_the_open_is_right */
/* loses: a_glossy_surface_half_in_shadow_is_right */
/* loses: uneven_counts_are_right */
/* loses: the_power_heuristic_is_right */
/* loses: a_constant_light_is_right */
/* loses: the_weights_are_those_of_the_balance_heuristic */
/* loses: the_weights_are_those_of_the_power_heuristic */
/* [mis-em] */
static void add_em(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
    uint32_t n_em, uint32_t n_brdf)
{
    (void)sum, (void)s, (void)pt, (void)stream, (void)scratch, (void)n_em, (void)n_brdf;
}
/* [end] */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    (void)heuristic, (void)own, (void)other;
    return 1;
}
/* [end] */
