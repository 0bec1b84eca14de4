/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment cdf: src/thesis/cdf.c, the running sum and its inversion. Expected values by hand, and by a linear search.
 * One statistical test. */
#include "mark.h"

#include "bis/thesis/rng.h"

#include <float.h>

/* The student's sum c[n + 1] of these weights; returns their total. */
static double sum_of(double *c, const double *w, size_t n)
{
    double total;

    ASK(ASK_CDF, GIVE(w, n), TAKE(c, n + 1), TAKE(&total, 1));
    return total;
}

/* The right sum, so that a wrong one costs the claims about it, and no others. */
static void right_sum_of(double *c, const double *w, size_t n)
{
    long double sum = 0, all = 0;

    for (size_t i = 0; i < n; i++) all += (long double)w[i];
    for (size_t i = 0; i < n; i++) {
        c[i] = (double)(sum / all);
        sum += (long double)w[i];
    }
    c[n] = 1;
}

/* What the student draws from c[n + 1], with the guide that our own code makes. remainder may be NULL. */
static void draw(size_t *item, double *remainder, const double *c, size_t n, const double *u, size_t n_u)
{
    size_t n_guide = 1, i = 0, last = n - 1;
    while (4 * n_guide <= n) n_guide *= 2;
    uint32_t *guide = mark_alloc(n_guide + 1, sizeof *guide);

    while (c[last] >= 1) last--; /* the last item of a weight above 0 */
    for (size_t g = 0; g <= n_guide; g++) {
        while (i < last && c[i + 1] <= (double)g / (double)n_guide) i++;
        guide[g] = (uint32_t)i;
    }
    ASK(ASK_SEARCH, GIVE(c, n + 1), GIVE(guide, n_guide + 1), GIVE(u, n_u), TAKE(item, n_u),
        TAKE(remainder, remainder ? n_u : 0));
}

/* Every fifth weight is 0; the others run over 12 decades. */
static void fill_contrasty(double *w, size_t n, uint64_t seed)
{
    bis_rng r;

    bis_rng_init(&r, mark_seed(seed), 0, 0, 0);
    for (size_t i = 0; i < n; i++) w[i] = i % 5 == 1 ? 0 : exp(27 * bis_rng_double(&r));
}

/* Against sums in long double; a plain sum in double is 10 times nearer than this. */
static void check_sums(const double *c, const double *w, size_t n)
{
    long double sum = 0, all = 0;

    for (size_t i = 0; i < n; i++) all += (long double)w[i];
    for (size_t i = 0; i < n; i++) {
        sum += (long double)w[i];
        if (!(c[i + 1] >= c[i])) {
            mark_wrong("%zu random weights: C[%zu] is less than C[%zu]; C never falls", n, i + 1, i);
        }
        mark_near(c[i + 1], (double)(sum / all), 1e-12, 0, "%zu random weights: C[%zu]", n, i + 1);
    }
}

/* What is returned and what stands in c[n] must be one number: the division makes 1 of it, to the last bit. */
static void check_ends(size_t n)
{
    double *w = mark_alloc(n, sizeof *w), *c = mark_alloc(n + 1, sizeof *c);

    fill_contrasty(w, n, 6);
    sum_of(c, w, n);
    if (c[0] != 0 || c[n] != 1) {
        mark_wrong("%zu random weights: C runs from %.17g to %.17g, must run from 0 to 1 exactly. Is the sum that is "
                   "returned c[n]?", n, c[0],
                   c[n]);
    }
    check_sums(c, w, n);
}

static void C_is_the_running_sum_of_the_probabilities(void)
{
    const double w[] = {1, 2, 4, 3}, C[] = {0, 0.1, 0.3, 0.7, 1};
    double c[5];

    mark_near(sum_of(c, w, 4), 10, 0, 1e-12, "the sum of the weights 1 2 4 3");
    for (int i = 0; i <= 4; i++) {
        mark_near(c[i], C[i], 1e-12, 0, "weights 1 2 4 3: C[%d]", i);
    }
    check_ends(mark_size(1000));
}

