/* SPDX-License-Identifier: BSD-2-Clause */
/* stage: one point of a scene for those who measure: what `bis pixel` tells, as numbers and arrays. The rules of
 * bis/flat/flat.h hold. bis/flat/taught.h has more functions of a stage; bis_flat_stage_at there chooses the pixel.
 * Where that sees no surface, all but bis_flat_stage_about and bis_flat_stage_angles are BIS_INPUT. seed is any number
 * of 64 bits. settings are name=value of an integrator and its parameters; unoccluded takes "proposal", too: em, brdf
 * or mix. */
#pragma once

#include "bis/flat/scene.h"
#include "bis/flat/taught.h"

/* bis_flat_stage_of makes a stage of an open scene, which must outlive it. light (may be NULL) takes the place of the
 * scene's; it is copied. A scene may have several stages, and be rendered meanwhile. Errors: BIS_NOMEM. */
int bis_flat_stage_of(bis_flat_stage **stage, const bis_flat_scene *scene, const bis_light *light, char *say,
                      size_t size);

/* bis_flat_stage_about returns in *text what is known of the scene and of the chosen pixel, as JSON: scene, light,
 * map_width, width, height, seed, sampler, x, y, hit (docs/live.md), uv, lobe, nothing, radiance, methods. It belongs
 * to the stage, until the next call. Errors: BIS_INPUT (no pixel was chosen), BIS_NOMEM. */
int bis_flat_stage_about(bis_flat_stage *stage, const char **text, char *say, size_t size);

/* bis_flat_stage_truth computes what eq. 4.1 is at the point, and eq. 4.5. value[4][4]: red, green, blue and their sum
 * of eq. 4.1, its standard errors, and both of eq. 4.5. moments[2][3]: variance and third central moment of F V/q for q
 * = q_L, q_f and their mean, where it is known by patches. count[3]: 1, or 0 where a long run of mis stands for the sum
 * over patches; patches; rays of the sum. Errors: BIS_NOMEM. */
int bis_flat_stage_truth(bis_flat_stage *stage, uint64_t seed, double *value, double *moments, uint64_t *count,
                         char *say, size_t size);

/* bis_flat_stage_method makes n >= 2 estimates L[n][3], and holds them against the truth that bis_flat_stage_truth has
 * computed last. value[2][4]: mean of red, green, blue and their sum; standard errors. figures[6]: z, skewness of the
 * mean, the same by the moments of the truth, relative error of one estimate, shadow rays and accepted candidates of
 * one; NaN: not known. *stop (may be NULL) ends the work soon if it is set, with the status BIS_INPUT. Errors:
 * BIS_INPUT (settings, n, the truth was not asked for), BIS_NOMEM. */
int bis_flat_stage_method(bis_flat_stage *stage, const char *const *settings, uint64_t seed, size_t n,
                          const volatile sig_atomic_t *stop, float *L, double *value, double *figures, char *say,
                          size_t size);

/* bis_flat_stage_estimate draws, weighs, chooses and traces as `sir` with these settings does in the first pass of a
 * render with this seed. Of each of M <= room candidates: wi[room][3], w[room], count[room][3] (1: from the map, 0:
 * from the BRDF; how often it was chosen; 1: it was chosen and sees the light). sum[17]: M, N, sum of the weights, sum
 * of their squares, effective sample size, the largest share of a candidate, beta (NaN: nothing has a weight),
 * candidates of the map, those with a weight, those that were chosen, choices that see the light, the estimate in red,
 * green and blue, and that of eq. 4.5. Errors: as bis_flat_stage_candidates. */
int bis_flat_stage_estimate(bis_flat_stage *stage, const char *const *settings, uint64_t seed, size_t room, float *wi,
                            double *w, uint32_t *count, double *sum, char *say, size_t size);

/* bis_flat_stage_rays makes the estimates that camera samples 0 to runs - 1 of the pixel are in a render with this
 * seed, and writes down their shadow rays: *n of them, of which the first `room` are stored. wi[room][3];
 * which[room][2]: the camera sample, and 1 where the ray reached the light. Errors: BIS_INPUT (settings, runs above
 * 2^20), BIS_NOMEM. */
int bis_flat_stage_rays(bis_flat_stage *stage, const char *const *settings, uint64_t seed, uint32_t runs, size_t room,
                        float *wi, uint32_t *which, size_t *n, char *say, size_t size);

/* bis_flat_stage_look stores for each direction wi[n][3] q_L (eq. 4.2), q_f (4.3) and phat = f cos Le, r+g+b (4.4), in
 * density[n][3]. A direction whose length is 1 but for the rounding of floats is taken as it is. Errors: BIS_INPUT (wi
 * is 0 or not finite). */
int bis_flat_stage_look(bis_flat_stage *stage, size_t n, const float *wi, double *density, char *say, size_t size);

/* bis_flat_stage_sees stores 1 in seen[n] where no surface hides the light in direction wi[n][3], else 0. Errors: as
 * bis_flat_stage_look. */
int bis_flat_stage_sees(bis_flat_stage *stage, size_t n, const float *wi, uint8_t *seen, char *say, size_t size);

/* bis_flat_stage_angles stores theta and phi of each direction wi[n][3] in the frame of the light, z up, in degrees:
 * angle[n][2]. Errors: BIS_INPUT (wi is not finite). */
int bis_flat_stage_angles(bis_flat_stage *stage, size_t n, const float *wi, double *angle, char *say, size_t size);

/* bis_flat_stage_sphere stores the mean over sub x sub directions in each cell of a lat-long field of directions in the
 * frame of the light, field[4][rows][columns]: q_L, f cos (r+g+b), f cos Le (r+g+b), and what is seen of the latter.
 * Errors: BIS_INPUT (columns or rows outside [1, 4096], sub outside [1, 64]). */
int bis_flat_stage_sphere(bis_flat_stage *stage, int columns, int rows, int sub, float *field, char *say, size_t size);
