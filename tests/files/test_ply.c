/* SPDX-License-Identifier: BSD-2-Clause */
/* ply: texts beside the mesh that each is, also as binary files; every type, order and element; bad files with their
 * messages. */
#include "claim.h"
#include "mesh_help.h"
#include "files/ply.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ASCII "ply\nformat ascii 1.0\n"
#define VERTICES(n) "element vertex " #n "\nproperty float x\nproperty float y\nproperty float z\n"
#define FACES(n) "element face " #n "\nproperty list uchar int vertex_indices\nend_header\n"
#define CORNERS "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
#define UV(u, v) "element vertex 3\nproperty float x\nproperty float " u "\nproperty float y\nproperty float " v \
    "\nproperty float z\n"
#define UV_BODY "0 0.25 0 0.5 0\n1 1 0 nan 0\n0 -2 1 1e39 9\n3 0 1 2\n"
#define MOST "3.4028234663852886e38" /* the largest float */
#define BIG "3.402823e+38"

/* The text of a file without its first line and its format: an ascii file. */
static bytes ascii_of(const char *text)
{
    bytes b = {0};
    put_text(&b, ASCII);
    put_text(&b, text);
    return b;
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

/* The same text as a binary file: each number of the body is of its property's type; a list has its count before. */
static bytes binary_of(const char *text, bool big)
{
    const char *const end = strstr(text, "end_header\n") + strlen("end_header\n");
    char *body = strdup(end), *at = body;
    bytes b = {0};
    put_text(&b, big ? "ply\nformat binary_big_endian 1.0\n" : "ply\nformat binary_little_endian 1.0\n");
    put(&b, text, (size_t)(end - text));
    for (const char *element = strstr(text, "element"), *next; element && element < end; element = next) {
        long n_rows = 0;
        sscanf(element, "element %*s %ld", &n_rows);
        next = strstr(element + 1, "element ");
        for (; n_rows > 0; n_rows--)
            for (const char *line = element; line < (next ? next : end); line = strchr(line, '\n') + 1) {
                char type[16], items[16];
                if (sscanf(line, "property %15s %15s", type, items) != 2) continue;
                long n = 1;
                if (strcmp(type, "list") == 0) {
                    n = strtol(at, &at, 10);
                    put_number(&b, (double)n, items, big);
                    sscanf(line, "property list %*s %15s", type);
                }
                for (; n > 0; n--) put_number(&b, strtod(at, &at), type, big);
            }
    }
    free(body);
    return b;
}

static const struct {
    enum { ANY, ALONE, WITH_UV } kind; /* ALONE: no binary file says this; WITH_UV: read by bis_ply_read_uv */
    const char *claim, *text, *warning, *mesh;
} texts[] = {
    {ALONE, "rows may span lines, and numbers be spelled in any way",
     "element vertex 3\nproperty float32 x\nproperty float64 y\nproperty int8 z\n"
     "element face 1\nproperty list uint8 int32 vertex_indices\nend_header\n"
     " +1.5e0\t.25 -3 \n1\n\n1\r1\n 7. 8e-1 9\r\n3 0 1\n2",
     NULL, "1.5 0.25 -3, 1 1 1, 7 0.8 9; 0 1 2"},
    {ALONE, "blanks and tabs part words of the header and numbers",
     "\telement  vertex\t3 \nproperty int16 \tx\nproperty uint16 y\nproperty  uint32 z\n" FACES(1)
     "-1\t2\v3\n\f4 5\t\t6\t\n7 8 9\n3 0\t1\t2\t", NULL, "-1 2 3, 4 5 6, 7 8 9; 0 1 2"},
    {ALONE, "what is too much in a line is skipped", VERTICES(4) FACES(1)
     "0 0 0 \n1 0 0 9 9\n1 1 0\t\n0 1 0\n3 1 2 3 0.5 0.5\r\n",
     "2 lines hold more numbers than the header says: the rest of them is skipped",
     "0 0 0, 1 0 0, 1 1 0, 0 1 0; 1 2 3"},
    {ANY, "faces may come before their vertices",
     "element face 1\nproperty list uchar int vertex_indices\n" VERTICES(3)
     "end_header\n3 2 1 0\n0 0 0\n1 0 0\n0 1 0\n",
     NULL, "0 0 0, 1 0 0, 0 1 0; 2 1 0"},
    {ANY, "polygons become fans, and small ones are left out and counted",
     VERTICES(5) FACES(4) "0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n5 0 1 2 3 4\n2 0 1\n0\n3 2 3 4\n",
     "2 faces have fewer than 3 vertices and are left out",
     "0 0 0, 1 0 0, 2 1 0, 1 2 0, 0 1 0; 0 1 2, 0 2 3, 0 3 4, 2 3 4"},
    {ANY, "strips alternate their winding and begin anew after -1",
     VERTICES(5) "element tristrips 2\nproperty list int int vertex_indices\nend_header\n"
     "0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n8 0 1 2 3 -1 2 3 4\n4 4 3 2 1\n",
     NULL, "0 0 0, 1 0 0, 2 1 0, 1 2 0, 0 1 0; 0 1 2, 2 1 3, 2 3 4, 4 3 2, 2 3 1"},
    {ANY, "broken normals stand for the faces'",
     "element vertex 3\nproperty float nx\nproperty float x\nproperty float y\nproperty float z\nproperty float ny\n"
     "property float nz\n" FACES(1) "0 1 2 3 0 1\nnan 4 5 6 0 1\n0 7 8 10 1e60 0\n3 0 1 2\n",
     "2 vertex normals are not finite: the faces' normals are used there",
     "1 2 3 n 0 0 1, 4 5 6 n 0 0 0, 7 8 10 n 0 0 0; 0 1 2"},
#define ONE_OF(a, b, face, z, warning, mesh) {WITH_UV, "one is counted, too", VERTICES(3) \
    "property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n" FACES(2) \
    "0 0 0 0 0 1 2 3\n1 0 0 0 0 " a " 2 " b "\n1 1 0 0 0 1 2 3\n3 0 1 2\n" face "\n", "1 " warning, \
    "0 0 0 n 0 0 1 t 2 3, 1 0 0 n 0 0 " z ", 1 1 0 n 0 0 1 t 2 3; 0 1 2" mesh}
    ONE_OF("nan", "3", "3 0 1 2", "0 t 2 3", "vertex normals are not finite: the faces' normals are used there",
           ", 0 1 2"),
    ONE_OF("1", "inf", "3 0 1 2", "1 t none",
           "texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)", ", 0 1 2"),
    ONE_OF("1", "3", "1 0", "1 t 2 3", "faces have fewer than 3 vertices and are left out", ""),
    {ALONE, "one long line is counted, too", VERTICES(3) FACES(1) "0 0 0\n1 0 0 7\n1 1 0\n3 0 1 2\n",
     "1 lines hold more numbers than the header says: the rest of them is skipped", "0 0 0, 1 0 0, 1 1 0; 0 1 2"},
    {ANY, "a short cut meets a quad half way",
     VERTICES(4) "element face 3\nproperty list uchar uint vertex_indices\nend_header\n" CORNERS
     "3 0 1 2\n4 0 1 2 3\n3 0 1 2\n", NULL, "0 0 0, 1 0 0, 1 1 0, 0 1 0; 0 1 2, 0 1 2, 0 2 3, 0 1 2"},
    {WITH_UV, "coordinates of corners make two of a vertex that has two",
     VERTICES(4) "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
     "end_header\n" CORNERS "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 0.5 0.5 0 1\n", NULL,
     "0 0 0 t 0 0, 1 0 0 t 1 0, 1 1 0 t 1 1, 0 1 0 t 0 1, 1 1 0 t 0.5 0.5; 0 1 2, 0 4 3"},
    {ANY, "an empty mesh is legal", "end_header\n",
     "no triangles: nothing of this mesh will be seen (0 vertices)", "; "},
    {ANY, "a mesh without faces is legal", VERTICES(4) "end_header\n" CORNERS,
     "no triangles: nothing of this mesh will be seen (4 vertices)", "0 0 0, 1 0 0, 1 1 0, 0 1 0; "},
    {ALONE, "an element without properties takes neither room nor time",
     "element nothing 1844674407370955161\nend_header\n",
     "no triangles: nothing of this mesh will be seen (0 vertices)", "; "},
    {ANY, "what is no vertex and no face is skipped, and faces may come twice, and behind strips",
     "element first 2\nproperty list uchar short a\nproperty double b\n" VERTICES(4) "property list uchar short c\n"
     "element tristrips 1\nproperty list int int vertex_indices\n"
     "element face 1\nproperty list uchar int vertex_indices\n" FACES(2)
     "2 7 8 0.5\n0 0.5\n0 0 0 0\n1 0 0 1 5\n1 1 0 2 5 6\n0 1 0 0\n3 0 1 2\n4 0 1 2 3\n3 1 2 3\n3 2 3 0\n", NULL,
     "0 0 0, 1 0 0, 1 1 0, 0 1 0; 0 1 2, 0 1 2, 0 2 3, 1 2 3, 2 3 0"},
    {ANY, "an element of no rows says nothing", "element vertex 0\nelement face 0\nend_header\n",
     "no triangles: nothing of this mesh will be seen (0 vertices)", "; "},
    {ANY, "the largest float is a coordinate of a vertex and of a normal",
     "element vertex 3\nproperty double x\nproperty double y\nproperty double z\nproperty double nx\n"
     "property double ny\nproperty double nz\n" FACES(1) MOST " -" MOST " " MOST " -" MOST " " MOST " -" MOST
     "\n1 0 0 0 0 1\n1 1 0 0 0 1\n3 0 1 2\n", NULL,
     BIG " -" BIG " " BIG " n -" BIG " " BIG " -" BIG ", 1 0 0 n 0 0 1, 1 1 0 n 0 0 1; 0 1 2"},
#define TWO_OF_A_NORMAL(a, b) {ANY, "two of the three of a normal make none", VERTICES(3) "property float " a \
    "\nproperty float " b "\n" FACES(1) "0 0 0 1 1\n1 0 0 1 1\n1 1 0 1 1\n3 0 1 2\n", NULL, \
    "0 0 0, 1 0 0, 1 1 0; 0 1 2"}
    TWO_OF_A_NORMAL("nx", "nz"), TWO_OF_A_NORMAL("ny", "nz"),
    {ANY, "the last property of a name counts, and two of the three of a normal make none",
     VERTICES(3) "property float x\nproperty float nx\nproperty float ny\n" FACES(1)
     "9 0 0 1 1 0\n9 1 0 2 1 0\n9 0 1 3 1 0\n3 0 1 2\n", NULL, "1 0 0, 2 1 0, 3 0 1; 0 1 2"},
