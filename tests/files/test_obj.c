/* SPDX-License-Identifier: BSD-2-Clause */
/* obj: texts beside the mesh that each is: every form of a face, pairs of position and normal, continued lines; bad
 * files with their messages. */
#include "claim.h"
#include "mesh_help.h"
#include "files/obj.h"

#include <stdio.h>
#include <string.h>

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
#define QUAD "0 0 0, 1 0 0, 1 1 0, 0 1 0"
#define MOST "3.4028234663852886e38" /* the largest float */
#define BIG "3.402823e+38"
#define NO_NORMALS "faces name normals, but there is no \"vn\": the mesh is flat, unless \"smooth\" is true"

static const struct {
    mesh_reader *read;
    const char *claim, *text, *warning, *mesh;
} texts[] = {
#define FORM(face) {bis_obj_read, "a corner may have any of its forms", SQUARE face, NULL, QUAD "; 0 1 2, 0 2 3"}
    FORM("f 1 2 3 4"), FORM("f 1/1 2/2 3/3 4/4"), FORM("f 1/ 2/ 3/ 4/"), FORM("f 1// 2// 3// 4//"),
    FORM("f 1/1/ 2/2/ 3/3/ 4/4/"), FORM("f -4 -3 -2 -1"), FORM("f -4/1 2/2/ -2// 4"), FORM("\tf  1\t2 3 4 # a square"),
    FORM("f 1 2\\\n3\\\r\n 4\\\n\n"), FORM("f 1/10 2/20/ 3/-30/ 4/90"), FORM("f\\\n1 2 3 4"),
    {bis_obj_read, "all statements but v, vn, f are skipped",
     "# f 1 1 1\nmtllib f.mtl\no f\ng f 1 2 3\ns 1\nusemtl v\nvt 1 2\nvp 1\nl 1 2\np 1\nfo 1 2 3\nv2 1 2 3\n"
     "v 0 0 0 1\r\nv 1 0 0 0.5 0.5 nan\rv 0 1 0\n\n\n  f 1 2 3\nf",
     "1 faces have fewer than 3 vertices and are left out", "0 0 0, 1 0 0, 0 1 0; 0 1 2"},
    {bis_obj_read, "a comment behind a backslash goes on like any line",
     SQUARE "# nothing \\\nf 1 2 3\nv 5 \\\n  6 \\\n 7\nf 1 2 5\n", NULL, QUAD ", 5 6 7; 0 1 4"},
    {bis_obj_read, "a face may name vertices that come later", "f 1//1 2//1 3//1\n" SQUARE "vn 0 0 1\n", NULL,
     "0 0 0 n 0 0 1, 1 0 0 n 0 0 1, 1 1 0 n 0 0 1, 0 1 0 n 0 0 0; 0 1 2"},
    {bis_obj_read, "each pair of position and normal is one vertex",
     SQUARE "vn 0 0 1\nvn 0 0 -1\nf 1//1 2//1 3//1\nf 1//2 3//-1 4//2\nf 1//2 2//1 4\nf 1//1 3//2 4//2\n", NULL,
     "0 0 0 n 0 0 1, 1 0 0 n 0 0 1, 1 1 0 n 0 0 1, 0 1 0 n 0 0 -1, 0 0 0 n 0 0 -1, 1 1 0 n 0 0 -1, 0 1 0 n 0 0 0; "
     "0 1 2, 4 5 3, 4 1 6, 0 5 3"},
    {bis_obj_read, "normals that are not finite stand for the faces'",
     SQUARE "vn nan 0 1\nvn 0 0 1\nvn 2 inf 1\nvn 3 1 -1e39\nf 1//1 2//2 3//3 4//4\n",
     "3 vertex normals are not finite: the faces' normals are used there",
     "0 0 0 n 0 0 0, 1 0 0 n 0 0 1, 1 1 0 n 0 0 0, 0 1 0 n 0 0 0; 0 1 2, 0 2 3"},
    {bis_obj_read, "one normal that is not finite is counted, too", SQUARE "vn nan 0 1\nf 1 2 3\nf 4//1 3//1 2//1\n",
     "1 vertex normals are not finite: the faces' normals are used there",
     "0 0 0 n 0 0 0, 1 0 0 n 0 0 0, 1 1 0 n 0 0 0, 0 1 0 n 0 0 0, 1 1 0 n 0 0 0, 1 0 0 n 0 0 0; 0 1 2, 3 4 5"},
    {bis_obj_read_uv, "one coordinate that is not finite is counted, too", SQUARE "vt nan 0 1\nf 1 2 3\n",
     "1 texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)", QUAD "; 0 1 2"},
    {bis_obj_read, "the largest float is a coordinate of a vertex and of a normal",
     "v " MOST " -" MOST " " MOST "\nv 1 0 0\nv 1 1 0\nvn " MOST " " MOST " -" MOST "\nf 1//1 2//1 3//1\n", NULL,
     BIG " -" BIG " " BIG " n " BIG " " BIG " -" BIG ", 1 0 0 n " BIG " " BIG " -" BIG ", "
     "1 1 0 n " BIG " " BIG " -" BIG "; 0 1 2"},
    {bis_obj_read, "a vertex that faces use without a normal and with one is two",
     SQUARE "vn 0 0 1\nf 1 2 3\nf 1//1 3//1 4//1\n", NULL,
     "0 0 0 n 0 0 0, 1 0 0 n 0 0 0, 1 1 0 n 0 0 0, 0 1 0 n 0 0 1, 0 0 0 n 0 0 1, 1 1 0 n 0 0 1; 0 1 2, 4 5 3"},
    /* files from which a program removed the normals alone */
#define LACKING(face) {bis_obj_read, "normals that a file does not have are left out", SQUARE face "\n", NO_NORMALS, \
    QUAD "; 0 1 2"}
    LACKING("f 1//1 2//2 3//3"), LACKING("f 1/1/9 2/2/9 3/3/-1"), LACKING("f 1//0 2 3"),
    {bis_obj_read, "an empty mesh is legal", "", "no triangles: nothing of this mesh will be seen (0 vertices)", "; "},
    {bis_obj_read, "a mesh without faces is legal", SQUARE,
     "no triangles: nothing of this mesh will be seen (4 vertices)", QUAD "; "},

    {bis_obj_read_uv, "a texture coordinate has one to three numbers; v is 0 where there is none",
     SQUARE "vt 0.25\nvt 0.5 0.75 9\nvt -1 2\nvt 4 # 5\nf 1/1 2/2 3/3 4/-1\n", NULL,
     "0 0 0 t 0.25 0, 1 0 0 t 0.5 0.75, 1 1 0 t -1 2, 0 1 0 t 4 0; 0 1 2, 0 2 3"},
    {bis_obj_read_uv, "a texture coordinate that is not finite, or larger than a float, stands for none",
     SQUARE "vt nan 1\nvt 1 inf\nvt 1e39 1\nvt 1 -1e39\nvt " MOST " -" MOST "\nf 1/1 2/2 3/3\n"
     "f 1/1 3/5 4/4\n",
     "4 texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)",
     "0 0 0 t none, 1 0 0 t none, 1 1 0 t none, 0 1 0 t none, 1 1 0 t " BIG " -" BIG "; 0 1 2, 0 4 3"},
    {bis_obj_read_uv, "a vertex that faces use without a coordinate and with one is two",
     SQUARE "vt .5 .25\nf 1 2 3\nf 1/1 3/1 4/1\n", NULL,
     "0 0 0 t none, 1 0 0 t none, 1 1 0 t none, 0 1 0 t 0.5 0.25, 0 0 0 t 0.5 0.25, 1 1 0 t 0.5 0.25; 0 1 2, 4 5 3"},
    {bis_obj_read_uv, "a coordinate may come after its faces; a slash with nothing behind it says nothing",
     SQUARE "f 1/1 2/ 3//\nvt 2 3 \\\n\n", NULL, "0 0 0 t 2 3, 1 0 0 t none, 1 1 0 t none, 0 1 0 t none; 0 1 2"},
    {bis_obj_read_uv, "normals that a file does not have are left out, its coordinates are not",
     SQUARE "vt 1 2\nf 1/1/1 2/1/-10 3/1/\n", NO_NORMALS,
     "0 0 0 t 1 2, 1 0 0 t 1 2, 1 1 0 t 1 2, 0 1 0 t none; 0 1 2"},
    /* a vertex with two coordinates is two; so is one that is used with and without */
    {bis_obj_read_uv, "each triple of position, coordinate and normal is one vertex",
     SQUARE "vt 0 0\nvt 1 0\nvn 0 0 1\nvn 0 0 -1\nf 1/1/1 2/1/1 3/2/1\nf 1/1/1 3/1/1 4/1/2\nf 1/2/1 3/1/1 4/1/2\n"
     "f 1//1 3/2/1 4/1/1\nf 1/2/1 2/1 3/2/1\n", NULL,
     "0 0 0 n 0 0 1 t 0 0, 1 0 0 n 0 0 1 t 0 0, 1 1 0 n 0 0 1 t 1 0, 0 1 0 n 0 0 -1 t 0 0, 1 1 0 n 0 0 1 t 0 0, "
     "0 0 0 n 0 0 1 t 1 0, 0 0 0 n 0 0 1 t none, 0 1 0 n 0 0 1 t 0 0, 1 0 0 n 0 0 0 t 0 0; "
     "0 1 2, 0 4 3, 5 4 3, 6 2 7, 5 8 2"},
    {bis_obj_read_uv, "an index of a coordinate or a normal that is not there is none",
     SQUARE "vt 1 2\nvn 0 0 1\nf 1/1/1 2/2/2 3/-2/0\nvt 9 9\n",
     "3 corners of faces name a \"vt\" or \"vn\" that is not there, and have none: textures may be wrong there",
     "0 0 0 n 0 0 1 t 1 2, 1 0 0 n 0 0 0 t 9 9, 1 1 0 n 0 0 0 t none, 0 1 0 n 0 0 0 t none; 0 1 2"},
    {bis_obj_read_uv, "coordinates that no face uses are left out", SQUARE "vt 0 0\nf 1 2 3\n", NULL, QUAD "; 0 1 2"},
    {bis_obj_read_uv, "negative indices count back from what was read so far, each list by itself",
     SQUARE "vt 0.25 0\nvn 0 0 1\nf -4/-1/-1 -3/-1/-1 -2/-1/-1\nvt 0.5 0\nvn 0 0 2\nvn 0 0 3\nv 2 2 2\n"
     "f -1/-1/-1 -2/-2/-2 -3/-2/-3\n", NULL,
     "0 0 0 n 0 0 1 t 0.25 0, 1 0 0 n 0 0 1 t 0.25 0, 1 1 0 n 0 0 1 t 0.25 0, 0 1 0 n 0 0 2 t 0.25 0, "
     "2 2 2 n 0 0 3 t 0.5 0; 0 1 2, 4 3 2"},
};

