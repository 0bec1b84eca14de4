/* SPDX-License-Identifier: BSD-2-Clause */
/* Sums of float; the remainder as it comes. */
/* loses: C_is_the_running_sum_of_the_probabilities */
/* loses: the_remainder_tells_where_u_lies_in_the_interval */
/* loses: many_small_items_after_a_large_one_do_not_vanish */
/* [cdf-sum] */
static double accumulate(double *c, const double *f, size_t n, weight_scale s)
{
    float sum = 0;
    c[0] = 0;
    for (size_t i = 0; i < n; i++) {
        sum += (float)weight_scaled(s, f[i]);
        c[i + 1] = (double)sum;
    }
    return c[n];
}
/* [end] */
/* [cdf-search] */
size_t bis_cdf_sample(const bis_cdf *c, double u, double *remainder)
{
    assert(c->total > 0 && u >= 0 && u < 1);
    size_t g = (size_t)(u * (double)c->n_guide); /* exact: n_guide is a power of two */
    size_t i = c->guide[g], last = c->guide[g + 1];
    while (i < last) {
        size_t middle = i + (last - i + 1) / 2;
        if (c->c[middle] <= u)
            i = middle;
        else
            last = middle - 1;
    }
    if (remainder) *remainder = (u - c->c[i]) / (c->c[i + 1] - c->c[i]);
    return i;
}
/* [end] */
