/* SPDX-License-Identifier: BSD-2-Clause */
/* parser: docs/scene-format.md by examples. Bad scenes lie in tests/data/bad/NAME.txt beside the exact messages
 * NAME.expect (expect.h), each a test; good ones in tests/data/scenes and in docs/scene-format.md. */
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/scene/scene.h"
#include "claim.h"
#include "expect.h"
#include "image_help.h"
#include "parse/directives.h"
#include "parse/parser_ask.h"

#include <dirent.h>
#include <float.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BAD "tests/data/bad/"

/* ---- help ---- */

/* Parse this text; the description and diag are the caller's. */
static bis_status parse_text(bis_scene_desc **d, bis_diag *diag, const char *text)
{
    const char *path = scratch("scene.txt");
    *diag = (bis_diag){0};
    store(path, text, strlen(text));
    return bis_scene_parse(d, path, diag);
}

static bis_scene_desc *good(const char *text)
{
    bis_diag diag;
    bis_scene_desc *d;
    bis_status status = parse_text(&d, &diag, text);
    for (size_t i = 0; i < diag.n && status; i++) print_error("%s\n", diag.messages[i].text);
    bis_diag_clear(&diag);
    assert_int_equal(status, BIS_OK);
    return d;
}

/* before, WorldBegin with a light, after */
static bis_scene_desc *good_scene(const char *before, const char *after)
{
    char text[4096];
    snprintf(text, sizeof text, "%s\nWorldBegin\nLightSource \"infinite\"\n%s\n", before, after);
    return good(text);
}

/* All messages, a line each, without every "tests/data/bad/". */
static char *messages(const bis_diag *diag)
{
    size_t n = 1;
    for (size_t i = 0; i < diag->n; i++) n += strlen(diag->messages[i].text) + 1;
    char *all = calloc(n, 1), *out = all;
    for (size_t i = 0; i < diag->n; i++) {
        for (const char *s = diag->messages[i].text; *s;) {
            if (strncmp(s, BAD, strlen(BAD)) == 0) s += strlen(BAD);
            else *out++ = *s++;
        }
        *out++ = '\n';
    }
    return all;
}

/* ---- bad scenes ---- */

/* `parse NAME` of tests/data/bad: its messages. Some give warnings alone. */
static int parse(const expect_command *c)
{
    char path[512];
    bis_diag diag = {0};
    bis_scene_desc *d;

    snprintf(path, sizeof path, BAD "%s", c->arguments);
    const bis_status status = bis_scene_parse(&d, path, &diag);
    char *got = messages(&diag);
    fputs(got, c->messages);
    assert_int_equal(status, diag.n_errors ? BIS_INPUT : BIS_OK);
    assert_true((d == NULL) == (diag.n_errors > 0));
    free(got);
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
    return status ? 2 : 0;
}

static void a_scene_that_cannot_be_read_is_the_disks_fault(void **state)
{
    bis_scene_desc *d;
    bis_diag diag = {0};
    assert_int_equal(bis_scene_parse(&d, "build/no-such-scene.txt", &diag), BIS_IO);
    assert_int_equal(bis_scene_parse(&d, "tests", &diag), BIS_IO);
    assert_int_equal(diag.n_errors, 2);
    bis_diag_clear(&diag);
}

/* ---- what is said of a line ---- */

#define L " WorldBegin LightSource \"infinite\""
#define W "WorldBegin LightSource \"infinite\" "
#define FOV(value) "Camera \"perspective\" \"float fov\" " value L
#define MATTE(words) W "Material \"matte\" " words
#define TRIANGLE W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] "
#define FIELD(nu, nv, Pz) W "Shape \"heightfield\" \"integer nu\" " nu " \"integer nv\" " nv Pz
#define D62 "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"

/* A scene of one line, where its first message stands, and words of its cause; "": nothing is said, for the last value
 * that is good stands beside the first that is not. Columns are counted by hand. */
