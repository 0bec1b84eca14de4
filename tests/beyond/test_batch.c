/* batch: sir with candidates side by side against sir with candidates one by one, lane by lane where the random numbers
 * are chosen, in the mean where they are not. Family-wise significance 1e-3 over all statistical tests here. */
#include "beyond/batch.h"
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/errata.h"
#include "beyond/blocks.h"
#include "lit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { SEED = 60221 };

/* means: 24 combinations x 2 x 4 channels, and 2 twins */
static double alpha(void) { return stat_level(1e-3, 24 * 2 * 4); }

static bis_settings sir(bis_proposal proposal, uint32_t M, uint32_t N, bool vectorize)
{
    bis_settings s = bis_settings_default(&bis_sir);

    s.proposal = proposal;
    s.candidates = M;
    s.shadowrays = N;
    s.vectorize = vectorize;
    return s;
}

/* What one thread has. */
typedef struct workspace {
    bis_scratch scratch;
    bis_fast fast;
} workspace;

/* pool NULL: each point draws its own directions. */
static void share(workspace *w, const bis_pool *pool)
{
    w->fast.pool = pool;
    w->scratch.sets = pool ? &pool->sets : NULL;
}

static void new_workspace(workspace *w, bis_pool *pool, const bis_settings *s)
{
    const bis_fast_needs needs = bis_fast_needs_of(s);

    assert_int_equal(bis_scratch_init(&w->scratch, s, NULL), BIS_OK);
    assert_int_equal(bis_fast_init(&w->fast, s, NULL), BIS_OK);
    w->scratch.fast = &w->fast;
    if (!needs.n_pool) return;
    assert_int_equal(bis_pool_init(pool, needs.n_pool, needs.batch, NULL), BIS_OK);
    share(w, pool);
}

static void clear(workspace *w, bis_pool *pool)
{
    bis_scratch_clear(&w->scratch);
    bis_fast_clear(&w->fast);
    bis_pool_clear(pool);
}

/* ---- one lane at a time ---- */

/* The stream whose k-th number is the one given: bis_hash is undone step by step. */
static uint64_t unshift(uint64_t x, int by)
{
    uint64_t y = x;

    for (int i = by; i < 64; i += by) y = x ^ (y >> by);
    return y;
}

static uint64_t inverse(uint64_t odd)
{
    uint64_t x = odd;

    for (int i = 0; i < 6; i++) x *= 2 - odd * x; /* Newton: bits double */
    return x;
}

static bis_rng rng_with(uint64_t number, uint64_t k)
{
    uint64_t x = unshift(number, 31) * inverse(0x94d049bb133111ebu);

    x = unshift(unshift(x, 27) * inverse(0xbf58476d1ce4e5b9u), 30);
    bis_rng r = {x ^ (0x9e3779b97f4a7c15u * k), k};
    assert_true(bis_rng_u64(&r) == number);
    r.counter = 0;
    return r;
}

/* Shows one direction alone. */
typedef struct spy {
    bis_accel accel;
    vec3 only;
    int rays;
} spy;

static bool hides(const bis_accel *a, const ray *r)
{
    spy *s = (spy *)(uintptr_t)a;

    s->rays++;
    return r->d.x != s->only.x || r->d.y != s->only.y;
}

static const bis_accel_ops spying = {.name = "spy", .occluded = hides};

/* A pool of one set, whose M lanes have the given weights exactly: diffuse, all at 60 degrees from the normal, q =
 * 1/2. */
typedef struct bench {
    lit l;
    spy accel;
    bis_light *light;
    workspace work;
    bis_pool pool;
    bis_settings s;
    uint32_t M;
} bench;

static void open_bench(bench *b, const float *w, uint32_t M, uint32_t N, bis_resampling resampling)
{
    *b = (bench){.accel = {.accel = {.ops = &spying}}, .light = lit_new_light(LIT_SMOOTH, 1, 0, false), .s = sir(BIS_PROPOSAL_EM, M, N, true), .M = M};
    b->s.resampling = resampling;
    lit_init(&b->l, b->light, bis_phong((rgb){1, 1, 1}, (rgb){0, 0, 0}, 1), (vec3){0, 0, 1}, 20, LIT_OPEN);
    b->l.pt.accel = &b->accel.accel;
    new_workspace(&b->work, &b->pool, &b->s);
    assert_non_null(b->work.fast.batch);
    b->pool.n_sets = 1;
    bis_pool_fill(&b->pool, b->light, SEED, 0, 1);
    const bis_lanes l = bis_pool_lanes(&b->pool, 0);
    for (uint32_t i = 0; i < M; i++) {
        const vec3 wi = vec3_from(sqrt(0.75) * cos(2 * PI * i / M), sqrt(0.75) * sin(2 * PI * i / M), 0.5);
        l.x[i] = wi.x, l.y[i] = wi.y, l.z[i] = wi.z;
        l.r[i] = w[i], l.g[i] = l.b[i] = 0, l.q[i] = 0.5f;
    }
}

