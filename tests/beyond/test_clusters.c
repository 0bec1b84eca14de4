/* clusters, product, visibility: candidates from where light and BRDF can both be large, and where earlier passes saw
 * the light. Family-wise significance 1e-3 over all statistical tests here. */
#include "beyond/batch.h"
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "lit.h"
#include "beyond/product.h"
#include "thesis/proposal.h"

#include "bis/base/stats.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"
#include "bis/scene/light_load.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { SEED = 71, RUNS = 200, PER_FILL = 20 };

static double alpha(void) { return stat_level(1e-3, 4 * 4 * 2 * 4 + 1); }

static vec3 tilted(void) { return normalize((vec3){0.3f, 0.1f, 1}); }

static const lit_map maps[] = {LIT_SPOTTY, LIT_SMOOTH};

/* ---- the cut ---- */

static void clusters_share_the_curve_and_none_is_empty(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        bis_light *light = lit_new_light(maps[i], 1, 0.15, false);
        const bis_importance *im = bis_light_importance(light);
        bis_clusters c;
        assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
        assert_true(c.n > 1 && c.n <= 2 * BIS_CLUSTERS + 2);
        assert_true(c.t[0] == 0 && c.t[c.n] == 1);
        double *sum = bis_alloc(c.n, sizeof *sum);
        const bis_envmap *em = bis_light_envmap(light);
        for (uint32_t p = 0; p < (uint32_t)(em->width * em->height); p++) {
            sum[bis_cluster_of_pixel(&c, p)] += bis_importance_pdf_pixel(im, p) * em->row_solid_angle[p / (uint32_t)em->width];
        }
        for (uint32_t k = 0; k < c.n; k++) {
            assert_true(bis_cluster_share(&c, k) > 0);
            assert_true(fabs(sum[k] - bis_cluster_share(&c, k)) < 1e-12); /* of_tile says the same as t */
        }
        bis_free(sum);
        bis_clusters_clear(&c);
        bis_light_free(light);
    }
}

/* Where inside its pixel a direction lies: its two places are independent, so that half of all lie in the two quarters
 * of the diagonal, wherever each of them has its middle, since the azimuth is even. Other passes have other
 * directions. The twin takes one number for both. */
static void directions_fill_their_pixels_and_are_drawn_anew_in_each_pass(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_envmap *em = bis_light_envmap(light);
    bis_clusters c;
    vec3 first = {0, 0, 0};
    double diagonal = 0, n = 0;

    (void)state;
    assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
    for (uint32_t pass = 0; pass < 4; pass++) {
        bis_clusters_fill(&c, light, SEED, pass, 1);
        assert_true(pass == 0 || c.y[0].wi.x != first.x || c.y[0].wi.y != first.y);
        first = c.y[0].wi;
        for (uint32_t i = 0; i < c.n * BIS_CLUSTER_DIRECTIONS; i++, n++) {
            const vec3 wi = c.y[i].wi;
            const double turns = atan2((double)wi.y, (double)wi.x) / (2 * PI),
                x = (turns < 0 ? turns + 1 : turns) * em->width,
                         y = acos(fmax(-1, fmin(1, (double)wi.z))) / PI * em->height;
            diagonal += (x - floor(x) < 0.5) == (y - floor(y) < 0.5);
        }
    }
    /* one binomial, in the normal approximation: n is thousands */
    const double z = (diagonal - n / 2) / sqrt(n / 4);
    stat_judges(1);
    assert_true(n > 4000 && bis_stats_normal_p(z) > alpha());
    bis_clusters_clear(&c);
    bis_light_free(light);
}

/* Each cluster is compact, so that one cone describes it: K of them would share the sphere evenly, and a piece of the
 * curve is cut when it has a K-th of the sphere, which one tile of 4 x 4 pixels may exceed. Where the map has light
 * everywhere; the dark half has a hundredth of the importance, and cut by importance alone it would be one or two
 * pieces. */
static void no_cluster_is_larger_than_its_share_of_the_sphere(void **state)
{
    const bis_light_desc desc = {.L = {1, 1, 1}, .scale = 1, .levels = 8, .to_world = bis_xform_identity()};
    bis_image image;
    bis_envmap map;
    bis_light *light;
    bis_clusters c;

    (void)state;
    assert_int_equal(bis_image_init(&image, 128, 64, NULL), BIS_OK);
    for (int i = 0; i < 128 * 64; i++) image.pixels[i] = i % 128 < 64 ? grey(100) : grey(1);
    assert_int_equal(bis_envmap_from_latlong(&map, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &map, &desc, BIS_NEED_CURVE, NULL), BIS_OK);
    assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
    const bis_envmap *em = bis_light_envmap(light);
    double *angle = bis_alloc(c.n, sizeof *angle), most = 0;
    for (uint32_t p = 0; p < 128 * 64; p++) angle[bis_cluster_of_pixel(&c, p)] += em->row_solid_angle[p / 128];
    for (uint32_t k = 0; k < c.n; k++) most = fmax(most, angle[k]);
    assert_true(most < 4 * PI / BIS_CLUSTERS + 16 * em->row_solid_angle[31]);
    bis_free(angle);
    bis_clusters_clear(&c);
    bis_light_free(light);
}

