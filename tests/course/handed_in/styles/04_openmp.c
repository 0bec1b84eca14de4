/* A loop for OpenMP. */
/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    double most = 0;

#pragma omp parallel for reduction(max : most)
    for (size_t i = 0; i < s->n; i++) most = prob[i] > most ? prob[i] : most;
    while (most > 1 && s->n_large > 0 && s->n_small > 0) {
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
