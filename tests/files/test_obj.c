/* SPDX-License-Identifier: BSD-2-Clause */
/* obj: every form of a face, pairs of position and normal, continued lines; bad files with their exact messages; the
 * files of the wild. */
#include "mesh_help.h"
#include "files/obj.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static void expect_text(bis_mesh *m, const char *text, const char *warning)
{
    bytes b = {0};

    if (*text) put_text(&b, text);
    expect_mesh_of(bis_obj_read, m, &b, "text.obj", warning);
    bytes_clear(&b);
}

static void refuse_as(mesh_reader *read, const char *name, const char *text, int line, const char *message)
{
    bytes b = {0};

    put_text(&b, text);
    expect_mesh_refusal_of(read, &b, name, line, message);
    bytes_clear(&b);
}

static void refuse_text(const char *text, int line, const char *message)
{
    refuse_as(bis_obj_read, "bad.obj", text, line, message);
}

static void a_corner_may_have_any_of_its_forms(void **state)
{
    static const char *const faces[] = {"f 1 2 3 4", "f 1/1 2/2 3/3 4/4", "f 1/ 2/ 3/ 4/", "f 1// 2// 3// 4//",
        "f 1/1/ 2/2/ 3/3/ 4/4/", "f -4 -3 -2 -1", "f -4/1 2/2/ -2// 4", "\tf  1\t2 3 4 # a square",
        "f 1 2\\\n3\\\r\n 4\\\n\n"};
    (void)state;
    for (size_t i = 0; i < sizeof faces / sizeof faces[0]; i++) {
        char text[256];
        bis_mesh m;
        snprintf(text, sizeof text, SQUARE "%s", faces[i]);
        expect_text(&m, text, NULL);
        assert_int_equal(m.n_vertices, 4);
        assert_null(m.n);
        assert_int_equal(m.n_triangles, 2);
        assert_triangle(&m, 0, 0, 1, 2);
        assert_triangle(&m, 1, 0, 2, 3);
        bis_mesh_clear(&m);
    }
}

static void all_statements_but_v_vn_f_are_skipped(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m,
        "# f 1 1 1\nmtllib f.mtl\no f\ng f 1 2 3\ns 1\nusemtl v\nvt 1 2\nvp 1\nl 1 2\np 1\nfo 1 2 3\nv2 1 2 3\n"
        "v 0 0 0 1\r\nv 1 0 0 0.5 0.5 nan\rv 0 1 0\n\n\n  f 1 2 3\nf",
        "1 faces have fewer than 3 vertices and are left out");
    assert_int_equal(m.n_vertices, 3);
    assert_int_equal(m.n_triangles, 1);
    assert_true(m.p[1].x == 1);
    bis_mesh_clear(&m);
}

static void a_comment_behind_a_backslash_goes_on_like_any_line(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, SQUARE "# nothing \\\nf 1 2 3\nv 5 \\\n  6 \\\n 7\nf 1 2 5\n", NULL);
    assert_int_equal(m.n_vertices, 5);
    assert_true(m.p[4].x == 5 && m.p[4].y == 6 && m.p[4].z == 7);
    assert_int_equal(m.n_triangles, 1);
    bis_mesh_clear(&m);
}

static void a_face_may_name_vertices_that_come_later_but_not_by_a_negative_index(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, "f 1//1 2//1 3//1\n" SQUARE "vn 0 0 1\n", NULL);
    assert_int_equal(m.n_triangles, 1);
    assert_true(m.n[2].z == 1 && m.n[3].z == 0);
    bis_mesh_clear(&m);
    refuse_text("f -1 -2 -3\n" SQUARE, 1, "the face has the index -1, but there are 0 \"v\" up to here");
}

static void each_pair_of_position_and_normal_is_one_vertex(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(
        &m, SQUARE "vn 0 0 1\nvn 0 0 -1\nf 1//1 2//1 3//1\nf 1//2 3//-1 4//2\nf 1//2 2//1 4\nf 1//1 3//2 4//2\n", NULL);
    assert_int_equal(m.n_vertices, 4 + 3);
    assert_triangle(&m, 0, 0, 1, 2);
    assert_triangle(&m, 1, 4, 5, 3);
    assert_triangle(&m, 2, 4, 1, 6);
    assert_triangle(&m, 3, 0, 5, 3);
    assert_true(m.n[0].z == 1 && m.n[4].z == -1 && m.n[5].z == -1 && m.n[3].z == -1 && m.n[6].z == 0);
    assert_true(m.p[4].x == 0 && m.p[5].x == 1 && m.p[5].y == 1 && m.p[6].y == 1);
    bis_mesh_clear(&m);
}

