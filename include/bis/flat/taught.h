/* SPDX-License-Identifier: BSD-2-Clause */
/* taught: the steps of the thesis one by one, on arrays, for the figures that live (docs/live.md). The rules of
 * bis/flat/flat.h hold: numbers, arrays and text, statuses, say[size]. */
#pragma once

#include "bis/flat/flat.h"
#include "bis/flat/map.h"

/* ---- numbers, hashes ---- */

/* bis_flat_fnv continues the FNV-1a hash[2] (low half, high half) by bytes[n]. It begins with {0, 0}, which stands for
 * the offset basis. It does nothing where hash is NULL, or bytes is and n is not 0. */
void bis_flat_fnv(uint32_t hash[2], size_t n, const uint8_t *bytes);

/* bis_flat_uniform stores u[n] of the stream (seed, stream), uniform in [0,1). */
void bis_flat_uniform(uint32_t seed, uint32_t stream, size_t n, double *u);

/* bis_flat_points stores points u[n][2] of one camera sample of a pixel, by a sampler of this kind: "random",
 * "stratified", "sobol" or "halton". dim is the pair of dimensions, as an integrator numbers its own; UINT32_MAX: the
 * places in the pixel of camera samples `sample` to sample + n - 1. spp is how many the pixel has. Errors: BIS_INPUT
 * (kind, spp is 0, dim from 2^31 - 1 on, n above 2^32 - 1). */
int bis_flat_points(const char *kind, uint64_t seed, uint32_t pixel, uint32_t sample, uint32_t spp, uint32_t dim,
                    size_t n, double *u, char *say, size_t size);

/* bis_flat_histogram counts values[n] in equal cells from 0 to most times *unit: count[cells]. What lies below falls
 * into the first cell, what lies above into the last one, as all does where *unit is 0. Errors: BIS_INPUT (no cell, a
 * value that is no number, *unit or most negative or not finite). */
int bis_flat_histogram(size_t n, const double *values, const double *unit, double most, size_t cells, uint32_t *count,
                       char *say, size_t size);

/* So many rows have room in the arrays of bis_flat_bits. */
enum { BIS_FLAT_BITS = 16 };

/* bis_flat_bits computes the rows of `bis verify --bits`, *n of them. hash[n][2] and expected[n][2] are low and high
 * half; name[n][64] ends with 0. Errors: BIS_NOMEM. */
int bis_flat_bits(uint32_t *hash, uint32_t *expected, uint8_t *name, uint32_t *n, char *say, size_t size);

/* ---- thesis 3.2: discrete distributions ---- */

/* bis_flat_marsaglia makes Marsaglia's list of integer weights w[n]: list[room], of which *length are used. Errors:
 * BIS_INPUT (longer than room; weights that flat's other tables refuse), BIS_NOMEM. */
int bis_flat_marsaglia(size_t n, const uint32_t *w, size_t room, uint32_t *list, uint32_t *length, char *say,
                       size_t size);

/* bis_flat_alias_stage shows how Vose's table of w[n] fills. order[n] receives the bins in an order in which they
 * can be filled: each after those that it gives to. height[n] receives how high each item's own part stands after
 * the first `steps` of them, 1 being full: N P_i at first, prob[i] in the end. Errors: BIS_INPUT (as
 * bis_flat_alias_sample). */
int bis_flat_alias_stage(size_t n, const double *w, size_t steps, uint32_t *order, double *height, char *say,
                         size_t size);

/* bis_flat_alias_pmf stores the probabilities pmf[n] that tables of w[n] really give, and in P[n] those of the weights.
 * Errors: as bis_flat_alias_build. */
int bis_flat_alias_pmf(size_t n, const double *w, double *pmf, double *P, char *say, size_t size);

/* bis_flat_alias_few_bits draws by every number u of so few bits, 0 to 24 of them, from the table of w[n]: printed[n]
 * receives each item's share of the draws by appendix A's test as printed, u - i > prob (docs/errata.md E14), and
 * right[n] that by bis_alias_sample. impossible[2] is the share of items of weight 0 among the draws that fall into
 * their bins, as printed and right. Errors: BIS_INPUT (bits; as bis_flat_alias_build), BIS_NOMEM. */
int bis_flat_alias_few_bits(size_t n, const double *w, int bits, double *printed, double *right, double *impossible,
                            char *say, size_t size);

/* bis_flat_cdf_build stores the CDF c[n + 1] of the weights w[n] and its guide table guide[*n_guide + 1], which has
 * room for 2 n + 2. Errors: as bis_flat_alias_build. */
int bis_flat_cdf_build(size_t n, const double *w, double *c, uint32_t *guide, uint32_t *n_guide, char *say,
                       size_t size);

/* bis_flat_cdf_sample draws item[m] from u[m] by inverting the CDF of w[n]. part[m] receives the part of the guide
 * table that u lies in, and first[m] the item at which the search begins. Errors: as bis_flat_alias_sample. */
int bis_flat_cdf_sample(size_t n, const double *w, size_t m, const double *u, uint32_t *item, uint32_t *part,
                        uint32_t *first, char *say, size_t size);