static void close_bench(bench *b)
{
    clear(&b->work, &b->pool);
    bis_light_free(b->light);
}

/* The estimate where lane i alone is seen, in units in which it is the share of the marks on i times W; the number
 * behind the first mark is `number`. */
static double share_of(bench *b, uint32_t i, uint64_t number)
{
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = 1, .spp = 1, .xsamples = 1, .ysamples = 1};
    const bis_lanes l = bis_pool_lanes(&b->pool, 0);
    bis_stream stream = {.sampler = &sampler, .rng = rng_with(number, 2)}; /* before it: which set, the phase */

    b->accel.only = (vec3){l.x[i], l.y[i], 0.5f};
    b->accel.rays = 0;
    const rgb L = bis_batch_Lo(&b->s, &b->l.pt, &stream, &b->work.scratch);
    return (double)L.r / (INV_PI * bis_light_mean(b->light) / b->M); /* Kd/pi is the weights' unit */
}

/* In sixty-fourths of [0,1), from its middle. */
static uint64_t mark(uint32_t k, uint32_t n) { return (uint64_t)((k + 0.5) / n * 0x1p53) << 11; }

enum { LANES = 40 };

/* Whole weights that sum to 64: a block of zeroes, a last lane of a block, one positive lane in the last block, of
 * which 8 lanes are beyond M. */
static void whole_weights(float w[LANES])
{
    for (int i = 0; i < LANES; i++) w[i] = 0;
    w[0] = 3, w[1] = 1, w[7] = 12, w[14] = 5, w[15] = 16, w[39] = 27;
}

static void lanes_are_chosen_exactly_in_proportion_to_their_weights(void **state)
{
    static const uint32_t Ns[] = {1, 4, 15};
    float w[LANES];

    (void)state;
    whole_weights(w);
    for (int c = 0; c < 3; c++) {
        bench b;
        open_bench(&b, w, LANES, Ns[c], BIS_RESAMPLING_SYSTEMATIC);
        for (uint32_t i = 0; i < LANES; i++) {
            double sum = 0;
            for (uint32_t k = 0; k < 64; k++) sum += share_of(&b, i, mark(k, 64)) / 64; /* 64 offsets: each weight a whole number of marks */
            if (fabs(sum - (double)w[i]) > 1e-5) fail_msg("N = %u: lane %u of weight %g is worth %g", (unsigned)Ns[c], (unsigned)i, (double)w[i], sum);
        }
        close_bench(&b);
    }
    /* Independent marks: N = 1 is one uniform number. */
    bench b;
    open_bench(&b, w, LANES, 1, BIS_RESAMPLING_MULTINOMIAL);
    for (uint32_t i = 0; i < LANES; i++) {
        double sum = 0;
        for (uint32_t k = 0; k < 64; k++) sum += share_of(&b, i, mark(k, 64)) / 64;
        assert_true(fabs(sum - (double)w[i]) < 1e-5);
    }
    close_bench(&b);
}

static void marks_at_the_ends_fall_on_the_first_and_on_the_last_positive_lane(void **state)
{
    static const uint64_t ends[] = {0, UINT64_MAX};

    (void)state;
    for (int k = 0; k < 2; k++) {
        for (int way = 0; way < 2; way++) {
            float w[LANES] = {0};
            w[18] = 0.1f, w[20] = 1e-7f, w[33] = 0.7f; /* the first block is empty, the last lane is not the last */
            bench b;
            open_bench(&b, w, LANES, 1, way ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC);
            for (uint32_t i = 0; i < LANES; i++) {
                const bool chosen = i == (k ? 33 : 18);
                const double got = share_of(&b, i, ends[k]);
                assert_true(chosen ? fabs(got - 0.8000001) < 1e-6 : got == 0);
                assert_int_equal(b.accel.rays, 1);
            }
            close_bench(&b);
        }
    }
}

