/* SPDX-License-Identifier: BSD-2-Clause */
/* errata: every switch of `--as-printed`, in both directions. The same check passes the right equation and rejects the
 * printed one; where the printed one has a value in closed form, that is what comes out. Then the switches themselves:
 * names, scenes, options, the EXR's record of them.
 *
 * Family-wise significance 1e-3. docs/errata.md argues each item. */
#include "bis/thesis/errata.h"
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/render/render.h"

#include "claim.h"
#include "file_help.h"
#include "lit.h"
#include "program.h"
#include "thesis/as_printed.h"

#include <stdio.h>
#include <string.h>

#define SEED 71u
#define DIR "build/test_errata"

enum { W = 128, H = 64 }; /* of lit's maps */

static double alpha(void) { return stat_level(1e-3, 38); }

static bis_material white_diffuse(void) { return bis_phong(grey(1), grey(0), 1); }

static const vec3 up = {0, 0, 1};

/* A light from pixel(x, y), drawn as printed or not. */
static bis_light *new_light(rgb (*pixel)(int x, int y), double b, bis_table_kind kind, unsigned as_printed)
{
    const bis_light_desc desc = {.L = {1, 1, 1},
        .scale = 1,
        .area_exponent = b,
        .levels = 8,
        .table_kind = kind,
        .as_printed = as_printed,
        .to_world = bis_xform_identity()};
    bis_image image = {.width = W, .height = H, .pixels = bis_alloc(W * H, sizeof *image.pixels)};
    bis_light *light;
    bis_envmap em;

    for (int i = 0; i < W * H; i++) image.pixels[i] = pixel(i % W, i / W);
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL), BIS_OK);
    return light;
}

static bis_settings settings(
    const bis_integrator *integrator, uint32_t M, uint32_t N, bis_proposal proposal, unsigned as_printed)
{
    bis_settings s = bis_settings_default(integrator);

    s.samples = s.shadowrays = N;
    s.candidates = M;
    s.proposal = proposal;
    s.as_printed = as_printed;
    return s;
}

/* ---- E3 ---- */

static rgb one(int x, int y)
{
    return (rgb){1, 1, 1};
}

/* All rows are drawn alike, L/q is cancelled to 4 pi: 4 pi/pi times the mean over the rows of cos theta (up), or of sin
 * theta times the mean 1/pi of cos+ phi. */
static double irradiance_by_rows(bool facing_up)
{
    enum { K = 500 };
    double sum = 0;

    for (int y = 0; y < H; y++) {
        double c0 = cos(PI * y / H), c1 = cos(PI * (y + 1) / H);
        for (int k = 0; k < K; k++) {
            double z = c0 + (c1 - c0) * (k + 0.5) / K;
            sum += facing_up ? fmax(0, z) : sqrt(1 - z * z) / PI;
        }
    }
    return 4 * sum / (H * K);
}

static void E3_importance_without_solid_angle_makes_the_poles_too_bright(void **state)
{
    const vec3 normals[] = {up, {1, 0, 0}};

    bis_light *right = new_light(one, 0, BIS_TABLE_ALIAS, 0), *printed = new_light(one, 0, BIS_TABLE_ALIAS, BIS_E3);
    assert_true(fabs(irradiance_by_rows(true) - 4 / PI) < 1e-3);
    assert_true(fabs(irradiance_by_rows(false) - 8 / (PI * PI)) < 1e-3);
    for (int i = 0; i < 4; i++) { /* by the table and along the curve */
        const bis_settings s = settings(i / 2 ? &bis_sir : &bis_em, 16, i / 2 ? 1 : 16, BIS_PROPOSAL_EM, 0);
        stat_moments m[4];
        lit l;
        lit_init(&l, right, white_diffuse(), normals[i % 2], 30, LIT_OPEN);
        lit_run(m, &l, &s, 4000, SEED);
        stat_assert_mean("E3", SEED, &m[0], 1, alpha());
        lit_init(&l, printed, white_diffuse(), normals[i % 2], 30, LIT_OPEN);
        lit_run(m, &l, &s, 4000, SEED);
        stat_assert_not_mean("E3_printed", SEED, &m[0], 1, alpha());
        stat_assert_mean("E3_4_over_pi", SEED, &m[0], irradiance_by_rows(i % 2 == 0), alpha());
    }
    bis_light_free(right);
    bis_light_free(printed);
}

