/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment alias: src/thesis/alias.c, the loop of appendix A and the draw. The implied pmf of a table is compared
 * with the weights. One statistical test. */
#include "mark.h"

#include "bis/thesis/alias.h"
#include "bis/thesis/rng.h"

/* The student's tables of these weights, whose values are probabilities and items. */
static bis_alias alias_of(const double *w, size_t n)
{
    bis_alias a = {.n = n, .total = 1, .prob = mark_alloc(n, sizeof *a.prob), .alias = mark_alloc(n, sizeof *a.alias)};

    ASK(ASK_ALIAS, GIVE(w, n), TAKE(a.prob, n), TAKE(a.alias, n));
    for (size_t i = 0; i < n; i++) {
        if (!(a.prob[i] >= 0 && a.prob[i] <= 1)) {
            mark_wrong("bin %zu of %zu: prob is %.9g, a probability is in [0, 1]", i, n, a.prob[i]);
        }
        if (a.alias[i] >= n) mark_wrong("bin %zu of %zu: its alias is %u, which is no item", i, n, a.alias[i]);
    }
    return a;
}

/* Right tables, by the slowest road: bin i is filled by whoever has most to give. */
static bis_alias right_alias_of(const double *w, size_t n)
{
    bis_alias a = {.n = n, .total = 1, .prob = mark_alloc(n, sizeof *a.prob), .alias = mark_alloc(n, sizeof *a.alias)};
    bool *done = mark_alloc(n, sizeof *done);
    double sum = 0;

    for (size_t i = 0; i < n; i++) sum += w[i];
    for (size_t i = 0; i < n; i++) a.prob[i] = (double)n * w[i] / sum;
    for (size_t k = 0; k < n; k++) {
        size_t least = n, most = n;
        for (size_t i = 0; i < n; i++) {
            if (done[i]) continue;
            if (least == n || a.prob[i] < a.prob[least]) least = i;
            if (most == n || a.prob[i] >= a.prob[most]) most = i;
        }
        done[least] = true;
        a.alias[least] = (uint32_t)most;
        if (most == least) a.prob[least] = 1; /* the last one, but for rounding */
        else a.prob[most] -= 1 - a.prob[least];
    }
    return a;
}

static void pick(size_t *item, const bis_alias *a, const double *u, size_t n_u)
{
    ASK(ASK_PICK, GIVE(a->prob, a->n), GIVE(a->alias, a->n), GIVE(u, n_u), TAKE(item, n_u));
}

/* Every seventh weight is 0; the others run over `decades` powers of ten. */
static void fill_contrasty(double *w, size_t n, uint64_t seed, double decades)
{
    bis_rng r;

    bis_rng_init(&r, mark_seed(seed), 0, 0, 0);
    for (size_t i = 0; i < n; i++) w[i] = i % 7 == 3 ? 0 : pow(10, decades * (bis_rng_double(&r) - 0.5));
}

/* The first item whose probability in a table is not its weight's share; n: there is none. */
static size_t first_wrong(double *pmf, double *sum, const bis_alias *a, const double *w)
{
    size_t i = 0;

    *sum = 0;
    for (size_t j = 0; j < a->n; j++) *sum += w[j];
    bis_alias_implied_pmf(a, pmf);
    while (i < a->n && (w[i] > 0 || pmf[i] == 0) && fabs(pmf[i] - w[i] / *sum) <= 1e-8 * w[i] / *sum) i++;
    return i;
}

static void check_table(const bis_alias *a, const double *w)
{
    const size_t n = a->n;
    double *pmf = mark_alloc(n, sizeof *pmf), sum;
    const size_t i = first_wrong(pmf, &sum, a, w);

    if (i < n && w[i] == 0) mark_wrong("item %zu of %zu has weight 0, but the table gives it %.3g", i, n, pmf[i]);
    if (i < n) {
        mark_wrong("item %zu of %zu: the table gives it a probability of %.9g, must be %.9g (what is its own in its "
                   "bin, and what other bins "
                   "give it as their alias)", i, n, pmf[i], w[i] / sum);
    }
}

static void check_pmf(const double *w, size_t n)
{
    bis_alias a = alias_of(w, n);

    check_table(&a, w);
}

/* What holds of any right table, and of most that are not: the bin of an item that lacks something holds the item
 * itself, with what it has, and one that has something to give. */
