/* SPDX-License-Identifier: BSD-2-Clause */
/* OpenEXR: files made here byte by byte (all layouts, uncompressed), by OpenEXR's older C interface (each
 * compression, luminance with chroma); bad files; what the writer leaves in a
 * file. */
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "image_help.h"
#include "threads.h"

#include <ImfCRgbaFile.h>
#include <errno.h>
#include <math.h>
#include <openexr.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

enum { UINT, HALF, FLOAT };

typedef struct channel_spec {
    char name[32];
    int type, x_sampling, y_sampling;
} channel_spec;

/* A part of a file. Its channels stand in alphabetical order, because so the format wants it; each is of halves, ":u"
 * and ":f" make one of whole numbers or floats, "/2" leaves out every other pixel and row. */
typedef struct part_spec {
    const char *channels;
    int x0, y0, width, height;
    int tile; /* 0: scanlines; else the side of a tile */
    bool decreasing;
    const char *type, *name; /* NULL: not written */
    const float *chromaticities; /* chromaticities[8]; NULL: not written */
} part_spec;

static int channels_of(channel_spec channels[8], const char *text)
{
    int n = 0;
    for (int used; sscanf(text, " %31[^:/|- ]%n", channels[n].name, &used) == 1; n++) {
        text += used;
        channels[n].type = *text != ':' ? HALF : text[1] == 'u' ? UINT : FLOAT;
        text += *text == ':' ? 2 : 0;
        channels[n].x_sampling = *text == '/' || *text == '-' ? 2 : 1;
        channels[n].y_sampling = *text == '/' || *text == '|' ? 2 : 1;
        text += channels[n].x_sampling * channels[n].y_sampling > 1 ? 2 : 0;
    }
    return n;
}

/* Whole numbers that a half holds exactly, all different: at (x, y) of the window, from its upper left corner. */
static int value_at(int channel, int x, int y) { return 128 * channel + 11 * y + x; }

/* ---- bytes of a file ---- */

static uint16_t half_of(int v)
{
    int e;
    if (v == 0) return 0;
    double m = frexp(v, &e); /* v = m 2^e, 0.5 <= m < 1 */
    return (uint16_t)((e - 1 + 15) << 10 | ((int)(m * 2048) & 1023));
}

static void put_value(bytes *b, int type, int v)
{
    if (type == UINT) put_int(b, (uint64_t)v, 4);
    if (type == HALF) put_int(b, half_of(v), 2);
    if (type == FLOAT) put_float(b, (float)v);
}

static void put_attribute(bytes *b, const char *name, const char *type, const bytes *value)
{
    put(b, name, strlen(name) + 1);
    put(b, type, strlen(type) + 1);
    put_int(b, value->n, 4);
    put(b, value->data, value->n);
}

static void put_text_attribute(bytes *b, const char *name, const char *text)
{
    bytes value = {0};
    if (!text) return;
    put_text(&value, text);
    put_attribute(b, name, "string", &value);
    bytes_clear(&value);
}

static void put_int_attribute(bytes *b, const char *name, const char *type, int v, int n_bytes)
{
    bytes value = {0};
    put_int(&value, (uint64_t)v, n_bytes);
    put_attribute(b, name, type, &value);
    bytes_clear(&value);
}

static void put_window(bytes *b, const char *name, int x0, int y0, int x1, int y1)
{
    bytes value = {0};
    const int corners[4] = {x0, y0, x1, y1};
    for (int i = 0; i < 4; i++)
        put_int(&value, (uint32_t)corners[i], 4);
    put_attribute(b, name, "box2i", &value);
    bytes_clear(&value);
}

static void put_channels(bytes *b, const part_spec *p)
{
    bytes value = {0};
    channel_spec channels[8];
    const int n = channels_of(channels, p->channels);
    for (const channel_spec *c = channels; c < channels + n; c++) {
        put(&value, c->name, strlen(c->name) + 1);
        put_int(&value, (uint64_t)c->type, 4);
        put_int(&value, 0, 4);
        put_int(&value, (uint64_t)c->x_sampling, 4);
        put_int(&value, (uint64_t)c->y_sampling, 4);
    }
    put_int(&value, 0, 1);
    put_attribute(b, "channels", "chlist", &value);
    bytes_clear(&value);
}

static int tiles_along(int size, int tile) { return (size - 1) / tile + 1; }

static int n_chunks_of(const part_spec *p)
{
    return p->tile ? tiles_along(p->width, p->tile) * tiles_along(p->height, p->tile) : p->height;
}

static void put_header(bytes *b, const part_spec *p)
{
    bytes value = {0};
    put_channels(b, p);
    put_int_attribute(b, "compression", "compression", 0, 1);
    put_window(b, "dataWindow", p->x0, p->y0, p->x0 + p->width - 1, p->y0 + p->height - 1);
    put_window(b, "displayWindow", p->x0 - 2, p->y0 - 1, p->x0 + p->width + 3, p->y0 + p->height + 1);
    put_int_attribute(b, "lineOrder", "lineOrder", p->decreasing, 1);
    put_float(&value, 1);
    put_attribute(b, "pixelAspectRatio", "float", &value);
    put_attribute(b, "screenWindowWidth", "float", &value);
    put_float(&value, 0);
    put_attribute(b, "screenWindowCenter", "v2f", &value);
    if (p->tile) {
        value.n = 0;
        put_int(&value, (uint64_t)p->tile, 4);
        put_int(&value, (uint64_t)p->tile, 4);
        put_int(&value, 0, 1);
        put_attribute(b, "tiles", "tiledesc", &value);
    }
    if (p->chromaticities) {
        value.n = 0;
        for (int i = 0; i < 8; i++) put_float(&value, p->chromaticities[i]);
        put_attribute(b, "chromaticities", "chromaticities", &value);
    }
    put_text_attribute(b, "type", p->type);
    put_text_attribute(b, "name", p->name);
    if (p->type) put_int_attribute(b, "chunkCount", "int", n_chunks_of(p), 4);
    if (p->type && !strncmp(p->type, "deep", 4)) {
        put_int_attribute(b, "version", "int", 1, 4);
        put_int_attribute(b, "maxSamplesPerPixel", "int", 1, 4);
    }
    put_int(b, 0, 1);
    bytes_clear(&value);
}

