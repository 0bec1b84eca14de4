/* clock: seconds on a clock that nobody sets, and those that this thread has worked. For durations: their zeros mean
 * nothing. */
#ifndef BIS_CLOCK_H
#define BIS_CLOCK_H

#include <time.h>

static inline double bis_clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Waiting does not count, nor do other threads. A call of the system: half a microsecond. */
static inline double bis_clock_processor(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