/* ---- E6 ---- */

static void E6_one_mean_visibility_turns_coloured_shadows_grey(void **state)
{
    bis_light *light = lit_new_light(LIT_RED_BLUE, 1, 0, false);

    for (int i = 0; i < 2; i++) {
        bis_settings s = settings(i ? &bis_rejection : &bis_sir, 64, 8, BIS_PROPOSAL_EM, 0);
        stat_moments m[4];
        lit l;
        s.estimator = BIS_ESTIMATOR_RATIO;
        lit_init(&l, light, white_diffuse(), up, 30, LIT_HALF); /* red is hidden: the truth is (0, 0, 1/2) */
        lit_run(m, &l, &s, 4000, SEED);
        assert_true(m[0].mean == 0);
        if (i == 0) stat_assert_mean("E6", SEED, &m[2], 0.5, alpha()); /* the ratio estimator has its bias of O(1/M) */
        s.as_printed = BIS_E6;
        lit_run(m, &l, &s, 4000, SEED);
        stat_assert_not_mean("E6_red", SEED, &m[0], 0, alpha());
        stat_assert_not_mean("E6_blue", SEED, &m[2], 0.5, alpha());
        assert_true(fabs(m[0].mean - 0.25) < 0.02 && fabs(m[2].mean - 0.25) < 0.02); /* (1/2, 0, 1/2) of it */
        if (i == 0) stat_assert_mean("E6_sum", SEED, &m[3], 0.5, alpha()); /* intensity is right, colour is not */
    }
    bis_light_free(light);
}

/* ---- E13 ---- */

/* Radiances from 3 to 3e4, some black. */
static rgb contrasty(int x, int y)
{
    double i = pow(10, 4.0 * ((x * 7919 + y * 104729) % 1009) / 1009);

    return (x + y) % 7 == 0 ? (rgb){0, 0, 0} : rgb_from(i, i, i);
}

/* Half the sum of |P - q dO| over the pixels: what the tables draw against what estimators divide by. */
static double total_variation(const bis_light *light)
{
    const bis_importance *im = bis_light_importance(light);
    double *pmf = bis_alloc(W * H, sizeof *pmf), sum = 0;

    assert_int_equal(bis_importance_implied_pmf(im, pmf, NULL), BIS_OK);
    for (size_t i = 0; i < W * H; i++) {
        sum += fabs(pmf[i] - bis_importance_pdf_pixel(im, i) * bis_light_envmap(light)->row_solid_angle[i / W]) / 2;
    }
    bis_free(pmf);
    return sum;
}

static void E13_alias_tables_from_raw_weights_do_not_draw_by_importance(void **state)
{
    const bis_settings s = settings(&bis_em, 1, 64, BIS_PROPOSAL_EM, 0);

    for (int i = 0; i < 3; i++) { /* right; printed; printed, with CDFs, which it does not reach */
        bis_light *light = new_light(contrasty, 0, i == 2 ? BIS_TABLE_CDF : BIS_TABLE_ALIAS, i ? BIS_E13 : 0);
        stat_moments m[4];
        lit l;
        lit_init(&l, light, white_diffuse(), up, 30, LIT_HALF);
        lit_run(m, &l, &s, 2000, SEED);
        double truth = rgbd_sum(lit_truth(&l, true));
        if (i == 1) {
            stat_assert_not_mean("E13_printed", SEED, &m[3], truth, alpha());
            assert_true(total_variation(light) > 0.5);
        } else {
            stat_assert_mean("E13", SEED, &m[3], truth, alpha());
            assert_true(total_variation(light) < 1e-8);
        }
        bis_light_free(light);
    }
}

/* ---- E20 ---- */

/* A red sun of one pixel over a blue sky. */
static rgb sun_and_sky(int x, int y) { return x == 90 && y == 18 ? (rgb){5000, 0, 0} : (rgb){0, 0, 1}; }

/* b = 0.45 makes of one of our pixels, 0.0019 sr, about what 0.15 makes of a sun of 6.8e-5 sr: half of its share of the
 * samples is lost. */
