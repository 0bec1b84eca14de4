/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_tables: the tables that are written into the folder. */
#pragma once

#include "trade.h"

/* bis_trade_write_tables writes the tables of the folder. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_trade_write_tables(const bis_trade *t, bis_diag *diag);

/* bis_trade_next_on_front returns the point of the Pareto front that is next in time after last (NULL: the first), or
 * NULL. Of equal ones both come. */
const bis_trade_point *bis_trade_next_on_front(const bis_trade_result *r, const bis_trade_point *last);
