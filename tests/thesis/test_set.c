/* SPDX-License-Identifier: BSD-2-Clause */
/* set: what the verbs of src/thesis/set.h hold by themselves, for every model, map and proposal: weights, sums and
 * shares against doubles, one candidate after the other; the same bits on every processor and in a used workspace;
 * memory. What the estimators make of them is held by test_enumeration.c, test_sir.c, test_rejection.c and
 * test_integrators.c. */
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/beyond/pool.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "clones.h"
#include "lit.h"
#include "set_help.h"
#include "thesis/as_printed.h"

#include <string.h>

enum { SEED = 60221 };

/* ---- many sets ---- */

enum { N_MATERIALS = 12, N_WAYS = 7, N_SETS = N_MATERIALS * N_WAYS * 3 };

static bis_material material(int k)
{
    const rgb orange = {0.9f, 0.5f, 0.1f}, blue = {0.1f, 0, 0.7f};
    const bis_material all[N_MATERIALS] = {
        bis_phong(orange, grey(0), 1), bis_phong(blue, orange, 0), bis_phong(grey(0), orange, 50),
        bis_phong(blue, orange, 1e4),
        bis_phong(grey(0), grey(1), 1e8), bis_phong(grey(1e-19), (rgb){1e-20f, 0, 1e-3f}, 10),
        bis_microfacet(orange, grey(0.04), 1), bis_microfacet(grey(0), orange, 0.1),
        bis_microfacet(blue, orange, BIS_MICROFACET_MIN_ROUGHNESS),
        bis_microfacet_metal((rgb){0.952f, 0.62f, 0.511f}, (rgb){0.2f, 0.924f, 1.102f}, 0.3),
        bis_plastic(blue, grey(0.04), 1.5, 0.2), bis_plastic(orange, grey(0), 1.5, 0.5)};

    return all[k];
}

static const struct {
    bis_proposal proposal;
    bool stratify, shared;
    uint32_t M;
} ways[N_WAYS] = {{BIS_PROPOSAL_EM, false, false, 7},   {BIS_PROPOSAL_EM, true, true, 800},
                  {BIS_PROPOSAL_BRDF, false, false, 1}, {BIS_PROPOSAL_BRDF, true, false, 300},
                  {BIS_PROPOSAL_MIX, false, false, 17}, {BIS_PROPOSAL_MIX, true, true, 64},
                  {BIS_PROPOSAL_MIX, true, false, 250}};

/* One of N_SETS sets: a material, a way to draw, and a light: spotty, or smooth and dim, or constant and bright. Every
 * fourth is seen at grazing angle. */
typedef struct example {
    lit l;
    bis_light *light;
    bis_pool pool;
    bis_settings s;
    bis_scratch scratch;
    bis_set *x;
} example;

static bis_light *lights[3];

static int open_lights(void **state)
{
    static const lit_map maps[] = {LIT_SPOTTY, LIT_SMOOTH, LIT_CONSTANT};
    static const double scales[] = {1, 1e-35, 1e33};

    for (int i = 0; i < 3; i++) lights[i] = lit_new_light(maps[i], scales[i], 0.15, false);
    return 0;
}

static int close_lights(void **state)
{
    for (int i = 0; i < 3; i++) bis_light_free(lights[i]);
    return 0;
}

static void new_example(example *e, int k)
{
    const int way = k / N_MATERIALS % N_WAYS;

    *e = (example){.light = lights[k / N_MATERIALS / N_WAYS], .s = bis_settings_default(&bis_sir)};
    lit_init(&e->l, e->light, material(k % N_MATERIALS), lit_tilted(), k % 4 == 3 ? 89 : 40, LIT_HALF);
    e->s.proposal = ways[way].proposal;
    e->s.stratify = ways[way].stratify;
    e->s.candidates = ways[way].M;
    e->s.shadowrays = 9;
    assert_int_equal(bis_scratch_init(&e->scratch, &e->s, NULL), BIS_OK);
    e->x = e->scratch.set;
    if (!ways[way].shared || bis_light_is_constant(e->light)) return;
    assert_int_equal(bis_pool_init(&e->pool, ways[way].M, NULL), BIS_OK);
    bis_pool_fill(&e->pool, e->light, SEED, (uint32_t)k, 1);
    bis_scratch_share(&e->scratch, &e->pool.sets, NULL);
}

