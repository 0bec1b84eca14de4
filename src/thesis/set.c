/* SPDX-License-Identifier: BSD-2-Clause */
/* set: weigh, choose, trace. Source: thesis 4.2 to 4.4.
 *
 * Weight. w = phat/q with phat = F.r + F.g + F.b and F = f cos Le. The printed weights w = f and w = L forget the
 * cosine and the true q_f (docs/errata.md E23).
 *
 * Unbiased. The density of each candidate is q (if stratified, the densities of the candidates average to q), so
 * E[(1/M) sum w V] is right. Resampling gives candidate i on average N w_i/W of the marks, whatever the scheme, so
 * E[(W/M) (1/N) sum V | candidates] = (1/M) sum w V. The float weights decide which candidates are traced, and the
 * estimate divides by these very weights, so rounding adds no bias but that of f and q themselves. */
#include "set.h"

#include "candidates.h"

#include <assert.h>
#include <float.h>

enum { BLOCK = BIS_LANES_BLOCK, CHUNK = 256 /* candidates whose f is kept at a time: 5 kB */ };

/* ---- weigh ---- */

/* [weigh] */
BIS_LANES
static void weigh(float *restrict w, float *restrict F_r, float *restrict F_g, float *restrict F_b,
                  const bis_lanes *candidates, const bis_reflected *reflected, float beta_map, float beta_f, uint32_t n)
{
    const bis_lanes x = *candidates;
    const bis_reflected f = *reflected;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        F_r[i] = f.r[i] * x.r[i];
        F_g[i] = f.g[i] * x.g[i];
        F_b[i] = f.b[i] * x.b[i];
        const float phat = f.cos[i] * (F_r[i] + F_g[i] + F_b[i]), q = beta_map * x.q[i] + beta_f * f.q[i];
        /* where q is 0, as at a black pixel outside the lobe, phat is 0, too */
        w[i] = bis_lanes_choose(f.cos[i] > 0, phat / bis_lanes_choose(q > 0, q, 1), 0);
    }
}
/* [end] */

/* f of a chunk at a time is kept, on the stack, because nobody asks for it again once F is known. The size is free:
 * `./bis scene.txt --integrator sir --candidates 8000 --spp 1 --resolution 160x120 --nthreads 1` took 3.9 s of user
 * time with 256, 4.0 with 1024, 3.9 with 8192 (the least of seven, on a busy machine). */
static void weigh_half(bis_set *set, const bis_half *half, const bis_point *pt)
{
    const float beta_map = (float)set->beta, beta_f = (float)(1 - set->beta);
    float memory[5][CHUNK];
    const bis_reflected f = {memory[0], memory[1], memory[2], memory[3], memory[4]};

    for (uint32_t i = 0; i < half->n; i += CHUNK) {
        const uint32_t n = half->n - i < CHUNK ? half->n - i : CHUNK, at = half->first + i;
        const bis_lanes y = bis_lanes_from(&half->x, i);
        set->unit_of_f = bis_bsdf_f_many(&f, &pt->bsdf, &y, n);
        weigh(set->choice.w + at, set->F[0] + at, set->F[1] + at, set->F[2] + at, &y, &f, beta_map, beta_f,
              bis_lanes_round_up(n));
    }
}

double bis_set_weigh(bis_set *set, const bis_point *pt)
{
    float *w = set->choice.w;

    weigh_half(set, &set->map, pt);
    /* Of a shared set of M directions as many are left out as the BRDF draws, evenly spread, so that the rest is, too:
     * their weight is 0, and no mark falls on them. */
    for (uint32_t j = 0; j < set->n_unused; j++) w[bis_one_of_set(j, set->n_unused, set->M, set->phase)] = 0;
    weigh_half(set, &set->brdf, pt);
    if (set->guide && set->guide->weigh) set->guide->weigh(set->guide, set);
    /* to the end of the last block: what only fills a block was given the radiance 0 and weighs nothing */
    set->W = bis_choice_sum(&set->choice, set->brdf.first + bis_lanes_round_up(set->brdf.n));
    return set->W / set->M * set->unit_of_f * set->unit_of_Le;
}

