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

/* bis_approximate_note counts one replacement of a kind ("3 x KIND: CONSEQUENCE"). consequence: a string constant. */
void bis_approximate_note(bis_parser *p, bis_loc at, const char *consequence, const char *fmt, ...) BIS_PRINTF(4, 5);

/* bis_approximate_or_refuse counts one replacement of a kind with --approximate, and returns true. Without it the
 * message is an error, ended by "; with --approximate: CONSEQUENCE". consequence: a string constant. */
bool bis_approximate_or_refuse(bis_parser *p, bis_loc at, const char *kind, const char *consequence, const char *fmt,
                               ...) BIS_PRINTF(5, 6);

/* ---- approximate_materials.c ---- */

/* bis_approximate_material returns the nearest material to pbrt's `name`, by the parameters that are read. index: that
 * of the material. "mix", and the interfaces of media, are made at the end. */
bis_material bis_approximate_material(bis_parser *p, const char *name, uint32_t index);

/* bis_approximate_finish mixes materials, leaves out the shapes of interfaces, and warns once of each kind. */
void bis_approximate_finish(bis_parser *p);

/* bis_approximate_clear frees what the parser keeps for it. */
void bis_approximate_clear(bis_parser *p);
