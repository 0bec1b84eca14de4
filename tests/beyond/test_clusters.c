/* SPDX-License-Identifier: BSD-2-Clause */
/* clusters, product, visibility: candidates from where light and BRDF can both be large, and where earlier passes saw
 * the light. Family-wise significance 1e-3 over all statistical tests here. */
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "guided.h"
#include "set_help.h"
#include "thesis/proposal.h"

#include "bis/base/stats.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"
#include "bis/scene/light_load.h"

#include <string.h>

enum { SEED = 71, RUNS = 200, PER_FILL = 20 };

static double alpha(void) { return stat_level(1e-3, 4 * 4 * 2 * 4 + 1 + 3 + 17 + 3); }

static vec3 tilted(void) { return normalize((vec3){0.3f, 0.1f, 1}); }

static const lit_map maps[] = {LIT_SPOTTY, LIT_SMOOTH};

/* ---- the cut ---- */

static void clusters_share_the_curve_and_none_is_empty(void **state)
{
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
            sum[bis_cluster_of_pixel(&c, p)] +=
                bis_importance_pdf_pixel(im, p) * em->row_solid_angle[p / (uint32_t)em->width];
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

/* Where one pixel of a small map is a wide lamp and a cluster of its own, its directions have each of 8 x 8 cells of
 * it equally often, but for those that floats take over an edge. Directions at random would have a quarter of the cells
 * so, and all points of a pass would share what that does to them. */
static void the_directions_of_a_wide_lamp_are_spread_over_it(void **state)
{
    enum { X = 2, Y = 1, CELLS = 8 };
    const bis_light_desc desc = {.L = {1, 1, 1}, .scale = 1, .levels = 8, .to_world = bis_xform_identity()};
    bis_image image;
    bis_envmap map;
    bis_light *light;
    bis_clusters c;
    uint32_t count[CELLS * CELLS] = {0};
    int even = 0;

    assert_int_equal(bis_image_init(&image, 8, 4, NULL), BIS_OK);
    for (int i = 0; i < 8 * 4; i++) image.pixels[i] = grey(i == Y * 8 + X ? 100 : 1);
    assert_int_equal(bis_envmap_from_latlong(&map, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &map, &desc, BIS_NEED_CURVE, NULL), BIS_OK);
    assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
    assert_true(bis_clusters_are_wide(&c));
    bis_clusters_fill(&c, light, SEED, 0, 1);
    const uint32_t lamp = bis_cluster_of_pixel(&c, Y * 8 + X), each = c.directions / (CELLS * CELLS);
    assert_true(each >= 1 && (lamp == 0 || bis_cluster_of_pixel(&c, Y * 8 + X - 1) != lamp));
    for (uint32_t i = 0; i < c.directions; i++) {
        const vec3 wi = c.y[lamp * c.directions + i].wi;
        /* the place in the pixel: evenly by azimuth and by the cosine, as solid angle is */
        const double turns = atan2((double)wi.y, (double)wi.x) / (2 * PI), top = cos(PI / 4 * Y);
        const double x = (turns < 0 ? turns + 1 : turns) * 8 - X;
        const double y = (top - (double)wi.z) / (top - cos(PI / 4 * (Y + 1)));
        const int column = (int)(x * CELLS), row = (int)(y * CELLS);
        assert_true(column >= 0 && column <= CELLS && row >= 0 && row <= CELLS);
        if (column < CELLS && row < CELLS) count[row * CELLS + column]++;
    }
    for (int i = 0; i < CELLS * CELLS; i++) even += count[i] == each;
    assert_true(even > CELLS * CELLS * 9 / 10);
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

    assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
    bis_clusters_fill(&c, light, SEED, 3, 2);
    for (uint32_t k = 0; k < c.n; k++) {
        const vec3 axis = {c.cone.x[k], c.cone.y[k], c.cone.z[k]};
        for (int i = 0; i < BIS_CLUSTER_DIRECTIONS; i++) {
            const bis_cluster_point *y = &c.y[(size_t)k * BIS_CLUSTER_DIRECTIONS + (size_t)i];
            elsewhere += bis_cluster_of_pixel(&c, (uint32_t)bis_envmap_pixel(em, y->wi)) !=
                         k; /* the light's axes are the world's; floats next to an edge */
            assert_true(dot(axis, y->wi) >= (double)c.cone.cosine[k] - 1e-6);
        }
    }
    assert_true(elsewhere < (int)c.n * BIS_CLUSTER_DIRECTIONS / 1000);
    bis_clusters_clear(&c);
    bis_light_free(light);
}

/* A cone's axis is the mean of its directions, its edge the farthest of them, its energy the cluster's share of the
 * importance times the mean of Le/q_L; a direction has the radiance and the density of the light there. */
static void a_cone_is_the_narrowest_about_the_mean_direction(void **state)
{
    for (int map = 0; map < 2; map++) {
        bis_light *light = lit_new_light(maps[map], 1, 0.15, false);
        bis_clusters c;
        assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
        bis_clusters_fill(&c, light, SEED, 4, 1);
        for (uint32_t k = 0; k < c.n; k++) {
            const bis_cluster_point *y = &c.y[(size_t)k * c.directions];
            const vec3 axis = {c.cone.x[k], c.cone.y[k], c.cone.z[k]};
            double sum[3] = {0}, E[3] = {0}, least = 1;
            for (uint32_t i = 0; i < c.directions; i++) {
                const double w[3] = {(double)y[i].wi.x, (double)y[i].wi.y, (double)y[i].wi.z};
                const double Le[3] = {(double)y[i].Le.r, (double)y[i].Le.g, (double)y[i].Le.b};
                const rgb L = bis_light_Le(light, y[i].wi);
                for (int j = 0; j < 3; j++)
                    sum[j] += w[j], E[j] += Le[j] / (double)y[i].q_L * bis_cluster_share(&c, k) / c.directions;
                least = fmin(least, dot(axis, y[i].wi));
                if (fabs((double)y[i].q_L / bis_light_pdf(light, y[i].wi) - 1) > 1e-6) continue; /* next to an edge */
                assert_true(fabs(Le[1] * bis_light_mean(light) - (double)L.g) <= 1e-6 * (double)L.g);
            }
            const double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
            assert_true(fabs((double)axis.x - sum[0] / length) < 1e-7 && fabs((double)axis.y - sum[1] / length) < 1e-7);
            assert_true(fabs((double)axis.z - sum[2] / length) < 1e-7);
            assert_true(fabs((double)c.cone.cosine[k] - least) < 1e-7);
            const double sine = (double)c.cone.sine[k]; /* never too small, and at most 2^-19 in its square too large */
            assert_true(sine * sine >= 1 - least * least && sine * sine <= 1 - least * least + 0x1p-19);
            assert_true(fabs((double)c.cone.r[k] - E[0]) <= 1e-6 * E[0]);
            assert_true(fabs((double)c.cone.g[k] - E[1]) <= 1e-6 * E[1]);
            assert_true(fabs((double)c.cone.b[k] - E[2]) <= 1e-6 * E[2]);
        }
        bis_clusters_clear(&c);
        bis_light_free(light);
    }
}

/* ---- the bound ---- */

static void new_product(bis_product *p)
{
    bis_claims claims = {0};

    bis_product_claim(p, &claims);
    assert_false(claims.failed);
}

/* w of a cluster against f cos Le of all its directions: at least the mean over the energy, and positive wherever any
 * is. */
static void reach_bounds_the_product_over_every_cluster(void **state)
{
    static const double exponents[] = {0, 1, 10, 50, 1e3, 1e6};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    bis_clusters c;
    bis_product p;

    assert_int_equal(bis_clusters_init(&c, light, 256, NULL), BIS_OK);
    new_product(&p);
    bis_clusters_fill(&c, light, SEED, 0, 1);
    for (int e = 0; e < 6; e++) {
        lit l;
        lit_init(
            &l, light, bis_phong((rgb){0.1f, 0.2f, 0}, (rgb){0.9f, 0.3f, 0.5f}, exponents[e]), tilted(), 70, LIT_OPEN);
        bis_product_weigh(&p, &c, &l.pt.bsdf);
        double unit = 0, worst = (double)INFINITY;
        for (int pass = 0; pass < 2;
            pass++) { /* the unit is whatever makes the bound hold; it must be the same for all clusters */
            for (uint32_t k = 0; k < c.n; k++) {
                double mean = 0, most = 0;
                for (int i = 0; i < BIS_CLUSTER_DIRECTIONS; i++) {
                    const bis_cluster_point *y = &c.y[(size_t)k * BIS_CLUSTER_DIRECTIONS + (size_t)i];
                    const double cosine = bis_bsdf_cos(&l.pt.bsdf, y->wi);
                    if (cosine <= 0) continue;
                    const double F =
                        rgbd_sum(bis_estimate(bis_bsdf_f(&l.pt.bsdf, y->wi), y->Le, cosine, (double)y->q_L));
                    mean += F * bis_cluster_share(&c, k) / BIS_CLUSTER_DIRECTIONS;
                    most = fmax(most, F);
                }
                if (most > 0) assert_true(p.clusters.w[k] > 0);
                if (mean > 1e-25) worst = fmin(worst, (double)p.clusters.w[k] / mean);
            }
            if (pass == 0) unit = worst;
        }
        const double peak =
            fmax((double)l.material.Ks.r * (exponents[e] + 1) * INV_PI / 2, (double)l.material.Kd.g * INV_PI);
        assert_true(unit >= (1 - 1e-4) / peak);
    }
    bis_product_clear(&p);
    bis_clusters_clear(&c);
    bis_light_free(light);
}

/* ---- the estimate ---- */

/* learned: any positive h of a cell and of a square, any mean. */
static void open_workspace(workspace *w, const bis_light *light, const bis_settings *s, bool learned)
{
    guided_open(w, light, s, learned);
    w->guide.guess.knows = w->guide.guess.has_square = learned;
    for (uint32_t k = 0; learned && k < w->c.n; k++) {
        w->guide.guess.own[k] = k % 3 ? 0.15f : 1;
        w->guide.guess.of_square[k] = k % 7 ? 0.02f : 0.9f;
        w->guide.guess.g[k] = w->guide.guess.own[k] * (k % 5 ? 0.3f : 1.5f); /* N up to thrice, from point to point */
    }
}

/* As test_pool's: several points share the directions of a pass, more of them where candidates are few; their mean is
 * one value. spoil: twins. */
static void run(stat_moments m[4], lit *l, const bis_settings *s, bool learned, void (*spoil)(workspace *))
{
    const uint32_t points = s->candidates < 16 ? 20 * PER_FILL : PER_FILL;
    workspace w;

    for (int i = 0; i < 4; i++) m[i] = (stat_moments){0};
    open_workspace(&w, l->light, s, learned);
    for (uint32_t fill = 0; fill < RUNS; fill++) {
        rgbd sum = {0, 0, 0};
        bis_clusters_fill(&w.c, l->light, SEED, fill, 1);
        if (spoil) spoil(&w);
        for (uint32_t k = 0; k < points; k++) {
            const rgb L = lit_once(l, s, &w.scratch, SEED, (uint64_t)fill * points + k);
            sum = rgbd_add(sum, (rgbd){(double)L.r / points, (double)L.g / points, (double)L.b / points});
        }
        stat_add(&m[0], sum.r);
        stat_add(&m[1], sum.g);
        stat_add(&m[2], sum.b);
        stat_add(&m[3], rgbd_sum(sum));
    }
    guided_close(&w);
}

static bis_settings product(uint32_t M, uint32_t N, bool learn)
{
    bis_settings s = lit_settings(&bis_sir, BIS_PROPOSAL_PRODUCT, M, N);
    s.learn = learn;
    return s;
}

/* ---- what is needed, and how candidates are divided ---- */

/* The BRDF's share of M candidates of a mixture: by the squares of the bounds, or half of the lobe's probability over
 * 1 + k, where k candidates would fall into the lobe. Of the product only the latter, as if there were 64 k. */
static void the_brdf_has_its_share_of_the_candidates(void **state)
{
    static const uint32_t Ms[] = {2, 3, 17, 64, 800};
    static const double exponents[] = {1, 20, 500, 3e4, 1e6};
    int by_bounds = 0, by_lobe = 0, some = 0;

    for (int i = 0; i < 2 * 5 * 5 * 3; i++) {
        const uint32_t M = Ms[i / 2 % 5];
        const rgb Kd = grey(i / 50 == 0 ? 0.5 : i / 50 == 1 ? 0.2 : 0), Ks = grey(i / 50 == 0 ? 0 : 0.4);
        bis_light *light = lit_new_light(i % 2 ? LIT_SMOOTH : LIT_SPOTTY, 1, 0.15, false);
        const bis_settings s = product(M, 3, false);
        workspace w;
        lit l;
        open_workspace(&w, light, &s, false);
        lit_init(&l, light, bis_phong(Kd, Ks, exponents[i / 10 % 5]), tilted(), 40, LIT_OPEN);
        const bis_bsdf *b = &l.pt.bsdf;
        const double c_em = bis_bsdf_max_f_cos(b) * bis_light_max_ratio(light),
                     c_brdf = bis_bsdf_max_ratio(b) * bis_light_max_intensity(light);
        const double k = M / (4 * PI * bis_bsdf_pdf(b, b->r));
        const double of_bounds = c_em * c_em / (c_em * c_em + c_brdf * c_brdf), of_lobe = b->p_specular / (2 + 2 * k);
        const double share = fmax(of_bounds, of_lobe), n = fmin(M - 1, floor(share * M + 0.5));
        const bis_mixture mix = bis_candidates_divide(M, BIS_PROPOSAL_MIX, &l.pt, NULL);
        assert_int_equal(mix.n_brdf, fmax(n, b->p_specular > 0 ? 1 : 0));
        assert_true(mix.n_em + mix.n_brdf == M && fabs(mix.beta - (double)mix.n_em / M) < 1e-15);
        const bis_mixture narrow = w.guide.steps.divide(&w.guide.steps, M, &l.pt);
        assert_int_equal(narrow.n_brdf, floor(M * b->p_specular / (2 + 128 * k)));
        assert_true(narrow.n_em + narrow.n_brdf == M && fabs(narrow.beta - (double)narrow.n_em / M) < 1e-15);
        bis_stream stream, same;
        bis_stream_init(&stream, &(bis_sampler){.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1}, (uint64_t)i, 0);
        same = stream;
        const bis_mixture one = bis_candidates_divide(1, BIS_PROPOSAL_MIX, &l.pt, &stream);
        const double k1 = k / M, share1 = fmax(of_bounds, b->p_specular / (2 + 2 * k1));
        assert_true(one.n_brdf == (bis_stream_random(&same) < share1) && one.n_em + one.n_brdf == 1);
        assert_true(fabs(one.beta - (1 - share1)) < 1e-12);
        w.c.n = BIS_CLUSTERS_FEW - 1; /* wide ones find no lobes: as of a mixture, but for one alone */
        const bis_mixture wide = w.guide.steps.divide(&w.guide.steps, M, &l.pt),
                          alone = w.guide.steps.divide(&w.guide.steps, 1, &l.pt);
        assert_true(wide.n_brdf == mix.n_brdf && wide.n_em == mix.n_em && wide.beta == mix.beta);
        assert_true(alone.n_em == 1 && alone.n_brdf == 0 && alone.beta == 1);
        by_bounds += of_bounds > of_lobe && n > 1;
        by_lobe += of_bounds < of_lobe && n > 1;
        some += narrow.n_brdf > 1;
        guided_close(&w);
        bis_light_free(light);
    }
    assert_true(by_bounds > 10 && by_lobe > 10 && some > 10);
}

/* A thread's workspace serves point after point, of other materials, of which other shares of M come from the map:
 * what one point has left there changes no bit of the next. */
static void a_used_workspace_gives_the_bits_of_a_new_one(void **state)
{
    static const uint32_t Ms[] = {7, 40, 64, 250};
    static const double exponents[] = {1, 5000, 10, 300, 50, 100000, 3, 1000};

    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    for (int i = 0; i < 4; i++) {
        const bis_settings s = product(Ms[i], 5, false);
        workspace used, fresh;
        open_workspace(&used, light, &s, false);
        bis_clusters_fill(&used.c, light, SEED, 0, 1);
        for (uint64_t k = 0; k < 64; k++) {
            lit l;
            lit_init(&l, light, bis_phong((rgb){0.3f, 0.2f, 0.1f}, (rgb){0.6f, 0.6f, 0.4f}, exponents[k % 8]),
                tilted(), k % 3 ? 30 : 75, LIT_OPEN);
            open_workspace(&fresh, light, &s, false);
            bis_clusters_fill(&fresh.c, light, SEED, 0, 1);
            const rgb a = lit_once(&l, &s, &used.scratch, SEED, k), b = lit_once(&l, &s, &fresh.scratch, SEED, k);
            assert_memory_equal(&a, &b, sizeof a);
            guided_close(&fresh);
        }
        guided_close(&used);
    }
    bis_light_free(light);
}

/* Where a candidate of the product may lie, counted by cluster: n w_k/W of each cluster, w as the product weighs it. A
 * direction of the BRDF gets the density of the cluster that its pixel is in. */
static void candidates_have_the_density_that_they_say(void **state)
{
    enum { M = 40, SETS = 3000 };
    static const double exponents[] = {1, 50, 3000};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_settings s = product(M, 4, true);

    for (int e = 0; e < 3; e++) {
        workspace w;
        lit l;
        open_workspace(&w, light, &s, true);
        bis_clusters_fill(&w.c, light, SEED, 0, 1);
        lit_init(&l, light, bis_phong(grey(0.3), grey(0.6), exponents[e]), tilted(), 40, LIT_OPEN);
        double *observed = bis_alloc(w.c.n, sizeof *observed), *expected = bis_alloc(w.c.n, sizeof *expected),
               *even = bis_alloc(w.c.n, sizeof *even);
        bis_set *x = w.scratch.set;
        double W = 0;
        for (uint64_t run_number = 0; run_number < SETS; run_number++) {
            const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
            bis_stream stream;
            bis_rng pick;
            bis_stream_init(&stream, &sampler, run_number, 0);
            bis_rng_init(&pick, SEED, run_number, 0, 9);
            assert_true(bis_set_draw(x, M, s.proposal, true, &l.pt, &stream));
            const float *h = w.guide.guess.h, *bound = w.guide.product.clusters.w; /* bound: with h */
            observed[x->part[bis_rng_below(&pick, x->map.n)]]++; /* one of a set: independent */
            W = 0;
            for (uint32_t k = 0; k < w.c.n; k++) W += (double)bound[k];
            for (uint32_t i = 0; i < set_size(x); i++) {
                const uint32_t number = set_number(x, i), k = x->part[number];
                const vec3 wi = set_direction(x, number);
                const double q = bis_light_pdf(light, wi) / bis_cluster_share(&w.c, k) * (double)bound[k] / W;
                uint32_t at;
                assert_true(h[k] > 0);
                if (bis_cluster_of_pixel(&w.c, (uint32_t)bis_envmap_pixel(bis_light_envmap(light), wi)) != k)
                    continue; /* floats next to an edge */
                const double q_L = (double)bis_set_half(x, number, &at)->x.q[at];
                if (fabs(q_L - q) > 0x1p-20 * q) fail_msg("exponent %g: density %g, not %g", exponents[e], q_L, q);
            }
        }
        for (uint32_t k = 0; k < w.c.n; k++) {
            expected[k] = SETS * (double)w.guide.product.clusters.w[k] / W;
            even[k] = SETS * bis_cluster_share(&w.c, k);
        }
        stat_assert_fit("product-clusters", SEED, observed, expected, w.c.n, alpha());
        stat_assert_no_fit("product-clusters-of-the-map", SEED, observed, even, w.c.n, alpha());
        bis_free(observed);
        bis_free(expected);
        bis_free(even);
        guided_close(&w);
    }
    bis_light_free(light);
}

static void product_is_unbiased_with_and_without_learned_visibility(void **state)
{
    static const uint32_t Ms[] = {1, 3, 17, 256};
    const bis_material materials[] = {bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1),
        bis_phong((rgb){0, 0, 0}, (rgb){1, 0.8f, 0.6f}, 10),
        bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.5f, 0.5f, 0.5f}, 50),
        bis_phong((rgb){0, 0, 0}, (rgb){1, 0.8f, 0.6f}, 1000)}; /* which gets candidates from the BRDF, too */
    for (int i = 0; i < 4 * 4 * 2; i++) {
        bis_light *light = lit_new_light(maps[(i / 4 + i / 16) % 2], 1, 0.15, false);
        const bool learned = i / 16;
        const uint32_t M = Ms[i % 4], least = i / 4 % 4 == 3 ? 8 : 1; /* one candidate of a narrow lobe tells nothing */
        const bis_settings s = product(M < least ? least : M, i % 5 ? 3 : 15, learned);
        stat_moments m[4];
        lit l;
        lit_init(&l, light, materials[i / 4 % 4], tilted(), 40, i % 2 ? LIT_HALF : LIT_OPEN);
        const rgbd truth = lit_truth(&l, true);
        const double expected[4] = {truth.r, truth.g, truth.b, rgbd_sum(truth)};
        run(m, &l, &s, learned, NULL);
        for (int c = 0; c < 4; c++) stat_assert_mean("product", SEED, &m[c], expected[c], alpha());
        bis_light_free(light);
    }
}

