/* SPDX-License-Identifier: BSD-2-Clause */
/* clock: a monotonic clock, and the processor time of a thread. Both are for durations: only differences of two
 * readings have a meaning. */
#pragma once

#include <time.h>

/* bis_clock_now returns the seconds of a monotonic clock that nobody sets. */
static inline double bis_clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* bis_clock_processor returns the seconds of processor time that this thread has used. Waiting does not count, nor do
 * other threads. One reading is a system call and costs half a microsecond. */
static inline double bis_clock_processor(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
