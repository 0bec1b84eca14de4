/* SPDX-License-Identifier: BSD-2-Clause */
/* foreign: scenes that were written for pbrt: where it looks for files, what it lets pass, what bis makes of it. */
#include "bis/base/mem.h"
#include "bis/scene/scene.h"
#include "claim.h"
#include "image_help.h"
#include "scene/distant.h"

#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define LIT "WorldBegin LightSource \"infinite\"\n"

/* A file of the test's own folder, which the scenes live in; the path lives until the fourth call from now. */
static const char *place(const char *name)
{
    static char paths[4][512];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, 512, "%s/%s", scratch("folder"), name);
    return path;
}

static int make_folder(void **state)
{
    return mkdir(scratch("folder"), 0777) || mkdir(place("geometry"), 0777) || mkdir(place("geometry/geometry"), 0777);
}

static int forget(const char *path, const struct stat *st, int type, struct FTW *walk)
{
    return remove(path);
}

static int remove_folder(void **state)
{
    return nftw(scratch("folder"), forget, 8, FTW_DEPTH | FTW_PHYS) || scratch_remove(state);
}

static void write_file(const char *name, const char *text) { store(place(name), text, strlen(text)); }

/* Parse main.txt of the scratch folder; the messages go to said, one a line. */
static bis_status parse_file(bis_scene_desc **d, unsigned how, char said[8192])
{
    bis_diag diag = {0};
    const bis_status status = bis_scene_parse_as(d, place("main.txt"), how, &diag);
    said[0] = '\0';
    for (size_t i = 0; i < diag.n; i++)
        snprintf(said + strlen(said), 8192 - strlen(said), "%s\n", diag.messages[i].text);
    bis_diag_clear(&diag);
    return status;
}

static bis_status parse(bis_scene_desc **d, const char *text, unsigned how, char said[8192])
{
    write_file("main.txt", text);
    return parse_file(d, how, said);
}

static bis_scene_desc *good(const char *text, unsigned how, char said[8192])
{
    bis_scene_desc *d;
    const bis_status status = parse(&d, text, how, said);
    if (status) print_message("%s", said);
    assert_int_equal(status, BIS_OK);
    return d;
}

static void assert_says(const char *said, const char *what)
{
    if (!strstr(said, what)) fail_msg("\"%s\" is not said in:\n%s", what, said);
}

static bool ends(const char *s, const char *end)
{
    return strlen(s) >= strlen(end) && strcmp(s + strlen(s) - strlen(end), end) == 0;
}

/* ---- files ---- */

/* The same name lies beside the main scene and beside the file that is included, or only at one of the places. */
static void names_of_an_included_file_are_looked_for_beside_the_main_scene_first(void **state)
{
    char said[8192];
    write_file("geometry/a.txt", "Shape \"plymesh\" \"string filename\" \"geometry/m.ply\"\n");
    write_file("geometry/m.ply", "ply\n");
    write_file("geometry/geometry/m.ply", "ply\n");
    bis_scene_desc *d = good(LIT "Include \"geometry/a.txt\"", 0, said);
    assert_true(
        ends(d->meshes[0].filename, "/geometry/m.ply") && !ends(d->meshes[0].filename, "geometry/geometry/m.ply"));
    bis_scene_desc_free(d);
    unlink(place("geometry/m.ply"));
    d = good(LIT "Include \"geometry/a.txt\"", 0, said); /* the last place: the folder of a.txt */
    assert_true(ends(d->meshes[0].filename, "geometry/geometry/m.ply"));
    bis_scene_desc_free(d);
    unlink(place("geometry/geometry/m.ply"));
    assert_int_equal(parse(&d, LIT "Include \"geometry/a.txt\"", 0, said), BIS_INPUT);
    assert_says(said, "geometry/a.txt:1:17: error: cannot read \"");
    assert_null(strstr(said, "geometry/geometry"));
    assert_int_equal(parse(&d, LIT "Include \"geometry/a.txt\"", BIS_PARSE_LIST_MISSING, said), BIS_OK);
    assert_true(d->n_missing == 1 && ends(d->missing[0], "/geometry/m.ply"));
    bis_scene_desc_free(d);
}

/* pbrt-v4's second place; the test runs in the root of the project. */
static void the_working_directory_is_the_second_place(void **state)
{
    char said[8192];
    bis_scene_desc *d = good(LIT "Shape \"plymesh\" \"string filename\" \"tests/scene/test_foreign.c\"", 0, said);
    assert_string_equal(d->meshes[0].filename, "tests/scene/test_foreign.c");
    bis_scene_desc_free(d);
}

static void an_include_may_be_compressed(void **state)
{
    char said[8192];
    static const char text[] = "Translate 0 4 0 Shape \"sphere\"\nShape \"spher\"\n";
    gzFile file = gzopen(place("part.pbrt.gz"), "wb");
    assert_true(gzwrite(file, text, (unsigned)strcspn(text, "\n")) > 0 && gzclose(file) == Z_OK);
    bis_scene_desc *d = good(LIT "Include \"part.pbrt.gz\"", 0, said);
    assert_true(d->n_shapes == 1 && d->shapes[0].to_world.m[1][3] == 4);
    bis_scene_desc_free(d);
    file = gzopen(place("part.pbrt.gz"), "wb"); /* places are those of the text */
    assert_true(gzwrite(file, text, sizeof text - 1) > 0 && gzclose(file) == Z_OK);
    assert_int_equal(parse(&d, LIT "Include \"part.pbrt.gz\"", 0, said), BIS_INPUT);
    assert_says(said, "part.pbrt.gz:2:7: error: unknown Shape \"spher\"");
}

