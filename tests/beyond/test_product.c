/* SPDX-License-Identifier: BSD-2-Clause */
/* Estimators x parameters: the mean of each agrees with brute force (tests/support/lit.h) for every combination of
 * method, M in {1, 2, 8, 64, 800}, N in {1, 15}, b in {0, 0.15}, occluded, half occluded and open points, grey and
 * coloured, three materials, four point sets. `make test` runs a set of combinations in which every pair of values of
 * two parameters occurs; BIS_LONG=1 (make test-long) runs the full product, with more runs each.
 * Biased settings: tests/thesis/test_enumeration.c. Family-wise significance 1e-3. */
#include "bis/base/mem.h"
#include "bis/beyond/pool.h"
#include "bis/thesis/phong.h"
#include "bis/scene/light_load.h"

#include "claim.h"
#include "lit.h"

#include <stdlib.h>
#include <string.h>

#define SEED 97u

/* ---- what is combined ---- */

typedef struct method {
    const char *name;
    const bis_integrator *integrator;
    bis_proposal proposal;
    bool other;  /* mis: power heuristic. sir: stratified, systematic */
    bool pooled; /* sir: from a pool of its own */
} method;

static const method methods[] = {{"em", &bis_em, BIS_PROPOSAL_EM, false, false},
                                 {"brdf", &bis_brdf, BIS_PROPOSAL_BRDF, false, false},
                                 {"mis_balance", &bis_mis, BIS_PROPOSAL_MIX, false, false},
                                 {"mis_power", &bis_mis, BIS_PROPOSAL_MIX, true, false},
                                 {"exact", &bis_exact, BIS_PROPOSAL_EM, false, false},
                                 {"rejection_em", &bis_rejection, BIS_PROPOSAL_EM, false, false},
                                 {"rejection_brdf", &bis_rejection, BIS_PROPOSAL_BRDF, false, false},
                                 {"rejection_choose", &bis_rejection, BIS_PROPOSAL_CHOOSE, false, false},
                                 {"sir_em_independent", &bis_sir, BIS_PROPOSAL_EM, false, false},
                                 {"sir_em", &bis_sir, BIS_PROPOSAL_EM, true, false},
                                 {"sir_em_pool", &bis_sir, BIS_PROPOSAL_EM, true, true},
                                 {"sir_brdf_independent", &bis_sir, BIS_PROPOSAL_BRDF, false, false},
                                 {"sir_brdf", &bis_sir, BIS_PROPOSAL_BRDF, true, false},
                                 {"sir_mix_independent", &bis_sir, BIS_PROPOSAL_MIX, false, false},
                                 {"sir_mix", &bis_sir, BIS_PROPOSAL_MIX, true, false},
                                 {"sir_mix_pool", &bis_sir, BIS_PROPOSAL_MIX, true, true},
                                 {"unoccluded_em", &bis_unoccluded, BIS_PROPOSAL_EM, true, false},
                                 {"unoccluded_brdf", &bis_unoccluded, BIS_PROPOSAL_BRDF, true, false},
                                 {"unoccluded_mix", &bis_unoccluded, BIS_PROPOSAL_MIX, true, false}};

enum { N_METHODS = sizeof methods / sizeof *methods };

static const uint32_t counts_M[] = {1, 2, 8, 64, 800}, counts_N[] = {1, 15};
static const double exponents_b[] = {0, 0.15};

/* The parameters, and how many values each has. */
enum { METHOD, CANDIDATES, SHADOWRAYS, AREA_WEIGHT, HIDDEN, COLOUR, MATERIAL, POINT_SET, N_FACTORS };
static const int levels[N_FACTORS] = {N_METHODS, 5, 2, 2, 3, 2, 3, 4};

typedef struct combination {
    int value[N_FACTORS];
} combination;

/* ---- a covering set ---- */

enum { MAX_LEVELS = N_METHODS, MAX_COVER = 400 };

/* seen[a][x][b][y]: value x of parameter a occurs together with value y of parameter b. */
typedef struct pairs {
    bool seen[N_FACTORS][MAX_LEVELS][N_FACTORS][MAX_LEVELS];
} pairs;

static void see(pairs *p, const combination *c)
{
    for (int a = 0; a < N_FACTORS; a++)
        for (int b = 0; b < N_FACTORS; b++) p->seen[a][c->value[a]][b][c->value[b]] = true;
}

