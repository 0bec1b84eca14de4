/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_settings: the table of settings that are measured, and what one of them is called. */
#pragma once

#include "trade.h"

/* bis_trade_list_settings makes the table: the scene's own setting, then all others that make sense for its light. */
void bis_trade_list_settings(bis_trade *t, bool small_map);

/* bis_trade_find_setting returns the index of the setting with this name, or -1. */
int bis_trade_find_setting(const bis_trade_plan *plan, const char *name);

/* bis_trade_is_rival returns whether an integrator is compared. `exact` and `unoccluded` are not, because one is a
 * reference and the other leaves the shadows out. */
bool bis_trade_is_rival(const bis_integrator *i);

/* bis_trade_judge_of returns which reference judges this setting: 0, by mis, or 1, by sir. It is never one of its own
 * family. */
int bis_trade_judge_of(const bis_trade_setting *s);

/* bis_trade_scene_text writes what differs from the defaults as a scene file says it, bis_trade_option_text as options
 * of the command line say it, or "" if there are none. */
void bis_trade_scene_text(char text[256], const bis_trade_setting *s, double scenes_b);
void bis_trade_option_text(char text[128], const bis_trade_setting *s, double scenes_b);
