/* SPDX-License-Identifier: BSD-2-Clause */
/* auto_help: what the tests of auto and of its pilot share. Not a .c file, because a clock in place of the C library's
 * is for these two programs alone. */
#pragma once

#include "bis/shape/accel.h"
#include "bis/thesis/settings.h"

#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/* What a scene gets that names no integrator, as docs/scene-format.md has it. */
static bool is_usual(const bis_settings *s)
{
    return s->integrator == &bis_sir && s->proposal == BIS_PROPOSAL_PRODUCT && s->candidates == 64 && s->shadowrays == 24 && s->learn;
}

/* A clock that counts work, since what the pilot makes of a real one differs from run to run: of a picture so small the
 * few camera rays take less time than what disturbs a clock. While it goes, a thread's processor time is 1 us for each ray
 * that the thread has traced and 10 ns for each look at the clock. */
static bool counts_work;
static _Thread_local long worked; /* ns */

int clock_gettime(clockid_t id, struct timespec *t); /* in place of the C library's */

int clock_gettime(clockid_t id, struct timespec *t)
{
    if (!counts_work || id != CLOCK_THREAD_CPUTIME_ID) return (int)syscall(SYS_clock_gettime, id, t);
    worked += 10;
    *t = (struct timespec){worked / 1000000000, worked % 1000000000};
    return 0;
}

typedef struct counting_accel {
    bis_accel base;
    bis_accel *inner;
} counting_accel;

static bool counting_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    worked += 1000;
    return bis_accel_intersect(((const counting_accel *)a)->inner, r, hit);
}

static bool counting_occluded(const bis_accel *a, const ray *r)
{
    worked += 1000;
    return bis_accel_occluded(((const counting_accel *)a)->inner, r);
}

static const bis_accel_ops counting = {.name = "counting", .intersect = counting_intersect, .occluded = counting_occluded};
