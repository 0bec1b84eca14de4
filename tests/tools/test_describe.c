/* SPDX-License-Identifier: BSD-2-Clause */
/* What is told of a render, by hand: lines of Integrators, header attributes, the JSON of --stats, and the plans of
 * scenes from their first line to their last (tests/data/expect/describe). */
#include "tools/describe.h"

#include "bis/base/mem.h"
#include "bis/base/version.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "expect.h"
#include "json_check.h"
#include "program.h"
#include "threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_describe"

/* ---- settings ---- */

static bis_settings settings(const bis_integrator *integrator, uint32_t M, uint32_t N)
{
    bis_settings s = bis_settings_default(integrator);
    s.candidates = M;
    s.samples = s.shadowrays = N;
    return s;
}

static void a_line_names_every_parameter_and_its_type(void **state)
{
    bis_settings s = {.samples = 7, .candidates = 33, .shadowrays = 5, .perpatch = 9, .proposal = BIS_PROPOSAL_BRDF,
                      .heuristic = BIS_HEURISTIC_POWER, .resampling = BIS_RESAMPLING_MULTINOMIAL,
                          .estimator = BIS_ESTIMATOR_PLAIN,
                      .fallback = BIS_FALLBACK_SUBSET, .split = 0.25, .compensate = true, .learn = true};
    bis_settings other = {.samples = 1, .candidates = 2, .shadowrays = 3, .perpatch = 4,
        .proposal = BIS_PROPOSAL_PRODUCT,
                          .heuristic = BIS_HEURISTIC_BALANCE, .resampling = BIS_RESAMPLING_SYSTEMATIC,
                              .estimator = BIS_ESTIMATOR_RATIO,
                          .fallback = BIS_FALLBACK_RESAMPLE, .split = 0.75, .stratify = true};
    const struct { const bis_integrator *integrator; int n; const char *line, *other; } cases[] = {
        {&bis_em, 2, "Integrator \"em\" \"integer samples\" 7 \"bool stratify\" false",
         "Integrator \"em\" \"integer samples\" 1 \"bool stratify\" true"},
        {&bis_brdf, 1, "Integrator \"brdf\" \"integer samples\" 7", "Integrator \"brdf\" \"integer samples\" 1"},
        {&bis_mis, 5, "Integrator \"mis\" \"integer samples\" 7 \"string heuristic\" \"power\" \"float split\" 0.25 "
         "\"bool compensate\" true \"bool stratify\" false",
         "Integrator \"mis\" \"integer samples\" 1 \"string heuristic\" \"balance\" \"float split\" 0.75 \"bool "
         "compensate\" false \"bool stratify\" true"},
        {&bis_rejection, 5, "Integrator \"rejection\" \"integer candidates\" 33 \"integer shadowrays\" 5 \"string "
         "proposal\" \"brdf\" \"string estimator\" \"plain\" \"string fallback\" \"subset\"",
         "Integrator \"rejection\" \"integer candidates\" 2 \"integer shadowrays\" 3 \"string proposal\" \"product\" "
         "\"string estimator\" \"ratio\" \"string fallback\" \"resample\""},
        {&bis_sir, 6, "Integrator \"sir\" \"integer candidates\" 33 \"integer shadowrays\" 5 \"string proposal\" "
         "\"brdf\" \"string resampling\" \"multinomial\" \"bool stratify\" false \"bool learn\" true",
         "Integrator \"sir\" \"integer candidates\" 2 \"integer shadowrays\" 3 \"string proposal\" \"product\" "
         "\"string resampling\" \"systematic\" \"bool stratify\" true \"bool learn\" false"},
        {&bis_exact, 1, "Integrator \"exact\" \"integer perpatch\" 9", "Integrator \"exact\" \"integer perpatch\" 4"},
        {&bis_unoccluded, 1, "Integrator \"unoccluded\" \"integer candidates\" 33",
         "Integrator \"unoccluded\" \"integer candidates\" 2"},
    };
    static const char *const names[] = {"samples", "candidates", "shadowrays", "perpatch", "proposal", "heuristic",
        "resampling", "estimator", "fallback", "split", "compensate", "stratify", "learn", "candidate", ""};
    char line[BIS_MAX_LINE];
    bis_attribute parameters[BIS_MAX_PARAMETERS];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        s.integrator = other.integrator = cases[i].integrator;
        assert_string_equal(bis_describe_line(line, &s, true), cases[i].line);
        assert_string_equal(bis_describe_line(line, &other, true), cases[i].other);
        assert_int_equal(bis_describe_settings(&s, parameters), cases[i].n);
        for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
            char word[32];
            snprintf(word, sizeof word, " %s\" ", names[k]);
            assert_true(
                (bis_parameter_of(cases[i].integrator, names[k]) != NULL) == (strstr(cases[i].line, word) != NULL));
        }
    }
    s.integrator = &bis_rejection;
    s.fallback = BIS_FALLBACK_UNOCCLUDED;
    assert_non_null(strstr(bis_describe_line(line, &s, true), "\"string fallback\" \"unoccluded\""));
}