static void each_text_is_its_mesh(void **state)
{
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        bytes b = {0};
        put_text(&b, texts[i].text);
        expect_mesh_words(texts[i].read, &b, "text.obj", texts[i].warning, texts[i].claim, texts[i].mesh);
        bytes_clear(&b);
    }
}

#define LONG "123456789012345678901234567890123456789x"
#define CUT "12345678901234567890123456789012"
#define NO_CORNER(word) "\"" word "\" is no corner of a face: v, v/vt, v//vn or v/vt/vn"
#define NO_INDEX(index, what) "the face has the index " index ", but there are " what

/* 32 characters of a long word are told. A line that goes on counts as two, whatever its end. */
static const struct {
    mesh_reader *read;
    const char *text;
    int line;
    const char *message;
} bad[] = {
    {bis_obj_read, SQUARE "v 1 2\n", 5, "\"v\" has 2 numbers, must have 3"},
    {bis_obj_read, SQUARE "v 1 two 3\n", 5, "\"two\" in \"v\" is no number"},
    {bis_obj_read, SQUARE "v 1 " LONG " 3\n", 5, "\"" CUT "\" in \"v\" is no number"},
    {bis_obj_read, SQUARE "vn 1 2\n", 5, "\"vn\" has 2 numbers, must have 3"},
    {bis_obj_read, "v 1 \\\r\n2 \\\r 3\\\n\r\noops\nv 1 x 2\n", 6, "\"x\" in \"v\" is no number"},
    {bis_obj_read, "# a \\\r\nv x\nv 1 2 y\n", 3, "\"y\" in \"v\" is no number"},
    {bis_obj_read, SQUARE "\n\r\nv 1 inf 2\n", 7, "the vertex has y = inf, must be a finite float"},
    {bis_obj_read, "v 1 2 nan\n", 1, "the vertex has z = nan, must be a finite float"},
    {bis_obj_read, "v -1e60 2 0\n", 1, "the vertex has x = -1e+60, must be a finite float"},
    {bis_obj_read, SQUARE "f 1 2 5\n", 5, NO_INDEX("5", "4 \"v\"")},
    {bis_obj_read, SQUARE "f 1 2 0\n", 5, NO_INDEX("0", "4 \"v\"")},
    {bis_obj_read, SQUARE "f 1 2 -5\n", 5, NO_INDEX("-5", "4 \"v\" up to here")},
    {bis_obj_read, "f -1 -2 -3\n" SQUARE, 1, NO_INDEX("-1", "0 \"v\" up to here")},
    {bis_obj_read, SQUARE "f 1 2 99999999999999999999999\n", 5, NO_INDEX("99999999999999999999999", "4 \"v\"")},
    /* 2^64 + 1, which is no 1 */
    {bis_obj_read, SQUARE "f 1 2 18446744073709551617\n", 5, NO_INDEX("18446744073709551617", "4 \"v\"")},
    {bis_obj_read, SQUARE "f 1 2 3.0\n", 5, NO_CORNER("3.0")},
    {bis_obj_read, SQUARE "f 1 2 /3\n", 5, NO_CORNER("/3")},
    {bis_obj_read, SQUARE "f 1 2 3/1/1/1\n", 5, NO_CORNER("3/1/1/1")},
    {bis_obj_read, SQUARE "f a b c\n", 5, NO_CORNER("a")},
    {bis_obj_read_uv, SQUARE "vt 1 a\nf 1 2 3\n", 5, "\"a\" in \"vt\" is no number"},
};