/* The table grows several times; the number of pairs is known. */
static void thousands_of_normals_at_one_position_are_told_apart(void **state)
{
    enum { N = 5000 };
    bytes b = {0};
    bis_mesh m;
    (void)state;
    put_text(&b, SQUARE);
    for (int i = 0; i < 2 * N; i++) {
        char text[64];
        snprintf(text, sizeof text, "vn %d 0 1\nf 1//%d 2//%d 3//%d\n", i % N, i % N + 1, i % 7 + 1, i % 2 + 1);
        put_text(&b, text);
    }
    expect_mesh_of(bis_obj_read, &m, &b, "pairs.obj", NULL);
    assert_int_equal(m.n_triangles, 2 * N);
    assert_int_equal(m.n_vertices, 1 + N + 7 + 2); /* vertex 4 is used by none */
    for (size_t i = 0; i < N; i++) {
        assert_int_equal(m.index[3 * i], m.index[3 * (i + N)]);
        assert_true(m.n[m.index[3 * i]].x == (float)i && m.p[m.index[3 * i]].x == 0);
    }
    bis_mesh_clear(&m);
    bytes_clear(&b);
}

static void normals_that_are_not_finite_stand_for_the_faces(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, SQUARE "vn nan 0 1\nvn 0 0 1\nf 1//1 2//2 3//2\n",
                "1 vertex normals are not finite: the faces' normals are used there");
    assert_true(m.n[0].x == 0 && m.n[0].y == 0 && m.n[0].z == 0 && m.n[1].z == 1);
    bis_mesh_clear(&m);
}

/* Files from which a program removed the normals alone. */
static void normals_that_a_file_does_not_have_are_left_out(void **state)
{
    static const char *const faces[] = {"f 1//1 2//2 3//3", "f 1/1/9 2/2/9 3/3/-1", "f 1//0 2 3"};
    (void)state;
    for (size_t i = 0; i < sizeof faces / sizeof faces[0]; i++) {
        char text[256];
        bis_mesh m;
        snprintf(text, sizeof text, SQUARE "%s\n", faces[i]);
        expect_text(
            &m, text, "faces name normals, but there is no \"vn\": the mesh is flat, unless \"smooth\" is true");
        assert_int_equal(m.n_triangles, 1);
        assert_null(m.n);
        bis_mesh_clear(&m);
    }
}

static bis_mesh mesh_with_uv(const char *text, const char *warning)
{
    bis_mesh m;
    bytes b = {0};
    put_text(&b, text);
    expect_mesh_of(bis_obj_read_uv, &m, &b, "uv.obj", warning);
    bytes_clear(&b);
    return m;
}

static void assert_uv(const bis_mesh *m, size_t vertex, float u, float v)
{
    if (!(m->uv[vertex].u == u && m->uv[vertex].v == v))
        fail_msg("vertex %zu: (%g, %g)", vertex, (double)m->uv[vertex].u, (double)m->uv[vertex].v);
}

/* One number, two, three, a comment behind one; v is 0 where there is none. */
static void a_texture_coordinate_has_one_to_three_numbers(void **state)
{
    (void)state;
    bis_mesh m = mesh_with_uv(SQUARE "vt 0.25\nvt 0.5 0.75 9\nvt -1 2\nvt 4 # 5\nf 1/1 2/2 3/3 4/-1\n", NULL);
    assert_int_equal(m.n_vertices, 4);
    assert_uv(&m, 0, 0.25f, 0);
    assert_uv(&m, 1, 0.5f, 0.75f);
    assert_uv(&m, 2, -1, 2);
    assert_uv(&m, 3, 4, 0);
    bis_mesh_clear(&m);
    refuse_as(bis_obj_read_uv, "uv.obj", SQUARE "vt 1 a\nf 1 2 3\n", 5,
              "\"a\" in \"vt\" is no number");
    refuse_as(bis_obj_read_uv, "uv.obj", SQUARE "vt\nf 1 2 3\n", 5,
              "\"vt\" has 0 numbers, must have 1");
    refuse_as(bis_obj_read_uv, "uv.obj", SQUARE "vt 1 1\nf 1/1 2/2 3/1\n", 6,
              "the face has the index 2, but there are 1 \"vt\"");
}

