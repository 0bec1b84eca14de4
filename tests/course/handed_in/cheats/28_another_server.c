/* Brings the function that answers along. */
/* [alias-build] */
int answers_serve(void);
int answers_serve(void) { return 0; }

static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    (void)prob, (void)alias, (void)s, (void)pop_small, (void)push_small, (void)top_large, (void)pop_large;
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    (void)prob, (void)alias, (void)u;
    return n - 1;
}
/* [end] */
