/* SPDX-License-Identifier: BSD-2-Clause */
/* alias: the implied pmf is compared with the weights, item by item, which is stronger than any sampling test (E15);
 * then the sampler with the tables. The twins are appendix A as printed. Significance of the one statistical
 * test: 0.01. The chi-square test of draws from a table stands in test_directions.c
 * (chi_square_p_values_of_right_samplers_are_uniform_over_seeds), students' in tests/course/alias.c. */
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/sampler.h"
#include "claim.h"
#include "stat.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MAX_ITEMS = 65536 };

static double alpha(void) { return stat_level(0.01, 1); }
static const double LAST_U = 1 - 0x1p-53;

static bis_alias alias_of(const double *w, size_t n)
{
    bis_alias a;
    assert_int_equal(bis_alias_init(&a, w, n, NULL), BIS_OK);
    return a;
}

/* Weights of `decades` orders of magnitude, log-uniform, every seventh one 0. */
static void fill_contrasty(double *w, size_t n, uint64_t seed, double decades)
{
    bis_rng r;
    bis_rng_init(&r, seed, 0, 0, 0);
    for (size_t i = 0; i < n; i++)
        w[i] = bis_rng_below(&r, 7) == 0 ? 0 : pow(10, decades * (bis_rng_double(&r) - 0.5));
}

/* E15's demands, with w / sum in long double. */
static void assert_exact(const double *w, size_t n)
{
    static double pmf[1 << 21];
    long double sum = 0;
    bis_alias a = alias_of(w, n);
    for (size_t i = 0; i < n; i++)
        sum += (long double)w[i];
    bis_alias_implied_pmf(&a, pmf);
    for (size_t i = 0; i < n; i++) {
        double exact = (double)((long double)w[i] / sum);
        assert_true(a.prob[i] >= 0 && a.prob[i] <= 1 && a.alias[i] < n);
        if (w[i] == 0 && pmf[i] != 0) fail_msg("item %zu of weight 0 has probability %g", i, pmf[i]);
        if (exact >= 1e-290 && !(fabs(pmf[i] - exact) <= 1e-8 * exact))
            fail_msg("item %zu of %zu: %.12g, must be %.12g", i, n, pmf[i], exact);
    }
    if (isfinite(a.total)) assert_true(fabs(a.total - (double)sum) <= 1e-14 * a.total);
    bis_alias_clear(&a);
}

static void figure_3_4_is_reproduced_up_to_rounding_E11(void **state)
{
    const double P[] = {.1, .2, .4, .3};
    bis_alias a = alias_of(P, 4);
    assert_true(fabs(a.prob[0] - 0.4) < 1e-15 && fabs(a.prob[1] - 0.8) < 1e-15); /* N P_j of those below the line */
    assert_true(a.alias[0] >= 2 && a.alias[1] >= 2);                             /* filled by one of the two above it */
    bis_alias_clear(&a);
    assert_exact(P, 4); /* which of 0.4 and 0.3 is chopped below 1/N depends on rounding: the pmf does not */
}

static void E13_alias_pmf_is_the_same_for_weights_scaled_by_1e30(void **state)
{
    static double w[MAX_ITEMS], scaled[MAX_ITEMS], pmf[MAX_ITEMS], other[MAX_ITEMS];
    const double scales[] = {1e-30, 1e30};
    const size_t n = 5000;
    fill_contrasty(w, n, 1, 12);
    bis_alias a = alias_of(w, n);
    bis_alias_implied_pmf(&a, pmf);
    bis_alias_clear(&a);
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < n; i++)
            scaled[i] = w[i] * scales[k];
        assert_exact(scaled, n);
        a = alias_of(scaled, n);
        bis_alias_implied_pmf(&a, other);
        for (size_t i = 0; i < n; i++)
            assert_true(fabs(other[i] - pmf[i]) <= 1e-10 * pmf[i]);
        bis_alias_clear(&a);
    }
}

/* Appendix A as printed: the weights are compared with 1/N as they come. single: what is stored has a float's
 * precision. */