static void check_small_bins(const double *w, size_t n)
{
    bis_alias a = alias_of(w, n);
    double sum = 0;

    for (size_t i = 0; i < n; i++) sum += w[i];
    for (size_t i = 0; i < n; i++) {
        const double own = (double)n * w[i] / sum, other = (double)n * w[a.alias[i]] / sum;
        if (own > 1 - 1e-9) continue;
        mark_near(a.prob[i], own, 1e-12, 0, "%zu items: prob of bin %zu, which is %zu times the probability %.9g,", n,
                  i, n, w[i] / sum);
        if (other < 1 - 1e-9) {
            mark_wrong("%zu items: bin %zu lacks something, and is filled by item %u, which has nothing to give away "
                       "(is it a number of 16 bits?)",
                       n, i, a.alias[i]);
        }
    }
}

static void figure_3_4_comes_out(void)
{
    check_small_bins((double[]){.1, .2, .4, .3}, 4);
    for (uint64_t k = 0; k < 20; k++) { /* as small, but nobody has drawn them */
        double w[4];
        fill_contrasty(w, 4, 20 + k, 1);
        check_small_bins(w, 4);
    }
}

static void every_table_gives_the_weights(void)
{
    static double w[6250];
    const size_t sizes[] = {4, 2, 3, 5, mark_size(17), mark_size(64), mark_size(1000), mark_size(5000)};

    check_pmf((double[]){.1, .2, .4, .3}, 4);
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        fill_contrasty(w, sizes[k], 10 + k, 2);
        check_pmf(w, sizes[k]);
    }
}

/* Whoever fails the claim before fails here for the same cause, unless small bins are wrong, too: it counts once. */
static void check_large(const double *w, size_t n, bool small_ones_are_right)
{
    check_small_bins(w, n);
    if (small_ones_are_right) check_pmf(w, n);
}

/* A million items: more than 16 bits can number, and far too many for a search at each step. */
static void tables_hold_for_a_contrast_of_1e12_and_a_million_items(void)
{
    const size_t n = mark_size(5000), many = mark_size(1000000);
    double *w = mark_alloc(many, sizeof *w), pmf[64], sum;

    fill_contrasty(w, 64, 3, 2);
    bis_alias a = alias_of(w, 64);
    const bool right = first_wrong(pmf, &sum, &a, w) == 64;
    fill_contrasty(w, n, 1, 12);
    check_large(w, n, right);
    for (size_t i = 0; i < n; i++) w[i] = i == 77 ? 1e12 : 1; /* one giver for all */
    check_large(w, n, right);
    fill_contrasty(w, many, 2, 2);
    check_large(w, many, right);
}

/* Bin j holds j and j + 1, half and half: a million coins, each tossed by what 20 bits of bin leave of u. */
static void check_pick_of_many(void)
{
    enum { STEP = 997 };
    const size_t n = mark_size(1000000), n_u = 2 * ((n + STEP - 1) / STEP);
    bis_alias a = {.n = n, .total = 1, .prob = mark_alloc(n, sizeof *a.prob), .alias = mark_alloc(n, sizeof *a.alias)};
    double *u = mark_alloc(n_u, sizeof *u);
    size_t *item = mark_alloc(n_u, sizeof *item);

    for (size_t j = 0; j < n; j++) {
        a.prob[j] = 0.5;
        a.alias[j] = (uint32_t)((j + 1) % n);
    }
    for (size_t k = 0; k < n_u; k++) u[k] = ((double)(k / 2 * STEP) + (k % 2 ? 0.51 : 0.49)) / (double)n;
    pick(item, &a, u, n_u);
    for (size_t k = 0; k < n_u; k++) {
        const size_t j = k / 2 * STEP, must = k % 2 ? a.alias[j] : j;
        if (item[k] != must) {
            mark_wrong("%zu bins, prob 0.5 each, u = %.9g (bin %zu, coin %g): item %zu, must be %zu. Is the bin a "
                       "number of 16 bits, or "
                       "the coin a float?", n, u[k], j, k % 2 ? 0.51 : 0.49, item[k], must);
        }
    }
}

static void the_bin_and_the_coin_come_from_one_u(void)
{
    enum { N = 8 };
    double prob[] = {0.25, 1, 0.5, 0.75};
    uint32_t alias[] = {1, 1, 3, 0};
    const bis_alias a = {.n = 4, .prob = prob, .alias = alias};
    const double u[N] = {0.03, 0.2, 0.3, 0.49, 0.55, 0.7, 0.8, 0.99};
    const size_t must[N] = {0, 1, 1, 1, 2, 3, 3, 0};
    size_t item[N];

    pick(item, &a, u, N);
    for (size_t k = 0; k < N; k++) {
        if (item[k] != must[k]) {
            mark_wrong("4 bins, prob 0.25 1 0.5 0.75, alias 1 1 3 0, u = %g (bin %d, coin %.2f): item %zu, must be "
                       "%zu", u[k], (int)(4 * u[k]),
                       4 * u[k] - (int)(4 * u[k]), item[k], must[k]);
        }
    }
    check_pick_of_many();
}

