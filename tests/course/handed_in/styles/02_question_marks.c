/* Two question marks and what may follow them, in comments of both kinds. */
/* [alias-build] */
/* does it stay large??/ or not??! */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_large && s->n_small) { // who gives??)
        const uint32_t small = pop_small(s), large = top_large(s);
        alias[small] = large;
        prob[large] = prob[large] + prob[small] - 1;
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
