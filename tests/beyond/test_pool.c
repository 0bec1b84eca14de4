/* SPDX-License-Identifier: BSD-2-Clause */
/* pool: directions drawn once for many pixels. Family-wise significance 1e-3 over all statistical tests here. */
#include "bis/base/mem.h"
#include "bis/beyond/pool.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "lit.h"
#include "set_help.h"

#include <string.h>

enum { SEED = 8154, RUNS = 400, PER_POOL = 25 };

static double alpha(void) { return stat_level(1e-3, 2 + 4 * 21); }

static vec3 tilted(void) { return normalize((vec3){0.3f, 0.1f, 1}); }

static bis_settings sir(bis_proposal proposal, uint32_t M, uint32_t N)
{
    return lit_settings(&bis_sir, proposal, M, N);
}

/* Every set has one direction in each M-th of the importance: the sets' directions number i all lie in the same piece
 * of the curve, so the i-th of all sets together, drawn often, fill the map as its density says. Count by quarter of
 * the sphere. */
static void directions_of_a_set_have_the_density_of_the_light(void **state)
{
    enum { M = 40, FILLS = 20, BINS = 8 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    double observed[BINS] = {0}, expected[BINS] = {0}, total = 0;
    bis_pool pool;

    assert_int_equal(bis_pool_init(&pool, M, NULL), BIS_OK);
    assert_int_equal(pool.n_sets, 256);
    for (uint32_t fill = 0; fill < FILLS; fill++) {
        bis_pool_fill(&pool, light, SEED, fill, 2);
        for (uint32_t set = 0; set < pool.n_sets; set++) {
            const bis_lanes y = bis_pool_set(&pool, set);
            const uint32_t i = (fill * pool.n_sets + set) % M; /* one of a set: independent */
            observed[(y.x[i] > 0) + 2 * (y.y[i] > 0) + 4 * (y.z[i] > 0)]++;
            total++;
            assert_true(fabs((double)y.q[i] / bis_light_pdf(light, (vec3){y.x[i], y.y[i], y.z[i]}) - 1) < 0x1p-23);
        }
    }
    for (size_t i = 0; i < bis_light_patches(light); i++) {
        bis_light_point s;
        bis_light_patch(light, i, (double[2]){0.5, 0.5}, &s);
        expected[(s.wi.x > 0) + 2 * (s.wi.y > 0) + 4 * (s.wi.z > 0)] += total * bis_light_pdf(light, s.wi) / s.pdf;
    }
    stat_assert_fit("pool", SEED, observed, expected, BINS, alpha());
    for (int i = 0; i < BINS; i++) expected[i] = total / BINS; /* twin: uniform */
    stat_assert_no_fit("pool-uniform", SEED, observed, expected, BINS, alpha());
    bis_pool_clear(&pool);
    bis_light_free(light);
}

/* Estimates by sir with pools; several points share a pool, as in a picture, and their mean is one value. spoil: a
 * wrong pool, for twins. */
static void run_with_pools(stat_moments m[4], lit *l, const bis_settings *s, void (*spoil)(bis_pool *))
{
    bis_scratch scratch;
    bis_pool pool;

    for (int c = 0; c < 4; c++) m[c] = (stat_moments){0};
    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    assert_int_equal(bis_pool_needs(s), s->candidates);
    assert_int_equal(bis_pool_init(&pool, s->candidates, NULL), BIS_OK);
    bis_scratch_share(&scratch, &pool.sets, NULL);
    for (uint32_t run = 0; run < RUNS; run++) {
        rgbd sum = {0, 0, 0};
        bis_pool_fill(&pool, l->light, SEED, run, 1);
        if (spoil) spoil(&pool);
        for (uint32_t k = 0; k < PER_POOL; k++) {
            rgb L = lit_once(l, s, &scratch, SEED, (uint64_t)run * PER_POOL + k);
            sum = rgbd_add(sum, (rgbd){(double)L.r / PER_POOL, (double)L.g / PER_POOL, (double)L.b / PER_POOL});
        }
        stat_add(&m[0], sum.r);
        stat_add(&m[1], sum.g);
        stat_add(&m[2], sum.b);
        stat_add(&m[3], rgbd_sum(sum));
    }
    bis_scratch_clear(&scratch);
    bis_pool_clear(&pool);
}

static void sir_with_a_pool_is_unbiased(void **state)
{
    static const uint32_t Ms[] = {1, 2, 7, 15, 16, 17, 64};
    const bis_material materials[] = {bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1),
                                      bis_phong((rgb){0, 0, 0}, (rgb){1, 0.8f, 0.6f}, 10),
                                      bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.5f, 0.5f, 0.5f}, 50)};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);

    for (int i = 0; i < 7 * 3; i++) {
        const bis_settings s = sir(i / 7 == 0 ? BIS_PROPOSAL_EM : BIS_PROPOSAL_MIX, Ms[i % 7], 3);
        stat_moments m[4];
        lit l;
        lit_init(&l, light, materials[i / 7], tilted(), 40, LIT_HALF);
        const rgbd truth = lit_truth(&l, true);
        const double expected[4] = {truth.r, truth.g, truth.b, rgbd_sum(truth)};
        run_with_pools(m, &l, &s, NULL);
        for (int c = 0; c < 4; c++) stat_assert_mean("sir-pool", SEED, &m[c], expected[c], alpha());
    }
    bis_light_free(light);
}

