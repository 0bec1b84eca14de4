/* Headers of the C library in quotation marks, and one of ours. */
/* [alias-build] */
#include "stdlib.h"
#include "bis/base/mem.h"
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    uint32_t *small = bis_alloc(1, sizeof *small);

    while (small && s->n_large > 0 && s->n_small > 0) {
        *small = pop_small(s);
        alias[*small] = top_large(s);
        prob[top_large(s)] -= 1 - prob[*small];
        if (prob[top_large(s)] <= 1) push_small(s, pop_large(s));
    }
    bis_free(small);
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
