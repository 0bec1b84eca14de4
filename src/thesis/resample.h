/* resample: N marks over the running sum of the weights (thesis 4.4). candidates.c and src/beyond/batch.c share it,
 * because they walk along different sums. */
#pragma once

#include "bis/thesis/curve.h"
#include "bis/thesis/integrator.h"

/* N marks in [0,1), ascending. */
typedef struct bis_marks {
    bis_resampling kind;
    uint32_t N, j;
    double offset;   /* systematic: mark j = (j + offset)/N */
    double log_rest; /* multinomial: log(1 - mark) */
} bis_marks;

/* bis_marks_start prepares N marks. */
static inline bis_marks bis_marks_start(bis_resampling kind, uint32_t N, bis_stream *stream)
{
    bis_marks m = {.kind = kind, .N = N};

    if (kind == BIS_RESAMPLING_SYSTEMATIC) m.offset = bis_stream_random(stream);
    return m;
}

/* bis_marks_next returns the next mark. Systematic: one random number serves all marks. Multinomial: the marks are
 * the order statistics of N independent uniform numbers, made in ascending order (Bentley and Saxe 1980). Of the N -
 * j numbers above mark t, the smallest leaves a fraction (1-u)^(1/(N-j)) of 1 - t above itself. */
static inline double bis_marks_next(bis_marks *m, bis_stream *stream)
{
    uint32_t j = m->j++;

    if (m->kind == BIS_RESAMPLING_SYSTEMATIC) return bis_stratum(j, m->offset, m->N);
    m->log_rest += log1p(-bis_stream_random(stream)) / (double)(m->N - j);
    return -expm1(m->log_rest);
}
