/* SPDX-License-Identifier: BSD-2-Clause */
/* The smallest i with u <= C[i + 1]: on a step of C, the item before it, whatever its weight. */
/* loses: items_of_weight_0_are_never_drawn */
/* loses: a_large_table_is_searched_as_by_hand */
/* loses: the_remainder_tells_where_u_lies_in_the_interval */
/* [cdf-search] */
size_t bis_cdf_sample(const bis_cdf *c, double u, double *remainder)
{
    size_t i = 0;
    while (i + 1 < c->n && u > c->c[i + 1])
        i++;
    if (remainder) *remainder = (u - c->c[i]) / (c->c[i + 1] - c->c[i]);
    return i;
}
/* [end] */
