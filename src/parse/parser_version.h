/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_version: which version of pbrt a scene is of; docs/scene-format.md, "Which version of pbrt". */
#pragma once

#include "parser.h"

/* bis_parser_find_version reads the words of the main scene, which the lexer is about to read, and of the files that it
 * includes, and decides p->version for all of them. p->desc->version says why. */
void bis_parser_find_version(bis_parser *p);

/* bis_parser_predates_v4 returns whether the scene is of pbrt-v1 to v3. */
static inline bool bis_parser_predates_v4(const bis_parser *p)
{
    return p->version == BIS_PBRT_V2 || p->version == BIS_PBRT_V3;
}

/* bis_parser_is_before_v4 returns whether `what` is to be read as pbrt-v1 to v3 read it. Where the scene does not tell
 * its version, it warns once of `what`, with both readings, and returns false. All three are string constants. */
bool bis_parser_is_before_v4(bis_parser *p, bis_loc at, const char *what, const char *as_v4, const char *before);
