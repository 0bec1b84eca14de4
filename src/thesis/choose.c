/* SPDX-License-Identifier: BSD-2-Clause */
/* choose: N marks on the running sum of the weights (thesis 4.4), at half a nanosecond a weight.
 *
 * The sum has two levels. Weights lie in blocks of 16, and a block without a mark is passed over by its sum. What the
 * 16 weights of a block add up to one by one may differ from the block's own sum by 2^-22 of it, because the two add in
 * another order. The chance of the block's last positive weight is off by that much.
 *
 * Rounding may leave a mark at the end of all: 1 - 2^-54 is 1. It belongs to the last item with a positive weight,
 * which need not be the last of all. */
#include "choose.h"

#include <assert.h>
#include <math.h>

enum { BLOCK = BIS_LANES_BLOCK };

void bis_choice_claim(bis_choice *c, uint32_t n, bis_claims *claims)
{
    assert(n % BLOCK == 0);
    c->w = bis_claim(claims, n, sizeof *c->w);
    c->sum = bis_claim(claims, n / BLOCK, sizeof *c->sum);
    c->item = bis_claim(claims, (size_t)n + 1, sizeof *c->item);
    c->times = bis_claim(claims, (size_t)n + 1, sizeof *c->times);
}

void bis_choice_clear(bis_choice *c)
{
    bis_free(c->w);
    bis_free(c->sum);
    bis_free(c->item);
    bis_free(c->times);
    *c = (bis_choice){.n = 0};
}

/* ---- the sum ---- */

BIS_LANES
static void sum_blocks(float *restrict sum, const float *restrict w, uint32_t n_blocks)
{
    for (uint32_t k = 0; k < n_blocks; k++) sum[k] = bis_lanes_sum(w + BLOCK * (size_t)k);
}

double bis_choice_sum(bis_choice *c, uint32_t n)
{
    double W = 0;

    assert(n % BLOCK == 0);
    c->n = n;
    sum_blocks(c->sum, c->w, n / BLOCK);
    for (uint32_t k = 0; k < n / BLOCK; k++) W += (double)c->sum[k];
    assert(W >= 0 && isfinite(W));
    return W;
}

/* ---- systematic ---- */

/* The number of marks j + offset, j = 0, 1, ..., below x. x is in units of W/N, and at most 2^26. Without a branch, so
 * that a loop of it becomes vectors. */
static inline BIS_INLINE uint32_t marks_below(double x, double offset)
{
    const double d = x - offset;
    const int32_t whole = (int32_t)d;

    return (uint32_t)((whole + (d > (double)whole)) & -(d > 0));
}

/* S_i = S + w_0 + ... + w_i for the 16 of a block. Fours are summed side by side and then put one behind the other: 7
 * additions wait for each other instead of 16. S_i never falls, and where w_i is 0 it does not rise: the first of a
 * four begins at the S_i before it. */
static inline BIS_INLINE void sums_of_block(double S_i[BLOCK], double S, const float *w)
{
    enum { FOUR = 4 };
#pragma GCC unroll 4
    for (uint32_t i = 0; i < BLOCK; i += FOUR) {
        S_i[i] = (double)w[i];
#pragma GCC unroll 3
        for (uint32_t j = i + 1; j < i + FOUR; j++) S_i[j] = S_i[j - 1] + (double)w[j];
    }
#pragma GCC unroll 4
    for (uint32_t i = 0; i < BLOCK; i += FOUR) {
#pragma GCC unroll 4
        for (uint32_t j = i; j < i + FOUR; j++) S_i[j] += S;
        S = S_i[i + FOUR - 1];
    }
}

/* Item i gets the marks below S_i that are not below S_(i-1). They are counted for the 16 of a block at once, and a
 * number is stored whether it is 0 or not and kept if it is not: a branch for each item would be guessed wrong N times,
 * which costs more than the rest of the loop. (Making the sums of several blocks first, so that their vectors need not
 * wait for what was just stored, saves 1 % of a render at most.) */
