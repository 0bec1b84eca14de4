/* Assignment cdf: src/thesis/cdf.c, the running sum and its inversion. Expected values by hand, and by a linear search.
 * One statistical test. */
#include "mark.h"

#include "bis/thesis/cdf.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"

#include <float.h>

static bis_cdf cdf_of(const double *w, size_t n)
{
    bis_cdf c;

    if (bis_cdf_init(&c, w, n, NULL)) mark_wrong("no memory for a distribution of %zu items", n);
    return c;
}

/* Every fifth weight is 0; the others run over 12 decades. */
static void fill_contrasty(double *w, size_t n, uint64_t seed)
{
    bis_rng r;

    bis_rng_init(&r, mark_seed(seed), 0, 0, 0);
    for (size_t i = 0; i < n; i++) w[i] = i % 5 == 1 ? 0 : exp(27 * bis_rng_double(&r));
}

/* What is returned and what stands in c[n] must be one number: the division makes 1 of it, to the last bit. */
static void check_ends(size_t n)
{
    double *w = bis_alloc(n, sizeof *w);

    if (!w) mark_wrong("no memory");
    fill_contrasty(w, n, 6);
    bis_cdf c = cdf_of(w, n);
    if (c.c[0] != 0 || c.c[n] != 1) {
        mark_wrong("%zu random weights: C runs from %.17g to %.17g, must run from 0 to 1 exactly. Is the sum that is returned c[n]?", n, c.c[0],
                   c.c[n]);
    }
    long double sum = 0, all = 0;
    for (size_t i = 0; i < n; i++) all += (long double)w[i];
    for (size_t i = 0; i < n; i++) {
        sum += (long double)w[i];
        if (c.c[i + 1] < c.c[i]) mark_wrong("%zu random weights: C[%zu] is less than C[%zu]; C never falls", n, i + 1, i);
        mark_near(c.c[i + 1], (double)(sum / all), 1e-12, 0, "%zu random weights: C[%zu]", n, i + 1); /* a plain sum in double is 10 times nearer */
    }
    bis_cdf_clear(&c);
    bis_free(w);
}

static void C_is_the_running_sum_of_the_probabilities(void)
{
    const double w[] = {1, 2, 4, 3}, C[] = {0, 0.1, 0.3, 0.7, 1};
    bis_cdf c = cdf_of(w, 4);

    for (int i = 0; i <= 4; i++) {
        mark_near(c.c[i], C[i], 1e-12, 0, "weights 1 2 4 3: C[%d]", i);
    }
    mark_near(c.total, 10, 0, 1e-12, "the sum of the weights 1 2 4 3");
    bis_cdf_clear(&c);
    check_ends(mark_size(1000));
}

static void each_u_gives_the_item_whose_interval_holds_it(void)
{
    const double w[] = {1, 2, 4, 3};
    const struct { double u; size_t item; } cases[] = {{0, 0}, {0.05, 0}, {0.15, 1}, {0.29, 1}, {0.31, 2}, {0.69, 2}, {0.71, 3}, {0.999, 3}};
    bis_cdf c = cdf_of(w, 4);

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const size_t i = bis_cdf_sample(&c, cases[k].u, NULL);
        if (i != cases[k].item) {
            mark_wrong("weights 1 2 4 3, u = %g: item %zu, must be %zu, since C is 0 0.1 0.3 0.7 1", cases[k].u, i,
                       cases[k].item);
        }
    }
    bis_cdf_clear(&c);
}

static void items_of_weight_0_are_never_drawn(void)
{
    const double w[] = {0, 0, 3, 0, 1, 2, 0, 0};
    bis_cdf c = cdf_of(w, 8);

    for (int k = 0; k <= 4000; k++) { /* on the steps of C and between */
        const double u = k < 8 ? fmin(c.c[k], 1 - DBL_EPSILON / 2) : fmin((k - 8) / 3990.0, 1 - DBL_EPSILON / 2);
        const size_t i = bis_cdf_sample(&c, u, NULL);
        if (i >= 8 || w[i] == 0) {
            mark_wrong("weights 0 0 3 0 1 2 0 0, u = %.17g: item %zu, which has weight 0. What if u lies exactly on "
                       "a step of C?", u, i);
        }
    }
    bis_cdf_clear(&c);
}

/* C[i] <= u < C[i + 1] holds for one i alone. */
static void a_large_table_is_searched_as_by_hand(void)
{
    const size_t n = mark_size(100000);
    double *w = bis_alloc(n, sizeof *w);
    bis_rng r;

    if (!w) mark_wrong("no memory");
    bis_rng_init(&r, mark_seed(2), 0, 0, 0);
    fill_contrasty(w, n, 1);
    bis_cdf c = cdf_of(w, n);
    for (int k = 0; k < 40000; k++) {
        /* anywhere, and on a step of C, or the last u before it */
        const double at = c.c[(size_t)(bis_rng_double(&r) * (double)n)];
        const double u = k % 4 ? bis_rng_double(&r) : fmin(at, 1 - DBL_EPSILON / 2), before = nextafter(u, 0);
        const double us[] = {u, before};
        for (int e = 0; e < (k % 4 ? 1 : 2); e++) {
            const size_t i = bis_cdf_sample(&c, us[e], NULL);
            if (i >= n) mark_wrong("%zu items, u = %.17g: item %zu", n, us[e], i);
            if (!(c.c[i] <= us[e] && us[e] < c.c[i + 1])) {
                mark_wrong("%zu items, u = %.17g: item %zu, whose interval is from C = %.17g to %.17g. Is the guide only where the search "
                           "starts?", n, us[e], i, c.c[i], c.c[i + 1]);
            }
        }
    }
    bis_cdf_clear(&c);
    bis_free(w);
}

