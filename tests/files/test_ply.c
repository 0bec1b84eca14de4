/* SPDX-License-Identifier: BSD-2-Clause */
/* ply: every type, order and element, written here byte by byte; bad files with their exact messages; the files of the
 * wild against the counts of an independent reader. */
#include "mesh_help.h"
#include "files/ply.h"

#include "bis/base/mem.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SQUARE_HEADER "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
#define FACES(n) "element face " #n "\nproperty list uchar int vertex_indices\nend_header\n"
#define ASCII "ply\nformat ascii 1.0\n"

static const float square[4][3] = {{0, 0, 0}, {1, 0, 0.5f}, {1, 1, 0}, {0, 1, -0.25f}};

static bytes text_file(const char *text)
{
    bytes b = {0};

    if (*text) put_text(&b, text);
    return b;
}

static void expect_text(bis_mesh *m, const char *text, const char *warning)
{
    bytes b = text_file(text);

    expect_mesh_of(bis_ply_read, m, &b, "text.ply", warning);
    bytes_clear(&b);
}

static void refuse_text(const char *text, int line, const char *message)
{
    bytes b = text_file(text);

    expect_mesh_refusal_of(bis_ply_read, &b, "bad.ply", line, message);
    bytes_clear(&b);
}

/* The low byte first, or the high one. */
static void put_number(bytes *b, double v, const char *type, bool big)
{
    unsigned char raw[8];
    size_t n = 0;
    if (!strcmp(type, "float")) {
        const float f = (float)v;
        memcpy(raw, &f, n = 4);
    } else if (!strcmp(type, "double")) {
        memcpy(raw, &v, n = 8);
    } else {
        const int64_t i = (int64_t)v;
        n = strstr(type, "char") ? 1 : strstr(type, "short") ? 2 : 4;
        memcpy(raw, &i, n); /* this test runs on machines that keep the low byte first */
    }
    for (size_t i = 0; i < n; i++) put(b, &raw[big ? n - 1 - i : i], 1);
}

/* A binary square as one quad: coordinates times 4 (whole numbers) of type `coordinate`, a scalar in the middle, lists
 * before and behind the indices. */
static bytes binary_square(bool big, const char *coordinate, const char *count, const char *index)
{
    bytes b = {0};
    char header[512];

    snprintf(header, sizeof header,
             "ply\nformat binary_%s_endian 1.0\ncomment by hand\nelement vertex 4\nproperty %s z\nproperty uchar "
             "red\nproperty %s "
             "x\nproperty list ushort double bones\nproperty %s y\nobj_info none\nelement face 1\nproperty list uchar "
             "float "
             "texcoord\nproperty list %s %s vertex_index\nproperty short group\nelement edge 1\nproperty int "
             "a\nend_header\n",
             big ? "big" : "little", coordinate, coordinate, coordinate, count, index);
    put_text(&b, header);
    for (size_t i = 0; i < 4; i++) {
        put_number(&b, 4 * (double)square[i][2], coordinate, big);
        put_number(&b, 200, "uchar", big);
        put_number(&b, 4 * (double)square[i][0], coordinate, big);
        put_number(&b, (double)i, "ushort", big);
        for (size_t k = 0; k < i; k++) put_number(&b, 1e300, "double", big);
        put_number(&b, 4 * (double)square[i][1], coordinate, big);
    }
    put_number(&b, 2, "uchar", big);
    put_number(&b, 0.5, "float", big);
    put_number(&b, 0.5, "float", big);
    put_number(&b, 4, count, big);
    for (int i = 0; i < 4; i++) put_number(&b, i, index, big);
    put_number(&b, -7, "short", big);
    put_number(&b, 1, "int", big);
    return b;
}

static void all_types_orders_and_places_of_properties_read_the_same(void **state)
{
    static const char *const coordinates[] = {"char", "short", "int", "float", "double"};
    static const char *const integers[] = {"char", "uchar", "short", "ushort", "int", "uint"};
    (void)state;
    for (size_t i = 0; i < 2 * 5 * 6 * 6; i++) {
        bytes b = binary_square(i % 2, coordinates[i / 2 % 5], integers[i / 10 % 6], integers[i / 60]);
        bis_mesh m;
        expect_mesh_of(bis_ply_read, &m, &b, "square.ply", NULL);
        assert_int_equal(m.n_vertices, 4);
        assert_int_equal(m.n_triangles, 2);
        for (size_t k = 0; k < 4; k++) {
            assert_true(m.p[k].x == 4 * square[k][0] && m.p[k].y == 4 * square[k][1] && m.p[k].z == 4 * square[k][2]);
        }
        assert_triangle(&m, 0, 0, 1, 2);
        assert_triangle(&m, 1, 0, 2, 3);
        bis_mesh_clear(&m);
        bytes_clear(&b);
    }
}