/* Rows [y, y + height), columns [x, x + width) of all channels. */
static void put_pixels(bytes *b, const part_spec *p, int x, int y, int width, int height)
{
    channel_spec channels[8];
    const int n = channels_of(channels, p->channels);
    for (int j = y; j < y + height; j++)
        for (int c = 0; c < n; c++)
            for (int i = x; i < x + width; i++)
                if ((i + p->x0) % channels[c].x_sampling == 0 && (j + p->y0) % channels[c].y_sampling == 0)
                    put_value(b, channels[c].type, value_at(c, i, j));
}

static void put_chunk(bytes *b, const part_spec *p, int part, int index)
{
    bytes data = {0};
    if (part >= 0) put_int(b, (uint64_t)part, 4);
    if (p->tile) {
        const int n = tiles_along(p->width, p->tile), x = index % n * p->tile, y = index / n * p->tile;
        put_int(b, (uint64_t)(index % n), 4);
        put_int(b, (uint64_t)(index / n), 4);
        put_int(b, 0, 8); /* level */
        put_pixels(&data, p, x, y, x + p->tile > p->width ? p->width - x : p->tile,
            y + p->tile > p->height ? p->height - y : p->tile);
    } else {
        put_int(b, (uint32_t)(p->y0 + index), 4);
        put_pixels(&data, p, 0, index, p->width, 1);
    }
    put_int(b, data.n, 4);
    put(b, data.data, data.n);
    bytes_clear(&data);
}

static void patch(bytes *b, size_t at, uint64_t v)
{
    for (int i = 0; i < 8; i++)
        b->data[at + (size_t)i] = (unsigned char)(v >> 8 * i);
}

static void put_file(bytes *b, const part_spec *parts, int n_parts)
{
    const bool multi = n_parts > 1, deep = parts[0].type && !strncmp(parts[0].type, "deep", 4);
    const int flags = (multi ? 0x1000 : 0) | (!multi && parts[0].tile ? 0x200 : 0) | (deep ? 0x800 : 0);
    put_int(b, 20000630, 4);
    put_int(b, (uint64_t)(2 | flags), 4);
    for (int i = 0; i < n_parts; i++)
        put_header(b, &parts[i]);
    if (multi) put_int(b, 0, 1);
    size_t table = b->n;
    for (int i = 0; i < n_parts; i++)
        for (int k = 0; k < n_chunks_of(&parts[i]); k++)
            put_int(b, 0, 8);
    for (int i = 0; i < n_parts; i++) {
        const int n = n_chunks_of(&parts[i]);
        for (int k = 0; k < n; k++) {
            int index = parts[i].decreasing ? n - 1 - k : k; /* the table is in order of y, the chunks as they come */
            patch(b, table + 8 * (size_t)index, b->n);
            put_chunk(b, &parts[i], multi ? i : -1, index);
        }
        table += 8 * (size_t)n;
    }
}

/* ---- reading ---- */

/* Read a file of these parts and expect, for R, G and B, the values of the channels of these indices. */
static void expect_channels(const part_spec *parts, int n_parts, int part, const int index[3], const char *remark)
{
    bytes file = {0};
    bis_image image;
    put_file(&file, parts, n_parts);
    store(scratch("made.exr"), file.data, file.n);
    expect_image(&image, scratch("made.exr"), remark);
    assert_int_equal(image.width, parts[part].width);
    assert_int_equal(image.height, parts[part].height);
    for (int y = 0; y < image.height; y++)
        for (int x = 0; x < image.width; x++) {
            rgb v = image.pixels[y * image.width + x];
            const int r = value_at(index[0], x, y), g = value_at(index[1], x, y), b = value_at(index[2], x, y);
            if (v.r != (float)r || v.g != (float)g || v.b != (float)b)
                fail_msg("%s: %g %g %g, not %d %d %d", parts[part].channels, (double)v.r, (double)v.g, (double)v.b, r,
                         g, b);
        }
    bis_image_clear(&image);
    bytes_clear(&file);
}

static void expect_bad_parts(const part_spec *parts, int n_parts, const char *message)
{
    bytes file = {0};
    put_file(&file, parts, n_parts);
    expect_refusal_of(&file, "bad.exr", message);
    bytes_clear(&file);
}

static const int plain[3] = {2, 1, 0}; /* of "B G R" */

static const char *const letters[3] = {":u", "", ":f"};

/* A pixel of the given values, of a file with these chromaticities; diag is the caller's. */
static rgb one_pixel(const float c[8], rgb value, bis_diag *diag)
{
    const float rec709[8] = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    const part_spec part = {.channels = "B:f G:f R:f", .width = 1, .height = 1,
                            .chromaticities = c ? c : rec709};
    bytes file = {0};
    bis_image image;
    put_file(&file, &part, 1);
    /* the last 12 bytes: B, G, R */
    const float v[3] = {value.b, value.g, value.r};
    memcpy(file.data + file.n - sizeof v, v, sizeof v);
    store(scratch("primaries.exr"), file.data, file.n);
    *diag = (bis_diag){0};
    assert_int_equal(bis_image_read(&image, scratch("primaries.exr"), (bis_loc){0}, diag), BIS_OK);
    const rgb out = image.pixels[0];
    bis_image_clear(&image);
    bytes_clear(&file);
    return out;
}

static void assert_colour(rgb c, double r, double g, double b, double tolerance)
{
    if (fabs((double)c.r - r) > tolerance || fabs((double)c.g - g) > tolerance || fabs((double)c.b - b) > tolerance)
        fail_msg("%g %g %g, not %g %g %g", (double)c.r, (double)c.g, (double)c.b, r, g, b);
}

/* The matrices are published: IEC 61966-2-1 has XYZ to sRGB to four digits, and Rec. ITU-R BT.2087 has BT.2020 to
 * BT.709. */