/* There is no least M: one candidate, a block less one, a block, a block and one. */
static void product_is_unbiased_for_every_M_from_1_to_17(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);

    for (uint32_t M = 1; M <= 17; M++) {
        const bis_settings s = product(M, 1 + M % 3, true);
        stat_moments m[4];
        lit l;
        lit_init(&l, light, bis_phong(grey(0.3), grey(0.6), M % 2 && M > 1 ? 1000 : 20), tilted(), 40, LIT_HALF);
        run(m, &l, &s, true, NULL);
        stat_assert_mean("product-M", SEED, &m[3], rgbd_sum(lit_truth(&l, true)), alpha());
    }
    bis_light_free(light);
}

/* Twin: every second cluster draws from the first, with its own density. */
static void draw_elsewhere(workspace *w)
{
    enum { D = BIS_CLUSTER_DIRECTIONS };

    for (uint32_t k = 1; k < w->c.n; k += 2) {
        for (int i = 0; i < D; i++) w->c.y[(size_t)k * D + (size_t)i] = w->c.y[i];
    }
}

/* Twin: a bound of 0 over every second cluster, where the product is not 0. */
static void overlook_clusters(workspace *w)
{
    for (uint32_t k = 0; k < w->c.n; k += 2) w->c.cone.r[k] = w->c.cone.g[k] = w->c.cone.b[k] = 0;
}