static void each_u_gives_the_item_whose_interval_holds_it(void)
{
    enum { N = 8 };
    const double w[] = {1, 2, 4, 3}, u[N] = {0, 0.05, 0.15, 0.29, 0.31, 0.69, 0.71, 0.999};
    const size_t must[N] = {0, 0, 1, 1, 2, 2, 3, 3};
    size_t item[N];
    double c[5];

    right_sum_of(c, w, 4);
    draw(item, NULL, c, 4, u, N);
    for (size_t k = 0; k < N; k++) {
        if (item[k] != must[k]) {
            mark_wrong("weights 1 2 4 3, u = %g: item %zu, must be %zu, since C is 0 0.1 0.3 0.7 1", u[k], item[k],
                       must[k]);
        }
    }
}

static void items_of_weight_0_are_never_drawn(void)
{
    enum { N = 4001 };
    const double w[] = {0, 0, 3, 0, 1, 2, 0, 0}, last = 1 - DBL_EPSILON / 2;
    double c[9], u[N];
    size_t item[N];

    right_sum_of(c, w, 8);
    /* on the steps of C and between */
    for (int k = 0; k < N; k++) u[k] = k < 8 ? fmax(0, fmin(c[k], last)) : fmin((k - 8) / 3990.0, last);
    draw(item, NULL, c, 8, u, N);
    for (int k = 0; k < N; k++) {
        if (item[k] >= 8 || w[item[k]] == 0) {
            mark_wrong("weights 0 0 3 0 1 2 0 0, u = %.17g: item %zu, which has weight 0. What if u lies exactly on "
                       "a step of C?", u[k], item[k]);
        }
    }
}

/* C[i] <= u < C[i + 1] holds for one i alone. */
static void check_items(const double *c, const size_t *item, size_t n, const double *u, size_t n_u)
{
    for (size_t k = 0; k < n_u; k++) {
        const size_t i = item[k];
        if (i >= n) mark_wrong("%zu items, u = %.17g: item %zu", n, u[k], i);
        if (!(c[i] <= u[k] && u[k] < c[i + 1])) {
            mark_wrong("%zu items, u = %.17g: item %zu, whose interval is from C = %.17g to %.17g. Is the guide only "
                       "where the search starts?", n, u[k], i, c[i], c[i + 1]);
        }
    }
}

static void a_large_table_is_searched_as_by_hand(void)
{
    enum { DRAWS = 50000 };
    const size_t n = mark_size(100000);
    double *w = mark_alloc(n, sizeof *w), *c = mark_alloc(n + 1, sizeof *c), *u = mark_uniforms(DRAWS, mark_seed(2), 0);
    size_t *item = mark_alloc(DRAWS, sizeof *item);

    fill_contrasty(w, n, 1);
    right_sum_of(c, w, n);
    for (int k = 0; k < DRAWS; k++) { /* anywhere; on a step of C; the last u before it */
        const double step = fmax(0, fmin(c[(size_t)(u[k] * (double)n)], 1 - DBL_EPSILON / 2));
        if (k % 5 == 0) u[k] = step;
        if (k % 5 == 1) u[k] = fmax(0, nextafter(step, 0));
    }
    draw(item, NULL, c, n, u, DRAWS);
    check_items(c, item, n, u, DRAWS);
}

static void items_are_drawn_with_their_probabilities(void)
{
    enum { N = 64, DRAWS = 200000 };
    double w[N], c[N + 1], observed[N] = {0}, expected[N], sum = 0, *u = mark_uniforms(DRAWS, mark_seed(3), 0);
    size_t *item = mark_alloc(DRAWS, sizeof *item);

    for (int i = 0; i < N; i++) sum += w[i] = i % 2 ? 1 : 0.1;
    right_sum_of(c, w, N);
    draw(item, NULL, c, N, u, DRAWS);
    for (int k = 0; k < DRAWS; k++) {
        if (item[k] >= N) mark_wrong("item %zu of 64", item[k]);
        observed[item[k]]++;
    }
    for (int i = 0; i < N; i++) expected[i] = DRAWS * w[i] / sum;
    mark_fit(observed, expected, N, MARK_ALPHA, "64 items of weights 0.1, 1, 0.1, 1 ...",
             "A small item must be found as "
             "surely as a large one.");
}