static void colours_of_other_primaries_become_those_of_rec_709(void **state)
{
    static const float bt2020[8] = {.708f, .292f, .17f, .797f, .131f, .046f, .3127f, .329f};
    static const float xyz[8] = {1, 1e-9f, 1e-9f, 1, 1e-9f, 1e-9f, 1.f / 3, 1.f / 3}; /* nearly: X, Y, Z themselves */
    static const float d50[8] = {.64f, .33f, .3f, .6f, .15f, .06f, .3457f, .3585f};
    bis_diag diag;
    /* inside of both: 0.1 red and 1 green of BT.2020, whose matrix has the rows 1.6605 -0.5876 -0.0728, -0.1246 1.1329
     * -0.0083, -0.0182 -0.1006 1.1187 */
    assert_colour(one_pixel(bt2020, (rgb){1, .5f, .25f}, &diag), 1.6605 - .2938 - .0182, -.1246 + .56645 - .0021,
                  -.0182 - .0503 + .27968, 2e-4);
    assert_int_equal(diag.n, 1);
    assert_null(strstr(diag.messages[0].text, "outside"));
    bis_diag_clear(&diag);
    /* white stays white where both have D65 */
    assert_colour(one_pixel(bt2020, (rgb){2, 2, 2}, &diag), 2, 2, 2, 1e-5);
    bis_diag_clear(&diag);
    /* pure red of BT.2020 is outside: green and blue become 0 and not negative */
    assert_colour(one_pixel(bt2020, (rgb){1, 0, 0}, &diag), 1.6605, 0, 0, 2e-4);
    assert_non_null(strstr(diag.messages[0].text, "100% of its pixels lie outside of these, and their negative parts "
                                                  "are set to 0"));
    bis_diag_clear(&diag);
    /* what was negative before is passed on, for who reads it to judge */
    assert_true(one_pixel(bt2020, (rgb){-1, 0, 0}, &diag).r < -1.6f);
    bis_diag_clear(&diag);
    assert_colour(one_pixel(bt2020, (rgb){1, -.5f, 0}, &diag), 1.6605 + .2938, -.1246 - .56645, -.0182 + .0503, 2e-4);
    assert_null(strstr(diag.messages[0].text, "outside"));
    bis_diag_clear(&diag);
    assert_colour(one_pixel(bt2020, (rgb){.5f, .1f, -1}, &diag), .83025 - .05876 + .0728, -.0623 + .11329 + .0083,
                  -.0091 - .01006 - 1.1187, 2e-4);
    assert_null(strstr(diag.messages[0].text, "outside"));
    bis_diag_clear(&diag);
    /* XYZ itself: the matrix of sRGB, 3.2406 -1.5372 -0.4986 */
    assert_colour(one_pixel(xyz, (rgb){.5f, .4f, .3f}, &diag), 1.6203 - .61488 - .14958, -.48445 + .75032 + .01245,
                  .02785 - .0816 + .3171, 2e-4);
    bis_diag_clear(&diag);
    /* a white of D50 is not adapted: 1 1 1 has the XYZ (.3457 1 .2958)/.3585 */
    const double X = .3457 / .3585, Z = (1 - .3457 - .3585) / .3585;
    assert_colour(one_pixel(d50, (rgb){1, 1, 1}, &diag), 3.2406 * X - 1.5372 - .4986 * Z,
        -.9689 * X + 1.8758 + .0415 * Z, .0557 * X - .204 + 1.057 * Z, 3e-4);
    bis_diag_clear(&diag);
    /* twin: of Rec. 709 nothing is changed, and nothing said */
    assert_colour(one_pixel(NULL, (rgb){.1f, .2f, .3f}, &diag), (double).1f, (double).2f, (double).3f, 0);
    assert_int_equal(diag.n, 0);
}

/* Two of seven pixels: one is red and one green, which lie outside; of a pixel outside only what is negative becomes
 * 0. */
static void the_share_of_pixels_outside_is_told(void **state)
{
    static const float bt2020[8] = {.708f, .292f, .17f, .797f, .131f, .046f, .3127f, .329f};
    const part_spec part = {.channels = "B:f G:f R:f", .width = 7, .height = 1, .chromaticities = bt2020};
    bytes file = {0};
    bis_image image;
    put_file(&file, &part, 1);
    float v[3][7];
    for (int i = 0; i < 7; i++) v[0][i] = v[1][i] = v[2][i] = 1;
    v[0][2] = v[1][2] = v[0][5] = v[2][5] = 0;
    memcpy(file.data + file.n - sizeof v, v, sizeof v);
    store(scratch("share.exr"), file.data, file.n);
    expect_image(&image, scratch("share.exr"), "its colours are converted from its own primaries to those of Rec. 709; "
                 "29% of its pixels lie outside of these, and their negative parts are set to 0");
    for (int i = 0; i < 7; i++)
        assert_colour(image.pixels[i], i == 2 ? 1.6605 : i == 5 ? 0 : 1, i == 2 ? 0 : i == 5 ? 1.1329 : 1,
                      i == 2 || i == 5 ? 0 : 1, 2e-4);
    bis_image_clear(&image);
    bytes_clear(&file);
}

static void luminance_has_no_primaries(void **state)
{
    static const float bt2020[8] = {.708f, .292f, .17f, .797f, .131f, .046f, .3127f, .329f};
    const part_spec part = {.channels = "Y:f", .width = 3, .height = 2, .chromaticities = bt2020};
    expect_channels(&part, 1, 0, (const int[3]){0, 0, 0}, NULL);
}

static void chromaticities_that_span_nothing_are_remarked(void **state)
{
    static const float bad[][8] = {{.3f, .3f, .3f, .3f, .1f, .1f, .3f, .3f},
                                   {.64f, .33f, .3f, .6f, .15f, .06f, .3f, 0},
                                    {NAN, .33f, .3f, .6f, .15f, .06f, .3f, .3f}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        bis_diag diag;
        assert_colour(one_pixel(bad[i], (rgb){.1f, .2f, .3f}, &diag), (double).1f, (double).2f, (double).3f, 0);
        assert_int_equal(diag.n, 1);
        assert_non_null(
            strstr(diag.messages[0].text, "are no three primaries and a white; the values are taken as they are"));
        bis_diag_clear(&diag);
    }
}

static void the_data_window_is_the_whole_map_wherever_it_lies(void **state)
{
    const int corners[][2] = {{0, 0}, {3, 4}, {-7, -5}, {-1000000, 1000000}, {98, 48}};
    for (size_t i = 0; i < sizeof corners / sizeof corners[0]; i++)
        for (int tile = 0; tile <= 4; tile += 4)
            for (int decreasing = 0; decreasing < 2; decreasing++) {
                const part_spec part = {.channels = "B G R", .x0 = corners[i][0], .y0 = corners[i][1], .width = 6,
                                        .height = 5, .tile = tile, .decreasing = decreasing};
                expect_channels(&part, 1, 0, plain, NULL);
            }
}

