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

/* Chromaticities of black bodies: Wyszecki and Stiles, Color Science, table 1(3.11); 2856 K is illuminant A. */
static void black_bodies_lie_on_plancks_locus(void **state)
{
    static const double known[][3] = {
        {2000, 0.5267, 0.4133}, {2856, 0.4476, 0.4074}, {5000, 0.3451, 0.3516}, {10000, 0.2807, 0.2884}};
    for (size_t i = 0; i < 4; i++) {
        const rgbd c = bis_spectrum_blackbody(known[i][0]);
        double xy[2];
        chromaticity(xy, c);
        assert_about(xy[0], known[i][1], 5e-4);
        assert_about(xy[1], known[i][2], 5e-4);
        assert_about(0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b, 1, 1e-12);
    }
    assert_true(isfinite(bis_spectrum_blackbody(500).r) && isfinite(bis_spectrum_blackbody(1e6).b));
}

static void white_is_white_and_a_part_of_the_spectrum_has_its_colour(void **state)
{
    const double grey[1][2] = {{550, 0.25}}, red[4][2] = {{400, 0}, {599, 0}, {600, 1}, {800, 1}};
    const rgbd g = bis_spectrum_reflected(&(bis_spectrum){grey, 1}),
               r = bis_spectrum_reflected(&(bis_spectrum){red, 4});
    assert_about(g.r, 0.25, 1e-12);
    assert_about(g.g, 0.25, 1e-12);
    assert_about(g.b, 0.25, 1e-12);
    assert_true(r.r > 0.9 && r.g < 0.05 && fabs(r.b) < 0.05);
    /* linear between its points, constant outside */
    const bis_spectrum ramp = {(const double[2][2]){{500, 1}, {600, 3}}, 2};
    assert_about(bis_spectrum_at(&ramp, 525), 1.5, 1e-12);
    assert_about(bis_spectrum_at(&ramp, 400), 1, 0);
    assert_about(bis_spectrum_at(&ramp, 700), 3, 0);
}

static void reflectances_may_be_spectra_files_or_xyz(void **state)
{
    char text[512];
    assert_rgb(
        material("Material \"diffuse\" \"spectrum reflectance\" [400 0.25 700 0.25]", NULL).Kd, 0.25, 0.25, 0.25, 1e-6);
    assert_rgb(material("Material \"matte\" \"spectrum Kd\" 0.5", NULL).Kd, 0.5, 0.5, 0.5, 1e-6);
    static const char spd[] = "# a grey\n300, 0.75\n\n900 0.75 # end\n";
    store(scratch("grey.spd"), spd, sizeof spd - 1);
    snprintf(text, sizeof text, "Material \"phong\" \"spectrum Kd\" \"%s\"", strrchr(scratch("grey.spd"), '/') + 1);
    assert_rgb(material(text, NULL).Kd, 0.75, 0.75, 0.75, 1e-6);
    /* half of D65's own white */
    assert_rgb(
        material("Material \"diffuse\" \"xyz reflectance\" [0.475235 0.5 0.544415]", NULL).Kd, 0.5, 0.5, 0.5, 1e-4);
    material("Material \"diffuse\" \"spectrum reflectance\" [500 0 520 1 540 0]", "of RGB; it is cut off to [0, 1]");
    /* white itself is inside, up to rounding */
    assert_rgb(material("Material \"diffuse\" \"spectrum reflectance\" [400 1 700 1]", NULL).Kd, 1, 1, 1, 0);
    assert_rgb(material("Material \"diffuse\" \"spectrum reflectance\" [400 1.01 700 1.01]",
                        "\"reflectance\" is the colour (1.01, 1.01, 1.01) of RGB; it is cut off to [0, 1]").Kd, 1, 1, 1,
                        0);
    assert_rgb(
        material("Material \"diffuse\" \"spectrum reflectance\" [400 1.00000001 700 1.00000001]", "(1, 1, 1)").Kd, 1, 1,
        1, 0);
    /* X = 0, Y = 0.1, Z = 0.1 by the same matrix: red below 0 */
    assert_rgb(material("Material \"diffuse\" \"xyz reflectance\" [0 0.1 0.1]", "is the colour (-0.2036, 0.1918, "
                                                                                "0.08532) of RGB; it is "
                                                                                "cut off to [0, 1]")
                   .Kd,
        0, 0.1918, 0.0853, 1e-4);
    refuse("Material \"diffuse\" \"spectrum reflectance\" [500 0 400 1]",
        "descend from 500 to 400: sort its pairs");
    refuse("Material \"diffuse\" \"spectrum reflectance\" [500 0 600]",
        "must be one number, or pairs of a wavelength in nm");
    for (int n = 3; n < 70; n += 2) { /* with the roughness before it their list is full at 15, 31 and 63 */
        char odd[1024] = "Material \"conductor\" \"float roughness\" 0.5 \"spectrum k\" [400 1] \"spectrum eta\" [";
        for (int i = 0; i < n; i++) snprintf(odd + strlen(odd), 16, "%d ", i % 2 ? 1 : 400 + i);
        strcat(odd, "]");
        refuse(odd, "must be one number, or pairs of a wavelength in nm");
        memmove(strstr(odd, "\"spectrum k"), strstr(odd, "\"spectrum eta"), strlen(strstr(odd, "\"spectrum eta")) + 1);
        refuse(odd, "must be one number, or pairs of a wavelength in nm");
    }
    refuse(
        "Material \"diffuse\" \"spectrum reflectance\" [500 -1]", "must be one number, or pairs of a wavelength in nm");
    refuse("Material \"diffuse\" \"spectrum reflectance\" \"no.spd\"", "cannot read");
    store(scratch("bad.spd"), "400 x", 5);
    snprintf(text, sizeof text, "Material \"phong\" \"spectrum Kd\" \"%s\"", strrchr(scratch("bad.spd"), '/') + 1);
    refuse(text, "is no spectrum: its value 2 is no number");
    store(scratch("bad.spd"), "300 0.75 900 0.75\0", 18); /* what follows a zero byte would be lost without a word */
    refuse(text, "bad.spd is no spectrum: there is a zero byte in it");
    const rgbd glow = bis_spectrum_blackbody(3000); /* in pbrt any colour may be one; this one is brighter than white */
    assert_rgb(material("Material \"diffuse\" \"blackbody reflectance\" 3000", "it is cut off to [0, 1]").Kd, 1, glow.g,
        glow.b, 1e-6);
}

