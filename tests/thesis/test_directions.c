/* SPDX-License-Identifier: BSD-2-Clause */
/* Directions as integrators draw them, each proposal against its density: from the map (table, curve, pool; lat-long
 * and angular input), from the BRDF, from both; those that rejection accepts against the product; and over many seeds
 * the p-values of right samplers are uniform.
 * Densities come by other roads: the models' by textbook (tests/support/lit.h), the probe's by its own pixels.
 * Family-wise significance 1e-3. */
#include "bis/beyond/mapping.h"
#include "bis/beyond/pool.h"
#include "bis/thesis/alias.h"
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/importance.h"
#include "bis/base/image.h"

#include "claim.h"
#include "lit.h"
#include "map_help.h"
#include "set_help.h"

#include <string.h>

#define SEED 83u

/* 24 of candidates, 32 of narrow lobes, 6 accepted, 6 + 1 from probes, 3 of p-values. */
static double alpha(void) { return stat_level(1e-3, 72); }

/* ---- candidates, by block of the map ---- */

/* Blocks of 8 x 4 pixels, and a last cell for what the harness cannot see: candidates below the horizon. */
enum { ACROSS = 16, DOWN = 16, BLOCKS = ACROSS * DOWN, BELOW = BLOCKS, CELLS = BLOCKS + 1 };

static size_t block_of(vec3 w)
{
    double theta = atan2(hypot((double)w.x, (double)w.y), (double)w.z), phi = atan2((double)w.y, (double)w.x);
    double turns = phi < 0 ? phi / (2 * PI) + 1 : phi / (2 * PI);

    return (size_t)fmin(theta / PI * DOWN, DOWN - 1) * ACROSS + (size_t)(turns * ACROSS) % ACROSS;
}

static rgbd model_of(const lit *l, vec3 wi, double *pdf)
{
    return lit_f(l, (double[]){(double)wi.x, (double)wi.y, (double)wi.z}, pdf);
}

static double density_brdf(const lit *l, vec3 wi)
{
    double pdf;

    model_of(l, wi, &pdf);
    return pdf;
}

typedef double density_fn(const lit *l, vec3 wi, double beta);

static double density_mixed(const lit *l, vec3 wi, double beta)
{
    return (beta > 0 ? beta * bis_light_pdf(l->light, wi) : 0) + (beta < 1 ? (1 - beta) * density_brdf(l, wi) : 0);
}

/* p of eq. 4.4, up to its factor. */
static double density_product(const lit *l, vec3 wi, double beta)
{
    double pdf;
    const rgbd f = model_of(l, wi, &pdf);
    const rgb Le = bis_light_Le(l->light, wi);
    const double product = f.r * (double)Le.r + f.g * (double)Le.g + f.b * (double)Le.b;

    return product * (beta > 0 ? dot(wi, l->pt.n) : 1); /* beta = 0: the twin without the cosine */
}

/* Integrals of the density over the blocks above the horizon, by midpoints: 6 x 6 in each pixel of the 128 x 64. */
static void integrate(double share[CELLS], const lit *l, density_fn *density, double beta)
{
    enum { W = 128, H = 64, K = 6 };

    for (int i = 0; i < CELLS; i++) share[i] = 0;
    for (int y = 0; y < H * K; y++) {
        const int row = y / K;
        const double c0 = cos(PI * row / H), c1 = cos(PI * (row + 1) / H), z = c0 + (c1 - c0) * (y % K + 0.5) / K,
                     s = sqrt(1 - z * z);
        for (int x = 0; x < W * K; x++) {
            const double phi = 2 * PI * (x + 0.5) / (W * K);
            const vec3 wi = vec3_from(s * cos(phi), s * sin(phi), z);
            if (dot(wi, l->pt.n) > 0) share[block_of(wi)] += density(l, wi, beta) * (c0 - c1) / K * 2 * PI / (W * K);
        }
    }
    share[BELOW] = 1;
    for (int i = 0; i < BLOCKS; i++) share[BELOW] -= share[i];
}

typedef struct way {
    const char *name;
    bis_proposal proposal;
    bool stratify, pooled;
    density_fn *density; /* NULL: beta q_L + (1 - beta) q_f */
} way;

static density_fn *density_of(const way *w) { return w->density ? w->density : density_mixed; }