static void E20_the_unweighted_density_takes_light_from_the_sun_and_gives_it_to_the_sky(void **state)
{
    const double b = 0.45;
    bis_light *right = new_light(sun_and_sky, b, BIS_TABLE_ALIAS, 0),
              *printed = new_light(sun_and_sky, b, BIS_TABLE_ALIAS, BIS_E20);
    double A = bis_light_envmap(right)->row_solid_angle[18], factor = pow(A / 0.01, b), sun = 5000 * A,
           sky = 4 * PI - A;
    double mean_factor = (sun * factor + sky) / (sun + sky);

    assert_true(factor > 0.44 && factor < 0.50);
    for (int i = 0; i < 2; i++) {
        const bis_settings s = settings(i ? &bis_sir : &bis_em, 16, i ? 1 : 16, BIS_PROPOSAL_EM, 0);
        stat_moments m[4];
        lit l;
        lit_init(&l, right, white_diffuse(), up, 30, LIT_OPEN);
        rgbd truth = lit_truth(&l, true);
        lit_run(m, &l, &s, 4000, SEED);
        stat_assert_mean("E20_sun", SEED, &m[0], truth.r, alpha());
        stat_assert_mean("E20_sky", SEED, &m[2], truth.b, alpha());
        lit_init(&l, printed, white_diffuse(), up, 30, LIT_OPEN);
        lit_run(m, &l, &s, 4000, SEED);
        stat_assert_not_mean("E20_printed_sun", SEED, &m[0], truth.r, alpha());
        stat_assert_not_mean("E20_printed_sky", SEED, &m[2], truth.b, alpha());
        stat_assert_mean("E20_sun_factor", SEED, &m[0], truth.r * factor / mean_factor, alpha());
        stat_assert_mean("E20_sky_factor", SEED, &m[2], truth.b / mean_factor, alpha());
    }
    bis_light_free(right);
    bis_light_free(printed);
}

/* ---- E21 ---- */

static void E21_L_ns_from_other_candidates_is_biased_at_small_M(void **state)
{
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);

    for (uint32_t M = 1; M <= 4; M *= 2) {
        bis_settings s = settings(&bis_sir, M, 1, BIS_PROPOSAL_EM, 0);
        stat_moments m[4];
        lit l;
        s.stratify = false;
        lit_init(&l, light, white_diffuse(), up, 30, LIT_HALF);
        lit_run(m, &l, &s, 20000, SEED);
        stat_assert_mean("E21", SEED, &m[0], 0.5, alpha());
        s.as_printed = BIS_E21;
        lit_run(m, &l, &s, 20000, SEED);
        stat_assert_not_mean("E21_printed", SEED, &m[0], 0.5, alpha());
        /* none of M directions on the sphere lies above the horizon: black, although L_ns is 1 elsewhere; else a
         * visible half of what is above */
        stat_assert_mean("E21_product", SEED, &m[0], 0.5 * (1 - pow(0.5, M)), alpha());
    }
    bis_light_free(light);
}

/* ---- E22 ---- */

/* E[N/M]/p, M the number of draws up to the N-th success (negative binomial). */
static double overestimate(int N, double p)
{
    double probability = pow(p, N), sum = 0;

    for (int M = N; M < 100000; M++) {
        sum += probability * N / M / p;
        probability *= (1 - p) * M / (M + 1 - N);
    }
    return sum;
}

static void E22_drawing_until_N_are_accepted_is_too_bright(void **state)
{
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);

    assert_true(fabs(overestimate(1, 0.02) - 4.0) < 0.02 && fabs(overestimate(4, 0.02) - 1.32) < 0.01);
    assert_true(fabs(overestimate(15, 0.02) - 1.070) < 0.001);
    assert_true(fabs(overestimate(1, 0.25) + log(0.25) / 0.75) < 1e-9);
    for (uint32_t N = 1; N <= 4;
        N += 3) { /* cos theta/B: one in four is accepted, and of M = 200 four will always be */
        bis_settings s = settings(&bis_rejection, 200, N, BIS_PROPOSAL_EM, 0);
        stat_moments m[4];
        lit l;
        s.estimator = BIS_ESTIMATOR_PLAIN;
        lit_init(&l, light, white_diffuse(), up, 30, LIT_OPEN);
        lit_run(m, &l, &s, 3000, SEED);
        stat_assert_mean("E22", SEED, &m[0], 1, alpha());
        s.as_printed = BIS_E22;
        lit_run(m, &l, &s, 3000, SEED);
        stat_assert_not_mean("E22_printed", SEED, &m[0], 1, alpha());
        stat_assert_mean("E22_negative_binomial", SEED, &m[0], overestimate((int)N, 0.25), alpha());
    }
    bis_light_free(light);
}

