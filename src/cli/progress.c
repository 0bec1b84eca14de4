/* progress: the words of the line that `bis render` keeps writing anew on a terminal. */
#include "progress.h"

#include <math.h>
#include <stdio.h>

const char *bis_progress_duration(char buf[BIS_PROGRESS_DURATION], double seconds)
{
    if (seconds < 10) snprintf(buf, BIS_PROGRESS_DURATION, "%.2g s", seconds);
    else if (seconds < 120) snprintf(buf, BIS_PROGRESS_DURATION, "%.0f s", seconds);
    else if (seconds < 7200) snprintf(buf, BIS_PROGRESS_DURATION, "%.0f min", seconds / 60);
    else if (seconds < 172800) snprintf(buf, BIS_PROGRESS_DURATION, "%.1f h", seconds / 3600);
    else snprintf(buf, BIS_PROGRESS_DURATION, "%.3g days", seconds / 86400);
    return buf;
}

const char *bis_progress_text(char text[BIS_PROGRESS_TEXT], const bis_progress *p)
{
    const bool is_over = p->passes_total && p->passes_done >= p->passes_total;
    char left[BIS_PROGRESS_DURATION];
    int n = snprintf(text, BIS_PROGRESS_TEXT, "pass %u", is_over ? p->passes_total : p->passes_done + 1);

    if (p->passes_total) n += snprintf(text + n, BIS_PROGRESS_TEXT - (size_t)n, " of %u", p->passes_total);
    n += snprintf(text + n, BIS_PROGRESS_TEXT - (size_t)n, ", %.0f%%", 100 * p->share);
    if (isfinite(p->seconds_left)) {
        bis_progress_duration(left, ceil(p->seconds_left));
        snprintf(text + n, BIS_PROGRESS_TEXT - (size_t)n, ", %s left", left);
    }
    return text;
}
