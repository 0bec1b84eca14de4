/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_stats: means, errors and the best settings, from the runs. */
#pragma once

#include "trade.h"

/* bis_trade_summarise computes t->result of the runs. Errors: BIS_NOMEM. */
bis_status bis_trade_summarise(bis_trade *t, bis_diag *diag);

/* bis_trade_error_at returns the error of a setting after so many seconds, bis_trade_seconds_to the seconds to an
 * error: by interpolation between budgets in log-log; beyond the longest by the root law, *extrapolated. NAN below one
 * pass, or for a biased setting beyond its measurements. */
double bis_trade_error_at(const bis_trade_result *r, const bis_trade_plan *plan, int setting, double seconds,
                          bool *extrapolated);
double bis_trade_seconds_to(const bis_trade_result *r, const bis_trade_plan *plan, int setting, double error,
                            bool *extrapolated);

/* bis_trade_best_of returns the setting of an integrator with the least cost x variance, its standard error added;
 * NULL: of all that are unbiased. -1: none was measured. */
int bis_trade_best_of(const bis_trade *t, const char *integrator);

/* bis_trade_heads stores the best of each integrator and the scene's own, in the order of the table, those that were
 * measured. It returns how many. */
int bis_trade_heads(const bis_trade *t, int setting[BIS_TRADE_STRIP]);

/* bis_trade_is_head returns whether setting is one of bis_trade_heads. */
bool bis_trade_is_head(const bis_trade *t, int setting);

enum { BIS_TRADE_COLUMNS = 6 };

/* bis_trade_times stores the columns of the table by time, bis_trade_errors those of the table by error: each at most
 * so many, ascending. They return how many. */
int bis_trade_times(const bis_trade *t, double seconds[BIS_TRADE_COLUMNS]);
int bis_trade_errors(const bis_trade *t, double error[BIS_TRADE_COLUMNS]);