/* The first pair not seen yet, as a combination with -1 for all else. False: all are. */
static bool first_unseen(combination *c, const pairs *p)
{
    for (int a = 0; a < N_FACTORS; a++) {
        for (int b = a + 1; b < N_FACTORS; b++) {
            for (int k = 0; k < levels[a] * levels[b]; k++) {
                if (p->seen[a][k % levels[a]][b][k / levels[a]]) continue;
                for (int i = 0; i < N_FACTORS; i++) c->value[i] = -1;
                c->value[a] = k % levels[a];
                c->value[b] = k / levels[a];
                return true;
            }
        }
    }
    return false;
}

static int new_pairs(const pairs *p, const combination *c, int factor, int value)
{
    int n = 0;

    for (int a = 0; a < N_FACTORS; a++) n += a != factor && c->value[a] >= 0 && !p->seen[a][c->value[a]][factor][value];
    return n;
}

/* Greedy: begin with a pair that is missing, give every other parameter the value that adds most new pairs; of equals,
 * another one each time, or the first values would be combined with each other over and over. */
static int make_cover(combination cover[MAX_COVER])
{
    pairs *p = bis_alloc(1, sizeof *p);
    int n = 0;

    memset(p, 0, sizeof *p);
    while (first_unseen(&cover[n], p)) {
        combination *c = &cover[n];
        for (int factor = 0; factor < N_FACTORS; factor++) {
            int best = -1;
            if (c->value[factor] >= 0) continue;
            for (int k = 0; k < levels[factor]; k++) {
                const int value = (k + n) % levels[factor], fresh = new_pairs(p, c, factor, value);
                if (fresh <= best) continue;
                best = fresh;
                c->value[factor] = value;
            }
        }
        see(p, c);
        n++;
        assert_true(n < MAX_COVER);
    }
    bis_free(p);
    return n;
}

/* By definition: each pair is looked for in all combinations. */
static bool covers_all_pairs(const combination *cover, int n)
{
    for (int a = 0; a < N_FACTORS; a++) {
        for (int b = a + 1; b < N_FACTORS; b++) {
            for (int k = 0; k < levels[a] * levels[b]; k++) {
                int i = 0;
                while (i < n && (cover[i].value[a] != k % levels[a] || cover[i].value[b] != k / levels[a])) i++;
                if (i == n) return false;
            }
        }
    }
    return true;
}

static void every_pair_of_values_is_in_the_covering_set_and_none_is_idle(void **state)
{
    static combination cover[MAX_COVER];
    const int n = make_cover(cover);

    assert_true(covers_all_pairs(cover, n));
    assert_false(covers_all_pairs(cover, n - 1));
    assert_true(n >= N_METHODS * 5 && n <= N_METHODS * 5 * 3 / 2); /* the two longest lists; half as much again */
    print_message(
        "%d combinations cover all pairs; the full product has %d\n", n, N_METHODS * 5 * 2 * 2 * 3 * 2 * 3 * 4);
}

/* ---- running them ---- */

/* Lights by b and colour; points by material, visibility, colour and b with their truths. Contrast 100 and a sun of 6 %
 * of the flux: so the mean of every estimator is near enough to normal for a z-test at the runs that we give it. */
typedef struct stage {
    bis_light *lights[2][2];
    lit points[3][3][2][2];
    rgbd truth[3][3][2], unshadowed[3][2];
} stage;

static double rounded(float x) { return sqrt((double)x); }

static bis_light *new_light(double b, bool coloured)
{
    const bis_light_desc desc = {
        .L = {1, 1, 1}, .scale = 1, .area_exponent = b, .levels = 8, .to_world = bis_xform_identity()};
    bis_light *spotty = lit_new_light(LIT_SPOTTY, 1, 0, false), *light;
    const bis_envmap *from = bis_light_envmap(spotty);
    bis_image image;
    bis_envmap em;

    assert_int_equal(bis_image_init(&image, from->width, from->height, NULL), BIS_OK);
    for (int i = 0; i < from->width * from->height; i++) {
        const rgb L = rgb_from(rounded(from->pixels[i].r), rounded(from->pixels[i].g), rounded(from->pixels[i].b));
        const double mean = rgb_sum(L) / 3;
        image.pixels[i] = coloured ? L : rgb_from(mean, mean, mean);
    }
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL), BIS_OK);
    bis_light_free(spotty);
    return light;
}