#define NAMES(kind, u, v, warning, mesh) \
    {kind, "texture coordinates have four pairs of names", UV(u, v) FACES(1) UV_BODY, warning, mesh}
#define PAIR(u, v) NAMES(WITH_UV, u, v, \
    "2 texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)", \
    "0 0 0 t 0.25 0.5, 1 0 0 t none, 0 1 9 t none; 0 1 2")
    PAIR("u", "v"), PAIR("s", "t"), PAIR("texture_u", "texture_v"), PAIR("texture_s", "texture_t"),
    NAMES(ANY, "u", "v", NULL, "0 0 0, 1 0 0, 0 1 9; 0 1 2"), /* none without the reader for them */
    NAMES(WITH_UV, "u", "w", NULL, "0 0 0, 1 0 0, 0 1 9; 0 1 2"),
    NAMES(WITH_UV, "w", "v", NULL, "0 0 0, 1 0 0, 0 1 9; 0 1 2"),
    {WITH_UV, "of two pairs of names the first in the list counts, wherever it stands",
     UV("s", "t") "property float v\nproperty float u\n" FACES(1)
     "0 3 0 4 0 2 1\n0 3 1 4 0 2 1\n1 3 0 4 0 2 1\n3 0 1 2\n", NULL,
     "0 0 0 t 1 2, 0 1 0 t 1 2, 1 0 0 t 1 2; 0 1 2"},
    {WITH_UV, "the largest float is a texture coordinate",
     VERTICES(3) "property double u\nproperty double v\n" FACES(1) "0 0 0 " MOST " -" MOST "\n1 0 0 -" MOST " " MOST
     "\n1 1 0 inf 0\n3 0 1 2\n", "1 texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)",
     "0 0 0 t " BIG " -" BIG ", 1 0 0 t -" BIG " " BIG ", 1 1 0 t none; 0 1 2"},
};

