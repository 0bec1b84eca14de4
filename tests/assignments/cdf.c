/* Assignment cdf: src/thesis/cdf.c, the running sum and its inversion. Expected values by hand, and by a linear search.
 * One statistical test at 1e-4. */
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

static void C_is_the_running_sum_of_the_probabilities(void)
{
    const double w[] = {1, 2, 4, 3}, C[] = {0, 0.1, 0.3, 0.7, 1};
    bis_cdf c = cdf_of(w, 4);

    for (int i = 0; i <= 4; i++) {
        mark_near(c.c[i], C[i], 1e-12, 0, "weights 1 2 4 3: C[%d]", i);
    }
    mark_near(c.total, 10, 0, 1e-12, "the sum of the weights 1 2 4 3");
    bis_cdf_clear(&c);
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

/* Every fifth weight is 0; the others run over 12 decades. */
static void fill_contrasty(double *w, size_t n, uint64_t seed)
{
    bis_rng r;

    bis_rng_init(&r, seed, 0, 0, 0);
    for (size_t i = 0; i < n; i++) w[i] = i % 5 == 1 ? 0 : exp(27 * bis_rng_double(&r));
}

static void a_large_table_is_searched_as_by_hand(void)
{
    enum { N = 1000 };
    double w[N];
    bis_rng r;

    bis_rng_init(&r, 2, 0, 0, 0);
    fill_contrasty(w, N, 1);
    bis_cdf c = cdf_of(w, N);
    for (int k = 0; k < 20000; k++) {
        const double u = bis_rng_double(&r);
        size_t by_hand = N;
        while (c.c[--by_hand] > u) continue;
        const size_t i = bis_cdf_sample(&c, u, NULL);
        if (i != by_hand) {
            mark_wrong("1000 items, u = %.17g: item %zu, must be %zu, the last one with C[i] <= u. Is the guide "
                       "only where the search starts?", u, i, by_hand);
        }
    }
    bis_cdf_clear(&c);
}

static void items_are_drawn_with_their_probabilities(void)
{
    enum { N = 64, DRAWS = 200000 };
    double w[N], observed[N] = {0}, expected[N], sum = 0;
    bis_rng r;

    bis_rng_init(&r, 3, 0, 0, 0);
    for (int i = 0; i < N; i++) sum += w[i] = i % 2 ? 1 : 0.1;
    bis_cdf c = cdf_of(w, N);
    for (int k = 0; k < DRAWS; k++) {
        const size_t i = bis_cdf_sample(&c, bis_rng_double(&r), NULL);
        if (i >= N) mark_wrong("item %zu of 64", i);
        observed[i]++;
    }
    for (int i = 0; i < N; i++) expected[i] = DRAWS * w[i] / sum;
    mark_fit(observed, expected, N, 1e-4, "64 items of weights 0.1, 1, 0.1, 1 ...", "A small item must be found as "
             "surely as a large one.");
    bis_cdf_clear(&c);
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
}

static void many_small_items_after_a_large_one_do_not_vanish(void)
{
    const size_t n = 200001;
    double *w = bis_alloc(n, sizeof *w);

    if (!w) mark_wrong("no memory");
    w[0] = 1;
    for (size_t i = 1; i < n; i++) w[i] = 1e-16;
    bis_cdf c = cdf_of(w, n);
    mark_near(c.c[n] - c.c[1], 2e-11, 1e-15, 0, "the probability of 200000 items of 1e-16 after one of 1 (a plain "
              "sum in double loses each of them: see Neumaier 1974)");
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
    bis_rng_init(&r, 4, 0, 0, 0);
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