static void items_are_drawn_with_their_probabilities(void)
{
    enum { N = 64, DRAWS = 200000 };
    double w[N], observed[N] = {0}, expected[N], sum = 0;
    bis_rng r;

    bis_rng_init(&r, mark_seed(3), 0, 0, 0);
    for (int i = 0; i < N; i++) sum += w[i] = i % 2 ? 1 : 0.1;
    bis_cdf c = cdf_of(w, N);
    for (int k = 0; k < DRAWS; k++) {
        const size_t i = bis_cdf_sample(&c, bis_rng_double(&r), NULL);
        if (i >= N) mark_wrong("item %zu of 64", i);
        observed[i]++;
    }
    for (int i = 0; i < N; i++) expected[i] = DRAWS * w[i] / sum;
    mark_fit(observed, expected, N, MARK_ALPHA, "64 items of weights 0.1, 1, 0.1, 1 ...", "A small item must be found as "
             "surely as a large one.");
    bis_cdf_clear(&c);
}

/* Of two items the second one's interval ends at 1. In a quarter of all cases the differences from C[1] to 1 and to the number before
 * it are both ties of rounding, and go to the same even number: their quotient is 1. */
static void check_last_remainders(void)
{
    bis_rng r;

    bis_rng_init(&r, mark_seed(7), 0, 0, 0);
    for (int k = 0; k < 400; k++) {
        const double w[] = {1, 1 + 6 * bis_rng_double(&r)};
        bis_cdf c = cdf_of(w, 2);
        double remainder = -1;
        bis_cdf_sample(&c, 1 - DBL_EPSILON / 2, &remainder);
        if (!(remainder >= 0.5 && remainder < 1)) {
            mark_wrong("weights 1 and %.17g, the last u below 1: the remainder is %.17g, must be near 1 and below it", w[1], remainder);
        }
        bis_cdf_sample(&c, c.c[1], &remainder);
        if (remainder != 0) mark_wrong("weights 1 and %.17g, u = C[1]: the remainder is %.17g, must be 0", w[1], remainder);
        bis_cdf_clear(&c);
    }
}

static void the_remainder_tells_where_u_lies_in_the_interval(void)
{
    const double w[] = {1, 2, 4, 3};
    bis_cdf c = cdf_of(w, 4);

    for (int k = 1; k < 100; k++) {
        const double u = k / 100.0 + 0.003;
        double remainder = -1;
        const size_t i = bis_cdf_sample(&c, u, &remainder);
        const double C[] = {0, 0.1, 0.3, 0.7, 1};
        if (i >= 4) mark_wrong("item %zu of 4", i);
        mark_near(remainder, (u - C[i]) / (C[i + 1] - C[i]), 1e-9, 0, "weights 1 2 4 3, u = %g: the remainder", u);
    }
    for (size_t i = 0; i < 4; i++) {
        double remainder = -1;
        bis_cdf_sample(&c, nextafter(c.c[i + 1], 0), &remainder);
        if (!(remainder >= 0 && remainder < 1)) {
            mark_wrong("the last u of item %zu: the remainder is %.17g, must be below 1", i, remainder);
        }
        if (remainder < 0.5) {
            mark_wrong("the last u of item %zu: the remainder is %.17g, must be nearly 1", i, remainder);
        }
    }
    bis_cdf_clear(&c);
    check_last_remainders();
}

static void many_small_items_after_a_large_one_do_not_vanish(void)
{
    const size_t n = mark_size(200000) + 1;
    double *w = bis_alloc(n, sizeof *w);

    if (!w) mark_wrong("no memory");
    w[0] = 1;
    for (size_t i = 1; i < n; i++) w[i] = 1e-16;
    bis_cdf c = cdf_of(w, n);
    mark_near(c.c[n] - c.c[1], 1e-16 * (double)(n - 1), 1e-15, 0, "the probability of %zu items of 1e-16 after one of 1 (a plain "
              "sum in double loses each of them: see Neumaier 1974)", n - 1);
    bis_cdf_clear(&c);
    bis_free(w);
}

static void work(void)
{
    enum { N = 100000 };
    double *w = bis_alloc(N, sizeof *w);
    size_t sum = 0;
    bis_rng r;

    if (!w) return;
    bis_rng_init(&r, mark_seed(4), 0, 0, 0);
    fill_contrasty(w, N, 5);
    bis_cdf c = cdf_of(w, N);
    for (int k = 0; k < 1000000; k++) sum += bis_cdf_sample(&c, bis_rng_double(&r), NULL);
    if (sum == 0) mark_wrong("nothing but item 0");
    bis_cdf_clear(&c);
    bis_free(w);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"C_is_the_running_sum_of_the_probabilities", 15, C_is_the_running_sum_of_the_probabilities},
        {"each_u_gives_the_item_whose_interval_holds_it", 15, each_u_gives_the_item_whose_interval_holds_it},
        {"items_of_weight_0_are_never_drawn", 15, items_of_weight_0_are_never_drawn},
        {"a_large_table_is_searched_as_by_hand", 10, a_large_table_is_searched_as_by_hand},
        {"items_are_drawn_with_their_probabilities", 10, items_are_drawn_with_their_probabilities},
        {"the_remainder_tells_where_u_lies_in_the_interval", 10, the_remainder_tells_where_u_lies_in_the_interval},
        {"many_small_items_after_a_large_one_do_not_vanish", 5, many_small_items_after_a_large_one_do_not_vanish},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work);
}