static stage *new_stage(void)
{
    const bis_material materials[2][3] = {
        {bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0, 0, 0}, 1), bis_phong((rgb){0, 0, 0}, (rgb){0.8f, 0.8f, 0.8f}, 10),
         bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.3f, 0.3f, 0.3f}, 50)},
        {bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1), bis_phong((rgb){0, 0, 0}, (rgb){0.9f, 0.8f, 0.7f}, 10),
         bis_phong((rgb){0.2f, 0.5f, 0.3f}, (rgb){0.5f, 0.3f, 0.1f}, 50)}};
    stage *s = bis_alloc(1, sizeof *s);

    for (int c = 0; c < 2; c++) {
        for (int b = 0; b < 2; b++) s->lights[b][c] = new_light(exponents_b[b], c);
        for (int i = 0; i < 3 * 3 * 2; i++) {
            lit *l = &s->points[i % 3][i / 3 % 3][c][i / 9];
            const vec3 n = normalize(vec3_from(0.2, 0.5, 0.8));
            lit_init(l, s->lights[i / 9][c], materials[c][i % 3], n, 40, (lit_hidden)(i / 3 % 3));
        }
        for (int m = 0; m < 3; m++) { /* the truth does not know b */
            for (int hidden = 0; hidden < 3; hidden++)
                s->truth[m][hidden][c] = lit_truth(&s->points[m][hidden][c][0], true);
            s->unshadowed[m][c] = s->truth[m][LIT_OPEN][c];
        }
        for (int m = 0; m < 3; m++) { /* half hidden is worth its name for every material */
            const double seen = s->truth[m][LIT_HALF][c].g / s->unshadowed[m][c].g;
            assert_true(seen > 0.1 && seen < 0.5);
        }
    }
    return s;
}

static void free_stage(stage *s)
{
    for (int i = 0; i < 4; i++) bis_light_free(s->lights[i % 2][i / 2]);
    bis_free(s);
}

static bis_settings settings_of(const method *m, uint32_t M, uint32_t N)
{
    bis_settings s = bis_settings_default(m->integrator);

    s.proposal = m->proposal;
    s.candidates = M;
    s.shadowrays = N;
    s.samples = m->integrator == &bis_mis && N < 2 ? 2 : N; /* mis needs one of each */
    s.perpatch = N == 1 ? 1 : 2;
    s.heuristic = m->other ? BIS_HEURISTIC_POWER : BIS_HEURISTIC_BALANCE;
    s.stratify = m->other;
    s.resampling = m->other ? BIS_RESAMPLING_SYSTEMATIC : BIS_RESAMPLING_MULTINOMIAL;
    s.estimator = BIS_ESTIMATOR_PLAIN;
    return s;
}

/* As lit_run, with a pool of one set, drawn anew for each estimate: sets shared between estimates are
 * tests/beyond/test_pool.c's. */
static void run_pooled(stat_moments m[4], lit *l, const bis_settings *s, uint32_t runs, uint64_t seed)
{
    bis_scratch scratch;
    bis_pool pool;

    for (int i = 0; i < 4; i++) m[i] = (stat_moments){0};
    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    assert_int_equal(bis_pool_init(&pool, bis_pool_needs(s), NULL), BIS_OK);
    pool.n_sets = 1;
    bis_scratch_share(&scratch, &pool.sets, NULL);
    for (uint32_t run = 0; run < runs; run++) {
        bis_pool_fill(&pool, l->light, seed, run, 1);
        const rgb L = lit_once(l, s, &scratch, seed, run);
        const double value[] = {(double)L.r, (double)L.g, (double)L.b, rgb_sum(L)};
        for (int i = 0; i < 4; i++) stat_add(&m[i], value[i]);
    }
    bis_scratch_clear(&scratch);
    bis_pool_clear(&pool);
}

