/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_advice: the advice from the statistics (trade_advice.c), checked by renders (trade_check.c), and its seconds
 * (trade_seconds.c). */
#pragma once

#include "trade.h"

/* bis_trade_square_passes returns the least number of passes >= least, in [1, 1e9], that the scene's sampler uses
 * well. A stratified one divides the pixel into the most square grid of so many cells: n x n and n x (n + 1) are
 * good. 13 = 1 x 13 leaves twice the relMSE of 12 = 3 x 4 where a picture has many edges (tests/tools/test_trade.c). */
uint32_t bis_trade_square_passes(const bis_trade *t, double least);

/* bis_trade_advise makes the advice; its seconds are those of the sweep's thin film. */
void bis_trade_advise(bis_trade *t);

/* bis_trade_check_advice replaces the advice's passes and errors by such as were measured with that many passes, as far
 * as there is time. */
bis_status bis_trade_check_advice(bis_trade *t, bis_diag *diag);

enum { BIS_TRADE_MOST_SPARED = 5 };

/* bis_trade_scatter returns the relMSE of one of n >= 2 renders that differ in their seeds alone: in each pixel and
 * channel their variance (over n - 1), divided by b^2 + m^2/100 as in bis_compare. b is the mean of the reference and
 * of the renders, weighted by 1/variance; with relmse = 0 the reference alone. m is the mean of b. The `spared` pixels
 * of the largest errors count as 0. All have one size. What noise is left in b makes the result biased, by terms of the
 * order of b's own relMSE. */
double bis_trade_scatter(const bis_image *images, int n, int spared, const bis_trade_reference *reference);

/* bis_trade_time_advice replaces the advice's seconds, which are the sweep's times the pixels, by better ones. */
bis_status bis_trade_time_advice(bis_trade *t, bis_diag *diag);

/* bis_trade_take_known_seconds takes the seconds from an earlier advice with the same setting, as many for each pass.
 * It returns false if there is none. */
bool bis_trade_take_known_seconds(bis_trade_advice *all, int i);
