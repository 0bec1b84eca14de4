/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_page: the parts that write the values of the report's page (src/tools/trade/page.html) as JSON. */
#pragma once

#include "trade.h"

#include "out/json.h"

/* page.html, as make puts it into the program. */
extern const char bis_trade_page[];

/* --- trade_page.c --- */

/* bis_trade_put_values writes all values of the page, an object. Errors: BIS_NOMEM. */
bis_status bis_trade_put_values(FILE *out, const bis_trade *t, bis_diag *diag);

/* --- trade_words.c --- */

/* bis_trade_say writes members as texts: "x=%.1f; y=%s" becomes "x": "1.0", "y": "...". format is printf's; all of it
 * has at most 767 bytes, and no value holds "; ". bis_trade_say_all writes an object of such members. */
void bis_trade_say(bis_json *j, const char *format, ...) BIS_PRINTF(2, 3);
void bis_trade_say_all(bis_json *j, const char *key, const char *format, ...) BIS_PRINTF(3, 4);

/* bis_trade_put_name writes the members that name a setting: "method", "name", and "notes", a list of what it is. */
void bis_trade_put_name(bis_json *j, const bis_trade_setting *s);

/* bis_trade_is_head returns whether setting is one of bis_trade_heads. */
bool bis_trade_is_head(const bis_trade *t, int setting);

/* --- trade_plot.c --- */

/* bis_trade_put_plot writes error over time, or over rays for each pixel, as an object. */
void bis_trade_put_plot(bis_json *j, const bis_trade *t, bool by_rays);

/* --- trade_strips.c --- */

/* bis_trade_put_strip writes the member "strip": the pictures of equal time, their enlarged parts, and the slider's
 * choice; null where there are none. */
void bis_trade_put_strip(bis_json *j, const bis_trade *t);

/* bis_trade_put_pictures writes the members "ratio" and "pictures". Each picture is there once: ref, and p0, e0, p1,
 * e1, ... of the strip with their errors. Errors: BIS_NOMEM. */
bis_status bis_trade_put_pictures(bis_json *j, const bis_trade *t, bis_diag *diag);
