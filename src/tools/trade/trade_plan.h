/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_plan: what is measured, for how long, and by which reference. */
#pragma once

#include "trade.h"

/* bis_trade_make_plan runs the pilot and makes the plan. Errors: BIS_INPUT, BIS_NOMEM. */
bis_status bis_trade_make_plan(bis_trade *t, bis_diag *diag);

/* bis_trade_fit_plan fits the plan to `left` seconds: its size, levels, run_seconds and references, from what the pilot
 * found: pass_seconds of a pixel, which become those of a pass, and pass_relmse. Errors: BIS_INPUT. */
bis_status bis_trade_fit_plan(bis_trade *t, double left, bis_diag *diag);

/* bis_trade_planned_runs returns the number of runs of the plan, bis_trade_planned_seconds what one of them takes. */
size_t bis_trade_planned_runs(const bis_trade_plan *plan);
double bis_trade_planned_seconds(const bis_trade_plan *plan, int setting, int level);

/* bis_trade_may_be_reference returns whether the setting may make reference 0 (a mis) or 1 (a sir). */
bool bis_trade_may_be_reference(const bis_trade_setting *s, int which);
