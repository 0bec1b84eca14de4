/* SPDX-License-Identifier: BSD-2-Clause */
/* sampler: point sets as functions of (seed, pixel, sample, dimension).
 *
 * Every set has its own stream of random numbers, keyed by (seed, pixel, sample, dim). Every sequence has a key
 * (seed, pixel, dim) that its sets share. The kinds:
 *   stratified   Hilbert's curve, cut into n equal pieces, with a random point in each (Hilbert: any n is possible)
 *   sobol        the digits of the index in base 2, reversed, and the same after a triangular matrix. This is a
 *                (0,2)-sequence: each aligned block of 2^k points has one point in each of the 2^k boxes of any shape
 *                2^-i x 2^-(k-i)
 *   halton       the digits of the index, reversed in base 2 and in base 3
 *
 * Owen's scrambling (src/base/scramble.h) keeps the nets nets, makes each point uniform, and makes two sequences with
 * different keys independent. Two scrambled copies of one sequence would still be paired point by point: the first bit
 * of one would always determine the first bit of the other. Each dimension pair therefore visits its sequence in an
 * order of its own (Burley 2020). Cost of a point in a set of 16, on a busy EPYC: random 12 ns, sobol
 * and stratified 72, halton 145, most of it for the digits in base 3.
 *
 * The camera samples of sobol are mirrored, too: samples 2k and 2k + 1 are mirror images through the pixel's centre, so
 * that a change of the radiance in proportion to the place cancels in each pair (antithetic points; on nets: Owen
 * 2008). Light does not change in proportion to the numbers that its directions are drawn with, so its sets are not
 * mirrored. */
#include "bis/thesis/sampler.h"

#include "base/scramble.h"
#include "bis/base/curve.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/* The purposes of random streams; 0 is that of the integrators. Sets and sequences add their dim. */
static const uint64_t PURPOSE_CAMERA = (uint64_t)1 << 32;
static const uint64_t PURPOSE_SET = (uint64_t)2 << 32;
static const uint64_t PURPOSE_SEQUENCE = (uint64_t)3 << 32;

/* The camera's dimension among the sequences. No integrator numbers its dimensions so high. */
enum { CAMERA_DIM = 0x7fffffff };

/* ---- base 2 ---- */

/* The index itself is scrambled first, from its highest digit down: that gives a sequence an order of its own, and
 * leaves each aligned block of 2^k indices a block, so that what was a net stays one. The digits of a point end after
 * 32; random ones follow, because a point is uniform in [0,1), and not on a grid. */
static void sobol_points(uint32_t scramble(uint32_t x, uint32_t key), bis_rng *sequence, bis_rng *random,
                         uint64_t first, uint32_t n, double (*u)[2])
{
    uint64_t key = bis_rng_u64(sequence), order = bis_rng_u64(sequence);
    for (uint32_t i = 0; i < n; i++) {
        uint64_t epoch = bis_hash((first + i) >> 32),
                 tail = bis_rng_u64(random); /* after 2^32 points, a new sequence */
        uint64_t k = key ^ epoch;
        uint32_t index = reversed(scrambled(reversed((uint32_t)(first + i)), (uint32_t)(order ^ epoch)));
        u[i][0] = with_random_tail(reversed(scramble(index, (uint32_t)k)), tail);
        u[i][1] = with_random_tail(reversed(scramble(sobol2(index), (uint32_t)(k >> 32))), tail >> 32);
    }
}

/* ---- base 3 ---- */

/* An index has no more digits than the last one of the set, or of all camera samples, and the rest are 0 in all of
 * them: in base 3 only `depth` digits are scrambled, and a random number takes the place of the rest. */
static void halton_points(bis_rng *sequence, bis_rng *random, uint64_t first, uint64_t count, uint32_t n,
                          double (*u)[2])
{
    uint64_t key2 = bis_rng_u64(sequence), key3 = bis_rng_u64(sequence);
    int depth = base3_digits(first + n > count ? first + n : count);
    for (uint32_t i = 0; i < n; i++) {
        uint64_t epoch = bis_hash((first + i) >> 32);
        uint32_t index = (uint32_t)(first + i);
        u[i][0] = with_random_tail(reversed(scrambled(index, (uint32_t)(key2 ^ epoch))), bis_rng_u64(random));
        u[i][1] = scrambled_base3(index, depth, key3 ^ epoch, bis_rng_double(random));
    }
}

/* ---- stratified, random ---- */

/* Point i lies on the i-th of n equal parts of Hilbert's curve. It is random within the curve's last cell, which is
 * 2^-26 wide. */
static void stratified_points(bis_rng *random, uint32_t n, double (*u)[2])
{
    for (uint32_t i = 0; i < n; i++) {
        double t = bis_stratum(i, bis_rng_double(random), n);
        uint64_t tail = bis_rng_u64(random);
        bis_curve_hilbert(t, u[i]);
        u[i][0] += (double)(tail & 0x7ffffff) * 0x1p-53; /* 27 bits below 2^-26: the last of a double below 1 */
        u[i][1] += (double)(tail >> 32 & 0x7ffffff) * 0x1p-53;
    }
}

