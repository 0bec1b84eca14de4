/* A pragma that only speeds up, which is refused: marked is the rest. */
/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
#pragma GCC unroll 4
    while (s->n_large > 0 && s->n_small > 0) {
        const uint32_t small = pop_small(s), large = top_large(s);
        alias[small] = large;
        prob[large] -= 1 - prob[small];
        if (prob[large] <= 1) push_small(s, pop_large(s));
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    const double x = u * (double)n;
    const size_t j = (size_t)x;

    return x - (double)j < prob[j] ? j : alias[j];
}
/* [end] */