static const struct { const char *scene, *place, *words; } sayings[] = {
    {FOV("nan"), "34: error", "non-finite number \"nan\""}, {FOV("[1 -INF]"), "37: error", "number \"-INF\""},
    {"Translate 1 Infinity 3" L, "13: error", "wants 3 numbers, found \"Infinity\" after 1"},
    {FOV("3.5e38"), "34: error", "the largest float is 3.4e38"}, {FOV("3.4e38"), "22: error", "must be in (0, 180)"},
    {FOV("true"), "34: error", "wants numbers, found \"true\""}, {FOV("[45"), "34: error", "has no ]"},
    {FOV("]"), "22: error", "has no value"}, {FOV("[45 46]"), "22: error", "has 2 values, must have 1"},
    {"Option \"bool disablepixeljitter\" \"true\" \"bool approximate\" [false]" L, "", ""},
    {"Option \"bool disablepixeljitter\" \"truth\"" L, "34: error", "wants true or false"},
    {"Film \"rgb\" \"string filename\" [\"a\" 3]" L, "35: error", "wants strings, found \"3\""},
    {MATTE("\"spectrum Kd\" [400 \"a\"]"), "71: error", "wants numbers, found the string"},
    {"Camera \"perspective\" \"\tfloat\t a \" 1" L, "22: error", "unknown parameter \"a\""},
    {"Camera \"perspective\" \"float a b\" 1" L, "22: error", "declared as \"type name\""},
    {"Camera \"perspective\" \"flaot fov\" 45" L, "22: error", "did you mean \"float\"?"},
    {"Camera" L, "8: error", "wants a quoted name, found \"WorldBegin\""},
    {W "Texture \"t\" \"float\" 3", "55: error", "wants another quoted name"},
    {"X" D62 L, "1: error", "unknown directive \"X" D62 "\""},

    {"Camera \"perspective\" \"float screenwindow\" [0 1 2 2]" L, "22: error", "is empty"},
    {"Camera \"perspective\" \"float screenwindow\" [1 0 2 1]" L, "", ""},
    {"Camera \"perspective\" \"float frameaspectratio\" 0" L, "22: error", "must be > 0"},
    {"Camera \"perspective\" \"float focaldistance\" 3 \"float lensradius\" 0 \"float fov\" 179.9" L, "", ""},
    {"Camera \"perspective\" \"float lensradius\" -1" L, "22: error", "a thin lens is not modelled"},
    {"Film \"rgb\" \"float cropwindow\" [.5 .5 0 1]" L, "12: error", "is empty"},
    {"Film \"rgb\" \"float cropwindow\" [0 1 0 1.5]" L, "12: error", "is 1.5, must be in [0, 1]"},
    {"Film \"rgb\" \"integer xresolution\" 32768 \"integer yresolution\" 1 \"float scale\" 0" L, "", ""},
    {"Film \"rgb\" \"integer xresolution\" 32769" L, "12: error", "must be in [1, 32768]"},
    {"Film \"rgb\" \"integer yresolution\" 0" L, "12: error", "must be in [1, 32768]"},
    {"Film \"rgb\" \"float scale\" -1" L, "12: error", "must be >= 0"},
    {"PixelFilter \"box\" \"float xradius\" .5 \"float ywidth\" 0.5" L, "", ""},
    {"PixelFilter \"box\" \"float yradius\" 1" L, "19: warning", "the box has the size of one pixel"},
    {"PixelFilter \"box\" \"float xradius\" 0" L, "19: error", "must be > 0"},
    {"Accelerator \"grid\" \"float density\" 100" L, "", ""},
    {"Accelerator \"grid\" \"float density\" 100.5" L, "20: error", "must be in (0, 100]"},
    {"Sampler \"sobol\" \"integer seed\" 3.5e38" L, "17: error", "must be in [0, 9007199254740991]"},
    {"Sampler \"sobol\" \"integer edgesamples\" 1025" L, "17: error", "must be in [1, 1024]"},
    {"Sampler \"sobol\" \"integer edgesamples\" 0" L, "17: error", "must be in [1, 1024]"},
    {"Sampler \"sobol\" \"float edgelight\" 0" L, "17: error", "must be in (0, 1]"},
    {"Sampler \"sobol\" \"float edgelight\" 1 \"integer edgesamples\" 1 \"integer pixelsamples\" 1000000000" L, "", ""},
    {"Sampler \"sobol\" \"integer pixelsamples\" 1000000001" L, "17: error", "must be in [1, 1000000000]"},
    {"Sampler \"stratified\" \"integer ysamples\" 65536" L, "22: error", "must be in [1, 65535]"},
    {"Sampler \"stratified\" \"integer ysamples\" 5 \"integer pixelsamples\" 16" L, "22: error", "is 20, must be"},
    {"Sampler \"stratified\" \"integer xsamples\" 25001 \"integer ysamples\" 40000" L, "22: error",
     "at most 1000000000"},
    {"Integrator \"sir\" \"bool vectorize\" false" L, "18: warning", "\"vectorize\" is ignored"},
    {"Integrator \"em\" \"bool vectorize\" false" L, "17: error", "unknown parameter"},
    {"MediumInterface \"\" \"fog\"" L, "20: error", "media are not modelled"},
    {"Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1" L, "44: error", "wants ] after 16 numbers"},
    {"Rotate 90 0 0 0" L, "1: error", "which has no direction"}, {"Scale 1 0 1" L, "1: error", "singular"},

    {W "Shape \"sphere\" \"float radius\" 2 \"float zmin\" -2 \"float zmax\" 5 \"float phimax\" 360", "", ""},
    {W "Shape \"disk\" \"float innerradius\" 0 \"float phimax\" 360 \"float height\" 3", "", ""},
    {W "Shape \"sphere\" \"color radius\" [1 1 1]", "50: error", "is of type rgb, must be float"},
    {W "Shape \"objmesh\" \"bool materials\" true", "41: error", "Shape needs \"string filename\""},
    {TRIANGLE "\"normal N\" [1 2 3]", "87: error", "has 3 values, must have 3 for each of the 3 points"},
    {TRIANGLE "\"float st\" [0 1]", "87: error", "has 2 values, must have 2 for each of the 3 points"},
    {TRIANGLE "\"integer indices\" [0 1 3]", "87: error", "holds 3 as its value 3, must be a whole number in [0, 2]"},
    {FIELD("1", "2", " \"float Pz\" [1 2]"), "55: error", "must be in [2, 32768]"},
    {FIELD("2.5", "2", " \"float Pz\" [1 2]"), "55: error", "must be a whole number"},
    {FIELD("2", "2", ""), "41: error", "heightfield needs \"Pz\""},
    {W "Shape \"nurbs\" \"integer nu\" 2 \"integer uorder\" 3 \"float uknots\" [0 0 1 1 1]", "49: error",
     "at least \"uorder\""},
    {W "Shape \"nurbs\" \"integer nu\" 2 \"integer uorder\" 17", "64: error", "must be in [2, 16]"},
    {W "Shape \"loopsubdiv\" \"integer nlevels\" 11 \"point3 P\" [0 0 0]", "54: error", "must be in [0, 10]"},
    {MATTE("\"texture Kd\" \"no\""), "52: error", "texture \"no\" is not defined"},
    {MATTE("\"spectrum Kd\" [400 1 400 1]"), "52: error", "wavelengths ascending"},
    {MATTE("\"spectrum Kd\" [400 1 500 -0.5]"), "52: error", "a value >= 0"},
    {MATTE("\"spectrum Kd\" [1e-3 0 400 0.5 400.5 0.5]"), "", ""},
    {MATTE("\"blackbody Kd\" 499"), "52: error", "must be in [500, 1000000]"},
    {MATTE("\"integer Kd\" 1"), "52: error", "is of type integer, must be float or rgb"},
    {W "\"xyz L\" [.2 .2 .2] \"rgb scale\" [1 2 3] \"float illuminance\" 0", "", ""},
    {W "\"float L\" 2", "35: error", "is of type float, must be rgb"},
    {W "\"rgb L\" [1e38 1 1] \"rgb scale\" [10 2 3]", "54: error", "is not finite"},
    {W "\"integer levels\" 0", "35: error", "must be in [1, 254]"},
    {W "\"integer levels\" 254 \"float areaexponent\" 10 \"integer width\" 32768", "", ""},
    {W "\"integer width\" 32769", "35: error", "must be in [2, 32768]"},
    {W "\"string filter\" \"ewa\"", "35: error", "must be \"point\" or \"bilinear\""},
    {W "WorldEnd Shape \"sphere\"", "44: error", "a scene has one world"},
};

static void each_line_has_its_messages(void **state)
{
    for (size_t i = 0; i < BIS_COUNT(sayings); i++) {
        const char *const said = sayings[i].place, *text = "";
        bis_scene_desc *d;
        bis_diag diag;
        const bis_status status = parse_text(&d, &diag, sayings[i].scene);
        if (diag.n) text = strstr(diag.messages[0].text, "scene.txt:1:") + strlen("scene.txt:1:");
        if (*said ? strncmp(text, said, strlen(said)) != 0 || !strstr(text, sayings[i].words) : diag.n > 0)
            fail_msg("%s\n%s", sayings[i].scene, text);
        assert_int_equal(status, strstr(said, "error") ? BIS_INPUT : BIS_OK);
        bis_scene_desc_free(d);
        bis_diag_clear(&diag);
    }
#undef L
#undef W
#undef TRIANGLE
}

/* pbrt's names, which are in its documents, and words of what is said of each; "": nothing. */
static void each_name_of_pbrts_is_known(void **state)
{
#define IN_WORLD "WorldBegin LightSource \"infinite\" "
    static const struct { const char *before, *names, *after, *said; } groups[] = {
        {"Integrator \"", "path volpath bdpt mlt sppm directlighting whitted ao lightpath randomwalk ambientocclusion "
         "function photonmap exphotonmap igi irradiancecache simplepath simplevolpath", "\"",
         "replaced by the default, \"sir\""},
        {"Sampler \"", "zsobol paddedsobol pmj02bn 02sequence lowdiscrepancy maxmindist bestcandidate adaptive", "\"",
         "replaced by \"sobol\""},
        {"Sampler \"", "random independent stratified sobol halton", "\"", ""},
        {"Sampler \"sobol\" \"integer ", "dimensions randomization scramble", "\" 1",
         "changes nothing but noise"},
        {"Sampler \"sobol\" \"integer ", "samplepixelcenter", "\" 1",
         "changes shape"},
        {"PixelFilter \"", "gaussian mitchell sinc triangle lanczossinc", "\"", "changes sharpness"},
        {"Accelerator \"", "bvh kdtree", "\"", "replaced by the default"},
        {"Film \"rgb\" \"float ", "iso exposuretime imagingratio", "\" 100", ""},
        {"Option \"integer ", "disabletexturefiltering disablewavelengthjitter msereferenceimage msereferenceout "
         "pixelstats rendercoordsys wavefront", "\" 1", "changes nothing"},
        {"Film \"image\" Camera \"perspective\" \"float ", "shutteropen shutterclose", "\" 1",
         "changes nothing"},
        {"Camera \"perspective\" \"float ", "shutterclose", "\" 1", ""},
        {IN_WORLD "Shape \"sphere\" \"float ", "alpha shadowalpha", "\" 1", ""},
        {IN_WORLD "Shape \"sphere\" \"float ", "uv st S faceIndices", "\" 1", ""},
        {IN_WORLD "Material \"coateddiffuse\" \"float roughness\" 0.1 \"float ", "g maxdepth nsamples", "\" 1", ""},
        {IN_WORLD "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"Makefile\" \"float ",
         "trilinear maxanisotropy", "\" 1", ""},
        {IN_WORLD "Texture \"t\" \"", "float spectrum color rgb", "\" \"constant\"", ""},
    };
    for (size_t i = 0; i < BIS_COUNT(groups); i++)
        for (const char *name = groups[i].names; *name; name += strspn(name, " ")) {
            char text[512], said[80];
            bis_scene_desc *d;
            bis_diag diag;
            const int n = (int)strcspn(name, " ");
            snprintf(text, sizeof text, "%s%.*s%s%s", groups[i].before, n, name, groups[i].after,
                     strstr(groups[i].before, "WorldBegin") ? "" : " " IN_WORLD);
            assert_int_equal(parse_text(&d, &diag, text), BIS_OK);
            assert_int_equal(diag.n, *groups[i].said ? 1 : 0);
            snprintf(said, sizeof said, "\"%.*s\"", n, name);
            if (diag.n && (!strstr(diag.messages[0].text, said) || !strstr(diag.messages[0].text, groups[i].said)))
                fail_msg("%s\n%s", text, diag.messages[0].text);
            bis_scene_desc_free(d);
            bis_diag_clear(&diag);
            name += n;
        }
#undef IN_WORLD
}

