/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_help: a scene of the text that a test gives, parsed and built. The text stands in scratch("scene.txt"). */
#ifndef TESTS_SCENE_HELP_H
#define TESTS_SCENE_HELP_H

#include "bis/scene/scene.h"

typedef struct built {
    bis_scene_desc *desc;
    bis_scene *scene;
    bis_diag diag;
} built;

/* scene_parse parses the text, scene_try builds it, too. Messages go to b->diag. */
bis_status scene_parse(built *b, const char *text);
bis_status scene_try(built *b, const char *text);

/* scene_assert fails with the messages of *b if the status is not BIS_OK. */
void scene_assert(const built *b, bis_status status);

/* scene_build does what scene_try does, and fails with its messages. */
built scene_build(const char *fmt, ...) BIS_PRINTF(1, 2);

void scene_clear(built *b);

#endif