static void check(stage *s, const combination *c, uint32_t effort, double alpha)
{
    static const bis_sampler_kind kinds[] = {
        BIS_SAMPLER_RANDOM, BIS_SAMPLER_STRATIFIED, BIS_SAMPLER_SOBOL, BIS_SAMPLER_HALTON};
    const int *v = c->value;
    const method *by = &methods[v[METHOD]];
    const bis_settings settings = settings_of(by, counts_M[v[CANDIDATES]], counts_N[v[SHADOWRAYS]]);
    const bool counts =
        by->integrator == &bis_sir || by->integrator == &bis_rejection || by->integrator == &bis_unoccluded;
    const uint32_t cost = (counts ? settings.candidates : settings.samples) + 3;
    const uint32_t runs = by->integrator == &bis_exact ? 40 : effort / cost;
    const uint64_t seed = SEED + (uint64_t)(v[METHOD] * 1000 + v[CANDIDATES] * 100 + v[HIDDEN] * 10 + v[MATERIAL]);
    lit *l = &s->points[v[MATERIAL]][v[HIDDEN]][v[COLOUR]][v[AREA_WEIGHT]];
    const rgbd truth = by->integrator == &bis_unoccluded ? s->unshadowed[v[MATERIAL]][v[COLOUR]]
                                                         : s->truth[v[MATERIAL]][v[HIDDEN]][v[COLOUR]];
    stat_moments m[4];

    l->kind = kinds[v[POINT_SET]];
    if (by->pooled) {
        run_pooled(m, l, &settings, runs, seed);
    } else {
        lit_run(m, l, &settings, runs, seed);
    }
    if (stat_mean(&m[0], truth.r, alpha).rejected || stat_mean(&m[1], truth.g, alpha).rejected ||
        stat_mean(&m[2], truth.b, alpha).rejected) {
        print_error("%s, M %u, N %u, b %g, hidden %d, colour %d, material %d, points %d:\n", by->name,
            (unsigned)settings.candidates, (unsigned)counts_N[v[SHADOWRAYS]], exponents_b[v[AREA_WEIGHT]], v[HIDDEN],
            v[COLOUR], v[MATERIAL], v[POINT_SET]);
    }
    stat_assert_mean(by->name, seed, &m[0], truth.r, alpha);
    stat_assert_mean(by->name, seed, &m[1], truth.g, alpha);
    stat_assert_mean(by->name, seed, &m[2], truth.b, alpha);
    if (v[HIDDEN] == LIT_OPEN || by->integrator == &bis_unoccluded) return;
    /* twin: V is forgotten */
    stat_assert_not_mean(by->name, seed, &m[1], s->unshadowed[v[MATERIAL]][v[COLOUR]].g, alpha);
    if (v[HIDDEN] == LIT_ALL) assert_true(m[3].mean == 0 && m[3].m2 == 0);
}

/* A parameter that a method does not read is not varied: M for em, brdf, mis and exact; N and visibility for
 * unoccluded; b for what draws nothing from the map. The materials and point sets take turns. */
static bool is_idle(const combination *c)
{
    const method *by = &methods[c->value[METHOD]];
    const bool has_M =
        by->integrator == &bis_sir || by->integrator == &bis_rejection || by->integrator == &bis_unoccluded;

    if (!has_M && c->value[CANDIDATES] > 0) return true;
    if (by->proposal == BIS_PROPOSAL_BRDF && c->value[AREA_WEIGHT] > 0) return true;
    return by->integrator == &bis_unoccluded && (c->value[SHADOWRAYS] > 0 || c->value[HIDDEN] > 0);
}

enum { FULL = N_METHODS * 5 * 2 * 2 * 3 * 2 * 3 };

static combination of_full(int k)
{
    combination c;
    int rest = k;
    for (int i = 0; i < POINT_SET; i++, rest /= levels[i - 1]) c.value[i] = rest % levels[i];
    c.value[POINT_SET] = k / 7 % 4;
    return c;
}

static bool is_long(void)
{
    const char *wanted = getenv("BIS_LONG");
    return wanted && *wanted;
}

/* Three channels of each combination, of the full product only where it runs. */
static double alpha(void)
{
    static combination cover[MAX_COVER];
    int n = make_cover(cover);

    for (int k = 0; k < FULL && is_long(); k++) {
        const combination c = of_full(k);
        n += !is_idle(&c);
    }
    return stat_level(1e-3, 3 * n);
}

static void means_agree_with_brute_force_for_every_pair_of_values(void **state)
{
    static combination cover[MAX_COVER];
    const int n = make_cover(cover);
    const double level = alpha();
    stage *s = new_stage();

    for (int i = 0; i < n; i++) check(s, &cover[i], 1000000, level);
    free_stage(s);
}

static void means_agree_with_brute_force_for_the_full_product(void **state)
{
    int done = 0;

    if (!is_long()) {
        print_message("make test-long (BIS_LONG=1) runs it\n");
        skip();
    }
    const double level = alpha();
    stage *s = new_stage();
    for (int k = 0; k < FULL; k++) {
        const combination c = of_full(k);
        if (is_idle(&c)) continue;
        check(s, &c, 600000, level);
        done++;
    }
    print_message("%d combinations: all means agree\n", done);
    free_stage(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pair_of_values_is_in_the_covering_set_and_none_is_idle),
        cmocka_unit_test(means_agree_with_brute_force_for_every_pair_of_values),
        cmocka_unit_test(means_agree_with_brute_force_for_the_full_product),
    };

    return cmocka_run_group_tests_name("product", tests, NULL, NULL);
}