static void a_cluster_s_directions_lie_in_it_and_in_its_cone(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_envmap *em = bis_light_envmap(light);
    bis_clusters c;
    int elsewhere = 0;

    (void)state;
    assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
    bis_clusters_fill(&c, light, SEED, 3, 2);
    for (uint32_t k = 0; k < c.n; k++) {
        const vec3 axis = {c.cone.x[k], c.cone.y[k], c.cone.z[k]};
        for (int i = 0; i < BIS_CLUSTER_DIRECTIONS; i++) {
            const bis_cluster_point *y = &c.y[(size_t)k * BIS_CLUSTER_DIRECTIONS + (size_t)i];
            elsewhere += bis_cluster_of_pixel(&c, (uint32_t)bis_envmap_pixel(em, y->wi)) != k; /* the light's axes are the world's; floats next to an edge */
            assert_true(dot(axis, y->wi) >= (double)c.cone.q_L[k] - 1e-6);
        }
    }
    assert_true(elsewhere < (int)c.n * BIS_CLUSTER_DIRECTIONS / 1000);
    bis_clusters_clear(&c);
    bis_light_free(light);
}

/* ---- the bound ---- */

/* w of a cluster against f cos Le of all its directions: at least the mean over the energy, and positive wherever any
 * is. */
static void reach_bounds_the_product_over_every_cluster(void **state)
{
    static const double exponents[] = {0, 1, 10, 50, 1e3, 1e6};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    bis_clusters c;
    bis_product p;

    (void)state;
    assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
    assert_true(bis_product_init(&p, 64));
    bis_clusters_fill(&c, light, SEED, 0, 1);
    for (int e = 0; e < 6; e++) {
        lit l;
        lit_init(&l, light, bis_phong((rgb){0.1f, 0.2f, 0}, (rgb){0.9f, 0.3f, 0.5f}, exponents[e]), tilted(), 70, LIT_OPEN);
        bis_product_weigh(&p, &c, NULL, &l.pt);
        double unit = 0, worst = (double)INFINITY;
        for (int pass = 0; pass < 2; pass++) { /* the unit is whatever makes the bound hold; it must be the same for all clusters */
            for (uint32_t k = 0; k < c.n; k++) {
                double mean = 0, most = 0;
                for (int i = 0; i < BIS_CLUSTER_DIRECTIONS; i++) {
                    const bis_cluster_point *y = &c.y[(size_t)k * BIS_CLUSTER_DIRECTIONS + (size_t)i];
                    const double cosine = bis_bsdf_cos(&l.pt.bsdf, y->wi);
                    if (cosine <= 0) continue;
                    const double F = rgbd_sum(bis_estimate(bis_bsdf_f(&l.pt.bsdf, y->wi), y->Le, cosine, (double)y->q_L));
                    mean += F * bis_cluster_share(&c, k) / BIS_CLUSTER_DIRECTIONS;
                    most = fmax(most, F);
                }
                if (most > 0) assert_true(p.clusters.w[k] > 0);
                if (mean > 1e-25) worst = fmin(worst, (double)p.clusters.w[k] / mean);
            }
            if (pass == 0) unit = worst;
        }
        const double peak = fmax((double)l.material.Ks.r * (exponents[e] + 1) * INV_PI / 2, (double)l.material.Kd.g * INV_PI);
        assert_true(unit >= (1 - 1e-4) / peak);
    }
    bis_product_clear(&p);
    bis_clusters_clear(&c);
    bis_light_free(light);
}

/* ---- the estimate ---- */

static void spoil_nothing(bis_clusters *c, float *visible)
{
    (void)c;
    (void)visible;
}

