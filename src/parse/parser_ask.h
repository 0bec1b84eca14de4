/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_ask: what a directive asks of its parameters and of its name. What nobody has asked for is an error in the end
 * (bis_params_end). */
#pragma once

#include "parser.h"

/* [lo, hi], without its ends where they are open; HUGE_VAL: no such end. */
typedef struct bis_interval {
    double lo, hi;
    bool lo_open, hi_open;
} bis_interval;

/* bis_parser_in_range returns whether *value lies in the range. If not, it complains. With --approximate it takes the
 * range's end instead, if that is part of the range, and returns true. */
bool bis_parser_in_range(bis_parser *p, bis_loc at, const char *name, double *value, bis_interval range);

/* bis_params_take returns the parameter with this name if it has one of these types and `count` values (0: any number
 * but none). It returns NULL if it is not given, or after a complaint. */
const bis_param *bis_params_take(bis_parser *p, const char *name, unsigned types, size_t count);

/* bis_params_float asks for a number in a range, as the next ones ask for n numbers, a whole number, a bool, a string,
 * a colour. Each returns true and stores *value if the parameter is given and right. It returns false if it is absent,
 * or after a complaint; *value is then untouched. */
bool bis_params_float(bis_parser *p, const char *name, double *value, bis_interval range);
bool bis_params_floats(bis_parser *p, const char *name, double *values, size_t n, bis_interval range);
bool bis_params_integer(bis_parser *p, const char *name, uint64_t *value, uint64_t lo, uint64_t hi);
bool bis_params_uint32(bis_parser *p, const char *name, uint32_t *value, uint32_t lo, uint32_t hi);
bool bis_params_bool(bis_parser *p, const char *name, bool *value);
bool bis_params_string(bis_parser *p, const char *name, const char **value);
bool bis_params_rgb(bis_parser *p, const char *name, rgb *value, bis_interval range, bool or_float);

/* bis_params_choice asks for a string that is one of choices[n], and stores its index. */
bool bis_params_choice(bis_parser *p, const char *name, int *value, const char *const *choices, size_t n);

/* bis_params_has returns whether the parameter is given. */
bool bis_params_has(bis_parser *p, const char *name);

/* bis_params_at returns the place of the parameter, or that of the directive's name if it is not given. */
bis_loc bis_params_at(bis_parser *p, const char *name);

/* bis_params_skip takes parameters of pbrt's that do not matter, names[n], without a word. */
void bis_params_skip(bis_parser *p, const char *const *names, size_t n);

/* bis_params_ignore passes over the directive's parameters that `bis` ignores. The first time each has a warning, which
 * says what changes by it. */
void bis_params_ignore(bis_parser *p, const char *directive);

/* bis_params_end complains of all parameters that nobody asked for. what: `Camera "perspective"`. */
void bis_params_end(bis_parser *p, const char *directive, const char *what);

/* What a directive's name stands for. */
enum { BIS_REPLACED = -1, BIS_FOREIGN = -2 };
typedef struct bis_choice {
    const char *name;
    int value; /* >= 0: ours; BIS_REPLACED: pbrt's, replaced by what the caller says; BIS_FOREIGN: pbrt's, an error */
} bis_choice;

/* bis_parser_choose returns the choice called name, or NULL after a complaint. */
const bis_choice *bis_parser_choose(bis_parser *p, const char *directive, const char *name, bis_loc at,
                                    const bis_choice *choices, size_t n);

/* bis_parser_begin reads a directive's name and parameters. It returns the choice of that name, or NULL after a
 * complaint. */
const bis_choice *bis_parser_begin(bis_parser *p, const char *directive, const bis_choice *choices, size_t n);

/* bis_parser_single warns if the directive is given again. */
void bis_parser_single(bis_parser *p, bis_single which, const char *directive, bis_loc at);

/* ---- parser_convert.c ---- */

/* bis_params_mean stores the mean of the texture that a parameter names, where a colour or a number is asked for. It
 * returns false without --approximate, and where the parameter is no texture. */
bool bis_params_mean(bis_parser *p, const char *name, rgbd *value);

/* bis_parser_convert makes of *param one of the types `wanted`, where it can; else it leaves it as it is. */
void bis_parser_convert(bis_parser *p, bis_param *param, unsigned wanted);