static void build_as_printed(double *probs, uint32_t *alias, size_t n, bool single)
{
    static uint32_t small[MAX_ITEMS], large[MAX_ITEMS];
    size_t n_small = 0, n_large = 0;
    const double standard = 1.0 / (double)n;
    for (size_t i = 0; i < n; i++)
        if (probs[i] > standard)
            large[n_large++] = (uint32_t)i;
        else
            small[n_small++] = (uint32_t)i;
    while (n_large > 0 && n_small > 0) {
        uint32_t sm = small[--n_small], lg = large[--n_large];
        probs[lg] -= standard - probs[sm];
        probs[sm] *= (double)n;
        if (single) {
            probs[lg] = (double)(float)probs[lg];
            probs[sm] = (double)(float)probs[sm];
        }
        alias[sm] = lg;
        if (probs[lg] > standard)
            large[n_large++] = lg;
        else
            small[n_small++] = lg;
    }
    for (size_t i = 0; i < n_small; i++)
        probs[small[i]] = 1;
    for (size_t i = 0; i < n_large; i++)
        probs[large[i]] = 1;
}

/* Half the sum of |pmf - w / sum|: the share of all draws that go astray. */
static double total_variation(const bis_alias *a, const double *w, size_t n)
{
    static double pmf[MAX_ITEMS];
    double sum = 0, variation = 0;
    for (size_t i = 0; i < n; i++)
        sum += w[i];
    bis_alias_implied_pmf(a, pmf);
    for (size_t i = 0; i < n; i++)
        variation += fabs(pmf[i] - w[i] / sum) / 2;
    return variation;
}

static void E13_appendix_A_as_printed_is_uniform_on_raw_radiances(void **state)
{
    static double w[MAX_ITEMS], printed[MAX_ITEMS];
    static uint32_t alias[MAX_ITEMS];
    const size_t n = 10000;
    bis_rng r;
    bis_rng_init(&r, 2, 0, 0, 0);
    for (size_t i = 0; i < n; i++)
        w[i] = printed[i] = exp(10 * bis_rng_double(&r)); /* all above 1/N */
    build_as_printed(printed, alias, n, false);
    bis_alias ours = alias_of(w, n), twin = {n, 1, printed, alias};
    assert_true(total_variation(&ours, w, n) < 1e-12);
    assert_true(total_variation(&twin, w, n) > 0.5);
    bis_alias_clear(&ours);
}

/* 3.2.2 says prob_j = 1 where P_j > 1/N. Here 0.45 gives, falls below 1/3 and needs an alias of its own. */
static void E11_a_giver_that_falls_below_the_line_has_prob_below_1(void **state)
{
    const double P[] = {.1, .45, .45};
    bis_alias a = alias_of(P, 3);
    assert_exact(P, 3);
    assert_true(total_variation(&a, P, 3) < 1e-15);
    for (int j = 1; j < 3; j++)
        a.prob[j] = 1; /* the twin: as the prose has it */
    assert_true(total_variation(&a, P, 3) > 0.05);
    bis_alias_clear(&a);
}

static void E14_an_item_of_weight_0_is_not_drawn_when_the_fraction_is_0(void **state)
{
    const double w[] = {0, 1}, u[] = {0, 0x1p-53, 0.5 - 0x1p-53, 0.5, LAST_U};
    bis_alias a = alias_of(w, 2);
    for (int k = 0; k < 5; k++) {
        size_t i = bis_alias_sample(&a, u[k]);
        assert_int_equal(i, 1);
        double x = u[k] * 2; /* the twin: u - i > prob ? alias : i */
        size_t j = (size_t)x, printed = x - (double)j > a.prob[j] ? a.alias[j] : j;
        assert_int_equal(printed, k == 0 ? 0 : 1);
    }
    bis_alias_clear(&a);
}

/* A number of 24 bits, as a float generator gives, leaves 24 - 19 = 5 of them for the coin: `u - i > prob` returns
 * black texels in 1 of 32 draws that fall on one. */
