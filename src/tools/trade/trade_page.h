/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_page: the report's page and its pictures, and the parts that write the values of the page
 * (src/tools/trade/page.html) as JSON; docs/live.md has each member. */
#pragma once

#include "trade.h"

#include "out/json.h"

/* page.html with its scripts, as make puts it into the program. */
extern const char bis_trade_page[];

/* --- trade_page.c --- */

/* bis_trade_write_report writes report.html. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_trade_write_report(const bis_trade *t, bis_diag *diag);

/* bis_trade_print_summary prints what a user wants to know at once: the advice in short, and where the page is. */
void bis_trade_print_summary(FILE *out, const bis_trade *t);

/* --- trade_strips.c --- */

/* bis_trade_exposure sets *exposure to that of all pictures of the page: what `bis render` gives a PNG of the
 * reference, metered on the shapes and not on the background. t: loaded, with t->both. Errors: BIS_NOMEM. */
bis_status bis_trade_exposure(double *exposure, const bis_trade *t, bis_diag *diag);

/* bis_trade_put_pictures writes the members "crops", "reference" (a picture) and "shots", the pictures of equal time
 * with their errors; null and empty where there are none. Errors: BIS_NOMEM. */
bis_status bis_trade_put_pictures(bis_json *j, const bis_trade *t, bis_diag *diag);