static void ascii_rows_may_span_lines_and_numbers_be_spelled_in_any_way(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, "ply\nformat ascii 1.0\nelement vertex 3\nproperty float32 x\nproperty float64 y\nproperty int8 z\n"
                    "element face 1\nproperty list uint8 int32 vertex_indices\nend_header\n"
                    " +1.5e0\t.25 -3 \n1\n\n1\r1\n 7. 8e-1 9\r\n3 0 1\n2", NULL);
    assert_int_equal(m.n_triangles, 1);
    assert_true(m.p[0].x == 1.5f && m.p[0].y == 0.25f && m.p[0].z == -3);
    assert_true(m.p[2].x == 7 && m.p[2].y == 0.8f && m.p[2].z == 9);
    bis_mesh_clear(&m);
}

static void what_is_too_much_in_a_line_is_skipped_with_a_warning(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, ASCII SQUARE_HEADER FACES(1) "0 0 0 \n1 0 0 9 9\n1 1 0\t\n0 1 0\n3 1 2 3 0.5 0.5\r\n",
                "2 lines hold more numbers than the header says: the rest of them is skipped");
    assert_true(m.p[2].x == 1 && m.p[2].y == 1);
    assert_triangle(&m, 0, 1, 2, 3);
    bis_mesh_clear(&m);
}

static void faces_may_come_before_their_vertices(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m,
        ASCII "element face 1\nproperty list uchar int vertex_indices\nelement vertex 3\nproperty float x\nproperty "
              "float y\nproperty float z\nend_header\n3 2 1 0\n0 0 0\n1 0 0\n0 1 0\n",
        NULL);
    assert_triangle(&m, 0, 2, 1, 0);
    bis_mesh_clear(&m);
}

static void polygons_become_fans_and_small_ones_are_left_out_and_counted(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, ASCII "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n" FACES(4)
                    "0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n5 0 1 2 3 4\n2 0 1\n0\n3 2 3 4\n",
                "2 faces have fewer than 3 vertices and are left out");
    assert_int_equal(m.n_triangles, 4);
    assert_triangle(&m, 0, 0, 1, 2);
    assert_triangle(&m, 1, 0, 2, 3);
    assert_triangle(&m, 2, 0, 3, 4);
    assert_triangle(&m, 3, 2, 3, 4);
    bis_mesh_clear(&m);
}

static void strips_alternate_their_winding_and_begin_anew_after_minus_1(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m,
        ASCII
        "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 2\nproperty list "
        "int int vertex_indices\nend_header\n0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n8 0 1 2 3 -1 2 3 4\n4 4 3 2 1\n",
        NULL);
    assert_int_equal(m.n_triangles, 5);
    assert_triangle(&m, 0, 0, 1, 2);
    assert_triangle(&m, 1, 2, 1, 3);
    assert_triangle(&m, 2, 2, 3, 4);
    assert_triangle(&m, 3, 4, 3, 2);
    assert_triangle(&m, 4, 2, 3, 1);
    bis_mesh_clear(&m);
}

static void normals_are_read_and_broken_ones_stand_for_the_faces(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m,
        ASCII
        "element vertex 3\nproperty float nx\nproperty float x\nproperty float y\nproperty float z\nproperty float "
        "ny\nproperty float nz\n" FACES(1) "0 1 2 3 0 1\nnan 4 5 6 0 1\n0 7 8 10 1e60 0\n3 0 1 2\n",
        "2 vertex normals are not finite: the faces' normals are used there");
    assert_non_null(m.n);
    assert_true(m.p[1].x == 4 && m.p[1].z == 6);
    assert_true(m.n[0].x == 0 && m.n[0].y == 0 && m.n[0].z == 1);
    for (int i = 1; i < 3; i++) assert_true(m.n[i].x == 0 && m.n[i].y == 0 && m.n[i].z == 0);
    bis_mesh_clear(&m);
}

/* Behind "end_header\r\n" both bytes belong to the line's end; behind "end_header\n" a first byte \n belongs to the
 * body, and behind "end_header\r" it does where all lines end so. */
static void every_line_end_leaves_a_body_that_begins_with_a_newline_alone(void **state)
{
    static const char *const ends[] = {"\n", "\r\n", "\r"};
    (void)state;
    for (int i = 0; i < 3; i++) {
        const char *lines[] = {"ply", "format binary_little_endian 1.0", "comment x", "element vertex 3",
            "property float x", "property float y", "property float z", "element face 1",
            "property list uchar int vertex_indices", "end_header"};
        bytes b = {0};
        bis_mesh m;
        float first;
        for (size_t k = 0; k < 10; k++) {
            put_text(&b, lines[k]);
            put_text(&b, ends[i]);
        }
        memcpy(&first, "\n\r\n?", 4);
        for (int k = 0; k < 9; k++) put_float(&b, k == 0 ? first : (float)k);
        put_int(&b, 3, 1);
        for (uint64_t k = 0; k < 3; k++) put_int(&b, k, 4);
        expect_mesh_of(bis_ply_read, &m, &b, "ends.ply", NULL);
        assert_true(m.p[0].x == first && m.p[2].z == 8);
        bis_mesh_clear(&m);
        bytes_clear(&b);
    }
}

static void an_empty_mesh_is_legal_with_a_warning(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, ASCII "end_header\n", "no triangles: nothing of this mesh will be seen (0 vertices)");
    assert_int_equal(m.n_vertices, 0);
    bis_mesh_clear(&m);
    expect_text(&m, ASCII SQUARE_HEADER "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0",
                "no triangles: nothing of this mesh will be seen (4 vertices)");
    assert_int_equal(m.n_vertices, 4);
    bis_mesh_clear(&m);
}