/* Counts always; of the rest what is not the default of this integrator. */
static void a_short_line_leaves_out_what_has_its_default(void **state)
{
    char line[BIS_MAX_LINE];
    bis_settings s = settings(&bis_sir, 800, 15);
    assert_string_equal(
        bis_describe_line(line, &s, false), "Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 15");
    s.stratify = false;
    s.proposal = BIS_PROPOSAL_PRODUCT;
    assert_string_equal(bis_describe_line(line, &s, false),
                        "Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 15 \"string proposal\" "
                        "\"product\" \"bool stratify\" false");
    s = settings(&bis_mis, 0, 6);
    assert_string_equal(bis_describe_line(line, &s, false), "Integrator \"mis\" \"integer samples\" 6");
    s.stratify = true; /* here it is the other way round */
    s.split = 0.25;
    assert_string_equal(bis_describe_line(line, &s, false),
        "Integrator \"mis\" \"integer samples\" 6 \"float split\" 0.25 \"bool stratify\" true");
}

/* ---- figures about the run ---- */

static bis_scene_desc small_scene(void)
{
    return (bis_scene_desc){.path = (char *)(uintptr_t)"a/scene.txt", .view.settings = settings(&bis_em, 0, 8)};
}

static char *stats_of(const bis_stats *s)
{
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    bis_stats_print(s, out);
    fclose(out);
    assert_true(json_is_valid(text));
    return text;
}

/* name=text or name=number, with blanks between. */
static const char *join(char *buf, size_t size, const bis_attribute *a, int n)
{
    size_t used = 0;
    for (int i = 0; i < n; i++) {
        if (a[i].text) used += (size_t)snprintf(buf + used, size - used, "%s=%s ", a[i].name, a[i].text);
        else used += (size_t)snprintf(buf + used, size - used, "%s=%g ", a[i].name, a[i].number);
    }
    return buf;
}

static void a_pictures_attributes_are_those_by_hand(void **state)
{
    bis_attribute attributes[BIS_MAX_ATTRIBUTES];
    char text[1024];
    bis_scene_desc desc = small_scene();
    bis_render_result result = {.seconds = 5.5, .error = {.relative_rmse = (double)NAN}, .spp = 12};
    desc.view.sampler.seed = 34;
    desc.view.edge_samples = 1;
    bis_film film;
    assert_int_equal(bis_film_init(&film, 2, 1, (double[]){0, 1, 0, 1}, (bis_loc){0}, NULL), BIS_OK);
    bis_stats s = {.desc = &desc, .film = &film, .result = &result, .line = "all"};
    int n = bis_describe_picture(&s, attributes);
    assert_string_equal(join(text, sizeof text, attributes, n),
                        "scene=a/scene.txt integrator=em samples=8 stratify=false spp=12 seed=34 render_seconds=5.5 "
                        "bis:version=" BIS_VERSION " ");
    /* a share of light samples is told where it is one, and where pixels on edges have more than one sample */
    static const struct { uint32_t samples; double light; const char *told; } edges[] = {
        {0, 0.25, ""}, {1, 0.25, ""}, {2, 0, "edgesamples=2 "}, {2, 1, "edgesamples=2 "}, {2, 2, "edgesamples=2 "},
        {2, 0.5, "edgesamples=2 edgelight=0.5 "}, {3, 0x1p-20, "edgesamples=3 edgelight=9.53674e-07 "}};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        char told[256];
        desc.view.edge_samples = edges[i].samples;
        desc.view.edge_light = edges[i].light;
        n = bis_describe_picture(&s, attributes);
        snprintf(told, sizeof told, " stratify=false %sspp=12 ", edges[i].told);
        assert_non_null(strstr(join(text, sizeof text, attributes, n), told));
    }
    result.error.relative_rmse = 0.25;
    result.error.is_known = result.error.has_upper = true;
    result.error.upper = 0.5;
    desc.view.edge_samples = 2;
    desc.view.edge_light = 0.25;
    snprintf(s.as_printed, sizeof s.as_printed, "E6 E20");
    bis_film_add(&film, 0, 0, (rgb){-1, 1, 0}, 1, 1); /* 1 of 8 is below 0 */
    bis_film_add(&film, 1, 0, (rgb){2, 2, 2}, 1, 1);
    n = bis_describe_picture(&s, attributes);
    assert_string_equal(join(text, sizeof text, attributes, n),
                        "scene=a/scene.txt integrator=em samples=8 stratify=false asprinted=E6 E20 edgesamples=2 "
                        "edgelight=0.25 "
                        "spp=12 seed=34 render_seconds=5.5 estimated_relative_rmse=0.25 relative_rmse_at_most=0.5 "
                        "bis:raised=0.125 "
                        "bis:version=" BIS_VERSION " ");
    bis_film_clear(&film);
}