/* Direction i of every set becomes direction from(i, M). */
static void replace(bis_pool *p, uint32_t (*from)(uint32_t i, uint32_t M))
{
    const uint32_t padded = bis_lanes_round_up(p->M);

    for (uint32_t k = 0; k < p->n_sets * BIS_LANES_ARRAYS; k++) {
        for (uint32_t i = 0; i < p->M; i++) p->lanes[k * padded + i] = p->lanes[k * padded + from(i, p->M)];
    }
}

/* Each odd direction replaced by its neighbour: every second piece of the map is forgotten. The first half of each set
 * in place of the whole: the first n of a set are no fair sample of it. */
static uint32_t even_one(uint32_t i, uint32_t M) { (void)M; return i & ~1u; }
static uint32_t of_first_half(uint32_t i, uint32_t M) { return i % (M / 2); }
static void forget_odd_directions(bis_pool *p) { replace(p, even_one); }
static void take_the_first_half(bis_pool *p) { replace(p, of_first_half); }

/* As if beta were forgotten: weights phat/q_L in place of a mixture's q, twice as large. */
static void halve_densities(bis_pool *p)
{
    for (uint32_t set = 0; set < p->n_sets; set++) {
        for (uint32_t i = 0; i < p->M; i++) bis_pool_set(p, set).q[i] /= 2;
    }
}

static void twins_with_unfair_sets_are_found(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = sir(BIS_PROPOSAL_EM, 8, 3);
    stat_moments m[4];
    lit l;

    lit_init(&l, light, bis_phong((rgb){0.8f, 0.8f, 0.8f}, (rgb){0, 0, 0}, 1), tilted(), 40, LIT_OPEN);
    const double truth = rgbd_sum(lit_truth(&l, true));
    run_with_pools(m, &l, &s, forget_odd_directions);
    stat_assert_not_mean("sir-pool-odd", SEED, &m[3], truth, alpha());
    run_with_pools(m, &l, &s, take_the_first_half);
    stat_assert_not_mean("sir-pool-half", SEED, &m[3], truth, alpha());
    run_with_pools(m, &l, &s, halve_densities);
    stat_assert_not_mean("sir-pool-density", SEED, &m[3], truth, alpha());
    bis_light_free(light);
}

/* Of a shared set the n that the BRDF gets are not used. Their phase is random, and each direction is left out equally
 * often: n of M times. The twin leaves out the last ones. */
static void unused_directions_are_any_of_a_set_equally_often(void **state)
{
    enum { M = 20, SETS = 40000 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_settings s = sir(BIS_PROPOSAL_MIX, M, 3);
    double unused[M] = {0}, expected[M], last[M] = {0}, n = 0;
    bis_scratch scratch;
    bis_pool pool;
    lit l;

    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    assert_int_equal(bis_pool_init(&pool, M, NULL), BIS_OK);
    bis_pool_fill(&pool, light, SEED, 0, 1);
    bis_scratch_share(&scratch, &pool.sets, NULL);
    lit_init(&l, light, bis_phong(grey(0.3), grey(0.6), 50), tilted(), 40, LIT_OPEN);
    const bis_set *x = scratch.set;
    for (uint64_t run = 0; run < SETS; run++) {
        static const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
        bis_stream stream;
        bis_stream_init(&stream, &sampler, run, 0);
        assert_true(bis_set_draw(scratch.set, M, s.proposal, s.stratify, &l.pt, &stream));
        assert_true(x->map.n == M && x->brdf.n == x->n_unused && x->n_unused > 0 && x->n_unused < M);
        const uint32_t i = (uint32_t)(run % M); /* one of a set: independent of the others */
        unused[i] += !set_is_used(x, i);
        n = x->n_unused;
        uint32_t all = 0;
        for (uint32_t k = 0; k < M; k++) all += !set_is_used(x, k);
        assert_int_equal(all, x->n_unused);
    }
    double total = 0;
    for (int i = 0; i < M; i++) total += unused[i];
    for (int i = 0; i < M; i++) expected[i] = total / M, last[i] = i >= M - n ? total / n : 0;
    assert_true(fabs(total - SETS * n / M) < 5 * sqrt(SETS * n / M));
    stat_assert_fit("pool-unused", SEED, unused, expected, M, alpha());
    stat_assert_no_fit("pool-unused-last", SEED, last, expected, M, alpha());
    bis_scratch_clear(&scratch);
    bis_pool_clear(&pool);
    bis_light_free(light);
}

static void a_pool_is_a_function_of_seed_and_pass_alone(void **state)
{
    enum { M = 100 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    bis_pool a, b;

    assert_int_equal(bis_pool_init(&a, M, NULL), BIS_OK);
    assert_int_equal(bis_pool_init(&b, M, NULL), BIS_OK);
    bis_pool_fill(&a, light, 1, 5, 1);
    bis_pool_fill(&b, light, 1, 5, 3);
    assert_int_equal(bis_pool_bytes(&a), 256 * 7 * 112 * sizeof(float));
    assert_memory_equal(a.lanes, b.lanes, bis_pool_bytes(&a));
    bis_pool_fill(&b, light, 1, 6, 1);
    assert_memory_not_equal(a.lanes, b.lanes, sizeof(float) * M);
    bis_pool_fill(&b, light, 2, 5, 1);
    assert_memory_not_equal(a.lanes, b.lanes, sizeof(float) * M);
    bis_pool_clear(&a);
    bis_pool_clear(&b);
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(directions_of_a_set_have_the_density_of_the_light),
        cmocka_unit_test(sir_with_a_pool_is_unbiased),
        cmocka_unit_test(twins_with_unfair_sets_are_found),
        cmocka_unit_test(unused_directions_are_any_of_a_set_equally_often),
        cmocka_unit_test(a_pool_is_a_function_of_seed_and_pass_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
