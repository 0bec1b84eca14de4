/* SPDX-License-Identifier: BSD-2-Clause */
/* progress: how far a render is, in words. */
#pragma once

#include "bis/render/render.h"

enum { BIS_PROGRESS_TEXT = 128 };

/* bis_progress_text writes "pass 3 of 12, 20%, 6.3 min left" to text and returns it: the pass under way, after the last
 * one the last; what is not known is left out. */
const char *bis_progress_text(char text[BIS_PROGRESS_TEXT], const bis_progress *p);
