/* SPDX-License-Identifier: BSD-2-Clause */
/* threads: with how many threads OpenMP works from now on; a compiler without it has one. */
#pragma once

#ifdef _OPENMP
#include <omp.h>
#endif

/* With how many threads a picture is made if n are asked for. */
static inline int threads_of(int n)
{
#ifdef _OPENMP
    return n;
#else
    (void)n;
    return 1;
#endif
}

/* Returns the number before. */
static inline int use_threads(int n)
{
#ifdef _OPENMP
    const int before = omp_get_max_threads();
    omp_set_num_threads(n);
    return before;
#else
    (void)n;
    return 1;
#endif
}
