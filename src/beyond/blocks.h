/* blocks: resampling by float weights in blocks of 16 (bis/lanes.h): thesis 4.4's walk along the running sum, block by
 * block where no mark falls. */
#pragma once

#include "bis/thesis/lanes.h"
#include "bis/thesis/integrator.h"

/* n weights, whole blocks; what is chosen of them: lane[k], times[k] > 0, k < n_chosen, ascending. */
typedef struct bis_blocks {
    float *w;               /* [n] */
    float *sum;             /* [n / 16] */
    uint32_t *lane, *times; /* as many as marks, at most n */
    uint32_t n, n_chosen;
} bis_blocks;

/* Room for n weights, whole blocks, and N marks. False: no memory, nothing is held. */
bool bis_blocks_init(bis_blocks *b, uint32_t n, uint32_t N);
void bis_blocks_clear(bis_blocks *b);
size_t bis_blocks_bytes(uint32_t n, uint32_t N);

/* The sum of w[n], n now as given, at most as initialised. Fills sum[]. Always in the same order, whatever the width of
 * a vector. */
double bis_blocks_sum(bis_blocks *b, uint32_t n);

/* Choose by N marks with probabilities w/W, W > 0 as bis_blocks_sum returned it. What the 16 of a block add up to may
 * differ from the block's own sum by 2^-22 of it, by which the chance of the block's last positive lane is off. */
void bis_blocks_choose(bis_blocks *b, uint32_t N, double W, bis_resampling resampling, bis_stream *stream);

/* The same with systematic marks at j + offset, offset in [0,1). */
void bis_blocks_choose_systematic(bis_blocks *b, uint32_t N, double W, double offset);
