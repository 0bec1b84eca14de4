/* An include and prints for debugging, behind conditions. */
/* [alias-build] */
#ifdef DEBUG
#include <stdio.h>
#define SAY(...) printf(__VA_ARGS__)
#else
#define SAY(...) (void)0
#endif

static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_large > 0 && s->n_small > 0) {
        const uint32_t small = pop_small(s), large = top_large(s);
        SAY("%u -> %u\n", large, small);
        alias[small] = large;
#if 1
        prob[large] -= 1 - prob[small];
#else
        prob[large] = 0;
#endif
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
