/* SPDX-License-Identifier: BSD-2-Clause */
/* "Pre-inverting C" (E10): what the guide says, without a search. The plain sum. */
/* loses: each_u_gives_the_item_whose_interval_holds_it */
/* loses: a_large_table_is_searched_as_by_hand */
/* loses: items_are_drawn_with_their_probabilities */
/* loses: the_remainder_tells_where_u_lies_in_the_interval */
/* loses: many_small_items_after_a_large_one_do_not_vanish */
/* [cdf-sum] */
static double accumulate(double *c, const double *f, size_t n, weight_scale s)
{
    c[0] = 0;
    for (size_t i = 0; i < n; i++)
        c[i + 1] = c[i] + weight_scaled(s, f[i]);
    return c[n];
}
/* [end] */
/* [cdf-search] */
size_t bis_cdf_sample(const bis_cdf *c, double u, double *remainder)
{
    size_t i = c->guide[(size_t)(u * (double)c->n_guide)];
    if (remainder) *remainder = fmin((u - c->c[i]) / (c->c[i + 1] - c->c[i]), 1 - DBL_EPSILON / 2);
    return i;
}
/* [end] */
