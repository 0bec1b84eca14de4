/* SPDX-License-Identifier: BSD-2-Clause */
/* extending: the worked examples of docs/extending.md as they stand there, compiled, run, and judged by the tests that
 * they get for nothing. A block of code on that page which is not in this file, or in src/, fails.
 * Family-wise significance 1e-3. */
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/scene/texture.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/warp.h"
#include "bis/thesis/envmap.h"
#include "bis/base/image.h"
#include "thesis/curve_many.h"
#include "thesis/light_many.h"
#include "thesis/proposal.h"
#include "thesis/set.h"

#include "claim.h"
#include "file_help.h"
#include "lit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SEED 61u

/* 3 examples, 4 points, 3 channels; 4 integrators, 3 channels; twins are not counted */
static double alpha(void)
{
    return stat_level(1e-3, 36 + 12);
}

/* ---- a BRDF ---- */

extern const bis_bsdf_model bis_moon_model; /* tests/support/beyond/moon.c */

/* ---- an integrator ---- */

extern const bis_integrator bis_uniform;
#include "uniform.c"

/* ---- a proposal ---- */

/* n candidates uniform over the hemisphere about the normal, q = 1/(2 pi). */
static const float hemisphere_q = (float)(INV_PI / 2);

static bool draw_hemisphere(bis_guide *guide, bis_set *set, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    const bis_lanes y = set->own;

    (void)guide;
    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) {
        vec3 wi = bis_warp_sphere(bis_stream_random(stream), bis_stream_random(stream));
        if (bis_bsdf_cos(&pt->bsdf, wi) < 0) wi = neg(wi);
        y.x[i] = wi.x;
        y.y[i] = wi.y;
        y.z[i] = wi.z;
    }
    bis_light_look(pt->light, &y, set->pixel, n); /* their radiance; what only fills the last block gets 0 */
    for (uint32_t i = 0; i < n; i++) y.q[i] = hemisphere_q;
    set->map = (bis_half){y, n, 0};
    return true;
}

/* The density of such a draw, for candidates that the BRDF has drawn. Below the horizon their weight is 0, whatever it
 * is. */
static void density_of_hemisphere(bis_guide *guide, bis_set *set)
{
    (void)guide;
    for (uint32_t i = 0; i < set->brdf.n; i++) set->brdf.x.q[i] = hemisphere_q;
}

static void forget_density(bis_guide *guide, bis_set *set) { (void)guide, (void)set; }

static rgb sir_guided(
    bis_guide *guide, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    bis_scratch_share(scratch, NULL, guide);
    return bis_sir.Lo(s, pt, stream, scratch);
}

static rgb hemisphere_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    bis_guide hemisphere = {.draw = draw_hemisphere, .density = density_of_hemisphere};
    return sir_guided(&hemisphere, s, pt, stream, scratch);
}

static rgb forgetful_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    bis_guide hemisphere = {.draw = draw_hemisphere, .density = forget_density};
    return sir_guided(&hemisphere, s, pt, stream, scratch);
}

static void hemisphere_scratch_needs(const bis_settings *s, bis_needs *need) { bis_sir.scratch_needs(s, need); }

static const bis_integrator hemisphere = {.name = "hemisphere",
    .claim = "unbiased for every M, N >= 1",
    .light_needs = uniform_light_needs,
    .scratch_needs = hemisphere_scratch_needs,
    .Lo = hemisphere_Lo};
static const bis_integrator forgetful = {.name = "density forgotten",
    .claim = "wrong",
    .light_needs = uniform_light_needs,
    .scratch_needs = hemisphere_scratch_needs,
    .Lo = forgetful_Lo};

/* ---- a mapping of the light ---- */

/* Lambert's cylinder: columns are phi, rows are even in z, so that all pixels have one solid angle. */
static bis_status envmap_from_cylinder(bis_envmap *em, const bis_image *cylinder, bis_diag *diag)
{
    enum { K = 16 }; /* heights in a lat-long pixel */
    const int W = cylinder->width, H = W / 2;
    bis_image latlong;

    bis_status status = bis_image_init(&latlong, W, H, diag);
    if (status) return status;
    for (int y = 0; y < H; y++) {
        const double top = cos(PI * y / H), bottom = cos(PI * (y + 1) / H);
        for (int x = 0; x < W; x++) {
            rgb sum = {0, 0, 0};
            for (int k = 0; k < K; k++) {
                const double z = top + (bottom - top) * (k + 0.5) / K; /* uniform in solid angle */
                const int row = (int)((1 - z) / 2 * cylinder->height);
                sum = rgb_add(sum, cylinder->pixels[row * W + x]);
            }
            latlong.pixels[y * W + x] = rgb_scale(sum, 1.0 / K);
        }
    }
    return bis_envmap_from_latlong(em, &latlong, diag);
}

