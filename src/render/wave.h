/* SPDX-License-Identifier: BSD-2-Clause */
/* wave: the camera samples of a tile, a few dozen at a time, step by step: all camera rays, all surfaces, the light of
 * all points, all shadow rays, the sums. For pass.c and workspace.c. */
#pragma once

#include "beyond/guide.h"
#include "bis/render/film.h"
#include "bis/render/render.h"
#include "bis/scene/scene.h"

#include <stdbool.h>

/* What a pass has made of a pixel so far. */
typedef struct bis_pixel_sum {
    rgbd L;         /* of its camera samples */
    uint32_t hits;  /* camera samples that hit geometry */
    uint32_t n;     /* camera samples */
    float *values;  /* of the layers; NULL: none */
    size_t cell;    /* of learned visibility that the pixel belongs to */
    const bis_settings *settings; /* of its camera samples; borrowed */
} bis_pixel_sum;

/* What all waves of a render share: all of it is borrowed. */
typedef struct bis_wave_task {
    const bis_scene *scene;
    const bis_scene_desc *desc;
    const bis_view *view;
    const bis_film *film;
    const bis_xform *to_camera;
    const bis_render_options *options;
} bis_wave_task;

/* A thread's own. */
typedef struct bis_wave bis_wave;

/* bis_wave_new allocates a thread's wave; NULL: no memory. scratch, guide and counters are borrowed. */
bis_wave *bis_wave_new(const bis_wave_task *task, bis_scratch *scratch, bis_product_guide *guide,
                       bis_counters *counters);
void bis_wave_free(bis_wave *wave);

/* bis_wave_bytes returns the bytes of a wave for a scene. */
size_t bis_wave_bytes(const bis_scene_desc *desc);

/* bis_wave_add notes camera sample `index` of the film's pixel (x, y). Its radiance is added to *pixel when the wave is
 * full, or by bis_wave_end, which must be called before *pixel is read. pixel is borrowed until then.
 * What is added does not depend on which samples share a wave. */
void bis_wave_add(bis_wave *wave, const bis_sampler *sampler, int x, int y, uint64_t index, bis_pixel_sum *pixel);
void bis_wave_end(bis_wave *wave);