static void free_example(example *e)
{
    bis_scratch_clear(&e->scratch);
    bis_pool_clear(&e->pool);
}

static bis_stream stream_of(uint64_t pixel)
{
    static const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
    bis_stream stream;

    bis_stream_init(&stream, &sampler, pixel, 0);
    return stream;
}

static void draw(example *e, uint64_t pixel)
{
    bis_stream stream = stream_of(pixel);

    assert_true(bis_set_draw(e->x, e->s.candidates, e->s.proposal, e->s.stratify, &e->l.pt, &stream));
}

/* ---- weights ---- */

/* F/q of a candidate in double, from the floats of its light and material. */
typedef rgbd formula(const example *e, rgbd f_cos, rgbd Le, double q_L, double q_f);

static rgbd F_over_q(const example *e, rgbd f_cos, rgbd Le, double q_L, double q_f)
{
    const double q = e->x->beta * q_L + (1 - e->x->beta) * q_f;

    return (rgbd){f_cos.r * Le.r / q, f_cos.g * Le.g / q, f_cos.b * Le.b / q};
}

/* Twins: every candidate with the density of the map; one candidate too few in the mixture. */
static rgbd with_q_L(const example *e, rgbd f_cos, rgbd Le, double q_L, double q_f)
{
    return (rgbd){f_cos.r * Le.r / q_L, f_cos.g * Le.g / q_L, f_cos.b * Le.b / q_L};
}

static rgbd with_another_beta(const example *e, rgbd f_cos, rgbd Le, double q_L, double q_f)
{
    const double beta = e->x->beta - 1.0 / e->x->M, q = beta * q_L + (1 - beta) * q_f;

    return (rgbd){f_cos.r * Le.r / q, f_cos.g * Le.g / q, f_cos.b * Le.b / q};
}

/* F/q over the units of the candidate with this number, 0 if it is not used or below the horizon; *per_F: 1/q. f comes
 * from the model for many directions, which tests/beyond/test_f_many.c compares with single ones; or one by one in
 * double. */
static rgbd single(double *per_F, const example *e, uint32_t number, const bis_reflected *f, formula *of)
{
    uint32_t i;
    const bis_half *half = bis_set_half(e->x, number, &i);
    const bis_lanes *y = &half->x;
    const double cosine = (double)f->cos[i];
    const rgbd f_cos = {(double)f->r[i] * cosine, (double)f->g[i] * cosine, (double)f->b[i] * cosine};
    const rgbd Le = {(double)y->r[i], (double)y->g[i], (double)y->b[i]};

    *per_F = 0;
    if (cosine <= 0 || rgbd_sum(Le) <= 0) return (rgbd){0, 0, 0};
    if (half == &e->x->map && e->pool.M && !set_is_used(e->x, number)) return (rgbd){0, 0, 0};
    *per_F = of(e, (rgbd){1, 1, 1}, (rgbd){1, 1, 1}, (double)y->q[i], (double)f->q[i]).r;
    return of(e, f_cos, Le, (double)y->q[i], (double)f->q[i]);
}

/* The largest error of a weight, relative to it, and of Zhat and the mean, relative to Zhat, in units of 2^-24. A
 * product of floats may be below the least normal one, in each of three channels and in their sum: 4 x 2^-126 over the
 * density, which no weight's error counts. */
typedef struct errors {
    double w, Zhat, mean;
} errors;

static double absolute(rgbd a) { return fmax(fabs(a.r), fmax(fabs(a.g), fabs(a.b))); }

