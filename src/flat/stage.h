/* SPDX-License-Identifier: BSD-2-Clause */
/* stage: what is behind a bis_flat_stage. flat_stage.c answers the figures that live, flat_stage_more.c and
 * flat_stage_about.c those who measure. */
#pragma once

#include "bis/flat/stage.h"
#include "tools/pixel/pixel.h"

struct bis_flat_stage {
    bis_scene_desc *own_desc; /* NULL: the scene is another's, who keeps it open */
    bis_scene *own_scene;
    bis_light *own_light; /* NULL: that of the scene */
    /* The scene, its description, and that with the settings of one question. They share all that the scene owns. */
    bis_scene scene;
    bis_scene_desc desc, asked;
    bis_counters counters;
    int x, y;
    bool is_chosen, is_hit; /* is_chosen: there is a pixel; is_hit: it sees a surface */
    bis_pixel_hit hit;
    bis_point pt;
    bool knows_exact;
    uint64_t exact_seed;
    bis_pixel_exact exact;
    char *about; /* of open_memstream */
};

/* bis_flat_stage_hit checks that a pixel was chosen and sees a surface. Errors: BIS_INPUT. */
bis_status bis_flat_stage_hit(const bis_flat_stage *stage, bis_diag *diag);

/* bis_flat_stage_ask does the same, and sets stage->asked to the scene with these settings. Errors: BIS_INPUT. */
bis_status bis_flat_stage_ask(bis_flat_stage *stage, const char *const *settings, bis_diag *diag);

/* bis_flat_stage_sir checks that stage->asked is of sir, with at most `room` candidates. Errors: BIS_INPUT. */
bis_status bis_flat_stage_sir(const bis_flat_stage *stage, size_t room, bis_diag *diag);

/* bis_flat_stage_know computes stage->exact, unless it is known for this seed. Errors: BIS_INPUT, BIS_NOMEM. */
bis_status bis_flat_stage_know(bis_flat_stage *stage, uint64_t seed, bis_diag *diag);

/* bis_flat_stage_field checks the sides of a field of directions. Errors: BIS_INPUT (outside [1, 4096]). */
bis_status bis_flat_stage_field(int columns, int rows, bis_diag *diag);
