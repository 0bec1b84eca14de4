/* SPDX-License-Identifier: BSD-2-Clause */
/* approximate: `--approximate`: what bis does not model is replaced by the nearest that it does, and each replacement
 * is noted in the description of the scene (bis_approximation). For src/parse alone.
 *
 * One table (approximate.c) has all that is replaced, with the consequence for the picture: the same words end the
 * error without --approximate, and stand in the list with it. */
#pragma once

#include "parser.h"

/* bis_approximate asks whether `directive` "name" may be replaced: it stands in the table (name NULL: any), and
 * --approximate is given. Then it is noted. */
bool bis_approximate(bis_parser *p, const char *directive, const char *name, bis_loc at);

/* bis_approximate_hint returns `; --approximate leaves it out: ...`, the end of the error without --approximate, or "".
 * It lasts until it is asked for the next. */
const char *bis_approximate_hint(bis_parser *p, const char *directive, const char *name);

/* bis_approximate_begin counts a directive among the lights, shapes, materials or textures of the scene. It returns its
 * name as a constant, or "" for others, and without --approximate, because then there is no list. */
const char *bis_approximate_begin(bis_parser *p, const char *directive);

/* bis_approximate_unknown asks whether `directive` may have a name that pbrt does not know either: --approximate is
 * given. Then it is noted, and the name to take instead is returned; else NULL. */
const char *bis_approximate_unknown(bis_parser *p, const char *directive, const char *name, bis_loc at);

/* bis_approximate_unknown_hint returns the end of the error of an unknown name, as bis_approximate_hint does. */
const char *bis_approximate_unknown_hint(bis_parser *p, const char *directive);

/* bis_approximate_note counts one replacement of a kind ("3 x KIND: CONSEQUENCE"). consequence: a string constant. The
 * effect is that of the directive that is read. */
void bis_approximate_note(bis_parser *p, bis_loc at, const char *consequence, const char *fmt, ...) BIS_PRINTF(4, 5);

/* bis_approximate_path returns what bis_parser_path does of a file that --approximate can do without; the complaint
 * says so. *lacks becomes whether it does without: then it returns NULL and has noted it. */
char *bis_approximate_path(bis_parser *p, bool *lacks, bis_loc at, const char *name, const bis_stand_in *other);

/* bis_approximate_integrator notes what the picture lacks because pbrt's integrator `name` is not there. */
void bis_approximate_integrator(bis_parser *p, bis_loc at, const char *directive, const char *name);

/* bis_approximate_sky notes that the scene got a sky that it does not have. */
void bis_approximate_sky(bis_parser *p);

/* bis_approximate_pass counts what pbrt-v1 to v3 let pass without a word, and bis, too: with --approximate in the list
 * of replacements, else with one warning for each kind. consequence: a string constant. */
void bis_approximate_pass(bis_parser *p, bis_loc at, const char *consequence, const char *fmt, ...) BIS_PRINTF(4, 5);

/* bis_approximate_or_refuse counts one replacement of a kind with --approximate, and returns true. Without it the
 * message is an error, ended by "; with --approximate: CONSEQUENCE". consequence: a string constant. */
bool bis_approximate_or_refuse(bis_parser *p, bis_loc at, const char *kind, const char *consequence, const char *fmt,
                               ...) BIS_PRINTF(5, 6);

/* ---- approximate_materials.c ---- */

/* bis_approximate_material returns the nearest material to pbrt's `name`, by the parameters that are read. index: that
 * of the material. "mix", and the interfaces of media, are made at the end. */
bis_material bis_approximate_material(bis_parser *p, const char *name, uint32_t index);

/* bis_approximate_finish_materials mixes materials and leaves out the shapes of interfaces. */
void bis_approximate_finish_materials(bis_parser *p);

/* ---- approximate.c ---- */

/* bis_approximate_finish sorts the list by effect, and warns once of each kind. */
void bis_approximate_finish(bis_parser *p);

/* bis_approximate_clear frees what the parser keeps for it. */
void bis_approximate_clear(bis_parser *p);