/* ---- defaults and parameters ---- */

/* What a scene has that names no sampler. */
static void assert_has_the_usual_sampler(const bis_scene_desc *d)
{
    assert_int_equal(d->view.sampler.kind, BIS_SAMPLER_SOBOL);
    assert_int_equal(d->view.sampler.spp, 16);
    assert_true(d->view.sampler.seed == 0);
    assert_int_equal(d->view.edge_samples, 8);
    assert_true(fabs(d->view.edge_light - 0.25) < 1e-12);
}

/* What a scene has that names no integrator. */
static void assert_has_the_usual_settings(const bis_scene_desc *d)
{
    const bis_settings *s = &d->view.settings;

    assert_false(d->names_integrator);
    assert_ptr_equal(s->integrator, &bis_sir);
    assert_int_equal(s->proposal, BIS_PROPOSAL_PRODUCT);
    assert_int_equal(s->candidates, 64);
    assert_int_equal(s->shadowrays, 24);
    assert_true(s->learn && s->stratify && s->resampling == BIS_RESAMPLING_SYSTEMATIC);
}

static void an_empty_world_has_the_defaults_of_the_contract_E39(void **state)
{
    bis_diag diag;
    bis_scene_desc *d;
    assert_int_equal(parse_text(&d, &diag, "WorldBegin"), BIS_OK);
    assert_int_equal(diag.n, 1); /* the warning "no light" */
    assert_non_null(strstr(diag.messages[0].text, "no light"));
    assert_false(d->has_light);
    assert_int_equal(d->view.film.width, 1280);
    assert_int_equal(d->view.film.height, 720);
    assert_string_equal(d->outfile, "bis.exr");
    assert_true(d->view.film.crop[0] == 0 && d->view.film.crop[1] == 1 && d->view.film.crop[2] == 0 &&
                d->view.film.crop[3] == 1);
    assert_true(!d->view.camera.orthographic && d->view.camera.fov_deg == 90 && !d->view.camera.has_screen);
    assert_has_the_usual_sampler(d);
    assert_true(d->view.pixel_jitter);
    assert_has_the_usual_settings(d);
    assert_int_equal(d->accel.kind, BIS_ACCEL_DEFAULT);
    assert_int_equal(d->n_shapes, 0);
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
}

static void a_sampler_alone_leaves_the_integrator_to_us(void **state)
{
    bis_scene_desc *d = good_scene("Sampler \"stratified\"", "");
    assert_int_equal(d->view.sampler.kind, BIS_SAMPLER_STRATIFIED);
    assert_int_equal(d->view.sampler.spp, 16);
    assert_int_equal(d->view.sampler.xsamples, 4);
    assert_true(d->view.sampler.jitter && d->view.sampler.seed == 0);
    assert_int_equal(d->view.edge_samples, 1); /* a named sampler has one camera sample everywhere */
    assert_has_the_usual_settings(d);
    bis_scene_desc_free(d);
    d = good_scene("Sampler \"sobol\"", "");
    assert_int_equal(d->view.edge_samples, 1);
    bis_scene_desc_free(d);
}

/* Counts, proposal and resampling of the thesis's chapter 5, written out as a scene has them. */
static void an_integrator_alone_has_the_settings_of_the_thesis_and_leaves_the_sampler_to_us(void **state)
{
    static const char *const lines[][2] = {
        {"Integrator \"sir\"",
         "Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 15 \"string proposal\" \"mix\""
         " \"bool learn\" false"},
        {"Integrator \"sir\" \"string proposal\" \"product\"",
         "Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 15 \"string proposal\" \"product\""
         " \"bool learn\" false"},
        {"Integrator \"rejection\"",
         "Integrator \"rejection\" \"integer candidates\" 800 \"integer shadowrays\" 15"},
        {"Integrator \"em\"", "Integrator \"em\" \"integer samples\" 16"},
    };

    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        bis_scene_desc *d = good_scene(lines[i][0], ""), *written_out = good_scene(lines[i][1], "");
        assert_true(d->names_integrator);
        assert_true(bis_settings_equal(&d->view.settings, &written_out->view.settings));
        assert_has_the_usual_sampler(d);
        bis_scene_desc_free(d);
        bis_scene_desc_free(written_out);
    }
}

/* pbrt's "path" says nothing of our integrators: the scene is one without. */
static void an_integrator_of_pbrt_is_none(void **state)
{
    static const char *const lines[] = {"Integrator \"path\"", "Integrator \"em\" Integrator \"path\""};

    for (int i = 0; i < 2; i++) {
        char text[256];
        bis_diag diag;
        bis_scene_desc *d;
        snprintf(text, sizeof text, "Option \"string asprinted\" \"E6\" %s WorldBegin LightSource \"infinite\"",
                 lines[i]);
        assert_int_equal(parse_text(&d, &diag, text), BIS_OK);
        assert_has_the_usual_settings(d);
        assert_int_equal(d->view.settings.as_printed, bis_erratum_find("E6")->flag); /* the Option's, which stays */
        bis_scene_desc_free(d);
        bis_diag_clear(&diag);
    }
}

/* Figure 5.5 by its text (ks = 1, kd = 0.1) would reflect more than arrives; by its caption (ks = 0, kd = 1) it does
 * not. */
static void coefficients_of_figure_5_5_s_text_are_warned_of_and_its_captions_are_not_E38(void **state)
{
    static const char *const scenes[] = {
        "WorldBegin LightSource \"infinite\" Material \"phong\" \"float Ks\" 0 \"float Kd\" 1 Shape \"sphere\"",
        "WorldBegin LightSource \"infinite\" Material \"phong\" \"float Ks\" 1 \"float Kd\" 0.1 Shape \"sphere\""};
    for (size_t i = 0; i < 2; i++) {
        bis_diag diag;
        bis_scene_desc *d;
        assert_int_equal(parse_text(&d, &diag, scenes[i]), BIS_OK);
        assert_int_equal(diag.n, i);
        if (i == 1) assert_non_null(strstr(diag.messages[0].text, "Kd + Ks"));
        bis_scene_desc_free(d);
        bis_diag_clear(&diag);
    }
}