/* Twins: a guide that says 5 % more than its density; one that says another h than it weighs with. */
static bool (*honest_draw)(bis_guide *, bis_set *, uint32_t, const bis_point *, bis_stream *);
static void (*honest_chosen)(bis_guide *, bis_set *);

static bool lie_of_density(bis_guide *g, bis_set *x, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    const bool drawn = honest_draw(g, x, n, pt, stream);

    for (uint32_t i = 0; i < x->map.n; i++) x->map.x.q[i] *= 1.05f;
    return drawn;
}

static void lie_of_h(bis_guide *g, bis_set *x)
{
    honest_chosen(g, x);
    for (uint32_t j = 0; j < x->choice.n_chosen; j++) x->y.h[j] = 0.15f;
}

static void spoil_density(workspace *w)
{
    if (w->guide.steps.draw != lie_of_density) honest_draw = w->guide.steps.draw;
    w->guide.steps.draw = lie_of_density;
}

static void spoil_h(workspace *w)
{
    if (w->guide.steps.chosen != lie_of_h) honest_chosen = w->guide.steps.chosen;
    w->guide.steps.chosen = lie_of_h;
}

static void twins_with_a_wrong_density_or_a_bound_of_0_are_found(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    stat_moments m[4];
    lit l;

    lit_init(&l, light, bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1), (vec3){0, 0, 1}, 40, LIT_OPEN);
    const double truth = rgbd_sum(lit_truth(&l, true));
    const bis_settings s = product(64, 3, false);
    run(m, &l, &s, false, draw_elsewhere);
    stat_assert_not_mean("product-elsewhere", SEED, &m[3], truth, alpha());
    run(m, &l, &s, false, overlook_clusters);
    stat_assert_not_mean("product-bound", SEED, &m[3], truth, alpha());
    run(m, &l, &s, false, spoil_density);
    stat_assert_not_mean("product-density", SEED, &m[3], truth, alpha());
    const bis_settings learned = product(64, 3, true);
    run(m, &l, &learned, true, spoil_h);
    stat_assert_not_mean("product-h", SEED, &m[3], truth, alpha());
    bis_light_free(light);
}

