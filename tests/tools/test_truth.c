/* SPDX-License-Identifier: BSD-2-Clause */
/* The sum over patches that `bis verify` and `bis pixel` hold all methods against: against brute force, and its error
 * against what it promises. Chances are 1e-7 each, below 1e-4 for all of this file. */
#include "tools/truth.h"

#include "bis/base/stats.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/warp.h"
#include "bis/thesis/rng.h"
#include "bis/scene/light_load.h"
#include "claim.h"
#include "lit.h"
#include "map_help.h"
#include "thesis/proposal.h"
#include "threads.h"

#include <string.h>

static const double chance = 1e-7;
enum { CELLS = 1 << 13 };

static bis_truth truth_of(const bis_point *pt, uint64_t seed)
{
    bis_truth t;
    assert_int_equal(bis_truth_of(&t, &(bis_truth_question){pt, {4, 2, 1}, CELLS, seed, NULL, 0}, NULL), BIS_OK);
    return t;
}

static double measure(rgbd c) { return 4 * c.r + 2 * c.g + c.b; }

/* Brute force is good to 1e-4 (lit.h): midpoints, in patches that are all seen or all hidden. No ray exceeds the bound
 * of its cell, for lobes narrower than a patch (0.05) as well. */
static void it_is_brute_force_within_its_bound(void **state)
{
    const lit_map maps[] = {LIT_SPOTTY, LIT_SMOOTH, LIT_CONSTANT};
    const bis_material materials[] = {bis_phong(grey(0.4), (rgb){0.5f, 0.3f, 0.1f}, 20),
        bis_phong(grey(0), grey(0.9), 300), bis_microfacet(grey(0.3), (rgb){0.9f, 0.5f, 0.1f}, 0.4),
        bis_phong(grey(0.5), grey(0), 1)};
    for (size_t i = 0; i < 3; i++) {
        bis_light *light = lit_new_light(maps[i], 1, 0.15, false);
        for (size_t k = 0; k < 4; k++) {
            lit l;
            lit_init(&l, light, materials[k], normalize((vec3){0.3f, -0.4f, 0.8f}), 40, k % 2 ? LIT_OPEN : LIT_HALF);
            const bis_truth t = truth_of(&l.pt, 1 + k);
            const double seen = measure(lit_truth(&l, true)), open = measure(lit_truth(&l, false));
            if (!(fabs(t.lit.mean[3] - seen) <= bis_truth_bound(&t.lit, chance) + 1e-4 * seen))
                fail_msg("lit: map %zu, material %zu", i, k);
            if (!(fabs(t.open.mean[3] - open) <= bis_truth_bound(&t.open, chance) + 1e-4 * open))
                fail_msg("open: map %zu, material %zu", i, k);
            assert_true(bis_truth_bound(&t.lit, chance) < 0.02 * open);
            if (!(t.worst <= 1))
                fail_msg("a ray is %g times the bound of its cell: map %zu, material %zu", t.worst, i, k);
            assert_near(t.lit.mean[3], measure((rgbd){t.lit.mean[0], t.lit.mean[1], t.lit.mean[2]}), 1e-9 * seen);
        }
        bis_light_free(light);
    }
}

/* A lobe of 0.001 in patches of 0.2: constant light in one patch and its neighbours, so the answer is that of a
 * furnace. */
static void a_lobe_far_narrower_than_a_patch_is_found(void **state)
{
    bis_envmap em = map_new(32, 16);
    bis_light *light;
    const bis_light_desc desc = {.to_world = bis_xform_identity()};
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = grey(1);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, 0, NULL), BIS_OK);
    for (int k = 0; k < 4; k++) { /* the lobe in the middle of a patch, at its edges */
        lit l;
        lit_init(&l, light, bis_phong(grey(0), grey(1), 1e6), normalize(vec3_from(0.2 + 0.01 * k, -0.3, 0.8)), 10 + k,
            LIT_OPEN);
        const bis_truth t = truth_of(&l.pt, 3);
        /* energy: (n+2)/(2 pi) times the integral of cos^n cos theta is (n+2)/(n+1) cos theta_r, all but 1/n */
        assert_near(t.open.mean[3] / (7 * cos((10 + k) * PI / 180)), 1,
            bis_truth_bound(&t.open, chance) / t.open.mean[3] + 1e-4);
        assert_true(bis_truth_bound(&t.open, chance) < 0.02 * t.open.mean[3]);
        assert_true(t.worst <= 1);
    }
    bis_light_free(light);
}

