/* SPDX-License-Identifier: BSD-2-Clause */
/* world: a scene without files, a ball on a floor under a map of 16 x 8 random pixels, and integrators that do exactly
 * what a test of render or film needs. Shared by the tests of row 6. */
#ifndef TESTS_WORLD_H
#define TESTS_WORLD_H

#include "bis/render/render.h"

#include <signal.h>
#include <stdatomic.h>

typedef struct world {
    bis_scene_desc desc;
    bis_scene scene;
    bis_material materials[2];
    bis_shape_desc shapes[2]; /* the floor, of material 0, and the ball, of material 1 */
} world;

enum { WIDTH = 37, HEIGHT = 21 };

extern const double whole[4];

/* Sampler stratified with 4 camera samples, seed 1; small M and N. w must stay where it is. */
void make_world(world *w, const bis_integrator *integrator);
void clear_world(world *w);

/* Film and all; both must succeed. */
void render(
    bis_film *film, bis_render_result *result, const world *w, const double crop[4], const bis_render_options *options);

/* As render, with layers (a set of bis/layers.h). */
void render_layers(bis_film *film, bis_render_result *result, const world *w, const double crop[4], unsigned layers,
    const bis_render_options *options);

/* Film, layers and one pass with the k-th allocation failing, k = 1, 2, ...: each is one error of memory. Returns the
 * first k that does not fail. */
long first_k_without_failure(const world *w, unsigned layers);

void assert_same_bits(const bis_film *a, const bis_film *b);

/* An integrator of one function. */
unsigned no_light_needs(const bis_settings *s);
void no_scratch(const bis_settings *s, bis_needs *need);
rgb noise_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch);

extern const bis_integrator noise; /* u, 1/2 + u, 1 */
extern const bis_integrator place; /* where the ray met the surface, plus 10 */
extern const bis_integrator sick;  /* NaN or infinity for a quarter of the samples */

/* As noise, and a call of it may interrupt. An integrator has no place of its own for state, so a test calls
 * set_fuse(n) before each render: the n-th call sets world_flag; -1: none does. */
extern const bis_integrator fused;
extern atomic_long world_calls; /* since then */
extern volatile sig_atomic_t world_flag;
void set_fuse(long n);

#endif
