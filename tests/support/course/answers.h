/* SPDX-License-Identifier: BSD-2-Clause */
/* answers: the process in which a student's functions run, while the claims run in another (mark.h).
 *
 * It knows no claim, no expected value and no seed. It reads a question from a socket, calls the functions that the
 * question names, once for each element of the arrays that come with it, and writes the arrays that are asked for. A
 * question is a whole batch of calls, because a question alone takes 20 to 100 us.
 *
 * A question has parts: some are given, and some are taken, that is, filled here. A part of 0 bytes is left out. */
#ifndef TESTS_ANSWERS_H
#define TESTS_ANSWERS_H

#include "lit.h"

#include "bis/shape/accel.h"
#include "bis/thesis/importance.h"
#include "bis/thesis/phong.h"

typedef enum ask_question {
    /* w[n]; taken: C[n + 1], total[1] */
    ASK_CDF,
    /* C[n + 1], guide[g + 1], u[m]; taken: item[m], remainder[m] (left out: NULL is passed) */
    ASK_SEARCH,
    /* w[n]; taken: prob[n], alias[n] */
    ASK_ALIAS,
    /* prob[n], alias[n], u[m]; taken: item[m] */
    ASK_PICK,
    /* bis_levels[m], intensity[m]; taken: uint8_t level[m] */
    ASK_LEVELS,
    /* ask_map[1], pixels[n]; taken: uint32_t regions[1], label[n], solid_angle[n], of which so many count */
    ASK_REGIONS,
    /* ask_map[1]; taken: row_solid_angle[height], cos_edge[height + 1] */
    ASK_MAP,
    /* ask_map[1], ask_place[m]; taken: vec3[m] */
    ASK_DIRECTIONS,
    /* ask_map[1], vec3[m]; taken: size_t pixel[m] */
    ASK_PIXELS,
    /* ask_map[1], pixels[n], u[m][4]; taken: the density of each pixel [n], ask_drawn[m], the density at each [m] */
    ASK_IMPORTANCE,
    /* (exponent, u1, u2)[m]; taken: vec3[m], density[m] */
    ASK_LOBE,
    /* ask_surface[1 or m], wi[m]; taken: f[m], its density[m], bis_bsdf_pdf[m] */
    ASK_F,
    /* ask_surface[1 or m], u[m][3]; taken: wi[m], uint8_t drawn[m] */
    ASK_SAMPLE,
    /* ask_surface[1 or m], u[m][2]; taken: wi[m], uint8_t drawn[m] */
    ASK_DRAW,
    /* ask_surface[m]; taken: max_ratio[m] */
    ASK_BOUND,
    /* ask_scene[1], uint64_t run[m], which are pixels; taken: ask_estimate[m] */
    ASK_ESTIMATES,
    /* ask_scene[1]; taken: Zhat[1], w[n], F_r[n], F_g[n], F_b[n], as they lie in the set */
    ASK_WEIGHTS,
    /* ask_marks[1], w[n]; taken: n_chosen[m], item[m][n + 1], times[m][n + 1] */
    ASK_CHOICES,
    /* p[], index[][3], density[1], rays[m]; taken: ask_hit[m]; then, to change the grid once it is built, p[], and its
     * offsets[], items[] and occupied[] */
    ASK_RAYS,
    ASK_QUESTIONS
} ask_question;

typedef struct ask_map {
    int width, height, levels;
    bis_importance_options options;
} ask_map;

typedef struct ask_place {
    int x, y;
    double u1, u2;
} ask_place;

typedef struct ask_drawn {
    bis_map_sample s;
    uint8_t drawn;
} ask_drawn;

/* The material's model is a pointer and means nothing in another process: microfacet where alpha > 0, else phong. */
typedef struct ask_surface {
    bis_material material;
    vec3 n, wo;
} ask_surface;

enum { ASK_MIS, ASK_REJECTION, ASK_SIR };

/* The light of lit_new_light, the shading point of lit_init, an integrator by its number, and the seed of its
 * streams. */
typedef struct ask_scene {
    lit_map map;
    double scale, area_exponent; /* of the light */
    bis_material material;
    vec3 n;
    double degrees;
    lit_hidden hidden;
    bis_sampler_kind kind;
    int integrator; /* ASK_MIS, ASK_REJECTION, ASK_SIR */
    bis_settings settings;
    uint64_t seed;
} ask_scene;

typedef struct ask_estimate {
    rgb L;
    uint64_t rays, accepted;
    lit_rays first; /* of the rays */
} ask_estimate;

typedef struct ask_marks {
    uint32_t N;
    double W;
    bis_resampling kind;
    uint64_t seed; /* and the pixel is the number of the run */
} ask_marks;

typedef struct ask_hit {
    bis_hit hit;
    uint8_t found, any;
} ask_hit;

/* What goes before a question's bytes. */
enum { ASK_PARTS = 9 };
typedef struct ask_header {
    uint64_t question, n;
    uint64_t bytes[ASK_PARTS];
    bool taken[ASK_PARTS];
} ask_header;

/* answers_serve answers questions on descriptor BOX_CHANNEL (box.h) until there are no more. Returns the
 * program's exit status. */
int answers_serve(void);

/* answers_model sets the model of a material that came from another process. */
void answers_model(bis_material *m);

/* answers_lit makes the light and the shading point of a scene. The caller frees l->light with bis_light_free. */
void answers_lit(lit *l, const ask_scene *scene);

/* answers_estimate makes the estimate of a run by settings->integrator. */
ask_estimate answers_estimate(lit *l, const bis_settings *settings, bis_scratch *scratch, uint64_t seed, uint64_t run);

/* answers_stream returns the stream of a run, which weights and choices draw from. sampler must stay where it is. */
bis_stream answers_stream(uint64_t seed, uint64_t run, bis_sampler *sampler);

#endif
