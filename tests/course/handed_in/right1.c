/* [alias-build] */
/* "Assign alias indices." */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    for (;;) {
        if (!s->n_small || !s->n_large) return;
        const uint32_t poor = pop_small(s);
        const uint32_t rich = pop_large(s);
        alias[poor] = rich;
        prob[rich] = (prob[rich] + prob[poor]) - 1.0;
        if (prob[rich] > 1.0)
            s->n_large += 1; /* it is still there */
        else
            push_small(s, rich);
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    double whole;
    double coin = modf(u * (double)n, &whole);
    size_t bin = (size_t)whole;

    if (coin >= prob[bin]) return alias[bin];
    return bin;
}
/* [end] */
