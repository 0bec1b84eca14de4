/* SPDX-License-Identifier: BSD-2-Clause */
/* threads: all threads that were started wait at one mutex, so that they live at the same time. */
#include "bis/base/threads.h"

#include "bis/base/mem.h"

#include <pthread.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

static void *wait_at(void *gate)
{
    pthread_mutex_lock(gate);
    pthread_mutex_unlock(gate);
    return NULL;
}

bis_status bis_threads_check(int n, bis_loc loc, bis_diag *diag)
{
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    int error = 0;
    size_t started = 0;

#ifdef _OPENMP
    if (n == 0) n = omp_get_max_threads();
#else
    n = 1;
#endif
    const size_t wanted = 2 * ((size_t)n - 1);
    pthread_t *threads = bis_alloc(wanted, sizeof *threads);
    if (!threads) return bis_error(diag, BIS_NOMEM, loc, "no memory for %d threads", n);
    pthread_mutex_lock(&gate);
    while (started < wanted && !error) {
        error = pthread_create(&threads[started], NULL, wait_at, &gate);
        if (!error) started++;
    }
    pthread_mutex_unlock(&gate);
    for (size_t i = 0; i < started; i++) pthread_join(threads[i], NULL);
    bis_free(threads);
    if (!error) return BIS_OK;
    return bis_error(diag, BIS_NOMEM, loc,
                     "the system started %zu threads and no more (%s), but %d with Embree's take %zu: give --nthreads "
                     "a smaller number, or raise the limits of memory and processes (ulimit -v, ulimit -u)",
                     started, strerror(error), n, wanted);
}