/* bis_flat_fit counts m draws item[m] in observed[n] and holds them against the probabilities P[n] by Pearson's
 * chi-square: fit[3] is the statistic, its degrees of freedom and p. The last bits are those of libm. Errors:
 * BIS_INPUT (an item not below n; P as the weights of bis_flat_alias_build), BIS_NOMEM. */
int bis_flat_fit(size_t n, const double *P, size_t m, const uint32_t *item, double *observed, double *fit, char *say,
                 size_t size);

/* ---- thesis 3.3, 3.4: maps ---- */

/* bis_flat_light_find stores in pixel[n] the pixel (y * width + x) of the map that each direction w[n][3] meets.
 * Errors: as bis_flat_light_look. */
int bis_flat_light_find(const bis_light *light, size_t n, const float *w, uint32_t *pixel, char *say, size_t size);

/* bis_flat_light_shrink makes a map of at most `width` columns from one that is open, by the mean of the radiance over
 * each of its pixels; it is opened as by a scene that says nothing of it. Errors: BIS_INPUT (width below 1), BIS_NOMEM.
 */
int bis_flat_light_shrink(bis_light **small, const bis_light *light, int width, char *say, size_t size);

/* bis_flat_light_density stores the density pdf[height][width] in 1/sr inside each pixel, the largest of them in *peak,
 * and share[height], the share of the draws that fall into each row. Errors: BIS_INPUT. */
int bis_flat_light_density(const bis_light *light, double *pdf, double *peak, double *share, char *say, size_t size);

/* bis_flat_light_rows counts in count[height] how many of pixel[n] lie in each row. polar[2] receives how many of them
 * lie in rows whose middle is within `degrees` of a pole, and how many should by the density. Errors: BIS_INPUT (a
 * pixel that the map does not have; degrees is NaN). */
int bis_flat_light_rows(const bis_light *light, size_t n, const uint32_t *pixel, double degrees, uint32_t *count,
                        double *polar, char *say, size_t size);

/* bis_flat_light_regions finds the components of thesis 3.4: label[height][width] (UINT32_MAX: black), level[height]
 * [width] (UINT32_MAX: black), area[height][width], the solid angle of each pixel's component in sr, *n their number,
 * and factor[height][width], the area factor with exponent b. Errors: BIS_INPUT (levels outside [1, 254]),
 * BIS_NOMEM. */
int bis_flat_light_regions(const bis_light *light, int levels, double b, uint32_t *label, uint32_t *level, double *area,
                           double *factor, uint32_t *n, char *say, size_t size);

/* ---- thesis 3.5: materials ---- */

/* bis_flat_bsdf_albedo stores in sum[3], by the midpoints of n x n cells of equal solid angle about the normal: the
 * share of light that is reflected (mean of R, G, B), the integral of the density over the hemisphere above the
 * horizon, and 1 minus it, which is drawn below the horizon and lost. normal[3] is as for bis_flat_bsdf_open. The
 * last bits are those of libm. Errors: BIS_INPUT (n outside [1, 4096], a normal of 0). */
int bis_flat_bsdf_albedo(const bis_bsdf *bsdf, const double *normal, int n, double *sum, char *say, size_t size);

/* bis_flat_bsdf_plane looks along n directions in the plane of normal and eye, degrees[n] from the normal, negative
 * on the eye's side: f_cos[n], f cos of red in 1/sr, and the density pdf[n]. normal[3] is as for bis_flat_bsdf_open.
 * The last bits are those of libm. Errors: BIS_INPUT (an angle that is not finite, a normal of 0). */
int bis_flat_bsdf_plane(const bis_bsdf *bsdf, const double *normal, size_t n, const double *degrees, double *f_cos,
                        double *pdf, char *say, size_t size);

/* bis_flat_bsdf_below stores 1 in below[n] where a direction wi[n][3] lies on or below the horizon, else 0, and their
 * number in *count. Errors: BIS_INPUT (wi is NaN). */
int bis_flat_bsdf_below(const bis_bsdf *bsdf, size_t n, const float *wi, uint8_t *below, uint32_t *count, char *say,
                        size_t size);

/* ---- chapter 4: one point of a scene ---- */

typedef struct bis_flat_stage bis_flat_stage;

/* bis_flat_stage_open reads a scene for looking at its points. settings are those of bis_flat_render. Errors: as
 * bis_flat_render. */
int bis_flat_stage_open(bis_flat_stage **stage, const char *scene, const char *const *settings, char *say, size_t size);

/* bis_flat_stage_close frees the stage; NULL is allowed. */
void bis_flat_stage_close(bis_flat_stage *stage);

/* bis_flat_stage_at goes to the point that the centre of pixel (x, y) sees. found[8]: 1 or 0 (no surface), position,
 * normal, distance. Where there is no surface the functions below are BIS_INPUT. */
int bis_flat_stage_at(bis_flat_stage *stage, int x, int y, double *found, char *say, size_t size);