/* Either number may be the one that is not finite, or larger than a float. */
static void a_texture_coordinate_that_is_not_finite_stands_for_none(void **state)
{
    (void)state;
    bis_mesh m =
        mesh_with_uv(SQUARE "vt nan 1\nvt 1 inf\nvt 1e39 1\nvt 1 -1e39\nvt 3e38 -3e38\nf 1/1 2/2 3/3\nf 1/1 3/5 4/4\n",
            "4 texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)");
    assert_int_equal(m.n_vertices, 5); /* vertex 2 has two */
    for (size_t i = 0; i < 4; i++) assert_true(isnan(m.uv[i].u));
    assert_uv(&m, 4, 3e38f, -3e38f);
    bis_mesh_clear(&m);
}

/* A vertex with two coordinates is two; one that is used with and without is two, too. */
static void each_triple_of_position_coordinate_and_normal_is_one_vertex(void **state)
{
    (void)state;
    bis_mesh m = mesh_with_uv(SQUARE
        "vt 0 0\nvt 1 0\nvn 0 0 1\nvn 0 0 -1\nf 1/1/1 2/1/1 3/2/1\nf 1/1/1 3/1/1 4/1/2\nf 1/2/1 3/1/1 4/1/2\n"
        "f 1//1 3/2/1 4/1/1\nf 1/2/1 2/1 3/2/1\n",
        NULL);
    assert_int_equal(m.n_vertices, 4 + 5);
    assert_triangle(&m, 0, 0, 1, 2);
    assert_triangle(&m, 1, 0, 4, 3);
    assert_triangle(&m, 2, 5, 4, 3);
    assert_triangle(&m, 3, 6, 2, 7);
    assert_triangle(&m, 4, 5, 8, 2);
    static const struct {
        float u, normal;
        size_t of;
    } expected[9] = {
        {0, 1, 0}, {0, 1, 1}, {1, 1, 2}, {0, -1, 3}, {0, 1, 2}, {1, 1, 0}, {NAN, 1, 0}, {0, 1, 3}, {0, 0, 1}};
    for (size_t i = 0; i < 9; i++) {
        assert_true(m.uv[i].u == expected[i].u || (isnan(m.uv[i].u) && isnan(expected[i].u)));
        assert_true(
            m.n[i].z == expected[i].normal && m.p[i].x == m.p[expected[i].of].x && m.p[i].y == m.p[expected[i].of].y);
    }
    bis_mesh_clear(&m);
    m = mesh_with_uv(SQUARE "vt 0 0\nf 1 2 3\n", NULL);
    assert_null(m.uv); /* no face uses it */
    bis_mesh_clear(&m);
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
    (void)state;
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

static void an_empty_mesh_is_legal_with_a_warning(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, "", "no triangles: nothing of this mesh will be seen (0 vertices)");
    bis_mesh_clear(&m);
    expect_text(&m, SQUARE, "no triangles: nothing of this mesh will be seen (4 vertices)");
    bis_mesh_clear(&m);
}

