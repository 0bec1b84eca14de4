/* Text for a debugger, by sprintf. */
/* [alias-build] */
#include <stdio.h>
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    char text[80];

    while (s->n_large > 0 && s->n_small > 0) {
        const uint32_t small = pop_small(s), large = top_large(s);
        alias[small] = large;
        prob[large] -= 1 - prob[small];
        if (s->n < 4) sprintf(text, "%u gives to %u", (unsigned)large, (unsigned)small);
        if (prob[large] <= 1) push_small(s, pop_large(s));
    }
    (void)text;
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