static void bad_headers_are_refused_by_line(void **state)
{
    (void)state;
    refuse_text("", 0, "the file is empty");
    refuse_text("plyx\n", 0, "not a PLY file: its first line must be \"ply\"");
    refuse_text("\nply\n", 0, "not a PLY file: its first line must be \"ply\"");
    refuse_text("solid cube\n", 0, "not a PLY file: its first line must be \"ply\"");
    refuse_text("ply", 0, "the header has no line \"end_header\": is the file cut off?");
    refuse_text(ASCII "element vertex 3\n", 0, "the header has no line \"end_header\": is the file cut off?");
    refuse_text("ply\nend_header\n", 0, "the header has no line \"format\"");
    refuse_text("ply\nformat binary 1.0\nend_header\n", 2,
                "the format must be ascii, binary_little_endian or binary_big_endian, and the version 1.0");
    refuse_text("ply\nformat ascii 2.0\nend_header\n", 2,
                "the format must be ascii, binary_little_endian or binary_big_endian, and the version 1.0");
    refuse_text(ASCII "elephant vertex 3\n", 3, "unknown word \"elephant\" in the header");
    refuse_text(ASCII "element vertex -3\n", 3, "an element is \"element NAME COUNT\", COUNT a whole number >= 0");
    refuse_text(ASCII "element vertex\n", 3, "an element is \"element NAME COUNT\", COUNT a whole number >= 0");
    refuse_text(ASCII "element vertex 99999999999999999999\n", 3,
        "an element is \"element NAME COUNT\", COUNT a whole number >= 0");
    refuse_text(ASCII "property float x\n", 3, "a property before the first element");
    refuse_text(ASCII "element vertex 1\nproperty float\n", 4,
                "a property is \"property TYPE NAME\" or \"property list COUNT-TYPE TYPE NAME\"");
    refuse_text(ASCII "element vertex 1\nproperty half x\n", 4,
                "\"half\" is no type: char, uchar, short, ushort, int, uint, float, double");
    refuse_text(ASCII "element vertex 1\nproperty list float int x\n", 4,
                "\"float\" is no type of a list's count: char, uchar, short, ushort, int, uint");
}

static void bad_bodies_are_refused_by_line_vertex_or_face(void **state)
{
    (void)state;
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", 12,
                "\"x\" where a number of vertex 2 should stand");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2x\n", 14,
                "\"2x\" where a number of face 0 should stand");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1", 0, "the file ends in face 0 of 1");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 1 inf\n0 1 0\n3 0 1 2", 0,
                "vertex 2 has z = inf, must be a finite float");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 nan 0\n1 1 0\n0 1 0\n3 0 1 2", 0,
                "vertex 1 has y = nan, must be a finite float");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "1e39 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2", 0,
                "vertex 0 has x = 1e+39, must be a finite float");
    refuse_text(ASCII SQUARE_HEADER FACES(2) "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 1 4", 0,
                "face 1 has the index 4, but there are 4 vertices");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 -1 2", 0,
                "face 0 has the index -1, but there are 4 vertices");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1.5 2", 0,
                "face 0 has the index 1.5, but there are 4 vertices");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 1 0\n0 1 0\n-3 0 1 2", 0,
                "face 0: the list \"vertex_indices\" has -3 items");
    refuse_text(
        ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4000000000 0 1 2", 0, "the file ends in face 0 of 1");
    refuse_text(ASCII "element vertex 1\nproperty float x\nproperty float z\nend_header\n1 2\n", 0,
        "a vertex has no property \"y\"");
    refuse_text(ASCII "element vertex 1\nproperty float y\nproperty float z\nend_header\n1 2\n", 0,
        "a vertex has no property \"x\"");
    refuse_text(ASCII "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n", 0,
        "a vertex has no property \"z\"");
    refuse_text(ASCII SQUARE_HEADER SQUARE_HEADER
        "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n",
        0, "the element \"vertex\" occurs twice");
    refuse_text(ASCII "element face 1\nproperty list uchar int corners\nend_header\n3 0 1 2\n", 0,
                "the element \"face\" has no list \"vertex_indices\"");
    refuse_text(ASCII "element strange 1\nproperty list char int x\nend_header\n-1\n", 0,
        "strange 0: the list \"x\" has -1 items");
}

static void counts_are_held_against_the_file_before_memory_is_asked_for(void **state)
{
    (void)state;
    refuse_text(ASCII
        "element vertex 200000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
        0, "200000000 rows of \"vertex\" of at least 6 bytes each, but the file has 6 bytes left");
    refuse_text("ply\nformat binary_big_endian 1.0\nelement vertex 18446744073709551615\nproperty double x\nproperty "
                "float y\nproperty "
                "float z\nend_header\n0123456789abcdef",
        3, "an element is \"element NAME COUNT\", COUNT a whole number >= 0");
    refuse_text("ply\nformat binary_big_endian 1.0\nelement vertex 1844674407370955161\nproperty double x\nproperty "
                "float y\nproperty "
                "float z\nend_header\n0123456789abcdef",
        0, "1844674407370955161 vertices, must be below 2^32 - 1");
    refuse_text("ply\nformat binary_big_endian 1.0\nelement vertex 2\nproperty double x\nproperty float y\nproperty "
                "float z\nend_header\n0123456789abcdef", 0,
                "2 rows of \"vertex\" of at least 16 bytes each, but the file has 16 bytes left");
    refuse_text("ply\nformat binary_big_endian 1.0\nelement face 4000000000\nproperty list uchar int "
                "vertex_index\nend_header\nx",
        0, "4000000000 rows of \"face\" of at least 1 bytes each, but the file has 1 bytes left");
}