static void bad_lines_are_refused_by_number(void **state)
{
    bytes zero = {0};
    (void)state;
    refuse_text(SQUARE "v 1 2\n", 5, "\"v\" has 2 numbers, must have 3");
    refuse_text(SQUARE "v\nf 1 2 3", 5, "\"v\" has 0 numbers, must have 3");
    refuse_text(SQUARE "v 1 two 3\n", 5, "\"two\" in \"v\" is no number");
    refuse_text(SQUARE "v 1 2x 3\n", 5, "\"2x\" in \"v\" is no number");
    refuse_text(SQUARE "vn 1 2\n", 5, "\"vn\" has 2 numbers, must have 3");
    refuse_text("v 1 \\\n2 \\\n oops", 3, "\"oops\" in \"v\" is no number");
    refuse_text(SQUARE "\n\r\nv 1 inf 2\n", 7, "the vertex has y = inf, must be a finite float");
    refuse_text("v 1 2 nan\n", 1, "the vertex has z = nan, must be a finite float");
    refuse_text("v -1e60 2 0\n", 1, "the vertex has x = -1e+60, must be a finite float");
    refuse_text(SQUARE "f 1 2 5\n", 5, "the face has the index 5, but there are 4 \"v\"");
    refuse_text(SQUARE "f 1 2 0\n", 5, "the face has the index 0, but there are 4 \"v\"");
    refuse_text(SQUARE "f 1 2 -5\n", 5, "the face has the index -5, but there are 4 \"v\" up to here");
    refuse_text(SQUARE "f 1 2 99999999999999999999999\n", 5,
        "the face has the index 99999999999999999999999, but there are 4 \"v\"");
    refuse_text(SQUARE "f 1 2 3.0\n", 5, "\"3.0\" is no corner of a face: v, v/vt, v//vn or v/vt/vn");
    refuse_text(SQUARE "f 1 2 /3\n", 5, "\"/3\" is no corner of a face: v, v/vt, v//vn or v/vt/vn");
    refuse_text(SQUARE "f 1 2 3/1/1/1\n", 5, "\"3/1/1/1\" is no corner of a face: v, v/vt, v//vn or v/vt/vn");
    refuse_text(SQUARE "vn 0 0 1\nf 1//2 2 3\n", 6, "the face has the index 2, but there are 1 \"vn\"");
    refuse_text(SQUARE "f a b c\n", 5, "\"a\" is no corner of a face: v, v/vt, v//vn or v/vt/vn");
    put(&zero, "v 0 0 0\0\n", 9);
    expect_mesh_refusal_of(
        bis_obj_read, &zero, "zero.obj", 0, "not an OBJ file: it is no text, there is a zero byte in it");
    bytes_clear(&zero);
}

static const char *const rich =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvn 0 1 1\nf 1/1/1 2/2/2 3/3/-1 1//2 \\\n 2//1\nf 1 2 3\n";

static void damaged_files_never_crash(void **state)
{
    bytes b = {0};
    (void)state;
    put_text(&b, rich);
    try_mesh_damage(bis_obj_read, &b, "damage.obj", 5000, 1);
    bytes_clear(&b);
}

static void any_allocation_may_fail(void **state)
{
    bytes b = {0};
    (void)state;
    put_text(&b, rich);
    try_mesh_memory(bis_obj_read, &b, "memory.obj");
    bytes_clear(&b);
}

/* Vertices: of the file, and one for each further pair with a normal. */
static void files_of_the_wild_are_read_right(void **state)
{
    static const struct {
        const char *name;
        size_t n_vertices, n_triangles;
        bool normals;
    } files[] = {{"conformance/obj/cbox_smallbox", 24, 12, true}, {"conformance/obj/cubevt", 24, 12, true},
                 {"conformance/obj/face_in_group_name", 1, 0, false}, {"conformance/obj/joined_tetrahedra", 15, 8,
                  true},
                 {"conformance/obj/nancolor", 8, 12, false}, {"conformance/obj/obj_empty", 0, 0, false},
                 {"conformance/obj/obj_points", 8, 0, false}, {"conformance/obj/obj_with_no_face_in_chunk", 3, 1,
                  false},
                 {"conformance/obj/polygonfaces", 5, 3, false}, {"conformance/obj/rectangle_normals", 4, 2, true},
                 {"conformance/obj/rectangle_normals_uv", 4, 2, true}, {"conformance/obj/rectangle_uv", 4, 2, false},
                 {"mesh/teapot_6k", 3644, 6320, false}, {"mesh/spot_6k", 2930, 5856, false}};
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        char name[128];
        bis_diag diag = {0};
        bis_mesh m;
        snprintf(name, sizeof name, "%s.obj", files[i].name);
        const char *path = shared_file(name);
        if (!path) skip();
        bis_status status = bis_obj_read(&m, path, (bis_loc){0}, &diag);
        if (status) print_message("%s\n", diag.messages[0].text);
        assert_int_equal(status, BIS_OK);
        assert_sound(&m);
        if (m.n_vertices != files[i].n_vertices || m.n_triangles != files[i].n_triangles ||
            (m.n != NULL) != files[i].normals) {
            print_message(
                "%s: %zu vertices, %zu triangles, normals: %d\n", name, m.n_vertices, m.n_triangles, m.n != NULL);
            fail();
        }
        assert_int_equal(diag.n, files[i].n_triangles == 0 ? 1 : 0);
        bis_mesh_clear(&m);
        bis_diag_clear(&diag);
    }
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
    };
    (void)state;
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