/* ---- F/phat ---- */

/* 1/sum of a denormal would be infinite: it is made a normal float first, by a power of two, which rounds nothing. */
static inline BIS_INLINE float lift_of(float sum) { return bis_lanes_choose(sum < FLT_MIN, 0x1p64f, 1); }

static inline BIS_INLINE float inverse_of(float sum) { return 1 / (bis_lanes_choose(sum > 0, sum, 1) * lift_of(sum)); }

BIS_LANES
static void make_shares(float *restrict r, float *restrict g, float *restrict b, uint32_t n)
{
#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float sum = r[i] + g[i] + b[i], lift = lift_of(sum), inverse = inverse_of(sum);
        r[i] = r[i] * lift * inverse;
        g[i] = g[i] * lift * inverse;
        b[i] = b[i] * lift * inverse;
    }
}

/* The lanes of a block are summed side by side, in an order that no width of vectors changes. Numbers are
 * size_t: the sum of two of 32 bits might begin again at 0, and the compiler would load each lane alone. */
static inline BIS_INLINE rgbd sum_shares(float *const F[3], const float *restrict w, const uint16_t *restrict part,
                                         const float *restrict factor, uint32_t n, const bool has_factor)
{
    const float *F_r = F[0], *F_g = F[1], *F_b = F[2];
    float r[BLOCK] = {0}, g[BLOCK] = {0}, b[BLOCK] = {0};
    rgbd sum = {0, 0, 0};

    for (size_t first = 0; first < n; first += BLOCK) {
        float v[BLOCK];
        for (size_t i = 0; i < BLOCK; i++) v[i] = has_factor ? w[first + i] * factor[part[first + i]] : w[first + i];
#pragma omp simd
        for (size_t i = 0; i < BLOCK; i++) {
            const float phat = F_r[first + i] + F_g[first + i] + F_b[first + i];
            const float lift = lift_of(phat), inverse = inverse_of(phat);
            r[i] += v[i] * (F_r[first + i] * lift * inverse);
            g[i] += v[i] * (F_g[first + i] * lift * inverse);
            b[i] += v[i] * (F_b[first + i] * lift * inverse);
        }
    }
    for (size_t i = 0; i < BLOCK; i++) sum = rgbd_add(sum, (rgbd){(double)r[i], (double)g[i], (double)b[i]});
    return sum;
}

BIS_LANES
static rgbd sum_all_shares(float *const F[3], const float *w, const uint16_t *part, const float *factor, uint32_t n)
{
    return factor ? sum_shares(F, w, part, factor, n, true) : sum_shares(F, w, NULL, NULL, n, false);
}

rgbd bis_shares_sum(const bis_set *set, uint32_t first, uint32_t n, const float *factor)
{
    float *const F[3] = {set->F[0] + first, set->F[1] + first, set->F[2] + first};

    return sum_all_shares(F, set->choice.w + first, set->part + first, factor, n);
}

rgbd bis_set_mean(const bis_set *set)
{
    const rgbd sum = bis_shares_sum(set, 0, set->choice.n, NULL);

    return rgbd_scale(sum, set->unit_of_f * set->unit_of_Le / set->M);
}

/* ---- choose ---- */

/* What was chosen, side by side, and its shares of F. Copied, because the few that are traced lie far apart among the
 * candidates, and the loops that follow (shares here, a guide's) are vectors only over neighbours. */
static void gather(bis_set *set)
{
    const uint32_t n = set->choice.n_chosen;
    const bis_traced y = set->y;

    assert(n <= y.room); /* of the candidates, at most N are traced */
    for (uint32_t j = 0; j < n; j++) {
        const uint32_t number = set->choice.item[j];
        uint32_t i;
        const bis_lanes *from_half = &bis_set_half(set, number, &i)->x;
        y.wi[j] = (vec3){from_half->x[i], from_half->y[i], from_half->z[i]};
        y.r[j] = set->F[0][number];
        y.g[j] = set->F[1][number];
        y.b[j] = set->F[2][number];
        y.h[j] = 1;
        y.seen[j] = NULL;
    }
    for (uint32_t j = n; j < bis_lanes_round_up(n); j++) y.r[j] = y.g[j] = y.b[j] = 0; /* of the last block */
    make_shares(y.r, y.g, y.b, bis_lanes_round_up(n));
    if (set->guide && set->guide->chosen) set->guide->chosen(set->guide, set);
}