/* ---- what they get for nothing ---- */

static void judge(const char *name, lit *l, const bis_settings *s, rgbd truth, bool fits)
{
    stat_moments m[4];

    lit_run(m, l, s, 20000, SEED);
    if (!fits) {
        stat_assert_not_mean(name, SEED, &m[3], rgbd_sum(truth), alpha());
        return;
    }
    stat_assert_mean(name, SEED, &m[0], truth.r, alpha());
    stat_assert_mean(name, SEED, &m[1], truth.g, alpha());
    stat_assert_mean(name, SEED, &m[2], truth.b, alpha());
}

static void examples_are_unbiased_for_both_models_in_the_open_and_half_hidden(void **state)
{
    const bis_material materials[] = {bis_phong(grey(0.5), (rgb){0.4f, 0.3f, 0.2f}, 5),
                                      bis_microfacet(grey(0.5), (rgb){0.9f, 0.5f, 0.1f}, 0.8)};
    const struct { const bis_integrator *integrator; bis_proposal proposal; } examples[] = {
        {&bis_uniform, BIS_PROPOSAL_EM}, {&hemisphere, BIS_PROPOSAL_EM}, {&hemisphere, BIS_PROPOSAL_MIX}};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);

    for (int i = 0; i < 12; i++) {
        bis_settings s = bis_settings_default(&bis_sir);
        lit l;
        s.integrator = examples[i % 3].integrator;
        s.proposal = examples[i % 3].proposal;
        s.samples = s.shadowrays = 4;
        s.candidates = 16;
        lit_init(&l, light, materials[i / 3 % 2], lit_tilted(), 50, i / 6 ? LIT_OPEN : LIT_HALF);
        judge(s.integrator->name, &l, &s, lit_truth(&l, true), true);
        if (i / 3 == 1) judge("unoccluded", &l, &s, lit_truth(&l, false), false); /* twin: no shadows */
        if (i % 3 < 2) continue;
        s.integrator = &forgetful; /* twin */
        judge("density", &l, &s, lit_truth(&l, true), false);
    }
    bis_light_free(light);
}

/* Under light of 1 from everywhere: Kd/2 (1 - c log(1 + 1/c)), c = cos theta_o. The twin is Kd, of a diffuse surface.
 */
static void dust_has_the_albedo_of_lommel_and_seeliger_by_every_integrator(void **state)
{
    static const bis_integrator *const integrators[] = {&bis_brdf, &bis_mis, &bis_rejection, &bis_sir};
    const bis_material m = {.model = &bis_moon_model, .Kd = {0.8f, 0.4f, 0.1f}};
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false); /* 1, 0.5, 0.25 */
    const double c = cos(50 * PI / 180), share = 0.5 * (1 - c * log1p(1 / c));

    for (int i = 0; i < 4; i++) {
        bis_settings s = bis_settings_default(integrators[i]);
        lit l;
        lit_init(&l, light, m, lit_tilted(), 50, LIT_OPEN);
        const rgbd truth = {(double)0.8f * share, (double)0.4f / 2 * share, (double)0.1f / 4 * share};
        judge(integrators[i]->name, &l, &s, truth, true);
        if (i == 3) judge("diffuse", &l, &s, (rgbd){0.8, 0.2, 0.025}, false);
    }
    bis_light_free(light);
}