static void an_element_without_properties_takes_neither_room_nor_time(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m, ASCII "element nothing 1844674407370955161\nend_header\n",
                "no triangles: nothing of this mesh will be seen (0 vertices)");
    bis_mesh_clear(&m);
}

static void a_short_cut_checks_every_corner(void **state)
{
    (void)state;
    for (uint64_t bad = 0; bad < 6; bad++) {
        bytes b = {0};
        char message[80];
        put_text(&b, "ply\nformat binary_little_endian 1.0\n" SQUARE_HEADER "element face 2\nproperty list uchar uint "
                     "vertex_indices\nend_header\n");
        for (size_t i = 0; i < 12; i++) put_float(&b, square[i / 3][i % 3]);
        for (uint64_t i = 0; i < 6; i++) {
            if (i % 3 == 0) put_int(&b, 3, 1);
            put_int(&b, i == bad ? 4 : i % 3, 4);
        }
        snprintf(message, sizeof message, "face %d has the index 4, but there are 4 vertices", (int)bad / 3);
        expect_mesh_refusal_of(bis_ply_read, &b, "corner.ply", 0, message);
        bytes_clear(&b);
    }
}

/* Faces that are lists and nothing else: rows of three indices of 4 bytes behind a count of one are copied whole, any
 * other type, order of bytes or length is read by itself. A triangle without area, whose zeros look the same at any
 * width, two triangles, a quad, a triangle. */
static void a_short_cut_for_faces_is_for_three_ints_behind_a_byte_alone(void **state)
{
    (void)state;
    static const char *const types[] = {"char", "uchar", "short", "ushort", "int", "uint"};
    static const int faces[5][5] = {{3, 0, 0, 0}, {3, 0, 1, 2}, {3, 0, 2, 3}, {4, 0, 1, 2, 3}, {3, 1, 2, 3}};
    for (int i = 0; i < 6 * 6 * 2; i++) {
        const char *const count = types[i % 6], *const index = types[i / 6 % 6];
        const bool big = i >= 36;
        bytes b = {0};
        bis_mesh m;
        char header[256];
        snprintf(header, sizeof header, "ply\nformat binary_%s_endian 1.0\n" SQUARE_HEADER
                 "element face 5\nproperty list %s %s vertex_indices\nend_header\n", big ? "big" : "little", count,
                 index);
        put_text(&b, header);
        for (size_t k = 0; k < 12; k++) put_number(&b, (double)square[k / 3][k % 3], "float", big);
        for (int f = 0; f < 5; f++) {
            put_number(&b, faces[f][0], count, big);
            for (int k = 1; k <= faces[f][0]; k++) put_number(&b, faces[f][k], index, big);
        }
        expect_mesh_of(bis_ply_read, &m, &b, "faces.ply", NULL);
        assert_true(m.n_vertices == 4 && m.n_triangles == 6);
        assert_triangle(&m, 0, 0, 0, 0);
        assert_triangle(&m, 1, 0, 1, 2);
        assert_triangle(&m, 2, 0, 2, 3);
        assert_triangle(&m, 3, 0, 1, 2);
        assert_triangle(&m, 4, 0, 2, 3);
        assert_triangle(&m, 5, 1, 2, 3);
        bis_mesh_clear(&m);
        bytes_clear(&b);
    }
}

/* Three floats in the order x, y, z are copied whole; any one that is a double, a list beside them or another order is
 * read by itself, in either byte order. */
static void a_short_cut_is_for_three_floats_alone(void **state)
{
    (void)state;
    static const char orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int i = 0; i < 6 * 8 * 2 * 2; i++) {
        const char *const order = orders[i % 6];
        const int doubles = i / 6 % 8;
        const bool big = i / 48 % 2, more = i / 96;
        bytes b = {0};
        bis_mesh m;
        char line[64];
        put_text(&b, "ply\nformat binary_");
        put_text(&b, big ? "big_endian 1.0\nelement vertex 3\n" : "little_endian 1.0\nelement vertex 3\n");
        for (int k = 0; k < 3; k++) {
            snprintf(
                line, sizeof line, "property %s %c\n", doubles >> k & 1 ? "double" : "float", "xyz"[(int)order[k]]);
            put_text(&b, line);
        }
        if (more) put_text(&b, "property list uchar uchar rest\n");
        put_text(&b, FACES(1));
        for (int v = 0; v < 3; v++) {
            for (int k = 0; k < 3; k++)
                put_number(&b, (double)square[v][(int)order[k]], doubles >> k & 1 ? "double" : "float", big);
            if (more) put_number(&b, 0, "uchar", big);
        }
        put_number(&b, 3, "uchar", big);
        for (int v = 0; v < 3; v++) put_number(&b, v, "int", big);
        expect_mesh_of(bis_ply_read, &m, &b, "three.ply", NULL);
        for (int v = 0; v < 3; v++)
            assert_true(m.p[v].x == square[v][0] && m.p[v].y == square[v][1] && m.p[v].z == square[v][2]);
        assert_triangle(&m, 0, 0, 1, 2);
        bis_mesh_clear(&m);
        bytes_clear(&b);
    }
}

