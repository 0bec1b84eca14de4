/* SPDX-License-Identifier: BSD-2-Clause */
/* state_help: renders whose state goes into files, checkpoints and parts: what is rendered, and what must be the same.
 */
#ifndef TESTS_STATE_HELP_H
#define TESTS_STATE_HELP_H

#include "render/checkpoint.h"
#include "world.h"

/* A way to render the world of world.h. */
typedef struct kind {
    const char *name;
    const bis_integrator *integrator;
    bis_sampler_kind sampler;
    bool learns, edges;
    double error;
    unsigned layers;
    const double *crop;
} kind;

/* w must stay where it is; clear_world frees it. */
void make_kind(world *w, const kind *k);

/* A render of its own: fresh film, fresh workspace. c: NULL, or what to keep, to go on from, and to identify the render
 * by; it is cleared. */
bis_status try_render(bis_film *f, bis_render_result *result, const world *w, const kind *k,
                      bis_render_options options, bis_checkpoint *c, bis_diag *diag);

void assert_same_film(const bis_film *a, const bis_film *b);
void assert_same_result(const bis_render_result *a, const bis_render_result *b);

/* Makes the checksum, the last 8 bytes of data[size], that of the others. */
void seal(unsigned char *data, size_t size);

#endif
