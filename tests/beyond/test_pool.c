/* pool: directions drawn once for many pixels. Family-wise significance 1e-3 over all statistical tests here. */
#include "beyond/batch.h"
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "lit.h"


#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { SEED = 8154, RUNS = 400, PER_POOL = 25 };

static double alpha(void) { return stat_level(1e-3, 1 + 4 * 12); }

static vec3 tilted(void) { return normalize((vec3){0.3f, 0.1f, 1}); }

static bis_settings sir(bis_proposal proposal, uint32_t M, uint32_t N)
{
    bis_settings s = bis_settings_default(&bis_sir);
    s.proposal = proposal;
    s.candidates = M;
    s.shadowrays = N;
    return s;
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

    (void)state;
    assert_int_equal(bis_pool_init(&pool, M, false, NULL), BIS_OK);
    assert_int_equal(pool.n_sets, 256);
    for (uint32_t fill = 0; fill < FILLS; fill++) {
        bis_pool_fill(&pool, light, SEED, fill, 2);
        for (uint32_t set = 0; set < pool.n_sets; set++) {
            const bis_light_point *y = &pool.y[(size_t)set * M + (fill * pool.n_sets + set) % M]; /* one of a set: independent */
            observed[(y->wi.x > 0) + 2 * (y->wi.y > 0) + 4 * (y->wi.z > 0)]++;
            total++;
            assert_true(y->pdf > 0);
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
    bis_fast fast;
    bis_pool pool;

    for (int c = 0; c < 4; c++) m[c] = (stat_moments){0};
    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    assert_int_equal(bis_fast_init(&fast, s, NULL), BIS_OK);
    assert_int_equal(bis_fast_needs_of(s).n_pool, s->candidates);
    assert_int_equal(bis_pool_init(&pool, bis_fast_needs_of(s).n_pool, fast.batch != NULL, NULL), BIS_OK);
    fast.pool = &pool;
    scratch.sets = &pool.sets;
    scratch.fast = &fast;
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
    bis_fast_clear(&fast);
    bis_pool_clear(&pool);
}

static void sir_with_a_pool_is_unbiased(void **state)
{
    static const uint32_t Ms[] = {1, 2, 7, 64};
    const bis_material materials[] = {bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1),
                                      bis_phong((rgb){0, 0, 0}, (rgb){1, 0.8f, 0.6f}, 10),
                                      bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.5f, 0.5f, 0.5f}, 50)};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);

    (void)state;
    for (int i = 0; i < 4 * 3; i++) {
        const bis_settings s = sir(i / 4 == 0 ? BIS_PROPOSAL_EM : BIS_PROPOSAL_MIX, Ms[i % 4], 3);
        stat_moments m[4];
        lit l;
        lit_init(&l, light, materials[i / 4], tilted(), 40, LIT_HALF);
        const rgbd truth = lit_truth(&l, true);
        const double expected[4] = {truth.r, truth.g, truth.b, rgbd_sum(truth)};
        run_with_pools(m, &l, &s, NULL);
        for (int c = 0; c < 4; c++) stat_assert_mean("sir-pool", SEED, &m[c], expected[c], alpha());
    }
    bis_light_free(light);
}

/* Each odd direction replaced by its neighbour: every second piece of the map is forgotten. */
static void forget_odd_directions(bis_pool *p)
{
    for (size_t i = 0; i < (size_t)p->n_sets * p->M; i++)
        if (i % p->M % 2) p->y[i] = p->y[i - 1];
}

/* The first half of each set in place of the whole: the first n of a set are no fair sample of it. */
static void take_the_first_half(bis_pool *p)
{
    for (size_t i = 0; i < (size_t)p->n_sets * p->M; i++)
        if (i % p->M >= p->M / 2) p->y[i] = p->y[i - p->M / 2];
}

static void twins_with_unfair_sets_are_found(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = sir(BIS_PROPOSAL_EM, 8, 3);
    stat_moments m[4];
    lit l;

    (void)state;
    lit_init(&l, light, bis_phong((rgb){0.8f, 0.8f, 0.8f}, (rgb){0, 0, 0}, 1), tilted(), 40, LIT_OPEN);
    const double truth = rgbd_sum(lit_truth(&l, true));
    run_with_pools(m, &l, &s, forget_odd_directions);
    stat_assert_not_mean("sir-pool-odd", SEED, &m[3], truth, alpha());
    run_with_pools(m, &l, &s, take_the_first_half);
    stat_assert_not_mean("sir-pool-half", SEED, &m[3], truth, alpha());
    bis_light_free(light);
}

static void a_pool_is_a_function_of_seed_and_pass_alone(void **state)
{
    enum { M = 100 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    bis_pool a, b;

    (void)state;
    assert_int_equal(bis_pool_init(&a, M, true, NULL), BIS_OK);
    assert_int_equal(bis_pool_init(&b, M, true, NULL), BIS_OK);
    bis_pool_fill(&a, light, 1, 5, 1);
    bis_pool_fill(&b, light, 1, 5, 3);
    assert_memory_equal(a.y, b.y, (size_t)a.n_sets * M * sizeof *a.y);
    assert_memory_equal(a.lanes, b.lanes, bis_pool_bytes(&a) - (size_t)a.n_sets * M * sizeof *a.y);
    bis_pool_fill(&b, light, 1, 6, 1);
    assert_memory_not_equal(a.y, b.y, sizeof *a.y * M);
    bis_pool_fill(&b, light, 2, 5, 1);
    assert_memory_not_equal(a.y, b.y, sizeof *a.y * M);
    bis_pool_clear(&a);
    bis_pool_clear(&b);
    bis_light_free(light);
}

static void sets_become_fewer_as_they_become_larger(void **state)
{
    (void)state;
    static const uint32_t M[] = {1, 800, 1024, 1600, BIS_POOL_MAX_SET}, sets[] = {256, 256, 256, 163, 16};
    for (int i = 0; i < 5; i++) {
        bis_pool p;
        assert_int_equal(bis_pool_init(&p, M[i], false, NULL), BIS_OK);
        assert_int_equal(p.n_sets, sets[i]);
        bis_pool_clear(&p);
    }
    bis_pool p;
    bis_diag diag = {0};
    bis_mem_fail_at(1);
    assert_int_equal(bis_pool_init(&p, 8, true, &diag), BIS_NOMEM);
    bis_mem_fail_at(0);
    assert_int_equal(diag.n_errors, 1);
    bis_diag_clear(&diag);
    bis_pool_clear(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(directions_of_a_set_have_the_density_of_the_light),
        cmocka_unit_test(sir_with_a_pool_is_unbiased),
        cmocka_unit_test(twins_with_unfair_sets_are_found),
        cmocka_unit_test(a_pool_is_a_function_of_seed_and_pass_alone),
        cmocka_unit_test(sets_become_fewer_as_they_become_larger),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
