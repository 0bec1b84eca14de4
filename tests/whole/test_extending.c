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
#include "thesis/candidates.h"
#include "thesis/proposal.h"

#include "lit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SEED 61u

/* 2 integrators, 4 points, 3 channels; 2 twins */
static double alpha(void)
{
    return stat_level(1e-3, 24);
}

static vec3 tilted(void)
{
    return normalize(vec3_from(0.2, -0.3, 0.8));
}

/* ---- an integrator ---- */

extern const bis_integrator bis_uniform;
#include "uniform.c"

/* ---- a proposal ---- */

/* M candidates uniform over the hemisphere about n, q = 1/(2 pi). */
static double candidates_from_hemisphere(bis_candidate *c, uint32_t M, const bis_point *pt, bis_stream *stream)
{
    const double q = 1 / (2 * PI);
    double W = 0;

    for (uint32_t i = 0; i < M; i++) {
        c[i] = (bis_candidate){.w = 0};
        vec3 wi = bis_warp_sphere(bis_stream_random(stream), bis_stream_random(stream));
        if (bis_bsdf_cos(&pt->bsdf, wi) < 0) wi = neg(wi);
        double cos_theta = bis_bsdf_cos(&pt->bsdf, wi);
        if (cos_theta <= 0) continue;
        c[i].wi = wi;
        c[i].C = bis_estimate(bis_bsdf_f(&pt->bsdf, wi), bis_light_Le(pt->light, wi), cos_theta, q);
        c[i].w = rgbd_sum(c[i].C);
        W += c[i].w;
    }
    return W;
}

static void hemisphere_scratch_needs(const bis_settings *s, bis_needs *need)
{
    need->n_candidates = s->candidates;
    need->n_chosen = s->shadowrays;
}

static rgb hemisphere_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    const uint32_t M = s->candidates, N = s->shadowrays;
    double W = candidates_from_hemisphere(scratch->candidates, M, pt, stream);

    if (W <= 0) return (rgb){0, 0, 0};
    bis_candidates_resample(scratch->chosen, N, scratch->candidates, M, W, s->resampling, stream);
    return rgbd_round(bis_candidates_trace(pt, scratch->candidates, scratch->chosen, N, W / M / N));
}

static const bis_integrator hemisphere = {.name = "hemisphere", .claim = "unbiased for every M, N >= 1",
                                          .light_needs = uniform_light_needs, .scratch_needs = hemisphere_scratch_needs, .Lo = hemisphere_Lo};

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
    const bis_integrator *examples[] = {&bis_uniform, &hemisphere};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);

    (void)state;
    for (int i = 0; i < 8; i++) {
        bis_settings s = bis_settings_default(&bis_sir);
        lit l;
        s.integrator = examples[i % 2];
        s.samples = s.shadowrays = 4;
        s.candidates = 16;
        lit_init(&l, light, materials[i / 2 % 2], tilted(), 50, i / 4 ? LIT_OPEN : LIT_HALF);
        judge(s.integrator->name, &l, &s, lit_truth(&l, true), true);
        if (i / 4 == 0 && i / 2 % 2) judge("unoccluded", &l, &s, lit_truth(&l, false), false); /* twin: no shadows */
    }
    bis_light_free(light);
}

static void cylinder_keeps_its_light_where_it_is(void **state)
{
    bis_image cylinder;
    bis_envmap em;

    (void)state;
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

/* ---- the page ---- */

static char *read_text(const char *path)
{
    FILE *f = fopen(path, "rb");
    char *text = calloc(1, 1 << 18);

    assert_non_null(f);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 18) - 1, f) < (1 << 18) - 1);
    fclose(f);
    return text;
}

