/* A thread that writes into the answers while they are read. */
/* [alias-build] */
int pthread_create(unsigned long *thread, const void *how, void *(*run)(void *), void *with);
static void *scribble(void *at)
{
    for (volatile char *p = at; 1; p[0]++) continue;
}

static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    (void)prob, (void)alias, (void)s, (void)pop_small, (void)push_small, (void)top_large, (void)pop_large;
    unsigned long thread;
    pthread_create(&thread, 0, scribble, prob);
}
/* [end] */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    (void)prob, (void)alias, (void)u;
    return n - 1;
}
/* [end] */