/* What a scene with shapes, replaced parts and missing samples says beside that, number by number; the seconds of the
 * render are the result's. */
static void what_a_scene_has_stands_under_its_key(void **state)
{
    static const struct { const char *path, *value; } told[] = {
        {"accelerator", "\"grid\""}, {"triangles", "12"}, {"width", "2"}, {"height", "1"}, {"extent.low.0", "1"},
        {"extent.low.1", "2"}, {"extent.low.2", "3"}, {"extent.high.0", "4"}, {"extent.high.1", "5"},
        {"extent.high.2", "6"}, {"memory.mesh", "100"}, {"memory.accel", "200"}, {"memory.envmap", "300"},
        {"seconds.parse", "1"}, {"seconds.load", "2"}, {"seconds.envmap", "3"}, {"seconds.accel", "4"},
        {"seconds.render", "5"}, {"seconds.write", "6"}, {"seconds.total", "7"}, {"candidates_drawn", "103"},
        {"accepted", "null"}, {"fallbacks", "null"}, {"samples", "8"}, {"candidates", "null"}, {"proposal", "null"},
        {"approximated.0.kind", "\"cone\""}, {"approximated.0.count", "3"}, {"approximated.0.consequence", "\"none\""},
        {"approximated.1.kind", "\"hair\""}, {"approximated.1.count", "1"}, {"approximated.2.kind", ""},
        {"estimated_relative_rmse", "null"}, {"relative_rmse_at_most", "0.75"}, {"interrupted", "false"},
        {"missing", "0.25"}};
    bis_approximation replaced[] = {{.kind = "cone", .consequence = "none", .effect = BIS_EFFECT_SHAPE, .n = 3},
                                    {.kind = "hair", .consequence = "skin", .effect = BIS_EFFECT_MATERIAL, .n = 1}};
    bis_attribute attributes[BIS_MAX_ATTRIBUTES];
    bis_scene_desc desc = small_scene();
    const bis_scene_figures figures = {12, "grid", 100, 200, 300};
    const bis_render_result result = {.counters = {101, 102, 103, 104, 105, 0}, .seconds = 5, .missing = 0.25,
        .error = {.relative_rmse = 0.5, .upper = 0.75, .has_upper = true}, .spp = 12, .n_threads = 1};
    const bis_box extent = {{1, 2, 3}, {4, 5, 6}};
    char value[256], all[1024];
    bis_film film;
    desc.approximations = replaced;
    desc.n_approximations = 2;
    desc.view.settings.as_printed = BIS_E34;
    assert_int_equal(bis_film_init(&film, 2, 1, (double[]){0, 1, 0, 1}, (bis_loc){0}, NULL), BIS_OK);
    bis_stats s = bis_stats_of(&desc, figures, (bis_scene_seconds){1, 2, 3, 4, 99, 6, 7}, &film, &result);
    s.extent = &extent;
    assert_string_equal(s.line, "Integrator \"em\" \"integer samples\" 8 \"bool stratify\" false");
    assert_string_equal(s.as_printed, "E34");
    assert_string_equal(s.approximated, "3 x cone: none; 1 x hair: skin");
    char *text = stats_of(&s);
    for (size_t i = 0; i < sizeof told / sizeof *told; i++)
        if (strcmp(json_value(value, sizeof value, text, told[i].path), told[i].value) != 0)
            fail_msg("%s is %s, must be %s", told[i].path, value, told[i].value);
    free(text);
    const int n = bis_describe_picture(&s, attributes);
    assert_string_equal(join(all, sizeof all, attributes, n),
        "scene=a/scene.txt integrator=em samples=8 stratify=false asprinted=E34 bis:approximated=3 x cone: none; 1 x "
        "hair: skin spp=12 bis:missing=0.25 seed=0 render_seconds=5 relative_rmse_at_most=0.75 "
                        "bis:version=" BIS_VERSION " ");
    bis_film_clear(&film);

    /* of parts that were put together the text alone is known */
    desc.n_approximations = 0;
    text = stats_of(&s);
    assert_string_equal(json_value(value, sizeof value, text, "approximated"), "\"3 x cone: none; 1 x hair: skin\"");
    free(text);
}