/* Of two items the second one's interval ends at 1. In a quarter of all cases the differences from C[1] to 1 and to
 * the number before it are both ties of rounding, and go to the same even number: their quotient is 1. */
static void check_last_remainders(void)
{
    bis_rng r;

    bis_rng_init(&r, mark_seed(7), 0, 0, 0);
    for (int k = 0; k < 400; k++) {
        const double w[] = {1, 1 + 6 * bis_rng_double(&r)};
        double c[3], u[2] = {1 - DBL_EPSILON / 2, 0}, remainder[2];
        size_t item[2];
        right_sum_of(c, w, 2);
        u[1] = c[1];
        draw(item, remainder, c, 2, u, 2);
        if (!(remainder[0] >= 0.5 && remainder[0] < 1)) {
            mark_wrong("weights 1 and %.17g, the last u below 1: the remainder is %.17g, must be near 1 and below it",
                       w[1], remainder[0]);
        }
        if (remainder[1] != 0) {
            mark_wrong("weights 1 and %.17g, u = C[1]: the remainder is %.17g, must be 0", w[1], remainder[1]);
        }
    }
}

static void the_remainder_tells_where_u_lies_in_the_interval(void)
{
    enum { N = 103 };
    const double w[] = {1, 2, 4, 3}, C[] = {0, 0.1, 0.3, 0.7, 1};
    double c[5], u[N], remainder[N];
    size_t item[N];

    right_sum_of(c, w, 4);
    for (int k = 0; k < 99; k++) u[k] = (k + 1) / 100.0 + 0.003;
    for (int i = 0; i < 4; i++) u[99 + i] = fmax(0, fmin(nextafter(c[i + 1], 0), 1 - DBL_EPSILON / 2));
    draw(item, remainder, c, 4, u, N);
    for (int k = 0; k < 99; k++) {
        const size_t i = item[k];
        if (i >= 4) mark_wrong("item %zu of 4", i);
        mark_near(remainder[k], (u[k] - C[i]) / (C[i + 1] - C[i]), 1e-9, 0, "weights 1 2 4 3, u = %g: the remainder",
                  u[k]);
    }
    for (int k = 99; k < N; k++) {
        if (!(remainder[k] >= 0 && remainder[k] < 1)) {
            mark_wrong("the last u of item %d: the remainder is %.17g, must be below 1", k - 99, remainder[k]);
        }
        if (remainder[k] < 0.5) {
            mark_wrong("the last u of item %d: the remainder is %.17g, must be nearly 1", k - 99, remainder[k]);
        }
    }
    check_last_remainders();
}

static void many_small_items_after_a_large_one_do_not_vanish(void)
{
    const size_t n = mark_size(200000) + 1;
    double *w = mark_alloc(n, sizeof *w), *c = mark_alloc(n + 1, sizeof *c);

    w[0] = 1;
    for (size_t i = 1; i < n; i++) w[i] = 1e-16;
    sum_of(c, w, n);
    mark_near(c[n] - c[1], 1e-16 * (double)(n - 1), 1e-15, 0,
              "the probability of %zu items of 1e-16 after one of 1 (a plain "
              "sum in double loses each of them: see Neumaier 1974)", n - 1);
}

static void work(void)
{
    enum { DRAWS = 1000000 };
    const size_t n = mark_size(100000);
    double *w = mark_alloc(n, sizeof *w), *c = mark_alloc(n + 1, sizeof *c), *u = mark_uniforms(DRAWS, mark_seed(4), 0);
    size_t *item = mark_alloc(DRAWS, sizeof *item);

    fill_contrasty(w, n, 5);
    sum_of(c, w, n);
    check_sums(c, w, n);
    draw(item, NULL, c, n, u, DRAWS);
    check_items(c, item, n, u, DRAWS);
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

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 2.3);
}
