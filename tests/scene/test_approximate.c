/* SPDX-License-Identifier: BSD-2-Clause */
/* approximate: what pbrt has and bis has not: an error that says what --approximate would do, and with it the nearest
 * that bis has, noted once for each kind. Numbers are worked out by hand. */
#include "bis/scene/scene.h"

#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "image_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A scene that names no light gets a constant one, so that its sky is not one more replacement. */
static bis_status parse(bis_scene_desc **d, const char *scene, unsigned how, bis_diag *diag)
{
    char text[4096];
    const char *world = strstr(scene, "\"infinite\"") ? NULL : strstr(scene, "WorldBegin");
    const size_t n = world ? (size_t)(world - scene) + strlen("WorldBegin") : 0;
    snprintf(text, sizeof text, "%.*s%s%s", (int)n, scene, world ? " LightSource \"infinite\"" : "", scene + n);
    store(scratch("scene.txt"), text, strlen(text));
    return bis_scene_parse_as(d, scratch("scene.txt"), how, diag);
}

/* The scene with --approximate; all that is said is a warning. */
static bis_scene_desc *approximated(const char *text)
{
    bis_scene_desc *d;
    bis_diag diag = {0};
    const bis_status status = parse(&d, text, BIS_PARSE_APPROXIMATE, &diag);
    if (status) print_message("%s", diag.messages[0].text);
    assert_int_equal(status, BIS_OK);
    for (size_t i = 0, n = 0; i < diag.n; i++) {
        if (!strstr(diag.messages[i].text, "warning: approximated: ")) continue;
        assert_true(n < d->n_approximations && strstr(diag.messages[i].text, d->approximations[n].kind));
        n++;
    }
    bis_diag_clear(&diag);
    return d;
}

