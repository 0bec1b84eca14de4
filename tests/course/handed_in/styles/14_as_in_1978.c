/* Functions are defined as in 1978, static inline, with nested blocks. */
/* [alias-build] */
static inline int is_small(p)
double p;
{
    return p <= 1;
}
static void assign_aliases(prob, alias, s)
double *prob;
uint32_t *alias;
stacks *s;
{
    while (s->n_small > 0 && s->n_large > 0) {
        const uint32_t small = pop_small(s), large = top_large(s);
        alias[small] = large;
        prob[large] -= 1 - prob[small];
        if (is_small(prob[large])) push_small(s, pop_large(s));
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