/* Is every ```c block of the page a piece of one of these files? Returns how many there are. */
static int blocks_found(const char *page, bool expected)
{
    static const char *const sources[] = {"tests/whole/test_extending.c", "tests/whole/uniform.c", "src/beyond/microfacet.c", "src/parse/parser_world.c", "src/thesis/settings.c",
                                          "tests/beyond/test_microfacet.c", "include/bis/thesis/bsdf.h"};
    int n = 0;

    for (const char *at = strstr(page, "```c\n"); at; at = strstr(at, "```c\n")) {
        const char *begin = at + 5, *end = strstr(begin, "```");
        bool found = false;
        assert_non_null(end);
        char *block = strndup(begin, (size_t)(end - begin));
        for (size_t i = 0; i < sizeof sources / sizeof *sources; i++) {
            char *text = read_text(sources[i]);
            found |= strstr(text, block) != NULL;
            free(text);
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
    (void)state;
    char *page = read_text("docs/extending.md");
    assert_true(blocks_found(page, true) >= 5);
    free(page);
    assert_int_equal(blocks_found("```c\nint never_written;\n```\n", false), 1); /* twin */
}

/* The page's integrator, put where the page says, into a copy of the sources: compiled, linked, asked for by every command. */
static void the_integrator_of_the_page_becomes_one_of_ours(void **state)
{
    (void)state;
    if (!getenv("BIS_COMPILE")) {
        print_message("run by make test, which tells how to compile\n");
        skip();
    }
    /* those that ask for every integrator and take less than 7 s; all programs take as long as make test */
    const char *tests = getenv("BIS_LONG") ? "all" : "test_help test_verify test_settings test_bytes test_errata test_layers test_render "
                                                     "test_verify_view test_survey test_options test_parser test_scene test_flat";
    char command[256];
    snprintf(command, sizeof command, "sh scripts/check/check_extending.sh %s", tests);
    assert_int_equal(system(command), 0);
    /* the twin: a page that has lost a line */
    assert_int_equal(system("grep -v '^+.*readers.*bis_uniform' docs/extending.md >\"$BIS_BUILD/extending.md\" && "
                            "! EXTENDING_PAGE=\"$BIS_BUILD/extending.md\" sh scripts/check/check_extending.sh >/dev/null 2>&1"), 0);
}

/* The page's BRDF is part of that check; its twin: a `remake` that forgets the exponent. */
static void a_brdf_whose_remake_forgets_a_number_is_found(void **state)
{
    (void)state;
    if (!getenv("BIS_COMPILE")) skip();
    assert_int_equal(system("! EXTENDING_EDIT='s,exponent ? \\*exponent : m->exponent,&/2,' sh scripts/check/check_extending.sh "
                            ">\"$BIS_BUILD/extending.txt\" 2>&1 && grep -q 'loses something' \"$BIS_BUILD/extending.txt\""), 0);
}

/* A number of bis_material that bis_material_numbers does not list would be lost to checkpoints, --plan and bis verify. */
static void every_number_of_a_material_is_listed(void **state)
{
    (void)state;
    const size_t word = sizeof(float), end = offsetof(bis_material, eta) + sizeof(rgb);
    assert_true(offsetof(bis_material, model) == 0 && (sizeof(bis_material) - end) < _Alignof(bis_material)); /* eta is the last field */
    for (size_t at = sizeof(bis_bsdf_model *); at < end; at += word) {
        bis_material m = bis_phong(grey(0.5), grey(0.25), 8);
        double before[BIS_MATERIAL_NUMBERS], after[BIS_MATERIAL_NUMBERS];
        bis_material_numbers(before, &m);
        ((unsigned char *)&m)[at + word - 2] ^= 0x40; /* of a float or the upper half of a double; of a lower half a digit */
        bis_material_numbers(after, &m);
        if (memcmp(before, after, sizeof before) == 0) fail_msg("byte %zu of bis_material is no number of bis_material_numbers", at);
    }
}

/* What has no `remake` must be told, because a picture without the texture would look like one with it. */
static void a_texture_of_a_model_without_remake_is_an_error(void **state)
{
    (void)state;
    bis_bsdf_model model = bis_phong_model;
    bis_texture white = {.kind = BIS_TEXTURE_CONSTANT, .value = {0.5, 0.5, 0.5}};
    const bis_textures t = {.list = &white, .n = 1};
    const bis_material_textures of = {0, BIS_NO_TEXTURE, BIS_NO_TEXTURE, 1, {"s.txt", 1, 1}};
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
        cmocka_unit_test(cylinder_keeps_its_light_where_it_is),
        cmocka_unit_test(every_block_of_the_page_is_code_that_was_compiled),
        cmocka_unit_test(the_integrator_of_the_page_becomes_one_of_ours),
        cmocka_unit_test(a_brdf_whose_remake_forgets_a_number_is_found),
        cmocka_unit_test(every_number_of_a_material_is_listed),
        cmocka_unit_test(a_texture_of_a_model_without_remake_is_an_error),
    };

    return cmocka_run_group_tests_name("extending", tests, NULL, NULL);
}