static void a_short_cut_meets_what_it_cannot_read_half_way(void **state)
{
    (void)state;
    for (int bad = 0; bad < 4; bad++) {
        bytes b = {0};
        bis_mesh m;
        put_text(&b, "ply\nformat binary_little_endian 1.0\n" SQUARE_HEADER "element face 3\nproperty list uchar uint "
                     "vertex_indices\nend_header\n");
        for (size_t i = 0; i < 12; i++) put_float(&b, bad == 1 && i == 7 ? NAN : square[i / 3][i % 3]);
        for (uint64_t face = 0; face < 3; face++) {
            const uint64_t n = face == 1 ? 4 : 3;
            put_int(&b, n, 1);
            for (uint64_t i = 0; i < n; i++) put_int(&b, bad == 2 && face == 2 && i == 1 ? 4 : i, 4);
        }
        if (bad == 3) b.n--;
        if (bad == 0) {
            expect_mesh_of(bis_ply_read, &m, &b, "cut.ply", NULL);
            assert_int_equal(m.n_triangles, 4);
            assert_triangle(&m, 2, 0, 2, 3);
            assert_triangle(&m, 3, 0, 1, 2);
            bis_mesh_clear(&m);
        }
        if (bad == 1)
            expect_mesh_refusal_of(bis_ply_read, &b, "cut.ply", 0, "vertex 2 has y = nan, must be a finite float");
        if (bad == 2)
            expect_mesh_refusal_of(bis_ply_read, &b, "cut.ply", 0, "face 2 has the index 4, but there are 4 vertices");
        if (bad == 3) expect_mesh_refusal_of(bis_ply_read, &b, "cut.ply", 0, "the file ends in face 2 of 3");
        bytes_clear(&b);
    }
}

static void missing_files_and_folders_are_the_disks_fault(void **state)
{
    bis_diag diag = {0};
    bis_mesh m;
    (void)state;
    assert_int_equal(bis_ply_read(&m, "build/no such file.ply", (bis_loc){"s.txt", 3, 7}, &diag), BIS_IO);
    assert_int_equal(bis_ply_read(&m, "build", (bis_loc){0}, &diag), BIS_IO);
    assert_null(m.p);
    assert_int_equal(diag.n, 2);
    assert_string_equal(
        diag.messages[0].text, "s.txt:3:7: error: cannot open \"build/no such file.ply\": No such file or directory");
    bis_diag_clear(&diag);
}

static void a_message_names_the_scene_line_and_the_meshes(void **state)
{
    const char *path = scratch("named.ply");
    char expected[512];
    bis_diag diag = {0};
    bis_mesh m;
    (void)state;
    store(path, "ply\nformat oops\n", 16);
    assert_int_equal(bis_ply_read(&m, path, (bis_loc){"s.txt", 3, 7}, &diag), BIS_INPUT);
    snprintf(expected, sizeof expected, "s.txt:3:7: error: %s:2: the format must be ascii, binary_little_endian or "
             "binary_big_endian, and the version 1.0", path);
    assert_string_equal(diag.messages[0].text, expected);
    bis_diag_clear(&diag);
}

static void damaged_files_never_crash(void **state)
{
    bytes binary = binary_square(true, "short", "uchar", "ushort");
    bytes text = text_file(ASCII SQUARE_HEADER "property float nx\nproperty float ny\nproperty float nz\n"
                           "element tristrips 1\nproperty list int int vertex_indices\n" FACES(2)
                           "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 1 0 0\n6 0 1 2 -1 3 2\n3 0 1 2\n4 0 1 2 3\n");
    (void)state;
    try_mesh_damage(bis_ply_read, &binary, "damage.ply", 3000, 1);
    try_mesh_damage(bis_ply_read, &text, "damage.ply", 3000, 2);
    bytes_clear(&binary);
    bytes_clear(&text);
}

