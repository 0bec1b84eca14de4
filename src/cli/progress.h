/* progress: how far a render is, in words. */
#ifndef BIS_CLI_PROGRESS_H
#define BIS_CLI_PROGRESS_H

#include "bis/render/render.h"

enum { BIS_PROGRESS_TEXT = 128, BIS_PROGRESS_DURATION = 32 };

/* bis_progress_text writes "pass 3 of 12, 20%, 6 min left" to text and returns it: the pass under way, after the last
 * one the last; what is not known is left out. */
const char *bis_progress_text(char text[BIS_PROGRESS_TEXT], const bis_progress *p);

/* bis_progress_duration writes a duration to buf and returns it, in the unit that keeps the number small: "90 s",
 * "6 min", "2.5 h", "12 days". */
const char *bis_progress_duration(char buf[BIS_PROGRESS_DURATION], double seconds);

#endif