/* As colours it is the whole picture: display windows of put_header begin 2 to the left and 1 above, and are 6 wider
 * and 3 higher. What has no pixels is black and transparent. */
static void a_picture_with_a_smaller_data_window_is_filled_up(void **state)
{
    const part_spec part = {.channels = "A B G R", .x0 = 7, .y0 = -5, .width = 4, .height = 3};
    bytes file = {0};
    bis_image image;
    put_file(&file, &part, 1);
    store(scratch("part.exr"), file.data, file.n);
    assert_int_equal(bis_image_read_alpha(&image, scratch("part.exr"), 1, (bis_loc){0}, NULL), BIS_OK);
    assert_true(image.width == 10 && image.height == 6);
    for (int i = 0; i < 60; i++) {
        const int x = i % 10 - 2, y = i / 10 - 1;
        const bool there = x >= 0 && x < 4 && y >= 0 && y < 3;
        assert_true(image.alpha[i] == (there ? (float)value_at(0, x, y) : 0));
        assert_true(image.pixels[i].r == (there ? (float)value_at(3, x, y) : 0));
    }
    bis_image_clear(&image);
    bytes_clear(&file);
}

static void tiles_of_any_side_fill_the_map(void **state)
{
    for (int tile = 1; tile <= 9; tile++) {
        const part_spec part = {.channels = "B G R", .width = 8, .height = 5, .tile = tile};
        expect_channels(&part, 1, 0, plain, NULL);
    }
}

#define LAYER(name) "it has no R, G, B at the top; layer \"" name "\" is read"
#define WHICH(layers) "it has no R, G, B without a layer, and which of its layers " layers " is the picture is not " \
    "known: name it Combined, beauty, rgba or C, or save it as R, G, B"
#define NO_COLOUR(names) "its channels are " names ", must be R, G and B, or Y, perhaps in a layer"
#define NOT_AT_TOP(what) what " is only read at the top of a file's first part; save it with ZIP compression as R, G, B"
#define FIVE(letter) letter letter letter letter letter
#define MOST(letter) FIVE(letter) FIVE(letter) FIVE(letter) FIVE(letter) FIVE(letter) FIVE(letter) letter
#define LINES .type = "scanlineimage"
#define ONE(channels) {{channels, .width = 4, .height = 4}}, 1

static const struct {
    part_spec parts[3];
    int n, part, index[3]; /* of the part that is read; -1: the file is refused */
    const char *message;
} made[] = {
    /* one pixel is a map */
    {{{"B G R", .width = 1, .height = 1}}, 1, 0, {2, 1, 0}, NULL},
    /* luminance alone is grey */
    {ONE("A Y:f right.Y"), 0, {1, 1, 1}, NULL},
    /* luminance with half a chroma is grey */
    {ONE("BY Y:f"), 0, {1, 1, 1}, NULL},
    {ONE("RY Y:f"), 0, {1, 1, 1}, NULL},
    /* of several layers, none is guessed */
    {ONE("a.Y view.pass.B view.pass.G view.pass.R"), -1, {0}, WHICH("\"a\", \"view.pass\"")},
    /* a layer of luminance is grey */
    {ONE("a.Y"), 0, {0, 0, 0}, LAYER("a")},
    /* colour at the top wins over luminance and layers; two of three colours are none */
    {ONE("B G R Y a.B a.G a.R"), 0, {2, 1, 0}, NULL},
    {ONE("B G Y:f"), 0, {2, 2, 2}, NULL},
    {ONE("B R Y"), 0, {2, 2, 2}, NULL},
    {ONE("G R Y:u"), 0, {2, 2, 2}, NULL},
    {ONE("a.B a.R b.B b.G b.R"), -1, {0}, WHICH("\"b\"")},
    /* a layer is found by its whole name, and a channel by the name behind it; the Y of a vector is no luminance */
    {ONE("B GG R Ya b.Y"), 0, {4, 4, 4}, LAYER("b")},
    {ONE("N.X N.Y N.Z b.Y"), -1, {0}, WHICH("\"b\"")},
    /* a subsampled channel that nobody wants does no harm */
    {ONE("B G H/2 R"), 0, {3, 1, 0}, NULL},
    /* the first part with colour is read */
    {{{"Z:f", .width = 9, .height = 2, LINES, .name = "depth"},
      {"B G R", .width = 5, .height = 4, .type = "tiledimage", .name = "colour", .tile = 3, .x0 = 2},
      {"B G R", .width = 3, .height = 3, LINES, .name = "other"}}, 3, 1, {2, 1, 0},
     "part 2 of 3 is read, the others are ignored"},
    /* a file without colour is refused by the channels of all its parts */
    {{{"a.B a.G b.R", .width = 4, .height = 3, LINES, .name = "one"},
      {"R", .width = 4, .height = 3, LINES, .name = "two"}}, 2, -1, {0},
     NO_COLOUR("\"a.B\", \"a.G\", \"b.R\", \"R\"")},
    /* deep data alone is refused */
    {{{"B G R", .width = 4, .height = 3, .type = "deepscanline", .name = "deep"}}, 1, -1,
     {0}, "it holds deep data alone (many samples a pixel); flatten it first"},
    /* what is not printable in a name is not printed, and of many names 199 bytes are */
    {ONE("\x1f Z~ \x7f"), -1, {0}, NO_COLOUR("\"?\", \"Z~\", \"?\"")},
    {ONE(MOST("a") " " MOST("b") " " MOST("c") " " MOST("d") " " MOST("e") " " MOST("f") " " MOST("g")), -1, {0},
     NO_COLOUR("\"" MOST("a") "\", \"" MOST("b") "\", \"" MOST("c") "\", \"" MOST("d") "\", \"" MOST("e") "\", "
               "\"fffffffffffffffffffffff")},
    /* subsampled colour is refused */
    {ONE("B-2 G R"), -1, {0}, "its channel B has a sampling of 2 x 1, must be 1 x 1"},
    {ONE("B G|2 R"), -1, {0}, "its channel G has a sampling of 1 x 2, must be 1 x 1"},
    {ONE("a.B a.G a.R/2"), -1, {0}, "its channel a.R has a sampling of 2 x 2, must be 1 x 1"},
    {ONE("Y/2"), -1, {0}, "its channel Y has a sampling of 2 x 2, must be 1 x 1"},
    /* what only the older interface reads must be at the top of the first part */
    {ONE("a.BY/2 a.RY/2 a.Y"), -1, {0}, NOT_AT_TOP("luminance with chroma")},
};

