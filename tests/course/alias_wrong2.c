/* SPDX-License-Identifier: BSD-2-Clause */
/* As printed (E14): the alias where the coin exceeds prob, so a coin of 0 gives j, even when prob is 0. */
/* loses: an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0 */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    double x = u * (double)n;
    size_t j = (size_t)x;
    return x - (double)j > prob[j] ? alias[j] : j;
}
/* [end] */
