/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify` of pictures: those of the renderer pass, wrong ones are rejected. */
#include "render/edges.h"
#include "tools/verify/verify.h"
#include "bis/base/mem.h"
#include "claim.h"
#include "map_help.h"
#include "mesh_help.h"
#include "program.h"
#include "verify_help.h"

#include <stdatomic.h>
#include <string.h>

/* Two renders, of five sums each: all pixels, three of outlines, the material. */
enum { SEEDS = 2, SUMS = 5 };

/* What the renderer does at most: product, learned visibility, edge samples. */
static const char full[] = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 24\n"
                           "Sampler \"sobol\" \"integer pixelsamples\" 16 \"integer edgesamples\" 4\n"
                           "Integrator \"sir\" \"string proposal\" \"product\" \"integer candidates\" 64 \"integer "
                           "shadowrays\" 16 "
                           "\"bool learn\" true\n";

/* It hides the zenith: what visibility learns depends on the direction. */
static const char roof[] =
    "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-2 1.5 1  2 1.5 1  2 1.5 7  -2 1.5 7]\n";

static verify_built build_full(void)
{
    verify_write_map();
    char text[2048];
    snprintf(text, sizeof text, "%s%s%s", full, program_world, roof);
    program_write_file(VERIFY_DIR "/full.txt", text);
    return verify_build(VERIFY_DIR "/full.txt");
}

/* Failed tests of the picture whose names begin so; all: "". */
static size_t failed_of_picture(
    bis_verify_render *render, const verify_built *b, const bis_settings *s, uint64_t seed, const char *name)
{
    bis_verify v = {.seed = seed, .halvings = 2};
    bool tested;
    size_t n = 0;
    assert_int_equal(bis_verify_picture(&v, render, b->scene, s, &tested, NULL), BIS_OK);
    assert_true(tested);
    assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
    for (size_t i = 0; i < v.n; i++)
        n += v.tests[i].verdict == BIS_VERDICT_FAILED && strncmp(v.tests[i].name, name, strlen(name)) == 0;
    bis_verify_clear(&v);
    return n;
}

static void a_right_picture_passes(void **state)
{
    verify_built b = build_full();
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        bis_verify v = {.seed = seed, .halvings = 2};
        bool tested;
        assert_int_equal(
            bis_verify_picture(&v, bis_render, b.scene, &b.desc->view.settings, &tested, NULL), BIS_OK);
        assert_true(tested);
        assert_int_equal(v.n, SUMS + 1); /* and no number that is none */
        assert_int_equal(verify_judged(&v), SUMS);
        verify_assert_accepted(&v);
    }
    verify_clear(&b);
}

/* Whether a few renders outweigh all others is a matter of chance. Whether there is any light, the scene decides. */
static void what_is_skipped_by_chance_counts_among_the_p_values(void **state)
{
    bis_verify v = {.seed = 1};
    bis_verify_p(bis_verify_new(&v, "picture", "one"), 1, 0.3, "z");
    bis_verify_bound(bis_verify_new(&v, "picture", "two"), 0, 0, "estimates that are no numbers");
    assert_int_equal(verify_judged(&v), 1);
    bis_verify_skip(bis_verify_new(&v, "picture", "three"), "a few renders outweigh all others here: too few to judge");
    assert_int_equal(verify_judged(&v), 2);
    bis_verify_skip(bis_verify_new(&v, "picture", "four"), "next to no light reaches the eye");
    assert_int_equal(verify_judged(&v), 2);
    bis_verify_clear(&v);
}

/* Renders that are wrong. */
static size_t pixels_of(const bis_film *f) { return (size_t)f->width * (size_t)f->height; }

/* A byte a pixel. */
static unsigned char *edges_of(const bis_film *f, const bis_scene *scene, const bis_view *view)
{
    const bis_rect all = {f->x0, f->y0, f->x0 + f->width, f->y0 + f->height};
    unsigned char *bits = bis_alloc(bis_edges_bytes(all), 1), *edge = bis_alloc(pixels_of(f), 1);
    double *turns = bis_edges_turns(scene->desc);
    assert_true(bis_edges_find(bits, all, all, &(bis_edge_eye){f, scene, view, turns}, 1));
    bis_free(turns);
    for (size_t i = 0; i < pixels_of(f); i++)
        edge[i] =
            bis_edges_kind(bits, all, f->x0 + (int)(i % (size_t)f->width), f->y0 + (int)(i / (size_t)f->width)) != 0;
    bis_free(bits);
    return edge;
}

static bis_status render_heavy_edges(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    const bis_status status = bis_render(result, f, scene, view, options, diag);
    unsigned char *edge = edges_of(f, scene, view);
    for (size_t i = 0; i < 3 * pixels_of(f); i++) f->sum[i] *= edge[i / 3] ? 1.5 : 1;
    bis_free(edge);
    return status;
}

/* Camera samples of edge pixels lie a quarter of a pixel to the right, or below. */
static bis_status render_shifted(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag, bool down)
{
    const double h = f->picture_height, aspect = f->picture_width / h, dx = down ? 0 : 0.5 / h, dy = down ? 0.5 / h : 0;
    bis_view shifted = *view;
    bis_film other;
    bis_render_result ignored;
    const double *crop = scene->desc->view.film.crop;
    assert_int_equal(bis_film_init_thin(&other, f->picture_width, f->picture_height, crop, f->step,
                         (bis_loc){0}, diag),
        BIS_OK);
    shifted.camera.has_screen = true;
    memcpy(shifted.camera.screen, (double[]){dx - aspect, dx + aspect, -1 - dy, 1 - dy}, sizeof shifted.camera.screen);
    bis_status status = bis_render(result, f, scene, view, options, diag);
    if (!status) status = bis_render(&ignored, &other, scene, &shifted, options, diag);
    unsigned char *edge = edges_of(f, scene, view);
    for (size_t i = 0; i < 3 * pixels_of(f); i++)
        if (edge[i / 3]) f->sum[i] = other.sum[i];
    bis_free(edge);
    bis_film_clear(&other);
    return status;
}

static bis_status render_to_the_right(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    return render_shifted(result, f, scene, view, options, diag, false);
}

static bis_status render_below(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    return render_shifted(result, f, scene, view, options, diag, true);
}

static bis_status render_exchanged(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    const bis_status status = bis_render(result, f, scene, view, options, diag);
    for (size_t i = 0; i < pixels_of(f); i++) {
        const double r = f->sum[3 * i];
        f->sum[3 * i] = f->sum[3 * i + 2];
        f->sum[3 * i + 2] = r;
    }
    return status;
}

static bis_status render_without_shadows(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    bis_view open = *view;
    open.settings = bis_settings_default(&bis_unoccluded);
    return bis_render(result, f, scene, &open, options, diag);
}

static bis_status render_not_a_number(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    const bis_status status = bis_render(result, f, scene, view, options, diag);
    result->counters.nonfinite += view->sampler.seed % 8 == 0; /* left out of the film, in a few renders */
    return status;
}

static bis_status render_a_pixel_without_number(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    const bis_status status = bis_render(result, f, scene, view, options, diag);
    f->sum[4] = (double)NAN;
    return status;
}

static bis_status render_three_percent_more(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    const bis_status status = bis_render(result, f, scene, view, options, diag);
    for (size_t i = 0; i < 3 * pixels_of(f); i++) f->sum[i] *= 1.03;
    return status;
}

/* No difference is larger than one that is no number, and none is smaller. */
static void a_mean_that_is_not_a_number_fails(void **state)
{
    verify_built b = build_full();
    bis_verify v = {.seed = 1, .halvings = 2};
    bool tested;
    assert_int_equal(bis_verify_picture(&v, render_a_pixel_without_number, b.scene, &b.desc->view.settings,
                                        &tested, NULL), BIS_OK);
    size_t n = 0;
    for (size_t i = 0; i < v.n; i++) {
        if (strncmp(v.tests[i].name, "all pixels", strlen("all pixels")) != 0) continue;
        n++;
        assert_true(v.tests[i].p == 0);
        assert_string_equal(v.tests[i].note, "not a number");
    }
    assert_true(tested && n > 0);
    bis_verify_clear(&v);
    verify_clear(&b);
}

static void wrong_pictures_are_rejected(void **state)
{
    static const struct { const char *what; bis_verify_render *render; const char *by; } wrong[] = {
        {"edge pixels count 1.5 times", render_heavy_edges, "outlines: "},
        {"edge samples to the right", render_to_the_right, "outlines, left to right"},
        {"edge samples below", render_below, "outlines, up and down"},
        {"channels exchanged", render_exchanged, "all pixels"},
        {"no shadows", render_without_shadows, "all pixels"},
        {"a number that is none", render_not_a_number, "not a number"},
        {"a pixel that is no number", render_a_pixel_without_number, "all pixels"},
        {"3 % too bright", render_three_percent_more, "all pixels"}};
    verify_built b = build_full();
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        /* one of two seeds: where a few renders outweigh all others there is no verdict */
        if (failed_of_picture(wrong[i].render, &b, &b.desc->view.settings, 1, wrong[i].by) == 0 &&
            failed_of_picture(wrong[i].render, &b, &b.desc->view.settings, 2, wrong[i].by) == 0)
            fail_msg("%s: \"%s\" accepts it", wrong[i].what, wrong[i].by);
    }
    verify_clear(&b);
}

/* Renders that have no noise: each pixel of the two is right, 5.25 by 7 = 4 + 2 + 1, times its factor. */
static double factor[2];

static bis_status render_factors(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    *result = (bis_render_result){.counters = {0}};
    for (size_t i = 0; i < 3 * pixels_of(f); i++) f->sum[i] = 2 * 0.75 * factor[i / 3];
    f->weight = 2;
    return BIS_OK;
}

static const struct {
    int width, height, floors;
    double first, second, factor[2];
    const char *found[5];
} floors[] = {{1, 1, 1, 0, 0, {1, 1}, {NULL}}, {1, 1, 1, 9, 0, {2 / 3.0, 1}, {NULL}},
    {1, 1, 1, 0, 0, {1.05, 1}, {"+5 %", "+5 %"}}, {2, 1, 2, -1, 1, {1, 1}, {NULL}},
    {2, 1, 2, -1, 1, {1.05, 0.95}, {NULL, NULL, "+5 %", ""}},
    {2, 1, 2, -1, 1, {0.95, 1.05}, {NULL, NULL, "-5 %", ""}},
    {1, 2, 2, -1, 1, {1.05, 0.95}, {NULL, NULL, "", "+5 %"}},
    {2, 1, 2, -1, 1.5, {1.1, 6.125 / 5.25}, {"+4.8 %", "+4.8 %", "+5.5 %", ""}}};

/* Floors of reflectance 1/2 end in each of one or two pixels, the picture is 7/2 or 7. All that is judged, by hand.
 * Where floors lie outside the middle of two pixels, these have opposite slopes: 5 % more in the first and less in the
 * second is nothing in all pixels, and 5 % of what the slopes weigh. Slopes along an edge are noise: "" may fail. Of
 * one pixel its slope tells nothing. The last case: the second floor takes a quarter of its pixel. Roots of mean
 * squares 5.534 and 6.310, their mean 5.922, weights 0.08729 and 0.08175, pixels 5.25 and 6.125, slopes 1.75 s (1 - s)
 * for a floor of share s: 0.4375 and 0.3281. Of 10 % more in the first, 4.78 % is left of the sum of all, and 5.50 % of
 * that with slopes. */
static void the_sums_of_a_picture_are_those_by_hand(void **state)
{
    static const char floor_text[] = "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" "
                                     "[%g %g 2  %g %g 2  %g %g 2  %g %g 2]\n";
    static const char *const of_one[] = {"all pixels: em", "outlines: em", "not a number: em"},
        *const of_material[] = {"all pixels: em", "material 1: em", "not a number: em"},
        *const of_two[] = {"all pixels: em", "outlines: em", "outlines, left to right: em", "outlines, up and down: em",
                           "not a number: em"};
    for (size_t i = 0; i < sizeof floors / sizeof *floors; i++) {
        char text[2048];
        const int down = floors[i].height == 2;
        int n = snprintf(text, sizeof text, "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\n"
                         "Camera \"orthographic\"\nIntegrator \"em\" \"integer samples\" 1\nWorldBegin\n"
                         "LightSource \"infinite\" \"rgb L\" [1 1 1]\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .5 "
                         ".5]\n",
                         floors[i].width, floors[i].height);
        for (int k = 0; k < floors[i].floors; k++) {
            const double a = k ? floors[i].second : -9, b = k ? 9 : floors[i].first;
            double c[4][2] = {{a, -9}, {b, -9}, {b, 9}, {a, 9}}; /* x, y */
            n += snprintf(text + n, sizeof text - (size_t)n, floor_text, c[0][down], c[0][!down], c[1][down],
                c[1][!down], c[2][down], c[2][!down], c[3][down], c[3][!down]);
        }
        program_folder(VERIFY_DIR);
        program_write_file(VERIFY_DIR "/floors.txt", text);
        verify_built b = verify_build(VERIFY_DIR "/floors.txt");
        for (int k = 0; k < 2; k++) factor[k] = floors[i].factor[k];
        /* Where a few renders outweigh all others there is no verdict: of seeds 1 to 20 a third have none. Each row
         * must get the right one from one of four seeds, and the wrong one from none. */
        bool judged[5] = {false}, all_judged = false;
        for (uint64_t seed = 1; !all_judged && seed <= 4; seed++) {
            bis_verify v = {.seed = seed, .halvings = 3};
            bool tested;
            assert_int_equal(
                bis_verify_picture(&v, render_factors, b.scene, &b.desc->view.settings, &tested, NULL), BIS_OK);
            assert_true(tested);
            assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
            assert_int_equal(v.n, floors[i].floors == 2 ? 5 : 3);
            all_judged = true;
            for (size_t k = 0; k < v.n; k++) {
                const char *found = floors[i].found[k];
                const char *const name = floors[i].floors == 2  ? of_two[k]
                                         : floors[i].first == 9 ? of_material[k]
                                                               : of_one[k];
                assert_string_equal(v.tests[k].name, name);
                assert_string_equal(v.tests[k].group, "picture");
                if (found && !*found) continue;
                judged[k] |= v.tests[k].verdict == (found ? BIS_VERDICT_FAILED : BIS_VERDICT_PASSED);
                all_judged &= judged[k];
                if (!found) assert_int_not_equal(v.tests[k].verdict, BIS_VERDICT_FAILED);
                if (found && v.tests[k].verdict == BIS_VERDICT_FAILED) assert_non_null(strstr(v.tests[k].note, found));
            }
            bis_verify_clear(&v);
        }
        if (!all_judged) fail_msg("case %zu: four seeds do not judge it", i);
        verify_clear(&b);
    }
}

/* Renders by turns brighter and darker than `swing.mean` by `swing.share` of it: one of `every` is the brighter. */
static struct { double mean, share; unsigned every, calls; } swing;

static bis_status render_by_turns(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    const double L = swing.mean * (1 + (swing.calls++ % swing.every == 0 ? swing.share : -swing.share));
    *result = (bis_render_result){.counters = {0}};
    for (size_t i = 0; i < 3 * pixels_of(f); i++) f->sum[i] = 4 * L / 7;
    f->weight = 4;
    return BIS_OK;
}

/* A floor of reflectance 1/2 fills a picture that is right at 7/2, which the reference's batches know to 1e-3. So the
 * scatter is that of the renders: 128 of them, half above and half below, have a standard error of the swing over the
 * root of 127, and Student's t tells p. Of one in 8 above, the skewness of the mean is 0.75 over the root of 14: 0.2 is
 * too much. */
static void z_and_p_of_a_picture_are_those_by_hand(void **state)
{
    static const struct { double mean, share; } cases[] = {{1.0625, 0.25}, {0.9375, 0.25}, {1.125, 0.5}};
    program_folder(VERIFY_DIR);
    program_write_file(VERIFY_DIR "/swing.txt",
        "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nCamera \"orthographic\"\n"
        "Integrator \"em\" \"integer samples\" 8\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n"
        "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 -9 2  9 -9 2  9 9 2  -9 9 2]\n");
    verify_built b = verify_build(VERIFY_DIR "/swing.txt");
    for (int i = 0; i < 4; i++) {
        bis_verify v = {.seed = 1, .halvings = 3};
        bool tested;
        swing.mean = 3.5 * cases[i % 3].mean;
        swing.share = cases[i % 3].share;
        swing.every = i < 3 ? 2 : 8;
        swing.calls = 0;
        assert_int_equal(
            bis_verify_picture(&v, render_by_turns, b.scene, &b.desc->view.settings, &tested, NULL), BIS_OK);
        assert_true(tested && swing.calls == 128);
        const bis_verify_test *t = &v.tests[0];
        assert_string_equal(t->name, "all pixels: em");
        if (i == 3) {
            assert_int_equal(t->verdict, BIS_VERDICT_SKIPPED);
            assert_string_equal(t->note, "a few renders outweigh all others here: too few to judge");
        } else {
            char note[80];
            const double se = swing.mean * swing.share / sqrt(127), z = (swing.mean - 3.5) / se;
            if (!(fabs(t->statistic / z - 1) < 0.02 && fabs(log(t->p / bis_verify_t(z, 127, 0))) < 0.1))
                fail_msg("case %d: z %g, p %g, must be %g, %g", i, t->statistic, t->p, z, bis_verify_t(z, 127, 0));
            snprintf(note, sizeof note, " %% +- %.2g %%; 128 renders of 1 pixels, 256 passes", 100 * se / 3.5);
            if (!strstr(t->note, note)) fail_msg("\"%s\" has no \"%s\"", t->note, note);
        }
        bis_verify_clear(&v);
    }
    verify_clear(&b);
}

/* Counts its calls, and whether each had so many samples a pixel. */
static struct { uint64_t spp; unsigned calls, wrong; } asked;

static bis_status render_nothing(bis_render_result *result, bis_film *f, const bis_scene *scene,
    const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    *result = (bis_render_result){.counters = {0}};
    asked.calls++;
    asked.wrong += options->budget.spp != asked.spp;
    f->weight = 1;
    return BIS_OK;
}

/* How many renders, pixels and passes, worked out. All renders may cost 2^25 units, halved h times: 8 a shadow ray, 1 a
 * candidate; for each pass 256 units a candidate (2^18 at most) and for `product` 2^15 more. 1024 pixels halved h
 * times, but 16 at least, as far as 32 renders of 2 passes (4 to learn) are paid for; 32 to 128 renders. E.g. product
 * 8/1, h = 2: 2^23 / (32 x 16 + 2048 + 32768) = 237.4 passes, 119 renders of 2; to learn 59 renders of 4. 64 x 48
 * pixels have 6 x 5 of each 10 x 10. */
static void renders_pixels_and_passes_are_those_worked_out(void **state)
{
    static const struct { const char *integrator; int width, height; unsigned h; const char *note; unsigned renders,
        spp; } cases[] = {
        {"\"em\" \"integer samples\" 8", 8, 4, 5, "; 128 renders of 32 pixels, 4 passes", 128, 4},
        {"\"em\" \"integer samples\" 8", 64, 48, 5, "; 128 renders of 30 pixels, 4 passes", 128, 4},
        {"\"sir\" \"integer candidates\" 8 \"integer shadowrays\" 1", 8, 4, 5, "; 128 renders of 32 pixels, 3 passes",
         128, 3},
        {"\"sir\" \"integer candidates\" 2000 \"integer shadowrays\" 1", 8, 4, 5, "; 32 renders of 8 pixels, 2 passes",
         32, 2},
        {"\"sir\" \"integer candidates\" 8 \"integer shadowrays\" 1 \"string proposal\" \"product\"", 8, 4, 2,
         "; 119 renders of 32 pixels, 2 passes", 119, 2},
        {"\"sir\" \"integer candidates\" 8 \"integer shadowrays\" 1 \"string proposal\" \"product\" \"bool learn\" "
         "true", 8, 4, 2,
         "; 59 renders of 32 pixels, 4 passes", 59, 4}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        snprintf(text, sizeof text,
            "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nCamera \"orthographic\"\n"
            "Integrator %s\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\nShape \"disk\" \"float height\" "
            "2\n",
            cases[i].width, cases[i].height, cases[i].integrator);
        program_folder(VERIFY_DIR);
        program_write_file(VERIFY_DIR "/counts.txt", text);
        verify_built b = verify_build(VERIFY_DIR "/counts.txt");
        bis_verify v = {.seed = 1, .halvings = cases[i].h};
        bool tested;
        asked.calls = asked.wrong = 0, asked.spp = cases[i].spp;
        assert_int_equal(
            bis_verify_picture(&v, render_nothing, b.scene, &b.desc->view.settings, &tested, NULL), BIS_OK);
        assert_true(tested && v.n > 0);
        if (!strstr(v.tests[0].note, cases[i].note)) fail_msg("case %zu: %s", i, v.tests[0].note);
        assert_int_equal(asked.calls, cases[i].renders);
        assert_int_equal(asked.wrong, 0);
        bis_verify_clear(&v);
        verify_clear(&b);
    }
}

/* Counts the camera rays. */
static atomic_uint camera_rays;

static bool counted_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    camera_rays++;
    return right_intersect(a, r, hit);
}

static bool seen_as_before(const bis_accel *a, const ray *r)
{
    return bis_accel_occluded(((const accel_twin *)a)->right, r);
}

/* What is expected of a picture is made of 8 batches that tell weights and outlines, and of 32 for the sums, with 2^21
 * samples in 32, halved so often: as many for each pixel, 1 to 4096. In pixels that an outline crosses the 32 have
 * eight times as many. Floors fill all pixels, or all but one that one of them ends in. */
static void a_reference_has_its_samples(void **state)
{
    static const bis_accel_ops ops = {.name = "counted", .intersect = counted_intersect, .occluded = seen_as_before};
    static const struct { int width, height; double right; unsigned halvings, samples, outlines; } cases[] = {
        {1, 1, 9, 3, 4096, 0}, {1, 1, 9, 7, 512, 0}, {1, 1, 0, 8, 256, 1}, {2, 2, 9, 7, 128, 0}, {4, 1, 0.5, 8, 64, 1},
        {3, 1, 9, 8, 85, 0}, {4, 4, 9, 20, 1, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        const unsigned n = (unsigned)(cases[i].width * cases[i].height);
        bis_verify v = {.seed = 1, .halvings = cases[i].halvings};
        bool tested;
        snprintf(text, sizeof text,
            "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nCamera \"orthographic\"\nIntegrator "
            "\"em\" \"integer samples\" 1\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\nMaterial "
            "\"diffuse\"\nShape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 -9 2  %g -9 2  %g "
            "9 2  -9 9 2]\n",
            cases[i].width, cases[i].height, cases[i].right, cases[i].right);
        program_folder(VERIFY_DIR);
        program_write_file(VERIFY_DIR "/samples.txt", text);
        verify_built b = verify_build(VERIFY_DIR "/samples.txt");
        accel_twin twin = {{&ops, &b.scene->geometry}, b.scene->accel};
        b.scene->accel = &twin.accel;
        camera_rays = 0;
        assert_int_equal(
            bis_verify_picture(&v, render_nothing, b.scene, &b.desc->view.settings, &tested, NULL), BIS_OK);
        b.scene->accel = (bis_accel *)(uintptr_t)twin.right;
        assert_true(tested);
        const unsigned expected = cases[i].samples * (8 * n + 32 * (n + 7 * cases[i].outlines));
        if (camera_rays != expected) fail_msg("case %zu: %u rays, must be %u", i, (unsigned)camera_rays, expected);
        bis_verify_clear(&v);
        verify_clear(&b);
    }
}

/* A floor of reflectance 1/2 fills the left half of the only pixel, seen from above in white light: half of 7/2, half
 * of 7. Times the place from the centre on: 7/2 times -1/8, 7 times 1/8. A pixel that the floor fills is no outline. */
static void a_reference_is_the_mean_over_the_pixel(void **state)
{
    static const char *const text =
        "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nCamera \"orthographic\"\nWorldBegin\n"
        "LightSource \"infinite\" \"rgb L\" [1 1 1]\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 -9 2  %d -9 2  %d 9 2  -9 9 2]\n";
    for (int whole = 0; whole < 2; whole++) {
        char filled[1024];
        bis_verify_table table;
        bis_verify_pixel pixel;
        double mean;
        program_folder(VERIFY_DIR);
        snprintf(filled, sizeof filled, text, 9 * whole, 9 * whole);
        program_write_file(VERIFY_DIR "/half.txt", filled);
        verify_built b = verify_build(VERIFY_DIR "/half.txt");
        const bis_film film = bis_film_place(1, 1, b.desc->view.film.crop, 1);
        assert_int_equal(bis_verify_table_init(&table, b.scene->light, NULL), BIS_OK);
        assert_near(table.sum[table.n], 4 * PI * 7, 1e-3);
        const bis_verify_eye eye = {b.scene, b.desc, &b.desc->view, &film, &table, false};
        bis_verify_means(&mean, &pixel, &eye, (uint32_t[]){1 << 16}, 1);
        assert_near(mean, whole ? 3.5 : 5.25, 0.02);
        assert_near(pixel.slope[0], whole ? 0 : 0.4375, 0.01);
        assert_near(pixel.slope[1], 0, 0.01);
        assert_int_equal(pixel.is_outline, !whole);
        bis_verify_table_clear(&table);
        verify_clear(&b);
    }
}

/* Of 6 x 4 pixels, each half as wide as a unit, every second in both directions, 1, 3, 5 and 1, 3, and of these the
 * right two columns: a floor of reflectance 1/2 fills pixel (3, 1), one of 1/4 pixel (5, 3), the others see the sky. By
 * white light a sample of a floor is 7 rho (g(c1) + g(c2)), g(c) = c/(c + 1/4), where c1 is uniform in [-1, 1] and g 0
 * below 0, and c2 has the density 2c: its mean is 7 rho, that of its square (7 rho)^2
 * (0.70118 + 2 x 0.29882 x 0.70118). */
static void pixels_of_a_thin_film_meet_what_is_there(void **state)
{
    static const char text[] = "Film \"rgb\" \"integer xresolution\" 6 \"integer yresolution\" 4\n"
        "Camera \"orthographic\"\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n"
        "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [0 0 2  .5 0 2  .5 .5 2  0 .5 2]\n"
        "Material \"diffuse\" \"rgb reflectance\" [.25 .25 .25]\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [1 -1 2  1.5 -1 2  1.5 -.5 2  1 -.5 2]";
    static const double rho[4] = {0.5, 0, 0, 0.25}, crop[4] = {1 / 3.0, 1, 0, 1};
    static const uint32_t n[4] = {1 << 16, 1 << 16, 1 << 16, 1 << 16};
    bis_verify_table table;
    bis_verify_pixel pixels[4];
    double mean[4], again[4];

    program_folder(VERIFY_DIR);
    program_write_file(VERIFY_DIR "/thin.txt", text);
    verify_built b = verify_build(VERIFY_DIR "/thin.txt");
    const bis_film film = bis_film_place(6, 4, crop, 2);
    assert_true(film.x0 == 1 && film.y0 == 0 && film.width == 2 && film.height == 2);
    assert_int_equal(bis_verify_table_init(&table, b.scene->light, NULL), BIS_OK);
    const bis_verify_eye eye = {b.scene, b.desc, &b.desc->view, &film, &table, false};
    bis_verify_means(mean, pixels, &eye, n, 1);
    bis_verify_means(again, NULL, &eye, n, 1);
    for (int i = 0; i < 4; i++) {
        const double L = 7 * rho[i];
        assert_true(mean[i] == again[i]);
        assert_false(pixels[i].is_outline);
        assert_near(mean[i], rho[i] > 0 ? L : 7, 0.01);
        assert_near(pixels[i].square, rho[i] > 0 ? L * L * (0.70118 + 2 * 0.29882 * 0.70118) : 49, 0.02);
        for (int k = 0; k < 2; k++) assert_near(pixels[i].slope[k], 0, 0.01);
        if (rho[i] > 0) {
            assert_near((double)b.desc->materials[pixels[i].material].Kd.r, rho[i], 1e-6);
            assert_true(pixels[i].n.x == 0 && pixels[i].n.y == 0 && pixels[i].n.z == -1);
        } else {
            assert_true(pixels[i].material == BIS_NO_NUMBER);
        }
    }
    bis_verify_means(again, NULL, &eye, n, 2);
    assert_true(again[0] != mean[0]);

    /* an invisible light is black behind everything, and lights as before */
    b.desc->light.visible = false;
    bis_verify_means(again, NULL, &eye, n, 1);
    for (int i = 0; i < 4; i++) assert_true(again[i] == (rho[i] > 0 ? mean[i] : 0));
    bis_verify_table_clear(&table);
    verify_clear(&b);
}

/* Two floors that share the only pixel, the right one of the same material or of another, turned about the line where
 * they meet by so many degrees: an outline where the material is another, or by more than 60 degrees. */
static void outlines_are_other_materials_and_other_sides(void **state)
{
    static const struct {
        bool is_other;
        double degrees;
    } cases[] = {{false, 0}, {true, 0}, {false, 55}, {false, 65}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double a = cases[i].degrees * PI / 180;
        char text[1024];
        bis_verify_table table;
        bis_verify_pixel pixel;
        double mean;
        program_folder(VERIFY_DIR);
        snprintf(text, sizeof text,
                 "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nCamera \"orthographic\"\n"
                 "WorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n"
                 "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
                 "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] "
                 "\"point3 P\" [-9 -9 9  0 -9 9  0 9 9  -9 9 9]\n"
                 "%s"
                 "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] "
                 "\"point3 P\" [0 -9 9  %.9g -9 %.9g  %.9g 9 %.9g  0 9 9]\n",
                 cases[i].is_other ? "Material \"diffuse\"\n" : "", 9 * cos(a), 9 + 9 * sin(a), 9 * cos(a),
                 9 + 9 * sin(a));
        program_write_file(VERIFY_DIR "/two.txt", text);
        verify_built b = verify_build(VERIFY_DIR "/two.txt");
        const bis_film film = bis_film_place(1, 1, b.desc->view.film.crop, 1);
        assert_int_equal(bis_verify_table_init(&table, b.scene->light, NULL), BIS_OK);
        const bis_verify_eye eye = {b.scene, b.desc, &b.desc->view, &film, &table, false};
        bis_verify_means(&mean, &pixel, &eye, (uint32_t[]){64}, 1);
        if (pixel.is_outline != (cases[i].is_other || cases[i].degrees > 60)) fail_msg("case %zu", i);
        bis_verify_table_clear(&table);
        verify_clear(&b);
    }
}

/* `exact` takes 2^17 patches a pixel: its points are looked at, as before. */
static void what_is_too_dear_is_said(void **state)
{
    verify_built b = build_full();
    bis_settings s = bis_settings_default(&bis_exact);
    bis_verify v = {.seed = 1};
    bool tested;
    s.perpatch = 256; /* of 512 patches */
    assert_int_equal(bis_verify_picture(&v, bis_render, b.scene, &s, &tested, NULL), BIS_OK);
    assert_false(tested);
    assert_int_equal(v.n, 1);
    assert_string_equal(v.tests[0].name, "all pixels: exact");
    assert_true(v.tests[0].verdict == BIS_VERDICT_SKIPPED && strstr(v.tests[0].note, "too dear"));
    bis_verify_clear(&v);
    verify_clear(&b);
}

static void every_allocation_of_a_picture_may_fail(void **state)
{
    verify_built b = build_full();
    bis_settings s = bis_settings_default(&bis_em);
    bis_status status = BIS_NOMEM;
    s.samples = 1;
    b.desc->view.film.width = b.desc->view.film.height = 2;
    b.desc->view.edge_samples = 1;
    for (long k = 1; status; k += 1 + k / 32) {
        bis_verify v = {.seed = 1, .halvings = 12};
        bis_diag diag = {0};
        bool tested;
        bis_mem_fail_at(k);
        status = bis_verify_picture(&v, bis_render, b.scene, &s, &tested, &diag);
        if (!status) status = bis_verify_judge(&v, &diag);
        const bool failed = bis_mem_count() >= k;
        bis_mem_fail_at(0);
        assert_int_equal(status, failed ? BIS_NOMEM : BIS_OK);
        assert_int_equal(diag.n_errors, failed);
        if (failed && diag.n > 0) assert_non_null(strstr(diag.messages[0].text, "memory"));
        bis_diag_clear(&diag);
        bis_verify_clear(&v);
    }
    verify_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(z_and_p_of_a_picture_are_those_by_hand),
        cmocka_unit_test(a_reference_has_its_samples),
        cmocka_unit_test(a_right_picture_passes),
        cmocka_unit_test(what_is_skipped_by_chance_counts_among_the_p_values),
        cmocka_unit_test(a_mean_that_is_not_a_number_fails),
        cmocka_unit_test(wrong_pictures_are_rejected),
        cmocka_unit_test(the_sums_of_a_picture_are_those_by_hand),
        cmocka_unit_test(renders_pixels_and_passes_are_those_worked_out),
        cmocka_unit_test(a_reference_is_the_mean_over_the_pixel),
        cmocka_unit_test(pixels_of_a_thin_film_meet_what_is_there),
        cmocka_unit_test(outlines_are_other_materials_and_other_sides),
        cmocka_unit_test(what_is_too_dear_is_said),
        cmocka_unit_test(every_allocation_of_a_picture_may_fail),
    };
    return cmocka_run_group_tests_name("verify_picture", tests, NULL, NULL);
}