static void a_missing_spectrum_is_one_of_the_missing_files(void **state)
{
    char said[8192];
    bis_scene_desc *d =
        good(LIT "Material \"metal\" \"spectrum eta\" \"spds/Au.eta.spd\" \"spectrum k\" \"spds/Au.k.spd\" "
                 "Shape \"sphere\" Material \"matte\" \"spectrum Kd\" \"spds/red.spd\"",
            BIS_PARSE_APPROXIMATE | BIS_PARSE_LIST_MISSING, said);
    assert_int_equal(d->n_missing, 3);
    assert_true(ends(d->missing[0], "spds/Au.eta.spd") && ends(d->missing[2], "spds/red.spd"));
    bis_scene_desc_free(d);
    assert_int_equal(
        parse(&d, LIT "Material \"matte\" \"spectrum Kd\" \"spds/red.spd\"", BIS_PARSE_APPROXIMATE, said), BIS_INPUT);
    d = good(
        LIT "Shape \"objmesh\" \"string filename\" \"gone.obj\" \"bool materials\" true", BIS_PARSE_LIST_MISSING, said);
    assert_int_equal(d->n_missing, 1); /* nor are its libraries asked for */
    assert_int_equal(d->n_shapes, 1);
    bis_scene_desc_free(d);
    d = good(LIT "Include \"gone.pbrt\" Shape \"sphere\"", BIS_PARSE_APPROXIMATE | BIS_PARSE_LIST_MISSING,
        said); /* so is a part of the scene */
    assert_true(d->n_missing == 1 && ends(d->missing[0], "gone.pbrt") && d->n_shapes == 1);
    bis_scene_desc_free(d);
}

/* ---- messages ---- */

/* Numbers outside of quotes do not make another cause, names do; sixty of one do not hide the next. Four others have
 * their places, of a fifth there are dots. */
static void errors_of_one_cause_are_one_message_with_their_number(void **state)
{
    char text[8192] = LIT, said[8192];
    bis_scene_desc *d;
    for (int i = 1; i <= 60; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "Shape \"sphere\" \"float radius\" -%d\n", i);
    strcat(text, "Shape \"cub\"\nShape \"cubb\"\nShape \"cub\"\n");
    assert_int_equal(parse(&d, text, 0, said), BIS_INPUT);
    assert_says(said, "main.txt:2:16: error: \"radius\" is -1, must be > 0 (60 like it: also in line 3, line 4, line "
                      "5, line 6, ...)\n");
    assert_says(said, "main.txt:62:7: error: unknown Shape \"cub\"");
    assert_says(said, "(2 like it: also in line 64)\n");
    assert_says(said, "main.txt:63:7: error: unknown Shape \"cubb\"");
    /* a place in another file than the scene's has the file's name */
    write_file("part.txt", "Shape \"sphere\" \"float radius\" -2\n\nShape \"sphere\" \"float radius\" -3\n");
    assert_int_equal(parse(&d, LIT "Shape \"sphere\" \"float radius\" -1\nInclude \"part.txt\"\n"
                               "Shape \"sphere\" \"float radius\" -4\n", 0, said), BIS_INPUT);
    char expected[1200];
    snprintf(expected, sizeof expected, " is -1, must be > 0 (4 like it: also in %s:1, %s:3, line 4)\n",
             place("part.txt"), place("part.txt"));
    assert_says(said, expected);
}

/* ---- what pbrt lets pass ---- */

/* pbrt-v1 to v3 say nothing, so bis renders without --approximate, and says it. */
static void what_pbrt_passes_over_in_silence_is_a_warning(void **state)
{
    char said[8192];
    bis_scene_desc *d = good(LIT "Shape \"sphere\" \"float radius\" 2 \"float radius\" 3 \"float radius\" 4\nShape "
                                 "\"sphere\" \"float radius\" 1 \"float radius\" 5",
        0, said);
    assert_true(d->shapes[0].radius == 4 && d->shapes[1].radius == 5);
    assert_says(said, "main.txt:2:33: warning: 3 x \"radius\" given twice: the last one counts\n");
    assert_int_equal(d->n_approximations, 0);
    bis_scene_desc_free(d);
    /* an object is known by its last definition; the attributes' End closes the object's attributes, the object goes on
     */
    d = good(LIT "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"\nObjectBegin \"o\" AttributeBegin "
                 "Translate 1 0 0 Shape \"disk\"\n"
                 "ObjectEnd Shape \"sphere\" AttributeEnd ObjectInstance \"o\"",
        0, said);
    assert_true(d->n_shapes == 3 && d->shapes[0].kind == BIS_SHAPE_SPHERE && d->shapes[2].kind == BIS_SHAPE_DISK);
    assert_says(said, "1 x an object defined again: the last one counts from there on\n");
    assert_says(
        said, "1 x ObjectEnd where AttributeEnd is due: it closes the last block that was opened, as in pbrt-v3\n");
    bis_scene_desc_free(d);
    d = good(LIT
        "ObjectBegin \"o\" Shape \"sphere\" AttributeEnd Shape \"disk\" AttributeBegin ObjectEnd ObjectInstance \"o\"",
        0, said);
    assert_int_equal(d->n_shapes, 2);
    bis_scene_desc_free(d);
}

static const struct pass {
    const char *scene, *kind, *refused; /* what plain bis says; NULL: it passes, too */
} passes[] = {
    {LIT "Material \"bluepaint\" \"rgb Kd\" [.1 .2 .3] \"float gloss\" 1 Shape \"sphere\"",
     "unknown Material \"bluepaint\"", "unknown Material"},
    {LIT "Shape \"sphere\" Shape \"blob\" \"float size\" 3", "unknown Shape \"blob\"", "unknown Shape"},
    {LIT "Material \"plastic\" \"rgb Ks\" [4 1 1] Shape \"sphere\"", "\"Ks\" out of its range",
     "\"Ks\" is 4, must be in [0, 1]"},
    {LIT "NamedMaterial \"Sun_Light\" Shape \"sphere\"", "NamedMaterial \"Sun_Light\", which is not made anywhere",
     "is not made anywhere"},
    {LIT "Shape \"sphere\" ObjectInstance \"o\"", "ObjectInstance of an object that is not defined", "is not defined"},
    {LIT "Shape \"sphere\" ConcatTransform [1 0 0 0  0 1 0 0  0 0 0 0  0 0 0 1] Translate 1 0 0 Shape \"disk\"",
     "a shape under a singular transformation", "the matrix of ConcatTransform is singular"},
    {LIT "Shape \"sphere\" AttributeBegin Scale 0 0 0 Shape \"disk\" AttributeEnd",
     "a shape under a singular transformation", "Scale by 0 is singular"},
    {LIT "ObjectBegin \"o\" Shape \"disk\" ObjectEnd AttributeBegin Scale 0 0 0 ObjectInstance \"o\" AttributeEnd "
     "Shape \"sphere\"", "a shape under a singular transformation", "Scale by 0 is singular"},
    {LIT "AttributeBegin TransformBegin AttributeEnd TransformEnd Shape \"sphere\"",
     "AttributeEnd where TransformEnd is due", "it would close the TransformBegin of"},
    {LIT "CoordinateSystem \"c\" Scale 0 0 0 CoordSysTransform \"c\" Shape \"sphere\"", NULL, "Scale by 0"},
    {LIT "Scale 0 0 0 Identity Shape \"sphere\"", NULL, "Scale by 0"},
    {LIT "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" .5 Material \"uber\" \"texture "
     "opacity\" \"t\" Shape \"sphere\"",
     "a texture as \"opacity\"", "\"opacity\" is of type texture"},
    {LIT "Texture \"t\" \"float\" \"imagemap\" \"float gamma\" 2.2 \"string filename\" \"data/maps/tiles.png\" "
     "Shape \"sphere\"",
     "\"float gamma\" of a texture", NULL},
    {LIT "Texture \"t\" \"float\" \"mix\" \"float tex1\" 0 \"float tex2\" -0.25 Shape \"sphere\"", NULL, NULL},
    /* both ends of a marble's interval belong to it */
    {LIT "Texture \"t\" \"color\" \"marble\" \"float scale\" -1e30 \"float variation\" 1e30 "
     "Shape \"sphere\"", NULL, NULL},
    {LIT "Texture \"t\" \"color\" \"marble\" \"float scale\" 1e30 \"float variation\" -1e30 "
     "Shape \"sphere\"", NULL, NULL},
    {LIT "Shape \"sphere\" WorldEnd Film \"image\" WorldBegin Shape \"disk\" WorldEnd", "what follows WorldEnd",
     "Film after WorldEnd"},
};

