/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel: everything about one pixel, for `bis pixel`: the point that its centre sees, what eq. 4.1 is there, what every
 * method makes of it, and the candidates, weights and shadow rays behind that.
 *
 * Nothing here prints; scripts/python/bis/tools/pixel.py does. Results do not depend on the number of threads.
 *
 *     if (bis_pixel_find(&hit, &pt, scene, x, y, &counters)) {
 *         status = bis_pixel_exact_of(&exact, &pt, seed, diag);                   // the truth
 *         status = bis_pixel_method_run(&method, estimate, &exact, job, diag);    // one method against it
 *         status = bis_pixel_candidates_draw(&c, &pt, &settings, &stream, diag);
 *         ...
 *         bis_pixel_candidates_clear(&c);
 *     } */
#pragma once

#include "bis/scene/scene.h"
#include "tools/verify/verify.h"

/* ---- src/tools/pixel/pixel.c: the point, the truth, the methods ---- */

typedef struct bis_pixel_hit {
    ray eye;                        /* of the pixel's centre; all else only where it meets a surface */
    double t;                       /* along it, in world units */
    uint32_t prim;                  /* of the geometry */
    size_t shape, part;             /* index into desc->shapes; the triangle in it */
    const bis_material *material;   /* of this point */
    bis_own_material own;           /* what the point's bsdf may point to: the hit must outlive the point, unmoved */
} bis_pixel_hit;

/* bis_pixel_find stores the point that the ray through the centre of pixel (x, y) meets, as an integrator sees it. It
 * returns false if the ray meets no surface. The scene must have been built with BIS_VERIFY_LIGHT_NEEDS (verify.h);
 * counters are borrowed by pt. */
bool bis_pixel_find(bis_pixel_hit *hit, bis_point *pt, const bis_scene *scene, int x, int y, bis_counters *counters);

/* Red, green, blue, and their sum: the mean and its standard error. */
typedef struct bis_pixel_value {
    double mean[4], se[4];
} bis_pixel_value;

/* Reflected radiance, eq. 4.1 (lit) and without V, eq. 4.5 (open): a sum over the patches of the light (truth.h), whose
 * scatter is the standard error; for a light of more than BIS_PIXEL_MAX_PATCHES patches so many runs of `mis` instead.
 */
enum {
    BIS_PIXEL_CELLS = 1 << 16,
    BIS_PIXEL_MAX_PATCHES = 1 << 21,
    BIS_PIXEL_MIS_RUNS = 1 << 14,
    BIS_PIXEL_MIS_SAMPLES = 64
};
typedef struct bis_pixel_exact {
    bool by_patches;
    size_t patches, rays;          /* by patches: rays that were traced for the sum */
    bis_pixel_value lit, open;
    double variance[3],
        third[3]; /* by patches: variance and third central moment of F V/q, for q = q_L, q_f, (q_L + q_f)/2 */
} bis_pixel_exact;

/* bis_pixel_exact_of computes it. max_patches is BIS_PIXEL_MAX_PATCHES; a test may choose. Errors: BIS_NOMEM. */
bis_status bis_pixel_exact_of(bis_pixel_exact *e, const bis_point *pt, size_t max_patches, uint64_t seed,
                              bis_diag *diag);

/* What multiple importance sampling reaches with independent samples, of r+g+b (docs/theory.md, "The best weights"):
 * variance of one estimate by the balance heuristic and by the best weights, its mean, beta, and the overlap of the two
 * densities, N int q1 q2/c, in [0,1]: 0 where they are apart, 1 where they are the same. */
typedef struct bis_pixel_mis {
    double variance[2], mean, beta, overlap;
} bis_pixel_mis;

/* bis_pixel_mis_of computes it from n >= 2 times the samples of these settings, which are those of mis, with the table
 * of the light. Cost: a ray for each sample. Errors: BIS_NOMEM. */
bis_status bis_pixel_mis_of(bis_pixel_mis *mis, const bis_point *pt, const bis_settings *settings, size_t n,
                            uint64_t seed, bis_diag *diag);

/* One method, run many times. */
typedef struct bis_pixel_method {
    char name[24]; /* the integrator's, "rejection plain" where it has two estimators */
    bis_settings settings;
    uint32_t repeats;
    bool is_open;          /* estimates L_ns: `unoccluded` */
    bis_pixel_value L;
    double error; /* root mean square difference of one estimate from the truth, both of r+g+b, over the truth; NAN for
                     a truth of 0 */
    double z;              /* (mean - truth) of r+g+b over both standard errors; NAN where neither scatters */
    double skewness; /* of the mean, from its own estimates: z is that of a normal distribution only where it is well
                        below 0.1 */
    double true_skewness;  /* the same for em, brdf, mis as if all samples were independent, from the sum over patches;
                              else NAN */
    double rays, accepted; /* shadow rays and accepted candidates in the mean of one estimate */
} bis_pixel_method;

