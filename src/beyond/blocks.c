/* blocks: a two-level running sum. As bis_candidates_resample, at 0.5 ns a weight. */
#include "blocks.h"

#include "thesis/resample.h"

#include "bis/base/mem.h"

#include <assert.h>

enum { BLOCK = BIS_LANES_BLOCK };

bool bis_blocks_init(bis_blocks *b, uint32_t n, uint32_t N)
{
    const uint32_t most = N < n ? N : n;

    assert(n % BLOCK == 0);
    *b = (bis_blocks){.n = n};
    b->w = bis_alloc(n, sizeof *b->w);
    b->sum = bis_alloc(n / BLOCK, sizeof *b->sum);
    b->lane = bis_alloc((size_t)most + 1, sizeof *b->lane); /* one more is written than chosen */
    b->times = bis_alloc((size_t)most + 1, sizeof *b->times);
    if (b->w && b->sum && b->lane && b->times) return true;
    bis_blocks_clear(b);
    return false;
}

void bis_blocks_clear(bis_blocks *b)
{
    bis_free(b->w);
    bis_free(b->sum);
    bis_free(b->lane);
    bis_free(b->times);
    *b = (bis_blocks){.n = 0};
}

size_t bis_blocks_bytes(uint32_t n, uint32_t N)
{
    return n * sizeof(float) + n / BLOCK * sizeof(float) + 2 * ((size_t)(N < n ? N : n) + 1) * sizeof(uint32_t);
}

BIS_LANES
static void sum_blocks(float *restrict sum, const float *restrict w, uint32_t n_blocks)
{
    for (uint32_t k = 0; k < n_blocks; k++) {
        const float *v = w + BLOCK * (size_t)k;
        float a[8], c[4];

        for (int i = 0; i < 8; i++) a[i] = v[i] + v[i + 8];
        for (int i = 0; i < 4; i++) c[i] = a[i] + a[i + 4];
        sum[k] = (c[0] + c[2]) + (c[1] + c[3]);
    }
}

double bis_blocks_sum(bis_blocks *b, uint32_t n)
{
    double W = 0;

    assert(n % BLOCK == 0);
    b->n = n;
    sum_blocks(b->sum, b->w, n / BLOCK);
    for (uint32_t k = 0; k < n / BLOCK; k++) W += (double)b->sum[k];
    assert(W >= 0 && isfinite(W));
    return W;
}

/* ---- systematic: how many marks lie before each sum ---- */

/* Marks j = 0, 1, ... at j + offset that lie below x <= 2^24, as many as a camera sample can have. */
static inline BIS_INLINE uint32_t marks_below(double x, double offset)
{
    const double d = x - offset;
    const int32_t whole = (int32_t)d;

    return d > 0 ? (uint32_t)(whole + (d > (double)whole)) : 0;
}

/* Each lane takes the marks between the sum before it and the sum with it. How many marks lie below each sum is found
 * for a block at once. No branch but for blocks without a mark: N marks cost N wrong guesses else. */
BIS_LANES
static uint32_t choose_systematic(uint32_t *restrict lane, uint32_t *restrict times, const float *restrict w,
                                  const float *restrict sum, uint32_t n_blocks, uint32_t N, double W, double offset)
{
    const double per_weight = N / W;
    uint32_t n = 0, taken = 0;
    double S = 0;

    for (uint32_t k = 0; k < n_blocks; k++, w += BLOCK) {
        const double end_of_block = S + (double)sum[k];
        uint32_t end = marks_below(end_of_block * per_weight, offset), last = BLOCK * k, below[BLOCK];
        double with[BLOCK];

        end = k == n_blocks - 1 || end > N ? N : end;
        if (end > taken) {
            for (uint32_t i = 0; i < BLOCK; i++) with[i] = S += (double)w[i];
#pragma omp simd
            for (uint32_t i = 0; i < BLOCK; i++) below[i] = marks_below(with[i] * per_weight, offset);
            for (uint32_t i = 0; i < BLOCK; i++) {
                uint32_t e = below[i] > end ? end : below[i];
                e = e < taken ? taken : e;
                lane[n] = BLOCK * k + i;
                times[n] = e - taken;
                n += e > taken;
                taken = e;
            }
            if (taken < end) { /* what rounding leaves at the end of a block, or of all */
                last = BLOCK - 1;
                while (w[last] <= 0) last--;
                const bool again = n > 0 && lane[n - 1] == BLOCK * k + last;
                n += !again;
                lane[n - 1] = BLOCK * k + last;
                times[n - 1] = (again ? times[n - 1] : 0) + end - taken;
                taken = end;
            }
        }
        S = end_of_block;
    }
    return n;
}

void bis_blocks_choose_systematic(bis_blocks *b, uint32_t N, double W, double offset)
{
    b->n_chosen = choose_systematic(b->lane, b->times, b->w, b->sum, b->n / BLOCK, N, W, offset);
}

/* ---- multinomial: mark by mark ---- */

/* One more mark on a lane. */
static void choose(bis_blocks *b, uint32_t lane)
{
    if (b->n_chosen && b->lane[b->n_chosen - 1] == lane) {
        b->times[b->n_chosen - 1]++;
        return;
    }
    b->lane[b->n_chosen] = lane;
    b->times[b->n_chosen++] = 1;
}

static void choose_multinomial(bis_blocks *b, uint32_t N, double W, bis_stream *stream)
{
    bis_marks marks = bis_marks_start(BIS_RESAMPLING_MULTINOMIAL, N, stream);
    double mark = bis_marks_next(&marks, stream) * W, S = 0;
    uint32_t used = 0, lane = 0;

    b->n_chosen = 0;
    for (uint32_t k = 0; k < b->n / BLOCK; k++) {
        const double end = S + (double)b->sum[k];
        uint32_t next = BLOCK * k;

        while (mark < end) {
            for (; S <= mark && next < BLOCK * (k + 1); next++) {
                if (b->w[next] <= 0) continue;
                S += (double)b->w[next];
                lane = next;
            }
            choose(b, lane);
            if (++used == N) return;
            mark = bis_marks_next(&marks, stream) * W;
        }
        S = end;
    }
    for (lane = b->n - 1; b->w[lane] <= 0;) lane--; /* marks that rounding took to the end of all: 1 - 2^-54 is 1 */
    for (; used < N; used++) choose(b, lane);
}

void bis_blocks_choose(bis_blocks *b, uint32_t N, double W, bis_resampling resampling, bis_stream *stream)
{
    if (resampling == BIS_RESAMPLING_SYSTEMATIC) bis_blocks_choose_systematic(b, N, W, bis_stream_random(stream));
    else choose_multinomial(b, N, W, stream);
}
