/* SPDX-License-Identifier: BSD-2-Clause */
/* replay: what the drawn directions give.
 *
 * A mean with the right noise can be had without a sample, by one integral. But the handout says how directions are
 * drawn, and the points of a stream depend on seed, run and dimension alone: so each estimate is determined, to
 * rounding. The judge makes it, too, and asks for it to 1e-4 of the mean.
 *
 * Graded, it makes 200 estimates by our own integrator, which is in the judge's program alone, under a light, a
 * material, a normal, an eye and a shadow that the secret changes. In a kit that integrator is the student's: there
 * stand 12 recorded values of r + g + b, under the kit's seed, which BIS_RECORD=1 prints. */
#ifndef TESTS_REPLAY_H
#define TESTS_REPLAY_H

#include "mark.h"

enum { REPLAY_RUNS = 200, REPLAY_KIT = 12 };

typedef struct replay {
    ask_scene scene;
    uint32_t n; /* that are looked at: the runs `run` of those that were asked for */
    uint64_t run[REPLAY_RUNS];
    ask_estimate mine[REPLAY_RUNS], must[REPLAY_RUNS];
    bool knows_sum_only, knows_rays; /* of must */
} replay;

/* replay_freshen makes it another light, material, normal, eye and shadow of the same kind, where there is a secret. */
void replay_freshen(ask_scene *scene);

/* replay_ask asks for `runs` estimates of a scene, and makes some of them by `ours`, or takes the recorded ones (NULL:
 * none). Where the runs are more than are looked at, nobody knows before which these are. */
void replay_ask(replay *r, const ask_scene *scene, const bis_integrator *ours, uint32_t runs,
                const double recorded[REPLAY_KIT]);

/* replay_by makes the same runs by an integrator that is given in every kit, with so many samples. */
void replay_by(ask_estimate made[REPLAY_RUNS], const replay *r, const bis_integrator *given, uint32_t samples);

/* replay_is_near returns whether estimate k is `must`, to 1e-4 of the mean of all or of itself. */
bool replay_is_near(const replay *r, uint32_t k, rgb must);

/* replay_first_wrong returns the first estimate that is not what it must be, or r->n. One in a hundred may be another
 * one, where rounding decides who is chosen. */
uint32_t replay_first_wrong(const replay *r);

/* replay_check ends the claim if there is one, and says how it differs: in its rays, by a factor that all have, or
 * else. drawn: what draws the directions, as in "em.c". */
void replay_check(const replay *r, const char *what, const char *drawn, const char *hint);

#endif