static errors errors_of(const example *e, double Zhat, const bis_reflected f[2], formula *of)
{
    const bis_set *x = e->x;
    const double unit = x->unit_of_f * x->unit_of_Le;
    rgbd sum = {0, 0, 0};
    errors worst = {0, 0, 0};

    for (uint32_t i = 0; i < set_size(x); i++) {
        const uint32_t number = set_number(x, i);
        double per_F;
        const rgbd C = single(&per_F, e, number, &f[number >= x->brdf.first], of);
        const double w = rgbd_sum(C), error = fabs((double)x->choice.w[number] - w) - 0x1p-124 * per_F;
        sum = rgbd_add(sum, C);
        if (error > 0) worst.w = fmax(worst.w, error / w * 0x1p24);
    }
    const rgbd mean = rgbd_scale(bis_set_mean(x), 1 / unit);
    worst.Zhat = fabs(Zhat / unit / (rgbd_sum(sum) / x->M) - 1) * 0x1p24;
    worst.mean = absolute(rgbd_add(sum, rgbd_scale(mean, -(double)x->M))) / rgbd_sum(sum) * 0x1p24;
    return worst;
}

/* Each number is rounded to a float, 2^-24 at most. w: a product of F, two sums over RGB, the cosine; beta, two
 * products and the sum of q; the quotient: 9. Zhat: 4 more, because the 16 of a block are added in 4 steps. A share
 * F/phat: two sums, the inverse, two products, the product with w: 6 more than w's 9, and one for each block that is
 * added. */
static void weights_means_and_shares_are_those_of_single_candidates(void **state)
{
    const uint32_t most = 1024;
    float *memory = bis_alloc(10 * most, sizeof *memory);
    double worst[3] = {0}, twins[2] = {0};

    for (int k = 0; k < N_SETS; k++) {
        example e;
        bis_reflected f[2];
        new_example(&e, k);
        for (int i = 0; i < 10; i++) (&f[i / 5].r)[i % 5] = memory + (uint32_t)i * most;
        draw(&e, (uint64_t)k);
        const double Zhat = bis_set_weigh(e.x, &e.l.pt);
        bis_bsdf_f_many(&f[0], &e.l.pt.bsdf, &e.x->map.x, e.x->map.n);
        bis_bsdf_f_many(&f[1], &e.l.pt.bsdf, &e.x->brdf.x, e.x->brdf.n);
        if (Zhat > 0) {
            const errors right = errors_of(&e, Zhat, f, F_over_q), q_L = errors_of(&e, Zhat, f, with_q_L);
            worst[0] = fmax(worst[0], right.w / 9);
            worst[1] = fmax(worst[1], right.Zhat / 13);
            worst[2] = fmax(worst[2], right.mean / (15 + e.x->choice.n / BIS_LANES_BLOCK));
            if (e.x->beta < 1) twins[0] += q_L.w < 9;
            if (e.x->beta < 1 && e.x->beta > 0) twins[1] += errors_of(&e, Zhat, f, with_another_beta).w < 9;
        }
        free_example(&e);
    }
    print_message("of the error derived: weights %.2f, Zhat %.2f, mean %.2f\n", worst[0], worst[1], worst[2]);
    assert_true(worst[0] <= 1 && worst[1] <= 1 && worst[2] <= 1);
    assert_true(twins[0] == 0 && twins[1] == 0);
    bis_free(memory);
}

/* The same candidates, weighed by a model that answers for one direction at a time: F/q in double, all of it by the
 * single functions of light and material. f, its unit's quotient, cos and q_f are rounded once each: 4 more than 9, and
 * Le and q_L of the lanes: 2. */