/* Rounding may take a mark to the end of all weights. No mark is lost: told a sum twice as large, so that half of the
 * marks lie beyond the end, N are chosen all the same, and the last positive lane has those. */
static void marks_beyond_the_end_fall_on_the_last_positive_lane(void **state)
{
    static const uint32_t Ns[] = {1, 2, 7, 40};

    (void)state;
    for (int way = 0; way < 2; way++) {
        for (int c = 0; c < 4; c++) {
            const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = 1, .spp = 1, .xsamples = 1, .ysamples = 1};
            bis_blocks b;
            uint32_t n = 0, last = 0, all_last = 0;
            assert_true(bis_blocks_init(&b, 48, Ns[c]));
            for (uint64_t run = 0; run < 100; run++) {
                bis_stream stream = {.sampler = &sampler, .rng = rng_with(mark((uint32_t)run, 100), 1)};
                /* the last positive one is 37 */
                for (int i = 0; i < 48; i++) b.w[i] = i % 3 == 1 && i < 40 ? (float)(1 + i % 5) : 0;
                const double W = bis_blocks_sum(&b, 48);
                bis_blocks_choose(&b, Ns[c], 2 * W, way ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC,
                    &stream);
                n = last = 0;
                for (uint32_t k = 0; k < b.n_chosen; k++) {
                    assert_true(b.times[k] > 0 && b.w[b.lane[k]] > 0 && (k == 0 || b.lane[k] > b.lane[k - 1]));
                    n += b.times[k];
                    if (b.lane[k] == 37) last += b.times[k];
                }
                assert_int_equal(n, Ns[c]);
                all_last += last;
            }
            assert_true(all_last >= 30 * Ns[c]); /* half of all, and its own share */
            bis_blocks_clear(&b);
        }
    }
}

static void one_positive_lane_gets_every_mark_and_one_ray(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < LANES; i++) {
        float w[LANES] = {0};
        bench b;
        w[i] = 1e-30f;
        open_bench(&b, w, LANES, 15, BIS_RESAMPLING_MULTINOMIAL);
        assert_true(fabs(share_of(&b, i, mark(i, LANES)) * 1e30 - 1) < 1e-6);
        assert_int_equal(b.accel.rays, 1);
        close_bench(&b);
    }
}

/* A workspace that has served another point gives the same bits as a new one: shares of M from map and BRDF change
 * from point to point, and blocks of lanes are filled to other ends. */
static void a_used_workspace_gives_the_bits_of_a_new_one(void **state)
{
    static const bis_proposal proposals[] = {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_MIX};
    static const double exponents[] = {1, 5000, 10, 300, 50, 100000, 3, 1000};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);

    (void)state;
    for (int i = 0; i < 6; i++) {
        const bis_settings s = sir(proposals[i % 3], i < 3 ? 40 : 250, 7, true);
        workspace used = {.fast = {NULL}}, fresh;
        bis_pool pool = {0}, same = {0};
        new_workspace(&used, &pool, &s);
        if (pool.n_sets) bis_pool_fill(&pool, light, SEED, 0, 1);
        for (uint64_t k = 0; k < 32; k++) {
            lit l;
            lit_init(&l, light, bis_phong((rgb){0.3f, 0.2f, 0.1f}, (rgb){0.6f, 0.6f, 0.4f}, exponents[k % 8]),
                normalize((vec3){0.3f, 0.1f, 1}), k % 3 ? 30 : 75, LIT_OPEN);
            new_workspace(&fresh, &same, &s);
            if (same.n_sets) bis_pool_fill(&same, light, SEED, 0, 1);
            const rgb a = lit_once(&l, &s, &used.scratch, SEED, k), b = lit_once(&l, &s, &fresh.scratch, SEED, k);
            assert_memory_equal(&a, &b, sizeof a);
            clear(&fresh, &same);
        }
        clear(&used, &pool);
    }
    bis_light_free(light);
}

static void a_black_set_gives_0_and_no_ray(void **state)
{
    float w[LANES] = {0};
    bench b;

    (void)state;
    open_bench(&b, w, LANES, 15, BIS_RESAMPLING_SYSTEMATIC);
    assert_true(share_of(&b, 0, 0) == 0);
    assert_int_equal(b.accel.rays, 0);
    close_bench(&b);
}