static void random_points(bis_rng *random, uint32_t n, double (*u)[2])
{
    for (uint32_t i = 0; i < n; i++) {
        u[i][0] = bis_rng_double(random);
        u[i][1] = bis_rng_double(random);
    }
}

/* ---- streams ---- */

/* Returns the divisor of n that is nearest to its square root from below. */
static uint64_t square_divisor(uint64_t n)
{
    uint64_t d = (uint64_t)sqrt((double)n);
    while (n % d) d--;
    return d;
}

void bis_sampler_set_spp(bis_sampler *s, uint64_t spp)
{
    s->spp = spp;
    s->ysamples = square_divisor(spp);
    s->xsamples = spp / s->ysamples;
}

void bis_stream_init(bis_stream *s, const bis_sampler *sampler, uint64_t pixel, uint64_t sample)
{
    *s = (bis_stream){.sampler = sampler, .pixel = pixel, .sample = sample};
    bis_rng_init(&s->rng, sampler->seed, pixel, sample, 0);
}

/* Returns the numbers that all samples of a pixel share in dimension pair dim, in `round` 0, 1, ... of spp samples
 * each. */
static bis_rng sequence_of(const bis_stream *s, unsigned dim, uint64_t round)
{
    bis_rng r;
    bis_rng_init(&r, s->sampler->seed, s->pixel, round, PURPOSE_SEQUENCE + dim);
    return r;
}

/* Returns this sample's place in the halton sequence of dim. Bases 2 and 3 have no common order of digits that could
 * be scrambled. Instead, the spp samples of a round take their places in an order of their own. */
static uint64_t halton_turn(const bis_stream *s, unsigned dim)
{
    uint64_t spp = s->sampler->spp, round = s->sample / spp, turn = s->sample % spp;
    if (dim == CAMERA_DIM) return s->sample;
    bis_rng order = sequence_of(s, dim, round);
    order.counter = 2; /* 0 and 1 belong to the scramblings */
    return round * spp + place_of(turn, spp, bis_rng_u64(&order));
}

void bis_stream_points(bis_stream *s, unsigned dim, uint32_t n, double (*u)[2])
{
    bis_rng sequence = sequence_of(s, dim, 0), random;
    bis_rng_init(&random, s->sampler->seed, s->pixel, s->sample, PURPOSE_SET + dim);
    switch (s->sampler->kind) {
    case BIS_SAMPLER_RANDOM: random_points(&random, n, u); break;
    case BIS_SAMPLER_STRATIFIED: stratified_points(&random, n, u); break;
    case BIS_SAMPLER_SOBOL:
        sobol_points(dim == CAMERA_DIM ? mirrored : scrambled, &sequence, &random, s->sample * n, n, u);
        break;
    case BIS_SAMPLER_HALTON:
        halton_points(&sequence, &random, halton_turn(s, dim) * n, s->sampler->spp * n, n, u);
        break;
    }
}

/* Stores a jittered point in one of xsamples x ysamples cells. Successive samples visit cells far apart, in an order
 * that is new in each round. */
static void stratified_camera(const bis_stream *s, double u[2])
{
    const bis_sampler *p = s->sampler;
    assert(p->xsamples * p->ysamples == p->spp);
    bis_rng order = sequence_of(s, CAMERA_DIM, s->sample / p->spp), random;
    double place[2] = {0.5, 0.5};
    uint64_t cell[2];

    cell_at(place_of(s->sample % p->spp, p->spp, bis_rng_u64(&order)), p->xsamples, p->ysamples, cell);
    bis_rng_init(&random, p->seed, s->pixel, s->sample, PURPOSE_CAMERA);
    if (p->jitter) random_points(&random, 1, &place);
    u[0] = ((double)cell[0] + place[0]) / (double)p->xsamples;
    u[1] = ((double)cell[1] + place[1]) / (double)p->ysamples;
    for (int i = 0; i < 2; i++)
        if (u[i] >= 1) u[i] = 1 - DBL_EPSILON / 2; /* cell + place may round up to the next cell */
}

void bis_stream_camera(bis_stream *s, double u[2])
{
    if (s->sampler->kind == BIS_SAMPLER_STRATIFIED) {
        stratified_camera(s, u);
        return;
    }
    double point[1][2];
    bis_stream_points(s, CAMERA_DIM, 1, point);
    u[0] = point[0][0];
    u[1] = point[0][1];
}

bool bis_sampler_is_low_discrepancy(bis_sampler_kind kind)
{
    return kind == BIS_SAMPLER_SOBOL || kind == BIS_SAMPLER_HALTON;
}

const char *bis_sampler_name(bis_sampler_kind kind)
{
    static const char *const names[] = {"random", "stratified", "sobol", "halton"};
    return names[kind];
}