static void what_pbrt_goes_on_after_is_approximated(void **state)
{
    char said[8192];
    for (size_t i = 0; i < sizeof passes / sizeof *passes; i++) {
        const struct pass *x = &passes[i];
        bis_scene_desc *d;
        const bis_status plain = parse(&d, x->scene, 0, said);
        if (plain != (x->refused ? BIS_INPUT : BIS_OK)) fail_msg("%s\n%s", x->scene, said);
        if (x->refused) assert_says(said, x->refused);
        bis_scene_desc_free(d);
        d = good(x->scene, BIS_PARSE_APPROXIMATE, said);
        if (d->n_shapes != 1) fail_msg("%s: %zu shapes", x->scene, d->n_shapes);
        assert_true(d->shapes[0].kind == BIS_SHAPE_SPHERE);
        bool listed = !x->kind;
        for (size_t k = 0; k < d->n_approximations; k++)
            listed |= x->kind && strcmp(d->approximations[k].kind, x->kind) == 0;
        if (!listed) fail_msg("%s\n%s", x->scene, said);
        assert_null(strstr(said, "bvh")); /* what is taken instead gives no message of its own */
        bis_scene_desc_free(d);
    }
}

static void what_is_replaced_has_the_values_of_the_scene(void **state)
{
    char said[8192];
    bis_scene_desc *d = good(passes[0].scene, BIS_PARSE_APPROXIMATE, said);
    const bis_material *m = &d->materials[d->shapes[0].material];
    assert_true(m->Kd.r == .1f && m->Kd.g == .2f && m->Kd.b == .3f);
    assert_int_equal(d->n_approximations, 1); /* what the unknown material has beside is not told one by one */
    bis_scene_desc_free(d);
    d = good("Camera \"omni\" \"float fov\" 30 Sampler \"neural\" \"integer pixelsamples\" 5 " LIT,
             BIS_PARSE_APPROXIMATE, said);
    assert_true(d->view.camera.fov_deg == 30 && !d->view.camera.orthographic && d->view.sampler.spp == 5);
    bis_scene_desc_free(d);
    /* a value at an open end has no nearest one */
    assert_int_equal(parse(&d, LIT "Shape \"sphere\" \"float radius\" 0", BIS_PARSE_APPROXIMATE, said), BIS_INPUT);
    d = good("WorldBegin LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"", 0, said);
    const rgb L = d->light.L;
    assert_true(fabs((double)L.r - 1) < 1e-6 && fabs((double)L.g - 1) < 1e-6 && fabs((double)L.b - 1) < 1e-6);
    bis_scene_desc_free(d);
}

/* An image is its mean of every channel, times the scale and perhaps inverted; a file that is none is the grey of
 * half the scale. */
static void an_image_in_the_place_of_a_colour_is_its_mean(void **state)
{
    static const float pixels[6] = {.1f, .2f, .375f, .3f, .4f, .125f}; /* the means: 0.2, 0.3, 0.25 */
    static const struct { const char *image; double r, g, b; } cases[] = {
        {"\"mean.pfm\"", .2, .3, .25},
        {"\"mean.pfm\" \"float scale\" 2", .4, .6, .5},
        {"\"mean.pfm\" \"float scale\" .5 \"bool invert\" true", .9, .85, .875},
        {"\"main.txt\" \"float scale\" 0.5", .5, .5, .5},
    };
    bytes b = {0};
    put_text(&b, "PF\n2 1\n-1.0\n");
    for (int i = 0; i < 6; i++) put_float(&b, pixels[i]);
    store(place("mean.pfm"), b.data, b.n);
    bytes_clear(&b);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[400], said[8192];
        snprintf(text, sizeof text, LIT "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" %s "
                 "Material \"mirror\" \"texture Kr\" \"t\" Shape \"sphere\"", cases[i].image);
        bis_scene_desc *d = good(text, BIS_PARSE_APPROXIMATE, said);
        const rgb c = d->materials[d->shapes[0].material].Ks;
        if (fabs((double)c.r - cases[i].r) > 1e-6 || fabs((double)c.g - cases[i].g) > 1e-6 ||
            fabs((double)c.b - cases[i].b) > 1e-6)
            fail_msg("%s: %g %g %g", cases[i].image, (double)c.r, (double)c.g, (double)c.b);
        bis_scene_desc_free(d);
    }
}