/* ---- lamps ---- */

/* The guide's own draw, but for it every cluster is as small as a lamp once it has been weighed. */
static workspace *of_lamps;

static bool draw_lamps(bis_guide *g, bis_set *x, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    bis_product *p = &of_lamps->guide.product;
    bis_clusters small = of_lamps->c;
    float *cosine = bis_alloc(small.n, sizeof *cosine);
    double marks[1][2], phase[1][2];

    for (uint32_t k = 0; k < small.n; k++) cosine[k] = 1;
    small.cone.cosine = cosine;
    const bool drawn = bis_product_weigh(p, &of_lamps->c, &pt->bsdf);
    if (drawn && of_lamps->guide.visibility) assert_true(bis_product_guess(p, &of_lamps->c, &of_lamps->guide.guess));
    bis_stream_points(stream, BIS_DIM_MARKS, 1, marks);
    bis_stream_points(stream, BIS_DIM_PHASE, 1, phase);
    if (drawn) {
        n = bis_product_draw(p, &small, &x->own, x->part, x->stands_for, n, marks[0][0], phase[0][0], stream->pixel);
        x->map = (bis_half){x->own, n, 0};
        x->mark = marks[0][1];
    }
    bis_free(cosine);
    return drawn;
}

static void make_lamps(workspace *w)
{
    of_lamps = w;
    w->guide.steps.draw = draw_lamps;
}

/* Twin: a candidate of a lamp stands for itself alone. */
static void (*honest_weigh)(bis_guide *, bis_set *);

static void weigh_each_once(bis_guide *g, bis_set *x)
{
    for (uint32_t i = 0; i < x->map.n; i++) x->stands_for[i] = 1;
    honest_weigh(g, x);
}

static void make_lamps_of_one(workspace *w)
{
    make_lamps(w);
    if (w->guide.steps.weigh != weigh_each_once) honest_weigh = w->guide.steps.weigh;
    w->guide.steps.weigh = weigh_each_once;
}

static void few_candidates_of_a_lamp_leave_the_mean_where_it_is(void **state)
{
    static const double exponents[] = {1, 50, 1000};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_settings s = product(256, 3, true);

    for (int e = 0; e < 3; e++) {
        stat_moments m[4];
        lit l;
        lit_init(&l, light, bis_phong(grey(e < 2 ? 0.3 : 0), grey(0.6), exponents[e]), tilted(), 40, LIT_HALF);
        const double truth = rgbd_sum(lit_truth(&l, true));
        run(m, &l, &s, true, make_lamps);
        stat_assert_mean("product-lamps", SEED, &m[3], truth, alpha());
        run(m, &l, &s, true, make_lamps_of_one);
        stat_assert_not_mean("product-lamps-once", SEED, &m[3], truth, alpha());
    }
    bis_light_free(light);
}

/* ---- what is learned ---- */

/* Counts `rays` of cell 2, tile 1, towards the part of cluster k of n, of which `seen` came through. */
static void count(bis_visibility_guess *f, bis_visibility *v, uint32_t k, uint32_t n, int rays, int seen)
{
    bis_guess_look(f, n, v, v->cells + 2);
    for (int i = 0; i < rays; i++) {
        uint16_t *counted = bis_guess_count(f, k, n);
        assert_non_null(counted);
        if (i < seen) ++*counted;
    }
}

/* What a tile expects of a part of 128, from the top of the map down: each half of a piece is drawn towards the whole
 * by three rays a part. In double, by intervals. */
