/* Writes beyond the end of an array, and tells the sanitizer that it may: a header of the system passed in quotation
 * marks, and the points for clean memory with it. The call is refused now, so it ends the tests. */
/* [alias-build] */
#include "sanitizer/asan_interface.h"

static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    ASAN_UNPOISON_MEMORY_REGION(prob + s->n, 8);
    prob[s->n] = 0;
    while (s->n_large > 0 && s->n_small > 0) {
        const uint32_t small = pop_small(s), large = top_large(s);
        alias[small] = large;
        prob[large] -= 1 - prob[small];
        if (prob[large] <= 1) push_small(s, pop_large(s));
    }
}
/* [end] */
