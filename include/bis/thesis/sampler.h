/* sampler: where the numbers in [0,1) of a pixel come from (thesis 3.3: "low-discrepancy sequence such as Halton").
 *
 * A bis_sampler says which point set; a bis_stream is one camera sample of one pixel, positioned in it. An integrator
 * asks the stream for sets of points, one set per dimension pair, and for plain random numbers. Sets of different
 * dimensions and pixels are scrambled independently (Owen scrambling by hashing, Laine and Karras 2011, Burley 2020).
 * Every point is uniform in [0,1)^2 by itself, whatever the kind: all estimators stay unbiased. The kinds differ in how
 * evenly the points of one set, and of the successive camera samples of one pixel, fill the square. */
#ifndef BIS_SAMPLER_H
#define BIS_SAMPLER_H

#include "bis/thesis/rng.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum bis_sampler_kind {
    BIS_SAMPLER_RANDOM,     /* independent */
    BIS_SAMPLER_STRATIFIED, /* camera: xsamples x ysamples jittered cells; sets: one point in each of n cells along Hilbert's curve */
    BIS_SAMPLER_SOBOL,      /* the first two dimensions of Sobol's sequence, a (0,2)-sequence, Owen-scrambled */
    BIS_SAMPLER_HALTON      /* bases 2 and 3, Owen-scrambled */
} bis_sampler_kind;

typedef struct bis_sampler {
    bis_sampler_kind kind;
    uint64_t seed;
    uint64_t spp;                /* camera samples per pixel; > 0. 64 bits: on outlines, up to 1024 times the scene's */
    uint64_t xsamples, ysamples; /* stratified: xsamples * ysamples = spp */
    bool jitter;                 /* stratified: false puts camera points in the middle of their cells */
} bis_sampler;

/* One camera sample of one pixel. Transparent: a test may forge one. */
typedef struct bis_stream {
    const bis_sampler *sampler;
    uint64_t pixel;  /* y * width + x of the full image */
    uint64_t sample; /* 0, 1, 2, ...; at spp and beyond the point set goes on (stratified: a fresh set of cells) */
    bis_rng rng;     /* plain random numbers of this sample */
} bis_stream;

/* spp >= 1 camera samples a pixel; stratified ones in the most square xsamples x ysamples = spp. */
void bis_sampler_set_spp(bis_sampler *s, uint64_t spp);

void bis_stream_init(bis_stream *s, const bis_sampler *sampler, uint64_t pixel, uint64_t sample);

/* The camera sample's place in its pixel, uniform in [0,1)^2. */
void bis_stream_camera(bis_stream *s, double u[2]);

/* n points of dimension pair `dim` (0, 1, ...; the integrator numbers its own): u[n][2]. Over the camera samples of a
 * pixel the sets of one dim continue each other (sobol, halton: points sample*n ... sample*n+n-1 of one sequence, which
 * each dim visits in an order of its own, or the pairs of two dims would lie on a line; 53 bits each, the lowest
 * random). stratified: in the order of Hilbert's curve, one point in each n-th of it. */
void bis_stream_points(bis_stream *s, unsigned dim, uint32_t n, double (*u)[2]);

/* The next plain random number in [0,1). */
static inline double bis_stream_random(bis_stream *s) { return bis_rng_double(&s->rng); }

/* True for sobol and halton: the EM's sampler then defaults to "cdf" (docs/errata.md E12). */
bool bis_sampler_is_low_discrepancy(bis_sampler_kind kind);

/* "random", "stratified", "sobol", "halton". */
const char *bis_sampler_name(bis_sampler_kind kind);

#endif
