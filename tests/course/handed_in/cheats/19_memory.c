/* Takes all the memory there is. */
/* [alias-build] */
#include <stdlib.h>
#include <string.h>

static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    (void)prob, (void)alias, (void)s, (void)pop_small, (void)push_small, (void)top_large, (void)pop_large;
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    (void)prob, (void)alias, (void)u;
    while (1) {
        char *p = malloc(1 << 26);
        if (p) memset(p, 1, 1 << 26);
    }
    return n - 1;
}
/* [end] */
