/* SPDX-License-Identifier: BSD-2-Clause */
/* verify: are samplers, materials and integrators right for the user's own map and scene (`bis verify`)?
 *
 * A run is a list of tests. Two kinds: those of a number that must not exceed a limit which is derived where it stands
 * (rounding, quadrature), and statistical ones, which have a p-value. How many of the latter there will be is known in
 * the end alone: then the threshold of each is Sidak's, so that all of them together reject what is right with
 * probability BIS_VERIFY_ALPHA.
 *
 * What a check asks of a sampler, a material or an integrator, it asks through a struct of functions: so a test can
 * hand in a wrong one and see it rejected (tests/tools/test_verify*.c). Nothing here prints; src/cli/cmd_verify.c does.
 * Results do not depend on the number of threads.
 *
 *     bis_verify v = {.seed = 1};
 *     status = bis_verify_map(&v, em, 0.15, 8, diag);
 *     bis_verify_judge(&v);               // v.n_failed, v.tests[0 .. v.n - 1]
 *     bis_verify_clear(&v); */
#pragma once

#include "bis/render/render.h"
#include "bis/scene/scene.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"

#include <signal.h>

#define BIS_VERIFY_ALPHA 0.01

typedef enum bis_verdict { BIS_VERDICT_PASSED, BIS_VERDICT_FAILED, BIS_VERDICT_SKIPPED } bis_verdict;

typedef struct bis_verify_test {
    const char *group; /* "map", "materials", "picture", "view", "accelerators"; a constant */
    char name[80];     /* "material 2, n 50, 45 degrees" */
    char note[120];    /* what the statistic is, or why the test was skipped or failed at once */
    double statistic, dof;
    double p;          /* NAN: not statistical */
    double threshold;  /* of p, or the largest statistic that is right; set by bis_verify_judge for p */
    bis_verdict verdict;
} bis_verify_test;

/* A run. Zero-initialise but for seed, as_printed, halvings and progress. */
typedef struct bis_verify {
    uint64_t seed;
    unsigned as_printed; /* BIS_E*: what the scene does wrong on purpose, for the maps' tables; it should be found */
    unsigned halvings; /* so often the number of draws, runs, rays and pixels is halved: 0; to 5 for many quick runs */
    void (*progress)(const char *what, void *user); /* a new part begins; may be NULL */
    void *user;
    bis_verify_test *tests;
    size_t n, capacity;
    size_t n_statistical, n_failed, n_skipped; /* by bis_verify_judge */
    double threshold;                          /* of every p */
    bool no_memory;                            /* a test was lost: then bis_verify_judge returns BIS_NOMEM */
    bis_verify_test lost;                      /* what stands for that test, so that no caller has to ask */
} bis_verify;

/* bis_verify_judge sets thresholds and verdicts. Errors: BIS_NOMEM. */
bis_status bis_verify_judge(bis_verify *v, bis_diag *diag);

/* bis_verify_clear frees the tests. */
void bis_verify_clear(bis_verify *v);

/* bis_verify_seed returns the seed of one test, by its name, so that it does not change when another test comes before
 * it. All tests of all runs see different numbers. */
uint64_t bis_verify_seed(const bis_verify *v, const char *name, ...) BIS_PRINTF(2, 3);

/* ---- one test each: bis_verify_bound(bis_verify_new(v, "map", "row %d", y), error, limit, "relative error") ---- */

/* bis_verify_new adds a test to v, whose name is made as by printf, and returns it, never NULL. It may move until the
 * next one is added, so let one of the functions below fill it in at once. */
bis_verify_test *bis_verify_new(bis_verify *v, const char *group, const char *name, ...) BIS_PRINTF(3, 4);

/* bis_verify_bound tests that 0 <= value <= limit. */
void bis_verify_bound(bis_verify_test *t, double value, double limit, const char *note);

/* bis_verify_fit tests counts by Pearson's chi-square: cells that expect fewer than 5 are pooled in order, the rest
 * joins the last pool; a hit in a cell that expects 0 rejects. */
void bis_verify_fit(bis_verify_test *t, const double *observed, const double *expected, size_t n);

/* Runs of an estimator. */
typedef struct bis_verify_moments {
    double n, mean, m2, m3; /* sums of squares and cubes about the mean */
} bis_verify_moments;

/* bis_verify_add adds a run. */
void bis_verify_add(bis_verify_moments *m, double x);

/* bis_verify_skewness returns the skewness of the mean of these runs, 0 where they do not scatter. */
double bis_verify_skewness(const bis_verify_moments *m);

/* bis_verify_skewness_beside returns a bound of the |skewness| of the difference of two means. of_a: the share of a's
 * mean in the difference's variance. */
double bis_verify_skewness_beside(const bis_verify_moments *a, const bis_verify_moments *b, double of_a);

/* bis_verify_t returns a bound of the probability that a mean of so many runs lies |z| or more of its own standard
 * errors from what is right; dof: runs less one, or INFINITY where the standard error is known. skewness: of the mean.
 * Never larger for a larger |z|. Beyond BIS_VERIFY_MOST_SKEWNESS no z is enough for a verdict. */