/* Numbers between blanks and commas, with comments; all or nothing. No said: a grey of 3/4. */
static void a_file_of_a_spectrum_has_pairs_of_numbers(void **state)
{
    static const char pairs[] = "3:18: error: the spectrum \"Kd\" must be one number, or pairs of a wavelength in nm "
                                "and a value >= 0, wavelengths ascending",
                      falls[] = "3:18: error: the wavelengths of the spectrum \"Kd\" descend from 400 to 300: sort its "
                                "pairs; with --approximate: sorted by wavelength";
    static const struct { const char *text, *said; int number; } cases[] = {
        {"300,0.75,900,0.75", NULL, 0}, {"300\t0.75\r\n900\t0.75\r\n", NULL, 0}, {"#x\n300 0.75#y\n#z\n", NULL, 0},
        {"\n\n , 300 .75", NULL, 0}, {"300 0.75 # 5 5", NULL, 0}, {"#\r300 0.75", NULL, 0}, {"3e2 75e-2,", NULL, 0},
        {"", pairs, 0}, {"0.5", pairs, 0}, {"# 300 0.75", pairs, 0}, {"400 1 300 1", falls, 0}, {"400", pairs, 0},
        {"400 1 500", pairs, 0}, {"400 1e39", pairs, 0}, {"1e39 1", pairs, 0}, {"0 1", pairs, 0}, {"400 -1", pairs, 0},
        {"400 x", NULL, 2}, {"x", NULL, 1}, {"400 1 500 2z", NULL, 4}, {"400;1", NULL, 1}, {"400 1 500 -", NULL, 4},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256], said[400] = "";
        store(scratch("a.spd"), cases[i].text, strlen(cases[i].text));
        snprintf(text, sizeof text, "Material \"phong\" \"spectrum Kd\" \"%s\"", strrchr(scratch("a.spd"), '/') + 1);
        parsed p = parse(text);
        if (cases[i].said) snprintf(said, sizeof said, "%s:%s", scratch("scene.txt"), cases[i].said);
        else if (cases[i].number)
            snprintf(said, sizeof said, "%s:3:18: error: %s is no spectrum: its value %d is no number",
                     scratch("scene.txt"), scratch("a.spd"), cases[i].number);
        if (p.diag.n != (*said ? 1 : 0) || (*said && strcmp(p.diag.messages[0].text, said) != 0))
            fail_msg("%s: %zu messages, %s", cases[i].text, p.diag.n, p.diag.n ? p.diag.messages[0].text : "");
        if (!*said) assert_rgb(p.desc->materials[p.desc->shapes[0].material].Kd, .75, .75, .75, 1e-6);
        clear(&p);
    }
}

static void light_may_be_a_black_body_or_xyz(void **state)
{
    parsed p = {0};
    static const char a[] = "WorldBegin LightSource \"infinite\" \"blackbody L\" 2856 \"float scale\" 2",
                      b[] = "WorldBegin LightSource \"infinite\" \"xyz L\" [0.95047 1 1.08883]",
                      c[] = "WorldBegin LightSource \"infinite\" \"blackbody L\" [2856 2]",
                      d[] = "WorldBegin LightSource \"infinite\" \"xyz L\" [0 0.1 0.1]",
                      e[] = "WorldBegin LightSource \"infinite\" \"blackbody L\" [2856 2 1]";
    store(scratch("a.txt"), a, sizeof a - 1);
    assert_int_equal(bis_scene_parse(&p.desc, scratch("a.txt"), &p.diag), BIS_OK);
    const rgb L = p.desc->light.L;
    double xy[2];
    chromaticity(xy, (rgbd){(double)L.r, (double)L.g, (double)L.b});
    assert_about(xy[0], 0.4476, 5e-4);
    assert_about(xy[1], 0.4074, 5e-4);
    clear(&p);
    store(scratch("a.txt"), b, sizeof b - 1);
    assert_int_equal(bis_scene_parse(&p.desc, scratch("a.txt"), &p.diag), BIS_OK);
    assert_rgb(p.desc->light.L, 1, 1, 1, 1e-4);
    clear(&p);
    store(scratch("a.txt"), c, sizeof c - 1);
    assert_int_equal(bis_scene_parse(&p.desc, scratch("a.txt"), &p.diag), BIS_OK);
    chromaticity(xy, (rgbd){(double)p.desc->light.L.r, (double)p.desc->light.L.g, (double)p.desc->light.L.b});
    assert_about(xy[0], 0.4476, 5e-4); /* tests/foreign/scenes says how bright */
    assert_about(xy[1], 0.4074, 5e-4);
    clear(&p);
    store(scratch("a.txt"), e, sizeof e - 1); /* pbrt has two at most: nobody knows what three would mean */
    assert_int_equal(bis_scene_parse_as(&p.desc, scratch("a.txt"), BIS_PARSE_APPROXIMATE, &p.diag), BIS_INPUT);
    assert_non_null(strstr(p.diag.messages[0].text, "\"blackbody L\" has 3 values, must have one"));
    clear(&p);
    store(scratch("a.txt"), d, sizeof d - 1);
    assert_int_equal(bis_scene_parse(&p.desc, scratch("a.txt"), &p.diag), BIS_OK);
    assert_non_null(strstr(p.diag.messages[0].text, "\"L\" is the colour (-0.2036, 0.1918, 0.08532) of RGB; what is "
                           "negative becomes 0"));
    assert_rgb(p.desc->light.L, 0, 0.1918, 0.08532, 1e-4);
    clear(&p);
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

/* By numbers that anybody can check: k = 0 and n = 1.5 is glass, ((0.5)/(2.5))^2 = 0.04; n = 1 and k = 2 is 4/8. */
static void a_conductor_reflects_what_fresnel_says_head_on(void **state)
{
    const char *rough = "\"float roughness\" 0.25";
    char text[512];
    snprintf(text, sizeof text, "Material \"conductor\" \"rgb eta\" [1.5 1 1] \"rgb k\" [0 2 0] %s", rough);
    assert_rgb(material(text, NULL).Ks, 0.04, 0.5, 0, 1e-6);
    snprintf(text, sizeof text, "Material \"conductor\" \"float eta\" 1 \"float k\" 2 %s", rough);
    assert_rgb(material(text, NULL).Ks, 0.5, 0.5, 0.5, 1e-6);
    snprintf(text, sizeof text, "Material \"conductor\" \"spectrum eta\" [550 1.5] \"spectrum k\" [550 0] %s", rough);
    assert_rgb(material(text, NULL).Ks, 0.04, 0.04, 0.04, 1e-6);
    snprintf(text, sizeof text, "Material \"conductor\" \"rgb reflectance\" [0.9 0.6 0.3] %s", rough);
    assert_rgb(material(text, NULL).Ks, 0.9, 0.6, 0.3, 1e-6);
    refuse("Material \"conductor\" \"rgb reflectance\" [0.9 0.6 0.3] \"rgb eta\" [1 1 1]",
        "give \"reflectance\", or \"eta\" and \"k\"");
    refuse("Material \"conductor\" \"spectrum eta\" \"metal-CuZn-eta\" \"spectrum k\" \"metal-CuZn-k\"",
        "the metal of \"metal-CuZn-eta\" is not known; bis has Ag, Al, Au, Cu, MgO and TiO2: give \"rgb reflectance\", "
        "or eta and k as spectra; with --approximate: gold");
    refuse("Material \"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Au-k\"",
        "must be of one metal");
    static const char *const alone[] = {"rgb eta\" [1 1 1]", "rgb k\" [1 1 1]", "float eta\" 1", "float k\" 1",
        "spectrum eta\" [400 1 500 2]", "spectrum k\" [400 1 500 2]"};
    for (size_t i = 0; i < sizeof alone / sizeof *alone; i++) {
        snprintf(text, sizeof text, "Material \"conductor\" \"%s", alone[i]);
        refuse(text, "give both \"eta\" and \"k\"");
    }
    /* what reflects nothing has no eta, but Schlick's curve, which is then constant */
    const bis_material nothing =
        material("Material \"conductor\" \"spectrum eta\" [550 1] \"spectrum k\" [550 0] \"float roughness\" 1", NULL);
    assert_rgb(nothing.Ks, 0, 0, 0, 0);
    assert_rgb(nothing.eta, 0, 0, 0, 0);
    /* of two that are there and bad, each is complained of, and nothing else */
    parsed p =
        parse("Material \"conductor\" \"spectrum eta\" [500 -1] \"spectrum k\" [500 -2] \"float roughness\" 0.25");
    assert_int_equal(p.diag.n, 2);
    clear(&p);
}

/* Published colours of metals head on (S. Lagarde, "Feeding a physically based shading model", 2011, from the same
 * constants): copper 0.955 0.638 0.538, gold 1.022 0.782 0.344, silver 0.972 0.960 0.915, aluminium 0.913 0.922 0.924.
 * They are cut off in the third digit. */
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
    const uint32_t index = p.desc->shapes[0].material;
    assert_rgb(bis_textures_material(&p.desc->textures, NULL, bis_textures_of(&p.desc->textures, index),
                   &p.desc->materials[index], (double[]){0.5, 0.5}, (vec3){0, 0, 0})
                   .eta,
        1, 1, 1, 0);
    clear(&p);
}