/* ---- E23, E34 ---- */

/* The share of the lobe (n+1)/(2 pi) cos^n alpha that lies above the horizon, its axis at `degrees` from the normal. */
static double share_above(double n, double degrees)
{
    enum { K = 100000 };
    double theta = degrees * PI / 180, sum = 0;

    for (int k = 0; k < K; k++) {
        double cos_alpha = pow((k + 0.5) / K, 1 / (n + 1)),
               x = -cos_alpha / (sqrt(1 - cos_alpha * cos_alpha) * tan(theta));
        sum += x <= -1 ? 1 : acos(x) / PI; /* of the circle about the axis */
    }
    return sum / K;
}

static void E23_weights_f_and_L_reflect_more_than_arrives(void **state)
{
    static const double degrees[] = {60, 85}, albedo[] = {0.490, 0.108};
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    stat_moments m[4];
    lit l;

    assert_true(fabs(share_above(50, 85) - 0.73) < 0.005);
    for (int i = 0; i < 2; i++) {
        bis_settings s = settings(&bis_sir, 16, 4, BIS_PROPOSAL_BRDF, 0);
        lit_init(&l, light, bis_phong(grey(0), grey(1), 50), up, degrees[i], LIT_OPEN);
        double truth = lit_truth(&l, true).r;
        assert_true(fabs(truth - albedo[i]) < 1e-3);
        lit_run(m, &l, &s, 4000, SEED);
        stat_assert_mean("E23", SEED, &m[0], truth, alpha());
        s.as_printed = BIS_E23;
        lit_run(m, &l, &s, 4000, SEED);
        stat_assert_not_mean("E23_printed", SEED, &m[0], truth, alpha());
        stat_assert_mean("E23_share", SEED, &m[0], share_above(50, degrees[i]), alpha());
    }
    bis_settings s =
        settings(&bis_sir, 16, 4, BIS_PROPOSAL_EM, BIS_E23); /* w = f_r: a white surface returns twice what it gets */
    lit_init(&l, light, white_diffuse(), up, 30, LIT_OPEN);
    lit_run(m, &l, &s, 4000, SEED);
    assert_true(fabs(m[0].mean - 2) < 1e-6); /* all estimates are the same but for rounding */
    bis_light_free(light);
}

static void E34_redrawing_below_the_horizon_adds_64_percent_at_85_degrees(void **state)
{
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    bis_settings s = settings(&bis_brdf, 1, 16, BIS_PROPOSAL_BRDF, 0);
    stat_moments m[4];
    lit l;

    assert_true(fabs(1 / share_above(10, 85) - 1.64) < 0.01);
    lit_init(&l, light, bis_phong(grey(0), grey(1), 10), up, 85, LIT_OPEN);
    double truth = lit_truth(&l, true).r;
    lit_run(m, &l, &s, 4000, SEED);
    stat_assert_mean("E34", SEED, &m[0], truth, alpha());
    s.as_printed = BIS_E34;
    lit_run(m, &l, &s, 4000, SEED);
    stat_assert_not_mean("E34_printed", SEED, &m[0], truth, alpha());
    stat_assert_mean("E34_share", SEED, &m[0], truth / share_above(10, 85), alpha());
    bis_light_free(light);
}

/* ---- E27 ---- */

/* L_max over the power, times L_ns: white light has the intensity 3 and the power 12 pi. */
static void E27_the_bound_as_printed_of_the_brdfs_proposal_is_L_max_over_the_power(void **state)
{
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    lit l;
    lit_init(&l, light, white_diffuse(), up, 30, LIT_OPEN);
    assert_true(fabs(bis_as_printed_bound(&l.pt, BIS_PROPOSAL_BRDF, 2) - 2 / (4 * PI)) < 1e-7);
    bis_light_free(light);
}

static bool is_low(const bis_accel *a, const ray *r)
{
    return r->d.z < 0.5f;
}