double bis_verify_t(double z, double dof, double skewness);
#define BIS_VERIFY_MOST_SKEWNESS 0.15

/* bis_verify_mean tests by bis_verify_t that the mean of these runs is `expected`, but for `slack` that rounding or
 * quadrature may have. */
void bis_verify_mean(bis_verify_test *t, const bis_verify_moments *runs, double expected, double slack);

/* bis_verify_p tests any p, or a bound of it. */
void bis_verify_p(bis_verify_test *t, double statistic, double p, const char *note);

/* bis_verify_skip says that the test was skipped, and why. */
void bis_verify_skip(bis_verify_test *t, const char *why);

/* bis_verify_begin tells the caller's progress that a new part begins. */
void bis_verify_begin(const bis_verify *v, const char *what);

/* ---- the checks; errors: BIS_NOMEM ---- */

/* src/tools/verify/verify_map.c. A way to draw from a map, as bis_importance_sample: false where there is no light. */
typedef struct bis_verify_sampler {
    const char *name;
    bool (*draw)(const void *self, bis_rng *rng, bis_map_sample *s);
    const void *self;
} bis_verify_sampler;

/* bis_verify_map tests all of a map: solid angles, and its importance by alias tables, CDFs and the curve. */
bis_status bis_verify_map(bis_verify *v, const bis_envmap *em, double area_exponent, int levels, bis_diag *diag);

/* bis_verify_solid_angles tests that a map's solid angles add up to the sphere, and each row's by its integral. */
void bis_verify_solid_angles(bis_verify *v, const bis_envmap *em);

/* bis_verify_definition computes pmf[height * width] by definition, w dO / sum, from pixels and regions alone. *lit:
 * there is light. */
bis_status bis_verify_definition(double *pmf, bool *lit, const bis_envmap *em, double area_exponent, int levels,
                                 bis_diag *diag);

/* An importance with a table. */
typedef struct bis_verify_drawing {
    const char *name; /* "alias", "cdf" */
    bis_table_kind kind;
    const bis_importance *im;
} bis_verify_drawing;

/* bis_verify_importance tests that the density of an importance is the definition's and integrates to 1, and that its
 * table gives each pixel the probability that the density claims. */
bis_status bis_verify_importance(bis_verify *v, const bis_verify_drawing *d, const bis_envmap *em, const double *pmf,
                                 bis_diag *diag);

/* bis_verify_draws tests drawn directions by pixel, and by 4 x 4 cells inside the pixels. */
bis_status bis_verify_draws(bis_verify *v, const bis_verify_sampler *sampler, const bis_envmap *em, const double *pmf,
                            bis_diag *diag);

/* ---- src/tools/verify/verify_bsdf.c ---- */

/* A material seen at an angle to the normal. */
typedef struct bis_verify_lobe {
    const char *name;
    const bis_material *material;
    double degrees;
} bis_verify_lobe;

/* bis_verify_width returns what the model tells of its lobe's width: n of a lobe over wi, alpha of one over the half
 * vector (at least 1e-4). Without a lobe n is 0. */
double bis_verify_width(const bis_material *m);

/* bis_verify_material tests that the density of a lobe integrates to 1 and that its sampler draws by it; under a
 * constant light the integrators (n of them) give what quadrature gives. */
bis_status bis_verify_material(bis_verify *v, const bis_verify_lobe *lobe, const bis_settings *settings, size_t n,
                               bis_diag *diag);

/* ---- src/tools/verify/verify_view.c ---- */

#define BIS_VERIFY_MAX_INTEGRATORS 16 /* BIS_TRUTH_MAX_DENSITIES */

/* A shading point where integrators are compared, by samples of that kind. */
typedef struct bis_verify_place {
    const char *name;
    const bis_point *pt;
    bis_sampler_kind kind;
} bis_verify_place;

/* bis_verify_point tests n <= BIS_VERIFY_MAX_INTEGRATORS integrators at one point against a sum over all patches of the
 * light, which must have table and curve. *tested: false where too little of the light is seen from there for a fair
 * test; nothing is added then. */
bis_status bis_verify_point(bis_verify *v, const bis_verify_place *at, const bis_settings *settings, size_t n,
                            bool *tested, bis_diag *diag);

/* Estimates of reflected radiance at a point: n of them, the r-th from the stream of (seed, pixel = r). */
typedef struct bis_verify_job {
    const bis_point *pt;
    const bis_settings *settings;
    bis_sampler_kind kind;
    uint32_t n;
    uint64_t seed;
    const volatile sig_atomic_t *stop; /* NULL, or it is set to end the work soon */
} bis_verify_job;

/* bis_verify_runs makes estimate[job->n] on all threads. Each is independent of the others: proposal "product" draws
 * the directions of its clusters anew for each, and nothing is learned. counters: shadow rays, accepted candidates and
 * fallbacks are added to it. Errors: BIS_NOMEM, BIS_INPUT (it was stopped). */
bis_status bis_verify_runs(rgb *estimate, const bis_verify_job *job, bis_counters *counters, bis_diag *diag);

/* bis_verify_cost returns about how long one estimate takes, in units of 60 ns: 8 for a shadow ray, 1 for a candidate.
 */