/* ---- the plan ---- */

/* `plan` of the input as a scene. */
static int plan(const expect_command *c)
{
    bis_scene_desc *desc = NULL;
    bis_diag diag = {0};
    program_write_file(DIR "/scene.txt", c->input);
    if (bis_scene_parse(&desc, DIR "/scene.txt", &diag)) fail_msg("%s", diag.messages[0].text);
    bis_scene_plan(desc, c->output);
    bis_scene_desc_free(desc);
    bis_diag_clear(&diag);
    return 0;
}

/* A map or mesh whose header tells nothing: the size of the file. */
static void a_file_that_tells_nothing_has_its_bytes(void **state)
{
    static char text[2500001];
    bis_scene_desc *desc = NULL;
    char *plan = NULL;
    size_t n;
    memset(text, '#', sizeof text - 1);
    program_write_file(DIR "/strange.hdr", text);
    program_write_file(DIR "/strange.obj", text);
    program_write_file(DIR "/scene.txt", "WorldBegin LightSource \"infinite\" \"string filename\" \"strange.hdr\"\n"
                       "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"strange.hdr\"\n"
                       "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"objmesh\" "
                       "\"string filename\" \"strange.obj\"\n");
    assert_int_equal(bis_scene_parse(&desc, DIR "/scene.txt", NULL), BIS_OK);
    FILE *out = open_memstream(&plan, &n);
    bis_scene_plan(desc, out);
    fclose(out);
    if (!strstr(plan, "\nlight        map " DIR "/strange.hdr, latlong, a file of 2.5 MB\n") ||
        !strstr(plan, "\nbuild        light curve, one CDF along a space-filling curve\n") ||
        !strstr(plan, "\nbuild        texture " DIR "/strange.hdr, a file of 2.5 MB\n") ||
        !strstr(plan, "\nbuild        mesh " DIR "/strange.obj, a file of 2.5 MB, read once for 1 shape\n"))
        fail_msg("%s", plan);
    free(plan);
    bis_scene_desc_free(desc);
}

/* 2048 x 1024 pixels, each of 16 bytes to draw from. */
static void distant_lights_are_planned_as_a_map(void **state)
{
    bis_scene_desc *desc = NULL;
    char *plan = NULL;
    size_t n;
    program_write_file(DIR "/scene.txt",
                       "WorldBegin LightSource \"distant\" LightSource \"distant\" Shape \"sphere\"");
    assert_int_equal(bis_scene_parse_as(&desc, DIR "/scene.txt", BIS_PARSE_APPROXIMATE, NULL), BIS_OK);
    FILE *out = open_memstream(&plan, &n);
    bis_scene_plan(desc, out);
    fclose(out);
    if (!strstr(plan, "\nlight        constant\nlight        and 2 distant, as discs in a map of 2048 x 1024\n") ||
        !strstr(plan, "\nbuild        light curve, one CDF along a space-filling curve: at most 33.6 MB\n"))
        fail_msg("%s", plan);
    free(plan);
    bis_scene_desc_free(desc);
}

int main(void)
{
    use_threads(1); /* each has a chunk of the EXR in memory, which the plans by hand count */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_names_every_parameter_and_its_type),
        cmocka_unit_test(a_short_line_leaves_out_what_has_its_default),
        cmocka_unit_test(a_pictures_attributes_are_those_by_hand),
        cmocka_unit_test(what_a_scene_has_stands_under_its_key),
        cmocka_unit_test(distant_lights_are_planned_as_a_map),
        cmocka_unit_test(a_file_that_tells_nothing_has_its_bytes),
    };
    program_folder(DIR);
    program_write_scene(DIR, ""); /* for its map.pfm of 8 x 4 */
    program_write_file(DIR "/t.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n1 0 1\n0 1 1\n3 0 1 2\n");
    program_write_file(DIR "/unused.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    program_write_file(DIR "/probe.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3000 +X 3000\n");
    const bis_erratum *e6 = bis_erratum_find("E6");
    const expect_word words[] = {{"plan", plan}, {NULL, NULL}};
    const expect_text texts[] = {
        {"claim of mis", bis_mis.claim},
        {"claim of em", bis_em.claim},
        {"claim of rejection", bis_rejection.claim},
        {"claim of exact", bis_exact.claim},
        {"section of E6", e6->section},
        {"effect of E6", e6->effect},
        {"accelerator", bis_accel_embree_version() ? "embree" : "grid, default density"},
        {NULL, NULL},
    };
    return expect_run("describe", tests, sizeof tests / sizeof *tests, NULL, NULL,
                      &(expect_folder){"tests/data/expect/describe", words, texts});
}