static void every_parameter_before_the_world_arrives(void **state)
{
    bis_scene_desc *d = good_scene(
        "Camera \"orthographic\" \"float screenwindow\" [-2 2 -1.5 1.5] \"float frameaspectratio\" 2 \"float "
        "lensradius\" 0\n"
        "Film \"rgb\" \"integer xresolution\" 640 \"integer yresolution\" [480] \"string filename\" \"a b.exr\" "
        "\"float cropwindow\" [.25 .75 0 .5]\n"
        "PixelFilter \"box\"\n"
        "Sampler \"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5 \"bool jitter\" false \"integer seed\" "
        "9007199254740991\n"
        "Integrator \"rejection\" \"integer candidates\" 7 \"integer shadowrays\" 3 \"string proposal\" \"brdf\" "
        "\"string estimator\" \"plain\" \"string fallback\" \"subset\"\n"
        "Accelerator \"grid\" \"float density\" 2.5\n"
        "Option \"bool disablepixeljitter\" true\n"
        "ColorSpace \"srgb\" MediumInterface \"\" \"\" MediumInterface \"\"\n",
        "");
    assert_true(d->view.camera.orthographic && d->view.camera.has_screen && d->view.camera.screen[0] == -2 &&
                d->view.camera.screen[3] == 1.5);
    assert_true(d->view.camera.frame_aspect == 2);
    assert_int_equal(d->view.film.width, 640);
    assert_int_equal(d->view.film.height, 480);
    assert_string_equal(d->outfile, "a b.exr");
    assert_true(d->view.film.crop[0] == 0.25 && d->view.film.crop[1] == 0.75 && d->view.film.crop[2] == 0 &&
                d->view.film.crop[3] == 0.5);
    assert_int_equal(d->view.sampler.xsamples, 3);
    assert_int_equal(d->view.sampler.ysamples, 5);
    assert_int_equal(d->view.sampler.spp, 15);
    assert_true(!d->view.sampler.jitter && d->view.sampler.seed == (UINT64_C(1) << 53) - 1);
    const bis_settings *s = &d->view.settings;
    assert_ptr_equal(s->integrator, &bis_rejection);
    assert_true(s->candidates == 7 && s->shadowrays == 3 && s->proposal == BIS_PROPOSAL_BRDF &&
                s->estimator == BIS_ESTIMATOR_PLAIN && s->fallback == BIS_FALLBACK_SUBSET);
    assert_int_equal(d->accel.kind, BIS_ACCEL_GRID);
    assert_true(d->accel.density == 2.5);
    assert_false(d->view.pixel_jitter);
    bis_scene_desc_free(d);
}

static void a_film_has_the_layers_that_are_named(void **state)
{
    const unsigned albedo = 1u << BIS_LAYER_ALBEDO, depth = 1u << BIS_LAYER_DEPTH;
    static const char *const lines[] = {"\"albedo\"", "\"depth\"", "[\"albedo\" \"depth\"]", "[\"depth\" \"albedo\"]"};
    const unsigned expected[] = {albedo, depth, albedo | depth, albedo | depth};
    for (int i = 0; i < 4; i++) {
        char text[256];
        snprintf(text, sizeof text, "Film \"rgb\" \"string layers\" %s", lines[i]);
        bis_scene_desc *d = good_scene(text, "");
        assert_int_equal(d->view.film.layers, expected[i]);
        bis_scene_desc_free(d);
    }
}

/* One by one, in one list, and by one Option after the other: the switches add up. */
static void errata_are_switched_by_their_names(void **state)
{
    const bis_erratum *e = bis_errata;
    char text[256];
    assert_true(e[0].name && e[1].name && e[0].flag != e[1].flag);
    for (int i = 0; i < 4; i++) {
        const char *a = e[i % 2].name, *b = e[1 - i % 2].name;
        if (i < 2) snprintf(text, sizeof text, "Option \"string asprinted\" [\"%s\" \"%s\"]", a, b);
        else
            snprintf(text, sizeof text, "Option \"string asprinted\" \"%s\" Option \"string asprinted\" \"%s\"", a, b);
        bis_scene_desc *d = good_scene(text, "");
        assert_int_equal(d->view.settings.as_printed, e[0].flag | e[1].flag);
        bis_scene_desc_free(d);
    }
}

static void every_parameter_of_the_other_integrators_arrives(void **state)
{
    bis_scene_desc *d;
    d = good_scene("Integrator \"mis\" \"integer samples\" 9 \"string heuristic\" \"power\" \"float split\" .25 \"bool "
                   "compensate\" true",
        "");
    assert_true(d->view.settings.integrator == &bis_mis && d->view.settings.samples == 9 &&
                d->view.settings.heuristic == BIS_HEURISTIC_POWER &&
                d->view.settings.split == 0.25 && d->view.settings.compensate);
    bis_scene_desc_free(d);
    d = good_scene("Integrator \"sir\" \"integer candidates\" 5 \"integer shadowrays\" 2 \"string proposal\" \"em\" "
                   "\"string resampling\" \"multinomial\" \"bool stratify\" \"false\"", "");
    assert_true(d->view.settings.integrator == &bis_sir && d->view.settings.candidates == 5 &&
                d->view.settings.shadowrays == 2 && d->view.settings.proposal == BIS_PROPOSAL_EM &&
                d->view.settings.resampling == BIS_RESAMPLING_MULTINOMIAL && !d->view.settings.stratify);
    bis_scene_desc_free(d);
    d = good_scene("Integrator \"exact\" \"integer perpatch\" 4", "");
    assert_true(d->view.settings.integrator == &bis_exact && d->view.settings.perpatch == 4);
    bis_scene_desc_free(d);
    d = good_scene("Integrator \"em\" \"integer samples\" 3", "");
    assert_true(d->view.settings.integrator == &bis_em && d->view.settings.samples == 3);
    bis_scene_desc_free(d);
    d = good_scene("Integrator \"brdf\" \"integer samples\" 1", "");
    assert_true(d->view.settings.integrator == &bis_brdf && d->view.settings.samples == 1);
    bis_scene_desc_free(d);
    d = good_scene("Integrator \"unoccluded\" \"integer candidates\" 11", "");
    assert_true(d->view.settings.integrator == &bis_unoccluded && d->view.settings.candidates == 11);
    bis_scene_desc_free(d);
}

/* What is not named has the default: L 1, scale 1, area exponent 0.15, 8 levels, width 0, lat-long, visible, pixels. */
static void each_parameter_of_a_light_changes_itself_alone(void **state)
{
    static const struct { const char *words; bis_light_desc is; } cases[] = {
        {"\"rgb L\" [1 2 3]", {.L = {1, 2, 3}}},
        {"\"rgb L\" [1 2 3] \"rgb scale\" [2 2 2]", {.L = {1, 2, 3}, .scale = 2}},
        {"\"rgb scale\" [2 2 3]", {.L = {2, 2, 3}}},
        {"\"rgb scale\" [3 2 2] \"rgb L\" [1 2 3]", {.L = {3, 4, 6}}},
        {"\"rgb scale\" [0 0 1]", {.L = {0, 0, 1}}},
        {"\"float scale\" 0.5", {.scale = .5}},
        {"\"string mapping\" \"latlong\"", {.has_mapping = true}},
        {"\"string mapping\" \"cubestrip\"", {.has_mapping = true, .mapping = (bis_mapping)(BIS_N_MAPPINGS - 1)}},
        {"\"string mapping\" \"equalarea\"", {.has_mapping = true, .mapping = BIS_MAPPING_EQUALAREA}},
        {"\"integer width\" 2", {.width = 2}},
        {"\"float areaexponent\" 10", {.area_exponent = 10}},
        {"\"integer levels\" 1", {.levels = 1}},
        {"\"integer levels\" 254", {.levels = 254}},
        {"\"string sampler\" \"alias\"", {.has_table_kind = true, .table_kind = BIS_TABLE_ALIAS}},
        {"\"string sampler\" \"cdf\"", {.has_table_kind = true, .table_kind = BIS_TABLE_CDF}},
        {"\"bool visible\" false", {.as_printed = 1}}, /* here: not visible */
        {"\"bool visible\" true", {.width = 0}},
        {"\"string filter\" \"point\"", {.width = 0}},
        {"\"string filter\" \"bilinear\"", {.is_smooth = true}},
        {"\"string mapname\" \"%s\"", {.filename = (char *)(uintptr_t)"m"}},
        {"\"string filename\" \"%s\"", {.filename = (char *)(uintptr_t)"m", .is_v4 = true}},
        {"\"float illuminance\" -5", {.width = 0}},
    };
    store(scratch("map.pfm"), "x", 1);
    for (size_t i = 0; i < BIS_COUNT(cases); i++) {
        char text[512], words[256];
        const char *name = strstr(cases[i].words, "%s");
        const bis_light_desc *is = &cases[i].is;
        snprintf(words, sizeof words, "%.*s%s%s", name ? (int)(name - cases[i].words) : 200, cases[i].words,
                 name ? strrchr(scratch("map.pfm"), '/') + 1 : "", name ? name + 2 : "");
        snprintf(text, sizeof text, "WorldBegin\nRotate 90 0 0 1\nLightSource \"infinite\" %s", words);
        bis_scene_desc *d = good(text);
        const bis_light_desc *l = &d->light;
        const rgb L = rgb_is_black(is->L) ? (rgb){1, 1, 1} : is->L;
        const bool same = l->L.r == L.r && l->L.g == L.g && l->L.b == L.b &&
            l->scale == (is->scale > 0 ? is->scale : 1) && l->mapping == is->mapping &&
            l->has_mapping == is->has_mapping && l->is_v4 == is->is_v4 &&
            l->width == is->width && l->area_exponent == (is->area_exponent > 0 ? is->area_exponent : 0.15) &&
            l->levels == (is->levels ? is->levels : 8) && l->has_table_kind == is->has_table_kind &&
            l->visible == !is->as_printed && l->is_smooth == is->is_smooth && !l->filename == !is->filename;
        if (!same || (l->has_table_kind && l->table_kind != is->table_kind)) fail_msg("%s", text);
        if (l->filename) assert_string_equal(l->filename, scratch("map.pfm"));
        assert_true(l->loc.line == 3 && fabs(l->to_world.m[1][0] - 1) < 1e-12 && d->has_light && !l->n_distants);
        bis_scene_desc_free(d);
    }
}