static void a_black_material_and_an_eye_below_the_horizon_give_0(void **state)
{
    float w[LANES];
    bench b;

    (void)state;
    whole_weights(w);
    open_bench(&b, w, LANES, 1, BIS_RESAMPLING_SYSTEMATIC);
    b.l.material = bis_phong((rgb){0, 0, 0}, (rgb){0, 0, 0}, 1);
    bis_bsdf_init(&b.l.pt.bsdf, &b.l.material, b.l.pt.n, b.l.pt.wo);
    assert_true(share_of(&b, 0, 0) == 0);
    b.l.material = bis_phong((rgb){1, 1, 1}, (rgb){0, 0, 0}, 1);
    bis_bsdf_init(&b.l.pt.bsdf, &b.l.material, b.l.pt.n, neg(b.l.pt.wo));
    assert_true(share_of(&b, 0, 0) == 0);
    close_bench(&b);
}

/* ---- side by side and one by one ---- */

static bool near(float a, float b) { return fabs((double)a - (double)b) <= 1e-4 * fabs((double)b); }

/* From the map alone, both ways read the same numbers: the same set, the same marks. */
static void side_by_side_the_same_candidates_are_chosen_as_one_by_one(void **state)
{
    enum { RUNS = 2000 };
    static const uint32_t Ms[] = {16, 17, 64, 800};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);

    (void)state;
    for (int c = 0; c < 16; c++) {
        const bis_settings batch = sir(BIS_PROPOSAL_EM, Ms[c / 4], c % 2 ? 15 : 1, true), plain = sir(BIS_PROPOSAL_EM, Ms[c / 4], c % 2 ? 15 : 1, false);
        const double ks = c % 4 < 2 ? 0 : 0.6;
        workspace with, without;
        bis_pool pool, none;
        uint32_t equal = 0;
        double sums[2] = {0};
        lit l;
        lit_init(&l, light, bis_phong(rgb_from(0.8 - ks, 0.7 - ks, 0.6 - ks), rgb_from(ks, ks / 2, ks), 20), normalize((vec3){0.3f, 0.1f, 1}), 40, LIT_HALF);
        new_workspace(&with, &pool, &batch);
        new_workspace(&without, &none, &plain);
        assert_true(with.fast.batch && !without.fast.batch);
        share(&without, &pool);
        bis_pool_fill(&pool, light, SEED, (uint32_t)c, 1);
        for (uint64_t run = 0; run < RUNS; run++) {
            const rgb a = lit_once(&l, &batch, &with.scratch, SEED, run), b = lit_once(&l, &plain, &without.scratch, SEED, run);
            equal += near(a.r, b.r) && near(a.g, b.g) && near(a.b, b.b);
            sums[0] += rgb_sum(a);
            sums[1] += rgb_sum(b);
        }
        if (equal < 0.999 * RUNS) fail_msg("M = %u: %u of %u estimates differ", (unsigned)Ms[c / 4], RUNS - (unsigned)equal, (unsigned)RUNS);
        assert_true(fabs(sums[0] / sums[1] - 1) < 2e-4);
        clear(&with, &pool);
        clear(&without, &none);
    }
    bis_light_free(light);
}

/* Estimates with pools, 25 of them and their mean as one value; spoil: for twins. */
static void run(stat_moments m[4], lit *l, const bis_settings *s, uint32_t runs, void (*spoil)(bis_pool *))
{
    enum { PER_POOL = 25 };
    workspace work;
    bis_pool pool = {0};

    for (int c = 0; c < 4; c++) m[c] = (stat_moments){0};
    new_workspace(&work, &pool, s);
    assert_true((work.fast.batch != NULL) == (s->vectorize && s->candidates >= 16));
    pool.n_sets = PER_POOL;
    for (uint32_t k = 0; k < runs; k++) {
        double sum[3] = {0};
        bis_pool_fill(&pool, l->light, SEED, k, 1);
        if (spoil) spoil(&pool);
        for (uint32_t j = 0; j < PER_POOL; j++) {
            const rgb L = lit_once(l, s, &work.scratch, SEED, (uint64_t)k * PER_POOL + j);
            sum[0] += (double)L.r / PER_POOL, sum[1] += (double)L.g / PER_POOL, sum[2] += (double)L.b / PER_POOL;
        }
        for (int c = 0; c < 3; c++) stat_add(&m[c], sum[c]);
        stat_add(&m[3], sum[0] + sum[1] + sum[2]);
    }
    clear(&work, &pool);
}

