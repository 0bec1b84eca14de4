/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_words: how the page and the command say a duration, an error and a setting; the order of the Pareto front. */
#include "trade_page.h"

#include <stdarg.h>
#include <string.h>

/* "a=1; b=x" as members. */
BIS_PRINTF(2, 0)
static void put_members(bis_json *j, const char *format, va_list args)
{
    char text[768];

    vsnprintf(text, sizeof text, format, args);
    for (char *at = text, *next; at; at = next) {
        char *value = strchr(at, '=');
        next = strstr(at, "; ");
        if (next) *next = '\0', next += 2;
        *value = '\0';
        bis_json_text(j, at, value + 1);
    }
}

void bis_trade_say(bis_json *j, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    put_members(j, format, args);
    va_end(args);
}

void bis_trade_say_all(bis_json *j, const char *key, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    bis_json_open(j, key, '{');
    put_members(j, format, args);
    bis_json_close(j);
    va_end(args);
}

void bis_trade_put_name(bis_json *j, const bis_trade_setting *s)
{
    bis_trade_say(j, "method=%s; name=%s", s->settings.integrator->name, s->name);
    bis_json_open(j, "notes", '[');
    if (s->is_scenes && !strstr(s->name, "own")) bis_json_text(j, NULL, "the scene's");
    if (s->is_biased) bis_json_text(j, NULL, "biased");
    bis_json_close(j);
}

const bis_trade_point *bis_trade_next_on_front(const bis_trade_result *r, const bis_trade_point *last)
{
    const bis_trade_point *next = NULL;
    for (int i = 0; i < r->n_points; i++) {
        const bis_trade_point *p = &r->points[i];
        const bool is_later = !last || p->seconds > last->seconds || (p->seconds == last->seconds && p > last);
        if (p->on_front && is_later && (!next || p->seconds < next->seconds)) next = p;
    }
    return next;
}

bool bis_trade_is_head(const bis_trade *t, int setting)
{
    int heads[BIS_TRADE_STRIP];
    for (int i = bis_trade_heads(t, heads) - 1; i >= 0; i--)
        if (heads[i] == setting) return true;
    return false;
}
