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

static bool ends_with(const char *s, const char *end)
{
    return strlen(s) > strlen(end) && strcmp(s + strlen(s) - strlen(end), end) == 0;
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

/* Each scene has messages beside it: without any a scene would not be parsed. */
static void each_bad_scene_has_its_messages(void **state)
{
    int n = 0;
    DIR *folder = opendir(BAD);
    assert_non_null(folder);
    for (struct dirent *e = readdir(folder); e; e = readdir(folder)) {
        char path[512], name[256];
        if (!ends_with(e->d_name, ".txt")) continue;
        snprintf(path, sizeof path, BAD "%.*s.expect", (int)(strlen(e->d_name) - strlen(".txt")), e->d_name);
        FILE *f = fopen(path, "r");
        if (!f) fail_msg("no %s", path);
        assert_int_equal(fscanf(f, "$%*[2 ]parse %255s", name), 1);
        assert_string_equal(name, e->d_name);
        fclose(f);
        n++;
    }
    closedir(folder);
    assert_true(n >= 190);
}

static void a_bad_scene_without_a_list_for_messages_fails_all_the_same(void **state)
{
    bis_scene_desc *d;
    assert_int_equal(bis_scene_parse(&d, BAD "syntax-several-errors.txt", NULL), BIS_INPUT);
    assert_null(d);
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
#define FOV(value) "Camera \"perspective\" \"float fov\" " value L
#define INFINITE(value) {FOV(value), "1:34: error: non-finite number \"" value "\""}, \
    {FOV("[1 " value "]"), "1:37: error: non-finite number \"" value "\""}
#define DECLARED(words) {"Camera \"perspective\" \"" words "\" 45" L, \
    "1:22: error: a parameter is declared as \"type name\", not \"" words "\""}
#define UNKNOWN(words) {"Camera \"perspective\" " words L, "1:22: error: unknown parameter \"a\" of Camera " \
    "\"perspective\"; with --approximate: ignored"}
#define NEAREST "; with --approximate: the nearest value that it may have"
#define SPECTRUM(words) {"WorldBegin LightSource \"infinite\" Material \"matte\" \"spectrum Kd\" " words, \
    "1:52: error: the spectrum \"Kd\" must be one number, or pairs of a wavelength in nm and a value >= 0, " \
    "wavelengths ascending"}
#define SPHERE(type, shown) {"WorldBegin LightSource \"infinite\" Shape \"sphere\" \"" type " radius\" [1 1 1]", \
    "1:50: error: \"radius\" is of type " shown ", must be float"}
#define D62 "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"
#define DEEP D62 "xx"

