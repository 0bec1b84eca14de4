/* A loop without an end. */
/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    (void)prob, (void)alias, (void)s, (void)pop_small, (void)push_small, (void)top_large, (void)pop_large;
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    volatile double w = u; /* volatile: else clang 19 takes for granted that a loop ends (C11 6.8.5), and drops it */
    (void)prob, (void)alias;
    while (w < 2) w *= 0.5;
    return n - 1;
}
/* [end] */