/* A portal is in world space, and lights that differ in nothing else are one light. */
static void equal_lights_are_one_with_several_portals(void **state)
{
#define PORTAL(corners) "LightSource \"infinite\" \"rgb L\" [3 2 1] \"point3 portal\" [" corners "] "
    bis_scene_desc *d = good("WorldBegin Rotate 90 1 0 0 Scale 2 2 2 " PORTAL("1 2 3  1 4 3  1 4 3.5  1 2 3.5")
                             PORTAL("0 0 0  0 0 2  1 0 2  1 0 0"));
    const bis_portal *p = d->light.portals;

    assert_int_equal(d->light.n_portals, 2);
    assert_true(p[0].corner[0] == 1 && p[0].corner[1] == 2 && p[0].corner[2] == 3);
    assert_true(p[0].edge[0][1] == 2 && p[0].edge[1][2] == 0.5 && p[1].edge[0][2] == 2 && p[1].edge[1][0] == 1);
    assert_true(p[0].edge[0][0] == 0 && p[0].edge[1][1] == 0 && d->light.L.g == 2);
    bis_scene_desc_free(d);
}

/* As squarely as possible; of two sides the one that is not given is 4. */
static void spp_alone_is_divided_as_squarely_as_possible(void **state)
{
    static const struct { const char *words; uint32_t x, y; } cases[] = {
        {"pixelsamples\" 1", 1, 1}, {"pixelsamples\" 7", 7, 1}, {"pixelsamples\" 12", 4, 3},
        {"pixelsamples\" 72", 9, 8}, {"pixelsamples\" 1000000000", 32000, 31250}, {"xsamples\" 3", 3, 4},
        {"ysamples\" 5", 4, 5}};
    for (size_t i = 0; i < BIS_COUNT(cases); i++) {
        char text[128];
        snprintf(text, sizeof text, "Sampler \"stratified\" \"integer %s", cases[i].words);
        bis_scene_desc *d = good_scene(text, "");
        const bis_sampler *is = &d->view.sampler;
        if (is->xsamples != cases[i].x || is->ysamples != cases[i].y || is->spp != cases[i].x * cases[i].y)
            fail_msg("%s: %llu x %llu", text, (unsigned long long)is->xsamples, (unsigned long long)is->ysamples);
        bis_scene_desc_free(d);
    }
}

static void a_directive_given_again_starts_from_the_defaults(void **state)
{
    bis_scene_desc *d = good_scene("Film \"rgb\" \"integer xresolution\" 10 \"string filename\" \"a.exr\"\n"
                                   "Film \"rgb\" \"integer yresolution\" 20\n"
                                   "Sampler \"random\" \"integer seed\" 3\nSampler \"random\"\n"
                                   "Integrator \"sir\" \"integer candidates\" 5\nIntegrator \"sir\"", "");
    assert_int_equal(d->view.film.width, 1280);
    assert_int_equal(d->view.film.height, 20);
    assert_string_equal(d->outfile, "bis.exr");
    assert_true(d->view.sampler.seed == 0);
    assert_int_equal(d->view.settings.candidates, bis_settings_default(&bis_sir).candidates);
    bis_scene_desc_free(d);
}

/* Of what a scene has once the second counts, and says so; Option may come again. */
static void what_a_scene_has_once_is_told_when_it_comes_again(void **state)
{
    static const char *const lines[] = {"Camera \"perspective\"", "Film \"rgb\"", "PixelFilter \"box\"",
        "Sampler \"sobol\"", "Integrator \"em\"", "Accelerator \"grid\"", "Option \"bool disablepixeljitter\" true"};
    for (size_t i = 0; i < BIS_COUNT(lines); i++) {
        const int n = (int)strcspn(lines[i], " ");
        char text[256], said[256];
        bis_scene_desc *d;
        bis_diag diag;
        snprintf(text, sizeof text, "%s\n\n  %s WorldBegin LightSource \"infinite\"", lines[i], lines[i]);
        assert_int_equal(parse_text(&d, &diag, text), BIS_OK);
        snprintf(said, sizeof said, "%s:3:3: warning: %.*s is given again and replaces that of %s:1",
                 scratch("scene.txt"), n, lines[i], scratch("scene.txt"));
        assert_int_equal(diag.n, i < 6 ? 1 : 0);
        if (i < 6) assert_string_equal(diag.messages[0].text, said);
        bis_scene_desc_free(d);
        bis_diag_clear(&diag);
    }
}

/* ---- transformations and blocks ---- */

/* Where object-space (1, 2, 3) of shape i ends. */
static void assert_moves(const bis_scene_desc *d, size_t i, double x, double y, double z)
{
    vec3 p = bis_xform_point(&d->shapes[i].to_world, (vec3){1, 2, 3});
    assert_true(fabs((double)p.x - x) < 1e-5 && fabs((double)p.y - y) < 1e-5 && fabs((double)p.z - z) < 1e-5);
}

static void transformations_multiply_from_the_right(void **state)
{
    bis_scene_desc *d = good_scene("Translate 100 100 100", /* the camera's: forgotten at WorldBegin */
                                   "Translate 10 0 0 Scale 2 3 4 Shape \"sphere\"\n"
                                   "Identity Rotate 90 0 0 1 Shape \"sphere\"\n"
                                   "Transform [1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1] Shape \"sphere\"\n"
                                   "ConcatTransform 2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1 Shape \"sphere\"\n"
                                   "CoordinateSystem \"here\" Identity CoordSysTransform \"here\" Shape \"sphere\"\n"
                                   "CoordSysTransform \"world\" Shape \"sphere\"\n"
                                   "LookAt 0 0 5 0 0 0 0 1 0 Shape \"sphere\"");
    assert_moves(d, 0, 12, 6, 12);
    assert_moves(d, 1, -2, 1, 3);
    assert_moves(d, 2, 6, 8, 10);
    assert_moves(d, 3, 7, 10, 13);
    assert_moves(d, 4, 7, 10, 13);
    assert_moves(d, 5, 1, 2, 3);
    assert_moves(d, 6, -1, 2, 2); /* x turned round, z from the eye */
    bis_scene_desc_free(d);
}

static void the_coordinate_system_camera_maps_camera_space_to_the_world(void **state)
{
    bis_scene_desc *d = good_scene("Translate 0 0 5 Camera \"perspective\"",
                                   "CoordSysTransform \"camera\" Shape \"sphere\"");
    assert_moves(d, 0, 1, 2, -2);
    assert_true(d->view.camera.to_world.m[2][3] == -5);
    bis_scene_desc_free(d);
}