static const way ways[] = {{"candidates_em", BIS_PROPOSAL_EM, false, false, NULL},
                           {"candidates_em_curve", BIS_PROPOSAL_EM, true, false, NULL},
                           {"candidates_em_pool", BIS_PROPOSAL_EM, true, true, NULL},
                           {"candidates_brdf", BIS_PROPOSAL_BRDF, false, false, NULL},
                           {"candidates_brdf_curve", BIS_PROPOSAL_BRDF, true, false, NULL},
                           {"candidates_mix", BIS_PROPOSAL_MIX, false, false, NULL},
                           {"candidates_mix_curve", BIS_PROPOSAL_MIX, true, false, NULL},
                           {"candidates_mix_pool", BIS_PROPOSAL_MIX, true, true, NULL}};
enum { N_WAYS = sizeof ways / sizeof *ways, M_DRAWN = 8, SETS = 40000 };

typedef enum twin { RIGHT, FIRST_ONLY, REDRAWN } twin;

/* A workspace for sets of M, and the stream of one of them. */
static bis_scratch new_scratch(uint32_t M)
{
    bis_settings s = bis_settings_default(&bis_sir);
    bis_scratch scratch;

    s.candidates = M;
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    return scratch;
}

static bis_stream stream_of(uint64_t run)
{
    static const bis_sampler sampler = {
        .kind = BIS_SAMPLER_STRATIFIED, .seed = SEED, .spp = 1, .xsamples = 1, .ysamples = 1, .jitter = true};
    bis_stream stream;

    bis_stream_init(&stream, &sampler, run, 0);
    return stream;
}

/* One candidate of each set, at random, so that what is counted is independent also where the set is stratified. */
static void count_candidates(double observed[CELLS], lit *l, const way *w, twin wrong)
{
    bis_scratch scratch = new_scratch(M_DRAWN);
    bis_set *x = scratch.set;
    bis_pool pool;
    bis_rng pick;

    memset(observed, 0, CELLS * sizeof *observed);
    assert_int_equal(bis_pool_init(&pool, M_DRAWN, NULL), BIS_OK);
    if (w->pooled) bis_scratch_share(&scratch, &pool.sets, NULL);
    bis_rng_init(&pick, SEED, 1, 2, 3);
    for (uint32_t run = 0, counted = 0; counted < SETS; run++) {
        bis_stream stream = stream_of(run);
        uint32_t number;
        if (w->pooled && run % 64 == 0) bis_pool_fill(&pool, l->light, SEED, run, 1);
        assert_true(bis_set_draw(x, M_DRAWN, w->proposal, w->stratify, &l->pt, &stream));
        do number = set_number(x, wrong == FIRST_ONLY ? 0 : (uint32_t)bis_rng_below(&pick, set_size(x)));
        while (wrong != FIRST_ONLY && !set_is_used(x, number));
        const vec3 wi = set_direction(x, number);
        const bool above = dot(wi, l->pt.n) > 0;
        if (!above && wrong == REDRAWN) continue;
        observed[above ? block_of(wi) : BELOW]++;
        counted++;
    }
    bis_scratch_clear(&scratch);
    bis_pool_clear(&pool);
}

/* Share of the candidates from the map, from the weights of a few: w = F/q, q = beta q_L + (1 - beta) q_f. */
static double find_beta(lit *l, const way *w)
{
    double beta = -1;

    if (w->proposal != BIS_PROPOSAL_MIX) return w->proposal == BIS_PROPOSAL_EM;
    bis_scratch scratch = new_scratch(M_DRAWN);
    for (uint64_t run = 0; beta < 0; run++) {
        bis_stream stream = stream_of(run);
        assert_true(bis_set_draw(scratch.set, M_DRAWN, w->proposal, w->stratify, &l->pt, &stream));
        bis_set_weigh(scratch.set, &l->pt);
        for (uint32_t i = 0; i < M_DRAWN; i++) {
            const uint32_t number = set_number(scratch.set, i);
            const vec3 wi = set_direction(scratch.set, number);
            const double weight = bis_set_weight(scratch.set, number), q_L = bis_light_pdf(l->light, wi),
                         q_f = density_brdf(l, wi);
            if (weight > 0) beta = (density_product(l, wi, 1) / weight - q_f) / (q_L - q_f);
        }
    }
    bis_scratch_clear(&scratch);
    assert_true(fabs(beta * M_DRAWN - round(beta * M_DRAWN)) < 1e-2);
    return round(beta * M_DRAWN) / M_DRAWN;
}