/* Nothing is reflected: no ray is above its bound, which is 0 (make asan divides by no 0). */
static void what_is_black_has_a_sum_of_0(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    lit l;
    lit_init(&l, light, bis_phong(grey(0), grey(0), 1), (vec3){0, 0, 1}, 40, LIT_OPEN);
    const bis_truth t = truth_of(&l.pt, 1);
    for (int i = 0; i < 4; i++) assert_true(t.lit.mean[i] == 0 && t.open.mean[i] == 0);
    assert_true(t.worst == 0 && t.rays == 0 && bis_truth_bound(&t.open, chance) == 0);
    bis_light_free(light);
}

/* All light comes from one patch, of which a share is hidden. */
typedef struct curtain {
    bis_accel accel;
    double x; /* hides what lies beyond it along x */
} curtain;

static bool is_behind(const bis_accel *a, const ray *r) { return (double)r->d.x > ((const curtain *)a)->x; }

/* ---- sums by hand ---- */

/* A pixel of a map of 512 x 256: 0.7 degrees wide, so that f cos is next to constant in it. */
typedef struct lamp {
    int x, y;
    double Le, seen; /* seen: the share of it that no curtain hides */
} lamp;

enum { FINE_WIDTH = 512, FINE_HEIGHT = 256, LAMPS = 3 };

/* Hidden is what lies beyond a meridian. */
typedef struct meridian {
    bis_accel accel;
    vec3 across;
} meridian;

static bool is_across(const bis_accel *a, const ray *r) { return dot(r->d, ((const meridian *)a)->across) > 0; }

static const bis_accel_ops meridian_ops = {.name = "meridian", .occluded = is_across};

/* A light of these pixels alone, of the colour (1, 1/2, 1/4); *middle is the direction of the first. */
static bis_light *light_of_lamps(const lamp *lamps, int n, vec3 *middle)
{
    bis_envmap em = map_new(FINE_WIDTH, FINE_HEIGHT);
    const bis_light_desc desc = {.to_world = bis_xform_identity()};
    bis_light *light;
    for (int i = 0; i < n; i++)
        em.pixels[lamps[i].y * FINE_WIDTH + lamps[i].x] = rgb_from(lamps[i].Le, lamps[i].Le / 2, lamps[i].Le / 4);
    *middle = bis_envmap_direction(&em, lamps[0].x, lamps[0].y, 0.5, 0.5);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE, NULL), BIS_OK);
    return light;
}

static double size_of(const lamp *p)
{
    return 2 * PI / FINE_WIDTH * (cos(PI * p->y / FINE_HEIGHT) - cos(PI * (p->y + 1) / FINE_HEIGHT));
}

/* Mean, variance and third central moment of what has the value x[i] with the chance p[i], and else 0. */
static void moments_by_hand(double m[3], const double *x, const double *p, int n)
{
    double rest = 1;
    m[0] = m[1] = m[2] = 0;
    for (int i = 0; i < n; i++) m[0] += p[i] * x[i];
    for (int i = 0; i < n; i++) {
        m[1] += p[i] * pow(x[i] - m[0], 2);
        m[2] += p[i] * pow(x[i] - m[0], 3);
        rest -= p[i];
    }
    m[1] += rest * m[0] * m[0];
    m[2] -= rest * m[0] * m[0] * m[0];
}

static void assert_share(const char *what, double found, double expected, double scale)
{
    if (!(fabs(found - expected) <= 2e-3 * scale)) fail_msg("%s: %g, must be %g", what, found, expected);
}

/* Three lamps about the normal, two in one block of patches and one in another: in all of a lamp F is Le (4 0.7 + 2 0.6
 * / 2 + 0.5 / 4)/pi but for the cosine, 2e-4. The last quarter of the first one is hidden, on a border of cells, so
 * that V is constant in each, too: no pair of rays differs by more than the cosine does. No ray may have more than
 * 0.7/pi (4 + 2/2 + 1/4) Le. In units of that of the first lamp, the bounds are 1, 3 and 2; of 300 cells each has a
 * 50th: so 64, 256 and 256 cells are made. */