static void blocks_restore_what_they_saved(void **state)
{
    bis_scene_desc *d = good_scene("", "Material \"diffuse\" \"rgb reflectance\" [1 0 0] Translate 1 0 0\n"
                                       "AttributeBegin Material \"diffuse\" Translate 1 0 0 Shape \"sphere\"\n"
                                       "  TransformBegin Translate 5 0 0 Material \"phong\" Shape \"sphere\" "
                                       "TransformEnd Shape \"sphere\"\n"
                                       "AttributeEnd Shape \"sphere\"");
    assert_moves(d, 0, 3, 2, 3);
    assert_moves(d, 1, 8, 2, 3);
    assert_moves(d, 2, 3, 2, 3);
    assert_moves(d, 3, 2, 2, 3);
    assert_int_equal(d->shapes[1].material, d->shapes[2].material); /* TransformEnd restores no material */
    assert_true(d->shapes[0].material != d->shapes[1].material);
    assert_true(d->materials[d->shapes[3].material].Kd.r == 1);
    bis_scene_desc_free(d);
}

static void instances_put_their_transformation_before_the_objects(void **state)
{
    bis_scene_desc *d = good_scene("", "Translate 1 0 0\n"
                                       "ObjectBegin \"o\" Scale 2 2 2 Material \"phong\" Shape \"sphere\" Shape "
                                       "\"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ObjectEnd\n"
                                       "Translate 0 10 0 ObjectInstance \"o\" ObjectInstance \"o\" Shape \"sphere\"");
    assert_int_equal(d->n_shapes, 5);
    assert_moves(d, 0, 1 + 1 + 2, 10 + 4, 6);
    assert_moves(d, 3, 1 + 1 + 2, 10 + 4, 6);
    assert_moves(d, 4, 1 + 1, 10 + 2, 3); /* ObjectEnd restored the CTM */
    assert_int_equal(d->n_meshes, 1);
    assert_int_equal(d->shapes[1].mesh, d->shapes[3].mesh);
    assert_true(d->shapes[0].material != d->shapes[4].material);
    bis_scene_desc_free(d);
}

/* Read otherwise, a file is another mesh: as PLY or OBJ, smooth or not, in parts or whole. Each way comes twice. */
static void a_file_that_is_read_in_other_ways_is_other_meshes(void **state)
{
    static const char *const ways[] = {"\"plymesh\"", "\"plymesh\" \"bool smooth\" true", "\"objmesh\"",
        "\"objmesh\" \"bool smooth\" true", "\"objmesh\" \"bool materials\" true",
        "\"objmesh\" \"bool materials\" true \"bool smooth\" true"};
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    char text[2048] = "";
    store(scratch("m.obj"), obj, sizeof obj - 1);
    for (int i = 0; i < 12; i++) {
        const size_t n = strlen(text);
        snprintf(text + n, sizeof text - n, "Shape %s \"string filename\" \"%s\"\n", ways[i % 6],
            strrchr(scratch("m.obj"), '/') + 1);
    }
    bis_scene_desc *d = good_scene("", text);
    for (size_t i = 0; i < 12; i++) {
        const bis_mesh_desc *m = &d->meshes[d->shapes[i].mesh];
        assert_int_equal(d->shapes[i].mesh, i % 6);
        assert_true(m->kind == (i % 6 < 2 ? BIS_SHAPE_PLY : BIS_SHAPE_OBJ) &&
                    m->smooth == (i % 6 == 1 || i % 6 == 3 || i % 6 == 5) && m->has_parts == (i % 6 > 3));
    }
    bis_scene_desc_free(d);
}

static void a_named_material_may_be_used_before_it_is_made(void **state)
{
    bis_scene_desc *d = good_scene("",
        "NamedMaterial \"m\" Shape \"sphere\" MakeNamedMaterial \"m\" \"string type\" \"matte\" \"color Kd\" [1 0 0]");
    assert_true(d->materials[d->shapes[0].material].Kd.r == 1);
    bis_scene_desc_free(d);
}

static void triangles_arrive_with_points_indices_and_normals(void **state)
{
    bis_scene_desc *d = good_scene("",
        "Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0 7 8 9] \"integer indices\" [2 1 0 3 2 1]\n"
        " \"normal N\" [0 0 1 0 0 1 0 0 1 1 0 0] \"vector S\" [1 0 0]\n"
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]");
    const bis_mesh *m = &d->meshes[0].mesh;
    assert_int_equal(m->n_vertices, 4);
    assert_int_equal(m->n_triangles, 2);
    assert_true(m->p[3].x == 7 && m->p[3].y == 8 && m->p[3].z == 9 && m->n[3].x == 1 && m->n[0].z == 1);
    assert_memory_equal(m->index, ((const uint32_t[6]){2, 1, 0, 3, 2, 1}), 6 * sizeof *m->index);
    assert_int_equal(d->meshes[1].mesh.n_triangles, 1); /* three points are a triangle */
    assert_int_equal(d->meshes[1].mesh.index[2], 2);
    assert_null(d->meshes[1].mesh.n);
    bis_scene_desc_free(d);
}

/* ---- the light's frame ---- */

static void a_light_frame_may_be_rotated_and_mirrored_and_is_made_exactly_orthonormal(void **state)
{
    /* 30 degrees about z to three digits, mirrored in x, moved */
    bis_scene_desc *d = good("WorldBegin Translate 5 5 5 Scale -1 1 1 ConcatTransform [.866 .5 0 0 -.5 .866 0 0 0 0 1 "
                             "0 0 0 0 1] LightSource \"infinite\"");
    const bis_xform *t = &d->light.to_world;
    assert_true(bis_xform_is_orthonormal(t, 4 * 0x1p-52));
    assert_true(fabs(t->m[0][0] + sqrt(0.75)) < 1e-3 && fabs(t->m[1][0] - 0.5) < 1e-3 && t->m[0][3] == 0);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) assert_true(t->inv[i][j] == t->m[j][i]);
    bis_scene_desc_free(d);
}

/* ---- pbrt ---- */

static void assert_same_xform(const bis_xform *a, const bis_xform *b)
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) assert_true(fabs(a->m[i][j] - b->m[i][j]) < 1e-14);
}

static void a_scene_in_pbrt_v3_and_in_v4_spelling_is_the_same_scene_and_gives_no_message(void **state)
{
    bis_scene_desc *a, *b;
    bis_diag diag = {0};
    assert_int_equal(bis_scene_parse(&a, "tests/data/scenes/pbrt-v3.txt", &diag), BIS_OK);
    assert_int_equal(bis_scene_parse(&b, "tests/data/scenes/pbrt-v4.txt", &diag), BIS_OK);
    assert_int_equal(diag.n, 0);
    assert_same_xform(&a->view.camera.to_world, &b->view.camera.to_world);
    assert_same_xform(&a->light.to_world, &b->light.to_world);
    assert_true(a->light.scale == b->light.scale && a->view.camera.fov_deg == b->view.camera.fov_deg);
    assert_string_equal(a->light.filename, b->light.filename);
    assert_int_equal(a->view.film.width, b->view.film.width);
    assert_int_equal(a->view.sampler.spp, b->view.sampler.spp);
    assert_int_equal(a->n_shapes, 4);
    assert_int_equal(b->n_shapes, 4);
    for (size_t i = 0; i < 4; i++) {
        const bis_material *m = &a->materials[a->shapes[i].material], *n = &b->materials[b->shapes[i].material];
        assert_int_equal(a->shapes[i].kind, b->shapes[i].kind);
        assert_same_xform(&a->shapes[i].to_world, &b->shapes[i].to_world);
        assert_true(m->Kd.r == n->Kd.r && m->Kd.b == n->Kd.b && m->Ks.g == n->Ks.g && m->exponent == n->exponent);
    }
    bis_scene_desc_free(a);
    bis_scene_desc_free(b);
}

/* ---- robustness ---- */

