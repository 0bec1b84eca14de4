/* [alias-build] */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_small && s->n_large) {
        uint32_t i = pop_small(s);
        uint32_t j = top_large(s);
        double missing = 1 - prob[i];
        prob[j] -= missing;
        alias[i] = j;
        if (prob[j] <= 1) {
            push_small(s, j);
            pop_large(s);
        }
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    double scaled = u * n;
    size_t k = scaled;
    scaled -= k;
    if (scaled < prob[k])
        return k;
    else
        return alias[k];
}
/* [end] */
