/* SPDX-License-Identifier: BSD-2-Clause */
/* choose: N of n weights. Each weight gets N w/W marks on average, exactly; every mark lies where it must; and no mark
 * is lost at the ends of the sum. Family-wise significance 1e-3. */
#include "claim.h"
#include "forced.h"
#include "stat.h"
#include "thesis/choose.h"

#include <math.h>

enum { SEED = 47, BLOCK = BIS_LANES_BLOCK, MOST = 1600 };

static double alpha(void) { return stat_level(1e-3, 3); }

static const double last_number = 1 - 0x1p-53;

typedef enum scheme { SYSTEMATIC, MULTINOMIAL } scheme;

static bis_choice new_choice(uint32_t n)
{
    bis_claims claims = {0};
    bis_choice c;

    bis_choice_claim(&c, n, &claims);
    assert_false(claims.failed);
    c.n = n;
    for (uint32_t i = 0; i < n; i++) c.w[i] = 0;
    return c;
}

static void choose(bis_choice *c, uint32_t N, double W, scheme how, bis_rng rng)
{
    bis_stream stream = {.rng = rng};

    if (how == SYSTEMATIC) bis_choose_systematic(c, N, W, bis_stream_random(&stream));
    else bis_choose_multinomial(c, N, W, &stream);
}

/* What every choice keeps, whatever the weights: N marks, on positive weights alone, in order. */
static void check_choice(const bis_choice *c, uint32_t N)
{
    uint64_t marks = 0;

    for (uint32_t j = 0; j < c->n_chosen; j++) {
        assert_true(c->item[j] < c->n && c->w[c->item[j]] > 0 && c->times[j] > 0);
        assert_true(j == 0 || c->item[j] > c->item[j - 1]);
        marks += c->times[j];
    }
    assert_int_equal(marks, N);
}

static uint32_t times_of(const bis_choice *c, uint32_t item)
{
    for (uint32_t j = 0; j < c->n_chosen; j++)
        if (c->item[j] == item) return c->times[j];
    return 0;
}

/* ---- in proportion ---- */

/* Whole weights that sum to 64, and 64 offsets: item i then owns exactly N w_i of the 64 N marks, because a mark is (64
 * j + k + 1/2)/64 N of the sum. Among them an empty block, the last item of a block, and a last block of one item. */
static void every_weight_gets_exactly_its_share_of_marks(void **state)
{
    static const uint32_t Ns[] = {1, 4, 7, 15, 200};
    bis_choice c = new_choice(48);

    c.w[0] = 3, c.w[1] = 1, c.w[7] = 12, c.w[14] = 5, c.w[15] = 16, c.w[39] = 27;
    const double W = bis_choice_sum(&c, 48);
    assert_true(W == 64);
    for (int k = 0; k < 5; k++) {
        uint32_t marks[48] = {0}, as_if_equal = 0;
        for (int offset = 0; offset < 64; offset++) {
            choose(&c, Ns[k], W, SYSTEMATIC, forced((offset + 0.5) / 64, 0));
            check_choice(&c, Ns[k]);
            for (uint32_t i = 0; i < 48; i++) marks[i] += times_of(&c, i);
        }
        for (uint32_t i = 0; i < 48; i++) {
            assert_int_equal(marks[i], (uint32_t)(Ns[k] * (double)c.w[i]));
            as_if_equal += marks[i] == 64 * Ns[k] / 6; /* twin: positive weights, chosen evenly */
        }
        assert_int_equal(as_if_equal, 0);
    }
    choose(&c, 64, W, SYSTEMATIC, forced(0, 0)); /* on whole numbers: a mark at the end of an item is the next one's */
    for (uint32_t i = 0; i < 48; i++) assert_int_equal(times_of(&c, i), (uint32_t)c.w[i]);
    for (int k = 0; k < 64; k++) { /* of one independent mark the place is its random number: log and exp round it */
        choose(&c, 1, W, MULTINOMIAL, forced((k + 0.5) / 64, 0));
        double S = 0;
        uint32_t i = 0;
        while ((S += (double)c.w[i]) <= k) i++;
        assert_int_equal(c.item[0], i);
    }
    bis_choice_clear(&c);
}

/* The largest distance of a systematic mark from the interval of the item that got it, over W. The intervals are summed
 * in long double, one item after the other. */
static double farthest_mark(const bis_choice *c, uint32_t N, double offset)
{
    long double W = 0, S = 0, worst = 0;
    uint32_t i = 0, mark = 0;

    for (uint32_t k = 0; k < c->n; k++) W += (long double)c->w[k];
    for (uint32_t j = 0; j < c->n_chosen; j++) {
        for (; i < c->item[j]; i++) S += (long double)c->w[i];
        const long double end = S + (long double)c->w[i];
        for (uint32_t k = 0; k < c->times[j]; k++, mark++) {
            const long double at = (mark + (long double)offset) / N * W;
            worst = fmaxl(worst, fmaxl(S - at, at - end) / W);
        }
    }
    return (double)worst;
}