static void E14_few_bits_make_the_printed_test_draw_black_texels(void **state)
{
    const size_t n = (size_t)1 << 19;
    double *w = bis_alloc(n, sizeof *w);
    for (size_t i = 0; i < n; i += 2)
        w[i] = 1;
    bis_alias a = alias_of(w, n);
    size_t black = 0, black_as_printed = 0, draws = (size_t)1 << 24;
    for (size_t k = 0; k < draws; k++) {
        double u = (double)k * 0x1p-24, x = u * (double)n;
        size_t j = (size_t)x, printed = x - (double)j > a.prob[j] ? a.alias[j] : j;
        black += w[bis_alias_sample(&a, u)] == 0;
        black_as_printed += w[printed] == 0;
    }
    assert_int_equal(black, 0);
    assert_int_equal(black_as_printed, draws / 2 / 32);
    bis_alias_clear(&a);
    bis_free(w);
}

/* The bin of the largest u is the last one, never N, for every N: the proof in src/thesis/alias.c. */
static void E14_the_largest_u_falls_into_the_last_bin_for_every_n(void **state)
{
    const size_t most = (size_t)1 << 20;
    double *prob = bis_alloc(most, sizeof *prob);
    uint32_t *alias = bis_alloc(most, sizeof *alias);
    for (size_t i = 0; i < most; i++)
        prob[i] = 1;
    for (size_t n = 1; n <= most; n++)
        assert_int_equal(bis_alias_pick(prob, alias, n, LAST_U), n - 1);
    bis_free(prob);
    bis_free(alias);
}

static void E15_the_implied_pmf_is_exact_for_contrasty_tables_of_any_size(void **state)
{
    static double w[MAX_ITEMS];
    const size_t sizes[] = {1, 2, 3, 4, 5, 17, 256, 1000, 65536};
    const double decades[] = {0, 1, 7, 12, 30, 600};
    for (int s = 0; s < 9; s++)
        for (int d = 0; d < 6; d++) {
            fill_contrasty(w, sizes[s], 10 + (uint64_t)d, decades[d]);
            w[sizes[s] / 2] = 1;
            assert_exact(w, sizes[s]);
        }
}

static void E15_the_implied_pmf_is_exact_beside_one_weight_of_1e12_times_the_rest(void **state)
{
    const size_t n = 1000000;
    double *w = bis_alloc(n, sizeof *w);
    fill_contrasty(w, n, 3, 2);
    const size_t places[] = {0, 500000, 999999};
    for (int k = 0; k < 3; k++) {
        double was = w[places[k]];
        w[places[k]] = 1e12;
        assert_exact(w, n);
        w[places[k]] = 1e12 * 1e6; /* 1e12 times the sum of the rest */
        assert_exact(w, n);
        w[places[k]] = was;
    }
    bis_free(w);
}

static void E15_the_implied_pmf_is_exact_from_the_least_to_the_largest_double(void **state)
{
    const double cases[][4] = {{1e-300, 1e300, 1, 0},     {5e-324, 0, 5e-324, 5e-324}, {1e-310, 2e-310, 3e-310, 0},
                               {DBL_MAX, DBL_MAX, 0, 1},  {DBL_MAX, 1e300, 1e290, 0},  {1e300, 3e300, 1e11, 1e10},
                               {0, 0, 0, DBL_MIN},        {1, 1, 1, 1},                {1, 1 + DBL_EPSILON, 1, 1},
                               {0.25, 0.25, 0.25, 0.25}};
    for (int k = 0; k < 10; k++)
        assert_exact(cases[k], 4);
}

static void E15_an_alias_off_by_one_is_rejected(void **state)
{
    double w[40], observed[40] = {0}, twin[40] = {0}, expected[40], sum = 0;
    fill_contrasty(w, 40, 5, 2);
    for (int i = 0; i < 40; i++)
        sum += w[i];
    bis_alias a = alias_of(w, 40);
    bis_rng r;
    bis_rng_init(&r, 5, 0, 0, 0);
    for (int k = 0; k < 200000; k++) {
        double u = bis_rng_double(&r), x = u * 40;
        size_t j = (size_t)x;
        observed[bis_alias_sample(&a, u)]++;
        twin[x - (double)j < a.prob[j] ? j : (a.alias[j] + 1) % 40]++;
    }
    for (int i = 0; i < 40; i++)
        expected[i] = 200000 * w[i] / sum;
    stat_assert_fit("alias", 5, observed, expected, 40, alpha());
    stat_assert_no_fit("alias_twin", 5, twin, expected, 40, alpha());
    for (int i = 0; i < 40; i++)
        if (a.prob[i] < 1) a.alias[i] = (a.alias[i] + 1) % 40;
    assert_true(total_variation(&a, w, 40) > 0.01);
    bis_alias_clear(&a);
}

