/* SPDX-License-Identifier: BSD-2-Clause */
/* pbrt's own materials and colours: spectra against published chromaticities, metals against their optical constants,
 * roughness against pbrt's formulas, worked out by hand. */
#include "bis/base/fresnel.h"
#include "bis/base/mem.h"
#include "parse/spectrum.h"
#include "bis/beyond/microfacet.h"
#include "bis/scene/scene.h"

#include "claim.h"
#include "image_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void assert_about(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance)) fail_msg("%.9g is not %.9g +- %g", a, b, tolerance);
}

static void assert_rgb(rgb c, double r, double g, double b, double tolerance)
{
    assert_about((double)c.r, r, tolerance);
    assert_about((double)c.g, g, tolerance);
    assert_about((double)c.b, b, tolerance);
}

typedef struct parsed {
    bis_scene_desc *desc;
    bis_diag diag;
    bis_status status;
} parsed;

static parsed parse(const char *world)
{
    parsed p = {0};
    char text[4096];
    const int n = snprintf(text, sizeof text, "WorldBegin\nLightSource \"infinite\"\n%s\nShape \"sphere\"", world);
    store(scratch("scene.txt"), text, (size_t)n);
    p.status = bis_scene_parse(&p.desc, scratch("scene.txt"), &p.diag);
    return p;
}

static void clear(parsed *p)
{
    bis_scene_desc_free(p->desc);
    bis_diag_clear(&p->diag);
}

/* The material that these words make; warning: a part of the one warning, or NULL. */
static bis_material material(const char *world, const char *warning)
{
    parsed p = parse(world);
    for (size_t i = 0; i < p.diag.n && p.status; i++) print_error("%s\n", p.diag.messages[i].text);
    assert_int_equal(p.status, BIS_OK);
    assert_int_equal(p.diag.n, warning ? 1 : 0);
    if (warning && !strstr(p.diag.messages[0].text, warning)) fail_msg("%s, not %s", p.diag.messages[0].text, warning);
    const bis_material m = p.desc->materials[p.desc->shapes[0].material];
    clear(&p);
    return m;
}

/* The material where its textures are looked up at (u, 1/2). */
static bis_material material_at(const parsed *p, double u)
{
    const uint32_t index = p->desc->shapes[0].material;
    const bis_material_textures *t = bis_textures_of(&p->desc->textures, index);
    assert_non_null(t);
    return bis_textures_material(&p->desc->textures, NULL, t, &p->desc->materials[index], (double[]){u, 0.5},
                                 (vec3){0, 0, 0});
}

static void refuse(const char *world, const char *message)
{
    parsed p = parse(world);
    assert_int_equal(p.status, BIS_INPUT);
    if (!strstr(p.diag.messages[0].text, message)) fail_msg("%s, not %s", p.diag.messages[0].text, message);
    clear(&p);
}

/* ---- colours ---- */

/* The chromaticity of a colour, by the inverse matrix (IEC 61966-2-1 to seven digits). */
static void chromaticity(double xy[2], rgbd c)
{
    const double X = 0.4124564 * c.r + 0.3575761 * c.g + 0.1804375 * c.b,
                 Y = 0.2126729 * c.r + 0.7151522 * c.g + 0.0721750 * c.b,
                 Z = 0.0193339 * c.r + 0.1191920 * c.g + 0.9503041 * c.b;
    xy[0] = X / (X + Y + Z);
    xy[1] = Y / (X + Y + Z);
}

/* The last is by the matrix of sRGB: X = 0, Y = 0.1, Z = 0.1 has red below 0. */
static void reflectances_may_be_spectra_files_or_xyz(void **state)
{
    static const struct { const char *words; double is[3]; const char *warning; } cases[] = {
        {"\"spectrum reflectance\" [400 0.25 700 0.25]", {.25, .25, .25}, NULL},
        {"\"spectrum reflectance\" 0.5", {.5, .5, .5}, NULL},
        {"\"xyz reflectance\" [0.475235 0.5 0.544415]", {.5, .5, .5}, NULL}, /* half of D65's own white */
        {"\"spectrum reflectance\" [400 1 700 1]", {1, 1, 1}, NULL}, /* white itself is inside, up to rounding */
        {"\"spectrum reflectance\" [400 1.01 700 1.01]", {1, 1, 1},
         "(1.01, 1.01, 1.01) of RGB; it is cut off to [0, 1]"},
        {"\"xyz reflectance\" [0 0.1 0.1]", {0, .1918, .0853}, "the colour (-0.2036, 0.1918, 0.08532) of RGB"},
    };
    char text[512];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, "Material \"diffuse\" %s", cases[i].words);
        const double *is = cases[i].is;
        assert_rgb(material(text, cases[i].warning).Kd, is[0], is[1], is[2], 1e-4);
    }
    const rgbd glow = bis_spectrum_blackbody(3000); /* in pbrt any colour may be one; this one is brighter than white */
    assert_rgb(material("Material \"diffuse\" \"blackbody reflectance\" 3000", "it is cut off to [0, 1]").Kd, 1, glow.g,
        glow.b, 1e-6);
    for (int n = 3; n < 70; n += 2) { /* with the roughness before it their list is full at 15, 31 and 63 */
        char odd[1024] = "Material \"conductor\" \"float roughness\" 0.5 \"spectrum eta\" [";
        for (int i = 0; i < n; i++) snprintf(odd + strlen(odd), 16, "%d ", i % 2 ? 1 : 400 + i);
        strcat(odd, "]");
        refuse(odd, "must be one number, or pairs of a wavelength in nm");
    }
    refuse("Material \"diffuse\" \"spectrum reflectance\" [500 0 400 1]", "descend from 500 to 400: sort its pairs");
    refuse("Material \"diffuse\" \"spectrum reflectance\" \"no.spd\"", "cannot read");
    store(scratch("bad.spd"), "300 0.75 900 0.75\0", 18); /* what follows a zero byte would be lost without a word */
    snprintf(text, sizeof text, "Material \"phong\" \"spectrum Kd\" \"%s\"", strrchr(scratch("bad.spd"), '/') + 1);
    refuse(text, "bad.spd is no spectrum: there is a zero byte in it");
}

