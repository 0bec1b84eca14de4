/* SPDX-License-Identifier: BSD-2-Clause */
/* sine: sin and cos with the same bits on every machine. C leaves the last bit of libm's to each C library, and glibc
 * and musl do differ; what a table of a map holds shall not. */
#pragma once

/* bis_sine returns sin x, bis_cosine cos x, the nearest double of each; x in [0, pi/2], for cos not within 1e-8 of
 * pi/2. Some 200 ns: for tables, not
 * for samples. */
double bis_sine(double x);
double bis_cosine(double x);