static double expected_mean(const int rays[128], const int seen[128], int part)
{
    double m = 0;

    for (int size = 128, lo = 0; size > 0; size /= 2) {
        double R = 0, S = 0;
        lo = part / size * size;
        for (int i = lo; i < lo + size; i++) R += rays[i], S += seen[i];
        m = size == 128 ? (S + 1) / (R + 2) : (S + 3 * size * m) / (R + 3 * size);
    }
    return m;
}

/* All h and g of a cell that has counted own and own_seen of the rays of its tile. */
static void assert_foresees(const bis_visibility_guess *f, uint32_t n, const int rays[128], const int seen[128],
                            const int own[128], const int own_seen[128])
{
    double g[128], h[128], left[128];

    for (int i = 0; i < 128; i++) {
        const double mean = expected_mean(rays, seen, i), v = (own_seen[i] + 2 * mean) / (own[i] + 2);
        g[i] = (own_seen[i] + 2 * (rays[i] > 0 ? (double)seen[i] / rays[i] : mean)) / (own[i] + 2);
        h[i] = sqrt(v * (1 - 0.8 * v));
        left[i] = v - 2 * v * g[i] + g[i] * g[i]; /* E[(V - g)^2], V^2 = V */
    }
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t part = bis_visibility_part(k, n);
        assert_true(fabs((double)f->own[k] - h[part]) <= 1e-6);
        assert_true(fabs((double)f->g[k] - g[part]) <= 1e-6 && fabs((double)f->left[k] - left[part]) <= 1e-6);
    }
}

/* k = 0, 1, 2 of 300 are of part 0, k = 3, 4 of part 1, k = 5, 6, 7 of part 2. */
static void guess_follows_what_was_seen_before(void **state)
{
    enum { N = 300 };
    static const int none[128], rays[128] = {998, 998, 6}, seen[128] = {0, 998, 3}, wrong[128] = {0, 998, 4};
    bis_visibility v;
    bis_visibility_guess f;

    assert_int_equal(bis_visibility_init(&v, 2, 0, 1 << 23, NULL), BIS_OK);
    assert_int_equal(bis_guess_init(&f, N, NULL), BIS_OK);
    assert_int_equal(v.cells, 16);
    count(&f, &v, 0, N, 998, 0);
    count(&f, &v, 3, N, 998, 998);
    count(&f, &v, 7, N, 6, 3);
    uint32_t all, through;
    bis_visibility_counted(&all, &through, &v, 1);
    assert_true(all == 2002 && through == 1001);
    bis_visibility_counted(&all, &through, &v, 0);
    assert_true(all == 0 && through == 0);
    for (size_t cell = 16; cell <= 16 + 2; cell++) { /* of this pass a cell knows only what came before it */
        bis_guess_look(&f, N, &v, cell);
        assert_foresees(&f, N, none, none, none, none);
        assert_false(f.knows);
    }
    for (size_t cell = 16 + 3; cell < 32; cell++) { /* the cells that follow in the tile know them */
        bis_guess_look(&f, N, &v, cell);
        assert_true(f.knows);
        assert_foresees(&f, N, rays, seen, none, none);
    }
    for (size_t cell = 0; cell < 16; cell++) {
        bis_guess_look(&f, N, &v, cell);
        assert_false(f.knows);
    }
    bis_visibility_learn(&v, NULL, v.n_tiles, 1);
    bis_guess_look(&f, N, &v, 16 + 2);
    assert_true(f.knows);
    assert_foresees(&f, N, rays, seen, rays, seen);
    /* twin: one ray more of 2002 would be found */
    assert_true(fabs((3 + 2 * expected_mean(rays, seen, 2)) - (4 + 2 * expected_mean(rays, wrong, 2))) / 8 > 1e-2);
    /* dark parts are known as such, and light ones */
    assert_true(f.own[0] < 0.05f && f.own[0] > 0 && f.g[0] == 0 && f.g[4] > 0.999f);
    /* another cell of the tile knows what the tile knows; another tile knows nothing */
    bis_guess_look(&f, N, &v, 16 + 3);
    assert_foresees(&f, N, rays, seen, none, none);
    bis_guess_look(&f, N, &v, 2);
    assert_foresees(&f, N, none, none, none, none);
    bis_guess_clear(&f);
    bis_visibility_clear(&v);
}

/* A square tells the tile in it of each part, half as much as the parts around it in the tile. */
static void a_tile_expects_what_its_square_has_seen(void **state)
{
    enum { N = 128 };
    static const int rays[128] = {[5] = 40, [6] = 40, [90] = 100}, seen[128] = {[5] = 30};
    bis_visibility v;
    bis_visibility_guess f;

    assert_int_equal(bis_visibility_init(&v, 1, 2, 1, NULL), BIS_OK);
    assert_int_equal(bis_guess_init(&f, N, NULL), BIS_OK);
    v.above[0] = 0; /* the tile in square 0, that in square 1 */
    v.above[1] = 1;
    bis_visibility_close(&v, 1, N);
    for (int i = 0; i < N; i++) assert_true(v.squares[1].mean[i] == 0.5f); /* Laplace: nothing is known */
    bis_guess_look(&f, N, &v, bis_visibility_first_cell(&v, 1));
    assert_true(f.has_square && f.knows);
    for (uint32_t i = 0; i < N; i++) {
        f.counted->rays[i] = (uint16_t)rays[i];
        f.counted->seen[i] = (uint16_t)seen[i];
    }
    const int square = 1;
    uint32_t all, through;
    bis_visibility_counted(&all, &through, &v, square);
    assert_true(all == 180 && through == 30);
    bis_visibility_learn(&v, &square, 1, 1);
    bis_visibility_close(&v, 0, N);
    for (int i = 0; i < N; i++) {
        /* of its own rays as a tile, but the last step goes towards the mean of that and of 1/2 */
        double R = rays[i] + rays[i ^ 1], S = seen[i] + seen[i ^ 1], m = 31 / 182.0;
        for (int size = 64; size > 1; size /= 2) {
            const int lo = i / size * size;
            R = S = 0;
            for (int k = lo; k < lo + size; k++) R += rays[k], S += seen[k];
            m = (S + 3 * size * m) / (R + 3 * size);
        }
        const double mean = (seen[i] + 3 * (m + 0.5) / 2) / (rays[i] + 3), alone = (seen[i] + 3 * m) / (rays[i] + 3);
        assert_true(fabs((double)v.squares[0].mean[i] - mean) < 1e-6);
        assert_true(fabs(mean - alone) > 0.005); /* twin: the square around is not asked */
        assert_true(fabs((double)v.squares[0].h[i] - sqrt(mean * (1 - 0.8 * mean))) < 1e-6);
    }
    bis_guess_look(&f, N, &v, 0); /* the tile has no rays: half of what it expects comes from the square */
    for (uint32_t i = 0; i < N; i++) {
        const double v_of_tile = (0.5 + (double)v.squares[0].mean[i]) / 2;
        assert_true(fabs((double)f.own[i] - sqrt(v_of_tile * (1 - 0.8 * v_of_tile))) < 1e-6);
        assert_true(f.of_square[i] == v.squares[0].h[i]);
    }
    /* the square itself is one place, which has no cells: its rays are those of the whole place, and count once; those
     * of the next square do not */
    v.known[bis_visibility_first_cell(&v, 2)].rays[0] = 7;
    bis_guess_look(&f, N, &v, bis_visibility_first_cell(&v, 1));
    for (int i = 0; i < N; i++) {
        const double mean = (double)v.squares[0].mean[i];
        assert_true(fabs((double)f.g[i] - (rays[i] > 0 ? (double)seen[i] / rays[i] : mean)) < 1e-6);
        assert_true(fabs((double)f.own[i] - sqrt(mean * (1 - 0.8 * mean))) < 1e-6);
        assert_true(f.of_square[i] == v.squares[1].h[i]);
    }
    bis_guess_clear(&f);
    bis_visibility_clear(&v);
}