/* Where the weights of 0 are, and how many, is known to nobody before; u goes by steps that hit the coin's 0 in
 * every bin. */
static void an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0(void)
{
    enum { STEPS = 4096 };
    double u[STEPS];
    size_t item[STEPS];

    for (int j = 0; j < STEPS; j++) u[j] = j / (double)STEPS;
    for (uint64_t k = 0; k < 20; k++) {
        double w[8] = {0, 1, 0, 2};
        bool drawn[8] = {false};
        const size_t n = k ? 8 : 4;
        const uint64_t zeros = mark_seed(30 + k);
        if (k) fill_contrasty(w, 8, 40 + k, 1);
        for (size_t i = 0; k && i < 8; i++) {
            if (zeros >> i & 1) w[i] = 0;
        }
        if (k) w[zeros >> 8 & 7] = 1; /* one at least */
        bis_alias a = right_alias_of(w, n);
        pick(item, &a, u, STEPS);
        for (int j = 0; j < STEPS; j++) {
            const size_t i = item[j];
            if (i >= n || w[i] == 0) {
                mark_wrong("weights %g %g %g %g %g %g %g %g, u = %g: item %zu, which has weight 0. What does your "
                           "comparison say where "
                           "the coin is exactly 0?", w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], u[j], i);
            }
            drawn[i] = true;
        }
        for (size_t i = 0; i < n; i++) {
            if (w[i] > 0 && !drawn[i]) {
                mark_wrong("item %zu of %zu is never drawn, though its weight is %g", i, n, w[i]);
            }
        }
    }
}

/* From right tables: a wrong one is found by the claims above. */
static void items_are_drawn_with_their_probabilities(void)
{
    enum { N = 50, DRAWS = 200000 };
    double w[N], observed[N] = {0}, expected[N], sum = 0, *u = mark_uniforms(DRAWS, mark_seed(3), 0);
    size_t *item = mark_alloc(DRAWS, sizeof *item);

    fill_contrasty(w, N, 4, 2);
    bis_alias a = right_alias_of(w, N);
    pick(item, &a, u, DRAWS);
    for (int k = 0; k < DRAWS; k++) {
        if (item[k] >= N) mark_wrong("item %zu of 50", item[k]);
        observed[item[k]]++;
    }
    for (int i = 0; i < N; i++) sum += w[i];
    for (int i = 0; i < N; i++) expected[i] = DRAWS * w[i] / sum;
    mark_fit(observed, expected, N, MARK_ALPHA, "50 items of random weights, from right tables",
             "Which of the two outcomes of a bin comes "
             "first?");
}

/* But where the coin is as near to prob as rounding may bring it. */
static void check_items(const size_t *item, const bis_alias *a, const double *u, size_t n_u)
{
    for (size_t k = 0; k < n_u; k++) {
        const double at = u[k] * (double)a->n, coin = at - floor(at);
        const size_t bin = (size_t)at, must = coin < a->prob[bin] ? bin : a->alias[bin];
        if (fabs(coin - a->prob[bin]) > 1e-9 && item[k] != must) {
            mark_wrong("%zu bins, u = %.17g: item %zu, must be %zu", a->n, u[k], item[k], must);
        }
    }
}

static void work(void)
{
    enum { DRAWS = 300000 };
    const size_t n = mark_size(100000);
    double *w = mark_alloc(n, sizeof *w), *u = mark_uniforms(DRAWS, mark_seed(4), 0);
    size_t *item = mark_alloc(DRAWS, sizeof *item);

    for (uint64_t k = 0; k < 5; k++) { /* other weights each time: what is kept of the last table is of no use */
        fill_contrasty(w, n, 50 + k, 6);
        bis_alias a = alias_of(w, n);
        pick(item, &a, u, DRAWS);
        check_table(&a, w);
        check_items(item, &a, u, DRAWS);
    }
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"figure_3_4_comes_out", 15, figure_3_4_comes_out},
        {"every_table_gives_the_weights", 20, every_table_gives_the_weights},
        {"tables_hold_for_a_contrast_of_1e12_and_a_million_items", 10,
         tables_hold_for_a_contrast_of_1e12_and_a_million_items},
        {"the_bin_and_the_coin_come_from_one_u", 15, the_bin_and_the_coin_come_from_one_u},
        {"an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0", 10,
         an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0},
        {"items_are_drawn_with_their_probabilities", 10, items_are_drawn_with_their_probabilities},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 2.8);
}