static void each_text_is_its_mesh_in_ascii_and_both_byte_orders(void **state)
{
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        for (int format = 0; format < (texts[i].kind == ALONE ? 1 : 3); format++) {
            bytes b = format ? binary_of(texts[i].text, format == 2) : ascii_of(texts[i].text);
            mesh_reader *const read = texts[i].kind == WITH_UV ? bis_ply_read_uv : bis_ply_read;
            expect_mesh_words(read, &b, "text.ply", texts[i].warning, texts[i].claim, texts[i].mesh);
            bytes_clear(&b);
        }
}

/* A square as one quad, coordinates of type `coordinate`, a scalar in the middle, lists before and behind the
 * indices. */
static const char *typed_square(const char *coordinate, const char *count, const char *index)
{
    static char text[1024];
    snprintf(text, sizeof text, "comment by hand\nelement vertex 4\nproperty %s z\nproperty uchar red\nproperty %s x\n"
             "property list ushort double bones\nproperty %s y\nobj_info none\nelement face 1\n"
             "property list uchar float texcoord\nproperty list %s %s vertex_index\nproperty short group\n"
             "element edge 1\nproperty int a\nend_header\n0 200 0 0 0\n2 200 4 1 1e300 0\n0 200 4 2 1e300 1e300 4\n"
             "-1 200 0 3 1e300 1e300 1e300 4\n2 0.5 0.5 4 0 1 2 3 -7\n1\n", coordinate, coordinate, coordinate, count,
             index);
    return text;
}

