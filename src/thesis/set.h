/* SPDX-License-Identifier: BSD-2-Clause */
/* set: the M candidates of thesis 4.3 and 4.4, and the four verbs that sir, rejection and unoccluded are made of:
 *
 *     draw      x_i ~ q                                            i <= M
 *     weigh     w_i = phat(x_i)/q(x_i),  Zhat = (1/M) sum w_i      phat = F.r + F.g + F.b,  F = f cos Le
 *     choose    y_j = x_i with probability w_i/sum w               j <= N
 *     trace     Z sum_j F(y_j)/phat(y_j) V(y_j)
 *
 * The candidates lie side by side: an array for each number of a candidate. So a loop over i becomes vectors
 * (bis/thesis/lanes.h), and 800 candidates take 1 us instead of 20. Numbers are floats, in units that keep any map and
 * any material within a float's range: radiance is over the light's mean, f over the material's unit.
 *
 * A renderer may know more than the thesis: sets of directions that many points share (bis_sets), where the product can
 * be large, and what earlier rays say of V (bis_guide). Without it all verbs are the thesis's own. */
#pragma once

#include "candidates.h"
#include "choose.h"

#include "bis/thesis/integrator.h"

typedef struct bis_set bis_set;

/* Candidates of one kind, from the map or from the BRDF. x: directions, radiance, and q_map, the density with which
 * they would be drawn from the map: q_L, that of its importance, or a guide's. Candidate i of them is number first + i
 * of the set. first is a multiple of a block. */
typedef struct bis_half {
    bis_lanes x;
    uint32_t n, first;
} bis_half;

/* The y_j that are traced. The share of each channel, F/phat, is in r, g, b: together 1, or 0 where F is 0. */
typedef struct bis_traced {
    vec3 *wi;
    float *r, *g, *b;
    float *h;        /* [N]: what w was multiplied by beyond phat/q; 1 without a guide */
    uint16_t **seen; /* [N]: what grows by 1 if light arrives, or NULL */
    uint32_t room;   /* N, rounded up to whole blocks */
} bis_traced;

struct bis_set {
    /* ---- draw: x_i ~ q ---- */
    uint32_t M;
    double beta;              /* q = beta q_map + (1 - beta) q_f for every candidate (docs/errata.md E26) */
    bis_half map, brdf;
    bis_lanes own;            /* room for candidates from the map that this point alone draws */
    float *u1, *u2;           /* the points by which the BRDF draws */
    const bis_sets *sets;     /* borrowed, as in bis_scratch. Of a shared set of M directions */
    uint32_t n_unused, phase; /* n_unused are not used: evenly spread from a random phase. Their weight is 0 */

    /* ---- weigh: w_i = phat/q ---- */
    float *F[3];              /* F over its unit and the cosine, f Le, of all candidates */
    bis_choice choice;        /* w_i of all candidates, and which were chosen */
    double unit_of_f, unit_of_Le, W; /* w is in units of both; W is the sum of the w */

    /* ---- choose and trace: y_j ---- */
    double mark;              /* the offset of systematic marks; < 0: choose draws it */
    bis_traced y;

    /* ---- for the steps of a guide ---- */
    struct bis_guide *guide;  /* borrowed; NULL: all steps are the thesis's own */
    uint32_t *pixel;          /* the pixel of the map in which a BRDF's candidate lies */
    uint16_t *part;           /* the part of the map to which each candidate belongs */
    float *stands_for;        /* how many candidates of the map each stands for */

    float *floats;            /* what holds most of the arrays */
};

/* What is known beyond the thesis. A function that is NULL leaves the thesis's own step as it is. All estimates stay
 * unbiased, because each step says with which density, or with which factor, it was done. */
typedef struct bis_guide bis_guide;
struct bis_guide {
    /* divide says how many of the M candidates of proposal "product" the BRDF draws; NULL: as many as of "mix" */
    bis_mixture (*divide)(const bis_guide *guide, uint32_t M, const bis_point *pt);
    /* draw puts n candidates from the map into set->map, with their density in q. false: the map sends nothing that can
     * be reflected at pt. density puts the density of such a draw into q of set->brdf */
    bool (*draw)(bis_guide *guide, bis_set *set, uint32_t n, const bis_point *pt, bis_stream *stream);
    void (*density)(bis_guide *guide, bis_set *set);
    /* weigh multiplies each weight by h > 0, and by what a candidate stands for; chosen stores h and seen of what was
     * chosen */
    void (*weigh)(bis_guide *guide, bis_set *set);
    void (*chosen)(bis_guide *guide, bis_set *set);
    /* rays returns how many of the candidates are to be chosen where the settings say N: at most BIS_MORE_RAYS N. It
     * may ask the candidates and what was known before, but not the marks by which they are chosen */
    uint32_t (*rays)(const bis_guide *guide, const bis_set *set, const bis_point *pt, uint32_t N);
    /* has_control returns whether V's mean g is known and worth its time; expected then returns
     * (1/M) sum_i F/q g - Z sum_j F/(phat h) g, whose mean is 0 (sir.c) */
    bool (*has_control)(const bis_guide *guide, const bis_set *set, const bis_point *pt);
    rgbd (*expected)(const bis_guide *guide, const bis_set *set, double Z);
    bool learns; /* rays that are traced now are counted, so that later points know more of V */
};