static void compare(const char *name, const double observed[CELLS], const double share[CELLS], double n, bool fits)
{
    double expected[CELLS];

    for (int i = 0; i < CELLS; i++) expected[i] = n * fmax(0, share[i]);
    if (fits) {
        stat_assert_fit(name, SEED, observed, expected, CELLS, alpha());
    } else {
        stat_assert_no_fit(name, SEED, observed, expected, CELLS, alpha());
    }
}

static void candidates_of_each_proposal_have_its_density(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    const bis_material materials[] = {bis_phong((rgb){0.2f, 0.3f, 0.1f}, (rgb){0.5f, 0.4f, 0.3f}, 10),
        bis_phong(grey(0.6), grey(0.3), 2.5), bis_microfacet((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.3f, 0.2f, 0.1f}, 0.5)};

    for (int i = 0; i < 3 * N_WAYS; i++) {
        const way *w = &ways[i % N_WAYS];
        double observed[CELLS], share[CELLS];
        lit l;
        lit_init(&l, light, materials[i / N_WAYS], lit_tilted(), 50, LIT_OPEN);
        const double beta = find_beta(&l, w);
        integrate(share, &l, density_of(w), beta);
        count_candidates(observed, &l, w, RIGHT);
        compare(w->name, observed, share, SETS, true);
        if (w->proposal == BIS_PROPOSAL_MIX) { /* twin: the density of another division */
            assert_true(beta > 0 && beta < 1);
            integrate(share, &l, density_mixed, beta == 0.5 ? 0.625 : 0.5);
            compare("candidates_mix_other_share", observed, share, SETS, false);
        }
    }
    bis_light_free(light);
}

static void first_of_a_set_and_redrawing_below_the_horizon_are_rejected_E1_E34(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);

    for (int i = 0; i < N_WAYS; i++) {
        const way *w = &ways[i];
        double observed[CELLS], share[CELLS];
        lit l;
        lit_init(&l, light, bis_phong(grey(0.1), grey(0.9), 2.5), lit_tilted(), 70, LIT_OPEN);
        integrate(share, &l, density_of(w), find_beta(&l, w));
        if (share[BELOW] > 0.01) {
            count_candidates(observed, &l, w, REDRAWN);
            compare("candidates_redrawn", observed, share, SETS, false);
        }
        if (!w->stratify && w->proposal != BIS_PROPOSAL_MIX) continue;
        count_candidates(observed, &l, w, FIRST_ONLY);
        compare("candidates_first", observed, share, SETS, false);
    }
    bis_light_free(light);
}

/* ---- narrow lobes ---- */

/* Head on, the lobe is all above the horizon, and 1 - cos^(n+1) and the azimuth are uniform. */
enum { RINGS = 24, SECTORS = 16, LOBE_CELLS = RINGS * SECTORS };

static void count_lobe(double observed[LOBE_CELLS], lit *l, double n, bool stratify, uint32_t M)
{
    bis_scratch scratch = new_scratch(M);
    bis_rng pick;

    memset(observed, 0, LOBE_CELLS * sizeof *observed);
    bis_rng_init(&pick, SEED, 4, 5, 6);
    for (uint32_t run = 0; run < SETS; run++) {
        bis_stream stream = stream_of(run);
        assert_true(bis_set_draw(scratch.set, M, BIS_PROPOSAL_BRDF, stratify, &l->pt, &stream));
        const vec3 wi = set_direction(scratch.set, set_number(scratch.set, (uint32_t)bis_rng_below(&pick, M))),
                   d = sub(wi, l->pt.bsdf.r);
        const double v = -expm1((n + 1) * log1p(-dot(d, d) / 2)),
                     phi = atan2(dot(wi, l->pt.bsdf.lobe.y), dot(wi, l->pt.bsdf.lobe.x));
        observed[(size_t)fmin(v * RINGS, RINGS - 1) * SECTORS +
                 (size_t)fmin((phi + PI) / (2 * PI) * SECTORS, SECTORS - 1)]++;
    }
    bis_scratch_clear(&scratch);
}

