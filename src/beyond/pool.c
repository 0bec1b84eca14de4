/* SPDX-License-Identifier: BSD-2-Clause */
/* pool: sets of stratified directions, drawn in parallel: their directions number i by a stream of their own, (seed, i,
 * pass, purpose "pool"). */
#include "bis/beyond/pool.h"

#include "thesis/light_many.h"

#include "bis/base/curve.h"
#include "bis/base/mem.h"

#include <assert.h>

static const uint64_t purpose_pool = 0x706f6f6c; /* no pixel's stream has it */

/* Many sets, because pixels with the same one share their luck. 2^18 directions are 7 MiB, which a pass fills in 20 ms
 * of one thread; at least 16 sets, so that long ones are not shared by all. */
enum { MIN_SETS = 16, MAX_SETS = 256, MAX_DIRECTIONS = 1 << 18 };

uint32_t bis_pool_needs(const bis_settings *s)
{
    bis_needs need = {0, 0, 0, 0};

    s->integrator->scratch_needs(s, &need);
    return need.n_set <= BIS_POOL_MAX_SET ? need.n_set : 0;
}

static bis_lanes choose(const bis_sets *sets, bis_stream *stream)
{
    const bis_pool *p = (const bis_pool *)sets; /* its first member */
    return bis_pool_set(p, bis_pool_choose(p, &stream->rng));
}

bis_status bis_pool_init(bis_pool *p, uint32_t M, bis_diag *diag)
{
    assert(M >= 1 && M <= BIS_POOL_MAX_SET);
    const uint32_t sets = MAX_DIRECTIONS / M;
    *p = (bis_pool){.sets = {choose}, .n_sets = sets < MIN_SETS ? MIN_SETS : sets > MAX_SETS ? MAX_SETS : sets, .M = M};
    p->lanes = bis_alloc((size_t)p->n_sets * BIS_LANES_ARRAYS * bis_lanes_round_up(M), sizeof *p->lanes);
    if (p->lanes) return BIS_OK;
    bis_pool_clear(p);
    return bis_error(diag, BIS_NOMEM, (bis_loc){0},
                     "no memory for %d sets of %u candidates; fewer candidates need less", MAX_SETS, (unsigned)M);
}

void bis_pool_clear(bis_pool *p)
{
    bis_free(p->lanes);
    *p = (bis_pool){.M = 0};
}

size_t bis_pool_bytes(const bis_pool *p)
{
    return (size_t)p->n_sets * BIS_LANES_ARRAYS * bis_lanes_round_up(p->M) * sizeof *p->lanes;
}

/* Directions number i of all sets: all in the same M-th of the curve, so that the CDF and the map are read in one place
 * (80 ns a direction; set by set, 250). */
static void draw_stratum(bis_pool *p, uint32_t i, const bis_light *light, bis_rng *rng)
{
    const double unit = bis_light_mean(light);

    for (uint32_t set = 0; set < p->n_sets; set++) {
        const double t = bis_stratum(i, bis_rng_double(rng), p->M);
        const double u[2] = {bis_rng_double(rng), bis_rng_double(rng)};
        bis_light_point y;
        const bool drawn = bis_light_sample_curve(light, t, u, &y);
        assert(drawn);
        (void)drawn;
        const bis_lanes x = bis_pool_set(p, set);
        bis_lanes_put(&x, i, &y, unit);
    }
}

static void fill_last_block(const bis_pool *p, uint32_t set)
{
    const bis_lanes l = bis_pool_set(p, set);

    for (uint32_t i = p->M; i < bis_lanes_round_up(p->M); i++) bis_lanes_put(&l, i, NULL, 1);
}

void bis_pool_fill(bis_pool *p, const bis_light *light, uint64_t seed, uint32_t pass, int n_threads)
{
    (void)n_threads; /* a compiler without OpenMP has one thread */
#pragma omp parallel for schedule(static) num_threads(n_threads)
    for (uint32_t i = 0; i < p->M; i++) {
        bis_rng rng;
        bis_rng_init(&rng, seed, i, pass, purpose_pool);
        draw_stratum(p, i, light, &rng);
    }
    for (uint32_t set = 0; set < p->n_sets; set++) fill_last_block(p, set);
}