/* Float lanes against double, one by one: a dozen roundings of each. */
static void dust_is_the_same_in_vectors(void **state)
{
    enum { N = 64 };
    const bis_material m = {.model = &bis_moon_model, .Kd = {0.8f, 0.4f, 0}};
    float memory[(BIS_LANES_ARRAYS + 7) * N], *at = memory + BIS_LANES_ARRAYS * N, *u1 = at + 5 * N, *u2 = at + 6 * N;
    const bis_lanes y = bis_lanes_in(memory, N);
    const bis_reflected f = {at, at + N, at + 2 * N, at + 3 * N, at + 4 * N};
    bis_bsdf b;

    bis_bsdf_init(&b, &m, lit_tilted(), normalize(vec3_from(0.1, 0.5, 0.8)));
    bis_curve_points(u1, u2, N, SEED);
    bis_bsdf_sample_many(&y, &b, u1, u2, N);
    const double unit = bis_bsdf_f_many(&f, &b, &y, N);
    for (int i = 0; i < N; i++) {
        const vec3 wi = {y.x[i], y.y[i], y.z[i]};
        vec3 same;
        double q;
        const rgb one = bis_bsdf_f_pdf(&b, wi, &q);
        assert_true(bis_bsdf_draw(&b, (double[]){(double)u1[i], (double)u2[i]}, &same) && length(sub(wi, same)) < 1e-6);
        assert_true(fabs((double)f.r[i] * unit / (double)one.r - 1) < 0x1p-20);
        assert_true(fabs((double)f.g[i] * unit / (double)one.g - 1) < 0x1p-20);
        assert_true(fabs((double)f.q[i] - q) < 0x1p-21 && fabs((double)f.cos[i] - bis_bsdf_cos(&b, wi)) < 0x1p-21);
    }
}

static void cylinder_keeps_its_light_where_it_is(void **state)
{
    bis_image cylinder;
    bis_envmap em;

    assert_int_equal(bis_image_init(&cylinder, 64, 128, NULL), BIS_OK);
    for (int i = 0; i < 64 * 128; i++)
        cylinder.pixels[i] = i / 64 < 32 ? (rgb){2, 1, 0} : (rgb){0, 1, i % 64 < 16 ? 4 : 0};
    assert_int_equal(envmap_from_cylinder(&em, &cylinder, NULL), BIS_OK);
    /* red: z > 1/2, a quarter of the sphere; blue: a quarter of the other three quarters */
    assert_true(fabs(bis_envmap_power(&em) / (4 * PI) - (2 * 0.25 + 1 + 4 * 0.75 / 4)) < 1e-2);
    assert_true(bis_envmap_Le(&em, normalize((vec3){1, 1, 2})).r == 2);
    assert_true(bis_envmap_Le(&em, normalize((vec3){1, 1, 0.5f})).b == 4);
    assert_true(bis_envmap_Le(&em, normalize((vec3){-1, 1, 0.5f})).b == 0);
    bis_image_clear(&cylinder);
    bis_envmap_clear(&em);
}

/* Is every ```c block of the page a piece of one of these files? Returns how many there are. */
static int blocks_found(const char *page, bool expected)
{
    static const char *const sources[] = {"tests/whole/test_extending.c", "tests/whole/uniform.c",
        "tests/support/beyond/moon.c", "tests/support/beyond/moon_many.c", "tests/support/beyond/moon_formulas.h",
        "src/scene/parameters.c", "tests/beyond/test_microfacet.c", "include/bis/thesis/bsdf.h"};
    int n = 0;

    for (const char *at = strstr(page, "```c\n"); at; at = strstr(at, "```c\n")) {
        const char *begin = at + 5, *end = strstr(begin, "```");
        bool found = false;
        assert_non_null(end);
        char *block = strndup(begin, (size_t)(end - begin));
        for (size_t i = 0; i < sizeof sources / sizeof *sources; i++) {
            char *text = read_whole(sources[i]);
            found |= strstr(text, block) != NULL;
            bis_free(text);
        }
        if (found != expected) fail_msg("block %d of docs/extending.md: %.60s", n + 1, block);
        free(block);
        at = end + 3;
        n++;
    }
    return n;
}

static void every_block_of_the_page_is_code_that_was_compiled(void **state)
{
    char *page = read_whole("docs/extending.md");
    assert_true(blocks_found(page, true) >= 5);
    bis_free(page);
    assert_int_equal(blocks_found("```c\nint never_written;\n```\n", false), 1); /* twin */
}

/* The page's integrator, put where the page says, into a copy of the sources: compiled, linked, asked for by every
 * command. */