static void candidates_of_lobes_from_0_to_1e6_have_their_density(void **state)
{
    static const double exponents[] = {0, 1, 2.5, 10, 50, 1e3, 1e5, 1e6};
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);

    for (int i = 0; i < 8 * 4; i++) {
        const double n = exponents[i % 8];
        double observed[LOBE_CELLS], expected[LOBE_CELLS];
        lit l;
        lit_init(&l, light, bis_phong(grey(0), grey(1), n), lit_tilted(), 0, LIT_OPEN);
        for (int k = 0; k < LOBE_CELLS; k++) expected[k] = (double)SETS / LOBE_CELLS;
        count_lobe(observed, &l, n, i / 8 % 2, i / 16 ? M_DRAWN : 1);
        stat_assert_fit("candidates_lobe", SEED, observed, expected, LOBE_CELLS, alpha());
        /* twin: n + 1 for n, or 10 % more where that is too little to be seen */
        count_lobe(observed, &l, n <= 10 ? n + 1 : 0.9 * n, i / 8 % 2, i / 16 ? M_DRAWN : 1);
        stat_assert_no_fit("candidates_lobe_n", SEED, observed, expected, LOBE_CELLS, alpha());
    }
    bis_light_free(light);
}

/* ---- what rejection accepts ---- */

typedef struct recorder {
    bis_accel accel;
    double *hits;
} recorder;

static bool record(const bis_accel *a, const ray *r)
{
    ((const recorder *)a)->hits[block_of(r->d)]++;
    return false;
}

/* Glossy, where the cosine and the lobe differ between candidates of both kinds; diffuse:
 * tests/thesis/test_rejection.c. */
static void accepted_directions_of_glossy_surfaces_have_the_product_density_eq_4_4(void **state)
{
    static const bis_accel_ops recording = {.name = "recorder", .occluded = record};
    static const bis_proposal proposals[] = {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_CHOOSE};
    const bis_material materials[] = {bis_phong((rgb){0.4f, 0.2f, 0.3f}, (rgb){0.3f, 0.6f, 0.5f}, 10),
                                      bis_microfacet((rgb){0.4f, 0.2f, 0.3f}, (rgb){0.3f, 0.6f, 0.5f}, 0.6)};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);

    for (int i = 0; i < 2 * 3; i++) {
        double hits[CELLS] = {0}, share[CELLS];
        recorder rec = {{.ops = &recording}, hits};
        bis_settings s = bis_settings_default(&bis_rejection);
        stat_moments m[4];
        lit l;
        s.proposal = proposals[i % 3];
        s.candidates = s.shadowrays = 16;
        s.estimator = BIS_ESTIMATOR_PLAIN;
        lit_init(&l, light, materials[i / 3], lit_tilted(), 50, LIT_OPEN);
        l.pt.accel = &rec.accel;
        lit_run(m, &l, &s, 40000, SEED);
        for (int k = 1; k >= 0; k--) {
            double total = 0;
            integrate(share, &l, density_product, k);
            for (int j = 0; j < BLOCKS; j++) total += share[j];
            for (int j = 0; j < BLOCKS; j++) share[j] /= total;
            share[BELOW] = 0;
            compare(k ? "rejection_glossy" : "rejection_glossy_without_cosine", hits, share,
                (double)l.counters.shadow_rays, k == 1);
        }
    }
    bis_light_free(light);
}

/* ---- angular input ---- */

/* A probe of large soft lights, a black wedge, and hard edges along pixels. */
enum { SIDE = 48 };

static rgb probe_pixel(int x, int y)
{
    const double u = 2 * (x + 0.5) / SIDE - 1, v = 1 - 2 * (y + 0.5) / SIDE;

    if (x / 8 == 4 && y / 8 == 1) return (rgb){6, 5, 4};
    if (x >= 6 && x < 10 && y >= 26 && y < 30) return (rgb){0, 0, 0};
    return rgb_from(0.4 + exp(-8 * ((u - 0.3) * (u - 0.3) + v * v)), 0.5 + 0.4 * u, 0.6 + 0.5 * v);
}

static bis_envmap probe_map(int width, bool upside_down)
{
    bis_image image;
    bis_envmap em;

    assert_int_equal(bis_image_init(&image, SIDE, SIDE, NULL), BIS_OK);
    for (int i = 0; i < SIDE * SIDE; i++)
        image.pixels[i] = probe_pixel(i % SIDE, upside_down ? SIDE - 1 - i / SIDE : i / SIDE);
    assert_int_equal(bis_envmap_from_mapping(&em, &image, BIS_MAPPING_ANGULAR, width, NULL), BIS_OK);
    bis_image_clear(&image);
    return em;
}