/* Largest relative error of a positive item's probability; *black: how many of weight 0 have any. */
static double worst_error(const bis_alias *a, const double *w, int *black)
{
    static double pmf[MAX_ITEMS];
    double worst = 0;
    long double sum = 0;
    *black = 0;
    for (size_t i = 0; i < a->n; i++)
        sum += (long double)w[i];
    bis_alias_implied_pmf(a, pmf);
    for (size_t i = 0; i < a->n; i++) {
        *black += w[i] == 0 && pmf[i] > 0;
        if (w[i] > 0) worst = fmax(worst, fabs(pmf[i] / (double)((long double)w[i] / sum) - 1));
    }
    return worst;
}

/* One item of half the sum gives to all others, and its rounding errors add up. What is left over in the end gets
 * prob 1, though it be of weight 0. */
static void E15_a_float_table_as_printed_is_rejected_and_draws_a_black_leftover(void **state)
{
    static double w[MAX_ITEMS], printed[MAX_ITEMS];
    static uint32_t alias[MAX_ITEMS];
    const size_t n = MAX_ITEMS;
    double sum = 0;
    int black, black_as_printed;
    fill_contrasty(w, n, 15, 5);
    w[0] = w[n / 2] = 0;
    for (size_t i = 0; i < n; i++)
        sum += w[i];
    w[n / 2] = sum;
    for (size_t i = 0; i < n; i++)
        printed[i] = (double)(float)(w[i] / (2 * sum));
    build_as_printed(printed, alias, n, true);
    bis_alias ours = alias_of(w, n), twin = {n, 1, printed, alias};
    double error = worst_error(&ours, w, &black), error_as_printed = worst_error(&twin, w, &black_as_printed);
    print_message(
        "largest relative error of %zu items: %.2g; float table as printed: %.2g, draws %d items of weight 0\n", n,
        error, error_as_printed, black_as_printed);
    assert_true(error <= 1e-8 && black == 0);
    assert_true(error_as_printed > 0.01 && black_as_printed > 0);
    bis_alias_clear(&ours);
}

static void E16_the_weights_are_left_alone(void **state)
{
    double w[100], copy[100];
    fill_contrasty(w, 100, 6, 5);
    memcpy(copy, w, sizeof w);
    bis_alias a = alias_of(w, 100);
    assert_memory_equal(w, copy, sizeof w);
    bis_alias_clear(&a);
    uint32_t alias[100];
    build_as_printed(copy, alias, 100, false); /* the twin works on the caller's own */
    assert_memory_not_equal(w, copy, sizeof w);
}

/* No weight at all: nothing is above the line, all are leftovers, and each gets prob 1. */
static void E16_black_as_printed_is_uniform(void **state)
{
    double black[3] = {0}, pmf[2][3];
    uint32_t alias[3] = {0};
    bis_alias ours = alias_of(black, 3), twin = {3, 1, black, alias};
    build_as_printed(black, alias, 3, false);
    bis_alias_implied_pmf(&ours, pmf[0]);
    bis_alias_implied_pmf(&twin, pmf[1]);
    for (int i = 0; i < 3; i++)
        assert_true(pmf[0][i] == 0 && fabs(pmf[1][i] - 1.0 / 3) < 1e-15);
    bis_alias_clear(&ours);
}

static void E16_nothing_one_and_all_zero_are_legal_and_zero_is_not_uniform(void **state)
{
    const double zeros[3] = {0}, one[] = {1e-9}, lone[] = {0, 0, 7, 0};
    double pmf[4];
    bis_alias none = alias_of(NULL, 0), black = alias_of(zeros, 3), single = alias_of(one, 1), spot = alias_of(lone, 4);
    assert_true(none.total == 0 && black.total == 0);
    bis_alias_implied_pmf(&none, pmf);
    bis_alias_implied_pmf(&black, pmf);
    for (int i = 0; i < 3; i++)
        assert_true(pmf[i] == 0 && black.prob[i] == 0 && black.alias[i] < 3);
    assert_true(single.total == 1e-9);
    assert_int_equal(bis_alias_sample(&single, 0), 0);
    assert_int_equal(bis_alias_sample(&single, LAST_U), 0);
    for (int k = 0; k <= 1000; k++)
        assert_int_equal(bis_alias_sample(&spot, fmin(k / 1000.0, LAST_U)), 2);
    bis_alias_clear(&none), bis_alias_clear(&black), bis_alias_clear(&single), bis_alias_clear(&spot);
    bis_alias_clear(&spot);
}