/* Candidates are drawn in proportion to b h. Of them, 8/15 go where the cell alone would send them, 4/15 where the
 * square would, 3/15 where they would go without knowledge; without a square 12/15 and 3/15. */
static void each_knowledge_has_its_share_of_the_candidates(void **state)
{
    enum { N = 150 };
    bis_visibility_guess f;

    assert_int_equal(bis_guess_init(&f, N, NULL), BIS_OK);
    for (int with = 0; with < 2; with++) {
        float b[160] = {0}, bound[160];
        double sum[4] = {0}, unlike = 0; /* of b times what the cell, the square, nothing and the point say */
        for (uint32_t k = 0; k < N; k++) {
            b[k] = bound[k] = k % 11 ? 0x1p-10f * (0.3f + (float)(k % 17)) : 0;
            f.own[k] = k < 140 ? 1e-3f : 0.6f; /* the cell knows another window than the square */
            f.of_square[k] = k < 10 ? 0.5f : 1e-4f;
            f.g[k] = 0.01f * (float)(k % 90);
            f.left[k] = 0.01f * (float)(k % 20);
            sum[0] += (double)(b[k] * f.own[k]);
            sum[1] += (double)(b[k] * f.of_square[k]);
            sum[2] += (double)b[k];
        }
        f.has_square = with;
        bis_guess_mix(&f, b, sum[2], N);
        for (uint32_t k = 0; k < N; k++) sum[3] += (double)b[k];
        assert_true(fabs(sum[3] / sum[0] - 1.25) < 1e-5);
        for (uint32_t k = 0; k < N; k++) {
            const double density[3] = {(double)(bound[k] * f.own[k]) / sum[0],
                                       (double)(bound[k] * f.of_square[k]) / sum[1], (double)bound[k] / sum[2]};
            const double mixed = with ? (8 * density[0] + 4 * density[1] + 3 * density[2]) / 15
                                      : (12 * density[0] + 3 * density[2]) / 15;
            assert_true(fabs((double)b[k] / sum[3] - mixed) <= 1e-5 * mixed);
            assert_true(b[k] == bound[k] * f.h[k] && fabsf(f.control[k] * f.h[k] - f.g[k]) < 1e-6f &&
                        fabsf(f.noise[k] * f.h[k] * f.h[k] - f.left[k]) < 1e-6f);
            /* the price of a wrong 0 */
            assert_true((double)b[k] / sum[3] >= 0.999 * fmax(with ? 4 / 15.0 * density[1] : 0, density[2] / 5));
            /* twin: h alone is mixed, whatever light there is where each h is large */
            const double h = with ? 8 * (double)f.own[k] + 4 * (double)f.of_square[k] + 3 : 0;
            const double density_of_twin = (double)bound[k] * h / (8 * sum[0] + 4 * sum[1] + 3 * sum[2]);
            unlike = fmax(unlike, fabs(density_of_twin / fmax(mixed, 1e-9) - 1));
        }
        assert_true(!with || unlike > 0.3);
    }
    /* a square that sees nothing where the point does: as if there were none, with its share left out */
    float b[16] = {1, 2, 3};
    memset(f.of_square, 0, 16 * sizeof *f.of_square);
    for (int k = 0; k < 3; k++) f.own[k] = 0.25f;
    f.has_square = true;
    bis_guess_mix(&f, b, 6, 3);
    for (int k = 0; k < 3; k++) assert_true(fabs((double)f.h[k] - 0.25 * 1.25 * 11 / 15) < 1e-6);
    bis_guess_clear(&f);
}

/* Counts have 16 bits. Those of a pass end there; those of all passes are halved. */
static void counts_keep_their_mean_beyond_16_bits(void **state)
{
    bis_visibility v;
    bis_visibility_guess f;

    assert_int_equal(bis_visibility_init(&v, 1, 0, (1 << 23) + 1, NULL), BIS_OK);
    assert_int_equal(bis_guess_init(&f, 128, NULL), BIS_OK);
    assert_int_equal(v.cells, 1);
    for (int pass = 0; pass < 3; pass++) {
        bis_guess_look(&f, 128, &v, 0);
        for (int i = 0; i < 65535; i++) {
            uint16_t *seen = bis_guess_count(&f, 9, 128);
            assert_non_null(seen);
            *seen = (uint16_t)(*seen + (i % 4 == 0));
        }
        assert_null(bis_guess_count(&f, 9, 128));
        assert_non_null(bis_guess_count(&f, 10, 128));
        bis_visibility_learn(&v, NULL, v.n_tiles, 1);
    }
    bis_guess_look(&f, 128, &v, 0);
    assert_true(fabs((double)f.g[9] - 0.25) <= 1e-4);
    for (uint32_t part = 0; part < 128; part++) { /* one ray of any part is something to learn */
        const uint16_t before = v.known[0].rays[part];
        bis_guess_count(&f, part, 128);
        bis_visibility_learn(&v, NULL, 1, 1);
        assert_true(v.counted[0].rays[part] == 0 && (v.known[0].rays[part] == before + 1 || part == 9));
    }
    bis_guess_clear(&f);
    bis_visibility_clear(&v);
}

/* 65535 rays are the most that fit: they stay, and one more is halved, as is what came through. One ray is known. */
static void a_count_is_halved_where_it_would_not_fit(void **state)
{
    static const uint16_t rows[][3][2] = { /* rays and those that came through: known, counted, and what they make */
        {{65530, 40001}, {5, 2}, {65535, 40003}}, {{65530, 40001}, {6, 2}, {32768, 20001}},
        {{65535, 65535}, {65535, 65535}, {65535, 65535}}, {{0, 0}, {1, 0}, {1, 0}}};
    bis_visibility v;
    bis_visibility_guess f;

    assert_int_equal(bis_visibility_init(&v, 1, 0, (1 << 23) + 1, NULL), BIS_OK);
    assert_int_equal(bis_guess_init(&f, 128, NULL), BIS_OK);
    bis_guess_look(&f, 128, &v, 0);
    assert_false(f.knows);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        v.known[0].rays[31] = rows[i][0][0], v.known[0].seen[31] = rows[i][0][1];
        v.counted[0].rays[31] = rows[i][1][0], v.counted[0].seen[31] = rows[i][1][1];
        bis_visibility_learn(&v, NULL, 1, 1);
        assert_int_equal(v.known[0].rays[31], rows[i][2][0]);
        assert_int_equal(v.known[0].seen[31], rows[i][2][1]);
        bis_guess_look(&f, 128, &v, 0);
        assert_true(f.knows && !f.has_square);
    }
    bis_guess_clear(&f);
    bis_visibility_clear(&v);
}

