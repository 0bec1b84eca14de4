/* clock: seconds on a clock that nobody sets. For durations: its zero means nothing. */
#ifndef BIS_CLOCK_H
#define BIS_CLOCK_H

#include <time.h>

static inline double bis_clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