enum { BIS_MORE_RAYS = 3 }; /* times N: of 64 candidates, 3 x 24 marks choose nearly all */

/* bis_set_claim allocates what the needs of an integrator ask for, as claims say (bis/base/mem.h). */
void bis_set_claim(bis_set *set, const bis_needs *need, bis_claims *claims);

/* bis_set_clear frees the arrays. */
void bis_set_clear(bis_set *set);

/* bis_set_draw draws M candidates from a proposal. With `stratify` they are evenly spread, in the order of a
 * space-filling curve (candidates.c); without, they are independent. Returns false if there is no light or nothing can
 * be reflected; the estimate is then 0. */
bool bis_set_draw(bis_set *set, uint32_t M, bis_proposal proposal, bool stratify, const bis_point *pt,
                  bis_stream *stream);

/* bis_set_weigh weighs them: w_i = phat/q (eq. 4.8, eq. 4.9), times h with a guide. Returns Zhat = (1/M) sum w_i.
 * Without a guide it estimates the sum of L_ns (eq. 4.5) over its channels. */
double bis_set_weigh(bis_set *set, const bis_point *pt);

/* bis_set_weight returns w of the candidate with number i, in the unit of Zhat. It is 0 for the numbers that only fill
 * a block. i < set->choice.n. */
static inline double bis_set_weight(const bis_set *set, uint32_t i)
{
    return (double)set->choice.w[i] * set->unit_of_f * set->unit_of_Le;
}

/* bis_set_mean returns (1/M) sum_i F(x_i)/q(x_i): L_ns of eq. 4.5 in RGB. With a guide each term is times h. */
rgbd bis_set_mean(const bis_set *set);

/* bis_set_rays returns N, or with a guide how many candidates it wants chosen in the place of N. */
static inline uint32_t bis_set_rays(const bis_set *set, const bis_point *pt, uint32_t N)
{
    return set->guide && set->guide->rays ? set->guide->rays(set->guide, set, pt, N) : N;
}

/* bis_set_choose chooses N candidates with probabilities w_i/sum w. Zhat must be > 0. */
void bis_set_choose(bis_set *set, uint32_t N, bis_resampling resampling, bis_stream *stream);

/* bis_set_take takes the candidates that set->choice.item[n] names, once each, in the place of bis_set_choose. Their
 * weights must be > 0, and n at most the number of candidates that its needs say are traced. For rejection. */
void bis_set_take(bis_set *set, uint32_t n);

/* bis_set_has_control returns whether a guide knows the mean of V; bis_set_expected then returns what it is worth, see
 * bis_guide. */
bool bis_set_has_control(const bis_set *set, const bis_point *pt);
rgbd bis_set_expected(const bis_set *set, double Z);

/* bis_set_trace returns L + Z sum_j F(y_j)/(phat(y_j) h_j) V(y_j) over what was chosen: eq. 4.6 in RGB
 * (docs/errata.md E6), with Z for L_ns/N. A candidate that got several marks is traced once. */
rgbd bis_set_trace(rgbd L, const bis_set *set, const bis_point *pt, double Z);

/* bis_set_half returns the half in which the candidate with number i is, and stores its place there in *at. */
static inline const bis_half *bis_set_half(const bis_set *set, uint32_t i, uint32_t *at)
{
    const bis_half *half = i < set->brdf.first ? &set->map : &set->brdf;

    *at = i - half->first;
    return half;
}

/* bis_shares_sum returns the sum over i of w[i] factor[i] F(x_i)/phat(x_i) for n candidates from number `first` on.
 * factor[i] is 1, or factor[part[i]] if factor is not NULL. first and n are whole blocks. */
rgbd bis_shares_sum(const bis_set *set, uint32_t first, uint32_t n, const float *factor);