static void a_few_small_lamps_have_the_sums_by_hand(void **state)
{
    static const lamp lamps[LAMPS] = {{300, 100, 1, 0.75}, {299, 100, 3, 1}, {299, 101, 2, 1}};
    static const bis_truth_density q[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.25, 0.5, 0.25}};
    const double product = (4 * 0.7 + 2 * 0.6 / 2 + 0.5 / 4) / PI, most = 0.7 * (4 + 2 / 2.0 + 1 / 4.0) / PI;
    const double channel[3] = {0.7 / PI, 0.6 / PI / 2, 0.5 / PI / 4}, phi = 2 * PI * (300 + 0.75) / FINE_WIDTH;
    meridian m = {{&meridian_ops, NULL}, vec3_from(-sin(phi), cos(phi), 0)};
    double seen = 0, all = 0, weight = 0, variance = 0, third = 0;
    vec3 n;
    bis_light *light = light_of_lamps(lamps, LAMPS, &n);
    bis_truth t;
    lit l;
    lit_init(&l, light, bis_phong(rgb_from(0.7, 0.6, 0.5), grey(0), 1), n, 20, LIT_OPEN);
    l.pt.accel = &m.accel;
    assert_int_equal(bis_truth_of(&t, &(bis_truth_question){&l.pt, {4, 2, 1}, 300, 1, q, 4}, NULL), BIS_OK);
    assert_int_equal(t.patches, FINE_WIDTH * FINE_HEIGHT);
    assert_int_equal(t.rays, 2 * (64 + 256 + 256));
    for (int i = 0; i < LAMPS; i++) {
        const double F = lamps[i].Le * size_of(&lamps[i]), share = lamps[i].seen;
        all += F;
        seen += F * share;
        weight += F; /* the map's table, too, is by Le and size */
        variance += pow(product * F, 2) * share * (1 - share);
        third += pow(product * F, 3) * share * (1 - share) * (1 - 2 * share);
    }
    assert_share("lit", t.lit.mean[3], product * seen, product * seen);
    assert_share("open", t.open.mean[3], product * all, product * all);
    for (int k = 0; k < 3; k++) {
        assert_share("a channel, lit", t.lit.mean[k], channel[k] * seen, channel[k] * seen);
        assert_share("a channel, open", t.open.mean[k], channel[k] * all, channel[k] * all);
    }
    for (int k = 0; k < 4; k++) /* a pair differs by 2e-4 at most, and there are 576 */
        assert_true(sqrt(t.lit.variance[k]) < 2e-5 * t.lit.mean[k] && t.open.variance[k] <= 2 * t.lit.variance[k]);
    const double bound = most * lamps[0].Le * size_of(&lamps[0]) / 64;
    assert_share("largest of a cell", t.lit.most, bound / 2, bound / 2);
    assert_share("largest of a cell, open", t.open.most, bound / 2, bound / 2);
    const double B = most * all / 300, worst = product * size_of(&lamps[0]) / 64 / B;
    assert_share("worst", t.worst, worst, worst);
    assert_share("variance of a ray in each", t.one_ray.variance, variance, variance);
    assert_share("third moment of a ray in each", t.one_ray.third, third, fabs(third));
    assert_share("largest ray", t.one_ray.most, product * 3 * size_of(&lamps[1]), product * 3 * size_of(&lamps[1]));

    /* a sample of density q meets a lamp, where it is seen, with the chance q times its size, and then it is F/q */
    for (int k = 0; k < 4; k++) {
        double x[LAMPS], p[LAMPS], by_hand[3], largest = 0;
        for (int i = 0; i < LAMPS; i++) {
            const double size = size_of(&lamps[i]), q_L = lamps[i].Le / weight;
            const double d = q[k].from_map * q_L + q[k].from_bsdf / PI + q[k].uniform / (4 * PI);
            x[i] = product * lamps[i].Le / d;
            p[i] = d * size * lamps[i].seen;
            largest = fmax(largest, x[i]);
        }
        moments_by_hand(by_hand, x, p, LAMPS);
        assert_share("mean", t.lit.mean[3], by_hand[0], by_hand[0]);
        assert_share("variance of a sample", t.sample[k].variance, by_hand[1], by_hand[1]);
        const double scale = fabs(by_hand[2]) + pow(by_hand[1], 1.5);
        assert_share("third moment of a sample", t.sample[k].third, by_hand[2], scale);
        assert_share("largest sample", t.sample[k].most, largest, largest);
    }
    bis_light_free(light);
}

