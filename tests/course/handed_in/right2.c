/* [alias-build] */
/* What bin `to` lacks comes from `from`. */
static void give(double *prob, uint32_t *alias, uint32_t from, uint32_t to)
{
    const double lack = 1 - prob[to];

    alias[to] = from;
    prob[from] -= lack;
}

static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_small != 0) {
        if (s->n_large == 0) break;
        uint32_t donor = top_large(s);
        give(prob, alias, donor, pop_small(s));
        if (!(prob[donor] > 1)) push_small(s, pop_large(s));
    }
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    const double scaled = (double)n * u;
    const size_t j = (size_t)floor(scaled);
    const bool keep = scaled - floor(scaled) < prob[j];

    return keep ? j : (size_t)alias[j];
}
/* [end] */