/* bis_flat_stage_exact stores in value[4] the reflected radiance r+g+b of eq. 4.1, its standard error, and the same
 * two without V, eq. 4.5. Errors: BIS_NOMEM. */
int bis_flat_stage_exact(bis_flat_stage *stage, uint32_t seed, double *value, char *say, size_t size);

/* bis_flat_stage_densities stores, for the middle of each cell of a lat-long field of directions in the light's
 * frame: q_L[rows][columns] (eq. 4.2), q_f[rows][columns] (4.3), product[rows][columns], which is phat = f cos Le
 * (4.4, not normalised), and seen[rows][columns], the part of it that is seen; and the largest of each in peak[4].
 * Floats, because the last bits of a double depend on the C library's pow. */
int bis_flat_stage_densities(bis_flat_stage *stage, int columns, int rows, float *q_L, float *q_f, float *product,
                             float *seen, float *peak, char *say, size_t size);

/* bis_flat_stage_candidates draws, weighs, chooses and traces as `sir` does with these settings (name=value of its
 * parameters, with candidates <= room). Of each candidate: wi[room][3], w[room], chosen[room] (how often), kind[room]
 * (bit 0: from the map, bit 1: it sees the light). sum[6]: M, N, the effective sample size, the estimate r+g+b, that
 * of L_ns, the rays. Errors: BIS_INPUT (settings of another integrator, more candidates than room), BIS_NOMEM. */
int bis_flat_stage_candidates(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t room, float *wi,
                              double *w, uint32_t *chosen, uint32_t *kind, double *sum, char *say, size_t size);

/* bis_flat_stage_find stores in cell[n] that of a field [rows][columns] of the light's frame that each wi[n][3] lies
 * in. The first one is that of (0, 0, 0), which bis_flat_stage_candidates stores where there is no candidate.
 * Errors: BIS_INPUT (columns or rows outside [1, 4096], wi not finite). */
int bis_flat_stage_find(bis_flat_stage *stage, int columns, int rows, size_t n, const float *wi, uint32_t *cell,
                        char *say, size_t size);

/* bis_flat_stage_runs stores n estimates r+g+b at the point in L[n] by the integrator that settings name, with
 * numbers of the kind of the scene's sampler, each estimate by itself; and in sum[3] their mean, their standard
 * deviation, and shadow rays per estimate. Errors: as bis_flat_render. */
int bis_flat_stage_runs(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *L,
                        double *sum, char *say, size_t size);

/* bis_flat_stage_mis computes what multiple importance sampling reaches with independent samples, from n times those of
 * integrator "mis" with these settings (docs/theory.md, "The best weights"): sum[5] is the mean of one estimate r+g+b,
 * its standard deviation by the balance heuristic, that by the best weights, beta, and the overlap of the two densities
 * in [0,1]. The last bits are those of libm. Errors: BIS_INPUT (another integrator, n outside [2, 1e6]), BIS_NOMEM. */
int bis_flat_stage_mis(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *sum,
                       char *say, size_t size);

/* bis_flat_stage_noises measures the two noises of sir over n estimates (docs/errata.md E31): sum[5] is the mean, the
 * standard deviation of the estimate, that of its mean given the candidates (the noise of the candidates, of Zhat and
 * of what they see), that of the rest (the noise of choosing N of them, so of V), and rays per estimate. The squares of
 * the two add up to that of the whole. Costs M more rays per estimate. Errors: as bis_flat_stage_runs. */
int bis_flat_stage_noises(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *sum,
                          char *say, size_t size);

/* bis_flat_stage_bounds stores in bound[2] the bounds of figure 4.4 at the point: c_em and c_brdf. */
int bis_flat_stage_bounds(bis_flat_stage *stage, double *bound, char *say, size_t size);

/* bis_flat_stage_accept holds candidates of weight w[n] against the bound of their proposal, "em" or "brdf": height[n]
 * receives u[n] times the bound, taken[n] 1 where it lies below w, else 0, and *accepted the number of the former.
 * Errors: BIS_INPUT (another proposal, w or u is NaN). */
int bis_flat_stage_accept(bis_flat_stage *stage, const char *proposal, size_t n, const double *w, const double *u,
                          double *height, uint32_t *taken, uint32_t *accepted, char *say, size_t size);

/* bis_flat_stage_accepted makes n estimates by integrator rejection: count[3] receives accepted candidates, candidates
 * and rays of one estimate in the mean. Errors: as bis_flat_stage_runs. */
int bis_flat_stage_accepted(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *count,
                            char *say, size_t size);

/* ---- pictures ---- */

/* bis_flat_picture_pass_seconds returns how long one pass of the render took, one sample of every pixel; NaN for NULL.
 */
double bis_flat_picture_pass_seconds(const bis_flat_picture *picture);

/* bis_flat_compare stores in sum[3] the RMSE, the relMSE and the bias of a[height][width][4] against b, which is
 * b[height][width][4], as `bis compare`. The last bits are those of libm. Errors: BIS_INPUT, BIS_NOMEM. */
int bis_flat_compare(int width, int height, const float *a, const float *b, double *sum, char *say, size_t size);
