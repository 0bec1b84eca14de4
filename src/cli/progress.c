/* SPDX-License-Identifier: BSD-2-Clause */
/* progress: the words of the line that `bis render` keeps writing anew on a terminal. */
#include "progress.h"

#include "base/text.h"

const char *bis_progress_text(char text[BIS_PROGRESS_TEXT], const bis_progress *p)
{
    const bool is_over = p->passes_total && p->passes_done >= p->passes_total;
    char left[BIS_DURATION];
    int n = snprintf(text, BIS_PROGRESS_TEXT, "pass %u", is_over ? p->passes_total : p->passes_done + 1);

    if (p->passes_total) n += snprintf(text + n, BIS_PROGRESS_TEXT - (size_t)n, " of %u", p->passes_total);
    n += snprintf(text + n, BIS_PROGRESS_TEXT - (size_t)n, ", %.0f%%", 100 * p->share);
    if (isfinite(p->seconds_left)) {
        bis_duration(left, ceil(p->seconds_left));
        snprintf(text + n, BIS_PROGRESS_TEXT - (size_t)n, ", %s left", left);
    }
    return text;
}