/* As `bis --integrator NAME`: a scene that has it all written out says the same. */
static void another_integrator_brings_its_defaults_and_the_scenes_own_keeps_its_settings(void **state)
{
    static const struct { const char *scene, *name, *written_out; bool keeps; } cases[] = {
        {"Integrator \"em\" \"integer samples\" 7", "em", "Integrator \"em\" \"integer samples\" 7", true},
        {"Integrator \"em\" \"integer samples\" 7", "brdf", "Integrator \"brdf\" \"integer samples\" 16", false},
        {"", "sir", "Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 15 \"bool learn\" false "
         "\"string proposal\" \"mix\"", false},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, "Option \"string asprinted\" \"E6\" %s", cases[i].scene);
        bis_scene_desc *d = good_scene(text, ""), *written_out = good_scene(cases[i].written_out, "");
        assert_int_equal(d->view.settings.as_printed, BIS_E6);
        bis_scene_name_integrator(d, bis_integrator_find(cases[i].name), (bis_loc){"here", 77, 5});
        assert_true(bis_settings_equal(&d->view.settings, &written_out->view.settings));
        assert_int_equal(d->view.settings.as_printed, BIS_E6);
        assert_int_equal(d->integrator_loc.line == 77, !cases[i].keeps);
        bis_scene_desc_free(d);
        bis_scene_desc_free(written_out);
    }
}

/* What the real user may not read, as the superuser (root) may read anything. */
static void a_file_that_may_not_be_read_is_no_missing_one(void **state)
{
    static const char text[] = "WorldBegin\nLightSource \"infinite\" \"string filename\" \"%s\"";
    char scene[200];
    bis_scene_desc *d;
    bis_diag diag;
    const bool root = getuid() == 0;
    snprintf(scene, sizeof scene, text, strrchr(scratch("locked.hdr"), '/') + 1);
    store(scratch("locked.hdr"), "#?", 2);
    assert_int_equal(chmod(scratch("locked.hdr"), 0), 0);
    if (root) assert_int_equal(setreuid(65534, (uid_t)-1), 0);
    const bis_status status = parse_text(&d, &diag, scene);
    if (root) assert_int_equal(setreuid(0, (uid_t)-1), 0);
    assert_int_equal(status, BIS_IO);
    assert_non_null(strstr(diag.messages[0].text, "locked.hdr\": Permission denied"));
    bis_diag_clear(&diag);
}

static void a_german_locale_changes_no_number(void **state)
{
    if (!setlocale(LC_ALL, "de_DE.UTF-8") && !setlocale(LC_ALL, "de_DE.utf8")) {
        print_message("skipped: no locale de_DE.UTF-8 here\n");
        skip();
    }
    bis_scene_desc *d = good_scene("Camera \"perspective\" \"float fov\" 45.5", "");
    setlocale(LC_ALL, "C");
    assert_true(d->view.camera.fov_deg == 45.5);
    bis_scene_desc_free(d);
}

/* Any byte changed, left out or doubled: a status, and no crash, hang or leak (the sanitizers watch). */
static void damaged_scenes_are_survived(void **state)
{
    unsigned char *text;
    size_t size;
    unsigned x = 1;
    assert_int_equal(bis_file_read(&text, &size, "tests/data/scenes/pbrt-v3.txt", (bis_loc){0}, NULL), BIS_OK);
    char *damaged = calloc(size + 2, 1);
    for (int round = 0; round < 2000; round++) {
        memcpy(damaged, text, size);
        size_t n = size;
        for (int i = 0; i < 1 + round % 4; i++) {
            size_t at = (x = x * 1664525u + 1013904223u) % size;
            unsigned how = (x >> 13) % 4;
            if (how == 0) damaged[at] = (char)(x >> 24);
            if (how == 1) damaged[at] = "[]\"#-. 9e\\"[(x >> 20) % 10];
            if (how == 2) n = at;
            const size_t gap = (x >> 24) % 32 % (size - at);
            if (how == 3) memmove(damaged + at, damaged + at + gap, size - at - gap);
        }
        bis_scene_desc *d;
        bis_diag diag = {0};
        store(scratch("damaged.txt"), damaged, n);
        bis_status status = bis_scene_parse(&d, scratch("damaged.txt"), &diag);
        assert_true((status == BIS_OK) == (d != NULL));
        bis_scene_desc_free(d);
        bis_diag_clear(&diag);
    }
    free(damaged);
    bis_free(text);
}

/* A text repeated n times between head and tail, parsed; returns the first message, in buf. */
static const char *repeated(char buf[256], const char *head, const char *unit, size_t n, const char *tail)
{
    const size_t length = strlen(unit);
    char *text = malloc(strlen(head) + n * length + strlen(tail) + 1), *out = text;
    out += sprintf(out, "%s", head);
    for (size_t i = 0; i < n; i++, out += length) memcpy(out, unit, length);
    strcpy(out, tail);
    bis_scene_desc *d;
    bis_diag diag;
    parse_text(&d, &diag, text);
    snprintf(buf, 256, "%s", diag.n ? diag.messages[0].text : "");
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
    free(text);
    return buf;
}

/* What follows the fiftieth error is not read. */
static void a_scene_is_read_to_its_fiftieth_error(void **state)
{
    for (int n = 49; n <= 52; n++) {
        char text[4096] = "WorldBegin LightSource \"infinite\"\n";
        bis_scene_desc *d;
        bis_diag diag;
        for (int k = 0; k < n; k++)
            snprintf(text + strlen(text), sizeof text - strlen(text), "Xword%c%c\n", 'a' + k / 26, 'a' + k % 26);
        assert_int_equal(parse_text(&d, &diag, text), BIS_INPUT);
        assert_int_equal(diag.n, n < 50 ? n : 51);
        assert_int_equal(strstr(diag.messages[diag.n - 1].text, "stopped after 50 errors") != NULL, n >= 50);
        bis_diag_clear(&diag);
    }
}

static void limits_are_errors_and_not_exhausted_memory(void **state)
{
    char buf[256];
    assert_non_null(strstr(repeated(buf, "WorldBegin ", "AttributeBegin ", 4097, ""), "blocks nest deeper than 4096"));
    assert_non_null(strstr(repeated(buf, "WorldBegin ", "AttributeBegin ", 4096, ""), "AttributeBegin has no "));
    char *objects = malloc(200000);
    char *out = objects + sprintf(objects, "WorldBegin ObjectBegin \"o\" ");
    for (int i = 0; i < 5000; i++) out += sprintf(out, "Shape \"sphere\" ");
    strcpy(out, "ObjectEnd ");
    /* the 5000 of the object and 208 times as many leave 3576 of 2^20 */
    for (int i = 0; i < 208; i++) strcat(objects, "ObjectInstance \"o\" ");
    assert_non_null(strstr(repeated(buf, objects, "Shape \"sphere\" ", 3577, ""), ": error: more than 1048576 shapes"));
    assert_null(strstr(repeated(buf, objects, "Shape \"sphere\" ", 3576, ""), "more than"));
    free(objects);
}

/* Each file includes the next one twice: 2^40 files in all. */
static void includes_that_double_are_stopped(void **state)
{
    char first[128];
    bis_scene_desc *d;
    bis_diag diag = {0};
    snprintf(first, sizeof first, "%s", scratch("double0.txt"));
    for (int i = 0; i < 40; i++) {
        char name[32], text[256];
        snprintf(name, sizeof name, "double%d.txt", i + 1);
        const char *next = strrchr(scratch(name), '/') + 1;
        int n = snprintf(text, sizeof text, "Include \"%s\" Include \"%s\"", next, next);
        snprintf(name, sizeof name, "double%d.txt", i);
        store(scratch(name), text, i < 39 ? (size_t)n : 0);
    }
    assert_int_equal(bis_scene_parse(&d, first, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "more than 100000 Includes"));
    bis_diag_clear(&diag);
}