static void named_metals_have_their_published_colours(void **state)
{
    assert_rgb(material("Material \"conductor\" \"float roughness\" 0.1", NULL).Ks, 0.955, 0.638, 0.538, 1e-3);
    assert_rgb(material("Material \"conductor\" \"float roughness\" 0.1\n"
        "\"spectrum eta\" [" COPPER_ETA "] \"spectrum k\" [" COPPER_K "]", NULL).Ks, 0.955, 0.638, 0.538, 4e-3);
    assert_rgb(material("Material \"metal\"", NULL).Ks, 0.955, 0.638, 0.538, 1e-3);
    assert_rgb(material("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\" "
                        "\"float roughness\" 0.1",
                   NULL)
                   .Ks,
        1, 0.782, 0.344, 1e-3);
    assert_rgb(material("Material \"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\" "
                        "\"float roughness\" 0.1",
                   NULL)
                   .Ks,
        0.972, 0.960, 0.915, 1e-3);
    assert_rgb(material("Material \"conductor\" \"spectrum eta\" \"metal-Al-eta\" \"spectrum k\" \"metal-Al-k\" "
                        "\"float roughness\" 0.1",
                   NULL)
                   .Ks,
        0.913, 0.922, 0.924, 1e-3);
    /* copper is pbrt's own: its eta or its k alone says enough, of another metal both are needed */
    static const char *const alone[] = {"eta", "k"};
    for (int i = 0; i < 2; i++) {
        char text[128];
        snprintf(text, sizeof text, "Material \"conductor\" \"spectrum %s\" \"metal-Cu-%s\" \"float roughness\" 0.1",
            alone[i], alone[i]);
        assert_rgb(material(text, NULL).Ks, 0.955, 0.638, 0.538, 1e-3);
        snprintf(text, sizeof text, "Material \"conductor\" \"spectrum %s\" \"metal-Ag-%s\" \"float roughness\" 0.1",
            alone[i], alone[i]);
        refuse(text, "\"eta\" and \"k\" must be of one metal");
    }
}

/* pbrt-v4: alpha = sqrt(roughness); pbrt-v3: its polynomial, here as python computes it; bis's own alpha is what
 * counts. */
static void roughness_becomes_pbrts_alpha(void **state)
{
    assert_about(material("Material \"conductor\" \"float roughness\" 0.25", NULL).alpha, 0.5, 1e-12);
    assert_about(material("Material \"conductor\" \"float roughness\" 0.25 \"bool remaproughness\" false", NULL).alpha,
        0.25, 1e-12);
    assert_about(
        material("Material \"conductor\" \"float uroughness\" 0.04 \"float vroughness\" 0.04", NULL).alpha, 0.2, 1e-12);
    assert_about(material("Material \"metal\" \"float roughness\" 0.1", NULL).alpha, 0.46176003200863397, 1e-9);
    assert_about(material("Material \"metal\"", NULL).alpha, 0.13892440927807698, 1e-9);
    assert_about(material("Material \"plastic\"", NULL).alpha, 0.46176003200863397, 1e-9);
    assert_about(
        material("Material \"metal\" \"float roughness\" 0.3 \"bool remaproughness\" false", NULL).alpha, 0.3, 1e-12);
    assert_about(
        material("Material \"conductor\"", "a perfect mirror is not modelled: it becomes a lobe with alpha = 0.0001")
            .alpha,
        1e-4, 1e-12);
    assert_about(
        material("Material \"metal\" \"float roughness\" 0.5", "this roughness has alpha = 1.1").alpha, 1, 1e-12);
    refuse("Material \"conductor\" \"float uroughness\" 0.1 \"float vroughness\" 0.2",
        "anisotropic surfaces are not modelled");
}