static void E16_without_memory_nothing_is_left(void **state)
{
    const double w[] = {1, 2, 3};
    bis_alias a;
    bis_status status;
    long k = 0;
    do {
        bis_mem_fail_at(++k);
        status = bis_alias_init(&a, w, 3, NULL);
        if (status) {
            assert_int_equal(status, BIS_NOMEM);
            assert_null(a.prob);
            assert_true(a.total == 0);
        }
    } while (status);
    bis_mem_fail_at(0);
    assert_int_equal(k, 4);
    bis_alias_clear(&a);
}

static void rows_can_be_built_in_place_in_two_large_arrays(void **state)
{
    enum { WIDTH = 50, HEIGHT = 20 };
    double w[HEIGHT * WIDTH], prob[HEIGHT * WIDTH];
    uint32_t alias[HEIGHT * WIDTH], work[WIDTH];
    fill_contrasty(w, HEIGHT * WIDTH, 8, 6);
    memset(w + 3 * WIDTH, 0, WIDTH * sizeof *w);
    memcpy(prob, w, sizeof w);
    for (int y = 0; y < HEIGHT; y++) {
        double *row = prob + y * WIDTH;
        double total = bis_alias_build(row, alias + y * WIDTH, row, work, WIDTH);
        bis_alias a = {WIDTH, total, row, alias + y * WIDTH};
        if (y == 3)
            assert_true(total == 0);
        else
            assert_true(total_variation(&a, w + y * WIDTH, WIDTH) < 1e-13);
    }
}

static void twelve_bytes_an_item_are_used(void **state)
{
    double w[100];
    fill_contrasty(w, 100, 9, 1);
    bis_alias a = alias_of(w, 100);
    assert_int_equal(bis_alias_bytes(&a), 1200);
    bis_alias_clear(&a);
}

/* ---- E12: a small map, drawn as chapter 3.3 does, a row and then a texel in it, by either method ---- */

enum { MAP_W = 64, MAP_H = 32, POINTS = 4096 };

typedef struct map {
    bis_cdf cdf_rows, cdf_row[MAP_H];
    bis_alias alias_rows, alias_row[MAP_H];
} map;

static map make_map(void)
{
    map m;
    double rows[MAP_H], w[MAP_W];
    bis_rng r;
    bis_rng_init(&r, 12, 0, 0, 0);
    for (int y = 0; y < MAP_H; y++) {
        rows[y] = 0;
        for (int x = 0; x < MAP_W; x++)
            rows[y] += w[x] = exp(4 * bis_rng_double(&r)) + (x == 40 && y == 9 ? 3000 : 0);
        assert_int_equal(bis_cdf_init(&m.cdf_row[y], w, MAP_W, NULL), BIS_OK);
        m.alias_row[y] = alias_of(w, MAP_W);
    }
    assert_int_equal(bis_cdf_init(&m.cdf_rows, rows, MAP_H, NULL), BIS_OK);
    m.alias_rows = alias_of(rows, MAP_H);
    return m;
}

static void clear_map(map *m)
{
    bis_cdf_clear(&m->cdf_rows);
    bis_alias_clear(&m->alias_rows);
    for (int y = 0; y < MAP_H; y++) {
        bis_cdf_clear(&m->cdf_row[y]);
        bis_alias_clear(&m->alias_row[y]);
    }
}

/* The reflected light of a diffuse surface over the total: the mean of a cosine under the map's distribution. */
static double diffuse(size_t x, size_t y)
{
    double theta = acos(-1) * ((double)y + 0.5) / MAP_H, phi = 2 * acos(-1) * ((double)x + 0.5) / MAP_W;
    return fmax(0, 0.6 * cos(theta) + 0.8 * sin(theta) * cos(phi - 1));
}

