/* SPDX-License-Identifier: BSD-2-Clause */
/* template: a page with holes, filled with the values of a JSON object. The page is a file of its own, which a browser
 * shows with the examples that stand in the holes.
 *
 *     [[name|example]]                                     the value of "name", as text
 *     <!--each name-->A<!--else name-->B<!--end name-->    A for each item of a list, or once for what is not empty;
 *                                                          else B, which may be missing
 *     <!-- other comments -->                              are left out
 *
 * In a style sheet the marks are written as CSS comments: each, else and end between slash-star and star-slash. Within
 * A, names are those of the item, if it is an object; the item itself is [[.|example]]. Empty are false, null, "", 0,
 * {} and []. A section must not stand in another one of the same name. */
#pragma once

#include "bis/base/status.h"

#include <stdio.h>

/* bis_template_fill prints page with its holes filled from json, an object that bis_json has written. Errors:
 * BIS_INPUT (the page has a name that the object lacks, or a section without its end). */
bis_status bis_template_fill(FILE *out, const char *page, const char *json, bis_diag *diag);