static void all_types_orders_and_places_of_properties_read_the_same(void **state)
{
    static const char *const coordinates[] = {"char", "short", "int", "float", "double"};
    static const char *const integers[] = {"char", "uchar", "short", "ushort", "int", "uint"};
    for (size_t i = 0; i < 2 * 5 * 6 * 6; i++) {
        const char *const text = typed_square(coordinates[i / 2 % 5], integers[i / 10 % 6], integers[i / 60]);
        bytes b = binary_of(text, i % 2);
        expect_mesh_words(bis_ply_read, &b, "square.ply", NULL, text, "0 0 0, 4 0 2, 4 4 0, 0 4 -1; 0 1 2, 0 2 3");
        bytes_clear(&b);
    }
}

/* The text's first n bytes with other ends of lines, and what follows them. */
static bytes with_ends(const char *text, size_t n, const char *end, const bytes *rest)
{
    bytes b = {0};
    for (; n > 0; n--, text++) put(&b, *text == '\n' ? end : text, *text == '\n' ? strlen(end) : 1);
    if (rest) put(&b, rest->data, rest->n);
    return b;
}

static const char *const ends[] = {"\n", "\r\n", "\r"};

/* Behind "end_header\r\n" both bytes belong to the line's end; behind "end_header\n" a first byte \n belongs to the
 * body, and behind "end_header\r" it does where all lines end so. */
