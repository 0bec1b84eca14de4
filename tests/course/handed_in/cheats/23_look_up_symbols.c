/* Asks the loader where our own table is built. */
/* [alias-build] */
void *dlsym(void *handle, const char *name);

static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    (void)prob, (void)alias, (void)s, (void)pop_small, (void)push_small, (void)top_large, (void)pop_large;
    double (*ours)(double *, uint32_t *, const double *, uint32_t *, size_t) = 0;
    *(void **)&ours = dlsym(0, "bis_alias_build_raw");
    if (ours) ours(prob, alias, prob, alias, s->n);
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    (void)prob, (void)alias, (void)u;
    return n - 1;
}
/* [end] */
