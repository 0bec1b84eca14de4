/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_large > 0 && s->n_small > 0) {
        const uint32_t big = top_large(s);
        const uint32_t tiny = pop_small(s);

        alias[tiny] = big;
        prob[big] = prob[big] - (1 - prob[tiny]);
        if (prob[big] < 1)
            push_small(s, pop_large(s));
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    const double un = u * (double)n;
    const size_t j = (size_t)floor(un);
    const double rest = un - (double)j;

    if (rest < prob[j]) {
        return j;
    }
    return alias[j];
}
/* [end] */