static void textures_of_roughness_are_remapped_as_constants_are(void **state)
{
    parsed p = parse("Texture \"r\" \"float\" \"checkerboard\" \"float tex1\" 0.0625 \"float tex2\" 0.25\nMaterial "
                     "\"conductor\" \"texture roughness\" \"r\"");
    assert_int_equal(p.status, BIS_OK);
    const uint32_t index = p.desc->shapes[0].material;
    const bis_material_textures *t = bis_textures_of(&p.desc->textures, index);
    assert_non_null(t);
    const bis_material *base = &p.desc->materials[index];
    assert_about(bis_textures_material(&p.desc->textures, NULL, t, base, (double[]){0.5, 0.5}, (vec3){0, 0, 0}).alpha,
        0.25, 1e-9);
    assert_about(bis_textures_material(&p.desc->textures, NULL, t, base, (double[]){1.5, 0.5}, (vec3){0, 0, 0}).alpha,
        0.5, 1e-9);
    clear(&p);
}

/* pbrt-v3's polynomial as python computes it; what is rougher than bis has is 1. Without remapping the value is alpha.
 */
static void textures_of_roughness_of_pbrt_v3_are_remapped_too(void **state)
{
    /* typical: of the mean of both */
    static const struct { const char *rest; double alpha[2], typical; } cases[] = {
        {"\"float tex1\" 0.1 \"float tex2\" 0.3 Material \"metal\" \"texture roughness\" \"r\"",
         {0.46176003200863414, 0.8570364675174545}, 0.6838364252513122},
        {"\"float tex1\" 0.01 \"float tex2\" 0.4 Material \"plastic\" \"texture roughness\" \"r\"",
         {0.13892440927807703, 1}, 0.6933838275608094},
        {"\"float tex1\" 0 \"float tex2\" 0.75 Material \"substrate\" \"texture roughness\" \"r\"",
         {0.047269450828605786, 1}, 0.9684381966903411},
        {"\"float tex1\" 0.1 \"float tex2\" 0.3 Material \"metal\" \"texture roughness\" \"r\" \"bool remaproughness\" "
         "false", {.1, .3}, .2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[300];
        snprintf(text, sizeof text, "Texture \"r\" \"float\" \"checkerboard\" %s", cases[i].rest);
        parsed p = parse(text);
        assert_int_equal(p.status, BIS_OK);
        const uint32_t index = p.desc->shapes[0].material;
        const bis_material_textures *t = bis_textures_of(&p.desc->textures, index);
        assert_non_null(t);
        assert_about(p.desc->materials[index].alpha, cases[i].typical, 1e-9);
        const bis_texture *x = &p.desc->textures.list[t->width];
        const bool is_remapped = i < 3;
        assert_true(t->power == 0.5 && x->kind == (is_remapped ? BIS_TEXTURE_ALPHA : BIS_TEXTURE_CHECKERBOARD));
        assert_true(x->steps == (is_remapped ? 4 : 3) && x->of[0] == (is_remapped ? t->width - 1 : 0));
        if (is_remapped) assert_about(x->value.r + x->value.g + x->value.b, 3 * cases[i].typical, 1e-9);
        for (int k = 0; k < 2; k++)
            assert_about(bis_textures_material(&p.desc->textures, NULL, t, &p.desc->materials[index],
                             (double[]){0.5 + k, 0.5}, (vec3){0, 0, 0})
                             .alpha,
                cases[i].alpha[k], 1e-9);
        clear(&p);
    }
}

/* Of oxides without absorption: ((n - 1)/(n + 1))^2 with the index at 611, 549 and 464 nm, where red, green and blue
 * are. */
static void oxides_reflect_as_their_indices_say(void **state)
{
    assert_rgb(material("Material \"conductor\" \"spectrum eta\" \"metal-MgO-eta\" \"spectrum k\" \"metal-MgO-k\" "
                        "\"float roughness\" 0.1",
                   NULL)
                   .Ks,
        .0724, .0730, .0745, 1e-3);
    assert_rgb(material("Material \"conductor\" \"spectrum eta\" \"metal-MgO-eta\" \"spectrum k\" \"metal-MgO-k\" "
                        "\"float roughness\" 0.1",
                   NULL)
                   .eta,
        1.7362, 1.7406, 1.7505, 4e-3);
    assert_rgb(material("Material \"conductor\" \"spectrum eta\" \"metal-TiO2-eta\" \"spectrum k\" \"metal-TiO2-k\" "
                        "\"float roughness\" 0.1",
                   NULL)
                   .Ks,
        .236, .244, .265, 1e-2);
    assert_rgb(material("Material \"conductor\" \"spectrum eta\" \"metal-TiO2-eta\" \"spectrum k\" \"metal-TiO2-k\" "
                        "\"float roughness\" 0.1",
                   NULL)
                   .eta,
        2.889, 2.955, 3.12, .07);
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
    refuse("Material \"uber\" \"float index\" 100.5", "\"index\" is 100.5, must be in [0.01, 100]");
    refuse("Material \"uber\" \"float eta\" 0.009", "\"eta\" is 0.009, must be in [0.01, 100]");
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
    refuse("Material \"coateddiffuse\" \"float thickness\" -1", "\"thickness\" is -1, must be ");
    refuse("Material \"uber\" \"rgb opacity\" [1 0.5 1]", "\"opacity\" must be 1");
    refuse("Material \"uber\" \"rgb Kt\" [1 0.5 1]", "\"Kt\" must be 0");
    refuse("Material \"coateddiffuse\" \"float albedo\" 0.5", "\"albedo\" must be 0");
    refuse("Material \"coateddiffuse\" \"float eta\" 0.5", "\"eta\" is 0.5, must be in [1, 10]");
}

static void a_textured_coat_is_the_coat_of_each_colour(void **state)
{
    parsed p = parse("Texture \"k\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.5 \"rgb tex2\" [1 0 0.5]\nMaterial "
                     "\"coateddiffuse\" \"texture reflectance\" \"k\" \"float roughness\" 0.25");
    assert_int_equal(p.status, BIS_OK);
    uint32_t index = p.desc->shapes[0].material;
    const bis_material_textures *t = bis_textures_of(&p.desc->textures, index);
    assert_rgb(bis_textures_material(
                   &p.desc->textures, NULL, t, &p.desc->materials[index], (double[]){0.5, 0.5}, (vec3){0, 0, 0})
                   .Kd,
        0.19581, 0.19581, 0.19581, 3e-4);
    assert_rgb(bis_textures_material(
                   &p.desc->textures, NULL, t, &p.desc->materials[index], (double[]){1.5, 0.5}, (vec3){0, 0, 0})
                   .Kd,
        0.47028, 0, 0.19581, 3e-4);
    assert_int_equal(bis_textures_check(&p.desc->textures, NULL, t, &p.desc->materials[index], &p.diag), BIS_OK);
    clear(&p);
    p = parse("Texture \"k\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.5 \"rgb tex2\" [1 0 0.5]\nMaterial "
              "\"plastic\" \"texture Kd\" \"k\" \"texture Ks\" \"k\"");
    assert_int_equal(p.status, BIS_OK);
    index = p.desc->shapes[0].material;
    t = bis_textures_of(&p.desc->textures, index);
    const bis_material m = bis_textures_material(
        &p.desc->textures, NULL, t, &p.desc->materials[index], (double[]){1.5, 0.5}, (vec3){0, 0, 0});
    assert_rgb(m.Kd, 1, 0, 0.5, 1e-6);
    assert_rgb(m.Ks, 0.04, 0, 0.02, 1e-6);
    assert_ptr_equal(m.model, &bis_plastic_model);
    assert_rgb(m.eta, 1.5, 1.5, 1.5, 0);
    clear(&p);
    /* plastic, too, has a roughness in [0.01, 1], of a texture or not */
    p = parse("Texture \"r\" \"float\" \"checkerboard\" \"float tex1\" 0.16 \"float tex2\" 1.5\nMaterial \"plastic\" "
              "\"texture roughness\" \"r\" "
              "\"bool remaproughness\" false");
    index = p.desc->shapes[0].material;
    t = bis_textures_of(&p.desc->textures, index);
    assert_about(bis_textures_material(
                     &p.desc->textures, NULL, t, &p.desc->materials[index], (double[]){0.5, 0.5}, (vec3){0, 0, 0})
                     .alpha,
        0.16, 1e-9);
    assert_int_equal(bis_textures_check(&p.desc->textures, NULL, t, &p.desc->materials[index], &p.diag), BIS_INPUT);
    assert_non_null(strstr(p.diag.messages[0].text, "roughness"));
    clear(&p);
}

/* A texture that is made of constants is one: what it is follows by hand from the shares and factors. */
static void textures_of_constants_are_their_values(void **state)
{
#define DULL " Material \"diffuse\" \"texture reflectance\" \"m\""
    assert_rgb(material("Texture \"m\" \"spectrum\" \"mix\" \"rgb tex1\" [0.2 0 1] \"rgb tex2\" [1 0.5 0] \"float "
                        "amount\" 0.25" DULL,
                   NULL)
                   .Kd,
        0.4, 0.125, 0.75, 1e-6);
    assert_rgb(material("Texture \"m\" \"spectrum\" \"mix\" \"rgb tex1\" [0.2 0 1] \"rgb tex2\" [1 0.5 0] \"float "
                        "amount\" 1" DULL,
                   NULL)
                   .Kd,
        1, 0.5, 0, 1e-6);
    assert_rgb(
        material("Texture \"m\" \"spectrum\" \"mix\" \"rgb tex1\" [0.2 0 1] \"rgb tex2\" [1 0.5 0]" DULL, NULL).Kd, 0.6,
        0.25, 0.5, 1e-6);
    assert_rgb(
        material("Texture \"m\" \"spectrum\" \"scale\" \"rgb tex1\" [0.5 1 0.25] \"rgb tex2\" [0.5 0.75 1]" DULL, NULL)
            .Kd,
        0.25, 0.75, 0.25, 1e-6);
    assert_rgb(material("Texture \"k\" \"float\" \"scale\" \"float tex1\" 0.5 \"float tex2\" 0.25\n"
                        "Texture \"s\" \"spectrum\" \"scale\" \"rgb tex1\" [0.5 1 0.25] \"rgb tex2\" [0.5 0.75 1]\n"
                        "Texture \"m\" \"spectrum\" \"mix\" \"texture tex1\" \"s\" \"rgb tex2\" [0.25 0.25 0.25] "
                        "\"texture amount\" \"k\""
                        DULL, NULL).Kd, 0.25, 0.6875, 0.25, 1e-6);
#undef DULL
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
    static const char *const wrong[] = {"gamma 0", "gamma -1", "gamma 100.1", "gamma nan", "gamma x", "gamma ", "gamma",
        "gamma 2 ", "srgb", "linear ", ""};
    char text[1024], message[160], x[64], y[64];
    store(scratch("x.png"), "x", 1); /* opened by the build alone */
    snprintf(x, sizeof x, "%s", strrchr(scratch("x.png"), '/') + 1);
    store(scratch("y.png"), "y", 1);
    snprintf(y, sizeof y, "%s", strrchr(scratch("y.png"), '/') + 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" %s\n"
                 "Texture \"b\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" %s\n"
                 "Texture \"c\" \"float\" \"imagemap\" \"string filename\" \"%s\" \"string encoding\" \"gamma 3\"\n"
                 "Texture \"d\" \"float\" \"imagemap\" \"string filename\" \"%s\" %s\n", x, cases[i].words, x,
                 cases[i].words, x, y,
                 cases[i].words);
        parsed p = parse(text);
        assert_int_equal(p.status, BIS_OK);
        const bis_textures *t = &p.desc->textures;
        assert_int_equal(t->n_files, 3);
        assert_true(
            t->files[0].gamma == cases[i].gamma && t->files[1].gamma == 3 && t->files[2].gamma == cases[i].gamma);
        assert_string_equal(strrchr(t->files[1].filename, '/') + 1, x);
        assert_string_equal(strrchr(t->files[2].filename, '/') + 1, y);
        static const uint32_t images[] = {0, 0, 1, 2};
        const bis_texture *of = &t->list[t->n - 4];
        for (size_t k = 0; k < 4; k++) assert_true(of[k].kind == BIS_TEXTURE_IMAGE && of[k].image == images[k]);
        clear(&p);
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(text, sizeof text,
            "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" \"string encoding\" \"%s\"", x,
            wrong[i]);
        snprintf(message, sizeof message,
            "error: \"encoding\" is \"%s\", must be \"sRGB\", \"linear\" or \"gamma X\", X in (0, 100]", wrong[i]);
        refuse(text, message);
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
     "3:22: error: give \"reflectance\", or \"eta\" and \"k\""},
    {"\"conductor\" \"rgb reflectance\" [1 1 1] \"float eta\" 1",
     "3:22: error: give \"reflectance\", or \"eta\" and \"k\""},
    {"\"conductor\" \"rgb reflectance\" [1 1 1] \"float k\" 1",
     "3:22: error: give \"reflectance\", or \"eta\" and \"k\""},
    {"\"conductor\" \"rgb eta\" [1 1 1]", "3:10: error: give both \"eta\" and \"k\", or none (copper), or \"rgb "
     "reflectance\""},
    {"\"conductor\" \"rgb k\" [1 1 1]", "3:10: error: give both \"eta\" and \"k\", or none (copper), or \"rgb "
     "reflectance\""},
    {"\"conductor\" \"spectrum eta\" [400 1 700 2]",
     "3:10: error: give both \"eta\" and \"k\", or none (copper), or \"rgb reflectance\""},
    {"\"conductor\" \"spectrum k\" [400 1 700 2]",
     "3:10: error: give both \"eta\" and \"k\", or none (copper), or \"rgb reflectance\""},
    {"\"conductor\" \"spectrum eta\" \"metal-Ti-eta\" \"spectrum k\" \"metal-Ti-k\"",
     "3:22: error: the metal of \"metal-Ti-eta\" is not known; bis has Ag, Al, Au, Cu, MgO and TiO2: give \"rgb "
     "reflectance\", or eta and k as spectra; with --approximate: aluminium"},
    {"\"conductor\" \"rgb eta\" [1 1 1] \"spectrum k\" \"metal-Ti-k\"",
     "error: the metal of \"metal-Ti-k\" is not known; bis has Ag, Al, Au, Cu, MgO and TiO2: give \"rgb "
     "reflectance\", or eta and k as spectra; with --approximate: aluminium"},
    {"\"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Au-k\"",
     "3:52: error: \"eta\" and \"k\" must be of one metal"},
    {"\"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Au-k\"",
     "3:52: error: \"eta\" and \"k\" must be of one metal"},
    {"\"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"rgb k\" [1 1 1]",
     "3:52: error: \"eta\" and \"k\" must be of one metal"},
    {"\"conductor\" \"rgb eta\" [1 1 1] \"spectrum k\" \"metal-Cu-k\"",
     "error: \"eta\" and \"k\" must be of one metal"},
    {"\"conductor\" \"spectrum eta\" \"metal-Ag-eta\"", "3:22: error: \"eta\" and \"k\" must be of one metal"},
    {"\"conductor\" \"float roughness\" 0.1 \"float uroughness\" 0.2",
     "3:44: error: \"uroughness\" and \"vroughness\" differ: anisotropic surfaces are not modelled, give both the "
     "same value"},
    {"\"conductor\" \"float roughness\" 0.1 \"float uroughness\" 0.2 \"float vroughness\" 0.3",
     "3:67: error: \"uroughness\" and \"vroughness\" differ"},
    {"\"conductor\" \"float roughness\" -0.1", "\"roughness\" is -0.1, must be "},
    {"\"conductor\" \"rgb reflectance\" [0 1.5 0]", "\"reflectance\" is 1.5, must be in [0, 1]"},
    {"\"conductor\" \"rgb eta\" [1 -1 1] \"rgb k\" [1 1 1]", "\"eta\" is -1, must be "},
    {"\"conductor\" \"rgb eta\" [1 1 1] \"rgb k\" [1 1 -1]", "\"k\" is -1, must be "},
    {"\"coateddiffuse\" \"float eta\" 10.5", "\"eta\" is 10.5, must be in [1, 10]"},
    {"\"coateddiffuse\" \"float albedo\" 1.5", "\"albedo\" is 1.5, must be in [0, 1]"},
    {"\"coateddiffuse\" \"float albedo\" 0.001", "3:26: error: a coat that scatters is not modelled: \"albedo\" "
     "must be 0; with --approximate: the coat is clear"},
    {"\"coateddiffuse\" \"rgb albedo\" [0 0 0.1]", "\"albedo\" must be 0; with --approximate: the coat is clear"},
    {"\"coateddiffuse\" \"spectrum albedo\" [400 0.5 700 0.5]",
     "\"albedo\" must be 0; with --approximate: the coat is clear"},
    {"\"uber\" \"float eta\" 0", "\"eta\" is 0, must be "},
    {"\"uber\" \"float index\" 0", "\"index\" is 0, must be "},
    {"\"uber\" \"rgb Kr\" [0.1 0 0]", "an \"uber\" that is a mirror or lets light through is not modelled: \"Kr\" "
     "must be 0"},
    {"\"uber\" \"rgb Kr\" [0 0 0.1]", "\"Kr\" must be 0"},
    {"\"uber\" \"rgb Kt\" [0 0.1 0]", "\"Kt\" must be 0"},
    {"\"uber\" \"rgb opacity\" [0.5 1 1]", "\"opacity\" must be 1"},
    {"\"uber\" \"rgb opacity\" [1 1 0.5]", "\"opacity\" must be 1"},
    {"\"plastic\" \"rgb Kd\" [0 0 1.5]", "\"Kd\" is 1.5, must be in [0, 1]"},
    {"\"plastic\" \"rgb Ks\" [-0.5 0 0]", "\"Ks\" is -0.5, must be in [0, 1]"},
    {"\"substrate\" \"rgb Kd\" [0 0 1.5]", "\"Kd\" is 1.5, must be in [0, 1]"},
    {"\"substrate\" \"rgb Ks\" [0 1.5 0]", "\"Ks\" is 1.5, must be in [0, 1]"},
    {"\"phong\" \"rgb Kd\" [1.5 0 0]", "\"Kd\" is 1.5, must be in [0, 1]"},
    {"\"phong\" \"float Ks\" -1", "\"Ks\" is -1, must be in [0, 1]"},
    {"\"phong\" \"float exponent\" -0.5", "\"exponent\" is -0.5, must be "},
    {"\"microfacet\" \"float roughness\" 0.009", "\"roughness\" is 0.009, must be in [0.01, 1]"},
    {"\"microfacet\" \"float roughness\" 1.01", "\"roughness\" is 1.01, must be in [0.01, 1]"},
    {"\"microfacet\" \"float Kd\" 1.5", "\"Kd\" is 1.5, must be in [0, 1]"},
    {"\"microfacet\" \"float Ks\" 1.5", "\"Ks\" is 1.5, must be in [0, 1]"},
    {"\"diffuse\" \"float reflectance\" 0.5 \"float Kd\" 0.5",
     "error: \"Kd\" and \"reflectance\" are the same: give one"},
    {"\"diffuse\" \"spectrum reflectance\" [400 0.5] \"float Kd\" 0.5",
     "error: \"Kd\" and \"reflectance\" are the same: give one"},
    {"\"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5] \"xyz Kd\" [0.1 0.1 0.1]",
     "error: \"Kd\" and \"reflectance\" are the same: give one"},
    {"\"diffuse\" \"xyz reflectance\" [0.1 0.1 0.1] \"rgb Kd\" [0.5 0.5 0.5]",
     "error: \"Kd\" and \"reflectance\" are the same: give one"},
    {"\"diffuse\" \"spectrum reflectance\" [400 -1] \"float Kd\" 0.5",
     "must be one number, or pairs of a wavelength in nm"},
    {"\"diffuse\" \"float sigma\" 0.1", "a rough diffuse surface (Oren and Nayar) is not modelled: \"sigma\" must "
     "be 0"},
    {"\"diffuse\" \"float reflectance\" 1.5", "\"reflectance\" is 1.5, must be in [0, 1]"},
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

/* ---- textures of materials: the typical value stands in the description ---- */

#define BOARD "Texture \"b\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0.5 0] \"rgb tex2\" [0.5 0 0.25]\n"
#define BLACK "Texture \"b\" \"spectrum\" \"checkerboard\" \"float tex1\" 1\n"
static const struct { const char *texture; double typical[3]; unsigned steps; } textured[] = {
    {BOARD "Texture \"t\" \"spectrum\" \"scale\" \"texture tex1\" \"b\" \"rgb tex2\" [0.5 1 0.5]",
     {.375, .25, .0625}, 5},
    {BOARD "Texture \"t\" \"color\" \"mix\" \"texture tex1\" \"b\" \"float amount\" 0.25", {.8125, .4375, .34375},
     6}, /* tex2 is 1 */
    {BOARD "Texture \"t\" \"rgb\" \"mix\" \"texture tex2\" \"b\"", {.375, .125, .0625}, 6},
     /* tex1 is 0, amount 1/2 */
    {BOARD "Texture \"t\" \"spectrum\" \"checkerboard\" \"texture tex2\" \"b\"", {.875, .625, .5625}, 5},
     /* tex1 is 1 */
    {BOARD "Texture \"t\" \"spectrum\" \"checkerboard\" \"texture tex1\" \"b\"", {.375, .125, .0625}, 5},
     /* tex2 is 0 */
    {BLACK "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"b\"", {.5, .5, .5}, 5}, /* scale is 1 */
    {BLACK "Texture \"t\" \"spectrum\" \"scale\" \"texture scale\" \"b\" \"float tex\" 5", {1, 1, 1}, 5},
     /* 2.5, cut to [0, 1] */
    {"Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"x.png\"", {.5, .5, .5}, 1},
    {"Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"x.png\" \"float scale\" 0.25",
     {.125, .125, .125}, 1},
    {"Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"x.png\" \"float scale\" 0.25 \"bool invert\" "
     "true", {.5, .5, .5}, 1},
    {"Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"x.png\" \"float scale\" 0", {0, 0, 0}, 1},
};

static void a_textured_material_has_a_typical_value_and_counts_its_steps(void **state)
{
    char x[64], text[1024];
    store(scratch("x.png"), "x", 1);
    snprintf(x, sizeof x, "%s", strrchr(scratch("x.png"), '/') + 1);
    for (size_t i = 0; i < sizeof textured / sizeof *textured; i++) {
        const char *name = strstr(textured[i].texture, "x.png");
        if (name)
            snprintf(text, sizeof text, "%.*s%s%s", (int)(name - textured[i].texture), textured[i].texture, x,
                     name + 5);
        else snprintf(text, sizeof text, "%s", textured[i].texture);
        strcat(text, "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"");
        parsed p = parse(text);
        if (p.status || p.diag.n) fail_msg("%s: %s", text, p.diag.messages[0].text);
        const uint32_t index = p.desc->shapes[0].material;
        const bis_material_textures *t = bis_textures_of(&p.desc->textures, index);
        assert_true(t && t->Kd == p.desc->textures.n - 1 && t->Ks == BIS_NO_TEXTURE && t->width == BIS_NO_TEXTURE &&
                    t->power == 1);
        const rgb Kd = p.desc->materials[index].Kd;
        if (fabs((double)Kd.r - textured[i].typical[0]) + fabs((double)Kd.g - textured[i].typical[1]) +
                fabs((double)Kd.b - textured[i].typical[2]) >
            1e-6)
            fail_msg("%s: %g %g %g", text, (double)Kd.r, (double)Kd.g, (double)Kd.b);
        assert_int_equal(p.desc->textures.list[t->Kd].steps, textured[i].steps);
        clear(&p);
    }
    /* a coat adds one step, a factor two: 3 + 1 + 2, and 3 + 2 for Ks */
    parsed p = parse(BOARD
        "Material \"coateddiffuse\" \"texture reflectance\" \"b\" \"float roughness\" 0.04 \"float thickness\" 0");
    uint32_t index = p.desc->shapes[0].material;
    const bis_material_textures *t = bis_textures_of(&p.desc->textures, index);
    assert_int_equal(p.desc->textures.list[t->Kd].steps, 6);
    assert_true(t->Ks == BIS_NO_TEXTURE && t->power == 1);
    /* a coat of glass, of alpha 0.2, keeps 0.91401^2/2.25 of what is black: of 0.75 0.3713 0.75/(1 - 0.495 0.75) */
    assert_rgb(p.desc->materials[index].Kd, .3713 * .75 / (1 - .495 * .75), .3713 * .25 / (1 - .495 * .25),
        .3713 * .125 / (1 - .495 * .125), 5e-4);
    assert_about(p.desc->textures.list[t->Kd].value.r, .3713 * .75 / (1 - .495 * .75), 5e-4);
    assert_about(p.desc->textures.list[t->Kd].value.b, .3713 * .125 / (1 - .495 * .125), 5e-4);
    clear(&p);
    p = parse(BOARD "Material \"plastic\" \"texture Ks\" \"b\"");
    index = p.desc->shapes[0].material;
    t = bis_textures_of(&p.desc->textures, index);
    assert_int_equal(p.desc->textures.list[t->Ks].steps, 5);
    assert_true(t->Kd == BIS_NO_TEXTURE && p.desc->textures.list[t->Ks].scale == 1);
    assert_rgb(p.desc->materials[index].Ks, .03, .01, .005, 1e-6);
    assert_about(p.desc->textures.list[t->Ks].value.r, .03, 1e-6);
    assert_about(p.desc->textures.list[t->Ks].value.b, .005, 1e-6);
    clear(&p);
#undef BOARD
#undef BLACK
}

static const struct { const char *scene, *message; } wrong_names[] = {
    {"Texture \"wood\" \"spectrum\" \"constant\"\nMaterial \"phong\" \"texture exponent\" \"wood\"",
     "4:18: error: texture \"wood\" is one of colours; \"exponent\" needs one of numbers, Texture \"wood\" "
     "\"float\""},
    {"Texture \"wood\" \"spectrum\" \"constant\"\nMaterial \"phong\" \"texture Kd\" \"woot\"",
     "4:18: error: texture \"woot\" is not defined (did you mean \"wood\"?); as in pbrt, Texture must stand before "
     "its first use"},
    {"Texture \"wood\" \"float\" \"constant\"\nMaterial \"phong\" \"texture exponent\" \"woot\"",
     "texture \"woot\" is not defined (did you mean \"wood\"?); as in pbrt"},
    {"Texture \"t\" \"float\" \"scale\" \"texture tex1\" \"t\"",
     "3:29: error: texture \"t\" would be made of itself: name one that is defined before"},
    {"Texture \"t\" \"vector\" \"scale\"", "3:13: error: a Texture is of type \"float\" or \"spectrum\" (or "
     "\"color\", \"rgb\"), not \"vector\""},
    {"Texture \"t\" \"float\" \"imagemap\"", "3:9: error: Texture \"imagemap\" needs \"string filename\""},
    {"Texture \"t\" \"float\" \"checkerboard\" \"integer dimension\" 4",
     "3:36: error: \"dimension\" is 4, must be in [2, 3]"},
    {"Texture \"t\" \"float\" \"constant\" \"float value\" 2 Material \"diffuse\" \"texture reflectance\" \"t\"",
     "\"reflectance\" is 2, must be in [0, 1]"},
    {"Texture \"t\" \"color\" \"constant\" \"rgb value\" [0 2 0] Material \"diffuse\" \"texture reflectance\" "
     "\"t\"", "\"reflectance\" is 2, must be in [0, 1]"},
    {"Texture \"t\" \"color\" \"constant\" \"rgb value\" [0 0 3] Material \"diffuse\" \"texture reflectance\" "
     "\"t\"", "\"reflectance\" is 3, must be in [0, 1]"},
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
    assert_rgb(material("Texture \"t\" \"float\" \"constant\" \"float value\" 0.25 Material \"diffuse\" \"texture "
                        "reflectance\" \"t\"",
                   NULL)
                   .Kd,
        .25, .25, .25, 0);
    assert_rgb(
        material("Texture \"t\" \"spectrum\" \"constant\" Material \"diffuse\" \"texture reflectance\" \"t\"", NULL).Kd,
        1, 1, 1, 0);
    assert_rgb(
        material("Texture \"t\" \"spectrum\" \"scale\" Material \"diffuse\" \"texture reflectance\" \"t\"", NULL).Kd, 1,
        1, 1, 0);
    assert_rgb(
        material("Texture \"t\" \"spectrum\" \"mix\" Material \"diffuse\" \"texture reflectance\" \"t\"", NULL).Kd, .5,
        .5, .5, 0);
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

/* What bis does not filter is passed over, or told. */
static void words_about_filtering_are_ignored(void **state)
{
    char x[64], text[1024];
    static const struct { const char *words; bool is_told; } cases[] = {
        {"\"string filter\" \"bilinear\"", false}, {"\"bool trilinear\" true \"float maxanisotropy\" 4", false},
        {"\"string filter\" \"ewa\"", true}};
    store(scratch("x.png"), "x", 1);
    snprintf(x, sizeof x, "%s", strrchr(scratch("x.png"), '/') + 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(
            text, sizeof text, "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" %s", x,
            cases[i].words);
        parsed p = parse(text);
        assert_int_equal(p.status, BIS_OK);
        assert_int_equal(p.diag.n, cases[i].is_told ? 1 : 0);
        clear(&p);
    }
    parsed p =
        parse("Texture \"t\" \"float\" \"checkerboard\" \"integer dimension\" 2 \"string aamode\" \"closedform\"");
    assert_int_equal(p.status, BIS_OK);
    assert_int_equal(p.diag.n, 0);
    clear(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(black_bodies_lie_on_plancks_locus),
        cmocka_unit_test(white_is_white_and_a_part_of_the_spectrum_has_its_colour),
        cmocka_unit_test(reflectances_may_be_spectra_files_or_xyz),
        cmocka_unit_test(a_file_of_a_spectrum_has_pairs_of_numbers),
        cmocka_unit_test(light_may_be_a_black_body_or_xyz),
        cmocka_unit_test(a_conductor_reflects_what_fresnel_says_head_on),
        cmocka_unit_test(metals_reflect_on_average_what_their_spectra_do),
        cmocka_unit_test(named_metals_have_their_published_colours),
        cmocka_unit_test(textures_of_roughness_of_pbrt_v3_are_remapped_too),
        cmocka_unit_test(oxides_reflect_as_their_indices_say),
        cmocka_unit_test(roughness_becomes_pbrts_alpha),
        cmocka_unit_test(textures_of_roughness_are_remapped_as_constants_are),
        cmocka_unit_test(coats_are_what_their_index_says),
        cmocka_unit_test(a_textured_coat_is_the_coat_of_each_colour),
        cmocka_unit_test(each_material_has_its_defaults),
        cmocka_unit_test(each_parameter_of_a_material_has_its_limits),
        cmocka_unit_test(what_a_roughness_becomes_is_told_once),
        cmocka_unit_test(a_textured_material_has_a_typical_value_and_counts_its_steps),
        cmocka_unit_test(names_of_textures_are_those_of_their_kind),
        cmocka_unit_test(words_about_filtering_are_ignored),
        cmocka_unit_test(textures_of_constants_are_their_values),
        cmocka_unit_test(a_normal_map_is_linear),
        cmocka_unit_test(an_image_has_the_gamma_that_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