static void each_file_gives_the_channels_or_the_message_beside_it(void **state)
{
    for (size_t i = 0; i < sizeof made / sizeof *made; i++) {
        if (made[i].part < 0) expect_bad_parts(made[i].parts, made[i].n, made[i].message);
        else expect_channels(made[i].parts, made[i].n, made[i].part, made[i].index, made[i].message);
    }
}

/* OpenEXRCore 3.1.5 wrote all of three or four channels where it was to write one half. */
static void one_channel_of_any_type_among_any_others_is_read(void **state)
{
    static const struct {
        const char *format;
        int index[3];
    } sets[] = {{"A%s Y%s", {1, 1, 1}}, {"A%s Y%s Z%s", {1, 1, 1}}, {"A%s Y%s Z%s ZZ%s", {1, 1, 1}},
                {"A%s B%s G%s R%s", {3, 2, 1}}};
    for (int types = 0; types < 81; types++)
        for (int k = 0; k < 4; k++) {
            char channels[64];
            snprintf(channels, sizeof channels, sets[k].format, letters[types % 3], letters[types / 3 % 3],
                     letters[types / 9 % 3], letters[types / 27]);
            const part_spec part = {.channels = channels, .width = 4, .height = 3, .tile = k == 2 ? 3 : 0};
            expect_channels(&part, 1, 0, sets[k].index, NULL);
        }
}

/* ---- compression ---- */

/* Even, for chroma. */
enum { WIDE = 70, HIGH = 34 };

/* Whole numbers in blocks of 4 x 4, which every compression of halves but DWA keeps exactly. */
static bool is_blocky, is_tiled; /* what is written */

static int blocky(int channel, int x, int y) { return 100 * channel + (x / 4 * 7 + y / 4 * 3) % 50; }

/* A smooth picture: what lossy codings keep. */
static rgb smooth(int x, int y)
{
    if (is_blocky) return rgb_from(blocky(2, x, y), blocky(1, x, y), blocky(0, x, y));
    return rgb_from(1 + 0.5 * sin(0.05 * x), 1 + 0.3 * cos(0.07 * y), 2 + 0.01 * x - 0.01 * y);
}

static void write_by_imf(const char *path, int channels, int compression, int x0, int y0)
{
    static ImfRgba pixels[WIDE * HIGH];
    ImfHeader *header = ImfNewHeader();
    for (int i = 0; i < WIDE * HIGH; i++) {
        rgb v = smooth(i % WIDE, i / WIDE);
        ImfFloatToHalf(v.r, &pixels[i].r);
        ImfFloatToHalf(v.g, &pixels[i].g);
        ImfFloatToHalf(v.b, &pixels[i].b);
        ImfFloatToHalf(1, &pixels[i].a);
    }
    ImfHeaderSetDataWindow(header, x0, y0, x0 + WIDE - 1, y0 + HIGH - 1);
    ImfHeaderSetDisplayWindow(header, x0, y0, x0 + WIDE + 2, y0 + HIGH);
    ImfHeaderSetCompression(header, compression);
    const ImfRgba *origin = (ImfRgba *)((intptr_t)pixels - (intptr_t)sizeof *pixels * (y0 * WIDE + x0));
    if (is_tiled) {
        ImfTiledOutputFile *file = ImfOpenTiledOutputFile(path, header, channels, 16, 12, IMF_ONE_LEVEL,
                                                          IMF_ROUND_DOWN);
        assert_true(ImfTiledOutputSetFrameBuffer(file, origin, 1, WIDE));
        assert_true(ImfTiledOutputWriteTiles(file, 0, (WIDE - 1) / 16, 0, (HIGH - 1) / 12, 0, 0));
        assert_true(ImfCloseTiledOutputFile(file));
    } else {
        ImfOutputFile *file = ImfOpenOutputFile(path, header, channels);
        assert_true(ImfOutputSetFrameBuffer(file, origin, 1, WIDE));
        assert_true(ImfOutputWritePixels(file, HIGH));
        assert_true(ImfCloseOutputFile(file));
    }
    ImfDeleteHeader(header);
}

/* Each channel within this share of the pixel's largest. */
static void expect_smooth(double tolerance)
{
    bis_image image;
    expect_image(&image, scratch("imf.exr"), NULL);
    assert_int_equal(image.width, WIDE);
    assert_int_equal(image.height, HIGH);
    for (int i = 0; i < WIDE * HIGH; i++) {
        rgb v = image.pixels[i], expected = smooth(i % WIDE, i / WIDE);
        double allowed = tolerance * fmax((double)expected.r, fmax((double)expected.g, (double)expected.b));
        assert_true(fabs((double)(v.r - expected.r)) <= allowed);
        assert_true(fabs((double)(v.g - expected.g)) <= allowed);
        assert_true(fabs((double)(v.b - expected.b)) <= allowed);
    }
    bis_image_clear(&image);
}

static void every_compression_of_no_loss_is_read_in_scanlines_and_tiles(void **state)
{
    is_blocky = true;
    for (int compression = IMF_NO_COMPRESSION; compression <= IMF_B44A_COMPRESSION; compression++)
        for (int tiled = 0; tiled < 2; tiled++) {
            is_tiled = tiled;
            write_by_imf(scratch("imf.exr"), IMF_WRITE_RGB, compression, 0, 0);
            expect_smooth(0);
        }
    is_blocky = is_tiled = false;
}