void bis_set_choose(bis_set *set, uint32_t N, bis_resampling resampling, bis_stream *stream)
{
    if (resampling == BIS_RESAMPLING_MULTINOMIAL) bis_choose_multinomial(&set->choice, N, set->W, stream);
    /* mark: an offset that a guide has spread evenly over the camera samples of the pixel */
    else bis_choose_systematic(&set->choice, N, set->W, set->mark < 0 ? bis_stream_random(stream) : set->mark);
    gather(set);
}

void bis_set_take(bis_set *set, uint32_t n)
{
    set->choice.n_chosen = n;
    for (uint32_t j = 0; j < n; j++) set->choice.times[j] = 1;
    gather(set);
}

/* ---- trace ---- */

bool bis_set_has_control(const bis_set *set, const bis_point *pt)
{
    return set->guide && set->guide->has_control && set->guide->has_control(set->guide, set, pt);
}

rgbd bis_set_expected(const bis_set *set, double Z) { return set->guide->expected(set->guide, set, Z); }

/* [trace] */
rgbd bis_set_trace(rgbd L, const bis_set *set, const bis_point *pt, double Z)
{
    const bis_traced *y = &set->y;

    for (uint32_t j = 0; j < set->choice.n_chosen; j++) {
        const rgbd share = {(double)y->r[j], (double)y->g[j], (double)y->b[j]};
        /* times: one ray serves all marks of a candidate. h: what the choice was steered by is divided out again */
        const rgbd C = rgbd_scale(share, Z * set->choice.times[j] / (double)y->h[j]);
        bis_point_add(&L, pt, y->wi[j], C, y->seen[j]);
    }
    return L;
}
/* [end] */

/* ---- memory ---- */

void bis_set_claim(bis_set *set, const bis_needs *need, bis_claims *claims)
{
    const size_t M = bis_lanes_round_up(need->n_candidates), all = 2 * M; /* of a shared set all M, and of the BRDF M */
    const size_t most = need->n_traced < all ? need->n_traced : all, N = bis_lanes_round_up((uint32_t)most);
    /* own, to whose end a guide may add whole blocks, and brdf.x; u1, u2, stands_for; F; and four arrays of y: one
     * allocation, so that a set lies together */
    const size_t n = BIS_LANES_ARRAYS * (2 * M + BLOCK) + 3 * M + 3 * all + 4 * N;

    bis_choice_claim(&set->choice, (uint32_t)all, claims);
    set->pixel = bis_claim(claims, M, sizeof *set->pixel);
    set->part = bis_claim(claims, all, sizeof *set->part);
    set->y.wi = bis_claim(claims, N, sizeof *set->y.wi);
    set->y.seen = bis_claim(claims, N, sizeof *set->y.seen);
    set->y.room = (uint32_t)N;
    float *p = set->floats = bis_claim(claims, n, sizeof *set->floats);
    if (!p) return;
    set->own = bis_lanes_in(p, (uint32_t)M + BLOCK);
    set->brdf.x = bis_lanes_in(p += BIS_LANES_ARRAYS * (M + BLOCK), (uint32_t)M);
    set->u1 = p += BIS_LANES_ARRAYS * M;
    set->u2 = p += M;
    set->stands_for = p += M;
    p += M;
    for (int i = 0; i < 3; i++, p += all) set->F[i] = p;
    float **const traced[] = {&set->y.r, &set->y.g, &set->y.b, &set->y.h};
    for (int i = 0; i < 4; i++, p += N) *traced[i] = p;
}

void bis_set_clear(bis_set *set)
{
    bis_choice_clear(&set->choice);
    bis_free(set->pixel);
    bis_free(set->y.wi);
    bis_free(set->part);
    bis_free(set->y.seen);
    bis_free(set->floats);
    *set = (bis_set){.M = 0};
}