static double estimate(const map *m, bool by_cdf, bis_sampler_kind kind, uint64_t run)
{
    static double u[POINTS][2];
    const bis_sampler p = {kind, 12, 1, 1, 1, true};
    bis_stream s;
    double sum = 0;
    bis_stream_init(&s, &p, run, 0);
    bis_stream_points(&s, 0, POINTS, u);
    for (int i = 0; i < POINTS; i++) {
        size_t y = by_cdf ? bis_cdf_sample(&m->cdf_rows, u[i][0], NULL) : bis_alias_sample(&m->alias_rows, u[i][0]);
        size_t x = by_cdf ? bis_cdf_sample(&m->cdf_row[y], u[i][1], NULL) : bis_alias_sample(&m->alias_row[y], u[i][1]);
        sum += diffuse(x, y) / POINTS;
    }
    return sum;
}

/* Against the sum over all texels. */
static double rms_error(const map *m, bool by_cdf, bis_sampler_kind kind)
{
    const int runs = 200;
    double exact = 0, square = 0;
    for (size_t y = 0; y < MAP_H; y++)
        for (size_t x = 0; x < MAP_W; x++)
            exact += bis_cdf_pmf(&m->cdf_rows, y) * bis_cdf_pmf(&m->cdf_row[y], x) * diffuse(x, y);
    for (int run = 0; run < runs; run++) {
        double error = estimate(m, by_cdf, kind, (uint64_t)run) - exact;
        square += error * error / runs;
    }
    return sqrt(square);
}

static void E12_inversion_keeps_the_structure_of_4096_sobol_points_and_alias_loses_it(void **state)
{
    map m = make_map();
    double cdf = rms_error(&m, true, BIS_SAMPLER_SOBOL), alias = rms_error(&m, false, BIS_SAMPLER_SOBOL);
    double cdf_random = rms_error(&m, true, BIS_SAMPLER_RANDOM),
           alias_random = rms_error(&m, false, BIS_SAMPLER_RANDOM);
    clear_map(&m);
    print_message("rms error at 4096 points: cdf %.2g, alias %.2g; random numbers: %.2g, %.2g\n", cdf, alias,
        cdf_random, alias_random);
    assert_true(alias > 2 * cdf);
    /* an rms of 200 runs has a relative standard error of 1/20: four of them, for a ratio */
    assert_true(fabs(alias_random / cdf_random - 1) < 4 * sqrt(2) / 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figure_3_4_is_reproduced_up_to_rounding_E11),
        cmocka_unit_test(E13_alias_pmf_is_the_same_for_weights_scaled_by_1e30),
        cmocka_unit_test(E13_appendix_A_as_printed_is_uniform_on_raw_radiances),
        cmocka_unit_test(E11_a_giver_that_falls_below_the_line_has_prob_below_1),
        cmocka_unit_test(E14_an_item_of_weight_0_is_not_drawn_when_the_fraction_is_0),
        cmocka_unit_test(E14_few_bits_make_the_printed_test_draw_black_texels),
        cmocka_unit_test(E14_the_largest_u_falls_into_the_last_bin_for_every_n),
        cmocka_unit_test(E15_the_implied_pmf_is_exact_for_contrasty_tables_of_any_size),
        cmocka_unit_test(E15_the_implied_pmf_is_exact_beside_one_weight_of_1e12_times_the_rest),
        cmocka_unit_test(E15_the_implied_pmf_is_exact_from_the_least_to_the_largest_double),
        cmocka_unit_test(E15_an_alias_off_by_one_is_rejected),
        cmocka_unit_test(E15_a_float_table_as_printed_is_rejected_and_draws_a_black_leftover),
        cmocka_unit_test(E16_the_weights_are_left_alone),
        cmocka_unit_test(E16_black_as_printed_is_uniform),
        cmocka_unit_test(E16_nothing_one_and_all_zero_are_legal_and_zero_is_not_uniform),
        cmocka_unit_test(E16_without_memory_nothing_is_left),
        cmocka_unit_test(rows_can_be_built_in_place_in_two_large_arrays),
        cmocka_unit_test(twelve_bytes_an_item_are_used),
        cmocka_unit_test(E12_inversion_keeps_the_structure_of_4096_sobol_points_and_alias_loses_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