/* The sum of a block adds 16 floats in 4 steps, each of which rounds by 2^-24 of the block. So a place in the running
 * sum is off by 2^-22 W, and W itself by as much. */
static void every_mark_falls_on_the_weight_that_lies_there(void **state)
{
    static const uint32_t ns[] = {16, 32, 160, MOST}, Ns[] = {1, 7, 64, 5000};
    double worst = 0, twin = 0;
    bis_rng r;

    bis_rng_init(&r, SEED, 0, 0, 0);
    for (int k = 0; k < 4 * 4 * 3 * 20; k++) {
        const uint32_t n = ns[k % 4], N = Ns[k / 4 % 4];
        const double spread = (double[]){0, 3, 30}[k / 16 % 3], offset = bis_rng_double(&r);
        bis_choice c = new_choice(n);
        for (uint32_t i = 0; i < n; i++) {
            const bool none = bis_rng_double(&r) < 0.3;
            c.w[i] = (float)(none ? 0 : pow(10, spread * (bis_rng_double(&r) - 0.5)));
        }
        c.w[n / 2] = 1;
        bis_choose_systematic(&c, N, bis_choice_sum(&c, n), offset);
        check_choice(&c, N);
        worst = fmax(worst, farthest_mark(&c, N, offset));
        for (uint32_t i = 0; i < n; i++) c.w[i] *= i % 16 ? 1 : 0.999f; /* twin: other weights than those */
        twin = fmax(twin, farthest_mark(&c, N, offset));
        bis_choice_clear(&c);
    }
    assert_true(worst <= 0x1p-21);
    assert_true(twin > 0x1p-21);
}

static void independent_marks_have_the_law_of_the_weights(void **state)
{
    enum { N = 5, RUNS = 40000 };
    static const float w[BLOCK] = {0, 3, 1e-3f, 0, 7, 0.5f, 2, 0};
    double observed[2][BLOCK] = {{0}}, expected[BLOCK], equal[BLOCK];
    bis_choice c = new_choice(BLOCK);

    for (int i = 0; i < BLOCK; i++) c.w[i] = w[i];
    const double W = bis_choice_sum(&c, BLOCK);
    for (uint64_t run = 0; run < 2 * RUNS; run++) {
        bis_rng r;
        bis_rng_init(&r, SEED, run, 0, 0);
        choose(&c, N, W, run % 2 ? MULTINOMIAL : SYSTEMATIC, r);
        check_choice(&c, N);
        if (run % 2 == 0) assert_in_range(times_of(&c, 4), 2, 3); /* it holds 0.56 of 5 equally spaced marks */
        for (uint32_t i = 0; i < BLOCK; i++) observed[run % 2][i] += times_of(&c, i);
    }
    for (int i = 0; i < BLOCK; i++) expected[i] = N * RUNS * (double)w[i] / W, equal[i] = w[i] > 0 ? N * RUNS / 5.0 : 0;
    for (int how = 0; how < 2; how++) {
        stat_assert_fit("resampling", SEED, observed[how], expected, BLOCK, alpha());
        stat_assert_no_fit("resampling_uniform", SEED, observed[how], equal, BLOCK, alpha());
    }
    bis_choice_clear(&c);
}

/* Made in ascending order, multinomial marks are distributed like independent ones, and so are pairs of them. */
static void multinomial_choices_are_independent(void **state)
{
    enum { RUNS = 50000 };
    double observed[16] = {0}, expected[16];
    bis_choice c = new_choice(BLOCK);

    for (int i = 0; i < 4; i++) c.w[i] = (float)(i + 1);
    const double W = bis_choice_sum(&c, BLOCK);
    for (uint64_t run = 0; run < RUNS; run++) {
        bis_rng r;
        bis_rng_init(&r, SEED, run, 1, 0);
        choose(&c, 2, W, MULTINOMIAL, r);
        observed[c.item[0] * 4 + c.item[c.n_chosen - 1]]++;
    }
    for (int i = 0; i < 16; i++) {
        const double p = (i / 4 + 1) * (i % 4 + 1) / (W * W);
        expected[i] = RUNS * (i / 4 > i % 4 ? 0 : i / 4 == i % 4 ? p : 2 * p);
    }
    stat_assert_fit("multinomial_pairs", SEED, observed, expected, 16, alpha());
    bis_choice_clear(&c);
}

/* ---- the ends ---- */

/* The first number that there is falls on the first positive weight, the last one on the last, wherever empty blocks
 * lie. With W = 49, 49 (1/49) rounds to less than 1: a mark is left at the end of all weights. */