double bis_verify_cost(const bis_settings *s, size_t patches);

/* bis_verify_measure returns one number for a colour, to be tested: 4r + 2g + b, so that an exchange of channels is
 * seen. */
static inline double bis_verify_measure(rgbd c) { return 4 * c.r + 2 * c.g + c.b; }

/* src/tools/verify/verify_pixels.c. Sums of bis_verify_measure times solid angle over the light's patches. */
typedef struct bis_verify_table {
    const bis_light *light;
    size_t n;
    double *sum; /* sum[n + 1]: over the patches before */
} bis_verify_table;

/* bis_verify_table_init makes the sums. light is borrowed. Errors: BIS_NOMEM; *t can then be cleared. */
bis_status bis_verify_table_init(bis_verify_table *t, const bis_light *light, bis_diag *diag);
void bis_verify_table_clear(bis_verify_table *t);

/* What is seen, and how. */
typedef struct bis_verify_eye {
    const bis_scene *scene;
    const bis_scene_desc *desc;
    const bis_view *view;
    const bis_film *film; /* as bis_film_place makes it */
    const bis_verify_table *table;
    bool without_shadows;
} bis_verify_eye;

/* What the samples of a pixel have met. */
typedef struct bis_verify_pixel {
    double square;     /* mean of their squares */
    double slope[2];   /* mean of their values times their place in the pixel, right and down from its centre */
    bool is_outline;   /* they meet other materials, normals more than 60 degrees apart, or nothing at times */
    uint32_t material; /* of the first, an index into desc->materials; BIS_NO_NUMBER: it meets nothing */
    vec3 n;            /* normal of the first */
} bis_verify_pixel;

/* bis_verify_means stores in mean[height][width] what each pixel of the film should be, by n[height][width] > 0 samples
 * of its area, and in pixels[height][width] (may be NULL) what they met. The numbers are those of bis_verify_measure.
 * The result does not depend on the number of threads. */
void bis_verify_means(double *mean, bis_verify_pixel *pixels, const bis_verify_eye *e, const uint32_t *n,
                      uint64_t seed);

/* src/tools/verify/verify_picture.c. What renders: bis_render, or what a test hands in. */
typedef bis_status bis_verify_render(bis_render_result *result, bis_film *film, const bis_scene *scene,
                                     const bis_view *view, const bis_render_options *options, bis_diag *diag);

/* bis_verify_picture compares many small pictures by `render`, of scene->desc's view with these settings, with
 * bis_verify_means. *tested: false where the integrator is too dear for that, or nothing is lit; a skipped test says
 * so. Errors: BIS_NOMEM. */
bis_status bis_verify_picture(bis_verify *v, bis_verify_render *render, const bis_scene *scene,
                              const bis_settings *settings, bool *tested, bis_diag *diag);

/* ---- src/tools/verify/verify_oracle.c ---- */

/* What an accelerator says of a ray: the distance to the nearest hit, infinite for none, and whether there is any. */
enum { BIS_VERIFY_ANSWERS = 2 };
typedef struct bis_verify_answer {
    double t;
    bool occluded;
} bis_verify_answer;

/* bis_verify_search stores which of n answers are right, within the rounding of floats, by a search over all primitives
 * but `left`, which the ray starts from by bis_surface_offset (a triangle or a disk; BIS_NO_PRIM: none). */
void bis_verify_search(bool right[], const bis_geometry *g, const ray *r, uint32_t left,
                       const bis_verify_answer *answer, int n);

/* ---- src/tools/verify/verify_accel.c ---- */

/* bis_verify_backends tests one backend (b NULL), or two of the same geometry, by n random rays, and as many from the
 * surfaces that they meet. */
void bis_verify_backends(bis_verify *v, const bis_accel *a, const bis_accel *b, size_t n);

/* What the scene's description must ask of its light (bis_scene_desc.light_needs), here and for bis_pixel_find: all
 * that any integrator needs of it. */
#define BIS_VERIFY_LIGHT_NEEDS (BIS_NEED_TABLE | BIS_NEED_CURVE | BIS_NEED_SPREAD)

/* ---- src/tools/verify/verify_scene.c ---- */

/* bis_verify_scene makes whatever tests of the above apply. */
bis_status bis_verify_scene(bis_verify *v, const bis_scene *scene, const bis_scene_desc *desc,
                            const bis_settings *settings, bis_diag *diag);

/* ---- the same bits: src/tools/verify/verify_bits.c ---- */

/* A small table or picture, as this build computes it. */
enum { BIS_N_BITS = 12 };
typedef struct bis_bits {
    const char *name;
    uint64_t hash, expected; /* FNV-1a of all values; other values than every build has if they differ */
    double sum;              /* of all values */
    double departs;          /* |sum - the expected sum| as a share of the latter */
} bis_bits;

/* bis_verify_bits computes all rows, each from those above it, so that the first one that differs says where a build
 * departs. Needs no file; takes a second. Errors: BIS_NOMEM. */
bis_status bis_verify_bits(bis_bits rows[BIS_N_BITS], bis_diag *diag);