static void a_model_of_single_directions_is_weighed_and_drawn_like_any_other(void **state)
{
    double worst = 0;

    for (int k = 0; k < N_SETS; k++) {
        example e;
        new_example(&e, k);
        bis_bsdf_model one_by_one = *e.l.material.model;
        one_by_one.many = NULL;
        e.l.material.model = &one_by_one;
        draw(&e, (uint64_t)k);
        bis_set_weigh(e.x, &e.l.pt);
        for (uint32_t i = 0; i < set_size(e.x); i++) {
            const uint32_t number = set_number(e.x, i);
            const vec3 wi = set_direction(e.x, number);
            double q_f, q_L = bis_light_pdf(e.light, wi), cosine = bis_bsdf_cos(&e.l.pt.bsdf, wi);
            const rgb f = bis_bsdf_f_pdf(&e.l.pt.bsdf, wi, &q_f), Le = bis_light_Le(e.light, wi);
            const double q = (e.x->beta > 0 ? e.x->beta * q_L : 0) + (1 - e.x->beta) * q_f;
            const double f_Le = (double)f.r * (double)Le.r + (double)f.g * (double)Le.g + (double)f.b * (double)Le.b;
            const double phat = f_Le * cosine;
            const double w = cosine > 0 && phat > 0 && (!e.pool.M || set_is_used(e.x, number)) ? phat / q : 0;
            uint32_t at;
            const bis_half *half = bis_set_half(e.x, number, &at);
            /* a direction next to a pixel's edge may be looked up beside it */
            if (fabs((double)half->x.r[at] * e.x->unit_of_Le - (double)Le.r) > 1e-6 * (double)Le.r) continue;
            const double got = bis_set_weight(e.x, number);
            if (w > e.x->unit_of_f * e.x->unit_of_Le * 0x1p-100) worst = fmax(worst, fabs(got / w - 1) * 0x1p24 / 15);
        }
        free_example(&e);
    }
    print_message("of the error derived: %.2f\n", worst);
    assert_true(worst <= 1 && worst > 0.01);
}

/* F/phat of what was chosen, to the 5 roundings of two sums, a quotient and two products; also where F is so small that
 * the inverse of its sum is no float. */
static void shares_of_the_chosen_are_F_over_phat_down_to_denormal_floats(void **state)
{
    double worst = 0;

    for (int k = 0; k < N_SETS * 3; k++) {
        const float scale = (float[]){1, 0x1p-126f, 0x1p-140f}[k / N_SETS];
        bis_stream stream = stream_of((uint64_t)k);
        example e;
        new_example(&e, k % N_SETS);
        draw(&e, (uint64_t)k);
        for (uint32_t i = 0; i < set_size(e.x); i++) {
            uint32_t at;
            const bis_lanes *y = &bis_set_half(e.x, set_number(e.x, i), &at)->x;
            y->r[at] *= scale, y->g[at] *= scale, y->b[at] *= scale;
        }
        if (bis_set_weigh(e.x, &e.l.pt) > 0) {
            bis_set_choose(e.x, e.s.shadowrays, BIS_RESAMPLING_SYSTEMATIC, &stream);
            for (uint32_t j = 0; j < e.x->choice.n_chosen; j++) {
                const uint32_t number = e.x->choice.item[j];
                const double F[3] = {(double)e.x->F[0][number], (double)e.x->F[1][number], (double)e.x->F[2][number]};
                const float share[3] = {e.x->y.r[j], e.x->y.g[j], e.x->y.b[j]};
                for (int c = 0; c < 3; c++) worst = fmax(worst, fabs((double)share[c] - F[c] / (F[0] + F[1] + F[2])));
                assert_true(e.x->y.h[j] == 1 && !e.x->y.seen[j]);
            }
        }
        free_example(&e);
    }
    assert_true(worst <= 5 * 0x1p-24);
}

/* ---- the same bits ---- */

typedef struct processor {
    clone_weigh *weigh;
    clone_mean *mean;
    clone_choose *choose;
} processor;

/* All numbers that a set holds after it has been weighed and chosen from, and its mean. */
static void run_set(example *e, const processor *p, uint64_t pixel, rgbd *mean)
{
    bis_stream stream = stream_of(pixel + 1000);

    draw(e, pixel);
    const double Zhat = p->weigh(e->x, &e->l.pt);
    *mean = p->mean(e->x);
    if (Zhat > 0) p->choose(e->x, e->s.shadowrays, (bis_resampling)(pixel % 2), &stream);
}

