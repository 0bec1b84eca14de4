/* SPDX-License-Identifier: BSD-2-Clause */
/* threads: can the system start as many as a render wants? libgomp ends the program where it cannot, without a way back
 * for a library, so the question comes first. */
#pragma once

#include "bis/base/status.h"

/* bis_threads_check starts the threads that a render by n threads needs besides the calling one, all at once, and ends
 * them again: n - 1 for OpenMP and n - 1 for Embree. n = 0: all processors. It takes some 20 us a thread.
 * Fails: BIS_NOMEM, if the system refuses one of them. */
bis_status bis_threads_check(int n, bis_loc loc, bis_diag *diag);
