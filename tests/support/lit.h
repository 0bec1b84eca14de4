/* SPDX-License-Identifier: BSD-2-Clause */
/* lit: a shading point under a small map, in the open, half hidden or hidden, and its reflected radiance by brute
 * force: a sum over all patches with many midpoints in each, with f by lit_f, sharing nothing with the integrators but
 * the map (lit_truth.c). For the tests of integrators. */
#ifndef TESTS_LIT_H
#define TESTS_LIT_H

#include "bis/scene/parameters.h"
#include "bis/thesis/integrator.h"
#include "stat.h"

/* The occluders are bounded by meridians and circles of the map's rows, so that V is constant in a patch and midpoints
 * converge fast. */
typedef enum lit_hidden { LIT_OPEN, LIT_HALF /* y > 0 is hidden */, LIT_ALL, LIT_OTHER_HALF } lit_hidden;

static inline bool lit_is_hidden(lit_hidden hidden, double y)
{
    return hidden == LIT_ALL || (hidden == LIT_HALF && y > 0) || (hidden == LIT_OTHER_HALF && y <= 0);
}

/* Where the first shadow rays went. */
enum { LIT_RAYS = 4 };
typedef struct lit_rays {
    uint32_t n;
    vec3 to[LIT_RAYS];
} lit_rays;

typedef struct lit_accel {
    bis_accel accel; /* first: what bis_accel_occluded sees */
    lit_hidden hidden;
    lit_rays *rays;  /* NULL: nobody wants to know */
} lit_accel;

typedef struct lit {
    bis_light *light;
    lit_accel accel;
    bis_material material;
    bis_sampler_kind kind; /* STRATIFIED; a test may change it */
    bis_counters counters;
    bis_point pt;
} lit;

enum { LIT_WIDTH = 128, LIT_HEIGHT = 64 };

/* Maps of this size, made of blocks of 8 x 8 pixels (0.15 sr at the equator; one pixel: 0.0024 sr, so that area
 * weighting has something to weigh). */
typedef enum lit_map {
    LIT_SPOTTY,    /* coloured blocks, contrast 1e4, black ones, bright single pixels, one sun */
    LIT_SMOOTH,    /* a coloured gradient */
    LIT_RED_BLUE,  /* red for y > 0, blue for y < 0, of equal r+g+b (E5, E6) */
    LIT_ONE_BLOCK, /* one lit block, in the open half, at phi = 281 degrees */
    LIT_BELOW,     /* lit only near -z (E25) */
    LIT_BLACK,
    LIT_CONSTANT   /* no map: a constant light (1, 0.5, 0.25) */
} lit_map;

/* lit_settings returns the defaults of an integrator, but for what its candidates come from, M and N. */
static inline bis_settings lit_settings(const bis_integrator *integrator, bis_proposal proposal, uint32_t M, uint32_t N)
{
    bis_settings s = bis_settings_default(integrator);

    s.proposal = proposal;
    s.candidates = M;
    s.shadowrays = N;
    return s;
}

static inline rgb grey(double v) { return rgb_from(v, v, v); }
static inline vec3 lit_tilted(void) { return normalize(vec3_from(0.2, -0.3, 0.8)); }

bis_light *lit_new_light(lit_map map, double scale, double area_exponent, bool compensate);

/* A point with the given normal, seen at `degrees` from it. l must stay where it is (pt points into it). The light is
 * borrowed. */
void lit_init(lit *l, bis_light *light, bis_material m, vec3 n, double degrees, lit_hidden hidden);

/* F of Schlick, or of Fresnel's equations in complex numbers where eta > 0 and 0 < Ks < 1. */
double lit_fresnel(double Ks, double eta, double c);

/* f, 0 below the horizon, and the density of what the material draws, by the textbooks' formulas, in double: for phong
 * and microfacet. */
rgbd lit_f(const lit *l, const double wi[3], double *pdf);

/* Reflected radiance, with and without V. */
rgbd lit_truth(const lit *l, bool with_V);

/* Integral of phat^2/q - (integral of phat)^2 for q = q_L: the variance of the intensity of one candidate from the map
 * (E31). */
double lit_variance_em(const lit *l);

/* `runs` independent estimates by the integrator; moments per channel, and of the sum in [3]. */
void lit_run(stat_moments m[4], lit *l, const bis_settings *s, uint32_t runs, uint64_t seed);

/* One estimate, with the stream of (seed, pixel = run). */
rgb lit_once(lit *l, const bis_settings *s, bis_scratch *scratch, uint64_t seed, uint64_t run);

/* The most shadow rays that one of `runs` such estimates casts. */
uint64_t lit_most_rays(lit *l, const bis_settings *s, uint32_t runs, uint64_t seed);

#endif
