/* No stack functions: two pointers that walk through the items. */
/* [alias-build] */
typedef struct { uint32_t *top; } pile;
static inline uint32_t taken(pile *p) { return *--p->top; }
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    pile small = {s->items + s->n_small};
    uint32_t *large = s->items + (s->n - s->n_large);

    (void)pop_small, (void)push_small, (void)top_large, (void)pop_large;
    while (small.top > s->items && large < s->items + s->n) {
        const uint32_t to = taken(&small);
        prob[*large] += prob[to] - 1.0;
        alias[to] = *large;
        if (!(prob[*large] > 1)) *small.top++ = *large++;
    }
    s->n_small = (size_t)(small.top - s->items);
    s->n_large = (size_t)(s->items + s->n - large);
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