/* One texture for both widths is as exact as "roughness". */
static void both_roughnesses_may_be_one_texture(void **state)
{
    char said[8192];
#define T \
    "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" .2 \"float tex2\" .6 Texture \"u\" \"float\" " \
    "\"checkerboard\" "
    bis_scene_desc *d =
        good(LIT T "Material \"substrate\" \"texture uroughness\" \"t\" \"texture vroughness\" \"t\" Shape \"sphere\" "
                   "Material \"substrate\" \"texture roughness\" \"t\" Shape \"sphere\"",
            0, said);
    const bis_material_textures *a = bis_textures_of(&d->textures, d->shapes[0].material),
                                *b = bis_textures_of(&d->textures, d->shapes[1].material);
    assert_true(a && b && a->power == b->power);
    const double uv[2] = {.5, .5};
    const double width = bis_textures_value(&d->textures, NULL, b->width, uv, (vec3){0, 0, 0}).r;
    assert_true(bis_textures_value(&d->textures, NULL, a->width, uv, (vec3){0, 0, 0}).r == width);
    bis_scene_desc_free(d);
    /* approximated, the lobe is as wide as the one that is a texture, or uroughness's */
    static const char *const both[] = {"\"texture uroughness\" \"t\" \"float vroughness\" .3",
                                       "\"float uroughness\" .3 \"texture vroughness\" \"t\"",
                                       "\"texture uroughness\" \"t\" \"texture vroughness\" \"u\""};
    for (size_t i = 0; i < sizeof both / sizeof *both; i++) {
        char text[1024];
        snprintf(text, sizeof text, LIT T "Material \"substrate\" %s Shape \"sphere\"", both[i]);
        d = good(text, BIS_PARSE_APPROXIMATE, said);
        const bis_material_textures *c = bis_textures_of(&d->textures, d->shapes[0].material);
        assert_non_null(c);
        assert_true(bis_textures_value(&d->textures, NULL, c->width, uv, (vec3){0, 0, 0}).r == width);
        bis_scene_desc_free(d);
    }
#undef T
}

/* A bad value counts where the texture is shown: refused when the scene is built, cut off with --approximate. */
static void a_bad_part_of_a_texture_counts_where_it_is_shown(void **state)
{
    static const char shown[] = LIT "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" 1.5 \"float tex2\" -0.5 "
                                    "Material \"matte\" \"texture Kd\" \"t\" Shape \"sphere\"";
    char said[8192];
    bis_diag diag = {0};
    bis_scene *s;
    bis_scene_desc *d = good(shown, 0, said);
    assert_int_equal(bis_scene_build(&s, d, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "the texture of \"Kd\" has values down to -0.5, must be in [0, 1]"));
    bis_diag_clear(&diag);
    bis_scene_desc_free(d);
    d = good(shown, BIS_PARSE_APPROXIMATE, said);
    assert_int_equal(bis_scene_build(&s, d, &diag), BIS_OK);
    assert_true(diag.n == 1 && strstr(diag.messages[0].text, "must be in [0, 1]: what lies outside is cut off"));
    const uint32_t index = d->shapes[0].material;
    for (int k = 0; k < 2; k++) {
        const bis_material m = bis_textures_material(&d->textures, s->images, bis_textures_of(&d->textures, index),
            &d->materials[index], (double[]){.5 + k, .5}, (vec3){0, 0, 0});
        assert_true(m.Kd.r == (k ? 0.0f : 1.0f));
    }
    assert_true(d->materials[index].Kd.r > 0); /* not taken for black */
    bis_diag_clear(&diag);
    bis_scene_free(s);
    bis_scene_desc_free(d);
}

/* ---- versions ---- */

/* pbrt-v2 has the first row of an image at t = 0 and linear values, v3 at t = 1 and sRGB. The image has two rows, 0.25
 * above 0.75; a PFM is linear in both. */
static void the_images_of_pbrt_v2_stand_on_their_head(void **state)
{
    static const struct { const char *mapping; double uv[2]; vec3 p; } cases[] = {
        {"\"float vscale\" 0.5 \"float vdelta\" 0.1", {.5, .3}, {0, 0, 0}}, /* t = 0.25 */
        {"\"string mapping\" \"planar\" \"vector v1\" [0 1 0] \"vector v2\" [1 0 0] \"float vdelta\" .05", {0, 0},
         {.2f, .9f, .4f}},
        {"\"string mapping\" \"cylindrical\"", {0, 0}, {.5f, .5f, .25f}},
        {"\"string mapping\" \"spherical\"", {0, 0}, {0, 1, .5f}}, /* phi = pi/2: t = 1/4 */
    };
    const float rows[2][2][3] = {
        {{.75f, .75f, .75f}, {.75f, .75f, .75f}}, {{.25f, .25f, .25f}, {.25f, .25f, .25f}}}; /* from below */
    char pfm[64], said[8192], text[1024];
    const size_t n = (size_t)snprintf(pfm, sizeof pfm, "PF\n2 2\n-1.0\n");
    memcpy(pfm + n, rows, sizeof rows);
    store(place("two.pfm"), pfm, n + sizeof rows);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double v[2];
        for (int v2 = 0; v2 < 2; v2++) {
            snprintf(text, sizeof text,
                "%s \"path\" " LIT "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"two.pfm\" %s "
                "Material \"matte\" \"texture Kd\" \"t\" Shape \"sphere\"",
                v2 ? "SurfaceIntegrator" : "Integrator", cases[i].mapping);
            bis_scene_desc *d = good(text, BIS_PARSE_APPROXIMATE, said);
            assert_true(
                !!strstr(said, "taken for pbrt-v2 or v1, because of SurfaceIntegrator in ") == v2);
            bis_texture_image image;
            assert_int_equal(bis_textures_load(&image, &d->textures.files[0], NULL), BIS_OK);
            v[v2] = bis_textures_value(
                &d->textures, &image, d->textures.of_material[d->shapes[0].material].Kd, cases[i].uv, cases[i].p)
                        .r;
            bis_image_clear(&image.image);
            bis_scene_desc_free(d);
        }
        if (fabs(v[0] - .75) > 1e-6 || fabs(v[1] - .25) > 1e-6)
            fail_msg("%s: v3 %g, v2 %g", cases[i].mapping, v[0], v[1]);
    }
    /* linear, unless gamma says otherwise; Integrator is v3's word */
    static const struct { const char *before, *gamma; double is; } gammas[] = {
        {"SurfaceIntegrator \"path\"", "", 1}, {"SurfaceIntegrator \"path\"", "\"float gamma\" 2.2", 2.2},
        {"SurfaceIntegrator \"path\"", "\"float gamma\" 0.25", 0.25},
        {"Integrator \"path\"", "", BIS_GAMMA_SRGB}, {"Sampler \"bestcandidate\"", "", 1},
        {"VolumeIntegrator \"emission\"", "", 1}, {"Renderer \"sampler\"", "", 1},
        {"SurfaceIntegrator \"path\" Integrator \"path\"", "", BIS_GAMMA_SRGB},
        {"AreaLightSource \"x\"", "", BIS_GAMMA_SRGB}, {"Sampler \"adaptive\"", "", BIS_GAMMA_SRGB}};
    for (size_t i = 0; i < sizeof gammas / sizeof *gammas; i++) {
        snprintf(text, sizeof text, "%s " LIT "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"two.pfm\" %s",
            gammas[i].before, gammas[i].gamma);
        bis_scene_desc *d = good(text, BIS_PARSE_APPROXIMATE, said);
        if (d->textures.files[0].gamma != gammas[i].is)
            fail_msg("%s: %g", gammas[i].before, d->textures.files[0].gamma);
        bis_scene_desc_free(d);
    }
}