typedef enum drawing { ALIAS, CDF, CURVE } drawing;
typedef enum map_twin { MAP_RIGHT, THETA_UNIFORM, AS_THE_CENTRE } map_twin;

static void draw_from_map(
    vec3 *w, const bis_envmap *em, const bis_importance *im, drawing how, bis_rng *g, map_twin wrong)
{
    bis_map_sample s;
    double u[4];

    for (int k = 0; k < 4; k++) u[k] = bis_rng_double(g);
    assert_true(how == CURVE ? bis_importance_sample_curve(im, u[0], u + 2, &s) : bis_importance_sample(im, u, &s));
    *w = s.w_local;
    if (wrong == MAP_RIGHT) return;
    const int x = (int)s.pixel % em->width, y = (int)s.pixel / em->width;
    const double theta = PI * (y + bis_rng_double(g)) / em->height,
                 phi = 2 * PI * (x + bis_rng_double(g)) / em->width; /* the sine is missing */
    *w = wrong == AS_THE_CENTRE ? bis_envmap_direction(em, x, y, 0.5, 0.5)
                                : vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
}

static bis_importance *importance_of(const bis_envmap *em, drawing how, double b)
{
    const bis_importance_options o = {.table = how != CURVE,
        .curve = how == CURVE,
        .table_kind = how == CDF ? BIS_TABLE_CDF : BIS_TABLE_ALIAS,
        .area_exponent = b,
        .levels = 8};
    bis_importance *im;

    assert_int_equal(bis_importance_new(&im, em, &o, NULL), BIS_OK);
    return im;
}

