/* Assignment alias: src/thesis/alias.c, the loop of appendix A and the draw. The implied pmf of a table is compared with the weights.
 * One statistical test. */
#include "mark.h"

#include "bis/thesis/alias.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"

static bis_alias alias_of(const double *w, size_t n)
{
    bis_alias a;

    if (bis_alias_init(&a, w, n, NULL)) mark_wrong("no memory for a table of %zu items", n);
    for (size_t i = 0; i < n; i++) {
        if (!(a.prob[i] >= 0 && a.prob[i] <= 1)) {
            mark_wrong("bin %zu of %zu: prob is %.9g, a probability is in [0, 1]", i, n, a.prob[i]);
        }
        if (a.alias[i] >= n) mark_wrong("bin %zu of %zu: its alias is %u, which is no item", i, n, a.alias[i]);
    }
    return a;
}

/* Every seventh weight is 0; the others run over `decades` powers of ten. */
static void fill_contrasty(double *w, size_t n, uint64_t seed, double decades)
{
    bis_rng r;

    bis_rng_init(&r, mark_seed(seed), 0, 0, 0);
    for (size_t i = 0; i < n; i++) w[i] = i % 7 == 3 ? 0 : pow(10, decades * (bis_rng_double(&r) - 0.5));
}

static void check_pmf(const double *w, size_t n)
{
    double *pmf = bis_alloc(n, sizeof *pmf), sum = 0;
    bis_alias a = alias_of(w, n);

    if (!pmf) mark_wrong("no memory");
    for (size_t i = 0; i < n; i++) sum += w[i];
    bis_alias_implied_pmf(&a, pmf);
    for (size_t i = 0; i < n; i++) {
        if (w[i] == 0 && pmf[i] != 0) {
            mark_wrong("item %zu of %zu has weight 0, but the table gives it %.3g", i, n, pmf[i]);
        }
        if (!(fabs(pmf[i] - w[i] / sum) <= 1e-8 * w[i] / sum)) {
            mark_wrong("item %zu of %zu: the table gives it a probability of %.9g, must be %.9g (what is its own in its bin, and what other bins "
                       "give it as their alias)", i, n, pmf[i], w[i] / sum);
        }
    }
    bis_alias_clear(&a);
    bis_free(pmf);
}

static void figure_3_4_comes_out(void)
{
    const double P[] = {.1, .2, .4, .3};
    bis_alias a = alias_of(P, 4);

    mark_near(a.prob[0], 0.4, 1e-12, 0, "figure 3.4: prob of bin 0, which is 4 times 0.1,");
    mark_near(a.prob[1], 0.8, 1e-12, 0, "figure 3.4: prob of bin 1, which is 4 times 0.2,");
    for (int i = 0; i < 2; i++) {
        if (a.alias[i] < 2) {
            mark_wrong("figure 3.4: bin %d is filled by item %u, which has nothing to give away", i, a.alias[i]);
        }
    }
    bis_alias_clear(&a);
    check_pmf(P, 4);
    for (uint64_t k = 0; k < 20; k++) { /* as small, but nobody has drawn them */
        double w[4];
        fill_contrasty(w, 4, 20 + k, 1);
        check_pmf(w, 4);
    }
}

static void every_table_gives_the_weights(void)
{
    static double w[6250];
    const size_t sizes[] = {2, 3, 5, mark_size(17), mark_size(64), mark_size(1000), mark_size(5000)};

    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        fill_contrasty(w, sizes[k], 10 + k, 2);
        check_pmf(w, sizes[k]);
    }
}

/* A million items: more than 16 bits can number, and far too many for a search at each step. */
static void tables_hold_for_a_contrast_of_1e12_and_a_million_items(void)
{
    const size_t n = mark_size(5000), many = mark_size(1000000);
    double *w = bis_alloc(many, sizeof *w);

    if (!w) mark_wrong("no memory");
    fill_contrasty(w, n, 1, 12);
    check_pmf(w, n);
    for (size_t i = 0; i < n; i++) w[i] = i == 77 ? 1e12 : 1; /* one giver for all */
    check_pmf(w, n);
    fill_contrasty(w, many, 2, 2);
    check_pmf(w, many);
    bis_free(w);
}

