/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_scene: the scene with all its lights, and one render of it. */
#pragma once

#include "trade.h"

/* bis_trade_interrupted returns whether the user has interrupted the measurement. */
bool bis_trade_interrupted(const bis_trade *t);

/* bis_trade_tell tells the caller's progress, if there is one. */
void bis_trade_tell(const bis_trade *t, const char *what, double share, double seconds_left);

/* bis_trade_load parses the scene, applies the options, and builds everything that the settings need. bis_trade_unload
 * frees it. Errors: BIS_INPUT, BIS_IO, BIS_NOMEM. */
bis_status bis_trade_load(bis_trade *t, bis_diag *diag);
void bis_trade_unload(bis_trade *t);

/* bis_trade_film returns the film that is measured, of each step x step pixels one; step 0: a film of one pixel that
 * sees all. bis_trade_pixels returns how many pixels it has. */
bis_film bis_trade_film(const bis_trade *t, int step);
double bis_trade_pixels(const bis_trade *t, int step);

/* One render: `passes` with a setting, into the film of each step x step pixels one. */
typedef struct bis_trade_job {
    const bis_trade_setting *setting;
    int step;
    uint32_t passes;
    uint64_t seed;
} bis_trade_job;

/* bis_trade_render renders a job. image may be NULL; it need not be initialised, and the caller clears it. An
 * interrupted render leaves result->passes < job->passes. Errors: those of bis_render. */
bis_status bis_trade_render(bis_trade *t, const bis_trade_job *job, bis_image *image, bis_render_result *result,
                            bis_diag *diag);
