/* SPDX-License-Identifier: BSD-2-Clause */
/* stage: what is behind a bis_flat_stage. flat_stage.c chooses the point and looks into directions, flat_methods.c runs
 * methods there, flat_stage_about.c describes it. src/tools/pixel computes what `bis pixel` prints, too. */
#pragma once

#include "bis/flat/stage.h"
#include "flat/wishes.h"
#include "tools/pixel/pixel.h"

struct bis_flat_stage {
    bis_flat_scene own;   /* empty: the scene is another's, who keeps it open */
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