/* 4 x 4 cells of equal solid angle inside each pixel of the resampled map (40 x 20), poles and seam included. */
static void check_cells(drawing how, double b, map_twin wrong)
{
    enum { N = 400000 };
    bis_envmap em = probe_map(40, false);
    bis_importance *im = importance_of(&em, how, b);
    const size_t cells = 16 * map_n(&em), width = 4 * (size_t)em.width;
    double *observed = bis_alloc(cells, sizeof *observed), *expected = bis_alloc(cells, sizeof *expected), sum = 0;
    bis_rng g;

    bis_rng_init(&g, SEED, 7, 0, 0);
    memset(observed, 0, cells * sizeof *observed);
    for (int i = 0; i < N; i++) {
        vec3 w;
        draw_from_map(&w, &em, im, how, &g, wrong);
        const double theta = atan2(hypot((double)w.x, (double)w.y), (double)w.z), phi = atan2((double)w.y, (double)w.x);
        const int y = (int)fmin(theta / PI * em.height, em.height - 1);
        const double top = cos(PI * y / em.height), bottom = cos(PI * (y + 1) / em.height);
        const int v = (int)fmin(fmax(4 * (top - cos(theta)) / (top - bottom), 0), 3);
        observed[(size_t)(4 * y + v) * width +
                 (size_t)((double)width * (phi < 0 ? phi + 2 * PI : phi) / (2 * PI)) % width]++;
    }
    for (size_t i = 0; i < cells; i++) {
        const size_t pixel = i / width / 4 * (size_t)em.width + i % width / 4;
        expected[i] = b > 0 ? bis_importance_pdf_pixel(im, pixel)
                            : map_intensity(&em, pixel); /* the areas: tests/thesis/test_importance.c */
        sum += expected[i] *= map_solid_angle(&em, pixel);
    }
    for (size_t i = 0; i < cells; i++) expected[i] *= N / sum;
    if (wrong == MAP_RIGHT) {
        stat_assert_fit("angular_cells", SEED, observed, expected, cells, alpha());
    } else {
        stat_assert_no_fit("angular_cells_wrong", SEED, observed, expected, cells, alpha());
    }
    bis_free(observed);
    bis_free(expected);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

static void directions_from_a_probe_fit_inside_the_pixels_E2(void **state)
{
    for (drawing how = ALIAS; how <= CURVE; how++) {
        check_cells(how, 0, MAP_RIGHT);
        check_cells(how, 0.15, MAP_RIGHT);
        check_cells(how, 0, THETA_UNIFORM);
        check_cells(how, 0, AS_THE_CENTRE);
    }
}

/* Back on the disc, from a map so fine that its pixels smear little over the blocks' edges: where the probe's own
 * pixels, each with its solid angle pi^2 sinc(pi r) dA, say that the light is. 12 x 12 blocks. */
static void directions_from_a_probe_come_from_where_its_pixels_shine(void **state)
{
    enum { N = 100000, BLOCK = 4, SIDE_BLOCKS = SIDE / BLOCK, DISC_CELLS = SIDE_BLOCKS * SIDE_BLOCKS, K = 8 };
    double expected[2][DISC_CELLS] = {{0}}, total[2] = {0};

    for (int i = 0; i < SIDE * SIDE * K * K; i++) {
        const int x = i / (K * K) % SIDE, y = i / (K * K) / SIDE;
        const double u = 2 * (x + (i % K + 0.5) / K) / SIDE - 1, v = 1 - 2 * (y + ((int)(i / K % K) + 0.5) / K) / SIDE,
                     r = hypot(u, v);
        if (r > 1) continue;
        for (int k = 0; k < 2; k++) { /* [1]: dA for the solid angle */
            const double flux = rgb_sum(probe_pixel(x, y)) * (k ? 1 : sin(PI * r) / (PI * r));
            expected[k][y / BLOCK * SIDE_BLOCKS + x / BLOCK] += flux;
            total[k] += flux;
        }
    }
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < DISC_CELLS; i++) expected[k][i] *= N / total[k];

    for (int upside_down = 0; upside_down < 2; upside_down++) {
        bis_envmap em = probe_map(384, upside_down);
        bis_importance *im = importance_of(&em, ALIAS, 0);
        double observed[DISC_CELLS] = {0};
        bis_rng g;
        bis_rng_init(&g, SEED, 8, 0, 0);
        for (int i = 0; i < N; i++) {
            vec3 w;
            draw_from_map(&w, &em, im, ALIAS, &g, MAP_RIGHT);
            const double h = hypot((double)w.y, (double)w.z), r = atan2(h, -(double)w.x) / PI;
            const double u = -(double)w.y / h * r, v = (double)w.z / h * r;
            const int x = (int)fmin((u + 1) / 2 * SIDE, SIDE - 1), y = (int)fmin((1 - v) / 2 * SIDE, SIDE - 1);
            observed[y / BLOCK * SIDE_BLOCKS + x / BLOCK]++;
        }
        if (upside_down) {
            stat_assert_no_fit("probe_upside_down", SEED, observed, expected[0], DISC_CELLS, alpha());
        } else {
            stat_assert_fit("probe", SEED, observed, expected[0], DISC_CELLS, alpha());
            stat_assert_no_fit("probe_without_solid_angle", SEED, observed, expected[1], DISC_CELLS, alpha());
        }
        bis_importance_free(im);
        bis_envmap_clear(&em);
    }
}

/* ---- p-values ---- */

enum { RUNS = 2000, P_BINS = 20, P_CELLS = 32, P_DRAWS = 3200 };

/* Fill a histogram that is right, or slightly not; the same expected counts for each seed. */
typedef void fill_fn(double observed[P_CELLS], double expected[P_CELLS], const void *what, bool wrong, uint64_t seed);

static void fill_alias(double observed[P_CELLS], double expected[P_CELLS], const void *what, bool wrong, uint64_t seed)
{
    const bis_alias *a = what;
    bis_rng g;

    bis_rng_init(&g, seed, 0, 0, 0);
    for (int i = 0; i < P_DRAWS; i++) {
        double u = bis_rng_double(&g);
        observed[wrong && u > 0.98 ? 5 : bis_alias_sample(a, u)]++;
    }
    for (int i = 0; i < P_CELLS; i++) expected[i] = P_DRAWS * (1 + i % 5) / a->total;
}

static void fill_lobe(double observed[P_CELLS], double expected[P_CELLS], const void *what, bool wrong, uint64_t seed)
{
    const double n = *(const double *)what;
    bis_rng g;

    bis_rng_init(&g, seed, 1, 0, 0);
    for (int i = 0; i < P_DRAWS; i++) {
        vec3 w;
        double pdf, u1 = bis_rng_double(&g), u2 = bis_rng_double(&g);
        bis_phong_lobe_sample(&w, &pdf, wrong ? 1.05 * n : n, u1, u2);
        double v = -expm1((n + 1) / 2 * log1p(-((double)w.x * (double)w.x + (double)w.y * (double)w.y)));
        observed[(int)fmin(8 * v, 7) * 4 + (w.x < 0) * 2 + (w.y < 0)]++;
    }
    for (int i = 0; i < P_CELLS; i++) expected[i] = (double)P_DRAWS / P_CELLS;
}

