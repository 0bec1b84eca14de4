/* blocks: a two-level running sum. As bis_candidates_resample, at 0.5 ns a weight. */
#include "blocks.h"

#include "resample.h"

#include "bis/mem.h"

#include <assert.h>

enum { BLOCK = BIS_LANES_BLOCK };

bool bis_blocks_init(bis_blocks *b, uint32_t n, uint32_t N)
{
    const uint32_t most = N < n ? N : n;

    assert(n % BLOCK == 0);
    *b = (bis_blocks){.n = n};
    b->w = bis_alloc(n, sizeof *b->w);
    b->sum = bis_alloc(n / BLOCK, sizeof *b->sum);
    b->lane = bis_alloc(most, sizeof *b->lane);
    b->times = bis_alloc(most, sizeof *b->times);
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
    return n * sizeof(float) + n / BLOCK * sizeof(float) + 2 * (N < n ? N : n) * sizeof(uint32_t);
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

void bis_blocks_choose(bis_blocks *b, uint32_t N, double W, bis_resampling resampling, bis_stream *stream)
{
    bis_marks marks = bis_marks_start(resampling, N, stream);
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
    for (; used < N; used++) choose(b, lane); /* a mark that rounding took to the end of all */
}
