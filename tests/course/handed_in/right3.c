/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    uint32_t *items = s->items;
    size_t lo = s->n_small, hi = s->n - s->n_large;

    (void)pop_small, (void)push_small, (void)pop_large, (void)top_large;
    while (lo > 0 && hi < s->n) {
        const uint32_t a = items[lo - 1], b = items[hi];
        double rest = prob[b] + prob[a] - 1;

        alias[a] = b;
        prob[b] = rest;
        lo--;
        if (rest <= 1) {
            items[lo++] = b;
            hi++;
        }
    }
    s->n_small = lo;
    s->n_large = s->n - hi;
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    size_t k = (size_t)(u * (double)n);
    double c = u * (double)n;

    c -= (double)k;
    if (c < prob[k]) {
        return k;
    } else {
        return alias[k];
    }
}
/* [end] */