/* Light comes from above 30 degrees alone: 3/4 of a diffuse surface's. Acceptance min(1, 4 pi cos theta) is nearly
 * uniform: it sees 1/2 / (1 - 1/(8 pi)). */
static void E27_accepting_against_f_max_does_not_accept_by_the_product(void **state)
{
    static const bis_accel_ops ops = {.name = "low", .occluded = is_low};
    const bis_accel accel = {.ops = &ops};
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    bis_settings s = settings(&bis_rejection, 800, 8, BIS_PROPOSAL_EM, 0);
    stat_moments m[4];
    lit l;

    lit_init(&l, light, white_diffuse(), up, 30, LIT_OPEN);
    l.pt.accel = &accel;
    lit_run(m, &l, &s, 1500, SEED);
    stat_assert_mean("E27", SEED, &m[0], 0.75, alpha());
    s.as_printed = BIS_E27;
    lit_run(m, &l, &s, 1500, SEED);
    stat_assert_not_mean("E27_printed", SEED, &m[0], 0.75, alpha());
    stat_assert_mean("E27_uniform", SEED, &m[0], 0.5 / (1 - 1 / (8 * PI)), alpha());
    bis_light_free(light);
}

/* ---- E29 ---- */

static void E29_the_unshadowed_fallback_lights_a_fully_hidden_point(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    bis_settings s = settings(&bis_rejection, 100, 8, BIS_PROPOSAL_EM, 0);
    stat_moments m[4];
    lit l;

    lit_init(&l, light, bis_phong(grey(0), grey(1), 1000), up, 40, LIT_ALL);
    lit_run(m, &l, &s, 2000, SEED);
    assert_true(m[3].mean == 0 && m[3].m2 == 0);
    s.as_printed = BIS_E29;
    lit_run(m, &l, &s, 2000, SEED);
    stat_assert_not_mean("E29_printed", SEED, &m[3], 0, alpha());
    bis_light_free(light);
}

/* ---- the switches ---- */

static void every_switch_has_a_flag_a_paragraph_and_a_scene_of_its_own(void **state)
{
    static char doc[1 << 16];
    unsigned all = 0;
    int n = 0;

    read_text(doc, sizeof doc, "docs/errata.md");
    for (const bis_erratum *e = bis_errata; e->name; e++, n++) {
        char heading[32], path[64], buf[BIS_ERRATA_TEXT];
        snprintf(heading, sizeof heading, "**%s. ", e->name);
        snprintf(path, sizeof path, "data/scenes/errata/%s.txt", e->name);
        assert_true(e->flag && !(e->flag & (e->flag - 1)) && !(all & e->flag));
        all |= e->flag;
        assert_non_null(strstr(doc, heading));
        assert_true(program_exists(path));
        assert_ptr_equal(bis_erratum_find(e->name), e);
        assert_string_equal(bis_errata_text(buf, e->flag), e->name);
    }
    assert_true(n >= 8);
    char buf[BIS_ERRATA_TEXT];
    bis_errata_text(buf, all); /* asserts that all names fit */
    assert_string_equal(bis_errata_text(buf, BIS_E20 | BIS_E6), "E6 E20");
    assert_string_equal(bis_errata_text(buf, 0), "");
    assert_null(bis_erratum_find("E5"));
    assert_string_equal(bis_erratum_nearest("e22"), "E22");
}

/* Not a bit of any estimate, for the integrators that the table does not name. */
static void a_switch_changes_nothing_where_it_does_not_reach(void **state)
{
    for (const bis_erratum *e = bis_errata; e->name; e++) {
        bis_light *right = new_light(contrasty, 0.15, BIS_TABLE_ALIAS, 0),
                  *printed = new_light(contrasty, 0.15, BIS_TABLE_ALIAS, e->flag);
        for (const bis_integrator *const *i = bis_integrators; *i; i++) {
            if (*i == &bis_exact || bis_erratum_reaches(e, (*i)->name)) continue;
            bis_settings s = bis_settings_default(*i);
            bis_scratch scratch;
            lit a, b;
            s.candidates = s.samples = 32;
            assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
            lit_init(&a, right, bis_phong(grey(0.5), grey(0.5), 5), up, 60, LIT_HALF);
            lit_init(&b, printed, bis_phong(grey(0.5), grey(0.5), 5), up, 60, LIT_HALF);
            for (uint64_t run = 0; run < 20; run++) {
                s.as_printed = 0;
                rgb x = lit_once(&a, &s, &scratch, SEED, run);
                s.as_printed = e->flag;
                rgb y = lit_once(&b, &s, &scratch, SEED, run);
                assert_true(x.r == y.r && x.g == y.g && x.b == y.b);
            }
            bis_scratch_clear(&scratch);
        }
        bis_light_free(right);
        bis_light_free(printed);
    }
}