static void any_allocation_may_fail(void **state)
{
    bytes binary = binary_square(false, "float", "uchar", "int");
    bytes text = text_file(ASCII SQUARE_HEADER "property float nx\nproperty float ny\nproperty float nz\n"
                           "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                           "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 1 0 0\n14 0 1 2 3 0 1 2 3 0 1 2 3 0 1\n");
    (void)state;
    try_mesh_memory(bis_ply_read, &binary, "memory.ply");
    try_mesh_memory(bis_ply_read, &text, "memory.ply");
    bytes_clear(&binary);
    bytes_clear(&text);
}

static void files_of_the_wild_have_the_counts_that_another_reader_finds(void **state)
{
    static const struct {
        const char *name;
        size_t n_vertices, n_triangles;
        bool normals;
    } files[] = {
        {"points_emptyascii", 12, 0, false}, {"triangle_face_colors", 3, 1, true},
        {"dolphins", 855, 1689, false}, {"rectangle_uv", 4, 2, false}, {"dolphins_be", 855, 1689, false},
        {"ply_empty_header", 0, 0, false},
        {"platonic_shelf_ascii", 50, 80, false}, {"quad", 4, 2, false}, {"plane_tri", 4, 2, true},
        {"fuze", 502, 1000, false},
        {"points_bin", 5, 0, false}, {"sofa_ascii", 12103, 24104, false}, {"octagonal_pocket", 1658, 3262, false},
        {"fuze_ascii", 502, 1000, false}, {"Tetraascii", 4, 4, false}, {"cube_binary_starts_with_nl", 8, 12, false},
        {"cube_blender_uv", 24, 12, true}, {"igea_tristrips", 134345, 268686, false}, {"mirror", 143, 286, false},
        {"reference", 845, 1610, false}, {"input", 3, 1, false}, {"fixed_top", 2374, 4772, false},
        {"quad4", 5, 4, false},
        {"plane", 4, 2, true}, {"bunny_normals_uv_rgba", 33528, 65630, true}, {"cube_binary", 8, 12, false},
        {"cube_binary_header_with_RN_newline", 8, 12, false}, {"ply_empty_ascii", 0, 0, false},
        {"sphere", 642, 1280, false},
        {"points_emptyface", 1024, 0, false}, {"dolphins_le", 855, 1689, false}, {"rectangle_normals_uv", 4, 2, true},
        {"float-color", 3, 1, false}, {"multi", 4, 2, false}, {"cube_blender_uv_meshlab", 24, 12, false},
        {"ply_empty_bin", 0, 0, false},
        {"icosahedron_ascii", 12, 20, true}, {"cube_uv", 24, 12, true}, {"points_ascii", 5, 0, false},
    };
    (void)state; /* issue623.ply is in the next test */
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        char name[128];
        snprintf(name, sizeof name, "conformance/ply/%s.ply", files[i].name);
        const char *path = shared_file(name);
        bis_diag diag = {0};
        bis_mesh m;
        if (!path) skip();
        bis_status status = bis_ply_read(&m, path, (bis_loc){0}, &diag);
        if (status) print_message("%s\n", diag.messages[0].text);
        assert_int_equal(status, BIS_OK);
        assert_sound(&m);
        if (m.n_vertices != files[i].n_vertices || m.n_triangles != files[i].n_triangles) {
            print_message("%s: %zu vertices, %zu triangles\n", name, m.n_vertices, m.n_triangles);
        }
        assert_int_equal(m.n_vertices, files[i].n_vertices);
        assert_int_equal(m.n_triangles, files[i].n_triangles);
        assert_int_equal(m.n != NULL, files[i].normals);
        /* fuze_ascii.ply has ten numbers where its header speaks of four. */
        assert_int_equal(diag.n, files[i].n_triangles == 0 || !strcmp(files[i].name, "fuze_ascii") ? 1 : 0);
        bis_mesh_clear(&m);
        bis_diag_clear(&diag);
    }
}

/* Its header gives each vertex a list that the rows do not have: the line "element face" is missing. */
static void the_one_contradictory_file_of_the_wild_is_refused(void **state)
{
    const char *path = shared_file("conformance/ply/issue623.ply");
    bis_diag diag = {0};
    bis_mesh m;
    (void)state;
    if (!path) skip();
    assert_int_equal(bis_ply_read(&m, path, (bis_loc){0}, &diag), BIS_INPUT);
    assert_non_null(
        strstr(diag.messages[0].text, "issue623.ply: error: vertex 0: the list \"vertex_indices\" has 7.9418 items"));
    bis_diag_clear(&diag);
}

/* Three files of one mesh. */
static void dolphins_are_the_same_in_ascii_and_both_byte_orders(void **state)
{
    bis_mesh m[3];
    (void)state;
    for (int i = 0; i < 3; i++) {
        static const char *const names[] = {"dolphins", "dolphins_le", "dolphins_be"};
        char name[128];
        snprintf(name, sizeof name, "conformance/ply/%s.ply", names[i]);
        const char *path = shared_file(name);
        if (!path) skip();
        assert_int_equal(bis_ply_read(&m[i], path, (bis_loc){0}, NULL), BIS_OK);
    }
    for (int i = 1; i < 3; i++) {
        assert_memory_equal(m[0].index, m[i].index, 3 * m[0].n_triangles * sizeof *m[0].index);
        assert_memory_equal(m[0].p, m[i].p, m[0].n_vertices * sizeof *m[0].p);
    }
    for (int i = 0; i < 3; i++) bis_mesh_clear(&m[i]);
}

#define UV(u, v) ASCII "element vertex 3\nproperty float x\nproperty float " u "\nproperty float y\nproperty float " v \
    "\nproperty float z\n"

/* Any of pbrt's pairs of names; of two pairs the first in the list, wherever it stands; none without the reader for
 * them. */