/* All messages of a scene of one line; "": none. Places are counted by hand. */
static const struct { const char *scene, *said; } sayings[] = {
    INFINITE("nan"), INFINITE("NaN"), INFINITE("NAN"), INFINITE("inf"), INFINITE("Inf"), INFINITE("INF"),
    INFINITE("infinity"), INFINITE("Infinity"), /* of which the last looks like a directive's name */
    {"Translate 1 Infinity 3" L, "1:13: error: Translate wants 3 numbers, found \"Infinity\" after 1"},
    {FOV("Nan"), "1:22: error: \"fov\" has no value"},
    {FOV("[Nan]"), "1:34: error: the [ of \"fov\" has no ]"},
    {FOV("3.5e38"), "1:34: error: non-finite number \"3.5e38\": the largest float is 3.4e38"},
    {FOV("-3.5e38"), "1:34: error: non-finite number \"-3.5e38\": the largest float is 3.4e38"},
    {FOV("3.4e38"), "1:22: error: \"fov\" is 3.4e+38, must be in (0, 180)"},
    {FOV("true"), "1:34: error: \"fov\" wants numbers, found \"true\""},
    {FOV("[45"), "1:34: error: the [ of \"fov\" has no ]"},
    {FOV("]"), "1:22: error: \"fov\" has no value"},
    {"Camera \"perspective\" \"float fov\"", "1:22: error: \"fov\" has no value\n1:33: error: the scene has no "
     "WorldBegin"},
    {"Camera \"perspective\" \"float fov\" [45", "1:34: error: the [ of \"fov\" has no ]\n1:37: error: the scene has "
     "no WorldBegin"},
    {FOV("[45 46]"), "1:22: error: \"fov\" has 2 values, must have 1; with --approximate: the default is taken"},
    {FOV("[]"), "1:22: error: \"fov\" has 0 values, must have 1; with --approximate: the default is taken"},
    {"Sampler \"sobol\" \"integer seed\" 3.5e38" L, "1:17: error: \"seed\" is 3.5e+38, must be in [0, "
     "9007199254740991]" NEAREST},
    {"Option \"bool disablepixeljitter\" \"true\" \"bool approximate\" [false]" L, ""},
    {"Option \"bool disablepixeljitter\" [\"false\"]" L, ""},
    {"Option \"bool disablepixeljitter\" \"truth\"" L, "1:34: error: \"disablepixeljitter\" wants true or false, found "
     "the string \"truth\""},
    {"Option \"bool disablepixeljitter\" tru" L, "1:8: error: \"disablepixeljitter\" has no value"},
    {"Option \"bool disablepixeljitter\" 1" L, "1:34: error: \"disablepixeljitter\" wants true or false, found \"1\""},
    {"Film \"rgb\" \"string filename\" [\"a\" 3]" L, "1:35: error: \"filename\" wants strings, found \"3\""},
    {"Film \"rgb\" \"string filename\" true" L, "1:30: error: \"filename\" wants strings, found \"true\""},
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"spectrum Kd\" [\"a\" 3]",
     "1:71: error: \"Kd\" wants strings, found \"3\""},
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"spectrum Kd\" [400 \"a\"]",
     "1:71: error: \"Kd\" wants numbers, found the string \"a\""},
    {"Camera \"perspective\" \"vector2 a\" [1 \"b\" true [" L, "1:46: error: \"a\" wants a value, found \"[\""},
    UNKNOWN("\"vector2 a\" [1 \"b\" true]"), UNKNOWN("\"vector2 a\" \"b\""), UNKNOWN("\"float a\" 1"),
    UNKNOWN("\"\tfloat\t a \" 1"), UNKNOWN("\"float a\\r\" 1"), UNKNOWN("\"\\rfloat\\ra\\t\" 1"),
    UNKNOWN("\"float   a\" 1"), UNKNOWN("\"   float a\" 1"), UNKNOWN("\"float a   \" 1"), DECLARED("float a   b"),
    DECLARED("float"), DECLARED(""), DECLARED(" fov"), DECLARED("float a b"), DECLARED("float a,b"),
    DECLARED("float " DEEP "x"),
    {"Camera \"perspective\" \"float " DEEP "\" 45" L, "1:22: error: unknown parameter \"" DEEP "\" of Camera "
     "\"perspective\"; with --approximate: ignored"},
    {"Camera \"perspective\" \"float azAZ09_.:-\" 45" L, "1:22: error: unknown parameter \"azAZ09_.:-\" of Camera "
     "\"perspective\"; with --approximate: ignored"},
    {"Camera \"perspective\" \"flaot fov\" 45" L, "1:22: error: unknown parameter type \"flaot\" (did you mean "
     "\"float\"?)"},
    {"Camera \"perspective\" \"normal3 a\" [1 2 3]" L, "1:22: error: unknown parameter \"a\" of Camera "
     "\"perspective\"; with --approximate: ignored"},
    {"Camera" L, "1:8: error: Camera wants a quoted name, found \"WorldBegin\""},
    {"WorldBegin LightSource \"infinite\" Texture \"t\" \"float\" 3", "1:55: error: Texture wants another quoted name, "
     "found \"3\""},
    {"WorldBegin LightSource \"infinite\" Texture", "1:42: error: Texture wants a quoted name, found the end of the "
     "file"},

    {"Camera \"perspective\" \"float screenwindow\" [0 0 1 2]" L, "1:22: error: \"screenwindow\" is empty: it wants x0 "
     "x1 y0 y1 with x0 != x1, y0 != y1"},
    {"Camera \"perspective\" \"float screenwindow\" [0 1 2 2]" L, "1:22: error: \"screenwindow\" is empty: it wants x0 "
     "x1 y0 y1 with x0 != x1, y0 != y1"},
    {"Camera \"perspective\" \"float screenwindow\" [1 0 2 1]" L, ""},
    {"Camera \"perspective\" \"float frameaspectratio\" 0" L, "1:22: error: \"frameaspectratio\" is 0, must be > 0"},
    {"Camera \"perspective\" \"float focaldistance\" 3 \"float lensradius\" 0 \"float fov\" 179.9" L, ""},
    {"Camera \"perspective\" \"float lensradius\" -1" L,
     "1:22: error: a thin lens is not modelled: \"lensradius\" must "
     "be 0; with --approximate: all is in focus"},
    {"Film \"rgb\" \"float cropwindow\" [.5 .5 0 1]" L, "1:12: error: \"cropwindow\" is empty: it wants x0 x1 y0 y1 "
     "with x0 < x1, y0 < y1"},
    {"Film \"rgb\" \"float cropwindow\" [0 1 .5 .5]" L, "1:12: error: \"cropwindow\" is empty: it wants x0 x1 y0 y1 "
     "with x0 < x1, y0 < y1"},
    {"Film \"rgb\" \"float cropwindow\" [0 1 0 1.5]" L,
     "1:12: error: \"cropwindow\" is 1.5, must be in [0, 1]" NEAREST},
    {"Film \"rgb\" \"float cropwindow\" [-1 1 0 1]" L, "1:12: error: \"cropwindow\" is -1, must be in [0, 1]" NEAREST},
    {"Film \"rgb\" \"integer xresolution\" 32768 \"integer yresolution\" 1 \"float scale\" 0" L, ""},
    {"Film \"rgb\" \"integer xresolution\" 32769" L, "1:12: error: \"xresolution\" is 32769, must be in [1, 32768]"
     NEAREST},
    {"Film \"rgb\" \"integer yresolution\" 0" L, "1:12: error: \"yresolution\" is 0, must be in [1, 32768]" NEAREST},
    {"Film \"rgb\" \"float scale\" -1" L, "1:12: error: \"scale\" is -1, must be >= 0" NEAREST},
    {"PixelFilter \"box\" \"float xradius\" .5 \"float ywidth\" 0.5" L, ""},
    {"PixelFilter \"box\" \"float yradius\" 1" L, "1:19: warning: \"yradius\" is ignored: the box has the size of one "
     "pixel (0.5)"},
    {"PixelFilter \"box\" \"float xwidth\" 1 \"float ywidth\" 2" L, "1:19: warning: \"xwidth\" is ignored: the box has "
     "the size of one pixel (0.5)\n1:36: warning: \"ywidth\" is ignored: the box has the size of one pixel (0.5)"},
    {"PixelFilter \"box\" \"float xradius\" 0" L, "1:19: error: \"xradius\" is 0, must be > 0"},
    {"PixelFilter \"lanczossinc\" \"float tau\" 3" L, "1:13: warning: PixelFilter \"lanczossinc\" is ignored, which "
     "changes sharpness: the box of one pixel is used"},
    {"Accelerator \"grid\" \"float density\" 100" L, ""},
    {"Accelerator \"grid\" \"float density\" 100.5" L,
     "1:20: error: \"density\" is 100.5, must be in (0, 100]" NEAREST},
    {"Accelerator \"kdtree\" \"float emptybonus\" 3" L, "1:13: warning: Accelerator \"kdtree\" is replaced by the "
     "default"},
    {"Sampler \"sobol\" \"integer edgesamples\" 1025" L, "1:17: error: \"edgesamples\" is 1025, must be in [1, 1024]"
     NEAREST},
    {"Sampler \"sobol\" \"integer edgesamples\" 0" L,
     "1:17: error: \"edgesamples\" is 0, must be in [1, 1024]" NEAREST},
    {"Sampler \"sobol\" \"float edgelight\" 0" L, "1:17: error: \"edgelight\" is 0, must be in (0, 1]"},
    {"Sampler \"sobol\" \"float edgelight\" 1.5" L, "1:17: error: \"edgelight\" is 1.5, must be in (0, 1]" NEAREST},
    {"Sampler \"sobol\" \"float edgelight\" 1 \"integer edgesamples\" 1 \"integer pixelsamples\" 1000000000" L, ""},
    {"Sampler \"sobol\" \"integer pixelsamples\" 1000000001" L, "1:17: error: \"pixelsamples\" is 1000000001, must be "
     "in [1, 1000000000]" NEAREST},
    {"Sampler \"stratified\" \"integer xsamples\" 0" L,
     "1:22: error: \"xsamples\" is 0, must be in [1, 65535]" NEAREST},
    {"Sampler \"stratified\" \"integer ysamples\" 65536" L, "1:22: error: \"ysamples\" is 65536, must be in [1, 65535]"
     NEAREST},
    {"Sampler \"stratified\" \"integer ysamples\" 5 \"integer pixelsamples\" 16" L, "1:22: error: \"xsamples\" 4 times "
     "\"ysamples\" 5 is 20, must be \"pixelsamples\" 16"},
    {"Sampler \"stratified\" \"integer ysamples\" 5 \"integer pixelsamples\" 20" L, ""},
    {"Sampler \"random\" \"integer dimensions\" 4 \"string randomization\" \"owen\"" L, "1:18: warning: \"dimensions\" "
     "is ignored, which changes nothing but noise\n1:41: warning: \"randomization\" is ignored, which changes nothing "
     "but noise"},
    {"Sampler \"adaptive\" \"integer minsamples\" 4" L, "1:9: warning: Sampler \"adaptive\" is replaced by \"sobol\""},
    {"Integrator \"sppm\" \"integer maxdepth\" 4" L, "1:12: warning: Integrator \"sppm\" is pbrt's and replaced by the "
     "default, \"sir\", one bounce; its parameters are ignored"},
    {"Option \"integer seed\" 3 \"bool wavefront\" true" L, "1:8: warning: \"seed\" is ignored, which changes nothing "
     "but noise\n1:25: warning: \"wavefront\" is ignored, which changes nothing"},
    {"Option \"bool forcediffuse\" true" L, "1:8: warning: \"forcediffuse\" is ignored, which changes colour: "
     "materials stay as they are"},
    {"MediumInterface \"\" \"fog\"" L, "1:20: error: MediumInterface is \"fog\", must be \"\": media are not modelled; "
     "with --approximate: there is no medium; nothing dims or scatters light"},
    {"MediumInterface \"\" \"\" \"\"" L, "1:23: error: expected a directive, found the string \"\""},
    {"Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1" L, "1:44: error: Transform wants ] after 16 numbers, found "
     "\"WorldBegin\""},
    {"LookAt 0 0 5 0 0 0 0 1" L, "1:24: error: LookAt wants 9 numbers, found \"WorldBegin\" after 8"},
    {"Rotate 90 1 0" L, "1:15: error: Rotate wants 4 numbers, found \"WorldBegin\" after 3"},
    {"Rotate 90 0 0 0" L, "1:1: error: Rotate about the axis 0 0 0, which has no direction"},
    {"Rotate 90 1 0 0 Rotate 90 0 1 0 Rotate 90 0 0 1" L, ""},
    {"Scale 1 0 1" L, "1:1: error: Scale by 0 is singular: no factor may be 0; with --approximate: the shapes under it "
     "are left out"},
    {"Scale 1 1 0" L, "1:1: error: Scale by 0 is singular: no factor may be 0; with --approximate: the shapes under it "
     "are left out"},

    {"WorldBegin LightSource \"infinite\" Shape \"objmesh\" \"bool materials\" true", "1:41: error: Shape needs "
     "\"string filename\""},
    {"WorldBegin LightSource \"infinite\" Shape \"objmesh\" \"string filename\" 3", "1:69: error: \"filename\" "
     "wants strings, found \"3\""},
    {"WorldBegin LightSource \"infinite\" Shape \"objmesh\" \"float filename\" 3", "1:51: error: \"filename\" is of "
     "type float, must be string"},
    {"WorldBegin LightSource \"infinite\" \"spectrum scale\" [400 .5 700 .5]", ""},
    {"WorldBegin LightSource \"infinite\" \"spectrum scale\" [400 -1]", "1:35: error: the spectrum \"scale\" must be "
     "one number, or pairs of a wavelength in nm and a value >= 0, wavelengths ascending"},
    {"WorldBegin LightSource \"infinite\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [1 2 3] "
     "\"float uv\" [1]", "1:87: error: \"N\" has 3 values, must have 3 for each of the 3 points; with --approximate: "
     "left out, as in pbrt"},
    {"X" D62 L, "1:1: error: unknown directive \"X" D62 "\""}, {"X" D62 "x" L, "1:1: error: unknown directive \"X" D62
     "\""}, /* a name has 63 letters at most */
    {"X" DEEP L, "1:1: error: unknown directive \"X" D62 "\""},
    {"WorldBegin LightSource \"infinite\" Material \"diffuse\" \"texture reflectance\" \"no\" \"float Kd\" .5",
     "1:54: error: texture \"no\" is not defined; as in pbrt, Texture must stand before its first use; with "
     "--approximate: the parameter's default is taken"},
    {"WorldBegin LightSource \"infinite\" Shape \"heightfield\" \"integer nu\" 1 \"integer nv\" 2 \"float Pz\" [1 2]",
     "1:55: error: \"nu\" is 1, must be in [2, 32768]" NEAREST},
    {"WorldBegin LightSource \"infinite\" Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 40000 \"float Pz\" 1",
     "1:70: error: \"nv\" is 40000, must be in [2, 32768]" NEAREST},
    {"WorldBegin LightSource \"infinite\" Shape \"heightfield\" \"integer nu\" 2.5 \"integer nv\" 2 \"float Pz\" [1 2]",
     "1:55: error: \"nu\" is 2.5, must be a whole number"},
    {"WorldBegin LightSource \"infinite\" Shape \"nurbs\" \"integer nu\" 2 \"integer uorder\" 3 \"float uknots\" [0 0 "
     "1 1 1] \"integer nv\" 2 \"integer vorder\" 2 \"float vknots\" [0 0 1 1]", "1:49: error: \"nu\" is 2, must be at "
     "least \"uorder\", 3"},
    {"WorldBegin LightSource \"infinite\" Shape \"nurbs\" \"integer nu\" 2 \"integer uorder\" 17 \"integer nv\" 1 "
     "\"integer vorder\" 1", "1:64: error: \"uorder\" is 17, must be in [2, 16]" NEAREST "\n1:99: error: \"vorder\" "
     "is 1, must be in [2, 16]" NEAREST},
    {"WorldBegin LightSource \"infinite\" Shape \"loopsubdiv\" \"integer nlevels\" 11 \"point3 P\" [0 0 0 1 0 0 0 1 0]",
     "1:54: error: \"nlevels\" is 11, must be in [0, 10]" NEAREST},
    {"WorldBegin LightSource \"infinite\" Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 2",
     "1:41: error: heightfield needs \"Pz\""},
    {"WorldBegin LightSource \"infinite\" Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 2 "
     "\"integer Pz\" [1 2 3 4]",
     "1:85: error: \"Pz\" is of type integer, must be float"},
    {"WorldBegin LightSource \"infinite\" Shape \"nurbs\" \"integer nu\" 3 \"integer uorder\" 2 \"float uknots\" [0 0 "
     "1 .5 2] \"integer nv\" 0 \"integer vorder\" 2", "1:83: error: \"uknots\" falls from 1 to 0.5: knots must not "
     "descend\n1:111: error: \"nv\" is 0, must be in [1, 32768]" NEAREST},
    {"WorldBegin LightSource \"infinite\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" "
     "[0 5 6]", "1:87: error: \"indices\" holds 5 as its value 2, must be a whole number in [0, 2]; "
     "with --approximate: the mesh is left out, as in pbrt"},
    {"WorldBegin LightSource \"infinite\" \"xyz L\" [.2 .2 .2]", ""}, /* 0.24 0.19 0.18 */
    SPHERE("color", "rgb"), SPHERE("rgb", "rgb"), SPHERE("point", "point3"), SPHERE("point3", "point3"),
    SPHERE("vector", "vector3"), SPHERE("normal", "normal"), SPHERE("normal3", "normal"), SPHERE("point2", "point2"),
    SPHERE("vector2", "vector2"), SPHERE("xyz", "xyz"), SPHERE("spectrum", "spectrum"),
    SPHERE("blackbody", "blackbody"), SPHERE("integer", "integer"),
    SPECTRUM("[0 1]"), SPECTRUM("[-400 1]"), SPECTRUM("[400 1 400 1]"),
    SPECTRUM("[400 -1]"), SPECTRUM("[400 1 500]"), SPECTRUM("[400 1 500 -0.5]"),
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"spectrum Kd\" [1e-3 0 400 0.5 400.5 0.5]", ""},
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"spectrum Kd\" []", "1:52: error: \"Kd\" has no value"},
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"blackbody Kd\" 499", "1:52: error: \"Kd\" is 499, must "
     "be in [500, 1000000]" NEAREST},
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"blackbody Kd\" 1000001", "1:52: error: \"Kd\" is "
     "1000001, must be in [500, 1000000]" NEAREST},
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"integer Kd\" 1", "1:52: error: \"Kd\" is of type "
     "integer, must be float or rgb"},
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"string sigma\" \"x\"", "1:52: error: \"sigma\" is "
     "of type string, must be float"},
    {"WorldBegin LightSource \"infinite\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"rgb uv\" 1",
     "1:87: error: \"uv\" is of type rgb, must be float or point2"},
    {"WorldBegin LightSource \"infinite\" Material \"matte\" \"xyz Kd\" [0 0]",
     "1:52: error: \"Kd\" has 2 values, must "
     "have 3; with --approximate: the default is taken"},
    {"WorldBegin LightSource \"infinite\" \"rgb L\" [1 1 1] \"rgb scale\" [1 2 3] \"float illuminance\" 0", ""},
    {"WorldBegin LightSource \"infinite\" \"rgb L\" [1e38 1 1] \"rgb scale\" [10 2 3]", "1:54: error: \"L\" times "
     "\"scale\" is not finite"},
    {"WorldBegin LightSource \"infinite\" \"integer levels\" 0", "1:35: error: \"levels\" is 0, must be in [1, 254]"
     NEAREST},
    {"WorldBegin LightSource \"infinite\" \"integer levels\" 254 \"float areaexponent\" 10 \"integer width\" 32768",
     ""},
    {"WorldBegin LightSource \"infinite\" \"integer width\" 32769", "1:35: error: \"width\" is 32769, must be in [2, "
     "32768]" NEAREST},
    {"WorldBegin LightSource \"infinite\" \"string filter\" \"ewa\"", "1:35: error: \"filter\" is \"ewa\", must be "
     "\"point\" or \"bilinear\"; with --approximate: the default is taken"},
    {"WorldBegin LightSource \"infinite\" \"integer samples\" 4", "1:35: warning: \"samples\" is ignored, which "
     "changes nothing but noise"},
    {"WorldBegin LightSource \"infinite\" WorldEnd Shape \"sphere\" Shape \"disk\"", "1:44: error: Shape after "
     "WorldEnd: a scene has one world"},
    {"WorldBegin LightSource \"infinite\" Shape \"sphere\" \"float alpha\" 1 \"float shadowalpha\" 1", ""},
    {"WorldBegin LightSource \"infinite\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" "
     "[0 1 3]", "1:87: error: \"indices\" holds 3 as its value 3, must be a whole number in [0, 2]; "
     "with --approximate: the mesh is left out, as in pbrt"},
    {"WorldBegin LightSource \"infinite\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"float st\" [0 1]",
     "1:87: error: \"st\" has 2 values, must have 2 for each of the 3 points; with --approximate: left out, as "
     "in pbrt"},
    {"WorldBegin LightSource \"infinite\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1] \"integer indices\" "
     "[0 1 5] \"normal N\" [1]", "1:56: error: \"P\" has 8 values, must have a multiple of 3; with --approximate: "
     "the last numbers are left out"},
};

