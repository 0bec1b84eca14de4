/* foreign: scenes that were written for pbrt: where it looks for files, what it lets pass, what bis makes of it. */
#include "bis/base/mem.h"
#include "bis/scene/scene.h"
#include "image_help.h"

#include <ftw.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

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
    (void)state;
    return mkdir(scratch("folder"), 0777) || mkdir(place("geometry"), 0777) || mkdir(place("geometry/geometry"), 0777);
}

static int forget(const char *path, const struct stat *st, int type, struct FTW *walk)
{
    (void)st, (void)type, (void)walk;
    return remove(path);
}

static int remove_folder(void **state)
{
    (void)state;
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
    (void)state;
    write_file("geometry/a.txt", "Shape \"plymesh\" \"string filename\" \"geometry/m.ply\"\n");
    write_file("geometry/m.ply", "ply\n");
    write_file("geometry/geometry/m.ply", "ply\n");
    bis_scene_desc *d = good(LIT "Include \"geometry/a.txt\"", 0, said);
    assert_true(ends(d->meshes[0].filename, "/geometry/m.ply") && !ends(d->meshes[0].filename, "geometry/geometry/m.ply"));
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
    (void)state;
    bis_scene_desc *d = good(LIT "Shape \"plymesh\" \"string filename\" \"tests/scene/test_foreign.c\"", 0, said);
    assert_string_equal(d->meshes[0].filename, "tests/scene/test_foreign.c");
    bis_scene_desc_free(d);
}

static void an_include_may_be_compressed(void **state)
{
    char said[8192];
    static const char text[] = "Translate 0 4 0 Shape \"sphere\"\nShape \"spher\"\n";
    (void)state;
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
    (void)state;
    bis_scene_desc *d = good(LIT "Material \"metal\" \"spectrum eta\" \"spds/Au.eta.spd\" \"spectrum k\" \"spds/Au.k.spd\" "
                                 "Shape \"sphere\" Material \"matte\" \"spectrum Kd\" \"spds/red.spd\"",
                             BIS_PARSE_APPROXIMATE | BIS_PARSE_LIST_MISSING, said);
    assert_int_equal(d->n_missing, 3);
    assert_true(ends(d->missing[0], "spds/Au.eta.spd") && ends(d->missing[2], "spds/red.spd"));
    bis_scene_desc_free(d);
    assert_int_equal(parse(&d, LIT "Material \"matte\" \"spectrum Kd\" \"spds/red.spd\"", BIS_PARSE_APPROXIMATE, said), BIS_INPUT);
}

/* ---- messages ---- */

/* Numbers outside of quotes do not make another cause, names do; sixty of one do not hide the next. */
static void errors_of_one_cause_are_one_message_with_their_number(void **state)
{
    char text[8192] = LIT, said[8192];
    bis_scene_desc *d;
    (void)state;
    for (int i = 1; i <= 60; i++) snprintf(text + strlen(text), sizeof text - strlen(text), "Shape \"sphere\" \"float radius\" -%d\n", i);
    strcat(text, "Shape \"cub\"\nShape \"cubb\"\nShape \"cub\"\n");
    assert_int_equal(parse(&d, text, 0, said), BIS_INPUT);
    assert_says(said, "main.txt:2:16: error: \"radius\" is -1, must be > 0 (60 like it: also in line 3, line 4, line 5, line 6, ...)\n");
    assert_says(said, "main.txt:62:7: error: unknown Shape \"cub\" (2 like it: also in line 64)\n");
    assert_says(said, "main.txt:63:7: error: unknown Shape \"cubb\"\n");
    assert_null(strstr(said, "stopped"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_an_included_file_are_looked_for_beside_the_main_scene_first),
        cmocka_unit_test(the_working_directory_is_the_second_place),
        cmocka_unit_test(an_include_may_be_compressed),
        cmocka_unit_test(a_missing_spectrum_is_one_of_the_missing_files),
        cmocka_unit_test(errors_of_one_cause_are_one_message_with_their_number),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