static void first_and_last_numbers_fall_on_the_first_and_last_positive_weight(void **state)
{
    static const uint32_t Ns[] = {1, 3, 7, 15, 49};

    for (int k = 0; k < 5 * 5 * 2 * 2; k++) {
        const uint32_t N = Ns[k % 5], from = (uint32_t)k / 5 % 5; /* all blocks are empty but two */
        const scheme how = k / 25 % 2 ? MULTINOMIAL : SYSTEMATIC;
        const bool at_end = k / 50;
        bis_choice c = new_choice(7 * BLOCK);
        for (int sum = 1; sum <= 4096; sum += sum < 100 ? 1 : 37) {
            c.w[from * BLOCK + 3] = 1e-30f, c.w[from * BLOCK + 5] = (float)sum, c.w[from * BLOCK + 18] = 1e-9f;
            choose(&c, N, bis_choice_sum(&c, c.n), how, forced(at_end ? last_number : 0, 0));
            check_choice(&c, N);
            if (N > 1) continue;
            assert_true(at_end ? c.item[0] >= from * BLOCK + 5 : c.item[0] == from * BLOCK + 3);
        }
        bis_choice_clear(&c);
    }
}

/* No mark is lost where rounding takes it beyond the end: told a sum twice as large, so that half of the marks lie
 * there, N are chosen all the same, and the last positive weight has those. */
static void marks_beyond_the_end_fall_on_the_last_positive_weight(void **state)
{
    static const uint32_t Ns[] = {1, 2, 7, 40};

    for (int k = 0; k < 2 * 4; k++) {
        const uint32_t N = Ns[k % 4];
        uint32_t beyond = 0;
        bis_choice c = new_choice(80);
        for (uint32_t i = 0; i < 40; i++) c.w[i] = i % 3 == 1 ? (float)(1 + i % 5) : 0; /* 37 is the last */
        const double W = bis_choice_sum(&c, 80);
        for (int run = 0; run < 100; run++) {
            choose(&c, N, 2 * W, k / 4 ? MULTINOMIAL : SYSTEMATIC, forced((run + 0.5) / 100, 0));
            check_choice(&c, N);
            beyond += times_of(&c, 37);
        }
        assert_true(beyond >= 30 * N); /* half of all, and its own share */
        bis_choice_clear(&c);
    }
}

/* In float 1 + 1.5 2^-24 is 1 + 2^-23, the sum of a block; its weights one by one end below. A mark between the two has
 * no weight there, and belongs to the last positive one of the block. */
static void a_mark_that_rounding_leaves_in_a_block_falls_on_its_last_positive_weight(void **state)
{
    bis_choice c = new_choice(2 * BLOCK);

    c.w[2] = 1, c.w[10] = 1.5f * 0x1p-24f, c.w[20] = 3;
    const double W = bis_choice_sum(&c, 2 * BLOCK);
    assert_true(W == 4 + 0x1p-23);
    for (int how = 0; how < 2; how++) {
        choose(&c, 1, W, how ? MULTINOMIAL : SYSTEMATIC, forced(floor((1 + 1.75 * 0x1p-24) / W * 0x1p53) * 0x1p-53, 0));
        check_choice(&c, 1);
        assert_int_equal(c.item[0], 10);
    }
    bis_choice_clear(&c);
}

static void one_positive_weight_gets_every_mark_wherever_it_lies_and_however_small_it_is(void **state)
{
    static const float weights[] = {1e-44f, 1e-30f, 1, 1e30f};
    bis_choice c = new_choice(48);

    for (uint32_t i = 0; i < 48 * 4 * 2; i++) {
        for (uint32_t k = 0; k < 48; k++) c.w[k] = k == i % 48 ? weights[i / 48 % 4] : 0;
        choose(&c, 15, bis_choice_sum(&c, 48), i / 192 ? MULTINOMIAL : SYSTEMATIC, forced(i / 384.0, 0));
        assert_true(c.n_chosen == 1 && c.item[0] == i % 48 && c.times[0] == 15);
    }
    bis_choice_clear(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_weight_gets_exactly_its_share_of_marks),
        cmocka_unit_test(every_mark_falls_on_the_weight_that_lies_there),
        cmocka_unit_test(independent_marks_have_the_law_of_the_weights),
        cmocka_unit_test(multinomial_choices_are_independent),
        cmocka_unit_test(first_and_last_numbers_fall_on_the_first_and_last_positive_weight),
        cmocka_unit_test(marks_beyond_the_end_fall_on_the_last_positive_weight),
        cmocka_unit_test(a_mark_that_rounding_leaves_in_a_block_falls_on_its_last_positive_weight),
        cmocka_unit_test(one_positive_weight_gets_every_mark_wherever_it_lies_and_however_small_it_is),
    };

    return cmocka_run_group_tests_name("choose", tests, NULL, NULL);
}
