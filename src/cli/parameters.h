/* SPDX-License-Identifier: BSD-2-Clause */
/* parameters: what the command line says of the integrators' parameters, from the table of bis/scene/parameters.h: the
 * options of `bis render`, and the words of --help and `bis help`. */
#pragma once

#include "bis/scene/parameters.h"
#include "cli.h"

enum { BIS_PARAMETER_OPTIONS = 16 /* rows of the table that are options */, BIS_PARAMETER_WORDS = 256 };

/* One row that the command line may set. Rows of one name share an option: the first holds its value. */
typedef struct bis_parameter_option {
    const bis_parameter *parameter;
    bool given;
    uint64_t count;
    const char *name; /* of a choice; "on" or "off" */
    const char *names[BIS_MAX_CHOICES + 1];
    char help[BIS_PARAMETER_WORDS];
} bis_parameter_option;

/* bis_parameter_options appends a row for each option to options[*n] and raises *n; values[] receives what the user
 * gives. */
void bis_parameter_options(bis_option *options, size_t *n, bis_parameter_option values[BIS_PARAMETER_OPTIONS]);

/* bis_parameter_given returns whether the user gave the option with this name. */
bool bis_parameter_given(const bis_parameter_option values[BIS_PARAMETER_OPTIONS], const char *name);

/* bis_parameter_override sets what the user gave. It warns of options that the integrator does not read. */
void bis_parameter_override(bis_settings *s, const bis_parameter_option values[BIS_PARAMETER_OPTIONS], bis_diag *diag);

/* bis_parameter_words writes who reads the parameter with this name, and what it is: "em, brdf, mis: light samples for
 * each camera sample". */
const char *bis_parameter_words(char buf[BIS_PARAMETER_WORDS], const char *name);

enum { BIS_INTEGRATOR_WORDS = 1024 };

/* bis_integrator_words writes what an integrator does, its parameters with their defaults, and its claim. */
const char *bis_integrator_words(char buf[BIS_INTEGRATOR_WORDS], const bis_integrator *integrator);