static void the_integrator_of_the_page_becomes_one_of_ours(void **state)
{
    if (!getenv("BIS_COMPILE")) {
        print_message("run by make test, which tells how to compile\n");
        skip();
    }
    /* those that ask for every integrator and take less than 7 s; all programs take as long as make test */
    const char *tests = getenv("BIS_LONG")
                            ? "all"
                            : "test_help test_verify test_parameters test_errata test_layers test_render "
                              "test_verify_view test_options test_expect test_parser test_scene test_flat";
    char command[256];
    snprintf(command, sizeof command, "sh scripts/check/check_extending.sh %s", tests);
    assert_int_equal(system(command), 0);
    /* the twin: a page that has lost a line */
    assert_int_equal(system("grep -v '^+.*readers.*bis_uniform' docs/extending.md >\"$BIS_BUILD/extending.md\" && "
                            "! EXTENDING_PAGE=\"$BIS_BUILD/extending.md\" sh scripts/check/check_extending.sh "
                            ">/dev/null 2>&1"), 0);
}

/* The page's BRDF is part of that check; its twin: a `remake` that forgets the exponent. */
static void a_brdf_whose_remake_forgets_a_number_is_found(void **state)
{
    if (!getenv("BIS_COMPILE")) skip();
    assert_int_equal(
        system("! EXTENDING_EDIT='s,exponent ? \\*exponent : m->exponent,&/2,' sh scripts/check/check_extending.sh "
               ">\"$BIS_BUILD/extending.txt\" 2>&1 && grep -q 'loses something' \"$BIS_BUILD/extending.txt\""),
        0);
}

/* A number of bis_material that bis_material_numbers does not list would be lost to checkpoints, --plan and bis verify.
 */
static void every_number_of_a_material_is_listed(void **state)
{
    const size_t word = sizeof(float), end = offsetof(bis_material, eta) + sizeof(rgb);
    assert_true(offsetof(bis_material, model) == 0 &&
                (sizeof(bis_material) - end) < _Alignof(bis_material)); /* eta is the last field */
    for (size_t at = sizeof(bis_bsdf_model *); at < end; at += word) {
        bis_material m = bis_phong(grey(0.5), grey(0.25), 8);
        double before[BIS_MATERIAL_NUMBERS], after[BIS_MATERIAL_NUMBERS];
        bis_material_numbers(before, &m);
        ((unsigned char *)&m)[at + word - 2] ^=
            0x40; /* of a float or the upper half of a double; of a lower half a digit */
        bis_material_numbers(after, &m);
        if (memcmp(before, after, sizeof before) == 0)
            fail_msg("byte %zu of bis_material is no number of bis_material_numbers", at);
    }
}

/* What has no `remake` must be told, because a picture without the texture would look like one with it. */
static void a_texture_of_a_model_without_remake_is_an_error(void **state)
{
    bis_bsdf_model model = bis_phong_model;
    bis_texture white = {.kind = BIS_TEXTURE_CONSTANT, .value = {0.5, 0.5, 0.5}};
    const bis_textures t = {.list = &white, .n = 1};
    const bis_material_textures of = {
        0, BIS_NO_TEXTURE, BIS_NO_TEXTURE, 1, {"s.txt", 1, 1}, BIS_NO_TEXTURE, BIS_NO_TEXTURE};
    bis_material m = bis_phong(grey(0.5), grey(0.25), 8);
    bis_diag diag = {0};
    m.model = &model;
    assert_int_equal(bis_textures_check(&t, NULL, &of, &m, &diag), BIS_OK); /* the twin */
    model.remake = NULL;
    assert_int_equal(bis_textures_check(&t, NULL, &of, &m, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "has no `remake`"));
    bis_diag_clear(&diag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(examples_are_unbiased_for_both_models_in_the_open_and_half_hidden),
        cmocka_unit_test(dust_has_the_albedo_of_lommel_and_seeliger_by_every_integrator),
        cmocka_unit_test(dust_is_the_same_in_vectors),
        cmocka_unit_test(cylinder_keeps_its_light_where_it_is),
        cmocka_unit_test(every_block_of_the_page_is_code_that_was_compiled),
        cmocka_unit_test(the_integrator_of_the_page_becomes_one_of_ours),
        cmocka_unit_test(a_brdf_whose_remake_forgets_a_number_is_found),
        cmocka_unit_test(every_number_of_a_material_is_listed),
        cmocka_unit_test(a_texture_of_a_model_without_remake_is_an_error),
    };

    return cmocka_run_group_tests_name("extending", tests, NULL, NULL);
}