/* What `bis verify` did before: four rays in each patch, and their scatter. Returns z. */
static double four_rays(const bis_point *pt, double truth, uint64_t seed)
{
    double sum = 0, variance = 0;
    bis_rng rng;
    bis_rng_init(&rng, seed, 0, 0, 99);
    for (size_t i = 0; i < bis_light_patches(pt->light); i++) {
        double x[4], mean = 0;
        for (int k = 0; k < 4; k++) {
            bis_light_point y;
            const double u0 = bis_rng_double(&rng), u[2] = {u0, bis_rng_double(&rng)};
            bis_light_patch(pt->light, i, u, &y);
            const double c = bis_bsdf_cos(&pt->bsdf, y.wi),
                         F = c > 0 ? (double)bis_bsdf_f(&pt->bsdf, y.wi).r * (double)y.Le.r * c * 7 / y.pdf : 0;
            x[k] = F > 0 && bis_point_sees(pt, y.wi) ? F : 0;
            mean += x[k] / 4;
        }
        sum += mean;
        for (int k = 0; k < 4; k++) variance += (x[k] - mean) * (x[k] - mean) / 12;
    }
    return (sum - truth) / sqrt(variance);
}

/* The defect: of a patch that is hidden by a tenth, four rays see all two times in three, and think that they know it.
 * A sum of midpoints, 1000 x 1000 in the patch, is the truth. */
static void a_patch_hidden_by_a_tenth_does_not_look_exact(void **state)
{
    enum { SEEDS = 60, FINE = 1000 };
    static const bis_accel_ops ops = {.name = "curtain", .occluded = is_behind};
    bis_envmap em = map_new(16, 8);
    bis_light *light;
    const size_t bright = 2 * 16 + 1;
    const bis_light_desc desc = {.to_world = bis_xform_identity()};
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = grey(0.001);
    em.pixels[bright] = grey(10);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, 0, NULL), BIS_OK);
    curtain c = {{&ops, NULL}, 0.78};
    lit l;
    lit_init(&l, light, bis_phong(grey(0.7), grey(0), 1), (vec3){0, 0, 1}, 20, LIT_OPEN);
    l.pt.accel = &c.accel;

    double truth = 0, all = 0;
    for (size_t i = 0; i < bis_light_patches(light); i++) {
        const int n = i == bright ? FINE : 64;
        double sum = 0;
        for (int k = 0; k < n * n; k++) {
            bis_light_point y;
            bis_light_patch(light, i, (double[]){(k % n + 0.5) / n, (k / n + 0.5) / n}, &y);
            const double F = fmax(0, (double)y.wi.z) * 0.7 / PI * (double)y.Le.r * 7 / y.pdf / (n * n);
            sum += (double)y.wi.x > c.x ? 0 : F;
            all += F;
        }
        truth += sum;
    }
    if (!(truth < 0.95 * all && truth > 0.85 * all)) fail_msg("%g of it is seen", truth / all);

    int accused = 0;
    double worst = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        const bis_truth t = truth_of(&l.pt, seed);
        const double e = fabs(t.lit.mean[3] - truth);
        worst = fmax(worst, e / bis_truth_bound(&t.lit, chance));
        assert_true(bis_truth_bound(&t.lit, chance) < 0.02 * truth);
        accused += fabs(four_rays(&l.pt, truth, seed)) > 4; /* normal: 1 in 16000 */
    }
    if (!(worst <= 1)) fail_msg("off by %g bounds", worst);
    if (accused <= SEEDS / 20) fail_msg("the twin, four rays a patch, is off in %d of %d runs only", accused, SEEDS);
    bis_light_free(light);
}

/* Nothing scatters, and the bound is not 0: 2 M sqrt(l/2) sqrt(2 l) + M l/3, l = log(3/chance), by hand. */
static void a_scatter_of_0_promises_no_error_of_0(void **state)
{
    const bis_truth_sum still = {.most = 1e-3}, known = {.variance = {0, 0, 0, 4}};
    const double l = log(3 / 1e-7);
    assert_near(bis_truth_bound(&still, 1e-7), 1e-3 * (2 * l + l / 3), 1e-15);
    assert_near(bis_truth_bound(&known, 1e-7), 2 * sqrt(2 * l), 1e-12);
    assert_near(bis_truth_deviation(&still, exp(-2)), 1e-3 * (1 + 1), 1e-15);
}