static void assert_same(const bis_set *a, const bis_set *b)
{
    const size_t n = a->choice.n_chosen;

    assert_true(a->choice.n == b->choice.n && n == b->choice.n_chosen && a->W == b->W);
    assert_memory_equal(a->choice.w, b->choice.w, a->choice.n * sizeof *a->choice.w);
    assert_memory_equal(a->choice.item, b->choice.item, n * sizeof *a->choice.item);
    assert_memory_equal(a->choice.times, b->choice.times, n * sizeof *a->choice.times);
    assert_memory_equal(a->y.r, b->y.r, n * sizeof *a->y.r);
    assert_memory_equal(a->y.g, b->y.g, n * sizeof *a->y.g);
    assert_memory_equal(a->y.b, b->y.b, n * sizeof *a->y.b);
}

static void sets_have_the_same_bits_on_every_processor(void **state)
{
    const processor all[] = {{bis_set_weigh, bis_set_mean, bis_set_choose},
                             {plain_set_weigh, plain_set_mean, plain_set_choose},
                             {avx2_set_weigh, avx2_set_mean, avx2_set_choose}};
    const int n = clone_has_avx2() ? 3 : 2;

    for (int k = 0; k < N_SETS; k++) {
        example e[3];
        rgbd mean[3];
        for (int p = 0; p < n; p++) {
            new_example(&e[p], k);
            run_set(&e[p], &all[p], (uint64_t)k, &mean[p]);
            assert_same(e[0].x, e[p].x);
            assert_memory_equal(&mean[0], &mean[p], sizeof mean[0]);
        }
        for (int p = 0; p < n; p++) free_example(&e[p]);
    }
}

/* A thread's workspace serves point after point, of other materials, with other shares of M from the map, which end in
 * other blocks: what one point has left there changes no bit of the next. */
static void a_used_workspace_gives_the_bits_of_a_new_one(void **state)
{
    for (int k = 0; k < N_SETS; k += N_MATERIALS) {
        example used, fresh;
        new_example(&used, k);
        for (int i = 0; i < 3 * N_MATERIALS; i++) {
            new_example(&fresh, k);
            used.l.material = fresh.l.material = material(7 * i % N_MATERIALS);
            for (int j = 0; j < 2; j++) {
                lit *l = j ? &used.l : &fresh.l;
                bis_bsdf_init(&l->pt.bsdf, &l->material, l->pt.n, l->pt.wo);
            }
            const rgb a = lit_once(&used.l, &used.s, &used.scratch, SEED, (uint64_t)i);
            const rgb b = lit_once(&fresh.l, &fresh.s, &fresh.scratch, SEED, (uint64_t)i);
            assert_memory_equal(&a, &b, sizeof a);
            free_example(&fresh);
        }
        free_example(&used);
    }
}

/* ---- nothing to reflect ---- */

static void what_reflects_nothing_draws_nothing(void **state)
{
    example e;

    new_example(&e, 2 * N_MATERIALS); /* from the BRDF */
    for (int k = 0; k < 3; k++) {
        bis_light *black = lit_new_light(LIT_BLACK, 1, 0, false);
        bis_stream stream = stream_of(1);
        bis_point pt = e.l.pt;
        const bis_material m = bis_phong(grey(0), grey(0), 1);
        if (k == 0) pt.light = black;
        bis_bsdf_init(&pt.bsdf, k == 1 ? &m : &e.l.material, pt.n, k == 2 ? neg(pt.wo) : pt.wo);
        e.l.counters = (bis_counters){0};
        assert_false(bis_set_draw(e.x, 1, BIS_PROPOSAL_BRDF, false, &pt, &stream));
        assert_true(e.x->choice.n == 0 && e.l.counters.candidates == 0);
        bis_light_free(black);
    }
    free_example(&e);
}