/* A text in the place of a file has the name that is given. */
static void a_text_is_parsed_as_a_file_of_that_name(void **state)
{
    bis_scene_desc *d;
    bis_diag diag = {0};
    assert_int_equal(bis_scene_parse_text(&d, "some/here.txt", "WorldBegin LightSource \"infinite\"\nShape \"disk\"", 0,
                                          &diag), BIS_OK);
    assert_true(d->n_shapes == 1 && diag.n == 0 && strcmp(d->files[0], "some/here.txt") == 0);
    assert_true(strcmp(d->shapes[0].loc.file, "some/here.txt") == 0 && d->shapes[0].loc.line == 2);
    bis_scene_desc_free(d);
    assert_int_equal(bis_scene_parse_text(&d, "some/here.txt", "WorldBegin\n LightSource 3", 0, &diag), BIS_INPUT);
    assert_string_equal(diag.messages[0].text,
                        "some/here.txt:2:14: error: LightSource wants a quoted name, found \"3\"");
    assert_null(d);
    bis_diag_clear(&diag);
}

/* What is no scene is told with what it is, as the scene itself and as a part of one. */
static void a_file_that_is_no_scene_is_told_what_it_is_for(void **state)
{
    static const char *const cases[][3] = {
        {"s.pfm", "PF\n1 1\n-1\n", "a PFM image"}, {"s.x", "ply\nformat ascii 1.0\n", "a PLY mesh"},
        {"s.obj", "v 0 0 0\n", "a Wavefront mesh"}, {"s.y", "{}", "a file in JSON"},
        {"s.x", "#?RADIANCE", "a Radiance map"}, {"s.x", "#?RGBE", "a Radiance map"},
        {"s.x", "\x76\x2f\x31\x01", "an OpenEXR image"}, {"s.x", "\x89PNG", "a PNG picture"},
        {"s.x", "\xff\xd8\xff", "a JPEG picture"}, {"s.x", "<", "a page or scene in XML or HTML"},
        {"s.mtl", "newmtl a", "the materials of a Wavefront mesh"}, {"s.csv", "1", "a table"}};
    for (size_t i = 0; i < BIS_COUNT(cases); i++) {
        char path[128], text[800];
        bis_scene_desc *d;
        bis_diag diag = {0};
        snprintf(path, sizeof path, "%s", scratch(cases[i][0]));
        store(path, cases[i][1], strlen(cases[i][1]));
        assert_int_equal(bis_scene_parse(&d, path, &diag), BIS_INPUT);
        assert_true(diag.n == 1 && strstr(diag.messages[0].text, cases[i][2]));
        bis_diag_clear(&diag);
        snprintf(text, sizeof text, "WorldBegin LightSource \"infinite\" Include \"%s\" Shape \"cub\"",
                 strrchr(path, '/') + 1);
        assert_int_equal(parse_text(&d, &diag, text), BIS_INPUT);
        assert_true(diag.n == 2 && strstr(diag.messages[0].text, cases[i][2])); /* what follows is read as ever */
        bis_diag_clear(&diag);
    }
}

/* ---- the user's reference ---- */

/* Every block that is fenced as ```pbrt in docs/scene-format.md. One without WorldBegin is a part: it is tried on both
 * sides of one. */
static void check_example(const char *text, size_t n)
{
    char scene[8192];
    bis_scene_desc *d;
    bis_diag diag = {0};
    const char *part = memmem(text, n, "WorldBegin", 10)       ? "%.*s"
                       : memmem(text, n, "# in the world", 14) ? "WorldBegin\n%.*s\n"
                                                               : "%.*s\nWorldBegin\n";
    assert_true(n + 64 < sizeof scene);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    snprintf(scene, sizeof scene, part, (int)n, text);
#pragma GCC diagnostic pop
    store("build/scratch/example.txt", scene, strlen(scene));
    bis_status status = bis_scene_parse(&d, "build/scratch/example.txt", &diag);
    for (size_t i = 0; i < diag.n && status; i++) print_error("%s\n%.*s", diag.messages[i].text, (int)n, text);
    assert_int_equal(status, BIS_OK);
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
}

static void every_example_of_the_reference_is_a_scene(void **state)
{
    static const char fence[] = "```pbrt\n";
    unsigned char *page;
    size_t size;
    int n = 0;
    assert_int_equal(bis_file_read(&page, &size, "docs/scene-format.md", (bis_loc){0}, NULL), BIS_OK);
    /* the files that the examples name */
    static const char *const names[] = {"map.exr", "probe.hdr", "dragon.ply", "teapot.obj", "materials.txt"};
    scratch("x");
    for (size_t i = 0; i < BIS_COUNT(names); i++) {
        char path[64];
        snprintf(path, sizeof path, "build/scratch/%s", names[i]);
        store(path, "# nothing\n", 10);
    }
    for (const char *at = strstr((const char *)page, fence); at; at = strstr(at, fence)) {
        at += strlen(fence);
        const char *end = strstr(at, "```");
        assert_non_null(end);
        check_example(at, (size_t)(end - at));
        at = end;
        n++;
    }
    assert_true(n >= 20);
    bis_free(page);
}

static const expect_word words[] = {{"parse", parse}, {NULL, NULL}};

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_that_cannot_be_read_is_the_disks_fault),
        cmocka_unit_test(each_line_has_its_messages),
        cmocka_unit_test(a_scene_is_read_to_its_fiftieth_error),
        cmocka_unit_test(a_file_that_is_no_scene_is_told_what_it_is_for),
        cmocka_unit_test(each_name_of_pbrts_is_known),
        cmocka_unit_test(an_empty_world_has_the_defaults_of_the_contract_E39),
        cmocka_unit_test(a_sampler_alone_leaves_the_integrator_to_us),
        cmocka_unit_test(an_integrator_alone_has_the_settings_of_the_thesis_and_leaves_the_sampler_to_us),
        cmocka_unit_test(an_integrator_of_pbrt_is_none),
        cmocka_unit_test(coefficients_of_figure_5_5_s_text_are_warned_of_and_its_captions_are_not_E38),
        cmocka_unit_test(every_parameter_before_the_world_arrives),
        cmocka_unit_test(a_film_has_the_layers_that_are_named),
        cmocka_unit_test(errata_are_switched_by_their_names),
        cmocka_unit_test(every_parameter_of_the_other_integrators_arrives),
        cmocka_unit_test(each_parameter_of_a_light_changes_itself_alone),
        cmocka_unit_test(equal_lights_are_one_with_several_portals),
        cmocka_unit_test(spp_alone_is_divided_as_squarely_as_possible),
        cmocka_unit_test(a_directive_given_again_starts_from_the_defaults),
        cmocka_unit_test(what_a_scene_has_once_is_told_when_it_comes_again),
        cmocka_unit_test(transformations_multiply_from_the_right),
        cmocka_unit_test(the_coordinate_system_camera_maps_camera_space_to_the_world),
        cmocka_unit_test(blocks_restore_what_they_saved),
        cmocka_unit_test(instances_put_their_transformation_before_the_objects),
        cmocka_unit_test(a_file_that_is_read_in_other_ways_is_other_meshes),
        cmocka_unit_test(a_named_material_may_be_used_before_it_is_made),
        cmocka_unit_test(triangles_arrive_with_points_indices_and_normals),
        cmocka_unit_test(a_light_frame_may_be_rotated_and_mirrored_and_is_made_exactly_orthonormal),
        cmocka_unit_test(a_scene_in_pbrt_v3_and_in_v4_spelling_is_the_same_scene_and_gives_no_message),
        cmocka_unit_test(another_integrator_brings_its_defaults_and_the_scenes_own_keeps_its_settings),
        cmocka_unit_test(a_file_that_may_not_be_read_is_no_missing_one),
        cmocka_unit_test(a_german_locale_changes_no_number),
        cmocka_unit_test(damaged_scenes_are_survived),
        cmocka_unit_test(limits_are_errors_and_not_exhausted_memory),
        cmocka_unit_test(includes_that_double_are_stopped),
        cmocka_unit_test(a_text_is_parsed_as_a_file_of_that_name),
        cmocka_unit_test(every_example_of_the_reference_is_a_scene),
    };
    return expect_run("parser", tests, sizeof tests / sizeof *tests, NULL, scratch_remove,
                      &(expect_folder){"tests/data/bad", words, NULL});
}