static void every_line_end_leaves_a_body_that_begins_with_a_newline_alone(void **state)
{
    static const char header[] = "ply\nformat binary_little_endian 1.0\ncomment x\n" VERTICES(3) FACES(1);
    bytes body = {0};
    put_text(&body, "\n\r\n?"); /* as a float: 0.5392615 */
    for (int k = 1; k < 9; k++) put_float(&body, (float)k);
    put_int(&body, 3, 1);
    for (uint64_t k = 0; k < 3; k++) put_int(&body, k, 4);
    for (int i = 0; i < 3; i++) {
        bytes b = with_ends(header, sizeof header - 1, ends[i], &body);
        expect_mesh_words(bis_ply_read, &b, "ends.ply", NULL, "ends of lines", "0.5392615 1 2, 3 4 5, 6 7 8; 0 1 2");
        bytes_clear(&b);
    }
    bytes_clear(&body);
}

/* Where every line is counted: a word that is no number stands where it stands for all three ends of lines, which are
 * one each. */
static void lines_are_counted_by_any_end(void **state)
{
    static const char text[] = ASCII "comment a b c d e f g\n" VERTICES(4) FACES(1) "0 0 0\n1 0 0\n\n1 1 0\n0 x 0\n";
    for (int i = 0; i < 3; i++) {
        bytes b = with_ends(text, sizeof text - 1, ends[i], NULL);
        expect_mesh_refusal_of(bis_ply_read, &b, "lines.ply", 15, "\"x\" where a number of vertex 3 should stand");
        bytes_clear(&b);
    }
}

/* ---- bad files ---- */

#define NO_END "the header has no line \"end_header\": is the file cut off?"
#define NO_FORMAT "the format must be ascii, binary_little_endian or binary_big_endian, and the version 1.0"
#define NO_ELEMENT "an element is \"element NAME COUNT\", COUNT a whole number >= 0"
#define NO_PLY "not a PLY file: its first line must be \"ply\""
#define SQUARE ASCII VERTICES(4)
#define ONE SQUARE FACES(1)
#define LARGE(n) "ply\nformat binary_big_endian 1.0\nelement vertex " n "\nproperty double x\nproperty float y\n" \
    "property float z\nend_header\n0123456789abcdef"

#define LETTERS "abcdefghijklmnopqrstuvwxyz"