static void a_bad_line_is_refused_by_its_number(void **state)
{
    bytes zero = {0};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        bytes b = {0};
        put_text(&b, bad[i].text);
        expect_mesh_refusal_of(bad[i].read, &b, "bad.obj", bad[i].line, bad[i].message);
        bytes_clear(&b);
    }
    put(&zero, "v 0 0 0\0\n", 9);
    expect_mesh_refusal_of(
        bis_obj_read, &zero, "zero.obj", 0, "not an OBJ file: it is no text, there is a zero byte in it");
    bytes_clear(&zero);
}

/* N positions, each with the first pair of coordinate and normal and then with others: those of a second pair, or with
 * as many coordinates, or as many normals, as there are positions. A vertex of a further triple comes where the triple
 * does, and a triple that comes again is the same vertex. */
static void thousands_of_further_triples_are_told_apart(void **state)
{
    enum { N = 3000 };
    for (int kind = 0; kind < 3; kind++) {
        bytes b = {0};
        bis_mesh m;
        char text[128];
        for (int i = 0; i < N; i++) {
            snprintf(text, sizeof text, "v %d 0 1\nvt %d 2\nvn %d 3 4\nf %d/1/1 -1/1/1 %d/1/1\n", i, i, i, i + 1,
                     i + 1);
            put_text(&b, text);
        }
        for (int i = 0; i < 2 * (N - 1); i++) {
            const int k = i % (N - 1) + 2; /* 2 to N */
            snprintf(text, sizeof text, "f %d/%d/%d 1/1/1 1/1/1\n", kind == 0 ? k : 1, kind == 1 ? k : 2,
                     kind == 2 ? k : 2);
            put_text(&b, text);
        }
        expect_mesh_of(bis_obj_read_uv, &m, &b, "triples.obj", NULL);
        assert_int_equal(m.n_vertices, N + N - 1);
        assert_int_equal(m.n_triangles, N + 2 * (N - 1));
        for (uint32_t i = 0; i < 2 * (N - 1); i++) {
            const uint32_t k = i % (N - 1) + 2, v = N + k - 2;
            assert_triangle(&m, N + i, v, 0, 0);
            assert_true(m.p[v].x == (kind == 0 ? (float)(k - 1) : 0) && m.p[v].z == 1);
            assert_true(m.uv[v].u == (kind == 1 ? (float)(k - 1) : 1) && m.uv[v].v == 2);
            assert_true(m.n[v].x == (kind == 2 ? (float)(k - 1) : 1) && m.n[v].z == 4);
        }
        for (uint32_t i = 0; i < N; i++) {
            assert_triangle(&m, i, i, i, i);
            assert_true(m.p[i].x == (float)i && m.uv[i].u == 0 && m.n[i].x == 0 && m.n[i].y == 3);
        }
        bis_mesh_clear(&m);
        bytes_clear(&b);
    }
}

