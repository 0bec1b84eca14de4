/* Labels and jumps, and an assertion for each step. */
/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    uint32_t small, large;

next:
    if (!s->n_large || !s->n_small) goto done;
    small = pop_small(s);
    large = top_large(s);
    assert(small != large && prob[small] <= 1);
    alias[small] = large;
    prob[large] -= 1 - prob[small];
    if (prob[large] > 1) goto next;
    push_small(s, pop_large(s));
    goto next;
done:
    return;
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