/* 32 characters of a long word are told. An element's count is held against the file before memory is asked for. */
static const struct {
    const char *text;
    int line;
    const char *message;
} bad[] = {
    {"", 0, "the file is empty"},
    {"plyx\n", 0, NO_PLY},
    {"ply", 0, NO_END},
    {ASCII "element vertex 3\n", 0, NO_END},
    {"ply\nend_header\n", 0, "the header has no line \"format\""},
    {"ply\nformat binary 1.0\nend_header\n", 2, NO_FORMAT},
    {"ply\nformat ascii 2.0\nend_header\n", 2, NO_FORMAT},
    {ASCII "elephant vertex 3\n", 3, "unknown word \"elephant\" in the header"},
    {ASCII "element vertex -3\n", 3, NO_ELEMENT},
    {ASCII LETTERS LETTERS LETTERS " 3\n", 3,
     "unknown word \"" LETTERS LETTERS "abcdefghijkl\" in the header"}, /* 64 are told */
    {ASCII "element vertex 99999999999999999999\n", 3, NO_ELEMENT},
    {LARGE("18446744073709551615"), 3, NO_ELEMENT},
    {ASCII "property float x\n", 3, "a property before the first element"},
    {ASCII "element vertex 1\nproperty float\n", 4,
     "a property is \"property TYPE NAME\" or \"property list COUNT-TYPE TYPE NAME\""},
    {ASCII "element vertex 1\nproperty half x\n", 4,
     "\"half\" is no type: char, uchar, short, ushort, int, uint, float, double"},
    {ASCII "element vertex 1\nproperty list float int x\n", 4,
     "\"float\" is no type of a list's count: char, uchar, short, ushort, int, uint"},
    {ASCII "element vertex 1\nproperty list int int\n", 4,
     "a property is \"property TYPE NAME\" or \"property list COUNT-TYPE TYPE NAME\""},

    {ONE "0 0 0\n1 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", 12, "\"x\" where a number of vertex 2 should stand"},
    {ONE CORNERS "3 0 1 2x\n", 14, "\"2x\" where a number of face 0 should stand"},
    {ONE CORNERS "3 0 1", 0, "the file ends in face 0 of 1"},
    {ONE "0 0 0\n1 0 0\n1 1 inf\n0 1 0\n3 0 1 2", 0, "vertex 2 has z = inf, must be a finite float"},
    {ONE "1e39 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2", 0, "vertex 0 has x = 1e+39, must be a finite float"},
    {SQUARE FACES(2) CORNERS "3 0 1 2\n3 0 1 4", 0, "face 1 has the index 4, but there are 4 vertices"},
    {ONE CORNERS "3 0 -1 2", 0, "face 0 has the index -1, but there are 4 vertices"},
    {ONE CORNERS "-3 0 1 2", 0, "face 0: the list \"vertex_indices\" has -3 items"},
    {ONE CORNERS "4294967295 0 1 2", 0, "the file ends in face 0 of 1"},
    {ONE CORNERS "4294967296 0 1 2", 0, "face 0: the list \"vertex_indices\" has 4.29497e+09 items"},
    {ASCII "element vertex 1\nproperty float x\nproperty float z\nend_header\n1 2\n", 0,
     "a vertex has no property \"y\""},
    {SQUARE VERTICES(4) "end_header\n" CORNERS CORNERS, 0, "the element \"vertex\" occurs twice"},
    {ASCII "element face 1\nproperty list uchar int corners\nend_header\n3 0 1 2\n", 0,
     "the element \"face\" has no list \"vertex_indices\""},
    {ASCII "element strange 1\nproperty list char int x\nend_header\n-1\n", 0,
     "strange 0: the list \"x\" has -1 items"},

    {ASCII VERTICES(200000000) "end_header\n0 0 0\n", 0,
     "200000000 rows of \"vertex\" of at least 6 bytes each, but the file has 6 bytes left"},
    {ONE "0 0 0\n1 0 0\n1 1", 0, "4 rows of \"vertex\" of at least 6 bytes each, but the file has 15 bytes left"},
    {ASCII VERTICES(4294967295) "end_header\n0 0 0", 0, "4294967295 vertices, must be below 2^32 - 1"},
    {LARGE("1844674407370955161"), 0, "1844674407370955161 vertices, must be below 2^32 - 1"},
    {LARGE("2"), 0, "2 rows of \"vertex\" of at least 16 bytes each, but the file has 16 bytes left"},
    {"ply\nformat binary_big_endian 1.0\nelement face 4000000000\nproperty list uchar int vertex_index\nend_header\nx",
     0, "4000000000 rows of \"face\" of at least 1 bytes each, but the file has 1 bytes left"},
};

static void a_bad_file_is_refused_by_line_vertex_or_face(void **state)
{
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        bytes b = {0};
        put_text(&b, bad[i].text);
        expect_mesh_refusal_of(bis_ply_read, &b, "bad.ply", bad[i].line, bad[i].message);
        bytes_clear(&b);
    }
}

#define TWO VERTICES(4) "element face 2\nproperty list uchar uint vertex_indices\nend_header\n" CORNERS
#define THREE(p) VERTICES(4) "element face 3\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n" p \
    "\n0 1 0\n"
#define NO_CORNER(face) "face " face " has the index 4, but there are 4 vertices"