static void each_line_has_its_messages(void **state)
{
    for (size_t i = 0; i < BIS_COUNT(sayings); i++) {
        char all[1024] = "";
        bis_scene_desc *d;
        bis_diag diag;
        const bis_status status = parse_text(&d, &diag, sayings[i].scene);
        for (size_t k = 0; k < diag.n; k++) {
            const char *place = strstr(diag.messages[k].text, "scene.txt:");
            assert_non_null(place);
            snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", k ? "\n" : "", place + strlen("scene.txt:"));
        }
        if (strcmp(all, sayings[i].said) != 0) fail_msg("%s\n%s", sayings[i].scene, all);
        assert_int_equal(status, strstr(all, "error: ") ? BIS_INPUT : BIS_OK);
        bis_scene_desc_free(d);
        bis_diag_clear(&diag);
    }
#undef L
}

/* pbrt's names, which are in its documents, and what is said of each; "": nothing. %s stands for the name. */
static void each_name_of_pbrts_is_known(void **state)
{
#define IN_WORLD "WorldBegin LightSource \"infinite\" "
    static const struct { const char *before, *names, *after, *said; } groups[] = {
        {"Integrator \"", "path volpath bdpt mlt sppm directlighting whitted ao lightpath randomwalk ambientocclusion "
         "function photonmap exphotonmap igi irradiancecache simplepath simplevolpath", "\"", "Integrator \"%s\" is "
         "pbrt's and replaced by the default, \"sir\", one bounce; its parameters are ignored"},
        {"Sampler \"", "zsobol paddedsobol pmj02bn 02sequence lowdiscrepancy maxmindist bestcandidate adaptive", "\"",
         "Sampler \"%s\" is replaced by \"sobol\""},
        {"Sampler \"", "random independent stratified sobol halton", "\"", ""},
        {"Sampler \"sobol\" \"integer ", "dimensions randomization scramble", "\" 1",
         "\"%s\" is ignored, which changes nothing but noise"},
        {"Sampler \"sobol\" \"integer ", "samplepixelcenter", "\" 1",
         "\"%s\" is ignored, which changes shape: edges are smooth"},
        {"PixelFilter \"", "gaussian mitchell sinc triangle lanczossinc", "\"", "PixelFilter \"%s\" is ignored, which "
         "changes sharpness: the box of one pixel is used"},
        {"Accelerator \"", "bvh kdtree", "\"", "Accelerator \"%s\" is replaced by the default"},
        {"Film \"rgb\" \"float ", "iso exposuretime imagingratio", "\" 100", ""},
        {"Option \"integer ", "disabletexturefiltering disablewavelengthjitter msereferenceimage msereferenceout "
         "pixelstats rendercoordsys wavefront", "\" 1", "\"%s\" is ignored, which changes nothing"},
        {"Film \"image\" Camera \"perspective\" \"float ", "shutteropen shutterclose", "\" 1",
         "\"%s\" is ignored, which changes nothing"},
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
            char text[512], said[300];
            bis_scene_desc *d;
            bis_diag diag;
            const int n = (int)strcspn(name, " ");
            const char *at = strstr(groups[i].said, "%s");
            snprintf(text, sizeof text, "%s%.*s%s%s", groups[i].before, n, name, groups[i].after,
                     strstr(groups[i].before, "WorldBegin") ? "" : " " IN_WORLD);
            assert_int_equal(parse_text(&d, &diag, text), BIS_OK);
            assert_int_equal(diag.n, at ? 1 : 0);
            if (at) {
                snprintf(said, sizeof said, ": warning: %.*s%.*s%s", (int)(at - groups[i].said), groups[i].said, n,
                         name, at + 2);
                if (!ends_with(diag.messages[0].text, said)) fail_msg("%s\n%s", diag.messages[0].text, said);
            }
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

/* A word of bis itself before 0.1.0: a scene of that time is read as if it were not there, and is told once. */
static void a_word_that_sir_once_had_is_ignored_with_a_note(void **state)
{
    bis_diag diag;
    bis_scene_desc *d;
    assert_int_equal(
        parse_text(&d, &diag, "Integrator \"sir\" \"bool vectorize\" false \"integer candidates\" 33\nWorldBegin"),
        BIS_OK);
    assert_int_equal(diag.n, 2); /* and "no light" */
    assert_non_null(strstr(diag.messages[0].text, "\"vectorize\" is ignored"));
    assert_int_equal(d->view.settings.candidates, 33);
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
    assert_int_equal(
        parse_text(&d, &diag, "Integrator \"em\" \"bool vectorize\" false\nWorldBegin"), BIS_INPUT); /* twin */
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
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

/* Of two lines of a kind the second counts, with its defaults: nothing of the first stays. */
static void a_second_sampler_begins_with_the_defaults(void **state)
{
    static const char first[] =
        "Sampler \"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 2 \"integer seed\" 7 "
        "\"bool jitter\" false \"integer edgesamples\" 1024 \"float edgelight\" 0.125\n";
    char two[512];
    bis_scene_desc *d = good_scene(first, ""), *usual = good_scene("Sampler \"stratified\"", "");
    assert_true(fabs(d->view.edge_light - 0.125) < 1e-12);
    assert_true(d->view.edge_samples == 1024 && d->view.sampler.seed == 7 && d->view.sampler.spp == 6);
    bis_scene_desc_free(d);
    snprintf(two, sizeof two, "%sSampler \"stratified\"", first);
    d = good_scene(two, "");
    assert_true(d->view.edge_samples == 1 && fabs(d->view.edge_light - 1) < 1e-12);
    assert_true(d->view.sampler.seed == usual->view.sampler.seed && d->view.sampler.spp == usual->view.sampler.spp);
    assert_true(d->view.sampler.jitter && d->view.sampler.kind == usual->view.sampler.kind);
    bis_scene_desc_free(d);
    bis_scene_desc_free(usual);
}

static void a_film_without_parameters_has_the_defaults_of_no_film(void **state)
{
    bis_scene_desc *d = good_scene("Film \"rgb\"", "");
    const bis_film_desc *f = &d->view.film;
    assert_true(f->width == 1280 && f->height == 720 && strcmp(d->outfile, "bis.exr") == 0 && f->layers == 0);
    assert_true(f->crop[0] == 0 && f->crop[1] == 1 && f->crop[2] == 0 && f->crop[3] == 1);
    bis_scene_desc_free(d);
}

static void a_light_without_parameters_has_the_defaults_of_the_contract(void **state)
{
    bis_scene_desc *d = good_scene("", "");
    const bis_light_desc *l = &d->light;
    assert_true(d->has_light && l->visible && !l->filename && !l->is_v4 && l->mapping == BIS_MAPPING_LATLONG &&
                !l->has_mapping && !l->has_table_kind);
    assert_true(l->L.r == 1 && l->L.g == 1 && l->L.b == 1 && l->scale == 1 && l->area_exponent == 0.15 &&
                l->levels == 8);
    assert_int_equal(l->loc.line, 3);
    bis_scene_desc_free(d);
}

static void materials_have_the_defaults_of_the_contract(void **state)
{
    bis_scene_desc *d =
        good_scene("", "Shape \"sphere\" Material \"phong\" Shape \"sphere\" Material \"diffuse\" Shape \"disk\"");
    for (size_t i = 0; i < 3; i++) {
        const bis_material *m = &d->materials[d->shapes[i].material];
        assert_true(m->Kd.r == 0.5f && m->Kd.g == 0.5f && m->Kd.b == 0.5f && rgb_is_black(m->Ks));
    }
    assert_true(d->materials[d->shapes[1].material].exponent == 50);
    assert_true(d->shapes[0].radius == 1 && d->shapes[2].radius == 1 && d->shapes[2].height == 0);
    bis_scene_desc_free(d);
}

static void whole_quadrics_may_say_that_they_are_whole(void **state)
{
    bis_scene_desc *d =
        good_scene("", "Shape \"sphere\" \"float radius\" 2 \"float zmin\" -2 \"float zmax\" 5 \"float phimax\" 360 "
                       "Shape \"disk\" \"float innerradius\" 0 \"float phimax\" 360 \"float height\" 3");
    assert_int_equal(d->n_shapes, 2);
    assert_true(d->shapes[0].radius == 2 && d->shapes[1].radius == 1 && d->shapes[1].height == 3);
    bis_scene_desc_free(d);
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

static void every_parameter_of_a_light_arrives(void **state)
{
    char text[1024];
    store(scratch("map.pfm"), "x", 1);
    const char *name = strrchr(scratch("map.pfm"), '/') + 1;
    snprintf(text, sizeof text,
             "WorldBegin LightSource \"infinite\" \"string filename\" \"%s\" \"rgb L\" [1 2 3] \"float scale\" 4 "
             "\"string mapping\" \"angular\" \"integer width\" 100 \"float areaexponent\" 0 \"integer levels\" 5 "
             "\"string sampler\" \"cdf\" "
             "\"bool visible\" false", name);
    bis_scene_desc *d = good(text);
    const bis_light_desc *l = &d->light;
    assert_string_equal(l->filename, scratch("map.pfm")); /* relative to the scene's folder */
    assert_true(l->L.r == 1 && l->L.g == 2 && l->L.b == 3 && l->scale == 4 && l->is_v4 && l->has_mapping &&
                l->mapping == BIS_MAPPING_ANGULAR && l->width == 100);
    assert_true(l->area_exponent == 0 && l->levels == 5 && l->has_table_kind && l->table_kind == BIS_TABLE_CDF &&
                !l->visible);
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

static void spp_alone_is_divided_as_squarely_as_possible(void **state)
{
    static const struct {
        uint32_t spp, x, y;
    } cases[] = {{1, 1, 1}, {2, 2, 1}, {7, 7, 1}, {8, 4, 2}, {12, 4, 3}, {16, 4, 4}, {100, 10, 10}, {72, 9, 8},
                 {999983, 999983, 1}, {1000000000, 32000, 31250}};
    for (size_t i = 0; i < BIS_COUNT(cases); i++) {
        char text[128];
        snprintf(text, sizeof text, "Sampler \"stratified\" \"integer pixelsamples\" %u", cases[i].spp);
        bis_scene_desc *d = good_scene(text, "");
        assert_int_equal(d->view.sampler.spp, cases[i].spp);
        assert_int_equal(d->view.sampler.xsamples, cases[i].x);
        assert_int_equal(d->view.sampler.ysamples, cases[i].y);
        bis_scene_desc_free(d);
    }
    /* of two sides the one that is not given is 4 */
    for (int i = 0; i < 2; i++) {
        char text[128];
        snprintf(text, sizeof text, "Sampler \"stratified\" \"integer %csamples\" %d", i ? 'y' : 'x', i ? 5 : 3);
        bis_scene_desc *one = good_scene(text, "");
        assert_int_equal(one->view.sampler.xsamples, i ? 4 : 3);
        assert_int_equal(one->view.sampler.ysamples, i ? 5 : 4);
        assert_int_equal(one->view.sampler.spp, i ? 20 : 12);
        bis_scene_desc_free(one);
    }
    /* the product of both has the same limit */
    bis_scene_desc *d = good_scene("Sampler \"stratified\" \"integer xsamples\" 40000 \"integer ysamples\" 25000", "");
    assert_true(d->view.sampler.spp == 1000000000 && d->view.sampler.xsamples == 40000);
    bis_scene_desc_free(d);
    bis_diag diag;
    parse_text(&d, &diag, "Sampler \"stratified\" \"integer xsamples\" 25001 \"integer ysamples\" 40000\n");
    assert_non_null(strstr(diag.messages[0].text, "\"xsamples\" 25001 times \"ysamples\" 40000 is 1000040000, must "
                                                  "be at most 1000000000"));
    bis_diag_clear(&diag);
    bis_scene_desc_free(d);
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

static void a_file_named_by_many_shapes_is_one_mesh(void **state)
{
    store(scratch("m.ply"), "x", 1);
    char text[1024];
    const char *name = strrchr(scratch("m.ply"), '/') + 1;
    snprintf(text, sizeof text,
             "Shape \"plymesh\" \"string filename\" \"%s\" Shape \"plymesh\" \"string filename\" [\"%s\"]\n"
             "Shape \"plymesh\" \"string filename\" \"%s\" \"bool smooth\" true \"float alpha\" 1 "
             "\"point2 uv\" [0 0]", name, name, name);
    bis_scene_desc *d = good_scene("", text);
    assert_int_equal(d->n_shapes, 3);
    assert_int_equal(d->n_meshes, 2);
    assert_int_equal(d->shapes[0].mesh, d->shapes[1].mesh);
    assert_true(d->meshes[d->shapes[2].mesh].smooth && !d->meshes[d->shapes[0].mesh].smooth);
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
    store(scratch("n.obj"), obj, sizeof obj - 1);
    for (int i = 0; i < 12; i++) {
        const size_t n = strlen(text);
        snprintf(text + n, sizeof text - n, "Shape %s \"string filename\" \"%s\"\n", ways[i % 6],
            strrchr(scratch("m.obj"), '/') + 1);
    }
    const size_t n = strlen(text);
    snprintf(
        text + n, sizeof text - n, "Shape \"plymesh\" \"string filename\" \"%s\"", strrchr(scratch("n.obj"), '/') + 1);
    bis_scene_desc *d = good_scene("", text);
    assert_int_equal(d->n_shapes, 13);
    assert_int_equal(d->n_meshes, 7);
    for (size_t i = 0; i < 12; i++) {
        const bis_mesh_desc *m = &d->meshes[d->shapes[i].mesh];
        assert_int_equal(d->shapes[i].mesh, i % 6);
        assert_true(m->kind == (i % 6 < 2 ? BIS_SHAPE_PLY : BIS_SHAPE_OBJ) &&
                    m->smooth == (i % 6 == 1 || i % 6 == 3 || i % 6 == 5) && m->has_parts == (i % 6 > 3));
    }
    assert_int_equal(d->shapes[12].mesh, 6);
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

/* Any one of the 32 numbers of a transformation and its inverse may be the bad one. */
static void a_transformation_with_one_infinite_number_is_not_usable(void **state)
{
    static const double bad[] = {HUGE_VAL, -HUGE_VAL, (double)NAN};
    for (size_t k = 0; k < BIS_COUNT(bad); k++)
        for (int i = 0; i < 16; i++) {
            bis_xform t = bis_xform_identity(), u = t;
            assert_true(bis_parser_is_usable(&t));
            t.m[i / 4][i % 4] = u.inv[i / 4][i % 4] = bad[k];
            assert_false(bis_parser_is_usable(&t));
            assert_false(bis_parser_is_usable(&u));
            t = bis_xform_identity();
            t.m[i / 4][i % 4] = t.inv[i / 4][i % 4] = DBL_MAX;
            assert_true(bis_parser_is_usable(&t));
        }
}

/* What a scene leaves unsaid is said nowhere: the place is the file alone. */
static void what_nobody_names_has_the_file_for_its_place(void **state)
{
    bis_scene_desc *d = good("WorldBegin LightSource \"infinite\"");
    assert_string_equal(d->integrator_loc.file, d->files[0]);
    assert_true(ends_with(d->files[0], "scene.txt"));
    assert_true(d->integrator_loc.line == 0 && d->integrator_loc.column == 0 && !d->names_integrator);
    bis_scene_desc_free(d);
    d = good("Sampler \"halton\"\n  Integrator \"sir\" WorldBegin LightSource \"infinite\"");
    assert_true(d->integrator_loc.line == 2 && d->names_integrator);
    bis_scene_desc_free(d);
}

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

/* Where a folder is a file there is no such file; a name that is too long is the disk's fault. With --approximate the
 * first is left out, and the second is an error all the same. */
static void a_file_in_a_file_is_missing_and_a_name_too_long_is_not(void **state)
{
    char long_name[400], text[512];
    store(scratch("plain"), "x", 1);
    memset(long_name, 'x', sizeof long_name);
    long_name[sizeof long_name - 1] = '\0';
    for (int is_long = 0; is_long < 2; is_long++) {
        bis_scene_desc *d;
        bis_diag diag;
        snprintf(text, sizeof text,
                 "WorldBegin LightSource \"infinite\" Material \"matte\" \"string normalmap\" \"%s%s\"",
                 is_long ? long_name : strrchr(scratch("plain"), '/') + 1, is_long ? "" : "/x");
        assert_int_equal(parse_text(&d, &diag, text), is_long ? BIS_IO : BIS_INPUT);
        assert_non_null(strstr(diag.messages[0].text, is_long ? "\": File name too long" : "plain/x\": Not a directory"
                               "; with --approximate: the surface is as smooth as its shape"));
        bis_diag_clear(&diag);
        assert_int_equal(bis_scene_parse_as(&d, scratch("scene.txt"), BIS_PARSE_APPROXIMATE, NULL),
                         is_long ? BIS_IO : BIS_OK);
        bis_scene_desc_free(d);
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

/* Errors of the words and of the lexer count alike; those of one cause count once. What follows the fiftieth is not
 * read, and the 49th is not the last. */
static void a_scene_is_read_to_its_fiftieth_error(void **state)
{
    for (int i = 0; i < 3 * 6; i++) {
        const int n = 48 + i % 6, kind = i / 6; /* kind 0: unknown words; 1: malformed numbers; 2: in turn */
        char text[4096] = "WorldBegin LightSource \"infinite\"\nXagain\n";
        bis_scene_desc *d;
        bis_diag diag;
        for (int k = 1; k < n; k++)
            snprintf(text + strlen(text), sizeof text - strlen(text), "%s%c%c\nXagain\n",
                     kind == 1 || (kind == 2 && k % 2) ? "0x" : "Xword", 'a' + k / 26, 'a' + k % 26);
        assert_int_equal(parse_text(&d, &diag, text), BIS_INPUT);
        assert_null(d);
        if (diag.n != (size_t)(n < 50 ? n : 51)) fail_msg("%d errors of kind %d: %zu messages", n, kind, diag.n);
        const bool stopped = strstr(diag.messages[diag.n - 1].text, ": error: stopped after 50 errors") != NULL;
        if (stopped != (n >= 50)) fail_msg("%d errors of kind %d: %s", n, kind, diag.messages[diag.n - 1].text);
        char again[64]; /* with the first it is as many as errors were read, but where the last is the fiftieth */
        snprintf(again, sizeof again, " (%d like it: also in line 4, line 6, line 8, line 10, ...)", n < 50 ? n : 49);
        /* a malformed number is complained of before the word that stands before it */
        const char *const first = diag.messages[kind > 0].text;
        if (!strstr(first, again)) fail_msg("%d errors of kind %d: %s", n, kind, first);
        bis_diag_clear(&diag);
    }
}

/* What follows would close other blocks than its author means: nothing of it is read, and all blocks are open. */
static void what_follows_blocks_that_nest_too_deeply_is_not_read(void **state)
{
    static const char unit[] = "AttributeBegin ";
    const size_t length = strlen(unit);
    char *text = malloc(4097 * length + 64), *out = text;
    bis_scene_desc *d;
    bis_diag diag;

    out += sprintf(out, "WorldBegin ");
    for (int i = 0; i < 4097; i++, out += length) memcpy(out, unit, length);
    strcpy(out, "AttributeEnd Nonsense Nonsense");
    assert_int_equal(parse_text(&d, &diag, text), BIS_INPUT);
    assert_int_equal(diag.n, 1);
    assert_non_null(strstr(diag.messages[0].text, "blocks nest deeper than 4096"));
    bis_diag_clear(&diag);
    free(text);
}

static void limits_are_errors_and_not_exhausted_memory(void **state)
{
    char buf[256];
    assert_non_null(strstr(repeated(buf, "WorldBegin ", "AttributeBegin ", 100000, ""),
                           "blocks nest deeper than 4096"));
    assert_non_null(strstr(repeated(buf, "WorldBegin ", "AttributeBegin ", 4097, ""), "blocks nest deeper than 4096"));
    assert_non_null(strstr(repeated(buf, "WorldBegin ", "AttributeBegin ", 4096, ""), "AttributeBegin has no "));
    /* 1000 shapes a thousand times, and that a thousand times */
    char *objects = malloc(200000);
    char *out = objects + sprintf(objects, "WorldBegin ObjectBegin \"o\" ");
    for (int i = 0; i < 5000; i++) out += sprintf(out, "Shape \"sphere\" ");
    strcpy(out, "ObjectEnd ");
    assert_non_null(strstr(repeated(buf, objects, "ObjectInstance \"o\" ", 2000, ""),
                           "more than 1048576 shapes, instances included"));
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

static void after_a_texture_of_the_wrong_kind_the_parser_goes_on(void **state)
{
    bis_scene_desc *d;
    bis_diag diag;
    assert_int_equal(parse_text(&d, &diag, "WorldBegin LightSource \"infinite\"\n"
                                "Texture \"wood\" \"spectrum\" \"constant\"\n"
                                "Material \"phong\" \"texture exponent\" \"wood\"\nShape \"quux\""), BIS_INPUT);
    assert_int_equal(diag.n, 2);
    assert_non_null(strstr(diag.messages[0].text, ":3:"));
    assert_non_null(strstr(diag.messages[1].text, ":4:"));
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

/* Its words would be errors of their own, if it were read as a scene. */
static void an_included_map_gives_one_error(void **state)
{
    static const char map[] = "PF\n1 1\n-1\nShape Quux WorldEnd";
    const char *path = scratch("included.pfm");
    char text[256];
    bis_scene_desc *d;
    bis_diag diag;
    store(path, map, sizeof map - 1);
    snprintf(text, sizeof text, "WorldBegin LightSource \"infinite\"\nInclude \"%s\" Shape \"sphere\"",
             strrchr(path, '/') + 1);
    assert_int_equal(parse_text(&d, &diag, text), BIS_INPUT);
    assert_int_equal(diag.n, 1);
    assert_non_null(strstr(diag.messages[0].text, "scene.txt:2:"));
    assert_non_null(strstr(diag.messages[0].text, "is a PFM image, no part of a scene: "));
    bis_diag_clear(&diag);
}

/* What is no scene is told with what to do, as the scene itself and as a part of one. */
static void a_file_that_is_no_scene_is_told_what_it_is_for(void **state)
{
    static const struct { const char *name, *content, *what, *instead; } cases[] = {
        {"s.pfm", "PF\n1 1\n-1\n", "a PFM image", ""}, /* it names the file itself */
        {"s.x", "ply\nformat ascii 1.0\n", "a PLY mesh", "a scene names it in Shape \"plymesh\" \"string filename\""},
        {"s.obj", "v 0 0 0\n", "a Wavefront mesh", "a scene names it in Shape \"objmesh\" \"string filename\""},
        {"s.y", "{}", "a file in JSON", "a scene is text in pbrt's format (`bis help scene`), such as scene.txt"},
    };
    for (size_t i = 0; i < BIS_COUNT(cases); i++) {
        char path[128], instead[400], text[800];
        bis_scene_desc *d;
        bis_diag diag = {0};
        snprintf(path, sizeof path, "%s", scratch(cases[i].name));
        store(path, cases[i].content, strlen(cases[i].content));
        if (i == 0)
            snprintf(instead, sizeof instead, "try `bis envmap %s` or `bis verify %s`; a scene names it in LightSource "
                     "\"infinite\" \"string filename\"", path, path);
        else snprintf(instead, sizeof instead, "%s", cases[i].instead);
        assert_int_equal(bis_scene_parse(&d, path, &diag), BIS_INPUT);
        assert_int_equal(diag.n, 1);
        snprintf(text, sizeof text, "%s: error: this is %s, no scene: %s", path, cases[i].what, instead);
        assert_string_equal(diag.messages[0].text, text);
        bis_diag_clear(&diag);
        snprintf(text, sizeof text, "WorldBegin LightSource \"infinite\" Include \"%s\" Shape \"cub\"",
                 strrchr(path, '/') + 1);
        assert_int_equal(parse_text(&d, &diag, text), BIS_INPUT);
        assert_int_equal(diag.n, 2); /* the next directive is read as ever */
        snprintf(text, sizeof text, "%s:1:43: error: \"%s\" is %s, no part of a scene: %s", scratch("scene.txt"), path,
                 cases[i].what, instead);
        assert_string_equal(diag.messages[0].text, text);
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

/* Of each row of the code there is a line of the page with its directive, its name and what changes. */
static void what_is_ignored_is_what_the_reference_says(void **state)
{
    unsigned char *page;
    size_t size;
    assert_int_equal(bis_file_read(&page, &size, "docs/scene-format.md", (bis_loc){0}, NULL), BIS_OK);
    for (size_t i = 0; i < bis_n_ignored; i++) {
        const bis_ignored *row = &bis_ignored_parameters[i];
        const char *changes = strstr(row->consequence, "changes ") + strlen("changes "), *line = (const char *)page;
        char directive[64], name[64], effect[128], text[512] = "";
        snprintf(directive, sizeof directive, "| `%s` |", row->directive);
        snprintf(name, sizeof name, "`%s`", row->name);
        snprintf(effect, sizeof effect, "| %s |", changes);
        while (*line && !(strstr(text, directive) && strstr(text, name) && strstr(text, effect))) {
            const size_t n = strcspn(line, "\n");
            snprintf(text, sizeof text, "%.*s", (int)n, line);
            line += n + (line[n] == '\n');
        }
        if (!*line) fail_msg("%s \"%s\" changes %s", row->directive, row->name, changes);
    }
    bis_free(page);
}

static const expect_word words[] = {{"parse", parse}, {NULL, NULL}};

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_bad_scene_has_its_messages),
        cmocka_unit_test(what_is_ignored_is_what_the_reference_says),
        cmocka_unit_test(a_bad_scene_without_a_list_for_messages_fails_all_the_same),
        cmocka_unit_test(a_scene_that_cannot_be_read_is_the_disks_fault),
        cmocka_unit_test(each_line_has_its_messages),
        cmocka_unit_test(each_name_of_pbrts_is_known),
        cmocka_unit_test(an_empty_world_has_the_defaults_of_the_contract_E39),
        cmocka_unit_test(a_sampler_alone_leaves_the_integrator_to_us),
        cmocka_unit_test(an_integrator_alone_has_the_settings_of_the_thesis_and_leaves_the_sampler_to_us),
        cmocka_unit_test(an_integrator_of_pbrt_is_none),
        cmocka_unit_test(a_word_that_sir_once_had_is_ignored_with_a_note),
        cmocka_unit_test(a_second_sampler_begins_with_the_defaults),
        cmocka_unit_test(a_film_without_parameters_has_the_defaults_of_no_film),
        cmocka_unit_test(a_light_without_parameters_has_the_defaults_of_the_contract),
        cmocka_unit_test(materials_have_the_defaults_of_the_contract),
        cmocka_unit_test(whole_quadrics_may_say_that_they_are_whole),
        cmocka_unit_test(coefficients_of_figure_5_5_s_text_are_warned_of_and_its_captions_are_not_E38),
        cmocka_unit_test(every_parameter_before_the_world_arrives),
        cmocka_unit_test(a_film_has_the_layers_that_are_named),
        cmocka_unit_test(errata_are_switched_by_their_names),
        cmocka_unit_test(every_parameter_of_the_other_integrators_arrives),
        cmocka_unit_test(every_parameter_of_a_light_arrives),
        cmocka_unit_test(each_parameter_of_a_light_changes_itself_alone),
        cmocka_unit_test(spp_alone_is_divided_as_squarely_as_possible),
        cmocka_unit_test(a_directive_given_again_starts_from_the_defaults),
        cmocka_unit_test(what_a_scene_has_once_is_told_when_it_comes_again),
        cmocka_unit_test(transformations_multiply_from_the_right),
        cmocka_unit_test(the_coordinate_system_camera_maps_camera_space_to_the_world),
        cmocka_unit_test(blocks_restore_what_they_saved),
        cmocka_unit_test(instances_put_their_transformation_before_the_objects),
        cmocka_unit_test(a_file_named_by_many_shapes_is_one_mesh),
        cmocka_unit_test(a_file_that_is_read_in_other_ways_is_other_meshes),
        cmocka_unit_test(a_named_material_may_be_used_before_it_is_made),
        cmocka_unit_test(triangles_arrive_with_points_indices_and_normals),
        cmocka_unit_test(a_light_frame_may_be_rotated_and_mirrored_and_is_made_exactly_orthonormal),
        cmocka_unit_test(a_scene_in_pbrt_v3_and_in_v4_spelling_is_the_same_scene_and_gives_no_message),
        cmocka_unit_test(a_transformation_with_one_infinite_number_is_not_usable),
        cmocka_unit_test(what_nobody_names_has_the_file_for_its_place),
        cmocka_unit_test(another_integrator_brings_its_defaults_and_the_scenes_own_keeps_its_settings),
        cmocka_unit_test(a_file_in_a_file_is_missing_and_a_name_too_long_is_not),
        cmocka_unit_test(a_file_that_may_not_be_read_is_no_missing_one),
        cmocka_unit_test(a_german_locale_changes_no_number),
        cmocka_unit_test(damaged_scenes_are_survived),
        cmocka_unit_test(a_scene_is_read_to_its_fiftieth_error),
        cmocka_unit_test(what_follows_blocks_that_nest_too_deeply_is_not_read),
        cmocka_unit_test(limits_are_errors_and_not_exhausted_memory),
        cmocka_unit_test(includes_that_double_are_stopped),
        cmocka_unit_test(an_included_map_gives_one_error),
        cmocka_unit_test(a_file_that_is_no_scene_is_told_what_it_is_for),
        cmocka_unit_test(a_text_is_parsed_as_a_file_of_that_name),
        cmocka_unit_test(after_a_texture_of_the_wrong_kind_the_parser_goes_on),
        cmocka_unit_test(every_example_of_the_reference_is_a_scene),
    };
    return expect_run("parser", tests, sizeof tests / sizeof *tests, NULL, scratch_remove,
                      &(expect_folder){"tests/data/bad", words, NULL});
}