/* As test_pool's: several points share the directions of a pass; their mean is one value. */
static void run(stat_moments m[4], lit *l, const bis_settings *s, bool learned, void (*spoil)(bis_clusters *, float *))
{
    bis_scratch scratch;
    bis_fast fast;
    bis_clusters c;
    bis_seen counted[BIS_VISIBILITY_PARTS] = {{0, 0}};

    for (int i = 0; i < 4; i++) m[i] = (stat_moments){0};
    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    assert_int_equal(bis_fast_init(&fast, s, NULL), BIS_OK);
    assert_true(bis_fast_needs_of(s).clusters);
    scratch.fast = &fast;
    assert_int_equal(bis_clusters_init(&c, l->light, s->candidates, NULL), BIS_OK);
    fast.clusters = &c;
    fast.counted = counted;
    if (learned) {
        fast.visible = bis_alloc(bis_lanes_round_up(c.n), sizeof *fast.visible);
        for (uint32_t k = 0; k < c.n; k++) fast.visible[k] = k % 3 ? 0.15f : 1; /* any positive numbers */
    }
    for (uint32_t fill = 0; fill < RUNS; fill++) {
        rgbd sum = {0, 0, 0};
        bis_clusters_fill(&c, l->light, SEED, fill, 1);
        spoil(&c, fast.visible);
        for (uint32_t k = 0; k < PER_FILL; k++) {
            const rgb L = lit_once(l, s, &scratch, SEED, (uint64_t)fill * PER_FILL + k);
            sum = rgbd_add(sum, (rgbd){(double)L.r / PER_FILL, (double)L.g / PER_FILL, (double)L.b / PER_FILL});
        }
        stat_add(&m[0], sum.r);
        stat_add(&m[1], sum.g);
        stat_add(&m[2], sum.b);
        stat_add(&m[3], rgbd_sum(sum));
    }
    bis_scratch_clear(&scratch);
    bis_fast_clear(&fast);
    bis_clusters_clear(&c);
}

static bis_settings product(uint32_t M, uint32_t N, bool learn)
{
    bis_settings s = bis_settings_default(&bis_sir);
    s.proposal = BIS_PROPOSAL_PRODUCT;
    s.candidates = M;
    s.shadowrays = N;
    s.learn = learn;
    return s;
}

/* A thread's workspace serves point after point, of other materials, of which other shares of M come from the map:
 * what one point has left there changes no bit of the next. */
static void a_used_workspace_gives_the_bits_of_a_new_one(void **state)
{
    static const uint32_t Ms[] = {16, 40, 64, 250};
    static const double exponents[] = {1, 5000, 10, 300, 50, 100000, 3, 1000};

    (void)state;
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    for (int i = 0; i < 4; i++) {
        const bis_settings s = product(Ms[i], 5, false);
        bis_scratch used, fresh;
        bis_fast used_fast, fresh_fast;
        bis_clusters c;
        assert_int_equal(bis_clusters_init(&c, light, Ms[i], NULL), BIS_OK);
        bis_clusters_fill(&c, light, SEED, 0, 1);
        assert_int_equal(bis_scratch_init(&used, &s, NULL), BIS_OK);
        assert_int_equal(bis_fast_init(&used_fast, &s, NULL), BIS_OK);
        used_fast.clusters = &c;
        used.fast = &used_fast;
        for (uint64_t k = 0; k < 64; k++) {
            lit l;
            lit_init(&l, light, bis_phong((rgb){0.3f, 0.2f, 0.1f}, (rgb){0.6f, 0.6f, 0.4f}, exponents[k % 8]),
                tilted(), k % 3 ? 30 : 75, LIT_OPEN);
            assert_int_equal(bis_scratch_init(&fresh, &s, NULL), BIS_OK);
            assert_int_equal(bis_fast_init(&fresh_fast, &s, NULL), BIS_OK);
            fresh_fast.clusters = &c;
            fresh.fast = &fresh_fast;
            const rgb a = lit_once(&l, &s, &used, SEED, k), b = lit_once(&l, &s, &fresh, SEED, k);
            assert_memory_equal(&a, &b, sizeof a);
            bis_scratch_clear(&fresh);
            bis_fast_clear(&fresh_fast);
        }
        bis_scratch_clear(&used);
        bis_fast_clear(&used_fast);
        bis_clusters_clear(&c);
    }
    bis_light_free(light);
}

static void product_is_unbiased_with_and_without_learned_visibility(void **state)
{
    static const uint32_t Ms[] = {16, 17, 64, 256};
    const bis_material materials[] = {bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1), bis_phong((rgb){0, 0, 0}, (rgb){1, 0.8f, 0.6f}, 10),
                                      bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.5f, 0.5f, 0.5f}, 50),
                                      bis_phong((rgb){0, 0, 0}, (rgb){1, 0.8f, 0.6f}, 1000)}; /* which gets candidates from the BRDF, too */
    (void)state;
    for (int i = 0; i < 4 * 4 * 2; i++) {
        bis_light *light = lit_new_light(maps[(i / 4 + i / 16) % 2], 1, 0.15, false);
        const bool learned = i / 16;
        const bis_settings s = product(Ms[i % 4], i % 5 ? 3 : 15, learned);
        stat_moments m[4];
        lit l;
        lit_init(&l, light, materials[i / 4 % 4], tilted(), 40, i % 2 ? LIT_HALF : LIT_OPEN);
        const rgbd truth = lit_truth(&l, true);
        const double expected[4] = {truth.r, truth.g, truth.b, rgbd_sum(truth)};
        run(m, &l, &s, learned, spoil_nothing);
        for (int c = 0; c < 4; c++) stat_assert_mean("product", SEED, &m[c], expected[c], alpha());
        bis_light_free(light);
    }
}