/* Of binary files: each corner that a short cut takes is checked, and so is what it cannot take. */
static void a_short_cut_refuses_what_the_long_way_refuses(void **state)
{
    static const struct {
        const char *text, *message;
        size_t lost; /* bytes of the end */
    } cut[] = {{TWO "3 4 1 2\n3 0 1 2", NO_CORNER("0"), 0}, {TWO "3 0 4 2\n3 0 1 2", NO_CORNER("0"), 0},
               {TWO "3 0 1 4\n3 0 1 2", NO_CORNER("0"), 0}, {TWO "3 0 1 2\n3 4 1 2", NO_CORNER("1"), 0},
               {TWO "3 0 1 2\n3 0 4 2", NO_CORNER("1"), 0}, {TWO "3 0 1 2\n3 0 1 4", NO_CORNER("1"), 0},
               {THREE("1 nan 0") "3 0 1 2\n4 0 1 2 3\n3 0 1 2", "vertex 2 has y = nan, must be a finite float", 0},
               {THREE("1 1 0") "3 0 1 2\n4 0 1 2 3\n3 0 4 2", NO_CORNER("2"), 0},
               {TWO "3 0 1 2\n3 0 1 2", "the file ends in face 1 of 2", 1},
               {TWO "3 0 1 2\n3 0 1 2", "the file ends in face 1 of 2", 12},
               {THREE("1 1 0") "3 0 1 2\n4 0 1 2 3\n3 0 1 2", "the file ends in face 2 of 3", 1}};
    for (size_t i = 0; i < sizeof cut / sizeof *cut; i++) {
        bytes b = binary_of(cut[i].text, false);
        b.n -= cut[i].lost;
        expect_mesh_refusal_of(bis_ply_read, &b, "cut.ply", 0, cut[i].message);
        bytes_clear(&b);
    }
}

/* ---- files ---- */

static void missing_files_and_folders_are_the_disks_fault(void **state)
{
    bis_diag diag = {0};
    bis_mesh m;
    assert_int_equal(bis_ply_read(&m, "build/no such file.ply", (bis_loc){"s.txt", 3, 7}, &diag), BIS_IO);
    assert_int_equal(bis_ply_read(&m, "build", (bis_loc){0}, &diag), BIS_IO);
    assert_null(m.p);
    assert_int_equal(diag.n, 2);
    assert_string_equal(
        diag.messages[0].text, "s.txt:3:7: error: cannot open \"build/no such file.ply\": No such file or directory");
    bis_diag_clear(&diag);
}

#define STRIP_OF_NORMALS VERTICES(4) "property float nx\nproperty float ny\nproperty float nz\n" \
    "element tristrips 1\nproperty list int int vertex_indices\n"
#define NORMAL_CORNERS "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 1 0 0\n"

static void damaged_files_never_crash(void **state)
{
    bytes binary = binary_of(typed_square("short", "uchar", "ushort"), true);
    bytes text = ascii_of(STRIP_OF_NORMALS FACES(2) NORMAL_CORNERS "6 0 1 2 -1 3 2\n3 0 1 2\n4 0 1 2 3\n");
    try_mesh_damage(bis_ply_read, &binary, "damage.ply", 3000, 1);
    try_mesh_damage(bis_ply_read, &text, "damage.ply", 3000, 2);
    bytes_clear(&binary);
    bytes_clear(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_text_is_its_mesh_in_ascii_and_both_byte_orders),
        cmocka_unit_test(all_types_orders_and_places_of_properties_read_the_same),
        cmocka_unit_test(every_line_end_leaves_a_body_that_begins_with_a_newline_alone),
        cmocka_unit_test(lines_are_counted_by_any_end),
        cmocka_unit_test(a_bad_file_is_refused_by_line_vertex_or_face),
        cmocka_unit_test(a_short_cut_refuses_what_the_long_way_refuses),
        cmocka_unit_test(missing_files_and_folders_are_the_disks_fault),
        cmocka_unit_test(damaged_files_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
