/* A helper without `static`, and a table, too. */
/* [alias-build] */
const double whole[2] = {1, 1};

void fill(double *prob, uint32_t *alias, uint32_t small, uint32_t large)
{
    alias[small] = large;
    prob[large] -= whole[0] - prob[small];
}

static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_large > 0 && s->n_small > 0) {
        const uint32_t large = top_large(s);
        fill(prob, alias, pop_small(s), large);
        if (prob[large] <= whole[1]) push_small(s, pop_large(s));
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