static void dwa_is_read_to_its_own_precision(void **state)
{
    const int corners[][2] = {{0, 0}, {-7, 1000}};
    for (int i = 0; i < 2; i++) {
        write_by_imf(scratch("imf.exr"), IMF_WRITE_RGBA, IMF_DWAA_COMPRESSION, corners[i][0], corners[i][1]);
        expect_smooth(0.02);
        write_by_imf(scratch("imf.exr"), IMF_WRITE_RGB, IMF_DWAB_COMPRESSION, corners[i][0], corners[i][1]);
        expect_smooth(0.02);
    }
}

static void luminance_with_chroma_is_colour(void **state)
{
    for (int compression = IMF_NO_COMPRESSION; compression <= IMF_DWAB_COMPRESSION; compression++) {
        write_by_imf(scratch("imf.exr"), IMF_WRITE_YC, compression, 0, 0);
        expect_smooth(0.05); /* chroma at a quarter of the resolution, edges extrapolated */
    }
}

/* ---- bad files ---- */

/* Where the value of an attribute begins: behind its name, its type (words hold both, with a zero behind each) and four
 * bytes. */
static unsigned char *value_in(const bytes *file, const char *words, size_t n)
{
    unsigned char *const found = memmem(file->data, file->n, words, n);
    assert_non_null(found);
    return found + n + 4;
}

static void set_size(const bytes *file, int width, int height)
{
    unsigned char *const window = value_in(file, BYTES("dataWindow\0box2i\0"));
    for (int j = 0; j < 4; j++) {
        window[8 + j] = (unsigned char)((width - 1) >> 8 * j);
        window[12 + j] = (unsigned char)((height - 1) >> 8 * j);
    }
}

/* Two bytes a channel: 25 x 3 pixels have 450, one of 4 x 54 has 1296; a table of 55 has 440. */
static void a_huge_window_in_a_short_file_is_refused_before_it_is_allocated(void **state)
{
    part_spec part = {.channels = "B G R", .width = 4, .height = 3};
    const struct {
        int width, height;
        const char *message;
    } cases[] = {
        {25, 3, "25 x 3 pixels cannot be in 433 bytes (the file is cut off or damaged)"},
        {4, 54, "4 x 54 pixels cannot be in 433 bytes (the file is cut off or damaged)"},
        {4, 55, "its 55 chunks need a table of 8 bytes each, but the file has 433 bytes"},
        {32769, 3, "its size is 32769 x 3, a side must be 1 to 32768 pixels"},
        {4, 32769, "its size is 4 x 32769, a side must be 1 to 32768 pixels"},
    };
    bytes file = {0};
    put_file(&file, &part, 1);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        set_size(&file, cases[i].width, cases[i].height);
        expect_refusal_of(&file, "bomb.exr", cases[i].message);
    }
    bytes_clear(&file);
}

/* A black picture is the shortest: what each compression makes of one is believed. */
static void a_black_picture_of_each_compression_is_believed(void **state)
{
    enum { WIDTH = 1024, HEIGHT = 512 };
    static ImfRgba black[WIDTH * HEIGHT];
    for (int compression = IMF_NO_COMPRESSION; compression <= IMF_DWAB_COMPRESSION; compression++) {
        bis_image image;
        ImfHeader *header = ImfNewHeader();
        ImfHeaderSetDataWindow(header, 0, 0, WIDTH - 1, HEIGHT - 1);
        ImfHeaderSetDisplayWindow(header, 0, 0, WIDTH - 1, HEIGHT - 1);
        ImfHeaderSetCompression(header, compression);
        ImfOutputFile *file = ImfOpenOutputFile(scratch("black.exr"), header, IMF_WRITE_RGB);
        assert_true(ImfOutputSetFrameBuffer(file, black, 1, WIDTH) && ImfOutputWritePixels(file, HEIGHT));
        assert_true(ImfCloseOutputFile(file));
        ImfDeleteHeader(header);
        expect_image(&image, scratch("black.exr"), NULL);
        for (int i = 0; i < WIDTH * HEIGHT; i++) assert_true(rgb_is_black(image.pixels[i]));
        bis_image_clear(&image);
    }
}

static void no_damage_leads_out_of_the_file(void **state)
{
    const part_spec scanlines = {.channels = "B G R", .width = 4, .height = 3};
    const part_spec tiles = {.channels = "B G R", .width = 4, .height = 3, .tile = 2};
    const part_spec parts[2] = {
        {"B", .width = 2, .height = 2, LINES, .name = "a"},
        {"B G R", .width = 2, .height = 2, LINES, .name = "b"},
    };
    const part_spec *const damaged[3] = {&scanlines, &tiles, parts};
    for (int i = 0; i < 3; i++) {
        bytes file = {0};
        put_file(&file, damaged[i], i == 2 ? 2 : 1);
        try_damage(&file, "damaged.exr", 1000, 3 + (uint32_t)i);
        bytes_clear(&file);
    }
}

static void load(bytes *file, const char *path)
{
    size_t n;
    unsigned char *const data = read_bytes(path, &n);
    put(file, data, n);
    bis_free(data);
}

static void no_damage_to_compressed_data_leads_out_of_the_file(void **state)
{
    for (int compression = IMF_RLE_COMPRESSION; compression <= IMF_DWAB_COMPRESSION; compression++) {
        bytes file = {0};
        write_by_imf(scratch("imf.exr"), compression % 2 ? IMF_WRITE_RGB : IMF_WRITE_YC, compression, 0, 0);
        load(&file, scratch("imf.exr"));
        uint32_t seed = 77 + (uint32_t)compression;
        for (int i = 0; i < 100; i++) {
            bis_image image;
            bytes changed = {0};
            put(&changed, file.data, file.n);
            for (int k = 0; k < 3; k++) /* behind the header: that is the test above */
                changed.data[400 + next_random(&seed) % (changed.n - 400)] = (unsigned char)next_random(&seed);
            store(scratch("changed.exr"), changed.data, changed.n);
            bis_status status = bis_image_read(&image, scratch("changed.exr"), (bis_loc){0}, NULL);
            assert_int_equal(status == BIS_OK, image.pixels != NULL);
            bis_image_clear(&image);
            bytes_clear(&changed);
        }
        bytes_clear(&file);
    }
}

/* ---- writing ---- */

static enum { AS_EVER, IN_PIECES, NOTHING } disk; /* how much of what is asked for is written */
static int n_writes;

