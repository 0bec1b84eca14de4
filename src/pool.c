/* pool: sets of stratified directions, drawn in parallel, each by a stream of its own: (seed, set, pass, purpose "pool"). */
#include "bis/pool.h"

#include "bis/curve.h"
#include "bis/mem.h"

#include <assert.h>

static const uint64_t purpose_pool = 0x706f6f6c; /* no pixel's stream has it */

enum { MIN_SETS = 16, MAX_SETS = 256, MAX_DIRECTIONS = 1 << 18 };

bis_status bis_pool_init(bis_pool *p, uint32_t M, bis_diag *diag)
{
    assert(M >= 1 && M <= BIS_POOL_MAX_SET);
    uint32_t sets = MAX_DIRECTIONS / M;
    p->n_sets = sets < MIN_SETS ? MIN_SETS : sets > MAX_SETS ? MAX_SETS : sets;
    p->M = M;
    p->y = bis_alloc((size_t)p->n_sets * M, sizeof *p->y);
    if (p->y) return BIS_OK;
    *p = (bis_pool){.M = 0};
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %d sets of %u candidates; fewer candidates need less", MAX_SETS, (unsigned)M);
}

void bis_pool_clear(bis_pool *p)
{
    bis_free(p->y);
    *p = (bis_pool){.M = 0};
}

size_t bis_pool_bytes(const bis_pool *p) { return (size_t)p->n_sets * p->M * sizeof *p->y; }

void bis_pool_fill(bis_pool *p, const bis_light *light, uint64_t seed, uint32_t pass, int n_threads)
{
    (void)n_threads; /* a compiler without OpenMP has one thread */
    (void)n_threads; /* without OpenMP there is one */
#pragma omp parallel for schedule(static) num_threads(n_threads)
    for (uint32_t set = 0; set < p->n_sets; set++) {
        bis_light_point *y = p->y + (size_t)set * p->M;
        bis_rng rng;
        bis_rng_init(&rng, seed, set, pass, purpose_pool);
        for (uint32_t i = 0; i < p->M; i++) {
            double t = bis_stratum(i, bis_rng_double(&rng), p->M);
            double u[2] = {bis_rng_double(&rng), bis_rng_double(&rng)};
            bool drawn = bis_light_sample_curve(light, t, u, &y[i]);
            assert(drawn);
            (void)drawn;
        }
    }
}
