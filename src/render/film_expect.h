/* SPDX-License-Identifier: BSD-2-Clause */
/* film_expect: what the variance of a pixel's mean, and the difference of its halves, should be. */
#pragma once

/* What is expected of a film of W samples. */
typedef struct bis_film_expected {
    double whole;  /* variance of the mean of all */
    double halves; /* of the variance by the difference of its two parts */
} bis_film_expected;

/* bis_film_expect returns what is expected of P samples and the W - P that follow, 0 < P < W, if V(h) - V(2h) is 1 and
 * edges have this share of it, in [0,1]. V(n) is the variance of the mean of the first n samples; h is the half of
 * `unit`, rounded down, and at least 1. */
bis_film_expected bis_film_expect(double P, double W, double share, double unit);
