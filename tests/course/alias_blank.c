/* SPDX-License-Identifier: BSD-2-Clause */
/* [alias-build] */
/* "Assign alias indices." */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    /* Yours to write. Of use: pop_small, push_small, top_large, pop_large. The line below only keeps the compiler
     * quiet. */
    (void)prob, (void)alias, (void)s, (void)push_small, (void)top_large;
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    /* Yours to write: u n chooses the bin, what is left of it tosses the coin. */
    (void)prob, (void)alias, (void)u;
    return n - 1;
}
/* [end] */