/* The scene at 20 columns; the mean of r+g+b. */
static double render_small(const char *path, unsigned as_printed, rgb pixels[20 * 15])
{
    bis_diag diag = {0};
    bis_scene_desc *desc;
    bis_scene *scene;
    bis_film film = {0};
    bis_render_result result;
    const bis_render_options options = {.budget = {.spp = 2}, .n_threads = 1};
    float rgba[20 * 15 * 4];
    double sum = 0;

    if (bis_scene_parse(&desc, path, &diag)) fail_msg("%s", diag.messages[0].text);
    assert_int_equal(diag.n, 0);
    assert_int_equal(desc->view.settings.as_printed, 0); /* right, unless the user asks otherwise */
    desc->view.settings.as_printed = as_printed;
    desc->view.film.width = 20;
    desc->view.film.height = 15;
    assert_int_equal(bis_film_init(&film, 20, 15, desc->view.film.crop, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_scene_build(&scene, desc, &diag), BIS_OK);
    assert_int_equal(bis_render(&result, &film, scene, &desc->view, &options, NULL), BIS_OK);
    assert_int_equal(result.counters.nonfinite, 0);
    bis_film_resolve(&film, rgba);
    for (int i = 0; i < 20 * 15; i++) {
        pixels[i] = (rgb){rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]};
        sum += rgb_sum(pixels[i]);
    }
    bis_film_clear(&film);
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
    return sum;
}

static void the_scenes_of_the_errata_show_a_difference(void **state)
{
    static rgb right[20 * 15], printed[20 * 15];

    for (const bis_erratum *e = bis_errata; e->name; e++) {
        char path[64];
        double difference = 0;
        snprintf(path, sizeof path, "data/scenes/errata/%s.txt", e->name);
        double sum = render_small(path, 0, right);
        render_small(path, e->flag, printed);
        assert_true(sum > 0);
        for (int i = 0; i < 20 * 15; i++) {
            difference += fabs((double)right[i].r - (double)printed[i].r) +
                          fabs((double)right[i].g - (double)printed[i].g) +
                          fabs((double)right[i].b - (double)printed[i].b);
        }
        if (!(difference > 0.005 * sum)) fail_msg("%s: the pictures differ by %g of %g", path, difference, sum);
    }
}

/* ---- where a user says it ---- */

#define BALL \
    "\nFilm \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 6\nWorldBegin\nLightSource " \
    "\"infinite\"\nTranslate 0 0 4\n" \
    "Shape \"sphere\"\n"

static void an_option_of_the_scene_outlives_the_integrator_and_may_be_a_list(void **state)
{
    static const char *const texts[] = {
        "Option \"string asprinted\" [\"E6\" \"E21\"]\nOption \"string asprinted\" \"E3\"\nIntegrator \"sir\"" BALL,
        "Integrator \"sir\"\nOption \"string asprinted\" [\"E3\" \"E6\" \"E21\"]" BALL,
        "Option \"string asprinted\" [\"E21\" \"E6\" \"E3\" \"E3\"]\nIntegrator \"path\"" BALL,
    };

    program_folder(DIR);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        bis_diag diag = {0};
        bis_scene_desc *desc;
        program_write_file(DIR "/scene.txt", texts[i]);
        assert_int_equal(bis_scene_parse(&desc, DIR "/scene.txt", &diag), BIS_OK);
        assert_int_equal(desc->view.settings.as_printed, BIS_E3 | BIS_E6 | BIS_E21);
        bis_scene_desc_free(desc);
        bis_diag_clear(&diag);
    }
}