static const struct row {
    const char *scene, *kind;
    bool is_error; /* without --approximate; else a warning, as ever */
} rows[] = {
    {"WorldBegin Material \"dielectric\" \"float eta\" 1.3", "Material \"dielectric\"", true},
    {"WorldBegin Material \"thindielectric\"", "Material \"thindielectric\"", true},
    {"WorldBegin Material \"glass\" \"rgb Kt\" [1 1 1]", "Material \"glass\"", true},
    {"WorldBegin Material \"mirror\"", "Material \"mirror\"", true},
    {"WorldBegin Material \"shinymetal\"", "Material \"shinymetal\"", true},
    {"WorldBegin Material \"coatedconductor\"", "Material \"coatedconductor\"", true},
    {"WorldBegin Material \"disney\" \"rgb color\" [1 0 0]", "Material \"disney\"", true},
    {"WorldBegin Material \"diffusetransmission\"", "Material \"diffusetransmission\"", true},
    {"WorldBegin Material \"translucent\"", "Material \"translucent\"", true},
    {"WorldBegin Material \"subsurface\" \"string name\" \"Skin1\"", "Material \"subsurface\"", true},
    {"WorldBegin Material \"kdsubsurface\"", "Material \"kdsubsurface\"", true},
    {"WorldBegin Material \"measured\" \"string filename\" \"a.bsdf\"", "Material \"measured\"", true},
    {"WorldBegin Material \"fourier\" \"string bsdffile\" \"a.bsdf\"", "Material \"fourier\"", true},
    {"WorldBegin Material \"hair\" \"float eumelanin\" 1.3", "Material \"hair\"", true},
    {"WorldBegin Material \"none\"", "Material \"none\"", true},
    {"WorldBegin Material \"\"", "Material \"\"", true},
    {"WorldBegin Material \"interface\"", "Material \"interface\"", true},
    {"WorldBegin AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\"", "AreaLightSource", true},
    {"WorldBegin LightSource \"point\" \"rgb I\" [1 1 1]", "LightSource \"point\"", true},
    {"WorldBegin LightSource \"spot\"", "LightSource \"spot\"", true},
    {"WorldBegin LightSource \"distant\"", "LightSource \"distant\"", true},
    {"WorldBegin LightSource \"goniometric\" \"string filename\" \"a.exr\"", "LightSource \"goniometric\"", true},
    {"WorldBegin LightSource \"projection\"", "LightSource \"projection\"", true},
    {"WorldBegin LightSource \"infinite\" LightSource \"infinite\"", "LightSource \"a second\"", true},
    {"WorldBegin MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"", "MakeNamedMedium", true},
    {"WorldBegin MediumInterface \"fog\" \"\"", "MediumInterface", true},
    {"WorldBegin Volume \"homogeneous\"", "Volume", true},
    {"WorldBegin ActiveTransform All Shape \"sphere\"", "ActiveTransform", true},
    {"TransformTimes 0 1 WorldBegin", "TransformTimes", true},
    {"WorldBegin Attribute \"shape\" \"float radius\" 2", "Attribute", true},
    {"SurfaceIntegrator \"path\" \"integer maxdepth\" 5 WorldBegin", "SurfaceIntegrator \"path\"", true},
    {"Integrator \"path\" \"integer maxdepth\" 5 WorldBegin", "Integrator \"path\"", false},
    {"Camera \"realistic\" WorldBegin", "Camera \"realistic\"", true},
    {"WorldBegin NamedMaterial \"gold\" Shape \"sphere\"", "NamedMaterial \"gold\", which is not made anywhere", true},
    {"WorldBegin Material \"diffuse\" \"texture reflectance\" \"t\"", "a texture that is not defined", true},
    {"WorldBegin ObjectInstance \"o\"", "ObjectInstance of an object that is not defined", true},
    {"WorldBegin AttributeEnd", "AttributeEnd without AttributeBegin", true},
    {"WorldBegin AttributeBegin", "AttributeBegin has no AttributeEnd", true},
    {"WorldBegin LightSource \"infinite\" \"spectrum L\" \"stdillum-A\"", "an illuminant that is not D65", true},
    {"VolumeIntegrator \"emission\" WorldBegin", "VolumeIntegrator", true},
    {"Renderer \"sampler\" WorldBegin", "Renderer", true},
    {"SearchPath \"/tmp\" WorldBegin", "SearchPath", true},
    {"ColorSpace \"rec2020\" WorldBegin", "ColorSpace", true},
    {"Film \"gbuffer\" WorldBegin", "Film \"gbuffer\"", true},
    {"Film \"spectral\" WorldBegin", "Film \"spectral\"", true},
    {"Camera \"perspective\" \"float lensradius\" 0.1 WorldBegin", "\"lensradius\"", true},
    {"PixelFilter \"mitchell\" \"float B\" 0.3 WorldBegin", "PixelFilter \"mitchell\"", false},
    {"Film \"image\" Camera \"perspective\" \"float shutteropen\" 0 WorldBegin", "parameter \"shutteropen\"", false},
    {"Film \"rgb\" \"string colourspace\" \"x\" WorldBegin", "parameter \"colourspace\" of Film \"rgb\"", true},
    {"Accelerator \"grid\" \"integer splitmethod\" 3 WorldBegin", "parameter \"splitmethod\" of Accelerator \"grid\"",
     true},
    {"WorldBegin Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 1 1 0 2 1 0]", "Shape \"curve\"", true},
    {"WorldBegin Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1] \"integer indices\" [0 1 2 0 1 3]",
     "Shape \"loopsubdiv\" whose triangles do not form surfaces", true},
    {"WorldBegin Shape \"sphere\" \"float zmin\" 2", "a shape without extent", true},
    {"WorldBegin Material \"conductor\" \"float uroughness\" 0.01 \"float vroughness\" 0.16",
     "\"uroughness\" and \"vroughness\" that differ", true},
    {"WorldBegin Material \"matte\" \"float sigma\" 20", "\"sigma\"", true},
    {"WorldBegin Material \"uber\" \"rgb Kr\" [.1 .1 .1]", "\"Kr\" of Material \"uber\"", true},
    {"WorldBegin Material \"uber\" \"rgb Kt\" [0 .1 0]", "\"Kt\" of Material \"uber\"", true},
    {"WorldBegin Material \"uber\" \"rgb opacity\" [1 1 .5]", "\"opacity\" of Material \"uber\"", true},
    {"WorldBegin Material \"coateddiffuse\" \"rgb albedo\" [0 .1 0]", "\"albedo\" of Material \"coateddiffuse\"", true},
    {"WorldBegin Material \"conductor\" \"spectrum eta\" \"metal-Ti-eta\" \"spectrum k\" \"metal-Ti-k\"",
     "\"metal-Ti-eta\"", true},
    {"WorldBegin Material \"conductor\" \"rgb eta\" [1 1 1] \"spectrum k\" \"metal-CuZn-k\"", "\"metal-CuZn-k\"", true},
    {"WorldBegin Texture \"t\" \"float\" \"directionmix\" \"vector3 dir\" [0 0 1]", "Texture \"directionmix\"", true},
    {"WorldBegin Texture \"t\" \"spectrum\" \"ptex\" \"string filename\" \"no.ptx\"", "Texture \"ptex\"", true},
    {"WorldBegin Material \"zzz\" \"float gloss\" 1", "unknown Material \"zzz\"", true},
    {"WorldBegin Shape \"zzz\"", "unknown Shape \"zzz\"", true},
    {"WorldBegin LightSource \"zzz\"", "unknown LightSource \"zzz\"", true},
    {"WorldBegin Texture \"t\" \"float\" \"zzz\"", "unknown Texture \"zzz\"", true},
    {"Camera \"zzz\" WorldBegin", "unknown Camera \"zzz\"", true},
    {"Sampler \"zzz\" WorldBegin", "unknown Sampler \"zzz\"", true},
    {"Film \"zzz\" WorldBegin", "unknown Film \"zzz\"", true},
    {"Accelerator \"zzz\" WorldBegin", "unknown Accelerator \"zzz\"", true},
    {"WorldBegin Shape \"sphere\" \"float radius\" [1 2]", "\"radius\" of 2 values", true},
    {"WorldBegin Shape \"sphere\" \"float radius\" 1 \"float radius\" 2", "\"radius\" given twice", false},
    {"WorldBegin Material \"phong\" \"float Kd\" 2", "\"Kd\" out of its range", true},
    {"WorldBegin Texture \"t\" \"float\" \"bilerp\" \"string mapping\" \"x\"", "\"mapping\" that is \"x\"",
     true},
    {"WorldBegin Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"no.png\"",
     "an image that is not there", true},
    {"WorldBegin Material \"matte\" \"string normalmap\" \"n\"", "a normal map that is not there", true},
    {"WorldBegin TransformEnd", "TransformEnd without TransformBegin", true},
    {"WorldBegin ObjectBegin \"o\"", "ObjectBegin has no ObjectEnd", true},
    {"WorldBegin ObjectBegin \"o\" ObjectEnd ObjectBegin \"o\" ObjectEnd", "an object defined again", false},
    {"WorldBegin Texture \"t\" \"spectrum\" \"bilerp\"\nMaterial \"phong\" \"texture exponent\" \"t\"",
     "a texture of colours in place of numbers", true},
    {"WorldBegin MakeNamedMaterial \"m\" \"string type\" \"matte\" MakeNamedMaterial \"m\" \"string type\" \"matte\"",
     "a material made again", true},
};

static void each_kind_is_an_error_with_its_way_out_and_is_noted_with_approximate(void **state)
{
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const struct row *r = &rows[i];
        bis_scene_desc *d;
        bis_diag diag = {0};
        const bis_status status = parse(&d, r->scene, 0, &diag);
        if (status != (r->is_error ? BIS_INPUT : BIS_OK)) fail_msg("%s: status %d", r->scene, (int)status);
        if (!status) assert_true(d->n_approximations == 0);
        bis_scene_desc_free(d);
        char *said = diag.n_errors ? strstr(diag.messages[0].text, "; with --approximate: ") : NULL;
        char consequence[200] = "";
        if (said) snprintf(consequence, sizeof consequence, "%s", said + strlen("; with --approximate: "));
        bis_diag_clear(&diag);

        d = approximated(r->scene);
        if (d->n_approximations != 1 || strcmp(d->approximations[0].kind, r->kind) != 0)
            fail_msg("%s: %zu kinds, the first %s", r->scene, d->n_approximations, d->approximations[0].kind);
        assert_int_equal(d->approximations[0].n, 1);
        if (said && !strstr(d->approximations[0].consequence, consequence)) fail_msg("%s: %s", r->scene, consequence);
        if (r->is_error && !said) fail_msg("%s: no way out", r->scene);
        bis_scene_desc_free(d);
    }
}