/* Stands in the place of the system's. In pieces of seven bytes, and every third time a signal comes first. */
ssize_t pwrite(int fd, const void *data, size_t n, off_t offset)
{
    const struct iovec piece = {(void *)(uintptr_t)data, disk == IN_PIECES && n > 7 ? 7 : n};
    n_writes++;
    if (disk == NOTHING) return 0;
    if (disk != IN_PIECES || n_writes % 3) return pwritev(fd, &piece, 1, offset);
    errno = EINTR;
    return -1;
}

static void expect_text(exr_const_context_t file, const char *name, const char *expected)
{
    const char *text;
    int32_t length;
    assert_int_equal(exr_attr_get_string(file, 0, name, &length, &text), 0);
    assert_int_equal(length, strlen(expected));
    assert_memory_equal(text, expected, strlen(expected));
}

static void expect_window(const exr_attr_box2i_t *w, int x0, int y0, int x1, int y1)
{
    assert_true(w->min.x == x0 && w->min.y == y0 && w->max.x == x1 && w->max.y == y1);
}

/* 33 x 20 pixels of 64 x 48, four channels of colour and one of errors. */
static void expect_layout(exr_context_t file)
{
    exr_attr_box2i_t window;
    exr_compression_t compression;
    const exr_attr_chlist_t *list;
    assert_int_equal(exr_get_data_window(file, 0, &window), 0);
    expect_window(&window, 5, 7, 37, 26);
    assert_int_equal(exr_get_display_window(file, 0, &window), 0);
    expect_window(&window, 0, 0, 63, 47);
    assert_int_equal(exr_get_compression(file, 0, &compression), 0);
    assert_int_equal(compression, EXR_COMPRESSION_ZIP);
    assert_int_equal(exr_get_channels(file, 0, &list), 0);
    assert_int_equal(list->num_channels, 5);
    for (int i = 0; i < 5; i++) assert_int_equal(list->entries[i].pixel_type, EXR_PIXEL_FLOAT);
    assert_string_equal(list->entries[4].name.str, "stderr.R");
}

static void channels_windows_and_attributes_are_all_in_the_file(void **state)
{
    const float odd[] = {0, -0.0f, INFINITY, -1, 1e-45f, 3.4e38f, 65504};
    enum { N = 33 * 20 };
    static float colour[N][4], error[N];
    const char long_name[] = "a name that is a good deal longer than thirty-one characters";
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 4; k++)
            colour[i][k] = odd[(i + k) % 7] * (k == 3 ? 0.5f : 1);
        error[i] = (float)i / 3;
    }
    const bis_channel channels[5] = {{"R", colour[0], 4}, {"G", colour[0] + 1, 4}, {"B", colour[0] + 2, 4},
        {"A", colour[0] + 3, 4}, {"stderr.R", error, 1}};
    const bis_attribute attributes[4] = {
        {"scene", "knot.txt", 0}, {"spp", NULL, 16}, {"seconds", NULL, 0.1}, {long_name, "", 0}};
    const bis_picture picture = {.width = 33, .height = 20, .x0 = 5, .y0 = 7, .full_width = 64, .full_height = 48,
        .channels = channels,
                                 .n_channels = 5, .attributes = attributes, .n_attributes = 4};
    bis_diag diag = {0};
    assert_int_equal(bis_image_write(scratch("out.exr"), &picture, &diag), BIS_OK);
    assert_int_equal(diag.n, 0);

    bis_image image;
    expect_image(&image, scratch("out.exr"), NULL);
    for (int i = 0; i < N; i++)
        assert_memory_equal(&image.pixels[i], colour[i], sizeof(rgb));
    bis_image_clear(&image);

    exr_context_t file;
    double number;
    assert_int_equal(exr_start_read(&file, scratch("out.exr"), NULL), 0);
    expect_layout(file);
    expect_text(file, "scene", "knot.txt");
    expect_text(file, long_name, "");
    assert_int_equal(exr_attr_get_double(file, 0, "spp", &number), 0);
    assert_true(number == 16);
    assert_int_equal(exr_attr_get_double(file, 0, "seconds", &number), 0);
    assert_true(number == 0.1);
    exr_finish(&file);
}

/* Values within a factor of e fill their bytes so well that ZIP saves about what it adds: of 300 such pictures a dozen
 * come out exactly as long as they were (with zlib 1.2.13). */
static void a_chunk_that_zip_makes_neither_longer_nor_shorter_is_read_as_it_was(void **state)
{
    enum { WIDTH = 48, HEIGHT = 16, PICTURES = 300 };
    static float values[3 * WIDTH * HEIGHT];
    const bis_channel channels[3] = {{"R", values, 3}, {"G", values + 1, 3}, {"B", values + 2, 3}};
    const bis_picture picture = {.width = WIDTH, .height = HEIGHT, .full_width = WIDTH, .full_height = HEIGHT,
                                 .channels = channels, .n_channels = 3};
    for (int i = 0; i < PICTURES; i++) {
        bis_image image;
        bis_rng rng;
        bis_rng_init(&rng, 5, (uint64_t)i, 0, 0);
        for (int k = 0; k < 3 * WIDTH * HEIGHT; k++) values[k] = (float)exp(bis_rng_double(&rng) - 0.5);
        assert_int_equal(bis_image_write(scratch("noise.exr"), &picture, NULL), BIS_OK);
        assert_int_equal(bis_image_read(&image, scratch("noise.exr"), (bis_loc){0}, NULL), BIS_OK);
        assert_memory_equal(image.pixels, values, sizeof values);
        bis_image_clear(&image);
    }
}

enum { MOST_ROWS = 100, MOST_CHANNELS = 12, ROW = 24 };

/* Channel k of the picture holds other numbers than the rest, half of it noise that ZIP cannot shorten. */
static bis_picture noisy_picture(bis_channel channels[MOST_CHANNELS], int n_channels, int height)
{
    static const char *const names[MOST_CHANNELS] = {
        "R", "G", "B", "A", "Z", "a.R", "a.G", "a.B", "b.Y", "c.R", "c.G", "c.B"};
    static float values[MOST_CHANNELS * ROW * MOST_ROWS];
    bis_rng rng;
    bis_rng_init(&rng, 3, (uint64_t)height, (uint64_t)n_channels, 0);
    for (int i = 0; i < MOST_CHANNELS * ROW * MOST_ROWS; i++)
        values[i] = i % 8 < 4 ? (float)bis_rng_double(&rng) : (float)(i % 12);
    for (int k = 0; k < n_channels; k++) channels[k] = (bis_channel){names[k], values + k, n_channels};
    return (bis_picture){.width = ROW, .height = height, .x0 = 3, .y0 = 2, .full_width = ROW + 9,
                         .full_height = height + 7, .channels = channels, .n_channels = n_channels};
}