/* Numbers between blanks and commas, with comments; all or nothing. No said: a grey of 3/4. */
static void a_file_of_a_spectrum_has_pairs_of_numbers(void **state)
{
    static const char *const cases[][2] = {
        {"300,0.75,900,0.75", NULL}, {"300\t0.75\r\n900\t0.75\r\n", NULL}, {"#x\n300 0.75#y\n#z\n", NULL},
        {"\n\n , 300 .75", NULL}, {"#\r300 0.75", NULL}, {"3e2 75e-2,", NULL},
        {"", "pairs of a wavelength"}, {"0.5", "pairs of a wavelength"}, {"400 1 500", "pairs of a wavelength"},
        {"400 1 300 1", "descend from 400 to 300"}, {"400 1e39", "pairs of a wavelength"},
        {"0 1", "pairs of a wavelength"}, {"400 -1", "pairs of a wavelength"}, {"400 x", "its value 2 is no number"},
        {"400 1 500 2z", "its value 4 is no number"}, {"400;1", "its value 1 is no number"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        store(scratch("a.spd"), cases[i][0], strlen(cases[i][0]));
        snprintf(text, sizeof text, "Material \"phong\" \"spectrum Kd\" \"%s\"", strrchr(scratch("a.spd"), '/') + 1);
        if (cases[i][1]) refuse(text, cases[i][1]);
        else assert_rgb(material(text, NULL).Kd, .75, .75, .75, 1e-6);
    }
}

static void light_may_be_a_black_body_or_xyz(void **state)
{
    static const struct { const char *words; double xy[2]; const char *said; } cases[] = {
        {"\"blackbody L\" 2856 \"float scale\" 2", {.4476, .4074}, NULL},
        {"\"blackbody L\" [2856 2]", {.4476, .4074}, NULL}, /* tests/foreign/scenes says how bright */
        {"\"xyz L\" [0.95047 1 1.08883]", {.3127, .3290}, NULL},
        {"\"xyz L\" [0 0.1 0.1]", {.2535, .4326}, "(-0.2036, 0.1918, 0.08532) of RGB; what is negative becomes 0"},
        {"\"blackbody L\" [2856 2 1]", {0}, "\"blackbody L\" has 3 values, must have one"}, /* pbrt has two at most */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        parsed p = {0};
        double xy[2];
        const int n = snprintf(text, sizeof text, "WorldBegin LightSource \"infinite\" %s", cases[i].words);
        store(scratch("a.txt"), text, (size_t)n);
        const bis_status status = bis_scene_parse(&p.desc, scratch("a.txt"), &p.diag);
        assert_int_equal(status, i == 4 ? BIS_INPUT : BIS_OK);
        assert_int_equal(p.diag.n, cases[i].said ? 1 : 0);
        if (cases[i].said) assert_non_null(strstr(p.diag.messages[0].text, cases[i].said));
        if (!status) {
            const rgb L = p.desc->light.L;
            chromaticity(xy, (rgbd){(double)L.r, (double)L.g, (double)L.b});
            for (int k = 0; k < 2; k++) assert_about(xy[k], cases[i].xy[k], 5e-4);
        }
        clear(&p);
    }
}

/* ---- metals ---- */

/* The constants of copper every 20 nm. */
#define COPPER_ETA \
    "380 1.206 400 1.175 420 1.178 440 1.171 460 1.16 480 1.148 500 1.134 520 1.111 540 1.033 560 0.8614 580 0.6027 " \
    "600 0.3902 620 0.2718 " \
    "640 0.2266 660 0.212 680 0.2112 700 0.2148 720 0.22 740 0.2295 760 0.2414 780 0.2509"
#define COPPER_K \
    "380 2.094 400 2.13 420 2.248 440 2.349 460 2.436 480 2.515 500 2.574 520 2.602 540 2.582 560 2.593 580 2.71 600 " \
    "2.943 620 3.241 " \
    "640 3.511 660 3.752 680 3.962 700 4.158 720 4.345 740 4.522 760 4.692 780 4.861"

/* What reflects nothing has no eta, but Schlick's curve, which is then constant. */
static void a_conductor_that_reflects_nothing_has_no_eta(void **state)
{
    const bis_material nothing =
        material("Material \"conductor\" \"spectrum eta\" [550 1] \"spectrum k\" [550 0] \"float roughness\" 1", NULL);
    assert_rgb(nothing.Ks, 0, 0, 0, 0);
    assert_rgb(nothing.eta, 0, 0, 0, 0);
}

/* Over all directions: sums over 41 wavelengths by numpy. Gold's red would be 1.012, and is cut off. */
static void metals_reflect_on_average_what_their_spectra_do(void **state)
{
    static const struct { const char *name; double mean[3]; } known[] = {
        {"Ag", {0.96958, 0.95857, 0.91795}}, {"Al", {0.90078, 0.91154, 0.91682}}, {"Cu", {0.95219, 0.64684, 0.55546}},
        {"Au", {1, 0.79192, 0.38046}},
        {"", {0.95219, 0.64684, 0.55546}}}; /* copper by its spectra */
    for (int i = 0; i < 5; i++) {
        char text[2048];
        snprintf(text, sizeof text,
            "Material \"metal\" \"spectrum eta\" \"metal-%s-eta\" \"spectrum k\" \"metal-%s-k\"", known[i].name,
            known[i].name);
        if (!*known[i].name)
            snprintf(text, sizeof text,
                "Material \"metal\" \"spectrum eta\" [" COPPER_ETA "] \"spectrum k\" [" COPPER_K "]");
        const bis_material m = material(text, NULL);
        const double Ks[3] = {(double)m.Ks.r, (double)m.Ks.g, (double)m.Ks.b},
                     eta[3] = {(double)m.eta.r, (double)m.eta.g, (double)m.eta.b};
        for (int c = 0; c < 3; c++) {
            assert_true((eta[c] > 0) == (Ks[c] < 1));
            assert_about(Ks[c] < 1 ? bis_fresnel_mean(eta[c], bis_fresnel_k2(Ks[c], eta[c])) : 1, known[i].mean[c],
                *known[i].name ? 1e-4 : 4e-3);
        }
    }
    /* each channel by itself; a reflectance has pbrt-v4's eta of 1, also from a texture */
    assert_rgb(material("Material \"metal\" \"rgb eta\" [0.2 0.9 1.1] \"rgb k\" [3.9 2.5 2.1]", NULL).eta, 0.2, 0.9,
        1.1, 1e-7);
    assert_rgb(material("Material \"conductor\" \"rgb reflectance\" [0.9 0.6 0.3] \"float roughness\" 0.1", NULL).eta,
        1, 1, 1, 0);
    parsed p = parse("Texture \"k\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.5 \"rgb tex2\" [1 0 0.5] Material "
                     "\"conductor\" \"texture reflectance\" \"k\" \"float roughness\" 0.1");
    assert_int_equal(p.status, BIS_OK);
    assert_rgb(material_at(&p, 0.5).eta, 1, 1, 1, 0);
    clear(&p);
}

/* Published colours of metals head on (S. Lagarde, "Feeding a physically based shading model", 2011, from the same
 * constants), cut off in the third digit. Of oxides without absorption ((n - 1)/(n + 1))^2 with the index at 611, 549
 * and 464 nm, where red, green and blue are. Copper is pbrt's own: its eta or its k alone says enough. */
static void named_metals_have_their_published_colours(void **state)
{
    static const struct { const char *words; double Ks[3], tolerance; } cases[] = {
        {"", {.955, .638, .538}, 1e-3}, {"\"spectrum eta\" \"metal-Cu-eta\"", {.955, .638, .538}, 1e-3},
        {"\"spectrum k\" \"metal-Cu-k\"", {.955, .638, .538}, 1e-3},
        {"\"spectrum eta\" [" COPPER_ETA "] \"spectrum k\" [" COPPER_K "]", {.955, .638, .538}, 4e-3},
        {"\"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"", {1, .782, .344}, 1e-3},
        {"\"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\"", {.972, .960, .915}, 1e-3},
        {"\"spectrum eta\" \"metal-Al-eta\" \"spectrum k\" \"metal-Al-k\"", {.913, .922, .924}, 1e-3},
        {"\"spectrum eta\" \"metal-MgO-eta\" \"spectrum k\" \"metal-MgO-k\"", {.0724, .0730, .0745}, 1e-3},
        {"\"spectrum eta\" \"metal-TiO2-eta\" \"spectrum k\" \"metal-TiO2-k\"", {.236, .244, .265}, 1e-2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        snprintf(text, sizeof text, "Material \"conductor\" \"float roughness\" 0.1 %s", cases[i].words);
        const double *Ks = cases[i].Ks;
        assert_rgb(material(text, NULL).Ks, Ks[0], Ks[1], Ks[2], cases[i].tolerance);
    }
    assert_rgb(material("Material \"metal\" \"spectrum eta\" \"metal-MgO-eta\" \"spectrum k\" \"metal-MgO-k\"",
        NULL).eta,
        1.7362, 1.7406, 1.7505, 4e-3);
}

/* pbrt-v4: alpha = sqrt(roughness); pbrt-v3: its polynomial, here as python computes it; bis's own alpha is what
 * counts. What is rougher than bis has is 1. */
static void roughness_becomes_pbrts_alpha(void **state)
{
    static const struct { const char *words; double alpha; const char *warning; } cases[] = {
        {"\"conductor\" \"float roughness\" 0.25", .5, NULL},
        {"\"conductor\" \"float roughness\" 0.25 \"bool remaproughness\" false", .25, NULL},
        {"\"conductor\" \"float uroughness\" 0.04 \"float vroughness\" 0.04", .2, NULL},
        {"\"metal\" \"float roughness\" 0.1", .46176003200863397, NULL}, {"\"metal\"", .13892440927807698, NULL},
        {"\"plastic\"", .46176003200863397, NULL},
        {"\"metal\" \"float roughness\" 0.3 \"bool remaproughness\" false", .3, NULL},
        {"\"conductor\"", 1e-4, "a perfect mirror is not modelled: it becomes a lobe with alpha = 0.0001"},
        {"\"metal\" \"float roughness\" 0.5", 1, "this roughness has alpha = 1.1"},
    };
    static const struct { const char *rest; double alpha[2]; } textured[] = {
        {"0.0625 \"float tex2\" 0.25 Material \"conductor\" \"texture roughness\" \"r\"", {.25, .5}},
        {"0.1 \"float tex2\" 0.3 Material \"metal\" \"texture roughness\" \"r\"",
         {.46176003200863414, .8570364675174545}},
        {"0.01 \"float tex2\" 0.4 Material \"plastic\" \"texture roughness\" \"r\"", {.13892440927807703, 1}},
        {"0 \"float tex2\" 0.75 Material \"substrate\" \"texture roughness\" \"r\"", {.047269450828605786, 1}},
        {"0.1 \"float tex2\" 0.3 Material \"metal\" \"texture roughness\" \"r\" \"bool remaproughness\" false",
         {.1, .3}},
    };
    char text[300];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, "Material %s", cases[i].words);
        assert_about(material(text, cases[i].warning).alpha, cases[i].alpha, 1e-9);
    }
    for (size_t i = 0; i < sizeof textured / sizeof *textured; i++) {
        snprintf(text, sizeof text, "Texture \"r\" \"float\" \"checkerboard\" \"float tex1\" %s", textured[i].rest);
        parsed p = parse(text);
        for (int k = 0; k < 2; k++) assert_about(material_at(&p, 0.5 + k).alpha, textured[i].alpha[k], 1e-9);
        clear(&p);
    }
}

/* ---- coats ---- */

/* F0 of 1.5 is 0.04, of 1.33 (0.33/2.33)^2 = 0.0200593. Of light from everywhere 0.85674 pass a coat of alpha 0.5 and
 * thickness 0.02, and 0.27240 of the base's come back (4 million random paths of Mitsuba): a base of 0.5 shows
 * 0.85674^2/2.25 0.5/(1 - 0.2724 0.5) = 0.18883, a white one 0.44836. */
static void coats_are_what_their_index_says(void **state)
{
    bis_material m = material("Material \"plastic\" \"rgb Kd\" [0.1 0.2 0.3] \"float Ks\" 0.5", NULL);
    assert_rgb(m.Kd, 0.1, 0.2, 0.3, 1e-6);
    assert_rgb(m.Ks, 0.02, 0.02, 0.02, 1e-6);
    assert_ptr_equal(m.model, &bis_plastic_model);
    assert_rgb(m.eta, 1.5, 1.5, 1.5, 0);
    m = material("Material \"uber\" \"float Kd\" 0.4 \"float Ks\" 1 \"float eta\" 1.33 \"rgb Kr\" [0 0 0]", NULL);
    assert_rgb(m.Ks, 0.0200593, 0.0200593, 0.0200593, 1e-6);
    assert_ptr_equal(m.model, &bis_plastic_model);
    assert_rgb(m.eta, 1.33, 1.33, 1.33, 1e-6);
    assert_rgb(material("Material \"uber\" \"float index\" 100", NULL).eta, 100, 100, 100, 0);
    assert_rgb(material("Material \"uber\" \"float index\" 0.01", NULL).eta, 0.01, 0.01, 0.01, 1e-9);
    m = material("Material \"substrate\" \"rgb Kd\" [0.1 0.2 0.3] \"rgb Ks\" [0.4 0.5 0.6] \"float uroughness\" 0.05 "
                 "\"float vroughness\" 0.05",
        NULL);
    assert_ptr_equal(m.model, &bis_microfacet_model);
    assert_rgb(m.Kd, 0.1, 0.2, 0.3, 1e-6);
    assert_rgb(m.Ks, 0.4, 0.5, 0.6, 1e-6);
    m = material(
        "Material \"coateddiffuse\" \"rgb reflectance\" [0.5 1 0] \"float roughness\" 0.25 \"float thickness\" 0.02",
        NULL);
    assert_ptr_equal(m.model, &bis_plastic_model);
    assert_rgb(m.eta, 1.5, 1.5, 1.5, 0);
    assert_rgb(m.Kd, 0.18883, 0.44836, 0, 3e-4);
    assert_rgb(m.Ks, 0.04, 0.04, 0.04, 1e-6);
    assert_about(m.alpha, 0.5, 1e-12);
    /* pbrt's thickness is 0.01; of a texture of roughness a smooth coat is made: 0.89796, 0.56735 */
    m = material("Material \"coateddiffuse\" \"rgb reflectance\" [0.5 1 0] \"float roughness\" 0.25", NULL);
    assert_rgb(m.Kd, 0.19581, 0.47028, 0, 3e-4);
    m = material("Texture \"r\" \"float\" \"checkerboard\" \"float tex1\" 0.1 \"float tex2\" 0.2\nMaterial "
                 "\"coateddiffuse\" \"rgb reflectance\" [0.5 1 0] "
                 "\"texture roughness\" \"r\"",
        NULL);
    assert_rgb(m.Kd, 0.25014, 0.82830, 0, 3e-4);
}

static void a_textured_coat_is_the_coat_of_each_colour(void **state)
{
    parsed p = parse("Texture \"k\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.5 \"rgb tex2\" [1 0 0.5]\nMaterial "
                     "\"coateddiffuse\" \"texture reflectance\" \"k\" \"float roughness\" 0.25");
    assert_int_equal(p.status, BIS_OK);
    assert_rgb(material_at(&p, 0.5).Kd, 0.19581, 0.19581, 0.19581, 3e-4);
    assert_rgb(material_at(&p, 1.5).Kd, 0.47028, 0, 0.19581, 3e-4);
    clear(&p);
    p = parse("Texture \"k\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.5 \"rgb tex2\" [1 0 0.5]\nMaterial "
              "\"plastic\" \"texture Kd\" \"k\" \"texture Ks\" \"k\"");
    const bis_material m = material_at(&p, 1.5);
    assert_rgb(m.Kd, 1, 0, 0.5, 1e-6);
    assert_rgb(m.Ks, 0.04, 0, 0.02, 1e-6);
    assert_ptr_equal(m.model, &bis_plastic_model);
    assert_rgb(m.eta, 1.5, 1.5, 1.5, 0);
    clear(&p);
}

/* A texture that is made of constants is one: what it is follows by hand from the shares and factors. */
static void textures_of_constants_are_their_values(void **state)
{
    static const struct { const char *texture; double is[3]; } cases[] = {
        {"\"mix\" \"rgb tex1\" [0.2 0 1] \"rgb tex2\" [1 0.5 0] \"float amount\" 0.25", {.4, .125, .75}},
        {"\"mix\" \"rgb tex1\" [0.2 0 1] \"rgb tex2\" [1 0.5 0]", {.6, .25, .5}},
        {"\"scale\" \"rgb tex1\" [0.5 1 0.25] \"rgb tex2\" [0.5 0.75 1]", {.25, .75, .25}},
        {"\"mix\" \"texture tex1\" \"s\" \"rgb tex2\" [0.25 0.25 0.25] \"texture amount\" \"k\"", {.25, .6875, .25}},
        {"\"constant\"", {1, 1, 1}}, {"\"scale\"", {1, 1, 1}}, {"\"mix\"", {.5, .5, .5}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[700];
        snprintf(text, sizeof text, "Texture \"k\" \"float\" \"scale\" \"float tex1\" 0.5 \"float tex2\" 0.25\n"
                 "Texture \"s\" \"spectrum\" \"scale\" \"rgb tex1\" [0.5 1 0.25] \"rgb tex2\" [0.5 0.75 1]\n"
                 "Texture \"m\" \"spectrum\" %s Material \"diffuse\" \"texture reflectance\" \"m\"", cases[i].texture);
        assert_rgb(material(text, NULL).Kd, cases[i].is[0], cases[i].is[1], cases[i].is[2], 1e-6);
    }
}

/* The gamma of an image's bytes, up to its limits; a file that is named twice is there once for each gamma. */
static void an_image_has_the_gamma_that_is_said(void **state)
{
    static const struct {
        const char *words;
        double gamma;
    } cases[] = {{"", BIS_GAMMA_SRGB}, {"\"string encoding\" \"sRGB\"", BIS_GAMMA_SRGB},
        {"\"string encoding\" \"linear\"", 1}, {"\"bool gamma\" true", BIS_GAMMA_SRGB}, {"\"bool gamma\" false", 1},
        {"\"string encoding\" \"gamma 2.2\"", 2.2}, {"\"string encoding\" \"gamma 100\"", 100},
        {"\"string encoding\" \"gamma 1e-3\"", 1e-3}};
    static const char *const wrong[] = {"gamma 0", "gamma 100.1", "gamma nan", "gamma x", "gamma", "gamma 2 ", "srgb",
        ""};
    char text[1024], x[64];
    store(scratch("x.png"), "x", 1); /* opened by the build alone */
    snprintf(x, sizeof x, "%s", strrchr(scratch("x.png"), '/') + 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" %s\n"
                 "Texture \"c\" \"float\" \"imagemap\" \"string filename\" \"%s\" \"string encoding\" \"gamma 3\"\n",
                 x, cases[i].words, x);
        parsed p = parse(text);
        assert_int_equal(p.status, BIS_OK);
        const bis_textures *t = &p.desc->textures;
        assert_true(t->n_files == 2 && t->files[0].gamma == cases[i].gamma && t->files[1].gamma == 3);
        for (uint32_t k = 0; k < 2; k++) assert_int_equal(t->list[t->n - 2 + k].image, k);
        clear(&p);
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(text, sizeof text,
            "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" \"string encoding\" \"%s\"", x,
            wrong[i]);
        refuse(text, "must be \"sRGB\", \"linear\" or \"gamma X\", X in (0, 100]");
    }
}

/* Normals are linear numbers, whatever the format means by its own. The twin is an image of colours. */
static void a_normal_map_is_linear(void **state)
{
    char text[512];
    store(scratch("x.png"), "x", 1);
    const char *x = strrchr(scratch("x.png"), '/') + 1;
    snprintf(text, sizeof text, "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\"\n"
             "Material \"matte\" \"string normalmap\" \"%s\"", x, x);
    parsed p = parse(text);
    assert_int_equal(p.status, BIS_OK);
    const bis_material_textures *t = bis_textures_of(&p.desc->textures, p.desc->shapes[0].material);
    assert_true(t && t->normals == 1 && t->bump == BIS_NO_TEXTURE && t->Kd == BIS_NO_TEXTURE && t->power == 1);
    assert_true(p.desc->textures.n_files == 2 && p.desc->textures.files[0].gamma == BIS_GAMMA_SRGB &&
                p.desc->textures.files[1].gamma == 1);
    assert_true(p.desc->textures.files[1].loc.line == 4 && p.desc->textures.files[1].loc.column == 18);
    assert_true(t->loc.line == 4 && t->loc.column == 10);
    clear(&p);
}

/* ---- what each material is when little is said ---- */

/* The defaults of the page, and the limits of each parameter, by hand. alpha 0: Phong's, of exponent `width`. */
static void each_material_has_its_defaults(void **state)
{
    static const struct { const char *material; double Kd[3], Ks[3], alpha, exponent; } cases[] = {
        {"\"phong\"", {.5, .5, .5}, {0, 0, 0}, 0, 50},
        {"\"phong\" \"rgb Kd\" [0 0.25 1] \"rgb Ks\" [1 0.5 0] \"float exponent\" 0", {0, .25, 1}, {1, .5, 0}, 0, 0},
        {"\"phong\" \"float Kd\" 0.6 \"float Ks\" 0.4", {.6, .6, .6}, {.4, .4, .4}, 0, 50},
         /* as floats a little above 1: no warning */
        {"\"diffuse\"", {.5, .5, .5}, {0, 0, 0}, 0, 50},
        {"\"diffuse\" \"rgb reflectance\" [0.1 0.2 0.3] \"float sigma\" 0", {.1, .2, .3}, {0, 0, 0}, 0, 50},
        {"\"matte\" \"rgb Kd\" [0.1 0.2 0.3]", {.1, .2, .3}, {0, 0, 0}, 0, 50},
        {"\"microfacet\"", {0, 0, 0}, {.9, .9, .9}, .25, 0},
        {"\"microfacet\" \"rgb Kd\" [0.1 0.2 0.3] \"rgb Ks\" [0.4 0.5 0.6] \"float roughness\" 0.01", {.1, .2, .3},
         {.4, .5, .6}, 1e-4, 0},
        {"\"microfacet\" \"float Kd\" 1 \"float Ks\" 0.5 \"float roughness\" 1", {1, 1, 1}, {.5, .5, .5}, 1, 0},
        {"\"plastic\" \"bool remaproughness\" false", {.25, .25, .25}, {.01, .01, .01}, .1, 0},
        {"\"plastic\" \"rgb Ks\" [1 0.5 0] \"bool remaproughness\" false \"float roughness\" 0.3", {.25, .25, .25},
         {.04, .02, 0}, .3, 0},
        {"\"uber\" \"bool remaproughness\" false", {.25, .25, .25}, {.01, .01, .01}, .1, 0},
        {"\"uber\" \"float Ks\" 1 \"float index\" 3 \"bool remaproughness\" false", {.25, .25, .25}, {.25, .25, .25},
         .1, 0},
        {"\"uber\" \"float Ks\" 1 \"float eta\" 3 \"bool remaproughness\" false \"float Kr\" 0 \"float Kt\" 0 \"float "
         "opacity\" 1", {.25, .25, .25},
         {.25, .25, .25}, .1, 0},
        {"\"substrate\" \"bool remaproughness\" false", {.5, .5, .5}, {.5, .5, .5}, .1, 0},
        {"\"coateddiffuse\" \"float eta\" 1 \"float thickness\" 0 \"float roughness\" 0.25", {.5, .5, .5}, {0, 0, 0},
         .5, 0}, /* no coat */
        {"\"coateddiffuse\" \"float eta\" 10 \"float roughness\" 0.25 \"float reflectance\" 0", {0, 0, 0},
         {81 / 121.0, 81 / 121.0, 81 / 121.0}, .5, 0},
        {"\"coateddiffuse\" \"float reflectance\" 0 \"float roughness\" 0.25 \"float thickness\" 1 \"float g\" 0.5 "
         "\"integer maxdepth\" 3 "
         "\"integer nsamples\" 2 \"float albedo\" 0", {0, 0, 0}, {.04, .04, .04}, .5, 0},
        {"\"conductor\" \"rgb reflectance\" [0.1 0.2 0.3] \"float uroughness\" 0.04 \"float vroughness\" 0.04",
         {0, 0, 0}, {.1, .2, .3}, .2, 0},
        {"\"conductor\" \"rgb reflectance\" [0.1 0.2 0.3] \"float roughness\" 1", {0, 0, 0}, {.1, .2, .3}, 1, 0},
         /* alpha 1 is no warning */
        {"\"conductor\" \"rgb reflectance\" [0.1 0.2 0.3] \"float roughness\" 1e-4 \"bool remaproughness\" false",
         {0, 0, 0}, {.1, .2, .3}, 1e-4, 0},
        /* ((n - 1)^2 + k^2)/((n + 1)^2 + k^2) */
        {"\"conductor\" \"rgb eta\" [1 2 3] \"rgb k\" [2 0 1] \"float roughness\" 0.25", {0, 0, 0},
         {.5, 1 / 9.0, 5 / 17.0}, .5, 0},
        {"\"metal\" \"rgb eta\" [3 1 2] \"float k\" 2 \"bool remaproughness\" false", {0, 0, 0}, {.4, .5, 5 / 13.0},
         .01, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[400];
        snprintf(text, sizeof text, "Material %s", cases[i].material);
        const bis_material m = material(text, NULL);
        assert_rgb(m.Kd, cases[i].Kd[0], cases[i].Kd[1], cases[i].Kd[2], 1e-6);
        assert_rgb(m.Ks, cases[i].Ks[0], cases[i].Ks[1], cases[i].Ks[2], 1e-6);
        assert_about(m.alpha, cases[i].alpha, 1e-9);
        assert_about(m.exponent, cases[i].exponent, 0);
    }
    material("Material \"phong\" \"rgb Kd\" [0.5 0.75 0.5] \"rgb Ks\" [0.5 0.5 0.5]",
        "scene.txt:3:10: warning: Kd + Ks is 1.25 in green: the material reflects more light than it receives. Make "
        "one of them smaller");
    material("Material \"phong\" \"rgb Kd\" [0.5 0.75 1] \"rgb Ks\" [0.5 0.25 0.5]", "warning: Kd + Ks is 1.5 in blue");
    material("Material \"phong\" \"rgb Kd\" [0.75 1 1] \"rgb Ks\" [0.5 1 0.5]", "warning: Kd + Ks is 1.25 in red");
}

static const struct { const char *material, *message; } limits[] = {
    {"\"conductor\" \"rgb reflectance\" [1 1 1] \"float eta\" 1 \"float k\" 1",
     "give \"reflectance\", or \"eta\" and \"k\""},
    {"\"conductor\" \"rgb reflectance\" [1 1 1] \"float k\" 1", "give \"reflectance\", or \"eta\" and \"k\""},
    {"\"conductor\" \"rgb eta\" [1 1 1]", "give both \"eta\" and \"k\", or none (copper)"},
    {"\"conductor\" \"spectrum k\" [400 1 700 2]", "give both \"eta\" and \"k\", or none (copper)"},
    {"\"conductor\" \"spectrum eta\" \"metal-Ti-eta\" \"spectrum k\" \"metal-Ti-k\"",
     "the metal of \"metal-Ti-eta\" is not known; bis has Ag, Al, Au, Cu, MgO and TiO2"},
    {"\"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Au-k\"", "must be of one metal"},
    {"\"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"rgb k\" [1 1 1]", "must be of one metal"},
    {"\"conductor\" \"spectrum eta\" \"metal-Ag-eta\"", "must be of one metal"},
    {"\"conductor\" \"float roughness\" 0.1 \"float uroughness\" 0.2", "anisotropic surfaces are not modelled"},
    {"\"conductor\" \"float roughness\" -0.1", "\"roughness\" is -0.1, must be "},
    {"\"conductor\" \"rgb reflectance\" [0 1.5 0]", "\"reflectance\" is 1.5, must be in [0, 1]"},
    {"\"conductor\" \"rgb eta\" [1 -1 1] \"rgb k\" [1 1 1]", "\"eta\" is -1, must be "},
    {"\"conductor\" \"rgb eta\" [1 1 1] \"rgb k\" [1 1 -1]", "\"k\" is -1, must be "},
    {"\"coateddiffuse\" \"float eta\" 10.5", "\"eta\" is 10.5, must be in [1, 10]"},
    {"\"coateddiffuse\" \"float eta\" 0.5", "\"eta\" is 0.5, must be in [1, 10]"},
    {"\"coateddiffuse\" \"float thickness\" -1", "\"thickness\" is -1, must be "},
    {"\"coateddiffuse\" \"float albedo\" 1.5", "\"albedo\" is 1.5, must be in [0, 1]"},
    {"\"coateddiffuse\" \"rgb albedo\" [0 0 0.1]", "a coat that scatters is not modelled: \"albedo\" must be 0"},
    {"\"uber\" \"float eta\" 0.009", "\"eta\" is 0.009, must be in [0.01, 100]"},
    {"\"uber\" \"float index\" 100.5", "\"index\" is 100.5, must be in [0.01, 100]"},
    {"\"uber\" \"rgb Kr\" [0 0 0.1]", "\"Kr\" must be 0"}, {"\"uber\" \"rgb Kt\" [0 0.1 0]", "\"Kt\" must be 0"},
    {"\"uber\" \"rgb opacity\" [1 1 0.5]", "\"opacity\" must be 1"},
    {"\"plastic\" \"rgb Kd\" [0 0 1.5]", "\"Kd\" is 1.5, must be in [0, 1]"},
    {"\"plastic\" \"rgb Ks\" [-0.5 0 0]", "\"Ks\" is -0.5, must be in [0, 1]"},
    {"\"substrate\" \"rgb Kd\" [0 0 1.5]", "\"Kd\" is 1.5, must be in [0, 1]"},
    {"\"phong\" \"float Ks\" -1", "\"Ks\" is -1, must be in [0, 1]"},
    {"\"phong\" \"float exponent\" -0.5", "\"exponent\" is -0.5, must be "},
    {"\"microfacet\" \"float roughness\" 0.009", "\"roughness\" is 0.009, must be in [0.01, 1]"},
    {"\"microfacet\" \"float roughness\" 1.01", "\"roughness\" is 1.01, must be in [0.01, 1]"},
    {"\"microfacet\" \"float Kd\" 1.5", "\"Kd\" is 1.5, must be in [0, 1]"},
    {"\"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5] \"xyz Kd\" [0.1 0.1 0.1]", "are the same: give one"},
    {"\"diffuse\" \"float sigma\" 0.1", "a rough diffuse surface (Oren and Nayar) is not modelled"},
};

/* One complaint a mistake, with its place and its words. */
static void each_parameter_of_a_material_has_its_limits(void **state)
{
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        char text[400];
        snprintf(text, sizeof text, "Material %s", limits[i].material);
        parsed p = parse(text);
        assert_int_equal(p.status, BIS_INPUT);
        if (p.diag.n_errors != 1 || !strstr(p.diag.messages[0].text, limits[i].message))
            fail_msg(
                "%s: %u errors, the first: %s", limits[i].material, (unsigned)p.diag.n_errors, p.diag.messages[0].text);
        clear(&p);
    }
}

/* A warning comes once a scene; a lobe of two widths has the mean one where it is asked for. */
static void what_a_roughness_becomes_is_told_once(void **state)
{
    parsed p = parse("Material \"conductor\"\nMaterial \"conductor\"\nMaterial \"conductor\" \"float roughness\" "
                     "2\nMaterial \"conductor\" \"float roughness\" 3");
    assert_int_equal(p.status, BIS_OK);
    assert_int_equal(p.diag.n, 2);
    assert_non_null(
        strstr(p.diag.messages[0].text, "a perfect mirror is not modelled: it becomes a lobe with alpha = 0.0001"));
    assert_non_null(
        strstr(p.diag.messages[1].text, "5:22: warning: this roughness has alpha = 1.414; it is taken as 1"));
    clear(&p);
}

static const struct { const char *scene, *message; } wrong_names[] = {
    {"Texture \"wood\" \"spectrum\" \"constant\"\nMaterial \"phong\" \"texture exponent\" \"wood\"",
     "4:18: error: texture \"wood\" is one of colours; \"exponent\" needs one of numbers, Texture \"wood\" "
     "\"float\""},
    {"Texture \"wood\" \"spectrum\" \"constant\"\nMaterial \"phong\" \"texture Kd\" \"woot\"",
     "4:18: error: texture \"woot\" is not defined (did you mean \"wood\"?); as in pbrt, Texture must stand before "
     "its first use"},
    {"Texture \"t\" \"float\" \"scale\" \"texture tex1\" \"t\"",
     "3:29: error: texture \"t\" would be made of itself: name one that is defined before"},
    {"Texture \"t\" \"vector\" \"scale\"", "3:13: error: a Texture is of type \"float\" or \"spectrum\" (or "
     "\"color\", \"rgb\"), not \"vector\""},
    {"Texture \"t\" \"float\" \"imagemap\"", "3:9: error: Texture \"imagemap\" needs \"string filename\""},
    {"Texture \"t\" \"float\" \"checkerboard\" \"integer dimension\" 4",
     "3:36: error: \"dimension\" is 4, must be in [2, 3]"},
    {"Texture \"t\" \"float\" \"constant\" \"float value\" 2 Material \"diffuse\" \"texture reflectance\" \"t\"",
     "\"reflectance\" is 2, must be in [0, 1]"},
    {"Texture \"t\" \"float\" \"mix\" \"float amount\" 1.5", "\"amount\" is 1.5, must be in [0, 1]"},
    {"Texture \"t\" \"float\" \"constant\" \"float value\" -1 Material \"diffuse\" \"texture reflectance\" \"t\"",
     "\"reflectance\" is -1, must be in [0, 1]"},
};

/* A texture that is defined twice, of the wrong kind, or not at all. */
static void names_of_textures_are_those_of_their_kind(void **state)
{
    /* a name of colours and the same of numbers are two */
    parsed p = parse("Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [0.1 0.2 0.3]\nTexture \"t\" \"float\" "
                     "\"constant\" \"float value\" 7\n"
                     "Material \"phong\" \"texture Kd\" \"t\" \"texture exponent\" \"t\"");
    assert_int_equal(p.status, BIS_OK);
    assert_int_equal(p.diag.n, 0);
    const bis_material *m = &p.desc->materials[p.desc->shapes[0].material];
    assert_rgb(m->Kd, .1, .2, .3, 1e-6);
    assert_true(m->exponent == 7);
    assert_null(bis_textures_of(&p.desc->textures, p.desc->shapes[0].material));
    clear(&p);
    assert_rgb(material("Texture \"t\" \"float\" \"constant\" \"float value\" 0.25\nTexture \"t\" \"float\" "
                        "\"constant\" \"float value\" 0.75\n"
                        "Material \"diffuse\" \"texture reflectance\" \"t\"",
                   "4:9: warning: texture \"t\" is defined again: the new one counts from here on")
                   .Kd,
        .75, .75, .75, 0);
    for (size_t i = 0; i < sizeof wrong_names / sizeof *wrong_names; i++) {
        p = parse(wrong_names[i].scene);
        assert_int_equal(p.status, BIS_INPUT);
        if (p.diag.n != 1 || !strstr(p.diag.messages[0].text, wrong_names[i].message))
            fail_msg("%s: %zu messages, the first: %s", wrong_names[i].scene, p.diag.n, p.diag.messages[0].text);
        clear(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reflectances_may_be_spectra_files_or_xyz),
        cmocka_unit_test(a_file_of_a_spectrum_has_pairs_of_numbers),
        cmocka_unit_test(light_may_be_a_black_body_or_xyz),
        cmocka_unit_test(a_conductor_that_reflects_nothing_has_no_eta),
        cmocka_unit_test(metals_reflect_on_average_what_their_spectra_do),
        cmocka_unit_test(named_metals_have_their_published_colours),
        cmocka_unit_test(roughness_becomes_pbrts_alpha),
        cmocka_unit_test(coats_are_what_their_index_says),
        cmocka_unit_test(a_textured_coat_is_the_coat_of_each_colour),
        cmocka_unit_test(each_material_has_its_defaults),
        cmocka_unit_test(each_parameter_of_a_material_has_its_limits),
        cmocka_unit_test(what_a_roughness_becomes_is_told_once),
        cmocka_unit_test(names_of_textures_are_those_of_their_kind),
        cmocka_unit_test(textures_of_constants_are_their_values),
        cmocka_unit_test(a_normal_map_is_linear),
        cmocka_unit_test(an_image_has_the_gamma_that_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