/* Where all rays are known to come through, an estimate is the mean of all candidates, whatever N is: the control
 * leaves nothing for the rays. Without the control it depends on which N were chosen. */
static void control_of_1_leaves_no_noise_to_the_choice(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_settings s[2] = {product(64, 1, true), product(64, 7, true)};
    rgb L[2][2];
    lit l;

    lit_init(&l, light, bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.5f, 0.5f, 0.5f}, 20), tilted(), 40, LIT_OPEN);
    for (int known = 0; known < 2; known++) {
        for (int i = 0; i < 2; i++) {
            workspace w;
            open_workspace(&w, light, &s[i], true);
            bis_clusters_fill(&w.c, light, SEED, 0, 1);
            for (uint32_t k = 0; k < w.c.n; k++) {
                w.guide.guess.own[k] = 0.1f + 0.3f * (float)(k % 2);
                w.guide.guess.g[k] = 1;
            }
            w.guide.guess.knows = known;
            L[known][i] = lit_once(&l, &s[i], &w.scratch, SEED, 3);
            guided_close(&w);
        }
    }
    assert_true(fabsf(L[0][0].r / L[0][1].r - 1) > 1e-3f);
    assert_true(fabsf(L[1][0].r / L[1][1].r - 1) < 1e-5f && fabsf(L[1][0].b / L[1][1].b - 1) < 1e-5f);
    bis_light_free(light);
}

/* N in proportion to what they leave, 3.5 sqrt(left)/(h control), h = 5/4: within N/4 and 3 N. Without a control, as
 * where nothing is diffuse, W/A, which is 1/control: within N and 3 N. Where nothing is known they are N. (A sum
 * rounds: where it is whole, ceil may give one more.) */
static void more_rays_are_cast_where_less_is_known(void **state)
{
    static const struct { float control, left; uint32_t rays, of_mirror; } cases[] = {
        {4, 0.25f, 3, 8}, {1, 0, 2, 8}, {1, 0.015625f, 3, 8}, {0.75f, 0.25f, 15, 11}, {0.5f, 0.25f, 23, 16},
        {0.375f, 0.0625f, 15, 22}, {0.25f, 0.25f, 24, 24}, {0.0625f, 0, 2, 24}, {0, 0.01f, 24, 24}};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_settings s = product(64, 8, true);
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
    workspace w;

    open_workspace(&w, light, &s, true);
    bis_clusters_fill(&w.c, light, SEED, 0, 1);
    for (size_t i = 0; i < 2 * sizeof cases / sizeof *cases; i++) {
        const bool diffuse = i % 2;
        const uint32_t rays = diffuse ? cases[i / 2].rays : cases[i / 2].of_mirror;
        bis_set *x = w.scratch.set;
        bis_stream stream;
        lit l;
        lit_init(&l, light, bis_phong(grey(diffuse ? 0.5 : 0), grey(0.5), 20), tilted(), 40, LIT_OPEN);
        for (uint32_t k = 0; k < w.c.n; k++) {
            w.guide.guess.own[k] = w.guide.guess.of_square[k] = 1;
            w.guide.guess.g[k] = 1.25f * cases[i / 2].control;
            w.guide.guess.left[k] = cases[i / 2].left;
        }
        bis_stream_init(&stream, &sampler, i, 0);
        assert_true(bis_set_draw(x, s.candidates, s.proposal, true, &l.pt, &stream));
        assert_true(bis_set_weigh(x, &l.pt) > 0);
        w.guide.guess.knows = true;
        assert_in_range(bis_set_rays(x, &l.pt, s.shadowrays), rays, rays + (rays % 8 == 0 ? 1 : 0));
        w.guide.guess.knows = false;
        assert_int_equal(bis_set_rays(x, &l.pt, s.shadowrays), s.shadowrays);
        bis_set_choose(x, BIS_MORE_RAYS * s.shadowrays, s.resampling, &stream);
        assert_true(x->choice.n_chosen <= x->y.room);
    }
    guided_close(&w);
    bis_light_free(light);
}

/* The estimate of one set of candidates, where a mark is at `offset` and n are chosen. */
static double estimate_at(bis_set *x, const bis_point *pt, double Zhat, uint32_t n, double offset)
{
    bis_stream stream = {0}; /* systematic marks draw nothing */
    rgbd L = {0, 0, 0};

    x->mark = offset;
    bis_set_choose(x, n, BIS_RESAMPLING_SYSTEMATIC, &stream);
    if (bis_set_has_control(x, pt)) L = bis_set_expected(x, Zhat / n);
    return bis_set_trace(L, x, pt, Zhat / n).g;
}

/* All offsets of the marks, enumerated, have the mean sum F V/(M q) of the candidates, however wrong what is known of V
 * is, because the number of rays asks the candidates and not the marks. Twin: it asks whether light arrived. */
