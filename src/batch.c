/* batch: sampling-importance resampling (sir.c, thesis 4.4) with all candidates of a point side by side.
 *
 * The estimator is that of sir.c and candidates.c, step by step: a set of the pool, weights, N marks over their running sum, rays. What differs is how
 * the numbers lie in memory (bis/lanes.h), and that a candidate is a weight of 4 bytes until it is chosen. M = 800 from a pool take 1 us instead of
 * 20, 50 of them from the BRDF another microsecond instead of 9.
 *
 * Unbiased as sir.c is: the float weights decide which candidates are traced, and the estimate divides by these very weights. With Zhat = W/M,
 *     L = (Zhat/N) sum_j F/phat V,
 * where F/phat is a candidate's colour: neither q nor the cosine is needed again.
 * The running sum goes over blocks of 16, then over the 16: what a block's 16 add up to may differ from the block's own sum by 2^-22 of it, by which the
 * chance of the block's last candidate is off. */
#include "batch.h"

#include "candidates.h"
#include "resample.h"

#include "bis/mem.h"

#include <assert.h>

enum { SMALLEST = BIS_LANES_BLOCK, BLOCK = BIS_LANES_BLOCK };

struct bis_batch {
    uint32_t M, N;
    float *w;        /* w[2 M]: the set's weights, then those of the BRDF's candidates; each part whole blocks */
    float *block;    /* block[]: sums of 16 of w */
    bis_lanes brdf;  /* candidates from the BRDF, M at most */
    float *u1, *u2;
    uint32_t *pixel;
    uint32_t *chosen, *times; /* [N]: a lane, how often it was chosen */
    bis_lanes traced;         /* [N] */
    vec3 *wi;
    bool *sees;
    float *floats;            /* what holds all the float arrays */
};

/* ---- workspace ---- */

bool bis_batch_wanted(const bis_settings *s)
{
    return s->vectorize && !s->as_printed && s->candidates >= SMALLEST && bis_candidates_pool_needs(s) > 0;
}

/* Floats for w, block, brdf, u1, u2, pixel, traced. */
static size_t floats_needed(uint32_t M, uint32_t N)
{
    const size_t m = bis_lanes_round_up(M), n = bis_lanes_round_up(N);

    return 2 * m + bis_lanes_round_up(bis_lanes_blocks((uint32_t)(2 * m))) + BIS_LANES_ARRAYS * m + 3 * m + BIS_LANES_ARRAYS * n;
}

size_t bis_batch_bytes(uint32_t M, uint32_t N)
{
    return sizeof(bis_batch) + floats_needed(M, N) * sizeof(float) + N * (2 * sizeof(uint32_t) + sizeof(vec3) + sizeof(bool));
}

bis_batch *bis_batch_new(uint32_t M, uint32_t N)
{
    const uint32_t m = bis_lanes_round_up(M), n = bis_lanes_round_up(N);
    bis_batch *b = bis_alloc(1, sizeof *b);

    if (!b) return NULL;
    *b = (bis_batch){.M = M, .N = N};
    b->floats = bis_alloc(floats_needed(M, N), sizeof *b->floats);
    b->chosen = bis_alloc(N, sizeof *b->chosen);
    b->times = bis_alloc(N, sizeof *b->times);
    b->wi = bis_alloc(N, sizeof *b->wi);
    b->sees = bis_alloc(N, sizeof *b->sees);
    b->pixel = bis_alloc(m, sizeof *b->pixel);
    if (!b->floats || !b->chosen || !b->times || !b->wi || !b->sees || !b->pixel) {
        bis_batch_free(b);
        return NULL;
    }
    float *next = b->floats;
    b->w = next, next += 2 * m;
    b->block = next, next += bis_lanes_round_up(bis_lanes_blocks(2 * m));
    b->u1 = next, next += m;
    b->u2 = next, next += m;
    b->brdf = bis_lanes_in(next, m), next += BIS_LANES_ARRAYS * (size_t)m;
    b->traced = bis_lanes_in(next, n);
    return b;
}

void bis_batch_free(bis_batch *b)
{
    if (!b) return;
    bis_free(b->floats);
    bis_free(b->chosen);
    bis_free(b->times);
    bis_free(b->wi);
    bis_free(b->sees);
    bis_free(b->pixel);
    bis_free(b);
}

bool bis_batch_fits(const bis_point *pt, const bis_scratch *scratch)
{
    return scratch->batch && scratch->pool && scratch->pool->lanes && pt->bsdf.material->model->lanes;
}

/* ---- candidates ---- */

/* The set's weights. Where the BRDF takes n_brdf of the M, so many of the set, evenly spread, are left out. Returns the unit of the weights. */
static double weigh_set(bis_batch *b, const bis_lanes *set, const bis_mixture *m, uint32_t phase, const bis_point *pt)
{
    const uint32_t M = m->n_em + m->n_brdf;
    const double unit = pt->bsdf.material->model->lanes->weigh(b->w, &pt->bsdf, set, M, m->beta);

    for (uint32_t j = 0; j < m->n_brdf; j++) b->w[bis_one_of_set(j, m->n_brdf, M, phase)] = 0;
    return unit;
}

static void weigh_brdf(bis_batch *b, float *w, const bis_mixture *m, const bis_point *pt, bis_stream *stream)
{
    const bis_bsdf_lanes *lanes = pt->bsdf.material->model->lanes;

    bis_lanes_points(b->u1, b->u2, m->n_brdf, bis_rng_u64(&stream->rng));
    lanes->sample(&b->brdf, &pt->bsdf, b->u1, b->u2, m->n_brdf);
    bis_light_look(pt->light, &b->brdf, b->pixel, m->n_brdf);
    lanes->weigh(w, &pt->bsdf, &b->brdf, m->n_brdf, m->beta);
}

