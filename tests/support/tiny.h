/* SPDX-License-Identifier: BSD-2-Clause */
/* tiny: a point under a map of 8 pixels whose every estimate can be enumerated.
 *
 * The map has 4 x 2 pixels: the octants of the sphere. The BRDF is a model of its own, such that f cos is constant in
 * each octant, above the horizon; it draws an octant with given probabilities and a direction uniform in it. A
 * candidate then is in one of 9 states, with one weight each: above the horizon in octant 0 ... 7, or worth nothing
 * (TINY_NOTHING: below the horizon, or a black octant). What an estimator does with M candidates is a sum over 9^M
 * cases: its mean, its variance, the law of its rays, exactly. The normal is oblique: the horizon cuts most octants. */
#ifndef TESTS_TINY_H
#define TESTS_TINY_H

#include "bis/scene/parameters.h"
#include "bis/thesis/integrator.h"
#include "stat.h"

enum { TINY_PIXELS = 8, TINY_NOTHING = 8, TINY_STATES = 9, TINY_MAX_M = 17 };

/* f cos of each octant, in RGB; the probability with which the BRDF draws it. The bis_material comes first: a bsdf
 * points to that. */
typedef struct tiny_material {
    bis_material material;
    rgb f_cos[TINY_PIXELS];
    double pick[TINY_PIXELS];
} tiny_material;

/* Hides some of the octants, and counts the rays. */
typedef struct tiny_accel {
    bis_accel accel;
    bool hidden[TINY_PIXELS];
    double *rays; /* [TINY_PIXELS] */
} tiny_accel;

typedef struct tiny {
    bis_light *light;
    tiny_material material;
    tiny_accel accel;
    double rays[TINY_PIXELS];
    bis_counters counters;
    bis_point pt;
    double above[TINY_PIXELS]; /* the part of each octant above the horizon, by quadrature */
    double p_em[TINY_PIXELS];  /* L dOmega / sum: the probabilities of the pixels */
    int place[TINY_PIXELS];    /* pixels in the order of the light's curve */
} tiny;

/* t must stay where it is. tiny_clear it. */
void tiny_init(tiny *t);
void tiny_clear(tiny *t);

int tiny_pixel(vec3 w);

/* M candidates as a proposal draws them: P[i][k] is the probability that candidate i is in state k, C[k] what it is
 * worth then, F/q in RGB. */
typedef struct tiny_candidates {
    uint32_t M;
    double P[TINY_MAX_M][TINY_STATES];
    rgbd C[TINY_STATES];
} tiny_candidates;

/* stratify: for proposal em alone. A mix is told from what it does: the weights of what it draws give beta. */
tiny_candidates tiny_enumerate(tiny *t, bis_proposal proposal, bool stratify, uint32_t M);

/* Reflected radiance: with and without V. */
rgbd tiny_truth(const tiny *t, bool with_V);

/* Sum over all tuples of M <= 3 states: visit(states, probability, data). */
typedef void tiny_visit(const int state[TINY_MAX_M], double probability, void *data);
void tiny_for_all(const tiny_candidates *c, tiny_visit *visit, void *data);

/* One estimate with random numbers of (seed, run). */
rgb tiny_once(tiny *t, const bis_settings *s, bis_scratch *scratch, uint64_t seed, uint64_t run);

#endif
