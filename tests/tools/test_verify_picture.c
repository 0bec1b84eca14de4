/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify` of pictures: those of the renderer pass, wrong ones are rejected. */
#include "render/edges.h"
#include "tools/verify/verify.h"
#include "bis/base/mem.h"
#include "claim.h"
#include "map_help.h"
#include "program.h"
#include "verify_help.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(z_and_p_of_a_picture_are_those_by_hand),
        cmocka_unit_test(a_right_picture_passes),
        cmocka_unit_test(wrong_pictures_are_rejected),
        cmocka_unit_test(a_reference_is_the_mean_over_the_pixel),
        cmocka_unit_test(pixels_of_a_thin_film_meet_what_is_there),
        cmocka_unit_test(outlines_are_other_materials_and_other_sides),
        cmocka_unit_test(what_is_too_dear_is_said),
    };
    return cmocka_run_group_tests_name("verify_picture", tests, NULL, NULL);
}