/* Moments of one sample of a density, and of one ray in each patch, against 10^5 draws of them. */
static void moments_are_those_of_draws(void **state)
{
    enum { N = 200000 };
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    const bis_truth_density q[] = {{1, 0, 0}, {0.5, 0.5, 0}, {0.2, 0.3, 0.5}};
    bis_truth t;
    lit l;
    lit_init(&l, light, bis_phong(grey(0.4), (rgb){0.5f, 0.3f, 0.1f}, 20), normalize((vec3){0.3f, -0.4f, 0.8f}), 40,
        LIT_HALF);
    assert_int_equal(bis_truth_of(&t, &(bis_truth_question){&l.pt, {4, 2, 1}, CELLS, 1, q, 3}, NULL), BIS_OK);
    for (int k = 0; k < 3; k++) {
        double sum = 0, square = 0;
        bis_rng rng;
        bis_rng_init(&rng, 5, 0, 0, 98);
        for (int i = 0; i < N; i++) {
            bis_light_point y = {.pdf = 0};
            vec3 wi;
            double u[4];
            for (int j = 0; j < 4; j++) u[j] = bis_rng_double(&rng);
            if (i % 10 < 10 * q[k].from_map) {
                bis_light_sample(light, u, &y);
                wi = y.wi;
            } else if (i % 10 < 10 * (q[k].from_map + q[k].from_bsdf)) {
                bis_bsdf_sample(&l.pt.bsdf, u[0], u[1], u[2], &wi);
            } else {
                wi = bis_warp_sphere(u[0], u[1]);
            }
            const double p = q[k].from_map * bis_light_pdf(light, wi) + q[k].from_bsdf * bis_bsdf_pdf(&l.pt.bsdf, wi) +
                             q[k].uniform * 0.079577471545947668; /* 1/(4 pi) */
            const double c = bis_bsdf_cos(&l.pt.bsdf, wi);
            if (c <= 0 || !bis_point_sees(&l.pt, wi)) continue;
            const double x = measure(bis_estimate(bis_bsdf_f(&l.pt.bsdf, wi), bis_light_Le(light, wi), c, p));
            sum += x / N;
            square += x * x / N;
        }
        /* of 2e5 draws, with a kurtosis below 20: 1 % is 1 standard error of the variance */
        assert_near((square - sum * sum) / t.sample[k].variance, 1, 0.05);
    }
    bis_settings s = bis_settings_default(&bis_exact);
    double x[300], mean = 0, m2 = 0;
    bis_scratch scratch;
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (uint64_t run = 0; run < 300; run++) {
        const rgb e = lit_once(&l, &s, &scratch, 7, run);
        x[run] = measure((rgbd){(double)e.r, (double)e.g, (double)e.b});
        mean += x[run] / 300;
    }
    bis_scratch_clear(&scratch);
    for (int i = 0; i < 300; i++) m2 += (x[i] - mean) * (x[i] - mean) / 299;
    const double p = bis_stats_chi_square_p(m2 * 299 / t.one_ray.variance, 299);
    assert_true(p > 1e-5 && p < 1 - 1e-5);
    bis_light_free(light);
}

static void the_same_bits_for_any_number_of_threads(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    bis_truth a, b;
    lit l;
    lit_init(&l, light, bis_phong(grey(0.4), grey(0.5), 20), (vec3){0, 0, 1}, 40, LIT_HALF);
    const int before = use_threads(1);
    a = truth_of(&l.pt, 5);
    use_threads(3);
    b = truth_of(&l.pt, 5);
    use_threads(before);
    assert_memory_equal(&a, &b, sizeof a);
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_brute_force_within_its_bound),
        cmocka_unit_test(a_lobe_far_narrower_than_a_patch_is_found),
        cmocka_unit_test(what_is_black_has_a_sum_of_0),
        cmocka_unit_test(a_few_small_lamps_have_the_sums_by_hand),
        cmocka_unit_test(a_patch_hidden_by_a_tenth_does_not_look_exact),
        cmocka_unit_test(a_scatter_of_0_promises_no_error_of_0),
        cmocka_unit_test(moments_are_those_of_draws),
        cmocka_unit_test(the_same_bits_for_any_number_of_threads),
    };
    return cmocka_run_group_tests_name("truth", tests, NULL, NULL);
}