static void texture_coordinates_have_four_pairs_of_names(void **state)
{
    static const char body[] = FACES(1) "0 0.25 0 0.5 0\n1 1 0 nan 0\n0 -2 1 1e39 9\n3 0 1 2\n";
    static const char *const headers[] = {
        UV("u", "v"), UV("s", "t"), UV("texture_u", "texture_v"), UV("texture_s", "texture_t")};
    (void)state;
    for (int i = 0; i < 4; i++) {
        bytes b = {0};
        bis_mesh m;
        put_text(&b, headers[i]);
        put_text(&b, body);
        expect_mesh_of(bis_ply_read_uv, &m, &b, "uv.ply",
                       "2 texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)");
        assert_true(m.uv[0].u == 0.25f && m.uv[0].v == 0.5f && isnan(m.uv[1].u) && isnan(m.uv[2].u));
        assert_true(m.p[1].x == 1 && m.p[2].y == 1 && m.p[2].z == 9);
        bis_mesh_clear(&m);
        expect_mesh_of(bis_ply_read, &m, &b, "uv.ply", NULL);
        assert_null(m.uv);
        assert_true(m.p[1].x == 1 && m.p[2].y == 1 && m.p[2].z == 9);
        bis_mesh_clear(&m);
        bytes_clear(&b);
    }
    bytes b = {0};
    bis_mesh m;
    put_text(&b, UV("s", "t") "property float v\nproperty float u\n" FACES(1) "0 3 0 4 0 2 1\n0 3 1 4 0 2 1\n1 3 0 4 0 "
                                                                              "2 1\n3 0 1 2\n");
    expect_mesh_of(bis_ply_read_uv, &m, &b, "uv.ply", NULL);
    assert_true(m.uv[2].u == 1 && m.uv[2].v == 2);
    bis_mesh_clear(&m);
    bytes_clear(&b);
    static const char *const halves[] = {UV("u", "w"), UV("w", "v")};
    for (int i = 0; i < 2; i++) {
        put_text(&b, halves[i]);
        put_text(&b, FACES(1) "0 3 0 4 0\n0 3 1 4 0\n1 3 0 4 0\n3 0 1 2\n");
        expect_mesh_of(bis_ply_read_uv, &m, &b, "uv.ply", NULL);
        assert_null(m.uv); /* one of the two is missing */
        bis_mesh_clear(&m);
        bytes_clear(&b);
    }
}

/* The last property of a name counts; two of the three of a normal make none. */
static void a_name_that_occurs_twice_counts_as_its_last(void **state)
{
    bis_mesh m;
    (void)state;
    expect_text(&m,
        ASCII
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float x\nproperty float nx\n"
        "property float ny\n" FACES(1) "9 0 0 1 1 0\n9 1 0 2 1 0\n9 0 1 3 1 0\n3 0 1 2\n",
        NULL);
    for (int i = 0; i < 3; i++) assert_true(m.p[i].x == (float)(i + 1) && m.p[i].y == (float)(i == 1));
    assert_null(m.n);
    bis_mesh_clear(&m);
}

/* 32 characters of a long word; a binary file that ends within a vertex or a list; the most vertices that a header may
 * claim, which the file's length then refuses. */
static void messages_tell_where_a_file_ends_and_no_more_than_32_characters(void **state)
{
    (void)state;
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 abcdefghijklmnopqrstuvwxyz0123456789 0\n1 1 0\n0 1 0\n3 0 1 2\n",
        11, "\"abcdefghijklmnopqrstuvwxyz012345\" where a number of vertex 1 should stand");
    refuse_text(ASCII SQUARE_HEADER FACES(1) "0 0 0\n1 0 0\n1 1", 0,
                "4 rows of \"vertex\" of at least 6 bytes each, but the file has 15 bytes left");
    refuse_text(ASCII
        "element vertex 4294967294\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0",
        0, "4294967294 rows of \"vertex\" of at least 6 bytes each, but the file has 5 bytes left");
    refuse_text(ASCII
        "element vertex 4294967295\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0",
        0, "4294967295 vertices, must be below 2^32 - 1");
    for (int strips = 0; strips < 2; strips++)
        for (size_t lost = 1; lost < 30; lost++) {
            bytes b = {0};
            char message[80];
            put_text(&b, "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty double "
                         "y\nproperty int z\n");
            put_text(&b, strips ? "element tristrips 2\nproperty list ushort int vertex_indices\nend_header\n"
                                : "element face 2\nproperty list ushort int vertex_indices\nend_header\n");
            for (int i = 0; i < 3; i++) {
                put_number(&b, i, "short", true);
                put_number(&b, i * i, "double", true);
                put_number(&b, 1, "int", true);
            }
            for (int i = 0; i < 8; i++) {
                if (i % 4 == 0) put_number(&b, 4, "ushort", true);
                put_number(&b, i % 4 % 3, "int", true);
            }
            b.n -= lost; /* a list has 18 bytes; its count alone is 2, and the file must have room for that */
            snprintf(message, sizeof message, "the file ends in %s %d of 2", strips ? "tristrips" : "face",
                lost <= 18 ? 1 : 0);
            expect_mesh_refusal_of(bis_ply_read, &b, "ends.ply", 0, message);
            bytes_clear(&b);
        }
}

