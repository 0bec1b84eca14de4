/* [alias-build] */
/* One giver at a time: it fills bins until it has become small itself. */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_large > 0) {
        const uint32_t big = top_large(s);

        while (prob[big] > 1) {
            if (s->n_small == 0) return;
            const uint32_t little = pop_small(s);
            alias[little] = big;
            prob[big] -= 1;
            prob[big] += prob[little];
        }
        pop_large(s);
        push_small(s, big);
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    u *= (double)n;
    const uint32_t column = (uint32_t)u;
    return u - column >= prob[column] ? alias[column] : column;
}
/* [end] */
