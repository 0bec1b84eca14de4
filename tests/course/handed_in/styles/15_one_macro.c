/* Everything stands in one macro; a helper without static has a name of the C library. */
/* [alias-build] */
#define SOLUTION \
    double gamma(double p) { return 1 - p; } \
    static void assign_aliases(double *prob, uint32_t *alias, stacks *s) \
    { \
        while (s->n_small > 0 && s->n_large > 0) { \
            const uint32_t small = pop_small(s), large = top_large(s); \
            alias[small] = large; \
            prob[large] -= gamma(prob[small]); \
            if (prob[large] <= 1) push_small(s, pop_large(s)); \
        } \
    }
SOLUTION
/* [end] */
/* [alias-sample] */
#define BEGIN {
#define END }
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
BEGIN
    const double x = u * (double)n;
    const size_t j = (size_t)x;

    return x - (double)j < prob[j] ? j : alias[j];
END
/* [end] */