/* A list is no coordinate, also where all else is as in the short cut; a name that is a coordinate's and a list's is
 * the coordinate's. */
static void a_list_is_no_coordinate(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        for (int twice = 0; twice < 2; twice++) {
            bytes b = {0};
            bis_mesh m;
            char text[64];
            put_text(&b, "ply\nformat binary_little_endian 1.0\nelement vertex 3\n");
            for (int i = 0; i < 3; i++) {
                snprintf(text, sizeof text, "property %s %c\n", i == k ? "list uchar float" : "float", "xyz"[i]);
                put_text(&b, text);
            }
            snprintf(text, sizeof text, "property float %c\n", "xyz"[k]);
            if (twice) put_text(&b, text);
            put_text(&b, FACES(1));
            for (int v = 0; v < 3; v++) {
                for (int i = 0; i < 3; i++) {
                    if (i == k) put_int(&b, 1, 1);
                    put_float(&b, i == k ? 99 : square[v][i]);
                }
                if (twice) put_float(&b, square[v][k]);
            }
            put_int(&b, 3, 1);
            for (uint64_t v = 0; v < 3; v++) put_int(&b, v, 4);
            snprintf(text, sizeof text, "a vertex has no property \"%c\"", "xyz"[k]);
            if (twice) {
                expect_mesh_of(bis_ply_read, &m, &b, "list.ply", NULL);
                for (int v = 0; v < 3; v++)
                    assert_true(m.p[v].x == square[v][0] && m.p[v].y == square[v][1] && m.p[v].z == square[v][2]);
                bis_mesh_clear(&m);
            } else {
                expect_mesh_refusal_of(bis_ply_read, &b, "list.ply", 0, text);
            }
            bytes_clear(&b);
        }
    }
}

/* Where every line is counted: a word that is no number stands where it stands for all three ends of lines, which are
 * one each. */
static void lines_are_counted_by_any_end(void **state)
{
    (void)state;
    static const char *const ends[] = {"\n", "\r\n", "\r"};
    for (int e = 0; e < 3; e++) {
        static const char text[] = "ply\nformat ascii 1.0\ncomment a b c d e f g\n" SQUARE_HEADER FACES(
            1) "0 0 0\n1 0 0\n\n1 1 0\n0 x 0\n3 0 1 2\n";
        bytes b = {0};
        int line = 1;
        for (const char *c = text; *c; c++) {
            if (*c == '\n') put_text(&b, ends[e]);
            else put(&b, c, 1);
        }
        for (const char *c = text; c < strstr(text, "x 0\n3"); c++) line += *c == '\n';
        expect_mesh_refusal_of(bis_ply_read, &b, "lines.ply", line, "\"x\" where a number of vertex 3 should stand");
        bytes_clear(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_types_orders_and_places_of_properties_read_the_same),
        cmocka_unit_test(ascii_rows_may_span_lines_and_numbers_be_spelled_in_any_way),
        cmocka_unit_test(what_is_too_much_in_a_line_is_skipped_with_a_warning),
        cmocka_unit_test(faces_may_come_before_their_vertices),
        cmocka_unit_test(polygons_become_fans_and_small_ones_are_left_out_and_counted),
        cmocka_unit_test(strips_alternate_their_winding_and_begin_anew_after_minus_1),
        cmocka_unit_test(normals_are_read_and_broken_ones_stand_for_the_faces),
        cmocka_unit_test(every_line_end_leaves_a_body_that_begins_with_a_newline_alone),
        cmocka_unit_test(an_empty_mesh_is_legal_with_a_warning),
        cmocka_unit_test(bad_headers_are_refused_by_line),
        cmocka_unit_test(bad_bodies_are_refused_by_line_vertex_or_face),
        cmocka_unit_test(counts_are_held_against_the_file_before_memory_is_asked_for),
        cmocka_unit_test(an_element_without_properties_takes_neither_room_nor_time),
        cmocka_unit_test(a_short_cut_checks_every_corner),
        cmocka_unit_test(a_short_cut_for_faces_is_for_three_ints_behind_a_byte_alone),
        cmocka_unit_test(a_short_cut_is_for_three_floats_alone),
        cmocka_unit_test(a_short_cut_meets_what_it_cannot_read_half_way),
        cmocka_unit_test(a_list_is_no_coordinate),
        cmocka_unit_test(lines_are_counted_by_any_end),
        cmocka_unit_test(missing_files_and_folders_are_the_disks_fault),
        cmocka_unit_test(a_message_names_the_scene_line_and_the_meshes),
        cmocka_unit_test(damaged_files_never_crash),
        cmocka_unit_test(any_allocation_may_fail),
        cmocka_unit_test(files_of_the_wild_have_the_counts_that_another_reader_finds),
        cmocka_unit_test(the_one_contradictory_file_of_the_wild_is_refused),
        cmocka_unit_test(dolphins_are_the_same_in_ascii_and_both_byte_orders),
        cmocka_unit_test(texture_coordinates_have_four_pairs_of_names),
        cmocka_unit_test(a_name_that_occurs_twice_counts_as_its_last),
        cmocka_unit_test(messages_tell_where_a_file_ends_and_no_more_than_32_characters),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
