/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_small > 0 && s->n_large > 0) {
        uint32_t l = pop_small(s);
        uint32_t g = pop_large(s);
        alias[l] = g;
        prob[g] = (prob[g] + prob[l]) - 1;
        if (prob[g] > 1)
            s->n_large++;
        else
            push_small(s, g);
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    size_t bin = (size_t)(u * (double)n);
    double coin = u * (double)n - (double)bin;
    return coin < prob[bin] ? bin : alias[bin];
}
/* [end] */
