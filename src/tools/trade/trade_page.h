/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_page: the parts that write the values of the report's page (src/tools/trade/page.html) as JSON; docs/json.md
 * has each member. */
#pragma once

#include "trade.h"

#include "out/json.h"

/* page.html with its scripts, as make puts it into the program. */
extern const char bis_trade_page[];

/* --- trade_page.c --- */

/* bis_trade_put_values writes all values of the page, an object. Errors: BIS_NOMEM. */
bis_status bis_trade_put_values(FILE *out, const bis_trade *t, bis_diag *diag);

/* --- trade_strips.c --- */

/* bis_trade_put_pictures writes the members "crops", "reference" (a picture) and "shots", the pictures of equal time
 * with their errors; null and empty where there are none. Errors: BIS_NOMEM. */
bis_status bis_trade_put_pictures(bis_json *j, const bis_trade *t, bis_diag *diag);