static bis_material glossy(bool coloured)
{
    return coloured ? bis_phong((rgb){0.4f, 0.2f, 0.1f}, (rgb){0.3f, 0.5f, 0.1f}, 50) : bis_phong((rgb){0.3f, 0.3f, 0.3f}, (rgb){0.5f, 0.5f, 0.5f}, 50);
}

static void the_mean_is_brute_force_s_with_and_without_vectors(void **state)
{
    static const uint32_t Ms[] = {16, 17, 64, 800}, runs[] = {400, 400, 200, 30};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);

    (void)state;
    for (int c = 0; c < 24; c++) {
        bis_settings s = sir(c % 2 ? BIS_PROPOSAL_MIX : BIS_PROPOSAL_EM, Ms[c % 4], c / 4 % 2 ? 15 : 1, false);
        stat_moments m[4];
        lit l;
        s.resampling = c / 8 % 2 ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC;
        lit_init(&l, light, glossy(c / 2 % 2), normalize((vec3){0.3f, -0.1f, 1}), 40, c / 8 % 3 == 0 ? LIT_OPEN : LIT_HALF);
        const rgbd truth = lit_truth(&l, true);
        const double expected[4] = {truth.r, truth.g, truth.b, rgbd_sum(truth)};
        for (int vectorize = 0; vectorize < 2; vectorize++) {
            s.vectorize = vectorize;
            run(m, &l, &s, runs[c % 4], NULL);
            for (int k = 0; k < 4; k++) stat_assert_mean(vectorize ? "batch" : "batch-plain", SEED, &m[k], expected[k], alpha());
        }
    }
    lit l;
    const bis_settings s = sir(BIS_PROPOSAL_MIX, 64, 15, true);
    stat_moments m[4];
    lit_init(&l, light, glossy(true), (vec3){0, 0, 1}, 40, LIT_ALL);
    run(m, &l, &s, 2, NULL);
    assert_true(m[3].mean == 0);
    bis_light_free(light);
}

/* As if each block's last lane were never chosen. */
static void forget_last_lanes(bis_pool *p)
{
    for (uint32_t set = 0; set < p->n_sets; set++) {
        const bis_lanes l = bis_pool_lanes(p, set);
        for (uint32_t i = 15; i < p->M; i += 16) l.r[i] = l.g[i] = l.b[i] = 0;
    }
}

/* As if beta were forgotten: weights phat/q_L in place of a mixture's q, twice as large. */
static void halve_densities(bis_pool *p)
{
    for (uint32_t set = 0; set < p->n_sets; set++) {
        const bis_lanes l = bis_pool_lanes(p, set);
        for (uint32_t i = 0; i < p->M; i++) l.q[i] /= 2;
    }
}

static void twins_that_forget_a_lane_or_a_density_are_found(void **state)
{
    bis_light *smooth = lit_new_light(LIT_SMOOTH, 1, 0, false), *spotty = lit_new_light(LIT_SPOTTY, 1, 0, false);
    const bis_settings em = sir(BIS_PROPOSAL_EM, 64, 15, true), mix = sir(BIS_PROPOSAL_MIX, 64, 15, true);
    stat_moments m[4];
    lit l;

    (void)state;
    lit_init(&l, smooth, bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1), normalize((vec3){0.3f, -0.1f, 1}), 40, LIT_OPEN);
    run(m, &l, &em, 200, forget_last_lanes);
    stat_assert_not_mean("batch-last-lane", SEED, &m[3], rgbd_sum(lit_truth(&l, true)), alpha());
    lit_init(&l, spotty, glossy(true), normalize((vec3){0.3f, -0.1f, 1}), 40, LIT_OPEN); /* there the map has most of the candidates */
    run(m, &l, &mix, 200, halve_densities);
    stat_assert_not_mean("batch-beta", SEED, &m[3], rgbd_sum(lit_truth(&l, true)), alpha());
    bis_light_free(smooth);
    bis_light_free(spotty);
}

/* ---- workspace ---- */

static bool has_batch(const bis_settings *s)
{
    bis_fast fast;

    assert_int_equal(bis_fast_init(&fast, s, NULL), BIS_OK);
    const bool has = fast.batch != NULL;
    assert_true((bis_fast_Lo(s) == bis_batch_Lo) == has);
    bis_fast_clear(&fast);
    return has;
}