typedef struct map_of {
    const bis_envmap *em;
    const bis_importance *im;
} map_of;

/* 8 x 4 blocks of the map. */
static void fill_em(double observed[P_CELLS], double expected[P_CELLS], const void *what, bool wrong, uint64_t seed)
{
    const map_of *m = what;
    double sum = 0;
    bis_rng g;

    bis_rng_init(&g, seed, 2, 0, 0);
    for (int i = 0; i < P_CELLS; i++) expected[i] = 0;
    for (size_t i = 0; i < map_n(m->em); i++) {
        double flux = map_intensity(m->em, i) * map_solid_angle(m->em, i);
        expected[i / 40 / 5 * 8 + i % 40 / 5] += flux;
        sum += flux;
    }
    for (int i = 0; i < P_CELLS; i++) expected[i] *= P_DRAWS / sum;
    for (int i = 0; i < P_DRAWS; i++) {
        vec3 w;
        draw_from_map(&w, m->em, m->im, ALIAS, &g, MAP_RIGHT);
        if (wrong) w.z = (float)(0.97 * (double)w.z);
        const double theta = acos((double)w.z), phi = atan2((double)w.y, (double)w.x);
        observed[(int)fmin(theta / PI * 4, 3) * 8 + (int)(8 * (phi < 0 ? phi + 2 * PI : phi) / (2 * PI)) % 8]++;
    }
}

static void check_p_values(const char *name, fill_fn *fill, const void *what)
{
    double expected_bins[P_BINS];

    for (int wrong = 0; wrong < 2; wrong++) {
        double bins[P_BINS] = {0};
        for (uint64_t run = 0; run < RUNS; run++) {
            double observed[P_CELLS] = {0}, expected[P_CELLS];
            fill(observed, expected, what, wrong, 5000 + run);
            bins[(int)fmin(stat_chi_square(observed, expected, P_CELLS, alpha()).p * P_BINS, P_BINS - 1)]++;
        }
        for (int i = 0; i < P_BINS; i++) expected_bins[i] = (double)RUNS / P_BINS;
        if (wrong) {
            stat_assert_no_fit(name, 5000, bins, expected_bins, P_BINS, alpha());
        } else {
            stat_assert_fit(name, 5000, bins, expected_bins, P_BINS, alpha());
        }
    }
}

/* Alias tables, a lobe, the map: each right over 2000 seeds, each a little wrong (too little for one test) found by all
 * of them. */
static void chi_square_p_values_of_right_samplers_are_uniform_over_seeds(void **state)
{
    double w[P_CELLS];
    const double n = 2.5;
    bis_alias a;
    bis_envmap em = probe_map(40, false);
    bis_importance *im = importance_of(&em, ALIAS, 0);

    for (int i = 0; i < P_CELLS; i++) w[i] = 1 + i % 5;
    assert_int_equal(bis_alias_init(&a, w, P_CELLS, NULL), BIS_OK);
    check_p_values("p_values_alias", fill_alias, &a);
    check_p_values("p_values_lobe", fill_lobe, &n);
    check_p_values("p_values_em", fill_em, &(map_of){&em, im});
    bis_alias_clear(&a);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(candidates_of_each_proposal_have_its_density),
        cmocka_unit_test(first_of_a_set_and_redrawing_below_the_horizon_are_rejected_E1_E34),
        cmocka_unit_test(candidates_of_lobes_from_0_to_1e6_have_their_density),
        cmocka_unit_test(accepted_directions_of_glossy_surfaces_have_the_product_density_eq_4_4),
        cmocka_unit_test(directions_from_a_probe_fit_inside_the_pixels_E2),
        cmocka_unit_test(directions_from_a_probe_come_from_where_its_pixels_shine),
        cmocka_unit_test(chi_square_p_values_of_right_samplers_are_uniform_over_seeds),
    };

    return cmocka_run_group_tests_name("directions", tests, NULL, NULL);
}
