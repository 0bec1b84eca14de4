/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_small > 0 && s->n_large > 0) {
        uint32_t small = pop_small(s);
        uint32_t large = top_large(s);
        alias[small] = large;
        prob[large] -= 1.0 - prob[small];
        if (prob[large] <= 1.0) {
            pop_large(s);
            push_small(s, large);
        }
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    double x = u * (double)n;
    size_t i = (size_t)x;
    double coin = x - (double)i;
    if (coin < prob[i]) return i;
    return alias[i];
}
/* [end] */