/* ---- memory ---- */

/* The i-th of n is (i + phase) M/n, cut to a whole number; phase is a fraction of 2^32. */
static void some_of_a_set_are_evenly_spread_from_their_phase(void **state)
{
    static const struct { uint32_t n, M, phase, expected[5]; } cases[] = {
        {5, 10, 0, {0, 2, 4, 6, 8}}, {5, 10, 0x7fffffff, {0, 2, 4, 6, 8}}, {5, 10, 0x80000000, {1, 3, 5, 7, 9}},
        {5, 10, UINT32_MAX, {1, 3, 5, 7, 9}}, {3, 7, 0, {0, 2, 4}}, {3, 7, 0xc0000000, {1, 4, 6}},
        {3, 7, UINT32_MAX, {2, 4, 6}}, {1, 16384, 0xffff0000, {16383}}, {1, 16384, 0x00040000, {1}},
        {1, 16384, 0x0003ffff, {0}}, {2, 3, 0x55555555, {0, 1}}, {2, 3, 0x55555556, {0, 2}}, {4, 4, 12, {0, 1, 2, 3}}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (uint32_t i = 0; i < cases[k].n; i++)
            assert_int_equal(bis_one_of_set(i, cases[k].n, cases[k].M, cases[k].phase), cases[k].expected[i]);
}

/* A light is asked for a table where directions are drawn one by one, and for the curve where they are stratified. */
static void candidates_need_what_their_proposal_draws_with(void **state)
{
    static const bis_proposal all[] = {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_MIX, BIS_PROPOSAL_CHOOSE,
        BIS_PROPOSAL_PRODUCT};
    for (int k = 0; k < 5; k++) {
        const bool from_brdf = all[k] == BIS_PROPOSAL_BRDF, takes_set = k == 0 || k == 2;
        assert_int_equal(bis_candidates_light_needs(all[k], false), from_brdf ? 0 : BIS_NEED_TABLE);
        assert_int_equal(bis_candidates_light_needs(all[k], true), from_brdf ? 0 : BIS_NEED_CURVE);
        bis_settings s = lit_settings(&bis_sir, all[k], 37, 3);
        s.stratify = true;
        assert_int_equal(bis_candidates_set_needs(&s), takes_set ? 37 : 0);
        s.stratify = false;
        assert_int_equal(bis_candidates_set_needs(&s), 0);
    }
    const unsigned bits[] = {BIS_NEED_TABLE, BIS_NEED_CURVE, BIS_NEED_COMPENSATED, BIS_NEED_SPREAD};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) assert_true(((bits[i] & bits[j]) != 0) == (i == j));
}

/* Kd = (0.2, 0.1, 0.3), Ks = (0.1, 0.4, 0.2), n = 9: f cos is at most Ks 10/(2 pi) + Kd/pi, in green 2.1/pi. A
 * constant light (1, 0.5, 0.25): I = 1.75 everywhere, I/q = 7 pi. As E27 prints them: f_max over the albedo, 0.5, times
 * L_ns; and L_max over the power, 7 pi, times L_ns. */