static void the_command_line_lists_switches_and_corrects_their_names(void **state)
{
    static program_run run;

    program_folder(DIR);
    program_write_file(DIR "/ball.txt", "Integrator \"sir\"" BALL);
    program_expect(&run, 0, "--as-printed list");
    for (const bis_erratum *e = bis_errata; e->name; e++) {
        assert_non_null(strstr(run.output, e->name));
        assert_non_null(strstr(run.output, e->section));
        assert_non_null(strstr(run.output, e->effect));
    }
    program_expect(&run, 2, "--as-printed E66 --as-printed=E77 " DIR "/ball.txt --outfile " DIR "/no.exr");
    assert_non_null(strstr(run.messages, "no erratum \"E66\" can be switched (did you mean \"E6\"?)"));
    assert_non_null(strstr(run.messages, "\"E77\""));
    assert_false(program_exists(DIR "/no.exr"));
    program_expect(&run, 0, "--as-printed E6 --as-printed E22 --plan " DIR "/ball.txt --integrator rejection");
    assert_non_null(strstr(run.output, "\nas printed   E6 (4.1, eq. 4.6): "));
    assert_non_null(strstr(run.output, "\nas printed   E22 (4.3, eq. 4.7): "));
    program_expect(&run, 0, "--as-printed E34 --plan " DIR "/ball.txt");
    assert_non_null(strstr(run.messages, "E34 as printed has no effect on integrator \"sir\""));
}

/* A wrong picture says so. */
static void the_EXR_names_the_switches_only_where_there_are_some(void **state)
{
    static program_run run;
    static char bytes[2][1 << 16];

    program_folder(DIR);
    program_write_file(DIR "/ball.txt", "Option \"string asprinted\" \"E6\"\nIntegrator \"sir\"" BALL);
    program_write_file(DIR "/right.txt", "Integrator \"sir\"" BALL);
    program_expect(&run, 0, DIR "/ball.txt --as-printed E23 --spp 1 --quiet --outfile " DIR "/0.exr");
    program_expect(&run, 0, DIR "/right.txt --spp 1 --quiet --outfile " DIR "/1.exr");
    for (int i = 0; i < 2; i++) {
        FILE *f = fopen(i ? DIR "/1.exr" : DIR "/0.exr", "rb");
        assert_non_null(f);
        size_t n = fread(bytes[i], 1, sizeof bytes[i], f);
        fclose(f);
        const char *at = memmem(bytes[i], n, "asprinted", 9);
        if (i == 1) assert_null(at);
        else {
            assert_non_null(at);
            assert_memory_equal(at, "asprinted\0string\0\6\0\0\0E6 E23", 9 + 1 + 7 + 4 + 6);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(E3_importance_without_solid_angle_makes_the_poles_too_bright),
        cmocka_unit_test(E6_one_mean_visibility_turns_coloured_shadows_grey),
        cmocka_unit_test(E13_alias_tables_from_raw_weights_do_not_draw_by_importance),
        cmocka_unit_test(E20_the_unweighted_density_takes_light_from_the_sun_and_gives_it_to_the_sky),
        cmocka_unit_test(E21_L_ns_from_other_candidates_is_biased_at_small_M),
        cmocka_unit_test(E22_drawing_until_N_are_accepted_is_too_bright),
        cmocka_unit_test(E23_weights_f_and_L_reflect_more_than_arrives),
        cmocka_unit_test(E27_the_bound_as_printed_of_the_brdfs_proposal_is_L_max_over_the_power),
        cmocka_unit_test(E27_accepting_against_f_max_does_not_accept_by_the_product),
        cmocka_unit_test(E29_the_unshadowed_fallback_lights_a_fully_hidden_point),
        cmocka_unit_test(E34_redrawing_below_the_horizon_adds_64_percent_at_85_degrees),
        cmocka_unit_test(every_switch_has_a_flag_a_paragraph_and_a_scene_of_its_own),
        cmocka_unit_test(a_switch_changes_nothing_where_it_does_not_reach),
        cmocka_unit_test(the_scenes_of_the_errata_show_a_difference),
        cmocka_unit_test(an_option_of_the_scene_outlives_the_integrator_and_may_be_a_list),
        cmocka_unit_test(the_command_line_lists_switches_and_corrects_their_names),
        cmocka_unit_test(the_EXR_names_the_switches_only_where_there_are_some),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