/* pbrt-v1 to v3 take the point in the world for "planar", and the matrix itself for patterns in space; v4 takes the
 * inverse for both. Film "image" is in no v4, Film "rgb" in no v3. The point (3, 0.5, 0.25) of Translate 1 0 0
 * Scale 2 2 2 is (3, ...) in the world, (1, 0.25, 0.125) in the texture's space, (7, 1, 0.5) by the matrix itself. */
static void textures_lie_where_their_version_has_them(void **state)
{
#define PLANE "\"bilerp\" \"string mapping\" \"planar\" \"float v00\" 0 \"float v01\" 0 \"float v10\" 1 \"float v11\" 1"
#define CUBES "\"checkerboard\" \"integer dimension\" 3 \"float tex1\" 0 \"float tex2\" 1"
    static const struct { const char *film, *texture; double is; } cases[] = {
        {"rgb", "\"float\" " PLANE, 1},
        {"image", "\"float\" " PLANE, 3},
        {"rgb", "\"float\" " CUBES, 1},
        {"image", "\"float\" " CUBES, 0},
        {"rgb", "\"color\" \"uv\" \"string mapping\" \"planar\" \"vector v1\" [0.25 0 0] \"float udelta\" 0.125", .375},
        {"image", "\"color\" \"uv\" \"string mapping\" \"planar\" \"vector v1\" [0.25 0 0] \"float udelta\" 0.125",
         .875},
    };
    char said[8192], text[1024];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text,
            "Film \"%s\" " LIT
            "Translate 1 0 0 Scale 2 2 2 Texture \"t\" %s Identity Material \"phong\" \"texture %s\" \"t\" "
            "Shape \"sphere\"",
            cases[i].film, cases[i].texture, strstr(cases[i].texture, "color") ? "Kd" : "exponent");
        bis_scene_desc *d = good(text, 0, said);
        const bis_material_textures *m = bis_textures_of(&d->textures, d->shapes[0].material);
        const double is = bis_textures_value(
            &d->textures, NULL, m->Kd != BIS_NO_TEXTURE ? m->Kd : m->width, (double[]){0, 0}, (vec3){3, .5f, .25f})
                              .r;
        if (fabs(is - cases[i].is) > 1e-6) fail_msg("%s, %s: %g", cases[i].film, cases[i].texture, is);
        assert_string_equal(said, "");
        bis_scene_desc_free(d);
    }
#undef PLANE
#undef CUBES
}

static void the_films_scale_multiplies_the_light(void **state)
{
    char said[8192];
    bis_scene_desc *d = good("Film \"image\" \"float scale\" 5 WorldBegin LightSource \"infinite\" \"rgb L\" [1 2 3] "
                             "\"float scale\" 0.5 Shape \"sphere\"",
        0, said);
    assert_true(d->light.scale == 2.5 && d->light.L.g == 2);
    assert_string_equal(said, "");
    bis_scene_desc_free(d);
    d = good("Film \"image\" \"float scale\" 5 Film \"image\" " LIT, 0, said); /* a second film has the defaults */
    assert_true(d->light.scale == 1);
    bis_scene_desc_free(d);
}

/* ---- what a plan can know ---- */