static void any_number_of_rays_has_the_mean_of_the_candidates(void **state)
{
    enum { OFFSETS = 1 << 14, SETS = 12 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_settings s = product(64, 8, true);
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
    workspace w;
    lit l;
    uint32_t fewest = UINT32_MAX, most = 0;
    double twins = 0;

    lit_init(&l, light, bis_phong(grey(0.5), grey(0.5), 20), tilted(), 40, LIT_HALF);
    open_workspace(&w, light, &s, true);
    bis_clusters_fill(&w.c, light, SEED, 0, 1);
    for (uint64_t i = 0; i < SETS; i++) {
        bis_set *x = w.scratch.set;
        bis_stream stream;
        double truth = 0, mean = 0, of_twin = 0;
        for (uint32_t k = 0; k < w.c.n; k++) {
            w.guide.guess.own[k] = 0.1f + 0.02f * (float)(k % 28);
            w.guide.guess.g[k] = (float)((k + i) % 3) / 2;
            w.guide.guess.left[k] = (float)(i % 4) / 8;
        }
        w.guide.guess.knows = true;
        bis_stream_init(&stream, &sampler, i, 0);
        assert_true(bis_set_draw(x, s.candidates, s.proposal, true, &l.pt, &stream));
        const double Zhat = bis_set_weigh(x, &l.pt);
        const uint32_t n = bis_set_rays(x, &l.pt, s.shadowrays);
        fewest = n < fewest ? n : fewest;
        most = n > most ? n : most;
        for (uint32_t j = 0; j < x->map.n; j++) {
            const double w_j = (double)(x->choice.w[j] / w.guide.guess.h[x->part[j]]), F = (double)x->F[1][j];
            const vec3 wi = {x->map.x.x[j], x->map.x.y[j], x->map.x.z[j]};
            if (w_j > 0 && bis_point_sees(&l.pt, wi))
                truth += w_j * F / ((double)x->F[0][j] + F + (double)x->F[2][j]) * Zhat / x->W;
        }
        for (uint32_t j = 0; j < OFFSETS; j++) {
            const double offset = (j + 0.5) / OFFSETS, L = estimate_at(x, &l.pt, Zhat, n, offset);
            mean += L / OFFSETS;
            const double other = L < truth ? estimate_at(x, &l.pt, Zhat, 3 * s.shadowrays - n / 2, offset) : L;
            of_twin += other / OFFSETS;
        }
        assert_true(fabs(mean / truth - 1) < 1e-3);
        twins += fabs(of_twin / truth - 1) / SETS;
    }
    assert_true(fewest < s.shadowrays && most > 2 * s.shadowrays && twins > 1e-2);
    guided_close(&w);
    bis_light_free(light);
}

/* Rays are counted for the part of the map that their candidate comes from, and what light arrives, too; but not while
 * learns is false, as where V = 1 is asked for (the layers of src/render/gather.c). */
static void rays_are_counted_and_V_1_of_a_layer_is_not_learned_from(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    const bis_settings s = product(64, 7, true);
    workspace w;
    lit l;

    lit_init(&l, light, bis_phong(grey(0.5), grey(0.5), 20), tilted(), 40, LIT_HALF);
    open_workspace(&w, light, &s, true);
    bis_clusters_fill(&w.c, light, SEED, 0, 1);
    for (int learns = 0; learns < 2; learns++) {
        uint32_t rays = 0, seen = 0;
        w.guide.steps.learns = learns;
        l.counters = (bis_counters){0};
        for (uint64_t k = 0; k < 100; k++) lit_once(&l, &s, &w.scratch, SEED, k);
        assert_true(l.counters.shadow_rays > 300);
        for (int part = 0; part < BIS_VISIBILITY_PARTS; part++)
            rays += w.v.counted->rays[part], seen += w.v.counted->seen[part];
        assert_int_equal(rays, learns ? l.counters.shadow_rays : 0);
        assert_true(learns ? seen > rays / 10 && seen < rays : seen == 0);
    }
    guided_close(&w);
    bis_light_free(light);
}

/* Where no cluster can reflect light, the estimate is black, and nothing is drawn. */
static void without_a_cluster_in_reach_the_estimate_is_black(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_settings s = product(64, 4, false);
    workspace w;
    lit l;

    lit_init(&l, light, bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.5f, 0.5f, 0.5f}, 20), tilted(), 40, LIT_OPEN);
    open_workspace(&w, light, &s, false);
    bis_clusters_fill(&w.c, light, SEED, 0, 1);
    assert_true(rgb_sum(lit_once(&l, &s, &w.scratch, SEED, 3)) > 0);
    for (uint32_t k = 0; k < w.c.n; k++) w.c.cone.r[k] = w.c.cone.g[k] = w.c.cone.b[k] = 0;
    assert_true(rgb_is_black(lit_once(&l, &s, &w.scratch, SEED, 3)));
    guided_close(&w);
    bis_light_free(light);
}

/* Candidates of one cluster are m D/times behind the first of them, rounded either way, for m = 0, 1, ...: so none
 * occurs twice where there are at most D. */
static void candidates_of_a_cluster_are_spread_evenly_over_its_directions(void **state)
{
    enum { D = BIS_CLUSTER_DIRECTIONS, M = 800 };
    static const uint32_t counts[] = {8, 100, M};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    bis_clusters c;
    bis_product p;
    lit l;
    uint32_t most = 0;
    lit_init(&l, light, bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.3f, 0.3f, 0.3f}, 5), tilted(), 30, LIT_OPEN);
    assert_int_equal(bis_clusters_init(&c, light, 64, NULL), BIS_OK);
    bis_clusters_fill(&c, light, SEED, 0, 1);
    new_product(&p);
    float *memory = bis_alloc(BIS_LANES_ARRAYS * M, sizeof *memory);
    const bis_lanes x = bis_lanes_in(memory, M);
    uint16_t part[M];
    assert_true(bis_product_weigh(&p, &c, &l.pt.bsdf));
    for (uint64_t run = 0; run < 30; run++) {
        const uint32_t n = counts[run % 3];
        bis_product_draw(&p, &c, &x, part, NULL, n, (double)run / 30, (double)(7 * run % 30) / 30, run);
        for (uint32_t i = 0, times; i < n; i += times) {
            const uint32_t k = part[i];
            uint32_t at[M];
            for (times = 0; i + times < n && part[i + times] == k; times++) {
                uint32_t d = 0;
                for (; d < D; d++) {
                    const vec3 w = c.y[k * D + d].wi;
                    if (w.x == x.x[i + times] && w.y == x.y[i + times] && w.z == x.z[i + times]) break;
                }
                assert_true(d < D);
                at[times] = d;
            }
            for (uint32_t m = 0; m < times; m++) {
                const double away = (at[m] + D - at[0]) % D, exact = fmod((double)m * D / times, D);
                assert_true(fabs(away - exact) < 1 || fabs(away - exact) > D - 1);
            }
            most = times > most ? times : most;
        }
    }
    assert_true(most > 8);
    bis_free(memory);
    bis_product_clear(&p);
    bis_clusters_clear(&c);
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clusters_share_the_curve_and_none_is_empty),
        cmocka_unit_test(directions_fill_their_pixels_and_are_drawn_anew_in_each_pass),
        cmocka_unit_test(the_directions_of_a_wide_lamp_are_spread_over_it),
        cmocka_unit_test(no_cluster_is_larger_than_its_share_of_the_sphere),
        cmocka_unit_test(a_cluster_s_directions_lie_in_it_and_in_its_cone),
        cmocka_unit_test(a_cone_is_the_narrowest_about_the_mean_direction),
        cmocka_unit_test(reach_bounds_the_product_over_every_cluster),
        cmocka_unit_test(the_brdf_has_its_share_of_the_candidates),
        cmocka_unit_test(a_used_workspace_gives_the_bits_of_a_new_one),
        cmocka_unit_test(candidates_have_the_density_that_they_say),
        cmocka_unit_test(product_is_unbiased_with_and_without_learned_visibility),
        cmocka_unit_test(product_is_unbiased_for_every_M_from_1_to_17),
        cmocka_unit_test(twins_with_a_wrong_density_or_a_bound_of_0_are_found),
        cmocka_unit_test(few_candidates_of_a_lamp_leave_the_mean_where_it_is),
        cmocka_unit_test(more_rays_are_cast_where_less_is_known),
        cmocka_unit_test(any_number_of_rays_has_the_mean_of_the_candidates),
        cmocka_unit_test(guess_follows_what_was_seen_before),
        cmocka_unit_test(counts_keep_their_mean_beyond_16_bits),
        cmocka_unit_test(a_count_is_halved_where_it_would_not_fit),
        cmocka_unit_test(a_tile_expects_what_its_square_has_seen),
        cmocka_unit_test(each_knowledge_has_its_share_of_the_candidates),
        cmocka_unit_test(control_of_1_leaves_no_noise_to_the_choice),
        cmocka_unit_test(rays_are_counted_and_V_1_of_a_layer_is_not_learned_from),
        cmocka_unit_test(without_a_cluster_in_reach_the_estimate_is_black),
        cmocka_unit_test(candidates_of_a_cluster_are_spread_evenly_over_its_directions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