/* Bin j holds j and j + 1, half and half: a million coins, each tossed by what 20 bits of bin leave of u. */
static void check_pick_of_many(void)
{
    const size_t n = mark_size(1000000);
    double *prob = bis_alloc(n, sizeof *prob);
    uint32_t *alias = bis_alloc(n, sizeof *alias);

    if (!prob || !alias) mark_wrong("no memory");
    for (size_t j = 0; j < n; j++) {
        prob[j] = 0.5;
        alias[j] = (uint32_t)((j + 1) % n);
    }
    for (size_t j = 0; j < n; j += 997) {
        for (int half = 0; half < 2; half++) {
            const double u = ((double)j + (half ? 0.51 : 0.49)) / (double)n;
            const size_t i = bis_alias_pick(prob, alias, n, u), must = half ? alias[j] : j;
            if (i != must) {
                mark_wrong("%zu bins, prob 0.5 each, u = %.9g (bin %zu, coin %g): item %zu, must be %zu. Is the bin a number of 16 bits, or "
                           "the coin a float?", n, u, j, half ? 0.51 : 0.49, i, must);
            }
        }
    }
    bis_free(prob);
    bis_free(alias);
}

static void the_bin_and_the_coin_come_from_one_u(void)
{
    const double prob[] = {0.25, 1, 0.5, 0.75};
    const uint32_t alias[] = {1, 1, 3, 0};
    const struct { double u; size_t item; } cases[] = {{0.03, 0}, {0.2, 1}, {0.3, 1}, {0.49, 1}, {0.55, 2}, {0.7, 3}, {0.8, 3}, {0.99, 0}};

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const size_t i = bis_alias_pick(prob, alias, 4, cases[k].u);
        if (i != cases[k].item) {
            mark_wrong("4 bins, prob 0.25 1 0.5 0.75, alias 1 1 3 0, u = %g (bin %d, coin %.2f): item %zu, must be %zu", cases[k].u, (int)(4 * cases[k].u),
                       4 * cases[k].u - (int)(4 * cases[k].u), i, cases[k].item);
        }
    }
    check_pick_of_many();
}

/* Where the weights of 0 are, and how many, is known to nobody before; u goes by steps that hit the coin's 0 in every bin. */
static void an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0(void)
{
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
        bis_alias a = alias_of(w, n);
        for (int j = 0; j < 4096; j++) {
            const size_t i = bis_alias_pick(a.prob, a.alias, n, j / 4096.0);
            if (i >= n || w[i] == 0) {
                mark_wrong("weights %g %g %g %g %g %g %g %g, u = %g: item %zu, which has weight 0. What does your comparison say where "
                           "the coin is exactly 0?", w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], j / 4096.0, i);
            }
            drawn[i] = true;
        }
        for (size_t i = 0; i < n; i++) {
            if (w[i] > 0 && !drawn[i]) mark_wrong("item %zu of %zu is never drawn, though its weight is %g", i, n, w[i]);
        }
        bis_alias_clear(&a);
    }
}

static void items_are_drawn_with_their_probabilities(void)
{
    enum { N = 50, DRAWS = 200000 };
    double w[N], observed[N] = {0}, expected[N], sum = 0;
    bis_rng r;

    bis_rng_init(&r, mark_seed(3), 0, 0, 0);
    fill_contrasty(w, N, 4, 2);
    bis_alias a = alias_of(w, N);
    for (int k = 0; k < DRAWS; k++) {
        const size_t i = bis_alias_pick(a.prob, a.alias, N, bis_rng_double(&r));
        if (i >= N) mark_wrong("item %zu of 50", i);
        observed[i]++;
    }
    for (int i = 0; i < N; i++) sum += w[i];
    for (int i = 0; i < N; i++) expected[i] = DRAWS * w[i] / sum;
    mark_fit(observed, expected, N, MARK_ALPHA, "50 items of random weights", "Do table and draw agree which of the two "
             "outcomes of a bin comes first?");
    bis_alias_clear(&a);
}

static void work(void)
{
    enum { N = 100000 };
    double *w = bis_alloc(N, sizeof *w);
    size_t sum = 0;
    bis_rng r;

    if (!w) return;
    bis_rng_init(&r, mark_seed(4), 0, 0, 0);
    fill_contrasty(w, N, 5, 6);
    for (int k = 0; k < 5; k++) {
        bis_alias a;
        if (bis_alias_init(&a, w, N, NULL)) return;
        for (int i = 0; i < 300000; i++) sum += bis_alias_pick(a.prob, a.alias, N, bis_rng_double(&r));
        bis_alias_clear(&a);
    }
    if (sum == 0) mark_wrong("nothing but item 0");
    bis_free(w);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"figure_3_4_comes_out", 15, figure_3_4_comes_out},
        {"every_table_gives_the_weights", 20, every_table_gives_the_weights},
        {"tables_hold_for_a_contrast_of_1e12_and_a_million_items", 10, tables_hold_for_a_contrast_of_1e12_and_a_million_items},
        {"the_bin_and_the_coin_come_from_one_u", 15, the_bin_and_the_coin_come_from_one_u},
        {"an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0", 10, an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0},
        {"items_are_drawn_with_their_probabilities", 10, items_are_drawn_with_their_probabilities},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work);
}