/* By a file's head, with the message that the render would give; what no shape shows does not count. */
static void a_plan_knows_what_the_heads_of_files_tell(void **state)
{
#define MATTE "Material \"matte\" \"texture Kd\" \"t\" "
#define IMAGE(name) "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"" name "\" "
    static const struct { const char *scene, *message; } cases[] = {
        {LIT IMAGE("two.gif") MATTE "Shape \"sphere\"", "it is a GIF, which is not read"},
        {LIT IMAGE("bad.jpg") MATTE "Shape \"sphere\"", "the JPEG is damaged"},
        {LIT IMAGE("bad.png") MATTE "Shape \"sphere\"", "cannot read"},
        {LIT IMAGE("bad.jpg") "Shape \"sphere\" " MATTE, NULL},
        {"WorldBegin LightSource \"infinite\" \"string filename\" \"bad.exr\"", "cannot read"},
        {LIT IMAGE("two.gif") "Shape \"sphere\" " MATTE, NULL},
        {"WorldBegin LightSource \"infinite\" \"string mapname\" \"square.pfm\"", "is square, 2 x 2: give its mapping"},
        {"WorldBegin LightSource \"infinite\" \"string filename\" \"two.gif\"", "it is a GIF, which is not read"},
        {LIT "Shape \"plymesh\" \"string filename\" \"two.gif\"", "not a PLY file"},
        {LIT "Shape \"objmesh\" \"string filename\" \"zero.obj\"", "not an OBJ file"},
        {LIT "Shape \"objmesh\" \"string filename\" \"flat.obj\"", NULL},
        {LIT "ObjectBegin \"o\" Shape \"plymesh\" \"string filename\" \"two.gif\" ObjectEnd", NULL},
        {LIT "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" 2 " MATTE "Shape \"sphere\"",
         "has values up to 2, must be in [0, 1]"},
        {LIT "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" 2 " MATTE, NULL},
    };
    write_file("two.gif", "GIF89a, a picture of the web");
    write_file("bad.jpg", "\xff\xd8\xff\xe0garbage"); /* a mark, and then nothing that tells the size */
    write_file("bad.png", "\x89PNG\r\n\x1a\ngarbage");
    write_file("bad.exr", "\x76\x2f\x31\x01garbage");
    store(place("zero.obj"), "v\2\0\0\0", 5);
    write_file("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    static const char square[] = "PF\n2 2\n-1.0\n012345678901234567890123456789012345678901234567";
    write_file("square.pfm", square);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char said[8192];
        bis_diag diag = {0};
        bis_scene_desc *d = good(cases[i].scene, 0, said);
        const bis_status status = bis_scene_check_files(d, &diag);
        if (status != (cases[i].message ? BIS_INPUT : BIS_OK)) fail_msg("%s: %d", cases[i].scene, status);
        if (cases[i].message) assert_says(diag.messages[0].text, cases[i].message);
        bis_diag build = {0};
        bis_scene *s = NULL;
        const bis_status built = bis_scene_build(&s, d, &build); /* and the render agrees */
        assert_int_equal(built, status);
        if (cases[i].message) assert_says(build.messages[0].text, cases[i].message);
        bis_scene_free(s);
        bis_diag_clear(&build);
        bis_diag_clear(&diag);
        bis_scene_desc_free(d);
    }
#undef MATTE
#undef IMAGE
}

/* A mesh from elsewhere: its library, a material, an image, an option are not there or not known. */
static void what_is_missing_around_a_mesh_is_grey(void **state)
{
    static const char scene[] = LIT "Shape \"objmesh\" \"string filename\" \"m.obj\" \"bool materials\" true\n"
                                "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"none.png\" Material "
                                "\"matte\" \"texture Kd\" \"t\" Shape \"sphere\"";
    char said[8192];
    bis_scene_desc *d;
    write_file("m.obj",
        "mtllib none.mtl\nmtllib some.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl lost\nf 1 3 2\n");
    write_file("some.mtl", "newmtl red\nKd 0.8 0 0\nmap_Kd -texres 512 none.jpg\n");
    assert_int_equal(parse(&d, scene, 0, said), BIS_INPUT);
    assert_says(said, "m.obj:1: error: cannot read \"");
    assert_says(said, "none.mtl\": No such file or directory; with --approximate: its materials are diffuse grey");
    assert_says(said, "none.png\": No such file or directory; with --approximate: grey");
    d = good(scene, BIS_PARSE_APPROXIMATE, said);
    assert_int_equal(d->n_shapes, 3);
    const float Kd[3] = {.8f, .5f, .5f};
    for (int i = 0; i < 3; i++) {
        const rgb is = d->materials[d->shapes[i].material].Kd;
        assert_true(is.r == Kd[i] && is.g == (i ? .5f : 0) && is.b == (i ? .5f : 0));
        assert_null(bis_textures_of(&d->textures, d->shapes[i].material));
    }
    assert_says(said, "1 x a library of materials that is not there");
    assert_says(said, "1 x a material that is in no library of its mesh");
    assert_says(said, "1 x an image of a library that is not there");
    assert_says(said, "1 x an image that is not there");
    assert_says(said, "some.mtl:3: warning: -texres of a map is ignored");
    bis_scene_desc_free(d);
    d = good(scene, BIS_PARSE_APPROXIMATE | BIS_PARSE_LIST_MISSING, said); /* and a plan lists them */
    assert_int_equal(d->n_missing, 3);
    bis_scene_desc_free(d);
    write_file("m.obj", "mtllib some.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    assert_int_equal(parse(&d, scene, 0, said), BIS_INPUT);
    assert_says(said, "none.jpg\": No such file or directory; with --approximate: the material without it");
    store(place("some.mtl"), "newmtl red\n\0", 12);
    assert_int_equal(parse(&d, scene, 0, said), BIS_INPUT);
    assert_says(said, "some.mtl: error: no library of materials: there is a zero byte in it");
}

/* ---- light ---- */

static void a_scene_without_light_from_infinity_gets_a_white_sky(void **state)
{
    char said[8192];
    bis_scene_desc *d =
        good("Integrator \"path\" WorldBegin LightSource \"point\" Shape \"sphere\"", BIS_PARSE_APPROXIMATE, said);
    assert_true(d->has_light && !d->light.filename && d->light.scale == 1 && d->light.L.r == 1 && d->light.L.b == 1);
    assert_int_equal(d->approximations[0].effect, BIS_EFFECT_SKY);
    assert_int_equal(d->approximations[1].effect, BIS_EFFECT_INDIRECT);
    assert_non_null(strstr(said, "main.txt: warning: approximated: no light from infinity: a white sky of radiance 1 "
                                 "is used; bis render --light MAP takes another\n"));
    assert_null(strstr(said, "no LightSource"));
    bis_scene_desc_free(d);
    d = good("WorldBegin Shape \"sphere\"", 0, said); /* plain bis renders it black, as ever */
    assert_false(d->has_light);
    assert_says(said, "no light: the scene has no LightSource and will be black");
    bis_scene_desc_free(d);
}

/* What a surface that faces `to` receives from the map, and how much of it comes from beyond `reach` of that direction.
 */
static void measure(
    rgbd *E, rgbd *outside, const bis_light *light, const bis_light_desc *desc, const double to[3], double reach)
{
    const bis_envmap *em = bis_light_envmap(light);
    *E = *outside = (rgbd){0, 0, 0};
    for (int y = 0; y < em->height; y++)
        for (int x = 0; x < em->width; x++) {
            const vec3 local = bis_envmap_direction(em, x, y, .5, .5), w = bis_xform_vector(&desc->to_world, local);
            const double cosine = (double)w.x * to[0] + (double)w.y * to[1] + (double)w.z * to[2];
            const rgb L = em->pixels[(size_t)y * (size_t)em->width + (size_t)x];
            const rgbd part =
                rgbd_scale((rgbd){(double)L.r, (double)L.g, (double)L.b}, fmax(0, cosine) * em->row_solid_angle[y]);
            *E = rgbd_add(*E, part);
            if (acos(fmin(1, cosine)) > reach) *outside = rgbd_add(*outside, part);
        }
}

/* The irradiance is pbrt's, L of the light, in the direction of the light; also at the poles of the map, in a turned
 * frame, and in a map whose pixels are larger than the disc. */
static void a_distant_light_is_a_disc_of_its_irradiance(void **state)
{
    static const struct { const char *scene; double to[3], reach; } cases[] = {
        {"LightSource \"distant\" \"point from\" [1 2 2] \"rgb L\" [3 2 1]", {1 / 3., 2 / 3., 2 / 3.}, .4},
        {"LightSource \"distant\" \"point from\" [0 0 5] \"point to\" [0 0 0] \"rgb L\" [6 4 2] \"float scale\" .5",
         {0, 0, 1}, .4},
        {"LightSource \"distant\" \"rgb L\" [3 2 1]", {0, 0, -1}, .4}, /* pbrt's default shines along +z */
        {"AttributeBegin Rotate 90 0 1 0 LightSource \"distant\" \"point from\" [0 0 1] \"point to\" [0 0 0] \"rgb L\" "
         "[3 2 1] AttributeEnd", {1, 0, 0}, .4},
        {"AttributeBegin Rotate 40 1 2 3 LightSource \"infinite\" \"string filename\" \"small.pfm\" AttributeEnd "
         "LightSource \"distant\" \"point from\" [1 2 2] \"point to\" [0 0 0] \"rgb L\" [3 2 1]",
         {1 / 3., 2 / 3., 2 / 3.}, 40},
    };
    char pfm[1000] = "", said[8192], text[1024];
    const size_t n = (size_t)snprintf(pfm, sizeof pfm, "PF\n8 4\n-1.0\n"); /* black */
    store(place("small.pfm"), pfm, n + 8 * 4 * 12);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_light *light;
        bis_diag diag = {0};
        rgbd E, outside;
        snprintf(text, sizeof text, "WorldBegin %s Shape \"sphere\"", cases[i].scene);
        if (i == 0) strcpy(strstr(text, " \"rgb L\""), " \"point to\" [0 0 0] \"rgb L\" [3 2 1] Shape \"sphere\"");
        bis_scene_desc *d = good(text, BIS_PARSE_APPROXIMATE, said);
        assert_true(d->light.n_distants == 1 && !strstr(said, "sky"));
        assert_says(said, "a disc in the map, half a degree wide, of the same irradiance");
        assert_int_equal(bis_light_load(&light, &d->light, 0, NULL, &diag), BIS_OK);
        measure(&E, &outside, light, &d->light, cases[i].to, cases[i].reach * PI / 180);
        /* floats: pixels, directions and the axis are rounded by 6e-8 each, of a disc 4e-3 wide. One pixel of 45
         * degrees has its middle elsewhere, and the surface here faces the light: cos of at most that */
        const double tolerance = i < 4 ? 1e-4 : .3;
        if (fabs(E.r / 3 - 1) > tolerance || fabs(E.g / 2 - 1) > tolerance || fabs(E.b - 1) > tolerance ||
            outside.r > 0)
            fail_msg("%s: %g %g %g, outside %g", cases[i].scene, E.r, E.g, E.b, outside.r);
        assert_int_equal(diag.n, 0);
        bis_light_free(light);
        bis_scene_desc_free(d);
    }
    bis_scene_desc *d;
    assert_int_equal(
        parse(&d, "WorldBegin LightSource \"distant\" \"point to\" [0 0 0]", BIS_PARSE_APPROXIMATE, said), BIS_INPUT);
    assert_says(said, "\"from\" and \"to\" are one point");
    /* of 6e-5 sr, so that the disc is 16000 times as bright as its irradiance */
    bis_light *light;
    bis_diag diag = {0};
    d = good("WorldBegin LightSource \"distant\" \"rgb L\" [3e34 1 1]", BIS_PARSE_APPROXIMATE, said);
    assert_int_equal(bis_light_load(&light, &d->light, 0, NULL, &diag), BIS_INPUT);
    assert_says(diag.messages[0].text, "a distant light exceeds the largest float as a disc of half a degree: give it "
                "a smaller \"L\"");
    bis_diag_clear(&diag);
    bis_scene_desc_free(d);
    d = good("WorldBegin LightSource \"distant\" \"rgb L\" [1e34 1 1]", BIS_PARSE_APPROXIMATE, said);
    assert_int_equal(bis_light_load(&light, &d->light, 0, NULL, NULL), BIS_OK);
    bis_light_free(light);
    bis_scene_desc_free(d);
}

/* Irradiance over the disc's projected solid angle, wherever the disc stands. A pixel is covered where points of its
 * grid are, so some hundred of the disc's thousand points may be on the wrong side: 10 % at most. A row of pixels left
 * out would make the rest brighter by a quarter and more. */
static void a_disc_has_its_radiance_in_all_directions(void **state)
{
    enum { W = BIS_DISTANT_WIDTH, H = W / 2 };
    static const int rows[] = {0, 1, 60, 500, 780, H - 1}; /* the poles, too */
    const double radiance = 1 / (PI * pow(sin(BIS_DISTANT_HALF_ANGLE), 2));
    bis_image black = {W, H, bis_alloc((size_t)W * H, sizeof *black.pixels), NULL};
    bis_envmap em;
    assert_int_equal(bis_envmap_from_latlong(&em, &black, NULL), BIS_OK);
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        for (int column = 37; column < W; column += 511) {
            const vec3 towards = bis_envmap_direction(&em, column, rows[k], 0.3, 0.6);
            const bis_distant sun = {.irradiance = {1, 1, 1},
                                     .towards = {(double)towards.x, (double)towards.y, (double)towards.z}};
            float brightest = 0;
            assert_true(bis_distant_add(&em, &sun));
            for (size_t i = 0; i < (size_t)W * H; i++) brightest = fmaxf(brightest, em.pixels[i].r);
            assert_true(fabs((double)brightest / radiance - 1) < 0.1);
            memset(em.pixels, 0, (size_t)W * H * sizeof *em.pixels);
        }
    bis_envmap_clear(&em);
}

/* A constant light is the sky around the disc: the map holds its radiance everywhere else, and a surface that faces the
 * disc receives pi L more. */
static void a_constant_light_is_the_sky_around_a_distant_one(void **state)
{
    static const char distant[] = "LightSource \"distant\" \"point from\" [0 0 1] \"point to\" [0 0 0] "
                                  "\"rgb L\" [3 2 1]",
                      sky[] = "LightSource \"infinite\" \"rgb L\" [.5 .25 2] \"float scale\" 2";
    char said[8192], text[1024];
    for (int i = 0; i < 2; i++) {
        bis_light *light;
        rgbd E, outside;
        snprintf(text, sizeof text, "WorldBegin %s %s Shape \"sphere\"", i ? sky : distant, i ? distant : sky);
        bis_scene_desc *d = good(text, BIS_PARSE_APPROXIMATE, said);
        assert_int_equal(bis_light_load(&light, &d->light, 0, NULL, NULL), BIS_OK);
        static const vec3 elsewhere[] = {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {.6f, 0, .8f}};
        for (size_t k = 0; k < sizeof elsewhere / sizeof *elsewhere; k++) {
            const rgb L = bis_light_Le(light, elsewhere[k]);
            assert_true(L.r == 1 && L.g == .5f && L.b == 4);
        }
        measure(&E, &outside, light, &d->light, (double[]){0, 0, 1}, .4 * PI / 180);
        assert_true(fabs(E.r / (3 + PI) - 1) < 1e-4 && fabs(E.g / (2 + PI / 2) - 1) < 1e-4 &&
                    fabs(E.b / (1 + 4 * PI) - 1) < 1e-4);
        bis_light_free(light);
        bis_scene_desc_free(d);
    }
}

/* Each of several lights arrives, times the film's scale, in the frame of a map that comes before, between or after. */
static void distant_lights_are_all_there_in_one_frame(void **state)
{
    static const double to[2][3] = {{1 / 3., 2 / 3., 2 / 3.}, {-2 / 3., -2 / 3., 1 / 3.}};
    char pfm[1000] = "", said[8192], text[2048];
    const size_t n = (size_t)snprintf(pfm, sizeof pfm, "PF\n8 4\n-1.0\n"); /* black */
    store(place("small.pfm"), pfm, n + 8 * 4 * 12);
    static const char map[] =
        " AttributeBegin Rotate 40 1 2 3 LightSource \"infinite\" \"string filename\" \"small.pfm\" AttributeEnd ";
    for (int i = 0; i < 3; i++) {
        bis_scene_desc *d;
        snprintf(text, sizeof text,
            "Film \"image\" \"float scale\" 2 WorldBegin%sLightSource \"distant\" \"point from\" [1 2 2] "
            "\"point to\" [0 0 0] \"rgb L\" [3 2 1]%sLightSource \"distant\" \"point from\" [-2 -2 1] \"point to\" [0 "
            "0 0] "
            "\"rgb L\" [1 2 3]%sShape \"sphere\"",
            i == 0 ? map : " ", i == 1 ? map : " ", i == 2 ? map : " ");
        d = good(text, BIS_PARSE_APPROXIMATE, said);
        assert_int_equal(d->light.n_distants, 2);
        for (int k = 0; k < 2; k++) {
            const bis_distant *x = &d->light.distants[k];
            const vec3 w = bis_xform_vector(
                &d->light.to_world, (vec3){(float)x->towards[0], (float)x->towards[1], (float)x->towards[2]});
            const double cosine =
                ((double)w.x * to[k][0] + (double)w.y * to[k][1] + (double)w.z * to[k][2]) / (double)length(w);
            assert_true(cosine > 1 - 1e-6); /* floats: an angle of 1e-3 at most */
            assert_true(
                x->irradiance.r == (k ? 2.f : 6.f) && x->irradiance.g == 4.f && x->irradiance.b == (k ? 6.f : 2.f));
        }
        bis_scene_desc_free(d);
    }
}

/* The lights of the scene are passed over, also without --approximate, and the frame stands upright. */
static void another_light_takes_the_place_of_all(void **state)
{
    static const struct { const char *before, *after; double up[3]; } cases[] = {
        {"LookAt 0 5 -1  0 0 0  0 1 0 Camera \"perspective\"",
         "LightSource \"point\" LightSource \"infinite\" \"rgb L\" [2 2 2]", {0, 1, 0}},
        {"LookAt 5 5 5  0 0 0  0 0 1", "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] Shape \"disk\"", {0, 0, 1}},
        {"LookAt 5 0 0  0 0 0  0 1 1", "", {0, 1, 0}}, /* of two the first */
        {"LookAt 0 0 5  0 0 0  -1 0 0", "", {-1, 0, 0}},
        {"Rotate 90 1 0 0 Camera \"perspective\"", "", {0, 0, -1}},
         /* the camera's own y; the rotation takes -z to it */
        {"LookAt 0 5 -1  0 0 0  0 1 0", "AttributeBegin Rotate 90 0 1 0 LightSource \"infinite\" \"string mapname\" "
         "\"no.exr\" AttributeEnd", {1, 0, 0}},
    };
    char said[8192], text[1024];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, "%s WorldBegin %s Shape \"sphere\"", cases[i].before, cases[i].after);
        bis_scene_desc *d = good(text, BIS_PARSE_OTHER_LIGHT, said);
        assert_string_equal(said, "");
        assert_true(d->has_light && !d->light.filename && d->light.scale == 1 && d->light.L.r == 1);
        for (int k = 0; k < 3; k++)
            if (fabs(d->light.to_world.m[k][2] - cases[i].up[k]) > 1e-12)
                fail_msg("%s %s: %d", cases[i].before, cases[i].after, k);
        /* it is turned about x, or about y where its z becomes x: this axis stays */
        const int axis = fabs(cases[i].up[0]) > 0.5;
        for (int k = 0; k < 3; k++) assert_true(fabs(d->light.to_world.m[k][axis] - (k == axis)) < 1e-12);
        bis_scene_desc_free(d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_an_included_file_are_looked_for_beside_the_main_scene_first),
        cmocka_unit_test(the_working_directory_is_the_second_place),
        cmocka_unit_test(an_include_may_be_compressed),
        cmocka_unit_test(a_missing_spectrum_is_one_of_the_missing_files),
        cmocka_unit_test(errors_of_one_cause_are_one_message_with_their_number),
        cmocka_unit_test(what_pbrt_passes_over_in_silence_is_a_warning),
        cmocka_unit_test(what_pbrt_goes_on_after_is_approximated),
        cmocka_unit_test(what_is_replaced_has_the_values_of_the_scene),
        cmocka_unit_test(an_image_in_the_place_of_a_colour_is_its_mean),
        cmocka_unit_test(both_roughnesses_may_be_one_texture),
        cmocka_unit_test(a_bad_part_of_a_texture_counts_where_it_is_shown),
        cmocka_unit_test(the_images_of_pbrt_v2_stand_on_their_head),
        cmocka_unit_test(textures_lie_where_their_version_has_them),
        cmocka_unit_test(the_films_scale_multiplies_the_light),
        cmocka_unit_test(a_plan_knows_what_the_heads_of_files_tell),
        cmocka_unit_test(what_is_missing_around_a_mesh_is_grey),
        cmocka_unit_test(a_scene_without_light_from_infinity_gets_a_white_sky),
        cmocka_unit_test(a_distant_light_is_a_disc_of_its_irradiance),
        cmocka_unit_test(a_disc_has_its_radiance_in_all_directions),
        cmocka_unit_test(a_constant_light_is_the_sky_around_a_distant_one),
        cmocka_unit_test(distant_lights_are_all_there_in_one_frame),
        cmocka_unit_test(another_light_takes_the_place_of_all),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