/* A chunk is 16 rows: less than one, one, and several with an end of one, four and nine rows. */
static void any_number_of_threads_writes_the_same_file(void **state)
{
    const int heights[] = {1, 16, 73}, threads[] = {1, 2, 3, 8}, before = use_threads(1);
    for (int n_channels = 3; n_channels <= MOST_CHANNELS; n_channels++)
        for (size_t i = 0; i < sizeof heights / sizeof *heights; i++) {
            bis_channel channels[MOST_CHANNELS];
            const bis_picture picture = noisy_picture(channels, n_channels, heights[i]);
            bytes first = {0};
            bis_image image;
            for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
                use_threads(threads[t]);
                assert_int_equal(bis_image_write(scratch("threads.exr"), &picture, NULL), BIS_OK);
                if (t == 0) load(&first, scratch("threads.exr"));
                assert_true(holds(scratch("threads.exr"), first.data, first.n));
            }
            expect_image(&image, scratch("threads.exr"), NULL);
            for (int k = 0; k < ROW * heights[i]; k++)
                assert_memory_equal(&image.pixels[k], channels[0].data + k * n_channels, sizeof(rgb));
            bis_image_clear(&image);
            bytes_clear(&first);
        }
    use_threads(before);
}

/* A disk that takes a few bytes at a time takes them all; one that takes none is full. */
static void a_slow_disk_gets_every_byte(void **state)
{
    bis_channel channels[MOST_CHANNELS];
    const bis_picture picture = noisy_picture(channels, 3, 33);
    bis_diag diag = {0};
    char expected[256];
    assert_int_equal(bis_image_write(scratch("slow.exr"), &picture, NULL), BIS_OK);
    bytes whole = {0};
    load(&whole, scratch("slow.exr"));
    n_writes = 0;
    disk = IN_PIECES;
    const bis_status in_pieces = bis_image_write(scratch("pieces.exr"), &picture, NULL);
    disk = NOTHING;
    const bis_status none = bis_image_write(scratch("nothing.exr"), &picture, &diag);
    disk = AS_EVER;
    assert_true(n_writes > (int)whole.n / 7);
    assert_int_equal(in_pieces, BIS_OK);
    assert_true(holds(scratch("pieces.exr"), whole.data, whole.n));
    assert_int_equal(none, BIS_IO);
    snprintf(expected, sizeof expected, "%s: error: cannot write \"%s\": No space left on device",
             scratch("nothing.exr"),
             scratch("nothing.exr"));
    assert_string_equal(diag.messages[0].text, expected);
    bis_diag_clear(&diag);
    bytes_clear(&whole);
}

/* Wherever the disk is full, whoever writes: one message, which names the reason, and no file. */
static void a_full_disk_stops_all_threads(void **state)
{
    const int before = use_threads(1);
    struct rlimit none, limit;
    bis_channel channels[MOST_CHANNELS];
    const bis_picture picture = noisy_picture(channels, 5, MOST_ROWS);
    char expected[256];
    struct stat info;

    assert_int_equal(bis_image_write(scratch("whole.exr"), &picture, NULL), BIS_OK);
    assert_int_equal(stat(scratch("whole.exr"), &info), 0);
    const int n_files = scratch_count();
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &none), 0);
    signal(SIGXFSZ, SIG_IGN);
    for (int threads = 1; threads <= 8; threads++)
        for (int i = 0; i < 50; i++) {
            bis_diag diag = {0};
            limit = none;
            limit.rlim_cur = (rlim_t)(info.st_size * i / 50);
            use_threads(threads);
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
            const bis_status status = bis_image_write(scratch("full.exr"), &picture, &diag);
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
            assert_int_equal(status, BIS_IO);
            assert_int_equal(diag.n, 1);
            snprintf(expected, sizeof expected, "%s: error: cannot write \"%s\": File too large", scratch("full.exr"),
                scratch("full.exr"));
            assert_string_equal(diag.messages[0].text, expected);
            assert_int_equal(scratch_count(), n_files);
            bis_diag_clear(&diag);
        }
    signal(SIGXFSZ, SIG_DFL);
    use_threads(before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_of_other_primaries_become_those_of_rec_709),
        cmocka_unit_test(the_share_of_pixels_outside_is_told),
        cmocka_unit_test(luminance_has_no_primaries),
        cmocka_unit_test(chromaticities_that_span_nothing_are_remarked),
        cmocka_unit_test(the_data_window_is_the_whole_map_wherever_it_lies),
        cmocka_unit_test(a_picture_with_a_smaller_data_window_is_filled_up),
        cmocka_unit_test(tiles_of_any_side_fill_the_map),
        cmocka_unit_test(each_file_gives_the_channels_or_the_message_beside_it),
        cmocka_unit_test(one_channel_of_any_type_among_any_others_is_read),
        cmocka_unit_test(every_compression_of_no_loss_is_read_in_scanlines_and_tiles),
        cmocka_unit_test(dwa_is_read_to_its_own_precision),
        cmocka_unit_test(luminance_with_chroma_is_colour),
        cmocka_unit_test(a_huge_window_in_a_short_file_is_refused_before_it_is_allocated),
        cmocka_unit_test(a_black_picture_of_each_compression_is_believed),
        cmocka_unit_test(no_damage_leads_out_of_the_file),
        cmocka_unit_test(no_damage_to_compressed_data_leads_out_of_the_file),
        cmocka_unit_test(channels_windows_and_attributes_are_all_in_the_file),
        cmocka_unit_test(a_chunk_that_zip_makes_neither_longer_nor_shorter_is_read_as_it_was),
        cmocka_unit_test(any_number_of_threads_writes_the_same_file),
        cmocka_unit_test(a_slow_disk_gets_every_byte),
        cmocka_unit_test(a_full_disk_stops_all_threads),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