/* block[k] = the sum of w[16 k], ..., always in the same order, whatever the width of a vector. */
BIS_LANES
static void sum_blocks(float *restrict block, const float *restrict w, uint32_t n_blocks)
{
    for (uint32_t k = 0; k < n_blocks; k++) {
        const float *v = w + BLOCK * (size_t)k;
        float a[8], c[4];

        for (int i = 0; i < 8; i++) a[i] = v[i] + v[i + 8];
        for (int i = 0; i < 4; i++) c[i] = a[i] + a[i + 4];
        block[k] = (c[0] + c[2]) + (c[1] + c[3]);
    }
}

static double sum(const float *block, uint32_t n_blocks)
{
    double W = 0;

    for (uint32_t k = 0; k < n_blocks; k++) W += (double)block[k];
    return W;
}

/* ---- resampling ---- */

/* One more mark on lane i; n lanes have been chosen so far. Returns how many there are then. */
static uint32_t choose(bis_batch *b, uint32_t n, uint32_t i)
{
    if (n && b->chosen[n - 1] == i) {
        b->times[n - 1]++;
        return n;
    }
    b->chosen[n] = i;
    b->times[n] = 1;
    return n + 1;
}

/* The lanes that N marks fall on, each once, with the number of its marks; returns how many they are. As bis_candidates_resample, but
 * blocks without a mark are passed over as a whole. What rounding leaves beyond the end of a block, or of all, belongs to the last positive lane before. */
static uint32_t resample(bis_batch *b, uint32_t N, uint32_t n_blocks, double W, bis_resampling resampling, bis_stream *stream)
{
    bis_marks marks = bis_marks_start(resampling, N, stream);
    double mark = bis_marks_next(&marks, stream) * W, S = 0;
    uint32_t n = 0, used = 0, lane = 0;

    for (uint32_t k = 0; k < n_blocks; k++) {
        const double end = S + (double)b->block[k];
        uint32_t next = BLOCK * k;

        while (mark < end) {
            for (; S <= mark && next < BLOCK * (k + 1); next++) {
                if (b->w[next] <= 0) continue;
                S += (double)b->w[next];
                lane = next;
            }
            n = choose(b, n, lane);
            if (++used == N) return n;
            mark = bis_marks_next(&marks, stream) * W;
        }
        S = end;
    }
    for (; used < N; used++) n = choose(b, n, lane);
    return n;
}

/* ---- rays ---- */

static void copy_lane(const bis_lanes *to, uint32_t k, const bis_lanes *from, uint32_t i)
{
    to->x[k] = from->x[i];
    to->y[k] = from->y[i];
    to->z[k] = from->z[i];
    to->r[k] = from->r[i];
    to->g[k] = from->g[i];
    to->b[k] = from->b[i];
}

/* The n chosen lanes side by side: lanes below `first_brdf` are the set's, the others the BRDF's. */
static void gather(bis_batch *b, uint32_t n, const bis_lanes *set, uint32_t first_brdf)
{
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = b->chosen[k];
        const bool brdf = i >= first_brdf;
        copy_lane(&b->traced, k, brdf ? &b->brdf : set, brdf ? i - first_brdf : i);
        b->wi[k] = (vec3){b->traced.x[k], b->traced.y[k], b->traced.z[k]};
    }
    for (uint32_t k = n; k < bis_lanes_round_up(n); k++) b->traced.r[k] = b->traced.g[k] = b->traced.b[k] = 0;
}

/* The sum of F/phat V over the marks. */
static rgbd trace(bis_batch *b, uint32_t n, const bis_point *pt)
{
    rgbd sum = {0, 0, 0};

    pt->bsdf.material->model->lanes->colour(&pt->bsdf, &b->traced, n);
    bis_point_sees_many(pt, b->wi, n, b->sees);
    for (uint32_t k = 0; k < n; k++) {
        if (!b->sees[k]) continue;
        const rgbd colour = {(double)b->traced.r[k], (double)b->traced.g[k], (double)b->traced.b[k]};
        sum = rgbd_add(sum, rgbd_scale(colour, b->times[k]));
    }
    return sum;
}

rgb bis_batch_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    bis_batch *b = scratch->batch;
    const uint32_t M = s->candidates, N = s->shadowrays;
    const bis_mixture m = bis_candidates_divide(M, s->proposal, pt, stream);
    const bis_lanes set = bis_pool_lanes(scratch->pool, bis_pool_choose(scratch->pool, &stream->rng));
    const uint32_t phase = (uint32_t)(bis_rng_u64(&stream->rng) >> 32), first_brdf = bis_lanes_round_up(M);
    const uint32_t n_blocks = bis_lanes_blocks(M) + bis_lanes_blocks(m.n_brdf);

    pt->counters->candidates += M;
    const double unit = weigh_set(b, &set, &m, phase, pt);
    if (m.n_brdf) weigh_brdf(b, b->w + first_brdf, &m, pt, stream);
    sum_blocks(b->block, b->w, n_blocks);
    const double W = sum(b->block, n_blocks);
    assert(isfinite(W));
    if (W <= 0) return (rgb){0, 0, 0};

    const uint32_t n = resample(b, N, n_blocks, W, s->resampling, stream);
    gather(b, n, &set, first_brdf);
    const double Zhat = W / M * unit * bis_light_mean(pt->light);
    return rgbd_round(rgbd_scale(trace(b, n, pt), Zhat / N));
}