/* By the names of usemtl, in the order in which they come; libraries with their lines. */
static void a_part_is_what_follows_a_name(void **state)
{
    static const char text[] =
        "mtllib a.mtl\n" SQUARE "f 1 2 3 4\nusemtl red\nf 1 2 3\nusemtl  pale blue \nusemtl none\nusemtl red\nf 1 3 4\n"
        "mtllib  b c.mtl \nusemtl pale blue\nf 2 3 4\nusemtl last\n";
    static const uint32_t part[] = {0, 0, 1, 1, 2};
    bis_obj_materials o;
    bis_mesh m;
    size_t n;
    store(scratch("parts.obj"), text, sizeof text - 1);
    assert_int_equal(bis_obj_read_parts(&m, &n, scratch("parts.obj"), false, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(n, 4);
    assert_int_equal(m.n_triangles, 5);
    for (size_t i = 0; i < 5; i++) assert_int_equal(m.part[i], part[i]);
    assert_null(m.uv);
    bis_mesh_clear(&m);
    assert_int_equal(bis_obj_read_materials(&o, scratch("parts.obj"), (bis_loc){0}, NULL), BIS_OK);
    static const char *const names[] = {"red", "pale blue", "none", "last"};
    assert_int_equal(o.parts.n, 4);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t k = 0;
        assert_true(bis_names_find(&o.parts, names[i], &k) && k == i + 1);
    }
    assert_int_equal(o.n_shown, 3);
    assert_true(o.is_shown[0] && o.is_shown[1] && o.is_shown[2]);
    assert_int_equal(o.n_libraries, 2);
    assert_string_equal(o.libraries[0].name, "a.mtl");
    assert_string_equal(o.libraries[1].name, "b c.mtl");
    assert_true(o.libraries[0].line == 1 && o.libraries[1].line == 13);
    bis_obj_materials_clear(&o);
}

/* Parts without a face, before and behind one that has some, and faces before the first name. */
static void a_part_without_faces_is_not_shown(void **state)
{
    static const struct {
        const char *text;
        size_t n_parts, n_shown;
        bool shown[4];
    } cases[] = {
        {"usemtl a\nusemtl b\nf 1 2 3\nusemtl c\n", 3, 3, {false, false, true}},
        {"usemtl a\nf 1 2 3\nusemtl b\nusemtl c\nf 1 2 3\n", 3, 4, {false, true, false, true}},
        {"f 1 2 3\nusemtl a\n", 1, 1, {true}},
        {"usemtl a\n", 1, 0, {false}},
        {"f 1 2 3\nusemtl a\nf 1 2 3\nusemtl a \nf 1 2 3\nusemtl\tb\nf 1 2 3", 2, 3, {true, true, true}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_obj_materials o;
        store(scratch("shown.obj"), cases[i].text, strlen(cases[i].text));
        assert_int_equal(bis_obj_read_materials(&o, scratch("shown.obj"), (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(o.parts.n, cases[i].n_parts);
        assert_int_equal(o.n_shown, cases[i].n_shown);
        for (size_t k = 0; k < o.n_shown; k++) assert_int_equal(o.is_shown[k], cases[i].shown[k]);
        assert_int_equal(o.n_libraries, 0);
        bis_obj_materials_clear(&o);
    }
}

/* One at the end of the file continues nothing, and none that stands within a name does. */
static void a_name_ends_before_the_backslash_that_continues_its_line(void **state)
{
    static const char text[] =
        "mtllib a\\b.mtl \\\n\nusemtl red\\\r\n\r\nf 1 2 3\nusemtl \\\n blue\\\\\n\nf 1 2 3\nusemtl end\\";
    static const char *const names[] = {"red", "blue\\", "end\\"};
    bis_obj_materials o;
    store(scratch("backslash.obj"), text, sizeof text - 1);
    assert_int_equal(bis_obj_read_materials(&o, scratch("backslash.obj"), (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(o.n_libraries, 1);
    assert_string_equal(o.libraries[0].name, "a\\b.mtl");
    assert_int_equal(o.parts.n, 3);
    for (uint32_t i = 0; i < 3; i++) assert_string_equal(o.parts.names[i], names[i]);
    assert_true(o.n_shown == 3 && !o.is_shown[0] && o.is_shown[1] && o.is_shown[2]);
    bis_obj_materials_clear(&o);
}

static const char *const rich =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0\nvt 1 0\nvt 2\nvn 0 0 1\nvn 0 1 1\nf 1/1/1 2/2/2 3/3/-1 1//2 \\\n 2//1\nf 1 2 3\n";

static void damaged_files_never_crash(void **state)
{
    bytes b = {0};
    put_text(&b, rich);
    try_mesh_damage(bis_obj_read, &b, "damage.obj", 5000, 1);
    bytes_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_text_is_its_mesh),
        cmocka_unit_test(a_bad_line_is_refused_by_its_number),
        cmocka_unit_test(thousands_of_further_triples_are_told_apart),
        cmocka_unit_test(a_part_is_what_follows_a_name),
        cmocka_unit_test(a_part_without_faces_is_not_shown),
        cmocka_unit_test(damaged_files_never_crash),
        cmocka_unit_test(a_name_ends_before_the_backslash_that_continues_its_line),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
