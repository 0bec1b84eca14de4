/* SPDX-License-Identifier: BSD-2-Clause */
/* measure: what the benchmarks of error and cost share: pictures rendered in this process, references, relMSE.
 *
 * A scene is a template: a scene file in which `@integrator` stands for a line of the caller's table of settings and
 * `@material` for the parameters of a Phong material. In a setting, a lone `@` stands for N, the number that is tuned.
 * Nothing here returns an error: a benchmark that cannot go on prints why and exits with 1. */
#ifndef MEASURE_H
#define MEASURE_H

#include "bis/render/render.h"

typedef struct measure_setting {
    const char *name, *text;
} measure_setting;

enum { MEASURE_MATERIALS = 4 };

/* (ks, kd, n) = (1, 0, 10), (1, 0, 50), (.5, .5, 50), (0, 1, -); ended by one that reflects nothing. */
extern const measure_setting measure_materials[MEASURE_MATERIALS + 1];

/* Leave with the messages of diag where status is an error. */
void measure_check(bis_status status, bis_diag *diag);

/* The template with all blanks filled in; bis_scene_desc_free it. */
bis_scene_desc *measure_parse(const char *path, const char *setting, unsigned N, const char *material);
bis_scene *measure_build(const bis_scene_desc *desc);

/* Processor seconds of this process. With one thread they are what a clock on the wall shows on an idle machine, and
 * nearly that on a busy one. */
double measure_clock(void);

/* Render spp passes into *film (cleared first) with this seed. Returns the processor seconds of the render phase;
 * result, which has those of the wall, may be NULL. */
double measure_render(bis_film *film, const bis_scene *scene, bis_scene_desc *desc, uint64_t seed, uint32_t spp,
    int threads, bis_render_result *result);

/* Pixels that hit geometry; 1 at least. */
size_t measure_shaded(const bis_film *film);

/* What a pixel should be, L[height][width][3], and how well that is known. Two methods, a long `mis` and a long `sir`,
 * each rendered twice with other seeds: the halves of a method give its error, the two methods must agree, and the
 * reference is their mean, weighted by these errors (all four are unbiased). */
typedef struct measure_reference {
    int width, height;
    double *L;
    double error;      /* estimated relMSE of L itself */
    double disagree;   /* relMSE between the two methods : what their errors let expect; about 1 */
    double difference; /* mean of mis : mean of sir, minus 1 */
    double seconds;    /* that it could take, of all processors together */
} measure_reference;

/* Make it, or take it from build/bench/ref, where it is kept under a hash of all that it depends on: the scene's text,
 * the sizes of its files, the processor seconds that it may take. */
measure_reference measure_reference_get(const char *path, const char *material, double seconds);
void measure_reference_free(measure_reference *ref);

/* The error of a picture. Without antialiasing: FINDINGS' relMSE, the mean over shaded pixels and R, G, B of (L -
 * Lref)^2 / (Lref^2 + (0.01 m)^2), m the mean of Lref over the same. With it: that of docs/trust.md, over all pixels,
 * with floor (0.1 m)^2. trimmed: without the 1% of pixels that contribute most. */
typedef struct measure_error {
    double mean, trimmed;
} measure_error;

measure_error measure_relmse(const bis_film *film, const measure_reference *ref, bool antialiased);

#endif