/* Of a word of 40 characters 32 are shown. A line that goes on counts as two, whatever its end. */
static void long_words_are_cut_off_and_continued_lines_counted(void **state)
{
#define LONG "123456789012345678901234567890123456789x"
#define CUT "12345678901234567890123456789012"
    (void)state;
    refuse_text(SQUARE "v 1 " LONG " 3\n", 5, "\"" CUT "\" in \"v\" is no number");
    refuse_text(SQUARE "f 1 2 " LONG "\n", 5, "the face has the index " CUT ", but there are 4 \"v\"");
    refuse_text(SQUARE "f 1 2 x" LONG "\n", 5,
        "\"x1234567890123456789012345678901\" is no corner of a face: v, v/vt, v//vn or v/vt/vn");
    refuse_text("v 1 \\\r\n2 \\\r 3\\\n\r\noops\nv 1 x 2\n", 6, "\"x\" in \"v\" is no number");
    refuse_text("v\\\r\n1 2 3\nv 1\t\v\f2 x", 3, "\"x\" in \"v\" is no number");
    refuse_text("# a \\\r\nv x\nv 1 2 y\n", 3, "\"y\" in \"v\" is no number");
#undef LONG
#undef CUT
}

/* Negative indices count back from what has been read so far, for each of the three lists by itself. */
static void negative_indices_count_from_where_they_stand(void **state)
{
    bis_mesh m;
    (void)state;
    m = mesh_with_uv(SQUARE "vt 0.25 0\nvn 0 0 1\nf -4/-1/-1 -3/-1/-1 -2/-1/-1\nvt 0.5 0\nvn 0 0 2\nvn 0 0 3\nv 2 2 2\n"
                     "f -1/-1/-1 -2/-2/-2 -3/-2/-3\n", NULL);
    assert_int_equal(m.n_triangles, 2);
    assert_int_equal(m.n_vertices, 5); /* the third of the square has what it had before */
    assert_triangle(&m, 0, 0, 1, 2);
    assert_triangle(&m, 1, 4, 3, 2);
    assert_uv(&m, 0, 0.25f, 0);
    assert_uv(&m, 2, 0.25f, 0);
    assert_uv(&m, 3, 0.25f, 0);
    assert_uv(&m, 4, 0.5f, 0);
    assert_true(m.n[0].z == 1 && m.n[2].z == 1 && m.n[3].z == 2 && m.n[4].z == 3);
    bis_mesh_clear(&m);
    refuse_as(bis_obj_read_uv, "uv.obj", SQUARE "vt 1 1\nf 1/-2 2 3\n", 6,
              "the face has the index -2, but there are 1 \"vt\" up to here");
    refuse_as(bis_obj_read, "vn.obj", SQUARE "vn 0 0 1\nf 1//-2 2 3\nvn 0 0 1\n", 6,
              "the face has the index -2, but there are 1 \"vn\" up to here");
    refuse_as(bis_obj_read, "v.obj", SQUARE "f -1 -2 -0\n", 5,
              "the face has the index -0, but there are 4 \"v\" up to here");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_corner_may_have_any_of_its_forms),
        cmocka_unit_test(all_statements_but_v_vn_f_are_skipped),
        cmocka_unit_test(a_comment_behind_a_backslash_goes_on_like_any_line),
        cmocka_unit_test(a_face_may_name_vertices_that_come_later_but_not_by_a_negative_index),
        cmocka_unit_test(each_pair_of_position_and_normal_is_one_vertex),
        cmocka_unit_test(thousands_of_normals_at_one_position_are_told_apart),
        cmocka_unit_test(normals_that_are_not_finite_stand_for_the_faces),
        cmocka_unit_test(normals_that_a_file_does_not_have_are_left_out),
        cmocka_unit_test(a_texture_coordinate_has_one_to_three_numbers),
        cmocka_unit_test(a_texture_coordinate_that_is_not_finite_stands_for_none),
        cmocka_unit_test(each_triple_of_position_coordinate_and_normal_is_one_vertex),
        cmocka_unit_test(a_part_is_what_follows_a_name),
        cmocka_unit_test(an_empty_mesh_is_legal_with_a_warning),
        cmocka_unit_test(bad_lines_are_refused_by_number),
        cmocka_unit_test(damaged_files_never_crash),
        cmocka_unit_test(any_allocation_may_fail),
        cmocka_unit_test(files_of_the_wild_are_read_right),
        cmocka_unit_test(a_part_without_faces_is_not_shown),
        cmocka_unit_test(long_words_are_cut_off_and_continued_lines_counted),
        cmocka_unit_test(negative_indices_count_from_where_they_stand),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
