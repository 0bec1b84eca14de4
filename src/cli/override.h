/* SPDX-License-Identifier: BSD-2-Clause */
/* override: what the command line of `bis render` changes in a scene. */
#pragma once

#include "cli.h"
#include "parameters.h"

/* What the command line says; has_ tells whether it does. NULL, false or 0 elsewhere: it says nothing. */
typedef struct bis_override {
    const char *integrator, *accelerator, *layers;
    bis_texts as_printed;
    const char *light, *light_mapping;
    double light_rotate, light_scale;
    bool has_light_rotate, has_light_scale;
    bis_parameter_option parameters[BIS_PARAMETER_OPTIONS];
    bool no_jitter, transparent;
    bool has_spp, has_seed, has_resolution, has_crop;
    uint64_t spp, seed, threads;
    int resolution[2];
    double crop[4];
} bis_override;

/* bis_override_read_crop is the `read` of an option whose value is double[4]. "0.25,0.75,0,1": x0 < x1 and y0 < y1, all
 * in [0,1]. */
bool bis_override_read_crop(void *value, const char *text);

/* bis_override_scene changes *d, and the number of threads (bis_cli_use_threads). It warns of what has no effect.
 * Errors: BIS_INPUT (no such erratum or layer, settings that do not fit together, an accelerator that is not built
 * in). */
bis_status bis_override_scene(bis_scene_desc *d, const bis_override *o, bis_diag *diag);