static void bounds_are_those_of_the_largest_channel(void **state)
{
    const double slack = 2e-6; /* a bound may be larger by 2^-21 and by the rounding of floats */
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    lit l;
    lit_init(&l, light, bis_phong((rgb){0.2f, 0.1f, 0.3f}, (rgb){0.1f, 0.4f, 0.2f}, 9), lit_tilted(), 30, LIT_OPEN);
    const double em = bis_candidates_bound(&l.pt, BIS_PROPOSAL_EM);
    assert_true(em >= 2.1 * 7 * (1 - 1e-7) && em <= 2.1 * 7 * (1 + slack));
    const double printed_em = bis_as_printed_bound(&l.pt, BIS_PROPOSAL_EM, 3),
                 printed_brdf = bis_as_printed_bound(&l.pt, BIS_PROPOSAL_BRDF, 3);
    assert_true(fabs(printed_em / (4.2 / PI * 3) - 1) <= slack);
    assert_true(fabs(printed_brdf / (1.75 / (7 * PI) * 3) - 1) <= slack);
    lit_init(&l, light, bis_phong((rgb){0.2f, 0.1f, 0.3f}, grey(0), 9), lit_tilted(), 30, LIT_OPEN);
    const double brdf = bis_candidates_bound(&l.pt, BIS_PROPOSAL_BRDF); /* f cos/q = Kd */
    assert_true(brdf >= 0.3 * 1.75 * (1 - 1e-7) && brdf <= 0.3 * 1.75 * (1 + slack));
    /* of 30 directions over the sphere 1.5 fall into the lobe, whose density is 10/(2 pi) on its axis */
    lit_init(&l, light, bis_phong(grey(0), grey(0.5), 9), lit_tilted(), 30, LIT_OPEN);
    assert_true(fabs(bis_candidates_in_lobe(30, &l.pt) - 1.5) < 1e-5);
    bis_light_free(light);
}

/* All from the map, or all from the BRDF, as the proposal or a constant light says; a mixture leaves the map one, and
 * a lobe gets one however small its share. */
static void candidates_are_divided_at_the_ends_of_the_range(void **state)
{
    static const struct { lit_map map; bis_proposal proposal; float Kd, Ks; uint32_t M, n_brdf; } cases[] = {
        {LIT_SPOTTY, BIS_PROPOSAL_EM, 0.5f, 0.5f, 7, 0}, {LIT_SPOTTY, BIS_PROPOSAL_BRDF, 0.5f, 0.5f, 7, 7},
        {LIT_CONSTANT, BIS_PROPOSAL_MIX, 0.5f, 0.5f, 7, 7}, {LIT_CONSTANT, BIS_PROPOSAL_EM, 0.5f, 0.5f, 7, 0},
        {LIT_SPOTTY, BIS_PROPOSAL_MIX, 0.5f, 0, 7, 0}, {LIT_SPOTTY, BIS_PROPOSAL_MIX, 0.9f, 0.01f, 7, 1},
        {LIT_SMOOTH, BIS_PROPOSAL_MIX, 0, 0.5f, 2, 1}, {LIT_SMOOTH, BIS_PROPOSAL_MIX, 0, 0.5f, 3, 2}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const uint32_t M = cases[k].M, n = cases[k].n_brdf;
        bis_light *light = lit_new_light(cases[k].map, 1, 0, false);
        lit l;
        lit_init(&l, light, bis_phong(grey((double)cases[k].Kd), grey((double)cases[k].Ks), 20), lit_tilted(), 30,
                 LIT_OPEN);
        const bis_mixture mix = bis_candidates_divide(M, cases[k].proposal, &l.pt, NULL);
        assert_int_equal(mix.n_brdf, n);
        assert_int_equal(mix.n_em, M - n);
        assert_true(mix.beta == (double)(M - n) / M);
        bis_light_free(light);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_means_and_shares_are_those_of_single_candidates),
        cmocka_unit_test(a_model_of_single_directions_is_weighed_and_drawn_like_any_other),
        cmocka_unit_test(shares_of_the_chosen_are_F_over_phat_down_to_denormal_floats),
        cmocka_unit_test(sets_have_the_same_bits_on_every_processor),
        cmocka_unit_test(a_used_workspace_gives_the_bits_of_a_new_one),
        cmocka_unit_test(what_reflects_nothing_draws_nothing),
        cmocka_unit_test(some_of_a_set_are_evenly_spread_from_their_phase),
        cmocka_unit_test(candidates_need_what_their_proposal_draws_with),
        cmocka_unit_test(bounds_are_those_of_the_largest_channel),
        cmocka_unit_test(candidates_are_divided_at_the_ends_of_the_range),
    };

    return cmocka_run_group_tests_name("set", tests, open_lights, close_lights);
}