/* What each does to the picture, and what there are others of: the light that `parse` adds is one of the lights. */
static const struct { const char *scene; bis_effect effect; const char *among; size_t of; } effects[] = {
    {"WorldBegin AreaLightSource \"diffuse\" Shape \"sphere\"", BIS_EFFECT_LIGHT, "lights", 2},
    {"WorldBegin LightSource \"lamp\"", BIS_EFFECT_LIGHT, "lights", 2},
    {"WorldBegin Shape \"disk\" Shape \"curve\" Shape \"sphere\"", BIS_EFFECT_SHAPE, "shapes", 3},
    {"WorldBegin Shape \"sphere\" \"float alpha\" 0.5", BIS_EFFECT_SHAPE, "shapes", 1},
    {"WorldBegin Material \"glass\" Material \"matte\"", BIS_EFFECT_MATERIAL, "materials", 2},
    {"WorldBegin NamedMaterial \"gold\" Shape \"sphere\"", BIS_EFFECT_MATERIAL, NULL, 0},
    {"WorldBegin Texture \"t\" \"float\" \"constant\" Texture \"u\" \"float\" \"ptex\"", BIS_EFFECT_TEXTURE, "textures",
     2},
    {"WorldBegin ObjectInstance \"o\"", BIS_EFFECT_SHAPE, NULL, 0},
    {"WorldBegin MediumInterface \"fog\" \"\"", BIS_EFFECT_SHAPE, NULL, 0},
    {"Camera \"realistic\" WorldBegin", BIS_EFFECT_SETTING, NULL, 0},
    {"WorldBegin Shape \"sphere\" \"float size\" 1", BIS_EFFECT_SETTING, NULL, 0}, /* the sphere is there */
    {"Integrator \"bdpt\" WorldBegin", BIS_EFFECT_INDIRECT, NULL, 0},
    {"Integrator \"directlighting\" WorldBegin", BIS_EFFECT_INDIRECT, NULL, 0},
    {"Integrator \"ao\" WorldBegin", BIS_EFFECT_SETTING, NULL, 0},
};

static void each_replacement_has_its_effect_and_its_share(void **state)
{
    for (size_t i = 0; i < sizeof effects / sizeof *effects; i++) {
        bis_scene_desc *d = approximated(effects[i].scene);
        const bis_approximation *a = d->approximations;
        assert_int_equal(d->n_approximations, 1);
        if (a->effect != effects[i].effect || a->n != 1 || a->of != effects[i].of || !a->among != !effects[i].among)
            fail_msg("%s: effect %d, %zu of %zu", effects[i].scene, (int)a->effect, a->n, a->of);
        if (a->among) assert_string_equal(a->among, effects[i].among);
        bis_scene_desc_free(d);
    }
}

/* A value beyond an end of its range becomes that end, each number of a list by itself; the others stay. */
static void what_is_out_of_its_range_becomes_its_end(void **state)
{
    bis_scene_desc *d = approximated(
        "Film \"rgb\" \"integer xresolution\" 0 \"integer yresolution\" 40000 \"float cropwindow\" [-1 0.5 0.25 3]\n"
        "Sampler \"sobol\" \"integer pixelsamples\" 0 \"float edgelight\" 7 \"integer edgesamples\" 5000 \"integer "
        "seed\" -3\nIntegrator \"mis\" \"float split\" -1\nAccelerator \"grid\" \"float density\" 200\n"
        "WorldBegin LightSource \"infinite\" \"rgb L\" [-1 2 3] \"integer levels\" 999 \"float areaexponent\" 11 "
        "\"integer width\" 1\nMaterial \"phong\" \"rgb Kd\" [2 -1 0.25] \"float Ks\" -3 \"float exponent\" -1 "
        "Shape \"sphere\"");
    const bis_film_desc *f = &d->view.film;
    const bis_material *m = &d->materials[d->shapes[0].material];
    assert_true(f->width == 1 && f->height == 32768);
    assert_true(f->crop[0] == 0 && f->crop[1] == 0.5 && f->crop[2] == 0.25 && f->crop[3] == 1);
    assert_true(d->view.sampler.spp == 1 && d->view.edge_light == 1 && d->view.edge_samples == 1024 &&
                d->view.sampler.seed == 0);
    assert_true(d->view.settings.integrator == &bis_mis && d->view.settings.split == 0 && d->accel.density == 100);
    assert_true(d->light.L.r == 0 && d->light.L.g == 2 && d->light.L.b == 3 && d->light.levels == 254 &&
                d->light.area_exponent == 10 && d->light.width == 2);
    assert_true(m->Kd.r == 1 && m->Kd.g == 0 && m->Kd.b == 0.25f && m->Ks.g == 0 && m->exponent == 0);
    assert_int_equal(d->n_approximations, 16);
    for (size_t i = 0; i < 16; i++) {
        const bis_approximation *a = &d->approximations[i];
        assert_int_equal(a->n, strstr(a->kind, "cropwindow") || strstr(a->kind, "Kd") ? 2 : 1);
        assert_string_equal(a->consequence, "the nearest value that it may have");
    }
    bis_scene_desc_free(d);
}

