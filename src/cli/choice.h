/* SPDX-License-Identifier: BSD-2-Clause */
/* choice: what integrator "auto" becomes in `bis render`. */
#pragma once

#include "cli.h"
#include "render/checkpoint.h"
#include "tools/auto/auto.h"

/* bis_choice_make puts into desc->view.settings, on all ranks, what a checkpoint says that was chosen, or
 * else what a pilot chooses, and says so on standard error unless quiet. *choice is set on rank 0. Errors: those of
 * bis_auto_choose, of any rank. */
bis_status bis_choice_make(bis_auto_report *choice, const bis_scene *scene, bis_scene_desc *desc,
                           const bis_render_options *options, const bis_checkpoint *checkpoint, bool quiet,
                           bis_diag *diag);
