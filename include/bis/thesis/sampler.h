/* SPDX-License-Identifier: BSD-2-Clause */
/* sampler: the source of a pixel's numbers in [0,1) (thesis 3.3: "low-discrepancy sequence such as Halton").
 *
 * A bis_sampler says which point set is used. A bis_stream is one camera sample of one pixel: a position in the point
 * set. An integrator asks the stream for sets of points, one set per pair of dimensions, and for plain random
 * numbers. The sets of different dimensions and pixels are scrambled independently (Owen scrambling by hashing: Laine
 * and Karras 2011, Burley 2020).
 *
 * Each point by itself is uniform in [0,1)^2, whatever the kind. All estimators therefore stay unbiased. The kinds
 * differ in how evenly the points fill the square: the points of one set, and those of successive camera samples of
 * one pixel. */
#pragma once

#include "bis/thesis/rng.h"

#include <stdbool.h>
#include <stdint.h>

/* The largest seed, on the command line, in scenes and for other languages. Scenes and JSON hold numbers as doubles;
 * all integers up to this one are doubles, and no other integer is rounded to one of them. */
#define BIS_SEED_MAX ((UINT64_C(1) << 53) - 1)

typedef enum bis_sampler_kind {
    BIS_SAMPLER_RANDOM,     /* independent */
    /* camera: xsamples x ysamples jittered cells; sets: one point in each of n cells along Hilbert's curve */
    BIS_SAMPLER_STRATIFIED,
    /* the first two dimensions of Sobol's sequence, a (0,2)-sequence; sets: Owen-scrambled; camera: samples 2k and 2k +
     * 1 are mirror images of each other through the pixel's centre */
    BIS_SAMPLER_SOBOL,
    BIS_SAMPLER_HALTON      /* bases 2 and 3, Owen-scrambled */
} bis_sampler_kind;

typedef struct bis_sampler {
    bis_sampler_kind kind;
    uint64_t seed;
    /* camera samples per pixel, > 0. It has 64 bits, because outlines take up to 1024 times the scene's number */
    uint64_t spp;
    uint64_t xsamples, ysamples; /* stratified: xsamples * ysamples = spp */
    bool jitter;                 /* stratified: false puts the camera points in the middle of their cells */
} bis_sampler;

/* One camera sample of one pixel. The struct is open, so that a test can forge one. */
typedef struct bis_stream {
    const bis_sampler *sampler;
    uint64_t pixel;  /* y * width + x of the full image */
    uint64_t sample; /* 0, 1, 2, ...; from spp on the point set continues (stratified: with a fresh set of cells) */
    bis_rng rng;     /* plain random numbers of this sample */
} bis_stream;

/* bis_sampler_set_spp sets the number of camera samples per pixel, spp >= 1. It also sets xsamples and ysamples: the
 * most square pair with xsamples * ysamples = spp. */
void bis_sampler_set_spp(bis_sampler *s, uint64_t spp);

/* bis_stream_init starts the stream of one camera sample. pixel is y * width + x of the full image; sample counts
 * from 0. sampler is borrowed for the life of *s. */
void bis_stream_init(bis_stream *s, const bis_sampler *sampler, uint64_t pixel, uint64_t sample);

/* bis_stream_camera stores the place of the camera sample in its pixel, uniform in [0,1)^2, in u[2]. */
void bis_stream_camera(bis_stream *s, double u[2]);

/* bis_stream_points stores n points of the dimension pair `dim` in u[n][2]. The integrator numbers its own pairs: 0,
 * 1, ...
 *
 * Over the camera samples of a pixel, the sets of one dim continue each other. sobol and halton return the points
 * sample*n ... sample*n+n-1 of one sequence. Each dim visits the sequence in an order of its own, because the pairs
 * of two dims would otherwise lie on a line. The numbers have 53 bits, the lowest of them random. stratified returns
 * one point in each n-th part of Hilbert's curve, in the order of the curve. */
void bis_stream_points(bis_stream *s, unsigned dim, uint32_t n, double (*u)[2]);

/* bis_stream_random returns the next plain random number in [0,1). */
static inline double bis_stream_random(bis_stream *s) { return bis_rng_double(&s->rng); }

/* bis_sampler_is_low_discrepancy returns true for sobol and halton. The EM's sampler then defaults to "cdf"
 * (docs/errata.md E12). */
bool bis_sampler_is_low_discrepancy(bis_sampler_kind kind);

/* bis_sampler_name returns "random", "stratified", "sobol" or "halton". */
const char *bis_sampler_name(bis_sampler_kind kind);