/* Where bis asks for a number or a colour a texture is its mean, of colours the mean of the channels for a number. */
static void a_texture_is_its_mean_where_a_value_is_asked_for(void **state)
{
    static const char head[] = "WorldBegin Texture \"f\" \"float\" \"constant\" \"float value\" 0.5 "
        "Texture \"c\" \"spectrum\" \"constant\" \"rgb value\" [0.25 0.5 1.5] "
        "Texture \"v\" \"float\" \"bilerp\" \"float v00\" 1 ";
    static const struct { const char *words; double radius, L[3]; size_t n; } cases[] = {
        {"LightSource \"infinite\" Shape \"sphere\" \"texture radius\" \"f\"", .5, {1, 1, 1}, 0},
        {"LightSource \"infinite\" Shape \"sphere\" \"texture radius\" \"c\"", .75, {1, 1, 1}, 0},
        {"LightSource \"infinite\" Shape \"sphere\" \"texture radius\" \"v\"", .75, {1, 1, 1}, 1},
        {"LightSource \"infinite\" Shape \"sphere\" \"texture radius\" \"no\"", 1, {1, 1, 1}, 2},
        {"LightSource \"infinite\" \"texture L\" \"c\" Shape \"sphere\"", 1, {.25, .5, 1.5}, 0},
        {"LightSource \"infinite\" \"texture scale\" \"c\" \"rgb L\" [2 2 4] Shape \"sphere\"", 1, {.5, 1, 6}, 0},
        {"LightSource \"infinite\" \"spectrum scale\" [400 .5 700 .5] \"rgb L\" [2 2 4] Shape \"sphere\"", 1, {1, 1, 2},
         0},
        {"LightSource \"infinite\" \"xyz scale\" [.475235 .5 .544415] \"rgb L\" [2 2 4] Shape \"sphere\"", 1, {1, 1, 2},
         0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        snprintf(text, sizeof text, "%s%s", head, cases[i].words);
        bis_scene_desc *d = approximated(text);
        const bis_light_desc *l = &d->light;
        const double L[3] = {(double)l->L.r * l->scale, (double)l->L.g * l->scale, (double)l->L.b * l->scale};
        assert_int_equal(d->n_approximations, cases[i].n);
        if (fabs(d->shapes[0].radius - cases[i].radius) > 1e-6) fail_msg("%s: %g", text, d->shapes[0].radius);
        for (int k = 0; k < 3; k++)
            if (fabs(L[k] - cases[i].L[k]) > 1e-4) fail_msg("%s: %d: %g", text, k, L[k]);
        bis_scene_desc_free(d);
    }
    /* each channel of a mean is cut off to [0, 1] */
    bis_scene_desc *cut = approximated("WorldBegin Texture \"c\" \"spectrum\" \"constant\" \"rgb value\" [1.5 -1 0.25] "
                                       "Material \"mirror\" \"texture Kr\" \"c\" Shape \"sphere\"");
    const rgb Ks = cut->materials[cut->shapes[0].material].Ks;
    assert_true(Ks.r == 1 && Ks.g == 0 && Ks.b == .25f);
    bis_scene_desc_free(cut);
}

/* A texture with a part that is not there is one grey, whichever part it is; with all parts it is what it is. */
static void a_texture_without_a_part_is_grey(void **state)
{
    static const char *const kinds[][6] = {
        {"\"mix\"", "tex1", "tex2", "amount"}, {"\"scale\"", "tex1", "tex2"}, {"\"scale\"", "tex", "scale"},
        {"\"checkerboard\" \"string aamode\" \"none\"", "tex1", "tex2"},
        {"\"checkerboard\" \"integer dimension\" 3", "tex1", "tex2"}, {"\"dots\"", "inside", "outside"},
        {"\"bilerp\"", "v00", "v01", "v10", "v11"}, {"\"constant\"", "value"},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        for (int gone = 0; gone < 5 && (!gone || kinds[i][gone]); gone++) { /* 0: none is missing */
            char text[1024];
            size_t n = (size_t)snprintf(text, sizeof text, "WorldBegin Texture \"f\" \"float\" \"bilerp\"\n"
                                        "Texture \"t\" \"float\" %s", kinds[i][0]);
            for (int k = 1; k < 5 && kinds[i][k]; k++)
                n += (size_t)snprintf(text + n, sizeof text - n, " \"texture %s\" \"%s\"", kinds[i][k],
                                      k == gone ? "no" : "f");
            bis_scene_desc *d = approximated(text);
            const bis_texture *x = &d->textures.list[d->textures.n - 1];
            assert_int_equal(d->n_approximations, gone > 0);
            if (gone && (x->kind != BIS_TEXTURE_CONSTANT || x->value.r != .5 || x->value.g != .5 || x->value.b != .5))
                fail_msg("%s: kind %d, %g", text, (int)x->kind, x->value.r);
            if (!gone && i < 7) assert_true(x->kind != BIS_TEXTURE_CONSTANT && x->steps > 5);
            bis_scene_desc_free(d);
        }
}

static void a_scene_may_say_it_itself(void **state)
{
    bis_scene_desc *d;
    assert_int_equal(parse(&d, "Option \"bool approximate\" true WorldBegin Material \"glass\"", 0, NULL), BIS_OK);
    assert_int_equal(d->n_approximations, 1);
    bis_scene_desc_free(d);
    assert_int_equal(parse(&d, "Option \"bool approximate\" false WorldBegin Material \"glass\"", 0, NULL), BIS_INPUT);
    /* the command line's word stands */
    d = approximated("Option \"bool approximate\" false WorldBegin Material \"glass\"");
    bis_scene_desc_free(d);
}

/* Textures of pbrt's are one value; a solid checkerboard mixes its parts, which may be textures. */
static void textures_of_pbrts_have_the_mean_of_their_parts(void **state)
{
    static const struct { const char *texture; double r, g, b; } cases[] = {
        {"\"ptex\" \"string filename\" \"no.ptx\"", .5, .5, .5},
        {"\"directionmix\" \"rgb tex1\" 1", .5, .5, .5}, /* one value is none: 0 is mixed with 1 */
        {"\"directionmix\" \"rgb tex1\" [.2 .4 .6]", .6, .7, .8},      /* tex2: 1 */
        {"\"directionmix\" \"rgb tex2\" [.2 .4 .6]", .1, .2, .3},      /* tex1: 0 */
        {"\"directionmix\" \"texture tex1\" \"u\" \"rgb tex2\" [.5 0 .1]", .4, .3, .5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[400];
        snprintf(text, sizeof text, "WorldBegin Texture \"u\" \"spectrum\" \"constant\" \"rgb value\" [.3 .6 .9]\n"
                 "Texture \"t\" \"spectrum\" %s Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
                 cases[i].texture);
        bis_scene_desc *d;
        d = approximated(text);
        const rgb c = d->materials[d->shapes[0].material].Kd;
        if (fabs((double)c.r - cases[i].r) > 1e-6 || fabs((double)c.g - cases[i].g) > 1e-6 ||
            fabs((double)c.b - cases[i].b) > 1e-6)
            fail_msg("%s: %g %g %g", cases[i].texture, (double)c.r, (double)c.g, (double)c.b);
        for (size_t k = 0; k < d->textures.n; k++) /* one value asks no other texture */
            assert_true(d->textures.list[k].kind == BIS_TEXTURE_CONSTANT && d->textures.list[k].steps == 1);
        assert_int_equal(d->n_approximations, strstr(cases[i].texture, "tex1\" 1") ? 2 : 1);
        bis_scene_desc_free(d);
    }
}

/* Brass is gold, titanium aluminium (published colours, see test_pbrt_materials.c); a coat that scatters is a clear
 * one. */
static void unknown_metals_and_coats_are_the_nearest_known(void **state)
{
    static const struct { const char *material; double r, g, b; } cases[] = {
        {"\"conductor\" \"spectrum eta\" \"metal-CuZn-eta\" \"spectrum k\" \"metal-CuZn-k\"", 1, .782, .344},
        {"\"conductor\" \"spectrum eta\" \"metal-Ti-eta\" \"spectrum k\" \"metal-Ti-k\"", .913, .922, .924},
        {"\"metal\" \"float eta\" 1 \"spectrum k\" \"metal-Cr-k\"", .913, .922, .924},
        {"\"coateddiffuse\" \"spectrum albedo\" [400 .2 700 .3] \"float eta\" 2", 1 / 9., 1 / 9., 1 / 9.},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[300];
        snprintf(
            text, sizeof text, "WorldBegin Material %s \"float roughness\" .1 Shape \"sphere\"", cases[i].material);
        bis_scene_desc *d = approximated(text);
        const rgb c = d->materials[d->shapes[0].material].Ks;
        assert_int_equal(d->n_approximations, 1);
        assert_string_equal(d->approximations[0].consequence, i == 0  ? "gold"
                                                              : i < 3 ? "aluminium"
                                                                      : "the coat is clear");
        if (fabs((double)c.r - cases[i].r) > 1e-3 || fabs((double)c.g - cases[i].g) > 1e-3 ||
            fabs((double)c.b - cases[i].b) > 1e-3)
            fail_msg("%s: %g %g %g", cases[i].material, (double)c.r, (double)c.g, (double)c.b);
        bis_scene_desc_free(d);
    }
}

static void a_mix_of_itself_or_of_nothing_is_an_error(void **state)
{
    static const struct { const char *scene, *message; } cases[] = {
        {"WorldBegin MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"b\" \"b\"] "
         "MakeNamedMaterial \"b\" "
         "\"string type\" \"mix\" \"string materials\" [\"a\" \"a\"]", "is, by its names, a mix of itself"},
        {"WorldBegin Material \"mix\"", "needs the names of two materials"},
        {"WorldBegin Material \"mix\" \"string materials\" [\"a\"]", "needs the names of two materials"},
        {"WorldBegin Material \"mix\" \"string materials\" [\"a\" \"a\"]", "material \"a\" is not made anywhere"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_scene_desc *d;
        bis_diag diag = {0};
        assert_int_equal(parse(&d, cases[i].scene, BIS_PARSE_APPROXIMATE, &diag), BIS_INPUT);
        assert_non_null(strstr(diag.messages[0].text, cases[i].message));
        bis_diag_clear(&diag);
    }
}

static void shapes_of_an_interface_are_left_out_also_as_instances(void **state)
{
    bis_scene_desc *d = approximated(
        "WorldBegin ObjectBegin \"o\" Material \"none\" Shape \"sphere\" Material \"diffuse\" Shape \"disk\" "
        "ObjectEnd ObjectInstance \"o\" ObjectInstance \"o\" NamedMaterial \"air\" Shape \"sphere\" "
        "MakeNamedMaterial \"air\" \"string type\" \"interface\"");
    assert_int_equal(d->n_shapes, 2);
    for (int i = 0; i < 2; i++) assert_true(d->shapes[i].kind == BIS_SHAPE_DISK);
    for (size_t i = 0; i < d->n_materials; i++) assert_non_null(d->materials[i].model);
    bis_scene_desc_free(d);
}

/* The number of a name changes with its making, and what stands before keeps the one it had. */
static void a_material_made_again_counts_from_there_on(void **state)
{
#define MADE(Kd) "MakeNamedMaterial \"m\" \"string type\" \"matte\" \"rgb Kd\" " Kd " "
#define SHOWN "NamedMaterial \"m\" Shape \"sphere\" "
    static const float expected[5][3] = {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    bis_scene_desc *d = approximated("WorldBegin " MADE("[1 0 0]") SHOWN MADE("[0 1 0]") "Shape \"sphere\" " SHOWN
                                     MADE("[0 0 1]") SHOWN SHOWN);
    assert_true(d->n_shapes == 5 && d->n_approximations == 1 && d->approximations[0].n == 2);
    for (int i = 0; i < 5; i++) {
        const rgb Kd = d->materials[d->shapes[i].material].Kd;
        assert_true(Kd.r == expected[i][0] && Kd.g == expected[i][1] && Kd.b == expected[i][2]);
    }
    bis_scene_desc_free(d);
#undef MADE
#undef SHOWN
}

static void what_moves_stands_where_it_is_at_first(void **state)
{
    bis_scene_desc *d =
        approximated("WorldBegin AttributeBegin Translate 1 0 0 ActiveTransform EndTime Translate 0 5 0 Scale 2 2 2 "
                     "ActiveTransform StartTime Translate 0 0 3 ActiveTransform All Shape \"sphere\" "
                     "ActiveTransform EndTime Rotate 90 0 0 1 AttributeEnd Translate 0 7 0 Shape \"sphere\"");
    assert_int_equal(d->n_shapes, 2);
    assert_true(
        d->shapes[0].to_world.m[0][3] == 1 && d->shapes[0].to_world.m[1][3] == 0 && d->shapes[0].to_world.m[2][3] == 3);
    assert_true(d->shapes[0].to_world.m[0][0] == 1);
    assert_true(d->shapes[1].to_world.m[1][3] == 7); /* AttributeEnd ends the choice, too */
    bis_scene_desc_free(d);
}

/* The end of a motion neither flattens what stands at its start nor restores what is flat there. */
static void what_is_flat_at_the_end_alone_is_shown(void **state)
{
#define FLAT "[1 0 0 0  0 1 0 0  0 0 0 0  0 0 0 1] "
    static const struct { const char *transforms; size_t shapes; } cases[] = {
        {"ActiveTransform EndTime Scale 1 1 0 ", 1},
        {"ActiveTransform EndTime Transform " FLAT, 1},
        {"CoordinateSystem \"c\" Scale 1 1 0 ActiveTransform EndTime Identity ", 0},
        {"CoordinateSystem \"c\" Scale 1 1 0 CoordSysTransform \"c\" ", 1},
        {"Scale 1 1 0 CoordinateSystem \"c\" Identity CoordSysTransform \"c\" ", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[400];
        snprintf(text, sizeof text, "WorldBegin %sActiveTransform All Shape \"sphere\"", cases[i].transforms);
        bis_scene_desc *d = approximated(text);
        if (d->n_shapes != cases[i].shapes) fail_msg("%s: %zu shapes", cases[i].transforms, d->n_shapes);
        bis_scene_desc_free(d);
    }
#undef FLAT
}

/* As in pbrt: neither a flat space nor the choice of a motion's end outlives the options. */
static void the_world_begins_with_the_identity_of_all_transformations(void **state)
{
    static const char *const before[] = {"", "Scale 1 1 0 ", "ActiveTransform EndTime ", "Translate 9 9 9 ",
                                         "ActiveTransform EndTime Scale 0 0 0 "};
    for (size_t i = 0; i < sizeof before / sizeof *before; i++) {
        char text[200];
        snprintf(text, sizeof text, "%sWorldBegin Translate 1 2 3 Shape \"sphere\" CoordSysTransform \"world\" "
                 "Shape \"sphere\"", before[i]);
        bis_scene_desc *d = approximated(text);
        if (d->n_shapes != 2) fail_msg("%s: %zu shapes", before[i], d->n_shapes);
        for (int k = 0; k < 3; k++) {
            assert_true(d->shapes[0].to_world.m[k][3] == k + 1);
            assert_true(d->shapes[1].to_world.m[k][3] == 0);
        }
        bis_scene_desc_free(d);
    }
}

static void what_is_unknown_to_pbrt_too_stays_an_error(void **state)
{
    static const char *const scenes[] = {
        "WorldBegin Shap \"sphere\"", "WorldBegin Shape \"sphere\" \"float radius\" -1",
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\"", "Camera \"perspective\" \"float fov\" 200 WorldBegin",
        "WorldBegin Material \"matte\" \"string normalmap\" \"\"",
        "WorldBegin LightSource \"distant\" \"rgb L\" [1e30 1 1] \"float scale\" 1e30",
    };
    bis_diag diag = {0};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        bis_scene_desc *d;
        bis_diag_clear(&diag);
        assert_int_equal(parse(&d, scenes[i], BIS_PARSE_APPROXIMATE, &diag), BIS_INPUT);
    }
    assert_non_null(strstr(diag.messages[0].text, ": error: \"L\" times \"scale\" is not finite"));
    bis_diag_clear(&diag);
}

static void an_import_is_read_as_an_include(void **state)
{
    const char *shapes = "Translate 0 4 0 Shape \"sphere\"";
    char text[200];
    store(scratch("part.txt"), shapes, strlen(shapes));
    snprintf(text, sizeof text, "WorldBegin Import \"%s\" Shape \"disk\"", strrchr(scratch("part.txt"), '/') + 1);
    bis_scene_desc *d = approximated(text);
    assert_true(d->n_shapes == 2 && d->shapes[0].kind == BIS_SHAPE_SPHERE && d->n_approximations == 1);
    bis_scene_desc_free(d);
}

static void a_plan_lists_what_is_missing_each_once(void **state)
{
    bis_scene_desc *d;
    char text[20000];
    FILE *out = fmemopen(text, sizeof text, "w");
    assert_int_equal(parse(&d, "WorldBegin LightSource \"infinite\" \"string filename\" \"no.exr\" Material \"glass\" "
                               "Shape \"plymesh\" \"string filename\" \"no/a.ply\" Shape \"plymesh\" \"string "
                               "filename\" \"no/a.ply\" "
                               "\"bool smooth\" true Shape \"objmesh\" \"string filename\" \"b.obj\"",
                           BIS_PARSE_APPROXIMATE | BIS_PARSE_LIST_MISSING, NULL), BIS_OK);
    assert_int_equal(d->n_missing, 3);
    bis_scene_plan(d, out);
    fclose(out);
    assert_non_null(strstr(text, "approximated 1 x Material \"glass\" (of 1 materials): a mirror of its reflectance; "
                                 "what it lets through, and other surfaces in it, are black\n"));
    assert_non_null(strstr(text, "no.exr\n"));
    assert_non_null(strstr(text, "no/a.ply\nmissing"));
    bis_scene_desc_free(d);
    /* without the list it is an error, as ever */
    assert_int_equal(
        parse(&d, "WorldBegin LightSource \"infinite\" \"string filename\" \"no.exr\"", BIS_PARSE_APPROXIMATE, NULL),
        BIS_INPUT);
}

static const struct { const char *material; float Kd[3], Ks[3]; double alpha; /* 0: Phong's */ } originals[] = {
    {"\"dielectric\"", {0, 0, 0}, {.04f, .04f, .04f}, .01},
    {"\"dielectric\" \"float index\" 2", {0, 0, 0}, {1 / 9.f, 1 / 9.f, 1 / 9.f}, .01},
    {"\"dielectric\" \"float index\" 2 \"float eta\" 4", {0, 0, 0}, {.36f, .36f, .36f}, .01},
    {"\"dielectric\" \"float eta\" 0", {0, 0, 0}, {.04f, .04f, .04f}, .01}, /* no index: as 1.5 */
    {"\"dielectric\" \"float eta\" 0.25", {0, 0, 0}, {.36f, .36f, .36f}, .01},
    {"\"dielectric\" \"float roughness\" 5", {0, 0, 0}, {.04f, .04f, .04f}, 1},
    {"\"dielectric\" \"float roughness\" 1e-12", {0, 0, 0}, {.04f, .04f, .04f}, 1e-4},
    {"\"dielectric\" \"float roughness\" -1", {0, 0, 0}, {.04f, .04f, .04f}, .01},
    {"\"dielectric\" \"float roughness\" 0.25 \"float uroughness\" 0.01", {0, 0, 0}, {.04f, .04f, .04f}, .2236068},
     /* sqrt of 0.05 */
    {"\"dielectric\" \"float roughness\" 0.3 \"bool remaproughness\" false", {0, 0, 0}, {.04f, .04f, .04f}, .3},
    {"\"substrate\" \"float Kd\" 0.3 \"float Ks\" 0.2 \"bool remaproughness\" false \"float uroughness\" 0.2 "
     "\"float vroughness\" 0.45", {.3f, .3f, .3f}, {.2f, .2f, .2f}, .3},
    {"\"coateddiffuse\" \"float reflectance\" 0 \"float roughness\" 0.04 \"float vroughness\" 0.64", {0, 0, 0},
     {.04f, .04f, .04f}, .4}, /* 0.2 0.8 = 0.16 */
    {"\"glass\"", {0, 0, 0}, {.04f, .04f, .04f}, .01},
    {"\"glass\" \"rgb Kr\" [1 0.5 0.25] \"float index\" 3", {0, 0, 0}, {.25f, .125f, .0625f}, .01},
    {"\"glass\" \"rgb Kr\" [-1 2 0.5]", {0, 0, 0}, {0, .04f, .02f}, .01},
    {"\"thindielectric\" \"float eta\" 3", {0, 0, 0}, {.4f, .4f, .4f}, .01},
    {"\"thindielectric\" \"float roughness\" 0.25", {0, 0, 0}, {.08f / 1.04f, .08f / 1.04f, .08f / 1.04f}, .01},
    {"\"mirror\"", {0, 0, 0}, {.9f, .9f, .9f}, .01},
    {"\"mirror\" \"rgb Kr\" [0.1 0.2 0.3]", {0, 0, 0}, {.1f, .2f, .3f}, .01},
    {"\"mirror\" \"float roughness\" 0.5", {0, 0, 0}, {.9f, .9f, .9f}, .01},
    {"\"shinymetal\"", {0, 0, 0}, {1, 1, 1}, .31622777},
    {"\"shinymetal\" \"rgb Ks\" [1 0.5 0] \"rgb Kr\" [0 0.25 0.5] \"float roughness\" 0.04", {0, 0, 0},
     {.5f, .375f, .25f}, .2},
    {"\"coatedconductor\"", {0, 0, 0}, {.9f, .9f, .9f}, .01},
    {"\"coatedconductor\" \"rgb reflectance\" [0.1 0.2 0.3] \"float conductor.roughness\" 0.04 \"float "
     "interface.roughness\" 0.3",
     {0, 0, 0}, {.1f, .2f, .3f}, .2},
    {"\"disney\"", {.5f, .5f, .5f}, {.04f, .04f, .04f}, .25},
    {"\"disney\" \"rgb color\" [1 0.5 0] \"float eta\" 3", {1, .5f, 0}, {.25f, .25f, .25f}, .25},
    {"\"disney\" \"rgb color\" [1 0.5 0] \"float metallic\" 1", {0, 0, 0}, {1, .5f, 0}, .25},
    {"\"disney\" \"rgb color\" [1 0.5 0] \"float metallic\" -1 \"float roughness\" 0.001", {1, .5f, 0},
     {.04f, .04f, .04f}, 1e-4},
    {"\"disney\" \"rgb color\" [1 0.5 0] \"float metallic\" 0.25 \"float roughness\" 2", {.75f, .375f, 0},
     {.28f, .155f, .03f}, 1},
    {"\"diffusetransmission\"", {.25f, .25f, .25f}, {0, 0, 0}, 0},
    {"\"diffusetransmission\" \"rgb reflectance\" [0.1 0.2 0.3] \"rgb transmittance\" [1 1 1]", {.1f, .2f, .3f},
     {0, 0, 0}, 0},
    {"\"translucent\"", {.125f, .125f, .125f}, {.005f, .005f, .005f}, .31622777},
    {"\"translucent\" \"rgb Kd\" [0.2 0.4 0.6] \"rgb reflect\" [1 0.5 0.25] \"rgb Ks\" [1 0.5 0.5] \"float "
     "roughness\" 0.04",
     {.2f, .2f, .15f}, {.04f, .01f, .005f}, .2},
    {"\"subsurface\"", {.5f, .5f, .5f}, {.04f, .04f, .04f}, .01},
    {"\"subsurface\" \"rgb reflectance\" [0.1 0.2 0.3] \"float roughness\" 0.04", {.1f, .2f, .3f},
     {.04f, .04f, .04f}, .2},
    {"\"kdsubsurface\" \"rgb Kd\" [0.1 0.2 0.3] \"rgb reflectance\" [1 1 1] \"float eta\" 3", {.1f, .2f, .3f},
     {.25f, .25f, .25f}, .01},
    {"\"hair\" \"rgb color\" [2 2 2]", {1, 1, 1}, {0, 0, 0}, 0}, /* clamped */
    {"\"hair\"", {.2f, .2f, .2f}, {0, 0, 0}, 0},
    {"\"hair\" \"rgb reflectance\" [0.1 0.2 0.3]", {.1f, .2f, .3f}, {0, 0, 0}, 0},
    {"\"hair\" \"rgb reflectance\" [0.1 0.2 0.3] \"rgb color\" [0.4 0.5 0.6]", {.4f, .5f, .6f}, {0, 0, 0}, 0},
    {"\"measured\" \"string filename\" \"no.bsdf\"", {.5f, .5f, .5f}, {0, 0, 0}, 0},
};

/* Every channel by itself, what is not said as in pbrt, and the limits; by hand from the formulas of the page. */
static void each_channel_and_each_default_is_the_originals(void **state)
{
    for (size_t i = 0; i < sizeof originals / sizeof *originals; i++) {
        char text[400];
        snprintf(text, sizeof text, "WorldBegin Material %s Shape \"sphere\"", originals[i].material);
        bis_scene_desc *d = approximated(text);
        const bis_material *m = &d->materials[d->shapes[0].material];
        const float Kd[3] = {m->Kd.r, m->Kd.g, m->Kd.b}, Ks[3] = {m->Ks.r, m->Ks.g, m->Ks.b};
        for (int k = 0; k < 3; k++)
            if (fabs((double)(Kd[k] - originals[i].Kd[k])) > 1e-6 || fabs((double)(Ks[k] - originals[i].Ks[k])) > 1e-6)
                fail_msg("%s: channel %d: Kd %g Ks %g", originals[i].material, k, (double)Kd[k], (double)Ks[k]);
        if (originals[i].alpha > 0 ? fabs(m->alpha / originals[i].alpha - 1) > 1e-6 : m->alpha != 0)
            fail_msg("%s: alpha %g", originals[i].material, m->alpha);
        bis_scene_desc_free(d);
    }
}

#define ONE \
    "MakeNamedMaterial \"one\" \"string type\" \"microfacet\" \"rgb Kd\" [0.2 0.4 0.8] \"rgb Ks\" [0.3 0.1 0] " \
    "\"float roughness\" 0.2 "
#define TWO \
    "MakeNamedMaterial \"two\" \"string type\" \"phong\" \"rgb Kd\" [0 0.4 0.2] \"rgb Ks\" [0 0.2 0.4] \"float " \
    "exponent\" 7 "
#define OF "\"string materials\" [\"one\" \"two\"] "
static const struct { const char *mix; float Kd[3], Ks[3]; bool first; } mixes[] = {
    {OF "\"float amount\" 0.25", {.15f, .4f, .65f}, {.225f, .125f, .1f}, true},
    {OF, {.1f, .4f, .5f}, {.15f, .15f, .2f}, false}, /* 0.2 against 0.3 */
    {OF "\"float amount\" 0.375", {.125f, .4f, .575f}, {.1875f, .1375f, .15f}, true}, /* 0.25 against 0.225 */
    {OF "\"rgb amount\" [0 0.5 1]", {.2f, .4f, .2f}, {.3f, .15f, .4f}, false}, /* 0.35 against 0.5 */
    {OF "\"rgb amount\" [0 0.5 0.5]", {.2f, .4f, .5f}, {.3f, .15f, .2f}, true}, /* 0.35 against 0.3 */
    {"\"string namedmaterial1\" \"one\" \"string namedmaterial2\" \"two\" \"float amount\" 0.25", {.05f, .4f, .35f},
     {.075f, .175f, .3f}, false},
    {"\"string namedmaterial1\" \"two\" \"string namedmaterial2\" \"one\" \"float amount\" 0.25", {.15f, .4f, .65f},
     {.225f, .125f, .1f}, true},
    {OF "\"texture amount\" \"t\"", {.18f, .4f, .74f}, {.27f, .11f, .04f}, true}, /* the mean of t: 0.1 */
    /* of what is not seen nothing is mixed in */
    {"\"string materials\" [\"one\" \"air\"] \"float amount\" 0.25", {.2f, .4f, .8f}, {.3f, .1f, 0}, true},
    {"\"string materials\" [\"air\" \"one\"] \"float amount\" 0.25", {.2f, .4f, .8f}, {.3f, .1f, 0}, true},
    {"\"string materials\" [\"one\" \"one\"] \"float amount\" 0.25", {.2f, .4f, .8f}, {.3f, .1f, 0}, true},
};

/* The lobe is that of the material whose share of Ks is larger; the shares are of each channel. */
static void a_mix_has_the_lobe_of_the_stronger_one(void **state)
{
    for (size_t i = 0; i < sizeof mixes / sizeof *mixes; i++) {
        char text[1000];
        snprintf(text, sizeof text, "WorldBegin Texture \"t\" \"float\" \"constant\" \"float value\" 0.1 " ONE TWO
                 "MakeNamedMaterial \"air\" \"string type\" \"none\" Material \"mix\" %s Shape \"sphere\"",
                 mixes[i].mix);
        bis_scene_desc *d = approximated(text);
        const bis_material *m = &d->materials[d->shapes[0].material];
        const float Kd[3] = {m->Kd.r, m->Kd.g, m->Kd.b}, Ks[3] = {m->Ks.r, m->Ks.g, m->Ks.b};
        for (int k = 0; k < 3; k++)
            if (fabs((double)(Kd[k] - mixes[i].Kd[k])) > 1e-6 || fabs((double)(Ks[k] - mixes[i].Ks[k])) > 1e-6)
                fail_msg("%s: channel %d: Kd %g Ks %g", mixes[i].mix, k, (double)Kd[k], (double)Ks[k]);
        assert_ptr_equal(
            m->model, mixes[i].first ? bis_microfacet(m->Kd, m->Ks, .5).model : bis_phong(m->Kd, m->Ks, 1).model);
        assert_true(mixes[i].first ? fabs(m->alpha - .04) < 1e-9 : m->exponent == 7);
        bis_scene_desc_free(d);
    }
    /* two metals: no eta is that of both */
    bis_scene_desc *d =
        approximated("WorldBegin MakeNamedMaterial \"a\" \"string type\" \"conductor\" \"float roughness\" 0.1 "
                     "Material \"mix\" \"string materials\" [\"a\" \"a\"] Shape \"sphere\"");
    const bis_material *m = &d->materials[d->shapes[0].material];
    assert_true(m->eta.r == 0 && m->eta.g == 0 && m->eta.b == 0 && m->Ks.r > 0.9f);
    bis_scene_desc_free(d);
    /* nor has a mix plastic's index: it is a microfacet of the mean colours */
    d = approximated("WorldBegin MakeNamedMaterial \"a\" \"string type\" \"plastic\" \"float Ks\" 0.5 "
                     "Material \"mix\" \"string materials\" [\"a\" \"a\"] Shape \"sphere\"");
    m = &d->materials[d->shapes[0].material];
    assert_true(
        m->model == &bis_microfacet_model && m->eta.r == 0 && m->Kd.g == 0.25f && fabs((double)m->Ks.b - .02) < 1e-6);
    bis_scene_desc_free(d);
    /* the chain stands in the wrong order; three rounds */
    d = approximated(
        "WorldBegin MakeNamedMaterial \"m1\" \"string type\" \"mix\" \"string materials\" [\"m2\" \"one\"] "
        "MakeNamedMaterial \"m2\" \"string type\" \"mix\" \"string materials\" [\"one\" \"m3\"] "
        "MakeNamedMaterial \"m3\" \"string type\" \"mix\" \"string materials\" [\"two\" \"one\"] " ONE TWO
        "NamedMaterial \"m1\" Shape \"sphere\"");
    m = &d->materials[d->shapes[0].material];
    assert_true(fabs((double)m->Kd.r - .2 * 7 / 8) < 1e-6 && fabs((double)m->Ks.b - .4 / 8) < 1e-6);
    bis_scene_desc_free(d);
#undef OF
#undef ONE
#undef TWO
}

/* What is said is said where it begins, with the number of times and the share, the largest effect first. */
static void what_is_approximated_is_told_with_place_number_and_consequence(void **state)
{
    static const char *const lines[] = {
        "scene.txt:1:12: warning: approximated: Integrator \"path\": one bounce",
        "scene.txt:3:1: warning: approximated: 1 x AreaLightSource (of 2 lights): its light is missing",
        "scene.txt:5:7: warning: approximated: 1 x Shape \"curve\" (of 3 shapes): left out",
        "scene.txt:2:10: warning: approximated: 2 x Material \"glass\" (of 3 materials): a mirror of its reflectance",
        "scene.txt:6:21: warning: approximated: 1 x Texture \"ptex\" (of 1 textures): one value all over, 0.5",
        "scene.txt:1:40: warning: approximated: 1 x \"maxdepth\" given twice: the last one counts",
    };
    bis_scene_desc *d;
    bis_diag diag = {0};
    assert_int_equal(parse(&d,
                         "Integrator \"path\" \"integer maxdepth\" 3 \"integer maxdepth\" 5 WorldBegin LightSource "
                         "\"infinite\"\nMaterial \"glass\"\nAreaLightSource \"diffuse\"\n"
                         "Material \"glass\" Shape \"sphere\" Shape \"disk\" Material \"matte\"\nShape "
                         "\"curve\"\nTexture \"t\" \"float\" \"ptex\"\n",
                         BIS_PARSE_APPROXIMATE, &diag),
        BIS_OK);
    assert_int_equal(diag.n, 6);
    for (size_t i = 0; i < 6; i++)
        if (!strstr(diag.messages[i].text, lines[i])) fail_msg("%s", diag.messages[i].text);
    bis_diag_clear(&diag);
    bis_scene_desc_free(d);
    /* both names of a mix are looked for, and a near one is named */
    assert_int_equal(parse(&d,
                         "WorldBegin MakeNamedMaterial \"wood\" \"string type\" \"diffuse\"\nMaterial \"mix\" \"string "
                         "materials\" [\"wood\" \"woot\"]",
                         BIS_PARSE_APPROXIMATE, &diag),
        BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "material \"woot\" is not made anywhere (did you mean \"wood\"?)"));
    bis_diag_clear(&diag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_is_an_error_with_its_way_out_and_is_noted_with_approximate),
        cmocka_unit_test(each_replacement_has_its_effect_and_its_share),
        cmocka_unit_test(what_is_out_of_its_range_becomes_its_end),
        cmocka_unit_test(a_texture_is_its_mean_where_a_value_is_asked_for),
        cmocka_unit_test(a_texture_without_a_part_is_grey),
        cmocka_unit_test(a_scene_may_say_it_itself),
        cmocka_unit_test(textures_of_pbrts_have_the_mean_of_their_parts),
        cmocka_unit_test(unknown_metals_and_coats_are_the_nearest_known),
        cmocka_unit_test(each_channel_and_each_default_is_the_originals),
        cmocka_unit_test(a_mix_has_the_lobe_of_the_stronger_one),
        cmocka_unit_test(what_is_approximated_is_told_with_place_number_and_consequence),
        cmocka_unit_test(a_mix_of_itself_or_of_nothing_is_an_error),
        cmocka_unit_test(shapes_of_an_interface_are_left_out_also_as_instances),
        cmocka_unit_test(a_material_made_again_counts_from_there_on),
        cmocka_unit_test(what_moves_stands_where_it_is_at_first),
        cmocka_unit_test(what_is_flat_at_the_end_alone_is_shown),
        cmocka_unit_test(the_world_begins_with_the_identity_of_all_transformations),
        cmocka_unit_test(what_is_unknown_to_pbrt_too_stays_an_error),
        cmocka_unit_test(an_import_is_read_as_an_include),
        cmocka_unit_test(a_plan_lists_what_is_missing_each_once),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