static void there_is_no_batch_where_none_can_be_used(void **state)
{
    const bis_settings yes = sir(BIS_PROPOSAL_MIX, 16, 1, true);
    bis_settings s;

    (void)state;
    assert_true(has_batch(&yes));
    s = yes, s.candidates = BIS_POOL_MAX_SET, assert_true(has_batch(&s));
    s = yes, s.candidates = BIS_POOL_MAX_SET + 1, assert_false(has_batch(&s));
    s = yes, s.candidates = 15, assert_false(has_batch(&s));
    s = yes, s.vectorize = false, assert_false(has_batch(&s));
    s = yes, s.stratify = false, assert_false(has_batch(&s));
    s = yes, s.proposal = BIS_PROPOSAL_BRDF, assert_false(has_batch(&s));
    s = yes, s.as_printed = BIS_E21, assert_false(has_batch(&s));
}

static void under_a_constant_light_and_without_lanes_candidates_go_one_by_one(void **state)
{
    const bis_settings s = sir(BIS_PROPOSAL_MIX, 64, 4, true), plain = sir(BIS_PROPOSAL_MIX, 64, 4, false);
    bis_light *lights[] = {lit_new_light(LIT_CONSTANT, 1, 0, false), lit_new_light(LIT_SMOOTH, 1, 0, false)};
    workspace with, without;
    bis_pool pool, none;
    bis_bsdf_model model = bis_phong_model; /* a model that no table of lanes knows */

    (void)state;
    new_workspace(&with, &pool, &s);
    new_workspace(&without, &none, &plain);
    bis_pool_fill(&pool, lights[1], SEED, 0, 1);
    for (int k = 0; k < 2; k++) {
        lit l;
        lit_init(&l, lights[k], glossy(true), (vec3){0, 0, 1}, 40, LIT_HALF);
        if (k) l.material.model = &model;
        share(&with, k ? &pool : NULL);
        share(&without, k ? &pool : NULL);
        for (uint64_t run_number = 0; run_number < 50; run_number++) {
            const rgb a = lit_once(&l, &s, &with.scratch, SEED, run_number), b = lit_once(&l, &plain, &without.scratch, SEED, run_number);
            assert_memory_equal(&a, &b, sizeof a);
        }
    }
    clear(&with, &pool);
    clear(&without, &none);
    bis_light_free(lights[0]);
    bis_light_free(lights[1]);
}

static void any_allocation_may_fail(void **state)
{
    const bis_settings s = sir(BIS_PROPOSAL_MIX, 64, 4, true);
    bis_status status = BIS_NOMEM;
    int k = 0;

    (void)state;
    while (status) {
        workspace work = {.fast = {NULL}};
        bis_pool pool = {0};
        bis_diag diag = {0};
        bis_mem_fail_at(++k);
        status = bis_scratch_init(&work.scratch, &s, &diag);
        if (!status) status = bis_fast_init(&work.fast, &s, &diag);
        if (!status) status = bis_pool_init(&pool, s.candidates, true, &diag);
        bis_mem_fail_at(0);
        assert_int_equal(diag.n_errors, status ? 1 : 0);
        assert_true(!status || status == BIS_NOMEM);
        bis_diag_clear(&diag);
        clear(&work, &pool);
    }
    assert_true(k > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lanes_are_chosen_exactly_in_proportion_to_their_weights),
        cmocka_unit_test(marks_at_the_ends_fall_on_the_first_and_on_the_last_positive_lane),
        cmocka_unit_test(marks_beyond_the_end_fall_on_the_last_positive_lane),
        cmocka_unit_test(one_positive_lane_gets_every_mark_and_one_ray),
        cmocka_unit_test(a_used_workspace_gives_the_bits_of_a_new_one),
        cmocka_unit_test(a_black_set_gives_0_and_no_ray),
        cmocka_unit_test(a_black_material_and_an_eye_below_the_horizon_give_0),
        cmocka_unit_test(side_by_side_the_same_candidates_are_chosen_as_one_by_one),
        cmocka_unit_test(the_mean_is_brute_force_s_with_and_without_vectors),
        cmocka_unit_test(twins_that_forget_a_lane_or_a_density_are_found),
        cmocka_unit_test(there_is_no_batch_where_none_can_be_used),
        cmocka_unit_test(under_a_constant_light_and_without_lanes_candidates_go_one_by_one),
        cmocka_unit_test(any_allocation_may_fail),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