enum { BIS_PIXEL_MAX_METHODS = 12 };

/* bis_pixel_methods stores the methods worth a row, with the scene's parameters where they apply: all but `exact`. It
 * returns their number. */
size_t bis_pixel_methods(bis_pixel_method list[BIS_PIXEL_MAX_METHODS], const bis_settings *own);

/* bis_pixel_method_run makes estimate[job->n] by the method and fills all from L on. job: where, how many (2 or more),
 * and by which numbers; its settings are those of *m. Errors: BIS_NOMEM, BIS_INPUT (it was stopped). */
bis_status bis_pixel_method_run(bis_pixel_method *m, rgb *estimate, const bis_pixel_exact *exact, bis_verify_job job,
                                bis_diag *diag);

/* ---- src/tools/pixel/pixel_rays.c: what a method does ---- */

/* A candidate, taken apart: q_L and q_f are the proposals' own densities, q that by which it was weighed. */
typedef struct bis_pixel_candidate {
    vec3 wi;
    double w;            /* the weight, phat/q */
    bool from_map;       /* else from the BRDF */
    double q_L, q_f, q;  /* 1/sr; NAN where the weight is 0: then its direction is not known */
    double product;      /* phat = f cos Le, r+g+b */
    uint32_t chosen;     /* how often */
    bool seen;           /* V, of the chosen */
} bis_pixel_candidate;

/* One estimate by SIR (thesis 4.4). */
typedef struct bis_pixel_candidates {
    uint32_t M, N;
    bis_pixel_candidate *c; /* c[M], in the order in which they were drawn */
    double W, square_sum;   /* sums of the weights and of their squares */
    double ess;             /* effective sample size, (sum w)^2 / sum w^2; 0 when all weights are */
    double largest;         /* the largest share of one candidate in W */
    double share_em;        /* beta: the map's share of the mixture q; NAN where no candidate has a weight */
    uint32_t n_map;         /* of the M, from the map */
    uint32_t positive, distinct,
        seen;               /* candidates with a weight; candidates chosen; of the N choices those that see the light */
    rgbd L, L_ns;           /* the estimate, and that of eq. 4.5 */
} bis_pixel_candidates;

/* bis_pixel_candidates_draw draws, weighs, chooses and traces as `sir` with settings s does, by its stream; without the
 * renderer's shared pool. Proposal "product" draws from the clusters of pass 0 of the stream's seed, and nothing has
 * been learned: so does the first pass of a render. Errors: BIS_NOMEM. */
bis_status bis_pixel_candidates_draw(bis_pixel_candidates *c, const bis_point *pt, const bis_settings *s,
                                     bis_stream *stream, bis_diag *diag);
void bis_pixel_candidates_clear(bis_pixel_candidates *c);

/* A shadow ray that an integrator cast. */
typedef struct bis_pixel_ray {
    vec3 wi;
    uint32_t run;
    bool seen; /* it reached the light */
} bis_pixel_ray;

typedef struct bis_pixel_rays {
    bis_pixel_ray *ray;
    size_t n, capacity;
    uint32_t runs;
} bis_pixel_rays;

/* bis_pixel_rays_record stores the shadow rays of camera samples 0 ... runs - 1 of a pixel. An accelerator that writes
 * down what it is asked finds them, so this is true for any integrator. Errors: BIS_NOMEM. */
bis_status bis_pixel_rays_record(bis_pixel_rays *r, const bis_point *pt, const bis_settings *s,
                                 const bis_sampler *sampler, uint64_t pixel, uint32_t runs, bis_diag *diag);
void bis_pixel_rays_clear(bis_pixel_rays *r);

/* bis_pixel_product returns f cos Le towards wi, r+g+b: phat of the thesis. */
double bis_pixel_product(const bis_point *pt, vec3 wi);

/* Directions as the map has them: z up, row 0 at +z, theta from it and phi with the columns, in degrees. */
typedef struct bis_pixel_direction {
    double theta, phi;
} bis_pixel_direction;

/* bis_pixel_angles returns those of w, which is in the map's frame; bis_pixel_direction_of those of a world's wi. */
bis_pixel_direction bis_pixel_angles(vec3 w);
bis_pixel_direction bis_pixel_direction_of(const bis_xform *light_to_world, vec3 wi);