/* [choose] */
BIS_LANES
static uint32_t choose_systematic(uint32_t *restrict item, uint32_t *restrict times, const float *restrict w,
                                  const float *restrict sum, uint32_t n_blocks, uint32_t N, double W, double offset)
{
    const double marks_per_weight = N / W;
    uint32_t n = 0, given = 0; /* items chosen, marks given away */
    double S_i[BLOCK], S = 0;

    for (uint32_t k = 0; k < n_blocks; k++) {
        const double S_before = S;
        S += (double)sum[k];
        const uint32_t below_end = marks_below(S * marks_per_weight, offset);
        const uint32_t end = k == n_blocks - 1 || below_end > N ? N : below_end;
        if (end <= given) continue;
        uint32_t below[1 + BLOCK], last = BLOCK * k + BLOCK - 1;
        sums_of_block(S_i, S_before, w + BLOCK * (size_t)k);
        below[0] = given;
        /* not for vectors of 16 bytes, which hold two doubles: gcc knows no vector of two integers */
#pragma omp simd simdlen(16)
        for (uint32_t i = 0; i < BLOCK; i++) {
            const uint32_t marks = marks_below(S_i[i] * marks_per_weight, offset);
            const uint32_t most = marks > end ? end : marks;
            below[1 + i] = most > given ? most : given;
        }
#pragma GCC unroll 4
        for (uint32_t i = 0; i < BLOCK; i++) {
            item[n] = BLOCK * k + i;
            times[n] = below[1 + i] - below[i];
            n += below[1 + i] > below[i];
        }
        if (below[BLOCK] < end) { /* what rounding leaves at the end of the block */
            while (w[last] <= 0) last--;
            if (n == 0 || item[n - 1] != last) {
                item[n] = last;
                times[n++] = 0;
            }
            times[n - 1] += end - below[BLOCK];
        }
        given = end;
    }
    return n;
}
/* [end] */

void bis_choose_systematic(bis_choice *c, uint32_t N, double W, double offset)
{
    uint32_t n_blocks = c->n / BLOCK;

    while (c->sum[n_blocks - 1] <= 0) n_blocks--; /* W > 0: one block has a weight. The last marks belong to it */
    c->n_chosen = choose_systematic(c->item, c->times, c->w, c->sum, n_blocks, N, W, offset);
}

/* ---- multinomial ---- */

/* The marks in ascending order: of N - j numbers above mark t, the smallest leaves a fraction (1-u)^(1/(N-j)) of 1 - t
 * above itself (Bentley and Saxe 1980). log_rest is log(1 - t). */
static double next_mark(double *log_rest, uint32_t left, bis_stream *stream)
{
    *log_rest += log1p(-bis_stream_random(stream)) / (double)left;
    return -expm1(*log_rest);
}

static void add_mark(bis_choice *c, uint32_t item)
{
    if (c->n_chosen == 0 || c->item[c->n_chosen - 1] != item) {
        c->item[c->n_chosen] = item;
        c->times[c->n_chosen++] = 0;
    }
    c->times[c->n_chosen - 1]++;
}

/* [choose-multinomial] */
void bis_choose_multinomial(bis_choice *c, uint32_t N, double W, bis_stream *stream)
{
    double log_rest = 0, mark = next_mark(&log_rest, N, stream) * W, S = 0;
    uint32_t given = 0, item = 0;

    c->n_chosen = 0;
    for (uint32_t k = 0; k < c->n / BLOCK; k++) {
        const double end = S + (double)c->sum[k];
        uint32_t next = BLOCK * k;

        while (mark < end) {
            for (; S <= mark && next < BLOCK * (k + 1); next++) {
                if (c->w[next] <= 0) continue;
                S += (double)c->w[next];
                item = next;
            }
            add_mark(c, item);
            if (++given == N) return;
            mark = next_mark(&log_rest, N - given, stream) * W;
        }
        S = end;
    }
    for (item = c->n - 1; c->w[item] <= 0;) item--;
    for (; given < N; given++) add_mark(c, item);
}
/* [end] */