/* Twin: every second cluster draws from the first, with its own density. */
static void draw_elsewhere(bis_clusters *c, float *visible)
{
    enum { D = BIS_CLUSTER_DIRECTIONS };
    (void)visible;
    for (uint32_t k = 1; k < c->n; k += 2) {
        for (int i = 0; i < D; i++) c->y[(size_t)k * D + (size_t)i] = c->y[i];
    }
}

/* Twin: a bound of 0 over every second cluster, where the product is not 0. */
static void overlook_clusters(bis_clusters *c, float *visible)
{
    (void)visible;
    for (uint32_t k = 0; k < c->n; k += 2) c->cone.r[k] = c->cone.g[k] = c->cone.b[k] = 0;
}

static void twins_with_a_wrong_density_or_a_bound_of_0_are_found(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    stat_moments m[4];
    lit l;

    (void)state;
    lit_init(&l, light, bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1), (vec3){0, 0, 1}, 40, LIT_OPEN);
    const double truth = rgbd_sum(lit_truth(&l, true));
    const bis_settings s = product(64, 3, false);
    run(m, &l, &s, false, draw_elsewhere);
    stat_assert_not_mean("product-elsewhere", SEED, &m[3], truth, alpha());
    run(m, &l, &s, false, overlook_clusters);
    stat_assert_not_mean("product-bound", SEED, &m[3], truth, alpha());
    bis_light_free(light);
}

/* ---- what is learned ---- */

static void factors_follow_what_was_seen_in_the_passes_before(void **state)
{
    enum { N = 300 };
    bis_visibility v;
    float g[N];

    (void)state;
    assert_int_equal(bis_visibility_init(&v, 2, NULL), BIS_OK);
    v.counted[1][0] = (bis_seen){1000, 0};
    v.counted[1][1] = (bis_seen){1000, 1000};
    bis_visibility_factors(g, N, &v, 1);
    for (int k = 1; k < N; k++) assert_true(g[k] == g[0]); /* this pass's counts are not known */
    bis_visibility_learn(&v, 1);
    assert_true(v.counted[1][0].rays == 0);
    bis_visibility_factors(g, N, &v, 1);
    assert_true(g[0] > 0.1f && g[0] < 0.2f);
    assert_true(g[3] > 1 && g[3] < 1.02f && g[N - 1] == g[3]); /* k = 3 of 300 is of part 1; never counted is as if seen */
    bis_visibility_factors(g, N, &v, 0);
    assert_true(g[0] == g[N - 1]);
    bis_visibility_clear(&v);
}

static void without_memory_nothing_is_held(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    bis_settings s = product(64, 3, true);

    (void)state;
    for (long k = 1; k < 40; k++) {
        bis_clusters c;
        bis_visibility v;
        bis_scratch scratch;
        bis_mem_fail_at(k);
        if (bis_clusters_init(&c, light, 256, NULL) == BIS_OK) bis_clusters_clear(&c);
        bis_mem_fail_at(k);
        if (bis_visibility_init(&v, 3, NULL) == BIS_OK) bis_visibility_clear(&v);
        bis_mem_fail_at(k);
        if (bis_scratch_init(&scratch, &s, NULL) == BIS_OK) bis_scratch_clear(&scratch);
        bis_mem_fail_at(0);
    }
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clusters_share_the_curve_and_none_is_empty),
        cmocka_unit_test(directions_fill_their_pixels_and_are_drawn_anew_in_each_pass),
        cmocka_unit_test(no_cluster_is_larger_than_its_share_of_the_sphere),
        cmocka_unit_test(a_cluster_s_directions_lie_in_it_and_in_its_cone),
        cmocka_unit_test(reach_bounds_the_product_over_every_cluster),
        cmocka_unit_test(a_used_workspace_gives_the_bits_of_a_new_one),
        cmocka_unit_test(product_is_unbiased_with_and_without_learned_visibility),
        cmocka_unit_test(twins_with_a_wrong_density_or_a_bound_of_0_are_found),
        cmocka_unit_test(factors_follow_what_was_seen_in_the_passes_before),
        cmocka_unit_test(without_memory_nothing_is_held),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
